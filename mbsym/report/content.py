"""What a report says, as a value: headings, sentences with typed gaps, formulas with labels, matrices.

A builder (``sections/``) makes it once from a result; the media (``latex/writer.py``, ``html/writer.py``,
``plain_writer.py``) write it, each in every language.  Content knows formulas and nothing of mechanics, a medium knows
content and nothing of results.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from mbsym.algebra.program import Node, Program
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message, Said
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import Expression
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.told import Told
from mbsym.report.words.passages import Passage

if TYPE_CHECKING:
    from mbsym.picture.sketch import Sketch

# --- mathematics ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Symbol:
    """A letter of ours with indices: ``Symbol("omega", "1")``, ``Symbol("V", "O1")``, ``Symbol("R", upper="01")``.

    The letter is one of the alphabet or the English name of a Greek one; ``dots`` are those above it, ``look`` is "",
    "bar" (above it) or "script".
    """

    letter: str
    lower: str = ""
    upper: str = ""
    dots: int = 0
    look: str = ""


@dataclass(frozen=True)
class Entry:
    """An entry of a matrix, which may have an index itself: (M_1)_12; a component by a name: Q_theta."""

    whole: Symbol
    index: str | Name


@dataclass(frozen=True)
class Name:
    """A name that the description declares, ``dots`` above it; ``at``: its value at a time, theta(0).

    ``ring``: that of the formulas that hold it, where it is not the system's.
    """

    name: str
    dots: int = 0
    ring: Ring | None = None
    at: str = ""


@dataclass(frozen=True)
class Notation:
    """Fixed notation in the common part of TeX: ``Notation(r"\\dot x = A x")``."""

    tex: str


@dataclass(frozen=True)
class Number:
    """A number as it is printed: ``-1.5e-3``, ``3/7``; ``0 within 2e-9`` is one that is not told from zero."""

    text: str

    @property
    def tex(self) -> str:
        """In the common part of TeX."""
        text = re.sub(r"(\d+)/(\d+)", r"\\tfrac{\1}{\2}", self.text.replace(" within ", " \\pm "))
        return re.sub(r"e([-+]?\d+)", lambda m: f" \\cdot 10^{{{int(m[1])}}}", text)


def exact(value: Fraction) -> Number:
    """A decimal where it is exact, else a fraction."""
    text = f"{float(value):.15g}"
    return Number(text if Fraction(text) == value else str(value))


@dataclass(frozen=True)
class Rows:
    """Values in rows, in brackets."""

    rows: tuple[tuple[Math, ...], ...]


@dataclass(frozen=True)
class Raised:
    """A value with an index in brackets above: ``Raised(Name("x"), 2)`` is x^(2), a coefficient of a series."""

    of: Math
    index: int


@dataclass(frozen=True)
class Power:
    """A value with an exponent."""

    base: Math
    exponent: int


@dataclass(frozen=True)
class Text:
    """Words in a formula: ``Text(Said("at"), " ")``."""

    parts: tuple[Inline, ...]

    def __init__(self, *parts: Inline) -> None:
        object.__setattr__(self, "parts", parts)


@dataclass(frozen=True)
class Readable:
    """A formula, or its length where nobody would read it.  ``kept``: it stands in full in results.json."""

    value: Formula
    kept: bool = True


@dataclass(frozen=True)
class Listed:
    """Values side by side: a, b, c.  ``brackets``: (a, b, c); ``braces``: {a, b, c}."""

    items: tuple[Math, ...]
    brackets: bool = False
    braces: bool = False


@dataclass(frozen=True)
class Relation:
    """Values and the signs between them: ``Relation(left, "=", right)``, ``Relation(x, ">=", 0)``."""

    parts: tuple[Math | str, ...]

    def __init__(self, *parts: Math | str) -> None:
        object.__setattr__(self, "parts", parts)

    @property
    def told(self) -> tuple[Math | str, ...]:
        """The parts as they are written: what is compared with 0 without a positive number as its factor."""
        match self.parts:
            case (Formula() as x, ">" | "<" | ">=" | "<=" | "!=" as sign, 0):
                return x.primitive, sign, 0
        return self.parts


@dataclass(frozen=True)
class Polynomial:
    """Sum of ``coefficients[k]`` times ``variable`` to the power k, the highest first; ``power``: that of all of it."""

    coefficients: tuple[Formula, ...]
    variable: str
    power: int = 1


@dataclass(frozen=True)
class SpeedForm:
    """What a speed is made of, in which components of the angular velocity of body number ``body`` may stand."""

    form: Expression
    body: int


@dataclass(frozen=True)
class Tensor:
    """A tensor of the description, row by row."""

    rows: tuple[tuple[Expression, Expression, Expression], ...]


@dataclass(frozen=True)
class Points:
    """The points (x, y) of a table; of many the first and the last."""

    points: tuple[tuple[Fraction, Fraction], ...]


Math = (
    Symbol
    | Entry
    | Name
    | Notation
    | Number
    | Rows
    | Raised
    | Power
    | Text
    | Readable
    | Listed
    | Relation
    | Polynomial
    | SpeedForm
    | Tensor
    | Points
    | Formula
    | Expression
    | int
)


# --- text -------------------------------------------------------------------------------------------------------------


def say(text: str, **gaps: Inline | Sequence[Inline]) -> Said:
    """``Said`` with its gaps by name."""
    return Said(text, gaps)


@dataclass(frozen=True)
class Strong:
    """What stands out: a verdict, an outcome.  ``grade``: good, bad or open; ``key``: a page knows it by that."""

    text: Inline
    grade: str = ""
    key: str = ""


@dataclass(frozen=True)
class Graded:
    """Words among others that are good, bad or open: coloured on a screen; on paper the bad ones stand out."""

    text: Inline
    grade: str


@dataclass(frozen=True)
class Link:
    """Words that lead on a screen to the section ``to``."""

    text: Inline
    to: str


@dataclass(frozen=True)
class Elsewhere:
    """Where a reader finds what is too long to stand here: the ``problem`` of a report, or the command that prints it.

    ``name``: what ``mbsym show`` calls it.
    """

    name: str
    problem: int

    @property
    def link(self) -> Link:
        return Link(say("problem [[number]]", number=str(self.problem)), f"problem-{self.problem}")


@dataclass(frozen=True)
class Numbered:
    """Where the formula with the label ``key`` stands: its number on paper, a link on a screen; a terminal has none."""

    key: str


@dataclass(frozen=True)
class Phrase:
    """Parts one after the other."""

    parts: tuple[Inline, ...]


class Under(Phrase):
    """A line of a fact that belongs to the last one that is under none."""


@dataclass(frozen=True)
class Emphasis:
    """A name in italics: that of a body."""

    text: str


@dataclass(frozen=True)
class Verbatim:
    """What somebody typed: a name of the description, a file."""

    text: str


@dataclass(frozen=True)
class Unit:
    """A unit in brackets, as the description has it."""

    text: str


@dataclass(frozen=True)
class Citation:
    """A publication: its number where there is a list of literature, else its ``text``."""

    key: str
    text: str


#: What stands in the gaps of a sentence, where it is made piece by piece.
Gaps = dict[str, "Inline | Sequence[Inline]"]
#: What stands in a line; a ``str`` that is no message is the same in every language: a name, punctuation.
Inline = (
    Said | Strong | Graded | Link | Elsewhere | Numbered | Phrase | Emphasis | Verbatim | Unit | Citation | Math | str
)


#: What the keys of conditions begin with: there are references to these.
CONDITION = "condition:"


# --- blocks -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Heading:
    """The title of a section; ``key`` is that of its label."""

    key: str
    title: Said


@dataclass(frozen=True)
class Subheading:
    parts: tuple[Inline, ...]


@dataclass(frozen=True)
class Paragraph:
    """Sentences, formulas and punctuation one after the other.

    ``missing``: it says why there is no result; ``ragged``: for the formulas in it lines end where they do.
    """

    parts: tuple[Inline, ...]
    missing: bool = False
    ragged: bool = False


@dataclass(frozen=True)
class Display:
    """A formula in lines of its own, broken where it is long; ``key``: that of its label.

    ``notes`` are said beside it, in brackets.
    """

    value: Math | tuple[Inline, ...]
    key: str = ""
    notes: tuple[Inline, ...] = ()


@dataclass(frozen=True)
class Definitions:
    """What letters stand for, one after the other, led in by words."""

    words: Said
    items: tuple[Relation, ...]


@dataclass(frozen=True)
class Matrices:
    """A matrix as a whole where it fits, else its entries; of a ``symmetric`` one the upper half.

    ``packed``: its entries in any case, side by side on paper.
    """

    symbol: Symbol
    value: Matrix
    symmetric: bool
    key: str
    packed: bool = False

    def entries(self) -> list[tuple[str, Formula]]:
        """(index, entry) of what is not zero."""
        comma = "," if len(self.value.rows) > 9 else ""
        return [
            (f"{i + 1}{comma}{j + 1}", entry)
            for i, row in enumerate(self.value)
            for j, entry in enumerate(row)
            if not entry.is_zero and (j >= i or not self.symmetric)
        ]


@dataclass(frozen=True)
class SideBySide:
    """Several matrices, on paper beside each other where they fit; ``key``: that of their labels then."""

    matrices: tuple[Matrices, ...]
    key: str


@dataclass(frozen=True)
class Components:
    """A vector as a row where it fits, else component by component."""

    symbol: Symbol
    value: Column
    key: str


@dataclass(frozen=True)
class Itemised:
    """A list; each item is one block or several."""

    items: tuple[tuple[Block, ...], ...]
    numbered: bool = False


@dataclass(frozen=True)
class TableColumn:
    """A column of a table; ``width``: that on a wide page in cm, 0 for what screens alone show.

    Numbers stand to the ``right``; what is ``folded`` may take several lines on a narrow terminal.
    """

    title: Inline
    width: float = 0.0
    right: bool = False
    fold: bool = False


@dataclass(frozen=True)
class Table:
    """Rows of cells, each of them parts of a line; in narrow columns of paper its rows follow one another.

    One without a title has headings of its columns on paper, too, and its rows are paragraphs where they follow.
    ``aligned``: its columns stand under one another on the terminal, too.
    """

    title: Said | None
    columns: tuple[TableColumn, ...]
    rows: tuple[tuple[tuple[Inline, ...], ...], ...]
    aligned: bool = False


@dataclass(frozen=True)
class Fact:
    """Something that was found: its name, and what is said of it, in lines."""

    name: Inline
    lines: tuple[Inline, ...]


@dataclass(frozen=True)
class Facts:
    """A list of what was found."""

    items: tuple[Fact, ...]


@dataclass(frozen=True)
class Cited:
    """Words, each with the keys of its literature; told where there is a list of literature."""

    words: Said
    items: tuple[tuple[Inline, tuple[str, ...]], ...]


@dataclass(frozen=True)
class Beside:
    """Blocks in which these names occur besides those of the system."""

    names: tuple[str, ...]
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Lettered:
    """Blocks in letters of the author, and what these stand for, which is known when the blocks have been written.

    In reports that stands in front of them, on the terminal behind what was found.
    """

    blocks: tuple[Block, ...]
    meanings: Callable[[], tuple[Block, ...]]


@dataclass(frozen=True)
class Drawing:
    """The drawing of a system, and what is said below it; a terminal is without it."""

    drawn: Sketch
    caption: tuple[Said, ...]


@dataclass(frozen=True)
class Folded:
    """What a screen unfolds on request; paper is without it."""

    title: Said
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Intermediates:
    """Definitions of named quantities, each in front of what needs it: phrases and what they introduce."""

    told: Told[Any]
    passages: tuple[Passage, ...]


@dataclass(frozen=True)
class Steps:
    """A straight-line program: what occurs more than once has a number, then ``results`` by what they are called.

    ``names`` are those of its inputs; a screen unfolds it under the ``title``.
    """

    program: Program
    results: tuple[tuple[Symbol, Node], ...]
    names: Mapping[str, Math]
    title: Said


Block = (
    Heading
    | Subheading
    | Paragraph
    | Display
    | Definitions
    | Matrices
    | SideBySide
    | Components
    | Itemised
    | Table
    | Facts
    | Cited
    | Beside
    | Lettered
    | Drawing
    | Folded
    | Intermediates
    | Steps
)


def paragraph(*parts: Inline) -> Paragraph:
    """A paragraph of these parts."""
    return Paragraph(parts)


def column(title: str, right: bool = False, fold: bool = False) -> TableColumn:
    """A column of an aligned table."""
    return TableColumn(title, right=right, fold=fold)


def aligned(columns: Iterable[TableColumn], rows: Iterable[Sequence[Inline]]) -> Table:
    """A table whose columns stand under one another."""
    listed = tuple(tuple((cell,) for cell in row) for row in rows)
    return Table(None, tuple(columns), listed, aligned=True)


def ragged(*sentences: Inline) -> Paragraph:
    """A paragraph of these sentences, with spaces between them, around long formulas."""
    return Paragraph(joined(sentences, " ").parts, ragged=True)


def joined(items: Iterable[Inline], *between: Inline) -> Phrase:
    """The items with ``between`` from one to the next."""
    parts = [part for item in items for part in (*between, item)]
    return Phrase(tuple(parts[len(between) :]))


def facts(pairs: Iterable[tuple[str, str]]) -> Facts:
    """What is said under titles, one after the other; without a title it goes on.  Warnings stand out."""
    items: list[tuple[str, list[Inline]]] = []
    for title, text in pairs:
        if title or not items:
            items.append((title, []))
        items[-1][1].append(text)
    return Facts(tuple(Fact(_title(title), tuple(lines)) for title, lines in items))


def _title(text: str) -> Inline:
    name = text if isinstance(text, Message) else say(text)
    return Graded(name, "open") if text == "warning" else name


def equalities(pairs: Iterable[tuple[Math, Math]], key: str) -> Iterator[Display]:
    """Each is equal to its other one, in lines of their own; ``key`` and its number is that of its label."""
    for k, (left, right) in enumerate(pairs, start=1):
        yield Display(Relation(left, "=", right), f"{key}:{k}")


def compared(formulas: Iterable[Formula], relation: str = "=") -> tuple[Relation, ...]:
    """Each with 0."""
    return tuple(Relation(x, relation, 0) for x in formulas)


def numbered(symbol: Symbol, values: Iterable[Formula]) -> Iterator[tuple[Symbol, Formula]]:
    """Components, by the symbol with their number as its index."""
    return ((replace(symbol, lower=str(k)), value) for k, value in enumerate(values, start=1))


def named(names: Iterable[str], ring: Ring | None = None) -> Listed:
    """Declared names side by side."""
    return Listed(tuple(Name(name, ring=ring) for name in names))


def speed(name: str) -> Name:
    """A variable of velocity: a declared speed by its name, the velocity of a coordinate as the dotted coordinate."""
    plain = without_velocity(name)
    return Name(plain, int(plain != name))


def speeds(names: Iterable[str]) -> Listed:
    """Variables of velocity side by side."""
    return Listed(tuple(map(speed, names)))
