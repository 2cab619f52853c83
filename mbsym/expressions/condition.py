"""Conditions on a motion as text: ``theta = 0``, ``r < 1/10``, ``t = 0 mod 2*pi/Omega``, ``top: v = 0 falling``.

    condition = [title ":"] expression ("=" | "<" | ">") expression ["mod" expression] ["rising" | "falling"]

``a = b`` happens where a - b passes zero, ``a < b`` where it becomes negative, ``a > b`` where it becomes positive;
``rising`` and ``falling`` keep one direction of ``=``.  With ``mod p`` it happens where a - b passes any multiple of p:
an angle that goes round is not taken modulo 2*pi unless that is said.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from difflib import get_close_matches

from mbsym.expressions.message import Message
from mbsym.expressions.parser import SpanOf, names_apart, parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.safe import quoted
from mbsym.expressions.tree import CONSTANTS, Expression, Name, subtract, walk

#: A condition has at most so many characters, its title so many.
MAX_LENGTH, MAX_TITLE = 2_000, 64

RISING, FALLING, BOTH = "rising", "falling", "both"

_RELATION = re.compile(r"<=|>=|==|[=<>]")
_WORD = re.compile(r"\b(mod|rising|falling)\b")
_TITLE = re.compile(r"\s*[^\W\d][\w -]*\Z")
_EXAMPLE = 'write for example "theta = 0", "r < 1/10", "theta = pi/2 mod 2*pi rising"'


@dataclass(frozen=True)
class Condition:
    """``difference`` = left - right passes zero (or, with a ``period``, any multiple of it) in a ``direction``.

    ``text`` is what was written; ``side`` is -1 for ``<``, 1 for ``>``, 0 for ``=``; ``closed``: it holds with
    equality, too.
    """

    title: str
    text: str
    difference: Expression
    side: int = 0
    direction: str = BOTH
    period: Expression | None = None
    closed: bool = False


def parse_condition(text: str, known: Collection[str], complaints: Complaints, span_of: SpanOf) -> Condition | None:
    """The condition that a text is, or None with at least one complaint; names are looked up among ``known``."""
    before = complaints.error_count
    if len(text) > MAX_LENGTH:
        complaints.error("too-long", "a condition has at most [[most]] characters", span_of(0, 1), most=MAX_LENGTH)
        return None
    title, colon, _ = text.partition(":")
    begin = len(title) + 1 if colon else 0
    if colon and (not _TITLE.match(title) or len(title.strip()) > MAX_TITLE):
        message = Message(
            "[[file]] is no title: letters, digits, _, - and blanks, [[most]] at most",
            file=quoted(title.strip()),
            most=MAX_TITLE,
        )
        complaints.error("bad-title", message, span_of(0, max(1, len(title))))
    relations = list(_RELATION.finditer(text, begin))
    if len(relations) != 1:
        where = span_of(*relations[1].span()) if relations else span_of(begin, max(begin + 1, len(text)))
        many = "more than one of = < >" if relations else "a condition has one of = < >"
        complaints.error("bad-condition", many, where, _EXAMPLE)
        return None
    relation = relations[0]
    words = list(_WORD.finditer(text, relation.end()))
    end = words[0].start() if words else len(text)
    left = _expression(text, begin, relation.start(), known, complaints, span_of)
    right = _expression(text, relation.end(), end, known, complaints, span_of)
    side = {"<": -1, ">": 1}.get(relation.group()[0], 0)
    period, direction = None, {-1: FALLING, 0: BOTH, 1: RISING}[side]
    for place, word in enumerate(words):
        after = words[place + 1].start() if place + 1 < len(words) else len(text)
        if word.group() == "mod" and place == 0:
            period = _expression(text, word.end(), after, known, complaints, span_of)
        elif word.group() == "mod" or text[word.end() : after].strip() or place + 1 < len(words):
            complaints.error(
                "bad-condition", "[[word]] does not stand here", span_of(*word.span()), _EXAMPLE, word=word.group()
            )
        elif side:
            message = Message(
                "[[word]] says already that it is [[direction]]", word=relation.group(), direction=direction
            )
            complaints.error("bad-condition", message, span_of(*word.span()), "rising and falling go with =")
        else:
            direction = word.group()
    if complaints.error_count > before or left is None or right is None:
        return None
    written, closed = text[begin:].strip(), "=" in relation.group()
    return Condition(
        title.strip() if colon else written, written, subtract(left, right), side, direction, period, closed
    )


def _expression(
    text: str, start: int, end: int, known: Collection[str], complaints: Complaints, span_of: SpanOf
) -> Expression | None:
    """One side, every name in it looked up."""

    def place(first: int, last: int):  # type: ignore[no-untyped-def]
        return span_of(start + first, start + last)

    before = complaints.error_count
    piece = text[start:end]
    expression = parse_expression(piece, complaints, place)
    for node in walk(expression) if expression is not None else names_apart(piece, place, complaints.items):
        if isinstance(node, Name) and node.name not in (*known, *CONSTANTS) and node.span is not None:
            close = get_close_matches(node.name[:MAX_TITLE], sorted(known)[:200], n=1)
            listed = ", ".join(sorted(known)[:20])
            hint = (
                Message("did you mean '[[other]]'?", other=close[0])
                if close
                else Message("there are [[listed]]", listed=listed)
            )
            complaints.error("unknown-name", Message("unknown name [[name]]", name=quoted(node.name)), node.span, hint)
    return expression if complaints.error_count == before else None


def _commas(text: str) -> Iterator[int]:
    """Where the parts of a list end: at commas outside of parentheses, and at its end."""
    depth = 0
    for place, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if character == "," and depth <= 0:
            yield place
    yield len(text)


#: (text, expression, period) of an axis.
AxisText = tuple[str, Expression, Expression | None]


def parse_axes(text: str, known: Collection[str], complaints: Complaints, span_of: SpanOf) -> tuple[AxisText, ...]:
    """``q2, q2_dot`` or ``theta mod 2*pi, energy``: expressions, two at least, each perhaps modulo a period."""
    axis_texts: list[AxisText] = []
    start = 0
    for end in _commas(text[:MAX_LENGTH]):
        piece = text[start:end]
        word = re.search(r"\bmod\b", piece)
        middle = start + word.start() if word else end
        value = _expression(text, start, middle, known, complaints, span_of)
        period = _expression(text, start + word.end(), end, known, complaints, span_of) if word else None
        if value is not None:
            axis_texts.append((piece.strip(), value, period))
        start = end + 1
    if len(text) > MAX_LENGTH or (len(axis_texts) < 2 and not complaints.errors):
        complaints.error("bad-axes", "a section has two axes at least", span_of(0, max(1, len(text))), "q2, q2_dot")
    return tuple(axis_texts)
