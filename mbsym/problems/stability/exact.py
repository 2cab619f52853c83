"""Verdicts of problem 6 at rational and algebraic parameter values: every root is counted exactly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from typing import Any, Protocol

from flint import fmpq, fmpq_mat

from mbsym.algebra.characteristic import Matrix, Polynomial
from mbsym.algebra.factors import occurring
from mbsym.algebra.matrices import Operators, leading_determinants, null_vectors, reduced_rows
from mbsym.algebra.roots import RootCount, counted, rational
from mbsym.problems.stability import nonholonomic
from mbsym.problems.stability.linear_form import LinearSystem, state_matrix
from mbsym.problems.stability.routh import (
    ENERGY_BESIDES,
    besides_cyclic,
    energy_besides,
    ignoring_cyclic,
    momenta_are_constant,
    only_momenta,
)
from mbsym.problems.stability.verdict import (
    Flaw,
    Verdict,
    bounded,
    coasting,
    concluded,
    displaced,
    drifting,
    exactly,
    here,
    off_the_leaf,
    only_drifts,
    undecided,
)
from mbsym.problems.stability.words import Because, Fact, Ground, Reason, Word, applying, implied

# Exactly linear equations: x' = A x is decided by A alone, at any numbers.
#
# No root to the right and those on the imaginary axis semisimple, zero ones too (each at most once in the minimal
# polynomial): every solution is bounded, the motion is stable.  A Jordan block on the axis: some grow like a power of
# t.
#
# Where everything may be shifted along directions V, (K + N) V = 0 (two masses with a spring between them, a body whose
# spring has the stiffness 0), the shifted motions are motions, too: as with cyclic coordinates what is asked for then
# is the rest, q modulo V and all velocities, and A acts on it.  There zero roots that are semisimple belong to
# velocities along V, or to momenta, that stay what they are.  This is the same in all coordinates x = S y.
#
# Source: F. R. Gantmacher, The Theory of Matrices, volume II, chapter XIV, section 3.


def decided(open_verdict: Verdict, first_order: Numbers, shifts: Numbers | None, shown: frozenset[Fact]) -> Verdict:
    """The verdict on x' = A x, A = ``first_order`` (coordinates first), that another one leaves open.

    ``shifts``: rows v with A (v, 0) = 0, along which a drift does not count; None where all coordinates count.
    ``shown`` are facts about the matrices of second order, for the reasons.
    """
    facts = shown | {Fact.EXACTLY_LINEAR}
    roots = counted(first_order.charpoly())
    if roots.right:
        return open_verdict
    calm = is_calm(first_order)
    if shifts is None or not shifts.nrows():
        return bounded(facts) if calm else growing(first_order)
    rest = across(first_order, shifts)
    if not rest.nrows():
        return bounded(facts) if calm else coasting()
    left = counted(rest.charpoly())
    rest_calm = is_calm(rest)
    if rest_calm and left.left and left.left + left.zero == left.degree:
        return exactly(drifting(concluded({Fact.ROOTS_LEFT}), constant_momenta=left.zero > 0), calm)
    if calm:
        return bounded(facts)
    if not rest_calm:
        return growing(first_order)
    if left.zero == left.degree:
        return coasting()
    return drifting(bounded(facts))


def growing(first_order: Numbers) -> Verdict:
    """The verdict where there is a Jordan block on the axis and no root to the right; whether only drifts grow is told.

    Modulo all v with A (v, 0) = 0 no block is left then.
    """
    verdict = concluded({Fact.EXACTLY_LINEAR, Fact.JORDAN_BLOCK})
    still = kernel_of(first_order)
    drifts = still.nrows() and is_calm(across(first_order, still))
    return only_drifts(verdict) if drifts else verdict


def kernel_of(*matrices: Numbers) -> Numbers:
    """Rows v that span what all the matrices A make zero, A v = 0: positions that may be shifted, of x' = A x."""
    kind, n, zero = type(matrices[0]), matrices[0].nrows(), matrices[0][0, 0] * 0
    rows = [row for matrix in matrices for row in matrix.tolist()]
    stacked = kind(len(rows), n, [x for row in rows for x in row])
    basis = null_vectors(Operators(zero, zero + 1), reduced_rows(stacked), n)
    return kind(len(basis), n, [x for v in basis for x in v])


