"""Draws the README's picture and animation of the editor again: `make window`."""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path

from conftest import CHROMIUM
from PIL import Image
from playwright.sync_api import sync_playwright
from windows import Window, serving

ROOT = Path(__file__).parents[2]
SIZE = {"width": 1440, "height": 900}


def few_colours(data: bytes, width: int, colours: int) -> Image.Image:
    image = Image.open(io.BytesIO(data)).convert("RGB")
    image = image.resize((width, image.height * width // image.width), Image.Resampling.LANCZOS)
    return image.quantize(colours, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)


def main(folder: Path) -> None:
    with sync_playwright() as running, tempfile.TemporaryDirectory() as place:
        chromium = running.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
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
