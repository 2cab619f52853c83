"""What may stand in a description, in words: ``mbsym explain description``, ``loads``, ``claims`` and the like.

Everything comes from the table that the reader itself goes by, so that nothing is described that is not read.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from textwrap import wrap

from mbsym.expressions.tree import SMOOTH
from mbsym.model.claims import CLAIMS, EXPRESSION, ClaimKind
from mbsym.source.examples import example_names, example_text
from mbsym.source.grammar import Ends, Flag, Key, Kind, Named, Record, Type, plain
from mbsym.source.keys import CLAIM, CONSTRAINTS, DESCRIPTION, LOADS, SYSTEM
from mbsym.source.labels import BODY, HEADER, SECTIONS

WIDTH = 110


def description() -> str:
    """Every key of a description, loads, constraints and claims apart."""
    return "\n\n".join([*(_titled(record) for record in records(DESCRIPTION)), _SEE])


def loads() -> str:
    """Every kind of load with its keys."""
    return _kinds("load", LOADS)


def constraints() -> str:
    """Every kind of constraint with its keys."""
    return _kinds("constraint", CONSTRAINTS)


def plain_text() -> str:
    """The labels of the description editor's text, which the paper's Figure 3 prints, and the keys they stand for."""
    width = max(map(len, _LABELS))
    parts = [_PLAIN_TEXT]
    for title, labels in _LABELLED.items():
        lines = [f"    {label.capitalize():<{width}}  {key}" for label, key in labels.items()]
        parts.append("\n".join([title, "", *lines]))
    return "\n\n".join(parts)


def _kinds(what: str, kinds: Mapping[str, Kind]) -> str:
    parts = [f"{what}s:  a list; each {what} is  - kind: {{key: value, ...}}  or  - kind: {_BARE[what]}"]
    for name, kind in kinds.items():
        parts.append(f"{name}: {kind.meaning}" + (f"\n\n{_listed(kind.keys)}" if kind.keys else ""))
    return "\n\n".join([*parts, *(_titled(end) for end in ends(kinds))])


#: What the value of a kind without keys is.
_BARE = {"load": "expression", "constraint": "equation, or two ends"}


def records(value_type: Type) -> list[Record]:
    """The records of a description with their keys, from the whole inwards, each once; those of kinds are apart."""
    nested: list[Record] = []
    for inner in plain(value_type):
        if isinstance(inner, Record) and inner.title:
            nested += [inner, *(x for key in inner.keys.values() for x in records(key.type))]
        elif isinstance(inner, Named):
            nested += records(inner.value)
    return list(dict.fromkeys(nested))


def ends(kinds: Mapping[str, Kind]) -> list[Record]:
    """What the ends of these kinds are given by."""
    types = (
        value_type for kind in kinds.values() for value_type in (kind.type, *(key.type for key in kind.keys.values()))
    )
    return list(dict.fromkeys(value_type.record for value_type in types if isinstance(value_type, Ends)))


def keys_of(record: Record) -> dict[str, Key]:
    """Its keys, but for words that are short for another one (``positive: true``), which that one tells."""
    return {name: key for name, key in record.keys.items() if not (isinstance(key.type, Flag) and not key.type.false)}


#: The labels of the editor's text, and the keys they stand for.
_LABELLED = {
    "Of the system:": {label: key for label, key in HEADER.items() if key in SYSTEM},
    "Sections of lines 'name = value':": {label: name for label, (name, _) in SECTIONS.items()},
    "Of a body, below 'Body description (1)':": BODY,
}
_LABELS = {label: key for labels in _LABELLED.values() for label, key in labels.items()}


def _titled(record: Record) -> str:
    return f"{record.title}\n\n{_listed(keys_of(record))}"


def expressions() -> str:
    """What a formula in a description is made of."""
    return _EXPRESSIONS.format(functions=", ".join(sorted(SMOOTH)), kinked=_KINKED, tabulated=_TABULATED)


def abbreviations() -> str:
    """The author's letters, in claims and in results."""
    return _ABBREVIATIONS


