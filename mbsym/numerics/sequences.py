"""Rotation sequences: the 12 ways to orient a body by three turns, ranked by size and distance from singularity.

A body turned about the axes a1, a2, a3 has an orientation R; every other sequence of three axes reaches the same R by
other angles.  A sequence of three different axes is singular where cos x2 = 0, one that returns to its first axis where
sin x2 = 0; there two of its turns are about one axis, M is singular and the angles' rates are unbounded.

distance   |cos x2| or |sin x2| of the middle angle at the state, the least along the given states
pivot      the smallest pivot of M over its largest, at the first state
size       operations of the accelerations with the parameters given, and of M and the forcing
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import atan2, cos, hypot, sin
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message
from mbsym.expressions.rates import without_velocity
from mbsym.expressions.tree import Name, names
from mbsym.mechanics.programs import constants, forward_dynamics, programs
from mbsym.mechanics.variables import expressions, ring_of
from mbsym.model.system import Body, Rotation, System
from mbsym.numerics.kernels.interface import FLOAT64, Code
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.trade.digits import Arithmetic, Quantity, input_names

#: Three axes of which no two neighbours are equal.
SEQUENCES = tuple(axes for axes in product((1, 2, 3), repeat=3) if axes[0] != axes[1] != axes[2])

FIXED = "its angles are not three coordinates of its own, so they cannot be exchanged"

Matrix = Any  # 3 x 3, numpy


@dataclass(frozen=True)
class Alternative:
    """One sequence for one body; ``own`` is the one in the description."""

    axes: tuple[int, int, int]
    own: bool
    distance: float
    pivot: float
    operations: int
    equations: int

    @property
    def text(self) -> str:
        return "".join(map(str, self.axes))


@dataclass(frozen=True)
class Ranking:
    """``alternatives`` of one body, best first; ``unusable`` says why there are none."""

    body: str
    alternatives: tuple[Alternative, ...]
    unusable: str = ""

    @property
    def sentence(self) -> str:
        """Which is best, and why."""
        if self.unusable:
            return Message("[[body]]: [[why]].", body=self.body, why=self.unusable)
        best = self.alternatives[0]
        own = next(a for a in self.alternatives if a.own)
        text = (
            "[[body]]: the sequence [[best]] is best, [[distance]] from its singularity (at most 1) with "
            "[[operations]] "
            "operations"
        )
        gaps = {"best": best.text, "distance": f"{best.distance:.2g}", "operations": best.operations}
        message = Message(text, body=self.body, **gaps)
        if best.own:
            return Message("[[told]]; it is the one in the description.", told=message)
        text = "[[told]]; the description's [[own]] is [[distance]] away with [[operations]]."
        return Message(text, told=message, own=own.text, distance=f"{own.distance:.2g}", operations=own.operations)


def rankings(scenario: Scenario, states: Sequence[Sequence[float]], watch: Callable[[str], None]) -> Iterator[Ranking]:
    """One ranking for every body that three turns about coordinates of its own orient.

    ``states`` are states (q, q') that the motion passes, the first one the state at which M is judged.
    """
    for body in scenario.system.bodies:
        if len(list(body.rotation.turns())) == 3:
            watch(f"sequences of {body.name}")
            yield _ranking(scenario, body, states)


def _ranking(scenario: Scenario, body: Body, states: Sequence[Sequence[float]]) -> Ranking:
    system = scenario.system
    turns = list(body.rotation.turns())
    angles = [angle.name for _, angle in turns if isinstance(angle, Name)]
    if len(angles) != 3 or not set(angles) <= set(body.coordinates):
        return Ranking(body.name, (), Message(FIXED))
    elsewhere = _uses_elsewhere(system, body, angles)
    if elsewhere:
        return Ranking(
            body.name,
            (),
            Message(("[[names]] occur outside the rotation, so the sequence is fixed"), names=", ".join(elsewhere)),
        )
    places = [system.coordinates.index(name) for name in angles]
    own = tuple(axis for axis, _ in turns)
    alternatives = []
    for axes in SEQUENCES:
        middles = [angles_of(axes, orientation(own, [state[k] for k in places])) for state in states]
        distance = min(abs(sin(x[1])) if axes[0] == axes[2] else abs(cos(x[1])) for x in middles)
        state = list(states[0][: len(system.coordinates)])
        for k, value in zip(places, middles[0], strict=True):
            state[k] = value
        alternatives.append(_alternative(scenario, body, axes, axes == own, distance, state))
    kept_alternatives = [a for a in alternatives if a is not None]
    return Ranking(body.name, tuple(sorted(kept_alternatives, key=_preference)))


def _preference(a: Alternative) -> tuple[float, int, bool]:
    """By distance in steps of a quarter of a digit, then by size, the description's own first."""
    return (-round(4 * np.log10(max(a.distance, 1e-16))), a.operations, not a.own)


def _uses_elsewhere(system: System, body: Body, angles: Sequence[str]) -> list[str]:
    """Angles that occur in loads or in other bodies: their meaning would change with the sequence."""
    parts = [system.loads, [b for b in system.bodies if b is not body], body.connection_point, body.mass_centre]
    used: set[str] = set()
    for part in parts:
        for expression in expressions(tuple(part)):
            used |= {without_velocity(name) for name in names(expression)}
    return [name for name in angles if name in used or any(_mentions(load, name) for load in system.loads)]


def _mentions(load: Any, name: str) -> bool:
    """A load on the coordinate itself (a spring in the joint)."""
    components = getattr(load, "components", ())
    listed = [item[0] for item in components if isinstance(item, tuple) and len(item) == 2]
    return getattr(load, "coordinate", None) == name or name in listed


def _alternative(
    scenario: Scenario, body: Body, axes: tuple[int, ...], own: bool, distance: float, state: Sequence[float]
) -> Alternative | None:
    system = scenario.system
    rotation = Rotation(tuple(axes), tuple(angle for _, angle in body.rotation.turns()))
    changed = replace(
        system,
        bodies=tuple(replace(b, rotation=rotation) if b is body else b for b in system.bodies),
        motion=(),
        initial=(),
    )
    try:
        ring = ring_of(changed)
        solved, whole = forward_dynamics(changed, ring), programs(changed, ring)
    except Failure:
        return None
    fixed = constants(changed)
    equations = [*(x for row in whole.mass_matrix for x in row), *whole.forcing]
    code = Code(solved.program, input_names(changed), solved.pivots)
    arithmetic = Arithmetic(replace(scenario, system=changed), [Quantity("pivots", code)], compiled=False)
    inputs = np.array([0.0, *state, *(0.0 for _ in state)])
    pivots = np.abs(arithmetic.values("pivots", FLOAT64, inputs))
    pivot = float(pivots.min() / pivots.max()) if np.all(np.isfinite(pivots)) and pivots.max() > 0 else 0.0
    first, second, third = axes
    return Alternative(
        (first, second, third),
        own,
        distance,
        pivot,
        solved.program.operations(solved.accelerations, fixed),
        whole.program.operations(equations, fixed),
    )


# --- angles of an orientation ---


def _turn(axis: int, angle: float) -> Matrix:
    """C_axis(angle), passive."""
    i, j = axis % 3, (axis + 1) % 3
    c = np.eye(3)
    c[i, i] = c[j, j] = cos(angle)
    c[i, j], c[j, i] = sin(angle), -sin(angle)
    return c


def orientation(axes: Sequence[int], angles: Sequence[float]) -> Matrix:
    """R = C_a3 C_a2 C_a1, the matrix of direction cosines (new axes in rows)."""
    r = np.eye(3)
    for axis, angle in zip(axes, angles, strict=True):
        r = _turn(axis, angle) @ r
    return r


def angles_of(axes: Sequence[int], r: Matrix) -> tuple[float, float, float]:
    """Angles x1, x2, x3 with C_a3(x3) C_a2(x2) C_a1(x1) = R.

    Row a3 of R is e_a3.C_a2(x2) C_a1(x1), column a1 is C_a3(x3) C_a2(x2) e_a1: they hold two angles each.
    """
    i, j, k = (axis - 1 for axis in axes)
    if i != k:
        sign = 1 if (j - i) % 3 == 1 else -1
        # R[k, i] = +-sin x2; R[k, j], R[k, k] hold x1 and R[j, i], R[i, i] hold x3.
        second = atan2(sign * r[k, i], hypot(r[i, i], r[j, i]))
        first = atan2(-sign * r[k, j], r[k, k])
        third = atan2(-sign * r[j, i], r[i, i])
        return first, second, third
    other = 3 - i - j
    sign = 1 if (j - i) % 3 == 1 else -1
    second = atan2(hypot(r[i, j], r[i, other]), r[i, i])
    first = atan2(r[i, j], -sign * r[i, other])
    third = atan2(r[j, i], sign * r[other, i])
    return first, second, third
