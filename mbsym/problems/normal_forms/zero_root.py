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

from mbsym.algebra.matrices import adjugate_at, adjugate_slope_at, determinant_by_traces, faddeev, inverted
from mbsym.algebra.truncated import Space, Truncated, bracket, flow
from mbsym.problems.normal_forms.birkhoff import Linear, NormalForm, absolute, diagonalised, hessian, matrix_of, pairing
from mbsym.problems.normal_forms.result import Judged, Outcome, Theorem, Why, defects
from mbsym.problems.normal_forms.twist import NotVerified, signed

# Normal forms of Hamiltonians whose linear part is not diagonal: H_2 = sum lambda_k xi_k eta_k + N, N nilpotent.
#
# Two cases, both in canonical coordinates xi, eta that are complex where the roots are:
#
# * a double root lambda = i w with one eigenvector, A v = lambda v, A u = lambda u + v:
#
#       x = xi_1 v + xi_2 u + eta_1 u*/e - eta_2 v*/e,      e = [v, u*]
#       H_2 = lambda (xi_1 eta_1 + xi_2 eta_2) + xi_2 eta_1
#
#   with [a, b] = sum a_i b_(n+i) - a_(n+i) b_i, which is 0 of v and v*, and of u and u* by the choice of u;
# * a zero root, A v = 0, A u = v, beside at most one pair lambda:
#
#       x = xi_1 v + eta_1 u/d + xi_2 ... + eta_2 ...,      d = [v, u],      H_2 = eta_1^2/(2 d) + lambda xi_2 eta_2
#
# Degree by degree chi with H_k + {H_2, chi} = what stays.  With S the part that is diagonal on products xi^a eta^b this
# is chi = S^-1 r + ..., r led on through N, which ends because N is nilpotent.  What stays: products with
# lambda.(a - b) = 0, and of these with a zero root only those without eta_1, the others are {eta_1^2, .} of something.
#
# Source: A. G. Sokolskii, J. Appl. Math. Mech. 38 (1974) 741, 41 (1977) 20; J.-C. van der Meer, The Hamiltonian Hopf
# Bifurcation (1985), chapter 2.


#: chi of a product with lambda.(a - b) = 0 that does not stay; None where it stays.
Solves = Callable[[tuple[int, ...], acb], "tuple[tuple[int, ...], acb] | None"]


def chain(hamiltonian: Truncated, root: acb) -> tuple[list[acb], list[acb]]:
    """v and u with A v = root v, A u = root u + v: a column of adj(s - A) and of its derivative at a double root."""
    matrix, m = matrix_of(hamiltonian), hamiltonian.space.variables
    whole = adjugate_at(matrix, root, acb(0), acb(1))
    column = max(range(m), key=lambda j: sum(absolute(row[j]) for row in whole))
    return [row[column] for row in whole], [row[column] for row in adjugate_slope_at(matrix, root, acb(0), acb(1))]


def on_double_root(whole: Truncated, root: acb) -> tuple[NormalForm, acb]:
    """The normal form of two degrees of freedom at a double ``root`` i w with one eigenvector, and e = [v, u*].

    Divisions by what may be zero give enclosures that are not finite, of which nothing is said.
    """
    v, u = chain(whole, root)
    e = pairing(v, conjugate(u))
    shift = -pairing(u, conjugate(u)) / (2 * e)
    u = [a + shift * b for a, b in zip(u, v, strict=True)]
    columns = (tuple(v), tuple(u), tuple(x / e for x in conjugate(u)), tuple(-x / e for x in conjugate(v)))
    space = whole.space
    nilpotent = Truncated(space, {(0, 1, 1, 0): acb(1)})
    return _formed(whole, Linear((root, root), columns), nilpotent, lambda key, value: None), e


def conjugate(column: Sequence[acb]) -> list[acb]:
    return [x.conjugate() for x in column]


