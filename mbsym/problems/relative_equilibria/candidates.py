"""Places that may be equilibria without being isolated roots: zero, and where the springs in coordinates are at rest.

A root at which the Jacobian is singular has no box that proves it.  There the coordinates are known exactly, rational
numbers and rational multiples of pi, so the equations can be put to the test in the ring.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import arb, ctx, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.mechanics.rest import Rest
from mbsym.problems.relative_equilibria.place import PRECISION, Place

#: A root of higher multiplicity is not told apart from others.
MOST_MULTIPLE = 8


@dataclass(frozen=True)
class Candidate:
    """``forms``: coordinates as rational numbers plus multiples of pi; ``images``: their generators as constants."""

    ring: Ring
    forms: Mapping[str, LinearForm]
    images: Mapping[int, Polynomial]

    def vanishes(self, x: Polynomial) -> bool:
        """Whether x is proved to be zero there."""
        try:
            return bool(self.ring.substitute(x, dict(self.images)).is_zero())
        except NOT_THERE:
            return False

    def place(self, found: Rest, rates: Mapping[int, Any]) -> Place:
        """With all other coordinates at 0."""
        ring, balls = self.ring, {}
        exact: dict[int, Any] = {}
        for name in found.constant:
            if name in self.forms:
                continue
            exact[ring.index("coordinate", name)] = fmpq_poly([0])
            if name in ring.angles:
                exact |= {ring.index("sine", name): fmpq_poly([0]), ring.index("cosine", name): fmpq_poly([1])}
        for k, value in self.images.items():
            if value.is_constant():
                exact[k] = fmpq_poly([value.leading_coefficient() if value else 0])
        with ctx.workprec(PRECISION):
            for name, form in self.forms.items():
                turns, rest = (rationals.exact(x) for x in (form.turns, form.constant))
                balls[name] = arb(rest) + arb.pi() * turns
        return Place(found, balls, exact | dict(rates), fmpq_poly([0, 1]))


def candidates(found: Rest, names: Sequence[str], equations: Sequence[Polynomial]) -> Iterator[Candidate]:
    """Those at which all equations vanish: ``names`` at zero, and at the rests of their springs."""
    rests: dict[str, list[LinearForm]] = {name: [LinearForm()] for name in names}
    for load in found.system.loads:
        name, value = load.rest_position or ("", None)
        form = None if value is None else linear_form(value)
        if form is not None and not form.coefficients:
            rests.get(name, []).append(form)
    longest = max(map(len, rests.values()), default=0)
    tried = []
    for k in range(longest):
        forms = {name: each[min(k, len(each) - 1)] for name, each in rests.items()}
        if forms in tried:
            continue
        tried.append(forms)
        candidate = candidate_at(found, forms)
        if all(candidate.vanishes(x) for x in equations):
            yield candidate


def candidate_at(found: Rest, forms: Mapping[str, LinearForm]) -> Candidate:
    """The place with these coordinates."""
    return Candidate(found.ring, forms, _images(found.ring, forms))


def _images(ring: Ring, forms: Mapping[str, LinearForm]) -> dict[int, Polynomial]:
    """Generators as constants; sines and cosines that are not made of square roots are left as they are."""
    images: dict[int, Polynomial] = {}
    for name, form in forms.items():
        value = ring.number(form.constant)
        if form.turns:
            value = value + ring.times(ring.number(form.turns), ring.generator("parameter", "pi"))
        images[ring.index("coordinate", name)] = value
        if name in ring.angles and not form.constant:
            try:
                sine, cosine = ring.sin_cos(LinearForm(turns=form.turns / ring.angles[name]))
            except Failure:
                continue
            images |= {ring.index("sine", name): sine, ring.index("cosine", name): cosine}
    return images


def only_root(ring: Ring, equation: Polynomial, name: str, candidate: Candidate, interval: Any) -> bool:
    """Whether ``candidate`` is proved to be the only root of one equation f(x) = 0 in an interval around it.

    With f = f' = ... = 0 up to the order m - 1 there,  f(x) = f^(m)(y) (x - a)^m / m!  for some y between x and a.
    """
    slope = equation
    for _ in range(MOST_MULTIPLE):
        if not candidate.vanishes(slope):
            break
        slope = ring.derivative(slope, name)
    else:
        return False
    at = dict.fromkeys(ring.names(), arb(0)) | {name: interval}
    with ctx.workprec(PRECISION):
        return not bool(ring.evaluate(slope, at).contains(0))
