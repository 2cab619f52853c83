"""Whether a formula of another form may be the same periodic solution with its symbols chosen otherwise.

One solution x = sum eps^n x_n(T; a) is written with many amplitudes, constants a and phases T.  With

    a -> a + eps a_1 + eps^2 a_2 + ...,      T -> T + eps T_1 + ...

the coefficient x_n changes by sums of derivatives  d^m x_j / da^m  with j + |m| <= n, 0 < |m|, times factors that are
free of the phase; T may be counted from another quarter, or backwards, besides.  A difference outside of the space
that these derivatives span is no matter of symbols.  Ranks are found modulo a prime at random points.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations_with_replacement
from random import Random
from typing import Any

from flint import nmod_mat

from mbsym.algebra.failures import Failure
from mbsym.algebra.tower import MOST_ROOTS, Element, Tower
from mbsym.problems.small_parameter.oscillation_result import Amplitude, Harmonics, Oscillation
from mbsym.problems.small_parameter.oscillations import AMPLITUDE

PRIME = (1 << 61) - 1
_POINTS, _TRIALS = 2, 400


def explained(found: Oscillation, series: Sequence[Harmonics], order: int, claimed: Harmonics) -> bool:
    """Whether other symbols may make ``claimed`` of series[order]; true where that cannot be excluded."""
    if same_size(series[order], claimed) and any(claimed.waves):
        return True
    try:
        shifts = list(_shifts(found, series, order))
    except Failure:
        return True
    variants = _VARIANTS if any(any(one.waves) for one in series[: order + 1]) else _VARIANTS[:1]
    for variant in variants:
        difference = claimed - _varied(series[order], *variant)
        if difference.is_zero or _in_span(found.tower, [_varied(one, *variant) for one in shifts], difference):
            return True
    return False


def same_size(one: Harmonics, other: Harmonics) -> bool:
    """Whether all harmonics have the same squares of amplitudes: T may begin anywhere."""
    if one.waves.keys() != other.waves.keys():
        return False
    for k, (c, s) in one.waves.items():
        d, t = other.waves[k]
        if not (c - d if k == 0 else c * c + s * s - d * d - t * t).is_zero():
            return False
    return True


#: Quarters of a turn, and the direction, of T.
_VARIANTS = tuple((quarter, sense) for sense in (1, -1) for quarter in range(4))


def _varied(x: Harmonics, quarter: int, sense: int) -> Harmonics:
    """x(sense T + quarter pi/2)."""
    waves = {}
    for k, (c, s) in x.waves.items():
        turn = k * quarter % 4
        # c cos(y + turn pi/2) + s sin(y + turn pi/2)
        c, s = ((c, s), (s, -c), (-c, -s), (-s, c))[turn]
        waves[k] = (c, s if sense > 0 else -s)
    return Harmonics(x.tower, waves)


def _shifts(found: Oscillation, series: Sequence[Harmonics], order: int) -> Iterator[Harmonics]:
    """d^m x_j / da^m with j + |m| <= order."""
    symbols: list[str | None] = [AMPLITUDE] if found.kind is Amplitude.FREE else []
    symbols += [f"#{name}" for name, _ in found.constants]
    symbols.append(None)  # the phase
    for j in range(order):
        for size in range(1, order - j + 1):
            for chosen in combinations_with_replacement(symbols, size):
                one = series[j]
                for symbol in chosen:
                    one = one.slope() if symbol is None else one.mapped(lambda x, by=symbol: _derivative(x, by))
                if not one.is_zero:
                    yield one


def _derivative(x: Element, name: str) -> Element:
    tower = x.tower
    if x.is_zero():
        return x
    place = MOST_ROOTS + tower.parameters.index(name)
    top, bottom, unit = x.top, x.bottom, tower.context.constant(1)
    below = tower.made(bottom.derivative(place), unit)
    slope = tower.made(top.derivative(place), unit)
    for k, square in enumerate(tower.squares):
        held = top.derivative(MOST_ROOTS - 1 - k)
        if held != 0:
            root = tower.made(tower.context.gens()[MOST_ROOTS - 1 - k], unit)
            inner = _derivative(tower.made(square, unit), name)
            slope = slope + tower.made(held, unit) * inner / (root * tower.number(2))
    return (slope - x * below) / tower.made(bottom, unit)


def _in_span(tower: Tower, span: Sequence[Harmonics], x: Harmonics) -> bool:
    """Whether x = sum c_i span_i with c_i free of the phase; true where no point shows the contrary."""
    places = sorted({(k, side) for one in (*span, x) for k in one.waves for side in (0, 1)})
    if not span:
        return x.is_zero
    for values in _points(tower):
        rows = []
        try:
            for one in (*span, x):
                rows.append([_at(one.wave(k)[side], values) for k, side in places])
        except ZeroDivisionError:
            continue
        if _rank(rows) > _rank(rows[:-1]):
            return False
    return True


def _rank(rows: Sequence[Sequence[int]]) -> int:
    return int(nmod_mat(len(rows), len(rows[0]), [x for row in rows for x in row], PRIME).rank())


def _points(tower: Tower) -> Iterator[list[int]]:
    """Random values of all generators modulo the prime, roots with their squares."""
    random, there = Random(20240229), 0
    for _ in range(_TRIALS):
        values = [0] * MOST_ROOTS + [random.randrange(1, PRIME) for _ in tower.parameters]
        for k, square in enumerate(tower.squares):
            root = _root(_polynomial_at(square, values))
            if root is None:
                break
            values[MOST_ROOTS - 1 - k] = root
        else:
            there += 1
            yield values
        if there == _POINTS:
            return


def _root(square: int) -> int | None:
    """Modulo the prime, which is 3 modulo 4."""
    root = pow(square, (PRIME + 1) // 4, PRIME)
    return root if root * root % PRIME == square else None


def _at(x: Element, values: Sequence[int]) -> int:
    below = _polynomial_at(x.bottom, values)
    if below == 0:
        raise ZeroDivisionError
    return _polynomial_at(x.top, values) * pow(below, -1, PRIME) % PRIME


def _polynomial_at(p: Any, values: Sequence[int]) -> int:
    total = 0
    for monomial, c in p.to_dict().items():
        term = int(c.p) % PRIME * pow(int(c.q), -1, PRIME)
        for value, exponent in zip(values, monomial, strict=True):
            if exponent:
                term = term * pow(value, int(exponent), PRIME) % PRIME
        total += term
    return total % PRIME
