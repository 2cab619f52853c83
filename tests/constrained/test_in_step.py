"""Steady motions on which several angles turn: what they have in common does not vary, in any coordinates.

Wheels with a coupling rod: frame, wheels and rod have, with x' = r p' and the rod parallel to itself,

    2 T = (3 m r^2 + m r^2/2 + m r^2/2) p'^2 + (m/10)((r - e sin p)^2 + e^2 cos^2 p) p'^2,    U = -(m/10) g e sin p,

so that p' = const needs e = 0; counterweights -e/20 of both wheels, m each, make T and U constant.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import mbsym
from mbsym.analysis.stages import Unavailable
from mbsym.mechanics import motion
from mbsym.problems.stability.words import Word

ROD = (Path(__file__).parents[1] / "cases" / "constraints" / "coupling-rod.yaml").read_text(encoding="utf-8")
WHEEL = "mass: m, inertia about: mass centre"
BALANCED = ROD.replace(WHEEL, "mass: m, mass centre: [-e/20, 0, 0], inertia about: mass centre")
GIVEN = "motion: {x: {rate: v}, p: {rate: v/r}, s: {rate: v/r}, b: {rate: -v/r}}"

BARS = """
mbsym: 1
name: two bars on one axis, a spring between their ends
parameters: {m: positive, l: positive, k: positive, w: real}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: m, mass centre: [l, 0, 0]}
  - {name: two, attached to: 0, rotation: {axes: [3], angles: [b]}, mass: m, mass centre: [l, 0, 0]}
loads:
  - spring: {between: [{body: one, point: [l, 0, 0]}, {body: two, point: [l, 0, 0]}], stiffness: k, length: 0}
motion: {a: {rate: w}, b: {rate: w}}
"""

#: The end of the second bar stays on a line through the axis of the first: b = -2 a.  What has mass is the elbow.
ELBOW = """
mbsym: 1
name: an elbow that goes round
parameters: {m: positive, l: positive, w: positive}
bodies:
  - {name: one, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: m, mass centre: [l, 0, 0]}
  - {name: two, attached to: one, connection point: [l, 0, 0], rotation: {axes: [3], angles: [b]}, mass: 0}
constraints:
  - relation: l*sin(a) + l*sin(a + b) = 0
motion: {a: {rate: w}, b: {rate: -2*w}}
initial: {a: 0, b: 0}
"""

TABLE = BARS.replace("k: positive, w: real}", "k: positive, w: real}\nprescribed: {chi: {rate: w}}")
TABLE = TABLE.replace("angles: [a]}, mass: m, mass centre: [l, 0, 0]}", "angles: [chi]}, mass: 0}").replace(
    "a: {rate: w}, ", ""
)

#: A bar that is pinned to a turntable at two points, and another on it.
PINNED = """
mbsym: 1
name: a bar on a turntable
parameters: {m: positive, l: positive, k: positive, w: real}
prescribed: {chi: {rate: w}}
bodies:
  - {name: table, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - {name: two, attached to: 0, rotation: {axes: [3], angles: [b]}, mass: m, mass centre: [l, 0, 0]}
  - {name: three, attached to: two, connection point: [l, 0, 0], rotation: {axes: [3], angles: [c]}, mass: m,
     mass centre: [l, 0, 0]}
loads: [{generalized force: {c: -k*c}}]
constraints:
  - coincide: [{body: table, point: [l, 0, 0]}, {body: two, point: [l, 0, 0]}]
motion: {b: {rate: w}, c: 0}
initial: {b: 0, c: 0}
"""


@pytest.mark.parametrize("given", [GIVEN, "motion: {x: {rate: v}}"])
def test_wheels_with_a_balanced_rod_run_steadily(given: str) -> None:
    """Also where only x' = v is said, and the other rates follow."""
    assert ROD.count(WHEEL) == 2
    assert GIVEN in ROD
    analysis = mbsym.loads(BALANCED.replace(GIVEN, given))
    assert analysis.equilibrium.satisfied
    assert analysis.linearisation.varying == ()
    assert all(not check.failed for check in analysis.checks)


def test_wheels_with_a_rod_that_is_lifted_do_not() -> None:
    """The force of the rod's weight, m g e cos(p)/10, is what is left; no condition is told of the constraints."""
    found = mbsym.loads(ROD).equilibrium
    assert not found.satisfied
    assert [str(x) for x in found.conditions] == ["cos(p)"]
    assert (found.solved, found.unsteady) == ((), ("p",))


def test_bars_in_their_own_angles_and_in_the_relative_one() -> None:
    """m l^2 (a - b)''/2 = -k l^2 (a - b) to first order, and a + b drifts."""
    apart = mbsym.loads(BARS)
    together = mbsym.loads(BARS.replace("two, attached to: 0", "two, attached to: one").replace("b: {rate: w}", "b: 0"))
    for one in (apart, together):
        assert one.equilibrium.satisfied
        assert one.stability.verdict.word is Word.STABLE_BUT_CYCLIC
        assert all(not check.failed for check in one.checks)
        assert not one.linearisation.varying
    m, stiffness = apart.linearisation.M, apart.linearisation.K
    assert [str(x) for x in (m[0, 0], m[0, 1])] == ["m*l**2", "0"]
    assert [str(x) for x in (stiffness[0, 0], stiffness[0, 1])] == ["l**2*k", "-l**2*k"]


def test_a_bar_beside_a_turntable() -> None:
    """m l^2 b'' = -k l^2 (b - chi) about b = chi = w t."""
    found = mbsym.loads(TABLE)
    assert found.equilibrium.satisfied
    assert str(found.linearisation.K[0, 0]) == "l**2*k"
    assert all(not check.failed for check in found.checks)


def test_a_bar_that_is_held_by_a_turntable() -> None:
    """b = chi by two rows of which one follows from the other; m l^2 c'' = -(k + m l^2 w^2) c about c = 0."""
    found = mbsym.loads(PINNED)
    assert found.equilibrium.satisfied
    assert found.linearisation.coordinates == ("c",)
    m, k = found.linearisation.M[0, 0], found.linearisation.K[0, 0]
    assert (str(m), str(k)) == ("m*l**2", "m*l**2*w**2 + k")
    assert all(not check.failed for check in found.checks)


def test_an_angle_twice_as_fast() -> None:
    assert mbsym.loads(ELBOW).equilibrium.satisfied


def test_a_wrong_ratio_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Angles that are said to turn three times as fast as they do: the second route has a moment of the motion."""
    right = motion.in_step

    def wrong(*arguments: object) -> dict[str, tuple[str, int]]:
        return {name: (first, 3 * k) for name, (first, k) in right(*arguments).items()}  # type: ignore[arg-type]

    monkeypatch.setattr(motion, "in_step", wrong)
    with pytest.raises(Unavailable, match="self-check 'equilibrium' failed"):
        _ = mbsym.loads(BARS).equilibrium