def _independent(kind: Any, rows: Sequence[Sequence[Any]]) -> Numbers:
    """Rows that span the same, none too many."""
    basis = list(reduced_rows(kind(len(rows), len(rows[0]), [x for row in rows for x in row])).values())
    return kind(len(basis), len(rows[0]), [x for row in basis for x in row])


def is_calm(first_order: Numbers) -> bool:
    """Whether no root is to the right, and those on the axis are semisimple."""
    roots: RootCount = counted(first_order.charpoly())
    if roots.right or max(roots.imaginary_multiplicity, roots.zero) <= 1:
        return not roots.right
    blocks: RootCount = counted(first_order.minpoly())
    return max(blocks.imaginary_multiplicity, blocks.zero) <= 1


def across(first_order: Numbers, shifts: Numbers) -> Numbers:
    """A on the states modulo (v, 0), v the rows of ``shifts``: A (v, 0) = 0."""
    basis, rows = reduced_rows(shifts), first_order.tolist()
    remaining = [i for i in range(len(rows)) if i not in basis]
    entries = []
    for i in remaining:
        row = rows[i]
        for at, v in basis.items():
            if i < len(v) and v[i] != 0:
                row = [x - v[i] * y for x, y in zip(row, rows[at], strict=True)]
        entries += [row[j] for j in remaining]
    return type(first_order)(len(remaining), len(remaining), entries)


def is_open(verdict: Verdict) -> bool:
    """Whether linear theory has something to add."""
    return verdict.word.open and not verdict.coordinates_singular


Numbers = Any  # a flint.fmpq_mat


@dataclass(frozen=True)
class PointVerdict:
    """The exact result at parameter values.  ``roots`` and ``polynomial`` are None where M is singular."""

    verdict: Verdict
    polynomial: Any
    roots: RootCount | None

    @property
    def characteristic(self) -> tuple[Any, ...]:
        """The coefficients of the characteristic polynomial, from low to high powers; () where M is singular."""
        return () if self.polynomial is None else tuple(self.polynomial.coeffs())


def verdict_at(system: LinearSystem, point: Mapping[int, Fraction]) -> PointVerdict:
    """The exact verdict at rational parameter values {index of the generator: value}.

    Half-planes are counted exactly; whether multiple imaginary roots are semisimple is read off the minimal
    polynomial.  Raises ValueError when a parameter that occurs has no value, or when M, D or K is not symmetric (up
    to positive factors of the rows).
    """
    return verdict_over(system, RationalPoint(point))


def verdict_over(system: LinearSystem, at: ExactPoint) -> PointVerdict:
    """The same where the matrices' entries have exact values of whatever kind; ``polynomial`` is of that kind."""
    verdict = _verdict_over(system, at)
    if system.exact and verdict.roots is not None:
        verdict = replace(verdict, verdict=_of_linear_equations(system, at, verdict.verdict))
    zeros = 0 if verdict.roots is None else verdict.roots.zero
    return replace(verdict, verdict=on_the_motion(system, verdict.verdict, zeros))


def on_the_motion(system: LinearSystem, verdict: Verdict, zeros: int) -> Verdict:
    """What a verdict on the coordinates of the matrices, by so many zero roots, means: others may be outside."""
    verdict = displaced(verdict, system.basis)
    if system.exact and system.nonholonomic is not None:
        verdict = nonholonomic.besides_outside(system.nonholonomic, verdict, zeros)
    return off_the_leaf(verdict) if system.leaf else verdict


