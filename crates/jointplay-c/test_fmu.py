"""Simulates exported functional mock-up units by FMPy, and compares them with the C library.

Run by `test.py`, in an environment that has FMPy, with the path of the `jointplay` command; the folder of the
installed library is in JOINTPLAY_PREFIX. Each unit is validated and simulated in FMI 2.0 and 3.0. Positions and
displacements are those of the functions in `jointplay.h` to the bit; directional derivatives are compared with
differences, and states are saved, restored and serialized.

    test_fmu.py COMMAND --time    time of a step instead, as a simulator calls it
"""

from __future__ import annotations

import ctypes
import math
import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, defaultCallbacks, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

ROOT = Path(__file__).resolve().parents[2]
STRANGERS = ROOT / "crates" / "jointplay-interop" / "tests" / "fmu"
PREFIX = Path(os.environ["JOINTPLAY_PREFIX"])
LIBRARY = PREFIX / "lib" / ("libjointplay.dylib" if sys.platform == "darwin" else "libjointplay.so")
# File or name, amplitude of the drives (m, rad).
MECHANISMS: list[tuple[str | Path, float]] = [
    ("gpr-mechanism", 1e-3),
    ("hexapod", 0.01),
    ("four-bar", 0.8),
    (STRANGERS / "table.toml", 0.004),
    (STRANGERS / "head.toml", 0.3),
    (STRANGERS / "lamp.toml", 0.02),
]
VIRTUALIZATIONS = ["radial", "polar", "offset", "planar"]
ROBOTS: list[str | Path] = ["gpr", STRANGERS / "tripod.toml"]
STEP = 0.01
STEPS = 25


def fail(text: str) -> None:
    sys.exit(f"units: {text}")


def export(command: Path, subject: str | Path, folder: Path, *flags: str) -> Path:
    """The unit of a mechanism or robot."""
    words = [str(command), "export", str(subject), "--to", "fmu", "--out", str(folder), "--library", str(LIBRARY), *flags]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        fail(f"{' '.join(words)}\n{done.stderr}")
    (unit,) = folder.glob("*.fmu")
    return unit


class Unit:
    """An instance of a unit of either version, in step mode."""

    def __init__(self, path: Path, folder: Path) -> None:
        self.description = fmpy.read_model_description(str(path))
        self.inputs = [one for one in self.description.modelVariables if one.causality == "input"]
        self.outputs = [one for one in self.description.modelVariables if one.causality == "output"]
        self.is_third = self.description.fmiVersion.startswith("3")
        self.messages: list[str] = []
        if not folder.exists():
            fmpy.extract(str(path), str(folder))
        self.fmu = (FMU3Slave if self.is_third else FMU2Slave)(
            guid=self.description.guid if not self.is_third else self.description.instantiationToken,
            unzipDirectory=str(folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="unit",
        )
        if self.is_third:
            self.fmu.instantiate(logMessage=lambda *message: self.messages.append(message[-1].decode()))
            self.fmu.enterInitializationMode(startTime=0.0)
        else:
            callbacks = fmi2CallbackFunctions()
            callbacks.logger = fmi2CallbackLoggerTYPE(lambda *message: self.messages.append(message[-1].decode()))
            callbacks.allocateMemory, callbacks.freeMemory = defaultCallbacks.allocateMemory, defaultCallbacks.freeMemory
            self.fmu.instantiate(callbacks=callbacks)
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        self.time = 0.0

    def references(self, variables: list[object]) -> list[int]:
        return [one.valueReference for one in variables]  # type: ignore[attr-defined]

    def set(self, values: list[float]) -> None:
        setter = self.fmu.setFloat64 if self.is_third else self.fmu.setReal
        setter(self.references(self.inputs), values)

    def step(self) -> None:
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=STEP)
        self.time += STEP

    def get(self) -> list[float]:
        getter = self.fmu.getFloat64 if self.is_third else self.fmu.getReal
        return list(getter(self.references(self.outputs)))

    def rates(self, seed: list[float]) -> list[float]:
        known, unknown = self.references(self.inputs), self.references(self.outputs)
        return list(self.fmu.getDirectionalDerivative(unknown, known, seed))

    def save(self) -> ctypes.c_void_p:
        return self.fmu.getFMUState() if self.is_third else self.fmu.getFMUstate()

    def restore(self, state: ctypes.c_void_p) -> None:
        (self.fmu.setFMUState if self.is_third else self.fmu.setFMUstate)(state)

    def free(self, state: ctypes.c_void_p) -> None:
        (self.fmu.freeFMUState if self.is_third else self.fmu.freeFMUstate)(state)

    def through_bytes(self, state: ctypes.c_void_p) -> ctypes.c_void_p:
        if self.is_third:
            return self.fmu.deserializeFMUState(self.fmu.serializeFMUState(state))
        return self.fmu.deSerializeFMUstate(self.fmu.serializeFMUstate(state))

    def close(self) -> None:
        self.fmu.terminate()
        self.fmu.freeInstance()


