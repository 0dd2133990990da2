"""Tables and chart of the three-rod robot."""

from quantities import figures, quantity, rate, time
from report import about, charts, method, save, write

# Of each family: what it is, and the colours of jointplay and of the others in the chart.
FAMILIES = {
    "closed": ("Closed equations, Newton", "#0b6e99", "#9ecae1"),
    "least": ("Closed equations, least displacement", "#0b6e99", "#9ecae1"),
    "general": ("General engines", "#b35806", "#fdc98d"),
}
WHAT = {
    "closed": [
        "Three equations for the sides, F(X) = 0, in six unknowns; each program solves them by the paper's iteration X ← X + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ (L² − L(X)²) with the exact Jacobian, until each side is within 10⁻⁹ mm.",
        "*With pose*: the pose of the platform is included.",
    ],
    "least": [
        "The same equations, solved to the X that is nearest to nominal in the metric, where optimisers end.",
        "jointplay, C, Numba, JAX, NumPy and the generated C go by Gauss–Newton, X ← X₀ + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ (J (X − X₀) + L² − L(X)²); the others are general optimisers with exact derivatives.",
    ],
    "general": [
        "Programs that know links and joints, not these equations; jointplay's entry is `PositionSolver`, which does not know them either, and iterates to round-off.",
    ],
}
NOTES = {
    "closed": [
        "*jointplay, one by one*: `Gpr::virtual_joints`, and with pose `Gpr::forward`; *bulk*: `Gpr::forward_many`, whose pose is origin, normal and torsion.",
        "*C, vectors over poses*: 8 or 16 poses in the vectors of the compiler, or a loop without branches under `#pragma omp simd`. *C, by hand*: pose by pose. Both use the law of cosines, series for the sines of small turns, a first step computed once for all poses, and one division for a 3×3 system. *C, textbook* omits the series and the first step.",
        "*Numba*, *JAX*, *NumPy* use the same formulas, Numba and JAX the same series; *CasADi* derives them and generates C, which is compiled like the rest.",
        "Of C, every kernel is built by every compiler found, with `-O3 -march=native`, with and without `-ffast-math`; the fastest counts, all are below.",
    ],
    "least": [
        "*SciPy*, *Drake, SNOPT* and *CasADi* get the problem in millimetres, derivatives included, and tolerances at which every side is within 10⁻⁹ mm.",
    ],
    "general": [
        "*Pinocchio, C++*, *MuJoCo, C*, *Pinocchio, Python*, *Drake, Newton*: kinematics and Jacobians of the library, Newton's iteration of the bench on them; the compiled ones with Eigen at fixed sizes. These libraries have no position solver for loops of their own; MuJoCo's constraints are soft.",
        "*Drake, SNOPT*: `InverseKinematics` with the displacement as cost, feasibility tolerance 10⁻¹³.",
        "*Exudyn, static*: `MainSolverStatic` with springs at the virtual joints, whose equilibrium is the least displacement.",
        "*SciPy*: `least_squares`, as a user without other libraries does it.",
    ],
}


def report(out, document):
    work = document["work"]
    lines = [
        "# Positions of the three-rod robot",
        "",
        *about(document, "python3 bench/run.py --only gpr"),
        *method(document),
        "",
        f"The robot of the catalogue with the six virtual joints of the polar model, ρ = 1 mm, in {work['poses']} poses: azimuth 0° to 359° by 1°, tilt −2° to 2° by 0.1° but for level, height 500 mm.",
        "Rods are given; virtual joints, and the pose where stated, are found, each pose from nominal.",
        "",
        "*Closed*, gaps and distances are computed from each program's answer by one function of the bench with equations of its own: gaps are of sides, and of sockets from balls where there is a pose.",
        "*From Newton* and *from least* is how far X is at most from a reference found without haste, a turn counted as its arc at the socket.",
        "A program that is asked for fewer poses is asked for every so many of them.",
    ]
    for family, results in work["families"].items():
        lines += ["", f"## {FAMILIES[family][0]}", "", *WHAT[family], "", *table(results, work["poses"]), ""]
        lines += [f"- {note}" for note in NOTES[family]]
    lines += ["", "![Poses per second](gpr.svg)", "", *million(work), "", *calls(work["calls"])]
    lines += ["", *limits(work["limits"]), "", *tried(work)]
    write(out, "gpr", document, lines)
    chart(out, work)


