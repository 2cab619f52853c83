"""The values of speeds and unit vectors at a state of the coordinates, from the placement of the bodies.

An independent route to the variables of ``mechanics.speeds``: at numbers for q, q', q'' the oracle places all bodies in
inertial axes as series in time; angular velocities, direction cosines and their rates are read off there, by

    u = form(q, q', omega),      u' = du/dt,      e = columns of A_k^T A_j,      e0 = sqrt(1 + tr A_k^T A_j)/2,

and S = du/dq' from the spins that unit velocities give.  Neither Y nor any derivative of a closed formula is used.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import Any

from mbsym.algebra.base import Lowering, Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.ring import Ring
from mbsym.mechanics.oracle import Dual, FirstOrder, Oracle, Series, State, TaylorSeries
from mbsym.model.speeds import OMEGA, Quaternion, Speed
from mbsym.model.system import velocity_name


def completed(oracle: Oracle) -> State:
    """The oracle's state with values for speeds, unit vectors and their derivatives."""
    values = dict(oracle.state.values)
    for name, series in variables(oracle).items():
        values |= {name: series.a, velocity_name(name): series.b}
    return State(oracle.state.numbers, values)


def variables(oracle: Oracle) -> dict[str, Series]:
    """Speeds and components of unit vectors as series in time, of which the first two coefficients count."""
    system = oracle.system
    series: dict[str, Series] = {}
    for body in system.bodies:
        if not body.orientation:
            continue
        own, frame = oracle.moving.axes[body.name], oracle.moving.axes[body.attached_to]
        for vector in body.orientation:
            if isinstance(vector, Quaternion):
                series |= dict(zip(vector.components, _quaternion(oracle, own, frame), strict=True))
                continue
            for i, name in enumerate(vector.components):
                series[name] = _sum(own[k][i] * frame[k][vector.axis - 1] for k in range(3))
    return series | {speed.name: _speed(oracle, speed) for speed in system.speeds}


def in_time(ring: Ring, oracle: Oracle) -> Carrier:
    """Formulas as series in time along the motion from the oracle's state on, of which x and dx/dt count."""
    series = {**oracle.in_time, **variables(oracle)}
    return Carrier(ring, TaylorSeries(oracle.numbers, series), series)


def _quaternion(oracle: Oracle, own: Any, frame: Any) -> list[Series]:
    """The quaternion with e0 > 0 of A = A_j^T A_k:  4 e0^2 = 1 + tr A,  4 e0 e1 = A32 - A23  and round (Shepperd)."""
    algebra = TaylorSeries(oracle.numbers, {})
    a = [[_sum(frame[k][m] * own[k][i] for k in range(3)) for i in range(3)] for m in range(3)]
    twice = algebra.square_root(algebra.one + a[0][0] + a[1][1] + a[2][2])
    half, slope = algebra.number(Fraction(1, 2)), algebra.reciprocal(twice)
    differences = (a[2][1] - a[1][2], a[0][2] - a[2][0], a[1][0] - a[0][1])
    return [half * twice, *(half * slope * x for x in differences)]


def _sum(items: Any) -> Any:
    terms = list(items)
    return sum(terms[1:], start=terms[0])


def _speed(oracle: Oracle, speed: Speed) -> Series:
    """u and u' (the first two coefficients) of the form, along the motion."""
    moving = oracle.moving
    environment = dict(oracle.in_time)
    if speed.turns:
        zero = oracle.numbers.zero
        omega, rate = moving.spin(speed.body)
        world = [Series(a, b, zero) for a, b in zip(omega, rate, strict=True)]
        own = moving.axes[speed.body]
        environment |= {name: _sum(own[k][i] * world[k] for k in range(3)) for i, name in enumerate(OMEGA)}
    return Lowering(TaylorSeries(oracle.numbers, environment), environment)(speed.form)


def all_slopes(oracle: Oracle, names: Sequence[str]) -> list[list[Scalar]]:
    """du_r/dq'_i of the speeds ``names``, velocities of coordinates among them, from the spins of the placed bodies."""
    declared = {speed.name: speed for speed in oracle.system.speeds}
    one, zero = oracle.numbers.one, oracle.numbers.zero
    return [
        slopes(oracle, declared[u])
        if u in declared
        else [one if velocity_name(name) == u else zero for name in oracle.system.coordinates]
        for u in names
    ]


def slopes(oracle: Oracle, speed: Speed) -> list[Scalar]:
    """du/dq'_i for every coordinate."""
    scalars = []
    for name in oracle.system.coordinates:
        displaced = oracle.displaced(name)
        environment: dict[str, Any] = {
            key: _dual(oracle, value, velocity_name(name) == key) for key, value in oracle.state.values.items()
        }
        if speed.turns:
            spin = displaced.spin(speed.body)[0]
            own = oracle.moving.axes[speed.body]
            for i, key in enumerate(OMEGA):
                along = _sum(own[k][i].a * spin[k] for k in range(3))
                environment[key] = _dual(oracle, oracle.numbers.zero, True, along)
        algebra = FirstOrder(oracle.numbers, environment)
        scalars.append(Lowering(algebra, environment)(speed.form).b)
    return scalars


def _dual(oracle: Oracle, value: Scalar, moves: bool, rate: Scalar | None = None) -> Any:
    seed = oracle.numbers.one if rate is None else rate
    return Dual(value, seed if moves else oracle.numbers.zero)
