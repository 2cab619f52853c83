"""Enclosures over a stretch of time, with as many bits as the width asked for needs.

The solution from exact initial numbers is enclosed with few bits first; where its widest component is wider than asked
for, or no further step can be proved, as many bits more are taken as that needs, and it begins again: the width of a
solution from a point grows by a factor that belongs to the motion, whatever the bits.  Components are reckoned as parts
of their sizes, so that nothing of this depends on units.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import inf, log2
from time import perf_counter

from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.numerics.enclosure.field import Field, upper
from mbsym.numerics.enclosure.segment import CannotStep, Segment, advanced, bundle
from mbsym.numerics.kernels.interface import Code

#: Bits of the first try, beyond those that the width itself has; of the arithmetic beyond those of the series; at most.
FIRST, GUARD, MOST = 24, 24, 2_000

#: The first guess of the disc's radius, as a part of the whole time, and how it grows from step to step.
FIRST_GUESS, GROWTH = 0.02, 1.3

#: A disc smaller than this part of the whole time means that the enclosure cannot go on.
LEAST = 1e-7

#: A set that is wider than this part of a quantity's size, or so many times what was wanted, is given up.
WIDE, MUCH_WIDER = 1e-3, 1e3

#: After this part of its time an enclosure that would need so many times as much as it has is given up.
FIRST_LOOK, HOPELESS = 0.1, 10.0

#: Why an enclosure ends before the time asked for.
NO_STEP, TOO_WIDE, OUT_OF_TIME, INTERRUPTED = "no step proved", "too wide", "out of time", "interrupted"
TOO_DEAR = "too dear"
CUT = (OUT_OF_TIME, TOO_DEAR, INTERRUPTED)

#: What a step costs, an operation of rates and Jacobian and as many for all else, times the square of the bits: about
#: seconds of a usual machine (``mbsym.numerics.planning.prices``).
STEP, BESIDES = 2.5e-8, 30


@dataclass(frozen=True)
class Enclosure:
    """Segments that follow each other from 0 to ``reached``; ``ended`` says why that is not the end ("": it is).

    ``end`` is the time asked for; ``bits`` of the series; every component of the exact solution is within ``at(t)`` for
    t up to ``reached``.  ``cut`` says why no try with more bits, to make it narrower, came as far ("": none was cut).
    """

    segments: tuple[Segment, ...]
    bits: int
    reached: float
    ended: str
    seconds: float
    end: float = inf
    cut: str = ""

    @property
    def whole_seconds(self) -> float:
        """How long the whole would take at this pace: an estimate."""
        return self.seconds * self.end / self.reached if self.reached > 0 else inf

    def at(self, t: float) -> list[arb]:
        """Balls that contain the solution at t, n numbers; raises ValueError beyond ``reached``."""
        return self.within(t, t)

    def within(self, first: float, last: float) -> list[arb]:
        """Balls that contain the solution for all times from ``first`` to ``last``."""
        with ctx.workprec(self.bits + GUARD):
            begin, end = arb(first), arb(last)
            if first < 0 or last > self.reached or not self.segments:
                raise ValueError(f"enclosed from 0 to {self.reached:g} only")
            found: list[arb] | None = None
            place = max(0, bisect_left(self._starts, first) - 1)
            for segment in self.segments[place:]:
                if segment.start > end:
                    break
                low = begin if begin > segment.start else segment.start
                high = end if end < segment.end else segment.end
                value = segment.at(low if first == last else low.union(high))
                found = value if found is None else [a.union(b) for a, b in zip(found, value, strict=True)]
            assert found is not None
            return found

    @cached_property
    def _starts(self) -> list[float]:
        return [float(segment.start) for segment in self.segments]


def enclosed(
    rates: Code,
    jacobian: Code,
    state: Sequence[Fraction | arb],
    end: float,
    width: float,
    scales: Sequence[float],
    seconds: float = inf,
    watch: Callable[[float], None] = lambda t: None,
    limit: float = inf,
) -> Enclosure:
    """The solution of x' = rates(t, x) from ``state`` (exact numbers, or balls) at 0 to ``end``.

    ``width`` is the radius wanted of every component, as a part of its ``scale``.  The enclosure that comes
    furthest within ``seconds``, and for a cost of ``limit`` (counted work), is given; its ``ended`` says what was
    missing.  Raises NotAnalytic where the equations have no power series.
    """
    began, spent = perf_counter(), 0.0
    bits = FIRST + max(8, int(-log2(width)))
    exact = all(not isinstance(value, arb) or value.is_exact() for value in state)
    best: Enclosure | None = None
    while True:
        left = seconds - (perf_counter() - began)
        found = _once(rates, jacobian, state, end, bits, left, width, scales, watch, limit - spent)
        spent += _price(rates, jacobian, bits) * len(found.segments)
        if best is None or (found.reached, not found.ended) >= (best.reached, not best.ended):
            best = found
        missing = _missing(found, width, scales) if exact else 0
        finished = not missing or found.ended in CUT or bits >= MOST
        if finished:
            # A try with more bits that was cut short is why there is no more, however far an earlier one came.
            cut = found.ended if found.ended in CUT else ""
            ended = cut if best.ended and cut else best.ended
            return Enclosure(best.segments, best.bits, best.reached, ended, perf_counter() - began, end, cut)
        bits = min(MOST, bits + missing)


def _missing(found: Enclosure, width: float, scales: Sequence[float]) -> int:
    """How many bits more would make it as narrow as wanted; 0 where it is, or more bits would not help."""
    if found.ended == "":
        radii = [max(one) for one in zip(*(segment.radii for segment in found.segments), strict=True)]
        widest = max(radius / scale for radius, scale in zip(radii, scales, strict=True))
        # Twice: what the series of a segment are rounded by comes on top of that.
        return 0 if 2 * widest <= width else 8 + int(log2(2 * widest / width))
    # Too wide on the way: as many bits as that part of the way has cost, for the rest of it, with some to spare.
    return max(32, found.bits) if found.ended == TOO_WIDE else 0


def _once(
    rates: Code,
    jacobian: Code,
    state: Sequence[Fraction | arb],
    end: float,
    bits: int,
    seconds: float,
    width: float,
    scales: Sequence[float],
    watch: Callable[[float], None],
    limit: float,
) -> Enclosure:
    began, price = perf_counter(), _price(rates, jacobian, bits)
    segments: list[Segment] = []
    guess, ended = FIRST_GUESS * end, ""
    with ctx.workprec(bits + GUARD):
        field = Field(rates, jacobian, bits + GUARD, scales)
        now = bundle(arb(0), [_ball(value) / size for value, size in zip(state, field.sizes, strict=True)])
        goal = arb(end)
        try:
            while now.time < goal:
                segment, now, found = advanced(field, now, bits, guess, goal)
                segments.append(segment)
                guess = min(found.radius * GROWTH, end)
                widest = max(_radius(value) / scale for value, scale in zip(segment.last, scales, strict=True))
                if not widest <= max(MUCH_WIDER * width, WIDE):
                    ended = TOO_WIDE
                elif found.radius < LEAST * end:
                    ended = NO_STEP
                elif _late(perf_counter() - began, seconds, float(now.time) / end):
                    ended = OUT_OF_TIME if now.time < goal else ""
                elif _late(price * len(segments), limit, float(now.time) / end):
                    ended = TOO_DEAR if now.time < goal else ""
                if ended:
                    break
                watch(float(now.time))
        except CannotStep as reason:
            ended = TOO_WIDE if reason.blurred else NO_STEP
        except KeyboardInterrupt:
            ended = INTERRUPTED
        reached = float(segments[-1].end) if segments else 0.0
    return Enclosure(tuple(segments), bits, reached, ended, perf_counter() - began, end)


def _price(rates: Code, jacobian: Code, bits: int) -> float:
    """What a step costs."""
    return STEP * (rates.operations + jacobian.operations + BESIDES) * bits**2


def _late(taken: float, allowed: float, part: float) -> bool:
    """Whether seconds, or what it may cost, are over, or a tenth of that has shown that it is far too little."""
    return taken > allowed or (taken > FIRST_LOOK * allowed and taken > HOPELESS * allowed * part)


def _ball(value: Fraction | arb) -> arb:
    return value if isinstance(value, arb) else rationals.ball(value)


def _radius(value: arb) -> float:
    return float(upper(value - value.mid()))
