"""Where the third order decides nothing the fifth one does: N. N. Bautin's point, by Poincare's focal values."""

from __future__ import annotations

from fractions import Fraction
from math import comb

import pytest
import sympy

import mbsym
from mbsym.problems.normal_forms.result import Outcome, Theorem, Why

LINE = """
mbsym: 1
name: an oscillator
parameters: {{a: real}}
motion: {{x: 0}}
bodies:
  - {{name: P, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 1}}
loads:
  - potential: x**2/2 + {potential}
  - generalized force: {{x: "{force}"}}
values: {{a: {a}}}
"""


def _judged(force, potential="0", a="0"):
    return mbsym.loads(LINE.format(force=force, potential=potential, a=a)).normal_forms.at_values


def focal_values(force, potential):
    """eta_3, eta_5 of  V' = eta_3 r^4 + eta_5 r^6,  V = r^2/2 + V_3 + ... + V_6,  where  x'' = -x - P'(x) + Q(x, x').

    With V = r^2/2 in first approximation r' = eta_3 r^3 + ...; each V_n by linear equations.
    """
    x, v = sympy.symbols("x v")
    pushed = sympy.sympify(force.replace("x_dot", "v")) - sympy.diff(sympy.sympify(potential), x)
    found, total = [], (x**2 + v**2) / 2
    for n in range(3, 7):
        unknown = sympy.symbols(f"c0:{n + 1}")
        eta = sympy.Symbol("eta") if n % 2 == 0 else sympy.Integer(0)
        new = total + sum(c * x ** (n - k) * v**k for k, c in enumerate(unknown))
        rate = sympy.expand(
            sympy.diff(new, x) * v + sympy.diff(new, v) * (-x + pushed) - eta * (x**2 + v**2) ** (n // 2)
        )
        terms = [c for powers, c in sympy.Poly(rate, x, v).terms() if sum(powers) == n]
        (solution,) = sympy.solve(terms, [*unknown, *([eta] if n % 2 == 0 else [])], dict=True) or [{}]
        total = sympy.expand(new.subs(solution).subs(dict.fromkeys(unknown, 0)))
        if n % 2 == 0:
            found.append(Fraction(str(solution[eta])))
    return found


@pytest.mark.parametrize(
    ("force", "potential"),
    [
        ("x**4*x_dot", "0"),
        ("-x_dot**5", "0"),
        ("x*x_dot + x**2*x_dot", "x**3/3"),  # a centre: dv/dx = -g(x) (1 - v)/v, g = x + x^2, is separable
        ("x*x_dot + x**2*x_dot + x**4*x_dot/7 + x_dot**3*x", "x**3/3 + x**4/5 - x**5/3"),
        ("2*x*x_dot + 2*x**2*x_dot - x**3*x_dot", "x**3/3"),
        ("x_dot**2 + x_dot**3 - 3*x**2*x_dot + x**2*x_dot**2", "x**4"),
    ],
)
def test_the_fifth_order_is_poincares(force, potential):
    third, fifth = focal_values(force, potential)
    assert third == 0
    found = _judged(force, potential)
    assert found.degree == 5
    assert Fraction(str(found.coefficient)) == fifth
    outcome = Outcome.UNSTABLE if fifth > 0 else Outcome.ASYMPTOTIC if fifth else Outcome.UNDECIDED
    assert (found.outcome, found.theorem) == (outcome, Theorem.REDUCTION if fifth else Theorem.NONE)


@pytest.mark.parametrize("power", [2, 4])
def test_the_mean_of_a_damper_by_hand(power):
    """Q = x^(2 n) x': r' = r^(2 n + 1) <cos^(2 n) sin^2>, and the mean is comb(2 n, n)/4^n/(2 n + 2)."""
    found = _judged(f"x**{power}*x_dot")
    n = power // 2
    assert Fraction(str(found.coefficient)) == Fraction(comb(2 * n, n), 4**n * (2 * n + 2))
    assert found.degree == (None if power == 2 else 5)


def test_a_parameter_that_is_not_zero_decides_at_third_order():
    assert _judged("a*x**2*x_dot - x**4*x_dot", a="1/1000").outcome is Outcome.UNSTABLE
    assert _judged("a*x**2*x_dot - x**4*x_dot", a="0").outcome is Outcome.ASYMPTOTIC


def test_where_the_fifth_order_vanishes_too_nothing_is_said():
    found = _judged("x**6*x_dot")
    assert (found.outcome, found.why) == (Outcome.UNDECIDED, Why.COEFFICIENT_OPEN)


PLANE = """
mbsym: 1
name: an oscillator and what it drags along
parameters: {{k: positive}}
motion: {{{first}: 0, {second}: 0}}
bodies:
  - {{name: a, attached to: 0, connection point: [{x}, 0, 0], coordinates: [{first}], mass: 0}}
  - {{name: b, attached to: a, connection point: [0, {y}, 0], coordinates: [{second}], mass: 1}}
loads:
  - potential: ({x})**2/2 + ({y})**2
  - generalized force:
      {first}: {p}*({force})
      {second}: {q}*({force}) + ({drag})
values: {{k: 1}}
"""


def test_it_does_not_depend_on_the_coordinates():
    """y'' + 3 y' + 2 y = x^2 is dragged along; with x = u the same as with y = w + u, of which Q_u = Q_x + Q_y."""

    def judged(c):
        force = f"x_dot*y + ({c})*x**2*x_dot"
        text = PLANE.format(first="x", second="y", x="x", y="y", p=1, q=0, force=force, drag="x**2 - 3*y_dot")
        return mbsym.loads(text).normal_forms.at_values, force

    # At third order x^2 x' gives 1/8, whatever y does; for one factor it outweighs that.
    zero = -8 * Fraction(str(judged(0)[0].coefficient))
    there, force = judged(zero)
    assert there.degree == 5
    mixed = PLANE.format(
        first="u", second="w", x="u", y="w + u", p=1, q=0,
        force=force.replace("x", "u").replace("*y", "*(w + u)") + " + u**2 - 3*(w_dot + u_dot)",
        drag="u**2 - 3*(w_dot + u_dot)",
    )  # fmt: skip
    other = mbsym.loads(mixed).normal_forms.at_values
    assert (other.degree, other.coefficient) == (5, there.coefficient)


def test_problem_6_and_lists_of_equilibria_say_what_problem_11_does() -> None:
    """-x^4 x' takes energy wherever the oscillator is not at rest; without it "stable" is all."""
    lost = mbsym.loads(LINE.format(force="-x**4*x_dot", potential="0", a="0"))
    assert lost.stability.numerical.word == "asymptotically stable"
    assert [*mbsym.equilibria(lost).table["verdict"]] == ["asymptotically stable"]
    assert mbsym.loads(LINE.format(force="0", potential="0", a="0")).stability.numerical.word == "stable"
