"""Kernels at ratios of 1e12: against equations written by hand and evaluated with 300 bits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction as F
from math import log10
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import system_of
from flint import arb, arb_mat, ctx, fmpq

import mbsym
from mbsym.expressions.tree import Number
from mbsym.numerics import compensation as module
from mbsym.numerics.compensation import compensated_code
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.methods.interface import Setting, machine_code
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import Scenario, scenario

ROOT = Path(__file__).parents[2]
BITS = 300
State = Sequence[Any]


def ball(x: Any) -> Any:
    top, bottom = x.as_integer_ratio()
    return arb(fmpq(int(top), int(bottom)))


def text(name: str, parameters: str, bodies: str, loads: str, initial: str) -> Scenario:
    parts = [f"mbsym: 1\nname: {name}\nparameters: {parameters}\nbodies:\n{bodies}"]
    parts += [f"loads:\n{loads}"] if loads else []
    return scenario(mbsym.loads("\n".join([*parts, f"initial: {initial}", ""])).system)


def given_of(name: str, **values: F) -> Scenario:
    found = system_of(ROOT / "systems" / f"{name}.yaml")
    return scenario(found, {key: Number(value) for key, value in values.items()}, assumed=False)


def digits(given: Scenario, truth: Callable[[dict[str, Any], State], list[Any]], state: Sequence[float]) -> float:
    """Of the worst acceleration of its own, in the kernel that simulations use, at a state of doubles."""
    dynamics = Dynamics(given)
    n = dynamics.size
    found = kernel(machine_code(dynamics, "right_hand_side"))(np.array([0.0, *state]))[n:]
    with ctx.workprec(BITS):
        parameters = {name: ball(value) for name, value in given.parameters.items()}
        exact = truth(parameters, [ball(x) for x in state])
        errors = [float(abs((arb(float(v)) - x) / x).mid()) for v, x in zip(found, exact, strict=True)]
    return min(16.0, -log10(max(*errors, 1e-17)))


# --- equations by hand -----------------------------------------------------------------------------------------------


def compound(p: dict[str, Any], x: State) -> list[Any]:
    """Two bodies in a plane, in the angles a and b from the downward vertical; M in absolute angles cancels nothing.

    (J1 + m1 c1^2 + m2 l^2) a'' + m2 l c2 cos(a - b) b'' = -m2 l c2 sin(a - b) b'^2 - (m1 c1 + m2 l) g sin a
    m2 l c2 cos(a - b) a'' + (J2 + m2 c2^2) b'' = m2 l c2 sin(a - b) a'^2 - m2 g c2 sin b
    """
    a, b, da, db = x[0], x[0] + x[1], x[2], x[2] + x[3]
    s, c, mixed = (a - b).sin(), (a - b).cos(), p["m2"] * p["l"] * p["c2"]
    m = arb_mat(2, 2, [p["J1"] + p["m1"] * p["c1"] ** 2 + p["m2"] * p["l"] ** 2, mixed * c, mixed * c,
                       p["J2"] + p["m2"] * p["c2"] ** 2])  # fmt: skip
    f = [
        -mixed * s * db * db - (p["m1"] * p["c1"] + p["m2"] * p["l"]) * p["g"] * a.sin(),
        mixed * s * da * da - p["m2"] * p["g"] * p["c2"] * b.sin(),
    ]
    found = m.solve(arb_mat(2, 1, f))
    return [found[0, 0], found[1, 0] - found[0, 0]]


COMPOUND = """
  - {name: upper, attached to: 0, rotation: {axes: [3], angles: [u]}, mass centre: [0, -c1, 0], mass: m1,
     inertia about: mass centre, inertia: [J1, J1, J1]}
  - {name: lower, attached to: upper, rotation: {axes: [3], angles: [v]}, connection point: [0, -l, 0],
     mass centre: [0, -c2, 0], mass: m2, inertia about: mass centre, inertia: [J2, J2, J2]}
"""


def compound_of(**values: F) -> Scenario:
    usual = {"m1": F(1), "m2": F(1), "c1": F(1, 2), "c2": F(1, 3), "l": F(1), "J1": F(1, 10), "J2": F(1, 7)} | values
    parameters = ", ".join(f"{name}: {value}" for name, value in ({"g": F(981, 100)} | usual).items())
    gravity = "  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}"
    return text("Compound", f"{{{parameters}}}", COMPOUND, gravity, "{u: 1, v: 1/2}")


def points(p: dict[str, Any], x: State) -> list[Any]:
    """Two points on massless rods: the same equations, with c1 = l, J = 0."""
    whole = p | {"l": p["l1"], "c1": p["l1"], "c2": p["l2"], "J1": arb(0), "J2": arb(0)}
    return compound(whole, x)


def spring(p: dict[str, Any], x: State) -> list[Any]:
    """r theta'' + 2 r' theta' = -g sin theta,  r'' - r theta'^2 = g cos theta - k (r - l0)/m."""
    theta, r, dtheta, dr = x
    return [
        -(2 * dr * dtheta + p["g"] * theta.sin()) / r,
        r * dtheta * dtheta + p["g"] * theta.cos() - p["k"] * (r - p["l0"]) / p["m"],
    ]


