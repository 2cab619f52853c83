"""Problem 12."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, UnsetType

from mbsym.report.documents.base import ASIDE, Part, told_apart_by
from mbsym.report.documents.expansion import AT_VALUES, Measured, SlowManifold
from mbsym.report.documents.oscillations import Oscillation
from mbsym.report.documents.parts import Formula


class Averaged(Part, frozen=True):
    phase: Annotated[str, "the prescribed quantity, or several with commas"]
    reason: Annotated[
        str | UnsetType, "why there is no effective potential, or why it is withdrawn: by what is measured"
    ] = UNSET
    orders: Annotated[
        dict[str, int] | UnsetType,
        "the powers of eps of the rates and of the amplitudes; all else is taken as of order 1",
    ] = UNSET
    rate: Annotated[str | UnsetType, "its rate, or theirs, taken as large"] = UNSET
    small: Annotated[list[str] | UnsetType, "parameters that are taken as small"] = UNSET
    vibrational: Annotated[Formula | UnsetType, "what the fast phase adds to the potential energy"] = UNSET
    potential: Annotated[
        Formula | UnsetType,
        "the effective potential energy, but for constants; loads without a force function act beside it",
    ] = UNSET
    averaged_motion_at_values: Annotated[str | UnsetType | None, AT_VALUES] = UNSET
    measured: Annotated[Measured | UnsetType, ASIDE] = UNSET


class SmallParameters(Part, frozen=True):
    """problem 12: expansions in small parameters"""

    small: Annotated[str | None, "the small parameter that the description names; null: none"]
    powers: Annotated[dict[str, int], "power of the small parameter by which a parameter is multiplied"]
    slow_manifold: Annotated[SlowManifold[Formula] | None, "the slow integral manifold; null where none was found"]
    no_slow_manifold: Annotated[str, "why none was found; empty where one was, or none was asked for"]
    measured: Annotated[Measured | None, "the error of the flow on the slow manifold; null without one", ASIDE]
    oscillation: Annotated[
        Oscillation | None,
        "the periodic solution near that of the linear part; null: none was found, or none was asked for",
    ]
    no_oscillation: Annotated[str, "why none was found; empty where one was, or none was asked for"]
    averaged: Annotated[
        list[Averaged],
        "effective potentials, one for each prescribed quantity whose rate is a parameter",
        told_apart_by("phase"),
    ]
