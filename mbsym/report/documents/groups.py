"""What ``mbsym groups --json`` prints."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import Head, Part

Powers = Annotated[dict[str, str], "exponents of units, by name"]


class Group(Part, frozen=True):
    """a parameter times a product of powers of units"""

    parameter: Annotated[str, "the parameter; of lengths the coordinate"]
    powers: Powers


class Groups(Head, frozen=True, kw_only=True):
    """The dimensionless groups of the equations: of their parameters no more than these matters."""

    free: Annotated[list[str], "parameters that occur and follow from no others"]
    idle: Annotated[list[str], "parameters that do not occur"]
    units: Annotated[list[str], "parameters that are set to 1"]
    singly: Annotated[list[str], "units that stand in no group: they change the clock, or all forces alike"]
    groups: Annotated[list[Group], "what is left"]
    rate: Annotated[Powers | None, "by which product 1/t is measured then; null where nothing gives a time"]
    lengths: Annotated[list[Group], "by which products coordinates are that are no angles"]
    unused: Annotated[int, "further scalings, for which no parameter is left that is known to be positive"]
