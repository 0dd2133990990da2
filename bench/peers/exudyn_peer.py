"""Worker for the workloads of the bench with the static solver of Exudyn, on kinematic trees with loops closed by joints.

python exudyn_peer.py gpr FILE, python exudyn_peer.py linkage FILE
The virtual joints have springs: their static equilibrium is the least displacement.
"""

import sys

import exudyn as exu
import exudyn.itemInterface as items
import numpy as np
import work as workload

Z = exu.JointType.RevoluteZ
TURNS = [exu.JointType.RevoluteX, exu.JointType.RevoluteY, exu.JointType.RevoluteZ]
SLIDES = [exu.JointType.PrismaticX, exu.JointType.PrismaticY, exu.JointType.PrismaticZ]


class Tree:
    """Kinematic tree, which `add` extends by one link."""

    def __init__(self):
        self.types, self.parents, self.rotations, self.points = [], [], [], []

    def add(self, parent, kind, rotation=np.eye(3), point=(0, 0, 0)):
        self.types.append(kind)
        self.parents.append(parent)
        self.rotations.append(rotation)
        self.points.append(np.array(point, dtype=float))
        return len(self.types) - 1

    def build(self, stiffness):
        """Builds system, node and tree, with springs at coordinates of non-zero stiffness."""
        count = len(self.types)
        mbs = exu.SystemContainer().AddSystem()
        zeros = [0.0] * count
        node = mbs.AddNode(
            items.NodeGenericODE2(
                referenceCoordinates=zeros,
                initialCoordinates=zeros,
                initialCoordinates_t=zeros,
                numberOfODE2Coordinates=count,
            )
        )
        tree = mbs.AddObject(
            items.ObjectKinematicTree(
                nodeNumber=node,
                jointTypes=self.types,
                linkParents=self.parents,
                jointTransformations=exu.Matrix3DList(self.rotations),
                jointOffsets=exu.Vector3DList(self.points),
                linkInertiasCOM=exu.Matrix3DList([np.eye(3)] * count),
                linkCOMs=exu.Vector3DList([[0.0] * 3] * count),
                linkMasses=[1.0] * count,
                jointPControlVector=stiffness,
                jointPositionOffsetVector=zeros,
            )
        )
        return mbs, node, tree


def settings(gap):
    exu.config.suppressWarnings = True
    options = exu.SimulationSettings()
    options.solution.file.write = False
    options.solution.sensors.active = False
    options.staticSolver.verboseMode = 0
    newton = options.staticSolver.newton
    # Full Newton steps; the harness checks the solution afterwards.
    newton.relativeTolerance = 1e-12
    newton.absoluteTolerance = gap
    options.staticSolver.adaptiveStep = False
    options.linearSolver.solverType = exu.LinearSolverType.EigenDense
    options.linearSolver.ignoreSingularJacobian = True
    return options


def solved(mbs, options, solver, start):
    """Coordinates in equilibrium from a start, or None."""
    mbs.systemData.SetODE2Coordinates(start, exu.ConfigurationType.Initial)
    try:
        if not solver.SolveSystem(mbs, options):
            return None
    except Exception:
        return None
    return mbs.systemData.GetODE2Coordinates(exu.ConfigurationType.Current)


def gpr(path):
    work = workload.Gpr.read(path)
    tree = Tree()
    link = -1
    for kind in SLIDES + TURNS:
        link = tree.add(link, kind, point=(0, 0, work.height if kind == SLIDES[0] else 0))
    platform, sockets = link, []
    for k in range(3):
        heading = np.arctan2(work.direction[k, 1], work.direction[k, 0])
        turn = tree.add(platform, Z, rotation=workload.turn(heading))
        sockets.append(tree.add(turn, SLIDES[0], point=(work.radius[k], 0, 0)))
    stiffness = np.concatenate([np.zeros(6), 1 / work.compliance])
    mbs, node, body = tree.build(stiffness)
    ground = mbs.AddObject(items.ObjectGround())
    balls = []
    for socket in sockets:
        ball = mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=ground, localPosition=[0, 0, 0]))
        own = mbs.AddMarker(
            items.MarkerKinematicTreeRigid(objectNumber=body, linkNumber=socket, localPosition=[0, 0, 0])
        )
        mbs.AddObject(items.ObjectJointSpherical(markerNumbers=[ball, own]))
        balls.append(ball)
    mbs.Assemble()
    options, solver, rest = settings(work.gap), exu.MainSolverStatic(), np.zeros(12)

    def one(rods):
        for marker, ball in zip(balls, work.balls(rods)):
            mbs.SetMarkerParameter(marker, "localPosition", ball)
        q = solved(mbs, options, solver, rest)
        if q is None:
            return None
        x, y, z = q[3:6]
        rotation = turn_x(x) @ turn_y(y) @ workload.turn(z)
        return [*rotation.ravel(), *(q[:3] + [0, 0, work.height]), *(work.radius + q[7::2]), *q[6::2]]

    return lambda: [one(rods) for rods in work.poses]


