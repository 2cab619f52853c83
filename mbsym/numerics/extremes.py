"""A model at its extremes: how many digits each quantity keeps, where it breaks down, and why.

Ladders of states and parameters (``probes``, ``borders``) times quantities (``digits``): every rung is evaluated by the
compiled kernels in float32 and float64 and by rigorous balls, with the condition of the question beside it.  What is
said in sentences follows from the rows and from nothing else.
"""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import isfinite

from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Program
from mbsym.algebra.ring import Ring
from mbsym.analysis import Analysis
from mbsym.expressions.tree import Expression
from mbsym.mechanics.falling import falling_frames
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System
from mbsym.numerics.borders import BORDER, Judged, LinearModel
from mbsym.numerics.digits import FEW, FULL, Arithmetic, Digits, Quantity, Truth, Watch, measured, quantities
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64, Code
from mbsym.numerics.probes import EQUILIBRIUM, RATES, RATIO, SINGULAR, Ladder, Probe, ladders
from mbsym.numerics.scenario import Scenario

#: Sums are called good where float64 keeps at least so many digits.
GOOD = 10.0

#: A quantity is left out where its program is longer than this, linear matrices where they have more terms.
MOST_OPERATIONS = 20_000

#: Steps of polynomial arithmetic that a second of the budget allows the linear equations; a second holds two to four
#: times as many.  Counted steps make the same thing come out on every machine.
STEPS_PER_SECOND = 1_000_000

#: Programs with more operations than this for a second of the budget are not compiled but taken step by step.
COMPILED_PER_SECOND = 1_000

#: So many names are listed where time was short.
LISTED = 8


@dataclass(frozen=True)
class Row:
    """One quantity on one rung."""

    kind: str
    subject: str
    size: float
    quantity: str
    found: Digits


@dataclass(frozen=True)
class VerdictRow:
    """The verdict on one rung, exact and by floats."""

    kind: str
    subject: str
    size: float
    judged: Judged


@dataclass(frozen=True)
class Extremes:
    """All rows in the order measured; ``left_out`` says what was not, and why.

    ``falling`` is there where a frame falls in a Newtonian field.
    """

    system: System
    rows: tuple[Row, ...]
    verdicts: tuple[VerdictRow, ...]
    left_out: tuple[str, ...]
    seconds: float
    falling: Falling | None = None

    @property
    def ladders(self) -> tuple[tuple[str, str], ...]:
        """(kind, subject) of every ladder."""
        measured_ = [(row.kind, row.subject) for row in self.rows]
        return tuple(dict.fromkeys([*measured_, *((row.kind, row.subject) for row in self.verdicts)]))

    @property
    def quantities(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row.quantity for row in self.rows))

    def of(self, kind: str, subject: str, quantity: str) -> tuple[Row, ...]:
        """One quantity along one ladder, in the order of the rungs."""
        return tuple(r for r in self.rows if (r.kind, r.subject, r.quantity) == (kind, subject, quantity))


def extremes(
    given: Scenario,
    ring: Ring,
    overrides: dict[str, Expression],
    budget: float = 60.0,
    watch: Watch = lambda text: None,
) -> Extremes:
    """Everything that applies to a scenario, in about ``budget`` seconds.

    Raises NoClosedForm or SingularPoint where the equations have no program at all.
    """
    started = time.perf_counter()
    left_out: list[str] = []
    watch("programs")
    found = _quantities(given.system, ring, left_out)
    truth = Truth(given.system, found)
    watch("linear equations")
    linear = _linear(given, budget, left_out)
    watch("kernels")
    compiled = sum(q.code.operations for q in found) <= COMPILED_PER_SECOND * budget
    rungs = _Rungs(given, Arithmetic(given, found, compiled), truth, linear, started + budget)
    late = []
    for ladder in _all(given, overrides, truth, found, linear):
        watch(ladder.title)
        if not rungs.climb(ladder):
            late.append(ladder.title)
    if late:
        shown = late if len(late) <= LISTED + 1 else [*late[:LISTED], f"and {len(late) - LISTED} more"]
        left_out.append(f"out of time, raise --budget: {', '.join(shown)}")
    joined = falling(given, ring, found, truth)
    seconds = time.perf_counter() - started
    return Extremes(given.system, tuple(rungs.rows), tuple(rungs.verdicts), tuple(left_out), seconds, joined)


