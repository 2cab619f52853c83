"""Kane's equations in speeds as a straight-line program: M, f of M u' = f and the rates s' = g.

The recursions run over the program with the angular velocities and unit vectors that are variables taken as they are,
so that no angle, and no singular one, stands between.  Inertia is linear in u', velocities are linear in u: M and the
partial velocities are exact derivatives of nodes (``algebra.derivative``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.program import Node, Program
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import actions
from mbsym.mechanics.newton_euler import inertia_wrenches
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System


@dataclass(frozen=True)
class SpeedProgram:
    """Nodes of ``program``, whose inputs bear the declared names: M (n x n), f (n), s' in the order of positions.

    ``scene`` is the system over it, ``environment`` the names of its inputs.
    """

    program: Program
    environment: Mapping[str, Node]
    scene: Scene
    mass_matrix: tuple[tuple[Node, ...], ...]
    forcing: tuple[Node, ...]
    rates: tuple[Node, ...]


def speed_program(form: SpeedForm) -> SpeedProgram:
    """The program of a system in speeds.  Raises what the loads raise, NoClosedForm where a rate has none."""
    program = Program()
    inputs: dict[str, Node] = dict(program_environment(form.system, program))
    scene = form.scene_over(program, inputs)
    residuals = _residuals(form, scene, inputs)
    accelerations = [inputs[u.rate_name] for u in form.speeds]
    still = {u.rate_name: program.zero for u in form.speeds}
    forcing = program.evaluate(residuals, {**inputs, **still}, program)
    carry = Carrier(form.ring, program, inputs)
    return SpeedProgram(
        program=program,
        environment=inputs,
        scene=scene,
        mass_matrix=jacobian(program, residuals, accelerations),
        forcing=tuple(-x for x in forcing),
        rates=tuple(carry(form.rates[position.name]) for position in form.positions),
    )


def orthonormal(system: System) -> tuple[tuple[tuple[str, ...], ...], ...]:
    """Of every body told by unit vectors or a quaternion the components of the vectors whose products are kept."""
    return tuple(tuple(vector.components for vector in body.orientation) for body in system.bodies if body.orientation)


def restoring(program: Program, system: System) -> dict[str, Node]:
    """What leads components back to lengths of 1 and right angles, by name: Newton's step to the nearest such,

    e + (1 - e.e) e/2  of a quaternion,      e_i - 1/2 sum_j (e_i.e_j - delta_ij) e_j  of unit vectors,

    less e and e_i themselves; its square is left.
    """
    half = program.number(Fraction(1, 2))
    nodes: dict[str, Node] = {}
    for vectors in orthonormal(system):
        for vector in vectors:
            totals = [program.zero] * len(vector)
            for other in vectors:
                pairs = zip(vector, other, strict=True)
                gap = sum((program.input(a) * program.input(b) for a, b in pairs), program.zero)
                gap = gap - program.one if other is vector else gap
                totals = [x + gap * program.input(name) for x, name in zip(totals, other, strict=True)]
            nodes |= {name: -(half * x) for name, x in zip(vector, totals, strict=True)}
    return nodes


def _residuals(form: SpeedForm, scene: Scene, inputs: Mapping[str, Node]) -> list[Node]:
    """sum (F - F_loads) . dV_O/du_r + (N - M_loads) . domega/du_r - sum Q_i dq'_i/du_r."""
    program: Program = scene.algebra  # type: ignore[assignment]
    speeds = [inputs[u.name] for u in form.speeds]
    wrenches = inertia_wrenches(scene)
    generalized: dict[str, Node] = {}
    for action in actions(scene):
        for wrench in action.wrenches:
            force, moment = wrenches[wrench.body]
            wrenches[wrench.body] = (force - wrench.force, moment - wrench.moment)
        for name, value in action.generalized.items():
            generalized[name] = generalized.get(name, program.zero) + value
    powers = [(x, v) for name, (force, moment) in wrenches.items() for x, v in _pairs(scene, name, force, moment)]
    carry = Carrier(form.ring, program, inputs)
    powers += [(-force, carry(form.velocity(name))) for name, force in generalized.items()]
    rows = jacobian(program, [velocity for _, velocity in powers], speeds)
    totals = [program.zero for _ in speeds]
    for (needed, _), row in zip(powers, rows, strict=True):
        totals = [total + needed * partial for total, partial in zip(totals, row, strict=True)]
    return totals


def _pairs(scene: Scene, name: str, force: Vector, moment: Vector) -> list[tuple[Node, Node]]:
    """Components of a wrench, each with the velocity on which it works."""
    motion = scene.motions[name]
    pairs = [*zip(force, motion.velocity_origin, strict=True), *zip(moment, motion.angular_velocity, strict=True)]
    return list(pairs)
