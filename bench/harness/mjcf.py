"""The work of the bench as models of MuJoCo."""

from work import quaternion

HEAD = """<mujoco>
  <compiler angle="radian" inertiafromgeom="false"/>
  <option gravity="0 0 0"/>
  <worldbody>"""
# MuJoCo refuses moving bodies without mass; kinematics does not look at it.
INERTIA = '<inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>'


def words(numbers):
    return " ".join(f"{number:.17g}" for number in numbers)


def gpr(work):
    """A free platform, and on it a body with a turn about the middle and a slide for each limb."""
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
    """The tree of bodies; the loops stay open, for the caller to close.

    `inside` has further elements of bodies by their index, −1 for the world; `after` follows the bodies.
    """
    inside = inside or {}
    children = {parent: [] for parent in range(-1, len(work.bodies))}
    for index, body in enumerate(work.bodies):
        children[body.parent].append(index)
    # Coordinates of MuJoCo follow the order in which bodies are written, depth first; the work has to agree.
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
