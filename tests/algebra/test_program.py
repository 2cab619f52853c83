"""Straight-line programs: equal nodes are one, constants fold, signs move out, dead code goes, values stay exact."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import Any

import pytest
from flint import arb, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from random_systems import Description, analysed, orbiting, state, systems

from mbsym.algebra.base import Algebra
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Program
from mbsym.expressions.angles import LinearForm
from mbsym.mechanics.energy import gyrostatic_term
from mbsym.mechanics.states import ball_states, rational_states


class Floats(Algebra):
    """Plain floating-point numbers: the third algebra a program must run over."""

    zero, one = 0.0, 1.0

    def __init__(self, angles: dict[str, float]) -> None:
        self.angles = angles

    def number(self, value: Fraction | int) -> float:
        return float(value)

    def sin_cos(self, angle: LinearForm) -> tuple[float, float]:
        total = float(angle.turns) * math.pi + sum(float(c) * self.angles[name] for name, c in angle.coefficients)
        return math.sin(total), math.cos(total)

    def sin_cos_of(self, argument: Any) -> tuple[float, float]:
        return math.sin(argument), math.cos(argument)

    def reciprocal(self, x: Any) -> float:
        return 1.0 / x

    def square_root(self, x: Any) -> float:
        return math.sqrt(x)

    def function(self, name: str, x: Any) -> float:
        return float(getattr(math, name)(x))


@pytest.fixture
def program() -> Program:
    return Program()


def angle(name: str, coefficient: Fraction | int = 1, turns: Fraction | int = 0) -> LinearForm:
    return LinearForm(((name, Fraction(coefficient)),), Fraction(turns))


# --- building ---


def test_equal_nodes_are_one_node(program: Program) -> None:
    a, b = program.input("a"), program.input("b")
    assert program.input("a") == a
    assert a + b == b + a
    assert a * b == b * a
    assert program.times(a, b) == a * b
    assert program.sin_cos(angle("a")) == program.sin_cos(angle("a"))
    before = len(program.instructions)
    assert (a + b) * (b + a) == (a + b) * (a + b)
    assert len(program.instructions) == before + 2 - 1  # a + b was there


def test_constants_fold(program: Program) -> None:
    a, three = program.input("a"), program.number(3)
    assert three + program.number(4) == program.number(7)
    assert three * program.number(Fraction(1, 3)) == program.one
    assert -three == program.number(-3)
    assert a + program.zero == a
    assert a * program.one == a
    assert program.vanishes(a * program.zero)
    assert program.vanishes(a - a)
    assert program.divide(a, program.number(4)) == a * program.number(Fraction(1, 4))
    assert program.square_root(program.number(Fraction(9, 4))) == program.number(Fraction(3, 2))
    assert program.sin_cos(LinearForm(turns=Fraction(3, 2))) == (program.number(-1), program.zero)
    with pytest.raises(SingularPoint):
        program.reciprocal(program.zero)


def test_signs_move_outwards(program: Program) -> None:
    a, b = program.input("a"), program.input("b")
    assert a * -b == -(a * b)
    assert -a * -b == a * b
    assert program.minus(-a) == a
    assert -a + b == b - a
    assert -a + -b == -(a + b)
    assert -(a - b) == b - a
    assert a * program.number(-2) == -(a * program.number(2))
    assert a - (-b) == a + b
    sine, cosine = program.sin_cos(angle("a"))
    assert program.sin_cos(angle("a", -1)) == (-sine, cosine)


def test_a_product_with_a_reciprocal_is_one_division(program: Program) -> None:
    a, b = program.input("a"), program.input("b")
    quotient = program.times(program.reciprocal(b), a)
    assert quotient == program.divide(a, b)
    assert program.operations([quotient]) == 1


def test_only_what_the_outputs_need_is_live(program: Program) -> None:
    a, b = program.input("a"), program.input("b")
    wanted, idle = a * a + b, program.sin_cos(angle("b"))[0] * a
    live = {program.instructions[number].operation for number in program.live([wanted])}
    assert live == {"input", "multiply", "add"}
    assert program.operations([wanted]) == 2
    assert program.operations([idle]) == 2
    assert program.operations([wanted, idle]) == 4
    assert program.operations([a, program.one]) == 0
    assert program.live([]) == []


# --- random programs against the same operations on numbers ---

Steps = list[tuple[str, int, int]]
steps = st.lists(
    st.tuples(
        st.sampled_from(["+", "-", "*", "/", "neg", "half", "sin", "zero"]), st.integers(0, 9), st.integers(0, 9)
    ),
    max_size=14,
)


def run(algebra: Algebra, inputs: list[Any], script: Steps) -> list[Any]:
    """The script's values over an algebra, starting from inputs a, b, c (a is an angle too)."""
    values = list(inputs)
    for operation, i, j in script:
        x, y = values[i % len(values)], values[j % len(values)]
        match operation:
            case "+":
                values.append(x + y)
            case "-":
                values.append(x - y)
            case "*":
                values.append(algebra.times(x, y))
            case "/":
                values.append(algebra.times(x, algebra.reciprocal(algebra.times(y, y) + algebra.one)))
            case "neg":
                values.append(-x)
            case "half":
                values.append(algebra.times(algebra.number(Fraction(i - 4, 2)), x))
            case "sin":
                values.append(algebra.sin_cos(angle("a", i - 4 or 5, Fraction(j, 2)))[j % 2])
            case "zero":
                values.append(x - x)
    return values


