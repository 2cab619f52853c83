"""The logical place of every condition, against motions that are known to be stable where it fails."""

from __future__ import annotations

import json
from pathlib import Path

from conftest import STATEMENTS, at_values
from terminal import told

import mbsym
from mbsym.problems.stability.problem import SubsystemStability
from mbsym.problems.stability.requirements import Place
from mbsym.report.conditions import cases, statements
from mbsym.report.targets import TARGETS


def places(part: SubsystemStability) -> dict[str, tuple[str, Place]]:
    """Of the open conditions by label: the relation and the place."""
    return {x.label: (x.relation, x.place) for x in statements(part.ring, part.theory.requirements)}


def at(path: Path, **values: str) -> str:
    """The verdict at values, in a word."""
    found = at_values(path, **values).stability.numerical
    assert found is not None
    return found.word


def test_a_lamina_spins_stably_about_its_largest_axis() -> None:
    """C = A + B makes the frequencies W and W sqrt((C - A)(C - B)/(A B)) coincide; K > 0 all the same."""
    a = mbsym.load(STATEMENTS / "s_euler_lamina.yaml")
    (part,) = [x for x in a.stability.subsystems if len(x.coordinates) == 2]
    assert places(part) == {
        "v0 of factor 1": (">", Place.NECESSARY),
        "resultant of factors 1 and 2": ("!=", Place.METHOD),
    }
    assert at(STATEMENTS / "s_euler_lamina.yaml", A="2", B="3", C="5", W="1").startswith("stable")  # not necessary
    assert at(STATEMENTS / "s_euler_lamina.yaml", A="2", B="4", C="3", W="1") == "unstable"  # the middle axis: v0 < 0
    line = "  resultant of factors 1 and 2: A + B - C != 0 (needed by this method, which leaves the rest open)"
    assert line in told(a, 6)
    assert "(needed by this method, which leaves the rest open)" in TARGETS["latex"].render(a, (6,))
    found = json.loads(TARGETS["json"].render(a, (6,)))["stability"]
    assert [[item["place"] for item in part["conditions"]] for part in found["subsystems"]] == [
        [],
        ["necessary", "method"],
    ]


def test_squared_factors_of_discriminants_are_no_conditions_of_stability() -> None:
    """Two equal tops that spin in opposite directions: W1 + W2 = 0 makes frequencies coincide without Jordan blocks."""
    a = mbsym.load(STATEMENTS / "cg_claims.yaml")
    found = places(a.stability.subsystems[0])
    squared = {label: place for label, (relation, place) in found.items() if relation == "!="}
    assert len(squared) >= 4
    assert {*squared.values()} == {Place.METHOD}
    assert {place for relation, place in found.values() if relation == ">"} == {Place.NECESSARY}


def test_strict_inequalities_are_necessary_for_exponential_stability() -> None:
    """Not for asymptotic stability: x'' + x^2 x' + x = 0 is asymptotically stable without any root to the left."""
    a = mbsym.load(STATEMENTS / "claims_spin.yaml")
    (part,) = [x for x in a.stability.subsystems if len(x.coordinates) == 3]
    assert {place for _, place in places(part).values()} == {Place.EXPONENTIAL}


def test_one_potential_well() -> None:
    """x'' = -(a - b)^2 x, exactly: at a = b that is x'' = 0, a free particle, which drifts."""
    a = mbsym.load(STATEMENTS / "claims_min.yaml")
    (part,) = a.stability.subsystems
    assert places(part) == {"v0": ("!=", Place.DRIFTS)}
    assert {r.place for r in part.theory.stiffness.requirements} == {Place.SUFFICIENT}


def test_a_condition_that_another_one_implies_is_not_told() -> None:
    """C^2 Omega^2 - 4 A m l g > 0 says that C^2 Omega^2 - 2 A m l g > 0, and is < 0 where that is."""
    top = mbsym.load(STATEMENTS.parents[2] / "systems" / "heavy-top.yaml").stability
    assert [str(x) for _, x, _ in top.subsystems[0].conditions] == ["C**2*Omega**2 - 4*A*m*l*g"]
    pair = mbsym.load(STATEMENTS.parents[2] / "systems" / "gyroscopic-pair.yaml").stability
    assert len(pair.subsystems[0].conditions) == 2  # g^2 - k1 - k2 is negative where g = 0


def test_a_trap_has_one_condition() -> None:
    """Penning's trap is stable across where q^2 B^2 > 2 m k (L. S. Brown, G. Gabrielse, Rev. Mod. Phys. 58, 1986):
    neither B != 0 nor q^2 B^2 > m k is told beside it, and without a field it is unstable, too."""
    trap = mbsym.loads("""
mbsym: 1
name: trap
parameters: {m: positive, q: positive, B: real, k: positive}
bodies: [{name: ion, attached to: 0, mass: m, connection point: [x, y, z], coordinates: [x, y, z]}]
loads:
  - potential: k*(2*z**2 - x**2 - y**2)/4
  - generalized force: {x: q*B*y_dot, y: -q*B*x_dot}
motion: {x: 0, y: 0, z: 0}
""").stability
    (part,) = [part for part in trap.subsystems if len(part.coordinates) == 2]
    told = [[str(x.formula) for x in (*case.all_of, *case.any_of)] for case in cases(part)]
    assert told == [["q**2*B**2 - 2*m*k"], ["2*m*k - q**2*B**2"]]


def test_what_stands_under_a_root_of_a_relation_is_not_negative() -> None:
    """A ball at the angle a on a shaft that turns at w = sqrt(g/(l cos a)): there is no such motion with cos a < 0."""
    text = """
mbsym: 1
name: governor
parameters: {m: positive, J: positive, g: positive, l: positive, w: real, a: real}
relations: {w: sqrt(g/(l*cos(a)))}
bodies:
  - {name: shaft, rotation: {axes: [3], angles: [f]}, inertia: [J, J, J], coordinates: [f],
     mass: 0, inertia about: joint}
  - {name: p, attached to: shaft, connection point: [l*sin(th), 0, -l*cos(th)], mass: m, coordinates: [th]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
motion: {f: {rate: w}, th: a}
"""
    found = mbsym.loads(text)
    (part,) = found.stability.subsystems
    assert [str(x) for _, x, _ in part.conditions] == ["cos(a) - 1"]
    assert [case.verdict.word.value for case in part.theory.cases if not case.never] == [
        "stable but for a drift of cyclic coordinates"
    ]
    assert mbsym.loads(text.replace("sqrt(g/(l*cos(a)))", "g/(l*cos(a))")).stability.verdict.word.value != "unstable"


def test_a_root_of_what_cannot_vanish_does_not_either():
    """V = (1 - c) b x^2 with b = sqrt(1/(1 - c)), a number: 1 - c > 0, and b > 0 without a condition of its own."""
    verdict = mbsym.loads("""
mbsym: 1
name: Spring by a root
parameters: {b: real, c: real}
relations: {b: sqrt(1/(1 - c))}
bodies:
  - {name: p, attached to: 0, coordinates: [x], connection point: [x, 0, 0], mass: 1}
loads:
  - potential: (1 - c)*b*x**2
motion: {x: 0}
""").stability
    assert verdict.verdict.word.value == "stable"
    assert not verdict.subsystems[0].conditions
