"""The shipped systems, to begin with."""

from __future__ import annotations

import re
from functools import lru_cache

from mbsym.source.examples import example_names, example_text

_NAME = re.compile(r"^name:[ \t]*[\"']?(.*?)[\"']?[ \t]*$", re.MULTILINE)


@lru_cache
def listed() -> list[dict[str, str]]:
    """Names of files and titles, as they are written there."""
    found = []
    for name in example_names():
        title = _NAME.search(example_text(name))
        found.append({"name": name, "title": title[1] if title else name})
    return found


def text(name: str) -> str:
    """Raises KeyError where there is none of that name."""
    return example_text(name)
