"""Periodic solutions in powers of a small parameter against textbooks, a derivation by hand, and an independent one.

Duffing: A. Nayfeh, Perturbation Methods, section 3.1; van der Pol: omega = 1 - eps^2/16 + 17 eps^4/3072
(C. Andersen and J. Geer, 1982); pendulum: omega = 1 - a^2/16 + a^4/3072, the series of its elliptic integral.
"""

from __future__ import annotations

import ast
import operator
from fractions import Fraction
from math import comb, inf

import numpy as np
import pytest
from conftest import SHIPPED, reference
from msgspec import UNSET

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis.oscillating import oscillating
from mbsym.problems.small_parameter.checks import oscillation_orders
from mbsym.problems.small_parameter.lindstedt import NotPeriodic, Resonance
from mbsym.problems.small_parameter.result import Amplitude
from mbsym.report.oscillation_json import oscillation_data
from mbsym.report.plain_writer import Writer
from mbsym.report.words.oscillation_words import measured_sentences, numerator, sentences
from mbsym.simulation.oscillating import ROWS, measured_orders

POINT = """mbsym: 1
name: A point
parameters: {{w: {{sign: positive}}, eps: {{sign: positive}}, k: {{sign: real}}}}
{small}
bodies:
  - {{name: mass, attached to: 0, connection point: [{place}], mass: 1, coordinates: [{names}]}}
loads:
{loads}
"""
EPS = "small parameter: eps"


def point(tmp_path, loads, names="x", small=EPS, more=""):
    path = tmp_path / "point.yaml"
    place = f"{names}, 0" if "," in names else f"{names}, 0, 0"
    text = POINT.format(small=small, place=place, names=names, loads="".join(f"  - {one}\n" for one in loads))
    path.write_text(text + more, encoding="utf-8")
    return mbsym.load(path)


def corrections(told):
    return [str(told.formula(x)) for x in told.oscillation.corrections]


def test_duffing_as_in_the_textbook(tmp_path):
    """omega = w + 3 eps a^2/(8 w) - 21 eps^2 a^4/(256 w^3), a the initial displacement."""
    told = oscillating(point(tmp_path, ["potential: w**2*x**2/2 + eps*x**4/4"]), 2)
    assert str(told.formula(told.oscillation.frequency)) == "w"
    assert corrections(told) == ["3*amplitude**2/(8*w**2)", "-21*amplitude**4/(256*w**4)"]
    assert told.oscillation.residuals == (3, 3)
    first = told.wave(told.oscillation.series[1][1]).polynomial
    ring = told.ring
    s, c = (ring.generator(kind, "phase") for kind in ("sine", "cosine"))
    a = told.formula(told.oscillation.amplitude).polynomial
    by_hand = ring.times(ring.multiple_angle(s, c, 3)[1] - c, a**3)  # 32 w^2 x_1 = a^3 (cos 3T - cos T)
    w = ring.generator("parameter", "w")
    assert ring.is_zero(ring.times(first, 32 * w**2) - by_hand)


def test_a_quadratic_oscillator(tmp_path):
    """x'' + x + eps x^2: omega = 1 - 5 eps^2 a^2/12, by hand: x_1 = a^2 (-1/2 + cos(2T)/6 + cos(T)/3)."""
    told = oscillating(point(tmp_path, ["potential: x**2/2 + eps*x**3/3"]), 2)
    assert corrections(told) == ["0", "-5*amplitude**2/12"]


def test_van_der_pol_has_one_amplitude(tmp_path):
    told = oscillating(point(tmp_path, ["potential: x**2/2", "generalized force: {x: eps*(1 - x**2)*x_dot}"]), 4)
    assert told.oscillation.kind is Amplitude.DETERMINED
    assert str(told.formula(told.oscillation.amplitude)) == "2"
    assert corrections(told) == ["0", "-1/16", "0", "17/3072"]
    assert str(told.written(told.oscillation.series[told.oscillation.names.index("x")][1])) == "-1/4*sin(3*phase)"


