"""All rests in one set of angles, solved exactly with direction cosines as unknowns (``rest_cosines``).

It is the second way for systems that outgrow the exact solution in sines and cosines (a gyrostat in an orbit with any
gyrostatic moment).  The system here is equivalent to f = 0 wherever the angles are regular: all components of the
moment of every joint in one frame, what acts on the other coordinates, and the relations of the direction cosines.
So a complete list of its real solutions (``polynomial_systems.solve``) is a complete list of the orientations at rest.

The angles follow:  of three turns about different axes one entry of R is +-sin x2, four are +-sin x1 cos x2,
+-cos x1 cos x2, +-sin x3 cos x2, +-cos x3 cos x2, with  cos x2 = +-sqrt(1 - sin^2 x2):  two descriptions of one
orientation (sine and cosine of x2 exchanged where the first axis is repeated).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, combinations_with_replacement, product
from typing import Any

from flint import ctx, fmpq, fmpq_mat, fmpq_poly, fmpz

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.matrices import reduced_rows
from mbsym.algebra.polynomial_systems import AlgebraicPoint, Limits, context, solve
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.charts import Chart, Joint, moment_components, rows
from mbsym.mechanics.rest import Rest
from mbsym.problems.relative_equilibria.place import PRECISION, Place, Unknowns, angle_of, at_zero, ball_at, exact_rates

# Direction cosines as unknowns of a rest, in place of the sines and cosines of three angles.
#
# The orientation of a body against the one it hangs on is a matrix R (rows: the axes of the body in components of the
# previous one).  What acts at rest depends on R, not on the angles that describe it, and where the angles are regular
#
#     f = 0   if and only if   tau = 0,      tau: the moment in axes of either body (``charts.moment_components``).
#
# In the entries of two columns u, v (or two rows) of R, which determine the third as u x v, tau is a polynomial of low
# degree: of a gyrostat in an orbit tau = 3 e x I e - n x (I n + h).  With  u.u = v.v = 1, u.v = 0  such a system has
# one solution for each orientation, where sines and cosines have two, and its Groebner basis is much smaller.
#
# A trigonometric polynomial g is written in the entries by linear algebra: the monomials of degree up to d in them,
# written out in sines and cosines, are independent or dependent vectors over QQ, and g is a combination of them or is
# not.  It is an identity, so nothing has to be trusted: where it does not come out for some g, there is no such system.


#: Degrees of the monomials in direction cosines that are tried, and the most of them.
DEGREES = (1, 2, 3)
MOST_MONOMIALS = 120

Entry = tuple[int, int]
Terms = dict[tuple[int, ...], Any]


@dataclass(frozen=True)
class Choice:
    """Which entries of R are unknowns: one or two of its columns, or of its rows, each a unit vector."""

    vectors: tuple[tuple[Entry, ...], ...]

    @property
    def entries(self) -> tuple[Entry, ...]:
        return tuple(x for vector in self.vectors for x in vector)

    def third(self) -> tuple[Entry, ...]:
        """The entries of the line that follows from two, in the order of its components."""
        column = self.vectors[0][0][1] == self.vectors[0][1][1]
        used = {vector[0][1] if column else vector[0][0] for vector in self.vectors}
        (left,) = {0, 1, 2} - used
        return tuple((k, left) if column else (left, k) for k in range(3))

    def sign(self) -> int:
        """third = sign * (first x second)."""
        column = self.vectors[0][0][1] == self.vectors[0][1][1]
        first, second = (vector[0][1] if column else vector[0][0] for vector in self.vectors)
        return 1 if (second - first) % 3 == 1 else -1


def choices(joint: Joint) -> Iterator[Choice]:
    """Unknowns that may do for a joint: what its free angles leave, else two columns or two rows."""
    columns = [tuple((k, j) for k in range(3)) for j in range(3)]
    lines = [tuple((k, j) for j in range(3)) for k in range(3)]
    if joint.first_free:
        yield Choice((columns[joint.axes[0] - 1],))
    elif joint.last_free:
        yield Choice((lines[joint.axes[2] - 1],))
    else:
        for part in (columns, lines):
            for pair in combinations(part, 2):
                yield Choice(pair)


class Cosines:
    """The entries of one joint's R as polynomials in its sines and cosines, and the way back."""

    def __init__(self, found: Rest, joint: Joint, choice: Choice) -> None:
        self.ring: Ring = found.ring
        self.joint, self.choice = joint, choice
        self.matrix = rows(found, joint)
        self.own = frozenset(
            self.ring.index(kind, name)
            for name in joint.angles
            for kind in ("sine", "cosine")
            if self.ring.has(kind, name)
        )
        self.plain = frozenset(self.ring.index("coordinate", name) for name in joint.angles)

    def written(self, polynomials: Sequence[Polynomial]) -> list[list[tuple[tuple[int, ...], Terms]]] | None:
        """Each g as pairs (exponents of the entries, coefficients in the other generators by their monomials), or None.

        g = sum over the pairs of  (product of entries) * (the polynomial of the terms).
        """
        parts = [self._split(x) for x in polynomials]
        if any(part is None for part in parts):
            return None
        vectors = [(k, rest, inner) for k, part in enumerate(parts) for rest, inner in (part or {}).items()]
        for degree in DEGREES:
            monomials = self._monomials(degree)
            if len(monomials) > MOST_MONOMIALS:
                return None
            weights = _combinations([x for _, x in monomials], [inner for _, _, inner in vectors])
            if weights is None:
                continue
            forms: list[dict[tuple[int, ...], Terms]] = [{} for _ in polynomials]
            for (k, rest, _), weight in zip(vectors, weights, strict=True):
                for (exponents, _), number in zip(monomials, weight, strict=True):
                    if number:
                        forms[k].setdefault(exponents, {})[rest] = number
            return [list(item.items()) for item in forms]
        return None

    def _split(self, x: Polynomial) -> dict[tuple[int, ...], Terms] | None:
        """By the monomials of the other generators; None where one of these is made of the joint's angles."""
        for k in occurring([x]):
            argument = self.ring.generators[k].argument
            if k in self.plain or (argument is not None and self.own & self.ring.held([argument])):
                return None
        parts: dict[tuple[int, ...], Terms] = {}
        for monomial, coefficient in self.ring.reduce(x).terms():
            inner = tuple(int(e) if k in self.own else 0 for k, e in enumerate(monomial))
            rest = tuple(0 if k in self.own else int(e) for k, e in enumerate(monomial))
            parts.setdefault(rest, {})[inner] = coefficient
        return parts

    def _monomials(self, degree: int) -> list[tuple[tuple[int, ...], Terms]]:
        """(exponents, its terms in sines and cosines), short ones first."""
        entries = [self.matrix[k][j] for k, j in self.choice.entries]
        known: dict[tuple[int, ...], Polynomial] = {(): self.ring.one}
        monomials = []
        for size in range(degree + 1):
            for chosen in combinations_with_replacement(range(len(entries)), size):
                if chosen:
                    known[chosen] = self.ring.reduce(known[chosen[:-1]] * entries[chosen[-1]])
                exponents = tuple(chosen.count(k) for k in range(len(entries)))
                monomials.append((exponents, {tuple(map(int, m)): c for m, c in known[chosen].terms()}))
        return monomials


