"""Verdicts of a sweep are those of the exact judge at the numbers of the row; which classes there are is no guess."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from conftest import SHIPPED
from flint import fmpq

import mbsym
from mbsym.algebra.failures import Limit, TooLargeError
from mbsym.maps.section import Axis, Section, section
from mbsym.maps.verdicts import verdict_at
from mbsym.sweeps import judged
from mbsym.sweeps.deciding import classes, split
from mbsym.sweeps.judged import EXACT, MASSLESS, NO_VERDICT, OUTSIDE, RIGHT, VERDICT, WORDS, StabilityMeasure

F = Fraction

#: (system, axes, settings): gyroscopic, damped with circulation, cyclic, damped by a rod.
PLANES = [
    ("satellite", [("alpha", -1, 1), ("gamma", -1, 1)], {"p1": F(2, 5), "p2": F(1, 5)}),
    ("ziegler-damped", [("P", 0, 5), ("b1", 0, 2)], {}),
    ("heavy-top", [("Omega", 0, 30), ("C", F(1, 100), 1)], {}),
    ("gravity-gradient", [("A", 1, 20), ("C", 1, 20)], {}),
]


def made(name: str, axes: list[tuple[str, object, object]], settings: dict[str, Fraction]) -> StabilityMeasure:
    analysis = mbsym.load(SHIPPED / f"{name}.yaml")
    return StabilityMeasure(analysis, section(analysis, [Axis(n, F(a), F(b)) for n, a, b in axes], settings))


def exact(found: Section, point: np.ndarray) -> tuple[str, int]:
    numbers = [fmpq(*float(x).as_integer_ratio()) for x in point]
    there = verdict_at(found, numbers)
    return there.verdict.word.value, -1 if there.right is None else there.right


@pytest.mark.parametrize(("name", "axes", "settings"), PLANES, ids=lambda x: x if isinstance(x, str) else "")
def test_every_verdict_is_that_of_the_exact_judge(name, axes, settings) -> None:  # type: ignore[no-untyped-def]
    measure = made(name, axes, settings)
    source = np.random.default_rng(5)
    low, high = (np.array([[float(axis[k])] for axis in axes]) for k in (1, 2))  # type: ignore[arg-type]
    points = source.uniform(low, high, (len(axes), 20_000))
    found = measure.at(points)
    several = set(found[VERDICT.name].tolist())
    assert len(several) > 1
    for place in range(0, 20_000, 160):
        if WORDS[found[VERDICT.name][place]] in NO_VERDICT:
            continue
        assert (WORDS[found[VERDICT.name][place]], found[RIGHT.name][place]) == exact(measure.section, points[:, place])


def test_on_borders_points_are_judged_singly_and_right() -> None:
    """The lines alpha = 0 and gamma = p2 of the satellite's condition det K > 0, and one unit in the last place off."""
    measure = made(*PLANES[0])
    step = np.nextafter(0.2, 1)
    points = np.array([[0.0, 5e-324, 0.5, 0.5, 0.5], [0.7, 0.7, 0.2, step, np.nextafter(0.2, 0)]])
    found = measure.at(points)
    assert found[EXACT.name].tolist() == [1, 1, 1, 0, 1]
    words = [WORDS[code] for code in found[VERDICT.name]]
    assert words == [exact(measure.section, point)[0] for point in points.T]
    assert [words[0], words[3], words[4]] == ["undecided", "stable", "unstable"]
    assert words[2] == "stable"  # the float 0.2 is greater than 1/5 by 1e-17


def test_outside_the_assumptions_nothing_is_judged() -> None:
    measure = made("satellite", [("alpha", -2, 2), ("gamma", -2, 2)], {"p1": F(2, 5), "p2": F(1, 5)})
    words = [WORDS[code] for code in measure.at(np.array([[1.5, 0.5, 0.5, 0.9], [0.5, 1.5, 0.5, -0.8]]))[VERDICT.name]]
    assert words == [OUTSIDE, OUTSIDE, "stable", MASSLESS]


def test_what_is_too_large_is_undecided_and_not_undefined(monkeypatch: pytest.MonkeyPatch) -> None:
    """No formula divides by zero there: a limit of the judge leaves the verdict open."""

    def refused(*_: object) -> None:
        raise TooLargeError("a field of a high degree", limit=Limit.DEGREE)

    monkeypatch.setattr(judged.Judge, "judged", refused)
    measure = made("satellite", [("alpha", -2, 2), ("gamma", -2, 2)], {"p1": F(2, 5), "p2": F(1, 5)})
    found = measure.at(np.array([[0.5], [0.5]]))
    assert [WORDS[code] for code in found[VERDICT.name]] == ["undecided"]
    assert found[RIGHT.name].tolist() == [-1]


