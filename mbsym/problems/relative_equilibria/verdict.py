"""Linear equations at states of rest, as formulas in the coordinates, and the verdict of problem 6 on one of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from typing import Any

from flint import ctx, fmpq, fmpq_mpoly_ctx

from mbsym.algebra.base import Algebra
from mbsym.algebra.failures import NOT_THERE, Failure, NotRational
from mbsym.algebra.krawczyk import pivot_rows
from mbsym.algebra.matrices import ScalarMatrix, echelon, null_vectors, skew, symmetric
from mbsym.algebra.point import Balls
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.rest import Rest, at_numbers, rest
from mbsym.mechanics.symmetry import constantly_curved, free_spin
from mbsym.problems import dissipation, knowledge
from mbsym.problems import energy as energies
from mbsym.problems.constrained_balance import ConstrainedBalance
from mbsym.problems.dissipation import EnergyLaw
from mbsym.problems.energy import Energy
from mbsym.problems.relative_equilibria.place import PRECISION, Place, candidate_at, described_place, exact_rates
from mbsym.problems.stability.bundle import Conserved, Element, NumberField, by_integrals, by_potential, conserved
from mbsym.problems.stability.enclosed import blocks, enclosed_verdict_with_cyclic
from mbsym.problems.stability.exact import verdict_at
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import Verdict, by_geodesics, coasting, combine, drifting, undecided
from mbsym.problems.stability.words import Because

#: Matrices by their entries, which are numbers.
Rows = list[list[list[Any]]]


@dataclass(frozen=True)
class LinearAtRest:
    """M, D, G, K, N as formulas in the coordinates, valid wherever f vanishes; of the open tree where it is tied.

    ``law``: what the energy does near all of these states; ``ignorable``: coordinates that no equation contains;
    ``cyclic``: places of those whose momenta are constant but for linear forces.
    """

    matrices: tuple[Sequence[Sequence[Polynomial]], ...]
    law: EnergyLaw
    cyclic: tuple[int, ...]
    varying: tuple[str, ...]
    tilts: tuple[int, ...]
    spin: Polynomial | None
    rest: Rest
    energy: Energy | None
    ignorable: tuple[str, ...]
    #: The equations of motion have no terms of higher order.
    exact: bool = False

    def verdict(self, place: Place) -> Verdict:
        """By the first approximation, and where that leaves it open by the integrals of the motion."""
        verdict = self._by_first_approximation(place)
        return self.decided(verdict, place)

    def decided(self, verdict: Verdict, place: Place) -> Verdict:
        """An open verdict decided by terms of higher order of the energy, or by further integrals; else as it is."""
        if not verdict.word.open or verdict.coordinates_singular or self.varying or place.modulus is None:
            return verdict
        if self.rest.rows:
            return verdict
        field = NumberField(place.modulus, place.enclose)
        try:
            with ctx.workprec(PRECISION):
                by_energy = self._by_higher_order(place, field)
                if by_energy is not None:
                    return by_energy
                known = self._conserved
                names = None if known is None else known.combination(place.residue, field)
        except NotRational:
            return verdict
        if names is not None:
            return by_integrals(names, bool(self.ignorable))
        held = known.holding() if known is not None and self._idle else None
        return verdict if held is None else drifting(held) if self.ignorable else held

    def _by_higher_order(self, place: Place, field: NumberField) -> Verdict | None:
        """Where no coordinate turns, V = T_2 part of the energy apart: K = V'' as a formula gives all derivatives."""
        ring, names = self.rest.ring, self.rest.system.coordinates
        if not self.conservative or self.rest.turning or any(x != 0 for row in self.matrices[4] for x in row):
            return None
        remaining = [i for i, name in enumerate(names) if name not in self.ignorable]
        if not remaining:
            return None
        stiffness = [[self.matrices[3][i][j] for j in remaining] for i in remaining]
        forces = (x for row in (*stiffness, *self.matrices[2]) for x in row)
        if self.law is EnergyLaw.CONSERVED and all(ring.is_zero(x) is True for x in forces):
            return coasting(Because.ALIKE) if self._alike else by_geodesics()
        of = [names[i] for i in remaining]

        def derivative(i: int, j: int, *further: int) -> Element | None:
            x = stiffness[i][j]
            for k in further:
                x = ring.derivative(x, of[k])
            return place.residue(x)

        applied = generalized_forces(self.rest.scene).values()
        by_velocities = (ring.velocity_derivative(x, name) for x in applied for name in names)
        gyroscopic = any(
            ring.is_zero(x) is not True for x in (*by_velocities, *(x for row in self.matrices[2] for x in row))
        )
        conserved, only = self.law is EnergyLaw.CONSERVED, len(remaining) == len(names)
        damping = [[place.ball(self.matrices[1][i][j]) for j in remaining] for i in remaining]
        if not all(x.is_finite() for row in damping for x in row):
            return None
        verdict = by_potential(len(remaining), derivative, field, conserved, only, gyroscopic, damping)
        return drifting(verdict) if verdict is not None and self.ignorable else verdict

    @property
    def _idle(self) -> bool:
        """Whether V is the same at every position, and nothing turns: the energy is that of T_2."""
        parts = (*self.matrices[3], *self.matrices[4])
        return not self.rest.turning and all(self.rest.ring.is_zero(x) is True for row in parts for x in row)

    @property
    def _alike(self) -> bool:
        """Whether all positions are alike for the kinetic energy."""
        ring, names = self.rest.ring, self.rest.system.coordinates
        try:
            return constantly_curved(ring, self.matrices[0], lambda x, i: ring.derivative(x, names[i]))
        except Failure:
            return False

    @property
    def conservative(self) -> bool:
        """Whether the energy does not grow near any of these states, in all orders."""
        return self.law.bounded

    @cached_property
    def bends(self) -> list[list[list[Polynomial]]]:
        """dJ/dq, a symmetric matrix for each constraint."""
        ring, names = self.rest.ring, self.rest.system.coordinates
        return [[[ring.derivative(x, name) for name in names] for x in row.partials] for row in self.rest.rows]

    @cached_property
    def _conserved(self) -> Conserved | None:
        """The integrals, where the energy is conserved and some momentum is."""
        if self.energy is None or not self.conservative:
            return None
        return conserved(self.rest.scene, self.energy, self.ignorable, self.rest.turning)

    def _by_first_approximation(self, place: Place) -> Verdict:
        if self.varying:
            return undecided(Because.VARIES, ", ".join(self.varying))
        if self.rest.rows:
            return self._constrained(place)
        values = [[[place.ball(x) for x in row] for row in rows_] for rows_ in self.matrices]
        exact = [[[place.residue(x) for x in row] for row in rows_] for rows_ in self.matrices]
        return self._of(values, exact, place, range(len(self.rest.system.coordinates)))

    def _constrained(self, place: Place) -> Verdict:
        """M, D, G, K, N on the displacements Y that constraints allow, K with the curvature of the constraints:

        Y^T X Y,    Y^T (K - sum lambda_k dJ_k/dq) Y,    J Y = 0,    f + J^T lambda = 0
        Where velocities are tied only Y^T M Y is looked at: coordinates are singular where it is.
        """
        numbers: Algebra[Any] = Balls({}) if place.modulus is None else NumberField(place.modulus, place.enclose)
        look = place.ball if place.modulus is None else place.residue
        n = len(self.rest.system.coordinates)
        with ctx.workprec(PRECISION):
            try:
                parts = [[[look(x) for x in row] for row in rows_] for rows_ in self.matrices]
                jacobian = [[look(x) for x in row.partials] for row in self.rest.rows]
                acting = [look(f) for f in self.rest.at_rest]
                bends = [[[look(x) for x in line] for line in bend] for bend in self.bends]
                if any(x is None for rows_ in (*parts, jacobian, [acting], *bends) for row in rows_ for x in row):
                    return undecided(Because.NOT_ENCLOSED)
                table = [[*column, -f] for column, f in zip(zip(*jacobian, strict=True), acting, strict=True)]
                columns = list(range(n))
                weigh: dict[str, Any] = {}
                if place.modulus is None:  # balls: what may be 0 divides nothing
                    weigh = {"weight": smallness}
                    first = pivot_rows([[float(x.mid()) for x in row[:-1]] for row in table])
                    columns = [*first, *(k for k in columns if k not in first)]
                    table = [table[k] for k in columns]
                reduced, pivots = echelon(numbers, [[row[k] for k in columns] for row in jacobian], n, **weigh)
                basis = null_vectors(numbers, dict(zip(pivots, reduced, strict=False)), n)
                pivots, basis = [columns[k] for k in pivots], [[v[columns.index(k)] for k in range(n)] for v in basis]
                if not all(row.name.holonomic for row in self.rest.rows):
                    mass = [[numbers.dot(row, y) for row in parts[0]] for y in basis]
                    mass = [[numbers.reduce(numbers.dot(x, z)) for z in mass] for x in basis]
                    if len(echelon(numbers, mass, len(basis), **weigh)[1]) < len(basis):
                        return undecided(Because.MASS_SINGULAR)
                    return undecided(Because.NO_EQUATIONS, OF_VELOCITIES)
                solved, taken = echelon(numbers, table, len(jacobian), **weigh)
                multipliers = dict(zip(taken, (row[-1] for row in solved), strict=False))
                for k, multiplier in multipliers.items():
                    parts[3] = [
                        [x - numbers.times(multiplier, y) for x, y in zip(*lines, strict=True)]
                        for lines in zip(parts[3], bends[k], strict=True)
                    ]
                images = [[[numbers.dot(row, y) for row in rows_] for y in basis] for rows_ in parts]
                made = [[[numbers.reduce(numbers.dot(x, z)) for z in of] for x in basis] for of in images]
            except (ZeroDivisionError, *NOT_THERE):
                return undecided(Because.NOT_ENCLOSED)
            if place.modulus is None:
                if not all(x.is_finite() for rows_ in made for row in rows_ for x in row):
                    return undecided(Because.NOT_ENCLOSED)
                exact: Rows = [[[None for _ in row] for row in rows_] for rows_ in made]
                values = made
            else:
                exact, values = made, [[[place.enclose(x) for x in row] for row in rows_] for rows_ in made]
        return self._of(values, exact, place, [k for k in range(n) if k not in pivots])

    def _of(self, values: Rows, exact: Rows, place: Place, remaining: Sequence[int]) -> Verdict:
        """The verdict on matrices in the coordinates ``remaining``."""
        rational = all(x is not None and x.degree() <= 0 for rows_ in exact for row in rows_ for x in row)
        verdicts = []
        for indices in blocks(*values):
            cyclic = tuple(
                at
                for at, i in enumerate(indices)
                if remaining[i] in self.cyclic and all(values[m][i][j] == 0 for m in (3, 4) for j in indices)
            )
            if rational:
                parts = [[[exact[m][i][j][0] for j in indices] for i in indices] for m in range(5)]
                names = tuple(self.rest.system.coordinates[remaining[i]] for i in indices)
                rate = self._rate(place) if {*self.tilts} <= {*indices} else None
                verdicts.append(_rational_verdict(parts, self.conservative, cyclic, rate, names, self.exact))
            else:
                parts = [[[values[m][i][j] for j in indices] for i in indices] for m in range(5)]
                verdicts.append(enclosed_verdict_with_cyclic(parts, self.conservative, cyclic, PRECISION, self.exact))
        return combine(verdicts, self.conservative)

    def _rate(self, place: Place) -> fmpq | None:
        """The rate of a steady spin that may be turned in space, where it is a rational number."""
        residue = None if self.spin is None else place.residue(self.spin)
        return None if residue is None or residue.degree() > 0 else residue[0]


def smallness(x: Any) -> int | None:
    """How small a ball is, of what may be 0 more than of all others; None of an exact 0."""
    if x.is_zero():
        return None
    return 1 << 20 if x.contains(0) else -math.frexp(float(x.mid()))[1]


def linear_at_rest(found: Rest) -> LinearAtRest:
    """M = mass matrix, D + G = -df/dq', K + N = -df/dq, on the steady motions."""
    ring, names = found.ring, found.system.coordinates
    rates = dict(found.rates)
    mass = found.mass_matrix()
    slopes = [[ring.velocity_derivative(f, name) for name in names] for f in found.forcing]
    C = -ScalarMatrix(ring, slopes).map(lambda x: ring.substitute(x, dict(rates)))
    S = -ScalarMatrix(ring, [[ring.derivative(f, name) for name in names] for f in found.at_rest])
    moving = [*found.turning, *(item.name for item in found.system.prescribed), "t"]
    every = (x for rows_ in (mass, C, S, [row.partials for row in found.rows]) for row in rows_ for x in row)
    varying = tuple(dict.fromkeys(name for x in every for name in ring.dependencies(x, moving)))
    scene = found.scene
    try:
        known = energies.energy(scene)
    except Failure:
        known = None
    of = ConstrainedBalance if found.rows else dissipation.Balance
    balance = of(scene, known, knowledge.signs(scene), {}, somewhere=True)
    cyclic = tuple(names.index(name) for name in balance.ignorable if name not in balance.driven)
    # Momenta of cyclic coordinates have to be those of the equations, too, not of an L that knows the time.
    law = balance.law
    if not law.bounded and not found.rows and all(found.at_rest[i].is_zero() for i in cyclic) and has_energy(found):
        law = EnergyLaw.CONSERVED
    circulatory = skew(S).map(lambda x: ring.zero if ring.is_zero(x) is True else x)
    parts = (mass, symmetric(C).rows, skew(C).rows, symmetric(S).rows, circulatory.rows)
    spin = None if found.rows else free_spin(found.system)
    tilts = () if spin is None else tuple(names.index(name) for name in spin.tilts)
    rate = None if spin is None else rates[ring.index("velocity", spin.coordinate)]
    exact = balance.exactly_linear
    return LinearAtRest(parts, law, cyclic, varying, tilts, rate, found, known, balance.ignorable, exact)


