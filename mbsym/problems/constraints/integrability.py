"""Frobenius' theorem, exactly: the distribution of the velocities that the constraints leave, and its Lie brackets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.derivative import directional
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.constraints.embedding import Embedding, Pivots, basis_vector, embedded
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import State
from mbsym.mechanics.variables import rate_of
from mbsym.problems.constraints.result import Integrability

#: A vector field on the coordinates and t: the components of the coordinates, then that of t.
Field = tuple[Polynomial, ...]
Rank = Callable[[Sequence[Field]], tuple[int, bool]]

#: So many fields are bracketed at most, and so often.
MOST_FIELDS, MOST_STEPS = 60, 12


def integrability(
    scene: Scene, embedding: Embedding, shift_matters: bool, position_rank: int, rank: Rank
) -> Integrability | None:
    """The growth of the distribution at generic points of the manifold; None where there are no velocity constraints.

    ``rank`` gives the rank of fields at points of the manifold, and whether it is proved that it is no greater.  Raises
    NoClosedForm where brackets outgrow the budget.
    """
    ring, n = scene.ring, len(scene.system.coordinates)
    imposed = len(embedding.dependent) - position_rank
    if imposed <= 0:
        return None
    fields = _fields(scene, embedding, shift_matters)
    whole = n - position_rank + shift_matters
    growth, bounded = _growth(fields, whole, lambda x, y: bracket(scene, x, y), lambda x: is_nothing(ring, x), rank)
    # A rank that is reached is proved; that it goes no further only where the ring says so.
    reached = growth[-1]
    proved = reached == whole or bounded or (reached == growth[0] and _is_involutive(scene, embedding, shift_matters))
    certainty = Certainty.PROVED if proved else Certainty.VERIFIED
    return Integrability(growth, whole - reached, imposed, certainty, shift_matters)


def _growth(
    fields: Sequence[Any],
    whole: int,
    bracketed: Callable[[Any, Any], Any],
    vanishes: Callable[[Any], bool],
    rank: Callable[[Sequence[Any]], tuple[int, bool]],
) -> tuple[tuple[int, ...], bool]:
    """The ranks of fields, with their brackets, and so on, and whether it is proved that these are no greater."""
    growth, layer, seen = [len(fields)], list(fields), list(fields)
    reached, bounded = rank(seen)
    for _ in range(MOST_STEPS):
        if reached == whole:
            return tuple(growth), bounded
        before, next_layer = reached, []
        for field in (x for a in fields for b in layer if not vanishes(x := bracketed(a, b))):
            more, sure = rank([*seen, field])
            if more > reached:
                next_layer.append(field)
                seen.append(field)
                reached = more
            else:
                bounded = bounded and sure
            if reached == whole or len(seen) > MOST_FIELDS:
                break
        growth.append(reached)
        if reached == before:
            return tuple(growth), bounded
        layer = next_layer
    return tuple(growth), False


def by_program(
    coordinates: Sequence[str], rows: ConstrainedPrograms, pivots: Pivots, position_rank: int, points: Sequence[State]
) -> Integrability | None:
    """The same where closed formulas outgrow their budget: fields and brackets as straight-line programs.

    For constraints without time.  That the brackets span everything at one certified point is a proof; that they do not
    at these points is none, and nothing is said then.  Raises Failure as the program does.
    """
    program, n = rows.tree.program, len(coordinates)
    inputs = [rows.environment[name] for name in coordinates]
    sides = [(program.zero, program.zero)] * len(rows.names)
    embedding = embedded(program, rows.jacobian, sides, pivots)
    fields = [tuple(basis_vector(program, embedding, place)) for place in range(len(embedding.free))]

    def bracketed(a: Sequence[Node], b: Sequence[Node]) -> tuple[Node, ...]:
        forwards, back = directional(program, b, inputs, a), directional(program, a, inputs, b)
        return tuple(x - y for x, y in zip(forwards, back, strict=True))

    def rank(vectors: Sequence[Sequence[Node]]) -> tuple[int, bool]:
        best = 0
        for point in points:
            try:
                flat = program.evaluate([x for v in vectors for x in v], point.values, point.numbers)
            except ZeroDivisionError:  # the dependent velocities are singular just there
                continue
            best = max(best, eliminated([flat[i : i + n] for i in range(0, len(flat), n)], range(n)).rank)
        return best, best == len(vectors)

    whole, imposed = n - position_rank, len(embedding.dependent) - position_rank
    growth, _ = _growth(fields, whole, bracketed, lambda x: all(map(program.vanishes, x)), rank)
    if growth[-1] < whole:
        return None
    return Integrability(growth, 0, imposed, Certainty.PROVED, rheonomic=False)


def _is_involutive(scene: Scene, embedding: Embedding, shift_matters: bool) -> bool:
    """Whether the ring proves Frobenius' condition: Y's columns and (y0, 1) commute.

    Their components of the independent coordinates and of t are constants; so a bracket has none there, and is a
    combination of the fields only if it is zero.
    """
    ring = scene.ring
    fields = _fields(scene, replace(embedding, determinant=ring.one), shift_matters)
    try:
        return all(ring.is_zero(x) is True for a, b in combinations(fields, 2) for x in bracket(scene, a, b))
    except Failure:
        return False


def _fields(scene: Scene, embedding: Embedding, shift_matters: bool) -> list[Field]:
    """Y's columns and (y0, 1), each times the determinant, which leaves their span and clears the denominators."""
    ring = scene.ring
    fields = [[*basis_vector(ring, embedding, place), ring.zero] for place in range(len(embedding.free))]
    if shift_matters:
        drift = [ring.zero] * len(scene.system.coordinates)
        for k, x in zip(embedding.dependent, embedding.shift, strict=True):
            drift[k] = x
        fields.append([*drift, ring.one])
    return [tuple(ring.reduce(ring.times(embedding.determinant, x)) for x in field) for field in fields]


