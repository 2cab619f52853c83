"""Savings that the motion allows: coordinates that rest, cyclic coordinates, parameters that drop out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from flint import arb, ctx

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import names
from mbsym.mechanics.kinematics import over_ring
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.states import ball_states
from mbsym.mechanics.variables import expressions, ring_of
from mbsym.model.system import INERTIAL, System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ledger.entry import COUNT, OPERATIONS, SECONDS, TERMS, Measure, Saving
from mbsym.numerics.ledger.work import INSTRUCTION, Work, holds
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.planning.reduced import reduced
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.separable import separated
from mbsym.problems.energy import Energy

#: Random states, and bits, at which a parameter is given two values; and instructions that this may cost in all.
STATES, PRECISION, INSTRUCTIONS = 3, 256, 3_000_000

#: A reason that lets terms of L keep the parameter.
FACTOR = Message("identity of the ring: it only changes a common factor of each row of M q'' = f, and cancels")


def resting_coordinates(work: Work) -> Iterator[Saving]:
    """Coordinates that rest in this scene, against integrating all of them."""
    scenario = work.scenario
    if scenario is None:
        return
    whole, seconds = work.timed(lambda: _written(scenario))
    work.begin(INSTRUCTION * len(whole.right_hand_side.program.instructions))
    subsystem = reduced(whole)
    if subsystem is None:
        return
    _, spent = work.timed(lambda: _written(subsystem.reduction.scenario))
    before, after = subsystem.operations
    normal = _plane(subsystem.dynamics.system)
    why = Message("from this initial state, with q_S held, f_S and M_SF vanish for all other q, q', t: q_S'' = 0")
    if normal:
        text = "what is left moves in the plane normal to inertial axis [[axis]]"
        why = joined([why, Message(text, axis=normal)], "; ")
    n = whole.size
    measures = (
        Measure("coordinates to integrate", COUNT, n, n - len(subsystem.names)),
        Measure("operations of the right-hand side at these values", OPERATIONS, before, after),
        Measure("seconds of writing the right-hand side", SECONDS, seconds, spent),
    )
    kind = Kind.PLANE if normal else Kind.RESTING
    yield Saving(kind, subsystem.names, why, subsystem.reduction.how, measures)


def separate_parts(work: Work) -> Iterator[Saving]:
    """Parts that nothing links at these values, each with steps of its own, against one step for all."""
    scenario = work.scenario
    if scenario is None:
        return
    whole = _written(scenario)
    work.begin(INSTRUCTION * len(whole.right_hand_side.program.instructions))
    parts = separated(whole)
    if len(parts) < 2:
        return
    sizes = [len(part.names) for part in parts]
    measures = (
        Measure("coordinates that share their steps", COUNT, whole.size, max(sizes)),
        Measure(
            "entries of the Jacobian of an implicit step",
            COUNT,
            (2 * whole.size) ** 2,
            sum(4 * n * n for n in sizes),
        ),
    )
    why = Message("the blocks of M between them vanish, and none occurs in the accelerations of another")
    yield Saving(Kind.PARTS, tuple(" and ".join(part.names) for part in parts), why, Certainty.PROVED, measures)


def _written(scenario: Scenario) -> Dynamics:
    """The dynamics of a scenario with its right-hand side."""
    dynamics = Dynamics(scenario)
    assert dynamics.right_hand_side.outputs
    return dynamics


def _plane(system: System) -> int | None:
    """The inertial axis (1 to 3) to which all motion is normal: omega_k = w e, V_Ck.e = 0 for every body."""
    ring = ring_of(system)
    try:
        scene = over_ring(system, ring)
        axes = {1, 2, 3}
        for motion in scene.motions.values():
            spin = scene.to_axes(motion.angular_velocity, INERTIAL)
            velocity = scene.to_axes(motion.velocity_mass_centre, INERTIAL)
            for axis in tuple(axes):
                others = [x for k, x in enumerate(spin, start=1) if k != axis]
                if not all(ring.reduce(x).is_zero() for x in (*others, velocity[axis - 1])):
                    axes.discard(axis)
    except Failure:
        return None
    return min(axes) if len(axes) == 1 else None


def cyclic_coordinates(work: Work) -> Iterator[Saving]:
    """Coordinates that neither L nor the other loads hold, and that no force drives."""
    energy: Energy | None = work.result("energy")
    if energy is None or not set(energy.cyclic) & set(work.system.coordinates):
        return
    cyclic = tuple(name for name in energy.cyclic if name in _undriven(work))
    if not cyclic:
        return
    n = len(work.system.coordinates)
    why = Message(
        "identities of the ring: dL/dq = 0 and Q = 0, so p = dL/dq' is constant and q follows by "
        "a quadrature; told, not used: mbsym simulate integrates them"
    )
    measures = (Measure("order of the equations, on a level of the momenta", COUNT, 2 * n, 2 * (n - len(cyclic))),)
    yield Saving(Kind.CYCLIC, cyclic, why, Certainty.PROVED, measures)


def _undriven(work: Work) -> set[str]:
    """The coordinates on which no force without a force function acts."""
    equations = work.result("equations") if "equations" in work.analysis.derived else None
    if equations is not None:
        forces = dict(zip(work.system.coordinates, equations.generalized_force, strict=True))
        return {name for name, force in forces.items() if force.is_zero}
    ring = ring_of(work.system)
    try:
        generalized = generalized_forces(over_ring(work.system, ring))
    except Failure:
        return set()
    return {name for name, force in generalized.items() if ring.reduce(force).is_zero()}


def dropped_parameters(work: Work) -> Iterator[Saving]:
    """Parameters of bodies and loads that the accelerations do not depend on, by how that is known."""
    parts = (work.system.bodies, work.system.loads, work.system.prescribed)
    occurring = {name for x in expressions(parts) for name in names(x)}
    used = [name for name in work.system.parameter_names if name in occurring]
    forward = work.forward
    live = {
        str(x.payload)
        for k in forward.program.live(forward.accelerations)
        if (x := forward.program.instructions[k])[0] == "input"
    }
    unread = [name for name in used if name not in live]
    if unread:
        why = Message("liveness: no instruction that q'' needs reads it")
        yield Saving(Kind.DROPPED, tuple(unread), why, Certainty.PROVED, _dropped(work, used, unread))
    read = [name for name in used if name in live]
    by_reason: dict[tuple[str, Certainty], list[str]] = {}
    for name in _without_influence(work, read):
        by_reason.setdefault(_reason(work, name), []).append(name)
    for (reason, how), parameters in by_reason.items():
        measures = _dropped(work, used, parameters)[: 1 if reason == FACTOR else 2]
        yield Saving(Kind.DROPPED, tuple(parameters), reason, how, measures)


def _dropped(work: Work, used: Sequence[str], parameters: Sequence[str]) -> tuple[Measure, ...]:
    measures = [Measure("parameters that q'' depends on", COUNT, len(used), len(used) - len(parameters))]
    energy: Energy | None = work.result("energy")
    if energy is not None:
        ring = energy.kinetic_energy.ring
        lagrangian = ring.reduce(energy.kinetic_energy.polynomial + energy.force_function.polynomial)
        terms = len(lagrangian)
        without = sum(_term_holds(ring, term, parameters) for term in _terms(ring, lagrangian))
        measures.append(Measure("terms of L without them", TERMS, terms, terms - without))
    return tuple(measures)


def _terms(ring: Ring, x: Polynomial) -> Iterator[Polynomial]:
    for monomial, coefficient in zip(x.monoms(), x.coeffs(), strict=True):
        yield ring.context.term(exp_vec=monomial, coeff=coefficient)


def _term_holds(ring: Ring, term: Polynomial, parameters: Sequence[str]) -> bool:
    return any(holds(ring, term, name) for name in parameters)


def _without_influence(work: Work, read: Sequence[str]) -> list[str]:
    """Those whose value makes no difference to q'' at random states, in balls of ``PRECISION`` bits."""
    forward = work.forward
    live = forward.program.live(forward.accelerations)
    size = len(live)
    if any(forward.program.instructions[number].operation in ("abs", "sign") for number in live):
        return []  # what makes no difference at some states may make one beyond a jump
    if size * (len(read) + 1) * STATES > INSTRUCTIONS:
        return []
    left = list(read)
    with ctx.workprec(PRECISION):
        for state in ball_states(work.system, ring_of(work.system), STATES):
            at = [work.accelerations_at(state.values)]
            for name in tuple(left):
                other = work.accelerations_at({**state.values, name: state.values[name] * arb(7) / 5})
                if not all(_same(a, b) for a, b in zip(at[0], other, strict=True)):
                    left.remove(name)
    return left


def _same(a: arb, b: arb) -> bool:
    """Whether two balls are narrow and overlap."""
    narrow = all(x.is_finite() and x.rad() <= arb(2) ** (-PRECISION // 2) * (1 + abs(x.mid())) for x in (a, b))
    return bool(narrow and a.overlaps(b))


def _reason(work: Work, name: str) -> tuple[str, Certainty]:
    """Why a parameter makes no difference: (justification, how)."""
    equations = work.result("equations")
    if equations is not None:
        ring, matrix = equations.mass_matrix[0, 0].ring, equations.mass_matrix.polynomials
        rows = [[*row, force.polynomial] for row, force in zip(matrix, equations.forcing, strict=True)]
        if not any(holds(ring, x, name) for row in rows for x in row):
            return Message("identity of the ring: it cancels from M and f"), Certainty.PROVED
        if _proportional(ring, rows, name):
            return FACTOR, Certainty.PROVED
    text = "q'' is the same for two values at [[states]] random states, in [[bits]]-bit balls"
    return Message(text, states=STATES, bits=PRECISION), Certainty.VERIFIED


def _proportional(ring: Ring, rows: Sequence[Sequence[Polynomial]], name: str) -> bool:
    """Whether each row with a parameter p is a multiple of the same row with p = 1: e_j(p) e_k(1) = e_k(p) e_j(1)."""
    at_one = {ring.index("parameter", name): ring.one}
    try:
        for row in rows:
            other = [ring.substitute(x, at_one) for x in row]
            k = next(k for k, x in enumerate(row) if not x.is_zero() and not other[k].is_zero())
            for x, y in zip(row, other, strict=True):
                if ring.is_zero(ring.times(x, other[k]) - ring.times(row[k], y)) is not True:
                    return False
    except (Failure, StopIteration):
        return False
    return True
