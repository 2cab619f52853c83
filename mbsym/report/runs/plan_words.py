"""What is said of a plan: lines for the terminal, the options that repeat its run, and its part of simulation.json."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from math import isfinite
from typing import TYPE_CHECKING

from msgspec import UNSET

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.counting import counted
from mbsym.numerics.methods.interface import Setting
from mbsym.numerics.planning.kinds import (
    FINENESS,
    GRAVITY,
    LEFT_OUT,
    LINEARITY,
    MASSES,
    METHOD,
    PARTS,
    RESTING,
    SCALAR,
    WELDED,
)
from mbsym.numerics.planning.models import Model
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
from mbsym.report.runs.certificate import at_most

if TYPE_CHECKING:
    from mbsym.expressions.condition import Condition
    from mbsym.simulation import Request

#: How a share is known, in words.
HOW = {Certainty.MEASURED: "difference from a better run, doubled", Certainty.ESTIMATED: "estimated"}

#: Lines of the plan by kinds of items; the tolerance stands with the method, and one motion needs no word on kernels.
TITLES = {
    GRAVITY: "gravity",
    LINEARITY: "equations",
    LEFT_OUT: "left out",
    MASSES: "masses",
    RESTING: "resting",
    PARTS: "parts",
    WELDED: "welded",
    METHOD: "method",
    SCALAR: "arithmetic",
}


def duration(seconds: float) -> str:
    """``91 µs``."""
    for limit, factor, unit in ((1e-3, 1e6, "µs"), (1.0, 1e3, "ms")):
        if seconds < limit:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds:.3g} s"


def plan_lines(plan: Plan, unit: str | None) -> Iterator[tuple[str, str]]:
    """(title, text): the accuracy, the bound with its shares, the choices, a digit more or less."""
    until = f"{plan.time:g}" + (f" {unit}" if unit else "")
    yield "accuracy", f"{accuracy_words(plan.accuracy)}, from 0 to {until}"
    for place, bound in enumerate(plan.bounds):
        yield "" if place else "bound", bound_words(bound)
        yield "", " + ".join(share_words(share) for share in bound.shares)
        if bound.proved is not None:
            yield "", proved_words(bound)
    if plan.unshown and not plan.contradicted and all(bound.reached for bound in plan.bounds):
        yield "warning", f"the accuracy asked for is not shown: the error of this run is not estimated ({plan.unshown})"
    elif not plan.reached:
        why = plan.unmeasured
        yield "warning", f"the accuracy asked for is not {f'shown: {why}' if why else 'reached'}"
    for item in plan.items:
        if item.kind in TITLES:
            yield TITLES[item.kind], item_words(item, plan)
    for title, other in (("one digit more", plan.more), ("one digit less", plan.less)):
        if other is not None and other.target < 1:
            yield "" if title.endswith("less") else "cost", f"{title}, {alternative_words(other, plan)}"
    for remark in plan.remarks:
        yield "note", remark


def accuracy_words(accuracy: Accuracy) -> str:
    """``1e-06 of every coordinate and velocity, energy 1e-09``."""
    every = accuracy.everything
    parts = [] if every is None else [f"{every:g} of the size of every coordinate and velocity"]
    return ", ".join([*parts, *(f"{name} {value:g}" for name, value in accuracy.named.items())])


def bound_words(bound: Bound) -> str:
    """``theta2 within 4.8e-07 of its size (measured)``; of a quantity that was not named: the worst."""
    if not isfinite(bound.total):
        return f"{bound.quantity}: nothing is known, for no run could be had to measure by"
    of = "the largest kinetic energy" if bound.quantity == ENERGY else "its size"
    return f"{bound.quantity} within {bound.total:.1e} of {of} ({bound.how})"


def proved_words(bound: Bound) -> str:
    """What a certificate says of the shares that are no model's."""
    assert bound.proved is not None
    within = "" if bound.proved <= bound.integrated else ", which is wider than those shares"
    return f"integration + arithmetic at most {at_most(bound.proved)} at every row (proved{within})"


def share_words(share: Share) -> str:
    """``integration 4.8e-07 (difference from a better run, doubled)``."""
    if share.how is None:
        return f"{share.name} (contained in the integration's)"
    if share.error == 0:
        return f"{share.name} 0 (nothing neglected)" if share.name == MODEL else f"{share.name} 0"
    how = (
        "by a rerun with the richest model"
        if share.name == MODEL and share.how is Certainty.MEASURED
        else HOW[share.how]
    )
    return f"{share.name} {share.error:.1e} ({how})" if share.name != ARITHMETIC else f"{share.name} {share.error:.1e}"


