"""A difference taken apart by products of velocities, and the abbreviations that explain it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from flint import fmpq

from mbsym.algebra.factors import rational_ratio
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import (
    Expression,
    Name,
    differentiate,
    names,
)
from mbsym.formulas.formula import Formula
from mbsym.model.claims import Claim
from mbsym.problems.claims.forms import by_motion, by_place, in_parameters, scene_of_claims
from mbsym.problems.claims.result import DIFFERS, ClaimResult, Derived, Part
from mbsym.problems.claims.symbols import Symbols

#: Differences of more products of velocities than this are not taken apart.
MOST_PARTS = 60


def differing(derived: Derived, result: ClaimResult, symbols: Symbols, difference: Polynomial) -> ClaimResult:
    """The result with its difference, taken apart."""
    parts = _parts(derived, result.claim, symbols, difference)
    if result.claim.variable:  # the generator of the time stands for the variable: only the parts can be shown
        return replace(result, derived=None, outcome=DIFFERS, parts=parts)
    return replace(result, outcome=DIFFERS, difference=Formula(derived.ring, difference), parts=parts)


def _parts(derived: Derived, claim: Claim, symbols: Symbols, difference: Polynomial) -> tuple[Part, ...]:
    """The difference by products of velocities (a characteristic polynomial by powers), equal ones together."""
    ring = derived.ring
    if claim.variable:
        one, time = Formula(ring, ring.one), ring.index("time", "t")
        powers = {place[time]: coefficient for place, coefficient in by_place(ring, claim, difference)}
        return tuple(Part(one, Formula(ring, powers[power]), power) for power in sorted(powers, reverse=True))
    split = list(by_motion(ring, difference))
    if len(split) > MOST_PARTS:
        return ()
    values = _values(derived, symbols, [claim.equals])
    groups: list[tuple[Polynomial, Polynomial]] = []  # (combination of products, difference)
    for exponents, coefficient in split:
        product = ring.context.from_dict({exponents: fmpq(1)})
        for place, (combined, known) in enumerate(groups):
            ratio = rational_ratio(coefficient, known)
            if ratio is not None:
                groups[place] = (combined + product * ratio, known)
                break
        else:
            groups.append((product, coefficient))
    slopes = _slopes(derived, claim, symbols)
    found = []
    for combined, coefficient in groups:
        same = _same_as(coefficient, values)
        repairs = () if same else _repairs(ring, combined, coefficient, slopes, values)
        found.append(Part(Formula(ring, combined), Formula(ring, coefficient), None, same, repairs))
    return tuple(found)


def _values(derived: Derived, symbols: Symbols, expressions: list[Expression]) -> dict[str, Polynomial]:
    """The abbreviations that occur, as polynomials in declared parameters."""
    scene = scene_of_claims(derived)
    wanted = symbols.occurring(expressions)
    lower = symbols.in_scene(scene)
    return {name: in_parameters(derived, lower(Name(name))) for name in symbols.values if name in wanted}


def _same_as(coefficient: Polynomial, values: Mapping[str, Polynomial]) -> str:
    """``c18`` or ``-2*c18``, if the coefficient is a rational multiple of an abbreviation."""
    for name, value in values.items():
        ratio = None if value.is_constant() else rational_ratio(coefficient, value)
        if ratio is not None:
            sign = "-" if ratio < 0 else ""
            return sign + (name if abs(ratio) == 1 else f"{abs(ratio)}*{name}")
    return ""


def _slopes(derived: Derived, claim: Claim, symbols: Symbols) -> dict[str, Polynomial]:
    """What stands before each abbreviation in the claim, for those that enter it linearly."""
    scene = scene_of_claims(derived)
    found = {}
    for name in symbols.values:
        if name not in names(claim.equals):
            continue
        slope = differentiate(claim.equals, name)
        if name in names(slope):
            continue
        found[name] = in_parameters(derived, symbols.in_scene(scene)(symbols.opened(slope)))
    return found


def _repairs(
    ring: Ring,
    combined: Polynomial,
    coefficient: Polynomial,
    slopes: Mapping[str, Polynomial],
    values: Mapping[str, Polynomial],
) -> tuple[tuple[str, Formula], ...]:
    """Abbreviations that stand before just this combination: with -difference added the claim would be right.

    Where some of them are made of the parameters of the difference, the others are not named.
    """
    found, likely = [], []
    needed = _parameters(ring, coefficient)
    for name, slope in slopes.items():
        ratio = rational_ratio(combined, slope)
        if ratio is not None:
            found.append((name, Formula(ring, ring.reduce(-coefficient * ratio))))
            if needed <= _parameters(ring, values[name]):
                likely.append(found[-1])
    return tuple(likely or found)


def _parameters(ring: Ring, x: Polynomial) -> set[int]:
    degrees = x.degrees()
    return {k for k, g in enumerate(ring.generators) if g.kind == "parameter" and degrees[k] > 0}
