"""What every part of the builder does with a node: demand a shape, read a word, a text, an expression, a vector.

Each reader complains and returns a harmless stand-in (zero, an empty text), so that reading goes on and one run finds
every mistake; a System is only returned when there was none.
"""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

from mbsym.expressions.constants import out_of_range, unsupported_power, value
from mbsym.expressions.message import Message, worded
from mbsym.expressions.parser import NO_TABLES, ascii_safe, decimal_comma, in_latin, names_apart, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import ZERO, Call, Expression, Name, names, walk
from mbsym.model.system import Vector
from mbsym.model.units import Declared
from mbsym.source import placed
from mbsym.source.grammar import Key, Word
from mbsym.source.keys import ALIASES, MEANT, UNSUPPORTED, spellings
from mbsym.source.placed import Entry, Node, Scalar, Sequence
from mbsym.source.scope import Allowed, Scope, closest, did_you_mean

MAX_ENTRIES = 500
MAX_FREE_TEXT = 4_000
MAX_SHOWN = 60

_TWO_IN_ONE = re.compile(r"(?<=[\w)])\s+(?=[-+]?[\w(])")

ZERO_VECTOR: Vector = (ZERO, ZERO, ZERO)


def comma_hint(items: tuple[Node, ...], count: int) -> str | None:
    """What may be wrong with the commas of a list that has not as many items as it should have."""
    texts = [item.text if isinstance(item, Scalar) else "" for item in items]
    if len(texts) < count:
        if any(";" in text for text in texts):
            return "components are separated by commas"
        double = next((text for text in texts if _TWO_IN_ONE.search(text) and len(text) <= MAX_SHOWN), None)
        return double and Message("is a comma missing: [[written]]?", written=_TWO_IN_ONE.sub(", ", double))
    tight = [isinstance(second, Scalar) and _is_decimal_comma(first, second) for first, second in pairwise(items)]
    return "numbers have a decimal point: write 0.5 for 0,5" if any(tight) and not all(tight) else None


def _filled_hint(items: tuple[Node, ...]) -> str | None:
    """Components that were left out, most likely because the motion is planar, are zeros."""
    texts = [item.text.strip() if isinstance(item, Scalar) else "" for item in items]
    if len(texts) > 2 or any(not text or len(text) > MAX_SHOWN for text in texts):
        return None
    return Message(
        "components along the axes 1, 2, 3: for example [[[written]]]",
        written=", ".join([*texts, *["0"] * (3 - len(texts))]),
    )


def _as_mapping(node: Node) -> Message | None:
    """``{m: 1, l: 2}`` for ``m = 1 l = 2``, where every name has its value, and for ``[m: 1, l: 2]``."""
    pairs: list[tuple[str, str]] = []
    if isinstance(node, Scalar) and len(node.text) <= 3 * MAX_SHOWN:
        first, *parts = _ASSIGNED.split(node.text)
        pairs = [(name, value.strip(" \n,;")) for name, value in zip(parts[::2], parts[1::2], strict=True)]
        if first.strip() or not all(_is_expression(value) for _, value in pairs):
            return None
    elif isinstance(node, Sequence):
        entries = [
            item.entries[0] for item in node.items if isinstance(item, placed.Mapping) and len(item.entries) == 1
        ]
        values = [entry.value.text for entry in entries if isinstance(entry.value, Scalar)]
        if len(values) == len(node.items):
            pairs = [(entry.key.text, value) for entry, value in zip(entries, values, strict=True)]
    written = ", ".join(f"{name}: {value}" for name, value in pairs)
    return Message("write {[[example]]}", example=written) if pairs and len(written) <= 3 * MAX_SHOWN else None


#: A name that is given a value.
_ASSIGNED = re.compile(r"([A-Za-z]\w*)\s*=(?!=)")

#: So many keys that are all unknown are one mistake, of more each is; so many are told where there are none.
MOST_OTHER = 8

#: What should have been two: a key, and its value behind an equals sign or a colon without a blank.
_KEY_AND_VALUE = re.compile(r"\s*([A-Za-z][\w' -]*?)\s*[:=]\s*(\S.*?)\s*", re.DOTALL)

#: A list in other brackets, or as a function of other programs: (a, b, c), diag(a, b, c), vector(a, b, c).
_BRACKETED = re.compile(r"(?:diag|diagonal|vec|vector|array|list|tuple|Matrix)?\s*[(\[{]+(.*?)[)\]}]+\Z", re.DOTALL)


