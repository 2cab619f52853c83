"""Verdicts at exact points of curves and corners, against borders known by hand.

M = 1, G = [[0, -g], [g, 0]], K = diag(-a, -b):  lambda^4 + (g^2 - a - b) lambda^2 + a b;  two gyroscopically stabilised
coordinates for g > sqrt(a) + sqrt(b), a double pair +-i (a b)^(1/4) with Jordan blocks for equality, flutter below.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from flint import fmpq, fmpq_mpoly_ctx, fmpq_poly, fmpz_poly

from mbsym.algebra.arrangements import decompose
from mbsym.algebra.failures import TooLargeError
from mbsym.algebra.plane import Box
from mbsym.algebra.plane.elements import Element, ElementMatrix, ElementPolynomial, PointField, SimpleField
from mbsym.algebra.plane.numbers import number, roots_between
from mbsym.algebra.roots import RootCount, counted, counted_real
from mbsym.maps.check import ExactVerdicts
from mbsym.maps.verdicts import Border, Judged
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.verdict import combine
from mbsym.problems.stability.words import Because, Word

X, Y = fmpq_mpoly_ctx.get(["x", "y"]).gens()
ZERO, ONE = X * 0, X * 0 + 1


def section(m: Any, d: Any, g: Any, k: Any, n: Any, conservative: bool = True, **further: Any) -> Any:
    """What the judge asks of a section, with one part."""
    rows = [tuple(tuple(ZERO + x for x in row) for row in matrix) for matrix in (m, d, g, k, n)]
    part = LinearSystem(*rows, conservative, **further)
    return SimpleNamespace(parts=(part,), judged=lambda signs: ((part,), conservative), whole=combine)


def diagonal(*values: Any) -> list[list[Any]]:
    return [[value if i == j else 0 for j in range(len(values))] for i, value in enumerate(values)]


NONE = diagonal(0, 0)


def at(curves: list[Any], near: tuple[float, float], judged: Any, box: Box | None = None) -> Judged:
    """The verdict at the corner of some curves nearest to a place."""
    found = decompose(curves, box or Box(-4, 4, -4, 4))
    corners = sorted(found.corners, key=lambda c: sum(abs(a - b) for a, b in zip(c.point.floats(), near, strict=True)))
    return ExactVerdicts(judged)(corners[0].point)


def gyroscopic() -> Any:
    """a = x, b = 1, g = y."""
    return section(diagonal(1, 1), NONE, [[0, -Y], [Y, 0]], diagonal(-X, -1), NONE)


def test_the_border_of_gyroscopic_stabilisation_has_jordan_blocks() -> None:
    found = decompose([(Y**2 - X - 1) ** 2 - 4 * X], Box(fmpq(1, 2), 3, 1, 4))
    judge = ExactVerdicts(gyroscopic())
    assert found.arcs
    for arc in found.arcs:
        judged = judge(arc.point)
        assert judged.border is Border.JORDAN
        assert judged.verdict.word is Word.UNDECIDED
        assert judged.verdict.because(Because.JORDAN_BLOCK)
        assert (judged.right, judged.degree, judged.null) == (0, 2, 0)
    words = {ExactVerdicts(gyroscopic())(PointLike(*region.sample)).verdict.word for region in found.regions}
    assert words == {Word.GYROSCOPIC, Word.UNSTABLE}


class PointLike:
    """A rational point as the judge takes it."""

    def __new__(cls, x: Any, y: Any) -> Any:
        from mbsym.algebra.plane import Point

        return Point(fmpq(x), fmpq(y))


def test_a_corner_over_two_square_roots() -> None:
    """a = x, g = y at x^2 = 2 and (y^2 - x - 1)^2 = 4 x: y = 1 + 2^(1/4), of degree 4 over QQ(sqrt 2)."""
    curve = (Y**2 - X - 1) ** 2 - 4 * X
    judged = at([curve, X**2 - 2], (2**0.5, 1 + 2**0.25), gyroscopic())
    assert judged.border is Border.JORDAN
    above = at([(Y - 3) ** 2 - 2, X**2 - 2], (2**0.5, 3 + 2**0.5), gyroscopic(), Box(-4, 4, -4, 5))
    assert (above.verdict.word, above.border) == (Word.GYROSCOPIC, None)
    below = at([Y**2 - 2, X**2 - 2], (2**0.5, 2**0.5), gyroscopic())
    assert (below.verdict.word, below.right, below.real_right) == (Word.UNSTABLE, 2, 0)


def test_equal_frequencies_without_coupling_are_semisimple_and_stable() -> None:
    judged = at([X**2 - 2, X - Y], (2**0.5, 2**0.5), section(diagonal(1, 1), NONE, NONE, diagonal(X, Y), NONE))
    assert (judged.verdict.word, judged.border) == (Word.STABLE, Border.SEMISIMPLE)


def test_a_zero_root_where_two_irrational_coordinates_agree() -> None:
    """y^2 - 2 is reducible over QQ(x), x = sqrt 2: x - y vanishes at one of its roots and not at the other."""
    judged = section(diagonal(1, 1), NONE, NONE, diagonal(1, 2 + X - Y), NONE)
    zero = section(diagonal(1, 1), NONE, NONE, diagonal(1, X - Y), NONE)
    curves = [X**2 - 2, Y**2 - 2]
    assert at(curves, (2**0.5, 2**0.5), judged).verdict.word is Word.STABLE
    there = at(curves, (2**0.5, 2**0.5), zero)
    assert (there.border, there.null, there.verdict.word) == (Border.ZERO, 1, Word.UNDECIDED)
    assert at(curves, (2**0.5, -(2**0.5)), zero).verdict.word is Word.STABLE
    assert at(curves, (-(2**0.5), 2**0.5), zero).verdict.word is Word.UNSTABLE


def test_hurwitz_border_of_a_damped_pair() -> None:
    """q1'' + q1' + q1 + p q2 = 0, q2'' + q2' + q2 - p q1 = 0: (s^2 + s + 1)^2 + p^2, on the axis at p = xy = 1."""
    damped = section(diagonal(1, 1), diagonal(1, 1), NONE, diagonal(1, 1), [[0, X * Y], [-X * Y, 0]], False)
    on = at([X**2 - 2, (X * Y) ** 2 - 1], (2**0.5, 0.5**0.5), damped)
    assert (on.border, on.right, on.verdict.word) == (Border.IMAGINARY, 0, Word.CRITICAL)
    inside = at([X**2 - 2, (2 * X * Y) ** 2 - 1], (2**0.5, 0.5**1.5), damped)
    assert (inside.border, inside.verdict.word) == (None, Word.ASYMPTOTIC)
    outside = at([X**2 - 2, (X * Y) ** 2 - 3], (2**0.5, 1.5**0.5), damped)
    assert (outside.right, outside.real_right, outside.verdict.word) == (2, 0, Word.UNSTABLE)


def test_a_singular_mass_matrix() -> None:
    judged = at([X**2 - 2, Y**2 - 2], (2**0.5, 2**0.5), section(diagonal(1, X - Y), NONE, NONE, diagonal(1, 1), NONE))
    assert (judged.border, judged.right, judged.verdict.word) == (Border.MASS, None, Word.UNDECIDED)


def test_cyclic_coordinates_are_ignored_at_algebraic_points() -> None:
    """q'' + y s' + x q = 0, s'' - y q' = 0, s cyclic: at constant momentum q'' + (x + y^2) q = 0."""
    system = section(diagonal(1, 1), NONE, [[0, Y], [-Y, 0]], diagonal(X, 0), NONE, cyclic=(1,))
    stable = at([X + 1, Y**4 - 2], (-1, 2**0.25), system)
    assert stable.verdict.word is Word.STABLE_BUT_CYCLIC
    assert stable.border is None
    unstable = at([X + 1, 2 * Y**4 - 1], (-1, 0.5**0.25), system)
    assert (unstable.verdict.word, unstable.right) == (Word.UNSTABLE, 1)
    border = at([X**2 - 2, X + Y**2], (-(2**0.5), 2**0.25), system)
    assert (border.verdict.word, border.border) == (Word.UNDECIDED, Border.ZERO)


@pytest.fixture(scope="module")
def root_of_two() -> SimpleField:
    return SimpleField(number(roots_between(fmpq_poly([-2, 0, 1]).numer(), fmpq(0), fmpq(2))[0]))


def test_counts_over_a_field(root_of_two: SimpleField) -> None:
    """(s^2 + 2 r)^2 (s + r) (s - 1) s with r = sqrt 2."""
    r = Element(root_of_two, fmpq_poly([0, 1]))
    one, nil = r * 0 + 1, r * 0
    square = ElementPolynomial([r * 2, nil, one])
    product = (
        square * square * ElementPolynomial([r, one]) * ElementPolynomial([-one, one]) * ElementPolynomial([nil, one])
    )
    assert counted(product) == RootCount(1, 4, 1, 1, 2)
    assert counted_real(product) == (1, 1, 1)
    found = {m: f.degree() for f, m in product.factor_squarefree()[1]}
    assert found == {1: 3, 2: 2}


def test_matrices_over_a_field(root_of_two: SimpleField) -> None:
    """A Jordan block of sqrt 2 beside the eigenvalue 3: minimal and characteristic polynomial, rank, solution."""
    r = Element(root_of_two, fmpq_poly([0, 1]))
    nil, one = r * 0, r * 0 + 1
    change = ElementMatrix(3, 3, [one, r, nil, nil, one, one, r, nil, one * 5])
    block = ElementMatrix(3, 3, [r, one, nil, nil, r, nil, nil, nil, one * 3])
    moved = change.solve(block * change)
    whole = ElementPolynomial([-r, one]) * ElementPolynomial([-r, one]) * ElementPolynomial([one * -3, one])
    for found in (moved.charpoly(), moved.minpoly()):
        assert all(a == b for a, b in zip(found.coeffs(), whole.coeffs(), strict=True))
    plain = ElementMatrix(3, 3, [r, nil, nil, nil, r, nil, nil, nil, one * 3])
    again = change.solve(plain * change)
    assert again.minpoly().degree() == 2
    assert ElementMatrix(2, 2, [r, one * 2, one, r]).rank() == 1
    with pytest.raises(ZeroDivisionError):
        ElementMatrix(2, 2, [r, one * 2, one, r]).solve(ElementMatrix(2, 1, [one, one]))


def test_inverses_over_a_tower() -> None:
    found = decompose([X**2 - 2, Y**4 - X - 1], Box(0, 2, 0, 2))
    corner = next(c for c in found.corners if c.kind == "crossing")
    field = PointField(corner.point)
    value = field.value(X * Y**3 - Y + 3)
    assert value * value.inverse() == 1
    assert field.value(Y**4 - X - 1) == 0
    with pytest.raises(ZeroDivisionError):
        field.value(Y**4 - X - 1).inverse()


def test_fields_of_high_degree_are_refused() -> None:
    found = decompose([X**50 - 2, Y**2 - X], Box(1, 2, 0, 2))
    corner = next(c for c in found.corners if c.kind == "crossing")
    with pytest.raises(TooLargeError, match="degree 50"):
        ExactVerdicts(gyroscopic())(corner.point)
    assert corner.point.sign(Y**2 - X) == 0


def test_what_curves_share_at_a_corner_is_of_lower_degree() -> None:
    """y = x - 1 and (y - x + 1) (y^2 + 3) + x^2 - 2 = 0 meet over x^2 = 2, once: there y is in QQ(x)."""
    line, cubic = Y - X + 1, (Y - X + 1) * (Y**2 + 3) + X**2 - 2
    found = decompose([line, cubic], Box(-2, 2, -2, 2))
    corner = next(c for c in found.corners if c.factors == (0, 1))
    field = PointField(corner.point)
    assert field.value(line) == 0
    assert field.value(X**2 - 2) == 0
    assert len(corner.point.y.polynomial) == 2


def test_inverses_at_one_point_are_bounded() -> None:
    """In QQ(2^(1/40)) the root itself has an inverse, numbers of 3000 digits are left alone."""
    p = fmpz_poly([-2] + [0] * 39 + [1])
    field = SimpleField(number(roots_between(p, fmpq(0), fmpq(2))[0]))
    long = fmpq_poly([fmpq(7**3000 + k, 5**3000) for k in range(40)])
    assert field.inverse(fmpq_poly([0, 1])) == fmpq_poly([0] * 39 + [fmpq(1, 2)])
    with pytest.raises(TooLargeError, match="arithmetic at a point in a number field of degree 40"):
        field.inverse(long)
