"""All kinds of savings, and the ledger of one run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from math import isfinite
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import BUDGET as DETERMINANT
from mbsym.algebra.characteristic import characteristic_polynomial
from mbsym.algebra.failures import Failure, Limit, SingularPoint
from mbsym.algebra.program import Node, Program
from mbsym.analysis import PROBLEMS, USUAL_PROBLEMS, Analysis
from mbsym.expressions.message import Message, joined, worded
from mbsym.formulas.formula import Matrix
from mbsym.mechanics import factorisation
from mbsym.mechanics.programs import ARTICULATED, FACTORISED, Programs, forward_dynamics, programs
from mbsym.mechanics.variables import ring_of
from mbsym.model.system import rational
from mbsym.numerics.body_motion import BodyMotions, body_motions
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays
from mbsym.numerics.ledger import described, motion
from mbsym.numerics.ledger.entry import COUNT, OPERATIONS, Ledger, Measure, Saving
from mbsym.numerics.ledger.work import BUDGET, AccuracyGoal, Counted, TooDear, Work
from mbsym.numerics.methods.interface import Breakdown, Setting
from mbsym.numerics.planning.choice import choose
from mbsym.numerics.planning.kinds import Kind
from mbsym.numerics.planning.model_choice import PART, Scene, Tried, model_chosen, model_settled
from mbsym.numerics.planning.models import Model, parted
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.planning.planning import outlined
from mbsym.numerics.scenario import Scenario, bound, changed, substituted
from mbsym.numerics.trade.trial import trial_of
from mbsym.problems.linearisation import Linearisation, components

# Savings in the straight-line program: what it does not compute, or computes once.


#: Counted on this program where both routes apply; beyond so many coordinates only the bound is told.
MOST_COUNTED = 40


def steady_operations(work: Work) -> Iterator[Saving]:
    """What depends on the parameters alone is worked out once, against working it out in every state."""
    forward = work.forward
    every = forward.program.operations(forward.accelerations)
    measures = (Measure("operations of q'' for one state", OPERATIONS, every, work.operations(forward.accelerations)),)
    steady = every - int(measures[0].taken)
    why = Message("liveness: no coordinate, velocity or time reaches them")
    yield Saving(Kind.STEADY, (Message("[[count]] subexpressions", count=steady),), why, Certainty.PROVED, measures)


def dead_operations(work: Work) -> Iterator[Saving]:
    """What the recursions wrote down on the way and q'' does not need."""
    forward = work.forward
    work.begin(work.price)
    alone = forward_dynamics(work.system, ring_of(work.system), forward.method)
    constant_names = work.given
    every = [alone.program.node(k) for k in range(len(alone.program.instructions))]
    written, live = (alone.program.operations(x, constant_names) for x in (every, alone.accelerations))
    measures = (Measure("operations written for one state", OPERATIONS, written, live),)
    why = Message("liveness: counted backwards from q'', no output needs them")
    yield Saving(Kind.DEAD, (Message("[[count]] operations", count=written - live),), why, Certainty.PROVED, measures)


def route(work: Work) -> Iterator[Saving]:
    """The cheaper of two exact ways to q'', against the other."""
    forward = work.forward
    other = FACTORISED if forward.method == ARTICULATED else ARTICULATED
    if other not in forward.operations:
        return
    costs = dict(forward.operations)
    bound_only = other in forward.estimated
    if bound_only and len(work.system.coordinates) <= MOST_COUNTED:
        work.begin(work.price)
        costs[other] = forward_dynamics(work.system, ring_of(work.system), other).operations[other]
        bound_only = False
    quantity = "operations of q'' and the pivots for one state"
    measures = (Measure(quantity, OPERATIONS, costs[other], costs[forward.method], bound_only),)
    what = Message("[[method]] instead of [[other]]", method=worded(forward.method), other=worded(other))
    yield Saving(Kind.ROUTE, (what,), Message("both solve M q'' = f exactly"), Certainty.PROVED, measures)


def branch_sparsity(work: Work) -> Iterator[Saving]:
    """Zeros of M that the factorisation keeps, against factorising a matrix without zeros."""
    found = _factorised(work)
    if found is None:
        return
    program, matrix, n = found.program, found.mass_matrix, len(found.forcing)
    zeros = [(i, j) for i in range(n) for j in range(i) if program.vanishes(matrix[i][j])]
    if not zeros:
        return
    full = [list(row) for row in matrix]
    for i, j in zeros:
        full[i][j] = full[j][i] = program.input(f"M {i} {j}")
    sparse, dense = (_solving(program, x, found.forcing) for x in (matrix, full))
    measures = (
        Measure("entries of M", COUNT, n * n, n * n - 2 * len(zeros)),
        Measure("operations of solving M q'' = f", OPERATIONS, dense, sparse),
    )
    why = Message(
        "structural zeros: coordinates on different branches, or normal to each other, share no kinetic energy"
    )
    yield Saving(
        Kind.SPARSITY, (Message("[[count]] entries of M", count=2 * len(zeros)),), why, Certainty.PROVED, measures
    )


def symmetry(work: Work) -> Iterator[Saving]:
    """L D L^T of a symmetric matrix, against Gaussian elimination of the same matrix."""
    found = _factorised(work)
    if found is None:
        return
    program, matrix, n = found.program, found.mass_matrix, len(found.forcing)
    below = sum(not program.vanishes(matrix[i][j]) for i in range(n) for j in range(i))
    half = _solving(program, matrix, found.forcing)
    nodes = [x for row in matrix for x in row] + [*found.forcing]
    whole = _cost(program, _eliminated(program, matrix, found.forcing), nodes)
    measures = (
        Measure("entries of M", COUNT, n + 2 * below, n + below),
        Measure("operations of solving M q'' = f", OPERATIONS, whole, half),
    )
    why = Message("identity: M_ij = d2T/dq_i' dq_j' = M_ji")
    what = Message("[[count]] entries below the diagonal", count=below)
    yield Saving(Kind.SYMMETRY, (what,), why, Certainty.PROVED, measures)


def _factorised(work: Work) -> Programs | None:
    """M and f as nodes, where q'' is found by factorising M."""
    if work.forward.method != FACTORISED:
        return None
    work.begin(work.price)
    return programs(work.system, ring_of(work.system))


def _solving(program: Program, matrix: Sequence[Sequence[Node]], right: Sequence[Node]) -> int:
    """Operations of x with M x = f by L D L^T, M and f given."""
    nodes = [x for row in matrix for x in row] + [*right]
    return _cost(program, factorisation.solve(program, matrix, right)[0], nodes)


def _cost(program: Program, outputs: Sequence[Node], nodes: Sequence[Node]) -> int:
    """Operations of the outputs beyond those of what is given."""
    needed, there = program.live(outputs), set(program.live(nodes))
    silent = ("constant", "input")
    return sum(k not in there and program.instructions[k].operation not in silent for k in needed)


def _eliminated(program: Program, matrix: Sequence[Sequence[Node]], right: Sequence[Node]) -> tuple[Node, ...]:
    """x with M x = f by Gaussian elimination without pivoting, from the last row to the first, zeros left out."""
    n = len(right)
    rows = [{j: x for j, x in enumerate(row) if not program.vanishes(x)} for row in matrix]
    order = factorisation.elimination_order([set(row) for row in rows])
    values, done = list(right), set()
    for k in order:
        inverse = program.reciprocal(rows[k][k])
        done.add(k)
        for i in range(n):
            if i in done or k not in rows[i]:
                continue
            factor = program.product(rows[i].pop(k), inverse)
            for j, x in rows[k].items():
                if j not in done:
                    change = program.product(factor, x)
                    rows[i][j] = program.difference(rows[i][j], change) if j in rows[i] else -change
            values[i] = program.difference(values[i], program.product(factor, values[k]))
    nodes: dict[int, Node] = {}
    for k in reversed(order):
        value = values[k]
        for j, x in rows[k].items():
            if j in nodes:
                value = program.difference(value, program.product(x, nodes[j]))
        nodes[k] = program.times(value, program.reciprocal(rows[k][k]))
    return tuple(nodes[k] for k in range(n))


def values(work: Work) -> Iterator[Saving]:
    """Parameters whose value is zero, or special in another way, against values without any relation."""
    if work.numbers is None:
        return
    zero = tuple(name for name, x in work.numbers.parameters.items() if x == 0)
    try:
        here = _specialised(work, work.numbers)
        without_zeros = _specialised(work, changed(work.numbers, **_generic(zero)))
    except SingularPoint:
        return
    if zero:
        measures = (Measure("operations of q'' at these values", OPERATIONS, without_zeros, here),)
        why = Message("exact folding: 0 x = 0, so their terms are no instructions")
        yield Saving(Kind.ZEROS, zero, why, Certainty.PROVED, measures)
    symbolic = work.operations(work.forward.accelerations)
    measures = (Measure("operations of q'' for one state", OPERATIONS, symbolic, without_zeros),)
    why = Message("exact folding: constants are rational, 1 x = x, and equal values make equal nodes")
    what = Message("[[count]] parameters", count=len(work.numbers.parameters))
    yield Saving(Kind.VALUES, (what,), why, Certainty.PROVED, measures)


def _generic(names: Sequence[str]) -> Mapping[str, Fraction]:
    """Different values that are neither 0 nor 1 nor equal to anything usual."""
    return {name: Fraction(7919 + 2 * place, 3571) for place, name in enumerate(names)}


def _specialised(work: Work, numbers: Scenario) -> int:
    fresh = bound(numbers)
    return fresh.operations(substituted(work.forward.program, work.forward.accelerations, fresh))


#: The run's tolerance, the times at which it is looked at, and the part of the motion that may be out of the plane.
TIGHT, _TIMES, FLAT = 1e-12, 201, 1e-8

#: A direction is a coordinate axis where no other component is larger; the plane is then one of the coordinates'.
ALONG = 1e-6


def skew_plane(work: Work) -> Iterator[Saving]:
    """Motion normal to a direction that is no axis of inertial space, until the time of the accuracy asked for."""
    if work.goal is None or work.scenario is None:
        return
    work.begin(work.price)
    dynamics = Dynamics(work.scenario)
    times = np.linspace(0.0, work.goal.time, _TIMES)
    try:
        method = choose(dynamics, TIGHT, work.goal.time).method
        states = trial_of(method, dynamics, Setting(TIGHT), times).whole().states
        rates = arrays.kernel(dynamics.right_hand_side)(np.vstack([times, states]))[dynamics.size :]
        motions = body_motions(work.scenario, times, states, rates)
    except (Breakdown, Failure):
        return
    turning, moving = _kinds(work, motions)
    e, off = plane_of(motions, turning, moving)
    if e is None or np.sum(np.abs(e) > ALONG) < 2:
        return
    direction = ", ".join(f"{x:.6g}" for x in e)
    why = Message(
        "at [[times]] times until [[time]] all angular velocities are along ([[direction]]) of "
        "inertial space and all velocities normal to it, but for [[part]] of them; told, not "
        "used: mbsym simulate integrates all coordinates",
        times=_TIMES,
        time=f"{work.goal.time:g}",
        direction=direction,
        part=f"{off:.0e}",
    )
    measures = (
        Measure(
            "components of velocities and angular velocities",
            COUNT,
            3 * sum(turning) + 3 * sum(moving),
            sum(turning) + 2 * sum(moving),
        ),
    )
    names = tuple(name for name, a, b in zip(motions.names, turning, moving, strict=True) if a or b)
    yield Saving(Kind.SKEW, names, why, Certainty.VERIFIED, measures)


def _kinds(work: Work, motions: BodyMotions) -> tuple[list[bool], list[bool]]:
    """Which bodies have inertia, and which a mass: of the others it does not matter how they move."""
    bodies = [work.system.body(name) for name in motions.names]
    return [body.inertia is not None for body in bodies], [rational(body.mass) != 0 for body in bodies]


def plane_of(motions: BodyMotions, turning: list[bool], moving: list[bool]) -> tuple[Any | None, float]:
    """(e, the largest part of the motion that is not normal to it); None where there is no such direction."""
    spins = np.einsum("kijt,kit->jkt", motions.axes, motions.angular_velocities)[:, turning].reshape(3, -1)
    speeds = np.moveaxis(motions.velocities, 1, 0)[:, moving].reshape(3, -1)
    if np.any(spins):
        e = np.linalg.svd(spins, full_matrices=False)[0][:, 0]
    else:
        sides, sizes, _ = np.linalg.svd(speeds, full_matrices=False)
        if not sizes[1] > FLAT**0.5 * sizes[0]:
            return None, 0.0  # at rest, or along one line, which lies in many planes
        e = sides[:, 2]
    e = e * np.sign(e[np.argmax(np.abs(e))])
    off = max(_part(spins - np.outer(e, e @ spins), spins), _part(e @ speeds, speeds))
    return (e, off) if off <= FLAT else (None, off)


def _part(of: Any, whole: Any) -> float:
    largest = float(np.max(np.abs(whole), initial=0.0))
    return float(np.max(np.abs(of), initial=0.0)) / largest if largest else 0.0


#: What characteristic polynomials of all parts and of the whole cost, about.
CHARACTERISTIC = 1.0

#: Bounds that end a derivation because its result is too large, not because there is none.
TOO_LARGE = (Limit.TERMS, Limit.WORK, Limit.MEMORY)


def problems_not_asked(work: Work) -> Iterator[Saving]:
    """Problems of every run that nobody asked for and nothing asked for needed, against deriving them."""
    analysis = work.analysis
    left = [n for n in USUAL_PROBLEMS if n not in analysis.problems and PROBLEMS[n].attribute not in analysis.derived]
    for number in left:
        work.require(0.0)
        problem, stage = PROBLEMS[number], work.bounded.stage(number)
        if stage.failure is None:
            counted = Counted(_terms(stage.value), 0, stage.seconds)
        elif stage.failure.limit in TOO_LARGE:
            counted = _given_up(work, number)
        else:
            continue  # there is no such result, so nothing was saved
        why = Message("liveness: nobody asked for it, and nothing that was asked for needs it")
        if number == 3 and "linearisation" in analysis.derived:
            why = joined([why, Message("the linearisation is expanded while the equations are built")], "; ")
        what = Message("problem [[number]], [[title]]", number=number, title=worded(problem.title))
        measures = counted.measures(Counted(0, 0, 0.0), Message("it"))
        yield Saving(Kind.NOT_ASKED, (what,), why, Certainty.PROVED, measures)


def _given_up(work: Work, number: int) -> Counted:
    """What a problem costs by itself until the budgets end it."""
    alone = work.fresh(work.system)
    started = time.thread_time()
    alone.stage(number)
    return Counted(None, alone.ring.work, time.thread_time() - started)


def _terms(result: Any) -> int:
    """Terms of a problem's result, or of all of them where there are several."""
    return sum(item.formula.terms for item in result) if isinstance(result, tuple) else int(result.terms)


