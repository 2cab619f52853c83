"""All real solutions of a polynomial system with rational coefficients, exactly.

A system is taken apart before it is attacked: every polynomial that arises is factored, and each factor starts a branch
of its own in which the factors of earlier branches are known not to vanish, so branches never share a solution.  What
does not split any more becomes a Groebner basis (Buchberger's algorithm with the product and the chain criterion).

* A branch of finitely many solutions is radical once the minimal polynomial of every variable is irreducible
  (Seidenberg's lemma 92).  A linear form t then separates its solutions, and every variable is a polynomial in t modulo
  the irreducible p(t): a solution is a real root of p, and whether a polynomial vanishes there is decided in the
  number field QQ[t]/p, without rounding.
* A branch of infinitely many solutions is a family.  With U a largest set of independent variables and h the product
  of leading coefficients in QQ[U], the part h != 0 has one dimension everywhere, and h = 0 is looked at as branches of
  its own (Gianni, Trager and Zacharias).  That a family is real is proved by one regular real point on it.

Every step is bounded by counts, never by a clock.  What could not be finished is listed in ``Solutions.unfinished``;
an empty list means that nothing is missing.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import combinations, product
from typing import Any

from flint import Ordering, arb, arb_poly, ctx, fmpq, fmpq_mat, fmpq_poly, fmpz, fmpz_mpoly_ctx, fmpz_mpoly_vec

from mbsym.algebra.base import Algebra
from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.failures import NoClosedForm, message_of
from mbsym.algebra.matrices import echelon
from mbsym.algebra.terms import residue, univariate
from mbsym.expressions.message import Message

Polynomial = Any  # a flint.fmpz_mpoly
Univariate = Any  # a flint.fmpq_poly
Monomial = tuple[int, ...]
_vector: Any = fmpz_mpoly_vec  # its type hints lack some arguments


@dataclass(frozen=True)
class Limits:
    """Counts that bound the work: branches, basis elements, terms and bits of one polynomial, S-polynomials in all, the
    number of solutions of one branch, and terms touched in all."""

    branches: int = 4_000
    elements: int = 70
    terms: int = 500
    bits: int = 6_000
    pairs: int = 3_000
    solutions: int = 96
    work: int = 10_000_000
    reduction: int = 0  # elements x terms x bits before one interreduction; 0: any


@dataclass(frozen=True)
class AlgebraicPoint:
    """A real point with algebraic coordinates: ``values[i](t)`` at the root number ``index`` of ``modulus``.

    ``modulus`` is irreducible over QQ; its real roots are counted from the smallest.
    """

    modulus: Univariate
    index: int
    values: tuple[Univariate, ...]

    @property
    def rational(self) -> bool:
        return bool(self.modulus.degree() == 1)

    def residue(self, x: Polynomial) -> Univariate:
        """The value of a polynomial, as an element of QQ[t]/modulus; it is zero if and only if the value is."""
        return residue(x, self.values, self.modulus)

    def root(self, bits: int) -> Any:
        """A ball around t, of relative size about 2^-bits."""
        return _known_roots(tuple(self.modulus.numer().coeffs()), bits)[self.index]

    def enclosures(self, bits: int = 200) -> tuple[Any, ...]:
        """Balls around the coordinates."""
        return tuple(self.enclosure(value, bits) for value in self.values)

    def enclosure(self, element: Univariate, bits: int = 200) -> Any:
        """A ball around an element of the number field, at this root: about ``bits`` bits where cancelling allows."""
        if element.degree() <= 0:
            return _ball(element[0], bits)
        for working in (bits << k for k in range(6)):
            with ctx.workprec(working):
                ball = arb_poly(element.coeffs())(self.root(working))
            if ball.rad() * arb(2) ** (bits - 20) < abs(ball).mid():
                break
        return ball


@dataclass(frozen=True)
class Family:
    """Infinitely many real solutions: a component of ``dimension`` near the regular real point ``sample``.

    ``equations`` vanish on it (and on its closure); ``free`` are variables that may be chosen near the sample, which is
    ``special`` where it is none that was met by chance.
    """

    equations: tuple[Polynomial, ...]
    dimension: int
    free: tuple[int, ...]
    sample: AlgebraicPoint
    special: bool = False

    def contains(self, point: AlgebraicPoint) -> bool:
        return all(point.residue(x) == 0 for x in self.equations)

    def holds(self, other: Family) -> bool:
        """Whether a family of lower dimension is proved to lie in it: its equations reduce to 0 by the other's."""
        if other.dimension >= self.dimension or not self.contains(other.sample):
            return False
        for x in self.equations:
            rest = None
            while x and x != rest:
                rest = x
                for y in other.equations:
                    x = divmod(x, y)[1]
            if x:
                return False
        return True


