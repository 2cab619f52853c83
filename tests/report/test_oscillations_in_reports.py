"""Periodic solutions of problem 12 in every report: Duffing, van der Pol by the textbook, and where there is none.

Duffing (A. Nayfeh, Perturbation Methods, section 3.1): omega = w + 3 eps a^2/(8 w) - ...  Van der Pol's equation
x'' + x = eps (k - x^2) x' has the amplitude 2 sqrt(k) (energy balance over a period: k a^2/2 = a^4/8).
"""

from __future__ import annotations

import json
import re
from fractions import Fraction
from math import cos, log2, sin

import jsonschema
import numpy as np
import pytest
from conftest import SHIPPED
from scipy.integrate import solve_ivp
from terminal import told

import mbsym
from mbsym.analysis import Analysis
from mbsym.analysis.oscillating import oscillating
from mbsym.report.content import Said
from mbsym.report.language import Language
from mbsym.report.schemas import schema
from mbsym.report.sections import small_parameters
from mbsym.report.targets import TARGETS
from mbsym.report.words.expansion_measured import orders_or_why

POINT = """mbsym: 1
name: A point
parameters: {{w: {{sign: positive}}, eps: {{sign: positive}}, k: {{sign: {sign}}}}}
small parameter: {small}
bodies:
  - {{name: mass, attached to: 0, connection point: [{place}], mass: 1, coordinates: [{names}]}}
loads:
  - potential: w**2*x**2/2 {potential}
  - generalized force: {{x: {force}}}
{more}
"""
NUMBERS = "values: {w: 2, eps: 1/5, k: 1}\ninitial: {x: {position: %s, velocity: 0}}"


def point(potential="", force="0", small="eps", sign="real", more="", names="x", place="x, 0, 0"):
    values = {"potential": potential, "force": force, "small": small, "sign": sign}
    return Analysis(mbsym.loads(POINT.format(**values, more=more, names=names, place=place)).system, (12,))


def said(analysis):
    return " ".join(told(analysis, 12))


@pytest.fixture(scope="module")
def duffing():
    return point("+ eps*x**4/4", more=NUMBERS % 1)


@pytest.fixture(scope="module")
def limit_cycle():
    return point(force="eps*(k - x**2)*x_dot", more=NUMBERS % 0)


def test_duffing_as_json(duffing):
    data = json.loads(TARGETS["json"].render(duffing, (12,)))
    jsonschema.validate(data, schema("results"))
    found = data["small_parameters"]
    assert (found["slow_manifold"], found["no_oscillation"]) == (None, "")
    found = found["oscillation"]
    assert found["corrections"] == ["3*amplitude**2/(8*w**2)", "-21*amplitude**4/(256*w**4)"]
    assert (found["amplitude"]["kind"], found["conditions"]) == ("free", [])
    assert [one["order"] for one in found["measured"]["errors"]] == pytest.approx([3, 3], abs=0.1)


def test_duffing_as_python_latex_html_and_wolfram(duffing):
    latex, page, wolfram, source = (TARGETS[x].render(duffing, (12,)) for x in ("latex", "html", "wolfram", "python"))
    space = {"__name__": "model"}
    exec(compile(source, "model.py", "exec"), space)
    found = space["small_parameters"]({"w": 2.0, "amplitude": 0.5, "phase": 0.3, "k": 1.0, "eps": 0.2})
    assert found["periodic solution: phase', order 0"] == 2
    assert found["periodic solution: phase', order 1"] == pytest.approx(3 * 0.5**2 / 16)
    assert "{x}^{(0)} = " in latex
    assert r"{\dot{x}}^{(1)} = " in latex
    assert "2^k" not in latex
    assert '"phase\'", 1, ' in wolfram
    assert "Periodic solution up to order" in page


#: Duffing, with the parameter eps, and with a small deviation x = eps X: the same with a^2 eps in place of eps.
SMALL = ["eps", "{size: {powers: {x: 1}}}"]


