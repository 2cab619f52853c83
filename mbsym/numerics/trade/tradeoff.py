"""What accuracy costs: ladders over method, tolerance or step, and arithmetic, measured on one system on this machine.

error    largest |x_i(t) - reference_i(t)| over all coordinates, velocities and the thousands of times at which the
         reference is known, each relative to its size in the whole motion (``mbsym.numerics.planning.sizes``)
drift    largest error of the energy h at the same times: its change where h is proved to be conserved, else its
         difference from that of the reference, whose loss is the system's own; relative to the largest kinetic energy
         of the reference, or to the largest change of its h where that is larger
strayed  largest drift of positions and of velocities from constraints at the same times, where there are any
         (``mbsym.numerics.constrained``: in parts of the motion's size)
cost     counted work of all that was done for a row, compiling, repeating and comparing included
seconds  median processor time of the integration from 0 to the end; compiling is not counted (it happens once), nor
         are rows

Which settings are measured is a matter of counted work (``planning.prices``): on every machine, however busy, the
same rows come out with the same errors and counts.  Seconds, and the front that they make, are those of this machine.

An error is measured against a reference solution of a different method and arithmetic, never against a tolerance; what
is smaller than a hundred times the reference's own error is not called an error at all.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf, isfinite, log2
from typing import Any

import numpy as np

from mbsym.algebra.failures import Defect, Failure
from mbsym.expressions.message import Message, at_most, duration, plainly
from mbsym.numerics.closing import begun
from mbsym.numerics.conservation import Standing, energy_standing, visited
from mbsym.numerics.constrained import drift
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64
from mbsym.numerics.kernels.llvm import available, kernels
from mbsym.numerics.methods.interface import Method, Setting, Unusable, Work
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.choice import choose
from mbsym.numerics.planning.prices import STARTED, STARTED_EACH
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.simulate import Rests, begins_in_equilibrium
from mbsym.numerics.states import dynamics_of
from mbsym.numerics.trade import fidelity
from mbsym.numerics.trade.fidelity import ModelError
from mbsym.numerics.trade.reference_search import IMPLICIT, Reference, whole_reference
from mbsym.numerics.trade.trial import Candidate, Trial, trial_of

#: A reference must be so much better than what it judges.
MARGIN = 100.0

#: Runs that cost less than this are repeated, and the median of their seconds taken.
SHORT = 0.25
REPEATS = 5

#: A run is stopped when it has cost so much at the earliest.
LEAST = 0.05

#: The part of the budget that the likely winner may spend, which is tried first, and the tolerance that it is asked at.
FIRST, USUAL_TOLERANCE = 0.4, 1e-10

#: A measured order is the median of so many halvings, the finest ones.
ORDER_OF = 3

#: What comparing one row costs.
COMPARED = 1e-6


@dataclass(frozen=True)
class Measured(Trial):
    """A row: what one candidate cost, and how wrong it was.

    ``strayed``: the largest drift from constraints on positions, and on velocities; None where there are none.
    ``cost``: the counted work of all that was done for the row, in seconds of a usual machine.
    """

    drift: float = inf
    front: bool = False
    strayed: tuple[float, float] | None = None


@dataclass(frozen=True)
class Order:
    """The measured order of a fixed-step method beside its nominal one; ``pairs`` of steps it is the median of."""

    method: str
    scalar: str
    nominal: int
    measured: float
    pairs: int


@dataclass(frozen=True)
class Tradeoff:
    """All rows, by methods; ``unusable`` methods with the reason; ``interrupted``: not all are there.

    ``spent``: what measuring them cost, in counted work.
    """

    rows: tuple[Measured, ...]
    reference: Reference
    orders: tuple[Order, ...]
    unusable: tuple[tuple[str, str], ...]
    interrupted: bool = False
    spent: float = 0.0

    def cheapest(self, target: float) -> Measured | None:
        """The least expensive row whose error, with that of the reference, is at most ``target``."""
        good = [row for row in self.rows if row.error + self.reference.error <= target]
        return min(good, key=lambda row: row.seconds, default=None)

    @property
    def smallest_judged(self) -> float:
        """Errors below this cannot be told from the reference's own, or from the rounding of what is compared.

        In two digits, as it is printed, rounded up.
        """
        return float(at_most(max(MARGIN * self.reference.error, float(np.finfo(float).eps))))


def tradeoff(
    dynamics: Dynamics,
    methods: Sequence[Method],
    reference: Reference,
    budget: float = 60.0,
    watch: Callable[[str], None] = lambda label: None,
) -> Tradeoff:
    """Measures every method's ladder against ``reference`` (whose times are the sampled ones), as ``budget`` allows.

    The budget is one of counted work, of everything that happens here, compiling included, about as many seconds on a
    usual machine.  The method that a run takes by itself climbs first, for ``FIRST`` of it at most; what is left is
    shared evenly between the other ladders.  A ladder stops where its next rung would cost too much, or where a finer
    setting no longer gives a smaller error.  Ctrl-C ends the measuring and keeps the rows that there are.
    An exception that nobody foresaw costs its row and the rest of its ladder (``Defect``), and nothing else.
    """
    judge = _Judge(dynamics, reference)
    rows_by_method: dict[tuple[str, str], list[Measured]] = {}
    unusable = []
    pairs = [(method, scalar) for method in methods for scalar in method.traits.scalars if available(scalar)]
    likely = _likely(dynamics, reference) if len(pairs) > 1 else None
    interrupted = False
    for place, (method, scalar) in enumerate(sorted(pairs, key=lambda pair: _name(*pair) != likely)):
        left, own = max(budget - judge.spent, 0.0), rows_by_method.setdefault(_name(method, scalar), [])
        share = FIRST * left if _name(method, scalar) == likely else left / (len(pairs) - place)
        try:
            for row in _ladder(judge, method, scalar, share, watch):
                own.append(row)
        except (Unusable, Failure) as reason:
            unusable.append((method.traits.name, reason.reason))
        except KeyboardInterrupt:
            interrupted = True
            break
    rows = [row for pair in pairs for row in rows_by_method.get(_name(*pair), ())]
    orders = tuple(_orders(rows))
    found = Tradeoff(tuple(rows), reference, orders, tuple(dict.fromkeys(unusable)), interrupted, judge.spent)
    return replace(found, rows=_with_front(rows, found.smallest_judged))


def _name(method: Method, scalar: str) -> tuple[str, str]:
    return method.traits.name, scalar


def _likely(dynamics: Dynamics, reference: Reference) -> tuple[str, str]:
    """The method that a run takes by itself, in its usual arithmetic."""
    return choose(dynamics, USUAL_TOLERANCE, float(reference.times[-1])).method.traits.name, FLOAT64


class _Judge:
    """Runs candidates and compares them with the reference; ``spent`` is what all have cost."""

    def __init__(self, dynamics: Dynamics, reference: Reference) -> None:
        self.dynamics = dynamics
        self.reference = reference
        self.scale = np.asarray(reference.scale)[:, np.newaxis]
        self.energy = kernels({"energy": dynamics.relative_energy})["energy"]
        self.true_energy, self.energy_scale = self._true_energy()
        self.spent = self.starting = 0.0
        self.defect = False
        self._ladders: set[tuple[str, str]] = set()

    def measure(self, candidate: Candidate, limit: float = inf) -> Measured:
        """Error, drift and median seconds of a candidate; a breakdown is a result too, so is a ``limit`` of cost.

        So is an exception that nobody foresaw; ``defect`` says whether it was one.  Raises Unusable.
        """
        self.defect = False
        how = candidate.method, candidate.scalar, candidate.setting
        try:
            with np.errstate(over="ignore"):  # extended numbers beyond the range of float64
                return self._measure(*how, limit)
        except (Unusable, Failure):
            raise
        except Exception as error:
            self.defect = True
            return Measured(*how, Work(), trouble=str(Defect.of(error)))

    def _measure(self, method: Method, scalar: str, setting: Setting, limit: float) -> Measured:
        times = self.reference.times
        trial = trial_of(method, self.dynamics, setting, times, scalar, limit)
        self.starting = self._compiling(method, scalar)  # a method that does not apply has compiled nothing
        until = self.spent + self.starting + limit
        self.spent += self.starting + trial.cost
        if not trial.trouble and trial.cost <= SHORT:
            trial = self._repeated(trial, until)
        row = Measured(method, scalar, setting, trial.work, 0.0, trial.seconds, trouble=trial.trouble)
        if trial.trouble:
            return row
        self.spent += COMPARED * len(times)
        states = trial.states
        error, strayed = self._error(states), self._strayed(times, states)
        return replace(row, error=error, drift=self._drift(times, states), strayed=strayed)

    def _compiling(self, method: Method, scalar: str) -> float:
        """What a method costs before its first step: once, but for those that compile every setting."""
        again = _name(method, scalar) in self._ladders and method.traits.name not in STARTED_EACH
        self._ladders.add(_name(method, scalar))
        return 0.0 if again else STARTED * self.dynamics.right_hand_side.operations

    def _repeated(self, trial: Trial, until: float) -> Trial:
        """The same with the seconds that it takes without the places at which it was compared, where these count."""
        end, runs, spent = self.reference.times[-1:], list[Trial](), 0.0
        while not runs or (spent < SHORT and len(runs) < REPEATS and self.spent < until):
            again = trial_of(trial.method, self.dynamics, trial.setting, np.append(0.0, end), trial.scalar)
            if again.trouble:
                return again
            runs.append(again)
            spent, self.spent = spent + again.cost, self.spent + again.cost
        return replace(runs[-1], states=trial.states, seconds=statistics.median(run.seconds for run in runs))

    def _error(self, states: Any) -> float:
        with np.errstate(all="ignore"):
            worst = float(np.max(np.abs(states - self.reference.states) / self.scale))
        return worst if isfinite(worst) else inf

    def _true_energy(self) -> tuple[Any, float]:
        """h along the motion, and what its errors are parts of."""
        times, states = self.reference.times, self.reference.states
        with np.errstate(all="ignore"):
            h, kinetic = self.energy(np.vstack([times, states]))
            change = np.max(np.abs(h - h[0]))
            scale = float(max(np.max(np.abs(kinetic)), change) or abs(h[0]) or 1.0)
        standing, _ = energy_standing(self.dynamics, visited(times, states, h))
        return (h[0] if standing is Standing.PROVED else h), scale

    def _drift(self, times: Any, states: Any) -> float:
        with np.errstate(all="ignore"):
            h, _ = self.energy(np.vstack([times, states]))
            worst = float(np.max(np.abs(h - self.true_energy)) / self.energy_scale)
        return worst if isfinite(worst) else inf

    def _strayed(self, times: Any, states: Any) -> tuple[float, float] | None:
        """The drift from constraints, positions and velocities, measured by the sizes of the reference."""
        known = self.dynamics.constraints
        if known is None:
            return None
        with np.errstate(all="ignore"):
            positions, velocities = drift(known, times, states, np.asarray(self.reference.scale)).largest
        return (positions if isfinite(positions) else inf), (velocities if isfinite(velocities) else inf)


def _ladder(
    judge: _Judge, method: Method, scalar: str, share: float, watch: Callable[[str], None]
) -> Iterator[Measured]:
    """From coarse to fine, until the next rung costs too much or brings nothing."""
    begun = judge.spent
    idle, best, dearest = 0, inf, 0.0
    for setting in _settings(method, scalar, float(judge.reference.times[-1])):
        candidate = Candidate(method, scalar, setting)
        watch(candidate.label)
        before = judge.spent
        row = judge.measure(candidate, max(share - (before - begun), LEAST))
        now = judge.spent
        yield replace(row, cost=now - before)
        idle = 0 if row.error < 0.5 * best else idle + (best < inf)
        best = min(best, row.error)
        growth = max(1.3, (now - before) / dearest) if dearest else 1.3
        # What was compiled for the first rung is there for the next one, but for methods that compile every setting.
        dearest = now - before - (0.0 if dearest else judge.starting)
        if judge.defect or idle >= 3 or now - begun + min(growth, 4.0) * dearest > share:
            return


def _settings(method: Method, scalar: str, duration: float) -> Iterator[Setting]:
    """Tolerances decade by decade down to the arithmetic's own, or steps halved again and again."""
    if method.traits.fixed:
        count = 16
        while count <= 2**26:
            yield Setting(step=duration / count)
            count *= 2
    else:
        finest = {FLOAT32: -6, FLOAT64: -14}.get(scalar, -18)
        for power in range(-3, finest - 1, -1):
            yield Setting(tolerance=10.0**power)


