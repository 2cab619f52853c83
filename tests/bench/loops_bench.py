"""Closed loops of the IFToMM library: error against references, seconds, and what others published.

    python tests/bench/loops_bench.py [--large] [--table]

Each problem at the loosest tolerance of dop853 (decades) with which the error at the end is within the target.  Seconds
are processor time of the run alone, median of some, and of everything before it: reading, equations, machine code.
Published times are from other machines, and at errors that their authors did not all state: they show orders of
magnitude, nothing else.  ``--large`` adds forty four-bars, whose machine code takes some seconds the first time;
nobody's time at a stated error was found for them.  Then what equations and machine code take: a chain of ten pendulums
(PyDy's issue 536: 3906 s), and the operations of the bicycle's nonlinear right-hand side.  ``--table`` prints the rows
of docs/howto/constraints.md, whose errors tests/constrained/test_loops_told.py holds.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

TESTS = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(TESTS / "constrained"))

from test_mechanisms import ANGLES, chain, described, four_bars, reference, shipped  # noqa: E402

import mbsym  # noqa: E402
from mbsym.mechanics.constraints.dynamics import Chosen, constrained_dynamics  # noqa: E402
from mbsym.mechanics.programs import constants  # noqa: E402
from mbsym.numerics.closing import closed  # noqa: E402
from mbsym.numerics.dynamics import Dynamics  # noqa: E402
from mbsym.numerics.methods.interface import Setting, compiled_kernel  # noqa: E402
from mbsym.numerics.methods.table import METHODS  # noqa: E402
from mbsym.numerics.scenario import Scenario, scenario  # noqa: E402

REPEATS = 5
SHIPPED = TESTS.parent / "systems"


@dataclass(frozen=True)
class Problem:
    """``wrong`` is the error of the states at ``end``; ``published`` what others say they need, and who."""

    name: str
    made: Callable[[], Scenario]
    end: float
    target: float
    wrong: Callable[[Dynamics, Any], float]
    published: str = ""


def bob(dynamics: Dynamics, state: Any) -> float:
    truth = [float(x) for x in reference("iftomm_a01_pendulum")["reference"]["xy"]["10"]]
    return float(np.max(np.abs(state[:2] - truth)))


def first_bar(truth: tuple[float, float]) -> Callable[[Dynamics, Any], float]:
    def wrong(dynamics: Dynamics, state: Any) -> float:
        angle = state[dynamics.system.coordinates.index("th0")]
        return float(np.max(np.abs(np.array([-np.sin(angle), np.cos(angle)]) - truth)))

    return wrong


def squeezed(dynamics: Dynamics, state: Any) -> float:
    truth = reference("andrews_squeezer")["reference"]["recomputed_t003"]["q"]
    names = dynamics.system.coordinates
    return max(abs(float(state[names.index(name)]) - float(x)) for name, x in zip(ANGLES, truth, strict=True))


def by_one_angle(number: int, end: float) -> tuple[float, float]:
    """B0 of ``number`` four-bars at ``end``: they move as one pendulum, I th'' = G sin th, th'(0) = 1."""
    from scipy.integrate import solve_ivp

    inertia, weight = (number + 1) / 3 + number, ((number + 1) / 2 + number) * 9.81
    run = solve_ivp(
        lambda t, x: [x[1], weight / inertia * np.sin(x[0])], (0, end), [0, 1], "DOP853", rtol=3e-14, atol=1e-15
    )
    return float(np.sin(run.y[0, -1])), float(np.cos(run.y[0, -1]))


def on_the_axis(dynamics: Dynamics, state: Any) -> float:
    return float(np.max(np.abs(state - [float(x) for x in reference("ivp_caraxis")["reference"]["y"][:8]])))


PENDULUM = chain(1).replace("initial: {x0: 1", "initial: {x0: -1")


