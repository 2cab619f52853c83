"""What is said of problem 12."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.quotients import Series
from mbsym.algebra.signs import Condition
from mbsym.analysis.expanding import Expansion
from mbsym.analysis.small import Averaging, SmallParameters
from mbsym.expressions.message import worded
from mbsym.expressions.rates import without_velocity
from mbsym.formulas.formula import Formula
from mbsym.problems.small_parameter.result import Choice, Outcome
from mbsym.problems.stability.problem import Stability
from mbsym.problems.stability.words import Word
from mbsym.report.conditions import statements
from mbsym.report.content import Gaps, Inline, Name, Phrase, Raised, Relation, Said, named, say
from mbsym.report.words.expansion_measured import SLACK, JudgedAverage

if TYPE_CHECKING:
    from mbsym.simulation.expanded import Measured

SERIES = (
    "Slow integral manifold up to order [[order]] of [[small]]: the fast variables [[fast]] as functions of the slow "
    "ones [[slow]], and the flow on it. The coefficient of the power $k$ of [[small]] has the index $(k)$."
)
CONSTANTS = (
    "Slow integral manifold up to order [[order]] of [[small]]: the fast variables [[fast]], which depend on no slow "
    "one. The coefficient of the power $k$ of [[small]] has the index $(k)$."
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
    "from the averaged one, as a part of its size, is [[distances]] at the given values, and with $\\epsilon$ a half "
    "and a quarter of it; it changes like the power [[orders]] of $\\epsilon$ instead of 1."
)


def too_slow(orders: Sequence[float], expected: int) -> bool:
    """Whether the last of the measured orders falls short of the expected one."""
    return bool(orders) and orders[-1] < expected - SLACK


@dataclass(frozen=True)
class Coefficient:
    """The coefficient of eps^``order`` in the series of a variable, of its ``rate`` (1), or of that one's (2).

    ``flow``: it is one of the flow on the manifold.
    """

    variable: str
    rate: int
    order: int
    formula: Formula
    flow: bool = False

    @property
    def equation(self) -> Relation:
        return Relation(Raised(Name(self.variable, self.rate), self.order), "=", self.formula)


@dataclass(frozen=True)
class Sums:
    """Functions called ``name``: of every variable in ``series``, by its own name and with its rate in primes,

        x = sum_k small^k parts[k],

    where the ``phase``, if there is one, is the time by the sum that is called after it.
    """

    name: str
    small: str
    series: tuple[tuple[str, tuple[tuple[int, Formula], ...]], ...]
    phase: str = ""


def sum_of_powers(parts: Iterable[tuple[int, str]], small: str, power: str) -> str:
    """Terms written as (coefficient)*small**k."""
    factors = {0: "", 1: f"*{small}"}
    return " + ".join(
        f"({x}){factors.get(k, f'*{small}{power}{k}' if k > 0 else f'*{small}{power}({k})')}" for k, x in parts
    )


def summed(
    name: str, small: str, listed: Iterable[Coefficient], powers: Iterable[tuple[str, int]] = (), phase: str = ""
) -> Sums:
    """The sums of which coefficients are told; a variable x with a power stands for x times that of ``small``."""
    series: dict[str, list[tuple[int, Formula]]] = {}
    shift = {without_velocity(variable): power for variable, power in powers}
    for x in listed:
        parts = series.setdefault(x.variable + "'" * (x.rate if x.variable != phase else 0), [])
        parts.append((x.order + shift.get(x.variable, 0), x.formula))
    return Sums(name, small, tuple((key, tuple(parts)) for key, parts in series.items()), phase)


_FAST = {
    Outcome.HOLDS: "The manifold attracts near this motion for all sufficiently small $[[small]] > 0$ (proved: "
    "Hurwitz's minors of the fast roots, by their first coefficients).",
    Outcome.CONDITIONAL: "The manifold attracts near this motion for all sufficiently small $[[small]] > 0$ where "
    "[[conditions]] (proved: Hurwitz's minors of the fast roots, by their first coefficients).",
    Outcome.FAILS: "The manifold does not attract near this motion for any sufficiently small $[[small]] > 0$ "
    "(proved: a Hurwitz minor of the fast roots is negative).",
    Outcome.UNDECIDED: "Whether the manifold attracts near this motion is undecided: a Hurwitz minor of the fast roots "
    "vanishes to the order of the expansion, or has no sign.",
}
#: Where no root is zero by itself.
_ALL = {
    Outcome.HOLDS: "All roots of the flow on it have negative real parts for all sufficiently small $[[small]] > 0$ "
    "(proved in first approximation).",
    Outcome.CONDITIONAL: "All roots of the flow on it have negative real parts for all sufficiently small "
    "$[[small]] > 0$ where [[conditions]] (proved in first approximation).",
    Outcome.FAILS: "Not all roots of the flow on it have negative real parts for sufficiently small $[[small]] > 0$ "
    "(proved in first approximation).",
}
#: Where some are, by coordinates on which nothing depends.
_SLOW = {
    Outcome.HOLDS: "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all "
    "sufficiently small $[[small]] > 0$ (proved in first approximation).",
    Outcome.CONDITIONAL: "All roots of the flow on it but [[zeros]] that are zero have negative real parts for all "
    "sufficiently small $[[small]] > 0$ where [[conditions]] (proved in first approximation).",
    Outcome.FAILS: "Of the flow on it, not all roots but [[zeros]] that are zero have negative real parts for "
    "sufficiently small $[[small]] > 0$ (proved in first approximation).",
    Outcome.UNDECIDED: "Whether the roots of the flow on it have negative real parts is undecided: a Hurwitz minor "
    "vanishes to the order of the expansion, or has no sign.",
}
#: Of a set of steady states.
_OMEGA = {
    Outcome.HOLDS: "For all sufficiently small $[[small]] > 0$ it is asymptotically stable with respect to [[others]] "
    "near this motion, and stabilizable (Rumyantsev): disturbed motions tend to points of $\\Omega$ "
    "(Lyapunov-Malkin).",
    Outcome.CONDITIONAL: "For all sufficiently small $[[small]] > 0$ it is asymptotically stable with respect to "
    "[[others]] near this motion, and stabilizable (Rumyantsev), where [[conditions]]: disturbed motions tend to "
    "points of $\\Omega$ (Lyapunov-Malkin).",
    Outcome.FAILS: "It is not stable with respect to [[others]] near this motion for any sufficiently small "
    "$[[small]] > 0$: a root has a positive real part.",
    Outcome.UNDECIDED: "Whether it is stable with respect to [[others]] near this motion is undecided.",
}


def coefficients(expansion: Expansion) -> Iterator[Coefficient]:
    """All of the manifold, then all of the flow, but for what only says that the rate of a variable is its rate."""
    manifold = expansion.manifold
    rates = {without_velocity(name) for name in (*manifold.fast, *manifold.slow) if name in expansion.velocities}
    for rate, names, series in ((False, manifold.fast, manifold.functions), (True, manifold.slow, manifold.flow)):
        for name, component in zip(names, series, strict=True):
            if rate and name in rates - {*expansion.velocities}:
                continue
            for k, formula in of_series(expansion, component):
                plain = without_velocity(name) if name in expansion.velocities else name
                yield Coefficient(plain, rate + (plain != name), k, formula, rate)


def of_series(expansion: Expansion, series: Series) -> Iterator[tuple[int, Formula]]:
    """Exponents and coefficients, in order; 0 where there are none."""
    listed = series.coefficients or {0: series.coefficient(0)}
    for k in sorted(listed):
        yield k, expansion.formula(listed[k])


def opening(expansion: Expansion) -> Iterator[Said]:
    """What is expanded in what."""
    manifold = expansion.manifold
    small = Name(manifold.field.small)
    yield from scaled(manifold.field.powers, manifold.field.small)
    fast, slow = (tuple(_variable(expansion, name) for name in names) for names in (manifold.fast, manifold.slow))
    gaps: Gaps = {"order": str(manifold.order), "small": small, "fast": fast}
    yield Said(SERIES, gaps | {"slow": slow}) if slow else Said(CONSTANTS, gaps)


def _variable(expansion: Expansion, name: str) -> Name:
    return Name(without_velocity(name), 1) if name in expansion.velocities else Name(name)


def scaled(powers: Iterable[tuple[str, int]], small: str) -> Iterator[Said]:
    """What stands for its product with a power of the small parameter."""
    for name, power in powers:
        text = "[[name]] is multiplied by the power [[power]] of [[small]]."
        yield say(text, name=Name(name), power=str(power), small=Name(small))


def sentences(expansion: Expansion) -> Iterator[Said]:
    """What was checked, and what is known of the motion on the manifold and towards it."""
    manifold = expansion.manifold
    least = [residual for residual in manifold.residuals if residual is not None]
    values: Gaps = {"small": Name(manifold.field.small), "order": str(manifold.order)}
    if least:
        yield Said(
            "Put into the equations at a random rational state, it leaves terms of order [[left]] (verified).",
            values | {"left": str(min(least))},
        )
    else:
        yield Said("Put into the equations at a random rational state, it leaves nothing (verified).", values)
    yield from _choice(expansion)
    if expansion.real:
        yield say("It is real where [[conditions]].", conditions=_told(expansion, expansion.real))
    if expansion.provided:
        yield say(
            "It holds where these are not zero, which were divided by: [[provided]].", provided=expansion.provided
        )
    if manifold.steady is None:
        yield say("Nothing is said of stability: [[missing]].", missing=worded(expansion.missing))
        return
    values["zeros"] = str(manifold.steady.zeros)
    outcome, conditions = expansion.fast
    yield Said(_FAST[outcome], values | {"conditions": _told(expansion, conditions)})
    if len(manifold.steady.slow.polynomial) > 1:
        outcome, conditions = expansion.slow
        wording = _SLOW if manifold.steady.zeros else _SLOW | _ALL
        yield Said(wording[outcome], values | {"conditions": _told(expansion, conditions)})
    elif manifold.steady.free:
        yield Said("All roots of the flow on it are zero.")
    elif manifold.steady.zeros:
        yield Said("All roots of the flow on it are zero: the first approximation decides nothing there.")
    yield Said(
        "The characteristic polynomial of all variables is divided by that of the flow without a remainder up to order "
        "[[known]] (verified).",
        values | {"known": str(manifold.steady.remainder - 1)},
    )
    yield from _of_set(expansion, manifold.steady.free, values)
    if (
        expansion.fast[0] is Outcome.FAILS
    ):  # a negative minor: a root to the right, whatever the flow on the manifold does
        yield Said(
            "A fast root has a positive real part: this motion is unstable for all sufficiently small $[[small]] > 0$.",
            values,
        )
        return
    yield Said(
        "By the reduction principle (Strygin and Sobolev) a steady state on an attracting slow manifold is stable, "
        "asymptotically stable or unstable as it is in the flow on it. How small [[small]] has to be is not known "
        "from this: at given values problem 6 decides.",
        values,
    )


#: Of several solutions of the lowest order.
_CHOICE = {
    Choice.ON_MOTION: "This one holds the unperturbed motion.",
    Choice.ATTRACTING: "This one attracts for all sufficiently small $[[small]] > 0$ (proved: the derivative of the "
    "fast rate by [[fast]] is negative there).",
    Choice.FIRST: "This is the first; which of them attract is not decided.",
}


def _choice(expansion: Expansion) -> Iterator[Said]:
    """Which solution of the lowest order this one begins with, and the others."""
    if expansion.choice is Choice.ONLY:
        return
    fast = tuple(_variable(expansion, name) for name in expansion.manifold.fast)
    text = "At the lowest order the fast variables have solutions; their number: [[count]]."
    yield say(text, count=str(1 + len(expansion.others)))
    attracting = expansion.choice is Choice.ATTRACTING
    gaps: Gaps = {"small": Name(expansion.manifold.field.small), "fast": fast} if attracting else {}
    yield Said(_CHOICE[expansion.choice], gaps)
    for values in expansion.others:
        shown = tuple(Relation(Raised(name, 0), "=", value) for name, value in zip(fast, values, strict=True))
        yield say("Another one begins with [[values]].", values=shown)
    if expansion.unknown:
        text = "Solutions that need other roots, real or not, are not expanded; their number: [[count]]."
        yield say(text, count=str(expansion.unknown))


def _of_set(expansion: Expansion, free: Sequence[str], values: Gaps) -> Iterator[Said]:
    """The set of steady states, in the words of Rumyantsev."""
    known = {*expansion.manifold.fast, *expansion.manifold.slow}
    order = [name for name in expansion.transfer.variables if name in known]
    others = [name for name in order if name not in free]
    if not (free and others):
        return
    outcome, conditions = expansion.stabilizable
    values = values | {
        "free": tuple(_variable(expansion, name) for name in free),
        "others": tuple(_variable(expansion, name) for name in others),
        "conditions": _told(expansion, conditions),
    }
    yield Said(
        "Every state near this motion with any [[free]], and with [[others]] as on the motion, is steady: a set "
        "$\\Omega$ of as many dimensions as roots are zero.",
        values,
    )
    yield Said(_OMEGA[outcome], values)


def of_measured(small: str, measurement: Measured | str) -> Iterator[Said]:
    """The error of the flow against all equations."""
    if isinstance(measurement, str):
        yield say("The error of the flow was not measured: [[why]].", why=worded(measurement))
        return
    values: Gaps = {"small": Name(small), "time": f"{measurement.time:.4g}"}
    values["distances"] = ", ".join(f"{x:.2g}" for x in measurement.distances)
    if measurement.exact:
        yield Said(
            "Measured against a simulation of all equations over a time of [[time]]: the distance of the slow "
            "variables is no larger than the errors of the integrations.",
            values,
        )
        return
    yield Said(
        "Measured against a simulation of all equations over a time of [[time]], both from the manifold: the largest "
        "distance of the slow variables, as a part of their size, is [[distances]] at the given [[small]], a half "
        "and a quarter of it.",
        values,
    )
    if measurement.orders:
        yield Said(
            "It shrinks like the power [[orders]] of [[small]]; [[expected]] is expected where [[small]] is small "
            "enough.",
            values
            | {"orders": ", ".join(f"{x:.1f}" for x in measurement.orders), "expected": str(measurement.expected)},
        )
        if too_slow(measurement.orders, measurement.expected):
            yield Said(TOO_SLOW)


def of_averaging(average: JudgedAverage) -> Iterator[Said]:
    """The effective potential, what problem 6 says with it, and the error that was measured.

    Of one that the measurement contradicts nothing is said but that.
    """
    averaging = average.averaging
    phase = named(averaging.phases)
    if averaging.averaged is None:
        yield say("Averaging over [[phase]] gives nothing: [[why]].", phase=phase, why=worded(averaging.failure))
        return
    yield say(
        "Averaged over the phase [[phase]]. Its rate [[rate]] is taken as of order $1/\\epsilon$, and what is not "
        "named here as of order 1."
        if len(averaging.phases) == 1
        else "Averaged over the phases [[phase]]. Their rates [[rate]] are taken as of order $1/\\epsilon$, and what "
        "is not named here as of order 1.",
        phase=phase,
        rate=named(averaging.averaged.rates),
    )
    if averaging.averaged.apart:
        yield say("Taken as of order $1/\\epsilon$, too, as phases meet: [[rates]].", rates=averaging.averaged.apart)
    for power in sorted({power for _, power in averaging.averaged.orders}):
        names = [name for name, k in averaging.averaged.orders if k == power]
        yield say(
            "Taken as of the order of the power [[power]] of $\\epsilon$: [[names]].",
            power=str(power),
            names=named(names),
        )
    if average.withdrawn:
        assert not isinstance(average.measured, str)
        yield say(WITHDRAWN, phase=phase, **_measures(average.measured))
        return
    yield Said(
        "For times of order 1 the motion stays within order $\\epsilon$ of one in the effective potential below "
        "(averaging theorem)."
    )
    yield say(
        "What the fast phase adds: [[formula]]."
        if len(averaging.phases) == 1
        else "What the fast phases add: [[formula]].",
        formula=averaging.averaged.vibrational,
    )
    yield say("Effective potential: [[formula]].", formula=averaging.averaged.potential)
    if averaging.averaged.beside:
        yield say(
            "Beside it act the forces on [[names]] that have no force function here, as they did.",
            names=named(averaging.averaged.beside),
        )
    yield from _of_averaged_motion(averaging)
    yield from _of_measured_average(average.measured)


def _of_averaged_motion(averaging: Averaging) -> Iterator[Said]:
    assert averaging.analysis is not None
    stage = averaging.analysis.stage(6)
    if stage.value is None:
        assert stage.failure is not None
        hint = (" (", worded(stage.failure.hint), ")") if stage.failure.hint else ()
        why = Phrase((worded(stage.failure.reason), *hint))
        yield say("Of the stability of the averaged motion there is no result: [[why]].", why=why)
        return
    stability: Stability = stage.value
    equilibrium = averaging.analysis.equilibrium
    if equilibrium.conditions:
        relations = tuple(Relation(x, "=", 0) for x in equilibrium.conditions)
        yield say("The averaged motion is there where [[conditions]].", conditions=relations)
    for part in stability.subsystems:
        verdict = part.theory.verdict
        text = "The averaged motion, not the motion itself, by problem 6: [[names]]: [[word]]."
        yield say(text, names=named(part.coordinates), word=worded(verdict.word.value))
        items = [] if verdict.stable else list(statements(part.ring, part.theory.requirements))
        if verdict.word is Word.DEPENDS and items:
            written = [
                Phrase((Relation(x.formula, x.relation, 0), " (", worded(x.place.value), ")"))
                for x in items
                if x.formula is not None
            ]
            if written:
                yield say("What problem 6 asks of the parameters: [[conditions]].", conditions=written)
            if len(written) < len(items):
                yield Said("Further conditions are not written out here.")
    if stability.numerical is not None:
        yield say("At the given values: [[word]].", word=worded(stability.numerical.word.value))


def _of_measured_average(measurement: Measured | str) -> Iterator[Said]:
    if isinstance(measurement, str):
        yield say("The distance to the averaged motion was not measured: [[why]].", why=worded(measurement))
        return
    values: Gaps = {**_measures(measurement)}
    yield Said(
        "Measured over a time of [[time]]: the largest distance of the motion from the averaged one, as a part of its "
        "size, is [[distances]] at the given values, and with $\\epsilon$ a half and a quarter of it.",
        values,
    )
    yield Said(
        "It shrinks like the power [[orders]] of $\\epsilon$; 1 is expected where $\\epsilon$ is small enough.", values
    )


def _measures(measurement: Measured) -> dict[str, str]:
    return {
        "time": f"{measurement.time:.4g}",
        "distances": ", ".join(f"{x:.2g}" for x in measurement.distances),
        "orders": ", ".join(f"{x:.1f}" for x in measurement.orders),
    }


def of_none(small_parameters: SmallParameters) -> Iterator[Said]:
    """What is said where there is nothing to expand in, or no slow manifold was found."""
    if small_parameters.nothing:
        yield Said(NOTHING)
    elif small_parameters.small and small_parameters.slow is None:
        yield say(
            "No slow manifold was found in powers of [[small]]: [[why]].",
            small=Name(small_parameters.small),
            why=worded(small_parameters.no_slow),
        )


def _told(expansion: Expansion, conditions: Sequence[Condition]) -> tuple[Inline, ...]:
    ring = expansion.transfer.ring
    parts: dict[str, Inline] = {}  # each once
    for condition in conditions:
        if condition.kind == "inequality":
            parts[f"{condition.polynomial} > 0"] = Relation(Formula(ring, condition.polynomial), ">", 0)
        elif condition.kind == "unwritten":
            parts[""] = worded("a condition too long to be written out")
        parts |= {f"{p} != 0": Relation(Formula(ring, p), "!=", 0) for p in condition.nonzero}
    return tuple(parts.values())
