"""Rests and steady motions that textbooks decide by an energy, by rests near by, or on a carrier that runs evenly."""

from __future__ import annotations

import pytest

import mbsym
from mbsym.analysis.resting import relative_equilibria
from mbsym.mechanics.rest import given_values
from mbsym.problems.stability.words import Word


def word(text: str) -> Word:
    found = mbsym.loads(text, (4, 5, 6)).stability.numerical
    assert found is not None
    return found.word


SKATE = """
mbsym: 1
name: skate
parameters: {k: real, c: real, d: real}
bodies:
  - {name: p, mass: 1, connection point: [x, y, 0], rotation: {axes: [3], angles: [th]}, inertia about: joint,
     inertia: [0, 0, 1], coordinates: [x, y, th]}
loads: [potential: V, rayleigh: d*(x_dot**2 + y_dot**2 + th_dot**2)/2]
constraints: [velocity: x_dot*sin(th) - y_dot*cos(th) = 0]
motion: {x: 0, y: Y, th: 0}
values: {k: 1, c: 4, d: D}
"""
WELL, HELD = "k*(x**2 + y**2)/2", "k*(x**2 + y**2)/2 + c*th**2/2"


@pytest.mark.parametrize(
    ("potential", "place", "damping", "wanted"),
    [
        # E = T + V has a strict minimum, and the edge does no work (Neimark & Fufaev, chapter V)
        (HELD, "0", "0", Word.STABLE),
        # Roots of l^2 + d l + 1 and l^2 + d l + 4; x = th = 0 are rests for every y: one zero root
        (HELD, "0", "1", Word.ASYMPTOTIC_BUT_STEADY),
        (HELD, "1", "1/2", Word.ASYMPTOTIC_BUT_STEADY),
        # th'' = 0, and x^2 + y^2 stays small
        (WELL, "0", "0", Word.STABLE_BUT_CYCLIC),
        # x cos(th) + y sin(th) = 0 are rests: two dimensions, a curved manifold; l^2 + l + 1, l + 1
        (WELL, "1", "1", Word.ASYMPTOTIC_BUT_STEADY),
        ("-k*x**2/2 + c*th**2/2 + y**2", "0", "1", Word.UNSTABLE),
    ],
)
def test_a_skate_in_a_well(potential: str, place: str, damping: str, wanted: Word) -> None:
    text = SKATE.replace("V,", f"{potential},").replace("Y", place).replace("D}", f"{damping}}}")
    assert word(text) is wanted


@pytest.mark.parametrize(("potential", "place"), [("k*(x**2 - y**2)/2 + c*th**2/2", "0"), (HELD, "1")])
def test_an_energy_without_minimum_proves_nothing(potential: str, place: str) -> None:
    """Across the edge V falls, or is not stationary: the edge holds the skate there."""
    text = SKATE.replace("V,", f"{potential},").replace("Y", place).replace("D}", "0}")
    assert word(text).open


VALLEY = """
mbsym: 1
name: valley
bodies:
  - {name: p, mass: 1, connection point: [POINT, 0], coordinates: [x, y]}
loads: [potential: V, FORCE]
motion: {x: X, y: 0}
"""
NO_FORCE, DAMPED = "rayleigh: 0*x_dot", "rayleigh: (x_dot**2 + y_dot**2)/2"


@pytest.mark.parametrize(
    ("point", "potential", "place", "force", "wanted"),
    [
        # Slow motions follow the parabola (Rubin & Ungar): y = e, T = 3/e leads to y = 1.5, however small e is
        ("x, y", "(x - y**2)**2", "0", NO_FORCE, Word.UNSTABLE),
        ("x + y**2, y", "x**2", "0", NO_FORCE, Word.UNSTABLE),
        ("y + x, y - x", "(y + x - (y - x)**2)**2", "0", NO_FORCE, Word.UNSTABLE),
        ("x, y", "(x - y**2)**2", "0", DAMPED, Word.ASYMPTOTIC_BUT_STEADY),
        ("x, y", "(x**2 + 2*y**2 - 1)**2", "1", NO_FORCE, Word.UNSTABLE),
        ("x, y", "(x**2 + y**2 - 1)**2", "1", NO_FORCE, Word.STABLE_BUT_CYCLIC),
        ("x, y", "(x - y**2)**2 + y**4", "0", NO_FORCE, Word.STABLE),
        ("x, y", "-(x - y**2)**2", "0", NO_FORCE, Word.UNSTABLE),
    ],
)
def test_a_valley_of_rests(point: str, potential: str, place: str, force: str, wanted: Word) -> None:
    text = VALLEY.replace("POINT", point).replace("V,", f"{potential},").replace("FORCE", force)
    assert word(text.replace("X", place)) is wanted


