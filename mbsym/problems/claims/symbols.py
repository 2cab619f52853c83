"""The abbreviations of a publication, as they stand in its formulas."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from typing import Any
from weakref import WeakKeyDictionary

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.remembered import remembered
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import ZERO, Call, Expression, Name, Number, add, multiply, names, reached, rewritten, walk
from mbsym.mechanics.kinematics import Scene
from mbsym.model.claims import Claim
from mbsym.model.system import System


class Symbols:
    """The abbreviations of a description, as they stand in claims.

    One that is a linear form in angles (``beta = theta + alpha``) may stand under sin and cos; the others are values.
    """

    @staticmethod
    @remembered  # they are asked for again and again, claim by claim
    def of(owner: Any) -> Symbols:
        """Those of ``owner.system``, made once for its owner."""
        return Symbols(owner.system)

    def __init__(self, system: System) -> None:
        self.system = system
        self.values = {item.name: item.value for item in system.abbreviations}
        self._in_scenes: WeakKeyDictionary[Scene, Lowering] = WeakKeyDictionary()
        self._known: WeakKeyDictionary[Scene, dict[str, Any]] = WeakKeyDictionary()
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

        def change(part: Expression) -> Expression | None:
            if not (isinstance(part, Call) and part.function in ("sin", "cos", "tan")):
                return None
            form = linear_form(part.argument)
            opened = None if form is None else self._opened_form(form)
            return Call(part.function, self.opened(part.argument) if opened is None else _written(opened))

        return rewritten(expression, change)

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
        needs = {name: names(value) for name, value in self.values.items()}
        return reached(needs, (name for expression in expressions for name in names(expression)))

    def lowering(self, algebra: Any, environment: Mapping[str, Any], required: set[str]) -> Lowering:
        """Values for expressions, in an algebra, with those of the wanted abbreviations."""
        known = dict(environment)
        for name, value in self.values.items():
            if name in required:
                known[name] = Lowering(algebra, known)(self.opened(value))
        return Lowering(algebra, known)

    def in_scene(self, scene: Scene, more: Mapping[str, Any] | None = None) -> Lowering:
        """Values for expressions over a scene, with those of the abbreviations: each is formed once.

        ``more`` are names that it has besides from now on.
        """
        if scene not in self._in_scenes:
            values = _Values(scene.environment, self)
            self._in_scenes[scene] = values.lower = Lowering(scene.algebra, values)
            self._known[scene] = values
        if more:
            self._known[scene].update(more)
        return self._in_scenes[scene]

    def polynomial(self, scene: Scene, claim: Claim) -> Polynomial:
        """What was claimed, in the ring; a characteristic polynomial's variable is the generator of the time.

        Raises NoClosedForm where such a polynomial holds the time itself.
        """
        lower, opened = self.in_scene(scene), self.opened(claim.equals)
        if not claim.variable:
            return lower(opened)
        if "t" in self.occurring([claim.equals]):
            raise NoClosedForm("a characteristic polynomial does not hold the time")
        # No abbreviation holds the variable: it is no name outside its claim.
        known = {name: lower(Name(name)) for name in names(opened) if name != claim.variable}
        return Lowering(scene.ring, known | {claim.variable: scene.ring.generator("time", "t")})(opened)


class _Values(dict[str, Any]):
    """Values by name; those of abbreviations are formed when they are asked for."""

    lower: Lowering

    def __init__(self, environment: Mapping[str, Any], symbols: Symbols) -> None:
        super().__init__({name: value for name, value in environment.items() if name not in symbols.values})
        self._symbols = symbols

    def __missing__(self, name: str) -> Any:
        self[name] = value = self.lower(self._symbols.opened(self._symbols.values[name]))
        return value


def _written(form: LinearForm) -> Expression:
    total: Expression = ZERO
    for name, coefficient in form.coefficients:
        total = add(total, multiply(Number(coefficient), Name(name)))
    if form.turns:
        total = add(total, multiply(Number(form.turns), Name("pi")))
    return add(total, Number(form.constant)) if form.constant else total
