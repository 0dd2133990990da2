"""Runs the workload of the three-rod robot with six virtual joints in all programs: many positions, each from nominal."""

import json
import os
import statistics
import sys
from pathlib import Path

import check
import limits
import mjcf
import work as workload
import workers

PEERS = Path(__file__).resolve().parent.parent / "peers"
# Footprint that exceeds every cache [bytes].
MEMORY = 1 << 30
# Number of measurements of a kernel in C, and of repetitions in each.
TRIES = 8
# Number of single calls in a batch, and number of batches; the median batch counts.
CALLS, BATCHES = {"compiled": 2000, "python": 200}, 25


def peer(name, *words):
    return [sys.executable, PEERS / f"{name}_peer.py", *words]


def commands(build, path, kernels):
    """Commands of all workers by family and name; the first worker of a family is the unit of the others."""
    jointplay = build / "jointplay"
    in_c = {
        "C, vectors over poses": ("vectors", "x"),
        "C, vectors over poses, with pose": ("vectors", "pose"),
        "C, by hand": ("hand", "x"),
        "C, by hand, with pose": ("hand", "pose"),
        "C, textbook": ("textbook", "x"),
        "CasADi, generated C": ("casadi", "x"),
    }
    least_in_c = {
        "C, vectors over poses": ("vectors", "least"),
        "C, by hand": ("hand", "least"),
        "CasADi, generated C": ("casadi", "least"),
    }

    def compiled(kinds):
        return {name: [kernels[kind], kind[1], path] for name, kind in kinds.items() if kind in kernels}

    return {
        "closed": {
            "jointplay, one by one": [jointplay, "gpr", "joints", "newton"],
            "jointplay, one by one, with pose": [jointplay, "gpr", "own", "newton"],
            "jointplay, bulk": [jointplay, "gpr", "bulk", "joints"],
            "jointplay, bulk, with pose": [jointplay, "gpr", "bulk", "pose"],
            "jointplay, bulk, from Python": peer("jointplay", path),
            **compiled(in_c),
            "Numba": peer("numba", "x", path),
            "JAX": peer("jax", "x", path),
            "NumPy": peer("numpy", "x", path),
        },
        "least": {
            "jointplay, one by one": [jointplay, "gpr", "joints", "least-norm"],
            "jointplay, one by one, with pose": [jointplay, "gpr", "own", "least-norm"],
            "jointplay, bulk": [jointplay, "gpr", "bulk", "least"],
            **compiled(least_in_c),
            "Numba": peer("numba", "least", path),
            "JAX": peer("jax", "least", path),
            "NumPy": peer("numpy", "least", path),
            "CasADi, IPOPT": peer("casadi", "ipopt", path),
            "CasADi, SQP": peer("casadi", "sqpmethod", path),
            "SciPy, SLSQP": peer("scipy", "slsqp", path),
            "SciPy, trust-constr": peer("scipy", "trust-constr", path),
            "Drake, SNOPT": peer("drake", "closed", path),
        },
        "general": {
            "jointplay, any mechanism": [jointplay, "gpr", "general", "newton"],
            "jointplay, any mechanism, least": [jointplay, "gpr", "general", "least-norm"],
            "Pinocchio, C++": [build / "pinocchio", "gpr", path],
            "MuJoCo, C": [build / "mujoco", "gpr", path],
            "Pinocchio, Python": peer("pinocchio", "gpr", path),
            "Drake, Newton": peer("drake", "gpr", path),
            "Drake, SNOPT": peer("drake", "snopt", path),
            "Exudyn, static": peer("exudyn", "gpr", path),
            "SciPy": peer("scipy", "gpr", path),
        },
    }