def has_energy(found: Rest) -> bool:
    """Whether q'.M q'/2 + V(q) is proved to be an integral, with V from f(q, 0), whatever L looks like.

    So it is where a frame is accelerated evenly: L knows the time, the equations do not.  With f' = f(q, q') - f(q, 0)

        d/dt (q'.M q'/2 + V) = q'.f' + sum q'_k q'.(dM/dq_k) q' / 2
    """
    ring, names = found.ring, found.system.coordinates
    moving = [*(item.name for item in found.system.prescribed), "t"]
    mass = found.mass_matrix()
    if found.turning or any(ring.dependencies(x, moving) for x in (*found.forcing, *(x for row in mass for x in row))):
        return False
    try:
        for i, j in combinations(range(len(names)), 2):
            slope = ring.derivative(found.at_rest[i], names[j]) - ring.derivative(found.at_rest[j], names[i])
            if ring.is_zero(slope) is not True:
                return False
        speeds = [ring.generator("velocity", name) for name in names]
        power = ring.dot(speeds, [x - y for x, y in zip(found.forcing, found.at_rest, strict=True)])
        for k, name in enumerate(names):
            rate = ring.dot(speeds, [ring.dot(speeds, [ring.derivative(x, name) for x in row]) for row in mass])
            power = power + ring.times(speeds[k], rate) * ring.number(Fraction(1, 2))
        return ring.is_zero(ring.reduce(power)) is True
    except Failure:
        return False


