"""Solves the scenes by hand-written equations at 200 bits: python -m truth.independent.solve writes ``solutions.json``
(with ``sizes`` for its argument: ``sizes.json`` and ``peak.json``).

Taylor series of order 80, coefficient by coefficient, with steps so short that the last terms vanish.  How far two
solutions with different orders and steps agree is written beside each: that many digits are printed.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
from flint import arb, arb_series, ctx
from truth.independent.scenes import SCENES, Scene

HERE = Path(__file__).resolve().parent
BITS = 200

#: Orders and shares of steps of the two solutions that are compared.
LADDER = ((80, 1.0), (64, 0.7))

#: Places in the whole time at which solutions are compared: irregular, so that no period hides an error.
COUNT = 60


def places(end: float) -> list[float]:
    """The times, exact floats."""
    drawn = np.sort(np.random.default_rng(7).uniform(0, end, COUNT - 1))
    return [*map(float, drawn), end]


def number(text: str) -> arb:
    """A decimal number, or pi/2."""
    return arb.pi() / 2 if text == "pi/2" else arb(text)


def solved(
    scene: Scene, times: Sequence[float], order: int, short: float, place: int | None = None, start: Sequence[str] = ()
) -> list[list[arb]]:
    """States at the times by Taylor series of one order; steps are ``short`` of what the last terms allow.

    From a known state ``start`` at one of the ``places``, where that is given.
    """
    assert scene.rates is not None
    found, now = [], arb(0 if place is None else places(scene.time)[place])
    x = [number(text) for text in start or scene.start]
    left = [arb(t) for t in times]
    while left:
        rows = [[value.mid()] for value in x]
        for k in range(order):
            ctx.cap = k + 1
            slopes = scene.rates(arb_series([now, 1]), [arb_series(row) for row in rows], number)
            for row, slope in zip(rows, slopes, strict=True):
                value = slope[k] if isinstance(slope, arb_series) else arb(slope) if k == 0 else arb(0)
                row.append((value / (k + 1)).mid())
        after = (now + arb(min(_step(rows, k) for k in (order - 1, order)) * short)).mid()
        while left and left[0] <= after:
            found.append([_sum(row, left[0] - now) for row in rows])
            left.pop(0)
        x, now = [_sum(row, after - now) for row in rows], after
    return found


def _step(rows: Sequence[Sequence[arb]], k: int) -> float:
    """h with |c_k| h^k = 2^-BITS of the size of the state, the worst component deciding."""
    size = max(max(abs(float(row[0])) for row in rows), 1.0)
    largest = max(abs(row[k]) for row in rows)
    if not largest > 0:
        return 1.0
    exponent = (float(largest.log()) - np.log(size) + BITS * np.log(2)) / k
    return float(np.exp(-exponent))


def _sum(row: Sequence[arb], s: arb) -> arb:
    value = row[-1]
    for coefficient in row[-2::-1]:
        value = (value * s + coefficient).mid()
    return value


def states_of(scene: Scene, order: int = 80, short: float = 1.0) -> list[list[Any]]:
    """The solution at ``places``, as numbers of 60 digits."""
    times = places(scene.time)
    if scene.closed is not None:
        with mpmath.workdps(60):
            return [scene.closed(mpmath.mpf(t)) for t in times]
    with ctx.workprec(BITS + 40):
        found = solved(scene, times, order, short)
        with mpmath.workdps(60):
            return [[mpmath.mpf(value.str(60, radius=False)) for value in row] for row in found]


def agreement(one: list[list[Any]], other: list[list[Any]]) -> float:
    """The largest difference, relative to the size of each component."""
    with mpmath.workdps(60):
        worst = mpmath.mpf(0)
        for i in range(len(one[0])):
            size = max(abs(row[i]) for row in one) or mpmath.mpf(1)
            worst = max(worst, *(abs(a[i] - b[i]) / size for a, b in zip(one, other, strict=True)))
        return float(worst)


def sizes(scene: Scene) -> list[float]:
    """The largest absolute value of each component in the whole time, to some digits, by the hand-written equations.

    Short peaks fall between ``places``: the velocity of van der Pol's oscillator has its size there and nowhere else.
    """
    from scipy.integrate import solve_ivp

    rates = scene.rates
    assert rates is not None

    def slopes(t: float, x: Any) -> list[float]:
        return [float(value) for value in rates(arb(t), [arb(float(value)) for value in x], number)]

    start = [float(number(text)) for text in scene.start]
    found = solve_ivp(
        slopes, (0.0, scene.time), start, method="LSODA", rtol=1e-6, atol=1e-9, max_step=scene.time / 2000
    )
    return [float(f"{value:.4g}") for value in np.max(np.abs(found.y), axis=1)]


def peak() -> dict[str, Any]:
    """Times about the highest velocity of van der Pol's oscillator, and its states there, from the place before.

    The jump is over in a hundredth of a second: between it and the next place errors of its time have died out.
    """
    from scipy.integrate import solve_ivp

    scene = next(scene for scene in SCENES if scene.name == "van der pol")

    def slopes(t: float, x: Any) -> list[float]:
        return [x[1], 100 * (1 - x[0] * x[0]) * x[1] - x[0]]

    found = solve_ivp(slopes, (0.0, scene.time), [2.0, 0.0], method="LSODA", rtol=1e-9, atol=1e-12, max_step=0.05)
    top = float(found.t[int(np.argmax(np.abs(found.y[1])))])
    known = json.loads((HERE / "solutions.json").read_text(encoding="utf-8"))[scene.name]["states"]
    before = max(k for k, t in enumerate(places(scene.time)) if t < top - 0.1)
    times = [top + 0.001 * k for k in range(-8, 9)]
    with ctx.workprec(BITS + 40):
        found_states = [solved(scene, times, order, short, before, known[before]) for order, short in LADDER]
        one, other = ([[value.str(22, radius=False) for value in row] for row in rows] for rows in found_states)
    with mpmath.workdps(60):
        apart = agreement(*([[mpmath.mpf(text) for text in row] for row in rows] for rows in (one, other)))
    return {"times": times, "states": one, "agreement": apart}


def write_sizes() -> None:
    """``sizes.json``; scenes in closed form have no peaks between the places that matter."""
    content = {scene.name: sizes(scene) for scene in SCENES if scene.rates is not None}
    (HERE / "sizes.json").write_text(json.dumps(content, indent=0) + "\n", encoding="utf-8")
    (HERE / "peak.json").write_text(json.dumps(peak(), indent=0) + "\n", encoding="utf-8")


def main(names: Sequence[str]) -> None:
    if names == ["sizes"]:
        write_sizes()
        return
    file = HERE / "solutions.json"
    for scene in SCENES:
        if names and scene.name not in names:
            continue
        began = time.perf_counter()
        found = states_of(scene)
        known = 0.0 if scene.closed is not None else agreement(found, states_of(scene, 64, 0.7))
        with mpmath.workdps(60):
            rows = [[mpmath.nstr(value, 22) for value in row] for row in found]
        content = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        content[scene.name] = {"agreement": known, "states": rows}
        file.write_text(json.dumps(content, indent=0) + "\n")
        print(scene.name, f"{known:.1e}", f"{time.perf_counter() - began:.1f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
