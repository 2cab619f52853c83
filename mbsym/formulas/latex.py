"""Formulas in LaTeX (amsmath): dots for velocities, Greek letters, indices, fractions.

Long formulas must break across lines.  Only TeX knows how wide things are, so ``breaks=True`` marks the places before
plus and minus signs with penalties that grow with the depth, and TeX chooses.  A bracket that fits into a line is never
broken; of longer ones a coefficient's only as a last resort.  Brackets are of fixed size, never ``\\left`` or
``\\right``.

Nothing may read wrongly: what follows ``\\cos x`` would seem to belong to the argument, so functions stand last.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.expressions.rates import derivative_of
from mbsym.expressions.table import Tabulated
from mbsym.formulas.letters import lettered
from mbsym.formulas.names import LOWER_GREEK, greek
from mbsym.formulas.shape import forget_printed, length, present, printed
from mbsym.formulas.tree import Factor, Product, Sum, Wave, angles_or
from mbsym.formulas.typeset import Layout, Names, split

_VARIANTS = {"phi": "varphi", "epsilon": "varepsilon"}
#: Greek letters that LaTeX has no command for: they look Latin.
_LATIN = {
    "omicron": "o", "Alpha": "A", "Beta": "B", "Epsilon": "E", "Zeta": "Z", "Eta": "H", "Iota": "I", "Kappa": "K",
    "Mu": "M", "Nu": "N", "Omicron": "O", "Rho": "P", "Tau": "T", "Chi": "X",
}  # fmt: skip
_BRACKETS = (("(", ")"), (r"\bigl[", r"\bigr]"), (r"\bigl\{", r"\bigr\}"), (r"\Bigl(", r"\Bigr)"))
#: The same about fractions.
_HIGH_BRACKETS = ((r"\Bigl(", r"\Bigr)"), (r"\Bigl[", r"\Bigr]"), (r"\Bigl\{", r"\Bigr\}"), (r"\Bigl(", r"\Bigr)"))
_DOTS = {"velocity": "dot", "acceleration": "ddot"}
_COMMANDS = {"sine": r"\sin", "cosine": r"\cos"}
#: A bracket of this length (names, numbers, signs; a column holds it) is never broken.
UNBROKEN = 18
#: The penalty for a break in a longer bracket of parameters only.
LAST_RESORT = 5000
_NAMED = {"exp": r"\exp", "log": r"\ln", "atan": r"\arctan", "sign": r"\operatorname{sign}"}


def latex_text(ring: Ring, polynomial: Polynomial, breaks: bool = False) -> str:
    """The polynomial; with ``breaks`` a paragraph of inline mathematics may break it before any plus or minus."""
    ring, polynomial = lettered(ring, polynomial)
    return printed(
        ring, polynomial, angles_or("shorter"), ("latex", breaks), lambda shape: LatexPrinter(ring, breaks).sum(shape)
    )


def latex_factor(ring: Ring, polynomial: Polynomial, breaks: bool = False) -> str:
    """The polynomial as a factor before another: in brackets if it is a sum, or if what follows would be misread.

    After ``\\cos x`` a name would seem to belong to the argument.  1 is written as an empty string, -1 as ``-``.
    """
    ring, polynomial = lettered(ring, polynomial)
    shape, printer = present(ring, polynomial, angles_or("shorter")), LatexPrinter(ring, breaks)
    if len(shape.terms) != 1:
        return printer.factor(Factor(shape))
    text = printer.sum(shape)
    if text in ("1", "-1"):
        return text[:-1]
    term = shape.terms[0]
    return printer.factor(Factor(shape)) if term.over and printer.runs_on(term) else text


@dataclass(frozen=True, slots=True)
class Symbol:
    """``\\theta`` with index ``1``: accents stand over the stem only."""

    stem: str
    index: str = ""

    def __str__(self) -> str:
        return self.stem + (f"_{{{self.index}}}" if self.index else "")

    def accented(self, accent: str) -> str:
        return str(Symbol(f"\\{accent}{{{self.stem}}}", self.index))


@lru_cache(4096)
def latex_symbol(name: str) -> Symbol:
    """theta1 -> \\theta_{1}, Jx -> J_{x}, p_max -> p_{\\mathrm{max}}, mass -> \\mathit{mass}."""
    whole = split(name)
    plain = whole.stem if len(whole.stem) == 1 else f"\\mathit{{{whole.stem}}}"
    return Symbol(_greek_command(whole.greek) if whole.greek else plain, _index(whole.indices))


def _index(indices: Iterable[str]) -> str:
    """Indices that belong together: x1 stays x1, words are upright and set apart by commas."""
    written: list[str] = []
    for piece in indices:
        if greek(piece):
            text = _greek_command(greek(piece))
        else:
            text = piece if len(piece) <= 2 or piece.isdigit() else f"\\mathrm{{{piece}}}"
        if written and not (len(piece) == 1 or piece.isdigit()):
            text = "," + text
        written.append(text if not written or not written[-1][-1:].isdigit() or not text[:1].isdigit() else "," + text)
    return " ".join(written)


def _greek_command(letter: str) -> str:
    if letter in _LATIN:
        return _LATIN[letter] if letter == "omicron" else f"\\mathrm{{{_LATIN[letter]}}}"
    return "\\" + (_VARIANTS.get(letter, letter) if letter in LOWER_GREEK else letter)


class LatexNames(Names[Symbol]):
    symbol = staticmethod(latex_symbol)

    @staticmethod
    def verbatim(name: str) -> Symbol:
        escaped = name.replace("_", r"\_")
        return Symbol(f"\\mathtt{{{escaped}}}")


def write_as(ring: Ring, spellings: Mapping[str, str]) -> None:
    """From now on names of the ring are written in LaTeX as ``spellings``, in every formula."""
    LatexNames.write_as(ring, {name: given_symbol(text) for name, text in spellings.items()})
    forget_printed()


def given_symbol(text: str) -> Symbol:
    """``d_{C1}`` as a stem and its index; ``(\\sin \\theta_{1})``, whose index is not of the whole, as a stem."""
    match = re.fullmatch(r"(.*[^_\s])\s*_\s*(\{[^{}]*\}|[^\s{}()])\s*", text)
    if match is None or match[1].count("{") != match[1].count("}"):
        return Symbol(text.strip())
    return Symbol(match[1].strip(), match[2].strip("{}"))


class LatexPrinter(Layout):
    def __init__(self, ring: Ring, breaks: bool = False) -> None:
        super().__init__(ring)
        self.breaks = breaks
        self._whole = LatexPrinter(ring) if breaks else self
        self.names = LatexNames.of(ring)
        self._atoms: dict[int, tuple[str, str]] = {}
        self._high: dict[Sum, bool] = {}

    def sum(self, shape: Sum, depth: int = 0, penalty: int = 0) -> str:
        """The terms, in ``depth`` brackets; where it may be broken, at this penalty."""
        if not shape.terms:
            return "0"
        pieces: list[str] = []
        for term in shape.terms:
            negative = term.coefficient < 0
            if pieces and self.breaks:
                pieces.append(f"\\penalty{penalty} ")
            pieces.append((" - " if negative else " + ") if pieces else ("-" if negative else ""))
            pieces.append(self.product(term, depth))
        return "".join(pieces)

    def product(self, product: Product, depth: int = 0) -> str:
        """Without its sign: number and parameters as one fraction if there is a denominator, then the rest.

        Sines and cosines stand last.
        """
        top, bottom = product.magnitude
        inside, over = self.inside_and_behind(product)
        if product.under:
            number = [str(top)] if top != 1 or not inside else []
            below = [str(bottom)] if bottom != 1 else []
            numerator = _joined(number + [self.factor(f, depth) for f in inside])
            alone = len(product.under) == 1 and not below
            denominator = _joined(below + [self._denominator(f, alone) for f in self.readable(product.under)])
            pieces = [f"\\frac{{{numerator}}}{{{denominator}}}"]
        elif bottom != 1:
            pieces = [f"\\frac{{{top}}}{{{bottom}}}"]
        else:
            pieces = [str(top)] if top != 1 or not over else []
        return _joined(pieces + [self.factor(f, depth) for f in over])

    def runs_on(self, product: Product) -> bool:
        """Whether it ends in a function without brackets, whose argument would seem to go on."""
        return any(self.is_sine(factor) for factor in product.over)

    def _denominator(self, factor: Factor, alone: bool) -> str:
        """Inside a fraction's denominator nothing can break, and a lone bracket needs no brackets."""
        if alone and factor.exponent == 1 and isinstance(factor.base, Sum):
            return self._whole.sum(factor.base)
        return self._whole.factor(factor)

    def factor(self, factor: Factor, depth: int = 0) -> str:
        if isinstance(factor.base, int):
            return self.atom(factor.base, factor.exponent)
        if isinstance(factor.base, Wave):
            return self.wave(factor.base, factor.exponent)
        brackets = _HIGH_BRACKETS if self._is_high(factor.base) else _BRACKETS
        opening, closing = brackets[min(self.height(factor.base), len(brackets)) - 1]
        raised = f"^{{{factor.exponent}}}" if factor.exponent != 1 else ""
        return f"{opening}{self._bracketed(factor.base, depth + 1)}{closing}{raised}"

    def _bracketed(self, shape: Sum, depth: int) -> str:
        if not self.breaks:
            return self.sum(shape)
        if length(self.ring, shape) <= UNBROKEN:
            return self._whole.sum(shape)
        return self.sum(shape, depth, LAST_RESORT if self.is_coefficient(shape) else 60 * depth)

    def _is_high(self, shape: Sum) -> bool:
        """Whether fractions stand in it."""
        if shape not in self._high:
            inner = (f.base for term in shape.terms for f in term.over if isinstance(f.base, Sum))
            self._high[shape] = any(term.under for term in shape.terms) or any(map(self._is_high, inner))
        return self._high[shape]

    def height_of_base(self, base: int | Wave | Sum) -> int:
        """A wave of several angles has brackets, too."""
        return int(len(base.angle) > 1) if isinstance(base, Wave) else super().height_of_base(base)

    def atom(self, index: int, exponent: int = 1) -> str:
        if index not in self._atoms:
            self._atoms[index] = self._atom(self.ring.generators[index])
        head, tail = self._atoms[index]
        return head + (f"^{{{exponent}}}" if exponent != 1 else "") + tail

    def _atom(self, g: Generator) -> tuple[str, str]:
        """(before, after) an exponent: ``\\sin^{2}`` and its argument."""
        if g.kind in _COMMANDS:
            return _COMMANDS[g.kind], self._angle(g)
        if g.kind == "root":
            return f"\\sqrt{{{self._quiet(g.argument)}}}", ""
        if g.kind == "function" and g.name == "abs":
            return f"\\lvert {self._quiet(g.argument)} \\rvert", ""
        if isinstance(g.name, Tabulated):
            return latex_table(g.name), f"({self._quiet(g.argument)})"
        if g.kind == "function":
            return _NAMED[g.name], f"({self._quiet(g.argument)})"
        if g.name == "pi":
            return r"\pi", ""
        kind, name = derivative_of(g.kind, g.name)
        if kind in _DOTS:
            return self.names[name].accented(_DOTS[kind]), ""
        return str(self.names[name]), ""

    def wave(self, wave: Wave, exponent: int = 1) -> str:
        """``\\cos(q_1 - 2 q_2)``, ``\\sin^{2} 2 q``."""
        pieces: list[str] = []
        for name, n in wave.angle:
            pieces.append((" - " if n < 0 else " + ") if pieces else ("-" if n < 0 else ""))
            symbol, top = str(self.names[name]), abs(n.numerator)
            times = "" if top == 1 else f"{top} "
            pieces.append(f"{times}{symbol}" if n.denominator == 1 else f"\\frac{{{times}{symbol}}}{{{n.denominator}}}")
        raised = f"^{{{exponent}}}" if exponent != 1 else ""
        angle = "".join(pieces)
        return f"{_COMMANDS[wave.kind]}{raised}" + (f" {angle}" if len(wave.angle) == 1 else f"({angle})")

    def _angle(self, g: Generator) -> str:
        if g.argument is not None:
            return f"({self._quiet(g.argument)})"
        symbol = str(self.names[g.name])
        return " " + symbol if g.denominator == 1 else f"\\frac{{{symbol}}}{{{g.denominator}}}"

    def _quiet(self, argument: Any) -> str:
        return self._whole.sum(present(self.ring, argument, angles_or("shorter")))