@settings(max_examples=200, derandomize=True)
@given(steps, st.lists(st.integers(-9, 9), min_size=4, max_size=4))
def test_a_program_has_the_values_of_what_it_recorded(script: Steps, numbers: list[int]) -> None:
    program = Program()
    recorded = run(program, [program.input(name) for name in "abc"], script)
    inputs = {name: fmpq(value, 4) for name, value in zip("abc", numbers, strict=False)} | {"pi": fmpq(22, 7)}
    exact = Rationals({"a": fmpq(numbers[3], 5)}, {"a": 1})
    assert program.evaluate(recorded, inputs, exact) == run(exact, [inputs[name] for name in "abc"], script)


@settings(max_examples=50, derandomize=True)
@given(steps, st.lists(st.integers(-9, 9), min_size=3, max_size=3))
def test_floats_lie_where_balls_say(script: Steps, numbers: list[int]) -> None:
    program = Program()
    recorded = run(program, [program.input(name) for name in "abc"], script)
    plain = {name: value / 4 for name, value in zip("abc", numbers, strict=True)} | {"pi": math.pi}
    balls: dict[str, Any] = {name: arb(value) for name, value in plain.items()} | {"pi": arb.pi()}
    floats = program.evaluate(recorded, plain, Floats(plain))
    enclosures = program.evaluate(recorded, balls, Balls(balls))
    for x, ball in zip(floats, enclosures, strict=True):
        assert abs(x - float(ball.mid())) <= 1e-9 * (1 + abs(x))


# --- programs of systems ---


@settings(max_examples=20, derandomize=True)
@given(st.one_of(systems(), orbiting()))
def test_programs_of_systems_equal_the_closed_equations(description: Description) -> None:
    analysis = analysed(description)
    found, closed = analysis.programs, analysis.equations
    kinetic = analysis.energy.kinetic_energy.polynomial - gyrostatic_term(analysis.scene)  # no energy contains it
    formulas = [x.polynomial for row in closed.mass_matrix for x in row]
    formulas += [*(x.polynomial for x in closed.forcing), kinetic - analysis.energy.force_function.polynomial]
    nodes = [*(x for row in found.mass_matrix for x in row), *found.forcing, found.energy]
    exact = [state(analysis), *rational_states(analysis.system, analysis.ring, 1)]
    for here in exact:
        carry = Carrier(analysis.ring, here.numbers, here.values)
        assert found.program.evaluate(nodes, here.values, here.numbers) == [carry(x) for x in formulas]
    for here in ball_states(analysis.system, analysis.ring, 1):
        values = found.program.evaluate(nodes, here.values, Balls(here.values))  # sin q is that of q here
        plain = {name: float(arb(value).mid()) for name, value in here.values.items()}
        floats = found.program.evaluate(nodes, plain, Floats(plain))
        scale = 1 + max(abs(float(value.mid())) for value in values)
        for x, ball, formula in zip(floats, values, formulas, strict=True):
            assert ball.overlaps(analysis.ring.evaluate(formula, here.values))
            assert abs(x - float(ball.mid())) <= 1e-10 * scale
