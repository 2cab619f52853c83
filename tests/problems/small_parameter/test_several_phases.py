"""Oscillations with several frequencies: by hand, by laws of Hamiltonian systems, and by an integration of its own."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, cos, exp, sin, sqrt

import pytest
from conftest import SHIPPED
from test_oscillations import EPS, POINT, point

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.oscillating import in_variables, oscillating, told_angle
from mbsym.expressions.place import Complaints
from mbsym.problems.small_parameter.checks import oscillation_orders
from mbsym.problems.small_parameter.generating import graded_rows
from mbsym.problems.small_parameter.lindstedt import NotPeriodic, Resonance
from mbsym.problems.small_parameter.result import APART, multiples
from mbsym.report.oscillation_json import oscillation_data
from mbsym.simulation.oscillating import measured_orders
from mbsym.source.scaling import read_scaling


def number(told, x, /, **letters):
    known = {shown: letters.get(shown, 1) for shown in told.symbols.values()} | letters
    return float(told.formula(x).to_sympy().subs(known))


def rates(told, /, **letters):
    """By phase: the frequency and nu_1, nu_2, ..."""
    return [
        [number(told, phase.frequency, **letters), *(number(told, x, **letters) for x in phase.corrections)]
        for phase in told.oscillation.phases
    ]


@pytest.mark.parametrize("turns", [(0,), (3,), (-2, 5), (1, -1), (-7, 0, 2), (4, -3, -1)])
def test_wave_numbers_are_multiples_of_all_phases_at_once(turns):
    k = sum(n * APART**j for j, n in enumerate(turns))
    assert multiples(k, len(turns)) == turns
    assert multiples(k + 1, len(turns)) == (turns[0] + 1, *turns[1:])


def test_angles_are_told_as_sums():
    names = ("phase_x", "phase_y")
    told = [told_angle(k, names) for k in (1, 2, APART, APART - 2, 3 * APART + 1)]
    assert told == ["phase_x", "2*phase_x", "phase_y", "-2*phase_x + phase_y", "phase_x + 3*phase_y"]


def test_two_oscillators_in_turned_axes(tmp_path):
    """u = x + y, v = x - y: u'' + w^2 u + e h u^3 = 0, v'' + W^2 v + e H v^3 = 0, each as Nayfeh's (section 3.1).

    nu_1 = 3 h a^2/(8 w^2), nu_2 = -15 h^2 a^4/(256 w^4), a the coefficient of the cosine in u, twice that in x.
    """
    potential = "2*(x + y)**2/4 + 3*(x - y)**2/4 + eps*(5*(x + y)**4 + 7*(x - y)**4)/8"
    told = oscillating(point(tmp_path, [f"potential: {potential}"], "x, y"), 2, leading=("x", "y"))
    names = [told.symbols[x] for x in ("#amplitude", "#amplitude of 1")]
    assert names == ["amplitude_x", "amplitude_y"]
    assert told.oscillation.residuals == (3, 3, 3, 3)
    found = rates(told, amplitude_x=0.3, amplitude_y=0.3)
    by_hand = [
        [sqrt(square), 3 * h * 0.6**2 / (8 * square), -15 * h**2 * 0.6**4 / (256 * square**2)]
        for square, h in ((2, 5), (3, 7))
    ]
    assert sorted(found) == [pytest.approx(row, rel=1e-12) for row in by_hand]
    # nothing of one oscillator is in the other's: no wave holds both phases
    for series in told.oscillation.series:
        assert all(0 in multiples(k, 2) for harmonics in series for k in harmonics.waves)


def test_frequencies_have_a_potential_in_the_actions():
    """d w_1/d I_2 = d w_2/d I_1 (they are derivatives of one energy), I = m l^2 w a^2/2 and m w a^2/2, l = l0 + m g/k.

    And with one amplitude 0 they are those of the motion that one phase leads.
    """
    analysis = mbsym.load(SHIPPED / "spring-pendulum.yaml").in_free_coordinates
    both = oscillating(analysis, 2, leading=("theta", "r"))
    letters = {"m": 1.25, "k": 7.5, "l0": 0.75, "g": 9.5}
    length = letters["l0"] + letters["m"] * letters["g"] / letters["k"]

    def corrected(first, second):
        (w, _, a), (v, _, b) = rates(both, amplitude_theta=first, amplitude_r=second, **letters)
        return w, v, w * a, v * b

    w, v, *alone = corrected(1, 0)
    *_, whole, other = corrected(1, 1)
    by_r, by_theta = whole - alone[0], other - corrected(0, 1)[3]
    assert by_r / (letters["m"] * v / 2) == pytest.approx(by_theta / (letters["m"] * length**2 * w / 2), rel=1e-12)
    assert abs(by_r) > 0.01
    for name, place in (("theta", 0), ("r", 1)):
        led = oscillating(analysis, 2, leading=name)
        single = rates(led, amplitude=1, **letters)[0]
        at = {"amplitude_theta": 0, "amplitude_r": 0} | {f"amplitude_{name}": 1}
        assert rates(both, **at, **letters)[place] == pytest.approx(single, rel=1e-12)


def test_a_correction_that_is_wrong_leaves_terms_of_its_order(tmp_path):
    analysis = point(tmp_path, ["potential: 2*x**2/2 + 3*y**2/2 + eps*x**2*y**2"], "x, y")
    told = oscillating(analysis, 1, leading=("x", "y"))
    oscillation, tower = told.oscillation, told.oscillation.tower
    names = told.field.variables
    rows = graded_rows(tower, told.field, "eps", {}, 5)
    assert oscillation_orders(rows, names, oscillation) == (2, 2, 2, 2)
    phases = list(oscillation.phases)
    for place, phase in enumerate(phases):
        wrong = replace(phase, corrections=(phase.corrections[0] * 2,))
        planted = replace(oscillation, phases=(*phases[:place], wrong, *phases[place + 1 :]))
        assert 1 in oscillation_orders(rows, names, planted)


@pytest.mark.parametrize(
    ("potential", "why"),
    [
        ("w**2*(x**2 + y**2)/2 + eps*x**2*y**2", "frequency of their own"),  # x y^2 holds 2 T_y - T_x = T_x
        ("w**2*(x**2 + 4*y**2)/2 + eps*x**2*y", "frequency of their own"),  # x^2 drives y at 2 w
        ("w**2*(x**2 + 9*y**2)/2 + eps*x**3*y", "frequency of their own"),
    ],
)
def test_frequencies_in_resonance_are_refused(tmp_path, potential, why):
    with pytest.raises(Resonance, match=why):
        oscillating(point(tmp_path, [f"potential: {potential}"], "x, y"), 2, leading=("x", "y"))


def test_frequencies_in_resonance_whose_terms_are_not_there_are_none(tmp_path):
    """1 : 2 with x^2 y^2 alone: the harmonics 2 T_x and 2 T_y +- T_x, 2 T_x +- T_y are no frequencies to this order."""
    told = oscillating(
        point(tmp_path, ["potential: w**2*(x**2 + 4*y**2)/2 + eps*x**2*y**2"], "x, y"), 1, leading=("x", "y")
    )
    (_, first), (_, second) = rates(told, w=1.5, amplitude_x=0.5, amplitude_y=0.25)
    # x'' + w^2 x = -2 eps x y^2: mean of y^2 is b^2/2; the like of y
    assert (first, second) == pytest.approx((0.25**2 / (2 * 1.5**2), 0.5**2 / (2 * 9)))


def test_what_is_integrated_over_the_time_is_divided_by_sums_of_frequencies():
    """z'' = -eps x y with x = a cos T, y = b cos U: z = eps a b/2 (cos(T + U)/(w + v)^2 + cos(T - U)/(w - v)^2)."""
    potential = "w**2*x**2/2 + k**2*y**2/2 + eps*x*y*z"
    text = POINT.format(small=EPS, place="x, y, z", names="x, y, z", loads=f"  - potential: {potential}")
    analysis = mbsym.loads(text.replace("k: {sign: real}", "k: {sign: positive}"))
    told = oscillating(analysis, 1, {"z_dot_0": 0}, leading=("x", "y"))
    ring = told.ring
    w, k = (ring.generator("parameter", name) for name in "wk")
    shown = {x.harmonic: told.formula(x.value).polynomial for x in told.oscillation.divisors if "z" in x.variables[0]}
    assert {APART + 1, APART - 1} <= shown.keys()
    assert shown[APART + 1] in (w + k, -w - k)
    assert shown[APART - 1] in (w - k, k - w)
    z = told.oscillation.series[told.oscillation.names.index("z")][1]
    for turn, both in ((APART + 1, w + k), (APART - 1, w - k)):
        cosine = told.formula(z.wave(turn)[0]).polynomial
        a, b = (ring.generator("parameter", f"amplitude_{name}") for name in "xy")
        assert ring.is_zero(ring.times(cosine, 2 * both**2) - a * b)


def test_amplitudes_that_damping_determines_are_not_looked_for(tmp_path):
    loads = ["potential: x**2/2 + 3*y**2/2", "generalized force: {x: eps*(1 - x**2)*x_dot, y: eps*(1 - y**2)*y_dot}"]
    with pytest.raises(NotPeriodic, match="of several phases"):
        oscillating(point(tmp_path, loads, "x, y"), 1, leading=("x", "y"))


def test_what_is_wrong_with_the_variables_that_lead(tmp_path):
    more = "values: {w: 2, eps: 1/10, k: 0}\ninitial: {x: 1, y: 1}\n"
    analysis = point(tmp_path, ["potential: w**2*x**2/2 + y**2 + eps*x**2*y**2"], "x, y", more=more)
    with pytest.raises(NoClosedForm, match="all frequencies of x are taken"):
        oscillating(analysis, 1, leading=("x", "x"))
    with pytest.raises(NoClosedForm, match="do not depend on z"):
        oscillating(analysis, 1, leading=("x", "z"))
    with pytest.raises(NoClosedForm, match="several phases"):
        measured_orders(analysis.system, oscillating(analysis, 1, leading=("x", "y")))


def test_further_phases_stand_in_json(tmp_path):
    analysis = point(tmp_path, ["potential: w**2*x**2/2 + y**2 + eps*x**2*y"], "x, y")
    data = oscillation_data(oscillating(analysis, 2, leading=("x", "y")), "not measured")
    (second,) = data.further_phases
    assert (data.phase, second.phase, second.leading, second.amplitude) == ("phase_x", "phase_y", "y", "amplitude_y")
    assert second.frequency == "sqrt(2)"
    assert all(isinstance(x.harmonic, list) and len(x.harmonic) == 2 for x in data.resonances)
    assert any("phase_x + phase_y" in x.formula for one in data.solution for x in one.coefficients)


# Amer, Amer and Galal (2023), (30), (31): the fast gyrostat with both oscillations at once, l = 0.


def _rate(state, e, a, b, k, x, y, z):
    """(5) of the paper, and Poisson's equations."""
    p, q, r, h1, h2, h3 = state
    return (
        -((1 - b) * q * r + e * (k * (b - 1) * h2 * h3 + z * h2 - y * h3)) / a,
        -((a - 1) * p * r + e * (x * h3 - k * (a - 1) * h1 * h3 - z * h1)) / b,
        -e * e * ((b - a) * p * q + y * h1 - (b - a) * k * h1 * h2 - x * h2),
        r * h2 - e * q * h3,
        e * p * h3 - r * h1,
        e * q * h1 - e * p * h2,
    )


