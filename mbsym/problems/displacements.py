"""Displacements that change no equation of motion: directions c, constant in the coordinates, with

    sum c_i dT/dq_i = 0    and    sum c_i d(dU/dq_j + Q_j)/dq_i = 0    for every j;

under constraints with rows g = J q' + j besides  J c = 0  and  sum c_i dg/dq_i = 0:  then the constraints allow them.

A cyclic coordinate is one of them, along its own axis; in other coordinates the same is a sum of several (two masses on
a ring: both move alike).  Taken as coordinates, by a constant linear change q = P y, they are cyclic in the usual
sense, so that verdicts do not depend on the coordinates of a description.  By Lagrange's equations the momentum along c

    p = sum c_i dT/dq'_i,    p' = sum c_i (dU/dq_i + Q_i),

is constant if that sum vanishes: Noether.

Coefficients are solved for over the field of the parameters, by comparing those of equal monomials: every direction is
one, some may be missing where formulas have other normal forms.

Directions that vary with the position are fields c(q) with, besides,

    sum c_i dT/dq_i + c_i' dT/dq'_i = 0,    sum c_i dF_j/dq_i + c_i' dF_j/dq'_i + F_i dc_i/dq_j = 0,

F_j = dU/dq_j + Q_j, and J c = 0 under integrable constraints:
then the flow of c takes motions into motions (a particle's x, y turned about an axis, a body turned in space).  Near a
position at which c is not 0 there are coordinates, made by that flow, of which one changes along c alone: a cyclic one.
Matrices of the first approximation become P^T A P with the columns c of P at the motion, if c is constant along it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations

from mbsym.algebra.matrices import ScalarMatrix, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.expressions.message import Message, joined
from mbsym.formulas.formula import Formula

#: Formulas with more terms together are not looked at.
MOST_TERMS = 40_000
#: So many choices of coordinates that directions take the place of are tried.
MOST_CHOICES = 200

Direction = tuple[Polynomial, ...]


@dataclass(frozen=True)
class Displacements:
    """``directions`` by ``coordinates``, of which the first ``constant`` ones have constant momenta.

    ``driven``: numbers of those on which forces of higher order act.  ``fields`` tell in words those that vary with the
    position, by their numbers.
    """

    coordinates: tuple[str, ...]
    directions: tuple[Direction, ...] = ()
    constant: int = 0
    driven: tuple[int, ...] = ()
    fields: Mapping[int, str] = field(default_factory=dict)


def displacements(
    ring: Ring,
    coordinates: Sequence[str],
    kinetic: Polynomial,
    forces: Sequence[Polynomial],
    moving: Sequence[str],
    rows: Sequence[tuple[Polynomial, Sequence[Polynomial]]] = (),
) -> Displacements:
    """All directions along ``coordinates`` as above; ``forces`` are dU/dq_j + Q_j of every coordinate, these first.

    ``moving`` are all coordinates and velocities, ``rows`` pairs of g and of the partials J along ``coordinates``.
    Raises NoClosedForm beyond the bounds.
    """
    from mbsym.algebra.kernel import kernel  # most systems have no zero roots to be explained

    none = Displacements(tuple(coordinates))
    if len(kinetic) + sum(map(len, forces)) > MOST_TERMS:
        return none
    lists = [[ring.derivative(x, name) for name in coordinates] for x in (kinetic, *forces, *(g for g, _ in rows))]
    lists += [list(partials) for _, partials in rows]
    free = [_whole(ring, vector, len(coordinates)) for vector in kernel(ring, *lists)]
    if not free:
        return none
    works = [_along(ring, c, forces) for c in free]
    constant = [
        tuple(
            ring.reduce(sum((w * free[k][i] for k, w in weights.items()), ring.zero)) for i in range(len(coordinates))
        )
        for weights in kernel(ring, works)
    ]
    others = _completing(ring, constant, free)
    driven = [
        k
        for k, c in enumerate(others, start=len(constant))
        if not _is_linear(ring, _along(ring, c, forces), coordinates, moving)
    ]
    return Displacements(tuple(coordinates), (*constant, *others), len(constant), tuple(driven))


def _whole(ring: Ring, vector: dict[int, Polynomial], size: int) -> Direction:
    return tuple(vector.get(i, ring.zero) for i in range(size))


def _along(ring: Ring, direction: Direction, forces: Sequence[Polynomial]) -> Polynomial:
    return ring.reduce(sum((ring.times(c, x) for c, x in zip(direction, forces, strict=False)), ring.zero))


def _completing(ring: Ring, basis: Sequence[Direction], directions: Sequence[Direction]) -> list[Direction]:
    """Those of the directions that enlarge what a basis spans."""
    from mbsym.algebra.kernel import kernel

    added: list[Direction] = []
    for c in directions:
        columns = [*basis, *added, c]
        if not kernel(ring, *([x[i] for x in columns] for i in range(len(c)))):
            added.append(c)
    return added


def _is_linear(ring: Ring, x: Polynomial, coordinates: Sequence[str], moving: Sequence[str]) -> bool:
    """Whether a force is a linear form in coordinates and velocities: then it shows in D and N."""
    slopes = [ring.derivative(x, name) for name in coordinates]
    slopes += [ring.velocity_derivative(x, name) for name in coordinates]
    return not any(ring.dependencies(slope, moving) for slope in slopes)


# --- that vary with the position ---

#: Fields that are combined, and terms of what their combinations have to leave unchanged.
MOST_FIELDS, MOST_FIELD_TERMS = 40, 4_000
#: All that is done to find symmetries among them may take so much work.
FIELD_WORK = 10_000_000


def linear_fields(ring: Ring, coordinates: Sequence[str]) -> list[Direction]:
    """q_j e_i of the coordinates that are no angles."""
    plain = [i for i, name in enumerate(coordinates) if name not in ring.angles]
    return [
        tuple(ring.generator("coordinate", coordinates[j]) if k == i else ring.zero for k in range(len(coordinates)))
        for i in plain
        for j in plain
    ]


def turned_fields(
    ring: Ring,
    coordinates: Sequence[str],
    angles: Sequence[str],
    rates: Sequence[Sequence[Polynomial]],
    axes: Sequence[Sequence[Polynomial]],
) -> list[Direction]:
    """How three angles a change when a body is turned about some axes: a' = W^-1 e.

    ``rates``: W of omega = W a', where ``axes`` e have their components, too.  () where W is singular everywhere.
    """
    size = determinant(ring, rates)
    if size.is_zero():
        return []
    inverse = ring.reciprocal(size)
    directions = []
    for axis in axes:
        turned = {}
        for j, name in enumerate(angles):
            rows = [[*row[:j], x, *row[j + 1 :]] for row, x in zip(rates, axis, strict=True)]
            turned[name] = ring.reduce(ring.times(determinant(ring, rows), inverse))
        directions.append(tuple(turned.get(name, ring.zero) for name in coordinates))
    return directions


def symmetries(
    ring: Ring,
    coordinates: Sequence[str],
    kinetic: Polynomial,
    forces: Sequence[Polynomial],
    fields: Sequence[Direction],
    here: Callable[[Polynomial], Polynomial],
    standing: Sequence[str],
    rows: Sequence[Sequence[Polynomial]] = (),
) -> list[tuple[Direction, Direction, bool]]:
    """(c, its value on the motion, whether p is constant) for the combinations of fields that change no equation.

    ``rows`` J of integrable constraints allow them, J c = 0: they lead from a leaf into itself, without work.
    ``here`` puts the motion in; only fields of ``standing`` coordinates are told, and those with values that are not 0.
    Raises NoClosedForm beyond the bounds.
    """
    from mbsym.algebra.kernel import kernel

    units = [tuple(ring.one if k == i else ring.zero for k in range(len(coordinates))) for i in range(len(coordinates))]
    tried = [*units, *fields][:MOST_FIELDS]
    if len(kinetic) + sum(map(len, forces)) > MOST_FIELD_TERMS:
        return []
    lists = [[_lie(ring, coordinates, c, kinetic) for c in tried], *([_along(ring, c, x) for c in tried] for x in rows)]
    for j, name in enumerate(coordinates):
        lists.append(
            [
                _lie(ring, coordinates, c, forces[j])
                + sum((ring.times(f, ring.derivative(x, name)) for f, x in zip(forces, c, strict=True)), ring.zero)
                for c in tried
            ]
        )
    accepted: list[tuple[Direction, Direction, bool]] = []
    combined = [
        tuple(
            ring.reduce(sum((ring.times(w, tried[k][i]) for k, w in weights.items()), ring.zero))
            for i in range(len(coordinates))
        )
        for weights in kernel(ring, *[[ring.reduce(x) for x in row] for row in lists])
    ]
    for c in sorted(combined, key=lambda c: any(ring.dependencies(x, coordinates) for x in c)):
        if any(not set(ring.dependencies(x, coordinates)) <= {*standing} for x in c) or _shears(ring, coordinates, c):
            continue
        value = tuple(here(x) for x in c)
        if not all(x.is_zero() for x in value):
            accepted.append((c, value, _along(ring, c, forces).is_zero()))
    return accepted


def independent(
    ring: Ring, coordinates: Sequence[str], found: Sequence[tuple[Direction, Direction, bool]]
) -> list[tuple[Direction, Direction, bool]]:
    """Those with independent values on the motion.

    Of fields that do not commute it is not said that p is constant: they are no cyclic coordinates of one description,
    so that Routh's reduction is not theirs; energies and families of equilibria ask for less.
    """
    accepted: list[tuple[Direction, Direction, bool]] = []
    for symmetry in found:
        if _completing(ring, [v for _, v, _ in accepted], [symmetry[1]]):
            accepted.append(symmetry)
    if all(_commute(ring, coordinates, a, b) for (a, _, _), (b, _, _) in combinations(accepted, 2)):
        return accepted
    return [(c, value, False) for c, value, _ in accepted]


def _shears(ring: Ring, coordinates: Sequence[str], c: Direction) -> bool:
    """Whether a linear field is not known to turn: q' = A q + a with A^3 = -s A, s > 0, or A = 0, keeps rates bounded.

    In u = x + y^2 and y a free particle has the symmetry (2 y, 1), but u' = x' + 2 y y' grows with y.  Fields of angles
    are periodic in these.
    """
    names = [name for name, x in zip(coordinates, c, strict=True) if not x.is_zero()]
    names += [name for name in coordinates if name not in names and any(ring.dependencies(x, [name]) for x in c)]
    parts = [c[coordinates.index(name)] for name in names]
    slopes = ScalarMatrix(ring, [[ring.derivative(x, name) for name in names] for x in parts])
    if any(ring.dependencies(x, coordinates) for row in slopes.rows for x in row):
        return False
    cubed = slopes @ (slopes @ slopes)
    pairs = [
        (x, y) for row, other in zip(slopes.rows, cubed.rows, strict=True) for x, y in zip(row, other, strict=True)
    ]
    lead = next(((x, y) for x, y in pairs if not x.is_zero()), None)
    if lead is None:
        return False
    a, b = lead
    alike = all(ring.is_zero(ring.times(a, y) - ring.times(b, x)) is True for x, y in pairs)
    return not (alike and ring.is_positive(ring.reduce(-ring.times(a, b))))


def _lie(ring: Ring, coordinates: Sequence[str], c: Direction, x: Polynomial) -> Polynomial:
    """The rate of a function of q and q' along the flow of c."""
    total = ring.zero
    for name, component in zip(coordinates, c, strict=True):
        if component.is_zero():
            continue
        total = total + ring.times(component, ring.derivative(x, name))
        rate = _rate(ring, coordinates, component)
        if not rate.is_zero():
            total = total + ring.times(rate, ring.velocity_derivative(x, name))
    return total