@dataclass(frozen=True)
class Solutions:
    """``points`` are isolated; ``unfinished`` says what was left out, and why (empty: the list is complete)."""

    points: tuple[AlgebraicPoint, ...]
    families: tuple[Family, ...]
    unfinished: tuple[str, ...]


class _TooLarge(Exception):
    """A branch went beyond a limit; the message says which."""


def context(names: Sequence[str], lexicographic: bool = False) -> Any:
    """Integer polynomials in these variables."""
    return fmpz_mpoly_ctx.get(list(names), Ordering.lex if lexicographic else Ordering.degrevlex)


def real_roots(p: Univariate, bits: int = 64) -> list[Any]:
    """Isolating balls of the real roots, ascending."""
    if p.degree() == 1:
        return [_ball(-p[0] / p[1], bits)]
    with ctx.workprec(bits):
        # Arb encloses real roots in balls whose imaginary part is exactly 0, and the others in balls off the axis.
        real = (root.real for root, _ in p.numer().complex_roots() if root.imag == 0)
        return sorted(real, key=lambda root: root.mid())


@lru_cache(maxsize=64)
def _known_roots(coefficients: tuple[Any, ...], bits: int) -> list[Any]:
    """``real_roots``, once for all the points of a field that are asked for together."""
    return real_roots(fmpq_poly(list(coefficients)), bits)


def solve(
    equations: Iterable[Polynomial],
    nonzero: Iterable[Polynomial] = (),
    bounded: Iterable[int] = (),
    limits: Limits | None = None,
) -> Solutions:
    """All real solutions of ``equations`` = 0 at which no polynomial of ``nonzero`` vanishes.

    ``bounded``: variables known to lie in [-1, 1] (sines and cosines), which ends branches early.  All polynomials
    belong to one ``context``; every variable of it should occur.
    """
    return _Solver(list(equations), list(nonzero), frozenset(bounded), limits or Limits()).run()


@dataclass
class _Branch:
    equations: list[Polynomial]
    nonzero: list[Polynomial]
    special: bool = False  # split at the zeros of the bounded variables already
    families: list[Family] = field(default_factory=list)  # those whose closure this branch may touch


