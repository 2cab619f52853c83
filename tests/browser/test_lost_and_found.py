"""What a crash, a server away, another tab and another program cannot take: in a real browser, before a real server."""

from __future__ import annotations

import math
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
import windows
from conftest import SHIPPED
from windows import Window, serving

browser, opened = windows.browser, windows.opened
PENDULUM = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")

Open = Callable[..., Window]


@contextmanager
def killed_at_the_end(path: Path) -> Iterator[str]:
    """A server that ends as by kill -9."""
    with serving(path, signal.SIGKILL) as address:
        yield address


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Path]]:
    path = tmp_path_factory.mktemp("shared") / "system.yaml"
    path.write_text(PENDULUM, encoding="utf-8")
    with serving(path) as address:
        yield address, path


def journal_of(path: Path) -> Path:
    return path.with_name(f".{path.name}.mbsym-journal")


def journalled(window: Window) -> None:
    """Until what was typed stands in the journal."""
    for _ in range(500):
        if journal_of(window.path).exists():
            return
        window.page.wait_for_timeout(20)
    raise AssertionError("no journal")


def text_of(window: Window) -> str:
    """What the text panel shows, without saving it."""
    return str(window.page.locator(".cm-content").inner_text())


def test_after_a_kill_what_was_typed_is_offered_refused_and_taken(tmp_path: Path, opened: Open) -> None:
    path = tmp_path / "system.yaml"
    path.write_text(PENDULUM, encoding="utf-8")
    with killed_at_the_end(path) as address:
        window = opened(address, path)
        window.alone = True
        window.page.locator(".cm-content").focus()
        window.press("Control+Home")
        window.typed("# unsaved ")
        window.settled()
        journalled(window)
    # The page is told, and keeps the text.
    window.page.locator(".banner.away").wait_for()
    assert "# unsaved" in text_of(window)
    window.page.once("dialog", lambda one: one.accept())  # to leave with unsaved changes
    window.page.goto("about:blank")
    assert path.read_text(encoding="utf-8") == PENDULUM
    with serving(path) as address:
        window = opened(address, path)
        banner = window.page.locator(".banner.journal")
        assert "never saved" in banner.inner_text()
        banner.get_by_role("button", name="Leave them").click()
        assert "# unsaved" not in text_of(window)
        # Refused it stays on offer until something is saved.
        window.open(address)
        banner.get_by_role("button", name="Take them up").click()
        window.settled()
        assert "# unsaved" in text_of(window)
        assert window.text == f"# unsaved {PENDULUM}"
        window.press("Control+z")
        window.settled()
        assert window.text == PENDULUM
        assert not journal_of(path).exists()
        window.alone = True


def test_another_server_at_the_address_is_told_and_saves_nothing(tmp_path: Path, opened: Open) -> None:
    """Begun again at the same port it has another token: the page says where to go on, and keeps its text."""
    path = tmp_path / "pendulum.yaml"
    path.write_text(PENDULUM, encoding="utf-8")
    with serving(path) as address:
        window = opened(address, path)
        window.alone = True
        window.settled()
    banner = window.page.locator(".banner.away")
    banner.get_by_text("does not answer").wait_for()
    with serving(path, port=urlsplit(address).port or 0) as other:
        assert other != address
        banner.get_by_text("Another `mbsym edit` answers here now").wait_for()
        assert window.page.locator("#connection").inner_text() == "another server"
        window.page.locator(".cm-content").focus()
        window.press("Control+Home")
        window.typed("# kept ")
        window.press("Control+s")
        assert "# kept" in text_of(window)
        assert path.read_text(encoding="utf-8") == PENDULUM
        window.page.once("dialog", lambda one: one.accept())
        window.page.goto("about:blank")
        # Chromium tells every request that was not found.
        assert all("404 (Not Found)" in one for one in window.troubles), window.troubles
        window.troubles.clear()


