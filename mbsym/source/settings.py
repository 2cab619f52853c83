"""What is asked of a system: relations, assumptions, unperturbed motion, notation, initial state."""

from __future__ import annotations

import re

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression, names
from mbsym.model.system import Assumption, InitialValue, Limit, MotionEntry, Notation, Relation, rational
from mbsym.source.keys import INITIAL, MOTION
from mbsym.source.placed import Mapping, Node, Scalar, Sequence
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
    """Peel off relations that depend on no other one; those that remain depend on themselves."""
    needs = {relation.name: names(relation.value) for relation in relations}
    while free := [name for name, needed in needs.items() if not needed & needs.keys()]:
        for name in free:
            del needs[name]
    for relation in relations:
        if relation.name in needs and _reaches(relation.name, needs):
            message = Message("'[[name]]' depends on itself through the relations", name=relation.name)
            reading.error("relation-cycle", message, relation.span)


def _reaches(name: str, needs: dict[str, set[str]]) -> bool:
    seen: set[str] = set()
    pending = [name]
    while pending:
        for needed in needs.get(pending.pop(), set()):
            if needed == name:
                return True
            if needed not in seen:
                seen.add(needed)
                pending.append(needed)
    return False


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
    allowed = Allowed("an unperturbed motion")
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
            value = fields.expression("value", allowed) or ZERO
            rate = fields.expression("rate", allowed) or ZERO
            if "rate" in keys_of(entry.value) and reading.scope.kinds.get(entry.key.text) == "input":
                message = Message(
                    "the input [[what]] is constant on the unperturbed motion", what=ascii_safe(entry.key.text)
                )
                reading.error("misplaced-key", message, fields.key_span("rate"), "leave 'rate' out")
        else:
            value = reading.expression(entry.value, allowed)
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
    notation = []
    allowed = Allowed("a notation", ("parameter", "notation"))
    entries = [] if node is None else list(reading.entries(node, "'notation'"))
    reading.scope.later = {entry.key.text for entry in entries}
    for entry in entries:
        errors = reading.errors
        value = reading.expression(entry.value, allowed)
        if reading.scope.declare(entry.key.text, "notation", entry.key.span) and reading.errors == errors:
            notation.append(Notation(entry.key.text, value, entry.key.span))
        reading.scope.later.discard(entry.key.text)
    return tuple(notation)


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
            if not fields.found:
                reading.error(
                    "missing-key",
                    Message("[[what]] has neither 'position' nor 'velocity'", what=worded(fields.what)),
                    span,
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
