"""What ``mbsym simulate`` tells: how it went, how good it is, and what broke down."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mbsym.expressions.counting import counted
from mbsym.model.quantities import time_unit, unit_of, with_unit
from mbsym.report.unit_text import pretty
from mbsym_cli.console import console, printable

if TYPE_CHECKING:
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.planning.reduced import Reduced
    from mbsym.numerics.simulate import Trajectory
    from mbsym.simulation import Simulation

#: Of more rows than this the first ones tell whether rows stand at the ends of steps.
MOST_LOOKED_AT = 20_001

#: Below this much of what it was a pivot of M costs digits worth a warning.
NEARLY_SINGULAR = 1e-8


def print_summary(file: Path, run: Simulation, paths: Sequence[Path]) -> None:
    from rich.text import Text

    out = console()
    out.print(Text.assemble((run.system.name, "bold"), (f"  {printable(file)}", "dim")))
    for name, text in _lines(run, file):
        style = "yellow" if name == "warning" else "bold cyan"
        out.print(Text.assemble("  ", (f"{name:<{10 if run.plan else 9}} ", style), text))
    names = ", ".join(path.name for path in paths)
    out.print(Text.assemble("  files in ", (printable(paths[0].parent), "bold"), f": {names}"))


def _lines(run: Simulation, file: Path) -> Iterator[tuple[str, str]]:
    """(title, text) of the summary's lines."""
    from mbsym.numerics.breakdowns import least_pivot
    from mbsym.report.runs.between_steps import passed_over, switch_line
    from mbsym.report.runs.certificate import certificate_lines
    from mbsym.report.runs.constrained_run_words import constraint_lines
    from mbsym.report.runs.events_words import events_lines
    from mbsym.report.runs.plan_words import plan_lines
    from mbsym.report.runs.simulation_words import (
        change_lines,
        energy_lines,
        inputs_line,
        invariant_line,
        quality,
    )
    from mbsym.report.runs.state_run_words import state_lines

    found, chosen, request = run.trajectory, run.chosen, run.request
    doubts, told, unknown = quality(run)
    errors = [("" if place else "error", text) for place, text in enumerate(told)]
    yield from (("warning", text) for text in doubts)
    if unknown:
        yield from errors
    if run.plan is not None:
        yield from plan_lines(run.plan, pretty(time_unit(run.system)))
    work = found.work
    if run.plan is None:
        yield from _method_lines(run)
    for text in change_lines(work.changes, pretty(time_unit(run.system))):
        yield "changes", text
    unit = pretty(time_unit(run.system))
    reached = "" if found.whole else f", reached {with_unit(f'{found.times[-1]:.9g}', unit)}"
    if run.happened is not None and run.happened.ended is not None:
        reached = (
            f", of which {found.samples} up to t = {with_unit(f'{found.times[-1]:.9g}', unit)}, where it was stopped"
        )
    yield "time", f"0 to {with_unit(f'{request.time:g}', unit)}, {len(chosen.times)} samples{reached}"
    if request.earlier is not None:
        begin = with_unit(f"{request.earlier.time:.9g}", unit)
        yield "continued", f"from t = {begin}; {counted(len(request.earlier.times), 'row', 'rows')} before it"
    if run.scenario.inputs:
        yield "inputs", inputs_line(run.scenario)
    if chosen.resting is not None:
        yield "resting", _rest_line(chosen.resting)
    if chosen.parts:
        shares = " | ".join(f"{', '.join(part.names)} ({part.method})" for part in chosen.parts)
        yield "parts", f"{shares}: nothing links them, each has its own steps"
    evaluations = counted(work.evaluations, "evaluation", "evaluations")
    jacobians = f" and {counted(work.jacobians, 'Jacobian', 'Jacobians')}" if work.jacobians else ""
    rejected = f" ({work.rejected} rejected)" if work.rejected else ""
    yield "work", f"{counted(work.steps, 'step', 'steps')}{rejected}, {evaluations}{jacobians}, {found.seconds:.3g} s"
    yield from constraint_lines(run)
    yield from state_lines(run)
    yield from events_lines(run)
    if switches := switch_line(found.passed):
        yield "switches", switches
    energies = list(energy_lines(run))
    for place, (which, what) in enumerate(energies):
        title = "energy" if len(energies) == 1 else "" if place else "energies"
        yield title, what if len(energies) == 1 else f"{which}: {what}"
    for kept in run.invariants:
        yield "invariant", invariant_line(kept.conservation)
    if not unknown:
        yield from errors
    if run.certificate is not None:
        for place, text in enumerate(certificate_lines(run.certificate, run.system, len(found.times))):
            yield "" if place else "certified", text
    for text in passed_over(run, printable(file)):
        yield "warning", text
    ratio, at = least_pivot(run.dynamics, found) if found.least_pivot is None else found.least_pivot
    if found.breakdown is None and ratio < NEARLY_SINGULAR:
        what = "the mass matrix was" if run.closed is None else "the mass matrix was, or the constraints were,"
        where = with_unit(f"{at:.6g}", unit)
        yield "warning", f"at t = {where} {what} nearly singular (a pivot fell to {ratio:.1e})"
    spacing = float(chosen.times[1] - chosen.times[0])
    if chosen.frequency * spacing > pi / 2:
        yield "warning", "fewer than 4 samples a period of the fastest oscillation: figures deceive; raise --samples"


