"""Problem 3, with constraints and reactions."""

from __future__ import annotations

from collections.abc import Sequence
from operator import itemgetter
from typing import TYPE_CHECKING, Annotated

from msgspec import UNSET, Meta, UnsetType

from mbsym.report.documents.base import BY_COORDINATE, From, Part, words
from mbsym.report.documents.parts import Formula

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.rows import RowName


def _labels(rows: Sequence[RowName]) -> list[str]:
    return [row.label for row in rows]


class ConstraintRow(Part, frozen=True):
    constraint: Annotated[int, "number of the constraint in the description, from 1", From(by=lambda k: k + 1)]
    component: Annotated[int | None, "number of its row, from 1; null where it has one", From(by=lambda k: k or None)]
    kind: Annotated[str, "coincide, parallel, distance, relation, rolling or velocity"]
    holonomic: Annotated[bool, "whether it is given as a relation between coordinates"]
    position: Annotated[Formula | None, "f(q, t), which is zero; null of one that is given by velocities"]
    velocity: Annotated[Formula, "J q' + j, which is zero"]
    independent: Annotated[bool, "whether it is one of the independent rows"]


class RedundantRow(Part, frozen=True):
    row: Annotated[str, "which row", From("name.label")]
    follows_from: Annotated[list[str], "the rows that it follows from", From("from_rows", _labels)]
    known: Annotated[str, words("proved", "verified numerically", "undecided"), "how that is known", From("certainty")]


class Integrability(Part, frozen=True):
    """of the velocity constraints (Frobenius); null where there are none"""

    word: Annotated[str, words("holonomic", "partly", "nonholonomic", "undecided"), "the verdict"]
    growth: Annotated[list[int], "dimensions spanned by the fields, with their first brackets, and so on"]
    kept: Annotated[int | None, "relations between coordinates that follow besides those given"]
    known: Annotated[str, words("proved", "verified numerically", "undecided"), "how that is known", From("certainty")]


class IntegrableAlone(Part, frozen=True):
    row: Annotated[str, "which row"]
    integrable: Annotated[bool | None, "whether it has an integrating factor"]


class Constraints(Part, frozen=True):
    """of a system with constraints: M q'' = f + J^T lambda with J q'' + acceleration = 0"""

    rows: Annotated[list[ConstraintRow], "the rows that say something"]
    jacobian: Annotated[list[list[Formula]], "J, a row for each of rows, a column for each coordinate"]
    acceleration: Annotated[list[Formula], "J' q' + j'"]
    position_rank: Annotated[int, "independent constraints on positions"]
    velocity_rank: Annotated[int, "independent constraints on velocities, derivatives of those on positions included"]
    degrees_of_freedom: Annotated[int, "independent velocities", From("free", len)]
    redundant: Annotated[list[RedundantRow], "rows that follow from others"]
    parameter_conditions: Annotated[
        int, "how many relations between the parameters the constraints on positions demand", From("demanded.count")
    ]
    parameter_relations: Annotated[
        list[Formula],
        "these, as formulas that are zero (verified numerically); empty where they were not recognised",
        From("demanded.relations"),
    ]
    parameters_satisfy_them: Annotated[
        bool | None,
        "whether the given values satisfy them; null where there are none, or not all values are given",
        From("demanded.satisfied"),
    ]
    kept_at_given_values: Annotated[
        bool | None,
        "whether a position that keeps them was found at the given values; null where values are missing",
        From("kept_at_values"),
    ]
    velocity_rank_beside: Annotated[
        int | None,
        "velocity_rank at values of the parameters near the given ones, where it is another; else null",
        From("rank_beside"),
    ]
    integrability: Integrability | None
    integrable_alone: Annotated[
        list[IntegrableAlone], "of each independent velocity constraint by itself (proved; null: undecided)"
    ]
    dependent: Annotated[list[str], "coordinates whose velocities are expressed by the others"]
    independent: Annotated[list[str], "the others, whose velocities are u", From("free")]
    regular_where_not_zero: Annotated[
        Formula | UnsetType,
        "the determinant by which the dependent velocities are solved for",
        From("solved.regular_where"),
    ] = UNSET
    Y: Annotated[
        list[list[Formula]] | UnsetType, "q' = Y u + y0, a row for each coordinate", From("solved.transformation")
    ] = UNSET
    y0: Annotated[list[Formula] | UnsetType, "see Y", From("solved.shift")] = UNSET
    a0: Annotated[list[Formula] | UnsetType, "q'' = Y u' + a0", From("solved.acceleration_shift")] = UNSET


class Embedded(Part, frozen=True):
    """the equations without multipliers, mass_matrix u' = forcing"""

    mass_matrix: Annotated[list[list[Formula]], "Y^T M Y"]
    forcing: Annotated[list[Formula], "Y^T (f - M a0) at q' = Y u + y0"]


class Equations(Part, frozen=True):
    """problem 3: M(q) q'' = f(q, q', t); with speeds of their own M u' = f"""

    mass_matrix: Annotated[list[Annotated[list[Formula], BY_COORDINATE]], "M", BY_COORDINATE]
    forcing: Annotated[list[Formula], "f", BY_COORDINATE]
    speeds: Annotated[list[str] | UnsetType, "the speeds u, in the order of M and f, where they are not q'"] = UNSET
    needed: Annotated[list[Formula] | UnsetType, "of each equation, what the motion needs", BY_COORDINATE] = UNSET
    supplied: Annotated[list[Formula] | UnsetType, "what the loads supply: needed = supplied", BY_COORDINATE] = UNSET
    positions: Annotated[
        dict[str, Formula] | UnsetType,
        "the rates of coordinates and components of unit vectors and quaternions, by name",
    ] = UNSET
    aside: Annotated[list[str] | UnsetType, "those on which no equation depends"] = UNSET
    constraints: Constraints | UnsetType = UNSET
    embedded: Annotated[Embedded | UnsetType, From()] = UNSET


class PerMultiplier(Part, frozen=True):
    row: Annotated[str, "which row"]
    force: Annotated[list[Formula], "its part of the force", Meta(min_length=3, max_length=3)]
    moment: Annotated[list[Formula], "its part of the moment", Meta(min_length=3, max_length=3)]


class Balance(Part, frozen=True):
    """forces of constraints that are in balance with each other: any multiple of them may be added"""

    rows: Annotated[list[str], "whose forces; the first one is left out of the formulas", From(by=_labels)]
    components: Annotated[
        list[int], "what they change and the equations do not determine: 0, 1, 2 of the force, 3, 4, 5 of the moment"
    ]
    force: Annotated[
        list[Formula] | None, "what they add to the force; null where that is long", From("added", itemgetter(0))
    ]
    moment: Annotated[
        list[Formula] | None, "what they add to the moment; null where that is long", From("added", itemgetter(1))
    ]


class Reaction(Part, frozen=True):
    body: Annotated[str, "whose joint"]
    force: Annotated[list[Formula], "without multipliers", Meta(min_length=3, max_length=3)]
    moment: Annotated[list[Formula], "the same of the moment", Meta(min_length=3, max_length=3)]
    per_multiplier: Annotated[list[PerMultiplier], "of each independent row of the constraints, for lambda = 1"]
    undetermined: Annotated[list[Balance], "why components are not determined; empty where all are", From("balances")]
    determined_combinations: Annotated[
        int, "combinations of the undetermined components that are determined all the same", From("combinations")
    ]
