"""A periodic motion as files and sentences.

``orbit.csv`` holds one period: t, coordinates, velocities, as numbers that read back exactly.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite

import numpy as np

from mbsym.expressions.message import Counted, Message
from mbsym.model.quantities import marked, unit_of
from mbsym.numerics.orbits.periodic import Orbit
from mbsym.report.documents import orbit as doc
from mbsym.report.documents.base import file_of
from mbsym.report.runs.trajectory_csv import written
from mbsym.simulation.motions import PeriodicMotion


def orbit_csv(motion: PeriodicMotion) -> str:
    system = motion.scenario.system
    names = ("t", *motion.orbit.names)
    return written([marked(name, unit_of(system, name)) for name in names], [motion.times, *motion.states])


def orbit_json(motion: PeriodicMotion) -> str:
    """The file's text."""
    orbit, system = motion.orbit, motion.scenario.system
    return file_of(
        doc.Orbit,
        system,
        orbit,
        initial=zip(orbit.names, map(float, orbit.state), strict=True),
        repeats=motion.repeats,
        turns={name: float(turn) for name, turn in zip(orbit.names, orbit.turns, strict=True) if turn},
        verified=(orbit.verified, orbit.verifier),
        multipliers=[(float(mu.real), float(mu.imag), float(abs(mu))) for mu in orbit.multipliers],
        trivial=(orbit.trivial, orbit.reasons),
    )


def sentences(motion: PeriodicMotion) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    orbit = motion.orbit
    period, n = f"{orbit.period:.15g}", motion.repeats
    text = "[[period]], in which the motion is run through [[n]] times: it repeats after [[shorter]]"
    shorter = f"{orbit.period / n:.15g}"
    yield Message("period"), Message(text, period=period, n=n, shorter=shorter) if n > 1 else period
    yield Message("motion"), _judged(orbit)
    values = zip(orbit.names, orbit.state, strict=True)
    yield Message("state"), ", ".join(f"{name} = {value:.12g}" for name, value in values)
    if orbit.shifted:
        by = (f"{name} = {orbit.turns[orbit.names.index(name)]:.12g}" for name in orbit.shifted)
        yield Message("shifted by"), ", ".join(by)
    steps = Counted(orbit.steps, "Newton step")
    text = "to [[size]] of the state's size after [[steps]]"
    yield Message("closes"), Message(text, size=f"{orbit.closure:.1e}", steps=steps)
    if isfinite(orbit.verified):
        text = "numerically: by [[method]] the same motion closes to [[size]]"
        yield Message("verified"), Message(text, method=orbit.verifier, size=f"{orbit.verified:.1e}")
    else:
        yield Message("warning"), Message("no other method could verify it")
    listed = ", ".join(_shown(mu) for mu in orbit.multipliers)
    text = "[[values]] (to about [[error]])"
    yield Message("multipliers"), Message(text, values=listed, error=f"{orbit.uncertainty:.0e}")
    for reason in orbit.reasons:
        yield Message("one is 1"), reason.reason


def _judged(orbit: Orbit) -> Message:
    """What the multipliers that are not trivial say; a number is told from 1 if it is farther than its uncertainty."""
    others = np.abs(orbit.others)
    doubt = max(10 * orbit.uncertainty, 1e-9)
    if not len(others):
        return Message("all multipliers are 1 for a reason: they tell nothing of stability")
    largest = float(others[0])
    if largest > 1 + doubt:
        text = "unstable in floating point: a multiplier of size [[size]]; not proved"
        return Message(text, size=f"{largest:.6g}")
    if largest < 1 - doubt:
        text = "neighbouring motions come nearer, in floating point: the largest other multiplier is [[size]]"
        return Message(text, size=f"{largest:.6g}")
    return Message(
        "no multiplier is distinguishable from one on the unit circle or inside: numbers decide nothing "
        "about stability here"
    )


def _shown(mu: complex) -> str:
    if abs(mu.imag) < 1e-12 * (1 + abs(mu)):
        return f"{mu.real:.9g}"
    return f"{mu.real:.6g}{mu.imag:+.6g}i"
