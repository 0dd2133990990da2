"""Compiles and runs programs in C, C++ and C# against the installed C library, and compares its answers.

Run by `cargo xtask c`, with the path of the `jointplay` command; the folder of the installed library is in
JOINTPLAY_PREFIX. The documents of the JSON requests are compared with those that the command prints.
In an environment of its own it runs `test_fmu.py`, which simulates functional mock-up units.
With `--prepare` it only makes that environment, and installs the C# compiler where there is none and Debian's can be installed.
Everything that it makes is in `target/c`.
"""

from __future__ import annotations

import ctypes
import json
import math
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CRATE = ROOT / "crates" / "jointplay-c"
HOME = ROOT / "target" / "c"
# Compiler and runtime of C#.
MONO = ["mcs", "mono"]
DEBIAN = ["mono-mcs", "mono-runtime", "libmono-system-core4.0-cil"]
# FMPy, with those of its dependencies that reading and simulating units needs.
PACKAGES = ["fmpy==0.3.32", "attrs==26.1.0", "lark==1.3.1", "lxml==6.1.3", "msgpack==1.2.4", "numpy==2.2.6"]


def report(text: str) -> None:
    print(f"--- {text}", flush=True)


def run(command: list[str | Path], **environment: str) -> str:
    """The standard output of a command; if it fails, so does this program."""
    words = [str(part) for part in command]
    done = subprocess.run(
        words, capture_output=True, text=True, check=False, env=os.environ | environment, cwd=HOME
    )
    if done.returncode != 0:
        sys.exit(f"failed with exit code {done.returncode}: {' '.join(words)}\n{done.stdout}{done.stderr}")
    return done.stdout


def need(name: str, remedy: str) -> str:
    found = shutil.which(name)
    if found is None:
        sys.exit(f"{name} is not found; {remedy}")
    return found


def environment() -> Path:
    """A Python of our own with FMPy; made once."""
    folder = HOME / "python"
    python = folder / ("Scripts" if os.name == "nt" else "bin") / "python"
    mark, wanted = folder / "packages.txt", "\n".join(PACKAGES)
    if not mark.exists() or mark.read_text() != wanted:
        venv.create(folder, with_pip=True, clear=True)
        run([python, "-m", "pip", "install", "--quiet", "--no-compile", "--no-deps", *PACKAGES])
        mark.write_text(wanted)
    return python


def prepare() -> None:
    environment()
    if all(shutil.which(name) for name in MONO) or not shutil.which("apt-get"):
        return
    report("no C# compiler found: installing Mono of Debian by apt-get")
    sudo = [] if os.geteuid() == 0 else ["sudo"]
    quiet = {"DEBIAN_FRONTEND": "noninteractive"}
    # One program at a time: another may be installing a browser.
    apt = ["flock", ROOT / "target" / "apt.lock", *sudo, "apt-get"]
    run([*apt, "update", "-qq"], **quiet)
    run([*apt, "install", "-y", "-qq", "--no-install-recommends", *DEBIAN], **quiet)


def flags(prefix: Path) -> list[str]:
    """What pkg-config prints, which is on most machines, or what it would print."""
    configuration = prefix / "lib" / "pkgconfig"
    if shutil.which("pkg-config"):
        found = run(
            ["pkg-config", "--cflags", "--libs", "jointplay"],
            PKG_CONFIG_PATH=str(configuration),
            PKG_CONFIG_ALLOW_SYSTEM_CFLAGS="1",
        )
        return found.split()
    report("pkg-config is not found: flags without it")
    return [f"-I{prefix / 'include'}", f"-L{prefix / 'lib'}", "-ljointplay"]


def value(output: str, label: str) -> list[float]:
    """The numbers of a line of an example."""
    (line,) = [line for line in output.splitlines() if line.startswith(label)]
    numbers = []
    for word in line[len(label) :].split():
        try:
            numbers.append(float(word))
        except ValueError:
            pass
    return numbers


def near(what: str, found: list[float], expected: list[float], threshold: float) -> None:
    if len(found) != len(expected) or any(abs(a - b) > threshold for a, b in zip(found, expected)):
        sys.exit(f"{what}: {found}, expected {expected} within {threshold}")


