"""Verdicts as values, and the law by which those of subsystems combine.

Of each subsystem some **grounds** are known, each of which holds for the whole if it holds for all parts, and some
**flaws**, each of which the whole has if one part has it:

    grounds(whole) = intersection of grounds(part),    flaws(whole) = union of flaws(part)

and the word is read off these two by one table, ``LAW``.  So combination is commutative, associative and idempotent,
and never gives a stronger verdict than any part has.  Why each ground carries over:

* DECAYS: the roots of the whole are those of its parts (Lyapunov's first method; with zero roots of cyclic coordinates
  and those of turned spins or of a family of steady motions, Lyapunov-Malkin).
* ENERGY: K of the whole is positive definite if K of every part is, and there is one energy, that of the whole system.
  So a damped part beside an undamped one is stable if both have K > 0 and **one energy** of both does not grow, which
  is to be said (``one_energy``); if stability of the damped part rests on its roots alone, nothing covers both, and
  the whole is critical.
* UNDAMPED: a part that gyroscopic forces stabilise, beside others without dissipation; K of the whole is not positive
  definite if that of one part is not (``INDEFINITE``), and then the whole is stabilised by these forces only.
* LINEAR, SHIFTED: the solutions of exactly linear equations are those of its parts, side by side.
* IDLE: nothing but constant momenta, which every other statement survives (they are parameters).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from enum import Enum, auto

from mbsym.expressions.message import joined
from mbsym.problems.displacements import Basis
from mbsym.problems.stability.words import (
    BEYOND_LINEAR,
    LAGRANGE,
    LINEAR,
    MALKIN,
    ROUTH,
    Because,
    Fact,
    Ground,
    Reason,
    Word,
    applying,
    explanation,
    implied,
    reason_of,
)


class Flaw(Enum):
    """What keeps a verdict from being better."""

    CYCLIC = auto()  # cyclic coordinates may drift
    HERE = auto()  # some of those that drift are cyclic at these parameters only; the word is the same
    TURNED = auto()  # a turned spin does not come back
    STEADY = auto()  # a disturbed steady motion may tend to another one of its family
    INDEFINITE = auto()  # what is bounded without dissipation is so by gyroscopic forces: K is not positive definite
    OPEN = auto()  # no theorem applies
    DEPENDS = auto()  # it depends on the parameters
    UNSTABLE = auto()
    INSIDE = auto()  # unstable but for border cases
    SINGULAR = auto()  # the mass matrix is singular: nothing that is computed with it means anything


_ANY = frozenset(Flaw)


@dataclass(frozen=True)
class Row:
    """``word`` where ``ground`` is there, all flaws of ``required``, and no others than those ``allowed``."""

    word: Word
    ground: Ground | None = None
    required: frozenset[Flaw] = frozenset()
    allowed: frozenset[Flaw] = _ANY


_DRIFT = frozenset({Flaw.CYCLIC})
_SOUND = frozenset({Flaw.CYCLIC, Flaw.TURNED})
_FAMILY = frozenset({Flaw.STEADY})

#: The first row that fits gives the word.  Every combination of grounds and flaws fits one.
LAW = (
    Row(Word.UNDECIDED, required=frozenset({Flaw.SINGULAR})),
    Row(Word.UNSTABLE, required=frozenset({Flaw.UNSTABLE})),
    Row(Word.UNSTABLE_BUT_BORDERS, required=frozenset({Flaw.INSIDE})),
    Row(Word.DEPENDS, required=frozenset({Flaw.DEPENDS})),
    Row(Word.UNDECIDED, required=frozenset({Flaw.OPEN})),
    Row(Word.ASYMPTOTIC, Ground.DECAYS, allowed=frozenset()),
    Row(Word.STABLE_BUT_CYCLIC, Ground.IDLE, required=_DRIFT, allowed=_DRIFT),
    Row(Word.ASYMPTOTIC_BUT_CYCLIC, Ground.DECAYS, required=_DRIFT, allowed=_DRIFT),
    Row(Word.ASYMPTOTIC_BUT_STEADY, Ground.DECAYS, required=_FAMILY, allowed=_FAMILY),
    Row(Word.ASYMPTOTIC_BUT_CYCLIC, Ground.DECAYS, required=_DRIFT | _FAMILY, allowed=_DRIFT | _FAMILY),  # on a leaf
    Row(Word.ASYMPTOTIC_BUT_TURNED, Ground.DECAYS, allowed=_SOUND),
    Row(Word.STABLE, Ground.ENERGY, allowed=frozenset()),
    Row(Word.STABLE, Ground.ENERGY, required=_FAMILY, allowed=_FAMILY),  # of a leaf, beside parts that decay
    Row(Word.STABLE, Ground.LINEAR, allowed=_DRIFT | _FAMILY),  # what may drift by itself stays near, too
    Row(Word.STABLE_BUT_CYCLIC, Ground.ENERGY, required=_DRIFT, allowed=_DRIFT | _FAMILY),
    Row(Word.STABLE_BUT_CYCLIC, Ground.SHIFTED, required=_DRIFT, allowed=_DRIFT | _FAMILY),
    Row(Word.GYROSCOPIC, Ground.UNDAMPED, required=frozenset({Flaw.INDEFINITE})),
    Row(Word.CRITICAL),
)

#: Grounds and flaws of a verdict of which nothing but its word is known.
PLAIN: Mapping[Word, tuple[Set[Ground], Set[Flaw]]] = {
    Word.ASYMPTOTIC: ({Ground.DECAYS}, set()),
    Word.ASYMPTOTIC_BUT_CYCLIC: ({Ground.DECAYS}, {Flaw.CYCLIC}),
    Word.ASYMPTOTIC_BUT_TURNED: ({Ground.DECAYS}, {Flaw.TURNED}),
    Word.ASYMPTOTIC_BUT_STEADY: ({Ground.DECAYS}, {Flaw.STEADY}),
    Word.STABLE: ({Ground.ENERGY, Ground.UNDAMPED}, set()),
    Word.STABLE_BUT_CYCLIC: ({Ground.ENERGY, Ground.UNDAMPED}, {Flaw.CYCLIC}),
    Word.GYROSCOPIC: ({Ground.UNDAMPED}, {Flaw.INDEFINITE}),
    Word.CRITICAL: (set(), set()),
    Word.UNDECIDED: (set(), {Flaw.OPEN}),
    Word.DEPENDS: (set(), {Flaw.DEPENDS}),
    Word.UNSTABLE: (set(), {Flaw.UNSTABLE}),
    Word.UNSTABLE_BUT_BORDERS: (set(), {Flaw.INSIDE}),
}


def row_of(grounds: Set[Ground], flaws: Set[Flaw]) -> Row:
    """The row of the table."""
    flaws = flaws - {Flaw.HERE}
    return next(
        row for row in LAW if row.required <= flaws <= row.allowed and (row.ground is None or row.ground in grounds)
    )


@dataclass(frozen=True, repr=False)
class Verdict:
    """A word, the names of the theorems it rests on (empty when none does), and why.

    ``grounds`` with the names of the theorems that lay them, and ``flaws``, are what combination needs; where they are
    not given they are those of the word.  Raises ValueError where they belong to another word.
    """

    word: Word
    theorems: tuple[str, ...] = ()
    reasons: tuple[Reason, ...] = ()
    grounds: tuple[tuple[Ground, tuple[str, ...]], ...] | None = None
    flaws: frozenset[Flaw] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "word", Word(self.word))
        grounds, flaws = PLAIN[self.word]
        if self.flaws is None:
            object.__setattr__(self, "flaws", frozenset(flaws))
        if self.grounds is None:
            decisive = row_of(grounds, flaws).ground
            theorems_by_ground = {ground: self.theorems if ground is decisive else () for ground in grounds}
        else:
            theorems_by_ground = dict(self.grounds)
        object.__setattr__(
            self,
            "grounds",
            tuple((ground, theorems_by_ground[ground]) for ground in Ground if ground in theorems_by_ground),
        )
        if row_of({*theorems_by_ground}, self.flawed).word != self.word:
            raise ValueError(f"these are not the grounds of '{self.word}'")

    def __repr__(self) -> str:
        return f"Verdict({self.word.value!r}{', ' if self.theorems else ''}{self.theorem})"

    def _repr_html_(self) -> str:
        from html import escape

        theorem = f" ({escape(self.theorem)})" if self.theorem else ""
        return f"<b>{escape(self.word.value)}</b>{theorem}. {escape(self.explanation)}"

    @property
    def laid(self) -> dict[Ground, tuple[str, ...]]:
        return dict(self.grounds or ())

    @property
    def flawed(self) -> frozenset[Flaw]:
        return self.flaws or frozenset()

    @property
    def theorem(self) -> str:
        """The names of the theorems, or nothing."""
        return ", ".join(self.theorems)

    @property
    def explanation(self) -> str:
        """The reasons in sentences."""
        return explanation(self.reasons)

    def because(self, code: Because) -> bool:
        return any(reason.code is code for reason in self.reasons)

    @property
    def stable(self) -> bool:
        """Whether stability of the motion itself is proved, be it asymptotic, or but for drift or rotation."""
        return self.word.stable

    @property
    def counted(self) -> Word:
        """The word where coordinates count that are cyclic at these parameters only: their drift is instability.

        Where every velocity tends to its own exponentially these coordinates end near by.
        """
        if Flaw.HERE in self.flawed:
            return Word.STABLE if self.word is Word.ASYMPTOTIC_BUT_CYCLIC else Word.UNSTABLE
        return Word.STABLE if Flaw.CYCLIC in self.flawed and Ground.LINEAR in self.laid else self.word

    @property
    def beyond_linear(self) -> bool:
        """Whether more than the first approximation was needed, whose conditions are not those of this verdict."""
        return any(map(self.because, BEYOND_LINEAR))

    @property
    def coordinates_singular(self) -> bool:
        """Whether nothing is claimed because the mass matrix is singular here."""
        return Flaw.SINGULAR in self.flawed


def undecided(code: Because, *data: object) -> Verdict:
    """No theorem applies, and why."""
    flaw = Flaw.SINGULAR if code in (Because.MASS_SINGULAR, Because.ORDER_LOWER) else Flaw.OPEN
    return Verdict(Word.UNDECIDED, (), (Reason(code, data),), flaws=frozenset({flaw}))


def depends() -> Verdict:
    """Different for different parameters."""
    return Verdict(Word.DEPENDS, (), (Reason(Because.SEE_CASES),))


def unstable_inside(unstable: Verdict) -> Verdict:
    """``unstable`` for all parameters but some without inner points, at which it is left open."""
    return Verdict(Word.UNSTABLE_BUT_BORDERS, unstable.theorems, (*unstable.reasons, Reason(Because.BORDERS_APART)))


def weakest(verdicts: Sequence[Verdict]) -> Verdict:
    """What is true of one system at all parameters, each of which has one of these verdicts."""
    if (
        len(
            {
                (candidate.word, candidate.theorems, candidate.reasons, candidate.grounds, candidate.flaws)
                for candidate in verdicts
            }
        )
        == 1
    ):
        return verdicts[0]
    kept_grounds = set.intersection(*({*verdict.laid} for verdict in verdicts))
    grounds = {ground: tuple(sorted({name for x in verdicts for name in x.laid[ground]})) for ground in kept_grounds}
    flaws = frozenset[Flaw]().union(*(verdict.flawed for verdict in verdicts))
    row = row_of(kept_grounds, flaws)
    if not row.word.stable and all(verdict.stable for verdict in verdicts):
        last = max(verdicts, key=lambda candidate: [*Word].index(candidate.word))
        if last.flawed >= flaws - {Flaw.HERE}:  # stable everywhere, though no one theorem says so
            names = tuple(sorted({name for verdict in verdicts for name in verdict.theorems}))
            return replace(last, theorems=names, flaws=flaws)
    names = () if row.ground is None else grounds[row.ground]
    alike = [verdict for verdict in verdicts if verdict.word == row.word]
    if row.ground is None and row.word in (Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS):
        names = tuple(sorted({name for verdict in alike for name in verdict.theorems}))
    reasons = {_uncounted(reason) for verdict in alike for reason in verdict.reasons}
    if not all(verdict.because(Because.LINEAR_DRIFTS) for verdict in verdicts):
        reasons.discard(_DRIFTS)
    reasons = _telling(reasons)
    return Verdict(row.word, names, tuple(sorted(reasons, key=lambda x: x.rank)), tuple(grounds.items()), flaws)


def concluded(shown: Set[Fact], *reasons: Reason, why_not: Because = Because.BORDER) -> Verdict:
    """What the theorems whose hypotheses are all ``shown`` give, or what may be said without any.

    ``reasons`` replace those of the theorem; where no theorem applies and the first approximation is not shown to be
    stable, ``why_not`` is the reason.
    """
    theorems = applying(shown)
    if None in theorems:
        return Verdict(Word.UNSTABLE, (theorems[None].name,), reasons or (reason_of(theorems[None]),))
    grounds: dict[Ground, tuple[str, ...]] = {
        ground: (theorem.name,) for ground, theorem in theorems.items() if ground is not None
    }
    every = implied(shown)
    if not grounds and Fact.BOUNDED not in every:
        return undecided(why_not)
    if every >= {Fact.UNDAMPED, Fact.POTENTIAL, Fact.MASS_POSITIVE}:
        grounds[Ground.UNDAMPED] = ()
    flaws = {Flaw.TURNED} if Fact.LEFT_BUT_TURNED in every else set()
    if Fact.LEFT_BUT_STEADY in every:
        flaws.add(Flaw.STEADY)
    if flaws:  # the energy of a free spin has its minimum at given angular momentum only
        grounds = {ground: names for ground, names in grounds.items() if ground is Ground.DECAYS}
    positive = Fact.STIFFNESS_POSITIVE in every or Ground.LINEAR in grounds
    if Ground.UNDAMPED in grounds and Ground.ENERGY not in grounds and not positive:
        flaws.add(Flaw.INDEFINITE)
    row = row_of({*grounds}, flaws)
    theorem = theorems.get(row.ground)
    explanations = reasons or ((reason_of(theorem),) if theorem is not None else ())
    names = () if row.ground is None else grounds[row.ground]
    return Verdict(row.word, names, explanations, tuple(grounds.items()), frozenset(flaws))


class Extremum(Enum):
    """What is proved of a stationary point of the potential energy."""

    MINIMUM = "strict minimum"
    NONE = "no minimum"
    OPEN = "open"


def by_extremum(
    order: int, extremum: Extremum, conserved: bool, complete: bool = False, of_one: Set[Fact] = frozenset()
) -> Verdict | None:
    """The verdict by what terms of this order make of V, where the energy does not grow; ``conserved``: nor fall.

    ``complete``: D > 0.  Then no motion keeps the energy but rests, of which there is no other near a strict minimum.
    ``of_one``: what is shown of a system of one coordinate, instead.
    """
    if of_one:
        found = {Extremum.MINIMUM: {Fact.MINIMUM_OF_HIGHER_ORDER}, Extremum.NONE: {Fact.NO_MINIMUM_IN_LOWEST_FORM}}
        shown = {*of_one, *found.get(extremum, ())}
        theorems = applying(shown)
        carried = theorems.get(None) or theorems.get(Ground.DECAYS) or theorems.get(Ground.ENERGY)
        if carried is None:
            return None
        orders = (Because.HIGHER_MINIMUM, Because.NO_MINIMUM)
        return concluded(shown, Reason(carried.because, (order,) if carried.because in orders else ()))
    if extremum is Extremum.MINIMUM:
        facts = {Fact.MINIMUM_OF_HIGHER_ORDER, Fact.ENERGY_NEVER_GROWS}
        if complete:
            return concluded(facts | {Fact.DAMPING_POSITIVE}, Reason(Because.HIGHER_MINIMUM_AND_COMPLETE, (order,)))
        return concluded(facts, Reason(Because.HIGHER_MINIMUM, (order,)))
    if extremum is Extremum.NONE and conserved:
        facts = {Fact.NO_MINIMUM_IN_LOWEST_FORM, Fact.NO_OTHER_FORCES, Fact.ENERGY_CONSERVED}
        return concluded(facts, Reason(Because.NO_MINIMUM, (order,)))
    return None


def bounded(shown: Set[Fact], *reasons: Reason) -> Verdict:
    """The verdict where the first approximation is stable; ``reasons`` say what that leaves open.

    Nothing is left open where there are no terms of higher order.
    """
    every = implied(shown)
    if Fact.EXACTLY_LINEAR not in every:
        return concluded(shown | {Fact.BOUNDED}, *reasons)
    explanations = [Reason(Because.LINEAR_BOUNDED)]
    if every >= {Fact.UNDAMPED, Fact.POTENTIAL, Fact.STIFFNESS_NONSINGULAR, Fact.STIFFNESS_NEGATIVE_SOMEWHERE}:
        explanations.append(Reason(Because.LINEAR_GYROSCOPIC))
    return concluded(shown | {Fact.BOUNDED}, *explanations)


def exactly(verdict: Verdict, calm: bool = False) -> Verdict:
    """A verdict on exactly linear equations: whatever makes them stable, their solutions are bounded.

    ``calm``: those along cyclic coordinates are, too.
    """
    if not {Ground.DECAYS, Ground.ENERGY, Ground.LINEAR, Ground.SHIFTED} & {*verdict.laid}:
        return verdict
    grounds = {Ground.SHIFTED: (LINEAR,), **verdict.laid}
    if calm or Flaw.CYCLIC not in verdict.flawed:
        grounds.setdefault(Ground.LINEAR, (LINEAR,))
    row = row_of({*grounds}, verdict.flawed)
    if row.word == verdict.word:
        return replace(verdict, grounds=tuple(grounds.items()))
    return Verdict(row.word, (LINEAR,), (Reason(Because.LINEAR_BOUNDED),), tuple(grounds.items()), verdict.flawed)


def drifting(verdict: Verdict, constant_momenta: bool = True) -> Verdict:
    """The verdict on the other coordinates as one on the whole, whose cyclic coordinates may drift.

    ``constant_momenta``: it was reached after Routh, and a disturbed momentum stays disturbed.  Where none is and the
    others decay, cyclic velocities are among what decays.
    """
    flaws = verdict.flawed | {Flaw.CYCLIC}
    grounds = {ground: _at_constant_momenta(names) for ground, names in verdict.laid.items()}
    if Ground.LINEAR in grounds:  # bounded is what is left when shifts are not counted
        grounds[Ground.SHIFTED] = grounds.pop(Ground.LINEAR)
    drift = Because.DRIFT
    if Ground.DECAYS in verdict.laid:
        drift = Because.DRIFT_AT_GIVEN_MOMENTA if constant_momenta else Because.ELSEWHERE
    row = row_of({*grounds}, flaws)
    names = verdict.theorems if row.ground is None else grounds[row.ground]
    without = _BESIDE_ZERO_ROOTS | _BUT_CYCLIC
    explanations = (Reason(Because.RIGHT_ROOT) if x.code in _OF_ONE_PART else x for x in verdict.reasons)
    reasons = dict.fromkeys([*(without.get(reason, reason) for reason in explanations), Reason(drift)])
    said = _telling(set(reasons))
    return Verdict(
        row.word,
        names,
        tuple(explanation for explanation in reasons if explanation in said),
        tuple(grounds.items()),
        flaws,
    )


def here(verdict: Verdict) -> Verdict:
    """The verdict on exactly linear equations of which drifting coordinates are cyclic at these parameters only."""
    if Flaw.CYCLIC not in verdict.flawed or Ground.LINEAR in verdict.laid:
        return verdict
    return replace(verdict, flaws=verdict.flawed | {Flaw.HERE})


#: What is true of a whole only if it is of every part that is not stable.
_DRIFTS = Reason(Because.LINEAR_DRIFTS)


def only_drifts(verdict: Verdict) -> Verdict:
    """The verdict, unstable by Jordan blocks, which says that nothing grows but a uniform drift."""
    return replace(verdict, reasons=(*verdict.reasons, _DRIFTS))


def displaced(verdict: Verdict, basis: Basis | None) -> Verdict:
    """The verdict, which says of a drift in which displacements of the user's coordinates it is."""
    displacements = () if basis is None else basis.together
    if not displacements or Flaw.CYCLIC not in verdict.flawed:
        return verdict
    reason = Reason(Because.DISPLACEMENTS, (joined(displacements, ", "),))
    return replace(verdict, reasons=tuple(sorted((*verdict.reasons, reason), key=lambda reason: reason.rank)))


