"""The JSON Schemas of the files that mbsym writes, one file each: they say what every property is.

Keywords of our own stand in them, which validators pass over and ``mbsym.diff`` reads: ``x-tell-apart`` names the
properties by which the items of a list are told apart, ``x-indices`` says that items are about coordinates, ``x-first``
with which number they begin, and ``x-aside`` marks what is no result (versions, measured seconds, sentences beside
codes).
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

Schema = dict[str, Any]

_FOLDER = Path(__file__).parent


def names() -> tuple[str, ...]:
    """The kinds of files that have a schema: results, simulation, ..."""
    return tuple(sorted(item.stem for item in _FOLDER.iterdir() if item.suffix == ".json"))


def schema(name: str) -> Schema:
    """The schema (draft 2020-12) of a kind of file.  Raises KeyError for a name that is not among ``names()``."""
    if name not in names():
        raise KeyError(name)
    found: Schema = json.loads((_FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    return found


def version() -> str:
    """The version of mbsym that writes."""
    from mbsym import __version__

    return __version__
