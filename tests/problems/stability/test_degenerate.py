"""K with a null direction: terms of higher order decide, by hand."""

from __future__ import annotations

from fractions import Fraction

import pytest
from conftest import TESTS

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import equilibria
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import Because, Word

BLOCK = """
mbsym: 1
name: Blocks
bodies:
  - {{name: block, attached to: 0, connection point: [{point}], mass: 1, coordinates: [{coordinates}]}}
loads:
  - potential: {potential}
{more}motion: {{{motion}}}
"""


def verdict(potential: str, coordinates: str = "x", more: str = "") -> Verdict:
    names = coordinates.split(", ")
    point = ", ".join([*names, "0", "0"][:3])
    motion = ", ".join(f"{name}: 0" for name in names)
    text = BLOCK.format(potential=potential, coordinates=coordinates, point=point, more=more, motion=motion)
    found = mbsym.loads(text).stability.numerical
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("potential", "word"),
    [
        ("x**4", Word.STABLE),
        ("x**6 - x**8", Word.STABLE),
        ("-x**4", Word.UNSTABLE),
        ("x**3", Word.UNSTABLE),
        ("x**5 + x**6", Word.UNSTABLE),
        ("cos(x) + x**2/2", Word.STABLE),  # x^4/24
        ("cos(x) + x**2/2 - x**4/24", Word.UNSTABLE),  # -x^6/720
        ("x**12", Word.UNDECIDED),  # beyond what is looked at
    ],
)
def test_one_coordinate(potential: str, word: Word) -> None:
    assert verdict(potential).word is word


@pytest.mark.parametrize(
    ("potential", "word"),
    [
        # V = (y + a x^2)^2/2 + b x^4 has its minimum iff b > 0; without the splitting it is (a^2/2 + b) x^4.  Along the
        # valley V < 0 somewhere near by: unstable by the normal form of a zero frequency (Sokolskii).
        ("(y + x**2)**2/2 + x**4/10", Word.STABLE),
        ("(y + x**2)**2/2 - x**4/10", Word.UNSTABLE),
        ("(y + x**2)**2/2", Word.UNSTABLE),  # along the valley, across which V'' varies, slow motions leave
        ("y**2 + x**4", Word.STABLE),
        ("y**2 + x**3", Word.UNSTABLE),
        ("y**2 + x*y**2 + x**4 + x**2*y", Word.STABLE),  # y = -x^2/2 + ...: x^4 (1 - 1/4)
        ("y**2 + x**4 + 3*x**2*y", Word.UNSTABLE),  # x^4 (1 - 9/4)
        ("(x + y)**2 + (x - y)**4", Word.STABLE),
        ("x**4 + y**4", Word.STABLE),  # two null directions
        ("x**4 + y**4 + 3*x**2*y**2 + x**5", Word.STABLE),
        ("x**2*y**2", Word.UNSTABLE),  # y = 0, x = x' t
    ],
)
def test_two_coordinates(potential: str, word: Word) -> None:
    assert verdict(potential, "x, y").word is word


def test_three_coordinates_need_what_lies_across_the_null_direction() -> None:
    potential = "(y + x**2)**2/2 + (z - 2*x**2 + y)**2 + x**4/10"
    assert verdict(potential, "x, y, z").word is Word.STABLE
    assert verdict(potential.replace("+ x**4/10", "- x**4/10"), "x, y, z").word is Word.UNSTABLE


def test_friction_keeps_a_minimum_and_forbids_to_speak_of_the_converse() -> None:
    assert verdict("x**4", more="  - damper: {coordinate: x, coefficient: 1}\n").word in (Word.STABLE, Word.ASYMPTOTIC)
    assert verdict("x**4", more="  - rayleigh: -x_dot**2/2\n").word is Word.UNSTABLE
    driven = "  - rayleigh: -x_dot**4/4\n"
    assert verdict("x**4 + y**4 + x**3*y + x*y**3", "x, y", more=driven).word is Word.UNDECIDED
    assert verdict("x**4", more=driven).word is Word.UNSTABLE  # one coordinate: it gains energy along every orbit
    # Roots 0 and -1: the converse is not about systems with friction; on the centre manifold x' = 4 x^3 + ...
    driven_away = verdict("-x**4", more="  - damper: {coordinate: x, coefficient: 1}\n")
    assert (driven_away.word, driven_away.theorem) == (Word.UNSTABLE, "Lyapunov, Pliss: centre manifold")


def test_an_upright_rod_on_the_torsional_spring_that_just_holds_it() -> None:
    """k th^2/2 + cos th at k = 1: th^4/24."""
    system = mbsym.load(TESTS / "cases" / "statements" / "torsion.yaml").system
    (one,) = equilibria(system, given_values(system, {"k": Fraction(1)})).equilibria
    assert (one.verdict.word, one.verdict.theorem) == (Word.STABLE, "Lagrange-Dirichlet")


