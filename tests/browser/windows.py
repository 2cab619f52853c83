"""A real browser before `mbsym edit`: skipped by name where Playwright or Chromium is missing.

The fixtures are taken by name (`browser, opened = windows.browser, windows.opened`), since a second conftest would
hide the first.
"""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from conftest import CHROMIUM

#: So long may an answer of the page take on a machine that does other things, too.
PATIENCE = 20_000


@contextmanager
def serving(path: Path, ended_by: signal.Signals = signal.SIGTERM, port: int = 0) -> Iterator[str]:
    """The address of a server for one file, in a process of its own."""
    command = [sys.executable, "-m", "mbsym_cli", "edit", str(path), "--no-browser", "--port", str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        try:
            assert process.stdout is not None
            said = ""
            for line in process.stdout:
                said += line
                if found := re.search(r"http://127\.0\.0\.1:\d+/\S+/", line):
                    break
            else:
                raise AssertionError(said)
            yield found.group()
        finally:
            process.send_signal(ended_by)
            process.wait(20)


#: Three dimensions without a graphics card; flat canvases drawn the same way each time.  The page itself is put
#: together without that emulated card, which takes a third of all processor time.
OPTIONS = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-accelerated-2d-canvas"]
OPTIONS += ["--disable-gpu-compositing"]

_LAUNCHED: list[Any] = []


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """One Chromium for all tests of a worker, in however many modules this fixture is named."""
    if _LAUNCHED:
        yield _LAUNCHED[0]
        return
    if CHROMIUM is None:
        pytest.skip("no chromium")
    playwright = pytest.importorskip("playwright.sync_api", reason="no playwright")
    with playwright.sync_playwright() as running:
        started = running.chromium.launch(executable_path=CHROMIUM, args=OPTIONS)
        _LAUNCHED.append(started)
        yield started
        _LAUNCHED.clear()
        started.close()


#: Opens the section of an element of the form, and folds the others.
ALONE = """e => {
  const own = e.closest('details');
  own.open = true;
  for (const one of document.querySelectorAll('#form details')) if (one !== own) one.open = false;
}"""


class Window:
    """A page of the editor, with the things that a person does there."""

    def __init__(self, page: Any, path: Path) -> None:
        self.page, self.path = page, path
        self.troubles: list[str] = []
        #: The server is away, as the test wants it: the browser says so of every request.
        self.alone = False
        page.set_default_timeout(PATIENCE)
        page.on("console", self.heard)
        page.on("pageerror", lambda one: self.troubles.append(str(one)))
        page.add_init_script(
            "window.violations = []; document.addEventListener('securitypolicyviolation',"
            " e => window.violations.push(`${e.violatedDirective} ${e.blockedURI} ${e.target.className}`));"
        )

    def heard(self, one: Any) -> None:
        """Errors and warnings; not what a software renderer says of its own speed, nor answers that the page expects
        (a description that cannot be drawn yet, a file that somebody else has written)."""
        expected = ("GL Driver Message", "Applying inline style", "status of 400", "status of 409", "status of 422")
        if self.alone and "net::ERR_" in one.text:
            return
        if one.type in ("error", "warning") and not any(words in one.text for words in expected):
            self.troubles.append(one.text)

    def open(self, address: str) -> None:
        """Loads the page and waits for the first look at the text."""
        self.page.goto(address)
        self.settled()

    def settled(self) -> None:
        """Until the server has looked at the text as it is, whatever it says of it."""
        self.until("document.documentElement.dataset.fresh === 'true'")

    def until(self, expression: str) -> None:
        """Waits until an expression holds: asked from outside, since the page's policy forbids what Playwright's own
        waiting evaluates."""
        limit = time.monotonic() + PATIENCE / 1000
        while not self.page.evaluate(expression):
            assert time.monotonic() < limit, f"still not: {expression}"
            self.page.wait_for_timeout(20)

    def told(self, words: str) -> None:
        """Waits until the status line tells something with these words, and the text is understood."""
        self.page.locator("#said").filter(has_text=words).wait_for()
        self.settled()

    def press(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    def typed(self, text: str) -> None:
        self.page.keyboard.type(text)

    def body(self, name: str) -> Any:
        """The body in the graph."""
        return self.page.locator("#graph [role=treeitem]").filter(has=self.page.get_by_text(name, exact=True))

    def field(self, label: str, value: str) -> None:
        """Types into a field of the form, or chooses by its first letters."""
        field = self.page.locator("#form").get_by_label(label, exact=True)
        if field.evaluate("e => { e.closest('details').open = true; return e.tagName; }") == "SELECT":
            field.focus()
            field.select_option(value)
        else:
            field.click()
            self.press("Control+a")
            self.typed(value)
            self.press("Tab")
        self.settled()

    def add(self, button: str, *entries: dict[str, str]) -> None:
        """A button of the form, and its dialog filled in field by field: once for each entry, without closing it."""
        place = self.page.locator("#form").get_by_label(button, exact=True)
        place.evaluate(ALONE)  # a long form is laid out anew after each change
        place.click()
        for entry in entries:
            dialog = self.page.locator("dialog[open]")
            dialog.wait_for()
            for label, value in entry.items():
                field = dialog.get_by_label(label, exact=True)
                if field.evaluate("e => e.tagName") == "SELECT":
                    field.select_option(value)
                else:
                    field.fill(value)
            last = entry is entries[-1]
            mark = None if last else dialog.evaluate("e => e.querySelector('h2').id")
            dialog.get_by_role("button", name="Add" if last else "Add, then another", exact=True).click()
            if mark:  # the next one
                self.until(f"(document.querySelector('dialog[open] h2')?.id ?? '{mark}') !== '{mark}'")
        self.page.locator("dialog").wait_for(state="detached")  # closed, and acted upon
        self.settled()

    def undrawn(self) -> None:
        """From now on no picture is computed for what is half built: another test looks at those."""
        words = '{"complaints": [{"message": "nothing is drawn for this test"}]}'
        self.page.route("**/api/picture", lambda one: one.fulfill(body=words, content_type="application/json"))

    def form_of(self, which: str) -> None:
        """The form of the body or of the system, with all its sections open."""
        self.page.locator("#form").get_by_role("button", name=which, exact=True).click()
        self.page.evaluate("document.querySelectorAll('#form details').forEach(e => { e.open = true; })")

    @property
    def bodies(self) -> dict[str, str]:
        """What hangs on what, as the graph tells those who listen."""
        labels = self.page.locator("#graph [role=treeitem]").evaluate_all("all => all.map(e => e.ariaLabel)")
        found = (re.match(r"(.*), body \d+ on ([^;]*)", label) for label in labels)
        return {match[1]: match[2] for match in found if match}

    def in_dialog(self, text: str | None = None, *chosen: str) -> None:
        """Answers the open dialog with Enter, after typing `text` over what is marked, and keys in what follows it."""
        self.page.locator("dialog[open]").wait_for()
        if text is not None:
            self.typed(text)
        for key in chosen:
            self.press("Tab", key)
        if chosen:
            self.press("Tab")  # to the button: Enter opens a list
        self.press("Enter")
        self.page.locator("dialog").wait_for(state="detached")  # closed, and acted upon
        self.settled()

    def in_dialog_take(self) -> None:
        """Presses the main button of the open dialog."""
        self.page.locator("dialog[open] button.main").click()
        self.page.locator("dialog").wait_for(state="detached")
        self.settled()

    def write(self, text: str) -> None:
        """The whole text replaced, by keys as a person would: mark all, paste."""
        self.page.locator(".cm-content").focus()
        self.press("Control+a")
        self.page.keyboard.insert_text(text)
        self.settled()

    @property
    def text(self) -> str:
        """The text as it is saved."""
        self.save()
        return self.path.read_bytes().decode()

    def save(self) -> None:
        if self.page.locator("#do-save").is_enabled():
            self.press("Control+s")
            self.until("document.querySelector('#saved').textContent === 'saved'")

    @property
    def complaints(self) -> list[str]:
        self.settled()
        return self.page.locator(".complaint .message").all_text_contents()

    def is_quiet(self) -> None:
        """Nothing on the console, nothing that the security policy had to stop; but where text is edited Chromium
        itself puts style attributes, which are stopped there."""
        assert self.troubles == [], self.troubles
        violations = self.page.evaluate("window.violations")
        assert [one for one in violations if one != "style-src-attr inline text-shadow"] == []


@pytest.fixture
def opened(browser: Any) -> Iterator[Callable[..., Window]]:
    """Opens a file in a window; all windows are closed and have to be quiet at the end."""
    windows: list[Window] = []
    contexts = []

    def open_one(address: str, path: Path, **settings: Any) -> Window:
        context = browser.new_context(viewport={"width": 1280, "height": 720}, **settings)
        contexts.append(context)
        window = Window(context.new_page(), path)
        window.open(address)
        windows.append(window)
        return window

    yield open_one
    for window in windows:
        window.is_quiet()
    for context in contexts:
        context.close()
