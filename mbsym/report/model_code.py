"""What generated code computes, as nodes of straight-line programs: made once, written by every language.

M, f           mass matrix and forcing,  M(q) q'' = f(q, q', t)
q''            by the cheaper route of ``mbsym.mechanics.forward_dynamics``; no inverse is formed
d q''/d(q, q') by the chain rule along the program of q'': exact, no differences
energies, first integrals of problem 7, places of the bodies
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.mechanics.forward_dynamics import ForwardDynamics, forward_dynamics
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.programs import generalized_energy, momenta, scene_without_accelerations
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import INERTIAL
from mbsym.problems.integrals import ENERGY, Integral, identifiers, whole_momenta
from mbsym.report.programs import programs_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: Indices into an array: (), (i,) or (i, j).
Place = tuple[int, ...]

#: A Jacobian that takes about more operations than this is left out.
LARGEST_JACOBIAN = 100_000


@dataclass(frozen=True)
class Solved:
    """Accelerations and d q''/d(q, q') (n rows of 2n nodes of the same program), or the reasons why there are none."""

    forward: ForwardDynamics | None
    no_forward: str
    slopes: tuple[tuple[Node, ...], ...] | None
    no_slopes: str


@dataclass(frozen=True)
class NamedIntegral:
    """A first integral of problem 7; ``name`` in letters, digits and underscores, ``title`` in words."""

    name: str
    title: str
    status: str


@dataclass(frozen=True)
class Integrals:
    """First integrals with their ``nodes`` over ``program``; without any there may be a ``reason``."""

    named: tuple[NamedIntegral, ...]
    program: Program
    nodes: tuple[Node, ...]
    reason: str = ""


@dataclass(frozen=True)
class Part:
    """A function of generated code: ``entries`` of an array of ``shape`` that need not be zero, by place."""

    name: str
    words: str
    shape: tuple[int, ...]
    program: Program
    entries: Mapping[Place, Node]


#: Several files are written of one analysis, one after the other, from the same programs.
_SOLVED: WeakKeyDictionary[Analysis, Solved] = WeakKeyDictionary()


def solved(analysis: Analysis) -> Solved:
    """Accelerations and their derivatives, computed when they are first asked for."""
    if analysis not in _SOLVED:
        _SOLVED[analysis] = _solved(analysis)
    return _SOLVED[analysis]


def _solved(analysis: Analysis) -> Solved:
    code, _ = programs_of(analysis)
    if code is None:
        return Solved(None, "", None, "")
    try:
        forward = forward_dynamics(analysis.system, analysis.ring)
    except Failure as reason:
        return Solved(None, str(reason), None, "")
    names = [*analysis.system.coordinates, *analysis.system.velocities]
    estimate = forward.program.operations(forward.accelerations) * len(names)
    if estimate > LARGEST_JACOBIAN:
        return Solved(forward, "", None, f"it would take some {estimate} operations")
    inputs = [forward.environment[name] for name in names]
    return Solved(forward, "", jacobian(forward.program, forward.accelerations, inputs), "")


def first_integrals(analysis: Analysis, problems: Sequence[int]) -> Integrals:
    """The integrals of problem 7, if that is among ``problems``; or none and the reason.

    They are those that problem 7 found, with its word for how that is known.  Their code is the recursion's own, never
    an expanded formula.
    """
    code, missing = programs_of(analysis)
    if 7 not in problems or code is None:
        return Integrals((), Program(), (), missing)
    stage = analysis.stage(7)
    if stage.failure is not None:
        return Integrals((), code.program, (), stage.failure.reason)
    in_speeds = ("unit vectors", "quaternion", "speed momentum")
    found: Sequence[Integral] = [item for item in stage.value if item.kind not in in_speeds]
    named = [NamedIntegral(name, item.name, item.status) for item, name in zip(found, identifiers(found), strict=True)]
    system = analysis.system
    lagrangian: dict[tuple[str, str], Node] = {(ENERGY, "time"): generalized_energy(code, system)}
    for name, node in zip(system.coordinates, momenta(code, system), strict=True):
        lagrangian["cyclic momentum", name] = node
    keys = [(item.kind, item.of) for item in found]
    if all(key in lagrangian for key in keys):
        return Integrals(tuple(named), code.program, tuple(lagrangian[key] for key in keys))
    scene, program = _scene(analysis)
    whole = {(kind, str(axis)): node for kind, axis, node in whole_momenta(scene)}
    carried = code.program.evaluate(list(lagrangian.values()), scene.environment, program)
    whole |= dict(zip(lagrangian, carried, strict=True))
    return Integrals(tuple(named), program, tuple(whole[key] for key in keys))


def _scene(analysis: Analysis) -> tuple[Scene, Program]:
    """The system over a program of its own."""
    program = Program()
    inputs = program_environment(analysis.system, program)
    return scene_without_accelerations(analysis.system, analysis.ring, program, inputs), program


def places(analysis: Analysis) -> tuple[Part, Part]:
    """Joints and mass centres of all bodies, a row each, from the inertial origin in inertial axes."""
    scene, program = _scene(analysis)
    joints = [scene.position(scene.zero(name), INERTIAL) for name in scene.motions]
    centres = [scene.position(motion.mass_centre, INERTIAL) for motion in scene.motions.values()]
    return (
        _places("joints", "Connection points of the bodies", program, joints),
        _places("mass_centres", "Mass centres of the bodies", program, centres),
    )


def _places(name: str, words: str, program: Program, rows: Sequence[Iterable[Node]]) -> Part:
    entries: dict[Place, Node] = {(i, k): x for i, row in enumerate(rows) for k, x in enumerate(row)}
    words += ", a row for each of BODIES, from the inertial origin in inertial axes"
    return Part(name, words, (len(rows), 3), program, _nonzero(program, entries))


def parts(analysis: Analysis, problems: Sequence[int]) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """Everything that generated code computes, and what it lacks, as sentences."""
    code, no_code = programs_of(analysis)
    if code is None:
        return (), (f"There is no code for the equations of motion: {no_code}",)
    n, program, found = len(analysis.system.coordinates), code.program, solved(analysis)
    pairs: dict[Place, Node] = {(i, j): code.mass_matrix[i][j] for i in range(n) for j in range(n)}
    forces: dict[Place, Node] = {(i,): node for i, node in enumerate(code.forcing)}
    energies = generalized_energy(code, analysis.system)
    jacobi = "T2 - T0 - U, with T2 and T0 the parts of T of second and of no degree in q'"
    made = [
        Part("mass_matrix", "M(q), symmetric", (n, n), program, _nonzero(program, pairs)),
        Part("forcing", "f of M(q) q'' = f(q, q', t)", (n,), program, _nonzero(program, forces)),
        Part("energy", "T - U, the kinetic energy minus the force function", (), program, {(): code.energy}),
        Part("generalized_energy", jacobi, (), program, {(): energies}),
    ]
    lacking = []
    if found.forward is None:
        lacking.append(f"There are no accelerations: {found.no_forward}")
    else:
        own = found.forward.program
        columns: dict[Place, Node] = {(i,): node for i, node in enumerate(found.forward.accelerations)}
        made.append(Part("accelerations", "q'' = M^-1 f, by factorisation", (n,), own, _nonzero(own, columns)))
        if found.slopes is None:
            lacking.append(f"There is no Jacobian: {found.no_slopes}")
        else:
            slopes: dict[Place, Node] = {
                (n + i, j): node for i, row in enumerate(found.slopes) for j, node in enumerate(row)
            }
            slopes |= {(i, n + i): own.one for i in range(n)}
            words = "d(q', q'')/d(q, q'), exact: by the chain rule"
            made.append(Part("jacobian", words, (2 * n, 2 * n), own, _nonzero(own, slopes)))
    conserved = first_integrals(analysis, problems)
    if conserved.reason:
        lacking.append(f"There are no first integrals: {conserved.reason}")
    if conserved.nodes:
        values: dict[Place, Node] = {(k,): node for k, node in enumerate(conserved.nodes)}
        words = "The first integrals in the order of INTEGRALS"
        made.append(Part("integrals", words, (len(values),), conserved.program, values))
    made.extend(places(analysis))
    return tuple(made), tuple(lacking)


def _nonzero(program: Program, entries: Mapping[Place, Node]) -> dict[Place, Node]:
    return {place: node for place, node in entries.items() if not program.vanishes(node)}
