"""What is told of parameters and inputs: ``groups``, ``trim``, ``inverse`` with ``--json``, and ``regressor.json``."""

from __future__ import annotations

from typing import Annotated

from mbsym.mechanics.regressor import KINDS
from mbsym.report.documents.base import From, Hashed, Head, Part, words


class SignDemand(Part, frozen=True):
    """a demand: the value, in relation to 0"""

    name: Annotated[str, "the parameter whose sign is declared"]
    value: Annotated[str, "its value, in Python syntax"]
    relation: Annotated[str, words(">", ">=", "<", "<=", "!="), "how it has to stand to 0"]


class Trim(Head, frozen=True, kw_only=True):
    """Inputs or parameters with which the described motion satisfies the equations; formulas in Python syntax."""

    possible: Annotated[bool, "whether there are such values", From("impossible", lambda never: not never)]
    solved: Annotated[dict[str, str], "values in terms of the free ones, by name"]
    free: Annotated[list[str], "those that may have any value"]
    nonzero: Annotated[list[str], "what was divided by: all this holds where none of it vanishes", From("assumed")]
    conditions: Annotated[list[str], "what has to vanish besides, whatever the values are"]
    signed: Annotated[list[SignDemand], "what the declared signs demand of the values"]


class Inverse(Head, frozen=True, kw_only=True):
    """The inputs with which the coordinates move as given, in the units of the description."""

    exact: Annotated[bool, "whether they give this motion, but for rounding; else the nearest by least squares"]
    left: Annotated[float | None, "what is left of the equations at most, as a part of the size of their terms"]
    unique: Annotated[bool, "whether no other inputs do the same at any of the times; else these are the smallest"]
    times: Annotated[list[float], "the times"]
    inputs: Annotated[dict[str, Annotated[list[float], "its value at each time"]], "the inputs, by name"]


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


class Parameter(Part, frozen=True):
    """one of a body's ten parameters"""

    body: Annotated[str, "the body, in whose axes it is, about its connection point"]
    kind: Annotated[str, words(*KINDS), "mass m, first moment h = m c, or a component of the tensor about the origin"]


class Share(Parameter, frozen=True):
    """one that is added, times a coefficient"""

    coefficient: Annotated[str, "in Python syntax"]


class Base(Parameter, frozen=True):
    """a parameter and what is added to it: the motion tells this sum, and nothing of its parts"""

    others: Annotated[list[Share], "what is added"]
    value: Annotated[str, "the sum for the description's bodies, in Python syntax"]


class Regressor(Hashed, frozen=True, kw_only=True):
    """The smallest set of inertial parameters of which generalised forces are made: tau = Y(q, q', q'') base."""

    coordinates: Annotated[list[str], "the rows of Y"]
    standard: Annotated[int, "how many parameters the bodies have, ten each"]
    base: Annotated[list[Base], "the columns of Y in their order"]
    without_effect: Annotated[list[Parameter], "parameters that no motion tells"]
    other_loads: Annotated[bool, "whether there are loads besides uniform gravity, which tau leaves out"]
    constraints: Annotated[
        bool, "whether there are constraints: tau + J^T lambda = Y base, and fewer sums may be enough"
    ]
