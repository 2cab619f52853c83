"""Problem 11 in the pipeline: of which systems it can be, and what it is told of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import arb

from mbsym.algebra import rationals
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.matrices import solved
from mbsym.algebra.parts import installed
from mbsym.algebra.point import Rationals
from mbsym.analysis.approximation import kept_by_velocities, refuse_unsolved
from mbsym.analysis.poles import pole
from mbsym.expressions.message import Message
from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import ZERO, names
from mbsym.formulas.formula import Formula
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.motion import relations, turning, unperturbed_with
from mbsym.mechanics.symmetry import constantly_curved
from mbsym.mechanics.variables import expressions
from mbsym.model.substitution import on_one_side
from mbsym.problems import knowledge
from mbsym.problems.checks import FAILED, NUMERICAL, Check
from mbsym.problems.stability import problem as stability
from mbsym.problems.stability.verdict import Extremum, Verdict, by_extremum, by_geodesics, coasting
from mbsym.problems.stability.words import Because, Fact, HigherOrder, Reason, Word

if TYPE_CHECKING:
    from mbsym.algebra.ring import Polynomial, Ring
    from mbsym.algebra.signs import Signs
    from mbsym.analysis.pipeline import Analysis
    from mbsym.mechanics.expansion import OnManifold
    from mbsym.problems.dissipation import Balance
    from mbsym.problems.normal_forms.result import InSymbols, Judged, NormalForms


def normal_forms_of(analysis: Analysis) -> NormalForms:
    """What terms of higher order decide; with numbers where the description gives all of them."""
    from mbsym.problems.normal_forms import problem  # few ask for it
    from mbsym.problems.normal_forms.result import InSymbols, Judged, Outcome, Theorem, Why
    from mbsym.problems.stabilisation.problem import on_motion

    analysis = analysis.in_free_coordinates
    equilibrium, scene = analysis.equilibrium, analysis.parameters_scene
    analysis.judgeable  # noqa: B018  raises where the first approximation, or time, says that no theorem applies
    refuse_unsolved(equilibrium)
    values = stability.parameter_values(scene, equilibrium)
    nothing = Why.NONE
    if values is not None:
        divides = pole(analysis, values) is not None
        nothing = Why.POLE if divides else Why.NONE if on_motion(scene, equilibrium, values) else Why.NO_MOTION
    values = values if nothing is Why.NONE else None
    result = problem.Expanded(scene, analysis.system, equilibrium, *expanded_with(analysis)).normal_forms(values)
    judged = analysis.optional("stability")
    before = None if judged is None else judged.before_higher_order or judged.numerical
    first = None if before is None else before.word
    if nothing is not Why.NONE:
        result = replace(result, at_values=Judged(Outcome.UNDECIDED, Theorem.NONE, nothing))
    if isinstance(result.in_symbols, InSymbols):
        result = replace(result, in_symbols=_told_by_signs(result.in_symbols, analysis.signs))
    balance = analysis.balance
    return replace(
        result,
        linear=balance.exactly_linear,
        linear_at_values=values is not None and balance.at(values).exactly_linear,
        first=first,
        everywhere=None if judged is None else decided(judged.verdict.word),
    )


def judge(analysis: Analysis) -> Callable[[Mapping[str, Any]], Judged | None]:
    """What terms of higher order decide at rational values of all parameters; None where they could not be had.

    The expansions are made once for all of them.
    """
    from mbsym.problems.normal_forms import problem

    scene, equilibrium = analysis.parameters_scene, analysis.equilibrium
    made: list[Callable[[Mapping[str, Any]], Judged]] = []

    def at(values: Mapping[str, Any]) -> Judged | None:
        try:
            if not made:
                made.append(problem.Expanded(scene, analysis.system, equilibrium, *expanded_with(analysis)).at)
            return made[0](values)
        except (Failure, *NOT_THERE):
            return None

    return at


def by_energy(analysis: Analysis, values: Mapping[str, Fraction]) -> Verdict | None:
    """What a minimum of the potential energy of higher order says under constraints; None where it says nothing."""
    from mbsym.problems.normal_forms import problem

    balance = analysis.balance.at(values)
    try:
        if not balance.law.bounded:
            return None
        scene, manifold = analysis.parameters_scene, on_manifold(analysis)
        if balance.conserves and nothing_acts(analysis):
            return coasting(Because.ALIKE) if _alike(analysis, values) else by_geodesics()
        damping = () if on_a_leaf(analysis) else analysis.autonomous.D.polynomials
        equilibrium = analysis.equilibrium
        expanded = problem.Expanded(scene, analysis.system, equilibrium, manifold=manifold)
        return expanded.by_energy(balance.conserves, values, damping)
    except (Failure, *NOT_THERE):
        return None


def nothing_acts(analysis: Analysis) -> bool:
    """Whether no force of any kind moves the system from rest, for all parameters."""
    return all(map(analysis.ring.vanishes, _acting(analysis)))


def _acting(analysis: Analysis) -> Iterator[Polynomial]:
    """dU/dq, other forces, and the momenta at q' = 0."""
    force_function = analysis.energy.force_function.polynomial
    yield from generalized_forces(analysis.held_scene).values()
    yield from (analysis.ring.derivative(force_function, name) for name in analysis.system.coordinates)
    yield from momenta_at_rest(analysis)


