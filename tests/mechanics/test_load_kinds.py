"""What a load says of itself (``mbsym.model.loads``) against what it does to a motion (``mbsym.mechanics.loads``).

Each kind acts alone on a cart that slides and an arm that turns on it.
"""

from __future__ import annotations

import json
from collections import Counter
from typing import Any, get_args

import pytest

import mbsym
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.tree import ZERO
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import KINDS, generalized_forces
from mbsym.mechanics.variables import expressions, ring_environment, ring_of
from mbsym.model import loads as model

ENDS = [{"body": "arm", "point": [0, "l", 0]}, {"body": "cart", "point": ["b", 1, 0]}]
LOADS: dict[type, Any] = {
    model.NewtonianGravity: {"newtonian gravity": {"constant": "nu", "centre": 0, "about": "station"}},
    model.UniformGravity: {"uniform gravity": {"vector": [0, "-g", 0]}},
    model.CoordinateSpring: {"spring": {"coordinate": "x", "stiffness": "k", "rest": "b"}},
    model.PointSpring: {"spring": {"between": ENDS, "stiffness": "k", "length": "l"}},
    model.CoordinateDamper: {"damper": {"coordinate": "q", "coefficient": "c"}},
    model.PointDamper: {"damper": {"between": ENDS, "coefficient": "c"}},
    model.IsotropicDamper: {"isotropic damper": {"between": ENDS, "coefficient": "c"}},
    model.ForceFunction: {"potential": "k*x**2*q"},
    model.Rayleigh: {"rayleigh": "c*(x_dot - b*q_dot)**2/2"},
    model.GeneralizedForce: {"generalized force": {"x": "g*q", "q": "k*x"}},
    model.PointForce: {"force": ENDS[0] | {"components": ["g", "k", 0], "axes": "arm"}},
    model.Torque: {"torque": {"body": "arm", "components": [0, 0, "k"], "axes": "cart", "reaction on": "cart"}},
}
BODIES = [
    {"name": "station", "attached to": 0, "connection point": ["R", 0, 0], "mass": 0},
    {"name": "cart", "attached to": "station", "connection point": ["x", 0, 0], "mass": "m", "coordinates": ["x"]},
    {
        "name": "arm",
        "attached to": "cart",
        "rotation": {"axes": [3], "angles": ["q"]},
        "mass centre": [0, "l", 0],
        "mass": "m",
        "coordinates": ["q"],
    },
]
POSITIVE = ["m", "l", "b", "c", "k", "g", "R", "nu"]
every_kind = pytest.mark.parametrize("kind", LOADS, ids=lambda kind: kind.__name__)


def alone(kind: type) -> tuple[Any, Scene, Ring]:
    text = {"mbsym": 1, "name": "one load", "parameters": dict.fromkeys(POSITIVE, "positive")}
    system = mbsym.loads(json.dumps(text | {"bodies": BODIES, "loads": [LOADS[kind]]}), ()).system
    (load,) = system.loads
    assert type(load) is kind
    ring = ring_of(system)
    return load, Scene(system, ring, ring_environment(system, ring), ring), ring


def power(forces: dict[str, Polynomial], ring: Ring) -> Polynomial:
    return ring.reduce(sum((f * ring.generator("velocity", name) for name, f in forces.items()), ring.zero))


def check_conservative(kind: type) -> None:
    """Q = dU/dq where there is a U: wrenches through partial velocities against the derivative."""
    load, scene, ring = alone(kind)
    function = KINDS[kind].force_function
    assert load.conservative == (function is not None)
    if function is not None:
        value = function(load, scene)
        for name, force in generalized_forces(scene, [load]).items():
            assert ring.is_zero(force - ring.derivative(value, name)) is True


def check_reach(kind: type) -> None:
    """The bodies and coordinates on which it says that it acts are those on which it does."""
    load, scene, _ = alone(kind)
    action = KINDS[kind].action(load, scene)
    touched = {wrench.body for wrench in action.wrenches}
    if load.bodies is None:
        assert touched == {"cart", "arm"}
    else:
        assert touched <= {*load.bodies}
        assert bool(touched) == bool(load.bodies)
    if load.coordinates or action.generalized:
        given_by_formula = load.dissipation_function is not None or kind is model.ForceFunction
        assert given_by_formula or {*action.generalized} == {*load.coordinates}
    assert load.link is None or {*load.link[:2]} <= {*load.bodies}
    assert {point.body for point in load.points} <= {*(load.bodies or ())}


