"""Writes tables, charts and all numbers into files."""

import json

from quantities import figures, rate

OURS, THEIRS = "#0b6e99", "#b8b8b8"


def charts():
    """The plotting library without a window; tables do not need it."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "bench", "svg.fonttype": "path", "font.size": 10})
    from matplotlib import pyplot

    return pyplot


def write(out, name, document, lines):
    out.joinpath(f"{name}.json").write_text(json.dumps(document, indent=1) + "\n")
    out.joinpath(f"{name}.md").write_text("\n".join([*lines, ""]))


def about(document, command):
    """Command, machine and versions of the run, as lines of Markdown."""
    machine, versions = document["machine"], document["versions"]
    listed = ", ".join(f"{name} {version}" for name, version in versions.items() if version)
    lines = [
        f"Command: `{command}`.",
        f"Run on {document['date'][:10]}, {machine['processor']}, {machine['cores']} cores, {machine['system']}, "
        f"load average {machine['load_average'][0]:.1f} at the start.",
        f"Versions: {listed}.",
    ]
    lines += [f"Missing: {name}, {why}." for name, why in document["missing"].items()]
    return lines


def method(document):
    return [
        f"All programs compute the workload in one run of {document['rounds']} rounds, in each of which they alternate; the round with the least CPU time counts.",
        "Rates are those of one core; only the ratios are comparable between machines.",
    ]


def linkages(out, document):
    works = document["work"]
    names = list(next(iter(works.values()))["results"])
    lines = [
        "# Positions of mechanisms along a drive",
        "",
        *about(document, "python3 bench/run.py --only linkages"),
        *method(document),
        "",
        "Catalogue mechanisms without virtual joints; 200 positions along the motion of their drives, forward and back; the initial guess of each is the previous position, the same for every program.",
        "Closed: all gaps of points below 10⁻¹³ m, those of hinge directions below 10⁻¹³ rad, computed by one function of the bench.",
        "",
        "Time for a position, in µs, and in brackets as a multiple of the time of jointplay.",
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
            cells.append(f"{figures(own)} ({figures(own / times[mechanism]['jointplay'])}×{short})")
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
        "jointplay is `PositionSolver`, which ends at 10⁻¹³ of the characteristic length, and determines the rank itself; *many at a time* is one call of its `solve_many` for all positions, from the same guesses.",
        "Pinocchio, MuJoCo and Drake supply kinematics and Jacobians for Newton's iteration of the bench. A hinge that closes a loop has five equations, a ball joint three. The compiled programs solve square systems by LU and others by normal equations, which are the fastest methods for mechanisms of known rank.",
        "Exudyn closes loops with its own joints, and with `ignoreSingularJacobian` where hinges are redundant.",
        "",
        "![Time for a position](linkages.svg)",
    ]
    write(out, "linkages", document, lines)
    pyplot = charts()
    figure, axes = pyplot.subplots(figsize=(7.5, 4.2), layout="constrained")
    markers = "osD^v<>"
    for index, name in enumerate(names):
        points = [(at, times[mechanism][name]) for at, mechanism in enumerate(works) if name in times[mechanism]]
        style = {"color": OURS, "linewidth": 2.2, "zorder": 3} if name == "jointplay" else {"linewidth": 1}
        axes.plot(*zip(*points), marker=markers[index % len(markers)], markersize=5, label=name, **style)
    axes.set_yscale("log")
    axes.set_xticks(
        range(len(works)), [f"{name}\n{work['loops']} loop{'s' * (work['loops'] > 1)}" for name, work in works.items()]
    )
    axes.set_ylabel("time for a position, µs (lower is faster)")
    axes.grid(axis="y", alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1.0, 0.5))
    save(figure, out / "linkages.svg")


def words(out, document):
    results = document["work"]
    truth, pinocchio, mujoco, drake, exudyn = (
        results[name] for name in ("jointplay", "pinocchio", "mujoco", "drake", "exudyn")
    )

    def cell(peer, name, text):
        """Result of a program for a mechanism, or the reason for which it has none."""
        result = {"error": peer["failed"]} if "failed" in peer else peer[name]
        return f"error: {result['error']}" if "error" in result else text(result)

    lines = [
        "# Mechanisms: results of each program",
        "",
        *about(document, "python3 bench/run.py --only words"),
        "",
        "Pinocchio, MuJoCo, Drake and Exudyn are general programs for dynamics; the first three do not determine mobility.",
        "Each program computes the quantities that it supports, for the same mechanism in the same closed configuration.",
        "",
        "- *jointplay*: freedoms of all joints, rank, instantaneous mobility, finite mobility, redundancy (`jointplay mobility`).",
        "- *Pinocchio*: velocities of the open tree, rows of its constraint Jacobian, and its rank by NumPy; then whether `constraintDynamics` is finite with proximal μ = 0 and with μ = 10⁻¹².",
        "- *MuJoCo*: velocities of the open tree, rows of its equality constraints, and their rank by NumPy; accelerations, and number of warnings.",
        "- *Drake*: velocities of the open tree, and constraints, as `MultibodyPlant` counts them.",
        "- *Exudyn*: freedoms and redundant constraints from `ComputeSystemDegreeOfFreedom`.",
        "",
        "Pinocchio, MuJoCo and Drake close a hinge by two points on its axis, which has one redundant row.",
        "",
        "| mechanism | jointplay: freedoms, rank, instantaneous, **finite**, redundancy | Pinocchio: velocities, rows, rank; μ = 0; μ = 10⁻¹² | MuJoCo: velocities, rows, rank; accelerations; warnings | Drake: velocities, constraints | Exudyn: freedoms, redundant |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for own in truth["mechanisms"]:
        name = own["name"]
        cells = [
            name,
            f"{own['freedoms']}, {own['rank']}, {own['instantaneous']}, **{own['finite']}**, {own['redundancy']}",
            cell(
                pinocchio,
                name,
                lambda result: (
                    f"{result['velocities']}, {result['rows']}, {result['rank_of_its_jacobian']}; "
                    f"{result['accelerations_mu_0']}; {result['accelerations_mu_1e-12']}"
                ),
            ),
            cell(
                mujoco,
                name,
                lambda result: (
                    f"{result['velocities']}, {result['rows']}, {result['rank_of_its_jacobian']}; "
                    f"{result['accelerations']}; {result['warnings']}"
                ),
            ),
            cell(drake, name, lambda result: f"{result['velocities']}, {result['constraints']}"),
            cell(exudyn, name, lambda result: f"{result['degree_of_freedom']}, {result['redundant_constraints']}"),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    lines += ["", *conclusions(truth["mechanisms"], pinocchio, exudyn), ""]
    lines += [
        "## The level robot without virtual joints, commanded to rise and to tilt",
        "",
        "The rods are commanded to rise by 10 mm, which is possible, and then to the lengths of a tilt of 2°, for which no configuration exists.",
        "",
        "| program | method | to rise | to tilt |",
        "| --- | --- | --- | --- |",
    ]

    def asked(name, how, text, own=None):
        peer = results[name]
        answers = [cell(peer, f"gpr-asked-to-{what}", text) for what in ("rise", "tilt")]
        lines.append(f"| {own or name} | {how} | {' | '.join(answers)} |")

    lines.append(f"| jointplay | `jointplay assemble` | {truth['asked_to']['rise']} | {truth['asked_to']['tilt']} |")
    asked(
        "pinocchio",
        "Newton's iteration of the bench on its constraints",
        lambda result: f"ends {result['gap_mm']:.2g} mm open",
        "Pinocchio",
    )
    asked(
        "mujoco",
        "servos on the rods, ten seconds",
        lambda result: (
            f"settles {result['gap_mm']:.2g} mm open, rods {result['rods_off_mm']:.1g} mm off, {result['warnings']} warnings"
        ),
        "MuJoCo",
    )
    asked("drake", "`InverseKinematics`, SNOPT", lambda result: f"`{result['status']}`", "Drake")
    for how in ("default", "ignoring singular Jacobians"):
        asked("exudyn", f"static solver, {how}", lambda result: f"`{result[how]}`", "Exudyn")
    lines += [
        "",
        "Pinocchio has no position solver for loops; the author of the iteration has to check the gap.",
        "MuJoCo has soft constraints by design; the user has to read the gap.",
    ]
    write(out, "words", document, lines)


SCALED = {
    "mobility_dense": ("mobility, dense", THEIRS, "--"),
    "mobility_sparse": ("mobility, sparse", OURS, "-"),
    "drive_dense": ("drive, dense", THEIRS, ":"),
    "drive_sparse": ("drive, sparse", OURS, "-."),
}


def scaling(out, document):
    def seconds(row, key):
        return None if row[key] is None else row[key].get("seconds")

    def cell(row, key):
        if row[key] is None:
            return "–"
        if "error" in row[key]:
            return f"error: {row[key]['error']}"
        return f"{1e3 * row[key]['seconds']:.3g}"

    lines = [
        "# Cost against loops",
        "",
        *about(document, "python3 bench/run.py --only scaling"),
        "Shortest of the repetitions within 0.3 s, on one core; only the ratios are comparable between machines.",
        "",
        "Scissor lifts and rows of Bennett linkages, in ms: *mobility* is instantaneous and finite mobility, *drive* ten steps over 0.1 rad.",
        "Dense algebra is measured up to 30 loops only.",
    ]
    for family, rows in document["work"].items():
        names = [name for name, _, _ in SCALED.values()]
        lines += ["", f"| {family}, loops | joints | finite mobility | {' | '.join(names)} |"]
        lines.append("| ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
        for row in rows:
            cells = [cell(row, key) for key in SCALED]
            finite = (row["mobility_sparse"] or {}).get("answer")
            lines.append(f"| {row['loops']} | {row['joints']} | {finite} | {' | '.join(cells)} |")
    lines += ["", "![Cost against loops](scaling.svg)"]
    write(out, "scaling", document, lines)
    pyplot = charts()
    figure, panels = pyplot.subplots(1, 2, figsize=(9, 3.8), sharey=True, layout="constrained")
    for axes, (family, rows) in zip(panels, document["work"].items()):
        for key, (label, color, line) in SCALED.items():
            points = [(row["loops"], seconds(row, key)) for row in rows if seconds(row, key) is not None]
            axes.plot(*zip(*points), line, color=color, marker="o", markersize=4, label=label)
        axes.set(xscale="log", yscale="log", title=family, xlabel="loops")
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("time, s")
    panels[1].legend(frameon=False)
    save(figure, out / "scaling.svg")


def conclusions(mechanisms, pinocchio, exudyn):
    """Conclusions from the table of mechanisms."""
    lines = [
        "Velocities less rank are the instantaneous mobility; users of Pinocchio or MuJoCo can compute it from these numbers, because neither program reports it."
    ]
    answers = {own["name"]: pinocchio.get(own["name"], {}) for own in mechanisms}
    redundant = [
        name for name, result in answers.items() if "rows" in result and result["rank_of_its_jacobian"] < result["rows"]
    ]
    if redundant:
        finite = [f"*{name}*" for name in redundant if answers[name]["accelerations_mu_0"] == "finite"]
        lines.append(
            f"Redundant rows make Pinocchio's accelerations NaN where μ = 0, without an exception, in {len(redundant) - len(finite)} of {len(redundant)} mechanisms"
            + (f"; because of round-off they are finite for {' and '.join(finite)}." if finite else ".")
        )
        lines.append("With μ > 0 the accelerations are finite, and redundant rows are not reported.")
    lines.append("MuJoCo's rows are soft, and redundant ones are not reported.")
    counted = [(own, exudyn.get(own["name"], {})) for own in mechanisms]
    counted = [(own, result) for own, result in counted if "degree_of_freedom" in result]
    if counted:
        agree = sum(
            (result["degree_of_freedom"], result["redundant_constraints"]) == (own["instantaneous"], own["redundancy"])
            for own, result in counted
        )
        lines.append(
            f"Exudyn reports freedoms and redundancy; both equal the instantaneous values of jointplay in {agree} of {len(mechanisms)} mechanisms."
        )
    infinitesimal = [f"*{own['name']}*" for own in mechanisms if own["finite"] != own["instantaneous"]]
    names = " and ".join(infinitesimal)
    lines.append(f"Only jointplay reports that the finite mobility is smaller, for {names}.")
    return lines


def save(figure, path):
    # No date in the metadata, so that the same numbers produce the same file.
    figure.savefig(path, metadata={"Date": None})
    charts().close(figure)
