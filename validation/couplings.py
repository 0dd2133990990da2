"""Compare coupled mechanisms with MuJoCo and Pinocchio.

Models with gears, a rack and a differential in loops, written in the format of MuJoCo, and a gripper with `mimic` in
that of ROS. Both programs evaluate constraints and their Jacobian; positions follow from their own Newton steps.
Compared are the numbers of independent and redundant constraints, and the poses of all bodies over a motion.

    pip install mujoco==4.0.0 pin numpy
    python couplings.py --jointplay target/debug/jointplay --pinocchio

MuJoCo alone is also run by `exported.py`. Further models of MuJoCo can be given with the joint to be driven and its
range in radians or metres: `--model scene.xml left_driver_joint=0:0.6`.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

# Singular values below this share of the largest count as zero; in these models they are below 1e-13 or above 1e-3.
RANK = 1e-8
# Largest deviation of positions (m) and rotation matrices: round-off of the Newton steps, which end at 1e-12.
SAME = 1e-9
STEPS = 12

FIVE_BAR = """<mujoco model="geared five-bar"><compiler angle="radian"/><worldbody>
  <body name="left crank"><joint name="left" axis="0 0 1" ref="0.4"/><geom size="0.01"/>
    <body name="left rod" pos="0.4 0.92 0"><joint name="left knee" axis="0 0 1"/><geom size="0.01"/></body></body>
  <body name="right crank" pos="3 0 0"><joint name="right" axis="0 0 -1"/><geom size="0.01"/>
    <body name="right rod" pos="0.1 1.1 0"><joint name="right knee" axis="0 0 1"/><geom size="0.01"/></body></body>
</worldbody><equality>
  <connect body1="left rod" body2="right rod" anchor="1.3 1.4 0"/>
  <joint joint1="right" joint2="left" polycoef="0 0.75 0 0 0"/>
</equality></mujoco>"""

RACK = """<mujoco model="rack and crank"><compiler angle="degree"/><worldbody>
  <body name="rack" pos="0 -0.05 0"><joint name="rack" type="slide" axis="1 0 0"/><geom size="0.01"/>
    <body name="link" pos="0.3 0 0"><joint name="pin" axis="0 0 1"/><geom size="0.01"/></body></body>
  <body name="pinion"><joint name="pinion" axis="0 0 1"/><geom size="0.01"/></body>
  <body name="rocker" pos="0.6 0.2 0"><joint name="rocker" axis="0 0 1" ref="25"/><geom size="0.01"/></body>
</worldbody><equality>
  <connect body1="link" body2="rocker" anchor="0.25 0.06 0"/>
  <joint joint1="rack" joint2="pinion" polycoef="0 -0.05"/>
</equality></mujoco>"""

DIFFERENTIAL = """<mujoco model="differential"><compiler angle="radian"/><worldbody>
  <body name="near"><joint name="near" axis="0 1 0"/><geom size="0.01"/></body>
  <body name="far" pos="0 0.4 0"><joint name="far" axis="0 1 0" ref="-0.2"/><geom size="0.01"/></body>
  <body name="carrier" pos="0 0.2 0"><joint name="carrier" axis="0 1 0"/><geom size="0.01"/>
    <body name="coupler" pos="0.2 0 0.1"><joint name="elbow" axis="0 1 0"/><geom size="0.01"/></body></body>
  <body name="lever" pos="0.7 0.2 0"><joint name="lever" axis="0 1 0"/><geom size="0.01"/></body>
</worldbody><tendon>
  <fixed name="sum"><joint joint="near" coef="1"/><joint joint="far" coef="1.5"/><joint joint="carrier" coef="-2.5"/></fixed>
</tendon><equality>
  <connect body1="coupler" body2="lever" anchor="0.45 0 0.1"/>
  <tendon tendon1="sum" polycoef="0"/>
  <joint joint1="near" joint2="far" polycoef="0 -0.5 0 0 0"/>
