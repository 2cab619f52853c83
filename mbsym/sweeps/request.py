"""What a sweep is asked for, as plain data that another machine can read, and the measure that it means."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

from mbsym.analysis import Analysis
from mbsym.expressions.tree import Expression, number, text
from mbsym.maps.section import Axis, Section, section
from mbsym.model.system import System
from mbsym.numerics.scenario import scenario
from mbsym.sweeps.points import Measure, Points

STABILITY, EIGENVALUES, DAMPING, FREQUENCY = "stability", "eigenvalues", "damping", "frequency"
#: What is measured by name; anything else is a formula.
MEASURES = (STABILITY, EIGENVALUES, DAMPING, FREQUENCY)


@dataclass(frozen=True)
class Asked:
    """``ends``: the interval in which each varied name lies; ``settings``: numbers in place of the description's.

    ``measure`` is one of ``MEASURES``, or "" where ``formula`` is measured: at the parameters, or with a ``time`` along
    the motion.
    """

    points: Points
    ends: Mapping[str, tuple[Fraction, Fraction]]
    settings: Mapping[str, Fraction]
    measure: str
    formula: Expression | None = None
    time: float | None = None

    @property
    def name(self) -> str:
        """What is measured, in words."""
        if self.formula is None:
            return self.measure
        return text(self.formula) if self.time is None else f"simulate:{text(self.formula)} to t = {self.time:.12g}"

    def digest(self, described: str, version: str) -> str:
        """SHA-256 of everything that the numbers follow from: description (its digest), version, request."""
        told = repr((described, version, self.points, sorted(self.ends.items()), sorted(self.settings.items())))
        return hashlib.sha256((told + self.name + repr(self.time)).encode()).hexdigest()


def measure_of(system: System, asked: Asked) -> Measure:
    """The measure, derived and compiled.

    Raises Unfit (with all complaints) where the parameters fit no section, Failure where it cannot be derived.
    """
    if asked.time is not None and asked.formula is not None:
        from mbsym.sweeps.simulated import SimulatedMeasure

        overrides = {name: number(value) for name, value in asked.settings.items()}
        given, said = scenario(system, overrides, assumed=False), text(asked.formula)
        return SimulatedMeasure(given, overrides, asked.points.names, asked.formula, said, asked.time)
    analysis = Analysis(system)
    axes = [Axis(name, *asked.ends[name]) for name in asked.points.names]
    found = section(analysis, axes, asked.settings)
    if asked.formula is not None:
        from mbsym.sweeps.formula import FormulaMeasure

        return FormulaMeasure(found, asked.formula, text(asked.formula))
    if asked.measure == STABILITY:
        from mbsym.sweeps.judged import StabilityMeasure

        return StabilityMeasure(analysis, found)
    from mbsym.sweeps import roots

    kinds: dict[str, Callable[[Section, str], Measure]] = {
        EIGENVALUES: roots.RootsMeasure,
        DAMPING: roots.DampingMeasure,
        FREQUENCY: roots.FrequencyMeasure,
    }
    scale = analysis.system.time_scale
    return kinds[asked.measure](found, "the description's unit of 1/time" if scale is None else text(scale))
