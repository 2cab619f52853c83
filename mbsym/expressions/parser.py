"""Text to expression tree: a whitelist grammar with bounds, never Python's own evaluator.

    sum      = product (("+" | "-") product)*
    product  = signed (("*" | "/") signed)*
    signed   = ("-" | "+") signed | power
    power    = atom [("**" | "^") signed]    (the exponent must come out as one rational number)
    atom     = number | name ["'" ["'"]] | function "(" sum ("," sum)* ")" | "(" sum ")"

``theta'`` is ``theta_dot`` and ``theta''`` is ``theta_ddot``, as results print them.

Numbers are exact: ``0.1`` is 1/10 and ``1e-3`` is 1/1000.  What is too long, too deep or too big is complained about
before any work is spent on it, so that ``9**9**9**9`` costs nothing; whatever evaluates the tree later can rely on the
bounds below.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from math import ceil

from mbsym.expressions.angles import linear_form
from mbsym.expressions.constants import meaningless
from mbsym.expressions.message import Message, joined
from mbsym.expressions.place import Complaint, Complaints, Span, in_line
from mbsym.expressions.rates import ACCELERATION_ENDING, VELOCITY_ENDING
from mbsym.expressions.safe import quoted
from mbsym.expressions.table import Table
from mbsym.expressions.tree import (
    FUNCTIONS,
    SIGNATURES,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    multiply,
    sign_by_structure,
    text,
    without_jump,
)

#: An expression has at most so many characters, tree nodes, levels of the tree, and nested parentheses.
MAX_LENGTH = 20_000
MAX_NODES = 2_000
MAX_DEPTH = 150
MAX_NESTING = 50

#: A literal has at most so many digits before and after the point (``1e-60`` is the smallest).
MAX_DIGITS = 60

#: So many foreign characters of one expression are complained about.
MAX_STRANGE = 10

#: The size of an exponent, and the denominator of a fractional one.
MAX_EXPONENT = 64
MAX_DENOMINATOR = 1_000

#: Bound of the size of any number that evaluating the tree can produce, counted as in :func:`_weight`.
MAX_WEIGHT = 5_000

#: No tables to call.
NO_TABLES: Mapping[str, Table] = {}

SpanOf = Callable[[int, int], Span]


@dataclass(frozen=True, slots=True)
class Bounds:
    """How much of one expression is read: characters, nodes, levels of the tree, parentheses, weight."""

    length: int = MAX_LENGTH
    nodes: int = MAX_NODES
    depth: int = MAX_DEPTH
    nesting: int = MAX_NESTING
    weight: int = MAX_WEIGHT


#: Of what a person writes, and of what mbsym has derived: thousands of terms, in any order of magnitude that it prints.
WRITTEN = Bounds()
DERIVED = Bounds(length=8_000_000, nodes=2_000_000, depth=200_000, nesting=100, weight=2_000_000)

_TOKEN = re.compile(
    r"(?P<blank>\s+)"
    r"|(?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+(?![A-Za-z0-9_.]))?)"
    r"|(?P<name>[A-Za-z_][A-Za-z0-9_]*'{0,2})"
    r"|(?P<operator>\*\*|[-+*/()^,])",
)

_OPENING = re.compile(r"\s*\(")

_LOOKALIKES = {
    "−": "write - for minus",
    "–": "write - for minus",
    "—": "write - for minus",
    "×": "write * for a product",
    "·": "write * for a product",
    "⋅": "write * for a product",
    "∗": "write * for a product",
    "÷": "write / for a quotient",
    "∕": "write / for a quotient",
    "°": "angles are in radians: write 30*pi/180 for 30 degrees",
    "²": "write **2",
    "³": "write **3",
    "√": "write sqrt(...)",
    "π": "write pi",
    "\\": "nothing is written as in LaTeX: theta, a/b, sqrt(a)",
    "[": "only round parentheses group",
    "]": "only round parentheses group",
    "{": "only round parentheses group",
    "}": "only round parentheses group",
}

#: What joins conditions elsewhere; no names here, so that no product holds them.
_CONNECTIVES = {"and", "or", "not"}

_ARCSINE = "atan(x/sqrt(1 - x**2)) for asin(x)"
_ARCCOSINE = "pi/2 - atan(x/sqrt(1 - x**2)) for acos(x)"
_FOREIGN_FUNCTIONS = {
    "arctan": "atan",
    "arctangent": "atan",
    "ln": "log",
    "tg": "tan",
    "sh": "sinh",
    "ch": "cosh",
    "th": "tanh",
    "sgn": "sign",
    "signum": "sign",
    "heaviside": "step",
    "Heaviside": "step",
    "fabs": "abs",
    "cot": "1/tan(...)",
    "ctg": "1/tan(...)",
    "asin": _ARCSINE,
    "arcsin": _ARCSINE,
    "arcsine": _ARCSINE,
    "acos": _ARCCOSINE,
    "arccos": _ARCCOSINE,
    "arccosine": _ARCCOSINE,
}

#: Names of functions elsewhere, so short that they could be taken for factors.
_NO_FACTORS = ("max", "min", "pow", "sec", "csc")

DEGREES = ("deg", "degs", "degree", "degrees")
_RADIANS = ("rad", "rads", "radian", "radians")

#: Units behind a number, which mean nothing here; some are names of quantities just as well.
_UNITS = tuple(
    unit
    for units in (
        "kg g mg lb lbs m mm cm km um ft s ms us sec min h hr Hz kHz N kN mN Nm Pa kPa MPa J kJ W kW rpm",
        "second seconds minute minutes hour hours meter meters metre metres gram grams kilogram kilograms",
        "newton newtons",
    )
    for unit in units.split()
)

_DECIMAL_COMMA = re.compile(r"(?<![\w.,])([0-9]+),([0-9]+)(?![\w.,])")

_BINDING = {"+": 10, "-": 10, "*": 20, "/": 20}


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str  # "number", "name", "operator", "end"
    text: str
    start: int
    end: int


class _Refused(Exception):
    """Internal: this expression is given up; the complaint is already recorded."""


def parse_expression(
    text: str,
    complaints: Complaints,
    span_of: SpanOf = in_line,
    named: bool = True,
    bounds: Bounds = WRITTEN,
    tables: Mapping[str, Table] = NO_TABLES,
) -> Expression | None:
    """The tree of an expression, or None with at least one complaint; of one that holds a number that is none, log(0),
    both the tree, for its names count, and the complaint.

    ``span_of(start, end)`` turns offsets in ``text`` into places of the file.  Names are not looked up here: which
    names a place allows is the reader's business; where it allows none (``named`` is false) no hint speaks of any.
    Only ``tables`` are known: they may be called like functions.
    """
    errors_before = complaints.error_count
    try:
        if len(text) > bounds.length:
            complaints.error(
                "too-long", "an expression has at most [[length]] characters", span_of(0, 1), length=bounds.length
            )
            raise _Refused
        parser = _Parser(text, _tokens(text, complaints, span_of), complaints, span_of)
        parser.named = named
        parser.bounds = bounds
        parser.tables = tables
        tree = parser.whole()
    except _Refused:
        return None
    if complaints.error_count == errors_before and (nothing := meaningless(tree)) is not None:
        node, why = nothing
        complaints.error("no-number", "this is no real number: [[why]]", node.span, _no_number_hint(node), why=why)
        return tree
    return tree if complaints.error_count == errors_before else None


def _no_number_hint(node: Expression) -> str | None:
    """What is usually meant: a limit has a name, and a sign was lost."""
    match node:
        case Operation("/"):
            return "its divisor is zero to 600 digits: leave the fraction out, or let a parameter stand for the divisor"
        case Call("log"):
            return "a logarithm is that of a positive number"
        case Call("sqrt") | Operation("**"):
            return "a root is that of a positive number or zero"
        case Call("tan"):
            return "an angle of pi/2 is described by its cosine, 0, not by its tangent"
    return None


def names_apart(text: str, span_of: SpanOf, refused: Sequence[Complaint]) -> list[Name]:
    """The names in a text that is no expression, so that each can be looked up: one mistake hides no other.

    Left out is what would be blamed twice (the pieces that ``refused`` is about) and what is no name of anything:
    functions, letters beside foreign characters, words that stand behind one another like prose or units.
    """
    spans = [item.span for item in refused if item.span is not None and item.code != "division-by-zero"]
    if len(text) > MAX_LENGTH:
        return []
    names: list[Name] = []
    blank = _Token("operator", "", 0, 0)
    previous, end, position = blank, -1, 0  # end: where the last piece that is no token ended
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            previous, position = blank, position + 1
            end = position
            continue
        start, position = match.span()
        if match.lastgroup == "blank":
            continue
        token = _token(match)
        beside = start == end or (position < len(text) and _TOKEN.match(text, position) is None)
        call = _OPENING.match(text, position) is not None
        if token.kind == "name" and previous.kind == "operator" and not (beside or call or token.text in FUNCTIONS):
            span = span_of(start, position)
            if not any(_inside(span, other) for other in spans):
                names.append(Name(token.text, span))
        previous = token
    return names


def _inside(span: Span, other: Span) -> bool:
    return span.line == other.line and other.column <= span.column < other.column + other.length


def _token(match: re.Match[str]) -> _Token:
    text = "**" if match.group() == "^" else match.group()
    name = text.rstrip("'")
    ending = ("", VELOCITY_ENDING, ACCELERATION_ENDING)[len(text) - len(name)]
    return _Token(match.lastgroup or "", name + ending, *match.span())


def _tokens(text: str, complaints: Complaints, span_of: SpanOf) -> list[_Token]:
    """All tokens with an end mark; foreign characters are complained about, all of them."""
    tokens: list[_Token] = []
    position, strange = 0, 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            strange += 1
            if strange > MAX_STRANGE:
                message = Message(
                    "and more characters without a meaning: the first [[most]] are shown",
                    most=MAX_STRANGE,
                )
                complaints.error("bad-character", message, span_of(position, len(text)))
                break
            position = _complain_of_character(text, position, complaints, span_of)
            continue
        if match.lastgroup != "blank":
            tokens.append(_token(match))
        position = match.end()
    if strange:
        raise _Refused
    return [*tokens, _Token("end", "", len(text), len(text))]


def _complain_of_character(text: str, position: int, complaints: Complaints, span_of: SpanOf) -> int:
    """Complain of one foreign character, or of a whole run of foreign letters; the position after it."""
    character, end = text[position], position + 1
    while character.isalpha() and end < len(text) and text[end].isalpha() and not text[end].isascii():
        end += 1
    while character.isdecimal() and end < len(text) and text[end].isdecimal() and not text[end].isascii():
        end += 1
    shown = text[position:end]
    hint = _LOOKALIKES.get(character)
    if character.isdecimal():
        hint = Message("digits are 0 to 9: write [[value]]", value=int(shown))
    if re.match(r"\.(inf|nan)\b", text[position:], re.IGNORECASE):
        end, hint = position + 4, "infinity and what is no number have no place here: write a number"
        shown = text[position:end]
    if character == "'" and position and text[position - 1].isalnum():
        hint = "a velocity is written theta' or theta_dot, an acceleration theta'' or theta_ddot"
    if hint is None and character.isalpha():
        hint = Message("names are Latin letters, digits and _: write [[latin]]", latin=in_latin(shown))
    complaints.error(
        "bad-character",
        Message("the character [[shown]] has no meaning here", shown=ascii_safe(shown)),
        span_of(position, end),
        hint,
    )
    return end


#: A quoted piece of the file for a message.
ascii_safe = quoted


def in_latin(text: str) -> str:
    """``theta`` for the Greek letter, ``a`` for a lookalike of a, ``l0`` for a script l with a lowered 0."""
    text = unicodedata.normalize("NFKC", text)
    if re.fullmatch("[\u0400-\u04ff]{2,}", text):  # a word of another alphabet, letter by letter as it sounds
        written = "".join(_SOUNDS.get(x.lower(), x) for x in text)
    else:
        written = "".join(_LOOKS_LIKE.get(x) or _latin_letter(x) for x in text)
    return written if written.isascii() else "the name in Latin letters"


#: Cyrillic letters that are taken for Latin ones, and how they sound.
_LOOKS_LIKE = dict(zip("АВЕКМНОРСТУХаекморстух", "ABEKMHOPCTYXaekmopctyx", strict=True))
_SOUNDS = dict(zip("абвгдеёзийклмнопрстуфыэ", "abvgdeeziyklmnoprstufye", strict=True)) | {
    "ж": "zh", "х": "kh", "ц": "ts", "ч": "ch", "ш": "sh", "щ": "shch", "ю": "yu", "я": "ya", "ь": "", "ъ": "",
}  # fmt: skip


def _latin_letter(character: str) -> str:
    name = unicodedata.name(character, "")
    if character.isascii() or "LETTER " not in name:
        return character
    word = name.rsplit("LETTER ", 1)[-1].split(" WITH ")[0].split(" ")[-1]
    return word.lower() if "CAPITAL" not in name else word.capitalize()


def decimal_comma(text: str) -> str | None:
    """The hint for a number such as ``0,5`` in a text."""
    match = _DECIMAL_COMMA.search(text)
    return match and Message(
        "numbers have a decimal point: write [[whole]].[[part]]", whole=match.group(1), part=match.group(2)
    )


class _Parser:
    """Precedence climbing over a list of tokens."""

    def __init__(self, text: str, tokens: list[_Token], complaints: Complaints, span_of: SpanOf) -> None:
        self.text = text
        self.tokens = tokens
        self.position = 0
        self.nodes = 0
        self.nesting = 0
        self.sizes: dict[int, tuple[int, int]] = {}  # of each node by identity: depth and weight
        self.kept: list[Expression] = []  # keeps identities from being used again
        self.complaints = complaints
        self.span_of = span_of
        self.named = True
        self.bounds = WRITTEN
        self.tables: Mapping[str, Table] = NO_TABLES

    def whole(self) -> Expression:
        if self.next.kind == "end":
            raise self.refusal("bad-expression", "an expression is missing", self.next)
        tree = self.sum(0)
        if self.next.kind != "end":
            raise self.trailing(self.next)
        return tree

    @property
    def next(self) -> _Token:
        return self.tokens[self.position]

    def advance(self) -> _Token:
        token = self.tokens[self.position]
        self.position += 1
        return token

    def sum(self, binding: int) -> Expression:
        """An operand and every following operator that binds more tightly than ``binding``."""
        start = self.next.start
        left = self.signed()
        while (own := _BINDING.get(self.next.text, 0)) > binding:
            operator = self.advance()
            right = self.sum(own)
            if operator.text == "/" and _is_zero(right):
                self.complain("division-by-zero", "division by zero", operator.start, self.last_end)
            whole = Operation(operator.text, left, right, self.span_of(start, self.last_end))
            left = self.grown(without_jump(whole) if operator.text == "*" else whole, left, right)
        return left

    @property
    def last_end(self) -> int:
        return self.tokens[self.position - 1].end

    def signed(self) -> Expression:
        """Signs bind less tightly than powers: -x**2 is -(x**2)."""
        signs = []
        while self.next.text in ("-", "+"):
            signs.append(self.advance())
        operand = self.power()
        for sign in reversed(signs):
            if sign.text == "-":
                operand = self.grown(Negative(operand, self.span_of(sign.start, self.last_end)), operand)
        return operand

    def power(self) -> Expression:
        start = self.next.start
        base = self.atom()
        if self.next.text != "**":
            return base
        self.advance()
        exponent = self.exponent(base)
        if not isinstance(exponent, Number):
            return exponent  # what it holds is looked at, too
        if _is_zero(base) and exponent.value <= 0:
            self.complain("division-by-zero", "zero has no such power", start, self.last_end)
        return self.grown(Operation("**", base, exponent, self.span_of(start, self.last_end)), base)

    def exponent(self, base: Expression) -> Expression:
        """One rational number: ``x**(1/2)`` is folded here, symbols are refused, which gives no number."""
        start = self.next.start
        self.nest(self.next)
        tree = self.signed()
        self.nesting -= 1
        end = self.last_end
        form = linear_form(tree)
        if form is None or not form.is_constant:
            of_euler = base == Name("e")
            written = text(Call("exp", tree if of_euler else multiply(tree, Call("log", base))))
            shown = Message("Euler's number") if of_euler else text(base)
            real = not _is_zero(base) and sign_by_structure(base, {}) != "negative"
            hint = Message("[[base]] to this power is [[written]]", base=shown, written=written) if real else None
            self.complain("bad-exponent", "an exponent must be a rational number", start, end, hint)
            return tree if of_euler else self.grown(Operation("*", base, tree, self.span_of(start, end)), base, tree)
        value = form.constant
        if abs(value) > MAX_EXPONENT or value.denominator > MAX_DENOMINATOR:
            bounds = Message(
                "at most [[most]] in size, a fraction of at most [[parts]] parts",
                most=MAX_EXPONENT,
                parts=MAX_DENOMINATOR,
            )
            self.complain("bad-exponent", Message("an exponent is [[bounds]]", bounds=bounds), start, end)
            raise _Refused
        return Number(value, self.span_of(start, end))

    def atom(self) -> Expression:
        token = self.advance() if self.next.kind != "end" else self.next
        if token.kind == "number":
            return self.grown(Number(self.literal(token), self.span_of(token.start, token.end)))
        if token.kind == "name" and self.next.text == "(":
            return self.call(token)
        if token.kind == "name":
            return self.name(token)
        if token.text == "(":
            return self.inside(token)[0]
        if token.kind == "end":
            raise self.refusal("bad-expression", "the expression ends too early", token)
        raise self.refusal("bad-expression", Message("unexpected [[what]]", what=ascii_safe(token.text)), token)

    def name(self, token: _Token) -> Expression:
        if token.text in FUNCTIONS:
            raise self.refusal(
                "bad-expression",
                Message("[[what]] needs an argument", what=token.text),
                token,
                Message(
                    "write [[what]]([[argument]])",
                    what=token.text,
                    argument=self.next.text if self.next.kind in ("name", "number") else "...",
                ),
            )
        return self.grown(Name(token.text, self.span_of(token.start, token.end)))

    def call(self, token: _Token) -> Expression:
        table = self.tables.get(token.text)
        known = token.text in FUNCTIONS or table is not None
        if not known:
            self.complain(
                "unknown-function",
                Message("unknown function [[what]]", what=ascii_safe(token.text)),
                token.start,
                token.end,
                _function_hint(token.text, self.tables),
            )
        usage = SIGNATURES.get(token.text, "")
        argument, *more = self.inside(self.advance(), usage.count(",") + 1, usage)
        span = self.span_of(token.start, self.last_end)
        return self.grown(Call(token.text, argument, span, tuple(more), table), argument, *more)

    def inside(self, opening: _Token, required: int = 1, usage: str = "") -> list[Expression]:
        """What stands between an opening parenthesis, already read, and its closing one: so many arguments."""
        self.nest(opening)
        expressions = [self.sum(0)]
        while self.next.text == "," and len(expressions) < required:
            self.advance()
            expressions.append(self.sum(0))
        self.nesting -= 1
        if self.next.text == ")" and len(expressions) < required:
            raise self.refusal(
                "bad-expression",
                Message("[[wanted]] arguments are wanted", wanted=required),
                self.next,
                Message("write [[usage]]", usage=usage),
            )
        if self.next.text == ")":
            self.advance()
            return expressions
        if self.next.text == ",":
            message = "one argument only" if required == 1 else Message("[[wanted]] arguments only", wanted=required)
            hint = decimal_comma(self.text) or (Message("write [[usage]]", usage=usage) if usage else None)
            raise self.refusal("bad-expression", message, self.next, hint)
        if self.next.kind == "end":
            hint = "within {...} or [...] quote what holds commas" if required > len(expressions) else None
            raise self.refusal("bad-expression", "this parenthesis is never closed", opening, hint)
        raise self.trailing(self.next)

    def nest(self, token: _Token) -> None:
        self.nesting += 1
        if self.nesting > self.bounds.nesting:
            raise self.refusal(
                "too-deep", Message("parentheses nest at most [[nesting]] deep", nesting=self.bounds.nesting), token
            )

    def literal(self, token: _Token) -> Fraction:
        """The exact value of a decimal literal, after a look at its size."""
        mantissa, _, exponent = token.text.lower().partition("e")
        whole, _, decimals = mantissa.partition(".")
        shift = int(exponent) if 0 < len(exponent) <= 4 else 0
        whole, decimals = whole.lstrip("0"), decimals.rstrip("0")
        if len(exponent) > 4 or len(whole) + shift > MAX_DIGITS or len(decimals) - shift > MAX_DIGITS:
            raise self.refusal(
                "bad-number",
                Message("a number has at most [[most]] digits before and after the point", most=MAX_DIGITS),
                token,
            )
        digits = Fraction(int((whole + decimals) or "0"), 10 ** len(decimals))
        return digits * Fraction(10) ** shift

    def grown(self, node: Expression, *operands: Expression) -> Expression:
        """The node, after counting it: the tree stays within its bounds."""
        self.nodes += 1
        sizes = [self.sizes[id(operand)] for operand in operands]
        depth = 1 + max((size[0] for size in sizes), default=0)
        weight = _weight(node, [size[1] for size in sizes])
        self.sizes[id(node)] = depth, weight
        self.kept.append(node)
        if self.nodes > self.bounds.nodes:
            raise self.refusal(
                "too-long",
                Message("an expression has at most [[nodes]] parts", nodes=self.bounds.nodes),
                self.tokens[self.position - 1],
            )
        if depth > self.bounds.depth:
            raise self.refusal(
                "too-deep",
                Message("an expression nests at most [[depth]] operations deep", depth=self.bounds.depth),
                self.tokens[self.position - 1],
                "group long sums with parentheses",
            )
        if weight > self.bounds.weight:
            raise self.refusal(
                "too-long", "these powers multiply up to numbers beyond all bounds", self.tokens[self.position - 1]
            )
        return node

    def complain(self, code: str, message: str, start: int, end: int, hint: str | None = None) -> None:
        self.complaints.error(code, message, self.span_of(start, max(end, start + 1)), hint)

    def refusal(self, code: str, message: str, token: _Token, hint: str | None = None) -> _Refused:
        self.complain(code, message, token.start, token.end, hint)
        return _Refused()

    def trailing(self, token: _Token) -> _Refused:
        """Something stands where an operator should: most often a forgotten product sign."""
        previous = self.tokens[self.position - 1] if self.position else token
        hint: str | None = None
        if token.kind in ("name", "number") or token.text == "(":
            factor = f"{token.text}(...)" if token.text in FUNCTIONS else token.text
            hint = Message("write [[what]]*[[what2]] for a product", what=previous.text, what2=factor)
        if previous.kind == "number" and token.kind == "name":
            hint = _other_base(previous.text + token.text) or _unit_hint(previous.text, token.text, self.named) or hint
        if _CONNECTIVES & {previous.text, token.text}:
            hint = Message("one condition in one place: write two that have to hold as two, or 0 < x < 1")
        if token.text == ",":
            hint = decimal_comma(self.text)
        if previous.kind == "number" and re.fullmatch(r"[0-9_]+", token.text):
            hint = Message(
                "digits stand together: write [[what]][[joined]]",
                what=previous.text,
                joined=token.text.replace("_", ""),
            )
        elif previous.kind == token.kind == "number" and previous.end == token.start:
            hint = "a number has one decimal point"
        if token.text == ")":
            return self.refusal("bad-expression", "this parenthesis was never opened", token)
        return self.refusal(
            "bad-expression",
            Message("an operator is missing before [[what]]", what=ascii_safe(token.text)),
            token,
            hint,
        )


def _other_base(text: str) -> str | None:
    """For ``0x1f``, and for an exponent that was not finished."""
    if re.fullmatch(r"0x[0-9a-fA-F]+|0o[0-7]+|0b[01]+", text):
        return Message("numbers are decimal: write [[value]]", value=int(text, 0))
    if re.fullmatch(r"[0-9.]+[eE]", text):
        return Message("an exponent has digits, as in 2e3: write [[value]]", value=text[:-1])
    return None


def _unit_hint(value: str, unit: str, named: bool) -> str | None:
    """For a number with a unit behind it; where names may stand, the unit may be meant as a factor, too."""
    if unit.lower() in DEGREES:
        short = " or pi/6" if value == "30" else ""
        return Message("angles are in radians: write [[value]]*pi/180[[short]]", value=value, short=short)
    if unit.lower() in _RADIANS:
        return Message("angles are in radians: write [[value]] alone", value=value)
    if named and unit not in _UNITS:
        return None
    units = Message("no units beside numbers: write numbers only, and units under 'units'")
    product = Message("for a product write [[value]]*[[unit]]", value=value, unit=unit)
    return joined([units, product], "; ") if named else units


def _function_hint(name: str, tables: Iterable[str]) -> str:
    tabulated = get_close_matches(name, tables, n=1)
    if tabulated:
        return Message("did you mean '[[other]]'?", other=tabulated[0])
    if name in _FOREIGN_FUNCTIONS:
        return Message("write [[function]]", function=_FOREIGN_FUNCTIONS[name])
    lower = name.lower()[:40]
    begun = [function for function in FUNCTIONS if lower.startswith(function)]  # cosine, sinus, exponential
    close = [max(begun, key=len)] if begun else get_close_matches(lower, FUNCTIONS, n=1)
    if close:
        return Message("did you mean '[[other]]'?", other=close[0])
    if len(name) <= 3 and name not in _NO_FACTORS:
        return Message(
            "write [[name]]*(...) for a product; the functions are [[functions]]",
            name=name,
            functions=", ".join(FUNCTIONS),
        )
    return Message("the functions are [[functions]]", functions=", ".join(FUNCTIONS))


def _is_zero(tree: Expression) -> bool:
    form = linear_form(tree)
    return form is not None and form.is_constant and not form.constant


def _weight(node: Expression, operands: list[int]) -> int:
    """How long the exact value can become at a point of small rational numbers: names and short numbers count 1."""
    match node:
        case Number(value):
            return 1 + value.numerator.bit_length() // 16 + value.denominator.bit_length() // 16
        case Operation("**", _, Number(exponent)):
            return operands[0] * max(1, ceil(abs(exponent)))
    return max(1, sum(operands))
