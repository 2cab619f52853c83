"""Functions with kinks and jumps: values at and around them in every algebra, and derivatives that are refused."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_series, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from test_ring import is_zero, lower, lowering, new_ring, parsed

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.jet import Jet, Jets
from mbsym.algebra.point import Arrays, Balls, Rationals
from mbsym.algebra.program import Program
from mbsym.expressions.tree import Derivation, differentiate, substitute, text
from mbsym.numerics.kernels import arrays, llvm
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.precise import precise

WRITTEN = ("abs(x)", "sign(x)", "step(x)", "pulse(x, -1/2, 3/4)")
#: Written by hand: below, at and above 0, and of the pulse at its ends.
VALUES = {
    "abs(x)": {-2: 2, 0: 0, 3: 3},
    "sign(x)": {-2: -1, 0: 0, 3: 1},
    "step(x)": {-2: 0, 0: Fraction(1, 2), 3: 1},
    "pulse(x, -1/2, 3/4)": {-2: 0, Fraction(-1, 2): Fraction(1, 2), 0: 1, Fraction(3, 4): Fraction(1, 2), 3: 0},
}
CASES = [(written, x, y) for written, table in VALUES.items() for x, y in table.items()]


@pytest.mark.parametrize(("written", "x", "y"), CASES)
def test_values_in_every_algebra(written: str, x: Any, y: Any) -> None:
    tree, point = parsed(written), Fraction(x)
    exact = fmpq(point.numerator, point.denominator)
    assert Lowering(Rationals({}, {}), {"x": exact})(tree) == fmpq(Fraction(y).numerator, Fraction(y).denominator)
    assert Lowering(Balls({}), {"x": arb(exact)})(tree) == arb(fmpq(Fraction(y).numerator, Fraction(y).denominator))
    program = Program()
    node = Lowering(program, {"x": program.input("x")})(tree)
    code = Code(program, ("x",), (node,))
    with ctx.workprec(200):
        assert precise(code, 200)([arb(exact)])[0] == arb(float(y))
    several = np.array([[float(x), 0.25, float(x)] * 5])
    for scalar in (FLOAT64, FLOAT32):
        for kernel in (arrays.kernel(code, scalar), llvm.kernels({"f": code}, scalar)["f"],
                       llvm.kernels({"f": code}, scalar, wide=True)["f"]):  # fmt: skip
            assert kernel(np.array([float(x)]))[0] == float(y)
            assert list(kernel(several)[0, ::3]) == [float(y)] * 5
    assert Lowering(program, {"x": program.number(point)})(tree) == program.number(Fraction(y))
    assert text(tree) == written


@pytest.mark.parametrize("written", WRITTEN)
@given(
    middle=st.integers(-128, 128).map(lambda k: Fraction(k, 64)),
    radius=st.integers(0, 64).map(lambda k: Fraction(k, 64)),
    inside=st.fractions(-1, 1),
)
@settings(max_examples=40)
def test_balls_over_a_kink_hold_every_value(written: str, middle: Fraction, radius: Fraction, inside: Fraction) -> None:
    ball = arb(fmpq(middle.numerator, middle.denominator), fmpq(radius.numerator, radius.denominator))
    point = middle + radius * inside
    exact = Lowering(Rationals({}, {}), {"x": fmpq(point.numerator, point.denominator)})(parsed(written))
    ring = new_ring()
    by_ring = ring.evaluate(lower(ring, written), {"x": ball})
    for found in (Lowering(Balls({}), {"x": ball})(parsed(written)), by_ring):
        assert found.contains(arb(exact))


@pytest.mark.parametrize(
    ("difference", "verdict"),
    [
        ("abs(x)**2 - x**2", True),
        ("abs(x - y) - abs(y - x)", True),
        ("sign(x - y) + sign(y - x)", True),
        ("abs(l) - l", True),  # l is positive
        ("sign(l + m) - 1", True),
        ("step(x) + step(-x) - 1", True),
        ("abs(x) - x", False),
        ("sign(x) - 1", False),
        ("abs(x) + x", False),
        ("abs(w) - w", False),
        ("sign(x)**2 - 1", None),  # false at x = 0
        ("abs(x) - x*sign(x)", True),  # at x = 0, too
    ],
)
def test_zeros(difference: str, verdict: bool | None) -> None:
    assert is_zero(difference) is verdict


def test_derivatives_of_a_modulus() -> None:
    """d |u| = sign(u) du, d (|u| u) = 2 |u| du: compared at numbers, off the kink."""
    values = {name: fmpq(3 + k, 7) for k, name in enumerate(("x", "y", "chi", "l", "m", "w", "t", "x_dot"))}
    values |= {"y_dot": fmpq(-2, 3), "x_ddot": fmpq(0), "y_ddot": fmpq(0)}
    for written, name, slope in (
        ("abs(x - y)", "x", "sign(x - y)"),
        ("abs(x - y)", "y", "-sign(x - y)"),
        ("abs(sin(x) - 1/2)**3", "x", "3*abs(sin(x) - 1/2)**2*sign(sin(x) - 1/2)*cos(x)"),
        ("abs(y_dot)*y_dot", "y_dot", "2*abs(y_dot)"),
    ):
        ring = new_ring()
        lowered = lowering(ring)
        found, wanted = ring.derivative(lowered(parsed(written)), name), lowered(parsed(slope))
        by_tree = lowered(differentiate(parsed(written), name))
        with ctx.workprec(200):
            for other in (wanted, by_tree):
                gap = ring.evaluate(found - other, values)
                assert gap.contains(0)
                assert gap.rad() < 1e-40


@pytest.mark.parametrize("written", ["sign(x - t)", "step(x - t)", "pulse(x - t, 0, w)", "x*sign(y + x - t)"])
@pytest.mark.parametrize("name", ["x", "t"])
def test_what_jumps_has_no_derivative(written: str, name: str) -> None:
    """A derivative of 0 would prove that a step is conserved, and that a potential with a step has no force."""
    ring = new_ring()
    polynomial = lower(ring, written)
    with pytest.raises(NoClosedForm, match="jump"):
        ring.derivative(polynomial, name)
    assert ring.derivative(polynomial, "chi").is_zero()
    assert ring.depends_on(polynomial, name)
    with pytest.raises(ValueError, match="jump"):
        differentiate(parsed(written), name)
    with pytest.raises(NoClosedForm, match="jump"):
        ring.velocity_derivative(lower(ring, "sign(y_dot)"), "y")


def test_a_sign_at_rest_is_refused() -> None:
    ring = new_ring()
    friction = lower(ring, "w*sign(x_dot)")
    with pytest.raises(NoClosedForm, match="jump"):
        ring.substitute(friction, {ring.index("velocity", "x"): ring.zero})
    drag = lower(ring, "x_dot*abs(x_dot)")
    assert ring.substitute(drag, {ring.index("velocity", "x"): ring.zero}).is_zero()


def _jets(at: str) -> tuple[Jets, Lowering]:
    ring = new_ring()
    base = lower(ring, at)
    jets = Jets(ring, {"x": parsed(at)}, {"x": 0}, {"x": base})
    return jets, Lowering(jets, {"x": jets.deviation(0, base), "w": Jet(lower(ring, "w")), "l": Jet(lower(ring, "l"))})


def test_an_expansion_off_the_kink_is_the_series() -> None:
    """|a + u|^3 about a = -3/2, by the power series of -(a + u)^3."""
    jets, lowered = _jets("-3/2")
    found = lowered(parsed("abs(x)**3 + sign(x)"))
    with ctx.workprec(100):
        series = -(arb_series([fmpq(-3, 2), 1], 3) ** 3) - 1
    whole = [found.value, found.first[0], found.second[0, 0]]
    for k, coefficient in enumerate(whole):
        assert jets.ring.evaluate(coefficient, {}).overlaps(series[k])


@pytest.mark.parametrize("at", ["0", "l - l", "w - w"])
@pytest.mark.parametrize("written", ["abs(x)", "sign(x)", "step(x)"])
def test_an_expansion_at_the_kink_is_refused(written: str, at: str) -> None:
    _, lowered = _jets(at)
    with pytest.raises(NoClosedForm, match=r"kink|jump"):
        _ = lowered(parsed(written)).first


def test_arrays_agree_with_numpy() -> None:
    x = np.linspace(-2, 2, 9)
    functions: dict[str, Callable[[Any], Any]] = {
        "abs(x)": np.abs,
        "sign(x)": np.sign,
        "step(x)": lambda z: np.heaviside(z, 0.5),
    }
    for written, wanted in functions.items():
        assert np.array_equal(Lowering(Arrays({}), {"x": x})(parsed(written)), wanted(x))


def test_trees_are_substituted_and_differentiated_by_all_arguments() -> None:
    tree = parsed("pulse(x, t, y)")
    assert text(substitute(tree, {"y": parsed("2*l"), "x": parsed("w")})) == "pulse(w, t, 2*l)"
    assert text(Derivation({"m": parsed("1")})(parsed("m*pulse(x, t, y)"))) == "pulse(x, t, y)"
