"""Steady motions whose velocities constraints tie to one another: orbits of the symmetries of a system.

A field c(q) = a + C q is a symmetry where M and f of  M q'' = f + J^T lambda  and the constraint rows  g = J q' + j  do
not change along it but for a mixture of rows,

    L_c M = 0,    L_c f = 0,    L_c g_i = sum_k A_ik g_k,    A constant:

a shift of the place on the ground, the turn (-y, x, 1) of place and heading, the angle of a wheel.  A relative
equilibrium is a motion  q(t) = exp(t X) q0  with  X = sum_k w_k c_k.  Each field used here is e_k at places where the
coordinates k of all fields are 0, which every orbit meets; the other coordinates rest, and there

    q'_k = w_k,    q''_i = sum_kl w_k w_l C_k[i, l],    M q'' = f + J^T lambda,    J q' + j = 0,    phi(q) = 0.

As M, f and rows do not change along the orbit, these hold on all of it.  Rates that the description gives are taken;
those of other coordinates are 0, or follow where constraints determine them (how fast a bicycle turns): such a rate is
an unknown, written by the letter of its coordinate, which stands in no equation.

The first approximation about such a motion has constant coefficients in the frame that moves with it,
q = exp(t X) (q0 + x):

    R(x, w, w') = M (w' + Gamma(w, w)) - f - J^T lambda = 0,    J w + j = 0,    x' = w of the coordinates that rest.

Sources: J. E. Marsden, Lectures on Mechanics (1992), chapter 4; A. M. Bloch et al., Arch. Rational Mech. Anal. 136
(1996) 21-99; Neimark & Fufaev, chapter V.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from random import Random
from typing import Any

from flint import arb, arb_mat, ctx

from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.kernel import kernel
from mbsym.algebra.krawczyk import pivot_rows
from mbsym.algebra.matrices import echelon, null_vectors
from mbsym.algebra.point import Balls
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.constraints.ranks import eliminated
from mbsym.mechanics.constraints.rows import Row
from mbsym.mechanics.rest import Rest
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import SEED
from mbsym.model.system import velocity_name
from mbsym.problems import energy as energies
from mbsym.problems import equations
from mbsym.problems.constraints.motion import embedded_equations, oscillating_position
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.relative_equilibria.place import PRECISION, Place
from mbsym.problems.relative_equilibria.verdict import has_energy, smallness
from mbsym.problems.stability.linear_form import NonholonomicForm
from mbsym.problems.stability.nonholonomic import all_left, one_oscillates, to_the_right
from mbsym.problems.stability.verdict import Verdict, concluded, undecided
from mbsym.problems.stability.words import Because, Fact, Reason

#: More coordinates than this that are no angles are not combined to linear fields.
MOST_PLAIN = 6
#: Formulas up to this length are asked first.
SHORT = 20


@dataclass(frozen=True)
class Symmetry:
    """c = e_k + a + C q: ``place`` is k, ``along`` holds the entries of a, ``slopes`` those of C, that are not 0."""

    place: int
    along: Mapping[int, Polynomial]
    slopes: Mapping[tuple[int, int], Polynomial]


@dataclass(frozen=True)
class Orbits(Rest):
    """The steady motions along ``symmetries`` of the system ``whole``: ``at_rest`` is f - M q'', rows are independent.

    ``speeds`` are the w_k by their places; ``following`` those coordinates whose letter stands for their unknown rate.
    """

    whole: Rest | None = None
    constraints: Constraints | None = None
    symmetries: tuple[Symmetry, ...] = ()
    speeds: Mapping[int, Polynomial] = field(default_factory=dict)
    following: tuple[str, ...] = ()

    @property
    def constant(self) -> tuple[str, ...]:
        """The coordinates that are looked for, and the letters of rates that are."""
        names = self.system.coordinates
        return tuple(name for i, name in enumerate(names) if i not in self.speeds or name in self.following)

    @cached_property
    def keeps_energy(self) -> bool:
        """Whether q'.M q'/2 + V(q) is an integral that the symmetries leave as it is.

        One of the open tree, and rows J q' = 0 whose forces do no work; c . grad V = 0 of every symmetry, unlike on a
        slope, where what may be shifted along it rolls faster and faster.
        """
        whole, ring = self.whole, self.ring
        assert whole is not None
        still = {ring.index("velocity", name): ring.zero for name in self.system.coordinates}
        if any(not ring.substitute(row.velocity, still).is_zero() for row in whole.rows):
            return False
        at_rest = tuple(ring.substitute(x, still) for x in whole.forcing)
        for c in self.symmetries:
            power = at_rest[c.place] + sum((ring.times(x, at_rest[i]) for i, x in c.along.items()), ring.zero)
            for (i, j), x in c.slopes.items():
                shift = ring.times(x, ring.generator("coordinate", self.system.coordinates[j]))
                power = power + ring.times(shift, at_rest[i])
            if ring.is_zero(ring.reduce(power)) is not True:
                return False
        return has_energy(replace(whole, turning=(), rates=still, at_rest=at_rest))

    @cached_property
    def first_approximation(self) -> LinearOnOrbit:
        """For verdicts."""
        return LinearOnOrbit(self)

    @cached_property
    def oscillating(self) -> str:
        """The one position that all velocities follow along every motion; "" if none (``constraints.motion``)."""
        assert self.whole is not None
        assert self.constraints is not None
        scene, names = self.whole.scene, self.system.coordinates
        try:
            tree = equations.equations(scene, energies.energy(scene))
            embedded = embedded_equations(SpeedForm(self.system, self.ring), tree, self.constraints)
        except Failure:
            return ""
        return oscillating_position(self.ring, embedded, names)

    def fastest(self, within: float) -> float:
        """How far rates that follow are looked for: ``within``, or ten times the largest rate that is given."""
        given = (self.ring.constant_value(x) for x in self.speeds.values())
        return max(within, *(10 * abs(float(x.mid())) for x in given if x is not None))

    @property
    def implied(self) -> int | None:
        """The place of an equation that the others imply: sum_i w_i (f - M q'' + J^T lambda)_i = 0 with the energy."""
        turning = [self.system.coordinates.index(name) for name in self.turning]
        return next((i for i in turning if self.speeds[i].is_constant()), None) if self.keeps_energy else None


def symmetries(first: Rest) -> tuple[Symmetry, ...]:
    """Symmetries e_k + a + C q, C among the coordinates k of such, a among others; none of systems that know the time.

    The k are those that turn, where possible.  Raises NoClosedForm beyond the bounds of ``kernel``.
    """
    ring, names = first.ring, first.system.coordinates
    size = range(len(names))
    mass, rows = first.mass_matrix(), first.rows
    every = [*first.forcing, *(x for line in mass for x in line), *(x for row in rows for x in row.partials)]
    every += [x for row in rows for x in (row.position, row.velocity) if x is not None]
    moving = [*(item.name for item in first.system.prescribed), "t"]
    if any(ring.dependencies(x, moving) for x in every):
        return ()
    given = {entry.coordinate for entry in first.system.motion}
    units = sorted(size, key=lambda i: (names[i] in first.turning, names[i] not in given, i))
    plain = [i for i in size if names[i] not in ring.angles]
    linear = [(i, j) for i in plain for j in plain] if len(plain) <= MOST_PLAIN else []
    mixtures = [(i, k) for i in range(len(rows)) for k in range(len(rows))]
    places = [ring.generator("coordinate", name) for name in names]
    speeds = [ring.generator("velocity", name) for name in names]

    laws: list[tuple[Polynomial, list[tuple[int, Polynomial]]]] = []  # a scalar, and what mixes with it besides
    for i in size:  # f is a covector, M a form
        laws.append((first.forcing[i], [(k, first.forcing[a]) for k, (a, b) in enumerate(linear) if b == i]))
        for j in range(i, len(names)):
            mixed = [(k, mass[a][j]) for k, (a, b) in enumerate(linear) if b == i]
            laws.append((mass[i][j], mixed + [(k, mass[i][a]) for k, (a, b) in enumerate(linear) if b == j]))
    for i, row in enumerate(rows):
        of = [other.velocity if row.position is None else other.position for other in rows]
        shares = [(len(linear) + k, -x) for k, (a, b) in enumerate(mixtures) if a == i and (x := of[b]) is not None]
        laws.append((row.velocity if row.position is None else row.position, shares))
    shift = len(linear) + len(mixtures)

    def along(x: Polynomial, mixed: Iterable[tuple[int, Polynomial]], columns: Sequence[int]) -> list[Polynomial]:
        """The derivatives of x along the linear fields and the coordinates among ``columns``."""
        sums = dict.fromkeys(columns, ring.zero)
        for k, (i, j) in enumerate(linear):
            if k in sums:
                sums[k] = ring.times(places[j], ring.derivative(x, names[i]))
                sums[k] = sums[k] + ring.times(speeds[j], ring.velocity_derivative(x, names[i]))
        for k, y in mixed:
            if k in sums:
                sums[k] = sums[k] + y
        return [ring.derivative(x, names[units[k - shift]]) if k >= shift else ring.reduce(y) for k, y in sums.items()]

    columns = list(range(shift + len(names)))
    vectors: list[dict[int, Polynomial]] = []
    for longest in (SHORT, None):  # what short ones exclude is not looked for in long ones
        lists = [along(*law, columns) for law in laws if longest is None or len(law[0]) <= longest]
        vectors = [
            {columns[k]: x for k, x in vector.items()}
            for vector in kernel(ring, *(lists or [[ring.zero] * len(columns)]))
        ]
        columns = sorted({k for vector in vectors for k in vector})
    candidates = []
    for vector in vectors:
        last = max(vector)  # the coefficient that is free
        if last >= shift:
            scale = ring.reciprocal(vector[last])
            parts = {k: ring.reduce(ring.times(x, scale)) for k, x in vector.items() if k != last}
            along_others = {units[k - shift]: x for k, x in parts.items() if k >= shift}
            slopes = {linear[k]: x for k, x in parts.items() if k < len(linear)}
            candidates.append(Symmetry(units[last - shift], along_others, slopes))
    while True:
        known = {c.place for c in candidates}
        sound = [c for c in candidates if all({*entry} <= known for entry in c.slopes)]
        if len(sound) == len(candidates):
            return tuple(sound)
        candidates = sound


def orbits(first: Rest, constraints: Constraints) -> Orbits | None:
    """The steady motions of a system whose rows tie what moves; None where symmetries do not carry all that moves.

    Raises NoClosedForm beyond the bounds of ``kernel``.
    """
    ring, names = first.ring, first.system.coordinates
    carrying = symmetries(first)
    along = [c.place for c in carrying]
    if not {names.index(name) for name in first.turning} <= {*along}:
        return None
    standing = _standing(ring, [names[k] for k in along])
    rows = _independent(
        ring,
        [
            replace(
                row,
                position=None if row.position is None else ring.reduce(ring.substitute(row.position, standing)),
                velocity=ring.reduce(ring.substitute(row.velocity, standing)),
                acceleration=ring.zero,
                partials=tuple(ring.reduce(ring.substitute(x, standing)) for x in row.partials),
            )
            for row in first.rows
        ],
        [k for k, row in enumerate(first.rows) if row.name in {constraints.names[i] for i in constraints.independent}],
    )
    given = {names.index(entry.coordinate) for entry in first.system.motion}
    order = sorted((k for k in along if k not in given), key=lambda k: (names[k] not in constraints.dependent, -k))
    rates, every = _rates(first, rows, carrying, order)
    if any(not every[i].is_zero() for i in given if i not in along):
        return None
    images = {ring.index("velocity", name): x for name, x in zip(names, every, strict=True)}

    def there(x: Polynomial) -> Polynomial:
        return ring.reduce(ring.substitute(ring.substitute(x, standing), images))

    accelerations = [ring.zero] * len(names)
    for c in carrying:
        for (i, j), x in c.slopes.items():
            accelerations[i] = accelerations[i] + ring.times(ring.times(rates[c.place], x), rates[j])
    forces = []
    for line, f in zip(first.mass_matrix(), first.forcing, strict=True):
        inertia = ring.dot([ring.substitute(x, standing) for x in line], accelerations)
        forces.append(ring.reduce(there(f) - inertia))
    told = tuple(replace(row, velocity=there(row.velocity)) for row in rows)
    following = tuple(names[k] for k in order if ring.depends_on(rates[k], names[k]))
    same = {x.name: getattr(first, x.name) for x in fields(Rest)}
    of_orbits = {"at_rest": tuple(forces), "rates": images, "rows": told}
    return Orbits(
        **(same | of_orbits),
        whole=first,
        constraints=constraints,
        symmetries=carrying,
        speeds=rates,
        following=following,
    )


def _standing(ring: Ring, names: Sequence[str]) -> dict[int, Polynomial]:
    """Coordinates at 0, by their generators."""
    images = {ring.index("coordinate", name): ring.zero for name in names}
    for name in names:
        if name in ring.angles:
            images |= {ring.index("sine", name): ring.zero, ring.index("cosine", name): ring.one}
    return images


def _independent(ring: Ring, rows: Sequence[Row], elsewhere: Sequence[int]) -> list[Row]:
    """As many independent rows where the coordinates k are 0 as ``elsewhere``, where possible the same.

    Rows mix along a symmetry, which leaves their rank as it is; but which of them are independent changes: across an
    axle along the first axis of the ground one row of each wheel says the same, of an axle that is askew none.
    """
    source = Random(SEED)
    place = {name: arb(source.uniform(0.1, 1.0)) for name in ring.names()}
    order = [*elsewhere, *(k for k in range(len(rows)) if k not in elsewhere)]
    table = [[ring.evaluate(x, place) for x in rows[k].partials] for k in order]
    chosen = [order[i] for i, _ in eliminated(table, range(len(table[0]))).pivots][: len(elsewhere)]
    return [rows[k] for k in (chosen if len(chosen) == len(elsewhere) else elsewhere)]


def _rates(
    first: Rest, rows: Sequence[Row], carrying: Sequence[Symmetry], order: Sequence[int]
) -> tuple[dict[int, Polynomial], list[Polynomial]]:
    """The rates w_k: as given; those of ``order`` by their letters where rows determine them, and 0 where none does.

    What a row determines by a number is put in.  And the rates of all coordinates.
    """
    ring, names = first.ring, first.system.coordinates
    rates = {c.place: first.rates[ring.index("velocity", names[c.place])] for c in carrying}
    rates |= {k: ring.generator("coordinate", names[k]) for k in order}

    def every() -> list[Polynomial]:
        total = [rates.get(i, ring.zero) for i in range(len(names))]
        for c in carrying:
            for i, x in c.along.items():
                total[i] = ring.reduce(total[i] + ring.times(x, rates[c.place]))
        return total

    at = {ring.index("velocity", name): x for name, x in zip(names, every(), strict=True)}
    kept = [ring.reduce(ring.substitute(row.velocity, at)) for row in rows]
    while True:
        numbers = (
            (k, i, slope)
            for k in order
            for i, x in enumerate(kept)
            if not (slope := ring.derivative(x, names[k])).is_zero() and slope.is_constant()
        )
        k, i, slope = next(numbers, (-1, -1, ring.zero))
        if k < 0:
            break
        letter = ring.generator("coordinate", names[k])
        value = {ring.index("coordinate", names[k]): ring.reduce(letter - kept[i] / slope.leading_coefficient())}
        del kept[i]
        kept = [ring.reduce(ring.substitute(x, value)) for x in kept]
        rates = {place: ring.reduce(ring.substitute(x, value)) for place, x in rates.items()}
    table = [[ring.derivative(x, names[k]) for k in order] for x in kept]
    determined: set[int] = set()
    for column, k in enumerate(order):
        pivot = next((row for row in table if not row[column].is_zero()), None)
        if pivot is None:
            continue
        determined.add(k)
        table.remove(pivot)
        table = [
            [
                ring.reduce(ring.times(pivot[column], x) - ring.times(row[column], y))
                for x, y in zip(row, pivot, strict=True)
            ]
            for row in table
        ]
    nothing = {ring.index("coordinate", names[k]): ring.zero for k in order if k not in determined}
    rates = {k: ring.reduce(ring.substitute(x, nothing)) for k, x in rates.items()}
    return rates, every()


class LinearOnOrbit:
    """The first approximation about the steady motions of ``orbits``, and what Lyapunov's first method says of one."""

    def __init__(self, orbits: Orbits) -> None:
        self.orbits = orbits
        whole, ring = orbits.whole, orbits.ring
        assert whole is not None
        self.whole = whole
        names = whole.system.coordinates
        along = [c.place for c in orbits.symmetries]
        standing = _standing(ring, [names[k] for k in along])
        self._felt = [i for i in range(len(names)) if i not in along]
        self._names = names

        def there(x: Polynomial) -> Polynomial:
            return ring.reduce(ring.substitute(x, standing))

        speeds = [ring.generator("velocity", name) for name in names]
        turned = [ring.zero] * len(names)  # Gamma(w, w)
        for c in orbits.symmetries:
            for (i, j), x in c.slopes.items():
                turned[i] = turned[i] + ring.times(ring.times(speeds[c.place], x), speeds[j])
        self.mass = [[there(x) for x in line] for line in whole.mass_matrix()]
        residual = [
            ring.reduce(ring.dot(line, turned) - there(f)) for line, f in zip(self.mass, whole.forcing, strict=True)
        ]
        independent = [row.name for row in orbits.rows]
        rows = [row for row in whole.rows if row.name in independent]
        self.residual = residual
        self.by_speed = [[ring.velocity_derivative(x, name) for name in names] for x in residual]
        self.by_place = [[ring.derivative(x, names[i]) for i in self._felt] for x in residual]
        self.jacobian = [[there(x) for x in row.partials] for row in rows]
        self.bends = [[[ring.derivative(x, names[i]) for i in self._felt] for x in line] for line in self.jacobian]
        velocities = [there(row.velocity) for row in rows]
        self.moved = [[ring.derivative(x, names[i]) for i in self._felt] for x in velocities]
        self.holonomic = [k for k, row in enumerate(rows) if row.position is not None]

    def verdict(self, place: Place) -> Verdict:
        """At a place of rest along these orbits, by enclosures of the roots."""
        with ctx.workprec(PRECISION):
            try:
                return self._verdict(place)
            except (ZeroDivisionError, *NOT_THERE):
                return undecided(Because.NOT_ENCLOSED)

    def _verdict(self, place: Place) -> Verdict:
        ring, names, felt = self.whole.ring, self._names, self._felt
        w = [ring.evaluate(self.orbits.rates[ring.index("velocity", name)], place.balls) for name in names]
        balls = dict.fromkeys(ring.names(), arb(0)) | {names[i]: place.balls[names[i]] for i in felt}
        balls |= dict(zip(map(velocity_name, names), w, strict=True))

        def look(rows: Sequence[Sequence[Polynomial]]) -> list[list[Any]]:
            return [[arb(0) if x.is_zero() else ring.evaluate(x, balls) for x in row] for row in rows]

        n = len(names)
        mass, damping, stiffness, jacobian = map(look, (self.mass, self.by_speed, self.by_place, self.jacobian))
        (residual,) = look([self.residual])
        for multiplier, lines in zip(_multipliers(jacobian, residual), self.bends, strict=True):
            for i, line in enumerate(look(lines)):
                stiffness[i] = [x - multiplier * y for x, y in zip(stiffness[i], line, strict=True)]
        # Deviations that rows leave: P z of positions, Y u + W x of velocities.
        positions = _reduced([[jacobian[k][i] for i in felt] for k in self.holonomic], len(felt))
        velocities = _reduced(
            [[*row, *(-x for x in x_)] for row, x_ in zip(jacobian, look(self.moved), strict=True)], n
        )
        P, Y = _kernel(positions, len(felt)), _kernel(velocities, n)
        z, u = P.ncols(), Y.ncols()
        W = _matrix([velocities[i][n:] if i in velocities else [arb(0)] * len(felt) for i in range(n)], len(felt)) * P
        M, B, C = _matrix(mass, n), _matrix(damping, n), _matrix(stiffness, len(felt)) * P
        own = [i for k, i in enumerate(felt) if k not in positions]  # z' are velocities less those along symmetries
        moves = [[arb(int(i == k)) for k in range(n)] for i in own]
        for c in self.orbits.symmetries:
            for row, i in zip(moves, own, strict=True):
                row[c.place] -= ring.evaluate(c.along.get(i, ring.zero), balls)
        z_u, z_z = (_matrix(moves, n) * x for x in (Y, W))
        T = Y.transpose()
        try:
            inverse = (T * M * Y).inv()
        except ZeroDivisionError:
            return undecided(Because.MASS_SINGULAR)
        u_u, u_z = (-(inverse * (T * x)) for x in (B * Y + M * W * z_u, B * W + C + M * W * z_z))
        first = _matrix([*_beside(z_z, z_u), *_beside(u_z, u_u)], z + u)
        coefficients = [arb(x) for x in first.charpoly().coeffs()]
        if any(x < 0 for x in coefficients):  # the leading one is 1
            return concluded({Fact.ROOT_RIGHT})
        zeros = next(k for k, x in enumerate(coefficients) if not x.contains(0))
        if self.orbits.oscillating and z == 1 and all(x < 0 for x in _squares(coefficients[u - 1 :])):
            return one_oscillates(NonholonomicForm(drifts=True, pairs=1))
        energy = sum((x * y * mass[i][j] for i, x in enumerate(w) for j, y in enumerate(w)), arb(0))
        # Where the energy is an integral and grows with w, one root is 0; if no other is, the rest is regular on each
        # of its levels, so that there is one steady motion on each near by: a family of one dimension.
        family = int(bool(energy > 0) and self.orbits.keeps_energy)
        if zeros > family:
            return undecided(Because.MORE_ZERO_ROOTS, zeros, family)
        right = to_the_right(coefficients[zeros:])
        if right is None:
            return undecided(Because.NEAR_BORDER)
        if right:
            return concluded({Fact.ROOT_RIGHT}, Reason(Because.RIGHT_ROOTS, (right,)))
        return all_left(NonholonomicForm(family=zeros, drifts=True), zeros)


