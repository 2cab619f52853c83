"""Published mechanisms (``tests/mechanisms.py``): error against references, seconds, and what others published.

    python tests/bench/loops_bench.py [--table] [--forty] [NAME ...]

Each at the loosest tolerance (decades) with which the error at the end is within the target, of all or of those whose
name has one of the words in it.  Seconds are processor time of the run alone, the least of twenty, and of everything
before it: reading, equations, machine code (which the second time is read from a file).  Published times are from other
machines, and at errors that their authors did not all state: they show orders of magnitude, nothing else.

``--table`` prints the rows of docs/howto/constraints.md, whose errors tests/constrained/test_loops_told.py holds,
``--forty`` the forty four-bars alone as a JSON record.  Without them further lines say what equations and machine code
of a chain of ten pendulums take (PyDy's issue 536: 3906 s), and the operations of the bicycle's nonlinear right-hand
side.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")  # as the command has it; waiting threads would be counted
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

import mbsym  # noqa: E402
from mbsym.mechanics.constraints.dynamics import Chosen, constrained_dynamics  # noqa: E402
from mbsym.mechanics.programs import constants  # noqa: E402
from mbsym.numerics.closing import begun  # noqa: E402
from mbsym.numerics.dynamics import Dynamics  # noqa: E402
from mbsym.numerics.methods.interface import Setting, compiled_kernel  # noqa: E402
from mbsym.numerics.methods.table import METHODS  # noqa: E402
from mbsym.numerics.scenario import scenario  # noqa: E402
from mbsym.numerics.states import dynamics_of  # noqa: E402
from mbsym.source import read  # noqa: E402
from tests.constrained.test_mechanisms import chain, described  # noqa: E402
from tests.mechanisms import MECHANISMS, Mechanism, Truth  # noqa: E402

REPEATS = 20


@dataclass(frozen=True)
class Measured:
    """At the loosest tolerance 10^``power`` that reaches the target; seconds of processor time."""

    power: int
    error: float
    steps: int
    seconds: float
    before: float


def dynamics_at_start(mechanism: Mechanism) -> Dynamics:
    """In the variables of its run, led to its constraints."""
    system, complaints = read(mechanism.text)
    assert system is not None, list(complaints)
    return dynamics_of(begun(scenario(system, declared=bool(system.speeds)), (), declared=True).scenario)


@cache
def truth_of(mechanism: Mechanism) -> Truth:
    return mechanism.truth(mechanism.end)


def error_of(mechanism: Mechanism, found: Mapping[str, float]) -> float:
    """The largest; of an angle the distance of the unit vectors."""
    true = truth_of(mechanism).items()
    return max(abs((np.exp(1j * found[key]) if isinstance(x, complex) else found[key]) - x) for key, x in true)


def error_at(mechanism: Mechanism, dynamics: Dynamics, power: int) -> float:
    """At the end of a run with the tolerance 10^``power``."""
    state = METHODS[mechanism.method].start(dynamics, Setting(tolerance=10.0**power)).advance(mechanism.end)
    return float(error_of(mechanism, dict(zip(dynamics.inputs[1:], map(float, state), strict=True))))


def measured(mechanism: Mechanism) -> Iterator[Measured]:
    """For each target."""
    begin = time.process_time()
    dynamics, method = dynamics_at_start(mechanism), METHODS[mechanism.method]
    method.start(dynamics, Setting(tolerance=1e-3))
    before = time.process_time() - begin
    for target in mechanism.targets:
        power = next(k for k in range(-3, -15, -1) if error_at(mechanism, dynamics, k) <= target)
        spent = []
        for _ in range(REPEATS):
            run = method.start(dynamics, Setting(tolerance=10.0**power))
            begin = time.process_time()
            run.advance(mechanism.end)
            spent.append(time.process_time() - begin)
        error = error_at(mechanism, dynamics, power)
        yield Measured(power, error, run.work.steps, min(spent), before)


def line(mechanism: Mechanism, found: Measured) -> str:
    told = f"tolerance 1e{found.power}, error {found.error:.1e}, {found.steps} steps, {found.seconds * 1e3:.3g} ms"
    further = f"; {mechanism.published}" if mechanism.published else ""
    return f"{mechanism.name}: {told} (before: {found.before:.2f} s){further}"


def row(mechanism: Mechanism, found: Measured) -> str:
    cells = (mechanism.name, f"{mechanism.end:g}", f"1e{found.power}", f"{found.error:.1e}", f"{found.steps}")
    return "| " + " | ".join((*cells, f"{found.seconds * 1e3:.2g} ms", mechanism.published)) + " |"


def chain_of_ten() -> str:
    """Equations and machine code of ten pendulums in Cartesian coordinates."""
    begin = time.process_time()
    dynamics = Dynamics(described(chain(10)))
    compiled_kernel(dynamics, "right_hand_side")
    spent, operations = time.process_time() - begin, dynamics.right_hand_side.operations
    return f"chain of ten pendulums: {operations} operations, equations and machine code {spent:.2f} s; PyDy: 3906 s"


def bicycle() -> str:
    """Operations with parameters as names (constants once), and with their numbers."""
    analysis = mbsym.load(ROOT / "systems" / "bicycle.yaml", (3,))
    found = analysis.constraints
    kept = [(found.names[i].constraint, found.names[i].component) for i in found.independent]
    dynamics = constrained_dynamics(analysis.system, analysis.ring, Chosen(tuple(kept)))
    named = dynamics.program.operations(dynamics.accelerations, constants(analysis.system))
    numbers = Dynamics(scenario(analysis.system)).right_hand_side.operations
    return f"bicycle, right-hand side: {named} operations with named parameters, {numbers} with numbers"


def main() -> None:
    words = [word for word in sys.argv[1:] if not word.startswith("--")]
    chosen = [one for one in MECHANISMS if not words or any(word in one.name for word in words)]
    if "--forty" in sys.argv[1:]:
        (forty,) = (one for one in MECHANISMS if one.name == "A02, N = 40")
        print(json.dumps(asdict(next(measured(forty)))))
        return
    told = row if "--table" in sys.argv[1:] else line
    for mechanism in chosen:
        for found in measured(mechanism):
            print(told(mechanism, found), flush=True)
    if told is line and not words:
        print(chain_of_ten(), flush=True)
        print(bicycle(), flush=True)


if __name__ == "__main__":
    main()
