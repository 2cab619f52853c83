"""Jets are Taylor polynomials: every coefficient is a derivative taken in the ring."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations_with_replacement

import pytest
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from test_ring import lower, lowering, new_ring, parsed

from mbsym.algebra.base import Lowering
from mbsym.algebra.jet import Jet, Jets
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import Call, Expression, Name, Negative, Operation, number

#: Deviations: x is x_0, y is x_1, x_dot is x_2.
NAMES = ("x", "y", "x_dot")
angles = ["x", "-x", "2*x", "x/2", "x - chi", "x + pi/2", "3*x/2 - chi", "chi"]
own_angles = ["l*x", "x*y", "y*w - 1", "w*t"]


def expanded(ring: Ring, expression: Expression, base: dict[str, str], order: int = 2) -> Jet:
    """The expression over jets about x = base['x'], y = base['y'] (absent: the coordinate itself), x' = 0."""
    motion = {name: parsed(text) for name, text in base.items()}
    plain = lowering(ring)
    lowered = dict(plain.environment) | {name: plain(value) for name, value in motion.items()}
    jets = Jets(ring, motion, {"x": 0, "y": 1}, lowered, order)
    environment = {name: Jet(value) for name, value in plain.environment.items()}
    for i, name in enumerate(("x", "y")):
        start = plain(motion[name]) if name in motion else plain.environment[name]
        environment[name] = jets.deviation(i, start)
    environment["x_dot"] = jets.deviation(2, ring.zero)
    return Lowering(jets, environment)(expression)


def taylor(ring: Ring, x: Polynomial, base: dict[str, str]) -> Jet:
    """The same by derivatives in the ring, then substitution."""
    images = {ring.index("velocity", "x"): ring.zero}
    for name, text in base.items():
        images[ring.index("coordinate", name)] = lower(ring, text)
        if name in ring.angles:
            half = Operation("/", parsed(text), number(ring.angles[name]))
            images[ring.index("sine", name)], images[ring.index("cosine", name)] = lowering(ring).angle(half)

    def slope(y: Polynomial, name: str) -> Polynomial:
        return ring.velocity_derivative(y, "x") if name == "x_dot" else ring.derivative(y, name)

    first = [slope(x, name) for name in NAMES]
    halves = {(i, j): Fraction(1, 2) if i == j else Fraction(1) for i in range(3) for j in range(i, 3)}
    second = {(i, j): ring.number(half) * slope(first[i], NAMES[j]) for (i, j), half in halves.items()}
    return Jet(
        ring.substitute(x, images),
        {(i,): ring.substitute(y, images) for i, y in enumerate(first)},
        {key: ring.substitute(y, images) for key, y in second.items()},
    )


def assert_equal(ring: Ring, a: Jet, b: Jet) -> None:
    pairs = [(a.value, b.value)]
    pairs += [(a.first.get(i, ring.zero), b.first.get(i, ring.zero)) for i in range(3)]
    pairs += [(a.second.get((i, j), ring.zero), b.second.get((i, j), ring.zero)) for i in range(3) for j in range(i, 3)]
    for x, y in pairs:
        assert ring.is_zero(x - y) is True, f"{x} against {y}"


def _positive(inner: Expression) -> Expression:
    return Operation("+", Operation("**", inner, number(2)), number(1))


leaves = st.one_of(
    st.sampled_from([Name(name) for name in ("x", "y", "x_dot", "l", "w")]),
    st.builds(number, st.builds(Fraction, st.integers(-3, 3), st.integers(1, 3))),
    st.builds(Call, st.sampled_from(["sin", "cos"]), st.sampled_from([*angles, *own_angles]).map(parsed)),
    st.sampled_from(["1/(1 + x**2)", "1/(l + y)", "sqrt(1 + x)", "sqrt(l + y**2)", "exp(x*w)", "1/(2 + cos(x))"]).map(
        parsed
    ),
)
expressions = st.recursive(
    leaves,
    lambda inner: st.one_of(
        st.builds(Operation, st.sampled_from(["+", "-", "*"]), inner, inner),
        st.builds(Negative, inner),
        st.builds(Operation, st.just("**"), inner, st.integers(0, 3).map(number)),
    ),
    max_leaves=5,
)
bases = st.sampled_from([{}, {"x": "0", "y": "0"}, {"x": "pi/2", "y": "l"}, {"x": "2*chi", "y": "w**2"}, {"y": "0"}])


