"""``mbsym equilibria FILE --vary NAME=LOW:HIGH``: branches of equilibria over one parameter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import Message
from mbsym.model.system import System
from mbsym.report.content import Block, aligned, column, paragraph
from mbsym.studies.study import Answer, Exit, Watch

if TYPE_CHECKING:
    from mbsym.maps.axis import Axis
    from mbsym.maps.branches_result import Branches
    from mbsym.maps.result import Cell
    from mbsym.studies.equilibria import Request


class Withdrawn(Exception):
    """What branches stand on does not hold."""


def followed(system: System, axis: Axis, values: Mapping[str, Fraction], watch: Watch) -> Branches:
    """Raises Failure, and Withdrawn."""
    from mbsym.analysis import Analysis
    from mbsym.maps.branches import branches

    branch_map = branches(system, axis, values, watch=watch)
    withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
    if withdrawn is not None:
        raise Withdrawn(withdrawn.reason)
    return branch_map


def answer(system: System, request: Request, branches: Branches) -> Answer:
    from mbsym.studies.map.answer import files_of

    lines, files = _lines(branches), files_of(system, branches, request.files, request.language or system.language)
    if branches.interrupted:
        message = Message("interrupted; what was proved before that is written")
        return Answer(lines, files, (message,), Exit.INTERRUPTED)
    unbalanced = any(branches.critical(critical).balance is False for critical in branches.criticals)
    return Answer(lines, files, code=Exit.FAILED if unbalanced else Exit.OK)


def _lines(branches: Branches) -> Iterator[Block]:
    """Intervals and critical values in their order, then what there is to know besides."""
    from mbsym.report.maps.words import critical_words, remark_words

    columns = (
        column(branches.axes[0].name),
        column(Message("equilibria"), right=True),
        column(Message("stable"), right=True),
        column(Message("what happens"), fold=True),
    )
    yield aligned(columns, rows(branches))
    for cell in branches.criticals:
        if (polynomial := _minimal(cell.sample)) and critical_words(branches, cell):
            message = Message("[[value]] is a root of [[polynomial]]", value=value(cell.sample), polynomial=polynomial)
            yield paragraph(message)
    for remark in branches.remarks:
        yield paragraph(remark_words(remark))
    lost = sum(not piece.throughout for piece in branches.pieces)
    if lost:
        text = "verdicts proved at the sample only, not along the whole piece: [[lost]] of [[all]]"
        yield paragraph(Message(text, lost=lost, all=len(branches.pieces)))
    if branches.proved:
        yield paragraph(Message("the numbers of equilibria are proved in every open interval"))


def rows(branches: Branches) -> list[tuple[str, str, str, str]]:
    """(interval or value, equilibria, stable ones, what happens); intervals between which nothing happens as one."""
    table: list[tuple[str, str, str, str]] = []
    from mbsym.report.maps.words import stable_words

    for first, last in branches.spans():
        table += _critical_row(branches, branches.between(first)[0])
        number = len(branches.equilibria(first))
        count = str(number) if first.certainty is Certainty.PROVED else Message("[[number]], not proved", number=number)
        stable = stable_words(x.verdict for x in branches.equilibria(first))
        table.append((f"{value(branches.ends(first)[0])} .. {value(branches.ends(last)[1])}", count, stable, ""))
    return table + (_critical_row(branches, branches.between(branches.intervals[-1])[1]) if branches.intervals else [])


def _critical_row(branches: Branches, at: Cell | None) -> list[tuple[str, str, str, str]]:
    """The row of the critical value at the end of an interval, if there is one at which something happens."""
    from mbsym.report.maps.words import critical_words, stable_words

    words = "" if at is None else critical_words(branches, at)
    if at is None or not words:
        return []
    critical = branches.critical(at)
    counted = critical.meetings is not None and not critical.continuum
    stable = stable_words(x.verdict for x in critical.meetings or ())
    count = str(len(critical.meetings or ())) if counted else Message("not counted")
    count = Message("infinitely many") if critical.continuum else count
    return [(value(at.sample), count, stable if counted else "", words)]


def value(x: Any) -> str:
    """A rational number, or the first digits of an algebraic one."""
    return str(x) if isinstance(x, fmpq) else f"{float(x):.10g}..."


def _minimal(x: Any) -> str:
    """The minimal polynomial of an irrational number, where it is short."""
    if isinstance(x, fmpq):
        return ""
    degree = int(x.polynomial.degree())
    if degree > 4:
        return Message("a polynomial of degree [[degree]], in branches.json", degree=degree)
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