def path(start: list[float], amplitude: float) -> Iterator[list[float]]:
    """Values of the drives, each with its own phase, from their initial values."""
    for step in range(1, STEPS + 1):
        yield [value + amplitude * (math.sin(0.1 * step + k) - math.sin(k)) for k, value in enumerate(start)]


def c_library() -> ctypes.CDLL:
    library = ctypes.CDLL(str(LIBRARY))
    library.jp_mechanism_link_name.restype = ctypes.c_char_p
    library.jp_mechanism_coordinate_name.restype = ctypes.c_char_p
    for name in ("coordinate_count", "joint_coordinate_count", "link_count", "drive_count"):
        getattr(library, f"jp_mechanism_{name}").restype = ctypes.c_size_t
    return library


Compute = Callable[[list[float]], tuple[list[list[float]], list[float]]]


def by_mechanism(library: ctypes.CDLL, subject: str | Path) -> Compute:
    """Transforms of the links but the base, by rows, and displacements, by the functions for mechanisms."""
    handle = ctypes.c_void_p()
    text = subject.read_bytes() if isinstance(subject, Path) else subject.encode()
    make = library.jp_mechanism_parse if isinstance(subject, Path) else library.jp_mechanism_catalogue
    assert make(text, ctypes.byref(handle)) == 0
    count, links = library.jp_mechanism_coordinate_count(handle), library.jp_mechanism_link_count(handle)
    joints = library.jp_mechanism_joint_coordinate_count(handle)
    positions = (ctypes.c_double * count)()
    poses = (ctypes.c_double * (16 * links))()
    assert library.jp_mechanism_home(handle, positions) == 0

    def compute(drives: list[float]) -> tuple[list[list[float]], list[float]]:
        assert library.jp_mechanism_positions(handle, (ctypes.c_double * len(drives))(*drives), positions) == 0
        assert library.jp_mechanism_link_poses(handle, positions, poses) == 0
        return [poses[16 * k : 16 * k + 16] for k in range(1, links)], positions[joints:]

    return compute


def by_robot(library: ctypes.CDLL, subject: str | Path, virtualization: int) -> Compute:
    """Transform of the platform and displacements, by the functions for robots."""
    handle = ctypes.c_void_p()
    text = subject.read_bytes() if isinstance(subject, Path) else (ROOT / "crates/jointplay-format/robots" / f"{subject}.toml").read_bytes()
    assert library.jp_robot_parse(text, ctypes.byref(handle)) == 0
    count = [3, 6, 6, 6][virtualization]

    def compute(drives: list[float]) -> tuple[list[list[float]], list[float]]:
        pose, joints = (ctypes.c_double * 16)(), (ctypes.c_double * 6)()
        rods = (ctypes.c_double * 3)(*drives)
        assert library.jp_robot_forward(handle, virtualization, rods, pose, joints, None) == 0
        return [list(pose)], joints[:count]

    return compute


