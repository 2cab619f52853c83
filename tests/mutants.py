"""Mutated descriptions, the same ones in every run: numbers, names, texts, lines, characters.

``mutant(text, chance)`` changes anything, and mostly gives a description with errors; ``variant(text, chance)`` changes
numbers, names and texts for people so that most of what comes out is still a description, of another system.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random

#: Numbers that formulas, printers or integers may stumble over.
NUMBERS = (
    "0", "1", "-1", "-0", "1/3", "0.1", "1e-30", "1e30", "1e300", "12345678901.2345", "2147483648",
    "9223372036854775808", "10**40", "0.30000000000000004", "pi", "pi/7", "pi/12",
    "(pi+1)**3", "(2*pi/86164)**2", "sqrt(2)", "sqrt(-1)",
    "1/0", "0.0", "7/5", "3**-2", "cos(1)", "exp(2)", "1e-400", "1_000", "0x10", "1,5", "nan", "inf", "1e5000",
)  # fmt: skip

#: Names that mean something in one of the languages of the reports, or nearly.
NAMES = (
    "lambda", "int", "double", "e", "I", "E", "N", "D", "K", "C", "O", "Pi", "def", "None", "True", "np", "math",
    "self", "s1",
    "s2", "q", "qd", "p", "t", "x", "M", "f", "result", "value", "main", "sin_x", "Sin", "Dt", "alpha1", "beta_2",
    "phi_dot", "theta", "a1b2", "restrict", "static", "inline", "class", "import", "y1", "j0", "gamma", "exp1", "i",
    "l", "aaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaaa", "_x", "x_", "A0", "Omega", "omega_0", "model", "errno", "INFINITY",
)  # fmt: skip

#: Texts for people that want to be code.
TEXTS = (
    '*/ int x; /*', "//", "/* /*", '\\"\\"\\"', "'''", "\\\\", "\\\\end{document}", "$x$ % & # _ ^ ~", "(* *) *) (*",
    "\\\\u0041", "é ü ß", "漢字 Ω ∑", "a" * 300, "{", "}", "[[", "trigraph ??/", "\\\\n", "#include <x>", "'", "`",
    "<<>>", "null", "yes: no", "%s %d {0}", "\\\\VAR{x}", "\\\\BLOCK{ if }", "{{x}}", " ", "-", "-->",
)  # fmt: skip

_NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
_WORD = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?![\w:])")
_DECLARED = re.compile(r"^  ?([A-Za-z]\w*):|[\[{,]\s*([A-Za-z]\w*)(?=[:,\]}])", re.MULTILINE)
_TEXT = re.compile(r"((?:name|description|meaning|place):\s*)([^\n,}\"']+)")

#: Words that are keys or values of the language of descriptions, not names of a system.
_WORDS = """
mbsym name description parameters bodies attached to rotation axes angles mass centre inertia about joint loads
coordinates motion values initial relations notation positive real negative nonnegative meaning value rate position
velocity point connection acceleration direction gravity uniform spring damper potential force function torque
prescribed between stiffness rest coefficient coordinate generalized rayleigh claims claim equals place newtonian
constant order body vector entry of state component that as abbreviations assumptions moment gyrostatic sin cos tan sqrt
exp log atan sinh cosh tanh pi dimensionless time relative length
"""
_KEYS = frozenset(_WORDS.split())


def mutant(text: str, chance: Random) -> str:
    """One to four changes of any kind."""
    for _ in range(chance.randint(1, 4)):
        text = chance.choice(_MUTATIONS)(text, chance) or "mbsym"
    return text


def variant(text: str, chance: Random) -> str:
    """One to three changes that keep the form."""
    for _ in range(chance.randint(1, 3)):
        text = chance.choice(_VARIATIONS)(text, chance)
    return text


def _number(text: str, chance: Random) -> str:
    return _replaced(text, _NUMBER, chance, chance.choice(NUMBERS), after=text.find("\n") + 1)


def _scaled(text: str, chance: Random) -> str:
    """A name that has numbers in its place: a mass of ten digits, an irrational stiffness."""
    names = _names(text)
    if not names:
        return text
    name, value = chance.choice(names), chance.choice(NUMBERS)
    places = list(re.finditer(rf"(?<![\w.]){name}(?![\w:])", text))
    if not places:
        return text
    place = chance.choice(places)
    return text[: place.start()] + f"({value})" + text[place.end() :]


def _renamed(text: str, chance: Random) -> str:
    """A name of the description, everywhere."""
    names = _names(text)
    if not names:
        return text
    return re.sub(rf"(?<!\w){chance.choice(names)}(?=_dot\b|\b)", chance.choice(NAMES), text)


def _worded(text: str, chance: Random) -> str:
    words = chance.choice(TEXTS)
    places = list(_TEXT.finditer(text))
    if not places:
        return text
    place = chance.choice(places)
    return f'{text[: place.start()]}{place[1]}"{words}"{text[place.end() :]}'


def _operator(text: str, chance: Random) -> str:
    return _replaced(text, re.compile(r"(?<=\w)[-+*/](?=\w)|\*\*"), chance, chance.choice("+-*/"))


def _swapped(text: str, chance: Random) -> str:
    """One name where another one stood."""
    names = _names(text)
    return _replaced(text, _WORD, chance, chance.choice(names)) if names else text


def _line_gone(text: str, chance: Random) -> str:
    lines = text.split("\n")
    del lines[chance.randrange(len(lines))]
    return "\n".join(lines)


def _line_twice(text: str, chance: Random) -> str:
    lines = text.split("\n")
    lines.insert(chance.randrange(len(lines)), chance.choice(lines))
    return "\n".join(lines)


def _indented(text: str, chance: Random) -> str:
    lines = text.split("\n")
    at = chance.randrange(len(lines))
    lines[at] = chance.choice([" " + lines[at], lines[at].lstrip(), "\t" + lines[at], "- " + lines[at]])
    return "\n".join(lines)


def _character(text: str, chance: Random) -> str:
    at = chance.randrange(len(text))
    new = chance.choice(
        ["", *"{}[]:,#&*!|>'\"%@`\\-?", "\x00", "\x1b", "\u202e", "\ufeff", "\u00a0", "é", "\u2028", "0"]
    )
    return text[:at] + new + text[at + chance.randint(0, 2) :]


def _cut(text: str, chance: Random) -> str:
    return text[: chance.randrange(len(text))]


def _repeated(text: str, chance: Random) -> str:
    """A piece many times over."""
    start = chance.randrange(len(text))
    piece = text[start : start + chance.randint(1, 60)]
    return text[:start] + piece * chance.choice([2, 20, 200]) + text[start:]


_VARIATIONS: tuple[Callable[[str, Random], str], ...] = (
    _number,
    _scaled,
    _scaled,
    _renamed,
    _renamed,
    _worded,
    _operator,
)
_MUTATIONS = (*_VARIATIONS, _swapped, _line_gone, _line_twice, _indented, _character, _character, _cut, _repeated)


def _names(text: str) -> list[str]:
    """Names that the description declares, in order."""
    found = [first or second for first, second in _DECLARED.findall(text)]
    return [name for name in dict.fromkeys(found) if name not in _KEYS]


def _replaced(text: str, pattern: re.Pattern[str], chance: Random, new: str, after: int = 0) -> str:
    places = [match for match in pattern.finditer(text) if match.start() >= after]
    if not places:
        return text
    place = chance.choice(places)
    return text[: place.start()] + new + text[place.end() :]


#: Changes of generated code that change what it computes at a random state: signs, products, entries, numbers, names.
_CODE: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], str]], ...] = (
    (re.compile(r"(?<=[\w)\]]) \+ (?=[\w(])"), lambda _: " - "),
    (re.compile(r"(?<=[\w)\]]) - (?=[\w(])"), lambda _: " + "),
    (re.compile(r"(?<=[a-z\d])\*(?=[a-z])"), lambda _: " + "),
    (re.compile(r"\bsin\("), lambda _: "cos("),
    (re.compile(r"(?<=[ *+(-])s(\d+)(?=[*; )])"), lambda match: f"s{max(1, int(match[1]) - 1)}x"),
    (re.compile(r"(?<=[*+/( -])(\d)\.(\d)"), lambda match: f"{int(match[1]) + 1}.{match[2]}"),
)


#: Assignments to local names and to entries of results.
_ASSIGNED = re.compile(
    r"\s+(?:const double )?(?:s\d+|(?:sin|cos)_\w+|(?:result|M|f|qdd|J)(?:\[[\d, ]+\]|\([\d, ]+\))|der\(\w+\)) = "
)


def corrupted(code: str, chance: Random) -> str:
    """One sign, product, function, number or name of generated code is another."""
    lines = code.split("\n")
    places = [
        (number, match, change(match))
        for number, line in enumerate(lines)
        if _ASSIGNED.match(line)
        for pattern, change in _CODE
        for match in pattern.finditer(line, line.index(" = ") + 3)
    ]
    number, match, new = chance.choice(places)
    lines[number] = lines[number][: match.start()] + new + lines[number][match.end() :]
    return "\n".join(lines)
