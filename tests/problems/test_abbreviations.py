"""Abbreviations in claims: formed once for all claims, they are what they would be for each claim alone."""

from __future__ import annotations

from fractions import Fraction

import pytest
from conftest import SHIPPED

import mbsym
from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.expressions.table import Table
from mbsym.expressions.tree import Call, Name, differentiate
from mbsym.problems.claims import Symbols


@pytest.fixture(scope="module", params=["satellite", "satellite-with-damper"])
def analysis(request: pytest.FixtureRequest) -> Analysis:
    return mbsym.load(SHIPPED / f"{request.param}.yaml", ())


def test_every_formula_is_the_same(analysis: Analysis) -> None:
    scene, symbols = analysis.parameters_scene, Symbols.of(analysis)
    assert symbols is Symbols.of(analysis)
    formulas = 0
    for claim in analysis.system.claims:
        for side in (claim.equals, claim.right):
            if side is None or claim.is_numerical:
                continue
            environment = dict(scene.environment)
            if claim.variable:
                environment[claim.variable] = scene.ring.generator("time", "t")
            try:
                alone = symbols.lowering(scene.ring, environment, symbols.occurring([side]))(symbols.opened(side))
            except Failure:  # angles of its own
                continue
            if claim.variable:
                assert symbols.polynomial(scene, claim) == alone
                continue
            assert symbols.in_scene(scene)(symbols.opened(side)) == alone
            formulas += 1
    assert formulas >= 4


def test_the_slope_of_a_table_stays_one_where_abbreviations_are_opened() -> None:
    """f'(A) with A = 2 q is the slope of f there, and not f."""
    table = Table("f", ((Fraction(0), Fraction(1)), (Fraction(1), Fraction(3))))
    slope = differentiate(Call("f", Name("A"), table=table), "A")
    assert Symbols(mbsym.load(SHIPPED / "simple-pendulum.yaml").system).opened(slope) == slope
