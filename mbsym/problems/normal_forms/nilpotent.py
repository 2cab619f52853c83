"""Normal forms of Hamiltonians whose linear part is not diagonal: H_2 = sum lambda_k xi_k eta_k + N, N nilpotent.

Two cases, both in canonical coordinates xi, eta that are complex where the roots are:

* a double root lambda = i w with one eigenvector, A v = lambda v, A u = lambda u + v:

      x = xi_1 v + xi_2 u + eta_1 u*/e - eta_2 v*/e,      e = [v, u*]
      H_2 = lambda (xi_1 eta_1 + xi_2 eta_2) + xi_2 eta_1

  with [a, b] = sum a_i b_(n+i) - a_(n+i) b_i, which is 0 of v and v*, and of u and u* by the choice of u;
* a zero root, A v = 0, A u = v, beside at most one pair lambda:

      x = xi_1 v + eta_1 u/d + xi_2 ... + eta_2 ...,      d = [v, u],      H_2 = eta_1^2/(2 d) + lambda xi_2 eta_2

Degree by degree chi with H_k + {H_2, chi} = what stays.  With S the part that is diagonal on products xi^a eta^b this
is chi = S^-1 r + ..., r led on through N, which ends because N is nilpotent.  What stays: products with
lambda.(a - b) = 0, and of these with a zero root only those without eta_1, the others are {eta_1^2, .} of something.

Source: A. G. Sokolskii, J. Appl. Math. Mech. 38 (1974) 741, 41 (1977) 20; J.-C. van der Meer, The Hamiltonian Hopf
Bifurcation (1985), chapter 2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from flint import acb

from mbsym.algebra.matrices import adjugate_at, adjugate_slope_at
from mbsym.algebra.truncated import Truncated, bracket, flow
from mbsym.problems.normal_forms.birkhoff import Linear, NormalForm, absolute, diagonalised, matrix_of

#: chi of a product with lambda.(a - b) = 0 that does not stay; None where it stays.
Solves = Callable[[tuple[int, ...], acb], "tuple[tuple[int, ...], acb] | None"]


def pairing(a: Sequence[acb], b: Sequence[acb]) -> acb:
    """[a, b]."""
    n, total = len(a) // 2, acb(0)
    for i in range(n):
        total += a[i] * b[n + i] - a[n + i] * b[i]
    return total


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
    columns = (
        tuple(v),
        tuple(u),
        tuple(x / e for x in conjugate(u)),
        tuple(-x / e for x in conjugate(v)),
    )
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
        one, two = diagonalised(whole, [other], lambda x: 1 / x, absolute).columns
        columns, roots = [tuple(v), one, tuple(u), two], [acb(0), other]
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
    found, rest = space.nothing, part
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
        found = found + Truncated(space, solved) + Truncated(space, still)
        rest = bracket(nilpotent, Truncated(space, solved))
    return found
