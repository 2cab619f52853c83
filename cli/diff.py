"""``mbsym diff``: what changed between two results, or between a description and the results that are kept of it.

No study: it is about two files, or two folders of them, most of which are no descriptions.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.expressions.message import Counted, Message, joined, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.model.system import LANGUAGES, ONE_OF_LANGUAGES
from mbsym.report.documents import diff as doc
from mbsym.report.language import Language
from mbsym.studies.study import Exit
from mbsym_cli.console import complain, console, defect, printable, read_description, reason_of, speaking
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from mbsym.diff import Change, Diff

RESULTS = "results.json"


@click.command("diff")
@click.argument("a", type=click.Path(path_type=Path))
@click.argument("b", type=click.Path(path_type=Path))
@click.option("--check", is_flag=True, help="Exit code 1 unless both say the same.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of words.")
@click.option("--all", "everything", is_flag=True, help="Print every change, however many there are.")
@click.option("--language", metavar="NAME", help=f"{ONE_OF_LANGUAGES}.  [default: that of the descriptions]")
def command(a: Path, b: Path, check: bool, as_json: bool, everything: bool, language: str | None) -> None:
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
      mbsym diff systems build --check --json
    """
    options = Options()
    tongue = None if language is None else options.word("--language", language, tuple(LANGUAGES), "language")
    if options.refused():
        sys.exit(Exit.BAD_INPUT)
    sides = _side(a), _side(b)
    if not all(sides):
        sys.exit(Exit.BAD_INPUT)
    if len(sides[0]) == len(sides[1]) == 1:
        common = [(next(iter(sides[1])), next(iter(sides[0].values())), next(iter(sides[1].values())))]
        lacking: list[tuple[str, bool, Source]] = []
    else:
        common = [(name, sides[0][name], sides[1][name]) for name in sides[0] if name in sides[1]]
        lacking = [(name, True, source) for name, source in sides[0].items() if name not in sides[1]]
        lacking += [(name, False, source) for name, source in sides[1].items() if name not in sides[0]]
    sys.exit(_compare(common, lacking, check, as_json, everything, tongue))


def _compare(
    common: list[tuple[str, Source, Source]],
    lacking: list[tuple[str, bool, Source]],
    check: bool,
    as_json: bool,
    everything: bool,
    language: str | None,
) -> int:
    from mbsym.diff import diff

    worst, systems = Exit.OK, list[doc.SystemDiff]()
    for name, first, second in common:
        try:
            difference = diff(first.content(second), second.content(first))
        except Unreadable:
            worst = Exit.BAD_INPUT
            continue
        except Exception as error:  # a defect of ours must not cost the other systems
            defect(error, name)
            worst = max(worst, Exit.FAILED)
            continue
        if not difference.same and check:
            worst = max(worst, Exit.FAILED)
        systems.append(system_data(name, difference))
        if not as_json:
            say = speaking(*(source.path for source in (first, second) if source.description))
            say = say if language is None else Language(language).say
            show(name, first.title, second.title, difference, everything, say)
    for name, first_only, source in lacking:
        worst = max(worst, Exit.FAILED if check else Exit.OK)
        if not as_json:
            say = Language(language).say if language else speaking(*([source.path] if source.description else []))
            message = Message("[[name]]: only in [[side]]", name=name, side="A" if first_only else "B")
            console().print(printable(say(message)))
    if as_json:
        from mbsym.report.documents.base import written

        only = doc.OnlyIn(*([name for name, first, _ in lacking if first is side] for side in (True, False)))
        click.echo(written(doc.Diff(systems=systems, only_in=only), indent=2), nl=False)
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
            loaded = json.loads(self.path.read_text(encoding="utf-8"))
        except OSError as error:
            complain(self.path, Message("it cannot be read: [[why]]", why=reason_of(error)))
            raise Unreadable from error
        except (ValueError, RecursionError) as error:
            complain(self.path, Message("error[not-json]: this is no JSON: [[why]]", why=ascii_safe(str(error)[:200])))
            raise Unreadable from error
        if not isinstance(loaded, dict) or loaded.get("format") != 1 or not isinstance(loaded.get("coordinates"), list):
            complain(self.path, "error[not-results]: this is no results.json of format 1")
            hint = Message("mbsym run writes one; those of earlier versions have to be written again")
            print(f"  {speaking(self.path)(Message('hint: [[hint]]', hint=hint))}", file=sys.stderr)
            raise Unreadable
        return loaded

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
        results: dict[str, Any] = json.loads(render(Analysis(system, chosen, budget), chosen))
        return results


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

    sources = {place.folder: Source(Path(place.file), True) for place in found_in([path], Path("build")).places}
    if not sources:
        complain(path, "error[nothing]: there are neither results nor descriptions in this folder")
    return sources


