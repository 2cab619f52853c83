"""What is watched for along a run, as asked for and as found: events, conditions that end it, a Poincare section."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.expressions.condition import Condition, parse_axes, parse_condition
from mbsym.expressions.place import Complaint, Complaints, in_line
from mbsym.expressions.tree import Expression, Name, names
from mbsym.model.states import InStates
from mbsym.model.system import System, velocity_name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.events.events import Occurrence, Occurrences
from mbsym.numerics.events.surfaces import Action, Event, event, known_names, node
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.methods.interface import Cause, Method
from mbsym.numerics.simulate import Trajectory
from mbsym.numerics.watched import Watched


@dataclass(frozen=True)
class Axis:
    """An axis of a section: ``text`` is what was written; with a ``period`` p it is taken from -p/2 to p/2."""

    text: str
    expression: Expression
    period: Expression | None = None


@dataclass(frozen=True)
class Section:
    """The states on a surface, shown in some axes."""

    condition: Condition
    axes: tuple[Axis, ...]


@dataclass(frozen=True)
class Watch:
    """What is asked for."""

    events: tuple[Condition, ...] = ()
    stops: tuple[Condition, ...] = ()
    section: Section | None = None

    def __bool__(self) -> bool:
        return bool(self.events or self.stops or self.section)


@dataclass(frozen=True)
class SectionPoints:
    """``points`` (axes, m) in the ``axes`` of the section, ``times`` (m,), ``turns`` (m,), ``states`` (2n, m)."""

    section: Section
    times: Any
    turns: Any
    points: Any
    states: Any


@dataclass(frozen=True)
class Happened:
    """What was found: ``occurrences`` of events and stops, the points of the section."""

    occurrences: Occurrences
    section: SectionPoints | None = None

    @property
    def ended(self) -> Occurrence | None:
        """What ended the run, as it was asked to."""
        return self.occurrences.ended


class NoEvent(ValueError):
    """A condition without a value at these numbers; ``option`` is where it was given."""

    def __init__(self, option: str, text: str, reason: str) -> None:
        super().__init__(f"{option} {text!r} has no value: {reason}")
        self.option, self.text, self.reason = option, text, reason


def read_watch(
    system: System,
    events: Sequence[str] = (),
    stops: Sequence[str] = (),
    section: str | None = None,
    axes: str = "",
    unread: Callable[[str, str, Complaint], None] | None = None,
) -> Watch:
    """Texts as conditions; ``unread`` takes the complaints, each with what it is of and the text.

    Raises ValueError with everything that is wrong where nobody takes them.
    """
    wrong: list[str] = []
    known = known_names(system)

    def complain(option: str, text: str, complaints: Complaints) -> None:
        for item in complaints.sorted():
            if unread is not None:
                unread(option, text, item)
            else:
                wrong.append(f"{option} {text!r}: {item.message}")

    def read(option: str, text: str) -> Condition | None:
        complaints = Complaints()
        parsed_condition = parse_condition(text, known, complaints, in_line)
        complain(option, text, complaints)
        return parsed_condition

    marks = [read("event", text) for text in events]
    ends = [read("stop", text) for text in stops]
    condition = None if section is None else read("section", section)
    if axes and section is None and unread is None:
        wrong.append("axes are those of a section, and there is none")
    complaints = Complaints()
    written = parse_axes(axes, known, complaints, in_line) if axes else ()
    complain("axes", axes, complaints)
    if wrong:
        raise ValueError("; ".join(wrong))
    return Watch(
        tuple(mark for mark in marks if mark is not None),
        tuple(end for end in ends if end is not None),
        None if condition is None else section_of(system, condition, written),
    )


def section_of(
    system: System, condition: Condition, axes: Sequence[tuple[str, Expression, Expression | None]]
) -> Section:
    """A section in the axes asked for; else the first coordinate that the condition does not name, and its velocity.

    In declared variables the first two that it does not name.
    """
    if axes:
        return Section(condition, tuple(Axis(*axis) for axis in axes))
    named = names(condition.difference)
    if isinstance(system, InStates):
        free = [name for name in (*system.coordinates, *system.velocities) if name not in named]
        return Section(condition, tuple(Axis(name, Name(name)) for name in free[:2]))
    shown = next((name for name in system.coordinates if name not in named), system.coordinates[0])
    return Section(condition, tuple(Axis(name, Name(name)) for name in (shown, velocity_name(shown))))


class Watching:
    """A request put into code; ``method`` integrates and watches."""

    def __init__(self, dynamics: Dynamics, method: Method, asked: Watch) -> None:
        self._asked, self._dynamics = asked, dynamics
        conditions = [("event", recorded, Action.RECORD) for recorded in asked.events]
        conditions += [("stop", stop, Action.STOP) for stop in asked.stops]
        conditions += [("section", asked.section.condition, Action.RECORD)] if asked.section is not None else []
        events: list[Event] = []
        for option, condition, action in conditions:
            try:
                events.append(event(dynamics, condition, action))
            except Failure as reason:
                raise NoEvent(option, condition.text, str(reason)) from None
        self._axes = None if asked.section is None else _axes(dynamics, asked.section)
        self.method = Watched(method, dynamics, events)

    def happened(self, trajectory: Trajectory) -> tuple[Trajectory, Happened]:
        """The trajectory, whole where it ended as it was asked to, and what happened along it."""
        everything = self.method.occurrences(float(trajectory.times[-1]))
        if trajectory.breakdown is not None and trajectory.breakdown.kind == Cause.STOPPED:
            trajectory = replace(trajectory, breakdown=None)
        if self._axes is None or self._asked.section is None:
            return trajectory, Happened(everything)
        last = len(everything.events) - 1
        own = everything.which == last
        times, turns, states = everything.times[own], everything.turns[own], everything.states[:, own]
        points = _wrapped(kernel(self._axes)(np.vstack([times, states])) if len(times) else np.empty((0, 0)))
        section = SectionPoints(self._asked.section, times, turns, points, states)
        return trajectory, Happened(_without(everything, last), section)


def _without(occurrences: Occurrences, event: int) -> Occurrences:
    """Without the last of the events, which is the section."""
    rest = occurrences.which != event
    return replace(
        occurrences,
        events=occurrences.events[:event],
        times=occurrences.times[rest],
        which=occurrences.which[rest],
        turns=occurrences.turns[rest],
        states=occurrences.states[:, rest],
        undecided=tuple(item for item in occurrences.undecided if item is not occurrences.events[event]),
    )


def _axes(dynamics: Dynamics, section: Section) -> Code:
    """(t, q, q') -> for every axis its value and its period, 0 where it has none."""
    program = dynamics.right_hand_side.program
    outputs = []
    for axis in section.axes:
        try:
            period = program.zero if axis.period is None else node(dynamics, axis.period)
            outputs += [node(dynamics, axis.expression), period]
        except Failure as reason:
            raise NoEvent("axes", axis.text, str(reason)) from None
    return Code(program, dynamics.inputs, tuple(outputs))


def _wrapped(values: Any) -> Any:
    """Values, each less a multiple of its period."""
    quantities, periods = values[0::2], values[1::2]
    with np.errstate(all="ignore"):
        return np.where(periods > 0, quantities - periods * np.round(quantities / periods), quantities)
