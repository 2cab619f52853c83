"""What robotics calls by name in generated code; its numbers are compared with d'Alembert's in ``test_exports``."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest
from conftest import SHIPPED

import mbsym
from mbsym.analysis import Analysis
from mbsym.report.code import named_dynamics
from mbsym.report.targets import FORMATS

#: A cart with a pendulum on it; its names are those that generated code likes for its own arrays.
CLASHING = """
mbsym: 1
name: Clashing names
parameters: {tau: 2, qdd: 3, efforts: 5, tau_x: 7}
inputs: {pose: force on the cart}
bodies:
  - {name: cart, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: tau + qdd}
  - {name: frame, attached to: cart, rotation: {axes: [3], angles: [gravity]}, mass centre: [0, -efforts, 0],
     mass: tau_x}
  - {name: tool/0, attached to: frame, connection point: [0, -2*efforts, 0], mass: 0}
loads:
  - uniform gravity: {vector: [0, -9.81, 0]}
  - generalized force: {x: pose - 4*x_dot}
  - spring: {coordinate: gravity, stiffness: 11}
"""


def module(analysis: Analysis) -> Any:
    made = ModuleType("generated")
    exec(str(FORMATS["python"].render(analysis, ())), made.__dict__)  # our own generated module
    return made


def test_names_that_generated_code_likes_for_itself() -> None:
    """By hand, m = 5, mu = 7, l = 5, s and c the sine and cosine of the angle b:

    (m + mu) x'' + mu l (c b'' - s b'^2) + 4 x' = Q_x,  mu l (c x'' + l b'') + mu g l s + 11 b = Q_b.
    """
    analysis = mbsym.loads(CLASHING, problems=())
    model = module(analysis)
    q, qd, qdd = np.array([0.3, 0.7]), np.array([0.2, -1.1]), np.array([1.3, 0.4])
    s, c, p = np.sin(0.7), np.cos(0.7), model.DEFAULTS
    inertia = np.array([12 * 1.3 + 35 * c * 0.4, 35 * (c * 1.3 + 5 * 0.4)])
    coriolis, gravity = np.array([-35 * s * 1.21, 0]), np.array([0, 35 * 9.81 * s])
    tau = inertia + coriolis + gravity + np.array([4 * 0.2, 11 * 0.7])
    assert model.inverse_dynamics(q, qd, qdd, p) == pytest.approx(tau, rel=1e-14)
    assert model.coriolis(q, qd, p) == pytest.approx(coriolis, rel=1e-14)
    assert model.gravity(q, p) == pytest.approx(gravity, rel=1e-14)
    assert model.forward_dynamics(q, qd, tau, p) == pytest.approx(qdd, rel=1e-13)
    assert model.FRAMES == ("cart", "frame", "tool/0")
    assert model.frame_pose("tool/0", q, p)[:3, 3] == pytest.approx([0.3 + 10 * s, -10 * c, 0], rel=1e-14)
    slopes = [[1, 10 * c], [0, 10 * s], [0, 0], [0, 0], [0, 0], [0, 1]]
    assert model.frame_jacobian("tool/0", q, p) == pytest.approx(np.array(slopes), rel=1e-14)
    with pytest.raises(ValueError, match="no frame tool: choose from cart, frame, tool/0"):
        model.frame_pose("tool", q, p)


def test_of_constrained_systems_it_is_about_the_open_tree() -> None:
    model = module(mbsym.load(SHIPPED / "four-bar.yaml", problems=()))
    n = len(model.COORDINATES)
    q, qd, qdd = np.random.default_rng(4).normal(size=(3, n))
    p = {name: 1.0 + k / 7 for k, name in enumerate(model.PARAMETERS)}
    wanted = model.mass_matrix(q, p) @ qdd - model.forcing(q, qd, p)
    assert model.inverse_dynamics(q, qd, qdd, p) == pytest.approx(wanted, rel=1e-12)


def test_forward_dynamics_keeps_the_constraints() -> None:
    """Against LAPACK's solution of (M, -J^T; J, 0) (q'', lambda) = (f + tau, -gamma); tau comes back but for J^T mu."""
    model = module(mbsym.load(SHIPPED / "four-bar.yaml", problems=()))
    n = len(model.COORDINATES)
    q, qd, tau = np.random.default_rng(8).normal(size=(3, n))
    p = {name: 1.0 + k / 7 for k, name in enumerate(model.PARAMETERS)}
    mass, slopes = model.mass_matrix(q, p), model.constraint_jacobian(q, p)
    rows = len(slopes)
    whole = np.block([[mass, -slopes.T], [slopes, np.zeros((rows, rows))]])
    right = np.concatenate([model.forcing(q, qd, p) + tau, -model.constraint_acceleration(q, qd, p)])
    found = model.forward_dynamics(q, qd, tau, p)
    assert found == pytest.approx(np.linalg.solve(whole, right)[:n], rel=1e-10)
    needed = model.inverse_dynamics(q, qd, found, p) - tau
    assert np.linalg.matrix_rank(np.vstack([slopes, needed]), tol=1e-9) == rows
    several = model.forward_dynamics(*np.stack([np.array([q, qd, tau])] * 2, axis=-1), p)
    assert several[:, 1] == pytest.approx(found, rel=1e-13)
    for kind in ("c", "casadi"):
        assert "forward_dynamics" in str(FORMATS[kind].render(mbsym.load(SHIPPED / "four-bar.yaml", problems=()), ()))


def test_frames_that_would_take_too_much_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """The end of the tree comes first, with 9 operations; the cart takes none, and 3 more are too many."""
    monkeypatch.setattr(named_dynamics, "MOST_OPERATIONS", 10)
    analysis = mbsym.loads(CLASHING.replace("Clashing", "Expensive"), problems=())
    text = str(FORMATS["python"].render(analysis, ()))
    assert "There are no poses of these, they would take too many operations: frame" in " ".join(text.split())
    assert module(analysis).FRAMES == ("cart", "tool/0")
    assert "too many operations: frame" in " ".join(str(FORMATS["casadi"].render(analysis, ())).split())


def test_what_moves_as_prescribed_makes_forces_of_inertia_at_rest() -> None:
    """A bead on a hoop that turns at Omega:  m R^2 theta'' - m R^2 Omega^2 sin cos + m g R sin + b theta' = 0.

    c does not vanish with theta', so that it is no C(q, q') q'; that is said.
    """
    analysis = mbsym.load(SHIPPED / "bead-on-hoop.yaml", problems=())
    model = module(analysis)
    at_rest = -0.1 * 0.3**2 * 8**2 * np.sin(0.7) * np.cos(0.7)
    assert model.coriolis([0.7], [0.0], model.DEFAULTS) == pytest.approx([at_rest], rel=1e-14)
    assert "where nothing moves as prescribed" in model.coriolis.__doc__
    header = str(FORMATS["c"].companions[0].render(analysis, ()))
    assert "C(q, q') q' where nothing moves as prescribed" in header