def momenta_at_rest(analysis: Analysis) -> Iterator[Polynomial]:
    """dT/dq' at q' = 0, whose changes are gyroscopic forces."""
    kinetic = analysis.energy.kinetic_energy.polynomial
    for name in analysis.system.coordinates:
        yield analysis.ring.at_rest(analysis.ring.velocity_derivative(kinetic, name))


def by_reduced_potential(analysis: Analysis, values: Mapping[str, Any] | None = None) -> Verdict | None:
    """Instability of a steady motion at whose momenta beta of cyclic coordinates c the reduced potential W is constant.

    With dT/dc' = beta, dW/ds = -dL/ds at s' = 0, and gyroscopic forces are changes of dT/ds' there, of which one
    coordinate s knows nothing.  For all parameters, or at ``values``; None where something varies or was not found.
    """
    system, ring = analysis.system, analysis.ring
    if system.constraints or system.speeds or (values is None and not analysis.equilibrium.satisfied):
        return None
    if not turning(analysis.scene) or nothing_acts(analysis):  # judged by whether positions are alike
        return None
    numbers = {} if values is None else ring.given(values)
    here = unperturbed_with(analysis.scene, relations(analysis.scene))

    def at(x: Polynomial) -> Polynomial:
        return ring.reduce(ring.substitute(x, dict(numbers)))

    try:
        energy, balance = analysis.energy, analysis.balance if values is None else analysis.balance.at(values)
        c = [name for name in balance.ignorable if name not in balance.driven]
        s = [name for name in system.coordinates if name not in c]
        if not (
            c and s and balance.conserves and all(map(ring.vanishes, generalized_forces(analysis.held_scene).values()))
        ):
            return None
        still = {ring.index("velocity", name): ring.zero for name in s}
        momenta = [
            ring.substitute(ring.velocity_derivative(energy.kinetic_energy.polynomial, name), still) for name in c
        ]
        gaps = [[at(ring.substitute(p, here) - ring.at_rest(p))] for p in momenta]
        mass = [[at(ring.velocity_derivative(p, name)) for name in c] for p in momenta]
        rates = {ring.index("velocity", name): x for name, (x,) in zip(c, solved(ring, mass, gaps), strict=True)}
        lagrangian = energy.kinetic_energy.polynomial + energy.force_function.polynomial
        varying = [ring.derivative(lagrangian, name) for name in s]
        if len(s) > 1:
            varying += [ring.velocity_derivative(lagrangian, name) for name in s]
        if not all(ring.vanishes(at(ring.substitute(x, still | rates))) for x in varying):
            return None
    except (Failure, *NOT_THERE):
        return None
    return by_geodesics()


