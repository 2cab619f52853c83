"""Claims: is what somebody printed right?

A claim says "quantity = formula".  The quantity is derived, the formula is read as it was printed, and

    difference = claimed - derived

is decided in the exact ring: the claim holds exactly (the difference is zero), on the relations between parameters,
with the same equations of motion (Lagrangians that differ by dF(q, t)/dt, the kernel of the Euler-Lagrange operator),
or it differs by exactly this.  A difference is split into products of velocities, and where a publication's
abbreviations were declared, those that explain a part are named: a part that *is* an abbreviation, or an abbreviation
that would be right with something added.

What only has to vanish (an equation of motion, a characteristic polynomial) may be multiplied by anything that is not
zero: it holds up to a factor.  Where it does not, it is compared with that multiple of the derived one that agrees with
it in most places, so that the difference is what is wrong:  claimed - factor*derived.  Of every other quantity a factor
is an error, and it differs by the factor.

A first integral I is decided by dI/dt = 0 on the equations of motion; one that fails is told its dI/dt, with q''
replaced by M^-1 f, and a state where this is not zero.  A condition is one that stability in the first approximation
needs, or one of those that problem 6 finds sufficient ('as' may say which: necessary, or sufficient, and then those of
one place are taken together).  It is looked for among the conditions of problem 6; it is refuted by parameters at which
the motion is stable without it, or, as sufficient, unstable with it, both exactly.  A number at a state is compared by
rigorous balls with the digits that were printed: 1.234 means 1.234 +- 0.0005.

Under roots of squares signs matter: sqrt(r**2) is r for r > 0 only.  What holds only for positive coordinates and
parameters (those whose sign is not declared) is said to hold for these.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import product as combinations_of
from typing import Any, Protocol

from flint import arb, ctx, fmpq

from mbsym.algebra.base import Lowering, NoClosedForm, NotRational, SingularPoint
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.expressions.angles import LinearForm, linear_form
from mbsym.expressions.tree import (
    ZERO,
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    add,
    differentiate,
    multiply,
    names,
    subtract,
    text,
    walk,
)
from mbsym.formulas.formula import Formula, Matrix, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.mechanics.oracle import State
from mbsym.mechanics.programs import Programs, accelerated
from mbsym.model.claims import CLAIMS, NECESSARY, SUFFICIENT, SUMS, Claim
from mbsym.model.system import INERTIAL, System, acceleration_name, velocity_name
from mbsym.problems.counterexample import (
    Counterexample,
    Trials,
    against_constancy,
    rate_at_states,
    shown,
)
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import is_conserved, is_proved, rate_on_motion, residual, total_rate
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.knowledge import definition_in_parameters
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability import Stability
from mbsym.problems.stability_theory import (
    ASYMPTOTIC,
    ASYMPTOTIC_BUT_CYCLIC,
    ASYMPTOTIC_BUT_TURNED,
    GYROSCOPIC,
    STABLE,
    STABLE_BUT_CYCLIC,
    UNSTABLE,
)

EXACT = "holds exactly"
RELATIONS = "holds on the relations between the parameters"
FACTOR = "holds up to a factor"
EQUIVALENT = "holds up to a total time derivative"
DIGITS = "holds to the digits printed"
NUMERICAL = "verified numerically"
UNDECIDED = "undecided"
DIFFERS = "differs"
SCALED = "differs by a factor"
FAILS = "does not hold"

#: Working precision of balls, in bits; numbers whose digits cancel are tried again with more of them.
PRECISION = 256
FINER = (PRECISION, 1024, 4096)
#: What is left of a number that is known so well, relatively, is rounding.
ROUNDING = arb(2) ** -60
#: Differences of more products of velocities than this are not taken apart.
MOST_PARTS = 60
#: Multiples of a derived equation that a claimed one is compared with.
MOST_FACTORS = 12
#: Names of undeclared sign under roots for which both signs are tried, and points with each.
MOST_SIGNS, POINTS = 3, 4
#: Verdicts of a motion that is stable; the last is about the first approximation only.
_LINEARLY_STABLE = (
    STABLE,
    ASYMPTOTIC,
    STABLE_BUT_CYCLIC,
    ASYMPTOTIC_BUT_CYCLIC,
    ASYMPTOTIC_BUT_TURNED,
    GYROSCOPIC,
)
_MOTION = ("velocity", "acceleration")


class Derived(Protocol):
    """What a claim may be compared with; each is derived when it is asked for."""

    @property
    def system(self) -> System: ...
    @property
    def ring(self) -> Ring: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def parameters_scene(self) -> Scene: ...
    @property
    def signs(self) -> Signs: ...
    @property
    def programs(self) -> Programs: ...
    @property
    def kinematics(self) -> Kinematics: ...
    @property
    def energy(self) -> Energy: ...
    @property
    def equations(self) -> Equations: ...
    @property
    def equilibrium(self) -> Equilibrium: ...
    @property
    def linearisation(self) -> Linearisation: ...
    @property
    def stability(self) -> Stability: ...
    @property
    def trials(self) -> Trials: ...


@dataclass(frozen=True)
class Part:
    """``factor`` (a combination of products of velocities; 1 without them) times ``difference``.

    For a characteristic polynomial the factor is its variable to the power ``power``.  ``same_as`` is the abbreviation
    that the difference is (with its number: ``-2*c18``); ``repairs`` are abbreviations with which the claim would be
    right if the formula were added to them.
    """

    factor: Formula
    difference: Formula
    power: int | None = None
    same_as: str = ""
    repairs: tuple[tuple[str, Formula], ...] = ()


@dataclass(frozen=True)
class ClaimResult:
    """``outcome`` is one of the words above; ``difference`` is claimed - derived, ``parts`` the same taken apart.

    ``factor`` is claimed / derived where one is a multiple of the other; else, where it is given, the difference is
    claimed - factor*derived.  For a first integral I the difference is dI/dt on the equations of motion instead.
    ``where`` are the signs to which the outcome is restricted, ``counterexample`` numbers that refute the claim.  For
    numbers at a state ``value`` is the derived one, ``digits`` how many of the ``printed_digits`` hold.  ``remark``
    says what else there is to say.
    """

    claim: Claim
    title: str
    outcome: str
    derived: Formula | None = None
    difference: Formula | None = None
    parts: tuple[Part, ...] = ()
    factor: Formula | None = None
    value: str = ""
    digits: int | None = None
    printed_digits: int | None = None
    remark: str = ""
    where: str = ""
    counterexample: Counterexample | None = None

    @property
    def holds(self) -> bool:
        return self.outcome in (EXACT, RELATIONS, FACTOR, EQUIVALENT, DIGITS, NUMERICAL)

    @property
    def refuted(self) -> bool:
        return self.outcome in (DIFFERS, SCALED, FAILS)


def title(claim: Claim, system: System) -> str:
    """What a claim is about: ``mass matrix [theta, delta]``."""
    kind = CLAIMS[claim.kind]
    words = claim.kind
    if claim.kind == "coefficient":
        of = claim.of if claim.of in SUMS else f"the equation of {claim.of}"
        words = f"coefficient of {text(claim.at or ZERO)} in {of}"
    elif claim.of_expression is not None:
        words = f"value of {text(claim.of_expression)}"
    elif claim.of:
        words += f" of {claim.of}"
    if claim.entry:
        words += " [" + ", ".join(str(k) if kind.axes else system.coordinates[k - 1] for k in claim.entry) + "]"
    if claim.right is not None:
        words += f" {text(claim.equals)} {claim.relation} {text(claim.right)}"
    if claim.at_initial:
        words += " at the initial state"
    elif claim.state:
        words += " at " + ", ".join(f"{name} = {text(value)}" for name, value in claim.state)
    return words


def examine(derived: Derived, claim: Claim) -> ClaimResult:
    """One claim against what is derived.

    Raises NoClosedForm, NotRational or SingularPoint (and what ``derived`` raises) where it cannot be decided.
    """
    about = title(claim, derived.system)
    if claim.is_numerical:
        return _at_state(derived, claim, about)
    if claim.right is not None:
        return _condition(derived, claim, about)
    symbols = Symbols(derived.system)
    claimed = symbols.polynomial(derived.parameters_scene, claim)
    if claim.kind == "first integral":
        return _first_integral(derived, claim, about, _in_parameters(derived, claimed))
    return _compared(derived, claim, about, symbols, claimed, _quantity(derived, claim))


def undecided(system: System, claim: Claim, reason: str) -> ClaimResult:
    """A claim about something that could not be derived."""
    return ClaimResult(claim, title(claim, system), UNDECIDED, remark=reason)


# --- symbols ---


class Symbols:
    """The abbreviations of a description, as they stand in claims.

    One that is a linear form in angles (``beta = theta + alpha``) may stand under sin and cos; the others are values.
    """

    def __init__(self, system: System) -> None:
        self.system = system
        self.values = {item.name: item.value for item in system.abbreviations}
        self.forms: dict[str, LinearForm] = {}
        for name, value in self.values.items():
            form = linear_form(value)
            opened = None if form is None else self._opened_form(form)
            if opened is not None:
                self.forms[name] = opened

    def _opened_form(self, form: LinearForm) -> LinearForm | None:
        """A linear form with abbreviations replaced; None where one of them is no linear form."""
        total = LinearForm((), form.turns, form.constant)
        for name, coefficient in form.coefficients:
            if name in self.values and name not in self.forms:
                return None
            total = total + self.forms.get(name, LinearForm(((name, Fraction(1)),))).scaled(coefficient)
        return total

    def opened(self, expression: Expression) -> Expression:
        """The expression with abbreviations under sin, cos and tan replaced by the angles that they are."""
        match expression:
            case Call("sin" | "cos" | "tan" as function, argument):
                form = linear_form(argument)
                opened = None if form is None else self._opened_form(form)
                return Call(function, self.opened(argument) if opened is None else _written(opened))
            case Call(function, argument):
                return Call(function, self.opened(argument))
            case Negative(operand):
                return Negative(self.opened(operand))
            case Operation(operator, left, right):
                return Operation(operator, self.opened(left), self.opened(right))
        return expression

    def arguments(self, claim: Claim) -> Iterator[Expression]:
        """Every angle under sin, cos and tan in a claim and in the abbreviations that it is written in."""
        parts = [part for part in (claim.equals, claim.right, claim.of_expression, claim.at) if part is not None]
        parts += [self.values[name] for name in sorted(self.occurring(parts)) if name in self.values]
        for expression in parts:
            for node in walk(self.opened(expression)):
                if isinstance(node, Call) and node.function in ("sin", "cos", "tan"):
                    yield node.argument

    def occurring(self, expressions: Iterable[Expression]) -> set[str]:
        """The names that occur, those in abbreviations included."""
        found: set[str] = set()
        pending = [name for expression in expressions for name in names(expression)]
        while pending:
            name = pending.pop()
            if name not in found:
                found.add(name)
                pending += names(self.values[name]) if name in self.values else ()
        return found

    def lowering(self, algebra: Any, environment: Mapping[str, Any], wanted: set[str]) -> Lowering:
        """Values for expressions, in an algebra, with those of the wanted abbreviations."""
        known = dict(environment)
        for name, value in self.values.items():
            if name in wanted:
                known[name] = Lowering(algebra, known)(self.opened(value))
        return Lowering(algebra, known)

    def polynomial(self, scene: Scene, claim: Claim) -> Polynomial:
        """What was claimed, in the ring; a characteristic polynomial's variable is the generator of the time."""
        wanted = self.occurring([claim.equals])
        environment = dict(scene.environment)
        if claim.variable:
            if "t" in wanted:
                raise NoClosedForm("a characteristic polynomial does not hold the time")
            environment[claim.variable] = scene.ring.generator("time", "t")
        return self.lowering(scene.ring, environment, wanted)(self.opened(claim.equals))