def item_words(item: Item, plan: Plan) -> str:
    """``dop853, tolerance 3.3e-08, 91 µs a run: ...; rk45 3.3e-08: error 6.6e-07, about 110 µs``."""
    chosen = item.chosen
    if item.kind == METHOD:
        fineness = next(one for one in plan.items if one.kind == FINENESS)
        chosen = f"{chosen}, {fineness.chosen}, {duration(plan.seconds)} a run"
    what = f"{', '.join(item.what)} " if item.kind in (MASSES, RESTING, PARTS, WELDED) else ""
    refused = "".join(f"; {refused_words(one, item.unit)}" for one in item.refused)
    return f"{what}{chosen}: {item.why}{refused}"


def refused_words(one: Refused, unit: str) -> str:
    """``rk45 3.3e-08: error 6.6e-07, about 110 µs``."""
    parts = [f"error {one.error:.1e}"] if one.error is not None else []
    parts += [one.why] if one.why else []
    if one.cost is not None:
        about = f"about {duration(one.cost)}"  # by counted work
        parts.append(counted(round(one.cost), "operation", "operations") if unit == OPERATIONS else about)
    return f"{one.word}: {', '.join(parts)}" if parts else one.word


def alternative_words(other: Alternative, plan: Plan) -> str:
    """``1e-07: about 110 µs, 1.2 times as much work (dop853 5e-09)``: by counted work, and seconds in proportion."""
    model = f", {other.model}" if other.model else ""
    if other.seconds is None:
        return f"{other.target:.0e}: {other.why}"
    times = other.times
    same = "as much work" if 0.95 < times < 1.05 else f"{times:.2g} times as much work"
    return f"{other.target:.0e}: about {duration(other.seconds)}, {same} ({other.label}{model})"


def repeating_options(request: Request) -> list[str]:
    """The options after FILE, beside --set and those of the output, that repeat a settled run without choosing."""
    found = ["--time", _number(request.time)]
    found += ["--samples", str(request.samples)] if request.samples is not None else []
    found += ["--every", _number(request.every)] if request.every is not None else []
    found += ["--method", request.method]
    found += ["--tolerance", _number(request.tolerance)] if request.tolerance is not None else []
    found += ["--step", _number(request.step)] if request.step is not None else []
    found += ["--max-step", _number(request.longest)] if request.longest is not None else []
    found += ["--arithmetic", request.arithmetic] if request.arithmetic != "float64" else []
    found += ["--gravity", str(request.model.gravity)] if request.model.gravity is not None else []
    found += ["--linear"] if request.model.linear else []
    found += [word for name in request.model.without for word in ("--without", name)]
    found += ["--whole"] if request.whole else []
    found += ["--certify", _number(request.certify)] if request.certify is not None else []
    found += ["--step-limit", str(request.step_limit)] if request.step_limit != Setting.step_limit else []
    found += ["--invariants"] if request.invariants else []
    watched = request.events
    found += [word for one in watched.events for word in ("--event", _written(one))]
    found += [word for one in watched.stops for word in ("--stop", _written(one))]
    if watched.section is not None:
        axes = ", ".join(axis.text for axis in watched.section.axes)
        found += ["--section", _written(watched.section.condition), "--axes", axes]
    return found


def _written(condition: Condition) -> str:
    """With its title, where it has one of its own."""
    return condition.text if condition.title == condition.text else f"{condition.title}: {condition.text}"


def _number(x: float) -> str:
    """The shortest text that is read as the same number."""
    return repr(x).removesuffix(".0")


def repeating_command(file: str, settings: Sequence[str], request: Request, carried: Sequence[str] = ()) -> str:
    """A command to paste; ``carried`` are words about what is written and estimated."""
    sets = [word for text in settings for word in ("--set", text)]
    return shlex.join(["mbsym", "simulate", file, *sets, *repeating_options(request), *carried])


# --- simulation.json ---


def model_json(model: Model) -> doc.Model:
    """What is in the equations."""
    return doc.Model(gravity=model.gravity, linear=model.linear, without=list(model.without))


def plan_json(plan: Plan, request: Request) -> doc.Plan:
    """The plan without seconds, which no two runs share."""
    return doc.Plan(
        accuracy=doc.Accuracy(everything=plan.accuracy.everything, named=dict(plan.accuracy.named)),
        reached=plan.reached,
        bounds=[
            doc.Bound(
                quantity=bound.quantity,
                target=bound.target,
                total=bound.total,
                how=bound.how,
                shares=[doc.Share(name=x.name, error=x.error, how=x.how or "together") for x in bound.shares],
                proved_at_rows=UNSET if bound.proved is None else bound.proved,
            )
            for bound in plan.bounds
        ],
        items=[
            doc.Item(kind=x.kind, what=list(x.what), chosen=x.chosen, why=x.why, error=x.error, how=x.how)
            for x in plan.items
        ],
        remarks=list(plan.remarks),
        options=repeating_options(request),
    )
