"""Constraints for ``mbsym simulate``: ``--fixed``, what does not go with them, what is said where they stay open."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym.expressions.safe import quoted
from mbsym.model.constraints import listed as constraints_listed
from mbsym.source.scope import did_you_mean, listed
from mbsym_cli.options import Options, group

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Request
    from mbsym_cli.simulate.request import Asked


@dataclass(frozen=True)
class Fixed:
    """As it was typed."""

    fixed: str | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the names; whatever is wrong with them joins the complaints of ``asked``."""
        if self.fixed is None or system is None:
            return request
        if not system.constraints:
            hint = "initial values stay as they are given; leave --fixed out"
            asked.complain("--fixed", "idle-option", "there are no constraints that initial values would follow", hint)
            return request
        known = (*system.coordinates, *system.velocities)
        names = tuple(dict.fromkeys(part.strip() for part in self.fixed.split(",") if part.strip()))
        for name in names:
            if name not in known:
                way = did_you_mean(name, known) or listed("these can be fixed", known)
                asked.complain("--fixed", "unknown-name", f"there is nothing called {quoted(name)} to be fixed", way)
        return replace(request, fixed=tuple(name for name in names if name in known))


closing_options = group(
    "closing",
    Fixed,
    click.option(
        "--fixed", metavar="NAMES", help="Initial values that stay while the others are fitted to the constraints."
    ),
)


def check_constrained(system: System | None, wanted: Asked, asked: Options) -> None:
    """Complains about every option that does not know constraints yet."""
    if system is None or not system.constraints:
        return
    from mbsym.numerics.methods.table import METHODS

    request = wanted.request
    told = constraints_listed(system.constraints)
    if request.model.linear:
        message = f"--linear does not take constraints into account yet ({told})"
        asked.complain("--linear", "constraints", message, "without them this would be another system")
    if request.method in METHODS and (METHODS[request.method].traits.conservative or request.method == "lsoda"):
        hint = "these do: auto, dop853, rk45, rk4, taylor, radau, bdf"
        message = f"{request.method} does not keep to constraints ({told})"
        asked.complain("--method", "unsuitable-method", message, hint)


def begun_at(given: Scenario | None, request: Request) -> Scenario | None:
    """With the initial state that a run takes; what was given where there is an answer to that question only later."""
    if given is None or not given.system.constraints or request.earlier is None:
        return given
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.closing import closed

    try:
        return closed(given, request.fixed).scenario
    except Failure:
        return given
