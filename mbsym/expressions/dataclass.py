"""The standard library's ``dataclass`` for frozen classes, most of whose work is put off until somebody needs it.

``dataclasses`` writes and compiles six methods of each frozen class when a module is imported: for the hundred and
fifty classes of a run that was a third of the time of all imports, and half of these classes have no instance then.
Here a plain frozen class gets its ``__init__`` when its first instance is made, compares and hashes by its fields
without anything being compiled, and whatever else is asked of it (fields, signature, patterns, repr) comes from the
library, then.  A class that is not plain goes to the library at once.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import MISSING, Field, FrozenInstanceError
from operator import attrgetter
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(cls=None, /, *, frozen=False, slots=False, eq=True, repr=True, **others):
        """``dataclasses.dataclass``."""

        def decorated(cls):
            if frozen and not others and _is_plain(cls, slots):
                return _Late(cls, eq, repr, slots).cls
            return dataclasses.dataclass(cls, frozen=frozen, slots=slots, eq=eq, repr=repr, **others)

        return decorated if cls is None else decorated(cls)


#: What the text of ``__init__`` calls something else.
_TAKEN = ("self", "_assign")

#: Annotations that are no fields, or fields of another kind.
_NO_FIELDS = ("ClassVar", "InitVar", "KW_ONLY")

#: What a plain class does not define itself.
_GENERATED = (
    *("__init__", "__setattr__", "__delattr__", "__slots__"),
    *("__match_args__", "__getstate__", "__setstate__", "__signature__"),
)

#: What the library looks at, besides the defaults of fields.
_READ = ("__module__", "__qualname__", "__doc__", "__annotations__", "__orig_bases__", "__post_init__")

_FIELDS = "__dataclass_fields__"


def _is_plain(cls: type, slots: bool) -> bool:
    """All of it is fields with or without a default, and none are inherited; it compares and hashes itself, or not."""
    own = cls.__dict__
    annotations = own.get("__annotations__")  # from Python 3.14 on they come late themselves
    if not annotations or not own.get("__doc__") or any(name in own for name in _GENERATED):
        return False
    if ("__eq__" in own) != (own.get("__hash__") is not None):
        return False
    for name, words in annotations.items():
        if name in _TAKEN or not isinstance(words, str) or any(word in words for word in _NO_FIELDS):
            return False
        default = own.get(name)
        if isinstance(default, Field):
            if default.default is MISSING or not default.init or default.hash is not None or default.kw_only is True:
                return False
            default = default.default
        if type(default).__hash__ is None:  # the library has words for that
            return False
    bases = cls.__mro__[1:-1]
    return not any(_FIELDS in base.__dict__ or (slots and "__slots__" not in base.__dict__) for base in bases)


class _Late:
    """A plain class, and what is put off of it."""

    def __init__(self, cls: type, eq: bool, repr_: bool, slots: bool) -> None:
        own = dict(cls.__dict__)
        self.names = tuple(own["__annotations__"])
        self._own = {name: own[name] for name in (*_READ, *self.names) if name in own}
        given = {name: own[name] for name in self.names if name in own}
        self._defaults = {name: x.default if isinstance(x, Field) else x for name, x in given.items()}
        self._options, self._bases = {"frozen": True, "eq": eq, "repr": repr_}, cls.__bases__
        self.cls: Any = _slotted(cls, own, self.names) if slots else cls
        methods: dict[str, Any] = {"__init__": self._first_init(), **_frozen(self.cls)}
        for name in (_FIELDS, "__dataclass_params__", "__match_args__", "__signature__"):
            methods[name] = _Put(self, name)
        if eq and "__eq__" not in own:
            ignored = [name for name, x in given.items() if isinstance(x, Field) and not x.compare]
            methods |= _compared(tuple(name for name in self.names if name not in ignored))
        if repr_ and "__repr__" not in own:
            methods["__repr__"] = self._first_repr()
        methods |= _STATE if slots else self._defaults
        for name, method in methods.items():
            setattr(self.cls, name, method)

    def _first_init(self) -> Callable[..., None]:
        cls = self.cls

        def __init__(self_: Any, *args: Any, **named: Any) -> None:
            cls.__init__ = self._init()
            cls.__init__(self_, *args, **named)

        return __init__

    def _init(self) -> Any:
        """``__init__`` that sets the fields, as the library's does."""
        names: dict[str, Any] = {f"_default_{name}": value for name, value in self._defaults.items()}
        arguments = ", ".join(f"{x}=_default_{x}" if x in self._defaults else x for x in self.names)
        lines = [f"_assign(self, {name!r}, {name})" for name in self.names]
        lines += ["self.__post_init__()"] if hasattr(self.cls, "__post_init__") else []
        body = "\n ".join(lines)
        names["_assign"] = object.__setattr__
        exec(f"def __init__(self, {arguments}):\n {body}", names)
        names["__init__"].__qualname__ = f"{self.cls.__qualname__}.__init__"
        return names["__init__"]

    def _first_repr(self) -> Callable[[Any], str]:
        cls = self.cls

        def __repr__(self_: Any) -> str:
            cls.__repr__ = self.of_library().__repr__
            written: str = cls.__repr__(self_)
            return written

        return __repr__

    def of_library(self) -> Any:
        """A class of the same name and fields, as the library makes it."""
        own = type(self.cls)(self.cls.__name__, self._bases, dict(self._own))
        return dataclasses.dataclass(**self._options)(own)

    def complete(self) -> None:
        """What the library tells of the class takes its place."""
        made = self.of_library()
        for name in (_FIELDS, "__dataclass_params__", "__match_args__", "__replace__", "__init__"):
            if name in made.__dict__:
                setattr(self.cls, name, made.__dict__[name])