def check_outputs(name: str, outputs: list[float], expected: tuple[list[list[float]], list[float]]) -> None:
    """Positions and displacements to the bit, quaternions by their rotation."""
    transforms, displacements = expected
    for k, rows in enumerate(transforms):
        *position, w, x, y, z = outputs[7 * k : 7 * k + 7]
        if position != [rows[3], rows[7], rows[11]]:
            fail(f"{name}: position {position} of link {k}, the library has {[rows[3], rows[7], rows[11]]}")
        turn = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        if not np.allclose(turn, [rows[0:3], rows[4:7], rows[8:11]], rtol=0, atol=1e-14):
            fail(f"{name}: orientation of link {k}")
    if outputs[len(outputs) - len(displacements) :] != list(displacements):
        fail(f"{name}: displacements {outputs[-len(displacements):]}, the library has {list(displacements)}")


def check_rates(name: str, unit: Unit, drives: list[float]) -> None:
    """Directional derivatives against central differences of steps from one state."""
    h, seed = 1e-5, [1.0 - 0.37 * k for k in range(len(drives))]
    found, state = unit.rates(seed), unit.save()
    moved = []
    for sign in (1, -1):
        unit.restore(state)
        unit.set([value + sign * h * rate for value, rate in zip(drives, seed)])
        unit.step()
        moved.append(unit.get())
    unit.restore(state)
    unit.free(state)
    expected = (np.array(moved[0]) - np.array(moved[1])) / (2 * h)
    if not np.allclose(found, expected, rtol=0, atol=2e-6):
        fail(f"{name}: directional derivatives {found}, differences {expected.tolist()}")


def check_refusals(name: str, unit: Unit) -> None:
    """A step that cannot be done is discarded; values and later steps are as if it had not been tried."""
    before, state = unit.get(), unit.save()
    start = [float(one.start) for one in unit.inputs]
    for values, status in (([1e6] * len(start), (2, 3)), ([math.nan] * len(start), (3,))):
        try:
            unit.set(values)
            unit.step()
        except FMICallException as refused:
            if refused.status not in status:
                fail(f"{name}: status {refused.status} of a step to {values[0]}")
        else:
            fail(f"{name}: a step to {values[0]} was done")
        if unit.get() != before:
            fail(f"{name}: a refused step has changed the outputs")
    if not any("too large" in text or "limits" in text for text in unit.messages):
        fail(f"{name}: messages {unit.messages}")
    unit.restore(state)
    unit.free(state)


