"""What is given of a section of the space of parameters: axes and numbers that fit together, or every complaint."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from random import Random
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

from mbsym.algebra.failures import Failure, SingularPoint
from mbsym.algebra.ring import Polynomial
from mbsym.analysis import Analysis
from mbsym.expressions.tree import names
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.model.assumptions import RELATION_OF_SIGN, holds
from mbsym.model.system import System, rational
from mbsym.problems.knowledge import definition_in_parameters

if TYPE_CHECKING:
    from mbsym.problems.equilibrium import Equilibrium


class Fault(Enum):
    """Why a section cannot be made."""

    MISSING = "no number"
    RELATED = "a relation gives it"
    SOLVED = "the motion needs another value, or gives it"
    DEPENDENT = "not independent of the others"
    SIGN = "against its declared sign"
    NOWHERE = "the motion does not exist"
    IRRATIONAL = "not rational"
    SINGULAR = "a division by zero"
    OUTSIDE = "no point keeps it"


@dataclass(frozen=True)
class Complaint:
    """What is wrong with the axes or numbers given; ``name`` whom it is about, ``about`` what else is to be told."""

    fault: Fault
    name: str
    about: str = ""


class Unfit(Failure):
    """No section can be made; all complaints at once."""

    code = "section"

    def __init__(self, complaints: Sequence[Complaint]) -> None:
        super().__init__("; ".join(f"{one.name}: {one.fault.value} {one.about}".rstrip() for one in complaints))
        self.complaints = tuple(complaints)


def numbers_given(
    analysis: Analysis, chosen: Sequence[str], settings: Mapping[str, Fraction], motion: Equilibrium
) -> dict[str, Fraction]:
    """The numbers of what is no axis.  Raises Unfit for names that do not fit together."""
    given = {name: value for name, value in settings.items() if name not in chosen}
    complaints = [*_determined(analysis.system, motion, [*chosen, *given]), *_against_signs(analysis, given)]
    complaints += _dependent(analysis.parameters_scene, [*chosen, *given])
    if complaints:
        raise Unfit(complaints)
    return _remaining(analysis.system, chosen, given, motion) | given


def _determined(system: System, motion: Equilibrium, chosen: Sequence[str]) -> list[Complaint]:
    """Names that follow from others: through relations, or where the motion exists."""
    from mbsym.expressions.tree import text

    related = {item.name: f"{item.name} = {text(item.value)}" for item in system.relations}
    solved = {name: f"{name} = {value}" for name, value in motion.solved}
    found = [Complaint(Fault.RELATED, name, related[name]) for name in chosen if name in related]
    return [*found, *(Complaint(Fault.SOLVED, name, solved[name]) for name in chosen if name in solved)]


def _against_signs(analysis: Analysis, given: Mapping[str, Fraction]) -> list[Complaint]:
    """Numbers that contradict a declared sign, or one that the definition of a symbol shows."""
    words = analysis.signs.words
    found = []
    for name, value in given.items():
        word = words[analysis.ring.index("parameter", name)]
        relation = RELATION_OF_SIGN.get(word)
        if relation is not None and not holds(value, relation):
            found.append(Complaint(Fault.SIGN, name, word))
    return found


def _dependent(scene: Scene, chosen: Sequence[str]) -> list[Complaint]:
    """Symbols of the notation that are not independent of what else is given.

    The rank of their derivatives by the parameters that are not given is found at a random rational point: a full one
    proves that they are independent.
    """
    ring, images = scene.ring, relations(scene)
    symbols = [name for name in chosen if name in {item.name for item in scene.system.notation}]
    if not symbols:
        return []
    free = [
        ring.index("parameter", x.name)
        for x in scene.system.parameters
        if x.name not in chosen and ring.index("parameter", x.name) not in images
    ]
    generator = Random(20261122)
    rows: list[list[Any]] = []
    rank, found = 0, []
    point = [fmpq(generator.randint(1000, 9999), generator.randint(100, 999)) for _ in range(ring.context.nvars())]
    for name in symbols:
        try:
            top, bottoms = ring.fraction(ring.substitute(definition_in_parameters(scene, name), images))
            below = ring.one
            for factor, exponent in bottoms:
                below = below * factor**exponent
            row = [_slope(top, below, k, point) for k in free]
        except (Failure, ZeroDivisionError):
            found.append(Complaint(Fault.SINGULAR, name))
            continue
        table = fmpq_mat([*rows, row]) if row else fmpq_mat(1, 1)
        if table.rank() == rank + 1:
            rows, rank = [*rows, row], rank + 1
        else:
            found.append(Complaint(Fault.DEPENDENT, name, ", ".join(x for x in chosen if x != name)))
    return found


def _slope(top: Polynomial, below: Polynomial, k: int, point: Sequence[Any]) -> Any:
    """d(top/below)/dx_k at a point."""
    n, d = fmpq(top(*point)), fmpq(below(*point))
    if d == 0:
        raise SingularPoint("at the random point")
    return (fmpq(top.derivative(k)(*point)) * d - n * fmpq(below.derivative(k)(*point))) / d**2


def _remaining(
    system: System, chosen: Sequence[str], given: Mapping[str, Fraction], motion: Equilibrium
) -> dict[str, Fraction]:
    """The description's own numbers, but for parameters that stand in symbols that are given."""
    meaning = {item.name: names(item.value) for item in system.notation}
    meaning |= {item.name: names(item.value) for item in system.relations}
    spoken: set[str] = set()
    pending = [x for name in (*chosen, *given) if name in meaning for x in meaning[name]]
    while pending:
        name = pending.pop()
        if name not in spoken:
            spoken.add(name)
            pending += meaning.get(name, ())
    taken = {*chosen, *given, *spoken, *(item.name for item in system.relations), *(name for name, _ in motion.solved)}
    values = ((item.name, rational(item.value)) for item in system.parameters if item.value is not None)
    return {name: value for name, value in values if value is not None and name not in taken}
