"""Extremes with constraints: positions that lose their rank, by hand; states on the constraints; what is said."""

from __future__ import annotations

import json
from fractions import Fraction
from math import pi
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from conftest import filed, invoked, system_of

from mbsym.mechanics.variables import ring_of
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.extremes.extremes import extremes, on_constraints
from mbsym.numerics.extremes.extremes_told import lost_rank, sentences
from mbsym.numerics.extremes.singular_positions import SingularPositions, singular_positions
from mbsym.numerics.probes import RATIO, Ladder, Probe, scaled
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.report.schemas import schema


def four_bar(crank: str, coupler: str, rocker: str, ground: str, start: str) -> str:
    """Angles relative to the last link."""
    links = [("crank", "0", "0", "a", crank), ("coupler", "crank", crank, "b", coupler)]
    links.append(("rocker", "coupler", coupler, "c", rocker))
    lines = ["mbsym: 1", "name: Four-bar", "parameters: {m: positive, l: positive}", "bodies:"]
    for name, base, at, angle, length in links:
        lines.append(
            f"  - {{name: {name}, attached to: {base}, connection point: [{at}, 0, 0], mass: m,"
            f" rotation: {{axes: [3], angles: [{angle}]}}, mass centre: [({length})/2, 0, 0],"
            " inertia about: mass centre, inertia: [0, 0, m*l**2]}"
        )
    lines.append("constraints:")
    lines.append(f"  - coincide: [{{body: rocker, point: [{rocker}, 0, 0]}}, {{body: 0, point: [{ground}, 0, 0]}}]")
    lines.append(f"initial: {{{start}}}")
    return "\n".join(lines).replace("parameters: {m: positive, l: positive}", VALUED) + "\n"


VALUED = "parameters: {m: {positive: true, value: 1}, l: {positive: true, value: 1}}"

#: 1 + 3 = 2 + 2: links come in line, where 1 - 2 + 3 = 2, and in no other way.
CHANGE_POINT = four_bar("l", "2*l", "3*l", "2*l", "a: 1, b: 1, c: -2")
#: +-1 +-2 +-3 is never 9/4.
NO_CHANGE_POINT = CHANGE_POINT.replace("{body: 0, point: [2*l", "{body: 0, point: [9*l/4")
#: All of one length: +1 +1 -1, +1 -1 +1, -1 +1 +1.
EQUAL = four_bar("l", "l", "l", "l", "a: 1, b: -1, c: -2")

#: A point on a massless arm: M = diag(m r^2, m) is singular at r = 0, on r = a it is m (r^2 + 1).
SPIRAL = """
mbsym: 1
name: A spiral
parameters: {m: 1}
bodies:
  - {name: arm, attached to: 0, mass: 0, rotation: {axes: [3], angles: [a]}}
  - {name: point, attached to: arm, mass: m, connection point: [r, 0, 0], coordinates: [r]}
constraints:
  - relation: r = a
initial: {r: 1, a: {position: 1, velocity: 1}}
"""


def begun(text: str) -> Scenario:
    system = system_of(text)
    return closed(scenario(system)).scenario


def found_in(text: str) -> SingularPositions:
    found = singular_positions(begun(text), [1.0, 1.0, 1.0], 20.0)
    assert found is not None
    return found


def test_a_change_point_is_found_and_proved() -> None:
    found = found_in(CHANGE_POINT)
    (one,) = found.found
    assert one.proved
    assert not one.family
    assert (one.rank, one.usual) == (1, 2)
    assert dict(one.labels) == {"a": "0", "b": "pi", "c": "pi"}


def test_links_of_one_length_come_in_line_in_three_ways() -> None:
    found = found_in(EQUAL)
    ways = {tuple(one.labels[name] for name in "abc") for one in found.found}
    # Absolute angles (0, 0, pi), (0, pi, 0), (pi, 0, 0), told as relative ones in (-pi, pi].
    assert ways == {("0", "0", "pi"), ("0", "pi", "pi"), ("pi", "pi", "0")}
    assert all(one.proved for one in found.found)