@pytest.mark.parametrize(("rate", "word"), [("3", Word.STABLE), ("16/5", Word.UNSTABLE)])
def test_a_bead_on_a_turning_hoop_at_its_border(rate: str, word: Word) -> None:
    """V = -g cos a - W^2 sin^2 a / 2: at W^2 = g = 9 it is g (-1 + a^4/8), a minimum."""
    text = """
mbsym: 1
name: Bead on a hoop that is turned
parameters: {g: 9, W: 3}
prescribed: {chi: {rate: W}}
bodies:
  - {name: hoop, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: arm, attached to: hoop, rotation: {axes: [1], angles: [a]}, mass centre: [0, 0, -1], mass: 1}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
motion: {a: 0}
"""
    found = mbsym.loads(text.replace("W: 3", f"W: {rate}")).stability.numerical
    assert found is not None
    assert found.word is word


@pytest.mark.parametrize(
    ("position", "coordinates", "loads", "word"),
    [
        # One coordinate is a function of the length of its path, straight lines know no polar coordinates, a cone is
        # cut open, and on a sphere all places are alike: the same words as of x'' = 0.
        ("[x, x**2/2, 0]", "x: 0", "", Word.STABLE_BUT_CYCLIC),
        ("[r*cos(a), r*sin(a), 0]", "r: 1, a: 0", "", Word.STABLE_BUT_CYCLIC),
        ("[x, y + x**2, 0]", "x: 0, y: 0", "", Word.STABLE_BUT_CYCLIC),
        ("[r*cos(a), r*sin(a), 2*r]", "r: 1, a: 0", "", Word.STABLE_BUT_CYCLIC),
        ("[cos(b)*cos(a), cos(b)*sin(a), sin(b)]", "a: 0, b: 0", "", Word.STABLE_BUT_CYCLIC),
        ("[r*cos(b)*cos(a), r*cos(b)*sin(a), r*sin(b)]", "a: 0, b: 0, r: 1", "", Word.STABLE_BUT_CYCLIC),
        # Geodesics of a surface whose places differ leave every small circle.
        ("[x, y, x**2/2 + y**2 + x**2*y/2]", "x: 0, y: 0", "", Word.UNSTABLE),
        ("[(2 + cos(b))*cos(a), (2 + cos(b))*sin(a), sin(b)]", "a: 0, b: 0", "", Word.UNSTABLE),
        ("[2*cos(b)*cos(a), cos(b)*sin(a), sin(b)]", "a: 0, b: 0", "", Word.UNSTABLE),
        # x'' = y', y'' = -x' but for terms of third order: circles of radius |v| about places near by.
        ("[x, y, x*y]", "x: 0, y: 0", "generalized force: {x: y_dot, y: -x_dot}", None),
        # Friction stops it near by: x'' (1 + x^2) + x x'^2 = -x'.
        ("[x, x**2/2, 0]", "x: 0", "rayleigh: x_dot**2/2", None),
    ],
)
def test_no_forces_at_all(position: str, coordinates: str, loads: str, word: Word | None) -> None:
    names = ", ".join(one.partition(":")[0].strip() for one in coordinates.split(","))
    acting = f"loads: [{{{loads}}}]\n" if loads else ""
    text = f"""
mbsym: 1
name: Free
bodies:
  - {{name: one, attached to: 0, connection point: {position}, mass: 1, coordinates: [{names}]}}
{acting}motion: {{{coordinates}}}
"""
    found = mbsym.loads(text).stability.numerical
    assert found is not None
    assert found.word is word if word is not None else found.word is not Word.UNSTABLE
    assert ("motion along geodesics" in found.theorems) == (word is Word.UNSTABLE)


