"""A section of the space of parameters: a description with all parameters but one, two or three put in as numbers.

Problem 6's subsystems  M x'' + (D + G) x' + (K + N) x = 0  become matrices of polynomials in the axes with rational
coefficients.  Every matrix of a part is multiplied by the square of what their entries divide by, so that roots,
definiteness and verdicts are those of the part wherever the formulas make sense.

The axes, and what is given, may be parameters of the description or symbols of its notation (alpha = (c - b)/a).
Where symbols are given, the numbers of the description for the parameters in their definitions are not used: they
would say something else.  Symbols together have to be independent, which the rank of their derivatives at a random
rational point proves.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from itertools import product
from random import Random
from typing import TYPE_CHECKING, Any

from flint import fmpq, fmpq_mat

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure, NoValue, SingularPoint
from mbsym.algebra.ring import Polynomial
from mbsym.analysis import Analysis
from mbsym.analysis.judge import Judge
from mbsym.expressions.tree import names, reached
from mbsym.maps.axis import Axis
from mbsym.maps.images import Image, Images, Irrational, common_denominator
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.model.assumptions import RELATION_OF_SIGN, holds
from mbsym.model.constraints import is_holonomic
from mbsym.model.system import System, rational
from mbsym.problems.knowledge import definition_in_parameters
from mbsym.problems.stability.constant import Constant, constant_of, context_of
from mbsym.problems.stability.linear_form import LinearSystem
from mbsym.problems.stability.problem import Prepared, of_one_energy, prepared_parts
from mbsym.problems.stability.verdict import Verdict, combine, undecided
from mbsym.problems.stability.words import Because, Fact, Word

if TYPE_CHECKING:
    from mbsym.problems.dissipation import Balance
    from mbsym.problems.equilibrium import Equilibrium

#: With so many axes an irrational constant may stand among the coefficients.
MOST_BESIDE = 2
#: Of so many axes all signs are tried.
MOST_TRIED = 3


@dataclass(frozen=True)
class Section:
    """``parts`` over ``context``, whose generators are the ``axes`` in their order; ``coordinates`` of the parts.

    ``law`` tells by the signs of the axes whether the energy of the nonlinear system is proved not to grow, ``judged``
    gives the parts with that; ``parts`` and ``one_energy`` (as in ``verdict.combine``) hold what is proved for all
    points alike.  ``undefined``: where one of these vanishes the formulas divide by zero, or the equations have another
    form; nothing is said there.  ``constant``: an irrational number, the last generator.  ``numbers``: what may be put
    in, by name, also from the description; ``told``: those that were asked for or stand in the matrices.  ``images``
    does that with further formulas in parameters.  ``general``: what the nonlinear system shows at all parameters of a
    motion that the first approximation leaves open.
    """

    axes: tuple[Axis, ...]
    context: Any
    parts: tuple[LinearSystem, ...]
    coordinates: tuple[tuple[str, ...], ...]
    one_energy: bool
    law: Law
    undefined: tuple[Polynomial, ...]
    numbers: Mapping[str, Fraction]
    told: Mapping[str, Fraction]
    images: Images
    constant: Constant | None = None
    general: Verdict | None = None

    @property
    def asked(self) -> tuple[Polynomial, ...]:
        """The axes themselves, where what is known of the energy is different for their signs."""
        count = len(self.axes)
        gens = tuple(self.context.gens()[:count])
        if self.law.settled:
            return ()
        if count > MOST_TRIED:
            return gens
        laws = {signs: self.law.shown(signs) for signs in product((-1, 0, 1), repeat=count)}
        return tuple(
            gens[k]
            for k in range(count)
            if any(laws[signs] != laws[(*signs[:k], 0, *signs[k + 1 :])] for signs in laws)
        )

    def reduced(self, p: Polynomial) -> Polynomial:
        """p in normal form: 0 exactly where it vanishes in the whole section."""
        return p if self.constant is None else self.constant.reduced(p)

    def norm(self, p: Polynomial) -> Polynomial:
        """A polynomial in the axes alone that vanishes wherever p does."""
        return p if self.constant is None else self.constant.norm(p)

    def judged(self, signs: Sequence[int]) -> tuple[tuple[LinearSystem, ...], bool]:
        """(parts, one energy) where the coordinates of a point have these signs."""
        bounded, of_one = self.law.shown(tuple(signs[: len(self.axes)]))
        if bounded == self.one_energy and all(part.of_one == of_one for part in self.parts):
            return self.parts, self.one_energy
        return tuple(replace(part, conservative=bounded, of_one=of_one) for part in self.parts), bounded

    def whole(self, parts: Iterable[Verdict], one_energy: bool) -> Verdict:
        """The verdict on the whole system where those on its parts are these."""
        verdict = combine(parts, one_energy)
        return verdict if self.general is None or not verdict.word.open else self.general


class Law:
    """Whether the energy is proved not to grow, by the signs (-1, 0, 1) of the axes at a point, and what else is shown.

    The proof holds for all points of these signs; without one it is False.  What else there is, is of one coordinate.
    """

    def __init__(self, balance: Balance, axes: Sequence[str], given: Mapping[str, Fraction]) -> None:
        self._balance, self._axes = balance, tuple(axes)
        self._given = dict(given)
        there = balance.at(self._given)
        self.everywhere, self._of_one = there.law.bounded, of_one_energy(there)
        #: Whether no signs could show more.
        self.settled = self.everywhere and (there.conserves or not self._of_one or Fact.ENERGY_VARIES in self._of_one)
        self._found: dict[tuple[int, ...], tuple[bool, frozenset[Fact]]] = {}

    def __call__(self, signs: tuple[int, ...]) -> bool:
        return self.shown(signs)[0]

    def shown(self, signs: tuple[int, ...]) -> tuple[bool, frozenset[Fact]]:
        """(whether it does not grow, what else is shown of it)."""
        if self.settled:
            return True, self._of_one
        if signs not in self._found:
            self._found[signs] = self._prove(signs)
        return self._found[signs]

    def _prove(self, signs: Sequence[int]) -> tuple[bool, frozenset[Fact]]:
        ring = self._balance.scene.ring
        zeros = {name: Fraction(0) for name, sign in zip(self._axes, signs, strict=True) if sign == 0}
        known = {name: x for name, x in zeros.items() if name in self._balance.scene.system.parameter_names}
        assumptions = [
            (ring.generator("parameter", name) * sign, ">")
            for name, sign in zip(self._axes, signs, strict=True)
            if sign
        ]
        try:
            there = self._balance.at(self._given | known)
            there = replace(there, signs=self._balance.signs.assuming(assumptions))
            return there.law.bounded, of_one_energy(there)
        except ValueError:  # no parameters have these signs
            return False, frozenset()


def usable(system: System) -> tuple[str, ...]:
    """The names that axes and settings may have."""
    return (*system.parameter_names, *(item.name for item in system.notation))


def section(analysis: Analysis, axes: Sequence[Axis], settings: Mapping[str, Fraction]) -> Section:
    """The section of an analysis with one to three ``axes`` at the values of ``settings``, names as in ``usable``.

    With one or two axes, the other numbers may hold one root, or the sine and cosine of a fraction of pi
    (``constant``).
    Raises Unfit with all complaints, Unavailable where there is no first approximation to judge.
    """
    irrational: list[int] = []
    try:
        return _section(analysis, axes, settings, None, irrational)
    except Unfit as unfit:
        constant = None
        varied = {*(axis.name for axis in axes), *settings}  # of these the description's value is not the one here
        described = not any(analysis.ring.generators[k].name in varied for k in irrational)
        if described and len(axes) <= MOST_BESIDE and unfit.irrational:
            constant = constant_of(analysis.system, analysis.ring, irrational)
        if constant is None:
            raise
        return _section(analysis, axes, settings, constant, irrational)


def _section(
    analysis: Analysis,
    axes: Sequence[Axis],
    settings: Mapping[str, Fraction],
    constant: Constant | None,
    irrational: list[int],
) -> Section:
    """The section with a constant; what else is irrational joins ``irrational`` (generators of the ring)."""
    images, numbers, parts, balance, law = _prepared(analysis, axes, settings, constant)
    linear, motion = analysis.judgeable, analysis.equilibrium
    complaints: list[Complaint] = []
    undefined: list[Polynomial] = []
    systems = []
    for part in parts:
        made, below = _in_axes(part, part.at(balance), images, complaints)
        if made is not None:
            systems.append(made)
            undefined += below
    irrational += images.irrational
    if complaints:
        raise Unfit(list(dict.fromkeys(complaints)))
    used = frozenset(images.used)
    _motion_exists(motion, images)
    for assumed in linear.about.assumed:
        undefined += [x for x in _carried(images, assumed.polynomial) if not x.is_constant()]
    return Section(
        tuple(axes),
        images.context,
        tuple(systems),
        tuple(part.coordinates for part in parts),
        law.everywhere,
        law,
        tuple(undefined),
        numbers,
        {name: value for name, value in numbers.items() if name in used or name in settings},
        images,
        constant,
        _general(analysis),
    )


def _general(analysis: Analysis) -> Verdict | None:
    """What velocity constraints leave to the energy without them, at all parameters; None where that is nothing."""
    if all(map(is_holonomic, analysis.system.constraints)):
        return None
    verdict = Judge(in_velocities(analysis)).for_all(undecided(Because.VALUES_DECIDE))
    return None if verdict.word.open or verdict.word is Word.DEPENDS else verdict


def in_velocities(analysis: Analysis) -> Analysis:
    """The system in generalised velocities, in which motions are judged."""
    return analysis.in_coordinates if analysis.system.speeds else analysis


def unmade(
    analysis: Analysis, axes: Sequence[Axis], settings: Mapping[str, Fraction]
) -> tuple[Section, tuple[LinearSystem, ...]]:
    """(a section without parts, the parts in parameters), for matrices that are no polynomials in the axes.

    Raises Unfit as ``section`` does, but for what the matrices hold.
    """
    images, numbers, parts, balance, law = _prepared(analysis, axes, settings, None)
    _motion_exists(analysis.equilibrium, images)
    names = tuple(part.coordinates for part in parts)
    none = (), names, law.everywhere, law, (), numbers, numbers, images
    plain = Section(tuple(axes), images.context, *none, general=_general(analysis))
    return plain, tuple(part.at(balance) for part in parts)


def _prepared(
    analysis: Analysis, axes: Sequence[Axis], settings: Mapping[str, Fraction], constant: Constant | None
) -> tuple[Images, dict[str, Fraction], Sequence[Prepared], Balance, Law]:
    """What formulas become in the axes, the numbers of all else, the parts, and what is known of the energy there."""
    with analysis.strictly():
        linear, motion = analysis.judgeable, analysis.equilibrium
    scene, chosen = analysis.parameters_scene, [axis.name for axis in axes]
    numbers = numbers_given(analysis, chosen, settings, motion)
    solved = {name: value.polynomial for name, value in motion.solved}
    images = Images(scene, chosen, context_of(chosen, constant), numbers, solved, constant)
    parts = prepared_parts(scene, analysis.balance, linear, motion, analysis.signs)
    known = {name: x for name, x in numbers.items() if name in analysis.system.parameter_names}
    return images, numbers, parts, analysis.balance.at(known), Law(analysis.balance, chosen, known)


# --- matrices ---------------------------------------------------------------------------------------------------------


def _in_axes(
    part: Prepared, system: LinearSystem, images: Images, complaints: list[Complaint]
) -> tuple[LinearSystem | None, list[Polynomial]]:
    """The part's matrices in the axes, times the square of their common denominator, and that denominator."""
    entries = [[[_image(x, part, images, complaints) for x in row] for row in matrix] for matrix in system.matrices]
    turned = [_image(x, part, images, complaints) for x in system.turned]
    if any(x is None for matrix in entries for row in matrix for x in row) or any(x is None for x in turned):
        return None, []
    below = common_denominator([x for matrix in entries for row in matrix for x in row if x is not None])
    square = images.context.constant(1) if below.is_constant() else below * below

    def cleared(image: Image | None, by: Polynomial) -> Polynomial:
        assert image is not None
        whole = image[0] * (by / image[1])
        return whole if images.constant is None else images.constant.reduced(whole)

    m, d, g, k, n = (tuple(tuple(cleared(x, square) for x in row) for row in matrix) for matrix in entries)
    bottom = common_denominator([x for x in turned if x is not None]) if turned else below
    made = replace(system, M=m, D=d, G=g, K=k, N=n, turned=tuple(cleared(x, bottom * bottom) for x in turned))
    return made, [x for x in (below, bottom) if not x.is_constant()]