def _verdict_over(system: LinearSystem, at: ExactPoint) -> PointVerdict:
    """What holds of disturbances that the matrices are about."""
    _, d, _, _, n = matrices = [evaluated(matrix, at) for matrix in system.matrices]
    try:
        a = state_at(system, at, matrices)
    except ZeroDivisionError:
        return PointVerdict(undecided(Because.MASS_SINGULAR), None, None)
    polynomial = a.charpoly()
    roots = counted(polynomial)
    if system.nonholonomic is not None:
        return PointVerdict(nonholonomic.at_rationals(system.nonholonomic, a), polynomial, roots)
    if not system.cyclic or roots.right:
        verdict = _judge(system, matrices, a, roots)
        if system.turned and not roots.right and not (_no(d) and _no(n)):
            verdict = _judge_turned(polynomial, [at.value(x) for x in system.turned], verdict)
        return PointVerdict(verdict, polynomial, roots)
    energy = _energy_besides(system, at, d, n)
    if roots.left + len(system.cyclic) == 2 * system.size:
        decaying = concluded(energy | {Fact.ROOTS_LEFT})
        return PointVerdict(drifting(decaying, constant_momenta=False), polynomial, roots)
    there = _settled(system, at)  # a damper of coefficient 0 changes no momentum
    if only_momenta(there):
        return PointVerdict(coasting(), polynomial, roots)
    if momenta_are_constant(there):
        reduced = verdict_over(ignoring_cyclic(there), at)
        return PointVerdict(drifting(reduced.verdict), polynomial, roots)
    if energy:
        return PointVerdict(drifting(energy_besides(system), constant_momenta=False), polynomial, roots)
    return PointVerdict(undecided(Because.CYCLIC_ZERO_ROOTS), polynomial, roots)


def _of_linear_equations(system: LinearSystem, at: ExactPoint, first_verdict: Verdict) -> Verdict:
    """A verdict by the first approximation, where that is all there is."""
    if not is_open(first_verdict) and Flaw.CYCLIC not in first_verdict.flawed:
        return exactly(first_verdict)
    m, d, g, k, n = (evaluated(matrix, at) for matrix in system.matrices)
    a = state_at(system, at, (m, d, g, k, n))
    if not is_open(first_verdict):
        return exactly(first_verdict, Ground.IDLE not in first_verdict.laid and is_calm(a))
    if system.leaf and a.charpoly().coeffs()[0] == 0:  # what changes the relations acts like a constant force
        return first_verdict
    always = evaluated(system.shifts, at).tolist() if system.shifts else []
    there = kernel_of(k + n, g).tolist() if system.free else []
    shifts = _independent(type(m), [*always, *there]) if always or there else None
    facts = frozenset[Fact]() if system.nonholonomic is not None else _facts(m, d, g, k, n, system)
    verdict = exactly(decided(first_verdict, a, shifts, facts))
    return here(verdict) if shifts is not None and shifts.nrows() > len(always) else verdict


def _energy_besides(system: LinearSystem, at: ExactPoint, d: Numbers, n: Numbers) -> frozenset[Fact]:
    """What Lagrange's theorem needs for the other coordinates and all velocities, cyclic ones not counted; or nothing.

    V has a strict minimum in the others, T in the velocities, whatever acts on the cyclic coordinates.
    """
    block = besides_cyclic(system)
    if not system.conservative or not _no(n) or inertia(d)[2]:
        return frozenset()
    if block and inertia(evaluated(block, at))[1:] != (0, 0):
        return frozenset()
    return ENERGY_BESIDES


def _settled(system: LinearSystem, at: ExactPoint) -> LinearSystem:
    """The system with its matrices such that what vanishes at the point is zero."""
    m, d, g, k, n = (tuple(tuple(map(at.settled, row)) for row in matrix) for matrix in system.matrices)
    return replace(system, M=m, D=d, G=g, K=k, N=n)


