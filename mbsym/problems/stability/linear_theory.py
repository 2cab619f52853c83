"""Exactly linear equations: x' = A x is decided by A alone, at any numbers.

No root to the right and those on the imaginary axis semisimple, zero ones too (each at most once in the minimal
polynomial): every solution is bounded, the motion is stable.  A Jordan block on the axis: some grow like a power of t.

Where everything may be shifted along directions V, (K + N) V = 0 for all parameters alike (two masses with a spring
between them), the shifted motions are motions, too: as with cyclic coordinates what is asked for then is the rest, q
modulo V and all velocities, and A acts on it.  There zero roots that are semisimple belong to velocities along V, or to
momenta, that stay what they are.  This is the same in all coordinates x = S y.

Source: F. R. Gantmacher, The Theory of Matrices, volume II, chapter XIV, section 3.
"""

from __future__ import annotations

from typing import Any

from mbsym.algebra.matrices import Operators, null_vectors, reduced_rows
from mbsym.algebra.roots import RootCount, counted
from mbsym.problems.stability.theorems import Fact
from mbsym.problems.stability.verdict import Verdict, bounded, coasting, concluded, drifting, exactly, only_drifts

Numbers = Any  # flint.fmpq_mat, or a matrix that does the same over another field


def decided(open_verdict: Verdict, first_order: Numbers, shifts: Numbers | None, shown: frozenset[Fact]) -> Verdict:
    """The verdict on x' = A x, A = ``first_order`` (coordinates first), that another one leaves open.

    ``shifts``: rows v with A (v, 0) = 0, along which a drift does not count; None where there are none.  ``shown`` are
    facts about the matrices of second order, for the reasons.
    """
    facts = shown | {Fact.EXACTLY_LINEAR}
    roots = counted(first_order.charpoly())
    if roots.right:
        return open_verdict
    calm = is_calm(first_order)
    if shifts is None:
        return bounded(facts) if calm else growing(first_order)
    rest = across(first_order, shifts)
    if not rest.nrows():
        return bounded(facts) if calm else coasting()
    left = counted(rest.charpoly())
    kept = is_calm(rest)
    if kept and left.left and left.left + left.zero == left.degree:
        return exactly(drifting(concluded({Fact.ROOTS_LEFT}), constant_momenta=left.zero > 0), calm)
    if calm:
        return bounded(facts)
    if not kept:
        return growing(first_order)
    if left.zero == left.degree:
        return coasting()
    return drifting(bounded(facts))


def growing(first_order: Numbers) -> Verdict:
    """The verdict where there is a Jordan block on the axis and no root to the right; whether only drifts grow is told.

    Modulo all v with A (v, 0) = 0 no block is left then.
    """
    verdict = concluded({Fact.EXACTLY_LINEAR, Fact.JORDAN_BLOCK})
    still = _still(first_order)
    drifts = still.nrows() and is_calm(across(first_order, still))
    return only_drifts(verdict) if drifts else verdict


def _still(first_order: Numbers) -> Numbers:
    """Rows v that span what A makes zero: positions that may be shifted, as x' = 0 there."""
    n, zero = first_order.nrows(), first_order[0, 0] * 0
    found = null_vectors(Operators(zero, zero + 1), reduced_rows(first_order), n)
    return type(first_order)(len(found), n, [x for v in found for x in v])


def is_calm(first_order: Numbers) -> bool:
    """Whether no root is to the right, and those on the axis are semisimple."""
    roots: RootCount = counted(first_order.charpoly())
    if roots.right or max(roots.imaginary_multiplicity, roots.zero) <= 1:
        return not roots.right
    blocks: RootCount = counted(first_order.minpoly())
    return max(blocks.imaginary_multiplicity, blocks.zero) <= 1


def across(first_order: Numbers, shifts: Numbers) -> Numbers:
    """A on the states modulo (v, 0), v the rows of ``shifts``: A (v, 0) = 0."""
    basis, rows = reduced_rows(shifts), first_order.tolist()
    kept = [i for i in range(len(rows)) if i not in basis]
    found = []
    for i in kept:
        row = rows[i]
        for at, v in basis.items():
            if i < len(v) and v[i] != 0:
                row = [x - v[i] * y for x, y in zip(row, rows[at], strict=True)]
        found += [row[j] for j in kept]
    return type(first_order)(len(kept), len(kept), found)


def is_open(verdict: Verdict) -> bool:
    """Whether linear theory has something to add."""
    return verdict.word.open and not verdict.coordinates_singular
