"""A spatial chain arm with N rotary joints in SymPy, as quick as SymPy can be made: the peer of ``make bench``.

The arm, which ``description`` also writes as an mbsym description: the joints turn about axes 3, 2, 1, 3, 2, 1, ...;
joint k+1 sits on body k at (0, 0, l_k), gravity is (0, 0, -g).

``principal``
    mass centre (0, 0, c_k), principal inertias A_k, B_k, C_k about the mass centre.
``full``
    joint k+1 at (d_k, 0, l_k), mass centre (u_k, v_k, w_k), a full tensor about the joint.

Two roads from the same compact, nested Lagrangian: ``plain`` (plain symbols, the chain rule by hand, the quicker one)
and ``library`` (``LagrangesMethod``).  The last line of the output is JSON; with ``--check`` it holds the largest
relative difference from a numerical Newton-Euler recursion, with ``--timeout`` a run that takes too long says so.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from fractions import Fraction
from types import FrameType
from typing import Any

ROADS = ("plain", "library")
TENSOR = ("Jxx", "Jyy", "Jzz", "Jxy", "Jxz", "Jyz")


class OutOfTimeError(BaseException):
    """Raised by the alarm; not an Exception, so that nothing on the way swallows it."""


def axis(joint: int) -> int:
    """Axis number of joint 1, 2, ...: 3, 2, 1, 3, 2, 1, ..."""
    return (3, 2, 1)[(joint - 1) % 3]


def connection(joint: int, full: bool) -> tuple[str, str, str]:
    """Where the joint sits, in the axes of the body before it."""
    if joint == 1:
        return ("0", "0", "0")
    return (f"d{joint - 1}" if full else "0", "0", f"l{joint - 1}")


def mass_centre(body: int, full: bool) -> tuple[str, str, str]:
    """Mass centre of a body in its own axes."""
    return (f"u{body}", f"v{body}", f"w{body}") if full else ("0", "0", f"c{body}")


def inertia(body: int, full: bool) -> list[list[str]]:
    """Inertia tensor: about the joint (full) or about the mass centre (principal)."""
    if full:
        xx, yy, zz, xy, xz, yz = (f"{name}{body}" for name in TENSOR)
        return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return [[f"A{body}", "0", "0"], ["0", f"B{body}", "0"], ["0", "0", f"C{body}"]]


def parameter_names(joints: int, full: bool) -> list[str]:
    """Every constant of the arm, in a fixed order."""
    names = ["g"]
    for k in range(1, joints + 1):
        rows = inertia(k, full)
        cells = [rows[0][0], rows[1][1], rows[2][2], rows[0][1], rows[0][2], rows[1][2]]
        names += [name for name in (f"m{k}", *connection(k, full), *mass_centre(k, full), *cells) if name != "0"]
    return names


def description(joints: int, full: bool) -> str:
    """The same arm as an mbsym description."""
    lines = ["mbsym: 1", f"name: Spatial arm with {joints} joints", "parameters:"]
    lines += [f"  {name}: {'positive' if name[0] in 'gmlABC' else 'real'}" for name in parameter_names(joints, full)]
    lines.append("bodies:")
    for k in range(1, joints + 1):
        rows = inertia(k, full)
        tensor = (
            "[" + ", ".join(f"[{', '.join(row)}]" for row in rows) + "]"
            if full
            else f"[{', '.join(rows[i][i] for i in range(3))}]"
        )
        lines += [
            f"  - name: link {k}",
            f"    attached to: {f'link {k - 1}' if k > 1 else 0}",
            f"    rotation: {{axes: [{axis(k)}], angles: [q{k}]}}",
            f"    connection point: [{', '.join(connection(k, full))}]",
            f"    mass centre: [{', '.join(mass_centre(k, full))}]",
            f"    mass: m{k}",
            f"    inertia about: {'joint' if full else 'mass centre'}",
            f"    inertia: {tensor}",
        ]
    lines += ["loads:", "  - uniform gravity: {vector: [0, 0, -g]}", ""]
    return "\n".join(lines)


def sample(joints: int, full: bool) -> dict[str, Fraction]:
    """A fixed value for every constant, coordinate, velocity and acceleration (not a physical arm: none is needed)."""

    def stream() -> Iterator[Fraction]:
        state = 12345
        while True:
            state = (1103515245 * state + 12345) % 2**31
            yield Fraction(state % 1999 + 1, 1000)

    names = parameter_names(joints, full)
    names += [f"q{k}{suffix}" for suffix in ("", "_dot", "_ddot") for k in range(1, joints + 1)]
    return dict(zip(names, stream(), strict=False))


def newton_euler(joints: int, full: bool, values: dict[str, float]) -> list[float]:
    """M q'' - f by the numerical Newton-Euler recursion: independent of Lagrange's equations."""
    import numpy as np

    def vector(names: Sequence[str]) -> Any:
        return np.array([values.get(name, 0.0) for name in names])

    omega, alpha, acceleration = np.zeros(3), np.zeros(3), np.array([0.0, 0.0, values["g"]])
    bodies = []
    for k in range(1, joints + 1):
        q, qd, qdd = (values[f"q{k}{suffix}"] for suffix in ("", "_dot", "_ddot"))
        a = axis(k) - 1
        e = np.eye(3)[a]
        c, s = np.cos(q), np.sin(q)
        turn = np.eye(3)
        i, j = (a + 1) % 3, (a + 2) % 3
        turn[i, i] = turn[j, j] = c
        turn[i, j], turn[j, i] = s, -s
        p = vector(connection(k, full))
        acceleration = turn @ (acceleration + np.cross(alpha, p) + np.cross(omega, np.cross(omega, p)))
        before = turn @ omega
        omega = before + qd * e
        alpha = turn @ alpha + qdd * e + np.cross(before, qd * e)
        centre, mass = vector(mass_centre(k, full)), values[f"m{k}"]
        tensor = np.array([vector(row) for row in inertia(k, full)])
        if not full:
            tensor = tensor + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        force = mass * (acceleration + np.cross(alpha, centre) + np.cross(omega, np.cross(omega, centre)))
        moment = (
            tensor @ alpha + np.cross(omega, tensor @ omega) + mass * np.cross(centre, acceleration)
        )  # about the joint
        bodies.append((e, turn, p, force, moment))
    residual = []
    force, moment = np.zeros(3), np.zeros(3)
    for e, turn, p, own_force, own_moment in reversed(bodies):
        force, moment = force + own_force, moment + own_moment
        residual.append(float(e @ moment))
        force, moment = turn.T @ force, turn.T @ moment
        moment = moment + np.cross(p, force)
    return residual[::-1]


def cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """a x b."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def lagrangian(joints: int, full: bool, q: Sequence[Any], qd: Sequence[Any]) -> Any:
    """T + U, nested: nothing is multiplied out."""
    from sympy import S, Symbol, cos, sin

    def symbol(name: str) -> Any:
        return S.Zero if name == "0" else Symbol(name, real=True)

    def turned(number: int, angle: Any, v: Sequence[Any]) -> list[Any]:
        result = list(v)
        i, j = number % 3, (number + 1) % 3
        result[i], result[j] = cos(angle) * v[i] + sin(angle) * v[j], cos(angle) * v[j] - sin(angle) * v[i]
        return result

    omega, velocity, up = [S.Zero] * 3, [S.Zero] * 3, [S.Zero, S.Zero, S.One]
    height: Any = S.Zero
    total: Any = S.Zero
    for k in range(1, joints + 1):
        point = [symbol(name) for name in connection(k, full)]
        centre = [symbol(name) for name in mass_centre(k, full)]
        tensor = [[symbol(name) for name in row] for row in inertia(k, full)]
        mass = symbol(f"m{k}")
        height += dot(up, point)
        moved = [v + x for v, x in zip(velocity, cross(omega, point), strict=True)]
        velocity, up, omega = (turned(axis(k), q[k - 1], v) for v in (moved, up, omega))
        omega[axis(k) - 1] += qd[k - 1]
        swing = cross(omega, centre)
        if full:
            total += mass * (dot(velocity, velocity) / 2 + dot(velocity, swing))
        else:
            speed = [v + x for v, x in zip(velocity, swing, strict=True)]
            total += mass * dot(speed, speed) / 2
        total += sum(tensor[i][i] * omega[i] ** 2 for i in range(3)) / 2
        total += sum(tensor[i][j] * omega[i] * omega[j] for i, j in ((0, 1), (0, 2), (1, 2)))
        total -= mass * symbol("g") * (height + dot(up, centre))
    return total


def plain_equations(lagrangian_: Any, q: Sequence[Any], qd: Sequence[Any]) -> tuple[Any, Any]:
    """M_ij = d2L/dq'_i dq'_j and f_i = dL/dq_i - sum_j d2L/dq'_i dq_j q'_j, in plain symbols."""
    from sympy import Matrix, zeros

    n = len(q)
    momenta = [lagrangian_.diff(v) for v in qd]
    mass = zeros(n, n)
    for i in range(n):
        for j in range(i, n):
            mass[i, j] = mass[j, i] = momenta[i].diff(qd[j])
    forcing = Matrix(
        [lagrangian_.diff(q[i]) - sum(momenta[i].diff(x) * v for x, v in zip(q, qd, strict=True)) for i in range(n)]
    )
    return mass, forcing


def library_equations(lagrangian_: Any, q: Sequence[Any]) -> tuple[Any, Any]:
    """Mass matrix and forcing by ``LagrangesMethod``."""
    from sympy.physics.mechanics import LagrangesMethod

    method = LagrangesMethod(lagrangian_, q)
    method.form_lagranges_equations()
    return method.mass_matrix, method.forcing


def check(joints: int, full: bool, equations: tuple[Any, Any], q: Sequence[Any], qd: Sequence[Any]) -> float:
    """The largest difference from Newton-Euler at one state, relative to the largest residual."""
    from sympy import Float, Matrix, Symbol

    values = {name: float(value) for name, value in sample(joints, full).items()}
    point: dict[Any, Any] = {Symbol(name, real=True): Float(values[name]) for name in parameter_names(joints, full)}
    point |= {x: Float(values[f"q{k}"]) for k, x in enumerate(q, 1)}
    point |= {v: Float(values[f"q{k}_dot"]) for k, v in enumerate(qd, 1)}
    mass, forcing = (part.xreplace(point).evalf() for part in equations)
    mine = mass * Matrix([values[f"q{k}_ddot"] for k in range(1, joints + 1)]) - forcing
    truth = newton_euler(joints, full, values)
    scale = max(abs(value) for value in truth)
    return max(abs(float(mine[i]) - truth[i]) for i in range(joints)) / scale


def derive(joints: int, full: bool, road: str, checked: bool, record: dict[str, Any]) -> None:
    """Derive the equations and write what was measured into ``record``."""
    clock = time.perf_counter
    seconds: dict[str, float] = record["seconds"]
    start = clock()
    from sympy import Symbol, count_ops

    if road == "library":
        from sympy.physics.mechanics import dynamicsymbols
    seconds["import"] = clock() - start

    start = clock()
    names = [f"q{k}" for k in range(1, joints + 1)]
    if road == "library":
        q = [dynamicsymbols(name) for name in names]
        qd = [x.diff() for x in q]
    else:
        q = [Symbol(name) for name in names]
        qd = [Symbol(f"{name}_dot") for name in names]
    lagrangian_ = lagrangian(joints, full, q, qd)
    seconds["build"] = clock() - start

    start = clock()
    equations = library_equations(lagrangian_, q) if road == "library" else plain_equations(lagrangian_, q, qd)
    seconds["equations"] = clock() - start

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    record["peak_mb"] = peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6
    if checked:
        record["operations"] = {
            "lagrangian": int(count_ops(lagrangian_)),
            "mass_matrix": int(sum(count_ops(x) for x in equations[0])),
            "forcing": int(sum(count_ops(x) for x in equations[1])),
        }
        record["difference"] = check(joints, full, equations, q, qd)


def main() -> None:
    """Derive one arm and print the JSON record."""
    parser = argparse.ArgumentParser(description="a spatial arm in SymPy")
    parser.add_argument("joints", type=int)
    parser.add_argument("kind", nargs="?", choices=("principal", "full"), default="principal")
    parser.add_argument("--road", choices=ROADS, default="plain")
    parser.add_argument("--timeout", type=float, default=0.0, help="give up after so many seconds (0: never)")
    parser.add_argument("--check", action="store_true", help="compare with Newton-Euler afterwards, count operations")
    parser.add_argument("--description", action="store_true", help="only print the arm as an mbsym description")
    options = parser.parse_args()
    # An unbounded cache makes SymPy a quarter quicker here; it is read when sympy is imported.
    os.environ.setdefault("SYMPY_CACHE_SIZE", "None")
    full = options.kind == "full"
    if options.description:
        print(description(options.joints, full), end="")
        return

    def alarm(_signal: int, _frame: FrameType | None) -> None:
        raise OutOfTimeError

    record: dict[str, Any] = {
        "joints": options.joints,
        "kind": options.kind,
        "road": options.road,
        "seconds": {},
        "timed_out": False,
    }
    signal.signal(signal.SIGALRM, alarm)
    signal.setitimer(signal.ITIMER_REAL, options.timeout)
    try:
        derive(options.joints, full, options.road, options.check, record)
    except OutOfTimeError:
        record["timed_out"] = True
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    print(json.dumps(record))


if __name__ == "__main__":
    main()
