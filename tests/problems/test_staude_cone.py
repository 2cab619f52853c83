"""Permanent rotations of a heavy body for every rate, against Staude's cone and Euler's equations by hand.

With n upward, r the mass centre and J the moments of inertia (gravity m g = 1 along -n), J w' = J w x w + n x r; so
w = W n is a permanent rotation if and only if  W^2 (J n x n) + n x r = 0.
"""

from __future__ import annotations

import json
import math
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import sympy
from click.testing import CliRunner
from conftest import SHIPPED, TESTS

import mbsym
from mbsym.mechanics.rest import given_values
from mbsym.problems.relative_equilibria import permanent_rotations as module
from mbsym.problems.relative_equilibria.equilibria import equilibria
from mbsym.problems.relative_equilibria.permanent_rotations import PermanentRotations, permanent_rotations
from mbsym.studies.equilibria import STUDY
from mbsym_cli.study import command_of

FILE = TESTS / "cases" / "statements" / "staude2.yaml"
G = sympy.symbols("g1 g2 g3")


def staude(**values: str) -> PermanentRotations:
    system = mbsym.load(FILE).system
    found = permanent_rotations(system, given_values(system, {k: Fraction(v) for k, v in values.items()}))
    assert found is not None
    return found


def read(text: str) -> Any:
    return sympy.sympify(text, dict(zip(("g1", "g2", "g3"), G, strict=True)))


def by_hand(J: list[Any], r: list[Any], h: list[Any]) -> list[list[Any]]:
    """(n x r, h x n, J n x n): what is constant, linear and quadratic in the rate."""
    n = sympy.Matrix(G)
    return [
        list(n.cross(sympy.Matrix(r))),
        list(sympy.Matrix(h).cross(n)),
        list((sympy.diag(*J) * n).cross(n)),
    ]


def agree(found: PermanentRotations, parts: list[list[Any]]) -> None:
    """Each component is proportional to the one by hand, with one factor that is not zero."""
    for row in range(3):
        ours = [read(part[row]) for part in (found.constant, found.linear, found.quadratic)]
        true = [part[row] for part in parts]
        for i in range(3):
            for j in range(3):
                assert sympy.expand(ours[i] * true[j] - ours[j] * true[i]) == 0
        assert [sympy.expand(x) == 0 for x in ours] == [sympy.expand(x) == 0 for x in true]


def test_staudes_cone() -> None:
    found = staude()
    J, r = [4, 5, 6], [Fraction(1, 10), Fraction(1, 5), Fraction(3, 10)]
    agree(found, by_hand(J, [sympy.Rational(x.numerator, x.denominator) for x in r], [0, 0, 0]))
    # r . (J n x n) = r1 (B - C) n2 n3 + r2 (C - A) n3 n1 + r3 (A - B) n1 n2, times -10
    (cone,) = found.axes
    assert sympy.expand(read(cone) - (G[1] * G[2] - 4 * G[2] * G[0] + 3 * G[0] * G[1])) == 0
    assert found.family
    assert found.either


@pytest.mark.parametrize("rate", ["1/2", "1", "3"])
def test_what_is_listed_at_one_rate_belongs_to_the_family(rate: str) -> None:
    system = mbsym.load(FILE).system
    found = staude(W=rate)
    listed = equilibria(system, given_values(system, {"W": Fraction(rate)}))
    assert listed.complete
    assert listed.equilibria
    for one in listed.equilibria:
        th, phi = (next(x.value for x in one.values if x.name == name) for name in ("th", "phi"))
        n = dict(zip(G, (math.sin(th) * math.sin(phi), math.sin(th) * math.cos(phi), math.cos(th)), strict=True))
        assert abs(read(found.axes[0]).subs(n)) < 1e-9
        for constant, quadratic in zip(found.constant, found.quadratic, strict=True):
            assert abs(read(constant).subs(n) + float(Fraction(rate)) ** 2 * read(quadratic).subs(n)) < 1e-9


def test_of_each_line_of_the_cone_one_direction_has_a_real_rate() -> None:
    """n = (x, y, 1) with 3 x y - 4 x + y = 0 is y = 4 x / (3 x + 1): the rate of n or of -n, by Euler's equations."""
    found = staude()
    for x in np.linspace(-3.1, 3.3, 23):
        n = np.array([x, 4 * x / (3 * x + 1), 1])
        n /= np.linalg.norm(n)
        assert abs(read(found.axes[0]).subs(dict(zip(G, n, strict=True)))) < 1e-12
        moment, turning = np.cross(n, [0.1, 0.2, 0.3]), np.cross([4 * n[0], 5 * n[1], 6 * n[2]], n)
        assert np.abs(np.cross(moment, turning)).max() < 1e-12
        squares = [-(s * moment) @ turning / (turning @ turning) for s in (1, -1)]
        assert sum(square > 0 for square in squares) == 1