def _written(form: LinearForm) -> Expression:
    total: Expression = ZERO
    for name, coefficient in form.coefficients:
        total = add(total, multiply(Number(coefficient), Name(name)))
    if form.turns:
        total = add(total, multiply(Number(form.turns), Name("pi")))
    return add(total, Number(form.constant)) if form.constant else total


# --- quantities ---


def _quantity(derived: Derived, claim: Claim) -> Polynomial:
    """What is claimed, derived; over the ring."""
    ring, kind = derived.ring, claim.kind
    rows = [k - 1 for k in claim.entry]
    if kind in SUMS:
        return _sum(derived, kind)
    if kind == "coefficient":
        whole = _sum(derived, claim.of) if claim.of in SUMS else _equation(derived, claim.of)
        return _coefficient(ring, whole, derived.parameters_scene.lower(claim.at or ZERO))
    if kind == "mass matrix":
        return derived.energy.A2[rows[0], rows[1]].polynomial
    if kind == "equation of motion":
        return _equation(derived, claim.of)
    if kind.startswith("linear matrix"):
        return getattr(derived.linearisation, kind[-1])[rows[0], rows[1]].polynomial
    if kind.startswith("subsystem matrix"):
        wanted = [derived.system.coordinates[k] for k in rows]
        for part in derived.linearisation.subsystems:
            if set(wanted) <= set(part.coordinates):
                place = [part.coordinates.index(name) for name in wanted]
                return getattr(part, kind[-1])[place[0], place[1]].polynomial
        return ring.zero
    if kind == "characteristic polynomial":
        return _characteristic(derived, claim.of)
    if kind in ("position", "velocity"):
        return _in_inertial_axes(derived.scene, kind, claim.of)[rows[0]]
    body = derived.kinematics.body(claim.of)
    if kind == "direction cosine":
        return body.rotation[rows[0], rows[1]].polynomial
    spin = body.angular_velocity if kind == "angular velocity" else body.relative_angular_velocity
    return spin[rows[0]].polynomial


