"""Parts of the report one by one: the words of the whole, and formulas that other programs can read."""

from __future__ import annotations

import re
from html import unescape

import pytest
from conftest import SHIPPED, analysed, derived

from mbsym.analysis import Analysis
from mbsym.report.html.formulas import inline
from mbsym.report.html.report import PARTS, part_html, render, title
from mbsym.report.targets import TARGETS

PENDULUM = """\
mbsym: 1
name: pendulum <script>alert(1)</script>
description: "<img src=x onerror=alert(2)>"
parameters: {m: positive, l: positive, g: positive}
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: m,
     inertia about: mass centre, inertia: [0, 0, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {x: 0}
"""


@pytest.fixture(scope="module")
def pendulum() -> Analysis:
    return analysed(PENDULUM, (1, 2, 3, 4, 5, 6, 7))


def attributes(html: str, name: str) -> list[str]:
    return [unescape(x) for x in re.findall(rf'data-{name}="([^"]*)"', html)]


def test_the_mass_of_a_pendulum_is_spelled_in_three_languages(pendulum: Analysis) -> None:
    """m l^2 x'' + m g l sin x = 0, by hand."""
    html = part_html(pendulum, 3, (3,))
    assert "m*l**2" in {x.strip("[]") for x in attributes(html, "python")}
    assert any(re.search(r"Sin\[", x) for x in attributes(html, "wolfram"))
    assert any(r"\sin" in x for x in attributes(html, "latex"))


def test_a_spelling_says_what_the_formula_is(pendulum: Analysis) -> None:
    force = pendulum.energy.force_function
    html = inline(force, spelled=True)
    assert attributes(html, "python") == [str(force)]
    assert attributes(html, "wolfram") == [force.wolfram()]
    assert "data-" not in inline(force), "reports go without"


@pytest.mark.parametrize("number", [1, 2, 3, 4, 5, 6, 7])
def test_a_part_has_the_words_of_the_report(pendulum: Analysis, number: int) -> None:
    bare = re.sub(r' data-(latex|wolfram|python)="[^"]*"', "", part_html(pendulum, number, pendulum.problems))
    bare = re.sub(r"</?mrow>", "", bare)
    whole = re.sub(r"</?mrow>", "", render(pendulum, pendulum.problems))
    assert bare.strip() in whole
    assert title(pendulum, number) in whole


@pytest.mark.parametrize("part", [*PARTS, 1, 3, 6])
def test_nothing_of_a_description_becomes_markup(pendulum: Analysis, part: str | int) -> None:
    html = part_html(pendulum, part, pendulum.problems)
    assert not re.search(r"<(script|img|b)\b", html)
    assert "style=" not in html, "a page with a policy against inline styles shows it all the same"


def test_there_is_no_other_part(pendulum: Analysis) -> None:
    with pytest.raises(KeyError):
        part_html(pendulum, "../report", ())


def test_no_blank_is_left_where_a_link_is_not_shown() -> None:
    """In print and in notebooks the arrows to conditions are hidden: the comma behind one stands at the formula."""
    html = TARGETS["html"].render(derived(SHIPPED / "gravity-gradient.yaml"), (6,))
    page = re.sub(r'<a class="there".*?</a>', "", html)
    assert 'class="there"' in html
    assert not re.search(r"[ \u00a0](</span>)?,", page.partition("<dl>")[2].partition("</dl>")[0])