def vanishing_entries(work: Work) -> Iterator[Saving]:
    """Entries of M, D, G, K, N that are identically zero, and matrices that vanish as a whole."""
    linearisation = _linearisation(work)
    if linearisation is None:
        return
    letters = dict(zip("MDGKN", linearisation.matrices, strict=True))
    n = len(linearisation.coordinates)
    entries = sum(not m[i, j].is_zero for m in linearisation.matrices for i in range(n) for j in range(n))
    gone = [name for name, matrix in letters.items() if matrix.is_zero]
    what = [Message("[[count]] of [[all]] entries", count=5 * n * n - entries, all=5 * n * n)]
    if gone:
        what.append(Message("[[matrices]] as a whole", matrices=", ".join(gone)))
    why = Message("identities of the ring: their polynomials are 0")
    measures = (Measure("entries of M, D, G, K, N", COUNT, 5 * n * n, entries),)
    yield Saving(Kind.ENTRIES, tuple(what), why, Certainty.PROVED, measures)


def subsystems(work: Work) -> Iterator[Saving]:
    """Characteristic polynomials of subsystems, against that of the whole system."""
    linearisation = _linearisation(work)
    parts = components(linearisation.matrices) if linearisation is not None else []
    if linearisation is None or len(parts) < 2 or 6 not in work.analysis.problems:
        return
    work.begin(CHARACTERISTIC)
    divided = [_characteristic(work, linearisation, part) for part in parts]
    if any(item.terms is None for item in divided):
        return
    here = Counted(sum(x.terms or 0 for x in divided), sum(x.steps for x in divided), sum(x.seconds for x in divided))
    there = _characteristic(work, linearisation, range(len(linearisation.coordinates)))
    names = ("{" + ", ".join(linearisation.coordinates[i] for i in part) + "}" for part in parts)
    why = Message("identities of the ring: no matrix couples them, so the determinant is the product of theirs")
    measures = there.measures(here, "det(M s^2 + (D + G) s + K + N)")
    yield Saving(Kind.SUBSYSTEMS, tuple(names), why, Certainty.PROVED, measures)


