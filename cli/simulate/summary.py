"""What ``mbsym simulate`` tells: how it went, how good it is, and what broke down."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.model.quantities import time_unit, unit_of, with_unit
from mbsym.report.content import facts, say
from mbsym.report.language import Language
from mbsym.report.unit_text import pretty
from mbsym_cli.console import BROKEN_DOWN, OK, asked_width, complain, printable, show, status, tell
from mbsym_cli.simulate.request import Asked, Goal

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.scenario import Scenario
    from mbsym.numerics.simulate import Trajectory
    from mbsym.simulation import Request, Simulation
    from mbsym.simulation.run import Stage


def print_summary(file: Path, run: Simulation, paths: Sequence[Path], verbose: bool = False) -> None:
    """What was integrated and how good it is, where the files are; ``verbose``: how it was done, too."""
    from mbsym.report.runs.summary import method_lines, result_lines

    lines = result_lines(run, printable(file))
    print_lines(file, run.system, (*lines, *method_lines(run)) if verbose else lines, paths, not verbose)


def print_lines(
    file: Path, system: System, pairs: Iterable[tuple[str, str]], paths: Sequence[Path] = (), more: bool = False
) -> None:
    """What is said under titles, in the language of the description, and where files are; ``more`` with -v."""
    from mbsym.report.plain_writer import Writer

    writer = Writer(Language(system.language), readable=True, width=asked_width() or 100)
    tell((system.name, "bold"), (f"  {printable(file)}", "dim"))
    show(writer.document([facts(pairs)]))
    if paths:
        text = "files in [[folder]]: [[names]] (how it was done: -v)" if more else "files in [[folder]]: [[names]]"
        names = ", ".join(path.name for path in paths)
        tell(writer.said(say(text, folder=printable(paths[0].parent), names=names)), indent=2)


def broken(file: Path, ended: Breakdown, found: Trajectory, paths: Sequence[Path]) -> str:
    """What happened, when, and in which state."""
    from mbsym.numerics.methods.interface import (
        BLOW_UP,
        OUT_OF_REACH,
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
        BLOW_UP: Message(
            "the motion grows without an end in sight, in finite time or exponentially; is a sign of the forces right?"
            if ended.time > 0
            else "choose other initial values, or units in which the numbers are smaller"
        ),
        SINGULAR: Message(
            "a coordinate loses its meaning in this state: a distance has shrunk to zero (a collision, a fall to the "
            "centre), or angles are singular (a pole; other angles help); or a mass is zero. Start elsewhere or stop "
            "earlier"
        ),
        SINGULAR_CONSTRAINTS: Message(
            "a mechanism in a singular position (links in line, branches that meet): the accelerations do not follow "
            "from the constraints there; start beside it"
        ),
        OUT_OF_REACH: Message(
            "what moves the constraints leads the mechanism to the end of its reach (links stretched out, or blocked): "
            "stop earlier, or let it move less far"
        ),
        STEP_LIMIT: Message(
            "raise --step-limit, or choose a larger --tolerance or --step; a stiff system needs --method radau"
        ),
        UNDEFINED: Message("the model says nothing beyond this state; is the sign under a root or a logarithm right?"),
        OUTSIDE: Message("choose a shorter --time, give more points, or say how the table goes on, as 'outside: hold'"),
        SWITCHING: Message(
            "a force that jumps leads back to its jump from both sides: a smooth one, as tanh, goes through it"
        ),
        STUCK: Message("a larger --tolerance may pass; look for a singularity of forces at this state"),
    }
    code, at, say = ended.kind.replace(" ", "-"), with_unit(f"{ended.time:.9g}", time), Language(system.language).say
    happened = Message(
        "[[kind]] at t = [[time]]: [[message]]", kind=Message(ended.kind), time=at, message=ended.message
    )
    kept = Message(
        "kept in [[folder]]: samples up to t = [[time]] ([[count]])",
        folder=printable(paths[0].parent), time=with_unit(f"{found.times[-1]:.9g}", time), count=found.samples,
    )  # fmt: skip
    lines = [Message("state: [[state]]", state=state), Message("hint: [[hint]]", hint=hints.get(ended.kind, ""))]
    return "\n".join(
        [
            f"{printable(file)}: error[{code}]: {say(happened)}",
            *(f"  {say(line)}" for line in lines),
            f"{printable(file)}: {say(kept)}",
        ]
    )


def note(found: Trajectory) -> str:
    """What figures say of a trajectory that is not whole, in the language of the description."""
    unit, say = pretty(time_unit(found.system)), Language(found.system.language).say
    if found.breakdown is not None:
        time, kind = with_unit(f"{found.breakdown.time:.6g}", unit), Message(found.breakdown.kind)
        return say(Message("ended early: [[kind]] at t = [[time]]", kind=kind, time=time))
    time = with_unit(f"{found.times[-1]:.6g}", unit)
    return say(Message("interrupted at t = [[time]]", time=time)) if found.interrupted else ""


# Runs to an accuracy for ``mbsym simulate``: the plan alone, or with its run; and the command that repeats it.


class InterruptedPlanning(KeyboardInterrupt):
    """Ctrl-C before there was a plan."""


@contextmanager
def planning(asked: Asked, file: Path) -> Iterator[None]:
    """A spinner while a plan is made.  Raises InterruptedPlanning for Ctrl-C."""
    try:
        with status(asked.quiet, f"{file.name}: choosing model, method and tolerance"):
            yield
    except KeyboardInterrupt:
        raise InterruptedPlanning from None


def simulated_to(
    goal: Goal, given: Scenario, request: Request, watch: Callable[[float], None], stage: Stage
) -> Simulation:
    """The run that a plan asks for."""
    from mbsym.simulation.accurate import simulate_accurately

    return simulate_accurately(given, request, goal.accuracy, goal.pins, watch, stage)


def only_planned(file: Path, given: Scenario, asked: Asked) -> int:
    """Prints the plan; the exit code says whether it reaches what was asked for."""
    from mbsym.report.runs.plan_words import bound_lines, choice_lines
    from mbsym.simulation.accurate import plan_for

    goal = asked.goal
    assert goal is not None
    with planning(asked, file):
        plan, settled = plan_for(given, asked.request, goal.accuracy, goal.pins)
    if asked.quiet:
        if not plan.reached:
            text = Message("no plan is shown to reach the accuracy asked for")
            complain(file, Language(given.system.language).say(text))
        return OK if plan.reached else BROKEN_DOWN
    print_lines(file, given.system, (*bound_lines(plan, pretty(time_unit(given.system))), *choice_lines(plan)))
    print_repeat(file, given.system, goal, settled)
    return OK if plan.reached else BROKEN_DOWN


def print_repeat(file: Path, system: System, goal: Goal, settled: Request) -> None:
    """The command that makes the same trajectory without choosing, on a line of its own to be pasted."""
    from mbsym.report.runs.plan_words import repeating_command

    repeat = Language(system.language).say(Message("to repeat:"))
    print(f"  {repeat}\n{repeating_command(str(file), goal.settings, settled, goal.carried)}")
