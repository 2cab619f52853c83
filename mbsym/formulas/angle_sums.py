"""Polynomials in sines and cosines of several angles as sums of waves, where that is shorter to read.

``sin q1 cos q2 + cos q1 sin q2`` is ``sin(q1 + q2)``.  The ring keeps products of sines and cosines of single angles.
A polynomial in these is, exactly, a Fourier polynomial: each term an amplitude times cos or sin of n1 q1 + n2 q2 + ...
The angles that are joined are chosen by the length of what is read: all of a linked set, some of them, or none; what
is joined in one part may stand as products in another.  1 and cos(2 u) of equal weight are a square of cos u or sin u.

Monomials are packed: angle k has the byte 2*(power of its cosine) + (power of its sine, 0 or 1), as normal forms have.
Waves are packed too: the sum of n_k * 256**k, and whether it is a sine.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import lru_cache
from itertools import combinations
from math import comb, gcd
from typing import NamedTuple

from mbsym.algebra.matrices import united

#: A packed product of sines and cosines.
Code = int
#: Multiples of the angles; the first that is not zero is positive.
Combination = tuple[tuple[int, int], ...]

#: More angles than this, or products than this, are not joined at once: 2**angles waves may come of each.
MOST_ANGLES, MOST_PRODUCTS = 6, 64
#: Higher powers of one cosine are left alone.
MOST_POWER = 8
#: Sets of linked angles with more members are tried whole and in pairs only.
_ALL_SUBSETS = 4

_BITS = 8
_BYTE = (1 << _BITS) - 1


class Wave(NamedTuple):
    """cos or sin of a combination of angles, to a power (2 at most)."""

    sine: bool
    combination: Combination
    power: int = 1


class Part(NamedTuple):
    """weight * waves * (what stays a product of sines and cosines)."""

    weight: int
    waves: tuple[Wave, ...]
    code: Code


class Joined(NamedTuple):
    """The sum of the parts, divided by ``below``, a power of two."""

    parts: tuple[Part, ...]
    below: int = 1


def packed(exponents: Iterable[tuple[int, int, int]]) -> Code:
    """From (angle, power of its sine, power of its cosine)."""
    return sum((2 * cosine + sine) << (_BITS * angle) for angle, sine, cosine in exponents)


def unpacked(code: Code) -> Iterator[tuple[int, int, int]]:
    """(angle, power of its sine, power of its cosine)."""
    angle = 0
    while code:
        byte = code & _BYTE
        if byte:
            yield angle, byte & 1, byte >> 1
        code >>= _BITS
        angle += 1


@lru_cache(maxsize=1 << 14)
def joined(products: frozenset[tuple[Code, int]], squares: bool = True) -> Joined | None:
    """The shortest presentation found of the sum of weight * product; None where nothing is shorter than products.

    The same value, exactly.  Depends on the products only, and not on their order.  ``squares``: single angles, too,
    have their sin^2 and their double angle.
    """
    if len(products) < 2 or len(products) > MOST_PRODUCTS:
        return None
    return _shortest(dict(sorted(products)), squares)


def _shortest(products: Mapping[Code, int], squares: bool) -> Joined | None:
    pieces = [Part(weight, (), code) for code, weight in products.items()]
    best, least = None, _length(pieces, 1)
    for block in _candidates(products, squares):
        candidate = _over(products, block)
        length = _length(*candidate)
        if length < least:
            best, least = candidate, length
            if 2 * len(candidate[0]) <= len(products) and len(block) > 1:
                break
    if best is None:
        return None
    # What stands beside each wave is a polynomial in the angles that are left.
    parts, below = best
    beside: dict[tuple[Wave, ...], dict[Code, int]] = {}
    for part in parts:
        beside.setdefault(part.waves, {})[part.code] = part.weight
    further = [(waves, rest, _shortest(rest, squares) if len(rest) > 1 else None) for waves, rest in beside.items()]
    common = max([1, *(again.below for _, _, again in further if again is not None)])
    result: list[Part] = []
    for waves, rest, again in further:
        if again is None:
            result += [Part(weight * common, waves, code) for code, weight in rest.items()]
        else:
            factor = common // again.below
            result += [
                Part(part.weight * factor, tuple(sorted((*waves, *part.waves))), part.code) for part in again.parts
            ]
    return _lowest(result, below * common)


def _lowest(parts: Iterable[Part], below: int) -> Joined:
    parts = list(parts)
    common = gcd(below, *(part.weight for part in parts))
    lowest = [part._replace(weight=part.weight // common) for part in parts]
    return Joined(tuple(sorted(lowest, key=lambda part: (part.waves, part.code))), below // common)


# --- which angles to join ---------------------------------------------------------------------------------------------


def _candidates(products: Mapping[Code, int], squares: bool) -> Iterator[tuple[int, ...]]:
    """Sets of angles to join, the largest first."""
    links = _linked(products)
    for whole in sorted(tuple(sorted(angles)) for angles in united(links)):
        if len(whole) > MOST_ANGLES:
            yield from (pair for pair in links if set(pair) <= set(whole))
            continue
        yield whole
        sizes = range(len(whole) - 1, 1, -1) if len(whole) <= _ALL_SUBSETS else (2,) if len(whole) > 2 else ()
        for size in sizes:
            yield from combinations(whole, size)
    if squares:
        for angle in _squared(products):
            yield (angle,)


def _linked(products: Mapping[Code, int]) -> list[tuple[int, int]]:
    """Pairs of angles with ``X sin a sin b`` and ``X cos a cos b``, or ``X sin a cos b`` and ``X cos a sin b``.

    Their weights are equal up to sign: only then does a sum of angles replace two products by one wave.
    """
    pairs: set[tuple[int, int]] = set()
    for code, weight in products.items():
        sines, cosines, rest, angle = [], [], code, 0
        while rest:
            byte = rest & _BYTE
            if byte & 1:
                sines.append(angle)
            if byte > 1:
                cosines.append(angle)
            rest >>= _BITS
            angle += 1
        for place, a in enumerate(sines):
            unit = 1 << (_BITS * a)
            for b in sines[place + 1 :]:
                if abs(products.get(code + unit + (1 << (_BITS * b)), 0)) == abs(weight):
                    pairs.add((a, b))
            for b in cosines:
                if b != a and abs(products.get(code + unit - (1 << (_BITS * b)), 0)) == abs(weight):
                    pairs.add((a, b) if a < b else (b, a))
    return sorted(pairs)


def _squared(products: Mapping[Code, int]) -> list[int]:
    """Angles with ``X cos^2`` beside X, of weights that leave one of 1, sin^2, cos(2 a)."""
    angles: set[int] = set()
    for code, weight in products.items():
        rest, angle = code, 0
        while rest:
            if rest & _BYTE >= 4:
                below = products.get(code - (4 << (_BITS * angle)), 0)
                if below and (weight == -below or weight == -2 * below):
                    angles.add(angle)
            rest >>= _BITS
            angle += 1
    return sorted(angles)


# --- Fourier ----------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1 << 10)
def _single(byte: int) -> tuple[tuple[int, int], ...]:
    """2**(i + j) * s**i * c**j, but for a factor (-i)**i, as (multiple, weight) over exp(i n x)."""
    j = byte >> 1
    spectrum = {j - 2 * k: comb(j, k) for k in range(j + 1)}
    if byte & 1:
        spectrum = {n: spectrum.get(n - 1, 0) - spectrum.get(n + 1, 0) for n in range(-j - 1, j + 2) if (n - j) % 2}
    return tuple((n, weight) for n, weight in spectrum.items() if weight)


def _over(products: Mapping[Code, int], block: tuple[int, ...]) -> tuple[list[Part], int]:
    """Waves in the angles of the block, where they are shorter, beside what the others leave; and their divisor."""
    mask = sum(_BYTE << (_BITS * angle) for angle in block)
    beside: dict[Code, dict[Code, int]] = {}
    for code, weight in products.items():
        beside.setdefault(code & ~mask, {})[code & mask] = weight
    scale = 1 << max(_degree(code & mask) for code in products)
    parts: list[Part] = []
    for outside, inner in beside.items():
        as_products = [Part(weight * scale, (), code) for code, weight in inner.items()]
        waves = _waves(inner, block, scale)
        if waves is None or _length(waves, scale) >= _length(as_products, scale):
            waves = as_products
        parts += [Part(weight, wave, code | outside) for weight, wave, code in waves] if outside else waves
    return parts, scale


@lru_cache(maxsize=1 << 12)
def _degree(code: Code) -> int:
    return sum(sine + cosine for _, sine, cosine in unpacked(code))


def _waves(inner: Mapping[Code, int], block: tuple[int, ...], scale: int) -> list[Part] | None:
    """``scale`` times the Fourier polynomial; None where a power is too high."""
    cosines: dict[int, int] = {}
    sines: dict[int, int] = {}
    for code, weight in inner.items():
        spectrum, odd, degree = {0: weight}, 0, 0
        for angle in block:
            byte = (code >> (_BITS * angle)) & _BYTE
            if not byte:
                continue
            if byte >> 1 > MOST_POWER:
                return None
            odd, degree = odd + (byte & 1), degree + (byte & 1) + (byte >> 1)
            shift = 1 << (_BITS * angle)
            product: dict[int, int] = {}
            for place, value in spectrum.items():
                for n, factor in _single(byte):
                    key = place + n * shift
                    product[key] = product.get(key, 0) + value * factor
            spectrum = product
        factor = -scale >> degree if odd & 2 else scale >> degree  # (-i)**odd, but for -i itself
        target = sines if odd & 1 else cosines
        for key, value in spectrum.items():
            if key > 0:  # the other half is its mirror image
                target[key] = target.get(key, 0) + 2 * factor * value
            elif not key and not odd & 1:
                target[0] = target.get(0, 0) + factor * value
    waves = _folded(cosines)
    waves += [_wave(True, key, weight) for key, weight in sines.items() if weight]
    return waves


def _folded(cosines: dict[int, int]) -> list[Part]:
    """1 + cos(2 u) is 2 cos(u)**2, 1 - cos(2 u) is 2 sin(u)**2."""
    constant = cosines.pop(0, 0)
    parts: list[Part] = []
    for key in sorted(cosines):
        weight = cosines[key]
        if constant and abs(weight) == abs(constant):
            double = _multiples(key)
            if all(n % 2 == 0 for _, n in double):
                wave, _ = _oriented(weight != constant, tuple([(angle, n // 2) for angle, n in double]))
                parts.append(Part(2 * constant, (wave._replace(power=2),), 0))
                constant = 0
                continue
        if weight:
            parts.append(_wave(False, key, weight))
    if constant:
        parts.append(Part(constant, (), 0))
    return parts


def _wave(sine: bool, key: int, weight: int) -> Part:
    wave, sign = _oriented(sine, _multiples(key))
    return Part(weight * sign, (wave,), 0)


@lru_cache(maxsize=1 << 12)
def _multiples(key: int) -> Combination:
    """(angle, multiple) from the sum of multiple * 256**angle."""
    multiples, angle = [], 0
    while key:
        n = ((key + 128) & _BYTE) - 128
        if n:
            multiples.append((angle, n))
        key = (key - n) >> _BITS
        angle += 1
    return tuple(multiples)


def _oriented(sine: bool, combination: Combination) -> tuple[Wave, int]:
    """The wave with its first angle positive, and the sign that this costs."""
    if combination[0][1] > 0:
        return Wave(sine, combination), 1
    return Wave(sine, tuple((angle, -n) for angle, n in combination)), -1 if sine else 1


# --- lengths ----------------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1 << 12)
def _length_of_code(code: Code) -> int:
    """What is read of a product of sines and cosines: functions, names, powers."""
    return sum(2 * sine + (0 if not cosine else 2 if cosine == 1 else 3) for _, sine, cosine in unpacked(code))


@lru_cache(maxsize=1 << 12)
def _length_of_wave(wave: Wave) -> int:
    """``cos``, and of each angle its name, its sign and its multiple."""
    inside = sum(1 if abs(n) == 1 else 2 for _, n in wave.combination) + len(wave.combination) - 1
    return 1 + inside + (wave.power != 1)


def _length(parts: Sequence[Part], below: int) -> int:
    """The parts as a sum, their common number in front; all are divided by ``below``."""
    common = gcd(*[part.weight for part in parts])
    written = 0 if common % below == 0 else 1
    for weight, waves, code in parts:
        written += 1 + (abs(weight) != common) + _length_of_code(code)
        for wave in waves:
            written += _length_of_wave(wave)
    return written
