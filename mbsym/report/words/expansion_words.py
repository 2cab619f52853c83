"""What is said of problem 12: sentences with gaps, filled by whoever writes them (terminal, LaTeX, HTML)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.quotients import Series
from mbsym.algebra.signs import Condition
from mbsym.analysis.expanding import Expansion
from mbsym.analysis.small import Averaging, SmallParameters
from mbsym.formulas.formula import Formula
from mbsym.problems.small_parameter.result import Outcome
from mbsym.problems.stability import Stability
from mbsym.problems.stability.word import Word
from mbsym.report.conditions import statements
from mbsym.report.words.expansion_measured import SLACK, JudgedAverage
from mbsym.report.words.said import Said

if TYPE_CHECKING:
    from mbsym.simulation.averaged import Measured as MeasuredAverage
    from mbsym.simulation.expanded import Measured

SERIES = (
    "Slow integral manifold up to order [[order]] of [[small]]: the fast variables [[fast]] as functions of the slow "
    "ones [[slow]], and the flow on it. The coefficient of the power k of [[small]] has the index (k)."
)
NOTHING = (
    "The description names no small parameter, and no prescribed quantity has a parameter as its rate: nothing is "
    "expanded."
)

TOO_SLOW = (
    "It shrinks more slowly than expected: the parameter is too large there, the time too long, or something is wrong."
)
#: Of an effective potential that the program's own measurement contradicts.
WITHDRAWN = (
    "The result of averaging over [[phase]] is withdrawn: over a time of [[time]] the largest distance of the motion "
    "from the averaged one, as a part of its size, is [[distances]] at the given values, and with epsilon a half and a "
    "quarter of it; it changes like the power [[orders]] of epsilon instead of 1."
)


def too_slow(orders: Sequence[float], expected: int) -> bool:
    """Whether the last of the measured orders falls short of the expected one."""
    return bool(orders) and orders[-1] < expected - SLACK


@dataclass(frozen=True)
class Medium:
    """How a medium writes names, a formula, ``formula relation 0``, a word."""

    names: Callable[[Sequence[str]], str]
    formula: Callable[[Formula], str]
    condition: Callable[[Formula, str], str]
    word: Callable[[str], str]


@dataclass(frozen=True)
class Coefficient:
    """The coefficient of eps^``order`` in the series of a variable, or of its rate."""

    variable: str
    rate: bool
    order: int
    formula: Formula


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
#: Where no root is zero by itself.
_ALL = {
    Outcome.HOLDS: "All roots of the flow on it have negative real parts for all sufficiently small [[small]] > 0 "
    "(proved in first approximation).",
    Outcome.CONDITIONAL: "All roots of the flow on it have negative real parts for all sufficiently small [[small]] "
    "> 0 where [[conditions]] (proved in first approximation).",
    Outcome.FAILS: "Not all roots of the flow on it have negative real parts for sufficiently small [[small]] > 0 "
    "(proved in first approximation).",
}
#: Where some are, by coordinates on which nothing depends.
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


def coefficients(found: Expansion) -> Iterator[Coefficient]:
    """All of the manifold, then all of the flow."""
    manifold = found.manifold
    for rate, names, series in ((False, manifold.fast, manifold.functions), (True, manifold.slow, manifold.flow)):
        for name, one in zip(names, series, strict=True):
            for k, formula in of_series(found, one):
                yield Coefficient(name, rate, k, formula)


def of_series(found: Expansion, one: Series) -> Iterator[tuple[int, Formula]]:
    """Exponents and coefficients, in order; 0 where there are none."""
    listed = one.coefficients or {0: one.coefficient(0)}
    for k in sorted(listed):
        yield k, found.formula(listed[k])


def opening(found: Expansion, write: Medium) -> Iterator[Said]:
    """What is expanded in what."""
    manifold = found.manifold
    small = write.names([manifold.field.small])
    yield from scaled(manifold.field.powers, manifold.field.small, write)
    values: dict[str, object] = {"order": manifold.order, "small": small}
    yield SERIES, values | {"fast": write.names(manifold.fast), "slow": write.names(manifold.slow)}


def scaled(powers: Iterable[tuple[str, int]], small: str, write: Medium) -> Iterator[Said]:
    """What stands for its product with a power of the small parameter."""
    for name, power in powers:
        yield (
            "[[name]] is multiplied by the power [[power]] of [[small]].",
            {"name": write.names([name]), "power": power, "small": write.names([small])},
        )


def sentences(found: Expansion, write: Medium) -> Iterator[Said]:
    """What was checked, and what is known of the motion on the manifold and towards it."""
    manifold = found.manifold
    least = [one for one in manifold.residuals if one is not None]
    values: dict[str, object] = {"small": write.names([manifold.field.small]), "order": manifold.order}
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
            {"provided": ", ".join(map(write.formula, found.provided))},
        )
    if manifold.steady is None:
        yield "Nothing is said of stability: [[missing]].", {"missing": write.word(found.missing)}
        return
    values["zeros"] = manifold.steady.zeros
    outcome, conditions = found.fast
    yield _FAST[outcome], values | {"conditions": _told(found, conditions, write)}
    if len(manifold.steady.slow.polynomial) > 1:
        outcome, conditions = found.slow
        told = _SLOW if manifold.steady.zeros else _SLOW | _ALL
        yield told[outcome], values | {"conditions": _told(found, conditions, write)}
    elif manifold.steady.zeros:
        yield "All roots of the flow on it are zero: the first approximation decides nothing there.", {}
    yield (
        "The characteristic polynomial of all variables is divided by that of the flow without a remainder up to order "
        "[[known]] (verified).",
        values | {"known": manifold.steady.remainder - 1},
    )
    if found.fast[0] is Outcome.FAILS:  # a negative minor: a root to the right, whatever the flow on the manifold does
        yield (
            "A fast root has a positive real part: this motion is unstable for all sufficiently small [[small]] > 0.",
            values,
        )
        return
    yield (
        "By the reduction principle (Strygin and Sobolev) a steady state on an attracting slow manifold is stable, "
        "asymptotically stable or unstable as it is in the flow on it. How small [[small]] has to be is not known "
        "from this: at given values problem 6 decides.",
        values,
    )


def of_measured(small: str, told: Measured | str, write: Medium) -> Iterator[Said]:
    """The error of the flow against all equations."""
    if isinstance(told, str):
        yield "The error of the flow was not measured: [[why]].", {"why": write.word(told)}
        return
    values: dict[str, object] = {"small": write.names([small]), "time": f"{told.time:.4g}"}
    values["distances"] = ", ".join(f"{x:.2g}" for x in told.distances)
    if told.exact:
        yield (
            "Measured against a simulation of all equations over a time of [[time]]: the distance of the slow "
            "variables is no larger than the errors of the integrations.",
            values,
        )
        return
    yield (
        "Measured against a simulation of all equations over a time of [[time]], both from the manifold: the largest "
        "distance of the slow variables, as a part of their size, is [[distances]] at the given [[small]], a half "
        "and a quarter of it.",
        values,
    )
    if told.orders:
        yield (
            "It shrinks like the power [[orders]] of [[small]]; [[expected]] is expected where [[small]] is small "
            "enough.",
            values | {"orders": ", ".join(f"{x:.1f}" for x in told.orders), "expected": told.expected},
        )
        if too_slow(told.orders, told.expected):
            yield TOO_SLOW, {}


def of_averaging(told: JudgedAverage, write: Medium) -> Iterator[Said]:
    """The effective potential, what problem 6 says with it, and the error that was measured.

    Of one that the measurement contradicts nothing is said but that.
    """
    one = told.one
    phase = write.names([one.phase])
    if one.found is None:
        yield "Averaging over [[phase]] gives nothing: [[why]].", {"phase": phase, "why": write.word(one.failure)}
        return
    yield (
        "Averaged over the phase [[phase]]. Its rate [[rate]] is taken as of order 1/epsilon, and what is not named "
        "here as of order 1.",
        {"phase": phase, "rate": write.names([one.found.rate])},
    )
    for power in sorted({power for _, power in one.found.orders}):
        names = [name for name, k in one.found.orders if k == power]
        yield (
            "Taken as of the order of the power [[power]] of epsilon: [[names]].",
            {"power": power, "names": write.names(names)},
        )
    if told.withdrawn:
        assert not isinstance(told.measured, str)
        yield WITHDRAWN, {"phase": phase} | _measures(told.measured)
        return
    yield (
        "For times of order 1 the motion stays within order epsilon of one in the effective potential below (averaging "
        "theorem).",
        {},
    )
    yield "What the fast phase adds: [[formula]].", {"formula": write.formula(one.found.vibrational)}
    yield "Effective potential: [[formula]].", {"formula": write.formula(one.found.potential)}
    if one.found.beside:
        yield (
            "Beside it act the forces on [[names]] that have no force function here, as they did.",
            {"names": write.names(one.found.beside)},
        )
    yield from _of_averaged_motion(one, write)
    yield from _of_measured_average(told.measured, write)


def _of_averaged_motion(one: Averaging, write: Medium) -> Iterator[Said]:
    assert one.analysis is not None
    stage = one.analysis.stage(6)
    if stage.value is None:
        yield (
            "Of the stability of the averaged motion there is no result: [[why]].",
            {"why": write.word("" if stage.failure is None else stage.failure.reason)},
        )
        return
    found: Stability = stage.value
    equilibrium = one.analysis.equilibrium
    if equilibrium.conditions:
        told = ", ".join(write.condition(x, "=") for x in equilibrium.conditions)
        yield "The averaged motion is there where [[conditions]].", {"conditions": told}
    for part in found.subsystems:
        verdict = part.theory.verdict
        values: dict[str, object] = {"names": write.names(part.coordinates), "word": write.word(verdict.word.value)}
        yield "The averaged motion, not the motion itself, by problem 6: [[names]]: [[word]].", values
        items = [] if verdict.stable else list(statements(part.ring, part.theory.requirements))
        if verdict.word is Word.DEPENDS and items:
            written = [
                f"{write.condition(x.formula, x.relation)} ({write.word(x.place.value)})"
                for x in items
                if x.formula is not None
            ]
            if written:
                yield (
                    "What problem 6 asks of the parameters: [[conditions]].",
                    {"conditions": ", ".join(written)},
                )
            if len(written) < len(items):
                yield "Further conditions are not written out here.", {}
    if found.numerical is not None:
        yield "At the given values: [[word]].", {"word": write.word(found.numerical.word.value)}


def _of_measured_average(told: MeasuredAverage | str, write: Medium) -> Iterator[Said]:
    if isinstance(told, str):
        yield "The distance to the averaged motion was not measured: [[why]].", {"why": write.word(told)}
        return
    values = _measures(told)
    yield (
        "Measured over a time of [[time]]: the largest distance of the motion from the averaged one, as a part of its "
        "size, is [[distances]] at the given values, and with epsilon a half and a quarter of it.",
        values,
    )
    yield "It shrinks like the power [[orders]] of epsilon; 1 is expected where epsilon is small enough.", values


def _measures(told: MeasuredAverage) -> dict[str, object]:
    return {
        "time": f"{told.time:.4g}",
        "distances": ", ".join(f"{x:.2g}" for x in told.distances),
        "orders": ", ".join(f"{x:.1f}" for x in told.orders),
    }


def of_none(found: SmallParameters, write: Medium) -> Iterator[Said]:
    """What is said where there is nothing to expand in, or no slow manifold was found."""
    if found.nothing:
        yield NOTHING, {}
    elif found.small and found.slow is None:
        yield (
            "No slow manifold was found in powers of [[small]]: [[why]].",
            {"small": write.names([found.small]), "why": write.word(found.no_slow)},
        )


def _told(found: Expansion, conditions: Sequence[Condition], write: Medium) -> str:
    ring = found.transfer.ring
    parts = []
    for one in conditions:
        if one.kind == "inequality":
            parts.append(write.condition(Formula(ring, one.polynomial), ">"))
        elif one.kind == "unwritten":
            parts.append(write.word("a condition too long to be written out"))
        parts += [write.condition(Formula(ring, p), "!=") for p in one.nonzero]
    return ", ".join(dict.fromkeys(parts))
