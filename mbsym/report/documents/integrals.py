"""What ``mbsym integrals --json`` prints, and what problem 9 has of it."""

from __future__ import annotations

from typing import Annotated, Literal

from msgspec import field

from mbsym.problems.polynomial_integrals.result import Obstacle
from mbsym.report.documents.base import Format, From, Part, SystemName, Version, told_apart_by, version, words


class Integral(Part, frozen=True):
    weight: Annotated[int, "weighted degree"]
    name: Annotated[str, "name in problem 7; empty for one that it does not list"]
    new: Annotated[bool, "whether problem 7 does not list it", From("is_new")]
    formula: Annotated[str, "in Python syntax", From("polynomial")]
    independent: Annotated[bool, "of those before it, as a function"]
    independence: Annotated[
        str, words("proved", "verified numerically", "undecided"), "how that is known", From("certainty")
    ]


class Count(Part, frozen=True):
    weight: Annotated[int, "of this weight, or up to it where the equations are not quasi-homogeneous"]
    monomials: Annotated[int, "unknown coefficients"]
    at_most: Annotated[int, "independent linear combinations that are integrals, at most", From("most")]
    found: Annotated[int, "those that products of the listed ones span, at least", From("products")]


class WeightedIntegral(Part, frozen=True):
    weight: Annotated[int, "weighted degree"]
    formula: Annotated[str, "in Python syntax"]


class OnLevel(Part, frozen=True):
    zero: Annotated[str, "name of the integral that vanishes", From("level.name")]
    integrals: Annotated[list[WeightedIntegral], "whose derivatives it divides", told_apart_by("formula")]


class SpecialValue(Part, frozen=True):
    value: Annotated[str, "rational number"]
    integrals: Annotated[list[WeightedIntegral], "that hold everywhere", told_apart_by("formula")]
    on_levels: Annotated[list[OnLevel], "that hold where another one vanishes", told_apart_by("zero"), From("levels")]
    complete: Annotated[bool, "proved: no others that hold everywhere, of weight up to the degree"]


UndecidedAtZerosOf = Annotated[
    list[list[str]],
    "polynomials by their coefficients, the lowest first",
    From("irrational", lambda polynomials: [p.coeffs() for p in polynomials]),
]


class Along(Part, frozen=True):
    """special values of one parameter; null where none was varied"""

    parameter: Annotated[str, "its name", From("name")]
    low: Annotated[str, "rational number"]
    high: Annotated[str, "rational number"]
    values: Annotated[list[SpecialValue], "rational values with further integrals", told_apart_by("value")]
    undecided_at: Annotated[list[str], "values at which there may be more than is listed", From("undecided")]
    undecided_at_zeros_of: UndecidedAtZerosOf
    weights: Annotated[
        dict[str, int] | None,
        "weights of the variables where a constant more made the equations quasi-homogeneous, and unit vectors have "
        "any length; otherwise null",
    ]
    no_others: Annotated[
        bool,
        "proved for all other values, but for algebraic numbers whose polynomials over the integers need "
        "coefficients beyond 10^9",
        From("whole"),
    ]
    no_other_rational: Annotated[
        bool, "proved for all other rational values with numerator and denominator up to 10^9", From("usual")
    ]


class SpecialCase(Part, frozen=True):
    vanishing: Annotated[list[str], "what of the parameters vanishes", From("conditions")]
    integrals: Annotated[
        list[WeightedIntegral], "that hold everywhere", told_apart_by("formula"), From("special.integrals")
    ]
    on_levels: Annotated[
        list[OnLevel], "that hold where another one vanishes", told_apart_by("zero"), From("special.levels")
    ]
    complete: Annotated[
        bool, "proved: no others that hold everywhere, of weight up to the degree", From("special.complete")
    ]


class Cases(Part, frozen=True):
    """special cases; null where they were not asked for"""

    families: Annotated[int, "families of parameters that were looked at"]
    families_left: Annotated[int, "families that were not looked at within the budget", From("left")]
    conditions_not_found: Annotated[
        int, "families in which the rank drops under conditions that were not found", From("unread")
    ]
    cases: Annotated[list[SpecialCase], "each proved", told_apart_by("vanishing")]


class InvariantRelation(Part, frozen=True):
    formula: Annotated[str, "the form", From("polynomial")]
    vanishing: Annotated[list[str], "what of the parameters vanishes", From("conditions")]
    nonzero: Annotated[list[str], "what of them does not"]


