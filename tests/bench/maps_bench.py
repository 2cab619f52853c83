"""The satellite's map against eigenvalue counts of the paper's own matrices at 20,000 random rational points.

    python tests/bench/maps_bench.py

The counts are exact (characteristic polynomial of the first-order matrix, Sturm's chains); beside them stands the time
that a grid of as many points takes with NumPy's eigvals, which says nothing between its points.
"""

from __future__ import annotations

import sys
import time
from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from tests.maps.test_map import SATELLITE, mapped, paper_matrices, roots_to_the_right, stratum_at  # noqa: E402

POINTS = 20_000


def main() -> None:
    started = time.perf_counter()
    found = mapped(*SATELLITE)
    making = time.perf_counter() - started
    random = Random(20261122)
    points = [
        (Fraction(random.randint(-9999, 9999), 10000), Fraction(random.randint(1, 9999), 10000)) for _ in range(POINTS)
    ]
    started = time.perf_counter()
    strata = [stratum_at(found, *point) for point in points]
    locating = time.perf_counter() - started
    p1, p2 = Fraction(2, 5), Fraction(1, 5)
    wrong = 0
    started = time.perf_counter()
    for (alpha, gamma), stratum in zip(points, strata, strict=True):
        counted = [roots_to_the_right(*one) for one in paper_matrices(alpha, gamma, p1, p2)]
        if not all(positive for _, positive in counted):
            wrong += stratum is None or stratum.judged is not None
        else:
            judged = None if stratum is None else stratum.judged
            wrong += judged is None or judged.right != sum(count for count, _ in counted)
    counting = time.perf_counter() - started
    started = time.perf_counter()
    for alpha, gamma in points:
        for m, g, k in paper_matrices(alpha, gamma, p1, p2):
            mass, c, s = (np.array(x, dtype=float) for x in (m, g, k))
            n = len(mass)
            first = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(mass, s), -np.linalg.solve(mass, c)]])
            np.linalg.eigvals(first)
    grid = time.perf_counter() - started
    print(f"map {making:.2f} s, {POINTS} points located {locating:.2f} s, disagreements {wrong}")
    print(f"exact counts {counting:.1f} s, a NumPy loop over as many points {grid:.1f} s")


if __name__ == "__main__":
    main()
