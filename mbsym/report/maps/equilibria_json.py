"""The relative equilibria of a system as JSON: everything that the table shows, and the enclosures' midpoints."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from msgspec import UNSET

from mbsym.expressions.tree import text
from mbsym.mechanics.rest import Value
from mbsym.model.quantities import units_by_name
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.equilibria import Equilibria
from mbsym.problems.relative_equilibria.permanent_rotations import PermanentRotations
from mbsym.report.documents import equilibria as doc
from mbsym.report.documents.base import written


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
        permanent_rotations=permanent,
    )
    return written(data)
