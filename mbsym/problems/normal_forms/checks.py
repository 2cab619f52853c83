"""The second route to a normal form: its transformation written out, and substituted.

The generators give x(xi, eta) by Lie series.  Then two things are looked at that the normalisation does not use: the
brackets {x_i, x_j} are those of J to the order, so that the transformation is canonical; and H(x(xi, eta)), formed by
plain substitution, is the normal form to the order.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from flint import arb, ctx

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls
from mbsym.algebra.truncated import Truncated, bracket, flow
from mbsym.problems.normal_forms.birkhoff import NormalForm
from mbsym.problems.normal_forms.result import InSymbols, NormalForms


def transformation(found: NormalForm) -> list[Truncated]:
    """x_1 ... x_n, p_1 ... p_n in xi and eta, to the order of the normal form."""
    space = found.hamiltonian.space
    rows = [space.linear(column[i] for column in found.linear.columns) for i in range(space.variables)]
    for generator in found.generators:
        rows = [flow(row, generator) for row in rows]
    return rows


def defects(hamiltonian: Truncated, found: NormalForm) -> Iterator[Any]:
    """What has to vanish: coefficients of {x_i, x_j} - J_ij below the order, and of H(x(xi, eta)) - normal form."""
    rows = transformation(found)
    space, n = found.hamiltonian.space, len(found.linear.roots)
    for i, row in enumerate(rows):
        for j in range(i):
            expected = space.constant(space.one).scaled(-1) if i == j + n else space.nothing
            rest = bracket(row, rows[j]) - expected
            yield from (value for key, value in rest.coefficients.items() if sum(key) < space.order)
    difference = hamiltonian.composed(rows) - found.hamiltonian
    yield from difference.coefficients.values()


def symbols_agree(found: NormalForms, values: Mapping[str, Any]) -> bool | None:
    """Whether D_4 and w_1^2 w_2^2 in parameters are at the values what enclosures of the normal form there are.

    Roots of polynomials and floating balls on one side, a tower of square roots over the parameters on the other.  None
    where one of them is not there.
    """
    symbols, judged = found.in_symbols, found.at_values
    if not isinstance(symbols, InSymbols) or judged is None or len(judged.frequencies) != 2:
        return None
    with ctx.workprec(320):
        balls = {"pi": arb.pi()}
        balls |= {k: x if isinstance(x, arb) else arb(x.numerator) / x.denominator for k, x in values.items()}
        carry = Carrier(symbols.determinant.ring, Balls(balls), balls)
        one, other = judged.frequencies
        pairs = [(carry(symbols.product.polynomial), (one * other) ** 2)]
        pairs += [(carry(symbols.determinant.polynomial), x) for order, x in judged.determinants if order == 4]
        return all((a - b).contains(0) for a, b in pairs)
