"""What the energy and the momenta of cyclic coordinates do where there are constraints.

Ideal constraints do no work in displacements that they allow at an instant; so the balance of the energy is that of the
open tree if every velocity row is homogeneous, J q' = 0: then the actual velocity is such a displacement.  With a part
j(q, t) besides (a wall that moves, a table that turns) constraint forces take power from outside, and nothing is
claimed but of equations that are exactly linear where j does not depend on q: deviations from the motion obey J q' = 0
then.  The momentum of a cyclic coordinate is constant where no row knows the coordinate or its velocity: constraint
forces do not act on it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from flint import fmpq, fmpq_mat

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.rates import velocity_name
from mbsym.mechanics.constraints.rows import Row, RowName, said_rows
from mbsym.mechanics.expansion import echelon
from mbsym.mechanics.motion import turning
from mbsym.problems.constraints.motion import Turned
from mbsym.problems.displacements import Direction, Displacements, among
from mbsym.problems.dissipation import Balance, EnergyLaw
from mbsym.problems.linearisation import Reduction

#: A row is looked for among others in a table of no more entries than this.
MOST_ENTRIES = 4_000_000


@dataclass(frozen=True)
class ConstrainedBalance(Balance):
    """The balance of the open tree, as far as it holds under constraints; ``about`` says what they leave free.

    ``following`` are rows on velocities that are proved to follow from others: they say nothing further.  Of
    ``constraints.motion``: ``oscillating`` is the position that the velocities follow, "" without one; ``steady``: the
    dimension of the steady motions near by, None where these are not shown to be a manifold.
    """

    about: Reduction | None = None
    following: frozenset[RowName] = frozenset()
    oscillating: str = ""
    steady: int | None = None

    def _law(self) -> EnergyLaw:
        free = Balance(self.scene, self.energy, self.signs, self.fixed, self.somewhere)
        moving = set(self.scene.system.coordinates) - self._resting
        if self._rows is None:
            return EnergyLaw.UNKNOWN
        if (not self._homogeneous or self._touched & moving) and not self._deviates_homogeneously:
            return EnergyLaw.UNKNOWN
        return free._law()

    @cached_property
    def ignorable(self) -> tuple[str, ...]:
        """The cyclic coordinates that no constraint touches."""
        return tuple(name for name in self.absent if name not in self._touched)

    def displacements(self, coordinates: Sequence[str]) -> Displacements:
        """Displacements that the constraints allow, by independent coordinates; dependent ones go with these.

        Where the constraints are integrable they lead from a leaf into itself: constraint forces do no work along them.
        """
        if self._rows is None:
            return Displacements(tuple(coordinates))
        names, taken = self.scene.system.coordinates, self._with_dependent(coordinates)
        places = [names.index(name) for name in taken]
        extended = self._displacements(taken, [(row.velocity, [row.partials[i] for i in places]) for row in self._rows])
        return _along(extended, coordinates)

    def symmetries(self, coordinates: Sequence[str]) -> Displacements:
        """Those that vary with the position, too, of holonomic systems near a rest: along leaves of the constraints."""
        displacements = among(self.ring, self._fields, self.scene.system.coordinates, self._with_dependent(coordinates))
        return _along(displacements, coordinates)

    def _with_dependent(self, coordinates: Sequence[str]) -> tuple[str, ...]:
        independent = () if self.about is None else self.about.about
        others = (name for name in self.scene.system.coordinates if name not in {*coordinates, *independent})
        return (*coordinates, *others)

    @property
    def _allowing(self) -> tuple[Direction, ...] | None:
        if self._rows is None or self.about is None or not self.about.holonomic:
            return None
        if self._resting != {*self.scene.system.coordinates} or not self._homogeneous:
            return None
        return tuple(row.partials for row in self._rows)

    @cached_property
    def absent(self) -> tuple[str, ...]:
        """The coordinates that occur neither in L nor in any other force of the open tree."""
        return Balance(self.scene, self.energy, self.signs, self.fixed, self.somewhere).ignorable

    @cached_property
    def closed(self) -> bool:
        """Whether the steady motion may be shifted along every coordinate that drops out, and is a steady motion again.

        Each of them is absent from the open tree's equations and from the rows, or shifting it is a symmetry together
        with a constant linear map of the others (a plane turned about its normal: yaw, and x and y with it).  So the
        zero root of each belongs to a family of steady motions.
        """
        if self.about is None or self._rows is None or self.energy is None:
            return False
        try:
            return all(map(self.shifts, self.about.idle))
        except Failure:
            return False

    def steady_by(self, integrals: Sequence[Polynomial], at: Mapping[int, Polynomial]) -> int | None:
        """The rank, at the motion, of the differentials of first integrals along states that the constraints allow.

        Where f is the motion's vector field (of what does not drop out), dI f = 0: so of the equations f = 0 as many
        follow from the others as dI has rank.  If that is the dimension of the null space of df, steady motions near
        the given one are a manifold of this dimension (implicit functions).  None where a symmetry by which coordinates
        drop out changes an integral, f knows the time, or the rank hangs on what may vanish.
        """
        ring, about, names = self.ring, self.about, self.scene.system.coordinates
        if about is None or self._rows is None or self.energy is None or self._forces is None:
            return None
        running = [g.name for g in ring.generators if g.kind in ("prescribed", "time")]
        acting = [self.energy.kinetic_energy.polynomial, self.energy.force_function.polynomial, *self._forces.values()]
        entries = [*acting, *(x for row in self._rows for x in _entries(row))]
        integrals = [x for x in integrals if not ring.dependencies(x, running)]
        if any(ring.dependencies(x, running) for x in entries):  # f knows the time
            return None
        if not all(self._absent_everywhere(name, integrals) or self._symmetric(name, integrals) for name in about.idle):
            return None
        variables = (*names, *map(velocity_name, names))
        positions = (row.position for row in self._rows if row.position is not None)
        rows: list[Mapping[Any, Polynomial]] = [
            {k: ring.substitute(ring.derivative(x, name), at) for k, name in enumerate(variables)}
            for x in (*positions, *self._velocity_rows, *integrals)
        ]
        rank = echelon(ring, self.signs, rows, range(len(variables)))
        allowed = len(about.coordinates) + len(about.speeds)
        return None if rank.assumed else len(rank.pivots) - (len(variables) - allowed)

    def shifts(self, name: str) -> bool:
        """Whether a shift of this coordinate, alone or with a linear map of others, is a symmetry (``closed``)."""
        return self._absent_everywhere(name) or self._symmetric(name)

    def _absent_everywhere(self, name: str, further: Sequence[Polynomial] = ()) -> bool:
        entries = [*(x for row in self._rows or () for x in _entries(row)), *further]
        return name in self.absent and not any(self.ring.depends_on(x, name) for x in entries)

    def _symmetric(self, name: str, further: Sequence[Polynomial] = ()) -> bool:
        """Whether rational numbers W_ij and S_rk exist with which, i and j being absent coordinates,

            dT/d(name) + sum W_ij q'_j dT/dq'_i = 0,    dg_r/d(name) + sum W_ij q'_j dg_r/dq'_i = sum S_rk g_k,
            dQ_k/d(name) + sum W_ij q'_j dQ_k/dq'_i + sum W_ik Q_i = 0            for the forces without a potential,

        where neither the force function nor f knows the name or these i.  The shift is then a symmetry.  If it leaves
        the independent speeds as they are (the i are dependent), no equation of theirs depends on the name; else it
        does, and the name has to rest if what is shifted is to be steady.  It leaves the ``further`` functions as they
        are, too, as it does T.
        """
        return self._map(name, further) is not None

    def _map(self, name: str, further: Sequence[Polynomial] = ()) -> Mapping[tuple[str, str], Any] | None:
        """The W of ``_symmetric``, entries that are not 0."""
        found = self._maps(name, True, further)
        return self._maps(name, False, further) if found is None and name in self._resting else found

    @property
    def turned(self) -> Turned | None:
        """The one coordinate that drops out and is not absent (a heading), and the W of its shift; None if not one."""
        about = self.about
        names = [] if about is None or not self.closed else [x for x in about.idle if not self._absent_everywhere(x)]
        found = self._map(names[0]) if len(names) == 1 else None
        return None if found is None else (names[0], found)

    @cached_property
    def _resting(self) -> set[str]:
        """The coordinates that do not move on the unperturbed motion."""
        moving = {name for name, _ in self.about.rates} if self.about is not None else set()
        return {name for name in self.scene.system.coordinates if name not in moving} - set(turning(self.scene))

    def _maps(self, name: str, dependent: bool, further: Sequence[Polynomial]) -> Mapping[tuple[str, str], Any] | None:
        """The symmetry of ``_symmetric`` with all i and j ``dependent``, or any."""
        ring, about, energies, rows = self.ring, self.about, self.energy, self._rows
        assert about is not None
        assert energies is not None
        assert rows is not None
        turned = [x for x in about.idle + about.dependent_speeds if x != name and self._absent_everywhere(x)]
        turned = [x for x in dict.fromkeys(turned) if x in about.dependent_speeds or not dependent]
        forces = self._forces
        potentials = [energies.force_function.polynomial, *(row.position for row in rows if row.position is not None)]
        if forces is None or any(ring.depends_on(x, name) for x in potentials):
            return None
        if any(not ring.velocity_derivative(x, y).is_zero() for x in potentials for y in turned):
            return None
        speeds = [ring.generator("velocity", x) for x in turned]
        functions = [energies.kinetic_energy.polynomial, *(row.velocity for row in rows), *further]
        equations = []
        for number, f in enumerate((*functions, *forces.values())):
            slopes = [ring.velocity_derivative(f, x) for x in turned]
            maps = [ring.times(speed, slope) for slope in slopes for speed in speeds]
            if number >= len(functions):
                felt = list(forces)[number - len(functions)]
                along = (forces[i] if j == felt else ring.zero for i in turned for j in turned)
                maps = [x + y for x, y in zip(maps, along, strict=True)]
            combined = [
                (g if number == r + 1 else ring.zero) for r in range(len(rows)) for g in (row.velocity for row in rows)
            ]
            equations.append((ring.derivative(f, name), [*maps, *combined]))
        solution = _solution(equations)
        pairs = [(i, j) for i in turned for j in turned]
        return None if solution is None else {pair: x for pair, x in zip(pairs, solution, strict=False) if x}

    @property
    def _velocity_rows(self) -> tuple[Polynomial, ...]:
        return tuple(row.velocity for row in self._rows or ())

    @property
    def uneven(self) -> bool:
        """Whether constraints make velocities hang on places: j of the rows J q' + j does."""
        ring, names = self.ring, self.scene.system.coordinates
        still = {ring.index("velocity", name): ring.zero for name in names}
        return any(ring.dependencies(ring.substitute(row, still), names) for row in self._velocity_rows)

    @cached_property
    def exactly_linear(self) -> bool:
        """Whether the open tree's equations and the rows are, and with them the equations of what is independent."""
        return self._rows is not None and super().exactly_linear

    @property
    def ring(self) -> Ring:
        return self.scene.ring

    @cached_property
    def _rows(self) -> tuple[Row, ...] | None:
        if not self.scene.motions:
            return None
        try:
            rows = said_rows(self.scene)
            kept_rows = [row for row in rows if row.position is not None or row.name not in self.following]
            return tuple(self._shortest(row, rows) for row in kept_rows)
        except Failure:
            return None

    def _shortest(self, row: Row, rows: Sequence[Row]) -> Row:
        """A row, or one on velocities that says the same and is shorter: (1 + y^2) g = 0 knows y, g = 0 does not."""

        def length(x: Row) -> int:
            return len(x.velocity)

        if row.position is not None:
            return row
        same = (x for x in rows if x.name in self.following and length(x) < length(row) and self._proportional(x, row))
        return min(same, key=length, default=row)

    def _proportional(self, row: Row, other: Row) -> bool:
        """Whether b x = a y for velocity rows x and y: a, b are the partials in the first place where x has one."""
        ring = self.ring
        at = next((k for k, x in enumerate(row.partials) if not x.is_zero()), None)
        if at is None or row.position is not None:
            return False
        left, right = ring.times(other.partials[at], row.velocity), ring.times(row.partials[at], other.velocity)
        return bool(ring.reduce(left - right).is_zero())

    @cached_property
    def _rates(self) -> tuple[Polynomial, ...]:
        """j(q, t) of every row."""
        return tuple(self.ring.at_rest(row.velocity) for row in self._rows or ())

    @property
    def _homogeneous(self) -> bool:
        return all(x.is_zero() for x in self._rates)

    @property
    def _deviates_homogeneously(self) -> bool:
        """Whether deviations obey J q' = 0, J constant, exactly."""
        coordinates = self.scene.system.coordinates
        return self.exactly_linear and not any(self.ring.dependencies(x, coordinates) for x in self._rates)

    @cached_property
    def _touched(self) -> set[str]:
        """The coordinates that a row depends on, or on whose velocity it does."""
        names = self.scene.system.coordinates
        rows = self._rows or ()
        touched = {name for row in rows for name, x in zip(names, row.partials, strict=True) if not x.is_zero()}
        return touched | {
            name for row in rows for x in _entries(row) for name in names if self.ring.depends_on(x, name)
        }


