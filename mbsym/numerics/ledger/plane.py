"""Motion in a plane that no coordinates show: found along the motion, told, and not used.

All motion is normal to e where, for every body with inertia, omega_k = w_k e, and V_C.e = 0 for every mass centre.  The
direction is that of the angular velocities, or normal to the velocities where no body has inertia.  That it stays so is
seen at the times of a run, not proved.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message
from mbsym.model.system import rational
from mbsym.numerics.body_motion import BodyMotions, body_motions
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.ledger.entry import COUNT, Measure, Saving
from mbsym.numerics.ledger.work import Work
from mbsym.numerics.methods.interface import Breakdown, Setting
from mbsym.numerics.planning.choice import choose
from mbsym.numerics.planning.kinds import SKEW
from mbsym.numerics.rows import rows

#: The run's tolerance, the times at which it is looked at, and the part of the motion that may be out of the plane.
TIGHT, TIMES, FLAT = 1e-12, 201, 1e-8

#: A direction is a coordinate axis where no other component is larger; the plane is then one of the coordinates'.
ALONG = 1e-6


def skew_plane(work: Work) -> Iterator[Saving]:
    """Motion normal to a direction that is no axis of inertial space, until the time of the accuracy asked for."""
    if work.wanted is None or work.scenario is None:
        return
    work.begin(work.price)
    dynamics = Dynamics(work.scenario)
    times = np.linspace(0.0, work.wanted.time, TIMES)
    try:
        states = rows(choose(dynamics, TIGHT, work.wanted.time).method, dynamics, Setting(TIGHT), times).states
        rates = arrays.kernel(dynamics.right_hand_side)(np.vstack([times, states]))[dynamics.size :]
        found = body_motions(work.scenario, times, states, rates)
    except (Breakdown, Failure):
        return
    turning, moving = _kinds(work, found)
    e, off = plane_of(found, turning, moving)
    if e is None or np.sum(np.abs(e) > ALONG) < 2:
        return
    direction = ", ".join(f"{x:.6g}" for x in e)
    why = Message(
        "at [[times]] times until [[time]] all angular velocities are along ([[direction]]) of "
        "inertial space and all velocities normal to it, but for [[part]] of them; told, not "
        "used: mbsym simulate integrates all coordinates",
        times=TIMES,
        time=f"{work.wanted.time:g}",
        direction=direction,
        part=f"{off:.0e}",
    )
    measures = (
        Measure(
            "components of velocities and angular velocities",
            COUNT,
            3 * sum(turning) + 3 * sum(moving),
            sum(turning) + 2 * sum(moving),
        ),
    )
    names = tuple(name for name, a, b in zip(found.names, turning, moving, strict=True) if a or b)
    yield Saving(SKEW, names, why, Certainty.VERIFIED, measures)


def _kinds(work: Work, found: BodyMotions) -> tuple[list[bool], list[bool]]:
    """Which bodies have inertia, and which a mass: of the others it does not matter how they move."""
    bodies = [work.system.body(name) for name in found.names]
    return [body.inertia is not None for body in bodies], [rational(body.mass) != 0 for body in bodies]


def plane_of(found: BodyMotions, turning: list[bool], moving: list[bool]) -> tuple[Any | None, float]:
    """(e, the largest part of the motion that is not normal to it); None where there is no such direction."""
    spins = np.einsum("kijt,kit->jkt", found.axes, found.angular_velocities)[:, turning].reshape(3, -1)
    speeds = np.moveaxis(found.velocities, 1, 0)[:, moving].reshape(3, -1)
    if np.any(spins):
        e = np.linalg.svd(spins, full_matrices=False)[0][:, 0]
    else:
        sides, sizes, _ = np.linalg.svd(speeds, full_matrices=False)
        if not sizes[1] > FLAT**0.5 * sizes[0]:
            return None, 0.0  # at rest, or along one line, which lies in many planes
        e = sides[:, 2]
    e = e * np.sign(e[np.argmax(np.abs(e))])
    off = max(_part(spins - np.outer(e, e @ spins), spins), _part(e @ speeds, speeds))
    return (e, off) if off <= FLAT else (None, off)


def _part(of: Any, whole: Any) -> float:
    largest = float(np.max(np.abs(whole), initial=0.0))
    return float(np.max(np.abs(of), initial=0.0)) / largest if largest else 0.0
