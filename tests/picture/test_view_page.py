"""``mbsym view``: the page holds what it should and nothing else, and draws in a browser without a complaint."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Callable, Iterator
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import windows
from click.testing import Result
from conftest import SHIPPED, filed, invoked

import mbsym
from mbsym.picture import as_json, picture
from mbsym.report.viewer.page import viewed

DRAWN = [x for x in sorted(SHIPPED.glob("*.yaml")) if x.stem not in ("gyroscopic-pair", "triangular-points")]

HOSTILE = """mbsym: 1
name: "</script><img src=x onerror=alert(1)><!--"
description: "<b onclick=alert(1)>bold</b> & </title><script>alert(1)</script>"
source: "<iframe src=//evil.example>"
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: 1, mass centre: [0, -1, 0]}
motion: {a: 0}
initial: {a: 1}
"""


def run(*arguments: object, code: int | None = None) -> Result:
    return invoked("view", *arguments, code=code)


class Elements(HTMLParser):
    """The elements of a page, and what stands in scripts and styles."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[tuple[str, dict[str, str | None]]] = []
        self.inside: list[str] = []
        self._raw = False
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.names.append((tag, dict(attributes)))
        self._raw = tag in ("script", "style")
        if self._raw:
            self.inside.append("")

    def handle_endtag(self, tag: str) -> None:
        self._raw = False

    def handle_data(self, text: str) -> None:
        if self._raw:
            self.inside[-1] += text


def test_nothing_of_a_description_becomes_an_element() -> None:
    text, _ = viewed(mbsym.loads(HOSTILE).system, {}, time=1.0, modes=True, equilibria=True)
    plain, _ = viewed(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, {}, time=1.0)
    found, usual = Elements(text), Elements(plain)
    assert [name for name, _ in found.names] == [name for name, _ in usual.names]
    assert all(not name.startswith("on") and name != "src" for _, given in found.names for name in given)
    style, data, script = found.inside
    told = json.loads(data)
    assert told["picture"]["name"] == "</script><img src=x onerror=alert(1)><!--"
    assert "<" not in data
    policy = next(given["content"] for name, given in found.names if name == "meta" and "http-equiv" in given)
    assert policy is not None
    rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
    assert rules["default-src"] == "'none'"
    for rule, content in (("style-src", style), ("script-src", script)):
        assert rules[rule] == f"'sha256-{b64encode(sha256(content.encode()).digest()).decode()}'"


def test_the_page_asks_the_network_for_nothing() -> None:
    text, _ = viewed(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, {})
    own = re.sub(r"<script.*?</script>|<style.*?</style>", "", text, flags=re.DOTALL)
    assert not re.search(r"https?:|src=|href=|url\(|@import", own)


def test_the_command_writes_a_page_and_tells_of_it(tmp_path: Path) -> None:
    out = tmp_path / "page.html"
    done = run(
        SHIPPED / "simple-pendulum.yaml",
        "--time",
        1,
        "--modes",
        "--equilibria",
        "--set",
        "theta=1/4",
        "-o",
        out,
        code=0,
    )
    data = json.loads(Elements(out.read_text(encoding="utf-8")).inside[1])
    assert data["picture"]["coordinates"][0]["value"] == 0.25
    assert data["motion"]["coordinates"]["theta"][0] == 0.25
    assert data["motion"]["times"][-1] == 1
    assert data["modes"]["verdict"]["verdict"] == "asymptotically stable"
    assert len(data["equilibria"]["equilibria"]) == 2
    assert "opens in a browser" in done.output


def test_what_is_told_of_a_page_is_in_the_language_of_the_description(tmp_path: Path) -> None:
    """A skate: by motions it comes to every position, so that none is said to be out of reach."""
    text = (SHIPPED / "chaplygin-sleigh.yaml").read_text(encoding="utf-8")
    file = filed(tmp_path / "sledge.yaml", text.replace("mbsym: 1\n", "mbsym: 1\nlanguage: ru\n"))
    done = run(file, "--equilibria", "-o", tmp_path / "page.html", code=0)
    assert "достижимо оно движением или нет" in done.output
    lines = [line for line in done.output.split("\n") if not line.startswith(text.split("name: ")[1].split("\n")[0])]
    assert not re.search("[a-z]{4}", re.sub(r"\S*(html|yaml)", "", "\n".join(lines))), done.output