def check(name: str, path_of_unit: Path, folder: Path, amplitude: float, compute: Compute) -> None:
    """One unit, in all respects."""
    problems = validate_fmu(str(path_of_unit))
    if problems:
        fail(f"{name}: FMPy finds {problems}")
    unit = Unit(path_of_unit, folder)
    start = [float(one.start) for one in unit.inputs]
    kept = None
    after: list[list[float]] = []
    for k, drives in enumerate(path(start, amplitude)):
        unit.set(drives)
        unit.step()
        outputs = unit.get()
        check_outputs(f"{name}, step {k}", outputs, compute(drives))
        if kept is not None:
            after.append(outputs)
        if k == STEPS // 2:
            check_rates(name, unit, drives)
            check_refusals(name, unit)
            saved = unit.save()
            kept = unit.through_bytes(saved)
            unit.free(saved)
    # The state of the bytes leads to the same outputs again.
    assert kept is not None
    unit.restore(kept)
    again = []
    for drives in list(path(start, amplitude))[STEPS // 2 + 1 :]:
        unit.set(drives)
        unit.step()
        again.append(unit.get())
    if again != after:
        fail(f"{name}: other outputs after a state was restored")
    unit.free(kept)
    unit.close()
    simulate(name, path_of_unit, amplitude)


def simulate(name: str, path_of_unit: Path, amplitude: float) -> None:
    """The loop of FMPy itself."""
    description = fmpy.read_model_description(str(path_of_unit))
    inputs = [one for one in description.modelVariables if one.causality == "input"]
    times = np.linspace(0, 1, 51)
    signal = np.zeros(len(times), dtype=[("time", float)] + [(one.name, float) for one in inputs])
    signal["time"] = times
    for k, one in enumerate(inputs):
        signal[one.name] = float(one.start) + amplitude * (np.sin(2 * times + k) - math.sin(k))
    result = fmpy.simulate_fmu(str(path_of_unit), input=signal, stop_time=1, output_interval=0.02)
    outputs = [one.name for one in description.modelVariables if one.causality == "output"]
    values = np.array([result[name] for name in outputs])
    if values.shape != (len(outputs), len(times)) or not np.isfinite(values).all() or (values.std(axis=1) == 0).all():
        fail(f"{name}: results of FMPy's simulation {values}")


def check_entries() -> None:
    """Every entry of the standard is in the library."""
    library = ctypes.CDLL(str(LIBRARY))
    # Of FMI 2.0 those of units for co-simulation; of FMI 3.0 all, which simulators ask for.
    header = (Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h").read_text()
    declared = re.findall(r"^FMI3_Export\s+fmi\w+\s+(fmi\w+);", header, re.MULTILINE)
    declared += [name for name in dir(FMU2Slave) if name.startswith("fmi2")]
    missing = [name for name in declared if not hasattr(library, name)]
    if missing or len(declared) < 100:
        fail(f"{len(declared)} entries, missing {missing}")
    print(f"--- {len(set(declared))} entries of FMI 2.0 and 3.0", flush=True)


def measure(command: Path, folder: Path) -> None:
    """Time of setting all inputs, a step, and reading all outputs."""
    for subject, amplitude in [("gpr", 5e-4), *MECHANISMS]:
        name = Path(subject).stem
        unit = Unit(export(command, subject, folder / name), folder / name / "unit")
        library, pointer = ctypes.CDLL(unit.fmu.dll._name), ctypes.c_void_p(unit.fmu.component)
        library.fmi2DoStep.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int]
        known = (ctypes.c_uint * len(unit.inputs))(*unit.references(unit.inputs))
        unknown = (ctypes.c_uint * len(unit.outputs))(*unit.references(unit.outputs))
        drives, outputs = (ctypes.c_double * len(known))(), (ctypes.c_double * len(unknown))()
        counts = ctypes.c_size_t(len(known)), ctypes.c_size_t(len(unknown))
        start, best = [float(one.start) for one in unit.inputs], math.inf
        for _ in range(3):
            spent, steps = 0.0, 20_000
            for step in range(steps):
                for k, value in enumerate(start):
                    drives[k] = value + amplitude * (math.sin(0.01 * step + k) - math.sin(k))
                begin = time.perf_counter()
                library.fmi2SetReal(pointer, known, counts[0], drives)
                status = library.fmi2DoStep(pointer, step * 1e-3, 1e-3, 1)
                library.fmi2GetReal(pointer, unknown, counts[1], outputs)
                spent += time.perf_counter() - begin
                assert status == 0
            best = min(best, spent / steps)
        print(f"{name:15} {len(known)} inputs, {len(unknown):2} outputs: {1e6 * best:5.1f} us for a step")


def main() -> None:
    command = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        if "--time" in sys.argv:
            return measure(command, folder)
        check_entries()
        library, count = c_library(), 0
        for version in ("2", "3"):
            for subject, amplitude in MECHANISMS:
                name = f"{Path(subject).stem}, FMI {version}"
                place = folder / f"{Path(subject).stem}-{version}"
                unit = export(command, subject, place, "--fmi", version)
                check(name, unit, place / "unit", amplitude, by_mechanism(library, subject))
                count += 1
            for subject in ROBOTS:
                for k, virtualization in enumerate(VIRTUALIZATIONS):
                    name = f"{Path(subject).stem}, {virtualization}, FMI {version}"
                    place = folder / f"{Path(subject).stem}-{virtualization}-{version}"
                    flags = ("--fmi", version, "--virtualization", virtualization)
                    unit = export(command, subject, place, *flags)
                    check(name, unit, place / "unit", 5e-4, by_robot(library, subject, k))
                    count += 1
        print(f"--- {count} units validated and simulated by FMPy, with the numbers of the library", flush=True)


if __name__ == "__main__":
    main()
