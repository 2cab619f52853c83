"""What ``mbsym oscillations --json`` prints, and the periodic solution of problem 12."""

from __future__ import annotations

from typing import Annotated

from msgspec import UNSET, UnsetType, field

from mbsym.problems.small_parameter.result import Amplitude
from mbsym.report.documents.base import ASIDE, Format, From, Part, SystemName, Version, told_apart_by, version


class AmplitudeValue(Part, frozen=True):
    """whether the amplitude is free, and its value or symbol"""

    kind: Annotated[
        Amplitude, "free: any amplitude; determined: certain ones only, in first approximation, of which this is one"
    ]
    value: Annotated[str, "symbol or value"]
    others: Annotated[
        str | UnsetType,
        "what is zero for other amplitudes, if real, at which secular terms are removed, too, and which are left out",
    ] = UNSET


class Constant(Part, frozen=True):
    variable: Annotated[str, "name"]
    value: Annotated[str, "symbol or number"]


class WaveCoefficient(Part, frozen=True):
    order: Annotated[int, "power of the small parameter"]
    formula: Annotated[str, "the coefficient; the phase stands under sin and cos"]


class Solution(Part, frozen=True):
    variable: Annotated[str, "name"]
    residual: Annotated[int | None, "order of the small parameter left in its equation; null: nothing is left"]
    function: Annotated[str, "the whole series; the phase in it is the time times phase_rate"]
    coefficients: Annotated[
        list[WaveCoefficient],
        "coefficients of powers of the small parameter, those that are zero left out",
        told_apart_by("order"),
    ]


class Drift(Part, frozen=True):
    variable: Annotated[str, "name"]
    rates: Annotated[list[str], "coefficients of the mean rate"]
    coefficients: Annotated[
        list[WaveCoefficient],
        "coefficients of powers of the small parameter, those that are zero left out",
        told_apart_by("order"),
    ]


class Resonance(Part, frozen=True):
    variables: Annotated[list[str], "names of variables"]
    harmonic: Annotated[int | list[int], "multiple of the frequency; of several phases the multiple of each"]
    order: Annotated[int, "order in which it first appears"]
    vanishes: Annotated[str, "resonance where this is zero"]
    vanishes_too: Annotated[str | UnsetType, "with damping: resonance only where this is zero, too"] = UNSET


class LeftOut(Part, frozen=True):
    variables: Annotated[list[str], "names of variables"]
    square: Annotated[str, "square of their frequency"]


class Error(Part, frozen=True):
    variable: Annotated[str, "name"]
    errors: Annotated[list[float | None], "the largest at each part; null where there is no motion"]
    order: Annotated[float | None, "log2 of the ratio of the last two that rounding leaves; null: there are none"]


class Measured(Part, frozen=True):
    """errors against motions that begin in the same state, over one period"""

    reason: Annotated[str | UnsetType, "why they were not measured; the other properties are left out then"] = UNSET
    small: Annotated[float | UnsetType, "the small parameter by the description's numbers"] = UNSET
    time: Annotated[float | UnsetType, "the period at the last part"] = UNSET
    parts: Annotated[list[str] | UnsetType, "parts of it at which errors were measured"] = UNSET
    relative: Annotated[
        list[float | None] | UnsetType,
        "at each part, the largest error as a part of the largest value of its variable, of those that are not zero",
    ] = UNSET
    errors: Annotated[list[Error] | UnsetType, "by variable, in scaled variables", told_apart_by("variable")] = UNSET


class CycleExponent(Part, frozen=True):
    """Poincare's exponent of a single cycle of two variables, in its lowest order"""

    power: Annotated[int, "power of the small parameter"]
    value: Annotated[str, "its coefficient"]
    attracts: Annotated[bool | UnsetType, "whether it is negative; left out where signs do not tell"] = UNSET


class FurtherPhase(Part, frozen=True):
    phase: Annotated[str, "what it is called in formulas"]
    leading: Annotated[str, "the variable whose oscillation leads"]
    amplitude: Annotated[str, "symbol or value: what stands before its cosine in that variable"]
    frequency: Annotated[str, "its rate where the small parameter is zero"]
    corrections: Annotated[list[str], "nu_1, nu_2, ... of the rate, frequency (1 + nu_1 eps + ...)"]
    phase_rate: Annotated[str, "its rate: frequency (1 + nu_1 eps + ...)"]


class Oscillation(Part, frozen=True, kw_only=True):
    """a periodic solution in powers of the small parameter"""

    small: Annotated[str, "the small parameter"]
    powers: Annotated[dict[str, int], "power of the small parameter by which a parameter is multiplied"]
    order: Annotated[int, "order of the expansion"]
    leading: Annotated[str, "the variable whose oscillation leads"]
    phase: Annotated[str, "what the phase is called in formulas"]
    amplitude: AmplitudeValue
    exponent: Annotated[CycleExponent | UnsetType, "of a single cycle: how motions near it come closer or part"] = UNSET
    constants: Annotated[
        list[Constant],
        "variables that are constant where the small parameter is zero, and their values at the phase 0",
        told_apart_by("variable"),
    ]
    frequency: Annotated[str, "the rate of the phase where the small parameter is zero"]
    corrections: Annotated[list[str], "nu_1, nu_2, ... of the rate, frequency (1 + nu_1 eps + ...)"]
    phase_rate: Annotated[str, "the rate of the phase: frequency (1 + nu_1 eps + ...)"]
    further_phases: Annotated[
        list[FurtherPhase] | UnsetType, "of a motion with several frequencies, all free", told_apart_by("phase")
    ] = UNSET
    solution: Annotated[
        list[Solution], "the variables as series of trigonometric polynomials", told_apart_by("variable")
    ]
    drifts: Annotated[
        list[Drift],
        "variables that no equation needs, and integrals that were asked for: rates times the time and trigonometric "
        "polynomials, but for the initial value; of integrals all powers of the small parameter",
        told_apart_by("variable"),
    ]
    resonances: Annotated[list[Resonance], "what was divided by"]
    left_out: Annotated[list[LeftOut], "free oscillations that are not in the solution"]
    forced: Annotated[
        list[Annotated[list[str], "names of variables"]],
        "variables with roots that are surely not imaginary: free motions that belong to those are left out",
        From("damped"),
    ]
    with_root_zero: Annotated[
        list[Annotated[list[str], "names of variables"]],
        "variables with a root that is zero: free displacements and drifts that belong to it are left out",
        From("with_zero"),
    ]
    roots_not_found: Annotated[
        list[Annotated[list[str], "names of variables"]],
        "variables some of whose roots were not found: free motions that belong to those are left out",
        From("not_known"),
    ]
    taylor: Annotated[bool, "whether the equations were expanded about the unperturbed motion"]
    conditions: Annotated[
        list[str],
        "what has to be positive for frequency and amplitude to be real and not zero, where the signs of the "
        "parameters do not tell",
    ]
    measured: Annotated[Measured, ASIDE]


class Oscillations(Oscillation, frozen=True, kw_only=True):
    """A periodic solution in powers of a small parameter."""

    format: Format = 1
    version: Version = field(default_factory=version)
    system: SystemName
    values: Annotated[dict[str, str], "numbers that were put in for parameters"]
