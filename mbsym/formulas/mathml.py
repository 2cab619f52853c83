"""Formulas in MathML (Core, presentation): the same shapes and the same names as in LaTeX.

No browser breaks a formula across lines.  So a formula is a list of *pieces*, each the content of a ``<math>`` of its
own, and the page breaks between them: before a plus or minus of the outermost sum, and within brackets only where
these are long.  Products carry the invisible times, functions the invisible application, so that what is read aloud, or
by a program, is what is meant.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from html import escape
from typing import Any

from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.expressions.rates import derivative_of
from mbsym.expressions.table import Tabulated
from mbsym.formulas.letters import lettered
from mbsym.formulas.names import greek, parts
from mbsym.formulas.shape import present
from mbsym.formulas.tree import Factor, Product, Sum, Wave, angles_or, leaves
from mbsym.formulas.typeset import Layout, Names, split

#: Brackets with more symbols than this, or of more letters, may be broken; those of coefficients, made of parameters,
#: are kept longer.
LONG_BRACKET, LONG_COEFFICIENT, WIDE_BRACKET = 16, 36, 30

_LETTERS = {
    "alpha": "α", "beta": "β", "gamma": "γ", "delta": "δ", "epsilon": "ε", "zeta": "ζ", "eta": "η", "theta": "θ",
    "iota": "ι", "kappa": "κ", "lambda": "λ", "mu": "μ", "nu": "ν", "xi": "ξ", "omicron": "ο", "pi": "π", "rho": "ρ",
    "sigma": "σ", "tau": "τ", "upsilon": "υ", "phi": "φ", "chi": "χ", "psi": "ψ", "omega": "ω",
}  # fmt: skip
_BRACKETS = ("()", "[]", "{}")
_DOTS = {"velocity": "˙", "acceleration": "¨"}
_TRIGONOMETRIC = {"sine": "sin", "cosine": "cos"}
_NAMED = {"exp": "exp", "log": "ln", "atan": "arctan", "sign": "sign"}

TIMES = "<mo>\u2062</mo>"
#: Around functions and words, which would run into their neighbours.
SPACED_TIMES = '<mo lspace=".17em">\u2062</mo>'
APPLY = '<mo rspace=".12em">\u2061</mo>'


# --- elements ---------------------------------------------------------------------------------------------------------


def mi(name: str) -> str:
    """An identifier; one letter is set in italics, several are upright."""
    return f"<mi>{escape(name)}</mi>"


def mn(value: int | str) -> str:
    """An unsigned number."""
    return f"<mn>{value}</mn>"


def mo(character: str, first: bool = False) -> str:
    """An operator between its operands; where a piece begins with it, that has to be said."""
    form = ' form="infix"' if first else ""
    return f"<mo{form}>{escape(character)}</mo>"


def sign(character: str) -> str:
    """A sign before its operand."""
    return f'<mo form="prefix">{character}</mo>'


def mtext(words: str) -> str:
    return f"<mtext>{escape(words)}</mtext>"


def fraction(top: str, bottom: str) -> str:
    return f"<mfrac><mrow>{top}</mrow><mrow>{bottom}</mrow></mfrac>"


def bracketed(content: str, pair: str = "()") -> str:
    """In brackets that grow with what they hold."""
    opening, closing = pair[0], pair[1]
    return f"<mrow><mo>{opening}</mo>{content}<mo>{closing}</mo></mrow>"


def power(base: str, exponent: str) -> str:
    return f"<msup><mrow>{base}</mrow><mrow>{exponent}</mrow></msup>"


def row(items: Sequence[str]) -> str:
    """(a, b, c)."""
    return bracketed('<mo separator="true">,</mo><mspace width="0.3em"/>'.join(items))


def table(rows: Sequence[Sequence[str]]) -> str:
    """A matrix in brackets; an entry alone stands without them."""
    if len(rows) == len(rows[0]) == 1:
        return rows[0][0]
    body = "".join("<mtr>" + "".join(f"<mtd>{x}</mtd>" for x in line) + "</mtr>" for line in rows)
    return bracketed(f"<mtable>{body}</mtable>")


# --- names ------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Symbol:
    """A stem and its index, as elements; dots stand over the stem only."""

    stem: str
    index: str = ""

    def __str__(self) -> str:
        return f"<msub>{self.stem}{self.index}</msub>" if self.index else self.stem

    def dotted(self, dots: str) -> Symbol:
        return Symbol(f'<mover accent="true">{self.stem}<mo stretchy="false">{dots}</mo></mover>', self.index)

    def raised(self, exponent: int) -> str:
        if exponent == 1:
            return str(self)
        if self.index:
            return f"<msubsup>{self.stem}{self.index}{mn(exponent)}</msubsup>"
        return f"<msup>{self.stem}{mn(exponent)}</msup>"


def mathml_symbol(name: str) -> Symbol:
    """theta1 -> theta with index 1, Jx -> J with index x, p_max -> p with index max, mass -> mass."""
    whole = split(name)
    return Symbol(mi(letter(whole.greek) if whole.greek else whole.stem), _index(whole.indices))


def letter(name: str) -> str:
    """theta -> \u03b8, Theta -> \u0398."""
    lower = name[:1].lower() + name[1:]
    letter = _LETTERS[lower]
    return letter if lower == name else letter.upper()


_SUBSCRIPTS = str.maketrans("0123456789", "\u2080\u2081\u2082\u2083\u2084\u2085\u2086\u2087\u2088\u2089")


def spelled_name(name: str) -> str:
    """A name as plain text: theta1 -> \u03b8\u2081; one with a word as its index stays as it is."""
    split = parts(name)
    if not all(piece.isdigit() for piece in split.indices):
        return name
    return (letter(split.greek) if split.greek else split.stem) + "".join(split.indices).translate(_SUBSCRIPTS)


def _index(indices: Iterable[str]) -> str:
    """Digits and letters side by side, words apart by commas."""
    written: list[str] = []
    before = ""
    for piece in indices:
        word = len(piece) > 1 and not piece.isdigit()
        if before and (word or (before.isdigit() and piece.isdigit())):
            written.append('<mo separator="true">,</mo>')
        written.append(mn(piece) if piece.isdigit() else mi(letter(greek(piece)) if greek(piece) else piece))
        before = piece
    if not written:
        return ""
    return written[0] if len(written) == 1 else f"<mrow>{''.join(written)}</mrow>"


class MathNames(Names[Symbol]):
    symbol = staticmethod(mathml_symbol)

    @staticmethod
    def verbatim(name: str) -> Symbol:
        return Symbol(f'<mi class="verbatim">{escape(name)}</mi>')


# --- formulas ---------------------------------------------------------------------------------------------------------


def mathml_pieces(ring: Ring, polynomial: Polynomial) -> list[str]:
    """The polynomial in pieces between which a page may break the line."""
    ring, polynomial = lettered(ring, polynomial)
    return MathPrinter(ring).pieces(shape_of(ring, polynomial))


def mathml_text(ring: Ring, polynomial: Polynomial) -> str:
    """The polynomial in one piece."""
    ring, polynomial = lettered(ring, polynomial)
    return MathPrinter(ring).sum(shape_of(ring, polynomial))


def shape_of(ring: Ring, polynomial: Polynomial) -> Sum:
    """What is printed here: with sums of angles where these are shorter, unless something else was asked for."""
    return present(ring, polynomial, angles_or("shorter"))


class MathPrinter(Layout):
    def __init__(self, ring: Ring) -> None:
        super().__init__(ring)
        self.names = MathNames.of(ring)
        self._atoms: dict[tuple[int, int], str] = {}

    def sum(self, shape: Sum) -> str:
        return "".join(self._sum(shape, False))

    def pieces(self, shape: Sum) -> list[str]:
        return self._sum(shape, True)

    def _sum(self, shape: Sum, breaks: bool) -> list[str]:
        if not shape.terms:
            return [mn(0)]
        found = [""]
        for place, term in enumerate(shape.terms):
            negative = term.coefficient < 0
            if place and breaks:
                found.append("")
            if place:
                found[-1] += mo("\u2212" if negative else "+", breaks)
            elif negative:
                found[-1] += sign("\u2212")
            _join(found, self._product(term, breaks))
        return found

    def _product(self, product: Product, breaks: bool) -> list[str]:
        """Without its sign: number and parameters as one fraction if there is a denominator, then the rest."""
        top, bottom = product.magnitude
        inside, over = self.inside_and_behind(product)
        head = ""
        if product.under:
            above = [mn(top)] if top != 1 or not inside else []
            below = [mn(bottom)] if bottom != 1 else []
            alone = len(product.under) == 1 and not below
            below += [self._denominator(f, alone) for f in self.readable(product.under)]
            head = fraction(self._joined(above + [self.factor(f) for f in inside]), self._joined(below))
        elif bottom != 1:
            head = f"<mfrac>{mn(top)}{mn(bottom)}</mfrac>"
        elif top != 1 or not over:
            head = mn(top)
        found = [head]
        before = head
        for factor in over:
            pieces = self.factor_pieces(factor) if breaks else [self.factor(factor)]
            if before:
                found[-1] += _times(before, pieces[0])
            _join(found, pieces)
            before = pieces[-1]
        return found

    def _joined(self, factors: Sequence[str]) -> str:
        text = ""
        for before, factor in zip(["", *factors], factors, strict=False):
            text += (_times(before, factor) if before else "") + factor
        return text

    def _denominator(self, factor: Factor, alone: bool) -> str:
        if alone and factor.exponent == 1 and isinstance(factor.base, Sum):
            return self.sum(factor.base)
        return self.factor(factor)

    def factor(self, factor: Factor) -> str:
        if isinstance(factor.base, int):
            return self.atom(factor.base, factor.exponent)
        if isinstance(factor.base, Wave):
            return self.wave(factor.base, factor.exponent)
        inner = bracketed(self.sum(factor.base), self._pair(factor.base))
        return inner if factor.exponent == 1 else f"<msup>{inner}{mn(factor.exponent)}</msup>"

    def factor_pieces(self, factor: Factor) -> list[str]:
        """A long bracket in pieces; its brackets, in different pieces, do not grow, and the exponent is the last's."""
        if not isinstance(factor.base, Sum):
            return [self.factor(factor)]
        if leaves(factor.base) <= LONG_BRACKET and len(_TAG.sub("", self.sum(factor.base))) <= WIDE_BRACKET:
            return [self.factor(factor)]
        if self.is_coefficient(factor.base) and leaves(factor.base) <= LONG_COEFFICIENT:
            return [self.factor(factor)]
        pair = self._pair(factor.base)
        pieces = self._sum(factor.base, True)
        pieces[0] = f'<mo form="prefix" stretchy="false">{pair[0]}</mo>' + pieces[0]
        end = f'<mo form="postfix" stretchy="false">{pair[1]}</mo>'
        pieces[-1] += end if factor.exponent == 1 else f"<msup>{end}{mn(factor.exponent)}</msup>"
        return pieces

    def _pair(self, shape: Sum) -> str:
        return _BRACKETS[(self.height(shape) - 1) % len(_BRACKETS)]

    def atom(self, index: int, exponent: int = 1) -> str:
        """A generator to a power."""
        key = index, exponent
        if key not in self._atoms:
            self._atoms[key] = self._atom(self.ring.generators[index], exponent)
        return self._atoms[key]

    def _atom(self, g: Generator, exponent: int) -> str:
        if g.kind in _TRIGONOMETRIC:
            name = Symbol(mi(_TRIGONOMETRIC[g.kind])).raised(exponent)
            return f"<mrow>{name}{APPLY}{self._angle(g)}</mrow>"
        if g.kind == "root":
            return Symbol(f"<msqrt>{self._inner(g.argument)}</msqrt>").raised(exponent)
        if g.kind == "function" and g.name == "abs":
            return Symbol(f"<mrow>{mo('|')}{self._inner(g.argument)}{mo('|')}</mrow>").raised(exponent)
        if g.kind == "function":
            table = g.name.written + "\u2032" * g.name.curve.order if isinstance(g.name, Tabulated) else ""
            name = Symbol(mi(table or _NAMED[g.name])).raised(exponent)
            return f"<mrow>{name}{APPLY}{bracketed(self._inner(g.argument))}</mrow>"
        if g.name == "pi":
            return Symbol(mi("π")).raised(exponent)
        kind, name = derivative_of(g.kind, g.name)
        symbol = self.names[name]
        return (symbol.dotted(_DOTS[kind]) if kind in _DOTS else symbol).raised(exponent)

    def wave(self, wave: Wave, exponent: int = 1) -> str:
        """The sine or cosine of a sum of angles, in brackets unless it is a multiple of one."""
        text = ""
        for name, n in wave.angle:
            if text:
                text += mo("\u2212" if n < 0 else "+")
            elif n < 0:
                text += sign("\u2212")
            top, angle = abs(n.numerator), str(self.names[name])
            multiple = angle if top == 1 else mn(top) + TIMES + angle
            text += multiple if n.denominator == 1 else fraction(multiple, mn(n.denominator))
        name = Symbol(mi(_TRIGONOMETRIC[wave.kind])).raised(exponent)
        argument = f"<mrow>{text}</mrow>" if len(wave.angle) == 1 else bracketed(text)
        return f"<mrow>{name}{APPLY}{argument}</mrow>"

    def _angle(self, g: Generator) -> str:
        if g.argument is not None:
            return bracketed(self._inner(g.argument))
        symbol = str(self.names[g.name])
        return symbol if g.denominator == 1 else f"<mfrac>{symbol}{mn(g.denominator)}</mfrac>"

    def _inner(self, argument: Any) -> str:
        return self.sum(shape_of(self.ring, argument))