def _image(x: Polynomial, part: Prepared, images: Images, complaints: list[Complaint]) -> Image | None:
    """The image of an entry; None where it has none, with what is missing among the complaints."""
    ring = None if part.ring is images.ring else part.ring
    image: Image | None = None
    try:
        image = images(x, ring)
    except NoValue as error:
        complaints.append(Complaint(Fault.MISSING, _missing(error)))
        complaints += _further(x, ring, images)
    except Irrational as error:
        complaints.append(Complaint(Fault.IRRATIONAL, str(error)))
    except SingularPoint:
        complaints.append(Complaint(Fault.SINGULAR, str(x)))
    return image


def _further(x: Polynomial, ring: Any, images: Images) -> list[Complaint]:
    """Everything else in the same entry that has no number."""
    complaints = []
    for k in occurring([x]):
        try:
            images(x.context().gen(k), ring)
        except NoValue as error:
            complaints.append(Complaint(Fault.MISSING, _missing(error)))
        except Failure:
            pass
    return complaints


def _missing(error: NoValue) -> str:
    return str(error.args[0])


def _carried(images: Images, p: Polynomial) -> tuple[Polynomial, ...]:
    """Numerator and denominator of a formula in the axes; nothing where it cannot be had."""
    try:
        return images(p)
    except (Failure, ZeroDivisionError):
        return ()


