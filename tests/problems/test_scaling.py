"""Dimensionless groups: those that textbooks name, and that the system in groups is the system, divided through."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest
from conftest import SHIPPED, invoked

import mbsym
from mbsym.analysis import Analysis
from mbsym.analysis.in_groups import group_of, in_groups, product
from mbsym.expressions.tree import substitute, text
from mbsym.model.system import rational
from mbsym.problems.scaling import Group, Groups, groups, linear_groups
from mbsym.problems.stability.problem import prepared_parts


def analysed(name: str) -> Analysis:
    return mbsym.load(SHIPPED / f"{name}.yaml")


def found(name: str) -> Groups:
    analysis = analysed(name)
    return groups(analysis.scene, analysis.equations)


def linear(name: str) -> Groups:
    a = analysed(name)
    parts = prepared_parts(a.parameters_scene, a.balance, a.judgeable, a.equilibrium, a.signs)
    return linear_groups(a.parameters_scene, [(part.ring, part.system) for part in parts])


def told(one: Group) -> str:
    return text(group_of(one.parameter, one.powers))


def test_the_double_pendulum_has_two_ratios() -> None:
    there = found("double-pendulum")
    assert [told(one) for one in there.groups] == ["m2/m1", "l2/l1"]
    assert there.units == ("m1", "l1", "g")
    assert there.rate == (("l1", Fraction(-1, 2)), ("g", Fraction(1, 2)))


def test_the_upright_top_has_one_number() -> None:
    """Majewski's condition C^2 Omega^2 > 4 A m g l (Magnus, Kreisel, 1971): only A m g l/(C Omega)^2 matters."""
    (only,) = linear("heavy-top").groups
    assert dict([(only.parameter, Fraction(1)), *only.powers]) == {"A": 1, "m": 1, "g": 1, "l": 1, "C": -2, "Omega": -2}
    assert len(found("heavy-top").groups) == 2


def test_the_satellite_in_the_papers_notation() -> None:
    """Formula (4) of the paper: alpha, gamma, p1, p2; the orbit's radius and the satellite's mass do not matter."""
    assert [one.parameter for one in linear("satellite").groups] == ["alpha", "gamma", "p1", "p2"]
    there = found("satellite")
    assert set(there.idle) == {"R", "M2"}
    assert len(there.groups) == 5
    assert [one.parameter for one in linear("gravity-gradient").groups] == ["B", "C"]


def test_a_length_is_measured_in_lengths() -> None:
    there = found("spring-pendulum")
    assert [(one.parameter, text(product(one.powers))) for one in there.lengths] == [("r", "l0")]
    assert [told(one) for one in there.groups] == ["g*m/(k*l0)"]


@pytest.mark.parametrize(
    "name", ["double-pendulum", "satellite", "spring-pendulum", "heavy-top", "ziegler-damped", "cartesian-pendulum"]
)
def test_the_system_in_groups_has_the_same_roots_in_its_own_time(name: str) -> None:
    """lambda' = lambda/rate, exactly: the characteristic polynomials at the values agree coefficient by coefficient."""
    analysis = analysed(name)
    there = groups(analysis.scene, analysis.equations)
    reduced = Analysis(in_groups(analysis.system, there))
    values = {x.name: x.value for x in analysis.system.parameters if x.value is not None}
    assert there.rate is not None
    rate = substitute(product([(unit, 2 * power) for unit, power in there.rate]), values)
    square = rational(rate)
    assert square is not None
    own = sorted(root for spectrum in analysis.stability.spectra for root in sizes(spectrum))
    new = sorted(root for spectrum in reduced.stability.spectra for root in sizes(spectrum))
    assert [x / float(square) for x in own] == pytest.approx(new, rel=1e-12, abs=1e-12)
    assert analysis.stability.numerical.word == reduced.stability.numerical.word  # type: ignore[union-attr]


def sizes(spectrum: mbsym.problems.stability.enclosed.Spectrum) -> list[float]:
    """|lambda|^2 of every root."""
    return [float((x.ball.real * x.ball.real + x.ball.imag * x.ball.imag).mid()) for x in spectrum.roots]


