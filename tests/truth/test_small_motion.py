"""A small motion is no rest: what two runs agree on is measured by its own size."""

from __future__ import annotations

from math import sin

import numpy as np
import pytest

import mbsym
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.planning.planning import planned
from mbsym.numerics.planning.sizes import scaled
from mbsym.numerics.scenario import scenario
from mbsym.report.runs.simulation_words import error_lines
from mbsym.simulation import Request, simulate
from mbsym.simulation.result import ErrorEstimate

FAST_TOP = """
mbsym: 1
name: Fast top, let go
parameters: {m: positive, g: positive, l: positive, A: positive, C: positive}
bodies:
  - name: b
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [psi, th, phi]}
    mass centre: [0, 0, l]
    mass: m
    inertia about: joint
    inertia: [A, A, C]
loads:
  - uniform gravity: {vector: [0, 0, -g]}
values: {m: 1, g: 9.81, l: 1/10, A: 1/50, C: 1/100}
initial: {psi: 0, th: 1/2, phi: {position: 0, velocity: 10000}}
"""

#: th' = (m g l sin th0/(C w)) sin(C w t/A), within some 1e-5 of it: the nutation of a fast top that is let go.
NUTATION = 9.81 * 0.1 * sin(0.5) / (0.01 * 1e4)


def test_the_nutation_of_a_fast_top_is_no_rest() -> None:
    """Its spin could turn it at 7000 a second, and it nutates at 0.0047: a millionth, which both runs show alike."""
    given = scenario(mbsym.loads(FAST_TOP).system)
    found = simulate(given, Request(time=0.01, samples=101, estimate=True))
    assert isinstance(found.error, ErrorEstimate)
    th_dot = next(q for q in found.error.quantities if q.name == "th_dot")
    assert th_dot.size == pytest.approx(NUTATION, rel=1e-3)
    assert th_dot.size < th_dot.floor
    assert not th_dot.rests
    assert not any("rest" in line for line in error_lines(found.error))
    plan = planned(given, Accuracy(1e-8), np.linspace(0, 0.01, 101))
    assert plan.reached
    least = next(bound for bound in plan.bounds)
    # 1e-8 of its size: measured by what the spin could do, a hundredth of the nutation would have been accurate enough.
    assert least.quantity in ("th_dot", "psi_dot")


def test_what_two_runs_do_not_agree_on_rests() -> None:
    """Sizes 1e-12 beside 1: by 1e-15 apart one moves, by as much as it is it rests; what is zero has no size at all."""
    own, usual = np.array([1e-12, 1e-12, 0.0]), np.ones(3)
    assert scaled(own, usual, np.array([1e-15, 1e-12, 0.0])).tolist() == [1e-12, 1.0, 1.0]
