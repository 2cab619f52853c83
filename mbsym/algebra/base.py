"""What the mechanics asks of a scalar.

The recursions in ``mbsym.mechanics`` are written once.  An ``Algebra`` supplies what they need beyond ``+ - *``:
numbers, sine and cosine of an angle, reciprocals, roots, and a normal form.  The algebras are

=============  ===============================================  =========================================
``Ring``       polynomials modulo sin^2 + cos^2 = 1             closed formulas, exact zero test
``Jet``        truncated Taylor polynomials over the ring       the first approximation, normal forms
``Program``    nodes of a straight-line program                 compact code
``Rationals``  ``fmpq``                                         exact agreement at rational states
``Balls``      ``arb``                                          rigorous enclosures where roots are not rational
=============  ===============================================  =========================================
"""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any, Generic, Protocol, Self, TypeVar

from mbsym.algebra.failures import NoClosedForm, NoValue
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.rates import is_rate
from mbsym.expressions.table import Table, curve_name
from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, children


class Summable(Protocol):
    """What a scalar of any algebra can do among its own kind: sums.  Products and all else are asked of its algebra."""

    def __add__(self, other: Self, /) -> Self: ...

    def __sub__(self, other: Self, /) -> Self: ...

    def __neg__(self) -> Self: ...


#: A scalar of one algebra: ``Algebra[S]``, ``Vector[S]``, ``Scene[S]`` belong together.
S = TypeVar("S", bound=Summable)
#: A scalar where nobody says of which algebra.
Scalar = Any
#: The components of a vector, in the axes of a frame that only the reader knows; with it: ``mbsym.algebra.vectors``.
Components = tuple[S, S, S]


class Algebra(Generic[S]):
    """Operations on scalars beyond ``+``, ``-`` and ``*``; subclasses define what raises NotImplementedError here."""

    zero: S
    one: S

    def number(self, value: Fraction | int) -> S:
        raise NotImplementedError

    def sin_cos(self, angle: LinearForm) -> tuple[S, S]:
        """sin and cos of a linear form in named angles."""
        raise NotImplementedError

    def sin_cos_of(self, argument: S) -> tuple[S, S]:
        """sin and cos of an argument that is no linear form in angles."""
        raise NotImplementedError

    def adds_constant(self, angle: LinearForm) -> bool:
        """Whether sin(theta + 3/10) is wanted in terms of the sines and cosines of theta and of 3/10."""
        return False

    def reciprocal(self, x: S) -> S:
        raise NotImplementedError

    def square_root(self, x: S) -> S:
        raise NotImplementedError

    def principal_root(self, x: S) -> S:
        """The root that is not negative, where ``square_root`` may be of either sign."""
        return self.square_root(x)

    def function(self, name: str, x: S) -> S:
        """exp, log, atan, sinh, cosh, tanh, abs or sign, the last two with their values at 0; or a ``Tabulated``."""
        raise NotImplementedError

    def times(self, a: S, b: S) -> S:
        product: S = operator.mul(a, b)
        return product

    def reduce(self, x: S) -> S:
        """The normal form; algebras without relations return x."""
        return x

    def vanishes(self, x: S) -> bool:
        """Whether x is zero as it stands, so that work with it can be left out."""
        return bool(x == 0)

    # --- derived --------------------------------------------------------------------------------------------------

    def ratio(self, x: S, y: S) -> S:
        """x/y in normal form."""
        return self.reduce(self.times(x, self.reciprocal(y)))

    def power(self, base: S, exponent: int) -> S:
        """base**exponent by repeated squaring; a negative exponent takes the reciprocal first."""
        if exponent < 0:
            base, exponent = self.reciprocal(base), -exponent
        result, square = self.one, base
        while exponent:
            if exponent & 1:
                result = self.reduce(self.times(result, square))
            exponent >>= 1
            if exponent:
                square = self.reduce(self.times(square, square))
        return result

    def dot(self, u: Sequence[S], v: Sequence[S]) -> S:
        total = self.zero
        for a, b in zip(u, v, strict=True):
            if not (self.vanishes(a) or self.vanishes(b)):
                total = total + self.times(a, b)
        return self.reduce(total)


