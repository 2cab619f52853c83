"""Systems with applied forces at an enclosed value at which a Hurwitz determinant is zero, exactly.

There two roots have the sum zero (Orlando), or one is zero.  Where enclosures leave only one pair of roots for that, it
is imaginary if it is one of conjugates; the others are looked at by their enclosures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Any

from flint import acb, acb_poly, arb, ctx

from mbsym.algebra.matrices import faddeev
from mbsym.algebra.truncated import Truncated
from mbsym.problems.normal_forms.birkhoff import absolute
from mbsym.problems.normal_forms.centre import matrix_of, on_pair, on_zero
from mbsym.problems.normal_forms.dissipative import state_field
from mbsym.problems.normal_forms.expansion import Expansion
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem, Why


def judged_on_border(found: Expansion, values: Mapping[str, Any], zero: Sequence[str]) -> Judged:
    """``zero``: ``root`` where a root is zero exactly, ``pair`` where the Hurwitz determinant before the last is."""
    from mbsym.problems.normal_forms.problem import enclosed

    return judged_enclosed(*state_field(enclosed(found, values)), zero)


def judged_enclosed(field: Sequence[Truncated], positions: Sequence[str], zero: Sequence[str]) -> Judged:
    """The same of a field with enclosed coefficients; ``positions`` are the coordinates among its first variables."""
    coefficients = faddeev(matrix_of(field), acb(0), acb(1))[1]
    if "root" in zero:
        return _zero(field, coefficients[1:]) if "pair" not in zero else _open(Why.MIXED_ROOTS)
    try:
        roots = _isolated(coefficients)
    except ValueError:
        return _open(Why.EQUAL_FREQUENCIES)
    opposite = [(i, j) for i, j in combinations(range(len(roots)), 2) if (roots[i] + roots[j]).contains(0)]
    if len(opposite) != 1:
        return _open(Why.MORE_PAIRS)
    i, j = opposite[0]
    if any(root.real > 0 for k, root in enumerate(roots) if k not in (i, j)):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not roots[i].imag.contains(0):
        if not roots[j].overlaps(roots[i].conjugate()):
            return _open(Why.MIXED_ROOTS)
    elif roots[i].real > 0 or roots[j].real > 0:
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    else:
        return _open(Why.ZERO_ROOT)
    if not all(root.real < 0 for k, root in enumerate(roots) if k not in (i, j)):
        return _open(Why.MIXED_ROOTS)
    w = abs(roots[i].imag)
    reduced = on_pair(field, acb(0, w), lambda x: 1 / x, absolute)
    place = next((k for k in range(len(positions)) if reduced.lengths[k].real > 0), None)
    if place is None:
        return _open(Why.COEFFICIENT_OPEN)
    a = (reduced.cubic / (4 * reduced.lengths[place])).real
    if not (a < 0 or a > 0):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.COEFFICIENT_OPEN, frequencies=(w,))
    outcome = Outcome.ASYMPTOTIC if a < 0 else Outcome.UNSTABLE
    return Judged(outcome, Theorem.REDUCTION, frequencies=(w,), coefficient=a, amplitude_of=positions[place])


def _zero(field: Sequence[Truncated], others: Sequence[acb]) -> Judged:
    """One root is zero; ``others`` are the coefficients of the polynomial of the rest."""
    try:
        roots = _isolated(others)
    except ValueError:
        return _open(Why.ZERO_ROOT)
    if any(root.real > 0 for root in roots):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not all(root.real < 0 for root in roots):
        return _open(Why.ZERO_ROOT)
    reduced = on_zero(field, lambda x: 1 / x, absolute)
    if reduced.quadratic.real != 0:
        return Judged(Outcome.UNSTABLE, Theorem.REDUCTION, coefficient=reduced.quadratic.real)
    a = reduced.cubic.real
    if not reduced.quadratic.is_zero() or not (a < 0 or a > 0):
        return _open(Why.COEFFICIENT_OPEN)
    return Judged(Outcome.ASYMPTOTIC if a < 0 else Outcome.UNSTABLE, Theorem.REDUCTION, coefficient=a)


def _isolated(coefficients: Sequence[acb]) -> list[acb]:
    """Roots, each alone in its enclosure.  Raises ValueError."""
    found: list[acb] = acb_poly(coefficients).roots(tol=arb(2) ** (-(ctx.prec // 2)))
    return found


def _open(why: Why) -> Judged:
    return Judged(Outcome.UNDECIDED, Theorem.NONE, why)
