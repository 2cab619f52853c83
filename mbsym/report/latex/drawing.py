"""The drawing of a system as a TikZ picture, which a person can go on drawing in."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import Any

from mbsym.picture.sketch import Dot, Mark, Sketch

_STYLES = {
    "body": "line width=1.5pt",
    "solid": "line width=0.6pt",
    "guide": "line width=0.9pt",
    "thin": "line width=0.35pt",
    "hidden": "line width=0.35pt, dashed",
    "tint": "fill=black!8, fill opacity=0.8",
}


def tikz(found: Sketch, letter: Callable[[Any], str], scale: float) -> str:
    """A ``tikzpicture``; ``letter`` writes what stands beside the lines, without dollars."""
    drawn = [_command(how, list(marks)) for how, marks in groupby(found.marks, _how)]
    used = {word for how, _ in groupby(found.marks, _how) for word in how}
    styles = "".join(f",\n  {name}/.style={{{style}}}" for name, style in _STYLES.items() if name in used)
    lines = [
        f"\\begin{{tikzpicture}}[>=latex, line join=round, scale={scale:g}{styles}]",
        *drawn,
        *_letters(found, letter),
        "\\end{tikzpicture}",
    ]
    return "\n".join(lines)


def _place(place: tuple[float, float]) -> str:
    return f"({_number(place[0])},{_number(place[1])})"


def _number(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".") if abs(value) >= 0.005 else "0"


def _how(mark: Mark) -> tuple[str, ...]:
    """The options of the command that draws it."""
    if isinstance(mark, Dot):
        return (f"fill={'white' if mark.open else 'black'}",)
    tips = ["<->"] if mark.both else ["->"] if mark.arrow else []
    return (mark.ink.value, *(["tint"] if mark.tinted else []), *tips)


def _command(how: Sequence[str], marks: Sequence[Mark]) -> str:
    """Marks that are drawn alike, and follow each other, by one command; its comment says what they are."""
    of = " ".join(", ".join(dict.fromkeys(mark.of for mark in marks)).split())
    return f"% {of}\n\\draw[{', '.join(how)}] {' '.join(map(_drawn, marks))};"


def _drawn(mark: Mark) -> str:
    if isinstance(mark, Dot):
        return f"{_place(mark.place)} circle ({mark.radius:g})"
    if mark.smooth:
        cycle = " cycle" if mark.closed else ""
        return f"plot[smooth{cycle}] coordinates {{{' '.join(map(_place, mark.points))}}}"
    return " -- ".join(map(_place, mark.points)) + (" -- cycle" if mark.closed else "")


def _letters(found: Sketch, letter: Callable[[Any], str]) -> Iterator[str]:
    """All of one size by one path."""
    if found.letters:
        nodes = "\n  ".join(f"{_place(one.place)} node {{${letter(one.text)}$}}" for one in found.letters)
        yield f"\\draw[every node/.style={{inner sep=1pt, font=\\small}}] {nodes};"
