"""``mbsym show FILE accelerations`` under constraints: Maggi's equations solved, against multipliers and by hand."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from conftest import SHIPPED

import mbsym
from mbsym.analysis import Analysis
from mbsym.expressions.tree import Number
from mbsym.numerics.closing import begun
from mbsym.numerics.kernels import arrays
from mbsym.numerics.scenario import scenario
from mbsym.numerics.states import dynamics_of
from mbsym.report.formulas_by_name import MOST_SOLVED, accelerations, lines, written
from mbsym_cli.main import main
from tests.constrained.test_flow_on_the_manifold import CASES, analysed, masses, trailers

#: x = 1 + y^2 and x + y = 1 + sin t: nothing is free.
HELD = """
mbsym: 1
name: Held
parameters: {m: 1}
bodies:
  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
constraints:
  - relation: x - y**2 = 1
  - relation: x + y = sin(t) + 1
dependent: [x, y]
"""


def apart(analysis: Analysis, seed: int) -> float:
    """How far the formulas are from accelerations with multipliers, at a random state that is on the constraints."""
    system, source = analysis.system, Random(seed)
    given = {x: Number(Fraction(source.randint(-20, 20), 40)) for x in (*system.coordinates, *system.velocities)}
    parameters = {p.name: Number(Fraction(source.randint(5, 20), 10)) for p in system.parameters if p.value is None}
    place = begun(scenario(system, {**given, **parameters})).scenario
    dynamics = dynamics_of(place)
    rates = arrays.kernel(dynamics.right_hand_side)(np.array([0.0, *map(float, place.state)]))[-len(place.velocities) :]
    names = (*dynamics.inputs, *place.parameters)
    values = dict(zip(names, [0.0, *map(float, place.state), *map(float, place.parameters.values())], strict=True))
    values |= dict.fromkeys(system.input_names, 0.0)  # held at the motion
    values |= {name: float(start) for name, (start, _) in place.prescribed.items()}
    found = [x for x in lines(analysis, "accelerations") if x.relation == "=" and x.name]
    texts = [written(line, "python", str).partition(" = ")[2] for line in found]
    got = [eval(text, {**vars(math), **values}) for text in texts]
    return float(np.max(np.abs(np.array(got) - rates) / (1 + np.max(np.abs(rates)))))


NAMES = ("four-bar", "rolling-disc", "rolling-disc-speeds", "chaplygin-sleigh", "snakeboard", "cartesian-pendulum")


@pytest.mark.parametrize("name", [*NAMES, "segway"])
def test_they_are_those_with_multipliers(name: str) -> None:
    folder = CASES if name == "segway" else SHIPPED
    assert apart(Analysis(mbsym.load(folder / f"{name}.yaml").system), 1) < 1e-9


@pytest.mark.parametrize("kind", [trailers, masses])
def test_of_random_systems(kind: Any) -> None:
    tried = 0
    for seed in range(6):
        text = kind(Random(f"{kind.__name__} {seed}"), True)
        analysis = analysed(text) if text else None
        if analysis is not None and len(analysis.constraints.free) <= MOST_SOLVED:
            assert apart(analysis, seed) < 1e-8, text
            tried += 1
    assert tried >= 3


def test_what_nothing_moves_freely_is_driven() -> None:
    """y' = cos t/(1 + 2 y), y'' = -(sin t + 2 y'^2)/(1 + 2 y), x'' = 2 y'^2 + 2 y y''."""
    analysis = Analysis(mbsym.loads(HELD).system)
    x, y = (eval(re.sub(r"\^", "**", str(a)), {**vars(math), "t": 0.7, "y": 0.3}) for a in accelerations(analysis))
    rate = math.cos(0.7) / 1.6
    wanted = -(math.sin(0.7) + 2 * rate**2) / 1.6
    assert (x, y) == pytest.approx((2 * rate**2 + 0.6 * wanted, wanted))


def test_it_is_said_what_is_independent_and_where_they_are_regular() -> None:
    result = CliRunner().invoke(main, ["show", str(SHIPPED / "chaplygin-sleigh.yaml"), "accelerations"])
    assert result.exit_code == 0, result.output
    assert "independent ones: x, theta" in result.stdout
    assert "regular where" in result.stdout