def top(p: dict[str, Any], x: State) -> list[Any]:
    """A, A, C turned by alpha about 1, beta about 2, phi about 3, w = phi' + alpha' sin beta constant:

    A (alpha'' cos^2 beta - 2 alpha' beta' sin beta cos beta) + C w beta' cos beta = m g l sin alpha cos beta
    A beta'' + A alpha'^2 sin beta cos beta - C w alpha' cos beta = m g l cos alpha sin beta
    phi'' = -alpha'' sin beta - alpha' beta' cos beta
    """
    alpha, beta, _, da, db, dphi = x
    s, c = beta.sin(), beta.cos()
    w, weight = dphi + da * s, p["m"] * p["g"] * p["l"]
    first = (2 * p["A"] * da * db * s - p["C"] * w * db + weight * alpha.sin()) / (p["A"] * c)
    second = (p["C"] * w * da * c - p["A"] * da * da * s * c + weight * alpha.cos() * s) / p["A"]
    return [first, second, -first * s - da * db * c]


def free_body(p: dict[str, Any], x: State) -> list[Any]:
    """Euler's equations, and the rates of turns 3, 2, 1 by w: C = C1(w) C2(v) C3(u).

    omega = (w' - u' sin v,  v' cos w + u' cos v sin w,  u' cos v cos w - v' sin w)
    """
    _, v, w, du, dv, dw = x
    sv, cv, sw, cw = v.sin(), v.cos(), w.sin(), w.cos()
    o = [dw - du * sv, dv * cw + du * cv * sw, du * cv * cw - dv * sw]
    a, b, c = p["A"], p["B"], p["C"]
    rates = [(b - c) / a * o[1] * o[2], (c - a) / b * o[2] * o[0], (a - b) / c * o[0] * o[1]]
    # o = E(v, w) (du, dv, dw): E x'' = o' - E' x'.
    own = [
        -du * dv * cv,
        -dv * dw * sw - du * dv * sv * sw + du * dw * cv * cw,
        -du * dv * sv * cw - du * dw * cv * sw - dv * dw * cw,
    ]
    left = [r - t for r, t in zip(rates, own, strict=True)]
    ddu = (left[1] * sw + left[2] * cw) / cv
    return [ddu, left[1] * cw - left[2] * sw, left[0] + ddu * sv]


BODY = """
  - {name: body, attached to: 0, rotation: {axes: [3, 2, 1], angles: [u, v, w]}, mass: 1,
     inertia about: mass centre, inertia: [A, B, C]}
"""


def body_of(**values: F) -> Scenario:
    parameters = ", ".join(f"{name}: {value}" for name, value in ({"A": F(2), "B": F(3), "C": F(4)} | values).items())
    return text("Body", f"{{{parameters}}}", BODY, "", "{u: 1, v: 1/2, w: 1/3}")


LINK = """
  - {name: b%d, attached to: %s, rotation: {axes: [3], angles: [q%d]}, connection point: [0, %d, 0],
     mass centre: [0, -1/2, 0], mass: m%d, inertia about: mass centre, inertia: [m%d/12, m%d/12, m%d/12]}
"""


def chain_of(masses: Sequence[F]) -> Scenario:
    """Rods of length 1."""
    rows = [
        LINK % (k, f"b{k - 1}" if k > 1 else "0", k, -1 if k > 1 else 0, k, k, k, k) for k in range(1, len(masses) + 1)
    ]
    parameters = ", ".join(["g: 9.81", *(f"m{k}: {m}" for k, m in enumerate(masses, 1))])
    initial = ", ".join(f"q{k}: 1/{k}" for k in range(1, len(masses) + 1))
    gravity = "  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}"
    return text("Chain", f"{{{parameters}}}", "".join(rows), gravity, f"{{{initial}}}")


