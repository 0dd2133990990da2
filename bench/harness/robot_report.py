"""Tables and chart of the workload of the three-rod robot."""

from quantities import figures, quantity, rate, time
from report import about, charts, method, save, write

# Title of each family, and the colours of jointplay and of the others in the chart.
FAMILIES = {
    "closed": ("Closed equations, Newton", "#0b6e99", "#9ecae1"),
    "least": ("Closed equations, least displacement", "#0b6e99", "#9ecae1"),
    "general": ("General engines", "#b35806", "#fdc98d"),
}
WHAT = {
    "closed": [
        "Three equations for the sides, F(X) = 0, in six unknowns; each program finds the solution of the paper's iteration X ← X + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ (L² − L(X)²) from nominal, each side within 10⁻⁹ mm: by this iteration with the exact Jacobian, and jointplay by polynomials that interpolate its solutions.",
        "*With pose*: the pose of the platform is included.",
    ],
    "least": [
        "The same equations, solved for the X of least displacement from nominal in the metric, which optimisers find.",
        "C, Numba, JAX, NumPy and the generated C use Gauss–Newton, X ← X₀ + W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ (J (X − X₀) + L² − L(X)²); jointplay uses polynomials that interpolate its solutions; the others are general optimisers with exact derivatives.",
    ],
    "general": [
        "Programs that receive links and joints, not these equations; the entry of jointplay is its general `PositionSolver`, which iterates to round-off.",
    ],
}
NOTES = {
    "closed": [
        "*jointplay* prepares the robot once, by `PoseSolver::new`, which is not counted: the virtual joints as polynomials of the slopes of the plane through the balls, and the first step of the iteration. *One by one*: `PoseSolver::virtual_joints`, and with pose `PoseSolver::forward`, by the polynomials; *bulk*: `PoseSolver::forward_many`, by the polynomials too, whose pose is origin, normal and torsion. Each pose is checked by its sides.",
        "*C, vectors over poses*: 8 or 16 poses in vectors of the compiler, or a loop without branches under `#pragma omp simd`. *C, by hand*: pose by pose. Both use the law of cosines, series for the sines of small angles, a first step computed once for all poses, and one division for a 3×3 system. *C, textbook* omits the series and the first step.",
        "*Numba*, *JAX*, *NumPy* use the same formulas, Numba and JAX the same series; *CasADi* derives them and generates C, which is compiled like the rest.",
        "Each kernel in C is built with each installed compiler, with `-O3` for the processor, with and without `-ffast-math`; the fastest counts, and all are listed below.",
    ],
    "least": [
        "*SciPy*, *Drake, SNOPT* and *CasADi* receive the problem in millimetres, with derivatives, and tolerances with which every side is within 10⁻⁹ mm.",
    ],
    "general": [
        "*Pinocchio, C++*, *MuJoCo, C*, *Pinocchio, Python*, *Drake, Newton*: kinematics and Jacobians of the library with Newton's iteration of the bench; the compiled ones with Eigen at fixed sizes. These libraries have no position solver for loops; MuJoCo has soft constraints.",
        "*Drake, SNOPT*: `InverseKinematics` with the displacement as cost, feasibility tolerance 10⁻¹³.",
        "*Exudyn, static*: `MainSolverStatic` with springs at the virtual joints, whose equilibrium is the least displacement.",
        "*SciPy*: `least_squares`, without other libraries.",
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
        f"The robot of the catalogue with the six virtual joints of the polar model, ρ = 1 mm, in {work['poses']} poses: azimuth 0° to 359° in steps of 1°, tilt −2° to 2° in steps of 0.1° without the level pose, height 500 mm.",
        "The rods are given; the programs compute the virtual joints, and where stated the pose, each from nominal.",
        "",
        "One function of the bench with independent equations computes *closed*, gaps and distances from the answers: gaps are errors of the sides, and with a pose distances of sockets from balls.",
        "*From Newton* and *from least* are the largest distances of X from reference solutions, with angles multiplied by the socket radius.",
        "Slow programs compute every tenth or fortieth pose.",
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
        f"`PoseSolver::forward_many` and `Gpr::inverse_many`: the {work['poses']} poses on one core, as above; then {poses} poses, more than the caches hold, on one core in CPU time, and distributed over all {work['cores']} cores (`study::parallel`) in wall time, in the best of many runs.",
        "*Gain* is the ratio of the wall time on one core to that on all cores; with other load on the machine it has little meaning. The last column is the ratio of the CPU time on one core to that of all cores together; below one, the distribution has a cost.",
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
        "## Limits of the machine",
        "",
        f"Measured in the same run on one core: {giga('fma', ' FMA/s')}, {giga('divide', ' divisions/s')}, {giga('root', ' roots/s')} of doubles in the widest vectors; copies (bytes read and written) at {copies}.",
        "Operations are counted from the executed instructions, by single-stepping: additions, subtractions, multiplications, divisions and roots of doubles; an FMA counts as two, a vector with its full width.",
        "Bytes are those of the columns read and written.",
        "The rate that a limit allows is in poses per second, without any other cost; the share refers to the smallest of these rates.",
        "No program reaches the limit of operations, which assumes that every instruction is an FMA.",
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
        "## Single calls",
        "",
        "CPU time of a single call, each of which depends on the result of the previous call: the median of the batches.",
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
        flags = one["flags"].removeprefix("-O3 ")
        row = rows.setdefault((one["kernel"], one["compiler"], flags), {})
        row[one["what"]] = f"**{rate}**" if one["taken"] else rate
    lines = [
        "## Kernels in C",
        "",
        "Poses per second of every build, measured before the rounds; the selected builds are bold.",
        "",
        "| kernel | compiler | flags | X | X and pose | least X |",
        "| --- | --- | --- | ---: | ---: | ---: |",
    ]
    for (kernel, compiler, flags), row in rows.items():
        cells = [row.get(what, "–") for what in ("x", "pose", "least")]
        lines.append(f"| {kernel} | {compiler} | {flags} | {' | '.join(cells)} |")
    return lines


def chart(out, work):
    """Draws all families into one chart, the fastest program of each on top."""
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