class _Solver:
    def __init__(
        self, equations: list[Polynomial], nonzero: list[Polynomial], bounded: frozenset[int], limits: Limits
    ) -> None:
        self.context = equations[0].context()
        self.nvars = self.context.nvars()
        self.bounded, self.limits = bounded, limits
        self.pending = [_Branch(equations, [f for x in nonzero for f in _irreducible(x)])]
        self.points: list[AlgebraicPoint] = []
        self.families: list[Family] = []
        self.unseen: list[tuple[list[Polynomial], tuple[int, ...]]] = []
        self.unfinished: list[str] = []
        self.work, self.pairs, self.branches = 0, 0, 0

    def run(self) -> Solutions:
        while self.pending:
            self.branches += 1
            branch = self.pending.pop()
            if self.branches > self.limits.branches:
                self.unfinished.append(Message("more than [[branches]] cases", branches=self.limits.branches))
                break
            try:
                self._treat(branch)
            except _TooLarge as reason:
                if branch.special or not self._specialised(branch):
                    self.unfinished.append(message_of(reason))
        for closure, free in self.unseen:
            self._seen_at_points(closure, free)
        # Branches do not share solutions, but a point may still be the limit of a family of another branch.
        isolated = [p for p in self.points if not any(family.contains(p) for family in self.families)]
        families = [x for x in self.families if not any(other.holds(x) for other in self.families if other is not x)]
        return Solutions(tuple(isolated), tuple(families), tuple(dict.fromkeys(self.unfinished)))

    def _specialised(self, branch: _Branch) -> bool:
        """Where a branch is too large: what lies at the zeros of sines and cosines apart, and then the rest again."""
        known = {_key(x) for x in branch.nonzero}
        gens = self.context.gens()
        zeros = [gens[k] for k in sorted(self.bounded) if _key(gens[k]) not in known]
        if not zeros:
            return False
        rest = _Branch(branch.equations, [*branch.nonzero, *zeros], families=branch.families, special=True)
        self.pending.append(rest)
        before = len(self.pending)
        self._split(branch.equations, zeros, branch)
        for part in self.pending[before:]:
            part.special = True
        return True

    def spend(self, work: int) -> None:
        self.work += work
        if self.work > self.limits.work:
            raise _TooLarge(Message("more than [[work]] steps of polynomial arithmetic", work=self.limits.work))

    def _treat(self, branch: _Branch) -> None:
        basis = self._basis(branch)
        if basis is None:
            return
        standard = _standard_monomials(basis, self.nvars, self.limits.solutions)
        if standard is None:
            self._family(basis, branch)
        else:
            self._finite(basis, standard, branch)

    # --- splitting ---------------------------------------------------------------------------------------------------

    def _split(self, rest: list[Polynomial], factors: list[Polynomial], branch: _Branch) -> None:
        """One branch for each factor, in which the factors before it do not vanish."""
        done: list[Polynomial] = []
        fresh = []
        for factor in factors:
            fresh.append(
                _Branch([*rest, factor], [*branch.nonzero, *done], special=branch.special, families=branch.families)
            )
            done.append(factor)
        self.pending += reversed(fresh)

    def _essential(self, x: Polynomial, nonzero: Sequence[Polynomial]) -> list[Polynomial]:
        """The irreducible factors of x that can vanish at a real solution; short ones first."""
        if len(x) > self.limits.terms:
            raise _TooLarge(Message("a polynomial of more than [[terms]] terms", terms=self.limits.terms))
        self.spend(20 * len(x))
        known = {_key(y) for y in nonzero}
        polynomials = [y for y in _irreducible(x) if _key(y) not in known and self._can_vanish(y)]
        return sorted(polynomials, key=lambda y: (y.total_degree(), len(y), str(y)))

    def _can_vanish(self, x: Polynomial) -> bool:
        """False only where x certainly has no real zero (in the range of bounded variables)."""
        degrees = x.degrees()
        used = [k for k in range(self.nvars) if degrees[k] > 0]
        if len(used) == 1:
            roots = real_roots(univariate(x, used[0]))
            if used[0] in self.bounded:
                roots = [r for r in roots if not abs(r) > 1]
            return bool(roots)
        signs = {coefficient > 0 for coefficient in x.coeffs()}
        even = all(exponent % 2 == 0 for monomial in x.monoms() for exponent in monomial)
        if len(signs) == 1 and even and sum(x.monoms()[-1]) == 0:
            return False  # a constant and squares of one sign
        if all(k in self.bounded for k in used):  # |sum of the others| < |constant|
            constant = sum((abs(c) for m, c in x.terms() if sum(m) == 0), fmpz(0))
            return not constant > sum((abs(c) for m, c in x.terms() if sum(m) > 0), fmpz(0))
        return True

    def _simplified(self, branch: _Branch) -> list[Polynomial] | None:
        """Interreduced irreducible equations; None where the branch is empty or was split."""
        current = [x for x in branch.equations if not x.is_zero()]
        while True:
            self._check_reduction(current)
            current = [x for x in _vector(current, self.context).autoreduction() if not x.is_zero()]
            self.spend(sum(map(len, current)) * (1 + len(current)))
            smaller, splitting = [], []
            for position, x in enumerate(current):
                factors = [] if x.is_constant() else self._essential(x, branch.nonzero)
                if not factors:
                    return None
                if len(factors) > 1:
                    splitting.append((max(f.total_degree() for f in factors), len(factors), position, factors))
                smaller.append(factors[0])
            for position, x in enumerate(smaller if not splitting else []):
                terms = _sum_of_squares(x)
                if terms:  # over the reals every term vanishes
                    rest = [y for k, y in enumerate(current) if k != position]
                    self.pending.append(
                        _Branch([*rest, *terms], branch.nonzero, special=branch.special, families=branch.families)
                    )
                    return None
            if splitting:
                _, _, position, factors = min(splitting, key=lambda item: item[:3])
                self._split([x for k, x in enumerate(current) if k != position], factors, branch)
                return None
            if all(_key(a) == _key(b) for a, b in zip(smaller, current, strict=True)):
                return smaller
            current = smaller

    def _check_reduction(self, current: list[Polynomial]) -> None:
        """One interreduction is one call that nothing stops: its size is looked at before."""
        if self.limits.reduction and current:
            bits = max(int(c).bit_length() for x in current for c in x.coeffs())
            if len(current) * sum(map(len, current)) * bits > self.limits.reduction:
                raise _TooLarge(Message("an interreduction of large polynomials"))

    # --- Buchberger --------------------------------------------------------------------------------------------------

    def _basis(self, branch: _Branch) -> list[Polynomial] | None:
        """The reduced Groebner basis of a branch that does not split, or None (empty, or put back in parts)."""
        basis = self._simplified(branch)
        if basis is None:
            return None
        leads = [x.monomial(0) for x in basis]
        pairs = {(i, j): sum(_lcm(leads[i], leads[j])) for i, j in combinations(range(len(basis)), 2)}
        while pairs:
            i, j = min(pairs, key=lambda pair: (pairs[pair], pair))
            del pairs[i, j]
            if _useless(i, j, leads, pairs):
                continue
            self.pairs += 1
            if self.pairs > self.limits.pairs:
                raise _TooLarge(Message("more than [[pairs]] S-polynomials", pairs=self.limits.pairs))
            x = basis[i].spoly(basis[j]).reduction_primitive_part(_vector(basis, self.context))
            self.spend(len(basis[i]) + len(basis[j]) + len(x) * len(basis))
            if x.is_zero():
                continue
            self._check(x)
            factors = [] if x.is_constant() else self._essential(x, branch.nonzero)
            if not factors:
                return None
            if len(factors) > 1:
                self._split(basis, factors, branch)
                return None
            x = factors[0]
            lead = x.monomial(0)
            if any(_divides(lead, other) for other in leads):  # the others get shorter: begin again with that
                self.pending.append(_Branch([*basis, x], branch.nonzero, branch.special, branch.families))
                return None
            pairs |= {(k, len(basis)): sum(_lcm(other, lead)) for k, other in enumerate(leads)}
            basis.append(x)
            leads.append(lead)
            if len(basis) > self.limits.elements:
                raise _TooLarge(
                    Message("a Groebner basis of more than [[elements]] elements", elements=self.limits.elements)
                )
        return list(_vector(basis, self.context).autoreduction(groebner=True))

    def _check(self, x: Polynomial) -> None:
        if len(x) > self.limits.terms:
            raise _TooLarge(Message("a polynomial of more than [[terms]] terms", terms=self.limits.terms))
        if int(x.leading_coefficient()).bit_length() > self.limits.bits:
            raise _TooLarge(Message("a coefficient of more than [[bits]] bits", bits=self.limits.bits))

    # --- finitely many solutions -------------------------------------------------------------------------------------

    def _finite(self, basis: list[Polynomial], standard: list[Monomial], branch: _Branch) -> None:
        size = len(standard)
        self.spend(size**3 + self.nvars * size**2)
        tables = _multiplication(basis, standard, self.nvars)
        for k, table in enumerate(tables):
            minimal = table.minpoly()
            factors = [_in_variable(p, k, self.context) for p, _ in irreducible_factors(minimal)[1]]
            vanishing = [x for x in factors if self._can_vanish(x)]
            if not vanishing:
                return
            if len(vanishing) < len(factors) or len(factors) > 1 or not _squarefree(minimal):
                self._split(basis, vanishing, branch)
                return
        for modulus, values in _representation(tables, size):
            for index in range(len(real_roots(modulus))):
                point = AlgebraicPoint(modulus, index, values)
                if any(point.residue(x) == 0 for x in branch.nonzero):
                    continue
                if not any(family.contains(point) for family in branch.families):
                    self.points.append(point)

    # --- families ----------------------------------------------------------------------------------------------------

    def _family(self, basis: list[Polynomial], branch: _Branch) -> None:
        """Splits off what is exceptional, and proves that the rest is real (or says that it could not)."""
        leads = [x.monomial(0) for x in basis]
        free = _independent(leads, self.nvars)
        sample = self._sample(basis, free, branch)
        exceptional, closure = self._exceptional(basis, free, branch)
        families = branch.families
        if sample is None:
            self.unseen.append((closure, free))
        else:
            family = Family(tuple(closure), len(free), free, sample)
            if not any(known.contains(sample) and known.dimension >= len(free) for known in families):
                self.families.append(family)
            families = [*families, family]
        done: list[Polynomial] = []
        for x in exceptional:
            self.pending.append(_Branch([*basis, x], [*branch.nonzero, *done], branch.special, families))
            done.append(x)

    def _exceptional(
        self, basis: list[Polynomial], free: tuple[int, ...], branch: _Branch
    ) -> tuple[list[Polynomial], list[Polynomial]]:
        """(the factors of the leading coefficients in QQ[free], generators of the closure of where none vanishes)."""
        order, lexicographic = self._with_last(free)
        moved = [_moved(x, order, lexicographic) for x in basis]
        ordered = self._bounded_basis(moved, lexicographic)
        bound = self.nvars - len(free)
        coefficients: dict[str, Polynomial] = {}
        for x in ordered:
            top = x.monomial(0)[: bound + 1]
            part = lexicographic.from_dict(
                {(0,) * (bound + 1) + m[bound + 1 :]: c for m, c in x.terms() if m[: bound + 1] == top}
            )
            if not part.is_constant():
                for factor in _irreducible(part):
                    back = _moved_back(factor, order, self.context)
                    if _key(back) not in {_key(y) for y in branch.nonzero}:
                        coefficients[_key(back)] = back
        removed = [*coefficients.values(), *branch.nonzero]
        if not removed:
            return [], list(basis)
        closure = self._saturated(ordered, removed, order, lexicographic)
        return [x for x in coefficients.values() if self._can_vanish(x)], closure

    def _with_last(self, last: Sequence[int]) -> tuple[list[int], Any]:
        """All unknowns with some of them last, and a lexicographic context of these behind one that is an inverse."""
        order = [k for k in range(self.nvars) if k not in last] + list(last)
        names = self.context.names()
        return order, context(["#inverse", *(names[k] for k in order)], lexicographic=True)

    def _saturated(
        self, generators: Sequence[Any], nonzero: Sequence[Any], order: Sequence[int], where: Any
    ) -> list[Any]:
        """A basis of what vanishes where the generators do and nothing of ``nonzero``."""
        inverse = where.gens()[0]
        for x in nonzero:
            inverse = inverse * _moved(x, order, where)
        basis = self._bounded_basis([*generators, *([inverse - 1] if nonzero else [])], where)
        return [_moved_back(x, order, self.context) for x in basis if x.degrees()[0] <= 0]

    def _bounded_basis(self, generators: list[Polynomial], where: Any) -> list[Polynomial]:
        limits = (self.limits.elements, self.limits.terms, self.limits.bits)
        basis, finished = _vector(generators, where).buchberger_naive(limits=limits)
        if not finished:
            raise _TooLarge("an elimination beyond the limits of a Groebner basis")
        self.spend(sum(map(len, basis)) * len(basis))
        return list(basis.autoreduction(groebner=True))

    def _sample(self, basis: list[Polynomial], free: tuple[int, ...], branch: _Branch) -> AlgebraicPoint | None:
        """A real point of the family at which its equations have the full rank, so that it goes on around there."""
        choices = (fmpq(3, 5), fmpq(-4, 5), fmpq(5, 13), fmpq(0), fmpq(1), fmpq(20, 29), fmpq(-12, 13), fmpq(7, 3))
        gens = self.context.gens()
        attempts = list(zip(*([choices] * len(free)), strict=True)) + list(product(choices[:4], repeat=len(free)))
        for values in dict.fromkeys(attempts[:24]):
            fixed = [gens[k] * int(v.q) - int(v.p) for k, v in zip(free, values, strict=True)]
            part = _Solver([*basis, *fixed], branch.nonzero, self.bounded, Limits(branches=200, work=2_000_000))
            part.families = []
            for point in part.run().points:
                if len(_free_at(basis, point, free)) == len(free):
                    return point
        return None

    def _seen_at_points(self, closure: list[Polynomial], free: tuple[int, ...]) -> None:
        """The family of a set in which no real point was met by chance, where an exceptional point is a regular one."""
        for point in self.points:
            if all(point.residue(x) == 0 for x in closure):
                there = _free_at(closure, point, free)
                if len(there) == len(free):
                    self.families.append(Family(tuple(closure), len(free), there, point, special=True))
                    return
        text = "a set of solutions of complex dimension [[count]] in which no regular real point was found"
        self.unfinished.append(Message(text, count=len(free)))


