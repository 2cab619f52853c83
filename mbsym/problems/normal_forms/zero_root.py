"""A root of a Hamiltonian system is zero, exactly: what terms of higher order decide.

H_2'' has a kernel of one dimension then, unless there are two eigenvectors.  With x one of the variables that is not
zero on it the others, xi, are eliminated by dH/dxi = 0, regular there, and

    g(x) = H(x, xi(x)) = a x^M + ...

In suitable coordinates H = (quadratic form K of the xi) + g(x) (splitting lemma), K what H_2'' is without x.

* M even and K, a of one sign: H has a strict minimum or maximum, the motion is stable (Dirichlet), for any number of
  degrees of freedom.
* One degree of freedom, or two with +-i w beside: H = delta y^2/2 + Omega I + a' x^M + b I x + ... in normal form;
  M odd, or M even and delta a < 0: unstable; M even and delta a > 0: stable (Sokolskii), delta the sign of det K.

Second route: the normal form itself by Lie series, checked by substitution; its coefficient of x^M is a times the M-th
power of the change of scale, and its delta has the sign of det K.

Sources: A. G. Sokolskii, J. Appl. Math. Mech. 41 (1977) 20-28; A. P. Markeev, Libration Points in Celestial Mechanics
and Space Dynamics (1978), chapter 2; D. Gromoll & W. Meyer, Topology 8 (1969) 361 (splitting lemma).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, acb_poly, arb, ctx

from mbsym.algebra.matrices import adjugate_at, determinant_by_traces, faddeev, inverted
from mbsym.algebra.truncated import Space, Truncated
from mbsym.problems.normal_forms.birkhoff import matrix_of
from mbsym.problems.normal_forms.checks import defects
from mbsym.problems.normal_forms.nilpotent import on_zero_root
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem, Why
from mbsym.problems.normal_forms.twist import NotVerified, signed


@dataclass(frozen=True)
class Scalars:
    """What is asked of the scalars of H: a reciprocal, whether one is proved to be zero or not to be, an enclosure."""

    inverse: Callable[[Any], Any]
    is_zero: Callable[[Any], bool]
    differs: Callable[[Any], bool]
    enclosed: Callable[[Any], arb]


BALLS = Scalars(
    inverse=lambda x: 1 / x,
    is_zero=lambda x: bool(x.is_zero()),
    differs=lambda x: not x.contains(0),
    enclosed=lambda x: x.real,
)


def zero_root(whole: Truncated, enclosed: Truncated, scalars: Scalars, names: Sequence[str]) -> Judged:
    """What is decided where det(s - A) = s^2 (...) exactly; ``whole`` is H over ``scalars``, ``enclosed`` over balls.

    ``names`` are those of the variables.  Raises NotVerified where the two routes differ.
    """
    n = len(names) // 2
    others = faddeev(matrix_of(enclosed), acb(0), acb(1))[1][2::2]
    roots = _other_roots(others)
    if roots is None:
        return _open(Why.ZERO_ROOT)
    if any(z.imag != 0 or z.real > 0 for z in roots):
        return Judged(Outcome.UNSTABLE, Theorem.FIRST)
    if not all(z.real < 0 and z.imag.contains(0) for z in roots):
        return _open(Why.ZERO_TWO)
    frequencies = tuple(signed(enclosed, [(-z.real).sqrt() for z in roots]))
    place = _along(whole, scalars)
    if place is None:
        return _open(Why.ZERO_TWO, frequencies)
    energy, rest = splitting(whole, place, scalars)
    order, a = _leading(energy, scalars)
    known: dict[str, Any] = {"frequencies": frequencies, "along": names[place]}
    if order is None:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.ZERO_OPEN, **known)
    known |= {"degree": order, "coefficient": a}
    minors = [_determinant([row[:k] for row in rest[:k]], scalars) for k in range(1, 2 * n)]
    for sign in (1, -1):
        if order % 2 == 0 and sign * a > 0 and all(sign**k * x > 0 for k, x in enumerate(minors, start=1)):
            return Judged(Outcome.STABLE, Theorem.DEFINITE_HIGHER, **known)
    if n > 2:
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.ZERO_MORE, **known)
    delta = minors[-1]
    if not (delta > 0 or delta < 0):
        return Judged(Outcome.UNDECIDED, Theorem.NONE, Why.ZERO_OPEN, **known)
    _verify(enclosed, frequencies, place, (order, a), delta)
    stable = order % 2 == 0 and delta * a > 0
    return Judged(Outcome.STABLE if stable else Outcome.UNSTABLE, Theorem.ZERO, **known)


def _open(why: Why, frequencies: tuple[Any, ...] = ()) -> Judged:
    return Judged(Outcome.UNDECIDED, Theorem.NONE, why, frequencies=frequencies)


def _other_roots(coefficients: Sequence[acb]) -> list[acb] | None:
    """lambda^2 of the other pairs, each alone in its enclosure; None where they are not told apart."""
    if len(coefficients) < 2:
        return []
    try:
        found: list[acb] = acb_poly(coefficients).roots(tol=arb(2) ** (-(ctx.prec // 2)))
    except ValueError:
        return None
    return sorted(found, key=lambda z: float(z.real.mid()))


def _along(whole: Truncated, scalars: Scalars) -> int | None:
    """The first variable, coordinates before momenta, that is not zero on the kernel of H_2''.

    adj(A) is of rank one where the kernel of A is of dimension one, and zero else.
    """
    space = whole.space
    table = adjugate_at(matrix_of(whole), space.zero, space.zero, space.one)
    m = space.variables
    for i in range(m):
        for j in range(m):
            if scalars.differs(table[i][j]):
                return i
    return None


def splitting(whole: Truncated, place: int, scalars: Scalars) -> tuple[Truncated, list[list[Any]]]:
    """g(x), x the variable at ``place``, and H_2'' without it.  Verified by dH/dxi = 0, substituted."""
    source, m = whole.space, whole.space.variables
    space = Space(1, source.order, source.zero, source.one)
    others = [k for k in range(m) if k != place]
    slopes = [whole.derivative(k) for k in others]
    unit = [tuple(int(j == k) for j in range(m)) for k in range(m)]
    rest = [[slope[unit[k]] for k in others] for slope in slopes]
    back = inverted(rest, scalars.inverse, source.zero, source.one)
    x = [space.nothing] * m
    x[place] = space.variable(0)
    for step in range(source.order):
        left = [slope.composed(x) for slope in slopes]
        # the linear terms are solved exactly by the first step: enclosures would leave balls about zero
        left = [one.beyond(1) if step else one for one in left]
        for row, k in zip(back, others, strict=True):
            change = space.nothing
            for factor, one in zip(row, left, strict=True):
                change = change - one.scaled(factor)
            x[k] = x[k] + change
    for slope in slopes:
        residual = slope.composed(x)
        if any(scalars.differs(v) for key, v in residual.coefficients.items() if key[0] < source.order):
            raise NotVerified("the variables beside the kernel are not eliminated")
    # the quadratic term is det H_2'' but for a factor, which is zero exactly
    return whole.composed(x).beyond(2), rest


def _leading(energy: Truncated, scalars: Scalars) -> tuple[int | None, Any]:
    """M and a, enclosed; None where no term is proved to be the first that is not zero."""
    for (order,), value in sorted(energy.coefficients.items()):
        if scalars.differs(value):
            return order, scalars.enclosed(value)
        if not scalars.is_zero(value):
            break
    return None, None


def _determinant(rows: list[list[Any]], scalars: Scalars) -> arb:
    return scalars.enclosed(determinant_by_traces(rows, rows[0][0] * 0, rows[0][0] * 0 + 1))


def _verify(
    enclosed: Truncated,
    frequencies: Sequence[arb],
    place: int,
    leading: tuple[int, arb],
    delta: arb,
) -> None:
    """The normal form by Lie series, with the same first term and the same signs.  Raises NotVerified."""
    order, a = leading
    other = acb(0, frequencies[0]) if frequencies else None
    form, slope = on_zero_root(enclosed, other)
    if not all(value.contains(0) for value in defects(enclosed, form)):
        raise NotVerified("the normal form, substituted, is not what the Hamiltonian becomes")
    n = len(form.linear.roots)

    def pure(k: int) -> acb:
        value: acb = form.hamiltonian[tuple(k * int(i == 0) for i in range(2 * n))]
        return value

    scale = form.linear.columns[0][place]
    agree = all(pure(k).contains(0) for k in range(3, order)) and pure(order).overlaps(a * scale**order)
    if not agree or not (slope.real * delta > 0):
        raise NotVerified("the normal form and the energy along the kernel differ")
