"""Prints the results of a program for mechanisms, as far as it supports them, as JSON: `words.py PROGRAM FOLDER`.

Each mechanism is in one closed configuration; then the level robot without virtual joints is commanded to rise, and to tilt.
"""

import contextlib
import io
import json
import sys
from pathlib import Path

import numpy as np
import work as workload

MECHANISMS = [
    "four-bar",
    "bennett",
    "bricard-orthogonal",
    "sarrus",
    "3-rps",
    "3-upu-tsai",
    "3-upu-snu",
    "gpr-level",
    "gpr-tilted",
]
ASKED = ["gpr-asked-to-rise", "gpr-asked-to-tilt"]
PEERS = Path(__file__).resolve().parent.parent / "peers"
sys.path.append(str(PEERS))
# Positions along the axis of a hinge of the two points by which some programs close a loop [m].
ON_AXIS = (-0.1, 0.1)


def points(cut):
    """Points in which two sides of a cut coincide: one for a ball joint, two for a hinge."""
    along = ON_AXIS if cut.kind == "R" else (0.0,)
    return [[point + rotation[:, 2] * by for rotation, point in cut.frames] for by in along]


def rank(jacobian):
    return int(np.linalg.matrix_rank(jacobian, tol=1e-9 * np.linalg.norm(jacobian, 2)))


def pinocchio():
    """Results of Pinocchio: point constraints on a tree, and forward dynamics with and without proximal regularisation."""
    import pinocchio as pin

    def build(work):
        kinds = {"R": pin.JointModelRZ, "P": pin.JointModelPZ, "S": pin.JointModelSpherical}
        model, joints, q = pin.Model(), [], []
        at = 0
        for index, body in enumerate(work.bodies):
            parent = 0 if body.parent < 0 else joints[body.parent]
            joints.append(
                model.addJoint(parent, kinds[body.kind](), pin.SE3(body.rotation, body.point), f"body{index}")
            )
            model.appendBodyToJoint(joints[-1], pin.Inertia.Random(), pin.SE3.Identity())
            own = work.guesses[0][at : at + body.width]
            at += body.width
            q.extend(np.roll(own, -1) if body.kind == "S" else own)
        constraints = [
            pin.RigidConstraintModel(
                pin.ContactType.CONTACT_3D,
                model,
                *(
                    x
                    for body, p in zip(cut.bodies, pair)
                    for x in (0 if body < 0 else joints[body], pin.SE3(np.eye(3), p))
                ),
            )
            for cut in work.cuts
            for pair in points(cut)
        ]
        return model, pin.StdVec_RigidConstraintModel(constraints), np.array(q), joints

    def dynamics(model, constraints, q, mu):
        data = model.createData()
        datas = pin.StdVec_RigidConstraintData([constraint.createData() for constraint in constraints])
        pin.initConstraintDynamics(model, data, constraints, datas)
        settings = pin.ProximalSettings(1e-12, mu, 20)
        v = np.zeros(model.nv)
        a = pin.constraintDynamics(model, data, q, v, v, constraints, datas, settings)
        return a

    def derivative(model, data, constraints, datas, q):
        """Jacobian of all constraints; Pinocchio requires a call that places each of them first."""
        pin.computeJointJacobians(model, data, q)
        for constraint, constraint_data in zip(constraints, datas):
            constraint.calc(model, data, constraint_data)
        return pin.getConstraintsJacobian(model, data, constraints, datas)

    def one(work):
        pin.seed(1)
        model, constraints, q, _ = build(work)
        data = model.createData()
        datas = pin.StdVec_RigidConstraintData([constraint.createData() for constraint in constraints])
        jacobian = derivative(model, data, constraints, datas, q)
        sharp, soft = (dynamics(model, constraints, q, mu) for mu in (0.0, 1e-12))
        apart = np.abs(sharp - soft).max() / np.abs(soft).max()
        return {
            "velocities": model.nv,
            "rows": jacobian.shape[0],
            "rank_of_its_jacobian": rank(jacobian),
            "accelerations_mu_0": "finite" if np.isfinite(sharp).all() else "NaN",
            "accelerations_mu_1e-12": "finite" if np.isfinite(soft).all() else "NaN",
            "apart": float(apart) if np.isfinite(apart) else None,
        }

    def asked(work):
        model, constraints, q, joints = build(work)
        free = [
            model.idx_vs[joint] + k
            for body, joint in zip(work.bodies, joints)
            if not body.driven
            for k in range(model.nvs[joint])
        ]
        data = model.createData()
        datas = pin.StdVec_RigidConstraintData([constraint.createData() for constraint in constraints])
        for _ in range(100):
            jacobian = derivative(model, data, constraints, datas, q)[:, free]
            gap = np.concatenate([constraint_data.c1Mc2.translation for constraint_data in datas])
            step = np.zeros(model.nv)
            # The gap is the position of side one relative to side two.
            step[free] = np.linalg.lstsq(jacobian, gap, rcond=1e-9)[0]
            q = pin.integrate(model, q, step)
        return {"gap_mm": 1e3 * float(np.abs(gap).max())}

    return one, asked


