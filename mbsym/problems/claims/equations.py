"""Claimed equations of motion: what vanishes on every motion is a combination of the equations of the system.

With the equations L = M a - f = 0, linear in the accelerations a (q'', or u' and the rates of positions), an expression
E(q, q', a, t) vanishes on every motion if and only if it does with a = M^-1 f.  One that is linear in a is then

    E = c^T L,      c^T = dE/da M^-1:      c_i = det(M with row i replaced by dE/da) / det M

so that solved accelerations and sums of equations are told with what they are made of.  M is taken apart into blocks
that are not coupled; each c_i is brought to lowest terms.  What does not hold is compared with the multiple of the own
equation, with the equation solved for the own acceleration, or with c^T L, whichever it differs from in fewest places.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import islice

from mbsym.algebra.failures import NOT_THERE, Failure, NoClosedForm
from mbsym.algebra.matrices import components, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import coefficients_in
from mbsym.expressions.message import Message
from mbsym.expressions.rates import without_velocity
from mbsym.formulas.formula import Formula
from mbsym.problems.claims.comparison import closest_multiple, decided, differing, exceptions
from mbsym.problems.claims.counterexample import rate_at_states
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome, by_place, in_parameters, on_relations
from mbsym.problems.claims.symbols import Symbols

#: States at which an expression must vanish before a proof is tried; coupled equations, and powers of accelerations,
#: beyond which none is.
STATES, MOST_COUPLED, MOST_POWER = 6, 6, 4
#: Coefficients longer than this are not printed.
LONGEST = 160

NOTHING = "it says 0 = 0"
SOLVED = "compared with the equation solved for the acceleration of [[name]]"
SAME_ACCELERATIONS = "compared with the combination of the equations that has the same accelerations"
NOT_LINEAR = "it vanishes on every motion; it is not linear in the accelerations, and others may satisfy it, too"


@dataclass(frozen=True)
class Dynamics:
    """The equations by ``names``, as ``rows`` L = M a - f; ``places`` are the generators of a."""

    ring: Ring
    names: tuple[str, ...]
    places: tuple[int, ...]
    rows: tuple[Polynomial, ...]

    @staticmethod
    def of(derived: Derived) -> Dynamics:
        """Of a tree M u' - f = 0, and s' - g = 0 of those s' that are no speeds themselves; in declared parameters."""
        form, ring = derived.form, derived.ring
        own = {u.index for u in form.speeds}
        variables = [s for s in form.positions if s.rate_index not in own]
        rows = [x.polynomial for x in derived.equations.equalities(derived.system.coordinates)]
        rows += [ring.context.gen(s.rate_index) - form.rates[s.name] for s in variables]
        names = (*(without_velocity(u.name) for u in form.speeds), *(s.name for s in variables))
        places = tuple(x.rate_index for x in (*form.speeds, *variables))
        return Dynamics(ring, names, places, tuple(in_parameters(derived, x) for x in rows))

    def combination(self, x: Polynomial) -> Combination:
        """x, linear in a, against c^T L.  Raises NoClosedForm where too many equations are coupled."""
        ring = self.ring
        slopes = [x.derivative(k) for k in self.places]
        coefficients: list[tuple[str, Polynomial, Polynomial]] = []
        left, over = x, ring.one
        for block, mass, whole in self._blocks({i for i, slope in enumerate(slopes) if not ring.vanishes(slope)}):
            for i in block:
                row = [slopes[j] for j in block]
                top = determinant(ring, [row if k == i else mass[m] for m, k in enumerate(block)])
                if ring.vanishes(top):
                    continue
                top, bottom = ring.lowest_terms(top, whole)
                coefficients.append((self.names[i], top, bottom))
                # left/over - top/bottom L_i over the least denominator
                mine, other = ring.lowest_terms(bottom, over)
                left = ring.times(left, mine) - ring.times(ring.times(top, other), self.rows[i])
                left, over = ring.reduce(left), ring.reduce(ring.times(over, mine))
        return Combination(tuple(coefficients), left, over)

    def solved(self, i: int) -> tuple[Polynomial, Polynomial]:
        """(top, bottom) of a_i = top/bottom, in lowest terms."""
        (solution,) = self._solutions({i})
        return solution[1], solution[2]

    def put_in(self, x: Polynomial) -> Polynomial:
        """x, a polynomial in a, times a power of det M with a = M^-1 f put in."""
        ring = self.ring
        degrees = x.degrees()
        indices = {i for i, k in enumerate(self.places) if degrees[k] > 0}
        total = x
        for i, top, bottom in self._solutions(indices):
            k = self.places[i]
            parts = coefficients_in(total, k)
            degree, total = len(parts) - 1, ring.zero
            for power, term in enumerate(parts):
                for factor, exponent in ((top, power), (bottom, degree - power)):
                    for _ in range(exponent):
                        term = ring.reduce(ring.times(term, factor))
                total = total + term
            total = ring.reduce(total)
        return total

    def _solutions(self, indices: set[int]) -> list[tuple[int, Polynomial, Polynomial]]:
        ring, solutions = self.ring, []
        still = dict.fromkeys(self.places, ring.zero)
        for block, mass, whole in self._blocks(indices):
            right = [-ring.substitute(self.rows[i], still) for i in block]
            for column, i in enumerate(block):
                if i in indices:
                    replaced = [
                        [y if c == column else x for c, x in enumerate(row)] for row, y in zip(mass, right, strict=True)
                    ]
                    solutions.append((i, *ring.lowest_terms(determinant(ring, replaced), whole)))
        return solutions

    def _blocks(self, indices: set[int]) -> list[tuple[list[int], list[list[Polynomial]], Polynomial]]:
        """(indices, block of M, its determinant) of those blocks that hold a wanted index."""
        ring = self.ring
        mass = [[row.derivative(k) for k in self.places] for row in self.rows]
        blocks = []
        for block in components(len(mass), lambda i, j: not ring.vanishes(mass[i][j]) or not ring.vanishes(mass[j][i])):
            if indices.isdisjoint(block):
                continue
            if len(block) > MOST_COUPLED:
                raise NoClosedForm("[[count]] equations are coupled", count=len(block))
            cut = [[mass[i][j] for j in block] for i in block]
            whole = determinant(ring, cut)
            if ring.vanishes(whole):
                raise NoClosedForm("the mass matrix is singular")
            blocks.append((block, cut, whole))
        return blocks


