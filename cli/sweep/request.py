"""The options of ``mbsym sweep``: what varies, what is measured."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.parser import ascii_safe
from mbsym_cli.options import MAX_LENGTH, Options
from mbsym_cli.section_options import known, read_rational

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.ensembles.variation import Variation
    from mbsym.sweeps.points import Points

#: More names than this are not varied at once.
MOST_VARIED = 64
#: More threads or workers than this are a slip.
MOST_JOBS = 1_000

_DRAW = re.compile(r"\s*(normal|uniform)\s*\((.*)\)\s*", re.DOTALL)
_TOLERANCE = re.compile(r"(?P<middle>.*?)\s*\+-\s*(?P<size>[^%]+?)\s*(?P<percent>%?)\s*", re.DOTALL)
_HINT = "write name=0:1:1000, name=1 +- 5%, name=uniform(0, 1) or name=normal(1, 0.05)"


@dataclass(frozen=True)
class Swept:
    """The points, and between which rational numbers each name lies (for whoever needs no more than an interval)."""

    points: Points
    ends: dict[str, tuple[Fraction, Fraction]]


def read_vary(
    texts: Sequence[str],
    members: str | None,
    seed: str,
    sampling: str,
    names: Sequence[str],
    system: System,
    options: Options,
) -> Swept | None:
    """The points of a sweep over some of ``names``; what is wrong joins the complaints."""
    from mbsym.sweeps.points import MOST_POINTS, Points, complaints

    if not texts:
        options.complain("--vary", "missing-option", "what varies is not said", _HINT)
        return None
    if len(texts) > MOST_VARIED:
        options.complain("--vary", "too-large", f"at most {MOST_VARIED} names vary at once")
        return None
    count = options.whole("--points", members, 2, MOST_POINTS)
    start = options.whole("--seed", seed, 0, 2**63 - 1)
    kind = options.word("--sampling", sampling, ("random", "sobol"), "sampling")
    before = len(options.complaints)
    found = [one for text in texts if (one := _variation(text, names, system, options)) is not None]
    if len(options.complaints) > before or start is None or kind is None or (members is not None and count is None):
        return None
    for name, told, hint in complaints([one for one, _ in found], count, names):
        options.complain(f"--vary {name}", "bad-variation", told, hint or None)
    points = Points(tuple(one for one, _ in found), count or 0, start, kind)
    return Swept(points, {one.name: ends for one, ends in found})


def _variation(
    text: str, names: Sequence[str], system: System, options: Options
) -> tuple[Variation, tuple[Fraction, Fraction]] | None:
    from mbsym.numerics.ensembles.variation import Draw, Grid

    name, equals, right = (part.strip() for part in " ".join(text.splitlines()).partition("="))
    if not equals or not name or not right or len(text) > MAX_LENGTH:
        options.complain("--vary", "bad-variation", f"{ascii_safe(text[:80])} says no range", _HINT)
        return None
    named = known(name, "--vary", names, options)
    option = f"--vary {name if name.isidentifier() else ascii_safe(name)}"
    tolerance, draw = _TOLERANCE.fullmatch(right), _DRAW.fullmatch(right)
    if tolerance is not None:
        about = _about(name, tolerance, system, option, options)
        if about is None or not named:
            return None
        return Draw(name, "uniform", float(about[0]), float(about[1])), about
    parts = [part.strip() for part in (draw[2].split(",") if draw else right.split(":"))]
    if len(parts) != (2 if draw else 3):
        options.complain(option, "bad-variation", "this is no range", _HINT)
        return None
    ends = [read_rational(part, option, options) for part in parts[:2]]
    count = 0 if draw else options.whole(option, parts[2], 2, 10**9)
    first, second = ends
    if first is None or second is None or count is None or not named:
        return None
    if draw is None:
        return Grid(name, float(first), float(second), count), (min(first, second), max(first, second))
    reach = (first, second) if draw[1] == "uniform" else (first - 8 * second, first + 8 * second)
    return Draw(name, draw[1], float(first), float(second)), reach


def _about(
    name: str, tolerance: re.Match[str], system: System, option: str, options: Options
) -> tuple[Fraction, Fraction] | None:
    """The ends of ``m = 1 +- 5%``; without a number in front, about the value of the description."""
    from mbsym.model.system import rational

    size = read_rational(tolerance["size"], option, options)
    if tolerance["middle"]:
        middle = read_rational(tolerance["middle"], option, options)
    else:
        given = next((one.value for one in system.parameters if one.name == name), None)
        middle = None if given is None else rational(given)
        if middle is None:
            told = f"{ascii_safe(name)} has no rational number in the description to vary about"
            options.complain(option, "missing-value", told, f"write {ascii_safe(name)}=1 +- 5%")
    if middle is None or size is None:
        return None
    reach = abs(middle) * size / 100 if tolerance["percent"] else size
    if reach <= 0:
        options.complain(option, "bad-variation", "the tolerance must be positive", _HINT)
        return None
    return middle - reach, middle + reach