def claim_kinds() -> str:
    """Every kind of claim, the keys that it needs, and what they mean."""
    width = max(map(len, CLAIMS))
    kinds = "\n".join(f"    {kind:<{width}}  {entry.meaning}{_keys(entry)}" for kind, entry in CLAIMS.items())
    head = f"Kinds of claim, and the keys they need beside 'equals':\n\n{kinds}"
    return f"{head}\n\nKeys:\n\n{_listed(CLAIM)}\n\nExamples:\n\n{EXAMPLES}"


def _keys(entry: ClaimKind) -> str:
    needed = ["of, state" if entry.of == EXPRESSION and not entry.order else "of"] if entry.of else []
    needed += ["order"] if entry.order else []
    needed += {0: [], 1: ["component"], 2: ["entry"]}[entry.entry]
    needed += ["at"] if entry.at else []
    needed += ["variable"] if entry.variable else []
    needed += ["that (instead of equals)"] if entry.inequality else []
    return f"  [{', '.join(needed)}]" if needed else ""


def _listed(table: Mapping[str, Key]) -> str:
    width = max(map(len, table))
    lines = []
    for key, entry in table.items():
        first, *others = wrap(entry.meaning, WIDTH - width - 6)
        lines.append(f"    {key:<{width}}  {first}")
        lines += [" " * (width + 6) + other for other in others]
    return "\n".join(lines)


def meanings(word: str) -> list[str]:
    """What a word means as a key of a description, its label in the editor's text, or a kind of load, constraint or
    claim; none for other words.
    """
    if word.lower() in _LABELS and _LABELS[word.lower()] != word:
        return meanings(_LABELS[word.lower()])
    named = [(record.title, record.keys) for record in records(DESCRIPTION)]
    named += [("A claim", CLAIM)]
    paragraphs = [f"{title}\n\n{_listed({word: keys[word]})}" for title, keys in named if word in keys]
    for what, kinds in (("load", LOADS), ("constraint", CONSTRAINTS)):
        if word in kinds:
            kind = kinds[word]
            keys = f"\n\n{_listed(kind.keys)}" if kind.keys else ""
            paragraphs.append(f"A kind of {what}: {kind.meaning}{keys}{_shipped(what, word)}")
        for name, kind in kinds.items():
            paragraphs += [f"A {what}, {name}\n\n{_listed({word: kind.keys[word]})}"] if word in kind.keys else []
    if word in CLAIMS:
        paragraphs.append(f"A kind of claim: {CLAIMS[word].meaning}{_keys(CLAIMS[word])}")
    return paragraphs


def _shipped(what: str, kind: str) -> str:
    """One of this kind as it stands in a shipped system, the shortest that stands in one line; "" where none does."""
    item = re.compile(rf"^ *- ({re.escape(kind)}: .*[^\s:>|-])$", re.MULTILINE)
    examples = [(len(line), line, name) for name in example_names() for line in item.findall(example_text(name))]
    if not examples:
        return ""
    _, line, name = min(examples)
    return f"\n\nAs in {name}.yaml (mbsym examples {name}):\n\n    {what}s:\n      - {line}"


def words() -> list[str]:
    """Every word that ``meanings`` knows."""
    tables: list[Iterable[str]] = [
        *(record.keys for record in records(DESCRIPTION)),
        CLAIM,
        LOADS,
        CONSTRAINTS,
        CLAIMS,
        _LABELS,
    ]
    tables += [kind.keys for kinds in (LOADS, CONSTRAINTS) for kind in kinds.values()]
    return list(dict.fromkeys(word for table in tables for word in table))


_PLAIN_TEXT = """\
A description in the plain text of the description editor, as the paper's Figure 3 has it

mbsym convert FILE.yaml --out FILE.txt writes a description so, and reads it.  A label is followed by a colon, nothing,
or its value in the next line; vectors stand in brackets or not, Greek letters and signs as they are printed.  Loads,
constraints and claims follow in blocks 'Load description (1)', with 'Type of load:' and their keys.  Without a section
'Parameters' names declare themselves.  Labels, and the keys that mbsym explain tells of:"""