def _moved(state, h, *letters):
    """A step of Runge's and Kutta's method."""
    k1 = _rate(state, *letters)
    k2 = _rate([u + h / 2 * v for u, v in zip(state, k1, strict=True)], *letters)
    k3 = _rate([u + h / 2 * v for u, v in zip(state, k2, strict=True)], *letters)
    k4 = _rate([u + h * v for u, v in zip(state, k3, strict=True)], *letters)
    rows = zip(state, k1, k2, k3, k4, strict=True)
    return [u + h / 6 * (c1 + 2 * c2 + 2 * c3 + c4) for u, c1, c2, c3, c4 in rows]


def _frequency(values, step, near):
    """By how much the phase of a component turns between two windows."""
    half = len(values) // 2
    parts = []
    for start in (0, half):
        total = 0j
        for i in range(half):
            u = (i + 0.5) / half
            t = (start + i) * step * near
            total += exp(-1 / (u * (1 - u))) * values[start + i] * complex(cos(t), -sin(t))
        parts.append(total)
    turned = parts[1] / parts[0]
    return near + atan2(turned.imag, turned.real) / (half * step)


SCALE = (
    "p=r_0*p1,q=r_0*q1,r=r_0*r1,gamma1=gamma3_0*h1,gamma2=gamma3_0*h2,gamma3=gamma3_0*h3,t=tau/r_0,A=a*C,B=b*C,"
    "x0=L*x,y0=L*y,z0=L*z,g=C*r_0**2/(M*L*gamma3_0),R=3*g*gamma3_0**2/(k*r_0**2)"
)