# --- monomials and polynomials ---------------------------------------------------------------------------------------


def _divides(a: Monomial, b: Monomial) -> bool:
    return all(x <= y for x, y in zip(a, b, strict=True))


def _lcm(a: Monomial, b: Monomial) -> Monomial:
    return tuple(max(x, y) for x, y in zip(a, b, strict=True))


def _useless(i: int, j: int, leads: Sequence[Monomial], pairs: Container[tuple[int, int]]) -> bool:
    """Buchberger's criteria: coprime leading monomials, or a chain through an element whose pairs are done."""
    common = _lcm(leads[i], leads[j])
    if all(not (a and b) for a, b in zip(leads[i], leads[j], strict=True)):
        return True
    for k, lead in enumerate(leads):
        if k in (i, j) or not _divides(lead, common):
            continue
        if (min(i, k), max(i, k)) not in pairs and (min(j, k), max(j, k)) not in pairs:
            return True
    return False


def _key(x: Polynomial) -> str:
    """Equal for polynomials that differ by a factor of -1 (they are primitive)."""
    return str(x if x.leading_coefficient() > 0 else -x)


def _irreducible(x: Polynomial) -> list[Polynomial]:
    try:
        return [] if x.is_constant() else [factor for factor, _ in irreducible_factors(x)[1]]
    except NoClosedForm as error:
        raise _TooLarge(error.reason) from None


