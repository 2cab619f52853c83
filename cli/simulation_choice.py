"""``--accuracy`` and ``--plan`` of ``mbsym simulate``, and the options that settle a model by hand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym_cli.option_groups import group
from mbsym_cli.options import Options

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mbsym.model.system import System
    from mbsym.numerics.models import Model
    from mbsym.numerics.plan import Accuracy
    from mbsym.numerics.planning import Pins
    from mbsym.simulation import Request
    from mbsym_cli.simulation_options import Group
    from mbsym_cli.simulation_request import Asked

#: Nothing here is finer, and nothing coarser says anything about a motion.
FINEST, COARSEST = 1e-17, 0.5

#: Words of ``--gravity``.
ORDERS = ("2", "3", "4", "exact")


@dataclass(frozen=True)
class Choosing:
    """As typed."""

    accuracy: str | None
    plan: bool
    gravity: str | None
    linear: bool
    without: tuple[str, ...]

    @property
    def typed(self) -> tuple[str, ...]:
        """The options among them that were typed."""
        given = {
            "--accuracy": self.accuracy,
            "--gravity": self.gravity,
            "--linear": self.linear,
            "--without": self.without,
        }
        return tuple(name for name, value in given.items() if value)

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the model that was settled by hand; complaints join ``asked``."""
        model = _model(system, self, asked)
        return request if model is None else replace(request, model=model)


@dataclass(frozen=True)
class Wanted:
    """What is to be reached, and what is settled already; ``only_plan``: nothing is run.

    ``settings`` are those of --set, for the command that repeats the run.
    """

    accuracy: Accuracy
    pins: Pins
    only_plan: bool
    settings: tuple[str, ...] = ()


choice_options = group(
    "choosing",
    Choosing,
    click.option(
        "--accuracy",
        metavar="X",
        help="Tolerable relative error over the whole time (1e-6; theta=1e-6,energy=1e-9): model, method, "
        "tolerance and arithmetic are chosen for it.",
    ),
    click.option("--plan", is_flag=True, help="Print what --accuracy chooses and its bound; run nothing."),
    click.option(
        "--gravity",
        metavar=f"[{'|'.join(ORDERS)}]",
        help="Order of Newtonian gravity.  [default: as described; chosen by --accuracy]",
    ),
    click.option("--linear", is_flag=True, help="Integrate the equations linearised about the unperturbed motion."),
    click.option("--without", multiple=True, metavar="NAME", help="Take a parameter as zero; repeatable."),
)


def with_goal(
    choosing: Group, system: System | None, wanted: Asked, settings: Sequence[str], varied: bool, asked: Options
) -> Asked:
    """What is asked for, with the accuracy that is to be reached, if one is.

    ``varied``: many motions, or sensitivities, which go with no choice of models.
    """
    assert isinstance(choosing, Choosing)
    if varied:
        for name in choosing.typed:
            asked.complain(name, "conflicting-options", "models and accuracies are chosen for one motion by itself")
    accuracy = _accuracy(system, choosing.accuracy, asked)
    if choosing.plan and choosing.accuracy is None:
        asked.complain(
            "--plan", "missing-option", "there is nothing to plan for", "give an --accuracy, for example 1e-6"
        )
    if accuracy is None:
        return wanted
    pins = _pins(wanted.request, choosing)
    return replace(wanted, goal=Wanted(accuracy, pins, choosing.plan, tuple(settings)))


def _pins(request: Request, choosing: Choosing) -> Pins:
    """What other options have settled."""
    from click.core import ParameterSource

    from mbsym.numerics.planning import Pins

    typed = click.get_current_context().get_parameter_source("arithmetic") is ParameterSource.COMMANDLINE
    return Pins(
        model=request.model if {"--gravity", "--linear", "--without"} & set(choosing.typed) else None,
        method=None if request.method == "auto" else request.method,
        tolerance=request.tolerance,
        step=request.step,
        scalar=request.arithmetic if typed else None,
        whole=request.whole,
    )


def _accuracy(system: System | None, text: str | None, asked: Options) -> Accuracy | None:
    """``1e-6``, ``theta=1e-6,energy=1e-9``, or both: ``1e-4,energy=1e-9``."""
    if text is None:
        return None
    from mbsym.numerics.plan import ENERGY, Accuracy

    known = (*system.coordinates, *system.velocities, ENERGY) if system is not None else ()
    everything: float | None = None
    named: dict[str, float] = {}
    before = len(asked.complaints)
    for part in text.split(","):
        left, equals, right = (piece.strip() for piece in part.partition("="))
        value = asked.number("--accuracy", right if equals else left, FINEST, COARSEST)
        name = left if equals else "everything"
        if name in named or (not equals and everything is not None):
            asked.complain("--accuracy", "conflicting-options", f"two errors are given for {name}")
        elif not equals:
            everything = value
        elif system is None or asked.word("--accuracy", name, known, "quantity") is not None:
            named[name] = value or FINEST
    if len(asked.complaints) > before:
        return None
    return Accuracy(everything, named)


def _model(system: System | None, choosing: Choosing, asked: Options) -> Model | None:
    """The model that was settled by hand; None where nothing was said."""
    from mbsym.model.system import NewtonianGravity
    from mbsym.numerics.models import Model

    order: int | str | None = None
    if choosing.gravity is not None:
        word = asked.word("--gravity", choosing.gravity, ORDERS, "order")
        order = int(word) if word is not None and word.isdigit() else word
        if system is not None and not any(isinstance(load, NewtonianGravity) for load in system.loads):
            asked.complain("--gravity", "unsuitable-option", "there is no Newtonian gravity in this description")
    if choosing.linear and system is not None and not system.motion:
        hint = "the description says with 'motion:' what the equations are linearised about"
        asked.complain("--linear", "unsuitable-option", "there is no unperturbed motion", hint)
    for name in choosing.without if system is not None else ():
        assert system is not None
        asked.word("--without", name, system.parameter_names, "parameter")
    if order is None and not choosing.linear and not choosing.without:
        return None
    return Model(order, choosing.linear, tuple(dict.fromkeys(choosing.without)))
