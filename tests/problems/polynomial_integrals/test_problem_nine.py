"""Problem 9 in the pipeline: Kovalevskaya's top, Goryachev and Chaplygin's, and what reports say of them."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html import unescape
from itertools import product

import jsonschema
import pytest
from conftest import SHIPPED, filed, invoked

import mbsym
from mbsym.analysis import polynomial
from mbsym.analysis.pipeline import Analysis
from mbsym.formulas.formula import Formula
from mbsym.problems.polynomial_integrals.relations import linear_relations
from mbsym.report.plain_writer import Writer
from mbsym.report.schemas import schema
from mbsym.report.words import integrals_words

KOVALEVSKAYA = (SHIPPED / "kovalevskaya.yaml").read_text(encoding="utf-8")
CHAPLYGIN = KOVALEVSKAYA.replace("[2*C, 2*C, C]", "[4*C, 4*C, C]").split("claims:")[0]


@pytest.fixture(scope="module")
def kovalevskaya():
    return Analysis(mbsym.loads(KOVALEVSKAYA).system, problems=(9,))


def test_kovalevskayas_integral_is_the_fourth(kovalevskaya):
    result = kovalevskaya.polynomial_integrals
    assert [one.weight for one in result.integrals.generators] == [2, 3, 4, 4]
    assert [one.is_new for one in result.integrals.generators] == [False, False, False, True]
    assert (result.integrals.independent, result.integrals.complete) == (4, True)
    # Hers: (C (p^2 - q^2) - m g x0 gamma1)^2 + (2 C p q - m g x0 gamma2)^2 is a polynomial in those found.
    there = polynomial.setting(kovalevskaya)
    C, x0, m, g, p, q, g1, g2 = map(there.whole.generator, ("C", "x0", "m", "g", "p", "q", "gamma1", "gamma2"))
    hers = (C * (p**2 - q**2) - m * g * x0 * g1) ** 2 + (2 * C * p * q - m * g * x0 * g2) ** 2
    assert there.whole.derivative(hers) == 0
    energy, _, _, new = (one.polynomial for one in result.integrals.generators)
    assert energy**2 - 4 * hers == new


def test_a_mistake_is_found_by_the_self_check(kovalevskaya):
    result = kovalevskaya.polynomial_integrals
    assert kovalevskaya.check("polynomial integrals").outcome == "exact"
    ring = result.formulas[-1].ring
    wrong = Formula(ring, result.formulas[-1].polynomial + ring.generator("coordinate", "r"))
    other = Analysis(kovalevskaya.system, problems=(9,))
    other.polynomial_integrals  # noqa: B018
    other.stage(9)
    planted = replace(result, formulas=(*result.formulas[:-1], wrong))
    object.__setattr__(other, "optional", lambda name: planted if name == "polynomial_integrals" else None)
    assert polynomial.check(other).failed


def test_problem_seven_goes_on_with_what_is_found():
    """Both asked for: one list, and hers in it as proved; alone, problem 7 says what it said."""
    system = mbsym.loads(KOVALEVSKAYA).system
    both, alone = Analysis(system, problems=(7, 9)), Analysis(system, problems=(7,))
    usual = [one.name for one in alone.stage(7).value]
    listed = both.stage(7).value
    assert [one.name for one in listed] == [*usual, "integral of weight 4"]
    assert (listed[-1].status, str(listed[-1].formula)) == ("proved", str(both.polynomial_integrals.formulas[-1]))
    assert [one.name for one in both.integrals] == usual  # what problem 9 stands on is as it was
    generic = Analysis(mbsym.load(SHIPPED / "euler-poisson.yaml").system, problems=(7, 9))
    assert [one.name for one in generic.stage(7).value] == usual


def test_what_problem_seven_goes_on_with_falls_with_the_check(monkeypatch):
    analysis = Analysis(mbsym.loads(KOVALEVSKAYA).system, problems=(7, 9))
    usual = analysis.integrals
    wrong = analysis.ring.generator("coordinate", "r")
    right = polynomial.Integral
    monkeypatch.setattr(
        polynomial,
        "Integral",
        lambda name, kind, of, f, status: right(name, kind, of, Formula(f.ring, f.polynomial + wrong), status),
    )
    assert analysis.stage(7).value == usual
    assert analysis.stage(9).failure.short == "withdrawn"


def test_goryachev_and_chaplygins_is_told_with_its_level(tmp_path):
    path = filed(tmp_path / "chaplygin.yaml", CHAPLYGIN)
    result = mbsym.load(path).polynomial_integrals
    assert result.integrals.new == ()
    assert [(one.level.weight, [w for w, _ in one.integrals]) for one in result.levels] == [(3, [3])]
    words = ["run", path, "-v", "--problems", "9", "--format", "json,latex,wolfram,html", "--language", "es"]
    done = invoked(*words, "--out", tmp_path / "out", code=0)
    assert "Peso 3, donde la de peso 3 (" in " ".join(done.output.split())
    data = json.loads((tmp_path / "out" / "results.json").read_text("utf-8"))
    jsonschema.validate(data, schema("results"))
    (level,) = data["polynomial_integrals"]["on_levels"]
    assert level["zero"] == "angular momentum about axis 3"
    for name in ("report.tex", "report.html"):
        assert "donde la de peso 3" in (tmp_path / "out" / name).read_text("utf-8")
    assert "polynomialIntegrals = {" in (tmp_path / "out" / "report.wl").read_text("utf-8")


def test_systems_in_angles_have_sines_and_cosines_for_variables():
    """The heavy top in Cardan angles: its energy and the momentum of phi, the area integral of degree four."""
    analysis = Analysis(mbsym.load(SHIPPED / "heavy-top.yaml").system, problems=(9,))
    result = analysis.polynomial_integrals
    assert result.integrals.field.variables[3:] == ("sin(alpha)", "cos(alpha)", "sin(beta)", "cos(beta)")
    assert result.integrals.new == ()
    assert result.integrals.complete
    assert [one.weight for one in result.integrals.generators] == [2, 3, 4]
    assert str(result.formulas[0]) in ("alpha_dot*sin(beta) + phi_dot", "phi_dot + alpha_dot*sin(beta)")
    # A damped pendulum keeps nothing.
    damped = Analysis(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, problems=(9,)).polynomial_integrals
    assert (damped.integrals.generators, damped.integrals.complete) == ((), True)


def test_a_wrong_sign_in_angles_is_found():
    analysis = Analysis(mbsym.load(SHIPPED / "double-pendulum.yaml").system, problems=(9,))
    there = polynomial.setting(analysis)
    (energy,) = [p for _, p in there.known]
    field = there.field
    assert field.reduced(field.derivative(energy)) == 0
    wrong = replace(field, numerators=(-field.numerators[0], *field.numerators[1:]))
    assert wrong.reduced(wrong.derivative(energy)) != 0
    assert polynomial.integrals_of(replace(there, field=wrong), 3).generators == ()


def test_every_sentence_has_its_translations():
    from mbsym.report.messages import messages
    from mbsym.report.words import integrals_words

    said = {integrals_words.LISTED, integrals_words.LEVEL, integrals_words.OPENING, *integrals_words._NONE.values()}
    said |= {*integrals_words._DEPENDENT.values(), *integrals_words._NONE_BUT_LENGTHS.values()}
    for language in ("ru", "es"):
        assert {("", text) for text in said} <= set(messages(language))


def test_goryachev_and_chaplygins_integral_holds_on_the_level_of_the_area_integral():
    """D. N. Goryachev (1900): r (p^2 + q^2) - m g x0/C p gamma3 for A = B = 4 C, gamma upwards."""
    found = mbsym.load(SHIPPED / "goryachev-chaplygin.yaml")
    result = found.polynomial_integrals
    assert not any(one.is_new for one in result.integrals.generators)
    assert [one.level.name for one in result.levels] == ["angular momentum about axis 3"]
    ((integral,),) = result.on_levels
    assert str(integral) == "C*(p**2 + q**2)*r - x0*m*g*p*gamma3"
    # The initial state of the file is on that level: 4 q gamma2 + r gamma3 = 4 (-12/25)(4/5) + (64/25)(3/5) = 0.
    other = (SHIPPED / "goryachev-chaplygin.yaml").read_text(encoding="utf-8").replace("4*C", "5*C")
    assert mbsym.loads(other).polynomial_integrals.levels == ()


def test_hess_relation_of_the_shipped_file():
    """A x0 p + C z0 r divides its derivative (W. Hess, 1890); with another second moment of inertia nothing does."""
    text = (SHIPPED / "hess-appelrot.yaml").read_text(encoding="utf-8")
    there = polynomial.setting(mbsym.loads(text))
    found = linear_relations(there.field, (1, 1, 1, 2, 2, 2), ["A", "C", "x0", "z0", "m", "g"])
    assert [str(there.formula(one.polynomial)) for one in found.relations] == ["A*x0*p + C*z0*r"]
    assert found.complete
    other = polynomial.setting(mbsym.loads(text.replace("[A, A*C*(x0**2 + z0**2)", "[A, A*C*(x0**2 + 2*z0**2)")))
    assert linear_relations(other.field, (1, 1, 1, 2, 2, 2), ["A", "C", "x0", "z0", "m", "g"]).relations == ()


def test_a_symmetry_with_gamma_gives_the_energy_that_problem_7_finds(tmp_path):
    """A cart that is pushed by a constant F: t -> t + s changes L by d(F x)/dt, so that the energy less F x is kept."""
    words = ["run", SHIPPED / "cart-pendulum.yaml", "--problems", "7,9", "--format", "json"]
    invoked(*words, "--out", tmp_path, code=0)
    symmetries = json.loads((tmp_path / "results.json").read_text("utf-8"))["polynomial_integrals"]["symmetries"]
    assert [(one["field"], one["gauge"], one["new"]) for one in symmetries["symmetries"]] == [({}, "F*x", False)]


ELLIPSES = """
mbsym: 1
name: Ellipses that turn into each other
parameters: {m: positive, k: positive}
bodies:
  - {name: one, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: two, attached to: 0, mass: 4*m, connection point: [y, 0, 0], coordinates: [y]}