def _with_front(rows: Sequence[Measured], least: float) -> tuple[Measured, ...]:
    """A row is on the Pareto front if none is no worse in cost and error, and better in one of them.

    Errors below ``least`` are not told apart.
    """
    best = inf
    front = set()
    for place in sorted(range(len(rows)), key=lambda k: (rows[k].seconds, rows[k].error)):
        error = max(rows[place].error, least)
        if error < best:
            best = error
            front.add(place)
    return tuple(replace(row, front=place in front) for place, row in enumerate(rows))


def _orders(rows: Sequence[Measured]) -> Iterator[Order]:
    """log2 of the ratio of errors when the step is halved, in the range where neither roundoff nor coarseness rules."""
    ladders: dict[tuple[str, str], list[Measured]] = {}
    for row in rows:
        traits = row.method.traits
        if traits.fixed and traits.order is not None and isfinite(row.error):
            ladders.setdefault((traits.name, row.scalar), []).append(row)
    for (name, scalar), ladder in ladders.items():
        floor = min(row.error for row in ladder)
        slopes = []
        for coarse, fine in pairwise(ladder):
            if coarse.error < 0.05 and fine.error > 30 * floor:
                slopes.append(log2(coarse.error / fine.error))
        if slopes:
            nominal = ladder[0].method.traits.order
            assert nominal is not None
            finest = slopes[-ORDER_OF:]
            yield Order(name, scalar, nominal, statistics.median(finest), len(finest))


