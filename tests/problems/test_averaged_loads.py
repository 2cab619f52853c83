"""A fast phase that acts in loads: effective potentials by hand, their distance by SciPy, and lies that are withdrawn.

By hand: in m x'' = f(x) + F(x, nu t) with <F> = 0 put x = X + xi(X, nu t), xi'' = F/m to the first order.  The mean of
F(X + xi) is <xi dF/dx>, that is - d/dX of  <(integral F dt)^2>/(2 m)  (Landau and Lifshitz, Mechanics, section 30); for
F = A(x) cos(nu t) this is  V = A^2/(4 m nu^2),  and in several coordinates  V = A.M^-1 A/(4 nu^2).
"""

from __future__ import annotations

import json
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
from conftest import STATEMENTS, filed, invoked
from scipy.integrate import solve_ivp
from terminal import told

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis import Analysis
from mbsym.analysis.averaged import averaged_system, averaging_of
from mbsym.problems.small_parameter import averaging
from mbsym.report.schemas import schema
from mbsym.report.targets import TARGETS
from mbsym.report.words.expansion_measured import averages, contradicts
from mbsym.simulation.expanded import Measured
from mbsym.simulation.expanded import average_measured as measured

POINT = """
mbsym: 1
name: Driven point
parameters: {{m: positive, v: positive, w: positive, k: positive, c: positive, h: positive, nu: positive}}
prescribed: {{phi: {{rate: nu}}{more}}}
bodies:
  - {{name: bead, attached to: 0, connection point: [{x}, y, 0], coordinates: [x, y], mass: m}}
loads:
{loads}
motion: {{x: 0, y: 0}}
"""
NUMBERS = {"m": 2, "v": 90, "w": 40, "k": 3, "c": 0.2, "h": 0.05, "nu": 50}
VALUES = "values: {m: 2, v: 90, w: 40, k: 3, c: 0.2, h: 0.05, nu: 50}\ninitial: {x: 0.4, y: 0.3}\n"

ROD = """
mbsym: 1
name: Driven pendulum
parameters: {{m: positive, l: positive, g: positive, v: positive, h: positive, nu: positive}}
prescribed: {{phi: {{rate: nu}}}}
bodies:
  - {{name: rod, attached to: 0, connection point: {pivot}, rotation: {{axes: [3], angles: [theta]}},
     mass centre: [0, -l, 0], mass: m}}
loads:
  - uniform gravity: {{acceleration: g, direction: [0, -1, 0]}}
  - {load}
motion: {{theta: 0}}
values: {{m: 1, l: 1, g: 9, v: {v}, h: 0.1, nu: 60}}
initial: {{theta: 0.3}}
"""


def _point(*loads: str, x: str = "x", more: str = "", values: str = "") -> Analysis:
    return mbsym.loads(POINT.format(loads="\n".join(f"  - {load}" for load in loads), x=x, more=more) + values)


def _rod(load: str, pivot: str = "[0, 0, 0]", v: float = 100) -> Analysis:
    return mbsym.loads(ROD.format(load=load, pivot=pivot, v=v))


def _value(formula, **values):
    expression = formula.to_sympy()
    return float(expression.subs({symbol: values[symbol.name] for symbol in expression.free_symbols}))