def _motion_exists(motion: Equilibrium, images: Images) -> None:
    """Raises Unfit where a condition of problem 4 does not hold in the whole section."""
    complaints = []
    for condition in motion.conditions:
        try:
            top, _ = images(condition.polynomial)
        except NoValue as error:
            complaints.append(Complaint(Fault.MISSING, _missing(error)))
            continue
        except Failure:
            complaints.append(Complaint(Fault.NOWHERE, f"{condition} = 0"))
            continue
        if top != 0:
            complaints.append(Complaint(Fault.NOWHERE, f"{condition} = 0"))
    complaints += [Complaint(Fault.NOWHERE, f"{condition} = 0") for condition in motion.impossible]
    if complaints:
        raise Unfit(complaints)


# What is given of a section of the space of parameters: axes and numbers that fit together, or every complaint.


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
        super().__init__("; ".join(f"{x.name}: {x.fault.value} {x.about}".rstrip() for x in complaints))
        self.complaints = tuple(complaints)

    @property
    def irrational(self) -> bool:
        """Whether nothing else is wrong than that matrices are not rational in the axes."""
        return {complaint.fault for complaint in self.complaints} == {Fault.IRRATIONAL}


def numbers_given(
    analysis: Analysis, chosen: Sequence[str], settings: Mapping[str, Fraction], motion: Equilibrium
) -> dict[str, Fraction]:
    """The numbers of what is no axis.  Raises Unfit for names that do not fit together."""
    numbers = {name: value for name, value in settings.items() if name not in chosen}
    complaints = [*_determined(analysis.system, motion, [*chosen, *numbers]), *_against_signs(analysis, numbers)]
    complaints += _dependent(analysis.parameters_scene, [*chosen, *numbers])
    if complaints:
        raise Unfit(complaints)
    return _remaining(analysis.system, chosen, numbers, motion) | numbers


