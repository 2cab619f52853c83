"""What ``mbsym simulate`` is asked of many motions, or of how one answers to changes."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import prod
from typing import TYPE_CHECKING, Any

from mbsym.expressions.message import Message
from mbsym.studies.request import Ranges
from mbsym_cli.options import Options
from mbsym_cli.variations import read_variations

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from mbsym.numerics.ensembles.variation import Variation
    from mbsym.numerics.scenario import Scenario
    from mbsym_cli.simulate.request import Asked

#: So many motions of a grid are drawn as curves beside each other.
MOST_BESIDE = 6

#: More names than this are not varied at once.
MOST_VARIED = 32


@dataclass(frozen=True)
class Varied:
    """An ensemble as it was asked for."""

    variations: tuple[Variation, ...]
    members: int | None
    seed: int
    sampling: str

    @property
    def few(self) -> tuple[tuple[tuple[str, float], ...], ...]:
        """The members by what varies, where they are grids of no more than can be drawn beside each other."""
        from mbsym.numerics.ensembles.variation import Grid

        grids = [one for one in self.variations if isinstance(one, Grid)]
        if len(grids) < len(self.variations) or prod(one.count for one in grids) > MOST_BESIDE:
            return ()
        return tuple(product(*([(one.name, float(value)) for value in one.values] for one in grids)))


def read_many(
    texts: Mapping[str, Any], given: Scenario | None, wanted: Asked, typed: Collection[str], options: Options
) -> tuple[Varied | None, tuple[str, ...]]:
    """(the ensemble, names to differentiate by); what is wrong joins the complaints."""
    names = _sensitive(texts["sensitivity"], given, options)
    if not texts["vary"]:
        return None, names
    from mbsym.numerics.ensembles.variation import Grid

    _check_method(wanted, options)
    members = options.whole("--members", texts["members"], 2, 10**12)
    seed = options.whole("--seed", texts["seed"], 0, 2**63 - 1)
    sampling = options.word("--sampling", texts["sampling"], ("random", "sobol"), "sampling")
    system = None if given is None else given.system
    read = read_variations("--vary", texts["vary"], Ranges("NAME=RANGE", "", most=MOST_VARIED), system, given, options)
    found = [one.variation for one in read or ()]
    if found and all(isinstance(one, Grid) for one in found):
        for option in sorted({"--seed", "--sampling"} & set(typed)):
            words = "[[option]] does not go with --vary [[name]]: a grid, of which nothing is drawn"
            told = Message(words, option=option, name=found[0].name)
            options.complain(option, "conflicting-options", told, "draw it: name=uniform(low, high)")
    if given is None or read is None or seed is None or sampling is None:
        return None, names
    if texts["members"] is not None and members is None:
        return None, names
    from mbsym.numerics.ensembles.variation import complaints_of

    for name, wrong, hint in complaints_of(given.system, found, members):
        options.complain(f"--vary {name}", "bad-variation", wrong, hint or None)
    return Varied(tuple(found), members, seed, sampling), names


def _check_method(wanted: Asked, options: Options) -> None:
    from mbsym.numerics.ensembles.side_by_side import TABLEAUX

    request = wanted.request
    if request.method != "auto" and request.method not in TABLEAUX:
        told = Message("members do not run side by side with [[method]]", method=request.method)
        options.complain(
            "--method", "unsuitable-method", told, Message("choose from [[names]]", names=", ".join(TABLEAUX))
        )
    for kind in wanted.formats:
        if kind not in ("csv", "svg", "png", "pdf"):
            told = Message("there is no [[format]] of an ensemble", format=kind)
            options.complain(
                "--format", "conflicting-options", told, Message("choose from [[names]]", names="csv, svg, png, pdf")
            )


def _sensitive(text: str | None, given: Scenario | None, options: Options) -> tuple[str, ...]:
    if text is None:
        return ()
    named = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if not named:
        options.complain(
            "--sensitivity",
            "missing-option",
            "there is no name in it",
            Message("for example [[example]]", example="theta,m1"),
        )
    if given is None:
        return named
    from mbsym.source.scope import closest

    system = given.system
    known = (*system.parameter_names, *system.coordinates, *system.velocities, *system.variables)
    following = {relation.name for relation in system.relations}
    for name in named:
        if name not in known:
            close = closest(name, known)
            hint = Message("there are [[names]]", names=", ".join(known))
            if close:
                hint = Message("did you mean '[[other]]'?", other=close)
            told = Message("there is nothing called '[[name]]' here", name=name)
            options.complain("--sensitivity", "unknown-name", told, hint)
        elif name in following:
            told = Message("[[name]] follows from other parameters", name=name)
            options.complain("--sensitivity", "bad-variation", told, "name those of which its relation is made")
    if _jumps(given):
        jumps = "the rates hold sign, abs or step, and derivatives of the motion would miss what their switches do"
        way = "compare runs: --vary with two or three values close together"
        options.complain("--sensitivity", "not-smooth", jumps, way)
    return named


def _jumps(given: Scenario) -> bool:
    """Whether the rates have switches; False where there are no rates, which is told later."""
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.dynamics import Dynamics

    try:
        return bool(Dynamics(given).switches.outputs)
    except Failure:
        return False
