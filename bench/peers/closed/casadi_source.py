"""Writes the closed equations as C code that CasADi derives and generates: `python casadi_source.py WORK OUT.c`.

Residuals are fractions of the allowed ones.
"""

import sys
from pathlib import Path

import casadi as ca
import closed_equations as closed
import work as workload


def main(path, out):
    work = workload.Gpr.read(path)
    own = closed.constants(work)
    rods, x = ca.SX.sym("q", 3), ca.SX.sym("x", 6)
    wanted = ca.vertcat(*closed.halves(own, [rods[k] for k in range(3)]))
    nominal = ca.DM([*own.radius, 0, 0, 0])
    compliance = ca.diag(ca.DM([1, 1, 1, *[own.stiffness] * 3]))

    def squares(xp, x):
        return ca.vertcat(*(side[0] for side in closed.sides(xp, own, ca.vertsplit(x))))

    def give(jacobian, b):
        weighted = ca.mtimes(compliance, jacobian.T)
        return ca.mtimes(weighted, ca.mtimes(ca.inv_minor(ca.mtimes(jacobian, weighted)), b))

    def share(b):
        return ca.mmax(ca.fabs(b) / ca.DM(own.half_gap))

    def widest(x):
        return ca.mmax(ca.fabs(ca.vertcat(x[4] - x[3], x[5] - x[4], x[3] - x[5])))

    def stepped(xp, x):
        """X after a Newton step, and the residual after it."""
        expression = squares(xp, unknown)
        jacobian = ca.substitute(ca.jacobian(expression, unknown), unknown, x)
        found = x + give(jacobian, wanted - squares(xp, x))
        return found, share(wanted - squares(xp, found))

    def pulled(xp, x):
        """X after a step towards the least displacement, the residual before the step, and the squared length of the step."""
        expression = squares(xp, unknown)
        jacobian = ca.substitute(ca.jacobian(expression, unknown), unknown, x)
        b = wanted - squares(xp, x)
        found = nominal + give(jacobian, ca.mtimes(jacobian, x - nominal) + b)
        moved = found - x
        return found, share(b), ca.sumsqr(moved[:3]) + own.metric**2 * ca.sumsqr(moved[3:])

    unknown = ca.SX.sym("x", 6)
    begun = ca.vertcat(*closed.start(own, ca.vertsplit(wanted)))
    newton, ended = stepped(closed.Series, begun)
    functions = [
        ca.Function("newton", [rods], [newton, ended, widest(newton)]),
        ca.Function("step", [rods, x], stepped(ca, x)),
        ca.Function("start", [rods], [begun]),
        ca.Function("near", [rods, x], [*pulled(closed.Series, x), widest(x)]),
        ca.Function("pull", [rods, x], pulled(ca, x)),
    ]
    generator = ca.CodeGenerator(Path(out).name, {"with_header": False})
    for function in functions:
        generator.add(function)
    generator.generate(f"{Path(out).parent}/")


if __name__ == "__main__":
    main(*sys.argv[1:])
