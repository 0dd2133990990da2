"""Starts workers and times them, round by round."""

import ctypes
import subprocess
import tempfile
import time
from pathlib import Path

# A round of a fast worker does its work several times over, so that it takes at least this long [s].
LEAST_ROUND = 0.3
_libc = ctypes.CDLL(None)


class Failed(Exception):
    """A worker that could not do its work, and why."""


class Worker:
    def __init__(self, command):
        # Errors go to a file, so that a chatty worker cannot fill a pipe and stall.
        self.errors = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen(
            [str(word) for word in command],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            text=True,
        )
        answer = self._answer("ready")
        self.stride = int(answer[0]) if answer else 1
        self.repeats = 1

    def _answer(self, expected):
        """Words after the expected one; programs may print lines of their own before."""
        for line in self.process.stdout:
            words = line.split()
            if words[:1] == [expected]:
                return words[1:]
        code = self.process.wait()
        self.errors.seek(0)
        lines = [line.strip() for line in self.errors if line.strip()]
        raise Failed(f"ended with {code}: {lines[-1][:300] if lines else 'no output'}")

    def _ask(self, line):
        try:
            self.process.stdin.write(line + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            pass
        return self._answer("done")

    def _cpu(self):
        """CPU time of all threads of the worker [s]."""
        clock = ctypes.c_int()
        if _libc.clock_getcpuclockid(self.process.pid, ctypes.byref(clock)) != 0:
            raise Failed("its clock cannot be read")
        return time.clock_gettime(clock.value)

    def time(self):
        """CPU and wall time of doing all work once [s]."""
        cpu, wall = self._cpu(), time.perf_counter()
        self._ask(f"run {self.repeats}")
        cpu, wall = self._cpu() - cpu, time.perf_counter() - wall
        return cpu / self.repeats, wall / self.repeats

    def call(self, times):
        """CPU time of one single call [s], from so many."""
        cpu = self._cpu()
        self._ask(f"call {times}")
        return (self._cpu() - cpu) / times

    def warm_up(self):
        """Runs unmeasured, and learns how often a round has to repeat the work."""
        cpu, _ = self.time()
        if cpu < LEAST_ROUND:
            cpu, _ = self.time()
        self.repeats = max(1, round(LEAST_ROUND / max(cpu, 1e-6)))

    def answers(self, path):
        """Every answer as a list of numbers, empty where there is none."""
        self._ask(f"write {path}")
        return [[float(word) for word in line.split()] for line in Path(path).read_text().splitlines()]

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=60)
        self.errors.close()


def compare(commands, rounds, folder, note):
    """Runs all workers in turn, round after round.

    Returns by name: times of every round, and the answers; or why there are none.
    """
    workers, results = {}, {}
    for name, command in commands.items():
        note(f"starting {name if isinstance(name, str) else ': '.join(name)}")
        try:
            worker = Worker(command)
            worker.warm_up()
            workers[name] = worker
            results[name] = {"cpu_s": [], "wall_s": [], "stride": worker.stride, "repeats": worker.repeats}
        except (Failed, OSError) as error:
            results[name] = {"failed": str(error)}
    for number in range(rounds):
        note(f"round {number + 1} of {rounds}")
        for name, worker in list(workers.items()):
            try:
                cpu, wall = worker.time()
            except Failed as error:
                results[name] = {"failed": str(error)}
                del workers[name]
                continue
            results[name]["cpu_s"].append(cpu)
            results[name]["wall_s"].append(wall)
    for name, worker in workers.items():
        try:
            results[name]["answers"] = worker.answers(folder / "answers.txt")
            worker.close()
        except Failed as error:
            results[name] = {"failed": str(error)}
    return results
