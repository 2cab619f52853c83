"""Reading what was written: whether a generated file would be taken by who reads it.

Nothing of it is executed.  Python is compiled, its names are looked up and the constants of the module are computed;
JSON is read; the other languages are read as far as brackets, strings, comments and environments go.
"""

from __future__ import annotations

import ast
import builtins
import json
import math
import re
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from mbsym.report.latex_reading import read_latex

#: Larger powers are not computed.
_MOST_EXPONENT = 10_000


def unreadable(filename: str, content: str | bytes) -> str:
    """Why the file would not be taken, or ""."""
    ending = filename.rpartition(".")[2]
    reader = partial(_latex, filename) if ending == "tex" else _READERS.get(ending)
    if reader is None and ending in ("m", "jl", "mo", "fmu"):
        from mbsym.report.parsing_exports import READERS

        reader = READERS[ending]
    if reader is None:
        return ""
    try:
        reader(content)
    except (SyntaxError, ValueError, ArithmeticError, RecursionError) as error:
        line = f"line {error.lineno}: " if isinstance(error, SyntaxError) and error.lineno else ""
        return f"{line}{getattr(error, 'msg', None) or error}"
    return ""


#: Longer whole numbers than 4300 digits are not read by Python, as it is set by default.
MOST_BITS = 14_284

# --- Python -----------------------------------------------------------------------------------------------------------


def _python(text: str) -> None:
    """Compiles; every name is known where it is used; tables of the module have numbers as values."""
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, int) and node.value.bit_length() > MOST_BITS:
            # Python refuses these unless somebody has lifted its limit in this process.
            raise ValueError("a number with more digits than Python reads")
    compile(tree, "<module>", "exec", dont_inherit=True)
    known = set(dir(builtins)) | {"__name__"}
    for statement in tree.body:
        match statement:
            case ast.Import(names=names) | ast.ImportFrom(names=names):
                known |= {(item.asname or item.name).split(".")[0] for item in names}
            case ast.FunctionDef(name=name):
                known.add(name)
            case ast.Assign(targets=targets, value=value):
                _known(value, known)
                _constant(value)
                known |= {target.id for target in targets if isinstance(target, ast.Name)}
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef):
            _known(statement, known | _bound(statement))


def _bound(function: ast.FunctionDef) -> set[str]:
    arguments = {argument.arg for argument in ast.walk(function) if isinstance(argument, ast.arg)}
    return arguments | {
        node.id for node in ast.walk(function) if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load)
    }


def _known(tree: ast.AST, names: set[str]) -> None:
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id not in names:
            raise SyntaxError(f"name '{node.id}' is not defined", ("", node.lineno, node.col_offset, None))


def _constant(node: ast.expr) -> object:
    """The value of a display of constants: numbers are computed, nothing else is."""
    match node:
        case ast.Constant(value=value):
            return value
        case ast.Tuple(elts=items) | ast.List(elts=items):
            return [_constant(item) for item in items]
        case ast.Dict(values=values):
            return [_constant(item) for item in values]
        case ast.Attribute(value=ast.Name(id="np"), attr="pi"):
            return math.pi
    return _number(node)


def _number(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.Attribute(value=ast.Name(id="np"), attr="pi"):
            return math.pi
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_number(operand)
        case ast.BinOp(op=ast.Pow(), left=left, right=right):
            base, exponent = _number(left), _number(right)
            if abs(exponent) > _MOST_EXPONENT:
                raise ValueError("a power too large to be computed")
            value = base**exponent
            if isinstance(value, complex):
                raise ValueError("a value that is not real")
            return float(value)
        case ast.BinOp(op=operator, left=left, right=right) if type(operator) in _OPERATIONS:
            return _OPERATIONS[type(operator)](_number(left), _number(right))
        case ast.Call(func=ast.Attribute(value=ast.Name(id="np"), attr=name), args=[argument]) if name in _FUNCTIONS:
            return _FUNCTIONS[name](_number(argument))
    raise SyntaxError(f"no constant: {ast.unparse(node)[:60]}", ("", node.lineno, node.col_offset, None))


_OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    **{name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "exp", "log", "sinh", "cosh", "tanh")},
    "arctan": math.atan,
}


# --- languages of brackets --------------------------------------------------------------------------------------------

_PAIRS = {")": "(", "]": "[", "}": "{"}


def balanced(tokens: Iterator[tuple[int, str]]) -> None:
    """Brackets, given with their lines, close in the order in which they opened."""
    opened: list[tuple[int, str]] = []
    for line, token in tokens:
        if token in _PAIRS:
            if not opened or opened[-1][1] != _PAIRS[token]:
                raise SyntaxError(f"'{token}' closes nothing", ("", line, 0, None))
            opened.pop()
        else:
            opened.append((line, token))
    if opened:
        raise SyntaxError(f"'{opened[-1][1]}' is never closed", ("", opened[-1][0], 0, None))


def brackets(text: str, skipped: re.Pattern[str], which: str) -> Iterator[tuple[int, str]]:
    """Brackets outside what is skipped (strings, comments); what is opened and never closed there is an error."""
    line, place = 1, 0
    for match in skipped.finditer(text):
        line += text.count("\n", place, match.start())
        place = match.start()
        if match.lastgroup == "open":
            raise SyntaxError(f"{match[0][:2]!r} is never closed", ("", line, 0, None))
        if match[0] in which:
            yield line, match[0]


_C = re.compile(
    r"""/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|(?P<open>/\*|"|')|[()\[\]{}]""", re.DOTALL
)


def c_text(text: str) -> None:
    printable(text)
    balanced(brackets(text, _C, "()[]{}"))


_WOLFRAM = re.compile(r'\\\[[A-Za-z]+\]|\\.|"|\(\*|\*\)|[()\[\]{}]|\n', re.DOTALL)


def _wolfram(text: str) -> None:
    """Comments nest and know no strings; strings know no comments."""
    printable(text)
    balanced(_wolfram_brackets(text))


def _wolfram_brackets(text: str) -> Iterator[tuple[int, str]]:
    line, depth, string = 1, 0, False
    for match in _WOLFRAM.finditer(text):
        token = match[0]
        line += token.count("\n")
        if depth:
            depth += {"(*": 1, "*)": -1}.get(token, 0)
        elif token == '"':
            string = not string
        elif string:
            continue
        elif token == "(*":
            depth = 1
        elif token == "*)":
            raise SyntaxError("'*)' closes nothing", ("", line, 0, None))
        elif token in "()[]{}":
            yield line, token
    if depth or string:
        raise SyntaxError(f"{'(*' if depth else 'a string'} is never closed", ("", line, 0, None))


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
    reader.StartElementHandler = _own_element
    try:
        reader.Parse(bare, True)
    except expat.ExpatError as error:
        raise SyntaxError(expat.ErrorString(error.code), ("", error.lineno, error.offset, None)) from None


def _own_element(name: str, attributes: dict[str, str]) -> None:
    for key, value in attributes.items():
        if key.startswith("on") or key == "style":
            raise SyntaxError(f"the attribute {key} of <{name}> is none of ours")
        if key in _ADDRESSES and not value.startswith(("#", "data:image/")):
            raise SyntaxError(f"<{name}> asks for {value[:60]!r}")


_ADDRESSES = ("src", "href", "xlink:href", "action", "formaction", "data", "poster", "srcset", "ping", "background")


def _json(text: str) -> None:
    json.loads(text, parse_constant=_no_number)


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


_READERS: dict[str, Callable[[Any], None]] = {
    "py": _python, "c": c_text, "h": c_text, "wl": _wolfram, "json": _json, "html": _html,
}  # fmt: skip