def test_a_damped_oscillator_has_no_periodic_solution(tmp_path):
    loads = ["potential: w**2*x**2/2 + eps*x**4/4", "generalized force: {x: -eps*k*x_dot}"]
    with pytest.raises(NotPeriodic, match="order 1 of eps secular terms remain unless k = 0"):
        oscillating(point(tmp_path, loads), 2)
    loads = ["potential: w**2*x**2/2 + eps*x**4/4", "generalized force: {x: -k*x_dot}"]
    with pytest.raises(NotPeriodic, match="no pair of imaginary roots"):
        oscillating(point(tmp_path, loads), 2)


def _damped_by(even):
    return ["potential: x**2/2", f"generalized force: {{x: eps*({even})*x_dot}}"]


@pytest.mark.parametrize(
    ("even", "squares"),
    [
        ("1 - 3*x**2 + x**4", {2.0, 4.0}),
        ("1 - 4*x**2 + x**4", {4 - 8**0.5, 4 + 8**0.5}),
    ],
)
def test_every_amplitude_of_several_cycles_is_told(tmp_path, even, squares):
    """x'' + x = eps (c0 + c2 x^2 + c4 x^4) x': a' = eps a (c0/2 + c2 a^2/8 + c4 a^4/16).

    By hand a^4 - 6 a^2 + 8 = 0 and a^4 - 8 a^2 + 8 = 0, both with two positive squares and simple roots: two cycles.
    """
    told = oscillating(point(tmp_path, _damped_by(even)), 2)
    a = told.oscillation.amplitude
    taken = float(told.formula(a * a).to_sympy())
    left = told.formula(told.oscillation.other_amplitudes).to_sympy()
    (symbol,) = left.free_symbols
    other = float(-left.subs(symbol, 0))  # a^2 - other
    assert {round(taken, 9), round(other, 9)} == {round(x, 9) for x in squares}
    shown = [Writer().said(said) for said in sentences(told)]
    assert any("Other amplitudes are left out" in one for one in shown)
    assert oscillation_data(told, "not measured").amplitude.others is not UNSET


def test_an_amplitude_that_is_surely_imaginary_is_passed_over(tmp_path):
    """c0 = 8 k, c2 = -8 (k - 4), c4 = -16: -(a^2 + k)(a^2 - 4) by the formula above; with k > 0 one cycle, a = 2."""
    told = oscillating(point(tmp_path, _damped_by("8*w - 8*(w - 4)*x**2 - 16*x**4")), 1)
    assert str(told.formula(told.oscillation.amplitude)) == "2"
    assert told.oscillation.other_amplitudes is None
    with pytest.raises(NotPeriodic, match="for every real amplitude"):
        oscillating(point(tmp_path, _damped_by("1 + x**2 + x**4")), 1)


def test_a_given_amplitude_is_the_one_that_is_meant(tmp_path):
    """Van der Pol has a = 2 alone: no family with the number 2 in it, and nothing at 1, which denies no other.

    Of a^4 - 6 a^2 + 8 = 0 the given 2 is taken; x'' + x + eps x^2 = 0 is a family, the number is put into it.
    """
    system = point(tmp_path, _damped_by("1 - x**2"))
    assert oscillating(system, 2, {"amplitude": Fraction(2)}).oscillation.kind is Amplitude.DETERMINED
    with pytest.raises(NotPeriodic, match="with this amplitude secular terms remain in the order 1"):
        oscillating(system, 2, {"amplitude": Fraction(1)})
    told = oscillating(point(tmp_path, _damped_by("1 - 3*x**2 + x**4")), 1, {"amplitude": Fraction(2)})
    assert str(told.formula(told.oscillation.amplitude)) == "2"
    family = oscillating(point(tmp_path, ["potential: x**2/2 + eps*x**3/3"]), 2, {"amplitude": Fraction(1)})
    assert family.oscillation.kind is Amplitude.FREE
    assert corrections(family) == ["0", "-5/12"]
    with pytest.raises(ZeroDivisionError, match="no oscillation"):
        oscillating(point(tmp_path, ["potential: x**2/2 + eps*x**3/3"]), 2, {"amplitude": Fraction(0)})