class _Put:
    """An attribute of the class that is put off until it is looked at; the signature is that of ``__init__``, then."""

    def __init__(self, late: _Late, name: str) -> None:
        self._late, self._name = late, name

    def __get__(self, instance: object, owner: type) -> Any:
        self._late.complete()
        if self._name == "__signature__":
            raise AttributeError(self._name)
        return getattr(owner, self._name)


def _compared(names: tuple[str, ...]) -> dict[str, Callable[..., Any]]:
    values: Callable[[Any], tuple[Any, ...]]
    if len(names) > 1:
        values = attrgetter(*names)
    else:

        def values(self: Any) -> tuple[Any, ...]:
            return tuple([getattr(self, name) for name in names])

    def __eq__(self: Any, other: object) -> Any:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:
        return hash(values(self))

    return {"__eq__": __eq__, "__hash__": __hash__}


def _frozen(cls: Any) -> dict[str, Callable[..., None]]:
    def __setattr__(self: Any, name: str, value: Any) -> None:
        if type(self) is cls or name in cls.__dataclass_fields__:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(cls, self).__setattr__(name, value)

    def __delattr__(self: Any, name: str) -> None:
        if type(self) is cls or name in cls.__dataclass_fields__:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(cls, self).__delattr__(name)

    return {"__setattr__": __setattr__, "__delattr__": __delattr__}


def _slotted(cls: type, own: dict[str, Any], names: tuple[str, ...]) -> type:
    """The class with slots for its fields: a new one, as the library makes it."""
    left = {name: value for name, value in own.items() if name not in (*names, "__dict__", "__weakref__")}
    made = type(cls)(cls.__name__, cls.__bases__, left | {"__slots__": names})
    made.__qualname__ = cls.__qualname__
    return made


def _state(self: Any) -> list[Any]:
    return [getattr(self, field.name) for field in dataclasses.fields(self)]


def _restored(self: Any, state: list[Any]) -> None:
    for field, value in zip(dataclasses.fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)


_STATE = {"__getstate__": _state, "__setstate__": _restored}
