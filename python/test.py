"""Builds the wheel, installs it into clean environments and tests it there.

Run by `cargo xtask python`, as the last step of `cargo xtask test`, with the path of the `jointplay` command.
Everything it makes is in `target/python`: the wheel, its tools, an environment for the oldest and one for the newest
Python that this machine has, what pip downloads for them, and bytecode.
With `--prepare` it only makes the environments.
"""

from __future__ import annotations

import glob
import os
import shutil
import subprocess
import sys
import time
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PYTHON = ROOT / "python"
HOME = ROOT / "target" / "python"
OLDEST, NEWEST = (3, 10), (3, 14)
TOOLS = ["maturin==1.16.0"]


def report(text: str) -> None:
    print(f"--- {text}", flush=True)


def run(command: list[str | Path], **options: object) -> None:
    """Runs a command; if it fails, so does this program."""
    done = subprocess.run([str(part) for part in command], check=False, **options)  # type: ignore[call-overload]
    if done.returncode != 0:
        report(f"failed: {' '.join(map(str, command))}")
        sys.exit(1)


def version(python: str) -> tuple[int, int] | None:
    """The version of an interpreter, if it runs and is a CPython with its usual library."""
    probe = "import sys, ensurepip, venv; print(sys.implementation.name, *sys.version_info[:2])"
    try:
        answer = subprocess.run([python, "-c", probe], capture_output=True, text=True, timeout=30, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return None
    words = answer.stdout.split()
    if answer.returncode != 0 or words[0] != "cpython":
        return None
    return int(words[1]), int(words[2])


def interpreters() -> dict[tuple[int, int], str]:
    """The interpreters of this machine by version: on the path, of pyenv, of uv."""
    minors = range(OLDEST[1], NEWEST[1] + 1)
    places = [sys.executable, *(f"python3.{minor}" for minor in minors)]
    pyenv = os.environ.get("PYENV_ROOT", os.path.expanduser("~/.pyenv"))
    places += sorted(glob.glob(f"{pyenv}/versions/*/bin/python3"))
    places += sorted(glob.glob(os.path.expanduser("~/.local/share/uv/python/cpython-*/bin/python3")))
    found: dict[tuple[int, int], str] = {}
    for place in places:
        known = version(place)
        if known is not None and OLDEST <= known <= NEWEST:
            found.setdefault(known, place)
    return found


def environment(python: str, name: str, packages: list[str]) -> Path:
    """An environment with these packages; one that has them already is kept."""
    folder, wanted = HOME / name, "\n".join([python, *packages])
    stamp = folder / "packages.txt"
    binaries = folder / ("Scripts" if os.name == "nt" else "bin")
    if not stamp.exists() or stamp.read_text() != wanted:
        report(f"environment {folder.relative_to(ROOT)}: {', '.join(packages)}")
        shutil.rmtree(folder, ignore_errors=True)
        if version(sys.executable) == version(python):
            venv.create(folder, with_pip=True)
        else:
            run([python, "-m", "venv", folder])
        # Few of all modules are used, and compiled when they are.
        run([binaries / "python", "-m", "pip", "install", "--quiet", "--no-compile", *packages])
        stamp.write_text(wanted)
    return binaries


def requirements(name: str) -> list[str]:
    lines = (PYTHON / "tests" / name).read_text().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def tested(found: dict[tuple[int, int], str], one: tuple[int, int]) -> Path:
    """The environment in which a Python is tested; the newest also checks types."""
    packages = requirements("requirements.txt")
    if one == max(found):
        packages += requirements("requirements-typing.txt")
    return environment(found[one], f"python-{one[0]}.{one[1]}", packages)


def built_wheel(python: str) -> Path:
    """Builds the wheel."""
    tools = environment(python, "tools", TOOLS)
    wheels = HOME / "wheels"
    shutil.rmtree(wheels, ignore_errors=True)
    # Not the release profile, which optimises across all crates for minutes; the kernels are optimised in either.
    build: list[str | Path] = ["build", "--quiet", "--locked", "--interpreter", python, "--out", wheels]
    # What it is built with where all features of all crates are built; maturin lists what is in it.
    build += ["--features", "jointplay/mcap,jointplay/parquet"]
    run([tools / "maturin", *build], cwd=PYTHON)
    (wheel,) = wheels.glob("*.whl")
    return wheel


def main() -> None:
    start = time.monotonic()
    os.environ["PIP_CACHE_DIR"] = str(HOME / "pip")
    os.environ["PIP_DISABLE_PIP_VERSION_CHECK"] = "1"
    os.environ["PYTHONPYCACHEPREFIX"] = str(HOME / "bytecode")
    os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = str(HOME / "hypothesis")
    found = interpreters()
    if not found:
        report(f"no CPython from 3.{OLDEST[1]} to 3.{NEWEST[1]} found, with its modules venv and ensurepip; install one")
        sys.exit(1)
    oldest, newest = min(found), max(found)
    if oldest == newest:
        report(f"only one Python found: {found[newest]}")
    if "--prepare" in sys.argv:
        environment(found[newest], "tools", TOOLS)
        for one in sorted({oldest, newest}):
            tested(found, one)
        return
    wheel = built_wheel(found[newest])
    report(f"built {wheel.relative_to(ROOT)} after {time.monotonic() - start:.0f} s")
    # The command gives the same numbers.
    os.environ["JOINTPLAY_COMMAND"] = str(Path(sys.argv[1]).resolve())
    for one in sorted({oldest, newest}):
        binaries = tested(found, one)
        python = binaries / "python"
        # With its dependency, numpy, as anybody installs it; what is there already is kept.
        run([python, "-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps", wheel])
        run([python, "-m", "pip", "check", "--quiet"])
        report(f"tests in {found[one]}")
        selected = ["-m", "not once"] if one != newest else []
        run([python, "-m", "pytest", "-p", "no:cacheprovider", "--hypothesis-seed=1", *selected], cwd=PYTHON)
        if one == newest:
            report("types")
            checked = ["src/jointplay", "tests/typed.py", "speed.py", "test.py"]
            run([python, "-m", "mypy", "--cache-dir", HOME / "mypy", *checked], cwd=PYTHON)
            run([python, "-m", "mypy.stubtest", "jointplay", "--concise"], cwd=PYTHON)
            run([binaries / "basedpyright", "--project", PYTHON, "--pythonpath", python, "tests/typed.py"], cwd=PYTHON)
    report(f"Python passed in {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