def test_constants_that_were_given_are_named_where_they_leave_nothing(tmp_path):
    """x'' + x = eps (1 - z') x', z'' = eps (x^2 - z'): z' = 1 and a^2 = 2 by hand, from the means of both."""
    loads = ["potential: x**2/2", "generalized force: {x: eps*(1 - z_dot)*x_dot, z: eps*(x**2 - z_dot)}"]
    system = point(tmp_path, loads, "x, z")
    told = oscillating(system, 1, {"z_dot_0": Fraction(1)}, "x")
    assert str(told.formula(told.oscillation.amplitude)) == "sqrt(2)"
    with pytest.raises(NotPeriodic, match="with the constants that were given"):
        oscillating(system, 1, {"z_dot_0": Fraction(2)}, "x")
    with pytest.raises(NoClosedForm, match="unless z_dot_0 - 1 = 0"):
        oscillating(system, 1, {}, "x")


def test_amplitudes_that_are_not_expressed_are_not_denied(tmp_path):
    """c6 adds 5 a^6/128: 5 a^6 - 72 a^4 + 144 a^2 - 64 is positive at a^2 = 1, negative at 0 and 4."""
    with pytest.raises(NoClosedForm, match=r"unless 5\*amplitude\*\*6") as raised:
        oscillating(point(tmp_path, _damped_by("1 - 9*x**2 + 9*x**4 - x**6")), 1)
    assert not isinstance(raised.value, NotPeriodic)


def test_a_family_is_not_said_to_be_periodic_beyond_its_order(tmp_path):
    """x'' + x = x^4 x': the energy grows by the integral of x^4 x'^2 > 0; in the order 2 nothing of that is seen."""
    loads = ["potential: x**2/2", "generalized force: {x: x**4*x_dot}"]
    told = oscillating(point(tmp_path, loads, small="", more="motion: {x: 0}\n"), 2)
    shown = " ".join(Writer().said(said) for said in sentences(told))
    assert "whether some remain in higher orders" in shown.lower()
    assert "cut off so" in shown
    assert "may leave terms of order 3" in shown


def test_a_root_zero_that_is_driven_is_no_exchange_of_energy(tmp_path):
    """x'' + x + eps y = 0, y'' + eps x = 0: (s^2 + 1) s^2 = eps^2, so that s = +-i (1 + eps^2/2 + ...) is periodic."""
    with pytest.raises(Resonance, match="not looked for") as raised:
        oscillating(point(tmp_path, ["potential: x**2/2 + eps*x*y"], "x, y"), 2, leading="x")
    assert "energy" not in str(raised.value)


def test_two_oscillators_at_one_to_two(tmp_path):
    """x^2 y drives y at 2 w: resonance where its frequency is 2 w, and a divisor w^2 k^2 - 4 w^2 where it is k w."""
    loads = ["potential: w**2*x**2/2 + 4*w**2*y**2/2 + eps*x**2*y"]
    with pytest.raises(Resonance, match="y are driven at 2 times the frequency"):
        oscillating(point(tmp_path, loads, "x, y"), 2, leading="x")
    loads = ["potential: w**2*x**2/2 + k**2*w**2*y**2/2 + eps*x**2*y"]
    told = oscillating(point(tmp_path, loads, "x, y"), 2, leading="x")
    two = next(one for one in told.oscillation.divisors if one.harmonic == 2 and "y" in one.variables)
    assert str(told.formula(two.value)) == "w**2*(k - 2)*(k + 2)"
    # by hand: y_1 = -a^2/(2 k^2 w^2) - a^2 cos(2T)/(2 w^2 (k^2 - 4)) and x'' + w^2 x = -2 eps^2 x_0 y_1
    ring, a = told.ring, told.formula(told.oscillation.amplitude).polynomial
    k, w = (ring.generator("parameter", name) for name in ("k", "w"))
    second = told.formula(told.oscillation.corrections[1]).polynomial
    assert ring.is_zero(ring.times(second, 4 * w**4 * k**2 * (k**2 - 4)) - a**2 * (8 - 3 * k**2))
    with pytest.raises(NoClosedForm, match="several frequencies"):
        oscillating(point(tmp_path, loads, "x, y"), 2)


COUPLED = "potential: w**2*(x**2 + y**2)/2 + k*(x - y)**2/2 + {}"