@pytest.mark.parametrize(
    ("loads", "orders", "by_hand"),
    [
        # A = -v x: Paul's trap
        (["potential: v*cos(phi)*x**2/2"], {"v": -1}, lambda x, y: 90**2 * x**2 / (4 * 2 * 50**2)),
        # a quadrupole with a part at rest: A = -v (x, -y)
        (
            ["potential: (k+v*cos(phi))*(x**2-y**2)/2"],
            {"v": -1},
            lambda x, y: 90**2 * (x**2 + y**2) / (4 * 2 * 50**2) + 3 * (x**2 - y**2) / 2,
        ),
        # a saddle turning at nu: |F|^2 = v^2 r^2 at every time, at the rate 2 nu: v^2 r^2/(2 m (2 nu)^2)
        (
            ["potential: v*((x**2-y**2)*cos(2*phi)+2*x*y*sin(2*phi))/2"],
            {"v": -1},
            lambda x, y: 90**2 * (x**2 + y**2) / (8 * 2 * 50**2),
        ),
        # two amplitudes, each quadrature by itself: |(y, x)|^2 and |(x, 0)|^2
        (
            ["potential: v*cos(phi)*x*y + w*sin(phi)*x**2/2"],
            {"v": -1, "w": -1},
            lambda x, y: (90**2 * (x**2 + y**2) + 40**2 * x**2) / (4 * 2 * 50**2),
        ),
        # the same force without a potential: F = (v x cos, v y sin), no curl
        (
            ["generalized force: {x: v*cos(phi)*x, y: v*sin(phi)*y}"],
            {"v": -1},
            lambda x, y: 90**2 * (x**2 + y**2) / (4 * 2 * 50**2),
        ),
        # F = v cos(phi) (y, -x) = v cos(phi) J q, xi = -F/(m nu^2): the mean v^2/(2 m nu^2) (-J J q) drives away
        (
            ["generalized force: {x: v*cos(phi)*y, y: -v*cos(phi)*x}"],
            {"v": -1},
            lambda x, y: -(90**2) * (x**2 + y**2) / (4 * 2 * 50**2),
        ),
        # a field that turns, its amplitude v x: F = v x (cos, sin), xi_x dF/dx = (-v^2 x/(2 m nu^2), 0)
        (
            ["force: {body: bead, point: [0, 0, 0], axes: 0, components: [v*cos(phi)*x, v*sin(phi)*x, 0]}"],
            {"v": -1},
            lambda x, y: 90**2 * x**2 / (4 * 2 * 50**2),
        ),
        # a force whose mean is not zero, of first order
        (["generalized force: {x: -v*cos(phi)**2*x**3}"], {"v": 0}, lambda x, y: 90 * x**4 / 8),
        # harmonics by themselves, over n^2: v (cos(phi) + cos(3 phi)/2) x
        (
            ["potential: v*(cos(phi)+cos(3*phi)/2)*x**2/2"],
            {"v": -1},
            lambda x, y: 90**2 * x**2 / (4 * 2 * 50**2) * (1 + 1 / (4 * 9)),
        ),
        # half the phase: the rate nu/2
        (["potential: v*sin(phi/2)*x**2/2"], {"v": -1}, lambda x, y: 90**2 * x**2 / (2 * 50**2)),
        # as the unbalance of a motor: a force m e nu^2, here with v for e, which is small
        (["potential: v*nu**2*cos(phi)*x**2/2"], {"v": 1}, lambda x, y: 90**2 * 50**2 * x**2 / (4 * 2)),
        # a force that is as large as nu by itself
        (["potential: v*nu*cos(phi)*x**2/2"], {"v": 0}, lambda x, y: 90**2 * x**2 / (4 * 2)),
        # of first order: its mean
        (["potential: v*cos(phi)**2*x**2/2"], {"v": 0}, lambda x, y: 90 * x**2 / 4),
        # a phase that is slow beside it stays; friction without the phase stays
        (
            ["potential: v*cos(phi)*x**2/2", "generalized force: {x: -c*x_dot*(1+x**2)}"],
            {"v": -1},
            lambda x, y: 90**2 * x**2 / (4 * 2 * 50**2),
        ),
        # a wave that travels: <A^2> is the same everywhere
        (["potential: v*cos(x-phi)"], {"v": -1}, lambda x, y: 0.0),
    ],
)
def test_the_effective_potential_of_driven_points(loads, orders, by_hand):
    found = averaging_of(_point(*loads), "phi")
    assert dict(found.orders) == orders
    for x, y in ((0.3, -0.7), (1.1, 0.4)):
        value = _value(found.potential, **NUMBERS, x=x, y=y) - _value(found.potential, **NUMBERS, x=0, y=0)
        assert value == pytest.approx(by_hand(x, y), abs=1e-12)


