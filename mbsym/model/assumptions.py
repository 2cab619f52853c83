"""Assumptions about parameters against numbers, and against each other.

An assumption that the given values break, or that no values can keep, makes every sentence that rests on it void.
Linear ones (a > 1, a + b < 2 c) are decided completely, together with declared signs and linear relations, by
Fourier-Motzkin elimination in exact numbers; what is not linear is left to those who know more about signs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import chain
from typing import Any

from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import Expression
from mbsym.model.admissibility import number_of
from mbsym.model.system import Assumption, System

#: More inequalities than this are not eliminated: nothing is said then.
MOST_INEQUALITIES = 400
#: pi stands in assumptions as a number between these.
_PI = (Fraction(314159, 100000), Fraction(314160, 100000))


#: The value of an expression at known numbers, or None where it has none or is not known.
Evaluate = Callable[[Expression, Mapping[str, Fraction]], Fraction | None]


def broken(
    system: System,
    values: Mapping[str, Fraction],
    tolerance: Fraction = Fraction(0),
    evaluate: Evaluate = number_of,
) -> Iterator[tuple[Assumption, Fraction, Fraction]]:
    """(assumption, left, right) of every assumption that is false at the values; where one has none, nothing is said.

    ``evaluate`` may round: sides that differ by less than ``tolerance``, relatively, are not told apart then.
    """
    known = dict(values)
    for notation in system.notation:
        value = evaluate(notation.value, known)
        if value is not None:
            known[notation.name] = value
    for assumption in system.assumptions:
        left, right = evaluate(assumption.left, known), evaluate(assumption.right, known)
        if left is None or right is None or holds(left - right, assumption.relation):
            continue
        if not tolerance or abs(left - right) > tolerance * max(abs(left), abs(right)):
            yield assumption, left, right


def contradictory(system: System) -> Assumption | None:
    """The first assumption that no values keep together with those before it, declared signs and relations.

    None where there is none, or none is proved.
    """
    known = [*_declared(system), *_equations(system)]
    added = [_inequalities(premise.left, premise.relation, premise.right) for premise in system.assumptions]
    if _impossible([*known, *chain.from_iterable(added)]) is False:  # what all keep together, some do
        return None
    for assumption, inequalities in zip(system.assumptions, added, strict=True):
        known += inequalities
        if _impossible(known):
            return assumption
    return None


@dataclass(frozen=True)
class _Inequality:
    """sum coefficient * name + constant > 0, or >= 0 where it is not ``strict``."""

    coefficients: tuple[tuple[str, Fraction], ...]
    constant: Fraction
    strict: bool

    def of(self, name: str) -> Fraction:
        return next((coefficient for other, coefficient in self.coefficients if other == name), Fraction(0))

    @property
    def false(self) -> bool:
        """Whether it is a false statement about numbers."""
        return not self.coefficients and (self.constant < 0 or (self.strict and self.constant == 0))


def _declared(system: System) -> list[_Inequality]:
    inequalities = [
        _Inequality((("pi", Fraction(1)),), -_PI[0], True),
        _Inequality((("pi", Fraction(-1)),), _PI[1], True),
    ]
    for parameter in system.parameters:
        relation = RELATION_OF_SIGN.get(parameter.sign, "!=")
        inequalities += _of_form(LinearForm(((parameter.name, Fraction(1)),)), relation)
    return inequalities


def _equations(system: System) -> list[_Inequality]:
    """Relations and notation are equations: two inequalities each."""
    equations = []
    definitions = [(relation.name, relation.value) for relation in system.relations]
    definitions += [(notation.name, notation.value) for notation in system.notation]
    for name, definition in definitions:
        value = linear_form(definition)
        if value is not None:
            gap = LinearForm(((name, Fraction(1)),)) + value.scaled(Fraction(-1))
            equations += [*_of_form(gap, ">="), *_of_form(gap, "<=")]
    return equations


def _inequalities(left: Expression, relation: str, right: Expression) -> list[_Inequality]:
    first, second = linear_form(left), linear_form(right)
    return [] if first is None or second is None else _of_form(first + second.scaled(Fraction(-1)), relation)


def _of_form(gap: LinearForm, relation: str) -> list[_Inequality]:
    """``gap relation 0``; != says nothing here unless the gap is a number."""
    if relation == "!=":
        return [_Inequality((), Fraction(0), True)] if gap == LinearForm() else []
    if relation in ("<", "<="):
        gap = gap.scaled(Fraction(-1))
    coefficients = dict(gap.coefficients) | ({"pi": gap.turns} if gap.turns else {})
    return [_Inequality(tuple(sorted(coefficients.items())), gap.constant, relation in ("<", ">"))]


def _impossible(inequalities: list[_Inequality]) -> bool | None:
    """Whether no numbers fulfil all of them; None where it would take too long to know."""
    known = set(inequalities)
    while True:
        if any(inequality.false for inequality in known):
            return True
        growth = _growth(known)
        if not growth:
            return False
        name = min(growth, key=lambda x: (growth[x], x))
        above = [inequality for inequality in known if inequality.of(name) > 0]
        below = [inequality for inequality in known if inequality.of(name) < 0]
        known = {inequality for inequality in known if inequality.of(name) == 0}
        known |= {_without(name, inequality, other) for inequality in above for other in below}
        if len(known) > MOST_INEQUALITIES:
            return None


def _growth(known: set[_Inequality]) -> dict[str, int]:
    """By name, how many inequalities more there are when it has been eliminated."""
    bounds: dict[str, list[int]] = {}
    for inequality in known:
        for name, coefficient in inequality.coefficients:
            bounds.setdefault(name, [0, 0])[coefficient > 0] += 1
    return {name: above * below - above - below for name, (above, below) in bounds.items()}


def _without(name: str, lower: _Inequality, upper: _Inequality) -> _Inequality:
    """The sum of the two in which a name drops out: positive in ``lower``, negative in ``upper``."""
    first, second = -upper.of(name), lower.of(name)
    total = {variable: first * value for variable, value in lower.coefficients}
    for variable, value in upper.coefficients:
        total[variable] = total.get(variable, Fraction(0)) + second * value
    coefficients = tuple(sorted((variable, value) for variable, value in total.items() if value))
    constant = first * lower.constant + second * upper.constant
    scale = abs(coefficients[0][1]) if coefficients else Fraction(1)
    coefficients = tuple((variable, value / scale) for variable, value in coefficients)
    return _Inequality(coefficients, constant / scale, lower.strict or upper.strict)


# Comparisons of numbers with zero, as assumptions state them and as the declared signs of parameters mean them.


#: The relation to zero that a sign word declares; "real" declares none.
RELATION_OF_SIGN = {"positive": ">", "nonnegative": ">=", "negative": "<", "nonpositive": "<=", "nonzero": "!="}


def holds(gap: Any, relation: str) -> bool:
    """Whether ``gap relation 0``; of a ball, whether this is certain."""
    return bool({"<": gap < 0, "<=": gap <= 0, ">": gap > 0, ">=": gap >= 0, "!=": gap != 0}[relation])


def has_sign(value: Any, sign: str) -> bool:
    """Whether a number has a declared sign; of a ball, whether this is certain."""
    return sign not in RELATION_OF_SIGN or holds(value, RELATION_OF_SIGN[sign])
