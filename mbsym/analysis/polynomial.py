"""Problem 9 of a system: its equations as a polynomial field, which integrals are known, what is found."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, partial
from typing import TYPE_CHECKING, Any

from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.signs import Signs
from mbsym.analysis import constrained
from mbsym.analysis.symmetric import blocks_of, symmetries_of
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.motion import relations
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import Oracles
from mbsym.model.speeds import Quaternion, UnitVector
from mbsym.problems.integrals import Integral
from mbsym.problems.polynomial_integrals.gradings import Grading, grading
from mbsym.problems.polynomial_integrals.homogenised import InAnyField, ZeroLevels
from mbsym.problems.polynomial_integrals.levels import levels, on_level
from mbsym.problems.polynomial_integrals.relations import linear_relations
from mbsym.problems.polynomial_integrals.result import (
    FUNCTION,
    Cases,
    DarbouxPolynomials,
    OtherLevels,
    PolynomialIntegrals,
    Polynomials,
    Relations,
)
from mbsym.problems.polynomial_integrals.search import polynomial_integrals
from mbsym.problems.symmetries.search import Gradients
from mbsym.problems.vector_field import Transfer, put_in, vector_field

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis
    from mbsym.problems.checks import Check


@dataclass(frozen=True)
class Setting:
    """The field of a system: ``whole`` over all parameters, ``field`` with numbers in place of some.

    ``kinds``: variables that have one weight, speeds first; ``known``: integrals of problem 7 over ``field``;
    ``aside``: positions on which no equation depends, which are no variables; ``inside``: those that are none,
    either, but stand in exponentials or reciprocals; ``rational``: integrals of problem 7 whose denominators hold
    variables.
    """

    whole: PolynomialField
    field: PolynomialField
    transfer: Transfer
    kinds: tuple[tuple[str, ...], ...]
    vectors: tuple[tuple[str, ...], ...]
    known: tuple[tuple[str, Any], ...]
    aside: tuple[str, ...] = ()
    inside: tuple[str, ...] = ()
    rational: tuple[str, ...] = ()
    #: Whether constraints tie positions that are variables.
    tied: bool = False
    #: Whether a formula is a function of the integrals of problem 7, those that are none of ``known`` among them.
    follows: Callable[[Formula], bool] = lambda formula: False

    def formula(self, p: Any) -> Formula:
        """A polynomial over ``field``, or one with numbers in place of further parameters, as a formula."""
        return Formula(self.transfer.ring, self.transfer.told(p, p.context().names()))

    def quotient_over(self, field: PolynomialField, top: Any) -> Formula:
        """``top`` over the denominator of a field with numbers in place of further parameters."""
        return self.quotient(top, field.denominator)

    def quotient(self, top: Any, bottom: Any) -> Formula:
        """The same of a quotient of two over ``field``, in lowest terms."""
        common = top.gcd(bottom)
        ring = self.transfer.ring
        upper, lower = (self.formula(p / common).polynomial for p in (top, bottom))
        return Formula(ring, ring.ratio(upper, lower))


def setting(analysis: Analysis, values: Mapping[str, Fraction] | None = None, driven: bool = False) -> Setting:
    """The equations of motion as a polynomial field, with numbers in place of some parameters.

    Phases of the time are variables where they may be ``driven``.

    Raises NoClosedForm where they are no such field, ZeroDivisionError where it
    divides by zero at these numbers.
    """
    form, declared = analysis.form, analysis.system.speeds
    equations: Any = analysis.equations
    listed = analysis.integrals
    listed = tuple(_without_aside(form, equations.aside, integral) for integral in listed) if declared else listed
    also = [integral.formula.polynomial for integral in listed]
    images = relations(analysis.parameters_scene)
    whole, transfer = vector_field(form, equations, also, images, driven=driven, rooted=driven)
    angles = [name.removeprefix("sin") for name in whole.variables if name.startswith("sin(")]
    vectors: Any = [(angle, (f"sin{angle}", f"cos{angle}")) for angle in angles]
    exponentials = tuple(name for name in whole.variables if name.startswith("exp("))
    held = analysis.ring.dependencies(transfer.back(_product(whole)), analysis.system.coordinates)
    inside = tuple(name for name in held if name not in whole.variables and f"sin({name})" not in whole.variables)
    if not declared:
        speeds: tuple[str, ...] = tuple(name for name in whole.variables if name not in exponentials)
        aside = _unfelt(analysis, transfer, held)
    else:
        vectors, speeds, aside = [*equations.vectors, *vectors], equations.speeds, _aside(form, equations.aside)
    numbers = {name: rationals.exact(x) for name, x in (values or {}).items() if name in whole.parameters}
    field = whole.at(numbers) if numbers else whole
    known, rational = _known(whole, field, numbers, transfer, listed)
    grouped_by = [tuple(x for x in components if x in whole.variables) for _, components in vectors]
    grouped = {name for vector in grouped_by for name in vector}
    speeds = tuple(name for name in speeds if name in whole.variables)
    alone = [(name,) for name in whole.variables if name not in grouped and name not in speeds]
    groups = [group for group in grouped_by if group]
    apart = (*dict.fromkeys(groups), *alone) if declared else (exponentials,)
    kinds = tuple(x for x in (speeds, *apart) if x)
    follows = None
    if len(known) < len(listed):
        follows = cache(partial(_following, analysis, dict(values or {}), transfer.images))
    tied = equations.constraints.position_rank > 0 and bool(whole.relations)
    there = Setting(whole, field, transfer, kinds, tuple(groups), tuple(known), aside, inside, rational, tied)
    return there if follows is None else replace(there, follows=lambda formula: follows()(formula))


def _following(
    analysis: Analysis, values: Mapping[str, Fraction], dependent: Mapping[int, Any]
) -> Callable[[Formula], bool]:
    """Whether a formula is a function of the integrals of problem 7: by gradients at a state of the whole system.

    As the length of the angular momentum is of its components in space, which a field without orientations lacks.
    ``dependent`` velocities are put in first: states are told by the others.
    """
    blocks = blocks_of(analysis, values)
    gradients = Gradients(analysis.system, blocks)
    for integral in analysis.integrals:
        gradients.add(put_in(blocks.ring, put_in(blocks.ring, integral.formula.polynomial, dependent), blocks.images))
    return lambda formula: gradients.grows(put_in(blocks.ring, formula.polynomial, blocks.images)) is False


def _product(field: PolynomialField) -> Any:
    """All variables times each other."""
    total = field.context.constant(1)
    for name in field.variables:
        total *= field.generator(name)
    return total


def _unfelt(analysis: Analysis, transfer: Transfer, held: Collection[str]) -> tuple[str, ...]:
    """The coordinates that are not ``held``, nor given by those that are."""
    ring, names = analysis.ring, analysis.system.coordinates
    positions = {ring.generators[k].name: x for k, x in transfer.images.items() if ring.generators[k].kind in _PLACES}
    given = (name for name, x in positions.items() if {*held}.issuperset(ring.dependencies(x, names)))
    return tuple(name for name in names if name not in {*held, *given})


#: Kinds of generators that are positions or functions of one.
_PLACES = ("coordinate", "sine", "cosine")


def _aside(form: SpeedForm, aside: Sequence[str]) -> tuple[str, ...]:
    """Positions on which no equation depends, unit vectors and quaternions as wholes.

    Of unit vectors those that the description asks for: nobody expects others.
    """
    whole = {name: one for body in form.oriented for one in body.orientation for name in one.components}
    selected = (name if name not in whole else whole[name].name if _asked(whole[name]) else None for name in aside)
    return tuple(dict.fromkeys(name for name in selected if name is not None))


def _asked(orientation: UnitVector | Quaternion) -> bool:
    return isinstance(orientation, Quaternion) or orientation.asked


def _without_aside(form: SpeedForm, aside: Sequence[str], integral: Integral) -> Integral:
    """The integral with 1 for the squares of unit vectors on which the equations do not depend."""
    ring, p = form.ring, integral.formula.polynomial
    for vector in (vector for body in form.oriented for vector in body.orientation):
        if set(vector.components) <= set(aside):
            norm = -ring.one
            for name in vector.components:
                norm = norm + ring.generator("coordinate", name) ** 2
            p = divmod(p, norm)[1]
    return replace(integral, formula=Formula(ring, ring.reduce(p)))


def with_known(there: Setting, listed: Sequence[Integral]) -> Setting:
    """The same with further integrals that are known, which hold no parameters but those of ``there.field``."""
    gone = {name: fmpq(0) for name in there.whole.parameters if name not in there.field.parameters}
    further, _ = _known(there.whole, there.field, gone, there.transfer, listed)
    return replace(there, known=(*there.known, *further))


#: What the name of an integral gets where only its numerator is told: the denominator holds parameters alone.
MULTIPLE = "[[name]], but for a constant factor (its denominator is left out)"


def _known(
    whole: PolynomialField,
    field: PolynomialField,
    numbers: Mapping[str, Any],
    transfer: Transfer,
    listed: Sequence[Integral],
) -> tuple[list[tuple[str, Any]], tuple[str, ...]]:
    """Names and numerators of integrals, of those that are polynomials on the field; with denominators: ``MULTIPLE``.

    Then the names of those that are quotients with variables below.
    """
    known, rational = [], []
    for integral in listed:
        try:
            top, bottom = transfer.fraction(integral.formula.polynomial)
        except Failure:
            continue  # it holds the time, or positions on which the equations do not depend
        if not any(bottom.degrees()[k] for k in whole.places):
            name = integral.name if bottom.is_constant() else Message(MULTIPLE, name=integral.name)
            known.append((name, _at(whole, field, numbers, top)))
        else:
            rational.append(integral.name)
    return known, tuple(rational)


def _at(whole: PolynomialField, field: PolynomialField, numbers: Mapping[str, Any], p: Any) -> Any:
    if field is whole:
        return p
    places = (*field.parameters, *field.variables)
    images = [
        field.context.constant(numbers[name]) if name in numbers else field.context.gen(places.index(name))
        for name in (*whole.parameters, *whole.variables)
    ]
    return p.compose(*images, ctx=field.context)


def allowed(analysis: Analysis, there: Setting, values: Mapping[str, Fraction], candidates: Cases) -> Cases:
    """Without the cases whose conditions contradict the signs and assumptions of the description."""
    numbers = {name: rationals.exact(x) for name, x in values.items() if name in there.whole.parameters}
    assumed = []
    for p, relation in analysis.signs.assumptions:
        with suppress(Failure):  # it holds other parameters than the equations
            assumed.append((_at(there.whole, there.field, numbers, there.transfer(p)), relation))
    declared = {parameter.name: parameter.sign for parameter in analysis.system.parameters}
    words = tuple(declared.get(name, "real") for name in there.field.context.names())
    signs = Signs(there.field.context, words, tuple(assumed))
    cases = tuple(
        case
        for case in candidates.cases
        if not any(signs.sign(p) in ("positive", "negative", "nonzero") for p in case.conditions)
    )
    return replace(candidates, cases=cases)


def weights_of(there: Setting, weights: Mapping[str, int] | None = None) -> Grading:
    """The weights of the variables: those found, or found and then replaced by ``weights``.

    The components of a unit vector have one weight: the largest that is given to one of them.
    """
    automatic = grading(there.field, there.kinds)
    if not weights:
        return automatic
    weight_by_name = dict(zip(there.field.variables, automatic.weights, strict=True)) | dict(weights)
    for vector in there.vectors:
        largest = max((weights[name] for name in vector if name in weights), default=weight_by_name[vector[0]])
        weight_by_name |= dict.fromkeys(vector, largest)
    return grading(there.field, there.kinds, [weight_by_name[name] for name in there.field.variables])


def integrals_of(there: Setting, degree: int, weights: Mapping[str, int] | None = None) -> PolynomialIntegrals:
    """All polynomial integrals up to a weighted degree.  Raises NoClosedForm where that is too much."""
    integrals = polynomial_integrals(there.field, weights_of(there, weights), degree, there.known)
    named = (
        replace(generator, name=FUNCTION)
        if not generator.name and there.follows(there.formula(generator.polynomial))
        else generator
        for generator in integrals.generators
    )
    found = replace(integrals, aside=there.aside, inside=there.inside, rational=there.rational, tied=there.tied)
    return replace(found, generators=tuple(named))


#: Problem 9 looks at integrals up to this weighted degree; ``mbsym integrals --degree`` at others.
DEGREE = 4


def polynomials_of(analysis: Analysis) -> Polynomials:
    """Problem 9 for the symbols of the description."""
    there = setting(analysis, driven=True)
    integrals = integrals_of(there, DEGREE)
    on = [
        restriction
        for restriction in (on_level(integrals, level) for level in levels(integrals))
        if restriction.integrals
    ]
    symmetries = None
    with suppress(Failure):  # the integrals stand without them
        symmetries = symmetries_of(analysis)
    return Polynomials(
        integrals,
        tuple(there.formula(there.field.generator(name)) for name in there.field.variables),
        tuple(there.formula(generator.polynomial) for generator in integrals.generators),
        tuple(on),
        tuple(tuple(there.formula(f) for _, f in restriction.integrals) for restriction in on),
        symmetries,
    )


def check(analysis: Analysis) -> Check | None:
    """Only where somebody has asked for it: dI/dt of those found, by d'Alembert's principle along the motion.

    Where parameters are related the states keep the relations; None where one of these gives an angle.
    """
    truth = analysis.oracles
    if analysis.system.relations:
        if any(relation.name in analysis.ring.angles for relation in analysis.system.relations):
            return None
        truth = _Related(analysis.system, analysis.ring, truth.count)
    polynomials = analysis.optional("polynomial_integrals") if "polynomial_integrals" in analysis.derived else None
    if polynomials is None:
        return None
    new = [
        Integral(
            Message("integral of weight [[weight]]", weight=generator.weight),
            "polynomial",
            "",
            formula,
            Certainty.PROVED,
        )
        for generator, formula in zip(polynomials.integrals.generators, polynomials.formulas, strict=True)
        if generator.is_new
    ]
    if polynomials.symmetries is not None:
        new += [
            Integral(Message("integral of symmetry [[k]]", k=k), "symmetry", "", symmetry.integral, Certainty.PROVED)
            for k, symmetry in enumerate(polynomials.symmetries.symmetries, start=1)
            if not symmetry.name
        ]
    if not new:
        return None
    return replace(constrained.integrals_check(analysis, new, truth), name="polynomial integrals")


class _Related(Oracles):
    """Oracles at states whose dependent parameters are what the relations say."""

    def _oracle(self, state: State) -> Oracle:
        values = dict(state.values)
        for relation in self.system.relations:
            values[relation.name] = Lowering(state.numbers, values)(relation.value)
        return super()._oracle(State(state.numbers, values))


# What divides its derivative, of a system: linear forms, Darboux polynomials, integrals where another one is zero.


@dataclass(frozen=True)
class InvariantRelations:
    """``linear`` forms with conditions on the parameters; ``darboux`` polynomials of any weight for almost all of them.

    ``levels``: integrals that hold where one of those found is zero, ``others``: where it has another value; None where
    several unit vectors or angles are related, and none was looked at.
    """

    linear: Relations
    darboux: DarbouxPolynomials
    levels: ZeroLevels | None
    others: OtherLevels | None


def invariant_relations(there: InAnyField, positive: Sequence[str]) -> InvariantRelations:
    """All four, up to the degree of the integrals; ``positive``: parameters that are.

    Raises NoClosedForm where more monomials are coupled than the bounds allow.
    """
    field, grading = there.usual.field, there.usual.grading
    linear = linear_relations(field, grading.weights, positive, grading.free)
    return InvariantRelations(linear, there.darboux(), there.zero_levels(), there.other_levels())
