"""A system in the dimensionless variables that an author chose (``mbsym.model.scaling``).

    x = c x1,    t = f tau,    p = p(new parameters)

**As a description**: p is put in, and as many positive names as there are base units are set to 1, those of the factors
first; every other one stands for its group then (``in_groups``).  What is left of a factor is put in, too.  **As
formulas**: those of the description, with x = c x1, x' = (c/f) x1', ... in them, row by row without what all terms of
a row share; for that no description need have such variables (scaled components of a unit vector).

The law: both ways give the same equations, identically in the ring and for all values of what was set to 1 (up to a
factor of each row).  A description that fails it is not given.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from fractions import Fraction
from functools import reduce
from typing import TYPE_CHECKING, Any, cast

from flint import fmpq

from mbsym.algebra import rationals
from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Generator, Polynomial, Ring
from mbsym.algebra.terms import apart
from mbsym.analysis.in_groups import in_groups, product
from mbsym.expressions.rates import ENDINGS, velocity_name, without_velocity
from mbsym.expressions.tree import (
    ONE,
    Call,
    Expression,
    Name,
    Operation,
    divide,
    is_number,
    multiply,
    names,
    number,
    power,
    substitute,
    text,
)
from mbsym.formulas.formula import Formula
from mbsym.mechanics.variables import angles_of, ring_environment, ring_of
from mbsym.model.assumptions import RELATION_OF_SIGN
from mbsym.model.scaling import Scaling, factor_of
from mbsym.model.speeds import Quaternion, Speed, UnitVector
from mbsym.model.substitution import folded, put
from mbsym.model.system import Assumption, Parameter, System, WrittenSymbol, rational
from mbsym.problems.scaling import Groups, independent, measured_in

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.in_speeds import SpeedEquations

#: Fields that hold names of variables.
_NAMED = ("coordinate", "coordinates", "order", "dependent", "fast", "slow", "leading", "powers", "components")


class NoDescription(Failure):
    """No description has these variables; the message says why.  Formulas in them there may be."""

    code = "no-description"


def in_variables(system: System, scaling: Scaling) -> System:
    """The description in the new variables.  Raises NoDescription, or what deriving the equations raises."""
    from mbsym.analysis import Analysis

    if system.linear is not None:
        raise NoDescription("the system is given by its matrices")
    vectors = {name for body in system.bodies for one in body.orientation for name in one.components}
    for one in scaling.variables:
        if one.name in vectors and not is_number(one.factor, 1):
            raise NoDescription("[[name]] is a component of a unit vector or quaternion", name=one.name)
    base = with_parameters(system, scaling)
    groups = _groups(base, scaling)
    units = {name: number(1) for name in groups.units}
    ring = ring_of(base)
    lower = Lowering(ring, ring_environment(base, ring))
    if scaling.time is not None and lower(folded(scaling.time.factor, units)) != ring.one:
        left = text(folded(scaling.time.factor, units))
        raise NoDescription("with what can be set to 1 the unit of time is [[left]], not 1", left=left)
    changed = renamed(in_groups(base, groups), {variable.name: variable.new for variable in scaling.variables})
    for one in scaling.variables:
        factor = folded(one.factor, units)
        if lower(factor) != ring.one:
            changed = _multiplied(changed, one.new, factor)
    new = Analysis(changed)
    _demand_law(Analysis(_original(system, scaling)), new, scaling, groups)
    unit_values = ", ".join(f"{name} = 1" for name in units)
    return replace(
        changed,
        name=f"{system.name}, in {f'units in which {unit_values}' if unit_values else 'dimensionless variables'}",
    )


def with_parameters(system: System, scaling: Scaling) -> System:
    """The description with the new parameters in it, its variables as they are."""
    images = scaling.images
    signs = {parameter.name: parameter.sign for parameter in system.parameters} | dict.fromkeys(
        (name for name in scaling.units if name in scaling.new), "positive"
    )
    known = {parameter.name: parameter.value for parameter in system.parameters if parameter.value is not None}
    signs |= _signs(scaling, signs)
    parameters = tuple(parameter for parameter in system.parameters if parameter.name not in images)
    solved = _solved(scaling)
    new = tuple(
        Parameter(name, signs.get(name, "real"), _valued(solved[name], known), text(solved[name]))
        if name in solved
        else Parameter(name, signs.get(name, "real"))
        for name in scaling.new
    )
    assumed = [
        Assumption(images[parameter.name], RELATION_OF_SIGN[parameter.sign], number(0))
        for parameter in system.parameters
        if parameter.name in images
        and parameter.sign in RELATION_OF_SIGN
        and not _has_sign(images[parameter.name], parameter.sign, signs)
    ]
    small = system.small
    needed = set() if small is None else {name for name, _ in small.powers} or {small.name}
    base = replace(system, parameters=(), claims=(), abbreviations=(), small=None)
    changed: System = put(base, images)
    return replace(
        changed,
        parameters=(*parameters, *new),
        symbols=tuple(symbol for symbol in system.symbols if symbol.name not in images),
        assumptions=(*changed.assumptions, *assumed),
        small=small if not needed & (images.keys() | {variable.name for variable in scaling.variables}) else None,
    )


def _has_sign(x: Expression, sign: str, signs: Mapping[str, str]) -> bool:
    """Whether it follows from the signs of names."""
    if sign != "negative" and sign != "nonpositive" and _positive(x, signs):
        return True
    own = (name for name in names(x) if signs.get(name) == sign and factor_of(x, name) is not None)
    return any(_positive(x, {**signs, name: "positive"}) for name in own)


def _positive(x: Expression, signs: Mapping[str, str]) -> bool:
    """Whether it is a product, quotient, power of what is positive."""
    match x:
        case Name(name):
            return signs.get(name) == "positive" or name == "pi"
        case Operation("*" | "/" | "+", left, right):
            return _positive(left, signs) and _positive(right, signs)
        case Operation("**", base, _):
            return _positive(base, signs)
        case Call("sqrt", inner):
            return _positive(inner, signs)
    value = rational(x)
    return value is not None and value > 0


def _signs(scaling: Scaling, signs: Mapping[str, str]) -> dict[str, str]:
    """New names that have the sign of what is put in for, being a factor of it beside others that are positive."""
    inferred: dict[str, str] = {}
    for name in scaling.new:
        for old, value in scaling.parameters:
            others = {**signs, **inferred, name: "positive"}
            if name not in signs and old in signs and factor_of(value, name) is not None and _positive(value, others):
                inferred[name] = signs[old]
    return inferred


def _solved(scaling: Scaling) -> dict[str, Expression]:
    """The new names in terms of the old ones, each from an equation in which it alone is unknown and a factor."""
    expressions: dict[str, Expression] = {}
    for _ in scaling.new:
        for old, value in scaling.parameters:
            unknown = [name for name in scaling.new if name in names(value) and name not in expressions]
            for degree in (1, 2, 3, 4) if len(unknown) == 1 else ():
                stand = f"{unknown[0]}#"
                shape = _powers(value, unknown[0], degree, stand)
                factor = None if shape is None else factor_of(shape, stand)
                if factor is not None:
                    expressions[unknown[0]] = _root(divide(Name(old), substitute(factor, expressions)), degree)
                    break
    return expressions


def _root(x: Expression, degree: int) -> Expression:
    return x if degree == 1 else Call("sqrt", x) if degree == 2 else power(x, number(Fraction(1, degree)))


def _powers(x: Expression, name: str, degree: int, stand: str) -> Expression | None:
    """The expression with another name for name**degree; None where the name is left."""
    if degree == 1:
        return substitute(x, {name: Name(stand)})

    def changed(node: Expression) -> Expression:
        match node:
            case Operation("**", Name(own), exponent) if own == name and is_number(exponent, degree):
                return Name(stand)
            case Operation(operator, left, right):
                return Operation(operator, changed(left), changed(right))
        return node

    expression = changed(x)
    return None if name in names(expression) else expression


def _valued(x: Expression, known: Mapping[str, Expression]) -> Expression | None:
    """The value of an expression, as a fraction where it is one; None where a name has none."""
    for _ in known:
        x = substitute(x, dict(known))
    if names(x) - {"pi"}:
        return None
    ring = Ring([], [], [], {})
    value = Lowering(ring, {"pi": ring.generator("parameter", "pi")})(x)
    return number(rationals.fraction(value.leading_coefficient() if value else fmpq(0))) if value.is_constant() else x


def _groups(base: System, scaling: Scaling, preferred: Sequence[str] = ()) -> Groups:
    """What is set to 1, by dimensions: names of factors first, then others that are positive, as they are declared."""
    signs = {parameter.name: parameter.sign for parameter in base.parameters}
    related = {relation.name for relation in base.relations}
    free = [name for name in signs if name not in related]
    bases = sorted({one for weights in scaling.weights.values() for one in weights if not one.startswith("[")} | {"s"})

    def vector(name: str) -> list[fmpq]:
        return [rationals.exact(scaling.weights[name].get(base_, Fraction(0))) for base_ in bases]

    exponents = {name: vector(name) for name in free}
    candidates = [name for name in (*preferred, *scaling.units, *free) if signs.get(name) == "positive"]
    units = independent(candidates, exponents)
    lost = next((name for name in free if len(independent((*units, name), exponents)) > len(units)), None)
    if lost is not None and lost not in units:
        raise NoDescription(
            "nothing that is positive measures [[name]]", name=lost, remedy="say what it is in new names"
        )
    rate = [fmpq(-int(base_ == "s")) for base_ in bases]
    moving = (
        *base.coordinates,
        *base.variables,
        *(prescribed.name for prescribed in base.prescribed),
        *base.input_names,
    )
    return measured_in(exponents, units, rate, {name: vector(name) for name in moving})


def proposed(system: System, dimensions: Scaling, preferred: Sequence[str]) -> str:
    """A scaling as an author would write it: what has a dimension is put in units, those preferred first.

    ``dimensions`` are those of a scaling that changes nothing.
    """
    try:
        groups = _groups(system, dimensions, preferred)
    except NoDescription:
        return ""
    known = {*system.parameter_names, *system.coordinates, *system.variables}
    items = []

    def new(name: str) -> str:
        while (fresh := f"{name}_hat") in known:
            name = f"{name}1"
        known.add(fresh)
        return fresh

    for length in groups.lengths:
        if length.parameter in system.coordinates and length.powers:
            items.append(f"{length.parameter}={text(multiply(product(length.powers), Name(new(length.parameter))))}")
    powers = [groups.rate or (), *(group.powers for group in (*groups.lengths, *groups.groups))]
    if any(power.denominator > 2 for monomial in powers for _, power in monomial):
        return ""  # nobody would choose these units
    if groups.rate:
        items.append(f"t={text(divide(Name('tau'), product(groups.rate)))}")
    for group in groups.groups:
        if group.powers:
            scale = product([(unit, -power) for unit, power in group.powers])
            items.append(f"{group.parameter}={text(multiply(scale, Name(new(group.parameter))))}")
    return ",".join(items).replace(" ", "")


def renamed(part: Any, new: Mapping[str, str]) -> Any:
    """A part of a description with other names of variables."""
    every = {name + end: to + end for name, to in new.items() for end in ("", *ENDINGS.values())}
    vectors = {name[:-1]: to[:-1] for name, to in new.items() if name[-1:].isdigit() and name[-1:] == to[-1:]}
    return put(_renamed(part, every, vectors), {name: Name(to) for name, to in every.items()})


def _renamed(part: Any, every: Mapping[str, str], vectors: Mapping[str, str]) -> Any:
    if isinstance(part, tuple):
        return tuple(_renamed(entry, every, vectors) for entry in part)
    if isinstance(part, (UnitVector, Quaternion)):
        to = vectors.get(part.name, part.name)
        components = tuple(every.get(name, name) for name in part.components)
        vector = replace(part, name=to)
        if vector.components != components:
            raise NoDescription(
                "components of one vector have the names of one vector: [[names]]", names=", ".join(part.components)
            )
        return vector
    if not is_dataclass(part) or isinstance(part, type):
        return part
    changed: dict[str, Any] = {}
    for item in fields(part):
        old = getattr(part, item.name)
        if item.name in _NAMED or (item.name == "name" and isinstance(part, (Speed, WrittenSymbol))):
            value = _in_names(old, every)
        else:
            value = _renamed(old, every, vectors)
        if value is not old:
            changed[item.name] = value
    return replace(part, **changed) if changed else part


def _in_names(value: Any, every: Mapping[str, str]) -> Any:
    if isinstance(value, tuple):
        return tuple(_in_names(entry, every) for entry in value)
    return every.get(value, value) if isinstance(value, str) else value


def _original(system: System, scaling: Scaling) -> System:
    """The system as it was described, its variables by their new names."""
    bare = replace(system, claims=(), abbreviations=(), units=type(system.units)(), limits=())
    return cast("System", renamed(bare, {variable.name: variable.new for variable in scaling.variables}))


def _multiplied(system: System, name: str, factor: Expression) -> System:
    """A description in which a variable is a factor times what it was; ``name`` stays."""
    images = {name + end: multiply(factor, Name(name + end)) for end in ("", *ENDINGS.values())}
    speeds = {speed.name for speed in system.speeds}
    if name in speeds:
        images = dict.fromkeys((), ONE) | {name + "_dot": images[name + "_dot"], name: images[name]}
    if name in system.dependent:
        raise NoDescription("'[[name]]' is a dependent variable", name=name)
    loads = tuple(_load(load, name, factor) for load in system.loads)
    conditions = {attribute: getattr(system, attribute) for attribute in ("motion", "initial", "start")}
    base = replace(system, loads=loads, motion=(), initial=(), start=())
    bodies = tuple(
        replace(
            body,
            speeds=tuple(
                replace(speed, form=divide(speed.form, factor)) if speed.name == name else speed
                for speed in body.speeds
            ),
        )
        for body in base.bodies
    )
    changed: System = put(replace(base, bodies=bodies), images)
    values = {parameter.name: parameter.value for parameter in system.parameters if parameter.value is not None}
    valued = _valued(factor, values)

    def divided(x: Expression | None) -> Expression | None:
        return None if x is None or valued is None else _valued(divide(x, valued), values) or divide(x, valued)

    motion = tuple(
        replace(x, value=divide(x.value, factor), rate=divide(x.rate, factor)) if x.coordinate == name else x
        for x in conditions["motion"]
    )
    initial, start = (
        tuple(
            replace(x, position=divided(x.position), velocity=divided(x.velocity)) if x.coordinate == name else x
            for x in conditions[part]
            if x.coordinate != name or valued is not None
        )
        for part in ("initial", "start")
    )
    return replace(changed, motion=motion, initial=initial, start=start)


def _load(load: Any, name: str, factor: Expression) -> Any:
    """A load on a coordinate, in the coordinate that is ``factor`` times smaller."""
    scaled = {
        id(measured.formula): _by_power(measured.formula, factor, -Fraction(measured.power))
        for measured in load.measured()
        if measured.coordinate == name
    }

    def changed(part: Any) -> Any:
        if id(part) in scaled:
            return scaled[id(part)]
        return tuple(map(changed, part)) if isinstance(part, tuple) else part

    return (
        replace(load, **{attribute.name: changed(getattr(load, attribute.name)) for attribute in fields(load)})
        if scaled
        else load
    )


def _by_power(x: Expression, factor: Expression, exponent: Fraction) -> Expression:
    own = factor if abs(exponent) == 1 else power(factor, number(abs(exponent)))
    return multiply(x, own) if exponent > 0 else divide(x, own)


# --- formulas --------------------------------------------------------------------------------------------------------


class _Put(Carrier):
    """Carries formulas into the ring of the new variables; a scaled angle stands under its sine as a product."""

    def __init__(self, ring: Ring, target: Ring, environment: Mapping[str, Any], scaled: Sequence[str]) -> None:
        super().__init__(ring, target, environment)
        self._scaled = frozenset(scaled)

    def _value(self, g: Generator) -> Any:
        if g.kind in ("sine", "cosine") and g.argument is None and g.name in self._scaled:
            argument = self.environment[g.name] * self.algebra.number(Fraction(1, g.denominator))
            return self.algebra.sin_cos_of(argument)[0 if g.kind == "sine" else 1]
        return super()._value(g)


class Formulas:
    """Formulas of a system in the new variables: ``carry`` brings one there, ``row`` without what its terms share."""

    def __init__(self, system: System, scaling: Scaling, terms: int = 0) -> None:
        from mbsym.analysis import Analysis

        self.scaling = scaling
        self.analysis = (
            Analysis(_original(system, scaling), terms=terms) if terms else Analysis(_original(system, scaling))
        )
        base = with_parameters(system, scaling)
        own = self.analysis.system
        self.system = replace(
            own, parameters=base.parameters, notation=(), assumptions=base.assumptions, relations=(), claims=()
        )
        ring = self.analysis.equations.forcing[0].ring
        self.ring = _ring(self.system, self.analysis.system, scaling)
        there = ring_environment(self.system, self.ring)
        self.carry = _Put(ring, self.ring, *_environment(self.analysis.system, there, self.ring, scaling, None))

    def formula(self, x: Formula) -> Formula:
        return Formula(self.ring, self.carry(x.polynomial))

    def moving(self, rate: Formula) -> Formula:
        """The rate of a variable, in its new time and size."""
        (k,) = (k for k, degree in enumerate(rate.polynomial.degrees()) if degree)
        g = rate.ring.generators[k]
        return Formula(self.ring, self.ring.generator(g.kind, g.name))

    def rate(self, rate: Formula, value: Formula) -> Formula:
        """What the rate of a variable is equal to, in its new time and size."""
        factor = self.ring.quotient(self.carry(rate.polynomial), self.moving(rate).polynomial)
        assert factor is not None
        return Formula(self.ring, self.ring.ratio(self.carry(value.polynomial), factor))

    def row(self, x: Formula, constant: bool = False) -> Formula:
        """A constant multiple of a formula: without denominators of parameters, content and common names.

        ``constant``: without what is constant in it, too.
        """
        top, below = self.ring.fraction(self.carry(x.polynomial))
        if any(_moving(self.ring, factor) for factor, _ in below):
            return self.formula(x)
        if constant:
            fixed = [k for k, g in enumerate(self.ring.generators) if g.kind != "parameter"]
            terms = top.to_dict().items()
            top = self.ring.context.from_dict({key: c for key, c in terms if any(key[k] for k in fixed)})
        shared = reduce(self.ring.common_factor, _terms(self.ring, top), self.ring.zero)
        whole = self.ring.quotient(top, shared) if shared else None
        return Formula(self.ring, top if whole is None else whole)


def _moving(ring: Ring, x: Polynomial) -> bool:
    """Whether it holds more than parameters."""
    return any(degree and g.kind != "parameter" for g, degree in zip(ring.generators, x.degrees(), strict=True))


def _terms(ring: Ring, x: Polynomial) -> Iterator[Polynomial]:
    """The coefficients of what moves: polynomials in parameters."""
    moving = [k for k, g in enumerate(ring.generators) if g.kind not in ("parameter", "spare")]
    return iter(apart(x, moving).values())


def _ring(system: System, original: System, scaling: Scaling) -> Ring:
    """The ring of the new variables, with room for what factors, and reciprocals of what is put in, bring."""
    factors = [scaled.factor for scaled in (*scaling.variables, scaling.time) if scaled is not None]
    room = tuple(Assumption(x, "!=", number(0)) for x in (*factors, *(divide(ONE, x) for x in scaling.images.values())))
    return ring_of(
        replace(system, assumptions=(*system.assumptions, *room, *room)), arguments=tuple(angles_of(original))
    )


def _environment(
    original: System, own: Mapping[str, Any], ring: Ring, scaling: Scaling, groups: Groups | None
) -> tuple[dict[str, Any], list[str]]:
    """What the names of the original, by their new names, are in the ring of the new variables."""
    lower = Lowering(ring, own)
    environment = dict(own)
    lengths = {} if groups is None else {length.parameter: product(length.powers) for length in groups.lengths}
    factors = {variable.new: variable.factor for variable in scaling.variables}
    slow = ONE if scaling.time is None else scaling.time.factor
    if scaling.time is None and groups is not None and groups.rate is not None:
        slow = divide(ONE, product(groups.rate))
    time = lower(slow)
    environment["t"] = ring.times(time, own["t"])
    rate = ring.reciprocal(time)
    old = {variable.new: variable.name for variable in scaling.variables}
    scaled = []
    driven = (*(prescribed.name for prescribed in original.prescribed), *original.input_names)
    for name in (*original.coordinates, *original.variables, *driven):
        factor = lower(factors.get(name) or lengths.get(old.get(name, name), ONE))
        if factor != ring.one:
            scaled.append(name)
        for order, end in enumerate(("", *ENDINGS.values())):
            if name + end in own:
                environment[name + end] = ring.times(
                    own[name + end], ring.times(factor, ring.power(rate, order) if order else ring.one)
                )
    for name, value in scaling.parameters:
        environment[name] = lower(value)
    return _following(original, ring, environment), scaled


def _following(system: System, ring: Ring, environment: dict[str, Any]) -> dict[str, Any]:
    """With what relations and the notation give."""
    definitions = [(relation.name, relation.value) for relation in system.relations] + [
        (notation.name, notation.value) for notation in system.notation
    ]
    for name, value in definitions:
        environment[name] = Lowering(ring, environment)(value)
    return environment


def _demand_law(old: Analysis, new: Analysis, scaling: Scaling, groups: Groups) -> None:
    """Both give the same equations.  Raises NoDescription where they do not, or where that cannot be seen."""
    units = tuple(Parameter(name, "positive") for name in groups.units)
    whole = replace(new.system, parameters=(*new.system.parameters, *units))
    ring = _ring(whole, old.system, scaling)
    own = ring_environment(whole, ring)
    own |= {x.name: own[x.name] ** 2 for x in units}  # positive: so their roots need no generators
    environment, scaled = _environment(old.system, own, ring, scaling, groups)
    old_carrier = _Put(old.equations.forcing[0].ring, ring, environment, scaled)
    lower = Lowering(ring, own)
    stands = {x.parameter: lower(multiply(Name(x.parameter), product(x.powers))) for x in groups.groups}
    new_carrier = Carrier(new.equations.forcing[0].ring, ring, _following(new.system, ring, {**own, **stands}))
    for left, right in zip(_rows(old), _rows(new), strict=True):
        a, b = [old_carrier(x.polynomial) for x in left], [new_carrier(x.polynomial) for x in right]
        k = next((k for k, x in enumerate(b) if x), None)
        same = [
            ring.is_zero(ring.reduce(ring.times(x, b[k]) - ring.times(y, a[k]))) if k is not None else not x
            for x, y in zip(a, b, strict=True)
        ]
        if not all(same) or (k is not None and not a[k]):
            raise NoDescription(
                "the equations hold numbers that have a dimension, or the scaled ones could not be compared",
                remedy="give the numbers names under 'parameters'",
            )


def _rows(analysis: Analysis) -> Iterator[list[Formula]]:
    """Terms that sum up to zero along every motion of the open tree; rates of the positions, and constraints.

    What the unperturbed motion is, where prescribed motions begin, and inputs that are held, too.
    """
    equations = analysis.equations
    ring = equations.forcing[0].ring
    lower, system = analysis.scene.lower, analysis.system
    known = ring_environment(system, ring)
    definitions = [(entry.coordinate, entry.value) for entry in system.motion]
    definitions += [(velocity_name(entry.coordinate), entry.rate) for entry in system.motion]
    definitions += [
        (prescribed.name, prescribed.initial) for prescribed in system.prescribed if prescribed.initial is not None
    ]
    definitions += [(quantity.name, quantity.held) for quantity in system.inputs]
    for name, value in definitions:
        yield [Formula(ring, known[name]), Formula(ring, lower(value))]
    speeds = cast("SpeedEquations", equations).speeds if equations.in_speeds else ()
    rates = [_rate(ring, name) for name in speeds] or [
        Formula(ring, ring.generator("acceleration", name)) for name in analysis.system.coordinates
    ]
    for row, force in zip(equations.mass_matrix, equations.forcing, strict=True):
        yield [*(x * rate for x, rate in zip(row, rates, strict=True)), force]
    yield from ([x] for x in equations.constraints.velocity)
    if equations.in_speeds:
        own = cast("SpeedEquations", equations)
        yield from ([_rate(ring, name), x] for name, x in zip(own.positions, own.rates, strict=True))


def _rate(ring: Ring, name: str) -> Formula:
    """The rate of a speed or position, also of a speed that is called x_dot."""
    if ring.has("velocity", name):
        return Formula(ring, ring.generator("velocity", name))
    return Formula(ring, ring.generator("acceleration", without_velocity(name)))
