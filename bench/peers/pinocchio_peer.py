"""Worker for the workloads of the bench with Pinocchio from Python: kinematics of Pinocchio, linear algebra of NumPy.

python pinocchio_peer.py gpr FILE, python pinocchio_peer.py linkage FILE
"""

import sys

import numpy as np
import pinocchio as pin
import work as workload


def cross_columns(linear, angular, point):
    """Velocities of a point for twists at the origin, one column for each twist."""
    x, y, z = point
    lift = np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
    return linear + lift @ angular


def gpr(path):
    work = workload.Gpr.read(path)
    model = pin.Model()
    platform = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "platform")
    slides = []
    for k in range(3):
        out = np.append(work.direction[k], 0.0)
        turn = model.addJoint(platform, pin.JointModelRZ(), pin.SE3.Identity(), f"turn{k}")
        place = pin.SE3(np.eye(3), work.radius[k] * out)
        slides.append(model.addJoint(turn, pin.JointModelPrismaticUnaligned(out), place, f"slide{k}"))
    data = model.createData()
    rest = pin.neutral(model)
    rest[2] = work.height
    compliance = work.compliance

    def one(rods):
        balls = work.balls(rods)
        q = rest
        for _ in range(workload.ITERATIONS):
            pin.forwardKinematics(model, data, q)
            points = np.array([data.oMi[slide].translation for slide in slides])
            gap = (points - balls).ravel()
            if not np.abs(gap).max() > work.gap:
                pose = data.oMi[platform]
                slid = [q[model.idx_qs[slide]] for slide in slides]
                turned = [q[model.idx_qs[slide - 1]] for slide in slides]
                return [*pose.rotation.ravel(), *pose.translation, *(work.radius + slid), *turned]
            jacobian = pin.computeJointJacobians(model, data)
            virtual_part = np.zeros((9, 6))
            rows = []
            for k in range(3):
                moved = cross_columns(jacobian[:3], jacobian[3:], points[k])
                rows.append(moved[:, :6])
                own = slice(2 * k, 2 * k + 2)
                virtual_part[3 * k : 3 * k + 3, own] = moved[:, 6 + 2 * k : 8 + 2 * k]
            step = workload.least_step(gap, np.vstack(rows), virtual_part, compliance)
            q = pin.integrate(model, q, np.concatenate(step))
        return None

    return lambda: [one(rods) for rods in work.poses]


def linkage(path):
    work = workload.Linkage.read(path)
    kinds = {"R": pin.JointModelRZ, "P": pin.JointModelPZ, "S": pin.JointModelSpherical}
    model, joints = pin.Model(), []
    for index, body in enumerate(work.bodies):
        parent = 0 if body.parent < 0 else joints[body.parent]
        place = pin.SE3(body.rotation, body.point)
        joints.append(model.addJoint(parent, kinds[body.kind](), place, f"body{index}"))
    data = model.createData()
    free, order = [], []
    for body, joint in zip(work.bodies, joints):
        q, v = model.idx_qs[joint], model.idx_vs[joint]
        # The workload has w, x, y, z; Pinocchio has x, y, z, w.
        order.extend([q + 3, q, q + 1, q + 2] if body.kind == "S" else [q])
        free.extend([] if body.driven else range(v, v + model.nvs[joint]))
    frames = [[pin.SE3(*frame) for frame in cut.frames] for cut in work.cuts]
    # Columns that move each side of each cut.
    supports = []
    for cut in work.cuts:
        moving = []
        for body in cut.bodies:
            chain = set() if body < 0 else set(model.supports[joints[body]])
            moving.append(
                np.array(
                    [
                        any(
                            joint and model.idx_vs[joint] <= k < model.idx_vs[joint] + model.nvs[joint]
                            for joint in chain
                        )
                        for k in free
                    ]
                )
            )
        supports.append(moving)

    def placed():
        for cut, own in zip(work.cuts, frames):
            yield [f if b < 0 else data.oMi[joints[b]] * f for b, f in zip(cut.bodies, own)]

    def one(guess):
        q = np.empty(model.nq)
        q[order] = guess
        for _ in range(workload.ITERATIONS):
            pin.forwardKinematics(model, data, q)
            sides = list(placed())
            gap = []
            for cut, (first, second) in zip(work.cuts, sides):
                gap.append(second.translation - first.translation)
                if cut.kind == "R":
                    gap.append(first.rotation[:, :2].T @ second.rotation[:, 2])
            gap = np.concatenate(gap)
            if not np.abs(gap).max() > work.gap:
                return q[order]
            columns = pin.computeJointJacobians(model, data)[:, free]
            rows = []
            for cut, (first, second), moving in zip(work.cuts, sides, supports):
                linear = angular = 0.0
                for sign, side, moves in ((-1.0, first, moving[0]), (1.0, second, moving[1])):
                    own = columns * (sign * moves)
                    linear = linear + cross_columns(own[:3], own[3:], side.translation)
                    angular = angular + own[3:]
                rows.append(linear)
                if cut.kind == "R":
                    z = second.rotation[:, 2]
                    rows.append(np.cross(z, first.rotation[:, :2].T) @ angular)
            step = np.zeros(model.nv)
            step[free] = -np.linalg.lstsq(np.vstack(rows), gap, rcond=1e-10)[0]
            q = pin.integrate(model, q, step)
        return None

    return lambda: [one(guess) for guess in work.guesses]


if __name__ == "__main__":
    workload.serve({"gpr": gpr, "linkage": linkage}[sys.argv[1]](sys.argv[2]))
