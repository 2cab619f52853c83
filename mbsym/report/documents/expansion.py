"""What ``mbsym expand --json`` prints, and the slow manifold of problem 12."""

from __future__ import annotations

from typing import Annotated, Generic, TypeVar

from msgspec import UNSET, UnsetType, field

from mbsym.problems.small_parameter.result import Choice, Outcome
from mbsym.report.documents.base import ASIDE, Format, Head, Part, SystemName, Version, told_apart_by, version

#: Text, or in results.json text or its length.
F = TypeVar("F")


class Coefficient(Part, Generic[F], frozen=True):
    order: Annotated[int, "power of the small parameter"]
    formula: Annotated[F, "in Python syntax"]


class FastVariable(Part, Generic[F], frozen=True):
    variable: Annotated[str, "name of the variable"]
    residual: Annotated[
        int | None, "order of what is left when it is put into the equations at a random rational state; null: nothing"
    ]
    coefficients: Annotated[
        list[Coefficient[F]], "coefficients that are not zero, by powers of the small parameter", told_apart_by("order")
    ]


class SlowVariable(Part, Generic[F], frozen=True):
    variable: Annotated[str, "name of the variable"]
    coefficients: Annotated[
        list[Coefficient[F]], "coefficients that are not zero, by powers of the small parameter", told_apart_by("order")
    ]


class Hurwitz(Part, Generic[F], frozen=True):
    """the roots of the fast variables"""

    outcome: Annotated[Outcome, "whether all roots have negative real parts for all sufficiently small positive values"]
    positive: Annotated[list[F], "what has to be positive for that"]
    nonzero: Annotated[list[F], "what must not vanish for that"]
    polynomial: Annotated[
        list[
            Annotated[
                list[Coefficient[F]],
                "coefficients that are not zero, by powers of the small parameter",
                told_apart_by("order"),
            ]
        ],
        "characteristic polynomial, from the highest power down; what follows from the order of the expansion",
    ]


class Steady(Part, Generic[F], frozen=True):
    """the first approximation about the unperturbed motion"""

    zeros: Annotated[int, "roots that are exactly zero"]
    divided_up_to: Annotated[int, "up to this order the polynomial of the flow is seen to divide that of all variables"]
    attracts: Hurwitz[F]
    flow: Annotated[Hurwitz[F], "the roots of the flow on the manifold but those that are zero"]
    free: Annotated[
        list[str],
        "variables that may have any values while the others keep theirs: then the state is steady; as many as roots "
        "are zero, or none",
    ]
    stabilizable: Annotated[
        Outcome | None,
        "whether this set of steady states is asymptotically stable with respect to the other variables and disturbed "
        "motions tend to its points (Rumyantsev), under the conditions of attracts and flow; null: no set is seen",
    ]


class Measured(Part, frozen=True):
    """the error measured against a simulation, in two digits: at eps, eps/2 and eps/4"""

    reason: Annotated[str | UnsetType, "why it was not measured; the other properties are left out then"] = UNSET
    time: Annotated[float | UnsetType, "how long the motions were compared"] = UNSET
    parts: Annotated[list[str] | UnsetType, "of the given eps"] = UNSET
    distances: Annotated[list[float] | UnsetType, "largest distances as a part of the size"] = UNSET
    orders: Annotated[list[float] | UnsetType, "log2 of their ratios"] = UNSET
    expected: Annotated[int | UnsetType, "the order that is expected where eps is small enough"] = UNSET


class Roots(Part, Generic[F], frozen=True, kw_only=True):
    """solutions of the lowest order for the fast variables, where there are several"""

    chosen: Annotated[Choice, "which of them the expansion begins with"]
    others: Annotated[list[dict[str, F]], "the fast variables at the others"]
    unknown: Annotated[int, "how many need other roots than the one square root that is adjoined"]
    positive: Annotated[list[F], "what stands under the square root and is positive where it is real"]


class SlowManifold(Part, Generic[F], frozen=True, kw_only=True):
    """the slow integral manifold"""

    small: Annotated[str, "the small parameter"]
    powers: Annotated[dict[str, int], "power of the small parameter by which a parameter is multiplied"]
    order: Annotated[int, "order of the expansion"]
    provided_nonzero: Annotated[list[F], "what was divided by: the expansion holds where these are not zero"]
    manifold: Annotated[
        list[FastVariable[F]], "the fast variables as functions of the slow ones", told_apart_by("variable")
    ]
    flow: Annotated[
        list[SlowVariable[F]], "derivatives of the slow variables on the manifold", told_apart_by("variable")
    ]
    roots: Roots[F] | UnsetType = UNSET
    missing: Annotated[str | UnsetType, "why nothing is said of a steady state"] = UNSET
    steady: Steady[F] | UnsetType = UNSET


class Expansion(SlowManifold[str], frozen=True, kw_only=True):
    """A slow integral manifold in powers of a small parameter."""

    format: Format = 1
    version: Version = field(default_factory=version)
    system: SystemName
    values: Annotated[dict[str, str], "numbers that were put in for parameters"]
    measured: Annotated[Measured, ASIDE]


#: Of the field ``averaged_motion_at_values``.
AT_VALUES = "verdict of problem 6 on the averaged motion at the given values; null where there is none"


class Average(Head, frozen=True, kw_only=True):
    """The effective potential of a system that is shaken fast, and how good it is; formulas in Python syntax."""

    phases: Annotated[list[str], "the fast phases"]
    rates: Annotated[list[str], "their rates, of order 1/eps"]
    orders: Annotated[dict[str, int], "powers of eps of the amplitudes; all else is taken as of order 1"]
    vibrational: Annotated[str, "what the phases add to the potential energy"]
    potential: Annotated[str, "the effective potential energy, but for constants"]
    beside: Annotated[list[str], "coordinates on which forces act that have no part in it, and act as they did"]
    averaged_motion_at_values: Annotated[str | None, AT_VALUES]
    measured: Annotated[Measured, ASIDE]
