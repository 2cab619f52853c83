"""Verdicts of problem 6 at a point that is known by enclosures: algebraic numbers, or boxes with a certified root.

The theorems are those of ``words``; what is strict (a sign, a half-plane) is read off balls, and nothing is
claimed that a ball leaves open.  Two facts make purely imaginary roots provable.  Without dissipation and circulation
the spectrum of  M x'' + G x' + K x = 0  is symmetric about both axes: an isolated simple root whose ball meets the
imaginary axis has its mirror image -conj(lambda) in the same ball, so it lies on the axis.  And with G = 0 the roots
lambda^2 are real, so the signs of K's leading minors decide.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, acb_mat, arb, arb_mat, ctx

from mbsym.algebra.matrices import components, leading_determinants
from mbsym.algebra.roots import Root, enclosures
from mbsym.problems.stability.linear_form import state_matrix
from mbsym.problems.stability.verdict import Verdict, bounded, concluded, drifting, exactly, undecided
from mbsym.problems.stability.words import Because, Fact, Reason, Word, implied

Rows = Sequence[Sequence[Any]]  # flint.arb; an entry known to vanish is exactly 0


def enclosed_verdict(matrices: Sequence[Rows], conservative: bool, bits: int = 200, exact: bool = False) -> Verdict:
    """The verdict for M x'' + (D + G) x' + (K + N) x = 0 with entries in balls, matrices in the order M, D, G, K, N.

    ``conservative``: the nonlinear system has its energy integral; ``exact``: there is no nonlinear system, these are
    the equations of motion.  What the balls leave open is ``undecided``.
    """
    m, d, g, k, n = matrices
    with ctx.workprec(bits):
        verdict = _verdict(m, d, g, k, n, conservative, exact)
    return exactly(verdict) if exact else verdict


def enclosed_verdict_with_cyclic(
    parts: Sequence[Rows], conservative: bool, cyclic: tuple[int, ...], bits: int = 200, exact: bool = False
) -> Verdict:
    """By enclosures, cyclic coordinates ignored after Routh where their momenta are constant."""
    plain = enclosed_verdict(parts, conservative, bits, exact)
    if not cyclic or plain.word is Word.UNSTABLE or plain.coordinates_singular:
        return plain
    with ctx.workprec(bits):
        reduced = _ignoring_cyclic(parts, cyclic)
        if reduced is None:
            rest = _besides_positions(parts, cyclic)
            if rest is None or not all(root.real < 0 for root in rest):
                return undecided(Because.CYCLIC_ZERO_ROOTS)
            return drifting(concluded({Fact.ROOTS_LEFT}), constant_momenta=False)
    return drifting(enclosed_verdict(reduced, conservative, bits, exact))


def _besides_positions(parts: Sequence[Rows], cyclic: Sequence[int]) -> list[Any] | None:
    """The roots but one zero for each cyclic coordinate: nothing depends on its position, its column of A is zero."""
    m, d, g, k, n = parts
    whole = state_matrix(arb_mat, m, _sum(d, g), _sum(k, n))
    remaining = [i for i in range(whole.nrows()) if i not in cyclic]
    return spectrum(acb_mat([[whole[i, j] for j in remaining] for i in remaining]))[0]


def _ignoring_cyclic(parts: Sequence[Rows], cyclic: Sequence[int]) -> list[Rows] | None:
    """Routh's reduction with M_cc^-1 in balls; None where a momentum is not constant."""
    m, d, g, _, n = parts
    others = [i for i in range(len(m)) if i not in cyclic]
    acted_on = not all(_no([rows[i] for i in cyclic]) for rows in (d, n))
    if acted_on or not others or not _no([[g[i][j] for j in cyclic] for i in cyclic]):
        return None
    inverse = arb_mat(len(cyclic), len(cyclic), [m[i][j] for i in cyclic for j in cyclic]).inv()
    sizes = {True: others, False: list(cyclic)}

    def block(rows: Rows, free_rows: bool, free_columns: bool) -> Any:
        at, across = sizes[free_rows], sizes[free_columns]
        return arb_mat(len(at), len(across), [rows[i][j] for i in at for j in across])

    def less(rows: Rows, *pairs: tuple[Rows, Rows]) -> Rows:
        total = block(rows, True, True)
        for left, right in pairs:
            total = total - block(left, True, False) * inverse * block(right, False, True)
        reduced: Rows = total.tolist()
        return reduced

    return [less(m, (m, m)), less(d), less(g, (m, g), (g, m)), less(parts[3], (g, g)), less(n)]