class _Rungs:
    """Takes measurements, one rung after another, until the clock shows ``end``."""

    def __init__(
        self, given: Scenario, usual: Arithmetic, truth: Truth, linear: LinearModel | None, end: float
    ) -> None:
        self.given, self.usual, self.truth, self.linear, self.end = given, usual, truth, linear, end
        self.found = usual.found
        self.lean = tuple(q for q in self.found if q.name != "Jacobian")
        self.rows: list[Row] = []
        self.verdicts: list[VerdictRow] = []

    @property
    def late(self) -> bool:
        return time.perf_counter() > self.end

    def climb(self, ladder: Ladder) -> bool:
        """Whether there was time for every rung."""
        for probe in ladder.probes:
            if self.late:
                return False
            if ladder.kind != BORDER:
                self._state(ladder, probe)
            if self.linear is not None and ladder.kind in (BORDER, RATIO):
                self._linear(ladder, probe, self.linear)
        return True

    def _state(self, ladder: Ladder, probe: Probe) -> None:
        usual = probe.scenario is self.given
        try:
            arithmetic = self.usual if usual else Arithmetic(probe.scenario, self.lean, compiled=False)
        except Failure:  # a division by zero in the parameters alone: nothing to evaluate
            return
        for q in self.found if usual else self.lean:
            digits = measured(self.truth, arithmetic, q.name, probe.scenario, probe.state)
            self.rows.append(Row(ladder.kind, ladder.subject, probe.size, q.name, digits))

    def _linear(self, ladder: Ladder, probe: Probe, linear: LinearModel) -> None:
        place = (ladder.kind, ladder.subject, probe.size)
        self.rows += [Row(*place, name, digits) for name, digits in linear.digits(probe.scenario).items()]
        if probe.assumed:
            self.verdicts.append(VerdictRow(*place, linear.judged(probe.scenario)))


def _all(
    given: Scenario,
    overrides: dict[str, Expression],
    truth: Truth,
    found: Sequence[Quantity],
    linear: LinearModel | None,
) -> Iterator[Ladder]:
    """Ladders that need no new kernels come first."""
    bordering = linear is not None
    for ladder in ladders(given, overrides, truth, found):
        if bordering and linear is not None and ladder.kind == RATIO:
            yield from linear.borders(given, overrides)
            bordering = False
        yield ladder


def _quantities(system: System, ring: Ring, left_out: list[str]) -> tuple[Quantity, ...]:
    found = quantities(system, ring)
    kept = tuple(q for q in found if q.code.operations <= MOST_OPERATIONS)
    left_out += [f"{q.name}: {q.code.operations} operations are too many here" for q in found if q not in kept]
    return kept


def _linear(given: Scenario, budget: float, left_out: list[str]) -> LinearModel | None:
    analysis = Analysis(given.system)
    analysis.ring.limit_work(int(budget * STEPS_PER_SECOND))
    what = "linear equations, eigenvalues and verdicts"
    try:
        terms = sum(len(x) for matrix in analysis.linearisation.matrices for row in matrix.polynomials for x in row)
        if terms > MOST_OPERATIONS:
            left_out.append(f"{what}: {terms} terms are too many here")
            return None
        return LinearModel(analysis)
    except Failure as reason:
        left_out.append(f"{what}: {reason.reason}")
        return None


# --- frames that fall ---


@dataclass(frozen=True)
class Falling:
    """Digits of the forcing in float64, the bodies at rest in the given positions and the frames some way along.

    ``apart``: with gravity and the acceleration of the ``frames`` taken separately; ``joined``: as it is done here.
    """

    frames: tuple[str, ...]
    apart: float
    joined: float


