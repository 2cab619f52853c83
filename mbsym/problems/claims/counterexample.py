"""Numbers at which a claim fails: found at random, then decided exactly or by rigorous balls.

Parameters are rational numbers of the declared signs that keep the relations and the assumptions, and with which the
masses and inertias are those of bodies.  For a first integral

    dI/dt = sum (dI/dq q' + dI/dq' q'') + (dI/dt at fixed q, q'),    q'' = M^-1 f,

is enclosed at a state, in a ball that does not contain zero.  A condition is compared with the verdict of problem 6 at
the same parameters, which is exact.  The search is the same on every run.

Source: admissible inertias as in ``mbsym.model.admissibility``.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import count, islice
from typing import Any

from flint import arb, ctx, fmpq, fmpq_mat, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.base import Algebra, Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, SingularPoint
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression, is_number, names, text
from mbsym.formulas.formula import Matrix
from mbsym.mechanics.oracle import State
from mbsym.mechanics.programs import Programs, accelerated
from mbsym.mechanics.states import SEED
from mbsym.model.admissibility import ROUNDING, body_violation
from mbsym.model.assumptions import has_sign, holds
from mbsym.model.system import Body, System, rational, velocity_name
from mbsym.problems.stability.exact import is_positive
from mbsym.problems.stability.verdict import Flaw, Verdict
from mbsym.problems.stability.words import Word, with_theorem

#: Parameters, and states, that are tried.
SAMPLES, STATES = 400, 40
#: Verdicts of problem 6 that are asked for, at those parameters where they could refute a condition; of so many of them
#: that leave it open the nonlinear system is looked at.
VERDICTS, LOOKED_INTO = 100, 10
#: Parameters that a border is solved for, and points on it for each.
SOLVED_FOR, BORDER_POINTS = 3, 6
#: What the comparison of one inequality with numbers, and a look at the nonlinear system, count for in the measure of
#: the ring's work.
WORK_OF_A_TRIAL, WORK_OF_A_LOOK = 500, 20_000
#: Working precision of balls, in bits; a value is shown to so many digits.
PRECISION, DIGITS_SHOWN = 256, 12

#: left - right of a claimed inequality, its value, and the relation of that to zero.
Gap = tuple[Expression, Any, str]

#: Of what a verdict is shown.
THE_MOTION = "the motion"


@dataclass(frozen=True)
class Counterexample:
    """``at`` holds exact numbers by name, ``shows`` what is found there: (what, value), first left - right of claims
    (``differences``).

    ``word`` is the verdict there, where it is asked for; ``at_equality``: both sides of the condition that was claimed
    are equal there; ``at_border``: so is a condition of problem 6.
    """

    at: tuple[tuple[str, str], ...]
    shows: tuple[tuple[str, str], ...]
    word: Word | None = None
    at_equality: bool = False
    at_border: bool = False
    differences: tuple[Expression, ...] = ()


# --- parameters ---


def parameter_samples(system: System, solved: Sequence[str] = ()) -> Iterator[dict[str, Fraction]]:
    """Values for the parameters that are free: those that were given first, then numbers near them, and any numbers.

    Parameters on the left of a relation, and ``solved`` ones, are left out: they follow.
    """
    source = random.Random(SEED)
    dependent = {relation.name for relation in system.relations} | set(solved)
    free = [parameter for parameter in system.parameters if parameter.name not in dependent]
    for number in range(SAMPLES):
        values = {}
        for parameter in free:
            stated = rational(parameter.value)
            value = Fraction(source.randint(1, 12), source.choice((1, 1, 2, 3, 4)))
            if stated is not None and (number == 0 or (stated and number % 2 == 0)):
                values[parameter.name] = stated if number == 0 else stated * Fraction(source.randint(10, 40), 20)
            else:
                flipped = parameter.sign in ("negative", "nonpositive")
                either = parameter.sign not in ("positive", "nonnegative") and source.randrange(3) == 0
                values[parameter.name] = -value if flipped or either else value
        yield values


def completed(
    system: System,
    numbers: Algebra,
    free: Mapping[str, Fraction],
    further: Callable[[Mapping[str, Any]], Mapping[str, Any]] | None = None,
) -> dict[str, Any]:
    """Values of all parameters and of the description's own symbols, in ``numbers``; ``further`` are solved ones.

    Raises SingularPoint where an assumption or a declared sign does not hold or no body has such an inertia,
    NotRational where a relation gives an irrational number to an algebra of rational ones, and KeyError where a
    number is missing (an exact one for pi, say).
    """
    values: dict[str, Any] = {"pi": arb.pi()} if isinstance(numbers, Balls) else {}
    values |= {name: numbers.number(value) for name, value in free.items()}
    follow(system, numbers, values)
    if further is not None:
        values |= further(values)
        follow(system, numbers, values)
    for parameter in system.parameters:
        if not has_sign(values[parameter.name], parameter.sign):
            raise SingularPoint("a declared sign does not hold")
    for symbol in system.notation:
        values[symbol.name] = Lowering(numbers, values)(symbol.value)
    lower = Lowering(numbers, values)
    for assumption in system.assumptions:
        if not holds(lower(assumption.left) - lower(assumption.right), assumption.relation):
            raise SingularPoint("an assumption does not hold")
    exact = {name: rationals.fraction(x) for name, x in values.items() if isinstance(x, fmpq)} | dict(free)
    if not all(_is_body(body, exact) for body in system.bodies):
        raise SingularPoint("no body has this inertia")
    return values


def follow(system: System, numbers: Algebra, values: dict[str, Any]) -> None:
    """Adds what the relations give, as far as what they need is there."""
    waiting = [item for item in system.relations if item.name not in values]
    while ready := [item for item in waiting if names(item.value) <= values.keys()]:
        for item in ready:
            values[item.name] = Lowering(numbers, values)(item.value)
        waiting = [item for item in waiting if item.name not in values]


def _is_body(body: Body, values: Mapping[str, Fraction]) -> bool:
    """False where the numbers exclude it; tensors of which some moments were left out as 0 are not looked at."""
    if body.inertia is None or any(is_number(body.inertia.tensor[k][k], 0) for k in range(3)):
        return True
    return body.inertia.accepted or body_violation(body, values, ROUNDING) is None


# --- conditions ---


@dataclass
class Trial:
    """Exact parameter ``values`` (notation included), and the verdict there once it is asked for.

    ``special``: the given values, or a border; there an open verdict is looked into first.  ``looked``: it was.
    """

    values: Mapping[str, Any]
    special: bool = False
    verdict: Verdict | None = None
    looked: bool = False


@dataclass(frozen=True)
class Tried:
    """Parameters that refute, if some were ``counterexample``, and at how many they were looked for (``points``)."""

    counterexample: Counterexample | None
    points: int


#: Verdicts of what is stable in first approximation, and left open beyond.
IN_FIRST = (Word.GYROSCOPIC, Word.CRITICAL)

Judge = Callable[[Mapping[str, Fraction]], Verdict]


class Trials:
    """Parameters at which claimed conditions are tried: made once for all claims of a description.

    At each the mass matrix of the first approximation is positive definite, rows of first order apart.  The first are
    those that the description gives.  ``verdict_at`` is the exact verdict of the first approximation, ``decided_at``
    what the nonlinear system adds where that leaves it open, ``verdict_where_zero`` that wherever a polynomial in
    parameters vanishes; ``solved`` are the parameters that follow from the
    conditions of problem 4.
    """

    def __init__(
        self,
        system: System,
        ring: Ring,
        mass_matrix: Matrix,
        solved: Mapping[str, Polynomial],
        verdict_at: Judge,
        decided_at: Callable[[Verdict, Mapping[str, Fraction]], Verdict],
        verdict_where_zero: Callable[[Polynomial], Verdict | None] = lambda _: None,
    ) -> None:
        self.system, self.ring, self.solved = system, ring, solved
        self.numbers = Rationals({}, {})
        self.verdict_where_zero = verdict_where_zero
        self._known: dict[str, Tried] = {}
        self._dependent = {relation.name for relation in system.relations} | set(solved)
        self._mass_matrix, self._verdict_at, self._decided_at = mass_matrix, verdict_at, decided_at
        self._made: list[Trial] = []
        self._coming = self._trials()

    def __iter__(self) -> Iterator[Trial]:
        for k in count():
            if k == len(self._made):
                more = next(self._coming, None)
                if more is None:
                    return
                self._made.append(more)
            yield self._made[k]

    @property
    def given(self) -> Trial | None:
        """The values of the description; where it gives none of a parameter, any."""
        first = next(iter(self), None)
        return first if first is not None and first.special else None

    def verdict(self, trial: Trial) -> Verdict:
        """The verdict of the first approximation there, or of the nonlinear system if it was looked at."""
        if trial.verdict is None:
            trial.verdict = self._verdict_at(self._parameters(trial))
        return trial.verdict

    def looked_into(self, trial: Trial) -> Verdict:
        """The same after a look at the nonlinear system, where that may decide more."""
        verdict = self.verdict(trial)
        if (verdict.word.open or verdict.word is Word.STABLE) and not trial.looked:
            self.ring.spend(WORK_OF_A_LOOK)
            trial.verdict, trial.looked = self._decided_at(verdict, self._parameters(trial)), True
        return self.verdict(trial)

    def _parameters(self, trial: Trial) -> dict[str, Fraction]:
        parameters = {name: trial.values[name] for name in self.system.parameter_names}
        return {name: rationals.fraction(x) for name, x in parameters.items()}

    def counterexample(
        self,
        claimed: Callable[[Algebra, Mapping[str, Any]], Sequence[Gap]],
        sufficient: bool,
        words: Sequence[str],
        among: Iterable[Trial],
        on_border: Callable[[Mapping[str, Any]], bool],
    ) -> Tried:
        """Parameters at which the claim is contradicted and the verdict is one of ``words``, the first if possible.

        ``claimed`` gives (left - right, its value, relation) of every inequality.  A necessary condition is
        contradicted where one of them fails, sufficient ones where all hold.  Of what contradicts, points are preferred
        that are not ``on_border`` of a condition of problem 6, then those at which no two sides are equal.
        """
        judged, looked, best = 0, 0, None
        for trial in among:
            if judged == VERDICTS:
                break
            try:
                gaps = claimed(self.numbers, trial.values)
            except KeyError:  # a name without a value, here and everywhere: sines of constant angles and the like
                break
            except NOT_THERE:
                continue
            self.ring.spend(WORK_OF_A_TRIAL * len(gaps))
            if all(holds(gap, relation) for _, gap, relation in gaps) is not sufficient:
                continue
            judged += 1
            verdict = self.verdict(trial)
            if verdict.word.open and looked < LOOKED_INTO and (trial.special or verdict.counted not in words):
                looked += 1
                verdict = self.looked_into(trial)
            if verdict.counted not in words:
                continue
            equal = any(gap == 0 for _, gap, _ in gaps)
            border = equal and on_border(trial.values)
            rank = border, equal, verdict.word in IN_FIRST
            if best is None or rank < best[0]:
                best = rank, trial, gaps
            if not any(best[0]):
                break
        return Tried(None if best is None else self._shown(best[1], best[2], best[0][0]), judged)

    def _shown(self, trial: Trial, gaps: Sequence[Gap], border: bool) -> Counterexample:
        verdict = self.looked_into(trial)
        word = with_theorem(verdict.word, verdict.theorems)
        if Flaw.HERE in verdict.flawed:
            word = Message(
                "[[verdict]]; some of these coordinates are cyclic there only, and with them counted it is unstable",
                verdict=word,
            )
        at = tuple((name, str(trial.values[name])) for name in self.system.parameter_names)
        shows = tuple((text(difference), str(gap)) for difference, gap, _ in gaps)
        differences = tuple(difference for difference, _, _ in gaps)
        equal = bool(gaps[0][1] == 0)
        return Counterexample(at, (*shows, (THE_MOTION, word)), verdict.word, equal, border, differences)

    def where_zero(self, x: Polynomial) -> Iterator[Trial]:
        """Parameters at which a polynomial in free parameters vanishes: one of them is solved for, rationally.

        At some of them another one vanishes, too: what is stable on a border may be unstable at single points of it.
        """
        ring = self.ring
        free = {name for name in self.system.parameter_names if name not in self._dependent}
        for factor, _ in [] if x.is_constant() else ring.factored(x)[1]:
            degrees = factor.degrees()
            names = sorted(
                (degrees[k], g.name)
                for k, g in enumerate(ring.generators)
                if g.kind == "parameter" and g.name in free and degrees[k]
            )
            for degree, name in names[:SOLVED_FOR]:
                for number, trial in enumerate(islice(self, BORDER_POINTS)):
                    values = {other: rationals.fraction(y) for other, y in trial.values.items() if other in free}
                    yield from self._zeros_along(values, factor, name, degree)
                    for other in sorted({*values} - {name})[: 0 if number else SOLVED_FOR]:
                        yield from self._zeros_along(values | {other: Fraction(0)}, factor, name, degree)

    def _zeros_along(self, free: Mapping[str, Fraction], factor: Polynomial, name: str, degree: int) -> Iterator[Trial]:
        """Where ``factor`` vanishes at rational values of the parameter ``name``, the others as they are."""

        def value_at(number: int) -> Any:
            values = dict(free) | {name: Fraction(number)}
            return Carrier(self.ring, self.numbers, {key: self.numbers.number(y) for key, y in values.items()})(factor)

        try:
            roots = rational_zeros([value_at(k) for k in range(degree + 1)])
        except (*NOT_THERE, KeyError):
            return
        for root in roots:
            try:
                trial = self._made_of(dict(free) | {name: rationals.fraction(root)})
            except (*NOT_THERE, KeyError):
                continue
            if trial is not None:
                trial.special = True
                yield trial

    def once(self, place: str, find: Callable[[], Tried]) -> Tried:
        """What ``find`` gives for the conditions of one place, which are taken together and searched for once."""
        if place not in self._known:
            self._known[place] = find()
        return self._known[place]

    def _trials(self) -> Iterator[Trial]:
        for number, free in enumerate(parameter_samples(self.system, tuple(self.solved))):
            try:
                made = self._made_of(free)
            except KeyError:  # a name without a value, here and everywhere
                return
            except NOT_THERE:
                continue
            if made is not None:
                made.special = number == 0
                yield made

    def _made_of(self, free: Mapping[str, Fraction]) -> Trial | None:
        """All parameters from the free ones; None where M is not positive definite.  Raises as ``completed`` does."""
        numbers = self.numbers
        values = completed(self.system, numbers, free, partial(_solved, self.ring, numbers, self.solved))
        carry = Carrier(self.ring, numbers, values)
        mass = [[carry(x) for x in row] for row in self._mass_matrix.polynomials]
        moving = [i for i, row in enumerate(mass) if any(x != 0 for x in row)]  # others are of first order
        massive = not moving or is_positive(fmpq_mat([[mass[i][j] for j in moving] for i in moving]))
        return Trial(values) if massive else None


def rational_zeros(values: Sequence[Any]) -> list[Any]:
    """The rational zeros of a polynomial that has these values at 0, 1, 2, ...; none of one that is zero."""
    total = fmpq_poly([0])
    for k, value in enumerate(values):
        term = fmpq_poly([value])
        for j in range(len(values)):
            if j != k:
                term = term * fmpq_poly([-j, 1]) / (k - j)
        total = total + term
    linear = (factor for factor, _ in total.factor()[1] if factor.degree() == 1) if total != 0 else ()
    return [-factor[0] / factor[1] for factor in linear]


def _solved(
    ring: Ring, numbers: Algebra, solved: Mapping[str, Polynomial], values: Mapping[str, Any]
) -> dict[str, Any]:
    carry = Carrier(ring, numbers, values)
    return {name: carry(x) for name, x in solved.items()}


# --- states ---


def rate_at_states(
    system: System,
    ring: Ring,
    programs: Programs,
    rate: Polynomial,
    negative: Sequence[str] = (),
    positive: Sequence[str] | None = None,
) -> Iterator[tuple[dict[str, Fraction], Any]]:
    """(numbers by name, dI/dt as a ball) at states of t = 0; ``rate`` is dI/dt with q'' as it stands.

    Coordinates are positive but for those in ``negative`` (which may hold parameters of undeclared sign, too); where
    ``positive`` ones are given, those that are neither have either sign, and angles all quadrants.
    """
    source = random.Random(SEED)
    with ctx.workprec(PRECISION):
        for free, _ in zip(parameter_samples(system), range(STATES), strict=False):
            chosen = dict(free)
            for name in system.coordinates:
                chosen[name] = Fraction(source.randint(1, 6), 4)
                chosen[velocity_name(name)] = Fraction(source.choice((-1, 1)) * source.randint(1, 6), 2)
                if positive is not None and name not in positive:
                    chosen[name] *= 3 * source.choice((-1, 1))
            chosen |= {name: Fraction(source.randint(1, 6), 2) for name in system.input_names}
            chosen |= {name: -abs(chosen[name]) for name in negative if name in chosen}
            try:
                values = _state(system, chosen)
                moving = accelerated(system, State(Balls(values), values), programs)
                value = Carrier(ring, moving.numbers, moving.values)(rate)
            except NOT_THERE:
                continue
            if value.is_finite():
                yield chosen, value


def _state(system: System, chosen: Mapping[str, Fraction]) -> dict[str, Any]:
    """Balls for every name at t = 0; the prescribed quantities start where they were told to."""
    exact = Balls({})
    parameters = {name: value for name, value in chosen.items() if name in system.parameter_names}
    values = completed(system, exact, parameters) | {"t": arb(0)}
    values |= {name: exact.number(value) for name, value in chosen.items()}
    for moved in system.prescribed:
        values[moved.name] = arb(0) if moved.initial is None else Lowering(exact, values)(moved.initial)
    return values


def against_constancy(
    system: System, ring: Ring, programs: Programs, rate: Polynomial, used: Container[str]
) -> Counterexample | None:
    """A state at which dI/dt is certainly not zero; only the numbers of ``used`` names are told."""
    for positive in (None, ()):
        for chosen, value in rate_at_states(system, ring, programs, rate, (), positive):
            if not value.contains(0):
                at = tuple((name, str(number)) for name, number in [*chosen.items(), ("t", 0)] if name in used)
                return Counterexample(at, (("dI/dt", shown(value)),))
    return None


def shown(value: Any, digits: int = DIGITS_SHOWN) -> str:
    """A dozen digits, or so many; zero where nothing but rounding is left."""
    if value.contains(0):
        return "0"
    written = str(value.mid().str(digits, radius=False))
    mantissa, mark, exponent = written.partition("e")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + mark + exponent
