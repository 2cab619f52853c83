"""A number for everything that a simulation needs: parameters, initial positions and velocities.

Numbers are exact fractions; what is irrational (pi/6, sqrt(2)) is rounded to ``PRECISION`` bits, far below any
arithmetic that is used later.  Nothing is made up: what has no value is listed by name, all at once.  Only one thing
may be left out: a coordinate whose initial position is given and whose velocity is not starts at rest.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from flint import arb, ctx

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import Failure, NotRational, NoValue, SingularPoint, message_of
from mbsym.algebra.point import Balls, Rationals
from mbsym.algebra.program import MOST_BITS, Node, Program
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.message import Message, worded
from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.expressions.tree import text as spelled
from mbsym.mechanics.given_matrices import refuse_matrices
from mbsym.model.assumptions import broken, has_sign
from mbsym.model.inputs import Input
from mbsym.model.substitution import driven, folded, images_of_laws, lacking_law, speeds_in_coordinates, with_images
from mbsym.model.system import InitialValue, System, overruled, velocity_name

#: Irrational values are rounded to so many bits.
PRECISION = 256

#: Beyond 2**LARGEST_EXPONENT, and closer to zero than its reciprocal, double precision ends.
LARGEST_EXPONENT = 1000

#: Two numbers for one parameter contradict each other if they differ by more than this, relatively.
AGREEMENT = Fraction(1, 10**12)


@dataclass(frozen=True)
class Contradiction:
    """A value that cannot be: a short stable ``code``, the ``name`` that has it, a sentence, and perhaps a way out."""

    code: str
    name: str
    text: str
    hint: str | None = None


@dataclass(frozen=True)
class Lack:
    """``names`` have no value; ``contradictions`` are values that cannot be."""

    names: tuple[str, ...] = ()
    contradictions: tuple[Contradiction, ...] = ()


class Incomplete(Exception):
    """Raised with everything that keeps a scenario from being complete; ``lack`` lists it."""

    def __init__(self, lack: Lack) -> None:
        parts = []
        if lack.names:
            parts.append("no value for " + ", ".join(lack.names))
        super().__init__("; ".join([*parts, *(contradiction.text for contradiction in lack.contradictions)]))
        self.lack = lack


@dataclass(frozen=True)
class Driven:
    """What an input is in a scenario; ``asked``: somebody said so, else it is held as on the unperturbed motion.

    ``law`` is as it was written, ``in_coordinates`` has coordinates and velocities in place of speeds and unit vectors.
    """

    name: str
    law: Expression
    asked: bool
    in_coordinates: Expression


@dataclass(frozen=True)
class Scenario:
    """A system with numbers: ``positions`` and ``velocities`` in the order of ``system.coordinates`` at t = 0.

    ``prescribed`` gives (initial, rate) of every prescribed quantity; ``typed`` keeps the initial positions as they
    were written (pi/2 is exact there).  The system has no inputs any more: ``inputs`` are what they have become.
    ``unstated`` are the velocities that were left out, and are zero where no constraint says otherwise.
    ``declared`` is the initial state in positions and speeds where it is given in these; where the angles are
    ``singular`` in it no generalised velocities belong to it, and a run in coordinates cannot begin there.
    """

    system: System
    parameters: Mapping[str, Fraction]
    positions: tuple[Fraction, ...]
    velocities: tuple[Fraction, ...]
    prescribed: Mapping[str, tuple[Fraction, Fraction]]
    typed: Mapping[str, Expression] = field(default_factory=dict)
    inputs: tuple[Driven, ...] = ()
    unstated: tuple[str, ...] = ()
    declared: tuple[Fraction, ...] = ()
    singular: bool = False

    @property
    def state(self) -> tuple[Fraction, ...]:
        """(q, q') at t = 0."""
        return (*self.positions, *self.velocities)


def scenario(
    system: System,
    overrides: Mapping[str, Expression] | None = None,
    state: bool = True,
    assumed: bool = True,
    laws: Mapping[str, Expression] | None = None,
    declared: bool = False,
) -> Scenario:
    """The numbers of a description, some of them replaced.

    ``overrides`` maps names of parameters, coordinates (initial position) and ``<name>_dot`` (initial velocity) to
    expressions without coordinates.  Parameters without a value take it from ``relations``.  With ``state`` false the
    initial state may be missing (it is then zero).  With ``assumed`` false values may break assumptions, on which no
    number depends.  ``laws`` gives inputs their expressions; the others keep their values on the unperturbed motion.
    An initial state in declared variables may be singular in coordinates only where a run in ``declared`` ones begins.
    Raises Incomplete, naming everything that is missing, and GivenByMatrices where nothing moves but a linear form.
    """
    refuse_matrices(system, "no motion is integrated")
    overrides = dict(overrides or {})
    images = images_of_laws(system, laws or {})
    given_laws = {name: folded(law, images) for name, law in (laws or {}).items()}
    given_laws |= {item.name: images[item.name] for item in system.given if item.name in images}
    functions = tuple(Input(item.name, item.meaning, images.get(item.name, ZERO)) for item in system.given)
    system = with_images(system, images)
    inputs = (*system.inputs, *functions)
    system = driven(system, given_laws)
    numbers = _Numbers()
    for item in system.given:
        text, hint = lacking_law(item.name)
        numbers.contradictions.append(Contradiction("no-law", item.name, text, hint))
    system = replace(system, given=(), prescribed=system.of_constant_rate) if system.given else system
    _parameters(system, overrides, numbers, assumed)
    parameters = numbers.known
    missing = [name for name in system.parameter_names if name not in parameters and name not in numbers.refused]
    own = own_values(system, overrides)
    if own and state:
        return _with_own(system, own, overrides, numbers, missing, given_laws, inputs, declared)
    for name in own if not state else ():
        if name in overrides:
            text = Message("'[[name]]' is a declared variable, and positions are taken in coordinates here", name=name)
            numbers.contradictions.append(Contradiction("misplaced-name", name, text))
    values = initial_values(system, overrides)
    positions, velocities = [], []
    for name in system.coordinates:
        entry = values[name]
        if entry.position is None and state:
            missing.append(f"{name} (its initial position)")
        positions.append(numbers.value(name, entry.position))
        velocities.append(numbers.value(velocity_name(name), entry.velocity))
    prescribed = _prescribed(system, numbers)
    if missing or numbers.contradictions:
        raise Incomplete(Lack(tuple(missing), tuple(numbers.contradictions)))
    typed = {name: entry.position for name, entry in values.items() if entry.position is not None}
    became = tuple(_driven(control, given_laws, system) for control in inputs)
    unstated = tuple(velocity_name(name) for name in system.coordinates if values[name].velocity is None)
    return Scenario(system, parameters, tuple(positions), tuple(velocities), prescribed, typed, became, unstated)


def _driven(control: Input, laws: Mapping[str, Expression], system: System) -> Driven:
    law = laws.get(control.name, control.held)
    plain = folded(law, speeds_in_coordinates(names(law), system))
    return Driven(control.name, law, control.name in laws, plain)


def _prescribed(system: System, numbers: _Numbers) -> dict[str, tuple[Fraction, Fraction]]:
    """(value at t = 0, rate) of what moves as prescribed."""
    return {
        item.name: (numbers.value(item.name, item.initial), numbers.value(f"the rate of {item.name}", item.rate))
        for item in system.prescribed
    }


def contradictions_of(system: System, overrides: Mapping[str, Expression]) -> tuple[Contradiction, ...]:
    """Where values of parameters, some of them replaced, contradict signs, relations or assumptions."""
    numbers = _Numbers()
    _parameters(system, overrides, numbers, assumed=True)
    return tuple(numbers.contradictions)


def own_values(system: System, overrides: Mapping[str, Expression]) -> dict[str, Expression]:
    """What the description and the overrides say of declared variables at t = 0."""
    expressions = {value.coordinate: value.position for value in system.start if value.position is not None}
    return expressions | {name: overrides[name] for name in system.variables if name in overrides}


def _with_own(
    system: System,
    own: Mapping[str, Expression],
    overrides: Mapping[str, Expression],
    numbers: _Numbers,
    missing: list[str],
    laws: Mapping[str, Expression],
    inputs: Sequence[Input],
    declared: bool,
) -> Scenario:
    """The scenario of an initial state in declared variables."""
    from mbsym.numerics.declared_start import declared_start  # few descriptions have any

    given_values = initial_values(system, overrides)
    values = {name: numbers.value(name, value) for name, value in own.items()}

    def told(name: str, value: Expression | None) -> Fraction | None:
        return None if value is None else numbers.value(name, value)

    positions = {name: told(name, given_values[name].position) for name in system.coordinates}
    velocities = {name: told(velocity_name(name), given_values[name].velocity) for name in system.coordinates}
    prescribed = _prescribed(system, numbers)
    if missing or numbers.contradictions:
        raise Incomplete(Lack(tuple(missing), tuple(numbers.contradictions)))
    known = numbers.known | {name: initial for name, (initial, _) in prescribed.items()}
    start = declared_start(system, values, positions, velocities, known)
    wrong = [Contradiction("conflicting-values", name, text) for name, text in start.wrong]
    singular = bool(start.state) and start.velocities is None
    if singular and not declared:
        text = "in the initial state angles are singular: their velocities do not follow from the speeds"
        hint = "other axes of 'rotation' are regular there; mbsym simulate begins there in declared variables"
        wrong.append(Contradiction("singular-start", next(iter(own)), text, hint))
    if start.missing or wrong:
        raise Incomplete(Lack(start.missing, tuple(wrong)))
    became = tuple(_driven(control, laws, system) for control in inputs)
    rates = start.velocities or (arb(0),) * len(positions)
    return Scenario(
        system=system,
        parameters=numbers.known,
        positions=tuple(map(rounded, start.positions)),
        velocities=tuple(map(rounded, rates)),
        prescribed=prescribed,
        inputs=became,
        unstated=start.unstated,
        declared=tuple(map(rounded, start.state)),
        singular=singular,
    )


def changed(nominal: Scenario, **parameters: Fraction) -> Scenario:
    """The scenario with other numbers for some parameters."""
    return replace(nominal, parameters={**nominal.parameters, **parameters})


class _Numbers:
    """Values found so far; what has none because its expression makes no sense is ``refused``, with a sentence."""

    def __init__(self) -> None:
        self.known: dict[str, Fraction] = {}
        self.refused: set[str] = set()
        self.contradictions: list[Contradiction] = []

    def ready(self, expression: Expression) -> bool:
        return names(expression) <= self.known.keys() | {"pi"}

    def value(self, name: str, expression: Expression | None) -> Fraction:
        """Zero for what is left out, refused, or cannot be computed yet (then something else is missing)."""
        if expression is None or not self.ready(expression):
            return Fraction(0)
        try:
            return exact(expression, self.known)
        except Failure as reason:
            text = Message("[[name]] has no value: [[why]]", name=name, why=message_of(reason))
            self.contradictions.append(Contradiction("bad-number", name.split(" ")[-1], text))
            self.refused.add(name)
            return Fraction(0)

    def define(self, name: str, expression: Expression) -> None:
        value = self.value(name, expression)
        if name not in self.refused:
            self.known[name] = value

    @property
    def settled(self) -> set[str]:
        return self.known.keys() | self.refused


def _parameters(system: System, overrides: Mapping[str, Expression], numbers: _Numbers, assumed: bool) -> None:
    """Values given, and those that follow from relations; contradictions between the two, to signs and assumptions."""
    expressions = {p.name: overrides.get(p.name, p.value) for p in system.parameters}
    typed = {name for name, value in expressions.items() if value is not None}
    # A relation overrules the number in the file where what it is made of was overridden; else they must agree.
    stale = overruled(system, overrides)
    for _ in range(len(expressions) + 1):
        before = len(numbers.settled)
        for name, value in expressions.items():
            if value is not None and name not in numbers.settled and name not in stale and numbers.ready(value):
                numbers.define(name, value)
        for relation in system.relations:
            applies = relation.name not in typed or relation.name in stale
            if applies and relation.name not in numbers.settled and numbers.ready(relation.value):
                numbers.define(relation.name, relation.value)
        if len(numbers.settled) == before:
            break
    for relation in system.relations:
        if relation.name in numbers.known and numbers.ready(relation.value):
            follows = numbers.value(f"the relation of {relation.name}", relation.value)
            own = numbers.known[relation.name]
            if abs(follows - own) > AGREEMENT * max(abs(follows), abs(own)):
                text = Message(
                    "[[name]] = [[value]] contradicts its relation, which gives [[other]]",
                    name=relation.name, value=f"{float(own):.12g}", other=f"{float(follows):.12g}",
                )  # fmt: skip
                numbers.contradictions.append(Contradiction("conflicting-values", relation.name, text))
    for parameter in system.parameters:
        number = numbers.known.get(parameter.name)
        if number is not None and not has_sign(number, parameter.sign):
            text = Message(
                "[[name]] = [[value]], but it is declared [[sign]]",
                name=parameter.name, value=f"{float(number):.12g}", sign=worded(parameter.sign),
            )  # fmt: skip
            inferred = parameter.value is not None and parameter.sign in ("positive", "negative")
            hint = Message(
                "if its value alone says so, [[entry]] allows any sign",
                entry=f"{parameter.name}: {{real: true, value: ...}}",
            )
            wrong = Contradiction("sign-contradiction", parameter.name, text, hint if inferred else None)
            numbers.contradictions.append(wrong)
    for assumption, left, right in broken(system, numbers.known, AGREEMENT, _evaluated) if assumed else ():
        used = names(assumption.left) | names(assumption.right)
        name = next((override for override in overrides if override in used), min(used, default=""))
        written = f"{spelled(assumption.left)} {assumption.relation} {spelled(assumption.right)}"
        message = Message(
            "the values break the assumption [[assumption]]: [[left]] against [[right]]",
            assumption=written, left=f"{float(left):.12g}", right=f"{float(right):.12g}",
        )  # fmt: skip
        numbers.contradictions.append(Contradiction("broken-assumption", name, message))


def _evaluated(expression: Expression, known: Mapping[str, Fraction]) -> Fraction | None:
    if not names(expression) <= known.keys() | {"pi"}:
        return None
    try:
        return exact(expression, known)
    except Failure:
        return None


def initial_values(system: System, overrides: Mapping[str, Expression]) -> dict[str, InitialValue]:
    """What the description and the overrides say of every coordinate at t = 0."""
    values = {entry.coordinate: entry for entry in system.initial}
    for name in system.coordinates:
        entry = values.get(name, InitialValue(name))
        if name in overrides:
            entry = replace(entry, position=overrides[name])
        if velocity_name(name) in overrides:
            entry = replace(entry, velocity=overrides[velocity_name(name)])
        values[name] = entry
    return values


def exact(expression: Expression, known: Mapping[str, Fraction]) -> Fraction:
    """The value of an expression in ``known`` numbers and pi: exact where rational, else rounded to PRECISION bits.

    Raises SingularPoint where it divides by zero, is not real, or is beyond double precision; NoClosedForm for a power
    that is neither whole nor half.
    """
    used = names(expression)
    if "pi" not in used:
        try:
            values = {name: rationals.exact(known[name]) for name in used}
            rational = Lowering(Rationals({}, {}), values)(expression)
            return _within_range(rationals.fraction(rational))
        except (NotRational, NoValue):
            pass
    with ctx.workprec(PRECISION + 64):
        balls = {name: rationals.ball(known[name]) for name in used - {"pi"}}
        value = Lowering(Balls(balls), {**balls, "pi": arb.pi()})(expression)
        if not value.is_finite():
            raise SingularPoint("it is infinite or not real")
        if not value.rad() <= arb(2) ** -120 * max(abs(value.mid()), arb(1)):
            raise SingularPoint("too many digits cancel")
        return _within_range(rounded(value))


def rounded(value: arb) -> Fraction:
    """The midpoint of a ball, rounded to PRECISION bits.  Raises SingularPoint far beyond double precision."""
    with ctx.workprec(PRECISION):
        mantissa, exponent = (+value).mid().man_exp()
    if abs(int(exponent)) > LARGEST_EXPONENT + 8 * PRECISION:
        raise SingularPoint("it is beyond the range of double precision")
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def _within_range(value: Fraction) -> Fraction:
    """The value, if a double can hold it."""
    size = abs(value.numerator.bit_length() - value.denominator.bit_length()) if value else 0
    if size > LARGEST_EXPONENT:
        raise SingularPoint("it is beyond the range of double precision")
    return value


# Programs with numbers put in: what depends on parameters only is computed once, with ``PRECISION`` bits.
#
# A parameter that is zero takes its terms out of the program; equal values make equal nodes.  Constants are kept as
# fractions and are rounded, to far more bits than any arithmetic used later, only when they grow too long: so a double
# constant of the compiled code is the correctly rounded value of its formula, whatever that formula loses.


class Specialised(Program):
    """A program some of whose inputs are bound to numbers or to other nodes."""

    def __init__(self) -> None:
        super().__init__()
        self.bound: dict[str, Node] = {}

    def number(self, value: Fraction | int) -> Node:
        value = Fraction(value)
        if max(value.numerator.bit_length(), value.denominator.bit_length()) > 2 * PRECISION:
            with ctx.workprec(PRECISION):
                value = rounded(rationals.ball(value))
            if abs(value) * 2 ** (MOST_BITS - PRECISION) < 1:  # a power of what is 0 but for the rounding of pi
                value = Fraction(0)
        return super().number(value)

    def input(self, name: str) -> Node:
        return self.bound[name] if name in self.bound else super().input(name)

    def sin_cos(self, angle: LinearForm) -> tuple[Node, Node]:
        moving, constant = [], Fraction(0)
        for name, coefficient in angle.coefficients:
            value = self._constant(self.input(name))
            if value is None:
                moving.append((name, coefficient))
            else:
                constant += coefficient * value
        if len(moving) == len(angle.coefficients) or not constant:
            return super().sin_cos(LinearForm(tuple(moving), angle.turns))
        if not moving:
            return self._sin_cos_number(constant, angle.turns)
        total = self.number(constant)
        for name, coefficient in moving:
            total = total + self.number(coefficient) * self.input(name)
        if angle.turns:
            total = total + self.number(self._turned(angle.turns))
        return super().sin_cos_of(total)

    def sin_cos_of(self, argument: Node) -> tuple[Node, Node]:
        value = self._constant(argument)
        return super().sin_cos_of(argument) if value is None else self._sin_cos_number(value, Fraction(0))

    def _sin_cos_number(self, radians: Fraction, turns: Fraction) -> tuple[Node, Node]:
        with ctx.workprec(PRECISION + 64):
            angle = rationals.ball(radians)
            angle += arb.pi() * rationals.ball(turns)
            sine, cosine = angle.sin_cos()
            return self.number(rounded(sine)), self.number(rounded(cosine))

    @staticmethod
    def _turned(turns: Fraction) -> Fraction:
        with ctx.workprec(PRECISION + 64):
            return rounded(arb.pi() * rationals.ball(turns))

    def square_root(self, x: Node) -> Node:
        node = super().square_root(x)
        return node if self._constant(node) is not None else self._folded("sqrt", x, node)

    def function(self, name: str, x: Node) -> Node:
        return self._folded(name, x, super().function(name, x))

    def _folded(self, name: str, x: Node, otherwise: Node) -> Node:
        """The number that a function of a number is."""
        value = self._constant(x)
        if value is None:
            return otherwise
        with ctx.workprec(PRECISION + 64):
            balls = Balls({})
            argument = balls.number(value)
            result = balls.square_root(argument) if name == "sqrt" else balls.function(name, argument)
            if not result.is_finite():
                raise SingularPoint("[[functions]] of [[what]]", functions=name, what=f"{float(value):g}")
            return self.number(rounded(result))


def bound(scenario: Scenario) -> Specialised:
    """An empty program in which the names of parameters and prescribed quantities stand for their values."""
    fresh = Specialised()
    values: dict[str, Node] = {name: fresh.number(value) for name, value in scenario.parameters.items()}
    time = fresh.input("t")
    for name, (initial, rate) in scenario.prescribed.items():
        values[name] = fresh.number(initial) + fresh.number(rate) * time
    with ctx.workprec(PRECISION):
        values["pi"] = fresh.number(rounded(arb.pi()))
    fresh.bound = values
    return fresh


def substituted(program: Program, outputs: Sequence[Node], fresh: Program) -> list[Node]:
    """The outputs rebuilt in another program, whose ``input`` says what the names stand for there."""
    inputs: Mapping[str, Node] = Names(fresh)
    return program.evaluate(outputs, inputs, fresh)


class Names(dict[str, Node]):
    """What names stand for in a program, which knows which of them are bound."""

    def __init__(self, program: Program) -> None:
        super().__init__()
        self.program = program

    def __missing__(self, name: str) -> Node:
        return self.program.input(name)
