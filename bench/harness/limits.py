"""Limits of the machine, and the share of them that jointplay reaches, in bytes and operations."""

import re
import subprocess
from collections import Counter
from pathlib import Path

import workers

HERE = Path(__file__).resolve().parent
# Arithmetic instructions for doubles in the output of objdump, and the number of lanes of each register.
ARITHMETIC = re.compile(r"v?(add|sub|mul|div|sqrt|rcp14|rsqrt14|fn?m(?:add|sub|addsub|subadd)(?:132|213|231))(sd|pd)$")
LANES = {"zmm": 8, "ymm": 4, "xmm": 2}


def build(out, march, run, reason):
    """Compiles the two helper programs; returns the failed builds with their reasons."""
    missing = {}
    for name, compiler, flags in (
        ("machine.cpp", "c++", ["-O3", march, "-std=c++17"]),
        ("steps.c", "cc", ["-O2", "-w"]),
    ):
        done = run([compiler, *flags, HERE / name, "-o", out / Path(name).stem])
        if done.returncode != 0:
            missing[f"harness, {name}"] = reason(done)
    return missing


def machine(build, footprints, rounds, folder, note):
    """Operations per second, and bytes per second of copies of each footprint."""
    asked = {name: [build / "machine", name, 0] for name in ("fma", "divide", "root")}
    asked |= {f"copy {size}": [build / "machine", "copy", size] for size in footprints}
    found = workers.compare(asked, rounds, folder, note)
    return {
        name: result["answers"][0][0] / min(result["cpu_s"]) if "cpu_s" in result else None for name, result in found.items()
    }


def operations(build, command, request):
    """Arithmetic operations that a worker executes for a command, counted from its instructions by single-stepping."""
    worker = workers.Worker(command)
    worker._ask(request)
    pid = worker.process.pid
    stepping = subprocess.Popen(
        [build / "steps", str(pid)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    if stepping.stdout.readline().strip() != "attached":
        raise workers.Failed(f"instructions cannot be counted: {stepping.stderr.read().strip()}")
    files = mapped(pid)
    worker._ask(request)
    lines, errors = stepping.communicate()
    worker.close()
    if stepping.returncode != 0:
        raise workers.Failed(f"instructions cannot be counted: {errors.strip()}")
    executed = [(int(address, 16), int(count)) for address, count in map(str.split, lines.splitlines())]
    return sort(executed, files)


def mapped(pid):
    """Files in the memory map of a process: start, end, base, path."""
    base, found = {}, []
    for line in Path(f"/proc/{pid}/maps").read_text().splitlines():
        span, _, _, _, _, *path = line.split()
        if not path or not path[0].startswith("/"):
            continue
        start, end = (int(word, 16) for word in span.split("-"))
        base.setdefault(path[0], start)
        found.append((start, end, base[path[0]], path[0]))
    return found


def sort(executed, files):
    """Counts of all instructions, floating-point operations, divisions and roots."""
    counts, names = Counter(), {}
    for address, count in executed:
        counts["instructions"] += count
        where = next((one for one in files if one[0] <= address < one[1]), None)
        if where is None:
            continue
        _, _, base, path = where
        if path not in names:
            names[path] = disassembled(path)
        text = names[path].get(address - base)
        kind = text and ARITHMETIC.match(text.split()[0])
        if not kind:
            continue
        lanes = 1
        if kind[2] == "pd":
            lanes = max(size for register, size in LANES.items() if register in text)
        counts["operations"] += count * lanes * (2 if kind[1].startswith("f") else 1)
        counts["divisions"] += count * lanes * (kind[1] == "div")
        counts["roots"] += count * lanes * (kind[1] == "sqrt")
    return counts


def disassembled(path):
    """Text of each instruction of a file, by address."""
    listing = subprocess.run(["objdump", "-d", "--no-show-raw-insn", path], capture_output=True, text=True)
    pairs = (line.split(":\t", 1) for line in listing.stdout.splitlines() if ":\t" in line)
    return {int(address, 16): text for address, text in pairs}


def bound(figure, rates):
    """Poses per second that each limit allows: bytes, operations, and divisions with roots; the smallest is the bound."""
    allowed = {}
    if copied := rates.get(f"copy {figure['footprint']}"):
        allowed["bytes"] = copied / figure["bytes"]
    if rates["fma"]:
        allowed["operations"] = 2 * rates["fma"] / figure["operations"]
    slow = sum(figure[kind] / rates[name] for kind, name in (("divisions", "divide"), ("roots", "root")) if rates[name])
    if slow:
        allowed["divisions and roots"] = 1 / slow
    return allowed