def _join(found: list[str], pieces: Sequence[str]) -> None:
    """Pieces after pieces: the first one goes on where the last one ends."""
    found[-1] += pieces[0]
    found.extend(pieces[1:])


_TAG = re.compile("<[^>]*>")
_WORD = re.compile(
    r"<mrow><m(sup><m)?i>|<mi( class=\"verbatim\")?>[^<]{2,}<|(<m(sub|subsup|sup|over)[^>]*>)+<mi[^>]*>[^<]{2,}<"
)


def _times(before: str, after: str) -> str:
    """Invisible, with a little room around functions and words."""
    return SPACED_TIMES if _WORD.match(before) or _WORD.match(after) else TIMES


# The common part of TeX in MathML: letters and numbers, indices, exponents, accents, fractions, words, signs.
#
#     T = \frac12 \sum M_{ij}\, \dot q_i \dot q_j
#
# What is not listed here raises ValueError: notation is ours, and a test reads all of it.


_SIGNS = {
    "cdot": "\u00b7", "times": "\u00d7", "circ": "\u2218", "partial": "\u2202", "sum": "\u2211", "pm": "\u00b1",
    "neq": "\u2260", "leq": "\u2264", "geq": "\u2265", "{": "{", "}": "}", "-": "\u2212",
}  # fmt: skip
_ACCENTS = {"dot": "\u02d9", "ddot": "\u00a8", "bar": "\u00af"}
_VARIANTS = {"varphi": "phi", "varepsilon": "epsilon"}
_SPACES = {",": "0.167em", ";": "0.278em", " ": "0.25em", "quad": "1em"}
_FUNCTIONS = ("cos", "sin", "exp", "ln", "det")
#: Where a line may end, and how tall a bracket is: screens see to that.
_LEFT_TO_SCREENS = ("penalty", "allowbreak", "bigl", "bigr", "Bigl", "Bigr")
#: Behind these a minus belongs to what follows.
_BEFORE_SIGNS = (mo("="), mo("("), mo("["))
_TOKEN = re.compile(r"\\[A-Za-z]+ ?|\\.|\d+(?:\.\d+)?|\S")


