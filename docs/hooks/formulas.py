"""Formulas between dollars become MathML while the site is built: nothing is fetched, no script runs."""

from __future__ import annotations

import re
from html import unescape
from typing import Any

from latex2mathml.converter import convert

_MARKED = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def on_page_content(html: str, **_: Any) -> str:
    """The page with its formulas as MathML."""
    return _MARKED.sub(_mathml, html)


def _mathml(found: re.Match[str]) -> str:
    tag, bracket, formula = found.groups()
    display = "inline" if bracket == "(" else "block"
    return f'<{tag} class="formula">{convert(unescape(formula), display=display)}</{tag}>'
