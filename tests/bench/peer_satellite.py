"""The satellite with a gravitational stabilizer in SymPy, as quick as SymPy can be made: the peer of ``make bench``.

Four roads, all from the same compact Lagrangian, written by hand, nested and never expanded:

``library``
    ``LagrangesMethod`` and its own ``Linearizer``: what the documentation of ``sympy.physics.mechanics`` teaches.
``restricted``
    ``LagrangesMethod``; the linearisation puts every variable but one to zero *before* it differentiates.
``jacobian``
    no mechanics library at all: coordinates and velocities are plain symbols and d/dt is the chain rule by hand; the
    linear matrices are Jacobians of the equations, put to zero afterwards: the script that an expert writes first.
``plain``
    the same equations; linearised like ``restricted``: the script that an expert writes when the first is too slow.

The Lagrangian is the motion about the point O1 of the orbit, T_rel + U_2, with everything constant dropped.  That is
less than the description file says (O1 itself moves, first-order gravity); leaving it out is a favour to the peer.

The last line of the output is JSON: seconds per stage, peak memory and, with ``--check``, operation counts and the
differences from the formulas of Banshchikov & Vetrov (equation (3) and Figure 5) and from an independent residual.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import time
from collections.abc import Sequence
from fractions import Fraction
from typing import Any

ROADS = ("library", "restricted", "jacobian", "plain")
#: Those without a mechanics library.
BY_HAND = ("jacobian", "plain")
COORDINATES = ("psi", "theta", "phi", "delta", "sigma")
PARAMETERS = ("J_x", "J_y", "J_z", "m", "m_0", "l", "r", "omega_0")

#: A state, and the residuals d/dt dL/dq' - dL/dq there, found without Lagrange's equations (d'Alembert's principle
#: on point masses with finite differences at 70 digits).
STATE: dict[str, tuple[str, ...]] = {
    "parameters": ("2.405", "1.144", "2.242", "0.604", "1.327", "4.293", "0.863", "0.346"),
    "q": ("1.096", "0.592", "0.903", "0.110", "1.228"),
    "qd": ("0.329", "0.545", "-1.805", "0.132", "-0.752"),
    "qdd": ("-1.454", "-1.367", "1.304", "-1.241", "-1.383"),
    "residual": (
        "-107.373553147863186264050307883",
        "-40.5373096388997418908890967830",
        "-38.6730120719058583868564111453",
        "32.5602284699055933094139077959",
        "-24.0774014779379181758914752374",
    ),
}


def peak_memory_mb() -> float:
    """The largest resident memory this process has had, in MB (10^6 bytes)."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak * 1024 / 1e6


def lagrangian(q: Sequence[Any], qd: Sequence[Any], parameters: Sequence[Any]) -> Any:
    """T_rel + U_2, nested: the angular velocities of satellite and rod are not multiplied out."""
    from sympy import cos, sin

    psi, theta, phi, delta, sigma = q
    psi_d, theta_d, phi_d, delta_d, sigma_d = qd
    j_x, j_y, j_z, m, m_0, l, r, omega_0 = parameters
    # satellite: angular velocity in its own axes
    w_x = phi_d + psi_d * sin(theta) + omega_0 * cos(theta) * sin(psi)
    w_y = (
        theta_d * sin(phi)
        + psi_d * cos(theta) * cos(phi)
        - omega_0 * (sin(phi) * cos(psi) + sin(theta) * cos(phi) * sin(psi))
    )
    w_z = (
        theta_d * cos(phi)
        - psi_d * cos(theta) * sin(phi)
        + omega_0 * (sin(theta) * sin(phi) * sin(psi) - cos(phi) * cos(psi))
    )
    # rod: the two components of its angular velocity across the rod
    v_x = w_x * cos(delta) + w_y * sin(delta) + sigma_d
    v_z = delta_d * cos(sigma) + w_x * sin(delta) * sin(sigma) - w_y * sin(sigma) * cos(delta) + w_z * cos(sigma)
    mu_0, mu_1, mu_2 = m + m_0, (m / 2 + m_0) * l, (m / 3 + m_0) * l**2
    kinetic = (
        j_x * w_x**2 + j_y * w_y**2 + j_z * w_z**2 + mu_0 * r**2 * (w_x**2 + w_z**2) + mu_2 * (v_x**2 + v_z**2)
    ) / 2 + mu_1 * r * (w_z * cos(delta) * v_z + (w_x * cos(sigma) - w_z * sin(delta) * sin(sigma)) * v_x)
    # gravity to second order: e is the outward radius, u the direction of the rod
    e_x, e_y, e_z = sin(theta), cos(theta) * cos(phi), -cos(theta) * sin(phi)
    u_y = cos(delta) * cos(sigma)
    eu = -sin(delta) * cos(sigma) * e_x + u_y * e_y + sin(sigma) * e_z
    force_function = omega_0**2 * (
        (-3 * (j_x * e_x**2 + j_y * e_y**2 + j_z * e_z**2) + 3 * mu_0 * r**2 * e_y**2 + 3 * mu_2 * eu**2) / 2
        + mu_1 * r * (3 * e_y * eu - u_y)
    )
    return kinetic + force_function


