"""Draws the README's first picture: a description beside what is derived of it (`make gallery`).

Everything in it is an output of mbsym: lines of the file, `mbsym show`, `mbsym equilibria --vary`, `mbsym simulate`.
The bead moves by CSS, which runs in images, too; it rests for those who asked their machine for less motion.
"""

from __future__ import annotations

import csv
import json
import math
import re
import sys
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from pathlib import Path

from click.testing import CliRunner

from mbsym_cli.main import main as mbsym

HOOP = Path(__file__).parents[2] / "systems" / "bead-on-hoop.yaml"
#: Lines of the description that are shown: up to its motion.
LINES = 14
#: The rate is varied up to MOST; SECONDS are shown at half speed, in FRAMES.
MOST, SECONDS, FRAMES = 12, 8, 320
GREEK = {"theta": "θ", "Omega": "Ω"}

STYLE = """\
svg { --page: #fff; --card: #f6f8fa; --line: #d0d7de; --ink: #1f2328; --faint: #59636e; --key: #0550ae;
      --bead: #bc4c00 }
@media (prefers-color-scheme: dark) {
  svg { --page: #0d1117; --card: #161b22; --line: #3d444d; --ink: #f0f6fc; --faint: #9198a1; --key: #79c0ff;
        --bead: #ffa657 }
}
text { fill: var(--ink); font: 14px system-ui, -apple-system, "Segoe UI", Helvetica, Arial, sans-serif }
.code { font: 12.5px ui-monospace, SFMono-Regular, Menlo, Consolas, "DejaVu Sans Mono", monospace; white-space: pre }
.math { font: italic 20px "STIX Two Text", "Latin Modern Roman", Cambria, Georgia, "DejaVu Serif", serif }
.small { font-size: 12px; fill: var(--faint) } .tick { font-size: 11.5px; fill: var(--faint) }
.key { fill: var(--key) } .upright { font-style: normal } .middle { text-anchor: middle } .end { text-anchor: end }
.page { fill: var(--page); stroke: var(--line) } .card { fill: var(--card); stroke: var(--line) }
.axis { stroke: var(--faint); stroke-width: 1; fill: none } .thin { stroke: var(--line); fill: none }
.stable { stroke: var(--key); stroke-width: 3; fill: none }
.unstable { stroke: var(--faint); stroke-width: 1.8; stroke-dasharray: 5 4; fill: none }
.now { stroke: var(--bead); stroke-dasharray: 2 3 } .bead { fill: var(--bead) }
.hoop { stroke: var(--ink); stroke-width: 2.5; fill: none; vector-effect: non-scaling-stroke }
"""


@dataclass(frozen=True)
class Branch:
    """One family of equilibria: values of the parameter, angles, and whether it is stable."""

    rates: tuple[float, ...]
    angles: tuple[float, ...]
    stable: bool


@dataclass(frozen=True)
class Derived:
    """What mbsym says of the hoop, by its commands; ``folder`` takes their files."""

    folder: Path

    def _run(self, *words: object) -> str:
        done = CliRunner().invoke(mbsym, [str(word) for word in words], catch_exceptions=False)
        assert done.exit_code == 0, done.output
        return done.stdout

    @cached_property
    def equation(self) -> str:
        return self._run("show", HOOP, "equations").strip()

    @cached_property
    def condition(self) -> str:
        (found,) = (line for line in self._run("show", HOOP, "conditions").splitlines() if line.endswith("> 0"))
        return found

    @cached_property
    def _study(self) -> dict[str, object]:
        self._run("equilibria", HOOP, "--vary", f"Omega=0:{MOST}", "--format", "json", "--quiet", "--out", self.folder)
        return json.loads((self.folder / "branches.json").read_text(encoding="utf-8"))

    @cached_property
    def branches(self) -> list[Branch]:
        found = []
        for branch in self._study["branches"]:
            interval = self._study["intervals"][branch["interval"]]
            verdict = interval["equilibria"][branch["equilibrium"]]["stability"]["verdict"]
            angles = tuple(point[0] for point in branch["points"])
            found.append(Branch(tuple(branch["parameter"]), angles, verdict == "asymptotically stable"))
        return found

    @cached_property
    def critical(self) -> tuple[float, str]:
        """Where the number of equilibria changes, and what happens there."""
        (found,) = self._study["critical_values"]
        return found["value"]["number"], found["events"][0]

    @cached_property
    def verdicts(self) -> tuple[str, str]:
        """Of the bead at the bottom, below the critical rate and above it."""
        below, above = (
            next(one for one in interval["equilibria"] if one["coordinates"][0]["value"] == "0")
            for interval in self._study["intervals"]
        )
        return below["stability"]["verdict"], above["stability"]["verdict"]

    @cached_property
    def motion(self) -> list[float]:
        """The angle at each frame and at the end."""
        self._run("simulate", HOOP, "--time", SECONDS, "--samples", FRAMES, "--format", "csv", "--no-estimate",
                  "--quiet", "--out", self.folder)  # fmt: skip
        with (self.folder / "trajectory.csv").open(encoding="utf-8") as file:
            return [float(row["theta"]) for row in csv.DictReader(file)]

    @cached_property
    def values(self) -> dict[str, float]:
        text = re.search(r"^values: \{(.*)\}$", HOOP.read_text(encoding="utf-8"), re.MULTILINE)
        assert text is not None
        return {name: float(value) for name, value in re.findall(r"(\w+): ([\d.]+)", text[1])}


