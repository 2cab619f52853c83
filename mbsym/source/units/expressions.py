"""The dimension of an expression; what is added or compared must be alike, what a function takes must be a number."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from fractions import Fraction

from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.expressions.table import Table
from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, names, text
from mbsym.model.system import rational
from mbsym.model.units import LENGTH, MASS, NONE, TIME, Dimension, times, written

_MOST = 40

#: Said instead of exponents.
_NAMED = {NONE: "a pure number", MASS: "a mass (kg)", LENGTH: "a length (m)", TIME: "a time (s)"}

Complain = Callable[[str, Span | None, str | None], None]


@dataclass
class Dimensions:
    """Reads expressions; complains where dimensions do not agree."""

    inference: Inference
    name_form: Callable[[str], Form]
    complain: Complain
    fresh: int = 0

    def with_name(self, name: str, form: Form) -> Dimensions:
        """The same with one more name, the variable of a polynomial; "" is no name."""
        known = self.name_form
        return replace(self, name_form=lambda other: form if other == name else known(other)) if name else self

    def expect(self, expression: Expression, wanted: Form, what: str) -> None:
        """An expression must have a dimension.  A number alone may stand for anything, in the units of the rest."""
        if not names(expression):
            return
        form = self.of(expression)
        if form is not None and not self.inference.equate(form, wanted):
            message = Message(
                "[[shown]] is [[told]], and [[what]] is [[told2]]",
                shown=_shown(expression),
                told=self.told(form),
                what=what,
                told2=self.told(wanted),
            )
            self.complain(message, _place(expression), None)

    def alike(self, left: Expression, right: Expression, how: str) -> None:
        """Two expressions must have the same dimension; a number alone goes with anything."""
        form, other = (self.of(side) if names(side) else None for side in (left, right))
        if form is not None and other is not None and not self.inference.equate(form, other):
            self.complain(self._apart(left, form, right, other, how), _place(right) or _place(left), None)

    def of(self, expression: Expression) -> Form | None:
        """The dimension; None of a zero, which goes with every one."""
        match expression:
            case Number(value):
                return None if value == 0 else Form()
            case Name(name):
                return Form() if name == "pi" else self.name_form(name)
            case Negative(operand):
                return self.of(operand)
            case Call(name, argument, table=Table()):  # the numbers in it have one dimension each, whatever they are
                inner = self.of(argument)
                if inner is not None:
                    self._tabulated(name, argument, inner)
                return self.name_form(name)
            case Call("sqrt", argument):
                inner = self.of(argument)
                return None if inner is None else inner.to_the(Fraction(1, 2))
            case Call("abs", argument):
                return self.of(argument)
            case Call("sign" | "step", argument):
                self.of(argument)
                return Form()
            case Call("pulse", argument, more=(start, end)):
                self._sum(Operation("-", argument, start, expression.span), argument, start)
                self._sum(Operation("-", argument, end, expression.span), argument, end)
                return Form()
            case Call(function, argument):
                self._number(
                    argument,
                    Message("[[function]] takes a pure number, such as an angle in radians", function=function),
                )
                return Form()
            case Operation("**", base, exponent):
                return self._power(base, exponent)
            case Operation("*", left, right):
                return self._product(left, right, 1)
            case Operation("/", left, right):
                return self._product(left, right, -1)
            case Operation(_, left, right):
                return self._sum(expression, left, right)
        raise TypeError(expression)

    def _tabulated(self, name: str, argument: Expression, found: Form) -> None:
        """All arguments of a table have one dimension."""
        form = self.name_form(Message("the argument of [[name]]", name=name))
        if not self.inference.equate(found, form):
            message = Message(
                "[[shown]] is [[told]], and the argument of [[name]] is [[told2]]",
                shown=_shown(argument),
                told=self.told(found),
                name=name,
                told2=self.told(form),
            )
            self.complain(message, _place(argument), None)

    def _product(self, left: Expression, right: Expression, power: int) -> Form | None:
        form, other = self.of(left), self.of(right)
        return None if form is None or other is None else form.times(other, power)

    def _power(self, base: Expression, exponent: Expression) -> Form | None:
        inner, power = self.of(base), rational(exponent)
        if power is not None:
            return Form() if power == 0 else None if inner is None else inner.to_the(power)
        self._number(exponent, "an exponent is a pure number")
        self._number(base, "what has a symbol for its exponent is a pure number")
        return Form()

    def _sum(self, whole: Operation, left: Expression, right: Expression) -> Form | None:
        form, other = self.of(left), self.of(right)
        if form is None or other is None:
            return other if form is None else form
        if self.inference.equate(form, other):
            return form
        how = "added" if whole.operator == "+" else "subtracted"
        message = self._apart(left, form, right, other, how)
        number = next((side for side in (left, right) if not names(side)), None)
        hint = None if number is None else "give the number a name and a unit under 'parameters'"
        self.complain(message, _place(right) or whole.span, hint)
        self.fresh += 1
        return Form(NONE, ((f" {self.fresh}", Fraction(1)),))  # one complaint about it is enough

    def _number(self, expression: Expression, rule: str) -> None:
        form = self.of(expression)
        if form is not None and not self.inference.equate(form, Form()):
            message = Message(
                "[[shown]] is [[told]]; [[rule]]", shown=_shown(expression), told=self.told(form), rule=rule
            )
            self.complain(message, _place(expression), None)

    def _apart(self, left: Expression, form: Form, right: Expression, other: Form, how: str) -> Message:
        """That two expressions have different dimensions, and so cannot be added, compared, ..."""
        return Message(
            "[[shown]] is [[told]], [[shown2]] is [[told2]]: they cannot be [[how]]",
            shown=_shown(left),
            told=self.told(form),
            shown2=_shown(right),
            told2=self.told(other),
            how=how,
        )

    def told(self, form: Form) -> str:
        """A dimension in words and SI units."""
        known = self.inference.reduced(form)
        unknown = " times ".join(f"[{name}]" + ("" if power == 1 else f"^{power}") for name, power in known.unknown)
        base = in_words(known.known)
        return (
            base
            if not unknown
            else unknown
            if not known.known
            else Message("[[base]] times [[unknown]]", base=base, unknown=unknown)
        )


def in_words(dimension: Dimension) -> str:
    """``a length (m)``, ``kg*m^2/s^2``, ``a pure number``."""
    return _NAMED.get(dimension) or written(times(NONE, dimension))


def _shown(expression: Expression) -> str:
    written_out = text(expression)
    return f"'{written_out}'" if len(written_out) <= _MOST else f"'{written_out[:_MOST]}...'"


def _place(expression: Expression) -> Span | None:
    """The place of an expression: its own, or that of its first part that has one."""
    if expression.span is not None:
        return expression.span
    match expression:
        case Negative(operand) | Call(_, operand):
            return _place(operand)
        case Operation(_, left, right):
            return _place(left) or _place(right)
    return None


# Dimensions as unknowns: every sum, equation and place of a description says something linear of their exponents.
#
# A ``Form`` is a known dimension times powers of the unknown dimensions of names.  ``Inference`` solves the equations
# as they come, by elimination over the rationals; one that contradicts those before is a slip.


@dataclass(frozen=True, slots=True)
class Form:
    """``known`` times the product of the dimensions of names to the powers of ``unknown``."""

    known: Dimension = NONE
    unknown: tuple[tuple[str, Fraction], ...] = ()

    def times(self, other: Form, power: Fraction | int = 1) -> Form:
        powers = dict(self.unknown)
        for name, exponent in other.unknown:
            powers[name] = powers.get(name, Fraction(0)) + exponent * power
        kept = tuple((name, exponent) for name, exponent in sorted(powers.items()) if exponent)
        return Form(times(self.known, other.known, power), kept)

    def to_the(self, power: Fraction | int) -> Form:
        return Form().times(self, power)

    @property
    def is_number(self) -> bool:
        """Whether it is known to be without dimension."""
        return not self.known and not self.unknown


@dataclass
class Inference:
    """What is known of the dimensions of names so far."""

    solved: dict[str, Form] = field(default_factory=dict)

    def reduced(self, form: Form) -> Form:
        """A form with everything put in that is known."""
        while True:
            name = next((name for name, _ in form.unknown if name in self.solved), None)
            if name is None:
                return form
            power = dict(form.unknown)[name]
            rest = Form(form.known, tuple(one for one in form.unknown if one[0] != name))
            form = rest.times(self.solved[name], power)

    def equate(self, left: Form, right: Form) -> bool:
        """Takes ``left = right`` for true; False, and nothing is taken, where that contradicts what is known."""
        difference = self.reduced(left.times(right, -1))
        if not difference.unknown:
            return not difference.known
        name, power = difference.unknown[0]
        rest = Form(difference.known, difference.unknown[1:])
        self.solved[name] = rest.to_the(-1 / power)
        return True

    def dimension(self, name: str) -> Dimension | None:
        """The dimension of a name, if it follows."""
        form = self.reduced(Form(NONE, ((name, Fraction(1)),)))
        return None if form.unknown else form.known
