"""The systems that are installed with the package, by name."""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files

_PACKAGE = "mbsym_systems"
_SUFFIX = ".yaml"
_NAME = re.compile(r"^name:[ \t]*[\"']?(.*?)[\"']?[ \t]*$", re.MULTILINE)


@cache
def example_names() -> tuple[str, ...]:
    """The names of the shipped systems, in alphabetical order: those of their files without the ending."""
    inside = files(_PACKAGE).iterdir()
    return tuple(sorted(file.name.removesuffix(_SUFFIX) for file in inside if file.name.endswith(_SUFFIX)))


def example_text(name: str) -> str:
    """The description of a shipped system, with its comments.  Raises KeyError where there is none of that name."""
    if name not in example_names():
        raise KeyError(name)
    return files(_PACKAGE).joinpath(name + _SUFFIX).read_text(encoding="utf-8")


def example_like(word: str) -> str | None:
    """The shipped system that a word means: its name, or the shortest name that ends in it or holds it."""
    slug = word.strip().lower().replace("_", "-").replace(" ", "-")
    names = sorted(example_names(), key=lambda name: (len(name), name))
    if slug in names:
        return slug
    ending = [name for name in names if name.endswith(f"-{slug}")]
    if slug == "pendulum":
        return "simple-pendulum"  # the shortest name would be the pendulum on a cart
    return next(iter(ending or [name for name in names if slug and slug in name]), None)


def example_in(title: str) -> str:
    """The shipped system whose name stands in a title, cart-pole in my-cart-pole; the longest, or the pendulum."""
    slug = title.lower().replace("_", "-").replace(" ", "-")
    return max((name for name in example_names() if name in slug), key=len, default="simple-pendulum")


@cache
def example_titles() -> list[dict[str, str]]:
    """``name`` and ``title`` of each, as it is written there, for a list to begin with."""
    titles = []
    for name in example_names():
        title = _NAME.search(example_text(name))
        titles.append({"name": name, "title": title[1] if title else name})
    return titles
