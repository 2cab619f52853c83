"""``mbsym diff``: what changed between two results, or between a description and the results that are kept of it."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.expressions.message import counted
from mbsym.expressions.parser import ascii_safe
from mbsym.report.documents import diff as doc
from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, console, defect, printable, read_description, reason_of
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.diff import Change, Diff

RESULTS = "results.json"


@click.command("diff")
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@click.option("--check", is_flag=True, help="Exit code 1 unless both say the same.")
@click.option("--format", "form", default="text", show_default=True, help="text or json.")
@click.option("--all", "everything", is_flag=True, help="Print every change, however many there are.")
def command(a: Path, b: Path, check: bool, form: str, everything: bool) -> None:
    """Say exactly what changed from A to B.

    Each is a results.json, a folder that holds one, a folder of such folders (as run and batch make them), a
    description, or a folder of descriptions; descriptions are derived now, with the problems and the budget of terms of
    the other side.  Formulas are compared exactly: equal ones that are printed otherwise are no change, of others the
    difference B - A is told.  What cannot be decided (behind roots and functions) is called so.  A name that was
    replaced throughout is recognised.

    \b
    Exit codes: 0 compared (with --check: both say the same), 1 something changed (with --check), 2 unreadable input.

    \b
    Examples:
      mbsym diff systems/satellite.yaml reports/satellite --check
      mbsym diff old/results.json new/results.json
      mbsym diff systems build --check --format json
    """
    asked = Options()
    forms = asked.words("--format", form, ("text", "json"), "format")
    if asked.refused() or len(forms) != 1:
        sys.exit(BAD_INPUT)
    sides = _side(a), _side(b)
    if not all(sides):
        sys.exit(BAD_INPUT)
    if len(sides[0]) == len(sides[1]) == 1:
        common = [(next(iter(sides[1])), next(iter(sides[0].values())), next(iter(sides[1].values())))]
        lacking: list[tuple[str, bool]] = []
    else:
        common = [(name, sides[0][name], sides[1][name]) for name in sides[0] if name in sides[1]]
        lacking = [(name, True) for name in sides[0] if name not in sides[1]]
        lacking += [(name, False) for name in sides[1] if name not in sides[0]]
    sys.exit(_compare(common, lacking, check, forms[0], everything))


def _compare(
    common: list[tuple[str, Source, Source]], lacking: list[tuple[str, bool]], check: bool, form: str, everything: bool
) -> int:
    from mbsym.diff import diff

    worst, told = OK, []
    for name, first, second in common:
        try:
            found = diff(first.content(second), second.content(first))
        except Unreadable:
            worst = BAD_INPUT
            continue
        except Exception as error:  # a defect of ours must not cost the other systems
            defect(error, name)
            worst = max(worst, FAILED)
            continue
        if not found.same and check:
            worst = max(worst, FAILED)
        told.append(system_data(name, found))
        if form == "text":
            show(name, first.title, second.title, found, everything)
    for name, first_only in lacking:
        worst = max(worst, FAILED if check else OK)
        if form == "text":
            show_lacking(name, first_only)
    if form == "json":
        from mbsym.report.documents import diff as doc
        from mbsym.report.documents.base import written

        only = doc.OnlyIn(*([name for name, first in lacking if first is side] for side in (True, False)))
        click.echo(written(doc.Diff(systems=told, only_in=only), indent=2), nl=False)
    return worst


class Unreadable(Exception):
    """What is wrong with a file has been told."""


@dataclass(frozen=True)
class Source:
    """One side of a comparison: a file of results, or a description that is derived when it is asked for."""

    path: Path
    description: bool

    @property
    def title(self) -> str:
        return str(self.path)

    def content(self, other: Source) -> Mapping[str, Any]:
        """The results; a description's for the problems that the other side has."""
        if not self.description:
            return self.read
        return self._derived(None if other.description else other.read)

    @cached_property
    def read(self) -> Mapping[str, Any]:
        try:
            found = json.loads(self.path.read_text(encoding="utf-8"))
        except OSError as error:
            complain(self.path, f"it cannot be read: {reason_of(error)}")
            raise Unreadable from error
        except (ValueError, RecursionError) as error:
            complain(self.path, f"error[not-json]: this is no JSON: {ascii_safe(str(error)[:200])}")
            raise Unreadable from error
        if not isinstance(found, dict) or found.get("format") != 1 or not isinstance(found.get("coordinates"), list):
            complain(self.path, "error[not-results]: this is no results.json of format 1")
            print("  hint: mbsym run writes one; those of earlier versions have to be written again", file=sys.stderr)
            raise Unreadable
        return found

    def _derived(self, like: Mapping[str, Any] | None) -> Mapping[str, Any]:
        system = read_description(self.path)
        if system is None:
            raise Unreadable
        from mbsym.algebra.ring import TERM_BUDGET
        from mbsym.analysis import ALL_PROBLEMS, USUAL_PROBLEMS, Analysis
        from mbsym.report.results_json import render

        problems, terms = (USUAL_PROBLEMS, TERM_BUDGET) if like is None else (like.get("problems"), like.get("terms"))
        listed = isinstance(problems, (list, tuple)) and all(number in ALL_PROBLEMS for number in problems)
        chosen = tuple(problems) if listed and problems else USUAL_PROBLEMS
        budget = terms if isinstance(terms, int) and 0 < terms <= 10**12 else TERM_BUDGET
        found: dict[str, Any] = json.loads(render(Analysis(system, chosen, budget), chosen))
        return found


