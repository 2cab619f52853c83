"""Polynomial equations over QQ(parameters), taken apart by what they are linear in.

    p_1 = ... = p_m = 0   in unknowns x,   coefficients in QQ[parameters].

Every polynomial is factored, and each factor starts a branch in which the factors of earlier branches do not vanish.
An equation  c v + d = 0  that holds an unknown v linearly gives  v = -d/c  where c != 0, and a branch of its own where
c = 0 (then d = 0, too).  So no two branches share a solution, and together they hold all solutions for which no
polynomial in the parameters alone that was divided by vanishes: those are listed (``Split.generic``), and nothing is
said about parameters at which one of them does.

Where nothing is linear, the factors of a resultant of two equations start branches.  What does not come apart like
that stays as it is (``Branch.remaining``): such a branch may be empty, which is for the caller to find out.  Every step
is bounded by counts; what was left aside is counted in ``Split.unfinished``.

A road not taken: Groebner bases over QQ(parameters).  They need no linear unknown, but their coefficients outgrow every
budget with three moments of inertia as symbols, and the answer is harder to read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.ring import Ring
from mbsym.algebra.terms import with_quotient

Polynomial = Any  # a flint.fmpq_mpoly


@dataclass(frozen=True)
class SplitLimits:
    """Counts that bound the work: branches in all, terms of one polynomial.

    Of equations that are linear in nothing, resultants of ``pairs`` are tried, those with at most ``long`` terms and up
    to ``degree``.
    """

    branches: int = 3_000
    terms: int = 400
    pairs: int = 6
    long: int = 40
    degree: int = 3


@dataclass(frozen=True)
class Solved:
    """The generator number ``unknown`` is numerator/denominator, in unknowns that stay free."""

    unknown: int
    numerator: Polynomial
    denominator: Polynomial


@dataclass(frozen=True)
class Branch:
    """``solved`` unknowns, ``remaining`` equations (irreducible, in none of the solved), what does not vanish."""

    solved: tuple[Solved, ...] = ()
    remaining: tuple[Polynomial, ...] = ()
    nonzero: tuple[Polynomial, ...] = ()

    def numerator(self, p: Polynomial) -> Polynomial:
        """p on this branch times a product of denominators, which do not vanish there: zero where p is."""
        return _cleared(p, self.solved)


@dataclass(frozen=True)
class Split:
    """``branches`` without common solutions; ``generic``: polynomials in the parameters taken to be nonzero."""

    branches: tuple[Branch, ...]
    generic: tuple[Polynomial, ...]
    unfinished: int


@dataclass
class _Work:
    """One call: what does not vanish by assumption, what was taken not to, how many branches were begun."""

    unknowns: Sequence[int]
    never_zero: Callable[[Polynomial], bool]
    limits: SplitLimits
    begun: int = 0
    unfinished: int = 0
    generic: list[Polynomial] = field(default_factory=list)
    done: list[Branch] = field(default_factory=list)
    factored: dict[tuple[int, tuple[int, ...]], list[tuple[Polynomial, list[Polynomial]]]] = field(default_factory=dict)

    def factors(self, p: Polynomial) -> list[Polynomial]:
        """The irreducible factors of p, which comes up in many branches; raises NoClosedForm."""
        alike = self.factored.setdefault((len(p), tuple(p.degrees())), [])  # polynomials of flint have no hash
        known = next((factors for q, factors in alike if q == p), None)
        if known is None:
            known = [f for f, _ in irreducible_factors(p)[1]]
            alike.append((p, known))
        return known

    def is_parameter(self, p: Polynomial) -> bool:
        degrees = p.degrees()
        return all(degrees[k] == 0 for k in self.unknowns)

    def known(self, p: Polynomial, nonzero: Sequence[Polynomial]) -> bool:
        """Whether the irreducible p is known, or taken, not to vanish."""
        if p.is_constant() or any(p == q for q in nonzero):
            return True
        if not self.is_parameter(p):
            return False
        if not self.never_zero(p) and all(p != q for q in self.generic):
            self.generic.append(p)
        return True


def exchanged(branch: Branch, out: Solved, unknown: int, inverse: tuple[Polynomial, Polynomial]) -> Branch | None:
    """The branch with ``unknown`` solved for instead of ``out.unknown``, which becomes free.

    The equation of ``out`` must hold ``unknown`` linearly; ``inverse`` is (P, Q) with P/Q = 1/(its coefficient) on the
    branch, Q without zeros there.
    """
    p = out.denominator * out.numerator.context().gen(out.unknown) - out.numerator
    rest = p - p.derivative(unknown) * p.context().gen(unknown)
    solution = Solved(unknown, -rest * inverse[0], inverse[1])
    taken = _substituted(replace(branch, solved=tuple(s for s in branch.solved if s is not out)), solution)
    if taken is None:
        return None
    return replace(taken, remaining=tuple(_cleared(q, (solution,)) for q in branch.remaining))


def split(
    equations: Sequence[Polynomial],
    unknowns: Sequence[int],
    never_zero: Callable[[Polynomial], bool] = lambda p: False,
    nonzero: Sequence[Polynomial] = (),
    limits: SplitLimits = SplitLimits(),
) -> Split:
    """The solutions of ``equations`` in the generators ``unknowns``, those first that should rather be solved for.

    ``never_zero`` tells which polynomials in the parameters (all other generators) do not vanish by assumption;
    ``nonzero`` lists polynomials that are not to vanish.
    """
    work = _Work(unknowns, never_zero, limits)
    nonzero_factors = tuple(f for p in nonzero for f, _ in irreducible_factors(p)[1])
    stack: list[tuple[Branch, tuple[Polynomial, ...]]] = [(Branch((), (), nonzero_factors), tuple(equations))]
    while stack:
        work.begun += 1
        if work.begun > limits.branches:
            work.unfinished += len(stack)
            break
        branch, open_equations = stack.pop()
        try:
            stack += reversed(_step(work, branch, open_equations))
        except NoClosedForm:
            work.unfinished += 1
    return Split(tuple(work.done), tuple(work.generic), work.unfinished)


def vanishes_with(ring: Ring, x: Polynomial, equations: Sequence[Polynomial]) -> bool | None:
    """Whether x is zero wherever all ``equations`` between parameters hold; None where that is not found out.

    What other generators hold (roots, functions of parameters) is not solved for; a branch on which a numerator is left
    is a witness only if every equation was solved there for something.
    """
    numerator, _ = ring.fraction(x)
    if numerator.is_zero():
        return True
    if any(ring.quotient(numerator, p) is not None for p in equations):
        return True
    present = [(k, ring.generators[k]) for k in occurring((numerator, *equations))]
    hidden = {k for _, g in present if g.argument is not None for k in occurring([g.argument])}
    unknowns = [k for k, g in present if g.kind == "parameter" and k not in hidden and g.name not in ring.angles]
    solutions = split(equations, unknowns)
    if solutions.unfinished or not all(ring.is_number(p) and ring.is_zero(p) is False for p in solutions.generic):
        return None
    left = [bool(ring.reduce(branch.numerator(numerator))) for branch in solutions.branches]
    if not any(left):
        return True
    solved = [
        nonvanishing for nonvanishing, branch in zip(left, solutions.branches, strict=True) if not branch.remaining
    ]
    return False if any(solved) else None


def _step(work: _Work, branch: Branch, equations: Sequence[Polynomial]) -> list[tuple[Branch, tuple[Polynomial, ...]]]:
    """One branching or one unknown solved for; nothing where the branch is empty or done."""
    open_equations: list[Polynomial] = []
    for p in equations:
        if p == 0:
            continue
        if len(p) > work.limits.terms:
            raise NoClosedForm("an equation of [[count]] terms", count=len(p))
        factors = [f for f in work.factors(p) if not work.known(f, branch.nonzero)]
        if not factors:
            return []
        if len(factors) > 1:
            return _by_factors(branch, equations, p, factors)
        if all(factors[0] != q for q in open_equations):
            open_equations.append(factors[0])
    best = _best(work, branch, open_equations)
    if best is None and (further := _by_resultants(work, branch, open_equations)) is not None:
        return further
    if best is None:
        work.done.append(replace(branch, remaining=tuple(open_equations)))
        return []
    place, unknown, slope = best
    p = open_equations[place]
    rest = p - slope * p.context().gen(unknown)
    others = [*open_equations[:place], *open_equations[place + 1 :]]
    slope_factors = [f for f in work.factors(slope) if not work.known(f, branch.nonzero)]
    branches = []
    # Where a factor of the slope vanishes, so does the rest.
    passed: tuple[Polynomial, ...] = ()
    for f in slope_factors:
        branches.append((replace(branch, nonzero=(*branch.nonzero, *passed)), (f, rest, *others)))
        passed = (*passed, f)
    solution = Solved(unknown, -rest, slope)
    taken = _substituted(replace(branch, nonzero=(*branch.nonzero, *passed)), solution)
    if taken is not None:
        branches.insert(0, (taken, tuple(_cleared(q, (solution,)) for q in others)))
    return branches


def _by_factors(
    branch: Branch, equations: Sequence[Polynomial], p: Polynomial, factors: Sequence[Polynomial]
) -> list[tuple[Branch, tuple[Polynomial, ...]]]:
    others = [q for q in equations if q != p]
    return [
        (replace(branch, nonzero=(*branch.nonzero, *factors[:k])), (factor, *others))
        for k, factor in enumerate(factors)
    ]


def _by_resultants(
    work: _Work, branch: Branch, equations: Sequence[Polynomial]
) -> list[tuple[Branch, tuple[Polynomial, ...]]] | None:
    """Branches by the factors of a resultant, which vanishes wherever two equations do; None where none helps."""
    pairs: list[tuple[Any, ...]] = []
    for k, p in enumerate(equations):
        for q in equations[k + 1 :]:
            if len(p) > work.limits.long or len(q) > work.limits.long:
                continue
            for unknown in work.unknowns:
                degrees = p.degrees()[unknown], q.degrees()[unknown]
                if min(degrees) > 0 and max(degrees) <= work.limits.degree:
                    pairs.append((sum(degrees), len(p) + len(q), len(pairs), p, q, unknown))
    for _, _, _, p, q, unknown in sorted(pairs, key=lambda pair: pair[:3])[: work.limits.pairs]:
        eliminated = p.resultant(q, p.context().name(unknown))
        if eliminated == 0:
            continue
        factors = [f for f in work.factors(eliminated) if not work.known(f, branch.nonzero)]
        if not factors:
            return []
        if len(factors) > 1 or all(factors[0] != x for x in equations):
            return [
                (replace(branch, nonzero=(*branch.nonzero, *factors[:k])), (f, *equations))
                for k, f in enumerate(factors)
            ]
    return None


def _best(work: _Work, branch: Branch, equations: Sequence[Polynomial]) -> tuple[int, int, Polynomial] | None:
    """(equation, unknown, slope) to solve next: slopes that do not vanish, short equations, early unknowns."""
    candidates = []
    for place, p in enumerate(equations):
        degrees = p.degrees()
        for rank, unknown in enumerate(work.unknowns):
            if degrees[unknown] != 1:
                continue
            slope = p.derivative(unknown)
            may_vanish = [f for f in work.factors(slope) if not work.known(f, branch.nonzero)]
            weight = sum(f.degrees()[k] for f in may_vanish for k in work.unknowns)
            candidates.append(((weight, len(p), rank, place), place, unknown, slope))
    return min(candidates, key=lambda c: c[0])[1:] if candidates else None


def _substituted(branch: Branch, solution: Solved) -> Branch | None:
    """The branch with one more unknown solved for; None where something that does not vanish would."""
    solveds = (solution,)
    nonzero: list[Polynomial] = []
    for q in branch.nonzero:
        cleared = _cleared(q, solveds)
        if cleared == 0:
            return None
        for f, _ in irreducible_factors(cleared)[1]:
            if not f.is_constant() and all(f != x for x in nonzero):
                nonzero.append(f)
    before = []
    for s in branch.solved:
        top, bottom = _at(s.numerator, solution), _at(s.denominator, solution)
        shift = top[1] - bottom[1]
        above = top[0] if shift >= 0 else top[0] * solution.denominator ** (-shift)
        below = bottom[0] * solution.denominator**shift if shift >= 0 else bottom[0]
        common = above.gcd(below)
        before.append(Solved(s.unknown, above / common, below / common))
    common = solution.numerator.gcd(solution.denominator) if solution.numerator != 0 else solution.denominator
    own = Solved(solution.unknown, solution.numerator / common, solution.denominator / common)
    return Branch((*before, own), branch.remaining, tuple(nonzero))


def _at(p: Polynomial, s: Solved) -> tuple[Polynomial, int]:
    """(P, n) with p = P/denominator^n where the unknown has its value."""
    degree = p.degrees()[s.unknown]
    return (with_quotient(p, s.unknown, s.numerator, s.denominator), degree) if degree > 0 else (p, 0)


def _cleared(p: Polynomial, solved: Sequence[Solved]) -> Polynomial:
    for s in solved:
        p = _at(p, s)[0]
    return p
