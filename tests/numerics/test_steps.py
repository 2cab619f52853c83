"""Steps, rows and restarts of every method: dense output against a closed-form motion, and against each other."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from conftest import OWN, SHIPPED
from numerics.test_methods import POLE, dynamics_of, ellipse, orders, start

import mbsym
from mbsym.expressions.tree import number
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import EXTENDED, FLOAT32, FLOAT64
from mbsym.numerics.methods.interface import Breakdown, Cause, Piece, Setting
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.planning.reduced import reduced
from mbsym.numerics.scenario import scenario
from mbsym.numerics.separable import completing

NAMES = list(METHODS)
COMPILED = ["rk4", "rk45", "dop853"]


@pytest.fixture(scope="module")
def kepler() -> Dynamics:
    return dynamics_of(OWN / "kepler.yaml")


@pytest.fixture(scope="module")
def pendulum() -> Dynamics:
    return dynamics_of(SHIPPED / "double-pendulum.yaml")


def setting(name: str, step: float = 0.01, tolerance: float = 1e-8) -> dict[str, float]:
    return {"step": step} if METHODS[name].traits.fixed else {"tolerance": tolerance}


def on_the_ellipse(times: Any) -> Any:
    return np.array([ellipse(float(t)) for t in times]).T


def pieces(run: Any, until: float) -> list[Piece]:
    found = []
    while run.time < until:
        found.append(run.step())
    return found


@pytest.mark.parametrize("name", NAMES)
def test_pieces_follow_each_other_and_the_motion(name: str, kepler: Dynamics) -> None:
    run = start(name, kepler, **setting(name))
    found = pieces(run, 3.0)
    assert found[0].start == 0
    assert np.array_equal(found[0](0.0), [float(x) for x in kepler.scenario.state])
    for before, after in itertools.pairwise(found):
        assert before.end == after.start
        assert np.abs(before(before.end) - after(after.start)).max() < 1e-12
    at_ends = max(float(np.abs(piece(piece.end) - ellipse(piece.end)).max()) for piece in found)
    worst = 0.0
    for piece in found:
        times = np.linspace(piece.start, piece.end, 9)
        worst = max(worst, float(np.abs(piece(times) - on_the_ellipse(times)).max()))
    # Dense output of orders 4 (rk45, rodas5p) and 3 (radau) is coarser than the steps.
    assert worst < 5 * at_ends + {"rk45": 1e-6, "scipy-rk45": 1e-6, "radau": 1e-8, "rodas5p": 1e-8}.get(name, 1e-12)
    assert run.time == found[-1].end
    assert np.abs(run.state - found[-1](run.time)).max() < 1e-14


@pytest.mark.parametrize("name", NAMES)
def test_rows_are_the_dense_output_of_the_same_steps(name: str, kepler: Dynamics) -> None:
    """The same steps however they are asked for, and the same numbers: rows, single times and pieces."""
    times = np.linspace(0, 3, 1201)
    rows = start(name, kepler, **setting(name, step=0.0125))
    filled = rows.fill(times)
    assert filled.shape == (4, 1201)
    assert rows.time == 3
    assert np.array_equal(rows.state, filled[:, -1])
    one_by_one = start(name, kepler, **setting(name, step=0.0125))
    single = np.array([one_by_one.advance(float(t)) for t in times]).T
    same = name in COMPILED
    assert np.array_equal(single, filled) if same else np.allclose(single, filled, rtol=0, atol=1e-13)
    chunks = start(name, kepler, **setting(name, step=0.0125))
    parts = np.hstack([chunks.fill(part) for part in np.array_split(times, 7)])
    assert np.array_equal(parts, filled) if same else np.allclose(parts, filled, rtol=0, atol=1e-13)
    stepping = start(name, kepler, **setting(name, step=0.0125))
    for piece in pieces(stepping, 3.0):
        inside = (times >= piece.start) & (times <= piece.end)
        assert np.allclose(piece(times[inside]), filled[:, inside], rtol=0, atol=1e-13)
    assert np.abs(filled - on_the_ellipse(times)).max() < 2e-2 * (name == "midpoint") + 1e-4


#: Orders of dense output: that of the method, or of the polynomial (q to 6, q' to 5) where that is less.
FIXED = {"rk4": 4, "midpoint": 2, "midpoint4": 4, "midpoint6": 5}


@pytest.mark.parametrize("name", FIXED)
def test_orders_between_steps_of_one_length(name: str, kepler: Dynamics) -> None:
    steps = [0.1, 0.05, 0.025] if name == "midpoint6" else [0.05, 0.025, 0.0125]
    errors = []
    for h in steps:
        run = start(name, kepler, step=h)
        times = (np.arange(round(2 / h)) + 0.37) * h
        errors.append(float(np.abs(run.fill(times) - on_the_ellipse(times)).max()))
    assert orders(steps, errors) > FIXED[name] - 0.35


@pytest.mark.parametrize("scalar", [FLOAT64, EXTENDED])
def test_the_polynomial_between_steps_has_its_order(scalar: str, kepler: Dynamics) -> None:
    """One step of midpoint6, from exact states: what is left is the polynomial's own error, h^6 in q, h^5 in q'."""
    steps, places, speeds = [0.4, 0.2, 0.1], [], []
    for h in steps:
        run = start("midpoint6", kepler, scalar, step=h / 64)
        ends = [ellipse(1.0), ellipse(1.0 + h)]
        run.restart(1.0, ends[0])
        kept = np.concatenate((run.x, run.carry))
        other = start("midpoint6", kepler, scalar, step=h / 64)
        other.restart(1.0 + h, ends[1])
        curve = run._between(
            np.array([1.0, 1.0 + h]), np.column_stack((kept, np.concatenate((other.x, other.carry)))), [0], [1]
        )
        times = 1.0 + h * np.linspace(0.1, 0.9, 9)
        error = np.abs(curve(times) - on_the_ellipse(times)).max(axis=1)
        places.append(float(error[:2].max()))
        speeds.append(float(error[2:].max()))
    assert orders(steps, places) == pytest.approx(6, abs=0.4)
    assert orders(steps, speeds) == pytest.approx(5, abs=0.4)


def test_a_wrong_term_is_seen(kepler: Dynamics, monkeypatch: pytest.MonkeyPatch) -> None:
    """The negative control of the orders: without its last term the polynomial loses an order and more."""
    from mbsym.numerics.methods import symplectic

    right = symplectic.hermite

    def wrong(*arguments: Any) -> Any:
        found = right(*arguments)
        found[3] = 0
        return found

    monkeypatch.setattr(symplectic, "hermite", wrong)
    errors = []
    for h in (0.1, 0.05, 0.025):
        times = (np.arange(round(2 / h)) + 0.37) * h
        run = start("midpoint6", kepler, step=h)
        errors.append(float(np.abs(run.fill(times) - on_the_ellipse(times)).max()))
    assert orders([0.1, 0.05, 0.025], errors) < 4.5


@pytest.mark.parametrize("scalar", [FLOAT64, EXTENDED, FLOAT32])
@pytest.mark.parametrize("name", [*COMPILED, "midpoint4", "taylor"])
def test_rows_in_every_arithmetic(name: str, scalar: str, kepler: Dynamics) -> None:
    if scalar not in METHODS[name].traits.scalars:
        pytest.skip(f"{name} does not run in {scalar}")
    times = np.linspace(0, 2, 333)
    run = start(name, kepler, scalar, **setting(name, step=0.004, tolerance=1e-6))
    found = run.fill(times)
    assert found.dtype == np.asarray(run.state).dtype
    assert np.abs(found - on_the_ellipse(times)).max() < 2e-4
    many = [run.step() for _ in range(3)]
    assert all(piece(piece.end).dtype == found.dtype for piece in many)


@pytest.mark.parametrize("name", NAMES)
def test_a_step_ends_where_it_is_told(name: str, kepler: Dynamics) -> None:
    run = start(name, kepler, **setting(name))
    for target in (0.0123, 0.5, 0.50001, 2.0):
        while run.time < target:
            piece = run.step(target)
            assert piece.end <= target
        assert run.time == target
        assert np.abs(run.state - ellipse(target)).max() < 2e-3 * (name == "midpoint") + 3e-5
    with pytest.raises(ValueError, match="a step to"):
        run.step(2.0)
    run.advance(2.0 + 1e-4)  # the step goes beyond, and is shown up to where it is asked for
    piece = run.step(2.0 + 2e-4)
    assert (piece.start, piece.end) == (2.0 + 1e-4, 2.0 + 2e-4)
    with pytest.raises(ValueError, match="beyond the piece"):
        piece(2.1)


#: x'' = -1/2 sqrt(1 - t), which has no value after t = 1.
ENDING = POLE.replace("2*x**3", "-x*sqrt(1 - t)/2")


@pytest.mark.parametrize(
    "name", ["rk4", "rk45", "dop853", "midpoint", "scipy-dop853", "scipy-rk45", "radau", "rodas5p", "bdf"]
)
def test_nothing_is_looked_at_beyond(name: str) -> None:
    """x'' = -sqrt(1 - t)/2 from x = 1, x' = 2 has x'(1) = 2 - 1/3; beyond t = 1 there is no value."""
    dynamics = dynamics_of(ENDING)
    run = start(name, dynamics, **setting(name, step=0.03))
    while run.time < 1:
        run.step(1.0)
    assert run.state[1] == pytest.approx(2 - 1 / 3, abs=1e-3)
    with pytest.raises(Breakdown):
        pieces(run, 2.0)


@pytest.mark.parametrize("name", NAMES)
def test_a_run_may_begin_anywhere(name: str, kepler: Dynamics) -> None:
    """From the ellipse at t = 1; restarted there, it makes the very same steps."""
    times = np.linspace(1, 2, 51)
    if METHODS[name].traits.extra is not None:
        pytest.importorskip(str(METHODS[name].traits.extra))
    begun = METHODS[name].start(kepler, Setting(**setting(name)), initial=ellipse(1.0), at=1.0)
    assert begun.time == 1
    first = begun.fill(times)
    assert np.abs(first - on_the_ellipse(times)).max() < 2e-3 * (name == "midpoint") + 3e-5
    used = start(name, kepler, **setting(name))
    used.advance(1.7)
    spent = used.work.steps
    used.restart(1.0, ellipse(1.0))
    assert np.array_equal(used.state, ellipse(1.0))
    assert np.allclose(used.fill(times), first, rtol=0, atol=1e-13)
    assert used.work.steps > spent


@pytest.mark.parametrize("name", NAMES)
def test_a_breakdown_keeps_the_rows_so_far(name: str, pendulum: Dynamics) -> None:
    run = start(name, pendulum, step_limit=50, **setting(name, step=1e-3, tolerance=1e-9))
    times = np.linspace(0, 100, 200_001)
    with pytest.raises(Breakdown) as failed:
        run.fill(times)
    assert failed.value.kind == Cause.STEP_LIMIT
    kept = failed.value.filled
    count = kept.shape[1]
    assert times[count - 1] <= failed.value.time < times[count] + 1e-12
    again = start(name, pendulum, step_limit=60, **setting(name, step=1e-3, tolerance=1e-9))
    assert np.allclose(again.fill(times[:count]), kept, rtol=0, atol=1e-13)


@pytest.mark.parametrize("name", NAMES)
def test_planar_motion_of_a_spatial_system_by_steps(name: str) -> None:
    """What rests is put back into pieces, rows and breakdowns; a state that moves it is refused."""
    plane = {name: number(0) for name in ("psi", "phi", "sigma", "psi_dot", "phi_dot", "sigma_dot")}
    dynamics = Dynamics(scenario(mbsym.load(SHIPPED / "satellite.yaml").system, plane))
    taken = reduced(dynamics)
    assert taken is not None
    assert taken.proved
    if METHODS[name].traits.extra is not None:
        pytest.importorskip(str(METHODS[name].traits.extra))
    options = Setting(**setting(name, step=0.05, tolerance=1e-9))
    run = completing(taken, METHODS[name]).start(dynamics, options)
    whole = METHODS[name].start(dynamics, options)
    times = np.linspace(0, 2, 21)
    rows = run.fill(times)
    assert np.allclose(rows, whole.fill(times), rtol=0, atol=1e-5)
    held = [place for place, x in enumerate(dynamics.inputs[1:]) if x in plane]
    assert len(held) == 6
    assert not np.any(rows[held])
    piece = run.step()
    assert piece(piece.end) == pytest.approx(run.state, abs=1e-14)
    assert piece(np.array([piece.start, piece.end])).shape == (len(rows), 2)
    run.restart(0.0, rows[:, 0])
    assert np.allclose(run.fill(times), rows, rtol=0, atol=1e-13)
    moved = rows[:, 0].copy()
    moved[held[0]] = 1e-3
    with pytest.raises(ValueError, match="moves what was taken out"):
        run.restart(0.0, moved)
    few = completing(taken, METHODS[name]).start(dynamics, replace(options, step_limit=5))
    with pytest.raises(Breakdown) as failed:
        few.fill(np.linspace(0, 1000, 20_001))
    assert len(failed.value.filled) == len(failed.value.state) == len(rows)


@pytest.mark.parametrize("name", ["taylor", "dop853", "rk45"])
def test_a_system_at_rest_steps_on(name: str) -> None:
    """Nothing moves, so that no error bounds a step: it has an end all the same."""
    text = "mbsym: 1\nname: rest\nbodies:\n  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, "
    text += "coordinates: [x]}\nloads:\n  - spring: {coordinate: x, stiffness: 3}\ninitial: {x: 0}\n"
    run = METHODS[name].start(Dynamics(scenario(mbsym.loads(text).system)), Setting(1e-10))
    for _ in range(3):
        piece = run.step()
        assert piece.end > piece.start
        assert np.all(np.isfinite(piece(np.linspace(piece.start, piece.end, 5))))
        assert not np.any(piece(piece.end))
    assert not np.any(run.fill(np.array([float(run.time) + 1, float(run.time) + 2000.0])))