def rates_of(results, poses):
    return {name: rate(result, poses) for name, result in results.items() if "cpu_s" in result}


def table(results, poses):
    rates = rates_of(results, poses)
    unit = next(iter(results))
    lines = [
        f"| program | poses/s | × {unit} | closed | largest gap, mm | from Newton, mm | from least, mm |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name in sorted(results, key=lambda name: -rates.get(name, 0)):
        result = results[name]
        if name not in rates or not result.get("answered"):
            lines.append(f"| {name} | – | – | failed: {result.get('failed', 'no answer')} | – | – | – |")
            continue
        asked = len(range(0, poses, result["stride"]))
        far = [f"{1e3 * result[key]:.1e}" for key in ("largest_gap_m", "from_newton_m", "from_least_m")]
        share = f"{rates[name] / rates[unit]:.3g}" if unit in rates else "–"
        lines.append(
            f"| {name} | {quantity(rates[name])} | {share} | {result['closed']} of {asked} | {' | '.join(far)} |"
        )
    return lines


def million(work):
    shared = work["million"]
    poses = shared["copies"] * work["poses"]
    lines = [
        "## jointplay, many poses at a time",
        "",
        f"`Gpr::forward_many` and `Gpr::inverse_many`: the {work['poses']} poses on one core, as above; then {poses} poses, more than the caches hold, on one core in CPU time, and shared by all {work['cores']} (`study::parallel`) by the clock on the wall, in the best of many runs.",
        "*Gain* is one core's time on the wall over that of all; with other work on the machine all are rarely free at once, and it means little. The last column compares the CPU time of one with that of all together: below one, sharing costs.",
        "",
        f"| computed | {work['poses']} poses, one core | {poses} poses, one core | all cores | gain | CPU time, one to all |",
        "| --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    few = {**work["bulk"], "polar, X, from Python": work["families"]["closed"]["jointplay, bulk, from Python"]}
    for name, result in few.items():
        cells = [f"failed: {result['failed']}" if "failed" in result else quantity(rate(result, work["poses"]))]
        one, every = (shared["results"][f"{name}, {cores}"] for cores in ("one core", "all cores"))
        if "failed" in one or "failed" in every:
            cells += [f"failed: {one.get('failed', every.get('failed'))}", "–", "–", "–"]
        else:
            cells += [quantity(poses / min(one["cpu_s"])), quantity(poses / min(every["wall_s"]))]
            cells += [f"{min(one[clock]) / min(every[clock]):.2f}" for clock in ("wall_s", "cpu_s")]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return lines


def limits(result):
    machine = result["machine"]

    def giga(name, unit):
        return f"{machine[name] / 1e9:.3g} G{unit}" if machine.get(name) else "–"

    sizes = {int(name.split()[1]): name for name in machine if name.startswith("copy ")}
    copies = ", ".join(f"{giga(name, 'B/s')} of {size / 1e6:.3g} MB" for size, name in sorted(sizes.items()))
    lines = [
        "## How near to what the machine can do",
        "",
        f"Measured in the same run on one core: {giga('fma', ' FMA/s')}, {giga('divide', ' divisions/s')}, {giga('root', ' roots/s')} of doubles in its widest vectors; copies (read and written) at {copies}.",
        "Operations are counted from the instructions that are executed, one by one: additions, subtractions, multiplications, divisions and roots of doubles, an FMA as two, a vector by its full width.",
        "Bytes are those of the columns read and written.",
        "What each limit allows is poses per second if nothing else took time; the share is of the least of them.",
        "No program reaches the limit of operations, which takes every instruction for an FMA.",
        "",
        "| computed | instructions | operations | divisions, roots | bytes | allowed by bytes | by operations | by divisions and roots | poses/s | share |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name, figure in result["figures"].items():
        if "failed" in figure:
            lines.append(f"| {name} | {' | '.join('–' * 8)} | failed: {figure['failed']} |")
            continue
        allowed = [figure["allowed"].get(kind) for kind in ("bytes", "operations", "divisions and roots")]
        cells = [figures(figure["instructions"]), figures(figure["operations"])]
        cells += [f"{figures(figure['divisions'])}, {figures(figure['roots'])}", f"{figure['bytes']}"]
        cells += ["–" if one is None else quantity(one) for one in allowed]
        least = min(one for one in allowed if one is not None)
        lines.append(f"| {name} | {' | '.join(cells)} | {quantity(figure['rate'])} | {figure['rate'] / least:.0%} |")
    return lines


def calls(results):
    lines = [
        "## One pose",
        "",
        "Time of a single call as its caller measures it, each call waiting for the answer of the one before: the median of the batches, CPU time.",
        "",
        "| call | time |",
        "| --- | ---: |",
    ]
    for name, result in results.items():
        shown = f"failed: {result['failed']}" if "failed" in result else time(result["median_s"])
        lines.append(f"| {name} | {shown} |")
    return lines


def tried(work):
    rows = {}
    for one in work["kernels_tried"]:
        rate = quantity(work["poses"] / one["cpu_s"])
        flags = one["flags"].removeprefix("-O3 -march=native ")
        row = rows.setdefault((one["kernel"], one["compiler"], flags), {})
        row[one["what"]] = f"**{rate}**" if one["taken"] else rate
    lines = [
        "## Kernels in C",
        "",
        "Poses per second of every build, before the rounds; the bold ones were taken.",
        "",
        "| kernel | compiler | flags | X | X and pose | least X |",
        "| --- | --- | --- | ---: | ---: | ---: |",
    ]
    for (kernel, compiler, flags), row in rows.items():
        cells = [row.get(what, "–") for what in ("x", "pose", "least")]
        lines.append(f"| {kernel} | {compiler} | {flags} | {' | '.join(cells)} |")
    return lines


def chart(out, work):
    """All families in one picture, the quickest of each on top."""
    rows = []
    for family, results in work["families"].items():
        rates = rates_of(results, work["poses"])
        ordered = sorted(rates, key=lambda name: -rates[name])
        rows.append((FAMILIES[family][0], None, None))
        _, ours, theirs = FAMILIES[family]
        rows += [(name, rates[name], ours if name.startswith("jointplay") else theirs) for name in ordered]
    rows.reverse()
    pyplot = charts()
    figure, axes = pyplot.subplots(figsize=(8, 0.27 * len(rows) + 0.9), layout="constrained")
    for at, (name, value, color) in enumerate(rows):
        if value is not None:
            bar = axes.barh(at, value, color=color, height=0.78)
            axes.bar_label(bar, [quantity(value)], padding=3, fontsize=9)
    axes.set_yticks(range(len(rows)), [name for name, _, _ in rows], fontsize=9)
    for label, (_, value, _) in zip(axes.get_yticklabels(), rows):
        if value is None:
            label.set_fontweight("bold")
    axes.tick_params(axis="y", length=0)
    axes.set_xscale("log")
    largest = max(value for _, value, _ in rows if value is not None)
    axes.set_xlim(right=largest * 4)
    axes.set_ylim(-0.7, len(rows) - 0.3)
    axes.set_xlabel("poses per second on one core (longer is faster); dark: jointplay")
    axes.spines[["top", "right"]].set_visible(False)
    save(figure, out / "gpr.svg")
