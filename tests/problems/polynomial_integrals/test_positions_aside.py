"""Integrals of systems whose equations lack positions, or vanish: what is said is said of what was looked at."""

from __future__ import annotations

import json
from fractions import Fraction

import jsonschema
import pytest
from conftest import filed, invoked

import mbsym
from mbsym.analysis import Analysis
from mbsym.analysis.found import beyond
from mbsym.analysis.polynomial import integrals_of, setting
from mbsym.problems.polynomial_integrals.result import FUNCTION
from mbsym.report.messages import messages
from mbsym.report.plain_writer import Writer
from mbsym.report.schemas import schema
from mbsym.report.words import integrals_words

FREE_BODY = """
mbsym: 1
name: free body
parameters: {A: positive, B: positive, C: positive}
bodies:
  - name: body
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, theta, phi]}
    mass: 0
    inertia about: joint
    inertia: {tensor: [A, B, C], accept: true}
    speeds: {p: omega1, q: omega2, r: omega3}
    orientation: {gamma: 3}
"""

PARTICLE = """
mbsym: 1
name: free particle
bodies:
  - {name: P, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
"""


@pytest.mark.parametrize(
    ("text", "names"),
    [
        (FREE_BODY, "gamma"),
        (FREE_BODY.replace("{gamma: 3}", "direction cosines"), "alpha, beta, gamma"),
        (FREE_BODY.replace("    orientation: {gamma: 3}\n", ""), "psi, theta, phi"),
        (FREE_BODY.replace("{gamma: 3}", "{e: quaternion}"), "e"),
    ],
)
def test_every_integral_of_a_free_body_is_not_said_of_those_that_hold_its_orientation(text, names):
    """Euler's equations have two integrals; A p gamma1 + B q gamma2 + C r gamma3 is a third, of degree two.

    Its derivative is  M . gamma' + M' . gamma = M . (gamma x w) + (M x w) . gamma = 0,  so that "every polynomial
    integral of degree up to 4 is a polynomial in" energy and |M|^2 is false of p, q, r, gamma.
    """
    found = Analysis(mbsym.loads(text).system, problems=(9,)).polynomial_integrals.integrals
    assert [one.weight for one in found.generators] == [2, 2]
    assert found.complete
    said = [Writer().said(one) for one in integrals_words.sentences(found)]
    (every,) = [one for one in said if one.startswith("Every")]
    assert f"that does not contain {names} is a polynomial" in every
    assert f"The equations do not contain {names}: integrals that do are not looked for here." in said


def test_what_the_equations_do_not_contain_is_in_the_data_and_in_what_is_said_of_a_line(tmp_path):
    """A charge in a magnetic field keeps x' - B y and y' + B x for every B: only integrals without x, y are denied."""
    path = filed(
        tmp_path / "charge.yaml",
        PARTICLE.replace("bodies:", "parameters: {B: real}\nbodies:")
        + "loads:\n  - {generalized force: {x: B*y_dot, y: -B*x_dot}}\n",
    )
    done = invoked("integrals", path, "--vary", "B=-1:1", code=0)
    told = " ".join(done.output.split())
    assert "rational or not, there is no further integral of weight up to 4 that does not contain x, y (proved" in told
    assert "B = 0 further integral of weight 1: x_dot" in told
    done = invoked("integrals", path, "--json")
    data = json.loads(done.output)
    jsonschema.validate(data, schema("integrals"))
    assert data["not_contained"] == ["x", "y"]


def test_a_free_particle_has_homogeneous_equations_and_relations_are_looked_for(tmp_path):
    """x'' = y'' = 0: the field of x', y' is zero, homogeneous of any degree; every polynomial in x', y' is kept."""
    path = filed(tmp_path / "free.yaml", PARTICLE)
    done = invoked("integrals", path, "--relations", code=0)
    told = " ".join(done.output.split())
    assert "Under these weights the equations are quasi-homogeneous." in told
    # x y' - y x' is of degree two, and kept as well.
    assert "there is none without x, y beyond those of problem 7" in told
    assert "There is none of weight up to 4 with K not zero" in told


def test_none_is_denied_without_positions():
    """x'' = -x': of x' alone nothing is kept, but x' + x is."""
    text = PARTICLE.replace("[x, y, 0]", "[x, 0, 0]").replace("[x, y]", "[x]")
    text += "loads:\n  - damper: {coordinate: x, coefficient: 1}\n"
    found = Analysis(mbsym.loads(text).system, problems=(9,)).polynomial_integrals.integrals
    said = [Writer().said(one) for one in integrals_words.sentences(found)]
    assert said[0] == "There is none up to weighted degree 4 that does not contain x (proved)."


def test_sentences_about_positions_aside_have_their_translations():
    every = [x for table in integrals_words._EVERY.values() for x in table.values()]
    every += [*integrals_words._NONE_WITHOUT.values(), *integrals_words._NO_OTHER_WITHOUT.values()]
    for text in every:
        assert all(("", text) in messages(language) for language in ("ru", "es"))


@pytest.mark.parametrize(
    "told",
    [
        "",
        "speeds: {p: omega1, q: omega2, r: omega3}",
        "speeds: {p: omega1, q: omega2, r: omega3}\n    orientation: {gamma: 3}",
        "speeds: {p: omega1, q: omega2, r: omega3}\n    orientation: {e: quaternion}",
    ],
)
def test_what_integrals_with_orientations_give_is_no_further_one(told):
    """|G|^2 = A^2 p^2 + B^2 q^2 + C^2 r^2 is the sum of the squares of G's components in space, which problem 7 has."""
    loaded = mbsym.loads(FREE_BODY.split("    speeds")[0] + f"    {told}\n")
    assert sum("momentum" in one.name for one in loaded.integrals) == 3
    found = loaded.polynomial_integrals.integrals
    assert not found.new
    assert [one.name for one in found.generators if one.independent][-1] == FUNCTION
    assert not beyond(loaded)


def test_of_a_symmetric_body_its_rate_about_the_axis_follows_too():
    """A = B = 1: |G|^2 - 2 T = C (C - 1) r^2, so that r is a function of what problem 7 has."""
    there = setting(mbsym.loads(FREE_BODY), {"A": Fraction(1), "B": Fraction(1)})
    found = integrals_of(there, 2)
    assert [(one.weight, one.name) for one in found.generators] == [(1, FUNCTION), (2, "generalised energy")]


def test_euler_bodys_families_hold_it_all_the_same():
    """Of K = T + lambda |G|^2: rotations about each axis are steady, with lambda = -1/(2 A) or its like."""
    found = mbsym.loads(FREE_BODY).invariant_sets
    steady = {one.free for family in found.families for one in family.sets if one.union == 1}
    assert steady == {("p",), ("q",), ("r",)}


def test_exponentials_and_angles_are_told_apart_as_functions():
    """cosh(x - y) + cos z: energy, x' + y' and z'^2/2 + cos z are independent, though exp(x - y) exp(y - x) = 1."""
    one = "  - {name: NAME, attached to: 0, connection point: [NAME, 0, 0], mass: 1, coordinates: [NAME]}\n"
    text = "mbsym: 1\nname: walls\nbodies:\n" + "".join(one.replace("NAME", x) for x in "xyz")
    found = mbsym.loads(text + "loads:\n  - potential: cosh(x - y) + cos(z)\n").polynomial_integrals.integrals
    assert found.independent == 3
    assert all(one.independent and one.certainty.value == "proved" for one in found.generators)