</equality></mujoco>"""

# With the joint that is driven, and by how much (rad, m).
MODELS = [(FIVE_BAR, "left", 0.5), (RACK, "pinion", 0.6), (DIFFERENTIAL, "far", 0.7)]

# A gripper with fingers of four bars each, of which the second follows the first; `ends` are joined.
GRIPPER = """<robot name="gripper"><link name="palm"/>{links}
  <joint name="left" type="revolute"><origin xyz="0 0.03 0"/><parent link="palm"/><child link="left knuckle"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="left inner" type="revolute"><origin xyz="0 0.01 0.02"/><parent link="palm"/><child link="left inner"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="left finger" type="revolute"><origin xyz="0 0.04 0.05"/><parent link="left knuckle"/><child link="left finger"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="right" type="revolute"><origin xyz="0 -0.03 0" rpy="0 0 3.141592653589793"/><parent link="palm"/><child link="right knuckle"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="left" multiplier="0.8" offset="0"/></joint>
  <joint name="right inner" type="revolute"><origin xyz="0 -0.01 0.02" rpy="0 0 3.141592653589793"/><parent link="palm"/><child link="right inner"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="right finger" type="revolute"><origin xyz="0 0.04 0.05"/><parent link="right knuckle"/><child link="right finger"/><axis xyz="1 0 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
SIDES = ["left", "right"]
PIN_ON_FINGER, PIN_ON_INNER = (0.0, -0.02, 0.02), (0.0, 0.04, 0.05)