def _bare_list(node: Node, count: int) -> str | None:
    """``a, b, c`` for a text that holds so many expressions between commas, whatever stands around them."""
    text = node.text.strip() if isinstance(node, Scalar) else ""
    bare = _BRACKETED.sub(r"\1", text)
    for parts in (text.split(","), bare.split(","), bare.split()):
        parts = [part.strip() for part in parts]
        if len(parts) == count and len(text) <= 3 * MAX_SHOWN and all(map(_is_expression, parts)):
            return ", ".join(parts)
    return None


def _is_expression(text: str) -> bool:
    return parse_expression(text, Complaints(), lambda _start, _end: Span(1, 1)) is not None


def _by_axis(node: Node, known: Container[str]) -> str | None:
    """``0, -l, 0`` for ``{y: -l}``, ``0, -1, 0`` for the axis ``-y``, and ``0, -y, 0`` where that is a known name."""
    if isinstance(node, placed.Mapping):
        written = {entry.key.text.strip(): entry.value for entry in node.entries}
        texts = {axis: value.text.strip() for axis, value in written.items() if isinstance(value, Scalar)}
        if texts and len(texts) == len(written) and set(texts) <= {*_AXES}:
            return ", ".join(texts.get(axis) or "0" for axis in _AXES)
    elif isinstance(node, Scalar) and (named := _AXIS.fullmatch(node.text.strip())):
        component = named[2] if named[2] in known else "1"
        return ", ".join(f"{named[1].strip('+')}{component}" if axis == named[2] else "0" for axis in _AXES)
    return None


_AXES = "xyz"
_AXIS = re.compile("([+-]?)([xyz])")


def _is_decimal_comma(whole: Node, decimals: Scalar) -> bool:
    """Whether nothing but a comma stands between two runs of digits."""
    if not isinstance(whole, Scalar) or not whole.literal or not re.fullmatch("[0-9]+", decimals.text):
        return False
    end = whole.place(len(whole.text), len(whole.text) + 2)
    return bool(re.fullmatch("[-+]?[0-9]+", whole.text)) and (end.line, end.column + 1) == (
        decimals.span.line,
        decimals.span.column,
    )


def keys_of(node: Node | None) -> list[str]:
    """The keys of a mapping."""
    return [entry.key.text for entry in node.entries] if isinstance(node, placed.Mapping) else []


def _is_empty(node: Node) -> bool:
    return isinstance(node, Scalar) and not node.text.strip()


