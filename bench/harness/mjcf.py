"""Writes the workloads of the bench as models of MuJoCo."""

from work import quaternion

HEAD = """<mujoco>
  <compiler angle="radian" inertiafromgeom="false"/>
  <option gravity="0 0 0"/>
  <worldbody>"""
# MuJoCo rejects moving bodies without mass; kinematics does not use the mass.
INERTIA = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def words(numbers):
    return " ".join(f"{number:.17g}" for number in numbers)


def gpr(work):
    """Model of the robot: a free platform, and for each limb a body with a rotation about the centre and a slide."""
    lines = [HEAD, f'<body name="platform" pos="0 0 {work.height:.17g}"><freejoint/>{INERTIA}']
    for k in range(3):
        out = (*work.direction[k], 0.0)
        at = [work.radius[k] * x for x in out]
        lines.append(
            f'<body name="socket{k}" pos="{words(at)}">{INERTIA}'
            f'<joint type="hinge" axis="0 0 1" pos="{words([-x for x in at])}"/>'
            f'<joint type="slide" axis="{words(out)}"/></body>'
        )
    return "\n".join([*lines, "</body>", "</worldbody></mujoco>"])


def linkage(work, inside=None, after=""):
    """Model of the tree of bodies; the caller closes the loops.

    `inside` contains further elements of bodies by index, −1 for the world; `after` contains the elements after the bodies.
    """
    inside = inside or {}
    children = {parent: [] for parent in range(-1, len(work.bodies))}
    for index, body in enumerate(work.bodies):
        children[body.parent].append(index)
    # MuJoCo orders coordinates by the bodies of the file, depth first; the workload must have the same order.
    order = []

    def write(index):
        order.append(index)
        body = work.bodies[index]
        kind = {"R": "hinge", "P": "slide", "S": "ball"}[body.kind]
        axis = "" if body.kind == "S" else ' axis="0 0 1"'
        hanging = "\n".join(write(child) for child in children[index])
        return (
            f'<body name="body{index}" pos="{words(body.point)}" quat="{words(quaternion(body.rotation))}">'
            f'{INERTIA}<joint name="joint{index}" type="{kind}"{axis}/>'
            f"{inside.get(index, '')}\n{hanging}</body>"
        )

    tree = "\n".join(write(child) for child in children[-1])
    if order != sorted(order):
        raise ValueError("bodies must be listed depth first")
    return f"{HEAD}\n{inside.get(-1, '')}{tree}\n</worldbody>{after}</mujoco>"