def jointplay(command: str, *words: str) -> dict:
    """The JSON answer of a command."""
    done = subprocess.run([command, *words, "--format", "json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"jointplay {' '.join(words)}: {done.stderr}")
    return json.loads(done.stdout)


def rank(jacobian: np.ndarray) -> int:
    sizes = np.linalg.svd(jacobian, compute_uv=False)
    return int((sizes > RANK * sizes[0]).sum())


def rotation(quaternion: list[float]) -> np.ndarray:
    w, x, y, z = quaternion
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def compare(name: str, command: str, file: Path, drive: str, poses_of, counts: tuple[int, int]) -> None:
    """Counts and poses of jointplay, against those of another program.

    `poses_of` gives position and rotation of links for a value of the driven joint, in the order of a motion.
    """
    answer = jointplay(command, "mobility", str(file))
    found = answer["instantaneous_mobility"], answer["redundancy"]
    if found != counts:
        sys.exit(f"{name}: mobility and redundancy are {found}, expected {counts}")
    moved = jointplay(command, "move", str(file), "--drive", drive, "--steps", str(STEPS), "--poses")
    (driven,) = moved["driven"]
    worst = 0.0
    # Imported files are in m and rad.
    values = next(moved["series"][key] for key in (f"{driven}_rad", f"{driven}_m") if key in moved["series"])
    for k, value in enumerate(values):
        for link, (place, turn) in poses_of(value).items():
            ours = moved["poses"][link]
            worst = max(worst, np.abs(np.array(ours["position"][k]) - place).max())
            worst = max(worst, np.abs(rotation(ours["quaternion"][k]) - turn).max())
    if not worst < SAME:
        sys.exit(f"{name}: poses differ by {worst}")
    print(f"{name}: mobility {counts[0]}, {counts[1]} redundant; poses within {worst:.1e} over {STEPS} steps")


def imported(command: str, folder: Path, model: Path, *words: str) -> Path:
    file = folder / f"{model.stem}.toml"
    done = subprocess.run(
        [command, "--quiet", "import", str(model), *words, "--out", str(file)], capture_output=True, text=True, check=False
    )
    if done.returncode != 0:
        sys.exit(f"import of {model.name}: {done.stderr}")
    return file


def check_mujoco(command: str, folder: Path, text: str, joint: str, ends: tuple[float | None, float]) -> None:
    """A model of MuJoCo, whose constraints MuJoCo evaluates."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(text) if "<" in text else mujoco.MjModel.from_xml_path(text)
    model.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    data = mujoco.MjData(model)
    name = Path(text).stem if "<" not in text else text.split('"')[1]
    file = folder / f"{name.replace(' ', '-')}.xml"
    file.write_text(text if "<" in text else Path(text).read_text())
    held = model.joint(joint).dofadr[0]
    free = [k for k in range(model.nv) if k != held]

    def constraints() -> tuple[np.ndarray, np.ndarray]:
        mujoco.mj_forward(model, data)
        rows = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        return data.efc_pos[rows], data.efc_J.reshape(-1, model.nv)[rows]

    def close() -> None:
        for _ in range(50):
            open_by, jacobian = constraints()
            if np.abs(open_by).max() < 1e-13:
                return
            step = np.zeros(model.nv)
            step[free] = -np.linalg.lstsq(jacobian[:, free], open_by, rcond=RANK)[0]
            mujoco.mj_integratePos(model, data.qpos, step, 1.0)
        open_by, _ = constraints()
        if np.abs(open_by).max() > 1e-12:
            sys.exit(f"{name}: MuJoCo's constraints stay open by {np.abs(open_by).max()}")

    close()
    open_by, jacobian = constraints()
    independent = rank(jacobian)
    links = [model.body(k).name for k in range(1, model.nbody)]

    def poses(value: float) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        data.joint(joint).qpos[0] = value
        close()
        return {link: (data.body(link).xpos.copy(), data.body(link).xmat.reshape(3, 3).copy()) for link in links}

    start = float(data.joint(joint).qpos[0])
    begin, to = ends
    begin = start if begin is None else begin
    drive = f"{joint}={begin!r}:{begin + to!r}"
    counts = model.nv - independent, len(open_by) - independent
    compare(name, command, imported(command, folder, file), drive, poses, counts)


def check_pinocchio(command: str, folder: Path) -> None:
    """A gripper with `mimic` and loops; Pinocchio has the Jacobians of its frames."""
    import pinocchio as pin

    names = [f"{side} {part}" for side in SIDES for part in ("knuckle", "inner", "finger")]
    links = "".join(f'<link name="{name}"/>' for name in names)
    urdf, loops = folder / "gripper.urdf", folder / "gripper-loops.toml"
    urdf.write_text(GRIPPER.format(links=links))
    text = 'kind = "loops"\nunits = { length = "m", angle = "rad" }\n'
    for side in SIDES:
        frames = ", ".join(f"{{ point = {list(point)}, axis = [1, 0, 0] }}" for point in (PIN_ON_FINGER, PIN_ON_INNER))
        text += f'[[joint]]\nname = "{side} pin"\nkind = "spherical"\nlinks = ["{side} finger", "{side} inner"]\n'
        text += f"frames = [{frames}]\n"
    loops.write_text(text)
    model = pin.buildModelFromXML(urdf.read_text())
    data = model.createData()
    index = {name: model.joints[model.getJointId(name)].idx_v for name in model.names[1:]}

    def constraints(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        pin.computeJointJacobians(model, data, q)
        open_by, rows = [], []
        for side in SIDES:
            ends = []
            for link, point in ((f"{side} finger", PIN_ON_FINGER), (f"{side} inner", PIN_ON_INNER)):
                joint = model.getJointId(link if link in index else side)
                place = data.oMi[joint] * pin.SE3(np.eye(3), np.array(point))
                whole = pin.getJointJacobian(model, data, joint, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
                arm = place.translation - data.oMi[joint].translation
                ends.append((place.translation, whole[:3] - pin.skew(arm) @ whole[3:]))
            open_by.append(ends[0][0] - ends[1][0])
            rows.append(ends[0][1] - ends[1][1])
        mimic = np.zeros((1, model.nv))
        mimic[0, index["right"]], mimic[0, index["left"]] = 1.0, -0.8
        return np.concatenate([*open_by, mimic @ q]), np.vstack([*rows, mimic])

    free = [k for k in range(model.nv) if k != index["left"]]
    q = pin.neutral(model)

    def close() -> None:
        for _ in range(50):
            open_by, jacobian = constraints(q)
            if np.abs(open_by).max() < 1e-14:
                break
            q[free] -= np.linalg.lstsq(jacobian[:, free], open_by, rcond=RANK)[0]

    def poses(value: float) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        q[index["left"]] = value
        close()
        pin.forwardKinematics(model, data, q)
        found = {}
        for side in SIDES:
            for part, joint in (("knuckle", side), ("inner", f"{side} inner"), ("finger", f"{side} finger")):
                pose = data.oMi[model.getJointId(joint)]
                found[f"{side} {part}"] = pose.translation.copy(), pose.rotation.copy()
        return found

    close()
    open_by, jacobian = constraints(q)
    independent = rank(jacobian)
    counts = model.nv - independent, len(open_by) - independent
    file = imported(command, folder, urdf, "--loops", str(loops))
    compare("gripper (Pinocchio)", command, file, "left=0:0.5", poses, counts)


def check(command: str, folder: Path) -> None:
    """All models that MuJoCo evaluates."""
    for text, joint, by in MODELS:
        check_mujoco(command, folder, text, joint, (None, by))


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--jointplay", default="jointplay", help="the command")
    options.add_argument("--pinocchio", action="store_true", help="also compare with Pinocchio")
    options.add_argument("--model", nargs=2, action="append", default=[], metavar=("FILE", "JOINT=FROM:BY"))
    arguments = options.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        check(arguments.jointplay, folder)
        for file, drive in arguments.model:
            joint, ends = drive.split("=")
            begin, by = ends.split(":")
            check_mujoco(arguments.jointplay, folder, file, joint, (float(begin), float(by)))
        if arguments.pinocchio:
            check_pinocchio(arguments.jointplay, folder)


if __name__ == "__main__":
    main()