def test_the_fast_gyrostat_with_both_oscillations_turns_as_an_integration_says():
    """-2 w' of gamma is N, -2 Omega w' of p is L: with M1 in N and M3 in L, which (31) has otherwise."""
    analysis = mbsym.load(SHIPPED / "gyrostat-fast.yaml")
    told = oscillating(analysis, 2, {"lx": 0, "lz": 0}, ("p", "gamma1"))
    complaints = Complaints()
    scaled = in_variables(told, analysis.system, read_scaling(SCALE, analysis.system, complaints))
    a, b, k, x, y, z, first, second = letters = 1.9, 1.35, 0.7, 0.4, 0.3, 0.5, 0.6, 0.8
    names = dict(zip(("a", "b", "k", "x", "y", "z", "amplitude_p", "amplitude_gamma1"), letters, strict=True))
    (omega, _, nu), (one, _, other) = rates(scaled, **names)
    assert (omega, one) == pytest.approx((sqrt((1 - a) * (1 - b) / (a * b)), 1))
    measured = []
    for e in (0.04, 0.02):
        own = (e, a, b, k, x, y, z)
        start = [
            first + e * (x / (1 - a) - second * (z * (2 * b - 1) + k * (a + b - 1) * (b - 1)) / (a + b - 1)),
            e * y / (1 - b), 1.0, second + e * a * first, 0.0, 1.0,
        ]  # fmt: skip
        rows = [start]
        for _ in range(12000):
            rows.append(_moved(rows[-1], 0.1, *own))
        turning = [_frequency([row[i] for row in rows], 0.1, near) for i, near in ((0, omega), (3, 1.0))]
        measured.append([(found - near) / e**2 for found, near in zip(turning, (omega, 1), strict=True)])
    extrapolated = [2 * fine - coarse for coarse, fine in zip(*measured, strict=True)]
    assert extrapolated == pytest.approx([omega * nu, other], abs=0.01)
    # (31), l = 0: (1 + b) M1^2 X^2 Omega^2 stands in N besides
    assert -2 * other == pytest.approx(
        -a * first**2 + 2 * x * second - 2 * z + k * (second**2 * (b - a) / 2 - (a + b - 2)), rel=1e-12
    )
