"""What generated code computes, as nodes of straight-line programs: made once, written by every language.

M, f           mass matrix and forcing,  M(q) q'' = f(q, q', t)
q''            by the cheaper route of ``mbsym.mechanics.programs``; no inverse is formed; with constraints by
               ``mbsym.mechanics.constraints.dynamics``, their rows and multipliers beside
d q''/d(q, q') by the chain rule along the program of q'': exact, no differences
energies, first integrals of problem 7, places of the bodies
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.derivative import jacobian
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.algebra.remembered import remembered
from mbsym.formulas.names import injective
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.programs import (
    Programs,
    generalized_energy,
    momenta,
    scene_without_accelerations,
)
from mbsym.model.system import INERTIAL, acceleration_name
from mbsym.problems.integrals import (
    ABOUT_CONTACT,
    AXIAL,
    ENERGY,
    GYROSCOPIC,
    OF_A_PART,
    WITH_FORCES,
    WITH_IMPULSE,
    Integral,
    about_contacts,
    identifiers,
    whole_momenta,
)
from mbsym.report.code.constrained_code import Tied, tied_of
from mbsym.report.code.functions import Function, Functions
from mbsym.report.code.named_dynamics import NamedDynamics, named_dynamics

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.mechanics.constraints.dynamics import ConstrainedDynamics

#: Indices into an array: (), (i,) or (i, j).
Place = tuple[int, ...]

#: What has a body of its own.
FUNCTIONS = ("mass", "forcing", "energy", "generalized", "accelerations", "jacobian", "reactions")

#: A Jacobian that takes about more operations than this is left out.
LARGEST_JACOBIAN = 100_000


@dataclass(frozen=True)
class Solved:
    """Accelerations and d q''/d(q, q') (n rows of 2n nodes of the same program), or the reasons why there are none.

    ``reactions`` are force and moment (6 nodes of that program) in each joint that the description names.
    """

    forward: ConstrainedDynamics | None
    no_forward: str
    slopes: tuple[tuple[Node, ...], ...] | None
    no_slopes: str
    reactions: tuple[tuple[Node, ...], ...] = ()
    no_reactions: str = ""


@dataclass(frozen=True)
class NamedIntegral:
    """A first integral of problem 7; ``name`` in letters, digits and underscores, ``title`` in words."""

    name: str
    title: str
    status: Certainty


@dataclass(frozen=True)
class Integrals:
    """First integrals with their ``nodes`` over ``program``; without any there may be a ``reason``."""

    named: tuple[NamedIntegral, ...]
    program: Program
    nodes: tuple[Node, ...]
    reason: str = ""


@dataclass(frozen=True)
class Part:
    """A function of generated code: ``entries`` of an array of ``shape`` that need not be zero, by place.

    ``argument``: what it takes besides the state: ``qdd``, accelerations, or ``tau``, generalised forces.  ``further``:
    only languages have it whose functions are many.
    """

    name: str
    words: str
    shape: tuple[int, ...]
    program: Program
    entries: Mapping[Place, Node]
    argument: str = ""
    further: bool = False


def programs_of(analysis: Analysis) -> tuple[Programs | None, str]:
    """M, f and the energy as a program, of the open tree where there are constraints; or why there is none."""
    tied = tied_of(analysis)
    return (None, tied) if isinstance(tied, str) else (tied.code.tree, "")


@remembered  # several files are written of one analysis, one after the other, from the same programs
def solved(analysis: Analysis) -> Solved:
    """Accelerations and their derivatives, computed when they are first asked for."""
    tied = tied_of(analysis)
    if isinstance(tied, str):
        return Solved(None, "", None, "")
    forward = tied.dynamics
    if forward is None:
        return Solved(None, tied.no_dynamics, None, "")
    needed, no_reactions = _reactions(analysis, tied, forward)
    names = [*analysis.system.coordinates, *analysis.system.velocities]
    estimate = forward.program.operations(forward.accelerations) * len(names)
    if estimate > LARGEST_JACOBIAN:
        return Solved(forward, "", None, f"it would take some {estimate} operations", needed, no_reactions)
    inputs = [forward.environment[name] for name in names]
    slopes = jacobian(forward.program, forward.accelerations, inputs)
    return Solved(forward, "", slopes, "", needed, no_reactions)


def _reactions(
    analysis: Analysis, tied: Tied, forward: ConstrainedDynamics
) -> tuple[tuple[tuple[Node, ...], ...], str]:
    """R_0 + sum lambda_i R_i in each joint asked for, at the accelerations of the equations; or why there is none."""
    system = analysis.system
    if not system.reactions:
        return (), ""
    from mbsym.mechanics.reactions import reactions  # few descriptions ask for them

    moved = {acceleration_name(q): x for q, x in zip(system.coordinates, forward.accelerations, strict=True)}
    try:
        scene = Scene(system, forward.program, {**forward.environment, **moved}, analysis.ring)
        joint_reactions = reactions(scene, system.reactions, tied.kept)
    except Failure as reason:
        return (), str(reason)
    totals = []
    for reaction in joint_reactions:
        total = [*reaction.force, *reaction.moment]
        for weight, (force, moment) in zip(forward.multipliers, reaction.per_multiplier, strict=True):
            total = [x + weight * y for x, y in zip(total, [*force, *moment], strict=True)]
        totals.append(tuple(total))
    return tuple(totals), ""


def functions_of(
    analysis: Analysis, writer: Functions, accelerated: bool = False
) -> tuple[dict[str, Function | None], list[tuple[int, int]]]:
    """Bodies of functions in the writer's language, None for those that there are not.

    M is there by its upper half, the generalised energy where it is another quantity than T - U; d q''/d(q, q') by the
    entries whose places are told besides, reactions joint after joint; q'' if these are to be ``accelerated``.
    """
    code, known, system = programs_of(analysis)[0], solved(analysis), analysis.system
    functions: dict[str, Function | None] = dict.fromkeys(FUNCTIONS)
    places: list[tuple[int, int]] = []
    if code:
        n = len(system.coordinates)
        upper = [code.mass_matrix[i][j] for i in range(n) for j in range(i, n)]
        functions["mass"] = writer.function(code.program, upper)
        functions["forcing"] = writer.function(code.program, code.forcing)
        functions["energy"] = writer.function(code.program, [code.energy])
        generalized = generalized_energy(code, system)
        if generalized is not code.energy:
            functions["generalized"] = writer.function(code.program, [generalized])
    if known.forward:
        program = known.forward.program
        if known.reactions:
            functions["reactions"] = writer.function(program, [x for row in known.reactions for x in row])
        if accelerated:
            functions["accelerations"] = writer.function(program, known.forward.accelerations)
        if known.slopes is not None:
            nodes = {(i, j): x for i, row in enumerate(known.slopes) for j, x in enumerate(row)}
            places = [place for place, x in nodes.items() if not program.vanishes(x)]
            functions["jacobian"] = writer.function(program, [nodes[place] for place in places])
    return functions, places


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
    elsewhere = ("unit vectors", "quaternion", "speed momentum", "symmetry", "polynomial")
    integrals: Sequence[Integral] = [item for item in stage.value if item.kind not in elsewhere]
    named = [
        NamedIntegral(name, item.name, item.status)
        for item, name in zip(integrals, identifiers(integrals), strict=True)
    ]
    system = analysis.system
    lagrangian: dict[tuple[str, str], Node] = {(ENERGY, "time"): generalized_energy(code, system)}
    for name, node in zip(system.coordinates, momenta(code, system), strict=True):
        lagrangian["cyclic momentum", name] = node
    keys = [(item.kind, item.of) for item in integrals]
    if system.constraints:  # a momentum may be one along a displacement of several coordinates
        for item, key in zip(integrals, keys, strict=True):
            if item.kind == "cyclic momentum" and item.name != f"momentum of {item.of}":
                carry = Carrier(analysis.ring, code.program, dict(code.environment))
                lagrangian[key] = carry(item.formula.polynomial)
    for item, key in zip(integrals, keys, strict=True):
        if item.kind in (AXIAL, WITH_FORCES, OF_A_PART, GYROSCOPIC, WITH_IMPULSE):
            carry = Carrier(analysis.ring, code.program, dict(code.environment))
            lagrangian[key] = carry(item.formula.polynomial)
    if all(key in lagrangian for key in keys):
        return Integrals(tuple(named), code.program, tuple(lagrangian[key] for key in keys))
    scene, program = _scene(analysis)
    of_all = whole_momenta(scene)
    whole = {(kind, str(axis)): node for kind, axis, node in of_all}
    whole |= {(ABOUT_CONTACT, of): node for of, _, _, node in about_contacts(scene, of_all)}
    carried = code.program.evaluate(list(lagrangian.values()), scene.environment, program)
    whole |= dict(zip(lagrangian, carried, strict=True))
    return Integrals(tuple(named), program, tuple(whole[key] for key in keys))


def _scene(analysis: Analysis) -> tuple[Scene, Program]:
    """The system over a program of its own."""
    program = Program()
    return scene_without_accelerations(analysis.system, analysis.ring, program), program


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


def parts(analysis: Analysis, problems: Sequence[int], named: bool = True) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """Everything that generated code computes (``named``: what robotics calls by name, too), and what it lacks, as
    sentences."""
    tied = tied_of(analysis)
    if isinstance(tied, str):
        return (), (f"There is no code for the equations of motion: {tied}",)
    code = tied.code.tree
    n, program, solution = len(analysis.system.coordinates), code.program, solved(analysis)
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
    if tied.rows:
        made.extend(_rows(tied, n))
    if solution.forward is None:
        lacking.append(f"There are no accelerations: {solution.no_forward}")
    else:
        own = solution.forward.program
        columns: dict[Place, Node] = {(i,): node for i, node in enumerate(solution.forward.accelerations)}
        words = "q'' = M^-1 f, by factorisation"
        if tied.rows:
            words = "q'' with M q'' = f + J^T lambda and J q'' = -gamma, by factors of M and of J M^-1 J^T"
        made.append(Part("accelerations", words, (n,), own, _nonzero(own, columns)))
        if solution.slopes is None:
            lacking.append(f"There is no Jacobian: {solution.no_slopes}")
        else:
            slopes: dict[Place, Node] = {
                (n + i, j): node for i, row in enumerate(solution.slopes) for j, node in enumerate(row)
            }
            slopes |= {(i, n + i): own.one for i in range(n)}
            words = "d(q', q'')/d(q, q'), exact: by the chain rule"
            made.append(Part("jacobian", words, (2 * n, 2 * n), own, _nonzero(own, slopes)))
        if tied.rows:
            made.extend(_corrections(tied, solution.forward))
        if solution.no_reactions:
            lacking.append(f"There are no reactions: {solution.no_reactions}")
        if solution.reactions:
            made.append(_reaction_part(analysis, solution))
    conserved = first_integrals(analysis, problems)
    if conserved.reason:
        lacking.append(f"There are no first integrals: {conserved.reason}")
    if conserved.nodes:
        values: dict[Place, Node] = {(k,): node for k, node in enumerate(conserved.nodes)}
        words = "The first integrals in the order of INTEGRALS"
        made.append(Part("integrals", words, (len(values),), conserved.program, values))
    made.extend(places(analysis))
    if named:
        dynamics = named_dynamics(analysis)
        made.extend(_named_parts(dynamics, n, bool(tied.rows)))
        lacking += filter(None, [dynamics.told_without])
    return tuple(made), tuple(lacking)


def _named_parts(dynamics: NamedDynamics, n: int, tied: bool) -> Iterator[Part]:
    """What robotics calls by name."""
    forward = "q'' with M q'' = f + tau + J^T lambda and J q'' = -gamma" if tied else "q'' = M^-1 (f + tau)"
    balance = "M q'' + c + g = generalised forces of other loads"
    for name, words, quantity, argument in (
        ("coriolis", f"c of {balance}: C(q, q') q' where nothing moves as prescribed", dynamics.coriolis, ""),
        ("gravity", f"g of {balance}, of the fields of gravity", dynamics.gravity, ""),
        (
            "inverse_dynamics",
            "The generalised forces tau = M q'' - f that q'' needs besides the loads, inputs being zero",
            dynamics.inverse,
            "qdd",
        ),
        ("forward_dynamics", f"{forward}, inputs being zero", dynamics.forward, "tau"),
    ):
        if quantity is not None:
            column: dict[Place, Node] = {(i,): x for i, x in enumerate(quantity.nodes)}
            nodes = _nonzero(quantity.program, column)
            yield Part(name, words, (n,), quantity.program, nodes, argument, bool(argument))
    called = injective([frame.name for frame in dynamics.frames], lambda name: re.sub(r"\W", "_", name, flags=re.ASCII))
    for frame in dynamics.frames:
        for stem, words, computed, shape in (
            ("pose", "[[R, r], [0, 1]]: inertial axes from its own are R, its origin is r", frame.pose, (4, 4)),
            (
                "jacobian",
                "J of (velocity of its origin, angular velocity) = J q', inertial axes",
                frame.jacobian,
                (6, n),
            ),
        ):
            entries: dict[Place, Node] = {divmod(k, shape[1]): x for k, x in enumerate(computed.nodes)}
            name = f"frame_{stem}_{called[frame.name]}"
            nodes = _nonzero(computed.program, entries)
            yield Part(name, f"Of {frame.name}, {words}", shape, computed.program, nodes, "", True)


def undetermined(analysis: Analysis) -> str:
    """Which components of reactions the equations do not determine, as a sentence; empty where they do all."""
    system = analysis.system
    if not (system.reactions and system.constraints):
        return ""
    reactions = analysis.optional("reactions")
    if reactions is None:
        return "Where constraints follow from others, forces of these are the least that do."
    components = [
        f"{reaction.body}: " + ", ".join(f"{'force' if k < 3 else 'moment'} {k % 3 + 1}" for k in reaction.undetermined)
        for reaction in reactions
        if reaction.undetermined
    ]
    if not components:
        return ""
    return (
        f"Statically indeterminate, so not determined by the equations, are {'; '.join(components)}: given are those "
        "without forces that constraints may have in balance, or with the least of them."
    )


def _reaction_part(analysis: Analysis, solution: Solved) -> Part:
    assert solution.forward is not None
    values: dict[Place, Node] = {(i, k): x for i, row in enumerate(solution.reactions) for k, x in enumerate(row)}
    joints = "; ".join(analysis.system.reactions)
    words = f"Force and moment in the joints of {joints}: a row for each, about its connection point, in its axes"
    open_ones = undetermined(analysis)
    if open_ones:
        words += f". {open_ones.removesuffix('.')}"
    program = solution.forward.program
    return Part("reactions", words, (len(solution.reactions), 6), program, _nonzero(program, values))


def _rows(tied: Tied, n: int) -> tuple[Part, ...]:
    """phi, J q' + j, J, gamma."""
    program, m = tied.code.tree.program, len(tied.rows)
    partials: dict[Place, Node] = {(i, j): x for i, row in enumerate(tied.jacobian) for j, x in enumerate(row)}

    def column(nodes: Sequence[Node]) -> dict[Place, Node]:
        return _nonzero(program, {(i,): node for i, node in enumerate(nodes)})

    rates = f"J q' + j = 0, the constraints on velocities: {'; '.join(tied.labels)}"
    made = [Part("constraint_velocity", rates, (m,), program, column(tied.velocity))]
    if tied.positions:
        words = "phi(q, t) = 0, the constraints on positions: their rates come first in constraint_velocity"
        made.insert(0, Part("constraints", words, (tied.positions,), program, column(tied.phi)))
    return (
        *made,
        Part("constraint_jacobian", "J", (m, n), program, _nonzero(program, partials)),
        Part("constraint_acceleration", "gamma = J' q' + j'", (m,), program, column(tied.gamma)),
    )


def _corrections(tied: Tied, dynamics: ConstrainedDynamics) -> tuple[Part, ...]:
    """lambda and the shortest ways back to the constraints."""
    program, n = dynamics.program, len(dynamics.accelerations)

    def column(nodes: Sequence[Node]) -> dict[Place, Node]:
        return _nonzero(program, {(i,): node for i, node in enumerate(nodes)})

    step = "a Newton step, the shortest as M measures it"
    made = [
        Part(
            "multipliers",
            "lambda, in the order of constraint_velocity",
            (len(tied.rows),),
            program,
            column(dynamics.multipliers),
        ),
        Part("velocity_correction", f"What to add to q' for J q' + j = 0: {step}", (n,), program,
             column(dynamics.velocity_correction)),
    ]  # fmt: skip
    if tied.positions:
        words = f"What to add to q for phi = 0: {step}"
        made.insert(1, Part("position_correction", words, (n,), program, column(dynamics.position_correction)))
    return tuple(made)


def _nonzero(program: Program, entries: Mapping[Place, Node]) -> dict[Place, Node]:
    return {place: node for place, node in entries.items() if not program.vanishes(node)}
