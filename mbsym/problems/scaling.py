"""Dimensionless groups: what of the parameters matters when masses, lengths and times may be measured in any units.

A **scaling** multiplies every parameter by a power of a positive number s,

    p -> s^a(p) p,    q -> s^c(q) q  (angles: c = 0),    t -> s^tau t,

and leaves the equations of motion what they are.  It does so where all terms of each equation  M_ij q_j'' = f_i  are
multiplied by one power of s, and where relations, prescribed motions and the unperturbed motion are kept: linear
equations for the exponents, one for every term.  Their solutions are found exactly, over the rationals; units of the
description are not needed, and if it has more symmetry than units (a pendulum's mass drops out) that is found, too.

    number of groups = number of free parameters - rank of the solutions' exponents of these

One parameter for every unit of that rank is set to 1; each other one then stands for a **group**, itself times powers
of the units, which no scaling changes (Buckingham's theorem; here it is linear algebra).

For the first approximation M x'' + C x' + K x = 0 more is allowed: every equation and every unknown of a subsystem may
be multiplied by a number of its own, so that there are fewer groups.

Groups are products of powers: that sums of parameters, such as (c - b)/a, would do with fewer is for the description's
own notation to say, which the first approximation is written in.

Raises Failure where the equations have no closed form, or formulas divide by zero.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import comb
from typing import Any

from flint import fmpq, fmpq_mat

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.matrices import Operators, added, null_vectors, reduced_rows
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.equations import Equations
from mbsym.problems.in_speeds import SpeedEquations
from mbsym.problems.stability.linear_form import LinearSystem

#: More choices of units than this are not compared: then the first parameters that will do are taken.
MOST_CHOICES = 20_000

Weights = dict[Hashable, Fraction]
TIME = ("time",)


@dataclass(frozen=True)
class Group:
    """``parameter`` times the product of powers of units: ``powers`` are (unit, exponent)."""

    parameter: str
    powers: tuple[tuple[str, Fraction], ...]


@dataclass(frozen=True)
class Groups:
    """``free``: parameters that occur and follow from no others; ``idle``: those that do not occur.

    ``units`` are set to 1; ``groups`` are what is left; ``rate`` is the product of powers of units by which 1/t is
    measured then, ``lengths`` those by which coordinates are that are no angles: (coordinate, powers).  ``singly`` are
    the units that stand in no group: with them only the clock runs faster, or forces are greater.  ``unused``: so many
    scalings more there are, for which no parameter is left that is known to be positive; then there are fewer groups
    wherever one of the others does not vanish.
    """

    free: tuple[str, ...]
    idle: tuple[str, ...]
    units: tuple[str, ...]
    groups: tuple[Group, ...]
    rate: tuple[tuple[str, Fraction], ...] | None
    lengths: tuple[Group, ...] = ()
    unused: int = 0

    @property
    def singly(self) -> tuple[str, ...]:
        inside = {name for group in self.groups for name, _ in group.powers}
        return tuple(name for name in self.units if name not in inside)


def groups(scene: Scene, equations: Equations | SpeedEquations) -> Groups:
    """The groups of the nonlinear equations M q'' = f, constraints, prescribed motions, relations and the motion.

    Of equations in speeds, M u' = f and s' = g; unit vectors, quaternions and the angles they replace are numbers.
    """
    made = _Equations(scene.ring, relations(scene))
    coordinates = scene.system.coordinates
    columns = [made.of_speed(name) for name in scene.system.velocities]
    if isinstance(equations, SpeedEquations):
        columns = [made.of_speed(name) for name in equations.speeds]
        coordinates = (*coordinates, *(name for name in equations.speeds if scene.ring.has("coordinate", name)))
        made.kinematic(scene, equations)
    for i, (row, force) in enumerate(zip(equations.mass_matrix.polynomials, equations.forcing, strict=True)):
        made.equal(force.polynomial, {("equation", i): Fraction(1)})
        for column, entry in zip(columns, row, strict=True):
            weight: Weights = {key: -power for key, power in column.items()}
            weight[TIME] = weight.get(TIME, Fraction(0)) + 1
            made.equal(entry, {("equation", i): Fraction(1), **weight})
    made.constrained(equations.constraints, columns)
    for item in scene.system.prescribed:
        own: Weights = {("coordinate", item.name): Fraction(1)}
        made.equal(scene.lower(item.rate), {**own, TIME: Fraction(-1)})
        if item.initial is not None:
            made.equal(scene.lower(item.initial), own)
    for entry in scene.system.motion:
        own = {("coordinate", entry.coordinate): Fraction(1)}
        made.equal(scene.lower(entry.value), own)
        made.equal(scene.lower(entry.rate), {**own, TIME: Fraction(-1)})
    return _found(scene, made, coordinates)


def linear_groups(scene: Scene, parts: Sequence[tuple[Ring, LinearSystem]]) -> Groups:
    """The groups of the first approximation: of its subsystems, whose matrices hold polynomials of these rings."""
    made = _Equations(scene.ring)
    for number, (ring, part) in enumerate(parts):
        matrices = (added(part.K, part.N), added(part.D, part.G), part.M)
        for order, matrix in enumerate(matrices):
            for i, row in enumerate(matrix):
                for j, entry in enumerate(row):
                    weight: Weights = {("equation", number, i): Fraction(1), ("unknown", number, j): Fraction(-1)}
                    made.equal(entry, {**weight, TIME: Fraction(order)}, ring)
    return _found(scene, made, ())


class _Equations:
    """Linear equations for exponents, collected term by term."""

    def __init__(self, ring: Ring, related: Mapping[int, Polynomial] | None = None) -> None:
        self.ring, self.related = ring, dict(related or {})
        self.rows: list[Weights] = []
        self._adjoined: set[int] = set()

    def equal(self, x: Polynomial, weight: Mapping[Hashable, Fraction], ring: Any = None) -> None:
        """Every term of a polynomial has this weight."""
        own = self.ring if ring is None else ring
        if ring is None and self.related:
            x = self.ring.substitute(x, self.related)
        used = occurring([x])
        of = {k: self._weight(own.indices[k] if hasattr(own, "indices") else k) for k in used}
        for exponents, _ in x.terms():
            row = {key: -value for key, value in weight.items()}
            for k in used:
                for key, value in of[k].items():
                    row[key] = row.get(key, Fraction(0)) + value * int(exponents[k])
            row = {key: value for key, value in row.items() if value}
            if row and row not in self.rows:
                self.rows.append(row)

    def of_speed(self, name: str) -> Weights:
        """The weight of a speed by its name: one of its own, or that of x' where it is called x_dot."""
        if self.ring.has("coordinate", name):
            return {("coordinate", name): Fraction(1)}
        return {("coordinate", name.removesuffix("_dot")): Fraction(1), TIME: Fraction(-1)}

    def kinematic(self, scene: Scene, equations: SpeedEquations) -> None:
        """s' = g, with the length of unit vectors and quaternions, and angles that they stand for."""
        for name, rate in zip(equations.positions, equations.rates, strict=True):
            self.equal(rate.polynomial, {("coordinate", name): Fraction(1), TIME: Fraction(-1)})
        for body in (body for body in scene.system.bodies if body.orientation):
            numbers = [name for orientation in body.orientation for name in orientation.components]
            self.rows += [{("coordinate", name): Fraction(1)} for name in (*numbers, *body.own_angles)]

    def constrained(self, tied: Constraints, columns: Sequence[Weights]) -> None:
        """f = 0 and J u + j = 0, with J^T lambda among the forces: a factor for every row, and for its multiplier."""
        for k, (position, velocity) in enumerate(zip(tied.position, tied.velocity, strict=True)):
            if position is not None:
                self.equal(position.polynomial, {("position", k): Fraction(1)})
            self.equal(velocity.polynomial, {("row", k): Fraction(1)})
            for i, column in enumerate(columns):
                entry = tied.jacobian[k, i].polynomial
                self.equal(entry, {("row", k): Fraction(1), **{key: -power for key, power in column.items()}})
                self.equal(entry, {("equation", i): Fraction(1), ("multiplier", k): Fraction(-1)})

    def parameters(self) -> set[str]:
        """Names of the parameters that occur."""
        return {str(key[1]) for row in self.rows for key in row if isinstance(key, tuple) and key[0] == "parameter"}

    def _weight(self, k: int) -> Weights:
        """The exponent of a generator of the ring."""
        g = self.ring.generators[k]
        match g.kind:
            case "parameter":
                return {} if g.name == "pi" else {("parameter", g.name): Fraction(1)}
            case "coordinate" | "prescribed":
                return {("coordinate", g.name): Fraction(1)}
            case "velocity":
                return {("coordinate", g.name): Fraction(1), TIME: Fraction(-1)}
            case "time":
                return {TIME: Fraction(1)}
            case "sine" | "cosine" if g.argument is None:
                parameter = self.ring.has("parameter", g.name)
                name = ("parameter" if parameter else "coordinate", g.name)
                self._once(k, [{TIME: Fraction(1)} if g.name == "t" else {name: Fraction(1)}])
                return {}
        own: Weights = {("adjoined", k): Fraction(1)}
        if k in self._adjoined:
            return own
        self._adjoined.add(k)
        match g.kind:
            case "reciprocal":
                self.equal(g.argument, {("adjoined", k): Fraction(-1)})
            case "root":
                self.equal(g.argument, {("adjoined", k): Fraction(2)})
            case "function" if g.name == "abs":
                self.equal(g.argument, own)
            case _:  # sign, exp, sine of a sum: numbers of numbers
                self.rows.append(own)
                if g.name != "sign":
                    self.equal(g.argument, {})
        return own

    def _once(self, k: int, rows: Iterable[Weights]) -> None:
        if k not in self._adjoined:
            self._adjoined.add(k)
            self.rows += rows

    def solutions(self, further: Iterable[Hashable]) -> tuple[list[Hashable], list[list[fmpq]]]:
        """(unknowns, a basis of the exponents that satisfy everything)."""
        unknowns = list(dict.fromkeys([*further, *(key for row in self.rows for key in row)]))
        if not self.rows:
            return unknowns, [[fmpq(int(i == j)) for j in range(len(unknowns))] for i in range(len(unknowns))]
        place = {key: k for k, key in enumerate(unknowns)}
        matrix = fmpq_mat(len(self.rows), len(unknowns))
        for i, row in enumerate(self.rows):
            for key, value in row.items():
                matrix[i, place[key]] = rationals.exact(value)
        return unknowns, null_vectors(Operators(fmpq(0), fmpq(1)), reduced_rows(matrix), len(unknowns))