def test_without_the_server_the_text_stays_and_goes_on_with_it(served: tuple[str, Path], opened: Open) -> None:
    """The connection is cut, as by a tunnel that breaks; results that come meanwhile are told when it is back."""
    address, path = served
    window = opened(address, path)
    page = window.page
    page.get_by_text("All is derived").wait_for()
    window.alone = True
    page.context.set_offline(True)
    page.locator(".cm-content").focus()
    window.press("Control+Home")
    window.typed("# typed alone ")
    page.locator(".banner.away").wait_for()
    assert page.locator("#connection").inner_text() == "server away"
    assert not journal_of(path).exists()
    page.context.set_offline(False)
    page.locator(".banner.away").wait_for(state="detached")
    window.settled()
    journalled(window)
    assert "# typed alone" in journal_of(path).read_text()
    page.get_by_role("button", name="Simulate").click()
    page.get_by_label("Time", exact=True).wait_for()
    window.press("Control+z")
    window.save()


def test_a_comment_derives_nothing_anew(served: tuple[str, Path], opened: Open) -> None:
    address, path = served
    window = opened(address, path)
    asked: list[Any] = []
    window.page.get_by_text("All is derived").wait_for()
    window.page.on("request", lambda one: asked.append((one.url.rsplit("/", 1)[-1], one.post_data)))
    window.page.locator(".cm-content").focus()
    window.press("Control+Home")
    window.typed("# a comment ")
    window.settled()
    window.page.wait_for_timeout(700)
    assert "look" in [name for name, _ in asked]
    assert [(name, body) for name, body in asked if name in ("derive", "picture")] == []
    assert window.page.locator(".result.old").count() == 0
    assert window.page.locator(".deriving").inner_text() == "All is derived from the text as it stands."
    window.press("Control+z")
    window.save()


def test_two_tabs_simulate_beside_each_other(served: tuple[str, Path], opened: Open) -> None:
    address, path = served
    tabs = [opened(address, path) for _ in range(2)]
    for tab in tabs:
        tab.page.get_by_role("button", name="Simulate").click()
    for tab in tabs:
        tab.page.get_by_label("Time", exact=True).wait_for()
        assert "begun again" not in tab.page.locator("#picture").inner_text()


def test_new_begins_from_an_example_and_one_undo_goes_back(served: tuple[str, Path], opened: Open) -> None:
    address, path = served
    window = opened(address, path)
    window.page.locator("#do-new").click()
    window.page.get_by_label("Begin from").select_option(value="gyrostat")
    window.page.get_by_role("button", name="Begin with it").click()
    window.told("gyrostat is here")
    assert window.complaints == []
    assert window.bodies != {}
    assert text_of(window) != PENDULUM
    window.press("Control+s")
    window.until("document.querySelector('#saved').textContent === 'saved'")
    assert path.read_text(encoding="utf-8") == (SHIPPED / "gyrostat.yaml").read_text(encoding="utf-8")
    window.press("Control+z")
    window.settled()
    assert window.text == PENDULUM


def copied(window: Window, formula: Any, language: str) -> str:
    formula.press("Enter")
    window.page.locator(".copy-bar button", has_text=language).press("Enter")
    window.page.locator("#said").filter(has_text=f"copied as {language}").wait_for()
    return str(window.page.evaluate("navigator.clipboard.readText()"))


def test_a_formula_is_copied_for_three_programs(served: tuple[str, Path], opened: Open) -> None:
    """What acts about the second joint of the double pendulum, by hand, with x' = theta1':

    -m2 l2 (l1 x'^2 sin(theta2) + g sin(theta1 + theta2)).
    """
    address, path = served
    window = opened(address, path, permissions=["clipboard-read", "clipboard-write"])
    window.page.get_by_text("All is derived").wait_for()
    window.page.locator("#result-3 > summary").press("Enter")
    formula = window.page.locator("#result-3 .formula[data-python^='-m2*l2*']")
    one, two, speed = 0.3, 0.5, 1.5
    values = {"theta1": one, "theta2": two, "theta1_dot": speed, "g": 9.0, "l1": 2.0, "l2": 3.0, "m2": 7.0}
    expected = -7 * 3 * (2 * speed**2 * math.sin(two) + 9 * math.sin(one + two))
    names = {"__builtins__": {}, "sin": math.sin, "cos": math.cos}
    assert eval(copied(window, formula, "Python"), names, values) == pytest.approx(expected)
    assert r"\sin(\theta_{1} + \theta_{2})" in copied(window, formula, "LaTeX")
    assert r"Sin[\[Theta]2[t]]" in copied(window, formula, "Wolfram")
