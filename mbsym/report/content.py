"""What a report says, as a value: headings, sentences with typed gaps, formulas with labels, matrices.

A builder (``sections/``) makes it once from a result; the media (``latex/writer.py``, ``html/writer.py``,
``plain_writer.py``) write it, each in every language.  Content knows formulas and nothing of mechanics, a medium knows
content and nothing of results.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from mbsym.algebra.ring import Ring
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import Expression
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.told import Told
from mbsym.report.words.passages import Passage

# --- mathematics ------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Symbol:
    """A letter of ours with indices: ``Symbol("omega", "1")``, ``Symbol("V", "O1")``, ``Symbol("R", upper="01")``.

    The letter is one of the alphabet or the English name of a Greek one; ``dots`` are those above it.
    """

    letter: str
    lower: str = ""
    upper: str = ""
    dots: int = 0


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


@dataclass(frozen=True)
class Said:
    """A sentence by its English text, which finds its translation.

    ``$...$`` is notation in the common part of TeX, ``[[name]]`` a gap, outside of mathematics or inside; ``gaps``
    says what stands there.
    """

    text: str
    gaps: Mapping[str, Inline | Sequence[Inline]] = field(default_factory=dict)


def say(text: str, **gaps: Inline | Sequence[Inline]) -> Said:
    """``Said`` with its gaps by name."""
    return Said(text, gaps)


@dataclass(frozen=True)
class Words:
    """A word or sentences of a result in English, of which the translation is looked for.

    ``variable``: the letter of characteristic polynomials, which the words call lambda.
    """

    text: str
    variable: str = ""


@dataclass(frozen=True)
class Strong:
    """What stands out: a verdict, an outcome.  ``grade``: good, bad or open."""

    text: Inline
    grade: str = ""


@dataclass(frozen=True)
class Phrase:
    """Parts one after the other."""

    parts: tuple[Inline, ...]


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
#: What stands in a line; a ``str`` is as it is in every language: a name of a body, a number, punctuation.
Inline = Said | Words | Strong | Phrase | Emphasis | Verbatim | Unit | Citation | Math | str


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
    """A formula in lines of its own, broken where it is long; ``key``: that of its label."""

    value: Math | tuple[Inline, ...]
    key: str = ""


@dataclass(frozen=True)
class Matrices:
    """A matrix as a whole where it fits, else its entries; of a ``symmetric`` one the upper half."""

    symbol: Symbol
    value: Matrix
    symmetric: bool
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
    """A column of a table; ``width``: that on a wide page in cm, 0 for what screens alone show."""

    title: Said
    width: float


@dataclass(frozen=True)
class Table:
    """Rows of cells, each of them parts of a line; in narrow columns of paper its rows follow one another."""

    title: Said
    columns: tuple[TableColumn, ...]
    rows: tuple[tuple[tuple[Inline, ...], ...], ...]


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


Block = Heading | Subheading | Paragraph | Display | Matrices | Components | Itemised | Table | Folded | Intermediates


def paragraph(*parts: Inline) -> Paragraph:
    """A paragraph of these parts."""
    return Paragraph(parts)


def ragged(*sentences: Inline) -> Paragraph:
    """A paragraph of these sentences, with spaces between them, around long formulas."""
    return Paragraph(joined(sentences, " ").parts, ragged=True)


def joined(items: Iterable[Inline], *between: Inline) -> Phrase:
    """The items with ``between`` from one to the next."""
    parts = [part for item in items for part in (*between, item)]
    return Phrase(tuple(parts[len(between) :]))


def named(names: Iterable[str], ring: Ring | None = None) -> Listed:
    """Declared names side by side."""
    return Listed(tuple(Name(name, ring=ring) for name in names))


def speed(name: str) -> Name:
    """A variable of velocity: a declared speed by its name, the velocity of a coordinate as the dotted coordinate."""
    plain = without_velocity(name)
    return Name(plain, int(plain != name))


def pieces(text: str) -> Iterator[tuple[bool, str]]:
    """The parts of a message: (whether it is notation, the part)."""
    for k, piece in enumerate(text.split("$")):
        if piece:
            yield k % 2 == 1, piece
