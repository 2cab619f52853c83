"""Which of the two fails where M is singular, the coordinates or the model: ranks at a point, with many bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, ctx

from mbsym.algebra.point import Balls
from mbsym.algebra.program import Node, Program
from mbsym.algebra.rationals import ball
from mbsym.algebra.ring import Ring
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.programs import programs
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System, velocity_name
from mbsym.numerics.scenario import Scenario

#: Ranks are decided at so many bits: smaller than this part of what is usual counts as zero.
BITS, NOTHING = 320, 1e-30

#: What a singular set is one of; ``BOTH`` where the coordinates fail, and the model beyond that.
CHART, MODEL, BOTH, OPEN = "coordinates", "model", "coordinates and model", "not told apart"


class Kinds:
    """Ranks of M and of what q' moves, at points with many bits."""

    def __init__(self, given: Scenario, system: System, ring: Ring, sizes: Mapping[str, Fraction]) -> None:
        self.given, self.system, self.sizes = given, system, sizes
        whole = programs(system, ring, open_tree=True)
        self.n = len(system.coordinates)
        self.matrix = (whole.program, [x for row in whole.mass_matrix for x in row])
        program = Program()
        environment = program_environment(system, program)
        scene = Scene(system, program, environment, ring, frozen=True)
        self.visible = (program, _moved(scene))
        with ctx.workprec(BITS):
            regular = self._point({}, 1)
            masses = self._masses(regular)
            self.usual = [masses[i, i] for i in range(self.n)]
            moved = self._motions(regular)
            self.rows = [max(abs(moved[i, j]) for j in range(self.n)) for i in range(moved.nrows())]

    def kind(self, place: Mapping[str, Any]) -> str:
        """Of a point of a singular set; the other coordinates are somewhere near where the scenario has them."""
        with ctx.workprec(BITS):
            point = self._point(place, 1)
            masses, moved = self._masses(point), self._motions(point)
            if any(not bool(x > 0) for x in self.usual):
                return OPEN
            n = self.n
            scaled = [[masses[i, j] / (self.usual[i] * self.usual[j]).sqrt() for j in range(n)] for i in range(n)]
            shown = [[moved[i, j] / row for j in range(n)] for i, row in enumerate(self.rows) if bool(row > 0)]
            lost, hidden = n - _rank(scaled), n - _rank(shown)
        if not lost:
            return OPEN
        if hidden == lost:
            return CHART
        return BOTH if hidden else MODEL

    def singular(self, place: Mapping[str, Any]) -> bool:
        """Whether M has less than full rank at the scenario's position with the coordinates of ``place``."""
        with ctx.workprec(BITS):
            masses, n = self._masses(self._point(place, 0)), self.n
            if any(not bool(x > 0) for x in self.usual):
                return False
            scaled = [[masses[i, j] / (self.usual[i] * self.usual[j]).sqrt() for j in range(n)] for i in range(n)]
            return _rank(scaled) < n

    def _point(self, place: Mapping[str, Any], beside: int) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for k, (name, value) in enumerate(zip(self.system.coordinates, self.given.positions, strict=True)):
            step = Fraction(beside * (7 + 3 * k), 50)
            found[name] = place.get(name, ball(value + step * self.sizes.get(name, Fraction(1))))
        for name, (start, _) in self.given.prescribed.items():
            found[name] = place.get(name, ball(start))
        found["t"], found["pi"] = place.get("t", arb(0)), arb.pi()
        return found

    def _masses(self, point: Mapping[str, Any]) -> Any:
        program, nodes = self.matrix
        return arb_mat(self.n, self.n, _midpoints(program.evaluate(nodes, point, Balls(point))))

    def _motions(self, point: Mapping[str, Any]) -> Any:
        """What unit velocities move: one column a coordinate."""
        program, nodes = self.visible
        columns = []
        for moving in self.system.coordinates:
            rates = {velocity_name(x): arb(1 if x == moving else 0) for x in self.system.coordinates}
            inputs = {**point, **rates}
            columns.append(_midpoints(program.evaluate(nodes, inputs, Balls(inputs))))
        return arb_mat(len(nodes), self.n, [columns[j][i] for i in range(len(nodes)) for j in range(self.n)])


def _moved(scene: Scene) -> list[Node]:
    """Velocities of joints and mass centres, and I omega of every body that has inertia."""
    nodes: list[Node] = []
    for motion in scene.motions.values():
        nodes += [*motion.velocity_origin, *motion.velocity_mass_centre]
        if motion.inertia is not None:
            nodes += [*(motion.inertia @ motion.angular_velocity)]
    return nodes


def _midpoints(balls: Sequence[Any]) -> list[Any]:
    return [x.mid() for x in balls]


def _rank(rows: Sequence[Sequence[Any]]) -> int:
    """By elimination with complete pivoting of rows of size 1; what is below ``NOTHING`` is zero."""
    left = [[x.mid() for x in row] for row in rows]
    rank = 0
    while left and left[0]:
        i, j = max(
            ((i, j) for i in range(len(left)) for j in range(len(left[0]))),
            key=lambda ij: float(abs(left[ij[0]][ij[1]])),
        )
        if not bool(abs(left[i][j]) > NOTHING):
            break
        pivot = left.pop(i)
        rank += 1
        left = [
            [(x - row[j] / pivot[j] * y).mid() for k, (x, y) in enumerate(zip(row, pivot, strict=True)) if k != j]
            for row in left
        ]
    return rank
