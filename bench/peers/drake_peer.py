"""Worker for the workloads of the bench with Drake from Python.

python drake_peer.py gpr FILE, python drake_peer.py linkage FILE: Newton with the kinematics of MultibodyPlant
python drake_peer.py snopt FILE: InverseKinematics, solved by SNOPT; for the robot
python drake_peer.py closed FILE: the closed equations of the robot, solved by SNOPT
"""

import sys

import closed_equations
import numpy as np
import work as workload
from pydrake import symbolic
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BallRpyJoint,
    FixedOffsetFrame,
    JacobianWrtVariable,
    PrismaticJoint,
    QuaternionFloatingJoint,
    RevoluteJoint,
    SpatialInertia,
)
from pydrake.solvers import MathematicalProgram, SnoptSolver

# Slow methods compute every tenth pose only.
STRIDE = 10


def body(plant, name):
    return plant.AddRigidBody(name, SpatialInertia.SolidSphereWithMass(1.0, 0.1))


def offset(plant, name, parent, rotation, point):
    place = RigidTransform(RotationMatrix.ProjectToRotationMatrix(rotation), point)
    return plant.AddFrame(FixedOffsetFrame(name, parent, place))


def robot(work):
    """Model of the robot: a free platform, three rotations about its centre, and a slide on each, whose origin is the socket."""
    plant = MultibodyPlant(0.0)
    platform = body(plant, "platform")
    floating = QuaternionFloatingJoint("floating", plant.world_frame(), platform.body_frame())
    plant.AddJoint(floating)
    sockets, joints = [], []
    for k in range(3):
        out = np.append(work.direction[k], 0.0)
        arm, socket = body(plant, f"arm{k}"), body(plant, f"socket{k}")
        turn = RevoluteJoint(f"turn{k}", platform.body_frame(), arm.body_frame(), [0, 0, 1])
        place = offset(plant, f"place{k}", arm.body_frame(), np.eye(3), work.radius[k] * out)
        slide = PrismaticJoint(f"slide{k}", place, socket.body_frame(), out)
        joints.append((plant.AddJoint(turn), plant.AddJoint(slide)))
        sockets.append(socket)
    plant.Finalize()
    return plant, platform, sockets, joints


def answer(work, plant, context, platform, joints):
    pose = plant.EvalBodyPoseInWorld(context, platform)
    turned = [turn.get_angle(context) for turn, _ in joints]
    slid = [slide.get_translation(context) for _, slide in joints]
    return [*pose.rotation().matrix().ravel(), *pose.translation(), *(work.radius + slid), *turned]


def gpr(path):
    work = workload.Gpr.read(path)
    plant, platform, sockets, joints = robot(work)
    context = plant.CreateDefaultContext()
    world = plant.world_frame()
    rest = np.zeros(plant.num_positions())
    floating = plant.GetJointByName("floating")
    rest[floating.position_start()] = 1.0
    rest[floating.position_start() + 6] = work.height
    passive = list(range(floating.velocity_start(), floating.velocity_start() + 6))
    own = [joint.velocity_start() for pair in joints for joint in pair]
    compliance = work.compliance

    def one(rods):
        balls = work.balls(rods)
        q = rest
        for _ in range(workload.ITERATIONS):
            plant.SetPositions(context, q)
            points = np.array([plant.EvalBodyPoseInWorld(context, s).translation() for s in sockets])
            gap = (points - balls).ravel()
            if not np.abs(gap).max() > work.gap:
                return answer(work, plant, context, platform, joints)
            jacobian = np.vstack(
                [
                    plant.CalcJacobianTranslationalVelocity(
                        context, JacobianWrtVariable.kV, s.body_frame(), np.zeros(3), world, world
                    )
                    for s in sockets
                ]
            )
            step = workload.least_step(gap, jacobian[:, passive], jacobian[:, own], compliance)
            v = np.empty(12)
            v[passive], v[own] = step
            q = q + plant.MapVelocityToQDot(context, v)
            first = floating.position_start()
            q[first : first + 4] /= np.linalg.norm(q[first : first + 4])
        return None

    return lambda: [one(rods) for rods in work.poses], 1


def snopt(path):
    work = workload.Gpr.read(path)
    plant, platform, sockets, joints = robot(work)
    context = plant.CreateDefaultContext()
    world = plant.world_frame()
    rest = np.zeros(plant.num_positions())
    floating = plant.GetJointByName("floating").position_start()
    rest[floating], rest[floating + 6] = 1.0, work.height
    solver = SnoptSolver()
    starts = [joint.position_start() for pair in joints for joint in pair]

    def one(rods):
        ik = InverseKinematics(plant, context)
        program, q = ik.prog(), ik.q()
        for socket, ball in zip(sockets, work.balls(rods)):
            ik.AddPositionConstraint(socket.body_frame(), np.zeros(3), world, ball, ball)
        weights = 1 / work.compliance
        program.AddQuadraticErrorCost(np.diag(weights / weights.max()), np.zeros(6), q[starts])
        program.SetSolverOption(solver.id(), "Major feasibility tolerance", 1e-13)
        program.SetSolverOption(solver.id(), "Minor feasibility tolerance", 1e-13)
        result = solver.Solve(program, rest)
        found = result.GetSolution(q)
        found[floating : floating + 4] /= np.linalg.norm(found[floating : floating + 4])
        plant.SetPositions(context, found)
        return answer(work, plant, context, platform, joints)

    def every():
        answers = [None] * len(work.poses)
        answers[::STRIDE] = [one(rods) for rods in work.poses[::STRIDE]]
        return answers

    return every, STRIDE


