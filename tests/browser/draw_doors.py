"""Draws the README's pictures of a paper, a robot and the editor again: `make window`."""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
from pathlib import Path

from click.testing import CliRunner
from conftest import CHROMIUM
from pages import DOCS, blocks
from PIL import Image
from playwright.sync_api import Browser, sync_playwright
from windows import Window, serving

from mbsym_cli.main import main as mbsym

ROOT = Path(__file__).parents[2]
SIZE = {"width": 1440, "height": 900}


def few_colours(data: bytes, width: int, colours: int) -> Image.Image:
    image = Image.open(io.BytesIO(data)).convert("RGB")
    image = image.resize((width, image.height * width // image.width), Image.Resampling.LANCZOS)
    return image.quantize(colours, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def run(*words: object) -> None:
    done = CliRunner().invoke(mbsym, [str(word) for word in words], catch_exceptions=False)
    assert done.exit_code == 0, done.output


def paper(folder: Path, place: Path) -> None:
    """Notation and stability of the satellite, as its report has them."""
    run("run", ROOT / "systems" / "satellite.yaml", "--format", "latex", "--out", place, "--quiet")
    for _ in range(2):
        subprocess.run(["pdflatex", "-interaction=batchmode", "report.tex"], cwd=place, check=True, capture_output=True)
    page = 0
    words = ""
    while "Problem 6. Stability" not in words or "Contents" in words:
        page += 1
        only = ["-f", str(page), "-l", str(page)]
        words = subprocess.run(
            ["pdftotext", *only, "report.pdf", "-"], cwd=place, check=True, capture_output=True, text=True
        ).stdout
    subprocess.run(["pdftoppm", "-r", "110", "-png", "-singlefile", *only, "report.pdf", "page"], cwd=place, check=True)
    image = Image.open(place / "page.png").convert("L")
    width, height = image.size
    image = image.crop((width // 12, height // 5, width * 11 // 12, height // 5 + width * 25 // 48))
    image.resize((800, 500), Image.Resampling.LANCZOS).quantize(16).save(folder / "paper.png", optimize=True)


def robot(folder: Path, place: Path, chromium: Browser) -> None:
    """The arm of the page on robots, bent."""
    source = next(one for one in blocks((DOCS / "howto" / "robots.md").read_text("utf-8")) if one.title == "arm.urdf")
    (place / "arm.urdf").write_text(source.text, encoding="utf-8")
    run("convert", place / "arm.urdf", "--symbols", "--out", place / "arm.yaml")
    run("view", place / "arm.yaml", "--set", "q1=-1/2", "--set", "q2=6/5", "--out", place / "arm.html", "--quiet")
    page = chromium.new_page(viewport={"width": 1240, "height": 720})
    page.goto((place / "arm.html").as_uri())
    page.wait_for_timeout(1500)
    canvas = page.locator("canvas").first
    canvas.focus()
    for key in ("ArrowRight",) * 4 + ("ArrowUp",) * 2 + ("+",) * 3:
        page.keyboard.press(key)
    page.wait_for_timeout(500)
    box = canvas.bounding_box()
    assert box is not None
    middle = box["y"] + box["height"] / 2
    clip = {"x": box["x"] + 4, "y": middle - 270, "width": 736, "height": 460}
    few_colours(page.screenshot(clip=clip), 800, 64).save(folder / "robot.png", optimize=True)
    page.close()


def main(folder: Path) -> None:
    with sync_playwright() as running, tempfile.TemporaryDirectory() as place:
        chromium = running.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        paper(folder, Path(place))
        robot(folder, Path(place), chromium)
        for name, chosen in (("satellite", "satellite"), ("double-pendulum", None)):
            path = Path(place) / f"{name}.yaml"
            path.write_bytes((ROOT / "systems" / path.name).read_bytes())
            with serving(path) as address:
                page = chromium.new_page(viewport=SIZE)
                window = Window(page, path)
                window.open(address)
                if chosen is not None:
                    window.body(chosen).click()
                    page.get_by_text("What was found").wait_for()
                    page.wait_for_timeout(4000)
                    few_colours(page.screenshot(), 1080, 64).save(folder / "window.png", optimize=True)
                else:
                    page.wait_for_timeout(2000)
                    page.get_by_role("button", name="Simulate").click()
                    page.get_by_role("button", name="Pause").or_(page.get_by_role("button", name="Play")).wait_for()
                    page.wait_for_timeout(1500)
                    shots = []
                    for _ in range(24):
                        shots.append(few_colours(page.screenshot(), 720, 32))
                        page.wait_for_timeout(80)
                    gif = folder / "window.gif"
                    shots[0].save(gif, save_all=True, append_images=shots[1:], duration=160, loop=0, optimize=True)
                page.close()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
