"""Parts that know nothing of each other: what is a part, and that separate runs are the joint one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED, dynamics_of

import mbsym
from mbsym.numerics import separable
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.methods.interface import Breakdown, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.scenario import scenario
from mbsym.numerics.separable import Separate, separated

#: A slow oscillator, a pendulum, and a fast oscillator on lines of their own.
THREE = """
mbsym: 1
name: three
bodies:
  - {name: a, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
  - {name: b, attached to: 0, connection point: [0, y, 0], mass: 2, coordinates: [y]}
  - {name: c, attached to: 0, connection point: [0, 0, z], mass: 1, coordinates: [z]}
loads:
  - potential: x**2/2 + 1 - cos(y) + 10000*z**2/2
initial: {x: 1, y: {position: 0, velocity: 1}, z: 1}
"""
#: z pulls at y, and y at z.
LINKED = THREE.replace("10000*z**2/2", "10000*z**2/2 + y*z")
#: z pulls at nothing, but y's frame carries it: M has the block.
CARRIED = THREE.replace("{name: c, attached to: 0,", "{name: c, attached to: b,").replace("[0, 0, z]", "[0, z, 0]")
#: a drives itself to a singularity: x = 1/(1 - t)^2.
BLOW_UP = THREE.replace("x**2/2", "-2*x**3").replace("{x: 1,", "{x: {position: 1, velocity: 2},")


def parts_of(text: str) -> list[tuple[str, ...]]:
    return [part.names for part in separated(dynamics_of(text))]


def test_what_is_a_part() -> None:
    assert parts_of(THREE) == [("x",), ("y",), ("z",)]
    assert parts_of(LINKED) == [("x",), ("y", "z")]
    assert parts_of(CARRIED) == [("x",), ("y", "z")]


def test_numbers_decide() -> None:
    """With a spring constant of zero the link is none."""
    text = LINKED.replace("y*z", "k*y*z").replace("name: three", "name: three\nvalues: {k: 0}\nparameters: {k: real}")
    assert parts_of(text) == [("x",), ("y",), ("z",)]
    assert parts_of(text.replace("k: 0", "k: 1")) == [("x",), ("y", "z")]


@pytest.mark.parametrize("name", ["double-pendulum", "heavy-top", "satellite", "gyrostat"])
def test_mechanisms_are_one_part(name: str) -> None:
    dynamics = Dynamics(scenario(mbsym.load(SHIPPED / f"{name}.yaml").system))
    assert len(separated(dynamics)) == 1


def exact(times: Any) -> Any:
    """x and z; y by a run of its own."""
    return np.array([np.cos(times), np.cos(100 * times)])


@pytest.mark.parametrize("scalar", ["float64", "extended"])
def test_apart_is_as_together(scalar: str) -> None:
    dynamics = dynamics_of(THREE)
    parts = separated(dynamics)
    dop853 = METHODS["dop853"]
    apart = Separate(dynamics, parts, [dop853] * 3).start(dynamics, Setting(1e-12), scalar)
    together = dop853.start(dynamics, Setting(1e-12), scalar)
    times = np.linspace(0, 10, 101)
    first, second = apart.fill(times), together.fill(times)
    assert np.max(np.abs(first - second)) < 1e-8
    assert np.max(np.abs(first[[0, 2]] - exact(times))) < 1e-8
    # The slow ones do not pay for the fast one.
    assert apart.work.evaluations < together.work.evaluations * 1.2
    assert apart.time == together.time == 10


def test_steps_are_pieces_of_the_same_motion() -> None:
    dynamics = dynamics_of(THREE)
    method = Separate(dynamics, separated(dynamics), [METHODS["dop853"], METHODS["rk45"], METHODS["dop853"]])
    run, filled = method.start(dynamics, Setting(1e-10)), method.start(dynamics, Setting(1e-10))
    assert method.traits.name == "parts"
    assert "y: " in method.traits.title
    times, ends = np.linspace(0, 1, 57), []
    found = np.empty((6, len(times)))
    while run.time < 1:
        piece = run.step()
        ends.append(piece.end)
        inside = (times >= piece.start) & (times <= piece.end)
        found[:, inside] = piece(times[inside])
    assert np.all(np.diff(ends) > 0)
    assert np.max(np.abs(found - filled.fill(times))) < 1e-13
    # And on by filling, from within a step of the slow ones.
    more = np.linspace(run.time, 3, 9)
    assert np.max(np.abs(run.fill(more)[[0, 2]] - exact(more))) < 1e-6


def test_from_another_state() -> None:
    dynamics = dynamics_of(THREE)
    method = Separate(dynamics, separated(dynamics), [METHODS["dop853"]] * 3)
    state = np.array([0.5, 0, 0, 0, 0, 0])
    run = method.start(dynamics, Setting(1e-10), initial=state, at=2.0)
    assert abs(run.advance(3.0)[0] - 0.5 * np.cos(1)) < 1e-9
    run.step()
    run.restart(0.0, state)
    assert abs(run.advance(1.0)[0] - 0.5 * np.cos(1)) < 1e-9
    assert run.work.steps > 0


def test_one_that_ends_early_ends_all() -> None:
    dynamics = dynamics_of(BLOW_UP)
    method = Separate(dynamics, separated(dynamics), [METHODS["dop853"]] * 3)
    times = np.linspace(0, 2, 41)
    with pytest.raises(Breakdown) as caught:
        method.start(dynamics, Setting(1e-10)).fill(times)
    filled = caught.value.filled
    assert abs(caught.value.time - 1) < 1e-3
    assert filled.shape in ((6, 20), (6, 21))  # at t = 1 itself: infinite, or as good as that
    assert np.max(np.abs(filled[2, :20] - np.cos(100 * times[:20]))) < 1e-7
    with pytest.raises(ValueError, match="another scenario"):
        method.start(dynamics_of(THREE), Setting(1e-10))
    run = method.start(dynamics, Setting(1e-10))
    with pytest.raises(Breakdown) as caught:
        [run.step() for _ in range(10_000)]
    assert np.shape(caught.value.state) == (6,)  # it was that of the part alone


def test_a_link_that_is_overlooked_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: links through q'' are not read.  The run and the better one, which is not separated, then differ."""
    text = LINKED.replace("+ y*z", "+ y*z/10")
    honest = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 1.0)
    assert honest.whole
    monkeypatch.setattr(separable, "_linked", lambda dynamics: [{i} for i in range(dynamics.size)])
    run = mbsym.simulate(mbsym.loads(text), 10.0, estimate=True)
    assert "each part by itself" in run.chosen.method.traits.title
    assert run.error.largest > 1e-6  # type: ignore[union-attr]