def _is_description(path: Path) -> bool:
    from mbsym.source import is_description

    return bool(is_description(path))


# A comparison of results in words, and as JSON.


#: So many changes of one system are printed; a text longer than so many characters is cut.
MOST_CHANGES, LONGEST = 40, 120

#: Properties of results.json that are called otherwise in words; what is empty is not said.
WORDS = {
    "system": "", "kinematics": "", "bodies": "", "energy": "", "equations": "",
    "rotation": Message("direction cosines"), "A2": Message("A2 of T"), "A1": Message("A1 of T"),
    "A0": Message("A0 of T"), "at_values": Message("at the values"), "linearisation": Message("linear form"),
    "velocity_origin": Message("velocity of the joint"), "velocity_mass_centre": Message("velocity of the mass centre"),
    "parameters": Message("parameter"), "checks": Message("self-check"), "subsystems": Message("subsystem"),
    "claims": Message("claim"), "initial": Message("initial state"), "motion": Message("unperturbed motion"),
    "integrals": Message("first integral"), "unavailable": Message("without a result"),
    "velocity": Message("its velocity"), "row": Message("number of the row"), "sha256": Message("digest"),
}  # fmt: skip

_SIGN = {"added": ("+", "green"), "removed": ("-", "red"), "undecided": ("?", "yellow")}

#: What stands in place of nothing.
NOTHING = Message("nothing")


def place(path: tuple[str, ...]) -> Message:
    """``mass matrix [theta, psi]`` for equations, mass_matrix, theta, psi."""
    from mbsym.diff import Key

    matrix = next((k for k, step in enumerate(path) if isinstance(step, Key) and step in _INDEXED), None)
    head, indices = (path, ()) if matrix is None else (path[: matrix + 1], path[matrix + 1 :])
    words = [word for step in head if (word := called(step) if isinstance(step, Key) else step)]
    if head[-1] == "theorems":
        indices = tuple(map(worded, indices))
    return joined((*words, *([joined(("[", joined(indices, ", "), "]"), "")] if indices else ())))


def called(key: str) -> str:
    """A property of results.json in words."""
    return WORDS.get(key, Message(key.replace("_", " ")))


_INDEXED = (
    "rotation", "angular_velocity", "velocity_origin", "velocity_mass_centre", "A2", "A1", "mass_matrix", "forcing",
    "M", "D", "G", "K", "N", "characteristic_polynomial", "coordinates", "cyclic", "theorems",
)  # fmt: skip


def lines(change: Change) -> list[Message]:
    """What changed at a place: the place, then by what."""
    where = place(change.path)
    if change.kind == "added":
        return [joined((where, Message("added"), *_standing(change, change.after)), ": ")]
    if change.kind == "removed":
        return [joined((where, Message("removed"), *_standing(change, change.before)), ": ")]
    if change.kind == "order":
        before, after = ", ".join(change.before), ", ".join(change.after)
        text = "[[place]]: in another order: [[before]] -> [[after]]"
        return [Message(text, place=where, before=before, after=after)]
    if change.kind == "formula":
        amount = Message("[[count]], the first of them [[first]]", count=_terms(change.terms), first=_cut(change.first))
        if change.difference:
            amount = joined((change.difference,)) if len(change.difference) <= 4 * LONGEST else _terms(change.terms)
        short = _short(change.before) and _short(change.after)
        both = joined((f"  {change.before}", f"{change.after}"), " -> ")
        return [joined((where, joined(("B - A", amount), " = ")), ": "), *([both] if short else [])]
    if change.kind == "undecided":
        return [joined((where, joined((Message("undecided"), _undecided(change)), ", ")), ": ")]
    word = change.word and change.path[-1] != "code"  # which is none of English either
    before, after = (worded(x) if word and isinstance(x, str) else x for x in (change.before, change.after))
    return [joined((where, joined((_cut(_text(before)), _cut(_text(after))), " -> ")), ": ")]