def _rate(ring: Ring, coordinates: Iterable[str], x: Polynomial) -> Polynomial:
    known = ring.dependencies(x, coordinates)
    slopes = ((ring.derivative(x, name), ring.generator("velocity", name)) for name in known)
    return ring.reduce(sum((ring.times(a, b) for a, b in slopes), ring.zero))


def _commute(ring: Ring, coordinates: Sequence[str], a: Direction, b: Direction) -> bool:
    for x, y in zip(a, b, strict=True):
        parts = (
            ring.times(u, ring.derivative(y, name)) - ring.times(v, ring.derivative(x, name))
            for name, u, v in zip(coordinates, a, b, strict=True)
        )
        if ring.is_zero(ring.reduce(sum(parts, ring.zero))) is not True:
            return False
    return True


def among(
    ring: Ring, found: Sequence[tuple[Direction, Direction, bool]], every: Sequence[str], coordinates: Sequence[str]
) -> Displacements:
    """Their combinations whose values lie along some of ``every`` coordinates, those with constant momenta first.

    Of c_1, c_2, ... with values v_1, v_2, ...  sum w_k c_k  where  sum w_k v_k = 0  at the other coordinates.
    """
    from mbsym.algebra.kernel import kernel

    places = [every.index(name) for name in coordinates]
    ordered = sorted(found, key=lambda symmetry: not symmetry[2])
    zero = [[value[i] for _, value, _ in ordered] for i in range(len(every)) if i not in places]
    own: list[tuple[Direction, Direction, bool]] = []
    for weights in kernel(ring, *(zero or [[ring.zero] * len(ordered)])):
        shares = list(weights.values())
        field, value = (
            tuple(ring.reduce(ring.dot(shares, [parts[k][i] for k in weights])) for i in range(len(every)))
            for parts in ([c for c, _, _ in ordered], [value for _, value, _ in ordered])
        )
        if len(weights) == 1 or not _shears(ring, every, field):
            own.append((field, value, all(ordered[k][2] for k in weights)))
    own.sort(key=lambda symmetry: not symmetry[2])
    constant = sum(symmetry[2] for symmetry in own)
    fields = {k: _displacement(ring, c, every, "d") for k, (c, value, _) in enumerate(own) if c != value}
    directions = tuple(tuple(value[i] for i in places) for _, value, _ in own)
    return Displacements(tuple(coordinates), directions, constant, tuple(range(constant, len(own))), fields)