def test_shaken_and_loaded_at_once():
    """The place is u + h cos(phi) (1 + u): T = m (u' (1 + h cos) - h nu sin (1 + u))^2/2, A1 = -m h nu sin (1 + u).

    With the force -v cos(phi) u: g = -v sin(phi) u/nu, a = A1 - g = sin(phi) (v u/nu - m h nu (1 + u)), V = a^2/(4 m)
    without the sine, less <A0> = m h^2 nu^2 (1 + u)^2/4: the squares of the shaking cancel, the product remains.
    """
    found = averaging_of(_point("potential: v*cos(phi)*x**2/2", x="x+h*cos(phi)*(1+x)"), "phi")
    assert dict(found.orders) == {"h": 1, "v": -1}
    m, v, h, nu = (NUMBERS[name] for name in ("m", "v", "h", "nu"))

    def by_hand(u):
        return (v * u / nu - m * h * nu * (1 + u)) ** 2 / (4 * m) - m * h**2 * nu**2 * (1 + u) ** 2 / 4

    for u in (0.3, 1.2):
        told = _value(found.potential, **NUMBERS, x=u, y=0) - _value(found.potential, **NUMBERS, x=0, y=0)
        assert told == pytest.approx(by_hand(u) - by_hand(0), rel=1e-9)


@pytest.mark.parametrize(
    ("load", "pivot", "square"),
    [
        # gravity modulated: torque -v sin(theta) cos(phi)
        ("potential: -v*cos(phi)*cos(theta)", "[0, 0, 0]", lambda s, c: (100 * s / 60) ** 2),
        # an unbalance torque that does not depend on the angle does nothing
        ("generalized force: {theta: v*cos(phi)}", "[0, 0, 0]", lambda s, c: 0.0),
        # pivot at h cos(phi): torque m h nu^2 sin(theta) cos(phi); with v sin(phi) cos(theta): in quadrature
        (
            "generalized force: {theta: v*sin(phi)*cos(theta)}",
            "[0, h*cos(phi), 0]",
            lambda s, c: (0.1 * 60 * s) ** 2 + (100 * c / 60) ** 2,
        ),
        # in phase: (m h nu^2 + v) sin(theta) cos(phi)
        (
            "generalized force: {theta: v*cos(phi)*sin(theta)}",
            "[0, h*cos(phi), 0]",
            lambda s, c: (0.1 * 60 + 100 / 60) ** 2 * s**2,
        ),
    ],
)
def test_the_effective_potential_of_driven_pendulums(load, pivot, square):
    found = averaging_of(_rod(load, pivot), "phi").potential
    numbers = {"m": 1, "l": 1, "g": 9, "v": 100, "h": 0.1, "nu": 60}
    for theta in (0.4, 2.0):
        told = _value(found, **numbers, theta=theta) - _value(found, **numbers, theta=0)
        s, c = np.sin(theta), np.cos(theta)
        assert told == pytest.approx(square(s, c) / 4 - square(0, 1) / 4 - 9 * (c - 1), abs=1e-9)