def _sum_of_squares(x: Polynomial) -> list[Polynomial]:
    """The terms of a sum of several even monomials with coefficients of one sign, none of them constant; else []."""
    monomials = x.monoms()
    if len(monomials) < 2 or any(e % 2 for m in monomials for e in m) or len({c > 0 for c in x.coeffs()}) > 1:
        return []
    return [x.context().from_dict({tuple(int(e > 0) for e in m): fmpz(1)}) for m in monomials]


def _in_variable(p: Univariate, index: int, where: Any) -> Polynomial:
    zeros = [0] * where.nvars()
    terms = {}
    for power, coefficient in enumerate(p.numer().coeffs()):
        if coefficient:
            exponents = list(zeros)
            exponents[index] = power
            terms[tuple(exponents)] = coefficient
    return where.from_dict(terms)


def _squarefree(p: Univariate) -> bool:
    return bool(p.gcd(p.derivative()).degree() == 0)


def _moved(x: Polynomial, order: Sequence[int], where: Any) -> Polynomial:
    """x in a context whose generators are one more in front, then those of x in another order."""
    return where.from_dict({(0, *(m[k] for k in order)): c for m, c in x.terms()})


def _moved_back(x: Polynomial, order: Sequence[int], where: Any) -> Polynomial:
    terms = {}
    for monomial, coefficient in x.terms():
        exponents = [0] * len(order)
        for place, k in enumerate(order):
            exponents[k] = monomial[place + 1]
        terms[tuple(exponents)] = coefficient
    return where.from_dict(terms)