def turn_x(angle):
    return workload.turn(angle)[np.ix_([2, 0, 1], [2, 0, 1])]


def turn_y(angle):
    return workload.turn(angle)[np.ix_([1, 2, 0], [1, 2, 0])]


def closed_tree(work, held):
    """System and drives of a mechanism with loops closed by joints; with `held`, the drives fix their coordinates."""
    tree, links = Tree(), []
    for one in work.bodies:
        parent = -1 if one.parent < 0 else links[one.parent]
        if one.kind == "S":
            # A ball joint consists of three rotations.
            parent = tree.add(parent, TURNS[0], one.rotation, one.point)
            parent = tree.add(parent, TURNS[1])
            links.append(tree.add(parent, TURNS[2]))
        else:
            links.append(tree.add(parent, Z if one.kind == "R" else SLIDES[2], one.rotation, one.point))
    mbs, node, body = tree.build([0.0] * len(tree.types))
    ground = mbs.AddObject(items.ObjectGround())
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    drives = []
    for one, link in zip(work.bodies, links):
        if one.driven and held:
            own = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=link))
            drives.append(
                (mbs.AddObject(items.ObjectConnectorCoordinate(markerNumbers=[fixed, own], offset=0.0)), link)
            )
    for cut in work.cuts:
        markers = []
        for where, (rotation, point) in zip(cut.bodies, cut.frames):
            place = {"localHT": np.block([[rotation, point[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])}
            if where < 0:
                markers.append(mbs.AddMarker(items.MarkerBodyRigid(bodyNumber=ground, **place)))
            else:
                on = {"objectNumber": body, "linkNumber": links[where]}
                markers.append(mbs.AddMarker(items.MarkerKinematicTreeRigid(**on, **place)))
        axes = [1, 1, 1, 1, 1, 0] if cut.kind == "R" else [1, 1, 1, 0, 0, 0]
        mbs.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=axes))
    mbs.Assemble()
    return mbs, drives


def coordinates(work, values):
    """Coordinates of the tree; a ball joint has three angles."""
    q, at = [], 0
    for one in work.bodies:
        own = values[at : at + one.width]
        at += one.width
        if one.kind == "S":
            r = workload.ball(own)
            q += [np.arctan2(-r[1, 2], r[2, 2]), np.arcsin(r[0, 2]), np.arctan2(-r[0, 1], r[0, 0])]
        else:
            q.append(own[0])
    return np.array(q)


def values(work, q):
    """Coordinates of the answer; a ball joint has a quaternion."""
    written_values, at = [], 0
    for one in work.bodies:
        if one.kind == "S":
            x, y, z = q[at : at + 3]
            written_values.extend(workload.quaternion(turn_x(x) @ turn_y(y) @ workload.turn(z)))
            at += 3
        else:
            written_values.append(q[at])
            at += 1
    return np.array(written_values)


def linkage(path):
    work = workload.Linkage.read(path)
    mbs, drives = closed_tree(work, held=True)
    options, solver = settings(work.gap), exu.MainSolverStatic()
    starts = [coordinates(work, guess) for guess in work.guesses]

    def one(q):
        for drive, link in drives:
            mbs.SetObjectParameter(drive, "offset", q[link])
        found = solved(mbs, options, solver, q)
        return None if found is None else values(work, found)

    return lambda: [one(q) for q in starts]


if __name__ == "__main__":
    workload.serve({"gpr": gpr, "linkage": linkage}[sys.argv[1]](sys.argv[2]))
