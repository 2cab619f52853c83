"""Sections of the space of parameters, and the polynomials that bound regions of one verdict."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import pytest
from conftest import SHIPPED, derived
from flint import fmpq

import mbsym
from mbsym.algebra.factors import irreducible_factors
from mbsym.maps.admissible import admissibility
from mbsym.maps.boundaries import Boundaries, Condition, Origin, boundaries
from mbsym.maps.section import Axis, Complaint, Fault, Section, Unfit, section
from mbsym.maps.verdicts import verdict_at as verdict_at_point
from mbsym.problems.stability.exact import verdict_at
from mbsym.problems.stability.words import Word


def made(name: str, axes: dict[str, tuple[Any, Any]], **settings: Any) -> Section:
    listed = [Axis(axis, Fraction(low), Fraction(high)) for axis, (low, high) in axes.items()]
    return section(derived(SHIPPED / f"{name}.yaml"), listed, {k: Fraction(v) for k, v in settings.items()})


def complaints(name: str, axes: dict[str, tuple[Any, Any]], **settings: Any) -> set[tuple[Fault, str]]:
    with pytest.raises(Unfit) as caught:
        made(name, axes, **settings)
    return {(one.fault, one.name) for one in caught.value.complaints if isinstance(one, Complaint)}


PAPER = {"alpha": (-1, 1), "gamma": (0, 1)}


def monic(p: Any) -> str:
    return str(p / p.leading_coefficient())


def factors_of(found: Boundaries, *origins: Origin) -> set[str]:
    return {
        monic(factor)
        for factor, conditions in zip(found.factors, found.conditions, strict=True)
        if {one.origin for one in conditions} & set(origins)
    }


def irreducible(*polynomials: Any) -> set[str]:
    return {monic(factor) for p in polynomials if not p.is_constant() for factor, _ in irreducible_factors(p)[1]}


@pytest.mark.parametrize(("p1", "p2"), [("2/5", "1/5"), ("3/4", "1/7")])
def test_the_boundaries_of_the_satellite_are_the_papers_conditions(p1: str, p2: str) -> None:
    """Banshchikov & Vetrov, eqs (5), (6): constant terms, leading coefficients and the discriminant as printed."""
    there = made("satellite", PAPER, p1=p1, p2=p2)
    alpha, gamma = there.context.gens()
    q1, q2 = fmpq(*map(int, p1.split("/"))), fmpq(*map(int, p2.split("/")))
    v6 = (1 + gamma * alpha) * q1 - (alpha + 1) * q2
    v4 = 3 * (1 + alpha * gamma) + (alpha + 1) * (q1 * (alpha + 3 * gamma + 2) - (alpha + 8) * q2)
    v2 = (
        (1 + 3 * gamma + alpha * (alpha + 2 * gamma + 3)) * (3 + q1)
        + 4 * alpha * q1 * (gamma + alpha)
        - 8 * q2 * (alpha + 1) * (alpha + 2)
    )
    v0 = 4 * alpha * ((alpha + gamma) * (3 + q1) - 4 * (alpha + 1) * q2)
    dis = v4**2 * v2**2 - 4 * v2**3 * v6 - 4 * v4**3 * v0 + 18 * v6 * v4 * v2 * v0 - 27 * v0**2 * v6**2
    found = boundaries(there)
    assert factors_of(found, Origin.CONSTANT) == irreducible(v0, gamma - q2)
    assert factors_of(found, Origin.DISCRIMINANT) == irreducible(dis)
    assert irreducible(v6) <= factors_of(found, Origin.LEADING)


def test_verdicts_change_only_where_a_boundary_vanishes() -> None:
    """Random points at which all factors have the same signs have the same verdict and numbers of roots."""
    random = Random(7)
    for name, axes, settings in (
        ("satellite", PAPER, {"p1": "2/5", "p2": "1/5"}),
        ("ziegler-damped", {"P": (0, 5), "b1": (0, 1)}, {}),
        ("orbital-gyrostat", {"h": (-9, 9), "A": (2, 8)}, {}),
        ("satellite-with-damper", {"omega": (0, 9), "Lambda": (0, 9)}, {}),
    ):
        there = made(name, axes, **settings)
        found = boundaries(there)
        by_signs: dict[tuple[int, ...], set[tuple[Any, ...]]] = {}
        for _ in range(60):
            at = [
                fmpq(random.randint(1, 999), 1000) * (fmpq(int(axis.high - axis.low))) + int(axis.low)
                for axis in there.axes
            ]
            signs = tuple((value > 0) - (value < 0) for p in found.factors for value in (p(*at),))
            point = {k: Fraction(int(x.p), int(x.q)) for k, x in enumerate(at)}
            said = [verdict_at(part, point) for part in there.parts]
            by_signs.setdefault(signs, set()).add(tuple((x.verdict.word, x.roots and x.roots.right) for x in said))
        # equal signs are necessary for the same region, and here no region of equal signs has two verdicts
        assert all(len(words) == 1 for words in by_signs.values()), name
        assert len({next(iter(words)) for words in by_signs.values()}) > 1, name


def test_without_its_hurwitz_minor_the_follower_force_would_be_mapped_wrongly() -> None:
    """A lost factor shows: points with equal signs of the others then have different numbers of roots to the right."""
    there = made("ziegler-damped", {"P": (0, 5), "b1": (0, 1)})
    found = boundaries(there)
    kept = [
        p
        for p, conditions in zip(found.factors, found.conditions, strict=True)
        if all(one.origin is not Origin.HURWITZ for one in conditions)
    ]
    assert len(kept) < len(found.factors)
    random, counts = Random(3), {}
    for _ in range(60):
        at = [fmpq(random.randint(1, 499), 100), fmpq(random.randint(1, 99), 100)]
        signs = tuple(p(*at) > 0 for p in kept)
        point = {k: Fraction(int(x.p), int(x.q)) for k, x in enumerate(at)}
        roots = verdict_at(there.parts[0], point).roots
        assert roots is not None
        counts.setdefault(signs, set()).add(roots.right)
    assert any(len(right) > 1 for right in counts.values())


def test_raw_parameters_and_notation_make_the_same_matrices() -> None:
    """The satellite at Jx, Jy, ... of its file and at the alpha, gamma, p1, p2 that follow from them (by hand)."""
    m, m0, length, r, jx, jy, jz = (Fraction(x) for x in ("2/5", "1/2", "2", "3/5", "12/5", "6/5", "23/10"))
    a, b = jy, jx + m * r * (length + r) + m * length**2 / 3 + m0 * (length + r) ** 2
    c, d = b + jz - jx, (m / 3 + m0) * length**2
    f = (m / 2 + m0) * r * length + d
    raw = made("satellite", {"Jx": (0, 5), "Jy": (0, 5)})
    told = made("satellite", PAPER, p1=d / f, p2=f / c)
    at_raw = [verdict_at(part, {0: jx, 1: jy}) for part in raw.parts]
    at_told = [verdict_at(part, {0: (c - b) / a, 1: (b - a) / c}) for part in told.parts]
    assert [x.verdict for x in at_raw] == [x.verdict for x in at_told]
    for one, other in zip(at_raw, at_told, strict=True):
        assert one.characteristic == other.characteristic


def test_every_complaint_at_once() -> None:
    assert complaints("satellite", PAPER) == {(Fault.MISSING, "p1"), (Fault.MISSING, "p2")}
    assert complaints("satellite", {"alpha": (0, 1), "nu": (0, 1)}, Jx="-1") == {
        (Fault.RELATED, "nu"),
        (Fault.SIGN, "Jx"),
    }
    assert complaints("orbital-gyrostat", {"h": (0, 1), "h1": (0, 1)}) == {(Fault.SOLVED, "h1")}


def test_symbols_that_follow_from_one_another_are_refused() -> None:
    """p1 = d/f: of d, f and p1 two are free."""
    found = complaints("satellite", PAPER, p1="1/2", d=1, f=3)
    assert found == {(Fault.DEPENDENT, "f")} or found == {(Fault.DEPENDENT, "p1")} or len(found) == 1
    assert all(fault is Fault.DEPENDENT for fault, _ in found)


def test_admissible_inertias_of_a_satellite() -> None:
    """A + B >= C and its turns, for C = 1, and A, B > 0."""
    analysis = derived(SHIPPED / "gravity-gradient.yaml")
    there = section(
        analysis, [Axis("A", Fraction(0), Fraction(2)), Axis("B", Fraction(0), Fraction(2))], {"C": Fraction(1)}
    )
    found = admissibility(analysis, there)
    a, b = there.context.gens()
    wanted = {monic(p) for p in (a, b, a + b - 1, b + 1 - a, a + 1 - b)}
    assert {monic(one.condition.polynomial) for one in found.demands} == wanted
    assert not found.broken
    assert not found.left_out
    inside = [fmpq(1), fmpq(1, 2)]
    assert all(one.kept(one.condition.polynomial(*inside)) for one in found.demands)
    assert not all(one.kept(one.condition.polynomial(fmpq(1, 3), fmpq(1, 3))) for one in found.demands)


def test_numbers_against_an_assumption_are_told() -> None:
    """The paper's symbols need p1 > 0."""
    analysis = derived(SHIPPED / "satellite.yaml")
    axes = [Axis(name, Fraction(-1), Fraction(1)) for name in PAPER]
    there = section(analysis, axes, {"p1": Fraction(-2, 5), "p2": Fraction(1, 5)})
    assert [one.condition.about for one in admissibility(analysis, there).broken] == ["p1 > 0"]


