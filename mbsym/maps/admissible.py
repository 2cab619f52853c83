"""What parameters have to keep, in the axes of a map: declared signs, assumptions, what a rigid body can be.

A verdict is about a mechanical system of the description, so none is given where these are broken: there formulas were
divided by factors whose sign would be another one.  What cannot be expressed in the axes is listed as left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from mbsym.algebra.characteristic import determinant
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Signs
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message
from mbsym.expressions.tree import is_number, text
from mbsym.maps.boundaries import Condition, Origin
from mbsym.maps.images import Images
from mbsym.maps.section import Section
from mbsym.mechanics.kinematics import Scene
from mbsym.model.assumptions import RELATION_OF_SIGN, holds
from mbsym.model.system import Body
from mbsym.problems.stability.problem import elimination_of

_FLIPPED = {"<": ">", "<=": ">="}


@dataclass(frozen=True)
class Demand:
    """``condition.polynomial`` ``relation`` 0, with relation one of >, >=, !=."""

    condition: Condition
    relation: str

    def kept(self, value: Any) -> bool:
        """Whether it is kept where the polynomial has this sign or value."""
        return holds(value, self.relation)


@dataclass(frozen=True)
class Admissibility:
    """``demands`` that depend on the axes; ``broken``: those that no point of the section keeps.

    ``left_out``: what could not be expressed in the axes.
    """

    demands: tuple[Demand, ...]
    broken: tuple[Demand, ...]
    left_out: tuple[str, ...]

    @property
    def known(self) -> tuple[tuple[Polynomial, str], ...]:
        """(polynomial, relation to 0) of what holds wherever a verdict is given."""
        return tuple((demand.condition.polynomial, demand.relation) for demand in self.demands)


def admissibility(analysis: Analysis, section: Section) -> Admissibility:
    """Everything that points of the section have to keep."""
    demands: list[Demand] = []
    left_out: list[str] = []
    _signs(analysis, section, demands)
    _assumptions(analysis, section.images, demands, left_out)
    for body in analysis.system.bodies:
        _triangles(analysis, body, section.images, demands, left_out)
    unique: list[Demand] = []
    for demand in demands:
        same = (x.condition.polynomial == demand.condition.polynomial and x.relation == demand.relation for x in unique)
        if not any(same):
            unique.append(demand)
    plain = [requirement for requirement in unique if not requirement.condition.polynomial.is_constant()]
    broken = [
        requirement
        for requirement in unique
        if requirement.condition.polynomial.is_constant()
        and not requirement.kept(_number(requirement.condition.polynomial))
    ]
    return Admissibility(tuple(plain), tuple(broken), tuple(dict.fromkeys(left_out)))


def _number(p: Polynomial) -> Any:
    return p.leading_coefficient() if p != 0 else 0


def _signs(analysis: Analysis, section: Section, demands: list[Demand]) -> None:
    """Declared signs of the axes, of symbols among them, and of what relations make of them."""
    words = analysis.signs.words
    chosen = {axis.name for axis in section.axes} | {item.name for item in analysis.system.relations}
    for name in sorted(chosen):
        k = analysis.ring.index("parameter", name)
        relation = RELATION_OF_SIGN.get(words[k])
        if relation is None:
            continue
        about = f"{name} {relation} 0"
        try:
            top, bottom = section.images(analysis.ring.context.gen(k))
        except (Failure, ZeroDivisionError):
            continue  # a relation among what the section does not hold
        if relation in _FLIPPED:
            top, relation = -top, _FLIPPED[relation]
        condition = Condition(Origin.SIGN, top * bottom, about=about)
        demands.append(Demand(condition, relation))


def _assumptions(analysis: Analysis, images: Images, demands: list[Demand], left_out: list[str]) -> None:
    scene = analysis.parameters_scene
    for item in analysis.system.assumptions:
        words = f"{text(item.left)} {item.relation} {text(item.right)}"
        try:
            top, bottom = images(scene.lower(item.left) - scene.lower(item.right))
        except (Failure, ZeroDivisionError):
            left_out.append(words)
            continue
        relation, value = item.relation, top * bottom
        if relation in _FLIPPED:
            value, relation = -value, _FLIPPED[relation]
        demands.append(Demand(Condition(Origin.ASSUMPTION, value, about=words), relation))


def _triangles(analysis: Analysis, body: Body, images: Images, demands: list[Demand], left_out: list[str]) -> None:
    """The second moments of a body about its mass centre are positive semidefinite: no principal minor is negative."""
    if body.inertia is None or body.inertia.accepted:
        return
    tensor = body.inertia.tensor
    if sum(not is_number(x, 0) for row in tensor for x in row) == 1:
        return  # one moment alone is that of plane motion, and leaves the others open
    scene, about = analysis.parameters_scene, Message("inertia of [[body]]", body=body.name)
    try:
        moments = list(_second_moments(scene, body))
    except (Failure, ZeroDivisionError):
        left_out.append(about)
        return
    elimination, signs = elimination_of(scene), analysis.signs
    for minor in moments:
        if minor.is_zero():
            continue
        value = _expressed(minor, images, signs)
        if value is None:
            try:
                value = _expressed(elimination(minor), images, signs)
            except (Failure, ZeroDivisionError):
                value = None
        if value is None:
            left_out.append(about)
        else:
            demands.append(Demand(Condition(Origin.INERTIA, value, about=about), ">="))


def _expressed(p: Polynomial, images: Images, signs: Signs) -> Polynomial | None:
    """A polynomial in the axes with the sign of p, factors that are known to be positive left out if need be."""
    ring = images.ring
    try:
        top, bottom = images(p)
    except (Failure, ZeroDivisionError):
        pass
    else:
        return top * bottom
    try:
        top, bottoms = ring.fraction(p)
        if any(signs.sign(factor) != "positive" for factor, _ in bottoms):
            return None
        condition = signs.condition(top)
        if condition.kind != "inequality" or condition.nonzero:
            return None
        top, bottom = images(condition.polynomial)
    except (Failure, ZeroDivisionError):
        return None
    return top * bottom


def _second_moments(scene: Scene, body: Body) -> Iterator[Polynomial]:
    """All principal minors of P = tr(J)/2 1 - J, with J about the mass centre."""
    assert body.inertia is not None
    ring = scene.ring
    tensor = [[scene.lower(x) for x in row] for row in body.inertia.tensor]
    if body.inertia.about == "joint":
        mass, centre = scene.lower(body.mass), [scene.lower(x) for x in body.mass_centre]
        square = sum((ring.times(x, x) for x in centre), ring.zero)
        shift = [
            [(square if i == j else ring.zero) - ring.times(centre[i], centre[j]) for j in range(3)] for i in range(3)
        ]
        tensor = [[ring.reduce(tensor[i][j] - ring.times(mass, shift[i][j])) for j in range(3)] for i in range(3)]
    half = (tensor[0][0] + tensor[1][1] + tensor[2][2]) / 2
    moments = [[(half if i == j else ring.zero) - tensor[i][j] for j in range(3)] for i in range(3)]
    diagonal = all(tensor[i][j].is_zero() for i in range(3) for j in range(3) if i != j)
    for size in (1,) if diagonal else (1, 2, 3):
        for chosen in combinations(range(3), size):
            yield ring.reduce(determinant([[moments[i][j] for j in chosen] for i in chosen]))
