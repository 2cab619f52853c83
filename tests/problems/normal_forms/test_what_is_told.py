"""Problem 11 in files: schemas, and sentences in other languages."""

from __future__ import annotations

import json
import re
from fractions import Fraction

import pytest
from conftest import SHIPPED
from jsonschema import Draft202012Validator
from terminal import told

import mbsym
from mbsym.analysis.judge import exceptional
from mbsym.mechanics.rest import given_values
from mbsym.problems.normal_forms.result import NormalForms, Outcome, Theorem, Why
from mbsym.report.messages import messages
from mbsym.report.plain_writer import Writer
from mbsym.report.results_json import render
from mbsym.report.schemas import schema
from mbsym.report.targets import TARGETS
from mbsym.report.words.exceptional_values import VANISHING, as_text
from mbsym.report.words.normal_form_words import LINEAR, REASONS, THEOREMS, sentences

SOFT = """
mbsym: 1
name: soft
parameters: {w: {sign: positive}}
bodies:
  - {name: slider, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - {potential: w**2*x**2/2}
  - {generalized force: {x: "FORCE"}}
motion: {x: 0}
values: {w: 2}
"""


#: Forces that both take and give energy, which decides nothing then.
MIXED, FIFTH = "x**2*x_dot/2 - x_dot**3", "x*x_dot**4 + x_dot**5"


def systems() -> dict[str, mbsym.Analysis]:
    found = {
        name: mbsym.load(SHIPPED / f"{name}.yaml", (6, 11))
        for name in ("three-bodies", "heavy-top", "ziegler", "spring-pendulum")
    }
    for force in (MIXED, FIFTH, "x*x_dot**2 + x_dot**3"):
        found[force] = mbsym.loads(SOFT.replace("FORCE", force), (6, 11))
    found["no numbers"] = mbsym.loads(SOFT.replace("FORCE", "-w*x_dot").replace("values: {w: 2}\n", ""), (6, 11))
    return found


def test_results_follow_the_schema() -> None:
    for name, analysis in systems().items():
        content = json.loads(render(analysis, (6, 11)))
        wrong = [x.message for x in Draft202012Validator(schema("results")).iter_errors(content)]
        assert wrong == [], name
        assert "normal_forms" in content


def test_exceptional_values_follow_the_schema() -> None:
    for name, parameter, ends in (("three-bodies", "mu", (0, 1)), ("ziegler-damped", "P", (0, 10))):
        analysis = mbsym.load(SHIPPED / f"{name}.yaml")
        values = given_values(analysis.system, {})
        found = exceptional(analysis, parameter, (Fraction(ends[0]), Fraction(ends[1])), values)
        content = json.loads(as_text(analysis.system, found))
        assert [x.message for x in Draft202012Validator(schema("nonlinear")).iter_errors(content)] == []
        assert len(content["between"]) == len(content["values"]) + 1


def test_the_words_of_the_schemas_are_those_of_the_code() -> None:
    judged = schema("results")["properties"]["normal_forms"]["properties"]["at_values"]["oneOf"][1]["properties"]
    other = schema("nonlinear")["properties"]["between"]["items"]["properties"]
    for one in (judged, other):
        assert set(one["verdict"]["enum"]) == {x.value for x in Outcome}
        assert set(one["theorem"]["enum"]) == {x.value for x in Theorem}
        assert set(one["reason"]["enum"]) == {x.value for x in Why}
    assert set(REASONS) == set(Why) - {Why.NONE}
    assert set(THEOREMS) == set(Theorem) - {Theorem.NONE, Theorem.FIRST, Theorem.FOURTH, Theorem.REDUCTION}
    assert len(set(VANISHING.values())) == len(VANISHING)


@pytest.mark.parametrize("language", ["ru", "es"])
def test_every_sentence_has_another_language(language: str) -> None:
    told = {*REASONS.values(), *THEOREMS.values()}
    for analysis in systems().values():
        found: NormalForms = analysis.normal_forms
        told |= {one.text for one in sentences(found) if one.text != "$[[symbol]] = [[value]]$."}
    assert {("", text) for text in told} <= set(messages(language))


