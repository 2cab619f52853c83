"""Zeros of a factor in several angles and coordinates: balls over boxes, changes of sign, critical points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import lcm
from typing import Any

from flint import Ordering, arb, ctx, fmpq, fmpq_mat, fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import Limit, NoClosedForm
from mbsym.algebra.matrices import reduced_rows
from mbsym.algebra.polynomial_systems import Limits, context, real_roots, solve
from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.algebra.terms import univariate


class Several:
    """A factor in several variables: boxes, signs, critical points."""

    def __init__(
        self,
        half: HalfAngles,
        factor: Polynomial,
        plain: Polynomial,
        names: tuple[str, ...],
        ranges: Mapping[str, Fraction],
    ) -> None:
        self.half, self.factor, self.plain, self.names = half, factor, plain, names
        self.terms = [([int(x) for x in m], arb(c)) for m, c in factor.terms()]
        # Half angles from -1/2 to 1/2 turns cover the projective line; coordinates from -range to range.
        self.box = [
            (Fraction(0), Fraction(1, 2)) if name in half.angles else (Fraction(0), ranges.get(name, Fraction(10)))
            for name in names
        ]

    def value(self, point: Sequence[tuple[Fraction, Fraction]]) -> Any:
        """A ball over the box of midpoints and radii."""
        letters: dict[int, Any] = {}
        for name, (middle, radius) in zip(self.names, point, strict=True):
            ball = rationals.ball(middle)
            if radius:
                ball = ball + arb(0, rationals.ball(radius).upper())
            if name in self.half.angles:
                sine, cosine = (ball * arb.pi()).sin_cos()
                letters[self.half.place[name]], letters[self.half.place[name] + 1] = sine, cosine
            else:
                letters[self.half.place[name]] = ball
        total = arb(0)
        for monomial, coefficient in self.terms:
            term = coefficient
            for place, x in letters.items():
                if monomial[place]:
                    term *= x ** monomial[place]
            total += term
        return total

    def found(self) -> ZeroSet | None:
        with ctx.workprec(BITS):
            pending: list[Any] = [tuple(self.box)]
            signs: dict[bool, Any] = {}
            for _ in range(MOST_BOXES):
                if not pending:
                    return None
                box = pending.pop(0)
                if not self.value(box).contains(0):
                    continue
                middle = tuple((m, Fraction(0)) for m, _ in box)
                there = self.value(middle)
                if not there.contains(0):
                    signs.setdefault(bool(there > 0), middle)
                if len(signs) == 2:
                    return ZeroSet(self.plain, self.names, SIGNS, (), (self._between(signs[True], signs[False]),))
                pending += self._halves(box)
        return self._critical()

    def _halves(self, box: Sequence[tuple[Fraction, Fraction]]) -> list[Any]:
        """The box cut across its longest side."""
        widths = [radius / whole for (_, radius), (_, whole) in zip(box, self.box, strict=True)]
        k = widths.index(max(widths))
        middle, radius = box[k][0], box[k][1] / 2
        return [(*box[:k], (middle + sign * radius, radius), *box[k + 1 :]) for sign in (-1, 1)]

    def _between(self, above: Any, below: Any) -> dict[str, Any]:
        """A zero on the segment between points of opposite sign, by bisection: within 2^-200 of it."""
        with ctx.workprec(PRECISION):
            for _ in range(220):
                middle = tuple(((a + b) / 2, Fraction(0)) for (a, _), (b, _) in zip(above, below, strict=True))
                there = self.value(middle)
                if there.contains(0):
                    break
                if there > 0:
                    above = middle
                else:
                    below = middle
            return self._values([(a + b) / 2 for (a, _), (b, _) in zip(above, below, strict=True)])

    def _values(self, point: Sequence[Fraction]) -> dict[str, Any]:
        values = {}
        for name, x in zip(self.names, point, strict=True):
            ball = rationals.ball(x)
            values[name] = 2 * arb.pi() * self.half.angles[name] * ball if name in self.half.angles else ball
        return values

    def _critical(self) -> ZeroSet | None:
        """Where a factor that changes no sign touches 0: its gradient vanishes there, too.

        Chart by chart: each angle by S = t, C = 1, or S = 1, C = t.
        """
        points: list[Mapping[str, Any]] = []
        isolated = True
        angles = [name for name in self.names if name in self.half.angles]
        for chart in product((0, 1), repeat=len(angles)):
            where = context([f"x{k}" for k in range(len(self.names))])
            flat = self._flat(where, dict(zip(angles, chart, strict=True)))
            equations = [flat, *(flat.derivative(k) for k in range(len(self.names)))]
            try:
                solved = solve([e for e in equations if not e.is_zero()], limits=CRITICAL)
            except (NoClosedForm, ArithmeticError, ValueError):
                return ZeroSet(self.plain, self.names, UNDECIDED)
            if solved.unfinished:
                return ZeroSet(self.plain, self.names, UNDECIDED)
            isolated = isolated and not solved.families
            for point in (*solved.points, *(family.sample for family in solved.families)):
                points.append(self._placed(point.enclosures(PRECISION), dict(zip(angles, chart, strict=True))))
        distinct = _distinct(points)
        return ZeroSet(self.plain, self.names, EXACT, (), tuple(distinct), isolated) if distinct else None

    def _flat(self, where: Any, chart: Mapping[str, int]) -> Polynomial:
        bottom = lcm(*(int(coefficient.q) for coefficient in self.factor.coeffs()))
        terms: dict[tuple[int, ...], int] = {}
        for monomial, coefficient in self.factor.terms():
            powers = tuple(int(monomial[self.half.place[name] + chart.get(name, 0)]) for name in self.names)
            whole = coefficient * bottom
            terms[powers] = terms.get(powers, 0) + int(whole.p)
        return where.from_dict(terms)

    def _placed(self, balls: Sequence[Any], chart: Mapping[str, int]) -> dict[str, Any]:
        coordinates = {}
        with ctx.workprec(PRECISION):
            for name, ball in zip(self.names, balls, strict=True):
                if name in chart:
                    half = ball.atan() if chart[name] == 0 else arb.pi() / 2 - ball.atan()
                    if half.mid() > (arb.pi() / 2).mid():
                        half = half - arb.pi()
                    ball = 2 * self.half.angles[name] * half
                coordinates[name] = ball
        return coordinates


def _distinct(points: Sequence[Mapping[str, Any]]) -> list[Mapping[str, Any]]:
    """Points that are told apart by their balls; one that two charts show is taken once."""
    distinct: list[Mapping[str, Any]] = []
    for point in points:
        if not any(all(point[name].overlaps(other[name]) for name in point) for other in distinct):
            distinct.append(point)
    return distinct


# What is known of the zeros of a polynomial: sets, values, and how each is known.


#: How a set is known: its zeros isolated exactly, or in number fields; a change of sign proved by balls; a search.
EXACT, SIGNS, UNDECIDED = "exact", "signs", "undecided"

#: Boxes that are looked at for one factor, and bits at which that is done.
MOST_BOXES, BITS = 6_000, 96

#: Zeros are known to so many bits.
PRECISION = 320

#: A factor in half angles is not formed beyond so many terms.
MOST_TERMS = 3_000

#: Critical points are sought with so much work.
CRITICAL = Limits(branches=60, elements=40, terms=200, solutions=40, work=400_000)


@dataclass(frozen=True)
class Zero:
    """A value of a variable: ``turns`` * pi where it is that exactly, else None; ``ball`` encloses it."""

    ball: Any
    turns: Fraction | None = None
    rational: Fraction | None = None


@dataclass(frozen=True)
class ZeroSet:
    """Where one irreducible ``factor`` vanishes.

    ``names`` are what it depends on.  With one name ``zeros`` lists all its values, an angle's in one period.  With
    several names ``point`` is a point of the set (exact, or proved to lie near a zero by signs), None where the search
    was undecided; ``nearest`` is then the point where the factor was smallest.  ``isolated``: the point is one of
    finitely many ``points``.
    """

    factor: Polynomial
    names: tuple[str, ...]
    known: str
    zeros: tuple[Zero, ...] = ()
    points: tuple[Mapping[str, Any], ...] = ()
    isolated: bool = False


@dataclass(frozen=True)
class Zeros:
    """All ``sets``; ``nowhere`` are the factors proved to have no zero; coordinates beyond ``range`` of several-name
    factors were not looked at (None: nothing depends on that)."""

    sets: tuple[ZeroSet, ...]
    nowhere: tuple[Polynomial, ...]
    bounded: tuple[str, ...]

    @property
    def complete(self) -> bool:
        """Whether it is proved that there are no others (coordinates within their ranges)."""
        return all(zero_set.known != UNDECIDED for zero_set in self.sets)


# Where a polynomial in angles and coordinates vanishes on the reals: set by set, each with how that is known.
#
# With  sin x = 2 S C,  cos x = C^2 - S^2,  1 = S^2 + C^2,   S = sin(x/2),  C = cos(x/2)   for every angle x, a
# polynomial becomes one that is homogeneous in each pair (S, C), which factors uniquely, unlike polynomials in sin x
# and cos x. An irreducible factor in one angle has the zeros of a rational polynomial in tan(x/2), C = 0 being x = pi;
# one in one coordinate those of a rational polynomial: both are isolated exactly.  A factor in several of them is
# enclosed by balls over boxes that cover all angles, and coordinates up to a given range.  It has no zero there if no
# enclosure contains 0, and has one if balls prove opposite signs at two points; else its gradient is solved for,
# exactly, as far as that goes.


def zero_sets(ring: Ring, polynomials: Sequence[Polynomial], ranges: Mapping[str, Fraction]) -> Zeros:
    """The real zeros of a product of polynomials; ``ranges`` bounds |x| of the coordinates.

    Raises NoClosedForm for adjoined generators (roots, functions), and where factors grow too long.
    """
    sets: list[ZeroSet] = []
    nowhere: list[Polynomial] = []
    bounded: set[str] = set()
    seen = set()
    for polynomial in polynomials:
        for plain, _ in irreducible_factors(polynomial)[1] if not polynomial.is_constant() else ():
            straightened, at_zero = _straightened(ring, plain)
            if at_zero:
                turned = zero_sets(ring, [straightened], ranges)
                nowhere += [plain] if not turned.sets else []
                sets += [_turned_back(ring, plain, turned_set, at_zero) for turned_set in turned.sets]
                bounded.update(turned.bounded)
                continue
            half = HalfAngles(ring, plain)
            for factor in half.factors():
                key = (half.names, str(factor))
                if key in seen:
                    continue
                seen.add(key)
                zero_set = half.zeros(factor, plain, ranges)
                several = [name for name in half.names_of(factor) if name not in half.angles]
                if len(half.names_of(factor)) > 1:
                    bounded.update(several)
                if zero_set is None:
                    nowhere.append(plain)
                else:
                    sets.append(zero_set)
    return Zeros(tuple(sets), tuple(nowhere), tuple(sorted(bounded)))


def _straightened(ring: Ring, x: Polynomial) -> tuple[Polynomial, tuple[str, ...]]:
    """x with those angles at 0 that a symmetry brings there, and their names.

    If sum_a c_a dx/da = 0 with c_b != 0, x is the same along that direction, which meets b = 0 from everywhere.
    """
    straight: list[str] = []
    while True:
        used = {ring.generators[k].name for k in occurring([x]) if ring.generators[k].kind in ("sine", "cosine")}
        angles = [name for name in ring.angles if name in used]
        slopes = [ring.reduce(_slope(ring, x, name)) for name in angles]
        monomials = sorted({m for slope in slopes for m in slope.to_dict()})
        if len(angles) < 2 or not monomials or len(monomials) > MOST_TERMS:
            return x, tuple(straight)
        columns = [slope.to_dict() for slope in slopes]
        rows = fmpq_mat(len(monomials), len(angles), [c.get(m, fmpq(0)) for m in monomials for c in columns])
        pivots = reduced_rows(rows)
        if len(pivots) == len(angles):
            return x, tuple(straight)
        name = next(name for j, name in enumerate(angles) if j not in pivots)
        s, c = ring.index("sine", name), ring.index("cosine", name)
        x = ring.substitute(x, {s: ring.zero, c: ring.one})
        straight.append(name)


def _slope(ring: Ring, x: Polynomial, name: str) -> Polynomial:
    """dx/da times a's denominator."""
    s, c = ring.index("sine", name), ring.index("cosine", name)
    gens = ring.context.gens()
    return (x.derivative(s) * gens[c] - x.derivative(c) * gens[s]) / ring.angles[name]


