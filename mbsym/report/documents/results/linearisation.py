"""Problem 5, with its matrices of first order."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, UnsetType

from mbsym.report.documents.base import BY_COORDINATE, From, Part, or_null, told_apart_by
from mbsym.report.documents.parts import Formula


class Reduction(Part, frozen=True, kw_only=True):
    """of a system with constraints: what the matrices are about, and what became of the other coordinates"""

    coordinates: Annotated[list[str], "the independent coordinates"]
    speeds: Annotated[list[str], "the coordinates whose velocities are independent: rows and columns of the matrices"]
    dependent_coordinates: Annotated[list[str], "expanded about the motion"]
    dependent_speeds: Annotated[list[str], "the coordinates whose velocities follow"]
    following: Annotated[
        list[str] | UnsetType,
        "felt coordinates whose velocities are dependent: each has an equation of first order of its own",
        From(),
    ] = UNSET
    idle: Annotated[
        list[str], "independent coordinates on which no equation of the speeds depends in the first approximation"
    ]
    rates: Annotated[dict[str, Formula], "velocities of the motion that follow from the constraints"]
    assumed_nonzero: Annotated[list[Formula], "formulas that must not vanish on the motion", From("assumed")]
    leaf: Annotated[
        int | UnsetType,
        "how many relations the velocity constraints keep, which are proved to be integrable; the first "
        "approximation is that on the leaf of the motion",
        From(by=or_null),
    ] = UNSET
    holonomic: Annotated[
        bool,
        "whether there are no more constraints on velocities than on coordinates, or all of these are proved to be "
        "integrable",
    ]


class Matrices(Part, frozen=True, kw_only=True):
    """of M x'' + (D + G) x' + (K + N) x"""

    M: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "mass matrix, symmetric", BY_COORDINATE]
    D: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "damping matrix, symmetric", BY_COORDINATE]
    G: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "gyroscopic matrix, skew", BY_COORDINATE]
    K: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "stiffness matrix, symmetric", BY_COORDINATE]
    N: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "circulatory matrix, skew", BY_COORDINATE]


class LinearSubsystem(Matrices, frozen=True, kw_only=True):
    """a decoupled part, in dimensionless time and the description's notation"""

    coordinates: Annotated[list[str], "its coordinates"]


class Linearisation(Matrices, frozen=True, kw_only=True):
    """problem 5: M x'' + (D + G) x' + (K + N) x = B v, with 0 on the right where there are no inputs; of a system with
    constraints x are the coordinates of the independent speeds
    """

    reduction: Annotated[Reduction | UnsetType, From("about", by=lambda about: about if about.ties else None)] = UNSET
    B: Annotated[
        list[list[Formula]] | UnsetType,
        "input matrix: a column for each of the inputs, where there are any",
        BY_COORDINATE,
        From(),
    ] = UNSET
    subsystems: Annotated[list[LinearSubsystem], "decoupled parts", told_apart_by("coordinates")]
    time: Annotated[Formula, "the time of the subsystems; t is that of the description"]
    notation: Annotated[dict[str, Formula], "the description's symbols and what they stand for"]


class StateSpace(Part, frozen=True):
    """first-order form x' = A x + B v, w = C x + D v of problem 5, in the time t, x, v, w the deviations of states,
    inputs and outputs; for descriptions with inputs or outputs
    """

    states: Annotated[list[str], "coordinates and velocities; under constraints the independent ones"]
    A: Annotated[list[list[Formula]], "a row and a column for each state"]
    B: Annotated[list[list[Formula]], "a row for each state, a column for each input"]
    C: Annotated[list[list[Formula]], "a row for each output, a column for each state"]
    D: Annotated[list[list[Formula]], "a row for each output, a column for each input"]


class FirstOrder(Part, frozen=True):
    """problem 5 in speeds and positions: x' = A x"""

    speeds: Annotated[list[str], "positions and speeds, in the order of x", From("names")]
    values: Annotated[list[Formula], "their values on the motion", BY_COORDINATE]
    A: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "A, in the order of x", BY_COORDINATE]
    relations: Annotated[
        int,
        "zero roots of A that belong to no motion: unit vectors keep their lengths and angles, quaternions their norm",
    ]
