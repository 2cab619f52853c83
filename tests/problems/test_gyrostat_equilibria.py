"""The general gyrostat in an orbit: complete lists against Newton's method from many orientations.

The conditions here are those of S. Gutnik and V. Sarychev in vectors, I w' = 0 with w = n:

    3 e x I e - n x (I n + h) = 0,      e: outward along the radius, n: normal of the orbit, in the axes of the body.
"""

from __future__ import annotations

import math
import random
from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED
from numpy.typing import NDArray

import mbsym
from mbsym.algebra.polynomial_systems import Limits
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria import oriented as rest_cosines
from mbsym.problems.relative_equilibria.equilibria import EXACT, Equilibria, RelativeEquilibrium, equilibria

Array = NDArray[np.float64]

GYROSTAT = mbsym.load(SHIPPED / "orbital-gyrostat.yaml").system

ON_AN_ARM = """
mbsym: 1
name: spun
prescribed: {chi: {rate: 1}}
bodies:
  - {name: arm, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}
  - name: body
    attached to: arm
    connection point: [2, 0, 0]
    rotation: {axes: [1, 2, 3], angles: [p, q, r]}
    mass: 1
    mass centre: [0.3, -0.2, 0.1]
    inertia about: joint
    inertia: [3, 2, 4]
    gyrostatic moment: [0.1, 0.3, 0.2]
loads:
  - uniform gravity: {vector: [0, 0, -1]}
"""


def listed(inertia: tuple[str, str, str], h: tuple[str, str, str], limits: Limits | None = None) -> Equilibria:
    given = dict(zip(("A", "B", "C", "h1", "h", "h3"), map(Fraction, (*inertia, *h)), strict=True))
    return equilibria(GYROSTAT, given_values(GYROSTAT, given), limits=limits)


def moment(turn: Array, inertia: Array, h: Array) -> Array:
    """The moment, for orientations (k x 2 x 3: e and n)."""
    e, n = turn[:, 0], turn[:, 1]
    found: Array = 3 * np.cross(e, inertia * e) - np.cross(n, inertia * n + h)
    return found


def rotated(turn: Array, small: Array) -> Array:
    """Orientations turned by rotation vectors (Rodrigues)."""
    angle = np.linalg.norm(small, axis=1)[:, None, None] + 1e-300
    axis = np.broadcast_to(small[:, None, :] / angle, turn.shape)
    along = (axis * turn).sum(axis=2, keepdims=True) * axis
    found: Array = turn * np.cos(angle) + np.cross(axis, turn) * np.sin(angle) + along * (1 - np.cos(angle))
    return found


def from_many_starts(inertia: Array, h: Array, starts: int = 1200) -> Array:
    """The different (e, n) that Newton's method reaches; steps of at most 0.3."""
    source = np.random.default_rng(7)
    frames = np.linalg.qr(source.normal(size=(starts, 3, 3)))[0] * source.choice((-1, 1), size=(starts, 1, 3))
    turn = np.stack([frames[:, :, 0], frames[:, :, 1]], axis=1)
    for _ in range(60):
        f, columns = moment(turn, inertia, h), []
        for k in range(3):  # d(tau) for a turn about axis k: e' = d x e, n' = d x n
            d = np.eye(3)[k]
            e, n = turn[:, 0], turn[:, 1]
            de, dn = np.cross(d, e), np.cross(d, n)
            change = 3 * (np.cross(de, inertia * e) + np.cross(e, inertia * de))
            columns.append(change - np.cross(dn, inertia * n + h) - np.cross(n, inertia * dn))
        jacobian = np.stack(columns, axis=2)
        step = -np.einsum("kij,kj->ki", np.linalg.pinv(jacobian), f)
        size = np.linalg.norm(step, axis=1)[:, None]
        turn = rotated(turn, step * np.minimum(1, 0.3 / np.maximum(size, 1e-300)))
        turn[:, 0] /= np.linalg.norm(turn[:, 0], axis=1)[:, None]
        turn[:, 1] -= (turn[:, 1] * turn[:, 0]).sum(axis=1)[:, None] * turn[:, 0]
        turn[:, 1] /= np.linalg.norm(turn[:, 1], axis=1)[:, None]
    found: list[Array] = []
    for one in turn[np.abs(moment(turn, inertia, h)).max(axis=1) < 1e-11]:
        if all(np.abs(one - other).max() > 1e-6 for other in found):
            found.append(one)
    return np.array(found)


def orientation(one: RelativeEquilibrium) -> Array:
    """(e, n) in the axes of A, B, C, as the description's abbreviations say."""
    assert one.coordinates_of == ""
    psi, theta, phi = (next(x.value for x in one.values if x.name == name) for name in ("psi", "theta", "phi"))
    e = [math.sin(theta), math.sin(phi) * math.cos(theta), math.cos(phi) * math.cos(theta)]
    n = [
        math.sin(psi) * math.cos(theta),
        math.cos(psi) * math.cos(phi) - math.sin(psi) * math.sin(theta) * math.sin(phi),
        -math.sin(psi) * math.sin(theta) * math.cos(phi) - math.cos(psi) * math.sin(phi),
    ]
    return np.array([e, n])


