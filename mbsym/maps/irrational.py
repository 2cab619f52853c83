"""Boxes where matrices hold functions of the axes that are no fractions of polynomials: sin(a), sqrt(a), exp(a).

There are no boundary polynomials.  All entries of the first approximation are enclosed over a box (a ball for each
function, dependences between them forgotten), and a box is proved by theorems that need strict inequalities only, as in
``subdivision.ByEnclosures``.  Axes are parameters of the description; everything else has a rational number.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import ctx, fmpq

from mbsym.algebra import rationals
from mbsym.algebra.failures import Failure, NoValue
from mbsym.algebra.plane import Box
from mbsym.algebra.plane.numbers import Rational, between, sign
from mbsym.analysis import Analysis
from mbsym.maps.given import Complaint, Fault, Unfit
from mbsym.maps.section import Axis, unmade
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.problems.stability.enclosed import enclosed_verdict_with_cyclic
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.problem import ExactVerdicts
from mbsym.problems.stability.verdict import Verdict, combine, displaced, off_the_leaf

#: Working precision, in bits: boxes are wide.
BITS = 64


class IrrationalSection:
    """``plain`` is the section without its matrices; ``verdict`` judges a box, ``at`` a rational point."""

    def __init__(
        self, analysis: Analysis, axes: Sequence[Axis], settings: Mapping[str, Fraction], why: Sequence[Complaint]
    ) -> None:
        """Raises Unfit for ``why`` where an axis or a setting is a symbol of the notation, or there are constraints.

        Unfit, too, where a name that occurs has no number.
        """
        names = {item.name for item in analysis.system.parameters}
        if not {*settings, *(axis.name for axis in axes)} <= names or analysis.system.constraints:
            raise Unfit(why)
        self.plain, self._systems = unmade(analysis, axes, settings)
        self._analysis, self._scene, self._linear = analysis, analysis.parameters_scene, analysis.judgeable
        self._solved = {name: value.polynomial for name, value in analysis.equilibrium.solved}
        self._exact: ExactVerdicts | None = None
        (x, y), made = axes, fmpq
        whole = Box(*(made(v.numerator, v.denominator) for v in (x.low, x.high, y.low, y.high)))
        try:
            for part in self._systems:
                self._matrices(part, whole)
        except NoValue as error:
            raise Unfit([Complaint(Fault.MISSING, str(error.args[0]))]) from error

    def verdict(self, box: Box) -> Verdict:
        """What theorems show of all points of a box; undecided where enclosures leave it open."""
        ranges = ((box.x0, box.x1), (box.y0, box.y1))
        apart = all(a > 0 or b < 0 for a, b in ranges)
        bounded = self.plain.law(tuple(sign(a) for a, _ in ranges)) if apart else self.plain.law.everywhere
        return combine((self._judged(part, box, bounded) for part in self._systems), bounded)

    def _judged(self, part: LinearSystem, box: Box, bounded: bool) -> Verdict:
        matrices = self._matrices(part, box)
        cyclic = () if part.driven else part.cyclic
        found = displaced(enclosed_verdict_with_cyclic(matrices, bounded, cyclic, BITS, part.exact), part.basis)
        return off_the_leaf(found) if part.leaf else found

    def _matrices(self, part: LinearSystem, box: Box) -> list[list[list[Any]]]:
        """M, D, G, K, N of a part in balls over a box."""
        x, y = self.plain.axes
        numbers = {name: rationals.exact(value) for name, value in self.plain.numbers.items()}
        with ctx.workprec(BITS):
            ranges = {x.name: between(box.x0, box.x1, BITS), y.name: between(box.y0, box.y1, BITS)}
            values = _Values(self._scene, self._solved, numbers | ranges)
            basis, evaluate = part.basis, self._scene.ring.evaluate
            names = part.names if basis is None else basis.coordinates
            at = [self._linear.coordinates.index(name) for name in names]
            blocks = [[[matrix.polynomials[i][j] for j in at] for i in at] for matrix in self._linear.matrices]
            if basis is not None:
                blocks = [basis.congruent(self._scene.ring, block) for block in blocks]
            return [[[evaluate(x, values) for x in row] for row in block] for block in blocks]

    def at(self, x: Rational, y: Rational) -> Verdict:
        """The verdict at a point, by the route that problem 6 takes at the numbers of a description."""
        if self._exact is None:
            one = self._analysis
            self._exact = ExactVerdicts(one.parameters_scene, one.balance, one.judgeable, one.equilibrium, one.signs)
        point = (rationals.fraction(v) for v in (x, y))
        names = {item.name for item in self._analysis.system.parameters}
        known = {name: value for name, value in self.plain.numbers.items() if name in names}
        return self._exact(known | dict(zip((axis.name for axis in self.plain.axes), point, strict=True)))


class _Values(dict[str, Any]):
    """Numbers by name; what follows from others is enclosed when it is asked for."""

    def __init__(self, scene: Scene, solved: Mapping[str, Any], known: Mapping[str, Any]) -> None:
        super().__init__(known)
        self._scene = scene
        generators = scene.ring.generators
        self._images = {str(generators[k].name): image for k, image in relations(scene).items()} | dict(solved)
        self._symbols = {item.name: item.value for item in scene.system.notation}

    def __missing__(self, name: str) -> Any:
        if name in self._images:
            image = self._images.pop(name)
        elif name in self._symbols:
            image = self._scene.lower(self._symbols.pop(name))
        else:
            raise NoValue(name)
        self[name] = self._scene.ring.evaluate(image, self)
        return self[name]


def irrational(error: Failure) -> bool:
    """Whether nothing else is wrong than that matrices are not rational in the axes."""
    return isinstance(error, Unfit) and {one.fault for one in error.complaints} == {Fault.IRRATIONAL}


def told(error: Unfit) -> str:
    """``the matrices hold what is no rational number there: sin(a)``."""
    return "the matrices hold what is no fraction of polynomials: " + ", ".join(
        dict.fromkeys(one.name for one in error.complaints)
    )