def _side(path: Path) -> dict[str, Source]:
    """The results and descriptions of a side, by the folder that holds them; nothing after a complaint."""
    if not path.exists():
        complain(path, "error[missing]: there is no such file or folder")
        return {}
    if path.is_file():
        results = path.suffix == ".json" and not _is_description(path)
        return {path.stem if not results else path.parent.name: Source(path, not results)}
    if (path / RESULTS).is_file():
        return {path.name: Source(path / RESULTS, False)}
    trees = sorted(path.rglob(RESULTS))
    if trees:
        return {file.parent.relative_to(path).as_posix(): Source(file, False) for file in trees}
    from mbsym_cli.batch.folders import found_in

    found = {place.folder: Source(Path(place.file), True) for place in found_in([path], Path("build")).places}
    if not found:
        complain(path, "error[nothing]: there are neither results nor descriptions in this folder")
    return found


def _is_description(path: Path) -> bool:
    from mbsym.source import is_description

    return bool(is_description(path))


# A comparison of results in words, and as JSON.


#: So many changes of one system are printed; a text longer than so many characters is cut.
MOST_CHANGES, LONGEST = 40, 120

#: Properties whose names say less than these words; what is empty is not said.
WORDS = {
    "kinematics": "", "bodies": "", "energy": "", "equations": "", "rotation": "direction cosines",
    "A2": "A2 of T", "A1": "A1 of T", "A0": "A0 of T", "at_values": "at the values", "linearisation": "linear form",
    "velocity_origin": "velocity of the joint", "velocity_mass_centre": "velocity of the mass centre",
    "parameters": "parameter", "checks": "self-check", "subsystems": "subsystem", "claims": "claim",
    "initial": "initial state", "motion": "unperturbed motion",
    "integrals": "first integral", "unavailable": "without a result", "conditions": "conditions",
}  # fmt: skip

_SIGN = {"added": ("+", "green"), "removed": ("-", "red"), "undecided": ("?", "yellow")}


def place(path: tuple[str, ...]) -> str:
    """``mass matrix [theta, psi]`` for equations, mass_matrix, theta, psi."""
    words: list[str] = []
    matrix = next((k for k, step in enumerate(path) if step in _INDEXED), None)
    head, indices = (path, ()) if matrix is None else (path[: matrix + 1], path[matrix + 1 :])
    for step in head:
        word = WORDS.get(step, step.replace("_", " "))
        words += [word] if word else []
    return " ".join(words) + (f" [{', '.join(indices)}]" if indices else "")


_INDEXED = (
    "rotation", "angular_velocity", "velocity_origin", "velocity_mass_centre", "A2", "A1", "mass_matrix", "forcing",
    "M", "D", "G", "K", "N", "characteristic_polynomial", "coordinates", "cyclic", "theorems",
)  # fmt: skip


