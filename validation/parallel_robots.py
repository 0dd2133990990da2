"""Compare the constraint Jacobian of parallel robots with that of Pinocchio.

The robots are folders with `robot.urdf` and `robot.yaml`, such as those of the public collection
Gepetto/example-parallel-robots, whose path is the argument.
`jointplay import --loops` and `jointplay mobility` give the closed configuration, rank and instantaneous mobility.
At the same coordinates, this program builds the robot in Pinocchio from the two files by itself, measures how far its
loops are open there, and computes the rank of its constraint Jacobian.

    python -m pip install pin==4.1.0 pyyaml
    python validation/parallel_robots.py ROBOTS --jointplay target/release/jointplay

The exit code is 1 if a robot differs.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin
import yaml

# Singular values below this share of the largest are round-off: with loops closed to 1e-12, they are far below.
RANK = 1e-7
# Largest mismatch of the loops in Pinocchio, at the coordinates of jointplay (m and rad).
CLOSED = 1e-9
TURNS = {"X": pin.JointModelRX, "Y": pin.JointModelRY, "Z": pin.JointModelRZ}


def with_kinds(urdf: Path, kinds: dict[str, str]) -> pin.Model:
    """The tree of a URDF, with other kinds for some of its joints."""
    read = pin.buildModelFromUrdf(str(urdf))
    model = pin.Model()
    # Joint of the model that carries a joint of the file, and where.
    carrier = {0: (0, pin.SE3.Identity())}
    for j in range(1, read.njoints):
        name, joint, kind = read.names[j], read.joints[j], kinds.get(read.names[j])
        parent, placement = carrier[read.parents[j]]
        placement = placement * read.jointPlacements[j]
        if kind == "FIXED":
            carrier[j] = parent, placement
            continue
        if kind == "SPHERICAL":
            joint = pin.JointModelSpherical()
        elif kind is not None:
            first, second = kind.removeprefix("UJOINT_")
            parent = model.addJoint(parent, TURNS[first](), placement, name + "/0")
            joint, placement = TURNS[second](), pin.SE3.Identity()
        carrier[j] = model.addJoint(parent, joint, placement, name), pin.SE3.Identity()
    for frame in list(read.frames)[1:]:
        joint, placement = carrier[frame.parentJoint]
        model.addFrame(pin.Frame(frame.name, joint, placement * frame.placement, frame.type), False)
    return model


def configuration(model: pin.Model, kinds: dict[str, str], coordinates: dict[str, float]) -> np.ndarray:
    """Coordinates of jointplay as those of Pinocchio."""
    q = pin.neutral(model)
    for j in range(1, model.njoints):
        joint, name = model.joints[j], model.names[j]
        part = slice(joint.idx_q, joint.idx_q + joint.nq)
        if name.endswith("/0"):
            q[part] = coordinates[name[:-2] + "[0]"]
        elif kinds.get(name) == "SPHERICAL":
            turn = np.array([coordinates[f"{name}[{k}]"] for k in range(3)])
            q[part] = pin.Quaternion(pin.exp3(turn)).coeffs()
        elif name in kinds:
            q[part] = coordinates[f"{name}[1]"]
        elif joint.nq == 2:
            q[part] = np.cos(coordinates[name]), np.sin(coordinates[name])
        else:
            q[part] = coordinates[name]
    return q


def pinocchio(folder: Path, coordinates: dict[str, float]) -> dict[str, float]:
    """Coordinates, constraints, rank, mobility and mismatch of a robot in Pinocchio."""
    text = yaml.safe_load((folder / "robot.yaml").read_text())
    kinds = dict(zip(text.get("joint_name", []), text.get("joint_type", []), strict=True))
    model = with_kinds(folder / "robot.urdf", kinds)
    q = configuration(model, kinds, coordinates)
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    pin.updateFramePlacements(model, data)
    pin.computeJointJacobians(model, data, q)
    constraints, mismatch = [], 0.0
    pairs = text["closed_loop"]
    for (first, second), kind in zip(pairs, text.get("type", ["6d"] * len(pairs)), strict=True):
        a, b = (model.frames[model.getFrameId(name)] for name in (first, second))
        is_point = kind.lower() == "3d"
        contact = pin.ContactType.CONTACT_3D if is_point else pin.ContactType.CONTACT_6D
        constraints.append(
            pin.RigidConstraintModel(
                contact, model, a.parentJoint, a.placement, b.parentJoint, b.placement, pin.ReferenceFrame.LOCAL
            )
        )
        poses = [data.oMf[model.getFrameId(name)] for name in (first, second)]
        apart = poses[0].inverse() * poses[1]
        mismatch = max(mismatch, np.abs(apart.translation).max())
        if not is_point:
            mismatch = max(mismatch, np.abs(apart.rotation - np.eye(3)).max())
    jacobian = pin.getConstraintsJacobian(model, data, constraints, [c.createData() for c in constraints])
    sizes = np.linalg.svd(jacobian, compute_uv=False)
    rank = int((sizes > RANK * sizes[0]).sum())
    return {
        "points": sum(c.type == pin.ContactType.CONTACT_3D for c in constraints),
        "coordinates": model.nv,
        "rank": rank,
        "mobility": model.nv - rank,
        "mismatch": mismatch,
        "next": float(sizes[rank] / sizes[0]) if rank < len(sizes) else 0.0,
    }


def jointplay(command: str, folder: Path, scratch: Path) -> dict[str, object] | str:
    """The answer of `jointplay mobility`, or its error."""
    file = scratch / f"{len(list(scratch.iterdir()))}.toml"
    loops = ["--loops", str(folder / "robot.yaml")]
    urdf = str(folder / "robot.urdf")
    done = subprocess.run(
        [command, "--quiet", "import", urdf, *loops, "--out", str(file)], capture_output=True, text=True, check=False
    )
    if done.returncode == 0:
        done = subprocess.run(
            [command, "mobility", str(file), "--format", "json"], capture_output=True, text=True, check=False
        )
    if done.returncode != 0:
        return done.stderr.strip()
    return {**json.loads(done.stdout), "note": done.stderr.strip()}


def main() -> None:
    """Compare all robots below a folder."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("robots", type=Path, help="folder with the robots")
    options.add_argument("--jointplay", default="jointplay", help="the command")
    arguments = options.parse_args()
    differences = 0
    print("| robot | coordinates | loops | rank | mobility | Pinocchio: rank | mobility | loops open by |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as scratch:
        for file in sorted(arguments.robots.rglob("robot.yaml")):
            folder = file.parent
            name = folder.relative_to(arguments.robots)
            if not (folder / "robot.urdf").exists():
                continue
            ours = jointplay(arguments.jointplay, folder, Path(scratch))
            if isinstance(ours, str):
                differences += 1
                print(f"| {name} | {ours} |")
                continue
            theirs = pinocchio(folder, ours["coordinates"])
            mobility = ours["instantaneous_mobility"]
            # A point of Pinocchio is a spherical joint here: three more coordinates, with three more equations.
            coordinates = ours["joint_freedoms"] - 3 * theirs["points"]
            rank = ours["rank"] - 3 * theirs["points"]
            same = (coordinates, rank, mobility) == (
                theirs["coordinates"],
                theirs["rank"],
                theirs["mobility"],
            )
            differences += not (same and theirs["mismatch"] < CLOSED)
            print(
                f"| {name} | {coordinates} | {ours['loops']} | {rank} | {mobility}"
                f" | {theirs['rank']} | {theirs['mobility']} | {theirs['mismatch']:.0e} |"
            )
            if ours["note"]:
                print(f"  {ours['note']}", file=sys.stderr)
    sys.exit(1 if differences else 0)


if __name__ == "__main__":
    main()