@pytest.mark.parametrize(
    ("name", "what", "why"),
    [("four-bar", "modes", "no unperturbed motion"), ("chaplygin-sleigh", "equilibria", "constraints tie what moves")],
)
def test_what_cannot_be_had_is_told_on_the_page(name: str, what: str, why: str, tmp_path: Path) -> None:
    """Four bars without a motion have no modes, a sledge led along a curve no list of equilibria: the picture stays."""
    out, file = tmp_path / "page.html", tmp_path / f"{name}.yaml"
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    file.write_text(text.replace("constraints:\n", "constraints:\n  - relation: y = x**2\n"), encoding="utf-8")
    done = run(file if what == "equilibria" else SHIPPED / f"{name}.yaml", f"--{what}", "-o", out, code=0)
    assert f"no {what}: " in done.output
    data = json.loads(Elements(out.read_text(encoding="utf-8")).inside[1])
    assert why in data[what]["why"]


def test_modes_are_those_of_the_values_set() -> None:
    """x'' + k x = 0 with k by a relation: omega^2 = 2 s."""
    text = """mbsym: 1
name: one
parameters: {s: positive, k: positive}
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: k}
relations: {k: 2*s}
motion: {x: 0}
values: {s: 2, k: 4}
"""
    from mbsym.report.viewer.page import modes_part
    from mbsym.simulation.request import read_values

    system = mbsym.loads(text).system
    assert modes_part(system, {})["modes"][0]["imaginary"] == pytest.approx(2)
    assert modes_part(system, read_values(system, {"s": "9/2"}))["modes"][0]["imaginary"] == pytest.approx(3)


def test_missing_values_are_stood_in_for_unless_a_motion_is_asked_for(tmp_path: Path) -> None:
    description = tmp_path / "one.yaml"
    whole = (SHIPPED / "simple-pendulum.yaml").read_text(encoding="utf-8")
    description.write_text(whole.replace("l: 0.5, ", ""), encoding="utf-8")
    out = tmp_path / "page.html"
    done = run(description, "-o", out, code=0)
    assert "Stand-ins for values that are not given, only to draw: l = 1." in done.output
    done = run(description, "--time", 1, "-o", tmp_path / "other.html", code=2)
    assert not (tmp_path / "other.html").exists()


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--time", "-1"), "--time"),
        (("--set", "nothing=1"), "nothing"),
        (("--set", "m=-1"), "declared positive"),
        (("--time", "x", "--set", "l=1/0"), "--time"),
    ],
)
def test_wrong_options(options: tuple[str, ...], complaint: str, tmp_path: Path) -> None:
    done = run(SHIPPED / "simple-pendulum.yaml", *options, "-o", tmp_path / "page.html", code=2)
    assert complaint in done.output
    assert not (tmp_path / "page.html").exists()


def test_systems_of_matrices_have_no_picture(tmp_path: Path) -> None:
    done = run(SHIPPED / "gyroscopic-pair.yaml", "-o", tmp_path / "page.html", code=2)
    assert "given by its matrices" in done.output


# ---- in a browser ---------------------------------------------------------------------------------------------------


browser = windows.browser  # one Chromium a process: Playwright runs once


class Window:
    """A page from a file, with everything that it complained of or asked for."""

    def __init__(self, browser: Any, path: Path, **options: Any) -> None:
        self.complaints: list[str] = []
        self.page = browser.new_page(viewport={"width": 480, "height": 320}, **options)
        self.page.on("console", self.heard)
        self.page.on("pageerror", lambda one: self.complaints.append(str(one)))
        self.asked: list[str] = []
        self.page.on("request", lambda one: self.asked.append(one.url))
        self.page.goto(path.as_uri())
        self.page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def heard(self, one: Any) -> None:
        """All but what a software renderer says of its own speed (``windows.Window.heard``)."""
        if "GL Driver Message" not in one.text:
            self.complaints.append(one.text)