def closed(path):
    """Least displacement under the closed equations, which are symbolic expressions."""
    work = workload.Gpr.read(path)
    own = closed_equations.constants(work)
    program, solver = MathematicalProgram(), SnoptSolver()
    y, wanted = program.NewContinuousVariables(6), program.NewContinuousVariables(3)
    values, _ = closed_equations.scaled_sides(symbolic, own, y)
    program.AddQuadraticErrorCost(np.eye(6), np.zeros(6), y)
    for value, goal in zip(values, wanted):
        program.AddConstraint(value - goal, 0.0, 0.0)
    # Constants of expressions cannot change between poses; bounds can.
    held = program.AddBoundingBoxConstraint(np.zeros(3), np.zeros(3), wanted).evaluator()
    for name in ("Major feasibility tolerance", "Major optimality tolerance", "Minor feasibility tolerance"):
        program.SetSolverOption(solver.id(), name, 1e-12)

    def one(rods):
        goal = np.array(closed_equations.scaled_wanted(own, rods))
        held.set_bounds(goal, goal)
        return solver.Solve(program, np.concatenate([np.zeros(6), goal])).GetSolution(y)

    def rows(found):
        answers = [None] * len(work.poses)
        answers[::STRIDE] = [closed_equations.from_scaled(own, y) for y in found]
        return answers

    return lambda: [one(rods) for rods in work.poses[::STRIDE]], STRIDE, None, rows


def tree(work, time_step):
    """Open tree of a mechanism: plant before `Finalize`, bodies and joints."""
    plant = MultibodyPlant(time_step)
    bodies, joints = [], []
    world = plant.world_frame()
    for index, one in enumerate(work.bodies):
        parent = world if one.parent < 0 else bodies[one.parent].body_frame()
        frame = offset(plant, f"frame{index}", parent, one.rotation, one.point)
        bodies.append(body(plant, f"body{index}"))
        if one.kind == "R":
            joint = RevoluteJoint(f"joint{index}", frame, bodies[-1].body_frame(), [0, 0, 1])
        elif one.kind == "P":
            joint = PrismaticJoint(f"joint{index}", frame, bodies[-1].body_frame(), [0, 0, 1])
        else:
            joint = BallRpyJoint(f"joint{index}", frame, bodies[-1].body_frame())
        joints.append(plant.AddJoint(joint))
    return plant, bodies, joints


def positions(work, plant, joints, values):
    """Positions of the plant; ball joints rotate about the fixed axes x, then y, then z."""
    q, at = np.empty(plant.num_positions()), 0
    for one, joint in zip(work.bodies, joints):
        own, first = values[at : at + one.width], joint.position_start()
        at += one.width
        if one.kind == "S":
            r = workload.ball(own)
            q[first : first + 3] = (
                np.arctan2(r[2, 1], r[2, 2]),
                np.arctan2(-r[2, 0], np.hypot(r[2, 1], r[2, 2])),
                np.arctan2(r[1, 0], r[0, 0]),
            )
        else:
            q[first] = own[0]
    return q


def linkage(path):
    work = workload.Linkage.read(path)
    plant, bodies, joints = tree(work, time_step=0.0)
    world = plant.world_frame()
    sides = []
    for index, cut in enumerate(work.cuts):
        pair = []
        for side, (where, frame) in enumerate(zip(cut.bodies, cut.frames)):
            parent = world if where < 0 else bodies[where].body_frame()
            pair.append(offset(plant, f"cut{index}{side}", parent, *frame))
        sides.append(pair)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    free = [
        k
        for one, joint in zip(work.bodies, joints)
        if not one.driven
        for k in range(joint.velocity_start(), joint.velocity_start() + joint.num_velocities())
    ]

    def values_at(q):
        values = []
        for one, joint in zip(work.bodies, joints):
            first = joint.position_start()
            if one.kind == "S":
                x, y, z = q[first : first + 3]
                upright = workload.turn(z)
                level = workload.turn(y)[np.ix_([1, 2, 0], [1, 2, 0])]
                ahead = workload.turn(x)[np.ix_([2, 0, 1], [2, 0, 1])]
                values.extend(workload.quaternion(upright @ level @ ahead))
            else:
                values.append(q[first])
        return values

    starts = [positions(work, plant, joints, guess) for guess in work.guesses]

    def one(q):
        for _ in range(workload.ITERATIONS):
            plant.SetPositions(context, q)
            gap, rows = [], []
            for cut, (first, second) in zip(work.cuts, sides):
                a, b = first.CalcPoseInWorld(context), second.CalcPoseInWorld(context)
                gap.append(b.translation() - a.translation())
                if cut.kind == "R":
                    gap.append(a.rotation().matrix()[:, :2].T @ b.rotation().matrix()[:, 2])
            gap = np.concatenate(gap)
            if not np.abs(gap).max() > work.gap:
                return values_at(q)
            for cut, (first, second) in zip(work.cuts, sides):
                velocity = [
                    plant.CalcJacobianSpatialVelocity(
                        context, JacobianWrtVariable.kV, frame, np.zeros(3), world, world
                    )[:, free]
                    for frame in (first, second)
                ]
                relative = velocity[1] - velocity[0]
                rows.append(relative[3:])
                if cut.kind == "R":
                    z = second.CalcPoseInWorld(context).rotation().matrix()[:, 2]
                    axes = first.CalcPoseInWorld(context).rotation().matrix()[:, :2]
                    rows.append(np.cross(z, axes.T) @ relative[:3])
            v = np.zeros(plant.num_velocities())
            v[free] = -np.linalg.lstsq(np.vstack(rows), gap, rcond=1e-10)[0]
            q = q + plant.MapVelocityToQDot(context, v)
        return None

    return lambda: [one(q) for q in starts], 1


if __name__ == "__main__":
    workload.serve(*{"gpr": gpr, "snopt": snopt, "closed": closed, "linkage": linkage}[sys.argv[1]](sys.argv[2]))
