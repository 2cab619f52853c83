"""What ``mbsym integrals`` is asked for, read from its options."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym_cli.options import Options
from mbsym_cli.section_options import read_axis, read_settings

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.maps.section import Axis
    from mbsym.model.system import System

#: More than any budget of monomials allows.
MOST_DEGREE = 60
MOST_WEIGHT = 12
#: For ``--cases``: counted work, worth about so many seconds.
BUDGET = 60.0


@dataclass(frozen=True)
class Request:
    """Up to a weighted ``degree``, with ``values`` and ``weights``; ``budget``: for cases; one parameter on an axis."""

    degree: int
    values: dict[str, Fraction]
    weights: dict[str, int]
    axis: Axis | None
    budget: float


def read_request(
    system: System | None,
    asked: Options,
    degree: str,
    settings: tuple[str, ...],
    weights: tuple[str, ...],
    vary: str | None,
    cases: bool,
    budget: str | None,
) -> Request | None:
    """None where something is wrong, which ``asked`` complains of."""
    most = asked.whole("--degree", degree, 1, MOST_DEGREE)
    values = {} if system is None else read_settings(settings, system, asked)
    given = _weights(weights, asked)
    axis = None if vary is None or system is None else read_axis(vary, "--vary", system, asked)
    if vary is not None and cases:
        asked.complain("--cases", "not-together", "with --vary other parameters are numbers", "choose one of them")
    if axis is not None and axis.name in values:
        asked.complain("--set", "repeated-name", f"'{axis.name}' has an interval and a number", "leave one of them out")
    paid = BUDGET if budget is None else asked.number("--budget", budget)
    if budget is not None and not cases:
        asked.complain("--budget", "missing-option", "--budget goes with --cases", "add --cases")
    if most is None or paid is None:
        return None
    return Request(most, values, given, axis, paid)


def complain_unfit(there: Setting, request: Request, asked: Options) -> None:
    """Of ``--weight``: no such variable.  Of ``--vary``: a parameter that does not occur, or others without numbers."""
    for name in request.weights:
        if name not in there.field.variables:
            known = ", ".join(there.field.variables)
            asked.complain("--weight", "unknown-name", f"the field has no variable {name}", f"there are {known}")
    _complain_unfit(there, request.axis, asked)


def _weights(texts: tuple[str, ...], asked: Options) -> dict[str, int]:
    found: dict[str, int] = {}
    for text in texts:
        name, equals, right = (part.strip() for part in text.partition("="))
        if not equals or not name:
            asked.complain("--weight", "bad-assignment", "a variable and its weight are wanted", "for example gamma1=2")
            continue
        weight = asked.whole("--weight", right, 1, MOST_WEIGHT)
        if weight is not None:
            found[name] = weight
    return found


def _complain_unfit(there: Setting, axis: Axis | None, asked: Options) -> None:
    """Of ``--vary``: a parameter that does not occur, or others without numbers."""
    if axis is None:
        return
    if axis.name not in there.field.parameters:
        asked.complain("--vary", "not-there", f"the equations do not depend on {axis.name}", "take another parameter")
    lacking = [name for name in there.field.parameters if name != axis.name]
    if lacking:
        example = " ".join(f"--set {name}=1" for name in lacking[:3]) + (" ..." if len(lacking) > 3 else "")
        asked.complain("--set", "missing-value", f"no number for {', '.join(lacking)}", f"for example {example}")
