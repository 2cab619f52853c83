"""What a digit more or less would cost: by what was measured, else by the slope of the setting that was chosen."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.expressions.message import Message
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT64
from mbsym.numerics.planning.model_choice import PART, Tried
from mbsym.numerics.planning.pilot import USUAL_SLOPE, Bench, Trial, finest
from mbsym.numerics.planning.plan import Accuracy, Alternative

#: How the cost of a method grows with its accuracy: cost ~ error**(-1/order).
ORDERS = {"dop853": 8, "rk45": 5, "taylor": 16}
USUAL_ORDER = 5

#: No tolerance is coarser.
COARSEST = 1e-2


def alternatives(
    bench: Bench, found: Trial, tried: Sequence[Tried], taken: Tried, accuracy: Accuracy, goal: float
) -> tuple[Alternative, Alternative]:
    """(one digit more, one digit less)."""
    more, less = (_other(bench, found, tried, taken, accuracy.finest, goal, factor) for factor in (0.1, 10.0))
    return more, less


def _other(
    bench: Bench, found: Trial, tried: Sequence[Tried], taken: Tried, target: float, goal: float, factor: float
) -> Alternative:
    wanted = goal * factor
    model = _model(tried, factor)
    price = model.operations / max(1, taken.operations)
    name = "" if model.model == taken.model else model.model.label
    options: list[tuple[float, str, bool]] = [
        (trial.cost * price, trial.label, not name) for trial in bench.trials if trial.ratio <= wanted
    ]
    judged = _judged(found, max(found.ratio / wanted, 1e-9), bench.spacing)
    if judged is not None and not _tried_in_vain(bench, found, judged[2], wanted):
        options.append((judged[0] * price, judged[1], False))
    if not options:
        needed = found.scalar == FLOAT64 and EXTENDED in found.method.traits.scalars
        text = "[[scalar]] has no finer tolerance; extended arithmetic is needed"
        why = Message(text if needed else "[[scalar]] has no finer tolerance", scalar=found.scalar)
        return Alternative(target * factor, why=why, model=name)
    cost, label, measured = min(options)
    times = cost / found.cost
    return Alternative(target * factor, label, found.seconds * times, measured, name, times=times)


def _model(tried: Sequence[Tried], factor: float) -> Tried:
    """The cheapest model that would be good enough; the faithful one has no error."""
    return min((one for one in tried if one.ratio <= PART * factor), key=lambda one: one.operations)


def _tried_in_vain(bench: Bench, found: Trial, fineness: float, wanted: float) -> bool:
    """Whether a setting at least as fine was not good enough: what is short is stepped over, whatever slopes say."""
    same = [one for one in bench.trials if one.method is found.method and one.scalar == found.scalar]
    return any(one.fineness <= fineness and one.ratio > wanted for one in same)


def _judged(found: Trial, worse: float, spacing: float) -> tuple[float, str, float] | None:
    """(cost, label, tolerance or step) of the same method with an error ``worse`` times smaller.

    None beyond its arithmetic.  A step is no longer than the ``spacing`` of the rows, and no tolerance is coarser than
    ``COARSEST``: what errors are then smaller by costs what it costs there.
    """
    traits = found.method.traits
    if found.setting.step is not None:
        order = traits.order or USUAL_ORDER
        growth = max(worse ** (1 / order), found.fineness / spacing)
        return found.cost * growth, f"{traits.name} h={found.fineness / growth:.1g}", found.fineness / growth
    worse = max(worse, min(1.0, (found.fineness / COARSEST) ** USUAL_SLOPE))
    tolerance = found.fineness * worse ** (-1 / USUAL_SLOPE)
    if tolerance < finest(found.method, found.scalar):
        return None
    growth = worse ** (1 / ORDERS.get(traits.name, USUAL_ORDER))
    return found.cost * growth, f"{traits.name} {tolerance:.0e}", tolerance