def test_a_lost_quantity_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the roots of the characteristic polynomial, classes mix verdicts: the comparison above would find it."""
    real = judged.deciding

    def blind(*arguments):  # type: ignore[no-untyped-def]
        from dataclasses import replace

        found = real(*arguments)
        return replace(found, counts=tuple(count for count in found.counts if count.kind != "sturm"))

    monkeypatch.setattr(judged, "deciding", blind)
    measure = made(*PLANES[0])
    points = np.random.default_rng(5).uniform(-0.99, 0.99, (2, 4_000))
    found = measure.at(points)
    wrong = [
        k
        for k in range(0, 4_000, 8)
        if WORDS[found[VERDICT.name][k]] not in NO_VERDICT
        and (WORDS[found[VERDICT.name][k]], found[RIGHT.name][k]) != exact(measure.section, points[:, k])
    ]
    assert wrong


def test_factors_and_their_mirror_images_are_even_together() -> None:
    from flint import Ordering, fmpq_mpoly_ctx

    context = fmpq_mpoly_ctx.get(("a",), Ordering.lex)
    one, a = context.constant(1), context.gen(0)
    # (x^2 + 2 x + 2)(x^2 - 2 x + 2)(x + a) = (x^4 + 4)(x + a)
    polynomial = (4 * a, 4 * one, 0 * one, 0 * one, a, one)
    even, plain = split(polynomial)
    assert [str(x) for x in even] == ["4", "0", "1"]
    assert [str(x) for x in plain] == ["a", "1"]


def test_classes_partition_the_certain_points() -> None:
    keys = np.array([[3, 3, 7, 7, 3]])
    certain = np.array([True, True, True, False, True])
    found = {key: sorted(members.tolist()) for key, members in classes(keys, certain)}
    assert found == {(3,): [0, 1, 4], (7,): [2]}
    wide = np.array([[3, 3, 7, 7, 3], [0, 1, 0, 0, 0]])
    found = {key: sorted(members.tolist()) for key, members in classes(wide, certain)}
    assert found == {(3, 0): [0, 4], (3, 1): [1], (7, 0): [2]}


def test_a_sweep_says_what_the_map_says() -> None:
    """At random points of the satellite's plane: the region that the map's arrangement finds, and its verdict."""
    from mbsym.maps.mapping import exact_map
    from mbsym.maps.result import Lack

    analysis = mbsym.load(SHIPPED / "satellite.yaml")
    measure = made(*PLANES[0])
    whole = exact_map(analysis, measure.section.axes, {"p1": F(2, 5), "p2": F(1, 5)})
    points = np.random.default_rng(11).uniform(-0.99, 0.99, (2, 500))
    found = measure.at(points)
    words = {Lack.OUTSIDE: OUTSIDE, Lack.MASSLESS: MASSLESS}
    for place, (x, y) in enumerate(points.T):
        there = whole.arrangement.locate(fmpq(*x.as_integer_ratio()), fmpq(*y.as_integer_ratio()))
        stratum = whole.regions[there.id]
        wanted = words.get(stratum.lack) or stratum.word
        assert WORDS[found[VERDICT.name][place]] == wanted


def test_sweeps_say_what_exact_counts_say() -> None:
    """Satellites with a gyroscope, a damper, a rotor: the models by hand of the maps, at the floats of the rows."""
    from tests.maps.test_maps_against_models import CASES, to_the_right

    for case in CASES:
        if case.name not in ("satellite-with-gyroscope", "satellite-with-damper", "orbital-gyrostat"):
            continue
        measure = made(case.name, [(n, F(a), F(b)) for n, a, b in case.axes], {k: F(v) for k, v in case.settings})
        low, high = (np.array([[float(F(axis[k]))] for axis in case.axes]) for k in (1, 2))
        points = np.random.default_rng(3).uniform(low, high, (2, 300))
        found = measure.at(points)
        words = set()
        for place, point in enumerate(points.T):
            told = WORDS[found[VERDICT.name][place]]
            assert told not in NO_VERDICT
            exactly = {name: F(*float(x).as_integer_ratio()) for (name, *_), x in zip(case.axes, point, strict=True)}
            right = sum(map(to_the_right, case.model(exactly)))
            assert found[RIGHT.name][place] == right
            assert (told == "unstable") == (right > 0)
            words.add(told)
        assert len(words) > 1


BORDER = """
mbsym: 1
name: border
parameters: {a: {sign: real, value: 0}}
bodies: [{name: p, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]
loads: [potential: A*x**2/2 + B, rayleigh: D*x_dot**2/2]
motion: {x: 0}
"""


@pytest.mark.parametrize(
    ("linear", "further", "damping", "wanted"),
    [
        # at a = 0: V = x^4/4 has a strict minimum, V = -x^4/4, x^3 have none
        ("a", "x**4/4", "0", ["unstable", "stable", "stable"]),
        ("a", "-x**4/4", "0", ["unstable", "unstable", "stable"]),
        ("a", "x**3", "0", ["unstable", "unstable", "stable"]),
        ("a", "x**4/4", "1", ["unstable", "asymptotically stable", "asymptotically stable"]),
        # x'' - a x' + x + x^2 x' = 0: a focus at a = 0, by x^2 x', as E' = -x^2 x'^2; then the energy grows
        ("1", "0", "-a + x**2", ["asymptotically stable", "asymptotically stable", "unstable"]),
        ("1", "0", "-a - x**2", ["asymptotically stable", "unstable", "unstable"]),
    ],
)
def test_on_borders_terms_of_higher_order_decide(linear: str, further: str, damping: str, wanted: list[str]) -> None:
    text = BORDER.replace("A*", f"{linear}*").replace("+ B", f"+ {further}").replace("D*", f"({damping})*")
    analysis = mbsym.loads(text)
    measure = StabilityMeasure(analysis, section(analysis, [Axis("a", F(-1), F(1))], {}))
    found = measure.at(np.array([[-1.0, 0.0, 1.0]]))
    assert [WORDS[code] for code in found[VERDICT.name]] == wanted
    assert found[EXACT.name].tolist() == [0, 1, 0]
