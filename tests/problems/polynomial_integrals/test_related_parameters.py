"""Relations between parameters are used: what is said of almost all parameters is said of those that keep them."""

from __future__ import annotations

from dataclasses import replace

import mbsym
from mbsym.analysis import polynomial
from mbsym.analysis.pipeline import Analysis
from mbsym.formulas.formula import Formula

BODY = """
mbsym: 1
name: Free body with an axis of symmetry by a relation
parameters: {A: {sign: positive}, B: {sign: positive}, C: {sign: positive}, m: {sign: positive}}
bodies:
  - name: body
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: m
    inertia about: joint
    inertia: [A, B, C]
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
"""


def test_a_symmetric_body_by_a_relation_keeps_r():
    plain, related = mbsym.loads(BODY), mbsym.loads(BODY + "relations: {B: A}\n")
    assert [one.weight for one in plain.polynomial_integrals.integrals.generators] == [2, 2]
    weights = [one.weight for one in related.polynomial_integrals.integrals.generators]
    assert weights == [1, 2]
    assert str(related.polynomial_integrals.formulas[0]) == "r"


def test_steady_motions_are_those_of_the_related_body():
    """A - B is no condition any more: it is zero."""
    found = mbsym.loads(BODY + "relations: {B: A}\n").invariant_sets
    assert all("B" not in str(x) for x in found.generic)
    assert any(one.free == ("r",) for one in found.families[0].sets)


def test_the_second_route_is_taken_at_states_that_keep_the_relations():
    """Kovalevskaya's integral with A = 2 C as a relation, and a planted p in its place: p is kept at no such state."""
    top = BODY.replace("inertia: [A, B, C]", "inertia: [A, A, C]\n    mass centre: [1, 0, 0]")
    top += "loads: [{uniform gravity: {acceleration: 1, direction: [0, 0, -1]}}]\nrelations: {A: 2*C}\n"
    analysis = Analysis(mbsym.loads(top).system, problems=(9,))
    result = analysis.polynomial_integrals
    assert polynomial.check(analysis).outcome == "exact"
    (place,) = (k for k, one in enumerate(result.integrals.generators) if one.is_new)
    ring = result.formulas[place].ring
    wrong = Formula(ring, ring.generator("coordinate", "p"))
    planted = replace(result, formulas=(*result.formulas[:place], wrong, *result.formulas[place + 1 :]))
    object.__setattr__(analysis, "optional", lambda name: planted if name == "polynomial_integrals" else None)
    assert polynomial.check(analysis).failed