def test_where_links_cannot_come_in_line_nothing_is_found_nor_proved_absent() -> None:
    found = found_in(NO_CHANGE_POINT)
    assert not found.found
    assert found.starts > 50
    told = " ".join(lost_rank(found))
    assert "No position in which constraints lose their rank was found" in told
    assert "no proof that there are none" in told


def test_a_nearly_singular_position_is_not_called_one() -> None:
    """Links that miss a line by a ten-thousandth: J is nearly singular, and is not."""
    assert not found_in(CHANGE_POINT.replace("{body: 0, point: [2*l", "{body: 0, point: [2*l + l/10000")).found


def test_irrational_positions_are_told_as_floats_and_not_as_proved() -> None:
    """The same loop turned by 1 rad: no angle is a quarter turn."""
    turned = CHANGE_POINT.replace("point: [2*l, 0, 0]}]", "point: [2*l*cos(1), 2*l*sin(1), 0]}]")
    (one,) = found_in(turned).found
    assert not one.proved
    assert one.place["a"] == pytest.approx(1, abs=1e-7)
    assert abs(one.place["b"]) == pytest.approx(pi, abs=1e-7)


def test_rungs_close_their_loops_anew() -> None:
    given = begun(CHANGE_POINT)
    left_out: list[str] = []
    longer = scaled(given, {}, "l", Fraction(1000))
    ladder = Ladder(RATIO, "l", (Probe(1e3, longer, given.state),))
    led = on_constraints(ladder, left_out)
    assert led is not None
    assert not left_out
    known = Dynamics(longer).constraints
    assert known is not None
    state = [float(x) for x in led.probes[0].state]
    assert np.max(np.abs(known.at(0.0, state).positions)) < 1e-9
    assert np.max(np.abs(known.at(0.0, state).velocities)) < 1e-9
    # A planted rung whose loop cannot be closed is left out and told.
    system = system_of(CHANGE_POINT.replace("{body: 0, point: [2*l", "{body: 0, point: [20*l"))
    open_ = scenario(system)
    assert on_constraints(Ladder(RATIO, "l", (Probe(10.0, open_, open_.state),)), left_out) is None
    assert left_out == ["l times 1e+01: no state of the constraints was found there"]


def test_a_singular_matrix_of_the_tree_is_held_against_what_constraints_allow() -> None:
    given = begun(SPIRAL)
    found = extremes(given, ring_of(given.system), {}, 6.0)
    assert found.positive == (True,)
    told = " ".join(sentences(found))
    assert "singular where r = 0, whatever else is: on what the constraints allow it is positive there" in told
    # With r = 0 as the constraint the arm turns without any mass.
    free = begun(SPIRAL.replace("r = a", "r = 0").replace("r: 1, a", "r: 0, a"))
    assert extremes(free, ring_of(free.system), {}, 6.0).positive == (False,)


def test_accelerations_are_those_with_constraints(tmp_path: Path) -> None:
    file = filed(tmp_path / "s.yaml", EQUAL)
    result = invoked("extremes", file, "--budget", "20", "--out", tmp_path, "--quiet", code=0)
    assert "proved by rational arithmetic" in result.stdout
    whole = json.loads((tmp_path / "extremes.json").read_text(encoding="utf-8"))
    jsonschema.validate(whole, schema("extremes"))
    assert len(whole["singular_positions"]["found"]) == 3
    # Towards a position in which rows become dependent, of a tree's accelerations nothing would be lost.
    near = [r for r in whole["rows"] if r["subject"].startswith("distance from a") and r["quantity"] == "accelerations"]
    assert near
    assert min(r["digits"]["float32"] for r in near) < 3
    refused = invoked("extremes", file, "--sequences", code=2)
    assert "sequences are ranked without constraints" in refused.stderr