@dataclass(slots=True)
class Reading:
    """The complaints and the declared names of one description; ``units`` are those that stand in records.

    ``folder`` is where the description is, if it is a file.  ``doubles``: numbers have to fit into such; not in claims.
    ``labelled``: keys are known to the reader by the labels of the editor's text.
    """

    complaints: Complaints
    scope: Scope
    units: list[Declared] = field(default_factory=list)
    folder: Path | None = None
    doubles: bool = True
    labelled: bool = False

    def error(self, code: str, message: str, span: Span | None = None, hint: str | None = None, **gaps: object) -> None:
        self.complaints.error(code, message, span, hint, **gaps)

    @property
    def errors(self) -> int:
        """How many errors there are so far: what was read without a new one is sound and may be judged."""
        return self.complaints.error_count

    def shape_error(self, node: Node, what: str, shape: str, hint: str | None = None) -> None:
        self.error(
            "wrong-shape",
            "[[what]] must be [[wanted]], not [[kind]]",
            node.span,
            hint,
            what=worded(what),
            wanted=worded(shape),
            kind=worded(placed.kind(node)),
        )

    def scalar(self, node: Node, what: str) -> Scalar | None:
        if not isinstance(node, Scalar):
            self.shape_error(node, what, "a single value")
            return None
        if not node.text.strip():
            self.error("missing-value", Message("[[what]] has no value", what=worded(what)), node.span)
            return None
        return node

    def free_text(self, node: Node, what: str) -> str:
        """Text for people: blanks and line ends are runs of one blank."""
        scalar = self.scalar(node, what)
        text = " ".join(scalar.text.split()) if scalar else ""
        if len(text) > MAX_FREE_TEXT:
            self.error(
                "too-long", "[[what]] has at most [[most]] characters", node.span, what=worded(what), most=MAX_FREE_TEXT
            )
        return text

    def word(self, node: Node, what: str, choices: Iterable[str]) -> str | None:
        """One of a few words."""
        scalar = self.scalar(node, what)
        if scalar is None:
            return None
        known = list(choices)
        word = " ".join(scalar.text.lower().split())
        if word in known:
            return word
        hint = did_you_mean(word, known) or Message("one of: [[known]]", known=", ".join(known))
        self.error(
            "bad-word",
            Message("[[what]] cannot be [[what2]]", what=worded(what), what2=ascii_safe(scalar.text)),
            scalar.span,
            hint,
        )
        return None

    def expression(self, node: Node, allowed: Allowed) -> Expression:
        """A parsed expression whose names are all allowed here; zero where something is wrong."""
        scalar = self.scalar(node, allowed.what)
        if scalar is None:
            return ZERO
        if self.scope.holds_no_name(scalar.text):
            return ZERO
        before = len(self.complaints.items)
        named = bool(allowed.kinds)
        tables = self.scope.tables if named else NO_TABLES
        tree = parse_expression(scalar.text, self.complaints, scalar.place, named, tables=tables)
        if tree is None:
            for name in names_apart(scalar.text, scalar.place, self.complaints.items[before:]):
                self.scope.check(name, allowed)
            if not scalar.text.isascii() and scalar.text.strip().isidentifier():
                self.scope.assumed.add(in_latin(scalar.text.strip()))  # as it is written elsewhere, or will be
            return ZERO
        self.scope.check(tree, allowed)
        if len(self.complaints.items) == before:
            self.check_range(tree, scalar)
        return tree

    def check_range(self, tree: Expression, scalar: Scalar) -> None:
        """Complains of a number that no double holds, where it is computed with, or of a power that is not computed."""
        if not self.doubles or isinstance(tree, Name):
            return
        exponent = unsupported_power(tree)
        if exponent is not None:
            message = Message("the power [[exponent]]: only whole and half exponents are supported", exponent=exponent)
            self.error(
                "no-number",
                message,
                scalar.span,
                Message("for 2**([[exponent]]) write exp(log(2)*[[exponent]])", exponent=exponent),
            )
        if names(tree) or any(isinstance(node, Call) and node.table for node in walk(tree)):
            return
        if value(tree) is None:
            self.error("no-number", "what this number is cannot be told: too many digits cancel", scalar.span)
        elif why := out_of_range(tree):
            self.error(
                "no-number",
                Message("nothing can be computed with this number: [[why]]", why=why),
                scalar.span,
                "take other units",
            )

    def vector(self, node: Node, allowed: Allowed) -> Vector:
        items = self.triple(node, allowed.what, kinds=allowed.kinds)
        if items is None:
            return ZERO_VECTOR
        return (
            self.expression(items[0], allowed),
            self.expression(items[1], allowed),
            self.expression(items[2], allowed),
        )

    def triple(self, node: Node, what: str, alike: bool = False, kinds: Container[str] = ()) -> tuple[Node, ...] | None:
        """The three items of a list of three, names of ``kinds``; ``alike``: a lone value is likely meant thrice."""
        if not isinstance(node, Sequence):
            bare, lone = _bare_list(node, 3), _bare_list(node, 1) if alike else None
            known = [name for name, kind in self.scope.kinds.items() if kind in kinds]
            bare = bare or (lone and ", ".join([lone] * 3)) or _by_axis(node, known)
            self.shape_error(node, what, "a list of three", Message("write [[[bare]]]", bare=bare or "0, 0, 0"))
            return None
        if len(node.items) != 3:
            message = Message("[[what]] has three components, not [[items]]", what=worded(what), items=len(node.items))
            self.error("wrong-shape", message, node.span, comma_hint(node.items, 3) or _filled_hint(node.items))
            return None
        return node.items

    def entries(self, node: Node, what: str, hint: str | None = None) -> Iterator[Entry]:
        """The entries of a mapping, each key once; ``hint`` is for what is no mapping."""
        if not isinstance(node, placed.Mapping):
            if isinstance(node, Scalar) and not node.text.strip():
                self.error(
                    "missing-value", "[[what]] is empty", node.span, hint or "leave the key out", what=worded(what)
                )
            else:
                self.shape_error(node, what, Message("a mapping (key: value)"), _as_mapping(node) or hint)
            return
        self._bounded(node, what, "[[what]] has at most [[most]] entries, not [[entries]]", entries=len(node.entries))
        seen: set[str] = set()
        for entry in self.with_values(self.with_decimals(node.entries)):
            key = ALIASES.get(entry.key.text, entry.key.text)
            if key in seen:
                self.error("repeated-key", "[[what]] is given twice", entry.key.span, what=ascii_safe(entry.key.text))
            else:
                seen.add(key)
                yield entry

    def with_decimals(self, entries: Iterable[Entry]) -> Iterator[Entry]:
        """Entries with ``{l: 0,5}``, which YAML takes for ``{l: 0, 5: }``, complained about and put together."""
        last: Entry | None = None
        for entry in entries:
            if last is not None and _is_decimal_comma(last.value, entry.key) and _is_empty(entry.value):
                assert isinstance(last.value, Scalar)
                whole, decimals = last.value.text, entry.key.text
                span = last.value.place(0, len(whole) + 1 + len(decimals))
                message = Message(
                    "here '[[whole]],[[decimals]]' is the number [[whole]] and a key [[decimals]]",
                    whole=whole,
                    decimals=decimals,
                )
                hint = decimal_comma(f"{whole.lstrip('+-')},{decimals}")
                self.error("bad-number", message, span, hint)
                last = Entry(last.key, Scalar(f"{whole}.{decimals}", span, literal=False))
                continue
            if last is not None:
                yield last
            last = entry
        if last is not None:
            yield last

    def with_values(self, entries: Iterable[Entry]) -> Iterator[Entry]:
        """Entries with ``{m:1}`` and ``{m = 1}``, which YAML takes for keys without values, complained about once."""
        blamed = False
        for entry in entries:
            key = entry.key
            parts = _KEY_AND_VALUE.fullmatch(key.text) if _is_empty(entry.value) else None
            if parts is None:
                yield entry
                continue
            if not blamed:
                message = Message("here [[written]] is a key without a value", written=ascii_safe(key.text))
                hint = "a key ends with a colon and a blank: write [[name]]: [[value]]"
                self.error("no-colon", message, key.span, Message(hint, name=parts[1], value=parts[2]))
                blamed = True
            yield Entry(key.part(*parts.span(1)), key.part(*parts.span(2)))

    def lone_or_items(self, node: Node, what: str) -> tuple[Node, ...]:
        """The items of a list; a single value is complained about and taken for a list of one."""
        if isinstance(node, Scalar) and node.text.strip():
            bare = _bare_list(node, node.text.count(",") + 1)
            self.shape_error(node, what, "a list", Message("write [[[bare]]]", bare=bare) if bare else None)
            parts = [node.text] if bare is None else bare.split(", ")
            return (node,) if len(parts) == 1 else tuple(Scalar(part, node.span, literal=False) for part in parts)
        return self.items(node, what)

    def items(self, node: Node, what: str) -> tuple[Node, ...]:
        if not isinstance(node, Sequence):
            self.shape_error(node, what, "a list")
            return ()
        self._bounded(node, what, "[[what]] has at most [[most]] items, not [[items]]", items=len(node.items))
        return node.items

    def _bounded(self, node: Node, what: str, text: str, **count: int) -> None:
        """Raises TooManyComplaints beyond ``MAX_ENTRIES``: without them every name would be unknown."""
        if max(count.values()) > MAX_ENTRIES:
            self.error("too-large", Message(text, what=worded(what), most=MAX_ENTRIES, **count), node.span)
            raise placed.TooManyComplaints

    def fields(
        self, node: Node, what: str, known: Mapping[str, Key], hint: str | None = None, unfit: Container[str] = ()
    ) -> Fields:
        """A mapping with a fixed set of keys; an unknown one is complained about and taken for what it resembles.

        None is taken for one of those that are ``unfit`` beside the others.
        """
        entries: dict[str, Entry] = {}
        misspelt: dict[str, Entry] = {}
        written_keys = keys_of(node)
        fitting = [key for key in known if key not in unfit]
        left = [key for key in fitting if key not in written_keys]
        other = self._other_keys(node, what, known)
        if hint is None and len(known) <= MOST_OTHER:
            hint = Message("the keys are: [[known]]", known=", ".join(known))
        for entry in () if other else self.entries(node, what, hint):
            key = ALIASES.get(entry.key.text, entry.key.text)
            if key in known:
                entries[key] = entry
            else:
                plural = entry.key.text.endswith("s") and entry.key.text[:-1] in left
                unsupported = None if plural else _unsupported(entry.key.text)
                guess = None if unsupported else _meant(entry.key.text, left)
                keys = (
                    Message("did you mean '[[other]]'?", other=guess)
                    if guess
                    else unsupported or Message("the keys are: [[known]]", known=", ".join(fitting))
                )
                message = Message(
                    "unknown key [[what]] in [[what2]]", what=ascii_safe(entry.key.text), what2=worded(what)
                )
                self.error("unknown-key", message, entry.key.span, keys)
                if guess:
                    misspelt[guess] = entry
        sound = isinstance(node, placed.Mapping) and not other
        return Fields(self, what, {**misspelt, **entries}, node.span, sound, known)

    def _other_keys(self, node: Node, what: str, known: Mapping[str, Key]) -> bool:
        """Whether all of several keys are those of something else, which is one mistake."""
        written = [entry.key for entry in node.entries] if isinstance(node, placed.Mapping) else []
        names = [ALIASES.get(key.text, key.text) for key in written]
        if not 2 <= len(names) <= MOST_OTHER or any(
            name in known or _unsupported(name) or _meant(name, known) for name in names
        ):
            return False
        message = Message(
            "[[what]] has none of the keys [[keys]]", what=worded(what), keys=", ".join(map(ascii_safe, names))
        )
        hint = Message("the keys are: [[known]]", known=", ".join(known))
        self.error("unknown-key", message, written[0].span, hint)
        return True