class InvariantRelations(Part, frozen=True):
    """linear invariant relations; null where they were not asked for"""

    complete: Annotated[bool, "proved: there are no others"]
    relations: Annotated[
        list[InvariantRelation],
        "linear forms that divide their derivatives, each proved",
        told_apart_by("formula", "vanishing"),
    ]


class Polynomial(Part, frozen=True):
    weight: Annotated[int, "weighted degree"]
    formula: Annotated[str, "f in Python syntax", From("polynomial")]
    cofactor: Annotated[str, "K in Python syntax"]
    defined: Annotated[bool, "false where the equations are not defined on f = 0, which is no relation of motions then"]


class NotFound(Part, frozen=True):
    weight: Annotated[int, "weighted degree"]
    cofactor: Annotated[str, "K in Python syntax"]
    at_most: Annotated[int, "so many more"]


class Darboux(Part, frozen=True):
    """polynomials f that divide their derivatives, df/dt = K f with K not zero, for almost all parameters; null where
    they were not asked for
    """

    degree: Annotated[int, "up to this weighted degree"]
    weights: Annotated[dict[str, int], "weight of each variable"]
    complete: Annotated[
        bool, "proved: every other with rational coefficients is a combination of products of these and of integrals"
    ]
    obstacle: Annotated[Obstacle | None, "why K is not known to be one of those that were looked at; null where it is"]
    polynomials: Annotated[list[Polynomial], "each proved by division", told_apart_by("formula")]
    not_found: Annotated[
        list[NotFound],
        "of which weights and K there may be more, which were not found within the budget",
        told_apart_by("weight", "cofactor"),
    ]


class DarbouxValue(Part, frozen=True):
    value: Annotated[str, "rational number"]
    polynomials: Annotated[list[Polynomial], "each proved by division", told_apart_by("formula")]
    complete: Annotated[bool, "proved: no others with rational coefficients, up to the degree"]


class DarbouxAlong(Part, frozen=True):
    """at which values of the parameter that was varied there are more polynomials f with df/dt = K f than for almost
    all; null where they were not asked for
    """

    parameter: Annotated[str, "its name", From("name")]
    low: Annotated[str, "rational number"]
    high: Annotated[str, "rational number"]
    values: Annotated[list[DarbouxValue], "rational values with further ones", told_apart_by("value")]
    undecided_at: Annotated[list[str], "values at which there may be more than is listed", From("undecided")]
    undecided_at_zeros_of: UndecidedAtZerosOf
    undecided_where_square: Annotated[
        list[str],
        "polynomials in the parameter: where one is the square of a rational number there may be others",
        From("square"),
    ]
    cofactors_left: Annotated[int, "so many K were not looked at within the budget", From("left")]
    all_followed: Annotated[
        bool, "whether all K that become rational at single values were followed, but for those left", From("followed")
    ]
    no_other_rational: Annotated[
        bool,
        "proved for all other rational values with numerator and denominator up to 10^9, for rational coefficients",
        From("complete"),
    ]


class ZeroLevel(Part, frozen=True):
    zero: Annotated[str, "name of the integral that vanishes", From("level.name")]
    integrals: Annotated[list[WeightedIntegral], "whose derivatives it divides", told_apart_by("formula")]
    complete: Annotated[bool, "proved: there are no others up to the degree, for almost all parameters"]


class Value(Part, frozen=True):
    value: Annotated[str, "rational number, not zero"]
    integrals: Annotated[
        list[WeightedIntegral],
        "that hold on this level and not everywhere, proved by division",
        told_apart_by("formula"),
    ]
    complete: Annotated[bool, "there are no others of the weights that were looked at"]


class OtherLevel(Part, frozen=True):
    integral: Annotated[str, "name of the integral that has a value", From("level.name")]
    power: Annotated[int, "the values are those of this power of it"]
    values: Annotated[list[Value], "at which there are others", told_apart_by("value")]
    undecided_at: Annotated[list[str], "values at which there may be more than is listed", From("undecided")]
    undecided_at_zeros_of: UndecidedAtZerosOf
    looked: Annotated[bool, "false where that was beyond the bounds"]
    complete: Annotated[bool, "at no other rational value with numerator and denominator up to 10^9 are there others"]
    at_any_value: Annotated[
        bool,
        "at no value at all, but for algebraic numbers whose polynomials over the integers need coefficients beyond "
        "10^9",
    ]
    known: Annotated[
        Literal["proved", "verified numerically"],
        "how the two before are known; verified: at random parameters modulo a prime",
    ]


