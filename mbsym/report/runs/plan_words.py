"""What is said of a plan: lines for the terminal, the options that repeat its run, and its part of simulation.json."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from msgspec import UNSET

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import Message, at_most, duration, joined, plainly, worded
from mbsym.model.quantities import with_unit
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.planning.plan import (
    ARITHMETIC,
    ENERGY,
    MODEL,
    OPERATIONS,
    Accuracy,
    Alternative,
    Bound,
    Item,
    Plan,
    Refused,
    Share,
)
from mbsym.report.documents import simulation as doc
from mbsym.report.runs.trajectory_csv import shortest

if TYPE_CHECKING:
    from mbsym.expressions.condition import Condition
    from mbsym.simulation import Request

#: Lines of the plan by kinds of items; the tolerance stands with the method, and one motion needs no word on kernels.
TITLES: dict[str, str] = {
    Kind.GRAVITY: "gravity field",
    Kind.LINEARITY: "equations",
    Kind.LEFT_OUT: "left out",
    Kind.MASSES: "masses",
    Kind.RESTING: "resting",
    Kind.PARTS: "parts",
    Kind.WELDED: "welded",
    Kind.METHOD: "method",
    Kind.SCALAR: "arithmetic",
}


def bound_lines(plan: Plan, unit: str | None) -> Iterator[tuple[str, Message]]:
    """(title, text): the accuracy, the bound with its shares, whether it is reached."""
    until = with_unit(f"{plan.time:g}", unit)
    yield "accuracy", Message("[[accuracy]], from 0 to [[time]]", accuracy=accuracy_words(plan.accuracy), time=until)
    for place, bound in enumerate(plan.bounds):
        yield "" if place else "bound", bound_words(bound)
        yield "", joined([share_words(share) for share in bound.shares], " + ")
        if bound.proved is not None:
            yield "", proved_words(bound)
    if plan.unshown and not plan.contradicted and all(bound.reached for bound in plan.bounds):
        text = "the accuracy asked for is not shown: the error of this run is not estimated ([[why]])"
        yield "warning", Message(text, why=plan.unshown)
    elif not plan.reached and plan.unmeasured:
        yield "warning", Message("the accuracy asked for is not shown: [[why]]", why=plan.unmeasured)
    elif not plan.reached:
        yield "warning", Message("the accuracy asked for is not reached")
    for remark in plan.remarks:
        yield "note", worded(remark)


def choice_lines(plan: Plan) -> Iterator[tuple[str, Message]]:
    """(title, text): the choices, and what a digit more or less costs."""
    for item in plan.items:
        if item.kind in TITLES:
            yield TITLES[item.kind], item_words(item, plan)
    title = "cost"
    if plan.more is not None and plan.more.target < 1:
        yield title, Message("one digit more, [[cost]]", cost=alternative_words(plan.more, plan))
        title = ""
    if plan.less is not None and plan.less.target < 1:
        yield title, Message("one digit less, [[cost]]", cost=alternative_words(plan.less, plan))


def accuracy_words(accuracy: Accuracy) -> Message:
    """``1e-06 of the size of every coordinate and velocity, energy 1e-09``."""
    text, every = "[[error]] of the size of every coordinate and velocity", accuracy.everything
    parts = [] if every is None else [Message(text, error=f"{every:g}")]
    named = [joined([_quantity(name), f"{value:g}"]) for name, value in accuracy.named.items()]
    return joined([*parts, *named], ", ")


def _quantity(name: str) -> str:
    return Message("energy") if name == ENERGY else name


def bound_words(bound: Bound) -> Message:
    """``theta2 within 4.8e-07 of its size (measured)``; of a quantity that was not named: the worst."""
    quantity, total = _quantity(bound.quantity), f"{bound.total:.1e}"
    if not isfinite(bound.total):
        return Message("[[quantity]]: nothing is known, for no run could be had to measure by", quantity=quantity)
    if bound.quantity == ENERGY:
        text = "[[quantity]] within [[total]] of the largest kinetic energy ([[how]])"
    else:
        text = "[[quantity]] within [[total]] of its size ([[how]])"
    return Message(text, quantity=quantity, total=total, how=bound.how)


def proved_words(bound: Bound) -> Message:
    """What a certificate says of the shares that are no model's."""
    assert bound.proved is not None
    if bound.proved <= bound.integrated:
        text = "integration + arithmetic at most [[bound]] at every row (proved)"
    else:
        text = "integration + arithmetic at most [[bound]] at every row (proved, which is wider than those shares)"
    return Message(text, bound=at_most(bound.proved))


def share_words(share: Share) -> Message:
    """``integration 4.8e-07 (difference from a better run, doubled)``."""
    name, error = Message(share.name), f"{share.error:.1e}"
    if share.how is None:
        return Message("[[share]] (contained in the integration's)", share=name)
    if share.error == 0:
        return Message("[[share]] 0 (nothing neglected)" if share.name == MODEL else "[[share]] 0", share=name)
    if share.name == ARITHMETIC:
        return joined([name, error])
    if share.how is not Certainty.MEASURED:
        return Message("[[share]] [[error]] ([[how]])", share=name, error=error, how=share.how)
    if share.name == MODEL:
        return Message("[[share]] [[error]] (by a rerun with the richest model)", share=name, error=error)
    return Message("[[share]] [[error]] (difference from a better run, doubled)", share=name, error=error)


