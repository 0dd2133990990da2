"""Time and memory of the studio's server for a long program, compared with those of `jointplay cell check`.

    python3 studio/long_program.py target/release/jointplay 10000

The program moves a wafer from one load port of the example cell to the other and back, so many times.
Linux only: memory is read from /proc.
"""

import json
import re
import resource
import subprocess
import sys
import tempfile
import time
import urllib.request
from pathlib import Path


EXAMPLE = Path(__file__).parent.parent / "crates/jointplay-format/cells" / "example.toml"


def program(lines: int) -> str:
    routes = (("LP1", "LP2"), ("LP2", "LP1"))
    move = "TRANSFER {} SLOT 1 TO {} SLOT 1 WITH A\n"
    return "HOME\n" + "".join(move.format(*routes[k % 2]) for k in range(lines))


def checked(command: str, cell: Path, text: Path) -> tuple[float, int]:
    """Seconds and peak memory [kB] of the command."""
    start = time.perf_counter()
    subprocess.run([command, "cell", "check", str(cell), str(text)], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss


class Server:
    def __init__(self, command: str, cell: Path) -> None:
        words = [command, "studio", "--no-open", "--port", "0", "--cell", str(cell)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        found = None
        while found is None:
            line = self.process.stdout.readline()
            if not line:
                raise SystemExit("the studio ended")
            found = re.search(r"http://127\.0\.0\.1:\d+/", line)
        self.address = found.group(0) + "api/v1/"

    def ask(self, path: str, body: object = None) -> tuple[bytes, int, float]:
        """The answer, the bytes sent and received, and the seconds."""
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data=data)
        if data is not None:
            request.add_header("content-type", "application/json")
        start = time.perf_counter()
        with urllib.request.urlopen(request, timeout=300) as answer:
            read = answer.read()
        return read, len(read) + len(data or b""), time.perf_counter() - start

    def peak(self) -> int:
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmHWM:\s+(\d+)", status).group(1))

    def stop(self) -> None:
        self.process.terminate()
        self.process.wait()


def shown(server: Server, plan: dict, known: set[str], at: float) -> tuple[int, float]:
    """Fetches what the page needs to draw a moment: bytes and seconds."""
    starts = [window["start_s"] for window in plan["windows"]]
    window = max(k for k, start in enumerate(starts) if start <= at)
    paths = [f"cell/scenes/{plan['scene']}"] + [f"cell/windows/{one['key']}" for one in plan["windows"][window : window + 2]]
    answers = [server.ask(path) for path in paths if path not in known]
    known.update(paths)
    return sum(size for _, size, _ in answers), sum(took for _, _, took in answers)


def main() -> None:
    command, lines = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10_000
    with tempfile.TemporaryDirectory() as folder:
        cell, text = Path(folder, "long.toml"), Path(folder, "long.program")
        cell.write_text(EXAMPLE.read_text())
        text.write_text(program(lines))
        took, peak = checked(command, cell, text)
        print(f"program: {lines} lines, {text.stat().st_size / 1e3:.0f} kB")
        print(f"cell check: {took:.2f} s, peak memory {peak / 1024:.0f} MiB")
        server = Server(command, cell)
        try:
            known: set[str] = set()
            answer, size, planned = server.ask("cell/plan", {})
            plan = json.loads(answer)
            assert plan["report"]["result"] == "passed", plan["diagnostics"][:3]
            more, drawn = shown(server, plan, known, 0.0)
            print(f"plan and first picture: {planned + drawn:.2f} s ({(planned + drawn) / took:.1f} times the check), {(size + more) / 1e3:.0f} kB")
            middle = plan["report"]["duration_s"] / 2
            more, drawn = shown(server, plan, known, middle)
            print(f"picture at {middle:.0f} s: {drawn:.3f} s, {more / 1e3:.0f} kB")
            change = {"plan": plan["key"], "program": {"from": lines // 2, "count": 0, "lines": ["WAIT 1 s"]}}
            answer, size, planned = server.ask("cell/plan", {"since": change})
            plan = json.loads(answer)
            more, drawn = shown(server, plan, known, middle)
            print(f"one line more in the middle: {planned + drawn:.2f} s, {(size + more) / 1e3:.0f} kB sent and received")
            print(f"server: peak memory {server.peak() / 1024:.0f} MiB")
        finally:
            server.stop()


if __name__ == "__main__":
    main()
