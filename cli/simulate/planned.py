"""Runs to an accuracy for ``mbsym simulate``: the plan alone, or with its run; and the command that repeats it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.model.quantities import time_unit
from mbsym.report.unit_text import pretty
from mbsym_cli.console import BROKEN_DOWN, OK, complain, console, printable, status
from mbsym_cli.simulate.choice import Wanted
from mbsym_cli.simulate.request import Asked

if TYPE_CHECKING:
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
    from rich.text import Text

    from mbsym.report.runs.plan_words import plan_lines
    from mbsym.simulation.accurate import plan_for

    goal = asked.goal
    assert goal is not None
    with planning(asked, file):
        plan, settled = plan_for(given, asked.request, goal.accuracy, goal.pins)
    if asked.quiet:
        if not plan.reached:
            complain(file, "no plan is shown to reach the accuracy asked for")
        return OK if plan.reached else BROKEN_DOWN
    out = console()
    out.print(Text.assemble((given.system.name, "bold"), (f"  {printable(file)}", "dim")))
    for name, text in plan_lines(plan, pretty(time_unit(given.system))):
        style = "yellow" if name == "warning" else "bold cyan"
        out.print(Text.assemble("  ", (f"{name:<10} ", style), text))
    print_repeat(file, goal, settled)
    return OK if plan.reached else BROKEN_DOWN


def print_repeat(file: Path, goal: Wanted, settled: Request) -> None:
    """The command that makes the same trajectory without choosing, on a line of its own to be pasted."""
    from mbsym.report.runs.plan_words import repeating_command

    print(f"  to repeat:\n{repeating_command(str(file), goal.settings, settled, goal.carried)}")
