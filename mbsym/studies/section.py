"""What keeps a section of the parameters from being made, as complaints about options."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message, worded
from mbsym.studies.study import Unfit

if TYPE_CHECKING:
    from mbsym.maps.axis import Axis
    from mbsym.maps.section import Complaint
    from mbsym.model.system import System


FOLLOWS = "[[name]] follows from other parameters: [[how]]"


def distinct(axes: Sequence[Axis], settings: Mapping[str, Fraction]) -> Iterator[Unfit]:
    """No name is taken twice, as two axes or as an axis that has a number."""
    names = [axis.name for axis in axes]
    for name in dict.fromkeys(name for name in names if names.count(name) > 1):
        yield Unfit(
            "--y", "repeated-name", Message("'[[name]]' is taken for two axes", name=name), "choose another one"
        )
    for name in names:
        if name in settings:
            message = Message("'[[name]]' has an interval and a number", name=name)
            yield Unfit("--set", "repeated-name", message, "leave one of them out")


def unless_parameter(option: str, name: str, system: System) -> Iterator[Unfit]:
    """Relative equilibria are solved at numbers of parameters: symbols and what follows from relations do not fit."""
    from mbsym.expressions.tree import text

    related = next((item for item in system.relations if item.name == name), None)
    if related is not None:
        message = Message(FOLLOWS, name=name, how=f"{name} = {text(related.value)}")
        yield Unfit(option, "given-by-relation", message, "take one of those of which its relation is made")
    elif name not in system.parameter_names and name in [item.name for item in system.notation]:
        message = Message("'[[name]]' is no parameter but a symbol of the notation", name=name)
        yield Unfit(option, "misplaced-name", message, "take the parameters of which it is made")


def against_sign(option: str, axis: Axis, system: System) -> Iterator[Unfit]:
    """An interval against the declared sign of its parameter."""
    sign = next((str(parameter.sign) for parameter in system.parameters if parameter.name == axis.name), "")
    if (sign in ("positive", "nonnegative") and axis.low < 0) or (
        sign in ("negative", "nonpositive") and axis.high > 0
    ):
        message = Message(
            "[[name]] is declared [[sign]], and the interval from [[low]] to [[high]] is not",
            name=axis.name, sign=worded(sign), low=str(axis.low), high=str(axis.high),
        )  # fmt: skip
        yield Unfit(option, "against-sign", message, "choose an interval of that sign")


def no_number(lacking: Sequence[str]) -> Unfit:
    """Of parameters that need one."""
    example = " ".join(f"--set {name}=1" for name in lacking[:3]) + (" ..." if len(lacking) > 3 else "")
    lacks = Message("no number for [[names]]", names=", ".join(lacking))
    return Unfit("--set", "missing-value", lacks, Message("for example [[example]]", example=example))


def unfit_section(wrong: Sequence[Complaint], axis_option: str) -> Iterator[Unfit]:
    """Why a section cannot be made: everything at once, each with what to do."""
    from mbsym.maps.section import Fault

    lacking = list(dict.fromkeys(complaint.name for complaint in wrong if complaint.fault is Fault.MISSING))
    if lacking:
        yield no_number(lacking)
    for flaw in dict.fromkeys(wrong):
        match flaw.fault:
            case Fault.RELATED:
                message = Message(FOLLOWS, name=flaw.name, how=flaw.about)
                yield Unfit(axis_option, "given-by-relation", message, "take those of which its relation is made")
            case Fault.SOLVED:
                message = Message("[[name]] has one value on the motion only: [[how]]", name=flaw.name, how=flaw.about)
                yield Unfit(axis_option, "given-by-motion", message, "take those of which its value is made")
            case Fault.DEPENDENT:
                message = Message("[[name]] is not independent of the parameters", name=flaw.name)
                if flaw.about:
                    message = Message("[[name]] is not independent of [[others]]", name=flaw.name, others=flaw.about)
                yield Unfit(axis_option, "not-independent", message, "leave one of them out")
            case Fault.SIGN:
                message = Message(
                    "[[name]] is declared [[sign]], or is by its definition", name=flaw.name, sign=worded(flaw.about)
                )
                yield Unfit("--set", "against-sign", message, "choose a number of that sign")
            case Fault.NOWHERE:
                text = "the motion of the description exists nowhere there: [[why]]"
                message = Message(text, why=worded(flaw.name or flaw.about))
                yield Unfit("--set", "no-motion", message, "see problem 4 for the conditions")
            case Fault.OUTSIDE:
                message = Message("no point of the map keeps what has to be kept: [[what]]", what=worded(flaw.about))
                yield Unfit("--set", "outside", message, "choose other values, or another interval")
            case Fault.IRRATIONAL:
                message = Message(
                    "the matrices hold what is no rational number there: [[what]]", what=worded(flaw.name)
                )
                remedy = "choose values at which roots and angles are rational; 'mbsym sweep' judges stability at any"
                yield Unfit("--set", "irrational", message, remedy)
            case Fault.SINGULAR:
                message = Message("a division by zero in [[what]]", what=worded(flaw.name))
                yield Unfit("--set", "division-by-zero", message, "choose other values")
