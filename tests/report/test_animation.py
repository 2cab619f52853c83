"""The moving system: what is drawn, the page in a browser, the GIF read by Pillow, figures as PDF."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import windows
from conftest import SHIPPED, TESTS, filed, invoked
from PIL import Image

import mbsym
from mbsym.numerics.positions import positions
from mbsym.picture.looking import projection
from mbsym.picture.values import Picture
from mbsym.report.figures.animation import MOST, TALL, WIDE, animation_gif, animation_mp4
from mbsym.report.figures.figures import figures
from mbsym.report.figures.motion_figure import view
from mbsym.report.html.report import asked_motion
from mbsym.report.language import Language
from mbsym.report.targets import TARGETS
from mbsym.report.viewer.motion import Motion, motion_of, moving_picture, run_sentences
from mbsym.report.viewer.page import AFTER, KEYS, NAMED, NEEDED, WORDS, animation_page, modes_part, picture_part
from mbsym.simulation import Simulation
from mbsym.studies.simulate.files import motion_files
from tests.report.readers import unreadable


@cache
def run(name: str, time: float, samples: int = 201) -> Simulation:
    return mbsym.simulate(SHIPPED / f"{name}.yaml", time, samples=samples)


@cache
def moving(name: str, time: float) -> tuple[Picture, Motion]:
    return moving_picture(run(name, time))


@cache
def page(name: str, time: float) -> str:
    return animation_page(run(name, time))


def data(text: str) -> dict:
    return json.loads(re.search(r'id="picture-data">(.*?)</script>', text)[1])


# --- what is drawn ---


def test_frames_are_samples_of_the_run() -> None:
    """The second mass of the double pendulum is where its angles put it, in what the page holds."""
    found, whole = data(page("double-pendulum", 6)), run("double-pendulum", 6)
    motion = found["motion"]
    assert np.allclose(motion["times"], whole.times)
    assert np.allclose(motion["energy"], whole.energy, rtol=1e-9)
    (second,) = [body for body in found["picture"]["bodies"] if body["name"] == "second rod"]
    picture, _ = moving("double-pendulum", 6)
    columns = {name: np.array(values) for name, values in motion["coordinates"].items()}
    columns |= {name: np.array(values) for name, values in motion["velocities"].items()} | {
        "t": np.array(motion["times"])
    }
    values = picture.program.evaluate(columns)
    first, angle = whole["theta1"], whole["theta2"]
    tip = np.array([values[k] + 0 * first for k in second["centre"]])
    absolute = [np.sin(first) + np.sin(angle), -np.cos(first) - np.cos(angle), 0 * first]
    relative = [np.sin(first) + np.sin(first + angle), -np.cos(first) - np.cos(first + angle), 0 * first]
    assert any(np.allclose(tip, wanted, atol=1e-9) for wanted in (absolute, relative))


def test_long_runs_are_thinned_to_samples() -> None:
    long = mbsym.simulate(SHIPPED / "simple-pendulum.yaml", 5.0, samples=5001, estimate=False)
    found = motion_of(long)
    assert len(found.times) <= 2401
    assert set(found.times) <= set(long.times)
    assert "one of 3 samples" in animation_page(long)  # every second one would be 2501 of them


def test_a_run_in_declared_variables_moves_in_coordinates() -> None:
    """The axes of the top are the unit vectors that were integrated, to the rounding of angles."""
    whole = mbsym.simulate(SHIPPED / "kovalevskaya.yaml", 3.0, samples=61, estimate=False)
    assert whole.dynamics.in_states
    picture, motion = moving_picture(whole)
    values = picture.program.evaluate({"t": motion.times, **motion.coordinates})
    (body,) = picture.bodies
    third = np.array([[np.broadcast_to(values[row[2]], motion.times.shape)] for row in body.axes])[:, 0]
    gamma = np.array([whole[name] for name in whole.given.system.body(body.name).orientation[2].components])
    assert np.allclose(third, gamma, atol=1e-9)
    assert max(np.max(np.abs(np.diff(x))) for x in motion.coordinates.values()) < np.pi


@pytest.mark.parametrize("name", ["double-pendulum", "satellite", "tethered-satellites"])
def test_the_eye_has_right_handed_axes(name: str) -> None:
    whole = run(name, 4.0)
    drawn = positions(whole.scenario, whole.times, whole.trajectory.states)
    look = np.array(projection(view(drawn)))
    assert np.allclose(look @ look.T, np.eye(3))
    assert np.linalg.det(look) == pytest.approx(1)
    if drawn.plane is not None:
        assert abs(look[2, drawn.plane - 1]) == pytest.approx(1)


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
    said = data(text)["motion"]
    assert said["doubts"] == []
    for sentence in (
        f"Integrated from t = 0 to 6 by {whole.chosen.method.traits.title} (tolerance 1e-10 per step",
        "Energy (T - U): conserved (proved)",
        "Error of the run: about ",
        "between frames coordinates are joined by straight lines",
    ):
        assert any(sentence in x for x in said["sentences"]), sentence
    assert said["driftOf"] == "drift of the energy"
    assert text == animation_page(whole)
    damped = data(page("simple-pendulum", 2.0))["motion"]  # a damper takes its energy: that is no error
    assert damped["driftOf"] == "change of the energy"
    early = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 6, step_limit=100, samples=601)
    assert not early.whole
    doubts = data(animation_page(early))["motion"]["doubts"]
    assert "The run ended early (step limit); 6 was asked for." in doubts


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


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Callable[..., Any]]:
    """Opens a page under its own policy; what it complains of fails the test."""
    said: list[str] = []
    pages = []

    def one(text: str, **options: Any) -> Any:
        file = filed(tmp_path / "animation.html", text)
        shown = browser.new_page(**options)
        pages.append(shown)
        shown.on("console", lambda heard: said.append(heard.text))
        shown.on("pageerror", lambda heard: said.append(str(heard)))
        shown.goto(file.as_uri())
        return shown

    yield one
    for shown in pages:
        shown.close()
    assert [line for line in said if "GL Driver Message" not in line] == []


def test_the_page_moves_and_stops(opened: Callable[..., Any]) -> None:
    shown = opened(page("satellite", 4.0))
    shown.wait_for_function("() => mbsymViewer.playing.t > 0")
    shown.get_by_role("button", name="Pause").click()
    shown.get_by_role("button", name="Play").wait_for()
    clock = shown.locator(".viewer-clock").inner_text()
    assert clock.startswith("t = ")
    assert float(clock.split("=")[1]) > 0


def test_motion_waits_for_those_who_want_less_of_it(opened: Callable[..., Any]) -> None:
    shown = opened(page("satellite", 4.0), reduced_motion="reduce")
    assert shown.get_by_role("button", name="Play").is_visible()
    assert shown.evaluate("() => mbsymViewer.playing.t") == 0


TURNTABLE = """mbsym: 1
name: turntable
parameters: {w: {sign: positive, value: 2, meaning: rate of the table}}
bodies:
  - {name: table, attached to: 0, mass: 0, rotation: {axes: [3], angles: [w*t]}}
  - {name: arm, attached to: table, mass: 1, mass centre: [1, 0, 0], coordinates: [z], connection point: [0, 0, z]}