def _turned_back(ring: Ring, plain: Polynomial, zero_set: ZeroSet, at_zero: Sequence[str]) -> ZeroSet:
    """A set of a straightened polynomial as one of the polynomial itself: it is nowhere isolated."""
    points = zero_set.points or tuple({zero_set.names[0]: zero.ball} for zero in zero_set.zeros)
    used = {ring.generators[k].name for k in occurring([plain])}
    rest = [name for name in at_zero if name in used]
    placed = tuple({**point, **{name: arb(0) for name in rest}} for point in points)
    return ZeroSet(plain, (*zero_set.names, *rest), zero_set.known, (), placed)


class HalfAngles:
    """A polynomial as one in (S, C) for each angle and in the coordinates."""

    def __init__(self, ring: Ring, polynomial: Polynomial) -> None:
        self.ring = ring
        used = [ring.generators[k] for k in occurring([polynomial])]
        for g in used:
            if g.kind not in ("sine", "cosine", "coordinate", "prescribed", "time") or g.argument is not None:
                raise NoClosedForm("a [[kind]] in a determinant", kind=g.kind, limit=Limit.TERMS)
        self.angles = {g.name: g.denominator for g in used if g.kind in ("sine", "cosine")}
        plain = [g.name for g in used if g.kind not in ("sine", "cosine")]
        self.names = (*self.angles, *(name for name in plain if name not in self.angles))
        if set(plain) & set(self.angles):
            raise NoClosedForm("a determinant in an angle and its sine", limit=Limit.TERMS)
        letters = [x for name in self.angles for x in (f"S{name}", f"C{name}")] + list(self.names[len(self.angles) :])
        self.context = fmpq_mpoly_ctx.get(letters, Ordering.lex)
        self.place = {name: 2 * i for i, name in enumerate(self.angles)}
        self.place |= {name: len(self.angles) + i for i, name in enumerate(self.names) if name not in self.angles}
        self.homogeneous = self._half(polynomial, used)

    def _half(self, polynomial: Polynomial, used: Sequence[Generator]) -> Polynomial:
        ring, gens = self.ring, self.context.gens()
        index = {(g.kind, g.name): ring.index(g.kind, g.name) for g in used}
        degrees = dict.fromkeys(self.angles, 0)
        pairs = {name: (index.get(("sine", name)), index.get(("cosine", name))) for name in self.angles}
        plain = [(index[g.kind, g.name], self.place[g.name]) for g in used if g.kind not in ("sine", "cosine")]
        terms = [(monomial, coefficient) for monomial, coefficient in polynomial.terms()]
        powers = [{n: tuple(int(m[k]) if k is not None else 0 for k in p) for n, p in pairs.items()} for m, _ in terms]
        for name in self.angles:
            degrees[name] = max(sum(power[name]) for power in powers)
        known: dict[tuple[str, int, int], Polynomial] = {}
        total = self.context.constant(0)
        for (monomial, coefficient), power in zip(terms, powers, strict=True):
            term = self.context.constant(coefficient)
            for k, place in plain:
                if monomial[k]:
                    term *= gens[place] ** int(monomial[k])
            for name, (i, j) in power.items():
                if (name, i, j) not in known:
                    s, c = gens[self.place[name]], gens[self.place[name] + 1]
                    known[name, i, j] = (2 * s * c) ** i * (c**2 - s**2) ** j * (s**2 + c**2) ** (degrees[name] - i - j)
                term *= known[name, i, j]
            total += term
            if len(total) > MOST_TERMS:
                raise NoClosedForm("a determinant too long in half angles", limit=Limit.TERMS)
        return total

    def factors(self) -> Iterator[Polynomial]:
        """The irreducible ones that may vanish."""
        circles = [self._circle(name) for name in self.angles]
        for factor, _ in irreducible_factors(self.homogeneous)[1]:
            if not any((factor / factor.leading_coefficient()) == circle for circle in circles):
                yield factor

    def _circle(self, name: str) -> Polynomial:
        s, c = (self.context.gens()[self.place[name] + i] for i in (0, 1))
        circle = s**2 + c**2
        return circle / circle.leading_coefficient()

    def names_of(self, factor: Polynomial) -> tuple[str, ...]:
        degrees = factor.degrees()
        return tuple(
            name
            for name in self.names
            if degrees[self.place[name]] > 0 or (name in self.angles and degrees[self.place[name] + 1] > 0)
        )

    def zeros(self, factor: Polynomial, plain: Polynomial, ranges: Mapping[str, Fraction]) -> ZeroSet | None:
        """None where it is proved that there are none."""
        names = self.names_of(factor)
        if len(names) == 1:
            roots = self._in_angle(factor, names[0]) if names[0] in self.angles else self._in_coordinate(factor, names)
            return ZeroSet(plain, names, EXACT, tuple(roots)) if roots else None
        return Several(self, factor, plain, names, ranges).found()

    # --- one variable ------------------------------------------------------------------------------------------------

    def _in_angle(self, factor: Polynomial, name: str) -> list[Zero]:
        """Homogeneous in (S, C): the zeros t = S/C of a polynomial, and x = pi where C divides it."""
        place, denominator = self.place[name], self.angles[name]
        if list(factor.degrees())[place] == 0:  # C alone
            return [_angle(Fraction(1), denominator)]
        p = univariate(factor, place)
        turns = _known_turns(p)
        if turns is not None:
            return [_angle(turn, denominator) for turn in turns]
        with ctx.workprec(PRECISION):
            return [Zero(2 * denominator * root.atan()) for root in real_roots(p, PRECISION)]

    def _in_coordinate(self, factor: Polynomial, names: tuple[str, ...]) -> list[Zero]:
        p = univariate(factor, self.place[names[0]])
        if p.degree() == 1:
            value = -p[0] / p[1]
            exact = rationals.fraction(value)
            with ctx.workprec(PRECISION):
                return [Zero(arb(value), None, exact)]
        return [Zero(root) for root in real_roots(p, PRECISION)]


