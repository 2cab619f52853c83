"""The moving system: what is drawn, the page in a browser, the GIF read by Pillow, figures as PDF."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
from dataclasses import replace
from functools import cache
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import windows
from conftest import SHIPPED, TESTS, browsed, needs_chromium
from PIL import Image

import mbsym
from mbsym.picture.looking import projection
from mbsym.report.figures.animation import Animation, animation, view
from mbsym.report.figures.animation_gif import MOST, TALL, WIDE, animation_gif
from mbsym.report.figures.animation_page import animation_page, run_sentences
from mbsym.report.figures.figures import figures
from mbsym.report.targets import TARGETS
from mbsym.report.viewer.page import motion_of
from mbsym.simulation import Simulation
from tests.report.readers import unreadable


@cache
def run(name: str, time: float, samples: int = 201) -> Simulation:
    return mbsym.simulate(SHIPPED / f"{name}.yaml", time, samples=samples)


@cache
def scene(name: str, time: float) -> Animation:
    found = animation(run(name, time))
    assert found is not None
    return found


@cache
def page(name: str, time: float) -> str:
    return animation_page(scene(name, time), run(name, time))


def data(text: str) -> dict:
    return json.loads(re.search(r'id="motion-data">(.*?)</script>', text)[1])


def floats(packed: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed), dtype="<f4")


# --- what is drawn ---


def test_frames_are_samples_of_the_run() -> None:
    """The tip of the double pendulum is where its angles put it, in what the page holds; no frame is made up."""
    found, whole = data(page("double-pendulum", 6)), run("double-pendulum", 6)
    times = floats(found["times"])
    assert np.allclose(times, whole.times, atol=1e-6)
    places = floats(found["places"]).reshape(-1, 3, len(times))
    first, second = whole["theta1"], whole["theta2"]
    tip = [np.sin(first) + np.sin(first + second), -np.cos(first) - np.cos(first + second), 0 * first]
    relative = [np.sin(first) + np.sin(second), -np.cos(first) - np.cos(second), 0 * first]
    assert any(np.allclose(place, wanted, atol=1e-5) for place in places for wanted in (tip, relative))
    assert np.allclose(floats(found["energy"]), whole.energy, rtol=1e-6)


def test_long_runs_are_thinned_to_whole_samples() -> None:
    long = mbsym.simulate(SHIPPED / "simple-pendulum.yaml", 5.0, samples=5001, estimate=False)
    found = animation(long)
    assert found is not None
    assert found.frames <= 1200
    assert np.array_equal(found.times, long.times[:: found.stride])
    assert f"one of {found.stride} samples" in animation_page(found, long)


def test_ellipsoids_have_the_inertia_of_their_bodies() -> None:
    """m/5 (b^2 + c^2) about each axis: the satellite's Jx, Jy, Jz; true to scale, along its axes."""
    found = scene("satellite", 4.0)
    (body,) = [item for item in found.ellipsoids if item.body == "satellite"]
    assert found.true_size
    squares = np.sum(body.axes[:, :, 0] ** 2, axis=1)
    moments = 10 / 5 * np.array([squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]])
    assert sorted(moments) == pytest.approx(sorted([2.4, 1.2, 2.3]))


@pytest.mark.parametrize("name", ["double-pendulum", "satellite", "tethered-satellites"])
def test_the_eye_has_right_handed_axes(name: str) -> None:
    look = np.array(projection(view(scene(name, 4.0).positions)))
    assert np.allclose(look @ look.T, np.eye(3))
    assert np.linalg.det(look) == pytest.approx(1)
    if scene(name, 4.0).positions.plane is not None:
        assert abs(look[2, scene(name, 4.0).positions.plane - 1]) == pytest.approx(1)


@pytest.mark.parametrize(("plane", "up"), [(1, 3), (1, 2), (2, 3), (2, 1), (3, 2), (3, 1)])
def test_a_plane_motion_is_seen_with_its_sideways_axis_to_the_right(plane: int, up: int) -> None:
    axes = np.eye(3)
    found: Any = SimpleNamespace(up=tuple(axes[up - 1]), plane=plane)
    right, upwards, towards = np.array(projection(view(found)))
    assert right == pytest.approx(axes[6 - plane - up - 1], abs=1e-12)
    assert upwards == pytest.approx(axes[up - 1], abs=1e-12)
    assert abs(towards) == pytest.approx(axes[plane - 1], abs=1e-12)