def _judge(system: LinearSystem, matrices: Sequence[Numbers], a: Numbers, roots: RootCount) -> Verdict:
    m, d, g, k, n = matrices
    facts = _facts(m, d, g, k, n, system)
    if system.exact:
        facts |= {Fact.EXACTLY_LINEAR}
    if roots.right:
        how_many = Reason(Because.RIGHT_ROOTS, (roots.right,))
        verdict = concluded(facts | {Fact.ROOT_RIGHT})
        further = [reason for reason in verdict.reasons if reason.code is not Because.RIGHT_ROOT]
        return replace(verdict, reasons=(how_many, *further))
    if roots.left == roots.degree:
        return concluded(facts | {Fact.ROOTS_LEFT})
    if implied(facts) >= {Fact.MASS_POSITIVE, Fact.DAMPING_SEMIDEFINITE, Fact.POTENTIAL, Fact.STIFFNESS_POSITIVE}:
        if not {None, Ground.ENERGY} & {*applying(facts)}:
            return bounded(facts, Reason(Because.NO_ENERGY), Reason(Because.HIGHER_ORDER))
        verdict = concluded(facts)
        if Fact.UNDAMPED in facts:
            return verdict
        names = ", ".join(system.name(i) for i in _undamped(a, d))
        return replace(verdict, reasons=(*verdict.reasons, Reason(Because.UNDAMPED_MOTION, (names,))))
    blocks = counted(a.minpoly()) if max(roots.imaginary_multiplicity, roots.zero) > 1 else roots
    if max(blocks.imaginary_multiplicity, blocks.zero) > 1:
        return undecided(Because.JORDAN_BLOCK)
    if roots.zero:  # without blocks, as a simple pair
        return concluded({Fact.BOUNDED}, Reason(Because.ZERO_ROOT), Reason(Because.HIGHER_ORDER))
    if facts >= {Fact.MASS_POSITIVE, Fact.UNDAMPED, Fact.POTENTIAL}:
        coinciding = [Reason(Because.COINCIDENCE)] if roots.imaginary_multiplicity > 1 else []
        return bounded(facts, Reason(Because.GYROSCOPIC_ONLY), *coinciding)
    return bounded(facts, Reason(Because.IMAGINARY), Reason(Because.HIGHER_ORDER))


def _facts(m: Numbers, d: Numbers, g: Numbers, k: Numbers, n: Numbers, system: LinearSystem) -> frozenset[Fact]:
    """What the matrices show.  Raises ValueError if M, D or K is not symmetric."""
    (_, massless, light), (_, free, negative), (_, undamped, growing) = (inertia(matrix) for matrix in (m, k, d))
    size = m.nrows()
    shown = {
        Fact.MASS_POSITIVE: not massless and not light,
        Fact.STIFFNESS_POSITIVE: not free and not negative,
        Fact.STIFFNESS_NONSINGULAR: not free,
        Fact.STIFFNESS_NEGATIVE_SOMEWHERE: negative > 0,
        Fact.STIFFNESS_ODD: not free and negative % 2 == 1,
        Fact.UNDAMPED: undamped == size,
        Fact.DAMPING_SEMIDEFINITE: not growing,
        Fact.DAMPING_POSITIVE: not growing and not undamped,
        Fact.NOT_GYROSCOPIC: _no(g),
        Fact.POTENTIAL: _no(n),
        Fact.ENERGY_NEVER_GROWS: system.conservative,
    }
    return system.of_one.union(fact for fact, holds in shown.items() if holds)


def observed(a: Numbers, d: Numbers) -> list[list[Any]]:
    """The rows of (0 D), (0 D) A, (0 D) A^2, ...: what D x' = 0 at all times says of (x, x')' = A (x, x')."""
    n, observability = d.nrows(), list[list[Any]]()
    rows = type(d)(n, 2 * n, [x for line in d.tolist() for x in [fmpq(0)] * n + line])
    for _ in range(2 * n):
        observability += rows.tolist()
        rows = rows * a
    return observability


def _undamped(a: Numbers, d: Numbers) -> list[int]:
    """The coordinates that take part in motions (x, x')' = A (x, x') on which D x' = 0 at all times.

    They are the ones not observed by D x': the unit row e_i does not depend on the rows of ``observed``.
    """
    n, rows = d.nrows(), observed(a, d)

    def rank(rows: Sequence[Sequence[Any]]) -> int:
        return int(type(d)(len(rows), len(rows[0]), [x for row in rows for x in row]).rref()[1])

    least = rank(rows)
    return [i for i in range(n) if rank([*rows, [fmpq(int(j == i)) for j in range(2 * n)]]) > least]


