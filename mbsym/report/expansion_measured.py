"""How large the error of an expansion is: measured once, when a report first asks, at the given values."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from mbsym.algebra.failures import Failure

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.analysis.small import SmallParameters
    from mbsym.model.system import System
    from mbsym.simulation.averaged import Measured as MeasuredAverage
    from mbsym.simulation.expanded import Measured
    from mbsym.simulation.oscillating import MeasuredOrders

NO_NUMBERS = "the description does not give all numbers and an initial state"
DIVIDED = "a denominator vanishes at the given numbers"

_FLOWS: WeakKeyDictionary[SmallParameters, Measured | str] = WeakKeyDictionary()
_WAVES: WeakKeyDictionary[SmallParameters, MeasuredOrders | str] = WeakKeyDictionary()
_AVERAGES: WeakKeyDictionary[SmallParameters, dict[str, MeasuredAverage | str]] = WeakKeyDictionary()


def flow_measured(found: SmallParameters, system: System) -> Measured | str:
    """The error of the flow on the slow manifold; why it was not measured."""
    if found not in _FLOWS:
        assert found.slow is not None
        _FLOWS[found] = measured_or_why(system, found.slow)
    return _FLOWS[found]


def measured_or_why(
    system: System, found: Expansion, time: float | None = None, values: Mapping[str, Fraction] | None = None
) -> Measured | str:
    """The error of the flow over ``time``, with ``values`` in place of the description's; why it was not measured."""
    from mbsym.numerics.scenario import Incomplete
    from mbsym.simulation.expanded import NotMeasured, measured

    try:
        return measured(system, found, time, values)
    except Incomplete:
        return NO_NUMBERS
    except ZeroDivisionError:
        return DIVIDED
    except (NotMeasured, Failure, ValueError, OverflowError) as reason:
        return str(reason)


def oscillation_measured(found: SmallParameters, system: System) -> MeasuredOrders | str:
    """The errors of the periodic solution at parts of the small parameter; why they were not measured."""
    if found not in _WAVES:
        assert found.oscillation is not None
        _WAVES[found] = orders_or_why(system, found.oscillation)
    return _WAVES[found]


def orders_or_why(
    system: System, told: Oscillating, values: Mapping[str, Fraction] | None = None
) -> MeasuredOrders | str:
    """The same of any periodic solution, with the ``values`` that it was made with."""
    from mbsym.numerics.scenario import Incomplete
    from mbsym.simulation.oscillating import measured_orders

    try:
        return measured_orders(system, told, values)
    except Incomplete:
        return NO_NUMBERS
    except ZeroDivisionError:
        return DIVIDED
    except (Failure, ValueError, OverflowError) as reason:
        return str(reason)


def average_measured(found: SmallParameters, phase: str, system: System) -> MeasuredAverage | str:
    """The distance of the motion from the averaged one; why it was not measured."""
    kept = _AVERAGES.setdefault(found, {})
    if phase not in kept:
        kept[phase] = _average(found, phase, system)
    return kept[phase]


def _average(found: SmallParameters, phase: str, system: System) -> MeasuredAverage | str:
    from mbsym.numerics.scenario import Incomplete
    from mbsym.simulation.averaged import measured

    one = next(one for one in found.averaged if one.phase == phase)
    assert one.found is not None
    assert one.analysis is not None
    try:
        return measured(system, one.analysis.system, one.found)
    except Incomplete:
        return NO_NUMBERS
    except ZeroDivisionError:
        return DIVIDED
    except (Failure, ValueError, OverflowError) as reason:
        return str(reason)
