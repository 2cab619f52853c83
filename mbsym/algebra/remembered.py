"""What is found once for an object, and goes with it."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar
from weakref import WeakKeyDictionary

Owner = TypeVar("Owner")
Found = TypeVar("Found")
P = ParamSpec("P")


def remembered(find: Callable[Concatenate[Owner, P], Found]) -> Callable[Concatenate[Owner, P], Found]:
    """The same function, which is asked once for each owner, its first argument; what is raised is not remembered."""
    known: WeakKeyDictionary[Owner, Found] = WeakKeyDictionary()

    @wraps(find)
    def of(owner: Owner, /, *others: P.args, **named: P.kwargs) -> Found:
        if owner not in known:
            known[owner] = find(owner, *others, **named)
        return known[owner]

    return of
