"""The self-check of problem 8: Kalman's rank and eigenvalues at random rational parameters against what is said."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE
from mbsym.algebra.point import Rationals
from mbsym.expressions.message import Message
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.checks import EXACT, FAILED, Check
from mbsym.problems.claims.counterexample import completed, parameter_samples
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stabilisation import numbers as exact
from mbsym.problems.stabilisation.numbers import AtValues
from mbsym.problems.stabilisation.problem import MOST_COORDINATES, at_values, feels_everything
from mbsym.problems.stabilisation.result import Locus, Stabilisation
from mbsym.problems.stability.exact import inertia

#: Points at which everything is compared.
POINTS = 3


def check_stabilisation(scene: Scene[Any], linear: Linearisation, stabilisation: Stabilisation) -> Check | None:
    """Degrees of instability, pervasiveness and controllability, each at random points off the places told.

    None where the matrices are irrational at all of them.
    """
    wrong: set[str] = set()
    compared = 0
    if len(linear.coordinates) > MOST_COORDINATES or not (
        stabilisation.gyroscopic or stabilisation.dissipation or stabilisation.control
    ):
        return None  # too large, or nothing is said
    for values in _points(scene):
        there = at_values(scene, linear, values)
        if there is None:
            continue
        compared += 1
        wrong |= set(_wrong(scene, linear, stabilisation, there, values))
        if compared == POINTS:
            break
    first, second = "minors and resultants in symbols", "Kalman's rank and eigenvalues counted at numbers"
    if wrong:
        return Check(
            "stabilisation", first, second, FAILED, Message("differs in [[wrong]]", wrong=", ".join(sorted(wrong)))
        )
    if not compared:  # roots of numbers in the matrices: there is nothing to compare exactly
        return None
    return Check(
        "stabilisation",
        first,
        second,
        EXACT,
        Message("equal at [[compared]] random rational points", compared=compared),
        compared,
    )


def _points(scene: Scene[Any]) -> Iterator[dict[str, Fraction]]:
    """Parameters that the description allows: elsewhere nothing is said, and formulas may have other signs."""
    system = scene.system
    for free in parameter_samples(system):
        try:
            values = completed(system, Rationals({}, {}), free)
        except NOT_THERE:
            continue
        yield {name: Fraction(int(x.p), int(x.q)) for name, x in values.items() if name in system.parameter_names}


def _wrong(
    scene: Scene[Any], linear: Linearisation, stabilisation: Stabilisation, there: AtValues, values: dict[str, Fraction]
) -> Iterator[str]:
    names = linear.coordinates
    carry = Carrier(scene.ring, Rationals({}, {}), {k: Rationals({}, {}).number(v) for k, v in values.items()})

    def vanishes(formula: Any) -> bool:
        try:
            return bool(carry(formula.polynomial) == 0)
        except NOT_THERE:
            return True

    for part in stabilisation.gyroscopic:
        own = there.only([names.index(name) for name in part.coordinates])
        stiff = (own.places + own.places.transpose()) / 2
        for region in part.regions:
            if any(vanishes(x) for x, _ in region.signs):
                continue
            there_too = all(r == "!=" or (carry(x.polynomial) > 0) == (r == ">") for x, r in region.signs)
            if there_too and inertia(stiff)[2] != region.degree:
                yield "the degree of instability"
    for damped in stabilisation.dissipation:
        at = [names.index(name) for name in damped.coordinates]
        own = there.only(at)
        if _is_generic(damped.rank.locus, vanishes) and damped.rank.certainty is Certainty.PROVED:
            matrix = (own.rates + own.rates.transpose()) / 2
            if feels_everything(own, matrix) != damped.rank.full:
                yield "pervasiveness"
    for control in stabilisation.control:
        own = there.only([names.index(name) for name in control.coordinates])
        comparable = _is_generic(control.rank.locus, vanishes) and control.rank.certainty is Certainty.PROVED
        if comparable and exact.is_controllable(own) != control.rank.full:
            yield "controllability"


def _is_generic(locus: Locus | None, vanishes: Any) -> bool:
    """Whether a point lies off everything at which a rank may be another one."""
    if locus is None:
        return False
    return not any(vanishes(x) for x in (*locus.factors, *locus.provided, *locus.together))
