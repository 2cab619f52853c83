"""Claims about periodic solutions in powers of a small parameter, and about slow manifolds.

The coefficient of eps^n of a variable x, or of an expression in variables, is compared with what problem 12 derives:

    x = sum_n eps^n x_n(phase),      phase' = sum_n eps^n w_n

in the symbols of the derived solution (``mbsym oscillations``): its amplitude, its constants at the phase 0, and
parameters and variables with the powers of eps taken out that the description gives them.  The difference is decided
in the field of these coefficients.  A solution may be written with another amplitude, other constants or another
phase: a difference that such a choice can explain (``other_symbols``) leaves the claim undecided.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations_with_replacement
from random import Random
from typing import Protocol

from flint import nmod_mat

from mbsym.algebra.failures import Failure, NoClosedForm, SingularPoint
from mbsym.algebra.quotients import Quotient
from mbsym.algebra.signs import Signs
from mbsym.algebra.terms import modulo
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower
from mbsym.expressions.angles import linear_form
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, rewritten
from mbsym.formulas.formula import Formula
from mbsym.model.claims import Claim
from mbsym.model.system import System
from mbsym.problems.claims.comparison import decided
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome, in_parameters
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.small_parameter.oscillations import AMPLITUDE
from mbsym.problems.small_parameter.result import Amplitude, Harmonics, Oscillation, SlowManifold
from mbsym.problems.vector_field import Transfer

# Whether a formula of another form may be the same periodic solution with its symbols chosen otherwise.
#
# One solution x = sum eps^n x_n(T; a) is written with many amplitudes, constants a and phases T.  With
#
#     a -> a + eps a_1 + eps^2 a_2 + ...,      T -> T + eps T_1 + ...
#
# the coefficient x_n changes by sums of derivatives  d^m x_j / da^m  with j + |m| <= n, 0 < |m|, times factors that are
# free of the phase; T may be counted from another quarter, or backwards, besides.  A difference outside of the space
# that these derivatives span is no matter of symbols.  Ranks are found modulo a prime at random points.


PRIME = (1 << 61) - 1
_POINTS, _TRIALS = 2, 400


def explained(oscillation: Oscillation, series: Sequence[Harmonics], order: int, claimed: Harmonics) -> bool:
    """Whether other symbols may make ``claimed`` of series[order]; true where that cannot be excluded."""
    if same_size(series[order], claimed) and any(claimed.waves):
        return True
    try:
        shifts = list(_shifts(oscillation, series, order))
    except Failure:
        return True
    variants = _VARIANTS if any(any(harmonics.waves) for harmonics in series[: order + 1]) else _VARIANTS[:1]
    for variant in variants:
        difference = claimed - _varied(series[order], *variant)
        if difference.is_zero or _in_span(
            oscillation.tower, [_varied(shift, *variant) for shift in shifts], difference
        ):
            return True
    return False


def same_size(harmonics: Harmonics, other: Harmonics) -> bool:
    """Whether all harmonics have the same squares of amplitudes: T may begin anywhere."""
    if harmonics.waves.keys() != other.waves.keys():
        return False
    for k, (c, s) in harmonics.waves.items():
        d, t = other.waves[k]
        if not (c - d if k == 0 else c * c + s * s - d * d - t * t).is_zero():
            return False
    return True


#: Quarters of a turn, and the direction, of T.
_VARIANTS = tuple((quarter, sense) for sense in (1, -1) for quarter in range(4))


def _varied(x: Harmonics, quarter: int, sense: int) -> Harmonics:
    """x(sense T + quarter pi/2)."""
    waves = {}
    for k, (c, s) in x.waves.items():
        turn = k * quarter % 4
        # c cos(y + turn pi/2) + s sin(y + turn pi/2)
        c, s = ((c, s), (s, -c), (-c, -s), (-s, c))[turn]
        waves[k] = (c, s if sense > 0 else -s)
    return Harmonics(x.tower, waves)


def _shifts(oscillation: Oscillation, series: Sequence[Harmonics], order: int) -> Iterator[Harmonics]:
    """d^m x_j / da^m with j + |m| <= order."""
    symbols: list[str | None] = [AMPLITUDE] if oscillation.kind is Amplitude.FREE else []
    symbols += [f"#{name}" for name, _ in oscillation.constants]
    symbols.append(None)  # the phase
    for j in range(order):
        for size in range(1, order - j + 1):
            for chosen in combinations_with_replacement(symbols, size):
                shift = series[j]
                for symbol in chosen:
                    shift = shift.slope() if symbol is None else shift.mapped(lambda x, by=symbol: _derivative(x, by))
                if not shift.is_zero:
                    yield shift


def _derivative(x: Element, name: str) -> Element:
    tower = x.tower
    if x.is_zero():
        return x
    place = MOST_ROOTS + tower.parameters.index(name)
    top, bottom, unit = x.top, x.bottom, tower.context.constant(1)
    below = tower.made(bottom.derivative(place), unit)
    slope = tower.made(top.derivative(place), unit)
    for k, square in enumerate(tower.squares):
        held = top.derivative(MOST_ROOTS - 1 - k)
        if held != 0:
            root = tower.made(tower.context.gens()[MOST_ROOTS - 1 - k], unit)
            inner = _derivative(tower.made(square, unit), name)
            slope = slope + tower.made(held, unit) * inner / (root * tower.number(2))
    return (slope - x * below) / tower.made(bottom, unit)


def _in_span(tower: Tower, span: Sequence[Harmonics], x: Harmonics) -> bool:
    """Whether x = sum c_i span_i with c_i free of the phase; true where no point shows the contrary."""
    places = sorted({(k, side) for summand in (*span, x) for k in summand.waves for side in (0, 1)})
    if not span:
        return x.is_zero
    for values in _points(tower):
        rows = []
        try:
            for harmonics in (*span, x):
                rows.append([_at(harmonics.wave(k)[side], values) for k, side in places])
        except ZeroDivisionError:
            continue
        if _rank(rows) > _rank(rows[:-1]):
            return False
    return True


def _rank(rows: Sequence[Sequence[int]]) -> int:
    return int(nmod_mat(len(rows), len(rows[0]), [x for row in rows for x in row], PRIME).rank())


def _points(tower: Tower) -> Iterator[list[int]]:
    """Random values of all generators modulo the prime, roots with their squares."""
    random, there = Random(20240229), 0
    for _ in range(_TRIALS):
        values = [0] * MOST_ROOTS + [random.randrange(1, PRIME) for _ in tower.parameters]
        for k, square in enumerate(tower.squares):
            root = _root(modulo(square, values, PRIME))
            if root is None:
                break
            values[MOST_ROOTS - 1 - k] = root
        else:
            there += 1
            yield values
        if there == _POINTS:
            return


def _root(square: int) -> int | None:
    """Modulo the prime, which is 3 modulo 4."""
    root = pow(square, (PRIME + 1) // 4, PRIME)
    return root if root * root % PRIME == square else None


def _at(x: Element, values: Sequence[int]) -> int:
    below = modulo(x.bottom, values, PRIME)
    if below == 0:
        raise ZeroDivisionError
    return modulo(x.top, values, PRIME) * pow(below, -1, PRIME) % PRIME


#: The kinds of claim that this is about.
OSCILLATION, FREQUENCY, MANIFOLD = "oscillation", "oscillation frequency", "slow manifold"

#: A difference of more terms is not shown.
MOST_SHOWN = 40

_OTHER_SYMBOLS = "with another amplitude, other constants or another phase it may hold: these are free to choose"
_NOT_SURE = "with square roots in it the difference is not told from zero"


class SolutionInRing(Protocol):
    """A solution with the ring in which it is told; ``symbols``: their names there by those in the solution."""

    @property
    def oscillation(self) -> Oscillation: ...
    @property
    def phase(self) -> str: ...
    @property
    def symbols(self) -> Mapping[str, str]: ...

    def formula(self, x: Element) -> Formula: ...
    def wave(self, harmonics: Harmonics) -> Formula: ...


class ToldManifold(Protocol):
    """A slow manifold with the ring in which it is told."""

    @property
    def manifold(self) -> SlowManifold: ...
    @property
    def transfer(self) -> Transfer: ...

    def formula(self, c: Quotient) -> Formula: ...


def examined(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """One claim of these kinds.  Raises NoClosedForm, Unavailable where there is nothing to compare it with."""
    if claim.kind == MANIFOLD:
        return _on_manifold(derived, claim, about)
    ring = derived.claimed_oscillation
    formulas = _formulas(derived.system, ring)
    try:
        claimed = formulas(claim.equals)
    except SingularPoint:
        raise NoClosedForm("the claimed formula divides by zero") from None
    series = _frequencies(ring.oscillation) if claim.kind == FREQUENCY else _series(ring, formulas, claim.of_expression)
    truth = series[claim.order]
    result = ClaimResult(claim, about, Outcome.EXACT, ring.wave(truth))
    difference = claimed - truth
    if difference.is_zero:
        return result
    shown = ring.wave(difference)
    result = replace(result, difference=shown if shown.terms <= MOST_SHOWN else None)
    if not _surely_nonzero(difference):
        return replace(result, outcome=Outcome.UNDECIDED, remark=_NOT_SURE)
    if explained(ring.oscillation, series, claim.order, claimed):
        return replace(result, outcome=Outcome.UNDECIDED, remark=_OTHER_SYMBOLS)
    factor = _factor(ring.oscillation.tower, claimed, truth)
    if factor is not None:
        return replace(result, outcome=Outcome.SCALED, factor=ring.formula(factor), difference=None)
    return replace(result, outcome=Outcome.DIFFERS, remark=_where(difference, ring.phase, shown.terms))


def _where(difference: Harmonics, phase: str, terms: int) -> str:
    """The harmonics that differ: a difference of very many terms tells less."""
    differing = []
    for k, pair in sorted(difference.waves.items()):
        angle = phase if k == 1 else f"{k}*{phase}"
        differing += [
            f"{wave}({angle})" if k else "1" for wave, c in zip(("cos", "sin"), pair, strict=True) if not c.is_zero()
        ]
    if not any(difference.waves):
        return Message("by [[terms]] terms", terms=terms) if terms > MOST_SHOWN else ""
    names = ", ".join(differing)
    if terms > MOST_SHOWN:
        return Message("in what stands before [[names]]: [[terms]] terms", names=names, terms=terms)
    return Message("in what stands before [[names]]", names=names)


def _formulas(system: System, solution: SolutionInRing) -> WaveFormulas:
    tower = solution.oscillation.tower
    known = {name: tower.parameter(name) for name in system.parameter_names if name in tower.parameters}
    constants = {f"#{name}": value for name, value in solution.oscillation.constants}
    for internal, shown in solution.symbols.items():
        known[shown] = constants.get(internal, solution.oscillation.amplitude)
    defined: dict[str, Expression] = {relation.name: relation.value for relation in system.relations}
    defined |= {notation.name: notation.value for notation in system.notation}
    defined |= {abbreviation.name: abbreviation.value for abbreviation in system.abbreviations}
    signs = {parameter.name: parameter.sign for parameter in system.parameters} | {AMPLITUDE: "positive"}
    return WaveFormulas(tower, solution.phase, known, defined, signs)


def _frequencies(oscillation: Oscillation) -> list[Harmonics]:
    """w_n of the rate of the phase."""
    values = [oscillation.frequency, *(oscillation.frequency * x for x in oscillation.corrections)]
    return [Harmonics.constant(oscillation.tower, x) for x in values]


def _series(solution: SolutionInRing, formulas: WaveFormulas, of: Expression | None) -> Sequence[Harmonics]:
    """The coefficients of powers of eps of an expression in variables."""
    assert of is not None
    return _InVariables(solution, formulas).series(of)[1]


def series_of(system: System, solution: SolutionInRing, expression: Expression) -> tuple[int, Sequence[Harmonics]]:
    """(m, c) with  expression = eps^m sum_n eps^n c[n],  n <= order, of an expression in variables and parameters.

    Divisors and what stands under roots have to be constant and not zero where eps = 0; the root of the square of the
    amplitude is the amplitude.  Raises NoClosedForm where there is no such series.
    """
    return _InVariables(solution, _formulas(system, solution), mixed=True).series(expression)


class _InVariables:
    """Values of expressions in the variables: the power of eps that is taken out, and the coefficients from it on.

    Terms of a sum have to have the same power: else nobody can say which coefficient is meant.  ``mixed``: they need
    not, and the least is taken out.
    """

    def __init__(self, told: SolutionInRing, formulas: WaveFormulas, mixed: bool = False) -> None:
        oscillation = told.oscillation
        self.oscillation, self.formulas, self.mixed = oscillation, formulas, mixed
        self.powers = dict(oscillation.powers)
        self.waves = dict(zip(oscillation.names, oscillation.series, strict=True))

    def series(self, expression: Expression) -> tuple[int, Sequence[Harmonics]]:
        oscillation = self.oscillation
        match expression:
            case Name(name) if name in self.waves:
                return self.powers.get(name, 0), self.waves[name]
            case Name(name) if any(drift.variable == name for drift in oscillation.drifts):
                raise NoClosedForm("[[name]] may drift: its oscillation is not compared", name=name)
            case Negative(operand):
                power, inner = self.series(operand)
                return power, [harmonics.scaled(-oscillation.tower.one) for harmonics in inner]
            case Operation("+" | "-" as operator, left, right):
                (power, first), (other, second) = self.series(left), self.series(right)
                least, zero = min(power, other), Harmonics(oscillation.tower, {})
                if power != other and not self.mixed:
                    raise NoClosedForm(
                        "terms with different powers of [[small]] in one sum: not compared", small=oscillation.small
                    )
                first, second = ([*[zero] * (m - least), *x][: len(x)] for m, x in ((power, first), (other, second)))
                return least, [x + y if operator == "+" else x - y for x, y in zip(first, second, strict=True)]
            case Operation("*", left, right):
                return self._product(self.series(left), self.series(right))
            case Operation("**", base, Number(exponent)) if exponent.denominator == 1 and 0 < exponent < 10:
                power, factor = total = self.series(base)
                for _ in range(int(exponent) - 1):
                    total = self._product(total, (power, factor))
                return total
            case Operation("/", left, right):
                return self._quotient(self.series(left), self.series(right))
            case Call("sqrt", argument):
                return self._root(self.series(argument))
            case Number() | Name():
                zero = Harmonics(oscillation.tower, {})
                return self._power_of(expression), [self.formulas(expression), *([zero] * oscillation.order)]
        raise NoClosedForm("an expression that is not compared with expansions")

    def _product(
        self, left: tuple[int, Sequence[Harmonics]], right: tuple[int, Sequence[Harmonics]]
    ) -> tuple[int, Sequence[Harmonics]]:
        product = [Harmonics(self.oscillation.tower, {})] * (self.oscillation.order + 1)
        for i, x in enumerate(left[1]):
            for j, y in enumerate(right[1][: len(product) - i]):
                product[i + j] = product[i + j] + x * y
        return left[0] + right[0], product

    def _quotient(
        self, numerator: tuple[int, Sequence[Harmonics]], denominator: tuple[int, Sequence[Harmonics]]
    ) -> tuple[int, Sequence[Harmonics]]:
        """q with  d_0 q_n = c_n - sum_(k>0) d_k q_(n-k)."""
        inverse = self.oscillation.tower.reciprocal(self._first(denominator[1]))
        quotient: list[Harmonics] = []
        for n, x in enumerate(numerator[1]):
            for k in range(1, n + 1):
                x = x - denominator[1][k] * quotient[n - k]
            quotient.append(x.scaled(inverse))
        return numerator[0] - denominator[0], quotient

    def _root(self, radicand: tuple[int, Sequence[Harmonics]]) -> tuple[int, Sequence[Harmonics]]:
        """s with  2 s_0 s_n = c_n - sum_(0<k<n) s_k s_(n-k),  s_0^2 = c_0, rather the amplitude than less it."""
        power, series = radicand
        tower = self.oscillation.tower
        if power % 2:
            raise NoClosedForm("a root of an odd power of [[small]]", small=self.oscillation.small)
        first = self._first(series)
        root = (
            self.oscillation.amplitude
            if (first - self.oscillation.amplitude * self.oscillation.amplitude).is_zero()
            else None
        )
        coefficients = [Harmonics.constant(tower, self.formulas.square_root(first) if root is None else root)]
        inverse = tower.reciprocal(coefficients[0].mean + coefficients[0].mean)
        for n in range(1, len(series)):
            x = series[n]
            for k in range(1, n):
                x = x - coefficients[k] * coefficients[n - k]
            coefficients.append(x.scaled(inverse))
        return power // 2, coefficients

    def _first(self, series: Sequence[Harmonics]) -> Element:
        """The value where eps = 0 of what is divided by, or stands under a root."""
        if any(k for k in series[0].waves):
            raise NoClosedForm("division by, or a root of, what changes with the phase: not compared")
        if series[0].is_zero:
            raise NoClosedForm(
                "what is divided by, or stands under a root, is 0 where [[small]] = 0", small=self.oscillation.small
            )
        return series[0].mean

    def _power_of(self, constant: Expression) -> int:
        match constant:
            case Number():
                return 0
            case Name(name) if name not in self.formulas.defined:
                return self.powers.get(name, 0)
        raise NoClosedForm("a factor that is no number and no parameter: not compared with expansions")


def _surely_nonzero(x: Harmonics) -> bool:
    """Whether some coefficient is not zero, whatever its square roots are."""
    for c in (c for pair in x.waves.values() for c in pair if not c.is_zero()):
        try:
            x.tower.reciprocal(c)
        except Failure:
            continue
        return True
    return False


def _factor(tower: Tower, claimed: Harmonics, truth: Harmonics) -> Element | None:
    """The number q with claimed = q truth; None where there is none."""
    if claimed.is_zero or truth.is_zero or claimed.waves.keys() != truth.waves.keys():
        return None
    k = min(truth.waves)
    top, bottom = next(
        (x, y) for x, y in zip(claimed.waves[k], truth.waves[k], strict=True) if not (x.is_zero() and y.is_zero())
    )
    if bottom.is_zero():
        return None
    try:
        factor = top / bottom
    except Failure:
        return None
    if not factor.top.is_constant() or not factor.bottom.is_constant():
        return None
    return factor if (claimed - truth.scaled(factor)).is_zero else None


def _on_manifold(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """The coefficient of eps^n of a fast variable on the slow manifold, or of the rate of a slow one there."""
    told_manifold = derived.claimed_manifold
    manifold = told_manifold.manifold
    names, series = (manifold.fast, manifold.functions) if claim.of in manifold.fast else (manifold.slow, manifold.flow)
    if claim.of not in names:
        raise NoClosedForm("[[of]] is neither fast nor slow there", of=claim.of)
    expansion = series[names.index(claim.of)]
    if expansion.known is not None and claim.order >= expansion.known:
        raise NoClosedForm(
            "the coefficient of [[small]]^[[order]] is not known", small=manifold.field.small, order=claim.order
        )
    coefficient = expansion.coefficients.get(claim.order)
    ring = told_manifold.transfer.ring
    truth = ring.zero if coefficient is None else told_manifold.formula(coefficient).polynomial
    claimed = in_parameters(derived, Symbols.of(derived).polynomial(derived.parameters_scene, claim))
    if told_manifold.transfer.images:
        claimed = ring.substitute(claimed, told_manifold.transfer.images)
    difference = ring.reduce(claimed - truth)
    result = ClaimResult(claim, about, Outcome.EXACT, Formula(ring, truth))
    known = derived.form.vanishes(difference)
    if known is True:
        return result
    if not derived.system.speeds or manifold.root is not None:  # a square root may be written with squares in it
        outcome, where = decided(derived, difference)
    else:
        outcome, where = Outcome.DIFFERS if known is False else Outcome.UNDECIDED, ""
    return replace(
        result, outcome=outcome, where=where, difference=None if outcome == Outcome.EXACT else Formula(ring, difference)
    )


# Formulas of claims as trigonometric polynomials of a phase, over the numbers in which a solution is told.


#: Powers and harmonics beyond are not formed.
MOST_POWER, MOST_HARMONIC = 24, 60


class WaveFormulas:
    """Values of expressions.  ``known`` names have values, ``defined`` ones stand for an expression.

    ``signs`` of parameters of the tower, where they are declared.  Raises NoClosedForm for what is no trigonometric
    polynomial of the phase with such coefficients.
    """

    def __init__(
        self,
        tower: Tower,
        phase: str,
        known: Mapping[str, Element],
        defined: Mapping[str, Expression],
        signs: Mapping[str, str],
    ) -> None:
        declared = (*["positive"] * MOST_ROOTS, *(signs.get(name, "real") for name in tower.parameters))
        self.signs = Signs(tower.context, declared)
        self.tower, self.phase = tower, phase
        self.defined = defined
        self._values = {name: Harmonics.constant(tower, x) for name, x in known.items()}

    def __call__(self, expression: Expression) -> Harmonics:
        match expression:
            case Number(value):
                return self._constant(self.tower.number(value))
            case Name(name):
                return self._named(name)
            case Negative(operand):
                return self(operand).scaled(-self.tower.one)
            case Operation("+", left, right):
                return self(left) + self(right)
            case Operation("-", left, right):
                return self(left) - self(right)
            case Operation("*", left, right):
                return self._product(self(left), self(right))
            case Operation("/", left, right):
                return self(left).scaled(self.tower.reciprocal(self.constant(right)))
            case Operation("**", base, exponent):
                return self._power(self(base), exponent)
            case Call("sqrt", argument):
                return self._constant(self.square_root(self.constant(argument)))
            case Call("sin" | "cos" as function, argument):
                return self._wave(function, argument)
            case Call(function, _):
                raise NoClosedForm("[[function]] in the coefficient of an expansion: not compared", function=function)
        raise NoClosedForm("an expression that is not compared with expansions")

    def square_root(self, x: Element) -> Element:
        """The root whose factors are positive beside the roots of the tower.  Raises NoClosedForm of unknown signs."""
        root = self.tower.square_root(x)
        places = [k for k, degree in enumerate(root.top.degrees()[:MOST_ROOTS]) if degree > 0]
        outside = root.top / root.top.context().gen(places[0]) if len(places) == 1 else root.top
        sign = self.signs.sign(outside)
        if self.signs.sign(root.bottom) == "negative":
            root = -root
        if sign in ("positive", "nonnegative", "zero"):
            return root
        if sign in ("negative", "nonpositive"):
            return -root
        raise NoClosedForm("a square root of the square of a quantity of unknown sign: not compared")

    def constant(self, expression: Expression) -> Element:
        """The value of what does not hold the phase."""
        value = self(expression)
        if any(k for k in value.waves):
            raise NoClosedForm("division by what changes with the phase: not compared with expansions")
        return value.mean

    def _constant(self, value: Element) -> Harmonics:
        return Harmonics.constant(self.tower, value)

    def _named(self, name: str) -> Harmonics:
        if name not in self._values:
            if name not in self.defined:
                what = "it is no constant of the solution" if name != self.phase else "it stands outside of sin and cos"
                raise NoClosedForm("[[name]] is not in the solution: [[what]]", name=name, what=what)
            self._values[name] = self(self.defined[name])
        return self._values[name]

    def _product(self, harmonics: Harmonics, other: Harmonics) -> Harmonics:
        if max((*harmonics.waves, 0)) + max((*other.waves, 0)) > MOST_HARMONIC:
            raise NoClosedForm("a harmonic beyond [[most]]", most=MOST_HARMONIC)
        return harmonics * other

    def _power(self, base: Harmonics, exponent: Expression) -> Harmonics:
        form = linear_form(exponent)
        power = form.constant if form is not None and form.is_constant else None
        if power is None or power.denominator not in (1, 2) or abs(power) > MOST_POWER:
            raise NoClosedForm("a power that is no whole or half number: not compared with expansions")
        if power.denominator == 2 or power < 0:
            if any(k for k in base.waves):
                raise NoClosedForm("division by, or a root of, what changes with the phase: not compared")
            value = base.mean
            if power.denominator == 2:
                value, power = self.square_root(value), power * 2
            base = self._constant(self.tower.reciprocal(value) if power < 0 else value)
        harmonics = self._constant(self.tower.one)
        for _ in range(abs(int(power))):
            harmonics = self._product(harmonics, base)
        return harmonics

    def _wave(self, function: str, argument: Expression) -> Harmonics:
        """sin or cos of k phase + m pi/2."""
        form = linear_form(self._opened(argument))
        times = dict(form.coefficients) if form is not None else {}
        k = times.pop(self.phase, Fraction(0))
        if form is None or times or form.constant or k.denominator != 1 or (2 * form.turns).denominator != 1:
            raise NoClosedForm("an angle that is no multiple of the phase and of pi/2: not compared with expansions")
        if abs(k) > MOST_HARMONIC:
            raise NoClosedForm("a harmonic beyond [[most]]", most=MOST_HARMONIC)
        quarters = int(2 * form.turns) - (function == "sin")  # sin x = cos(x - pi/2)
        c, s = ((1, 0), (0, -1), (-1, 0), (0, 1))[quarters % 4]  # cos(k T + quarters pi/2) = c cos(k T) + s sin(k T)
        n = int(k)
        number = self.tower.number
        if n == 0:
            return self._constant(number(c))
        return Harmonics(self.tower, {abs(n): (number(c), number(s if n > 0 else -s))})

    def _opened(self, expression: Expression) -> Expression:
        """What stands for an angle, in the phase."""
        defined = self.defined
        return rewritten(
            expression, lambda x: self._opened(defined[x.name]) if isinstance(x, Name) and x.name in defined else None
        )
