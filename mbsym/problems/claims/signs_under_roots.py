"""Whether a formula vanishes where roots occur: sqrt(r**2) is r for r > 0 only."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from itertools import product as combinations_of
from typing import Any

from flint import arb, ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.states import SEED
from mbsym.model.admissibility import number_of
from mbsym.model.assumptions import broken
from mbsym.model.system import System
from mbsym.problems.claims.counterexample import PRECISION
from mbsym.problems.claims.result import Derived, Outcome

#: What is left of a number that is known so well, relatively, is rounding.
ROUNDING = arb(2) ** -60
#: Quantities of undeclared sign under roots for which both signs are tried, points with each, and attempts per point.
MOST_SIGNS, POINTS, ATTEMPTS = 4, 8, 40
#: The answer that counts where several choices of signs are possible, last.
_WORST = (Outcome.EXACT, Outcome.NUMERICAL, Outcome.UNDECIDED, Outcome.DIFFERS)
#: By what is known of a quantity: r sqrt(p) stands for sqrt(r^2 p), or -r sqrt(p).
_SIGN = {"positive": 1, "nonnegative": 1, "zero": 1, "negative": -1, "nonpositive": -1}
#: What may stand under a root and have either sign.
_SIGNED = ("coordinate", "velocity", "acceleration", "time", "prescribed", "parameter", "sine", "cosine")


def decided(derived: Derived, x: Polynomial) -> tuple[str, str]:
    """Whether x vanishes: EXACT, NUMERICAL, UNDECIDED or DIFFERS; and "for r > 0 ...", if it does for some signs only.

    Roots of squares are opened for each choice of the signs that are not declared.
    """
    ring = derived.ring
    if ring.is_zero(x):
        return Outcome.EXACT, ""
    numerator, _ = ring.fraction(x)
    degrees = numerator.degrees()
    adjoined = [g for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0]
    if all(g.kind == "root" and g.argument.is_constant() for g in adjoined):
        return Outcome.DIFFERS, ""
    known, unknown = signs_under_roots(derived, numerator)
    tried = unknown[:MOST_SIGNS]
    answers = {
        pattern: _decided_for(derived, numerator, known, dict(zip(tried, pattern, strict=True)))
        for pattern in combinations_of((1, -1), repeat=len(tried))
    }
    found = answers[(1,) * len(tried)]
    if found is None:  # no parameters that are allowed have all these signs
        found = max((x for x in answers.values() if x), key=_WORST.index, default=Outcome.UNDECIDED)
    if found not in (Outcome.EXACT, Outcome.NUMERICAL):
        return found, ""
    if all(other in (Outcome.EXACT, Outcome.NUMERICAL, None) for other in answers.values()) and tried == unknown:
        return (Outcome.NUMERICAL if Outcome.NUMERICAL in answers.values() else Outcome.EXACT), ""
    matters = [k for k, _ in enumerate(tried) if any(answers[p] != answers[_flipped(p, k)] for p in answers)]
    names = [_name(ring, tried[k]) for k in matters] + [_name(ring, k) for k in unknown[MOST_SIGNS:]]
    return found, restriction(names, len(names) == 1 and Outcome.DIFFERS in answers.values())


def _flipped(pattern: tuple[int, ...], place: int) -> tuple[int, ...]:
    return (*pattern[:place], -pattern[place], *pattern[place + 1 :])


def _name(ring: Ring, index: int) -> str:
    return str(Formula(ring, ring.context.gen(index)))


def restriction(unknown: Sequence[str], refuted: bool) -> str:
    positive = ", ".join(f"{name} > 0" for name in unknown)
    if refuted:
        return Message("for [[positive]] (it does not for [[other]] < 0)", positive=positive, other=unknown[0])
    return Message("for [[positive]] (it need not with other signs)", positive=positive)


def signs_under_roots(derived: Derived, *values: Polynomial) -> tuple[dict[int, int], list[int]]:
    """Generators of declared sign (+1, -1), and those under the roots that occur whose sign is open.

    Under a root the sine of an angle may hide in its cosine: sqrt(1 - cos(x)**2).
    """
    ring, system = derived.ring, derived.system
    under: set[int] = set()
    pending = [(x, False) for x in values]
    seen: set[tuple[int, bool]] = set()
    while pending:
        x, below = pending.pop()
        for k, degree in enumerate(x.degrees()):
            g = ring.generators[k]
            if degree <= 0 or (k, below) in seen:
                continue
            seen.add((k, below))
            if k < ring.spare and g.argument is not None:
                pending.append((g.argument, below or g.kind == "root"))
            if below and g.kind in _SIGNED and g.name != "pi":
                under.add(k)
                if g.kind in ("sine", "cosine") and g.argument is None:
                    under |= {ring.index(kind, g.name) for kind in ("sine", "cosine")}
    known = {}
    for parameter in system.parameters:
        index = ring.index("parameter", parameter.name)
        sign = _SIGN.get(derived.signs.sign(ring.context.gen(index)))
        if sign is not None:
            known[index] = sign
    return known, [k for k in sorted(under) if k not in known]


def _decided_for(derived: Derived, x: Polynomial, known: Mapping[int, int], tried: Mapping[int, int]) -> str | None:
    """Whether x vanishes where these generators have these signs; None where there is no such point.

    All others take both signs, and angles all quadrants.
    """
    ring, signs = derived.ring, {**known, **tried}
    opened, identical = x, False
    try:
        opened = _opened_roots(derived, x, signs)
        identical = ring.is_zero(opened) is True
    except Failure:
        pass
    if identical and not (tried and derived.system.assumptions):
        return Outcome.EXACT
    source = random.Random(SEED)
    finite, narrow, found = 0, True, 0
    with ctx.workprec(PRECISION):
        for _ in range(POINTS * ATTEMPTS):
            values = _point(ring, signs, source)
            if not _has_signs(ring, signs, values) or not _is_allowed(derived.system, values):
                continue
            if identical:
                return Outcome.EXACT
            found += 1
            value = ring.evaluate(opened, values)
            if not value.is_finite():
                continue
            if not value.contains(0):
                return Outcome.DIFFERS
            finite, narrow = finite + 1, narrow and value.rad() < ROUNDING
            if finite == POINTS:
                return Outcome.NUMERICAL if narrow else Outcome.UNDECIDED
    return Outcome.UNDECIDED if found else None


def _point(ring: Ring, signs: Mapping[int, int], source: random.Random) -> dict[str, Any]:
    """Numbers for all names: of the given signs, else of either; up to more than a full turn."""
    values = {}
    plain = {ring.generators[k].name: sign for k, sign in signs.items() if ring.generators[k].kind == "parameter"}
    for name in ring.names():
        number = fmpq(source.randint(1, 99), source.choice((64, 16)))
        values[name] = number * plain.get(name, source.choice((1, -1)))
    return values


def _has_signs(ring: Ring, signs: Mapping[int, int], values: Mapping[str, Any]) -> bool:
    """Whether the generators have these signs at the point."""
    open_ = ((k, sign) for k, sign in signs.items() if ring.generators[k].kind != "parameter")
    return all(ring.evaluate(ring.context.gen(k), values) * sign > 0 for k, sign in open_)


def _is_allowed(system: System, values: Mapping[str, fmpq]) -> bool:
    """Whether the assumptions hold at the point: sqrt((a - b)**2) is b - a under a < b."""
    if not system.assumptions:
        return True
    known = {name: rationals.fraction(x) for name, x in values.items()}
    for relation in system.relations:
        value = number_of(relation.value, known)
        if value is None:
            return True
        known[relation.name] = value
    return next(broken(system, known), None) is None


def _opened_roots(derived: Derived, x: Polynomial, signs: Mapping[int, int]) -> Polynomial:
    """x with sqrt(r^2 p) = +-r sqrt(p) for every root, r of known sign."""
    ring = derived.ring
    images, degrees = {}, x.degrees()
    for k, g in enumerate(ring.generators[: ring.spare]):
        if g.kind != "root" or degrees[k] <= 0 or g.argument.is_constant():
            continue
        content, factors = ring.factored(g.argument)
        outside, inside = ring.one, ring.context.constant(content)
        for factor, exponent in factors:
            index = _generator(factor)
            sign = signs[index] if index in signs else _SIGN.get(derived.signs.sign(factor), 0)
            if sign:
                outside = ring.times(outside, (factor * sign) ** (exponent // 2))
                exponent %= 2
            inside = ring.times(inside, factor**exponent)
        if not outside.is_one():
            images[k] = ring.times(outside, ring.square_root(inside))
    return ring.substitute(x, images) if images else x


def _generator(x: Polynomial) -> int:
    """The generator that x is a positive multiple of, or -1."""
    if len(x) != 1 or sum(map(int, x.monomial(0))) != 1 or not x.coefficient(0) > 0:
        return -1
    return [int(e) for e in x.monomial(0)].index(1)
