"""What is said of a run: what was integrated, how good it is, what happened; and how it was done."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.expressions.message import Message, joined
from mbsym.model.quantities import time_unit, with_unit
from mbsym.numerics.simulate import BEGIN_BESIDE, least_pivot
from mbsym.report.runs.certificate import certificate_lines
from mbsym.report.runs.constrained_run_words import constraint_lines
from mbsym.report.runs.events import events_lines
from mbsym.report.runs.plan_words import bound_lines, choice_lines
from mbsym.report.runs.simulation_words import (
    change_lines,
    energy_lines,
    inputs_line,
    invariant_line,
    passed_over,
    quality,
    setting_words,
    state_lines,
    switch_line,
)
from mbsym.report.unit_text import pretty

if TYPE_CHECKING:
    from mbsym.numerics.planning.reduced import Reduced
    from mbsym.simulation import Simulation

#: Of more rows than this the first ones tell whether rows stand at the ends of steps.
MOST_LOOKED_AT = 20_001

#: Below this much of what it was a pivot of M costs digits worth a warning.
NEARLY_SINGULAR = 1e-8

#: Of constraints and declared variables, what is said of how rather than of how well.
_HOW = ("loops", "variables")


def result_lines(run: Simulation, file: str) -> Iterator[tuple[str, str]]:
    """(title, text), without a title what goes on: what was integrated, its error, what is kept, what happened.

    ``file``: the name of the description, for commands to be pasted.
    """
    trajectory, request, unit = run.trajectory, run.request, pretty(time_unit(run.system))
    doubts, messages, unknown = quality(run)
    errors = [("" if place else "error", text) for place, text in enumerate(messages)]
    yield from (("warning", text) for text in doubts)
    if unknown:
        yield from errors
    if run.begins_in_equilibrium:
        yield "motion", Message("none: the initial state is an equilibrium; [[advice]]", advice=BEGIN_BESIDE)
    if run.plan is not None:
        yield from bound_lines(run.plan, unit)
    yield "time", _time_line(run, unit)
    if request.earlier is not None:
        text, begin = "from t = [[time]]; rows before it: [[rows]]", with_unit(f"{request.earlier.time:.9g}", unit)
        yield "continued", Message(text, time=begin, rows=len(request.earlier.times))
    if run.scenario.inputs:
        yield "inputs", inputs_line(run.scenario)
    if not unknown:
        yield from errors
    yield from _beside(run, how=False)
    yield from events_lines(run)
    energies = list(energy_lines(run))
    for place, (which, what) in enumerate(energies):
        alone = len(energies) == 1
        yield "" if place else "energy", what if alone else Message("[[which]]: [[what]]", which=which, what=what)
    for invariant in run.invariants:
        yield "invariant", invariant_line(invariant.conservation)
    if run.certificate is not None:
        for place, text in enumerate(certificate_lines(run.certificate, run.system, len(trajectory.times))):
            yield "" if place else "certified", text
    yield from (("warning", text) for text in passed_over(run, file))
    yield from (("warning", text) for text in _doubtful(run, unit))


def _beside(run: Simulation, how: bool) -> Iterator[tuple[str, str]]:
    """Lines about constraints and declared variables, with those that go on."""
    last = ""
    for title, text in (*constraint_lines(run), *state_lines(run)):
        last = title or last
        if (last in _HOW) is how:
            yield title, text


def _time_line(run: Simulation, unit: str | None) -> Message:
    trajectory, end, count = run.trajectory, with_unit(f"{run.request.time:g}", unit), len(run.chosen.times)
    reached = with_unit(f"{trajectory.times[-1]:.9g}", unit)
    if run.happened is not None and run.happened.ended is not None:
        text = "0 to [[time]], [[count]] samples, of which [[kept]] up to t = [[reached]], where it was stopped"
        return Message(text, time=end, count=count, kept=trajectory.samples, reached=reached)
    if not trajectory.whole:
        return Message("0 to [[time]], [[count]] samples, reached [[reached]]", time=end, count=count, reached=reached)
    return Message("0 to [[time]], [[count]] samples", time=end, count=count)


def _doubtful(run: Simulation, unit: str | None) -> Iterator[Message]:
    trajectory, chosen = run.trajectory, run.chosen
    ratio, at = least_pivot(run.dynamics, trajectory) if trajectory.least_pivot is None else trajectory.least_pivot
    if trajectory.breakdown is None and ratio < NEARLY_SINGULAR:
        if run.closed is None:
            text = "at t = [[time]] the mass matrix was nearly singular (a pivot fell to [[pivot]])"
        else:
            text = "at t = [[time]] the mass matrix or the constraints were nearly singular (a pivot fell to [[pivot]])"
        yield Message(text, time=with_unit(f"{at:.6g}", unit), pivot=f"{ratio:.1e}")
    if chosen.frequency * float(chosen.times[1] - chosen.times[0]) > pi / 2:
        text = (
            "fewer than 4 samples a period of the fastest oscillation about the initial state: figures may deceive; "
            "raise --samples"
        )
        yield Message(text)


def method_lines(run: Simulation) -> Iterator[tuple[str, str]]:
    """(title, text): the method and why, its setting and work, what was taken out; of a plan its choices."""
    chosen, request, setting, work = run.chosen, run.request, run.trajectory.setting, run.trajectory.work
    if run.plan is not None:
        yield from choice_lines(run.plan)
    else:
        why = joined(filter(None, (chosen.why, chosen.measured)), ": ")
        yield "method", Message("[[method]] ([[why]])", method=chosen.method.traits.title, why=why)
        yield "setting", setting_words(setting, request.arithmetic)
        if setting.step is not None and _between(chosen.times, setting.step):
            if run.dynamics.in_states:
                text = "rows between the ends of steps by the polynomial that fits the states and their rates there"
            else:
                text = "rows between the ends of steps by the polynomial that fits q, q', q'' there"
            yield "", Message(text)
    for place, text in enumerate(change_lines(work.changes, pretty(time_unit(run.system)))):
        yield "" if place else "changes", text
    if chosen.resting is not None:
        yield "resting", _rest_line(chosen.resting)
    if chosen.parts:
        shares = " | ".join(f"{', '.join(part.names)} ({part.method})" for part in chosen.parts)
        yield "parts", Message("[[parts]]: nothing links them, each has its own steps", parts=shares)
    yield from _beside(run, how=True)
    if (switches := switch_line(run.trajectory.passed)) is not None:
        yield "switches", switches
    messages = [Message("steps: [[count]]", count=work.steps)]
    messages += [Message("rejected: [[count]]", count=work.rejected)] if work.rejected else []
    messages.append(Message("evaluations: [[count]]", count=work.evaluations))
    messages += [Message("Jacobians: [[count]]", count=work.jacobians)] if work.jacobians else []
    messages.append(Message("[[seconds]] s", seconds=f"{run.trajectory.seconds:.3g}"))
    yield "work", joined(messages, ", ")


def _between(times: Any, step: float) -> bool:
    """Whether there are rows at which no step ends."""
    passed = np.asarray(times[: min(len(times) - 1, MOST_LOOKED_AT)]) / step
    return not np.allclose(passed, np.round(passed), rtol=1e-12, atol=1e-6)


def _rest_line(reduced_system: Reduced) -> Message:
    """What was taken out of the integration, how it is known, and what that saved."""
    names, how = ", ".join(reduced_system.names), reduced_system.reduction.how
    if not reduced_system.proved:
        return Message("[[names]] ([[how]], not proved): integrated all the same", names=names, how=how)
    (whole, less), n = reduced_system.operations, reduced_system.whole.size
    text = (
        "[[names]] (proved): [[count]] of [[all]] coordinates integrated, [[less]] operations a right-hand side "
        "instead of [[whole]]"
    )
    return Message(text, names=names, count=n - len(reduced_system.names), all=n, less=less, whole=whole)