def compiled(prefix: Path, command: Path) -> None:
    """Examples in C and C++, the first also with the address sanitizer."""
    libraries = prefix / "lib"
    path = {"LD_LIBRARY_PATH": str(libraries), "DYLD_LIBRARY_PATH": str(libraries)}
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-O1", "-g"]
    c, cpp = need("cc", "install a C compiler"), need("c++", "install a C++ compiler")
    language = {"robot.c": [c, "-std=c99"], "robot.cpp": [cpp, "-std=c++17", "-pthread"]}
    outputs = {}
    for name, start in language.items():
        program = HOME / name.replace(".", "-")
        run([*start, *strict, CRATE / "examples" / name, *flags(prefix), "-lm", "-o", program])
        outputs[name] = run([program], **path)
        checked = program.with_suffix(".checked")
        run([*start, *strict, "-fsanitize=address,undefined", CRATE / "examples" / name, *flags(prefix), "-lm", "-o", checked])
        if run([checked], **path) != outputs[name]:
            sys.exit(f"{name}: another output with sanitizers")
        report(f"{name}: compiled without warnings, run, also with the address and undefined behaviour sanitizers")
    words = ["--azimuth-deg", "17", "--tilt-deg", "1.5", "--height-mm", "500", "--virtualization", "radial"]
    document = json.loads(run([command, "inverse", *words, "--format", "json"]))
    robot = outputs["robot.c"]
    near("rods", value(robot, "rods (mm)"), document["q_mm"], 1e-6)
    shift = [1e3 * x for x in document["platform"]["center_shift_mm"]]
    near("shift", value(robot, "shift (um)"), shift, 1e-3)
    if "mobility in JSON     1\n" not in robot or "limits exceeded      1 0 0, tilt 1\n" not in robot:
        sys.exit(f"robot.c:\n{robot}")
    if "error: " not in outputs["robot.cpp"]:
        sys.exit(f"robot.cpp:\n{outputs['robot.cpp']}")
    csharp(prefix, robot)


def csharp(prefix: Path, robot: str) -> None:
    """The example in C# prints the numbers of that in C."""
    compiler, runtime = (need(name, "install Mono, on Debian mono-mcs and mono-runtime") for name in MONO)
    program = HOME / "Robot.exe"
    sources = [CRATE / "examples" / "Robot.cs", CRATE / "bindings" / "Jointplay.cs"]
    run([compiler, "-warnaserror", "-warn:4", "-nowarn:1591", f"-out:{program}", *sources])
    output = run([runtime, program], LD_LIBRARY_PATH=str(prefix / "lib"))
    for label in ("rods (mm)", "shift (um)", "virtual joints (um)", "mobility in JSON", "platform"):
        near(f"C#: {label}", value(output, label), value(robot, label), 1e-9)
    if "error 2             with its text\n" not in output:
        sys.exit(f"Robot.cs:\n{output}")
    report("Robot.cs: compiled without warnings, run by Mono, the numbers of robot.c")


def add_in(prefix: Path, command: Path) -> None:
    """The add-in for SolidWorks, compiled against stubs, moves recording components as the command does."""
    if sys.platform != "linux":
        return
    tests = CRATE.parent.parent / "cad" / "solidworks" / "test.sh"
    output = run(["sh", tests, command, prefix / "lib" / "libjointplay.so"])
    if output != "passed, with a table of the command and the library\n":
        sys.exit(f"test.sh:\n{output}")
    report("SolidWorks: playback and add-in, run by Mono with recording stubs")


def same(what: str, found: object, expected: object) -> None:
    """The same document; numbers differ by the round-off of the units of the requests."""
    if isinstance(found, dict) and isinstance(expected, dict):
        if list(found) != list(expected):
            sys.exit(f"{what}: keys {list(found)}, expected {list(expected)}")
        for key, one in found.items():
            same(f"{what}.{key}", one, expected[key])
    elif isinstance(found, list) and isinstance(expected, list) and len(found) == len(expected):
        for i, (one, other) in enumerate(zip(found, expected)):
            same(f"{what}[{i}]", one, other)
    elif isinstance(found, float) and isinstance(expected, float):
        if not math.isclose(found, expected, rel_tol=1e-9, abs_tol=1e-9):
            sys.exit(f"{what}: {found!r}, expected {expected!r}")
    elif found != expected:
        sys.exit(f"{what}: {found!r}, expected {expected!r}")


