"""What is said of a slow manifold: sentences with gaps, filled by whoever writes them."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.analysis.expanding import Expansion
from mbsym.formulas.formula import Formula
from mbsym.problems.small_parameter.result import Outcome
from mbsym.report.said import Said

MANIFOLD = "Slow integral manifold up to order [[order]] of [[small]]"
FLOW = "The flow on it, up to order [[order]]"

_FAST = {
    Outcome.HOLDS: "The manifold attracts near this motion for all sufficiently small [[small]] > 0 (proved: Hurwitz's "
    "minors of the fast roots, by their first coefficients).",
    Outcome.CONDITIONAL: "The manifold attracts near this motion for all sufficiently small [[small]] > 0 where "
    "[[conditions]] (proved: Hurwitz's minors of the fast roots, by their first coefficients).",
    Outcome.FAILS: "The manifold does not attract near this motion for any sufficiently small [[small]] > 0 (proved: a "
    "Hurwitz minor of the fast roots is negative).",
    Outcome.UNDECIDED: "Whether the manifold attracts near this motion is undecided: a Hurwitz minor of the fast roots "
    "vanishes to the order of the expansion, or has no sign.",
}
_SLOW = {
    Outcome.HOLDS: "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all "
    "sufficiently small [[small]] > 0 (proved in first approximation).",
    Outcome.CONDITIONAL: "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all "
    "sufficiently small [[small]] > 0 where [[conditions]] (proved in first approximation).",
    Outcome.FAILS: "Of the flow on it, not all roots but [[zeros]] that are zero have negative real parts for "
    "sufficiently small [[small]] > 0 (proved in first approximation).",
    Outcome.UNDECIDED: "Whether the roots of the flow on it have negative real parts is undecided: a Hurwitz minor "
    "vanishes to the order of the expansion, or has no sign.",
}


def sentences(found: Expansion) -> Iterator[Said]:
    """What was checked, and what is known of the motion on the manifold and towards it."""
    manifold = found.manifold
    least = [one for one in manifold.residuals if one is not None]
    values: dict[str, object] = {"small": manifold.field.small, "order": manifold.order}
    if least:
        yield (
            "Put into the equations at a random rational state, it leaves terms of order [[left]] (verified).",
            values | {"left": min(least)},
        )
    else:
        yield "Put into the equations at a random rational state, it leaves nothing (verified).", values
    if found.provided:
        yield (
            "It holds where these are not zero, which were divided by: [[provided]].",
            {"provided": ", ".join(map(str, found.provided))},
        )
    if manifold.steady is None:
        yield "Nothing is said of stability: [[missing]].", {"missing": found.missing}
        return
    values["zeros"] = manifold.steady.zeros
    outcome, conditions = found.fast
    yield _FAST[outcome], values | {"conditions": _told(found, conditions)}
    if len(manifold.steady.slow.polynomial) > 1:
        outcome, conditions = found.slow
        yield _SLOW[outcome], values | {"conditions": _told(found, conditions)}
    yield (
        "The characteristic polynomial of all variables is divided by that of the flow without a remainder up to order "
        "[[known]] (verified).",
        values | {"known": manifold.steady.remainder - 1},
    )
    yield (
        "By the reduction principle (Strygin and Sobolev) a steady state on an attracting slow manifold is stable, "
        "asymptotically stable or unstable as it is in the flow on it. How small [[small]] has to be is not known "
        "from this: at given values problem 6 decides.",
        values,
    )


def _told(found: Expansion, conditions: tuple[object, ...]) -> str:
    ring = found.transfer.ring
    parts = []
    for one in conditions:
        if one.kind == "inequality":  # type: ignore[attr-defined]
            parts.append(_product(found, one.factors) + " > 0")  # type: ignore[attr-defined]
        parts += [f"{Formula(ring, p)} != 0" for p in one.nonzero]  # type: ignore[attr-defined]
    return " and ".join(dict.fromkeys(parts))


def _product(found: Expansion, factors: tuple[object, ...]) -> str:
    texts = [str(Formula(found.transfer.ring, p)) for p in factors]
    return texts[0] if len(texts) == 1 else " ".join(f"({text})" for text in texts)
