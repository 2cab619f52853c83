"""Rows of a trajectory: seconds to integrate and fill 2 to 20001 of them, beside heyoka and SciPy.

    python tests/bench/rows_bench.py

Everybody integrates the same equations at the loosest tolerance of his own at which the largest error of 2001 rows,
against extended arithmetic, is within the target; processor time of one thread, compiling not counted, medians of
interleaved repetitions.  Who is not installed (the extra ``bench``) is left out, and that is said.
"""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import mbsym
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Setting, Unusable, compiled_kernel
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario

SYSTEMS = Path(__file__).parents[2] / "systems"
CASES = (("double-pendulum", 10.0, 1e-8), ("spring-pendulum", 20.0, 1e-8), ("spatial-arm", 5.0, 1e-8))
ROWS = (2, 201, 2001, 20_001)
REPEATS = 9

#: times -> states (2n, m)
Fill = Callable[[Any], Any]


def ours(dynamics: Dynamics, tolerance: float) -> Fill:
    """dop853: steps and rows in machine code; the run is made once and begins anew, as heyoka's does."""
    run = METHODS["dop853"].start(dynamics, Setting(tolerance=tolerance))
    state = np.array(run.state)

    def fill(times: Any) -> Any:
        run.restart(0.0, state)
        return run.fill(times)

    return fill


def heyoka(dynamics: Dynamics, tolerance: float) -> Fill:
    """Its propagate_grid, on expressions made of the same program."""
    from mbsym.numerics.methods.taylor import _integrator

    made = _integrator(dynamics, tolerance, "float64")
    state, one = np.array(made.state), copy.deepcopy(made)

    def fill(times: Any) -> Any:
        one.time, one.state[:] = 0.0, state
        return one.propagate_grid(times)[-1].T

    return fill


def scipy(dynamics: Dynamics, tolerance: float) -> Fill:
    """solve_ivp with DOP853, on the right-hand side that mbsym compiles."""
    from scipy.integrate import solve_ivp

    rhs = compiled_kernel(dynamics, "right_hand_side")
    start = np.array([float(x) for x in dynamics.scenario.state])

    def fill(times: Any) -> Any:
        span = (0.0, times[-1])
        return solve_ivp(slope, span, start, "DOP853", times, rtol=tolerance, atol=tolerance).y

    def slope(t: float, x: Any) -> Any:
        return rhs(np.concatenate(([t], x)))

    return fill


PEERS = {"heyoka": heyoka, "scipy": scipy}


def good_enough(make: Callable[[Dynamics, float], Fill], dynamics: Dynamics, truth: Any, target: float) -> Fill | None:
    """At the loosest of some tolerances with which the rows are within the target, relative to their sizes."""
    times = np.linspace(0.0, truth[0], 2001)
    sizes = np.max(np.abs(truth[1]), axis=1)[:, None]
    for exponent in np.arange(6.0, 15.1, 0.5):
        fill = make(dynamics, float(10**-exponent))
        if np.max(np.abs(fill(times) - truth[1]) / sizes) <= target:
            return fill
    return None


def seconds(fill: Fill, times: Any) -> float:
    """Processor time of one repetition, of as many as a millisecond or so holds."""
    started = time.process_time()
    count = 0
    while count < 3 or time.process_time() - started < 2e-3:
        fill(times)
        count += 1
    return (time.process_time() - started) / count


def main() -> None:
    for name, end, target in CASES:
        dynamics = Dynamics(scenario(mbsym.load(SYSTEMS / f"{name}.yaml").system))
        rows = np.linspace(0.0, end, 2001)
        truth = METHODS["dop853"].start(dynamics, Setting(tolerance=1e-17), "extended").fill(rows)
        found: dict[str, Fill] = {}
        for who, make in {"mbsym": ours, **PEERS}.items():
            try:
                fill = good_enough(make, dynamics, (end, truth.astype(float)), target)
            except (ImportError, Unusable) as reason:
                print(f"{name}: without {who} ({reason})")
                continue
            if fill is None:
                print(f"{name}: {who} does not reach {target:g}")
            else:
                found[who] = fill
        for count in ROWS:
            times = np.linspace(0.0, end, count)
            spent: dict[str, list[float]] = {who: [] for who in found}
            for _ in range(REPEATS):
                for who, fill in found.items():
                    spent[who].append(seconds(fill, times))
            middle = {who: float(np.median(values)) for who, values in spent.items()}
            ratios = ", ".join(f"{who} {middle[who] / middle['mbsym']:.2f}" for who in found if who != "mbsym")
            print(
                f"{name}, {count} rows, error {target:g}: mbsym {middle['mbsym'] * 1e3:.3f} ms; times as long: {ratios}"
            )


if __name__ == "__main__":
    main()
