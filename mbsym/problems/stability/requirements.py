"""Conditions as values: what has to be positive or not zero, its logical place, and which verdict follows from which.

The places follow from continuity of roots.  While no root has a positive real part, coefficients, Hurwitz minors and,
with only even powers, (sub)discriminants are limits of positive numbers, so they are >= 0: **that** is necessary for
stability.  That they are > 0 is necessary for exponential stability, all roots to the left, and for nothing less: at a
border the motion may be asymptotically stable all the same, by terms of higher order (a soft border).  Where the best
that can be had is stability it is a demand of the method, which leaves the borders open: at a border roots may coincide
and be semisimple (a lamina that spins about its axis of largest inertia), or be zero where higher terms make the motion
stable.  Without forces on velocities a vanishing coefficient makes solutions of the first approximation grow."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from mbsym.algebra.characteristic import Coefficients, Matrix, Polynomial, leading_minors
from mbsym.algebra.failures import Failure
from mbsym.algebra.semialgebraic import EVERYTHING, NOTHING, Atom, ParameterSet, atom, where
from mbsym.algebra.signs import MOST_TERMS, Condition, Signs
from mbsym.expressions.message import Message
from mbsym.problems.stability.verdict import Verdict, combine, depends, undecided, unstable_inside, weakest
from mbsym.problems.stability.words import Because, Word

#: How labels are made of other labels: of a condition reversed, of one of several factors, of a part of a condition.
REVERSED, OF_FACTOR, PART = "-([[label]])", "[[label]] of factor [[number]]", "[[label]], [[part]]"


class Method(StrEnum):
    """What the conditions on the characteristic polynomial say together."""

    EVEN = "all squares of roots real, negative and simple: coefficients and discriminants"
    HURWITZ = "all roots to the left of the imaginary axis: Lienard-Chipart"
    NONE = "none"


#: What the conditions on roots in lambda^2 say where zero roots are left out of them.
EVEN_BUT_ZERO = "all squares of roots but the zero ones real, negative and simple: coefficients and discriminants"
#: What Hurwitz's conditions say where zero roots, or those of a turned steady spin as well, are left out of them.
BUT_ZERO = "all roots but the zero ones to the left of the imaginary axis: Lienard-Chipart"
BUT_TURNED = "all roots but the zero ones and those of a turned spin to the left of the imaginary axis: Lienard-Chipart"


class Place(StrEnum):
    """What follows where a condition fails."""

    #: p > 0: where p < 0 the motion is unstable; where p = 0 the method leaves it open.
    NECESSARY = "necessary, but for the case of equality"
    #: p > 0, p != 0 in exactly linear equations: where p = 0, too, the motion is unstable.
    STRICTLY = "necessary: with equality the motion is unstable"
    #: In exactly linear equations: where p = 0 and the other conditions hold the motion is unstable.
    BESIDE = "with equality, the other conditions holding, the motion is unstable"
    #: In exactly linear equations: where p = 0 and the other conditions hold the motion is stable.
    EQUALITY = "with equality, the other conditions holding, the motion is stable, too"
    #: In exactly linear equations: where p = 0 and the other conditions hold nothing grows, but not all decays.
    MERELY = "with equality, the other conditions holding, the motion is stable, but not asymptotically"
    #: The same, but along directions on which nothing depends then it drifts.
    DRIFTS = "with equality, the other conditions holding, the motion is stable but for a drift"
    #: Without it the first approximation has solutions that grow (linearly in time); the motion may be stable.
    FIRST = "necessary in the first approximation"
    #: Without it not all roots are to the left; by terms of higher order the motion may be asymptotically stable.
    EXPONENTIAL = "necessary for exponential stability (all roots to the left)"
    SUFFICIENT = "sufficient"
    #: Without it this method decides nothing: the motion may be stable, or not.
    METHOD = "needed by this method, which leaves the rest open"
    #: Nothing: a discriminant of a potential system is never negative, and where it vanishes roots are semisimple.
    HARMLESS = "not needed: equal frequencies of a potential system do no harm"


class Definite(StrEnum):
    """Whether a symmetric matrix is positive definite."""

    POSITIVE = "positive definite"
    NOT_POSITIVE = "not positive definite"
    OPEN = "undecided"


@dataclass(frozen=True)
class Requirement:
    """``polynomial`` ``relation`` 0, as it arises (``label``: v4, discriminant, ...) and reduced by what is known.

    ``by_mass``: it holds because the kinetic energy is positive definite.  ``place`` is the one of ``relation``,
    ``strict`` the one of ``polynomial`` != 0, which may be a condition of its own.  ``coefficients``, from low to high
    powers, are those of which a discriminant or minor is made; empty for what is no such thing.
    """

    label: str
    polynomial: Polynomial
    condition: Condition
    relation: str = ">"
    by_mass: bool = False
    place: Place = Place.NECESSARY
    strict: Place = Place.METHOD
    coefficients: Coefficients = ()

    @property
    def polynomials(self) -> tuple[Polynomial, ...]:
        """As it arises, and reduced."""
        return self.polynomial, self.condition.polynomial, *self.condition.nonzero

    @property
    def always(self) -> bool:
        return self.by_mass or self.condition.kind == "always"

    @property
    def never(self) -> bool:
        return not self.by_mass and self.condition.kind == "never"

    @property
    def unwritten(self) -> bool:
        """Too long to be written out: neither provable nor refutable, so that no verdict can rest on it."""
        return self.condition.kind == "unwritten"


@dataclass(frozen=True)
class Case:
    """If all of ``all_of`` and, unless it is empty, at least one of ``any_of`` hold, then ``verdict``.

    Cases are read in order, like an if-elif chain: a later one presumes that the earlier ones do not apply.
    A case that requires nothing is a mistake (``ValueError``): an empty choice must not count as fulfilled.
    """

    all_of: tuple[Requirement, ...]
    any_of: tuple[Requirement, ...]
    verdict: Verdict

    def __post_init__(self) -> None:
        if not self.all_of and not self.any_of:
            raise ValueError("a case needs a requirement")

    @property
    def always(self) -> bool:
        return all(r.always for r in self.all_of) and (not self.any_of or any(r.always for r in self.any_of))

    @property
    def polynomials(self) -> Iterator[Polynomial]:
        """What its conditions are about, as they arise and reduced."""
        for r in (*self.all_of, *self.any_of):
            yield from r.polynomials

    def carried(self, carry: Lift) -> Case:
        """The case in another ring, ``carry`` a map of its polynomials that keeps factors irreducible."""

        def there(r: Requirement) -> Requirement:
            of = r.condition
            factors, nonzero = (tuple(map(carry, x)) for x in (of.factors, of.nonzero))
            condition = replace(of, polynomial=carry(of.polynomial), factors=factors, nonzero=nonzero)
            return replace(r, polynomial=carry(r.polynomial), condition=condition)

        return replace(self, all_of=tuple(map(there, self.all_of)), any_of=tuple(map(there, self.any_of)))

    @property
    def never(self) -> bool:
        return any(r.never for r in self.all_of) or (bool(self.any_of) and all(r.never for r in self.any_of))


@dataclass(frozen=True)
class Definiteness:
    """Sylvester: a symmetric matrix is positive definite iff all leading ``minors`` are > 0."""

    word: Definite
    requirements: tuple[Requirement, ...]

    @property
    def minors(self) -> tuple[Polynomial, ...]:
        return tuple(r.polynomial for r in self.requirements)


@dataclass(frozen=True)
class Factor:
    """An irreducible factor of the characteristic polynomial: coefficients from low to high, and multiplicity."""

    coefficients: Coefficients
    multiplicity: int


def definiteness(matrix: Matrix, signs: Signs, name: str) -> Definiteness:
    """Sylvester's criterion, each leading minor reduced by ``signs`` and by the minors before it being positive."""
    requirements: list[Requirement] = []
    first = signs
    for i, minor in enumerate(leading_minors(matrix), start=1):
        condition = signs.condition(minor)
        place, label = Place.SUFFICIENT, Message("minor [[i]] of [[name]]", i=i, name=name)
        # What has the minor's sign only beside the others is not told under its name.
        if condition.kind == "inequality" and first.condition(minor) != condition:
            label = Message(PART, label=label, part=Message("reduced by those before"))
        requirements.append(Requirement(label, minor, condition, place=place, strict=place))
        if condition.kind == "inequality" and len(condition.polynomial) <= MOST_TERMS:
            signs = signs.assuming([(condition.polynomial, ">"), *((p, "!=") for p in condition.nonzero)])
    if all(r.always for r in requirements):
        word = Definite.POSITIVE
    elif any(r.never for r in requirements):
        word = Definite.NOT_POSITIVE
    else:
        word = Definite.OPEN
    return Definiteness(word, tuple(requirements))


