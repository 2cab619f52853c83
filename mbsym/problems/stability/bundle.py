"""Chetaev's method: a combination of first integrals with a definite second variation.

Let I_1, ..., I_m be integrals of the motions near a steady one, as functions of the variables z that are constant on it
(angles that turn, and others that the equations do not know, are left out).  If multipliers exist with

    sum mu_k dI_k = 0    and    v . (sum mu_k d^2 I_k) v > 0    for all v != 0 with dI_1 . v = ... = dI_m . v = 0

then V = sum mu_k (I_k - c_k) + N sum (I_k - c_k)^2, with a large enough N, is an integral with a strict minimum
(Finsler's lemma): the motion is stable with respect to z, in the nonlinear system.  With the energy alone this is
Lagrange's theorem, with cyclic momenta Routh's; with the angular momentum of a free body (a Casimir function of the
reduced system) it decides the spins about its largest and smallest axis, with the momentum about a top's own axis the
sleeping top.  Where z is only a part of the variables it is stability with respect to that part (Rumyantsev).

Nothing follows where no combination is definite.

The multipliers that annul the first variation are found exactly, in the number field of the motion; which of them make
the second one definite is looked for in floating point and then proved with enclosures.

Sources: N. G. Chetaev, Stability of Motion (1946); V. V. Rumyantsev's papers on the stability of steady motions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations, pairwise
from typing import Any

from flint import acb_poly, arb, arb_mat, fmpq, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NOT_THERE, Failure, NotRational
from mbsym.algebra.matrices import leading_determinants, null_space
from mbsym.algebra.polynomial_systems import Residues
from mbsym.algebra.rationals import rounded
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, enumerated, worded
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.programs import programs
from mbsym.mechanics.symmetry import is_free_about_the_origin
from mbsym.problems import equations as lagrange
from mbsym.problems import integrals as first_integrals
from mbsym.problems.energy import Energy
from mbsym.problems.integrals import ENERGIES, Integral
from mbsym.problems.stability.verdict import Extremum, Verdict, by_extremum, concluded, drifting
from mbsym.problems.stability.words import Because, Fact, Reason

Element = Any  # flint.fmpq_poly, an element of QQ[t]/modulus
Rows = Sequence[Sequence[Element]]

#: Directions that are tried where more than two multipliers are free.
ATTEMPTS = 60

#: So many turns of a pencil of two forms are tried, for one that is far from singular.
_TURNS = 16


class NumberField(Residues):
    """QQ[t]/modulus with one real root of the modulus; ``enclose`` gives a ball around an element there."""

    def __init__(self, modulus: Any, enclose: Callable[[Element], Any]) -> None:
        super().__init__(modulus)
        self.enclose = enclose


def definite_combination(gradients: Rows, hessians: Sequence[Rows], field: NumberField) -> tuple[Any, ...] | None:
    """Multipliers mu (balls) of a combination as above, or None where none was found and proved.

    ``gradients`` m x N, ``hessians`` m times N x N.  Zeros where the integrals alone determine all of z.
    """
    count, size = len(gradients), len(gradients[0])
    tangent = null_space(field, gradients, size)
    if not tangent:
        return (arb(0),) * count
    annulling = null_space(field, [[gradients[k][i] for k in range(count)] for i in range(size)], count)
    if not annulling:
        return None
    restricted = [_restricted(hessian, tangent, field) for hessian in hessians]
    forms = []
    for multipliers in annulling:
        total = [[fmpq_poly([0])] * len(tangent) for _ in tangent]
        for factor, rows in zip(multipliers, restricted, strict=True):
            total = [
                [a + field.times(factor, b) for a, b in zip(*pair, strict=True)]
                for pair in zip(total, rows, strict=True)
            ]
        forms.append([[field.enclose(x % field.modulus) for x in row] for row in total])
    weights = definite_combination_of(forms)
    if weights is None:
        return None
    return tuple(
        sum((field.enclose(vector[k]) * w for vector, w in zip(annulling, weights, strict=True)), arb(0))
        for k in range(count)
    )


def _restricted(hessian: Rows, tangent: Rows, field: NumberField) -> list[list[Element]]:
    """The values v_i . H v_j for the vectors of ``tangent``."""
    images = [[field.dot(row, v) for row in hessian] for v in tangent]
    return [[field.dot(v, image) for image in images] for v in tangent]


def definite_combination_of(forms: Sequence[Sequence[Sequence[Any]]]) -> list[fmpq] | None:
    """Rational weights w such that sum w_j forms_j is proved to be positive definite."""
    import numpy as np

    tables = [np.array([[float(x.mid()) for x in row] for row in form]) for form in forms]
    if not all(np.isfinite(table).all() for table in tables):
        return None
    sizes = [float(np.abs(table).max()) or 1.0 for table in tables]
    for direction in _directions([table / size for table, size in zip(tables, sizes, strict=True)]):
        for digits in (3, 8, 14):
            weights = [rounded(x / size, digits) for x, size in zip(direction, sizes, strict=True)]
            if _is_positive(forms, weights):
                return weights
    return None


def _directions(tables: Sequence[Any]) -> list[list[float]]:
    """Directions w in which sum w_j tables_j seems to be positive definite; for at most two tables all there are."""
    import numpy as np

    if len(tables) == 1:
        return [[1.0], [-1.0]]
    if len(tables) == 2:
        return [list(w) for w in _in_plane(tables[0], tables[1])]
    source = np.random.default_rng(1)
    best = source.standard_normal(len(tables))
    for _ in range(ATTEMPTS):
        other = source.standard_normal(len(tables))
        pencil = [sum(x * t for x, t in zip(w, tables, strict=True)) for w in (best, other)]
        weights = _in_plane(pencil[0], pencil[1], best_only=True)
        best = weights[0][0] * best + weights[0][1] * other
        best = best / np.linalg.norm(best)
        if np.linalg.eigvalsh(sum(x * t for x, t in zip(best, tables, strict=True)))[0] > 1e-9:
            return [[float(x) for x in best]]
    return []


def _in_plane(a: Any, b: Any, best_only: bool = False) -> list[tuple[float, float]]:
    """(cos x, sin x) in the middle of every interval in which a cos x + b sin x is positive definite.

    The intervals end where its determinant vanishes.  ``best_only``: wherever its least eigenvalue is greatest.
    """
    import numpy as np

    def at(x: float) -> Any:
        return a * math.cos(x) + b * math.sin(x)

    # The pencil is turned to where it is farthest from singular: singular at x + y is then -cot y an eigenvalue.
    angle = max((math.pi * k / _TURNS for k in range(_TURNS)), key=lambda x: min(abs(np.linalg.eigvalsh(at(x)))))
    borders = {0.0, math.pi / 2}
    try:
        eigenvalues = np.linalg.eigvals(np.linalg.solve(at(angle), at(angle + math.pi / 2)))
    except np.linalg.LinAlgError:  # singular everywhere: no combination is definite
        eigenvalues = np.array([])
    for root in eigenvalues:
        if abs(root.imag) <= 1e-7 * (1 + abs(root)) ** 2:
            borders.add((angle + math.atan2(1.0, -root.real)) % math.pi)
    ordered = sorted(borders)
    ends = [*ordered, *(x + math.pi for x in ordered), ordered[0] + 2 * math.pi]
    middles = [(p + q) / 2 for p, q in pairwise(ends)]
    seen = [(float(np.linalg.eigvalsh(at(x))[0]), (math.cos(x), math.sin(x))) for x in middles]
    seen.sort(reverse=True)
    return [pair for value, pair in seen[:1] if best_only or value > 0] or ([seen[0][1]] if best_only else [])


def _is_positive(forms: Sequence[Sequence[Sequence[Any]]], weights: Sequence[fmpq]) -> bool:
    size = len(forms[0])
    total = [
        [sum((form[i][j] * w for form, w in zip(forms, weights, strict=True)), arb(0)) for j in range(size)]
        for i in range(size)
    ]
    return all(minor > 0 for minor in leading_determinants(arb_mat, total))


# A potential energy whose second derivative is singular: terms of higher order decide.
#
# Let K >= 0 with K v = 0 for the directions v = sum t_a v_a only, one or two.  After minimising over what is across
# them (the splitting lemma), with w = V'''(v, v, .) and K u = w,
#
#     V = V_0 + V'''(v, v, v)/6 + (V''''(v, v, v, v) - 3 w.u)/24 + ...        along v
#
# and where nothing is across, K = 0, these are the terms of V.  The first form W(t) that does not vanish decides: V has
# a strict minimum where W > 0, and where W < 0 for some t there are motions that leave the rest, as long as there are
# no other forces (V. V. Kozlov, V. P. Palamodov, Doklady AN SSSR 263, 1982, 285-289).


#: V_ij... at the rest, by places of coordinates; None where it has no exact value.
Derivative = Callable[..., Element | None]

#: Derivatives of fourth order of a potential in more coordinates than this are not formed.
MOST_DEGENERATE = 4

#: Terms of a potential are looked at up to this order, where nothing is across; else up to the fourth.
MOST_ORDER = 10

#: At these t_2/t_1 forms in two variables are tried for negative values.
_TRIED = [Fraction(k, 4) for k in range(-16, 17)]


def by_potential(
    size: int,
    derivative: Derivative,
    field: NumberField,
    conserved: bool,
    only: bool,
    gyroscopic: bool,
    damping: Sequence[Sequence[arb]] = (),
) -> Verdict | None:
    """The verdict on a rest from the derivatives of V alone, where an energy T_2 + V does not grow.

    ``conserved``: it does not fall, either; ``only``: there are no other coordinates, not even ignored ones;
    ``gyroscopic``: the equations may have gyroscopic terms; ``damping``: D, size x size.
    """
    if size > MOST_DEGENERATE:
        return None
    try:
        order, form = lowest_form(size, derivative, field)
    except NotRational:
        return None
    extremum = _extremum(order, form, field)
    complete = only and bool(damping) and all(minor > 0 for minor in leading_determinants(arb_mat, damping))
    return by_extremum(order, extremum, conserved and only and not (gyroscopic and size > 1), complete)


def _extremum(order: int, form: Sequence[Element], field: NumberField) -> Extremum:
    """What a form of this order has at 0; ``form`` are its coefficients of t_1^order, t_1^(order - 1) t_2, ..."""
    if not form:
        return Extremum.OPEN
    if order % 2:
        return Extremum.NONE
    values = [sum((x * rationals.exact(t**k) for k, x in enumerate(form)), field.zero) for t in _TRIED]
    if any(field.enclose(x % field.modulus) < 0 for x in (form[0], form[-1], *values)):
        return Extremum.NONE
    if len(form) == 1:
        return Extremum.MINIMUM if field.enclose(form[0]) > 0 else Extremum.OPEN
    if not field.enclose(form[-1]) > 0:
        return Extremum.OPEN
    polynomial = acb_poly([field.enclose(x) for x in form])
    if all(x.degree() <= 0 for x in form):  # repeated roots are not isolated
        exact = fmpq_poly([x[0] for x in form])
        polynomial = acb_poly(exact / exact.gcd(exact.derivative()))
    try:
        crossing = any(root.imag.contains(0) for root in polynomial.roots())
    except ValueError:
        crossing = True
    return Extremum.OPEN if crossing else Extremum.MINIMUM


def lowest_form(size: int, derivative: Derivative, field: NumberField) -> tuple[int, tuple[Element, ...]]:
    """The order of W(t), and its coefficients in t_1^order, t_1^(order - 1) t_2, ...; none where it is not found.

    Of one coordinate in all that is the first term, too, where it is of order 2.  Raises NotRational.
    """
    span = range(size)
    known: dict[tuple[int, ...], Element | None] = {}

    def entry(*places: int) -> Element:
        key = tuple(sorted(places))
        if key not in known:
            known[key] = derivative(*key)
        if (value := known[key]) is None:
            raise NotRational("a derivative has no exact value")
        return value % field.modulus

    def contracted(*places: Any) -> Element:
        """A derivative along vectors, and in the places that are given as numbers."""
        at = next((k for k, place in enumerate(places) if not isinstance(place, int)), None)
        if at is None:
            return entry(*places)
        terms = (
            field.times(x, contracted(*places[:at], i, *places[at + 1 :])) for i, x in enumerate(places[at]) if x != 0
        )
        return sum(terms, field.zero) % field.modulus

    second = [[entry(i, j) for j in span] for i in span]
    null = null_space(field, second, size)
    if size == 1 and not null:
        return 2, (second[0][0],)
    if len(null) not in (1, 2):
        return 0, ()
    free = [next((i for i in span if v[i] != 0 and all(w[i] == 0 for w in null if w is not v)), -1) for v in null]
    others = [i for i in span if i not in free]
    block = [[field.enclose(second[i][j]) for j in others] for i in others]
    if -1 in free or not all(x > 0 for x in leading_determinants(arb_mat, block)):
        return 0, ()

    def form(order: int, value: Callable[..., Element]) -> tuple[Element, ...]:
        """W of a symmetric function of so many directions."""
        last, few = len(null) - 1, 1 if len(null) == 1 else order + 1
        return tuple(value(*(0,) * (order - k), *(last,) * k) * math.comb(order, k) % field.modulus for k in range(few))

    def along(*directions: int) -> Element:
        return contracted(*(null[k] for k in directions))

    across = {}
    for a, b in _sorted_indices(len(null), 2):
        w = [contracted(null[a], null[b], i) for i in others]
        # K u = w with u = 0 at the places left out: a vector (u, -1) that the rows [K | w] annul.
        table = [[*(second[i][j] for j in others), x] for i, x in zip(others, w, strict=True)]
        u = null_space(field, table, len(others) + 1)[-1]  # the only free place is the last: K is regular across
        across[a, b] = across[b, a] = w, u

    def joined(a: int, b: int, c: int, d: int) -> Element:
        """w_ab . u_cd"""
        return sum((field.times(-x, y) for x, y in zip(across[c, d][1], across[a, b][0], strict=False)), field.zero)

    def split(a: int, b: int, c: int, d: int) -> Element:
        return along(a, b, c, d) - joined(a, b, c, d) - joined(a, c, b, d) - joined(a, d, b, c)

    for order in range(3, MOST_ORDER + 1 if not others else 5):
        coefficients = form(order, split if order == 4 else along)
        if any(x != 0 for x in coefficients):
            return order, coefficients
    return 0, ()


def _sorted_indices(size: int, count: int) -> list[tuple[int, ...]]:
    if count == 0:
        return [()]
    return [(*rest, i) for rest in _sorted_indices(size, count - 1) for i in range(rest[-1] if rest else 0, size)]


# First integrals as functions of what is constant on a steady motion, with their first and second derivatives.
#
# Coordinates that neither L nor any force contains are left out (they turn, or may have any value): the others and all
# velocities are the variables z of a reduced system, on which every integral that does not contain the coordinates left
# out is a function.  Components of a conserved momentum that turn with them come as the sum of their squares.


#: How the name of a sum of squares of components of a momentum begins.
SQUARE = "square of the "
#: Momenta of more terms than this are not squared.
MOST_TERMS = 80
#: Coordinates of systems whose integrals are looked for.
MOST_COORDINATES = 8


@dataclass(frozen=True)
class Conserved:
    """``names`` and ``polynomials`` of proved integrals, functions of ``coordinates`` and of all ``velocities``."""

    ring: Ring
    names: tuple[str, ...]
    polynomials: tuple[Polynomial, ...]
    coordinates: tuple[str, ...]
    velocities: tuple[str, ...]

    def derivatives(self, x: Polynomial) -> list[Polynomial]:
        """dx/dz, coordinates first."""
        ring = self.ring
        of_places = [ring.derivative(x, name) for name in self.coordinates]
        return of_places + [ring.velocity_derivative(x, name) for name in self.velocities]

    @cached_property
    def gradients(self) -> list[list[Polynomial]]:
        """m x N."""
        return [self.derivatives(x) for x in self.polynomials]

    @cached_property
    def hessians(self) -> list[list[list[Polynomial]]]:
        """m times N x N."""
        return [[self.derivatives(x) for x in row] for row in self.gradients]

    def combination(self, value: Callable[[Polynomial], Element | None], field: NumberField) -> tuple[str, ...] | None:
        """The names of integrals of which a combination is definite at a state; None where none was found.

        ``value``: a polynomial at the state, as an element of the field, or None where it has no such value.
        """
        gradients = [[value(x) for x in row] for row in self.gradients]
        if any(x is None for row in gradients for x in row):
            return None
        hessians = [[[value(x) for x in row] for row in rows] for rows in self.hessians]
        if any(x is None for rows in hessians for row in rows for x in row):
            return None
        multipliers = definite_combination(gradients, hessians, field)
        if multipliers is None:
            return None
        contributing = [name for name, mu in zip(self.names, multipliers, strict=True) if not mu.contains(0)]
        return tuple(contributing) or self.names

    def holding(self) -> Verdict | None:
        """Stability by one coordinate's integral where T_2 is the energy, which does not grow; None without such one.

        With I(q, 0) = A(q), which is analytic and not constant, E + (I - I_0)^2 has a strict minimum at every rest:
        E = 0 says q' = 0, and A(q) = A(q_0) has no other solution near q_0.
        """
        ring = self.ring
        if len(self.coordinates) != 1 or ring.kinked:
            return None
        (name,) = self.coordinates
        for title, x in zip(self.names, self.polynomials, strict=True):
            if ring.is_zero(ring.reduce(ring.derivative(ring.at_rest(x), name))) is False:
                return concluded({Fact.INTEGRALS_DEFINITE}, Reason(Because.INTEGRAL_HOLDS, (name, worded(title))))
        return None


def by_integrals(names: Sequence[str], drift: bool) -> Verdict:
    """Stability by the integrals called ``names``; ``drift``: with respect to what is not cyclic."""
    verdict = concluded({Fact.INTEGRALS_DEFINITE}, Reason(Because.INTEGRALS, tuple(map(worded, names))))
    return drifting(verdict) if drift else verdict


def conserved(scene: Scene, energy: Energy, left_out: Sequence[str], steady: Sequence[str]) -> Conserved | None:
    """The integrals of a system, ``left_out`` the coordinates that neither L nor any force contains.

    ``steady``: those that turn at a constant rate.

    None where the energy is not conserved or no momentum is, and where the motion is steady in no such reduced system.
    """
    system = scene.system
    if not {*steady} <= {*left_out} or len(system.coordinates) > MOST_COORDINATES:
        return None
    try:
        known = first_integrals.integrals(
            scene, energy, lagrange.equations(scene, energy), programs(system, scene.ring)
        )
    except NOT_THERE:
        return None
    return of_integrals(scene, known, left_out)


def of_integrals(scene: Scene, known: Sequence[Integral], left_out: Sequence[str]) -> Conserved | None:
    """The same from the integrals of problem 7."""
    ring, system = scene.ring, scene.system
    hidden = [*left_out, *(item.name for item in system.prescribed), "t"]
    free = is_free_about_the_origin(system)
    proved = [item for item in known if item.status is Certainty.PROVED or (free and item.kind == "angular momentum")]
    functions = [(item.name, item.formula.polynomial) for item in proved]
    for kind in ("linear momentum", "angular momentum"):
        parts = [item for item in proved if item.kind == kind and ring.dependencies(item.formula.polynomial, hidden)]
        for count in (2, 3):
            for chosen in combinations(parts, count):
                if any(len(item.formula.polynomial) > MOST_TERMS for item in chosen):
                    continue
                axes = enumerated([item.of for item in chosen])
                try:
                    square = sum((ring.times(x, x) for item in chosen if (x := item.formula.polynomial)), ring.zero)
                    functions.append(
                        (
                            Message("square of the [[kind]] across ([[axes]])", kind=Message(kind), axes=axes),
                            ring.reduce(square),
                        )
                    )
                except Failure:
                    continue
    seen = [(name, x) for name, x in functions if not ring.dependencies(x, hidden)]
    if len(seen) < 2 or not any(item.kind in ENERGIES for item in proved):
        return None
    remaining = tuple(name for name in system.coordinates if name not in left_out)
    return Conserved(ring, tuple(name for name, _ in seen), tuple(x for _, x in seen), remaining, system.coordinates)