def typeset(formula: str) -> str:
    """What `mbsym show` prints as people set it: letters slanted, powers raised, primes and a long minus."""
    parts = []
    for word, power, other in re.findall(r"([A-Za-z]+)|\^(\w+)|([^A-Za-z^]+|\^)", formula):
        if power:
            parts.append(f'<tspan dy="-7" font-size="13">{power}</tspan><tspan dy="7">&#8203;</tspan>')
        elif word in {"sin", "cos"}:
            parts.append(f'<tspan class="upright">{word}</tspan>')
        elif word:
            parts.append(GREEK.get(word, word))
        else:
            primes = other.replace("''", "″").replace("'", "′").replace(" - ", " − ")
            parts.append(f'<tspan class="upright">{escape(primes, quote=False)}</tspan>')
    return "".join(parts)


def text(x: float, y: float, words: str, kind: str = "") -> str:
    return f'<text x="{x:g}" y="{y:g}" class="{kind}">{words}</text>'


def path(points: Iterable[tuple[float, float]], kind: str) -> str:
    return f'<path class="{kind}" d="M{" L".join(f"{x:.1f} {y:.1f}" for x, y in points)}"/>'


def code(width: float) -> str:
    """The first lines of the description, behind what is said about it."""
    lines = [line for line in HOOP.read_text(encoding="utf-8").splitlines() if not line.startswith("#")][:LINES]
    shown = [re.sub(r"^( *(?:- )?)([\w ]+)(?=:)", r'\1<tspan class="key">\2</tspan>', escape(line)) for line in lines]
    rows = [text(16, 46 + 19 * k, line, "code") for k, line in enumerate([*shown, "..."])]
    name = text(16, 22, f"systems/{HOOP.name}", "small")
    return f'<rect class="card" width="{width:g}" height="{19 * (LINES + 1) + 44}" rx="8"/>{name}{"".join(rows)}'


def finding(derived: Derived) -> str:
    """Equation, condition and verdicts, each under the command that says it."""
    below, above = derived.verdicts
    known = f"{derived.critical[0]:.3f}"
    return "".join([
        text(0, 14, "mbsym show bead-on-hoop.yaml", "code small"),
        text(0, 44, typeset(derived.equation), "math"),
        text(0, 80, "mbsym show bead-on-hoop.yaml conditions", "code small"),
        text(0, 110, typeset(derived.condition), "math"),
        text(0, 140, f"The bead at the bottom is then {below}, and {above}"),
        text(0, 160, f"where this is negative. At the values of the file: beyond Ω ≈ {known}."),
    ])  # fmt: skip


def hoop(derived: Derived) -> str:
    """The turning hoop and the bead on it, seen from the side, its axis upright; radius 84."""
    return "".join([
        path([(0, -112), (0, 104)], "thin"),
        '<path class="axis" d="M-20 -103 A20 7 0 0 0 20 -103 m-8 1.5 l8 -1.5 l-1.5 8"/>',
        text(24, -98, typeset("Omega"), "math"),
        '<g class="turning"><circle class="hoop" r="84"/></g><g class="sliding"><circle class="bead" r="9"/></g>',
        text(0, 124, f"mbsym simulate, Ω = {derived.values['Omega']:g} rad/s, at half speed", "small middle"),
    ])  # fmt: skip


def place(rate: float, angle: float) -> tuple[float, float]:
    """Where the diagram has them."""
    return 320 * rate / MOST, -30 * angle