@pytest.fixture
def show(browser: Any) -> Iterator[Callable[[Path], Window]]:
    """Opens pages for a reader who wants things still, and closes them: what moves costs the tests after it."""
    shown: list[Window] = []

    def one(out: Path) -> Window:
        shown.append(Window(browser, out, reduced_motion="reduce"))
        return shown[-1]

    yield one
    for window in shown:
        window.page.close()


@pytest.fixture(scope="module")
def still(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Window]:
    """The double pendulum, for a reader who wants things still."""
    out = tmp_path_factory.mktemp("view") / "page.html"
    text, _ = viewed(mbsym.load(SHIPPED / "double-pendulum.yaml").system, {}, 2.0, modes=True, equilibria=True)
    out.write_text(text, encoding="utf-8")
    window = Window(browser, out, reduced_motion="reduce")
    yield window
    window.page.close()


SHOWN = "([told, state]) => { const v = mbsymViewer; v.show(told); v.stage.renderer.render(v.stage.drawing.scene, \
v.stage.eye.camera); return Array.from(v.poses.at(state)); }"


def test_every_system_is_drawn_where_the_library_says(still: Window) -> None:
    """Each shipped system on one page: no complaint, and the page's poses are those of the library's interpreter."""
    source = np.random.default_rng(4)
    for path in DRAWN:
        found = picture(mbsym.load(path).system)
        state = {name: float(x) for name, x in zip(found.program.inputs, source.normal(size=99), strict=False)}
        values = still.page.evaluate(SHOWN, [as_json(found), state])
        there = [None if x is None else float(x) for x in values]
        own = [float(x) for x in found.program.evaluate(state)]
        assert there == pytest.approx(own, rel=1e-12, abs=1e-12), path.stem
        assert not still.complaints, (path.stem, still.complaints)


#: A browser in which these kinds of canvases are missing.
WITHOUT = (
    "HTMLCanvasElement.prototype.getContext = (own => function (kind, ...more) {{"
    " return {} ? null : own.call(this, kind, ...more); }})"
    "(HTMLCanvasElement.prototype.getContext);"
)


def test_without_a_graphics_card_the_same_is_drawn_flat(browser: Any, tmp_path: Path) -> None:
    """The bob of the pendulum is where WebGL draws it, in its colour, and moves."""
    out = tmp_path / "page.html"
    text, _ = viewed(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, {}, 0.5)
    out.write_text(text, encoding="utf-8")
    page = browser.new_page(reduced_motion="reduce")
    page.add_init_script(WITHOUT.format("kind.startsWith('webgl')"))
    page.goto(out.as_uri())
    look = """(t) => new Promise((done) => {
      mbsymViewer.go(t, false);
      requestAnimationFrame(() => requestAnimationFrame(() => {
        const { stage, picture, poses } = mbsymViewer, ratio = stage.canvas.width / stage.element.clientWidth;
        const [x, y] = stage.projected(poses.values, picture.bodies[0].centre);
        const place = [Math.round(ratio * x), Math.round(ratio * y)];
        done([x, y, ...stage.canvas.getContext('2d').getImageData(...place, 1, 1).data]);
      }));
    })"""
    there, later = (page.evaluate(look, t) for t in (0, 0.5))
    assert np.hypot(there[0] - later[0], there[1] - later[1]) > 20
    for seen in (there, later):  # blue
        assert seen[4] > seen[2] + 40
    assert page.get_by_role("button", name="Closer").count() == 1
    page.close()


def test_without_any_canvas_a_motion_is_told_all_the_same(browser: Any, tmp_path: Path) -> None:
    """A browser that draws nothing: time goes on, energy and positions are told, and no button is for a picture."""
    out = tmp_path / "page.html"
    text, _ = viewed(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, {}, 0.2)
    out.write_text(text, encoding="utf-8")
    page = browser.new_page()
    page.add_init_script(WITHOUT.format("true"))
    page.goto(out.as_uri())
    page.get_by_text("positions are told below in words").wait_for()
    page.locator(".viewer-reading").filter(has_text="energy").wait_for()
    page.get_by_text("In words", exact=True).click()
    row = page.get_by_role("row", name="pendulum")
    row.wait_for()
    told = row.inner_text()
    last = "told => [...document.querySelectorAll('.viewer-words tbody tr')].at(-1).innerText !== told"
    page.wait_for_function(last, arg=told)
    page.get_by_role("button", name="Pause").click()
    assert page.get_by_role("button", name="Closer").count() == 0
    page.close()


