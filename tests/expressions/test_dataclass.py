"""Frozen classes whose methods come late are what the standard library would have made at once."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, field
from functools import cached_property
from typing import Any, ClassVar, Generic, TypeVar

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mbsym.expressions import dataclass as module
from mbsym.expressions.dataclass import dataclass as late

T = TypeVar("T")
Maker = Callable[..., Any]


def plain(dataclass: Maker, **options: bool) -> Any:
    @dataclass(frozen=True, **options)
    class Plain:
        """Two without a default, one with."""

        a: int
        b: str
        c: tuple[int, ...] = (1, 2)

        def doubled(self) -> int:
            return 2 * self.a

    return Plain


def with_fields(dataclass: Maker, **options: bool) -> Any:
    @dataclass(frozen=True, **options)
    class Fields:
        """Two that are compared, one that is not, and is not shown; what is given is looked at."""

        a: int
        c: tuple[int, ...] = field(default=(), repr=False)
        span: str | None = field(default="here", compare=False, repr=False)

        def __post_init__(self) -> None:
            if self.a < 0:
                raise ValueError("negative")

    return Fields


@pytest.mark.parametrize("slots", [False, True])
@given(st.integers(-1, 1), st.integers(0, 1), st.sampled_from(["x", None]))
def test_fields_with_options(slots: bool, a: int, d: int, span: str | None) -> None:
    one, other = with_fields(late, slots=slots), with_fields(dataclasses.dataclass, slots=slots)
    for make in (
        lambda cls: repr(cls(a, (1,), span)),
        lambda cls: hash(cls(a, span=span)),
        lambda cls: cls(a, (), span) == cls(d),
        lambda cls: cls(a).span,
        lambda cls: dataclasses.astuple(dataclasses.replace(cls(d, (3,), span), a=a)),
        lambda cls: repr(dataclasses.fields(cls)),
        lambda cls: str(inspect.signature(cls)),
        lambda cls: [name for name in ("a", "c", "span") if name in vars(cls) and not slots],
    ):
        assert results(lambda make=make: make(one)) == results(lambda make=make: make(other))


def single(dataclass: Maker) -> Any:
    @dataclass(frozen=True)
    class Single(Generic[T]):
        """One field, of any type."""

        only: T

        @cached_property
        def kept(self) -> list[T]:
            return [self.only]

    return Single


FORMS = [{}, {"slots": True}, {"repr": False}, {"eq": False}, {"slots": True, "eq": False}]


def results(make: Callable[[], Any]) -> Any:
    try:
        return make()
    except Exception as error:
        return type(error), str(error)


@pytest.mark.parametrize("options", FORMS)
def test_what_can_be_looked_at(options: dict[str, bool]) -> None:
    one, other = plain(late, **options), plain(dataclasses.dataclass, **options)
    assert dataclasses.is_dataclass(one)
    assert [repr(x) for x in dataclasses.fields(one)] == [repr(x) for x in dataclasses.fields(other)]
    assert repr(one.__dataclass_params__) == repr(other.__dataclass_params__)
    assert str(inspect.signature(one)) == str(inspect.signature(other))
    assert one.__match_args__ == other.__match_args__
    assert one.__qualname__ == other.__qualname__
    assert ("__slots__" in one.__dict__) == ("__slots__" in other.__dict__)
    assert one.__doc__ == other.__doc__


@pytest.mark.parametrize("options", FORMS)
@given(st.integers(-2, 2), st.text(max_size=2), st.integers(-2, 2), st.text(max_size=2))
def test_what_instances_do(options: dict[str, bool], a: int, b: str, d: int, e: str) -> None:
    one, other = plain(late, **options), plain(dataclasses.dataclass, **options)
    assert (one(a, b) == one(d, e)) == (other(a, b) == other(d, e))
    if options.get("eq", True):
        assert hash(one(a, b)) == hash(other(a, b))
    if options.get("repr", True):
        assert repr(one(a, b=b)) == repr(other(a, b=b))
    assert dataclasses.astuple(dataclasses.replace(one(a, b), c=(d,))) == (a, b, (d,))
    assert one(a, b).doubled() == 2 * a
    assert one(a, b) != other(a, b)
    match one(a, b):
        case one(x, y):
            assert (x, y) == (a, b)
        case _:
            pytest.fail("no pattern")
    assert dataclasses.astuple(copy.copy(one(a, b))) == (a, b, (1, 2))


@pytest.mark.parametrize("options", FORMS)
def test_nothing_is_assigned(options: dict[str, bool]) -> None:
    for cls in (plain(late, **options), plain(dataclasses.dataclass, **options)):
        for name in ("a", "z"):
            with pytest.raises((FrozenInstanceError, TypeError)):
                setattr(cls(1, "b"), name, 3)
        with pytest.raises(FrozenInstanceError):
            del cls(1, "b").a


@pytest.mark.parametrize("given", [(), (1,), (1, "b", (), 4)])
def test_wrong_arguments(given: tuple[Any, ...]) -> None:
    ours = results(lambda: plain(late)(*given))
    assert ours == results(lambda: plain(dataclasses.dataclass)(*given))
    assert ours[0] is TypeError


def test_nan_equals_itself_as_in_a_tuple() -> None:
    nan = float("nan")
    cls, library = single(late), single(dataclasses.dataclass)
    assert (cls(nan) == cls(nan)) is (library(nan) == library(nan)) is True
    assert hash(cls(5)) == hash(library(5))
    assert cls(5).kept == [5]


@late(frozen=True, slots=True)
class Sent:
    """Goes through a pickle."""

    a: int
    b: str = "b"


@late(frozen=True)
class Told:
    """Goes through a pickle, too."""

    a: int


def test_pickles_of_classes_that_nobody_has_used_yet() -> None:
    """An instance that comes out of a pickle has been made without ``__init__``."""
    for cls in (Sent, Told):
        instance = cls.__new__(cls)
        object.__setattr__(instance, "a", 4)
        if cls is Sent:
            object.__setattr__(instance, "b", "c")
        found = pickle.loads(pickle.dumps(instance))
        assert found == instance
        assert hash(found) == hash(instance)
        assert found.a == 4
        with pytest.raises(FrozenInstanceError):
            found.a = 5


def test_classes_beneath_it() -> None:
    for base in (plain(late), plain(dataclasses.dataclass)):

        class Undecorated(base):  # type: ignore[misc]
            pass

        @dataclasses.dataclass(frozen=True)
        class Decorated(base):  # type: ignore[misc]
            d: int = 7

        assert Undecorated(1, "b").c == (1, 2)
        assert Undecorated(1, "b") == Undecorated(1, "b") != base(1, "b")
        assert Decorated(1, "b", d=3).d == 3
        assert [x.name for x in dataclasses.fields(Decorated)] == ["a", "b", "c", "d"]
        with pytest.raises(FrozenInstanceError):
            Undecorated(1, "b").a = 3


def test_what_is_not_plain_is_the_library_s() -> None:
    @late(frozen=True)
    class Counted:
        """A default that is made, a class variable."""

        count: ClassVar[int] = 3
        items: list[int] = field(default_factory=list)
        note: str = field(default="", compare=False)

        def __post_init__(self) -> None:
            self.items.append(1)

    assert Counted() == Counted(note="x")
    assert Counted().items == [1]
    assert [x.name for x in dataclasses.fields(Counted)] == ["items", "note"]
    with pytest.raises(ValueError, match="mutable default"):
        late(frozen=True)(type("Bad", (), {"__doc__": "x", "__annotations__": {"a": "list[int]"}, "a": []}))


def test_own_methods_stay() -> None:
    @late(frozen=True, slots=True)
    class Own:
        """Says and compares what it wants."""

        a: int

        def __repr__(self) -> str:
            return "own"

        def __eq__(self, other: object) -> bool:
            return True

        def __hash__(self) -> int:
            return 1

    assert (repr(Own(1)), Own(1) == 3, hash(Own(1))) == ("own", True, 1)


def test_importing_compiles_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: Any, **__: Any) -> Any:
        raise AssertionError("the library is asked for nothing before anything is needed")

    monkeypatch.setattr(module.dataclasses, "dataclass", refused)
    cls = plain(late)
    assert cls(1, "b") == cls(1, "b")
    assert hash(cls(1, "b")) == hash(cls(1, "b"))
