"""Vectors with their frames: the laws of vector algebra over the ring and over rationals, and the frame error."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import pytest
from flint import fmpq
from hypothesis import given
from hypothesis import strategies as st
from properties import settings
from test_ring import lowering, new_ring
from test_self_check import RECURSIONS, Mistake, analysed, plant

from mbsym.algebra.base import Algebra, Scalar
from mbsym.algebra.point import Rationals
from mbsym.algebra.vectors import FramesDiffer, Tensor, Vector, axis_vector, symmetric_tensor, tensor_of, zero_vector
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.tree import Name
from mbsym.mechanics.frames import Turn, back, direction_cosines, forward
from mbsym.problems.telling import told_system

some = settings(max_examples=40, derandomize=True)
RING, RATIONALS = new_ring(), Rationals({}, {})
SINE, COSINE = RING.sin_cos(LinearForm((("x", Fraction(1)),)))
#: The relation sin^2 + cos^2 = 1 takes part.
NAMED = [SINE, COSINE, *(lowering(RING).environment[name] for name in ("l", "w", "x_dot"))]
few = st.integers(-3, 3)

polynomials = st.builds(
    lambda a, b, c, x, y: RING.number(a) + RING.number(b) * x + RING.number(c) * x * y,
    few,
    few,
    few,
    st.sampled_from(NAMED),
    st.sampled_from(NAMED),
)
rationals = st.builds(fmpq, few, st.integers(1, 4))
OVER = pytest.mark.parametrize(("algebra", "scalars"), [(RING, polynomials), (RATIONALS, rationals)], ids=["ring", "Q"])


def vectors(algebra: Algebra, scalars: st.SearchStrategy[Scalar], frame: str = "arm") -> st.SearchStrategy[Vector]:
    return st.builds(lambda *items: Vector(algebra, items, frame), scalars, scalars, scalars)


def tensors(algebra: Algebra, scalars: st.SearchStrategy[Scalar]) -> st.SearchStrategy[Tensor]:
    row = st.tuples(scalars, scalars, scalars)
    return st.builds(lambda *rows: Tensor(algebra, rows, "arm"), row, row, row)


def same(u: Vector, v: Vector) -> bool:
    return u.frame == v.frame and (u - v).reduced().vanishes()


@OVER
@some
@given(data=st.data())
def test_laws_of_vectors(algebra: Algebra, scalars: st.SearchStrategy[Scalar], data: Any) -> None:
    u, v, w = (data.draw(vectors(algebra, scalars)) for _ in range(3))
    a, b = data.draw(scalars), data.draw(scalars)
    reduce, zero = algebra.reduce, zero_vector(algebra, "arm")
    assert same(u + v, v + u)
    assert same((u + v) + w, u + (v + w))
    assert same(u + zero, u)
    assert same(u - v, u + -v)
    assert same((u + v) * a, u * a + v * a)
    assert same(u * algebra.reduce(a * b), (u * b) * a)
    assert same(u.cross(v), -v.cross(u))
    assert same(u.cross(u), zero)
    assert same((u + v * a).cross(w), u.cross(w) + v.cross(w) * a)
    assert reduce(u.dot(v) - v.dot(u)) == algebra.zero
    assert reduce(u.cross(v).dot(w) - u.dot(v.cross(w))) == algebra.zero
    # Grassmann, Jacobi and Lagrange
    assert same(u.cross(v.cross(w)), v * u.dot(w) - w * u.dot(v))
    assert same(u.cross(v.cross(w)) + v.cross(w.cross(u)) + w.cross(u.cross(v)), zero)
    assert reduce(u.cross(v).dot(u.cross(v)) - u.dot(u) * v.dot(v) + u.dot(v) * u.dot(v)) == algebra.zero


def test_the_product_of_two_axes_is_the_third() -> None:
    """e_1 x e_2 = e_3 and so on round: what no law with an even number of products tells from its opposite."""
    for algebra in (RING, RATIONALS):
        e = [axis_vector(algebra, k, algebra.one, "arm") for k in (1, 2, 3)]
        for k in range(3):
            assert e[k].cross(e[(k + 1) % 3]) == e[(k + 2) % 3]
            assert [x for x in e[k]] == [algebra.one if i == k else algebra.zero for i in range(3)]  # noqa: C416


@OVER
@some
@given(data=st.data())
def test_laws_of_tensors(algebra: Algebra, scalars: st.SearchStrategy[Scalar], data: Any) -> None:
    s, t = (data.draw(tensors(algebra, scalars)) for _ in range(2))
    u, v = (data.draw(vectors(algebra, scalars)) for _ in range(2))
    assert same((s + t) @ u, s @ u + t @ u)
    assert same(t @ (u + v), t @ u + t @ v)
    assert algebra.reduce(u.dot(t @ v) - (t.T @ u).dot(v)) == algebra.zero
    assert [t.T.row(k) for k in range(3)] == [t.column(k) for k in range(3)]
    upper = symmetric_tensor(algebra, t.rows, "arm")
    assert upper.T.rows == upper.rows
    assert [upper[i][j] for i in range(3) for j in range(i, 3)] == [t[i][j] for i in range(3) for j in range(i, 3)]


def turn(axis: int, source: str, frame: str) -> Turn:
    return Turn(axis, Name("x"), SINE, COSINE, RING.zero, RING.zero, source, frame)


@pytest.mark.parametrize("axis", [1, 2, 3])
@some
@given(data=st.data())
def test_a_turn_changes_the_frame_and_no_product(axis: int, data: Any) -> None:
    u, v = (data.draw(vectors(RING, polynomials, "base")) for _ in range(2))
    one = turn(axis, "base", "arm")
    assert (one.out(u).frame, one.back(one.out(u)).frame) == ("arm", "base")
    assert same(one.back(one.out(u)), u)
    assert RING.reduce(one.out(u).dot(one.out(v)) - u.dot(v)).is_zero()
    assert same(one.out(u.cross(v)), one.out(u).cross(one.out(v)))
    rotation = direction_cosines(RING, [one], "base", "arm")
    assert (rotation.source, rotation.frame, rotation.T.source, rotation.T.frame) == ("base", "arm", "arm", "base")
    assert same(rotation @ u, one.out(u))
    assert same(rotation.T @ (rotation @ u), u)


def test_passive_convention() -> None:
    """C_3(x): a fixed vector e_1 has the components (cos x, -sin x, 0) in axes that have turned by x about e_3."""
    seen = turn(3, "base", "arm").out(axis_vector(RING, 1, RING.one, "base"))
    assert seen == Vector(RING, (COSINE, -SINE, RING.zero), "arm")


# --- the frame error ---

U, V = axis_vector(RATIONALS, 1, fmpq(2), "arm"), axis_vector(RATIONALS, 2, fmpq(3), "orbital frame")
J = tensor_of(RATIONALS, [[fmpq(i + j) for j in range(3)] for i in range(3)], "orbital frame")
MIXED: dict[str, Callable[[], object]] = {
    "sum": lambda: U + V,
    "difference": lambda: U - V,
    "dot": lambda: U.dot(V),
    "cross": lambda: U.cross(V),
    "tensor": lambda: J @ U,
    "tensors": lambda: J + J.in_parallel("arm"),
    "turn": lambda: turn(1, "orbital frame", "wheel").out(U),
    "turn back": lambda: turn(1, "orbital frame", "wheel").back(U),
    "turns": lambda: forward([turn(1, "orbital frame", "wheel")], U, "wheel"),
    "turns back": lambda: back([turn(1, "base", "orbital frame")], U, "base"),
}


@pytest.mark.parametrize("what", MIXED)
def test_vectors_in_different_axes_do_not_mix(what: str) -> None:
    with pytest.raises(FramesDiffer) as caught:
        MIXED[what]()
    assert {"arm", "wheel" if what == "turn back" else "orbital frame"} == {caught.value.left, caught.value.right}
    assert repr(caught.value.left) in str(caught.value)
    assert repr(caught.value.right) in str(caught.value)


def test_a_name_does_not_turn() -> None:
    assert U.in_parallel("wheel") != U
    assert (U.in_parallel("wheel") + V.in_parallel("wheel")).components == (2, 3, 0)


#: Mistakes that were formulas of other quantities as long as vectors were three numbers.
PLANTED = [
    Mistake("omega_k, as the paper prints it", RECURSIONS, "parent_spin.cross(offset)", "spin.cross(offset)", "", ()),
    Mistake("velocity not turned", RECURSIONS, "forward(turns, carried + relative_velocity, name)", "carried", "", ()),
    Mistake(
        "a weight in inertial axes",
        "mechanics.loads.kinds:_uniform_action",
        "field[name] *",
        "field['0'] *",
        "",
        (),
    ),
    Mistake("a force not turned back", "mechanics.articulated:forcing", "frame.back(force), ", "force, ", "", ()),
    Mistake("R for R^T", "mechanics.intermediates:NamedScene.back", "].T @ v", "] @ v", "", ()),
]


@pytest.mark.parametrize("mistake", PLANTED, ids=lambda mistake: mistake.what)
def test_a_planted_wrong_frame_stops_at_once(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, mistake: Mistake
) -> None:
    """As an error of the stage that it occurs in, or raised where no stage stands around."""
    plant(monkeypatch, mistake)
    found = ""
    try:
        analysis = analysed("machine")
        assert all(check.name for check in analysis.checks)
        told_system(analysis.system, analysis.ring, analysis.terms)
    except FramesDiffer as error:
        found = str(error)
    assert "a vector in the axes of" in found + caplog.text
