"""Writes tables of the results into README.md and the performance page: `documents.py RESULTS ROOT`; bench/run.py calls it.

A table is between a line `<!-- bench: NAME -->` and a line `<!-- bench: end -->`, which remain.
"""

import re
import sys
from pathlib import Path

import ratios
import robot_report
from quantities import figures, quantity, rate, time

PAGES = ("README.md", "docs/explanation/performance.md")
BLOCK = re.compile(r"(<!-- bench: (?!end)([a-z-]+) -->\n).*?(<!-- bench: end -->)", re.DOTALL)
# Rows of the table of the README: row of the ratios, and input of the programs.
SHOWN = {
    "polar, X": "equations of the robot, many poses at a time",
    "polar, X and pose": "the same, with pose",
    "polar, least X": "the same, least displacement",
    "single call, from Rust": "equations of the robot, a single call",
    "any mechanism, robot with virtual joints": "links and joints",
}


def main(results, root):
    documents = ratios.load(results)
    tables = {name: table(documents) for name, table in TABLES.items()}
    for page in PAGES:
        path = root / page
        path.write_text(filled(path.read_text(), tables))


def filled(text, tables):
    """Page with new tables; tables without results remain unchanged."""

    def block(match):
        begin, name, end = match.groups()
        if name not in tables:
            raise SystemExit(f"there is no table {name!r}; tables are {', '.join(tables)}")
        lines = tables[name]
        return match[0] if lines is None else "\n".join([begin.rstrip("\n"), *lines, end])

    return BLOCK.sub(block, text)


def amounts(row):
    """Numbers of jointplay and of the other program, in the unit of the row."""
    if "own" in row:
        return f"{quantity(row['own'])}/s", f"{quantity(row['other'])}/s"
    return time(row["own_s"]), time(row["other_s"])


def readme(documents):
    found = ratios.rows({work: documents[work] for work in documents if work == "gpr"})
    if not found:
        return None
    lines = ["| work, given | jointplay | best other program | factor |", "| --- | ---: | --- | ---: |"]
    for name, given in SHOWN.items():
        if name in found:
            own, other = amounts(found[name])
            lines.append(f"| {given} | {own} | {found[name]['best']}, {other} | {found[name]['ratio']:.2g} |")
    return lines


def factors(documents):
    found = ratios.rows(documents)
    if not found:
        return None
    lines = ["| row | jointplay | compared with | factor |", "| --- | ---: | --- | ---: |"]
    for name, row in found.items():
        own, other = amounts(row)
        lines.append(f"| {name} | {own} | {row['best']}, {other} | {row['ratio']:.2g} |")
    return lines


def measured(documents):
    if "gpr" not in documents:
        return None
    dates = sorted({document["date"][:10] for document in documents.values()})
    machines = sorted({document["machine"]["processor"] for document in documents.values()})
    return [f"Measured on {' and '.join(dates)}, {' and '.join(machines)}."]


def programs(family):
    def table(documents):
        if "gpr" not in documents:
            return None
        work = documents["gpr"]["work"]
        rates = robot_report.rates_of(work["families"][family], work["poses"])
        unit = next(iter(work["families"][family]))
        lines = [f"| program | poses/s | × {unit} |", "| --- | ---: | ---: |"]
        for name in sorted(rates, key=lambda name: -rates[name]):
            lines.append(f"| {name} | {quantity(rates[name])} | {figures(rates[name] / rates[unit])} |")
        return lines

    return table


def of_robot(lines):
    """Function that returns the table within a section of the report of the robot."""

    def table(documents):
        if "gpr" not in documents:
            return None
        return [line for line in lines(documents["gpr"]["work"]) if line.startswith("|")]

    return table


def linkages(documents):
    if "linkages" not in documents:
        return None
    works = documents["linkages"]["work"]
    lines = [f"| program | {' | '.join(works)} |", f"| --- | {' | '.join('---:' for _ in works)} |"]
    times = {
        mechanism: {
            name: 1e6 / rate(result, work["positions"]) for name, result in work["results"].items() if "cpu_s" in result
        }
        for mechanism, work in works.items()
    }
    for name in next(iter(works.values()))["results"]:
        cells = [
            f"{figures(times[mechanism][name])} ({figures(times[mechanism][name] / times[mechanism]['jointplay'])}×)"
            if name in times[mechanism]
            else "failed"
            for mechanism in works
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return lines


def scaling(documents):
    if "scaling" not in documents:
        return None
    keys = ("mobility_dense", "mobility_sparse", "drive_dense", "drive_sparse")
    lines = [
        f"| bennett-row, loops | joints | {' | '.join(key.replace('_', ', ') for key in keys)} |",
        "| ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for row in documents["scaling"]["work"]["bennett-row"]:
        if row["loops"] not in (1, 10, 30, 100, 1000):
            continue
        cells = [figures(1e3 * row[key]["seconds"]) if row[key] and "seconds" in row[key] else "–" for key in keys]
        lines.append(f"| {row['loops']} | {row['joints']} | {' | '.join(cells)} |")
    return lines


TABLES = {
    "readme": readme,
    "factors": factors,
    "measured": measured,
    "closed": programs("closed"),
    "least": programs("least"),
    "general": programs("general"),
    "calls": of_robot(lambda work: robot_report.calls(work["calls"])),
    "million": of_robot(robot_report.million),
    "limits": of_robot(lambda work: robot_report.limits(work["limits"])),
    "linkages": linkages,
    "scaling": scaling,
}


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