def on_zero_root(whole: Truncated, other: acb | None) -> tuple[NormalForm, acb]:
    """The normal form of one or two degrees of freedom with a zero root of one eigenvector, and 1/d = [v, u]^-1.

    ``other`` is lambda of the other degree of freedom.
    """
    v, u = chain(whole, acb(0))
    slope = 1 / pairing(v, u)
    u = [x * slope for x in u]
    columns, roots = [tuple(v), tuple(u)], [acb(0)]
    if other is not None:
        first, second = diagonalised(whole, [other], lambda x: 1 / x, absolute).columns
        columns, roots = [tuple(v), first, tuple(u), second], [acb(0), other]
    n = len(roots)
    key = tuple(2 * int(k == n) for k in range(2 * n))
    nilpotent = Truncated(whole.space, {key: slope / 2})

    def solves(exponents: tuple[int, ...], value: acb) -> tuple[tuple[int, ...], acb] | None:
        """{eta_1^2/(2 d), xi_1^(a+1) eta_1^(b-1) P} = -(a + 1)/d xi_1^a eta_1^b P."""
        if not exponents[n]:
            return None
        higher = list(exponents)
        higher[0], higher[n] = higher[0] + 1, higher[n] - 1
        return tuple(higher), value / (slope * higher[0])

    return _formed(whole, Linear(tuple(roots), tuple(columns)), nilpotent, solves), slope


def _formed(hamiltonian: Truncated, linear: Linear, nilpotent: Truncated, solves: Solves) -> NormalForm:
    space, n = hamiltonian.space, len(linear.roots)
    whole = hamiltonian.composed([space.linear(column[i] for column in linear.columns) for i in range(2 * n)])
    quadratic = {tuple(int(j in (k, n + k)) for j in range(2 * n)): root for k, root in enumerate(linear.roots)}
    # terms of degree 2 are these by construction: enclosures would leave balls about zero beside them
    whole = whole.beyond(2) + Truncated(space, quadratic) + nilpotent
    generators = []
    for degree in range(3, space.order + 1):
        part = whole.part(degree)
        generator = _generator(part, linear.roots, nilpotent, solves)
        generators.append(generator)
        if generator.coefficients:
            whole = flow(whole, generator)
            left = {
                key: value
                for key, value in whole.coefficients.items()
                if sum(key) != degree or (_still(key, linear.roots) and solves(key, acb(1)) is None)
            }
            whole = Truncated(space, left)
    return NormalForm(linear, whole, tuple(generators))


def _still(key: tuple[int, ...], roots: Sequence[acb]) -> bool:
    """lambda.(a - b) = 0: the roots that are not zero are equal, here."""
    n = len(roots)
    return sum(a - b for a, b, root in zip(key[:n], key[n:], roots, strict=True) if not root.is_zero()) == 0


def _generator(part: Truncated, roots: Sequence[acb], nilpotent: Truncated, solves: Solves) -> Truncated:
    space, n = part.space, len(roots)
    truncated, rest = space.nothing, part
    for _ in range(2 * space.order + 2):
        if not rest.coefficients:
            break
        solved, still = {}, {}
        for key, value in rest.coefficients.items():
            if _still(key, roots):
                answer = solves(key, value)
                if answer is not None:
                    still[answer[0]] = answer[1]
                continue
            divisor = acb(0)
            for a, b, root in zip(key[:n], key[n:], roots, strict=True):
                divisor += root * (a - b)
            solved[key] = value / divisor
        truncated = truncated + Truncated(space, solved) + Truncated(space, still)
        rest = bracket(nilpotent, Truncated(space, solved))
    return truncated


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
        other_roots: list[acb] = acb_poly(coefficients).roots(tol=arb(2) ** (-(ctx.prec // 2)))
    except ValueError:
        return None
    return sorted(other_roots, key=lambda z: float(z.real.mid()))


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
    second = hessian(whole)
    rest = [[second[i][k] for k in others] for i in others]
    back = inverted(rest, scalars.inverse, source.zero, source.one)
    x = [space.nothing] * m
    x[place] = space.variable(0)
    for step in range(source.order):
        left = [slope.composed(x) for slope in slopes]
        # the linear terms are solved exactly by the first step: enclosures would leave balls about zero
        left = [slope.beyond(1) if step else slope for slope in left]
        for row, k in zip(back, others, strict=True):
            change = space.nothing
            for factor, truncated in zip(row, left, strict=True):
                change = change - truncated.scaled(factor)
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


def _verify(enclosed: Truncated, frequencies: Sequence[arb], place: int, leading: tuple[int, arb], delta: arb) -> None:
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
