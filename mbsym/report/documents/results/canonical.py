"""Routh's and Hamilton's equations."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import BY_COORDINATE, From, Part
from mbsym.report.documents.parts import Formula


class Routh(Part, frozen=True):
    """problem 3 in Routh's form, where it was asked for: M_R s'' = f_R"""

    ignored: Annotated[list[str], "the cyclic coordinates c, without force, that are left out"]
    momenta: Annotated[list[str], "the names of their momenta beta, which are constants"]
    coordinates: Annotated[list[str], "the other coordinates s, in the order of M_R and f_R"]
    function: Annotated[Formula, "Routh's function R = L - beta.c', without c'"]
    mass_matrix: Annotated[list[list[Formula]], "M_R"]
    linear: Annotated[list[Formula], "b of R = 1/2 s'.M_R s' + b.s' - W"]
    reduced_potential: Annotated[Formula, "W"]
    forcing: Annotated[list[Formula], "f_R"]
    ignored_rates: Annotated[list[Formula], "c'"]


class Hamilton(Part, frozen=True):
    """problem 3 in Hamilton's form, where it was asked for"""

    momenta: Annotated[list[str], "the names of the momenta p, in the order of the coordinates"]
    momenta_in_velocities: Annotated[list[Formula], "p = dL/dq'", BY_COORDINATE]
    hamiltonian: Annotated[Formula, "Hamilton's function H(q, p, t)"]
    velocities: Annotated[list[Formula], "q' = dH/dp", BY_COORDINATE]
    rates: Annotated[list[Formula], "p' = -dH/dq + Q", BY_COORDINATE]


class Brackets(Part, frozen=True):
    """the first integrals of problem 7 in momenta"""

    integrals: Annotated[list[str], "their names", From("names")]
    formulas: Annotated[list[Formula], "F_i(q, p, t)"]
    matrix: Annotated[list[list[Formula]], "their Poisson brackets"]
    in_involution: Annotated[bool | None, "whether all brackets are zero; null where that is not decided"]