def test_something_is_told_where_nothing_is_decided() -> None:
    """x'' + w^2 x = x x'^4 + x'^5: no sign of a coefficient that is zero is asked for; without numbers it says so."""
    of = {name: " ".join(one.text for one in sentences(x.normal_forms)) for name, x in systems().items()}
    assert "the amplitude of [[name]] is without a term of third order for all parameters" in of[FIFTH]
    assert "if this rate is negative" not in of[FIFTH]
    assert "if this rate is negative" in of[MIXED]
    assert "Where sum, product" in of["three-bodies"]
    assert "Where sum, product" not in of["spring-pendulum"]  # a minimum of the potential energy, for all parameters
    assert "For all parameters problem 6 has decided already: [[word]]." in of["spring-pendulum"]
    assert of["no numbers"] == "There is no formula in parameters here; with numbers for all of them it may be decided."


def test_numbers_are_needed_of_what_formulas_hold_only() -> None:
    """A name that stands nowhere needs no number for a verdict; of one that stands in a load its lack is told."""
    unused = mbsym.loads(SOFT.replace("FORCE", "-x_dot").replace("{w:", "{idle: {sign: real}, w:", 1), (6,))
    assert any(
        re.match("At the given values of the parameters, decided exactly: asymptotically stable", x)
        for x in told(unused, 6)
    )
    lacking = mbsym.loads(SOFT.replace("FORCE", "-c*x_dot").replace("{w:", "{c: {sign: real}, w:", 1), (6,))
    none = "At the given values of the parameters nothing is said of stability: without a value is c."
    assert none in told(lacking, 6)
    assert "nothing is said of stability: without a value is $c$." in TARGETS["latex"].render(lacking, (6,))
    assert lacking.stability.numerical is None


SPHERICAL = """
mbsym: 1
name: spherical pendulum
parameters: {g: positive}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3, 1], angles: [psi, theta]}, mass centre: [0, 0, -1], mass: 1,
     inertia: [0, 0, 0]}
loads: [{uniform gravity: {vector: [0, 0, -g]}}]
motion: {psi: 0, theta: 0}
values: {g: 10}
"""


@pytest.mark.parametrize("force", ["", ", {damper: {coordinate: psi, coefficient: g}}"])
def test_where_coordinates_are_singular_that_is_the_reason(force: str) -> None:
    """T = theta'^2/2 + sin(theta)^2 psi'^2/2: no momenta at theta = 0, with and without applied forces."""
    hanging = mbsym.loads(SPHERICAL.replace("}}]", "}}" + force + "]"), (6, 11))
    told = [one.text for one in sentences(hanging.normal_forms)]
    assert REASONS[Why.SINGULAR_MASS] in told
    assert hanging.normal_forms.at_values.outcome is Outcome.UNDECIDED


ROTATING = """
mbsym: 1
name: particle in a rotating plane
parameters: {Om: positive}
prescribed: {phi: Om}
bodies:
  - {name: plane, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0}
  - {name: particle, attached to: plane, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - {potential: x**2/8 + y**2/8}
motion: {}
values: {Om: 3/2}
"""
SPRINGS = """
mbsym: 1
name: two springs
bodies:
  - {name: particle, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - {potential: x**2/2 + y**2 + x**2*y}
motion: {}
"""


def test_a_determinant_without_parameters_is_not_said_to_vanish_where_one_is_zero():
    """Frequencies 1 and sqrt(2), which no parameter changes: no condition on parameters can be told.

    Linear equations have the normal form H2 alone: D4 is zero for all parameters, and decides nothing.
    """
    told = told_of(SPRINGS)
    assert "it vanishes for no parameters" in told
    assert "it vanishes where" not in told
    assert "The resonance" not in told
    told = told_of(ROTATING)
    assert "$D_4$ is zero for all parameters" in told
    assert "it vanishes where" not in told
    assert "the motion is stable (Arnold-Moser) but for" not in told