loads:
  - potential: k*(x**2 + 4*y**2)/2
"""


def test_symmetries_are_in_the_reports(tmp_path):
    """L of x and 2 y is that of an isotropic oscillator: no change when they turn, (x, y) moving as (-4 y, x)."""
    (tmp_path / "ellipses.yaml").write_text(ELLIPSES, encoding="utf-8")
    words = ["run", tmp_path / "ellipses.yaml", "--problems", "7,9", "--format", "json,latex,html,python"]
    invoked(*words, "--language", "ru", "--out", tmp_path, code=0)
    data = json.loads((tmp_path / "results.json").read_text("utf-8"))
    jsonschema.validate(data, schema("results"))
    symmetries = data["polynomial_integrals"]["symmetries"]
    fields = [(one["field"], one["new"]) for one in symmetries["symmetries"]]
    assert fields == [({}, False), ({"x": "-4*y", "y": "x"}, True)]
    tex = (tmp_path / "report.tex").read_text("utf-8")
    assert "$\\xi_{x} = -4 y$, $\\xi_{y} = x$ даёт новый интеграл" in tex
    page = unescape(re.sub(r"<[^>]+>|\s", "", (tmp_path / "report.html").read_text("utf-8")))
    assert "ξx=\u22124y,ξy=xдаётновыйинтеграл" in page.replace("\u2062", "")
    assert "integral of the symmetry x: -4*y" in (tmp_path / "model.py").read_text("utf-8")


def test_symmetries_that_are_denied():
    """Friction ends the symmetry in time, though not that of L; what problem 7 lists is not called new."""
    damped = Analysis(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, problems=(9,)).polynomial_integrals
    assert damped.symmetries is not None
    assert (damped.symmetries.symmetries, damped.symmetries.complete) == ((), True)
    sphere = Analysis(mbsym.load(SHIPPED / "spherical-pendulum.yaml").system, problems=(9,)).polynomial_integrals
    assert sphere.symmetries is not None
    assert [one.name for one in sphere.symmetries.symmetries] == ["momentum of psi", "generalised energy"]


def test_sentences_of_symmetries_have_their_translations():
    from mbsym.problems.symmetries.search import Symmetries
    from mbsym.report.messages import messages
    from mbsym.report.words import symmetry_words

    found = Analysis(mbsym.load(SHIPPED / "spherical-pendulum.yaml").system, problems=(9,)).polynomial_integrals
    listed = found.symmetries.symmetries
    said = {
        symmetry_words.LOOKED_FOR,
        symmetry_words.KNOWN,
        symmetry_words.DEPENDS,
        symmetry_words.GIVES,
        symmetry_words.OPEN,
    }
    for some, complete, symbols, compared in product((listed, ()), *[(True, False)] * 3):
        given = Symmetries(some, complete, 3, False, symbols, compared)
        told = list(symmetry_words.sentences(given))
        said |= {one.text for one in told} | {one.gaps["proof"].text for one in told if "proof" in one.gaps}
    for language in ("ru", "es"):
        assert {("", text) for text in said} <= set(messages(language))


def test_integrals_with_positions_that_no_equation_contains_are_said_not_to_be_sought():
    """A charge in a uniform magnetic field keeps x' - B y: "every polynomial integral" is not said without a word."""
    charge = """
mbsym: 1
name: charge
parameters: {B: positive}
bodies:
  - {name: P, attached to: 0, connection point: [q_1, y, 0], mass: 1, coordinates: [q_1, y]}
loads:
  - {generalized force: {q_1: B*y_dot, y: -B*q_1_dot}}
"""
    analysis = Analysis(mbsym.loads(charge).system, problems=(9,))
    told = [Writer().said(one) for one in integrals_words.sentences(analysis.polynomial_integrals.integrals)]
    assert "The equations do not contain q_1, y: integrals that do are not looked for here." in told
    linear = Analysis(mbsym.loads(charge.replace("q_1: B*y_dot", "q_1: -q_1").replace("-B*q_1_dot", "-y")).system)
    assert not any("do not contain" in x.text for x in integrals_words.sentences(linear.polynomial_integrals.integrals))
