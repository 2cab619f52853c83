"""Problem 7 with constraints: what the constrained motion keeps.

With E = M q'' - f = J^T lambda a quantity I with  dI/dt = mu . E  (an identity of the open tree) changes at the rate

    dI/dt = (J mu) . lambda

so that it is kept if J mu vanishes on the constraints, for every independent row:

* the generalised energy T_2 - T_0 - U, mu = q':  J q' = -j, so it is kept where the constraints are homogeneous in the
  velocities, j = 0 (and L does not contain the time, and other loads do no work);
* the momentum along a displacement xi of constant components, mu = xi, if L and the other forces do not feel it and the
  constraints allow it, J xi = 0: a cyclic coordinate alone gives nothing that is kept where J xi is not zero;
* components of the linear and angular momentum in inertial axes: tried at exact states on the constraints, and proved,
  where the equations without multipliers are short enough, by  det(Y^T M Y) dI/dt = 0  in the ring.

What else a nonholonomic system keeps (the Noether theorem gives momentum equations, not integrals) is not looked for.

Source: Neimark & Fufaev, chapter III (energy); V. V. Kozlov & N. N. Kolesnikov, On theorems of dynamics, PMM 42 (1978).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from flint import ctx, fmpq_mat

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.constraints.embedding import basis_vector
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import is_certain
from mbsym.mechanics.constraints.states import PRECISION, Manifold, OnManifold
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.constraints.checks import accelerated
from mbsym.problems.constraints.motion import Embedded, dependent_velocities
from mbsym.problems.constraints.result import Constraints, Solved
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.integrals import ENERGY, Integral, residual, total_rate, varies, whole_momenta

# Whether something vanishes along every motion of a constrained system.
#
# With  q'' = Y u' + a0  and  Y^T M Y u' = Y^T (f - M a0)  an expression x(q, q', q'', t) is a function of positions on
# the constraints and of independent velocities.  It is tried at exact states on the constraints; that it vanishes is
# proved in the ring, where the equations without multipliers are short enough and x is linear in q'', by
#
#     det(Y^T M Y) x = 0        u' by Cramer's rule, dependent velocities expressed by the independent ones
#
# which does not use the constraints between positions: what vanishes on these alone is verified numerically.


#: At so many states an expression must vanish.
STATES = 4
#: Equations longer than this are not tried for a proof.
MOST_TERMS, MOST_SPEEDS = 600, 4


class AlongMotion:
    """Expressions along the motions of a system over the ring."""

    def __init__(self, scene: Scene, tied: Constraints, solved: Solved, embedded: Embedded) -> None:
        self.scene, self.ring = scene, scene.ring
        self.tied, self.solved, self.embedded = tied, solved, embedded
        self.velocities = dependent_velocities(self.ring, tied, solved)

    def restricted(self, x: Polynomial) -> Polynomial:
        """x on the velocities that the constraints allow."""
        return self.ring.reduce(self.ring.substitute(x, self.velocities))

    def values(self, x: Polynomial, states: Sequence[OnManifold]) -> list[tuple[OnManifold, Any]]:
        """x at those of the states where the equations have a solution, with their accelerations."""
        found = []
        for one in states:
            carry = Carrier(self.ring, one.state.numbers, one.state.values)
            try:
                moved = accelerated(one.state, carry, self.tied, self.embedded)
            except ZeroDivisionError:
                continue
            found.append((one, Carrier(self.ring, moved.numbers, moved.values)(x)))
        return found

    def vanishes_at(self, x: Polynomial, states: Sequence[OnManifold]) -> bool:
        """Whether x is zero, or cannot be told from it, at STATES states; False where there are fewer."""
        found = self.values(x, states)
        return len(found) == STATES and not any(is_certain(value) for _, value in found)

    def along_speeds(self, slopes: Sequence[Polynomial]) -> list[Polynomial]:
        """Y^T slopes: derivatives by q'' (by q') as those by u' (by u)."""
        basis = [basis_vector(self.ring, self.solved.embedding, place) for place in range(len(self.tied.free))]
        return [self.restricted(self.ring.dot(slopes, y)) for y in basis]

    def proves_zero(self, x: Polynomial, slopes: Sequence[Polynomial]) -> bool:
        """Whether x = 0 is an identity; ``slopes`` are dx/dq'', in which x must be linear."""
        ring, k = self.ring, len(self.tied.free)
        if self.embedded.terms > MOST_TERMS or k > MOST_SPEEDS:
            return False
        try:
            mass = [list(row) for row in self.embedded.mass_matrix.polynomials]
            right = [y.polynomial for y in self.embedded.forcing]
            along = self.along_speeds(slopes)
            still = {ring.index("acceleration", name): ring.zero for name in self.tied.coordinates}
            rest = ring.substitute(x, still)
            a0 = [y.polynomial for y in self.solved.acceleration_shift]
            rest = self.restricted(rest + ring.dot(slopes, a0))
            left = ring.times(determinant(ring, mass), rest)
            for j in range(k):  # Cramer's rule: a column replaced by the right-hand sides
                if not ring.vanishes(along[j]):
                    replaced = [[right[i] if c == j else mass[i][c] for c in range(k)] for i in range(k)]
                    left = left + ring.times(along[j], determinant(ring, replaced))
            return ring.is_zero(ring.reduce(left)) is True
        except Failure:
            return False


def integrals(
    scene: Scene, energy: Energy, equations: Equations, programs: ConstrainedPrograms
) -> tuple[Integral, ...]:
    """The energy, momenta along constant displacements, and momenta of the whole system that are kept."""
    assert equations.constraints is not None
    known = _Known(scene, energy, equations, equations.constraints)
    found = [*known.generalised_energy(), *known.momenta()]
    if equations.embedded is not None and equations.constraints.solved is not None:
        whole = _Whole(scene, equations.constraints, equations.constraints.solved, equations.embedded)
        found += whole.momenta(Manifold(scene.system, scene.ring, programs), found)
    return tuple(found)


class _Known:
    """What follows from identities of the open tree and J mu = 0."""

    def __init__(self, scene: Scene, energy: Energy, equations: Equations, tied: Constraints) -> None:
        self.scene, self.ring, self.tied, self.equations = scene, scene.ring, tied, equations
        self.names = scene.system.coordinates
        kinetic, force = energy.kinetic_energy.polynomial, energy.force_function.polynomial
        self.momentum = [self.ring.velocity_derivative(kinetic, name) for name in self.names]
        speeds = [self.ring.generator("velocity", name) for name in self.names]
        self.energy = self.ring.reduce(self.ring.dot(self.momentum, speeds) - kinetic - force)
        self.speeds = speeds
        self.residuals = [residual(scene, equations, i) for i in range(len(self.names))]

    def _is(self, quantity: Polynomial, mu: Sequence[Polynomial]) -> bool:
        """Whether dI/dt = mu . E is an identity."""
        left = total_rate(self.scene, quantity)
        for factor, one in zip(mu, self.residuals, strict=True):
            if not self.ring.vanishes(factor):
                left = left - self.ring.times(factor, one)
        return self.ring.is_zero(left) is True

    def generalised_energy(self) -> Iterator[Integral]:
        """Kept where every independent row is homogeneous: J q' + j = 0 with j = 0."""
        ring = self.ring
        still = {ring.index("velocity", name): ring.zero for name in self.names}
        drifts = [ring.substitute(self.tied.velocity[i].polynomial, still) for i in self.tied.independent]
        if (
            all(ring.is_zero(x) is True for x in drifts)
            and self._is(self.energy, self.speeds)
            and varies(self.scene, self.energy)
        ):
            yield Integral(ENERGY, ENERGY, "time", Formula(ring, self.energy), Certainty.PROVED)

    def momenta(self) -> Iterator[Integral]:
        """Of coordinates alone, and along the columns of Y whose entries are constants."""
        done: list[str] = []
        for i, name in enumerate(self.names):
            xi = [self.ring.one if k == i else self.ring.zero for k in range(len(self.names))]
            if self._allowed(xi) and self._is(self.momentum[i], xi) and varies(self.scene, self.momentum[i]):
                done.append(name)
                yield Integral(
                    Message("momentum of [[name]]", name=name),
                    "cyclic momentum",
                    name,
                    Formula(self.ring, self.momentum[i]),
                    Certainty.PROVED,
                )
        solved = self.tied.solved
        for place, name in enumerate(self.tied.free if solved is not None else ()):
            assert solved is not None
            xi = basis_vector(self.ring, solved.embedding, place)
            if name in done or any(self._moves(x) for x in xi):
                continue
            along = self.ring.dot(self.momentum, xi)
            if self._allowed(xi) and self._is(along, xi) and varies(self.scene, along):
                title = Message("momentum along the displacement of [[name]] that the constraints allow", name=name)
                yield Integral(title, "cyclic momentum", name, Formula(self.ring, along), Certainty.PROVED)

    def _moves(self, x: Polynomial) -> bool:
        changing = [*self.names, "t", *(item.name for item in self.scene.system.prescribed)]
        return bool(self.ring.dependencies(x, changing))

    def _allowed(self, xi: Sequence[Polynomial]) -> bool:
        """J xi = 0 for every independent row."""
        rows = ([self.tied.jacobian[i, k].polynomial for k in range(len(xi))] for i in self.tied.independent)
        return all(self.ring.is_zero(self.ring.dot(row, xi)) is True for row in rows)


class _Whole(AlongMotion):
    """Momenta of the whole system, through the equations without multipliers."""

    def momenta(self, manifold: Manifold, known: Sequence[Integral]) -> list[Integral]:
        """The components that are kept and say something new."""
        found: list[Integral] = []
        try:
            with ctx.workprec(PRECISION):
                states = list(manifold.states(STATES))
                for kind, axis, formula in whole_momenta(self.scene):
                    others = [self.restricted(x.formula.polynomial) for x in (*known, *found) if x.kind != ENERGY]
                    if not _is_new(self.ring, self.restricted(formula), others) or not self._kept(formula, states):
                        continue
                    name = (
                        Message("angular momentum about axis [[axis]]", axis=axis)
                        if kind == "angular momentum"
                        else Message("linear momentum along axis [[axis]]", axis=axis)
                    )
                    proved = self._is_proved(formula)
                    if not proved and self.ring.kinked:
                        continue  # a force that comes late vanishes at every state before
                    status = Certainty.PROVED if proved else Certainty.VERIFIED
                    found.append(Integral(name, kind, str(axis), Formula(self.ring, formula), status))
        except Failure:
            pass  # what was found so far is right; the rest is not known
        return found

    def _kept(self, formula: Polynomial, states: Sequence[OnManifold]) -> bool:
        """Whether dI/dt, with the accelerations of the equations, is zero at all these states."""
        return self.vanishes_at(total_rate(self.scene, formula), states)

    def _is_proved(self, formula: Polynomial) -> bool:
        """dI/dt = 0 as an identity."""
        slopes = [self.ring.velocity_derivative(formula, name) for name in self.tied.coordinates]
        return self.proves_zero(total_rate(self.scene, formula), slopes)


def _is_new(ring: Ring, formula: Polynomial, others: Sequence[Polynomial]) -> bool:
    """Whether it holds a velocity and is no rational combination of the others."""
    if formula.is_zero() or not any(g.kind == "velocity" and d > 0 for g, d in _degrees(ring, formula)):
        return False
    columns = [other.to_dict() for other in others]
    return _rank([*columns, formula.to_dict()]) > _rank(columns)


def _rank(columns: Sequence[Any]) -> int:
    """Of polynomials as columns of coefficients."""
    monomials = sorted({monomial for column in columns for monomial in column})
    entries = [column.get(monomial, 0) for monomial in monomials for column in columns]
    return int(fmpq_mat(len(monomials), len(columns), entries).rank()) if monomials and columns else 0


def _degrees(ring: Ring, x: Polynomial) -> Iterator[tuple[Any, int]]:
    return zip(ring.generators, map(int, x.degrees()), strict=True)