def test_the_other_frequency_of_two_coupled_oscillators_is_named(tmp_path):
    """u = (x + y)/2 with the square w^2 of its frequency, v = (x - y)/2 with w^2 + 2 k, and the force of eps x^4/4.

    By hand along u = a cos T: v_1'' + (w^2 + 2 k) v_1 = -u_0^3/2 = -a^3 (3 cos T + cos 3T)/8, so that the harmonic 1 is
    divided by w^2 + 2 k - w^2, and 3 by w^2 + 2 k - 9 w^2.  y_1 = x_1 - 2 v_1 holds 3 a^3/(8 k) cos T.
    """
    told = oscillating(point(tmp_path, [COUPLED.format("eps*x**4/4")], "x, y"), 1, leading="x")
    assert str(told.formula(told.oscillation.frequency)) == "w"
    shown = {one.harmonic: str(numerator(told, one.value)) for one in told.resonances}
    assert shown == {1: "k", 3: "k - 4*w**2"}
    x, y = (told.oscillation.series[told.oscillation.names.index(name)][1].wave(1)[0] for name in "xy")
    ring = told.ring
    a, k = told.formula(told.oscillation.amplitude).polynomial, ring.generator("parameter", "k")
    assert ring.is_zero(ring.times(told.formula(y - x).polynomial, 8 * k) - 3 * a**3)


def test_where_nothing_is_divided_no_frequency_is_named(tmp_path):
    """Along u = x = y the force eps (x + y)^3 drives u alone; one oscillator has no other frequency."""
    told = oscillating(point(tmp_path, [COUPLED.format("eps*(x + y)**4/4")], "x, y"), 1, leading="x")
    assert told.oscillation.divisors == ()
    told = oscillating(point(tmp_path, ["potential: w**2*x**2/2 + eps*x**4/4"]), 2)
    assert told.oscillation.divisors == ()
    # x_0^2 holds the harmonics 0 and 2 only; the squares of frequencies hold a root
    loads = ["potential: w**2*(x**2 + 2*y**2)/2 + k*x*y + eps*x**3"]
    told = oscillating(point(tmp_path, loads, "x, y"), 1, leading="x")
    assert {one.harmonic for one in told.oscillation.divisors} == {0, 2}


def test_a_pendulum_about_its_rest_by_its_amplitude(tmp_path):
    """No small parameter is named: that is the size of the deviation.  A planted 1 in 1000 is seen in the residuals."""
    loads = ["potential: -w**2*cos(x)"]
    analysis = point(
        tmp_path,
        loads,
        small="",
        more="motion: {x: 0}\nvalues: {w: 2, eps: 1, k: 0}\ninitial: {x: {position: 1/2, velocity: 0}}\n",
    )
    told = oscillating(analysis, 4)
    assert told.taylor
    assert corrections(told) == ["0", "-amplitude**2/16", "0", "amplitude**4/3072"]
    measured = measured_orders(analysis.system, oscillating(analysis, 2))
    assert measured.simulated
    assert all(order > 2.9 for order in measured.orders)


@pytest.mark.parametrize(("size", "within"), [("1/4", True), ("2", False)])
def test_how_far_duffings_series_is_from_the_motion_with_eps_as_it_is_given(tmp_path, size, within):
    """x = a cos T + eps a^3 (cos 3T - cos T)/32, T' = 1 + 3 eps a^2/8, beside another method for the motion."""
    from scipy.integrate import solve_ivp

    more = f"values: {{w: 1, k: 0, eps: 1}}\ninitial: {{x: {{position: {size}, velocity: 0}}}}\n"
    analysis = point(tmp_path, ["potential: w**2*x**2/2 + eps*x**4/4"], more=more)
    told = oscillating(analysis, 1)
    measured = measured_orders(analysis.system, told)
    a, rate = float(Fraction(size)), 1 + 3 * float(Fraction(size)) ** 2 / 8
    times = np.linspace(0, 2 * np.pi / rate, ROWS + 1)[1:]
    motion = solve_ivp(
        lambda t, y: (y[1], -y[0] - y[0] ** 3), (0, times[-1]), (a, 0), "DOP853", times, rtol=1e-12, atol=1e-14
    )
    phase = rate * times
    series = a * np.cos(phase) + a**3 * (np.cos(3 * phase) - np.cos(phase)) / 32
    speed = -rate * a * np.sin(phase) + a**3 * (np.sin(phase) - 3 * np.sin(3 * phase)) / 32  # to the order eps
    pairs = (series, motion.y[0]), (speed, motion.y[1])
    expected = max(np.abs(x - y).max() / np.abs(x).max() for x, y in pairs)
    assert measured.relative[0] == pytest.approx(expected, rel=0.02)
    assert bool(expected < 0.01) is within
    first = Writer().said(next(iter(measured_sentences(told, measured))))
    assert ("with eps = 1, as given" in first) is within
    assert ("up to eps = " in first) is not within


