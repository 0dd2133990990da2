"""Tables, charts and all numbers, as files."""

import json

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams.update({"svg.hashsalt": "bench", "svg.fonttype": "path", "font.size": 10})
from matplotlib import pyplot

OURS, THEIRS = "#0b6e99", "#b8b8b8"


def write(out, name, document, lines):
    out.joinpath(f"{name}.json").write_text(json.dumps(document, indent=1) + "\n")
    out.joinpath(f"{name}.md").write_text("\n".join([*lines, ""]))


def about(document, command):
    """Where the numbers come from, as lines of Markdown."""
    machine, versions = document["machine"], document["versions"]
    told = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    lines = [
        f"Command: `{command}`.",
        f"Run on {document['date'][:10]}, {machine['processor']}, {machine['cores']} cores, {machine['system']}, "
        f"load average {machine['load_average'][0]:.1f} at the start.",
        f"Versions: {told}.",
    ]
    lines += [f"Missing: {name}, {why}." for name, why in document["missing"].items()]
    return lines


def method(document):
    return [
        f"All programs do the work in one run, in {document['rounds']} rounds in which each takes its turn; the round with the least CPU time counts.",
        "Rates are of one core; on another machine only the ratios mean something.",
    ]


def rate(result, asked):
    """Work items per second of CPU time, in the best round."""
    return len(range(0, asked, result["stride"])) / min(result["cpu_s"])


def quantity(rate):
    for unit, size in (("M", 1e6), ("k", 1e3)):
        if rate >= size:
            return f"{rate / size:.3g} {unit}"
    return f"{rate:.3g}"


