"""Formulas in parameters as fractions of polynomials in the axes of a map, everything else put in as rational numbers.

An image of p in QQ[parameters] is a pair (n, d) of polynomials in the axes with p = n/d, d != 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure, NoValue, SingularPoint
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import with_quotients
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.problems.stability.constant import Constant

#: n/d, both polynomials in the axes.
Image = tuple[Polynomial, Polynomial]


class Irrational(Failure):
    """A number, or a function of the axes, that is no fraction of polynomials with rational coefficients."""

    code = "irrational"


class Images:
    """Carries polynomials of a scene's ring to fractions in the axes.

    ``given``: rational numbers of parameters and symbols of the notation.  What has none is looked up: a relation, what
    the motion ``solved``, the definition of a symbol.  Raises NoValue (with the name as its message) where nothing is
    found, Irrational for roots and angles that are no rational numbers, SingularPoint for 1/0.
    """

    def __init__(
        self,
        scene: Scene,
        axes: Sequence[str],
        context: Any,
        given: Mapping[str, Fraction],
        solved: Mapping[str, Polynomial],
        constant: Constant | None = None,
    ) -> None:
        self.scene, self.ring, self.context = scene, scene.ring, context
        self._one = context.constant(1)
        self._found: dict[int, Image] = {}
        self._pending: set[int] = set()
        for k, name in enumerate(axes):
            self._found[self.ring.index("parameter", name)] = (context.gen(k), self._one)
        self._given = {self.ring.index("parameter", name): name for name in given}
        #: The names of ``given`` numbers that were put in somewhere.
        self.used: set[str] = set()
        for name, value in given.items():
            number = context.constant(rationals.exact(value))
            self._found.setdefault(self.ring.index("parameter", name), (number, self._one))
        self.constant = constant
        #: Generators that stand for irrational numbers.
        self.irrational: list[int] = []
        self._solved = {self.ring.index("parameter", name): value for name, value in solved.items()}
        self._related = relations(scene)
        self._symbols = {item.name: item.value for item in scene.system.notation}

    def __call__(self, p: Polynomial, ring: Any = None) -> Image:
        """The image of a polynomial of the scene's ring, or of a smaller ring of its parameters."""
        indices = None if ring is None or ring is self.ring else ring.indices
        used = occurring([p])
        images = {k: self._generator(k if indices is None else indices[k]) for k in used}
        if all(bottom == 1 for _, bottom in images.values()):
            places = [images[k][0] if k in images else self.context.constant(0) for k in range(p.context().nvars())]
            return (p.compose(*places, ctx=self.context) if p else self.context.constant(0)), self._one
        return _lowest(*with_quotients(p, images, self.context))

    def _generator(self, k: int) -> Image:
        if k in self._given:
            self.used.add(self._given[k])
        if k not in self._found:
            if k in self._pending:
                raise NoValue(self.ring.generators[k].name)
            self._pending.add(k)
            try:
                self._found[k] = self._image_of(k)
            finally:
                self._pending.discard(k)
        return self._found[k]

    def _image_of(self, k: int) -> Image:
        if self.constant is not None and k in self.constant.images:
            c = self.context.gen(self.context.nvars() - 1)
            powers = enumerate(self.constant.images[k].coeffs())
            return sum((c**i * x for i, x in powers), self.context.constant(0)), self._one
        try:
            return self._plain_image_of(k)
        except Irrational:
            if k not in self.irrational and self.ring.generators[k].kind in ("root", "sine", "cosine"):
                self.irrational.append(k)
            raise

    def _plain_image_of(self, k: int) -> Image:
        g = self.ring.generators[k]
        if k in self._related:
            return self(self._related[k])
        if k in self._solved:
            return self(self._solved[k])
        if g.kind == "reciprocal":
            top, bottom = self(g.argument)
            if top == 0:
                raise SingularPoint("a formula divides by zero at these values")
            return _lowest(bottom, top)
        if g.kind == "root":
            return self._root(self(g.argument))
        if g.kind == "parameter" and g.name in self._symbols:
            return self._symbol(g.name)
        if g.kind == "parameter" and g.name != "pi":
            raise NoValue(g.name)
        raise Irrational(_told(self.ring, k))

    def _symbol(self, name: str) -> Image:
        """A symbol of the notation from its definition; where that lacks a number, the symbol does."""
        try:
            return self(self.scene.lower(self._symbols[name]))
        except NoValue as error:
            raise NoValue(name) from error

    def _root(self, image: Image) -> Image:
        """The square root where it is a rational number."""
        top, bottom = image
        if top.is_constant() and bottom.is_constant():
            value = fmpq(top.leading_coefficient()) / fmpq(bottom.leading_coefficient()) if top != 0 else fmpq(0)
            roots = [int(x) for x in (value.p.isqrt(), value.q.isqrt())] if value >= 0 else [0, 1]
            if value >= 0 and roots[0] ** 2 == value.p and roots[1] ** 2 == value.q:
                return self.context.constant(fmpq(*roots)), self._one
        raise Irrational("a square root")


def _told(ring: Ring, k: int) -> str:
    g = ring.generators[k]
    if g.kind in ("sine", "cosine") and g.argument is None:
        angle = g.name if g.denominator == 1 else f"{g.name}/{g.denominator}"
        return f"{'sin' if g.kind == 'sine' else 'cos'}({angle})"
    return g.name or g.kind


def _lowest(top: Polynomial, bottom: Polynomial) -> Image:
    """n/d without common factors."""
    if bottom.is_constant():
        return top / bottom.leading_coefficient(), bottom.context().constant(1)
    common = top.gcd(bottom)
    if not common.is_constant():
        top, bottom = top / common, bottom / common
    return top, bottom


def common_denominator(images: Sequence[Image]) -> Polynomial:
    """The least common multiple of the denominators."""
    below = images[0][1]
    for _, bottom in images[1:]:
        below = below * (bottom / below.gcd(bottom))
    return below