def _found(scene: Scene, made: _Equations, coordinates: Sequence[str]) -> Groups:
    related = {relation.name for relation in scene.system.relations}
    there = made.parameters()
    symbols = [*(x.name for x in scene.system.parameters), *(x.name for x in scene.system.notation)]
    free = tuple(name for name in symbols if name in there and name not in related)
    idle = tuple(x.name for x in scene.system.parameters if x.name not in there and x.name not in related)
    names: list[Hashable] = [("parameter", name) for name in free]
    lengths = [name for name in coordinates if scene.ring.has("coordinate", name)]
    unknowns, basis = made.solutions([*names, TIME, *(("coordinate", name) for name in lengths)])
    place = {key: k for k, key in enumerate(unknowns)}
    exponents = {name: [vector[place["parameter", name]] for vector in basis] for name in free}
    units, held = _units(free, exponents, {x.name: x.sign for x in scene.system.parameters})
    rate = [-vector[place[TIME]] for vector in basis]
    own = {name: [vector[place["coordinate", name]] for vector in basis] for name in lengths}
    return measured_in(exponents, units, rate, own, idle=idle, held=held)


def measured_in(
    exponents: Mapping[str, Sequence[fmpq]],
    units: tuple[str, ...],
    rate: Sequence[fmpq],
    lengths: Mapping[str, Sequence[fmpq]],
    idle: tuple[str, ...] = (),
    held: tuple[str, ...] = (),
) -> Groups:
    """Parameters with these ``exponents`` (of scalings, or of base units), the ``rate`` and ``lengths`` in units."""
    table = [exponents[name] for name in (*units, *held)]

    def powers(weights: Sequence[fmpq]) -> tuple[tuple[str, Fraction], ...] | None:
        solution = _solved(table, weights)
        return None if solution is None else tuple(x for x in zip(units, solution, strict=False) if x[1])

    left = []
    for name, weights in exponents.items():
        if name not in units:
            own = powers(weights)
            left.append(Group(name, tuple((unit, -power) for unit, power in own or ())))
    measured = [Group(name, own) for name, weights in lengths.items() if (own := powers(weights))]
    return Groups(tuple(exponents), idle, units, tuple(left), powers(rate), tuple(measured), len(held))


