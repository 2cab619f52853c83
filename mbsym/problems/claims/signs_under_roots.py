"""Whether a formula vanishes where roots occur: sqrt(r**2) is r for r > 0 only."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from itertools import product as combinations_of

from flint import arb, ctx, fmpq

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.states import SEED
from mbsym.problems.claims.counterexample import PRECISION
from mbsym.problems.claims.result import DIFFERS, EXACT, NUMERICAL, UNDECIDED, Derived

#: What is left of a number that is known so well, relatively, is rounding.
ROUNDING = arb(2) ** -60
#: Names of undeclared sign under roots for which both signs are tried, and points with each.
MOST_SIGNS, POINTS = 3, 4


def decided(derived: Derived, x: Polynomial) -> tuple[str, str]:
    """Whether x vanishes: EXACT, NUMERICAL, UNDECIDED or DIFFERS; and "for r > 0 ...", if it does for some signs only.

    Roots of squares are opened for each choice of the signs that are not declared.
    """
    ring = derived.ring
    if ring.is_zero(x):
        return EXACT, ""
    numerator, _ = ring.fraction(x)
    degrees = numerator.degrees()
    adjoined = [g for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0]
    if all(g.kind == "root" and g.argument.is_constant() for g in adjoined):
        return DIFFERS, ""
    known, unknown = signs_under_roots(derived, numerator)
    tried = unknown[:MOST_SIGNS]
    answers = {
        pattern: _decided_for(ring, numerator, known | dict(zip(tried, pattern, strict=True)))
        for pattern in combinations_of((1, -1), repeat=len(tried))
    }
    found, *others = answers.values()
    if found not in (EXACT, NUMERICAL):
        return found, ""
    if all(other in (EXACT, NUMERICAL) for other in others) and tried == unknown:
        return (NUMERICAL if NUMERICAL in answers.values() else EXACT), ""
    return found, restriction(unknown, all(other == DIFFERS for other in others) and len(unknown) == 1)


def restriction(unknown: Sequence[str], refuted: bool) -> str:
    positive = ", ".join(f"{name} > 0" for name in unknown)
    if refuted:
        return f"for {positive} (it does not for {unknown[0]} < 0)"
    return f"for {positive} (it need not with other signs)"


def signs_under_roots(derived: Derived, *values: Polynomial) -> tuple[dict[str, int], list[str]]:
    """Declared negative names (with -1), and the names of undeclared sign, under the roots that occur."""
    ring, system = derived.ring, derived.system
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
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
            elif below and g.kind in ("coordinate", "parameter") and g.name != "pi":
                under.add(k)
    found = [ring.generators[k].name for k in sorted(under)]
    known = {p.name: -1 for p in system.parameters if p.sign in ("negative", "nonpositive")}
    unknown = [name for name in found if signs.get(name) not in ("positive", "nonnegative") and name not in known]
    return known, unknown


def _decided_for(ring: Ring, x: Polynomial, signs: Mapping[str, int]) -> str:
    """Whether x vanishes where the named quantities have these signs, and the others are positive."""
    try:
        opened = _opened_roots(ring, x, signs)
        if ring.is_zero(opened):
            return EXACT
    except Failure:
        opened = x
    source = random.Random(SEED)
    finite, narrow = 0, True
    with ctx.workprec(PRECISION):
        for _ in range(4 * POINTS):
            values = {name: signs.get(name, 1) * fmpq(source.randint(1, 99), 64) for name in ring.names()}
            value = ring.evaluate(opened, values)
            if not value.is_finite():
                continue
            if not value.contains(0):
                return DIFFERS
            finite, narrow = finite + 1, narrow and value.rad() < ROUNDING
            if finite == POINTS:
                return NUMERICAL if narrow else UNDECIDED
    return UNDECIDED


def _opened_roots(ring: Ring, x: Polynomial, signs: Mapping[str, int]) -> Polynomial:
    """x with sqrt(r^2 p) = +-r sqrt(p) for every root, r of known sign."""
    images, degrees = {}, x.degrees()
    for k, g in enumerate(ring.generators[: ring.spare]):
        if g.kind != "root" or degrees[k] <= 0 or g.argument.is_constant():
            continue
        content, factors = ring.factored(g.argument)
        outside, inside = ring.one, ring.context.constant(content)
        for factor, exponent in factors:
            name = _plain_name(ring, factor)
            if name in signs:
                outside = ring.times(outside, (factor * signs[name]) ** (exponent // 2))
                exponent %= 2
            inside = ring.times(inside, factor**exponent)
        if not outside.is_one():
            images[k] = ring.times(outside, ring.square_root(inside))
    return ring.substitute(x, images) if images else x


def _plain_name(ring: Ring, x: Polynomial) -> str:
    """The name of a coordinate or parameter that x is a multiple of, or ""."""
    if len(x) != 1 or sum(map(int, x.monomial(0))) != 1:
        return ""
    g = ring.generators[[int(e) for e in x.monomial(0)].index(1)]
    return g.name if g.kind in ("coordinate", "parameter") else ""