loads: [{spring: {coordinate: z, stiffness: 3}}]
initial: {z: 0}
"""


def test_the_page_tells_its_values_and_no_rest_of_what_turns(opened: Callable[..., Any]) -> None:
    """Parameters and initial values stand there, and a table that turns as prescribed does not rest with its arm."""
    shown = opened(animation_page(mbsym.simulate(mbsym.loads(TURNTABLE), 5.0)), reduced_motion="reduce")
    said = shown.locator("#viewer").text_content()
    assert "No coordinate changes in this motion." in said
    assert "rests" not in said
    shown.locator("summary", has_text="Values").click()
    rows = shown.locator("details", has_text="Values").locator("tr")
    assert [row.split() for row in rows.all_inner_texts()] == [
        ["w", "2", "rate", "of", "the", "table"],
        ["z", "0", "initial", "value"],
        ["dz/dt", "0", "initial", "velocity"],
    ]


def test_the_policy_lets_the_page_run_as_it_is(opened: Callable[..., Any]) -> None:
    """With a hostile name, which stays a name."""
    attack = "</script><script>document.title='owned'</script>"
    whole = run("double-pendulum", 6)
    system = replace(whole.system, name=attack, description=attack)
    shown = opened(animation_page(replace(whole, scenario=replace(whole.scenario, system=system))))
    shown.get_by_role("button", name="Pause").wait_for()
    assert shown.title() == attack


def test_the_viewer_has_its_words_from_the_page_in_its_language(opened: Callable[..., Any]) -> None:
    """Each that its sources ask for, and no other; in every language that reports have."""
    asked = set()
    for one in (TESTS.parent / "editor/src/picture").glob("*.ts"):
        code = re.sub(r"(?m)^\s*(//|\*|/\*).*|//.*$|new Error\([^\n]*", "", one.read_text(encoding="utf-8"))
        asked |= set(re.findall(r'\bsay\("([^"]*)"[,)]', code))
        rest = re.sub(r'\bsay\("[^"]*"|\b(class|type|style): "[^"]*"|case "[^"]*"', "", code)
        words = [re.sub(r"\$\{[^}]*\}", "", text) for text in re.findall(r'"[^"\n]*"|`[^`\n]*`', rest)]
        assert [text for text in words if re.search(r"[a-z]{3,},? [a-z]{2,}", text)] == [], one.name
    assert asked == set(WORDS)
    system = mbsym.load(SHIPPED / "double-pendulum.yaml").system
    sentences = [*picture_part(system, {})["sentences"], *modes_part(system, {})["sentences"]]
    for name in ("ru", "es"):
        told = {word: Language(name).say(word) for word in (*WORDS, *NAMED, *sentences, KEYS, NEEDED, AFTER)}
        assert [word for word, said in told.items() if said == word] == []
    whole = run("double-pendulum", 6)
    system = replace(whole.system, language="es")
    shown = opened(animation_page(replace(whole, scenario=replace(whole.scenario, system=system))))
    shown.get_by_role("button", name="Pausa").wait_for()
    assert shown.locator("html").get_attribute("lang") == "es"
    assert shown.get_by_role("button", name="Ejes", exact=True).count() == 1


# --- other consumers ---


def test_the_gif_is_a_film() -> None:
    raw = animation_gif(run("double-pendulum", 6))
    assert raw == animation_gif(run("double-pendulum", 6))
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


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg")
def test_the_video_plays_everywhere(tmp_path: Path) -> None:
    """H.264 or MPEG-4 in mp4, its index in front; as many frames as were drawn, the first one as in the GIF."""
    raw = animation_mp4(run("double-pendulum", 6))
    assert raw == animation_mp4(run("double-pendulum", 6))
    assert raw[4:8] == b"ftyp"
    assert raw.index(b"moov") < raw.index(b"mdat")
    (tmp_path / "film.mp4").write_bytes(raw)
    words = [
        "ffmpeg",
        "-loglevel",
        "error",
        "-i",
        str(tmp_path / "film.mp4"),
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-",
    ]
    frames = np.frombuffer(subprocess.run(words, capture_output=True, check=True).stdout, dtype=np.uint8)
    film = frames.reshape(-1, TALL, WIDE, 3).astype(int)
    assert len(film) == len(run("double-pendulum", 6).trajectory.times)
    with Image.open(BytesIO(animation_gif(run("double-pendulum", 6)))) as gif:
        assert np.mean(np.abs(film[0] - np.asarray(gif.convert("RGB"), dtype=int))) < 4
    assert np.max(np.abs(film[0] - film[-1])) > 100


def test_without_ffmpeg_a_video_is_refused_before_anything_is_integrated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    words = ["simulate", str(SHIPPED / "double-pendulum.yaml"), "--format", "mp4", "--out", str(tmp_path / "out")]
    done = invoked(*words, code=2)
    assert "--format: error[no-ffmpeg]: ffmpeg makes mp4, and there is none on the path" in done.stderr
    assert not (tmp_path / "out").exists()


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


def test_where_nothing_is_seen_it_is_told_why() -> None:
    """A bead at a pole of its force has a place, but its run ends there at once."""
    text = """mbsym: 1
