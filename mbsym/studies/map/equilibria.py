"""``mbsym map --of equilibria``: what fits, and the numbers of relative equilibria over a plane."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.model.system import System
from mbsym.studies.section import against_sign, unless_parameter
from mbsym.studies.study import Unfit, Watch, missing

if TYPE_CHECKING:
    from mbsym.maps.equilibria_map import EquilibriaMap
    from mbsym.studies.map import Request


def fitting(request: Request, system: System, typed: Collection[str]) -> Iterator[Unfit]:
    """What keeps numbers of equilibria from being mapped."""
    if "y" not in typed and "x" in typed:
        hint = "give the second parameter as --y, or use mbsym equilibria --vary"
        yield Unfit("--y", "missing-option", "numbers of equilibria are mapped over a plane", hint)
    if "z" in typed:
        hint = "leave it out, and map at some of its values, each with an --out: --set NAME=VALUE"
        yield Unfit("--z", "not-of-equilibria", "there are no slices of numbers of equilibria", hint)
    if request.by == "boxes":
        hint = "leave it out: its regions are exact wherever they can be had"
        yield Unfit("--by boxes", "not-of-equilibria", "numbers of equilibria have no boxes", hint)
    for option, axis in (("--x", request.x), ("--y", request.y)):
        if axis is not None:
            yield from unless_parameter(option, axis.name, system)
            yield from against_sign(option, axis, system)
    for name in request.values:
        yield from unless_parameter("--set", name, system)
    from mbsym.mechanics.rest import missing_values

    chosen = {axis.name for axis in request.axes}
    lacking = [name for name in missing_values(system, _numbers(system, request)) if name not in chosen]
    if lacking and all(name not in typed or getattr(request, name) is not None for name in ("x", "y", "z")):
        yield missing(lacking, "rational number")


def _numbers(system: System, request: Request) -> Mapping[str, Fraction]:
    """Those of the parameters besides the axes."""
    from mbsym.mechanics.rest import given_values, rational_values

    chosen = {axis.name for axis in request.axes}
    given = given_values(system, {name: x for name, x in request.values.items() if name in system.parameter_names})
    return {name: x for name, x in rational_values(given).items() if name not in chosen}


def mapped(system: System, request: Request, watch: Watch) -> EquilibriaMap:
    """Raises Failure, also where what it stands on was withdrawn."""
    from mbsym.analysis import Analysis
    from mbsym.maps.equilibria_map import equilibria_map
    from mbsym.studies.map import NoMap

    found = equilibria_map(system, (request.axes[0], request.axes[1]), _numbers(system, request), watch)
    withdrawn = Analysis(system, ()).broken(Analysis.equilibria.stands_on)
    if withdrawn is not None:
        raise NoMap(Message("no map: [[reason]]", reason=withdrawn.reason))
    return found
