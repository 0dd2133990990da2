"""Tables, charts and all numbers, as files."""

import json

from quantities import figures, rate

OURS, THEIRS = "#0b6e99", "#b8b8b8"


def charts():
    """The library for charts, without a window; the tables need none."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams.update({"svg.hashsalt": "bench", "svg.fonttype": "path", "font.size": 10})
    from matplotlib import pyplot

    return pyplot


def write(out, name, document, lines):
    out.joinpath(f"{name}.json").write_text(json.dumps(document, indent=1) + "\n")
    out.joinpath(f"{name}.md").write_text("\n".join([*lines, ""]))


def about(document, command):
    """Where the numbers come from, as lines of Markdown."""
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
        f"All programs do the work in one run, in {document['rounds']} rounds in which each takes its turn; the round with the least CPU time counts.",
        "Rates are of one core; on another machine only the ratios mean something.",
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
        "Catalogue mechanisms without virtual joints; 200 positions along the motion of their drives, forward and back, each searched from the one before, the same guess for every program.",
        "Closed: all gaps of points below 10⁻¹³ m, those of hinge directions below 10⁻¹³ rad, computed by one function of the bench.",
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
        "jointplay is `PositionSolver`, which ends at 10⁻¹³ of the characteristic length, and finds the rank itself; *many at a time* is one call of its `solve_many` for all positions, from the same guesses.",
        "Of Pinocchio, MuJoCo and Drake the kinematics and Jacobians are used, with Newton's iteration of the bench; a hinge that closes a loop is five equations, a ball three; the compiled ones solve them by LU where they are square and by normal equations where not, the fastest methods for mechanisms whose ranks are known.",
        "Exudyn closes loops by its own joints, with `ignoreSingularJacobian` where hinges are redundant.",
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
        """The result of a program on a mechanism, or the reason why it has none."""
        result = {"error": peer["failed"]} if "failed" in peer else peer[name]
        return f"error: {result['error']}" if "error" in result else text(result)

    lines = [
        "# Mechanisms: results of each program",
        "",
        *about(document, "python3 bench/run.py --only words"),
        "",
        "Pinocchio, MuJoCo, Drake and Exudyn are general programs for dynamics; counting freedoms is no aim of the first three.",
        "Each is asked what it can be asked of the same mechanism in the same closed configuration.",
        "",
        "- *jointplay*: freedoms of all joints, rank, instantaneous mobility, finite mobility, redundancy (`jointplay mobility`).",
        "- *Pinocchio*: velocities of the open tree, rows of its constraint Jacobian, and the rank that NumPy finds of it; then whether `constraintDynamics` is finite with proximal μ = 0 and with μ = 10⁻¹².",
        "- *MuJoCo*: velocities of the open tree, rows of its equality constraints, and the rank that NumPy finds of them; accelerations, and warnings given.",
        "- *Drake*: velocities of the open tree, and constraints, as `MultibodyPlant` counts them.",
        "- *Exudyn*: freedoms and redundant constraints from `ComputeSystemDegreeOfFreedom`.",
        "",
        "Pinocchio, MuJoCo and Drake close a hinge by two points on its axis, which is one row more than needed.",
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
        "Its rods go up by 10 mm, which they can; then to the lengths of a tilt of 2°, for which there is no configuration.",
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
        "Pinocchio has no position solver for loops of its own; the author of the iteration has to check the gap.",
        "MuJoCo's constraints are soft by design; its user has to read the gap.",
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
        "The shortest of as many times as fit into 0.3 s, one core; on another machine only the ratios mean something.",
        "",
        "Scissor lifts and rows of Bennett linkages, in ms: *mobility* is instantaneous and finite mobility, *drive* ten steps over 0.1 rad.",
        "Dense algebra is not asked beyond 30 loops.",
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
        "Velocities less rank are the instantaneous mobility; users of Pinocchio or MuJoCo compute it so, for neither reports it."
    ]
    answers = {own["name"]: pinocchio.get(own["name"], {}) for own in mechanisms}
    redundant = [
        name for name, result in answers.items() if "rows" in result and result["rank_of_its_jacobian"] < result["rows"]
    ]
    if redundant:
        saved = [f"*{name}*" for name in redundant if answers[name]["accelerations_mu_0"] == "finite"]
        lines.append(
            f"Redundant rows make Pinocchio's accelerations NaN where μ = 0, without an exception, in {len(redundant) - len(saved)} of {len(redundant)} mechanisms"
            + (f"; round-off saves {' and '.join(saved)}." if saved else ".")
        )
        lines.append("With μ > 0 they do no harm, and are not reported.")
    lines.append("MuJoCo's rows are soft, and redundant ones are not reported.")
    counted = [(own, exudyn.get(own["name"], {})) for own in mechanisms]
    counted = [(own, result) for own, result in counted if "degree_of_freedom" in result]
    if counted:
        agree = sum(
            (result["degree_of_freedom"], result["redundant_constraints"]) == (own["instantaneous"], own["redundancy"])
            for own, result in counted
        )
        lines.append(
            f"Exudyn reports freedoms and redundancy itself; both equal jointplay's instantaneous ones in {agree} of {len(mechanisms)} mechanisms."
        )
    infinitesimal = [f"*{own['name']}*" for own in mechanisms if own["finite"] != own["instantaneous"]]
    names = " and ".join(infinitesimal)
    lines.append(f"Only jointplay reports that the finite mobility is smaller, at {names}.")
    return lines


def save(figure, path):
    # Without a date, so that the same numbers give the same file.
    figure.savefig(path, metadata={"Date": None})
    charts().close(figure)