class Lowering(Generic[S]):
    """Gives expressions values in an algebra: names through the environment, numbers exactly.

    ``environment`` maps every name that may occur (parameters, coordinates, velocities, accelerations, prescribed
    quantities, ``t``, ``pi``) to a scalar.  Values are remembered, so a subexpression is lowered once.

    Derivatives of long expressions are deep trees that share most of their parts.  Therefore equal expressions are
    recognised by numbers given to their parts, not by comparing whole trees, and values are formed from the leaves
    upwards, not by recursion.
    """

    def __init__(self, algebra: Algebra[S], environment: Mapping[str, S]) -> None:
        self.algebra = algebra
        self.environment = environment
        self._values: dict[int, S] = {}
        self._shapes: dict[tuple[Any, ...], int] = {}
        self._numbers: dict[int, int] = {}
        self._kept: list[Expression] = []  # an identity must not be used again

    def vector(self, components: Sequence[Expression]) -> Components[S]:
        return (self(components[0]), self(components[1]), self(components[2]))

    def __call__(self, expression: Expression) -> S:
        """The value of the expression.

        Raises SingularPoint for a division by zero, NoValue for a name without one, NoClosedForm or NotRational as the
        algebra does.
        """
        number = self._number(expression)
        if number not in self._values:
            pending = [expression]
            while pending:
                node = pending[-1]
                own = self._number(node)
                lacking = [x for x in self._operands(node) if self._number(x) not in self._values]
                if own not in self._values and lacking:
                    pending.extend(reversed(lacking))
                    continue
                pending.pop()
                if own not in self._values:
                    self._values[own] = self.algebra.reduce(self._value(node))
        return self._values[number]

    def _number(self, expression: Expression) -> int:
        """The same number for equal expressions."""
        known = self._numbers.get(id(expression))
        if known is not None:
            return known
        pending = [expression]
        while pending:
            node = pending[-1]
            if id(node) in self._numbers:
                pending.pop()
                continue
            parts = children(node)
            lacking = [x for x in parts if id(x) not in self._numbers]
            if lacking:
                pending.extend(lacking)
                continue
            shape = (type(node), _label(node), *(self._numbers[id(x)] for x in parts))
            self._numbers[id(node)] = self._shapes.setdefault(shape, len(self._shapes))
            self._kept.append(node)
            pending.pop()
        return self._numbers[id(expression)]

    def _operands(self, expression: Expression) -> tuple[Expression, ...]:
        """The parts whose values are asked for by ``_value``."""
        match expression:
            case Operation("**", base, _):
                return (base,)
            case Call("sin" | "cos" | "tan", argument) if self._angle_form(argument) is not None:
                return ()
        return children(expression)

    def angle(self, expression: Expression) -> tuple[S, S]:
        """(sin, cos) of an expression; theta + 3/10 by the addition theorem where the algebra wants it so."""
        form = self._angle_form(expression)
        if form is not None:
            return self.algebra.sin_cos(form)
        algebra, whole = self.algebra, linear_form(expression)
        if whole is None or not self._is_angle(whole) or not algebra.adds_constant(whole):
            return algebra.sin_cos_of(self(expression))
        s, c = algebra.sin_cos(LinearForm(whole.coefficients, whole.turns))
        fixed = algebra.sin_cos_of(algebra.number(whole.constant))
        sine = algebra.times(s, fixed[1]) + algebra.times(c, fixed[0])
        return algebra.reduce(sine), algebra.reduce(algebra.times(c, fixed[1]) - algebra.times(s, fixed[0]))

    def _angle_form(self, expression: Expression) -> LinearForm | None:
        """None for an angle of its own: a number that is no multiple of pi, a rate, anything not linear."""
        form = linear_form(expression)
        return None if form is None or form.constant or not self._is_angle(form) else form

    @staticmethod
    def _is_angle(form: LinearForm) -> bool:
        """No rates in it: the sine of a velocity is that of a plain value."""
        return not any(is_rate(name) for name, _ in form.coefficients)

    def _value(self, expression: Expression) -> S:
        algebra = self.algebra
        match expression:
            case Number(value):
                return algebra.number(value)
            case Name(name):
                return self._named(name)
            case Negative(operand):
                return -self(operand)
            case Operation("+", left, right):
                return self(left) + self(right)
            case Operation("-", left, right):
                return self(left) - self(right)
            case Operation("*", left, right):
                return algebra.times(self(left), self(right))
            case Operation("/", left, right):
                return algebra.times(self(left), algebra.reciprocal(self(right)))
            case Operation("**", base, exponent):
                return self._power(base, exponent)
            case Call(_, argument, table=Table() as table, order=order):
                return self._tabulated(table, order, self(argument))
            case Call("sqrt", argument):
                return algebra.square_root(self(argument))
            case Call("sin", argument):
                return self.angle(argument)[0]
            case Call("cos", argument):
                return self.angle(argument)[1]
            case Call("tan", argument):
                sine, cosine = self.angle(argument)
                return algebra.times(sine, algebra.reciprocal(cosine))
            case Call("step", argument):
                return self._step(self(argument))
            case Call("pulse", argument, more=(start, end)):
                return self._step(self(argument) - self(start)) - self._step(self(argument) - self(end))
            case Call(function, argument):
                return algebra.function(function, self(argument))
        raise TypeError(f"not an expression: {expression!r}")

    def _tabulated(self, table: Table, order: int, x: S) -> S:
        """f(x), where it is one polynomial as that; a table that is zero outside is one that holds, less its ends."""
        algebra, name = self.algebra, curve_name(table, order)
        polynomial = name.curve.polynomial
        if polynomial is None:
            value = algebra.function(name, x)
        else:
            value, u = algebra.zero, x - algebra.number(name.curve.bases[0])
            for coefficient in reversed(polynomial):
                value = algebra.times(value, u) + algebra.number(coefficient)
        if order == 0 and table.jumps:
            (first, start), (last, end) = table.points[0], table.points[-1]
            value = value - algebra.times(algebra.number(start), self._step(algebra.number(first) - x))
            value = value - algebra.times(algebra.number(end), self._step(x - algebra.number(last)))
        return value

    def _step(self, x: S) -> S:
        """(1 + sign x)/2."""
        half = self.algebra.number(Fraction(1, 2))
        return half + self.algebra.times(half, self.algebra.function("sign", x))

    def _named(self, name: str) -> S:
        try:
            return self.environment[name]  # some environments make their values when they are asked for
        except KeyError:
            raise NoValue(name) from None

    def _power(self, base: Expression, exponent: Expression) -> S:
        form = linear_form(exponent)
        if form is None or not form.is_constant:
            raise NoClosedForm("a power whose exponent is not a number")
        value = form.constant
        if value.denominator == 1:
            return self.algebra.power(self(base), value.numerator)
        if value.denominator == 2:
            return self.algebra.power(self.algebra.square_root(self(base)), value.numerator)
        raise NoClosedForm("the power [[value]]: only whole and half exponents are supported", value=value)


def _label(expression: Expression) -> Any:
    """What an expression is, its operands apart."""
    match expression:
        case Number(value):
            return value
        case Name(name):
            return name
        case Operation(operator, _, _):
            return operator
        case Call(function, _, table=table, order=order):
            return function if table is None else (table, order)
    return None
