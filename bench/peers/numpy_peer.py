"""Worker for the closed equations in NumPy, in blocks of poses: `python numpy_peer.py x FILE` or `least FILE`."""

import math
import sys

import closed_equations as closed
import numpy as np
import work as workload

# Number of poses in a block, whose arrays fit into the cache.
BLOCK = 1200


def iterate(own, wanted, least):
    """X of a block and its residual; converged poses continue with the others, which is faster than separating them."""
    x = closed.start(own, wanted)
    settled = not least
    for _ in range(workload.ITERATIONS):
        at = closed.sides(np, own, x)
        b = [wanted[k] - at[k][0] for k in range(3)]
        share = np.maximum(np.abs(b[0]) / own.half_gap[0], np.abs(b[1]) / own.half_gap[1])
        share = np.maximum(share, np.abs(b[2]) / own.half_gap[2])
        if settled and share.max() <= 1:
            break
        if not least:
            x = [now + change for now, change in zip(x, closed.step(own, at, b))]
            continue
        found = closed.step(own, at, closed.pulled(own, at, b, x))
        found = [found[k] + own.radius[k] for k in range(3)] + list(found[3:])
        slid = sum((found[k] - x[k]) ** 2 for k in range(3))
        turned = sum((found[k] - x[k]) ** 2 for k in range(3, 6))
        settled = (slid + own.metric**2 * turned).max() <= own.gap**2
        x = found
    return x, share * own.gap


def one(own, wanted):
    """X of a single pose by Newton's iteration with Python numbers, which are faster than small arrays."""
    x = closed.start(own, wanted)
    for _ in range(workload.ITERATIONS):
        at = closed.sides(math, own, x)
        b = [wanted[k] - at[k][0] for k in range(3)]
        share = max(abs(gap) / allowed for gap, allowed in zip(b, own.half_gap))
        if share <= 1:
            break
        x = [now + change for now, change in zip(x, closed.step(own, at, b))]
    return x, share * own.gap


def main(what, path):
    work = workload.Gpr.read(path)
    own, columns = closed.constants(work), np.ascontiguousarray(work.poses.T)
    count = columns.shape[1]
    x, residual = np.empty((6, count)), np.empty(count)

    def solve():
        for first in range(0, count, BLOCK):
            block = slice(first, first + BLOCK)
            x[:, block], residual[block] = iterate(own, closed.halves(own, columns[:, block]), what == "least")
        return x, residual

    single = [tuple(map(float, rods)) for rods in work.poses]

    def call(k):
        return one(own, closed.halves(own, single[k % count]))

    workload.serve(solve, call=call, rows=lambda found: closed.answers(*found, own.gap))


if __name__ == "__main__":
    main(*sys.argv[1:])