def test_conditions_that_hold_nowhere_are_told() -> None:
    """p1 and alpha are put in so that det K of the yaw-roll part vanishes with alpha = 0 everywhere on the line."""
    there = made("satellite", {"gamma": (0, 1)}, alpha=0, p1="2/5", p2="1/5")
    found = boundaries(there, [Condition(Origin.ASSUMPTION, there.context.constant(0))])
    assert any(one.origin is Origin.ASSUMPTION for one in found.vanishing)
    # lambda^2 splits off: the constant term is that of what is left, and does not vanish identically
    assert all(p != 0 for p in found.factors)


DAMPED = Path(__file__).parent / "damped.yaml"


def test_what_the_energy_does_depends_on_signs_and_is_proved_for_all_points_of_these_signs() -> None:
    """x'' + b x' + k x = 0 beside y'' + y = 0: stable for b >= 0 < k by the energy of both, which roots do not show."""
    there = section(mbsym.load(DAMPED), [Axis("b", Fraction(-1), Fraction(1)), Axis("k", Fraction(0), Fraction(1))], {})
    assert not there.one_energy
    assert [there.judged((sign, 1))[1] for sign in (-1, 0, 1)] == [False, True, True]
    said = [verdict_at_point(there, (fmpq(b), fmpq(1, 2))).verdict.word for b in (-1, 0, 1)]
    assert said == [Word.UNSTABLE, Word.STABLE, Word.STABLE]
    assert [str(x) for x in there.asked] == ["b"]


def test_roots_are_counted_over_all_subsystems() -> None:
    """x'' + b x' - x/2 = 0: one real root to the right whatever b is; b = -2, k = 5: a pair."""
    there = section(
        mbsym.load(DAMPED), [Axis("b", Fraction(-3), Fraction(1)), Axis("k", Fraction(-1), Fraction(9))], {}
    )
    found = verdict_at_point(there, (fmpq(1), fmpq(-1, 2)))
    assert (found.right, found.real_right, found.degree, found.null) == (1, 1, 1, 0)
    found = verdict_at_point(there, (fmpq(-2), fmpq(5)))
    assert (found.right, found.real_right, found.degree, found.null) == (2, 0, 0, 0)
