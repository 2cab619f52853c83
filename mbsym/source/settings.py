"""What is asked of a system: relations, assumptions, unperturbed motion, notation, initial state, small parameter."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression, names, reached
from mbsym.model.system import (
    Assumption,
    InitialValue,
    Limit,
    MotionEntry,
    Notation,
    Relation,
    SmallParameter,
    rational,
)
from mbsym.source.keys import INITIAL, MOST_POWER, MOTION, SMALL_PARAMETER
from mbsym.source.placed import Entry, Mapping, Node, Scalar, Sequence
from mbsym.source.reading import Reading, keys_of
from mbsym.source.scope import ASSUMPTION, Allowed

_COMPARISON = re.compile(r"<=|>=|!=|==|=|<|>|≤|≥|≠")
_OPPOSITES = {"≤": "<=", "≥": ">=", "≠": "!="}


def read_relations(node: Node | None, reading: Reading) -> tuple[Relation, ...]:
    """``name: expression`` between parameters, without circles."""
    if node is None:
        return ()
    relations = []
    for entry in reading.entries(node, "'relations'"):
        errors = reading.errors
        known = reading.scope.check_name(entry.key.text, entry.key.span, Allowed("the left side of a relation"))
        value = reading.expression(entry.value, Allowed("a relation"))
        if known and reading.errors == errors:
            relations.append(Relation(entry.key.text, value, entry.key.span))
    _check_circles(relations, reading)
    return tuple(relations)


def _check_circles(relations: list[Relation], reading: Reading) -> None:
    needs = {relation.name: names(relation.value) for relation in relations}
    for relation in relations:
        if relation.name in reached(needs, needs[relation.name]):
            message = Message("'[[name]]' depends on itself through the relations", name=relation.name)
            reading.error("relation-cycle", message, relation.span)


def read_assumptions(node: Node | None, reading: Reading) -> tuple[Assumption, ...]:
    """A list of inequalities; a chain ``-1 < alpha < 1`` is two of them."""
    assumptions: list[Assumption] = []
    for item in () if node is None else reading.items(node, "'assumptions'"):
        scalar = reading.scalar(item, "an assumption")
        if scalar is not None:
            assumptions += read_comparisons(scalar, reading, ASSUMPTION)
    return tuple(assumptions)


def read_comparisons(scalar: Scalar, reading: Reading, allowed: Allowed) -> list[Assumption]:
    """The inequalities of a chain; none, with complaints, where it is none."""
    signs = list(_COMPARISON.finditer(scalar.text))
    if not signs:
        hint = "write for example alpha > -1"
        reading.error(
            "bad-assumption", Message("[[what]] compares two expressions", what=worded(allowed.what)), scalar.span, hint
        )
        return []
    for sign in signs:
        if sign.group() in ("=", "=="):
            span = scalar.place(sign.start(), sign.end())
            hint = "an equation belongs to 'relations'"
            reading.error("bad-assumption", Message("[[what]] is an inequality", what=worded(allowed.what)), span, hint)
            return []
    errors = reading.errors
    cuts = [0, *(edge for sign in signs for edge in sign.span()), len(scalar.text)]
    sides = [
        reading.expression(scalar.part(begin, end), allowed) for begin, end in zip(cuts[::2], cuts[1::2], strict=True)
    ]
    if reading.errors != errors:
        return []
    relations = [_OPPOSITES.get(sign.group(), sign.group()) for sign in signs]
    return [
        Assumption(left, relation, right, scalar.span)
        for left, relation, right in zip(sides, relations, sides[1:], strict=False)
    ]


def read_motion(node: Node | None, reading: Reading) -> tuple[MotionEntry, ...]:
    """``theta: 0`` or ``phi: {value: 0, rate: Omega}``; an empty mapping is the rest of all coordinates at 0."""
    allowed, moving = Allowed("an unperturbed motion"), Allowed("an unperturbed motion", ("parameter", "given"))
    forces = Allowed("an unperturbed motion", (*moving.kinds, "given rate", "given acceleration"))
    if isinstance(node, Mapping) and not node.entries:
        return tuple(MotionEntry(name, ZERO, ZERO, node.span) for name in reading.scope.of_kind("coordinate"))
    entries = []
    inputs = ("input",) if reading.scope.of_kind("input") else ()
    rest = "write {} for the rest of all at 0" if isinstance(node, Scalar) and not node.text.strip() else None
    for entry in () if node is None else reading.entries(node, "'motion'", rest):
        known = _is_coordinate(entry.key, "the key of a motion", node, reading, *inputs)
        value: Expression = ZERO
        rate: Expression = ZERO
        if isinstance(entry.value, Mapping):
            fields = reading.fields(
                entry.value, Message("the motion of [[what]]", what=ascii_safe(entry.key.text)), MOTION
            )
            rate = fields.expression("rate", allowed) or ZERO
            value = fields.expression("value", moving if rate == ZERO else allowed) or ZERO
            if "rate" in keys_of(entry.value) and reading.scope.kinds.get(entry.key.text) == "input":
                message = Message(
                    "the input [[what]] is constant on the unperturbed motion", what=ascii_safe(entry.key.text)
                )
                reading.error("misplaced-key", message, fields.key_span("rate"), "leave 'rate' out")
        else:
            is_input = reading.scope.kinds.get(entry.key.text) == "input"
            value = reading.expression(entry.value, forces if is_input else moving)
        if known:
            entries.append(MotionEntry(entry.key.text, value, rate, entry.key.span))
    return tuple(entries)


def of_coordinates(motion: tuple[MotionEntry, ...], reading: Reading) -> tuple[MotionEntry, ...]:
    """The motion without its entries of inputs; where only these are given, the rest of all coordinates at 0."""
    entries = tuple(entry for entry in motion if reading.scope.kinds.get(entry.coordinate) != "input")
    if entries or not motion:
        return entries
    return tuple(MotionEntry(name, ZERO, ZERO, motion[0].span) for name in reading.scope.of_kind("coordinate"))


def _is_coordinate(key: Scalar, what: str, node: Node | None, reading: Reading, *more: str) -> bool:
    return reading.scope.check_key(key.span, key.text, keys_of(node), Allowed(what, ("coordinate", *more)))


def read_notation(node: Node | None, reading: Reading) -> tuple[Notation, ...]:
    """Symbols in order: each may use parameters and the symbols above it."""
    allowed = Allowed("a notation", ("parameter", "notation"))
    declared = read_in_order(node, "'notation'", allowed, reading, lambda _: "notation")
    return tuple(Notation(*item) for item in declared)


def read_in_order(
    node: Node | None, what: str, allowed: Allowed, reading: Reading, kind_of: Callable[[Expression], str]
) -> Iterator[tuple[str, Expression, Span]]:
    """Name, value and place of entries, each of which may use those above it."""
    entries = [] if node is None else list(reading.entries(node, what))
    reading.scope.later = {entry.key.text for entry in entries}
    for entry in entries:
        errors = reading.errors
        value = reading.expression(entry.value, allowed)
        if reading.scope.declare(entry.key.text, kind_of(value), entry.key.span) and reading.errors == errors:
            yield entry.key.text, value, entry.key.span
        reading.scope.later.discard(entry.key.text)


#: Variables that a description declares besides its coordinates.
DECLARED = ("speed", "unit vector", "quaternion")


def read_initial(node: Node | None, reading: Reading) -> tuple[tuple[InitialValue, ...], tuple[InitialValue, ...]]:
    """``theta: 0.1`` or ``theta: {position: 0.1, velocity: 0}``; apart from these ``p: 0.1`` of declared variables."""
    allowed = Allowed("an initial value")
    entries: list[InitialValue] = []
    own: list[InitialValue] = []
    declared = [kind for kind in DECLARED if reading.scope.of_kind(kind)]
    example = ", ".join(f"{name}: 0" for name in reading.scope.of_kind("coordinate")[:3])
    hint = Message("write {[[example]]}", example=example) if example else None
    for entry in () if node is None else reading.entries(node, "'initial'", hint):
        known = _is_coordinate(entry.key, "the key of an initial value", node, reading, *declared)
        span: Span = entry.key.span
        if isinstance(entry.value, Mapping):
            fields = reading.fields(
                entry.value, Message("the initial value of [[what]]", what=ascii_safe(entry.key.text)), INITIAL
            )
            position, velocity = fields.expression("position", allowed), fields.expression("velocity", allowed)
            if not fields.entries:
                reading.error(
                    "missing-key", "[[what]] has neither 'position' nor 'velocity'", span, what=worded(fields.what)
                )
        else:
            position, velocity = reading.expression(entry.value, allowed), None
        if known and reading.scope.kind_of(entry.key.text) in DECLARED:
            if velocity is not None:
                message = Message(
                    "'[[what]]' has a value at t = 0 and no velocity: that follows from the equations",
                    what=entry.key.text,
                )
                reading.error("misplaced-key", message, span, f"{entry.key.text}: 0.1")
            own.append(InitialValue(entry.key.text, position, None, span))
        elif known:
            entries.append(InitialValue(entry.key.text, position, velocity, span))
    return tuple(entries), tuple(own)


def read_limits(node: Node | None, reading: Reading) -> tuple[Limit, ...]:
    """``q1: [-pi, pi]``."""
    allowed = Allowed("a limit")
    limits = []
    for entry in () if node is None else reading.entries(node, "'limits'"):
        known = _is_coordinate(entry.key, "the key of a limit", node, reading)
        items = reading.items(entry.value, Message("the limits of [[what]]", what=ascii_safe(entry.key.text)))
        if len(items) != 2:
            if isinstance(entry.value, Sequence):
                reading.error("wrong-shape", "limits are two: the least and the greatest value", entry.value.span)
            continue
        lower, upper = (reading.expression(item, allowed) for item in items)
        least, most = rational(lower), rational(upper)
        if least is not None and most is not None and least >= most:
            reading.error("wrong-shape", "the first limit is the least value", entry.value.span, "exchange the two")
        if known:
            limits.append(Limit(entry.key.text, lower, upper, entry.key.span))
    return tuple(limits)


# The small parameter of a description: its name, powers of it in parameters, fast and slow variables.


_PARAMETER = Allowed("the small parameter", ("parameter",))
_KINDS = ("coordinate", "speed", "unit vector", "quaternion")
_SCALED = Allowed("what stands for a power of the small parameter", ("parameter", *_KINDS))
HINT = "write 'small parameter: eps', or 'small parameter: {eps: {powers: {e: 1, p2: -1}}}'"


def read_small(node: Node | None, reading: Reading, used: frozenset[str]) -> SmallParameter | None:
    """``eps``, or ``{eps: {powers: {e: 1}, fast: [x, y], slow: [p]}}``; ``used`` are the names that formulas hold."""
    if node is None:
        return None
    if isinstance(node, Scalar):
        errors = reading.errors
        reading.scope.check_name(node.text, node.span, _PARAMETER)
        if reading.errors == errors:
            _check_used(node.text, node, reading, used)
        return SmallParameter(node.text, span=node.span) if reading.errors == errors else None
    if not isinstance(node, Mapping) or len(node.entries) != 1:
        reading.shape_error(node, "the small parameter", "one name", HINT)
        return None
    entry = node.entries[0]
    name, errors = entry.key.text, reading.errors
    fields = reading.fields(
        entry.value, Message("the small parameter [[name]]", name=ascii_safe(name)), SMALL_PARAMETER, HINT
    )
    if not isinstance(entry.value, Mapping):  # the name is not what is wrong
        return None
    powers_node = fields.get("powers")
    powers = () if powers_node is None else tuple(_powers(powers_node, name, reading, used))
    if powers_node is None:
        reading.scope.check_name(name, entry.key.span, _PARAMETER)
        if reading.errors == errors:
            _check_used(name, entry.key, reading, used)
    else:
        reading.scope.is_name(name, entry.key.span)
        if name in reading.scope.kinds:
            message = Message(
                "[[name]] is declared already: with 'powers' the small parameter is a name of its own",
                name=ascii_safe(name),
            )
            reading.error("misplaced-name", message, entry.key.span, "choose another name, or leave 'powers' out")
        elif not powers and reading.errors == errors:
            reading.shape_error(powers_node, "'powers'", "a parameter with a power of the small one", HINT)
    fast = tuple(_variables(fields.get("fast"), "fast", reading))
    slow = tuple(_variables(fields.get("slow"), "slow", reading))
    for other in slow:
        if other in fast:
            message = Message("[[other]] is declared both fast and slow", other=ascii_safe(other))
            reading.error("conflicting-keys", message, entry.key.span, "leave it out of one of the two lists")
    leading = _leading(fields.get("leading"), reading)
    return SmallParameter(name, powers, fast, slow, leading, entry.key.span) if reading.errors == errors else None


def _check_used(name: str, where: Scalar, reading: Reading, used: frozenset[str]) -> None:
    if name not in used:
        message = Message(
            "the small parameter [[name]] occurs in no formula of bodies, loads or relations", name=ascii_safe(name)
        )
        reading.error("unused-name", message, where.span, "there is nothing to expand in it; see also 'powers'")


def _powers(node: Node, small: str, reading: Reading, used: frozenset[str]) -> Iterator[tuple[str, int]]:
    for entry in reading.entries(node, "'powers'"):
        errors = reading.errors
        reading.scope.check_name(entry.key.text, entry.key.span, _SCALED)
        if reading.errors == errors and reading.scope.kinds.get(entry.key.text) == "parameter":
            _check_used(entry.key.text, entry.key, reading, used)
        power = _power(entry, reading)
        if power is not None and reading.errors == errors:
            yield entry.key.text, power


def _power(entry: Entry, reading: Reading) -> int | None:
    text = entry.value.text.strip() if isinstance(entry.value, Scalar) else ""
    digits = text.removeprefix("-").removeprefix("+")
    if not digits.isascii() or not digits.isdigit() or not 1 <= int(digits[:9]) <= MOST_POWER:
        message = Message(
            "the power of [[what]] is no whole number from 1 to [[most]], or its negative",
            what=ascii_safe(entry.key.text),
            most=MOST_POWER,
        )
        reading.error("bad-number", message, entry.value.span, HINT)
        return None
    return int(text)


def _leading(node: Node | None, reading: Reading) -> str:
    scalar = None if node is None else reading.scalar(node, "'leading'")
    if scalar is None:
        return ""
    if reading.scope.kinds.get(scalar.text) not in _KINDS:
        _no_variable(scalar, _KINDS, reading)
    return scalar.text


def _no_variable(scalar: Scalar, kinds: tuple[str, ...], reading: Reading) -> None:
    """Complains, and tells the names of these kinds."""
    known = ", ".join(n for n, k in reading.scope.kinds.items() if k in kinds)
    message = Message("[[what]] is no variable", what=ascii_safe(scalar.text))
    hint = Message("variables are coordinates and speeds: [[known]]", known=known)
    reading.error("unknown-name", message, scalar.span, hint)


def _variables(node: Node | None, what: str, reading: Reading) -> Iterator[str]:
    seen: set[str] = set()
    for item in () if node is None else reading.items(node, f"'{what}'"):
        scalar = reading.scalar(item, Message("a [[what]] variable", what=what))
        if scalar is None:
            continue
        kind = reading.scope.kinds.get(scalar.text)
        if kind not in _KINDS:
            _no_variable(scalar, ("coordinate", "speed"), reading)
        elif scalar.text in seen:
            reading.error("repeated-name", "[[what]] is listed twice", scalar.span, what=ascii_safe(scalar.text))
        else:
            seen.add(scalar.text)
            yield scalar.text