def lagrange_equations(lagrangian_: Any, q: Sequence[Any]) -> tuple[Any, Any, Any]:
    """Mass matrix, forcing and the ``LagrangesMethod`` they come from."""
    from sympy.physics.mechanics import LagrangesMethod

    method = LagrangesMethod(lagrangian_, q)
    method.form_lagranges_equations()
    return method.mass_matrix, method.forcing, method


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


def linearise_library(method: Any, q: Sequence[Any], qd: Sequence[Any]) -> tuple[Any, Any, Any]:
    """M, D + G, K + N by ``LagrangesMethod.to_linearizer`` at zero."""
    n = len(q)
    point = dict.fromkeys([*q, *qd, *(v.diff() for v in qd)], 0)
    big_m, big_a, _ = method.to_linearizer(q_ind=list(q), qd_ind=list(qd)).linearize(op_point=point)
    return big_m[n:, n:], -big_a[n:, n:], -big_a[n:, :n]


def linearise_restricted(mass: Any, forcing: Any, q: Sequence[Any], qd: Sequence[Any]) -> tuple[Any, Any, Any]:
    """M, D + G, K + N from M(q) and f(q, q'): all variables but one are zero before f is differentiated."""
    from sympy import Dummy, S, zeros

    n = len(q)
    everything = [*q, *qd]
    point = dict.fromkeys(everything, S.Zero)
    # a velocity may be a Derivative of its coordinate: a Dummy takes the place of the variable that is kept
    kept = Dummy("kept")
    stiffness_damping = zeros(n, 2 * n)
    for j, variable in enumerate(everything):
        line = forcing.xreplace(point | {variable: kept})
        stiffness_damping[:, j] = -line.diff(kept).xreplace({kept: S.Zero})
    return mass.xreplace(point), stiffness_damping[:, n:], stiffness_damping[:, :n]


def linearise_jacobian(mass: Any, forcing: Any, q: Sequence[Any], qd: Sequence[Any]) -> tuple[Any, Any, Any]:
    """M, D + G, K + N: Jacobians of the forcing as they come, everything put to zero afterwards."""
    point = dict.fromkeys([*q, *qd], 0)
    return mass.subs(point), -forcing.jacobian(qd).subs(point), -forcing.jacobian(q).subs(point)


def paper_linear_form(parameters: dict[str, Fraction]) -> tuple[list[list[Fraction]], ...]:
    """M, G, K of the paper's equation (3), put together for q = (psi, theta, phi, delta, sigma), in time t."""
    j_x, j_y, j_z, m, m_0, l, r, omega_0 = (parameters[name] for name in PARAMETERS)
    a, b = j_y, j_x + m * r * (l + r) + m * l**2 / 3 + m_0 * (l + r) ** 2
    c, d = b + j_z - j_x, (m / 3 + m_0) * l**2
    f = (m / 2 + m_0) * r * l + d
    w, ww = omega_0, omega_0**2
    zero = Fraction(0)
    mass = [[zero] * 5 for _ in range(5)]
    gyroscopic, stiffness = [row[:] for row in mass], [row[:] for row in mass]
    pitch, yaw_roll = (1, 3), (0, 2, 4)
    for rows, target, block in (
        (pitch, mass, [[c, f], [f, d]]),
        (pitch, stiffness, [[3 * ww * (b - a), 3 * ww * f], [3 * ww * f, 3 * ww * f]]),
        (yaw_roll, mass, [[a, zero, zero], [zero, b, f], [zero, f, d]]),
        (yaw_roll, gyroscopic, [[zero, w * (c - b - a), zero], [w * (a + b - c), zero, zero], [zero] * 3]),
        (
            yaw_roll,
            stiffness,
            [
                [ww * (c - b), zero, zero],
                [zero, 4 * ww * (c - a), 4 * ww * f],
                [zero, 4 * ww * f, ww * (3 * f + d)],
            ],
        ),
    ):
        for i, row in zip(rows, block, strict=True):
            for j, value in zip(rows, row, strict=True):
                target[i][j] = value
    return mass, gyroscopic, stiffness


