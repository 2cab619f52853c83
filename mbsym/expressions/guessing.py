"""Names that somebody misspelt: the likeliest one that is meant."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING


def guess(name: str, known: Iterable[str]) -> str:
    """``: did you mean 'mass_matrix'?``, or what there is instead where nothing is near."""
    from difflib import get_close_matches

    names = list(known)
    near = get_close_matches(name, names, 1)
    if near:
        return f": did you mean '{near[0]}'?"
    return f"; there are {', '.join(names)}" if names else ""


class GuessesNames:
    """An attribute that is not there is answered with the one that may be meant."""

    __slots__ = ()

    if not TYPE_CHECKING:  # where types are checked, an unknown attribute is unknown

        def __getattr__(self, name: str) -> object:
            kind = type(self).__name__
            if name.startswith("_"):  # asked by Python, pickle, notebooks
                raise AttributeError(f"'{kind}' has no attribute '{name}'", name=name, obj=self)
            public = sorted(item for item in dir(type(self)) if not item.startswith("_"))
            public += [item for item in getattr(type(self), "__dataclass_fields__", ()) if item not in public]
            raise AttributeError(f"'{kind}' has no attribute '{name}'{guess(name, public)}", name=name, obj=self)