def advice(found: Tradeoff, target: float) -> Message:
    """One sentence: which setting reaches the target in the least time, and what a digit more or less would cost.

    Nothing is said to be reached but what was measured, with the reference's own error added.
    """
    known, least, printed_target = found.reference.error, f"{found.smallest_judged:.1e}", plainly(target)
    if target < found.smallest_judged:
        text = (
            "The reference itself is known to [[known]] only: an error of [[target]] cannot be judged here; choose a "
            "target of at least [[least]]."
        )
        return Message(text, known=f"{known:.1e}", target=printed_target, least=least)
    best = found.cheapest(target)
    if best is None:
        nearest = min(found.rows, key=lambda row: row.error)
        if nearest.error == inf:
            return Message("Nothing tried reaches [[target]]: no run came to the end.", target=printed_target)
        text = (
            "Nothing tried reaches [[target]]; the most accurate is [[setting]] with an error of [[error]] in [[time]]."
        )
        error, time = f"{nearest.error:.1e}", duration(nearest.seconds)
        return Message(text, target=printed_target, setting=nearest.label, error=error, time=time)
    judged = best.error > found.smallest_judged
    text = (
        "[[setting]] reaches [[target]] in the least time measured here: error [[error]] over the whole interval (the "
        "reference is good to [[known]]), in [[time]]; one digit more [[more]], one digit less [[less]]."
    )
    return Message(
        text,
        setting=best.label,
        target=printed_target,
        error=f"{best.error:.1e}" if judged else Message("below [[bound]]", bound=least),
        known=f"{known:.1e}",
        time=duration(best.seconds),
        more=_more(found, best, target / 10),
        less=_less(found, best, target * 10),
    )