def _squares(coefficients: Sequence[Any]) -> list[Any]:
    """lambda^2 of a pair of roots: of a lambda^2 + b lambda + c with b = 0, as the motion may run backwards."""
    c, _, a = coefficients
    return [-c / a]


def _reduced(rows: Sequence[Sequence[Any]], size: int) -> dict[int, list[Any]]:
    """Independent rows in balls, with their further entries, reduced: by the columns of their pivots, 1 there."""
    if not rows:
        return {}
    first = pivot_rows([[float(row[k].mid()) for row in rows] for k in range(size)])
    columns = [*first, *(k for k in range(size) if k not in first)]
    table = [[*(row[k] for k in columns), *row[size:]] for row in rows]
    made, pivots = echelon(Balls({}), table, len(rows), smallness)
    reduced = {}
    for place, row in zip(pivots, made, strict=True):
        back = dict(zip(columns, row, strict=False))
        reduced[columns[place]] = [*(back[k] for k in range(size)), *row[size:]]
    return reduced


def _multipliers(jacobian: Sequence[Sequence[Any]], residual: Sequence[Any]) -> list[Any]:
    """lambda of J^T lambda = R, which holds at a steady motion."""
    columns = list(zip(*jacobian, strict=True))
    first = pivot_rows([[float(x.mid()) for x in column] for column in columns])
    solved = _reduced([[*columns[i], residual[i]] for i in first], len(jacobian))
    return [solved[k][-1] for k in range(len(jacobian))]


def _kernel(reduced: Mapping[int, Sequence[Any]], size: int) -> Any:
    """A basis of the vectors that reduced rows annul, as columns."""
    vectors = null_vectors(Balls({}), {k: row[:size] for k, row in reduced.items()}, size)
    return _matrix([[v[i] for v in vectors] for i in range(size)], len(vectors))


def _matrix(rows: Sequence[Sequence[Any]], columns: int) -> Any:
    return arb_mat(len(rows), columns, [x for row in rows for x in row])


def _beside(left: Any, right: Any) -> list[list[Any]]:
    return [[*a, *b] for a, b in zip(left.tolist(), right.tolist(), strict=True)]
