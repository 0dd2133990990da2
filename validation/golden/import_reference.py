#!/usr/bin/env python3
"""Where the programs that models are written for put their links.

Loads the models in models/, next to this file, into MuJoCo (MJCF), Drake (SDF)
and Pinocchio (URDF), moves the joints to random coordinates, and writes next
to itself

    imported-coordinates.csv   the coordinates of each joint
    imported-poses.csv         the pose of each link, and of both sides of each loop closure

    python3 validation/golden/import_reference.py

needs mujoco, drake, pin and numpy, and takes no arguments. Loops stay open:
coordinates are random, so that both sides of a closure are apart.
"""

import platform
import re
import sys
from importlib.metadata import version
from pathlib import Path

import mujoco
import numpy
import pinocchio
from pydrake.math import RollPitchYaw, RotationMatrix
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex

DATE = "2026-11-21"
HERE = Path(__file__).resolve().parent
SAMPLES = 4
RANDOM = numpy.random.default_rng(20261121)

TURN, SLIDE = 1.2, 0.3


def rotation(vector):
    """The rotation of a rotation vector, by Rodrigues' formula."""
    angle = numpy.linalg.norm(vector)
    x, y, z = vector / angle
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return numpy.eye(3) + numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross


def quaternion(vector):
    """(w, x, y, z) of a rotation vector."""
    angle = numpy.linalg.norm(vector)
    return numpy.concatenate([[numpy.cos(angle / 2)], numpy.sin(angle / 2) * vector / angle])


def turns(count):
    return RANDOM.uniform(-TURN, TURN, count)


def slides(count):
    return RANDOM.uniform(-SLIDE, SLIDE, count)


def matrix_of(quat):
    matrix = numpy.zeros(9)
    mujoco.mju_quat2Mat(matrix, quat / numpy.linalg.norm(quat))
    return matrix.reshape(3, 3)


def from_mujoco(path):
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    kinds = mujoco.mjtJoint
    for _ in range(SAMPLES):
        coordinates, poses = {}, {}
        data.qpos[:] = model.qpos0
        for j in range(model.njnt):
            at, kind, name = model.jnt_qposadr[j], model.jnt_type[j], model.joint(j).name
            if kind == kinds.mjJNT_HINGE:
                coordinates[name] = turns(1)
                data.qpos[at] = coordinates[name][0]
            elif kind == kinds.mjJNT_SLIDE:
                coordinates[name] = slides(1)
                data.qpos[at] = coordinates[name][0]
            elif kind == kinds.mjJNT_BALL:
                coordinates[name] = turns(3)
                data.qpos[at:at + 4] = quaternion(coordinates[name])
            else:
                # Of a free joint the coordinates count from where the model has the body.
                by, turned = slides(3), turns(3)
                start = data.qpos[at + 3:at + 7].copy()
                data.qpos[at:at + 3] += matrix_of(start) @ by
                mujoco.mju_mulQuat(data.qpos[at + 3:at + 7], start, quaternion(turned))
                coordinates[name] = numpy.concatenate([by, turned])
        mujoco.mj_kinematics(model, data)
        for b in range(1, model.nbody):
            poses[model.body(b).name] = (data.xpos[b].copy(), data.xmat[b].reshape(3, 3).copy())
        for e in range(model.neq):
            if not data.eq_active[e]:
                continue
            name, first, second = model.equality(e).name, model.eq_obj1id[e], model.eq_obj2id[e]
            is_weld = model.eq_type[e] == mujoco.mjtEq.mjEQ_WELD
            values = model.eq_data[e]
            if model.eq_objtype[e] == mujoco.mjtObj.mjOBJ_SITE:
                sides = [(data.site_xpos[s].copy(), data.site_xmat[s].reshape(3, 3).copy())
                         for s in (first, second)]
            else:
                bodies = [(data.xpos[b], data.xmat[b].reshape(3, 3)) for b in (first, second)]
                (p1, r1), (p2, r2) = bodies
                if is_weld:
                    sides = [(p1 + r1 @ values[3:6], r1 @ matrix_of(values[6:10])),
                             (p2 + r2 @ values[0:3], r2)]
                else:
                    sides = [(p1 + r1 @ values[0:3], None), (p2 + r2 @ values[3:6], None)]
            for k, (point, turned) in enumerate(sides):
                poses[f"{name}[{k}]"] = (point, turned if is_weld else None)
        yield coordinates, poses


