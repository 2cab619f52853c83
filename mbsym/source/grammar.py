"""What the value of a key may be: the types of which ``mbsym.source.keys`` makes the table of all keys.

A type says what a value looks like and which names it holds.  The JSON Schema, completion, hover, renaming, the
editor's text go by it; so do the reader and the writers of loads and constraints.

They are compared by identity, and not printed: dataclasses that are take ten times as long to make, and every command
makes these.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields
from typing import Any

from mbsym.expressions.place import Span
from mbsym.source.scope import Allowed


class Type:
    """What a value may be."""


@dataclass(eq=False, repr=False)
class Formula(Type):
    """An expression in the names that are ``allowed``."""

    allowed: Allowed = Allowed("a formula")


@dataclass(eq=False, repr=False)
class Vector(Type):
    """Three expressions, which with ``direction`` are not all zero."""

    allowed: Allowed = Allowed("a vector")
    direction: bool = False


@dataclass(eq=False, repr=False)
class Equation(Type):
    """An equation or inequality between expressions; ``example`` is one."""

    allowed: Allowed = Allowed("an equation")
    example: str = ""


@dataclass(eq=False, repr=False)
class BodyName(Type):
    """The name of a body, or 0; in the editor's text its number.

    ``new``: it is declared here; ``moving``: it is not 0; ``ground``: 0 may be called so.
    """

    new: bool = False
    moving: bool = False
    ground: bool = False


@dataclass(eq=False, repr=False)
class Name(Type):
    """A name that formulas may hold; ``of`` is its kind.  One with ``own`` means something here only."""

    of: str = ""
    own: bool = False


@dataclass(eq=False, repr=False)
class Index(Type):
    """A coordinate or a number from 1 on."""


@dataclass(eq=False, repr=False)
class About(Type):
    """What a claim is about: an expression, a coordinate, or a body, by the kind of the claim."""


@dataclass(eq=False, repr=False)
class Word(Type):
    """One of a few words or numbers."""

    choices: tuple[str | int, ...]


@dataclass(eq=False, repr=False)
class Integer(Type):
    """A whole number."""

    least: int
    most: int | None = None


@dataclass(eq=False, repr=False)
class Figure(Type):
    """A number, perhaps as an expression without names."""


@dataclass(eq=False, repr=False)
class Text(Type):
    """Text for people: a name may be 2024 or yes, and nobody needs quotes for it."""


@dataclass(eq=False, repr=False)
class Unit(Type):
    """A unit, such as kg*m^2 or 1; of a file its column."""


@dataclass(eq=False, repr=False)
class String(Type):
    """What is taken letter by letter."""

    longest: int | None = None


@dataclass(eq=False, repr=False)
class Flag(Type):
    """true, or false where that may be said."""

    false: bool = False


@dataclass(eq=False, repr=False)
class Nothing(Type):
    """No value."""


@dataclass(eq=False, repr=False)
class Listed(Type):
    """A list of values of one type."""

    item: Type
    least: int = 0
    most: int | None = None
    unique: bool = False


@dataclass(eq=False, repr=False)
class Named(Type):
    """A mapping whose keys are names that the author chooses (``of`` coordinates, say); ``one``: of one entry."""

    value: Type
    of: str = ""
    one: bool = False


@dataclass(eq=False, repr=False)
class Either(Type):
    """Any of several types; ``called`` so in the schema."""

    types: tuple[Type, ...]
    called: str = ""


@dataclass(eq=False, repr=False)
class Way:
    """One way in which a kind is given, and what is made of it.

    ``made`` has a field for each of ``keys`` in their order (of two ends or sides two fields), those of ``fixed``, and
    ``span``; where its fields are others, ``make`` makes it of the values and ``parts`` gives them back.  Without
    ``parts`` nothing is written in this way.  A kind that has no keys is its value.
    """

    made: type[Any]
    keys: tuple[str, ...] = ()
    words: str = ""
    fixed: tuple[tuple[str, str], ...] = ()
    make: Callable[..., Any] | None = None
    parts: Callable[[Any], tuple[Any, ...]] | None = None

    def of(self, values: Iterable[Any], span: Span) -> Any:
        """What is made of values."""
        return (self.make or self.made)(*values, span=span, **dict(self.fixed))

    def writes(self, made: Any) -> bool:
        return (
            type(made) is self.made
            and (self.make is None or self.parts is not None)
            and all(getattr(made, name) == value for name, value in self.fixed)
        )

    def values(self, made: Any) -> tuple[Any, ...]:
        """What it was made of."""
        if self.parts is not None:
            return self.parts(made)
        apart = ("span", "as_written", *dict(self.fixed))
        return tuple(getattr(made, field.name) for field in fields(made) if field.name not in apart)


@dataclass(eq=False, repr=False)
class Record(Type):
    """A mapping with a fixed set of keys.

    ``title`` is what it is called where it is explained, ``called`` its name in the schema, ``alone`` the key of a
    value that stands alone, ``one_of`` are keys of which one is there, ``made`` is what is made of its values.
    """

    keys: Mapping[str, Key]
    title: str = ""
    called: str = ""
    alone: str | None = None
    one_of: tuple[str, ...] = ()
    made: type[Any] | None = None


@dataclass(eq=False, repr=False)
class Kinds(Type):
    """A mapping with one key, which says the kind of the value; ``called`` so in the schema."""

    kinds: Mapping[str, Kind]
    called: str


@dataclass(eq=False, repr=False)
class Ends(Type):
    """Two records that name a body each, and a ``point`` or an ``axis`` of it."""

    record: Record


@dataclass(eq=False, repr=False)
class Same:
    """The default of a key that is the value of another one."""

    key: str


@dataclass(eq=False, repr=False)
class Key:
    """What a key means and what its value may be.

    A key that is not ``required`` has a ``default`` where one is computed with.  ``label`` is its name in the editor's
    text, where that is another.
    """

    meaning: str
    type: Type = Formula()
    required: bool = False
    default: Any = None
    label: str = ""


@dataclass(eq=False, repr=False)
class Kind(Key):
    """A kind of load or constraint: a key whose value is given in one of several ways."""

    ways: tuple[Way, ...] = ()

    def required_in(self, way: Way) -> tuple[str, ...]:
        keys = self.keys
        return tuple(key for key in way.keys if keys[key].required)

    @property
    def keys(self) -> Mapping[str, Key]:
        return self.type.keys if isinstance(self.type, Record) else {}


def plain(value_type: Type) -> list[Type]:
    """What a value, or an item of it, is: without lists and choices."""
    match value_type:
        case Listed(item):
            return plain(item)
        case Either(types):
            return [inner for each in types for inner in plain(each)]
        case Ends(record):
            return [record]
    return [value_type]
