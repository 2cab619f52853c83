"""Results in the page of a real browser: sections that fill, formulas that are copied, text that stays text."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import windows
from windows import Window, serving

browser, opened = windows.browser, windows.opened
NASTY = """\
mbsym: 1
name: "<img src=x onerror=alert(1)><script>alert(2)</script>"
description: "<b onclick=alert(3)>bold</b> & <svg onload=alert(4)></svg>"
parameters: {m: {sign: positive, meaning: "</td><script>alert(5)</script>"}, l: positive, g: positive}
bodies:
  - {name: bob, attached to: 0, rotation: {axes: [3], angles: [x]}, mass centre: [0, -l, 0], mass: m,
     inertia about: mass centre, inertia: [0, 0, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
motion: {x: 0}
values: {m: 1, l: 1, g: 10}
"""


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    path = tmp_path_factory.mktemp("results") / "system.yaml"
    path.write_text(NASTY, encoding="utf-8")
    with serving(path) as address:
        yield address, path


def test_results_fill_are_copied_and_follow_the_text(served: tuple[str, Path], opened: Callable[..., Window]) -> None:
    address, path = served
    window = opened(address, path, permissions=["clipboard-read", "clipboard-write"])
    page = window.page
    done = "document.querySelector('.deriving').textContent.startsWith('All is derived')"
    window.until(done)
    # A pendulum at rest below, by hand: m l^2 x'' + m g l x = 0, stable.
    assert page.locator("#result-summary .good").first.inner_text() == "stable"

    # The drawing is seen as in a report: lines with their colour, heads of arrows, letters.
    drawing = page.locator("#result-summary svg.drawing")
    strokes = "all => all.map(e => getComputedStyle(e).stroke + getComputedStyle(e).markerEnd)"
    lines = drawing.locator("path:not(.tip)").evaluate_all(strokes)
    assert lines
    assert not [line for line in lines if line.startswith("none")]
    assert any("#tip" in line for line in lines)
    assert "x" in drawing.locator("foreignObject math").all_text_contents()

    # Nothing of the description is an element or a handler here.
    page.locator("#result-system > summary").click()
    page.locator("#result-system").get_by_text("</td><script>alert(5)</script>", exact=True).wait_for()
    assert page.locator("#results").locator("script, img, b, a, [onclick], [onload], [onerror], [style]").count() == 0

    # By keys alone: the moment of gravity, -m g l sin x, as Python.
    page.locator("#result-3 > summary").press("Enter")
    line = page.locator("#result-3 .formula[data-python='-m*l*g*sin(x)']").first
    line.press("Enter")
    page.locator(".copy-bar button", has_text="Python").press("Enter")
    page.locator("#said").filter(has_text="copied as Python").wait_for()
    assert page.evaluate("navigator.clipboard.readText()") == "-m*l*g*sin(x)"

    # With a mistake nothing is derived, and what stands there is told to be of an earlier text.
    load = page.get_by_role("button", name="Load it")
    path.write_text(NASTY.replace("mass: m,", "mass: mm,"), encoding="utf-8")
    load.click()
    window.until("document.querySelector('.deriving').textContent.startsWith('Waiting: the text has mistakes')")
    assert page.locator("#result-summary.old").count() == 1

    # Gravity upwards: the motion is unstable, and the page says so without being asked.
    path.write_text(NASTY.replace("direction: [0, -1, 0]", "direction: [0, 1, 0]"), encoding="utf-8")
    load.click()
    window.until(done)
    assert page.locator("#result-summary .bad").first.inner_text() == "unstable"
    assert page.locator(".result.old").count() == 0