#: How reasons read where cyclic coordinates have zero roots, and where momenta of theirs stay different.
_BESIDE_ZERO_ROOTS = {
    Reason(Because.LEFT): Reason(Because.LEFT_BUT_CYCLIC),
    Reason(Because.LINEAR_BOUNDED): Reason(Because.LINEAR_SHIFTED),
}
#: What is said of K and D without the cyclic coordinates: with them K is singular.
_BUT_CYCLIC = {
    Reason(Because.COMPLETE): Reason(Because.COMPLETE_BUT_CYCLIC),
    Reason(Because.MINIMUM): Reason(Because.MINIMUM_BUT_CYCLIC),
    Reason(Because.MINIMUM_AND_DISSIPATION): Reason(Because.MINIMUM_AND_DISSIPATION_BUT_CYCLIC),
    Reason(Because.NO_ENERGY): Reason(Because.NO_ENERGY_BUT_CYCLIC),
}
_OF_ALL = {told: reason for reason, told in _BUT_CYCLIC.items()}
_BESIDE_CONSTANT_MOMENTA = _BESIDE_ZERO_ROOTS | {
    Reason(Because.DRIFT): Reason(Because.DRIFT_AT_GIVEN_MOMENTA),
    Reason(Because.ELSEWHERE): Reason(Because.DRIFT_AT_GIVEN_MOMENTA),
}