def said_of(told, measured):
    return " ".join(map(Writer().said, measured_sentences(told, measured)))


def test_how_far_a_series_holds_is_the_same_in_other_units_of_length(tmp_path):
    """In metres and in nanometres; with an amplitude of 1e-9 all errors were "no more than rounding"."""

    def in_units(metre):
        more = f"values: {{w: 1, k: {metre**2}, eps: 1/2}}\ninitial: {{x: {{position: 1/{metre}, velocity: 0}}}}\n"
        analysis = point(tmp_path, ["potential: w**2*x**2/2 + eps*k*x**4/4"], more=more)
        return measured_orders(analysis.system, oscillating(analysis, 1))

    one, other = in_units(1), in_units(10**9)
    assert all(1.9 < order < 2.1 for order in other.orders)
    assert other.orders == pytest.approx(one.orders, abs=0.01)
    assert other.relative == pytest.approx(one.relative, rel=1e-3)


def test_what_a_series_sets_to_zero_is_told_apart(tmp_path):
    """y'' + 7 y = -eps^2 x^2 moves y at the order 2; to the order 1 nothing is within 0.2 % of its largest value."""
    more = "values: {w: 1, k: 1, eps: 1/5}\ninitial: {x: {position: 1, velocity: 0}, y: {position: 0, velocity: 0}}\n"
    analysis = point(tmp_path, ["potential: w**2*x**2/2 + 7*y**2/2 + eps**2*x**2*y"], "x, y", more=more)
    told = oscillating(analysis, 1, leading="x")
    measured = measured_orders(analysis.system, told)
    assert set(measured.unmoved) == {"y", "y_dot"}
    assert "sets to zero to this order: y" in said_of(told, measured)


def test_where_the_motion_runs_away_the_series_does_not_hold(tmp_path):
    """With eps = 2 the force is eps^2 x^5 of the wrong sign: the run ended early, and its rows were missed."""
    more = "values: {w: 1, k: 1, eps: 2}\ninitial: {x: {position: 1, velocity: 0}}\n"
    analysis = point(tmp_path, ["potential: w**2*x**2/2 + eps*x**4/4 - eps**2*x**6/4"], more=more)
    told = oscillating(analysis, 2)
    measured = measured_orders(analysis.system, told)
    assert measured.relative[0] == inf > measured.relative[1]
    assert all(2.6 < order < 3.2 for order in measured.orders)
    assert "not with 2, as given" in said_of(told, measured)


GYROSTAT = reference("gyrostat-oscillation")
_OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
#: sin and cos of T by the tangent of T/2 = 1/2.
SINE, COSINE = Fraction(4, 5), Fraction(3, 5)


def value(text, known):
    """A formula of the reference at rational numbers; sin and cos of multiples of T."""

    def of(node):
        match node:
            case ast.Constant(value=x):
                return Fraction(x)
            case ast.Name(id=name):
                return known[name]
            case ast.UnaryOp(operand=x):
                return -of(x)
            case ast.BinOp(op=ast.Pow(), left=a, right=b):
                return of(a) ** int(of(b))
            case ast.BinOp(op=op, left=a, right=b):
                return _OPERATORS[type(op)](of(a), of(b))
            case ast.Call(func=ast.Name(id=name), args=[x]):
                k = 1 if isinstance(x, ast.Name) else int(of(x.left))
                s, c = SINE, COSINE
                for _ in range(k - 1):
                    s, c = s * COSINE + c * SINE, c * COSINE - s * SINE
                return s if name == "sin" else c
        raise AssertionError(ast.dump(node))

    return of(ast.parse(text, mode="eval").body)


@pytest.fixture(scope="module")
def gyrostat():
    return mbsym.load(SHIPPED / "gyrostat-fast.yaml")


@pytest.fixture(scope="module")
def fast(gyrostat):
    return oscillating(gyrostat, 2)