def _ball(value: fmpq, bits: int) -> Any:
    with ctx.workprec(bits):
        return arb(value)


# --- the quotient by an ideal of finitely many solutions -------------------------------------------------------------


def _standard_monomials(basis: Sequence[Polynomial], nvars: int, most: int) -> list[Monomial] | None:
    """The monomials that no leading monomial divides, ascending by degree; None if there are infinitely many."""
    leads = [x.monomial(0) for x in basis]
    if any(not any(lead[k] == sum(lead) > 0 for lead in leads) for k in range(nvars)):
        return None
    layer: list[Monomial] = [(0,) * nvars]
    monomials: list[Monomial] = []
    while layer:
        monomials += layer
        if len(monomials) > most:
            raise _TooLarge(Message("more than [[most]] solutions in one case", most=most))
        grown = {(*m[:k], m[k] + 1, *m[k + 1 :]) for m in layer for k in range(nvars)}
        layer = sorted(m for m in grown if not any(_divides(lead, m) for lead in leads))
    return monomials


def _multiplication(basis: Sequence[Polynomial], standard: list[Monomial], nvars: int) -> list[Any]:
    """The matrices of multiplication by each variable (columns: images of the standard monomials)."""
    size = len(standard)
    position = {m: k for k, m in enumerate(standard)}
    tails = {}
    for x in basis:
        lead, top = x.monomial(0), fmpq(x.leading_coefficient())
        tails[lead] = [(m, -fmpq(c) / top) for m, c in list(x.terms())[1:]]
    normal: dict[Monomial, list[fmpq]] = {}
    for m, k in position.items():
        normal[m] = [fmpq(int(i == k)) for i in range(size)]

    def times(k: int, vector: Sequence[fmpq]) -> list[fmpq]:
        total = [fmpq(0)] * size
        for coefficient, m in zip(vector, standard, strict=True):
            if coefficient:
                for i, value in enumerate(form((*m[:k], m[k] + 1, *m[k + 1 :]))):
                    if value:
                        total[i] += coefficient * value
        return total

    def form(m: Monomial) -> list[fmpq]:
        """The normal form of a monomial on the border, from smaller ones."""
        if m not in normal:
            if m in tails:
                total = [fmpq(0)] * size
                for other, coefficient in tails[m]:
                    for i, value in enumerate(form(other)):
                        if value:
                            total[i] += coefficient * value
            else:
                k = next(
                    k
                    for k in range(nvars)
                    if m[k] and (smaller := (*m[:k], m[k] - 1, *m[k + 1 :])) not in position and _is_border(smaller)
                )
                total = times(k, form((*m[:k], m[k] - 1, *m[k + 1 :])))
            normal[m] = total
        return normal[m]

    def _is_border(m: Monomial) -> bool:
        return any(_divides(lead, m) for lead in tails)

    tables = []
    for k in range(nvars):
        columns = [form((*m[:k], m[k] + 1, *m[k + 1 :])) for m in standard]
        tables.append(fmpq_mat(size, size, [columns[j][i] for i in range(size) for j in range(size)]))
    return tables


