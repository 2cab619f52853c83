"""The options of ``mbsym simulate`` that ask for many motions, or for how one answers to changes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from mbsym.expressions.place import Complaints, Span
from mbsym.source import render_option
from mbsym_cli.option_groups import group
from mbsym_cli.options import MAX_LENGTH, Options

if TYPE_CHECKING:
    from collections.abc import Collection

    from mbsym.numerics.ensembles.variation import Variation
    from mbsym.numerics.scenario import Scenario
    from mbsym_cli.simulate.request import Asked

#: More names than this are not varied at once.
MOST_VARIED = 32

_DRAW = re.compile(r"\s*(normal|uniform)\s*\((.*)\)\s*", re.DOTALL)
_HINT = "write name=0:pi/2:1000, name=normal(0.3, 0.01) or name=uniform(0, 1)"


@dataclass(frozen=True)
class Many:
    """What varies, and what is differentiated by, as it was typed."""

    vary: tuple[str, ...]
    members: str | None
    seed: str
    sampling: str
    sensitivity: str | None


many_options = group(
    "many",
    Many,
    click.option(
        "--vary",
        multiple=True,
        metavar="NAME=RANGE",
        help="Many motions at once: theta=0:pi/2:1000 (a grid), theta=normal(0.3, 0.01), m=uniform(1, 2); repeatable.",
    ),
    click.option("--members", metavar="N", help="How many members to draw at random, for example --members 1000."),
    click.option("--seed", metavar="N", default="1", show_default=True, help="Of what is drawn at random."),
    click.option("--sampling", metavar="[random|sobol]", default="random", show_default=True),
    click.option(
        "--sensitivity",
        metavar="NAMES",
        help="Derivatives of the motion by initial values and parameters: --sensitivity theta,m1.",
    ),
)


@dataclass(frozen=True)
class Varied:
    """An ensemble as it was asked for."""

    variations: tuple[Variation, ...]
    members: int | None
    seed: int
    sampling: str


def read_many(
    many: Many, given: Scenario | None, wanted: Asked, typed: Collection[str], options: Options
) -> tuple[Varied | None, tuple[str, ...]]:
    """(the ensemble, names to differentiate by); what is wrong joins the complaints."""
    names = _sensitive(many.sensitivity, given, options)
    if not many.vary:
        return None, names
    from mbsym.numerics.ensembles.variation import Grid

    _check_method(wanted, options)
    if len(many.vary) > MOST_VARIED:
        options.complain("--vary", "too-large", f"at most {MOST_VARIED} names vary at once")
        return None, names
    members = options.whole("--members", many.members, 2, 10**12)
    seed = options.whole("--seed", many.seed, 0, 2**63 - 1)
    sampling = options.word("--sampling", many.sampling, ("random", "sobol"), "sampling")
    found = [one for text in many.vary for one in _variation(text, given, options)]
    if found and all(isinstance(one, Grid) for one in found):
        for option in sorted({"--seed", "--sampling"} & set(typed)):
            told = f"{option} does not go with --vary {found[0].name}: a grid, of which nothing is drawn"
            options.complain(option, "conflicting-options", told, "draw it: name=uniform(low, high)")
    if given is None or len(found) < len(many.vary) or seed is None or sampling is None:
        return None, names
    if many.members is not None and members is None:
        return None, names
    from mbsym.numerics.ensembles.variation import complaints_of

    for name, told, hint in complaints_of(given.system, found, members):
        options.complain(f"--vary {name}", "bad-variation", told, hint or None)
    return Varied(tuple(found), members, seed, sampling), names


def _check_method(wanted: Asked, options: Options) -> None:
    from mbsym.numerics.ensembles.side_by_side import TABLEAUX

    request = wanted.request
    if request.method != "auto" and request.method not in TABLEAUX:
        told = f"members do not run side by side with {request.method}"
        options.complain("--method", "unsuitable-method", told, f"choose from {', '.join(TABLEAUX)}")
    for kind in wanted.formats:
        if kind not in ("csv", "svg", "png", "pdf"):
            told = f"there is no {kind} of an ensemble"
            options.complain("--format", "conflicting-options", told, "choose from csv, svg, png, pdf")


def _variation(text: str, given: Scenario | None, options: Options) -> list[Variation]:
    from mbsym.numerics.ensembles.variation import Draw, Grid

    text = " ".join(text.splitlines())
    name, equals, right = (part.strip() for part in text.partition("="))
    if not equals or not name or not right or len(text) > MAX_LENGTH:
        options.complain("--vary", "bad-variation", "this says no range", _HINT)
        return []
    draw = _DRAW.fullmatch(right)
    parts = [part.strip() for part in (draw[2].split(",") if draw else right.split(":"))]
    if len(parts) != (2 if draw else 3):
        options.complain("--vary", "bad-variation", f"{name}: this is no range", _HINT)
        return []
    ends = [_number(part, given, options) for part in parts[:2]]
    count = 0 if draw else options.whole("--vary", parts[2], 2, 10**12)
    if ends[0] is None or ends[1] is None or count is None:
        return []
    return [Draw(name, draw[1], ends[0], ends[1]) if draw else Grid(name, ends[0], ends[1], count)]


def _number(text: str, given: Scenario | None, options: Options) -> float | None:
    """A number made of numbers, pi and parameters, of either sign."""
    from mbsym.algebra.failures import Failure
    from mbsym.expressions.parser import parse_expression
    from mbsym.expressions.tree import names
    from mbsym.numerics.scenario import exact

    complaints, whole = Complaints(), Span(1, 1, max(1, len(text)))
    value = parse_expression(text, complaints, lambda start, end: Span(1, start + 1, max(1, end - start)))
    known = dict(given.parameters) if given is not None else {}
    found = None
    if value is not None and not complaints.errors:
        unknown = sorted(names(value) - {*known, "pi"})
        if unknown and given is not None:
            complaints.error("unknown-name", f"unknown name {unknown[0]}", whole, "numbers, pi and parameters")
        elif not unknown:
            try:
                found = float(exact(value, known))
            except Failure as reason:
                complaints.error("bad-number", f"it has no value: {reason}", whole)
    options.complaints += [render_option(one, text, "--vary") for one in complaints.sorted()]
    return found


def _sensitive(text: str | None, given: Scenario | None, options: Options) -> tuple[str, ...]:
    if text is None:
        return ()
    named = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if not named:
        options.complain("--sensitivity", "missing-option", "there is no name in it", "for example theta,m1")
    if given is None:
        return named
    from mbsym.source.scope import closest

    system = given.system
    known = (*system.parameter_names, *system.coordinates, *system.velocities)
    following = {relation.name for relation in system.relations}
    for name in named:
        if name not in known:
            close = closest(name, known)
            hint = f"did you mean '{close}'?" if close else f"there are {', '.join(known)}"
            options.complain("--sensitivity", "unknown-name", f"there is nothing called {name!r} here", hint)
        elif name in following:
            told = f"{name} follows from other parameters"
            options.complain("--sensitivity", "bad-variation", told, "name those of which its relation is made")
    if _jumps(given):
        told = "the rates hold sign, abs or step, and derivatives of the motion would miss what their switches do"
        hint = "compare runs: --vary with two or three values close together"
        options.complain("--sensitivity", "not-smooth", told, hint)
    return named


def _jumps(given: Scenario) -> bool:
    """Whether the rates have switches; False where there are no rates, which is told later."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.dynamics import Dynamics

    try:
        return bool(Dynamics(given).switches.outputs)
    except Failure:
        return False
