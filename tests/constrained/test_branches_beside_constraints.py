"""``equilibria --vary`` under constraints: branches of the same mechanism in coordinates, and some known by hand."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from conftest import filed
from flint import fmpq

import mbsym
from mbsym.algebra.plane.numbers import enclosure
from mbsym.maps.branches import branches
from mbsym.maps.branches_events import Event
from mbsym.maps.branches_result import Branches
from mbsym.maps.section import Axis
from mbsym.mechanics.rest import given_values, rational_values
from mbsym.problems.relative_equilibria.equilibria import equilibria
from mbsym.report.maps.words import critical_words

#: A bead of weight 8 on a hoop of radius 2 that turns with the rate Omega; the pitchfork is at Omega^2 = g/R = 4.
HOOP = """mbsym: 1
name: hoop
parameters: {{m: {{positive: true, value: 1}}, R: {{positive: true, value: 2}}, g: {{positive: true, value: 8}},
  Omega: {{real: true}}}}
prescribed: {{chi: Omega}}
bodies:
  - {{name: frame, attached to: 0, rotation: {{axes: [3], angles: [chi]}}, mass: 0}}
  - {{name: bead, attached to: frame, {bead}, mass: m}}
loads: [{{uniform gravity: {{vector: [0, 0, -g]}}}}]
"""
ANGLE = 'connection point: ["R*sin(theta)", 0, "-R*cos(theta)"], coordinates: [theta]'
PLANE = "connection point: [x, 0, z], coordinates: [x, z]"
CIRCLE = "relation: x**2 + z**2 = R**2"
DISTANCE = "distance: {between: [{body: bead, point: [0, 0, 0]}, {body: frame, point: [0, 0, 0]}], length: R}"
TIED = {
    "a relation": [CIRCLE],
    "a relation of fourth degree": ["relation: (x**2 + z**2)**2 = R**4"],
    "a distance": [DISTANCE],
}

#: Two bars of length l as a shallow arch, its end on a spring k that is at rest at a: with the angle theta of the bars
#: V = k (2 l cos theta - a)^2 / 2 + P l sin theta,  so  P = 2 k (2 l sin theta - a tan theta),  which folds where
#: cos^3 theta = a / (2 l): with a = 27/32 l at cos theta = 3/4, P = 7 sqrt(7)/16 k l.
ARCH = """mbsym: 1
name: arch
parameters: {P: {real: true}, k: {positive: true, value: 1}, l: {positive: true, value: 1},
  a: {positive: true, value: 27/32}, m: {positive: true, value: 1}}