def _combinations(basis: Sequence[Terms], targets: Sequence[Terms]) -> list[list[Any]] | None:
    """Numbers w with  sum_k w_k basis_k = wanted  for each of ``targets``, earlier members first; else None."""
    every = [*basis, *targets]
    places = {m: k for k, m in enumerate(dict.fromkeys(m for x in every for m in x))}
    if not targets:
        return []
    table = [[fmpq(0)] * len(every) for _ in places]
    for column, x in enumerate(every):
        for monomial, coefficient in x.items():
            table[places[monomial]][column] = fmpq(coefficient)
    reduced = reduced_rows(fmpq_mat(table))
    if any(pivot >= len(basis) for pivot in reduced):
        return None
    weights = []
    for k in range(len(targets)):
        numbers = [fmpq(0)] * len(basis)
        for pivot, row in reduced.items():
            numbers[pivot] = row[len(basis) + k]
        weights.append(numbers)
    return weights


#: Bits of a coefficient that are allowed, as a multiple of those in sines and cosines; the part of the work (the
#: general gyrostat takes 150,000 steps of ten million); and the size of one interreduction (the gyrostat: 40 million).
BITS, PART, REDUCTION = 3, 20, 100_000_000

Split = Callable[[Polynomial], Iterable[Polynomial]]


@dataclass(frozen=True)
class Orientations:
    """The places of rest in one chart, every one and each in all its sets of angles.

    ``joints``: the bodies whose direction cosines were the unknowns.
    """

    places: tuple[Place, ...]
    joints: tuple[str, ...]


def orientations(
    chart: Chart, names: Sequence[str], nonzero: Sequence[Polynomial], split: Split, limits: Limits
) -> Orientations | None:
    """All real solutions of f = 0 in a chart at which no polynomial of ``nonzero`` vanishes.

    ``names``: the coordinates that occur in f.  ``split``: what must vanish so that a polynomial does at all times.
    None where the equations are no polynomials in direction cosines, where their solutions are not isolated, or where
    the solution is not finished within ``limits``: nothing is known then.
    """
    replaced = [joint for joint in chart.joints if len(joint.angles) == 3 and set(joint.angles) & set(names)]
    if not replaced:
        return None
    per_joint = [[(frame, choice) for frame in (0, 1) for choice in choices(joint)] for joint in replaced]
    components = [moment_components(chart.rest, joint) for joint in replaced]
    for picked in product(*per_joint):
        moments = [components[k][frame] for k, (frame, _) in enumerate(picked)]
        if any(not part or any(x is None for x in part) for part in moments):
            continue
        system = _System.of(chart, replaced, [choice for _, choice in picked], moments, split)
        if system is not None:
            return system.solved(names, nonzero, limits)
    return None