@cache
def notation(tex: str) -> str:
    """Finished elements.  Raises ValueError for what they cannot be made of."""
    return "".join(_Reader(tex).row())


class _Reader:
    def __init__(self, tex: str) -> None:
        self.tex, self.place = re.sub(r"\\penalty\d+", "", tex), 0

    def row(self, closing: str = "") -> list[str]:
        """What stands up to the end, or to the ``closing`` brace."""
        elements: list[str] = []
        while token := self._next():
            if token == closing:
                return elements
            if token == "}":
                raise ValueError(f"a brace was never opened: {self.tex}")
            if token in ("_", "^"):
                if not elements:
                    raise ValueError(f"nothing has this index: {self.tex}")
                elements.append(self._scripts(elements.pop(), token))
            elif token == "-" and (not elements or elements[-1] in _BEFORE_SIGNS):
                elements.append(sign(_SIGNS[token]))
            elif token.strip("\\") not in _LEFT_TO_SCREENS:
                elements.append(self._element(token))
        if closing:
            raise ValueError(f"a brace is never closed: {self.tex}")
        return elements

    def _next(self) -> str:
        match = _TOKEN.search(self.tex, self.place)
        self.place = len(self.tex) if match is None else match.end()
        return "" if match is None else match[0] if match[0] == "\\ " else match[0].rstrip()

    def _scripts(self, base: str, token: str) -> str:
        """The base with what stands below and above it, in either order."""
        places = {token: self._argument()}
        before, other = self.place, self._next()
        if other in ("_", "^") and other not in places:
            places[other] = self._argument()
        else:
            self.place = before
        match places:
            case {"_": low, "^": high}:
                return f"<msubsup>{base}{low}{high}</msubsup>"
            case {"_": low}:
                return f"<msub>{base}{low}</msub>"
        return f"<msup>{base}{places['^']}</msup>"

    def _argument(self) -> str:
        """A group, a command, one letter or one digit."""
        token = self._next()
        if not token or token == "}":
            raise ValueError(f"an argument is missing: {self.tex}")
        if token.isdigit() and len(token) > 1:
            self.place -= len(token) - 1
            token = token[0]
        return self._element(token)

    def _words(self) -> str:
        """What stands in the braces that follow, as it is."""
        match = re.compile(r" *\{([^{}]*)\}").match(self.tex, self.place)
        if match is None:
            raise ValueError(f"no braces: {self.tex}")
        self.place = match.end()
        return match[1]

    def _element(self, token: str) -> str:
        if token == "{":
            inside = self.row("}")
            return inside[0] if len(inside) == 1 else f"<mrow>{''.join(inside)}</mrow>"
        if token[:1].isdigit():
            return mn(token)
        name = token.removeprefix("\\")
        if not token.startswith("\\"):
            return mi(token) if token.isalpha() or "\ue000" <= token <= "\uf8ff" else mo(_SIGNS.get(token, token))
        if name in _ACCENTS:
            return f'<mover accent="true">{self._argument()}<mo stretchy="false">{_ACCENTS[name]}</mo></mover>'
        if name in ("frac", "tfrac"):
            return fraction(self._argument(), self._argument())
        if name in ("mathrm", "operatorname"):
            return mi(self._words())
        if name == "text":
            return mtext(self._words())
        if name in _FUNCTIONS:
            return mi(name) + "<mo>\u2061</mo>"
        if name in _SPACES:
            return f'<mspace width="{_SPACES[name]}"/>'
        if name in _SIGNS:
            return mo(_SIGNS[name])
        known = _VARIANTS.get(name, name)
        if greek(known) == known:
            return mi(letter(known))
        raise ValueError(f"not in our part of TeX: {token} in {self.tex}")
