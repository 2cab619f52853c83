"""Extremes of systems with constraints: equations with their rows, and states that satisfy them all.

A rung is led to the constraints by the shortest way (``mbsym.numerics.closing``): after lengths were changed loops are
closed anew, after velocities were changed they satisfy J q' + j = 0.  A rung that no state of the constraints is near
to is left out, and told.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.mechanics.constraints.dynamics import ConstrainedDynamics, constrained_dynamics
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.extremes.singular import Singularities, SingularSet
from mbsym.numerics.extremes.singular_positions import SingularPosition, SingularPositions
from mbsym.numerics.kernels import arrays
from mbsym.numerics.probes import DISTANCES, SINGULAR, Ladder, Probe
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.scene_units import SceneUnits

#: Directions in which a singular position is left, until one leads along the constraints; how far a rung may be from
#: where it was meant, as a factor.
DIRECTIONS, ABOUT = 12, 4.0

#: Of the positions that were found so many are approached, down to this distance.
MOST_APPROACHED, LEAST = 3, 1e-8


def equations(given: Scenario, ring: Ring) -> ConstrainedDynamics | None:
    """The equations with the rows of the scenario's branch; None without constraints."""
    known = Dynamics(given, ring).constraints
    return None if known is None else constrained_dynamics(given.system, ring, known.chosen)


def on_constraints(ladder: Ladder, left_out: list[str]) -> Ladder | None:
    """The ladder with states on the constraints; None where none of its rungs has one.

    A coordinate that approaches a value keeps that, as far as it can; what is left out is added to ``left_out``.
    """
    moving, arrow, _ = ladder.subject.partition(" -> ")
    fixed = (moving,) if ladder.kind == SINGULAR and arrow else ()
    probes, missing = [], []
    for probe in ladder.probes:
        state = _led(probe.scenario, probe.state, fixed)
        if state is None:
            missing.append(f"{probe.size:.0e}")
        else:
            probes.append(replace(probe, state=state))
    if missing:
        text = "[[ladder]] [[sizes]]: no state of the constraints was found there"
        left_out.append(Message(text, ladder=ladder.title, sizes=", ".join(missing)))
    return replace(ladder, probes=tuple(probes)) if probes else None


def _led(scenario: Scenario, state: tuple[Fraction, ...], fixed: tuple[str, ...] = ()) -> tuple[Fraction, ...] | None:
    n = len(scenario.system.coordinates)
    meant = replace(scenario, positions=state[:n], velocities=state[n:], unstated=())
    try:
        return closed(meant, fixed).scenario.state
    except (Failure, np.linalg.LinAlgError):
        return None


#: Below this part of the largest a kinetic energy of what the constraints allow counts as none.
NO_MASS = 1e-9


def positive_there(given: Scenario, where: Singularities, units: SceneUnits) -> tuple[bool | None, ...]:
    """Of every set at which M of the tree is singular, whether M is positive on what the constraints allow.

    At the first of its places, led to the constraints with the coordinates of the set held; None where no state of the
    constraints is found there.  By singular values in float64, lengths and angles in the units of the scene.
    """
    return tuple(_positive(given, one, units) for one in where.sets)


def _positive(given: Scenario, one: SingularSet, units: SceneUnits) -> bool | None:
    names, n = given.system.coordinates, len(given.system.coordinates)
    held = tuple(name for name in one.names if name in names)
    if not held or any(name not in names for name in one.names):
        return None
    values = dict(zip(names, given.positions, strict=True)) | dict(one.places[0])
    state = _led(given, (*(values[name] for name in names), *given.velocities), held)
    if state is None:
        return None
    at = np.array([float(x) for x in state])
    dynamics = Dynamics(given)
    known = dynamics.constraints
    assert known is not None
    sizes = np.array([float(x) for x in units.sizes])
    masses = arrays.kernel(dynamics.mass_matrix)(np.concatenate(([0.0], at))).reshape(n, n) * np.outer(sizes, sizes)
    rows = known.at(0.0, at).partials * sizes
    lengths = np.linalg.norm(rows, axis=1)
    _, values_, turned = np.linalg.svd(rows / np.where(lengths > 0, lengths, 1.0)[:, None])
    free = turned[int(np.sum(values_ > NO_MASS)) :].T
    if not free.size:
        return True
    # Each direction by the mass that its coordinates have by themselves.
    weights = np.sqrt(np.maximum(np.diag(masses), np.max(np.diag(masses)) * 1e-12))
    masses = masses / np.outer(weights, weights)
    free = np.linalg.qr(weights[:, None] * free)[0]
    energies = np.linalg.eigvalsh(free.T @ masses @ free)
    return bool(energies[0] > NO_MASS * energies[-1])


def approaches(given: Scenario, found: SingularPositions, units: SceneUnits) -> Iterator[Ladder]:
    """One ladder for each of the first positions, along the constraints; none where no way out of it is found."""
    for one in found.found[:MOST_APPROACHED]:
        probes = _approach(given, one, units)
        if probes:
            yield Ladder(SINGULAR, f"distance from {one.text}", tuple(probes))


def _approach(given: Scenario, one: SingularPosition, units: SceneUnits) -> list[Probe]:
    names, n = given.system.coordinates, len(given.system.coordinates)
    place, sizes = np.array([one.place[name] for name in names]), np.array([float(x) for x in units.sizes])
    source = np.random.default_rng(7)
    velocities = given.velocities if any(given.velocities) else units.velocities
    for _ in range(DIRECTIONS):
        way = source.normal(size=n)
        probes: list[Probe] = []
        for size in (x for x in DISTANCES if x >= LEAST):
            aimed = place + size * sizes * way / np.linalg.norm(way)
            state = _led(given, (*map(Fraction, aimed.tolist()), *velocities))
            if state is None:
                continue
            away = float(np.linalg.norm((np.array([float(x) for x in state[:n]]) - place) / sizes))
            if size / ABOUT < away < size * ABOUT:
                probes.append(Probe(size, given, state))
                way = _direction(state[:n], place, sizes)
        if len(probes) > 2:
            return probes
    return []


def _direction(position: Any, place: Any, sizes: Any) -> Any:
    return (np.array([float(x) for x in position]) - place) / sizes
