"""``mbsym equilibria FILE --vary NAME=LOW:HIGH``: branches of equilibria over one parameter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra.plane.numbers import compare
from mbsym.model.system import System
from mbsym.studies.study import Answer, Column, Exit, Line, Rows, Watch, line

if TYPE_CHECKING:
    from mbsym.maps.axis import Axis
    from mbsym.maps.branches_result import Branches
    from mbsym.studies.equilibria import Request


class Withdrawn(Exception):
    """What branches stand on does not hold."""


def followed(system: System, axis: Axis, values: Mapping[str, Fraction], watch: Watch) -> Branches:
    """Raises Failure, and Withdrawn."""
    from mbsym.analysis import Analysis
    from mbsym.maps.branches import branches

    found = branches(system, axis, values, watch=watch)
    withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
    if withdrawn is not None:
        raise Withdrawn(withdrawn.reason)
    return found


def answer(system: System, request: Request, found: Branches) -> Answer:
    lines, files = _lines(found), _files(system, request, found)
    if found.interrupted:
        told = "interrupted; what was proved before that is written"
        return Answer(lines, files, (told,), Exit.INTERRUPTED)
    unbalanced = any(one.balance is False for one in found.criticals)
    return Answer(lines, files, code=Exit.FAILED if unbalanced else Exit.OK)


def _files(system: System, request: Request, found: Branches) -> dict[str, str | bytes]:
    from mbsym.report.language import Language
    from mbsym.report.maps.branch_json import branches_json
    from mbsym.report.maps.branch_tex import branch_tex

    spoken = Language(request.language or "en")
    files: dict[str, str | bytes] = {}
    if request.pictures:
        from mbsym.report.maps.branch_figure import branch_figure

        files |= branch_figure(system, found, spoken, request.pictures)
    if "json" in request.files:
        files["branches.json"] = branches_json(system, found)
    if "tex" in request.files:
        files["branches.tex"] = branch_tex(system, found, spoken)
    return files


def _lines(found: Branches) -> Iterator[Line | Rows]:
    """Intervals and critical values in their order, then what there is to know besides."""
    from mbsym.report.maps.branch_words import critical_words, remark_words

    columns = (
        Column(found.axis.name),
        Column("equilibria", right=True),
        Column("stable", right=True),
        Column("what happens", fold=True),
    )
    yield Rows(columns, rows(found))
    for one in found.criticals:
        if (polynomial := _minimal(one.number)) and critical_words(found, one):
            yield line(f"  {value(one.number)} is a root of {polynomial}")
    for remark in found.remarks:
        yield line(f"  {remark_words(remark)}")
    lost = sum(not piece.throughout for piece in found.pieces)
    if lost:
        yield line(f"  verdicts proved at the sample only, not along the whole piece: {lost} of {len(found.pieces)}")
    if found.proved:
        yield line("  the numbers of equilibria are proved in every open interval")


def rows(found: Branches) -> list[tuple[str, str, str, str]]:
    """(interval or value, equilibria, stable ones, what happens); intervals between which nothing happens as one."""
    told: list[tuple[str, str, str, str]] = []
    from mbsym.report.maps.branch_words import stable_words

    for first, last in found.spans():
        told += _at(found, first.low)
        count = f"{len(first.equilibria)}" + ("" if first.constant else " ?")
        stable = stable_words(x.verdict for x in first.equilibria)
        told.append((f"{value(first.low)} .. {value(last.high)}", count, stable, ""))
    return told + (_at(found, found.intervals[-1].high) if found.intervals else [])


def _at(found: Branches, x: Any) -> list[tuple[str, str, str, str]]:
    """The row of the critical value at the end of an interval, if there is one."""
    one = next((c for c in found.criticals if compare(c.number, x) == 0), None)
    return [] if one is None else _critical_row(found, one)


def _critical_row(found: Branches, one: Any) -> list[tuple[str, str, str, str]]:
    from mbsym.report.maps.branch_words import critical_words, stable_words

    words = critical_words(found, one)
    if not words:
        return []
    counted = one.meetings is not None and not one.continuum
    stable = stable_words(x.verdict for x in one.meetings or ())
    count = "infinitely many" if one.continuum else str(len(one.meetings)) if counted else "not counted"
    return [(value(one.number), count, stable if counted else "", words)]


def value(x: Any) -> str:
    """A rational number, or the first digits of an algebraic one."""
    return str(x) if isinstance(x, fmpq) else f"{float(x):.10g}..."


def _minimal(x: Any) -> str:
    """The minimal polynomial of an irrational number, where it is short."""
    if isinstance(x, fmpq):
        return ""
    degree = int(x.polynomial.degree())
    if degree > 4:
        return f"a polynomial of degree {degree}, in branches.json"
    terms = []
    for power, c in reversed(list(enumerate(x.polynomial.coeffs()))):
        if c:
            letter = "" if power == 0 else "x" if power == 1 else f"x^{power}"
            size = abs(int(c))
            number = str(size) if size != 1 or not letter else ""
            sign = "-" if c < 0 else "+"
            terms.append((sign, number + ("*" if number and letter else "") + letter))
    first, *others = terms
    return ("-" if first[0] == "-" else "") + first[1] + "".join(f" {s} {t}" for s, t in others)
