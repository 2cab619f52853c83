"""Runs to an accuracy for ``mbsym simulate``: the plan alone, or with its run; and the command that repeats it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.model.quantities import time_unit
from mbsym.report.language import Language
from mbsym.report.unit_text import pretty
from mbsym_cli.console import BROKEN_DOWN, OK, complain, status
from mbsym_cli.simulate.choice import Wanted
from mbsym_cli.simulate.request import Asked
from mbsym_cli.simulate.summary import print_lines

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Request, Simulation
    from mbsym.simulation.run import Stage


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
    goal: Wanted, given: Scenario, request: Request, watch: Callable[[float], None], stage: Stage
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


def print_repeat(file: Path, system: System, goal: Wanted, settled: Request) -> None:
    """The command that makes the same trajectory without choosing, on a line of its own to be pasted."""
    from mbsym.report.runs.plan_words import repeating_command

    repeat = Language(system.language).say(Message("to repeat:"))
    print(f"  {repeat}\n{repeating_command(str(file), goal.settings, settled, goal.carried)}")