def falling(given: Scenario, ring: Ring, found: Sequence[Quantity], truth: Truth) -> Falling | None:
    """None where no frame falls, or the forcing has no tight enclosure."""
    frames = tuple(falling_frames(given.system))
    usual = next((q for q in found if q.name == "forcing"), None)
    if not frames or usual is None:
        return None
    program = Program()
    scene = scene_without_accelerations(given.system, ring, program, program_environment(given.system, program))
    nodes = tuple(-x for x in residuals(scene).values())
    apart = Quantity("forcing", Code(program, usual.code.inputs, nodes))
    rates = [rate for _, rate in given.prescribed.values() if rate]
    time_ = 1 / rates[0] if rates else Fraction(1)
    state = (*given.positions, *(Fraction(0) for _ in given.velocities))
    digits = [
        measured(truth, Arithmetic(given, [q], compiled=False), "forcing", given, state, time_) for q in (apart, usual)
    ]
    if not digits[0].bits:
        return None
    return Falling(frames, digits[0].formula, digits[1].formula)


# --- what follows ---


def sentences(found: Extremes) -> Iterator[str]:
    """Where the model breaks down, in plain words; each follows from the rows."""
    if found.falling is not None:
        yield (
            f"Gravity and the acceleration of {', '.join(found.falling.frames)} are joined before numbers are put in: "
            f"with the bodies at rest float64 keeps {found.falling.joined:.1f} digits of the forcing, "
            f"where term by term it would keep {found.falling.apart:.1f}."
        )
    for kind, subject in found.ladders:
        if kind == SINGULAR:
            yield from _singular(found, subject)
    yield from _range(found, RATES, "Rates")
    yield from _range(found, EQUILIBRIUM, "States at distances from the unperturbed motion")
    yield from _ratios(found)
    yield from _verdicts(found)
    yield from _formulas(found)


def _onward(sizes: Iterable[float], bad: Iterable[float]) -> str:
    """``from 1e-05 on`` where everything nearer is bad as well, else the places one by one."""
    places = sorted(set(bad), reverse=True)
    if {size for size in sizes if size <= places[0]} == set(places):
        return f"from {places[0]:.0e} on"
    return "at " + ", ".join(f"{place:.0e}" for place in places)


def _short(size: float) -> str:
    """``1e-8``, ``1e8``."""
    return f"{size:.0e}".replace("e-0", "e-").replace("e+0", "e").replace("e+", "e")


def _singular(found: Extremes, subject: str) -> Iterator[str]:
    parts = []
    for quantity in ("accelerations", "Jacobian"):
        rows = [r for r in found.of(SINGULAR, subject, quantity) if r.found.bits]
        for scalar in FULL:
            lost = [r.size for r in rows if r.found.digits[scalar] < FEW]
            if lost:
                where = _onward((r.size for r in rows), lost)
                parts.append(f"{scalar} keeps fewer than {FEW:.0f} digits of the {quantity} {where}")
    known = [r for r in found.of(SINGULAR, subject, "accelerations") if r.found.bits]
    if not parts and known:
        least = min(r.found.digits[FLOAT64] for r in known)
        nearest = min(r.size for r in known)
        parts = [f"float64 keeps at least {least:.1f} digits of the accelerations down to {nearest:.0e}"]
    yield f"{subject}: the mass matrix is singular" + "".join(f"; {part}" for part in parts) + "."
    avoidable = [r for r in known if r.found.verdict == "formula"]
    if avoidable:
        r = max(avoidable, key=lambda row: row.size)
        where = _onward((row.size for row in known), (row.size for row in avoidable))
        yield (
            f"{subject}: {where} more digits of the accelerations are lost than the question makes "
            f"unavoidable (condition {r.found.condition:.0e} and {r.found.formula:.1f} digits at the state as rounded, "
            f"at {r.size:.0e}); other coordinates may keep them (--sequences tries other angles)."
        )


def _range(found: Extremes, kind: str, title: str) -> Iterator[str]:
    rows = [r for r in found.rows if r.kind == kind and r.found.bits]
    if not rows:
        return
    least = min(rows, key=lambda r: r.found.digits[FLOAT64])
    single = min(rows, key=lambda r: r.found.digits[FLOAT32])
    sizes = [r.size for r in rows]
    worst = f"{least.found.digits[FLOAT64]:.1f} digits (worst: {least.quantity} at {least.size:.0e})"
    coarse = f"{single.found.digits[FLOAT32]:.1f} ({single.quantity} at {single.size:.0e})"
    places = f"{title} from {_short(min(sizes))} to {_short(max(sizes))}"
    yield f"{places}: float64 keeps at least {worst}, float32 {coarse}."


