"""The abbreviations of a publication, as they stand in its formulas."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import (
    ZERO,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    add,
    multiply,
    names,
    walk,
)
from mbsym.mechanics.kinematics import Scene
from mbsym.model.claims import Claim
from mbsym.model.system import System


class Symbols:
    """The abbreviations of a description, as they stand in claims.

    One that is a linear form in angles (``beta = theta + alpha``) may stand under sin and cos; the others are values.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.values = {item.name: item.value for item in system.abbreviations}
        self.forms: dict[str, LinearForm] = {}
        for name, value in self.values.items():
            form = linear_form(value)
            opened = None if form is None else self._opened_form(form)
            if opened is not None:
                self.forms[name] = opened

    def _opened_form(self, form: LinearForm) -> LinearForm | None:
        """A linear form with abbreviations replaced; None where one of them is no linear form."""
        total = LinearForm((), form.turns, form.constant)
        for name, coefficient in form.coefficients:
            if name in self.values and name not in self.forms:
                return None
            total = total + self.forms.get(name, LinearForm(((name, Fraction(1)),))).scaled(coefficient)
        return total

    def opened(self, expression: Expression) -> Expression:
        """The expression with abbreviations under sin, cos and tan replaced by the angles that they are."""
        match expression:
            case Call("sin" | "cos" | "tan" as function, argument):
                form = linear_form(argument)
                opened = None if form is None else self._opened_form(form)
                return Call(function, self.opened(argument) if opened is None else _written(opened))
            case Call(function, argument):
                return Call(function, self.opened(argument))
            case Negative(operand):
                return Negative(self.opened(operand))
            case Operation(operator, left, right):
                return Operation(operator, self.opened(left), self.opened(right))
        return expression

    def arguments(self, claim: Claim) -> Iterator[Expression]:
        """Every angle under sin, cos and tan in a claim and in the abbreviations that it is written in."""
        parts = [part for part in (claim.equals, claim.right, claim.of_expression, claim.at) if part is not None]
        parts += [self.values[name] for name in sorted(self.occurring(parts)) if name in self.values]
        for expression in parts:
            for node in walk(self.opened(expression)):
                if isinstance(node, Call) and node.function in ("sin", "cos", "tan"):
                    yield node.argument

    def occurring(self, expressions: Iterable[Expression]) -> set[str]:
        """The names that occur, those in abbreviations included."""
        found: set[str] = set()
        pending = [name for expression in expressions for name in names(expression)]
        while pending:
            name = pending.pop()
            if name not in found:
                found.add(name)
                pending += names(self.values[name]) if name in self.values else ()
        return found

    def lowering(self, algebra: Any, environment: Mapping[str, Any], wanted: set[str]) -> Lowering:
        """Values for expressions, in an algebra, with those of the wanted abbreviations."""
        known = dict(environment)
        for name, value in self.values.items():
            if name in wanted:
                known[name] = Lowering(algebra, known)(self.opened(value))
        return Lowering(algebra, known)

    def polynomial(self, scene: Scene, claim: Claim) -> Polynomial:
        """What was claimed, in the ring; a characteristic polynomial's variable is the generator of the time.

        Raises NoClosedForm where such a polynomial holds the time itself.
        """
        wanted = self.occurring([claim.equals])
        environment = dict(scene.environment)
        if claim.variable:
            if "t" in wanted:
                raise NoClosedForm("a characteristic polynomial does not hold the time")
            environment[claim.variable] = scene.ring.generator("time", "t")
        return self.lowering(scene.ring, environment, wanted)(self.opened(claim.equals))


def _written(form: LinearForm) -> Expression:
    total: Expression = ZERO
    for name, coefficient in form.coefficients:
        total = add(total, multiply(Number(coefficient), Name(name)))
    if form.turns:
        total = add(total, multiply(Number(form.turns), Name("pi")))
    return add(total, Number(form.constant)) if form.constant else total
