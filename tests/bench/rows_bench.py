"""Rows of a trajectory: seconds to integrate and fill 2 to 20001 of them, beside heyoka and SciPy.

    python tests/bench/rows_bench.py [--links]

Everybody integrates the same equations at the loosest tolerance of his own at which the largest error of 2001 rows,
against extended arithmetic, is within the target; processor time of one thread, compiling not counted, medians of
interleaved repetitions.  Who is not installed (the extra ``bench``) is left out, and that is said.  ``--links``: six
links on one another, 2001 rows, by mbsym's ``taylor`` and by heyoka alone, as a JSON record.
"""

from __future__ import annotations

import json
import sys
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

#: Six on one another, hanging, drawn aside by 10 degrees.
LINKS = "mbsym: 1\nname: links\nbodies:\n" + "".join(
    f"  - {{name: b{k}, attached to: {f'b{k - 1}' if k > 1 else 0}, rotation: {{axes: [3], angles: [q{k}]}}, "
    f"connection point: [{min(k - 1, 1)}, 0, 0], mass centre: [1, 0, 0], mass: 1}}\n"
    for k in range(1, 7)
)
LINKS += "loads: [{uniform gravity: {vector: [0, -981/100, 0]}}]\n"
LINKS += "initial: {q1: -7/5, q2: 0, q3: 0, q4: 0, q5: 0, q6: 0}\n"

#: times -> states (2n, m)
Fill = Callable[[Any], Any]


def ours(method: str) -> Callable[[Dynamics, float], Fill]:
    """Steps and rows by a method of mbsym; the run is made once and begins anew, as heyoka's does."""

    def make(dynamics: Dynamics, tolerance: float) -> Fill:
        run = METHODS[method].start(dynamics, Setting(tolerance=tolerance))
        state = np.array(run.state)

        def fill(times: Any) -> Any:
            run.restart(0.0, state)
            return run.fill(times)

        return fill

    return make


def heyoka(dynamics: Dynamics, tolerance: float) -> Fill:
    """Its propagate_grid, on expressions made of the same program."""
    import heyoka

    from mbsym.numerics.methods.taylor import STRAIGHT, expressions

    code = dynamics.right_hand_side
    names = [heyoka.expression(name) for name in code.inputs[1:]]
    state = np.array([float(x) for x in dynamics.scenario.state])
    equations = [*zip(names, expressions(code, heyoka, np.float64), strict=True)]
    one = heyoka.taylor_adaptive(equations, state, tol=tolerance, compact_mode=code.operations > STRAIGHT)

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


def compared(
    dynamics: Dynamics, end: float, target: float, people: dict[str, Callable[[Dynamics, float], Fill]], label: str
) -> dict[str, Fill]:
    """Everybody at the loosest tolerance that reaches the target; who does not, or is not there, is told."""
    rows = np.linspace(0.0, end, 2001)
    truth = METHODS["dop853"].start(dynamics, Setting(tolerance=1e-17), "extended").fill(rows)
    found: dict[str, Fill] = {}
    for who, make in people.items():
        try:
            fill = good_enough(make, dynamics, (end, truth.astype(float)), target)
        except (ImportError, Unusable) as reason:
            print(f"{label}: without {who} ({reason})")
            continue
        if fill is None:
            print(f"{label}: {who} does not reach {target:g}")
        else:
            found[who] = fill
    return found


def medians(found: dict[str, Fill], times: Any) -> dict[str, float]:
    spent: dict[str, list[float]] = {who: [] for who in found}
    for _ in range(REPEATS):
        for who, fill in found.items():
            spent[who].append(seconds(fill, times))
    return {who: float(np.median(values)) for who, values in spent.items()}


def main() -> None:
    if "--links" in sys.argv[1:]:
        links = Dynamics(scenario(mbsym.loads(LINKS).system))
        found = compared(links, 10.0, 1e-8, {"mbsym": ours("taylor"), "heyoka": heyoka}, "six links")
        print(json.dumps(medians(found, np.linspace(0.0, 10.0, 2001))))
        return
    for name, end, target in CASES:
        dynamics = Dynamics(scenario(mbsym.load(SYSTEMS / f"{name}.yaml").system))
        found = compared(dynamics, end, target, {"mbsym": ours("dop853"), **PEERS}, name)
        for count in ROWS:
            middle = medians(found, np.linspace(0.0, end, count))
            ratios = ", ".join(f"{who} {middle[who] / middle['mbsym']:.2f}" for who in found if who != "mbsym")
            print(
                f"{name}, {count} rows, error {target:g}: mbsym {middle['mbsym'] * 1e3:.3f} ms; times as long: {ratios}"
            )


if __name__ == "__main__":
    main()
