"""Worker for the closed equations compiled by Numba: `python numba_peer.py x FILE` or `least FILE`.

A loop without branches, which the compiler vectorizes, performs two steps for every pose.
A second loop solves the poses that have not converged.
"""

import math
import sys

import closed_equations as closed
import numba
import numpy as np
import work as workload

fast = numba.njit(fastmath=True, error_model="numpy", inline="always")
whole = numba.njit(fastmath=True, error_model="numpy")


def kernels(own):
    """Functions that contain the dimensions of the robot as compile-time constants."""
    (r0, r1, r2), (c0, c1, c2), (s0, s1, s2) = own.radius, own.cosine, own.sine
    (v0, v1, v2), (n0, n1, n2) = own.level, own.nominal
    g0, g1, g2 = (1 / gap for gap in own.half_gap)
    first, stiffness, gap, metric = np.array(own.first), own.stiffness, own.gap, own.metric
    f = [[float(number) for number in row] for row in first]
    (f00, f01, f02), (f10, f11, f12), (f20, f21, f22) = f[:3]
    (f30, f31, f32), (f40, f41, f42), (f50, f51, f52) = f[3:]
    series_sin, series_cos, limit = fast(closed.Series.sin), fast(closed.Series.cos), closed.SERIES

    @fast
    def side(li, lj, s, c, cosine, sine):
        along, across = cosine * c - sine * s, sine * c + cosine * s
        return 0.5 * (li * li + lj * lj) - li * lj * along, li - lj * along, lj - li * along, li * lj * across

    @fast
    def solve(at0, at1, at2, b0, b1, b2):
        (_, i0, j0, t0), (_, i1, j1, t1), (_, i2, j2, t2) = at0, at1, at2
        k0, k1, k2 = stiffness * t0, stiffness * t1, stiffness * t2
        xx, yy, zz = i0 * i0 + j0 * j0 + 2 * k0 * t0, i1 * i1 + j1 * j1 + 2 * k1 * t1, i2 * i2 + j2 * j2 + 2 * k2 * t2
        xy, yz, xz = j0 * i1 - k0 * t1, j1 * i2 - k1 * t2, i0 * j2 - k0 * t2
        cxx, cxy, cxz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - yy * xz
        cyy, cyz, czz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
        inverse = 1 / (xx * cxx + xy * cxy + xz * cxz)
        p = (cxx * b0 + cxy * b1 + cxz * b2) * inverse
        q = (cxy * b0 + cyy * b1 + cyz * b2) * inverse
        r = (cxz * b0 + cyz * b1 + czz * b2) * inverse
        return (
            i0 * p + j2 * r,
            i1 * q + j0 * p,
            i2 * r + j1 * q,
            k2 * r - k0 * p,
            k0 * p - k1 * q,
            k1 * q - k2 * r,
        )

    @fast
    def wanted(a, b, c):
        return 0.5 * (v0 + (b - a) * (b - a)), 0.5 * (v1 + (c - b) * (c - b)), 0.5 * (v2 + (a - c) * (a - c))

    @fast
    def begin(w0, w1, w2):
        b0, b1, b2 = w0 - n0, w1 - n1, w2 - n2
        return (
            r0 + f00 * b0 + f01 * b1 + f02 * b2,
            r1 + f10 * b0 + f11 * b1 + f12 * b2,
            r2 + f20 * b0 + f21 * b1 + f22 * b2,
            f30 * b0 + f31 * b1 + f32 * b2,
            f40 * b0 + f41 * b1 + f42 * b2,
            f50 * b0 + f51 * b1 + f52 * b2,
        )

    @fast
    def near(l0, l1, l2, p0, p1, p2):
        """Sides, with series for sine and cosine."""
        a, b, c = p1 - p0, p2 - p1, p0 - p2
        return (
            side(l0, l1, series_sin(a), series_cos(a), c0, s0),
            side(l1, l2, series_sin(b), series_cos(b), c1, s1),
            side(l2, l0, series_sin(c), series_cos(c), c2, s2),
        )

    @fast
    def far(l0, l1, l2, p0, p1, p2):
        """Sides, with sine and cosine of the library."""
        a, b, c = p1 - p0, p2 - p1, p0 - p2
        return (
            side(l0, l1, math.sin(a), math.cos(a), c0, s0),
            side(l1, l2, math.sin(b), math.cos(b), c1, s1),
            side(l2, l0, math.sin(c), math.cos(c), c2, s2),
        )

    @fast
    def ended(b0, b1, b2):
        return max(abs(b0) * g0, abs(b1) * g1, abs(b2) * g2)

    @fast
    def pulled(at0, at1, at2, b0, b1, b2, l0, l1, l2, p0, p1, p2):
        d0, d1, d2 = l0 - r0, l1 - r1, l2 - r2
        return (
            b0 + at0[1] * d0 + at0[2] * d1 + at0[3] * (p1 - p0),
            b1 + at1[1] * d1 + at1[2] * d2 + at1[3] * (p2 - p1),
            b2 + at2[1] * d2 + at2[2] * d0 + at2[3] * (p0 - p2),
        )

    @whole
    def one(a, b, c, least):
        w0, w1, w2 = wanted(a, b, c)
        l0, l1, l2, p0, p1, p2 = begin(w0, w1, w2)
        settled, share = not least, math.inf
        for _ in range(workload.ITERATIONS):
            at0, at1, at2 = far(l0, l1, l2, p0, p1, p2)
            b0, b1, b2 = w0 - at0[0], w1 - at1[0], w2 - at2[0]
            share = ended(b0, b1, b2)
            if settled and share <= 1.0:
                break
            if not least:
                x0, x1, x2, y0, y1, y2 = solve(at0, at1, at2, b0, b1, b2)
                l0, l1, l2, p0, p1, p2 = l0 + x0, l1 + x1, l2 + x2, p0 + y0, p1 + y1, p2 + y2
                continue
            b0, b1, b2 = pulled(at0, at1, at2, b0, b1, b2, l0, l1, l2, p0, p1, p2)
            x0, x1, x2, y0, y1, y2 = solve(at0, at1, at2, b0, b1, b2)
            x0, x1, x2 = x0 + r0, x1 + r1, x2 + r2
            slid = (x0 - l0) ** 2 + (x1 - l1) ** 2 + (x2 - l2) ** 2
            turned = (y0 - p0) ** 2 + (y1 - p1) ** 2 + (y2 - p2) ** 2
            settled = slid + metric * metric * turned <= gap * gap
            l0, l1, l2, p0, p1, p2 = x0, x1, x2, y0, y1, y2
        return l0, l1, l2, p0, p1, p2, share * gap

    @whole
    def newton(rods, out, residual):
        qa, qb, qc = rods[0], rods[1], rods[2]
        x0, x1, x2, y0, y1, y2 = out[0], out[1], out[2], out[3], out[4], out[5]
        for k in range(rods.shape[1]):
            w0, w1, w2 = wanted(qa[k], qb[k], qc[k])
            l0, l1, l2, p0, p1, p2 = begin(w0, w1, w2)
            at0, at1, at2 = near(l0, l1, l2, p0, p1, p2)
            d0, d1, d2, e0, e1, e2 = solve(at0, at1, at2, w0 - at0[0], w1 - at1[0], w2 - at2[0])
            l0, l1, l2, p0, p1, p2 = l0 + d0, l1 + d1, l2 + d2, p0 + e0, p1 + e1, p2 + e2
            at0, at1, at2 = near(l0, l1, l2, p0, p1, p2)
            share = ended(w0 - at0[0], w1 - at1[0], w2 - at2[0])
            widest = max(abs(p1 - p0), abs(p2 - p1), abs(p0 - p2))
            x0[k], x1[k], x2[k], y0[k], y1[k], y2[k] = l0, l1, l2, p0, p1, p2
            residual[k] = share * gap if widest <= limit else 1.0
        for k in range(rods.shape[1]):
            if residual[k] > gap:
                x0[k], x1[k], x2[k], y0[k], y1[k], y2[k], residual[k] = one(qa[k], qb[k], qc[k], False)

    @whole
    def least(rods, out, residual):
        for k in range(rods.shape[1]):
            found = one(rods[0, k], rods[1, k], rods[2, k], True)
            for m in range(6):
                out[m, k] = found[m]
            residual[k] = found[6]

    return {"x": newton, "least": least}, one


def main(what, path):
    work = workload.Gpr.read(path)
    functions, one = kernels(closed.constants(work))
    kernel = functions[what]
    columns = np.ascontiguousarray(work.poses.T)
    count = columns.shape[1]
    x, residual = np.empty((6, count)), np.empty(count)

    def solve():
        kernel(columns, x, residual)
        return x, residual

    single = [tuple(map(float, rods)) for rods in work.poses]

    def call(k):
        return one(*single[k % count], what == "least")

    solve(), call(0)
    workload.serve(solve, call=call, rows=lambda found: closed.answers(*found, work.gap))


if __name__ == "__main__":
    main(*sys.argv[1:])
