"""What the commands share: reading descriptions, printing complaints, the two consoles."""

from __future__ import annotations

import logging
import os
import re
import shutil
import sys
import time
import traceback
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from functools import cache
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.algebra.failures import LOG
from mbsym.algebra.parts import missing
from mbsym.expressions.message import Message, joined
from mbsym.expressions.safe import UNBROKEN
from mbsym.expressions.safe import safe as escaped
from mbsym.studies.study import Watch, unwatched

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from mbsym.expressions.place import Complaints
    from mbsym.model.system import System
    from mbsym.report.language import Language
    from mbsym.report.plain_writer import Line


class Debugging:
    """Whether ``--debug`` was given: tracebacks are shown."""

    wanted = False


class Force:
    """Whether what mbsym did not write is replaced, too (``--force``)."""

    wanted = False


class Defects(logging.Handler):
    """Collects the exceptions that were contained somewhere, in the order in which they came."""

    def __init__(self) -> None:
        super().__init__()
        self.errors: list[BaseException] = []
        self.told: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        if record.exc_info and record.exc_info[1] is not None:
            self.errors.append(record.exc_info[1])

    def tell(self) -> bool:
        """Tells of those of which nobody has told; whether there were any at all."""
        for error in self.errors:
            if described(error) not in self.told:
                defect(error)
        return bool(self.errors)


#: Those of the command that runs.
DEFECTS = Defects()


@contextmanager
def listening() -> Iterator[Defects]:
    """Contained exceptions are collected instead of being shown with their tracebacks."""
    DEFECTS.errors, DEFECTS.told = [], set()
    propagated, LOG.propagate = LOG.propagate, False
    LOG.addHandler(DEFECTS)
    try:
        yield DEFECTS
    finally:
        LOG.removeHandler(DEFECTS)
        LOG.propagate = propagated


@cache
def console(stderr: bool = False) -> Console:
    """rich's console; plain text where the output is no terminal.  Lines of words are wrapped to ``asked_width``."""
    from rich.console import Console
    from rich.text import Text

    class Wrapping(Console):
        def print(
            self,
            *objects: Any,
            soft_wrap: bool | None = None,
            markup: bool | None = None,
            margin: int | None = None,
            **how: Any,
        ) -> None:
            width = asked_width(stderr) if margin is None else asked_width(stderr) or sys.maxsize
            plain = len(objects) == 1 and isinstance(objects[0], Text | str) and not how and not soft_wrap
            if width is None or not plain:
                super().print(*objects, soft_wrap=soft_wrap, markup=markup, **how)
                return
            line = objects[0]
            text = line if isinstance(line, Text) else Text(line) if markup is False else Text.from_markup(line)
            for whole in text.split(allow_blank=True):
                indent, at = _breaks(whole.plain, width, margin)
                for k, piece in enumerate(whole.divide(at)):
                    if k < len(at):
                        piece.rstrip()
                    piece.plain = piece.plain.replace(UNBROKEN, " ")
                    super().print(Text(indent if k else "") + piece, soft_wrap=True)

    terminal = (sys.stderr if stderr else sys.stdout).isatty()
    return Wrapping(stderr=stderr, highlight=False, soft_wrap=not terminal, width=None if terminal else 120)


#: What is left of a line stands so much further to the right.
HANGING = 2


def asked_width(stderr: bool = False) -> int | None:
    """The width to which lines of words are wrapped: what COLUMNS says, else that of the terminal.

    None in a file or pipe of which nothing is said: there a statement is one line, so that nothing is cut from a log.
    """
    columns = os.environ.get("COLUMNS", "")
    if columns.isdecimal() and int(columns) > 0:
        return max(int(columns), 30)
    stream = sys.stderr if stderr else sys.stdout
    return shutil.get_terminal_size().columns if stream.isatty() else None


def wrapped(line: str, width: int | None, margin: int | None = None) -> str:
    """A line of words on lines of that width, none cut within a word; as it is where no width is asked for.

    ``margin``: where the further lines begin.
    """
    if width is None:
        return line
    indent, at = _breaks(line, width, margin)
    ends = zip((0, *at), (*at, len(line)), strict=True)
    return f"\n{indent}".join(line[first:last].rstrip() if at else line for first, last in ends)