@pytest.mark.parametrize("small", SMALL)
def test_series_are_functions_of_the_time(small):
    """Against x'' = -w^2 x - eps x^3 from x = a: beyond the second order errors are of the third, over times of 1."""
    by_power = small != "eps"
    analysis = point("+ x**4/4" if by_power else "+ eps*x**4/4", small=small)
    space = {"__name__": "model"}
    exec(compile(TARGETS["python"].render(analysis, (12,)), "model.py", "exec"), space)
    times, errors = np.linspace(0, 9, 40), []
    for eps in (0.1, 0.05):
        values = {"w": 2.0, "amplitude": 0.8, "size" if by_power else "eps": eps}
        told = space["periodic_solution"](times, values)
        factor, start = (1, eps * 0.8) if by_power else (eps, 0.8)
        told_start = space["periodic_solution"](0.0, values)
        run = solve_ivp(
            lambda t, z, factor=factor: (z[1], -4 * z[0] - factor * z[0] ** 3),
            (0, 9),
            (told_start["x"], 0.0),
            t_eval=times,
            rtol=1e-12,
            atol=1e-14,
        )
        assert told_start["x"] == pytest.approx(start, rel=1e-12)
        assert np.abs(told["x'"] - run.y[1]).max() < 0.1 * eps**3
        errors.append(np.abs(told["x"] - run.y[0]).max())
    assert log2(errors[0] / errors[1]) > 2.8
    data = json.loads(TARGETS["json"].render(analysis, (12,)))["small_parameters"]["oscillation"]
    names = {**values, "cos": cos, "sin": sin}
    names["phase"] = 1.5 * eval(data["phase_rate"], dict(names))
    (one,) = (x for x in data["solution"] if x["variable"] == "x")
    at = float(space["periodic_solution"](1.5, values)["x"])
    assert eval(one["function"], names) == pytest.approx(at, rel=1e-12)


def test_a_solution_that_leaves_nothing_is_periodic_in_all_orders(duffing):
    """x = 0, y'' = -6 y: of no higher order is it said that it is not looked at."""
    formal = "Whether some remain in higher orders"
    assert formal in said(duffing)
    led = point("+ 3*y**2 + eps*x**2*y", small="{eps: {leading: y}}", names="x, y", place="x, y, 0")
    assert "it leaves nothing (verified)." in said(led)
    assert formal not in said(led)


def test_an_amplitude_that_parameters_may_forbid(limit_cycle):
    """2 sqrt(k): told where it is real; not asked where k > 0 is known, refused where k < 0."""
    text = said(limit_cycle)
    assert "Secular terms are removed for certain amplitudes only. That of this solution" in text
    assert "The amplitude is real and not zero where k > 0." in text
    assert "The error of this solution was not measured" not in text  # it needs no x(0)
    assert "fall more slowly" not in text
    known = point(force="eps*(k - x**2)*x_dot", sign="positive")
    assert "real and not zero" not in said(known)
    refused = point(force="eps*(k - x**2)*x_dot", sign="negative")
    assert "only where the amplitude of x is imaginary: its square is < 0" in said(refused)
    assert refused.small_parameters.oscillation is None


def test_two_limit_cycles_are_not_called_one():
    """x'' + w^2 x = -eps (x^4 - 10 x^2 + 8) x': over a period a^4/16 - 10 a^2/8 + 8/2 = 0, a = 2 or 4."""
    found = point(force="-eps*(x**4 - 10*x**2 + 8)*x_dot")
    wave = found.small_parameters.oscillation
    assert abs(int(str(wave.formula(wave.oscillation.amplitude)))) in (2, 4)
    assert "for certain amplitudes only" in said(found)


def test_where_there_is_none_it_is_told_why(duffing):
    assert "No periodic solution was expanded in powers of eps: no periodic solution near those of the linear" in said(
        point("+ eps*x**4/4", "-eps*k*x_dot", sign="positive")
    )
    two = {"names": "x, y", "place": "x, y, 0"}
    text = said(point("+ 3*y**2/2 + eps*x**2*y**2", **two))
    assert "several frequencies are there, of: x_dot, x; y_dot, y; name a variable whose oscillation leads" in text
    led = point("+ 3*y**2/2 + eps*x**2*y**2", small="{eps: {leading: y}}", **two)
    assert led.small_parameters.oscillation.oscillation.leading == "y"
    damper = Analysis(mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml").system, (12,)).small_parameters
    assert (damper.oscillation, damper.no_oscillation) == (None, "")


@pytest.mark.parametrize("language", ["ru", "es"])
def test_in_other_languages(language, duffing, limit_cycle):
    tongue, gaps = Language(language), re.compile(r"\[\[\w+\]\]")
    for analysis in (duffing, limit_cycle):
        for block in small_parameters.told(analysis.small_parameters, analysis.system):
            for one in getattr(block, "parts", ()):
                assert isinstance(one, Said)
                assert tongue.sentence(one.text) != one.text
                assert set(gaps.findall(tongue.sentence(one.text))) == set(gaps.findall(one.text))


def test_numbers_that_are_put_in_are_measured_with(duffing):
    """w = 3 in place of 2: were the motion that of w = 2, the errors would not fall at all."""
    values = {"w": Fraction(3), "amplitude": Fraction(1, 2)}
    found = orders_or_why(duffing.system, oscillating(duffing, 2, values), values)
    assert found.orders == pytest.approx((3, 3), abs=0.1)
    wrong = orders_or_why(duffing.system, oscillating(duffing, 2, values), {})
    assert max(wrong.orders) < 1
