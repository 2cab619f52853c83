"""Jinja with delimiters that LaTeX, Wolfram and Python leave alone: ``\\VAR{...}``, ``\\BLOCK{...}``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mbsym_templates

if TYPE_CHECKING:
    from jinja2 import Environment, FileSystemBytecodeCache


def rendered(template: str, filters: Mapping[str, Callable[..., Any]], **values: Any) -> str:
    """A template of ``mbsym_templates`` filled in; an unknown name in it is an error."""
    own = _environment().overlay()
    own.filters = {**own.filters, **filters}
    return own.get_template(template).render(**values)


@cache
def templates() -> Path:
    """The folder of ``mbsym_templates``."""
    return Path(mbsym_templates.__path__[0])


@cache
def compiled() -> FileSystemBytecodeCache | None:
    """Compiled templates, in a folder that only this user may write; None where there is none."""
    from jinja2 import FileSystemBytecodeCache

    try:
        return FileSystemBytecodeCache()
    except RuntimeError:
        return None


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # only reports need it

    return Environment(
        bytecode_cache=compiled(),
        loader=FileSystemLoader(templates()),
        undefined=StrictUndefined,
        autoescape=False,
        block_start_string=r"\BLOCK{",
        block_end_string="}",
        variable_start_string=r"\VAR{",
        variable_end_string="}",
        comment_start_string=r"\#{",
        comment_end_string="}",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
