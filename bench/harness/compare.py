"""Runs the workloads of the bench in sequence: `compare.py BUILD OUT ROUNDS WORK…`; bench/run.py calls it."""

import datetime
import importlib.metadata
import json
import os
import platform
import subprocess
import sys
from pathlib import Path

import check
import mjcf
import report
import robot
import robot_report
import work as workload
import workers

HERE = Path(__file__).resolve().parent
LINKAGES = ["four-bar", "bennett", "sarrus", "3-rps", "hexapod", "delta"]
LOOPS = [1, 2, 5, 10, 20, 30, 50, 100, 200, 500, 1000]
PACKAGES = ["pin", "mujoco", "drake", "exudyn", "scipy", "numpy", "cmeel-eigen", "numba", "jax", "jaxlib", "casadi"]


def note(line):
    print(line, file=sys.stderr, flush=True)


def main(build, out, rounds, only):
    missing = json.loads((build / "missing.json").read_text())
    folder = build / "work"
    subprocess.run([build / "jointplay", "write", folder], check=True)
    out.mkdir(parents=True, exist_ok=True)
    if "gpr" in only:
        document = {**circumstances(missing), "rounds": rounds, "work": robot.work(build, folder, rounds, note)}
        robot_report.report(out, document)
    if "linkages" in only:
        document = {**circumstances(missing), "rounds": rounds, "work": linkages(build, folder, rounds)}
        report.linkages(out, document)
    if "words" in only:
        report.words(out, {**circumstances(missing), "work": words(build, folder.parent / "words")})
    if "scaling" in only:
        report.scaling(out, {**circumstances(missing), "work": scaling(build)})


def linkages(build, folder, rounds):
    """Positions of catalogue mechanisms along a drive, each with the previous one as the initial guess."""
    works = {}
    for name in LINKAGES:
        note(name)
        path = folder / f"{name}.txt"
        work = workload.Linkage.read(path)
        path.with_suffix(".xml").write_text(mjcf.linkage(work))
        commands = {
            "jointplay": [build / "jointplay", "linkage", name],
            "jointplay, many at a time": [build / "jointplay", "linkage", name, "many"],
            "Pinocchio, C++": [build / "pinocchio", "linkage", path],
            "MuJoCo, C": [build / "mujoco", "linkage", path],
            "Pinocchio, Python": robot.peer("pinocchio", "linkage", path),
            "Drake, Newton": robot.peer("drake", "linkage", path),
            "Exudyn, static": robot.peer("exudyn", "linkage", path),
            "SciPy": robot.peer("scipy", "linkage", path),
        }
        results = workers.compare(commands, rounds, folder, note)
        for result in results.values():
            if "answers" in result:
                result.update(check.linkage(work, result.pop("answers")))
        loops = len(work.cuts)
        works[name] = {"positions": len(work.guesses), "loops": loops, "results": results}
    return works


def words(build, folder):
    """Results of each program for mechanisms, by program."""
    subprocess.run([build / "jointplay", "words", folder], check=True)
    results = {"jointplay": json.loads((folder / "jointplay.json").read_text())}
    for name in ["pinocchio", "mujoco", "drake", "exudyn"]:
        note(f"running {name}")
        try:
            done = subprocess.run(
                [sys.executable, HERE / "words.py", name, folder], capture_output=True, text=True, timeout=300, cwd=build
            )
            answers = [line for line in done.stdout.splitlines() if line.startswith("answer ")]
            lines = done.stderr.strip().splitlines() or [f"ended with {done.returncode}"]
            results[name] = json.loads(answers[0].removeprefix("answer ")) if answers else {"failed": lines[-1][:300]}
        except subprocess.TimeoutExpired:
            results[name] = {"failed": "no answer in five minutes"}
    return results


def scaling(build):
    """Computation times of jointplay for mechanisms with many loops, by family."""
    families = {}
    for family in ["scissor-lift", "bennett-row"]:
        families[family] = []
        for loops in LOOPS:
            note(f"{family} of {loops} loops")
            done = subprocess.run([build / "jointplay", "scaling", family, str(loops)], capture_output=True, text=True)
            if done.returncode != 0:
                raise SystemExit(f"scaling {family} {loops} failed: {done.stderr.strip()}")
            families[family].append(json.loads(done.stdout))
    return families


def circumstances(missing):
    """Date, machine and versions of the run."""

    def output(*command):
        """First line of the output of a command."""
        try:
            return subprocess.run(command, capture_output=True, text=True).stdout.splitlines()[0]
        except (FileNotFoundError, IndexError):
            return "unknown version"

    versions = {}
    for package in PACKAGES:
        try:
            versions[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            versions[package] = None
    versions["python"] = platform.python_version()
    versions["rustc"] = output("rustc", "--version").removeprefix("rustc ")
    versions["C++ compiler"] = output(os.environ.get("CXX", "c++"), "--version")
    models = [line for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="minutes"),
        "machine": {
            "processor": models[0].split(":", 1)[1].strip() if models else platform.processor(),
            "cores": os.cpu_count(),
            "system": f"{platform.system()} {platform.release()}",
            "load_average": os.getloadavg(),
        },
        "versions": versions,
        "missing": missing,
    }


if __name__ == "__main__":
    build, out, rounds, *only = sys.argv[1:]
    main(Path(build), Path(out), int(rounds), only)