def told_of(description: str) -> str:
    analysis = mbsym.loads(description, (11,))
    return "\n".join(one.text for one in sentences(analysis.normal_forms))


def test_what_parameters_of_their_signs_cannot_make_zero_is_not_told_to_vanish():
    """Potential x^2/2 + y^2 + k x^4/4: the mean of k x^4/4 is 3 k I^2/8, so that D4 = (3 k/8) 2 = 3 k/4 by hand."""
    quartic = SPRINGS.replace("x**2*y", "k*x**4/4").replace("bodies:", "parameters: {k: SIGN}\nbodies:")
    told = told_of(quartic.replace("SIGN", "positive"))
    assert "it vanishes for no parameters" in told
    assert "it vanishes where" in told_of(quartic.replace("SIGN", "real"))


def test_a_resonance_is_one_of_real_frequencies():
    """x'' = 2 g y' + a^2 x, y'' = -2 g x' + a^2 y: frequencies g +- sqrt(g^2 - a^2).

    They are 1:2 at 9 a^2 = 8 g^2, 1:3 at 4 a^2 = 3 g^2.  Of ratios -1:2, which are none, it would be a^2 + 8 g^2.
    """
    text = SPRINGS.replace("x**2*y", "x**4 + x**2*y").replace("x**2/2 + y**2", "-a**2*(x**2 + y**2)/2")
    text = text.replace("bodies:", "parameters: {a: real, g: real}\nbodies:")
    text = text.replace("loads:\n", "loads:\n  - {generalized force: {x: 2*g*y_dot, y: -2*g*x_dot}}\n")
    vanishing = mbsym.loads(text, (11,)).normal_forms.in_symbols.vanishing
    told = {ratio: str(formula) for ratio, formula in vanishing.resonances}
    assert told == {(1, 2): "9*a**2 - 8*g**2", (1, 3): "4*a**2 - 3*g**2"}


DRIVEN = """
mbsym: 1
name: an oscillator and one that is damped
bodies:
  - {name: particle, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - {potential: x**2/2 + y**2}
  - {generalized force: {y: -y_dot, x: -x*y}}
motion: {}
"""


def test_higher_terms_are_not_said_to_decide_where_there_are_none():
    """x'' + x = -x y, y'' + y' + 2 y = 0: y = 0 is the centre manifold, on it x'' + x = 0: no term of any order."""
    told = told_of(DRIVEN)
    assert "order decide." not in told
    assert "may decide" in told


def test_formal_stability_is_no_matter_where_problem_6_has_proved_more():
    """Turning axes about z, V = (x^2 + y^2)/10 + z^2/7 + r^4/4 + z^4/4: at rest in space a minimum: stable."""
    analysis = mbsym.loads(
        """
mbsym: 1
name: particle
parameters: {n: positive}
prescribed: {phi: {rate: n}}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0}
  - {name: particle, attached to: table, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - potential: (x**2 + y**2)/10 + z**2/7 + (x**2 + y**2)**2/4 + z**4/4
motion: {x: 0, y: 0, z: 0}
values: {n: 1}
""",
        (6, 11),
    )
    found = analysis.normal_forms
    assert found.at_values is not None
    assert found.at_values.outcome is Outcome.FORMAL
    assert found.first is not None
    assert found.first.stable
    assert "problem 6 has decided already" in "\n".join(one.text for one in sentences(found))


def test_pi_in_the_coefficients_is_no_failure():
    """x'' + 2 pi x + x'^3 = 0: a = -3 w^2/8, but over square roots of numbers there is no pi to prove it with."""
    text = SOFT.replace("w**2*x**2/2", "pi*x**2").replace("FORCE", "-x_dot**3").replace("{w: {sign: positive}}", "{}")
    found = mbsym.loads(text.replace("values: {w: 2}\n", ""), (6, 11)).normal_forms
    assert found.at_values is not None
    assert found.at_values.why is Why.IRRATIONAL
    assert "pi in the coefficients" in found.no_symbols


