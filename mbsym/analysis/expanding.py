"""Problem 12 of a system: its equations sorted by the small parameter, the slow manifold, whether it attracts."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import fmpq_mpoly_ctx

from mbsym.algebra import rationals
from mbsym.algebra.factors import occurring, square_root_of
from mbsym.algebra.failures import Failure, NoClosedForm, message_of
from mbsym.algebra.quotients import Quotient
from mbsym.algebra.signs import Condition, Signs
from mbsym.algebra.signs import conditions as sharpest
from mbsym.algebra.terms import coefficients_in
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula, Shown
from mbsym.mechanics.motion import relations, unperturbed_with
from mbsym.model.system import SmallParameter
from mbsym.problems.small_parameter import slow
from mbsym.problems.small_parameter.checks import residual_orders
from mbsym.problems.small_parameter.result import Adjoined, Choice, Hurwitz, Outcome, ScaledField, SlowManifold, scaled
from mbsym.problems.small_parameter.slow import Root, Roots, adjoined, put, steady_states
from mbsym.problems.vector_field import Transfer, vector_field

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


@dataclass(frozen=True, repr=False)
class Expansion(Shown):
    """The manifold with the ring in which it is told.

    ``choice``: which root of the lowest order was taken; ``others``: the values of the fast variables at those that
    were not; ``unknown``: how many are neither rational nor square roots; ``real``: what makes the square root real,
    and not zero.  ``missing``: why nothing is said of steady states, "" where something is; ``fast``, ``slow``: whether
    the roots have negative real parts for all sufficiently small eps > 0, with what that takes of the parameters;
    ``provided``: what was divided by, and is not zero where the expansion holds; ``velocities``: variables that are
    rates of others.
    """

    manifold: SlowManifold
    transfer: Transfer
    names: tuple[str, ...]
    missing: str
    fast: tuple[Outcome, tuple[Condition, ...]] = (Outcome.UNDECIDED, ())
    slow: tuple[Outcome, tuple[Condition, ...]] = (Outcome.UNDECIDED, ())
    provided: tuple[Formula, ...] = ()
    velocities: tuple[str, ...] = ()
    choice: Choice = Choice.ONLY
    others: tuple[tuple[Formula, ...], ...] = ()
    unknown: int = 0
    real: tuple[Condition, ...] = ()

    @property
    def stabilizable(self) -> tuple[Outcome, tuple[Condition, ...]]:
        """Whether all roots but the zero ones have negative real parts for all sufficiently small eps > 0."""
        outcomes = {self.fast[0], self.slow[0]}
        worst = next(x for x in (Outcome.FAILS, Outcome.UNDECIDED, Outcome.CONDITIONAL, Outcome.HOLDS) if x in outcomes)
        return worst, (*self.fast[1], *self.slow[1])

    def formula(self, c: Quotient) -> Formula:
        """A coefficient as a formula of the description."""
        ring, root = self.transfer.ring, self.manifold.root
        if root is None:
            top, bottom = self.moved(c.top), self.moved(c.bottom)
            if c.bottom.is_constant():
                return Formula(ring, top)
            # one term below: what cancels in single terms is cancelled; partial fractions would be longer
            quotient = ring.times(top, ring.reciprocal(bottom))
            return Formula(ring, ring.reduce(quotient) if len(bottom) == 1 else quotient)
        whole, part, below = _rationalised(c, root)
        total = self.moved(whole) + ring.times(self.moved(part), ring.square_root(self.moved(root.square)))
        return Formula(ring, ring.times(total, ring.reciprocal(self.moved(below))))

    def moved(self, p: Any) -> Any:
        """A polynomial without the square root in the ring."""
        root = self.manifold.root
        names = [root.instead if root is not None and name == root.label else name for name in self.names]
        return self.transfer.told(p, names)


def _rationalised(c: Quotient, root: Adjoined) -> tuple[Any, Any, Any]:
    """(A, B, C) with  c = (A + B sqrt(d))/C, d = ``root.square``, in lowest terms, over the context of d."""
    context = root.square.context()

    def parts(p: Any) -> list[Any]:
        halves = [context.constant(0), context.constant(0)]
        for power, c in enumerate(coefficients_in(p, root.place)):
            halves[power % 2] += context.from_dict(c.to_dict()) * root.square ** (power // 2)
        return halves

    (a, b), (e, f) = parts(c.top), parts(c.bottom)
    below = e**2 - f**2 * root.square
    whole, part = a * e - b * f * root.square, b * e - a * f
    common = below.gcd(whole).gcd(part)
    return whole / common, part / common, below / common


def expansion(analysis: Analysis, order: int, values: Mapping[str, Fraction] | None = None) -> Expansion:
    """The slow manifold up to eps^order, checked.  Raises NoClosedForm where there is none, or it cannot be had."""
    small = analysis.system.small
    if small is None:
        raise NoClosedForm("the description names no small parameter", remedy="add 'small parameter: eps'")
    images = relations(analysis.parameters_scene)
    _refuse(analysis, small, values or {}, images)
    equations: Any = analysis.equations
    motion = _motion(analysis)
    steady: Iterable[Any] = () if isinstance(motion, str) else motion.values()
    whole, transfer = vector_field(analysis.form, equations, [*steady], images)
    inside = [name for name in whole.variables if not name.isidentifier()]
    if inside:
        raise NoClosedForm(
            "[[names]] are variables: slow manifolds are expanded in positions and velocities that stand by themselves",
            names=", ".join(inside),
            remedy="see 'mbsym oscillations' about a motion",
        )
    for name, _ in small.powers:
        if name in whole.variables:
            raise NoClosedForm(
                "[[name]] is a variable that is small itself: slow manifolds take powers of parameters only",
                name=name,
                remedy="see 'mbsym oscillations'",
            )
    numbers = {n: rationals.exact(x) for n, x in (values or {}).items() if n in whole.parameters}
    field = whole.at(numbers) if numbers else whole
    if small.name not in field.parameters and not any(name in field.parameters for name, _ in small.powers):
        raise NoClosedForm("the equations do not depend on [[name]]", name=small.name)
    there = scaled(field, small.name, dict(small.powers))
    fast = _declared(small, field.variables) or slow.fast_variables(there, small.slow)
    there, known, root = _with_root(analysis, there, fast, (*fast, small.name, *dict(small.powers)))
    velocities = () if analysis.system.speeds else analysis.system.velocities
    names = tuple(there.field.context.names())
    candidates: list[tuple[Expansion, Root]] = []
    reasons: list[Failure] = []
    for start in known.known:
        manifold = _expanded(analysis, there, fast, order, start, root)
        plain = Expansion(manifold, transfer, names, "", velocities=velocities)
        divided = (plain.formula(Quotient.of(p)) for p in slow.divisors(there, fast, manifold.functions, start))
        provided = {str(x): x for x in _open(analysis, divided)}
        if root is not None:
            square = plain.moved(root.square)
            provided.pop(str(Formula(analysis.ring, analysis.ring.square_root(square))), None)
            if _holds(manifold, root):
                plain = replace(plain, real=sharpest([_unscaled(analysis).condition(square)]))
        plain = replace(plain, provided=tuple(provided.values()))
        try:
            candidates.append((_about(analysis, plain, motion, numbers), start))
        except NoClosedForm as reason:
            reasons.append(reason)
    if not candidates:
        raise reasons[0]
    return _chosen(analysis, candidates, known)


def _holds(manifold: SlowManifold, root: Adjoined) -> bool:
    """Whether the square root stands in the expansion."""
    flow = [series for name, series in zip(manifold.slow, manifold.flow, strict=True) if name != root.label]
    quotients = [c for series in (*manifold.functions, *flow) for c in series.coefficients.values()]
    return any(not _rationalised(c, root)[1].is_zero() for c in quotients)


def _real_roots(analysis: Analysis, there: ScaledField, fast: tuple[str, ...]) -> Roots:
    """The roots of the lowest order, without square roots that are nowhere real."""
    real_roots, signs = slow.roots_of(there, fast), _declared_signs(analysis, there.field.context)
    real_roots = replace(real_roots, squares=tuple(x for x in real_roots.squares if signs.condition(x).kind != "never"))
    if not real_roots.any:
        raise NoClosedForm(
            "at the lowest order in [[small]] the equations of [[fast]] have no simple real solutions that are "
            "rational or square roots",
            small=there.small,
            fast=", ".join(fast),
        )
    return real_roots


def _declared_signs(analysis: Analysis, context: Any, root: Adjoined | None = None) -> Signs:
    """Of the parameters; a square root is positive."""
    known, assumed = {parameter.name: parameter.sign for parameter in analysis.system.parameters}, []
    if root is not None:
        if known.get(root.instead) == "positive":
            assumed.append((root.value.top * root.value.bottom, ">"))
        known[root.label] = "positive"
    return Signs(context, tuple(known.get(name, "real") for name in context.names()), tuple(assumed))


def _with_root(
    analysis: Analysis, there: ScaledField, fast: tuple[str, ...], held: Collection[str]
) -> tuple[ScaledField, Roots, Adjoined | None]:
    """The field in which the roots of the lowest order are rational, these, and the square root that it needs."""
    known = _real_roots(analysis, there, fast)
    if not known.squares:
        return there, known, None
    square = known.squares[0]
    adjunction = adjoined(there.field, square, held)
    if adjunction is None or not {there.field.context.names()[k] for k in occurring([square])}.isdisjoint(held):
        if known.known:
            return there, known, None
        raise NoClosedForm(
            "the fast variables hold a square root of something in which no slow variable or parameter is linear",
            remedy="" if square.is_constant() else "put in numbers with --set that make it a square",
        )
    field, root = adjunction
    there = scaled(field, there.small, dict(there.powers))
    return there, _real_roots(analysis, there, fast), root


def _expanded(
    analysis: Analysis, there: ScaledField, fast: tuple[str, ...], order: int, start: Root, root: Adjoined | None
) -> SlowManifold:
    """The manifold that begins at a root, with the flow on it.  Raises NoClosedForm where it fails its check."""
    functions = slow.manifold(there, fast, order, start)
    moving = slow.flow(there, fast, functions, order)
    left = residual_orders(there, fast, functions)
    manifold = SlowManifold(
        there, order, fast, tuple(moving), tuple(functions), tuple(moving.values()), left, root=root
    )
    if not manifold.verified:
        raise NoClosedForm("withdrawn: put into the equations, the expansion leaves terms of its own order")
    return manifold


def _about(
    analysis: Analysis, plain: Expansion, motion: Mapping[Any, Any] | str, numbers: Mapping[str, Any]
) -> Expansion:
    """With what is known of the steady state, told in the variables of the description.

    Raises NoClosedForm where a root that should be fast is slow.
    """
    manifold = plain.manifold
    flow = dict(zip(manifold.slow, manifold.flow, strict=True))
    if manifold.root is not None:
        rational_flow = slow.without_root(flow, manifold.root, plain.names)
        plain = replace(
            plain, manifold=replace(manifold, slow=tuple(rational_flow), flow=tuple(rational_flow.values()))
        )
    if isinstance(motion, str):
        return replace(plain, missing=motion)
    try:
        at = _steady_values(analysis, plain, motion, numbers)
        functions = dict(zip(manifold.fast, manifold.functions, strict=True))
        steady = steady_states(manifold.field, flow, functions, at, manifold.order)
        if manifold.root is not None:
            steady = replace(steady, free=slow.free_without_root(steady.free, manifold.root, plain.names))
    except Failure as reason:
        return replace(plain, missing=message_of(reason))
    except ZeroDivisionError:
        return replace(plain, missing="a denominator of the expansion vanishes on the motion")
    if steady.fast.bounded:
        raise NoClosedForm(
            "not all of [[fast]] are fast: of the roots that would belong to them one stays bounded as "
            "[[small]] tends to 0; of a slow manifold over more variables nothing is said",
            fast=", ".join(manifold.fast),
            small=manifold.field.small,
            remedy=slow.DECLARE,
        )
    plain = replace(plain, manifold=replace(plain.manifold, steady=steady))
    return replace(plain, fast=_judged(analysis, plain, steady.fast), slow=_judged(analysis, plain, steady.slow))


def _chosen(analysis: Analysis, candidates: Sequence[tuple[Expansion, Root]], known: Roots) -> Expansion:
    """The expansion that begins at the root on which the motion lies; else at the one that attracts; else the first."""
    unknown = known.others + 2 * len(known.squares)
    if len(known.known) + unknown == 1:
        return candidates[0][0]
    on, drawn = (
        [x for x in candidates if x[0].manifold.steady is not None],
        [x for x in candidates if _attracts(analysis, *x)],
    )
    listed, choice = (
        (on, Choice.ON_MOTION) if on else (drawn, Choice.ATTRACTING) if drawn else (candidates, Choice.FIRST)
    )
    taken, start = listed[0]
    others = [tuple(map(taken.formula, root.values)) for root in known.known if root is not start]
    return replace(taken, choice=choice, others=tuple(others), unknown=unknown)


def _attracts(analysis: Analysis, plain: Expansion, start: Root) -> bool:
    """Whether the only fast variable returns to the root: L/D < 0 for all parameters, D the denominator there."""
    manifold = plain.manifold
    scale = manifold.field.scales[manifold.field.field.variables.index(manifold.fast[0])]
    if len(manifold.fast) != 1 or scale <= 0:
        return False
    there = manifold.field
    place = len(there.field.parameters) + there.field.variables.index(manifold.fast[0])
    ratio = start.determinant * put(there.denominator[0], {place: start.values[0]})
    context, root = there.field.context, manifold.root
    if root is not None:
        whole, part, below = _rationalised(ratio, root)
        if part.is_zero():  # this root is there where the square root is not real, too
            ratio, context, root = Quotient(whole, below), whole.context(), None
    return _declared_signs(analysis, context, root).sign(ratio.top * ratio.bottom) == "negative"


def _refuse(
    analysis: Analysis, small: SmallParameter, values: Mapping[str, Fraction], images: Mapping[int, Any]
) -> None:
    """Raises NoClosedForm for what cannot be scaled, or cannot be a number."""
    scales = (small.name, *(name for name, _ in small.powers))
    related = {analysis.ring.generators[k].name for k in images}
    for name in scales:
        if name in related:
            raise NoClosedForm(
                "[[name]] is given by a relation: it is not small, or scaled, by itself",
                name=name,
                remedy="solve the relation for another parameter",
            )
        if name in values:
            raise NoClosedForm("[[name]] depends on the small parameter: it cannot be a number", name=name)
    for name in values:
        if name in related:
            raise NoClosedForm("[[name]] is given by a relation: it cannot be another number", name=name)
    signs = {parameter.name: parameter.sign for parameter in analysis.system.parameters}
    if signs.get(small.name) in ("negative", "nonpositive", "zero"):
        raise NoClosedForm(
            "expansions are about [[small]] > 0, and it is declared [[sign]]", small=small.name, sign=signs[small.name]
        )


def _open(analysis: Analysis, divided: Iterable[Formula]) -> Iterator[Formula]:
    """The factors of formulas that may be zero."""
    for formula in divided:
        for factor, _ in formula.polynomial.factor()[1]:
            if analysis.signs.sign(factor) not in ("positive", "negative"):
                yield Formula(formula.ring, factor)


def _declared(small: SmallParameter, variables: Sequence[str]) -> tuple[str, ...]:
    """The fast variables that are declared.  Raises NoClosedForm for one on which the equations do not depend."""
    for name in (*small.fast, *small.slow):
        if name not in variables:
            raise NoClosedForm("the equations do not depend on [[name]], which is declared fast or slow", name=name)
    return small.fast


def _motion(analysis: Analysis) -> Mapping[Any, Any] | str:
    """The unperturbed motion, by variables in speeds, by generators in coordinates; why there is none otherwise."""
    if not analysis.system.motion:
        return Message("no unperturbed motion is given")
    try:
        if not analysis.system.speeds:
            scene, equilibrium = analysis.parameters_scene, analysis.equilibrium
            if equilibrium.impossible:
                return equilibrium.why_not
            return unperturbed_with(scene, equilibrium.determined(scene))
        first_order = analysis.first_order
    except Unavailable as unavailable:
        return unavailable.reason
    except Failure as reason:
        return message_of(reason)
    return {name: value.polynomial for name, value in zip(first_order.names, first_order.values, strict=True)}


def _values(analysis: Analysis, transfer: Transfer, motion: Mapping[Any, Any]) -> Mapping[str, Any]:
    """The variables on it.  Raises NoClosedForm where one of them varies."""
    if analysis.system.speeds:
        return motion
    values = {}
    for name, k in zip(transfer.variables, transfer.places[len(transfer.parameters) :], strict=True):
        if k not in motion:
            raise NoClosedForm("[[name]] is not constant on the motion", name=name)
        values[name] = motion[k]
    return values


def _steady_values(
    analysis: Analysis, plain: Expansion, motion: Mapping[Any, Any], numbers: Mapping[str, Any]
) -> dict[str, Quotient]:
    """All variables of the field on the motion.  Raises NoClosedForm where they are no rational functions."""
    field, root = plain.manifold.field.field, plain.manifold.root
    names = [root.instead if root is not None and name == root.label else name for name in plain.names]
    before = fmpq_mpoly_ctx.get(names, field.context.ordering())
    at = {
        name: _quotient(plain.transfer, before, numbers, x)
        for name, x in _values(analysis, plain.transfer, motion).items()
    }
    for name in names[len(field.parameters) :]:
        at.setdefault(name, Quotient.of(before.constant(0)))
    if root is None:
        return at
    if root.label in field.variables:
        square = put(before.from_dict(root.square.to_dict()), {names.index(name): x for name, x in at.items()})
        at[root.label] = _positive_root(analysis, plain, square)
        del at[root.instead]

    def moved(p: Any) -> Quotient:
        p = field.context.from_dict(p.to_dict())
        return put(p, {root.place: root.value}) if root.label in field.parameters else Quotient.of(p)

    return {name: moved(x.top) / moved(x.bottom) for name, x in at.items()}


def _positive_root(analysis: Analysis, plain: Expansion, square: Quotient) -> Quotient:
    """The square root that is positive.  Raises NoClosedForm where it is none of the field, or has no sign."""
    top = square_root_of(square.top * square.bottom)
    if top is not None and (sign := analysis.signs.sign(plain.moved(top * square.bottom))) in ("positive", "negative"):
        return Quotient.of(top if sign == "positive" else -top, square.bottom)
    raise NoClosedForm(
        "the square root in the fast variables is no rational function on the motion, or has no sign there"
    )


def _quotient(transfer: Transfer, context: Any, numbers: Mapping[str, Any], p: Any) -> Quotient:
    names = context.names()
    images = [
        context.constant(numbers[name]) if name in numbers else context.gen(names.index(name))
        for name in transfer.context.names()
    ]
    try:
        top, bottom = transfer.fraction(p)
    except NoClosedForm as reason:
        raise NoClosedForm("the unperturbed motion is no rational function of the parameters") from reason
    return Quotient.of(top.compose(*images, ctx=context), bottom.compose(*images, ctx=context))


def _judged(analysis: Analysis, plain: Expansion, hurwitz: Hurwitz) -> tuple[Outcome, tuple[Condition, ...]]:
    """Hurwitz's minors by their first coefficients, under the assumptions of the description."""
    signs, conditions = _unscaled(analysis), []
    for minor in hurwitz.minors:
        if minor.lowest is None:
            return Outcome.UNDECIDED, ()
        lead = minor.coefficients[minor.lowest]
        ring = plain.transfer.ring
        top = plain.formula(Quotient.of(lead.top)).polynomial
        bottom = plain.formula(Quotient.of(lead.bottom)).polynomial
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
        return any(ring.generators[k].name in scales for k in ring.held([p]))

    assumptions = tuple(assumption for assumption in analysis.signs.assumptions if not held(assumption[0]))
    return replace(analysis.signs, assumptions=assumptions)