def between_terms(formula: str) -> str:
    """A formula that is broken in front of signs only."""
    return re.sub(r" (?![-+=<>!]+ )", UNBROKEN, formula)


def _breaks(line: str, width: int, margin: int | None = None) -> tuple[str, list[int]]:
    """What stands before the further lines, and where these begin: at words, so that none is wider that need not be.

    Within brackets only where nothing outside of them is near.
    """
    before = len(line) - len(line.lstrip(" "))
    indent, at, start, room = " " * (before + HANGING if margin is None else margin), list[int](), 0, width
    depths = list(accumulate((_BRACKETS.get(x, 0) for x in line), initial=0))
    begun: list[int] = []
    for first, last in _words(line, width - len(indent)):
        begun.append(first)
        while last - start > room and first > max(start, before):
            near = [x for x in begun if x > max(start, before) and x - start >= NEAR * room]
            cut = min(reversed(near), key=depths.__getitem__, default=first)
            at.append(cut)
            start, room = cut, width - len(indent)
    return indent, at


#: A line is broken outside of brackets if so much of it is full there.
NEAR = 0.35
_BRACKETS = {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}


def _words(line: str, widest: int) -> Iterator[tuple[int, int]]:
    """Where words begin and end; a sign is one with what is behind it, and what would be too wide is several."""
    for word in re.finditer(r"(?:[-+=<>]+ )?[^ \t\n]+", line):
        inner = f"[^{UNBROKEN}]+" if word.end() - word.start() > widest else ".+"
        yield from (part.span() for part in re.compile(inner).finditer(line, *word.span()))


#: What rich takes for a terminal though the output is none.
_FORCED = ("FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE")
#: What it drops from texts: they move a cursor.
_CONTROLS = dict.fromkeys((7, 8, 11, 12, 13))


def tell(*parts: str | tuple[str, str], indent: int = 0, whole: bool = False, margin: int | None = None) -> None:
    """A line of words, some with a style, as rich prints it; into a file or pipe without waiting for rich.

    One that is ``whole`` is not wrapped.  ``margin``: where further lines begin; spaces may be ``UNBROKEN`` then.
    """
    if sys.stdout.isatty() or any(name in os.environ for name in _FORCED):
        from rich.text import Text

        text = Text.assemble(" " * indent, *parts)
        if whole or asked_width() is None:
            text.plain = text.plain.replace(UNBROKEN, " ")
        if margin is None:
            console().print(text, soft_wrap=whole or None)
        else:
            console().print(text, margin=margin)  # type: ignore[call-arg]
        return
    words = " " * indent + "".join([part if isinstance(part, str) else part[0] for part in parts])
    width = None if whole else asked_width()
    lines = [wrapped(line.expandtabs(), width, margin) for line in words.translate(_CONTROLS).split("\n")]
    print("\n".join(lines).replace(UNBROKEN, " "))


def show(lines: Iterable[Line], indent: int = 2) -> None:
    """Lines of a document, so far to the right."""
    for parts, whole, margin in lines:
        tell(" " * indent, *parts, whole=whole, margin=None if margin is None else margin + indent)


#: The bars that move, each with a thread of its own.
_MOVING: list[Progress] = []


@contextmanager
def _moving(bar: Progress) -> Iterator[None]:
    _MOVING.append(bar)
    try:
        yield
    finally:
        _MOVING.remove(bar)


@contextmanager
def paused() -> Iterator[None]:
    """No bar moves meanwhile: what copies the process wants it with one thread."""
    for bar in _MOVING:
        bar.stop()
    try:
        yield
    finally:
        for bar in _MOVING:
            bar.start()