def test_a_free_particle_is_not_called_stable_for_lack_of_coordinates():
    """x'' = y'' = 0: a drift grows; without x and y, both cyclic, a form in no variables says nothing."""
    text = SPRINGS.replace("  - {potential: x**2/2 + y**2 + x**2*y}", "  - {potential: 0*x}")
    told = told_of(text)
    assert "nothing is left that could be judged" in told
    assert "stable" not in told


def test_of_a_linear_system_it_is_not_said_that_higher_terms_may_decide():
    """x'' + c x' + x = 0, y'' + y = 0: the pair of y is on the axis, and there are no other terms."""
    text = """
mbsym: 1
name: two oscillators
parameters: {c: positive}
motion: {x: 0, y: 0}
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: 0}
  - {name: b, attached to: a, connection point: [0, y, 0], coordinates: [y], mass: 1}
loads:
  - potential: (x**2 + y**2)/2
  - damper: {coordinate: x, coefficient: c}
"""
    said = " ".join(told(mbsym.loads(text), 11))
    assert "may decide" not in said
    assert "For all parameters problem 6 has decided already: stable." in said


PENNING = """
mbsym: 1
name: a charge in a quadrupole and a magnetic field
parameters: {w: positive, c: positive}
bodies:
  - {name: P, attached to: 0, connection point: [x, y, z], mass: 1, coordinates: [x, y, z]}
loads:
  - potential: w**2*(z**2 - (x**2 + y**2)/2)/2
  - generalized force: {x: c*y_dot, y: -c*x_dot}
motion: {x: 0, y: 0, z: 0}
values: {w: 1, c: C}
"""


@pytest.mark.parametrize(("c", "relation"), [("2", "omega_1 + |omega_3| = 2 omega_2"), ("9/4", "omega_1 = 2 omega_2")])
def test_a_resonance_is_one_of_the_frequencies_that_stand_above_it(c, relation):
    """omega = (c +- sqrt(c^2 - 2 w^2))/2, the lower one of negative energy (H. Dehmelt's magnetron motion), and w.

    c = 2: the sum of the sizes is 2 w; c = 9/4: 2 is twice w.
    """
    found = mbsym.loads(PENNING.replace("C}", c + "}"), (6, 11)).normal_forms
    lines = [Writer().said(said) for said in sentences(found)]
    assert [float(x) for x in found.at_values.frequencies][2] < 0
    assert next(one for one in lines if one.startswith("A resonance of order")).endswith(f"exactly: {relation}.")


@pytest.mark.parametrize(
    ("force", "values", "linear"),
    [
        ("-c*x_dot", "{w: 2, c: 1, e: 1}", True),
        ("-c*x_dot", "{}", True),
        ("-c*x_dot - e*x**3", "{w: 2, c: 1, e: 0}", True),
        ("-c*x_dot - e*x**5", "{w: 2, c: 1, e: 1}", False),
    ],
)
def test_of_linear_equations_no_term_of_higher_order_is_said_to_decide(force: str, values: str, linear: bool) -> None:
    """A damped mass beside an undamped one, y'' + w^2 y = 0: there is nothing of second order or more."""
    text = SOFT.replace("FORCE", force).replace("values: {w: 2}", f"values: {values}")
    text = text.replace("w: {sign: positive}", "w: {sign: positive}, c: {sign: positive}, e: {}")
    text = text.replace(
        "loads:", "  - {name: b, attached to: 0, connection point: [0, y, 0], mass: 1, coordinates: [y]}\nloads:"
    )
    text = text.replace("w**2*x**2/2", "w**2*(x**2 + y**2)/2").replace("{x: 0}", "{x: 0, y: 0}")
    lines = [str(one.text) for one in sentences(mbsym.loads(text, (6, 11)).normal_forms)]
    # Of all values the energy decides, to which the force joins -e x^4/4: nothing is left to higher orders of others.
    assert any("higher order may decide" in one for one in lines) is not linear
    assert (LINEAR in lines) is linear