OF_VELOCITIES = Message("constraints of velocities: 'mbsym run' judges a rest that the description gives")
#: Why no branches are followed there.
VARIED = Message("constraints of velocities: rests are listed at numbers, by 'mbsym equilibria' without --vary")
_CONSTANTS = fmpq_mpoly_ctx.get(["unused"])


def _rational_verdict(
    parts: Sequence[Sequence[Sequence[fmpq]]],
    conservative: bool,
    cyclic: tuple[int, ...],
    spin: fmpq | None,
    names: tuple[str, ...],
    exact: bool,
) -> Verdict:
    """By exact counting of roots; ``spin`` is the rate of a steady spin that may be turned in space.

    ``exact``: there are no terms of higher order.
    """
    turned = () if spin is None else (_CONSTANTS.constant(1), _CONSTANTS.constant(spin * spin))
    made = [tuple(tuple(_CONSTANTS.constant(x) for x in row) for row in rows_) for rows_ in parts]
    system = LinearSystem(
        *(made[0], made[1], made[2], made[3], made[4], conservative, cyclic, turned),
        names=names,
        exact=exact,
        free=True,
    )
    return verdict_at(system, {}).verdict


# Problem 6 where the first approximation leaves the verdict at the description's values open.
#
# The system is taken at its numbers, the unperturbed motion as one of its relative equilibria, and judged as
# ``mbsym equilibria`` judges these: by an energy that the equations have though L knows the time, by terms of higher
# order of the potential energy (``stability.degenerate``) and by combinations of first integrals
# (``stability.bundle``).


#: Larger systems are not derived again at their numbers.
MOST_COORDINATES = 8


def decided_at(verdict: Verdict, scene: Scene, values: Mapping[str, Any]) -> Verdict:
    """An open verdict at rational values of all parameters of an open tree, decided where that is possible."""
    system = scene.system
    if len(system.coordinates) > MOST_COORDINATES:
        return verdict
    try:
        there = rest(at_numbers(system, values))
        forms = described_place(system, there, values)
        if forms is None:
            return verdict
        candidate = candidate_at(there, forms)
        if not all(candidate.vanishes(x) for x in there.at_rest):
            return verdict
        place = candidate.place(there, exact_rates(there))
        again = linear_at_rest(there).verdict(place)
        return verdict if again.word.open else again
    except NOT_THERE:
        return verdict