class PolynomialBasis(Part, frozen=True, kw_only=True):
    """polynomial first integrals up to a weighted degree"""

    degree: Annotated[int, "up to this weighted degree"]
    weights: Annotated[dict[str, int], "weight of each variable"]
    quasi_homogeneous: Annotated[bool, "whether d/dt raises all weights alike", From("grading.homogeneous")]
    complete: Annotated[
        bool,
        "proved: every polynomial integral up to the degree, of the variables that have weights, is a polynomial in "
        "those listed, for almost all parameters",
    ]
    independent: Annotated[int, "so many are independent as functions, at least"]
    rational: Annotated[
        list[str],
        "integrals of problem 7 that are quotients of polynomials in the variables, and no polynomials",
        From(),
    ] = field(default_factory=list)
    not_contained: Annotated[
        list[str],
        "positions that the equations do not contain: integrals that do are not looked for, and all that is said is "
        "said of those without",
        From("aside"),
    ]
    integrals: Annotated[
        list[Integral],
        "integrals that are no polynomials in those before them, each proved",
        told_apart_by("weight", "name"),
        From("generators"),
    ]


class Integrals(PolynomialBasis, frozen=True, kw_only=True):
    """Polynomial first integrals up to a weighted degree."""

    format: Format = 1
    version: Version = field(default_factory=version)
    system: SystemName
    values: Annotated[dict[str, str], "numbers that were put in for parameters"]
    counts: Annotated[list[Count], "what was counted, weight by weight", told_apart_by("weight")]
    along: Along | None
    cases: Cases | None
    relations: InvariantRelations | None
    darboux: Darboux | None
    darboux_along: DarbouxAlong | None
    zero_levels: Annotated[
        list[ZeroLevel] | None,
        "integrals that hold where one of the list is zero, one item for each that was looked at; null where they "
        "were not asked for, or several unit vectors or angles are related; of equations that are not "
        "quasi-homogeneous for unit vectors of any length",
        told_apart_by("zero"),
    ]
    other_levels: Annotated[
        list[OtherLevel] | None,
        "integrals that hold where another one has a value that is not zero; null where they were not asked for, or "
        "not looked at",
    ]


class Symmetry(Part, frozen=True):
    field: Annotated[dict[str, str], "xi by coordinate or speed, where it is not zero", From("directions")]
    time: Annotated[str, "tau, the shift of time"]
    gauge: Annotated[str, "Gamma, whose time derivative the Lagrangian gains"]
    integral: Annotated[str, "sum xi p + tau H - Gamma, in Python syntax"]
    name: Annotated[
        str, "the integral of problem 7 of which it is a multiple, or of what it is a function; empty for others"
    ]
    new: Annotated[bool, "proved to be no function of those known without it", From("is_new")]
    told_apart: Annotated[
        str, words("proved", "verified numerically", "undecided"), "how it is known what it is", From("certainty")
    ]
    substituted: Annotated[
        str, words("proved", "verified numerically", "undecided"), "how dI/dt = 0 came out by substitution"
    ]


class SymmetryBasis(Part, frozen=True, kw_only=True):
    """symmetries (Noether) with fields of degree one in the positions, and their integrals; null where they outgrew a
    bound
    """

    directions: Annotated[
        Literal["coordinates", "speeds"],
        "what fields move",
        From("in_speeds", lambda in_speeds: "speeds" if in_speeds else "coordinates"),
    ]
    complete: Annotated[
        bool, "proved: every symmetry of this kind is a combination of those listed, for almost all parameters"
    ]
    symmetries: Annotated[list[Symmetry], "a basis, each an identity of the exact ring", told_apart_by("integral")]


class Symmetries(SymmetryBasis, frozen=True, kw_only=True):
    """Symmetries with fields of degree one in the positions and Gamma a polynomial of degree at most two in them, both
    free of the time, and their first integrals.
    """

    format: Format = 1
    version: Version = field(default_factory=version)
    system: SystemName
    values: Annotated[dict[str, str], "numbers that were put in for parameters"]