def _judge_turned(whole_polynomial: Any, turned: Sequence[Any], whole: Verdict) -> Verdict:
    """The roots that remain without those of p lambda^2 + q, (p, q) = ``turned``, decide; none has Re > 0."""
    top, bottom = turned
    polynomial, remainder = divmod(whole_polynomial, type(whole_polynomial)([bottom, bottom * 0, top]))
    if remainder != 0:
        return whole
    roots = counted(polynomial)
    if roots.left == roots.degree:
        return concluded({Fact.LEFT_BUT_TURNED})
    if whole.word is Word.STABLE:  # by its energy: K > 0, D >= 0
        return whole
    if roots.zero or roots.imaginary_multiplicity > 1:
        return undecided(Because.ZERO_OR_MULTIPLE_BESIDES_TURNED)
    if whole.because(Because.JORDAN_BLOCK):  # with the turned roots once more: without angular momentum tilts grow
        return whole
    return concluded({Fact.BOUNDED}, Reason(Because.IMAGINARY_BESIDES_TURNED), Reason(Because.HIGHER_ORDER))


def inertia(matrix: Numbers) -> tuple[int, int, int]:
    """(positive, zero, negative) eigenvalues of a symmetric rational matrix, by Descartes' rule, which is exact here.

    Rows may be scaled by positive factors.  Raises ValueError if the eigenvalues are not all real.
    """
    cs = matrix.charpoly().coeffs()
    zero = next(i for i, c in enumerate(cs) if c != 0)
    positive = _changes_of_sign(cs)
    negative = _changes_of_sign([-c if i % 2 else c for i, c in enumerate(cs)])
    if positive + zero + negative != matrix.nrows():
        raise ValueError("a matrix that should be symmetric is not")
    return positive, zero, negative


def _changes_of_sign(numbers: Sequence[Any]) -> int:
    signs = [c > 0 for c in numbers if c != 0]
    return sum(a != b for a, b in pairwise(signs))


class ExactPoint(Protocol):
    """Where matrices have exact values; ``matrix`` makes matrices of them as fmpq_mat does of rational numbers."""

    @property
    def matrix(self) -> Any: ...

    def value(self, entry: Polynomial) -> Any:
        """Its value, with an exact sign."""

    def settled(self, entry: Polynomial) -> Polynomial:
        """A polynomial with the same value there, which is zero if that is."""


@dataclass(frozen=True)
class RationalPoint:
    """Rational parameter values {index of the generator: value}."""

    point: Mapping[int, Fraction]
    _known: dict[int, tuple[Any, ...]] = field(default_factory=dict, repr=False)

    @property
    def matrix(self) -> Any:
        return fmpq_mat

    def value(self, entry: Polynomial) -> Any:
        """Raises ValueError where a parameter that occurs has no value."""
        if entry.is_constant():
            return fmpq(entry.leading_coefficient()) if entry else fmpq(0)
        context = entry.context()
        missing = [i for i in occurring([entry]) if i not in self.point]
        if missing:
            raise ValueError(f"no value for {', '.join(context.names()[i] for i in missing)}")
        return fmpq(entry(*self._of(context.nvars())))

    def _of(self, count: int) -> tuple[Any, ...]:
        """Values of all generators, 0 for those that do not occur."""
        if count not in self._known:
            self._known[count] = tuple(rational(self.point.get(i, 0)) for i in range(count))
        return self._known[count]

    def settled(self, entry: Polynomial) -> Polynomial:
        return entry.context().constant(self.value(entry))


def state_at(system: LinearSystem, at: ExactPoint, matrices: Sequence[Numbers] = ()) -> Numbers:
    """A of x' = A x there, by its ``matrices`` if they are known.  Raises ZeroDivisionError where M is singular."""
    m, d, g, k, n = matrices or [evaluated(matrix, at) for matrix in system.matrices]
    return state_matrix(at.matrix, m.tolist(), (d + g).tolist(), (k + n).tolist(), system.following)


def evaluated(matrix: Matrix, at: ExactPoint) -> Numbers:
    """A matrix of polynomials at a point."""
    return at.matrix(len(matrix), len(matrix[0]), [at.value(entry) for row in matrix for entry in row])


def is_positive(matrix: Numbers) -> bool:
    """Whether a symmetric rational matrix is positive definite: all leading minors are positive."""
    return all(minor > 0 for minor in leading_determinants(fmpq_mat, matrix.tolist()))


def _no(matrix: Numbers) -> bool:
    return all(x == 0 for x in matrix.entries())
