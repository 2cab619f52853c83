"""Derivatives of straight-line programs: against the ring's, against Taylor series, in both directions."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import WITH_BODIES
from flint import arb, arb_series, ctx, fmpq
from hypothesis import assume, given
from hypothesis import strategies as st
from properties import settings
from random_systems import Description, analysed, orbiting, systems

import mbsym
from mbsym.algebra import derivative
from mbsym.algebra.base import Algebra
from mbsym.algebra.derivative import gradient, jacobian
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Node, Program
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.tree import SMOOTH
from mbsym.mechanics.programs import forward_dynamics, momenta, momentum_rates
from mbsym.mechanics.states import rational_states
from mbsym.model.system import velocity_name

SHIPPED = WITH_BODIES
#: Those whose accelerations are M^-1 f.
FREE = [path for path in SHIPPED if "\nconstraints:" not in path.read_text(encoding="utf-8")]


class Duals(Algebra):
    """a + b e with e^2 = 0 over balls: derivatives by flint's power series, not by our rules."""

    def __init__(self, angles: dict[str, arb_series]) -> None:
        self.angles = angles
        self.zero, self.one = arb_series([0], 2), arb_series([1], 2)

    def number(self, value: Fraction | int) -> arb_series:
        value = Fraction(value)
        return arb_series([arb(fmpq(value.numerator, value.denominator))], 2)

    def sin_cos(self, angle: LinearForm) -> tuple[arb_series, arb_series]:
        total = arb_series([arb.pi() * self.number(angle.turns)[0]], 2)
        for name, coefficient in angle.coefficients:
            total = total + self.number(coefficient) * self.angles[name]
        return total.sin(), total.cos()

    def sin_cos_of(self, argument: Any) -> tuple[Any, Any]:
        return argument.sin(), argument.cos()

    def reciprocal(self, x: Any) -> Any:
        return self.one / x

    def square_root(self, x: Any) -> Any:
        return x.sqrt()

    def function(self, name: str, x: Any) -> Any:
        if name in ("sinh", "cosh", "tanh"):
            up, down = x.exp(), (-x).exp()
            sinh, cosh = (up - down) / 2, (up + down) / 2
            return {"sinh": sinh, "cosh": cosh}.get(name) or sinh / cosh
        if name in ("abs", "sign"):  # the sign of what is not 0 is constant nearby
            sign = arb_series([x[0].sgn()], 2)
            return sign * x if name == "abs" else sign
        return getattr(x, name)()


def slopes(program: Program, nodes: list[Node], values: dict[str, fmpq], name: str) -> list[arb]:
    """d nodes / d name by power series."""
    series = {key: arb_series([value, key == name], 2) for key, value in values.items()}
    return [x[1] for x in program.evaluate(nodes, series, Duals(series))]


# --- operations ---

Made = Callable[[Program, Node, Node], Node]
OPERATIONS: dict[str, Made] = {
    "add": lambda p, a, b: a + b,
    "subtract": lambda p, a, b: a - b,
    "multiply": lambda p, a, b: a * b,
    "square": lambda p, a, b: a * a,
    "negative": lambda p, a, b: -a,
    "divide": lambda p, a, b: p.divide(a, b),
    "reciprocal": lambda p, a, b: p.reciprocal(a),
    "divide by itself squared": lambda p, a, b: p.divide(a, a * a + b),
    "sqrt": lambda p, a, b: p.square_root(a + b),
    "sin": lambda p, a, b: p.sin_cos_of(a * b)[0],
    "cos": lambda p, a, b: p.sin_cos_of(a - b)[1],
    "angle": lambda p, a, b: p.sin_cos(LinearForm((("a", Fraction(-2)), ("b", Fraction(1))), Fraction(1, 3)))[0],
    **{
        name: lambda p, a, b, name=name: p.function(name, a * b)
        for name in (*SMOOTH, "abs", "sign")
        if name not in ("sin", "cos", "tan", "sqrt")
    },
}


@pytest.mark.parametrize("name", OPERATIONS)
def test_every_operation(name: str) -> None:
    program = Program()
    a, b = program.input("a"), program.input("b")
    node = OPERATIONS[name](program, a, b) * (a + program.number(3))
    values = {"a": fmpq(7, 5), "b": fmpq(3, 4), "pi": fmpq(22, 7)}
    rows = [gradient(program, node, [a, b]), *jacobian(program, [node], [a, b])]
    with ctx.workprec(200):
        balls: dict[str, Any] = {key: arb(value) for key, value in values.items()} | {"pi": arb.pi()}
        expected = [slopes(program, [node], values, key)[0] for key in "ab"]
        for row in rows:
            for x, wanted in zip(program.evaluate(row, balls, Balls(balls)), expected, strict=True):
                assert x.overlaps(wanted)
                assert (x - wanted).rad() < 1e-40


def test_an_unknown_operation_is_refused() -> None:
    program = Program()
    a = program.input("a")
    with pytest.raises(ValueError, match="no derivative is known for gamma"):
        gradient(program, program.function("gamma", a), [a])


# --- shape and cost ---


def test_inputs_that_do_not_matter_have_zero_derivatives() -> None:
    program = Program()
    a, b, c = (program.input(name) for name in "abc")
    assert gradient(program, a * a, [b, c]) == (program.zero, program.zero)
    assert gradient(program, program.number(3), [a]) == (program.zero,)
    assert gradient(program, a, [a, b]) == (program.one, program.zero)
    assert jacobian(program, [a * b, c], [c, a]) == ((program.zero, b), (program.one, program.zero))
    assert jacobian(program, [], [a]) == ()


