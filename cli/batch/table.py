"""What a batch shows while it runs: a live table on a terminal, a line for each description elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from mbsym.batch.outcome import ComplaintRow, Outcome, Row, Summary
from mbsym.expressions.message import Counted, Message, duration, joined, worded
from mbsym_cli.console import console, printable, speaking

if TYPE_CHECKING:
    from rich.console import RenderableType

#: Seconds between two pictures of the live table.
_FRAME = 0.1

#: So many running descriptions have a line of their own.
_MOST_LINES = 16


class Lines:
    """The ``Watcher`` that prints a line when a description is finished."""

    def __init__(self, total: int, width: int, quiet: bool, changed: bool, tongue: Callable[[str], str]) -> None:
        """``tongue`` says what is about no row."""
        self.total, self.width, self.tongue = total, width, tongue
        self.quiet, self.changed = quiet, changed
        self.finished = 0

    def began(self, file: str) -> None:
        """Nothing to show yet."""

    def ended(self, row: Row) -> None:
        self.finished += 1
        if not (self.quiet or (self.changed and row.cached)):
            self.say(f"[{str(self.finished).rjust(len(str(self.total)))}/{self.total}] {line(row, self.width)}", row)
        for text in complaints(row):
            self.complain(text)

    def tick(self) -> None:
        """Nothing moves."""

    def close(self) -> None:
        """Nothing to take away."""

    def say(self, text: str, row: Row) -> None:
        print(text, flush=not row.cached)

    def complain(self, text: str) -> None:
        print(text, file=sys.stderr)


class Live(Lines):
    """The same lines, and under them what runs, for how long, and how long the rest may take."""

    def __init__(self, total: int, width: int, quiet: bool, changed: bool, tongue: Callable[[str], str]) -> None:
        super().__init__(total, width, quiet, changed, tongue)
        self._running: dict[str, float] = {}
        self._began: float | None = None
        self._derived = 0
        self._drawn = 0.0
        self._live: object | None = None

    def began(self, file: str) -> None:
        now = time.monotonic()
        self._began = self._began or now
        self._running[file] = now

    def ended(self, row: Row) -> None:
        if self._running.pop(row.file, None) is not None:
            self._derived += 1
        super().ended(row)
        self._drawn = 0.0
        if self._live is not None:
            self.tick()

    def say(self, text: str, row: Row) -> None:
        from rich.text import Text

        console().print(Text(text, style=_STYLES.get(row.outcome, "dim" if row.cached else "")))

    def complain(self, text: str) -> None:
        if self._live is None:
            super().complain(text)
        else:  # on the same console, above the table
            from rich.text import Text

            console().print(Text(text))

    def tick(self) -> None:
        from rich.live import Live as Screen

        now = time.monotonic()
        if now - self._drawn < _FRAME:
            return
        self._drawn = now
        if self._live is None:
            self._live = Screen(self._picture(now), console=console(), auto_refresh=False, transient=True)
            self._live.start()
        assert isinstance(self._live, Screen)
        self._live.update(self._picture(now), refresh=True)

    def close(self) -> None:
        from rich.live import Live as Screen

        if isinstance(self._live, Screen):
            self._live.stop()
        self._live = None

    def _picture(self, now: float) -> RenderableType:
        from rich.table import Table
        from rich.text import Text

        table = Table.grid(padding=(0, 2))
        for file, since in list(self._running.items())[:_MOST_LINES]:
            table.add_row(
                Text(self.tongue("running"), style="cyan"), Text(printable(file)), Text(f"{now - since:.0f} s")
            )
        if len(self._running) > _MOST_LINES:
            more = Message("and [[count]] more", count=len(self._running) - _MOST_LINES)
            table.add_row(Text(""), Text(self.tongue(more)), Text(""))
        left = self.total - self.finished
        table.add_row(Text(f"{self.finished}/{self.total}", style="bold"), Text(self._remaining(now, left)), Text(""))
        return table

    def _remaining(self, now: float, left: int) -> str:
        """How long the rest may take, going by those that were derived."""
        if not self._derived or self._began is None:
            return self.tongue(Message("[[count]] to go", count=left))
        seconds = (now - self._began) / self._derived * left
        return self.tongue(Message("[[count]] to go, about [[time]]", count=left, time=duration(seconds)))


#: What derived results are called that were there before.
UP_TO_DATE = Message("up to date")

#: How many descriptions have an outcome.
NUMBER_OF = "[[count]] [[outcome]]"

_STYLES = {outcome: "red" for outcome in Outcome if outcome.failed} | {Outcome.SKIPPED: "dim"}


def watcher(total: int, width: int, quiet: bool, changed: bool, tongue: Callable[[str], str]) -> Lines:
    """The one that suits standard output."""
    kind = Live if sys.stdout.isatty() and not quiet else Lines
    return kind(total, width, quiet, changed, tongue)


def line(row: Row, width: int) -> str:
    """A row on one line: file, outcome, seconds, what is to be known of it."""
    say = speaking(row.file)
    pieces = [printable(row.file).ljust(width), say(_word(row))]
    if not row.cached and row.seconds:
        pieces.append(f"{row.seconds:.2f} s")
    pieces.append(printable(_said(row, say)))
    return "  ".join(piece for piece in pieces if piece)


def _word(row: Row) -> str:
    return UP_TO_DATE if row.cached and row.outcome is Outcome.DERIVED else row.outcome.value


def _said(row: Row, say: Callable[[str], str]) -> str:
    """The verdict, what is missing, claims that do not hold."""
    if row.message:
        return say(row.message)
    parts: list[str] = []
    errors = sum(complaint.severity == "error" for complaint in row.complaints)
    if errors:
        parts.append(Message("errors: [[count]]", count=errors))
    for problem in row.problems:
        if problem.verdict_at_values is not None:
            parts.append(Message("at the values [[verdict]]", verdict=worded(problem.verdict_at_values)))
        elif problem.verdict is not None:
            parts.append(problem.verdict)
    missing = [str(problem.number) for problem in row.problems if problem.status == "none"]
    if missing:
        parts.append(Message("no result: [[problems]]", problems=", ".join(missing)))
    parts += [joined((Message("SELF-CHECK FAILED"), check.name), ": ") for check in row.checks if check.failed]
    if refuted := _refuted(row):
        parts.append(Message("claims refuted: [[count]]", count=refuted))
    return "; ".join(map(say, parts))


def _refuted(row: Row) -> int:
    return sum(claim.word == "refuted" for claim in row.claims)


def complaints(row: Row) -> list[str]:
    """What is complained about, for standard error, each with its place."""
    name, say = printable(row.file), speaking(row.file)
    return [_complaint(name, complaint, say) for complaint in row.complaints] + [
        f"{name}: {printable(say(note))}" for note in row.notes
    ]


def _complaint(name: str, row: ComplaintRow, say: Callable[[str], str]) -> str:
    place = name if row.line is None else f"{name}:{row.line}:{row.column}"
    hint = "" if row.hint is None else "\n  " + say(Message("hint: [[hint]]", hint=printable(say(row.hint))))
    return f"{place}: {row.severity}[{row.code}]: {printable(say(row.message))}{hint}"


def totals(summary: Summary) -> Message:
    """The last line: how many of what."""
    parts: list[Message] = []
    for outcome, count in summary.totals.items():
        word = outcome.value
        if outcome is Outcome.DERIVED:
            cached = sum(row.cached for row in summary.rows if row.outcome is outcome)
            parts += [Message(NUMBER_OF, count=count - cached, outcome=worded(word))] if count > cached else []
            parts += [Message(NUMBER_OF, count=cached, outcome=UP_TO_DATE)] if cached else []
        else:
            found = Message("[[count]] with errors", count=count)
            parts.append(found if outcome is Outcome.ERRORS else Message(NUMBER_OF, count=count, outcome=worded(word)))
    refuted = sum(map(_refuted, summary.rows))
    parts += [Message("claims refuted: [[count]]", count=refuted)] if refuted else []
    what = joined(parts, ", ") if parts else Message("nothing to do")
    return joined((Counted(len(summary.rows), "system"), what), ": ")
