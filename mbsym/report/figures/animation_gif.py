"""``animation.gif``: the moving system in a loop of some seconds, for slides and chats."""

from __future__ import annotations

from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mbsym.model.quantities import time_unit, with_unit
from mbsym.picture.looking import projection
from mbsym.report.figures.animation import Animation, dots, moving_points, view

#: Pixels of the picture, how many times larger it is drawn, most frames, and seconds of the loop.
WIDE, TALL, FINER, MOST, SECONDS = 560, 420, 2, 120, 6.0
#: Hundredths of a second that a frame stands at least: viewers do not go faster.
SHORTEST = 4
PAPER, INK, SOFT = (255, 255, 255), (29, 36, 48), (120, 130, 145)
PATHS = ((179, 55, 47), (46, 139, 87), (217, 130, 43), (142, 94, 162), (23, 162, 184), (122, 92, 62))


def animation_gif(found: Animation) -> bytes:
    """The file; the same animation gives the same bytes (with one version of Pillow)."""
    chosen = np.unique(np.linspace(0, found.frames - 1, min(found.frames, MOST)).round().astype(int))
    picture = _Picture(found)
    frames = [picture.frame(int(k)) for k in chosen]
    each = max(SHORTEST, round(100 * SECONDS / len(frames)))
    palette = frames[-1].quantize(64, Image.Quantize.MEDIANCUT)
    shown = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    stream = BytesIO()
    shown[0].save(stream, "gif", save_all=True, append_images=shown[1:], duration=10 * each, loop=0, disposal=1)
    return stream.getvalue()


class _Picture:
    def __init__(self, found: Animation) -> None:
        self.found = found
        look = np.array(projection(view(found.positions)))
        self.flat = np.einsum("ij,pjm->pim", look, found.positions.places)
        self.bodies = [(np.einsum("ij,pjm->pim", look, item.axes), look @ item.places) for item in found.ellipsoids]
        self.look = look
        low, high = np.min(self.flat[:, :2], axis=(0, 2)), np.max(self.flat[:, :2], axis=(0, 2))
        for axes, place in self.bodies:
            reach = np.sqrt(np.sum(axes[:, :2] ** 2, axis=0))
            low = np.minimum(low, np.min(place[:2] - reach, axis=1))
            high = np.maximum(high, np.max(place[:2] + reach, axis=1))
        for outline in found.outlines:
            place = (look @ outline.places)[:2]
            low = np.minimum(low, np.min(place - outline.reach, axis=1))
            high = np.maximum(high, np.max(place + outline.reach, axis=1))
        self.middle = (low + high) / 2
        size = np.maximum(high - low, 1e-12 * max(1.0, float(np.max(np.abs(high)))))
        self.scale = 0.86 * FINER * min(WIDE / float(size[0]), (TALL - 40) / float(size[1]))
        try:
            self.font: Any = ImageFont.load_default(size=13 * FINER)
        except TypeError:  # Pillow before 10.1 has one size only
            self.font = ImageFont.load_default()

    def at(self, places: Any) -> list[tuple[float, float]]:
        """Pixels of (2 or 3, n) on the paper."""
        x = FINER * WIDE / 2 + self.scale * (places[0] - self.middle[0])
        y = FINER * (TALL + 26) / 2 - self.scale * (places[1] - self.middle[1])
        return list(zip(map(float, np.atleast_1d(x)), map(float, np.atleast_1d(y)), strict=True))

    def frame(self, k: int) -> Image.Image:
        """One frame, drawn finer and made smaller: its lines are smooth then."""
        image = Image.new("RGB", (FINER * WIDE, FINER * TALL), PAPER)
        draw = ImageDraw.Draw(image)
        for number, (i, _) in enumerate(moving_points(self.found.positions)):
            path = self.at(self.flat[i, :, : k + 1])
            if len(path) > 1:
                draw.line(path, fill=PATHS[number % len(PATHS)], width=FINER)
        around = np.linspace(0, 2 * np.pi, 49)
        for axes, place in self.bodies:
            for p, q in ((0, 1), (1, 2), (2, 0)):
                ring = (
                    place[:, k, None]
                    + np.outer(axes[p, :, k], np.cos(around))
                    + np.outer(axes[q, :, k], np.sin(around))
                )
                draw.line(self.at(ring), fill=SOFT, width=FINER)
        for outline in self.found.outlines:
            for line in outline.at(k):
                draw.line(self.at(self.look @ line), fill=SOFT, width=FINER)
        drawn = self.found.positions
        for pairs, width in ((drawn.slides, FINER), (drawn.links, 3 * FINER)):
            for i, j in pairs:
                draw.line(self.at(self.flat[[i, j], :, k].T), fill=INK, width=width)
        joints, centres = dots(drawn)
        for points, radius, fill in ((joints, 3, PAPER), (centres, 4, INK)):
            for i in points:
                (x, y), r = self.at(self.flat[i, :, k])[0], radius * FINER
                draw.ellipse((x - r, y - r, x + r, y + r), fill=fill, outline=INK, width=FINER)
        name = drawn.system.name
        title = name if len(name) <= 44 else name[:43] + "\u2026"
        printable = "".join(c if 32 <= ord(c) < 127 else "?" for c in title.replace("\u2026", "..."))
        draw.text((10 * FINER, 7 * FINER), printable, fill=INK, font=self.font)
        now = with_unit(f"t = {float(self.found.times[k]):.3g}", time_unit(drawn.system))
        draw.text((10 * FINER, 24 * FINER), now, fill=SOFT, font=self.font)
        return image.reduce(FINER)
