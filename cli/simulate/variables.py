"""``mbsym simulate --variables``: what is integrated of a system with speeds, and what goes with coordinates only."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import click

from mbsym_cli.options import Options, group

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.simulate.request import Asked

#: What an option that goes with coordinates only is answered with.
WAY_OUT = "--variables coordinates integrates coordinates and their velocities, angles among them"

#: Formats that show bodies, whose places are known in coordinates.
OF_BODIES = {"bodies-csv": "--bodies", "html": "--animate", "gif": "--animate"}


@dataclass(frozen=True)
class Variables:
    """As it was typed; None where nothing was."""

    variables: str | None

    def added(self, request: Request, system: System | None, asked: Options) -> Request:
        """The request with the variables; whatever is wrong with them joins the complaints of ``asked``."""
        if self.variables is None:
            return request
        word = asked.word("--variables", self.variables.lower(), ("declared", "coordinates"), "choice of variables")
        if word is not None and system is not None and not system.speeds:
            hint = "coordinates and their velocities are integrated; leave --variables out"
            asked.complain("--variables", "idle-option", "the description declares no speeds", hint)
        return request if word is None else replace(request, variables=word)

    @property
    def own(self) -> bool:
        """Whether declared variables are integrated."""
        return (self.variables or "declared").lower() == "declared"

    def seen(self, system: System | None) -> System | None:
        """The system with what is integrated in the place of coordinates and velocities, where that can be told."""
        from mbsym.algebra.failures import Failure
        from mbsym.simulation import integrated_system

        if system is None or not system.speeds:
            return system
        try:
            return integrated_system(system, (self.variables or "declared").lower())
        except Failure:
            return system  # said when it is integrated


variables_options = group(
    "variables",
    Variables,
    click.option(
        "--variables",
        metavar="[declared|coordinates]",
        help="Of a description with speeds: integrate these, and unit vectors or quaternions in place of angles, or "
        "coordinates and their velocities.  [default: declared]",
    ),
)


def check_states(system: System | None, wanted: Asked, asked: Options) -> None:
    """Complains about every option that goes with coordinates only, where a run has other variables."""
    from mbsym.model.states import InStates

    if not isinstance(system, InStates):
        return
    from mbsym.numerics.methods.table import METHODS

    request = wanted.request
    options = {
        "--continue": request.earlier is not None,
        "--linear": request.model.linear,
        **{option: kind in wanted.formats for kind, option in OF_BODIES.items()},
    }
    for option, there in options.items():
        if there:
            message = f"{option} knows coordinates and their velocities only, and this system has speeds"
            asked.complain(option, "variables", message, WAY_OUT)
    if request.method == "lsoda" and any(body.orientation for body in system.bodies):
        message = "lsoda does not keep quaternions and unit vectors at their lengths"
        asked.complain("--method", "unsuitable-method", message, "take dop853, rk4, taylor, radau or bdf")
    if request.method in METHODS and METHODS[request.method].traits.conservative:
        message = f"{request.method} integrates coordinates and their velocities only, and this system has speeds"
        asked.complain("--method", "unsuitable-method", message, f"take dop853, rk4, taylor or radau; {WAY_OUT}")
