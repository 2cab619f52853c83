"""Every system has speeds and rows: coordinates without constraints are the instance u = q' without rows.

A random tree is described as it is (Lagrange's equations, the quick route), in declared speeds u = q' (Kane's), and
beside a body that a constraint holds (equations without multipliers, expansion on the manifold).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from hypothesis import given
from properties import settings
from random_systems import Description, analysed, clone, numbers, resting, spinning

from mbsym.analysis import Analysis
from mbsym.problems.checks import EXACT, NUMERICAL, SINGULAR
from mbsym.problems.integrals import ENERGY, Integral

some = settings(max_examples=20)

PROBLEMS = (1, 2, 3, 4, 5, 6, 7)


def in_speeds(description: Description) -> Description:
    """u_q = q' of every coordinate."""
    there = clone(description)
    for body in there["bodies"]:
        if body["coordinates"]:
            body["speeds"] = {f"u_{name}": f"{name}_dot" for name in body["coordinates"]}
    return there


def beside_a_row(description: Description) -> Description:
    """With a point that could move along a line and is held there."""
    there = clone(description)
    held = {"name": "held", "attached to": 0, "mass": 3, "connection point": ["held1", 0, 0], "coordinates": ["held1"]}
    there["bodies"].append(held)
    return there | {"constraints": [{"relation": "held1 = 0"}]}


def as_velocity(name: str) -> str:
    """q_dot of u_q."""
    return f"{name.removeprefix('u_')}_dot" if name.startswith("u_") else name


def kept(analysis: Analysis, called: Callable[[str], str] = str) -> dict[tuple[str, str], Any]:
    """The energy and the cyclic momenta that problem 7 finds, as numbers."""
    found: list[Integral] = [x for x in analysis.integrals if x.kind in (ENERGY, "cyclic momentum")]
    return dict(
        zip([(x.kind, x.of) for x in found], numbers(analysis, [x.formula for x in found], called), strict=True)
    )


def all_numbers(analysis: Analysis, matrix: Any, called: Callable[[str], str] = str) -> list[Any]:
    return [numbers(analysis, row, called) for row in matrix]


def compared_in_speeds(description: Description) -> None:
    plain, general = analysed(description, PROBLEMS), analysed(in_speeds(description), PROBLEMS)
    names, own = plain.system.coordinates, general.equations
    order = [own.speeds.index(f"u_{name}") for name in names]
    mass, forcing = all_numbers(general, own.mass_matrix, as_velocity), numbers(general, own.forcing, as_velocity)
    assert [[mass[i][j] for j in order] for i in order] == all_numbers(plain, plain.equations.mass_matrix)
    assert [forcing[i] for i in order] == numbers(plain, plain.equations.forcing)
    for part in ("kinetic_energy", "force_function"):
        first, second = [getattr(plain.energy, part)], [getattr(general.energy, part)]
        assert numbers(general, second, as_velocity) == numbers(plain, first)
    assert kept(general, as_velocity) == kept(plain)
    outcomes = {check.name: check.outcome for check in general.checks}
    if outcomes["mass matrix"] == SINGULAR:  # what has no inertia has no first approximation in speeds either
        return
    assert {*outcomes.values()} <= {EXACT, NUMERICAL}
    if general.optional("first_order") is not None and general.optional("linearisation") is not None:
        assert outcomes["first approximation in speeds"] == EXACT


@some
@given(resting())
def test_of_rests_in_speeds(description: Description) -> None:
    compared_in_speeds(description)


@some
@given(spinning())
def test_of_spins_in_speeds(description: Description) -> None:
    compared_in_speeds(description)


def compared_beside_a_row(description: Description) -> None:
    plain, tied = analysed(description, PROBLEMS), analysed(beside_a_row(description), PROBLEMS)
    embedded = tied.equations.embedded
    assert embedded is not None
    assert embedded.free == plain.system.coordinates
    assert all_numbers(tied, embedded.mass_matrix) == all_numbers(plain, plain.equations.mass_matrix)
    assert numbers(tied, embedded.forcing) == numbers(plain, plain.equations.forcing)
    assert tied.equilibrium.satisfied == plain.equilibrium.satisfied
    one, other = tied.optional("linearisation"), plain.optional("linearisation")
    assert (one is None) == (other is None)
    if one is not None:
        for first, second in zip(one.matrices, other.matrices, strict=True):
            assert all_numbers(tied, first) == all_numbers(plain, second)
        verdicts = [x.optional("stability") for x in (tied, plain)]
        words = [None if x is None else x.verdict.word for x in verdicts]
        assert words[0] == words[1]


@some
@given(resting())
def test_of_rests_beside_a_row(description: Description) -> None:
    compared_beside_a_row(description)


@some
@given(spinning())
def test_of_spins_beside_a_row(description: Description) -> None:
    compared_beside_a_row(description)