def _sum(derived: Derived, kind: str) -> Polynomial:
    kinetic, force = derived.energy.kinetic_energy.polynomial, derived.energy.force_function.polynomial
    return {
        "kinetic energy": kinetic,
        "force function": force,
        "potential energy": -force,
        "lagrangian": derived.ring.reduce(kinetic + force),
    }[kind]


def _equation(derived: Derived, coordinate: str) -> Polynomial:
    """E_i = (M q'' - f)_i."""
    return residual(derived.scene, derived.equations, derived.system.coordinates.index(coordinate))


def _characteristic(derived: Derived, coordinate: str) -> Polynomial:
    """Lambda of one subsystem, or of all of them multiplied; the time stands for lambda."""
    ring = derived.ring
    total = ring.one
    for part in derived.stability.subsystems:
        if not coordinate or coordinate in part.coordinates:
            powers = enumerate(part.characteristic)
            sum_ = ring.zero
            for power, coefficient in powers:
                sum_ = sum_ + coefficient.polynomial * ring.generator("time", "t") ** power
            total = ring.times(total, sum_)
    return ring.reduce(total)


def _in_inertial_axes(scene: Scene, kind: str, body: str) -> tuple[Polynomial, Polynomial, Polynomial]:
    """Radius vector or velocity of the mass centre."""
    motion = scene.motions[body]
    if kind == "position":
        found = scene.position(body, motion.mass_centre, INERTIAL)
    else:
        found = scene.to_axes(motion.velocity_mass_centre, body, INERTIAL)
    return (scene.ring.reduce(found[0]), scene.ring.reduce(found[1]), scene.ring.reduce(found[2]))


def _coefficient(ring: Ring, x: Polynomial, product: Polynomial) -> Polynomial:
    """What stands before exactly this product of velocities and accelerations."""
    wanted = tuple(int(e) for e in product.monomial(0))
    for exponents, coefficient in _by_motion(ring, x):
        if exponents == wanted:
            return coefficient
    return ring.zero


def _by_motion(ring: Ring, x: Polynomial) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """Exponents of velocities and accelerations (those of all others are zero), and what stands before them."""
    yield from _split(ring, x, {k for k, g in enumerate(ring.generators) if g.kind not in _MOTION})


def _split(ring: Ring, x: Polynomial, constant: set[int]) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """x as a polynomial in the other generators: their exponents, and the coefficients in the constant ones."""
    found: dict[tuple[int, ...], dict[tuple[int, ...], Any]] = {}
    for monomial, coefficient in x.terms():
        exponents = [int(e) for e in monomial]
        key = tuple(0 if k in constant else e for k, e in enumerate(exponents))
        rest = tuple(e if k in constant else 0 for k, e in enumerate(exponents))
        found.setdefault(key, {})[rest] = coefficient
    for key, terms in found.items():
        yield key, ring.context.from_dict(terms)


# --- comparison ---


def _in_parameters(derived: Derived, x: Polynomial) -> Polynomial:
    """The description's own symbols replaced by what they stand for."""
    ring, scene = derived.ring, derived.parameters_scene
    degrees = x.degrees()
    images = {}
    for item in derived.system.notation:
        index = ring.index("parameter", item.name)
        if degrees[index] > 0:
            images[index] = definition_in_parameters(scene, item.name)
    return ring.substitute(x, images) if images else ring.reduce(x)


def _on_relations(derived: Derived, claim: Claim, x: Polynomial) -> Polynomial:
    """Relations between parameters used; for the linear problem also the conditions under which the motion exists."""
    ring = derived.ring
    images = relations(derived.parameters_scene)
    if claim.kind.startswith(("linear", "subsystem", "characteristic", "condition")):
        images |= {ring.index("parameter", name): value.polynomial for name, value in derived.equilibrium.solved}
    return ring.substitute(x, images) if images else x


def _compared(
    derived: Derived, claim: Claim, about: str, symbols: Symbols, claimed: Polynomial, truth: Polynomial
) -> ClaimResult:
    ring = derived.ring
    result = ClaimResult(claim, about, EXACT, Formula(ring, truth))
    homogeneous = CLAIMS[claim.kind].homogeneous
    if ring.is_zero(claimed - truth):  # in the description's own symbols, if both are written in them
        return result
    if homogeneous:
        multiple = _multiple(derived, claim, claimed, truth)
        if multiple is not None and multiple.verdict == (EXACT, ""):
            return replace(result, outcome=FACTOR, factor=multiple.factor, remark=multiple.remark)
    own = ring.reduce(claimed - truth)
    claimed, truth = _in_parameters(derived, claimed), _in_parameters(derived, truth)
    difference = ring.reduce(claimed - truth)
    if ring.is_zero(difference):
        return result
    exact = EXACT
    related = _on_relations(derived, claim, difference)
    if related != difference:
        claimed, truth = _on_relations(derived, claim, claimed), _on_relations(derived, claim, truth)
        difference, exact = related, RELATIONS
    outcome, where = _decided(derived, difference)
    if outcome == EXACT:
        return replace(result, outcome=exact, where=where)
    if outcome in (NUMERICAL, UNDECIDED):
        return replace(result, outcome=outcome, where=where, difference=Formula(ring, difference))
    if homogeneous:
        return _up_to_multiple(derived, result, symbols, claimed, truth, min(difference, own, key=len))
    factor = _factor(derived, claimed, truth)
    if factor is not None:
        return replace(result, outcome=SCALED, factor=factor)
    if claim.kind in SUMS and _same_equations(derived, difference):
        remark = "the equations of motion are the same" if _moving(derived, difference) else "it differs by a constant"
        return replace(result, outcome=EQUIVALENT, difference=Formula(ring, difference), remark=remark)
    return _differing(derived, result, symbols, min(difference, own, key=len))


def _differing(derived: Derived, result: ClaimResult, symbols: Symbols, difference: Polynomial) -> ClaimResult:
    """The result with its difference, taken apart."""
    parts = _parts(derived, result.claim, symbols, difference)
    if result.claim.variable:  # the generator of the time stands for the variable: only the parts can be shown
        return replace(result, derived=None, outcome=DIFFERS, parts=parts)
    return replace(result, outcome=DIFFERS, difference=Formula(derived.ring, difference), parts=parts)


