"""What is written can be read: contrast of the page's colours, light and dark, by the formula of WCAG 2.1."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

SOURCES = Path(__file__).parents[2] / "editor" / "src"

#: What is written, and on what.
WRITTEN = [
    *((front, back) for front in ("front", "soft") for back in ("back", "panel", "hover")),
    ("front", "marked"),
    ("on-accent", "accent"),
    *((front, back) for front in ("error", "warn", "load", "constraint") for back in ("back", "panel")),
    *((front, "back") for front in ("key", "word", "string", "number", "comment", "accent", "good")),
    *((front, "hover") for front in ("key", "string", "comment")),
]
#: What is only seen: edges of fields and of bodies, the focus.
SEEN = [
    ("edge", "back"),
    ("edge", "panel"),
    ("focus", "back"),
    ("focus", "panel"),
    ("accent", "back"),
    ("soft", "back"),
]


def palette(dark: bool) -> dict[str, str]:
    text = (SOURCES / "page.css").read_text(encoding="utf-8")
    pairs = re.findall(r"--([\w-]+): light-dark\((#\w{6}), (#\w{6})\);", text)
    return {name: (light, other)[dark] for name, light, other in pairs}


def luminance(colour: str) -> float:
    """Relative luminance of #rrggbb, WCAG 2.1."""
    channels = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(one: str, other: str) -> float:
    lighter, darker = sorted((luminance(one), luminance(other)), reverse=True)
    return (lighter + 0.05) / (darker + 0.05)


def test_the_formula_is_the_published_one() -> None:
    """Black on white is 21; #767676 on white is the well-known border of 4.5."""
    assert contrast("#000000", "#ffffff") == pytest.approx(21)
    assert contrast("#767676", "#ffffff") > 4.5 > contrast("#777777", "#ffffff")


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_text_is_readable(dark: bool) -> None:
    """At least 4.5 for text, 3 for edges (success criteria 1.4.3 and 1.4.11)."""
    colours = palette(dark)
    wrong = {pair: contrast(*map(colours.__getitem__, pair)) for pair in WRITTEN}
    assert not {pair: value for pair, value in wrong.items() if value < 4.5}
    wrong = {pair: contrast(*map(colours.__getitem__, pair)) for pair in SEEN}
    assert not {pair: value for pair, value in wrong.items() if value < 3}