def _linearisation(work: Work) -> Linearisation | None:
    if "linearisation" not in work.analysis.derived:
        return None
    linearisation: Linearisation | None = work.result("linearisation")
    return linearisation


def _characteristic(work: Work, linearisation: Linearisation, part: Sequence[int]) -> Counted:
    """The characteristic polynomial of some coordinates in the declared parameters, within its budget of products."""
    ring = linearisation.M[0, 0].ring

    def cut(*matrices: Matrix) -> list[list[Any]]:
        return [[ring.reduce(sum((m[i, j].polynomial for m in matrices), ring.zero)) for j in part] for i in part]

    def size() -> int | None:
        try:
            polynomial = characteristic_polynomial(
                cut(linearisation.M), cut(linearisation.D, linearisation.G), cut(linearisation.K, linearisation.N)
            )
        except Failure:
            return None
        return sum(len(x) for x in polynomial)

    terms, seconds = work.timed(size)
    return Counted(terms, DETERMINANT if terms is None else 0, seconds)


#: Times at which two motions are compared, besides the steps between.
TIMES = 501


def gravity_orders(work: Work) -> Iterator[Saving]:
    """Terms of the Newtonian field above the chosen order: their size, or what they change of the motion."""
    savings = list(described.gravity_orders(work))
    if work.goal is None or not savings:
        yield from savings
        return
    scene = _scene(work, work.goal)
    tried = None if scene is None else model_settled(scene, Model()).taken
    for saving in savings:
        yield saving if tried is None else _held(saving, tried, work.goal)


