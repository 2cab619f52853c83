"""The README's first picture: what mbsym derives of the bead on a hoop, and what is known of it by hand.

With T = m R^2 (theta'^2 + Omega^2 sin^2 theta)/2 and U = m g R cos theta Lagrange's equation with friction b theta' is
m R^2 theta'' + b theta' + m R sin theta (g - R Omega^2 cos theta) = 0.  It rests at theta = 0, pi and, from
Omega^2 = g/R on, where cos theta = g/(R Omega^2); the potential -m g R cos theta - m R^2 Omega^2 sin^2(theta)/2 has its
minimum at 0 up to there, at the new pair beyond.
"""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest
from draw_hoop import SECONDS, Derived, main, place
from pages import DOCS

FIGURES = DOCS / "figures"
NAMES = ("hoop.svg", "hoop-narrow.svg")
R, G, OMEGA, M, B = 0.3, 9.81, 8.0, 0.1, 0.01


@pytest.fixture(scope="module")
def derived(tmp_path_factory: pytest.TempPathFactory) -> Derived:
    return Derived(tmp_path_factory.mktemp("hoop"))


def test_what_is_kept_is_what_is_drawn(tmp_path: Path) -> None:
    """The same but for a tenth of a pixel: another machine's compiler rounds another way."""
    main(tmp_path)
    for name in NAMES:
        drawn, kept = ((folder / name).read_text("utf-8") for folder in (tmp_path, FIGURES))
        (words, places), (kept_words, kept_places) = map(taken_apart, (drawn, kept))
        same = words == kept_words and places == pytest.approx(kept_places, abs=0.11)
        assert same, f"docs/figures/{name} is not what is derived now: look at it, then make gallery"


def taken_apart(text: str) -> tuple[list[str], list[float]]:
    """What stands around the decimals of a picture, and these."""
    return re.split(r"-?\d+\.\d+", text), [float(x) for x in re.findall(r"-?\d+\.\d+", text)]


@pytest.mark.parametrize("name", NAMES)
def test_the_formulas_are_those_derived_by_hand(name: str) -> None:
    text = (FIGURES / name).read_text(encoding="utf-8")
    assert (
        "equation of motion m R^2 theta&#x27;&#x27; + b theta&#x27; + m R sin(theta) (g - R Omega^2 cos(theta)) = 0"
        in text
    )
    assert "the condition g - R Omega^2 &gt; 0, derived" in text
    assert "is then asymptotically stable, and unstable</text>" in text
    assert f"beyond Ω ≈ {math.sqrt(G / R):.3f}." in text
    assert f"pitchfork, {math.sqrt(G / R):.3f}" in text


def paths(kind: str) -> list[list[tuple[float, float]]]:
    """The curves of the diagram with that class, by their corners."""
    text = (FIGURES / "hoop.svg").read_text(encoding="utf-8")
    found = re.findall(rf'<path class="{kind}" d="M([^"]*)"', text)
    return [[tuple(map(float, pair.split())) for pair in curve.split(" L")] for curve in found]


def test_the_branches_are_where_they_are_by_hand() -> None:
    """Stable ones: the bottom below sqrt(g/R), cos theta = g/(R Omega^2) beyond; to a pixel."""
    scale = place(1, 0)[0]
    critical = math.sqrt(G / R)
    seen = set()
    for curve in paths("stable"):
        for x, y in curve:
            rate = x / scale
            angle = math.acos(min(1.0, G / (R * rate**2))) if rate > critical else 0.0
            side = 1 if y <= 0 else -1
            seen.add((rate > critical + 1, side))
            # Near the fork the angle goes like a root: one tenth of a pixel sideways is several upwards.
            assert abs(y - place(rate, side * angle)[1]) < 1 or abs(rate - critical) < 0.1
    assert {(True, 1), (True, -1), (False, 1)} <= seen
    top = {y for curve in paths("unstable") for _, y in curve}
    assert top == {round(place(0, math.pi)[1], 1), 0.0}


def test_the_bead_comes_to_rest_where_the_branch_is() -> None:
    """After eight seconds of friction, exp(-b t/(2 m R^2)) = 1.2 % of the oscillation is left: two pixels."""
    text = (FIGURES / "hoop.svg").read_text(encoding="utf-8")
    frames = re.search(r"@keyframes dot \{(.*)\}", text)
    assert frames is not None
    heights = [float(y) for y in re.findall(r"translate\(0,(-?[\d.]+)px\)", frames[1])]
    assert abs(heights[0] - place(0, 0.1)[1]) < 0.1
    assert math.exp(-B * SECONDS / (2 * M * R**2)) < 0.02
    assert abs(heights[-1] - place(0, math.acos(G / (R * OMEGA**2)))[1]) < 2


def test_a_wrong_hoop_would_be_noticed(derived: Derived, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Planted: gravity upwards.  The bottom is never stable then, and nothing forks off it."""
    text = (DOCS.parent / "systems" / "bead-on-hoop.yaml").read_text(encoding="utf-8")
    wrong = tmp_path / "bead-on-hoop.yaml"
    wrong.write_text(text.replace("[0, 0, -1]", "[0, 0, 1]"), encoding="utf-8")
    monkeypatch.setattr("draw_hoop.HOOP", wrong)
    assert derived.equation == "m R^2 theta'' + b theta' - m R sin(theta) (R Omega^2 cos(theta) + g) = 0"
