"""The shapes of bodies as outlines: polygons in the body's axes, which turn and move with it.

A box has its twelve edges; a sphere and an ellipsoid the three ellipses in their planes of symmetry; a cylinder its two
rims, a capsule two circles where its straight part ends, and two arcs over each end, with four lines between.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from mbsym.algebra.failures import Failure
from mbsym.model.system import Body, Shape
from mbsym.numerics.body_motion import BodyMotions
from mbsym.numerics.scenario import Scenario, exact
from mbsym.picture.looking import turned

#: Straight pieces of a circle.
PIECES = 32


@dataclass(frozen=True)
class Outline:
    """Of ``body``: ``lines`` have shape (points, 3), from its mass centre, in its axes.

    ``axes`` has shape (3, 3, frames), row i is axis i of the body in the axes of the frame; ``places`` (3, frames) is
    its mass centre.
    """

    body: str
    lines: tuple[Any, ...]
    axes: Any
    places: Any

    def at(self, k: int) -> list[Any]:
        """The lines in the k-th frame, each of shape (3, points), in the axes of the frame."""
        return [self.places[:, k, None] + np.einsum("pi,np->in", self.axes[:, :, k], line) for line in self.lines]

    @property
    def reach(self) -> float:
        """The largest distance of a point from the mass centre."""
        return max(float(np.max(np.linalg.norm(line, axis=1))) for line in self.lines)


def outlines(scenario: Scenario, motions: BodyMotions) -> tuple[Outline, ...]:
    """Of every body that has shapes, and whose mass centre is at rest in its axes."""
    outlined = []
    for k, name in enumerate(motions.names):
        lines = body_lines(scenario.system.body(name), scenario.parameters)
        if lines:
            outlined.append(Outline(name, lines, motions.axes[k], motions.places[k]))
    return tuple(outlined)


def body_lines(body: Body, values: Mapping[str, Fraction]) -> tuple[Any, ...]:
    """The outlines of all shapes of a body, from its mass centre, in its axes; nothing where one has no number."""
    if not body.shapes:
        return ()
    try:
        centre = np.array([float(exact(x, values)) for x in body.mass_centre])
        return tuple(line - centre for shape in body.shapes for line in _placed(shape, values))
    except (Failure, KeyError):  # a mass centre that moves with the coordinates
        return ()


def _placed(shape: Shape, values: Mapping[str, Fraction]) -> list[Any]:
    at = np.array([float(exact(x, values)) for x in shape.at])
    turn = np.array(turned(shape.rotation, values))
    size = [float(exact(x, values)) for x in shape.size]
    return [line @ turn + at for line in shape_lines(shape.kind, size)]


def shape_lines(kind: str, size: list[float]) -> list[Any]:
    """Polygons of shape (points, 3) about the middle of the shape, in its axes."""
    if kind == "box":
        return _box(np.array(size) / 2)
    if kind in ("sphere", "ellipsoid"):
        axes = np.diag(size * 3 if kind == "sphere" else size)
        return [_arc(axes[p], axes[q]) for p, q in ((0, 1), (1, 2), (2, 0))]
    radius, length = size
    first, second, along = radius * np.eye(3)[0], radius * np.eye(3)[1], np.array([0.0, 0.0, length / 2])
    lines = [_arc(first, second) + end for end in (along, -along)]
    lines += [np.array([side - along, side + along]) for side in (first, second, -first, -second)]
    if kind == "capsule":
        up = np.array([0.0, 0.0, radius])
        lines += [_arc(side, sign * up, np.pi) + sign * along for side in (first, second) for sign in (1, -1)]
    return lines


def _box(half: Any) -> list[Any]:
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]])
    faces = [np.column_stack([corners * half[:2], np.full(5, end * half[2])]) for end in (-1, 1)]
    return faces + [np.array([faces[0][k], faces[1][k]]) for k in range(4)]


def _arc(first: Any, second: Any, angle: float = 2 * np.pi) -> Any:
    turn = np.linspace(0, angle, PIECES + 1)
    return np.outer(np.cos(turn), first) + np.outer(np.sin(turn), second)
