"""Which members an ensemble has: values of parameters and of the initial state, on a grid or drawn at random.

A grid takes every combination of equally spaced values, ends included, the last name varying fastest; draws are joint,
each member one point of the space of all that varies, from NumPy's PCG64 or from Sobol's sequence (scrambled, SciPy).
The points are the same for the same seed, however they are cut: chunks of a sweep are made where they are used.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from fractions import Fraction
from functools import cached_property
from math import isfinite, prod
from typing import Any

import numpy as np

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import Failure, message_of
from mbsym.expressions.message import Message, worded
from mbsym.expressions.tree import names, number
from mbsym.expressions.tree import text as spelled
from mbsym.model.assumptions import has_sign, holds
from mbsym.model.system import System
from mbsym.numerics.ensembles.parametrised import Parametrised, dependent, released
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Incomplete, Names

#: More members than this are refused.
MOST_MEMBERS = 1_000_000

NORMAL, UNIFORM = "normal", "uniform"
RANDOM, SOBOL = "random", "sobol"


@dataclass(frozen=True)
class Grid:
    """``count`` values from ``low`` to ``high``."""

    name: str
    low: float
    high: float
    count: int

    @property
    def values(self) -> Any:
        """In increasing or decreasing order, ends included."""
        return np.linspace(self.low, self.high, self.count)


@dataclass(frozen=True)
class Draw:
    """normal(mean ``first``, standard deviation ``second``) or uniform(from ``first`` to ``second``)."""

    name: str
    kind: str
    first: float
    second: float

    def at(self, chances: Any) -> Any:
        """The values whose distribution function is ``chances``, between 0 and 1."""
        if self.kind == UNIFORM:
            return self.first + (self.second - self.first) * chances
        from scipy.special import ndtri

        tiny = np.finfo(float).tiny
        return self.first + self.second * ndtri(np.clip(chances, tiny, 1 - 2.0**-53))


Variation = Grid | Draw


@dataclass(frozen=True)
class Points:
    """``variations`` are all grids, or all draws with ``members`` points in all."""

    variations: tuple[Variation, ...]
    members: int = 0
    seed: int = 1
    sampling: str = RANDOM

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(variation.name for variation in self.variations)

    @property
    def grids(self) -> tuple[Grid, ...]:
        """The axes of a grid; nothing where points are drawn."""
        return tuple(variation for variation in self.variations if isinstance(variation, Grid))

    @cached_property
    def count(self) -> int:
        return prod(grid.count for grid in self.grids) if self.grids else self.members

    def part(self, start: int, stop: int) -> Any:
        """The points number ``start`` to ``stop`` - 1, shape (names, stop - start)."""
        if self.grids:
            places = np.unravel_index(np.arange(start, stop), [grid.count for grid in self.grids])
            return np.array([grid.values[place] for grid, place in zip(self.grids, places, strict=True)])
        chances = self._chances(start, stop)
        draws = [variation for variation in self.variations if isinstance(variation, Draw)]
        return np.array([draw.at(row) for draw, row in zip(draws, chances, strict=True)])

    def _chances(self, start: int, stop: int) -> Any:
        """Points of the unit cube, shape (names, stop - start)."""
        count = len(self.variations)
        if self.sampling == SOBOL:
            import warnings

            from scipy.stats import qmc

            sequence = qmc.Sobol(count, scramble=True, rng=self.seed)
            if start:
                sequence.fast_forward(start)
            with warnings.catch_warnings():  # that a number of points is no power of 2 costs some evenness, no more
                warnings.simplefilter("ignore", UserWarning)
                return sequence.random(stop - start).T
        bits = np.random.PCG64(self.seed)
        bits.advance(start * count)
        return np.random.Generator(bits).random((stop - start, count)).T


def variation(name: str, arguments: Sequence[float | str]) -> Variation:
    """(low, high, count), ("normal", mean, deviation) or ("uniform", low, high); else ValueError."""
    first, *rest = arguments
    if len(rest) != 2:
        raise ValueError(f"{name}: (low, high, count), ('normal', mean, deviation) or ('uniform', low, high)")
    if isinstance(first, str):
        if first not in (NORMAL, UNIFORM):
            raise ValueError(f"{name}: there is no distribution {first}: choose from {NORMAL}, {UNIFORM}")
        return Draw(name, first, float(rest[0]), float(rest[1]))
    count = int(rest[1])
    if count < 2:
        raise ValueError(f"{name}: a grid has 2 values at least, not {count}")
    return Grid(name, float(first), float(rest[0]), count)


class Unvaried(ValueError):
    """What cannot be varied; ``reasons`` are (name, sentence, hint), all of them."""

    def __init__(self, reasons: Sequence[tuple[str, str, str]]) -> None:
        super().__init__("; ".join(text for _, text, _ in reasons))
        self.reasons = tuple(reasons)


def complaints(
    variations: Sequence[Variation],
    members: int | None,
    known: Sequence[str],
    following: Collection[str] = (),
    what: str = "members",
    most: int = MOST_MEMBERS,
    example: int = 1000,
) -> Iterator[tuple[str, str, str]]:
    """What is wrong with them: (name, sentence, hint).

    ``known`` names may vary but for those ``following`` from others.  How many of ``what`` are drawn, ``most`` at most,
    an option of that name says.
    """
    seen: set[str] = set()
    for one in variations:
        if one.name not in known:
            message = Message("there is nothing called '[[name]]' to vary", name=one.name)
            near = get_close_matches(one.name, known, 1)
            hint = Message("did you mean '[[other]]'?", other=near[0]) if near else ""
            if not near and known:
                hint = Message("there are [[names]]", names=", ".join(known))
            yield one.name, message, hint
        elif one.name in following:
            message = Message("[[name]] follows from other parameters", name=one.name)
            yield one.name, message, "vary those of which its relation is made"
        if one.name in seen:
            yield one.name, Message("[[name]] is varied twice", name=one.name), "join the two"
        seen.add(one.name)
        yield from badly_ranged(one)
    clash = list(mixed(variations))
    yield from clash
    grids = [one for one in variations if isinstance(one, Grid)]
    if not clash and grids and members is not None:
        message = Message("a grid says itself how many [[what]] it has", what=worded(what))
        yield grids[0].name, message, Message("leave --[[option]] out", option=what)
    elif not grids and members is None and variations:
        message = Message("how many [[what]] to draw is not said", what=worded(what))
        yield variations[0].name, message, Message("for example [[example]]", example=f"--{what} {example}")
    count = prod(grid.count for grid in grids) if grids else members or 0
    if count > most:
        message = Message("[[count]] [[what]] are too many", count=count, what=worded(what))
        yield variations[0].name, message, Message("at most [[most]]", most=most)


def complaints_of(
    system: System, variations: Sequence[Variation], members: int | None
) -> Iterator[tuple[str, str, str]]:
    """Of the members of an ensemble."""
    known = (*system.parameter_names, *system.coordinates, *system.velocities, *system.variables)
    yield from complaints(variations, members, known, {relation.name for relation in system.relations})


def badly_ranged(one: Variation) -> Iterator[tuple[str, str, str]]:
    """What is wrong with one range: (name, sentence, hint)."""
    ends = (one.low, one.high) if isinstance(one, Grid) else (one.first, one.second)
    if not all(map(isfinite, ends)):
        yield one.name, Message("the range of [[name]] is not finite", name=one.name), ""
    elif isinstance(one, Grid) and one.low == one.high:
        yield one.name, _empty(one.name, one.low, one.high), "give two ends"
    if isinstance(one, Draw) and one.kind == NORMAL and not one.second > 0:
        words = "the standard deviation of [[name]] must be positive, not [[value]]"
        yield one.name, Message(words, name=one.name, value=f"{one.second:g}"), ""
    if isinstance(one, Draw) and one.kind == UNIFORM and not one.second > one.first:
        yield one.name, _empty(one.name, one.first, one.second), "the smaller one first"


def _empty(name: str, low: float, high: float) -> Message:
    return Message("the range of [[name]] is empty: [[low]] to [[high]]", name=name, low=f"{low:g}", high=f"{high:g}")


def mixed(variations: Sequence[Variation]) -> Iterator[tuple[str, str, str]]:
    """That grids and draws stand side by side: (name, sentence, hint)."""
    grids = [one for one in variations if isinstance(one, Grid)]
    if grids and len(grids) < len(variations):
        sentence = "a grid and draws at random do not go together"
        yield grids[0].name, sentence, "draw all of them: name=uniform(low, high)"


def drawn(
    system: System, variations: Sequence[Variation], members: int | None = None, seed: int = 1, sampling: str = RANDOM
) -> Any:
    """The values, shape (len(variations), m).  Raises Unvaried with everything that is wrong."""
    wrong = list(complaints_of(system, variations, members))
    if wrong:
        raise Unvaried(wrong)
    points = Points(tuple(variations), members or 1, seed, sampling)
    return points.part(0, points.count)


@dataclass(frozen=True)
class Members:
    """Members ready to be integrated: ``starts`` (2n, m), ``parameters`` (p, m) in the order of ``dynamics.free``."""

    dynamics: Parametrised
    names: tuple[str, ...]
    values: Any
    starts: Any
    parameters: Any

    def described(self, member: int) -> str:
        """``theta = 0.3, m1 = 2`` of a member."""
        pairs = zip(self.names, self.values[:, member], strict=True)
        return ", ".join(f"{name} = {value:.12g}" for name, value in pairs)


def members(dynamics: Parametrised, varied: Sequence[str], values: Any) -> Members:
    """Initial states and parameters of members with ``values`` (k, m) of ``varied`` names.

    ``dynamics.free`` must be those of them that are parameters.  States that have to be fitted to constraints, or told
    in declared variables, are those of a run of each member by itself.

    Raises Unvaried where a member's parameters break a declared sign or give no initial state.
    """
    count = values.shape[1]
    parameters = np.array([values[varied.index(name)] for name in dynamics.free]).reshape(len(dynamics.free), count)
    wrong = [*_signs(dynamics, parameters), *_assumptions(dynamics, parameters)]
    if wrong:
        raise Unvaried(wrong)
    one_by_one = dynamics.system.constraints or dynamics.in_states
    starts = _begun(dynamics, varied, values) if one_by_one else _starts(dynamics, varied, values, parameters)
    bad = np.flatnonzero(~np.all(np.isfinite(starts), axis=0))
    if len(bad):
        raise Unvaried(
            [(varied[0], Message("[[count]] of [[all]] members have no initial state", count=len(bad), all=count), "")]
        )
    return Members(dynamics, tuple(varied), values, starts, parameters)


def _starts(dynamics: Parametrised, varied: Sequence[str], values: Any, parameters: Any) -> Any:
    """(2n, m)."""
    system, own = dynamics.system, dict(zip(varied, values, strict=True))
    states = (*system.coordinates, *system.velocities)
    fixed = dict(zip(states, map(float, dynamics.scenario.state), strict=True))
    columns = [own.get(name, np.full(values.shape[1], fixed[name])) for name in states]
    starts = arrays.kernel(dynamics.start)(np.vstack([parameters, np.array(columns)]))
    for place, name in enumerate(states):
        if name in own:
            starts[place] = own[name]
    return starts


def _begun(dynamics: Parametrised, varied: Sequence[str], values: Any) -> Any:
    """(p + n, m).  Raises Unvaried with the first member that has no state."""
    starts = []
    for column in values.T:
        own = {name: number(Fraction(float(value))) for name, value in zip(varied, column, strict=True)}
        try:
            begun = dynamics.begun(own)
            starts.append([float(x) for x in begun.state])
            if dynamics.keeps(begun):
                continue
            words = "other rows of the constraints follow from others with [[values]] than at the description's values"
            why: dict[str, str] = {}
            remedy = "give the description values like those of the range, or narrow it"
        except (Failure, Incomplete) as reason:
            words, remedy = "no motion begins with [[values]]: [[why]]", "narrow the range"
            why = {"why": message_of(reason)}
        printed = ", ".join(f"{name} = {value:.12g}" for name, value in zip(varied, column, strict=True))
        raise Unvaried([(varied[0], Message(words, values=printed, **why), remedy)])
    return np.array(starts).T


def _signs(dynamics: Parametrised, parameters: Any) -> Iterator[tuple[str, str, str]]:
    """Members whose parameters break their declared signs."""
    if not dynamics.free:
        return
    moving = (*dynamics.free, *dependent(dynamics.system, dynamics.free))
    rows = arrays.kernel(dynamics.parameters)(parameters)
    signs = {parameter.name: parameter.sign for parameter in dynamics.system.parameters}
    for name, row in zip(moving, rows, strict=True):
        ends = [float(np.min(row)), float(np.max(row))]
        if not np.all(np.isfinite(row)):
            count = int(np.sum(~np.isfinite(row)))
            yield name, Message("[[name]] has no value in [[count]] members", name=name, count=count), ""
            continue
        values = [*ends, *([0.0] if np.any(row == 0) else [])]
        wrong = next((value for value in values if not has_sign(Fraction(value), signs[name])), None)
        if wrong is not None:
            words = "[[name]] = [[value]] in some member, but it is declared [[sign]]"
            value, sign = f"{wrong:.12g}", worded(signs[name])
            yield name, Message(words, name=name, value=value, sign=sign), "narrow its range"


def _assumptions(dynamics: Parametrised, parameters: Any) -> Iterator[tuple[str, str, str]]:
    """Members that break an assumption of the description."""
    moving = {*dynamics.free, *dependent(dynamics.system, dynamics.free)}
    for assumption in dynamics.system.assumptions:
        used = names(assumption.left) | names(assumption.right)
        if not used & moving or not used <= {*dynamics.system.parameter_names, "pi"}:
            continue
        fresh = released(dynamics.scenario, dynamics.free)
        lowering = Lowering(fresh, Names(fresh))
        gap = lowering(assumption.left) - lowering(assumption.right)
        values = arrays.kernel(Code(fresh, dynamics.free, (gap,)))(parameters)[0]
        broken = np.flatnonzero(~np.array([holds(value, assumption.relation) for value in values]))
        if len(broken):
            printed = f"{spelled(assumption.left)} {assumption.relation} {spelled(assumption.right)}"
            words = "[[count]] of [[all]] members break the assumption [[assumption]]"
            count = Message(words, count=len(broken), all=len(values), assumption=printed)
            yield next(name for name in dynamics.free), count, "narrow the range"
