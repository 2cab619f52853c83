"""Whether the field is defined on  f = 0:  where f divides its denominator there is no motion to speak of.

With  f' = K f / d  a motion that begins on f = 0 stays there if d is not zero all over f = 0: a length r with
r' = r_dot has  r r' = r_dot r,  and r = 0 is no invariant relation.  Looked for is a point with f = 0 and d not zero,
on curves through random points of the relations modulo a prime (the sphere and the circle seen from a pole).  One that
is found may have coordinates in an extension of the prime field; if d vanished all over f = 0, there would be none.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from random import Random
from typing import Any

from flint import nmod_poly

from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.problems.polynomial_integrals.modular import PRIMES

#: Curves that are tried for each variable.
TRIALS = 2


def is_regular_on(field: PolynomialField, f: Any, conditions: Sequence[Any] = ()) -> bool:
    """Whether the field's denominator is not zero at some point with f = 0; it is so at random ones modulo a prime.

    ``conditions``: polynomials in the parameters that vanish; those linear in one of them are put in.
    """
    bottom = field.denominator
    for condition in conditions:
        place = next((k for k in range(len(field.parameters)) if _solvable(condition, k)), None)
        if place is not None:
            slope = condition.derivative(place)
            images = list(field.context.gens())
            images[place] = -(condition - slope * images[place]) / slope.leading_coefficient()
            bottom, f = (p.compose(*images, ctx=field.context) for p in (bottom, f))
    if bottom == 0:
        return False
    if not any(bottom.degrees()[k] for k in field.places):
        return True
    return any(_meets(f, bottom, images, scale) for images, scale in _curves(field))


def _solvable(condition: Any, place: int) -> bool:
    return bool(condition.degrees()[place] == 1 and condition.derivative(place).is_constant())


def _meets(f: Any, bottom: Any, images: Sequence[Any], scale: Any) -> bool:
    """Whether f has a zero on the curve at which the denominator has none."""
    upper, lower = _on(f, images, scale), _on(bottom, images, scale)
    if upper.degree() < 1:
        return False
    return any(divmod(lower, g)[1] != 0 and divmod(scale, g)[1] != 0 for g, _ in upper.factor()[1])


def _on(p: Any, images: Sequence[Any], scale: Any) -> Any:
    """p on the curve, times a power of ``scale``, which divides each image that is not constant."""
    prime = PRIMES[0]
    moving = [k for k, image in enumerate(images) if image.degree() > 0]
    most = max((sum(int(m[k]) for k in moving) for m in p.monoms()), default=0)
    total = nmod_poly([0], prime)
    for m, c in p.to_dict().items():
        term = nmod_poly([int(c.p) * pow(int(c.q), -1, prime) % prime], prime)
        for image, power in zip(images, m, strict=True):
            if power:
                term *= image ** int(power)
        total += term * scale ** (most - sum(int(m[k]) for k in moving))
    return total


def _curves(field: PolynomialField) -> Iterator[tuple[list[Any], Any]]:
    """Curves with a parameter s on the relations: images of the generators, the moving ones times ``scale``."""
    prime, random = PRIMES[0], Random("regular")
    count = len(field.context.names())
    groups = [_group(relation) for relation in field.relations]
    if any(not one for one in groups):
        return  # of other relations no points are known
    alone = [(k,) for k in field.places if not any(k in one for one in groups)]
    for moving in [*alone, *groups] * TRIALS:
        images = [nmod_poly([random.randrange(1, prime)], prime) for _ in range(count)]
        scale = nmod_poly([1], prime)
        if len(moving) == 1:
            images[moving[0]] = nmod_poly([0, 1], prime)
        for group in groups:
            places = random.sample(group, len(group))
            others = [nmod_poly([random.randrange(1, prime)], prime) for _ in places[1:]]
            if group == moving:
                others[0] = nmod_poly([0, 1], prime)
            total = sum((one * one for one in others), nmod_poly([1], prime))
            values = [*(2 * one for one in others), total - 2]
            if group == moving:
                scale = total
            else:
                inverse = pow(int(total[0]), -1, prime)
                values = [one * inverse for one in values]
            for place, value in zip(places, values, strict=True):
                images[place] = value
        yield images, scale


def _group(relation: Any) -> tuple[int, ...]:
    """The generators of which a relation says that their squares have the sum 1; () where it says something else."""
    terms = dict(relation.to_dict())
    constant = terms.pop((0,) * len(relation.context().names()), 0)
    if len(terms) < 2 or any(sorted(m)[-2:] != [0, 2] or c != -constant for m, c in terms.items()):
        return ()
    return tuple(next(k for k, power in enumerate(m) if power) for m in terms)