def test_gyroscopic_forces_may_hold_what_moves_along_a_valley() -> None:
    force = "generalized force: {x: 3*y_dot, y: -3*x_dot}"
    text = VALLEY.replace("POINT", "x, y").replace("V,", "(x - y**2)**2,").replace("FORCE", force)
    assert word(text.replace("X", "0")).open


SHAFT = """
mbsym: 1
name: bob on a shaft
parameters: {W: positive, g: positive}
bodies:
  - {name: shaft, attached to: 0, mass: 0, rotation: {axes: [3], angles: [p]}, inertia about: joint,
     inertia: [0, 0, 1], coordinates: [p]}
  - {name: bob, attached to: shaft, mass: 1, rotation: {axes: [1], angles: [th]}, mass centre: [0, 0, -1],
     coordinates: [th]}
loads: [uniform gravity: {vector: [0, 0, -g]}]
RUN
values: {W: 2, g: G}
"""
RUNS = {
    "prescribed": "motion: {th: 0}",
    "relation": "constraints: [relation: p = W*t]\nmotion: {p: {rate: W}, th: 0}",
    "velocity": "constraints: [velocity: 3*p_dot = 3*W]\nmotion: {p: {rate: W}, th: 0}",
}


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize(
    # th'' + sin(th) (g - W^2 cos(th)) = 0: Jacobi's integral; at g = W^2 V = W^2 th^4/8 + ...
    ("gravity", "wanted"),
    [("5", Word.STABLE), ("4", Word.STABLE), ("3", Word.UNSTABLE)],
)
def test_a_shaft_that_runs_evenly(run: str, gravity: str, wanted: Word) -> None:
    text = SHAFT.replace("RUN", RUNS[run]).replace("G}", f"{gravity}}}")
    if run == "prescribed":
        text = text.replace(", coordinates: [p]", "").replace(
            "inertia: [0, 0, 1], coordinates: [p]", "inertia: [0, 0, 1]"
        )
        text = text.replace("bodies:", "prescribed: {p: {rate: W}}\nbodies:", 1)
    assert word(text) is wanted


HOOP = """
mbsym: 1
name: cylinder in a hoop that turns
parameters: {R: positive, r: positive, g: positive, W: real}
prescribed: {chi: {rate: W}}
bodies:
  - {name: hoop, attached to: 0, mass: 0, rotation: {axes: [3], angles: [chi]}}
  - {name: arm, attached to: 0, mass: 0, rotation: {axes: [3], angles: [p]}, coordinates: [p]}
  - {name: cyl, attached to: arm, mass: 1, connection point: [CENTRE], rotation: {axes: [3], angles: [th]},
     inertia about: joint, inertia: [0, 0, r**2/2], coordinates: [th]}
loads: [uniform gravity: {vector: [GRAVITY]}]
constraints: [rolling: {body: cyl, point: [CONTACT], on: hoop}]
motion: {p: 0, th: {rate: W*(R + r)/r}}
values: {R: 2, r: 1, g: 9.81, W: 3}
"""
DOWN = ("0, -R, 0", "0, -g, 0", "r*sin(-th), -r*cos(th), 0")
LEFT = ("-R, 0, 0", "-g, 0, 0", "-r*cos(th), r*sin(th), 0")


@pytest.mark.parametrize(("centre", "gravity", "contact"), [DOWN, LEFT])
def test_a_wheel_whose_rows_vanish_one_after_another(centre: str, gravity: str, contact: str) -> None:
    """3 R p'' + 2 g sin(p) = 0 whatever W; along fixed axes the rows are -g sin(p) and g cos(p), g that of the contact.

    So p = 0 and p = pi are the steady motions, and no position is singular.
    """
    text = HOOP.replace("CENTRE", centre).replace("GRAVITY", gravity).replace("CONTACT", contact)
    assert word(text) is Word.STABLE
    analysis = mbsym.loads(text, (3,))
    (redundant,) = analysis.constraints.redundant
    assert len(redundant.from_rows) == 1
    listed = relative_equilibria(analysis.system, given_values(analysis.system, {}))
    assert [x.verdict.word for x in listed.equilibria] == [Word.STABLE, Word.UNSTABLE]
    assert listed.complete
    assert not listed.remarks