def _at_constant_momenta(theorems: Iterable[str]) -> tuple[str, ...]:
    """A minimum of the effective potential at constant cyclic momenta is Routh's theorem."""
    return tuple(sorted({ROUTH if name == LAGRANGE else name for name in theorems}))


def off_the_leaf(verdict: Verdict) -> Verdict:
    """The verdict on disturbances that keep the relations of integrable constraints as one on those that change them.

    K or the roots on the leaf being what they are, an equilibrium near by belongs to every other value (implicit
    functions), and depends on it smoothly: what decays on the leaf decays to that, a minimum of the energy stays one.
    Where nothing acts on any coordinate nothing decays: on every leaf the velocities stay what they are.
    """
    if Ground.DECAYS not in verdict.laid or Ground.IDLE in verdict.laid:
        return verdict
    grounds = {
        ground: tuple(sorted({*names, MALKIN})) if ground is Ground.DECAYS else names
        for ground, names in verdict.laid.items()
    }
    flaws = verdict.flawed | {Flaw.STEADY}
    row = row_of({*grounds}, flaws)
    reasons = tuple(sorted((*verdict.reasons, Reason(Because.OTHER_LEAF)), key=lambda reason: reason.rank))
    names = verdict.theorems if row.ground is None else grounds[row.ground]
    return Verdict(row.word, names, reasons, tuple(grounds.items()), flaws)