_SEE = (
    "Kinds of load: mbsym explain loads.  Of constraint: mbsym explain constraints.  Formulas: mbsym explain "
    "expressions.  Letters: mbsym explain abbreviations.  Claims: mbsym explain claims."
)

_ABBREVIATIONS = """\
abbreviations:  letters of an author, in order; later ones may hold earlier ones:

    abbreviations:
      lam: (s - 1)*r + eta
      G: p**2 + q**2

They may stand in claims, and they and those under 'notation' stand in formulas of results: in reports, and in what run,
expand, average, oscillations, nonlinear, integrals and symmetries print.  A letter L = N/D is put in by its relation
L*D = N, solved for a symbol v of it (or v**2, v**3, ...): eta = lam - (s - 1)*r, p**2 = G - q**2.  That is exact:
the definitions put back give the same formula.  What cancels is cancelled.  After a formula's section is listed what
its letters stand for.

Without --in a letter is put in where that leaves less to read: names, numbers, functions, signs, brackets, fractions
are counted, each step has to save a twentieth, all together a fifth (a tenth where nothing of what the letters are made
of is left in the formula), and no step brings in a symbol or denominator that was not there.  Of several letters in a
row (A = a*C, B = b*C) only the end is counted.  Formulas of more than 1000 terms stay as they are.

    --in lam,G       these letters alone, also where nothing gets shorter
    --in lam,eta     and the parameter eta is not what is taken out
    --in none        parameters alone

results.json, report.wl and generated code have parameters alone in their formulas.  Subsystems of problem 5 and their
stability in problem 6 are about the matrices in the letters of 'notation', everywhere and whatever --in says."""

_KINKED = """\
sign(x) = -1, 0, 1 for x < 0, x = 0, x > 0;  abs(x) = x*sign(x);  step(x) = (1 + sign(x))/2, 1/2 at 0;
                  pulse(x, a, b) = step(x - a) - step(x - b), 1 between a and b.  All in forces and torques, abs in
                  potentials and dissipation functions as well, whose derivatives are forces.  A simulation stops at
                  each jump and kink and goes on from there"""

_TABULATED = """\
torque(x) of a table torque under 'tables': where abs may stand; where step may stand, if its end jumps"""

_EXPRESSIONS = """\
Formulas in a description

    numbers       exact: 0.1 is 1/10, 3/2 is 3/2, 1e-3 is 1/1000
    names         letters, digits and _ ; upper and lower case differ; pi is the number
    operations    + - * / and ** or ^ with a rational exponent; parentheses
    functions     {functions}
    in loads      {kinked}
    tables        {tabulated}
    velocities    x_dot or x' of a coordinate x: in forces, torques, dissipation functions, velocity constraints, claims
    speeds        the names under 'speeds': where velocities may stand; components of unit vectors in forces, torques,
                  potentials, constraints
    accelerations x_ddot or x'': in claims of equations of motion and of values
    time          t: in joints, loads, constraints and claims

Angles are in radians (30 degrees are pi/6); any number may be an angle, and fractions of pi and decimals stay exact:
sin(pi/12) is made of roots, sin(pi/7) and sin(0.7853) are constants of their own.  All numbers belong to one
consistent system of units; where units are declared (unit of a parameter, units of a description), every formula is
checked for its dimension.
2*x, not 2x."""

#: Claims as they stand in a description.
EXAMPLES = """\
    claims:
      - {claim: kinetic energy, equals: c1*x_dot**2/2 - m*l*x_dot*phi_dot*sin(phi), place: eq. (3)}
      - {claim: coefficient, of: kinetic energy, at: x_dot*phi_dot, equals: -m*l*sin(phi), place: eq. (4)}
      - {claim: mass matrix, entry: [x, phi], equals: -m*l*sin(phi)}
      - {claim: angular velocity, of: rod, component: 3, equals: phi_dot}
      - {claim: condition, that: k > 0, as: necessary}
      - {claim: value, of: phi_ddot, state: initial, equals: -0.4821}"""
