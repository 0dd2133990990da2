"""Cost of long studies: time, bytes and memory by the number of samples, and the extrapolation to a billion.

    python3 validation/study_cost.py path/to/jointplay [--samples 1e6 2e6 5e6 1e7] [--study FILE] [--folder DIR]

For developers, and for users who plan a study on a cluster; too slow for `cargo xtask test`.
Each size is computed by one thread in parts, then gathered.
Times are those of the processor, so that other programs on the machine change them little; memory is the largest resident set of the process.
A straight line is fitted to the times of all sizes but the largest, by least squares of relative errors.
Its error at the largest size, which is predicted and then measured, is the stated error of the extrapolation.
The last table computes the largest study by one, two, … tasks at a time, and compares the sums of their processor times: equal sums are linear scaling as long as each task has a core.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

STUDY = """kind = "study"
name = "cost"
samples = {samples}
seed = 1
quantities = ["center_shift_um", "tilt_error_urad"]

[pose]
tilt_x_deg = {{ normal = [0, 0.5] }}
tilt_y_deg = {{ normal = [0, 0.5] }}
height_mm = {{ uniform = [350, 650] }}
"""

BILLION = 1e9


@dataclass
class Run:
    """Resources of a process."""

    cpu_s: float
    wall_s: float
    memory_mb: float


def waited(process: subprocess.Popen[bytes], start: float) -> Run:
    """Resources of a process at its end."""
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{process.args}: exit code {process.returncode}")
    return Run(usage.ru_utime + usage.ru_stime, time.monotonic() - start, usage.ru_maxrss / 1024)


def started(command: str, *arguments: str | Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen([command, "study", *map(str, arguments), "--quiet"], stdout=subprocess.DEVNULL)


def run(command: str, *arguments: str | Path) -> Run:
    start = time.monotonic()
    return waited(started(command, *arguments), start)


def fit(sizes: list[float], times: list[float]) -> tuple[float, float]:
    """Constant a and slope b of the line a + b n with the least sum of squared relative errors."""
    # Weighted normal equations of two unknowns.
    weights = [1 / (t * t) for t in times]
    s = sum(weights)
    sx = sum(w * x for w, x in zip(weights, sizes))
    sxx = sum(w * x * x for w, x in zip(weights, sizes))
    sy = sum(w * y for w, y in zip(weights, times))
    sxy = sum(w * x * y for w, x, y in zip(weights, sizes, times))
    determinant = s * sxx - sx * sx
    return (sxx * sy - sx * sxy) / determinant, (s * sxy - sx * sy) / determinant


def bytes_of(folder: Path) -> int:
    return sum(file.stat().st_size for file in folder.iterdir() if file.name != "study.json")


def main() -> None:
    parser = argparse.ArgumentParser(description="cost of long studies")
    parser.add_argument("command")
    parser.add_argument("--samples", type=float, nargs="+", default=[1e6, 2e6, 5e6, 1e7])
    parser.add_argument("--study", type=Path, help="study file with {samples} in place of a number")
    parser.add_argument("--folder", type=Path, help="folder with room for the tables")
    chosen = parser.parse_args()
    sizes = sorted(chosen.samples)
    if len(sizes) < 3 or sizes[0] <= 0:
        parser.error("at least three positive numbers of samples are needed")
    text = chosen.study.read_text("utf-8") if chosen.study else STUDY
    work = Path(tempfile.mkdtemp(prefix="jointplay-cost-", dir=chosen.folder))
    try:
        measure(chosen.command, text, sizes, work)
    finally:
        shutil.rmtree(work)


def measure(command: str, text: str, sizes: list[float], work: Path) -> None:
    computed: list[float] = []
    gathered: list[float] = []
    size = 0.0
    print(f"{'samples':>12} {'CPU s':>9} {'samples/CPU s':>14} {'bytes/sample':>13} {'MB':>6} {'gather CPU s':>13} {'MB':>6}")
    for samples in sizes:
        file, parts = work / "study.toml", work / "parts"
        file.write_text(text.replace("{{", "{").replace("}}", "}").replace("{samples}", str(int(samples))), "utf-8")
        compute = run(command, file, "--parts", parts, "--threads", "1")
        size = bytes_of(parts) / samples
        gather = run(command, "--parts", parts, "--gather", work / f"all{table(parts)}", "--force", "--threads", "1")
        print(
            f"{int(samples):>12} {compute.cpu_s:>9.2f} {samples / compute.cpu_s:>14.3g} {size:>13.1f}"
            f" {compute.memory_mb:>6.0f} {gather.cpu_s:>13.2f} {gather.memory_mb:>6.0f}",
            flush=True,
        )
        computed.append(compute.cpu_s)
        gathered.append(gather.cpu_s)
        shutil.rmtree(parts)
    for what, times in (("compute", computed), ("gather", gathered)):
        a, b = fit(sizes[:-1], times[:-1])
        error = (a + b * sizes[-1]) / times[-1] - 1
        a, b = fit(sizes, times)
        at_billion = a + b * BILLION
        print(
            f"{what}: {a:.2f} s + {b * 1e9:.1f} ns per sample; of the largest size predicted with {error:+.1%}"
            f"; 1e9 samples take {at_billion / 3600:.2f} core hours"
        )
    print(f"table: 1e9 samples take {size * BILLION / 1e9:.0f} GB")
    tasks(command, work)


def tasks(command: str, work: Path) -> None:
    """The study of the largest size as one, two, … tasks at a time."""
    print(f"{'tasks':>6} {'sum of CPU s':>13} {'wall s':>8} {'largest MB':>11}")
    count, cores = 1, os.cpu_count() or 1
    while count <= cores:
        parts = work / f"tasks-{count}"
        start = time.monotonic()
        running = [
            started(command, work / "study.toml", "--parts", parts, "--part", f"{k}/{count}", "--threads", "1")
            for k in range(count)
        ]
        runs = [waited(process, start) for process in running]
        print(
            f"{count:>6} {sum(one.cpu_s for one in runs):>13.2f} {time.monotonic() - start:>8.2f}"
            f" {max(one.memory_mb for one in runs):>11.0f}",
            flush=True,
        )
        shutil.rmtree(parts)
        count *= 2


def table(parts: Path) -> str:
    """The ending of the tables of a folder of parts."""
    return ".parquet" if any(parts.glob("*.parquet")) else ".csv"


if __name__ == "__main__":
    sys.exit(main())
