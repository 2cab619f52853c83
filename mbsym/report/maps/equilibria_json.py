"""The relative equilibria of a system as JSON: everything that the table shows, and the enclosures' midpoints."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from msgspec import UNSET

from mbsym.expressions.tree import text
from mbsym.mechanics.rest import Value
from mbsym.model.quantities import units_by_name
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue, Equilibria, RelativeEquilibrium
from mbsym.problems.relative_equilibria.permanent_rotations import PermanentRotations
from mbsym.report.documents import equilibria as doc
from mbsym.report.documents import parts
from mbsym.report.documents.base import written
from mbsym.report.sections.stability import verdict_data


def equilibria_json(
    system: System,
    values: Mapping[str, Value],
    found: Equilibria,
    permanent: PermanentRotations | None = None,
) -> str:
    """One JSON object, keys in a fixed order, the same text for the same input."""
    data = doc.Equilibria.from_result(
        found,
        system=system.name,
        units=units_by_name(system) or UNSET,
        values={name: str(x) if isinstance(x, Fraction) else text(x) for name, x in values.items()},
        equilibria=[_equilibrium(one) for one in found.equilibria],
        singular=[_equilibrium(one) for one in found.singular],
        beyond=[doc.Beyond.from_result(_equilibrium(one), negative=list(one.beyond)) for one in found.beyond],
        families=[
            doc.Family.from_result(
                family,
                angles_of=family.coordinates_of or None,
                sample=[coordinate_value(item) for item in family.sample],
                stability_of_the_sample=verdict_data(family.verdict),
            )
            for family in found.families
        ],
        permanent_rotations=None if permanent is None else _permanent(permanent),
    )
    return written(data)


def _equilibrium(one: RelativeEquilibrium) -> doc.Equilibrium:
    return doc.Equilibrium(
        coordinates=[coordinate_value(item) for item in one.values],
        angles_of=one.coordinates_of or None,
        arbitrary=list(one.free),
        descriptions=one.described,
        proof=one.proof,
        stability=verdict_data(one.verdict),
    )


def _permanent(found: PermanentRotations) -> doc.PermanentRotations:
    return doc.PermanentRotations.from_result(
        found,
        one_parameter_family=found.family,
        one_direction_of_each_line=found.either,
        equations=[
            doc.RotationEquation(constant=constant, linear=linear, quadratic=quadratic)
            for constant, linear, quadratic in zip(found.constant, found.linear, found.quadratic, strict=True)
        ],
    )


def coordinate_value(item: CoordinateValue) -> parts.CoordinateValue:
    return parts.CoordinateValue.from_result(item, value=item.text, number=item.value)
