"""Starts workers and times them, round by round."""

import ctypes
import subprocess
import tempfile
import time
from pathlib import Path

# Least duration of a round; fast workers repeat their work within a round [s].
LEAST_ROUND = 0.3
_libc = ctypes.CDLL(None)


class Failed(Exception):
    """Failure of a worker, with the reason."""


class Worker:
    def __init__(self, command):
        # Errors are written to a file, because a full pipe would block the worker.
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
        """Reads lines up to the expected word, and returns the words after it; programs may print other lines before."""
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
            raise Failed("the CPU clock of the worker cannot be read")
        return time.clock_gettime(clock.value)

    def time(self):
        """CPU and wall time of the whole work [s]."""
        cpu, wall = self._cpu(), time.perf_counter()
        self._ask(f"run {self.repeats}")
        cpu, wall = self._cpu() - cpu, time.perf_counter() - wall
        return cpu / self.repeats, wall / self.repeats

    def call(self, times):
        """CPU time of a single call, as the mean of `times` calls [s]."""
        cpu = self._cpu()
        self._ask(f"call {times}")
        return (self._cpu() - cpu) / times

    def warm_up(self):
        """Runs without measurement, and determines how often a round repeats the work."""
        cpu, _ = self.time()
        if cpu < LEAST_ROUND:
            cpu, _ = self.time()
        self.repeats = max(1, round(LEAST_ROUND / max(cpu, 1e-6)))

    def answers(self, path):
        """Answers as lists of numbers, empty without a solution."""
        self._ask(f"write {path}")
        return [[float(word) for word in line.split()] for line in Path(path).read_text().splitlines()]

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=60)
        self.errors.close()


def compare(commands, rounds, folder, note):
    """Runs all workers alternately in rounds.

    Returns by name the times of all rounds and the answers, or the reason of a failure.
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
