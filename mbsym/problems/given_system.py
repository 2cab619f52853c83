"""Problem 5 of a system that is given by its matrices: these, split into symmetric and skew parts.

    D = (C + C^T)/2,  G = (C - C^T)/2,  K = (S + S^T)/2,  N = (S - S^T)/2

The equations are the ones that are given, exactly linear, and decided as such (``stability.linear_theory``).  What they
may have been linearised from nobody has told: asymptotic stability and instability carry over to it (Lyapunov's first
method), stability does not.  No coordinate counts as cyclic.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from flint import arb, ctx, fmpq, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, message_of
from mbsym.algebra.matrices import added, determinant
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Signs
from mbsym.expressions.message import Message
from mbsym.expressions.place import Span
from mbsym.mechanics.given_matrices import given_matrices
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.mechanics.states import ball_states
from mbsym.model.admissibility import known_values, number_of
from mbsym.model.linear import MATRICES, SYMMETRIC, GivenMatrix, LinearModel
from mbsym.problems.checks import FAILED, NUMERICAL, PRECISION, UNDECIDED, Check
from mbsym.problems.dissipation import Balance, EnergyLaw
from mbsym.problems.linearisation import Linearisation, assemble

ROUTE = "given matrices"

#: Points at which the matrices are compared with the description.
POINTS = 3

#: Minors of larger mass matrices are not written out in symbols to see whether their signs are wrong.
MOST_MINORS = 4


def by_matrices(scene: Scene[Polynomial], inputs: tuple[str, ...]) -> Linearisation:
    """The matrices of the description, relations used, with its ``inputs``.  Raises NoClosedForm or SingularPoint."""
    linear = scene.system.linear
    assert linear is not None
    whole = given_matrices(scene, linear)
    return assemble(scene, None, tuple(whole), ROUTE, inputs)


class OpenBalance(Balance):
    """Given equations are exactly linear; no coordinate is cyclic, and what energy they have the matrices show."""

    @property
    def exactly_linear(self) -> bool:
        return True

    @property
    def law(self) -> EnergyLaw:
        return EnergyLaw.UNKNOWN

    @property
    def ignorable(self) -> tuple[str, ...]:
        return ()

    @property
    def driven(self) -> tuple[str, ...]:
        return ()

    def at(self, values: object) -> Balance:
        return self


# --- the second route: the description at numbers, without the ring ---


def check_matrices(scene: Scene[Polynomial], linearisation: Linearisation) -> Check:
    """M, D + G, K + N and B against the formulas of the description, evaluated in balls at random parameters."""
    linear, ring, second = scene.system.linear, scene.ring, "formulas of the description at numbers"
    assert linear is not None
    wrong: set[str] = set()
    with ctx.workprec(PRECISION):
        for state in ball_states(scene.system, ring, POINTS):
            values = dict(state.values)
            try:
                _follow(scene, state.numbers, values)
                there = Scene(scene.system, state.numbers, values, ring, bodies=False)
                matrices = given_matrices(there, linear)
                carry = Carrier(ring, state.numbers, values)
                derived = [[[carry(x) for x in row] for row in matrix.polynomials] for matrix in linearisation.matrices]
                gains = (
                    [] if linearisation.B is None else [[carry(x) for x in row] for row in linearisation.B.polynomials]
                )
            except Failure as reason:
                return Check("linearisation", ROUTE, second, UNDECIDED, message_of(reason))
            mass, damping, gyroscopic, stiffness, circulatory = derived
            pairs: list[tuple[str, Any, Any]] = [("M", mass, matrices.mass), ("B", gains, matrices.inputs)]
            pairs.append(("D + G", added(damping, gyroscopic), matrices.rates))
            pairs.append(("K + N", added(stiffness, circulatory), matrices.places))
            wrong |= {name for name, first, rows in pairs if gains or name != "B" if not _same(first, rows)}
            wrong |= {name for name, rows in zip("MDK", (mass, damping, stiffness), strict=True) if not _is(rows, 1)}
            wrong |= {name for name, rows in zip("GN", (gyroscopic, circulatory), strict=True) if not _is(rows, -1)}
    if wrong:
        return Check(
            "linearisation", ROUTE, second, FAILED, Message("differs in [[wrong]]", wrong=", ".join(sorted(wrong)))
        )
    return Check(
        "linearisation",
        ROUTE,
        second,
        NUMERICAL,
        Message("to [[bits]] bits at [[count]] random points", bits=PRECISION, count=POINTS),
        POINTS,
    )


def _follow(scene: Scene[Polynomial], algebra: Any, values: dict[str, Any]) -> None:
    """Puts what the relations say in place of the values of their left sides; they hold no circle."""
    for _ in scene.system.relations:
        for relation in scene.system.relations:
            values[relation.name] = Lowering(algebra, values)(relation.value)


def _same(first: Any, second: Any) -> bool:
    return all(_near(a, b) for rows in zip(first, second, strict=True) for a, b in zip(*rows, strict=True))


def _is(rows: Any, sign: int) -> bool:
    return all(_near(rows[i][j], sign * rows[j][i]) for i in range(len(rows)) for j in range(len(rows)))


def _near(a: Any, b: Any) -> bool:
    """Equal rational numbers, or balls that overlap."""
    if isinstance(a, fmpq) and isinstance(b, fmpq):
        return bool(a == b)
    return bool(arb(a).overlaps(arb(b)))


# --- what is wrong with matrices that only algebra can tell ---


@dataclass(frozen=True)
class Fault:
    """An error at a place of the description."""

    code: str
    message: str
    hint: str
    span: Span | None


def faults(scene: Scene[Polynomial], signs: Signs) -> Iterator[Fault]:
    """Matrices without the symmetry that their keys promise, and an M that is not positive definite."""
    linear = scene.system.linear
    assert linear is not None
    sound = True
    for matrix in linear.matrices:
        for fault in _asymmetries(scene, matrix) if MATRICES[matrix.key] else ():
            sound = sound and matrix.key != "M"
            yield fault
    mass = linear.matrix("M")
    if mass is not None and sound:
        yield from _not_positive(scene, linear, mass, signs)


def _asymmetries(scene: Scene[Polynomial], matrix: GivenMatrix) -> Iterator[Fault]:
    """The first pair of entries that breaks the symmetry, relations used."""
    ring, symmetry, images = scene.ring, MATRICES[matrix.key], relations(scene)
    entries = [[ring.substitute(scene.lower(x), images) for x in row] for row in matrix.rows]
    sign, size = (1 if symmetry == SYMMETRIC else -1), len(entries)
    for i, j in [(i, i) for i in range(size) if sign < 0] + list(combinations(range(size), 2)):
        if ring.is_zero(entries[i][j] - sign * entries[j][i]) is not False:
            continue
        whole = {"D": "C", "G": "C", "K": "S", "N": "S"}.get(matrix.key)
        mirrored = f"entry {j + 1}, {i + 1}" + ("" if sign > 0 else " with the other sign")
        message = f"{matrix.key} is not {symmetry}: entry {i + 1}, {j + 1} is not {'0' if i == j else mirrored}"
        hint = f"a matrix without symmetry is given as {whole}, and split by mbsym" if whole else ""
        span = matrix.spans[j][i] if matrix.spans else matrix.span
        yield Fault("matrix-symmetry", message, hint, span)
        return


def _not_positive(scene: Scene[Polynomial], linear: LinearModel, mass: GivenMatrix, signs: Signs) -> Iterator[Fault]:
    """At the given values, and in symbols where declared signs show it."""
    values, size = known_values(scene.system), len(linear.coordinates)
    hint = "it is the matrix of a kinetic energy x'.M x'/2"
    known = [[number_of(x, values) for x in row] for row in mass.rows]
    for order in range(1, size + 1):
        block = [known[i][j] for i in range(order) for j in range(order)]
        if any(x is None for x in block):
            break
        minor = fmpq_mat(order, order, [rationals.exact(x) for x in block if x is not None]).det()
        if minor <= 0:
            at = " at the given values" if scene.system.parameters else ""
            message = f"M is not positive definite{at}: its leading minor of order {order} is {minor}"
            yield Fault("mass-matrix", message, hint, mass.span)
            return
    ring, images = scene.ring, relations(scene)
    rows = [[ring.substitute(scene.lower(x), images) for x in row] for row in mass.rows]
    for order in range(1, min(size, MOST_MINORS) + 1):
        minor = determinant(ring, [row[:order] for row in rows[:order]])
        if signs.sign(minor) in ("negative", "nonpositive", "zero"):
            message = f"M is not positive definite: its leading minor of order {order} is {signs.sign(minor)}"
            yield Fault("mass-matrix", message, hint, mass.span)
            return
