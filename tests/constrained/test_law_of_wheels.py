"""What is said of vehicles does not depend on their description, and is that of d'Alembert's principle with all rows.

A car on a level plane with random wheels on one axle (of which rows follow from others), a mass centre off the axle, a
pendulum, springs and dampers, straight ahead along one of the axes of the plane.  The reference are places alone
(``test_redundant_rows.Chain``): roots are those of its flow on what the rows allow, and what is called an integral is
constant along it, in each description, and there are as many in each.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from fractions import Fraction
from random import Random
from typing import Any

import numpy as np
import pytest

from tests.constrained.test_flow_on_the_manifold import analysed, apart, differences, numbers
from tests.constrained.test_redundant_rows import Chain, Link, kept_velocities, slope

FORMS = ("rolling", "velocity", "centre", "twice")
STEP = 1e-4


class Vehicle:
    """Coordinates x, y, h of the axle's middle, p0, p1, ... of the wheels, b of the pendulum."""

    def __init__(self, seed: int) -> None:
        source = Random(f"vehicle {seed}")
        some = lambda *values: Fraction(source.choice(values))  # noqa: E731
        wheels = source.randint(1, 4)
        self.places = [Fraction(x) for x in source.sample(["0", "1/2", "-1/2", "1", "-3/2", "2"], wheels)]
        self.radius, self.ahead, self.speed = some("1/2", "1/3", 1), some(0, "1/2", "-1/3", 1), some(1, -1, 2, "-1/2")
        self.mass, self.wheel, self.spin = some(1, 2, 3), some("1/2", 1), some("1/10", "1/5")
        self.quarters, self.hanging = source.choice([0, 0, 1, 2, 3]), source.random() < 0.5
        self.length, self.axis = some("1/2", "-1/2"), source.choice([1, 2])
        stiff = some(0, 0, 1), some(0, 5, 30)
        self.springs = [stiff[0], *([stiff[1]] if self.hanging else [])]
        self.dampers = [some(0, 0, "1/2"), *([some(0, "1/3")] if self.hanging else [])]
        own = [f"p{i}" for i in range(wheels)]
        self.names = ["x", "y", "h", *own, *(["b"] if self.hanging else [])]
        self.elastic = [2, len(self.names) - 1][: 1 + self.hanging]
        angle = math.pi / 2 * self.quarters
        self.direction = ((1, 0), (0, 1), (-1, 0), (0, -1))[self.quarters]
        self.rest, self.rates = np.zeros(len(self.names)), np.zeros(len(self.names))
        self.rest[2] = angle
        self.rates[:2] = [float(self.speed * x) for x in self.direction]
        self.rates[3 : 3 + wheels] = float(self.speed / self.radius)

    @property
    def chain(self) -> Chain:
        spin, d, r = float(self.spin), [float(x) for x in self.places], float(self.radius)
        links = [Link(-1, (0, 0, r), 3, 2, float(self.mass), (float(self.ahead), 0, 0), (1, 1, 1))]
        links += [
            Link(0, (0, x, 0), 2, 3 + i, float(self.wheel), (0, 0, 0), (spin, 2 * spin, spin)) for i, x in enumerate(d)
        ]
        if self.hanging:
            links.append(
                Link(0, (0, 0, 0), self.axis, len(self.names) - 1, 1, (0, 0, float(self.length)), (0.25, 0.25, 0.25))
            )

        def rolling(q: Any, qd: Any) -> Any:
            ahead = qd[0] * math.cos(q[2]) + qd[1] * math.sin(q[2])
            aside = qd[1] * math.cos(q[2]) - qd[0] * math.sin(q[2])
            return np.array([aside, *(ahead - x * qd[2] - r * qd[3 + i] for i, x in enumerate(d))])

        return Chain(tuple(self.names), links, (0, 0, -10), None, rolling, lambda q: np.array([*q[:2], 0]))

    def field(self, x: Any) -> Any:
        q, qd = np.split(x, 2)
        forces = np.zeros(len(q))
        for k, stiffness, damping in zip(self.elastic, self.springs, self.dampers, strict=True):
            forces[k] = -float(stiffness) * (q[k] - self.rest[k]) - float(damping) * qd[k]
        return np.concatenate([qd, self.chain.accelerations(q, qd, forces)[0]])

    def allowed(self, x: Any) -> Any:
        """What the rows leave free at a state, as columns."""
        rows = slope(lambda z: self.chain.velocities(*np.split(z, 2)), x)  # type: ignore[misc]
        sizes, basis = np.linalg.svd(rows)[1:]
        return basis[int(np.sum(sizes > 1e-6 * sizes[0])) :].T

    @property
    def roots(self) -> Any:
        state = np.concatenate([self.rest, self.rates])
        assert self.field(state)[len(self.rest) :] == pytest.approx(0, abs=1e-7)
        free = self.allowed(state)
        return np.linalg.eigvals(free.T @ differences(self.field, state) @ free)

    @property
    def state(self) -> Any:
        """Any that the rows allow."""
        source = np.random.default_rng(3)
        q = self.rest + source.normal(size=len(self.rest))
        return np.concatenate([q, kept_velocities(self.chain, q, source)])

    def told(self, x: Any, shift: Fraction) -> dict[str, float]:
        """The coordinates, velocities and speeds of a description whose x, y belong to a point ``shift`` ahead."""
        q, qd = np.split(x, 2)
        values = dict(zip(self.names, q, strict=True)) | {f"{k}_dot": v for k, v in zip(self.names, qd, strict=True)}
        c, s, a = math.cos(q[2]), math.sin(q[2]), float(shift)
        values |= {"x": q[0] + a * c, "y": q[1] + a * s}
        values |= {"x_dot": qd[0] - a * s * qd[2], "y_dot": qd[1] + a * c * qd[2]}
        return values | {"w": qd[2], "u": qd[0] * c + qd[1] * s, **{f"s{k[1:]}": values[f"{k}_dot"] - qd[2]
                         for k in self.names if k[0] == "p"}}  # fmt: skip

    def described(self, form: str, dependent: list[str] | None, speeds: bool) -> tuple[str, Fraction]:
        shift, j, r = self.ahead if form == "centre" else Fraction(0), self.spin, self.radius
        own = ", speeds: {w: omega3, u: x_dot*cos(h) + y_dot*sin(h)}" if speeds else ""
        bodies = [
            f"{{name: car, attached to: 0, connection point: [x, y, {r}], rotation: {{axes: [3], angles: [h]}}, "
            f"coordinates: [x, y, h], mass: {self.mass}, mass centre: [{self.ahead - shift}, 0, 0], "
            f"inertia about: mass centre, inertia: [1, 1, 1]{own}}}"
        ]
        rows = ["velocity: x_dot*sin(h) - y_dot*cos(h) = 0"] if form == "velocity" else []
        for i, place in enumerate(self.places):
            own = f", speeds: {{s{i}: p{i}_dot - h_dot}}" if speeds and i % 2 else ""
            bodies.append(
                f"{{name: w{i}, attached to: car, connection point: [{-shift}, {place}, 0], "
                f"rotation: {{axes: [2], angles: [p{i}]}}, mass: {self.wheel}, inertia about: mass centre, "
                f"inertia: [{j}, {2 * j}, {j}]{own}}}"
            )
            ahead = f"velocity: x_dot*cos(h) + y_dot*sin(h) - ({place})*h_dot = {r}*p{i}_dot"
            rows.append(
                ahead if form == "velocity" else f"rolling: {{body: w{i}, point: [0, 0, {-r}], axes: car, on: ground}}"
            )
        rows += rows[:1] if form == "twice" else []
        if self.hanging:
            bodies.append(
                f"{{name: pendulum, attached to: car, connection point: [{-shift}, 0, 0], "
                f"rotation: {{axes: [{self.axis}], angles: [b]}}, mass: 1, mass centre: [0, 0, {self.length}], "
                "inertia about: mass centre, inertia: [1/4, 1/4, 1/4]}"
            )
        heading = f"{self.quarters}*pi/2"
        forces = {
            name: f"-({k})*({name} - {at}) - ({c})*{name}_dot"
            for name, at, k, c in zip("hb", (heading, 0), self.springs, self.dampers, strict=False)
        }
        loads = ["uniform gravity: {vector: [0, 0, -10]}"]
        loads += [f"generalized force: {{{name}: {force}}}" for name, force in forces.items()]
        place = [shift * x for x in self.direction]
        motion = [
            f"{name}: {{value: {at}, rate: {self.speed * x}}}" if x else f"{name}: {at}"
            for name, at, x in zip("xy", place, self.direction, strict=True)
        ]
        motion += [f"h: {heading}", *(f"p{i}: {{rate: {self.speed / r}}}" for i in range(len(self.places)))]
        lines = ["mbsym: 1", "name: vehicle", "bodies:", *(f"  - {x}" for x in bodies)]
        lines += ["loads:", *(f"  - {x}" for x in loads), "constraints:", *(f"  - {x}" for x in rows)]
        lines += [f"dependent: [{', '.join(dependent)}]"] if dependent else []
        return "\n".join([*lines, f"motion: {{{', '.join(motion)}}}", ""]), shift

    def analysed(self, seed: int) -> Iterator[tuple[Any, Fraction]]:
        """In coordinates and in speeds, with dependent coordinates that are drawn."""
        for form in FORMS:
            drawn: list[str] | None = None
            for speeds in (False, True):
                for dependent in (None, drawn)[: 1 + bool(drawn)]:
                    text, shift = self.described(form, dependent, speeds)
                    analysis = analysed(text)
                    if analysis is not None:
                        rank = analysis.constraints.velocity_rank
                        drawn = drawn or Random(seed).sample(analysis.system.coordinates, rank)
                        yield analysis, shift


