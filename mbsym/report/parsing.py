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
import symtable
from collections.abc import Callable, Container, Iterator
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


#: Fewer letters and digits in a row make no such number, whatever its base.
_LONG_NUMBER = re.compile(rf"\w{{{MOST_BITS // 4}}}")


def _python(text: str) -> None:
    """Compiles; every name is known where it is used; tables of the module have numbers as values."""
    tree = ast.parse(text)
    for node in ast.walk(tree) if _LONG_NUMBER.search(text) else ():
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
            case ast.AnnAssign(target=ast.Name(id=name), annotation=annotation, value=value) if value is not None:
                _known(value, known)
                if not (isinstance(annotation, ast.Name) and annotation.id == "TypeAlias"):
                    _constant(value)
                known.add(name)
            case ast.Assign(targets=targets, value=value):
                _known(value, known)
                _constant(value)
                known |= {target.id for target in targets if isinstance(target, ast.Name)}
    module = symtable.symtable(text, "<module>", "exec")
    known |= {symbol.get_name() for symbol in module.get_symbols() if symbol.is_assigned() or symbol.is_imported()}
    wanted = {symbol.get_name() for symbol in module.get_symbols() if symbol.is_referenced()}
    missing = wanted.union(*map(_taken_from_module, module.get_children())) - known
    if missing:
        _known(tree, {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} - missing)
        raise SyntaxError(f"name '{min(missing)}' is not defined")


def _taken_from_module(scope: symtable.SymbolTable) -> set[str]:
    """The names that a function looks up in the module or among the builtins."""
    if isinstance(scope, symtable.Function):
        found = set(scope.get_globals())
    else:
        found = {symbol.get_name() for symbol in scope.get_symbols() if symbol.is_global() and symbol.is_referenced()}
    return found.union(*map(_taken_from_module, scope.get_children()))


def _known(tree: ast.AST, names: Container[str]) -> None:
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


#: What begins an attribute that is none of ours; what begins like it is looked at more closely.
_FOREIGN = {"on": re.compile(r"on[^\s=<>]*\s*="), "style": re.compile(r"style\s*=")} | {
    name: re.compile(rf"""{name}\s*=\s*(?!["'](?:\#|data:image/))""") for name in _ADDRESSES
}


def _is_suspect(text: str) -> bool:
    """Whether the text of a page has anything that looks like an attribute that is none of ours, or could bring one."""
    if "<!ENTITY" in text or "<!ATTLIST" in text:
        return True
    text = text.lower()
    for name, foreign in _FOREIGN.items():
        place = text.find(name)
        while place >= 0:
            if text[place - 1].isspace() and foreign.match(text, place):
                return True
            place = text.find(name, place + 1)
    return False


def _json(text: str) -> None:
    json.loads(text, parse_constant=_no_number)


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


_READERS: dict[str, Callable[[Any], None]] = {
    "py": _python, "c": c_text, "h": c_text, "wl": _wolfram, "json": _json, "html": _html,
}  # fmt: skip
