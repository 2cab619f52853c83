"""Angles that are numbers: fractions of pi and decimals, in formulas, in signs and in statements."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, product

import pytest
from flint import arb, ctx, fmpq

import mbsym
from mbsym.algebra.ring import Ring
from mbsym.expressions.angles import LinearForm
from mbsym.problems.checks import EXACT, NUMERICAL

SLOPE = """
mbsym: 1
name: Pendulum in a plane turned from the vertical
parameters: {{g: positive, l: positive, m: positive}}
bodies:
  - {{name: slope, attached to: 0, rotation: {{axes: [1], angles: [{angle}]}}, mass: 0}}
  - name: pendulum
    attached to: slope
    rotation: {{axes: [3], angles: [{joint}]}}
    mass centre: [0, -l, 0]
    mass: m
    coordinates: [q]
loads:
  - uniform gravity: {{vector: [0, -g, 0]}}
motion: {{q: {rest}}}
"""


def slope(angle: str, joint: str = "q", rest: str = "0") -> mbsym.Analysis:
    return mbsym.loads(SLOPE.format(angle=angle, joint=joint, rest=rest))


def value(ring: Ring, x: object) -> arb:
    found = ring.constant_value(x)
    assert found is not None
    return found


@pytest.mark.parametrize("denominator", [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 12, 13, 15, 16, 18, 24, 30, 180])
def test_sines_and_cosines_of_fractions_of_pi(denominator: int) -> None:
    ring = Ring([], [], [], {}, spare=40)
    numerators = range(-2 * denominator, 2 * denominator + 1) if denominator < 30 else (1, 7, 37, -91)
    for numerator in numerators:
        turns = Fraction(numerator, denominator)
        s, c = ring.sin_cos(LinearForm(turns=turns)) if _room(ring) else (None, None)
        if s is None:
            break
        with ctx.workprec(300):
            angle = arb.pi() * arb(fmpq(turns.numerator, turns.denominator))
            assert abs(value(ring, s) - angle.sin()) < arb(2) ** -200, turns
            assert abs(value(ring, c) - angle.cos()) < arb(2) ** -200, turns
        assert ring.is_zero(ring.times(s, s) + ring.times(c, c) - 1) is True


def _room(ring: Ring) -> bool:
    return ring._free >= 6


def test_nested_roots_are_independent_of_others():
    ring = Ring([], [], ["a", "b"], {}, spare=12)
    eighth, fifth = (ring.sin_cos(LinearForm(turns=Fraction(1, n)))[1] for n in (8, 5))
    tenth = ring.sin_cos(LinearForm(turns=Fraction(1, 10)))[1]
    root = {n: ring.square_root(ring.number(n)) for n in (2, 3, 5)}
    # cos(pi/8)^2 = (2 + sqrt 2)/4; cos(pi/10)^2 = (5 + sqrt 5)/8; cos(pi/5)^2 = (3 + sqrt 5)/8
    assert ring.is_zero(4 * eighth * eighth - 2 - root[2]) is True
    assert ring.is_zero(8 * tenth * tenth - 5 - root[5]) is True
    assert ring.is_zero(8 * fifth * fifth - 3 - root[5]) is True
    a, b = ring.generator("parameter", "a"), ring.generator("parameter", "b")
    parts = [
        ring.one,
        eighth,
        tenth,
        root[2],
        root[3],
        root[5],
        ring.reduce(eighth * tenth),
        ring.reduce(eighth * root[2]),
    ]
    for (x, y), (p, q) in product(combinations(parts, 2), ((1, -1), (3, 7), (-239, 169))):
        assert ring.is_zero(a * (p * x + q * y) + b) is False
        with ctx.workprec(300):  # and truly different from zero
            assert not (p * value(ring, x) + q * value(ring, y)).contains(0)


def test_hidden_identities_are_never_called_different_from_zero():
    ring = Ring([], [], ["a"], {}, spare=40)
    a = ring.generator("parameter", "a")

    def pair(turns: Fraction = Fraction(0), radians: Fraction = Fraction(0)) -> tuple[object, object]:
        if radians:
            return ring.sin_cos_of(ring.number(radians))
        return ring.sin_cos(LinearForm(turns=turns))

    (_, c7), (_, c14) = pair(Fraction(1, 7)), pair(Fraction(1, 14))
    (_, small), (_, large) = pair(radians=Fraction(1, 5)), pair(radians=Fraction(2, 5))
    (s9, c9), (_, c18) = pair(Fraction(1, 9)), pair(Fraction(1, 18))
    # 2 cos^2 x - 1 = cos 2x; cos(pi/18) = cos(pi/6 - pi/9)
    hidden = [2 * c14 * c14 - 1 - c7, 2 * small * small - 1 - large]
    hidden.append(c18 - ring.number(Fraction(1, 2)) * (ring.square_root(ring.number(3)) * c9 + s9))
    for x in hidden:
        assert ring.is_zero(a * x) in (True, None)
        assert ring.is_zero(a * x + a) is False
    # 8 c^3 - 4 c^2 - 4 c + 1 = 0 for cos(pi/7): proved
    assert ring.is_zero(a * (8 * c7**3 - 4 * c7**2 - 4 * c7 + 1)) is True


FIXED = {
    "pi/12": (Fraction(1, 12), Fraction(0)),
    "pi/8": (Fraction(1, 8), Fraction(0)),
    "-pi/5": (Fraction(-1, 5), Fraction(0)),
    "2*pi/7": (Fraction(2, 7), Fraction(0)),
    "pi/24": (Fraction(1, 24), Fraction(0)),
    "37*pi/180": (Fraction(37, 180), Fraction(0)),
    "0.3": (Fraction(0), Fraction(3, 10)),
    "pi/7 - 0.3": (Fraction(1, 7), Fraction(-3, 10)),
}


@pytest.mark.parametrize("angle", FIXED)
def test_all_seven_problems_for_any_fixed_angle(angle: str) -> None:
    # The plane is turned about its horizontal axis 1 by the angle: K = m g l cos(angle), positive here.
    analysis = slope(angle)
    assert [analysis.stage(number).failure for number in range(1, 8)] == [None] * 7
    turns, radians = FIXED[angle]
    with ctx.workprec(256):
        turned = arb.pi() * arb(fmpq(turns.numerator, turns.denominator)) + radians.numerator / arb(radians.denominator)
        stiffness = analysis.ring.evaluate(analysis.linearisation.K[0, 0].polynomial, {"m": 2, "g": 3, "l": 5})
        assert abs(stiffness - 30 * turned.cos()) < arb(2) ** -200
    assert "Lagrange-Dirichlet" in str(analysis.stability.verdict)
    assert all(check.outcome in (EXACT, NUMERICAL) for check in analysis.checks)


def test_a_hidden_equilibrium_condition_is_not_called_impossible():
    text = SLOPE.format(angle="pi/7", joint="q", rest="0")
    text = text.replace("motion:", "  - generalized force: {q: g*(2*cos(pi/14)**2 - 1 - cos(pi/7))}\nmotion:")
    assert mbsym.loads(text).equilibrium.impossible == ()  # it holds for every g
    assert mbsym.loads(text).stage(5).failure is None
    proved = text.replace("2*cos(pi/14)**2 - 1 - cos(pi/7)", "cos(pi/7) - cos(2*pi/7) + cos(3*pi/7) - 1/2")
    assert mbsym.loads(proved).equilibrium.conditions == ()


def test_an_angle_with_a_constant_part_is_made_of_both():
    analysis = slope("0", joint="q + 0.3", rest="-0.3")
    assert str(analysis.linearisation.K[0, 0]) == "g*l*m"
    text = str(analysis.equations.forcing[0])
    assert "sin(q)" in text
    assert "cos(3/10)" in text


def test_dozens_of_constant_angles_leave_the_program():
    bodies, above = [], "0"
    for k in range(1, 11):
        angles = ", ".join(f"{(k * 7919 * j) % 6283 / 1000 - 3:.4f}" for j in (1, 2, 3))
        bodies.append(
            f"  - {{name: base{k}, attached to: {above}, rotation: {{axes: [1, 2, 3], angles: [{angles}]}}, mass: 0}}"
        )
        bodies.append(
            f"  - {{name: link{k}, attached to: base{k}, rotation: {{axes: [3], angles: [q{k}]}}, mass: 1, "
            f"mass centre: [0.1, 0.2, 0.05], coordinates: [q{k}]}}"
        )
        above = f"link{k}"
    text = "mbsym: 1\nname: arm\nbodies:\n" + "\n".join(bodies) + "\n"
    analysis = mbsym.loads(text)
    assert analysis.ring.spare > 45
    assert len(analysis.programs.forcing) == 10
    outcomes = {check.name: check.outcome for check in analysis.checks}
    assert outcomes["straight-line program"] == NUMERICAL
    assert outcomes["mass matrix"] == EXACT


def test_both_routes_meet_where_constants_and_names_are_mixed():
    # The pendulum hangs at 2 q + 1/10 + pi/9 = 2 pi, that is at q = pi - 1/20 - pi/18; q enters by its double.
    analysis = slope("0.7", joint="2*q + 0.1 + pi/9", rest="pi - 1/20 - pi/18")
    assert all(check.outcome in (EXACT, NUMERICAL) for check in analysis.checks), analysis.checks
    with ctx.workprec(256):
        stiffness = analysis.ring.evaluate(analysis.linearisation.K[0, 0].polynomial, {"m": 1, "g": 1, "l": 1})
        assert abs(stiffness - 4 * (arb(7) / 10).cos()) < arb(2) ** -200


def test_a_motion_may_add_a_number_to_a_parameter():
    text = SLOPE.format(angle="0", joint="q/2 - beta", rest="2*beta + 0.5").replace(
        "g: positive", "g: positive, beta: real"
    )
    analysis = mbsym.loads(text.replace("loads:", "loads:\n  - generalized force: {q: g*l*m*sin(1/4)/2}"))
    assert all(check.outcome in (EXACT, NUMERICAL) for check in analysis.checks), analysis.checks
    with ctx.workprec(256):  # V = -m g l cos(q/2 - beta): V'' = m g l/4 cos(1/4)
        stiffness = analysis.ring.evaluate(
            analysis.linearisation.K[0, 0].polynomial, {"m": 1, "g": 1, "l": 1, "beta": fmpq(1, 3)}
        )
        assert abs(stiffness - (arb(1) / 4).cos() / 4) < arb(2) ** -200
