"""Jinja with delimiters that LaTeX, Wolfram and Python leave alone: ``\\VAR{...}``, ``\\BLOCK{...}``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any


def rendered(template: str, filters: Mapping[str, Callable[..., Any]], **values: Any) -> str:
    """A template of ``mbsym_templates`` filled in; an unknown name in it is an error."""
    from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined  # only reports need it

    try:
        cache = FileSystemBytecodeCache()  # compiled templates, in a folder that only this user may write
    except RuntimeError:
        cache = None

    environment = Environment(
        bytecode_cache=cache,
        loader=FileSystemLoader(str(files("mbsym_templates"))),
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
    environment.filters.update(filters)
    return environment.get_template(template).render(**values)