def check_losses(kind: type) -> None:
    """c of a load that takes c (rate)^2; R of one that takes 2 R, where R is quadratic."""
    load, scene, ring = alone(kind)
    lost = -power(generalized_forces(scene, [load]), ring)
    if load.damping is not None:
        c = ring.index("parameter", "c")
        assert scene.lower(load.damping) == ring.generator("parameter", "c")
        assert not lost.is_zero()
        assert ring.substitute(lost, {c: ring.zero}).is_zero()
        fast = {ring.index("velocity", x): 2 * ring.generator("velocity", x) for x in ("x", "q")}
        assert ring.is_zero(ring.substitute(lost, fast) - 4 * lost) is True
        still = {ring.index("sine", "q"): ring.zero, ring.index("cosine", "q"): ring.one}
        at_rest = ring.substitute(lost, still | {ring.index("velocity", "x"): ring.zero})
        numbers = {ring.index("parameter", x): ring.number(k) for k, x in enumerate(POSITIVE, 2)}
        numbers |= {ring.index("velocity", "q"): ring.one}
        assert ring.reduce(ring.substitute(at_rest, numbers)).leading_coefficient() > 0
    if load.dissipation_function is not None:
        assert ring.is_zero(lost - 2 * scene.lower(load.dissipation_function)) is True


def check_linear(kind: type) -> None:
    load, scene, ring = alone(kind)
    moving = ("x", "q", "x_dot", "q_dot")
    forces = generalized_forces(scene, [load])
    if load.linear:
        assert not any(ring.dependencies(ring.derivative(f, x), moving) for f in forces.values() for x in moving)
    if load.rest_position is not None:
        name, value = load.rest_position
        there = {ring.index("coordinate", name): scene.lower(value)}
        assert all(ring.substitute(f, there).is_zero() for f in forces.values())
    if load.along_line:  # a motion of the whole that keeps the distance: none here but x, which moves both ends
        assert ring.is_zero(forces["x"]) is True


CHECKS = [check_conservative, check_reach, check_losses, check_linear]


@every_kind
@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__.removeprefix("check_"))
def test_what_it_says_is_what_it_does(kind: type, check: Any) -> None:
    check(kind)


def test_every_kind_is_in_the_table() -> None:
    assert {*KINDS} == {*get_args(model.Load)} == {*LOADS}


@every_kind
def test_every_formula_is_measured_once(kind: type) -> None:
    load, _, _ = alone(kind)
    points = Counter(x for point in load.points for x in point.position)
    assert Counter(one.formula for one in load.measured()) == Counter(expressions(load)) - points


def test_what_is_left_where_coordinates_are_held() -> None:
    forces, _, _ = alone(model.GeneralizedForce)
    assert forces.without({"x"}).coordinates == ("q",)
    assert forces.without({"x", "q"}) is None
    for kind, held in ((model.CoordinateSpring, "x"), (model.CoordinateDamper, "q")):
        load, _, _ = alone(kind)
        assert load.without({held}) is None
        assert load.without({"x", "q"} - {held}) is load
    for kind in (model.PointSpring, model.Rayleigh, model.Torque, model.UniformGravity):
        load, _, _ = alone(kind)
        assert load.without({"x", "q"}) is load


def test_zero_forces_are_left_out() -> None:
    forces = model.GeneralizedForce((("x", ZERO), ("q", ZERO)))
    assert forces.simplified() is None
    assert model.Torque("arm", (ZERO, ZERO, ZERO), "arm").simplified() is None
    for kind in LOADS:
        load, _, _ = alone(kind)
        assert load.simplified() == load


LIES = [
    (model.Torque, "conservative", True, check_conservative),
    (model.UniformGravity, "conservative", False, check_conservative),
    (model.PointDamper, "bodies", ("arm",), check_reach),
    (model.UniformGravity, "bodies", (), check_reach),
    (model.CoordinateDamper, "coordinates", ("x",), check_reach),
    (model.PointForce, "damping", ZERO, check_losses),
    (model.PointSpring, "linear", True, check_linear),
    (model.CoordinateSpring, "rest_position", ("x", ZERO), check_linear),
]


@pytest.mark.parametrize(("kind", "fact", "lie", "check"), LIES, ids=lambda x: getattr(x, "__name__", None))
def test_a_planted_lie_is_found(monkeypatch: pytest.MonkeyPatch, kind: type, fact: str, lie: Any, check: Any) -> None:
    monkeypatch.setattr(kind, fact, lie)
    with pytest.raises(AssertionError):
        check(kind)
