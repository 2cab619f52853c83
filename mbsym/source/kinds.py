"""Loads and constraints, read by the table of their kinds: each key by its type, and what is made of them.

What a kind demands beyond its keys is its check, in ``mbsym.source.loads``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, Expression
from mbsym.model.system import INERTIAL, rational
from mbsym.source import grammar, placed
from mbsym.source.bodies import read_body_name
from mbsym.source.keys import ALIASES, UNSUPPORTED
from mbsym.source.placed import Entry, Node, Scalar, Sequence
from mbsym.source.reading import ZERO_VECTOR, Fields, Reading
from mbsym.source.scope import Allowed, closest

#: A kind that resembles a known one as much (1: equal) is a slip of the pen.
_MISSPELT = 0.75

#: Another word for the inertial frame, where no body is called so.
_GROUND = "ground"


@dataclass(frozen=True)
class Section:
    """A list of items of known kinds.

    ``meant``: other words and the kinds that they mean; ``example`` shows how an item is written, ``bare`` how one is
    of which only the text stands there; ``checks`` say what else is wrong with one and answer whether it is kept;
    ``hints`` of a value that is no mapping; ``others`` complain where the value is that of another kind, and answer
    whether it is.
    """

    what: str
    kinds: Mapping[str, grammar.Kind]
    example: str
    meant: Mapping[str, str]
    checks: Mapping[str, Callable[[Item, Any], bool]]
    hints: Mapping[str, Callable[[Node], str]] = field(default_factory=dict)
    others: Mapping[str, Callable[[Item], bool]] = field(default_factory=dict)
    bare: Callable[[str], str | None] | None = None

    def read(self, node: Node | None, bodies: list[str], reading: Reading) -> tuple[Any, ...]:
        """Every item, in its order."""
        nodes = () if node is None else reading.items(node, f"'{self.what}s'")
        values = (self._item(item_node, bodies, reading) for item_node in nodes)
        return tuple(value for value in values if value is not None)

    def _item(self, node: Node, bodies: list[str], reading: Reading) -> Any | None:
        if not isinstance(node, placed.Mapping) or len(node.entries) != 1:
            message = Message("a [[what]] is one key, its kind, with its data", what=worded(self.what))
            bare = isinstance(node, Scalar) and self.bare is not None and self.bare(node.text)
            reading.error(
                "wrong-shape", message, node.span, Message("write '- [[example]]'", example=bare or self.example)
            )
            return None
        entry = node.entries[0]
        name = self._kind(entry.key, reading)
        if name is None:
            return None
        item = Item(name, self.kinds[name], entry.key.span, entry.value, bodies, reading)
        if name in self.others and self.others[name](item):
            return None
        made = item.read(self.hints[name](entry.value) if name in self.hints else None)
        check = self.checks.get(name)
        return made if made is None or check is None or check(item, made) else None

    def _kind(self, key: Scalar, reading: Reading) -> str | None:
        """The kind that a key says; one that is misspelt is read as what it resembles, for what else may be wrong."""
        kind = ALIASES.get(key.text, key.text)
        if kind in self.kinds:
            return kind
        word = " ".join(kind.lower().replace("_", " ").split())
        other = self.meant.get(word)
        unsupported = None if other else UNSUPPORTED.get(word)
        misspelt = None if unsupported else closest(kind, self.kinds, _MISSPELT)
        hint = Message("the kinds of [[what]] are: [[kinds]]", what=worded(self.what), kinds=", ".join(self.kinds))
        if other:
            text = "did you mean [[other]]? The kinds of [[what]] are: [[kinds]]"
            hint = Message(text, other=other, what=worded(self.what), kinds=", ".join(self.kinds))
        way = Message("did you mean '[[other]]'?", other=misspelt) if misspelt else unsupported or hint
        message = Message("unknown kind of [[what]] [[kind]]", what=worded(self.what), kind=ascii_safe(key.text))
        reading.error(f"unknown-{self.what}", message, key.span, way)
        return misspelt


@dataclass(slots=True)
class Item:
    """One load or constraint being read: its kind, place and value, and the names of the bodies.

    ``values`` are those of its keys, ``sound`` the keys that are there and were read without a complaint; of a kind
    without keys the value is that of "".
    """

    name: str
    kind: grammar.Kind
    span: Span
    value: Node
    bodies: list[str]
    reading: Reading
    fields: Fields | None = None
    values: dict[str, Any] = field(default_factory=dict)
    sound: set[str] = field(default_factory=set)

    def read(self, hint: str | None) -> Any | None:
        """What is made of it; None where there is nothing to make it of."""
        if not isinstance(self.kind.type, grammar.Record):
            errors = self.reading.errors
            self._keep("", self._value(self.kind.type, self.value, f"'{self.name}'"), errors)
            return self._made(self.kind.ways[0], {"": self.kind.type})
        self.fields = self.reading.fields(self.value, f"'{self.name}'", self.kind.keys, hint)
        way = self._way(self.fields)
        for key in self.kind.keys:
            if key in way.keys if way is not None else all(key in other.keys for other in self.kind.ways):
                self._read_key(self.fields, key, self.kind.keys[key])
        return None if way is None else self._made(way, {key: self.kind.keys[key].type for key in way.keys})

    def _made(self, way: grammar.Way, types: Mapping[str, grammar.Type]) -> Any | None:
        """What is made of the values: of two ends or sides, two of its fields are."""
        values: list[Any] = []
        for key, of in types.items():
            value = self.values[key]
            if isinstance(of, grammar.Ends | grammar.Equation):
                if value is None:
                    return None
                values += value
            else:
                values.append(value)
        return way.of(values, self.span)

    def key_error(self, code: str, message: str, key: str, hint: str | None = None) -> None:
        """A complaint about a key that is there."""
        assert self.fields is not None
        self.reading.error(code, message, self.fields.key_span(key), hint)

    def value_error(self, code: str, message: str, key: str, hint: str | None = None) -> None:
        """A complaint about the value of a key that is there."""
        assert self.fields is not None
        self.reading.error(code, message, self.fields.entries[key].value.span, hint)

    def warning(self, code: str, message: str, key: str, hint: str | None = None) -> None:
        assert self.fields is not None
        self.reading.complaints.warning(code, message, self.fields.key_span(key), hint)

    def _way(self, fields: Fields) -> grammar.Way | None:
        """The last of the ways whose first key is there; what belongs to others does not go with it."""
        ways = self.kind.ways
        if len(ways) == 1:
            return ways[0]
        matching = [way for way in ways if way.keys[0] in fields.entries]
        if not matching:
            names = " nor ".join(f"'{way.keys[0]}'" for way in ways)
            if fields.sound:  # else there was no mapping
                self.reading.error(
                    "missing-key", "[[what]] has neither [[names]]", fields.span, what=worded(fields.what), names=names
                )
            return None
        fitting = matching[-1].keys
        fields.exclude(fitting[0], (key for key in self.kind.keys if key not in fitting), fitting)
        return matching[-1]

    def _read_key(self, fields: Fields, name: str, key: grammar.Key) -> None:
        node = fields.require(name) if key.required else fields.get(name)
        if node is not None:
            errors = self.reading.errors
            self._keep(name, self._value(key.type, node, f"'{name}'"), errors)
        elif key.required:
            self.values[name] = _nothing(key.type)
        else:
            self.values[name] = self.values[key.default.key] if isinstance(key.default, grammar.Same) else key.default

    def _keep(self, name: str, value: Any, errors: int) -> None:
        self.values[name] = value
        if self.reading.errors == errors:
            self.sound.add(name)

    def _value(self, value_type: grammar.Type, node: Node, what: str) -> Any:
        """The value of a node; where something is wrong with it, what can be gone on with, or None."""
        match value_type:
            case grammar.Formula(allowed):
                return self.reading.expression(node, allowed)
            case grammar.Vector(allowed, direction):
                return self._vector(node, allowed, direction)
            case grammar.BodyName():
                return self._body(node, value_type, what)
            case grammar.Name(of):
                scalar = self.reading.scalar(node, what)
                if scalar is not None:
                    self.reading.scope.check_name(scalar.text, scalar.span, Allowed(what, (of,)))
                return "" if scalar is None else scalar.text
            case grammar.Word(choices):
                known = {str(choice): choice for choice in choices}
                return known.get(self.reading.word(node, what, known) or "", choices[0])
            case grammar.Ends(record):
                return self._ends(node, record, what)
            case grammar.Equation():
                return self._equation(node, value_type)
            case grammar.Named(grammar.Formula(allowed), of):
                return self._named(node, allowed, of)
        raise TypeError(f"{what} has no reader")

    def _vector(self, node: Node, allowed: Allowed, direction: bool) -> Any:
        errors = self.reading.errors
        vector = self.reading.vector(node, allowed)
        if direction and self.reading.errors == errors and all(x == ZERO or rational(x) == 0 for x in vector):
            self.reading.error("bad-direction", "an axis has a direction: this one is zero", node.span)
        return vector

    def _body(self, node: Node, body_name: grammar.BodyName, what: str) -> str:
        """A body by its name; ``ground`` is the inertial frame where that may be and no body is called so."""
        written = node.text.strip() if isinstance(node, Scalar) else ""
        if body_name.ground and written == _GROUND and _GROUND not in self.bodies:
            return INERTIAL
        if body_name.moving and written == INERTIAL:
            self.reading.error("unknown-body", "a force on the inertial frame 0 does nothing", node.span)
        return read_body_name(node, what, self.bodies, self.reading) or INERTIAL

    def _ends(self, node: Node, record: grammar.Record, what: str) -> tuple[Any, Any] | None:
        """The two ends in a list of two."""
        vector = "[0, 0, 1]" if record.called == "axis" else "[0, 0, 0]"
        hint = f"[{', '.join(f'{{body: {body}, {record.called}: {vector}}}' for body in 'AB')}]"
        if not isinstance(node, Sequence):
            self.reading.shape_error(node, what, "a list", hint)
            return None
        items = self.reading.items(node, what)
        if len(items) == 2:
            return self._end(items[0], record), self._end(items[1], record)
        message = Message("[[what]] wants two items, not [[items]]", what=worded(what), items=len(items))
        self.reading.error("wrong-shape", message, node.span, hint)
        return None

    def _end(self, node: Node, record: grammar.Record) -> Any:
        assert record.made is not None
        article = "an" if record.called[0] in "aeiou" else "a"
        fields = self.reading.fields(node, f"{article} {record.called}", record.keys)
        values = []
        for name, key in record.keys.items():
            inner = fields.require(name)
            values.append(_nothing(key.type) if inner is None else self._value(key.type, inner, f"'{name}'"))
        return record.made(*values)

    def _equation(self, node: Node, equation: grammar.Equation) -> tuple[Expression, Expression] | None:
        """``left = right``; without an equals sign the expression is meant to be zero, and that is complained about."""
        scalar = self.reading.scalar(node, f"'{self.name}'")
        if scalar is None:
            return None
        written = scalar.text.replace("==", " =")  # one sign for one equation, every place kept
        signs = [k for k, character in enumerate(written) if character == "="]
        if len(signs) != 1:
            how = "no '='" if not signs else "more than one '='"
            message = Message("a [[name]] is one equation, and this has [[how]]", name=self.name, how=how)
            self.reading.error(
                "bad-equation", message, scalar.span, Message("write for example [[example]]", example=equation.example)
            )
            return None
        whole = Scalar(written, scalar.span, scalar.literal)
        sides = [whole.part(0, signs[0]), whole.part(signs[0] + 1, len(written))]
        errors = self.reading.errors
        left, right = (self.reading.expression(side, equation.allowed) for side in sides)
        return (left, right) if self.reading.errors == errors else None

    def _named(self, node: Node, allowed: Allowed, of: str) -> tuple[tuple[str, Expression], ...]:
        """Pairs of a name and an expression."""
        pairs = []
        entries = list(self.reading.entries(node, f"'{self.name}'"))
        known = self.reading.scope.of_kind(of)
        if spelled := _spelled_out(entries, known, of):
            text = "the key is the [[of]] itself: write [[spelled]]: and then [[what]]"
            what = worded("the force" if allowed.what == "a force" else allowed.what)
            hint = Message(text, of=worded(of), spelled=spelled, what=what)
            message = Message("unknown key '[[of]]' of a [[name]]", of=of, name=self.name)
            self.reading.error("unknown-key", message, entries[0].key.span, hint)
            return ()
        for entry in entries:
            key = Allowed(f"the key of a {self.name}", (of,))
            sound = self.reading.scope.check_name(entry.key.text, entry.key.span, key)
            value = self.reading.expression(entry.value, allowed)
            if sound:
                pairs.append((entry.key.text, value))
        return tuple(pairs)


def _spelled_out(entries: list[Entry], known: Any, of: str) -> str:
    """The coordinate of {coordinate: x, ...: force}, as other loads have it; empty for what is none."""
    if len(entries) != 2 or entries[0].key.text != of or of in known:
        return ""
    value = entries[0].value
    return value.text if isinstance(value, Scalar) and value.text in known else ""


def _nothing(value_type: grammar.Type) -> Any:
    """What stands for a value that is not there."""
    match value_type:
        case grammar.Formula():
            return ZERO
        case grammar.Vector():
            return ZERO_VECTOR
        case grammar.BodyName():
            return INERTIAL
        case grammar.Name():
            return ""
    return None