def mujoco():
    """Results of MuJoCo: `connect` constraints on a tree, a forward pass, and a simulation with stiff position servos on the rods."""
    import mjcf
    import mujoco as mj

    def build(work, after=""):
        sites, connects = {}, []
        for number, (cut, pair) in enumerate((cut, pair) for cut in work.cuts for pair in points(cut)):
            for side, (body, point) in enumerate(zip(cut.bodies, pair)):
                sites[body] = sites.get(body, "") + f'<site name="{number}-{side}" pos="{mjcf.words(point)}"/>'
            connects.append(f'<connect site1="{number}-0" site2="{number}-1"/>')
        text = mjcf.linkage(work, sites, f"<equality>{''.join(connects)}</equality>{after}")
        model = mj.MjModel.from_xml_string(text)
        data = mj.MjData(model)
        data.qpos[:] = work.guesses[0]
        return model, data

    def warnings(data):
        return int(sum(warning.number for warning in data.warning))

    def one(work):
        model, data = build(work)
        mj.mj_forward(model, data)
        jacobian = np.zeros((data.nefc, model.nv))
        for column, unit in enumerate(np.eye(model.nv)):
            out = np.zeros(data.nefc)
            mj.mj_mulJacVec(model, data, out, unit)
            jacobian[:, column] = out
        return {
            "velocities": model.nv,
            "rows": int(data.ne),
            "rank_of_its_jacobian": rank(jacobian),
            "accelerations": "finite" if np.isfinite(data.qacc).all() else "NaN",
            "warnings": warnings(data),
        }

    def asked(work):
        rods = [index for index, body in enumerate(work.bodies) if body.driven]
        servos = "".join(f'<position joint="joint{rod}" kp="1e5" dampratio="1"/>' for rod in rods)
        model, data = build(work, f"<actuator>{servos}</actuator>")
        model.opt.integrator = mj.mjtIntegrator.mjINT_IMPLICITFAST
        at = [model.joint(f"joint{rod}").qposadr[0] for rod in rods]
        goal = data.qpos[at]
        mj.mj_resetData(model, data)
        # The rods move for five seconds and then dwell for five.
        while data.time < 10.0:
            data.ctrl[:] = goal * min(data.time / 5.0, 1.0)
            mj.mj_step(model, data)
        reached = data.qpos[at]
        return {
            "gap_mm": 1e3 * float(np.abs(data.efc_pos[: data.ne]).max()),
            "rods_off_mm": 1e3 * float(np.abs(data.ctrl - reached).max()),
            "warnings": warnings(data),
        }

    return one, asked


