"""Mutated descriptions, the same ones in every run: numbers, names, texts, lines, characters.

``mutant(text, chance)`` changes anything, and mostly gives a description with errors; ``variant(text, chance)`` changes
numbers, names and texts for people so that most of what comes out is still a description, of another system;
``grafted(text, chance)`` changes the tree of keys and values.
"""

from __future__ import annotations

import copy
import json
import re
from collections.abc import Callable, Iterator
from random import Random
from typing import Any

import yaml

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


#: What is spliced around a formula, and what is put in the place of one.
_AROUND = ("sqrt({})", "exp({})", "log({})", "tan({})", "atan({})", "cos({})", "abs({})", "({})**2", "1/({})", "-({})",
           "({})*({})", "({}) - ({})", "{}/(1 + t)", "sign({})", "({})**(1/2)")  # fmt: skip
_ODD = ("0", "-1", "pi/2", "sqrt(2)", "1/3", "exp(1)", "t", "-0", "1e30", "cos(3*pi/2)", "sqrt(2)**2 - 2", "log(2)")
_CONSTRAINTS: tuple[dict[str, Any], ...] = (
    {"coincide": [{"body": "{0}", "point": ["1", "0", "0"]}, {"body": "{1}", "point": ["0", "1", "0"]}]},
    {"distance": [{"body": "{0}", "point": ["1", "0", "0"]}, {"body": "{1}"}], "length": "2"},
    {"relation": "{2} - {3}**2 = 0"},
    {"velocity": "{2}_dot - {3}*{2}_dot = 0"},
    {"velocity": "{2}_dot = 0"},
)


def grafted(text: str, chance: Random) -> str:
    """One or two changes of the tree of a YAML description: keys and items gone, exchanged or doubled, functions around
    formulas, odd values, a further body, a constraint."""
    try:
        tree = yaml.load(text, Loader=yaml.BaseLoader)
    except yaml.YAMLError:
        return text
    if not isinstance(tree, dict):
        return text
    for _ in range(chance.randint(1, 2)):
        _graft(tree, chance)
    written: str = yaml.safe_dump(tree, sort_keys=False, allow_unicode=True)
    return written


def _graft(tree: dict[str, Any], chance: Random) -> None:
    places = list(_places(tree))
    leaves = [(at, key) for at, key in places if isinstance(at[key], str) and key != "mbsym"]
    (at, key), (other, there) = chance.choice(places), chance.choice(places)
    (leaf, name), (second, one) = chance.choice(leaves), chance.choice(leaves)
    bodies = tree.get("bodies")
    match chance.randrange(10):
        case 0:
            del at[key]
        case 1:
            at[key], other[there] = copy.deepcopy(other[there]), copy.deepcopy(at[key])
        case 2:
            leaf[name], second[one] = second[one], leaf[name]
        case 3 | 4 | 5:
            leaf[name] = chance.choice(_AROUND).replace("{}", leaf[name])
        case 6:
            leaf[name] = chance.choice(_ODD)
        case 7:
            at[key] = chance.choice([[], {}, ""])
        case 8 if isinstance(bodies, list) and bodies and isinstance(bodies[-1], dict):
            extra = json.loads(re.sub(r'"angles": \[[^]]*\]', '"angles": ["extra_q"]', json.dumps(bodies[-1])))
            extra |= {"name": "extra", "attached to": bodies[-1].get("name", "0")}
            extra.pop("coordinates", None)
            if isinstance(extra.get("rotation"), dict):
                extra["rotation"]["axes"] = ["3"]
            bodies.append(extra)
        case 9 if isinstance(bodies, list):
            called = [str(one.get("name", "0")) for one in bodies if isinstance(one, dict)] or ["0"]
            moving = tree["motion"] if isinstance(tree.get("motion"), dict) and tree["motion"] else {"x": ""}
            words = [chance.choice(called), chance.choice([*called, "0"]), *(chance.choice(list(moving)) for _ in "12")]
            added = json.dumps(chance.choice(_CONSTRAINTS))
            for number, word in enumerate(words):
                added = added.replace(f"{{{number}}}", word)
            tree.setdefault("constraints", [])
            if isinstance(tree["constraints"], list):
                tree["constraints"].append(json.loads(added))


def _places(tree: Any) -> Iterator[tuple[Any, Any]]:
    """(container, key or index) of everything below the first level's version."""
    items = list(tree.items()) if isinstance(tree, dict) else list(enumerate(tree)) if isinstance(tree, list) else []
    for key, value in items:
        if key != "mbsym":
            yield tree, key
            yield from _places(value)


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