@pytest.mark.parametrize("moment", [Fraction(0), Fraction(3, 7)])
def test_the_gyrostat_to_second_order(fast, moment):
    """All six functions and the frequency of references/gyrostat, section 2.2, with and without l_x.

    In units with C = r0 = gamma0'' = 1: a = A, b = B, y1 = lx, nz = lz, x0' = g M x0, k = 3 g/R, M3 = amplitude.
    """
    numbers = {"a": Fraction(2, 3), "b": Fraction(7, 10), "nz": Fraction(3, 11), "y1": moment, "M3": Fraction(4, 3)}
    numbers |= {"x0": Fraction(2, 7), "y0": Fraction(3, 7), "z0": Fraction(6, 7), "k": Fraction(1, 5)}
    known = dict(numbers)
    known |= {"Aa": (1 - known["b"] + known["nz"]) / known["a"], "Bb": (known["a"] - 1 - known["nz"]) / known["b"]}
    for name in ("P0", "Omega2", "X", "A1", "B1", "C1", "lambda_", "lambda1", "lambda2", "nu"):
        known[name] = value(GYROSTAT[name], known)
    ours = {"A": known["a"], "B": known["b"], "C": Fraction(1), "M": Fraction(1), "g": Fraction(1), "R": 3 / known["k"]}
    ours |= {name: known[name] for name in ("x0", "y0", "z0")} | {"lx": moment, "lz": known["nz"]}
    symbols = {"amplitude": known["M3"], "r_0": Fraction(1), "gamma3_0": Fraction(1)}

    def at(formula):
        ring = fast.ring
        images = {ring.index("parameter", name): ring.number(x) for name, x in (ours | symbols).items()}
        images |= {ring.index("sine", "phase"): ring.number(SINE), ring.index("cosine", "phase"): ring.number(COSINE)}
        return _number(ring, formula, images)

    assert at(fast.formula(fast.oscillation.corrections[0])) == 0
    assert at(fast.formula(fast.oscillation.corrections[1])) == known["nu"]
    names = {"p": "p1", "q": "q1", "r": "r1", "gamma1": "g1", "gamma2": "g1p", "gamma3": "g1pp"}
    for name, series in zip(fast.oscillation.names, fast.oscillation.series, strict=True):
        for n in range(3):
            assert at(fast.wave(series[n])) == value(GYROSTAT[f"order{n}"][names[name]], known), (name, n)


def _number(ring, formula, images):
    top, factors = ring.fraction(formula.polynomial)
    found = Fraction(1)
    for part, exponent in [(top, 1), *((factor, -exponent) for factor, exponent in factors)]:
        x = ring.substitute(part, images)
        c = x.leading_coefficient() if not x.is_zero() else 0
        found *= Fraction(int(c.p), int(c.q)) ** exponent if c else 0
    return found


def test_divisors_of_the_gyrostat(fast):
    """Omega^2 = 0, 1 and 4 (references/gyrostat, the row on singular points)."""
    assert sorted(one.harmonic for one in fast.oscillation.divisors) == [0, 1, 2]


def test_the_measured_orders_of_the_gyrostat(gyrostat, fast):
    """3, 3, 4, 4, 4, 4 without l_x, and 3 with it (references/gyrostat, section 2.3)."""
    with_moment = measured_orders(gyrostat.system, fast)
    assert [round(x) for x in with_moment.orders] == [3] * 6
    other = oscillating(gyrostat, 2, {"lx": Fraction(0)})
    assert [round(x) for x in measured_orders(gyrostat.system, other).orders] == [3, 3, 4, 4, 4, 4]


def test_a_planted_error_is_seen_twice(gyrostat, fast):
    """One coefficient of second order of gamma1 a little off: residuals, and measured orders."""
    from dataclasses import replace

    found = fast.oscillation
    place, tower = found.names.index("gamma1"), found.tower
    rows = [list(one) for one in found.series]
    rows[place][2] = rows[place][2].scaled(tower.number(1) + tower.number(1) / tower.number(1000))
    wrong = replace(found, series=tuple(map(tuple, rows)))
    small = dict(found.powers)
    from mbsym.problems.small_parameter.generating import graded_rows

    graded = graded_rows(tower, fast.field, "eps", small, 3)
    assert min(x for x in oscillation_orders(graded, fast.field.variables, wrong) if x is not None) == 2
    assert min(x for x in oscillation_orders(graded, fast.field.variables, found) if x is not None) == 3
    assert measured_orders(gyrostat.system, replace(fast, oscillation=wrong)).orders[place] < 2.8


