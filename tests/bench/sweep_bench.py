"""A million verdicts of the satellite beside a NumPy loop over ``eigvals``.

    python tests/bench/sweep_bench.py [--points 1000000] [--peer 20000]

The peer is what people write: for every point the matrices of problem 5 as NumPy arrays, the companion matrix,
``numpy.linalg.eigvals``, and a look at the real parts with a tolerance.  It proves nothing and tells no border from a
slow instability; it is measured on fewer points and scaled.  ``stacked`` is the same with all points in one array.
The sweep is the whole command in a process of its own, with tables and pictures; ``verdicts`` is measuring alone.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

import mbsym
from mbsym.maps.section import Axis, section
from mbsym.numerics.ensembles.variation import Grid, Points
from mbsym.sweeps.judged import RIGHT, StabilityMeasure
from mbsym.sweeps.roots import RootsMeasure
from mbsym.sweeps.sweep import CHUNK, chunks

ROOT = Path(__file__).resolve().parents[2]
SATELLITE = ROOT / "systems" / "satellite.yaml"
SETTINGS = {"p1": Fraction(2, 5), "p2": Fraction(1, 5)}
ENDS = Fraction(-99, 100), Fraction(99, 100)


def loop(found: Any, points: Any) -> Any:
    """Roots with Re > 1e-9, point by point."""
    n = [part.size for part in found.parts]
    make = [[[_function(x) for row in matrix for x in row] for matrix in _matrices(part)] for part in found.parts]
    counts = np.zeros(points.shape[1], dtype=int)
    for place, (x, y) in enumerate(points.T):
        for size, functions in zip(n, make, strict=True):
            m, c, k = (np.array([f(x, y) for f in entries]).reshape(size, size) for entries in functions)
            a = np.zeros((2 * size, 2 * size))
            a[:size, size:] = np.eye(size)
            a[size:, :size], a[size:, size:] = -np.linalg.solve(m, k), -np.linalg.solve(m, c)
            counts[place] += int(np.sum(np.linalg.eigvals(a).real > 1e-9))
    return counts


def _matrices(part: Any) -> Any:
    from mbsym.algebra.matrices import added

    return part.M, added(part.D, part.G), added(part.K, part.N)


def _function(x: Any) -> Any:
    """A polynomial as a Python lambda, as a code generator would write it."""
    terms = [f"{float(Fraction(int(c.p), int(c.q)))!r}*x**{int(m[0])}*y**{int(m[1])}" for m, c in x.terms()]
    return eval("lambda x, y: " + (" + ".join(terms) or "0.0"))  # made of numbers only


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--points", type=int, default=1_000_000)
    options.add_argument("--peer", type=int, default=20_000)
    asked = options.parse_args()
    side = round(asked.points**0.5)
    points = Points((Grid("alpha", -0.99, 0.99, side), Grid("gamma", -0.99, 0.99, side)))
    started = time.perf_counter()
    analysis = mbsym.load(SATELLITE)
    found = section(analysis, [Axis("alpha", *ENDS), Axis("gamma", *ENDS)], SETTINGS)
    measure = StabilityMeasure(analysis, found)
    measure.at(points.part(0, 100))
    derived = time.perf_counter() - started
    started = time.process_time()
    right = np.concatenate([measure.at(points.part(c.start, c.stop))[RIGHT.name] for c in chunks(points.count)])
    own = time.process_time() - started
    chosen = np.random.default_rng(1).permutation(points.count)[: asked.peer]
    some = points.part(0, points.count)[:, chosen]
    started = time.process_time()
    counts = loop(found, some)
    peer = (time.process_time() - started) * points.count / asked.peer
    judged = right[chosen] >= 0  # elsewhere the kinetic energy is not positive definite, and nothing is claimed
    differ = int(np.sum((counts != right[chosen])[judged]))
    roots = RootsMeasure(found, "omega0")
    started = time.process_time()
    for c in chunks(asked.peer, CHUNK):
        roots.roots(some[:, c.start : c.stop])
    stacked = (time.process_time() - started) * points.count / asked.peer
    with tempfile.TemporaryDirectory() as folder:
        ends = [f"{name}=-0.99:0.99:{side}" for name in ("alpha", "gamma")]
        command = [sys.executable, "-m", "mbsym_cli", "sweep", str(SATELLITE), "-v", ends[0], "-v", ends[1], "-q"]
        started = time.perf_counter()
        subprocess.run([*command, "-s", "p1=2/5", "-s", "p2=1/5", "-o", folder], check=True, cwd=ROOT)
        whole = time.perf_counter() - started
    print(f"{points.count:,} points of the satellite's plane, {os.cpu_count()} processors")
    print(f"  derived and compiled        {derived:8.2f} s")
    print(f"  verdicts, one thread        {own:8.2f} s   {measure.operations} operations a point")
    print(f"  mbsym sweep, all files      {whole:8.2f} s   (wanted: under 10)")
    print(f"  NumPy loop over eigvals     {peer:8.2f} s   {peer / own:6.1f} times as long (wanted: 50)")
    print(f"  NumPy, all points stacked   {stacked:8.2f} s   {stacked / own:6.1f} times as long")
    print(f"  points where the loop counts other roots than the exact judge: {differ} of {np.sum(judged)}")


if __name__ == "__main__":
    main()