def _along(displacements: Displacements, coordinates: Sequence[str]) -> Displacements:
    """The same by the first coordinates alone: the others follow."""
    directions = tuple(direction[: len(coordinates)] for direction in displacements.directions)
    return replace(displacements, coordinates=tuple(coordinates), directions=directions)


def _entries(row: Row) -> list[Polynomial]:
    return [row.velocity, *row.partials, *([] if row.position is None else [row.position])]


def _solution(equations: Sequence[tuple[Polynomial, Sequence[Polynomial]]]) -> list[Any] | None:
    """Rational numbers c_k with  p + sum c_k p_k = 0  in every equation (p, (p_1, p_2, ...)); None without any."""
    lines: list[list[Any]] = []
    for value, unknowns in equations:
        columns = [x.to_dict() for x in (*unknowns, value)]
        monomials = sorted({monomial for column in columns for monomial in column})
        lines += [[column.get(monomial, 0) for column in columns] for monomial in monomials]
        if len(lines) * len(columns) > MOST_ENTRIES:
            return None
    width = len(equations[0][1])
    found = [fmpq(0)] * width
    if not lines:
        return found
    reduced, rank = fmpq_mat(len(lines), width + 1, [x for line in lines for x in line]).rref()
    for row in range(rank):
        pivot = next(k for k in range(width + 1) if reduced[row, k])
        if pivot == width:
            return None
        found[pivot] = -reduced[row, width]
    return found
