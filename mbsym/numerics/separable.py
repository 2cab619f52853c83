"""Coordinates that know nothing of each other: each part of a system integrated by itself, with steps of its own.

Coordinates S and the others O are parts where the blocks M_SO of the mass matrix vanish and q_S'' depends on t, q_S and
q_S' only; then M_SS q_S'' = f_S, and q_S moves as it does with q_O held.  That is read off the program of q'', after
numbers are in it: what does not occur there has no influence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from mbsym.algebra.matrices import united
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import number
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import SCALARS
from mbsym.numerics.methods.interface import (
    COUNTS,
    Breakdown,
    Method,
    Passed,
    Piece,
    Run,
    Setting,
    Traits,
    Work,
    together,
)
from mbsym.numerics.methods.tableaux import initial_state
from mbsym.numerics.planning.reduced import Reduced, without
from mbsym.numerics.scenario import Scenario


@dataclass(frozen=True)
class Part:
    """Coordinates ``names`` with equations of their own; ``places`` of their states among those of the whole."""

    names: tuple[str, ...]
    places: tuple[int, ...]
    dynamics: Dynamics


def separated(dynamics: Dynamics) -> tuple[Part, ...]:
    """The parts of a scenario in the order of their first coordinates; one, the whole, where all hang together."""
    n, names = dynamics.size, dynamics.system.coordinates
    # Constraints may link what the accelerations at some values do not.
    if dynamics.constraints is not None or dynamics.in_states:
        return (Part(names, tuple(range(2 * n)), dynamics),)
    linked = list(_linked(dynamics))
    if len(united(linked)) > 1:
        masses = dynamics.mass_matrix
        pairs = ((i, j) for i, j in product(range(n), range(n)) if i != j)
        linked += [{i, j} for i, j in pairs if not masses.program.vanishes(masses.outputs[i * n + j])]
    groups = sorted(map(sorted, united(linked)))
    if len(groups) == 1:
        return (Part(names, tuple(range(2 * n)), dynamics),)
    parts = []
    for own in groups:
        scenario = _alone(dynamics.scenario, {names[i] for i in own})
        places = (*own, *(n + i for i in own))
        parts.append(Part(tuple(names[i] for i in own), places, Dynamics(scenario)))
    return tuple(parts)


def _linked(dynamics: Dynamics) -> Iterator[set[int]]:
    """Each coordinate with those that q'' of it depends on."""
    n, code = dynamics.size, dynamics.right_hand_side
    owner = {name: place % n for place, name in enumerate(code.inputs[1:])}
    for i in range(n):
        live = map(code.program.instructions.__getitem__, code.program.live(code.outputs[n + i : n + i + 1]))
        read = (str(instruction.payload) for instruction in live if instruction.operation == "input")
        yield {i, *(owner[name] for name in read if name in owner)}


def _alone(scenario: Scenario, names: set[str]) -> Scenario:
    """The scenario with all other coordinates held where they start."""
    held = {
        name: number(position)
        for name, position in zip(scenario.system.coordinates, scenario.positions, strict=True)
        if name not in names
    }
    return without(scenario, held)


def completing(resting: Reduced, method: Method) -> Separate:
    """A method that integrates the coordinates that move by another, and shows whole states."""
    places, _ = resting.reduction.expanded(resting.whole.scenario)
    dynamics = resting.dynamics
    return Separate(resting.whole, [Part(dynamics.system.coordinates, places, dynamics)], [method])


def held(dynamics: Dynamics, method: Method) -> Separate:
    """What integrates nothing, where nothing moves: whole states rest where they start; called by the name of
    ``method``, which could have done it but for roundings."""
    return Separate(dynamics, (), (method,))


class Separate:
    """A method that integrates the parts of ``whole`` one beside the other, each by a method of its own.

    What is in none of them rests where it starts.
    """

    def __init__(self, whole: Dynamics, parts: Sequence[Part], methods: Sequence[Method]) -> None:
        self._whole, self._parts, self._methods = whole, tuple(parts), tuple(methods)
        self.traits = _traits(parts, methods)

    def start(
        self, dynamics: Dynamics, setting: Setting, scalar: str = "float64", initial: Any = None, at: float = 0.0
    ) -> Run:
        """Raises ValueError for the dynamics of another scenario or an ``initial`` state that moves what rests,
        Unusable where a method does not apply to a part."""
        if dynamics is not self._whole:
            raise ValueError("this method was made for the dynamics of another scenario")
        runs = [
            method.start(part.dynamics, setting, scalar, None if initial is None else initial[list(part.places)], at)
            for part, method in zip(self._parts, self._methods, strict=bool(self._parts))
        ]
        dtype = np.asarray(runs[0].state).dtype.type if runs else SCALARS[scalar].dtype
        beside = _Beside(self._parts, runs, initial_state(dynamics, dtype), at)
        if initial is not None:
            beside.require_rest(initial)
        return beside


def _traits(parts: Sequence[Part], methods: Sequence[Method]) -> Traits:
    """Those of the one method, or of several."""
    first = methods[0].traits
    if len(methods) == 1:
        return first
    scalars = tuple(kind for kind in first.scalars if all(kind in method.traits.scalars for method in methods))
    pairs = zip(parts, methods, strict=True)
    title = joined([joined([", ".join(part.names), method.traits.title], ": ") for part, method in pairs], "; ")
    same = all(method.traits.name == first.name for method in methods)
    orders = {method.traits.order for method in methods}
    return Traits(
        name=first.name if same else "parts",
        title=Message("[[method]], each part by itself", method=first.title) if same else title,
        order=first.order if len(orders) == 1 else None,
        fixed=first.fixed,
        scalars=scalars,
        implicit=any(method.traits.implicit for method in methods),
        conservative=any(method.traits.conservative for method in methods),
        least=max(method.traits.least for method in methods),
    )


@dataclass
class _Beside:
    """Runs of the parts, brought to the same times; ``ahead`` keeps what some have beyond the time that is shown.

    ``whole`` is the state (2n,) at the start, which holds what is in no part.
    """

    parts: Sequence[Part]
    runs: Sequence[Run]
    whole: Any
    time: float = 0.0
    state: Any = None
    ahead: list[Piece | None] = field(default_factory=list)
    work: Work = field(default_factory=Work)

    def __post_init__(self) -> None:
        self.ahead = [None] * len(self.runs)
        self.state = self._joined([run.state for run in self.runs])

    @property
    def passed(self) -> Passed | None:
        """What the parts have met on their way."""
        return together(self.runs, [partial(self._of_part, part) for part in self.parts])

    def _of_part(self, part: Part, state: Any) -> Any:
        """A whole state that tells of one part only."""
        return self._joined([state if other is part else np.full(len(other.places), np.nan) for other in self.parts])

    def require_rest(self, state: Any) -> None:
        """Raises ValueError where a state moves what is in no part."""
        given = np.asarray(state).astype(self.whole.dtype)
        if not np.array_equal(self._joined([given[list(part.places)] for part in self.parts]), given):
            raise ValueError("a state that moves what was taken out of the integration because it rests")

    def _count(self) -> None:
        """The work of all parts together."""
        for name in (*COUNTS, "compiling"):
            setattr(self.work, name, sum(getattr(run.work, name) for run in self.runs))
        self.work.changes[:] = sorted(
            (change for run in self.runs for change in run.work.changes), key=lambda change: change.time
        )

    def _joined(self, states: Sequence[Any], shape: tuple[int, ...] = ()) -> Any:
        """Whole states of those of the parts, one or in columns."""
        shape = np.shape(states[0])[1:] if states else shape
        whole = np.empty((len(self.whole), *shape), self.whole.dtype)
        whole[...] = self.whole.reshape(-1, *[1] * len(shape))
        for part, state in zip(self.parts, states, strict=True):
            whole[list(part.places)] = state
        return whole

    def advance(self, until: float) -> Any:
        return self.fill(np.array([until], dtype=float))[:, 0]

    def fill(self, times: Any) -> Any:
        """Where one part breaks down the others are brought to that time, too."""
        times = np.asarray(times)
        states: list[Any] = []
        ended: tuple[int, Breakdown] | None = None
        for place in range(len(self.runs)):
            try:
                states.append(self._filled(place, times))
            except Breakdown as breakdown:
                count = 0 if breakdown.filled is None else breakdown.filled.shape[1]
                times, states = times[:count], [state[:, :count] for state in states]
                states.append(
                    np.empty((len(self.parts[place].places), 0)) if breakdown.filled is None else breakdown.filled
                )
                ended = (place, breakdown) if ended is None or breakdown.time < ended[1].time else ended
        self._count()
        filled = self._joined(states, times.shape)
        if ended is not None:
            raise self._ended(*ended, filled[:, -1] if filled.shape[1] else self.state, filled)
        if len(times):
            self.time, self.state = float(times[-1]), filled[:, -1].copy()
        return filled

    def _ended(self, place: int, found: Breakdown, others: Any, filled: Any = None) -> Breakdown:
        """With a whole state: that of the part which broke down, and the ``others``."""
        state = np.array(others, dtype=float)
        state[list(self.parts[place].places)] = found.state
        return Breakdown(found.kind, found.message, found.time, state, filled)

    def _filled(self, place: int, times: Any) -> Any:
        """The states of one part, from what it has already and from its run."""
        piece, run = self.ahead[place], self.runs[place]
        known = 0 if piece is None else int(np.searchsorted(times, piece.end, side="right"))
        early = piece(times[:known]) if piece is not None and known else None
        if known == len(times):
            return early
        self.ahead[place] = None
        try:
            late = run.fill(times[known:])
        except Breakdown as breakdown:
            filled = (
                breakdown.filled
                if early is None
                else early
                if breakdown.filled is None
                else np.hstack((early, breakdown.filled))
            )
            raise Breakdown(breakdown.kind, breakdown.message, breakdown.time, breakdown.state, filled) from None
        return late if early is None else np.hstack((early, late))

    def step(self, until: float | None = None) -> Piece:
        """To where the first of the parts ends its step; the others keep theirs."""
        start = self.time
        pieces: list[Piece] = []
        for place, run in enumerate(self.runs):
            pending = self.ahead[place]
            if pending is None or pending.end <= start:
                try:
                    pending = self.ahead[place] = run.step(until)
                except Breakdown as ended:
                    raise self._ended(place, ended, self.state) from None
            pieces.append(pending)
        ends = [piece.end for piece in pieces] or [2 * abs(start) + 1.0]
        end = min(ends) if until is None else min(until, *ends)
        curves: list[Callable[[Any], Any]] = [piece.curve for piece in pieces]
        joined = self._joined
        combined = Piece(start, end, lambda times: joined([curve(times) for curve in curves], np.shape(times)))
        self.time, self.state = end, combined(end)
        self._count()
        return combined

    def restart(self, time: float, state: Any) -> None:
        self.require_rest(state)
        whole = np.asarray(state)
        for part, run in zip(self.parts, self.runs, strict=True):
            run.restart(time, whole[list(part.places)])
        self.ahead = [None] * len(self.runs)
        self.time, self.state = time, self._joined([run.state for run in self.runs])