@settings(max_examples=80, derandomize=True)
@given(expressions, bases)
def test_jets_are_taylor_polynomials(expression: Expression, base: dict[str, str]) -> None:
    ring = new_ring()
    assert_equal(ring, expanded(ring, expression, base), taylor(ring, lowering(ring)(expression), base))


@pytest.mark.parametrize(
    "text",
    [
        "sin(x)",
        "cos(2*x - chi)",
        "sin(x/2)**2",
        "sin(l*x)*y",
        "cos(x + 1)",
        "tan(x)",
        "1/(l + x*y)",
        "1/(1 + x**2)**2",
        "sqrt(l + x)",
        "sqrt(l**2 + x**2 + y**2)",
        "1/sqrt(l**2 + x*y)",
        "exp(x - y)",
        "log(l + x)",
        "atan(x*y + w)",
        "sinh(x)",
        "cosh(l*x)",
        "tanh(x)",
        "(l + x)**(3/2)",
        "x_dot**2*cos(x) + x_dot*y*l",
    ],
)
@pytest.mark.parametrize("base", [{}, {"x": "0", "y": "w"}], ids=["anywhere", "at zero"])
def test_each_function_is_expanded_to_second_order(text: str, base: dict[str, str]) -> None:
    ring = new_ring()
    assert_equal(ring, expanded(ring, parsed(text), base), taylor(ring, lower(ring, text), base))


def test_third_order_is_dropped() -> None:
    ring = new_ring()
    jet = expanded(ring, parsed("x**3 + x*y*x_dot + x**2*y**2"), {"x": "0", "y": "0"})
    assert Jets(ring, {}, {}, {}).vanishes(jet)


@pytest.mark.parametrize("value", ["0.5", "l*w", "chi + 1"])
def test_an_angle_may_rest_anywhere(value: str) -> None:
    ring = new_ring()
    assert_equal(
        ring, expanded(ring, parsed("sin(x)"), {"x": value}), taylor(ring, lower(ring, "sin(x)"), {"x": value})
    )


@pytest.mark.parametrize(
    "text",
    [
        *("sin(x)*cos(2*x - chi)*y", "1/(l + x)", "sqrt(l**2 + x**2 + y)", "exp(x - y)", "log(l + x)", "atan(x + w)"),
        *("tanh(x + y)", "(l + x)**(3/2)", "x_dot**2*x**2 + y*x_dot*cos(x)", "x**5 + x**3*y**2"),
    ],
)
def test_jets_of_higher_order_have_all_derivatives(text: str) -> None:
    """Every coefficient up to x^a y^b with a + b = 4 is a derivative at the point, divided by a! b!."""
    ring = new_ring()
    found = expanded(ring, parsed(text), {"x": "0", "y": "w"}, 4)
    at = taylor(ring, lower(ring, text), {"x": "0", "y": "w"})
    assert_equal(ring, found, at)
    for key in combinations_with_replacement(range(3), 4):
        slope, divided = lower(ring, text), Fraction(1)
        for place, i in enumerate(key):
            name = NAMES[i]
            slope = ring.velocity_derivative(slope, "x") if name == "x_dot" else ring.derivative(slope, name)
            divided /= key[: place + 1].count(i)
        expected = taylor(ring, slope, {"x": "0", "y": "w"}).value * ring.number(divided)
        assert ring.is_zero(found.degree(4).get(key, ring.zero) - expected) is True, key


def test_terms_beyond_the_order_are_dropped() -> None:
    found = expanded(new_ring(), parsed("x**5 + x**3*y + (x + y)**7"), {"x": "0", "y": "0"}, 4)
    assert [len(part) for part in found.parts] == [0, 0, 0, 1]