def chain(p: dict[str, Any], x: State) -> list[Any]:
    """In absolute angles a_i:  sum_j c_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) = -g w_i sin a_i

    w_i = m_i/2 + sum_{k > i} m_k,  c_ij = w_max(i, j),  c_ii = m_i/3 + sum_{k > i} m_k.
    """
    n = len(x) // 2
    m = [p[f"m{k}"] for k in range(1, n + 1)]
    beyond = [sum(m[i + 1 :], arb(0)) for i in range(n)]
    w = [m[i] / 2 + beyond[i] for i in range(n)]
    a = [sum(x[: i + 1], arb(0)) for i in range(n)]
    da = [sum(x[n : n + i + 1], arb(0)) for i in range(n)]
    c = [[m[i] / 3 + beyond[i] if i == j else w[max(i, j)] for j in range(n)] for i in range(n)]
    left = arb_mat(n, n, [c[i][j] * (a[i] - a[j]).cos() for i in range(n) for j in range(n)])
    right = [
        -p["g"] * w[i] * a[i].sin() - sum((c[i][j] * (a[i] - a[j]).sin() * da[j] ** 2 for j in range(n)), arb(0))
        for i in range(n)
    ]
    found = left.solve(arb_mat(n, 1, right))
    return [found[0, 0], *(found[i, 0] - found[i - 1, 0] for i in range(1, n))]


E12 = F(10) ** 12
RATIOS = [F(1), E12, 1 / E12]


# --- twelve digits at 1e12 -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("ratio", [E12, 1 / E12, F(10) ** 6])
@pytest.mark.parametrize("names", [("m1",), ("m2",), ("J1",), ("J2",), ("m1", "J1"), ("m2", "J2")])
def test_two_bodies_light_and_heavy_both_ways(names: tuple[str, ...], ratio: F) -> None:
    given = compound_of(**dict.fromkeys(names, ratio))
    assert digits(given, compound, (0.7, 0.9, 1.3, -0.4)) > 12
    assert digits(given, compound, (-1.9, 2.3, 0.1, 3.0)) > 12


@pytest.mark.parametrize("ratio", [E12, 1 / E12])
@pytest.mark.parametrize("name", ["m1", "m2"])
def test_two_points_light_and_heavy_both_ways(name: str, ratio: F) -> None:
    assert digits(given_of("double-pendulum", **{name: ratio}), points, (1.0, 0.5, 0.3, -0.2)) > 12


ONE = F(1)


@pytest.mark.parametrize(
    "masses",
    [
        (ONE, ONE, ONE), (ONE, ONE, E12), (E12, ONE, ONE), (ONE, E12, ONE), (E12, ONE, 1 / E12), (1 / E12, ONE, E12),
        (ONE, ONE, ONE, ONE, ONE, E12), (ONE, ONE, ONE, E12, ONE, ONE), (E12, ONE, ONE, ONE, ONE, ONE),
        (F(1, 10**12), F(1, 10**10), F(1, 10**8), F(1, 10**6), F(1, 10**3), ONE),
    ],
)  # fmt: skip
def test_chains_with_a_heavy_link_anywhere(masses: tuple[F, ...]) -> None:
    """The worst acceleration of its own keeps 12 digits, or what its own condition leaves of 16."""
    state = [0.7, 0.9, -0.4, 1.1, 0.3, -1.2][: len(masses)] + [0.3, -0.2, 0.5, 0.1, -0.4, 0.6][: len(masses)]
    assert digits(chain_of(masses), chain, state) > 12


@pytest.mark.parametrize("k", [F(40), 40 * E12, 40 / E12])
def test_stiff_and_soft_springs(k: F) -> None:
    """r - l0 is known to 16 digits of r, so the state is one at which that is exact."""
    given = given_of("spring-pendulum", k=k, l0=F(1))
    assert digits(given, spring, (0.1, 1.25, 0.3, 0.2)) > 13


@pytest.mark.parametrize("spin", [30.0, 3e6])
def test_a_fast_top(spin: float) -> None:
    assert digits(given_of("heavy-top"), top, (0.05, 0.3, 0.1, 0.2, -0.3, spin)) > 13


@pytest.mark.parametrize("near", [1e-3, 1e-6])
def test_a_top_near_its_gimbal_lock(near: float) -> None:
    """beta = pi/2 - near: what is lost is the condition 1/near of the question, and no more."""
    kept = digits(given_of("heavy-top"), top, (0.05, 1.5707963267948966 - near, 0.1, 0.2, -0.3, 5.0))
    assert kept > 15 + log10(near) - 1


@pytest.mark.parametrize("name", ["A", "B", "C"])
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_free_body_with_moments_far_apart(name: str, ratio: F) -> None:
    given = scenario(body_of().system, {name: Number(3 * ratio)}, assumed=False)
    assert digits(given, free_body, (1.0, 0.5, 0.3, 0.2, -0.7, 0.4)) > 12


