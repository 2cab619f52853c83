"""All equilibria of the general gyrostat in an orbit: mbsym's complete list against a search from many points.

The rival is SciPy's fsolve from 400 orientations with the conditions written by hand, which proves nothing; it may miss
some.  Prints counts, seconds and their ratio.  Run: python tests/bench/equilibria_bench.py
"""

from __future__ import annotations

import sys
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
from scipy.optimize import fsolve

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria.equilibria import equilibria

SYSTEM = Path(__file__).parents[2] / "systems" / "orbital-gyrostat.yaml"
CASES = (("1/20", "3/100", "1/50"), ("317/1000", "-41/100", "53/50"), ("-137/100", "211/100", "83/100"))
INERTIA = np.array([4.0, 5.0, 3.0])


def from_many_points(h: np.ndarray, starts: int = 400) -> int:
    """How many different (e, n) with 3 e x I e = n x (I n + h) are reached."""

    def conditions(x: np.ndarray) -> np.ndarray:
        e, n = x[:3], x[3:]
        moment = 3 * np.cross(e, INERTIA * e) - np.cross(n, INERTIA * n + h)
        return np.concatenate([moment, [e @ e - 1, n @ n - 1, e @ n]])

    source, found = np.random.default_rng(1), []
    for _ in range(starts):
        x, _, code, _ = fsolve(conditions, source.normal(size=6), full_output=True, xtol=1e-13)
        if code == 1 and all(np.abs(x - y).max() > 1e-6 for y in found):
            found.append(x)
    return len(found)


def main() -> int:
    system = mbsym.load(SYSTEM).system
    for h in CASES:
        given = dict(zip(("A", "B", "C", "h1", "h", "h3"), map(Fraction, ("4", "5", "3", *h)), strict=True))
        start = time.process_time()
        ours = equilibria(system, given_values(system, given))
        middle = time.process_time()
        theirs = from_many_points(np.array([float(Fraction(x)) for x in h]))
        end = time.process_time()
        known = "complete" if ours.complete else "may be incomplete"
        print(
            f"gyrostat, h = ({', '.join(h)}): mbsym {len(ours.equilibria)} ({known}), {middle - start:.2f} s; "
            f"fsolve from 400 points {theirs}, {end - middle:.2f} s; ratio {(end - middle) / (middle - start):.2f}"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