#: tan(x/2) of the multiples of pi/12 that are no multiples of pi/2, by their minimal polynomials (low powers first).
_TURNS: dict[tuple[int, ...], tuple[Fraction, ...]] = {
    (0, 1): (Fraction(0),),
    (-1, 1): (Fraction(1, 2),),
    (1, 1): (Fraction(-1, 2),),
    (-1, 0, 3): (Fraction(-1, 3), Fraction(1, 3)),
    (-3, 0, 1): (Fraction(-2, 3), Fraction(2, 3)),
    (-1, 2, 1): (Fraction(-3, 4), Fraction(1, 4)),
    (-1, -2, 1): (Fraction(-1, 4), Fraction(3, 4)),
    (1, -4, 1): (Fraction(1, 6), Fraction(5, 6)),
    (1, 4, 1): (Fraction(-5, 6), Fraction(-1, 6)),
}


def _known_turns(p: Any) -> tuple[Fraction, ...] | None:
    whole = p.numer()
    cs = [int(c) for c in whole.coeffs()]
    cs = [-c for c in cs] if cs[-1] < 0 else cs
    return _TURNS.get(tuple(cs))


def _angle(turns: Fraction, denominator: int) -> Zero:
    whole = turns * denominator
    with ctx.workprec(PRECISION):
        return Zero(arb.pi() * rationals.ball(whole), whole)
