"""The shipped double pendulum over 10 s as a short script with SciPy or heyoka: 2001 rows (t, q, q') of CSV on stdout.

    python tests/bench/peer_pendulum.py scipy|heyoka

By hand, with m = l = 1, the directions a, b of the rods from the downward vertical, d = a - b:

    2 a'' + cos d b'' = -sin d b'^2 - 2 g sin a,    cos d a'' + b'' = sin d a'^2 - g sin b
"""

import sys

GRAVITY, END, ROWS, TOLERANCE = 9.81, 10.0, 2001, 1e-9
START = [1.0, 1.5, 0.0, 0.0]


def rates(a, b, u, v, sin, cos):  # type: ignore[no-untyped-def]
    """a', b', a'', b''."""
    s, c = sin(a - b), cos(a - b)
    first, second = -s * v * v - 2 * GRAVITY * sin(a), s * u * u - GRAVITY * sin(b)
    whole = 2 - c * c
    return [u, v, (first - c * second) / whole, (2 * second - c * first) / whole]


def by_scipy(times):  # type: ignore[no-untyped-def]
    from math import cos, sin

    from scipy.integrate import solve_ivp

    span = (0, END)
    return solve_ivp(lambda t, x: rates(*x, sin, cos), span, START, "DOP853", times, rtol=TOLERANCE, atol=TOLERANCE).y.T


def by_heyoka(times):  # type: ignore[no-untyped-def]
    import heyoka

    names = heyoka.make_vars("a", "b", "u", "v")
    equations = list(zip(names, rates(*names, heyoka.sin, heyoka.cos), strict=True))
    return heyoka.taylor_adaptive(equations, START, tol=TOLERANCE).propagate_grid(times)[-1]


if __name__ == "__main__":
    import numpy as np

    times = np.linspace(0, END, ROWS)
    a, b, u, v = (by_scipy if sys.argv[1] == "scipy" else by_heyoka)(times).T
    np.savetxt(sys.stdout, np.column_stack([times, a, b - a, u, v - u]), "%.15g", ",", header="t,q1,q2,u1,u2")
