"""What happens to equilibria at a singular point of their curve, named by exact tests of derivatives.

At a point with f(q, p) = 0 and a null space of df/dq of dimension one, spanned by v (and w on the left), Lyapunov and
Schmidt's reduction leaves one equation g(y, p) = 0.  Its derivatives at the point are

    g_p   = w.f_p                              g_yy  = w.f_qq[v, v]
    g_yp  = w.(f_qp v + f_qq[v, q_p])          g_pp  = w.(f_pp + 2 f_qp q_p + f_qq[q_p, q_p])
    g_yyy = w.(f_qqq[v, v, v] + 3 f_qq[v, q_yy])

with  f_q q_p = -f_p  and  f_q q_yy = -f_qq[v, v]  wherever they are used (their right sides are orthogonal to w then).

* g_p != 0, g_yy != 0: a fold.  g = 0 is p = -g_yy y^2 / (2 g_p) + ...: two equilibria on one side, none on the other.
* g_p != 0, g_yy = 0, g_yyy != 0: one equilibrium on both sides (the branch turns steep, and goes on).
* g_p = 0, g_yy != 0, g_yp^2 > g_yy g_pp: transcritical, two curves cross; < : an isolated point.
* g_p = 0, g_yy = 0, g_yp != 0, g_yyy != 0: a pitchfork, three on the side where g_yp p / g_yyy < 0, one on the other.

(Golubitsky & Schaeffer, Singularities and Groups in Bifurcation Theory I, ch. II and IV.)  Anything else is not named.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq_poly

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.characteristic import characteristic_polynomial, discriminant, hurwitz_minors
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.matrices import ScalarMatrix, echelon, null_space
from mbsym.algebra.polynomial_systems import Residues
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message, Told
from mbsym.maps.branches_curve import Curve, CurvePoint, CurvePoints, joined
from mbsym.maps.result import Cell
from mbsym.problems.relative_equilibria.equilibria import _ChartSearch
from mbsym.problems.relative_equilibria.verdict import LinearAtRest
from mbsym.problems.stability.enclosed import blocks
from mbsym.problems.stability.words import LAGRANGE, ROUTH

Element = Any  # a flint.fmpq_poly: an element of a number field


class Event(Told):
    """What a point of the curve is at a critical value."""

    REGULAR = "goes on"
    FOLD = "fold"
    STEEP = "vertical tangent"
    TRANSCRITICAL = "transcritical", "transcritical point"
    ISOLATED = "isolated point"
    PITCHFORK = "pitchfork"
    CONTINUUM = "continuum", "infinitely many equilibria at one value"
    DEGENERATE = "degenerate, not named", "degenerate point, not named"


#: Of the events that are named: how many equilibria near the point on the side with fewer, and with more.
SIDES = {
    Event.REGULAR: (1, 1),
    Event.FOLD: (0, 2),
    Event.STEEP: (1, 1),
    Event.TRANSCRITICAL: (2, 2),
    Event.ISOLATED: (0, 0),
    Event.PITCHFORK: (1, 3),
}


_OF_ONE_BRANCH = frozenset({Event.REGULAR, Event.FOLD, Event.STEEP})


@dataclass(frozen=True)
class Named:
    """``below`` and ``above``: equilibria near the point at smaller and larger values of the parameter; None: unknown.

    ``derivatives``: enclosures (midpoints) of those that decided, by name.
    """

    event: Event
    below: int | None
    above: int | None
    derivatives: tuple[tuple[str, float], ...] = ()


def named(point: CurvePoint) -> Named:
    """The event at a point of a curve; DEGENERATE where the tests above do not tell."""
    try:
        event = _Reduction(point).named()
    except Failure:
        return _unnamed()
    # Where several branches meet, constraints that follow from others may hold on some of them only.
    return event if not point.curve.redundant or event.event in _OF_ONE_BRANCH else _unnamed()


def _unnamed() -> Named:
    return Named(Event.DEGENERATE, None, None)


class _Unknown(Failure):
    """A derivative that is not known in the number field."""


class _Reduction:
    """The derivatives of the reduced equation at one point."""

    def __init__(self, point: CurvePoint) -> None:
        self.curve: Curve = point.curve
        self.place, self.modulus = point.place, point.place.modulus
        self.field = Residues(self.modulus)
        self.names, self.ring = self.curve.names, self.curve.ring
        self.slopes = [[self.value(x) for x in row] for row in self.curve.slopes]

    def value(self, x: Polynomial) -> Element:
        element = self.place.residue(x)
        if element is None:
            raise _Unknown("a derivative outside of the number field")
        return element

    def sign(self, x: Element) -> int:
        """Exact: 0 only where the element vanishes."""
        if x == 0:
            return 0
        ball = self.place.enclose(x)
        if ball.contains(0):
            raise _Unknown("the sign of a derivative is not found at this precision")
        return 1 if ball > 0 else -1

    def named(self) -> Named:
        n = len(self.names)
        right = null_space(self.field, self.slopes, n)
        if not right:
            return Named(Event.REGULAR, 1, 1)
        if len(right) > 1:
            return _unnamed()
        self.v = right[0]
        self.w = null_space(self.field, list(zip(*self.slopes, strict=True)), n)[0]
        by_p = [self.value(self.curve.along(x)) for x in self.curve.forcing]
        g_p, g_yy = self.field.dot(self.w, by_p), self.field.dot(self.w, self.second(self.v, self.v))
        first, curved = self.sign(g_p), self.sign(g_yy)
        coefficients = [("g_p", g_p), ("g_yy", g_yy)]
        if first and curved:
            more_above = first * curved < 0
            return self.found(Event.FOLD, more_above, coefficients)
        if not first:
            q_p = self.solved([-x for x in by_p])
            g_yp = self.field.dot(self.w, self.mixed(self.v)) + self.field.dot(self.w, self.second(self.v, q_p))
        if not first and curved:
            g_pp = self.field.dot(self.w, self.twice_by_p())
            g_pp += 2 * self.field.dot(self.w, self.mixed(q_p)) + self.field.dot(self.w, self.second(q_p, q_p))
            split = self.sign((g_yp * g_yp - g_yy * g_pp) % self.modulus)
            coefficients += [("g_yp", g_yp % self.modulus), ("g_pp", g_pp % self.modulus)]
            if split:
                return self.found(Event.TRANSCRITICAL if split > 0 else Event.ISOLATED, True, coefficients)
            return _unnamed()
        q_yy = self.solved([-x for x in self.second(self.v, self.v)])
        g_yyy = self.field.dot(self.w, self.third()) + 3 * self.field.dot(self.w, self.second(self.v, q_yy))
        cubic = self.sign(g_yyy % self.modulus)
        coefficients.append(("g_yyy", g_yyy % self.modulus))
        if first:
            return self.found(Event.STEEP, True, coefficients) if cubic else _unnamed()
        crossing = self.sign(g_yp % self.modulus)
        coefficients.append(("g_yp", g_yp % self.modulus))
        return self.found(Event.PITCHFORK, crossing * cubic < 0, coefficients) if crossing and cubic else _unnamed()

    def found(self, event: Event, more_above: bool, coefficients: Sequence[tuple[str, Element]]) -> Named:
        few, many = SIDES[event]
        below, above = (few, many) if more_above else (many, few)
        return Named(event, below, above, tuple((name, float(self.place.enclose(x).mid())) for name, x in coefficients))

    # --- derivatives ---

    def second(self, a: Sequence[Element], b: Sequence[Element]) -> list[Element]:
        """f_qq[a, b]."""
        ring, total = self.ring, []
        for row in self.curve.slopes:
            parts = [
                self.value(ring.derivative(x, name)) * a[i] % self.modulus * b[j] % self.modulus
                for i, x in enumerate(row)
                if a[i] != 0
                for j, name in enumerate(self.names)
                if b[j] != 0
            ]
            total.append(sum(parts, fmpq_poly([0])))
        return total

    def third(self) -> list[Element]:
        """f_qqq[v, v, v]."""
        ring, v, total = self.ring, self.v, []
        active = [(i, name) for i, name in enumerate(self.names) if v[i] != 0]
        for row in self.curve.slopes:
            parts = [fmpq_poly([0])]
            for i, _ in active:
                for j, second in active:
                    x = ring.derivative(row[i], second)
                    for k, third in active:
                        weight = v[i] * v[j] % self.modulus * v[k] % self.modulus
                        parts.append(self.value(ring.derivative(x, third)) * weight % self.modulus)
            total.append(sum(parts, fmpq_poly([0])))
        return total

    def mixed(self, a: Sequence[Element]) -> list[Element]:
        """f_qp a."""
        return [self.field.dot([self.value(self.curve.along(x)) for x in row], a) for row in self.curve.slopes]

    def twice_by_p(self) -> list[Element]:
        """f_pp."""
        return [self.value(self.curve.along(self.curve.along(x))) for x in self.curve.forcing]

    # --- linear algebra in the number field ---

    def solved(self, right: Sequence[Element]) -> list[Element]:
        """One solution of f_q x = right, which is orthogonal to w."""
        n = len(self.names)
        rows = [[*row, y] for row, y in zip(self.slopes, right, strict=True)]
        reduced, pivots = echelon(self.field, rows, n)
        elements = [fmpq_poly([0])] * n
        for row, column in zip(reduced, pivots, strict=False):
            elements[column] = row[n]
        return elements


# Where along a branch the verdict of problem 6 may change.
#
# The verdict is read off the inertia of K and the roots of  det(M s^2 + (D + G) s + K + N) = p_0 + p_1 s + ... ,  so on
# a stretch of a branch it is one and the same as long as none of these vanishes: p_0 (where it does the equilibrium is
# singular), and
#
# * the last but one Hurwitz minor, where the polynomial is not even;
# * the discriminant in s^2, where it is even and there are gyroscopic or circulatory forces.
#
# Where K is positive definite (or has an odd number of negative eigenvalues) at the sample it is so throughout, because
# det K vanishes nowhere between: verdicts that follow from that alone need no more.


#: More coordinates than this make polynomials that are not looked at.
MOST_COORDINATES = 4
#: Nor are polynomials of more terms.
MOST_TERMS = 4000

#: Theorems that use no more than the signs of M, D and K.
BY_INERTIA = frozenset({"Lagrange-Dirichlet", "Lagrange-Dirichlet, Routh", "Kelvin-Chetaev"})
#: Theorems that need an energy which does not grow.
BY_ENERGY = frozenset({LAGRANGE, ROUTH})


def stability_changes(curve: Curve) -> CurvePoints:
    """The points of the curve at which a condition of stability besides det K is an equality."""
    linear = curve.search._linear
    if isinstance(linear, str) or linear.varying:
        return CurvePoints((), (), False, ("no linear equations",))
    if linear.rest.rows:
        reason = Message("under constraints changes of stability are solved without damping and gyroscopic forces only")
        return CurvePoints((), (), False, () if _unforced(linear) else (reason,))
    try:
        conditions = _conditions(curve, linear)
    except Failure as reason:
        return CurvePoints((), (), False, (str(reason),))
    if conditions is None:
        return CurvePoints((), (), False, (f"more than {MOST_COORDINATES} coordinates, or polynomials too long",))
    changes = []
    for x in conditions:
        try:
            points = curve.where_on_components([x]) if curve.search.equations else None
            changes.append(curve.where([x]) if points is None or points.unfinished else points)
        except Failure as reason:
            changes.append(CurvePoints((), (), False, (str(reason),)))
    return joined(changes)


def _conditions(curve: Curve, linear: LinearAtRest) -> list[Polynomial] | None:
    """Polynomials in q and the parameter; None where they are too large."""
    ring = curve.ring
    if _unforced(linear):
        return []
    conditions: list[Polynomial] = []
    for indices in blocks(*linear.matrices):
        mass, damping, gyroscopic, stiffness, circulatory = (
            ScalarMatrix(ring, [[rows[i][j] for j in indices] for i in indices]) for rows in linear.matrices
        )
        if len(indices) > MOST_COORDINATES:
            return None
        raw = characteristic_polynomial(mass.rows, (damping + gyroscopic).rows, (stiffness + circulatory).rows)
        p = [ring.fraction(ring.reduce(x))[0] for x in raw] if _polynomial(curve, raw) else None
        if p is None:
            return None
        if p[0].is_zero():  # of displacements that nothing resists: what is left is not singular with det df/dq
            while p[0].is_zero():
                p = p[1:]
            conditions.append(p[0])
        if any(not x.is_zero() for x in p[1::2]):
            conditions += hurwitz_minors(p)[len(p) - 3 : len(p) - 2] if len(p) > 2 else []
        elif len(p) > 3:
            conditions.append(discriminant(p[::2]))
    conditions = [ring.reduce(x) for x in conditions]
    if any(x.is_zero() for x in conditions):
        raise NoClosedForm("roots are imaginary, or double, along a whole branch")
    return None if any(len(x) > MOST_TERMS for x in conditions) else [x for x in conditions if not x.is_constant()]


def _unforced(linear: LinearAtRest) -> bool:
    """Whether D, G and N vanish identically."""
    return all(x.is_zero() for k in (1, 2, 4) for row in linear.matrices[k] for x in row)


def _polynomial(curve: Curve, coefficients: object) -> bool:
    """Whether no coefficient divides by anything: numerators of different denominators do not fit together."""
    return all(not curve.ring.fraction(x)[1] for x in coefficients)  # type: ignore[attr-defined]


def decided_throughout(interval: Cell, number: int, solved: bool, undamped: bool, bounded: bool) -> bool:
    """Whether the verdict at the sample is proved for the whole interval.

    What terms of higher order or integrals decide at the sample is not: their conditions are not solved.

    ``solved``: all changes of stability are solved; ``undamped``: D = 0 everywhere, so that the inertia of K decides
    what Lagrange, Dirichlet, Kelvin and Chetaev's theorems say; ``bounded``: the energy grows for no value of the
    parameter, by forces of higher order neither.
    """
    if interval.counted is None or interval.certainty is not Certainty.PROVED:
        return False
    verdict = interval.counted.equilibria[number].verdict
    if verdict.word.open or verdict.beyond_linear or not (bounded or BY_ENERGY.isdisjoint(verdict.theorems)):
        return False
    return solved or (undamped and verdict.theorem in BY_INERTIA)


def is_bounded(search: _ChartSearch) -> bool:
    """Whether the energy grows for no value of the parameter."""
    linear = search._linear
    return not isinstance(linear, str) and linear.law.bounded


def is_undamped(search: _ChartSearch) -> bool:
    """Whether D and N vanish identically."""
    linear = search._linear
    if isinstance(linear, str):
        return False
    return all(x.is_zero() for k in (1, 4) for row in linear.matrices[k] for x in row)