def documents(prefix: Path, command: Path) -> None:
    """JSON requests are answered by the documents that the command prints."""
    name = "libjointplay.dylib" if sys.platform == "darwin" else "libjointplay.so"
    library = ctypes.CDLL(str(prefix / "lib" / name))
    library.jp_text_free.argtypes = [ctypes.c_void_p]

    def error() -> str:
        text = ctypes.create_string_buffer(1000)
        library.jp_last_error(text, ctypes.c_size_t(1000))
        return text.value.decode()

    def ask(kind: str, handle: ctypes.c_void_p, request: dict[str, object]) -> object:
        answer = ctypes.c_void_p()
        code = getattr(library, f"jp_{kind}_json")(handle, json.dumps(request).encode(), ctypes.byref(answer))
        if code != 0:
            sys.exit(f"{request}: {code}: {error()}")
        text = ctypes.string_at(answer.value or 0)
        library.jp_text_free(answer)
        return json.loads(text)

    def printed(*words: str) -> object:
        return json.loads(run([command, *words, "--format", "json"]))

    robot = ctypes.c_void_p()
    assert library.jp_robot_paper(ctypes.byref(robot)) == 0
    tilt = {"azimuth_rad": math.radians(17), "tilt_rad": math.radians(1.5)}
    tilted = ("--azimuth-deg", "17", "--tilt-deg", "1.5")
    polar = {"virtualization": "polar"}
    cases: list[tuple[dict[str, object], tuple[str, ...]]] = [
        ({"kind": "forward", "rods_m": [0.499, 0.5, 0.501]}, ("forward", "--q-mm", "499,500,501")),
        ({"kind": "inverse", **tilt, **polar}, ("inverse", *tilted, "--virtualization", "polar")),
        ({"kind": "mobility", **polar}, ("mobility", "--virtualization", "polar")),
        ({"kind": "sensitivity", **tilt}, ("sensitivity", *tilted)),
    ]
    for request, words in cases:
        same(" ".join(words), ask("robot", robot, request), printed(*words))
    count = len(cases)
    library.jp_robot_free(robot)
    of_mechanisms: list[tuple[str, dict[str, object], tuple[str, ...]]] = [
        ("four-bar", {"kind": "assemble", "at": {"A": math.radians(30)}}, ("assemble", "four-bar", "--at", "A=30")),
        ("bennett", {"kind": "mobility"}, ("mobility", "bennett")),
        ("gpr-mechanism", {"kind": "mobility"}, ("mobility", "gpr-mechanism")),
        ("four-bar", {"kind": "jacobian"}, ("jacobian", "four-bar")),
        (
            "gpr-mechanism",
            {"kind": "sensitivity", "command": {"rod 1": 0.001, "rod 2": -0.001}},
            ("sensitivity", "gpr-mechanism", "--command", "rod 1=1,rod 2=-1"),
        ),
        (
            "four-bar",
            {"kind": "move", "to": {"A": math.radians(90)}, "steps": 6, "poses": True},
            ("move", "four-bar", "--drive", "A=:90", "--steps", "6", "--poses"),
        ),
        (
            "gpr-mechanism",
            {"kind": "move", "to": {"rod 1": 0.001}, "steps": 4, "free": ["rod 2"]},
            ("move", "gpr-mechanism", "--drive", "rod 1=:1", "--steps", "4", "--free", "rod 2"),
        ),
        (
            "parallelogram",
            {"kind": "suggest", "commands": [{"A1": math.radians(s * 5), "A2": math.radians(s * 4.9)} for s in (1, -1)]},
            ("suggest", "parallelogram", "--command", "A1=5,A2=4.9", "--command", "A1=-5,A2=-4.9"),
        ),
        (
            "gpr-mechanism",
            {"kind": "suggest", "rank": "largest", "symmetric": True, "limit": 2000},
            ("suggest", "gpr-mechanism", "--rank", "largest", "--symmetric", "--limit", "2000"),
        ),
    ]
    for name, request, words in of_mechanisms:
        mechanism = ctypes.c_void_p()
        assert library.jp_mechanism_catalogue(name.encode(), ctypes.byref(mechanism)) == 0, error()
        same(" ".join(words), ask("mechanism", mechanism, request), printed(*words))
        library.jp_mechanism_free(mechanism)
    report(f"{count + len(of_mechanisms)} documents are those of the command")


def main() -> None:
    HOME.mkdir(parents=True, exist_ok=True)
    prepare()
    if "--prepare" in sys.argv:
        return
    prefix, command = Path(os.environ["JOINTPLAY_PREFIX"]).resolve(), Path(sys.argv[1]).resolve()
    compiled(prefix, command)
    add_in(prefix, command)
    documents(prefix, command)
    print(run([environment(), CRATE / "test_fmu.py", command], JOINTPLAY_PREFIX=str(prefix)), end="")


if __name__ == "__main__":
    main()
