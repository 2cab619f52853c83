"""Whether the term that a resonance of third order leaves in the normal form is zero, exactly.

The normal form keeps of H_3 what is not removed, so that the coefficient of the product of the xi_j^k_j, k.lambda = 0,
is that of H_3(sum xi_j v_j) with the eigenvectors v_j for lambda_j = i Omega_j.  The frequencies in a resonance of
third order are rational multiples of one of them, w: of 1:2 by itself, of w_1 = w_2 + w_3 where all squares are
rational.  So the coefficient is a number of Q(i w), or of that over the roots in H, where zero is seen by reduction.

What is found to be zero is; where it is not found (roots that depend on each other, values that are not rational),
nothing is said.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb, fmpq

from mbsym.algebra.failures import Failure
from mbsym.algebra.tower import Element, Tower
from mbsym.algebra.truncated import Space, Truncated
from mbsym.mechanics.rest import rational_values
from mbsym.problems.normal_forms.birkhoff import diagonalised, matrix_of
from mbsym.problems.normal_forms.exact import even_part, over_tower, rational_squares
from mbsym.problems.normal_forms.expansion import Expansion


def is_zero_exactly(found: Expansion, values: Mapping[str, Any], vector: Sequence[int], omega: Sequence[arb]) -> bool:
    """``vector`` of the absolute frequencies |Omega_k|, ``omega`` with the signs of their energies."""
    exact = rational_values(values)
    if len(exact) < len(values):
        return False
    tower = Tower()
    try:
        return of_hamiltonian(tower, over_tower(found, tower, exact).hamiltonian(), vector, omega)
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
) -> tuple[Element, list[Fraction]] | None:
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
    ratios = [_root(x / own[0]) for x in own if x is not None and own[0] is not None]
    return None if None in ratios or own[0] is None else (tower.element(own[0]), [x for x in ratios if x is not None])


def _root(x: fmpq) -> Fraction | None:
    """The rational square root, if there is one."""
    top, bottom = x.p.isqrt(), x.q.isqrt()
    return Fraction(int(top), int(bottom)) if top * top == x.p and bottom * bottom == x.q else None