def _verdict(m: Rows, d: Rows, g: Rows, k: Rows, n: Rows, conservative: bool, exact: bool) -> Verdict:
    if not all(x.is_finite() for rows in (m, d, g, k, n) for row in rows for x in row):
        return undecided(Because.NOT_ENCLOSED)
    if not _positive(m):
        return undecided(Because.MASS_SINGULAR)
    shown = {
        Fact.MASS_POSITIVE: True,
        Fact.UNDAMPED: _no(d),
        Fact.DAMPING_SEMIDEFINITE: conservative or _semidefinite(d),  # x'.D x' leads its loss
        Fact.DAMPING_POSITIVE: _positive(d),
        Fact.NOT_GYROSCOPIC: _no(g),
        Fact.POTENTIAL: _no(n),
        Fact.STIFFNESS_POSITIVE: _positive(k),
        Fact.ENERGY_NEVER_GROWS: conservative,
        Fact.EXACTLY_LINEAR: exact,
    }
    facts = frozenset(fact for fact, holds in shown.items() if holds)
    conservative = Fact.ENERGY_NEVER_GROWS in implied(facts)
    undamped = facts >= {Fact.UNDAMPED, Fact.POTENTIAL}
    if undamped and Fact.STIFFNESS_POSITIVE in facts:
        if not conservative:
            return concluded(facts | {Fact.BOUNDED}, Reason(Because.NO_ENERGY))
        return concluded(facts)
    if facts >= {Fact.POTENTIAL, Fact.DAMPING_POSITIVE, Fact.STIFFNESS_POSITIVE}:
        return concluded(facts)
    roots, simple = eigenvalues(m, _sum(d, g), _sum(k, n))
    if roots is None:
        return concluded(facts, why_not=Because.NOT_ENCLOSED)
    if any(bool(root.real > 0) for root in roots):
        return concluded({Fact.ROOT_RIGHT})
    if all(root.real < 0 for root in roots):
        return concluded(facts | {Fact.ROOTS_LEFT})
    if undamped and simple and not any(root.contains(0) for root in roots) and _mirrored(roots):
        if Fact.NOT_GYROSCOPIC in facts:  # then lambda^2 are the eigenvalues of -M^-1 K
            facts |= {Fact.STIFFNESS_POSITIVE}
            return concluded(facts) if conservative else concluded(facts | {Fact.BOUNDED}, Reason(Because.NO_ENERGY))
        if exact or _not_positive(k):
            return bounded(facts, Reason(Because.GYROSCOPIC_ENCLOSED))
    return concluded(facts, why_not=Because.NEAR_BORDER)


def _semidefinite(rows: Rows) -> bool:
    """Whether a symmetric matrix is positive semidefinite: positive definite but for rows that are exactly 0."""
    nonzero = [i for i, row in enumerate(rows) if not all(x == 0 for x in row)]
    return _positive([[rows[i][j] for j in nonzero] for i in nonzero])


def eigenvalues(m: Rows, c: Rows, k: Rows, following: Sequence[int] = ()) -> tuple[list[Any] | None, bool]:
    """(balls around all roots of M x'' + C x' + K x = 0, whether they are isolated from each other)."""
    return spectrum(acb_mat(state_matrix(arb_mat, m, c, k, following)))


def spectrum(first: Any) -> tuple[list[Any] | None, bool]:
    """(balls around all eigenvalues of a matrix, whether they are isolated from each other)"""
    try:
        return list(first.eig()), True
    except ValueError:
        pass
    try:
        return list(first.eig(multiple=True)), False
    except ValueError:
        return None, False


