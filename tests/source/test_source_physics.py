"""What a body can be (inertias, masses) and whether an expression is identically zero."""

from __future__ import annotations

from fractions import Fraction

import pytest
from conftest import parsed
from hypothesis import given
from hypothesis import strategies as st
from properties import settings

import mbsym
from mbsym.expressions.tree import sign_by_structure
from mbsym.model.admissibility import (
    NumberTensor,
    about_mass_centre,
    impossible_alone,
    inertia_violation,
    number_of,
    second_moments,
)
from mbsym.source import read
from mbsym.source.identity import vanishes

coordinates = st.integers(-9, 9).map(Fraction)
points = st.tuples(coordinates, coordinates, coordinates)
clouds = st.lists(st.tuples(st.integers(1, 9).map(Fraction), points), min_size=1, max_size=6)


def inertia_of(cloud: list[tuple[Fraction, tuple[Fraction, Fraction, Fraction]]]) -> NumberTensor:
    """J = sum m (r.r 1 - r r^T), straight from the definition."""

    def entry(row: int, column: int) -> Fraction:
        return sum(
            (mass * ((sum(x * x for x in r) if row == column else 0) - r[row] * r[column]) for mass, r in cloud),
            Fraction(0),
        )

    first, second, third = ((entry(row, 0), entry(row, 1), entry(row, 2)) for row in range(3))
    return first, second, third


@settings(max_examples=100)
@given(clouds)
def test_point_masses_are_admissible_about_any_point(cloud: list) -> None:
    mass = sum((one for one, _ in cloud), Fraction(0))
    centre = tuple(sum((one * r[axis] for one, r in cloud), Fraction(0)) / mass for axis in range(3))
    tensor = inertia_of(cloud)
    moved = [(one, tuple(r[axis] - centre[axis] for axis in range(3))) for one, r in cloud]
    assert inertia_violation(tensor) is None
    assert about_mass_centre(tensor, mass, centre) == inertia_of(moved)
    assert inertia_violation(about_mass_centre(tensor, mass, centre)) is None


@settings(max_examples=50)
@given(clouds)
def test_a_little_less_than_nothing_is_not_admissible(cloud: list) -> None:
    """Second moments with a negative eigenvalue belong to no body: here all masses count as negative."""
    tensor = inertia_of([(-mass, r) for mass, r in cloud])
    if any(any(row) for row in tensor):
        assert inertia_violation(tensor) is not None


@pytest.mark.parametrize(
    ("moments", "axis"),
    [("0 0 J", 2), ("J**2*m 0 0", 0), ("0 v 0", 1), ("0 x 0", None), ("0 J J", None), ("0 0 0", None), ("0 0 n", None)],
)
def test_a_single_positive_moment_belongs_to_no_body(moments: str, axis: int | None) -> None:
    zero = parsed("0")
    first, second, third = map(parsed, moments.split())
    tensor = ((first, zero, zero), (zero, second, zero), (zero, zero, third))
    signs = {"J": "positive", "m": "positive", "x": "real", "n": "nonnegative"}
    assert impossible_alone(tensor, signs, {"v": Fraction(2)}) == axis


def test_second_moments_of_a_rod() -> None:
    rod = ((Fraction(1), Fraction(0), Fraction(0)), (Fraction(0),) * 3, (Fraction(0), Fraction(0), Fraction(1)))
    assert [second_moments(rod)[axis][axis] for axis in range(3)] == [0, 1, 0]
    assert inertia_violation(rod) is None


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("a*b + 1", 7),
        ("a**-1", Fraction(1, 2)),
        ("a/(b - 3)", None),
        ("sqrt(a)", None),
        ("c", None),
        ("a**(1/2)", None),
    ],
)
def test_numbers_where_there_are_numbers(text: str, value: Fraction | None) -> None:
    assert number_of(parsed(text), {"a": Fraction(2), "b": Fraction(3)}) == value


