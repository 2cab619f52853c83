"""What generated code has to compute, by routes that share nothing with it: d'Alembert's principle and closed formulas.

M, f        the oracle's residual is M q'' - f: at q'' = 0 and at unit vectors, in balls of 240 bits
q''         M^-1 f in balls
Jacobian    central differences of that with a step of 1e-20, whose error is below 1e-30
energies    the closed formulas of problem 2;  integrals: those of problem 7
places      the oracle's, which turns vectors by Rodrigues' formula; poses and Jacobians of bodies too, these by its
            velocities at q' = e_i less those at q' = 0
tau         the oracle's residual at q'' = (1, 2, ...);  q'' under tau = (1, 2, ...): M^-1 (f + tau)
c, g        its residuals at q'' = 0 without loads, and what fields of gravity alone change in these
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np
from conftest import ball, precision
from flint import arb, arb_mat, fmpq

from mbsym.algebra.base import Lowering
from mbsym.algebra.point import Balls
from mbsym.analysis import Analysis
from mbsym.mechanics.oracle import Oracle, Placement, State
from mbsym.model.loads import NewtonianGravity, UniformGravity
from mbsym.model.system import acceleration_name

BITS = 240
STEP = Fraction(1, 10**20)


@dataclass(frozen=True)
class Point:
    """Numbers of double precision: the time, x = (q, q') and the parameters, in the order of the description."""

    t: float
    x: tuple[float, ...]
    p: tuple[float, ...]


def random_point(analysis: Analysis, seed: int) -> Point:
    """Of the size of one; parameters that a relation gives are free."""
    source = random.Random(f"{analysis.system.name} {seed}")
    system = analysis.system
    x = tuple(source.randint(20, 90) / 64 * source.choice((1, -1)) for _ in range(2 * len(system.coordinates)))
    return Point(source.randint(1, 99) / 64, x, tuple(source.randint(30, 90) / 64 for _ in system.parameters))


def truth(analysis: Analysis, point: Point) -> dict[str, Any]:
    """Name of a function -> its value at the point."""
    with precision(BITS):
        return _Truth(analysis, point).everything()


class _Truth:
    def __init__(self, analysis: Analysis, point: Point) -> None:
        self.analysis, self.system, self.point = analysis, analysis.system, point
        self.n = len(self.system.coordinates)

    def values(self, x: Sequence[arb]) -> dict[str, arb]:
        point, system = self.point, self.system
        found = dict(zip(system.parameter_names, map(_exact, point.p), strict=True))
        found |= {"t": _exact(point.t), "pi": arb.pi()}
        found |= dict(zip([*system.coordinates, *system.velocities], x, strict=True))
        numbers = Balls(found)
        for item in system.prescribed:
            lower = Lowering(numbers, found)
            moved = lower(item.rate) * found["t"]
            found = {**found, item.name: moved if item.initial is None else moved + lower(item.initial)}
        return found

    def residuals(self, values: Mapping[str, arb], accelerations: Sequence[int]) -> list[arb]:
        names = map(acceleration_name, self.system.coordinates)
        whole = {**values, **{name: arb(a) for name, a in zip(names, accelerations, strict=True)}}
        found = Oracle(self.system, State(Balls(whole), whole)).residuals
        return [found[name] for name in self.system.coordinates]

    def dynamics(self, x: Sequence[arb]) -> tuple[arb_mat, arb_mat]:
        values, n = self.values(x), self.n
        still = self.residuals(values, [0] * n)
        columns = [self.residuals(values, [int(i == j) for i in range(n)]) for j in range(n)]
        mass = arb_mat(n, n, [columns[j][i] - still[i] for i in range(n) for j in range(n)])
        return mass, arb_mat(n, 1, [-r for r in still])

    def slopes(self, x: Sequence[arb]) -> list[arb]:
        mass, force = self.dynamics(x)
        return mass.solve(force).entries()

    def everything(self) -> dict[str, Any]:
        n, analysis = self.n, self.analysis
        x = [_exact(value) for value in self.point.x]
        mass, force = self.dynamics(x)
        jacobian = np.zeros((2 * n, 2 * n))
        for j in range(2 * n):
            ends = [self.slopes([v + s * ball(STEP) * (k == j) for k, v in enumerate(x)]) for s in (1, -1)]
            for i in range(n):
                jacobian[n + i, j] = float((ends[0][i] - ends[1][i]) / (2 * ball(STEP)))
            if j >= n:
                jacobian[j - n, j] = 1
        values = self.values(x)
        still = {**values, **{acceleration_name(name): arb(0) for name in self.system.coordinates}}
        oracle = Oracle(self.system, State(Balls(still), still))

        def closed(polynomial: Any) -> float:
            return float(analysis.ring.evaluate(polynomial, values))

        ring, energy = analysis.ring, analysis.energy
        kinetic, force_function = energy.kinetic_energy.polynomial, energy.force_function.polynomial
        momenta = [ring.velocity_derivative(kinetic, name) for name in self.system.coordinates]
        speeds = [ring.generator("velocity", name) for name in self.system.coordinates]
        found = {
            "mass_matrix": _floats(mass.entries()).reshape(n, n),
            "forcing": _floats(force.entries()),
            "accelerations": _floats(mass.solve(force).entries()),
            "jacobian": jacobian,
            "energy": closed(kinetic - force_function - _gyrostatic(analysis)),
            "generalized_energy": closed(ring.reduce(ring.dot(momenta, speeds) - kinetic - force_function)),
            "integrals": np.array([closed(item.formula.polynomial) for item in analysis.integrals]),
            "joints": np.array([_floats(part.a for part in oracle.moving.origin[b.name]) for b in self.system.bodies]),
            "mass_centres": np.array(
                [_floats(part.a for part in oracle.moving.mass_centre(b)) for b in self.system.bodies]
            ),
        }
        found |= self.named(values, mass, force)
        if not analysis.integrals:
            del found["integrals"]
        return found

    def named(self, values: Mapping[str, arb], mass: arb_mat, force: arb_mat) -> dict[str, Any]:
        """What robotics calls by name."""
        n, system = self.n, self.system
        some = range(1, n + 1)
        fields = tuple(one for one in system.loads if isinstance(one, UniformGravity | NewtonianGravity))
        parts = []
        for loads in ((), fields):
            other = _Truth.__new__(_Truth)
            other.system, other.n = replace(system, loads=loads), n
            parts.append(other.residuals(values, [0] * n))
        placed = [self.moving(values, ())] + [self.moving(values, (i,)) for i in range(n)]
        poses, slopes = [], []
        for body in system.bodies:
            origin, axes = placed[0].origin[body.name], placed[0].axes[body.name]
            rows = [_floats([*(x.a for x in axes[i]), origin[i].a]) for i in range(3)]
            poses.append(np.vstack([*rows, [0, 0, 0, 1]]))
            rates = [[x.b for x in one.origin[body.name]] + list(one.spin(body.name)[0]) for one in placed]
            slopes.append(_floats(rates[i + 1][k] - rates[0][k] for k in range(6) for i in range(n)).reshape(6, n))
        return {
            "inverse_dynamics": _floats(self.residuals(values, list(some))),
            "forward_dynamics": _floats(mass.solve(force + arb_mat(n, 1, [arb(k) for k in some])).entries()),
            "coriolis": _floats(parts[0]),
            "gravity": _floats(b - a for a, b in zip(*parts, strict=True)),
            "frame_poses": np.array(poses),
            "frame_jacobians": np.array(slopes),
        }

    def moving(self, values: Mapping[str, arb], fast: Sequence[int]) -> Placement:
        """Where the bodies are, velocities being zero but for some that are one."""
        rates = {name: arb(int(i in fast)) for i, name in enumerate(self.system.velocities)}
        still = {acceleration_name(name): arb(0) for name in self.system.coordinates}
        whole = {**values, **rates, **still}
        return Oracle(self.system, State(Balls(whole), whole)).moving


def _gyrostatic(analysis: Analysis) -> Any:
    """h.omega, which no energy contains."""
    total = analysis.ring.zero
    for motion in analysis.scene.motions.values():
        if motion.gyrostatic_moment is not None:
            total = total + analysis.ring.dot(motion.gyrostatic_moment, motion.angular_velocity)
    return analysis.ring.reduce(total)


def _exact(value: float) -> arb:
    exact = Fraction(value)
    return arb(fmpq(exact.numerator, exact.denominator))


def _floats(values: Any) -> Any:
    return np.array([float(value) for value in values])


def differences(found: Mapping[str, Any], expected: Mapping[str, Any], bound: float = 1e-11) -> list[str]:
    """The names of functions that are missing, have another shape, or differ by more than ``bound`` of their size."""
    wrong = []
    for name, value in expected.items():
        own, value = np.asarray(found.get(name, ()), float), np.asarray(value, float)
        size = max(1.0, np.abs(value).max(initial=0.0))
        if own.size != value.size or not np.all(np.abs(own.reshape(value.shape) - value) <= bound * size):
            wrong.append(name)  # what is no number is not less
    return wrong