def _mirrored(roots: Sequence[Any]) -> bool:
    """Whether every root lies on the imaginary axis, for a spectrum that is symmetric about it."""
    return all(on_axis(root, roots) for root in roots)


def on_axis(root: Any, roots: Sequence[Any]) -> bool:
    """Whether an isolated root lies on the imaginary axis, for a spectrum that is symmetric about it."""
    image = -root.conjugate()
    return bool(root.overlaps(image)) and not any(image.overlaps(other) for other in roots if other is not root)


def _positive(rows: Rows) -> bool:
    return all(minor > 0 for minor in leading_determinants(arb_mat, rows))


def _not_positive(rows: Rows) -> bool:
    """Whether a symmetric matrix is certainly not positive definite."""
    return any(minor < 0 for minor in leading_determinants(arb_mat, rows))


def _no(rows: Rows) -> bool:
    return all(x == 0 for row in rows for x in row)


def _sum(a: Rows, b: Rows) -> list[list[Any]]:
    return [[arb(x) + arb(y) for x, y in zip(*rows, strict=True)] for rows in zip(a, b, strict=True)]


def blocks(*matrices: Rows) -> list[list[int]]:
    """Sets of indices between which every matrix has exact zeros only."""

    def coupled(i: int, j: int) -> bool:
        return not all(bool(rows[i][j] == 0) and bool(rows[j][i] == 0) for rows in matrices)

    return components(len(matrices[0]), coupled)


# Eigenvalues of the first approximation at numbers: the roots lambda of  det(lambda^2 M + lambda (D + G) + K + N) = 0.
#
# They are told in physical time (1/s if the description's values are in SI units), by certified enclosures.  They are
# for reading: verdicts and counts of problem 6 never rest on them.


#: Working precision of enclosures, in bits.
PRECISION = 128


@dataclass(frozen=True)
class Spectrum:
    """The eigenvalues of one subsystem; sorted by real, then imaginary part."""

    coordinates: tuple[str, ...]
    roots: tuple[Root, ...]


def from_characteristic(coordinates: Sequence[str], characteristic: Sequence[Any], scale: Any) -> Spectrum:
    """From the exact polynomial (coefficients low to high) in lambda/scale, tau = scale t."""
    roots = enclosures(characteristic, PRECISION)
    return Spectrum(tuple(coordinates), tuple(Root(_times(x.ball, scale), x.multiplicity) for x in roots))


def from_matrices(coordinates: Sequence[str], parts: Sequence[Rows], following: Sequence[int] = ()) -> Spectrum | None:
    """From M, D, G, K, N in balls; None where M is singular or the roots cannot be enclosed.

    Roots that lie together are listed one by one.
    """
    m, d, g, k, n = parts
    size = range(len(coordinates))
    velocity, position = ([[x[i][j] + y[i][j] for j in size] for i in size] for x, y in ((d, g), (k, n)))
    try:
        with ctx.workprec(PRECISION):
            roots, _ = eigenvalues(m, velocity, position, following)
    except ZeroDivisionError:
        return None
    if roots is None:
        return None
    roots.sort(key=lambda ball: (float(ball.real.mid()), float(ball.imag.mid())))
    return Spectrum(tuple(coordinates), tuple(Root(ball, 1) for ball in roots))


def _times(ball: acb, scale: Any) -> acb:
    with ctx.workprec(PRECISION):
        return ball * scale


@dataclass(frozen=True)
class RootNumbers:
    """A root, or a pair of conjugate ones (``imaginary`` > 0), as numbers; a part that may be 0 is 0."""

    real: float
    imaginary: float
    multiplicity: int


def numbers(spectrum: Spectrum) -> tuple[RootNumbers, ...]:
    """Pairs of conjugate roots once, by their upper half."""
    upper_roots = []
    for root in spectrum.roots:
        real, imaginary = (0.0 if part.contains(0) else float(part.mid()) for part in (root.ball.real, root.ball.imag))
        if imaginary >= 0:
            upper_roots.append(RootNumbers(real, imaginary, root.multiplicity))
    return tuple(upper_roots)
