"""Ratios of jointplay to the best other program and to the limits of the machine, and their comparison with recorded ones.

With a ratio above one, jointplay is faster.
Times vary between machines and between runs; ratios of one run vary less.
"""

import json

from quantities import rate

# Largest allowed decrease of a ratio, as a fraction of the recorded ratio.
LOSS = 0.1
WORKS = ("gpr", "linkages", "scaling")
# Rows of the three-rod robot: family, program of jointplay, and suffix of the names of the compared programs.
POSES = {
    "polar, X": ("closed", "jointplay, bulk", ""),
    "polar, X and pose": ("closed", "jointplay, bulk, with pose", ", with pose"),
    "polar, X, one by one": ("closed", "jointplay, one by one", ""),
    "polar, least X": ("least", "jointplay, bulk", ""),
    "polar, least X, one by one": ("least", "jointplay, one by one", ""),
    "any mechanism, robot with virtual joints": ("general", "jointplay, any mechanism", ""),
}
# Programs that compute many poses at a time; single calls are not compared with them.
MANY = ("C, vectors over poses", "Numba", "JAX", "NumPy")
# Single calls: call of jointplay, and calls of other programs in the same language.
CALLS = {
    "single call, from Rust": ("jointplay, from Rust", ("C, by hand", "CasADi, generated C")),
    "single call, from Python": ("jointplay, from Python, with pose", ("Numba, from Python", "JAX, from Python", "plain Python")),
}


def load(folder):
    """Existing results, by workload."""
    paths = {work: folder / f"{work}.json" for work in WORKS}
    return {work: json.loads(path.read_text()) for work, path in paths.items() if path.exists()}


def rows(results):
    """Ratios by row: ratio, jointplay, the best other program, and its number; rates in 1/s, times in s."""
    found = {}
    if "gpr" in results:
        found |= robot(results["gpr"]["work"])
    if "linkages" in results:
        found |= linkages(results["linkages"]["work"])
    if "scaling" in results:
        found |= scaling(results["scaling"]["work"])
    return found


def robot(work):
    found = {}
    for row, (family, own, ending) in POSES.items():
        programs = work["families"][family]
        rates = {name: rate(result, work["poses"]) for name, result in programs.items() if "cpu_s" in result}
        others = {
            name: value
            for name, value in rates.items()
            if not name.startswith("jointplay")
            and name.endswith(", with pose") == bool(ending)
            and not ("one by one" in own and name.startswith(MANY))
        }
        if own in rates and others:
            best = max(others, key=others.get)
            found[row] = {"ratio": rates[own] / others[best], "own": rates[own], "best": best, "other": others[best]}
    for row, (own, names) in CALLS.items():
        times = {name: call["median_s"] for name, call in work["calls"].items() if "median_s" in call}
        others = {name: times[name] for name in names if name in times}
        if own in times and others:
            best = min(others, key=others.get)
            found[row] = {"ratio": others[best] / times[own], "own_s": times[own], "best": best, "other_s": others[best]}
    for name, figure in work["limits"]["figures"].items():
        if "allowed" in figure and name.endswith(", bulk"):
            limit = min(figure["allowed"].values())
            row = f"{name}, share of the limit"
            found[row] = {"ratio": figure["rate"] / limit, "own": figure["rate"], "best": "limit", "other": limit}
    return found


def linkages(works):
    found = {}
    for mechanism, work in works.items():
        times = {
            name: 1 / rate(result, work["positions"]) for name, result in work["results"].items() if "cpu_s" in result
        }
        others = {name: value for name, value in times.items() if not name.startswith("jointplay")}
        if "jointplay" in times and others:
            best = min(others, key=others.get)
            own = times["jointplay"]
            found[f"positions, {mechanism}"] = {
                "ratio": others[best] / own,
                "own_s": own,
                "best": best,
                "other_s": others[best],
            }
    return found


def scaling(families):
    """Ratios of the time per loop with a hundred loops to that with a thousand; one if the time is proportional to the loops."""
    found = {}
    for family, sizes in families.items():
        by_loops = {size["loops"]: size for size in sizes}
        for key in ("mobility_sparse", "drive_sparse"):
            times = [(by_loops.get(loops) or {}).get(key) or {} for loops in (100, 1000)]
            if all("seconds" in time for time in times):
                few, many = (time["seconds"] / loops for time, loops in zip(times, (100, 1000)))
                row = f"{family}, {key.replace('_', ', ')}, time of a loop"
                found[row] = {"ratio": few / many, "own_s": many, "best": "a hundred loops", "other_s": few}
    return found


def lost(before, after):
    """Rows whose ratio decreased by more than `LOSS`: row, ratio before, ratio after."""
    common = [row for row in before if row in after]
    pairs = [(row, before[row]["ratio"], after[row]["ratio"]) for row in common]
    return [(row, old, new) for row, old, new in pairs if new < (1 - LOSS) * old]


def compared(before, after):
    """Comparison of ratios, as lines of text."""
    if not before:
        return ["no recorded ratios to compare with"]
    worse = lost(before, after)
    if not worse:
        return [f"no ratio lost more than {LOSS:.0%} of its recorded value"]
    lines = [f"{len(worse)} ratios lost more than {LOSS:.0%} of their recorded value:"]
    return lines + [f"  {row}: {old:.3g}, now {new:.3g}" for row, old, new in worse]
