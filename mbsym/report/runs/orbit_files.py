"""A periodic motion as files and sentences.

``orbit.csv`` holds one period: t, coordinates, velocities, as numbers that read back exactly.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np

from mbsym.expressions.counting import counted
from mbsym.model.quantities import marked, unit_of
from mbsym.numerics.orbits.periodic import Orbit
from mbsym.report.documents import orbit as doc
from mbsym.report.documents.writer import written as document
from mbsym.report.runs.trajectory_csv import written
from mbsym.simulation.motions import PeriodicMotion
from mbsym.source.meaning import meaning


def orbit_csv(found: PeriodicMotion) -> str:
    system = found.scenario.system
    names = ("t", *found.orbit.names)
    return written([marked(name, unit_of(system, name)) for name in names], [found.times, *found.states])


def orbit_json(found: PeriodicMotion) -> str:
    """The file's text."""
    orbit, system = found.orbit, found.scenario.system
    content = doc.Orbit(
        system=system.name,
        description_sha256=meaning(system),
        initial=dict(zip(orbit.names, map(float, orbit.state), strict=True)),
        period=orbit.period,
        turns={name: float(turn) for name, turn in zip(orbit.names, orbit.turns, strict=True) if turn},
        energy=orbit.energy,
        closure=orbit.closure,
        verified=doc.Verified(closure=orbit.verified if isfinite(orbit.verified) else None, method=orbit.verifier),
        newton_steps=orbit.steps,
        autonomous=orbit.autonomous,
        multipliers=[
            doc.Multiplier(real=float(mu.real), imaginary=float(mu.imag), size=float(abs(mu)))
            for mu in orbit.multipliers
        ],
        uncertainty=orbit.uncertainty,
        determinant=orbit.determinant,
        trivial=doc.Trivial(
            count=orbit.trivial,
            reasons=[doc.Reason(reason=one.reason, moved=one.moved) for one in orbit.reasons],
        ),
        monodromy=[[float(x) for x in row] for row in orbit.monodromy],
    )
    return document(content)


def sentences(found: PeriodicMotion) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    orbit = found.orbit
    yield "period", f"{orbit.period:.15g}"
    yield "state", ", ".join(f"{name} = {value:.12g}" for name, value in zip(orbit.names, orbit.state, strict=True))
    steps = counted(orbit.steps, "Newton step", "Newton steps")
    yield "closes", f"to {orbit.closure:.1e} of the state's size after {steps}"
    if isfinite(orbit.verified):
        yield "verified", f"numerically: by {orbit.verifier} the same motion closes to {orbit.verified:.1e}"
    else:
        yield "warning", "no other method could verify it"
    yield "multiplier", ", ".join(_shown(mu) for mu in orbit.multipliers) + f" (to about {orbit.uncertainty:.0e})"
    for one in orbit.reasons:
        yield "one", f"{one.reason}"
    yield "motion", _judged(orbit)


def _judged(orbit: Orbit) -> str:
    """What the multipliers that are not trivial say; a number is told from 1 if it is farther than its uncertainty."""
    others = np.abs(orbit.others)
    doubt = max(10 * orbit.uncertainty, 1e-9)
    if not len(others):
        return "all multipliers are 1 for a reason: they tell nothing of stability"
    largest = float(others[0])
    if largest > 1 + doubt:
        return f"unstable in floating point: a multiplier of size {largest:.6g}; not proved"
    if largest < 1 - doubt:
        return f"neighbouring motions come nearer, in floating point: the largest other multiplier is {largest:.6g}"
    return "no multiplier is told from the unit circle outwards: numbers decide nothing about stability here"


def _shown(mu: complex) -> str:
    if abs(mu.imag) < 1e-12 * (1 + abs(mu)):
        return f"{mu.real:.9g}"
    return f"{mu.real:.6g}{mu.imag:+.6g}i"