def test_the_page_says_what_was_integrated() -> None:
    text, whole = page("double-pendulum", 6), run("double-pendulum", 6)
    assert unreadable("animation.html", text) == ""
    for said in (
        f"Integrated from t = 0 to 6 by {whole.chosen.method.traits.title} (tolerance 1e-10 per step",
        "Energy (T - U): conserved (proved)",
        "<span>relative drift of the energy",
        "Error of the run: about ",
        "between frames points are joined by straight lines, nothing is computed there",
    ):
        assert said in text
    assert text == animation_page(scene("double-pendulum", 6), whole)
    damped = run("simple-pendulum", 2.0)  # a damper takes its energy: that is no error
    assert "<span>relative change of the energy" in animation_page(scene("simple-pendulum", 2.0), damped)
    early = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 6, step_limit=100, samples=601)
    assert not early.whole
    assert "The run ended early (step limit); 6 was asked for." in animation_page(animation(early), early)


def test_what_is_called_conserved_is_the_energy_that_is() -> None:
    """A bead on a hoop that is turned: h = m R^2 (theta'^2 - Omega^2 sin^2 theta)/2 - m g R cos theta is constant,
    T - U = h + m R^2 Omega^2 sin^2 theta is not: the motor works."""
    found = mbsym.simulate(TESTS / "cases" / "statements" / "bead_on_hoop.yaml", 4, samples=401)
    theta, rate = found.trajectory.states[:2]
    h = 0.1 * 0.3**2 * (rate**2 - 64 * np.sin(theta) ** 2) / 2 - 0.1 * 9.81 * 0.3 * np.cos(theta)
    energy = h + 0.1 * 0.3**2 * 64 * np.sin(theta) ** 2
    assert np.ptp(h) < 1e-9 * np.ptp(energy)
    for said in (tuple(run_sentences(found)), motion_of(found).sentences):
        assert any(x.startswith("Energy (T2 - T0 - U): conserved (proved)") for x in said)
        assert any(x.startswith("Energy (T - U): not conserved") for x in said)
        assert not any("conserved (proved)" in x and "(T - U)" in x for x in said)


# --- a browser ---

browser = windows.browser

PROBE = """<script>
let waited = 0;
const waiting = setInterval(() => {
  waited += 50;
  const label = document.getElementById("motion-play").textContent;
  const still = label === "Pause" && Number(document.getElementById("motion-time").value) <= 0;
  if (waited < 500 || (still && waited < 20000)) return;
  clearInterval(waiting);
  const canvas = document.getElementById("motion-canvas");
  const painted = () => {
    const pixels = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
    let count = 0, sum = 0;
    for (let k = 3; k < pixels.length; k += 4) if (pixels[k]) { count += 1; sum = (sum * 31 + k) % 1000003; }
    return [count, sum];
  };
  const press = (key) => canvas.dispatchEvent(new KeyboardEvent("keydown", { key, cancelable: true }));
  const time = () => Number(document.getElementById("motion-time").value);
  const text = (id) => document.getElementById(id).textContent;
  const seen = { moved: time(), label: text("motion-play"), energy: text("motion-energy") };
  if (text("motion-play") === "Pause") press(" ");
  seen.paused = text("motion-play");
  const before = painted();
  press("ArrowLeft"); seen.turned = painted()[1] !== before[1];
  press("0"); seen.reset = painted()[1] === before[1];
  press("+"); seen.closer = painted()[1] !== before[1]; press("0");
  const held = time(); press("."); seen.step = time() - held;
  const slider = document.getElementById("motion-time");
  slider.value = "0.5"; slider.dispatchEvent(new Event("input"));
  seen.half = text("motion-reading"); seen.ink = painted()[0];
  document.body.dataset.seen = JSON.stringify(seen);
}, 50);
</script></body>"""


def probed(browser: Any, text: str, file: Path, **options: str) -> dict:
    """What the page does, seen by a script in place of its policy, in time as it is: under virtual time a browser draws
    when it likes."""
    file.write_text(re.sub(r"<meta http-equiv[^>]*>", "", text).replace("</body>", PROBE), encoding="utf-8")
    said: list[str] = []
    shown = browser.new_page(**options)
    shown.on("console", lambda one: said.append(one.text))
    shown.on("pageerror", lambda one: said.append(str(one)))
    shown.goto(file.as_uri())
    shown.locator("body[data-seen]").wait_for(state="attached")
    seen = shown.locator("body").get_attribute("data-seen")
    shown.close()
    assert [line for line in said if "read-frequently" not in line and "willReadFrequently" not in line] == []
    return json.loads(seen)