def simpler_model(work: Work) -> Iterator[Saving]:
    """What a run to the accuracy leaves out of the equations as well: all that is not linear, parameters, masses."""
    scene = None if work.goal is None else _scene(work, work.goal)
    if scene is None or work.goal is None:
        return
    taken = model_chosen(scene).taken
    model = taken.model
    before = scene.rich.right_hand_side.operations
    measures = (Measure("operations of the right-hand side at these values", OPERATIONS, before, taken.operations),)
    why = Message("simulate --accuracy [[accuracy]] leaves it out", accuracy=f"{work.goal.accuracy:g}")
    for kind, what in _left_out(scene, model):
        yield _held(Saving(kind, what, why, Certainty.ESTIMATED, measures), taken, work.goal)


def _left_out(scene: Scene, model: Model) -> Iterator[tuple[str, tuple[str, ...]]]:
    if model.linear:
        yield Kind.LINEARITY, (Message("all that is not linear in the deviation"),)
    bodies, others = parted(scene.scenario, model)
    if bodies:
        yield Kind.MASSES, bodies
    if others:
        yield Kind.LEFT_OUT, others


def _scene(work: Work, goal: AccuracyGoal) -> Scene | None:
    """The motion in outline; None without numbers, or where it does not come to the end."""
    if work.scenario is None:
        return None
    work.begin(work.price)
    try:
        return outlined(work.scenario, Accuracy(goal.accuracy), np.linspace(0, goal.time, TIMES))[0]
    except Breakdown:
        return None


