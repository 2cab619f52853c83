"""Problem 8."""

from __future__ import annotations

from typing import Annotated

from msgspec import Meta

from mbsym.report.documents.base import From, Part, told_apart_by, words
from mbsym.report.documents.parts import Formula, Verdict


class Relation(Part, frozen=True):
    """formula relation 0"""

    formula: Annotated[Formula, "compared with 0"]
    relation: Annotated[str, words(">", "<", "!="), "relation to 0"]


class Region(Part, frozen=True):
    """a region"""

    where: Annotated[list[Relation], "inequalities that bound it", From("signs")]
    degree: Annotated[int, "how many eigenvalues of K are negative there", Meta(ge=0)]


class Gyroscopic(Part, frozen=True):
    """a subsystem"""

    coordinates: Annotated[list[str], "the coordinates that it is about"]
    zero_eigenvalues: Annotated[int, "eigenvalues of K that vanish for all parameters", Meta(ge=0), From("free")]
    regions: Annotated[list[Region], "regions of parameters; none where they were not found"]


class BundleEnergy(Part, frozen=True):
    """a subsystem"""

    coordinates: Annotated[list[str], "the coordinates that it is about"]
    conserved: Annotated[bool, "whether D = 0"]
    definite: Annotated[bool | None, "whether K > 0: proved, refuted, or null: it depends"]
    minors: Annotated[list[Formula], "that have to be positive for it, known ones left out"]
    definite_at_values: Annotated[bool | None, "whether K > 0 at the given values", From("at_values")]
    bundle_at_values: Annotated[
        list[str] | None,
        "rational weights of a positive definite combination of the integrals V(x), V(x'), ...; null where none was "
        "looked for or found",
        From("bundle"),
    ]


class Lost(Part, frozen=True):
    """where a rank is lost"""

    where_one_vanishes: Annotated[list[Formula], "it is lost where one of them vanishes", From("factors")]
    where_all_vanish: Annotated[
        list[Formula], "elsewhere only where all of them vanish at once; nowhere where there are none", From("together")
    ]
    provided_nonzero: Annotated[list[Formula], "nothing is said where one of these vanishes", From("provided")]


class Rank(Part, frozen=True):
    """whether the rank is full for all lambda, for almost all parameters"""

    full: Annotated[bool, "whether it is"]
    sure: Annotated[str, words("proved", "undecided"), "how that is known", From("certainty")]
    roots_without: Annotated[
        list[Annotated[list[Formula], "coefficients"]],
        "polynomials at whose roots the rank is lost at all parameters, coefficients from low to high powers of lambda",
        From("factors"),
    ]
    lost: Annotated[Lost | None, "at which parameters it is lost; null where that was not found", From("locus")]
    why_not: Annotated[str, "why something was not found; empty where nothing is missing"]


class Undamped(Part, frozen=True):
    """a motion"""

    minus_lambda_squared: Annotated[Formula, "-lambda^2", From("square")]
    shape: Annotated[list[Formula] | None, "along which vector; null where that was not found"]


class Dissipation(Part, frozen=True):
    """a subsystem"""

    coordinates: Annotated[list[str], "the coordinates that it is about"]
    complete: Annotated[bool | None, "whether D > 0: true proved, false refuted, null not known"]
    semidefinite: Annotated[bool | None, "whether D >= 0: true proved, false refuted, null not known"]
    rank: Rank
    undamped: Annotated[list[Undamped], "motions that it does not feel", From("motions")]
    pervasive_at_values: Annotated[
        bool | None, "whether every motion but rest is felt at the given values", From("at_values")
    ]


class Control(Part, frozen=True):
    """a part"""

    coordinates: Annotated[list[str], "the coordinates that it is about"]
    inputs: Annotated[list[str], "the inputs"]
    rank: Rank
    controllable_at_values: Annotated[bool | None, "by Kalman's rank at the given values", From("at_values")]
    stabilisable_at_values: Annotated[bool | None, "whether what is out of reach decays at the given values"]


class Feedback(Verdict, frozen=True):
    """a feedback"""

    states: Annotated[list[str], "z of u = -k z: coordinates, then velocities, those left out that others determine"]
    of_part: Annotated[str, "why the states are those of some coordinates only; empty where they are of all"]
    gains: Annotated[list[Annotated[list[Annotated[str, "a rational number"]], "a row"]], "k, a row for each input"]
    characteristic_polynomial: Annotated[
        list[str],
        "of the closed loop, from low to high powers, rational numbers; empty where values are irrational",
        From("characteristic"),
    ]
    lyapunov: Annotated[
        list[list[str]] | None,
        "rational symmetric P of a Lyapunov function z.P z of the closed loop; null where none was found",
    ]


class Stabilisation(Part, frozen=True):
    """problem 8: what may stabilise the motion, and what stands against it"""

    gyroscopic: Annotated[
        list[Gyroscopic],
        "degrees of instability of K, subsystem by subsystem, where there are no circulatory forces",
        told_apart_by("coordinates"),
    ]
    energies: Annotated[
        list[BundleEnergy],
        "energies of the linear equations as Lyapunov functions",
        told_apart_by("coordinates"),
        From("energy"),
    ]
    dissipation: Annotated[list[Dissipation], "what D feels, subsystem by subsystem", told_apart_by("coordinates")]
    control: Annotated[
        list[Control], "controllability of the whole system, then of its subsystems", told_apart_by("coordinates")
    ]
    least_inputs: Annotated[
        list[Annotated[list[str], "a set"]],
        "the smallest sets of inputs that suffice for almost all parameters",
        From("least"),
    ]
    feedback: Annotated[Feedback | None, "a linear feedback u = -k z at the given values, proved to stabilise"]
    no_feedback: Annotated[str, "why there is none; empty where there is one"]
    left_out: Annotated[list[str], "coordinates of which independent equations under constraints know nothing"]