@pytest.mark.parametrize(
    ("text", "negative"),
    [("-m", True), ("-m*l**2", True), ("n", True), ("n*n", False), ("-m - l", True), ("l - m", False), ("n**3", True)],
)
def test_signs_that_declarations_force(text: str, negative: bool) -> None:
    signs = {"m": "positive", "l": "positive", "n": "negative"}
    assert (sign_by_structure(parsed(text), signs) == "negative") is negative


@pytest.mark.parametrize(
    "text",
    [
        "sin(x)**2 + cos(x)**2 - 1",
        "sin(2*x) - 2*sin(x)*cos(x)",
        "cos(x - y/3) - cos(x)*cos(y/3) - sin(x)*sin(y/3)",
        "sin(x + pi/2) - cos(x)",
        "cos(3*x/2) - 4*cos(x/2)**3 + 3*cos(x/2)",
        "(a + b)**3 - a**3 - 3*a**2*b - 3*a*b**2 - b**3",
        "1/(a - b) - (a + b)/(a**2 - b**2)",
        "tan(x) - sin(x)/cos(x)",
        "sqrt(a)**2 - a",
        "exp(a + b) - exp(a)*exp(b)",
        "sin(a*b)**2 + cos(a*b)**2 - 1",
        "sinh(a)**2 - cosh(a)**2 + 1",
    ],
)
def test_identities_hold_and_their_neighbours_do_not(text: str) -> None:
    assert vanishes(parsed(text)) is True
    assert vanishes(parsed(f"{text} + a/1000")) is False


def test_identities_modulo_relations() -> None:
    relations = {"nu": parsed("omega**2*R**3"), "k": parsed("nu/R**3")}
    assert vanishes(parsed("k - omega**2"), relations) is True
    assert vanishes(parsed("k - omega"), relations) is False


def test_relations_are_followed_in_any_order() -> None:
    relations = {"a": parsed("b + c"), "b": parsed("c**2"), "c": parsed("d - 1"), "z": parsed("a*b")}
    assert vanishes(parsed("z - a*c**2 + 0*b"), relations) is True
    assert (
        vanishes(parsed("a + b + c + z - 2*(d - 1)**2 - 2*(d - 1) - ((d - 1)**2 + d - 1)*(d - 1)**2"), relations)
        is True
    )
    assert vanishes(parsed("a - b"), relations) is False


def test_what_cannot_be_evaluated_is_not_judged() -> None:
    assert vanishes(parsed("log(-1 - a**2)")) is None


@pytest.mark.parametrize(("velocity", "good"), [("v + x_dot*cos(x)", True), ("x_dot*cos(x)", False), ("v", False)])
def test_relative_velocities_follow_prescribed_rates(velocity: str, good: bool) -> None:
    text = f"""mbsym: 1
name: velocity
parameters: [v, w]
prescribed: {{s: w}}
bodies:
  - name: a
    mass: 1
    connection point: [sin(x) + s, 0, 0]
    relative velocity: [{velocity}, 0, 0]
    coordinates: [x]
relations: {{w: v}}
"""
    system, complaints = read(text, "x.yaml")
    assert (system is not None) is good
    assert [item.code for item in complaints] == ([] if good else ["relative-velocity"])


@pytest.mark.parametrize("number", ["pi/6", "sqrt(2)", "-30*pi/180"])
def test_a_parameter_may_be_any_number(number: str) -> None:
    """What stands alone is what {value: ...} says; only a rational number says its own sign."""
    template = """
mbsym: 1
name: incline
parameters: {{m: positive, g: positive, slope: {slope}}}
bodies:
  - {{name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}
loads:
  - uniform gravity: {{acceleration: g, direction: [sin(slope), -cos(slope), 0]}}
"""
    short, long = (mbsym.loads(template.format(slope=slope)).system for slope in (number, f"{{value: {number}}}"))
    assert short == long
    assert next(one for one in short.parameters if one.name == "slope").value is not None