# --- as coordinates ---


@dataclass(frozen=True)
class Basis:
    """q = P y in some ``coordinates``: ``columns`` of P, polynomials in parameters; the first are directions.

    ``names`` tell what the y are in the user's coordinates, ``directions`` how these move together.
    """

    coordinates: tuple[str, ...]
    columns: tuple[Direction, ...]
    names: tuple[str, ...]
    directions: tuple[str, ...]

    @property
    def together(self) -> tuple[str, ...]:
        """The directions along which more than one coordinate moves."""
        return tuple(x for x in self.directions if x not in self.coordinates)

    def congruent(self, ring: Ring, rows: Sequence[Sequence[Polynomial]]) -> list[list[Polynomial]]:
        """P^T A P."""
        p_transposed = ScalarMatrix(ring, self.columns)
        return [list(row) for row in p_transposed @ (ScalarMatrix(ring, rows) @ p_transposed.T)]

    def through(self, ring: Ring, image: Callable[[Polynomial], Polynomial]) -> Basis:
        """The same in other symbols; a common denominator of a column is left out."""
        return replace(self, columns=tuple(_cleared(ring, [image(x) for x in column]) for column in self.columns))


def _cleared(ring: Ring, column: Sequence[Polynomial]) -> Direction:
    for bottom, exponent in (x for entry in column for x in ring.fraction(entry)[1]):
        column = [ring.reduce(ring.times(x, ring.power(bottom, exponent))) for x in column]
    return tuple(ring.fraction(x)[0] for x in column)


