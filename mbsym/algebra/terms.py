"""Polynomials of the number library by their terms: taken apart, with quotients put in, in any other algebra."""

from __future__ import annotations

import operator
from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from typing import Any, TypeVar

from flint import fmpq, fmpq_poly

Polynomial = Any  # of flint: python-flint carries no types
Key = TypeVar("Key", bound=Hashable)


def grouped(p: Polynomial, key: Callable[[Sequence[int]], Key], without: Collection[int] = ()) -> dict[Key, Polynomial]:
    """The sums of those terms that have the same key(exponents), ``without`` the generators of these places."""
    groups: dict[Key, dict[tuple[int, ...], Any]] = {}
    for monomial, c in p.terms():
        rest = list(monomial)
        for place in without:
            rest[place] = 0
        groups.setdefault(key(monomial), {})[tuple(rest)] = c
    return {name: p.context().from_dict(terms) for name, terms in groups.items()}


def apart(p: Polynomial, places: Collection[int]) -> dict[tuple[int, ...], Polynomial]:
    """{e: p_e} with p = sum_e x^e p_e, x the generators of these places, of which p_e is free; in the order of p."""
    return grouped(p, lambda monomial: tuple([int(monomial[place]) for place in places]), places)


def coefficients_in(p: Polynomial, place: int) -> list[Polynomial]:
    """[c_0, ..., c_n] with p = sum_k c_k x^k in one generator x, of which c_k is free; [0] of 0."""
    parts, zero = apart(p, (place,)), p.context().constant(0)
    return [parts.get((k,), zero) for k in range(max((k for (k,) in parts), default=0) + 1)]


def univariate(p: Polynomial, place: int = 0) -> fmpq_poly:
    """p in one generator, with 1 in place of all others."""
    total = fmpq_poly([0])
    for monomial, c in p.terms():
        total[int(monomial[place])] += fmpq(c)
    return total


def with_quotient(
    p: Polynomial, place: int, top: Polynomial, bottom: Polynomial, power: int | None = None
) -> Polynomial:
    """bottom^power p with top/bottom in place of a generator; the power is the degree unless it is given."""
    parts = coefficients_in(p, place)
    most = len(parts) - 1 if power is None else power
    products = (c * top**k * bottom ** (most - k) for k, c in enumerate(parts) if c != 0)
    return sum(products, p.context().constant(0))


def with_quotients(
    p: Polynomial, images: Mapping[int, tuple[Polynomial, Polynomial]], context: Any
) -> tuple[Polynomial, Polynomial]:
    """(P, Q) with p = P/Q where each generator k that p holds is top/bottom = images[k]: Q = prod bottom^degree."""
    degrees = {k: int(degree) for k, degree in enumerate(p.degrees()) if degree > 0}
    total, below = context.constant(0), context.constant(1)
    for k, degree in degrees.items():
        below *= images[k][1] ** degree
    for monomial, c in p.terms():
        term = context.constant(c)
        for k, degree in degrees.items():
            top, bottom = images[k]
            term *= top ** int(monomial[k]) * bottom ** (degree - int(monomial[k]))
        total += term
    return total, below


def evaluated(
    p: Polynomial,
    power: Callable[[int, int], Any],
    number: Callable[[Any], Any],
    times: Callable[[Any, Any], Any] = operator.mul,
) -> Any:
    """The sum of number(c) prod_k power(k, e_k) over the terms c x^e, by ``times`` and the scalars' own sum."""
    total = number(fmpq(0))
    for monomial, c in p.terms():
        term = number(c)
        for k, exponent in enumerate(monomial):
            if exponent:
                term = times(term, power(k, int(exponent)))
        total = total + term
    return total


def modulo(p: Polynomial, values: Sequence[int] | Mapping[int, int], prime: int) -> int:
    """The value at integers, modulo a prime that divides no denominator."""

    def number(c: fmpq) -> int:
        return int(c.p) * pow(int(c.q), -1, prime) % prime

    return int(evaluated(p, lambda k, e: pow(values[k], e, prime), number, lambda a, b: a * b % prime)) % prime


def residue(x: Polynomial, values: Sequence[fmpq_poly] | Mapping[int, fmpq_poly], modulus: fmpq_poly) -> fmpq_poly:
    """x at the values, modulo ``modulus``."""
    powers: dict[tuple[int, int], fmpq_poly] = {}

    def power(index: int, exponent: int) -> fmpq_poly:
        if exponent == 1:
            return values[index]
        key = (index, exponent)
        if key not in powers:
            powers[key] = power(index, exponent - 1) * values[index] % modulus
        return powers[key]

    return evaluated(x, power, lambda c: fmpq_poly([fmpq(c)]), lambda a, b: a * b % modulus) % modulus


def convolved(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    """The coefficients of the product of two polynomials, the lowest first; none where one of them has none."""
    if not a or not b:
        return []
    product = [a[0] * 0] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            product[i + j] = product[i + j] + x * y
    return product


def fraction_modulo(value: int, prime: int, most: int) -> tuple[int, int] | None:
    """(n, d) with n = d value modulo the prime, |n| <= most, 0 < d <= most; None where there are none."""
    if value <= most:
        return value, 1
    if prime - value <= most:
        return value - prime, 1
    r0, r1, s0, s1 = prime, value, 0, 1
    while r1 > most:
        quotient = r0 // r1
        r0, r1, s0, s1 = r1, r0 - quotient * r1, s1, s0 - quotient * s1
    if not 0 < abs(s1) <= most:
        return None
    return (r1, s1) if s1 > 0 else (-r1, -s1)
