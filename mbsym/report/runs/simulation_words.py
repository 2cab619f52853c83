"""What is said of a run: conservation and error, for the terminal, for figures, and as part of ``simulation.json``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
from msgspec import UNSET, UnsetType

from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import text
from mbsym.model.loads import GeneralizedForce, PointForce, Torque
from mbsym.model.quantities import with_unit
from mbsym.model.states import InStates
from mbsym.numerics.accuracy import ErrorEstimate, Lacking, NoEstimate
from mbsym.numerics.conservation import Conservation, Standing, swayed
from mbsym.numerics.events.surfaces import source_of
from mbsym.numerics.methods.interface import Change, Narrow, Passed, Setting
from mbsym.numerics.states import StateDynamics, has_quaternions, norm_drifts
from mbsym.report.documents import simulation as doc

if TYPE_CHECKING:
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Simulation


def standing_words(conservation: Conservation) -> Message:
    """``conserved (proved)``, ``not conserved``, ``undecided (why)``."""
    if conservation.standing in (Standing.PROVED, Standing.VERIFIED):
        return Message("conserved ([[how]])", how=conservation.standing)
    if conservation.doubt is not None:
        return Message("[[standing]] ([[why]])", standing=conservation.standing, why=conservation.doubt)
    return Message("[[standing]]", standing=conservation.standing)


def conservation_line(conservation: Conservation, error: float = 0.0) -> Message:
    """With how far the run keeps it, and what that is a part of: a drift is an error, a change is none.

    What other motions change may rest along this one, as T - U does at the bottom of a hoop that turns.  ``error`` is
    what the run's own errors make of the quantity: a change that is no larger is not told from it.
    """
    said = standing_words(conservation)
    if conservation.standing is Standing.CHANGING and conservation.change == 0:
        return Message("[[standing]] in general; constant along this run", standing=said)
    if not isfinite(conservation.change):
        return said
    if conservation.standing in (Standing.PROVED, Standing.VERIFIED):
        return Message("[[standing]]; largest drift [[measured]]", standing=said, measured=_measured(conservation))
    if conservation.standing is Standing.CHANGING and conservation.change <= error / conservation.scale:
        text = "[[standing]]; the change in this run, [[measured]], is not told from its error"
        return Message(text, standing=said, measured=_measured(conservation))
    return Message("[[standing]]; largest change [[measured]]", standing=said, measured=_measured(conservation))


def _measured(conservation: Conservation) -> Message:
    """``1e-12 times the largest kinetic energy``."""
    return Message("[[change]] times [[size]]", change=f"{conservation.change:.1e}", size=conservation.measure)


def energy_lines(run: Simulation) -> Iterator[tuple[str, Message]]:
    """(which, what is said of it): T2 - T0 - U and T - U, which are the same where nothing moves as prescribed."""
    forced = any(isinstance(load, GeneralizedForce | PointForce | Torque) for load in run.system.loads)

    def told(conservation: Conservation, place: int) -> Message:
        error = 0.0
        if conservation.standing is Standing.CHANGING and len(run.times):
            points = np.vstack([run.trajectory.times, run.trajectory.states])
            error = swayed(run.dynamics.energies, place, points, _errors(run))
        line = conservation_line(conservation, error)
        if conservation.standing is not Standing.CHANGING or not forced:
            return line
        return Message("[[line]] (U has no part of forces that are given as such)", line=line)

    if not run.dynamics.natural:
        yield "T2 - T0 - U", told(run.conservation, 1)
    yield "T - U", told(run.energy_conservation, 0)


def _errors(run: Simulation) -> list[float]:
    """Of each component; where they are not known, what a single step may err by.

    Where the run and a better one part nobody knows the state, but the energy may be kept all the same.
    """
    if isinstance(run.error, ErrorEstimate) and run.error.parted is None:
        return [difference.largest for difference in run.error.quantities]
    states, tolerance = run.trajectory.states, run.trajectory.setting.tolerance
    least = max(tolerance or 0.0, float(np.finfo(states.dtype).eps))
    return [least * float(size) for size in np.max(np.abs(states), axis=1)]


def invariant_line(conservation: Conservation) -> Message:
    """``momentum of psi (proved): largest drift 1e-12 times the size of its terms``."""
    if conservation.standing in (Standing.PROVED, Standing.VERIFIED):
        text = "[[quantity]] ([[how]]): largest drift [[measured]]"
        return Message(
            text, quantity=conservation.quantity, how=conservation.standing, measured=_measured(conservation)
        )
    return Message("[[quantity]]: [[said]]", quantity=conservation.quantity, said=conservation_line(conservation))


def setting_words(setting: Setting, scalar: str) -> Message:
    """``tolerance 1e-12 per step, steps up to 0.005, extended``."""
    if setting.step is not None:
        messages = [Message("step [[step]]", step=f"{setting.step:g}")]
    else:
        messages = [Message("tolerance [[tolerance]] per step", tolerance=f"{setting.tolerance:g}")]
    if setting.longest is not None:
        messages.append(Message("steps up to [[step]]", step=f"{setting.longest:.3g}"))
    return joined([*messages, Message(scalar)], ", ")


def error_lines(estimate: ErrorEstimate | NoEstimate) -> Iterator[Message]:
    """The error in words; nothing where none was asked for or the run says itself why it ended."""
    if isinstance(estimate, NoEstimate):
        if estimate.why not in (Lacking.NOT_ASKED, Lacking.NOT_WHOLE, Lacking.NOTHING, Lacking.INTERRUPTED):
            yield Message("not estimated: [[why]]", why=estimate.why)
        return
    better = joined([estimate.against.method, setting_words(estimate.against.setting, estimate.against.scalar)], ", ")
    against = Message("of each quantity's size in the whole motion; against [[run]]", run=better)
    largest, final = f"{estimate.largest:.1e}", f"{estimate.final:.1e}"
    if estimate.parted is not None:
        text = (
            "unknown: this run and a better one have parted by t = [[time]], differ by up to [[error]], and nothing is "
            "known of either from there on ([[against]])"
        )
        yield Message(text, error=largest, time=f"{estimate.parted:.4g}", against=against)
    elif estimate.largest <= estimate.rounding:
        text = "no more than the rounding of one number, [[rounding]] ([[against]])"
        yield Message(text, rounding=f"{estimate.rounding:.1e}", against=against)
    elif estimate.largest > 2 * estimate.final:
        text = "about [[error]] at the end, [[worst]] at worst ([[against]])"
        yield Message(text, error=final, worst=largest, against=against)
    else:
        yield Message("about [[error]] at the end ([[against]])", error=final, against=against)
    resting = [q for q in estimate.quantities if q.rests]
    if not resting:
        return
    names, error = ", ".join(q.name for q in resting), max(q.largest for q in resting)
    floor = min(q.floor for q in resting)
    if error == 0:
        yield Message("at rest in this run and in the better one: [[names]]", names=names)
        return
    text = (
        "at rest but for rounding, as far as can be told: [[names]]; the [[error]] that the run makes of it is "
        "measured by what the motion could do (sizes below [[floor]] on which two runs do not agree)"
    )
    yield Message(text, names=names, error=f"{error:.1e}", floor=f"{floor:.1e}")


#: So many changes of the method are told one by one.
MOST_CHANGES = 6


def change_lines(changes: Sequence[Change], unit: str | None) -> Iterator[Message]:
    """Where the run changed its method on the way, and why."""
    for change in changes[:MOST_CHANGES]:
        time = with_unit(f"{change.time:.9g}", unit)
        yield Message("from t = [[time]] on [[method]] ([[why]])", time=time, method=change.method, why=change.why)
    if len(changes) > MOST_CHANGES:
        last, more = changes[-1], len(changes) - MOST_CHANGES
        time = with_unit(f"{last.time:.9g}", unit)
        text = "... and [[more]] changes more, the last at t = [[time]] to [[method]]; all are in simulation.json"
        yield Message(text, more=more, time=time, method=last.method)


def warnings(conservation: Conservation, error: ErrorEstimate | NoEstimate) -> Iterator[Message]:
    """What makes a run doubtful."""
    if conservation.broken:
        text = (
            "the [[quantity]] is conserved, and this run does not keep it: it is too coarse; choose a smaller "
            "--tolerance, or, of a method with steps of one length, a smaller --step"
        )
        yield Message(text, quantity=Message(conservation.quantity))
    if isinstance(error, ErrorEstimate) and error.parted is not None:
        text = (
            "from t = [[time]] on this run and a better one have little in common: the motion is chaotic or comes "
            "close to an unstable one, as rest may be, the run has stepped over something short, or it is too coarse"
        )
        yield Message(text, time=f"{error.parted:.4g}")


def quality(run: Simulation) -> tuple[list[Message], list[Message], bool]:
    """(warnings, what is said of the error, whether that is to be read first, as warnings are).

    Whoever reads one line of a run that is wrong, or that nobody could judge, shall read that: it stands before what is
    proved of the equations.
    """
    if run.begins_in_equilibrium:
        return [], [_strayed(run)], False
    messages = list(error_lines(run.error))
    return list(warnings(run.conservation, run.error)), messages, isinstance(run.error, NoEstimate)


#: A component that rests has strayed where it has moved by more roundings of its largest value.
STRAYED = 64


def _strayed(run: Simulation) -> Message:
    """How far a run has moved from an equilibrium in which it begins, which no exact motion leaves."""
    states = np.asarray(run.trajectory.states, dtype=float)
    gaps, sizes = np.max(np.abs(states - states[:, :1]), axis=1), np.max(np.abs(states), axis=1)
    far = int(np.argmax(gaps))
    if gaps[far] <= STRAYED * np.finfo(float).eps * sizes[far]:
        return Message("none: no coordinate changes in this run, either")
    text = "[[name]] strays by up to [[gap]] by roundings (they grow where an equilibrium is unstable)"
    return Message(text, name=[*run.dynamics.inputs][1 + far], gap=f"{gaps[far]:.1e}")


def error_json(estimate: ErrorEstimate | NoEstimate) -> doc.Estimate | doc.NoEstimate:
    """The estimate with what it was made of, or why there is none."""
    if isinstance(estimate, NoEstimate):
        return doc.NoEstimate.from_result(estimate, available=False)
    return doc.Estimate.from_result(
        estimate,
        available=True,
        how="better run",
        over=(0.0, estimate.compared.end, estimate.compared.points, estimate.compared.followed),
        quantities={q.name: q for q in estimate.quantities},
    )


def inputs_line(scenario: Scenario) -> Message:
    """``F = sin(3*t); w = 0 (held, as on the unperturbed motion)``: what every input is in a run."""
    laws = {signal: Message("[[name]] = [[law]]", name=signal.name, law=text(signal.law)) for signal in scenario.inputs}
    held = "[[law]] (held, as on the unperturbed motion)"
    return joined([law if signal.asked else Message(held, law=law) for signal, law in laws.items()], "; ")


def laws_json(scenario: Scenario) -> dict[str, str]:
    """What every input is in a run, as formulas."""
    return {driven_input.name: text(driven_input.law) for driven_input in scenario.inputs}


# What is said of switches and narrow features on the way of a run: for the terminal and for ``simulation.json``.


#: So many times are shown.
SHOWN = 4


def between_steps_json(passed: Passed | None) -> doc.BetweenSteps | None:
    """Times of switches, narrow features with the steps that passed them."""
    return None if passed is None else doc.BetweenSteps.from_result(passed)


def switch_line(passed: Passed | None) -> Message | None:
    """``2, at t = 5 and 5.002: a step ends at each``; None where nothing was switched."""
    if passed is None or not passed.switches:
        return None
    times = [f"{float(t):.9g}" for t in passed.switches[:SHOWN]] + ["..."] * (len(passed.switches) > SHOWN)
    text = "[[count]], at t = [[times]]: a step ends at each"
    return Message(text, count=len(passed.switches), times=", ".join(times))


def passed_over(run: Simulation, file: str) -> Iterator[Message]:
    """A sentence for every function that steps were too long for, where it stands, and the command that helps."""
    passed = run.trajectory.passed
    if passed is None:
        return
    seen: set[int | None] = set()
    for transient in passed.narrow:
        if transient.followed or transient.place in seen:
            continue
        seen.add(transient.place)
        yield _told(run, transient, file)
    if passed.unresolved:
        words = (
            "in the step at t = [[time]] changes of side follow one another too quickly to be told apart: [[command]]"
        )
        command = _command(run, file, run.trajectory.setting.step or 1e-3)
        yield Message(words, time=f"{passed.unresolved[0]:.6g}", command=command)


def _told(run: Simulation, change: Narrow, file: str) -> Message:
    expression = None if change.place is None else source_of(run.dynamics, change.place)
    what = Message("a load") if expression is None else text(expression)
    if expression is not None and expression.span is not None:
        where = "[[what]] (line [[line]], column [[column]])"
        what = Message(where, what=what, line=expression.span.line, column=expression.span.column)
    words = "[[what]] changes within [[width]] at t = [[time]], and a step of [[step]] passed it: [[command]]"
    width, time, step = f"{change.width:.2g}", f"{change.time:.6g}", f"{change.step:.2g}"
    return Message(words, what=what, width=width, time=time, step=step, command=_command(run, file, change.width / 4))


def _command(run: Simulation, file: str, step: float) -> str:
    """The command once more, with steps that are short enough."""
    option = "--step" if run.trajectory.setting.step is not None else "--max-step"
    method = f" --method {run.method}" if run.request.method != "auto" else ""
    return f"mbsym simulate {file} --time {run.request.time:g}{method} {option} {step:.2g}"


# What is said of a run in the variables that a description declares: which they are, and how well lengths are kept.


def norm_columns(run: Simulation) -> Mapping[str, Any]:
    """``e_drift`` for every quaternion and unit vector e: how far its products are from 1 and 0; none otherwise."""
    dynamics = run.dynamics
    if not isinstance(dynamics, StateDynamics):
        return {}
    taken = dynamics.inputs
    drifts = norm_drifts(dynamics, run.trajectory.states)
    return {f"{name}_drift" + "_" * (f"{name}_drift" in taken): values for name, values in drifts.items()}


def state_lines(run: Simulation) -> Iterator[tuple[str, Message]]:
    """(title, text) of the summary's lines; none for a run in coordinates of a system that declares nothing else."""
    system = run.system
    if not isinstance(system, InStates):
        if run.given is not None and run.given.system.speeds:
            yield "variables", Message("coordinates and their velocities; speeds are computed from them")
        return
    assert system.described is not None
    positions, speeds = ", ".join(system.positions), ", ".join(system.own_speeds)
    yield "variables", Message("[[positions]]; [[speeds]], as declared", positions=positions, speeds=speeds)
    columns = norm_columns(run)
    if columns:
        worst = max(float(np.max(values)) for values in columns.values())
        if run.request.model.linear:
            text = "linear equations keep norms and right angles to first order: they drift by [[drift]] at most"
        elif has_quaternions(system.described):
            text = (
                "norms of quaternions are restored after every step; left of their drift at the rows: [[drift]] at most"
            )
        else:
            text = "unit vectors are restored after every step; left of their drift at the rows: [[drift]] at most"
        yield "drift", Message(text, drift=f"{worst:.1e}")


def states_json(run: Simulation) -> doc.Variables | UnsetType:
    """What simulation.json says; nothing for a run in coordinates."""
    if not isinstance(run.system, InStates):
        return UNSET
    drifts = {name: float(np.max(values)) for name, values in norm_columns(run).items()}
    return doc.Variables(positions=list(run.system.positions), speeds=list(run.system.own_speeds), norm_drift=drifts)
