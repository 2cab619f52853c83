"""What a simulation found: the trajectory, what it keeps, how wrong it is, and everything that was chosen for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.model.states import InStates
from mbsym.model.system import System
from mbsym.numerics.accuracy import ErrorEstimate, NoEstimate
from mbsym.numerics.conservation import Conservation
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.events import Occurrences
from mbsym.numerics.methods.interface import Breakdown, Method, Piece, Run, Setting
from mbsym.numerics.planning.plan import Plan
from mbsym.numerics.planning.reduced import Reduced
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.separable import completing
from mbsym.simulation.request import Request
from mbsym.simulation.watching import Happened, SectionPoints

if TYPE_CHECKING:
    from mbsym.numerics.closing import Closed
    from mbsym.numerics.constrained import Drift
    from mbsym.numerics.enclosure.compare import Certificate
    from mbsym.numerics.simulate import Trajectory


@dataclass(frozen=True)
class PartMethod:
    """Coordinates that are integrated by themselves, and the name of the method that does it."""

    names: tuple[str, ...]
    method: str


@dataclass(frozen=True)
class Chosen:
    """Everything settled before the first step; ``frequency`` is the greatest at the initial state, in rad per time.

    ``resting`` are the coordinates that rest; where that is proved, ``method`` integrates the others only.  ``parts``
    are those that nothing links and that are integrated each by itself; none where all hang together.
    """

    method: Method
    why: str
    measured: str
    setting: Setting
    times: Any
    frequency: float
    resting: Reduced | None = None
    parts: tuple[PartMethod, ...] = ()

    def completed(self, method: Method) -> Method:
        """Another method that integrates the same coordinates."""
        return method if self.resting is None or not self.resting.proved else completing(self.resting, method)


@dataclass(frozen=True)
class FollowedIntegral:
    """A first integral along a run: its column, its values (m,), how far it is conserved, its unit if that is known."""

    column: str
    values: Any
    conservation: Conservation
    unit: str | None = None


@dataclass(frozen=True, repr=False)
class Simulation:
    """The result of ``simulate``.

    ``energy`` (T - U) and ``generalized_energy`` (T2 - T0 - U) are one quantity where nothing is prescribed;
    ``conservation`` is that of the latter and ``energy_conservation`` that of the former.  ``scenario`` is that of the
    model that was integrated, ``given`` the one that was described where that is another; ``plan`` is how an accuracy
    that was asked for is reached.  With constraints ``closed`` says how the initial state was made to satisfy them, and
    ``drift`` how far each row strays from them, ``stepped_over`` are times of positions in which they lose their rank
    that steps went over.
    """

    scenario: Scenario
    dynamics: Dynamics
    request: Request
    chosen: Chosen
    trajectory: Trajectory
    conservation: Conservation
    energy_conservation: Conservation
    invariants: tuple[FollowedIntegral, ...]
    error: ErrorEstimate | NoEstimate
    no_invariants: str = ""
    certificate: Certificate | None = None
    happened: Happened | None = None
    given: Scenario | None = None
    plan: Plan | None = None
    closed: Closed | None = None
    drift: Drift | None = None
    stepped_over: tuple[float, ...] = ()

    def __repr__(self) -> str:
        rows = len(self.times)
        span = f", t = {self.times[0]:g} to {self.times[-1]:g}" if rows else ""
        return f"<Simulation of {self.system.name!r}: {self.method}{span}, {rows} rows>"

    @property
    def events(self) -> Occurrences | None:
        """What happened along the run of what was watched for: ``times``, ``which``, ``turns``, ``states``."""
        return None if self.happened is None else self.happened.occurrences

    @property
    def section(self) -> SectionPoints | None:
        """The Poincare section: ``points`` (axes, m), ``times``, ``states``."""
        return None if self.happened is None else self.happened.section

    @cached_property
    def begins_in_equilibrium(self) -> bool:
        """Whether the exact motion rests at the initial state (``mbsym.numerics.simulate.begins_in_equilibrium``)."""
        from mbsym.numerics.simulate import begins_in_equilibrium  # few runs begin so: not where the result is read

        return self.request.earlier is None and begins_in_equilibrium(self.dynamics)

    @property
    def system(self) -> System:
        """What was simulated."""
        return self.scenario.system

    @cached_property
    def speeds(self) -> dict[str, Any]:
        """The speeds and components of unit vectors that the description declares, by name, each of shape (m,).

        Of a trajectory that went to a file part by part there are none.  Raises Failure where they have no formulas.
        """
        if isinstance(self.system, InStates):
            return {name: self[name] for name in self.given.system.variables} if self.given is not None else {}
        if self.given is None or not self.given.system.speeds or self.trajectory.table is not None:
            return {}
        from mbsym.numerics.body_motion import speed_columns  # few systems have speeds of their own

        return speed_columns(self.given, self.times, self.trajectory.states)

    @property
    def times(self) -> Any:
        """The times of the samples, shape (m,)."""
        return self.trajectory.times

    @property
    def coordinates(self) -> Any:
        """q(t), shape (n, m), in the order of ``system.coordinates``; in declared variables the positions s(t)."""
        return self.trajectory.states[: self.dynamics.size]

    @property
    def velocities(self) -> Any:
        """q'(t), shape (n, m); in declared variables the speeds u(t)."""
        return self.trajectory.states[self.dynamics.size :]

    @property
    def energy(self) -> Any:
        """T - U, shape (m,)."""
        return self.trajectory.energy

    @property
    def generalized_energy(self) -> Any:
        """T2 - T0 - U, shape (m,)."""
        return self.trajectory.generalized_energy

    @property
    def method(self) -> str:
        """The name of the method."""
        return self.chosen.method.traits.name

    @property
    def why(self) -> str:
        """Why this method."""
        return self.chosen.why

    @property
    def arithmetic(self) -> str:
        """float64, float32 or extended."""
        return self.request.arithmetic

    @property
    def whole(self) -> bool:
        """Whether it reached the time asked for."""
        return self.trajectory.whole

    @property
    def ended(self) -> Breakdown | None:
        """Why it ended early."""
        return self.trajectory.breakdown

    @cached_property
    def dense(self) -> Dense:
        """The solution between the rows, as a function of time; see ``at``."""

        def start() -> Run:
            return self.chosen.method.start(self.dynamics, self.chosen.setting, self.arithmetic)

        return Dense(start, float(self.times[0]), float(self.times[-1]))

    def at(self, times: Any) -> Any:
        """The states (q, q') at any times from 0 to where the run ended: shape (2n, m), or (2n,) at one time.

        They come from the method's dense output, from a repetition of the run that is made when it is first asked for.
        Raises ValueError for a time beyond the run.
        """
        return self.dense(times)

    def __call__(self, times: Any) -> Any:
        """The same as ``at``."""
        return self.at(times)

    def __getitem__(self, name: str) -> Any:
        """The samples of a coordinate, a velocity (``theta_dot``), a first integral's column, or ``t``; shape (m,).

        Raises KeyError for any other name.
        """
        if name == "t":
            return self.times
        rows = (*self.system.coordinates, *self.system.velocities)
        if name in rows:
            return self.trajectory.states[rows.index(name)]
        for invariant in self.invariants:
            if invariant.column == name:
                return invariant.values
        if name in self.speeds:
            return self.speeds[name]
        raise KeyError(name)