def test_a_value_in_between_can_be_an_input() -> None:
    """d (u^2 + a) / d (u, a) with u = a b taken as independent."""
    program = Program()
    a, b = program.input("a"), program.input("b")
    u = a * b
    assert gradient(program, u * u + a, [u, a]) == (u + u, program.one)


def test_one_sweep_backwards_costs_a_few_times_the_function() -> None:
    """The cheap gradient principle: at most 5 operations for one, whatever the number of inputs."""
    program = Program()
    inputs = [program.input(f"x{k}") for k in range(40)]
    product = program.one
    for x in inputs:
        product = product * program.sin_cos_of(x)[0] + x
    before = program.operations([product])
    assert program.operations([product, *gradient(program, product, inputs)]) <= 5 * before


def chain_of_squares(program: Program, start: list[Node]) -> Node:
    node = program.zero
    for _ in range(20):
        for x in start:
            node = node * x + x * x
    return node


@pytest.mark.parametrize("wide", [True, False])
def test_the_cheaper_direction_is_taken(wide: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Many inputs and one output go backwards, one input and many outputs forwards; both agree."""
    program = Program()
    inputs = [program.input(f"x{k}") for k in range(12 if wide else 1)]
    last = chain_of_squares(program, inputs)
    outputs = [last] if wide else [last * program.number(k) + last * last for k in range(2, 14)]
    sweeps = derivative._Sweeps(program, outputs, inputs)
    forwards, backwards = sweeps.costs()
    assert (backwards < forwards) == wide
    found = jacobian(program, outputs, inputs)
    by_rows = tuple(sweeps.backwards(i) for i in range(len(outputs)))
    columns = [sweeps.forwards(j) for j in range(len(inputs))]
    by_columns = tuple(zip(*columns, strict=True))
    assert found == (by_rows if wide else by_columns)
    values = {f"x{k}": fmpq(k + 1, 1000) for k in range(12)}
    exact = Rationals({}, {})
    flat = [[x for row in rows for x in row] for rows in (by_rows, by_columns)]
    assert program.evaluate(flat[0], values, exact) == program.evaluate(flat[1], values, exact)
    nodes = [program.operations([*outputs, *x]) for x in flat]
    assert (nodes[0] < nodes[1]) == wide


# --- mechanics ---


@settings(max_examples=25, derandomize=True)
@given(st.one_of(systems(), orbiting()))
def test_derivatives_of_the_lagrangian_are_those_of_the_ring(description: Description) -> None:
    analysis = analysed(description, (1, 2, 3))
    assume(analysis.system.coordinates)
    ring, found = analysis.ring, analysis.programs
    lagrangian = analysis.energy.kinetic_energy.polynomial + analysis.energy.force_function.polynomial
    names = analysis.system.coordinates
    by_velocity = [ring.velocity_derivative(lagrangian, name) for name in names]
    by_position = [ring.derivative(lagrangian, name) for name in names]
    nodes = [*momenta(found, analysis.system), *momentum_rates(found, analysis.system)]
    # Plain q, sin q and cos q are independent at a rational state, and so they are in both derivatives.
    for state in rational_states(analysis.system, ring, 1):
        carry = Carrier(ring, state.numbers, state.values)
        values = found.program.evaluate(nodes, state.values, state.numbers)
        assert values == [carry(x) for x in (*by_velocity, *by_position)]


@pytest.mark.parametrize("path", FREE, ids=lambda path: path.stem)
def test_the_jacobian_of_the_accelerations(path: Path) -> None:
    """Against power series through the same program, which know nothing of the rules of differentiation."""
    analysis = mbsym.load(path)
    dynamics = forward_dynamics(analysis.system, analysis.ring)
    program, names = dynamics.program, analysis.system.coordinates
    states = [*names, *(velocity_name(name) for name in names)]
    rows = jacobian(program, dynamics.accelerations, [dynamics.environment[name] for name in states])
    with ctx.workprec(300):
        values = {name: fmpq(11 + 7 * k % 13, 10 + k) for k, name in enumerate(dynamics.environment)}
        balls: dict[str, Any] = {name: arb(value) for name, value in values.items()}
        columns = [slopes(program, list(dynamics.accelerations), values, name) for name in states]
        flat = program.evaluate([x for row in rows for x in row], balls, Balls(balls))
        expected = [column[i] for i in range(len(names)) for column in columns]
        for x, wanted in zip(flat, expected, strict=True):
            assert (x - wanted).contains(0)
            assert (x - wanted).rad() < 1e-30 * (1 + abs(wanted))


def test_a_planted_error_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the sign of one rule reversed, the comparison with power series fails."""
    right = derivative._Sweeps._local

    def wrong(self: derivative._Sweeps, number: int) -> Any:
        factors = right(self, number)
        if self.program.instructions[number].operation != "cos":
            return factors
        return tuple((node, not minus) for node, minus in factors)

    monkeypatch.setattr(derivative._Sweeps, "_local", wrong)
    with pytest.raises(AssertionError):
        test_the_jacobian_of_the_accelerations(SHIPPED[0].with_name("double-pendulum.yaml"))
    test_every_operation("exp")
    with pytest.raises(AssertionError):
        test_every_operation("cos")
