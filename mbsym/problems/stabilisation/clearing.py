"""Matrices as polynomials in parameters alone: multiplied by something positive that clears their denominators."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import ParameterRing, Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.formulas.formula import Formula, Matrix
from mbsym.problems.stability.problem import in_parameters

Rows = Sequence[Sequence[Polynomial]]


@dataclass(frozen=True)
class Cleared:
    """``matrices`` times one factor, positive wherever the formulas make sense, over ``ring``; ``known`` there."""

    matrices: tuple[Rows, ...]
    ring: ParameterRing
    known: Signs

    def formula(self, x: Polynomial) -> Formula:
        return Formula(self.ring.whole, self.ring.lift(x))


def cleared(ring: Ring, matrices: Sequence[Matrix | None], signs: Signs) -> Cleared:
    """The matrices (None: without columns) over parameters.  Raises NoClosedForm where roots or functions occur."""
    given: list[Rows] = [[] if one is None else [list(row) for row in one.polynomials] for one in matrices]
    factor = ring.one
    for x in (x for rows in given for row in rows for x in row):
        for bottom, exponent in ring.fraction(ring.reduce(ring.times(x, factor)))[1]:
            factor = ring.reduce(ring.times(factor, ring.power(bottom, exponent)))
    word = signs.sign(factor)
    further = ring.one if word == "positive" else -ring.one if word == "negative" else factor  # times a square
    whole = [
        [[further * ring.fraction(ring.reduce(ring.times(x, factor)))[0] for x in row] for row in rows]
        for rows in given
    ]
    small, known = in_parameters(ring, whole, signs)
    if not isinstance(small, ParameterRing):
        raise NoClosedForm("the matrices hold roots or functions of parameters")
    return Cleared(tuple([[small.project(x) for x in row] for row in rows] for rows in whole), small, known)
