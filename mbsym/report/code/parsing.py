"""Reading what was written: whether a generated file would be taken by who reads it.

Nothing of it is executed.  Python is compiled (``python_reading``), JSON is read; the other languages are read as far
as brackets, strings, comments and environments go.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from mbsym.report.code.python_reading import read_python
from mbsym.report.latex.reading import read_latex


def unreadable(filename: str, content: str | bytes) -> str:
    """Why the file would not be taken, or ""."""
    ending = filename.rpartition(".")[2]
    reader = partial(_latex, filename) if ending == "tex" else _READERS.get(ending)
    if reader is None and ending in ("m", "jl", "mo", "fmu"):
        from mbsym.report.code.parsing_exports import READERS

        reader = READERS[ending]
    if reader is None:
        return ""
    try:
        reader(content)
    except (SyntaxError, ValueError, ArithmeticError, RecursionError) as error:
        line = f"line {error.lineno}: " if isinstance(error, SyntaxError) and error.lineno else ""
        return f"{line}{getattr(error, 'msg', None) or error}"
    return ""


# --- languages of brackets --------------------------------------------------------------------------------------------

_PAIRS = {")": "(", "]": "[", "}": "{"}


def balanced(text: str, tokens: Iterator[tuple[int, str]]) -> None:
    """Brackets, given with their places, close in the order in which they opened."""
    opened: list[tuple[int, str]] = []
    for place, token in tokens:
        if token in "([{":
            opened.append((place, token))
        elif not opened or opened.pop()[1] != _PAIRS[token]:
            raise SyntaxError(f"'{token}' closes nothing", ("", line_at(text, place), 0, None))
    if opened:
        place, token = opened[-1]
        raise SyntaxError(f"'{token}' is never closed", ("", line_at(text, place), 0, None))


def brackets(text: str, skipped: re.Pattern[str]) -> Iterator[tuple[int, str]]:
    """Brackets outside what is skipped (strings, comments); what is opened and never closed there is an error."""
    for match in skipped.finditer(text):
        token = match[0]
        if token in "()[]{}":
            yield match.start(), token
        elif match.lastgroup == "open":
            raise SyntaxError(f"{token[:2]!r} is never closed", ("", line_at(text, match.start()), 0, None))


def line_at(text: str, place: int) -> int:
    """The line in which a place is, the first being 1: counted only where something is wrong."""
    return text.count("\n", 0, place) + 1


_C = re.compile(
    r"""/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|(?P<open>/\*|"|')|[()\[\]{}]""", re.DOTALL
)


def c_text(text: str) -> None:
    printable(text)
    balanced(text, brackets(text, _C))


_WOLFRAM = re.compile(r'\\\[[A-Za-z]+\]|\\.|"|\(\*|\*\)|[()\[\]{}]', re.DOTALL)


def _wolfram(text: str) -> None:
    """Comments nest and know no strings; strings know no comments."""
    printable(text)
    balanced(text, _wolfram_brackets(text))


def _wolfram_brackets(text: str) -> Iterator[tuple[int, str]]:
    depth, string = 0, False
    for match in _WOLFRAM.finditer(text):
        token = match[0]
        if depth:
            depth += {"(*": 1, "*)": -1}.get(token, 0)
        elif token == '"':
            string = not string
        elif string:
            continue
        elif token in "()[]{}":
            yield match.start(), token
        elif token == "(*":
            depth = 1
        elif token == "*)":
            raise SyntaxError("'*)' closes nothing", ("", line_at(text, match.start()), 0, None))
    if depth or string:
        what = "(*" if depth else "a string"
        raise SyntaxError(f"{what} is never closed", ("", line_at(text, len(text)), 0, None))


def _latex(filename: str, text: str) -> None:
    printable(text)
    read_latex(filename, text)


def printable(text: str) -> None:
    """No control characters but line ends and tabs."""
    bad = re.search(r"[\x00-\x08\x0b-\x1f\x7f]", text)
    if bad is not None:
        line = text.count("\n", 0, bad.start()) + 1
        raise SyntaxError(f"the control character U+{ord(bad[0]):04X}", ("", line, 0, None))


#: What stands in these is no markup.
_RAW = re.compile(r"(<(script|style)\b[^>]*>)(.*?)(</\2>)", re.DOTALL)


def _html(text: str) -> None:
    """Our pages are well-formed XML besides, and ask for nothing from elsewhere."""
    from xml.parsers import expat

    bare = _RAW.sub(lambda found: found[1] + "\n" * found[3].count("\n") + found[4], text)
    printable(bare)
    reader = expat.ParserCreate()
    if _is_suspect(bare):  # where the text already tells, elements need not be looked at one by one
        reader.StartElementHandler = _own_element
    try:
        reader.Parse(bare, True)
    except expat.ExpatError as error:
        raise SyntaxError(expat.ErrorString(error.code), ("", error.lineno, error.offset, None)) from None


def _own_element(name: str, attributes: dict[str, str]) -> None:
    for written, value in attributes.items():
        key = written.lower()  # browsers tell no capitals
        if key.startswith("on") or key == "style":
            raise SyntaxError(f"the attribute {written} of <{name}> is none of ours")
        if key in _ADDRESSES and not value.startswith(("#", "data:image/")):
            raise SyntaxError(f"<{name}> asks for {value[:60]!r}")


#: Addresses on a page.
_ADDRESSES = ("src", "href", "xlink:href", "action", "formaction", "data", "poster", "srcset", "ping", "background")


#: What begins an attribute that is none of ours, in small letters; what begins like it is looked at more closely.
_FOREIGN = re.compile(
    rf"""\s(?:on[^\s=<>]*\s*=|style\s*=|(?:{"|".join(_ADDRESSES)})\s*=\s*(?!["'](?:\#|data:image/)))"""
)


def _is_suspect(text: str) -> bool:
    """Whether the text of a page has anything that looks like an attribute that is none of ours, or could bring one."""
    return "<!ENTITY" in text or "<!ATTLIST" in text or _FOREIGN.search(text.lower()) is not None


def _json(text: str) -> None:
    json.loads(text, parse_constant=_no_number)


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


_READERS: dict[str, Callable[[Any], None]] = {
    "py": read_python, "c": c_text, "h": c_text, "wl": _wolfram, "json": _json, "html": _html,
}  # fmt: skip
