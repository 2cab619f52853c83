"""Savings in closed formulas: what nobody asked for, entries that vanish, subsystems that move by themselves."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import BUDGET as DETERMINANT
from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.failures import Failure, Limit
from mbsym.analysis import PROBLEMS, USUAL_PROBLEMS
from mbsym.expressions.message import Message, joined, worded
from mbsym.formulas.formula import Matrix
from mbsym.numerics.ledger.entry import COUNT, Measure, Saving
from mbsym.numerics.ledger.work import Counted, Work
from mbsym.numerics.planning.kinds import ENTRIES, NOT_ASKED, SUBSYSTEMS
from mbsym.problems.linearisation import Linearisation, components

#: What characteristic polynomials of all parts and of the whole cost, about.
CHARACTERISTIC = 1.0

#: Bounds that end a derivation because its result is too large, not because there is none.
TOO_LARGE = (Limit.TERMS, Limit.WORK, Limit.MEMORY)


def problems_not_asked(work: Work) -> Iterator[Saving]:
    """Problems of every run that nobody asked for and nothing asked for needed, against deriving them."""
    analysis = work.analysis
    left = [n for n in USUAL_PROBLEMS if n not in analysis.problems and PROBLEMS[n].attribute not in analysis.derived]
    for number in left:
        work.require(0.0)
        problem, stage = PROBLEMS[number], work.bounded.stage(number)
        if stage.failure is None:
            found = Counted(_terms(stage.value), 0, stage.seconds)
        elif stage.failure.limit in TOO_LARGE:
            found = _given_up(work, number)
        else:
            continue  # there is no such result, so nothing was saved
        why = Message("liveness: nobody asked for it, and nothing that was asked for needs it")
        if number == 3 and "linearisation" in analysis.derived:
            why = joined([why, Message("the linearisation is that of the quadratised Lagrangian")], "; ")
        what = Message("problem [[number]], [[title]]", number=number, title=worded(problem.title))
        measures = found.measures(Counted(0, 0, 0.0), Message("it"))
        yield Saving(NOT_ASKED, (what,), why, Certainty.PROVED, measures)


def _given_up(work: Work, number: int) -> Counted:
    """What a problem costs by itself until the budgets end it."""
    alone = work.fresh(work.system)
    started = time.thread_time()
    alone.stage(number)
    return Counted(None, alone.ring.work, time.thread_time() - started)


def _terms(found: Any) -> int:
    """Terms of a problem's result, or of all of them where there are several."""
    return sum(item.formula.terms for item in found) if isinstance(found, tuple) else int(found.terms)


def vanishing_entries(work: Work) -> Iterator[Saving]:
    """Entries of M, D, G, K, N that are identically zero, and matrices that vanish as a whole."""
    found = _linearisation(work)
    if found is None:
        return
    letters = dict(zip("MDGKN", found.matrices, strict=True))
    n = len(found.coordinates)
    entries = sum(not m[i, j].is_zero for m in found.matrices for i in range(n) for j in range(n))
    gone = [name for name, matrix in letters.items() if matrix.is_zero]
    what = [Message("[[count]] of [[all]] entries", count=5 * n * n - entries, all=5 * n * n)]
    if gone:
        what.append(Message("[[matrices]] as a whole", matrices=", ".join(gone)))
    why = Message("identities of the ring: their polynomials are 0")
    measures = (Measure("entries of M, D, G, K, N", COUNT, 5 * n * n, entries),)
    yield Saving(ENTRIES, tuple(what), why, Certainty.PROVED, measures)


def subsystems(work: Work) -> Iterator[Saving]:
    """Characteristic polynomials of subsystems, against that of the whole system."""
    found = _linearisation(work)
    parts = components(found.matrices) if found is not None else []
    if found is None or len(parts) < 2 or 6 not in work.analysis.problems:
        return
    work.begin(CHARACTERISTIC)
    divided = [_characteristic(work, found, part) for part in parts]
    if any(item.terms is None for item in divided):
        return
    here = Counted(sum(x.terms or 0 for x in divided), sum(x.steps for x in divided), sum(x.seconds for x in divided))
    there = _characteristic(work, found, range(len(found.coordinates)))
    names = ("{" + ", ".join(found.coordinates[i] for i in part) + "}" for part in parts)
    why = Message("identities of the ring: no matrix couples them, so the determinant is the product of theirs")
    measures = there.measures(here, "det(M s^2 + (D + G) s + K + N)")
    yield Saving(SUBSYSTEMS, tuple(names), why, Certainty.PROVED, measures)


def _linearisation(work: Work) -> Linearisation | None:
    if "linearisation" not in work.analysis.derived:
        return None
    found: Linearisation | None = work.result("linearisation")
    return found


def _characteristic(work: Work, found: Linearisation, part: Sequence[int]) -> Counted:
    """The characteristic polynomial of some coordinates in the declared parameters, within its budget of products."""
    ring = found.M[0, 0].ring

    def cut(*matrices: Matrix) -> list[list[Any]]:
        return [[ring.reduce(sum((m[i, j].polynomial for m in matrices), ring.zero)) for j in part] for i in part]

    def size() -> int | None:
        try:
            polynomial = characteristic_polynomial(cut(found.M), cut(found.D, found.G), cut(found.K, found.N))
        except Failure:
            return None
        return sum(len(x) for x in polynomial)

    terms, seconds = work.timed(size)
    return Counted(terms, DETERMINANT if terms is None else 0, seconds)
