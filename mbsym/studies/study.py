"""A study as a value: a request, what derives, and what of the result is said and written."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Generic, Protocol, TypeVar

from mbsym.expressions.message import Message, joined, worded

if TYPE_CHECKING:
    from mbsym.expressions.place import Span
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario
    from mbsym.report.content import Block
    from mbsym.report.plain_writer import Line as Written
    from mbsym.report.whole_run import Beside


T = TypeVar("T")


class Exit(IntEnum):
    """Exit codes of commands: everything held; a result is missing or failed its check; the input is wrong; what was
    done ended early; the user stopped it (as shells count the signal)."""

    OK = 0
    FAILED = 1
    BAD_INPUT = 2
    BROKEN_DOWN = 3
    INTERRUPTED = 130


@dataclass(frozen=True)
class Line:
    """A line of the terminal: parts, some with a style.

    One that is ``whole`` is never broken into several; ``always``: it is what ``--quiet`` leaves.
    """

    parts: tuple[str | tuple[str, str], ...]
    whole: bool = False
    always: bool = False


def line(*parts: str | tuple[str, str], whole: bool = False, always: bool = False) -> Line:
    return Line(parts, whole, always)


def heading(text: str) -> Line:
    return line("  ", (text, "bold cyan"))


class Watch(Protocol):
    """Is told what is being done and, where that is counted, how much of the ``whole``."""

    def __call__(self, text: str, done: float = 0.0, whole: float = 0.0) -> None: ...


def unwatched(text: str, done: float = 0.0, whole: float = 0.0) -> None:
    """Nobody looks on."""


class Remember(Protocol):
    """``measure()`` answers the ``question``, or an earlier answer does, unless it is asked ``anew``.

    Returns the answer, and whether it is an earlier one; only ``sound`` answers are kept for later.
    """

    def __call__(
        self, question: Sequence[str], measure: Callable[[], Any], sound: Callable[[Any], bool], anew: bool
    ) -> tuple[Any, bool]: ...


def unremembered(
    question: Sequence[str], measure: Callable[[], Any], sound: Callable[[Any], bool], anew: bool
) -> tuple[Any, bool]:
    """Nobody remembers anything."""
    return measure(), False


#: What is said of an answer that an earlier command found.
BEFORE = "measured by an earlier command, seconds too; --anew measures again"


def identity(scenario: Scenario) -> str:
    """A text that two scenarios share only if they are the same motion of the same description."""
    from mbsym.source.yaml_writer import meaning

    numbers = {name: getattr(scenario, name) for name in scenario.__dataclass_fields__ if name != "system"}
    return repr((meaning(scenario.system), numbers))


@dataclass(frozen=True)
class Screen:
    """Where a result is told: ``width`` columns, None in a file or pipe, or ``quiet``, nowhere.

    ``names`` of all descriptions, this one's among them; ``seconds()`` since the study of this one began.
    """

    width: int | None = None
    quiet: bool = False
    names: Sequence[str] = ()
    seconds: Callable[[], float] = lambda: 0.0


@dataclass(frozen=True)
class Asked:
    """What a study is about: the description, with the values of the request where it is of one motion.

    ``file``: its name, for commands to be pasted; ``folder``: where its files go, ``write`` writes one at once, whole.
    ``typed``: the texts of what was given on the command line, by the names of fields and of ``as_json``, ``out``, ...;
    ``store``: opens a file of nobody else's, on the disk of the folder, for what does not fit into memory; ``remember``
    knows what was measured before; ``letters``: the author's, in which formulas are written, None where nothing was
    said of them; ``spoken``: the language in which all is said, where it is not that of the description; ``beside``:
    who helps; ``unchanged`` lists the files that a command wrote into the folder and that are as it wrote them.
    """

    system: System
    scenario: Scenario | None = None
    file: str = ""
    folder: Path = Path()
    write: Callable[[Path, bytes], object] = Path.write_bytes
    typed: Mapping[str, Any] = field(default_factory=dict)
    store: Callable[[], BinaryIO | None] = lambda: None
    remember: Remember = unremembered
    letters: tuple[str, ...] | None = None
    spoken: str = ""
    beside: Beside | None = None
    unchanged: Callable[[str], Sequence[str]] = lambda command: ()
    screen: Screen = Screen()

    @property
    def language(self) -> str:
        return self.spoken or self.system.language

    def measured(
        self,
        what: str,
        scenario: Scenario,
        how: object,
        measure: Callable[[], T],
        anew: bool,
        sound: Callable[[T], bool] = lambda found: True,
    ) -> tuple[T, bool]:
        """``what`` is asked of a motion, in all ``how``: the answer, and whether an earlier command found it."""
        if self.remember is unremembered:
            return measure(), False
        found: tuple[T, bool] = self.remember((what, identity(scenario), repr(how)), measure, sound, anew)
        return found

    @property
    def motion(self) -> Scenario:
        assert self.scenario is not None, "a study with Settings is of one motion"
        return self.scenario


@dataclass(frozen=True)
class Answer:
    """What is said of a result: ``lines`` beneath the system's name, ``files``, and ``complaints`` after them.

    Of blocks, and of complaints that are messages, the language is that of the description.  ``after``: what stands
    behind the name of the description; ``brief``: the blocks that ``--quiet`` leaves; ``last``: lines beneath the names
    of files.  ``owner``: the command whose set the files are, unless it is that of the study; ``more``: what is said
    behind their names; ``stopped``: what broke off the making of some of them, which is raised when the others have
    been written; ``text``: what is printed as it is, and nothing else, for other programs; ``breaks``: a terminal may
    break its lines, between the terms of formulas.  ``bare``: the lines stand alone; ``listed``: the names of files
    beneath them.  ``gone``: of files that were written before, those that are to go, None: whatever is not among
    ``files``.  ``defects``: exceptions that nobody foresaw, and that were contained.
    """

    lines: Iterable[Line | Written | Block] = ()
    files: Mapping[str, str | bytes | Iterable[str]] = field(default_factory=dict)
    complaints: Sequence[str] = ()
    code: Exit = Exit.OK
    after: str = ""
    brief: Iterable[Block] = ()
    last: Iterable[Line] = ()
    owner: str = ""
    more: str = ""
    stopped: BaseException | None = None
    text: str | None = None
    breaks: bool = False
    bare: bool = False
    listed: bool = True
    gone: Collection[str] | None = None
    defects: Sequence[BaseException] = ()


@dataclass(frozen=True)
class Document:
    """The text of a single file, None where there is none, complaints about it; ``told`` stands behind its name."""

    text: str | None
    complaints: Sequence[str] = ()
    told: str = ""


@dataclass(frozen=True)
class Refusal:
    """What is said of an exception that ends a study, in a line and ``more`` of them."""

    text: str
    code: Exit = Exit.FAILED
    more: Sequence[str] = ()


#: In place of an option where the description is at fault: complaints begin with its name.
DESCRIPTION = ""


@dataclass(frozen=True)
class Unfit:
    """An option that does not go with the others, or with the system; of several values, that of a ``name``.

    ``text``: what was typed, where ``span`` is the place in it that is at fault.
    """

    option: str
    code: str
    message: str
    hint: str | None = None
    name: str = ""
    text: str = ""
    span: Span | None = None


@dataclass(frozen=True)
class Apart:
    """Two options that do not go together, and why; one may have its value, ``--method midpoint``."""

    option: str
    other: str
    why: str
    hint: str | None = None

    def unfit(self, options: Collection[str]) -> Iterator[Unfit]:
        """Where both were given."""
        if self.option in options and self.other in options:
            words = "[[option]] does not go with [[other]]: [[why]]"
            message = Message(words, option=self.option, other=self.other, why=worded(self.why))
            yield Unfit(self.option.split()[0], "conflicting-options", message, self.hint)


@dataclass(frozen=True)
class Needed:
    """An option that says something of another one only."""

    option: str
    other: str
    hint: str

    def unfit(self, options: Collection[str]) -> Iterator[Unfit]:
        """Where it was given without that one."""
        if self.option in options and self.other not in options:
            message = Message("[[option]] goes with [[other]]", option=self.option, other=self.other)
            yield Unfit(self.option, "missing-option", message, self.hint)


@dataclass(frozen=True)
class Among:
    """An option that says something only where a ``word`` is on the list of another one, and why."""

    option: str
    other: str
    word: str
    why: str
    hint: str

    def unfit(self, options: Collection[str]) -> Iterator[Unfit]:
        """Where that list was given without it."""
        lists = [text.removeprefix(f"{self.other} ") for text in options if text.startswith(f"{self.other} ")]
        words = {word.strip() for text in lists for word in text.split(",")}
        if self.option in options and lists and words.isdisjoint((self.word, "all")):
            yield Unfit(self.option, "conflicting-options", self.why, self.hint)


class NotFit(Exception):
    """A request that does not go with what was derived first."""

    def __init__(self, reasons: Sequence[Unfit]) -> None:
        super().__init__("; ".join(reason.message for reason in reasons))
        self.reasons = tuple(reasons)


@dataclass(frozen=True)
class Folder:
    """Files go into a folder; ``quiet``: whether there is an option to print nothing else, and what of.

    ``unwritten``: what is said of these options where nothing is written, ``alone``: of ``--json`` where something is;
    ``help`` of ``--out``; ``json``: whether one of the files is JSON, which ``--json`` prints.
    """

    quiet: str | None = "Print only what went wrong."
    unwritten: tuple[str, str, str] | None = None
    help: str = "Folder.  [default: reports/NAME]"
    alone: tuple[str, str, str] | None = None
    json: bool = False


@dataclass(frozen=True)
class Single:
    """One file is written where ``--out`` says so; ``help`` of that option, ``usual``: its name without it."""

    help: str
    usual: str = ""


R = TypeVar("R")
F = TypeVar("F")


def _nothing(*_: Any) -> Iterator[Unfit]:
    return iter(())


@dataclass(frozen=True)
class Study(Generic[R, F]):
    """One command.

    ``derive(asked, request, watch)`` finds the result; ``answer(asked, request, result)`` tells it, ``json`` as the
    text that ``--json`` prints.  ``refusal`` tells of the exceptions that are answers.  ``unfit(asked, request)`` says
    what of a request does not go together; fields that could not be read are None there, but among those that were
    ``typed``.  ``pairs``: options that do not go together, or not alone, whatever the system is.

    ``constraints``, ``matrices``: whether descriptions with these are understood, ``instead``: what works under
    constraints where they are not, ``bodies``: whether matrices are not, by the texts of the options; ``held``: whether
    inputs are held at their constant values; ``free``: whether functions of time without a law are understood.
    ``out``: where files go; ``writes``: whether there are any, by what was typed; ``document`` makes the single one.
    ``timed``: whether the seconds are told. ``letters``: whether formulas are written in the author's letters.
    ``several``: whether many descriptions, and folders of them, may be asked about at once; ``together`` compares their
    results. ``rare``: fields whose options stand in ``mbsym explain`` where ``--help`` would fill more than a screen.
    """

    name: str
    request: type[R]
    derive: Callable[[Asked, R, Watch], F]
    answer: Callable[[Asked, R, F], Answer]
    refusal: Callable[[Exception, Asked, R], Refusal | None]
    unfit: Callable[[Asked, R], Iterator[Unfit]] = _nothing
    json: Callable[[Asked, R, F], str] | None = None
    json_help: str = "Print JSON instead of a summary."
    constraints: bool = False
    instead: str = ""
    matrices: bool = False
    bodies: Callable[[Mapping[str, Any]], bool] = lambda texts: False
    held: bool = True
    free: bool = False
    out: Folder | Single | None = Folder()
    writes: Callable[[Collection[str]], bool] = lambda typed: True
    document: Callable[[Asked, R, F], Document] | None = None
    timed: bool = False
    letters: bool = False
    pairs: Sequence[Apart | Needed | Among] = ()
    several: bool = False
    together: Callable[[Sequence[tuple[Asked, R, F]]], Iterable[Block]] | None = None
    rare: Collection[str] = ()


#: The last line of what would have written something.
NOTHING_WRITTEN = Message("nothing was written.")


def refused(before: str, error: Exception, code: Exit = Exit.FAILED) -> Refusal:
    """What could not be had, why, and what to try next."""
    from mbsym.algebra.failures import message_of

    why = joined(filter(None, (message_of(error), getattr(error, "remedy", ""))), "; ")
    return Refusal(joined((Message(before), why), ": "), code)


def failed(error: Exception, before: str) -> Refusal | None:
    """Of exact studies: what could not be derived, and why."""
    from mbsym.algebra.failures import Failure

    return refused(before, error) if isinstance(error, Failure) else None


def no_program(error: Exception, context: Asked, request: object) -> Refusal | None:
    """Of studies that compile equations: where these have no program."""
    return failed(error, "error[no-program]: there is no program for these equations")


_LACKING = {
    "value": "no value for [[names]]",
    "number": "no number for [[names]]",
    "rational number": "no rational number for [[names]]",
}


def missing(shown: Sequence[str], what: str = "value", led: bool = False) -> Unfit:
    """One complaint about all names without a value; a coordinate is shown as ``x (its initial position)``.

    ``led``: positions are led to constraints, so that rough ones will do.
    """
    names = [name.split(" ")[0] for name in shown]
    positions = [name for name, shown_name in zip(names, shown, strict=True) if " " in shown_name]
    example = " ".join(f"--set {name}=1" for name in names[:3]) + (" ..." if len(names) > 3 else "")
    places = []
    if len(positions) < len(names):
        first = next(name for name in names if name not in positions)
        places.append(f"values: {{{first}: 1, ...}}")
    if positions:
        places.append(f"initial: {{{positions[0]}: 1, ...}}")
    hint = Message("[[example]], or in the file  [[places]]", example=example, places=",  ".join(places))
    if led and positions:
        hint = Message("[[hint]]; a position near the one that is meant will do: constraints lead it there", hint=hint)
    suffix = " (its initial position)"
    listed = joined(
        (Message("[[name]] (its initial position)", name=x.split(" ")[0]) if x.endswith(suffix) else x for x in shown),
        ", ",
    )
    return Unfit(DESCRIPTION, "missing-value", Message(_LACKING[what], names=listed), hint)
