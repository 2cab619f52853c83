"""Singular configurations: against sets worked out by hand, and against the compiled mass matrix on and off them."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction as F
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import system_of

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.tree import Number
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.extremes import singular as module
from mbsym.numerics.extremes.singular import CHART, MODEL, Singularities, singularities
from mbsym.numerics.kernels.llvm import kernel
from mbsym.numerics.scenario import Scenario, changed, scenario

ROOT = Path(__file__).parents[2]


def given_of(name: str, **values: F) -> Scenario:
    found = system_of(ROOT / "systems" / f"{name}.yaml")
    return scenario(found, {key: Number(value) for key, value in values.items()})


def found_in(given: Scenario) -> Singularities:
    return singularities(given, {name: F(10) for name in given.system.coordinates})


def text(name: str, parameters: str, bodies: str, initial: str) -> Scenario:
    head = f"mbsym: 1\nname: {name}\nparameters: {parameters}\nbodies:\n{bodies}\ninitial: {initial}\n"
    return scenario(mbsym.loads(head).system)


def values(found: Singularities) -> dict[str, set[str]]:
    """Names and labels of all sets."""
    return {", ".join(one.names): {value.label for value in one.values} for one in found.sets}


#: By hand: det M of each is a positive number times the squares of what vanishes there.
KNOWN: dict[str, dict[str, set[str]]] = {
    "double-pendulum": {},  # m1 m2 ... + m2^2 sin^2, never 0
    "simple-pendulum": {},
    "cart-pendulum": {},
    "ziegler": {},
    "spatial-arm": {},
    "tethered-satellites": {},
    "spherical-pendulum": {"theta": {"0", "pi"}},  # m^2 l^4 sin^2(theta)
    "spring-pendulum": {"r": {"0"}},  # m^2 r^2
    "gyrostat": {"theta": {"0", "pi"}},  # 3-1-3
    "heavy-top": {"beta": {"pi/2", "-pi/2"}},  # 1-2-3
    "gravity-gradient": {"theta": {"pi/2", "-pi/2"}},
    "orbital-gyrostat": {"theta": {"pi/2", "-pi/2"}},
    "satellite": {"theta": {"pi/2", "-pi/2"}, "sigma": {"pi/2", "-pi/2"}},
}


@pytest.mark.parametrize("name", KNOWN)
def test_sets_that_are_known_by_hand(name: str) -> None:
    orbit = {"R": F(7_000_000), "omega0": F(1, 1000)} if name == "satellite" else {}
    found = found_in(given_of(name, **orbit))
    assert values(found) == KNOWN[name]
    assert found.complete
    assert all(one.kind == CHART and one.proved for one in found.sets)


@pytest.mark.parametrize("axes", ["3, 1, 3", "3, 2, 1", "1, 2, 1", "2, 3, 1"])
def test_three_turns_of_a_body(axes: str) -> None:
    """cos x2 = 0 for three different axes, sin x2 = 0 where the first returns; the joint is named."""
    turned = f"rotation: {{axes: [{axes}], angles: [u, v, w]}}"
    bodies = f"  - {{name: b, attached to: 0, {turned}, mass: 1, inertia about: joint, inertia: [1, 2, 2]}}"
    found = found_in(text("Body", "{}", bodies, "{u: 1, v: 1, w: 1}"))
    first, _, third = axes.split(", ")
    assert values(found) == {"v": {"0", "pi"} if first == third else {"pi/2", "-pi/2"}}
    assert found.complete
    assert found.sets[0].joint == "b"


LINKS = """
  - {name: upper, attached to: 0, rotation: {axes: [3], angles: [a]}, mass: M}
  - {name: lower, attached to: upper, rotation: {axes: [3], angles: [b]}, connection point: [1, 0, 0],
     mass centre: [2, 0, 0], mass: 1}
"""


def test_a_massless_link_is_the_model_s_fault() -> None:
    """Two links, mass at the tip only: stretched or folded (det M = 4 sin^2 b) the elbow moves and no mass does."""
    found = found_in(text("Massless", "{M: 0}", LINKS, "{a: 1, b: 1}"))
    assert values(found) == {"b": {"0", "pi"}}
    assert [one.kind for one in found.sets] == [MODEL]
    assert found.complete


def test_a_heavy_elbow_is_regular() -> None:
    """The same with a mass at the elbow, however small."""
    elbow = LINKS.replace("mass: M}", "mass centre: [1, 0, 0], mass: M}")
    found = found_in(text("Light elbow", "{M: 1/1000000000000}", elbow, "{a: 1, b: 1}"))
    assert found.complete
    assert not found.sets


def test_a_set_in_several_coordinates() -> None:
    """A point on a massless arm that slides on a massless arm: x = y = 0 of polar-like coordinates, by hand.

    r = (1 + cos a, 0) turned by b about the third axis: det M = sin^2(a) (1 + cos a)^2, singular at a = 0, pi.
    """
    bodies = """
  - {name: arm, attached to: 0, rotation: {axes: [3], angles: [b]}, mass: 0}
  - {name: bob, attached to: arm, connection point: [1 + cos(a), 0, 0], mass: 1, coordinates: [a]}