def _held(saving: Saving, tried: Tried, goal: AccuracyGoal) -> Saving:
    """A saving with what it changes of the motion, beside what a model may change at this accuracy."""
    tolerable = PART * goal.accuracy
    if not isfinite(tried.worst):
        why = Message("[[why]]; what that changes of the motion could not be measured", why=saving.why)
        return replace(saving, why=joined(filter(None, (why, tried.why)), ": "), how=Certainty.UNDECIDED)
    word = Message("no more than" if tried.worst <= tolerable else "more than")
    text = (
        "until [[time]] it changes the motion by [[worst]] of its size, [[word]] the [[most]] that a model may at an "
        "accuracy of [[accuracy]]"
    )
    time, worst, most, accuracy = f"{goal.time:g}", f"{tried.worst:.1e}", f"{tolerable:g}", f"{goal.accuracy:g}"
    changed = Message(text, time=time, worst=worst, word=word, most=most, accuracy=accuracy)
    why = joined([saving.why, changed], "; ")
    return replace(saving, why=why, how=tried.how, error=tried.worst, tolerable=tolerable)


#: What each function looks for; the order is that of the ledger.
KINDS: Mapping[str, Callable[[Work], Iterator[Saving]]] = {
    Kind.RESTING: motion.resting_coordinates,
    Kind.PARTS: motion.separate_parts,
    Kind.WELDED: described.welded_bodies,
    Kind.MASSLESS: described.massless_bodies,
    Kind.POINTS: described.point_masses,
    Kind.AXES: described.unused_axes,
    Kind.TURNS: described.constant_rotations,
    Kind.SKEW: skew_plane,
    Kind.CYCLIC: motion.cyclic_coordinates,
    Kind.DROPPED: motion.dropped_parameters,
    Kind.ENTRIES: vanishing_entries,
    Kind.SUBSYSTEMS: subsystems,
    Kind.NOT_ASKED: problems_not_asked,
    Kind.SYMMETRY: symmetry,
    Kind.SPARSITY: branch_sparsity,
    Kind.ROUTE: route,
    Kind.DEAD: dead_operations,
    Kind.STEADY: steady_operations,
    Kind.VALUES: values,
    Kind.GRAVITY: gravity_orders,
    Kind.LEFT_OUT: simpler_model,
}