# --- signs under roots ---


def _decided(derived: Derived, x: Polynomial) -> tuple[str, str]:
    """Whether x vanishes: EXACT, NUMERICAL, UNDECIDED or DIFFERS; and "for r > 0 ...", if it does for some signs only.

    Roots of squares are opened for each choice of the signs that are not declared.
    """
    ring = derived.ring
    if ring.is_zero(x):
        return EXACT, ""
    numerator, _ = ring.fraction(x)
    degrees = numerator.degrees()
    adjoined = [g for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0]
    if all(g.kind == "root" and g.argument.is_constant() for g in adjoined):
        return DIFFERS, ""
    known, unknown = _signs_under_roots(derived, numerator)
    tried = unknown[:MOST_SIGNS]
    answers = {
        pattern: _decided_for(ring, numerator, known | dict(zip(tried, pattern, strict=True)))
        for pattern in combinations_of((1, -1), repeat=len(tried))
    }
    found, *others = answers.values()
    if found not in (EXACT, NUMERICAL):
        return found, ""
    if all(other in (EXACT, NUMERICAL) for other in others) and tried == unknown:
        return (NUMERICAL if NUMERICAL in answers.values() else EXACT), ""
    return found, _where(unknown, all(other == DIFFERS for other in others) and len(unknown) == 1)


def _where(unknown: Sequence[str], refuted: bool) -> str:
    positive = ", ".join(f"{name} > 0" for name in unknown)
    if refuted:
        return f"for {positive} (it does not for {unknown[0]} < 0)"
    return f"for {positive} (it need not with other signs)"


def _signs_under_roots(derived: Derived, *values: Polynomial) -> tuple[dict[str, int], list[str]]:
    """Declared negative names (with -1), and the names of undeclared sign, under the roots that occur."""
    ring, system = derived.ring, derived.system
    signs = {parameter.name: parameter.sign for parameter in system.parameters}
    under: set[int] = set()
    pending = [(x, False) for x in values]
    seen: set[tuple[int, bool]] = set()
    while pending:
        x, below = pending.pop()
        for k, degree in enumerate(x.degrees()):
            g = ring.generators[k]
            if degree <= 0 or (k, below) in seen:
                continue
            seen.add((k, below))
            if k < ring.spare and g.argument is not None:
                pending.append((g.argument, below or g.kind == "root"))
            elif below and g.kind in ("coordinate", "parameter") and g.name != "pi":
                under.add(k)
    found = [ring.generators[k].name for k in sorted(under)]
    known = {p.name: -1 for p in system.parameters if p.sign in ("negative", "nonpositive")}
    unknown = [name for name in found if signs.get(name) not in ("positive", "nonnegative") and name not in known]
    return known, unknown


def _decided_for(ring: Ring, x: Polynomial, signs: Mapping[str, int]) -> str:
    """Whether x vanishes where the named quantities have these signs, and the others are positive."""
    try:
        opened = _opened_roots(ring, x, signs)
        if ring.is_zero(opened):
            return EXACT
    except (NoClosedForm, SingularPoint):
        opened = x
    source = random.Random(1788)
    keep, ctx.prec = ctx.prec, PRECISION
    finite, narrow = 0, True
    try:
        for _ in range(4 * POINTS):
            values = {name: signs.get(name, 1) * fmpq(source.randint(1, 99), 64) for name in ring.names()}
            value = ring.evaluate(opened, values)
            if not value.is_finite():
                continue
            if not value.contains(0):
                return DIFFERS
            finite, narrow = finite + 1, narrow and value.rad() < ROUNDING
            if finite == POINTS:
                return NUMERICAL if narrow else UNDECIDED
    finally:
        ctx.prec = keep
    return UNDECIDED


