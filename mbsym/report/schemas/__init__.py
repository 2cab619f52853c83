"""The JSON Schemas of the files that mbsym writes, one file each: they say what every property is.

Two keywords of our own stand in them, which validators pass over: ``x-tell-apart`` names the properties by which the
items of a list are told apart when two files are compared, and ``x-aside`` marks what is no result (versions,
measured seconds).
"""

from __future__ import annotations

import json
from importlib.resources import files
from typing import Any

Schema = dict[str, Any]


def names() -> tuple[str, ...]:
    """The kinds of files that have a schema: results, simulation, ..."""
    found = (item.name for item in files(__package__).iterdir())
    return tuple(sorted(name.removesuffix(".json") for name in found if name.endswith(".json")))


def schema(name: str) -> Schema:
    """The schema (draft 2020-12) of a kind of file.  Raises KeyError for a name that is not among ``names()``."""
    if name not in names():
        raise KeyError(name)
    found: Schema = json.loads(files(__package__).joinpath(f"{name}.json").read_text(encoding="utf-8"))
    return found


def version() -> str:
    """The version of mbsym that writes."""
    from mbsym import __version__

    return __version__