#: Those that hold whatever constraints there are, and in any speeds: the others take the system for an open tree whose
#: velocities are those of its coordinates (no momentum is constant merely because L does not hold its coordinate).
OF_ANY_SYSTEM = frozenset(
    (Kind.MASSLESS, Kind.POINTS, Kind.AXES, Kind.TURNS, Kind.ENTRIES, Kind.SUBSYSTEMS, Kind.NOT_ASKED)
)


def ledger(analysis: Analysis, budget: float = BUDGET, goal: AccuracyGoal | None = None) -> Ledger:
    """What this run left out, why that is safe, and what it saved; call it when the run itself is over.

    ``budget`` bounds the counterfactuals together: counted work, and none is begun that would probably exceed it.  What
    the equations leave out is held against ``goal``, an accuracy over a time.
    """
    work = Work(analysis, budget, goal)
    entries: list[Saving] = []
    unmeasured = []
    tied = bool(analysis.system.constraints or analysis.system.speeds)
    for kind, savings in KINDS.items():
        if tied and kind not in OF_ANY_SYSTEM:
            continue
        try:
            entries += [saving for saving in savings(work) if saving.saves]
        except TooDear:
            unmeasured.append(kind)
        except Failure:
            continue
    return Ledger(tuple(entries), tuple(unmeasured))