def at_random(seed: int) -> tuple[tuple[str, str, str], tuple[str, str, str]]:
    """Moments of a rigid body, not all too different, and a gyrostatic moment with no component 0."""
    source = random.Random(seed)
    x, y, z = (source.randint(50, 300) for _ in range(3))
    inertia = (f"{y + z}/100", f"{z + x}/100", f"{x + y}/100")
    h = tuple(f"{source.choice((-1, 1)) * source.randint(3, 170)}/100" for _ in range(3))
    return inertia, (h[0], h[1], h[2])


@pytest.mark.parametrize(
    ("inertia", "h", "count"),
    [
        (("4", "5", "3"), ("1/20", "3/100", "1/50"), 24),  # counts of the reference, by a multistart of its own
        (("4", "5", "3"), ("1000003/20000000", "31/1000", "-1/51"), 24),
        (*at_random(1), None),
        (*at_random(2), None),
        (*at_random(3), None),
    ],
)
def test_every_equilibrium_of_the_general_gyrostat(
    inertia: tuple[str, str, str], h: tuple[str, str, str], count: int | None
) -> None:
    found = listed(inertia, h)
    assert found.complete
    assert not found.families
    assert not found.singular
    assert {one.proof for one in found.equilibria} == {EXACT}
    assert count is None or len(found.equilibria) == count
    expected = from_many_starts(
        np.array([float(Fraction(x)) for x in inertia]), np.array([float(Fraction(x)) for x in h])
    )
    ours = np.array([orientation(one) for one in found.equilibria])
    assert len(expected) == len(ours)
    gaps = np.abs(ours[:, None] - expected[None]).max(axis=(2, 3))
    assert (gaps.min(axis=1) < 1e-12).all()
    assert (gaps.min(axis=0) < 1e-12).all()


def test_a_list_that_outgrows_its_limits_stays_open() -> None:
    found = listed(("4", "5", "3"), ("1/20", "3/100", "1/50"), Limits(bits=4))
    assert not found.complete
    assert any("may be" in x or "not finished" in x for x in found.remarks)


def test_equilibria_beside_singular_angles_are_told_apart_from_them() -> None:
    """As h goes to 0 there are 24: eight of those of h = 0 have cos theta = 0, and now cos theta is about 1e-15."""
    found = listed(("4", "5", "3"), ("1/1000000000000000", "1/500000000000000", "3/1000000000000000"))
    assert found.complete
    assert len(found.equilibria) == 24
    assert not found.singular


def test_a_wrong_third_axis_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the third axis has the other sign, so the angles belong to no rest; the list is not taken from there."""
    true = rest_cosines.Choice.sign
    monkeypatch.setattr(rest_cosines.Choice, "sign", lambda self: -true(self))
    found = listed(("4", "5", "3"), ("1/20", "3/100", "1/50"))
    assert not found.complete
    assert not any("direction cosines" in x for x in found.remarks)


def test_a_symmetric_gyrostat_is_counted_up_to_turns_about_its_axis() -> None:
    """I = A + (B - A) k k, h along k, d = B - A = 1:  3 (e.k) e x k = (n.k + h/d) n x k.

    So k = +-n; or e.k = 0 and n.k = -h/d (two); or k = c n + s e with  3 c = -(c + h/d),  c = -1/8 for h/d = 1/2 (two).
    """
    found = listed(("4", "5", "4"), ("0", "1/2", "0"))
    assert found.complete
    assert not found.families
    assert [one.free for one in found.equilibria] == [("phi",)] * 6
    upright = []  # n.k in axes {2, 1, 3}: psi about the normal's opposite, k the third axis of the body
    for one in found.equilibria:
        psi, theta = (next(x.value for x in one.values if x.name == name) for name in ("psi", "theta"))
        upright.append(math.cos(psi) * math.cos(theta))
    assert np.allclose(sorted(upright), sorted([1, -1, -1 / 2, -1 / 2, -1 / 8, -1 / 8]), rtol=0, atol=1e-12)
    assert any("up to turns of satellite about its axis 3" in x for x in found.remarks)


def test_a_gyrostat_without_symmetry_is_not_counted_up_to_turns() -> None:
    """h is not along the axis of the symmetric inertia."""
    found = listed(("4", "5", "4"), ("3/10", "1/2", "1/5"))
    assert found.complete
    assert all(not one.free for one in found.equilibria)
    assert not any("up to turns" in x for x in found.remarks)


def test_a_body_whose_conditions_are_too_large_stays_open_in_bounded_time() -> None:
    """A heavy gyrostat on a turning arm, its mass centre off every axis: once an interreduction of minutes."""
    found = equilibria(mbsym.loads(ON_AN_ARM).system, {})
    assert not found.complete
    assert any("not finished" in x for x in found.remarks)
