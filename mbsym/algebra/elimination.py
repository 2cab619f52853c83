"""Rewriting polynomials in a user's own symbols: ``a = Jy``, ``alpha = (c - b)/a``.

Two exact means, cheap before dear.  ``Combination``: is p a rational combination sum c_k n_k of the definitions?
(One linear system over QQ; this is how matrices of linear equations are usually printed.)  ``Elimination``: solve the
definitions one after another for a symbol that occurs linearly, and substitute.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import fmpq_mat

from mbsym.algebra.matrices import reduced_rows
from mbsym.algebra.ring import Polynomial, Ring

#: A table of rows by columns is reduced if rows * columns^2 is no more than this; beyond it p stays as it was.
MOST_WORK = 20_000_000

#: A symbol's generator index and the polynomial it stands for (in parameters only).
Definition = tuple[int, Polynomial]


def combination(ring: Ring, p: Polynomial, definitions: Sequence[Definition]) -> Polynomial | None:
    """p as sum c_k n_k with rational c_k, or as a monomial times such a sum; None if it is neither."""
    if p.is_zero() or p.is_constant():
        return p
    whole = _combination(ring, p, definitions)
    if whole is not None:
        return whole
    content = p.term_content()
    monomial = content / content.leading_coefficient()
    if monomial.is_constant():
        return None
    rest = _combination(ring, divmod(p, monomial)[0], definitions)
    return None if rest is None else monomial * rest


def _combination(ring: Ring, p: Polynomial, definitions: Sequence[Definition]) -> Polynomial | None:
    columns = [definition.to_dict() for _, definition in definitions] + [p.to_dict()]
    monomials = sorted({monomial for column in columns for monomial in column})
    if len(monomials) * len(columns) ** 2 > MOST_WORK:
        return None
    ring.spend(len(monomials) * len(columns) ** 2)
    table = fmpq_mat(len(monomials), len(columns), [column.get(m, 0) for m in monomials for column in columns])
    reduced = reduced_rows(table)
    if len(definitions) in reduced:
        return None
    gens = ring.context.gens()
    return sum((gens[definitions[k][0]] * row[-1] for k, row in reduced.items()), ring.zero)


@dataclass(frozen=True)
class Elimination:
    """``images`` maps an eliminated generator to its value in the remaining symbols."""

    ring: Ring
    images: Mapping[int, Polynomial]

    def __call__(self, p: Polynomial) -> Polynomial:
        return self.ring.substitute(p, dict(self.images))


def eliminate(ring: Ring, definitions: Sequence[Definition], candidates: Sequence[int]) -> Elimination:
    """Solves each definition, in order, for one of the candidate generators that occurs linearly in it.

    Constant coefficients are preferred (nothing is divided by), then short ones, then the order of ``candidates``.  A
    definition in which no candidate is linear stays unused.
    """
    images: dict[int, Polynomial] = {}
    gens = ring.context.gens()
    for symbol, definition in definitions:
        relation, _ = ring.fraction(ring.substitute(gens[symbol] - definition, dict(images)))
        slope = relation.derivative(symbol)
        shared = slope.gcd(relation - slope * gens[symbol])  # zero for no value of the symbol alone: it says nothing
        relation = relation if shared.is_constant() else relation / shared
        options = []
        for order, index in enumerate(candidates):
            if index in images or relation.degrees()[index] != 1:
                continue
            slope = relation.derivative(index)
            options.append((0 if slope.is_constant() else len(slope), order, index, slope))
        if not options:
            continue
        _, _, index, slope = min(options, key=lambda option: option[:2])
        rest = relation - ring.times(slope, gens[index])
        value = ring.ratio(-rest, slope)
        images = {k: ring.substitute(image, {index: value}) for k, image in images.items()}
        images[index] = value
    return Elimination(ring, images)