def _alike(analysis: Analysis, values: Mapping[str, Fraction]) -> bool:
    """Whether all positions that the constraints leave are alike for the kinetic energy; False where it is not known.

    Of T = v.(Y^T M Y) v/2 in independent velocities, with d/dy_k = Y_k . d/dq along the manifold; what vanishes there
    has the constraints f(q) as factors of its numerator.
    """
    if len(analysis.autonomous.M.polynomials) == 1:
        return True
    ring, tied, embedded = analysis.ring, analysis.constraints, analysis.equations.embedded
    if tied.solved is None or tied.in_speeds or embedded is None:
        return False
    numbers = ring.given(values)

    def at(x: Polynomial) -> Polynomial:
        return ring.reduce(ring.substitute(x, numbers))

    directions = [list(map(at, column)) for column in zip(*tied.solved.transformation.polynomials, strict=True)]
    rows = [ring.fraction(at(x.polynomial))[0] for x in tied.position if x is not None]

    def derivative(x: Polynomial, k: int) -> Polynomial:
        return ring.reduce(ring.dot(directions[k], [ring.derivative(x, name) for name in analysis.system.coordinates]))

    def vanishes(x: Polynomial) -> bool:
        top, _ = ring.fraction(x)
        for row in rows:
            top = ring.reduce(divmod(top, row)[1])
        return ring.vanishes(top)

    metric = [list(map(at, row)) for row in embedded.mass_matrix.polynomials]
    try:
        return constantly_curved(ring, metric, derivative, vanishes)
    except Failure:
        return False


@dataclass(frozen=True)
class FirstTerm:
    """A term of V(x) of a system of one coordinate, ``coefficient`` x^``order``, on a border: those before vanish.

    ``damped`` by a term of first order, x' = -V'(x)/d on the centre manifold, else the energy decides; ``conserved``:
    it does not fall; ``leaf``: velocity constraints keep relations, and what decays there is stable.  ``of_one``: what
    is shown where there are no other coordinates.
    """

    order: int
    coefficient: Polynomial
    damped: bool
    conserved: bool
    leaf: bool
    of_one: frozenset[Fact]

    def verdict(self, sign: str) -> Verdict | None:
        """The verdict where the coefficient has this sign; None where that does not decide."""
        if self.order % 2:
            extremum = Extremum.NONE if sign in ("positive", "negative", "nonzero") else Extremum.OPEN
        else:
            extremum = {"positive": Extremum.MINIMUM, "negative": Extremum.NONE}.get(sign, Extremum.OPEN)
        return self.by(extremum)

    def by(self, extremum: Extremum) -> Verdict | None:
        """The verdict by what V has there."""
        if not self.damped or extremum is Extremum.OPEN:
            return by_extremum(self.order, extremum, self.conserved, of_one=self.of_one)
        decaying = Word.STABLE if self.leaf else Word.ASYMPTOTIC
        word = decaying if extremum is Extremum.MINIMUM else Word.UNSTABLE
        return Verdict(word, (HigherOrder.REDUCTION.value,), (Reason(Because.TERMS_OF_HIGHER_ORDER),))


def first_terms(analysis: Analysis, balance: Balance, sign: Callable[[Polynomial], str]) -> Iterator[FirstTerm]:
    """The terms that ``sign`` does not call zero, in order, to the first that cannot vanish.

    None of several coordinates, where K does not vanish, or where the energy may both grow and fall.  ``balance`` is
    that at the values ``sign`` is about.
    """
    if not installed("mbsym.problems.normal_forms"):
        return
    from mbsym.problems.normal_forms import problem

    scene = analysis.parameters_scene
    try:
        damping = analysis.autonomous.D.polynomials
        of_one = stability.of_one_energy(balance)
        if len(damping) != 1 or not (balance.law.bounded or of_one):
            return
        manifold = on_manifold(analysis) if analysis.system.constraints else None
        damped, leaf = sign(damping[0][0]) == "positive", on_a_leaf(analysis)
        expanded = problem.Expanded(scene, analysis.system, analysis.equilibrium, manifold=manifold)
        for order, coefficient in expanded.first_terms(sign):
            if order == 2:
                return
            above, below = scene.ring.fraction(coefficient)
            for factor, exponent in below:
                above = scene.ring.times(above, scene.ring.power(factor, exponent))
            yield FirstTerm(order, scene.ring.reduce(above), damped, balance.conserves, leaf, of_one)
            if sign(coefficient) in ("positive", "negative", "nonzero"):
                return
    except (Failure, *NOT_THERE):
        return


