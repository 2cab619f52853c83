"""Content as plain text, for the terminal and for comments: sentences, and documents line by line."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import singledispatchmethod
from shlex import quote
from textwrap import wrap
from typing import Any, NamedTuple

from mbsym.expressions.message import GAP, Message, Said, pieces, plain_notation
from mbsym.expressions.safe import UNBROKEN
from mbsym.expressions.tree import Expression, Negative, Number, Operation, text
from mbsym.formulas.formula import Formula
from mbsym.formulas.python import readable_name
from mbsym.formulas.straight_line import Dialect, listing
from mbsym.report import content
from mbsym.report.content import Inline, say
from mbsym.report.language import Language

_DOTS = ("", "'", "''")
_SCRIPT = {"A": "\U0001d49c", "B": "\u212c", "C": "\U0001d49e", "D": "\U0001d49f"}
_DIALECT = Dialect(call=lambda function, argument: f"{function}({argument})", local=lambda count: f"s{count}")
#: How what is good, bad or open looks on the terminal, and titles.
STYLES = {"good": "green", "bad": "bold red", "open": "yellow"}
TITLE = "bold cyan"
#: More definitions of intermediate quantities, or steps of a program, are counted.
MOST_DEFINITIONS = 24
#: Longer formulas (in letters) are counted on the terminal: four lines of it.
LONGEST = 320
#: Longer relations may be broken, in letters.
MOST_UNBROKEN = 40
#: No column of words in a table is made narrower than that.
NARROW = 24
#: What is no longer stands in one line with the sign behind it.
_SHORT = 16


class Line(NamedTuple):
    """A line of a document: parts with their styles; one that is ``whole`` is drawn and never broken.

    ``margin``: where it goes on if it is broken.
    """

    parts: tuple[tuple[str, str], ...]
    whole: bool = False
    margin: int | None = None

    @property
    def text(self) -> str:
        return "".join(part for part, _ in self.parts).replace(UNBROKEN, " ")


@dataclass(frozen=True)
class Writer:
    """Sentences in a language; ``readable`` formulas are as people write them, others as Python reads them, unbroken.

    Formulas with a text of more than ``longest`` letters are counted, with the ``file`` that has them if there is one.
    What is drawn has at most ``width`` columns.  ``description``: the file that a command would name.
    """

    language: Language = field(default_factory=Language)
    readable: bool = False
    longest: int = sys.maxsize
    width: int = 100
    file: str = ""
    description: str = ""

    # --- text ---

    def said(self, sentence: Said) -> str:
        """A sentence with its gaps filled."""
        return "".join(text for text, _ in self.pieces(sentence))

    def pieces(self, value: Inline) -> Iterator[tuple[str, Inline]]:
        """What stands one after the other, each with the value that it is of: a screen may show them differently."""
        if isinstance(value, content.Phrase):
            for part in value.parts:
                yield from self.pieces(part)
        elif isinstance(value, content.Link):
            yield from self.pieces(value.text)
        elif isinstance(value, Said):
            parts = (
                self._unbroken_notation(plain_notation(x, self._power)) if inside else x
                for inside, x in pieces(self.language.text_of(value))
            )
            for k, text in enumerate(GAP.split("".join(parts))):
                if k % 2 == 0:
                    yield text, text
                    continue
                filled = value.gaps[text]
                if isinstance(filled, Sequence) and not isinstance(filled, str):
                    filled = content.joined(filled, ", ")
                yield from self.pieces(filled)
        else:
            yield self.inline(value), value

    def _unbroken_notation(self, written: str) -> str:
        """``K > 0`` stands in one line."""
        return written.replace(" ", UNBROKEN) if self.readable and len(written) <= _SHORT else written

    @property
    def _power(self) -> str:
        return "^" if self.readable else "**"

    def inline(self, value: Any) -> str:
        """What stands in a line."""
        match value:
            case Said() | Message():
                return self.said(value)
            case str():
                return self.language.say(value) if isinstance(value, StrEnum) else value
            case int():
                return str(value)
            case Formula():
                return self._formula(value)
            case content.Readable():
                return self._formula(value.value, "results.json" if value.kept and self.file else self.file)
            case content.Text():
                return "".join(map(self.inline, value.parts))
            case content.Phrase():
                return "".join(text for text, _ in self.pieces(value))
            case content.Numbered():
                return ""
            case content.Elsewhere():
                if not self.description:
                    return self.inline(value.link)
                return f"mbsym show {quote(self.description)} {value.name}".replace(" ", UNBROKEN)
            case content.Strong() | content.Graded() | content.Link():
                return self.inline(value.text)
            case content.Emphasis() | content.Verbatim() | content.Citation():
                return value.text
            case content.Unit():
                return f"[{value.text}]"
            case content.Name():
                name = value.name if value.ring is None or not self.readable else readable_name(value.ring, value.name)
                return name + _DOTS[value.dots] + (f"({value.at})" if value.at else "")
            case content.Symbol():
                letter = value.letter if value.look != "script" else _SCRIPT[value.letter]
                between = "" if len(value.letter) == 1 and value.lower[:1].isdigit() else "_"
                below = between + value.lower if value.lower else ""
                above = f"^{value.upper}" if value.upper else ""
                return letter + ("bar" if value.look == "bar" else "") + below + above + _DOTS[value.dots]
            case content.Entry():
                index = value.index if isinstance(value.index, str) else self.inline(value.index)
                return f"{self.inline(value.whole)}[{index}]"
            case content.Notation():
                return plain_notation(value.tex, self._power).strip()
            case content.Power():
                return f"{self.inline(value.base)}{self._power}{value.exponent}"
            case content.Listed():
                written = ", ".join(map(self.inline, value.items))
                return f"({written})" if value.brackets else f"{{{written}}}" if value.braces else written
            case content.Relation():
                return self._relation(value)
            case content.Number():
                return value.text
            case content.Rows():
                return f"[{', '.join(self.inline(content.Listed(row, brackets=True)) for row in value.rows)}]"
            case content.Raised():
                return f"{self.inline(value.of)}({value.index})"
            case content.Polynomial():
                signs = (self._power, UNBROKEN if self.readable else "*")
                written = in_powers(list(map(self.inline, value.coefficients)), value.variable, *signs)
                return written if value.power == 1 else f"({written}){self._power}{value.power}"
        if not self.readable:
            return text(value)
        primed = re.sub(r"_(d{1,2})ot\b", lambda m: "'" * len(m[1]), text(_divided_last(value)))
        return primed.replace("**", "^").replace("*", UNBROKEN)

    def _relation(self, value: content.Relation) -> str:
        written, before = "", None
        for x in value.told:
            piece = self.inline(x).strip()
            listed = isinstance(x, content.Listed) and x.brackets and not isinstance(x.items[0], Formula)
            called = listed and isinstance(before, content.Symbol)  # with formulas it would be a product
            factor = isinstance(before, content.Symbol) and not isinstance(x, str)
            close = self.readable and (factor or isinstance(before, str) or (x == "=" and len(written) <= _SHORT))
            behind = UNBROKEN if close else " "
            written += (
                "" if not written or called or piece[:1] in ":," or re.search("(^|=.)-$", written) else behind
            ) + piece
            before = x
        return written

    def _formula(self, value: Formula, file: str | None = None) -> str:
        if value.terms <= self.longest:
            written = value.readable() if self.readable else str(value)
            if len(written) <= self.longest:
                return re.sub(r" (?![-+] )", UNBROKEN, written) if self.readable else written
        return self._counted(say("[[count]] terms", count=str(value.terms)), self.file if file is None else file)

    def _counted(self, size: Said, file: str) -> str:
        return f"[{self.said(size)}{f': {file}' if file else ''}]"

    # --- blocks ---

    def document(self, blocks: Iterable[content.Block]) -> Iterator[Line]:
        """The blocks one after the other."""
        for block in blocks:
            yield from self.block(block)

    def _line(self, *parts: Inline, indent: int = 0, style: str = "") -> Line:
        shown = self._shown(parts, style)
        return Line(((" " * indent, ""), *shown) if indent else shown, bool(indent) and not self.readable)

    def _shown(self, parts: Iterable[Inline], style: str = "") -> tuple[tuple[str, str], ...]:
        """Parts with their styles; a short relation stands in one line."""
        pieces = [piece for part in parts for piece in self.pieces(part)]
        return tuple((self._unbroken(text, value), _style(value) or style) for text, value in pieces)

    def _unbroken(self, text: str, value: Inline) -> str:
        short = self.readable and isinstance(value, content.Relation) and len(text) <= MOST_UNBROKEN
        return text.replace(" ", UNBROKEN) if short else text

    @singledispatchmethod
    def block(self, value: Any) -> Iterator[Line]:
        """The lines of a block; formulas stand a little to the right."""
        raise TypeError(f"not a block: {value!r}")

    @block.register
    def _(self, value: content.Heading) -> Iterator[Line]:
        yield self._line(value.title, style=TITLE)

    @block.register
    def _(self, value: content.Subheading) -> Iterator[Line]:
        yield self._line(*value.parts, style=TITLE)

    @block.register
    def _(self, value: content.Paragraph) -> Iterator[Line]:
        yield self._line(*value.parts, style=STYLES["open"] if value.missing else "")

    @block.register
    def _(self, value: content.Display) -> Iterator[Line]:
        match value.value:
            case content.Relation((*left, content.Rows(rows))):
                drawn = self._drawn(self.inline(content.Relation(*left)), [list(map(self.inline, x)) for x in rows])
                if drawn:
                    yield from drawn
                    return
        parts = value.value if isinstance(value.value, tuple) else (value.value,)
        notes = (part for note in value.notes for part in (" (", note, ")"))
        yield self._line(*parts, *notes, indent=2)

    @block.register
    def _(self, value: content.Definitions) -> Iterator[Line]:
        yield self._line(value.words, ":")
        yield from (self._line(item, indent=2) for item in value.items)

    @block.register
    def _(self, value: content.Matrices) -> Iterator[Line]:
        symbol, rows = self.inline(value.symbol), [list(map(self.inline, row)) for row in value.value]
        if value.value.is_zero:
            yield self._line(f"{symbol} = 0", indent=2)
            return
        drawn = [] if value.packed else self._drawn(f"{symbol} =", rows)
        if drawn:
            yield from drawn
            return
        comma = "," if len(rows) > 9 else ""
        for i, row in enumerate(rows):
            for j, entry in enumerate(row):
                if entry != "0" and (j >= i or not value.symmetric):
                    yield self._line(f"{symbol}[{i + 1}{comma}{j + 1}] =", UNBROKEN, entry, indent=2)

    def _drawn(self, left: str, rows: list[list[str]]) -> list[Line]:
        """Rows in brackets behind ``left``, none where they are too wide."""
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        if len(left) + 5 + sum(widths) + 2 * len(widths) > self.width - 2:
            return []
        if len(rows) == len(rows[0]) == 1:
            return [Line(((f"  {left} {rows[0][0]}", ""),), whole=True)]
        middle = (len(rows) - 1) // 2
        before = [left if k == middle else " " * len(left) for k in range(len(rows))]
        cells = ["  ".join(map(str.center, row, widths)) for row in rows]
        return [Line(((f"  {x} [ {y} ]", ""),), whole=True) for x, y in zip(before, cells, strict=True)]

    @block.register
    def _(self, value: content.SideBySide) -> Iterator[Line]:
        return self.document(value.matrices)

    @block.register
    def _(self, value: content.Components) -> Iterator[Line]:
        symbol, entries = self.inline(value.symbol), list(map(self.inline, value.value))
        whole = f"{symbol} = " + ("0" if set(entries) == {"0"} else f"({', '.join(entries)})")
        if len(whole) <= self.width - 2:
            yield self._line(whole, indent=2)
            return
        for k, entry in enumerate(entries, start=1):
            yield self._line(f"{symbol}[{k}] =", UNBROKEN, entry, indent=2)

    @block.register
    def _(self, value: content.Itemised) -> Iterator[Line]:
        for k, item in enumerate(value.items, start=1):
            sign = f"{k}. " if value.numbered else "- "
            for line in self.document(item):
                yield Line(((sign, ""), *line.parts), line.whole)
                sign = " " * len(sign)

    @block.register
    def _(self, value: content.Table) -> Iterator[Line]:
        """Each row in a line, or columns under one another."""
        if value.aligned:
            yield from self._aligned(value)
            return
        shown = [k for k, column in enumerate(value.columns) if column.width]
        head = tuple((column.title,) for column in value.columns)
        if value.title is not None:
            yield self._line(value.title, style=TITLE)
        for row in (head, *value.rows):
            cells = (row[k] for k in shown if self.inline(content.Phrase(row[k])))
            parts = [part for cell in cells for part in (" | ", *cell)][1:]
            yield self._line(*parts, style="bold" if row is head else "")

    def _aligned(self, value: content.Table) -> Iterator[Line]:
        """Columns of words take several lines where that is needed; what is too wide even so follows beneath."""
        heads = [self.inline(column.title) for column in value.columns]
        rows = [[self._shown(cell) for cell in row] for row in value.rows]
        texts = [heads, *([_plain(cell) for cell in row] for row in rows)]
        widths = [max(map(len, cells)) for cells in zip(*texts, strict=True)]
        folded = [k for k, column in enumerate(value.columns) if column.fold]
        least = {k: max(min(widths[k], NARROW), *(len(x) for row in texts for x in row[k].split())) for k in folded}
        while folded and sum(widths) + 2 * len(widths) - 2 > self.width:
            k = max(folded, key=lambda k: widths[k] - least[k])
            if widths[k] <= least[k]:
                break
            widths[k] -= 1
        for group in self._groups(widths, _telling(texts[1:])):
            for number, row in enumerate(texts):
                cells = {k: self._wrapped(row[k], widths[k]) if k in folded else [row[k]] for k in group}
                styles = {k: TITLE if number == 0 else _first(rows[number - 1][k]) for k in group}
                for line in range(max(map(len, cells.values()), default=0)):
                    pieces = {k: cells[k][line] if line < len(cells[k]) else "" for k in group}
                    turned = {k: str.rjust if value.columns[k].right else str.ljust for k in group}
                    padded = [(turned[k](pieces[k], widths[k]), styles[k]) for k in group]
                    while len(padded) > 1 and not padded[-1][0].strip():
                        padded.pop()
                    last = ((padded[-1][0].rstrip(), padded[-1][1]),)
                    yield Line(tuple(x for piece in padded[:-1] for x in (piece, ("  ", ""))) + last, whole=True)

    @staticmethod
    def _wrapped(text: str, width: int) -> list[str]:
        return wrap(text, max(width, 1), break_long_words=False, break_on_hyphens=False) or [""]

    def _groups(self, widths: Sequence[int], front: int) -> Iterator[list[int]]:
        """Columns that fit beside each other; the first ``front`` (one, if these are wide) begin each group."""
        if sum(widths[:front]) + 2 * front > self.width // 2:
            front = 1
        before, taken_before = list(range(front)), sum(widths[:front]) + 2 * (front - 1)
        group, taken = list(before), taken_before
        for k, width in list(enumerate(widths))[front:]:
            if len(group) > front and taken + 2 + width > self.width:
                yield group
                group, taken = list(before), taken_before
            group.append(k)
            taken += 2 + width
        yield group if widths else []

    @block.register
    def _(self, value: content.Facts) -> Iterator[Line]:
        """Names in a column, and beside it what is said."""
        labels = [self.inline(fact.name) for fact in value.items]
        width = max(map(len, labels), default=0) + 2
        for label, fact in zip(labels, value.items, strict=True):
            for k, said in enumerate(fact.lines):
                deeper = width + 2 * isinstance(said, content.Under)
                name = (label.ljust(deeper), _style(fact.name) or TITLE) if k == 0 else (" " * deeper, "")
                yield Line((name, *self._shown((said,))), margin=deeper + 2)

    @block.register
    def _(self, value: content.Cited) -> Iterator[Line]:
        """Nothing: there is no list of literature."""
        yield from ()

    @block.register
    def _(self, value: content.Beside) -> Iterator[Line]:
        return self.document(value.blocks)

    @block.register
    def _(self, value: content.Lettered) -> Iterator[Line]:
        yield from self.document(value.blocks)
        yield from self.document(value.meanings())

    @block.register
    def _(self, value: content.Drawing) -> Iterator[Line]:
        """Nothing: there are only letters here."""
        yield from ()

    @block.register
    def _(self, value: content.Folded) -> Iterator[Line]:
        """Nothing: it is said in front of it, in fewer words."""
        yield from ()

    @block.register
    def _(self, value: content.Intermediates) -> Iterator[Line]:
        count = sum(len(x.definitions) for x in value.passages)
        if count > MOST_DEFINITIONS:
            yield self._line(self._counted(say("[[count]] definitions", count=str(count)), self.file), indent=2)
            return
        for passage in value.passages:
            yield self._line(passage.words, f" {passage.coordinate}".rstrip(), ":")
            for item in passage.definitions:
                yield self._line(item.name, f"{UNBROKEN}={UNBROKEN}", item.formula, indent=2)

    @block.register
    def _(self, value: content.Steps) -> Iterator[Line]:
        names = {name: self.inline(item) for name, item in value.names.items()} | {"pi": "pi"}
        body = listing(value.program, [node for _, node in value.results], names, _DIALECT)
        called = [(self.inline(symbol), x) for (symbol, _), x in zip(value.results, body.results, strict=True)]
        steps = [*body.assignments, *called]
        if len(steps) > MOST_DEFINITIONS:
            yield self._line(self._counted(say("[[count]] steps", count=str(len(steps))), self.file), indent=2)
            return
        yield from (self._line(f"{left} =", UNBROKEN, right, indent=2) for left, right in steps)


def _plain(parts: Iterable[tuple[str, str]]) -> str:
    return "".join(text for text, _ in parts).replace(UNBROKEN, " ")


def _telling(rows: Sequence[Sequence[str]]) -> int:
    """How many of the first columns tell the rows apart; one, if not even all do."""
    known = (k for k in range(1, len(rows[0])) if len({tuple(row[:k]) for row in rows}) == len(rows)) if rows else ()
    return next(iter(known), 1)


def _first(parts: Iterable[tuple[str, str]]) -> str:
    """The style of a cell."""
    return next((style for _, style in parts if style), "")


def _divided_last(value: Expression) -> Expression:
    """v t/r of (v/r) t, 6 of 2 3: beside a space for a product v/r t would be read as v/(r t), 2 3 as one number."""
    match value:
        case Negative(operand):
            return Negative(_divided_last(operand))
        case Operation("*", Number(left), Number(right)):  # side by side they would be read as one
            return Number(left * right)
        case Operation("*", Negative(Operation("/") as quotient), factor):
            return Negative(_divided_last(Operation("*", quotient, factor)))
        case Operation("*", Operation("/", above, below), factor):
            return Operation("/", _divided_last(Operation("*", above, factor)), below)
        case Operation(operator, left, right):
            return Operation(operator, _divided_last(left), _divided_last(right))
    return value


def _style(value: object) -> str:
    """That of a verdict or an outcome."""
    return STYLES.get(value.grade, "") if isinstance(value, content.Strong | content.Graded) else ""


def in_powers(coefficients: Sequence[str], variable: str, power: str = "**", times: str = "*") -> str:
    """``m*z**2 + (a - b)*z - c`` of ``-c, a - b, m``: no factor 1, and brackets about sums only."""
    parts: list[str] = []
    for k, coefficient in reversed(list(enumerate(coefficients))):
        if coefficient == "0":
            continue
        minus = coefficient.startswith("-") and not (k and _is_sum(coefficient[1:]))
        factor = coefficient[1:].lstrip() if minus else coefficient
        if k:
            raised = variable if k == 1 else f"{variable}{power}{k}"
            written = f"({factor})" if _is_sum(factor) else factor
            factor = raised if factor == "1" else f"{written}{times}{raised}"
        parts.append((" - " if minus else " + ") + factor)
    found = "".join(parts).lstrip()
    return found[2:] if found.startswith("+ ") else found.replace("- ", "-", 1) or "0"


def _is_sum(text: str) -> bool:
    """Whether a plus or minus stands outside of all brackets, the first sign included."""
    depth = 0
    for letter in text:
        depth += (letter in "([") - (letter in ")]")
        if depth == 0 and letter in "+-":
            return True
    return False