class _System:
    """The equations in direction cosines and in the other unknowns."""

    def __init__(self, chart: Chart, cosines: Sequence[Cosines], equations: Sequence[Polynomial]) -> None:
        self.chart, self.ring, self.cosines = chart, chart.rest.ring, cosines
        self.original = list(equations)

    @staticmethod
    def of(
        chart: Chart,
        joints: Sequence[Joint],
        chosen: Sequence[Choice],
        moments: Sequence[Sequence[Polynomial | None]],
        split: Split,
    ) -> _System | None:
        rest, ring = chart.rest, chart.rest.ring
        inside = {name for joint in joints for name in joint.angles}
        conditions = [x for name, x in zip(rest.system.coordinates, rest.at_rest, strict=True) if name not in inside]
        conditions += [x for part in moments for x in part if x is not None]
        parts = [y for x in conditions for y in split(x)]
        equations = [ring.fraction(x)[0] for x in (*parts, *chart.restrictions)]
        cosines = [Cosines(rest, joint, choice) for joint, choice in zip(joints, chosen, strict=True)]
        system = _System(chart, cosines, [x for x in equations if not x.is_zero()])
        return system if system._written() else None

    def _written(self) -> bool:
        """Whether the equations are polynomials in the entries; they are made on the way."""
        terms: list[dict[tuple[tuple[int, ...], ...], Any]] = [{(): x} for x in self.original]
        for cosine in self.cosines:
            fresh: list[dict[tuple[tuple[int, ...], ...], Any]] = []
            for item in terms:
                written = cosine.written(list(item.values()))
                if written is None:
                    return False
                grown: dict[tuple[tuple[int, ...], ...], Any] = {}
                for key, pairs in zip(item, written, strict=True):
                    for exponents, rest in pairs:
                        grown[(*key, exponents)] = self.ring.context.from_dict(rest)
                fresh.append(grown)
            terms = fresh
        others = [x for item in terms for x in item.values() if not x.is_constant()]
        self.table = Unknowns(self.ring, others)
        entries = [f"r{k}_{i}{j}" for k, cosines in enumerate(self.cosines) for i, j in cosines.choice.entries]
        self.context = context([*entries, *(f"y{k}" for k in range(len(self.table.indices)))])
        self.equations = [self._integral(item) for item in terms] + self._relations(len(entries))
        return True

    def _integral(self, item: Mapping[tuple[tuple[int, ...], ...], Polynomial]) -> Any:
        """One equation times the least positive integer that leaves no fractions."""
        terms = {
            (*(e for part in key for e in part), *(int(m[k]) for k in self.table.indices)): fmpq(c)
            for key, x in item.items()
            for m, c in x.terms()
        }
        common = fmpz(1)
        for c in terms.values():
            common = common.lcm(c.q)
        return self.context.from_dict({m: (c * common).p for m, c in terms.items()})

    def _relations(self, entries: int) -> list[Any]:
        """Unit vectors, at right angles; and the relations of the other unknowns."""
        gens = iter(self.context.gens())
        relations = []
        for cosine in self.cosines:
            vectors = [[next(gens) for _ in vector] for vector in cosine.choice.vectors]
            relations += [sum(x * x for x in v) - 1 for v in vectors]
            if len(vectors) == 2:
                relations.append(sum(x * y for x, y in zip(*vectors, strict=True)))
        for x in self.table.relations():
            relations.append(self.context.from_dict({((0,) * entries + tuple(m)): c for m, c in x.terms()}))
        return relations

    # --- solutions ---------------------------------------------------------------------------------------------------

    def solved(self, names: Sequence[str], nonzero: Sequence[Polynomial], limits: Limits) -> Orientations | None:
        entries = sum(len(cosine.choice.entries) for cosine in self.cosines)
        bounded = [*range(entries), *(entries + k for k in self.table.bounded())]
        used = {k for x in self.equations for k, degree in enumerate(x.degrees()) if degree > 0}
        if used != set(range(self.context.nvars())):
            return None
        result = solve(
            self.equations,
            (),
            bounded,
            replace(limits, bits=BITS * limits.bits, work=limits.work // PART, reduction=REDUCTION),
        )
        if result.unfinished or result.families:
            return None
        places: list[Place] = []
        for point in result.points:
            rest = AlgebraicPoint(point.modulus, point.index, point.values[entries:])
            if not self.table.roots_agree(rest):
                continue
            described = self._described(point, names)
            if described is None:
                return None
            for place in described:
                values = [place.ball(x) for x in nonzero]
                if any(x == 0 for x in values):
                    continue
                if any(x.contains(0) for x in values):
                    return None
                places.append(place)
        return Orientations(tuple(places), tuple(cosine.joint.body for cosine in self.cosines))

    def _described(self, point: AlgebraicPoint, names: Sequence[str]) -> list[Place] | None:
        """The place in each of its sets of angles; [] where the angles are singular, None where that is not known."""
        ring, rest = self.ring, self.chart.rest
        start = 0
        sets: list[list[_Angles]] = []
        for cosine in self.cosines:
            count = len(cosine.choice.entries)
            angles = _angles(cosine, point, point.values[start : start + count], names)
            if not angles:
                return None if angles is None else []
            sets.append(angles)
            start += count
        others = dict(zip(self.table.indices, point.values[start:], strict=True))
        places = []
        for chosen in product(*sets):
            exact: dict[int, Any] = dict(others)
            balls: dict[str, Any] = {}
            for item in chosen:
                exact |= item.exact
                balls |= item.balls
            free = [name for name in rest.constant if name not in balls and name not in names]
            exact |= at_zero(ring, free)  # any value does; 0 is one
            try:
                left = [name for name in rest.constant if name not in balls and name in names]
                balls |= {name: ball_at(ring, name, exact, point) for name in left}
            except KeyError:
                return None
            places.append(Place(rest, balls, exact | exact_rates(rest), point.modulus, point.enclosure))
        return places


@dataclass(frozen=True)
class _Angles:
    """One set of angles of a joint: balls by name, and sines and cosines that lie in the field, by their generators."""

    balls: Mapping[str, Any]
    exact: Mapping[int, Any]


def _angles(
    cosines: Cosines, point: AlgebraicPoint, values: Sequence[Any], names: Sequence[str]
) -> list[_Angles] | None:
    """The sets of angles at a solution: two, none ([]) where they are singular; None where that cannot be told."""
    ring, joint, choice = cosines.ring, cosines.joint, cosines.choice
    known = dict(zip(choice.entries, values, strict=True))
    if len(choice.vectors) == 2:
        (u, v), p = (([known[x] for x in vector]) for vector in choice.vectors), point.modulus
        for k, entry in enumerate(choice.third()):
            a, b = (k + 1) % 3, (k + 2) % 3
            known[entry] = (u[a] * v[b] - u[b] * v[a]) * choice.sign() % p
    seen = list(_simple(cosines, known))
    middle = joint.angles[1]
    kinds = {ring.index(kind, middle): kind for kind in ("sine", "cosine")}
    first = next(((key, value) for key, value in seen if len(key) == 1 and key[0] in kinds), None)
    if first is None:
        return None
    (index,), inner = first
    other = next(k for k in kinds if k != index)
    square = (1 - inner * inner) % point.modulus
    if square == 0:
        return []
    with ctx.workprec(PRECISION):
        length = point.enclosure(square, PRECISION)
        if not length > 0:
            return None
        length = length.sqrt()
    root = None if square.degree() > 0 else rationals.square_root(square[0])
    sets = []
    for sign in (1, -1):
        exact = {index: inner}
        with ctx.workprec(PRECISION):
            balls = {index: point.enclosure(inner, PRECISION), other: length * sign}
        if root is not None:
            exact[other] = fmpq_poly([root * sign])
        for key, value in seen:
            outer = [k for k in key if k != other]
            if len(key) == 2 and len(outer) == 1 and outer[0] not in kinds:
                with ctx.workprec(PRECISION):
                    balls[outer[0]] = point.enclosure(value, PRECISION) / balls[other]
                if root is not None:
                    exact[outer[0]] = value * (1 / (root * sign))
        angles = {}
        for name in (x for x in joint.angles if x in names):
            s, c = (balls.get(ring.index(kind, name)) for kind in ("sine", "cosine"))
            if s is None or c is None:
                return None
            angles[name] = angle_of(s, c, ring.angles[name])
        inside = {ring.index(kind, name) for name in angles for kind in ("sine", "cosine")}
        sets.append(_Angles(angles, {k: value for k, value in exact.items() if k in inside}))
    return sets


def _simple(cosines: Cosines, known: Mapping[tuple[int, int], Any]) -> Iterator[tuple[tuple[int, ...], Any]]:
    """(generators, value of their product) for each entry that is +- a product of different sines and cosines."""
    for (k, j), value in known.items():
        terms = list(cosines.matrix[k][j].terms())
        if len(terms) == 1:
            ((monomial, coefficient),) = terms
            if coefficient in (1, -1) and all(e in (0, 1) for e in monomial):
                yield tuple(i for i, e in enumerate(monomial) if e), value * coefficient