# The model that has the closing joint.
MODELS = {"frames.sdf": "frames", "world.sdf": "bar"}
# Drake counts a joint to the model of its child.
NAMES = {"hand::ball": "ball"}
CLOSING = re.compile(r'<joint name="closing" type="(\w+)">(.*?)</joint>', re.S)


def from_drake(path):
    """Drake takes trees only: the joint that closes the loop becomes a frame on its child."""
    text = path.read_text()
    closing = CLOSING.search(text).group(2)
    pose = re.search(r"<pose.*?</pose>", closing).group(0)
    parent = re.search(r"<parent>(.*?)</parent>", closing).group(1)
    child = re.search(r"<child>(.*?)</child>", closing).group(1)
    axis = re.search(r"<xyz(?: expressed_in=\"(\w+)\")?>(.*?)</xyz>", closing)
    text = CLOSING.sub(f'<frame name="closing" attached_to="{child}">{pose}</frame>', text)
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(text, "sdf")
    plant.Finalize()
    context = plant.CreateDefaultContext()
    only = "<world" not in text

    def shown(item):
        model = plant.GetModelInstanceName(item.model_instance())
        name = f"{model}::{item.name()}"
        name = name.split("::", 1)[1] if only else name
        return NAMES.get(name, name)

    bodies = [plant.get_body(BodyIndex(b)) for b in range(plant.num_bodies())]
    frame = plant.GetFrameByName("closing")
    model = MODELS[path.name]
    closing_name = "closing" if only else f"{model}::closing"

    def body_of(name):
        """The body with which a link or frame moves."""
        *around, last = name.split("::")
        scope = "::".join([model, *around])
        instance = plant.GetModelInstanceByName(scope)
        return plant.GetFrameByName(last, instance).body()

    sides = [body_of(parent), body_of(child)]
    at_zero = frame.CalcPoseInWorld(context)
    direction = numpy.array([float(v) for v in axis.group(2).split()])
    turned = at_zero.rotation().matrix()
    if axis.group(1):
        turned = plant.GetFrameByName(axis.group(1)).CalcPoseInWorld(context).rotation().matrix()
    direction = turned @ direction / numpy.linalg.norm(direction)
    on_sides = []
    for body in sides:
        there = plant.EvalBodyPoseInWorld(context, body).inverse()
        on_sides.append((there @ at_zero.translation(), there.rotation().matrix() @ direction))
    for _ in range(SAMPLES):
        coordinates, poses = {}, {}
        for j in plant.GetJointIndices():
            joint = plant.get_joint(j)
            kind, name = joint.type_name(), shown(joint)
            if kind == "weld":
                continue
            if kind == "ball_rpy":
                coordinates[name] = turns(3)
                values = RollPitchYaw(RotationMatrix(rotation(coordinates[name]))).vector()
            elif kind == "prismatic":
                values = coordinates[name] = slides(1)
            elif kind in ("revolute", "screw", "universal"):
                values = coordinates[name] = turns(joint.num_positions())
            else:
                sys.exit(f"{path.name}: a joint of kind {kind}")
            state = plant.GetPositions(context)
            state[joint.position_start():joint.position_start() + len(values)] = values
            plant.SetPositions(context, state)
        for body in bodies:
            if body.name() != "world":
                pose = plant.EvalBodyPoseInWorld(context, body)
                poses[shown(body)] = (pose.translation(), pose.rotation().matrix())
        for k, (body, (point, axis_on_body)) in enumerate(zip(sides, on_sides)):
            pose = plant.EvalBodyPoseInWorld(context, body)
            poses[f"{closing_name}[{k}]"] = (pose @ point, pose.rotation().matrix() @ axis_on_body)
        yield coordinates, poses