@pytest.mark.parametrize(("value", "code"), [("2", None), ("2.0001", "rounded-value"), ("3", "conflicting-values")])
def test_a_value_is_held_against_a_relation_with_a_root(value: str, code: str | None) -> None:
    """n = sqrt(mu/R**3) = 2 for mu = 4 and R = 1."""
    text = f"""
mbsym: 1
name: relation
parameters: {{m: 1, mu: 4, R: 1, n: {{value: {value}}}}}
bodies:
  - {{name: p, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}}
loads:
  - spring: {{coordinate: x, stiffness: m*n**2}}
relations: {{n: sqrt(mu/R**3)}}
"""
    _, complaints = read(text, "x.yaml")
    assert [one.code for one in complaints.items] == ([] if code is None else [code])


BLOCK = "bodies:\n  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}\n"


@pytest.mark.parametrize(
    ("sign", "good", "bad"),
    [
        ("positive", "1", "0"), ("nonnegative", "0", "-1"), ("negative", "-1", "0"),
        ("nonpositive", "0", "1"), ("nonpositive", "-1", "1/2"), ("nonzero", "-1", "0"),
    ],
)  # fmt: skip
def test_declared_signs_and_values(sign: str, good: str, bad: str) -> None:
    def codes(number: str) -> list[str]:
        text = f"mbsym: 1\nname: x\nparameters: {{m: 1, k: {{sign: {sign}, value: {number}}}}}\n{BLOCK}"
        return [item.code for item in read(text, "x.yaml")[1] if item.code != "unused-name"]

    assert (codes(good), codes(bad)) == ([], ["sign-contradiction"])


def test_zero_has_no_sign_and_a_value_may_be_said_twice() -> None:
    for zero in ("0", "{value: 0}"):
        a = mbsym.loads(f"mbsym: 1\nname: x\nparameters: {{m: 1, k: {zero}}}\n{BLOCK}")
        assert [p.sign for p in a.system.parameters] == ["positive", "real"]
    for value, codes in (("1", []), ("2", ["conflicting-values"])):
        text = f"mbsym: 1\nname: x\nparameters: {{m: 1}}\n{BLOCK}values: {{m: {value}}}\n"
        assert [item.code for item in read(text, "x.yaml")[1]] == codes


@pytest.mark.parametrize(
    ("frame", "axes", "angles", "enough"),
    [
        (3, "3", "w", True),
        (1, "3", "w", False),  # a prescribed turn about another axis
        (3, "1, 3", "pi/6, w", False),  # tilted on a drum that turns
        (None, "1, 3", "pi/6, w", True),  # an inclined axis at rest
        (None, "3, 1", "w, pi/6", False),  # inclined to the axis it turns about
    ],
)
def test_where_a_single_moment_is_enough(frame: int | None, axes: str, angles: str, enough: bool) -> None:
    turning = f"rotation: {{axes: [{frame}], angles: [chi]}}"
    drum = "" if frame is None else f"  - {{name: drum, attached to: 0, mass: 0, {turning}}}\n"
    text = f"""mbsym: 1
name: x
parameters: {{omega: positive}}
{"prescribed: {chi: omega}" if drum else ""}
bodies:
{drum}  - name: wheel
    attached to: {"drum" if drum else 0}
    mass: 2
    rotation: {{axes: [{axes}], angles: [{angles}]}}
    mass centre: [3, 0, 0]
    inertia about: joint
    inertia: [0, 0, 18]
"""
    codes = [item.code for item in read(text, "x.yaml")[1] if item.code != "unused-name"]
    assert codes == ([] if enough else ["single-moment"])


def test_roots_of_squares_are_not_told_from_either_sign() -> None:
    """sqrt((a - b)^2) is b - a where a < b, sqrt(n^2) is -n for n < 0: no refusal, but of what is neither of them."""
    assert vanishes(parsed("sqrt((a - b)**2) - b + a")) is None
    assert vanishes(parsed("sqrt(n**2) + n")) is None
    assert vanishes(parsed("sqrt((a - b)**2) - b + 2*a")) is False
    assert vanishes(parsed("sqrt(a**2 + b**2) - a - b")) is False
