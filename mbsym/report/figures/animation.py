"""``animation.gif``, ``animation.mp4``: the moving system as it is drawn on paper, some seconds of it, for slides and
chats; the latter by ffmpeg."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mbsym.algebra.failures import Failure
from mbsym.model.quantities import time_unit, with_unit
from mbsym.picture.sketch import Dot, Film, Ink, Mark, Place
from mbsym.report.viewer.motion import moving_picture
from mbsym.simulation import Simulation

#: Pixels of the picture, how many times larger it is drawn, most frames, and seconds of the loop.
WIDE, TALL, FINER, MOST, SECONDS = 560, 420, 2, 120, 6.0
#: Of a video, which takes more frames.
MOST_OF_VIDEO, SECONDS_OF_VIDEO = 240, 8.0
#: The program that makes videos, as it is found on the path.
FFMPEG = "ffmpeg"
#: Hundredths of a second that a frame stands at least: viewers do not go faster.
SHORTEST = 4
#: Height of the words above.
WORDS = 40
#: Points between two of a smooth curve.
SMOOTH = 4
PAPER, INK, SOFT, TINT = (255, 255, 255), (29, 36, 48), (120, 130, 145), (226, 234, 244)
PATHS = ((179, 55, 47), (46, 139, 87), (217, 130, 43), (142, 94, 162), (23, 162, 184), (122, 92, 62))
THICK = {Ink.BODY: 4, Ink.GUIDE: 3, Ink.SOLID: 2, Ink.THIN: 1, Ink.HIDDEN: 1}


def animation_gif(run: Simulation) -> bytes:
    """The file.  The same run gives the same bytes (with one version of Pillow).

    Raises Failure as ``moving_picture`` does, and where nothing is drawn on paper.
    """
    drawn = _picture(run, MOST)
    frames = [drawn.frame(k) for k in drawn.marks]
    each = max(SHORTEST, round(100 * SECONDS / len(frames)))
    palette = frames[-1].quantize(64, Image.Quantize.MEDIANCUT)
    shown = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    stream = BytesIO()
    shown[0].save(stream, "gif", save_all=True, append_images=shown[1:], duration=10 * each, loop=0, disposal=1)
    return stream.getvalue()


def animation_mp4(run: Simulation) -> bytes:
    """The same as a video.  Raises Failure as ``animation_gif`` does, and where ffmpeg makes none."""
    drawn = _picture(run, MOST_OF_VIDEO)
    rate = f"{len(drawn.marks) / SECONDS_OF_VIDEO:.6g}"
    with TemporaryDirectory() as folder:
        path = Path(folder) / "animation.mp4"
        raw = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{WIDE}x{TALL}", "-r", rate, "-i", "-"]
        # One thread and no dates: the same run gives the same bytes, with one version of ffmpeg.
        same = ["-threads", "1", "-fflags", "+bitexact", "-flags:v", "+bitexact"]
        shown = ["-pix_fmt", "yuv420p", "-movflags", "+faststart"]  # which players in browsers and slides want
        try:
            program = shutil.which(FFMPEG) or FFMPEG
            words = [program, "-nostdin", "-hide_banner", "-loglevel", "error", *raw, *same, *shown, str(path)]
            frames = b"".join(drawn.frame(k).tobytes() for k in drawn.marks)
            done = subprocess.run(words, input=frames, capture_output=True, check=False)
        except OSError as error:
            raise Failure("ffmpeg cannot be run: [[why]]", why=error.strerror or str(error)) from error
        if done.returncode != 0 or not path.is_file():
            last = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            raise Failure("ffmpeg made no video: [[why]]", why=" ".join(last) or f"exit code {done.returncode}")
        return path.read_bytes()


def _picture(run: Simulation, most: int) -> _Picture:
    """So many frames of it at most.  Raises Failure where nothing is drawn."""
    picture, motion = moving_picture(run)
    film = Film(picture, run.system, motion.times, {**motion.coordinates, **motion.velocities})
    count = len(motion.times)
    chosen = np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))
    drawn = _Picture(film, [int(k) for k in chosen], run)
    if not drawn.size > 0:
        raise Failure("no body has a place that could be drawn")
    return drawn


class _Picture:
    def __init__(self, film: Film, chosen: Sequence[int], run: Simulation) -> None:
        self.run, self.film = run, film
        self.marks: dict[int, Sequence[Mark]] = {k: film.marks(k) for k in chosen}
        points = [point for marks in self.marks.values() for mark in marks for point in _points(mark)]
        points += [point for path in film.paths for point in path]
        every = np.array(points or [(0.0, 0.0)])
        low, high = np.min(every, axis=0), np.max(every, axis=0)
        self.middle = (low + high) / 2
        room = np.maximum(high - low, 1e-9)
        self.size = float(np.max(high - low))
        self.scale = 0.9 * FINER * min(WIDE / float(room[0]), (TALL - WORDS) / float(room[1]))
        try:
            self.font: Any = ImageFont.load_default(size=13 * FINER)
        except TypeError:  # Pillow before 10.1 has one size only
            self.font = ImageFont.load_default()

    def at(self, places: Sequence[Place]) -> list[tuple[float, float]]:
        """Pixels."""
        x0, y0 = FINER * WIDE / 2, FINER * (TALL + 26) / 2
        return [(x0 + self.scale * (x - self.middle[0]), y0 - self.scale * (y - self.middle[1])) for x, y in places]

    def frame(self, k: int) -> Image.Image:
        """One frame, drawn finer and made smaller: its lines are smooth then."""
        image = Image.new("RGB", (FINER * WIDE, FINER * TALL), PAPER)
        draw = ImageDraw.Draw(image)
        for number, path in enumerate(self.film.paths):
            if k > 0:
                draw.line(self.at(path[: k + 1]), fill=PATHS[number % len(PATHS)], width=FINER)
        for mark in self.marks[k]:
            if isinstance(mark, Dot):
                ((x, y),), r = self.at([mark.place]), max(2.0 * FINER, self.scale * mark.radius)
                fill = PAPER if mark.open else INK
                draw.ellipse((x - r, y - r, x + r, y + r), fill=fill, outline=INK, width=FINER)
                continue
            points = self.at(_smooth(mark.points, mark.closed) if mark.smooth else mark.points)
            if mark.closed:
                points = [*points, points[0]]
            if mark.tinted:
                draw.polygon(points, fill=TINT)
            ink = SOFT if mark.ink in (Ink.THIN, Ink.HIDDEN) else INK
            draw.line(points, fill=ink, width=THICK[mark.ink] * FINER, joint="curve")
        name = self.run.system.name
        title = name if len(name) <= 44 else name[:43] + "\u2026"
        printable = "".join(c if 32 <= ord(c) < 127 else "?" for c in title.replace("\u2026", "..."))
        draw.text((10 * FINER, 7 * FINER), printable, fill=INK, font=self.font)
        now = with_unit(f"t = {self.film.times[k]:.3g}", time_unit(self.run.system))
        draw.text((10 * FINER, 24 * FINER), now, fill=SOFT, font=self.font)
        return image.reduce(FINER)


def _points(mark: Mark) -> list[Place]:
    if not isinstance(mark, Dot):
        return list(mark.points)
    (x, y), r = mark.place, mark.radius
    return [(x - r, y - r), (x + r, y + r)]


def _smooth(points: Sequence[Place], closed: bool) -> list[Place]:
    """A curve through points: Catmull and Rom's cubics."""
    own = np.array(points)
    every = np.concatenate((own[-1:], own, own[:2]) if closed else (own[:1], own, own[-1:]))
    a, b, c, d = (every[i : len(every) - 3 + i, None, :] for i in range(4))
    s = (np.arange(SMOOTH) / SMOOTH)[:, None]
    curve = b + s * ((c - a) / 2 + s * (a - 2.5 * b + 2 * c - d / 2 + s * (1.5 * (b - c) + (d - a) / 2)))
    return [(float(x), float(y)) for x, y in (*curve.reshape(-1, 2), *(() if closed else own[-1:]))]