def _undecided(change: Change) -> Message:
    if not isinstance(change.before, str) or not isinstance(change.after, str):
        values = joined((_text(change.before), _text(change.after)), " -> ")
        return joined((Message("not written out"), values), ": ")
    both = joined((_cut(change.before), _cut(change.after)), " -> ")
    if not change.points:
        return both
    return joined((Message("numerically equal at [[points]]", points=Counted(change.points, "point")), both), ": ")


def _standing(change: Change, value: Any) -> tuple[str, ...]:
    """What stands there, unless the place says it."""
    said = isinstance(value, (str, int, float)) and value != change.path[-1]
    return (_cut(_text(value)),) if said else ()


def _terms(count: int) -> Message:
    return Counted(count, "term")


def _text(value: Any) -> str:
    if isinstance(value, dict) and "terms" in value:
        return _terms(value["terms"])
    if isinstance(value, list):
        return joined(map(_text, value), ", ") if value else NOTHING
    if value is None or value == "":
        return NOTHING
    if isinstance(value, bool):
        return Message("yes") if value else Message("no")
    return value if isinstance(value, str) else str(value)


def _short(value: Any) -> bool:
    return isinstance(value, str) and len(value) <= LONGEST // 2


def _cut(text: str) -> str:
    if len(text) <= LONGEST:
        return text
    return Message("[[beginning]]... ([[count]] characters)", beginning=text[:LONGEST], count=len(text))


def show(name: str, first: str, second: str, difference: Diff, everything: bool, say: Callable[[str], str]) -> None:
    """One system on the terminal."""
    from rich.text import Text

    def told(text: str, indent: int = 4) -> None:
        out.print(printable(" " * indent + say(text)))

    out, restated = console(), len(difference.restated)
    equal = Message("formulas that are equal and printed otherwise: [[count]]", count=restated)
    if difference.same:
        summary = Message("no change")
        if restated:
            summary = Message("no change ([[restated]])", restated=equal)
        out.print(Text.assemble((printable(name), "bold"), f": {say(summary)}"))
    else:
        counts = Counted(len(difference.changes), "change") if difference.changes else Message("only names are others")
        sides = (printable(f"{first} -> {second}"), "dim")
        out.print(Text.assemble((printable(name), "bold"), f": {say(counts)}   ", sides))
        for renaming in difference.renamed:
            text = "[[kind]] [[before]] is called [[after]]"
            renamed = Message(text, kind=worded(renaming.kind), before=renaming.before, after=renaming.after)
            out.print(Text.assemble(("  ~ ", "cyan"), printable(say(renamed))))
        shown = difference.changes if everything else difference.changes[:MOST_CHANGES]
        for change in shown:
            sign, colour = _SIGN.get(change.kind, ("*", "magenta"))
            for k, line in enumerate(lines(change)):
                out.print(Text.assemble((f"  {sign if not k else ' '} ", colour), printable(say(line))))
        if len(shown) < len(difference.changes):
            told(Message("and [[count]] more: --all prints them", count=len(difference.changes) - len(shown)))
        if restated:
            told(equal)
    if difference.versions[0] != difference.versions[1]:
        text = "written by mbsym [[before]] -> [[after]]"
        told(Message(text, before=difference.versions[0], after=difference.versions[1]))


def system_data(name: str, difference: Diff) -> doc.SystemDiff:
    """One system, for ``--json``."""
    return doc.SystemDiff(
        system=name,
        same=difference.same,
        versions=list(difference.versions),
        renamed=[doc.RenamedRow(kind=pair.kind, before=pair.before, after=pair.after) for pair in difference.renamed],
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
            for change in difference.changes
        ],
        restated=[list(path) for path in difference.restated],
    )
