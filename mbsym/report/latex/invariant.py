"""Problem 10 in LaTeX: its sentences filled."""

from __future__ import annotations

from mbsym.formulas.formula import Formula
from mbsym.formulas.latex import LatexNames
from mbsym.problems.invariant_sets import InvariantSets
from mbsym.report.even_powers import in_even_powers
from mbsym.report.language import Language
from mbsym.report.latex.formulas import formula
from mbsym.report.latex.words import escaped
from mbsym.report.words.invariant_words import Medium, closing, of_family, of_set, opening, told_families

_RELATIONS = {"!=": "\\neq", ">=": "\\ge"}


def of_invariant_sets(found: InvariantSets, names: LatexNames, tongue: Language) -> list[list[str]]:
    """Paragraphs, each a list of sentences in the language of the report."""

    def name_of(name: str) -> str:
        if name in found.variables and found.in_angles:  # written as in the formulas
            ring = found.integrals[0][1].ring
            return formula(Formula(ring, ring.generator("parameter", name)))
        return str(names[name])

    write = Medium(
        names=lambda listed: "$" + ",\\, ".join(map(name_of, listed)) + "$",
        condition=lambda x, relation: f"${formula(x)} {_RELATIONS.get(relation, relation)} 0$",
        value=lambda name, x: f"${name_of(name)} = {formula(x)}$",
        rate=lambda name, x: f"$\\dot{{{name_of(name)}}} = {formula(x)}$",
        formula=lambda x: f"${formula(x)}$",
        even=lambda factor: (
            "$" + in_even_powers([formula(x) for x in factor], lambda k: f"\\lambda^{{{k}}}", "\\,") + "$"
        ),
        word=lambda word: escaped(tongue.say(word)),
    )

    def said(told: object) -> list[str]:
        return [tongue.sentence(text, **values) for text, values in told]  # type: ignore[attr-defined]

    paragraphs = [said(opening(found, write))]
    for family in told_families(found):
        first = len(found.integrals) - len(family.integrals)
        terms = [f"{name_of(name)} V_{first + k + 1}" for k, name in enumerate(family.multipliers)]
        paragraphs.append([f"$K = {' + '.join([f'V_{first}', *terms])}$:", *said(of_family(family, write))])
        paragraphs += [said(of_set(one, k, write)) for k, one in enumerate(family.sets, start=1)]
    paragraphs.append(said(closing(found, write)))
    return [one for one in paragraphs if one]
