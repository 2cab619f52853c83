"""Periodic solutions of a system near those of its linear part: its equations sorted by powers, the result as formulas.

Equations in speeds are a polynomial field; so are those in coordinates where only powers of these stand in them.  Where
all deviations from the unperturbed motion are small themselves, the field is their Taylor series.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import count, pairwise
from math import prod
from typing import TYPE_CHECKING, Any

from flint import acb

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import apart, evaluated, with_quotients
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower, angle_in
from mbsym.analysis.scaled import with_parameters
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import ZERO, Call, Expression, Negative, Operation
from mbsym.formulas.formula import Formula
from mbsym.formulas.letters import letters_as
from mbsym.mechanics.motion import relations
from mbsym.mechanics.variables import ring_environment
from mbsym.model.oscillation_names import names_in, oscillation_names
from mbsym.model.scaling import Scaling
from mbsym.model.system import SmallParameter, System, velocity_name
from mbsym.problems.claims.oscillations import series_of
from mbsym.problems.knowledge import signs
from mbsym.problems.normal_forms.dissipative import taylor_field
from mbsym.problems.normal_forms.exact import letter
from mbsym.problems.small_parameter.generating import graded_rows
from mbsym.problems.small_parameter.lindstedt import integrated
from mbsym.problems.small_parameter.oscillations import (
    AMPLITUDE,
    LATEST,
    Equations,
    amplitude_symbol,
    oscillation,
    tower_over,
)
from mbsym.problems.small_parameter.result import Amplitude, Divisor, Harmonics, Oscillation, Phase, multiples
from mbsym.problems.vector_field import vector_field

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


#: What the sign of the exponent of a cycle says; None of one that is not known.
_ATTRACTS: dict[str | None, bool] = {"negative": True, "positive": False}


@dataclass(frozen=True)
class Oscillating:
    """An oscillation with the ring in which it is told: parameters, ``symbols`` (amplitudes, constants), ``phases``.

    ``field``: the equations with their numbers; ``taylor``: it is a Taylor series about the motion, cut off; ``real``:
    by the signs of the parameters frequencies at eps = 0 are real and not zero; ``resonances``: the divisors that are
    not known to be different from zero by them.  ``real_amplitude``: so is a determined amplitude.  ``velocities``:
    variables that are rates of others; ``deviating``: coordinates that mean deviations from a motion in which they are
    not zero.  ``attracts``: whether motions near a single cycle come closer to it for small
    eps > 0, None where that is not known, or depends.
    """

    oscillation: Oscillation
    ring: Ring
    phases: tuple[str, ...]
    symbols: Mapping[str, str]
    field: PolynomialField
    taylor: bool
    real: bool = False
    resonances: tuple[Divisor, ...] = ()
    real_amplitude: bool = True
    attracts: bool | None = None
    velocities: tuple[str, ...] = ()
    deviating: tuple[str, ...] = ()

    @property
    def phase(self) -> str:
        """The first."""
        return self.phases[0]

    def formula(self, x: Element, ring: Ring | None = None, finely: bool = False) -> Formula:
        """An element; in ``told_ring`` with letters for common denominators.

        What stands before each product of amplitudes is in lowest terms by itself; ``finely``: and of those parameters,
        too, by which nothing is divided.
        """
        letters = None if ring is None else self.denominators
        whole, tower = self.ring if ring is None else ring, self.oscillation.tower
        places = [MOST_ROOTS + tower.parameters.index(amplitude_symbol(k)) for k in range(len(self.phases))]
        places += [k for k in self._above if k not in places] if finely else []
        gens, total = tower.context.gens(), whole.zero
        for powers, p in apart(x.top, places).items():
            product = prod((gens[k] ** n for k, n in zip(places, powers, strict=True)), start=p)
            total = total + in_letters(tower, whole, self.symbols, tower.made(product, x.bottom), letters)
        return Formula(whole, total)

    @cached_property
    def _coefficients(self) -> list[Element]:
        """Of all waves, and of the rates of the phases."""
        expansion = self.oscillation
        waves = [harmonics for series in expansion.series for harmonics in series] + [
            x for drift in expansion.drifts for x in drift.waves
        ]
        values = [x for wave in waves for pair in wave.waves.values() for x in pair if not x.is_zero()]
        return [*values, *(x for phase in expansion.phases for x in phase.corrections)]

    @cached_property
    def _above(self) -> list[int]:
        """Places of parameters that stand in no denominator and under no root."""
        tower = self.oscillation.tower
        below = {k for x in self._coefficients for k in occurring([x.bottom])} | {*occurring(tower.squares)}
        return [MOST_ROOTS + k for k in range(len(tower.parameters)) if MOST_ROOTS + k not in below]

    @cached_property
    def denominators(self) -> tuple[tuple[Any, str], ...]:
        """Letters D1, D2, ... for irreducible factors with several terms that divide more than one coefficient."""
        factors: list[Any] = []
        often: list[int] = []
        for x in self._coefficients:
            for factor, _ in x.bottom.factor()[1]:
                if len(factor) > 1 and not any(factor.degrees()[:MOST_ROOTS]):
                    if factor not in factors:
                        factors.append(factor)
                        often.append(0)
                    often[factors.index(factor)] += 1
        taken = set(self.ring.names()) | set(self.symbols.values())
        names = (name for k in count(1) if (name := f"D{k}") not in taken)
        return tuple(zip((x for x, times in zip(factors, often, strict=True) if times > 1), names, strict=False))

    @cached_property
    def told_ring(self) -> Ring:
        """The ring of the result with the letters of ``denominators``."""
        if not self.denominators:
            return self.ring
        names = [g.name for g in self.ring.generators if g.kind == "parameter" and g.name != "pi"]
        positive = [name for name in names if self.ring.is_positive(self.ring.generator("parameter", name))]
        told = [*names, *(name for _, name in self.denominators)]
        ring = Ring((), self.phases, told, self.ring.angles, positive, spare=40)
        ring.leading = frozenset(ring.index("parameter", self.ring.generators[k].name) for k in self.ring.leading)
        return ring

    def wave(self, harmonics: Harmonics, target_ring: Ring | None = None, finely: bool = False) -> Formula:
        """A trigonometric polynomial of the phases."""
        ring = self.ring if target_ring is None else target_ring
        total = ring.zero
        for k, (a, b) in harmonics.waves.items():
            turns = zip(self.phases, multiples(k, len(self.phases)), strict=True)
            sine, cosine = ring.sin_cos(LinearForm(tuple((phase, Fraction(n)) for phase, n in turns if n)))
            for x, turned in ((a, cosine), (b, sine)):
                total = total + ring.times(self.formula(x, target_ring, finely).polynomial, turned)
        return Formula(ring, total if target_ring is not None else ring.reduce(total))

    def shortest(self, harmonics: Harmonics) -> Formula:
        """The same with letters for common denominators, in the form that takes least to be written."""
        wholes = [self.wave(harmonics), self.wave(harmonics, finely=True)]
        plain = [self.wave(harmonics, self.told_ring, finely) for finely in (False, True)] if self.denominators else []
        reduced = [Formula(x.ring, x.ring.reduce(x.polynomial)) for x in plain[:1]]
        with letters_as(None):  # to write each in letters would take long
            whole = min(wholes, key=lambda x: len(x.text()))
            if not plain:
                return whole
            named = min((*plain, *reduced), key=lambda x: len(x.text()))
            raw, most = len(named.text()), len(whole.text())
        length = len(whole.text())
        if length < min(raw, most):
            return whole  # the author's letters make it shorter than ours
        return min((named, whole), key=lambda x: len(x.text()))

    def written(self, harmonics: Harmonics) -> str:
        """The same, harmonic by harmonic, in Python syntax."""
        text = ""
        for k, pair in sorted(harmonics.waves.items()):
            for x, wave in zip(pair, ("cos", "sin"), strict=True):
                if x.is_zero():
                    continue
                coefficient = str(self.formula(x))
                negative = coefficient.startswith("-") and _single(coefficient)
                coefficient = coefficient[1:] if negative else coefficient
                if k:
                    factor = f"{wave}({told_angle(k, self.phases)})"
                    coefficient = (
                        "" if coefficient == "1" else coefficient if _single(coefficient) else f"({coefficient})"
                    )
                    coefficient = f"{coefficient}*{factor}" if coefficient else factor
                sign = " - " if negative else " + "
                text += (
                    coefficient if not text and not negative else f"-{coefficient}" if not text else sign + coefficient
                )
        return text or "0"


def told_angle(k: int, phases: Sequence[str]) -> str:
    """``2*phase``, ``phase_x - phase_y``: the sum of multiples of phases with that wave number."""
    text = ""
    for phase, n in zip(phases, multiples(k, len(phases)), strict=True):
        if n:
            sign = ("" if n > 0 else "-") if not text else (" + " if n > 0 else " - ")
            text += sign + (phase if abs(n) == 1 else f"{abs(n)}*{phase}")
    return text


def _single(text: str) -> bool:
    """Whether it is one term: no sign stands outside of parentheses but the first."""
    depth = 0
    for before, x in pairwise(text):
        depth += (before == "(") - (before == ")")
        if depth == 0 and x in "+-" and before != "*" and before != "e":
            return False
    return True


def small_parameter(system: System) -> SmallParameter:
    """The description's own, or the size of all deviations from the unperturbed motion.

    Raises NoClosedForm where neither is given.
    """
    if system.small is not None:
        return system.small
    if not system.motion or system.speeds:
        raise NoClosedForm(
            "the description names no small parameter, and no motion whose small deviations could be asked for",
            remedy="add 'small parameter: eps', or a 'motion' of the coordinates",
        )
    taken = {*system.parameter_names, *system.coordinates}
    name = next(candidate for candidate in ("eps", "epsilon", "eps_", "epsilon_") if candidate not in taken)
    return SmallParameter(name, tuple((coordinate, 1) for coordinate in system.coordinates))


def oscillating(
    analysis: Analysis,
    order: int,
    values: Mapping[str, Fraction] | None = None,
    leading: str | Sequence[str] = "",
    which: int = 1,
) -> Oscillating:
    """The periodic solution up to eps^order, or that with several phases, checked.

    ``values`` of parameters and of symbols of the result.

    A number of a parameter that is scaled stands before its power of eps, as the symbol would.

    ``leading`` names the variable that leads, or one for each phase; ``which`` says which frequency the first has,
    where it shares several.

    Raises NoClosedForm where there is none, or it cannot be had; ZeroDivisionError where numbers make it singular.
    """
    system = analysis.system
    small = small_parameter(system)
    known_values = dict(values or {})
    related = {analysis.ring.generators[k].name for k in relations(analysis.parameters_scene)}
    for name in (small.name, *(parameter for parameter, _ in small.powers), *known_values):
        if name in related:
            raise NoClosedForm(
                "[[name]] is given by a relation: it is not small, scaled, or a number by itself",
                name=name,
                remedy="solve the relation for another parameter",
            )
    whole, taylor = _field(analysis, small, order)
    if small.name in known_values:
        raise NoClosedForm("the small parameter cannot be a number")
    numbers = {n: rationals.exact(x) for n, x in known_values.items() if n in whole.parameters}
    scaled = {n: numbers.pop(n) for n, _ in small.powers if numbers.get(n)}  # zero has no power
    field = whole.at(numbers) if numbers else whole
    powers = {n: p for n, p in small.powers if n in field.parameters or n in field.variables}
    for name, power in small.powers:  # the velocity of a cyclic coordinate, too
        if name in system.coordinates and velocity_name(name) in field.variables:
            powers[velocity_name(name)] = power
    if small.name not in field.parameters and not powers:
        raise NoClosedForm("the equations do not depend on [[name]]", name=small.name)
    symbolic = [n for n in field.parameters if n != small.name and n not in scaled and n not in dict(field.roots)]
    most = order if taylor else order + LATEST
    left = {*symbolic, small.name, *related, *known_values}
    others = [name for name in system.parameter_names if name not in left]
    led = (leading,) if isinstance(leading, str) else tuple(leading)
    led = tuple(name for name in led if name) or ((small.leading,) if small.leading else ())
    if missing := next((name for name in led if name not in field.variables), ""):
        raise NoClosedForm("the equations do not depend on [[name]]", name=missing)
    tower = tower_over(symbolic, field.variables, order, others, max(1, len(led)))
    rows = graded_rows(tower, field, small.name, powers, most, scaled)
    phases, symbols = names_of(system, field, led)
    ring = _letters(system, [*symbolic, *others], phases, symbols)
    constants = {
        internal: tower.number(known_values[shown]) for internal, shown in symbols.items() if shown in known_values
    }
    there = Equations(
        tower,
        small.name,
        field.variables,
        rows,
        tuple(powers.items()),
        tuple(x for x in field.variables if x in system.coordinates),
        lambda x: str(Formula(ring, in_letters(tower, ring, symbols, x))),
        most,
        constants,
        lambda x: _sign(analysis, tower, x),
    )
    expansion = oscillation(there, order, led, which)
    if not expansion.verified:
        raise NoClosedForm("withdrawn: put into the equations, the expansion leaves terms of its own order")
    used = {*map(amplitude_symbol, range(len(phases))), *(f"#{name}" for name, _ in expansion.constants)}
    square_signs = [_sign(analysis, tower, phase.frequency * phase.frequency) for phase in expansion.phases]
    if "negative" in square_signs:
        raise NoClosedForm(
            "[[leading]] does not oscillate where [[small]] = 0: the square of its frequency is < 0",
            leading=expansion.phases[square_signs.index("negative")].leading,
            small=small.name,
        )
    size = _sign(analysis, tower, expansion.amplitude * expansion.amplitude)
    return Oscillating(
        expansion,
        ring,
        phases,
        {k: v for k, v in symbols.items() if k in used},
        field,
        taylor,
        all(sign == "positive" for sign in square_signs),
        tuple(
            divisor
            for divisor in expansion.divisors
            if all(_sign(analysis, tower, x) not in ("positive", "negative") for x in divisor.parts)
        ),
        expansion.kind is Amplitude.FREE or size == "positive",
        None if expansion.exponent is None else _ATTRACTS.get(_sign(analysis, tower, expansion.exponent[1])),
        () if system.speeds else system.velocities,
        tuple(x.coordinate for x in system.motion if taylor and (x.value, x.rate) != (ZERO, ZERO)),
    )


class NoRate(NoClosedForm):
    """A formula that is not the rate of the coordinate after which its integral is called."""

    code = "no-rate"


def with_integrals(solution: Oscillating, analysis: Analysis, rates: Mapping[str, Expression]) -> Oscillating:
    """The integrals over the time of ``rates``, formulas in variables and parameters, beside the solution.

    Powers of eps stand in them as they are: nothing is taken out.  An integral that has the name of a coordinate is
    that coordinate but for its initial value: its rate is held against the description exactly, but for the sign of
    square roots.  Raises NoRate where it is another, NoClosedForm where a formula has no series.
    """
    system, expansion = analysis.system, solution.oscillation
    drifts = list(expansion.drifts)
    for name, rate in rates.items():
        if name in system.coordinates:
            _is_rate(analysis, name, rate)
        power, slopes = series_of(system, solution, rate)
        if power < 0:
            raise NoClosedForm("the rate of [[name]] grows as [[small]] tends to 0", name=name, small=expansion.small)
        nothing = [Harmonics(expansion.tower, {})] * power
        turning = zip(*((phase.frequency, phase.corrections) for phase in expansion.phases), strict=True)
        drifts.append(integrated(name, [*nothing, *slopes], *turning))
    return replace(solution, oscillation=replace(expansion, drifts=tuple(drifts)))


def _is_rate(analysis: Analysis, name: str, rate: Expression) -> None:
    """Whether a formula in speeds and positions is the velocity of a coordinate that they replace.

    Square roots are taken with either sign:  (f - q')(f_- - q') = 0.
    """
    form = analysis.form
    refusal = NoRate(
        "[[name]] is a coordinate, and its rate was not found to be this",
        name=name,
        remedy="give the integral a name that the description does not have",
    )
    if not analysis.system.speeds or form.by_quaternion:
        raise refusal
    ring = form.ring
    known = ring_environment(analysis.system, ring) | form.plainly
    velocity = ring.generator("velocity", name)
    try:
        values = [Lowering(ring, known)(x) for x in (rate, _other_roots(rate))]
        product = ring.times(*(x - velocity for x in values))
        if ring.is_zero(product):
            return
    except Failure:
        pass
    raise refusal


def _other_roots(x: Expression) -> Expression:
    """With minus before every square root."""
    match x:
        case Call("sqrt"):
            return Negative(x)
        case Negative(operand):
            return Negative(_other_roots(operand))
        case Operation(operator, left, right):
            return Operation(operator, _other_roots(left), _other_roots(right))
    return x


def in_variables(solution: Oscillating, system: System, scaling: Scaling) -> Oscillating:
    """The same solution in an author's variables, time and parameters: put in, exactly, divided by the factors.

    Constant values and the small parameter keep their names; the amplitude is that of the new leading variable.
    """
    expansion, old = solution.oscillation, solution.oscillation.tower
    if any(angle_in(name) is not None for name in old.parameters):
        raise NoClosedForm("sines and cosines of parameters stand in it: it is not told in other variables")
    base = with_parameters(system, scaling)
    shown = {name: internal for internal, name in solution.symbols.items()}
    symbolic = [
        parameter.name
        for parameter in base.parameters
        if parameter.name not in shown and parameter.name != expansion.small
    ]
    internal = [name for name in old.parameters if name.startswith("#")]
    tower = Tower((*symbolic, *internal))
    own = {name: tower.parameter(shown.get(name, name)) for name in (*symbolic, *shown)}
    lower = Lowering(tower, own)
    images = {**own, **{name: lower(value) for name, value in scaling.parameters}}
    factors = {variable.name: lower(variable.factor) for variable in scaling.variables}
    new = {variable.name: variable.new for variable in scaling.variables}
    slow = tower.one if scaling.time is None else lower(scaling.time.factor)
    for name in solution.velocities:
        plain = without_velocity(name)
        factors[name] = factors.get(plain, tower.one) / slow
        new[name] = velocity_name(new.get(plain, plain))
    amplitudes = {
        amplitude_symbol(k): factors.get(phase.leading, tower.one) for k, phase in enumerate(expansion.phases)
    }

    def called(names: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(new.get(name, name) for name in names)

    def generator(index: int) -> Element:
        if index < MOST_ROOTS:
            return tower.square_root(whole(old.squares[MOST_ROOTS - 1 - index]))
        name = old.parameters[index - MOST_ROOTS]
        if name in amplitudes:
            return tower.parameter(name) * amplitudes[name]
        return tower.parameter(name) if name.startswith("#") else images[name]

    known: dict[int, Element] = {}

    def whole(p: Any) -> Element:
        """A polynomial with everything put in, over the product of the denominators."""
        for k in occurring([p]):
            known.setdefault(k, generator(k))
        images = {k: (x.top, x.bottom) for k, x in known.items()}
        total, below = with_quotients(p, images, tower.context)
        return tower.made(tower.reduced(total), below)

    def put(x: Element) -> Element:
        return whole(x.top) / whole(x.bottom)

    def wave(name: str, harmonics: Harmonics) -> Harmonics:
        factor = tower.reciprocal(factors.get(name, tower.one))
        return Harmonics(tower, {k: (put(c) * factor, put(s) * factor) for k, (c, s) in harmonics.waves.items()})

    moved = {
        id(divisor): replace(
            divisor,
            variables=called(divisor.variables),
            value=put(divisor.value),
            damping=None if divisor.damping is None else put(divisor.damping),
        )
        for divisor in expansion.divisors
    }
    changed = replace(
        expansion,
        tower=tower,
        names=called(expansion.names),
        phases=tuple(
            Phase(
                new.get(phase.leading, phase.leading),
                called(phase.block),
                put(phase.frequency) * slow,
                tuple(map(put, phase.corrections)),
                put(phase.amplitude) / factor,
            )
            for phase, factor in zip(expansion.phases, amplitudes.values(), strict=True)
        ),
        constants=tuple((name, put(x)) for name, x in expansion.constants),
        series=tuple(
            tuple(wave(name, harmonics) for harmonics in series)
            for name, series in zip(expansion.names, expansion.series, strict=True)
        ),
        drifts=tuple(
            replace(
                drift,
                variable=new.get(drift.variable, drift.variable),
                rates=tuple(put(x) * slow / factors.get(drift.variable, tower.one) for x in drift.rates),
                waves=tuple(wave(drift.variable, x) for x in drift.waves),
            )
            for drift in expansion.drifts
        ),
        divisors=tuple(moved.values()),
        others=tuple((called(names), put(x) * slow * slow) for names, x in expansion.others),
        damped=tuple(map(called, expansion.damped)),
        with_zero=tuple(map(called, expansion.with_zero)),
        not_known=tuple(map(called, expansion.not_known)),
        other_amplitudes=None if expansion.other_amplitudes is None else put(expansion.other_amplitudes),
        exponent=None if expansion.exponent is None else (expansion.exponent[0], put(expansion.exponent[1]) * slow),
    )
    return replace(
        solution,
        oscillation=changed,
        ring=_letters(base, symbolic, solution.phases, solution.symbols),
        real=solution.real or all(tower.rational(phase.frequency) is not None for phase in changed.phases),
        resonances=tuple(moved[id(resonance)] for resonance in solution.resonances),
        velocities=called(solution.velocities),
    )


def _sign(analysis: Analysis, tower: Tower, x: Element) -> str | None:
    """By the assumptions of the description; None where there is no telling, or symbols of the solution are in it."""
    if _is_number(tower, x):
        value = tower.enclosed(x, dict.fromkeys(tower.parameters, acb(1)))
        proved = value.imag == 0 and value.real != 0
        return ("positive" if value.real > 0 else "negative") if proved else None
    places = (p.degrees()[MOST_ROOTS:] for p in (x.top, x.bottom))
    names = {name for degrees in places for name, d in zip(tower.parameters, degrees, strict=True) if d > 0}
    if any(name.startswith("#") for name in names):
        return None
    product = in_letters(tower, analysis.ring, {}, tower.made(x.top * x.bottom, tower.context.constant(1)))
    rooted = any(
        d > 0 for d in x.top.degrees()[:MOST_ROOTS]
    )  # ``analysis.signs`` know no roots that are adjoined later
    return (signs(analysis.parameters_scene) if rooted else analysis.signs).sign(product)


def _is_number(tower: Tower, x: Element) -> bool:
    """Whether no parameter is in it, under its roots neither."""
    pending, seen = [x.top, x.bottom], set[int]()
    while pending:
        for index, degree in enumerate(pending.pop().degrees()):
            if degree > 0 and index >= MOST_ROOTS:
                return False
            if degree > 0 and index not in seen:
                seen.add(index)
                pending.append(tower.squares[MOST_ROOTS - 1 - index])
    return True


def _field(analysis: Analysis, small: SmallParameter, order: int) -> tuple[PolynomialField, bool]:
    """The equations; and whether they are cut off."""
    equations: Any = analysis.equations
    images = relations(analysis.parameters_scene)
    names = analysis.system.coordinates
    weights = dict(small.powers)
    in_coordinates = not analysis.system.speeds
    if in_coordinates and analysis.system.motion and all(weights.get(name, 0) > 0 for name in names):
        from mbsym.analysis.higher import expanded_with
        from mbsym.problems.normal_forms.expansion import expansion

        about = analysis.parameters_scene, analysis.system, analysis.equilibrium
        _, cyclic, manifold = expanded_with(analysis)
        jets = expansion(*about, order + 2, cyclic, manifold)
        return taylor_field(jets, order + 1), True
    field = vector_field(analysis.form, equations, (), images, rooted=True)[0]
    for name in names:
        if weights.get(name) and any(f"({name}" in variable for variable in field.variables):
            raise NoClosedForm(
                "[[name]] is small, but stands under sines and cosines: they are expanded about a motion in "
                "which all coordinates are small only",
                name=name,
                remedy="give the 'motion', and a power to every coordinate",
            )
    return field, False


def names_of(
    system: System, field: PolynomialField, leading: Sequence[str] = ()
) -> tuple[tuple[str, ...], dict[str, str]]:
    """What the phases are called, and the symbols of the tower by their own names."""
    names = oscillation_names(field.variables, names_in(system), leading)
    amplitudes = {amplitude_symbol(k): name for k, name in enumerate(names.amplitudes)}
    return names.phases, amplitudes | {f"#{name}": start for name, start in names.starts.items()}


def _letters(system: System, symbolic: list[str], phases: Sequence[str], symbols: Mapping[str, str]) -> Ring:
    angles = {inside[1]: inside[2] for name in symbolic if (inside := angle_in(name)) is not None}
    names = [name for name in dict.fromkeys((*symbolic, *angles)) if angle_in(name) is None]
    positive = [
        parameter.name for parameter in system.parameters if parameter.name in names and parameter.sign == "positive"
    ]
    positive += [shown for symbol, shown in symbols.items() if symbol.startswith(AMPLITUDE)]
    ring = Ring((), phases, [*names, *symbols.values()], dict.fromkeys(phases, 1) | angles, positive, spare=40)
    amplitudes = (shown for symbol, shown in symbols.items() if symbol.startswith(AMPLITUDE))
    ring.leading = frozenset(ring.index("parameter", shown) for shown in amplitudes)  # what stands before each is told
    return ring


def in_letters(
    tower: Tower,
    ring: Ring,
    symbols: Mapping[str, str],
    x: Element,
    denominators: Sequence[tuple[Any, str]] | None = None,
) -> Polynomial:
    """An element as a polynomial of the ring of a result; symbols that no result holds are left as they are.

    ``denominators``: letters for factors of denominators; then c/c is left where it stands.
    """

    def generator(index: int) -> Polynomial:
        if index >= MOST_ROOTS:
            name = tower.parameters[index - MOST_ROOTS]
            return letter(ring, symbols.get(name, name))
        kind = tower.kind(index)
        return letter(ring, kind) if isinstance(kind, str) else ring.square_root(carried(kind))

    def carried(p: Any) -> Polynomial:
        return ring.reduce(evaluated(p, lambda k, e: generator(k) ** e, ring.context.constant, ring.times))

    top = carried(x.top)
    if x.bottom.is_constant():
        return top  # the leading coefficient of every denominator is 1
    if denominators is None:
        return ring.ratio(top, carried(x.bottom))
    constant, factors = x.bottom.factor()
    below = ring.number(rationals.fraction(constant))
    for factor, power in factors:
        name = next((name for denominator, name in denominators if denominator == factor), None)
        own = carried(factor) if name is None else ring.generator("parameter", name)
        below = ring.times(below, own ** int(power))
    return ring.times(top, ring.reciprocal(below))
