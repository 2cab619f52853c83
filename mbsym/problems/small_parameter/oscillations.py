"""Poincare's and Lindstedt's method from the graded equations to a result: amplitudes found, everything checked.

Of several phases all amplitudes are free, or there is no result.  Periodic solutions are a family with a free
amplitude, or secular terms leave in some order m a condition P(a) = 0; then the corrections of the amplitude follow
from the orders m + 1, m + 2, ..., in which they stand linearly.  One of the real roots a != 0 of P is taken; the
others, and factors of P that square roots do not solve, are named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from dataclasses import field as dataclass_field
from typing import Any

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.terms import coefficients_in
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower
from mbsym.expressions.message import Message, joined
from mbsym.problems.small_parameter.checks import oscillation_orders
from mbsym.problems.small_parameter.generating import Generating, Mode, Rows, generating
from mbsym.problems.small_parameter.lindstedt import Demand, Led, NotPeriodic, Orders
from mbsym.problems.small_parameter.result import Amplitude, Harmonics, Oscillation, Phase

#: A condition on the amplitude may first appear in this order.
LATEST = 4
#: Names of the tower that no description can hold.
AMPLITUDE = "#amplitude"


def amplitude_symbol(place: int) -> str:
    """Of the phase with that place: the first is ``AMPLITUDE``."""
    return AMPLITUDE if not place else f"{AMPLITUDE} of {place}"


def correction_names(order: int) -> tuple[str, ...]:
    """Symbols of unknown terms of the amplitude, which no result holds."""
    return tuple(f"#amplitude {k}" for k in range(1, order + LATEST + 1))


def tower_over(
    parameters: Sequence[str], variables: Sequence[str], order: int, others: Sequence[str] = (), phases: int = 1
) -> Tower:
    """Parameters, the amplitudes, corrections of one, a constant value ``#x`` of every variable x.

    ``others``: parameters that no equation holds, for what results are compared with.
    """
    amplitudes = map(amplitude_symbol, range(phases))
    return Tower((*parameters, *amplitudes, *(f"#{name}" for name in variables), *correction_names(order), *others))


def _together(names: Sequence[str], frequencies: int) -> str:
    """The variables that share frequencies, and how many these are where there are several."""
    listed = ", ".join(names)
    return listed if frequencies == 1 else Message("[[names]] ([[count]] of them)", names=listed, count=frequencies)


class ModeIsOpen(NoClosedForm):
    """Several variables oscillate with frequencies of their own, and none was named."""

    code = "several-modes"

    def __init__(self, blocks: Sequence[tuple[str, ...]]) -> None:
        self.blocks = tuple(blocks)
        counts = Counter(self.blocks)
        message = joined((_together(block, n) for block, n in counts.items()), "; ")
        remedy = Message(
            "name a variable whose oscillation leads, or several, of which each does: --of NAME,NAME, or "
            "'leading: NAME' under the small parameter"
        )
        if max(counts.values(), default=0) > 1:
            which = Message("say which of the frequencies that variables share: --frequency K")
            remedy = which if len(counts) == 1 else joined((remedy, which), "; ")
        super().__init__(
            Message("without the small parameter several frequencies are there, of: [[told]]", told=message),
            remedy=remedy,
        )


@dataclass(frozen=True)
class Equations:
    """x' = sum_k eps^k rows[k](x) over a tower, known up to eps^most; ``told`` writes an element for a person.

    ``values``: numbers for amplitudes and for constants, by their symbols.
    """

    tower: Tower
    small: str
    names: tuple[str, ...]
    rows: Rows
    powers: tuple[tuple[str, int], ...]
    positions: tuple[str, ...]
    told: Callable[[Element], str]
    most: int = 99
    values: Mapping[str, Element] = dataclass_field(default_factory=dict)
    #: "positive" or "negative" where the sign of an element is known, else None.
    sign: Callable[[Element], str | None] = lambda x: None

    def symbol(self, name: str) -> Element:
        """A symbol of the tower, or its number."""
        return self.values.get(name, self.tower.parameter(name))


def oscillation(there: Equations, order: int, leading: Sequence[str] = (), which: int = 1) -> Oscillation:
    """The solution with a phase for each of the variables that are ``leading``, or for the only one that can be.

    The first has the ``which``-th frequency of its block, others the first that is left of theirs.

    Raises NoClosedForm where the equations are not quasi-linear or several frequencies are there, Resonance and
    NotPeriodic where there is no such solution.
    """
    tower = there.tower
    system = generating(tower, there.names, there.rows, lambda i: there.symbol(f"#{there.names[i]}"))
    modes: list[Mode] = []
    for name in leading or [""]:
        modes.append(_mode(there, system, name, 1 if modes else which, modes))
    places = [there.names.index(name) for name in leading] or [_leading(there, modes[0])]
    constants = {i: there.symbol(f"#{there.names[i]}") for i in system.constant}
    kind, others = Amplitude.FREE, None

    def begun(amplitudes: Sequence[Element], corrections: Sequence[str] = ()) -> Orders:
        led = [Led(system, *phase) for phase in zip(modes, places, amplitudes, strict=True)]
        return Orders(system, led, constants, corrections)

    symbols = [amplitude_symbol(k) for k in range(len(modes))]
    orders = begun([tower.parameter(name) for name in symbols])
    try:
        for _ in range(order):
            orders.go_on()
    except Demand as demand:
        if len(modes) > 1:
            raise NotPeriodic(
                "in the order [[order]] of [[small]] secular terms remain but for certain amplitudes: of several "
                "phases these are not looked for",
                order=demand.order,
                small=there.small,
            ) from None
        if order + demand.order > there.most:
            raise _secular(there, demand.order, _but_powers(tower, demand)) from None
        amplitude, others = _determined(there, there.names[places[0]], demand)
        kind = Amplitude.DETERMINED
        orders = begun([amplitude], correction_names(order))
        _with_corrections(there, orders, order, demand.order)
    else:
        if there.values.keys() & {*symbols}:
            amplitudes = list(map(there.symbol, symbols))
            if any(x.is_zero() for x in amplitudes):
                raise ZeroDivisionError("an amplitude of 0 is no oscillation")
            orders = begun(amplitudes)
            for _ in range(order):
                orders.go_on()
    names = [i for i in range(len(there.names)) if i not in system.aside]
    solution = Oscillation(
        tower,
        there.small,
        order,
        tuple(there.names[i] for i in names),
        there.powers,
        tuple(
            Phase(
                there.names[led.leading],
                tuple(there.names[i] for i in led.mode.block),
                led.frequency,
                tuple(led.shifts[:order]),
                led.amplitude,
            )
            for led in orders.phases
        ),
        kind,
        tuple((there.names[i], constants[i]) for i in system.constant),
        tuple(tuple(orders.series[i][: order + 1]) for i in names),
        tuple(orders.quadratures(order)),
        tuple(divisor for divisor in orders.divisors if divisor.order <= order),
        tuple(
            (tuple(there.names[i] for i in other_mode.block), other_mode.square)
            for other_mode in system.modes
            if not any(other_mode is mode for mode in modes)
        ),
        damped=_named(there, system.damped),
        with_zero=_named(there, system.with_zero),
        not_known=_named(there, system.not_known),
        other_amplitudes=others,
    )
    return replace(
        solution,
        residuals=oscillation_orders(there.rows, there.names, solution),
        exponent=_exponent(there, solution, names),
    )


def _exponent(there: Equations, solution: Oscillation, names: Sequence[int]) -> tuple[int, Element] | None:
    """Poincare's characteristic exponent of a cycle of two variables: the mean of div X over the period, first term.

    The phase runs evenly, so that it is the mean over the phase of  sum_i dX_i/dx_i  on the series.  None of families,
    of more variables, and where it vanishes in all orders that are known.
    """
    if solution.kind is Amplitude.FREE or len(names) != 2 or solution.drifts:
        return None
    tower, series = solution.tower, dict(zip(names, solution.series, strict=True))
    harmonics = Harmonics.constant(tower, tower.one)
    total = [Harmonics(tower, {}) for _ in range(solution.order + 1)]
    for i in names:
        for k, terms in there.rows[i].items():
            for exponents, c in terms.items():
                if not exponents[i] or k > solution.order:
                    continue
                product = {k: harmonics.scaled(c * exponents[i])}
                for j in (place for place, e in enumerate(exponents) for _ in range(e - (place == i))):
                    product = _times(product, series[j], solution.order)
                for n, part in product.items():
                    total[n] = total[n] + part
    return next(((n, part.mean) for n, part in enumerate(total) if not part.mean.is_zero()), None)


def _times(a: Mapping[int, Harmonics], b: Sequence[Harmonics], most: int) -> dict[int, Harmonics]:
    """A product of series in eps, up to eps^most."""
    times: dict[int, Harmonics] = {}
    for n, x in a.items():
        for k, y in enumerate(b[: most - n + 1]):
            times[n + k] = times[n + k] + x * y if n + k in times else x * y
    return times


def _mode(there: Equations, system: Generating, leading: str, which: int, taken: Sequence[Mode]) -> Mode:
    """One that is not ``taken``."""
    if leading:
        own = [mode for mode in system.modes if there.names.index(leading) in mode.block]
    else:
        own = list(system.modes)
    if not own:
        open_blocks = [block for block in system.not_known if not leading or there.names.index(leading) in block]
        if open_blocks:
            names = ", ".join(there.names[i] for block in open_blocks for i in block)
            raise NoClosedForm(
                "without [[small]] the frequencies of [[names]] were not found as square roots",
                small=there.small,
                names=names,
                remedy="with numbers for parameters, where they factor: --set NAME=VALUE",
            )
        damped = [there.names[i] for block in system.damped for i in block]
        if damped:
            raise NotPeriodic(
                "no periodic solution near those of the linear system: without [[small]] no pair of "
                "imaginary roots was found for [[damped]]",
                small=there.small,
                damped=", ".join(damped),
            )
        if leading:
            raise NoClosedForm("[[name]] does not oscillate where the small parameter is zero", name=leading)
        raise NoClosedForm("nothing oscillates where the small parameter is zero")
    if len({mode.block for mode in own}) > 1 or (len(own) > 1 and not leading):
        raise ModeIsOpen([tuple(there.names[i] for i in mode.block) for mode in own])
    own = [mode for mode in own if not any(mode is other for other in taken)]
    if not own:
        raise NoClosedForm("all frequencies of [[name]] are taken by variables before it", name=leading)
    if which > len(own):
        single = "without the small parameter [[names]] have one frequency: there is none with the number [[which]]"
        more = (
            "without the small parameter [[names]] have [[count]] frequencies: there is none with the number [[which]]"
        )
        names = ", ".join(there.names[i] for i in own[0].block)
        if len(own) == 1:
            raise NoClosedForm(single, names=names, which=which)
        raise NoClosedForm(more, names=names, count=len(own), which=which)
    return own[which - 1]


def _named(there: Equations, blocks: Sequence[tuple[int, ...]]) -> tuple[tuple[str, ...], ...]:
    return tuple(tuple(there.names[i] for i in block) for block in blocks)


def _leading(there: Equations, mode: Mode) -> int:
    """The first position among the variables of a mode, if there is one."""
    return min(mode.block, key=lambda i: (there.names[i] not in there.positions, i))


def _determined(there: Equations, leading: str, demand: Demand) -> tuple[Element, Element | None]:
    """An amplitude a != 0 that a condition allows, rather one that is surely real; what the others make zero, if any.

    The condition holds for a and -a alike, which are one solution: its factors are taken by the squares of a.  Where a
    number was given for the amplitude, that one is asked.
    """
    tower, symbol, element = there.tower, there.tower.parameter(AMPLITUDE), there.values.get(AMPLITUDE)
    place = MOST_ROOTS + tower.parameters.index(AMPLITUDE)
    squares: list[Element] = []
    unsolved: list[Element] = []
    imaginary, of_parameters = False, tower.context.constant(1)
    for factor, _ in demand.condition.top.factor()[1]:
        if factor.degrees()[place] == 0:
            of_parameters = of_parameters * factor
        elif factor != tower.context.gens()[place]:
            factor_squares = _squares(there, _by_powers(tower, factor, place))
            if factor_squares is None:
                unsolved.append(tower.made(factor, tower.context.constant(1)))
            real = [x for x in factor_squares or () if there.sign(x) != "negative"]
            imaginary = imaginary or len(real) < len(factor_squares or ())
            squares += [x for x in real if not any((x - y).is_zero() for y in squares)]
    if not squares and imaginary and not unsolved and of_parameters.is_constant():
        if any(name != AMPLITUDE for name in there.values):
            raise NotPeriodic(
                "with the constants that were given secular terms are removed only where the amplitude of "
                "[[name]] is imaginary: its square is < 0",
                name=leading,
            )
        raise NotPeriodic(
            "secular terms are removed only where the amplitude of [[name]] is imaginary: its square is < 0",
            name=leading,
        )
    if not squares:
        raise _not_solved(there, demand) if unsolved else _secular(there, demand.order, of_parameters)
    chosen = next((x for x in squares if there.sign(x) == "positive"), squares[0])
    if element is not None:
        elements = [x for x in squares if (x - element * element).is_zero()]
        if not elements:
            raise _other_amplitude(there, demand)
        chosen = elements[0]
    rest = [symbol * symbol - x for x in squares if x is not chosen] + unsolved
    others = None
    for condition in rest:
        others = condition if others is None else others * condition
    return _positive_root(tower, chosen), others


def _by_powers(tower: Tower, p: Any, place: int) -> list[Element]:
    """The coefficients of the powers of a generator, from low to high."""
    return [tower.made(part, tower.context.constant(1)) for part in coefficients_in(p, place)]


def _squares(there: Equations, coefficients: Sequence[Element]) -> list[Element] | None:
    """a^2 for the roots a of a factor, without those that are surely complex; None where square roots do not do."""
    if len(coefficients) == 2:
        root = coefficients[0] / coefficients[1]
        return [root * root]
    if any(not c.is_zero() for c in coefficients[1::2]) or len(coefficients) > 5:
        return None
    low, middle = (c / coefficients[-1] for c in coefficients[:3:2])
    if len(coefficients) == 3:
        return [-low]
    half = middle / 2
    inside = half * half - low
    if there.sign(inside) == "negative":
        return []
    root = there.tower.square_root(inside)
    return [root - half, -root - half]


def _positive_root(tower: Tower, square: Element) -> Element:
    """The root, the positive one of a rational number."""
    root = tower.square_root(square)
    number = tower.rational(root)
    return -root if number is not None and number < 0 else root


def _not_solved(there: Equations, demand: Demand) -> NoClosedForm:
    return NoClosedForm(
        "in the order [[order]] of [[small]] secular terms remain unless [[condition]] = 0: "
        "amplitudes that square roots do not express are not followed",
        order=demand.order,
        small=there.small,
        condition=_condition(there, _but_powers(there.tower, demand)),
    )


def _other_amplitude(there: Equations, demand: Demand) -> NotPeriodic:
    return NotPeriodic(
        "with this amplitude secular terms remain in the order [[order]] of [[small]]: the amplitude "
        "has to fulfil [[condition]] = 0",
        order=demand.order,
        small=there.small,
        condition=_condition(there, _but_powers(there.tower, demand)),
    )


def _condition(there: Equations, top: Any) -> Any:
    """A polynomial as it is told, without a number for a factor."""
    return there.told(there.tower.made(top / top.factor()[0], there.tower.context.constant(1)))


def _secular(there: Equations, order: int, condition: Any) -> NoClosedForm:
    """No real amplitude a != 0 fulfils a condition without ``condition`` = 0, a polynomial without a.

    With constants of the solution in it that is an equation for these, which is not solved.
    """
    tower = there.tower
    none = Message("no periodic solution near those of the linear system")
    if any(name != AMPLITUDE for name in there.values):
        none = Message("no periodic solution near those of the linear system with the constants that were given")
    where = Message("in the order [[order]] of [[small]] secular terms remain", order=order, small=there.small)
    if condition.is_constant():
        return NotPeriodic("[[none]]: [[where]] for every real amplitude", none=none, where=where)
    formula = _condition(there, condition)
    degrees = zip(tower.parameters, condition.degrees()[MOST_ROOTS:], strict=True)
    if any(degree > 0 and name.startswith("#") for name, degree in degrees):
        return NoClosedForm(
            "[[where]] unless [[told]] = 0: values of variables that this determines are not found here",
            where=where,
            told=formula,
        )
    return NotPeriodic("[[none]]: [[where]] unless [[told]] = 0", none=none, where=where, told=formula)


def _but_powers(tower: Tower, demand: Demand) -> Any:
    """The numerator of a condition, divided by the powers of the amplitude that it holds as a factor."""
    p, amplitude = demand.condition.top, tower.context.gens()[MOST_ROOTS + tower.parameters.index(AMPLITUDE)]
    while p != 0 and divmod(p, amplitude)[1] == 0:
        p = divmod(p, amplitude)[0]
    return p


def _with_corrections(there: Equations, orders: Orders, order: int, first: int) -> None:
    """All orders; each correction of the amplitude from the condition in which it stands first."""
    tower, names = there.tower, orders.corrections
    if first > LATEST:
        raise NoClosedForm("a condition on the amplitude appears in the order [[first]] only", first=first)
    while orders.complete <= order + first:
        try:
            orders.go_on()
        except Demand as demand:
            for name in names:
                place = MOST_ROOTS + tower.parameters.index(name)
                top = demand.condition.top
                if top.degrees()[place] > 0:
                    break
            else:
                raise _secular(there, demand.order, _but_powers(tower, demand)) from None
            slope = top.derivative(place)
            if slope.degrees()[place] > 0:
                raise NoClosedForm("a correction of the amplitude does not stand linearly in its condition") from None
            images = list(tower.context.gens())
            images[place] = tower.context.constant(0)
            rest = top.compose(*images, ctx=tower.context)
            unit = tower.context.constant(1)
            _put(orders, place, tower.made(-rest, unit) / tower.made(slope, unit))


def _put(orders: Orders, place: int, value: Element) -> None:
    """A value in place of a symbol, everywhere; the order that was being made is made again."""
    tower = orders.tower
    images = list(tower.context.gens())
    images[place] = tower.context.constant(0)

    def change(x: Element) -> Element:
        if x.top.degrees()[place] <= 0:
            return x
        total = tower.zero
        for part in reversed(_by_powers(tower, x.top, place)):
            total = total * value + part
        return total / tower.made(x.bottom, tower.context.constant(1))

    for i, series in enumerate(orders.series):
        orders.series[i] = [x.mapped(change) for x in series[: orders.complete]]
    for led in orders.phases:
        led.shifts[:] = [change(x) for x in led.shifts[: orders.complete - 1]]
    orders.products.clear()
