"""Verdicts on steady motions of nonholonomic systems by their roots; of rests ``analysis.families`` may say more.

The first approximation has no Hamiltonian structure: where no force does work its roots need not be symmetric about
the imaginary axis (a bicycle, a sleigh), K > 0 proves nothing, and gyroscopic stabilisation has no meaning.  What holds
is Lyapunov's first method; and, as steady motions come in families, along which roots are zero, the theorem of Lyapunov
and Malkin: with as many zero roots as the family has dimensions and all others to the left, the motion is stable, and
what is disturbed tends to a steady motion near by.  Where the velocities follow one position along every motion, a
pair of imaginary roots beside the zero ones is a centre.

Sources: J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems (1972), chapter V; A. V. Karapetyan, J. Appl.
Math. Mech. 44 (1980) 295; I. G. Malkin, Theory of Stability of Motion, section 34.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from flint import acb_poly, arb, arb_mat, ctx

from mbsym.algebra.roots import counted
from mbsym.problems.stability.linear_form import NonholonomicForm, state_matrix
from mbsym.problems.stability.verdict import Verdict, bounded, concluded, drifting, undecided
from mbsym.problems.stability.words import Because, Fact, Reason, Word

#: What is concluded where roots are imaginary and simple.
OPEN = (Reason(Because.IMAGINARY_NONHOLONOMIC), Reason(Because.HIGHER_ORDER))


def one_oscillates(form: NonholonomicForm) -> Verdict:
    """The verdict where velocities follow one position and the pair of roots that is its, if any, is imaginary."""
    verdict = concluded({Fact.ONE_POSITION, Fact.BOUNDED}, *(() if form.pairs else (Reason(Because.FOLLOWING),)))
    return drifting(verdict, constant_momenta=False) if form.drifts else verdict


def all_left(form: NonholonomicForm, zeros: int) -> Verdict:
    """The verdict where all roots are to the left but ``zeros`` of them, those of idle coordinates not counted."""
    if form.open_names:
        return undecided(Because.NOT_CLOSED, ", ".join(form.open_names))
    if zeros == 0 == form.family and not form.drifts:
        return concluded({Fact.ROOTS_LEFT})
    if zeros == form.family:
        return concluded({Fact.LEFT_BUT_STEADY})
    return undecided(Because.MORE_ZERO_ROOTS, zeros, form.family)


def besides_outside(form: NonholonomicForm, verdict: Verdict, zeros: int) -> Verdict:
    """A verdict on exactly linear equations, where coordinates in none of them may drift away.

    x1' = -a x2: where x2 stays near a place that is not zero, or ends there, x1 grows with the time.  Without
    ``zeros``, roots that are zero, there is none: x' = A x has the integral A^-1 x.  Where x2 drifts x1' may grow.
    """
    if not (form.outside and zeros and verdict.stable):
        return verdict
    if verdict.word is Word.STABLE_BUT_CYCLIC:
        return undecided(Because.JORDAN_BLOCK)
    return drifting(bounded({Fact.EXACTLY_LINEAR}), constant_momenta=False)


def at_rationals(form: NonholonomicForm, first_order: Any) -> Verdict:
    """The exact verdict; ``first_order`` is the exact matrix of ``state_matrix``."""
    size = first_order.nrows()
    remaining = [i for i in range(size) if i not in form.idle]
    entries = first_order.tolist()
    reduced = type(first_order)(len(remaining), len(remaining), [entries[i][j] for i in remaining for j in remaining])
    roots = counted(reduced.charpoly())
    if roots.right:
        return concluded({Fact.ROOT_RIGHT}, Reason(Because.RIGHT_ROOTS, (roots.right,)))
    if form.pairs is not None and roots.imaginary == 2 * form.pairs == roots.degree - roots.zero:
        return one_oscillates(form)
    if roots.left + roots.zero == roots.degree and (roots.zero == form.family or form.drifts):
        return all_left(form, roots.zero)
    blocks = counted(reduced.minpoly())
    if max(blocks.imaginary_multiplicity, blocks.zero) > 1:
        return undecided(Because.JORDAN_BLOCK)
    if roots.zero > form.family:
        why = Reason(Because.MORE_ZERO_ROOTS, (roots.zero, form.family))
        return undecided(why.code, *why.data) if form.drifts else concluded({Fact.BOUNDED}, why)
    return concluded({Fact.BOUNDED}, *OPEN)


def enclosed(
    form: NonholonomicForm, matrices: Sequence[Any], zero_power: int, bits: int, even: bool = False, exact: bool = False
) -> Verdict:
    """The verdict with entries in balls, M, D, G, K, N.

    Known in symbols are ``zero_power`` of the determinant, and whether the rest is ``even`` in lambda: then simple
    negative roots in lambda^2 are imaginary pairs, and zero roots, if they are those of the family, have no blocks.
    ``exact``: there is no nonlinear system, these are the equations of motion.
    """
    with ctx.workprec(bits):
        size = len(matrices[0])
        m, d, g, k, n = (arb_mat(size, size, [x for row in rows for x in row]) for rows in matrices)
        try:
            first = state_matrix(arb_mat, m.tolist(), (d + g).tolist(), (k + n).tolist(), form.following)
        except ZeroDivisionError:
            return undecided(Because.MASS_SINGULAR)
        coefficients = [arb(x) for x in first.charpoly().coeffs()[zero_power:]]
        right = to_the_right(coefficients)
        if form.pairs is not None and len(coefficients) == 2 * form.pairs + 1 and _negative(coefficients[::2]):
            return one_oscillates(form)
        if even and form.zeros(zero_power) in (0, form.family) and _negative(coefficients[::2]):
            return bounded({Fact.EXACTLY_LINEAR} if exact else set(), *OPEN)
    if right is None and any(x < 0 for x in coefficients):  # the leading one is 1: not all roots are on this side
        return concluded({Fact.ROOT_RIGHT})
    if right is None:
        return undecided(Because.NEAR_BORDER)
    if right:
        return concluded({Fact.ROOT_RIGHT}, Reason(Because.RIGHT_ROOTS, (right,)))
    return all_left(form, form.zeros(zero_power))


def _negative(coefficients: Sequence[arb]) -> bool:
    """Whether all roots of a real polynomial are shown to be real, simple and negative."""
    try:
        roots = acb_poly(coefficients).roots()
    except ValueError:  # not isolated
        return False
    real = all(not any(x.conjugate().overlaps(y) for y in roots if y is not x) for x in roots)
    return real and all(x.real < 0 for x in roots)


def to_the_right(coefficients: Sequence[arb]) -> int | None:
    """How many roots have a positive real part, by Routh's scheme, the other ones a negative one.

    None where a ball leaves the sign of a leading element open: sharper than balls around the roots themselves, whose
    radius is that of their isolation.
    """
    upper, lower = list(coefficients[::-1][::2]), list(coefficients[::-1][1::2])
    signs = []
    for _ in coefficients:
        if not (upper[0] > 0 or upper[0] < 0):
            return None
        signs.append(bool(upper[0] > 0))
        if not lower:
            break
        if not (lower[0] > 0 or lower[0] < 0):
            return None
        ratio = upper[0] / lower[0]
        padded = [*lower[1:], arb(0)]
        following = [x - ratio * y for x, y in zip(upper[1:], padded, strict=False)]
        upper, lower = lower, following
    return sum(a != b for a, b in pairwise(signs))
