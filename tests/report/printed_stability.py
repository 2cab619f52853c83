"""Readers of what terminal, LaTeX, HTML, JSON and Wolfram print of problems 4 to 6: each knows its own text alone.

They give the same shape of every surface: equations, matrices, and per subsystem the characteristic polynomial, the
conditions with the letters defined beside them, and the cases.  A formula is a function of a look-up of symbols; how
symbols are written is the surface's own affair.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any
from xml.etree import ElementTree as ET

import terminal
import tex_reader
from flint import arb, fmpq
from flint.utils.flint_exceptions import DomainError
from mathml_reader import Reader as MathReader
from mathml_reader import Token, tokens_of, tree

from mbsym.problems.stability.words import Word

#: The value of a formula, given that of each symbol in it, as the surface writes them.
Value = Callable[[Mapping[str, Any]], Any]


class TwoMeanings(AssertionError):
    """A symbol that stands for two things in one formula."""


@dataclass
class Line:
    """``label: formula relation 0``; None where it is not printed; ``under``: the label that is referred to.

    A formula alone has no label; a letter alone refers to what was shown as that, or is the formula.
    """

    label: str
    formula: Value | None
    relation: str
    under: str = ""
    letters: dict[str, Value] = field(default_factory=dict)
    #: The label as a symbol of the surface; "" where it is told in words.
    symbol: str = ""
    #: The formula, where it is nothing but a symbol: that of a label before, or of a parameter.
    alone: str = ""


@dataclass
class Case:
    word: str
    all_of: list[Line] = field(default_factory=list)
    any_of: list[Line] = field(default_factory=list)


@dataclass
class Part:
    polynomial: Value | None = None
    factors: list[tuple[Value, int]] = field(default_factory=list)
    lines: list[Line] = field(default_factory=list)
    cases: list[Case] = field(default_factory=list)


RELATIONS: dict[str, Callable[[Any], bool]] = {
    ">": lambda x: bool(x > 0),
    "<": lambda x: bool(x < 0),
    ">=": lambda x: bool(x >= 0),
    "<=": lambda x: bool(x <= 0),
    "!=": lambda x: bool(x != 0),
}


def truth(value: Any, relation: str) -> bool | None:
    """Whether ``value relation 0``; None where a ball does not tell."""
    if isinstance(value, arb) and not value.is_zero() and value.contains(0):
        return None
    return RELATIONS[relation](value)


class Symbols(dict[str, Any]):
    """Values of names as they are printed, then of letters: no symbol may be both."""

    def __init__(self, names: Mapping[str, Any], letters: Mapping[str, Value]) -> None:
        super().__init__(names)
        self.letters = letters

    def __missing__(self, symbol: str) -> Any:
        if symbol not in self.letters:
            raise NameError(f"{symbol} is not defined where it is printed")
        self[symbol] = self.letters[symbol](Symbols({k: v for k, v in self.items() if k not in self.letters}, {}))
        return self[symbol]


class WithVariable(dict[str, Any]):
    """Names, and a value for the one symbol that is none."""

    def __init__(self, names: Mapping[str, Any], value: Any) -> None:
        super().__init__(names)
        self.value = value

    def __missing__(self, symbol: str) -> Any:
        self[symbol] = self.value
        self.value = None  # a second unknown symbol has none
        return self[symbol]


@dataclass
class Read:
    """A part as somebody reads it at one point, from top to bottom."""

    names: Mapping[str, Any]
    part: Part
    shown: dict[str, Value | None] = field(default_factory=dict)  # by label; None of what is counted only
    letters: dict[str, Value] = field(default_factory=dict)  # labels that are symbols

    def value(self, line: Line) -> Any:
        """The value of a line; None where it is not printed."""
        refers = bool(line.under) and (line.under in self.shown or line.formula is None)
        if refers:
            if line.under not in self.shown:
                raise NameError(f"{line.under} is referred to, but not shown before")
            value = self.shown[line.under]
        else:
            value = line.formula
        if line.symbol:
            if line.symbol in self.names and (value is None or self.names[line.symbol] != value(self.names)):
                raise TwoMeanings(line.symbol)
            if value is not None and line.alone not in self.letters:  # v0: v4 < 0 says nothing of the size of v0
                self.letters[line.symbol] = value
        own = dict(line.letters)
        for symbol, meaning in own.items():
            if symbol in self.names and self.names[symbol] != meaning(Symbols(self.names, {})):
                raise TwoMeanings(symbol)
            if symbol in self.letters:
                plain = Symbols(self.names, {})
                if meaning(plain) - self.letters[symbol](plain) != 0:
                    raise TwoMeanings(symbol)
        if value is None:
            self.shown.setdefault(line.label, None)
            return None
        if not refers:
            letters = {**self.letters, **own}
            told = value
            value = lambda names: told(Symbols(names, letters))  # noqa: E731
            self.shown.setdefault(line.label, value)
            if line.label.startswith("-"):
                opposite = value
                self.shown.setdefault(_unsigned(line.label), lambda names: -opposite(names))
        return value(self.names)

    def truth(self, line: Line) -> bool | None:
        value = self.value(line)
        return None if value is None else truth(value, line.relation)

    def case(self, one: Case) -> bool | None:
        every = [self.truth(x) for x in one.all_of]
        some = [self.truth(x) for x in one.any_of]
        return both(every, some)


def _unsigned(label: str) -> str:
    return label[1:].removeprefix("(").removesuffix(")") if label.startswith("-(") else label[1:]


def both(every: list[bool | None], some: list[bool | None]) -> bool | None:
    """All of these, and one of those unless there are none, where some are unknown."""
    if False in every or (some and all(x is False for x in some)):
        return False
    return None if None in every or (some and True not in some) else True


def without_colon(label: str, formula: Callable[[], Value], relation: str) -> Line:
    """What is said of a label that was shown, or of a formula; of a letter either."""
    if re.search(r" of |, |minor|disc|condition ", label):
        return Line(label, None, relation, under=label)
    return Line(label, formula(), relation, under=label) if LABEL.fullmatch(label) else Line("", formula(), relation)


#: A label that is a letter.
LABEL = re.compile(r"-?[av]\d+")


def bare(label: str) -> str:
    """The name of the requirement in a label: ``v4`` of ``condition v4, squared factor`` and of ``-(v4, ...)``."""
    minus, words = ("-", label[1:].removeprefix("(").removesuffix(")")) if label.startswith("-") else ("", label)
    words = words.removeprefix("condition ").removeprefix("(condition ")
    words = re.sub(r", (squared factor( \d+)?|without squares)\)?$", "", words)
    return f"-({words})" if minus else words


# --- Python syntax: terminal and JSON -----------------------------------------------------------------------------


def python(text: str) -> Value:
    """Whole numbers stay exact, those of exponents plain."""
    exact = re.sub(r"(?<![\w.])(?<!\*\*)(\d+)(?![\w.])", r"N(\1)", text)
    code = compile(exact.strip(), "printed", "eval")
    functions = {"N": fmpq, "__builtins__": {}} | {
        name: (lambda x, name=name: getattr(arb(x), name)()) for name in ("sin", "cos", "sqrt", "exp", "log", "atan")
    }

    class Names(dict[str, Any]):
        def __missing__(self, key: str) -> Any:
            return functions[key] if key in functions else self.symbols[key]  # type: ignore[attr-defined]

    def value(symbols: Mapping[str, Any]) -> Any:
        names = Names()
        names.symbols = symbols  # type: ignore[attr-defined]
        return eval(code, {"__builtins__": {}}, names)

    return value


def of_terminal(text: str) -> list[Part]:
    parts: list[Part] = []
    state = ""
    for line in text.partition("Problem 6.")[2].splitlines():
        words = line.strip()
        if not line.startswith("  "):
            state = _terminal_state(words, parts, state)
        elif state == "polynomial":
            parts[-1].polynomial = readable(words.partition(" = ")[2])
            state = "told"
        elif state == "factors":
            whole = words.partition(": ")[2]
            raised = re.fullmatch(r"\((.*)\)\^(\d+)", whole)
            parts[-1].factors.append((readable(raised[1]), int(raised[2])) if raised else (readable(whole), 1))
        elif state not in ("", "told"):
            into = _latex_lines(parts[-1], state)
            letter = re.fullmatch(r"([av]\d+) = ([^<>!]*)", words)
            if letter is not None:
                into[-1].letters[letter[1]] = readable(letter[2])
            else:
                into.append(_terminal_line(words))
    return parts


def _terminal_state(words: str, parts: list[Part], state: str) -> str:
    """What follows a line that is no formula."""
    if words.startswith("The characteristic polynomial"):
        parts.append(Part())
        return "polynomial"
    if words.startswith("Number of its factors"):
        return "factors"
    if words.startswith("Conditions ("):
        return "lines"
    if words in ("and:", "and at least one of these holds:"):
        return "any"
    if words == "with:":
        return state
    case = re.fullmatch(r"(?:Otherwise )?(.*?)(?: \([^()]*\))?(?:, (if.*))?:", words)
    if case is not None and parts and case[1] in [*Word]:
        parts[-1].cases.append(Case(case[1]))
        return "any" if "at least one" in (case[2] or "") else "all"
    return ""


def _terminal_line(words: str) -> Line:
    match = re.fullmatch(r"(.*?) (>|<|!=|>=|<=) 0(?: \(.*\))?", words)
    assert match is not None, words
    relation = match[2]
    label, colon, formula = match[1].partition(": ")
    symbol = _terminal_label(label)
    if not colon:  # label = formula > 0 (never holds), a reference, or what is not written
        never = re.fullmatch(r"(.*?) = (.*)", label)
        if never is not None:
            return Line(_terminal_label(never[1]), readable(never[2]), relation)
        return without_colon(symbol, lambda: readable(label), relation)
    if formula.startswith("["):
        return Line(symbol, None, relation)
    if re.fullmatch(r"-?[av]\d+\^\(\d+\)", formula) or re.search(r" of |, |minor|subdisc|condition ", formula):
        return Line(symbol, None, relation, under=_terminal_label(formula))
    return Line(
        symbol, readable(formula), relation, symbol=label if re.fullmatch(r"[av]\d+", label) else "", alone=formula
    )


def _terminal_label(label: str) -> str:
    return re.sub(r"([av]\d+)\^\((\d+)\)", r"\1 of factor \2", label)


def readable(text: str) -> Value:
    """As people write it: products without a sign, powers with ^."""
    return python(re.sub(r"\blambda\b", "lambda_", terminal.python(text)))


def of_json(text: str) -> list[Part]:
    parts = []
    for found in json.loads(text)["stability"]["subsystems"]:
        powers = [python(x) for x in found["characteristic_polynomial"]]
        variable = found["variable"]

        def polynomial(symbols: Any, powers: list[Value] = powers, variable: str = variable) -> Any:
            return sum((x(symbols) * symbols[variable] ** k for k, x in enumerate(powers)), fmpq(0))

        part = Part(polynomial)
        for item in found["conditions"]:
            formula = item["formula"] and python(item["formula"])
            part.lines.append(Line(item["label"], formula, item["relation"]))
            if "in_coefficients" in item:
                form = item["in_coefficients"]
                letters = {name: python(x) for name, x in form["coefficients"].items()}
                part.lines.append(Line(item["label"], python(form["formula"]), item["relation"], letters=letters))
        for case in found["cases"]:
            part.cases.append(
                Case(case["verdict"], [_json_line(x) for x in case["all_of"]], [_json_line(x) for x in case["any_of"]])
            )
        parts.append(part)
    return parts


def _json_line(item: dict[str, Any]) -> Line:
    if "listed" in item:
        return Line(item["listed"], None, item["relation"], under=item["listed"])
    return Line(item["label"], item["formula"] and python(item["formula"]), item["relation"])


# --- LaTeX --------------------------------------------------------------------------------------------------------


def of_latex(text: str) -> list[Part]:
    section = text.partition("{Problem 6. Stability}")[2].partition("\\section*{")[0]
    parts: list[Part] = []
    state = ""
    for kind, content in _latex_pieces(section):
        if kind == "words":
            for word in re.finditer(
                r"\\subsection\*?\{|The characteristic polynomial|Number of its factors|Conditions \(|"
                r"(?:Otherwise )?\\textbf\{([^{}]*)\}([^\n]*?):$|and(?: at least one of these holds)?:$|Verdict|"
                r"with: ((?:\$\\displaystyle\s[^$]*\$(?:;\s)?)+)",
                content,
                re.MULTILINE,
            ):
                said = word[0]
                if said.startswith("\\subsection"):
                    parts.append(Part())
                elif said.startswith("The"):
                    state = "polynomial"
                elif said.startswith("Number"):
                    state = "factors"
                elif said.startswith("Conditions"):
                    state = "lines"
                elif said.startswith("and"):
                    state = "any"
                elif said == "Verdict":
                    state = ""
                elif said.startswith("with"):
                    for one in re.findall(r"\$\\displaystyle\s([^$]*)\$", word[3]):
                        letter, _, value = " ".join(one.split()).partition(" = ")
                        _latex_lines(parts[-1], state)[-1].letters[letter.strip()] = latex(value)
                elif parts and state:
                    parts[-1].cases.append(Case(word[1]))
                    state = "any" if "at least one" in word[2] else "all"
            continue
        if state == "polynomial":
            parts[-1].polynomial = latex(content.partition(" = ")[2])
            state = "told"
        elif state == "factors":
            _, _, right = content.partition(r"\colon\quad ")
            raised = re.fullmatch(r"\\bigl\[(.*)\\bigr\]\^\{(\d+)\}", right.strip(), re.DOTALL)
            whole, times = (raised[1], int(raised[2])) if raised else (right, 1)
            parts[-1].factors.append((latex(whole), times))
        elif state not in ("", "told"):
            _latex_lines(parts[-1], state).append(_latex_line(content))
    return parts


def _latex_lines(part: Part, state: str) -> list[Line]:
    return part.lines if state == "lines" else part.cases[-1].all_of if state == "all" else part.cases[-1].any_of


def _latex_pieces(section: str) -> Iterator[tuple[str, str]]:
    place = 0
    for match in re.finditer(r"\\longformula(\[[^\]]*\])?\{", section):
        yield "words", section[place : match.start()]
        place, depth = match.end(), 1
        while depth:
            depth += {"{": 1, "}": -1}.get(section[place], 0)
            place += 1
        yield "formula", " ".join(section[match.end() : place - 1].split())
    yield "words", section[place:]


def _latex_line(content: str) -> Line:
    content = re.sub(r" \\quad\\penalty0 \\text\{\(.*\)\}$", "", content)
    match = re.fullmatch(r"(.*) (>|<|\\neq|\\geq|\\leq) 0", content)
    assert match is not None, content
    relation = {r"\neq": "!=", r"\geq": ">=", r"\leq": "<="}.get(match[2], match[2])
    label, colon, formula = match[1].partition(r" \colon\quad ")
    symbol = _latex_label(label)
    if not colon:  # label = formula > 0 (never holds), a reference, or what is not written
        never = re.fullmatch(r"(.*?) = (.*)", label)
        if never is not None:
            return Line(_latex_label(never[1]), latex(never[2]), relation)
        return without_colon(symbol, lambda: latex(label), relation)
    if "terms, of degree" in formula:
        return Line(symbol, None, relation)
    if r"\text" in formula or "^{(" in formula:  # a label in words, or with a number above: no formula
        return Line(symbol, None, relation, under=_latex_label(formula))
    shown = label if re.fullmatch(r"[av]_\{\d+\}", label) else ""
    return Line(symbol, latex(formula), relation, symbol=shown, alone=formula)


def _latex_label(label: str) -> str:
    words = re.sub(r" ?\\text\{([^{}]*)\}", r"\1", label.strip())
    words = re.sub(r"([av])_\{(\d+)\}\^\{\((\d+)\)\}", r"\1\2 of factor \3", words)
    return re.sub(r"([av])_\{(\d+)\}", r"\1\2", words)


def latex(text: str) -> Value:
    plain = re.sub(r"\\mathrm\{pi\}", r"\\pi", text)

    def value(symbols: Mapping[str, Any]) -> Any:
        try:
            return tex_reader.read(plain, symbols, fmpq)
        except DomainError:  # the root of 3
            return tex_reader.read(plain, symbols, arb)

    return value


# --- HTML ---------------------------------------------------------------------------------------------------------


def of_html(page: str) -> list[Part]:
    (section,) = [x for x in tree(page).iter("section") if x.get("id") == "problem-6"]
    parts: list[Part] = []
    state = ""
    for node in section.iter():
        if node.tag == "h3":
            if "At the given values" in "".join(node.itertext()):
                break
            parts.append(Part())
        elif node.tag == "p" and parts:
            words = " ".join("".join(node.itertext()).split())
            strong = node.find("strong")
            if words.startswith("The characteristic polynomial"):
                state = "polynomial"
            elif words.startswith("Number of its factors"):
                state = "factors"
            elif words.startswith("Conditions ("):
                state = "lines"
            elif words.startswith("Verdict"):
                state = ""
            elif words in ("and:", "and at least one of these holds:"):
                state = "any"
            elif strong is not None and words.endswith(":"):
                parts[-1].cases.append(Case(strong.text or ""))
                state = "any" if "at least one" in words else "all"
        elif node.tag == "div" and node.get("class") == "formula" and parts and state:
            _html_line(parts[-1], state, [x for part in node.iter("math") for x in tokens_of(part)])
    return parts


def _html_line(part: Part, state: str, tokens: list[Token]) -> None:
    colon = next((k for k, x in enumerate(tokens) if x == ("mo", ":")), None)
    equals = next((k for k, x in enumerate(tokens) if x == ("mo", "=")), None)
    if state == "polynomial":
        assert equals is not None
        part.polynomial = mathml(tokens[equals + 1 :])
        return
    if state == "factors":
        assert colon is not None
        whole, times = tokens[colon + 1 :], 1
        if whole[0] == ("mo", "[") and whole[-1][0] == "power" and whole[-2] == ("mo", "]"):
            whole, times = whole[1:-2], int(str(whole[-1][1][0][1]))
        part.factors.append((mathml(whole), times))
        return
    into = part.lines if state == "lines" else part.cases[-1].all_of if state == "all" else part.cases[-1].any_of
    relation = {"\u2260": "!=", "\u2265": ">=", "\u2264": "<="}.get(str(tokens[-2][1]), str(tokens[-2][1]))
    stands = tokens[-1] == ("mn", "0") and relation in RELATIONS
    if not stands:  # a letter of the condition above
        assert equals is not None
        letter = "".join(str(x) for _, x in tokens[:equals])
        into[-1].letters[letter] = mathml(tokens[equals + 1 :])
        return
    body = tokens[:-2]
    if colon is None and equals is not None:
        into.append(Line(_html_label(body[:equals]), mathml(body[equals + 1 :]), relation))
    elif colon is None:
        words = any(kind == "mtext" for kind, _ in body) or any(
            kind == "power" and ("mo", "(") in x for kind, x in body
        )
        into.append(without_colon(_html_label(body) if words or len(body) < 3 else "", lambda: mathml(body), relation))
    else:
        label, formula = body[:colon], body[colon + 1 :]
        written = [x for x in formula if x[0] == "mtext"]
        if any("terms, of degree" in str(x[1]) for x in written):
            into.append(Line(_html_label(label), None, relation))
        elif written or any(kind == "power" and ("mo", "(") in x for kind, x in formula):
            into.append(Line(_html_label(label), None, relation, under=_html_label(formula)))
        else:
            symbol = str(label[0][1]) if len(label) == 1 and label[0][0] == "mi" else ""
            alone = str(formula[0][1]) if len(formula) == 1 and formula[0][0] == "mi" else ""
            into.append(Line(_html_label(label), mathml(formula), relation, symbol=symbol, alone=alone))


def _html_label(tokens: list[Token]) -> str:
    written = ""
    for kind, content in tokens:
        if kind == "power":
            written += " of factor " + "".join(str(x) for _, x in content if x not in "()")
        elif kind == "mo":
            written += "-" if content == "\u2212" else str(content)
        else:
            written += re.sub(r"^([av])_(\d+)$", r"\1\2", str(content)) if kind == "mi" else str(content)
    return written


def mathml(tokens: list[Token]) -> Value:
    return lambda symbols: MathReader(tokens, symbols, fmpq).value()


# --- Wolfram ------------------------------------------------------------------------------------------------------


def of_wolfram(text: str) -> list[Part]:
    """The parts; their lines have no labels."""
    found = re.search(
        r"characteristicPolynomials = \{\n(.*?)\n\};\nstabilityConditions = \{\n(.*?)\n\};", text, re.DOTALL
    )
    assert found is not None
    parts = []
    for polynomial, conditions in zip(found[1].split(",\n"), found[2].split("},\n  {"), strict=True):
        part = Part(wolfram(polynomial))
        for one in conditions.strip().removeprefix("{").removesuffix("}").split(",\n   "):
            match = re.fullmatch(r"(.*) (>|<|>=|<=|!=) 0", one.strip())
            if one.strip():  # a string says why there is no formula
                part.lines.append(Line("", wolfram(match[1]), match[2]) if match else Line("", None, ">"))
        parts.append(part)
    return parts


def wolfram_symbol(name: str) -> str:
    return re.sub(r"\\\[(\w+)\]", r"greek\1", name)


def wolfram(text: str) -> Value:
    plain = wolfram_symbol(text).replace("^", "**")
    for theirs, ours in (("ArcTan", "atan"), *((x.capitalize(), x) for x in ("sin", "cos", "sqrt", "exp", "log"))):
        plain = re.sub(rf"\b{theirs}\[", f"{ours}[", plain)
    return python(plain.replace("[", "(").replace("]", ")"))


def mathml_symbol(markup: str) -> str:
    """How the reader calls a symbol that is written so."""
    ((_, name),) = tokens_of(ET.fromstring(f"<math>{markup}</math>"))
    return str(name)


# --- problem 4 ----------------------------------------------------------------------------------------------------


def equations(surface: str, text: str) -> list[Value | None]:
    """The left-hand sides of ``... = 0``; None of what is counted only."""
    match surface:
        case "terminal":
            section = text.partition("Problem 4.")[2].partition("Problem 5.")[0].partition("if and only if")[2]
            lines = section.partition("which problems")[0].splitlines()[1:]
            assert all(x.endswith(" = 0") for x in lines if x.startswith("  "))
            return [None if x.startswith("  [") else readable(x[2:-4]) for x in lines if x.startswith("  ")]
        case "json":
            return [python(x) for x in json.loads(text)["equilibrium"]["conditions"]]
        case "wolfram":
            listed = re.search(r"^equilibriumConditions = \{(.*?)\};", text, re.MULTILINE | re.DOTALL)
            assert listed is not None
            return [wolfram(x) for x in re.split(r",\s+", listed[1]) if x.strip()]
        case "latex":
            section = text.partition("{Problem 4. The unperturbed motion}")[2].partition("\\section*{")[0]
            section = section.partition("if and only if")[2].partition("which problems")[0]
            formulas = [x for kind, x in _latex_pieces(section) if kind == "formula"]
            return [latex(x.removesuffix(" = 0")) for x in formulas]
    (section_4,) = [x for x in tree(text).iter("section") if x.get("id") == "problem-4"]
    lines_4: list[list[Token]] = []
    begun = False
    for node in section_4.iter():
        begun = begun or (node.tag == "p" and "if and only if" in "".join(node.itertext()))
        if node.tag == "p" and "use in the form" in "".join(node.itertext()):
            break
        if begun and node.tag == "div" and node.get("class") == "formula":
            lines_4.append([x for part in node.iter("math") for x in tokens_of(part)])
    assert all(x[-2:] == [("mo", "="), ("mn", "0")] for x in lines_4)
    return [mathml(x[:-2]) for x in lines_4]


# --- problem 5 ----------------------------------------------------------------------------------------------------


def matrices(surface: str, text: str) -> dict[str, dict[tuple[int, int], Value]]:
    """What is written of M, D, G, K and N in physical time; of symmetric ones perhaps the upper half."""
    found: dict[str, dict[tuple[int, int], Value]] = {}
    if surface == "terminal":
        return _drawn(re.split(_OTHER_FORMS, text.partition("Problem 5.")[2].partition("Problem 6.")[0])[0])
    if surface == "json":
        listed = json.loads(text)["linearisation"]
        return {x: _numbered([[python(y) for y in row] for row in listed[x]]) for x in "MDGKN"}
    if surface == "wolfram":
        for x, body in re.findall(r"^linear([MDGKN]) = \{\s*\{(.*?)\}\s*\};", text, re.MULTILINE | re.DOTALL):
            found[x] = _numbered([[wolfram(y) for y in re.split(r",\s+", row)] for row in re.split(r"\},\s*\{", body)])
        return found
    if surface == "latex":
        section = text.partition("{Problem 5. First approximation}")[2].partition("\\section*{")[0]
        for match in re.finditer(r"([MDGKN]) = (\d*) ?\\begin\{pmatrix\}(.*?)\\end\{pmatrix\}", section, re.DOTALL):
            rows = [row.split("&") for row in match[3].split(r"\\") if row.strip()]
            found.setdefault(
                match[1], _numbered([[_times(match[2], latex(" ".join(y.split()))) for y in r] for r in rows])
            )
        for name, alone in re.findall(r"\n([MDGKN]) = ((?:(?!pmatrix).)+)\n\\end\{equation\}", section):
            found.setdefault(name, {(1, 1): latex(alone)})
        for match in re.finditer(r"eq:linear:([MDGKN]):\d+\]\{[MDGKN]_\{(\d)(\d)\} = ", section):
            formula = next(x for kind, x in _latex_pieces(section[section.rindex("\\longformula", 0, match.end()) :])
                           if kind == "formula")  # fmt: skip
            found.setdefault(match[1], {})[int(match[2]), int(match[3])] = latex(formula.partition(" = ")[2])
        return found
    (section_5,) = [x for x in tree(text).iter("section") if x.get("id") == "problem-5"]
    for node in section_5.iter():
        if node.tag == "div" and node.get("class") == "formula":
            tokens = [x for part in node.iter("math") for x in tokens_of(part)]
            if str(tokens[0][1]).startswith("M") and str(tokens[1][1]).startswith("q"):  # M q'' + ... of a subsystem
                break
            name = re.fullmatch(r"([MDGKN])(?:_(\d)(\d))?", str(tokens[0][1])) if tokens[1:2] == [("mo", "=")] else None
            if name is not None and name[2]:
                found.setdefault(name[1], {})[int(name[2]), int(name[3])] = mathml(tokens[2:])
            elif name is not None and (table := [x for kind, x in tokens if kind == "table"]):
                front = str(tokens[2][1]) if tokens[2][0] == "mn" else ""
                found[name[1]] = _numbered([[_times(front, mathml(y)) for y in row] for row in table[0]])
            elif name is not None and tokens[2:] != [("mn", "0")]:
                found[name[1]] = {(1, 1): mathml(tokens[2:])}
    return found


_OTHER_FORMS = r"\n(?:With the deviations|In first-order form|The equations split|Derivatives are|  M1? q1?'')"


def _drawn(text: str) -> dict[str, dict[tuple[int, int], Value]]:
    """Square matrices in brackets, one below the other, and entries by their places."""
    found: dict[str, dict[tuple[int, int], Value]] = {}
    rows: list[list[str]] = []
    names = ""
    for line in text.splitlines():
        drawn = re.fullmatch(r" +(?:([MDGKN]) =)? +\[ (.*) \]", line)
        if drawn is not None:
            names += drawn[1] or ""
            rows.append(re.split(r" {2,}", drawn[2].strip()))
            if len(rows) == len(rows[0]):
                found[names] = _numbered([[readable(x) for x in row] for row in rows])
                rows, names = [], ""
        entry = re.fullmatch(r"  ([MDGKN])\[(\d)(\d)\] = (.*)", line)
        if entry is not None:
            found.setdefault(entry[1], {})[int(entry[2]), int(entry[3])] = readable(entry[4])
        alone = re.fullmatch(r"  ([MDGKN]) = ((?!\[ ).*)", line)
        if alone is not None and alone[2] != "0":
            found[alone[1]] = {(1, 1): readable(alone[2])}
    return found


def _numbered(rows: list[list[Value]]) -> dict[tuple[int, int], Value]:
    return {(i, j): value for i, row in enumerate(rows, 1) for j, value in enumerate(row, 1)}


def _times(number: str, value: Value) -> Value:
    return lambda symbols: fmpq(int(number or 1)) * value(symbols)
