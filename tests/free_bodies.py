"""Constrained motions by Newton and Euler: bodies without joints, coordinates or speeds, as references for ours.

Each body is free: centre r, quaternion e (from body to space, R), velocity v, angular velocity w in its own axes,

    m v' = F + F_c,    I w' = - w x I w + M + M_c,    J u + j = 0,    J u' = - gamma,    u = (v, w) of all bodies,

with the accelerations of Gauss's principle by the singular values of all rows, however many follow from others,

    u' = a + L^-T (J L^-T)^+ (-gamma - J a),    M = L L^T,    a that of the free bodies.

Rows are analytic functions of places and time, so that gamma = d(J)/dt u + dj/dt is the imaginary part of one
evaluation at a place moved by i h u.  A row is linear in the velocities of material points and of rotations in space.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

GRAVITY = np.array([0.0, 0.0, -9.81])

#: (bodies (r, R), t) -> (J (k, 6 n), j (k,) or 0).
Rows = Callable[[list[Any], Any], tuple[Any, Any]]

#: (bodies (r, R), u, t) -> forces and moments (6 n,) as u has velocities, moments about centres in body axes.
Forces = Callable[[list[Any], Any, float], Any]

_IMAGINARY = 1e-30j


def cosines(e: Any) -> Any:
    """R of a quaternion, whatever its norm."""
    a, v = e[0], e[1:]
    return ((a * a - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * a * cross(v)) / (e @ e)


def cross(a: Any) -> Any:
    """The matrix of a x b."""
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def turn(axis: int, angle: float) -> Any:
    """R of a turn about a coordinate axis, 0 to 2."""
    return cosines(np.r_[np.cos(angle / 2), np.sin(angle / 2) * np.eye(3)[axis]])


def quaternion(turned: Any) -> Any:
    """e of R."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(turned).as_quat()[[3, 0, 1, 2]]


def placed(bodies: Sequence[Any], u: Any) -> Any:
    """The state (13 n) of bodies (r, R) with velocities u."""
    each = zip(bodies, np.reshape(u, (-1, 6)), strict=True)
    return np.concatenate([np.r_[r, quaternion(R), v[:3], v[3:]] for (r, R), v in each])


def bodies_of(state: Any) -> list[Any]:
    """(r, R) of each body."""
    return [(x[:3], cosines(x[3:7])) for x in np.reshape(state, (-1, 13))]


def part(n: int, k: int, along: Any, about: Any) -> Any:
    """Rows of one body among n: for its v, and for its w."""
    found = np.zeros((len(along), 6 * n), np.result_type(along, about, 1.0))
    found[:, 6 * k : 6 * k + 3], found[:, 6 * k + 3 : 6 * k + 6] = along, about
    return found


def point(bodies: list[Any], k: int | None, c: Any) -> Any:
    """Rows of the velocity of a point c of body k, in its axes from its centre; those of the ground are zero."""
    if k is None:
        return np.zeros((3, 6 * len(bodies)))
    return part(len(bodies), k, np.eye(3), -bodies[k][1] @ cross(c))


def spin(bodies: list[Any], k: int | None) -> Any:
    """Rows of the angular velocity of body k in space."""
    if k is None:
        return np.zeros((3, 6 * len(bodies)))
    return part(len(bodies), k, np.zeros((3, 3)), bodies[k][1])


@cache
def _complement(axis: tuple[float, ...]) -> Any:
    """Two directions across an axis."""
    return np.linalg.svd(np.array([axis]))[2][1:]


def hinge(bodies: list[Any], one: int, c: Any, other: int | None, d: Any, axis: Any) -> Any:
    """Five rows of a joint between point c of one body and d of the other (of the ground: ``None``), about an axis of
    the first."""
    across = _complement(tuple(axis)) @ bodies[one][1].T
    apart = spin(bodies, one) - spin(bodies, other)
    return np.vstack([point(bodies, one, c) - point(bodies, other, d), across @ apart])


def rolling(bodies: list[Any], k: int, arm: Any) -> Any:
    """Three rows: the material point at an arm from the centre, in space, is at rest."""
    return part(len(bodies), k, np.eye(3), -cross(arm) @ bodies[k][1])


def rim(turned: Any, axis: Any, down: Any, radius: float) -> Any:
    """The arm to the lowest point of a circle about an axis of a body."""
    n = turned @ axis
    low = down - (down @ n) * n
    return radius * low / np.sqrt(low @ low)


def motion(
    masses: Sequence[float],
    inertias: Sequence[Any],
    rows: Rows,
    start: Any,
    times: Any,
    gravity: Any = GRAVITY,
    forces: Forces | None = None,
) -> Any:
    """States (13 n, m) at times, body by body r, e, v, w; inertias are (3,) or (3, 3), about centres, in body axes."""
    n = len(masses)
    tensors = [np.diag(x) if np.ndim(x) == 1 else np.asarray(x) for x in inertias]
    mass = np.zeros((6 * n, 6 * n))
    for k, (m, tensor) in enumerate(zip(masses, tensors, strict=True)):
        mass[6 * k : 6 * k + 3, 6 * k : 6 * k + 3] = m * np.eye(3)
        mass[6 * k + 3 : 6 * k + 6, 6 * k + 3 : 6 * k + 6] = tensor
    root = np.linalg.inv(np.linalg.cholesky(mass)).T
    heavy = np.kron(masses, np.r_[gravity, 0, 0, 0])

    def rates(t: float, x: Any) -> Any:
        each = x.reshape(n, 13)
        u = each[:, 7:].ravel()
        bodies, moved, given, places = [], [], heavy.copy(), []
        for k, (state, tensor) in enumerate(zip(each, tensors, strict=True)):
            (r, R), e, v, w = (state[:3], cosines(state[3:7])), state[3:7], state[7:10], state[10:]
            bodies.append((r, R))
            moved.append((r + _IMAGINARY * v, R + _IMAGINARY * R @ cross(w)))
            given[6 * k + 3 : 6 * k + 6] -= cross(w) @ tensor @ w
            places.append(np.concatenate([v, [-e[1:] @ w / 2], (e[0] * w + cross(e[1:]) @ w) / 2]))
        if forces is not None:
            given += forces(bodies, u, t)
        J, j = rows(moved, t + _IMAGINARY)
        gamma, J = np.imag(J @ u + j) / _IMAGINARY.imag, np.real(J)
        free = root @ (root.T @ given)
        rate = free + root @ (np.linalg.pinv(J @ root, rcond=1e-7) @ (-gamma - J @ free))
        return np.hstack([places, rate.reshape(n, 6)]).ravel()

    done = solve_ivp(rates, (0, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-12, atol=1e-13)
    assert done.success
    return done.y