def figure_5(values: dict[str, Any]) -> dict[str, Any]:
    """Coefficients of delta'', sigma'' and phi'' in the equation of theta, as Figure 5 prints them."""
    from sympy import cos, sin

    m, m_0, l, r = (values[name] for name in ("m", "m_0", "l", "r"))
    phi, delta, sigma = (values[name] for name in ("phi", "delta", "sigma"))
    return {
        "delta": l
        * (
            -l * cos(delta) * sin(2 * sigma) * sin(phi) * (m + 3 * m_0)
            + cos(sigma) * cos(phi) * (3 * r * cos(delta) * (m + 2 * m_0) + 2 * l * cos(sigma) * (m + 3 * m_0))
        )
        / 6,
        "sigma": l
        * sin(delta)
        * (-3 * r * cos(phi) * sin(sigma) * (m + 2 * m_0) + 2 * l * sin(phi) * (m + 3 * m_0))
        / 6,
        "phi": l
        * sin(delta)
        * (
            l * m * cos(phi) * sin(2 * sigma)
            + m * cos(sigma) * (3 * r + 2 * l * cos(delta) * cos(sigma)) * sin(phi)
            + 3 * m_0 * (l * cos(phi) * sin(2 * sigma) + 2 * cos(sigma) * (r + l * cos(delta) * cos(sigma)) * sin(phi))
        )
        / 6,
    }


def check(
    equations: tuple[Any, Any], linear: tuple[Any, Any, Any], q: Sequence[Any], qd: Sequence[Any], symbols_: Any
) -> dict[str, float]:
    """Largest differences from the paper and from the independent residual; the linear ones must be exactly zero."""
    from sympy import Matrix, Rational

    mass, forcing = equations
    given = {name: Fraction(text) for name, text in zip(PARAMETERS, STATE["parameters"], strict=True)}
    exact = {s: Rational(given[name]) for name, s in zip(PARAMETERS, symbols_, strict=True)}
    differences: dict[str, float] = {}
    for name, matrix, truth in zip(("M", "G", "K"), linear, paper_linear_form(given), strict=True):
        values = matrix.xreplace(exact)
        differences[f"linear_{name}"] = float(
            max(abs(values[i, j] - Rational(truth[i][j])) for i in range(5) for j in range(5))
        )
    state = dict(exact)
    state.update({x: Rational(text) for x, text in zip(q, STATE["q"], strict=True)})
    state.update({v: Rational(text) for v, text in zip(qd, STATE["qd"], strict=True)})
    mass_value, forcing_value = (part.xreplace(state).evalf(40) for part in (mass, forcing))
    by_name = dict(zip(PARAMETERS, symbols_, strict=True)) | dict(zip(COORDINATES, q, strict=True))
    printed = figure_5({name: state[symbol] for name, symbol in by_name.items()})
    differences["figure_5"] = float(
        max(abs(mass_value[1, COORDINATES.index(name)] - value.evalf(40)) for name, value in printed.items())
    )
    residual = mass_value * Matrix([Rational(text) for text in STATE["qdd"]]) - forcing_value
    differences["residual"] = float(
        max(abs(residual[i] - Rational(STATE["residual"][i])) for i in range(len(COORDINATES)))
    )
    return differences


def main() -> None:
    """Derive the satellite by one road and print the JSON record."""
    parser = argparse.ArgumentParser(description="the satellite in SymPy")
    parser.add_argument("--road", choices=ROADS, default="library")
    parser.add_argument("--check", action="store_true", help="compare with the paper afterwards, count operations")
    options = parser.parse_args()
    # An unbounded cache makes SymPy a quarter quicker here; it is read when sympy is imported.
    os.environ.setdefault("SYMPY_CACHE_SIZE", "None")

    clock = time.perf_counter
    seconds: dict[str, float] = {}
    start = clock()
    from sympy import count_ops, symbols

    if options.road not in BY_HAND:
        from sympy.physics.mechanics import dynamicsymbols
    seconds["import"] = clock() - start

    start = clock()
    parameters = symbols(PARAMETERS, positive=True)
    if options.road in BY_HAND:
        q = symbols(COORDINATES)
        qd = symbols([f"{name}_dot" for name in COORDINATES])
    else:
        q = dynamicsymbols(COORDINATES)
        qd = [x.diff() for x in q]
    lagrangian_ = lagrangian(q, qd, parameters)
    seconds["build"] = clock() - start

    start = clock()
    method = None
    if options.road in BY_HAND:
        mass, forcing = plain_equations(lagrangian_, q, qd)
    else:
        mass, forcing, method = lagrange_equations(lagrangian_, q)
    seconds["equations"] = clock() - start

    start = clock()
    if options.road == "library":
        linear = linearise_library(method, q, qd)
    elif options.road == "jacobian":
        linear = linearise_jacobian(mass, forcing, q, qd)
    else:
        linear = linearise_restricted(mass, forcing, q, qd)
    seconds["linearisation"] = clock() - start

    record: dict[str, Any] = {"road": options.road, "seconds": seconds, "peak_mb": peak_memory_mb()}
    if options.check:
        record["operations"] = {
            "lagrangian": int(count_ops(lagrangian_)),
            "mass_matrix": int(sum(count_ops(x) for x in mass)),
            "forcing": int(sum(count_ops(x) for x in forcing)),
        }
        record["differences"] = check((mass, forcing), linear, q, qd, parameters)
    print(json.dumps(record))


if __name__ == "__main__":
    main()
