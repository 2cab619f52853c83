"""What problem 10 finds."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mbsym.formulas.formula import Formula, Shown


class Kind(Enum):
    """What moves on a stationary set."""

    STEADY = "steady motions"
    MANIFOLD = "invariant manifold"


class Definiteness(Enum):
    """What the second variation says, for almost all parameters that the description allows."""

    STABLE = "stable"  # definite, proved
    CONDITIONAL = "conditional"  # definite where the conditions hold
    NEVER = "never"  # neither sign is possible: it is not definite
    DEGENERATE = "degenerate"  # its determinant vanishes identically
    LEFT_OUT = "left out"  # beyond the budget
    VARYING = "multipliers vary"  # over the set, so that it is none for fixed ones: not looked at


@dataclass(frozen=True)
class Relation:
    """``formula`` relation 0, the relation one of > >= != =; or one of ``unless`` vanishes."""

    formula: Formula
    relation: str
    unless: tuple[Formula, ...] = ()


@dataclass(frozen=True)
class SecondVariation:
    """The second variation of the family on the level of its integrals.

    ``positive`` and ``negative``: conditions for either sign, None where that sign is impossible; they may hold free
    multipliers, and are sufficient if some value of these satisfies them (``chosen``: which).
    """

    outcome: Definiteness
    size: int
    positive: tuple[Relation, ...] | None = None
    negative: tuple[Relation, ...] | None = None
    chosen: tuple[str, ...] = ()


class Gap(Enum):
    """What exact trials say of the region between sufficient and necessary conditions."""

    FOUND = "found"  # a point in it
    NONE_FOUND = "none found"  # at no point that was tried
    UNTRIED = "untried"


@dataclass(frozen=True)
class FirstApproximation:
    """The roots lambda at a steady motion: ``zeros`` of them vanish, the others are even factors in lambda^2.

    ``necessary``: where one of them is violated the motion is unstable; not ``complete`` where a factor that is not
    even was left out: ``left`` roots belong to these.  ``unstable``: proved for all parameters that the description
    allows.
    """

    zeros: int
    factors: tuple[tuple[Formula, ...], ...]
    necessary: tuple[Relation, ...]
    unstable: bool
    complete: bool
    left: int = 0


@dataclass(frozen=True)
class StationarySet:
    """{x: grad K = 0} for one branch of multipliers.

    ``equations`` that hold on it, solved where they could be (``solved``: name and value); ``nonzero``: what does not
    vanish on it; ``relations`` between what is left free, multipliers included; ``dimension`` for fixed multipliers,
    and of the union over all.
    """

    kind: Kind
    solved: tuple[tuple[str, Formula], ...]
    relations: tuple[Formula, ...]
    nonzero: tuple[Formula, ...]
    free: tuple[str, ...]
    multipliers: tuple[tuple[str, Formula | None], ...]
    dimension: int
    union: int
    motion: tuple[tuple[str, Formula], ...]
    #: By the equations of motion, in the ring; None where that was not decided.
    invariant: bool | None
    variation: SecondVariation | None
    first: FirstApproximation | None
    gap: Gap
    #: Real points: whether one was found at rational values that the description allows.
    real: bool

    @property
    def invariance(self) -> str:
        """How it is known to be invariant."""
        return {True: "proved", None: "undecided", False: "failed"}[self.invariant]

    @property
    def proved_variation(self) -> SecondVariation | None:
        """The second variation where the set is proved to be invariant."""
        return self.variation if self.invariant else None


@dataclass(frozen=True)
class Family:
    """K = V_0 + sum multipliers_k V_k, and its stationary sets."""

    integrals: tuple[str, ...]
    multipliers: tuple[str, ...]
    sets: tuple[StationarySet, ...]
    unfinished: int
    #: Branches on which the coordinates are singular: rates are not given there, and nothing is said.
    singular: int = 0
    #: Pieces that are not invariant by themselves, left out: the whole set of stationary points is.
    parts: int = 0

    @property
    def complete(self) -> bool:
        """Whether no branch was left aside."""
        return not (self.unfinished or self.singular or self.parts)


@dataclass(frozen=True, repr=False)
class InvariantSets(Shown):
    """Problem 10.  ``integrals``: what the families are made of; ``generic``: taken to be nonzero."""

    integrals: tuple[tuple[str, Formula], ...]
    relations: tuple[Formula, ...]
    families: tuple[Family, ...]
    generic: tuple[Formula, ...]
    #: Of Lagrange's equations, in rates and angles: multipliers of relations need not be constant along a motion.
    in_angles: bool = False
    variables: tuple[str, ...] = ()
    #: Variables that stand for something else: sin_theta for sin(theta).
    written: tuple[tuple[str, str], ...] = ()
    #: Integrals whose gradients depend on those of ``integrals`` at a random point, and that are no sums of these.
    left_out: tuple[str, ...] = ()
    #: The constant values of inputs for which all of this is so.
    inputs: tuple[tuple[str, str], ...] = ()

    @property
    def complete(self) -> bool:
        """Whether no branch was left aside."""
        return all(family.complete for family in self.families)