def diagram(derived: Derived) -> str:
    """Equilibria over the rate: solid where they are stable; the bead of the other picture is the dot."""
    critical, event = derived.critical
    now = derived.values["Omega"]
    high, low = place(0, math.pi)[1], place(0, -math.pi / 2)[1]
    parts = [path([(0, high - 8), (0, low + 8), (330, low + 8)], "axis")]
    for angle, name in ((math.pi, "π"), (math.pi / 2, "π/2"), (0, "0"), (-math.pi / 2, "−π/2")):
        parts.append(text(-8, place(0, angle)[1] + 4, name, "tick end"))
    parts += [text(place(rate, 0)[0], low + 24, str(rate), "tick middle") for rate in range(0, MOST + 1, 4)]
    parts += [path([place(now, math.pi), place(now, -math.pi / 2)], "now")]
    parts += [text(336, low + 12, "Ω"), text(-8, high - 16, "θ", "end")]
    for branch in derived.branches:
        points = [place(*point) for point in zip(branch.rates, branch.angles, strict=True)]
        parts.append(path(thinned(points), "stable" if branch.stable else "unstable"))
    x, y = place(critical, 0)
    parts += [text(x - 10, y - 10, f"{event}, {critical:.3f}", "small end")]
    parts += [text(8, y + 22, "stable", "small"), text(8, high + 16, "unstable", "small")]
    parts += [f'<g transform="translate({place(now, 0)[0]:.1f} 0)"><g class="dot"><circle class="bead" r="6"/></g></g>']
    return "".join([*parts, text(160, low + 46, f"mbsym equilibria --vary Omega=0:{MOST}", "small middle")])


def thinned(points: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Without those that no eye tells from the line between their neighbours: a third of a pixel."""
    if len(points) < 3:
        return list(points)
    (x0, y0), (x1, y1) = points[0], points[-1]
    length = math.hypot(x1 - x0, y1 - y0) or 1
    far = [abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) / length for x, y in points]
    k = max(range(len(points)), key=far.__getitem__)
    if far[k] < 1 / 3:
        return [points[0], points[-1]]
    return thinned(points[: k + 1])[:-1] + thinned(points[k:])


def moving(derived: Derived) -> str:
    """Key frames of the hoop's width, of the bead on it and of the dot in the diagram."""
    turning, sliding, dot = [], [], []
    for k, angle in enumerate(derived.motion):
        side = math.cos(derived.values["Omega"] * SECONDS * k / FRAMES)
        frame = f"{100 * k / FRAMES:.4g}%"
        turning.append(f"{frame}{{transform:scaleX({side:.3f})}}")
        bead = (84 * math.sin(angle) * side, 84 * math.cos(angle))
        sliding.append(f"{frame}{{transform:translate({bead[0]:.1f}px,{bead[1]:.1f}px)}}")
        dot.append(f"{frame}{{transform:translate(0,{place(0, angle)[1]:.1f}px)}}")
    names = {"turning": turning, "sliding": sliding, "dot": dot}
    frames = "\n".join(f"@keyframes {name} {{{''.join(found)}}}" for name, found in names.items())
    rest = derived.motion[-1]
    still = f".sliding {{ transform: translate({84 * math.sin(rest):.1f}px, {84 * math.cos(rest):.1f}px) }}"
    still += f" .dot {{ transform: translate(0, {place(0, rest)[1]:.1f}px) }}"
    rules = " ".join(f".{name} {{ animation: {name} {2 * SECONDS}s linear infinite }}" for name in names)
    return f"{still}\n@media not (prefers-reduced-motion: reduce) {{ {rules} }}\n{frames}\n"


def picture(derived: Derived, wide: bool) -> str:
    """The whole: two columns, or one for narrow screens."""
    size = (1000, 560) if wide else (560, 1070)
    places = ((20, 20), (24, 380), (785, 150), (630, 400)) if wide else ((16, 16), (20, 372), (280, 675), (110, 920))
    parts = (code(548 if wide else 528), finding(derived), hoop(derived), diagram(derived))
    told = (
        f"The equation of motion {derived.equation} and the condition {derived.condition}, derived of the description"
    )
    body = "\n".join(
        f'<g transform="translate({x} {y})">{part}</g>' for (x, y), part in zip(places, parts, strict=True)
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size[0]} {size[1]}" width="{size[0]}" role="img">\n'
        f"<title>A bead on a rotating hoop</title><desc>{escape(told)}</desc>\n"
        f"<style>\n{STYLE}{moving(derived)}</style>\n"
        f'<rect class="page" x="0.5" y="0.5" width="{size[0] - 1}" height="{size[1] - 1}" rx="10"/>\n{body}\n</svg>\n'
    )


def main(folder: Path) -> None:
    with tempfile.TemporaryDirectory() as place:
        derived = Derived(Path(place))
        for name, wide in (("hoop.svg", True), ("hoop-narrow.svg", False)):
            (folder / name).write_text(picture(derived, wide), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