def coasting(because: Because = Because.COASTING) -> Verdict:
    """All coordinates are cyclic and nothing acts on them: M q'' = 0; or so it is in other coordinates (ALIKE)."""
    every = tuple((ground, ()) for ground in Ground if ground is not Ground.LINEAR)
    return Verdict(Word.STABLE_BUT_CYCLIC, (), (Reason(because),), every, frozenset({Flaw.CYCLIC}))


def by_geodesics() -> Verdict:
    """The verdict on a rest where nothing acts at all, and positions are not shown to be alike."""
    return concluded({Fact.POTENTIAL_CONSTANT, Fact.NOT_GYROSCOPIC, Fact.ENERGY_CONSERVED})


def combine(verdicts: Iterable[Verdict], one_energy: bool = False) -> Verdict:
    """The verdict for a system that splits into subsystems: no better than its worst part.  See the module's head.

    ``one_energy``: they belong to one nonlinear system whose energy does not grow.  Raises ValueError where there is no
    subsystem.
    """
    parts = tuple(verdicts) if one_energy else tuple(map(_without_energy, verdicts))
    if not parts:
        raise ValueError("no subsystem, no verdict")
    if len(parts) == 1:
        return parts[0]
    kept_grounds = set.intersection(*({*part.laid} for part in parts))
    grounds = {
        ground: tuple(sorted({name for part in parts for name in part.laid[ground]}))
        for ground in Ground
        if ground in kept_grounds
    }
    flaws = frozenset[Flaw]().union(*(part.flawed for part in parts))
    row = row_of(kept_grounds, flaws)
    if row.ground is not None:
        if row.ground is Ground.ENERGY and Flaw.CYCLIC in flaws:
            grounds[Ground.ENERGY] = _at_constant_momenta(grounds[Ground.ENERGY])
        names = grounds[row.ground]
    else:  # those of the parts that have the flaw which decides
        names = tuple(sorted({name for part in parts if row.required <= part.flawed for name in part.theorems}))
        names = names if row.word in (Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS) else ()
    return Verdict(row.word, names, _reasons(parts, row), tuple(grounds.items()), flaws)


