"""What is said of a mechanism does not depend on its description: coordinates or constraints, whichever are dependent.

Random nets of masses and rods in a plane, of which any position with rational coordinates is made a rest by forces: a
mass is told by its Cartesian coordinates, the rods by relations or distances; or it hangs on a tree of rods, by their
angles from each other or from the ground, and what closes the loops are distances or further rods without mass.
"""

from __future__ import annotations

import math
from collections import defaultdict
from fractions import Fraction
from functools import cached_property
from random import Random
from typing import Any

import numpy as np
import pytest
from conftest import system_of

from mbsym.analysis.constrained import on_a_plane
from mbsym.analysis.resting import relative_equilibria
from tests.constrained.test_flow_on_the_manifold import analysed, apart, differences, numbers

#: Of rods: a mass by its number, or a place on the ground.
End = int | tuple[Fraction, Fraction]
SEEDS = range(10)
FORMS = ("relation", "distance", "tree", "absolute", "rods")


class Net:
    """``rods`` carry the masses from the ground on; ``ties`` close loops."""

    def __init__(self, seed: int) -> None:
        source = Random(f"net {seed}")
        while not self._drawn(source):
            pass
        n, some = len(self.places), lambda: Fraction(source.randint(1, 6), 2)
        self.masses, self.gravity = [some() for _ in range(n)], source.choice([0, 10])
        ends = [*range(n), *(end for _, end in self.rods if not isinstance(end, int))]
        pairs = [(i, source.choice([x for x in ends if x != i])) for i in range(n)]
        self.springs = [(a, b, some()) for a, b in pairs if source.random() < 0.6]
        self.damped = [i for i in range(n) if source.random() < 0.4]
        carried = [source.randint(-4, 4) for _ in (*self.rods, *self.ties)]
        #: Constant forces that hold the net, with forces ``carried`` by its rods.
        self.held = carried @ self.slopes(self._exact) - self.force(self._exact)

    def _drawn(self, source: Random) -> bool:
        """Places and rods; whether something moves and no position near by has a larger rank."""
        n, bars = source.randint(2, 3), source.random() < 0.4
        self.rods: list[tuple[int, End]]
        self.ties: list[tuple[int, End]]
        if bars:  # parallel ones
            d = Fraction(source.randint(1, 2)), Fraction(source.choice([-1, 1]))
            feet = [(Fraction(2 * i), Fraction(0)) for i in range(n)]
            self.places = [(x + d[0], y + d[1]) for x, y in feet]
            self.rods, self.ties = list(enumerate(feet)), [(i, i - 1) for i in range(1, n)]
            return True
        self.places = [(Fraction(source.randint(-3, 3)), Fraction(source.randint(-3, 3))) for _ in range(n)]
        feet = [(Fraction(source.randint(-4, 4)), Fraction(source.randint(-4, 4))) for _ in range(2)]
        self.rods = [(i, source.choice([*range(i), *feet])) for i in range(n)]
        others = [(i, x) for i in range(n) for x in (*range(i), *feet) if (i, x) not in self.rods]
        self.ties = source.sample(others, source.randint(1, 2))
        rank = np.linalg.matrix_rank(self.slopes(self._exact).astype(float))
        return len({*self.places, *feet}) == n + 2 and rank == len(self.rods) + len(self.ties) < 2 * n

    @property
    def _exact(self) -> Any:
        return np.array([x for place in self.places for x in place], dtype=object)

    @staticmethod
    def at(end: End, x: Any) -> Any:
        return x[2 * end : 2 * end + 2] if isinstance(end, int) else np.array(end, dtype=x.dtype)

    # --- the law, in Cartesian coordinates ---

    def slopes(self, x: Any) -> Any:
        """J of half the squared lengths."""
        rows = np.zeros((len(self.rods) + len(self.ties), len(x)), dtype=x.dtype) + 0 * x[0]
        for row, (i, end) in zip(rows, [*self.rods, *self.ties], strict=True):
            for mass, sign in ((i, 1), (end, -1)):
                if isinstance(mass, int):
                    row[2 * mass : 2 * mass + 2] += sign * (self.at(i, x) - self.at(end, x))
        return rows

    def force(self, x: Any) -> Any:
        f = 0 * x
        f[1::2] -= self.gravity * np.array(self.masses, dtype=x.dtype)
        for a, b, k in self.springs:
            for mass, sign in ((a, -1), (b, 1)):
                if isinstance(mass, int):
                    f[2 * mass : 2 * mass + 2] += (self.at(a, x) - self.at(b, x)) * (
                        sign * (k if x.dtype == object else float(k))
                    )
        return f

    @cached_property
    def roots(self) -> Any:
        """Of x'' = d'Alembert with all rows, on what they allow, by differences; J by its singular values."""
        x0, count = self._exact.astype(float), len(self.masses)
        lengths = lambda x: self.slopes(x) @ x - self._stretch(x)  # noqa: E731
        free = self._null(x0)
        m = free.shape[1]

        def state(y: Any) -> tuple[Any, Any]:
            x = x0 + free @ y[:m]
            for _ in range(20):
                x = x - np.linalg.pinv(self.slopes(x), rcond=1e-7) @ (lengths(x) - lengths(x0))
            basis = self._null(x, m)
            return x, basis @ np.linalg.solve(free.T @ basis, y[m:])

        def field(y: Any) -> Any:
            x, v = state(y)
            rows, mass = self.slopes(x), np.diag(np.repeat([float(z) for z in self.masses], 2))
            bent = np.array([np.sum((self.at(i, v) - (self.at(e, v) if isinstance(e, int) else 0)) ** 2)
                             for i, e in (*self.rods, *self.ties)])  # fmt: skip
            f = self.force(x) + self.held.astype(float)
            for i in self.damped:
                f[2 * i : 2 * i + 2] -= v[2 * i : 2 * i + 2] / 2
            first, z = -np.linalg.pinv(rows, rcond=1e-7) @ bent, self._null(x, m)
            whole = first + z @ np.linalg.solve(z.T @ mass @ z, z.T @ (f - mass @ first))
            return np.concatenate([y[m:], free.T @ whole])

        assert count * 2 - m == np.linalg.matrix_rank(self.slopes(x0))
        assert field(np.zeros(2 * m)) == pytest.approx(0, abs=1e-9)
        return np.linalg.eigvals(differences(field, np.zeros(2 * m)))

    def _stretch(self, x: Any) -> Any:
        """J x less half the squared lengths, as |a - b|^2 = 2 (a - b) (a - b)/2."""
        gaps = [self.at(i, x) - self.at(e, x) for i, e in (*self.rods, *self.ties)]
        return self.slopes(x) @ x - np.array([gap @ gap / 2 for gap in gaps])

    def _null(self, x: Any, size: int = 0) -> Any:
        _, s, turned = np.linalg.svd(self.slopes(x))
        return turned[len(x) - size :].T if size else turned[int(np.sum(s > 1e-9)) :].T

    # --- descriptions ---

    def described(self, form: str, dependent: list[str] | None = None, speeds: bool = False) -> str:
        tree, ties = form not in ("relation", "distance"), self.ties
        arms = [self.at(i, self._exact) - self.at(end, self._exact) for i, end in self.rods]
        point = lambda e: [0, 0, 0] if not tree else [*arms[e], 0]  # noqa: E731
        name = lambda e: f"n{e}" if isinstance(e, int) else "0"  # noqa: E731
        there = lambda e: f"{{body: {name(e)}, point: {self._list(point(e) if isinstance(e, int) else [*e, 0])}}}"  # noqa: E731
        bodies, rows, start = [], [], {}
        for k, (i, end) in enumerate(self.rods):
            if not tree:
                x, y = self.places[k]
                own = f"connection point: [x{k}, y{k}, 0], coordinates: [x{k}, y{k}]"
                told, start = f"u{k}: x{k}_dot, w{k}: y{k}_dot", start | {f"x{k}": x, f"y{k}": y}
                on = "0"
            else:
                on, at = name(end), self._list(point(end) if isinstance(end, int) else [*end, 0])
                if form == "absolute" and isinstance(end, int):
                    on, at = "0", self._chain(end, arms)
                own = f"connection point: {at}, rotation: {{axes: [3], angles: [q{k}]}}, "
                own += f"mass centre: {self._list(point(i))}"
                told, start = f"w{k}: omega3", start | {f"q{k}": Fraction(0)}
            own += f", speeds: {{{told}}}" * speeds
            bodies.append(f"{{name: n{k}, attached to: {on}, mass: {self.masses[k]}, {own}}}")
        for k, (i, end) in enumerate(ties if tree else [*self.rods, *ties]):
            gap = self.at(i, self._exact) - self.at(end, self._exact)
            square = gap @ gap
            if form == "rods":
                angle, start = f"s{k}", start | {f"s{k}": Fraction(0)}
                at = self._list(point(end) if isinstance(end, int) else [*end, 0])
                bodies.append(f"{{name: r{k}, attached to: {name(end)}, connection point: {at}, mass: 0, "
                              f"rotation: {{axes: [3], angles: [{angle}]}}}}")  # fmt: skip
                rows.append(f"coincide: [{{body: r{k}, point: {self._list([*gap, 0])}}}, {there(i)}]")
            elif form == "relation":
                other = (f"x{end}", f"y{end}") if isinstance(end, int) else (f"({end[0]})", f"({end[1]})")
                rows.append(f"relation: (x{i} - {other[0]})**2 + (y{i} - {other[1]})**2 = {square}")
            else:
                rows.append(f"distance: {{between: [{there(i)}, {there(end)}], length: sqrt({square})}}")
        loads = [f"uniform gravity: {{vector: [0, {-self.gravity}, 0]}}"] * bool(self.gravity)
        loads += [
            f"spring: {{between: [{there(a)}, {there(b)}], stiffness: {k}, length: 0}}" for a, b, k in self.springs
        ]
        ground = "{body: 0, point: [0, 0, 0]}"
        loads += [f"isotropic damper: {{between: [{there(i)}, {ground}], coefficient: 1/2}}" for i in self.damped]
        loads += [
            f"force: {{body: n{i}, point: {self._list(point(i))}, components: {self._list([*f, 0])}, axes: 0}}"
            for i in range(len(self.masses))
            if any(f := self.held[2 * i : 2 * i + 2])
        ]
        state = "{" + ", ".join(f"{x}: {value}" for x, value in start.items()) + "}"
        lines = ["mbsym: 1", "name: net", "bodies:", *(f"  - {x}" for x in bodies)]
        lines += ["loads:", *(f"  - {x}" for x in loads)] * bool(loads)
        lines += ["constraints:", *(f"  - {x}" for x in rows)]
        lines += [f"dependent: [{', '.join(dependent or [])}]"] * bool(dependent)
        return "\n".join([*lines, f"motion: {state}", f"initial: {state}", ""])

    @staticmethod
    def _list(values: Any) -> str:
        return f"[{', '.join(map(str, values))}]"

    def _chain(self, end: End, arms: Any) -> str:
        """The place of a mass, written out in the angles of the rods that carry it."""
        x, y = [], []
        while isinstance(end, int):
            a, b = arms[end]
            x.append(f"({a})*cos(q{end}) - ({b})*sin(q{end})")
            y.append(f"({a})*sin(q{end}) + ({b})*cos(q{end})")
            end = self.rods[end][1]
        return f"[{' + '.join([str(end[0]), *x])}, {' + '.join([str(end[1]), *y])}, 0]"

    def seen(self, form: str, values: dict[str, float]) -> tuple[float, ...]:
        """Where the masses are."""
        n = len(self.masses)
        if form in ("relation", "distance"):
            return tuple(round(values[f"{x}{i}"], 4) + 0.0 for i in range(n) for x in "xy")
        found, turned = np.zeros(2 * n), [0.0] * n
        for i, end in self.rods:
            turned[i] = values[f"q{i}"] + (turned[end] if isinstance(end, int) and form != "absolute" else 0)
            a, b = map(float, self.at(i, self._exact) - self.at(end, self._exact))
            c, s = math.cos(turned[i]), math.sin(turned[i])
            found[2 * i : 2 * i + 2] = self.at(end, found) + np.array([a * c - b * s, a * s + b * c])
        return tuple(round(float(x), 4) + 0.0 for x in found)