def against(requirements: Sequence[Requirement], known: Signs) -> tuple[Requirement, ...]:
    """p < 0 for every p > 0.  By continuity none of them occurs while all roots have Re <= 0 (or mu <= 0)."""

    def reversed_(r: Requirement) -> Condition:
        never = r.condition.kind == "always"  # it may follow from what others require
        return Condition("never", -r.polynomial) if never else known.condition(-r.polynomial)

    return tuple(
        Requirement(Message(REVERSED, label=_whole(r.label)), -r.polynomial, reversed_(r))
        for r in requirements
        if r.relation == ">" and r.place is not Place.HARMLESS and not r.by_mass and not r.unwritten
    )


def _whole(label: str) -> str:
    """``minor 2 of K`` of the label of that minor as it was reduced."""
    return label.gaps["label"] if isinstance(label, Message) and label.text == PART else label


def differs(label: str, p: Polynomial, known: Signs) -> Requirement:
    return Requirement(label, p, known.nonzero_condition(p), "!=", place=Place.METHOD)


def holds_always(p: Polynomial) -> Requirement:
    """1 > 0, over the ring of p: of a case that requires nothing."""
    one = p * 0 + 1
    return Requirement("none", one, Condition("always", one))


def unwritten(p: Polynomial) -> Requirement:
    """A condition that is left out."""
    return Requirement("not written out", p, Condition("unwritten", p * 0 + 1))


