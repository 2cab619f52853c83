"""Jinja for HTML: everything that is put into a page is escaped, but for what our own printers have made.

A page is one file that asks the network for nothing.  Its style and its scripts stand in it, and a content security
policy with their hashes lets the browser run these and nothing else, whatever a description may have smuggled in.
"""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Callable, Mapping
from hashlib import sha256
from typing import Any

from markupsafe import Markup

from mbsym.report.environment import compiled, templates


def page(
    template: str,
    known: Mapping[str, Callable[..., Any]],
    scripts: tuple[str, ...],
    bundle: tuple[str, str] = ("", ""),
    **values: Any,
) -> str:
    """A template of ``mbsym_templates/html`` filled in; ``known`` are the functions that it may call.

    ``scripts`` names the files of that folder that the page runs, ``bundle`` is a (script, style) that it has besides.
    An unknown name in a template is an error.
    """
    folder = templates() / "html"
    more, own = bundle
    style = own + "".join((folder / name).read_text(encoding="utf-8") for name in ("page.css", "pictures.css"))
    code = [(folder / name).read_text(encoding="utf-8") for name in scripts] + [more] * bool(more)
    values |= {"style": Markup(style), "scripts": [Markup(text) for text in code], "policy": _policy(style, code)}
    return fragment(template, known, **values)


def fragment(template: str, known: Mapping[str, Callable[..., Any]], **values: Any) -> str:
    """A template without style and scripts: a part of somebody's page."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # only reports need it

    environment = Environment(
        bytecode_cache=compiled(),
        loader=FileSystemLoader(templates() / "html"),
        undefined=StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.globals.update(known)
    return environment.get_template(template).render(**values)


def _policy(style: str, scripts: list[str]) -> str:
    """Nothing from anywhere; the page's own style and scripts, known by their hashes; pictures that stand in it."""
    run = " ".join(map(hash_of, scripts)) or "'none'"
    return (
        f"default-src 'none'; style-src {hash_of(style)}; script-src {run}; img-src data:; "
        "base-uri 'none'; form-action 'none'"
    )


def hash_of(text: str) -> str:
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def embedded(data: Any) -> Markup:
    """Data for a script of the page, as JSON that cannot end the element in which it stands."""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))