def _determined(system: System, motion: Equilibrium, chosen: Sequence[str]) -> list[Complaint]:
    """Names that follow from others: through relations, or where the motion exists."""
    from mbsym.expressions.tree import text

    related = {item.name: f"{item.name} = {text(item.value)}" for item in system.relations}
    solved = {name: f"{name} = {value}" for name, value in motion.solved}
    complaints = [Complaint(Fault.RELATED, name, related[name]) for name in chosen if name in related]
    return [*complaints, *(Complaint(Fault.SOLVED, name, solved[name]) for name in chosen if name in solved)]


def _against_signs(analysis: Analysis, numbers: Mapping[str, Fraction]) -> list[Complaint]:
    """Numbers that contradict a declared sign, or one that the definition of a symbol shows."""
    words = analysis.signs.words
    against_signs = []
    for name, value in numbers.items():
        word = words[analysis.ring.index("parameter", name)]
        relation = RELATION_OF_SIGN.get(word)
        if relation is not None and not holds(value, relation):
            against_signs.append(Complaint(Fault.SIGN, name, word))
    return against_signs


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
    rank, complaints = 0, []
    point = [fmpq(generator.randint(1000, 9999), generator.randint(100, 999)) for _ in range(ring.context.nvars())]
    for name in symbols:
        try:
            top, bottoms = ring.fraction(ring.substitute(definition_in_parameters(scene, name), images))
            below = ring.one
            for factor, exponent in bottoms:
                below = below * factor**exponent
            row = [_slope(top, below, k, point) for k in free]
        except (Failure, ZeroDivisionError):
            complaints.append(Complaint(Fault.SINGULAR, name))
            continue
        table = fmpq_mat([*rows, row]) if row else fmpq_mat(1, 1)
        if table.rank() == rank + 1:
            rows, rank = [*rows, row], rank + 1
        else:
            complaints.append(Complaint(Fault.DEPENDENT, name, ", ".join(x for x in chosen if x != name)))
    return complaints


def _slope(top: Polynomial, below: Polynomial, k: int, point: Sequence[Any]) -> Any:
    """d(top/below)/dx_k at a point."""
    n, d = fmpq(top(*point)), fmpq(below(*point))
    if d == 0:
        raise SingularPoint("at the random point")
    return (fmpq(top.derivative(k)(*point)) * d - n * fmpq(below.derivative(k)(*point))) / d**2


def _remaining(
    system: System, chosen: Sequence[str], own: Mapping[str, Fraction], motion: Equilibrium
) -> dict[str, Fraction]:
    """The description's own numbers, but for parameters that stand in symbols that are given."""
    meaning = {item.name: names(item.value) for item in system.notation}
    meaning |= {item.name: names(item.value) for item in system.relations}
    spoken = reached(meaning, (x for name in (*chosen, *own) for x in meaning.get(name, ())))
    taken = {*chosen, *own, *spoken, *(item.name for item in system.relations), *(name for name, _ in motion.solved)}
    values = ((item.name, rational(item.value)) for item in system.parameters if item.value is not None)
    return {name: value for name, value in values if value is not None and name not in taken}