bodies:
  - {name: left, attached to: 0, rotation: {axes: [3], angles: [q1]}, mass centre: [l, 0, 0], mass: m}
  - {name: right, attached to: left, connection point: [l, 0, 0], rotation: {axes: [3], angles: [q2]}, mass: 0,
     inertia about: joint, inertia: [0, 0, m*l**2]}
  - {name: slider, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
loads: [{uniform gravity: {vector: [0, -P, 0]}}, {generalized force: {x: -k*(x - a)}}]
constraints: [{coincide: [{body: right, point: [l, 0, 0]}, {body: slider, point: [0, 0, 0]}]}]
"""

#: A bead on the circle that the plane x = p cuts from a sphere of radius 1: two rests, none beyond |p| = 1.
CUT = """mbsym: 1
name: cut
parameters: {p: {real: true}, g: {positive: true, value: 1}, m: {positive: true, value: 1}}
bodies:
  - {name: bead, attached to: 0, connection point: [x, y, z], coordinates: [x, y, z], mass: m}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
constraints: [{relation: x**2 + y**2 + z**2 = 1}, {relation: x = p}]
"""


def found(folder: Path, text: str, name: str, low: str, high: str) -> Branches:
    path = filed(folder / "system.yaml", text)
    system = mbsym.load(path, ()).system
    values = {key: x for key, x in rational_values(given_values(system, {})).items() if key != name}
    return branches(system, Axis(name, Fraction(low), Fraction(high)), values)


def hoop(bead: str, *constraints: str) -> str:
    listed = "".join(f"  - {one}\n" for one in constraints)
    return HOOP.format(bead=bead) + ("constraints:\n" + listed if constraints else "")


def told(one: Branches) -> list[tuple[float, tuple[Event, ...]]]:
    happening = [x for x in one.criticals if one.happens(x)]
    return [(round(float(enclosure(x.sample).mid()), 9), one.critical(x).events) for x in happening]


def ends(one: Branches) -> list[tuple[bool, bool]]:
    """Of each branch, whether the equilibria that it tends to are told."""
    return [(piece.start is not None, piece.end is not None) for piece in one.pieces]


def counts(one: Branches) -> list[tuple[int, int]]:
    return [(x.counted.count, x.counted.stable) for x, _ in one.spans() if x.counted is not None]


@pytest.mark.parametrize("tied", TIED.values(), ids=TIED)
def test_a_constraint_in_place_of_a_coordinate_changes_nothing(tied: list[str], tmp_path: Path) -> None:
    plain = found(tmp_path, hoop(ANGLE), "Omega", "1/2", "5")
    there = found(tmp_path, hoop(PLANE, *tied), "Omega", "1/2", "5")
    assert told(there) == told(plain) == [(2.0, (Event.PITCHFORK,))]
    assert counts(there) == counts(plain) == [(2, 1), (4, 2)]
    assert there.proved
    assert all(piece.throughout for piece in there.pieces)
    assert sorted(ends(there)) == sorted(ends(plain))
    assert all(there.critical(one).balance is not False for one in there.criticals)
    heights = sorted(x.value for one in there.equilibria(there.intervals[-1]) for x in one.values if x.name == "z")
    rate = float(enclosure(there.intervals[-1].sample).mid())
    expected = sorted([-2.0, 2.0, *[-8 / rate**2] * 2])
    assert heights == pytest.approx(expected, abs=1e-9)


def test_of_constraints_that_follow_the_counts_are_the_same_and_what_splits_is_not_named(tmp_path: Path) -> None:
    there = found(tmp_path, hoop(PLANE, CIRCLE, DISTANCE), "Omega", "1/2", "5")
    assert told(there) == [(2.0, (Event.DEGENERATE,))]
    assert counts(there) == [(2, 1), (4, 2)]


def test_an_arch_of_two_bars_snaps_through_where_its_load_folds(tmp_path: Path) -> None:
    there = found(tmp_path, ARCH, "P", "1/10", "2")
    (at,) = [x for x in there.criticals if Event.FOLD in there.critical(x).events]
    assert [int(c) for c in at.sample.polynomial.coeffs()] == [-343, 0, 256]
    assert counts(there) == [(4, 2), (2, 1)]
    assert not there.proved  # the bars may fold and turn together: of that set nothing is counted


def test_equilibria_end_where_the_positions_that_keep_the_constraints_do(tmp_path: Path) -> None:
    there = found(tmp_path, CUT, "p", "-2", "2")
    assert [x.sample for x in there.criticals] == [fmpq(-1), fmpq(1)]
    assert counts(there) == [(0, 0), (2, 1), (0, 0)]
    assert there.proved
    words = {str(critical_words(there, one)) for one in there.criticals}
    assert words == {"equilibria in positions in which the constraints are singular"}


def test_damping_leaves_open_where_stability_changes_and_says_so(tmp_path: Path) -> None:
    text = hoop(PLANE, CIRCLE).replace("loads: [", "loads: [{generalized force: {x: -m*x_dot}}, ")
    there = found(tmp_path, text, "Omega", "1/2", "5")
    assert counts(there) == [(2, 1), (4, 2)]
    (remark,) = there.remarks
    assert "damping" in remark.about


def test_a_list_that_leaves_positions_out_is_not_called_complete(tmp_path: Path) -> None:
    """Of the two rests on the circle x = sin(1/2) none is found where equations are not algebraic."""
    path = filed(tmp_path / "cut.yaml", CUT.replace("relation: x = p", "relation: x = sin(p)"))
    listed = equilibria(mbsym.load(path, ()).system, {"p": Fraction(1, 2), "g": Fraction(1), "m": Fraction(1)})
    assert len(listed.equilibria) == 2 or not listed.complete
