"""Tables of thousands of points against NumPy's ``interp``, SciPy's spline, closed forms; and where tables end."""

from __future__ import annotations

from fractions import Fraction
from time import process_time
from typing import Any

import numpy as np
import pytest
from flint import arb, fmpq
from scipy.interpolate import CubicSpline

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.algebra.derivative import gradient
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import Program
from mbsym.expressions.table import CUBIC, ENDS, EXTRAPOLATE, HOLD, LINEAR, Table
from mbsym.expressions.tree import Call, Name
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels import arrays, llvm
from mbsym.numerics.kernels.arrays import stepwise
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64, Code
from mbsym.numerics.methods import sides
from mbsym.numerics.methods.interface import Breakdown, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario

COUNT = 5000
SOURCE = np.random.default_rng(7)
X = np.cumsum(SOURCE.integers(1, 40, COUNT))
Y = SOURCE.integers(-500, 500, COUNT)
POINTS = tuple((Fraction(int(x), 128), Fraction(int(y), 64)) for x, y in zip(X, Y, strict=True))


def table_of(between: str = LINEAR, outside: str = HOLD) -> Table:
    return Table("wind", POINTS, between, outside)


def code_of(table: Table, slopes: bool = False) -> Code:
    program = Program()
    x = program.input("x")
    node = Lowering(program, {"x": x})(Call("wind", Name("x"), table=table))
    return Code(program, ("x",), (node, *gradient(program, node, [x])) if slopes else (node,))


AT = np.concatenate([SOURCE.uniform(-3, X[-1] / 128 + 3, 4001), X[::7] / 128])


@pytest.mark.parametrize("scalar", [FLOAT64, FLOAT32, EXTENDED])
def test_values_are_those_of_interp(scalar: str) -> None:
    """NumPy's own interpolation holds the ends too; one state, many and several side by side give the same bits."""
    if not llvm.available(scalar):
        pytest.skip("no such arithmetic here")
    kind = {FLOAT64: np.float64, FLOAT32: np.float32, EXTENDED: np.longdouble}[scalar]
    code, wanted = code_of(table_of()), np.interp(AT.astype(kind).astype(float), X / 128, Y / 64)
    many = llvm.kernel(code, scalar)(AT[None, :])[0]
    allowed = 2e-6 if scalar == FLOAT32 else 2e-12
    assert np.max(np.abs(many - wanted)) < allowed
    wide = llvm.kernels({"f": code}, scalar, wide=True)["f"](AT[None, :])[0]
    assert np.array_equal(many, wide)
    one = llvm.kernel(code, scalar)
    assert all(one(np.array([x], dtype=kind))[0] == y for x, y in zip(AT[:50].astype(kind), many[:50], strict=True))
    assert np.array_equal(arrays.kernel(code, scalar)(AT[None, :])[0], many)
    if scalar != EXTENDED:
        assert all(stepwise(code, scalar)(np.array([x]))[0] == y for x, y in zip(AT[:50], many[:50], strict=True))


def test_a_spline_and_its_slope_are_those_of_scipy() -> None:
    code = code_of(table_of(CUBIC, EXTRAPOLATE), slopes=True)
    inside = AT[(X[0] / 128 < AT) & (X[-1] / 128 > AT)]
    spline = CubicSpline(X / 128, Y / 64, bc_type="natural")
    value, slope = llvm.kernel(code)(inside[None, :])
    assert np.max(np.abs(value - spline(inside))) < 1e-9 * np.max(np.abs(spline(inside)))
    assert np.max(np.abs(slope - spline(inside, 1))) < 1e-8 * np.max(np.abs(spline(inside, 1)))


@pytest.mark.parametrize("between", [LINEAR, CUBIC])
@pytest.mark.parametrize("outside", [HOLD, EXTRAPOLATE, ENDS])
def test_exact_values_balls_and_numbers_agree(between: str, outside: str) -> None:
    table = table_of(between, outside)
    call, code = Call("wind", Name("x"), table=table), code_of(table)
    for place in (Fraction(-1, 3), POINTS[0][0], POINTS[77][0], Fraction(12345, 67), POINTS[-1][0], Fraction(9999)):
        exact = Lowering(Rationals({}, {}), {"x": fmpq(place.numerator, place.denominator)})(call)
        ball = Lowering(Balls({}), {"x": arb(fmpq(place.numerator, place.denominator))})(call)
        assert ball.overlaps(arb(exact))
        wide = Lowering(Balls({}), {"x": arb(fmpq(place.numerator, place.denominator), 0.5)})(call)
        assert wide.contains(exact)
        found = llvm.kernel(code)(np.array([float(place)]))[0]
        assert abs(found - float(int(exact.p) / int(exact.q))) < 1e-9 * (1 + abs(found))


def test_a_ball_over_many_pieces_holds_all_of_them() -> None:
    call = Call("wind", Name("x"), table=table_of())
    ball = Lowering(Balls({}), {"x": arb(100, 5)})(call)
    inside = np.interp(np.linspace(95, 105, 999), X / 128, Y / 64)
    assert all(ball.contains(arb(y, 1e-9)) or ball.overlaps(arb(y)) for y in inside)
    assert float(ball.upper()) < np.max(inside) + 1
    assert float(ball.lower()) > np.min(inside) - 1


