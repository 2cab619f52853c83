"""Every kind of constraint in speeds: rows against places in inertial axes, embedded equations against multipliers."""

from __future__ import annotations

import pytest
from kinds_of_constraints import BODIES, KINDS

from mbsym.analysis.pipeline import Analysis
from mbsym.problems.checks import EXACT, NUMERICAL
from mbsym.source import read

#: Without multipliers their equations outgrow the budget, and nobody has them to check.
LONG = {"parallel", "rolling on a body"}

ARM = "connection point: [1, 0, 0],\n     inertia about: joint, inertia: [A, A, A]}"
WHEEL = "angles: [phi]}, inertia about: joint,\n     inertia: [A, A, A]}"


def in_speeds(kind: str, orientation: str) -> Analysis:
    assert ARM in BODIES
    assert WHEEL in BODIES
    arm = ARM[:-1] + f", speeds: {{p: omega1, q: omega2, n: omega3}}, orientation: {orientation}}}"
    wheel = WHEEL[:-1] + ", speeds: {k: omega1, w: omega3, h: x_dot + y*phi_dot}}"
    text = BODIES.replace(ARM, arm).replace(WHEEL, wheel) + f"  - {KINDS[kind]}\n"
    system, complaints = read(text)
    assert system is not None, list(complaints)
    return Analysis(system, (3,))


@pytest.mark.parametrize("orientation", ["angles", "direction cosines"])
@pytest.mark.parametrize("kind", KINDS)
def test_rows_and_equations_agree_with_the_oracle(kind: str, orientation: str) -> None:
    found = in_speeds(kind, orientation)
    found.stage(3)
    rows = found.check("constraints")
    assert rows is not None, found.stage(3).failure
    assert rows.outcome in (EXACT, NUMERICAL), rows
    if kind == "distance":  # the second check takes ten seconds of enclosures
        return
    motion = found.check("constrained motion")
    assert (motion is None) == (kind in LONG)
    assert motion is None or motion.outcome in (EXACT, NUMERICAL), motion
    assert not found.defects
