"""Conditions of rest as integer polynomials in unknowns: sines, cosines, roots, reciprocals, plain coordinates."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from flint import fmpq, fmpz

from mbsym.algebra.factors import occurring
from mbsym.algebra.polynomial_systems import AlgebraicPoint, context
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.python import python_text
from mbsym.problems.relative_equilibria.place import PRECISION


class Unknowns:
    """Which generators of the ring are unknowns, and the way into integer polynomials in them."""

    def __init__(self, ring: Ring, equations: Sequence[Polynomial]) -> None:
        self.ring = ring
        used = set(occurring(equations))
        pending = list(used)
        while pending:
            g = ring.generators[pending.pop()]
            more: set[int] = set()
            if g.argument is not None:
                more = set(occurring([g.argument]))
            elif g.kind in ("sine", "cosine"):
                more = {ring.index("sine", g.name), ring.index("cosine", g.name)}
            pending += more - used
            used |= more
        self.indices = sorted(used)
        letters = {"sine": "sin", "cosine": "cos"}
        self.names = []
        for k in self.indices:
            g = ring.generators[k]
            name = f"{g.name}/{g.denominator}" if g.denominator != 1 else g.name
            if g.argument is not None:
                written = python_text(ring, ring.context.gen(k))
                self.names.append(written if g.kind == "root" else f"({written})")
            else:
                self.names.append(f"{letters[g.kind]}({name})" if g.kind in letters else name)
        self.context = context([f"x{k}" for k in range(len(self.indices))])

    def holds(self, x: Polynomial) -> bool:
        return all(k in self.indices for k in occurring([x]))

    def polynomial(self, x: Polynomial) -> Any:
        """x times a positive integer."""
        common = math.lcm(*(int(c.q) for c in x.coeffs()))
        terms = {tuple(m[k] for k in self.indices): fmpz(int((c * common).p)) for m, c in x.terms()}
        return self.context.from_dict(terms)

    def back(self, x: Any) -> Polynomial:
        """An integer polynomial in the unknowns, in the ring."""
        terms = {}
        for monomial, coefficient in x.terms():
            exponents = [0] * len(self.ring.generators)
            for k, e in zip(self.indices, monomial, strict=True):
                exponents[k] = int(e)
            terms[tuple(exponents)] = fmpq(coefficient)
        return self.ring.context.from_dict(terms)

    def relations(self) -> list[Any]:
        """s^2 + c^2 = 1 of every angle, root^2 = radicand, x * reciprocal = 1."""
        ring, found = self.ring, []
        for k in self.indices:
            g = ring.generators[k]
            one = ring.context.gen(k)
            if g.kind == "sine":
                found.append(one**2 + ring.generator("cosine", g.name) ** 2 - 1)
            elif g.kind == "root":
                found.append(one**2 - g.argument)
            elif g.kind == "reciprocal":
                found.append(one * g.argument - 1)
        return [self.polynomial(x) for x in found]

    def is_relation(self, x: Any) -> bool:
        return any(x == y or x == -y for y in self.relations())

    def bounded(self) -> list[int]:
        return [i for i, k in enumerate(self.indices) if self.ring.generators[k].kind in ("sine", "cosine")]

    def roots_agree(self, point: AlgebraicPoint) -> bool:
        """Whether every square root is not negative."""
        for i, k in enumerate(self.indices):
            is_root = self.ring.generators[k].kind == "root" and point.values[i] != 0
            if is_root and point.enclosure(point.values[i], PRECISION) < 0:
                return False
        return True

    def text(self, x: Any) -> str:
        """A polynomial as a reader writes it."""
        parts = []
        for monomial, coefficient in x.terms():
            factors = [name if e == 1 else f"{name}**{e}" for name, e in zip(self.names, monomial, strict=True) if e]
            number = int(coefficient)
            if not factors or abs(number) != 1:
                factors.insert(0, str(abs(number)))
            parts.append(("-" if number < 0 else "+", "*".join(factors)))
        first, *others = parts
        return ("-" if first[0] == "-" else "") + first[1] + "".join(f" {sign} {term}" for sign, term in others)