def independent(names: Iterable[str], exponents: Mapping[str, Sequence[fmpq]]) -> tuple[str, ...]:
    """As many of the names, the first ones, as are independent of each other."""
    chosen: list[str] = []
    for name in names:
        if name not in chosen and _rank([exponents[x] for x in (*chosen, name)]) > len(chosen):
            chosen.append(name)
    return tuple(chosen)


def _units(
    free: Sequence[str], exponents: Mapping[str, Sequence[fmpq]], signs: Mapping[str, str]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """(units, held): parameters that are set to 1, and others that are left as they are though they could be scaled.

    Units are positive, and such that the powers in the groups are whole and small.  Where fewer of them are independent
    than there are scalings, the scalings that are used are those that change none of ``held``.
    """
    candidates = [name for name in free if signs.get(name) == "positive"]
    size = _rank([exponents[name] for name in candidates])
    best: tuple[Any, tuple[str, ...], tuple[str, ...]] | None = None
    for number, chosen in enumerate(combinations(candidates, size)):
        if number > MOST_CHOICES and best is not None:
            break
        if _rank([exponents[name] for name in chosen]) < size:
            continue
        held = independent((*chosen, *free), exponents)[size:]
        table = [exponents[name] for name in (*chosen, *held)]
        powers = [(_solved(table, exponents[name]) or ())[:size] for name in free if name not in chosen]
        cost = (
            sum(x.denominator > 1 for row in powers for x in row),
            sum(abs(x) for row in powers for x in row),
            number,
        )
        if best is None or cost < best[0]:
            best = cost, chosen, held
        if comb(len(candidates), size) > MOST_CHOICES:
            break
    return ((), ()) if best is None else best[1:]


def _solved(rows: Sequence[Sequence[fmpq]], target: Sequence[fmpq]) -> tuple[Fraction, ...] | None:
    """x with sum x_k rows_k = target; None where there is none, or more than one."""
    if not rows:
        return () if all(x == 0 for x in target) else None
    size = len(rows)
    table = fmpq_mat([[*column, t] for column, t in zip(zip(*rows, strict=True), target, strict=True)])
    reduced, rank = table.rref()
    if rank != size or any(reduced[i, j] != int(i == j) for i in range(size) for j in range(size)):
        return None
    return tuple(Fraction(int(reduced[i, size].p), int(reduced[i, size].q)) for i in range(size))


def _rank(rows: Sequence[Sequence[fmpq]]) -> int:
    return int(fmpq_mat([list(row) for row in rows]).rank()) if rows and rows[0] else 0
