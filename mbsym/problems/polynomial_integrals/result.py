"""What is found of problem 9, as values; words are made in ``report/integrals_words.py``."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.formulas.formula import Formula
from mbsym.problems.polynomial_integrals.gradings import Grading

if TYPE_CHECKING:
    from mbsym.problems.symmetries.search import Symmetries


#: The name of an integral that depends on those of problem 7 as a function, at a random state.
FUNCTION = "function of the integrals of problem 7"

#: The name of the variable by which a field is made quasi-homogeneous, as an integral.
UNITY = "unity"


@dataclass(frozen=True)
class Generator:
    """An integral that is no polynomial in those before it.

    ``polynomial`` in the field's context, df/dt = 0 (modulo the relations), proved by substitution.  ``name``: that of
    the integral of problem 7 which it is, or is a part of; FUNCTION; "" for one that is no function of these.
    ``independent`` of those before it as a function, and how that is known.
    """

    polynomial: Any
    weight: int
    name: str
    independent: bool
    certainty: Certainty

    @property
    def by_itself(self) -> bool:
        """Whether it has its value by what the variables are: a length, sine and cosine, exponentials."""
        return self.name.startswith(("length of ", "identity between "))

    @property
    def is_new(self) -> bool:
        return not self.name


@dataclass(frozen=True)
class Count:
    """Integrals of one weight (at most that of it, where the field is not quasi-homogeneous).

    ``monomials``: so many coefficients are unknown.  ``most``: the dimension of the kernel modulo a prime, at least
    that over QQ(parameters).  ``products``: the rank of products of the generators modulo the prime, at most that over
    QQ(parameters).  Where the two are equal the list is complete, which is proved then.
    """

    weight: int
    monomials: int
    most: int
    products: int

    @property
    def complete(self) -> bool:
        return self.most == self.products


@dataclass(frozen=True)
class PolynomialIntegrals:
    """Polynomials in ``generators`` are all integrals of weighted degree up to ``degree``, where ``complete``.

    ``independent``: so many of them are, as functions (a lower bound).  ``aside``: positions of the system on which no
    equation depends: they are no variables of the field, and integrals that hold them are not looked for.  ``inside``:
    those that are no variables, but stand in exponentials and reciprocals that are.
    ``rational``: integrals of problem 7 that are quotients of two polynomials in the variables, and no polynomials.
    ``tied``: constraints tie positions, and may have several branches, all of which an integral is one of.
    """

    field: PolynomialField
    grading: Grading
    degree: int
    generators: tuple[Generator, ...]
    counts: tuple[Count, ...]
    independent: int
    aside: tuple[str, ...] = ()
    inside: tuple[str, ...] = ()
    rational: tuple[str, ...] = ()
    tied: bool = False

    @property
    def complete(self) -> bool:
        return all(count.complete for count in self.counts)

    @property
    def new(self) -> tuple[Generator, ...]:
        """Those that problem 7 does not list, nor combinations of what it lists."""
        return tuple(generator for generator in self.generators if generator.is_new)


@dataclass(frozen=True)
class OnLevel:
    """Integrals on  V = 0, V the polynomial of ``level``: (weight, f) with  df/dt = K V, each proved by division."""

    level: Generator
    integrals: tuple[tuple[int, Any], ...]
    counts: tuple[Count, ...]

    @property
    def complete(self) -> bool:
        return all(count.complete for count in self.counts)


@dataclass(frozen=True)
class Special:
    """A special case: what there is beyond what there is in general.

    ``value`` of the parameter that was varied, if one was; ``field`` with it put in.  ``integrals``: (weight, f) over
    that field, proved.  ``levels``: those that hold where an integral vanishes.  ``complete``: there are no others of
    the weights that were looked at.
    """

    value: Fraction | None
    field: PolynomialField
    integrals: tuple[tuple[int, Any], ...]
    levels: tuple[OnLevel, ...]
    complete: bool


@dataclass(frozen=True)
class Along:
    """The special values of a parameter in an interval.

    ``irrational``: polynomials over QQ at whose zeros a rank may drop, too: undecided.  ``undecided``: values at which
    it does, and what there is was not found, or not all of it.  ``usual``: for almost all values the list is complete;
    without that nothing is proved of others.  ``whole``: it is proved that there is no other value, rational or not,
    but for algebraic numbers whose primitive polynomials over ZZ have coefficients beyond 10^9; otherwise that is so of
    rational ones with numerator and denominator up to 10^9.  ``weights``: those of the variables where the field was
    made quasi-homogeneous by a constant more, and integrals are such for any length of the unit vector; otherwise None.
    """

    name: str
    low: Fraction
    high: Fraction
    values: tuple[Special, ...]
    irrational: tuple[Any, ...]
    whole: bool
    undecided: tuple[Fraction, ...] = ()
    usual: bool = True
    weights: tuple[int, ...] | None = None


@dataclass(frozen=True)
class Case:
    """Where all ``conditions`` (polynomials in the parameters) vanish there is what ``special`` holds, proved."""

    conditions: tuple[Any, ...]
    special: Special


@dataclass(frozen=True)
class Cases:
    """The cases that were found in ``families`` families; ``unread``: drops of the rank whose condition was not.

    ``left``: families that were not looked at within the budget; nothing is known of them.
    """

    usual: PolynomialIntegrals
    cases: tuple[Case, ...]
    families: int
    unread: int
    left: int = 0


@dataclass(frozen=True)
class Polynomials:
    """What problem 9 tells of a system: the integrals found, and those that hold where one of them is zero.

    ``variables`` of the field; ``formulas`` of the generators, ``on_levels`` of ``levels``, one by one;
    ``symmetries`` are None where they outgrew a bound.
    """

    integrals: PolynomialIntegrals
    variables: tuple[Formula, ...]
    formulas: tuple[Formula, ...]
    levels: tuple[OnLevel, ...]
    on_levels: tuple[tuple[Formula, ...], ...]
    symmetries: Symmetries | None = None


@dataclass(frozen=True)
class Relation:
    """df/dt = K f where ``conditions`` vanish and ``nonzero`` do not: proved by division."""

    polynomial: Any
    conditions: tuple[Any, ...]
    nonzero: tuple[Any, ...]


@dataclass(frozen=True)
class Relations:
    """Linear invariant relations; ``complete``: there are no others."""

    relations: tuple[Relation, ...]
    complete: bool


class Obstacle(Enum):
    """Why cofactors of Darboux polynomials are not known to be finitely many, or were not all looked at."""

    NOT_HOMOGENEOUS = "not-homogeneous"
    MIXED = "mixed"
    NOT_AT_REST = "not-at-rest"
    TOO_MANY = "too-many"


@dataclass(frozen=True)
class DarbouxPolynomial:
    """D f = K f with f = ``polynomial``, K = ``cofactor`` not zero, D the derivative times the field's denominator.

    ``defined``: the field is so at points with f = 0; where it is not, f = 0 is no relation of motions.
    """

    polynomial: Any
    weight: int
    cofactor: Any
    defined: bool = True


@dataclass(frozen=True)
class DarbouxCount:
    """For one weight and cofactor: ``most`` as in ``Count``, ``products`` of those listed and of integrals."""

    weight: int
    cofactor: Any
    most: int
    products: int

    @property
    def complete(self) -> bool:
        return self.most == self.products


@dataclass(frozen=True)
class DarbouxPolynomials:
    """Those up to a ``degree``, no combinations of products of others and of integrals.

    ``weights`` of the variables of the field; ``counts``: one for every cofactor that was looked at.  ``complete``:
    there are no others with coefficients rational in the parameters; ``obstacle``: why that is not known.
    """

    degree: int
    weights: tuple[int, ...]
    polynomials: tuple[DarbouxPolynomial, ...]
    counts: tuple[DarbouxCount, ...]
    obstacle: Obstacle | None

    @property
    def complete(self) -> bool:
        return self.obstacle is None and all(count.complete for count in self.counts)


@dataclass(frozen=True)
class DarbouxSpecial:
    """What there is at a ``value`` of the parameter and not for almost all, each proved by division over ``field``.

    ``complete``: there are no others of the weights that were looked at.
    """

    value: Fraction
    field: PolynomialField
    polynomials: tuple[DarbouxPolynomial, ...]
    complete: bool


@dataclass(frozen=True)
class DarbouxAlong:
    """The special values of a parameter in an interval; ``general``: what there is for almost all.

    ``undecided``: values at which not all of it may have been found; ``irrational``: polynomials over QQ at whose zeros
    a rank may drop, too; ``square``: polynomials in the parameter: where one is the square of a rational number there
    may be others, and is at infinitely many values; ``left``: K that were not looked at within the budget;
    ``followed``: separate roots of all eigenvalues that move with the parameter were.  ``complete``: at all other
    rational values with numerator and denominator up to 10^9 there is none with rational coefficients.
    """

    name: str
    low: Fraction
    high: Fraction
    general: DarbouxPolynomials
    values: tuple[DarbouxSpecial, ...] = ()
    undecided: tuple[Fraction, ...] = ()
    irrational: tuple[Any, ...] = ()
    square: tuple[Any, ...] = ()
    left: int = 0
    followed: bool = True

    @property
    def complete(self) -> bool:
        return self.general.complete and not self.left and self.followed and not self.square and not self.undecided


@dataclass(frozen=True)
class SpecialLevel:
    """``integrals``: (weight, F) with F constant where the level's ``V^a`` is ``value``, proved by division.

    ``complete``: there are no others.
    """

    value: Fraction
    integrals: tuple[tuple[int, Any], ...]
    complete: bool


@dataclass(frozen=True)
class OtherLevel:
    """Where the integral ``level``, V, has a value other than zero; values are told of its power ``a``.

    ``undecided``: values at which a rank drops, and what there is was not found; ``irrational``: polynomials over QQ at
    whose zeros one may.  ``whole``: it drops nowhere, at no real value.  ``complete``: for almost all values there is
    nothing but the integrals that hold everywhere, so that at no value that is not named there is (rational ones with
    numerator and denominator up to 10^9, all where ``whole``).  ``drops``: parameters are symbols, and for almost all
    of them the rank drops somewhere.  ``looked``: whether that was within the bounds.
    """

    level: Generator
    power: int
    values: tuple[SpecialLevel, ...] = ()
    undecided: tuple[Fraction, ...] = ()
    irrational: tuple[Any, ...] = ()
    whole: bool = True
    complete: bool = False
    drops: bool = False
    by_rank: bool = False
    looked: bool = True


@dataclass(frozen=True)
class OtherLevels:
    """Up to a weighted ``degree``, one item for each integral; ``weights`` as in ``Along``.

    ``fixed``: another quantity has a value, too: the length of the unit vector, or the constant that is 1.
    """

    degree: int
    fixed: bool
    levels: tuple[OtherLevel, ...]
    weights: tuple[int, ...] | None = None