def item_words(item: Item, plan: Plan) -> Message:
    """``dop853, tolerance 3.3e-08, 91 µs a run: ...; rk45 3.3e-08: error 6.6e-07, about 110 µs``."""
    chosen: str = worded(item.chosen)
    if item.kind == Kind.METHOD:
        fineness = next(choice for choice in plan.items if choice.kind == Kind.FINENESS)
        text, seconds = "[[method]], [[fineness]], [[seconds]] a run", duration(plan.seconds)
        chosen = Message(text, method=item.chosen, fineness=fineness.chosen, seconds=seconds)
    if item.kind in (Kind.MASSES, Kind.RESTING, Kind.PARTS, Kind.WELDED):
        chosen = joined([", ".join(item.what), chosen])
    why = Message("[[chosen]]: [[why]]", chosen=chosen, why=item.why)
    return joined([why, *(refused_words(refused, item.unit) for refused in item.refused)], "; ")


def refused_words(refused: Refused, unit: str) -> Message:
    """``rk45 3.3e-08: error 6.6e-07, about 110 µs``."""
    parts = [Message("error [[error]]", error=f"{refused.error:.1e}")] if refused.error is not None else []
    parts += [worded(refused.why)] if refused.why else []
    if refused.cost is not None and unit == OPERATIONS:
        parts.append(Message("[[count]] operations", count=round(refused.cost)))
    elif refused.cost is not None:
        parts.append(Message("about [[cost]]", cost=duration(refused.cost)))  # by counted work
    return joined([worded(refused.word), *([joined(parts, ", ")] if parts else [])], ": ")


def alternative_words(other: Alternative, plan: Plan) -> Message:
    """``1e-07: about 110 µs, 1.2 times as much work (dop853 5e-09)``: by counted work, and seconds in proportion."""
    target = plainly(other.target)
    if other.seconds is None:
        return Message("[[target]]: [[why]]", target=target, why=other.why)
    setting = joined([other.label, *([worded(other.model)] if other.model else [])], ", ")
    seconds, times = duration(other.seconds), other.times
    if 0.95 < times < 1.05:
        return Message(
            "[[target]]: about [[seconds]], as much work ([[setting]])", target=target, seconds=seconds, setting=setting
        )
    text = "[[target]]: about [[seconds]], [[times]] times as much work ([[setting]])"
    return Message(text, target=target, seconds=seconds, times=f"{times:.2g}", setting=setting)


def repeating_options(request: Request) -> list[str]:
    """The options after FILE, beside --set and those of the output, that repeat a settled run without choosing."""
    options = ["--time", shortest(request.time)]
    options += ["--samples", str(request.samples)] if request.samples is not None else []
    options += ["--every", shortest(request.every)] if request.every is not None else []
    options += ["--method", request.method]
    options += ["--tolerance", shortest(request.tolerance)] if request.tolerance is not None else []
    options += ["--step", shortest(request.step)] if request.step is not None else []
    options += ["--max-step", shortest(request.longest)] if request.longest is not None else []
    options += ["--arithmetic", request.arithmetic] if request.arithmetic != "float64" else []
    options += ["--gravity", str(request.model.gravity)] if request.model.gravity is not None else []
    options += ["--linear"] if request.model.linear else []
    options += [word for name in request.model.without for word in ("--without", name)]
    options += ["--whole"] if request.whole else []
    options += ["--certify", shortest(request.certify)] if request.certify is not None else []
    options += ["--step-limit", str(request.step_limit)] if request.step_limit != Setting.step_limit else []
    options += ["--invariants"] if request.invariants else []
    watched = request.events
    options += [word for event in watched.events for word in ("--event", _written(event))]
    options += [word for stop in watched.stops for word in ("--stop", _written(stop))]
    if watched.section is not None:
        axes = ", ".join(axis.text for axis in watched.section.axes)
        options += ["--section", _written(watched.section.condition), "--axes", axes]
    return options


def _written(condition: Condition) -> str:
    """With its title, where it has one of its own."""
    return condition.text if condition.title == condition.text else f"{condition.title}: {condition.text}"


def repeating_command(file: str, settings: Sequence[str], request: Request, carried: Sequence[str] = ()) -> str:
    """A command to paste; ``carried`` are words about what is written and estimated."""
    sets = [word for text in settings for word in ("--set", text)]
    return shlex.join(["mbsym", "simulate", file, *sets, *repeating_options(request), *carried])


# --- simulation.json ---


def plan_json(plan: Plan, request: Request) -> doc.Plan:
    """The plan without seconds, which no two runs share."""
    return doc.Plan.from_result(
        plan,
        accuracy=doc.Accuracy.from_result(plan.accuracy),
        bounds=[
            doc.Bound.from_result(
                bound,
                shares=[doc.Share.from_result(x, how=x.how or "together") for x in bound.shares],
                proved_at_rows=UNSET if bound.proved is None else bound.proved,
            )
            for bound in plan.bounds
        ],
        items=[doc.Item.from_result(x) for x in plan.items],
        options=repeating_options(request),
    )
