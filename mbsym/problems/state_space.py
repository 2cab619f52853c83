"""The first approximation in first-order form, for systems with inputs or outputs,

    x' = A x + B v,    y - y0 = C x + D v,    x = (q - q0, q' - q0'),    v = u - u0,

    A = [ 0, 1; -M^-1 (K + N), -M^-1 (D + G) ],    B = [ 0; M^-1 B ],    C = [ dy/dq, dy/dq' ],    D = dy/du

in physical time and declared parameters, on the right the matrices of problem 5; u0 are the values at which the inputs
are held, y0 those of the outputs on the unperturbed motion.  M^-1 is the adjugate over the determinant, exactly in the
ring, part by part of what M couples.

Under constraints it is the whole flow on what they allow (``mbsym.mechanics.expansion``): x = (q_i, nu_k)
with the independent coordinates and the independent velocities, which need not be of the same coordinates, none of
them left out,

    A = [ T, S; -A^-1 C, -A^-1 B ],    B = [ 0; A^-1 gains ],    C = dy/d(q, q') P,

P from the independent deviations to all of them.

Source: Astrom & Murray, Feedback Systems, section 5.3 and example 5.4 (balance systems).

Example:

    >>> import mbsym
    >>> pole = mbsym.load("systems/cart-pole.yaml").state_space
    >>> print(pole.B[2, 0])
    (m*l**2 + J)/(J*(M + m) + M*m*l**2)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.matrices import adjugate, components, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Matrix, Shown
from mbsym.mechanics.expansion import combined, on_base
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import steadied
from mbsym.model.system import velocity_name
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.reduction import Reduced

#: Coordinates that M couples with each other: the inverse of more is no formula to read.
MOST_COUPLED = 6

Rows = list[list[Polynomial]]


@dataclass(frozen=True, repr=False)
class StateSpace(Shown):
    """A (s x s), B (s x m), C (p x s), D (p x m); ``states`` are q and q' by name, deviations from the motion.

    Without constraints s = 2n; under them the states are the independent coordinates, then the independent velocities;
    of equations that are given in the form x' = A x + B u they are x.
    """

    counted = ("A", "B", "C", "D")

    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    A: Matrix
    B: Matrix
    C: Matrix
    D: Matrix


def of_matrices(scene: Scene, linear: Linearisation) -> StateSpace:
    """A and B of a system that is given by its matrices; raises as ``state_space``."""
    ring, system = scene.ring, scene.system
    n, m, model = len(linear.coordinates), len(linear.inputs), scene.system.linear
    stiffness = _sum(ring, linear.K.polynomials, linear.N.polynomials, -1)
    damping = _sum(ring, linear.D.polynomials, linear.G.polynomials, -1)
    gains = [[] for _ in range(n)] if linear.B is None else [list(row) for row in linear.B.polynomials]
    nothing = Matrix.of(ring, [])
    if model is not None and model.of_first_order:  # M = 0, D + G = 1
        return StateSpace(
            system.coordinates, linear.inputs, (), Matrix.of(ring, stiffness), Matrix.of(ring, gains), nothing, nothing
        )
    right = [[*stiffness[i], *damping[i], *gains[i]] for i in range(n)]
    lower = _solved(ring, [list(row) for row in linear.M.polynomials], right)
    upper = [[ring.one if j == n + i else ring.zero for j in range(2 * n)] for i in range(n)]
    return StateSpace(
        states=(*system.coordinates, *system.velocities),
        inputs=linear.inputs,
        outputs=(),
        A=Matrix.of(ring, [*upper, *(row[: 2 * n] for row in lower)]),
        B=Matrix.of(ring, [*([ring.zero] * m for _ in range(n)), *(row[2 * n :] for row in lower)]),
        C=nothing,
        D=nothing,
    )


def state_space(scene: Scene, reduced: Reduced, equilibrium: Equilibrium) -> StateSpace:
    """A, B, C, D; functions of the time where the motion is not steady.

    Raises NoClosedForm where M couples too many coordinates; SingularPoint where M is singular for all parameters.
    """
    ring, expansion, equations = scene.ring, reduced.expansion, reduced.equations
    system, n = expansion.scene.system, len(scene.system.coordinates)
    names, inputs = scene.system.coordinates, system.input_names
    images = equilibrium.determined(scene)

    def on(rows: Sequence[Sequence[Polynomial]]) -> Rows:
        return [[steadied(scene, ring.substitute(x, dict(images))) for x in row] for row in rows]

    places, size = len(expansion.coordinates), len(expansion.speeds)
    right = [
        [*(-x for x in position), *(-x for x in speed), *gains]
        for position, speed, gains in zip(equations.C, equations.B, equations.gains, strict=True)
    ]
    upper = on([[*there, *moved] for there, moved in zip(equations.T, equations.S, strict=True)])
    lower = _solved(ring, on(equations.A), on(right))
    states = [*expansion.coordinates, *(n + k for k in expansion.speeds)]
    pushes = [3 * n + k for k in range(len(inputs))]
    deviations = (*expansion.positions, *expansion.velocities)
    measured = []
    for output in system.outputs:
        slopes = expansion.scene.lower(output.value).first
        own = combined(scene, ((slopes[i], form) for i, form in enumerate(deviations) if i in slopes))
        measured.append(
            [
                on_base(scene, expansion.base, x)
                for x in (*(own.get(i, ring.zero) for i in states), *(slopes.get(i, ring.zero) for i in pushes))
            ]
        )
    measured, whole = on(measured), places + size
    return StateSpace(
        states=(*(names[i] for i in expansion.coordinates), *(velocity_name(names[k]) for k in expansion.speeds)),
        inputs=inputs,
        outputs=tuple(channel.name for channel in system.outputs),
        A=Matrix.of(ring, [*upper, *(row[:whole] for row in lower)]),
        B=Matrix.of(ring, [*([ring.zero] * len(inputs) for _ in range(places)), *(row[whole:] for row in lower)]),
        C=Matrix.of(ring, [row[:whole] for row in measured]),
        D=Matrix.of(ring, [row[whole:] for row in measured]),
    )


def _sum(ring: Ring, a: Sequence[Sequence[Polynomial]], b: Sequence[Sequence[Polynomial]], sign: int) -> Rows:
    return [[ring.reduce((x + y) * sign) for x, y in zip(p, q, strict=True)] for p, q in zip(a, b, strict=True)]


def _solved(ring: Ring, mass: Rows, right: Rows) -> Rows:
    """M^-1 R, row by row, for every block of M by its adjugate."""
    n = len(mass)
    rows: Rows = [[] for _ in range(n)]
    for block in components(n, lambda i, j: not mass[i][j].is_zero()):
        if len(block) > MOST_COUPLED:
            listed = Message(
                "the mass matrix couples [[count]] coordinates, and its inverse is written for [[most]] at most",
                count=len(block),
                most=MOST_COUPLED,
            )
            raise NoClosedForm(listed, limit=Limit.TERMS)
        own = [[mass[i][j] for j in block] for i in block]
        inverse = ring.reciprocal(determinant(ring, own))
        for i, row in zip(block, adjugate(own, partial(determinant, ring)), strict=True):
            entries = (ring.dot(row, [right[j][column] for j in block]) for column in range(len(right[i])))
            rows[i] = [_in_lowest_terms(ring, ring.times(x, inverse)) for x in entries]
    return rows


def _in_lowest_terms(ring: Ring, x: Polynomial) -> Polynomial:
    """A numerator over one denominator, not term by term as the normal form has it: so it is shorter to read."""
    numerator, denominators = ring.fraction(x)
    for factor, exponent in denominators:
        numerator = ring.times(numerator, ring.reciprocal(factor) ** exponent)
    return numerator