def test_the_papers_solution_is_wrong_where_there_is_a_moment(fast):
    """(41) has p = 0 in the order 0, and gamma'' with y1 in place of P0 = y1/(1 - a + nz) in the order 1; without l_x
    both are right (references/gyrostat, the row on (41)).  In our units P0 = lx r0/((C - A) r0 + lz)."""
    ring = fast.ring
    a, c, lx, lz = (ring.generator("parameter", name) for name in ("A", "C", "lx", "lz"))
    r, m = (ring.generator("parameter", name) for name in ("r_0", "amplitude"))
    cosine = ring.generator("cosine", "phase")
    series = dict(zip(fast.oscillation.names, fast.oscillation.series, strict=True))
    p, gamma = fast.wave(series["p"][0]).polynomial, fast.wave(series["gamma3"][1]).polynomial
    assert ring.is_zero(ring.times(p, (c - a) * r + lz) - lx * r)
    assert not ring.is_zero(p)  # (41)
    assert ring.is_zero(ring.times(gamma, (c - a) * r + lz) - lx * m * (1 - cosine))
    printed = ring.times(lx * m * (1 - cosine), ring.reciprocal(ring.times(c, r)))  # M3 y1 (1 - cos), y1 = lx/(C r0)
    assert not ring.is_zero(gamma - printed)
    without = {ring.index("parameter", "lx"): ring.zero}
    assert ring.substitute(p, without).is_zero()
    assert ring.substitute(gamma - printed, without).is_zero()


def test_the_spring_pendulum_names_one_to_two():
    """k/m = 4 g/l with l = l0 + m g/k: 3 m g = k l0."""
    told = oscillating(mbsym.load(SHIPPED / "spring-pendulum.yaml"), 2, leading="theta")
    assert told.real
    shown = [(one.harmonic, str(numerator(told, one.value))) for one in told.resonances]
    assert shown == [(2, "k*(k*l0 - 3*m*g)")]


@pytest.mark.parametrize(("which", "square", "ratio"), [(1, 2 - 2**0.5, 2**0.5), (2, 2 + 2**0.5, -(2**0.5))])
def test_each_frequency_of_the_double_pendulum_leads(which, square, ratio):
    """Equal masses and lengths: w^2 = (2 -+ sqrt 2) g/l, absolute angles in the ratio +-sqrt 2 (theta2 is relative)."""
    analysis = mbsym.load(SHIPPED / "double-pendulum.yaml")
    numbers = {name: Fraction(1) for name in ("m1", "m2", "l1", "l2")} | {"g": Fraction(9)}
    found = oscillating(analysis, 2, numbers, "theta1", which)
    tower = found.oscillation.tower
    values = dict.fromkeys(tower.parameters, 1)
    assert float(tower.enclosed(found.oscillation.frequency, values).real) ** 2 == pytest.approx(9 * square)
    waves = {
        name: one[0].waves[1][0] for name, one in zip(found.oscillation.names, found.oscillation.series, strict=True)
    }
    assert float(tower.enclosed(waves["theta2"], values).real) == pytest.approx(ratio - 1)
    assert found.real
    assert found.resonances == ()  # 18 sqrt 2 and the like: numbers that are not zero
    assert min(measured_orders(analysis.system, found, numbers).orders) > 2.8


def test_a_frequency_that_is_not_there_is_told():
    numbers = {name: Fraction(1) for name in ("m1", "m2", "l1", "l2", "g")}
    with pytest.raises(NoClosedForm, match="have 2 frequencies: there is none with the number 3"):
        oscillating(mbsym.load(SHIPPED / "double-pendulum.yaml"), 1, numbers, "theta1", 3)


def test_what_cannot_oscillate_is_refused(tmp_path):
    with pytest.raises(NoClosedForm, match="square of its frequency is < 0"):
        oscillating(point(tmp_path, ["potential: -w**2*x**2/2 + eps*x**4/4"]), 2)