def problems(large: bool) -> Iterator[Problem]:
    """By name and target."""
    yield Problem("A01 pendulum, Cartesian", lambda: described(PENDULUM), 10.0, 1e-6, bob)
    x, y = (float(value) for value in reference("iftomm_a02_n_four_bar")["reference"]["recomputed"]["N=2"]["10"])
    told = "OpenSim 3.2: 0.455 s (i5-4570)"
    for target in (1e-3, 1e-6, 1e-9):
        yield Problem("A02 two four-bars", lambda: described(four_bars(2)), 10.0, target, first_bar((x, y)), told)
    for number, name in ((1, "one four-bar"), (10, "ten four-bars")):
        wrong = first_bar(by_one_angle(number, 10.0))
        yield Problem(f"A02 {name}", lambda number=number: described(four_bars(number)), 10.0, 1e-6, wrong)  # type: ignore[misc]
    yield Problem("car axis", lambda: shipped("car-axis"), 3.0, 1e-8, on_the_axis)
    if large:
        wrong = first_bar(by_one_angle(40, 20.0))
        yield Problem("A02 forty four-bars", lambda: described(four_bars(40)), 20.0, 1e-3, wrong)
    for target in (1e-4, 1e-8, 1e-12):
        yield Problem("A03 Andrews' squeezer", lambda: shipped("andrews-squeezer"), 0.03, target, squeezed)


@dataclass(frozen=True)
class Measured:
    """At the loosest tolerance 10^``power`` that reaches the target; seconds of processor time."""

    power: int
    error: float
    steps: int
    seconds: float
    before: float


def error_at(problem: Problem, dynamics: Dynamics, power: int) -> float:
    """At the end of a run with the tolerance 10^``power``."""
    run = METHODS["dop853"].start(dynamics, Setting(tolerance=10.0**power))
    return problem.wrong(dynamics, run.advance(problem.end))


def measured(problem: Problem) -> Measured:
    begun = time.process_time()
    dynamics = Dynamics(closed(problem.made()).scenario)
    METHODS["dop853"].start(dynamics, Setting(tolerance=1e-3))
    before = time.process_time() - begun
    power = next(k for k in range(-3, -15, -1) if error_at(problem, dynamics, k) <= problem.target)
    spent = []
    for _ in range(REPEATS):
        run = METHODS["dop853"].start(dynamics, Setting(tolerance=10.0**power))
        started = time.process_time()
        state = run.advance(problem.end)
        spent.append(time.process_time() - started)
    return Measured(power, problem.wrong(dynamics, state), run.work.steps, float(np.median(spent)), before)


def line(problem: Problem, found: Measured) -> str:
    told = f"tolerance 1e{found.power}, error {found.error:.1e}, {found.steps} steps, {found.seconds * 1e3:.3g} ms"
    further = f"; {problem.published}" if problem.published else ""
    return f"{problem.name}: {told} (before: {found.before:.2f} s){further}"


def row(problem: Problem, found: Measured) -> str:
    cells = (problem.name, f"{problem.end:g}", f"1e{found.power}", f"{found.error:.1e}", f"{found.steps}")
    return "| " + " | ".join((*cells, f"{found.seconds * 1e3:.2g} ms", problem.published)) + " |"


def chain_of_ten() -> str:
    """Equations and machine code of ten pendulums in Cartesian coordinates."""
    begun = time.process_time()
    dynamics = Dynamics(described(chain(10)))
    compiled_kernel(dynamics, "right_hand_side")
    spent, operations = time.process_time() - begun, dynamics.right_hand_side.operations
    return f"chain of ten pendulums: {operations} operations, equations and machine code {spent:.2f} s; PyDy: 3906 s"


def bicycle() -> str:
    """Operations with parameters as names (constants once), and with their numbers."""
    analysis = mbsym.load(SHIPPED / "bicycle.yaml", (3,))
    found = analysis.constraints
    kept = [(found.names[i].constraint, found.names[i].component) for i in found.independent]
    dynamics = constrained_dynamics(analysis.system, analysis.ring, Chosen(tuple(kept)))
    named = dynamics.program.operations(dynamics.accelerations, constants(analysis.system))
    numbers = Dynamics(scenario(analysis.system)).right_hand_side.operations
    return f"bicycle, right-hand side: {named} operations with named parameters, {numbers} with numbers"


def main() -> None:
    told = row if "--table" in sys.argv[1:] else line
    for problem in problems("--large" in sys.argv[1:]):
        print(told(problem, measured(problem)), flush=True)
    if told is row:
        return
    print(chain_of_ten(), flush=True)
    print(bicycle(), flush=True)


if __name__ == "__main__":
    main()