def gpr(out, document):
    poses, results = document["work"]["poses"], document["work"]["results"]
    rates = {name: rate(result, poses) for name, result in results.items() if "cpu_s" in result}
    general = rates["jointplay, any mechanism"]
    lines = [
        "# Positions of the three-rod robot",
        "",
        *about(document, "python3 bench/run.py --only gpr"),
        *method(document),
        "",
        f"The robot of the catalogue with the six virtual joints of the polar model, ρ = 1 mm, in {poses} poses: yaw 0° to 359° by 1°, pitch −2° to 2° by 0.1° but for level, height 500 mm.",
        "Rods are given; pose and virtual joints are found, each pose from nominal, until each ball is within 10⁻⁹ mm of its socket.",
        "",
        "| program | poses/s | × jointplay, any mechanism | closed | largest gap, mm | slides off the least, nm |",
        "| --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    for name in sorted(results, key=lambda name: -rates.get(name, 0)):
        result = results[name]
        if name not in rates:
            lines.append(f"| {name} | – | – | failed: {result['failed']} | – | – |")
            continue
        asked = len(range(0, poses, result["stride"]))
        lines.append(
            f"| {name} | {quantity(rates[name])} | {rates[name] / general:.3g} | {result['closed']} of {asked} "
            f"| {result['largest_gap_m'] * 1e3:.1e} | {result['slides_from_least_m'] * 1e9:.2g} |"
        )
    lines += [
        "",
        "*Closed* and the gaps are computed from each program's answer by one function of the bench, not taken from the program.",
        "*Off the least*: how far a radial slide is from that of the least displacement; Newton ends near it by construction.",
        "A program that is asked for fewer poses is asked for every so many of them.",
        "",
        "- *jointplay, the robot's equations*: `Gpr::forward` with the polar virtualization and Newton's iteration.",
        "- *jointplay, any mechanism*: `PositionSolver` on the graph of links and joints; it goes on to round-off.",
        "- *Pinocchio, C++*, *MuJoCo, C*, *Pinocchio, Python*, *Drake, Newton*: kinematics and Jacobians of the library, Newton's iteration of the bench on them; the compiled ones with Eigen at fixed sizes. These libraries have no position solver for loops of their own; MuJoCo's constraints are soft.",
        "- *Drake, SNOPT*: `InverseKinematics` with the displacement as cost, feasibility tolerance 10⁻¹².",
        "- *Exudyn, static*: `MainSolverStatic` with springs at the virtual joints, whose equilibrium is the least displacement.",
        "- *SciPy*: `least_squares`, as someone does it who has nothing else.",
        "",
        "![Poses per second](gpr.svg)",
    ]
    write(out, "gpr", document, lines)
    names = sorted(rates, key=lambda name: rates[name])
    figure, axes = pyplot.subplots(figsize=(7.5, 0.42 * len(names) + 1.1), layout="constrained")
    bars = axes.barh(
        names, [rates[name] for name in names], color=[OURS if name.startswith("jointplay") else THEIRS for name in names]
    )
    axes.bar_label(bars, [quantity(rates[name]) for name in names], padding=4)
    axes.set_xscale("log")
    axes.set_xlim(right=max(rates.values()) * 5)
    axes.set_xlabel("poses per second on one core (longer is faster)")
    axes.spines[["top", "right"]].set_visible(False)
    save(figure, out / "gpr.svg")


def linkages(out, document):
    works = document["work"]
    names = list(next(iter(works.values()))["results"])
    lines = [
        "# Positions of mechanisms along a drive",
        "",
        *about(document, "python3 bench/run.py --only linkages"),
        *method(document),
        "",
        "Catalogue mechanisms without virtual joints; 200 positions on the way of their drives there and back, each searched from the one before, the same guess for every program.",
        "Closed: all gaps of points below 10⁻¹² m, those of hinge directions below 10⁻¹² rad, computed by one function of the bench.",
        "",
        "Time for a position, in µs; in brackets as a multiple of jointplay's.",
        "",
        f"| program | {' | '.join(works)} |",
        f"| --- | {' | '.join('---:' for _ in works)} |",
    ]
    times = {
        mechanism: {
            name: 1e6 / rate(result, work["positions"]) for name, result in work["results"].items() if "cpu_s" in result
        }
        for mechanism, work in works.items()
    }
    for name in names:
        cells = []
        for mechanism, work in works.items():
            result = work["results"][name]
            if "cpu_s" not in result:
                cells.append("failed")
                continue
            asked = len(range(0, work["positions"], result["stride"]))
            short = "" if result["closed"] == asked else f", closed {result['closed']} of {asked}"
            own = times[mechanism][name]
            cells.append(f"{own:.3g} ({own / times[mechanism]['jointplay']:.3g}×{short})")
        lines.append(f"| {name} | {' | '.join(cells)} |")
    lines += ["", "Largest gap, in m or rad:", "", f"| program | {' | '.join(works)} |"]
    lines.append(f"| --- | {' | '.join('---:' for _ in works)} |")
    for name in names:
        gaps = [work["results"][name].get("largest_gap") for work in works.values()]
        lines.append(f"| {name} | {' | '.join('–' if gap is None else f'{gap:.0e}' for gap in gaps)} |")
    for mechanism, work in works.items():
        for name, result in work["results"].items():
            if "failed" in result:
                lines.append(f"\n{name} on {mechanism} failed: {result['failed']}.")
    lines += [
        "",
        "jointplay is `PositionSolver`, which goes on to round-off; the others stop at 10⁻¹².",
        "Of Pinocchio, MuJoCo and Drake the kinematics and Jacobians are used, with Newton's iteration of the bench; a hinge that closes a loop is five equations, a ball three.",
        "Exudyn closes loops by its own joints, with `ignoreSingularJacobian` where hinges are redundant.",
        "",
        "![Time for a position](linkages.svg)",
    ]
    write(out, "linkages", document, lines)
    figure, axes = pyplot.subplots(figsize=(7.5, 4.2), layout="constrained")
    markers = "osD^v<>"
    for index, name in enumerate(names):
        points = [(at, times[mechanism][name]) for at, mechanism in enumerate(works) if name in times[mechanism]]
        style = {"color": OURS, "linewidth": 2.2, "zorder": 3} if name == "jointplay" else {"linewidth": 1}
        axes.plot(*zip(*points), marker=markers[index % len(markers)], markersize=5, label=name, **style)
    axes.set_yscale("log")
    axes.set_xticks(range(len(works)), [f"{name}\n{work['loops']} loop{'s' * (work['loops'] > 1)}" for name, work in works.items()])
    axes.set_ylabel("time for a position, µs (lower is faster)")
    axes.grid(axis="y", alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    save(figure, out / "linkages.svg")


def save(figure, path):
    # Without a date, so that the same numbers give the same file.
    figure.savefig(path, metadata={"Date": None})
    pyplot.close(figure)