@pytest.mark.parametrize("seed", [4, 13, 19])
def test_roots_verdicts_and_integrals_in_all_descriptions(seed: int) -> None:
    vehicle = Vehicle(seed)
    roots, state = vehicle.roots, vehicle.state
    rate, free = vehicle.field(state), vehicle.allowed(state)
    words, counts = set(), set()
    for analysis, shift in vehicle.analysed(seed):
        assert analysis.equilibrium.satisfied
        assert apart(np.linalg.eigvals(numbers(analysis.state_space.A.polynomials)), roots) < 1e-4
        words.add((analysis.stability.numerical or analysis.stability.verdict).word)
        slopes = []
        for one in analysis.integrals:
            formula = compile(str(one.formula), "integral", "eval")

            def value(x: Any, formula: Any = formula, shift: Fraction = shift) -> Any:
                return np.array([eval(formula, vars(math) | vehicle.told(x, shift))])

            drift = (value(state + STEP * rate) - value(state - STEP * rate)) / (2 * STEP)
            assert drift == pytest.approx(0, abs=1e-5 * (1 + abs(value(state)[0]))), one
            slopes.append(slope(value, state)[0])
        counts.add(int(np.linalg.matrix_rank(np.array(slopes) @ free, tol=1e-5)) if slopes else 0)
    assert len(words) == len(counts) == 1
    assert next(iter(words)).value.startswith("unstable") == bool(max(roots.real) > 1e-3)