def _more(found: Tradeoff, best: Measured, target: float) -> Message:
    if target < found.smallest_judged:
        return Message("cannot be judged by this reference")
    other = found.cheapest(target)
    if other is None:
        return Message("is reached by nothing tried here")
    if other is best:
        return Message("costs nothing extra (it is there already)")
    return _compared(other, best)


def _less(found: Tradeoff, best: Measured, target: float) -> Message:
    other = found.cheapest(target)
    return Message("saves nothing") if other is None or other is best else _compared(other, best)


def _compared(other: Measured, best: Measured) -> Message:
    times, time = f"{other.seconds / best.seconds:.2g}", duration(other.seconds)
    text = "costs [[time]], [[times]] times as much ([[setting]])"
    return Message(text, time=time, times=times, setting=other.label)


# The trade of one scenario as a whole: reference, simpler models, ladders of settings, for what the budget pays.
#
# A budget is one of counted work (``mbsym.numerics.planning.prices``), so that the same is measured on every machine.


#: The part of the budget that the search for a reference may cost, where nothing is found that much more, and what it
#: may cost in any case.
FOR_REFERENCE, MOST_FOR_REFERENCE, LEAST_FOR_REFERENCE = 0.6, 0.9, 15.0

#: Places at which models are compared; they differ smoothly.
PLACES = 500


@dataclass(frozen=True)
class Study:
    """What accuracy costs, and what simpler models cost in accuracy (none where that was not asked for)."""

    trade: Tradeoff
    models: tuple[ModelError, ...]


def studied(
    scenario: Scenario,
    methods: Sequence[Method],
    end: float,
    budget: float,
    with_models: bool,
    watch: Callable[[str], None] = lambda text: None,
) -> Study:
    """The study from 0 to ``end``, for what ``budget`` pays (some more where that is too little for a reference).

    Of a system with constraints the initial state is the closest one that satisfies them; with speeds these are
    integrated.

    Raises NotClosed, Breakdown where there is no reference solution up to ``end``, Rests where nothing moves, Failure
    where the equations have no program.
    """
    scenario = begun(scenario).scenario
    dynamics = dynamics_of(scenario)
    if begins_in_equilibrium(dynamics):
        raise Rests
    watch("reference solution")
    usual, at_most = (max(LEAST_FOR_REFERENCE, part * budget) for part in (FOR_REFERENCE, MOST_FOR_REFERENCE))
    truth = whole_reference(dynamics, end, usual, watch, at_most)
    models: tuple[ModelError, ...] = ()
    if with_models:
        places = np.unique(np.linspace(0, len(truth.times) - 1, PLACES).astype(int))
        method = METHODS["lsoda" if truth.way == IMPLICIT else "dop853"]
        models = fidelity.measured(scenario, method, truth.times[places].tolist(), watch, truth.scale)
    return Study(tradeoff(dynamics, methods, truth, max(budget - truth.cost, 0.0), watch), models)