def _without_energy(part: Verdict) -> Verdict:
    """A part that decays, without what its energy would say beside parts that do not."""
    decays = {Ground.DECAYS, Ground.ENERGY} <= {*part.laid} and Ground.IDLE not in part.laid
    return replace(part, grounds=tuple(x for x in part.laid.items() if x[0] is not Ground.ENERGY)) if decays else part


_MINIMUM, _WITH_DISSIPATION = Because.MINIMUM, Because.MINIMUM_AND_DISSIPATION


def _reasons(parts: tuple[Verdict, ...], row: Row) -> tuple[Reason, ...]:
    """Those of the parts that decide; what is counted in one part is not counted in the whole."""
    parts = tuple(replace(part, reasons=tuple(_OF_ALL.get(x, x) for x in part.reasons)) for part in parts)
    alike = [part for part in parts if part.word == row.word and row.required <= part.flawed]
    idle = [part for part in parts if Ground.IDLE in part.laid]
    moving = [part for part in parts if part not in idle]
    reasons: set[Reason] = set()
    if row.required - _SOUND or len(alike) == len(parts) or (alike and row.ground in (Ground.UNDAMPED, None)):
        verdicts = [part for part in alike if part in moving] or alike
        reasons = {reason for part in verdicts for reason in part.reasons}
    elif row.ground is None:
        reasons = {Reason(Because.UNLIKE_PARTS)}
    elif row.ground in (Ground.LINEAR, Ground.SHIFTED):
        reasons = {Reason(Because.LINEAR_BOUNDED if row.ground is Ground.LINEAR else Because.LINEAR_SHIFTED)}
    elif row.ground is Ground.DECAYS and len({part.word for part in moving}) == 1:
        reasons = {reason for part in moving for reason in part.reasons}
    else:
        if row.ground is Ground.ENERGY and not all(Ground.UNDAMPED in part.laid for part in parts):
            reasons = {reason for part in alike if part in moving for reason in part.reasons}
            if reasons or any(part.because(_MINIMUM) or part.because(_WITH_DISSIPATION) for part in moving):
                reasons = reasons - {Reason(_MINIMUM)} | {Reason(_WITH_DISSIPATION)}
            else:
                reasons = {_BESIDE_ZERO_ROOTS.get(reason, reason) for part in moving for reason in part.reasons}
        if any(Flaw.CYCLIC in part.flawed for part in moving) or (row.ground is Ground.ENERGY and idle):
            reasons.add(Reason(Because.PARTLY_CYCLIC))
    if not all(part.stable or part.because(Because.LINEAR_DRIFTS) for part in parts):
        reasons.discard(_DRIFTS)  # of a part: others grow otherwise
    if Flaw.CYCLIC in row.required:
        reasons |= {reason for part in parts for reason in part.reasons if reason.code is Because.DISPLACEMENTS}
    if idle and moving and row.ground is Ground.DECAYS:
        reasons.add(Reason(Because.CONSTANT_MOMENTA))
    if Reason(Because.CONSTANT_MOMENTA) in reasons:
        reasons = {_BESIDE_CONSTANT_MOMENTA.get(reason, reason) for reason in reasons}
    several = len(alike) > 1
    reasons = {_uncounted(x) if several else x for x in reasons}
    reasons = {Reason(Because.RIGHT_ROOT) if x.code in _OF_ONE_PART else x for x in reasons}
    if not all(part.because(Because.COMPLETE) for part in parts) and Reason(Because.COMPLETE) in reasons:
        reasons = reasons - {Reason(Because.COMPLETE)} | {Reason(Because.LEFT)}
    if any(Flaw.CYCLIC in part.flawed for part in parts):
        reasons = {_BUT_CYCLIC.get(reason, reason) for reason in reasons}
    return tuple(sorted(_telling(reasons), key=lambda reason: reason.rank))


#: What is said of K and D of a part, and need not be true of those of the whole (with cyclic coordinates det K = 0).
_OF_ONE_PART = (Because.ODD_DEGREE, Because.ODD_DEGREE_REMAINS, Because.DESTROYED)


def _telling(reasons: set[Reason]) -> set[Reason]:
    """Without what others say better: that all stop, where some drift away; a root to the right, where counted."""
    if reasons & {Reason(Because.DRIFT), Reason(Because.DRIFT_AT_GIVEN_MOMENTA)}:
        reasons = reasons - {Reason(Because.ELSEWHERE)}
    if any(reason.code is Because.RIGHT_ROOTS for reason in reasons):
        reasons = reasons - {Reason(Because.RIGHT_ROOT)}
    if Reason(Because.FOLLOWS_ONE) in reasons:
        reasons = reasons - {Reason(Because.FOLLOWING)}
    return reasons


def _uncounted(reason: Reason) -> Reason:
    return Reason(Because.RIGHT_ROOT) if reason.code is Because.RIGHT_ROOTS else reason
