"""Where along a branch the verdict of problem 6 may change.

The verdict is read off the inertia of K and the roots of  det(M s^2 + (D + G) s + K + N) = p_0 + p_1 s + ... ,  so on a
stretch of a branch it is one and the same as long as none of these vanishes: p_0 (where it does the equilibrium is
singular), and

* the last but one Hurwitz minor, where the polynomial is not even;
* the discriminant in s^2, where it is even and there are gyroscopic or circulatory forces.

Where K is positive definite (or has an odd number of negative eigenvalues) at the sample it is so throughout, because
det K vanishes nowhere between: verdicts that follow from that alone need no more.
"""

from __future__ import annotations

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import characteristic_polynomial, discriminant, hurwitz_minors
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import ScalarMatrix
from mbsym.algebra.ring import Polynomial
from mbsym.maps.branches_curve import Curve, CurvePoints, joined
from mbsym.maps.result import Cell
from mbsym.problems.relative_equilibria.equilibria import _ChartSearch
from mbsym.problems.relative_equilibria.verdict import LinearAtRest

#: More coordinates than this make polynomials that are not looked at.
MOST_COORDINATES = 4
#: Nor are polynomials of more terms.
MOST_TERMS = 4000

#: Theorems that use no more than the signs of M, D and K.
BY_INERTIA = frozenset({"Lagrange-Dirichlet", "Lagrange-Dirichlet, Routh", "Kelvin-Chetaev"})


def stability_changes(curve: Curve) -> CurvePoints:
    """The points of the curve at which a condition of stability besides det K is an equality."""
    linear = curve.search._linear
    if isinstance(linear, str) or linear.varying:
        return CurvePoints((), (), False, ("no linear equations",))
    try:
        conditions = _conditions(curve, linear)
    except Failure as reason:
        return CurvePoints((), (), False, (str(reason),))
    if conditions is None:
        return CurvePoints((), (), False, (f"more than {MOST_COORDINATES} coordinates, or polynomials too long",))
    found = []
    for x in conditions:
        try:
            one = curve.where_on_components([x])
            found.append(curve.where([x]) if one.unfinished else one)
        except Failure as reason:
            found.append(CurvePoints((), (), False, (str(reason),)))
    return joined(found)


def _conditions(curve: Curve, linear: LinearAtRest) -> list[Polynomial] | None:
    """Polynomials in q and the parameter; None where they are too large."""
    ring = curve.ring
    mass, damping, gyroscopic, stiffness, circulatory = (
        ScalarMatrix(ring, [list(row) for row in rows]) for rows in linear.matrices
    )
    if len(mass.rows) > MOST_COORDINATES:
        return None
    free = all(x.is_zero() for m in (damping, gyroscopic, circulatory) for row in m.rows for x in row)
    if free:
        return []
    raw = characteristic_polynomial(mass.rows, (damping + gyroscopic).rows, (stiffness + circulatory).rows)
    p = [ring.fraction(ring.reduce(x))[0] for x in raw] if _polynomial(curve, raw) else None
    if p is None:
        return None
    while p and p[0].is_zero():
        p = p[1:]
    if len(p) < 3:
        return []
    found: list[Polynomial] = []
    if any(not x.is_zero() for x in p[1::2]):
        found.append(hurwitz_minors(p)[len(p) - 3])
    elif len(p) > 3:
        found.append(discriminant(p[::2]))
    found = [ring.reduce(x) for x in found]
    return None if any(len(x) > MOST_TERMS for x in found) else [x for x in found if not x.is_constant()]


def _polynomial(curve: Curve, coefficients: object) -> bool:
    """Whether no coefficient divides by anything: numerators of different denominators do not fit together."""
    return all(not curve.ring.fraction(x)[1] for x in coefficients)  # type: ignore[attr-defined]


def decided_throughout(interval: Cell, number: int, solved: bool, undamped: bool) -> bool:
    """Whether the verdict at the sample is proved for the whole interval.

    ``solved``: all changes of stability are solved; ``undamped``: D = 0 everywhere, so that the inertia of K decides
    what Lagrange, Dirichlet, Kelvin and Chetaev's theorems say.
    """
    if interval.counted is None or interval.certainty is not Certainty.PROVED:
        return False
    verdict = interval.counted.equilibria[number].verdict
    if verdict.word.open:
        return False
    return solved or (undamped and verdict.theorem in BY_INERTIA)


def is_undamped(search: _ChartSearch) -> bool:
    """Whether D and N vanish identically."""
    linear = search._linear
    if isinstance(linear, str):
        return False
    return all(x.is_zero() for k in (1, 4) for row in linear.matrices[k] for x in row)