def test_the_page_by_keys(show: Callable[[Path], Window], tmp_path: Path) -> None:
    """Sliders, time, modes and equilibria without a pointer; nothing moves by itself where that is not wanted."""
    out = tmp_path / "page.html"
    text, _ = viewed(mbsym.load(SHIPPED / "simple-pendulum.yaml").system, {}, 2.0, modes=True, equilibria=True)
    out.write_text(text, encoding="utf-8")
    window = show(out)
    page = window.page
    assert page.get_by_role("button", name="Play").is_visible()
    slider = page.get_by_role("slider", name=re.compile("^theta"))
    assert float(slider.input_value()) == pytest.approx(0.5)
    slider.focus()
    page.keyboard.press("ArrowRight")
    assert page.evaluate("() => mbsymViewer.state.theta") == pytest.approx(0.5 + 2 * np.pi / 100)
    page.locator("canvas.viewer-canvas").focus()
    page.keyboard.press(".")
    assert page.evaluate("() => mbsymViewer.playing.t") == pytest.approx(0.02)
    before = page.evaluate("() => mbsymViewer.stage.eye.camera.position.toArray()")
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("() => mbsymViewer.stage.eye.camera.position.toArray()") != before
    page.get_by_role("button", name=re.compile("unstable|theta = pi")).first.click()
    assert abs(page.evaluate("() => mbsymViewer.state.theta")) == pytest.approx(np.pi)
    page.get_by_role("button", name=re.compile("^Mode 1")).click()
    assert page.evaluate("() => mbsymViewer.playing.what") == "mode"
    assert "Mode 1" in page.locator(".viewer-said").inner_text()
    label = page.locator("canvas.viewer-canvas").get_attribute("aria-label")
    assert "pendulum" in label
    assert not window.complaints
    assert all(url.startswith(("file:", "blob:", "data:")) for url in window.asked)


def test_a_loop_follows_its_slider_or_says_that_it_is_open(still: Window) -> None:
    """The crank of the four-bar linkage on the page, by the page's own Newton steps."""
    found = as_json(picture(mbsym.load(SHIPPED / "four-bar.yaml").system))
    state = "(q) => { mbsymViewer.slid('q1', q); return [mbsymViewer.state, mbsymViewer.said.textContent]; }"
    still.page.evaluate("(told) => mbsymViewer.show(told)", found)
    for crank in (2.3, 2.6, 1.9):
        there, said = still.page.evaluate(state, crank)
        assert there["q1"] == crank
        assert said == ""
        turned, tip = 0.0, np.array([0.13, 0.0])
        for rod, name in zip((0.24, 0.21, 0.34), ("q1", "q2", "q3"), strict=True):
            turned += there[name]
            tip = tip + rod * np.array([np.cos(turned), np.sin(turned)])
        assert tip == pytest.approx([0, 0], abs=1e-8)
    text = (SHIPPED / "four-bar.yaml").read_text(encoding="utf-8").replace("l4: 0.34", "l4: 0.05")
    short = as_json(picture(mbsym.loads(text).system))
    still.page.evaluate("(told) => mbsymViewer.show(told)", short)
    _, said = still.page.evaluate(state, 0.0)
    assert "open" in said


def test_markup_stays_text_in_a_browser(show: Callable[[Path], Window], tmp_path: Path) -> None:
    out = filed(tmp_path / "page.html", viewed(mbsym.loads(HOSTILE).system, {}, 1.0, modes=True)[0])
    window = show(out)
    assert not window.complaints
    assert window.page.locator("img, iframe, svg:not(.viewer-axes), b").count() == 0
    assert "onerror" in window.page.locator("h1").inner_text()