def _opened_roots(ring: Ring, x: Polynomial, signs: Mapping[str, int]) -> Polynomial:
    """x with sqrt(r^2 p) = +-r sqrt(p) for every root, r of known sign."""
    images, degrees = {}, x.degrees()
    for k, g in enumerate(ring.generators[: ring.spare]):
        if g.kind != "root" or degrees[k] <= 0 or g.argument.is_constant():
            continue
        content, factors = ring.factored(g.argument)
        outside, inside = ring.one, ring.context.constant(content)
        for factor, exponent in factors:
            name = _plain_name(ring, factor)
            if name in signs:
                outside = ring.times(outside, (factor * signs[name]) ** (exponent // 2))
                exponent %= 2
            inside = ring.times(inside, factor**exponent)
        if not outside.is_one():
            images[k] = ring.times(outside, ring.square_root(inside))
    return ring.substitute(x, images) if images else x


def _plain_name(ring: Ring, x: Polynomial) -> str:
    """The name of a coordinate or parameter that x is a multiple of, or ""."""
    if len(x) != 1 or sum(map(int, x.monomial(0))) != 1:
        return ""
    g = ring.generators[[int(e) for e in x.monomial(0)].index(1)]
    return g.name if g.kind in ("coordinate", "parameter") else ""


def _moving(derived: Derived, x: Polynomial) -> bool:
    """Whether x depends on the state or the time."""
    ring = derived.ring
    degrees = x.degrees()
    if any(degrees[k] > 0 for k, g in enumerate(ring.generators) if g.kind in _MOTION):
        return True
    prescribed = (item.name for item in derived.system.prescribed)
    return bool(ring.dependencies(x, [*derived.system.coordinates, *derived.system.velocities, *prescribed, "t"]))


@dataclass(frozen=True)
class _Multiple:
    """``difference`` = claimed - factor*derived, whether it vanishes, and where the factor makes no sense."""

    factor: Formula
    difference: Polynomial
    verdict: tuple[str, str]
    remark: str


def _up_to_multiple(
    derived: Derived, result: ClaimResult, symbols: Symbols, claimed: Polynomial, truth: Polynomial, own: Polynomial
) -> ClaimResult:
    """What has only to vanish, against the multiple of the derived one that comes closest; ``own`` is for 1 times."""
    multiple = _multiple(derived, result.claim, claimed, truth)
    if multiple is None:
        return _differing(derived, result, symbols, own)
    found = replace(result, factor=multiple.factor, remark=multiple.remark)
    outcome, where = multiple.verdict
    if outcome == EXACT:
        return replace(found, outcome=FACTOR, where=where)
    if outcome in (NUMERICAL, UNDECIDED):
        difference = Formula(derived.ring, multiple.difference)
        return replace(found, outcome=outcome, where=where, difference=difference)
    return _differing(derived, replace(found, remark=""), symbols, multiple.difference)


def _multiple(derived: Derived, claim: Claim, claimed: Polynomial, truth: Polynomial) -> _Multiple | None:
    """claimed - factor*derived in the fewest products of velocities (powers of the variable).

    The candidates are 1 and the quotients of coefficients: of the coordinate's own acceleration (of the highest power)
    first, then of the others; the first of the best is taken.  For an equation the quotient of the whole is another, if
    there is one without accelerations.  None where 1 does best, or everything is too long.
    """
    ring = derived.ring
    if claimed.is_zero() or truth.is_zero():
        return None
    above, below = _over_common_denominator(ring, claimed, truth)
    first, second = dict(_places(ring, claim, above)), dict(_places(ring, claim, below))
    keys = sorted(first.keys() & second.keys(), key=partial(_importance, ring, claim))
    best: tuple[int, tuple[Polynomial, Polynomial], Polynomial] | None = None
    candidates = [(ring.one, ring.one), *((first[key], second[key]) for key in keys[:MOST_FACTORS])]
    if not claim.variable:
        candidates.append((above, below))
    for top, bottom in candidates:
        try:
            common = ring.common_factor(top, bottom)
            shorter = ring.quotient(top, common), ring.quotient(bottom, common)
            if any(x is None or _accelerations(ring, x) for x in shorter):
                continue
            left = ring.reduce(ring.times(above, shorter[1]) - ring.times(below, shorter[0]))
        except NoClosedForm:
            continue
        cost = 0 if ring.is_zero(left) else len(list(_places(ring, claim, left)))
        if best is None or cost < best[0]:
            best = (cost, (shorter[0], shorter[1]), left)
        if not cost:
            break
    if best is None or best[1][0] == best[1][1]:
        return None
    (top, bottom), left = best[1:]
    try:
        factor = ring.reduce(ring.times(top, ring.reciprocal(bottom)))
        difference = ring.reduce(claimed - ring.times(truth, factor))
    except (NoClosedForm, SingularPoint):
        return None
    return _Multiple(Formula(ring, factor), difference, _decided(derived, left), _exceptions(derived, top, bottom))


def _accelerations(ring: Ring, x: Polynomial) -> bool:
    degrees = x.degrees()
    return any(degrees[k] > 0 for k, g in enumerate(ring.generators) if g.kind == "acceleration")


def _over_common_denominator(ring: Ring, first: Polynomial, second: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Both times their denominators."""
    above, denominators = ring.fraction(first)
    below, others = ring.fraction(second)
    for factor, exponent in others:
        above = ring.times(above, ring.power(factor, exponent))
    for factor, exponent in denominators:
        below = ring.times(below, ring.power(factor, exponent))
    return above, below


def _places(ring: Ring, claim: Claim, x: Polynomial) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """x by products of velocities and accelerations; a characteristic polynomial by powers of its variable."""
    if not claim.variable:
        return _by_motion(ring, x)
    time = ring.index("time", "t")
    return _split(ring, x, set(range(len(ring.generators))) - {time})


def _importance(ring: Ring, claim: Claim, place: tuple[int, ...]) -> tuple[bool, bool, int, tuple[int, ...]]:
    """Sorts the coordinate's own acceleration first, then other accelerations, then high powers."""
    kinds = [ring.generators[k] for k, exponent in enumerate(place) if exponent]
    own = any(g.kind == "acceleration" and g.name == claim.of for g in kinds)
    accelerated_ = any(g.kind == "acceleration" for g in kinds)
    return not own, not accelerated_, -sum(place), place


def _exceptions(derived: Derived, top: Polynomial, bottom: Polynomial) -> str:
    """ "where r and cos(theta) are not 0": what of top and bottom is not known to be different from zero."""
    ring = derived.ring
    doubtful: list[str] = []
    for x in (top, bottom):
        try:
            factors = [] if x.is_constant() else ring.factored(x)[1]
        except NoClosedForm:
            return "where the factor is neither 0 nor infinite"
        for factor, _ in factors:
            if derived.signs.sign(factor) not in ("positive", "negative", "nonzero"):
                doubtful.append(str(Formula(ring, factor)))
    if not doubtful:
        return ""
    names_of = list(dict.fromkeys(doubtful))
    return f"where {' and '.join(names_of)} {'is' if len(names_of) == 1 else 'are'} not 0"


def _factor(derived: Derived, claimed: Polynomial, truth: Polynomial) -> Formula | None:
    """claimed / derived, if that is a product of powers of parameters.

    Both are split into what varies with the state and what stands before it; then one of these quotients is the factor.
    """
    ring = derived.ring
    if claimed.is_zero() or truth.is_zero():
        return None
    above, below = _over_common_denominator(ring, claimed, truth)
    constant = {k for k in range(len(ring.generators)) if not _moving(derived, ring.context.gen(k))}
    first, second = dict(_split(ring, above, constant)), dict(_split(ring, below, constant))
    if first.keys() != second.keys():
        return None
    key = min(second, key=lambda one: len(first[one]) + len(second[one]))
    common = ring.common_factor(first[key], second[key])
    top, bottom = ring.quotient(first[key], common), ring.quotient(second[key], common)
    if top is None or bottom is None or len(top) > 1 or len(bottom) > 1:
        return None
    if not ring.is_zero(ring.times(claimed, bottom) - ring.times(truth, top)):
        return None
    return Formula(ring, ring.reduce(ring.times(top, ring.reciprocal(bottom))))


def _same_equations(derived: Derived, difference: Polynomial) -> bool:
    """Whether d/dt dD/dq'_i - dD/dq_i vanishes identically for every coordinate: D = dF(q, t)/dt."""
    ring, scene = derived.ring, derived.parameters_scene
    for name in derived.system.coordinates:
        momentum = ring.velocity_derivative(difference, name)
        if ring.is_zero(total_rate(scene, momentum) - ring.derivative(difference, name)) is not True:
            return False
    return True


# --- what differs ---


def _parts(derived: Derived, claim: Claim, symbols: Symbols, difference: Polynomial) -> tuple[Part, ...]:
    """The difference by products of velocities (a characteristic polynomial by powers), equal ones together."""
    ring = derived.ring
    if claim.variable:
        return tuple(_by_power(ring, difference))
    split = list(_by_motion(ring, difference))
    if len(split) > MOST_PARTS:
        return ()
    values = _values(derived, symbols, [claim.equals])
    groups: list[tuple[Polynomial, Polynomial]] = []  # (combination of products, difference)
    for exponents, coefficient in split:
        product = ring.context.from_dict({exponents: fmpq(1)})
        for place, (combined, known) in enumerate(groups):
            ratio = _ratio(coefficient, known)
            if ratio is not None:
                groups[place] = (combined + product * ratio, known)
                break
        else:
            groups.append((product, coefficient))
    slopes = _slopes(derived, claim, symbols)
    found = []
    for combined, coefficient in groups:
        same = _same_as(coefficient, values)
        repairs = () if same else _repairs(ring, combined, coefficient, slopes, values)
        found.append(Part(Formula(ring, combined), Formula(ring, coefficient), None, same, repairs))
    return tuple(found)


def _by_power(ring: Ring, x: Polynomial) -> Iterator[Part]:
    """Powers of the variable of a characteristic polynomial, which the generator of the time stands for."""
    index = ring.index("time", "t")
    found: dict[int, dict[tuple[int, ...], Any]] = {}
    for monomial, coefficient in x.terms():
        exponents = [int(e) for e in monomial]
        power, exponents[index] = exponents[index], 0
        found.setdefault(power, {})[tuple(exponents)] = coefficient
    for power in sorted(found, reverse=True):
        yield Part(Formula(ring, ring.one), Formula(ring, ring.context.from_dict(found[power])), power)


def _values(derived: Derived, symbols: Symbols, expressions: list[Expression]) -> dict[str, Polynomial]:
    """The abbreviations that occur, as polynomials in declared parameters."""
    scene = derived.parameters_scene
    wanted = symbols.occurring(expressions)
    lower = symbols.lowering(scene.ring, scene.environment, wanted)
    return {name: _in_parameters(derived, lower(Name(name))) for name in symbols.values if name in wanted}


def _same_as(coefficient: Polynomial, values: Mapping[str, Polynomial]) -> str:
    """``c18`` or ``-2*c18``, if the coefficient is a rational multiple of an abbreviation."""
    for name, value in values.items():
        ratio = None if value.is_constant() else _ratio(coefficient, value)
        if ratio is not None:
            sign = "-" if ratio < 0 else ""
            return sign + (name if abs(ratio) == 1 else f"{abs(ratio)}*{name}")
    return ""


def _ratio(x: Polynomial, y: Polynomial) -> Any:
    """x / y where that is a rational number, else None."""
    if len(x) != len(y) or x.is_zero() or x.monomial(0) != y.monomial(0):
        return None
    ratio = x.coefficient(0) / y.coefficient(0)
    return ratio if x == y * ratio else None


def _slopes(derived: Derived, claim: Claim, symbols: Symbols) -> dict[str, Polynomial]:
    """What stands before each abbreviation in the claim, for those that enter it linearly."""
    scene = derived.parameters_scene
    found = {}
    for name in symbols.values:
        if name not in names(claim.equals):
            continue
        slope = differentiate(claim.equals, name)
        if name in names(slope):
            continue
        wanted = symbols.occurring([slope])
        lower = symbols.lowering(scene.ring, scene.environment, wanted)
        found[name] = _in_parameters(derived, lower(symbols.opened(slope)))
    return found


def _repairs(
    ring: Ring,
    combined: Polynomial,
    coefficient: Polynomial,
    slopes: Mapping[str, Polynomial],
    values: Mapping[str, Polynomial],
) -> tuple[tuple[str, Formula], ...]:
    """Abbreviations that stand before just this combination: with -difference added the claim would be right.

    Where some of them are made of the parameters of the difference, the others are not named.
    """
    found, likely = [], []
    needed = _parameters(ring, coefficient)
    for name, slope in slopes.items():
        ratio = _ratio(combined, slope)
        if ratio is not None:
            found.append((name, Formula(ring, ring.reduce(-coefficient * ratio))))
            if needed <= _parameters(ring, values[name]):
                likely.append(found[-1])
    return tuple(likely or found)


def _parameters(ring: Ring, x: Polynomial) -> set[int]:
    degrees = x.degrees()
    return {k for k, g in enumerate(ring.generators) if g.kind == "parameter" and degrees[k] > 0}


# --- first integrals ---


def _first_integral(derived: Derived, claim: Claim, about: str, claimed: Polynomial) -> ClaimResult:
    """dI/dt = 0 on the equations of motion, as they stand or with the relations between parameters used."""
    scene, ring, equations = derived.scene, derived.ring, derived.equations
    result = ClaimResult(claim, about, EXACT, Formula(ring, claimed))
    if not ring.dependencies(claimed, derived.system.velocities):
        return replace(result, outcome=FAILS, remark="it contains no velocity")
    outcome = EXACT
    for outcome in (EXACT, RELATIONS):
        if outcome == RELATIONS:
            images = relations(derived.parameters_scene)
            if not images:
                break
            claimed = ring.substitute(claimed, images)
            equations = _substituted(ring, equations, images)
        if is_conserved(scene, equations, claimed):
            if is_proved(scene, equations, claimed):
                return replace(result, outcome=outcome)
            found, where = _conserved_where(derived, equations, claimed)
            return replace(result, outcome=outcome if found == EXACT else NUMERICAL, where=where)
    rate = total_rate(scene, claimed)
    difference = _rate_of(derived, equations, claimed)
    if difference is None:
        parts = [rate, *(x.polynomial for row in equations.mass_matrix for x in row)]
        parts += [x.polynomial for x in equations.forcing]
    else:
        parts = [difference.polynomial]
    used = _names_in(derived, parts)
    timely = ["t", *(item.name for item in derived.system.prescribed)]
    if any(ring.dependencies(x, timely) for x in parts):
        used.add("t")
    example = against_constancy(derived.system, ring, derived.programs, rate, used)
    remark = "" if difference is not None else "dI/dt does not vanish on the equations of motion"
    return replace(result, outcome=FAILS, difference=difference, remark=remark, counterexample=example)


def _conserved_where(derived: Derived, equations: Equations, claimed: Polynomial) -> tuple[str, str]:
    """What became of dI/dt = 0 for the signs that are not declared: EXACT or NUMERICAL, and where."""
    scene, ring = derived.scene, derived.ring
    found = rate_on_motion(scene, equations, claimed)
    if found is not None:
        outcome, where = _decided(derived, found[0])
        if outcome in (EXACT, NUMERICAL):
            return outcome, where
    rate = total_rate(scene, claimed)
    parts = [rate, *(x.polynomial for row in equations.mass_matrix for x in row)]
    _, unknown = _signs_under_roots(derived, *parts, *(x.polynomial for x in equations.forcing))
    for pattern in combinations_of((1, -1), repeat=min(len(unknown), MOST_SIGNS)):
        negative = [name for name, sign in zip(unknown, pattern, strict=False) if sign < 0]
        states = rate_at_states(derived.system, ring, derived.programs, rate, negative)
        if negative and any(not value.contains(0) for _, value in states):
            return NUMERICAL, _where(unknown, len(unknown) == 1)
    return NUMERICAL, "" if len(unknown) <= MOST_SIGNS else _where(unknown, False)


def _rate_of(derived: Derived, equations: Equations, claimed: Polynomial) -> Formula | None:
    """dI/dt on the equations of motion in lowest terms; None where that is too long."""
    ring = derived.ring
    try:
        found = rate_on_motion(derived.scene, equations, claimed)
        if found is None:
            return None
        common = ring.common_factor(*found)
        top, bottom = ring.quotient(found[0], common), ring.quotient(found[1], common)
        if top is None or bottom is None:
            top, bottom = found
        return Formula(ring, ring.reduce(ring.times(top, ring.reciprocal(bottom))))
    except (NoClosedForm, SingularPoint):
        return None


def _names_in(derived: Derived, values: Iterable[Polynomial]) -> set[str]:
    """Coordinates, velocities and parameters in the values, those that relations and notation are made of included."""
    ring, system = derived.ring, derived.system
    wanted = [*system.coordinates, *system.velocities]
    found: set[str] = set()
    for x in values:
        found |= set(ring.dependencies(x, wanted))
        found |= {g.name for k, g in enumerate(ring.generators) if g.kind == "parameter" and _holds(ring, x, k)}
    made_of = {item.name: names(item.value) for item in system.relations}
    made_of |= {item.name: names(item.value) for item in system.notation}
    pending = list(found)
    while pending:
        new = made_of.get(pending.pop(), set()) - found
        found |= new
        pending += new
    return found


def _holds(ring: Ring, x: Polynomial, index: int) -> bool:
    """Whether a generator occurs in x, in what its reciprocals, roots and functions are made of included."""
    degrees = x.degrees()
    if degrees[index] > 0:
        return True
    inner = (g.argument for k, g in enumerate(ring.generators[: ring.spare]) if degrees[k] > 0)
    return any(argument is not None and _holds(ring, argument, index) for argument in inner)


def _substituted(ring: Ring, equations: Equations, images: Mapping[int, Polynomial]) -> Equations:
    def moved(x: Formula) -> Polynomial:
        return ring.substitute(x.polynomial, images)

    return replace(
        equations,
        mass_matrix=Matrix.of(ring, [[moved(x) for x in row] for row in equations.mass_matrix]),
        forcing=column(ring, [moved(x) for x in equations.forcing]),
    )


# --- conditions ---


def _condition(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """Looks for the inequality among those of problem 6, factors of known sign apart, then for a counterexample.

    Sufficient conditions of one place may be refuted together even where each is one of those of problem 6.
    """
    ring, scene = derived.ring, derived.parameters_scene
    symbols = Symbols(derived.system)
    assert claim.right is not None
    sides = [claim.equals, claim.right]
    lower = symbols.lowering(ring, scene.environment, symbols.occurring(sides))
    left, right = (lower(symbols.opened(side)) for side in sides)
    strict = claim.relation in ("<", ">", "!=")
    if claim.relation in ("<", "<="):
        left, right = right, left
    result = ClaimResult(claim, about, EXACT)
    if claim.role == SUFFICIENT:
        refuted = _contradicted(derived, claim, result)
        if refuted is not None:
            return refuted
    for own in (True, False):  # in the description's own symbols, then in declared parameters
        try:
            wanted = _essential(derived, claim, left - right, own)
            known = list(_conditions(derived, claim, own))
            for same in (_proportional, partial(_same_condition, derived.signs)):
                for what, found, relation in known:
                    if same(wanted, found, relation == "!="):
                        equal = strict == (relation in ("<", ">", "!="))
                        note = what + ("" if equal else ", but for the case of equality")
                        if claim.role == SUFFICIENT:
                            note += "; no parameters that were tried refute that those of its place are sufficient"
                        return replace(result, remark=note)
            kind = "" if claim.relation == "!=" else derived.signs.condition(wanted).kind
        except NoClosedForm:
            if own:
                raise
            break
        if kind == "always" and claim.role != SUFFICIENT:
            return replace(result, remark="it follows from the declared signs and assumptions")
        if kind == "never":
            return replace(result, outcome=FAILS, remark="with the declared signs and assumptions it never holds")
    refuted = None if claim.role == SUFFICIENT else _contradicted(derived, claim, result)
    if refuted is not None:
        return refuted
    remark = "it is not one of the conditions of problem 6 as they stand there; no parameters that were tried refute it"
    return replace(result, outcome=UNDECIDED, remark=remark)


def _contradicted(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """The claim refuted by parameters: stable without it, or (where it is to be sufficient) unstable with it."""
    sufficient = claim.role == SUFFICIENT
    together = [claim]
    if sufficient and claim.place:
        shared = (claim.kind, claim.role, claim.place)
        together = [one for one in derived.system.claims if (one.kind, one.role, one.place) == shared]
    trials = derived.trials
    if len(together) > 1 and claim.place in trials.known:
        found = trials.known[claim.place]
    else:
        found = _counterexample(derived, together, sufficient)
        if len(together) > 1:
            trials.known[claim.place] = found
    if found is None:
        return None
    if sufficient:
        subject = "it is" if len(together) == 1 else "the conditions of this place together are"
        remark = f"{subject} not sufficient for stability"
    else:
        in_first = dict(found.shows)["the motion"] == GYROSCOPIC
        remark = "it is not necessary for stability" + (" in the first approximation" if in_first else "")
    return replace(result, outcome=FAILS, remark=remark, counterexample=found)


def _counterexample(derived: Derived, together: Sequence[Claim], sufficient: bool) -> Counterexample | None:
    """Parameters that refute these conditions; None where none are found, or the formulas are too long."""
    symbols = Symbols(derived.system)
    environment = derived.parameters_scene.environment

    def claimed(numbers: Any, values: Mapping[str, Any]) -> list[tuple[str, Any, str]]:
        found = []
        for one in together:
            assert one.right is not None
            sides = [one.equals, one.right]
            lower = symbols.lowering(numbers, values, symbols.occurring(sides))
            left, right = (lower(symbols.opened(side)) for side in sides)
            found.append((text(subtract(one.equals, one.right)), left - right, one.relation))
        return found

    try:
        claimed(derived.ring, environment)  # its budgets end what would be too long as numbers, too
        return derived.trials.counterexample(claimed, sufficient, (UNSTABLE,) if sufficient else _LINEARLY_STABLE)
    except NoClosedForm:
        return None


def _conditions(derived: Derived, claim: Claim, own: bool) -> Iterator[tuple[str, Polynomial, str]]:
    """What a condition of problem 6 is called, the polynomial that has to be positive (or not zero), the relation."""
    for part in derived.stability.subsystems:
        whose = ", ".join(part.coordinates)
        sufficient = () if claim.role == NECESSARY else part.sufficient
        for found, note in (
            ((*part.conditions, *part.unreduced, *sufficient), ""),
            (part.guaranteed, ": it holds, the kinetic energy is positive definite"),
        ):
            for label, formula, relation in found:
                sign = -1 if relation in ("<", "<=") else 1
                polynomial = _essential(derived, claim, formula.polynomial * sign, own)
                yield f"it is the condition {label} of {whose}{note}", polynomial, relation


def _essential(derived: Derived, claim: Claim, x: Polynomial, own: bool) -> Polynomial:
    """x in its ``own`` symbols, or in declared parameters with relations used; denominators cleared by their signs."""
    ring = derived.ring
    whole = x if own else _on_relations(derived, claim, _in_parameters(derived, x))
    numerator, denominators = ring.fraction(whole)
    for factor, exponent in denominators:
        if exponent % 2 and derived.signs.sign(factor) != "positive":
            numerator = ring.times(numerator, factor)
    return numerator


def _proportional(first: Polynomial, second: Polynomial, unequal: bool) -> bool:
    ratio = _ratio(first, second)
    return ratio is not None and (unequal or ratio > 0)


def _same_condition(signs: Signs, first: Polynomial, second: Polynomial, unequal: bool) -> bool:
    """Whether two polynomials are positive together (nonzero together) for all parameters."""
    decide = signs.nonzero_condition if unequal else signs.condition
    one, other = decide(first), decide(second)
    if one.kind != other.kind or one.kind not in ("inequality", "nonzero"):
        return False
    return one.polynomial == other.polynomial and sorted(map(str, one.nonzero)) == sorted(map(str, other.nonzero))


# --- numbers at a state ---


def _at_state(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """The derived value as a ball against the number that was printed, to its digits.

    A ball too wide to tell is computed again in more bits; where the most of them do not tell, nothing is decided.
    """
    keep = ctx.prec
    try:
        for ctx.prec in FINER:
            result = _at_precision(derived, claim, about, last=ctx.prec == FINER[-1])
            if result is not None:
                return result
    finally:
        ctx.prec = keep
    return ClaimResult(claim, about, UNDECIDED, remark=f"too many digits cancel, even of {FINER[-1]} bits")


def _at_precision(derived: Derived, claim: Claim, about: str, last: bool) -> ClaimResult | None:
    """The verdict in the working precision, None where balls are too wide for one."""
    state = _state(derived.system, claim)
    symbols = Symbols(derived.system)
    try:
        printed = _number(symbols, state, claim.equals)
        if claim.of_expression is not None:
            value = _value(derived, symbols, state, claim.of_expression)
        else:
            value = Carrier(derived.ring, state.numbers, state.values)(_quantity(derived, claim))
    except KeyError as missing:
        raise NotRational(f"no number is given for {missing.args[0]}") from None
    for what, number in (("the value", value), ("the claimed value", printed)):
        if not number.is_finite():
            return ClaimResult(claim, about, UNDECIDED, remark=f"{what} is not finite") if last else None
    result = ClaimResult(claim, about, DIGITS, value=shown(value))
    error = abs(printed - value)
    if not claim.printed:
        if not error.contains(0):
            return replace(result, outcome=DIFFERS)
        # Where the value itself cannot be told from zero, there is nothing that it could be compared with.
        size = 1 + abs(value) if last else value.abs_lower()
        return replace(result, outcome=NUMERICAL) if error.rad() <= ROUNDING * size else None
    digits, unit = _printed(claim.printed)
    tolerance = arb(unit) / 2
    if error < tolerance or ((error - tolerance).contains(0) and error.rad() < ROUNDING * tolerance):
        return replace(result, printed_digits=digits, digits=digits)
    if not error > tolerance:
        return None
    return replace(result, outcome=DIFFERS, printed_digits=digits, digits=_agreeing(error, value, digits))


def _state(system: System, claim: Claim) -> State:
    """Numbers for parameters ('values', relations), and the initial state or the claim's own numbers, else zero."""
    values: dict[str, Any] = {"pi": arb.pi(), "t": arb(0)}
    for name in system.coordinates:
        values |= {name: arb(0), velocity_name(name): arb(0)}
    numbers = Balls(values)
    given = dict(claim.state)

    def lower(expression: Expression) -> Any:
        return Lowering(numbers, values)(expression)

    for parameter in system.parameters:
        chosen = given.get(parameter.name, parameter.value)
        if chosen is not None:
            values[parameter.name] = lower(chosen)
    pending = [item for item in system.relations if item.name not in values]
    while ready := [item for item in pending if names(item.value) <= values.keys()]:
        for item in ready:
            values[item.name] = lower(item.value)
        pending = [item for item in pending if item.name not in values]
    for moved in system.prescribed:
        if moved.initial is None or names(moved.initial) <= values.keys():
            start = arb(0) if moved.initial is None else lower(moved.initial)
            values[moved.name] = start
    for state in system.initial if claim.at_initial else ():
        for name, chosen in ((state.coordinate, state.position), (velocity_name(state.coordinate), state.velocity)):
            if chosen is not None and names(chosen) <= values.keys():
                values[name] = lower(chosen)
    for symbol in system.notation:
        if names(symbol.value) <= values.keys():
            values[symbol.name] = lower(symbol.value)
    for name, chosen in given.items():
        values[name] = lower(chosen)
    return State(numbers, values)


def _number(symbols: Symbols, state: State, expression: Expression) -> Any:
    wanted = symbols.occurring([expression])
    return symbols.lowering(state.numbers, state.values, wanted)(symbols.opened(expression))


def _value(derived: Derived, symbols: Symbols, state: State, expression: Expression) -> Any:
    """An expression at the state, its accelerations from the equations of motion."""
    wanted = symbols.occurring([expression])
    if any(acceleration_name(name) in wanted for name in derived.system.coordinates):
        state = accelerated(derived.system, state, derived.programs)
    return _number(symbols, state, expression)


def _printed(number: str) -> tuple[int, fmpq]:
    """Significant digits of a decimal number, and one unit of its last place."""
    mantissa, _, exponent = number.lower().lstrip("+-").partition("e")
    whole, _, decimals = mantissa.partition(".")
    digits = len((whole + decimals).lstrip("0")) or 1
    return digits, fmpq(10) ** (int(exponent or 0) - len(decimals))


def _agreeing(error: Any, value: Any, digits: int) -> int:
    """How many leading digits of the printed number are right, rounding allowed for."""
    if value.contains(0):
        return 0
    leading = (abs(value).mid().log() / arb(10).log()).floor().mid()  # the power of ten of the first digit
    right = 0
    while right < digits and 2 * error < arb(10) ** (leading - right):
        right += 1
    return right
