"""Values of options, read one and all before anything is computed: complaints are collected and printed at once.

Every complaint has one look, ``--option: error[code]: what is wrong``, the guilty piece and a hint where these help.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterable, Sequence
from pathlib import Path

from mbsym.expressions.message import Message, worded
from mbsym.expressions.place import Complaint, Complaints, Span
from mbsym.expressions.safe import quoted as ascii_safe
from mbsym.problems import NUMBERS, ranges
from mbsym.source import render_option
from mbsym_cli.console import counted, diagnose, printable

#: The text of an option has at most so many characters.
MAX_LENGTH = 2_000

#: Descriptions end in one of these.
SUFFIXES = (".yaml", ".yml", ".txt")

DESCRIPTIONS_HAVE = Message(
    "a description has the key 'mbsym', and its name ends in [[suffixes]]", suffixes=", ".join(SUFFIXES)
)


def nothing_here(others: int) -> Message:
    """What is said where there are no descriptions, but so many other files."""
    if not others:
        return Message("there are no descriptions here")
    if others == 1:
        return Message("there are no descriptions here (1 other file was passed over)")
    return Message("there are no descriptions here ([[count]] other files were passed over)", count=others)


#: Words that resemble each other as much (1: equal) are taken for slips.
_MISSPELT = 0.7


class Options:
    """Reads the texts of options; whatever cannot be read is None and one of the ``complaints``."""

    def __init__(self) -> None:
        self.complaints: list[str] = []
        self.say: Callable[[str], str] = str  # the language of the description, once it is read

    def add(self, option: str, text: str, *complaints: Complaint) -> None:
        """Complaints about an option, with the place in its ``text`` where they have one."""
        self.complaints += [render_option(complaint, text, option, self.say) for complaint in complaints]

    def complain(self, option: str, code: str, message: str, hint: str | None = None) -> None:
        self.add(option, "", Complaint(code, message, None, hint))

    def complain_whole(self, option: str, text: str, code: str, message: str, hint: str | None = None) -> None:
        """Of a text as a whole, which is shown."""
        self.add(option, text, Complaint(code, message, Span(1, 1, max(1, len(text))), hint))

    def sort(self, options: Sequence[str]) -> None:
        """Complaints in the order of these options, what is not about one of them behind."""

        def place(complaint: str) -> int:
            option = complaint.split(":")[0].split(" ")[0]
            return options.index(option) if option in options else len(options)

        self.complaints.sort(key=place)

    def refused(self, file: Path | None = None) -> bool:
        """Whether there is anything to complain about; then it is printed (of no ``file``: of the options alone)."""
        if not self.complaints:
            return False
        whose = "options" if file is None else printable(file)
        diagnose("\n".join(self.complaints))
        print(f"{whose}: {self.say(counted(len(self.complaints)))}", file=sys.stderr)
        return True

    def descriptions(self, files: Iterable[Path]) -> list[Path]:
        """The files, each once; a folder stands for the descriptions in it, by name and YAML before plain text.

        What lies in a folder and does not say that it is a description is passed over.
        """
        from mbsym.source.text_lines import is_description

        paths: dict[str, Path] = {}
        others = 0
        for path in files:
            inside = [path]
            if os.path.isdir(path):
                try:
                    named = [child for child in path.iterdir() if child.suffix in SUFFIXES]
                except OSError as error:
                    self.complain(
                        str(path), "unreadable", Message("the folder cannot be read: [[why]]", why=error.strerror)
                    )
                    continue
                inside = [child for child in named if is_description(child)]
                inside.sort(key=lambda child: (child.stem, SUFFIXES.index(child.suffix)))
                others += len(named) - len(inside)
            for description in inside:
                paths.setdefault(identity_of(description), description)
        if not paths and not self.complaints:
            self.complain(", ".join(map(str, files)), "no-descriptions", nothing_here(others), DESCRIPTIONS_HAVE)
        return list(paths.values())

    def unwritten(self, option: str, path: Path | None) -> None:
        """Complains of a file to be written that is there already."""
        from mbsym_cli.files import taken

        if path is not None and taken(path):
            self.complain(
                option, "exists", Message("[[file]] is there already", file=printable(path)), "another name, or --force"
            )

    def problems(self, text: str) -> tuple[int, ...]:
        """``--problems``: ``1-5``, ``1,3,5`` or ``6``."""
        numbers: set[int] = set()
        for part in (part.strip() for part in text.split(",")):
            first, dash, last = (piece.strip() for piece in part.partition("-"))
            ends = (first, last) if dash else (first, first)
            if not all(end.isascii() and end.isdigit() and len(end) < 10 for end in ends):
                hint = "write for example 1-5 or 1,3,6"
                self.complain("--problems", "bad-number", Message("'[[text]]' is no problem number", text=part), hint)
                continue
            low, high = map(int, ends)
            if low > high:
                hint = Message("a range goes upwards: write [[example]]", example=f"{last}-{first}")
                self.complain("--problems", "bad-range", Message("the range [[text]] is empty", text=part), hint)
                continue
            wrong = [n for n in dict.fromkeys((low, high)) if n not in NUMBERS]
            if wrong:
                message = Message("there is no problem [[number]]", number=wrong[0])
                if len(wrong) > 1:
                    words = "there is no problem [[first]] and no problem [[last]]"
                    message = Message(words, first=wrong[0], last=wrong[1])
                hint = Message("problems are numbered [[numbers]]", numbers=ranges())
                self.complain("--problems", "unknown-problem", message, hint)
                continue
            numbers.update(number for number in NUMBERS if low <= number <= high)
        return tuple(sorted(numbers))

    def number(self, option: str, text: str | None, least: float = 0.0, most: float | None = None) -> float | None:
        """A positive number made of numbers and pi (``2*pi``, ``1e-3``), between bounds."""
        if text is None:
            return None
        from mbsym.algebra.failures import Failure, message_of
        from mbsym.expressions.parser import parse_expression
        from mbsym.expressions.tree import CONSTANTS, Name, walk
        from mbsym.numerics.scenario import exact

        text = " ".join(text.splitlines())
        wrong = Complaints()
        value, whole = None, Span(1, 1, max(1, len(text)))
        if len(text) > MAX_LENGTH:
            wrong.error("bad-number", "this number is too long")
        else:
            value = parse_expression(text, wrong, named=False)
        if value is not None:
            for node in walk(value):
                if isinstance(node, Name) and node.name not in CONSTANTS and node.span is not None:
                    wrong.error(
                        "unknown-name",
                        Message("a number is wanted here, not [[name]]", name=ascii_safe(node.name)),
                        node.span,
                    )
        evaluated = None
        if value is not None and not wrong.errors:
            try:
                evaluated = float(exact(value, {}))
            except Failure as reason:
                wrong.error("bad-number", Message("it has no value: [[why]]", why=message_of(reason)), whole)
            else:
                within = None
                if most is not None:
                    within = Message("it is at most [[most]]", most=f"{most:g}")
                if most is not None and least:
                    within = Message("choose between [[least]] and [[most]]", least=f"{least:g}", most=f"{most:g}")
                if not evaluated > 0:
                    wrong.error("bad-number", "it must be positive", whole, within if least else None)
                elif evaluated < least or (most is not None and evaluated > most):
                    wrong.error("bad-number", within or Message("it is at least [[least]]", least=f"{least:g}"), whole)
        self.add(option, text, *wrong.sorted())
        return None if wrong.errors else evaluated

    def whole(self, option: str, text: str | None, least: int, most: int, why: str = "") -> int | None:
        """A whole number between bounds; ``why`` says what the lower one is for."""
        if text is None:
            return None
        short = text.strip()
        digits = short.removeprefix("-").removeprefix("+")
        if not (digits.isascii() and digits.isdigit() and len(digits) <= 30):
            self.complain(
                option, "bad-number", Message("a whole number is wanted, not [[text]]", text=ascii_safe(text))
            )
            return None
        value = int(short)
        if not least <= value <= most:
            message = Message("[[value]] is out of bounds: at most [[most]]", value=value, most=most)
            if value < least:
                bounds = "[[value]] is out of bounds: at least [[least]][[why]]"
                message = Message(bounds, value=value, least=least, why=worded(why))
            self.complain(option, "bad-number", message)
            return None
        return value

    def word(self, option: str, text: str, choices: Collection[str], what: str) -> str | None:
        """One of a few words."""
        if text in choices:
            return text
        self._unknown(option, text, choices, what)
        return None

    def words(
        self,
        option: str,
        text: str,
        choices: Collection[str],
        what: str,
        every: str = "",
        of_them: Collection[str] | None = None,
    ) -> tuple[str, ...]:
        """Some of a few words, separated by commas, each once; ``every`` stands for all of them, or ``of_them``."""
        named = [part.strip().lower() for part in text.split(",") if part.strip()]
        usual = tuple(choices if of_them is None else of_them)
        chosen = tuple(dict.fromkeys(x for part in named for x in (usual if every and part == every else (part,))))
        for name in chosen:
            if name not in choices:
                self._unknown(option, name, [*choices, every] if every else choices, what)
        if not chosen:
            self.complain(
                option,
                f"unknown-{what}",
                Message("there is no [[what]] in it", what=worded(what)),
                _listed(choices, every),
            )
        return tuple(name for name in chosen if name in choices)

    def _unknown(self, option: str, name: str, choices: Iterable[str], what: str) -> None:
        from mbsym.source.scope import closest

        known = list(choices)
        close = closest(name, known, _MISSPELT)
        hint = _listed(known)
        if close:
            words = "did you mean '[[other]]'? There are [[names]]"
            hint = Message(words, other=close, names=", ".join(known))
        message = Message("there is no [[what]] [[name]]", what=worded(what), name=ascii_safe(name))
        self.complain(option, f"unknown-{what}", message, hint)


def _listed(choices: Iterable[str], every: str = "") -> Message:
    names = ", ".join(choices)
    if every:
        return Message("choose from [[names]] or [[every]]", names=names, every=every)
    return Message("choose from [[names]]", names=names)


def identity_of(path: Path) -> str:
    """The same for two names of one file; the name itself where links lead nowhere."""
    try:
        return os.path.realpath(path)
    except (OSError, ValueError):  # the current folder is gone; a name with a NUL
        return str(path)
