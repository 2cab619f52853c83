"""Savings in the straight-line program: what it does not compute, or computes once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.program import Node, Program
from mbsym.expressions.message import Message, worded
from mbsym.mechanics import factorisation
from mbsym.mechanics.programs import ARTICULATED, FACTORISED, Programs, forward_dynamics, programs
from mbsym.mechanics.variables import ring_of
from mbsym.numerics.ledger.entry import COUNT, OPERATIONS, Measure, Saving
from mbsym.numerics.ledger.work import Work
from mbsym.numerics.planning.kinds import DEAD, ROUTE, SPARSITY, STEADY, SYMMETRY, VALUES, ZEROS
from mbsym.numerics.scenario import Scenario, changed
from mbsym.numerics.specialise import bound, substituted

#: Counted on this program where both routes apply; beyond so many coordinates only the bound is told.
MOST_COUNTED = 40


def steady_operations(work: Work) -> Iterator[Saving]:
    """What depends on the parameters alone is worked out once, against working it out in every state."""
    forward = work.forward
    every = forward.program.operations(forward.accelerations)
    measures = (Measure("operations of q'' for one state", OPERATIONS, every, work.operations(forward.accelerations)),)
    steady = every - int(measures[0].taken)
    why = Message("liveness: no coordinate, velocity or time reaches them")
    yield Saving(STEADY, (Message("[[count]] subexpressions", count=steady),), why, Certainty.PROVED, measures)


def dead_operations(work: Work) -> Iterator[Saving]:
    """What the recursions wrote down on the way and q'' does not need."""
    forward = work.forward
    work.begin(work.price)
    alone = forward_dynamics(work.system, ring_of(work.system), forward.method)
    given = work.given
    every = [alone.program.node(k) for k in range(len(alone.program.instructions))]
    written, live = (alone.program.operations(x, given) for x in (every, alone.accelerations))
    measures = (Measure("operations written for one state", OPERATIONS, written, live),)
    why = Message("liveness: counted backwards from q'', no output needs them")
    yield Saving(DEAD, (Message("[[count]] operations", count=written - live),), why, Certainty.PROVED, measures)


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
    yield Saving(ROUTE, (what,), Message("both solve M q'' = f exactly"), Certainty.PROVED, measures)


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
    yield Saving(SPARSITY, (Message("[[count]] entries of M", count=2 * len(zeros)),), why, Certainty.PROVED, measures)


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
    yield Saving(SYMMETRY, (what,), why, Certainty.PROVED, measures)


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


def _cost(program: Program, outputs: Sequence[Node], given: Sequence[Node]) -> int:
    """Operations of the outputs beyond those of what is given."""
    needed, there = program.live(outputs), set(program.live(given))
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
    found: dict[int, Node] = {}
    for k in reversed(order):
        value = values[k]
        for j, x in rows[k].items():
            if j in found:
                value = program.difference(value, program.product(x, found[j]))
        found[k] = program.times(value, program.reciprocal(rows[k][k]))
    return tuple(found[k] for k in range(n))


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
        yield Saving(ZEROS, zero, why, Certainty.PROVED, measures)
    symbolic = work.operations(work.forward.accelerations)
    measures = (Measure("operations of q'' for one state", OPERATIONS, symbolic, without_zeros),)
    why = Message("exact folding: constants are rational, 1 x = x, and equal values make equal nodes")
    what = Message("[[count]] parameters", count=len(work.numbers.parameters))
    yield Saving(VALUES, (what,), why, Certainty.PROVED, measures)


def _generic(names: Sequence[str]) -> Mapping[str, Fraction]:
    """Different values that are neither 0 nor 1 nor equal to anything usual."""
    return {name: Fraction(7919 + 2 * place, 3571) for place, name in enumerate(names)}


def _specialised(work: Work, numbers: Scenario) -> int:
    fresh = bound(numbers)
    return fresh.operations(substituted(work.forward.program, work.forward.accelerations, fresh))