def _unsupported(key: str) -> Message | None:
    """What is said of a key that other programs have."""
    return UNSUPPORTED.get(_words(key))


def _meant(key: str, known: Iterable[str]) -> str | None:
    """The known key that is meant by another word, or that a misspelt one resembles."""
    known = list(known)
    meant = MEANT.get(_words(key))
    return meant if meant in known else closest(key, known)


def _words(key: str) -> str:
    return " ".join(key.lower().replace("_", " ").split())


@dataclass(slots=True)
class Fields:
    """The known keys of a mapping and their values; not ``sound`` where there was no mapping to read."""

    reading: Reading
    what: str
    entries: dict[str, Entry]
    span: Span
    sound: bool
    known: Mapping[str, Key]

    def get(self, key: str) -> Node | None:
        entry = self.entries.get(key)
        return None if entry is None else entry.value

    def require(self, key: str, hint: str | None = None) -> Node | None:
        """The value of a key that must be there; without a ``hint`` it is said what the key means."""
        node = self.get(key)
        if node is None and self.sound:
            label = (self.known[key].label if self.reading.labelled and key in self.known else "") or key
            if hint is None and key in self.known:
                hint = Message("[[key]]: [[meaning]]", key=ascii_safe(label), meaning=worded(self.known[key].meaning))
            self.reading.error(
                "missing-key",
                Message("[[what]] has no [[label]]", what=worded(self.what), label=ascii_safe(label)),
                self.span,
                hint,
            )
        return node

    def key_span(self, key: str) -> Span:
        return self.entries[key].key.span

    def text(self, key: str) -> str:
        node = self.get(key)
        return "" if node is None else self.reading.free_text(node, f"'{key}'")

    def word(self, key: str, what: str = "") -> str:
        """One of the words that the table of keys allows; empty where there is none."""
        node, of = self.get(key), self.known[key].type
        if node is None or not isinstance(of, Word):
            return ""
        words = [other for choice in map(str, of.choices) for other in (choice, *spellings(choice))]
        spelled = self.reading.word(node, what or f"'{key}'", words) or ""
        return ALIASES.get(spelled, spelled)

    def expression(self, key: str, allowed: Allowed) -> Expression | None:
        node = self.get(key)
        return None if node is None else self.reading.expression(node, allowed)

    def required_expression(self, key: str, allowed: Allowed, hint: str | None = None) -> Expression:
        node = self.require(key, hint)
        return ZERO if node is None else self.reading.expression(node, allowed)

    def exclude(self, key: str, others: Iterable[str], fitting: Iterable[str] = ()) -> None:
        """Complain about keys that make no sense beside another one, with those that are ``fitting``."""
        rest = [x for x in fitting if x not in self.entries]
        hint = Message("beside it may stand: [[keys]]", keys=", ".join(map(repr, rest))) if rest else None
        for other in others:
            if other in self.entries:
                message = Message("[[other]] does not go with [[key]]", other=ascii_safe(other), key=ascii_safe(key))
                self.reading.error("conflicting-keys", message, self.key_span(other), hint)