# Cases as sets of parameters: what is said of a system whose parts have cases, for all parameters at once.
#
# The cases of a part are read in order; together with what none of them covers they divide the parameters.  Those of
# all
# parts are intersected, and what is proved to be empty is left out: "depends on the parameters" is said of what is
# left.


#: Intersections of the cases of several parts are followed up to so many.
MOST_CELLS = 64

Lift = Callable[[Polynomial], Polynomial]


@dataclass(frozen=True)
class Cell:
    """A set of parameters that is not known to be empty, and the verdict there."""

    where: ParameterSet
    verdict: Verdict


def cells_of(cases: Sequence[Case], lift: Lift = lambda p: p) -> tuple[Cell, ...] | None:
    """The cases of one part as sets that do not overlap, and what is left; None where one is too long to be written.

    ``lift`` carries polynomials into the ring in which sets of several parts are compared.
    """
    cells: list[Cell] = []
    left = EVERYTHING
    try:
        for case in cases:
            there = _set_of(case, lift)
            if there is None:
                return None
            cells.append(Cell(left & there, case.verdict))
            left = left & there.complement()
        return (*cells, Cell(left, undecided(Because.BORDER)))
    except Failure:
        return None


def _set_of(case: Case, lift: Lift) -> ParameterSet | None:
    """Where the case holds, whatever the others do."""
    if any(r.unwritten for r in (*case.all_of, *case.any_of)):
        return None
    parameter_set = EVERYTHING
    for requirement in case.all_of:
        parameter_set = parameter_set & where(*atoms(requirement, lift))
    if case.any_of:
        some = NOTHING
        for requirement in case.any_of:
            some = some | where(*atoms(requirement, lift))
        parameter_set = parameter_set & some
    return parameter_set


def atoms(requirement: Requirement, lift: Lift = lambda p: p) -> tuple[Atom, ...]:
    """What is left of a requirement once everything known has been used; a set for ``where``."""
    condition = requirement.condition
    if requirement.always:
        return ()
    if condition.kind == "never":
        return (atom(lift(condition.polynomial * 0), ">"),)
    apart = tuple(atom(lift(x), "!=") for x in condition.nonzero)
    if condition.kind == "inequality":
        return (atom(lift(condition.polynomial), requirement.relation), *apart)
    return apart