def from_pinocchio(path):
    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    for _ in range(SAMPLES):
        coordinates, poses = {}, {}
        q = pinocchio.neutral(model)
        for j in range(1, model.njoints):
            at, kind, name = model.idx_qs[j], model.joints[j].shortname(), model.names[j]
            if kind == "JointModelFreeFlyer":
                by, turned = slides(3), turns(3)
                w, x, y, z = quaternion(turned)
                q[at:at + 7] = [*by, x, y, z, w]
                coordinates[name] = numpy.concatenate([by, turned])
            elif kind == "JointModelPlanar":
                by, turned = slides(2), turns(1)
                q[at:at + 4] = [*by, numpy.cos(turned[0]), numpy.sin(turned[0])]
                coordinates[name] = numpy.concatenate([by, turned])
            elif kind.startswith("JointModelRUB") or kind == "JointModelRevoluteUnboundedUnaligned":
                coordinates[name] = turns(1)
                q[at:at + 2] = [numpy.cos(coordinates[name][0]), numpy.sin(coordinates[name][0])]
            elif kind.startswith("JointModelP"):
                q[at] = (coordinates.setdefault(name, slides(1)))[0]
            else:
                q[at] = (coordinates.setdefault(name, turns(1)))[0]
        pinocchio.framesForwardKinematics(model, data, q)
        for f, frame in enumerate(model.frames):
            if frame.type == pinocchio.FrameType.BODY:
                poses[frame.name] = (data.oMf[f].translation.copy(), data.oMf[f].rotation.copy())
        yield coordinates, poses


READERS = {".xml": from_mujoco, ".sdf": from_drake, ".urdf": from_pinocchio}

HEAD = """\
# {name}
# Source: the models of validation/golden/models, loaded by the programs they are written for.
# Command: python3 validation/golden/import_reference.py
# Tool: MuJoCo {mujoco} (.xml), Drake {drake} (.sdf), Pinocchio {pinocchio} (.urdf); numpy {numpy}, Python {python}
# Date: {date}
"""


def head(name):
    return HEAD.format(
        name=name, date=DATE, mujoco=mujoco.__version__, drake=version("drake"),
        pinocchio=pinocchio.__version__, numpy=numpy.__version__,
        python=platform.python_version())


COORDINATES = """\
# Units: rad and m.
# value: random, {turn} rad and {slide} m at most in either direction; several of one joint in the order of the mechanism,
#   a ball's as rotation vector, those of a free joint from where the model has the body.
# Tolerance: inputs, exact.
model,sample,joint,index,value
"""

POSES = """\
# Units: m.
# what: a link, or NAME[0] and NAME[1]: the two sides of the joint NAME that closes a loop.
# x,y,z: origin in the world. r11..r33: rotation matrix, by rows; of a closure by a joint with an axis
#   only its third column, the direction of the axis; of a connect none.
# Tolerance: 1e-12, absolute: chains of at most ten links, lengths below 4 m, numbers in binary64.
model,sample,what,x,y,z,r11,r12,r13,r21,r22,r23,r31,r32,r33
"""


def main():
    coordinates_file = head("imported-coordinates.csv")
    coordinates_file += COORDINATES.format(turn=TURN, slide=SLIDE)
    poses_file = head("imported-poses.csv") + POSES
    for path in sorted((HERE / "models").iterdir()):
        for sample, (coordinates, poses) in enumerate(READERS[path.suffix](path)):
            for joint, values in coordinates.items():
                for index, value in enumerate(values):
                    coordinates_file += f"{path.name},{sample},{joint},{index},{float(value)!r}\n"
            for what, (point, turned) in poses.items():
                entries = [repr(float(v)) for v in point]
                if turned is None:
                    entries += [""] * 9
                elif turned.shape == (3,):
                    for v in turned:
                        entries += ["", "", repr(float(v))]
                else:
                    entries += [repr(float(v)) for v in turned.ravel()]
                poses_file += f"{path.name},{sample},{what},{','.join(entries)}\n"
    (HERE / "imported-coordinates.csv").write_text(coordinates_file)
    (HERE / "imported-poses.csv").write_text(poses_file)


if __name__ == "__main__":
    main()
