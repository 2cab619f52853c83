"""A comparison of results in words, and as JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from mbsym.expressions.message import counted
from mbsym.report.documents import diff as doc
from mbsym_cli.console import console, printable

if TYPE_CHECKING:
    from mbsym.diff import Change, Diff

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
