"""The summary of a run on the terminal."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.counting import counted
from mbsym_cli.console import UNBROKEN, printable, tell

if TYPE_CHECKING:
    from mbsym.problems.checks import Check
    from mbsym.report.brief import Brief
    from mbsym.report.content import Facts, Inline
    from mbsym.report.language import Language
    from mbsym.report.summary import Line, Summary
    from mbsym.report.words.claims import ClaimLine

#: Longer relations may be broken, in letters.
MOST_UNBROKEN = 40

_COLOURS = {"exact": "green", "verified numerically": "green", "FAILED": "bold red"}
_COLOURS |= {"undecided": "yellow", "singular": "yellow"}
_CLAIM_COLOURS = {"held": "green", "refuted": "bold red", "undecided": "yellow"}


def show(found: Summary, path: Path, seconds: float) -> None:
    """Problems with what they gave and the seconds they took, the self-check, and where the files are."""
    tell((found.system, "bold"), (f"  {printable(path)}, {seconds:.2f} s", "dim"))
    for line in found.problems:
        _problem(line)
    _claims(found.claims)
    _checks(found.checks)
    if found.files:
        folder = found.files[0].parent
        tell("  files in ", (printable(folder), "bold"), f": {', '.join(_listed(found.files, folder))}")


def show_finding(
    found: Facts,
    title: str,
    path: Path,
    seconds: float,
    files: Sequence[Path],
    language: Language,
    further: Iterable[Line] = (),
) -> None:
    """What was found, each with its name; what ``further`` problems that were asked for gave; where all of it is."""
    from mbsym.report.content import say
    from mbsym.report.plain_writer import Writer

    writer = Writer(language, readable=True)
    tell((title, "bold"), (f"  {printable(path)}, {seconds:.2f} s", "dim"))
    labels = [writer.inline(fact.name) for fact in found.items]
    width = max(map(len, labels)) + 4
    for label, fact in zip(labels, found.items, strict=True):
        for k, said in enumerate(fact.lines):
            name = (f"  {label:<{width - 2}}", "bold cyan") if k == 0 else " " * width
            tell(name, *((_unbroken(text, x), _style(x)) for text, x in writer.pieces(said)), margin=width + 2)
    for line in further:
        _problem(line)
    if files:
        page = next((x for x in files if x.name == "report.html"), files[0])
        text = "[[file]] (all of it here: -v)"
        if len(files) > 1:
            text = "[[file]] (files there: [[count]]; all of it here: -v)"
        tell(writer.said(say(text, file=printable(page), count=str(len(files)))), indent=2)


def _unbroken(text: str, value: Inline) -> str:
    """A short relation stands in one line."""
    from mbsym.report.content import Relation

    return text.replace(" ", UNBROKEN) if isinstance(value, Relation) and len(text) <= MOST_UNBROKEN else text


def _style(value: object) -> str:
    """The colour of a verdict or an outcome."""
    from mbsym.report.content import Graded, Strong

    grade = value.grade if isinstance(value, Strong | Graded) else ""
    return {"good": "green", "bad": "bold red", "open": "yellow"}.get(grade, "")


def _listed(files: Sequence[Path], folder: Path) -> list[str]:
    """The files of a folder by name; those in folders in it are counted, each such folder where its first file is."""
    inner = [path.relative_to(folder).parts[:-1] for path in files]
    told = {
        parts: f"{'/'.join(parts)} ({counted(inner.count(parts), 'file')})" if parts else "" for parts in set(inner)
    }
    return list(dict.fromkeys(told[parts] or path.name for parts, path in zip(inner, files, strict=True)))


def show_brief(found: Brief, name: str, width: int) -> None:
    """A run in one line; columns are as wide as they mostly are."""
    colour = _COLOURS.get(found.worst, "")
    tell(
        (f"{printable(name):<{width}}", "bold"),
        f"  {found.problems:<8}",
        (f"  {found.self_check:<32}", colour),
        f"  {found.claims:<30}",
        (f"{found.seconds:7.2f} s", "dim"),
        (f"  {found.missing}" if found.missing else "", "yellow"),
    )


def _problem(line: Line) -> None:
    tell("  ", (f"{line.number} {line.title}", "bold cyan"), (f"  {line.seconds:.3f} s", "dim"))
    for text in line.lines:
        indent = 4 + len(text) - len(text.lstrip())
        tell((text.strip(), "" if line.available else "yellow"), indent=indent)


def _claims(claims: tuple[ClaimLine, ...]) -> None:
    """How many hold; then each with its place, and by what it differs."""
    if not claims:
        return
    from mbsym.report.words.claims import together

    words = [claim.word for claim in claims]
    counts = [f"{words.count(word)} {word}" for word in ("held", "refuted", "undecided") if word in words]
    tell((f"  claims: {', '.join(counts)}", "bold cyan"))
    width = min(28, max(len(claim.place) for claim in claims))
    for group in together(claims):
        claim = group[0]
        place = f"{claim.place:<{width}}  " if width else ""
        told = (f"{claim.title}: ", claim.outcome)
        if len(group) > 1:
            told = (f"{len(group)} claims ", claim.outcome.replace("holds", "hold", 1))
        tell(place + told[0], (told[1], _CLAIM_COLOURS[claim.word]), indent=4)
        for text in claim.lines:
            tell(text.strip(), indent=6 + len(text) - len(text.lstrip()))


def _checks(checks: tuple[Check, ...]) -> None:
    if not checks:
        return
    tell(("  self-check: two independent routes each", "bold cyan"))
    width = max(len(check.name) for check in checks)
    for check in checks:
        outcome = f"{check.outcome} ({check.detail})" if check.detail else check.outcome
        tell(f"{check.name:<{width}}  ", (outcome, _COLOURS[check.outcome]), indent=4)
