"""Reading Python that was written: it compiles, its names are known, the constants of the module can be computed.

Nothing of it is executed.  Functions are most of such a file, and what is asked of them needs no syntax tree: the
compiled code tells which names they take from elsewhere.  Where this is not enough to be sure, all of it is looked at.
"""

from __future__ import annotations

import ast
import builtins
import math
import opcode
import re
from collections.abc import Callable, Container, Iterable, Iterator
from types import CodeType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import symtable

#: Larger powers are not computed.
_MOST_EXPONENT = 10_000

#: Longer whole numbers than 4300 digits are not read by Python, as it is set by default.
MOST_BITS = 14_284

#: Fewer letters and digits in a row make no such number, whatever its base.
_LONG_NUMBER = re.compile(rf"\w{{{MOST_BITS // 4}}}")


#: A function of the module, up to its colon; whatever is indented or closes a bracket after that is its body.
_FUNCTION = re.compile(r"^(def \w+\([^#\"'\\]*?\)(?: ->[^:\n]*)?:)\n((?:[ )].*\n|\n)*)", re.MULTILINE)

#: The annotation of a local variable, which no code is made of.
_LOCAL = re.compile(r"^ +(\w+: [\w.|, \[\]]+?)(?: = .*)?$", re.MULTILINE)

_GLOBAL, _PLAIN, _STORED, _EXTENDED = (
    opcode.opmap[name] for name in ("LOAD_GLOBAL", "LOAD_NAME", "STORE_NAME", "EXTENDED_ARG")
)


def read_python(text: str) -> None:
    """Compiles; every name is known where it is used; tables of the module have numbers as values.

    Raises SyntaxError, ValueError or ArithmeticError, and says why.
    """
    if not _surely_sound(text):
        _looked_through(text)


def _surely_sound(text: str) -> bool:
    """Whether the file is plainly as it has to be: False where that takes a closer look."""
    if _LONG_NUMBER.search(text) or "__annotations__" in text:
        return False
    try:
        code = compile(text, "<module>", "exec", dont_inherit=True)
        tree = ast.parse(_FUNCTION.sub(_without_body, text))
        known = _statements_read(tree)
    except (SyntaxError, ValueError, ArithmeticError, RecursionError):
        return False
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    if len(functions) != sum(isinstance(x, CodeType) for x in code.co_consts):
        return False
    known |= {code.co_names[place] for place in _arguments(code, _STORED)}
    known.add("__annotations__")  # the code of an annotation asks for it
    return _annotations(functions).union(_looked_up(code)) <= known


def _without_body(function: re.Match[str]) -> str:
    return "\n    ".join([function[1], *(found[1] for found in _LOCAL.finditer(function[2])), "...\n"])


def _annotations(functions: Iterable[ast.FunctionDef]) -> set[str]:
    """The names in signatures and in annotations of local variables."""
    found = (node for function in functions for node in ast.walk(function))
    return {node.id for node in found if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}


def _looked_up(code: CodeType) -> Iterator[str]:
    """The names that some code, and what is defined in it, takes from the module or among the builtins."""
    for place in _arguments(code, _GLOBAL):
        yield code.co_names[place >> 1]
    for place in _arguments(code, _PLAIN):
        yield code.co_names[place]
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _looked_up(inner)


def _arguments(code: CodeType, operation: int) -> Iterator[int]:
    """The argument of each such operation of some bytecode."""
    operations, arguments = code.co_code[::2], code.co_code[1::2]
    at = operations.find(operation)
    while at >= 0:
        argument, count = arguments[at], 1
        while at >= count and operations[at - count] == _EXTENDED:
            argument += arguments[at - count] << 8 * count
            count += 1
        yield argument
        at = operations.find(operation, at + 1)


def _looked_through(text: str) -> None:
    import symtable  # hardly ever needed

    tree = ast.parse(text)
    for node in ast.walk(tree) if _LONG_NUMBER.search(text) else ():
        if isinstance(node, ast.Constant) and isinstance(node.value, int) and node.value.bit_length() > MOST_BITS:
            # Python refuses these unless somebody has lifted its limit in this process.
            raise ValueError("a number with more digits than Python reads")
    compile(tree, "<module>", "exec", dont_inherit=True)
    known = _statements_read(tree)
    module = symtable.symtable(text, "<module>", "exec")
    known |= {symbol.get_name() for symbol in module.get_symbols() if symbol.is_assigned() or symbol.is_imported()}
    wanted = {symbol.get_name() for symbol in module.get_symbols() if symbol.is_referenced()}
    missing = wanted.union(*map(_taken_from_module, module.get_children())) - known
    if missing:
        _known(tree, {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} - missing)
        raise SyntaxError(f"name '{min(missing)}' is not defined")


def _statements_read(tree: ast.Module) -> set[str]:
    """The names that the module's own statements define, each of which uses only earlier ones."""
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
    return known


def _taken_from_module(scope: symtable.SymbolTable) -> set[str]:
    """The names that a function looks up in the module or among the builtins."""
    if scope.get_type() == "function":
        found = set(scope.get_globals())  # type: ignore[attr-defined]
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
        case ast.Call(func=ast.Attribute(value=ast.Name(id="np"), attr="array"), args=[items], keywords=[]):
            return _constant(items)
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