def _representation(tables: Sequence[Any], size: int) -> list[tuple[Univariate, tuple[Univariate, ...]]]:
    """(p, values): every variable as a polynomial in t modulo p, for each irreducible factor p of t's polynomial."""
    for attempt in range(1, 40):
        weights = [(k * attempt + 1) ** 2 % 37 - 18 or 1 for k in range(len(tables))]
        if attempt == 1:
            weights = [1 + k for k in range(len(tables))]
        for only in [k for k in range(len(tables)) if attempt == 1 and tables[k].minpoly().degree() == size][:1]:
            weights = [int(k == only) for k in range(len(tables))]
        table = tables[0] * 0
        for weight, other in zip(weights, tables, strict=True):
            table = table + other * weight
        minimal = table.minpoly()
        if minimal.degree() < size:
            continue
        unit = fmpq_mat(size, 1, [1] + [0] * (size - 1))
        powers = [unit]
        for _ in range(size - 1):
            powers.append(table * powers[-1])
        krylov = fmpq_mat(size, size, [powers[j][i, 0] for i in range(size) for j in range(size)])
        values = [krylov.solve(other * unit) for other in tables]
        polynomials = [fmpq_poly([v[i, 0] for i in range(size)]) for v in values]
        return [(p, tuple(x % p for x in polynomials)) for p, _ in irreducible_factors(minimal)[1]]
    raise _TooLarge("no separating linear form was found")


