"""Worker for the Python package of jointplay: `python jointplay_peer.py FILE [COPIES [THREADS]]`; COPIES repeats the poses."""

import sys

import jointplay
import numpy as np
import work as workload


def main(path, copies="1", threads="1"):
    work = workload.Gpr.read(path)
    gpr = robot(work)
    options = {"virtualization": "polar", "solver": "newton", "metric": work.metric}
    rods = np.asfortranarray(np.tile(work.poses, (int(copies), 1)))
    out = {"virtual_joints": np.empty((len(rods), 6), order="F"), "residual_m": np.empty(len(rods))}
    single = [tuple(map(float, each)) for each in work.poses]
    count, number = len(single), int(threads)

    def solve():
        return gpr.forward(rods, **options, out=out, threads=number)

    def call(k):
        return gpr.forward(single[k % count], "polar", solver="newton", metric=work.metric)

    def rows(found):
        return [list(x) if status == 0 else None for x, status in zip(found.virtual_joints, found.status)]

    workload.serve(solve, call=call, rows=rows)


def robot(work):
    """The robot of the workload with the tilt limit of the paper, which is not checked."""
    return jointplay.Gpr(
        socket_radius_m=work.radius,
        socket_angle_rad=np.arctan2(work.direction[:, 1], work.direction[:, 0]),
        base_points_m=work.base,
        rod_limits_m=(0.0, 1.0),
        tilt_limit_rad=np.radians(1.5),
        working_height_m=work.height,
        check_limits=False,
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