def of_one_coordinate(analysis: Analysis, verdict: Verdict, values: Mapping[str, Any] | None = None) -> Verdict:
    """A verdict that is on a border, decided by the first term of V(x) of the one coordinate.

    For all parameters, or at ``values`` of them.
    """
    if analysis.parameters_scene.ring.kinked:
        return _of_two_sides(analysis, values) or verdict
    sign, term = _first_term(analysis, values)
    return verdict if term is None else term.verdict(sign(term.coefficient)) or verdict


def first_term(analysis: Analysis) -> FirstTerm | None:
    """The first term of V(x) of the one coordinate that is not known to vanish for all parameters."""
    return None if analysis.parameters_scene.ring.kinked else _first_term(analysis, None)[1]


def _first_term(
    analysis: Analysis, values: Mapping[str, Any] | None
) -> tuple[Callable[[Polynomial], str], FirstTerm | None]:
    scene, balance = analysis.parameters_scene, analysis.balance

    def for_all(x: Polynomial) -> str:
        return knowledge.signs(scene).sign(x)  # told anew: expansions bring numbers with them, as exp(1)

    sign = for_all if values is None else _sign_at(scene.ring, values)
    balance = balance if values is None else balance.at(values)
    return sign, next(first_terms(analysis, balance, sign), None)


def _of_two_sides(analysis: Analysis, values: Mapping[str, Any] | None) -> Verdict | None:
    """Of one coordinate x at rest at 0, of which forces know |x| or sign(x): by the first term of V on either side.

    V rises where it is c x^n with c > 0 for x > 0, or c (-1)^n > 0 for x < 0.  It does not know x': where forces know
    |x'| or sign(x') it is that for x' > 0; what these do to the energy is told of all velocities.
    """
    system = analysis.system
    if len(system.coordinates) != 1 or system.constraints or any(entry.value != ZERO for entry in system.motion):
        return None
    (name,) = system.coordinates
    terms, rises = [], []
    for side in (1, -1):
        beside = on_one_side(system, name, side)
        ahead = on_one_side(beside, velocity_name(name), 1)
        whole, there = (type(analysis)(x, (), analysis.terms, suggests=False) for x in (beside, ahead))
        scene = there.parameters_scene
        sign = knowledge.signs(scene).sign if values is None else _sign_at(scene.ring, values)
        balance = whole.balance if values is None else whole.balance.at(values)
        term = None if scene.ring.kinked else next(first_terms(there, balance, sign), None)
        word = "unknown" if term is None else sign(term.coefficient)
        if term is None or word not in ("positive", "negative"):
            return None
        terms.append(term)
        rises.append((word == "positive") is (side > 0 or term.order % 2 == 0))
    first = max(terms, key=lambda term: term.order)
    if len({(term.damped, term.conserved) for term in terms}) > 1:
        return None
    return first.by(Extremum.MINIMUM if all(rises) else Extremum.NONE)