def _method_lines(run: Simulation) -> Iterator[tuple[str, str]]:
    """The method with the reason for it, and its setting."""
    chosen, request, setting = run.chosen, run.request, run.trajectory.setting
    measured = f": {chosen.measured}" if chosen.measured else ""
    yield "method", f"{chosen.method.traits.title} ({chosen.why}{measured})"
    if setting.step is None:
        how = f"tolerance {setting.tolerance:g} per step"
    else:
        how = f"step {setting.step:g}" + _between(chosen.times, setting.step, run.dynamics.in_states)
    longest = f", steps up to {setting.longest:g}" if setting.longest is not None else ""
    yield "setting", f"{how}{longest}, {request.arithmetic}"


def _between(times: Any, step: float, in_states: bool) -> str:
    """How rows that no step ends at came about."""
    passed = np.asarray(times[: min(len(times) - 1, MOST_LOOKED_AT)]) / step
    if np.allclose(passed, np.round(passed), rtol=1e-12, atol=1e-6):
        return ""
    what = "the states and their rates" if in_states else "q, q', q''"
    return f"; rows between the ends of steps by the polynomial that fits {what} there"


def _rest_line(found: Reduced) -> str:
    """What was taken out of the integration, how it is known, and what that saved."""
    names = ", ".join(found.names)
    rest = "rests" if len(found.names) == 1 else "rest"
    if not found.proved:
        return f"{names} {rest} ({found.reduction.how}, not proved): integrated all the same"
    whole, less = found.operations
    n = found.whole.size
    saved = f"{less} operations a right-hand side instead of {whole}"
    return f"{names} {rest} (proved): {n - len(found.names)} of {n} coordinates integrated, {saved}"


def broken(file: Path, ended: Breakdown, found: Trajectory, paths: Sequence[Path]) -> str:
    """What happened, when, and in which state."""
    from mbsym.numerics.methods.interface import (
        BLOW_UP,
        SINGULAR,
        SINGULAR_CONSTRAINTS,
        STEP_LIMIT,
        STUCK,
        UNDEFINED,
    )
    from mbsym.numerics.methods.sides import OUTSIDE, SWITCHING

    names = [*found.system.coordinates, *found.system.velocities]
    system, time = found.system, pretty(time_unit(found.system))
    state = ", ".join(
        f"{name} = {with_unit(f'{float(value):.6g}', pretty(unit_of(system, name)))}"
        for name, value in zip(names, ended.state, strict=True)
    )
    hints = {
        BLOW_UP: (
            "the motion grows without an end in sight, in finite time or exponentially; is a sign of the forces right?"
            if ended.time > 0
            else "choose other initial values, or units in which the numbers are smaller"
        ),
        SINGULAR: (
            "a coordinate loses its meaning in this state: a distance has shrunk to zero (a collision, a fall to the "
            "centre), or angles are singular (a pole; other angles help); or a mass is zero. Start elsewhere or stop "
            "earlier"
        ),
        SINGULAR_CONSTRAINTS: (
            "a mechanism in a singular position (links in line, branches that meet): the accelerations do not follow "
            "from the constraints there; start beside it"
        ),
        STEP_LIMIT: "raise --step-limit, or choose a larger --tolerance or --step; a stiff system needs --method radau",
        UNDEFINED: "the model says nothing beyond this state; is the sign under a root or a logarithm right?",
        OUTSIDE: "choose a shorter --time, give more points, or say how the table goes on, as 'outside: hold'",
        SWITCHING: "a force that jumps leads back to its jump from both sides: a smooth one, as tanh, goes through it",
        STUCK: "a larger --tolerance may pass; look for a singularity of forces at this state",
    }
    samples, where = counted(found.samples, "sample", "samples"), printable(paths[0].parent)
    kept = f"{samples} up to t = {with_unit(f'{found.times[-1]:.9g}', time)} kept in {where}"
    code, at = ended.kind.replace(" ", "-"), with_unit(f"{ended.time:.9g}", time)
    return "\n".join(
        [
            f"{printable(file)}: error[{code}]: {ended.kind} at t = {at}: {ended.message}",
            f"  state: {state}",
            f"  hint: {hints.get(ended.kind, '')}",
            f"{printable(file)}: {kept}",
        ]
    )


def note(found: Trajectory) -> str:
    """What figures say of a trajectory that is not whole."""
    unit = pretty(time_unit(found.system))
    if found.breakdown is not None:
        return f"ended early: {found.breakdown.kind} at t = {with_unit(f'{found.breakdown.time:.6g}', unit)}"
    return f"interrupted at t = {with_unit(f'{found.times[-1]:.6g}', unit)}" if found.interrupted else ""
