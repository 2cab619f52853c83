"""Uniform motions that dissipation does not feel:  x = v t + w,  v != 0.

Hautus' test off lambda = 0 does not see them.  They move with  D x' = 0  exactly if

    D v = 0,   K v = 0,   and some w has  G v + K w = 0,  that is  u.G v = 0 for all u with K u = 0

(K is symmetric).  A free body between whose parts a damper acts drifts so; a charge in a magnetic field does not.
"""

from __future__ import annotations

from itertools import combinations
from math import comb

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import determinant
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.matrices import dot
from mbsym.algebra.ring import Polynomial
from mbsym.problems.stabilisation.clearing import Cleared, Rows
from mbsym.problems.stabilisation.hautus import MOST_BLOCKS, _open_factors, annihilator
from mbsym.problems.stabilisation.result import Locus, Rank


def without_drift(rank: Rank, whole: Cleared, gyro: Rows, stiff: Rows, damping: Rows) -> Rank:
    """``rank``, found off lambda = 0, with what uniform motions that are not felt change in it.

    Where some are there for all parameters, lambda is a root; else all is said where the minors that exclude them do
    not vanish.  Raises TooLargeError.
    """
    if not rank.full or rank.certainty is not Certainty.PROVED or whole.known.never_zero(determinant(stiff)):
        return rank
    damped = [j for j, row in enumerate(damping) if any(x != 0 for x in row)]
    beside = [[*k, *(d[j] for j in damped)] for k, d in zip(stiff, damping, strict=True)]
    both, unfelt = annihilator(beside, whole.known, len(stiff))
    needed = [both]
    if unfelt:
        held, free = annihilator(stiff, whole.known, len(stiff))
        found = _minor([[dot(u, [dot(row, v) for row in gyro]) for v in unfelt] for u in free], whole)
        if found is None:
            drift = (whole.formula(both * 0), whole.formula(both * 0 + 1))
            turned = any(x != 0 for row in gyro for x in row)  # then w is needed, which a lower rank of K may deny
            open_ = _open_factors(held, whole.known) if turned else []
            return Rank(False, Certainty.PROVED, (drift,), Locus((), (), tuple(map(whole.formula, open_))))
        needed.append(found)
    if rank.locus is None:
        return rank
    locus = rank.locus
    doubtful = {str(x): x for one in needed for x in map(whole.formula, _open_factors(one, whole.known))}
    if all(x == 0 for row in gyro for x in row):  # then what Hautus' test loses at lambda = 0 is a drift
        doubtful = {text: x for text, x in doubtful.items() if text not in map(str, locus.factors)}
    factors = tuple(x for x in locus.factors if str(x) not in doubtful)
    provided = {str(x): x for x in locus.provided} | doubtful
    return Rank(True, rank.certainty, (), Locus(factors, locus.together, tuple(provided.values())), rank.why_not)


def _minor(rows: Rows, whole: Cleared) -> Polynomial | None:
    """A minor of full column rank, one that cannot vanish if there is one; None where all vanish identically."""
    width = len(rows[0])
    if comb(len(rows), width) > MOST_BLOCKS:
        raise TooLargeError("too many minors")
    minors = [determinant([rows[i] for i in at]) for at in combinations(range(len(rows)), width)]
    left = [x for x in minors if x != 0]
    return min(left, key=lambda x: (not whole.known.never_zero(x), len(x))) if left else None