# The solution between the rows, anywhere from 0 to where the run ended.
#
# A run keeps its rows only: a million of them shall not bring the coefficients of all steps with them.  Whoever asks
# for more has the run integrated again, with the same method, steps and arithmetic, and its steps kept, if they are
# not too many; else every question costs an integration.


#: Steps are kept up to so many, a kilobyte or so each.
MOST_KEPT = 50_000


class Dense:
    """States (2n, m) at any times from ``begin`` to ``end``; ``start`` begins the run anew."""

    def __init__(self, start: Callable[[], Run], begin: float, end: float) -> None:
        self._start, self.begin, self.end = start, begin, end
        self._pieces: list[Piece] | None = None
        self._ends: Any = None
        self._too_many = False

    def __call__(self, times: Any) -> Any:
        """The states (2n, m) at m times in any order, or (2n,) at one.

        Raises ValueError for a time beyond the run, Breakdown where it cannot be repeated so far.
        """
        at = np.asarray(times, dtype=float)
        if not np.all((at >= self.begin) & (at <= self.end)):
            raise ValueError(f"the run goes from t = {self.begin:.9g} to {self.end:.9g}")
        if at.ndim > 1:
            raise ValueError(f"a time or an array of times, not one of shape {at.shape}")
        flat = np.atleast_1d(at)
        order = np.argsort(flat, kind="stable")
        sorted_states = self._ordered(flat[order])
        states = np.empty_like(sorted_states)
        states[:, order] = sorted_states
        return states if at.ndim else states[:, 0]

    def _ordered(self, times: Any) -> Any:
        """The states at increasing times."""
        run = self._start()
        if not len(times):
            return np.empty((len(run.state), 0), np.asarray(run.state).dtype)
        if self._pieces is None and not self._too_many:
            self._keep(run)
        if self._pieces is None:
            return self._start().fill(times)
        places = np.minimum(np.searchsorted(self._ends, times), len(self._pieces) - 1)
        cuts = np.flatnonzero(np.diff(places)) + 1
        parts = zip(np.split(places, cuts), np.split(times, cuts), strict=True)
        return np.hstack([self._pieces[place[0]].curve(part) for place, part in parts])

    def _keep(self, run: Run) -> None:
        """The steps of the run up to its end; nothing where they are too many."""
        pieces: list[Piece] = []
        try:
            while run.time < self.end:
                if len(pieces) == MOST_KEPT:
                    self._too_many = True
                    return
                pieces.append(run.step())
        except Breakdown as breakdown:
            if not pieces or pieces[-1].end < self.end:
                raise breakdown
        if not pieces:  # it ended where it began
            state = np.array(run.state)
            pieces.append(Piece(self.begin, self.end, lambda times: np.repeat(state[:, None], len(times), axis=1)))
        self._pieces, self._ends = pieces, np.array([float(piece.end) for piece in pieces])