name: at a pole
bodies: [{name: bead, attached to: 0, mass: 1, coordinates: [x], connection point: [x, 0, 0]}]
loads: [{force: {body: bead, point: [0, 0, 0], components: [1/(x - 1), 0, 0], axes: 0}}]
initial: {x: 1}
"""
    analysis = mbsym.loads(text)
    motion, why = asked_motion(analysis.system, 3.0, Language("en"))
    assert motion is None
    assert why == "the run ended where it began"
    files = motion_files(mbsym.simulate(analysis, 3.0), None, ("html", "gif"))
    assert not {"animation.html", "animation.gif"} & set(files.contents)
    assert [note for note in files.notes if "animation" in note] == [
        "no animation.html: the run ended where it began",
        "no animation.gif: the run ended where it began",
    ]


def test_the_report_shows_the_motion_where_that_is_asked_for(opened: Callable[..., Any]) -> None:
    """Nothing is integrated unless it is; then the page moves; a missing number is named."""
    analysis = mbsym.load(SHIPPED / "double-pendulum.yaml")
    assert "picture-data" not in TARGETS["html"].render(analysis, (3,))
    analysis.animate = 3.0
    text = TARGETS["html"].render(analysis, (3,))
    assert unreadable("report.html", text) == ""
    shown = opened(text)
    shown.locator("#motion .viewer").get_by_role("button", name="Pause").wait_for()
    assert "Integrated from t = 0 to 3 by" in shown.locator(".viewer-how").text_content()
    bare = mbsym.loads((SHIPPED / "double-pendulum.yaml").read_text(encoding="utf-8").split("initial:")[0])
    bare.animate = 3.0
    text = TARGETS["html"].render(bare, (3,))
    assert "No motion is shown: no value for theta1 (its initial position)" in text
    assert "picture-data" not in text
