"""Worker for the least displacement of the closed equations with optimisers of CasADi: `python casadi_peer.py ipopt FILE` or `sqpmethod FILE`."""

import sys

import casadi as ca
import closed_equations as closed
import numpy as np
import work as workload

# Computes every 40th pose only, because of the computation time.
STRIDE = 40
OPTIONS = {
    "ipopt": {
        "ipopt.print_level": 0,
        "ipopt.sb": "yes",
        "ipopt.tol": 1e-11,
        "ipopt.constr_viol_tol": 1e-11,
        "ipopt.mu_init": 1e-11,
    },
    "sqpmethod": {
        "qpsol": "qrqp",
        "qpsol_options": {"print_iter": False, "print_header": False, "print_info": False, "error_on_fail": False},
        "print_header": False,
        "print_iteration": False,
        "print_status": False,
        "tol_pr": 1e-11,
        "tol_du": 1e-11,
    },
}


def main(solver, path):
    work = workload.Gpr.read(path)
    own = closed.constants(work)
    y, wanted = ca.SX.sym("y", 6), ca.SX.sym("w", 3)
    values, _ = closed.scaled_sides(ca, own, ca.vertsplit(y))
    problem = {"x": y, "p": wanted, "f": ca.sumsqr(y) / 2, "g": ca.vertcat(*values) - wanted}
    function = ca.nlpsol("least", solver, problem, {"print_time": False, "error_on_fail": False, **OPTIONS[solver]})

    def one(rods):
        return function(x0=0, lbg=0, ubg=0, p=ca.DM(closed.scaled_wanted(own, rods)))["x"]

    def every():
        return [one(rods) for rods in work.poses[::STRIDE]]

    def rows(found):
        answers = [None] * len(work.poses)
        answers[::STRIDE] = [closed.from_scaled(own, np.array(y).ravel()) for y in found]
        return answers

    workload.serve(every, STRIDE, rows=rows)


if __name__ == "__main__":
    main(*sys.argv[1:])
