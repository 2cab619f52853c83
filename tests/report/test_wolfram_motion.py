"""What report.wl gives NDSolve, evaluated by Mathics at the initial state, against d'Alembert's principle there."""

from __future__ import annotations

import json
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, derived
from test_reports import uncommented
from truth_at_states import Point, truth

import mbsym
from mbsym.analysis import Analysis
from mbsym.numerics.scenario import scenario
from mbsym.report.targets import TARGETS


def numbers(mathics: Any, expression: str) -> Any:
    text = str(mathics.evaluate(f"N[{expression}]")).replace("*^", "e")
    return np.array(json.loads(text.replace("{", "[").replace("}", "]")), float)


def expected(analysis: Analysis) -> Any:
    """q'' at t = 0 in the description's initial state, at its values."""
    found = scenario(analysis.system)
    parameters = tuple(float(found.parameters[name]) for name in analysis.system.parameter_names)
    state = tuple(float(Fraction(value)) for value in found.state)
    return truth(analysis, Point(0.0, state, parameters))["accelerations"]


#: The accelerations that the equations have at the initial conditions.
AT_START = """
    rules = Map[(First[#] -> Last[#]) &, initialConditions];
    both = N[({massMatrix, forcing} /. rules) //. Join[values, RELATIONS]];
    LinearSolve[both[[1]], both[[2]]]
"""


@pytest.mark.parametrize("name", ["double-pendulum"])
def test_equations_and_initial_conditions_give_the_accelerations(name: str, mathics: Any) -> None:
    analysis = derived(SHIPPED / f"{name}.yaml")
    report = uncommented(TARGETS["wolfram"].render(analysis, (3,)))
    assert "mbsymSolution[tEnd_] := NDSolve[Join[equations, initialConditions]" in report
    mathics.reset()
    mathics.evaluate("t = 0")
    mathics.evaluate(f"({report})")
    own = AT_START.replace("RELATIONS", "relations" if analysis.system.relations else "{}")
    assert numbers(mathics, f"({own})") == pytest.approx(expected(analysis), rel=1e-12)


@pytest.mark.parametrize("name", ["double-pendulum", "satellite-with-damper-driven"])
def test_the_program_gives_the_same(name: str, mathics: Any) -> None:
    """Where equations are too long to be printed whole: mbsymRate, which NDSolve calls."""
    whole = derived(SHIPPED / f"{name}.yaml")
    report = uncommented(TARGETS["wolfram"].render(Analysis(whole.system, terms=3), (3,)))
    assert "equations =" not in report
    n, wanted = len(whole.system.coordinates), expected(whole)

    def rate(text: str) -> Any:
        mathics.reset()
        mathics.evaluate(f"({text})")
        return numbers(mathics, "mbsymRate[0., mbsymInitial]")

    state = [float(value) for value in scenario(whole.system).state]
    assert rate(report) == pytest.approx([*state[n:], *wanted], rel=1e-12)
    assert "mbsymSolution[tEnd_] := NDSolveValue[" in report
    changed = re.sub(r"(s\d+) = (.*)\*(.*);", r"\1 = \2 + \3;", report, count=1)
    assert changed != report
    assert rate(changed)[n:] != pytest.approx(wanted, rel=1e-9)


def test_series_as_functions_of_the_time(mathics):
    """x'' = -x - eps x^3, to eps^2, by hand at the phase 0 and by its rate 1 + 3/8 eps a^2 - 21/256 eps^2 a^4."""
    analysis = Analysis(
        mbsym.loads(
            "mbsym: 1\nname: Duffing\nparameters: {eps: positive}\nsmall parameter: eps\nbodies:\n"
            "  - {name: mass, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
            "loads:\n  - potential: x**2/2 + eps*x**4/4\n"
        ).system,
        (12,),
    )
    (line,) = re.findall(r"^periodicSolutionOf = .*$", TARGETS["wolfram"].render(analysis, (12,)), re.MULTILINE)
    mathics.evaluate(line)
    rate = 1 + 3 / 8 * 0.1 - 21 / 256 * 0.01
    for phase, x in ((0, 1), (2 * np.pi, 1), (np.pi, -1)):
        at = f"/. {{eps -> 0.1, amplitude -> 1, t -> {phase / rate:.15f}}}"
        assert numbers(mathics, f'("x" /. periodicSolutionOf) {at}') == pytest.approx(x, abs=1e-12)
        assert numbers(mathics, f'("x\'" /. periodicSolutionOf) {at}') == pytest.approx(0, abs=1e-12)