def _ratios(found: Extremes) -> Iterator[str]:
    rows = [r for r in found.rows if r.kind == RATIO and r.found.bits]
    poor: dict[str, list[Row]] = {}
    fine: dict[tuple[float, ...], dict[str, float]] = {}
    for row in rows:
        if row.found.digits[FLOAT64] < GOOD:
            poor.setdefault(row.subject, []).append(row)
    for subject in dict.fromkeys(row.subject for row in rows):
        own = [row for row in rows if row.subject == subject]
        if subject not in poor:
            factors = tuple(sorted({row.size for row in own}))
            fine.setdefault(factors, {})[subject] = min(row.found.digits[FLOAT64] for row in own)
    for factors, subjects in fine.items():
        listed = ", ".join(f"{factor:.0e}" for factor in factors)
        yield (
            f"{', '.join(subjects)} times {listed}: float64 keeps at least {min(subjects.values()):.1f} digits of "
            "everything that was measured."
        )
    for subject, lost in poor.items():
        worst = min(lost, key=lambda r: r.found.digits[FLOAT64])
        names = ", ".join(dict.fromkeys(r.quantity for r in lost))
        why = "the formula" if worst.found.verdict == "formula" else "the question itself"
        yield (
            f"{subject} times {worst.size:.0e}: {worst.found.digits[FLOAT64]:.1f} digits of the {worst.quantity} are "
            f"left in float64, lost by {why} (condition {worst.found.condition:.0e}); below {GOOD:.0f} digits: {names}."
        )


def _verdicts(found: Extremes) -> Iterator[str]:
    borders = [row for row in found.verdicts if row.kind == BORDER]
    subjects = dict.fromkeys(row.subject.rsplit(" from ", 1)[0] for row in borders)
    for subject in subjects:
        own = [row for row in borders if row.subject.startswith(subject + " from ")]
        sides = [[row for row in own if row.subject.endswith(f" from {side}")] for side in ("below", "above")]
        below, above = (_side(rows) for rows in sides)
        text = f"{subject}: a border of the first approximation, {below} below and {above} above"
        if all(len({row.judged.exact.word for row in rows}) == 1 for rows in sides):
            text += (
                f", decided exactly down to a distance of {max(min(row.size for row in rows) for rows in sides):.0e}"
            )
        for scalar in FULL:
            wrong = [row.size for row in own if row.judged.wrong(scalar)]
            if wrong:
                text += f"; {scalar} eigenvalues say otherwise {_onward((row.size for row in own), wrong)}"
        yield text + "."
    others = [row for row in found.verdicts if row.kind == RATIO]
    misjudged = [row for row in others if row.judged.wrong(FLOAT64)]
    if misjudged:
        listed = ", ".join(f"{row.subject} times {row.size:.0e}" for row in misjudged[:LISTED])
        more = f" and {len(misjudged) - LISTED} more" if len(misjudged) > LISTED else ""
        yield f"float64 eigenvalues contradict the exact verdict for {listed}{more}."


def _side(rows: Sequence[VerdictRow]) -> str:
    """The verdict on one side of a border; where it varies, all of it."""
    if not rows:
        return "not looked at"
    words = dict.fromkeys(row.judged.exact.word for row in rows)
    if len(words) == 1:
        return str(rows[0].judged.exact.word)
    parts = []
    for word in words:
        places = [row.size for row in rows if row.judged.exact.word == word]
        parts.append(f"{word} {_onward((row.size for row in rows), places)}")
    return " and ".join(parts)


def _formulas(found: Extremes) -> Iterator[str]:
    rows = [
        r for r in found.rows if r.found.verdict == "formula" and r.kind != SINGULAR and isfinite(r.found.condition)
    ]
    if rows:
        listed = dict.fromkeys(f"{r.quantity} ({r.subject})" for r in rows)
        yield f"More is lost than the condition explains, so another formula could keep it: {', '.join(listed)}."
    open_ = dict.fromkeys(f"{r.quantity} ({r.subject} {r.size:.0e})" for r in found.rows if not r.found.bits)
    if open_:
        undecided = f"Undecided, no tight enclosure within 2048 bits: {', '.join(list(open_)[:LISTED])}"
        yield undecided + (f" and {len(open_) - LISTED} more." if len(open_) > LISTED else ".")