def drake():
    """Results of Drake: ball constraints on a tree, and inverse kinematics with fixed rods."""
    import drake_peer
    from pydrake.multibody.inverse_kinematics import InverseKinematics
    from pydrake.solvers import SnoptSolver

    def one(work):
        plant, bodies, _ = drake_peer.tree(work, time_step=1e-3)
        where = [plant.world_body(), *bodies]
        for cut in work.cuts:
            for pair in points(cut):
                first, second = (where[body + 1] for body in cut.bodies)
                plant.AddBallConstraint(first, pair[0], second, pair[1])
        plant.Finalize()
        return {"velocities": plant.num_velocities(), "constraints": plant.num_constraints()}

    def asked(work):
        plant, bodies, joints = drake_peer.tree(work, time_step=0.0)
        plant.Finalize()
        ik = InverseKinematics(plant, plant.CreateDefaultContext())
        frames = [plant.world_frame(), *(body.body_frame() for body in bodies)]
        for cut in work.cuts:
            for pair in points(cut):
                first, second = (frames[body + 1] for body in cut.bodies)
                ik.AddPositionConstraint(first, pair[0], second, pair[1], pair[1])
        program, q = ik.prog(), ik.q()
        goal = drake_peer.positions(work, plant, joints, work.guesses[0])
        for body, joint in zip(work.bodies, joints):
            if body.driven:
                at = joint.position_start()
                program.AddBoundingBoxConstraint(goal[at], goal[at], q[at])
        result = SnoptSolver().Solve(program, goal)
        info = result.get_solver_details().info
        return {"status": f"{result.get_solution_result().name}, SNOPT info {info}"}

    return one, asked


def exudyn():
    """Results of Exudyn: freedoms and redundant constraints of joints on a kinematic tree, and the static solver."""
    import exudyn as exu
    import exudyn_peer

    def one(work):
        mbs, _ = exudyn_peer.closed_tree(work, held=False)
        q = exudyn_peer.coordinates(work, work.guesses[0])
        for configuration in (exu.ConfigurationType.Initial, exu.ConfigurationType.Current):
            mbs.systemData.SetODE2Coordinates(q, configuration)
        found = mbs.ComputeSystemDegreeOfFreedom()
        return {
            "coordinates": int(found["nODE2"]),
            "rows": int(found["nAE"]),
            "degree_of_freedom": int(found["degreeOfFreedom"]),
            "redundant_constraints": int(found["redundantConstraints"]),
        }

    def asked(work):
        answers = {}
        for forgiving in (False, True):
            mbs, drives = exudyn_peer.closed_tree(work, held=True)
            start = exudyn_peer.coordinates(work, work.guesses[0])
            for drive, link in drives:
                mbs.SetObjectParameter(drive, "offset", start[link])
            settings = exudyn_peer.settings(work.gap)
            settings.linearSolver.ignoreSingularJacobian = forgiving
            name = "ignoring singular Jacobians" if forgiving else "default"
            try:
                mbs.SolveStatic(settings)
                placed = work.gaps(exudyn_peer.values(work, mbs.systemData.GetODE2Coordinates()))
                answers[name] = f"solved, {1e3 * np.abs(placed).max():.0e} mm open"
            except Exception as error:
                answers[name] = " ".join(f"{type(error).__name__}: {error}".split())[:300]
        return answers

    return one, asked


def main(program, folder):
    # Programs print messages of their own; only the answer may be on standard output.
    with contextlib.redirect_stdout(io.StringIO()):
        one, asked = {"pinocchio": pinocchio, "mujoco": mujoco, "drake": drake, "exudyn": exudyn}[program]()
        results = {}
        for name in [*MECHANISMS, *ASKED]:
            ask = asked if name in ASKED else one
            try:
                results[name] = ask(workload.Linkage.read(folder / f"{name}.txt"))
            except Exception as error:
                results[name] = {"error": " ".join(f"{type(error).__name__}: {error}".split())[:300]}
    print("answer", json.dumps(results))


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