def basis(ring: Ring, found: Displacements, signs: Signs) -> Basis | None:
    """Directions and coordinates that together tell all positions; None where no choice is known to do so."""
    size = len(found.coordinates)
    for tried, places in enumerate(combinations(range(size), len(found.directions))):
        if tried == MOST_CHOICES:
            return None
        regular = determinant(ring, [[c[i] for i in places] for c in found.directions])
        number = ring.constant_value(regular)  # the ring may hold it, sin(1), since the signs were told
        if signs.sign(regular) in ("positive", "negative") or (number is not None and not number.contains(0)):
            break
    else:
        return None
    others = [i for i in range(size) if i not in places]
    units = [tuple(ring.one if i == k else ring.zero for i in range(size)) for k in others]
    labels = tuple(
        found.fields.get(k) or _displacement(ring, c, found.coordinates) for k, c in enumerate(found.directions)
    )
    remaining = tuple(_left(ring, found, places, i) for i in others)
    return Basis(found.coordinates, (*found.directions, *units), (*labels, *remaining), labels)


def _left(ring: Ring, found: Displacements, places: Sequence[int], i: int) -> str:
    """What is left of a coordinate without the displacements, but for a factor: ``b - a``."""
    name = found.coordinates[i]
    moving = [c for c in found.directions if not c[i].is_zero()]
    if not moving:
        return name
    if len(found.directions) > 1:
        return Message("[[name]] without the displacements", name=name)
    (c,), (place,) = moving, places

    def times(factor: Polynomial, of: str) -> str:
        text = str(Formula(ring, factor))
        return of if text == "1" else f"{text}*{of}" if len(factor) == 1 else f"({text})*{of}"

    return f"{times(c[place], name)} - {times(c[i], found.coordinates[place])}".replace(" - -", " + ")


def _displacement(ring: Ring, direction: Direction, coordinates: Sequence[str], mark: str = "") -> str:
    """``a``, or ``(a, b) = (r, -1)``: how coordinates move together; ``(da, db) = (-b, a)`` with a mark."""
    moved = [(name, Formula(ring, c)) for name, c in zip(coordinates, direction, strict=True) if not c.is_zero()]
    if len(moved) == 1 and not mark:
        return moved[0][0]
    formulas = [Formula(ring, ring.generator("coordinate", name)) for name, _ in moved]
    names = joined((joined((mark, x), "") for x in formulas), ", ")
    return joined(("(", names, ") = (", joined((rate for _, rate in moved), ", "), ")"), "")