def lines(change: Change) -> list[str]:
    """What changed at a place: the place, then by what."""
    where = place(change.path)
    if change.kind == "added":
        return [f"{where}: added" + _standing(change.after)]
    if change.kind == "removed":
        return [f"{where}: removed" + _standing(change.before)]
    if change.kind == "order":
        return [f"{where}: in another order: {', '.join(change.before)} -> {', '.join(change.after)}"]
    if change.kind == "formula":
        if change.difference and len(change.difference) <= 4 * LONGEST:
            told = change.difference
        elif change.difference:
            told = f"{counted(change.terms, 'term')}"
        else:
            told = f"{counted(change.terms, 'term')}, the first of them {_cut(change.first)}"
        short = _short(change.before) and _short(change.after)
        return [f"{where}: B - A = {told}", *([f"  {change.before} -> {change.after}"] if short else [])]
    if change.kind == "undecided":
        return [f"{where}: undecided, {_undecided(change)}"]
    return [f"{where}: {_cut(_text(change.before))} -> {_cut(_text(change.after))}"]


def _undecided(change: Change) -> str:
    if not isinstance(change.before, str) or not isinstance(change.after, str):
        return f"not written out: {_text(change.before)} -> {_text(change.after)}"
    numerically = "" if not change.points else f"numerically equal at {counted(change.points, 'point')}: "
    return f"{numerically}{_cut(change.before)} -> {_cut(change.after)}"


def _standing(value: Any) -> str:
    return f": {_cut(_text(value))}" if isinstance(value, (str, int, float)) else ""


def _text(value: Any) -> str:
    if isinstance(value, dict) and "terms" in value:
        return counted(value["terms"], "term")
    if isinstance(value, list):
        return ", ".join(map(_text, value)) or "nothing"
    if value is None or value == "":
        return "nothing"
    return {True: "yes", False: "no"}[value] if isinstance(value, bool) else str(value)


def _short(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST // 2


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST else text[:LONGEST] + f"... ({len(text)} characters)"


def show(name: str, first: str, second: str, found: Diff, everything: bool) -> None:
    """One system on the terminal."""
    from rich.text import Text

    out = console()
    if found.same:
        restated = counted(len(found.restated), "formula is", "formulas are")
        more = f" ({restated} printed otherwise)" if found.restated else ""
        out.print(Text.assemble((printable(name), "bold"), f": no change{more}"))
        _versions(found)
        return
    counts = counted(len(found.changes), "change", "changes") if found.changes else "only names are others"
    out.print(Text.assemble((printable(name), "bold"), f": {counts}   ", (printable(f"{first} -> {second}"), "dim")))
    for one in found.renamed:
        out.print(Text.assemble(("  ~ ", "cyan"), printable(f"{one.kind} {one.before} is called {one.after}")))
    shown = found.changes if everything else found.changes[:MOST_CHANGES]
    for change in shown:
        sign, colour = _SIGN.get(change.kind, ("*", "magenta"))
        for k, line in enumerate(lines(change)):
            out.print(Text.assemble((f"  {sign if not k else ' '} ", colour), printable(line)))
    if len(shown) < len(found.changes):
        out.print(f"    and {len(found.changes) - len(shown)} more: --all prints them")
    if found.restated:
        out.print(f"    {counted(len(found.restated), 'formula is', 'formulas are')} equal and printed otherwise")
    _versions(found)


def _versions(found: Diff) -> None:
    if found.versions[0] != found.versions[1]:
        console().print(printable(f"    written by mbsym {found.versions[0]} -> {found.versions[1]}"))


def show_lacking(name: str, first_only: bool) -> None:
    console().print(printable(f"{name}: only in {'A' if first_only else 'B'}"))


def system_data(name: str, found: Diff) -> doc.SystemDiff:
    """One system, for ``--format json``."""
    return doc.SystemDiff(
        system=name,
        same=found.same,
        versions=list(found.versions),
        renamed=[doc.RenamedRow(kind=one.kind, before=one.before, after=one.after) for one in found.renamed],
        changes=[
            doc.ChangeRow(
                path=list(change.path),
                kind=change.kind,
                before=change.before,
                after=change.after,
                difference=change.difference or None,
                terms=change.terms,
                first=change.first or None,
                points=change.points,
            )
            for change in found.changes
        ],
        restated=[list(path) for path in found.restated],
    )
