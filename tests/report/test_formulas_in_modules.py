"""model.py of problems 9 to 12: every formula, run, against its exact value at random rational numbers."""

from __future__ import annotations

import random
from fractions import Fraction

import pytest
from conftest import SHIPPED, precision
from flint import arb, fmpq
from test_reports import NASTY, loaded

import mbsym
from mbsym.analysis import PROBLEMS, Analysis
from mbsym.report.sections import section_of
from mbsym.report.targets import TARGETS

#: A system and a problem that has many formulas of it.
CASES = [
    ("gyrostat-poisson", 9),
    ("clebsch-poisson", 10),
    ("three-bodies", 11),
    ("satellite-with-damper-slow", 12),
    ("shaken-pendulum", 12),
    ("nasty", 9),
]


@pytest.mark.parametrize(("name", "number"), CASES)
def test_every_formula_has_its_exact_value(name, number, tmp_path):
    analysis = mbsym.loads(NASTY) if name == "nasty" else mbsym.load(SHIPPED / f"{name}.yaml")
    analysis = Analysis(analysis.system, (number,))
    model = loaded(TARGETS["python"].render(analysis, (number,)), tmp_path)
    stage = analysis.stage(number)
    if stage.failure is not None:
        assert f"There is no {PROBLEMS[number].attribute} (problem {number})" in model.__doc__
        return
    told = list(section_of(PROBLEMS[number]).formulas(stage.value, analysis.system))
    assert told
    source = random.Random(7)
    names = {x for _, formula in told for x in formula.ring.names()}
    values = {x: Fraction(source.randint(20, 80), 64) for x in sorted(names)}
    found = getattr(model, PROBLEMS[number].attribute)({x: float(value) for x, value in values.items()})
    assert len(found) == len(told)
    with precision(300):
        at = {x: arb(fmpq(value.numerator, value.denominator)) for x, value in values.items()}
        for (_, formula), value in zip(told, found.values(), strict=True):
            exact = float(formula.ring.evaluate(formula.polynomial, at))
            assert value == pytest.approx(exact, rel=1e-8, abs=1e-10)


def test_a_missing_value_is_named(tmp_path):
    analysis = Analysis(mbsym.load(SHIPPED / "shaken-pendulum.yaml").system, (12,))
    model = loaded(TARGETS["python"].render(analysis, (12,)), tmp_path)
    with pytest.raises(ValueError, match="theta"):
        model.small_parameters({"m": 1, "l": 1, "g": 1, "h": 1, "nu": 1})
