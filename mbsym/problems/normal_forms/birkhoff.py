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

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import faddeev
from mbsym.algebra.tower import Element, Tower
from mbsym.algebra.truncated import Space, Truncated, flow
from mbsym.problems.normal_forms.exact import even_part, exact_values, over_tower, rational_squares
from mbsym.problems.normal_forms.expansion import Expansion


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
    rows, n = hessian(hamiltonian), hamiltonian.space.variables // 2
    return [*rows[n:], *([-x for x in row] for row in rows[:n])]


def hessian(hamiltonian: Truncated) -> list[list[Any]]:
    """The second derivatives of H at 0."""
    m = hamiltonian.space.variables
    rows = [hamiltonian.part(2).derivative(k) for k in range(m)]
    unit = [tuple(int(j == k) for j in range(m)) for k in range(m)]
    return [[row[x] for x in unit] for row in rows]


def pairing(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """[a, b] = sum a_k b_(n + k) - a_(n + k) b_k."""
    n = len(a) // 2
    first, *others = (a[i] * b[n + i] - a[n + i] * b[i] for i in range(n))
    return sum(others, first)


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
    adjugates, _ = faddeev(matrix_of(hamiltonian), space.zero, space.one)
    first, second = [], []
    for root in roots:
        best: tuple[float, list[Any], list[Any], Any] | None = None
        for column in range(m):
            v, u = (_column(adjugates, s, column, space.zero) for s in (root, -root))
            d = pairing(v, u)
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
    entries = [zero] * len(adjugates)
    for matrix in adjugates:
        entries = [x * root + row[column] for x, row in zip(entries, matrix, strict=True)]
    return entries


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
        coefficients = {}
        for key, value in whole.part(degree).coefficients.items():
            difference = tuple(a - b for a, b in zip(key[:n], key[n:], strict=True))
            if not any(difference) or difference in resonances:
                continue
            if difference not in divisors:
                total = space.zero
                for k, root in zip(difference, linear.roots, strict=True):
                    total = total + root * k
                divisors[difference] = inverse(total)
            coefficients[key] = value * divisors[difference]
        generator = Truncated(space, coefficients)
        generators.append(generator)
        if coefficients:
            # what the choice of chi removes is removed exactly: enclosures would leave balls about zero
            removed = set(coefficients)
            whole = flow(whole, generator)
            whole = Truncated(space, {k: v for k, v in whole.coefficients.items() if k not in removed})
    return NormalForm(linear, _diagonal(whole, linear), tuple(generators))


def _diagonal(whole: Truncated, linear: Linear) -> Truncated:
    """With sum lambda xi eta for the terms of degree 2, which are that by construction."""
    space, n = whole.space, len(linear.roots)
    coefficients = {key: value for key, value in whole.coefficients.items() if sum(key) != 2}
    for k, root in enumerate(linear.roots):
        coefficients[tuple(int(j in (k, n + k)) for j in range(2 * n))] = root
    return Truncated(space, coefficients)


# Whether the term that a resonance of third order leaves in the normal form is zero, exactly.
#
# The normal form keeps of H_3 what is not removed, so that the coefficient of the product of the xi_j^k_j, k.lambda =
# 0, is that of H_3(sum xi_j v_j) with the eigenvectors v_j for lambda_j = i Omega_j.  The frequencies in a resonance
# of third order are rational multiples of one of them, w: of 1:2 by itself, of w_1 = w_2 + w_3 where all squares are
# rational.  So the coefficient is a number of Q(i w), or of that over the roots in H, where zero is seen by
# reduction.
#
# What is found to be zero is; where it is not found (roots that depend on each other, values that are not rational),
# nothing is said.


def is_zero_exactly(
    expansion: Expansion, values: Mapping[str, Any], vector: Sequence[int], omega: Sequence[arb]
) -> bool:
    """``vector`` of the absolute frequencies |Omega_k|, ``omega`` with the signs of their energies."""
    numbers = exact_values(expansion, values)
    if numbers is None:
        return False
    tower, exact = numbers
    try:
        return of_hamiltonian(tower, over_tower(expansion, tower, exact).hamiltonian(), vector, omega)
    except (Failure, ZeroDivisionError):
        return False


def of_hamiltonian(tower: Tower, hamiltonian: Truncated, vector: Sequence[int], omega: Sequence[arb]) -> bool:
    """The same of a Hamiltonian over the tower.  Raises what its arithmetic raises."""
    support = [j for j, k in enumerate(vector) if k]
    known = _in_units_of_one(tower, hamiltonian, vector, [abs(x) for x in omega])
    if known is None:
        return False
    square, ratios = known
    base = tower.square_root(-square)
    roots = [base * (ratio if omega[j] > 0 else -ratio) for j, ratio in zip(support, ratios, strict=True)]
    columns = diagonalised(hamiltonian, roots, lambda _: tower.one, lambda d: float(not d.is_zero())).columns
    count = len(support)
    # xi_j where k_j Omega_j > 0, its conjugate where that is negative
    chosen = [columns[n] if vector[j] * omega[j] > 0 else columns[count + n] for n, j in enumerate(support)]
    space = Space(count, 3, tower.zero, tower.one)
    images = [space.linear(column[row] for column in chosen) for row in range(hamiltonian.space.variables)]
    term: Element = hamiltonian.part(3).composed(images)[tuple(abs(vector[j]) for j in support)]
    return term.is_zero()


def _in_units_of_one(
    tower: Tower, hamiltonian: Truncated, vector: Sequence[int], sizes: Sequence[arb]
) -> tuple[Element, list[Any]] | None:
    """(w^2, w_j/w for the frequencies in the resonance); None where they are not known so."""
    support = [j for j, k in enumerate(vector) if k]
    even = even_part(matrix_of(hamiltonian), tower.zero, tower.one)
    if len(sizes) == 2:  # w and 2 w: the sum of squares is 5 w^2
        return even[1] / 5, [Fraction(3 - abs(vector[j])) for j in support]
    squares = rational_squares(tower, even)
    if squares is None:
        return None
    own = [next((x for x in squares if (sizes[j] * sizes[j]).contains(x)), None) for j in support]
    if any(x is None for x in own):
        return None
    ratios = [rationals.square_root(x / own[0]) for x in own if x is not None and own[0] is not None]
    return None if None in ratios or own[0] is None else (tower.element(own[0]), [x for x in ratios if x is not None])
