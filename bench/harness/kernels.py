"""Builds the closed equations in C: each kernel with each compiler and set of flags; the bench selects the fastest."""

import json
import os
from pathlib import Path

MATH = ["-fno-math-errno", "-ffast-math"]
# Supported answers of sources that do not support all of them.
ANSWERS = {"loop.c": ["x"], "casadi.c": ["x", "least"]}
# Name, source in peers/closed, definitions.
HAND = [
    ("textbook", "hand.c", ["-DTEXTBOOK"]),
    ("hand", "hand.c", []),
    ("vectors", "hand.c", ["-DLANES=8"]),
    ("vectors", "hand.c", ["-DLANES=16"]),
    ("vectors", "loop.c", ["-fopenmp-simd", "-mprefer-vector-width=512"]),
]


def build(build_folder, march, peers, python, run, reason):
    """Builds the kernels, and lists them in closed.json; returns the failed builds with their reasons."""
    optimised = ["-O3", march]
    out = build_folder / "closed"
    out.mkdir(exist_ok=True)
    kernels, missing = list(HAND), {}
    generated = out / "casadi_generated.c"
    work = build_folder / "work"
    run([build_folder / "jointplay", "write", work])
    paths = f"{peers.parent / 'harness'}:{peers}"
    done = run(
        [python, peers / "closed" / "casadi_source.py", work / "gpr.txt", generated],
        env={**os.environ, "PYTHONPATH": paths},
    )
    if done.returncode == 0:
        kernels.append(("casadi", "casadi.c", [f'-DGENERATED="{generated}"']))
    else:
        missing["CasADi, C"] = reason(done)
    inputs = [*peers.glob("*.hpp"), *peers.glob("closed*"), *(peers / "closed").iterdir(), generated]
    newest = max((path.stat().st_mtime for path in inputs if path.is_file()), default=0.0)
    built = []
    for compiler, version in compilers(run).items():
        for name, source, defined in kernels:
            for math in MATH:
                lanes = "".join(word.removeprefix("-DLANES=") for word in defined if "LANES" in word)
                binary = out / f"{name}{lanes}-{Path(compiler).name}{math}"
                if not binary.exists() or binary.stat().st_mtime < newest:
                    done = compile_one(run, compiler, [*optimised, math, *defined], peers, source, binary)
                    if done.returncode != 0:
                        missing[f"C, {binary.name}"] = reason(done)
                        continue
                used = [word for word in defined if "GENERATED" not in word]
                flags = " ".join([*optimised, math, *used])
                answers = ANSWERS.get(source, ["x", "pose", "least"])
                facts = {"kernel": name, "compiler": version, "flags": flags, "answers": answers}
                built.append({**facts, "binary": str(binary)})
    build_folder.joinpath("closed.json").write_text(json.dumps(built))
    return missing


def compilers(run):
    """Versions of the installed C compilers, by name."""
    clangs = sorted(Path("/usr/bin").glob("clang-[0-9]*"), key=lambda path: int(path.name.split("-")[1]))
    names = [os.environ.get("CC", "cc"), *(["clang"] if not clangs else [str(clangs[-1])])]
    versions = {name: run([name, "--version"]).stdout.split("\n")[0] for name in names}
    return {name: version for name, version in versions.items() if version}


def compile_one(run, compiler, flags, peers, source, binary):
    kernel = binary.with_suffix(".o")
    done = run([compiler, "-std=c11", *flags, "-w", "-c", peers / "closed" / source, "-o", kernel])
    if done.returncode != 0:
        return done
    worker = [os.environ.get("CXX", "c++"), "-std=c++17", "-O2", peers / "closed.cpp", kernel]
    return run([*worker, "-o", binary, "-lm"])
