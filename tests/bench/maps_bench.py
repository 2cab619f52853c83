"""The satellite's map against eigenvalue counts of the paper's own matrices at 20,000 random rational points.

    python tests/bench/maps_bench.py
    python tests/bench/maps_bench.py --growth      # only how time grows with degree and number of conditions

The counts are exact (characteristic polynomial of the first-order matrix, Sturm's chains); beside them stands the time
that a grid of as many points takes with NumPy's eigvals, which says nothing between its points.

Growth: oscillators  x'' + p_k x' + q_k x = 0,  p_k and q_k random polynomials of two parameters: each gives
two conditions.  Beside them a grid with as many rows and columns as the map has corners: a coarser one has corners that
share a cell.  Its time is that of NumPy's eigvals at so many points, from a sample of them.
"""

from __future__ import annotations

import sys
import time
from fractions import Fraction
from pathlib import Path
from random import Random

import numpy as np

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from tests.maps.test_map import SATELLITE, mapped, paper_matrices, roots_to_the_right  # noqa: E402

POINTS = 20_000


#: (number of oscillators, degree of their coefficients).
SIZES = ((1, 1), (2, 1), (4, 1), (8, 1), (1, 2), (2, 2), (4, 2), (1, 3), (2, 3), (1, 4), (2, 4))
#: Points of a grid that are really computed.
SAMPLE = 2_000


def growth() -> None:
    """Seconds of maps over the number and degree of conditions, beside those of a grid of the same resolution."""
    import mbsym
    from mbsym.algebra.failures import Failure
    from mbsym.maps.mapping import exact_map
    from mbsym.maps.section import Axis

    print("conditions  degree  map s  regions  grid points  grid s  grid/map")
    for count, degree in SIZES:
        chance = Random(1000 * count + degree)

        def entry(chance: Random = chance, degree: int = degree) -> str:
            terms = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
            return " + ".join(f"({chance.randint(-5, 5)})*a**{i}*b**{j}" for i, j in terms)

        rates, places = ([entry() for _ in range(count)] for _ in range(2))
        rows = {
            key: [[x if i == j else "0" for j in range(count)] for i, x in enumerate(entries)]
            for key, entries in (("D", rates), ("K", places))
        }
        text = "mbsym: 1\nname: growth\nparameters: {a: {sign: real}, b: {sign: real}}\nlinear system:\n"
        text += f"  coordinates: [{', '.join(f'x{k}' for k in range(count))}]\n"
        text += "".join(f"  {key}: {str(matrix).replace(chr(39), chr(34))}\n" for key, matrix in rows.items())
        started = time.perf_counter()
        try:
            found = exact_map(mbsym.loads(text), [Axis(name, Fraction(-1), Fraction(1)) for name in "ab"], {})
        except Failure as failure:
            print(f"{2 * count:10}  {degree:6}  {time.perf_counter() - started:5.2f}  {failure}")
            continue
        making = time.perf_counter() - started
        points = max(len(found.corners), 2) ** 2
        first = np.zeros((2 * count, 2 * count))
        first[:count, count:] = np.eye(count)
        started = time.perf_counter()
        for _ in range(SAMPLE):
            first[count:] = np.random.default_rng(1).normal(size=(count, 2 * count))
            np.linalg.eigvals(first)
        grid = (time.perf_counter() - started) * points / SAMPLE
        told = f"{2 * count:10}  {degree:6}  {making:5.2f}  {len(found.regions):7}  {points:11}"
        print(f"{told}  {grid:6.2f}  {grid / making:8.2f}")


def main() -> None:
    if "--growth" in sys.argv:
        growth()
        return
    started = time.perf_counter()
    found = mapped(*SATELLITE)
    making = time.perf_counter() - started
    random = Random(20261122)
    points = [
        (Fraction(random.randint(-9999, 9999), 10000), Fraction(random.randint(1, 9999), 10000)) for _ in range(POINTS)
    ]
    started = time.perf_counter()
    strata = [found.at(*point) for point in points]
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
    growth()


if __name__ == "__main__":
    main()
