"""Problem 7 in speeds and with constraints: what the motion keeps.

With E = M u' - f = J^T lambda a quantity I with  dI/dt = mu . E  (an identity of the open tree) changes at the rate

    dI/dt = (J mu) . lambda

so that it is kept if J mu vanishes on the constraints, for every independent row, however long the equations are:

* the generalised energy T_2 - T_0 - U, mu = u - s0 (in coordinates q'):  J mu = -j there, so it is kept where the
  constraints are homogeneous in the velocities, j = 0 (and L does not contain the time, other loads do no work);
* the momentum along a displacement xi of constant components, mu = xi, if L and the other forces do not feel it and the
  constraints allow it, J xi = 0: a cyclic coordinate alone gives nothing that is kept where J xi is not zero.  All such
  xi are found, from linear equations;
* squares and products of unit vectors and quaternions, mu = 0.

The same, components of the linear and angular momentum in inertial axes, also about contacts, and momenta dT/du of
declared speeds are tried at exact states on the constraints, and proved, where the equations without multipliers are
short enough, by
det(Y^T M Y) dI/dt = 0  in the ring.

What else a nonholonomic system keeps (the Noether theorem gives momentum equations, not integrals) is not looked for.

Source: Neimark & Fufaev, chapter III (energy); V. V. Kozlov & N. N. Kolesnikov, On theorems of dynamics, PMM 42 (1978).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any

from flint import ctx

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Failure, NoClosedForm
from mbsym.algebra.kernel import kernel
from mbsym.algebra.matrices import cramer, determinant
from mbsym.algebra.ring import Polynomial
from mbsym.formulas.formula import Formula
from mbsym.mechanics.constraints.embedding import basis_vector
from mbsym.mechanics.constraints.programs import ConstrainedPrograms
from mbsym.mechanics.constraints.ranks import is_certain
from mbsym.mechanics.constraints.states import PRECISION, Manifold, OnManifold
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_states import in_time
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import are_met
from mbsym.model.system import velocity_name
from mbsym.problems.constraints.checks import moving
from mbsym.problems.constraints.motion import Embedded, dependent_velocities
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.in_speeds import GEOMETRIC, NORM, Candidate, candidates
from mbsym.problems.integrals import ENERGY, Integral, is_independent

# Whether something vanishes along every motion.
#
# With  u' = Y v' + a0  and  Y^T M Y v' = Y^T (f - M a0)  an expression x(s, u, u', t) is a function of positions on
# the constraints and of independent velocities; without constraints Y = 1 and a0 = 0.  That it vanishes is proved in
# the ring, where x is linear in u' and the equations without multipliers are short enough, by
#
#     det(Y^T M Y) x = 0        v' by Cramer's rule, dependent velocities expressed by the independent ones
#
# which does not use the constraints between positions: what vanishes on these alone is tried at exact states on them,
# and verified numerically.


#: At so many states an expression must vanish.
STATES = 4
#: Equations without multipliers that are longer than this are not tried for a proof.
MOST_TERMS, MOST_SPEEDS = 600, 4


class AlongMotion:
    """Expressions along the motions of a system over the ring, of s' = g(s, u, t) and ``equations``.

    ``programs``: M, f and the rows of constraints, which exact states are taken from.
    """

    def __init__(self, form: SpeedForm, equations: Equations, programs: ConstrainedPrograms | None = None) -> None:
        self.form, self.ring = form, form.ring
        self.tied, self.equations, self.programs = equations.constraints, equations, programs
        self.solved = self.tied.solved
        self.velocities = {} if self.solved is None else dependent_velocities(form, self.solved)
        #: The independent rows: J, and J u + j.
        jacobian, velocity = self.tied.jacobian.polynomials, self.tied.velocity
        self.rows = [(jacobian[i], velocity[i].polynomial) for i in self.tied.independent]

    def restricted(self, x: Polynomial) -> Polynomial:
        """x on the velocities that the constraints allow."""
        return self.ring.reduce(self.ring.substitute(x, self.velocities))

    def vanishes(self, x: Polynomial) -> bool:
        """Whether x = 0 is known on the velocities that the constraints allow."""
        return self.form.vanishes(self.restricted(x)) is True

    def in_motion(self, x: Polynomial) -> Polynomial:
        """x with the rates of unit vectors and quaternions expressed."""
        own = {u.index for u in self.form.speeds}
        others = [s for s in self.form.positions if s.rate_index not in own]
        return self.ring.substitute(x, {s.rate_index: self.form.rates[s.name] for s in others}) if others else x

    # --- in the ring ---

    @cached_property
    def _matrices(self) -> Embedded:
        """Of the independent velocities.  Raises NoClosedForm where there are none, or they are too long."""
        short = self.equations.embedded
        long = bool(self.rows) and short is not None and (short.terms > MOST_TERMS or len(short.free) > MOST_SPEEDS)
        if short is None or self.solved is None or long:
            raise NoClosedForm("the equations without multipliers have no closed form within the budget")
        return short

    @cached_property
    def determinant(self) -> Polynomial:
        """det(Y^T M Y)."""
        return determinant(self.ring, self._matrices.mass_matrix.polynomials)

    @cached_property
    def _scaled(self) -> list[Polynomial]:
        """det(Y^T M Y) v' by Cramer's rule."""
        matrices = self._matrices
        return cramer(self.ring, matrices.mass_matrix.polynomials, [x.polynomial for x in matrices.forcing])

    def along_speeds(self, slopes: Sequence[Polynomial]) -> list[Polynomial]:
        """Y^T slopes: derivatives by u' (by u) as those by the independent ones."""
        assert self.solved is not None
        basis = [basis_vector(self.ring, self.solved.embedding, place) for place in range(len(self.tied.free))]
        return [self.restricted(self.ring.dot(slopes, y)) for y in basis]

    def _on_motion(self, slopes: Sequence[Polynomial], rest: Polynomial) -> Polynomial:
        """det(Y^T M Y) (slopes . u' + rest)."""
        ring = self.ring
        if self.solved is not None:
            rest = self.restricted(rest + ring.dot(slopes, [y.polynomial for y in self.solved.acceleration_shift]))
        along = ring.dot(self.along_speeds(slopes), self._scaled)
        return ring.reduce(ring.times(self.determinant, rest) + along)

    def rate(self, x: Polynomial) -> Polynomial:
        """det(Y^T M Y) dx/dt on the motion, of what holds no u'.  Raises Failure."""
        return self._on_motion([self.ring.derivative(x, u.name) for u in self.form.speeds], self.form.drift(x))

    def keeps(self, x: Polynomial) -> bool | None:
        """Whether dx/dt = 0 on every motion; None where the ring cannot decide.  Raises Failure."""
        return self.form.vanishes(self.rate(x))

    def rate_in_lowest_terms(self, x: Polynomial) -> Formula:
        """dx/dt on the motion."""
        return Formula(self.ring, self.ring.ratio(self.rate(x), self.determinant))

    def proves_zero(self, x: Polynomial) -> bool:
        """Whether x = 0 is an identity; x must be linear in u'."""
        still = {u.rate_index: self.ring.zero for u in self.form.speeds}
        try:
            slopes = [x.derivative(u.rate_index) for u in self.form.speeds]
            return self.form.vanishes(self._on_motion(slopes, self.ring.substitute(x, still))) is True
        except Failure:
            return False

    # --- at states on the constraints ---

    @cached_property
    def _carried(self) -> list[tuple[OnManifold, Carrier, Carrier]]:
        """Exact states on the constraints, or enclosures of some, with their accelerations, and as series in time.

        States where the equations have no solution are not counted.
        """
        carried: list[tuple[OnManifold, Carrier, Carrier]] = []
        assert self.programs is not None
        with ctx.workprec(PRECISION):
            for on_manifold in Manifold(self.form.system.without_speeds, self.ring, self.programs).states(2 * STATES):
                with suppress(*NOT_THERE):
                    state = moving(self.form, on_manifold, self.tied, self.programs)
                    carried.append(
                        (
                            on_manifold,
                            Carrier(self.ring, state.numbers, state.values),
                            in_time(self.ring, Oracle(self.form.system, state)),
                        )
                    )
                if len(carried) == STATES:
                    break
        return carried

    def values(self, x: Polynomial, rate: bool = False) -> list[tuple[OnManifold, Any]]:
        """x at these states, or dx/dt of what holds no accelerations."""
        evaluated: list[tuple[OnManifold, Any]] = []
        with ctx.workprec(PRECISION):
            for on_manifold, carry, in_series in self._carried:
                with suppress(*NOT_THERE):
                    evaluated.append((on_manifold, in_series(x).b if rate else carry(x)))
        return evaluated

    def vanishes_at_states(self, x: Polynomial, rate: bool = False) -> bool:
        """Whether x is zero, or cannot be told from it, at STATES states; False where there are fewer."""
        evaluated = self.values(x, rate)
        return len(evaluated) == STATES and not any(is_certain(value) for _, value in evaluated)


