"""Where bodies are and how they are turned, in the axes of one frame, as nodes of a program.

    axes:     e_i^k  = sum_l R^jk_il e_l^j          row i of the body's axes, by one plane rotation a turn
    origin:   O_k    = O_j + sum_l (r^j_Ok)_l e_l^j

from the frame outwards, so that a chain of n bodies costs O(n) operations.  (``mbsym.numerics.positions`` turns every
vector back body by body instead: the second route.)
"""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.algebra.program import Node, Program
from mbsym.expressions.tree import Expression, differentiate, names
from mbsym.mechanics.frames import Turn
from mbsym.mechanics.kinematics import Scene
from mbsym.model.system import INERTIAL, Body

Triple = tuple[Node, Node, Node]
Axes = tuple[Triple, Triple, Triple]


class Places:
    """Axes and origins of all bodies that ``frame`` carries, in its axes; ``carried`` are their names."""

    def __init__(self, scene: Scene[Node], frame: str) -> None:
        self.scene, self.frame = scene, frame
        program = scene.algebra
        assert isinstance(program, Program)
        self.program = program
        one, zero = program.one, program.zero
        self.axes: dict[str, Axes] = {frame: ((one, zero, zero), (zero, one, zero), (zero, zero, one))}
        self.origins: dict[str, Triple] = {frame: (zero, zero, zero)}
        #: The directions of the turns of each body's joint, in their order.
        self.turned: dict[str, list[Triple]] = {}
        for body in scene.system.bodies:
            if body.attached_to in self.axes and body.name != frame:
                self._place(body)

    @property
    def carried(self) -> list[str]:
        return [name for name in self.axes if name not in (INERTIAL, self.frame)]

    def _place(self, body: Body) -> None:
        motion = self.scene.motions[body.name]
        self.origins[body.name] = self.point(body.attached_to, motion.offset.components)
        axes = self.axes[body.attached_to]
        directions = []
        for turn in motion.turns:
            axes = self._turned(axes, turn)
            if turn.axis:
                directions.append(axes[turn.axis - 1])
        self.axes[body.name], self.turned[body.name] = axes, directions

    def _turned(self, axes: Axes, turn: Turn[Node]) -> Axes:
        """The rows after a turn: c u + s v and c v - s u of the two that it moves."""
        program = self.program
        if turn.given is not None:
            first, second, third = (self._combined(axes, row) for row in turn.given.rows)
            return first, second, third
        i, j = turn.axis % 3, (turn.axis + 1) % 3
        u, v, s, c = axes[i], axes[j], turn.sine, turn.cosine
        rows = list(axes)
        rows[i] = _triple([program.dot((c, s), (x, y)) for x, y in zip(u, v, strict=True)])
        rows[j] = _triple([program.dot((c, -s), (y, x)) for x, y in zip(u, v, strict=True)])
        return rows[0], rows[1], rows[2]

    def _combined(self, axes: Axes, components: Sequence[Node]) -> Triple:
        columns = ((axes[0][k], axes[1][k], axes[2][k]) for k in range(3))
        return _triple([self.program.dot(tuple(components), column) for column in columns])

    def direction(self, body: str, components: Sequence[Node]) -> Triple:
        """A vector given in a body's axes, in those of the frame."""
        return self._combined(self.axes[body], components)

    def point(self, body: str, components: Sequence[Node]) -> Triple:
        """A point given from a body's origin in its axes, from the frame's origin in those of the frame."""
        arm = self.direction(body, components)
        return _triple([a + b for a, b in zip(self.origins[body], arm, strict=True)])

    def given(self, body: str, components: Sequence[Expression]) -> Triple:
        """The same of expressions of the description."""
        return self.point(body, self.scene.lower.vector(components))

    def centre(self, body: str) -> Triple:
        """The mass centre."""
        return self.point(body, self.scene.motions[body].mass_centre.components)

    def slides(self, body: Body) -> list[tuple[str, Triple]]:
        """(coordinate, direction): how the connection point moves in the body before, for every coordinate it holds."""
        found = []
        held = set().union(*map(names, body.connection_point))
        for name in (x for x in self.scene.system.coordinates if x in held):
            slope = self.scene.lower.vector([differentiate(x, name) for x in body.connection_point])
            found.append((name, self.direction(body.attached_to, slope)))
        return found


def _triple(values: Sequence[Node]) -> Triple:
    return values[0], values[1], values[2]