def _independent(leads: Sequence[Monomial], nvars: int) -> tuple[int, ...]:
    """A largest set of variables such that no leading monomial is made of them alone."""
    supports = [{k for k, e in enumerate(lead) if e} for lead in leads]
    for size in range(nvars, 0, -1):
        for chosen in combinations(range(nvars), size):
            if not any(support <= set(chosen) for support in supports):
                return chosen
    return ()


def _free_at(equations: Sequence[Polynomial], point: AlgebraicPoint, free: tuple[int, ...]) -> tuple[int, ...]:
    """The variables that the others are functions of near a regular point, as many as its Jacobian leaves: ``free``

    where that is possible.  By elimination in the number field: exact.
    """
    columns = [k for k in range(len(point.values)) if k not in free] + list(free)
    rows = [[point.residue(x.derivative(k)) for k in columns] for x in equations]
    pivots = echelon(Residues(point.modulus), rows, len(columns))[1]
    return tuple(sorted(k for at, k in enumerate(columns) if at not in pivots))


class Residues(Algebra[Univariate]):
    """QQ[t]/modulus, a field where the modulus is irreducible."""

    def __init__(self, modulus: Univariate) -> None:
        self.modulus = modulus
        self.zero, self.one = fmpq_poly([0]), fmpq_poly([1])

    def times(self, a: Univariate, b: Univariate) -> Univariate:
        return a * b % self.modulus

    def reduce(self, x: Univariate) -> Univariate:
        return x % self.modulus

    def reciprocal(self, x: Univariate) -> Univariate:
        return inverse_modulo(x, self.modulus)


def inverse_modulo(x: Univariate, p: Univariate) -> Univariate:
    """1/x in QQ[t]/p.  Raises ZeroDivisionError for zero."""
    x = x % p
    if x == 0:
        raise ZeroDivisionError("zero has no inverse in the number field")
    _, s, _ = x.xgcd(p)
    return s % p


def minimal_polynomial(value: Univariate, modulus: Univariate) -> Univariate:
    """The monic minimal polynomial over QQ of an element of QQ[t]/modulus."""
    n = int(modulus.degree())
    if n == 1 or value.degree() <= 0:
        return fmpq_poly([-value[0], 1])
    columns = [(value * fmpq_poly([0] * j + [1])) % modulus for j in range(n)]
    return fmpq_mat(n, n, [columns[j][i] for i in range(n) for j in range(n)]).minpoly()