def test_a_wrong_group_is_noticed() -> None:
    """With g for g/l0 the roots are others: the comparison above is no tautology."""
    analysis = analysed("spring-pendulum")
    there = groups(analysis.scene, analysis.equations)
    wrong = Groups(
        there.free, there.idle, there.units, (Group("g", (("l0", Fraction(-1)),)),), there.rate, there.lengths
    )
    right = Analysis(in_groups(analysis.system, there)).stability.spectra
    assert sizes(right[0]) != pytest.approx(sizes(Analysis(in_groups(analysis.system, wrong)).stability.spectra[0]))


def test_the_command_writes_a_description_that_runs(tmp_path: Path) -> None:
    out = tmp_path / "groups.yaml"
    done = invoked("groups", SHIPPED / "spring-pendulum.yaml", "--out", out, code=0)
    assert "g stands for g*m/(k*l0)" in done.output
    again = invoked("groups", out)
    assert "g = 1" not in again.output  # what is a group stays one
    assert "1 parameter, 0 of them set to 1: 1 group" in again.output


@pytest.mark.parametrize("name", ["rolling-disc", "rolling-disc-speeds"])
def test_a_rolling_disc_has_one_number(name: str) -> None:
    """r w^2/g, Froude's number: upright rolling is stable for 3 r w^2 > g (Neimark and Fufaev, chapter 5)."""
    there = found(name)
    assert there.units == ("m", "r", "g")
    assert [told(one) for one in there.groups] == ["w*sqrt(r/g)"]
    assert [one.parameter for one in there.lengths][:2] == ["x", "y"]


def test_a_linkage_has_the_ratios_of_its_lengths() -> None:
    """In its closure every term is a length; without gravity there is nothing that measures the time."""
    there = found("four-bar")
    assert [told(one) for one in there.groups] == ["l2/l1", "l3/l1", "l4/l1"]
    assert not there.rate


def test_a_constraint_ties_what_the_equations_leave_apart(tmp_path: Path) -> None:
    """Two bodies that nothing joins may be measured in two lengths; with a rod of length d between them in one."""
    text = (
        "mbsym: 1\nname: two\nparameters: {m: positive, k: positive, d: positive, a: positive, b: positive}\nbodies:\n"
        "  - {name: one, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}\n"
        "  - {name: other, attached to: 0, connection point: [0, y, 0], mass: m, coordinates: [y]}\n"
        "loads: [{potential: k*(x - a)**4 + k*(y - b)**4}]\n"
    )
    free = mbsym.loads(text)
    there = groups(free.scene, free.equations)
    assert [told(one) for one in there.groups] == ["b/a"]
    tied = mbsym.loads(text + "constraints:\n  - relation: x**2 + y**2 = d**2\n")
    there = groups(tied.scene, tied.equations)
    assert [told(one) for one in there.groups] == ["a/d", "b/d"]


def test_what_may_vanish_is_not_set_to_1_and_scalings_left_over_are_told(tmp_path: Path) -> None:
    """m x'' + b x' + k x = 0 has one number, b^2/(k m), where k does not vanish; with k, b of any sign two are left."""
    text = (
        "mbsym: 1\nname: Block\nparameters: {k: real, b: real, m: positive}\nbodies:\n"
        "  - {name: block, attached to: 0, connection point: [x, 0, 0], coordinates: [x], mass: m}\n"
        "loads:\n  - spring: {coordinate: x, stiffness: k, rest: 0}\n  - damper: {coordinate: x, coefficient: b}\n"
        "motion: {x: 0}\n"
    )
    (tmp_path / "block.yaml").write_text(text)
    (tmp_path / "positive.yaml").write_text(text.replace("real", "positive"))
    told = {}
    for name in ("block", "positive"):
        analysis = mbsym.load(tmp_path / f"{name}.yaml")
        told[name] = groups(analysis.scene, analysis.equations)
    assert len(told["positive"].groups) == 1
    assert told["positive"].unused == 0
    assert (told["block"].units, told["block"].unused, len(told["block"].groups)) == (("m",), 1, 2)
    # With k as it is, m -> s m needs t -> sqrt(s) t: b/sqrt(m) does not change.
    assert {one.parameter: dict(one.powers) for one in told["block"].groups} == {"k": {}, "b": {"m": Fraction(-1, 2)}}
    done = invoked("groups", tmp_path / "block.yaml")
    assert "at most 2 groups" in done.output
    assert "1 scaling more is not used" in done.output
