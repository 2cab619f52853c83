"""An independent reader of presentation MathML: what a formula of a page is worth at given values.

It knows nothing of how mbsym writes; it reads what stands there as a person would, with invisible times and invisible
application where MathML wants them.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Iterator, Mapping
from typing import Any
from xml.etree import ElementTree as ET

from flint import arb, fmpq

TIMES, APPLY = "\u2062", "\u2061"
Token = tuple[str, Any]


def tree(page: str) -> ET.Element:
    """The page as XML, without what its style and scripts say."""
    bare = re.sub(r"(<(script|style)\b[^>]*>)(.*?)(</\2>)", r"\1\4", page, flags=re.DOTALL)
    return ET.fromstring(bare)


def formulas(root: ET.Element) -> dict[str, list[Token]]:
    """Right-hand sides by left-hand sides: every line of the form ``left = ...`` (the last one of a name)."""
    found: dict[str, list[Token]] = {}
    for line in root.iter("div"):
        if line.get("class") == "formula":
            tokens = [token for part in line.iter("math") for token in tokens_of(part)]
            place = next((k for k, token in enumerate(tokens) if token == ("mo", "=")), None)
            if place is not None:
                found["".join(str(value) for _, value in tokens[:place])] = tokens[place + 1 :]
    return found


def tokens_of(parent: ET.Element) -> list[Token]:
    """Children one after the other; what a function is applied to belongs together."""
    found: list[Token] = []
    for child in parent:
        if child.tag == "mrow" and found[-1:] == [("mo", APPLY)]:
            found.append(("group", tokens_of(child)))
        else:
            found += _tokens(child)
    return found


def _tokens(node: ET.Element) -> Iterator[Token]:
    text = (node.text or "").strip()
    match node.tag:
        case "mi" | "msub" | "mover":
            yield "mi", _name(node)
        case "mn":
            yield "mn", text
        case "mo":
            yield "mo", text
        case "mtext":
            yield "mtext", text
        case "mspace":
            return
        case "mrow" | "math" | "mtd":
            yield from tokens_of(node)
        case "msup":
            yield from _tokens(node[0])
            yield "power", tokens_of(node[1]) if node[1].tag == "mrow" else list(_tokens(node[1]))
        case "msubsup":
            yield "mi", f"{_name(node[0])}_{''.join(node[1].itertext())}"
            yield "power", list(_tokens(node[2]))
        case "mfrac":
            yield "fraction", (list(_tokens(node[0])), list(_tokens(node[1])))
        case "msqrt":
            yield "root", tokens_of(node)
        case "mtable":
            yield "table", [[list(_tokens(cell)) for cell in line] for line in node]
        case other:
            raise ValueError(f"<{other}> in a formula")


def _name(node: ET.Element) -> str:
    """theta with one dot and index 1 is ``\u03b8.1``-like: stem, dots, index."""
    if node.tag == "msub":
        return f"{_name(node[0])}_{''.join(node[1].itertext())}"
    if node.tag == "mover":
        return _name(node[0]) + {"\u02d9": "'", "\u00a8": "''"}[(node[1].text or "").strip()]
    return node.text or ""


def written(name: str, dots: str = "") -> str:
    """What a declared name looks like: theta1 with one dot -> ``\u03b8'_1``; Jx -> ``J_x``."""
    match = re.fullmatch(r"([A-Za-z]+?)_?(\d+|[xyz]|A|B)?", name)
    assert match is not None, name
    stem, index = match[1], match[2]
    if len(stem) > 1:
        kind = "SMALL" if stem.islower() else "CAPITAL"
        stem = unicodedata.lookup(f"GREEK {kind} LETTER {stem.replace('lambda', 'lamda').upper()}")
    return stem + dots + (f"_{index}" if index else "")


class Reader:
    """sum := product (+|- product)*,  product := factor (invisible times factor)*,  factor := atom [power]."""

    def __init__(self, tokens: list[Token], values: Mapping[str, Any], number: Callable[[fmpq], Any] = arb) -> None:
        self.tokens, self.values, self.number, self.place = tokens, values, number, 0

    def value(self) -> Any:
        found = self.sum()
        assert self.place == len(self.tokens), f"what follows is not read: {self.tokens[self.place :][:4]}"
        return found

    def peek(self) -> Token:
        return self.tokens[self.place] if self.place < len(self.tokens) else ("end", "")

    def take(self) -> Token:
        self.place += 1
        return self.tokens[self.place - 1]

    def sum(self) -> Any:
        negative = self.peek() == ("mo", "\u2212")
        if negative:
            self.take()
        total = -self.product() if negative else self.product()
        while self.peek() in (("mo", "+"), ("mo", "\u2212")):
            total = total + self.product() if self.take()[1] == "+" else total - self.product()
        return total

    def product(self) -> Any:
        total = self.factor()
        while self.peek() == ("mo", TIMES):
            self.take()
            total = total * self.factor()
        return total

    def exponent(self) -> Any:
        if self.peek()[0] != "power":
            return 1
        value = self.inner(self.take()[1])
        return int(value) if isinstance(value, fmpq) else value

    def inner(self, tokens: list[Token]) -> Any:
        return Reader(tokens, self.values, self.number).value()

    def factor(self) -> Any:
        kind, content = self.take()
        if kind == "mi" and content in ("sin", "cos", "ln", "exp", "arctan"):
            power = self.exponent()
            assert self.take() == ("mo", APPLY), "a function is applied"
            argument = self.factor()
            function = {"sin": arb.sin, "cos": arb.cos, "ln": arb.log, "exp": arb.exp, "arctan": arb.atan}[content]
            return function(arb(argument)) ** power
        match kind:
            case "mi":
                found = self.values[content]
            case "mn":
                whole, _, digits = content.partition(".")
                found = self.number(fmpq(int(whole + digits), 10 ** len(digits)))
            case "fraction":
                found = self.inner(content[0]) / self.inner(content[1])
            case "group":
                found = self.inner(content)
            case "root":
                found = arb(self.inner(content)).sqrt()
            case "mo" if content in "([{":
                found = self.sum()
                assert self.take() == ("mo", {"(": ")", "[": "]", "{": "}"}[content]), "brackets close"
            case _:
                raise ValueError(f"{kind} {content!r} where a factor was expected")
        return found ** self.exponent()
