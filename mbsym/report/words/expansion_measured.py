"""How large the error of an expansion is: measured once, when a report first asks, at the given values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, TypeVar

from mbsym.algebra.failures import Failure, message_of
from mbsym.algebra.remembered import remembered
from mbsym.analysis.constrained import in_free_coordinates

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.analysis.small import Averaging, SmallParameters
    from mbsym.model.system import System
    from mbsym.problems.small_parameter.averaging import Averaged
    from mbsym.simulation.expanded import Measured
    from mbsym.simulation.oscillating import MeasuredOrders

M = TypeVar("M")

NO_NUMBERS = "the description does not give all numbers and an initial state"
DIVIDED = "a denominator vanishes at the given numbers"
#: How far below the expected order a measured one may be.
SLACK = 0.25
#: A series is called valid where its error is no larger part of what it stands for.
VALID = 0.01
#: A distance from the averaged motion, as a part of its size, that has to shrink as expected at once.
FAR = 0.5
#: One that shrinks faster than expected from so far on was none of an averaged motion.
GONE = 100


@dataclass(frozen=True)
class JudgedAverage:
    """An effective potential with what was measured of it; ``withdrawn``: the measurement contradicts it."""

    averaging: Averaging
    measured: Measured | str
    withdrawn: bool

    @property
    def averaged(self) -> Averaged | None:
        """The result, where there is one that stands."""
        return None if self.withdrawn else self.averaging.averaged


def contradicts(measurement: Measured | str) -> bool:
    """Whether the distances do not shrink as they would by the averaging theorem: the result must not be told then."""
    from mbsym.simulation.expanded import NOISE

    if isinstance(measurement, str) or not measurement.orders:
        return False
    first, last = measurement.orders[0], measurement.orders[-1]
    # Where several phases beat the last distance alone scatters; better than expected is no contradiction.
    short = last < measurement.expected - SLACK and sum(measurement.orders) < measurement.expected * len(
        measurement.orders
    )
    slow = measurement.distances[-1] > NOISE and short
    away = measurement.distances[0] >= FAR and first < measurement.expected - 2 * SLACK
    gone = measurement.distances[0] >= GONE and first > measurement.expected + 2 * SLACK
    return slow or away or gone


@remembered
def flow_measured(small_parameters: SmallParameters, system: System) -> Measured | str:
    """The error of the flow on the slow manifold; why it was not measured."""
    assert small_parameters.slow is not None
    return measured_or_why(in_free_coordinates(system), small_parameters.slow)


def measured_or_why(
    system: System, expansion: Expansion, time: float | None = None, values: Mapping[str, Fraction] | None = None
) -> Measured | str:
    """The error of the flow over ``time``, with ``values`` in place of the description's; why it was not measured."""
    from mbsym.simulation.expanded import measured

    return _or_why(lambda: measured(system, expansion, time, values))


@remembered
def oscillation_measured(small_parameters: SmallParameters, system: System) -> MeasuredOrders | str:
    """The errors of the periodic solution at parts of the small parameter; why they were not measured."""
    assert small_parameters.oscillation is not None
    return orders_or_why(in_free_coordinates(system), small_parameters.oscillation)


def orders_or_why(
    system: System, solution: Oscillating, values: Mapping[str, Fraction] | None = None
) -> MeasuredOrders | str:
    """The same of any periodic solution, with the ``values`` that it was made with."""
    from mbsym.simulation.oscillating import measured_orders

    return _or_why(lambda: measured_orders(system, solution, values))


@remembered
def averages(small_parameters: SmallParameters, system: System) -> tuple[JudgedAverage, ...]:
    """All effective potentials, each held against the motion itself: what any output shows of them."""
    return tuple(_judged(small_parameters, in_free_coordinates(system)))


def _judged(small_parameters: SmallParameters, system: System) -> Iterator[JudgedAverage]:
    for averaging in small_parameters.averaged:
        measurement: Measured | str = ""
        if averaging.averaged is not None and averaging.analysis is not None:
            measurement = average_or_why(system, averaging.analysis.system, averaging.averaged)
        yield JudgedAverage(averaging, measurement, contradicts(measurement))


def average_or_why(system: System, averaged: System, average: Averaged, time: float | None = None) -> Measured | str:
    """The distance of the motion from the averaged one; why it was not measured."""
    from mbsym.simulation.expanded import average_measured

    return _or_why(lambda: average_measured(system, averaged, average, time))


def _or_why(measure: Callable[[], M]) -> M | str:
    """What is measured; why it was not."""
    from mbsym.numerics.scenario import Incomplete
    from mbsym.simulation.expanded import NotMeasured

    try:
        return measure()
    except Incomplete:
        return NO_NUMBERS
    except ZeroDivisionError:
        return DIVIDED
    except (NotMeasured, Failure, ValueError, OverflowError) as reason:
        return message_of(reason)
