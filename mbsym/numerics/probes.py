"""Where a model is driven to its extremes: ladders of exact states and scenarios.

singular          a coordinate approaches a value at which M is singular (found: ``mbsym.numerics.extremes.singular``)
rates             all velocities together, 1e-8 to 1e8 times the usual
equilibrium       the state approaches the unperturbed motion
ratios            one positive parameter at a time, times 1e-12 to 1e12; towards 0 this is also the small parameter

Distances and rates are in the units that the scene itself offers (``mbsym.numerics.probes``).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite, sqrt
from typing import Any

from flint import ctx

from mbsym.algebra.failures import SingularPoint
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression, Number, names
from mbsym.mechanics.variables import angle_denominators
from mbsym.model.system import velocity_name
from mbsym.numerics.closing import NotClosed, closed
from mbsym.numerics.extremes.singular import Singularities, SingularSet
from mbsym.numerics.scenario import Incomplete, Scenario, exact, scenario
from mbsym.numerics.trade.digits import Quantity, Truth

# What a scene itself offers as units, so that nothing that is measured depends on kilogram, metre and second.
#
#     rate omega    the largest of |q'_i|/X_i, sqrt(|q''_i|/X_i), sqrt(|dq''_i/dq_j| X_j/X_i), |dq''_i/dq'_j| X_j/X_i
#     length X_i    of a coordinate: 1 of an angle; else |q_i|, else the largest sqrt(M_jj/M_ii) X_j of the others
#
# all at the initial state.  In another unit of mass, length or time every one of them changes as its dimension says.


@dataclass(frozen=True)
class SceneUnits:
    """``sizes`` of the coordinates (exactly 1 for angles) and the ``rate``; both exact."""

    sizes: tuple[Fraction, ...]
    rate: Fraction

    @property
    def velocities(self) -> tuple[Fraction, ...]:
        return tuple(size * self.rate for size in self.sizes)


def scene_units(nominal: Scenario, truth: Truth) -> SceneUnits:
    """From balls at the initial state; what is not finite there (a singular position) is left out."""
    n = len(nominal.positions)
    angles = angle_denominators(nominal.system)
    masses = _values(truth, "mass matrix", nominal)
    diagonal = [masses[i * (n + 1)] if masses else 0.0 for i in range(n)]
    sizes = [1.0 if name in angles else 0.0 for name in nominal.system.coordinates]
    for i, position in enumerate(nominal.positions):
        if not sizes[i] and position:
            sizes[i] = abs(float(position))
    for i in range(n):
        if not sizes[i]:
            others = [
                sizes[j] * sqrt(diagonal[j] / diagonal[i]) for j in range(n) if diagonal[i] > 0 and diagonal[j] > 0
            ]
            sizes[i] = max(others, default=0.0) or 1.0
    exact = tuple(Fraction(size) for size in sizes)
    rates = [abs(float(v)) / x for v, x in zip(nominal.velocities, sizes, strict=True)]
    accelerations = _values(truth, "accelerations", nominal)
    rates += [sqrt(abs(a) / x) for a, x in zip(accelerations, sizes, strict=False)]
    slopes = _values(truth, "Jacobian", nominal)
    for place, slope in enumerate(slopes):
        i, j = divmod(place, 2 * n)
        scaled = abs(slope) * sizes[j % n] / sizes[i]
        rates.append(scaled if j >= n else sqrt(scaled))
    rates += [abs(float(rate)) for name, (_, rate) in nominal.prescribed.items() if name in angles]
    usual = max((x for x in rates if isfinite(x)), default=0.0)
    return SceneUnits(exact, Fraction(usual) if usual > 0 else Fraction(1))


def _values(truth: Truth, name: str, nominal: Scenario) -> list[float]:
    """Finite midpoints; nothing where the quantity is not measured."""
    if name not in truth.functions:
        return []
    with ctx.workprec(256):
        balls = truth.functions[name](truth.inputs(nominal, Fraction(0), nominal.state))
        return [float(x.mid()) if x.is_finite() else float("nan") for x in balls]


def in_units(units: SceneUnits, pattern: Sequence[Any]) -> tuple[Fraction, ...]:
    """A dimensionless pattern (q, q') in the units of the scene."""
    whole = (*units.sizes, *units.velocities)
    return tuple(Fraction(x) * unit for x, unit in zip(pattern, whole, strict=True))


SINGULAR, RATES, EQUILIBRIUM, RATIO = "singular", "rates", "equilibrium", "ratio"

DISTANCES = tuple(10.0**-k for k in range(2, 15))
SPEEDS = tuple(10.0**k for k in range(-8, 9, 2))
FACTORS = (1e-12, 1e-6, 1e6, 1e12)

#: Of one set so many places are approached.
MOST_PLACES = 4


@dataclass(frozen=True)
class Probe:
    """One scenario in one exact state (q, q'); ``size`` is the distance, rate or factor.

    ``assumed``: it keeps the assumptions of the description, on which verdicts may rest.
    """

    size: float
    scenario: Scenario
    state: tuple[Fraction, ...]
    assumed: bool = True


@dataclass(frozen=True)
class Ladder:
    """Probes of one kind; ``subject`` is what they are about (``theta -> pi/2``, ``m0``)."""

    kind: str
    subject: str
    probes: tuple[Probe, ...]

    @property
    def title(self) -> str:
        return Message("[[parameter]] times", parameter=self.subject) if self.kind == RATIO else self.subject


def ladders(
    nominal: Scenario,
    overrides: dict[str, Expression],
    quantities: Sequence[Quantity],
    singularities: Singularities,
    units: SceneUnits,
) -> Iterator[Ladder]:
    """All ladders of states and parameters that apply to a system."""
    yield from singular(nominal, singularities, units)
    yield Ladder(RATES, "rates", tuple(Probe(s, nominal, _faster(nominal, s, units)) for s in SPEEDS))
    yield from near_equilibrium(nominal, units)
    yield from ratios(nominal, overrides, quantities, units)


def _decimal(size: float) -> Fraction:
    """The exact power of ten that a float stands for."""
    return Fraction(f"{size:e}")


def _velocities(nominal: Scenario, units: SceneUnits) -> tuple[Fraction, ...]:
    """The initial velocities, or a plain choice where nothing moves."""
    if any(nominal.velocities):
        return nominal.velocities
    return tuple(Fraction(k + 2, 10 * (k + 1)) * unit for k, unit in enumerate(units.velocities))


def _faster(nominal: Scenario, factor: float, units: SceneUnits) -> tuple[Fraction, ...]:
    """All velocities times one factor."""
    return (*nominal.positions, *(v * _decimal(factor) for v in _velocities(nominal, units)))


# --- singular configurations ---


def singular(nominal: Scenario, singularities: Singularities, units: SceneUnits) -> Iterator[Ladder]:
    """One ladder for every value of a coordinate at which M is singular, or point of a set in several coordinates.

    One coordinate approaches it; the others are where the scenario has them, or where the set wants them.
    """
    for singular_set in singularities.sets:
        movable = [name for name in singular_set.names if name in nominal.system.coordinates]
        for number in range(min(len(singular_set.places), MOST_PLACES)):
            if movable:
                yield _approach(nominal, singular_set, number, movable[0], units)


def _approach(nominal: Scenario, singular_set: SingularSet, number: int, moving: str, units: SceneUnits) -> Ladder:
    place, names_ = singular_set.places[number], nominal.system.coordinates
    start = [
        *(place.get(name, x) for name, x in zip(names_, nominal.positions, strict=True)),
        *_velocities(nominal, units),
    ]
    k = names_.index(moving)
    probes = []
    for size in DISTANCES:
        state = list(start)
        state[k] -= _decimal(size) * units.sizes[k]
        probes.append(Probe(size, nominal, tuple(state)))
    return Ladder(SINGULAR, subject(singular_set, number, moving), tuple(probes))


def subject(singular_set: SingularSet, number: int, moving: str) -> str:
    """``theta -> pi/2``, ``a -> 1.5708 at b = 3.14159``."""
    if singular_set.values:
        return f"{moving} -> {singular_set.values[number].label}"
    place = {name: f"{float(x):.6g}" for name, x in singular_set.places[number].items()}
    others = ", ".join(f"{name} = {x}" for name, x in place.items() if name != moving)
    return f"{moving} -> {place[moving]} at {others}"


# --- the motion ---


def motion_state(nominal: Scenario) -> tuple[Fraction, ...] | None:
    """(q, q') of the unperturbed motion at t = 0; None where the description has none.

    Velocities that the motion does not name follow from the constraints where these can be satisfied so.
    """
    motion = {entry.coordinate: entry for entry in nominal.system.motion}
    if not motion:
        return None
    zero = Fraction(0)
    names_ = nominal.system.coordinates
    try:
        at = [exact(motion[q].value, nominal.parameters) if q in motion else zero for q in names_]
        rates = [exact(motion[q].rate, nominal.parameters) if q in motion else zero for q in names_]
    except SingularPoint:
        return None
    named = {velocity_name(name) for name in motion}
    unstated = tuple(x for x in nominal.system.velocities if x not in named)
    whole = replace(nominal, positions=tuple(at), velocities=tuple(rates), unstated=unstated)
    try:
        return closed(whole, {*names_, *named}).scenario.state
    except NotClosed:
        return whole.state


def near_equilibrium(nominal: Scenario, units: SceneUnits) -> Iterator[Ladder]:
    """States that approach the unperturbed motion, if there is one."""
    start = motion_state(nominal)
    if start is None:
        return
    pattern = in_units(units, [Fraction((-1) ** k * (k + 2), k + 3) for k in range(len(start))])
    probes = []
    for size in DISTANCES[::2]:
        state = tuple(x + _decimal(size) * c for x, c in zip(start, pattern, strict=True))
        probes.append(Probe(size, nominal, state))
    yield Ladder(EQUILIBRIUM, Message("distance from the motion"), tuple(probes))


# --- parameters ---


def scaled(
    nominal: Scenario, overrides: dict[str, Expression], name: str, factor: Fraction, assumed: bool = True
) -> Scenario:
    """The scenario with one parameter times a factor, and all that follows from it by relations.

    Raises Incomplete where that contradicts something; unless ``assumed`` is false, an assumption, too.
    """
    value = Number(nominal.parameters[name] * factor)
    changed = scenario(nominal.system, {**overrides, name: value}, state=False, assumed=assumed)
    return replace(changed, positions=nominal.positions, velocities=nominal.velocities)


def free_parameters(nominal: Scenario) -> tuple[str, ...]:
    """The parameters that are positive and not determined by a relation."""
    bound = {relation.name for relation in nominal.system.relations}
    return tuple(
        p.name
        for p in nominal.system.parameters
        if p.name not in bound and p.sign in ("positive", "nonnegative") and nominal.parameters[p.name] > 0
    )


def _assumed(nominal: Scenario, overrides: dict[str, Expression], name: str, factor: Fraction) -> bool:
    """Whether the assumptions still hold with a parameter times a factor."""
    try:
        scaled(nominal, overrides, name, factor)
    except Incomplete:
        return False
    return True


def ratios(
    nominal: Scenario, overrides: dict[str, Expression], quantities: Sequence[Quantity], units: SceneUnits
) -> Iterator[Ladder]:
    """One ladder for every free parameter that occurs in a quantity."""
    used = set()
    for q in quantities:
        for number in q.code.program.live(q.code.outputs):
            used.add(q.code.program.instructions[number].payload)
    for relation in nominal.system.relations:
        if relation.name in used:
            used.update(names(relation.value))
    for name in free_parameters(nominal):
        if name in used:
            probes = []
            for factor in FACTORS:
                try:
                    there = scaled(nominal, overrides, name, _decimal(factor), assumed=False)
                except Incomplete:  # a value that contradicts another one
                    continue
                state = (*nominal.positions, *_velocities(nominal, units))
                probes.append(Probe(factor, there, state, _assumed(nominal, overrides, name, _decimal(factor))))
            if probes:
                yield Ladder(RATIO, name, tuple(probes))
