"""What decides on a border hangs on the motion, not on its coordinates: verdicts derived by hand.

A coordinate may be told by a relation in place of a formula, once or twice, by either side, and squares of rates may
be written out; dissipation acts on a minimum of higher order as on any other.
"""

from __future__ import annotations

from fractions import Fraction

import pytest

import mbsym
from mbsym.analysis.judge import Judge
from mbsym.problems.stability.word import Word

#: Loads of a unit mass at x, and what is true of x = 0.
ON_A_LINE = {
    # x'' + x = x'^3: d(x'^2 + x^2)/dt = 2 x'^4
    "growing": ("potential: X**2/2", "rayleigh: -X_dot**4/4", Word.UNSTABLE),
    # x'' + x' + x^3 = 0: d(x'^2/2 + x^4/4)/dt = -x'^2, and nothing but x = 0 rests
    "quartic": ("potential: X**4/4", "rayleigh: X_dot**2/2", Word.ASYMPTOTIC),
    # x'' + x' = x^3: it has left with x' > 0
    "hilltop": ("potential: -X**4/4", "rayleigh: X_dot**2/2", Word.UNSTABLE),
    # x'' + x' + x^2 = 0: x^3/3 has no minimum
    "cubic": ("potential: X**3/3", "rayleigh: X_dot**2/2", Word.UNSTABLE),
    # x'' + x^5 = 0
    "sextic": ("potential: X**6/6", "rayleigh: 0*X_dot", Word.STABLE),
}
RELATIONS = {
    "x": ("x", ""),
    "s = x": ("x", "constraints: [relation: s = x]"),
    "x by s": ("s", "constraints: [relation: 2*s = 2*x]\ndependent: [x]"),
    "parameter": ("s", "constraints: [relation: m*x = m*s]"),
    "curved": ("x", "constraints: [relation: s = x + x**3]"),
    "twice": ("s", "constraints: [relation: s = x, relation: 2*(s - x) = 0]"),
}


def described(potential: str, rayleigh: str, relation: str, loads: str = "") -> str:
    name, constraints = RELATIONS[relation]
    slide = "  - {name: slide, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 0}\n"
    slide = slide if constraints else ""
    return (
        "mbsym: 1\nname: on a line\nparameters: {m: positive}\nbodies:\n"
        "  - {name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}\n"
        f"{slide}loads:\n  - {potential.replace('X', name)}\n  - {rayleigh.replace('X', name)}\n{loads}{constraints}\n"
        f"motion: {{x: 0{', s: 0' if constraints else ''}}}\nvalues: {{m: 1}}\n"
    )


def word(text: str) -> Word:
    found = mbsym.loads(text, (4, 5, 6)).stability.numerical
    assert found is not None
    return found.word


@pytest.mark.parametrize("relation", RELATIONS)
@pytest.mark.parametrize("case", ON_A_LINE)
def test_a_relation_in_place_of_a_formula(case: str, relation: str) -> None:
    potential, rayleigh, wanted = ON_A_LINE[case]
    assert word(described(potential, rayleigh, relation)) is wanted


def test_loads_on_a_coordinate_that_follows() -> None:
    """s = x + x^2: spring, damper and force act on s.

    V = s^2/2 - x^2/2 - x^3 = x^4/2; the power is (1 - c) s'^2, lost for c = 2, won for c = 1/2.
    """
    loads = (
        "  - spring: {coordinate: s, stiffness: 1}\n"
        "  - damper: {coordinate: s, coefficient: 2}\n"
        "  - generalized force: {s: s_dot}\n"
    )
    text = described("potential: -x**2/2 - x**3", "rayleigh: 0*x_dot", "s = x", loads)
    text = text.replace("relation: s = x", "relation: s = x + x**2")
    assert word(text) is Word.ASYMPTOTIC
    assert word(text.replace("coefficient: 2", "coefficient: 1/2")) is Word.UNSTABLE


def test_rates_that_grow_with_a_drift_are_no_drift() -> None:
    """Two free coordinates run evenly; s = x + y^2 then runs ever faster, s = x + y evenly."""
    text = """
mbsym: 1
name: free
parameters: {m: positive}
bodies:
  - {name: p, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
  - {name: slide, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 0}
constraints: [relation: s = x + y**2]
motion: {x: 0, y: 0, s: 0}
values: {m: 1}
"""
    assert word(text).open
    assert word(text.replace("y**2", "y")) is Word.STABLE_BUT_CYCLIC


def test_the_judge_of_maps_and_sweeps_knows_it() -> None:
    """x'' + (a - b) x + x^3 = 0 beside s = x: stable at a = b, by x^4."""
    text = """
mbsym: 1
name: border
parameters: {a: positive, b: positive}
bodies:
  - {name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}
  - {name: slide, attached to: 0, connection point: [s, 0, 0], coordinates: [s], mass: 0}
loads:
  - potential: a*x**2/2 - b*s**2/2 + s**4/4
constraints: [relation: s = x]
motion: {x: 0, s: 0}
"""
    judge = Judge(mbsym.loads(text, (4, 5, 6)))
    values = [{"a": Fraction(a), "b": Fraction(2)} for a in (3, 2, 1)]
    assert [judge(at).word for at in values] == [Word.STABLE, Word.STABLE, Word.UNSTABLE]


@pytest.mark.parametrize("written", ["-x**2*x_dot", "-(x + y)**2*(x_dot + y_dot)"])
def test_friction_that_is_a_square_in_other_coordinates(written: str) -> None:
    """u = x + y or u = x: V = u^2/2 + y^4/4 with friction u^2 u': the energy never grows."""
    u = "x + y" if "y_dot" in written else "x"
    force = f"generalized force: {{x: '{written}'" + (f", y: '{written}'}}" if u != "x" else "}")
    text = f"""
mbsym: 1
name: square
bodies:
  - {{name: p, mass: 1, connection point: ['{u}', y, 0], coordinates: [x, y]}}
  - {{name: q, attached to: 0, mass: 1, connection point: ['{u} + y', 0, 0]}}
loads:
  - potential: ({u})**2/2 + y**4/4
  - {force}
motion: {{x: 0, y: 0}}
"""
    assert word(text) is Word.STABLE
    assert not word(text.replace("'-", "'")).stable
