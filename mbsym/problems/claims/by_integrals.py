"""Sufficiency that rests on a combination of integrals, in symbols: sleeping tops, spins of free bodies.

Chetaev's method as in ``stability.bundle``, with formulas in place of numbers: multipliers mu that annul the first
variation, and a second variation that is definite where the integrals keep their values, proved by Sylvester's minors
under the claimed conditions.  Of two free multipliers their ratio is tried where a minor of order two is greatest: for
a top this gives C^2 W^2 > 4 A m g l.  An integral that is a sum of squares of quantities that vanish on the motion may
have a multiplier as large as one likes (Finsler's lemma): it counts as these quantities being kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import components, determinant, null_space_of_polynomials
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import MOST_TERMS, Signs
from mbsym.mechanics.motion import turning, unperturbed_with
from mbsym.problems import dissipation
from mbsym.problems.claims.result import Derived
from mbsym.problems.stability.bundle import SQUARE, Conserved, by_integrals, of_integrals
from mbsym.problems.stability.verdict import Verdict

#: Larger systems are not looked at.
MOST_COORDINATES = 4

_NOT_ZERO = ("positive", "negative", "nonzero")

Rows = list[list[Polynomial]]


def verdict_with(derived: Derived, known: Signs) -> Verdict | None:
    """The verdict where ``known`` holds, by a combination of integrals; None where none is proved to be definite."""
    system, scene = derived.system, derived.scene
    if len(system.coordinates) > MOST_COORDINATES or system.constraints or system.linear is not None:
        return None
    try:
        if not derived.equilibrium.satisfied and len(derived.equilibrium.conditions) > len(derived.equilibrium.solved):
            return None
        balance = dissipation.balance(scene, derived.energy, derived.signs)
        left_out = [name for name in balance.ignorable if name not in balance.driven]
        if not balance.law.bounded or not {*turning(scene)} <= {*left_out}:
            return None
        integrals = of_integrals(scene, derived.integrals, left_out)
        if integrals is None:
            return None
        names = _Second(derived, integrals, known).definite()
        return None if names is None else by_integrals(names, bool(left_out))
    except Failure:
        return None


class _Second:
    """First and second variations of integrals on the unperturbed motion, as formulas in the parameters."""

    def __init__(self, derived: Derived, integrals: Conserved, known: Signs) -> None:
        self.ring: Ring = derived.ring
        self.known, self.names = known, integrals.names
        at = unperturbed_with(derived.scene, derived.equilibrium.determined(derived.scene))

        def here(x: Polynomial) -> Polynomial:
            value = self.ring.substitute(x, at)
            if self.ring.dependencies(value, (*derived.system.coordinates, *derived.system.velocities, "t")):
                raise Failure("not constant on the motion")
            return value

        self.gradients: Rows = [[here(x) for x in row] for row in integrals.gradients]
        self.vanishing = [here(x).is_zero() for x in integrals.polynomials]
        self.hessians: list[Rows] = [[[here(x) for x in row] for row in rows] for rows in integrals.hessians]

    def definite(self) -> tuple[str, ...] | None:
        """The names of integrals of which a combination is definite."""
        rows = list(self.gradients)
        squares = [k for k, name in enumerate(self.names) if name.startswith(SQUARE) and self.vanishing[k]]
        for k in squares:
            rows += [row for row in self.hessians[k] if any(not x.is_zero() for x in row)]
        tangent = self._null(rows, len(rows[0]))
        others = [k for k in range(len(self.names)) if k not in squares]
        columns = [[self.gradients[k][i] for k in others] for i in range(len(rows[0]))]
        annulling = self._null(columns, len(others))
        if not tangent or not annulling or len(annulling) > 2:
            return None
        forms = [self._restricted(tangent, dict(zip(others, mu, strict=True))) for mu in annulling]
        for form in [*forms, *(self._between(*forms) if len(forms) == 2 else ())]:
            if self._is_definite(form):
                return self.names
        return None

    def _null(self, rows: Rows, size: int) -> Rows:
        """A basis of what the rows annul, wherever ``known`` holds.  Raises Failure where no pivot is certain."""
        return null_space_of_polynomials(self.ring, rows, size, lambda x: self._sign(x) in _NOT_ZERO)

    def _restricted(self, tangent: Rows, multipliers: dict[int, Polynomial]) -> Rows:
        ring, size = self.ring, range(len(tangent[0]))
        total = [
            [ring.reduce(sum((ring.times(mu, self.hessians[k][i][j]) for k, mu in multipliers.items()), ring.zero))
             for j in size]
            for i in size
        ]  # fmt: skip
        images = [[ring.reduce(ring.dot(row, v)) for row in total] for v in tangent]
        return [[ring.reduce(ring.dot(v, image)) for image in images] for v in tangent]

    def _between(self, first: Rows, second: Rows) -> Iterator[Rows]:
        """q (q F_0 + p F_1) with p/q where the minors of order two are greatest."""
        ring = self.ring
        for i, j in combinations(range(len(first)), 2):
            quadratic = ring.times(second[i][i], second[j][j]) - ring.times(second[i][j], second[i][j])
            linear = ring.times(first[i][i], second[j][j]) + ring.times(second[i][i], first[j][j])
            linear = ring.reduce(linear - ring.times(first[i][j], second[i][j]) * 2)
            q, p = ring.reduce(quadratic * 2), -linear
            if q.is_zero() or self._sign(q) not in _NOT_ZERO:
                continue
            yield [
                [ring.reduce(ring.times(q, ring.times(q, x) + ring.times(p, y))) for x, y in zip(*rows, strict=True)]
                for rows in zip(first, second, strict=True)
            ]

    def _is_definite(self, form: Rows) -> bool:
        """Whether a quadratic form is definite, of whichever sign."""
        ring, size = self.ring, len(form)
        if size == 1:
            return self._sign(form[0][0]) in _NOT_ZERO
        if size == 2:
            value = ring.reduce(ring.times(form[0][0], form[1][1]) - ring.times(form[0][1], form[1][0]))
            return self._sign(value) == "positive"
        parts = components(size, lambda i, j: not form[i][j].is_zero())
        blocks = [[[form[i][j] for j in part] for i in part] for part in parts]
        return any(all(self._is_positive(block, sign) for block in blocks) for sign in (1, -1))

    def _is_positive(self, block: Rows, sign: int) -> bool:
        return all(
            self._sign(self.ring.reduce(determinant(self.ring, [row[:s] for row in block[:s]]) * sign**s)) == "positive"
            for s in range(1, len(block) + 1)
        )

    def _sign(self, x: Polynomial) -> str:
        """The sign of a formula; denominators are squared away."""
        top, bottom = self.ring.fraction(x)
        for factor, exponent in bottom:
            if exponent % 2 and self.known.sign(factor) != "positive":
                top = self.ring.times(top, factor)
        return self.known.sign(top) if len(top) <= MOST_TERMS else "unknown"
