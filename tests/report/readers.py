"""Readers of generated files: whether who gets one would take it.

Nothing of it is executed.  Python is compiled, JSON is read; the other languages are read as far as brackets, strings,
comments and environments go.  Every file that a test lets a report write is read (``conftest.py``).
"""

from __future__ import annotations

import ast
import builtins
import json
import math
import re
import symtable
import zipfile
from collections.abc import Callable, Container, Iterator
from functools import partial
from io import BytesIO
from itertools import takewhile
from xml.etree import ElementTree


def unreadable(filename: str, content: str | bytes) -> str:
    """Why the file would not be taken, or ""."""
    ending = filename.rpartition(".")[2]
    reader = partial(_latex, filename) if ending == "tex" else READERS.get(ending)
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


def _json(text: str) -> None:
    json.loads(text, parse_constant=_no_number)


def _no_number(word: str) -> float:
    raise ValueError(f"{word} is no number of JSON")


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


# --- LaTeX: brackets and environments close, every command is known, no label is set twice ----------------------------

_LATEX = re.compile(
    r"""\\(?:begin|end)\s*\{[^{}]*\}|\\(?:left|right)(?![a-zA-Z])\s*(?:\\[{}|]|.)|\\verb(?P<mark>[^a-zA-Z]).*?(?P=mark)|\\[^a-zA-Z]|\\[a-zA-Z]+|%[^\n]*|\$\$?|[{}]""",
    re.DOTALL,
)

_GREEK = """alpha beta gamma delta epsilon varepsilon zeta eta theta vartheta iota kappa lambda mu nu xi pi varpi rho
    varrho sigma varsigma tau upsilon phi varphi chi psi omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi
    Omega"""
_MATHEMATICS = """frac tfrac dfrac sqrt sum cdot times pm mp neq ne geq leq ge le to sin cos tan exp ln log arctan sinh
    cosh tanh det max min operatorname text mathrm mathit mathtt mathbf mathsf mathcal mathbb boldsymbol dot ddot hat
    bar tilde vec overline widehat widetilde prime ell hbar partial infty star ast circ dagger nabla bigl bigr Bigl Bigr
    biggl biggr colon quad qquad displaystyle dots ldots cdots leftarrow rightarrow Leftrightarrow in equiv approx sim
    lvert rvert lVert rVert cdotp"""
_WORDS = """textbf textit texttt emph textbackslash textless textgreater textbar mbox item par noindent nopagebreak
    nobreak hfill hfil hskip hbox vspace hspace smallskip medskip bigskip small scriptsize footnotesize normalsize
    raggedright raggedbottom centering clearpage ref eqref label cite section subsection subsubsection paragraph
    addcontentsline caption hline endhead multicolumn arraybackslash columnwidth textwidth verb allowbreak penalty
    begingroup endgroup binoppenalty relpenalty linepenalty lineskiplimit lineskip hangindent hangafter parfillskip
    refstepcounter theequation emergencystretch setlength itemsep par newline toprule midrule bottomrule"""
_PICTURES = "node draw includegraphics parskip"
_DOCUMENT = """documentclass usepackage IfFileExists parindent medmuskip setcounter newcommand renewcommand
    makeatletter makeatother parbox title author date maketitle contentsifneeded tableofcontents bibitem refname
    longformula LARGE
    if ifnum expandafter csname endcsname edef pages pageof newwrite tf immediate openout jobname relax else fi
    detokenize thepage ps let thispagestyle pagestyle"""

_COMMANDS = frozenset(f"{_GREEK} {_MATHEMATICS} {_WORDS} {_PICTURES}".split())
_ONLY_IN_DOCUMENTS = frozenset(_DOCUMENT.split())


def is_part(filename: str) -> bool:
    """Whether the file goes into somebody else's document."""
    return filename.startswith("fragments/") or filename.rpartition("/")[2].startswith("appendix")


def read_latex(filename: str, text: str) -> None:
    """Raises SyntaxError, with the line, where TeX or the document around would not take the text."""
    _commands(text, _COMMANDS if is_part(filename) else _COMMANDS | _ONLY_IN_DOCUMENTS)
    _labels(text)


def _commands(text: str, known: Container[str]) -> None:
    opened: list[tuple[int, str]] = []
    kinds: dict[str, tuple[str, str]] = {}  # a file has few different tokens
    for match in _LATEX.finditer(text):
        token = match[0]
        kind, what = kinds.get(token) or kinds.setdefault(token, _token(token, known))
        if not kind:
            continue
        place = match.start()
        if kind == "unknown":
            raise SyntaxError(f"the command {token!r} is not known", ("", line_at(text, place), 0, None))
        if kind == "opens":
            opened.append((place, what))
        elif kind == "closes":
            if not opened or opened.pop()[1] != what:
                raise SyntaxError(f"{token!r} closes nothing", ("", line_at(text, place), 0, None))
        elif opened and opened[-1][1] == what:
            opened.pop()
        elif kind == "ends" or _in_mathematics(opened):
            raise SyntaxError(f"{token!r} closes nothing", ("", line_at(text, place), 0, None))
        else:
            opened.append((place, token))
    if opened:
        place, what = opened[-1]
        raise SyntaxError(f"{what!r} is never closed", ("", line_at(text, place), 0, None))