def test_the_page_moves_and_obeys(tmp_path: Path, browser: Any) -> None:
    seen = probed(browser, page("satellite", 4.0), tmp_path / "animation.html")
    assert seen["moved"] > 0
    assert seen["label"] == "Pause"
    assert seen["paused"] == "Play"
    assert seen["turned"]
    assert seen["reset"]
    assert seen["closer"]
    assert seen["step"] == pytest.approx(0.01)
    assert seen["half"] == "t = 2"
    assert seen["ink"] > 500
    assert float(seen["energy"]) == pytest.approx(run("satellite", 4.0).energy[0], rel=1e-2)


def test_motion_waits_for_those_who_want_less_of_it(tmp_path: Path, browser: Any) -> None:
    seen = probed(browser, page("satellite", 4.0), tmp_path / "animation.html", reduced_motion="reduce")
    assert seen["moved"] == 0
    assert seen["label"] == "Play"


@needs_chromium
def test_the_policy_lets_the_page_run_as_it_is(tmp_path: Path) -> None:
    """With a hostile name, which stays a name; nothing on the console; the script has run."""
    attack = "</script><script>document.title='owned'</script>"
    found, whole = scene("double-pendulum", 6), run("double-pendulum", 6)
    system = replace(found.system, name=attack, description=attack)
    hostile = replace(found, positions=replace(found.positions, system=system))
    (tmp_path / "a.html").write_text(animation_page(hostile, whole), encoding="utf-8")
    dom, said = browsed(tmp_path / "a.html")
    assert said == []
    assert "<title>owned" not in dom
    assert ">Pause</button>" in dom


# --- other consumers ---


def test_the_gif_is_a_film() -> None:
    raw = animation_gif(scene("double-pendulum", 6))
    assert raw == animation_gif(scene("double-pendulum", 6))
    with Image.open(BytesIO(raw)) as film:
        assert film.format == "GIF"
        assert film.size == (WIDE, TALL)
        assert film.n_frames == MOST
        assert film.info["loop"] == 0
        assert film.info["duration"] >= 40
        frames = []
        for k in (0, film.n_frames // 2, film.n_frames - 1):
            film.seek(k)
            frames.append(np.asarray(film.convert("RGB"), dtype=int))
    assert np.max(np.abs(frames[0] - frames[1])) > 100
    paths = frames[2][60:]  # coloured lines, below the words
    assert np.count_nonzero(np.ptp(paths, axis=2) > 60) > 200


@pytest.mark.skipif(shutil.which("pdftoppm") is None, reason="no pdftoppm")
def test_figures_as_pdf_can_be_read(tmp_path: Path) -> None:
    found = figures(run("double-pendulum", 6).trajectory, ["pdf"])
    assert set(found) == {"histories.pdf", "phase-planes.pdf", "drift.pdf"}
    assert found == figures(run("double-pendulum", 6).trajectory, ["pdf"])
    for name, raw in found.items():
        (tmp_path / name).write_bytes(raw)
        done = subprocess.run(["pdftoppm", "-r", "40", "-png", name, name], cwd=tmp_path, capture_output=True)
        assert done.returncode == 0
        assert done.stderr == b""
        with Image.open(tmp_path / f"{name}-1.png") as image:
            assert len(image.convert("L").getcolors()) > 10


# --- in report.html ---


@needs_chromium
def test_the_report_shows_the_motion_where_that_is_asked_for(tmp_path: Path) -> None:
    """Nothing is integrated unless it is; then the page moves; a missing number is named."""
    analysis = mbsym.load(SHIPPED / "double-pendulum.yaml")
    assert "motion-canvas" not in TARGETS["html"].render(analysis, (3,))
    analysis.animate = 3.0
    text = TARGETS["html"].render(analysis, (3,))
    assert unreadable("report.html", text) == ""
    (tmp_path / "report.html").write_text(text, encoding="utf-8")
    dom, said = browsed(tmp_path / "report.html")
    assert said == []
    assert ">Pause</button>" in dom
    assert "Integrated from t = 0 to 3 by" in dom
    bare = mbsym.loads((SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8").split("initial:")[0])
    bare.animate = 3.0
    text = TARGETS["html"].render(bare, (3,))
    assert "No motion is shown: no value for theta1 (its initial position)" in text
    assert "motion-canvas" not in text
