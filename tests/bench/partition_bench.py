"""Two ways to keep a run on its constraints, at equal tolerances and with the same method: led back, or partitioned.

    led           all coordinates are integrated, each step is led back by the shortest way in the kinetic metric
    partitioned   only independent coordinates and velocities are integrated (Wehage & Haug 1982); dependent ones follow
                  by Newton's method in every evaluation; the partition is chosen by pivots of J, and chosen anew at the
                  end of a step where its condition is three times the best there is

The accelerations are the same compiled ones.  Errors are those at the end against Taylor's method in extended
arithmetic, in parts of each quantity's size.

    python tests/bench/partition_bench.py
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.linalg import qr

TESTS = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(TESTS.parent), str(TESTS), str(TESTS / "constrained")]

from test_constrained_trade import CHANGE_POINT  # noqa: E402

from mbsym.numerics.closing import closed  # noqa: E402
from mbsym.numerics.dynamics import Dynamics  # noqa: E402
from mbsym.numerics.methods.interface import compiled_kernel  # noqa: E402
from mbsym.numerics.scenario import scenario  # noqa: E402
from mbsym.simulation import Request, simulate  # noqa: E402
from mbsym.source import load, read  # noqa: E402

SWITCH, NEWTON, MOST = 3.0, 20, 20_000


class Partitioned:
    """A run in independent coordinates."""

    def __init__(self, dynamics: Dynamics, tolerance: float) -> None:
        assert dynamics.constraints is not None
        self.constraints, self.rates = dynamics.constraints, compiled_kernel(dynamics, "right_hand_side")
        self.n, self.kept = dynamics.size, list(dynamics.constraints.kept)
        self.h = sum(k < self.constraints.holonomic for k in self.kept)
        self.tolerance, self.evaluations, self.switches = tolerance, 0, 0
        self.state = np.array([float(x) for x in dynamics.scenario.state])
        self.time, self.guess = 0.0, self.state

    def rows(self, t: float, state: Any) -> tuple[Any, Any, Any]:
        found = self.constraints.at(t, state)
        return found.positions[self.kept[: self.h]], found.velocities[self.kept], found.partials[self.kept]

    def choose(self) -> None:
        partials = self.rows(self.time, self.state)[2]
        order = qr(partials, pivoting=True, mode="r")[1]
        self.dependent = np.sort(order[: len(self.kept)])
        self.free = np.sort(order[len(self.kept) :])
        self.least = np.linalg.cond(partials[:, self.dependent])

    def whole(self, t: float, y: Any) -> Any:
        """(q, q') from the independent ones."""
        state, n, f = self.guess.copy(), self.n, len(self.free)
        state[self.free], state[n + self.free] = y[:f], y[f:]
        for _ in range(NEWTON):
            position, _, partials = self.rows(t, state)
            step = np.linalg.solve(partials[:, self.dependent], -position)
            state[self.dependent] += step
            if np.max(np.abs(step)) < 1e-14 * (1 + np.max(np.abs(state[:n]))):
                break
        else:
            raise ArithmeticError("Newton's method does not end")
        state[n + self.dependent] = 0.0
        _, velocity, partials = self.rows(t, state)
        state[n + self.dependent] = np.linalg.solve(partials[:, self.dependent], -velocity)
        self.guess = state
        return state

    def derivative(self, t: float, y: Any) -> Any:
        self.evaluations += 1
        state = self.whole(t, y)
        rates = self.rates(np.concatenate(([t], state)))
        return np.concatenate([state[self.n + self.free], rates[self.n + self.free]])

    def advance(self, end: float) -> int:
        """Steps taken; raises ArithmeticError or LinAlgError where the run ends."""
        steps, length = 0, None
        while self.time < end:
            self.choose()
            y = np.concatenate([self.state[self.free], self.state[self.n + self.free]])
            first = None if length is None else min(length, end - self.time)
            run = DOP853(self.derivative, self.time, y, end, rtol=self.tolerance, atol=self.tolerance, first_step=first)
            while run.status == "running" and steps < MOST:
                try:
                    run.step()
                    if run.status == "failed":
                        raise ArithmeticError("steps become too small")
                    self.state, self.time, length = self.whole(run.t, run.y), run.t, run.h_abs
                except (ArithmeticError, np.linalg.LinAlgError):  # tried again with half the step
                    length, self.guess, steps = run.h_abs / 2, self.state, steps + 1
                    if length < 1e-12 * end:
                        raise
                    break
                steps += 1
                partials = self.rows(self.time, self.state)[2]
                best = np.linalg.cond(partials[:, np.sort(qr(partials, pivoting=True, mode="r")[1][: len(self.kept)])])
                if np.linalg.cond(partials[:, self.dependent]) > SWITCH * best:
                    self.switches += 1
                    break
            if steps >= MOST:
                raise ArithmeticError("too many steps")
        return steps


def shipped(name: str) -> Any:
    system, complaints, _ = load(TESTS / "systems" / f"{name}.yaml")
    assert system is not None, list(complaints)
    return closed(scenario(system)).scenario


def through_the_line() -> Any:
    """The change-point four-bar, whose links come in line once a turn."""
    system, _ = read(CHANGE_POINT)
    assert system is not None
    return closed(scenario(system)).scenario


def main() -> None:
    """One line for each system and tolerance."""
    cases = [("andrews-squeezer", shipped("andrews-squeezer"), 0.03), ("bricard", shipped("bricard"), 5.0)]
    cases.append(("change point", through_the_line(), 5.0))
    print(
        f"{'system':18} {'tolerance':>9}   {'led: error, evaluations, drift':38}   partitioned: error, evaluations, ..."
    )
    for name, given, end in cases:
        dynamics = Dynamics(given)
        truth = simulate(given, Request(end, method="taylor", tolerance=1e-17, arithmetic="extended", estimate=False))
        last = np.asarray(truth.trajectory.states[:, -1], dtype=float)
        size = np.max(np.abs(np.asarray(truth.trajectory.states, dtype=float)), axis=1)
        for tolerance in (1e-6, 1e-9, 1e-12):
            run = simulate(given, Request(end, method="scipy-dop853", tolerance=tolerance, samples=2, estimate=False))
            error = np.max(np.abs(run.trajectory.states[:, -1] - last) / size) if run.whole else np.nan
            work = run.trajectory.work
            drift = max(run.drift.largest) if run.drift is not None else np.nan
            told = f"{work.evaluations:6d}  {drift:8.1e}  {len(work.singular)} over"
            line = f"{name:18} {tolerance:9.0e}   {error:8.1e}  {told}"
            other, started = Partitioned(dynamics, tolerance), time.perf_counter()
            try:
                steps = other.advance(end)
                error = float(np.max(np.abs(other.state - last) / size))
                line += f"         {error:8.1e}  {other.evaluations:6d}  {steps} steps, {other.switches} switches"
            except (ArithmeticError, np.linalg.LinAlgError) as ended:
                line += f"         ends at t = {other.time:.4g}: {ended}, {other.evaluations} evaluations"
            print(line, f"{time.perf_counter() - started:.1f} s", flush=True)


if __name__ == "__main__":
    main()