def _token(token: str, known: Container[str]) -> tuple[str, str]:
    """What a token does, and to what: nothing, it ``opens`` or ``closes`` a group, ``toggles`` or ``ends`` mathematics.

    Or it is an ``unknown`` command.
    """
    short = token.replace(" ", "") if token.startswith(("\\begin", "\\end")) else token
    name = re.fullmatch(r"\\([a-zA-Z]+)", short)
    if name is not None and name[1] not in known:
        return "unknown", ""
    if short in ("{", "\\begingroup") or short.startswith("\\begin{") or re.match(r"\\left(?![a-zA-Z])", short):
        return "opens", _opener(short)
    if short in ("}", "\\endgroup") or short.startswith("\\end{") or re.match(r"\\right(?![a-zA-Z])", short):
        return "closes", _opener(short)
    if short in ("$", "$$", "\\[", "\\("):
        return "toggles", short
    return ("ends", {"\\]": "\\[", "\\)": "\\("}[short]) if short in ("\\]", "\\)") else ("", "")


def _in_mathematics(opened: list[tuple[int, str]]) -> bool:
    """Whether mathematics has begun since the last brace, in which there may be text with mathematics of its own."""
    since = list(takewhile(lambda item: item[1] != "{", reversed(opened)))
    return any(item in ("$", "$$", "\\[", "\\(") for _, item in since)


def _opener(token: str) -> str:
    if token in "{}":
        return "{"
    if token.startswith(("\\left", "\\right")):
        return "\\left"
    return token.replace("\\end", "\\begin")


_LABEL = re.compile(r"\\(?:(label|ref|eqref)\{([^{}#]*)\}|longformula\[([^\]]*)\])|%[^\n]*")


def _labels(text: str) -> None:
    """Each is set once, and whatever is referred to is there."""
    found: set[str] = set()
    wanted: dict[str, int] = {}  # with the place where it is referred to first
    for match in _LABEL.finditer(text):
        name, place = match[2] or match[3], match.start()
        if name is None:
            continue
        if match[1] in ("ref", "eqref"):
            wanted.setdefault(name, place)
        elif name in found:
            raise SyntaxError(f"the label {name!r} is set a second time", ("", line_at(text, place), 0, None))
        else:
            found.add(name)
    for name, place in wanted.items():
        if name not in found:
            raise SyntaxError(f"nothing has the label {name!r}", ("", line_at(text, place), 0, None))


# --- Python: it compiles, its names are known, the constants of the module can be computed ----------------------------

#: Larger powers are not computed.
_MOST_EXPONENT = 10_000

#: Longer whole numbers than 4300 digits are not read by Python, as it is set by default.
MOST_BITS = 14_284

#: Fewer letters and digits in a row make no such number, whatever its base.
_LONG_NUMBER = re.compile(rf"\w{{{MOST_BITS // 4}}}")


def read_python(text: str) -> None:
    """Compiles; every name is known where it is used; tables of the module have numbers as values.

    Raises SyntaxError, ValueError or ArithmeticError, and says why.
    """
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
        _names_known(tree, {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)} - missing)
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
                _names_known(value, known)
                if not (isinstance(annotation, ast.Name) and annotation.id == "TypeAlias"):
                    _constant(value)
                known.add(name)
            case ast.Assign(targets=targets, value=value):
                _names_known(value, known)
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


def _names_known(tree: ast.AST, names: Container[str]) -> None:
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
    return _figure(node)


def _figure(node: ast.expr) -> float:
    match node:
        case ast.Constant(value=int() | float() as value):
            return float(value)
        case ast.Attribute(value=ast.Name(id="np"), attr="pi"):
            return math.pi
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_figure(operand)
        case ast.BinOp(op=ast.Pow(), left=left, right=right):
            base, exponent = _figure(left), _figure(right)
            if abs(exponent) > _MOST_EXPONENT:
                raise ValueError("a power too large to be computed")
            value = base**exponent
            if isinstance(value, complex):
                raise ValueError("a value that is not real")
            return float(value)
        case ast.BinOp(op=operator, left=left, right=right) if type(operator) in _OPERATIONS:
            return _OPERATIONS[type(operator)](_figure(left), _figure(right))
        case ast.Call(func=ast.Attribute(value=ast.Name(id="np"), attr=name), args=[argument]) if name in _NUMPY:
            return _NUMPY[name](_figure(argument))
    raise SyntaxError(f"no constant: {ast.unparse(node)[:60]}", ("", node.lineno, node.col_offset, None))


_OPERATIONS: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}
_NUMPY: dict[str, Callable[[float], float]] = {
    **{name: getattr(math, name) for name in ("sin", "cos", "tan", "sqrt", "exp", "log", "sinh", "cosh", "tanh")},
    "arctan": math.atan,
}


READERS: dict[str, Callable[..., None]] = {
    "py": read_python, "c": c_text, "h": c_text, "wl": _wolfram, "json": _json, "html": _html,
    "m": octave, "jl": julia, "mo": modelica, "fmu": fmu,
}  # fmt: skip