def test_a_symmetric_top_turns_steadily_about_every_axis() -> None:
    a = mbsym.load(SHIPPED / "heavy-top.yaml").system
    found = permanent_rotations(a, given_values(a, {}))
    assert found is not None
    assert found.everywhere
    assert found.axes == ()
    l, A, C, weight = (sympy.Rational(x) for x in ("1/2", "3/10", "1/10", "981/100"))
    agree(found, by_hand([A, A, C], [0, 0, weight * l], [0, 0, 0]))


def test_a_part_of_the_cone_without_rotations_is_left_out() -> None:
    """A = B, r = (1/10, 0, 3/10): K = (A - C) n2 n3 / 10, and on n3 = 0 (J n x n = 0) at most n = +-e1 rests."""
    found = staude(B="4", y="0")
    assert found.axes == ("g2",)
    assert found.family


@pytest.mark.parametrize(
    ("values", "loaded", "inertial"),
    [({"x": "0", "y": "0", "z": "0"}, False, True), ({"A": "6", "B": "6"}, True, False)],
)
def test_no_cone_is_claimed_where_there_is_none(values: dict[str, str], loaded: bool, inertial: bool) -> None:
    found = staude(**values)
    assert (found.loaded, found.inertial) == (loaded, inertial)
    assert (found.axes, found.family, found.everywhere) == ((), False, False)


def gyrostat(h: str) -> PermanentRotations | None:
    text = FILE.read_text().replace(
        "    inertia: [A, B, C]\n", f"    inertia: [A, B, C]\n    gyrostatic moment: [{h}]\n"
    )
    system = mbsym.loads(text).system
    return permanent_rotations(system, given_values(system, {}))


def test_a_heavy_gyrostat() -> None:
    """J w' = (J w + h) x w + n x r; the necessary condition vanishes at rotations that are found numerically."""
    found = gyrostat("1/3, -1/2, 1/5")
    assert found is not None
    agree(
        found,
        by_hand(
            [4, 5, 6],
            [sympy.Rational(k, 10) for k in (1, 2, 3)],
            [sympy.Rational(1, 3), -sympy.Rational(1, 2), sympy.Rational(1, 5)],
        ),
    )
    assert found.axes
    assert not found.family
    assert not found.either
    condition = sympy.lambdify(G, sympy.prod([read(x) for x in found.axes]))
    J, h, r = np.diag([4.0, 5, 6]), np.array([1 / 3, -1 / 2, 1 / 5]), np.array([0.1, 0.2, 0.3])
    source, reached = np.random.default_rng(3), 0
    for _ in range(40):
        x = np.append(source.normal(size=3), source.normal())

        def conditions(x: Any) -> Any:
            n, rate = x[:3], x[3]
            return np.append(np.cross(rate * J @ n + h, rate * n) + np.cross(n, r), n @ n - 1)

        for _ in range(60):
            slope = np.array([(conditions(x + 1e-7 * d) - conditions(x - 1e-7 * d)) / 2e-7 for d in np.eye(4)]).T
            x = x - np.linalg.lstsq(slope, conditions(x), rcond=1e-9)[0]
        if np.abs(conditions(x)).max() < 1e-11:
            reached += 1
            assert abs(condition(*x[:3])) < 1e-7 * (1 + np.abs(x).max())
    assert reached > 5


@pytest.mark.parametrize(
    "system", ["double-pendulum", "gravity-gradient", "orbital-gyrostat", "dumbbell", "spherical-pendulum"]
)
def test_what_is_no_body_about_a_fixed_axis_has_none(system: str) -> None:
    given = mbsym.load(SHIPPED / f"{system}.yaml").system
    assert permanent_rotations(given, given_values(given, {})) is None


def test_a_moment_that_does_not_hold_at_other_rates_is_withdrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: the moment at one rate has a wrong sign; the moments at further rates do not agree with it."""
    true = module._moment

    def lie(still: Any, joint: Any, rate: int) -> Any:
        found = true(still, joint, rate)
        return tuple(-x for x in found) if rate == -1 and found else found

    monkeypatch.setattr(module, "_moment", lie)
    system = mbsym.load(FILE).system
    assert permanent_rotations(system, given_values(system, {})) is None


def test_the_command_prints_the_cone() -> None:
    done = CliRunner().invoke(command_of(STUDY), [str(FILE)])
    assert done.exit_code == 0
    assert "a one-parameter family, the axes on a cone: 3*g1*g2 - 4*g1*g3 + g2*g3 = 0" in done.output
    data = json.loads(CliRunner().invoke(command_of(STUDY), [str(FILE), "--json"]).output)
    assert data["permanent_rotations"]["one_parameter_family"] is True
