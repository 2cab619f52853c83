"""What robotics calls by name: inverse and forward dynamics, Coriolis and gravity terms, poses and Jacobians of frames.

    tau = M q'' + c(q, q') + g(q) - d      inverse_dynamics; d are the forces of the other loads, inputs being zero
    q'' = M^-1 (tau - c - g + d + J^T l)   forward_dynamics, by ``mbsym.mechanics.programs``; under constraints l is
                                           such that J q'' + gamma = 0
    c                                      coriolis: what inertia needs at q'' = 0, C(q, q') q' where nothing moves as
                                           prescribed
    g = -dU/dq                             gravity: U of the fields of gravity alone
    (R r; 0 1), (v; w) = J q'              pose and Jacobian of a frame, all in inertial axes

tau are generalised forces, one for each coordinate.  Of constrained systems all else is about the open tree.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from mbsym.algebra.derivative import gradient
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.algebra.remembered import remembered
from mbsym.algebra.vectors import Vector, axis_vector
from mbsym.mechanics.articulated import bias_forces, forcing
from mbsym.mechanics.articulation import Articulation, articulation
from mbsym.mechanics.constraints.dynamics import constrained_dynamics
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import scene_without_accelerations
from mbsym.mechanics.variables import program_environment
from mbsym.model.inputs import force_names
from mbsym.model.loads import NewtonianGravity, UniformGravity
from mbsym.model.system import INERTIAL, System
from mbsym.report.code.constrained_code import tied_of
from mbsym.report.code.functions import Function, Functions

if TYPE_CHECKING:
    from mbsym.algebra.ring import Ring
    from mbsym.analysis import Analysis

#: Poses and Jacobians of all frames take so many operations at most; of those beyond there are none.
MOST_OPERATIONS = 30_000


@dataclass(frozen=True)
class Computed:
    """Nodes of a program."""

    program: Program
    nodes: tuple[Node, ...]


@dataclass(frozen=True)
class FrameCode:
    """Of one body or massless frame: its 4 x 4 pose and its 6 x n Jacobian, row by row."""

    name: str
    pose: Computed
    jacobian: Computed

    def entries(self, columns: int) -> tuple[list[tuple[int, int]], list[Node]]:
        """Places and nodes of the entries of the Jacobian that need not be zero."""
        found = [(divmod(k, columns), x) for k, x in enumerate(self.jacobian.nodes)]
        nonzero = [(place, x) for place, x in found if not self.jacobian.program.vanishes(x)]
        return [place for place, _ in nonzero], [x for _, x in nonzero]


@dataclass(frozen=True)
class NamedDynamics:
    """None in place of what there is none of; ``forward`` has the names of ``force_names`` as inputs.

    ``without`` are the bodies beyond what poses and Jacobians may cost.
    """

    inverse: Computed | None
    forward: Computed | None
    coriolis: Computed | None
    gravity: Computed | None
    frames: tuple[FrameCode, ...]
    without: tuple[str, ...]

    @property
    def told_without(self) -> str:
        """Which frames have neither, as a sentence; nothing where all have."""
        if not self.without:
            return ""
        return f"There are no poses of these, they would take too many operations: {', '.join(self.without)}."


@dataclass(frozen=True)
class Bodies:
    """The same as bodies of functions; of frames (name, pose, Jacobian, places of the Jacobian's entries)."""

    inverse: Function | None
    forward: Function | None
    coriolis: Function | None
    gravity: Function | None
    frames: list[tuple[str, Function, Function, list[tuple[int, int]]]]


def bodies(dynamics: NamedDynamics, writer: Functions, plain: Callable[[str], str]) -> Bodies:
    """In a language; names of frames may stand in its strings and comments when they are ``plain``."""

    def body(computed: Computed | None) -> Function | None:
        return None if computed is None else writer.function(computed.program, computed.nodes)

    frames = []
    for frame in dynamics.frames:
        places, nodes = frame.entries(len(writer.system.coordinates))
        pose = writer.function(frame.pose.program, frame.pose.nodes)
        frames.append((plain(frame.name), pose, writer.function(frame.jacobian.program, nodes), places))
    return Bodies(
        body(dynamics.inverse), body(dynamics.forward), body(dynamics.coriolis), body(dynamics.gravity), frames
    )


@remembered  # several files are written of one analysis, one after the other
def named_dynamics(analysis: Analysis) -> NamedDynamics:
    """All of it, computed when it is first asked for; what there is no program for is None."""
    system, ring = analysis.system, analysis.ring
    computeds: dict[str, Computed | None] = {}
    makers: dict[str, Callable[[], Computed | None]] = {
        "inverse": lambda: _inverse(system, ring),
        "forward": lambda: _forward(analysis),
        "coriolis": lambda: _coriolis(system, ring),
        "gravity": lambda: _gravity(system, ring),
    }
    for name, make in makers.items():
        try:
            computeds[name] = make()
        except Failure:
            computeds[name] = None
    frames, without = _frames(system, ring)
    return NamedDynamics(**computeds, frames=frames, without=without)


def _inverse(system: System, ring: Ring) -> Computed:
    """M q'' - f by one recursion of Newton and Euler's."""
    program = Program()
    scene = Scene(system, program, _unforced(system, program), ring)
    nodes = residuals(scene)
    return Computed(program, tuple(nodes[name] for name in system.coordinates))


def _unforced(system: System, program: Program) -> dict[str, Node]:
    """The names as inputs of a program, the system's own inputs being zero."""
    return program_environment(system, program) | dict.fromkeys(system.input_names, program.zero)


def _forward(analysis: Analysis) -> Computed | None:
    system, ring = analysis.system, analysis.ring
    pushed = dict(zip(system.coordinates, force_names(system), strict=True))
    tied = tied_of(analysis)
    if isinstance(tied, str):
        return None
    dynamics = constrained_dynamics(system, ring, tied.chosen, pushed=pushed)
    program = Program()
    nodes = _unforced(system, program) | {force: program.input(force) for force in pushed.values()}
    return Computed(program, tuple(dynamics.program.evaluate(list(dynamics.accelerations), nodes, program)))


def _coriolis(system: System, ring: Ring) -> Computed:
    program = Program()
    alone = replace(system, loads=())
    frames = articulation(scene_without_accelerations(alone, ring, program))
    return Computed(program, tuple(-x for x in forcing(frames, bias_forces(frames))))


def _gravity(system: System, ring: Ring) -> Computed:
    program = Program()
    alone = replace(
        system, loads=tuple(load for load in system.loads if isinstance(load, UniformGravity | NewtonianGravity))
    )
    inputs = program_environment(alone, program)
    potential = -force_function(scene_without_accelerations(alone, ring, program, inputs))
    return Computed(program, gradient(program, potential, [inputs[name] for name in system.coordinates]))


def _frames(system: System, ring: Ring) -> tuple[tuple[FrameCode, ...], tuple[str, ...]]:
    """Of every body, ends of the tree first where there are too many."""
    program = Program()
    scene = scene_without_accelerations(system, ring, program)
    placed = _Placed(articulation(scene), program)
    carrying = {body.attached_to for body in system.bodies}
    made: dict[str, FrameCode] = {}
    spent = 0
    for name in sorted(scene.motions, key=lambda body_name: body_name in carrying):
        if spent > MOST_OPERATIONS:
            break
        frame_code = placed.frame(name)
        spent += program.operations([*frame_code.pose.nodes, *frame_code.jacobian.nodes])
        if spent <= MOST_OPERATIONS:
            made[name] = frame_code
    return (
        tuple(made[name] for name in scene.motions if name in made),
        tuple(name for name in scene.motions if name not in made),
    )


class _Placed:
    """Axes and origins of elementary frames: the row i of ``axes`` is the inertial axis i in the axes of the frame."""

    def __init__(self, system: Articulation[Node], program: Program) -> None:
        self.system, self.program = system, program
        self.axes: list[tuple[Vector[Node], ...]] = []
        self.origins: list[tuple[Node, ...]] = []
        for frame in system.frames:
            axes, origin = self.of(frame.parent)
            step = tuple(axis.dot(frame.offset) for axis in axes)
            self.origins.append(tuple(a + b for a, b in zip(origin, step, strict=True)))
            self.axes.append(tuple(frame.out(axis) for axis in axes))

    def of(self, number: int) -> tuple[tuple[Vector[Node], ...], tuple[Node, ...]]:
        """Axes and origin of a frame; of the inertial one where the number is negative."""
        if number >= 0:
            return self.axes[number], self.origins[number]
        program = self.program
        return tuple(axis_vector(program, k, program.one, INERTIAL) for k in (1, 2, 3)), (program.zero,) * 3

    def frame(self, name: str) -> FrameCode:
        program = self.program
        axes, origin = self.of(self.system.frame_of[name])
        rows = [(*axis, x) for axis, x in zip(axes, origin, strict=True)]
        pose = (*rows[0], *rows[1], *rows[2], *[program.zero] * 3, program.one)
        columns = self._columns(self.system.frame_of[name], origin)
        order = self.system.coordinates
        slopes = tuple(columns[q][k] if q in columns else program.zero for k in range(6) for q in order)
        return FrameCode(name, Computed(program, pose), Computed(program, slopes))

    def _columns(self, end: int, origin: tuple[Node, ...]) -> dict[str, list[Node]]:
        """Coordinate: what its rate adds to the velocity of the origin and to the angular velocity.

        A turn by the angle x about the unit vector e at r: x_q (e x (origin - r), e);  an offset d: (d_q, 0).
        """
        columns: dict[str, list[Node]] = {}
        number = end
        while number >= 0:
            frame = self.system.frames[number]
            (axes, at), (before, _) = self.of(number), self.of(frame.parent)
            if frame.turn is not None and frame.angle_derivatives:
                e = [axis[frame.turn.axis - 1] for axis in axes]
                d = [a - b for a, b in zip(origin, at, strict=True)]
                swept = [e[1] * d[2] - e[2] * d[1], e[2] * d[0] - e[0] * d[2], e[0] * d[1] - e[1] * d[0], *e]
                for name, slope in frame.angle_derivatives.items():
                    self._add(columns, name, [slope * x for x in swept])
            for name, moved in frame.offset_derivatives.items():
                self._add(columns, name, [axis.dot(moved) for axis in before] + [self.program.zero] * 3)
            number = frame.parent
        return columns

    @staticmethod
    def _add(columns: dict[str, list[Node]], name: str, column: list[Node]) -> None:
        columns[name] = [a + b for a, b in zip(columns[name], column, strict=True)] if name in columns else column
