"""Tables: values by a search for the piece against those of formulas, in every algebra; the spline against SciPy's."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from flint import arb, fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from scipy.interpolate import CubicSpline

from mbsym.algebra.base import Lowering
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Program
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.table import CUBIC, EXTRAPOLATE, HOLD, LINEAR, OUTSIDE_ZERO, Table, pieces
from mbsym.expressions.tree import Call, Name, differentiate, slope_written_out, substitute, text, written_out
from mbsym.numerics.kernels import arrays, llvm
from mbsym.numerics.kernels.interface import Code

numbers = st.integers(-4000, 4000).map(lambda k: Fraction(k, 125))
points = st.lists(st.tuples(numbers, numbers), min_size=2, max_size=12, unique_by=lambda one: one[0]).map(sorted)
tables = st.builds(
    lambda own, between, outside: Table("f", tuple(own), between, outside),
    points, st.sampled_from((LINEAR, CUBIC)), st.sampled_from((HOLD, OUTSIDE_ZERO)),
)  # fmt: skip
F = Fraction
some = settings(max_examples=80, derandomize=True)


def searched(table: Table, x: Fraction) -> Fraction:
    """f(x) by a look at every piece."""
    (first, start), (last, end) = table.points[0], table.points[-1]
    if first < x < last:
        for (one, later), (a, b, c) in zip(pairwise(table.points), pieces(table), strict=True):
            if one[0] <= x <= later[0]:
                u = x - one[0]
                return one[1] + a * u + b * u**2 + c * u**3
    at_end = start if x <= first else end
    return at_end if table.outside == HOLD else at_end / 2 if x in (first, last) else Fraction(0)


@given(table=tables, x=numbers, exactly=st.integers(0, 11))
@some
def test_values_in_every_algebra(table: Table, x: Fraction, exactly: int) -> None:
    call = Call("f", Name("x"), table=table)
    for at in (x, table.points[exactly % len(table.points)][0]):
        wanted, exact = searched(table, at), fmpq(at.numerator, at.denominator)
        found = Lowering(Rationals({}, {}), {"x": exact})(call)
        assert found == fmpq(wanted.numerator, wanted.denominator)
        assert Lowering(Balls({}), {"x": arb(exact)})(call).overlaps(arb(found))


@given(table=tables)
@some
def test_values_in_kernels_keep_their_digits(table: Table) -> None:
    program = Program()
    node = Lowering(program, {"x": program.input("x")})(Call("f", Name("x"), table=table))
    code = Code(program, ("x",), (node,))
    at = np.linspace(-40, 40, 331) + 1 / 3000
    wanted = np.array([float(searched(table, Fraction(x))) for x in at])
    polynomials = zip(pairwise(table.points), pieces(table), strict=True)
    size = max(sum(abs(c) * (later[0] - one[0]) ** (k + 1) for k, c in enumerate(p)) for (one, later), p in polynomials)
    steep = max(sum(abs(c) * (k + 1) * (v[0] - u[0]) ** k for k, c in enumerate(p))
                for (u, v), p in zip(pairwise(table.points), pieces(table), strict=True))  # fmt: skip
    allowed = 4e-16 * len(table.points) * float(size + 80 * steep + max(abs(y) for _, y in table.points))
    for kernel in (arrays.kernel(code), llvm.kernels({"f": code})["f"]):
        assert np.max(np.abs(kernel(at[None, :])[0] - wanted)) <= allowed


@given(own=points)
@some
def test_the_spline_is_the_natural_one(own: list[tuple[Fraction, Fraction]]) -> None:
    table, x = Table("f", tuple(own), CUBIC), np.array([float(x) for x, _ in own])
    other = CubicSpline(x, [float(y) for _, y in own], bc_type="natural")
    at = np.linspace(x[0], x[-1], 57)[1:-1]
    found = np.array([float(searched(table, Fraction(one))) for one in at])
    assert np.allclose(found, other(at), rtol=1e-9, atol=1e-9 * np.max(np.abs(other(at))))
    lengths = [later[0] - one[0] for one, later in pairwise(own)]
    placed = list(zip(pieces(table), lengths, strict=True))
    slopes = [(a, a + 2 * b * h + 3 * c * h * h) for (a, b, c), h in placed]
    bends = [(2 * b, 2 * b + 6 * c * h) for (_, b, c), h in placed]
    assert all(one[1] == later[0] for one, later in pairwise(slopes))
    steep = max(abs(chord) for bend in bends for chord in bend) + 1
    assert all(abs(one[1] - later[0]) <= Fraction(1, 10**30) * steep for one, later in pairwise(bends))
    assert abs(bends[0][0]) <= Fraction(1, 10**30) * steep
    assert abs(bends[-1][1]) <= Fraction(1, 10**30) * steep


def test_a_spline_worked_by_hand() -> None:
    """Through (0, 0), (1, 1), (2, 0): the middle slope is 0, the others 3/2 and -3/2; f = 3/2 u - u^3/2."""
    first, second = pieces(Table("f", ((F(0), F(0)), (F(1), F(1)), (F(2), F(0))), CUBIC))
    assert first == (F(3, 2), 0, F(-1, 2))
    assert second == (0, F(-3, 2), F(1, 2))


def test_slopes_are_those_of_the_pieces() -> None:
    table = Table("f", ((F(0), F(1)), (F(1), F(3)), (F(4), F(0))), LINEAR)
    slope = differentiate(Call("f", Name("x"), table=table), "x")
    for at, wanted in ((F(-1), 0), (F(1, 2), 2), (F(2), -1), (F(5), 0)):
        assert Lowering(Rationals({}, {}), {"x": fmpq(at.numerator, at.denominator)})(slope) == wanted


def test_a_call_is_written_as_it_was_read() -> None:
    table, complaints = Table("f", ((F(0), F(1)), (F(1), F(3)))), Complaints()
    tree = parse_expression("2*f(x - 1) + f(y)", complaints, lambda a, b: Span(1, a + 1, b - a), tables={"f": table})
    assert tree is not None
    assert text(tree) == "2*f(x - 1) + f(y)"
    assert text(substitute(tree, {"y": Name("z")})) == "2*f(x - 1) + f(z)"
    assert text(differentiate(tree, "w")) == "0"


def place(start: int, end: int) -> Any:
    return Span(1, start + 1, end - start)


def test_a_table_that_is_not_there_is_no_function() -> None:
    complaints = Complaints()
    assert (
        parse_expression("torke(t)", complaints, place, tables={"torque": Table("torque", ((F(0), F(0)),) * 2)}) is None
    )
    assert [item.hint for item in complaints] == ["did you mean 'torque'?"]


@given(
    table=st.builds(
        lambda own, between, outside: Table("f", tuple(own), between, outside),
        points, st.sampled_from((LINEAR, CUBIC)), st.sampled_from((HOLD, EXTRAPOLATE)),
    ),
    x=numbers,
    exactly=st.integers(0, 11),
    order=st.integers(0, 3),
)  # fmt: skip
@some
def test_tables_written_out_are_the_same(table: Table, x: Fraction, exactly: int, order: int) -> None:
    """Moduli for the values, pulses for derivatives: exactly what the search for the piece gives, knots included."""
    curve = table.curve
    for _ in range(order):
        curve = curve.derivative
    for at in (x, table.points[exactly % len(table.points)][0]):
        written = slope_written_out(curve, Name("x")) if order else written_out(table, Name("x"))
        found = Lowering(Rationals({}, {}), {"x": fmpq(at.numerator, at.denominator)})(written)
        wanted = curve(at)
        assert found == fmpq(wanted.numerator, wanted.denominator)