def read_description(
    path: Path, unconstrained: str = "", moving: str = "", instead: str = "", free: bool = True, writes: bool = True
) -> System | None:
    """The system of a file, or None after printing every complaint on standard error.

    Unless functions of time may stay ``free`` their laws are put in, and those that have none are complained about.

    ``unconstrained`` names a command that does not know constraints: relations that give coordinates are put in, others
    are complained about, with what works ``instead``.  ``moving`` names one that needs equations of motion, which a
    system that is given by its matrices has not.  ``writes``: that nothing was written is said where there are errors.
    """
    from mbsym.model.substitution import lacking_law, with_laws
    from mbsym.report.language import Language
    from mbsym.source import load, render
    from mbsym.source.text_lines import language_of

    system, complaints, text = load(path)
    say = Language(language_of(text)).say
    if system is not None and (system.constraints or system.linear) and not complaints.errors:
        from mbsym.analysis.soundness import complain as complain_of

        complain_of(system, complaints)
    if system is not None and system.constraints and unconstrained and not complaints.errors:
        system = _in_free_coordinates(path, system, unconstrained, instead, complaints)
    if system is not None and not free:
        system = with_laws(system)
        for function in system.given:
            message, hint = lacking_law(function.name)
            complaints.error("no-law", message, function.span, hint)
    if system is not None and system.linear is not None and moving:
        words = "'mbsym [[command]]' is about bodies, and this system is given by its matrices"
        message = Message(words, command=moving)
        complaints.error("given-by-matrices", message, system.linear.span, "'mbsym run' judges its stability")
    for complaint in complaints.sorted():
        diagnose(render(complaint, text, str(path), say))
    if count := len(complaints.errors):
        complain(path, say(counted(count) if writes else Message("errors: [[count]]", count=count)))
    return None if complaints.errors else system


def counted(errors: int) -> Message:
    """The last line where there are errors, of what would have written something."""
    many = "[[count]] errors; nothing was written." if errors > 1 else "[[count]] error; nothing was written."
    return Message(many, count=errors)


def _in_free_coordinates(path: Path, system: System, command: str, instead: str, complaints: Complaints) -> System:
    """The system in the coordinates that relations leave, which is said; a complaint about each other constraint."""
    from mbsym.analysis.constrained import in_free_coordinates
    from mbsym.model.constraints import is_holonomic
    from mbsym.report.language import Language

    free = in_free_coordinates(system)
    for one in free.constraints:
        words = "'mbsym [[command]]' takes no constraint but relations that give a coordinate by others"
        why = "coordinates that keep it will do, too, or  relation: x = r*phi; a closed loop has none as a rule"
        if not is_holonomic(one):
            why = "no coordinates keep it, unless it follows from a relation: then write that,  relation: x = r*phi"
        hint = joined((Message(instead), Message(why)), "; ") if instead else Message(why)
        complaints.error("constraints", Message(words, command=command), one.span, hint)
    if not free.constraints:
        names = ", ".join(name for name in system.coordinates if name not in free.coordinates)
        words = "note: for '[[command]]' the relations are put in, and [[names]] left out"
        complain(path, Language(system.language).say(Message(words, command=command, names=names)))
    return free


def read_held(
    file: Path, command: str, constrained: bool = False, moving: bool = True, instead: str = ""
) -> System | None:
    """The system of a file with its inputs at the values of the unperturbed motion, which is said.

    A command that is ``constrained`` knows constraints, others refuse them; one that is not about ``moving`` bodies
    takes systems that are given by their matrices, too.
    """
    from mbsym.expressions.tree import text
    from mbsym.model.substitution import held

    system = read_description(file, "" if constrained else command, command if moving else "", instead, free=False)
    if system is None or not system.inputs:
        return system
    from mbsym.report.language import Language

    values = ", ".join(f"{quantity.name} = {text(quantity.held)}" for quantity in system.inputs)
    words = "note: for '[[command]]' the inputs are constant, as on the unperturbed motion: [[values]]"
    complain(file, Language(system.language).say(Message(words, command=command, values=values)))
    return held(system)


def printable(path: Path | str) -> str:
    """A name of a file for people: what could move a cursor or a title is written as an escape."""
    return escaped(os.fsencode(path).decode("utf-8", "backslashreplace"))


#: So much of a file is read to see which language it asks for.
_LOOK = 1_000_000


