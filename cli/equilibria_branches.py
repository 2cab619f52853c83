"""``mbsym equilibria FILE --vary NAME=LOW:HIGH``: branches of equilibria over one parameter, made, written and told."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flint import fmpq
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from mbsym.algebra.plane.numbers import compare
from mbsym_cli.console import FAILED, INTERRUPTED, OK, complain, console, printable, reason_of
from mbsym_cli.files import deliver
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.maps.branches_result import Branches
    from mbsym.maps.section import Axis
    from mbsym.model.system import System

FORMATS = ("svg", "pdf", "png", "json", "tex")


@dataclass(frozen=True)
class Request:
    """What was asked for, sound as far as options go."""

    file: Path
    folder: Path
    system: System
    axis: Axis
    values: Mapping[str, Fraction]
    formats: Sequence[str]
    language: str
    quiet: bool


def read_varied(text: str, system: System, settings: Sequence[str], asked: Options) -> Axis | None:
    """The parameter and its interval; every complaint joins those of ``asked``."""
    from mbsym_cli.section_options import read_axis

    found = read_axis(text, "--vary", system, asked)
    if found is None:
        return None
    complain_unless_parameter("--vary", found.name, system, asked)
    if any(one.partition("=")[0].strip() == found.name for one in settings):
        told = f"'{found.name}' has an interval and a number"
        asked.complain("--set", "repeated-name", told, "leave one of them out")
    complain_of_sign("--vary", found, system, asked)
    return found


def complain_unless_parameter(option: str, name: str, system: System, asked: Options) -> None:
    """Relative equilibria are solved at numbers of parameters: symbols and what follows from relations do not fit."""
    from mbsym.expressions.tree import text

    related = next((item for item in system.relations if item.name == name), None)
    if related is not None:
        told = f"{name} follows from other parameters: {name} = {text(related.value)}"
        asked.complain(option, "given-by-relation", told, "take one of those of which its relation is made")
    elif name not in system.parameter_names and name in [item.name for item in system.notation]:
        told = f"'{name}' is no parameter but a symbol of the notation"
        asked.complain(option, "misplaced-name", told, "take the parameters of which it is made")


def complain_of_sign(option: str, axis: Axis, system: System, asked: Options) -> None:
    """An interval against the declared sign of its parameter."""
    sign = next((str(one.sign) for one in system.parameters if one.name == axis.name), "")
    if (sign in ("positive", "nonnegative") and axis.low < 0) or (
        sign in ("negative", "nonpositive") and axis.high > 0
    ):
        told = f"{axis.name} is declared {sign}, and the interval from {axis.low} to {axis.high} is not"
        asked.complain(option, "against-sign", told, "choose an interval of that sign")


def run(request: Request) -> int:
    """The exit code."""
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.maps.branches import branches
    from mbsym_cli.map_run import watched

    started = time.perf_counter()
    file = request.file
    try:
        with watched(request.quiet, file.name) as watch:
            found = branches(request.system, request.axis, request.values, watch=watch)
            withdrawn = Analysis(request.system, ()).broken(Analysis.equilibria.stands_on)
            if withdrawn is not None:
                complain(file, f"no branches: {withdrawn.reason}")
                return FAILED
            watch("drawing", 0, 1)
            files = _files(request, found)
        deliver(request.folder, files, "equilibria")
    except Failure as failure:
        complain(file, f"no branches: {failure}")
        return FAILED
    except OSError as error:
        complain(file, f"the branches cannot be written: {reason_of(error)}")
        return FAILED
    if not request.quiet:
        _show(request, found, list(files), time.perf_counter() - started)
    if found.interrupted:
        complain(file, "interrupted; what was proved before that is written")
        return INTERRUPTED
    return FAILED if any(one.balance is False for one in found.criticals) else OK


def _files(request: Request, found: Branches) -> dict[str, str | bytes]:
    from mbsym.report.language import Language
    from mbsym.report.maps.branch_json import branches_json
    from mbsym.report.maps.branch_tex import branch_tex

    language = Language(request.language)
    files: dict[str, str | bytes] = {}
    pictures = [kind for kind in request.formats if kind in ("svg", "pdf", "png")]
    if pictures:
        from mbsym.report.maps.branch_figure import branch_figure

        files |= branch_figure(request.system, found, language, pictures)
    if "json" in request.formats:
        files["branches.json"] = branches_json(request.system, found)
    if "tex" in request.formats:
        files["branches.tex"] = branch_tex(request.system, found, language)
    return files


def _show(request: Request, found: Branches, names: Sequence[str], seconds: float) -> None:
    """Intervals and critical values in their order, then what there is to know besides."""
    from mbsym.report.maps.branch_words import critical_words, remark_words

    out = console()
    title = (request.system.name, "bold"), (f"  {printable(request.file)}, {seconds:.2f} s", "dim")
    out.print(Text.assemble(*title))
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold cyan")
    table.add_column(escape(found.axis.name))
    table.add_column("equilibria", justify="right")
    table.add_column("stable", justify="right")
    table.add_column("what happens", overflow="fold")
    for row in rows(found):
        table.add_row(*map(escape, row))
    out.print(table)
    for one in found.criticals:
        if (polynomial := _minimal(one.number)) and critical_words(found, one):
            out.print(Text(f"  {value(one.number)} is a root of {polynomial}"))
    for remark in found.remarks:
        out.print(Text(f"  {remark_words(remark)}"))
    lost = sum(not piece.throughout for piece in found.pieces)
    if lost:
        out.print(
            Text(f"  verdicts proved at the sample only, not along the whole piece: {lost} of {len(found.pieces)}")
        )
    if found.proved:
        out.print(Text("  the numbers of equilibria are proved in every open interval"))
    out.print(Text.assemble("  files in ", (printable(request.folder), "bold"), ": ", ", ".join(names)))


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
