"""Birkhoff's normal form of a Hamiltonian H_2 + H_3 + ... + H_N over any scalars.

The eigenvectors of x' = J H_2'' x for lambda and -lambda are one column of adj(lambda - A) and of adj(-lambda - A), so
that no root but lambda itself is needed.  With them (the second ones divided by d = v.J u) in the coordinates xi, eta

    H_2 = sum lambda_k xi_k eta_k,      {xi_k, eta_k} = 1

and degree by degree chi with  H_d + {H_2, chi} = what stays: products xi^a eta^b with lambda.(a - b) = 0.  Where there
is no resonance the normal form is a polynomial in P_k = xi_k eta_k; for lambda_k = i Omega_k and real motions
P_k = -i I_k with I_k >= 0 the action and Omega_k the frequency with the sign of its energy: H_2 = sum Omega_k I_k.

Source: G. D. Birkhoff, Dynamical Systems (1927), chapter III; A. Deprit, Celestial Mechanics 1 (1969) 12-30.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any

from mbsym.algebra.matrices import faddeev
from mbsym.algebra.truncated import Space, Truncated, flow


@dataclass(frozen=True)
class Linear:
    """``columns`` are v_1 ... v_n, u_1 ... u_n: x = sum xi_k v_k + eta_k u_k; ``roots`` are lambda_1 ... lambda_n."""

    roots: tuple[Any, ...]
    columns: tuple[tuple[Any, ...], ...]


@dataclass(frozen=True)
class NormalForm:
    """``hamiltonian`` in xi, eta; ``linear`` and the ``generators`` chi_3 ... chi_N lead to it, in this order."""

    linear: Linear
    hamiltonian: Truncated
    generators: tuple[Truncated, ...]

    def actions(self, degree: int) -> dict[tuple[int, ...], Any]:
        """The coefficients of products of P_k of that degree in them."""
        n = len(self.linear.roots)
        return {
            key[:n]: value
            for key, value in self.hamiltonian.part(2 * degree).coefficients.items()
            if key[:n] == key[n:]
        }


def matrix_of(hamiltonian: Truncated) -> list[list[Any]]:
    """A of x' = A x: x' = dH/dp, p' = -dH/dx."""
    m = hamiltonian.space.variables
    n = m // 2
    rows = [hamiltonian.part(2).derivative(k) for k in range(m)]
    unit = [tuple(int(j == k) for j in range(m)) for k in range(m)]
    return [[rows[n + i][unit[j]] for j in range(m)] for i in range(n)] + [
        [-rows[i][unit[j]] for j in range(m)] for i in range(n)
    ]


def absolute(x: Any) -> float:
    """About |x|, to choose the largest by."""
    return float(abs(x).mid())


def diagonalised(
    hamiltonian: Truncated, roots: Sequence[Any], inverse: Callable[[Any], Any], size: Callable[[Any], float]
) -> Linear:
    """Columns for simple ``roots`` lambda_k, one of each pair; ``size`` tells how far from zero a divisor is.

    Raises what ``inverse`` raises where d is zero (not for a simple root).
    """
    space = hamiltonian.space
    m = space.variables
    n = m // 2
    adjugates, _ = faddeev(matrix_of(hamiltonian), space.zero, space.one)
    first, second = [], []
    for root in roots:
        best: tuple[float, list[Any], list[Any], Any] | None = None
        for column in range(m):
            v, u = (_column(adjugates, s, column, space.zero) for s in (root, -root))
            d = space.zero
            for i in range(n):
                d = d + v[i] * u[n + i] - v[n + i] * u[i]
            measure = size(d)
            if best is None or measure > best[0]:
                best = (measure, v, u, d)
        assert best is not None
        factor = inverse(best[3])
        first.append(tuple(best[1]))
        second.append(tuple(x * factor for x in best[2]))
    return Linear(tuple(roots), (*first, *second))


def _column(adjugates: Sequence[Sequence[Sequence[Any]]], root: Any, column: int, zero: Any) -> list[Any]:
    """A column of sum B_k root^(m-1-k)."""
    found = [zero] * len(adjugates)
    for matrix in adjugates:
        found = [x * root + row[column] for x, row in zip(found, matrix, strict=True)]
    return found


def normal_form(
    hamiltonian: Truncated,
    linear: Linear,
    inverse: Callable[[Any], Any],
    resonances: Collection[tuple[int, ...]] = (),
    space: Space | None = None,
) -> NormalForm:
    """The normal form to the order of ``space``, in which the complex coordinates live.

    ``resonances`` are the vectors k != 0 with k.lambda = 0 exactly, k and -k both; other divisors have reciprocals.
    """
    space = space or hamiltonian.space
    n = space.variables // 2
    rows = [space.linear(column[i] for column in linear.columns) for i in range(2 * n)]
    whole = hamiltonian.composed(rows)
    generators = []
    divisors: dict[tuple[int, ...], Any] = {}
    for degree in range(3, space.order + 1):
        found = {}
        for key, value in whole.part(degree).coefficients.items():
            difference = tuple(a - b for a, b in zip(key[:n], key[n:], strict=True))
            if not any(difference) or difference in resonances:
                continue
            if difference not in divisors:
                total = space.zero
                for k, root in zip(difference, linear.roots, strict=True):
                    total = total + root * k
                divisors[difference] = inverse(total)
            found[key] = value * divisors[difference]
        generator = Truncated(space, found)
        generators.append(generator)
        if found:
            # what the choice of chi removes is removed exactly: enclosures would leave balls about zero
            removed = set(found)
            whole = flow(whole, generator)
            whole = Truncated(space, {k: v for k, v in whole.coefficients.items() if k not in removed})
    return NormalForm(linear, _diagonal(whole, linear), tuple(generators))


def _diagonal(whole: Truncated, linear: Linear) -> Truncated:
    """With sum lambda xi eta for the terms of degree 2, which are that by construction."""
    space, n = whole.space, len(linear.roots)
    kept = {key: value for key, value in whole.coefficients.items() if sum(key) != 2}
    for k, root in enumerate(linear.roots):
        kept[tuple(int(j in (k, n + k)) for j in range(2 * n))] = root
    return Truncated(space, kept)
