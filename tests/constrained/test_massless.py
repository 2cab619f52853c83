"""Mass matrices that are singular everywhere, and positive on what constraints allow."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import filed, invoked, system_of

import mbsym
from mbsym.mechanics.constraints import dynamics as equations
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import compiled_kernel
from mbsym.numerics.scenario import scenario
from mbsym.report.targets import FORMATS
from mbsym.simulation import Request, Simulation, simulate

#: A bob at the end of an arm without mass: no inertia belongs to q.
ARM = """
mbsym: 1
name: A bob on a massless arm
parameters: {m: 2, g: 9.81, l: 0.7}
bodies:
  - {name: bob, attached to: 0, mass: m, connection point: [x, y, 0], coordinates: [x, y]}
  - {name: arm, attached to: 0, mass: 0, rotation: {axes: [3], angles: [q]}}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
constraints:
  - coincide: [{body: bob, point: [0, 0, 0]}, {body: arm, point: [0, -l, 0]}]
initial: {x: 0.7*3/5, y: -0.7*4/5, q: 0.6435011087932844}
"""

PENDULUM = """
mbsym: 1
name: Pendulum
parameters: {m: 2, g: 9.81, l: 0.7}
bodies:
  - {name: bob, attached to: 0, mass: m, rotation: {axes: [3], angles: [q]}, mass centre: [0, -l, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
initial: {q: 0.6435011087932844}
"""

#: One point at u + v: M = m ((1, 1), (1, 1)) has no pivot that is zero at sight.
SUM = """
mbsym: 1
name: A sum
parameters: {m: 3, g: 9}
bodies:
  - {name: base, attached to: 0, mass: 0, connection point: [u, 0, 0], coordinates: [u]}
  - {name: point, attached to: base, mass: m, connection point: [v, 0, 0], coordinates: [v]}
loads:
  - uniform gravity: {acceleration: g, direction: [1, 0, 0]}
constraints:
  - relation: u = 2*v
initial: {u: 0, v: 0}
"""


def run(text: str, time: float, **how: Any) -> Simulation:
    system = system_of(text)
    return simulate(scenario(system), Request(time=time, samples=41, estimate=False, **how))


@pytest.mark.parametrize(
    "how", [{"tolerance": 1e-11}, {"method": "radau", "tolerance": 1e-9}, {"method": "rodas5p", "tolerance": 1e-9}]
)
def test_a_bob_on_a_massless_arm_is_a_pendulum(how: dict[str, Any]) -> None:
    found, truth = run(ARM, 4.0, **how), run(PENDULUM, 4.0, tolerance=1e-12)
    assert found.whole
    assert found["q"] == pytest.approx(truth["q"], abs=1e-6)
    assert found["x"] == pytest.approx(0.7 * np.sin(truth["q"]), abs=1e-6)
    assert found.drift is not None
    assert max(found.drift.largest) < 1e-13


def test_a_matrix_without_a_zero_pivot_is_seen_to_be_singular() -> None:
    """u + v = g t^2/2 and u = 2 v."""
    found = run(SUM, 2.0, tolerance=1e-11)
    assert found["v"] == pytest.approx(1.5 * found.times**2, abs=1e-9)
    assert found["u"] == pytest.approx(3.0 * found.times**2, abs=1e-9)


@pytest.mark.parametrize("text", [SUM.replace("u = 2*v", "u + v = 0"), ARM.replace("l, 0]}]", "l*0, 0]}]")])
def test_what_stays_without_mass_is_refused(text: str, tmp_path: Path) -> None:
    """u - v, or the arm about a bob on its axis, moves no mass and no constraint holds it."""
    file = filed(tmp_path / "s.yaml", text)
    words = ["simulate", str(file), "--time", "1", "--out", str(tmp_path / "out")]
    result = invoked(*words)
    assert result.exit_code in (2, 3), result.output
    assert "singular" in result.output + result.stderr


def _rod_force(text: str) -> Any:
    """What the rod does to the bob at the start: lambda, as J is the identity in x and y."""
    system = system_of(text)
    given = closed(scenario(system)).scenario
    point = np.array([0.0, *map(float, given.state)])
    return compiled_kernel(Dynamics(given), "multipliers")(point)


def test_the_force_of_the_rod_is_the_pendulum_s(monkeypatch: pytest.MonkeyPatch) -> None:
    """T = m (g cos q + l q'^2) towards the pivot; without its part of the force the added matrix would change that."""
    text = ARM.replace("q: 0.6435011087932844}", "q: {position: 0.6435011087932844, velocity: 2}}")
    tension = 2 * (9.81 * 0.8 + 0.7 * 4)
    truth = [-0.6 * tension, 0.8 * tension]
    assert _rod_force(text) == pytest.approx(truth, abs=1e-9)
    right = equations._added

    def forgotten(scene: Any, rows: Any, masses: Any, forces: Any) -> Any:
        return right(scene, rows, masses, forces)[0], list(forces)

    monkeypatch.setattr(equations, "_added", forgotten)
    assert np.max(np.abs(_rod_force(text) - truth)) > 0.1


def test_links_in_line() -> None:
    """Two links of length 1 without mass, b = a, a particle m at the end (``light-links-in-line``): M is singular in
    line, where nothing moves the particle along them, and the system is not,

        T = m (5 + 4 cos a) a'^2/2,      U = m g (cos a + cos 2a),      Q = 6:       18 a'' = 6 at a = 0, m = 2.
    """
    text = (Path(__file__).parents[1] / "cases" / "constraints" / "light-links-in-line.yaml").read_text(
        encoding="utf-8"
    )
    model: dict[str, Any] = {}
    exec(FORMATS["python"].render(mbsym.loads(text, (3,)), ()), model)
    rates = model["rhs"](0.0, np.zeros(4), model["complete"]())[2:]
    assert rates == pytest.approx([1 / 3, 1 / 3], abs=1e-12)
    for start in ("a: 0, b: 0", "a: -0.5, b: -0.5"):  # begins there, or passes it
        found = run(text.replace("a: 0, b: 0", start), 3.0)
        assert found.whole
        a, rate = found["a"], found["a_dot"]
        energy = (5 + 4 * np.cos(a)) * rate**2 - 18 * (np.cos(a) + np.cos(2 * a)) - 6 * a
        assert energy == pytest.approx(np.full(41, energy[0]), abs=1e-8)
        assert np.max(a) > 0.1
