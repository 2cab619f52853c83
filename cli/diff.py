"""``mbsym diff``: what changed between two results, or between a description and the results that are kept of it."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import click

from mbsym.expressions.parser import ascii_safe
from mbsym_cli.console import BAD_INPUT, FAILED, OK, complain, defect, read_description, reason_of
from mbsym_cli.options import Options

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
    from mbsym_cli.diff_words import show, show_lacking, system_data

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
