"""Problem 12 in every report: what is said, what is measured, and what is told where there is nothing to expand."""

from __future__ import annotations

import json
import re

import jsonschema
import pytest
from conftest import SHIPPED
from terminal import told

import mbsym
from mbsym.algebra.quotients import Series
from mbsym.analysis import Analysis
from mbsym.analysis.expanding import expansion
from mbsym.report.language import Language
from mbsym.report.schemas import schema
from mbsym.report.sections import small_parameters
from mbsym.report.targets import TARGETS
from mbsym.report.words import expansion_words
from mbsym.simulation.expanded import measured


@pytest.fixture(scope="module")
def damper():
    return Analysis(mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml").system, (12,))


@pytest.fixture(scope="module")
def shaken():
    return Analysis(mbsym.load(SHIPPED / "shaken-pendulum.yaml").system, (12,))


def text(analysis, target):
    return TARGETS[target].render(analysis, (12,))


def test_the_damper_as_json(damper):
    """Order 3, with which friction comes in; the error of the flow is of order 4."""
    data = json.loads(text(damper, "json"))
    jsonschema.validate(data, schema("results"))
    found = data["small_parameters"]
    assert (found["small"], found["slow_manifold"]["order"], found["averaged"]) == ("eps", 3, [])
    assert found["slow_manifold"]["steady"]["flow"]["positive"] == ["(s*omega + eta)*(s*omega + eta - omega)"]
    assert found["measured"]["expected"] == 4
    assert found["measured"]["orders"] == pytest.approx([4, 4], abs=0.1)


def test_a_planted_error_is_seen_in_the_measured_order(damper):
    """The correction of order 2 of omega' with another sign: the distance shrinks like eps^2 only."""
    found = expansion(damper, 2)
    flow = list(found.manifold.flow)
    one = flow[2]
    flow[2] = Series(one.context, {**one.coefficients, 2: -one.coefficients[2]}, one.known)
    object.__setattr__(found.manifold, "flow", tuple(flow))
    assert measured(damper.system, found, 5.0).orders[-1] == pytest.approx(2, abs=0.2)  # the right one: 3


def test_kapitza_as_json(shaken):
    data = json.loads(text(shaken, "json"))
    jsonschema.validate(data, schema("results"))
    found = data["small_parameters"]
    assert (found["small"], found["slow_manifold"], found["measured"]) == (None, None, None)
    (one,) = found["averaged"]
    assert one["vibrational"] == "-m*h**2*nu**2*cos(theta)**2/4"
    assert one["averaged_motion_at_values"] == "stable"
    assert one["measured"]["orders"] == pytest.approx([1, 1], abs=0.1)


def test_where_there_is_nothing_to_expand_it_is_told_and_nothing_fails():
    for name in ("simple-pendulum", "clebsch-poisson"):
        analysis = Analysis(mbsym.load(SHIPPED / f"{name}.yaml").system, (12,))
        assert analysis.stage(12).failure is None
        assert told(analysis, 12) == [expansion_words.NOTHING]
        assert "nothing is expanded" in " ".join(text(analysis, "latex").split())


def test_a_small_parameter_in_coordinates_says_what_is_missing():
    source = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")
    name = mbsym.loads(source).system.parameter_names[0]
    analysis = Analysis(mbsym.loads(f"{source}\nsmall parameter: {name}\n").system, (12,))
    slow, further = told(analysis, 12)
    assert further.startswith(f"No periodic solution was expanded in powers of {name}: the equations are not quasi-li")
    assert slow == (
        f"No slow manifold was found in powers of {name}: sin(theta), cos(theta) are variables: slow manifolds are "
        "expanded in positions and velocities that stand by themselves."
    )


def test_latex_html_and_wolfram_hold_the_coefficients(damper):
    latex, page, wolfram = (text(damper, target) for target in ("latex", "html", "wolfram"))
    assert re.search(r"\{\\dot\{p\}\}\^\{\(0\)\} = ", latex)
    assert page.count("<msup>") > 10
    assert 'slowFlow = {{"p", 0, ' in wolfram.replace("\n", "")


@pytest.mark.parametrize("language", ["ru", "es"])
def test_every_sentence_is_said_in_other_languages(language, damper, shaken):
    tongue = Language(language)
    listed = [expansion_words.NOTHING, *expansion_words._FAST.values(), *expansion_words._SLOW.values()]
    for analysis in (damper, shaken):
        found = small_parameters.told(analysis.small_parameters, analysis.system)
        listed += [one.text for block in found for one in getattr(block, "parts", ())]
    for sentence in listed:
        assert tongue.sentence(sentence) != sentence
        gaps = re.compile(r"\[\[\w+\]\]")
        assert set(gaps.findall(tongue.sentence(sentence))) == set(gaps.findall(sentence))
