"""What is asked of a simulation, and what of it cannot be done."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, inf, isfinite
from typing import Any, BinaryIO

import numpy as np

from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import Expression, names, number
from mbsym.model.system import System
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.models import Model
from mbsym.numerics.streamed import SHOWN
from mbsym.simulation.watching import Watch

#: The local error unless asked for otherwise.
TOLERANCE = {"float64": 1e-10, "float32": 1e-5, "extended": 1e-14}


#: What is integrated of a system with speeds.
DECLARED, COORDINATES = "declared", "coordinates"


@dataclass(frozen=True)
class Request:
    """What is asked for.

    ``samples`` rows from 0 to ``time``, or one ``every`` so often (by default as many as the motion needs); a method's
    name or ``auto``; a ``tolerance`` or, for methods of fixed step, a ``step``; ``invariants``: first integrals as
    well; ``estimate``: whether the error is estimated (None: if the run was short); ``whole``: what rests is
    integrated, too, all parts in one, and no body is lumped into another; ``certify``: the exact solution is enclosed
    so narrowly, as a part of each quantity's size, within ``certify_seconds`` and for the counted work
    ``certify_limit`` (``mbsym.numerics.planning.prices``); ``events``: what is watched for;
    ``model``: how much of the mechanics is in the equations; no step is longer than ``longest``; ``earlier``: the run
    that it goes on from, whose rows come first; ``store``: a file of nobody else's, open to be written and read, for
    the rows where they are very many: the result then has some of them, and the table of all;
    ``fixed``: coordinates and velocities whose initial values stay while others are fitted to constraints;
    ``variables``: what is integrated where a description has speeds, these with unit vectors or a quaternion
    (``declared``), or coordinates and their velocities (``coordinates``).
    """

    time: float
    samples: int | None = None
    every: float | None = None
    method: str = "auto"
    tolerance: float | None = None
    step: float | None = None
    arithmetic: str = "float64"
    step_limit: int = 10_000_000
    invariants: bool = False
    estimate: bool | None = None
    whole: bool = False
    certify: float | None = None
    certify_seconds: float = inf
    certify_limit: float = inf
    events: Watch = Watch()
    model: Model = Model()
    longest: float | None = None
    earlier: Earlier | None = None
    store: BinaryIO | None = None
    fixed: tuple[str, ...] = ()
    variables: str = DECLARED

    @property
    def rows(self) -> int | None:
        """How many are asked for; None where that is left open, or an earlier run has some already."""
        if self.earlier is not None or self.every is None:
            return None if self.earlier is not None else self.samples
        return ceil(self.time / self.every * (1 - 1e-12)) + 1

    @property
    def streams(self) -> bool:
        """Whether the rows go to the ``store``: where they are very many, and nothing needs them all at once."""
        return self.store is not None and self.certify is None and (self.rows or 0) > SHOWN


def read_values(system: System, values: Mapping[str, Expression | Fraction | float | str]) -> dict[str, Expression]:
    """Values by name as expressions: numbers, or text such as ``pi/6`` made of numbers, pi and parameters.

    A name is that of a parameter, a coordinate (its initial position), ``<coordinate>_dot`` (its initial velocity), or
    a declared variable (its initial value).  Raises ValueError with everything that is wrong.
    """
    known = (*system.parameter_names, *system.coordinates, *system.velocities, *system.variables)
    expressions: dict[str, Expression] = {}
    wrong = [f"there is nothing called {name} to set" for name in values if name not in known]
    for name, value in values.items():
        complaints = Complaints()
        if isinstance(value, str):
            read = parse_expression(value, complaints)
            unknown = sorted(names(read) - {*system.parameter_names, "pi"}) if read is not None else []
            wrong += [f"{name} = {value}: {item.message}" for item in complaints.items]
            wrong += [f"{name} = {value}: unknown name {other}" for other in unknown]
            if read is not None:
                expressions[name] = read
        elif isinstance(value, (int, float, Fraction)):
            if not isfinite(value):
                wrong.append(f"{name} = {value} is no number")
            else:
                expressions[name] = number(Fraction(value))
        else:
            expressions[name] = value
    if wrong:
        raise ValueError("; ".join(wrong))
    return expressions


def wrong_with(request: Request) -> Iterator[str]:
    """What of it cannot be done, a sentence each."""
    positive = {"time": request.time, "every": request.every, "tolerance": request.tolerance, "step": request.step}
    positive["certify"] = request.certify
    positive["certify_seconds"] = None if request.certify_seconds == inf else request.certify_seconds
    positive["max_step"] = request.longest
    for name, value in positive.items():
        if value is not None and not (isfinite(value) and value > 0):
            yield f"{name} must be positive, not {value}"
    if request.samples is not None and request.samples < 2:
        yield f"samples must be 2 at least, not {request.samples}"
    if request.samples is not None and request.every is not None:
        yield "samples and every exclude each other"
    if request.earlier is not None and not request.time > request.earlier.time:
        yield f"time must be beyond {request.earlier.time:.9g}, where the earlier run ended"
    if request.variables not in (DECLARED, COORDINATES):
        yield f"there are no variables {request.variables}: choose from {DECLARED}, {COORDINATES}"
    if request.step_limit < 1:
        yield f"step_limit must be 1 at least, not {request.step_limit}"
    if request.arithmetic not in TOLERANCE:
        yield f"there is no arithmetic {request.arithmetic}: choose from {', '.join(TOLERANCE)}"
    if request.method != "auto" and request.method not in METHODS:
        yield f"there is no method {request.method}: choose from auto, {', '.join(METHODS)}"
        return
    fixed = request.method != "auto" and METHODS[request.method].traits.fixed
    if fixed and request.step is None:
        yield f"{request.method} takes steps of one length: give a step"
    if not fixed and request.step is not None:
        yield f"{request.method} chooses its steps by a tolerance, not by a step"
    if fixed and request.tolerance is not None:
        yield f"{request.method} takes steps of one length, no tolerance"
    if fixed and request.longest is not None:
        yield f"{request.method} takes steps of one length: give a shorter step in place of max_step"


# Where an earlier run got to, so that another one can go on from there (``mbsym simulate --continue``).
#
# The new run begins in the last state of the earlier one, to the last bit, with a step found anew.  So the two together
# are the uninterrupted run but for what a step size changes: to rounding with steps of one length (where the earlier
# run ended at the end of a step), within the tolerance with steps that are chosen.


@dataclass(frozen=True, eq=False)
class Earlier:
    """The rows of an earlier run, from t = 0 to where it ended: times (m,) and states (2n, m).

    ``spacing`` is the distance of rows that was asked for; ``values`` are parameters and the state at t = 0 by their
    names, and the rest is how it was integrated: ``method`` is the last one, which may ``change`` on the way, ``model``
    how much of the mechanics was in the equations.
    """

    times: Any
    states: Any
    spacing: float
    values: Mapping[str, float]
    method: str
    tolerance: float | None
    step: float | None
    arithmetic: str
    change: bool = False
    model: Model = Model()

    @property
    def time(self) -> float:
        """Where it ended."""
        return float(self.times[-1])

    @property
    def state(self) -> Any:
        """The state there, in the arithmetic of the run."""
        return self.states[:, -1]

    def further(self, end: float, every: float | None, samples: int | None) -> Any:
        """Times after ``time`` up to ``end``: ``samples`` of them, one ``every`` so often, or spaced as before.

        Where the rows so far stand on multiples of the spacing, as they do unless they end between, so do these.
        """
        if samples is not None:
            return np.linspace(self.time, end, samples + 1)[1:]
        spacing = every if every is not None else self.spacing
        before = round(self.time / spacing)
        on_grid = abs(before * spacing - self.time) <= 1e-9 * spacing
        first = before if on_grid else 0
        count = int(np.ceil((end - (0.0 if on_grid else self.time)) / spacing * (1 - 1e-12))) - first
        times = np.arange(first + 1, first + max(count, 1) + 1) * spacing + (0.0 if on_grid else self.time)
        times[-1] = end
        return times