@dataclass(frozen=True)
class Combination:
    """E = sum top/bottom L_i + left/over: ``coefficients`` are (name of the equation, top, bottom)."""

    coefficients: tuple[tuple[str, Polynomial, Polynomial], ...]
    left: Polynomial
    over: Polynomial

    def words(self, dynamics: Dynamics, derived: Derived, own: str) -> str:
        """``it is 1 times the equation of x plus -cos(theta)/l times the equation of theta``."""
        ring = dynamics.ring
        terms: list[str] = []
        for name, top, bottom in self.coefficients:
            factor = str(Formula(ring, ring.ratio(top, bottom)))
            if len(factor) > LONGEST:
                names = ", ".join(name for name, *_ in self.coefficients)
                terms = [Message("a combination of the equations of [[names]]", names=names)]
                break
            factor = f"({factor})" if " " in factor else factor
            terms.append(Message("[[factor]] times the equation of [[name]]", factor=factor, name=name))
        what = terms[0]
        for term in terms[1:]:
            what = Message("[[first]] plus [[second]]", first=what, second=term)
        said = Message("it is [[what]]", what=what)
        if not any(name == own for name, *_ in self.coefficients):
            said = Message("it is [[what]]; that of [[own]] has no part in it", what=what, own=own)
        # What all the coefficients have in common and may vanish: there the claim says nothing.
        common = reduce(ring.common_factor, [top for _, top, _ in self.coefficients])
        some = exceptions(derived, common, ring.one)
        return Message("[[said]], and says something [[where]]", said=said, where=some) if some else said

    def equation(self, dynamics: Dynamics) -> Polynomial:
        """c^T L."""
        ring, total = dynamics.ring, dynamics.ring.zero
        for name, top, bottom in self.coefficients:
            row = dynamics.rows[dynamics.names.index(name)]
            total = total + ring.times(ring.times(top, ring.reciprocal(bottom)), row)
        return ring.reduce(total)


def along_motion(
    dynamics: Dynamics, x: Polynomial, verdict: Callable[[Polynomial], tuple[str, str]]
) -> tuple[tuple[str, str], Combination | None]:
    """Whether x vanishes on every motion, by ``verdict`` of what is left; and what it is made of, if it is linear.

    Raises Failure where that is too long to be formed.
    """
    power = power_of(dynamics.ring, x, dynamics.places)
    if power <= 1:
        combination = dynamics.combination(x)
        return verdict(combination.left), combination
    if power > MOST_POWER:
        raise NoClosedForm("high powers of accelerations, or accelerations under functions")
    return verdict(dynamics.put_in(x)), None


def power_of(ring: Ring, x: Polynomial, places: Sequence[int]) -> int:
    """The degree of x in these generators; more than MOST_POWER where they stand under functions or below a line."""
    if any(_under(ring, x, k) for k in places):
        return MOST_POWER + 1
    return max((sum(int(monomial[k]) for k in places) for monomial, _ in x.terms()), default=0)


def _under(ring: Ring, x: Polynomial, place: int) -> bool:
    """Whether a generator occurs in the arguments of reciprocals, roots and functions in x."""
    degrees = x.degrees()
    inner = [g.argument for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0]
    return any(y is not None and (y.degrees()[place] > 0 or _under(ring, y, place)) for y in inner)