def _sign_at(ring: Ring, values: Mapping[str, Any]) -> Callable[[Polynomial], str]:
    """The sign at values of all parameters, rational or enclosed: "zero" only where a factor is so exactly."""
    balls = {"pi": arb.pi()} | {name: x if isinstance(x, arb) else rationals.ball(x) for name, x in values.items()}
    numbers = Rationals({}, {})
    rational = {name: rationals.exact(x) for name, x in values.items() if isinstance(x, Fraction)}
    exactly = Carrier(ring, numbers, rational)

    def value(x: Polynomial) -> Any:
        try:
            return arb(exactly(x))
        except NOT_THERE:
            return ring.evaluate(x, balls)

    def sign(x: Polynomial) -> str:
        if ring.is_zero(x) is True:
            return "zero"
        unit, factors = x.factor()
        parts = [arb(unit), *(value(factor) ** int(exponent) for factor, exponent in factors)]
        if any(part.is_zero() for part in parts):
            return "zero"
        if any(part.contains(0) for part in parts):
            return "unknown"
        return "negative" if sum(part < 0 for part in parts) % 2 else "positive"

    return sign


def on_a_leaf(analysis: Analysis) -> bool:
    """Whether velocity constraints keep relations that a disturbance may change."""
    about = analysis.reduced.about
    return about.leaf > 0 or not about.holonomic


def on_manifold(analysis: Analysis) -> Callable[[int], OnManifold]:
    """What constraints leave near a rest, to any order.

    Raises NotExpanded where the motion is none, where constraints know the time or are not known to be integrable, or
    where their rank on the motion is not that near it.
    """
    from mbsym.mechanics.expansion import on_manifold
    from mbsym.problems.normal_forms.expansion import NotExpanded

    system, scene, tied = analysis.system, analysis.parameters_scene, analysis.constraints
    expansion, about = analysis.reduced.expansion, analysis.reduced.about
    at_rest = not expansion.base.turning and all(x.is_zero() for x in expansion.base.rates)
    if not at_rest or _knows_the_time(analysis) or any("t" in names(x) for x in expressions(system)):
        raise NotExpanded(
            "under constraints only rests are expanded, of systems whose equations do not contain the time",
            remedy="problem 6 judges steady motions in first approximation ('mbsym run'), 'mbsym orbit' finds periodic "
            "ones",
        )
    if (
        not (about.holonomic or kept_by_velocities(analysis))
        or len(system.coordinates) - len(expansion.speeds) != tied.velocity_rank
    ):
        raise NotExpanded("the constraints leave no manifold that is known")
    return lambda order: on_manifold(scene, analysis.signs, expansion, order)


def _knows_the_time(analysis: Analysis) -> bool:
    """Whether equations or constraints contain what is prescribed, not its constant rates alone (a turning frame)."""
    ring, tied = analysis.ring, analysis.constraints
    prescribed = [item.name for item in analysis.system.prescribed]
    rows = [*(x.polynomial for x in tied.velocity), *(x for row in tied.jacobian.polynomials for x in row)]
    energies = (analysis.energy.kinetic_energy.polynomial, analysis.energy.force_function.polynomial)
    acting = (*energies, *generalized_forces(analysis.held_scene).values(), *rows)
    return bool(prescribed) and any(ring.dependencies(x, prescribed) for x in acting)


def expanded_with(analysis: Analysis) -> tuple[bool, frozenset[str], Callable[[int], OnManifold] | None]:
    """What ``ignorable`` says, and the manifold that constraints leave; None without constraints."""
    return *ignorable(analysis), on_manifold(analysis) if analysis.system.constraints else None


def _told_by_signs(normal_form: InSymbols, signs: Signs) -> InSymbols:
    """With what may vanish at all for parameters of their signs."""
    from mbsym.problems.normal_forms.result import Vanishing

    region = [
        x.polynomial for x in (normal_form.trace, normal_form.product, normal_form.discriminant)
    ]  # positive: two frequencies
    inside = signs.assuming((x, ">") for x in region)

    def left(formula: Formula, may_vanish: Callable[[Polynomial], bool]) -> Formula:
        product = formula.ring.one
        if formula.is_zero:
            return formula
        for factor, _ in formula.polynomial.factor()[1]:
            if may_vanish(factor):
                product = formula.ring.times(product, factor)
        return Formula(formula.ring, formula.ring.reduce(product))

    def inside_too(factor: Polynomial) -> bool:
        return not inside.never_zero(factor) and not any(map(_zeros_of_terms(factor, signs), region))

    zero = left(normal_form.zero, lambda factor: not signs.never_zero(factor))
    resonances = tuple((vector, left(x, inside_too)) for vector, x in normal_form.resonances)
    return replace(normal_form, vanishing=Vanishing(zero, resonances))


