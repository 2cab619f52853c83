"""Sums of angles among the generators: which wave has which number, and terms with waves in place of products."""

from __future__ import annotations

from fractions import Fraction
from math import gcd
from typing import TYPE_CHECKING
from weakref import proxy

from mbsym.formulas import angle_sums
from mbsym.formulas.tree import Monomial, Terms, Wave

if TYPE_CHECKING:
    from mbsym.formulas.shape import Presenter

#: Within the place of its first angle a wave is placed by its other angles, up to so many bits.
WITHIN = 240


class Waves:
    """Sines and cosines of sums of angles in the part of generators, numbered from ``first`` on."""

    def __init__(self, presenter: Presenter) -> None:
        ring = presenter.ring
        self.presenter = proxy(presenter)
        self.first = len(ring.generators)
        self.names = [name for name in presenter._declared if name in ring.angles]
        self._numbers = {name: ring.angles[name] for name in self.names}
        self._atoms = [(ring.index("sine", name), ring.index("cosine", name)) for name in self.names]
        self._codes: dict[int, int] = {}  # of a generator: its weight in a packed product
        for angle, (sine, cosine) in enumerate(self._atoms):
            self._codes[sine] = angle_sums.packed([(angle, 1, 0)])
            self._codes[cosine] = angle_sums.packed([(angle, 0, 1)])
        numbers = {name: angle for angle, name in enumerate(self.names)}
        signed = [[(numbers[name], n) for name, n in form if name in numbers] for form in ring.typed]
        #: Of each sum of angles that was typed, the pairs (one with plus, one with minus).
        self._typed = {(k, j) for form in signed for k, n in form for j, m in form if n > 0 > m}
        self._made: list[Wave] = []
        self._indices: dict[Wave, int] = {}
        self._known: dict[angle_sums.Wave, tuple[int, int]] = {}

    def __getitem__(self, index: int) -> Wave:
        return self._made[index - self.first]

    def index(self, wave: Wave) -> int:
        return self._indices[wave]

    def joined(self, terms: Terms, squares: bool) -> tuple[int, Terms] | None:
        """(a whole number, the terms times it) with waves where they are shorter, beside all else; None if nowhere."""
        beside: dict[Monomial, dict[int, int]] = {}
        codes = self._codes
        for monomial, coefficient in terms.items():
            code, rest = 0, []
            for pair in monomial:
                known = codes.get(pair[0])
                if known is None:
                    rest.append(pair)
                elif pair[1] > angle_sums.MOST_POWER:
                    return None
                else:
                    code += known * pair[1]
            beside.setdefault(tuple(rest), {})[code] = coefficient
        if len(beside) == len(terms):
            return None
        groups: list[tuple[Monomial, int, dict[int, int], angle_sums.Joined | None]] = []
        below = 0
        for outside, products in beside.items():
            waves = None
            content = gcd(*products.values())
            if len(products) > 1:
                waves = angle_sums.joined(frozenset([(code, c // content) for code, c in products.items()]), squares)
                if waves is not None:
                    below = max(below, waves.below)
            groups.append((outside, content, products, waves))
        if not below:
            return None
        result: Terms = {}
        for outside, content, products, waves in groups:
            if waves is None:
                parts = [angle_sums.Part(weight * below, (), code) for code, weight in products.items()]
            else:
                factor = content * (below // waves.below)
                parts = [part._replace(weight=part.weight * factor) for part in waves.parts]
            for part in parts:
                monomial, sign = self._monomial(outside, part)
                result[monomial] = result.get(monomial, 0) + sign * part.weight
        return below, result

    def _monomial(self, outside: Monomial, part: angle_sums.Part) -> tuple[Monomial, int]:
        pairs, sign = list(outside), 1
        for wave in part.waves:
            index, turned = self._generator(wave)
            pairs.append((index, wave.power))
            sign *= turned**wave.power
        for angle, sine, cosine in angle_sums.unpacked(part.code):
            pairs += [(self._atoms[angle][0], 1)] * sine
            if cosine:
                pairs.append((self._atoms[angle][1], cosine))
        return tuple(sorted(pairs, key=lambda pair: self.presenter.place(pair[0]))), sign

    def _generator(self, wave: angle_sums.Wave) -> tuple[int, int]:
        """(the number that stands for a wave, sign): a generator's own number for sin and cos of a single angle."""
        if wave not in self._known:
            self._known[wave] = self._new(wave)
        return self._known[wave]

    def _new(self, wave: angle_sums.Wave) -> tuple[int, int]:
        combination = wave.combination
        if len(combination) == 1 and combination[0][1] == 1:
            return self._atoms[combination[0][0]][0 if wave.sine else 1], 1
        # q2 - q1 stays so where the description says it so; else the first angle is positive.
        first, second = combination[0][0], next((k for k, n in combination if n < 0), -1)
        sign = -1 if (second, first) in self._typed and (first, second) not in self._typed else 1
        angle = [(self.names[k], Fraction(sign * n, self._numbers[self.names[k]])) for k, n in combination]
        angle.sort(key=lambda item: item[1] < 0)
        made = Wave("sine" if wave.sine else "cosine", tuple(angle))
        if made not in self._indices:
            index = self._indices[made] = self.first + len(self._made)
            self._made.append(made)
            presenter = self.presenter
            presenter._inverted[index] = None
            presenter._levels[index] = max(presenter.level(self._atoms[k][0]) for k, _ in combination)
            place = 0
            for k, n in combination[:11]:
                place = (place << 20) + (k << 8) + 128 + n
            place <<= 20 * (11 - min(len(combination), 11))
            beside = presenter.place(self._atoms[first][1])
            presenter._places[index] = beside + (1 << WITHIN) + 2 * place + wave.sine
        return self._indices[made], sign if wave.sine else 1