def _joined(factors: Sequence[str]) -> str:
    """Factors side by side; a thin space after a function, whose argument would seem to go on, and around words."""
    if len(factors) < 2:
        return "".join(factors)
    written = [factors[0]]
    for before, factor in pairwise(factors):
        word = before.startswith(_WORDS) or factor.startswith(_WORDS)
        runs_on = before.startswith(_FUNCTIONS) and not factor.startswith(_FUNCTIONS[:2])
        written.append(r"\, " if word or runs_on else " ")
        written.append(factor)
    return "".join(written)


#: Names of several letters, which must not run into their neighbours.
_WORDS = (r"\mathit", r"\mathtt", r"\dot{\mathit", r"\ddot{\mathit")
_FUNCTIONS = (r"\sin", r"\cos", r"\exp", r"\ln", r"\arctan", r"\operatorname{")


def latex_table(name: Tabulated) -> str:
    """A table, with a prime for each derivative."""
    written = name.written.replace("_", "\\_")
    return f"\\operatorname{{{written}}}{chr(39) * name.curve.order}"


def latex_matrix(rows: Sequence[Sequence[str]]) -> str:
    """A pmatrix of finished entries; one alone stands without brackets."""
    if len(rows) == len(rows[0]) == 1:
        return rows[0][0]
    body = " \\\\ ".join(" & ".join(row) for row in rows)
    return f"\\begin{{pmatrix}} {body} \\end{{pmatrix}}"