# --- claims of trees ---


def examined_equation(derived: Derived, own_result: ClaimResult, symbols: Symbols, claimed: Polynomial) -> ClaimResult:
    """``own_result``: what the comparison with the own equation alone gives; where that does not hold, a sum may."""
    ring, claim = derived.ring, own_result.claim
    x = in_parameters(derived, claimed)
    if ring.is_zero(x) or ring.is_zero(on_relations(derived, claim, x)):
        return ClaimResult(claim, own_result.title, Outcome.UNDECIDED, own_result.derived, remark=NOTHING)
    if (
        own_result.outcome == Outcome.FACTOR
        and own_result.factor is not None
        and _has_accelerations(derived, own_result.factor.polynomial)
    ):
        own_result = replace(own_result, outcome=Outcome.DIFFERS)
    if own_result.holds and own_result.outcome != Outcome.NUMERICAL:
        return own_result
    refuted = _refuted_at_states(derived, x)
    if refuted and power_of(ring, x, _places(derived)) > 1:
        return own_result if own_result.refuted else replace(own_result, outcome=Outcome.DIFFERS)

    def verdict(left: Polynomial) -> tuple[str, str]:
        return decided(derived, on_relations(derived, claim, left))

    dynamics, made = Dynamics.of(derived), None
    try:
        (outcome, where), made = along_motion(dynamics, x, verdict)
    except Failure:
        outcome, where = (Outcome.DIFFERS if refuted else Outcome.NUMERICAL), ""
    plain = replace(own_result, factor=None, difference=None, parts=(), remark="", where=where)
    if outcome in (Outcome.EXACT, Outcome.NUMERICAL) and not refuted:
        remark = NOT_LINEAR
        if made is not None:
            remark = made.words(dynamics, derived, claim.of)
        elif power_of(ring, x, _places(derived)) <= 1:
            remark = "at states, with the accelerations of the motion put in"
        return replace(plain, outcome=Outcome.ALONG if outcome == Outcome.EXACT else Outcome.NUMERICAL, remark=remark)
    if outcome == Outcome.UNDECIDED and not refuted:
        return replace(plain, outcome=Outcome.UNDECIDED, remark="whether it vanishes on every motion is not decided")
    if not own_result.refuted:  # undecided as a multiple; refuted as what it is
        own_result = replace(own_result, outcome=Outcome.DIFFERS)
    return _closest(derived, own_result, symbols, x, dynamics, made)


def _places(derived: Derived) -> list[int]:
    return [derived.ring.index("acceleration", name) for name in derived.system.coordinates]


def _has_accelerations(derived: Derived, x: Polynomial) -> bool:
    return power_of(derived.ring, x, _places(derived)) > 0


def _refuted_at_states(derived: Derived, x: Polynomial) -> bool:
    """Whether x is certainly not zero at a state of a motion, coordinates positive."""
    states = rate_at_states(derived.system, derived.ring, derived.programs, x)
    return any(not value.contains(0) for _, value in islice(states, STATES))


def _closest(
    derived: Derived,
    own_result: ClaimResult,
    symbols: Symbols,
    x: Polynomial,
    dynamics: Dynamics,
    made: Combination | None,
) -> ClaimResult:
    """The difference in fewest places: from a multiple of the own equation, from the solved one, from c^T L."""
    ring, claim = derived.ring, own_result.claim

    def places(y: Polynomial) -> int:
        return len(list(by_place(ring, claim, y)))

    best, cost = own_result, places(own_result.difference.polynomial) if own_result.difference is not None else 10**6
    plain = replace(own_result, factor=None, parts=(), remark="", where="")
    try:
        top, bottom = dynamics.solved(dynamics.names.index(claim.of))
        own = dynamics.places[dynamics.names.index(claim.of)]
        solved = ring.reduce(ring.times(bottom, ring.context.gen(own)) - top)
        multiple = closest_multiple(derived, claim, x, solved)
        difference = ring.reduce(x - solved) if multiple is None else multiple.difference
        if not ring.vanishes(difference) and places(difference) < cost:
            factor = None if multiple is None else multiple.factor
            result = replace(plain, derived=Formula(ring, solved), factor=factor, remark=Message(SOLVED, name=claim.of))
            best, cost = differing(derived, result, symbols, difference), places(difference)
    except NOT_THERE:
        pass
    if made is not None and len(made.coefficients) > 0:
        try:
            whole = made.equation(dynamics)
            difference = ring.reduce(x - whole)
            if places(difference) < cost and not ring.vanishes(difference):
                result = replace(plain, derived=Formula(ring, whole), remark=SAME_ACCELERATIONS)
                best = differing(derived, result, symbols, difference)
        except NOT_THERE:
            pass
    return best
