"""Where a model is driven to its extremes: ladders of exact states and scenarios.

singular angles   a coordinate approaches a value at which det M vanishes while it does not nearby (found, not assumed:
                  0, pi/2, pi, -pi/2 of every coordinate, by balls)
rates             all velocities together from 1e-8 to 1e8 of the usual
equilibrium       the state approaches the unperturbed motion
ratios            one positive parameter at a time, times 1e-12 to 1e12; towards 0 this is also the small parameter
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from flint import arb, arb_mat, ctx

from mbsym.algebra.failures import SingularPoint
from mbsym.expressions.tree import Expression, Number, names
from mbsym.numerics.digits import Quantity, Truth
from mbsym.numerics.scenario import PRECISION, Incomplete, Scenario, exact, rounded, scenario

SINGULAR, RATES, EQUILIBRIUM, RATIO = "singular angle", "rates", "equilibrium", "ratio"

DISTANCES = tuple(10.0**-k for k in range(2, 15))
SPEEDS = tuple(10.0**k for k in range(-8, 9, 2))
FACTORS = (1e-12, 1e-6, 1e6, 1e12)


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
        return f"{self.subject} times" if self.kind == RATIO else self.subject


def ladders(
    given: Scenario, overrides: dict[str, Expression], truth: Truth, found: Sequence[Quantity]
) -> Iterator[Ladder]:
    """All ladders of states and parameters that apply to a system."""
    yield from singular(given, truth)
    yield Ladder(RATES, "rates", tuple(Probe(s, given, _faster(given, s)) for s in SPEEDS))
    yield from near_equilibrium(given)
    yield from ratios(given, overrides, found)


def _decimal(size: float) -> Fraction:
    """The exact power of ten that a float stands for."""
    return Fraction(f"{size:e}")


def _velocities(given: Scenario) -> tuple[Fraction, ...]:
    """The initial velocities, or a plain choice where nothing moves."""
    if any(given.velocities):
        return given.velocities
    return tuple(Fraction(k + 2, 10 * (k + 1)) for k in range(len(given.velocities)))


def _faster(given: Scenario, speed: float) -> tuple[Fraction, ...]:
    """All velocities times one factor, so that the largest is ``speed``."""
    usual = _velocities(given)
    factor = _decimal(speed) / max(abs(v) for v in usual)
    return (*given.positions, *(v * factor for v in usual))


# --- singular angles ---


def singular(given: Scenario, truth: Truth) -> Iterator[Ladder]:
    """One ladder for every coordinate and value at which M is singular while it is not nearby."""
    if "mass matrix" not in truth.functions:
        return
    with ctx.workprec(PRECISION):
        quarter = rounded(arb.pi() / 2)
    targets = (("0", Fraction(0)), ("pi/2", quarter), ("-pi/2", -quarter), ("pi", 2 * quarter))
    for place, name in enumerate(given.system.coordinates):
        for label, value in targets:
            if _vanishing(given, truth, place, value):
                probes = []
                for size in DISTANCES:
                    state = [*given.positions, *_velocities(given)]
                    state[place] = value - _decimal(size)
                    probes.append(Probe(size, given, tuple(state)))
                yield Ladder(SINGULAR, f"{name} -> {label}", tuple(probes))


def _vanishing(given: Scenario, truth: Truth, place: int, value: Fraction) -> bool:
    """Whether |det M| at ``value`` is below 1e-60 of what it is nearby, in balls of 512 bits."""
    sizes = []
    for offset in (Fraction(0), Fraction(1, 10)):
        state = list(given.state)
        state[place] = value - offset
        with ctx.workprec(512):
            entries = truth.functions["mass matrix"](truth.inputs(given, Fraction(0), state))
            n = len(given.positions)
            sizes.append(abs(arb_mat(n, n, entries).det()))
    return bool(sizes[0] < sizes[1] * arb(10) ** -60)


# --- the motion ---


def motion_state(given: Scenario) -> tuple[Fraction, ...] | None:
    """(q, q') of the unperturbed motion at t = 0; None where the description has none."""
    motion = {entry.coordinate: entry for entry in given.system.motion}
    if not motion:
        return None
    zero = Fraction(0)
    names_ = given.system.coordinates
    try:
        at = [exact(motion[q].value, given.parameters) if q in motion else zero for q in names_]
        rates = [exact(motion[q].rate, given.parameters) if q in motion else zero for q in names_]
    except SingularPoint:
        return None
    return (*at, *rates)


def near_equilibrium(given: Scenario) -> Iterator[Ladder]:
    """States that approach the unperturbed motion, if there is one."""
    start = motion_state(given)
    if start is None:
        return
    pattern = [Fraction((-1) ** k * (k + 2), k + 3) for k in range(len(start))]
    probes = []
    for size in DISTANCES[::2]:
        state = tuple(x + _decimal(size) * c for x, c in zip(start, pattern, strict=True))
        probes.append(Probe(size, given, state))
    yield Ladder(EQUILIBRIUM, "distance from the motion", tuple(probes))


# --- parameters ---


def scaled(
    given: Scenario, overrides: dict[str, Expression], name: str, factor: Fraction, assumed: bool = True
) -> Scenario:
    """The scenario with one parameter times a factor, and all that follows from it by relations.

    Raises Incomplete where that contradicts something; unless ``assumed`` is false, an assumption, too.
    """
    value = Number(given.parameters[name] * factor)
    changed = scenario(given.system, {**overrides, name: value}, state=False, assumed=assumed)
    return replace(changed, positions=given.positions, velocities=given.velocities)


def free_parameters(given: Scenario) -> tuple[str, ...]:
    """The parameters that are positive and not determined by a relation."""
    bound = {relation.name for relation in given.system.relations}
    return tuple(
        p.name
        for p in given.system.parameters
        if p.name not in bound and p.sign in ("positive", "nonnegative") and given.parameters[p.name] > 0
    )


def _assumed(given: Scenario, overrides: dict[str, Expression], name: str, factor: Fraction) -> bool:
    """Whether the assumptions still hold with a parameter times a factor."""
    try:
        scaled(given, overrides, name, factor)
    except Incomplete:
        return False
    return True


def ratios(given: Scenario, overrides: dict[str, Expression], found: Sequence[Quantity]) -> Iterator[Ladder]:
    """One ladder for every free parameter that occurs in a quantity."""
    used = set()
    for q in found:
        for number in q.code.program.live(q.code.outputs):
            used.add(q.code.program.instructions[number].payload)
    for relation in given.system.relations:
        if relation.name in used:
            used.update(names(relation.value))
    for name in free_parameters(given):
        if name in used:
            probes = []
            for factor in FACTORS:
                try:
                    there = scaled(given, overrides, name, _decimal(factor), assumed=False)
                except Incomplete:  # a value that contradicts another one
                    continue
                state = (*given.positions, *_velocities(given))
                probes.append(Probe(factor, there, state, _assumed(given, overrides, name, _decimal(factor))))
            if probes:
                yield Ladder(RATIO, name, tuple(probes))
