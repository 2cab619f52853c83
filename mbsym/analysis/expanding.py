"""Problem 12 of a system: its equations sorted by the small parameter, the slow manifold, whether it attracts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure, NoClosedForm, message_of
from mbsym.algebra.quotients import Quotient
from mbsym.algebra.signs import Condition, Signs
from mbsym.algebra.signs import conditions as sharpest
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula, Shown
from mbsym.mechanics.motion import relations, unperturbed_with
from mbsym.model.system import SmallParameter
from mbsym.problems.small_parameter import slow
from mbsym.problems.small_parameter.checks import residual_orders
from mbsym.problems.small_parameter.result import Hurwitz, Outcome, SlowManifold, scaled
from mbsym.problems.small_parameter.steady import steady_states
from mbsym.problems.vector_field import Transfer, vector_field

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


@dataclass(frozen=True, repr=False)
class Expansion(Shown):
    """The manifold with the ring in which it is told.

    ``missing``: why nothing is said of steady states, "" where something is; ``fast``, ``slow``: whether the roots have
    negative real parts for all sufficiently small eps > 0, with what that takes of the parameters; ``provided``: what
    was divided by, and is not zero where the expansion holds; ``velocities``: variables that are rates of others.
    """

    manifold: SlowManifold
    transfer: Transfer
    names: tuple[str, ...]
    missing: str
    fast: tuple[Outcome, tuple[Condition, ...]] = (Outcome.UNDECIDED, ())
    slow: tuple[Outcome, tuple[Condition, ...]] = (Outcome.UNDECIDED, ())
    provided: tuple[Formula, ...] = ()
    velocities: tuple[str, ...] = ()

    @property
    def stabilizable(self) -> tuple[Outcome, tuple[Condition, ...]]:
        """Whether all roots but the zero ones have negative real parts for all sufficiently small eps > 0."""
        outcomes = {self.fast[0], self.slow[0]}
        worst = next(x for x in (Outcome.FAILS, Outcome.UNDECIDED, Outcome.CONDITIONAL, Outcome.HOLDS) if x in outcomes)
        return worst, (*self.fast[1], *self.slow[1])

    def formula(self, c: Quotient) -> Formula:
        """A coefficient as a formula of the description."""
        ring, context = self.transfer.ring, self.transfer.context
        places = [(*self.transfer.parameters, *self.transfer.variables).index(name) for name in self.names]

        def back(p: Any) -> Any:
            terms = {}
            for monomial, number in p.to_dict().items():
                exponents = [0] * len(context.names())
                for k, power in zip(places, monomial, strict=True):
                    exponents[k] = power
                terms[tuple(exponents)] = number
            return self.transfer.back(context.from_dict(terms))

        top, bottom = back(c.top), back(c.bottom)
        return Formula(ring, ring.times(top, ring.reciprocal(bottom)) if not c.bottom.is_constant() else top)


def expansion(analysis: Analysis, order: int, values: Mapping[str, Fraction] | None = None) -> Expansion:
    """The slow manifold up to eps^order, checked.  Raises NoClosedForm where there is none, or it cannot be had."""
    small = analysis.system.small
    if small is None:
        raise NoClosedForm("the description names no small parameter", remedy="add 'small parameter: eps'")
    form = analysis.speed_form
    images = relations(analysis.parameters_scene)
    _refuse(analysis, small, values or {}, images)
    equations: Any = analysis.equations
    motion = _motion(analysis)
    steady: Iterable[Any] = () if isinstance(motion, str) else motion.values()
    whole, transfer = vector_field(analysis.system, analysis.ring, form, equations, [*steady], images)
    inside = [name for name in whole.variables if not name.isidentifier()]
    if inside:
        raise NoClosedForm(
            Message(
                "[[names]] are variables: slow manifolds are expanded in positions and velocities that stand by "
                "themselves",
                names=", ".join(inside),
            ),
            remedy="see 'mbsym oscillations' about a motion",
        )
    for name, _ in small.powers:
        if name in whole.variables:
            raise NoClosedForm(
                Message(
                    "[[name]] is a variable that is small itself: slow manifolds take powers of parameters only",
                    name=name,
                ),
                remedy="see 'mbsym oscillations'",
            )
    numbers = {n: rationals.exact(x) for n, x in (values or {}).items() if n in whole.parameters}
    field = whole.at(numbers) if numbers else whole
    if small.name not in field.parameters and not any(name in field.parameters for name, _ in small.powers):
        raise NoClosedForm(Message("the equations do not depend on [[name]]", name=small.name))
    there = scaled(field, small.name, dict(small.powers))
    fast = _declared(small, field.variables) or slow.fast_variables(there, small.slow)
    functions = slow.manifold(there, fast, order)
    moving = slow.flow(there, fast, functions, order)
    found = SlowManifold(
        there,
        order,
        fast,
        tuple(moving),
        tuple(functions),
        tuple(moving.values()),
        residual_orders(there, fast, functions),
    )
    if not found.verified:
        raise NoClosedForm("withdrawn: put into the equations, the expansion leaves terms of its own order")
    names = tuple(field.context.names())
    plain = Expansion(found, transfer, names, "", velocities=() if form is not None else analysis.system.velocities)
    divided = (plain.formula(Quotient.of(p)) for p in slow.divisors(there, fast, functions))
    plain = replace(plain, provided=tuple({str(x): x for x in _open(analysis, divided)}.values()))
    if isinstance(motion, str):
        return replace(plain, missing=motion)
    try:
        at = {n: _quotient(transfer, names, numbers, x) for n, x in _values(analysis, transfer, motion).items()}
        for name in (*fast, *moving):
            at.setdefault(name, Quotient.of(field.context.constant(0)))
        steady_found = steady_states(there, moving, dict(zip(fast, functions, strict=True)), at, order)
    except Failure as reason:
        return replace(plain, missing=message_of(reason))
    except ZeroDivisionError:
        return replace(plain, missing="a denominator of the expansion vanishes on the motion")
    if steady_found.fast.bounded:
        raise NoClosedForm(
            Message(
                "not all of [[fast]] are fast: of the roots that would belong to them one stays bounded as "
                "[[small]] tends to 0; of a slow manifold over more variables nothing is said",
                fast=", ".join(fast),
                small=small.name,
            ),
            remedy=slow.DECLARE,
        )
    plain = replace(plain, manifold=replace(found, steady=steady_found))
    return replace(
        plain, fast=_judged(analysis, plain, steady_found.fast), slow=_judged(analysis, plain, steady_found.slow)
    )


def _refuse(
    analysis: Analysis, small: SmallParameter, values: Mapping[str, Fraction], images: Mapping[int, Any]
) -> None:
    """Raises NoClosedForm for what cannot be scaled, or cannot be a number."""
    scales = (small.name, *(name for name, _ in small.powers))
    related = {analysis.ring.generators[k].name for k in images}
    for name in scales:
        if name in related:
            raise NoClosedForm(
                Message("[[name]] is given by a relation: it is not small, or scaled, by itself", name=name),
                remedy="solve the relation for another parameter",
            )
        if name in values:
            raise NoClosedForm(Message("[[name]] depends on the small parameter: it cannot be a number", name=name))
    for name in values:
        if name in related:
            raise NoClosedForm(Message("[[name]] is given by a relation: it cannot be another number", name=name))
    signs = {one.name: one.sign for one in analysis.system.parameters}
    if signs.get(small.name) in ("negative", "nonpositive", "zero"):
        raise NoClosedForm(
            Message(
                "expansions are about [[small]] > 0, and it is declared [[sign]]",
                small=small.name,
                sign=signs[small.name],
            )
        )


def _open(analysis: Analysis, divided: Iterable[Formula]) -> Iterator[Formula]:
    """The factors of formulas that may be zero."""
    for one in divided:
        for factor, _ in one.polynomial.factor()[1]:
            if analysis.signs.sign(factor) not in ("positive", "negative"):
                yield Formula(one.ring, factor)


def _declared(small: SmallParameter, variables: Sequence[str]) -> tuple[str, ...]:
    """The fast variables that are declared.  Raises NoClosedForm for one on which the equations do not depend."""
    for name in (*small.fast, *small.slow):
        if name not in variables:
            raise NoClosedForm(
                Message("the equations do not depend on [[name]], which is declared fast or slow", name=name)
            )
    return small.fast


def _motion(analysis: Analysis) -> Mapping[Any, Any] | str:
    """The unperturbed motion, by variables in speeds, by generators in coordinates; why there is none otherwise."""
    if not analysis.system.motion:
        return "no unperturbed motion is given"
    try:
        if analysis.speed_form is None:
            scene, equilibrium = analysis.parameters_scene, analysis.equilibrium
            if equilibrium.impossible:
                return "the given motion does not exist"
            return unperturbed_with(scene, equilibrium.determined(scene))
        found = analysis.first_order
    except Unavailable as unavailable:
        return unavailable.reason
    except Failure as reason:
        return message_of(reason)
    return {name: value.polynomial for name, value in zip(found.names, found.values, strict=True)}


def _values(analysis: Analysis, transfer: Transfer, motion: Mapping[Any, Any]) -> Mapping[str, Any]:
    """The variables on it.  Raises NoClosedForm where one of them varies."""
    if analysis.speed_form is not None:
        return motion
    found = {}
    for name, k in zip(transfer.variables, transfer.places[len(transfer.parameters) :], strict=True):
        if k not in motion:
            raise NoClosedForm(Message("[[name]] is not constant on the motion", name=name))
        found[name] = motion[k]
    return found


def _quotient(transfer: Transfer, names: tuple[str, ...], numbers: Mapping[str, Any], p: Any) -> Quotient:
    from flint import fmpq_mpoly_ctx

    context = fmpq_mpoly_ctx.get(list(names), transfer.context.ordering())
    images = [
        context.constant(numbers[name]) if name in numbers else context.gen(names.index(name))
        for name in transfer.context.names()
    ]
    try:
        top, bottom = transfer.fraction(p)
    except NoClosedForm as reason:
        raise NoClosedForm("the unperturbed motion is no rational function of the parameters") from reason
    return Quotient.of(top.compose(*images, ctx=context), bottom.compose(*images, ctx=context))


def _judged(analysis: Analysis, told: Expansion, hurwitz: Hurwitz) -> tuple[Outcome, tuple[Condition, ...]]:
    """Hurwitz's minors by their first coefficients, under the assumptions of the description."""
    signs, conditions = _unscaled(analysis), []
    for minor in hurwitz.minors:
        if minor.lowest is None:
            return Outcome.UNDECIDED, ()
        lead = minor.coefficients[minor.lowest]
        ring = told.transfer.ring
        top = told.formula(Quotient.of(lead.top)).polynomial
        bottom = told.formula(Quotient.of(lead.bottom)).polynomial
        product = ring.times(top, bottom)
        conditions.append(signs.condition(product))
        if conditions[-1].kind == "never":  # where it is zero, higher orders decide, which are not looked at
            return (Outcome.FAILS if signs.sign(product) == "negative" else Outcome.UNDECIDED), ()
    left = sharpest(conditions)
    return (Outcome.CONDITIONAL if left else Outcome.HOLDS), left


def _unscaled(analysis: Analysis) -> Signs:
    """What is known of signs without the assumptions that hold the small parameter: eps tends to zero beyond them."""
    small, ring = analysis.system.small, analysis.ring
    assert small is not None
    scales = {small.name, *(name for name, _ in small.powers)}

    def held(p: Any) -> bool:
        generators = [ring.generators[k] for k in occurring([p])]
        return any(g.name in scales or (g.argument is not None and held(g.argument)) for g in generators)

    kept = tuple(one for one in analysis.signs.assumptions if not held(one[0]))
    return replace(analysis.signs, assumptions=kept)
