"""The equations of a constrained system, projected on the motions that the constraints allow, to first order.

With the residuals r = M q'' - f of the open tree over jets (their constant part r_0 is what the constraint forces
supply on the motion) and Y of ``expansion.py``,

    Y^T r = Y_0^T r_0 + (Y_0^T r_x + Y_x^T r_0) x + Y_0^T r_nu nu + Y_0^T r_alpha alpha

is linear in the independent deviations once the dependent ones are put in: with speeds eta,

    A eta' + B eta + C x = gains u,    A = Y_0^T M Y_0,    x' = S eta + T x,

u the deviations of inputs.

The term Y_x^T r_0 is the one that is forgotten where only f and J_0 are linearised.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mbsym.algebra.jet import Jet
from mbsym.algebra.ring import Polynomial
from mbsym.mechanics.constraints.expansion import Expansion, Form, combined, on_base
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.newton_euler import residuals

Rows = tuple[tuple[Polynomial, ...], ...]


@dataclass(frozen=True)
class Projected:
    """``constant`` is Y_0^T r_0, one entry a speed; A and B square in the speeds, C by the independent coordinates.

    ``gains`` has a column for each input.  ``S`` and ``T`` have a row for each independent coordinate.
    """

    constant: tuple[Polynomial, ...]
    A: Rows
    B: Rows
    C: Rows
    gains: Rows
    S: Rows
    T: Rows


def projected(scene: Scene, found: Expansion) -> Projected:
    """The projected equations; ``scene`` is the one over the ring.  Raises NoClosedForm."""
    ring, n = scene.ring, len(scene.system.coordinates)
    needed: Sequence[Jet] = [
        Jet(on_base(scene, found.base, x.value), {key: on_base(scene, found.base, y) for key, y in x.degree(1).items()})
        for x in residuals(found.scene).values()
    ]
    inputs = [3 * n + k for k in range(len(found.scene.system.input_names))]
    deviations = (*found.positions, *found.velocities, *found.accelerations, *({i: ring.one} for i in inputs))
    own = [combined(scene, ((x, deviations[i]) for i, x in one.first.items())) for one in needed]
    constant, forms = [], []
    for k in range(len(found.speeds)):
        column = [found.null_space[i][k] for i in range(n)]
        constant.append(ring.dot(column, [one.value for one in needed]))
        parts: list[tuple[Polynomial, Form]] = list(zip(column, own, strict=True))
        parts += [(needed[i].value, found.slopes[i][k]) for i in range(n)]
        forms.append(combined(scene, parts))
    rates = [found.velocities[i] for i in found.coordinates]
    places = list(found.coordinates)
    speeds = [n + k for k in found.speeds]
    return Projected(
        constant=tuple(constant),
        A=_cut(scene, forms, [2 * n + k for k in found.speeds]),
        B=_cut(scene, forms, speeds),
        C=_cut(scene, forms, places),
        gains=tuple(tuple(-x for x in row) for row in _cut(scene, forms, inputs)),
        S=_cut(scene, rates, speeds),
        T=_cut(scene, rates, places),
    )


def on_leaf(scene: Scene, found: Expansion, equations: Projected) -> tuple[Expansion, Projected]:
    """The same where velocity constraints are integrable: on the leaf F(q) = F(q_0) of the unperturbed motion.

    Frobenius: dF = mu J dq with a regular matrix mu, so that deviations on the leaf are those with  J_0 x = 0,
    x = Y_0 x_s  with the coordinates x_s of the independent speeds;  x_s' = eta, and  A x_s'' + B x_s' + C Y_0 x_s  are
    Lagrange's equations of the leaf to first order.
    """
    ring = scene.ring
    rows = [found.null_space[i] for i in found.coordinates]
    columns = list(zip(*rows, strict=True))
    position = tuple(tuple(ring.dot(line, column) for column in columns) for line in equations.C)
    size = range(len(found.speeds))
    unit = tuple(tuple(ring.one if i == k else ring.zero for k in size) for i in size)
    still = tuple((ring.zero,) * len(size) for _ in size)
    forms = tuple(
        {i: x for i, x in zip(found.speeds, line, strict=True) if not x.is_zero()} for line in found.null_space
    )
    return replace(found, coordinates=found.speeds, positions=forms), replace(equations, C=position, S=unit, T=still)


def felt(found: Expansion, equations: Projected) -> tuple[int, ...]:
    """The independent coordinates on which the equations of the speeds depend, directly or through others.

    And those whose rates depend on themselves, directly or through others (the angle of a light trailer behind its
    car): they have roots of their own.  All others (a place on the ground, the angle of a wheel) follow by quadratures
    and drop out.
    """
    rows = [{m for m, x in enumerate(row) if not x.is_zero()} for row in equations.T]
    pending = {j for row in equations.C for j, x in enumerate(row) if not x.is_zero()}
    pending |= {j for j in range(len(rows)) if j in _reached(rows, rows[j])}
    return tuple(sorted(_reached(rows, pending)))


def _reached(rows: Sequence[set[int]], start: set[int]) -> set[int]:
    """Everything that some coordinates depend on, and these."""
    known, pending = set(start), list(start)
    while pending:
        new = rows[pending.pop()] - known
        known |= new
        pending += new
    return known


def _cut(scene: Scene, forms: Sequence[Form], columns: Sequence[int]) -> Rows:
    return tuple(tuple(form.get(j, scene.ring.zero) for j in columns) for form in forms)