def integrals(
    form: SpeedForm, scene: Scene, energy: Energy, equations: Equations, programs: ConstrainedPrograms
) -> tuple[Integral, ...]:
    """The energy, momenta, and products of unit vectors that are kept; of long equations those with multipliers."""
    motion = _Kept(form, equations, programs)
    conserved: list[Integral] = []
    known: list[Polynomial] = []
    for integral, multipliers in motion.candidates(scene, energy):
        x = integral.formula.polynomial
        with suppress(Failure):  # what is too long is not known to be conserved
            geometric = integral.kind in (GEOMETRIC, NORM)
            on = x if geometric else motion.as_known(x)
            if not geometric and not motion.says_something(integral, on, known):
                continue
            status = motion.status(integral, multipliers)
            if status is not None:
                conserved.append(replace(integral, status=status))
                known += [] if geometric or integral.kind == ENERGY else [on]
    return tuple(conserved)


class _Kept(AlongMotion):
    """Whether and how well it is known that the motion keeps something."""

    def candidates(self, scene: Scene, energy: Energy) -> Iterator[Candidate]:
        """Those of the tree, and momenta along displacements of constant components."""
        along: list[tuple[str, list[Polynomial]]] = []
        with suppress(Failure):
            along += self.displacements(energy.kinetic_energy.polynomial)
        yield from candidates(self.form, scene, energy, self.equations, along)

    def displacements(self, kinetic: Polynomial) -> Iterator[tuple[str, list[Polynomial]]]:
        """All constant xi with  J xi = 0  and  xi . (d/dt dT/du - E) = 0  on the velocities that constraints allow."""
        if not self.rows:  # problem 9 and symmetries look for these
            return
        form, ring = self.form, self.ring
        own = {velocity_name(name): name for name in form.coordinates}
        rates = [form.rate(ring.derivative(kinetic, u.name)) for u in form.speeds]
        rest = [self.restricted(rate - residual) for rate, residual in zip(rates, self._residuals, strict=True)]
        for xi in kernel(ring, rest, *(row for row, _ in self.rows)):
            name = form.speeds[max(xi)].name
            if len(xi) > 1:  # others are momenta of one coordinate or speed, which are tried anyway
                yield own.get(name, name), [xi.get(k, ring.zero) for k in range(len(form.speeds))]

    def as_known(self, x: Polynomial) -> Polynomial:
        """x on the velocities that the constraints allow, where that is not too long: to be compared with others."""
        with suppress(Failure):
            return self.form.in_angles(self.restricted(x))
        return x

    def says_something(self, integral: Integral, on: Polynomial, known: Sequence[Polynomial]) -> bool:
        """Whether it depends on the state, a momentum on velocities, and is no combination of the others."""
        speeds = [u.name for u in self.form.speeds]
        if integral.kind == ENERGY:
            return bool(self.ring.dependencies(on, [*speeds, *(x.name for x in self.form.positions)]))
        return bool(self.ring.dependencies(on, speeds)) and is_independent(self.ring, on, known)

    def status(self, integral: Integral, multipliers: Sequence[Polynomial]) -> Certainty | None:
        """Proved, or verified at states on the constraints; None where it is not kept, or that is not known.

        Energies and momenta of coordinates are told where constraint forces cannot change them, whatever these are.
        """
        x = integral.formula.polynomial
        known = bool(multipliers) or integral.kind in (GEOMETRIC, NORM)
        if known and self._by_multipliers(self.form.rate(x), multipliers):
            return Certainty.PROVED
        if integral.kind in (ENERGY, "cyclic momentum"):
            return None
        if not self.rows:
            return Certainty.PROVED if self.keeps(x) else None
        if self.equations.embedded is None:
            return None
        if not self.vanishes_at_states(x, rate=True) or self.vanishes_at_states(x):
            return None
        if self.proves_zero(self.form.rate(x)):
            return Certainty.PROVED
        # A force that comes late vanishes at every state before, a difference where it is told.
        told = self.ring.kinked or not are_met(self.form.system, self.ring)
        return None if told else Certainty.VERIFIED

    def _by_multipliers(self, left: Polynomial, multipliers: Sequence[Polynomial]) -> bool:
        """Whether a rate is mu . E on allowed velocities, and J mu vanishes or is J u + j in every row."""
        form, ring = self.form, self.ring
        for factor, residual in zip(multipliers, self._residuals, strict=False):
            if not ring.vanishes(factor):
                left = left - ring.times(factor, residual)
        if not self.vanishes(left):
            return False
        works = [(ring.dot(row, multipliers), velocity) for row, velocity in self.rows if multipliers]
        return all(
            form.vanishes(work) is True or form.vanishes(ring.reduce(work - velocity)) is True
            for work, velocity in works
        )

    @cached_property
    def _residuals(self) -> list[Polynomial]:
        """E."""
        return [x.polynomial for x in self.equations.equalities(self.form.system.coordinates)]
