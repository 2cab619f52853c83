"""The page's own history, by random clicks and keys: after each the three views agree; undo and redo walk the texts."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import windows
import yaml
from conftest import SHIPPED
from windows import Window, serving

from mbsym.source import read

browser, opened = windows.browser, windows.opened
PENDULUM = (SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8")
STEPS = 14


def clicked(window: Window, chance: random.Random, number: int) -> str:
    """One thing that a person does, on a body by chance; what it was."""
    names = sorted(window.bodies)
    what = chance.choice(["add", "rename", "duplicate", "delete", "mass", "line"] if names else ["add", "line"])
    if what == "line":
        window.page.locator(".cm-content").focus()
        window.press(chance.choice(["Control+Home", "Control+End"]))
        window.page.keyboard.insert_text(f"# {number}\n")
    elif what == "add" and not names:
        window.page.locator("#graph [role=treeitem]").first.click()
        window.press("a")
        window.in_dialog(f"body {number}")
    else:
        window.body(chance.choice(names)).click()
    if what == "mass":
        window.field("Mass", str(number + 2))
    elif what in ("add", "rename") and names:
        window.press({"add": "a", "rename": "F2"}[what])
        window.in_dialog(f"body {number}")
    elif what in ("duplicate", "delete"):
        said = window.page.locator("#said").inner_text()
        window.press({"duplicate": "d", "delete": "Delete"}[what])
        window.until(
            f"document.querySelector('dialog[open]') !== null || document.querySelector('#said').innerText !== {said!r}"
        )
        if window.page.locator("dialog[open]").count():
            window.in_dialog()
    window.settled()
    return what


def agrees(window: Window, text: str) -> None:
    """The graph shows what another reader of YAML reads; the page complains of what ours complains of."""
    system, complaints = read(text, "system.yaml")
    assert (system is None) == (window.page.locator(".complaint.error").count() > 0), (text, complaints.sorted())
    bodies = yaml.safe_load(text)["bodies"] or []
    shown = {one["name"]: str(one.get("attached to", 0)) for one in bodies}
    assert {name: "0" if on == "fixed axes (0)" else on for name, on in window.bodies.items()} == shown


def test_undo_and_redo_walk_through_what_random_clicks_made(tmp_path: Path, opened: Callable[..., Window]) -> None:
    chance, path = random.Random(15), tmp_path / "system.yaml"
    path.write_text(PENDULUM, encoding="utf-8")
    with serving(path) as address:
        window = opened(address, path)
        window.page.get_by_label("as the text changes").uncheck()
        window.undrawn()
        texts, at, done = [PENDULUM], 0, []
        for number in range(STEPS):
            way = chance.choice(["new", "new", "new", "undo", "redo"])
            if way == "new":
                done.append(clicked(window, chance, number))
                text = window.text
                if text != texts[at]:
                    texts[at + 1 :] = [text]
                    at += 1
            else:
                button = window.page.locator(f"#do-{way}")
                at += {"undo": -1, "redo": 1}[way] * button.is_enabled()
                if button.is_enabled():
                    button.click()
                    window.settled()
                done.append(way)
            assert window.text == texts[at], done
            agrees(window, texts[at])
            assert window.page.locator("#do-undo").is_enabled() == (at > 0), done
            assert window.page.locator("#do-redo").is_enabled() == (at < len(texts) - 1), done
        for key, walked in (("undo", reversed(texts[:at])), ("redo", iter(texts[1:]))):
            for text in walked:
                window.page.locator(f"#do-{key}").click()
                window.settled()
                assert window.text == text, (key, done)
        assert len({*done}) >= 5, "the chance was a lame one"