DESCRIPTION = """
mbsym: 1
name: Tabulated
parameters: {m: {positive: true, value: 2}}
tables:
  push: {points: [POINTS], MORE}
bodies:
  - {name: one, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}
loads:
  - LOAD
initial: {x: {position: POSITION, velocity: VELOCITY}}
"""


def run_of(points: Any, load: str, more: str = "", position: Any = 0, velocity: Any = 0, method: str = "dop853") -> Any:
    text = DESCRIPTION.replace("POINTS", ", ".join(f"[{x}, {y}]" for x, y in points)).replace("LOAD", load)
    text = text.replace(", MORE", f", {more}" if more else "").replace("POSITION", str(position))
    system = mbsym.loads(text.replace("VELOCITY", str(velocity))).system
    traits = METHODS[method].traits
    return METHODS[method].start(Dynamics(scenario(system)), Setting(None, 0.01) if traits.fixed else Setting(1e-12))


def test_hundreds_of_knots_cost_no_compilation_each() -> None:
    """m x'' = f(t): x' is the integral by trapezia, exactly; the piece changes in memory, not in code."""
    points = [(x, y) for x, y in zip(X[:400] / 128, Y[:400] / 64, strict=True)]
    run = run_of(points, "generalized force: {x: push(t)}")
    end = float(X[399]) / 128
    run.advance(float(X[0]) / 128)  # whatever is compiled is compiled now
    started = process_time()
    found = run.advance(end)
    assert process_time() - started < 2.0
    before = float(X[0]) / 128 * Y[0] / 64
    area = before + np.sum(np.diff(X[:400] / 128) * (Y[1:400] + Y[:399]) / 128)
    assert found[1] == pytest.approx(area / 2, rel=1e-12, abs=1e-12)
    assert len(run.passed.switches) == 400


@pytest.mark.parametrize("method", ["dop853", "rk4", "rodas5p", "radau"])
def test_a_well_of_two_straight_lines_has_its_period(method: str) -> None:
    """U = -3 |x| as a table that goes on: from rest at x0 the period is 4 sqrt(2 x0 m/3)."""
    run = run_of([(-1, 3), (0, 0), (1, 3)], "potential: push(x)", "outside: extrapolate", position=1.5, method=method)
    period = 4 * (2 * 1.5 * 2 / 3) ** 0.5
    for turn in (1, 2, 3):
        assert run.advance(turn * period) == pytest.approx([1.5, 0.0], abs=2e-9)


def test_friction_by_points_stops_and_holds() -> None:
    """R = 5 |x'| as a table: x'' = -5/m, at rest after m v/5 at m v^2/10; there it stays."""
    run = run_of([(-1, 5), (0, 0), (1, 5)], "rayleigh: push(x_dot)", "outside: extrapolate", velocity=3)
    rest = run.advance(2 * 3 / 5 + 0.5)
    assert rest == pytest.approx([2 * 9 / 10, 0.0], abs=1e-10)
    assert run.advance(10.0) == pytest.approx(rest, abs=1e-12)


def test_a_run_ends_where_a_table_ends() -> None:
    """At the last point of the time, and where a coordinate leaves the points: exactly there."""
    run = run_of([(0, 1), (2, 3)], "generalized force: {x: push(t)}", "outside: error")
    whole = run.advance(2.0)  # the last point belongs to the table
    assert whole[1] == pytest.approx((1 + 3) / 2)
    with pytest.raises(Breakdown, match="the table push ends at 2") as found:
        run.advance(2.5)
    assert (found.value.kind, found.value.time) == (sides.OUTSIDE, 2.0)
    run = run_of([(-1, 0), (1, 0.5)], "generalized force: {x: 0*push(x) + push(x)}", "outside: error", velocity=2)
    with pytest.raises(Breakdown, match="the table push ends at 1") as found:
        run.fill(np.linspace(0.1, 5, 50))
    assert float(found.value.state[0]) == pytest.approx(1.0, abs=1e-9)
    run = run_of([(1, 1), (2, 3)], "generalized force: {x: push(t)}", "outside: error")
    with pytest.raises(Breakdown, match="begins at 1, its argument is 0"):
        run.advance(1.0)


def test_a_table_that_goes_on_is_its_line() -> None:
    """Two points that go on are a straight line, a polynomial like any other: no table is left in the formulas."""
    text = DESCRIPTION.replace("POINTS", "[0, 1], [2, 5]").replace("LOAD", "generalized force: {x: push(x)}")
    text = text.replace("MORE", "outside: extrapolate").replace("POSITION", "0").replace("VELOCITY", "0")
    analysis = mbsym.loads(text)
    assert str(analysis.equations.forcing[0]) == "2*x + 1"


def test_a_wrong_piece_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Knots that are never reached leave the motion on its first piece: the judge sees it."""
    monkeypatch.setattr(sides.Sides, "next_knot", lambda self, own: float("inf"))
    monkeypatch.setattr(sides.Sides, "reached", lambda self, time, own: ())
    run = run_of([(0, 0), (1, 2), (3, 0)], "generalized force: {x: push(t)}")
    assert abs(run.advance(3.0)[1] - 3 / 2) > 0.1
