"""Whether integrals are independent as functions: the rank of their gradients at a random state modulo a prime.

The rank there is at most that at almost all states: that they are independent is proved by it.  That one depends on the
others is proved where there cannot be more (the states have n dimensions, a motion that is no rest leaves n - 1
functions); elsewhere it is verified at the random state.
"""

from __future__ import annotations

import random

from flint import nmod_mat

from mbsym.algebra.certainty import Certainty
from mbsym.problems.polynomial_integrals import frames
from mbsym.problems.polynomial_integrals.gradings import Grading
from mbsym.problems.polynomial_integrals.modular import ModularField, Terms


class Independence:
    """Of integrals that are put one after the other."""

    def __init__(self, there: ModularField, grading: Grading) -> None:
        self.there = there
        free = grading.free or grading.frames  # relations are integrals like others
        self.state = None if there.field.relations and not free else self._anywhere()
        if grading.frames:
            self.state = frames.state(there)
        if self.state is None:
            self.state = self._on_the_relations()
        self.rows: list[list[int]] = []
        related = 0
        if self.state is not None and not free:
            self.rows = [self._gradient(there.terms(relation)) for relation in there.field.relations]
            related = len(self.rows)
        self.most = len(there.field.variables) - related - 1
        self.rank = 0
        self._related = related

    def of(self, f: Terms) -> tuple[bool, Certainty]:
        """Whether f is independent of those before it; it is one of them from now on."""
        if self.state is None:
            return False, Certainty.UNDECIDED
        rows = [*self.rows, self._gradient(f)]
        if nmod_mat(rows, self.there.prime).rank() == len(rows):
            self.rows, self.rank = rows, self.rank + 1
            return True, Certainty.PROVED
        moves = any(self.there.slopes)
        return False, Certainty.PROVED if self.rank == self.most and moves else Certainty.VERIFIED

    def depends(self, f: Terms) -> bool:
        """Whether f adds nothing to the rank of those before it, at the random state."""
        if self.state is None:
            return False
        return bool(nmod_mat([*self.rows, self._gradient(f)], self.there.prime).rank() == len(self.rows))

    def _gradient(self, f: Terms) -> list[int]:
        assert self.state is not None
        return [slope(f, k, self.state, self.there.prime) for k in range(len(self.state))]

    def _anywhere(self) -> list[int]:
        source = random.Random(f"state {self.there.prime}")
        return [source.randrange(1, self.there.prime) for _ in self.there.field.variables]

    def _on_the_relations(self) -> list[int] | None:
        """A state that keeps relations  x^2 + ... = 0  in which each x stands alone; None where it is not so."""
        prime, source = self.there.prime, random.Random(f"states {self.there.prime}")
        rules = self.there.rules
        places = [leading.index(2) if sorted(leading)[-1] == 2 == sum(leading) else None for leading, _ in rules]
        fixed = [k for k in places if k is not None]
        if (
            len(set(fixed)) < len(rules)
            or any(m[k] for _, tail in rules for m in tail for k in fixed)
            or prime % 4 != 3
        ):
            return None
        for _ in range(200):
            state = [source.randrange(1, prime) for _ in self.there.field.variables]
            for k, (_, tail) in zip(fixed, rules, strict=True):
                square = value(tail, state, prime)
                state[k] = pow(square, (prime + 1) // 4, prime)
                if state[k] * state[k] % prime != square:
                    break
            else:
                return state
        return None


def value(f: Terms, state: list[int], prime: int) -> int:
    """f at a state."""
    total = 0
    for monomial, c in f.items():
        for x, power in zip(state, monomial, strict=True):
            if power:
                c = c * pow(x, power, prime) % prime
        total += c
    return total % prime


def slope(f: Terms, k: int, state: list[int], prime: int) -> int:
    """df/dx_k at a state."""
    part = {(*m[:k], m[k] - 1, *m[k + 1 :]): c * m[k] % prime for m, c in f.items() if m[k]}
    return value(part, state, prime)
