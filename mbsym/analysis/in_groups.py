"""A description written in its dimensionless groups: the units are 1, and every other parameter stands for its group.

    m2 -> m2/m1,   l2 -> l2/l1,   m1 = l1 = g = 1,   t in units of sqrt(l1/g)

The equations of the result are those of the system divided through; whatever is derived from it (reports, maps, sweeps)
is in the groups.  Values follow: those of the groups, and the initial state in the new units, where they are known.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from mbsym.expressions.tree import (
    Call,
    Expression,
    Name,
    divide,
    is_number,
    multiply,
    names,
    number,
    power,
    substitute,
    text,
)
from mbsym.model.substitution import folded, put
from mbsym.model.system import Body, InitialValue, Parameter, SmallParameter, System, rational
from mbsym.model.units import Units
from mbsym.problems.scaling import Groups

Powers = Iterable[tuple[str, Fraction]]


def product(powers: Powers) -> Expression:
    """x**2*sqrt(y)/z as an expression; 1 where there is nothing."""
    wholes: list[tuple[str, int]] = []
    halves: list[tuple[str, int]] = []
    others: list[tuple[str, Fraction]] = []
    for name, exponent in powers:
        if exponent.denominator == 1:
            wholes.append((name, exponent.numerator))
        elif exponent.denominator == 2:
            halves.append((name, exponent.numerator))
        else:
            others.append((name, exponent))
    expression = _quotient([(_whole(name, abs(k)), k > 0) for name, k in wholes])
    if halves:
        root = Call("sqrt", _quotient([(_whole(name, abs(k)), k > 0) for name, k in halves]))
        expression = root if is_number(expression, 1) else multiply(expression, root)
    for name, exponent in others:
        expression = multiply(expression, power(Name(name), number(exponent)))
    return expression


def _quotient(factors: Iterable[tuple[Expression, bool]]) -> Expression:
    """The factors that stand above (True) over those that do not."""
    sides: dict[bool, Expression] = {}
    for factor, above in factors:
        sides[above] = factor if above not in sides else multiply(sides[above], factor)
    top = sides.get(True, number(1))
    return divide(top, sides[False]) if False in sides else top


def _whole(name: str, exponent: int) -> Expression:
    return Name(name) if exponent == 1 else power(Name(name), number(exponent))


def group_of(name: str, powers: Powers) -> Expression:
    """What a parameter stands for: m2/m1."""
    return product([(name, Fraction(1)), *powers])


def in_groups(system: System, groups: Groups, values: bool = True) -> System:
    """The description in groups, with ``values`` if these are wanted; claims, units of measurement, limits left out."""
    units = {name: number(1) for name in groups.units}
    known: Mapping[str, Expression] = {x.name: x.value for x in system.parameters if x.value is not None and values}
    stands = {group.parameter: group_of(group.parameter, group.powers) for group in groups.groups}
    related = {relation.name for relation in system.relations}
    parameters = []
    for parameter in system.parameters:
        if parameter.name in units:
            continue
        if parameter.name in stands:
            parameters.append(_group(parameter, stands[parameter.name], known))
        else:  # one that does not matter, or follows from others
            keeps_value = values and parameter.name not in related
            parameters.append(parameter if keeps_value else replace(parameter, value=None))
    base = replace(system, parameters=(), initial=(), claims=(), units=Units(), limits=(), abbreviations=())
    changed: System = put(base, units, folded)
    scale = changed.time_scale
    unit_values = ", ".join(f"{name} = 1" for name in groups.units)
    return replace(
        changed,
        name=f"{system.name}, in dimensionless groups",
        description=f"In units in which {unit_values}.  {system.description}".strip()
        if unit_values
        else system.description,
        bodies=tuple(map(_accepted, changed.bodies)),
        parameters=tuple(parameters),
        symbols=tuple(symbol for symbol in changed.symbols if symbol.name not in units),
        initial=tuple(_initial(system.initial, groups, known)),
        start=tuple(_initial(system.start, groups, known)),
        time_scale=scale if scale is not None and names(scale) else None,
        small=_small(system, {parameter.name for parameter in parameters}),
        notation=tuple(item for item in changed.notation if names(item.value)),
    )


def _small(system: System, remaining: Collection[str]) -> SmallParameter | None:
    """The small parameter, where what it belongs to is still there."""
    small = system.small
    if small is None:
        return None
    needed = {name for name, _ in small.powers} or {small.name}
    return small if needed <= set(remaining) else None


def _accepted(body: Body) -> Body:
    """What a rigid body can be is not asked: m l^2 < A need not stand in the equations, which hold m g l and A."""
    return body if body.inertia is None else replace(body, inertia=replace(body.inertia, accepted=True))


def _group(parameter: Parameter, stands: Expression, values: Mapping[str, Expression]) -> Parameter:
    meaning = f"{text(stands)}; {parameter.name}: {parameter.meaning}" if parameter.meaning else text(stands)
    if stands == Name(parameter.name):
        meaning = parameter.meaning
    return replace(parameter, meaning=meaning, value=_valued(stands, values))


def _valued(x: Expression, values: Mapping[str, Expression]) -> Expression | None:
    """With numbers for all names; None where one has none."""
    if not names(x) <= values.keys():
        return None
    expression = substitute(x, dict(values))
    exact = rational(expression)
    return expression if exact is None else number(exact)


def _initial(
    given_values: Sequence[InitialValue], groups: Groups, values: Mapping[str, Expression]
) -> Iterable[InitialValue]:
    """Positions by their lengths, velocities by lengths times the rate; left out where a unit has no value."""
    lengths = {group.parameter: group.powers for group in groups.lengths}
    if groups.rate is None:
        return
    for value in given_values:
        length = _valued(product(lengths.get(value.coordinate, ())), values)
        rate = _valued(product([*lengths.get(value.coordinate, ()), *groups.rate]), values)
        if length is None or rate is None:
            continue
        position = value.position if value.position is None else _divided(value.position, length, values)
        velocity = value.velocity if value.velocity is None else _divided(value.velocity, rate, values)
        if (value.position is None) == (position is None):
            yield replace(value, position=position, velocity=velocity)


def _divided(x: Expression, unit: Expression, values: Mapping[str, Expression]) -> Expression | None:
    value = _valued(x, values)
    if value is None:
        return None
    exact = rational(divide(value, unit))
    return divide(value, unit) if exact is None else number(exact)
