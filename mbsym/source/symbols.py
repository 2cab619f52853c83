r"""Names as they are to stand in LaTeX: ``latex: {d_Ccm1: 'd_{C1}'}``, and nothing that could do more than that.

A symbol is a letter, a word in braces after a font, or a command for a letter, perhaps under an accent, with an index:
``J``, ``\varkappa``, ``\hat{\theta}``, ``\mathrm{tr}_{\max}``.  No exponent, no prime: formulas have those.
"""

from __future__ import annotations

import re

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.model.system import WrittenSymbol
from mbsym.source.keys import LONGEST
from mbsym.source.placed import Node, Scalar
from mbsym.source.reading import Reading
from mbsym.source.scope import Allowed

_LETTERS = frozenset(
    """alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi varpi rho varrho
    sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega ell
    hbar""".split()  # noqa: SIM905 (a list of words is read more easily)
)
_FONTS = frozenset({"mathrm", "mathit", "mathbf", "mathsf", "mathcal", "boldsymbol"})
_AROUND = _FONTS | {"hat", "bar", "tilde", "vec"}
_IN_INDEX = {"max", "min", "ast", "star", "infty", "cdot"}
_TOKEN = re.compile(r"\\[A-Za-z]+ ?|\\?.", re.DOTALL)
_FURTHER = ("abbreviation", "input")
_HINT = r"a letter or a command such as \theta, \hat{x}, \mathrm{word}, with an index: 'd_{C1}'"


class _Wrong(Exception):
    """What is wrong, from where to where."""

    def __init__(self, message: str, start: int, end: int) -> None:
        super().__init__(message)
        self.start, self.end = start, end


def read_symbols(node: Node | None, reading: Reading) -> tuple[WrittenSymbol, ...]:
    """``name: symbol`` for names of the description; no two of the same look."""
    symbols: list[WrittenSymbol] = []
    kinds = ("coordinate", "speed", "unit vector", "quaternion", "prescribed", "parameter", "notation", *_FURTHER)
    allowed = Allowed("a name with a symbol", kinds)
    for entry in () if node is None else reading.entries(node, "'latex'"):
        known = reading.scope.check_name(entry.key.text, entry.key.span, allowed)
        scalar = reading.scalar(entry.value, Message("the symbol of [[what]]", what=ascii_safe(entry.key.text)))
        if scalar is None or not known or not _is_symbol(scalar, reading):
            continue
        symbol = " ".join(scalar.text.split())
        other = next((written_symbol.name for written_symbol in symbols if written_symbol.latex == symbol), None)
        if other is not None:
            message = Message(
                "[[what]] and [[other]] have the same symbol", what=ascii_safe(entry.key.text), other=ascii_safe(other)
            )
            reading.error("repeated-symbol", message, scalar.span)
            continue
        symbols.append(WrittenSymbol(entry.key.text, symbol, entry.key.span))
    return tuple(symbols)


def _is_symbol(scalar: Scalar, reading: Reading) -> bool:
    try:
        check(scalar.text)
    except _Wrong as wrong:
        reading.error("bad-symbol", wrong.args[0], scalar.place(wrong.start, wrong.end), _HINT)
        return False
    return True


def check(text: str) -> None:
    """Raises ``_Wrong`` unless the text is one symbol, perhaps with an index."""
    if len(text) > LONGEST:
        raise _Wrong(Message("a symbol has at most [[most]] characters", most=LONGEST), 0, len(text))
    tokens = [(match[0].strip() or " ", match.start()) for match in _TOKEN.finditer(text)]
    place = _stem(tokens, 0, text)
    if [token for token, _ in tokens] == ["\\pi"]:
        raise _Wrong(r"\pi is the number, in formulas as in descriptions", 0, len(text))
    if place < len(tokens):
        if tokens[place][0] != "_":
            raise _unexpected(tokens[place], "a symbol is one letter, command or word, then its index")
        place = _index(tokens, place + 1, text)
    if place < len(tokens):
        raise _unexpected(tokens[place], "nothing stands after the index")


def _stem(tokens: list[tuple[str, int]], place: int, text: str) -> int:
    """Behind one letter, or one command with what stands under or in it."""
    if place == len(tokens):
        raise _Wrong("a letter is missing", len(text), len(text) + 1)
    token, _ = tokens[place]
    if token.removeprefix("\\") in _AROUND and token.startswith("\\"):
        if place + 1 == len(tokens) or tokens[place + 1][0] != "{":
            raise _unexpected(tokens[place], Message("[[token]] needs braces: [[token]]{x}", token=token))
        return _group(tokens, place + 1, text, words=token.startswith("\\math"))
    if re.fullmatch("[A-Za-z]", token) or (token.startswith("\\") and token[1:] in _LETTERS):
        return place + 1
    raise _unexpected(tokens[place], Message("[[token]] is not allowed in a symbol", token=ascii_safe(token)))


def _group(tokens: list[tuple[str, int]], place: int, text: str, words: bool) -> int:
    """Behind a group in braces: one letter, or a word where a font is meant."""
    place = inside = place + 1
    while place < len(tokens) and tokens[place][0] != "}":
        if not words and place > inside:
            raise _unexpected(tokens[place], "one letter stands under an accent")
        if words and re.fullmatch("[0-9]", tokens[place][0]) and place > inside:
            place += 1
            continue
        place = _stem(tokens, place, text)
    return _closed(tokens, inside, place)


def _index(tokens: list[tuple[str, int]], place: int, text: str) -> int:
    """Behind an index: one letter or digit, or anything plain in braces."""
    if place == len(tokens):
        raise _Wrong("an index is missing", len(text), len(text) + 1)
    if tokens[place][0] != "{":
        return place + 1 if re.fullmatch("[0-9]", tokens[place][0]) else _stem(tokens, place, text)
    place = inside = place + 1
    while place < len(tokens) and tokens[place][0] != "}":
        token = tokens[place][0]
        plain = re.fullmatch(r"[0-9,+*/ .-]", token) or (token.startswith("\\") and token[1:] in _IN_INDEX)
        place = place + 1 if plain else _stem(tokens, place, text)
    return _closed(tokens, inside, place)


def _closed(tokens: list[tuple[str, int]], inside: int, place: int) -> int:
    """Behind the brace that closes what begins ``inside``."""
    if place == len(tokens):
        raise _unexpected(tokens[inside - 1], "the brace is never closed")
    if place == inside:
        raise _unexpected(tokens[inside - 1], "there is nothing in the braces")
    return place + 1


def _unexpected(token: tuple[str, int], message: str) -> _Wrong:
    return _Wrong(message, token[1], token[1] + len(token[0]))
