"""How long one pose takes from Python, and a million: `python python/speed.py`."""

from __future__ import annotations

import time
import timeit
from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np

import jointplay as jp

POSES = 1_000_000


def call_ns(call: Callable[[], object]) -> float:
    """The least of several means, less what an empty call takes [ns]."""
    number = 100_000

    def least(function: Callable[[], object]) -> float:
        return min(timeit.repeat(function, number=number, repeat=7, timer=time.thread_time)) / number * 1e9

    return least(call) - least(lambda: None)


def per_pose_ns(work: Callable[[], object]) -> float:
    """The least of several runs, for each pose [ns]."""
    times = []
    for _ in range(7):
        start = time.thread_time()
        work()
        times.append(time.thread_time() - start)
    return min(times) / POSES * 1e9


def main() -> None:
    gpr = jp.Gpr.paper().without_limit_checks()
    rods, array = (0.5, 0.501, 0.502), np.array([0.5, 0.501, 0.502])
    print("one call [ns of processor time]")
    print(f"  inverse                        {call_ns(lambda: gpr.inverse(0.3, 0.02, 0.5)):8.0f}")
    print(f"  forward, tuple, planar         {call_ns(lambda: gpr.forward(rods)):8.0f}")
    print(f"  forward, array, planar         {call_ns(lambda: gpr.forward(array)):8.0f}")
    print(f"  forward, tuple, polar          {call_ns(lambda: gpr.forward(rods, 'polar')):8.0f}")
    many = np.random.default_rng(1).uniform(0.498, 0.502, (POSES, 3))
    tilts = gpr.forward(many, quantities=["azimuth_rad", "tilt_rad"])
    out = {"azimuth_rad": np.empty(POSES), "tilt_rad": np.empty(POSES), "origin_m": np.empty((POSES, 3), order="F")}
    rods_out = np.empty((POSES, 3), order="F")
    print(f"{POSES} poses, one thread [ns of processor time for each]")
    inverse = per_pose_ns(lambda: gpr.inverse(tilts.azimuth_rad, tilts.tilt_rad, threads=1, out=rods_out))
    print(f"  inverse                        {inverse:8.1f}")
    models: list[Literal["planar", "radial", "polar", "offset"]] = ["planar", "radial", "polar", "offset"]
    for name in models:
        forward = per_pose_ns(partial(gpr.forward, many, name, threads=1, out=out))
        print(f"  forward, {name:7} tilt, origin {forward:8.1f}")
    everything = per_pose_ns(lambda: gpr.forward(many, threads=1))
    print(f"  forward, planar, all, new      {everything:8.1f}")


if __name__ == "__main__":
    main()