@pytest.mark.parametrize(
    ("even", "amplitude", "exponent", "attracts"),
    [
        ("1 - x**2", 2, "-1", True),
        ("x**2 - 1", 2, "1", False),
        ("1 - 3*x**2 + x**4", 2, "1", False),
        ("w - x**2", None, "-w", True),
    ],
)
def test_a_single_cycle_attracts_or_repels(tmp_path, even, amplitude, exponent, attracts):
    """x'' + x = eps f(x) x': div X = eps f, whose mean over a cycle of amplitude a is the exponent (Poincare).

    f = c0 + c2 x^2 + c4 x^4: c0 + c2 a^2/2 + 3 c4 a^4/8.  By hand 1 - 2 = -1 for van der Pol's, a = 2; of
    1 - 3 x^2 + x^4  1 - 6 + 6 = 1 at a = 2 (the inner cycle has 1 - 3 + 3/2 = -1/2); w - 2 w = -w at a^2 = 4 w.
    """
    given = {} if amplitude is None else {"amplitude": Fraction(amplitude)}
    told = oscillating(point(tmp_path, _damped_by(even)), 2, given)
    power, x = told.oscillation.exponent
    assert (power, str(told.formula(x)), told.attracts) == (1, exponent, attracts)
    shown = [Writer().said(said) for said in sentences(told)]
    assert any(("asymptotically orbitally stable." in one) is attracts and "Poincare" in one for one in shown)
    data = oscillation_data(told, "not measured").exponent
    assert (data.power, data.value, data.attracts) == (1, exponent, attracts)


def test_of_families_nothing_is_said(tmp_path):
    told = oscillating(point(tmp_path, ["potential: x**2/2 + eps*x**3/3"]), 2)
    assert told.oscillation.exponent is None
    assert not any("Poincare" in Writer().said(said) for said in sentences(told))


def inverted(series):
    """1/(1 + c_1 t + c_2 t^2 + ...)."""
    found = [Fraction(1)]
    for n in range(1, len(series)):
        found.append(-sum((series[k] * found[n - k] for k in range(1, n + 1)), Fraction(0)))
    return found


def test_duffings_frequency_to_the_sixth_order(tmp_path):
    """w T/4 = integral of dt/sqrt(1 + e (1 + sin^2 t)/2) over a quarter, e = eps a^2/w^2, by energy: x = a sin t.

    <sin^(2 j)> = (2 j choose j)/4^j;  (1 + z)^(-1/2) = sum of (2 n choose n) (-z/4)^n.
    """
    period = [
        Fraction((-1) ** n * comb(2 * n, n), 8**n)
        * sum(comb(n, j) * Fraction(comb(2 * j, j), 4**j) for j in range(n + 1))
        for n in range(7)
    ]
    told = oscillating(point(tmp_path, ["potential: w**2*x**2/2 + eps*x**4/4"]), 6)
    for n, by_hand in enumerate(inverted(period)[1:], start=1):
        at = told.formula(told.oscillation.corrections[n - 1]).subs({"amplitude": 1, "w": 1})
        assert Fraction(str(at)) == by_hand


def test_a_pendulums_period_to_the_eighth_order(tmp_path):
    """w T = 2 pi sum of ((2 n choose n)/4^n)^2 sin^(2 n)(a/2): 1 + a^2/16 + 11 a^4/3072 + 173 a^6/737280 + ..."""
    sine = [Fraction(0), Fraction(1, 2), Fraction(0), Fraction(-1, 48), Fraction(0), Fraction(1, 3840)]
    sine += [Fraction(0), Fraction(-1, 645120), Fraction(0)]

    def times(p, q):
        return [sum((p[j] * q[n - j] for j in range(n + 1)), Fraction(0)) for n in range(9)]

    square, power = times(sine, sine), [Fraction(int(n == 0)) for n in range(9)]
    period = [Fraction(0)] * 9
    for n in range(5):
        period = [x + Fraction(comb(2 * n, n), 4**n) ** 2 * y for x, y in zip(period, power, strict=True)]
        power = times(power, square)
    assert period[::2] == [1, Fraction(1, 16), Fraction(11, 3072), Fraction(173, 737280), Fraction(22931, 1321205760)]
    told = oscillating(point(tmp_path, ["potential: -w**2*cos(x)"], small="", more="motion: {x: 0}\n"), 8)
    for n, by_hand in enumerate(inverted(period)[1:], start=1):
        assert Fraction(str(told.formula(told.oscillation.corrections[n - 1]).subs({"amplitude": 1}))) == by_hand
