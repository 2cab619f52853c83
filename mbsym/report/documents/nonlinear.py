"""What ``mbsym nonlinear --json`` prints."""

from __future__ import annotations

from typing import Annotated

from mbsym.problems.normal_forms.result import Outcome, Theorem, Why
from mbsym.problems.stability.words import Word
from mbsym.report.documents.base import Format, From, Part, told_apart_by, words

NUMBER = "a number: exactly where it is rational, else an enclosure, [mid +/- radius]"


class Determinant(Part, frozen=True):
    """a determinant"""

    order: Annotated[int, words(4, 6), "4 or 6"]
    value: Annotated[str, NUMBER]


#: What is decided at a point, field by field: files have them in orders of their own.
SaidOfHigherOrder = Annotated[Outcome, "what is said of the nonlinear system", From("outcome")]
TheoremOfHigherOrder = Annotated[Theorem, "the theorem behind it; empty where none applies"]
WhyOpen = Annotated[Why, "why nothing, or no more, is decided; empty where that is not so", From("why")]
Frequencies = Annotated[list[Annotated[str, NUMBER]], "of Hamiltonian systems with the signs of their energies"]
Determinants = Annotated[list[Determinant], "D_4, and D_6 where it was needed", told_apart_by("order")]
Coefficient = Annotated[
    str | None,
    "a of r' = a r^3, or a r^degree, on the centre manifold of one pair of imaginary roots; of a zero root the first "
    "coefficient that "
    "is not zero; of equal frequencies delta A of Sokolskii's normal form; of a zero root of a Hamiltonian system a of "
    "the energy a x^M along its direction",
]
AmplitudeOf = Annotated[str, "the coordinate whose amplitude r is; empty without such a pair"]
Kernel = Annotated[
    str, "of a zero root of a Hamiltonian system the coordinate x of the energy a x^M along its direction; else empty"
]
Degree = Annotated[int | None, "M of that energy, or the power of the amplitude, where it is not the third"]


class ExceptionalValue(Part, frozen=True):
    """an exceptional value"""

    value: Annotated[str, "the number, rational or in decimals"]
    enclosure: Annotated[str, "an enclosure, [mid +/- radius]"]
    root_of: Annotated[
        list[str], "whole coefficients of the irreducible polynomial that it is a root of, from the constant one on"
    ]
    vanishing: Annotated[list[str], "what is zero there"]
    verdict: Annotated[
        str,
        words(*(x.value for x in Outcome), *(x.value for x in Word if not x.open)),
        "what is said of the nonlinear system: in problem 6's words where terms of higher order leave it open",
        From("outcome"),
    ]
    theorem: Annotated[str, "the theorem behind it; empty where none applies"]
    reason: WhyOpen
    frequencies: Frequencies
    determinants: Determinants
    coefficient: Coefficient
    amplitude_of: AmplitudeOf
    along: Kernel
    degree: Degree


class Between(Part, frozen=True):
    """an open interval"""

    sample: Annotated[str, "a rational number in it"]
    verdict: SaidOfHigherOrder
    theorem: TheoremOfHigherOrder
    reason: WhyOpen
    frequencies: Frequencies
    determinants: Determinants
    coefficient: Coefficient
    amplitude_of: AmplitudeOf
    along: Kernel
    degree: Degree


class Nonlinear(Part, frozen=True, kw_only=True):
    """All values of a parameter at which terms of higher order decide otherwise than beside them."""

    format: Format = 1
    system: Annotated[str, "its name"]
    parameter: Annotated[str, "the parameter that is varied"]
    low: Annotated[str, "lower end of the open interval, a rational number"]
    high: Annotated[str, "upper end of the open interval, a rational number"]
    hamiltonian: Annotated[
        bool, "whether no force is applied beside the force function, or only one that has a generalized potential"
    ]
    coordinates: Annotated[list[str], "the coordinates that it is about"]
    cyclic: Annotated[list[str], "cyclic coordinates, left out"]
    values: Annotated[list[ExceptionalValue], "the exceptional values, upwards", told_apart_by("root_of", "value")]
    between: Annotated[
        list[Between], "what holds below the first of them, between neighbours, above the last: one entry more"
    ]