# Bulk functions of jointplay: name in the command, columns read, columns written.
BULK = {
    "polar, X": ("joints", 3, 7),
    "polar, X and pose": ("pose", 3, 14),
    "polar, least X": ("least", 3, 7),
    "planar, X alone": ("planar", 3, 6),
    "planar, X and pose": ("planar-pose", 3, 14),
    "radial, X alone": ("radial", 3, 3),
    "radial, X and pose": ("radial-pose", 3, 11),
    "inverse": ("inverse", 2, 3),
}
# Bulk functions that are also in a family, and are not timed twice.
SAME = {
    "polar, X": ("closed", "jointplay, bulk"),
    "polar, X and pose": ("closed", "jointplay, bulk, with pose"),
    "polar, least X": ("least", "jointplay, bulk"),
}
PYTHON = "polar, X, from Python"
# Number of copies of the poses for the parallel measurement, about a million poses.
COPIES = 70
# Number of poses whose instructions are counted in bulk functions.
PART = 1440
# Number of runs of a million poses in each round.
MOMENTS = 10
# Workers whose instructions are counted pose by pose: family, name, poses.
COUNTED = {
    "polar, X, one by one": ("closed", "jointplay, one by one", 200),
    "polar, X and pose, one by one": ("closed", "jointplay, one by one, with pose", 200),
    "any mechanism": ("general", "jointplay, any mechanism", 20),
    "C, by hand": ("closed", "C, by hand", 200),
}
CALLED = {
    "jointplay, from Rust": ("compiled", "closed", "jointplay, one by one"),
    "jointplay, from Rust, with pose": ("compiled", "closed", "jointplay, one by one, with pose"),
    "jointplay, from Python, with pose": ("python", "closed", "jointplay, bulk, from Python"),
    "C, by hand": ("compiled", "closed", "C, by hand"),
    "CasADi, generated C": ("compiled", "closed", "CasADi, generated C"),
    "Numba, from Python": ("python", "closed", "Numba"),
    "JAX, from Python": ("python", "closed", "JAX"),
    "plain Python": ("python", "closed", "NumPy"),
    "jointplay, any mechanism, from Rust": ("compiled", "general", "jointplay, any mechanism"),
}


def work(build, folder, rounds, note):
    path = folder / "gpr.txt"
    work = workload.Gpr.read(path)
    path.with_suffix(".xml").write_text(mjcf.gpr(work))
    kernels, tried = quickest(build, path, note)
    families = commands(build, path, kernels)
    everything = {(family, name): command for family, each in families.items() for name, command in each.items()}
    bulk = {name: [build / "jointplay", "gpr", "bulk", what] for name, (what, _, _) in BULK.items()}
    everything |= {("bulk", name): command for name, command in bulk.items() if name not in SAME}
    results = workers.compare(everything, rounds, folder, note)
    newton, least = check.reference(work, least=False), check.reference(work, least=True)
    for (_, name), result in results.items():
        if "answers" in result:
            answers = result.pop("answers")
            result.update(
                check.inverse(work, answers) if name == "inverse" else check.gpr(work, answers, newton, least)
            )
    by_family = {family: {name: results[family, name] for name in each} for family, each in families.items()}
    many = {name: results[SAME.get(name, ("bulk", name))] for name in bulk}
    return {
        "poses": len(work.poses),
        "cores": os.cpu_count(),
        "kernels_tried": tried,
        "families": by_family,
        "bulk": many,
        "million": million(build, path, rounds, note),
        "calls": calls(families, note),
        "limits": shares(build, families, bulk, {**by_family, "bulk": many}, len(work.poses), rounds, folder, note),
    }


def million(build, path, rounds, note):
    """Times of about a million poses, more than a cache can contain, on one core and on all cores."""
    commands = {}
    for name, (what, _, _) in BULK.items():
        rust = [build / "jointplay", "gpr", "bulk", what, COPIES]
        commands[f"{name}, one core"], commands[f"{name}, all cores"] = rust, [*rust, "cores"]
    python = peer("jointplay", path, COPIES)
    commands[f"{PYTHON}, one core"], commands[f"{PYTHON}, all cores"] = [*python, 1], [*python, os.cpu_count()]
    return {"copies": COPIES, "results": moments(commands, rounds, note)}


