#!/usr/bin/env python3
"""Runs the same work in jointplay and in other programs, and writes tables, charts and all numbers.

    python3 bench/run.py                 everything, into bench/results
    python3 bench/run.py --rounds 3      fewer rounds
    python3 bench/run.py --only gpr      one work: gpr, linkages, words or scaling
    python3 bench/run.py --avx2 --out F  all programs as on a processor without AVX-512, into a folder of its own
    python3 bench/run.py --write-docs    no run: tables of README.md and docs from bench/results

After a run it compares the ratios of jointplay to the best other program with the recorded ones, and ends with 1 if one
lost more than a tenth.

It needs Python 3.11, a C++ compiler, cargo, and the network once, for the packages of bench/requirements.txt.
What cannot be installed, built or run is reported as missing, with the reason.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "harness"))
import kernels  # noqa: E402
import limits  # noqa: E402
import ratios  # noqa: E402

VENV = HERE / ".venv"
BUILD = HERE / ".build"
PYTHON = VENV / "bin" / "python"
WORKS = ["gpr", "linkages", "words", "scaling"]


# What to remove of the sources of jointplay, by file, so that its widest vectors are those of AVX2.
AVX_512 = {
    "Cargo.toml": b'"x86-v4", ',
    "crates/jointplay-core/src/bulk/instruction_set.rs": b'        Arch::V4(_) => "AVX-512",\n',
}


class Processor:
    """What programs are built for."""

    def __init__(self, avx2):
        self.build, self.march, self.sources, self.environment = BUILD, "-march=native", HERE.parent, {}
        if avx2:
            numba = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
            self.environment = {**numba, "XLA_FLAGS": "--xla_cpu_max_isa=AVX2"}
            self.build, self.march = BUILD / "avx2", "-march=x86-64-v3"
            self.sources = self.build / "sources"
            self.copy_sources()
        self.build.mkdir(parents=True, exist_ok=True)

    def copy_sources(self):
        """Copies the files of the repository that git knows, without what is for AVX-512."""
        listed = run(["git", "ls-files"], cwd=HERE.parent)
        if listed.returncode != 0:
            sys.exit(f"--avx2 needs a clone of the repository and git:\n{listed.stderr}")
        for name in listed.stdout.splitlines():
            copy = self.sources / name
            copy.parent.mkdir(parents=True, exist_ok=True)
            text = (HERE.parent / name).read_bytes()
            if name in AVX_512:
                text = text.replace(AVX_512[name], b"")
            if not copy.exists() or copy.read_bytes() != text:
                copy.write_bytes(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=7, help="rounds, of which the best counts (default 7)")
    parser.add_argument("--only", choices=WORKS, action="append", help="this work alone; may be repeated")
    parser.add_argument("--out", type=Path, default=HERE / "results", help="folder for the results")
    parser.add_argument("--avx2", action="store_true", help="as on a processor without AVX-512; needs --out")
    parser.add_argument("--write-docs", action="store_true", help="write the tables of README.md and docs, and run nothing")
    arguments = parser.parse_args()
    if arguments.write_docs:
        python = PYTHON if PYTHON.exists() else sys.executable
        return subprocess.run([python, HERE / "harness" / "documents.py", arguments.out, HERE.parent]).returncode
    if arguments.rounds < 1:
        parser.error("--rounds has to be at least 1")
    if arguments.avx2 and arguments.out == HERE / "results":
        parser.error("--avx2 needs --out: the results of the repository are those of the whole processor")
    processor = Processor(arguments.avx2)
    missing = {**install(), **build(processor)}
    processor.build.joinpath("missing.json").write_text(json.dumps(missing))
    only = arguments.only or WORKS
    recorded = ratios.rows(only_of(only, ratios.load(HERE / "results")))
    command = [PYTHON, HERE / "harness" / "compare.py", processor.build, arguments.out, str(arguments.rounds), *only]
    done = subprocess.run(command, env=one_thread(processor)).returncode
    if done != 0 or arguments.avx2:
        return done
    found = ratios.rows(only_of(only, ratios.load(arguments.out)))
    print("\n".join(ratios.compared(recorded, found)))
    return 1 if ratios.lost(recorded, found) else 0


def only_of(only, results):
    """The results of some works."""
    return {work: document for work, document in results.items() if work in only}


def one_thread(processor):
    """The environment, with libraries limited to one thread: all rates are those of one core."""
    names = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"]
    limited = {name: "1" for name in names}
    return {**os.environ, **limited, **processor.environment, "PYTHONPATH": str(HERE / "harness")}


def install():
    """Makes the environment; returns what could not be installed, with the reason."""
    if not PYTHON.exists():
        print("making bench/.venv", flush=True)
        venv.create(VENV, with_pip=True)
    wanted = [line.strip() for line in (HERE / "requirements.txt").read_text().splitlines()]
    wanted = [line for line in wanted if line and not line.startswith("#")]
    listed = run([PYTHON, "-m", "pip", "freeze"]).stdout.splitlines()
    missing = {}
    for line in wanted:
        if line not in listed:
            print(f"installing {line}", flush=True)
            done = run([PYTHON, "-m", "pip", "install", "--quiet", line])
            if done.returncode != 0:
                missing[line.split("==")[0]] = reason(done)
    return missing


def build(processor):
    """Builds the compiled workers; returns what could not be built, with the reason."""
    folder, march = processor.build, processor.march
    print("building", flush=True)
    site = next(VENV.glob("lib/python*/site-packages"))
    prefix = site / "cmeel.prefix"
    missing = {}
    made = run(["cargo", "build", "--profile", "dist", "-p", "jointplay-bench", "--message-format", "json"], cwd=processor.sources)
    if made.returncode != 0:
        sys.exit(f"jointplay does not build:\n{made.stderr}")
    artifacts = [json.loads(line) for line in made.stdout.splitlines() if line.startswith("{")]
    binary = next(artifact["executable"] for artifact in artifacts if artifact.get("executable"))
    link(folder / "jointplay", Path(binary))
    compiler = [os.environ.get("CXX", "c++"), "-std=c++17", "-O3", "-DNDEBUG", f"-I{prefix}/include/eigen3"]
    # The definitions are those that Pinocchio's own build files ask of its users.
    pinocchio = [
        "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
        "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
        "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
        "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
        f"-I{prefix}/include",
        f"-L{prefix}/lib",
        f"-Wl,-rpath,{prefix}/lib",
    ]
    mujoco = [f"-I{site}/mujoco/include", *site.glob("mujoco/libmujoco.so*"), f"-Wl,-rpath,{site}/mujoco"]
    for name, flags in [("pinocchio", pinocchio), ("mujoco", mujoco)]:
        source, out = HERE / "peers" / f"{name}.cpp", folder / name
        inputs = [source, *(HERE / "peers").glob("*.hpp"), HERE / "requirements.txt"]
        if out.exists() and all(out.stat().st_mtime > path.stat().st_mtime for path in inputs):
            continue
        done = run([*compiler, source, "-o", out, *flags])
        if done.returncode != 0:
            out.unlink(missing_ok=True)
            missing[f"{name} (compiled)"] = reason(done)
    missing |= build_wheel(processor)
    missing |= limits.build(folder, march, run, reason)
    return {**missing, **kernels.build(folder, march, HERE / "peers", PYTHON, run, reason)}


def build_wheel(processor):
    """Builds jointplay's Python package and installs it; the version does not show whether it is the newest, so it is always rebuilt."""
    wheels = processor.build / "wheels"
    shutil.rmtree(wheels, ignore_errors=True)
    maturin = [PYTHON, "-m", "maturin", "build", "--profile", "dist", "--quiet", "--interpreter", PYTHON, "--out", wheels]
    done = run(maturin, cwd=processor.sources / "python")
    if done.returncode == 0:
        install = [PYTHON, "-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps", *wheels.glob("*.whl")]
        done = run(install)
    return {} if done.returncode == 0 else {"jointplay, from Python": reason(done)}


def run(command, cwd=None, env=None):
    words = [str(word) for word in command]
    try:
        return subprocess.run(words, capture_output=True, text=True, cwd=cwd, env=env)
    except FileNotFoundError as error:
        return subprocess.CompletedProcess(words, 127, "", str(error))


def link(path, target):
    path.unlink(missing_ok=True)
    path.symlink_to(target)


def reason(done):
    """The first line of the output of a failed command that looks like the reason."""
    lines = [line.strip() for line in done.stderr.splitlines() if line.strip()]
    reasons = [line for line in lines if "rror" in line] or lines[-1:] or ["no output"]
    return reasons[0][:300]


if __name__ == "__main__":
    sys.exit(main())
