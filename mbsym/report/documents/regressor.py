"""``regressor.json`` of ``mbsym regressor``."""

from __future__ import annotations

from typing import Annotated

from mbsym.mechanics.regressor import KINDS
from mbsym.report.documents.base import Hashed, Part, words

Kind = Annotated[str, words(*KINDS), "mass m, first moment h = m c, or a component of the tensor about the origin"]
Body = Annotated[str, "the body, in whose axes it is, about its connection point"]


class Parameter(Part, frozen=True):
    """one of a body's ten parameters"""

    body: Body
    kind: Kind


class Share(Part, frozen=True):
    """one that is added, times a coefficient"""

    body: Body
    kind: Kind
    coefficient: Annotated[str, "in Python syntax"]


class Base(Part, frozen=True):
    """a parameter and what is added to it: the motion tells this sum, and nothing of its parts"""

    body: Body
    kind: Kind
    others: Annotated[list[Share], "what is added"]
    value: Annotated[str, "the sum for the description's bodies, in Python syntax"]


class Regressor(Hashed, frozen=True, kw_only=True):
    """The smallest set of inertial parameters of which generalised forces are made: tau = Y(q, q', q'') base."""

    coordinates: Annotated[list[str], "the rows of Y"]
    standard: Annotated[int, "how many parameters the bodies have, ten each"]
    base: Annotated[list[Base], "the columns of Y in their order"]
    without_effect: Annotated[list[Parameter], "parameters that no motion tells"]
    other_loads: Annotated[bool, "whether there are loads besides uniform gravity, which tau leaves out"]
