"""Constraints between positions as operands, so that whoever moves one coordinate can lead the others back.

    f(q, t) = 0,     df/dq

A step that keeps the moved coordinate is the shortest solution of J dq = -f (Newton's method on rows that may be
dependent); ``closed`` takes such steps, a page does the same in its own language.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node
from mbsym.mechanics.kinematics import Scene
from mbsym.picture.program import PoseProgram
from mbsym.picture.values import Closure

#: Newton's steps at most.
STEPS = 60

#: No coordinate moves further in one of them, in radians or as a part of 1 + its size.
LONGEST = 0.5

#: Singular values below this part of the largest count as zero.
RANK = 1e-9


def rows(scene: Scene[Node]) -> tuple[list[Node], list[list[Node]], list[str]]:
    """f, its derivatives by the coordinates, and the names of the rows; rows that are zero at sight left out."""
    from mbsym.mechanics.constraints.rows import constraint_rows  # most systems have none

    found: list[tuple[str, Node]] = [
        (row.name.label, row.position)
        for row in constraint_rows(scene)
        if row.position is not None and not scene.algebra.vanishes(row.position)
    ]
    if not found:
        return [], [], []
    values = [position for _, position in found]
    program = values[0].program
    slopes = jacobian(program, values, [program.input(name) for name in scene.system.coordinates])
    return values, [list(row) for row in slopes], [label for label, _ in found]


def gaps(program: PoseProgram, closure: Closure, state: Mapping[str, float]) -> list[float]:
    """|f| of every row as a part of what the coordinates do to it: closed where it is below the tolerance."""
    values = program.at(state)
    sizes = [1 + abs(float(state[name])) for name in closure.coordinates]
    found = []
    for row, slopes in zip(closure.rows, closure.slopes, strict=True):
        scale = sum(abs(float(values[k])) * size for k, size in zip(slopes, sizes, strict=True))
        found.append(abs(float(values[row])) / scale if scale > 0 else abs(float(values[row])))
    return found


def closed(
    program: PoseProgram, closure: Closure, state: Mapping[str, float], held: Sequence[str]
) -> tuple[dict[str, float], bool]:
    """The state led to the constraints with the coordinates ``held``, and whether it keeps them then."""
    import numpy as np

    there = dict(state)
    free = [k for k, name in enumerate(closure.coordinates) if name not in held]
    for _ in range(STEPS):
        if max(gaps(program, closure, there)) < 1e-3 * closure.tolerance:
            break
        values = program.at(there)
        f = np.array([float(values[k]) for k in closure.rows])
        slopes = np.array([[float(values[row[k]]) for k in free] for row in closure.slopes])
        if not (np.all(np.isfinite(f)) and np.all(np.isfinite(slopes))) or not free:
            break
        step = np.linalg.lstsq(slopes, -f, rcond=RANK)[0]
        sizes = np.array([1 + abs(there[closure.coordinates[k]]) for k in free])
        step *= min(1.0, LONGEST / max(float(np.max(np.abs(step) / sizes)), 1e-300))
        for k, change in zip(free, step, strict=True):
            there[closure.coordinates[k]] += float(change)
    found = gaps(program, closure, there)
    return there, bool(max(found, default=0.0) < closure.tolerance)
