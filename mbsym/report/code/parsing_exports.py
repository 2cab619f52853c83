"""Reading exports again: brackets, strings and blocks close, every name is known where it is used, an FMU is whole."""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable, Iterator
from io import BytesIO
from xml.etree import ElementTree

from mbsym.report.code.parsing import balanced, brackets, c_text, printable

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
