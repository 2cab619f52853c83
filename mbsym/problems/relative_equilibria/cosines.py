"""Direction cosines as unknowns of a rest, in place of the sines and cosines of three angles.

The orientation of a body against the one it hangs on is a matrix R (rows: the axes of the body in components of the
previous one).  What acts at rest depends on R, not on the angles that describe it, and where the angles are regular

    f = 0   if and only if   tau = 0,      tau: the moment in axes of either body (``charts.moment_components``).

In the entries of two columns u, v (or two rows) of R, which determine the third as u x v, tau is a polynomial of low
degree: of a gyrostat in an orbit tau = 3 e x I e - n x (I n + h).  With  u.u = v.v = 1, u.v = 0  such a system has one
solution for each orientation, where sines and cosines have two, and its Groebner basis is much smaller.

A trigonometric polynomial g is written in the entries by linear algebra: the monomials of degree up to d in them,
written out in sines and cosines, are independent or dependent vectors over QQ, and g is a combination of them or is
not.  It is an identity, so nothing has to be trusted: where it does not come out for some g, there is no such system.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement
from typing import Any

from flint import fmpq, fmpq_mat

from mbsym.algebra.factors import occurring
from mbsym.algebra.matrices import reduced_rows
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.mechanics.charts import Joint, rows
from mbsym.mechanics.rest import Rest

#: Degrees of the monomials in direction cosines that are tried, and the most of them.
DEGREES = (1, 2, 3)
MOST_MONOMIALS = 120

Entry = tuple[int, int]
Terms = dict[tuple[int, ...], Any]


@dataclass(frozen=True)
class Choice:
    """Which entries of R are unknowns: one or two of its columns, or of its rows, each a unit vector."""

    vectors: tuple[tuple[Entry, ...], ...]

    @property
    def entries(self) -> tuple[Entry, ...]:
        return tuple(x for vector in self.vectors for x in vector)

    def third(self) -> tuple[Entry, ...]:
        """The entries of the line that follows from two, in the order of its components."""
        column = self.vectors[0][0][1] == self.vectors[0][1][1]
        used = {vector[0][1] if column else vector[0][0] for vector in self.vectors}
        (left,) = {0, 1, 2} - used
        return tuple((k, left) if column else (left, k) for k in range(3))

    def sign(self) -> int:
        """third = sign * (first x second)."""
        column = self.vectors[0][0][1] == self.vectors[0][1][1]
        first, second = (vector[0][1] if column else vector[0][0] for vector in self.vectors)
        return 1 if (second - first) % 3 == 1 else -1


def choices(joint: Joint) -> Iterator[Choice]:
    """Unknowns that may do for a joint: what its free angles leave, else two columns or two rows."""
    columns = [tuple((k, j) for k in range(3)) for j in range(3)]
    lines = [tuple((k, j) for j in range(3)) for k in range(3)]
    if joint.first_free:
        yield Choice((columns[joint.axes[0] - 1],))
    elif joint.last_free:
        yield Choice((lines[joint.axes[2] - 1],))
    else:
        for part in (columns, lines):
            for pair in combinations(part, 2):
                yield Choice(pair)


class Cosines:
    """The entries of one joint's R as polynomials in its sines and cosines, and the way back."""

    def __init__(self, found: Rest, joint: Joint, choice: Choice) -> None:
        self.ring: Ring = found.ring
        self.joint, self.choice = joint, choice
        self.matrix = rows(found, joint)
        self.own = frozenset(
            self.ring.index(kind, name)
            for name in joint.angles
            for kind in ("sine", "cosine")
            if self.ring.has(kind, name)
        )
        self.plain = frozenset(self.ring.index("coordinate", name) for name in joint.angles)

    def written(self, polynomials: Sequence[Polynomial]) -> list[list[tuple[tuple[int, ...], Terms]]] | None:
        """Each g as pairs (exponents of the entries, coefficients in the other generators by their monomials), or None.

        g = sum over the pairs of  (product of entries) * (the polynomial of the terms).
        """
        parts = [self._split(x) for x in polynomials]
        if any(part is None for part in parts):
            return None
        vectors = [(k, rest, inner) for k, part in enumerate(parts) for rest, inner in (part or {}).items()]
        for degree in DEGREES:
            monomials = self._monomials(degree)
            if len(monomials) > MOST_MONOMIALS:
                return None
            weights = _combinations([x for _, x in monomials], [inner for _, _, inner in vectors])
            if weights is None:
                continue
            found: list[dict[tuple[int, ...], Terms]] = [{} for _ in polynomials]
            for (k, rest, _), weight in zip(vectors, weights, strict=True):
                for (exponents, _), number in zip(monomials, weight, strict=True):
                    if number:
                        found[k].setdefault(exponents, {})[rest] = number
            return [list(item.items()) for item in found]
        return None

    def _split(self, x: Polynomial) -> dict[tuple[int, ...], Terms] | None:
        """By the monomials of the other generators; None where one of these is made of the joint's angles."""
        for k in occurring([x]):
            argument = self.ring.generators[k].argument
            if k in self.plain or (argument is not None and self.own & set(_beneath(self.ring, argument))):
                return None
        parts: dict[tuple[int, ...], Terms] = {}
        for monomial, coefficient in self.ring.reduce(x).terms():
            inner = tuple(int(e) if k in self.own else 0 for k, e in enumerate(monomial))
            rest = tuple(0 if k in self.own else int(e) for k, e in enumerate(monomial))
            parts.setdefault(rest, {})[inner] = coefficient
        return parts

    def _monomials(self, degree: int) -> list[tuple[tuple[int, ...], Terms]]:
        """(exponents, its terms in sines and cosines), short ones first."""
        entries = [self.matrix[k][j] for k, j in self.choice.entries]
        known: dict[tuple[int, ...], Polynomial] = {(): self.ring.one}
        found = []
        for size in range(degree + 1):
            for chosen in combinations_with_replacement(range(len(entries)), size):
                if chosen:
                    known[chosen] = self.ring.reduce(known[chosen[:-1]] * entries[chosen[-1]])
                exponents = tuple(chosen.count(k) for k in range(len(entries)))
                found.append((exponents, {tuple(map(int, m)): c for m, c in known[chosen].terms()}))
        return found


def _beneath(ring: Ring, x: Polynomial) -> set[int]:
    """The generators that a polynomial is made of, however deep."""
    reached: set[int] = set()
    pending = [*occurring([x])]
    while pending:
        k = pending.pop()
        if k not in reached:
            reached.add(k)
            argument = ring.generators[k].argument
            pending += [] if argument is None else [*occurring([argument])]
    return reached


def _combinations(basis: Sequence[Terms], wanted: Sequence[Terms]) -> list[list[Any]] | None:
    """Numbers w with  sum_k w_k basis_k = wanted  for each of ``wanted``, earlier members first; else None."""
    every = [*basis, *wanted]
    places = {m: k for k, m in enumerate(dict.fromkeys(m for x in every for m in x))}
    if not wanted:
        return []
    table = [[fmpq(0)] * len(every) for _ in places]
    for column, x in enumerate(every):
        for monomial, coefficient in x.items():
            table[places[monomial]][column] = fmpq(coefficient)
    reduced = reduced_rows(fmpq_mat(table))
    if any(pivot >= len(basis) for pivot in reduced):
        return None
    found = []
    for k in range(len(wanted)):
        numbers = [fmpq(0)] * len(basis)
        for pivot, row in reduced.items():
            numbers[pivot] = row[len(basis) + k]
        found.append(numbers)
    return found
