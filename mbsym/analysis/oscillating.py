"""Periodic solutions of a system near those of its linear part: its equations sorted by powers, the result as formulas.

Equations in speeds are a polynomial field; so are those in coordinates where only powers of these stand in them.  Where
all deviations from the unperturbed motion are small themselves, the field is their Taylor series.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from flint import acb

from mbsym.algebra import rationals
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower, angle_in
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.motion import relations
from mbsym.model.oscillation_names import names_in, oscillation_names
from mbsym.model.system import SmallParameter, System, velocity_name
from mbsym.problems.normal_forms.dissipative import taylor_field
from mbsym.problems.normal_forms.exact import letter
from mbsym.problems.small_parameter.graded_rows import graded_rows
from mbsym.problems.small_parameter.harmonics import Harmonics
from mbsym.problems.small_parameter.oscillation_result import Amplitude, Divisor, Oscillation
from mbsym.problems.small_parameter.oscillations import (
    AMPLITUDE,
    LATEST,
    Equations,
    oscillation,
    tower_over,
)
from mbsym.problems.vector_field import vector_field

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


#: What the sign of the exponent of a cycle says; None of one that is not known.
_ATTRACTS: dict[str | None, bool] = {"negative": True, "positive": False}


@dataclass(frozen=True)
class Oscillating:
    """An oscillation with the ring in which it is told: parameters, ``symbols`` (amplitude, constants), the phase.

    ``field``: the equations with their numbers; ``taylor``: it is a Taylor series about the motion, cut off; ``real``:
    by the signs of the parameters the frequency at eps = 0 is real and not zero; ``resonances``: the divisors that are
    not known to be different from zero by them.  ``real_amplitude``: so is a determined amplitude.  ``velocities``:
    variables that are rates of others.  ``attracts``: whether motions near a single cycle come closer to it for small
    eps > 0, None where that is not known, or depends.
    """

    found: Oscillation
    ring: Ring
    phase: str
    symbols: Mapping[str, str]
    field: PolynomialField
    taylor: bool
    real: bool = False
    resonances: tuple[Divisor, ...] = ()
    real_amplitude: bool = True
    attracts: bool | None = None
    velocities: tuple[str, ...] = ()

    def formula(self, x: Element) -> Formula:
        return Formula(self.ring, in_letters(self.found.tower, self.ring, self.symbols, x))

    def wave(self, one: Harmonics) -> Formula:
        """A trigonometric polynomial of the phase."""
        ring, total = self.ring, self.ring.zero
        s, c = (ring.generator(kind, self.phase) for kind in ("sine", "cosine"))
        for k, (a, b) in one.waves.items():
            sine, cosine = ring.multiple_angle(s, c, k) if k else (ring.zero, ring.one)
            total = total + ring.times(self.formula(a).polynomial, cosine)
            total = total + ring.times(self.formula(b).polynomial, sine)
        return Formula(ring, ring.reduce(total))

    def written(self, one: Harmonics) -> str:
        """The same, harmonic by harmonic, in Python syntax."""
        text = ""
        for k, pair in sorted(one.waves.items()):
            for x, wave in zip(pair, ("cos", "sin"), strict=True):
                if x.is_zero():
                    continue
                coefficient = str(self.formula(x))
                negative = coefficient.startswith("-") and _single(coefficient)
                coefficient = coefficient[1:] if negative else coefficient
                if k:
                    factor = f"{wave}({self.phase})" if k == 1 else f"{wave}({k}*{self.phase})"
                    coefficient = (
                        "" if coefficient == "1" else coefficient if _single(coefficient) else f"({coefficient})"
                    )
                    coefficient = f"{coefficient}*{factor}" if coefficient else factor
                sign = " - " if negative else " + "
                text += (
                    coefficient if not text and not negative else f"-{coefficient}" if not text else sign + coefficient
                )
        return text or "0"


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
    name = next(one for one in ("eps", "epsilon", "eps_", "epsilon_") if one not in taken)
    return SmallParameter(name, tuple((one, 1) for one in system.coordinates))


def oscillating(
    analysis: Analysis, order: int, values: Mapping[str, Fraction] | None = None, leading: str = "", which: int = 1
) -> Oscillating:
    """The periodic solution up to eps^order, checked.  ``values`` of parameters and of symbols of the result.

    ``leading`` names the variable that leads, ``which`` says which frequency it has, where it shares several.

    Raises NoClosedForm where there is none, or it cannot be had; ZeroDivisionError where numbers make it singular.
    """
    system = analysis.system
    small = small_parameter(system)
    given = dict(values or {})
    related = {analysis.ring.generators[k].name for k in relations(analysis.parameters_scene)}
    for name in (small.name, *(one for one, _ in small.powers), *given):
        if name in related:
            raise NoClosedForm(
                Message("[[name]] is given by a relation: it is not small, scaled, or a number by itself", name=name),
                remedy="solve the relation for another parameter",
            )
    whole, taylor = _field(analysis, small, order)
    if small.name in given or any(given.get(name) for name, _ in small.powers):
        raise NoClosedForm("what depends on the small parameter cannot be a number")
    numbers = {n: rationals.exact(x) for n, x in given.items() if n in whole.parameters}
    field = whole.at(numbers) if numbers else whole
    powers = {n: p for n, p in small.powers if n in field.parameters or n in field.variables}
    for name, power in small.powers:  # the velocity of a cyclic coordinate, too
        if name in system.coordinates and velocity_name(name) in field.variables:
            powers[velocity_name(name)] = power
    if small.name not in field.parameters and not powers:
        raise NoClosedForm(Message("the equations do not depend on [[name]]", name=small.name))
    kept = [name for name in field.parameters if name != small.name and name not in dict(field.roots)]
    most = order if taylor else order + LATEST
    left = {*kept, small.name, *related, *given}
    others = [name for name in system.parameter_names if name not in left]
    tower = tower_over(kept, field.variables, order, others)
    rows = graded_rows(tower, field, small.name, powers, most)
    phase, symbols = names_of(system, field)
    ring = _letters(system, [*kept, *others], phase, symbols)
    constants = {internal: tower.number(given[shown]) for internal, shown in symbols.items() if shown in given}
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
    found = oscillation(there, order, leading or small.leading, which)
    if not found.verified:
        raise NoClosedForm("withdrawn: put into the equations, the expansion leaves terms of its own order")
    used = {AMPLITUDE, *(f"#{name}" for name, _ in found.constants)}
    sign = _sign(analysis, tower, found.frequency * found.frequency)
    if sign == "negative":
        raise NoClosedForm(
            Message(
                "[[leading]] does not oscillate where [[small]] = 0: the square of its frequency is < 0",
                leading=found.leading,
                small=small.name,
            )
        )
    size = _sign(analysis, tower, found.amplitude * found.amplitude)
    return Oscillating(
        found,
        ring,
        phase,
        {k: v for k, v in symbols.items() if k in used},
        field,
        taylor,
        sign == "positive",
        tuple(
            one
            for one in found.divisors
            if all(_sign(analysis, tower, x) not in ("positive", "negative") for x in one.parts)
        ),
        found.kind is Amplitude.FREE or size == "positive",
        None if found.exponent is None else _ATTRACTS.get(_sign(analysis, tower, found.exponent[1])),
        () if system.speeds else system.velocities,
    )


def _sign(analysis: Analysis, tower: Tower, x: Element) -> str | None:
    """By the assumptions of the description; None where there is no telling, or symbols of the solution are in it."""
    if _is_number(tower, x):
        value = tower.enclosed(x, dict.fromkeys(tower.parameters, acb(1)))
        proved = value.imag == 0 and value.real != 0
        return ("positive" if value.real > 0 else "negative") if proved else None
    places = (p.degrees()[MOST_ROOTS:] for p in (x.top, x.bottom))
    names = {name for degrees in places for name, d in zip(tower.parameters, degrees, strict=True) if d > 0}
    if any(name.startswith("#") for name in names) or any(d > 0 for d in x.top.degrees()[:MOST_ROOTS]):
        return None
    product = in_letters(tower, analysis.ring, {}, tower.made(x.top * x.bottom, tower.context.constant(1)))
    return analysis.signs.sign(product)


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
    in_coordinates = analysis.speed_form is None
    if in_coordinates and analysis.system.motion and all(weights.get(name, 0) > 0 for name in names):
        from mbsym.analysis.higher import ignorable
        from mbsym.problems.normal_forms.expansion import expansion

        cyclic = ignorable(analysis)[1]
        jets = expansion(analysis.parameters_scene, analysis.system, analysis.equilibrium, order + 2, cyclic)
        return taylor_field(jets, order + 1), True
    field = vector_field(analysis.system, analysis.ring, analysis.speed_form, equations, (), images)[0]
    for name in names:
        if weights.get(name) and any(f"({name}" in one for one in field.variables):
            raise NoClosedForm(
                Message(
                    "[[name]] is small, but stands under sines and cosines: they are expanded about a motion in "
                    "which all coordinates are small only",
                    name=name,
                ),
                remedy="give the 'motion', and a power to every coordinate",
            )
    return field, False


def names_of(system: System, field: PolynomialField) -> tuple[str, dict[str, str]]:
    """What the phase is called, and the symbols of the tower by their own names."""
    found = oscillation_names(field.variables, names_in(system))
    return found.phase, {AMPLITUDE: found.amplitude} | {f"#{name}": start for name, start in found.starts.items()}


def _letters(system: System, kept: list[str], phase: str, symbols: Mapping[str, str]) -> Ring:
    angles = {inside[1]: inside[2] for name in kept if (inside := angle_in(name)) is not None}
    names = [name for name in dict.fromkeys((*kept, *angles)) if angle_in(name) is None]
    positive = [one.name for one in system.parameters if one.name in names and one.sign == "positive"]
    positive.append(symbols[AMPLITUDE])
    return Ring((), (phase,), [*names, *symbols.values()], {phase: 1} | angles, positive, spare=40)


def in_letters(tower: Tower, ring: Ring, symbols: Mapping[str, str], x: Element) -> Polynomial:
    """An element as a polynomial of the ring of a result; symbols that no result holds are left as they are."""

    def generator(index: int) -> Polynomial:
        if index >= MOST_ROOTS:
            name = tower.parameters[index - MOST_ROOTS]
            return letter(ring, symbols.get(name, name))
        kind = tower.kind(index)
        return letter(ring, kind) if isinstance(kind, str) else ring.square_root(carried(kind))

    def carried(p: Any) -> Polynomial:
        total = ring.zero
        for monomial, c in p.to_dict().items():
            term = ring.number(rationals.fraction(c))
            for index, exponent in enumerate(monomial):
                if exponent:
                    term = ring.times(term, generator(index) ** int(exponent))
            total = total + term
        return ring.reduce(total)

    top = carried(x.top)
    if x.bottom.is_constant():
        return top  # the leading coefficient of every denominator is 1
    return ring.reduce(ring.times(top, ring.reciprocal(carried(x.bottom))))