def _zeros_of_terms(p: Polynomial, signs: Signs) -> Callable[[Polynomial], bool]:
    """Whether another polynomial vanishes where p does, as terms of one sign vanish together: a^2 + 8 g^2 = 0."""
    context = p.context()
    terms = [(monomial, context.from_dict({monomial: coefficient})) for monomial, coefficient in p.to_dict().items()]
    alike = any(all(signs.sign(term) in words for _, term in terms) for words in _ONE_SIDED)
    used = [[k for k, exponent in enumerate(monomial) if exponent] for monomial, _ in terms]
    zeros = {k for names in used if len(names) == 1 for k in names} if alike else set[int]()
    at = [context.constant(0) if k in zeros else context.gen(k) for k in range(context.nvars())]
    return lambda x: bool(zeros) and x.compose(*at, ctx=context) == 0


#: Signs of terms that vanish together where their sum does.
_ONE_SIDED = (("nonnegative", "positive"), ("nonpositive", "negative"))


def decided(word: Word) -> Word | None:
    """A verdict that needs nothing more; None for others."""
    return None if word.open or word in (Word.DEPENDS, Word.UNSTABLE_BUT_BORDERS) else word


def ignorable(analysis: Analysis) -> tuple[bool, frozenset[str]]:
    """Whether the applied forces are zero or have a generalized potential; the cyclic coordinates, which neither holds.

    Of conservative systems those on which none acts: there their momenta are constant, too.  Both of the nonlinear
    system: what only terms of high order hold is not overlooked.
    """
    from mbsym.problems.normal_forms.expansion import have_generalized_potential  # few ask for it

    energies = analysis.energy
    applied = generalized_forces(analysis.held_scene)
    ring, names = analysis.ring, analysis.system.coordinates
    running = (*(item.name for item in analysis.system.prescribed), "t")
    conservative = have_generalized_potential(ring, names, applied, running)
    free = [name for name in names if not conservative or ring.vanishes(applied[name])]
    if analysis.system.constraints:  # what constraints tie has no constant momentum of its own
        return conservative, frozenset()
    cyclic = [name for name in free if name in energies.cyclic]
    held = {name for x in applied.values() for name in ring.dependencies(x, cyclic)}
    return conservative, frozenset(cyclic) - held


#: What problem 6 and problem 11 cannot both say of one motion.
_STABLE = ("asymptotically stable", "stable", "formally stable")


def check(analysis: Analysis) -> Check | None:
    """Only where somebody has asked for it: D_4 in symbols against that of enclosures, and problem 6's verdict."""
    normal_form = analysis.optional("normal_forms") if "normal_forms" in analysis.derived else None
    if normal_form is None or normal_form.at_values is None:
        return None
    from mbsym.problems.normal_forms.result import symbols_agree

    routes = ("normal form at the given values", "its formula in parameters, and problem 6")
    word, said = normal_form.first, normal_form.at_values.outcome.value
    if word is not None and ((word is Word.UNSTABLE and said in _STABLE) or (word.stable and said == "unstable")):
        return Check(
            "normal forms",
            *routes,
            FAILED,
            Message("problem 6 says [[value]], terms of higher order [[said]]", value=word.value, said=said),
        )
    values = stability.parameter_values(analysis.parameters_scene, analysis.equilibrium)
    agree = symbols_agree(normal_form, values or {})
    if agree is None:
        return None
    return Check("normal forms", *routes, NUMERICAL if agree else FAILED, "D4 in both" if agree else "D4 differs")
