"""Reading what was written: whether a generated file would be taken by who reads it.

Nothing of it is executed.  Python is compiled (``python_reading``), JSON is read; the other languages are read as far
as brackets, strings, comments and environments go.
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Callable, Iterator
from functools import partial
from io import BytesIO
from typing import Any
from xml.etree import ElementTree

from mbsym.report.code.python_reading import read_python
from mbsym.report.latex.reading import read_latex


def unreadable(filename: str, content: str | bytes) -> str:
    """Why the file would not be taken, or ""."""
    ending = filename.rpartition(".")[2]
    reader = partial(_latex, filename) if ending == "tex" else _READERS.get(ending)
    if reader is None and ending in ("m", "jl", "mo", "fmu"):
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


# Reading exports again: brackets, strings and blocks close, every name is known where it is used, an FMU is whole.


_STRING = r'"(?:\\.|[^"\\\n])*"'
_OCTAVE = re.compile(rf"%[^\n]*|(?<![\w)\]}}'.])'(?:''|[^'\n])*'|{_STRING}|(?P<open>\"|(?<![\w)\]}}'.])')|[()\[\]{{}}]")
_JULIA = re.compile(rf"#[^\n]*|{_STRING}|(?P<open>\")|[()\[\]{{}}]")
_MODELICA = re.compile(rf"//[^\n]*|{_STRING}|(?P<open>\")|[()\[\]{{}}]")
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*")
_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d*)?(?:[eE][-+]?\d+)?")

_FUNCTIONS = frozenset({"sin", "cos", "tan", "sqrt", "exp", "log", "atan", "sinh", "cosh", "tanh", "abs", "sign"})
_OCTAVE_WORDS = _FUNCTIONS | frozenset(
    """
    function end for if names numel zeros NaN strcmp isfield fieldnames error any isnan strjoin struct given values
    parameter_names
    """.split()  # noqa: SIM905
)
_JULIA_WORDS = _FUNCTIONS | frozenset(
    "function end return for zeros promote_type typeof eltype Float64 float vcat error parameters".split()  # noqa: SIM905
)


def octave(text: str) -> None:
    """Functions of MATLAB."""
    printable(text)
    balanced(text, brackets(text, _OCTAVE))
    _bodies(_plain(text, _OCTAVE), re.compile(r"^function\b.*\n"), _OCTAVE_WORDS)


def julia(text: str) -> None:
    """A module of Julia."""
    printable(text)
    balanced(text, brackets(text, _JULIA))
    plain = _plain(text, _JULIA)
    if not re.search(r"^module \w+$", plain, re.MULTILINE) or plain.rstrip()[-4:] != "\nend":
        raise SyntaxError("the module is not whole", ("", 1, 0, None))
    _bodies(plain.rstrip()[:-3], re.compile(r"^function\b(?:[^(\n]*\(;[^)]*\n\)\n|.*\n)"), _JULIA_WORDS)


def modelica(text: str) -> None:
    """A flat model of Modelica: every variable is declared, once, and has one equation."""
    printable(text)
    balanced(text, brackets(text, _MODELICA))
    plain = _plain(text, _MODELICA)
    found = re.fullmatch(r"model (\w+)[^\n]*\n(.*)\nequation\n(.*)end \1;\n", plain, re.DOTALL)
    if found is None:
        raise SyntaxError("the model is not whole", ("", 1, 0, None))
    declared = re.findall(r"^  (?:parameter |input )?Real (\w+)", found[2], re.MULTILINE)
    if len(set(declared)) < len(declared):
        raise SyntaxError("a name is declared twice", ("", 1, 0, None))
    known = {*declared, "time", "der", "noEvent", *_FUNCTIONS}
    first = plain.count("\n", 0, found.start(3)) + 1
    for number, line in enumerate(found[3].split("\n"), first):
        _known(line, known, number)
    variables = [name for name, size in re.findall(r"^  Real (\w+)(\[3\])?", found[2], re.MULTILINE)]
    left = set(re.findall(r"^  (?:der\()?(\w+)(?:\)|\[\d\])? = ", found[3], re.MULTILINE))
    if found[3].strip() and set(variables) - left:
        raise SyntaxError(f"no equation for {min(set(variables) - left)}", ("", first, 0, None))


def fmu(content: bytes) -> None:
    """An archive whose model description is XML and names the sources that are there."""
    try:
        archive = zipfile.ZipFile(BytesIO(content))
    except zipfile.BadZipFile as error:
        raise ValueError(str(error)) from None
    with archive:
        if archive.testzip() is not None:
            raise ValueError("a damaged archive")
        try:
            root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        except (KeyError, ElementTree.ParseError) as error:
            raise ValueError(f"modelDescription.xml: {error}") from None
        references = [int(item.get("valueReference", "-1")) for item in root.iter() if item.get("causality")]
        if references != list(range(len(references))) or not references:
            raise ValueError("value references are no numbers in order")
        for name in archive.namelist():
            if name.endswith((".c", ".h")):
                c_text(archive.read(name).decode())


def _plain(text: str, skipped: re.Pattern[str]) -> str:
    """Without comments and the insides of strings, line by line as it was."""
    return skipped.sub(lambda match: match[0] if match[0] in "()[]{}" else "", text)


def _bodies(text: str, head: re.Pattern[str], words: frozenset[str]) -> None:
    """Functions that begin and end on lines of their own: each name in them is an argument, assigned, or a word."""
    declared = set(re.findall(r"^function (?:\w+ = )?(\w+)\(", text, re.MULTILINE))
    line = 1
    inside: set[str] | None = None
    while text:
        found = head.match(text)
        if found is not None:
            if inside is not None:
                raise SyntaxError("a function is never ended", ("", line, 0, None))
            inside = {*words, *declared, *_NAME.findall(found[0])}
            piece = found[0]
        else:
            piece, newline, _ = text.partition("\n")
            piece += newline
            if piece.rstrip() == "end":
                if inside is None:
                    raise SyntaxError("'end' ends nothing", ("", line, 0, None))
                inside = None
            elif inside is not None:
                for name in _assigned(piece):
                    inside.add(name)
                _known(piece, inside, line)
        line += piece.count("\n")
        text = text[len(piece) :]
    if inside is not None:
        raise SyntaxError("a function is never ended", ("", line, 0, None))


def _assigned(line: str) -> Iterator[str]:
    found = re.match(r"\s*(?:for )?([A-Za-z_]\w*)(?:[.(\[{][^=]*)? = ", line)
    if found is not None and found[1] not in _FUNCTIONS:
        # What is assigned may not be used on the line that assigns it.
        name = found[1]
        if re.search(rf"(?<![\w.]){name}(?!\w)", line[found.end() :]):
            return
        yield name


def _known(line: str, known: set[str], number: int) -> None:
    for match in _NAME.finditer(_NUMBER.sub("0", line)):
        if match[0] not in known:
            raise SyntaxError(f"name '{match[0]}' is not defined", ("", number, 0, None))


READERS: dict[str, Callable[..., None]] = {"m": octave, "jl": julia, "mo": modelica, "fmu": fmu}