def speaking(*files: Path | str) -> Callable[[str], str]:
    """Says messages in the language of these descriptions."""
    return language_of_files(*files).say


def language_of_files(*files: Path | str) -> Language:
    """The language of these descriptions; English where they differ, or are none."""
    from mbsym.report.language import Language
    from mbsym.source.text_lines import language_of

    languages = set()
    for file in files:
        try:
            if not Path(file).is_file():  # a pipe would be emptied
                raise FileNotFoundError
            with Path(file).open("rb") as stream:
                languages.add(language_of(stream.read(_LOOK).decode("utf-8", "replace")))
        except (OSError, ValueError):
            languages.add("")
    return Language(languages.pop() if len(languages) == 1 else "")


def complain(path: Path | str, text: str, say: Callable[[str], str] | None = None) -> None:
    """A line about a file on standard error, in the language of that description unless another is given."""
    said = (say or speaking(path))(text)
    print(wrapped(f"{printable(path)}: {said}", asked_width(stderr=True)), file=sys.stderr, flush=True)


def diagnose(text: str) -> None:
    """A rendered complaint on standard error; on a terminal its lines are wrapped, but for what it quotes."""
    width = asked_width(stderr=True)
    for line in text.split("\n"):
        print(line if re.match(r" *\d* \|", line) else wrapped(line, width), file=sys.stderr)


def defect(error: BaseException, where: Path | str | None = None) -> None:
    """Tells of an exception nobody foresaw, too little memory, a missing part; with ``--debug``, where it came from."""
    DEFECTS.told.add(described(error))
    text = Message("internal error, please report it: [[error]]", error=escaped(described(error)))
    if part := missing(error):
        text = Message("[[part]] is not installed", part=part)
    elif isinstance(error, MemoryError):
        text = Message("out of memory; lower --terms, or ask for fewer --problems")
    print(text if where is None else f"{printable(where)}: {speaking(where)(text)}", file=sys.stderr)
    trace(error)


def trace(error: BaseException) -> None:
    """The traceback of an exception, if it is wanted."""
    if Debugging.wanted:
        print("".join(traceback.format_exception(error)), end="", file=sys.stderr)


def described(error: BaseException) -> str:
    """Its kind and what it says."""
    text = str(error)
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def reason_of(error: OSError) -> str:
    """What the system says of a file, with its name."""
    said = error.strerror or str(error)
    return said if error.filename is None else f"{printable(str(error.filename))}: {said}"


def among(names: Callable[[], Iterable[str]]) -> Callable[[click.Context, click.Parameter, str], Any]:
    """For ``shell_complete``: the names that begin as what was typed; they are looked up when a shell asks."""
    return lambda context, parameter, typed: [name for name in names() if name.startswith(typed)]


class OutPath(click.Path):
    """Where to write.  An empty text (a shell's unset variable) is no path: it would mean the current folder."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        if not str(value).strip():
            self.fail(Message("it is empty (an unset variable?); write . for this folder"), param, ctx)
        return super().convert(value, param, ctx)


# What is being done, on standard error: words with a bar, or a bar over simulated time or whatever is counted.


@contextmanager
def watching(quiet: bool, name: str) -> Iterator[Watch]:
    """What a study is doing, and a bar that fills where that is counted; nothing where there is no terminal."""
    if quiet or not sys.stderr.isatty():
        yield unwatched
        return
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    words = TextColumn("{task.description}", markup=False)
    bar = Progress(
        SpinnerColumn(), words, BarColumn(), TimeElapsedColumn(), console=console(stderr=True), transient=True
    )
    with bar, _moving(bar):
        task = bar.add_task(printable(name), total=None)
        said, shown = "", 0.0

        def watch(text: str, done: float = 0.0, whole: float = 0.0) -> None:
            nonlocal said, shown
            now = time.monotonic()
            if text != said or now - shown > 0.05:
                said, shown = text, now
                description = f"{printable(name)}: {printable(text)}" if text else printable(name)
                bar.update(task, description=description, completed=done, total=whole or None)

        yield watch
