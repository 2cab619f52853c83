"""The first Lyapunov coefficient on a curve of parameters on which one pair of roots is imaginary, as a formula.

det(lambda - A) = E(lambda^2) + lambda O(lambda^2).  Where E and O have one common root -w^2, and no more,

    resultant(E, O) = 0,      their first subresultant  S1 mu + S0  has that root:  w^2 = S0/S1,   S1 != 0

which is a fraction of polynomials in the parameters; a of r' = a r^3 then is one on that curve, too (``centre``).  As
long as S1, det A, and top and bottom of a do not vanish on a piece of the curve, a has one sign there and no root
crosses the imaginary axis.

Source: L. Orlando (Gantmacher, The Theory of Matrices, chapter XV); Yu. A. Kuznetsov, Elements of Applied Bifurcation
Theory, section 5.4.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.matrices import determinant_by_traces, faddeev
from mbsym.algebra.tower import Element, Tower
from mbsym.algebra.truncated import Truncated
from mbsym.problems.normal_forms.centre import matrix_of, on_pair
from mbsym.problems.normal_forms.exact import trimmed


@dataclass(frozen=True)
class OnCurve:
    """``resultant``, ``slope`` S1, ``constant`` det(-A), ``coefficient`` a: fractions in the tower's parameters.

    ``coefficient`` holds where ``resultant`` is zero and the others are not; r is the amplitude of ``amplitude_of``.
    """

    resultant: Element
    slope: Element
    constant: Element
    coefficient: Element
    amplitude_of: str


def on_curve(
    tower: Tower, field: Sequence[Truncated], positions: Sequence[str], size: Callable[[Element], float]
) -> OnCurve:
    """``size``: how large an element is at a point of the curve, so that nothing is divided by that vanishes there.

    Raises SingularPoint where a divisor vanishes all along, NoClosedForm where formulas outgrow their budget.
    """
    coefficients = faddeev(matrix_of(field), tower.zero, tower.one)[1]
    even, odd = trimmed(coefficients[::2]), trimmed(coefficients[1::2])
    resultant = subresultant(tower, even, odd, 0)[0]
    constant, slope = _linear(tower, even, odd)
    root = tower.square_root(-constant / slope)
    found = on_pair(field, root, tower.reciprocal, size)
    j = max(range(len(positions)), key=lambda k: size(found.lengths[k]))
    real = (found.cubic + tower.conjugate(found.cubic, tower.place(root))) / 2
    return OnCurve(resultant, slope, coefficients[0], real / (found.lengths[j] * 4), positions[j])


def _linear(tower: Tower, even: Sequence[Element], odd: Sequence[Element]) -> list[Element]:
    """S0, S1.  Raises SingularPoint where a common root is never alone: one is a constant, the other not linear."""
    degrees = len(even) - 1, len(odd) - 1
    if degrees == (1, 0):
        return list(even)  # the constant vanishes on the curve
    if min(degrees) < 1:
        raise SingularPoint("the even and the odd part of the polynomial have no common root that is alone")
    if min(degrees) == 1:
        return list(odd if degrees[1] == 1 else even)
    return subresultant(tower, even, odd, 1)


def subresultant(tower: Tower, p: Sequence[Element], q: Sequence[Element], j: int) -> list[Element]:
    """The j-th subresultant of two polynomials (low to high), j + 1 coefficients: of degree j where gcd has degree j.

    Determinants of the rows x^(n-j-1) p ... p, x^(m-j-1) q ... q: the last column is that of the power x^i.  j is 0,
    or less than both degrees.
    """
    m, n = len(p) - 1, len(q) - 1
    rows = [_shifted(tower, p, k, m + n - j) for k in reversed(range(n - j))]
    rows += [_shifted(tower, q, k, m + n - j) for k in reversed(range(m - j))]
    size = m + n - 2 * j
    found = []
    for i in range(j + 1):
        columns = [*(m + n - j - 1 - k for k in range(size - 1)), i]
        table = [[row[c] for c in columns] for row in rows]
        found.append(determinant_by_traces(table, tower.zero, tower.one))
    return found


def _shifted(tower: Tower, p: Sequence[Element], by: int, length: int) -> list[Element]:
    row = [tower.zero] * by + list(p)
    return row + [tower.zero] * (length - len(row))