def _distance(full, slow, start, start_slow, time):
    at = np.linspace(0, time, 200)
    q, Q = (
        solve_ivp(field, (0, time), x, t_eval=at, rtol=1e-9, atol=1e-11).y[: len(start) // 2]
        for field, x in ((full, start), (slow, start_slow))
    )
    return np.abs(q - Q).max()


@pytest.mark.parametrize("system", ["trap", "saddle", "unbalance", "friction"])
def test_the_motions_by_hand_come_together_like_1_over_nu(system):
    """The equations typed here, without mbsym: the potentials of the tests above are those of the motion itself."""
    distances = []
    for nu in (60.0, 120.0):
        v = 2 * nu  # as large as nu
        if system in ("trap", "friction"):  # x'' = -v cos(nu t) x - c x'; V = v^2 x^2/(4 nu^2) = x^2
            c = 0.5 if system == "friction" else 0.0
            full = lambda t, z, v=v, nu=nu, c=c: [z[1], -v * np.cos(nu * t) * z[0] - c * z[1]]  # noqa: E731
            slow = lambda t, z, c=c: [z[1], -2 * z[0] - c * z[1]]  # noqa: E731
            start, begun = [1.0, 0.0], [1.0, 0.0]
        elif system == "saddle":  # V = v^2 r^2/(8 nu^2) = r^2/2, the integral of F at t = 0 is (0, -v x/(2 nu)) ...

            def full(t, z, v=v, nu=nu):
                c, s = np.cos(2 * nu * t), np.sin(2 * nu * t)
                return [z[2], z[3], -v * (z[0] * c + z[1] * s), -v * (z[0] * s - z[1] * c)]

            slow = lambda t, z: [z[2], z[3], -z[0], -z[1]]  # noqa: E731
            # integral of -v (x c + y s, x s - y c) at t = 0: v (y, x)/(2 nu); Q' = q' - that
            start, begun = [1.0, 0.5, 0.0, 0.0], [1.0, 0.5, -0.5, -1.0]
        else:  # theta'' = -4 sin(theta) + e nu^2 cos(nu t) sin(theta), e nu = 3: V = 9 sin^2/4 - 4 cos
            full = lambda t, z, nu=nu: [z[1], (-4 + 3 * nu * np.cos(nu * t)) * np.sin(z[0])]  # noqa: E731
            slow = lambda t, z: [z[1], -4 * np.sin(z[0]) - 4.5 * np.sin(z[0]) * np.cos(z[0])]  # noqa: E731
            start, begun = [1.0, 0.0], [1.0, 0.0]
        distances.append(_distance(full, slow, start, begun, 4.0))
    assert np.log2(distances[0] / distances[1]) == pytest.approx(1, abs=0.15)


@pytest.mark.parametrize(
    "analysis",
    [
        lambda: _point("potential: (k+v*cos(phi))*(x**2-y**2)/2", values=VALUES),
        lambda: _point("generalized force: {x: v*cos(phi)*x, y: v*sin(phi)*y}", values=VALUES),
        lambda: _point("generalized force: {x: v*cos(phi)*y, y: -v*cos(phi)*x}", values=VALUES),
        lambda: _rod("generalized force: {theta: v*cos(phi)*sin(theta)}", "[0, h*cos(phi), 0]"),
    ],
)
def test_the_measured_distance_is_of_first_order(analysis):
    one = analysis()
    found = averaging_of(one, "phi")
    told = measured(one.system, averaged_system(one.system, found), found, 1.0)
    assert told.orders[-1] == pytest.approx(1, abs=0.2)
    assert not contradicts(told)


@pytest.mark.parametrize(
    ("loads", "reason"),
    [
        (["potential: 100*cos(phi)*x**2/2"], "is not plain"),
        (["potential: (1+v)*cos(phi)*x**2/2"], "is not plain"),
        (["potential: v**2*cos(phi)*x**2/2"], "is not plain"),
        (["generalized force: {x: v*cos(phi)*y_dot, y: -v*cos(phi)*x_dot}"], "velocities"),
        # xi = -(F)/(m nu^2), F = v cos(phi) (0, x y): the mean <xi dF/dq> = (0, -v^2 x^2 y/(2 m nu^2)) turns
        (["generalized force: {y: v*cos(phi)*x*y}"], "a mean force on . is left"),
        (["potential: v*cos(phi)*x**2/2", "generalized force: {x: -c*sign(x_dot)}"], "not linear in the velocities"),
        (["potential: v*cos(phi)*x**2/2", "generalized force: {x: -c*x_dot*abs(x_dot)}"], "not linear in the veloc"),
        (["potential: v*cos(phi)*x**2/2", "generalized force: {x: -c*x_dot**3}"], "not linear in the velocities"),
        (["generalized force: {x: -v*cos(phi)**2*sin(x)}"], "a mean force on x is left"),
        (["potential: v/(2+cos(phi))*x**2"], "in a denominator"),
        (["potential: v*cos(phi)"], "nothing oscillates"),
    ],
)
def test_what_averages_in_another_way_is_refused(loads, reason):
    with pytest.raises(NoClosedForm, match=reason):
        averaging_of(_point(*loads), "phi")


@pytest.mark.parametrize(
    ("orders", "reason"),
    [
        ({"v": -2}, "the averages mean nothing"),  # x'' = nu^2 f(x, nu t): no small parameter is left
        ({"k": 1}, "depends on phi also where k = 0"),
        ({"nu": -1, "v": -1}, "nu is the rate"),
    ],
)
def test_orders_that_do_not_fit_are_refused(orders, reason):
    with pytest.raises(NoClosedForm, match=reason):
        averaging_of(_point("potential: v*cos(phi)*x**2/2 + k*y**2/2"), "phi", orders)


def test_a_phase_that_goes_with_it_is_refused_and_a_slow_one_stays():
    load = "potential: (v*cos(phi)+w*cos(psi))*x**2/2"
    with pytest.raises(NoClosedForm, match="psi is as fast as phi"):
        averaging_of(_point(load, more=", psi: {rate: nu/2}"), "phi")
    found = averaging_of(_point(load, more=", psi: {rate: k}"), "phi")
    at = _value(found.potential, **NUMBERS, x=1, y=0, psi=0.7)
    assert at == pytest.approx(90**2 / (4 * 2 * 50**2) + 40 * np.cos(0.7) / 2)


@pytest.mark.parametrize(
    ("distances", "lie"),
    [
        ((0.2, 0.1, 0.05), False),
        ((12.0, 6.0, 3.0), False),  # an oscillation of order eps about a small motion
        ((1e-4, 2.5e-5, 6e-6), False),  # better than the theorem
        ((2.0, 2.0, 1.9), True),
        ((2.0, 1.9, 0.8), True),  # far away at the given values
        ((0.1, 0.1, 0.1), True),
        ((1e9, 0.5, 0.25), True),
        ((0.53, 0.16, 0.068), False),  # coarse at the given values, and better than the theorem from there on
        ((0.015, 0.0041, 0.0026), False),  # phases that beat
        ((0.2, 0.1, 0.1), True),
    ],
)
def test_what_contradicts_a_result(distances, lie):
    assert contradicts(Measured(1.0, (), distances)) is lie


def test_where_both_motions_rest_nothing_is_measured():
    told = Analysis(mbsym.loads((STATEMENTS / "paul2.yaml").read_text().replace("x: 0.1", "x: 0")).system, (12,))
    (one,) = averages(told.small_parameters, told.system)
    assert "tells nothing" in one.measured
    assert not one.withdrawn


def _texts(system):
    """Every output of problem 12, and the terminal."""
    found = {}
    for language in ("en", "ru", "es"):
        analysis = Analysis(replace(system, language=language), (12,))
        for target in ("latex", "html"):
            found[f"{target} {language}"] = TARGETS[target].render(analysis, (12,))
    analysis = Analysis(system, (12,))
    for target in ("wolfram", "python", "json"):
        found[target] = TARGETS[target].render(analysis, (12,))
    found["terminal"] = "\n".join(told(analysis, 12))
    return {name: " ".join(text.split()) for name, text in found.items()}


THEOREM = ("averaging theorem", "теорема об усреднении", "teorema del promedio")
POTENTIAL = ("ffective potential:", "ффективный потенциал:", "otencial efectivo:")
KEPT = ("effective potential, averaged", "effectivePotentials =", '"potential":')
WITHDRAWN = ("withdrawn", "отозван", "se retira")


@pytest.mark.parametrize("power", [1, 0])
def test_an_order_that_is_assumed_wrongly_is_withdrawn_on_every_surface(monkeypatch, tmp_path, power):
    """The planted lie: with v = O(1) or O(eps) V would be 0; the trap oscillates at v/(nu sqrt 2) = 1.77."""
    monkeypatch.setattr(averaging, "orders_of", lambda *given: {"v": power})
    path = STATEMENTS / "paul2.yaml"
    system = mbsym.load(path).system
    for name, text in _texts(system).items():
        assert not [word for word in (*THEOREM, *POTENTIAL, *KEPT) if word in text], name
        if name != "python":
            assert any(word in text for word in WITHDRAWN), name
    data = json.loads(TARGETS["json"].render(Analysis(system, (12,)), (12,)))
    jsonschema.validate(data, schema("results"))
    (one,) = data["small_parameters"]["averaged"]
    assert one["orders"] == {"nu": -1, "v": power}
    assert not {"potential", "vibrational", "averaged_motion_at_values"} & set(one)
    out = tmp_path / "averaged.yaml"
    for options in ([], ["--quiet"]):
        done = invoked("average", path, "--out", out, *options, code=1)
        assert "withdrawn" in done.output
        assert "effective potential" not in done.output
        assert not out.exists()


def test_the_scaling_stands_beside_the_result_on_every_surface(tmp_path):
    """V = v^2 x^2/(4 nu^2) for v of order 1/eps, the rate as well."""
    path = STATEMENTS / "paul2.yaml"
    system = mbsym.load(path).system
    texts = _texts(system)
    for name, text in texts.items():
        if name == "python":
            assert "nu of order eps^-1, v of order eps^-1, all else of order 1" in text, name
        elif name != "json":
            assert any(
                told in text for told in ("order of the power", "порядка степени", "del orden de la potencia")
            ), name
            assert any(word in text for word in THEOREM), name
    (one,) = json.loads(texts["json"])["small_parameters"]["averaged"]
    assert (one["potential"], one["orders"]) == ("v**2*x**2/(4*nu**2)", {"nu": -1, "v": -1})
    out = tmp_path / "averaged.yaml"
    done = invoked("average", path, "--out", out, code=0)
    assert "Taken as of the order of the power -1 of epsilon: v." in done.output
    assert "nu of order eps^-1, v of order eps^-1, all else of order 1" in out.read_text()
    assert _value(mbsym.load(out).linearisation.K[0, 0], v=100, nu=40) == pytest.approx(100**2 / (2 * 40**2))


def test_the_command_takes_orders():
    path = str(STATEMENTS / "avgmean.yaml")
    done = invoked("average", path, "--order", "u=0", "--time", "1", code=0)
    assert "Effective potential: u x^2/4." in done.output
    refused = invoked("average", path, "--order", "q=1", "--order", "u", "--order", "u=x", code=2)
    assert refused.output.count("--order: error[") == 3, refused.output


DIPOLE = """
mbsym: 1
name: Dipole in a field that turns
parameters: {{J: positive, b: positive, a: positive, nu: positive}}
prescribed: {{phi: {{rate: nu}}}}
bodies:
  - {{name: d, attached to: 0, rotation: {{axes: [3], angles: [th]}}, mass: 0, inertia about: mass centre,
     inertia: [J, J, J]}}
loads:
{loads}
motion: {{th: 0}}
values: {{J: 1, b: 1, a: 1, nu: 20}}
initial: {{th: 0.1}}
"""
TURNING = "  - generalized force: {th: -b*sin(th - phi)}\n"


@pytest.mark.parametrize(
    ("held", "potential", "beside"),
    [("generalized force: {th: -a*sin(th)}", "0", ("th",)), ("potential: -a*cos(th)", "-a*cos(th)", ())],
)
def test_forces_beside_an_effective_potential_are_told(tmp_path, held, potential, beside):
    """J th'' = -b sin(th - nu t) - a sin(th): the turning field adds b^2/(4 J nu^2), a constant, so that V = -a cos th.

    Given as a generalised force the couple is no part of V, and "effective potential: 0" was the whole story, beside
    "stable under a > 0".
    """
    text = DIPOLE.format(loads=TURNING + f"  - {held}\n")
    one = mbsym.loads(text)
    found = averaging_of(one, "phi")
    assert str(found.potential) == potential
    assert found.beside == beside
    path = filed(tmp_path / "dipole.yaml", text)
    told = [invoked("average", path).output]
    told += [x for name, x in _texts(one.system).items() if name in ("latex en", "html en", "terminal")]
    assert ["eside it act the forces on" in " ".join(x.split()) for x in told] == [bool(beside)] * 4
