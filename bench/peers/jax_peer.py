"""Worker for the closed equations in JAX, all poses at once on one thread: `python jax_peer.py x FILE` or `least FILE`.

The first two Newton steps have no loop and use series for sine and cosine, so that XLA fuses them into few passes.
Poses that have not converged continue in a loop with sine and cosine of JAX.
"""

import os
import sys

# With the flags alone JAX uses two threads; the affinity to one core limits it to one.
os.environ["XLA_FLAGS"] = os.environ.get("XLA_FLAGS", "") + " --xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})

import closed_equations as closed
import jax
import jax.numpy as jnp
import work as workload

jax.config.update("jax_enable_x64", True)


def widest(x):
    turns = [abs(x[3 + j] - x[3 + i]) for i, j in enumerate(closed.NEXT)]
    return jnp.maximum(jnp.maximum(turns[0], turns[1]), turns[2])


def share(own, b):
    """Largest residual as a fraction of the allowed one."""
    ended = [abs(b[k]) / own.half_gap[k] for k in range(3)]
    return jnp.maximum(jnp.maximum(ended[0], ended[1]), ended[2])


def gaps(own, xp, wanted, x):
    at = closed.sides(xp, own, x)
    return at, [wanted[k] - at[k][0] for k in range(3)]


def newton(own, rods):
    wanted = closed.halves(own, rods)

    def step(xp, x):
        at, b = gaps(own, xp, wanted, x)
        return [now + change for now, change in zip(x, closed.step(own, at, b))]

    x = step(closed.Series, closed.start(own, wanted))
    ended = share(own, gaps(own, closed.Series, wanted, x)[1])
    ended = jnp.where(widest(x) <= closed.SERIES, ended, jnp.inf)

    def again(state):
        x, _, steps = state
        x = step(jnp, x)
        return x, share(own, gaps(own, jnp, wanted, x)[1]), steps + 1

    def going(state):
        _, ended, steps = state
        return (ended > 1).any() & (steps < workload.ITERATIONS)

    x, ended, _ = jax.lax.while_loop(going, again, (x, ended, 0))
    return x, ended * own.gap


def least(own, rods):
    wanted = closed.halves(own, rods)
    x = closed.start(own, wanted)

    def step(xp):
        def stepped(x):
            at, b = gaps(own, xp, wanted, x)
            found = closed.step(own, at, closed.pulled(own, at, b, x))
            found = [found[k] + own.radius[k] for k in range(3)] + list(found[3:])
            moved = sum((found[k] - x[k]) ** 2 for k in range(3))
            moved += own.metric**2 * sum((found[k] - x[k]) ** 2 for k in range(3, 6))
            return found, share(own, b), moved

        return stepped

    def again(state):
        x, _, _, steps = state
        near = (widest(x) <= closed.SERIES).all()
        return *jax.lax.cond(near, step(closed.Series), step(jnp), x), steps + 1

    def going(state):
        _, ended, moved, steps = state
        return ((ended > 1) | (moved > own.gap**2)).any() & (steps < workload.ITERATIONS)

    far = jnp.full_like(rods[0], jnp.inf)
    x, ended, _, _ = jax.lax.while_loop(going, again, (x, far, far, 0))
    return x, ended * own.gap


def main(what, path):
    work = workload.Gpr.read(path)
    own = closed.constants(work)
    function = {"x": newton, "least": least}[what]
    kernel = jax.jit(lambda rods: function(own, rods))
    columns = [jnp.asarray(column.copy()) for column in work.poses.T]
    single = [tuple(map(float, rods)) for rods in work.poses]

    def solve():
        return jax.block_until_ready(kernel(columns))

    def call(k):
        return jax.block_until_ready(kernel(single[k % len(single)]))

    solve(), call(0)
    workload.serve(solve, call=call, rows=lambda found: closed.answers(*found, own.gap))


if __name__ == "__main__":
    main(*sys.argv[1:])
