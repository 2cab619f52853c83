"""The small parameter of a description: its name, powers of it in parameters, fast and slow variables."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.message import Message
from mbsym.expressions.parser import ascii_safe
from mbsym.model.system import SmallParameter
from mbsym.source.keys import MOST_POWER, SMALL_PARAMETER
from mbsym.source.placed import Entry, Mapping, Node, Scalar
from mbsym.source.reading import Reading
from mbsym.source.scope import Allowed

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
    given = fields.get("powers")
    powers = () if given is None else tuple(_powers(given, name, reading, used))
    if given is None:
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
            reading.shape_error(given, "'powers'", "a parameter with a power of the small one", HINT)
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
        known = ", ".join(n for n, k in reading.scope.kinds.items() if k in _KINDS)
        message = Message("[[what]] is no variable", what=ascii_safe(scalar.text))
        reading.error(
            "unknown-name",
            message,
            scalar.span,
            Message("variables are coordinates and speeds: [[known]]", known=known),
        )
    return scalar.text


def _variables(node: Node | None, what: str, reading: Reading) -> Iterator[str]:
    seen: set[str] = set()
    for item in () if node is None else reading.items(node, f"'{what}'"):
        scalar = reading.scalar(item, Message("a [[what]] variable", what=what))
        if scalar is None:
            continue
        kind = reading.scope.kinds.get(scalar.text)
        if kind not in _KINDS:
            known = ", ".join(n for n, k in reading.scope.kinds.items() if k in ("coordinate", "speed"))
            message = Message("[[what]] is no variable", what=ascii_safe(scalar.text))
            reading.error(
                "unknown-name",
                message,
                scalar.span,
                Message("variables are coordinates and speeds: [[known]]", known=known),
            )
        elif scalar.text in seen:
            reading.error(
                "repeated-name", Message("[[what]] is listed twice", what=ascii_safe(scalar.text)), scalar.span
            )
        else:
            seen.add(scalar.text)
            yield scalar.text