@pytest.mark.parametrize(
    ("relation", "coordinates", "word"),
    [
        ("x**2 + y**2 = 1", "x: 0, y: 1", Word.STABLE_BUT_CYCLIC),
        ("x**2 + 2*y**2 = 1", "x: 1, y: 0", Word.STABLE_BUT_CYCLIC),
        ("x**2 + y**2 + z**2 = 1", "x: 0, y: 0, z: 1", Word.STABLE_BUT_CYCLIC),
        ("x**2 + 2*y**2 + 3*z**2 = 3", "x: 0, y: 0, z: 1", Word.UNSTABLE),
        ("x**2 + 4*y**2 = 4", "x: 2, y: 0, z: 0", Word.STABLE_BUT_CYCLIC),
        ("z + z**3 = x**2", "x: 0, y: 0, z: 0", Word.STABLE_BUT_CYCLIC),
        ("z + z**3 = x**2 + y**2", "x: 0, y: 0, z: 0", Word.UNSTABLE),
        ("z**2 = x**2 + 2*y**2", "x: 1, y: 0, z: 1", Word.STABLE_BUT_CYCLIC),
        ("z**2 + 1 = x**2 + y**2", "x: 1, y: 0, z: 0", Word.UNSTABLE),
        ("(x**2 + y**2 + z**2 + 3)**2 = 16*(x**2 + y**2)", "x: 3, y: 0, z: 0", Word.UNSTABLE),
        ("b*x**2 + b*y**2 + 2*z**2 = 2", "x: 0, y: 0, z: 1", Word.STABLE_BUT_CYCLIC),
    ],
)
def test_no_forces_at_all_but_constraints(relation: str, coordinates: str, word: Word) -> None:
    """On curves, spheres, cylinders and cones all places are alike, on ellipsoids, hyperboloids, tori they are not."""
    names = [one.partition(":")[0].strip() for one in coordinates.split(",")]
    position = ", ".join([*names, "0"][:3])
    text = f"""
mbsym: 1
name: Free
parameters: {{b: 2}}
bodies:
  - {{name: one, attached to: 0, connection point: [{position}], mass: 1, coordinates: [{", ".join(names)}]}}
constraints: [{{relation: {relation}}}]
motion: {{{coordinates}}}
"""
    found = mbsym.loads(text).stability.numerical
    assert found is not None
    assert found.word is word


ROTOR = """
mbsym: 1
name: Rotor
bodies:
  - {name: rotor, attached to: 0, mass: 1, rotation: {axes: [1, 2], angles: [a, b]}, inertia about: joint,
     inertia: [1, 1, 1], gyrostatic moment: [0, 0, 5]}
  - {name: bead, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
constraints: [{relation: x**2 + 4*y**2 = 4}]
motion: {a: 0, b: 0, x: 2, y: 0}
"""


def test_a_rotor_has_gyroscopic_forces_under_constraints_too() -> None:
    """They are linear in velocities: at rest nothing is felt of them, and yet no motion is along a geodesic."""
    found = mbsym.loads(ROTOR).stability.numerical
    assert found is not None
    assert "motion along geodesics" not in found.theorems
    assert not found.because(Because.ALIKE)


def test_a_weight_that_does_not_change_its_height_feels_none() -> None:
    text = ROTOR.replace(", gyrostatic moment: [0, 0, 5]", "").replace(
        "motion:", "loads: [{uniform gravity: {acceleration: 9, direction: [0, 0, -1]}}]\nmotion:"
    )
    found = mbsym.loads(text.replace("[x, y, 0]", "[x, y, 3]")).stability.numerical
    assert found is not None
    assert found.because(Because.ALIKE)


@pytest.mark.parametrize(
    ("one", "two", "word"),
    [
        ("r*cos(a), r*sin(a), 0", "s*cos(b), s*sin(b), 0", Word.STABLE_BUT_CYCLIC),  # straight lines of both
        ("cos(r)*cos(a), cos(r)*sin(a), sin(r)", "s, b + s**2, 0", Word.STABLE_BUT_CYCLIC),  # sphere, plane
        ("2*cos(r)*cos(a), cos(r)*sin(a), sin(r)", "s, b + s**2, 0", Word.UNSTABLE),  # ellipsoid, plane
    ],
)
def test_two_particles_are_as_free_as_each(one: str, two: str, word: Word) -> None:
    found = mbsym.loads(f"""
mbsym: 1
name: Two
bodies:
  - {{name: one, attached to: 0, connection point: [{one}], mass: 1, coordinates: [r, a]}}
  - {{name: two, attached to: 0, connection point: [{two}], mass: 2, coordinates: [s, b]}}
motion: {{r: 1/3, a: 0, s: 1, b: 0}}
""").stability.numerical
    assert found is not None
    assert found.word is word


@pytest.mark.parametrize("tilt", ["1", "pi/3", "pi/2"])
@pytest.mark.parametrize("place", ["", "x, y, z"])
def test_a_free_body_that_rests_is_judged_alike_at_every_angle(tilt: str, place: str) -> None:
    """All positions are alike: turns about axes of space lead to each.  At 1 rad it was "unstable" at given values."""
    names = ", ".join(filter(None, [place, "a, b, c"]))
    at = f"connection point: [{place}], coordinates: [{names}]," if place else ""
    rest = ", ".join(f"{name}: {tilt if name == 'b' else 0}" for name in names.split(", "))
    found = mbsym.loads(f"""
mbsym: 1
name: Body
bodies:
  - {{name: one, attached to: 0, mass: 1, rotation: {{axes: [3, 1, 3], angles: [a, b, c]}}, {at}
     inertia about: mass centre, inertia: [2, 3, 4]}}
motion: {{{rest}}}
""").stability
    assert found.verdict.word is Word.STABLE_BUT_CYCLIC
    assert found.numerical is None or found.numerical.word is Word.STABLE_BUT_CYCLIC
