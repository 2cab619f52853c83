"""Problem 11."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mbsym.report.documents.base import From, Part, told_apart_by
from mbsym.report.documents.nonlinear import (
    NUMBER,
    AmplitudeOf,
    Coefficient,
    Degree,
    Determinants,
    Frequencies,
    Kernel,
    SaidOfHigherOrder,
    TheoremOfHigherOrder,
    WhyOpen,
)
from mbsym.report.documents.parts import Formula


class ActionTerm(Part, frozen=True):
    """a coefficient"""

    first: Annotated[int, "number of the one frequency", Meta(ge=1)]
    second: Annotated[int, "number of the other one", Meta(ge=1)]
    coefficient: Annotated[str, NUMBER]


class NormalFormAtValues(Part, frozen=True):
    """at the given values"""

    verdict: SaidOfHigherOrder
    theorem: TheoremOfHigherOrder
    reason: WhyOpen
    frequencies: Frequencies
    actions: Annotated[
        list[ActionTerm],
        "coefficients of products of two actions in the normal form of order 4",
        told_apart_by("first", "second"),
    ]
    determinants: Determinants
    resonances: Annotated[
        list[Annotated[list[int], "k"]], "vectors k with k.w = 0 exactly, w the frequencies without signs"
    ]
    coefficient: Coefficient
    amplitude_of: AmplitudeOf
    along: Kernel
    degree: Degree


class Resonance(Part, frozen=True):
    """a resonance"""

    ratio: Annotated[list[int], "of the frequencies, or of these exchanged"]
    vanishes: Annotated[Formula, "vanishes where it holds"]


class TwoFrequencies(Part, frozen=True):
    """formulas"""

    sum_of_squares: Annotated[Formula, "w1^2 + w2^2", From("trace")]
    product_of_squares: Annotated[Formula, "w1^2 w2^2", From("product")]
    discriminant: Annotated[Formula, "(w1^2 - w2^2)^2"]
    D4: Annotated[Formula, "the determinant of fourth order", From("determinant")]
    D4_vanishes: Annotated[Formula, "its numerator", From("zero")]
    resonances: Annotated[list[Resonance], "resonances of orders 3 and 4", told_apart_by("ratio")]


class Pair(Part, frozen=True):
    """formulas"""

    frequency_squared: Annotated[Formula, "w^2", From("square")]
    coefficient: Annotated[Formula, "a of r' = a r^3"]
    amplitude_of: Annotated[str, "the coordinate whose amplitude r is"]


class NormalForms(Part, frozen=True):
    """problem 11: what terms of higher order decide of the motion"""

    coordinates: Annotated[list[str], "the coordinates that it is about"]
    cyclic: Annotated[
        list[str], "cyclic coordinates, left out: of Hamiltonian systems with their momenta at the unperturbed values"
    ]
    hamiltonian: Annotated[
        bool,
        "whether Lagrange's function gives all forces: none is applied, or they have a generalized potential",
        From("conservative"),
    ]
    generalized_potential: Annotated[
        bool,
        "whether there are applied forces that Lagrange's function takes in (Helmholtz's conditions)",
        From("taken_in"),
    ]
    first_approximation: Annotated[
        str | None,
        "the verdict of problem 6 at the given values, without normal forms and centre manifolds",
        From("first"),
    ]
    at_values: Annotated[NormalFormAtValues | None, "what is decided at the given values; null without numbers"]
    two_frequencies: Annotated[TwoFrequencies | None, "Hamiltonian systems of two frequencies, in parameters"]
    pair: Annotated[Pair | None, "one pair of imaginary roots for all parameters"]
    no_formula: Annotated[
        str,
        "why there is no formula in parameters; empty where there is one, or none is looked for",
        From("no_symbols"),
    ]