def is_nothing(ring: Ring, field: Field) -> bool:
    return all(map(ring.vanishes, field))


def bracket(scene: Scene, a: Field, b: Field) -> Field:
    """[a, b] = (Db) a - (Da) b, components in the ring."""
    ring = scene.ring
    return tuple(ring.reduce(along(scene, a, y) - along(scene, b, x)) for x, y in zip(a, b, strict=True))


def along(scene: Scene, field: Field, x: Polynomial) -> Polynomial:
    """The derivative of x along a field; what is prescribed moves with t."""
    ring = scene.ring
    total = ring.zero
    for name, component in zip(scene.system.coordinates, field, strict=False):
        if not ring.vanishes(component):
            total = total + ring.times(component, ring.derivative(x, name))
    clock = field[-1]
    if not ring.vanishes(clock):
        total = total + ring.times(clock, rate_of(ring, scene.lower, scene.system, x))
    return ring.reduce(total)


def is_exact_by_itself(scene: Scene, row: Sequence[Polynomial], shift: Polynomial) -> bool | None:
    """Whether one form  omega = J dq + j dt  has an integrating factor: omega ^ d omega = 0; None where undecided.

    Its components are  omega_i (d_j omega_k - d_k omega_j) + cyclic  over coordinates and t.
    """
    ring, names = scene.ring, scene.system.coordinates
    form = [*row, shift]
    present = [i for i, x in enumerate(form) if not ring.vanishes(x)]

    def slope(x: Polynomial, i: int) -> Polynomial:
        return ring.derivative(x, names[i]) if i < len(names) else rate_of(ring, scene.lower, scene.system, x)

    def curl(i: int, k: int) -> Polynomial:
        return slope(form[k], i) - slope(form[i], k)

    decided: bool | None = True
    try:
        for i, j, k in combinations(range(len(form)), 3):
            if not {i, j, k} & set(present):
                continue
            total = ring.times(form[i], curl(j, k)) + ring.times(form[j], curl(k, i)) + ring.times(form[k], curl(i, j))
            zero = ring.is_zero(ring.reduce(total))
            if zero is False:
                return False
            decided = decided and zero
    except Failure:
        return None
    return decided or None


def undecided(imposed: int, rheonomic: bool) -> Integrability:
    """Nothing is known: formulas outgrew their budget."""
    return Integrability((), None, imposed, Certainty.UNDECIDED, rheonomic)
