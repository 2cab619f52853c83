"""What formulas in LaTeX and in MathML share: names of which no two look alike, and how a product is laid out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, MutableMapping
from typing import Any, ClassVar, Generic, Self, TypeVar
from weakref import WeakKeyDictionary

from mbsym.algebra.ring import ParameterRing, Ring
from mbsym.formulas.letters import LetterRing
from mbsym.formulas.names import NameParts, parts
from mbsym.formulas.tree import Factor, Product, Sum, Wave

S = TypeVar("S")


def split(name: str) -> NameParts:
    """The parts of a name as formulas have them, where Jx is J with index x."""
    whole = parts(name)
    match = re.fullmatch(r"([A-Z])([a-z]{1,2}|[A-Z])|([a-z])([a-z])", whole.stem)
    if whole.greek or match is None:
        return whole
    stem, first = (match[1], match[2]) if match[1] else (match[3], match[4])
    return NameParts(stem, "", (first, *whole.indices))


class Names(Generic[S]):
    """One renaming for a system: no two names look alike; one that would is written out as it was declared.

    Symbols that are ``given`` are nobody else's.
    """

    _of_rings: ClassVar[MutableMapping[Ring, Any]]

    def __init_subclass__(cls) -> None:
        cls._of_rings = WeakKeyDictionary()

    def __init__(self, names: Iterable[str], given: Mapping[str, S] | None = None) -> None:
        self._given = given or {}
        self._symbols: dict[str, S] = {}
        taken: set[str] = set()
        for name in dict.fromkeys([*self._given, *names]):
            symbol = self._given[name] if name in self._given else self.symbol(name)
            self._symbols[name] = self.verbatim(name) if str(symbol) in taken else symbol
            taken.add(str(symbol))

    @staticmethod
    def symbol(name: str) -> S:
        """What a name would like to look like."""
        raise NotImplementedError

    @staticmethod
    def verbatim(name: str) -> S:
        """A name as it was declared."""
        raise NotImplementedError

    def __getitem__(self, name: str) -> S:
        known = self._symbols.get(name)
        return self.symbol(name) if known is None else known

    def beside(self, more: Iterable[str]) -> Self:
        """These names and others, which do not look like them."""
        return type(self)([*self._symbols, *more], self._given)

    @classmethod
    def of(cls, ring: Ring) -> Self:
        """The ring's renaming, made once; a part of a ring has the names of the whole."""
        ring = ring.whole if isinstance(ring, ParameterRing) else ring
        if ring not in cls._of_rings:
            if isinstance(ring, LetterRing):
                cls._of_rings[ring] = cls.of(ring.whole).beside(ring.letters)
            else:
                cls._of_rings[ring] = cls(_declared(ring))
        known: Self = cls._of_rings[ring]
        return known

    @classmethod
    def write_as(cls, ring: Ring, given: Mapping[str, S]) -> None:
        """From now on names of the ring have these symbols, in every formula."""
        cls._of_rings[ring] = cls(_declared(ring), given)


def _declared(ring: Ring) -> list[str]:
    return ["t", *(g.name for g in ring.generators if g.kind in ("coordinate", "prescribed", "parameter"))]


class Layout:
    """What stands where in products of the ring, and how deeply brackets are nested."""

    def __init__(self, ring: Ring) -> None:
        self.ring = ring
        self._heights: dict[Sum, int] = {}

    def inside_and_behind(self, product: Product) -> tuple[list[Factor], list[Factor]]:
        """The factors above the line of a fraction, where there is a denominator, and those behind it."""
        over = self.readable(product.over)
        if not product.under:
            return [], over
        inside = [f for f in over if isinstance(f.base, int) and self.is_parameter(f.base)]
        if len(over) == 1 and not inside and isinstance(over[0].base, int):
            inside = over
        return inside, [f for f in over if f not in inside]

    def readable(self, factors: Iterable[Factor]) -> list[Factor]:
        """Sines and cosines last: after ``cos x`` a factor s or (a + b) would read as a part of the argument."""
        return sorted(factors, key=self.is_sine)

    def is_sine(self, factor: Factor) -> bool:
        if isinstance(factor.base, Wave):
            return True
        return isinstance(factor.base, int) and self.ring.generators[factor.base].kind in ("sine", "cosine")

    def is_parameter(self, index: int) -> bool:
        return self.ring.generators[index].kind == "parameter"

    def is_coefficient(self, shape: Sum) -> bool:
        """Whether it is made of parameters only."""
        bases = (f.base for term in shape.terms for f in (*term.over, *term.under))
        return all(
            self.is_coefficient(x) if isinstance(x, Sum) else isinstance(x, int) and self.is_parameter(x) for x in bases
        )

    def height(self, shape: Sum) -> int:
        """How deeply brackets are nested, this one included."""
        if shape not in self._heights:
            inner = (f.base for term in shape.terms for f in term.over)
            self._heights[shape] = 1 + max(map(self.height_of_base, inner), default=0)
        return self._heights[shape]

    def height_of_base(self, base: int | Wave | Sum) -> int:
        return self.height(base) if isinstance(base, Sum) else 0