def moments(commands, rounds, note):
    """CPU and wall times of many single runs; the best run has the least load from other programs."""
    results, started = {}, {}
    for name, command in commands.items():
        note(f"starting {name}")
        try:
            started[name] = workers.Worker(command)
            started[name].time()
            results[name] = {"cpu_s": [], "wall_s": []}
        except (workers.Failed, OSError) as error:
            started.pop(name, None)
            results[name] = {"failed": str(error)}
    for _ in range(MOMENTS * rounds):
        for name, worker in started.items():
            cpu, wall = worker.time()
            results[name]["cpu_s"].append(cpu)
            results[name]["wall_s"].append(wall)
    for worker in started.values():
        worker.close()
    return results


def shares(build, families, bulk, results, poses, rounds, folder, note):
    """Bytes and operations per pose of jointplay and of C, and the rates that the machine allows."""
    figures = {}
    for name, (family, worker, calls) in COUNTED.items():
        figures[name] = {"family": family, "worker": worker, "ask": f"call {calls}", "counted": calls, "columns": 10}
    for name, (_, read, written) in BULK.items():
        figures[f"{name}, bulk"] = {
            "family": "bulk",
            "worker": name,
            "ask": f"call {PART}",
            "counted": PART,
            "columns": read + written,
        }
    vectors = "C, vectors over poses"
    figures[vectors] = {"family": "closed", "worker": vectors, "ask": "run 1", "counted": poses, "columns": 10}
    for name, figure in figures.items():
        note(f"counting {name}")
        figure["bytes"] = 8 * figure["columns"]
        figure["footprint"] = poses * figure["bytes"]
        try:
            command = {**families, "bulk": bulk}[figure["family"]].get(figure["worker"])
            if command is None:
                raise workers.Failed("the worker was not built")
            counts = limits.operations(build, command, figure["ask"])
            for kind in ("instructions", "operations", "divisions", "roots"):
                figure[kind] = counts[kind] / figure["counted"]
            result = results[figure["family"]][figure["worker"]]
            figure["rate"] = poses / min(result["cpu_s"])
        except (workers.Failed, OSError, KeyError) as error:
            figure["failed"] = str(error)
    sizes = sorted({figure["footprint"] for figure in figures.values()} | {MEMORY})
    rates = limits.machine(build, sizes, rounds, folder, note)
    for figure in figures.values():
        if "rate" in figure:
            figure["allowed"] = limits.bound(figure, rates)
    return {"machine": rates, "figures": figures}


def quickest(build, path, note):
    """Fastest binary of the kernels in C for each kind of work, and the times of all."""
    built = json.loads((build / "closed.json").read_text())
    best, tried = {}, []
    for one in built:
        for what in one["answers"]:
            note(f"trying {Path(one['binary']).name} {what}")
            worker = workers.Worker([one["binary"], what, path])
            worker.time()
            worker.repeats = TRIES
            took = min(worker.time()[0] for _ in range(TRIES))
            worker.close()
            tried.append({**one, "binary": Path(one["binary"]).name, "what": what, "cpu_s": took})
            kind = (one["kernel"], what)
            if kind not in best or took < best[kind][0]:
                best[kind] = (took, one["binary"])
    for one in tried:
        one["taken"] = best[one["kernel"], one["what"]][0] == one["cpu_s"]
    return {kind: binary for kind, (_, binary) in best.items()}, tried


def calls(families, note):
    """CPU time of a single call, each of which depends on the previous result; the median of many batches."""
    results = {}
    for name, (kind, family, worker_name) in CALLED.items():
        note(f"calling {name}")
        command = families[family].get(worker_name)
        try:
            if command is None:
                raise workers.Failed("the worker was not built")
            worker = workers.Worker(command)
            worker.call(CALLS[kind])
            took = [worker.call(CALLS[kind]) for _ in range(BATCHES)]
            worker.close()
            results[name] = {"median_s": statistics.median(took), "least_s": min(took), "batches": BATCHES}
        except (workers.Failed, OSError) as error:
            results[name] = {"failed": str(error)}
    return results