def everywhere(verdict: Verdict) -> tuple[Cell, ...]:
    """The one cell of a part whose verdict does not depend on the parameters."""
    return (Cell(EVERYTHING, verdict),)


def alone(cells: Sequence[Cell], signs: Signs) -> Verdict:
    """The verdict on one part for all parameters: that of all its cells which are not empty, if they have one word."""
    if _differ([cells], signs, one_energy=True, within=EVERYTHING):
        return depends()
    left = [cell for cell in cells if not _is_empty(cell.where, signs)]
    return depends() if len({cell.verdict.word for cell in left}) > 1 and _all_stable(left) else _common(left, signs)


def uncovered(cells: Sequence[Cell], signs: Signs) -> bool:
    """Whether parameters are known, and all that are near them, at which none of the cases of one part holds."""
    if signs.numbers or signs.normal is not None:  # witnesses mean nothing
        return False
    left = cells[-1].where.inner()
    return any(left.holds(point) for point in signs.witnesses)


def joined(
    parts: Sequence[Sequence[Cell]], signs: Signs, one_energy: bool, within: ParameterSet = EVERYTHING
) -> Verdict:
    """The verdict on a whole for all parameters ``within``: what cells that are not empty have in common.

    Where every part is stable in every case, but not always asymptotically, it is stable.
    """
    left: list[tuple[ParameterSet, tuple[Verdict, ...]]] = [(within, ())]
    try:
        if _differ(parts, signs, one_energy, within):
            return depends()
        for part in parts:
            crossed = [(there & cell.where, (*verdicts, cell.verdict)) for there, verdicts in left for cell in part]
            left = [candidate for candidate in crossed if not _is_empty(candidate[0], signs)]
            if len(left) > MOST_CELLS:
                return depends()
    except Failure:
        return depends()
    return _common([Cell(there, combine(verdicts, one_energy)) for there, verdicts in left], signs)


def _differ(parts: Sequence[Sequence[Cell]], signs: Signs, one_energy: bool, within: ParameterSet) -> bool:
    """Whether points are known at which the verdicts differ, not all of them stable."""
    if signs.numbers or signs.normal is not None:
        return False
    stable_by_word: dict[Word, bool] = {}
    for point in signs.witnesses:
        if not within.holds(point):
            continue
        there = [next((cell for cell in part if cell.where.inner().holds(point)), None) for part in parts]
        verdicts = [cell.verdict for cell in there if cell is not None]
        if len(verdicts) == len(parts):
            verdict = combine(verdicts, one_energy)
            stable_by_word[verdict.word] = verdict.stable
            if len(stable_by_word) > 1 and not all(stable_by_word.values()):
                return True
    return False


def _common(cells: Sequence[Cell], signs: Signs) -> Verdict:
    if not cells:
        return undecided(Because.BORDER)
    verdicts = [cell.verdict for cell in cells]
    if len({verdict.word for verdict in verdicts}) == 1 or _all_stable(cells):
        return weakest(verdicts)
    unstable = [verdict for verdict in verdicts if verdict.word is Word.UNSTABLE]
    others = [cell for cell in cells if cell.verdict.word is not Word.UNSTABLE]
    if unstable and all(_is_empty(cell.where.inner(), signs) for cell in others):
        return unstable_inside(weakest(unstable))
    return depends()


def _all_stable(cells: Sequence[Cell]) -> bool:
    return all(cell.verdict.stable for cell in cells)


def _is_empty(there: ParameterSet, signs: Signs) -> bool:
    """Whether no parameters are in it, proved."""
    if any(len(one.polynomial) > MOST_TERMS for piece in there.pieces for one in piece):
        short = (tuple(one for one in piece if len(one.polynomial) <= MOST_TERMS) for piece in there.pieces)
        there = ParameterSet(tuple(short))  # a larger set
    return there.is_empty(signs)