def test_a_satellite_far_away() -> None:
    """R = 1e7: every part of it against balls of the equations without any rewriting (the program as derived)."""
    given = given_of("satellite", R=F(10**7), omega0=F(1, 1000), m0=E12)
    found = compensated_code(given, (dynamics := Dynamics(given)).right_hand_side, range(5, 10))
    assert found is not None
    assert found.before < 6
    assert found.after > 12
    assert 1 < found.cost < 4
    assert machine_code(dynamics, "right_hand_side").operations == found.code.operations


# --- who pays --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["double-pendulum", "heavy-top", "gravity-gradient", "spatial-arm", "tethered-satellites", "cart-pendulum"]
)
def test_usual_scenes_pay_nothing(name: str) -> None:
    dynamics = Dynamics(given_of(name))
    assert machine_code(dynamics, "right_hand_side") is dynamics.right_hand_side


def test_simulations_use_it() -> None:
    """Five light rods and one of 1e6: the compiled method against SciPy's on the equations by hand in 300 bits."""
    from scipy.integrate import solve_ivp

    given, end = chain_of((ONE, ONE, ONE, ONE, ONE, F(10**6))), 0.01
    dynamics = Dynamics(given)
    assert machine_code(dynamics, "right_hand_side") is not dynamics.right_hand_side
    start = np.array([float(x) for x in given.state])
    parameters = {name: ball(value) for name, value in given.parameters.items()}

    def rates(t: float, x: Any) -> Any:
        with ctx.workprec(BITS):
            return [*x[6:], *(float(v.mid()) for v in chain(parameters, [ball(float(v)) for v in x]))]

    truth = solve_ivp(rates, (0, end), start, method="DOP853", rtol=1e-10, atol=1e-10).y[:, -1]
    run = METHODS["dop853"].start(dynamics, Setting(1e-11, None, 100_000), "float64", start, 0.0)
    found = np.asarray(run.fill(np.array([0.0, end]))[:, -1], float)
    assert np.max(np.abs(found - truth) / np.max(np.abs(truth))) < 1e-9


def test_what_is_measured_decides(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: pairs whose low parts are lost gain nothing, and are not taken."""
    given = scenario(body_of().system, {"C": Number(3 * E12)}, assumed=False)
    code = Dynamics(given).right_hand_side
    assert compensated_code(given, code, range(3, 6)) is not None
    monkeypatch.setattr(module, "compensated", lambda program, outputs, chosen: list(outputs))
    assert compensated_code(given, code, range(3, 6)) is None


def test_slopes_backwards_are_derivatives(monkeypatch: pytest.MonkeyPatch) -> None:
    """The sweep that finds what is sensitive, against differences of the program; one sweep serves all outputs."""
    from mbsym.algebra.program import Program

    program = Program()
    x, y = program.input("x"), program.input("y")
    s, c = program.sin_cos_of(x * y)
    out = program.divide(s * x - program.square_root(y + c), c * y) - program.minus(x)

    def values(a: float, b: float) -> dict[int, float]:
        import math

        known: dict[int, float] = {}
        for number in program.live([out]):
            operation, operands, payload = program.instructions[number]
            v = [known[k] for k in operands]
            known[number] = {
                "input": lambda p=payload: a if p == "x" else b, "constant": lambda p=payload: float(p),
                "add": lambda v=v: v[0] + v[1], "subtract": lambda v=v: v[0] - v[1],
                "multiply": lambda v=v: v[0] * v[1], "divide": lambda v=v: v[0] / v[1],
                "negative": lambda v=v: -v[0], "sqrt": lambda v=v: math.sqrt(v[0]),
                "sin": lambda v=v: math.sin(v[0]), "cos": lambda v=v: math.cos(v[0]),
            }[operation]()  # fmt: skip
        return known

    looked_at, partials = [], module._partials
    monkeypatch.setattr(module, "_partials", lambda *given: looked_at.append(1) or partials(*given))
    live, wanted = program.live([out]), [out.number, s.number]  # one output stands within the other
    slopes = dict(module._slopes(program, live, values(0.3, 0.9), wanted))
    assert len(looked_at) == len(live)
    h = 1e-6
    for node, (da, db) in ((x, (h, 0)), (y, (0, h))):
        up, down = values(0.3 + da, 0.9 + db), values(0.3 - da, 0.9 - db)
        expected = [(up[k] - down[k]) / (2 * h) for k in wanted]
        assert slopes[node.number] == pytest.approx(expected, rel=1e-7)