"""
    found = found_in(text("Slider", "{}", bodies, "{a: 1, b: 1}"))
    assert {label for one in found.sets for label in (v.label for v in one.values)} == {"0", "pi"}
    assert found.complete


def smallness(given: Scenario) -> Callable[[Any], float]:
    """Of positions: the smallest eigenvalue of M over its trace, the coordinates scaled so that M's diagonal is usually
    1."""
    n = len(given.positions)
    whole = kernel(Dynamics(given).mass_matrix)

    def matrix(at: Any) -> Any:
        return np.array(whole(np.array([0.0, *at, *([0.0] * n)]))).reshape(n, n)

    usual = np.sqrt(np.diag(matrix(np.linspace(0.7, 1.1, n))))
    return lambda positions: float(np.linalg.eigvalsh(matrix(positions) / np.outer(usual, usual))[0])


@pytest.mark.parametrize("name", ["satellite", "gyrostat", "dumbbell", "spatial-arm", "spherical-pendulum"])
def test_the_compiled_matrix_is_singular_there_and_nowhere_else(name: str) -> None:
    """Another route: float64 M from the kernels, on the sets and at random positions."""
    orbit = {"R": F(7_000_000), "omega0": F(1, 1000)} if name == "satellite" else {}
    given = given_of(name, **orbit)
    found, source = found_in(given), np.random.default_rng(3)
    small, names = smallness(given), given.system.coordinates
    for _ in range(40):
        at = source.uniform(-pi, pi, len(names))
        distances = [
            abs(np.sin(at[names.index(one.names[0])] - float(value.exact)))
            for one in found.sets
            for value in one.values
        ]
        assert small(at) > 1e-6 * min(distances, default=1.0) ** 2
        for one in found.sets:
            for place in one.places:
                there = at.copy()
                for key, value in place.items():
                    there[names.index(key)] = float(value)
                assert abs(small(there)) < 1e-12


# --- what is not proved is not said to be -----------------------------------------------------------------------------


def test_a_search_is_no_proof(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*args: Any) -> Any:
        raise NoClosedForm("planted")

    monkeypatch.setattr(module, "own_determinants", refused)
    monkeypatch.setattr(module, "MOST_COORDINATES", 0)
    found = found_in(given_of("spherical-pendulum"))
    assert values(found) == {"theta": {"0", "pi"}}
    assert not found.complete
    assert not any(one.proved for one in found.sets)
    joint = found_in(given_of("gravity-gradient"))  # the joint's own map is proved all the same
    assert values(joint) == {"theta": {"pi/2", "-pi/2"}}
    assert not joint.complete
    assert joint.sets[0].proved


def test_a_tensor_that_no_mass_has_proves_nothing() -> None:
    """A moment about the joint below m l^2: kinetic energy may be negative, and a body's own says nothing of M."""
    bodies = """
  - {name: upper, attached to: 0, rotation: {axes: [3], angles: [a]}, mass centre: [1, 0, 0], mass: 1,
     inertia about: joint, inertia: [0, J, J]}
"""
    good = text("Tensor", "{J: 2}", bodies, "{a: 1}")
    assert "own body" in found_in(good).how
    assert "det M" in found_in(changed(good, J=F(1, 2))).how


@pytest.mark.parametrize("lost", ["sine", "cosine"])
def test_a_lost_factor_is_noticed(monkeypatch: pytest.MonkeyPatch, lost: str) -> None:
    """Planted: one factor of det M is dropped.  The sets then differ from those known by hand."""
    whole = module.zero_sets

    def dropping(ring: Any, polynomials: Any, ranges: Any) -> Any:
        found = whole(ring, polynomials, ranges)
        return type(found)(found.sets[1:], found.nowhere, found.bounded)

    monkeypatch.setattr(module, "zero_sets", dropping)
    name = {"sine": "spherical-pendulum", "cosine": "satellite"}[lost]
    orbit = {"R": F(7_000_000), "omega0": F(1, 1000)} if name == "satellite" else {}
    assert values(found_in(given_of(name, **orbit))) != KNOWN[name]
