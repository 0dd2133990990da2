"""Rates of a spatial loop by Pinocchio and NumPy, for `crates/jointplay-core/tests/differential.rs`.

    pip install pin numpy
    python3 validation/golden/differential_reference.py

The loop of the test, a hinge, a ball, a universal joint and a hinge, is opened at its last hinge:
a tree of a hinge, a spherical joint and two hinges remains, whose last frame Pinocchio moves.
Its point has to stay where the hinge is, and its z axis along the axis of the hinge: five equations, solved by least squares.
Prints velocities, then accelerations: crank, ball (angular velocity in the turned frame), universal joint.
"""

import numpy as np
import pinocchio as pin

CRANK, VELOCITY, ACCELERATION = 0.3, 0.7, -0.4


def place(point, axis):
    """The frame of a joint: z along its axis, x toward the x of the base, or its y where the axis is along x."""
    z = np.array(axis, dtype=float) / np.linalg.norm(axis)
    other = np.array([1.0, 0.0, 0.0] if abs(z[0]) < 0.9 else [0.0, 1.0, 0.0])
    y = np.cross(z, other)
    y /= np.linalg.norm(y)
    return pin.SE3(np.column_stack([np.cross(y, z), y, z]), np.array(point, dtype=float))


def loop():
    """The tree, its last frame, and where that has to be."""
    crank = place([0.0, 0.0, 0.0], [0.1, 0.2, 1.0])
    ball = place([0.12, 0.03, 0.02], [0.0, 0.0, 1.0])
    cross = place([0.4, 0.25, 0.1], [0.0, 0.0, 1.0])
    rocker = place([0.5, 0.0, 0.05], [0.0, 0.3, 1.0])
    model = pin.Model()
    last = model.addJoint(0, pin.JointModelRZ(), crank, "crank")
    last = model.addJoint(last, pin.JointModelSpherical(), crank.actInv(ball), "ball")
    last = model.addJoint(last, pin.JointModelRZ(), ball.actInv(cross), "cross, first")
    last = model.addJoint(last, pin.JointModelRX(), pin.SE3.Identity(), "cross, second")
    frame = model.addFrame(pin.Frame("rocker", last, cross.actInv(rocker), pin.FrameType.OP_FRAME))
    return model, frame, rocker


def main():
    model, frame, hinge = loop()
    data = model.createData()
    axis = hinge.rotation[:, 2]
    across = hinge.rotation[:, :2].T
    world = pin.LOCAL_WORLD_ALIGNED

    def equations(rates):
        """Of a motion (linear, angular) of the last frame."""
        return np.concatenate([rates[:3], across @ rates[3:]])

    def jacobian(q):
        columns = pin.computeFrameJacobian(model, data, q, frame, world)
        return np.column_stack([equations(column) for column in columns.T])

    q = pin.integrate(model, pin.neutral(model), np.array([CRANK, 0.0, 0.0, 0.0, 0.0, 0.0]))
    for _ in range(50):
        pin.framesForwardKinematics(model, data, q)
        at = data.oMf[frame]
        off = np.concatenate([at.translation - hinge.translation, across @ np.cross(axis, at.rotation[:, 2])])
        step = np.linalg.lstsq(jacobian(q)[:, 1:], -off, rcond=None)[0]
        q = pin.integrate(model, q, np.concatenate([[0.0], step]))
    assert np.abs(off).max() < 1e-14, off

    matrix = jacobian(q)
    passive = np.linalg.lstsq(matrix[:, 1:], -matrix[:, 0] * VELOCITY, rcond=None)[0]
    velocities = np.concatenate([[VELOCITY], passive])
    pin.forwardKinematics(model, data, q, velocities, np.zeros(model.nv))
    pin.updateFramePlacements(model, data)
    drift = equations(pin.getFrameClassicalAcceleration(model, data, frame, world).vector)
    passive = np.linalg.lstsq(matrix[:, 1:], -drift - matrix[:, 0] * ACCELERATION, rcond=None)[0]
    accelerations = np.concatenate([[ACCELERATION], passive])
    print(f"# pinocchio {pin.__version__}, numpy {np.__version__}")
    for rates in (velocities, accelerations):
        print(*(repr(float(rate)) for rate in rates), sep=",\n")


if __name__ == "__main__":
    main()
