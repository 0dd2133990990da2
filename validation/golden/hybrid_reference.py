#!/usr/bin/env python3
"""Where another program puts the links and wafers of robots with arms.

Reads the robots with arms of the folder crates/jointplay-format/robots/, draws random positions of all
axes, and writes next to itself

    hybrid-positions.csv   the position of each axis
    hybrid-poses.csv       the pose of the platform, of each link and of each wafer

    python3 validation/golden/hybrid_reference.py

needs pin and numpy, and takes no arguments. Each arm is a serial chain in
Pinocchio, its base a free joint at the platform. The platform is laid over its
rods by the fit of three sockets onto three ball centres in space, by singular
value decomposition (Kabsch): the least displacement of the sockets, and so what
the planar virtualization gives in closed form.
"""

import platform
import tomllib
from pathlib import Path

import numpy
import pinocchio

DATE = "2026-11-21"
HERE = Path(__file__).resolve().parent
ROBOTS = HERE.parent.parent / "crates/jointplay-format/robots"
SAMPLES = 12
RANDOM = numpy.random.default_rng(20261121)


def laid_over(rods, limbs):
    """The pose of the platform: rotation and origin in mm."""
    angles = [numpy.radians(limb["socket_angle_deg"]) for limb in limbs]
    radii = [limb["socket_radius_mm"] for limb in limbs]
    sockets = numpy.array([[r * numpy.cos(a), r * numpy.sin(a), 0] for r, a in zip(radii, angles)])
    points = numpy.array([limb.get("base_point_mm", socket[:2]) for limb, socket in zip(limbs, sockets)])
    balls = numpy.column_stack([points, rods])
    from_center, to_center = sockets.mean(axis=0), balls.mean(axis=0)
    u, _, vt = numpy.linalg.svd((sockets - from_center).T @ (balls - to_center))
    sense = numpy.diag([1, 1, numpy.linalg.det(vt.T @ u.T)])
    rotation = vt.T @ sense @ u.T
    return rotation, to_center - rotation @ from_center


def chain(arm):
    """An arm in Pinocchio, with the names of its links and wafers as frames."""
    model = pinocchio.Model()
    base = model.addJoint(0, pinocchio.JointModelFreeFlyer(), pinocchio.SE3.Identity(), "platform")
    parent, offset = base, numpy.array(arm["mount_mm"])
    for k, joint in enumerate(arm["joint"]):
        offset = offset + [0, 0, joint.get("rise_mm", 0)]
        kind = {"turn": pinocchio.JointModelRZ, "slide": pinocchio.JointModelPX}[joint["kind"]]
        at = pinocchio.SE3(numpy.eye(3), offset)
        parent = model.addJoint(parent, kind(), at, f"{arm['name']}/{k}")
        frame = pinocchio.Frame(f"{arm['name']}/{k}", parent, 0, pinocchio.SE3.Identity(), pinocchio.FrameType.BODY)
        model.addFrame(frame)
        offset = numpy.array([joint.get("length_mm", 0), joint.get("offset_mm", 0), 0])
    for effector in arm["effector"]:
        heading = pinocchio.utils.rotate("z", numpy.radians(effector.get("heading_deg", 0)))
        at = pinocchio.SE3(heading, numpy.array(effector["wafer_center_mm"]))
        model.addFrame(pinocchio.Frame(effector["name"], parent, 0, at, pinocchio.FrameType.OP_FRAME))
    return model


def value(joint, positions):
    unit = {"turn": "deg", "slide": "mm"}[joint["kind"]]
    zero = joint.get(f"zero_{unit}", 0)
    total = zero + sum(ratio * positions[axis] for axis, ratio in joint["drives"].items())
    return numpy.radians(total) if unit == "deg" else total


def drawn(robot, gpr):
    """Positions within limits, in mm and degrees."""
    low, high = gpr["limits"]["rod_mm"]
    level = RANDOM.uniform(low + 20, high - 20)
    yaw, pitch = RANDOM.uniform(-180, 180), RANDOM.uniform(0, gpr["limits"]["tilt_deg"])
    rods = []
    for limb in gpr["limb"]:
        away = limb["socket_angle_deg"] - yaw
        offset = limb["socket_radius_mm"] * numpy.cos(numpy.radians(away))
        rods.append(level - offset * numpy.tan(numpy.radians(pitch)))
    positions = dict(zip(("q1", "q2", "q3"), rods))
    for axis in robot["axis"]:
        unit = {"turn": "deg", "slide": "mm"}[axis["kind"]]
        low, high = axis[f"range_{unit}"]
        positions[axis["name"]] = RANDOM.uniform(low, high)
    # Rounded first, so that what is written is what is computed with.
    return {name: round(float(value), 6) for name, value in positions.items()}


HEAD = """\
# {name}
# Source: the robots with arms of crates/jointplay-format/robots/, each arm a serial chain in Pinocchio on a platform laid over its rods by numpy.
# Command: python3 validation/golden/hybrid_reference.py
# Tool: Pinocchio {pinocchio}, numpy {numpy}, Python {python}
# Date: {date}
"""

POSITIONS = """\
# Units: mm for rods, degrees for motors.
# Tolerance: inputs, exact.
robot,sample,axis,value
"""

POSES = """\
# Units: mm.
# what: platform, ARM/K for link K of an arm (from 0), or the name of an effector for its wafer.
# x,y,z: origin in the base frame. r11..r33: rotation matrix, by rows.
# Tolerance: 1e-12 of m and of entries of rotation matrices, absolute: at most five transforms, lengths below 2 m, numbers in binary64.
robot,sample,what,x,y,z,r11,r12,r13,r21,r22,r23,r31,r32,r33
"""


def main():
    def head(name):
        return HEAD.format(
            name=name, date=DATE, pinocchio=pinocchio.__version__, numpy=numpy.__version__,
            python=platform.python_version())

    positions_file = head("hybrid-positions.csv") + POSITIONS
    poses_file = head("hybrid-poses.csv") + POSES
    for path in sorted(ROBOTS.glob("*.toml")):
        robot = tomllib.loads(path.read_text(encoding="utf-8"))
        if robot["kind"] != "hybrid":
            continue
        gpr = robot["gpr"]
        if isinstance(gpr, str):
            gpr = tomllib.loads((ROBOTS / f"{gpr}.toml").read_text(encoding="utf-8"))
        models = [chain(arm) for arm in robot["arm"]]
        for sample in range(SAMPLES):
            positions = drawn(robot, gpr)
            rotation, origin = laid_over([positions[q] for q in ("q1", "q2", "q3")], gpr["limb"])
            poses = {"platform": (origin, rotation)}
            for arm, model in zip(robot["arm"], models):
                data = model.createData()
                quaternion = pinocchio.Quaternion(rotation)
                q = numpy.concatenate([
                    origin, quaternion.coeffs(), [value(joint, positions) for joint in arm["joint"]]])
                pinocchio.framesForwardKinematics(model, data, q)
                for f, frame in enumerate(model.frames):
                    if frame.name != "universe":
                        poses[frame.name] = (data.oMf[f].translation.copy(), data.oMf[f].rotation.copy())
            for axis, number in positions.items():
                positions_file += f"{path.stem},{sample},{axis},{number!r}\n"
            for what, (point, turned) in poses.items():
                entries = [repr(float(v)) for v in [*point, *turned.ravel()]]
                poses_file += f"{path.stem},{sample},{what},{','.join(entries)}\n"
    (HERE / "hybrid-positions.csv").write_text(positions_file)
    (HERE / "hybrid-poses.csv").write_text(poses_file)


if __name__ == "__main__":
    main()
