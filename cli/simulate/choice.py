"""``--accuracy`` and ``--plan`` of ``mbsym simulate``, and the options that settle a model by hand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym_cli.options import Options, group

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from mbsym.model.system import System
    from mbsym.numerics.planning.models import Model
    from mbsym.numerics.planning.plan import Accuracy
    from mbsym.numerics.planning.planning import Pins
    from mbsym.simulation import Request
    from mbsym_cli.simulate.options import Group
    from mbsym_cli.simulate.request import Asked

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
    def models(self) -> bool:
        """Whether a part of the model was settled by hand."""
        return bool(self.gravity or self.linear or self.without)

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the model that was settled by hand; complaints join ``asked``."""
        model = _model(system, self, asked)
        return request if model is None else replace(request, model=model)


@dataclass(frozen=True)
class Goal:
    """What is to be reached, and what is settled already; ``only_plan``: nothing is run.

    ``settings`` are those of --set, ``carried`` further options, for the command that repeats the run.
    """

    accuracy: Accuracy
    pins: Pins
    only_plan: bool
    settings: tuple[str, ...] = ()
    carried: tuple[str, ...] = ()


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
    choosing: Group,
    system: System | None,
    wanted: Asked,
    settings: Sequence[str],
    typed: Collection[str],
    carried: Sequence[str],
    asked: Options,
) -> Asked:
    """What is asked for, with the accuracy that is to be reached, if one is; ``typed`` are the options' names."""
    assert isinstance(choosing, Choosing)
    accuracy = _accuracy(system, choosing.accuracy, asked)
    if accuracy is None:
        return wanted
    pins = _pins(wanted.request, choosing, "--arithmetic" in typed)
    return replace(wanted, goal=Goal(accuracy, pins, choosing.plan, tuple(settings), tuple(carried)))


def _pins(request: Request, choosing: Choosing, arithmetic: bool) -> Pins:
    """What other options have settled; float64 settles the ``arithmetic`` only where it was typed."""
    from mbsym.numerics.planning.planning import Pins

    return Pins(
        model=request.model if choosing.models else None,
        method=None if request.method == "auto" else request.method,
        tolerance=request.tolerance,
        step=request.step,
        scalar=request.arithmetic if arithmetic else None,
        whole=request.whole,
    )


def _accuracy(system: System | None, text: str | None, asked: Options) -> Accuracy | None:
    """``1e-6``, ``theta=1e-6,energy=1e-9``, or both: ``1e-4,energy=1e-9``."""
    if text is None:
        return None
    from mbsym.numerics.planning.plan import ENERGY, Accuracy

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
    from mbsym.numerics.planning.models import Model

    order: int | str | None = None
    if choosing.gravity is not None:
        word = asked.word("--gravity", choosing.gravity, ORDERS, "order")
        order = int(word) if word is not None and word.isdigit() else word
        if system is not None and not system.newtonian_fields:
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