@pytest.mark.parametrize("seed", SEEDS)
def test_roots_and_verdicts_in_all_descriptions(seed: int) -> None:
    """In coordinates and in speeds, with dependent coordinates that are drawn.

    A verdict may stay open only beside others that know more: that their coordinates keep to a plane.
    """
    net, words, planes = Net(seed), defaultdict(list), set()
    for form in FORMS:
        drawn: list[str] | None = None
        for speeds in (False, True):
            for dependent in (None, drawn)[: 1 + bool(drawn)]:
                analysis = analysed(net.described(form, dependent, speeds))
                if analysis is None:
                    continue
                drawn = Random(seed).sample(analysis.system.coordinates, analysis.constraints.velocity_rank)
                assert analysis.equilibrium.satisfied
                found = np.linalg.eigvals(numbers(analysis.state_space.A.polynomials))
                assert apart(found, net.roots) < 1e-4, (form, dependent, speeds)
                verdict = analysis.stability.numerical or analysis.stability.verdict
                words[verdict.word].append((form, dependent, speeds))
                if on_a_plane(analysis.in_coordinates if speeds else analysis) is not None:
                    planes.add(form)
    decided = {word: forms for word, forms in words.items() if not word.open}
    assert len(decided or words) == 1, words
    assert len(words) == 1 or {form for forms in decided.values() for form, *_ in forms} <= planes, (words, planes)


@pytest.mark.parametrize("seed", [0, 1, 3, 4, 5, 8, 9, 11])
def test_rests_in_all_descriptions(seed: int) -> None:
    """The same places with the same verdicts; all of them wherever a list says that it is complete."""
    net = Net(seed)
    lists, whole = {}, []
    for form in FORMS:
        system = system_of(net.described(form))
        found = relative_equilibria(system, {})
        if found.families or any(one.free for one in found.equilibria):
            return
        lists[form] = {
            net.seen(form, {x.name: x.value for x in one.values}): str(one.verdict.word) for one in found.equilibria
        }
        whole += [lists[form]] * found.complete
    assert whole
    for form, one in lists.items():
        assert one == whole[0] if any(one is x for x in whole) else one.items() <= whole[0].items(), form
