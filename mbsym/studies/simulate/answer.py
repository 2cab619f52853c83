"""What ``mbsym simulate`` tells: how it went, how good it is, and what broke down."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.expressions.safe import safe
from mbsym.model.quantities import time_unit, unit_of, with_unit
from mbsym.report.content import Block, facts
from mbsym.report.language import Language
from mbsym.report.unit_text import pretty
from mbsym.studies.closing import not_closed
from mbsym.studies.simulate.files import ensemble_files, motion_files
from mbsym.studies.simulate.fitting import Many, Motion, Planned
from mbsym.studies.study import BEFORE, NOTHING_WRITTEN, Answer, Asked, Exit, Line, Refusal, heading, line
from mbsym.studies.study import refused as refused_because

if TYPE_CHECKING:
    from mbsym import simulation
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.simulate import Trajectory
    from mbsym.simulation import Simulation
    from mbsym.studies.simulate import Command
    from mbsym.studies.simulate.fitting import Result

#: What is typed again beside the settings of a run to repeat it: what is written, and what is estimated.
CARRIED = ("inputs", "estimate", "certify_seconds", "variables", "fixed", "format", "bodies", "animate", "out")


def answered(context: Asked, request: Command, result: Result) -> Answer:
    """Lines, files, complaints and the exit code of what was found."""
    match result:
        case Planned():
            return _planned(context, request, result)
        case Many():
            return _many(context, request, result)
    return _motion(context, request, result)


def _planned(context: Asked, request: Command, result: Planned) -> Answer:
    from mbsym.report.runs.plan_words import bound_lines, choice_lines

    plan, unit = result.plan, pretty(time_unit(context.motion.system))
    told = facts((*_measured(result.before), *bound_lines(plan, unit), *choice_lines(plan)))
    lines, last = [told], _repeat(context, request, result.request)
    if plan.reached:
        return Answer(lines, last=last)
    missed = Message("no plan is shown to reach the accuracy asked for")
    return Answer(lines, {}, [missed], Exit.BROKEN_DOWN, last=last)


def _measured(before: bool) -> Iterator[tuple[str, Message]]:
    if before:
        yield "note", Message(BEFORE)


def _many(context: Asked, request: Command, result: Many) -> Answer:
    from mbsym.report.runs.ensemble_tables import sentences

    ensemble, files = result.ensemble, ensemble_files(result, request)
    lines, complaints, code = [facts(sentences(ensemble))], list[str](), Exit.OK
    if ensemble.interrupted:
        complaints.append(Message("interrupted; kept up to t = [[time]]", time=f"{ensemble.times[-1]:.9g}"))
        code = Exit.INTERRUPTED
    elif ensemble.fates:
        text = "[[ended]] of [[count]] members ended early."
        complaints.append(Message(text, ended=len(ensemble.fates), count=ensemble.count))
        code = Exit.BROKEN_DOWN
    return Answer(lines, files, complaints, code, owner="ensemble")


def _motion(context: Asked, request: Command, result: Motion) -> Answer:
    from mbsym.report.runs.summary import method_lines, result_lines

    run = result.run
    files = motion_files(run, result.derivatives, request.formats)
    how = method_lines(run) if request.verbose else ()
    told = (*_measured(result.before), *result_lines(run, context.file), *how)
    lines: list[Line | Block] = [facts(told)]
    if result.derivatives is not None:
        from mbsym.report.runs.orbit_files import sensitivity_sentences  # few ask for them

        say = Language(run.system.language).say
        lines += [heading(say(Message("derivatives"))), facts(sensitivity_sentences(result.derivatives))]
    last = [] if run.plan is None else _repeat(context, request, run.request)
    complaints, code = _ended(run, context.folder)
    if code is Exit.OK:
        complaints, code = _underived(result)
    before = [Message("no first integrals: [[why]]", why=run.no_invariants)] if run.no_invariants else []
    more = "" if request.verbose else Message("how it was done: -v")
    complaints = [*before, *files.notes, *complaints]
    return Answer(lines, files.contents, complaints, code, last=last, more=more, stopped=files.stopped)


def _underived(result: Motion) -> tuple[list[str], Exit]:
    """What is said of derivatives that are not whole, or not there."""
    if isinstance(result.stopped, KeyboardInterrupt):
        return [Message("interrupted")], Exit.INTERRUPTED
    if result.stopped is not None:
        refusal = refused_because("error[no-program]: there is no program for these equations", result.stopped)
        return [refusal.text], refusal.code
    if result.derivatives is not None and result.derivatives.ended is not None:
        return [Message("the derivatives end early: [[why]]", why=result.derivatives.ended.told)], Exit.BROKEN_DOWN
    return [], Exit.OK


def _ended(run: Simulation, folder: Path) -> tuple[list[str], Exit]:
    """What is said of a run that is not whole, not proved as it was to be, or not as accurate."""
    from mbsym.numerics.accuracy import Lacking, NoEstimate
    from mbsym.numerics.enclosure.enclose import INTERRUPTED as CERTIFICATE_INTERRUPTED

    if run.ended is not None:
        return list(_broken(run.ended, run.trajectory, folder)), Exit.BROKEN_DOWN
    if run.trajectory.interrupted:
        text, until = "interrupted; kept up to t = [[time]] in [[folder]]", f"{run.times[-1]:.9g}"
        return [Message(text, time=until, folder=safe(str(folder)))], Exit.INTERRUPTED
    if isinstance(run.error, NoEstimate) and run.error.why is Lacking.INTERRUPTED:
        return [Message("interrupted")], Exit.INTERRUPTED
    proof = run.certificate
    if proof is not None and not (proof.whole and proof.narrow):
        interrupted = CERTIFICATE_INTERRUPTED in (proof.ended, proof.enclosure.cut)
        return [], Exit.INTERRUPTED if interrupted else Exit.BROKEN_DOWN
    return [], Exit.OK if run.plan is None or run.plan.reached else Exit.BROKEN_DOWN


def _broken(ended: Breakdown, trajectory: Trajectory, folder: Path) -> Iterator[str]:
    """What happened, when, and in which state; what was kept."""
    from mbsym.numerics.methods.interface import Cause
    from mbsym.numerics.methods.sides import OUTSIDE, SWITCHING

    system, time = trajectory.system, pretty(time_unit(trajectory.system))
    say = Language(system.language).say
    names = [*system.coordinates, *system.velocities]
    state = ", ".join(
        f"{name} = {with_unit(f'{float(value):.6g}', pretty(unit_of(system, name)))}"
        for name, value in zip(names, ended.state, strict=True)
    )
    hints = {
        Cause.BLOW_UP: Message(
            "the motion grows without an end in sight, in finite time or exponentially; is a sign of the forces right?"
            if ended.time > 0
            else "choose other initial values, or units in which the numbers are smaller"
        ),
        Cause.SINGULAR: Message(
            "a coordinate loses its meaning in this state: a distance has shrunk to zero (a collision, a fall to the "
            "centre), or angles are singular (a pole; other angles help); or a mass is zero. Start elsewhere or stop "
            "earlier"
        ),
        Cause.SINGULAR_SPEEDS: Message(
            "the motion may go on: --variables coordinates integrates coordinates and their velocities; or declare "
            "speeds that determine these everywhere, as velocities along and across a vehicle"
        ),
        Cause.SINGULAR_CONSTRAINTS: Message(
            "a mechanism in a singular position (links in line, branches that meet): the accelerations do not follow "
            "from the constraints there; start beside it"
        ),
        Cause.OUT_OF_REACH: Message(
            "what moves the constraints leads the mechanism to the end of its reach (links stretched out, or blocked): "
            "stop earlier, or let it move less far"
        ),
        Cause.STEP_LIMIT: Message(
            "raise --step-limit, or choose a larger --tolerance or --step; a stiff system needs --method rodas5p"
        ),
        Cause.NOT_SMOOTH: Message("--method dop853 does without them"),
        Cause.UNDEFINED: Message(
            "the model says nothing beyond this state; is the sign under a root or a logarithm right?"
        ),
        OUTSIDE: Message("choose a shorter --time, give more points, or say how the table goes on, as 'outside: hold'"),
        SWITCHING: Message(
            "a force that jumps leads back to its jump from both sides: a smooth one, as tanh, goes through it"
        ),
        Cause.STUCK: Message("a larger --tolerance may pass; look for a singularity of forces at this state"),
    }
    happened = "[[kind]] at t = [[time]]: [[message]]"
    at = with_unit(f"{ended.time:.9g}", time)
    about = say(Message(happened, kind=Message(ended.kind), time=at, message=ended.message))
    yield f"error[{ended.kind.replace(' ', '-')}]: {about}"
    yield f"  {say(Message('state: [[state]]', state=state))}"
    yield f"  {say(Message('hint: [[hint]]', hint=hints.get(ended.kind, '')))}"
    text, until = "kept in [[folder]]: samples up to t = [[time]] ([[count]])", f"{trajectory.times[-1]:.9g}"
    yield Message(text, folder=safe(str(folder)), time=with_unit(until, time), count=trajectory.samples)


def _repeat(context: Asked, request: Command, run: simulation.Request) -> list[Line]:
    """The command that makes the same trajectory without choosing, on a line of its own to be pasted."""
    from mbsym.report.runs.plan_words import repeating_command
    from mbsym.studies.request import words_typed

    say, typed = Language(context.motion.system.language).say, context.typed
    carried = words_typed(type(request), {name: typed[name] for name in CARRIED if name in typed})
    command = repeating_command(context.file, typed.get("values", ()), run, carried)
    return [line(f"  {say(Message('to repeat:'))}"), line(command, whole=True)]


def refused(error: Exception, context: Asked, request: Command) -> Refusal | None:
    """Of a run that cannot be begun."""
    from mbsym.algebra.failures import Failure, SingularPoint
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.simulate import Rests

    say = Language(context.motion.system.language).say
    nothing = say(NOTHING_WRITTEN)
    if isinstance(error, MemoryError):
        many = "out of memory; ask for fewer members"
        return Refusal(Message(many if request.vary else "out of memory; ask for fewer --samples"))
    if isinstance(error, Breakdown):
        text = Message("the motion does not come to the end, so nothing can be planned: [[why]]", why=error.told)
        return Refusal(f"error[no-plan]: {say(text)}", Exit.BROKEN_DOWN, (nothing,))
    if isinstance(error, Rests):
        return refused_because("error[rests]: there is nothing to plan", error)
    if isinstance(error, SingularPoint):
        text = Message("singular at these values: [[why]]", why=error.reason)
        return Refusal(f"error[singular]: {say(text)}", Exit.BROKEN_DOWN, (nothing,))
    if isinstance(error, Failure):
        return not_closed(error, context.motion.system) or Refusal(
            f"error[no-program]: {say(Message('there is no program for these equations: [[why]]', why=error.reason))}",
            Exit.FAILED,
            (nothing,),
        )
    return None
