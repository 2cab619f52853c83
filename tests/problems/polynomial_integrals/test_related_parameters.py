"""Relations between parameters are used: what is said of almost all parameters is said of those that keep them."""

from __future__ import annotations

import mbsym

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
    assert [one.weight for one in plain.polynomial_integrals.found.generators] == [2, 2]
    weights = [one.weight for one in related.polynomial_integrals.found.generators]
    assert weights == [1, 2]
    assert str(related.polynomial_integrals.formulas[0]) == "r"


def test_steady_motions_are_those_of_the_related_body():
    """A - B is no condition any more: it is zero."""
    found = mbsym.loads(BODY + "relations: {B: A}\n").invariant_sets
    assert all("B" not in str(x) for x in found.generic)
    assert any(one.free == ("r",) for one in found.families[0].sets)
