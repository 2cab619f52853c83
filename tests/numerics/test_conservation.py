"""What a run is said to keep, against what mechanics says that it keeps."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conftest import SHIPPED, STATEMENTS, filed

import mbsym
from mbsym.numerics.accuracy import Lacking, NoEstimate
from mbsym.numerics.conservation import CONTRADICTION, Conservation, Doubt, Measure, Standing, confronted
from mbsym.report.documents.simulation import GeneralizedEnergy
from mbsym.report.runs.simulation_words import conservation_line, energy_lines, warnings
from mbsym.report.runs.summary import method_lines, result_lines
from mbsym.report.viewer.motion import doubts, run_sentences
from mbsym.simulation import Simulation

FORCED = """
mbsym: 1
name: An oscillator without a spring
bodies: [{name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}]
loads: [{generalized force: {x: -x}}]
initial: {x: 1}
"""

PARTICLE = """
mbsym: 1
name: Particle
parameters: {m: positive, k: real}
bodies:
  - {name: particle, attached to: 0, connection point: [x, y, 0], mass: m, coordinates: [x, y]}
loads:
  - LOAD
values: {m: 1, k: 1}
initial: {x: {position: 1, velocity: 0.3}, y: {position: 0.2, velocity: -0.4}}
"""


def particle(load: str, folder: Path, time: float = 5.0, **values: object) -> Simulation:
    path = filed(folder / "particle.yaml", PARTICLE.replace("LOAD", load))
    return mbsym.simulate(path, time, values=values, invariants=True)  # type: ignore[arg-type]


def test_a_late_pulse_and_a_soft_contact_do_work() -> None:
    """1000 N for about 2 ms at t = 5; a ground that takes energy when it is pressed in: neither keeps the energy."""
    for case in ("pulse", "contact_energy"):
        run = mbsym.simulate(STATEMENTS / f"{case}.yaml", 10)
        assert run.conservation.standing is Standing.CHANGING, case
        assert "conserved (" not in conservation_line(run.conservation)
        assert GeneralizedEnergy.from_result(run.conservation, is_="T2 - T0 - U").conserved is False


def test_the_pulse_does_work_before_it_comes() -> None:
    """At t = 0.1 the force is exp(-24 million) of its peak, and no rounding: the energy of the system changes."""
    run = mbsym.simulate(STATEMENTS / "pulse.yaml", 0.1)
    assert run.conservation.change < 1e-9
    assert run.conservation.standing is Standing.CHANGING


@pytest.mark.parametrize(
    ("load", "wanted"),
    [
        ("potential: k*x**2*y", Standing.PROVED),
        # A gyroscopic force does no work, whatever the velocities.
        ("generalized force: {x: k*y_dot, y: -k*x_dot}", Standing.PROVED),
        ("generalized force: {x: -k*x, y: -3*k*y}", Standing.CHANGING),
        ("rayleigh: k*x_dot**2*1e-30", Standing.CHANGING),
        ("generalized force: {x: 1e-9*exp(-(t - 60)**2)}", Standing.CHANGING),
        ("force function: k*x*sin(t)*1e-20", Standing.CHANGING),
        # No power: the force is normal to the velocity, but that is for the ring to see through a root.
        ("generalized force: {x: k*y_dot*sqrt(1 + x**2), y: -k*x_dot*sqrt(1 + x**2)}", Standing.PROVED),
    ],
)
def test_what_particles_keep(load: str, wanted: Standing, tmp_path: Path) -> None:
    assert particle(load, tmp_path).conservation.standing is wanted


def test_what_only_these_numbers_make_vanish(tmp_path: Path) -> None:
    """exp(k)*exp(-1) - 1 at k = 1 is no identity that the ring knows: it is seen along the run, and called so."""
    load = "generalized force: {x: (exp(k)*exp(-1) - 1)*x_dot*cos(t)}"
    run = particle(load, tmp_path)
    assert run.conservation.standing in (Standing.PROVED, Standing.VERIFIED)
    assert particle(load, tmp_path, k=1.001).conservation.standing is Standing.CHANGING


def test_two_energies_where_something_is_prescribed() -> None:
    """A ring that turns at a constant rate: T2 - T0 - U is Jacobi's integral, T - U is not kept by the motor."""
    bead = """
mbsym: 1
name: Bead on a turning ring
parameters: {m: 2, r: 0.5, g: 9.81, Omega: 6}
prescribed: {chi: {rate: Omega}}
bodies:
  - {name: ring, attached to: 0, rotation: {axes: [2], angles: [chi]}, mass: 0}
  - {name: bead, attached to: ring, connection point: [r*sin(theta), -r*cos(theta), 0], mass: m, coordinates: [theta]}
loads:
  - uniform gravity: {vector: [0, -g, 0]}
initial: {theta: {position: 1, velocity: 0.5}}
"""
    run = mbsym.simulate(mbsym.loads(bead, ()), 5)
    theta, speed = run["theta"], run["theta_dot"]
    m, r, g, rate = 2.0, 0.5, 9.81, 6.0
    moving, carried, height = (
        m * (r * speed) ** 2 / 2,
        m * (r * rate * np.sin(theta)) ** 2 / 2,
        -m * g * r * np.cos(theta),
    )
    assert np.allclose(run.energy, moving + carried + height, rtol=1e-13)
    assert np.allclose(run.generalized_energy, moving - carried + height, rtol=0, atol=1e-12)
    assert run.conservation.standing is Standing.PROVED
    assert run.energy_conservation.standing is Standing.CHANGING
    assert run.conservation.change < 1e-9
    assert run.energy_conservation.change > 0.1


def test_the_two_energies_are_one_where_nothing_is_prescribed() -> None:
    run = mbsym.simulate(SHIPPED / "double-pendulum.yaml", 1, samples=11)
    assert run.generalized_energy is run.energy
    assert run.energy_conservation is run.conservation


def test_momenta_are_held_against_the_run(tmp_path: Path) -> None:
    """A central force keeps the angular momentum about axis 3; its components along the axes are not kept."""
    run = particle("potential: k*sqrt(x**2 + y**2)", tmp_path)
    momentum = run["x"] * run["y_dot"] - run["y"] * run["x_dot"]
    kept = [item for item in run.invariants if np.allclose(item.values, momentum, rtol=1e-12)]
    assert len(kept) == 1
    assert kept[0].conservation.standing is Standing.PROVED
    assert len(run.invariants) == 1


# --- the law of a statement and its run ---


def test_nothing_but_a_proof_stands_against_a_run() -> None:
    constant, drifting, broken = np.ones(9), np.linspace(1, 2, 9), np.array([1.0, np.nan])
    for standing in Standing:
        assert confronted("I", standing, constant, 1.0).standing is standing
        assert confronted("I", standing, broken, 1.0).standing is Standing.UNDECIDED
        assert confronted("I", standing, broken, 1.0).doubt is Doubt.NO_VALUES
    assert confronted("I", Standing.VERIFIED, drifting, 1.0).standing is Standing.UNDECIDED
    assert confronted("I", Standing.VERIFIED, drifting, 1.0).doubt is Doubt.CONTRADICTED
    assert confronted("I", Standing.VERIFIED, drifting, 1.0 / CONTRADICTION).standing is Standing.VERIFIED
    assert confronted("I", Standing.CHANGING, drifting, 1.0).standing is Standing.CHANGING
    proved = confronted("I", Standing.PROVED, drifting, 1.0)
    assert proved.standing is Standing.PROVED
    assert proved.broken
    assert not confronted("I", Standing.PROVED, constant, 1.0).broken


def test_a_proof_that_a_run_breaks_is_told_as_a_mistake_of_the_run() -> None:
    """Steps of a sixth of a period: the energy of an oscillator is conserved, but not by this run."""
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 100, method="rk4", step=1.0, every=1.0)
    assert run.conservation.standing is Standing.PROVED
    assert run.conservation.broken
    assert any("does not keep it" in text for text in warnings(run.conservation, run.error))


def test_scales_are_those_of_the_motion() -> None:
    """Sampled at whole periods an oscillator seems to rest: the drift is still a part of its energy."""
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 2 * np.pi, samples=2)
    assert run.conservation.scale == pytest.approx(0.5, rel=1e-3)
    assert run.conservation.change < 1e-9


def test_words_of_each_standing() -> None:
    said = {standing: conservation_line(Conservation("energy", standing, 1e-12, 1.0)) for standing in Standing}
    of = "1.0e-12 times the largest kinetic energy"
    assert said[Standing.PROVED] == f"conserved (proved); largest drift {of}"
    assert said[Standing.VERIFIED] == f"conserved (verified numerically along this run); largest drift {of}"
    assert said[Standing.CHANGING] == f"not conserved; largest change {of}"
    assert said[Standing.UNDECIDED] == f"undecided; largest change {of}"


def test_an_oscillator_whose_spring_is_a_given_force_is_not_simply_told_to_lose_energy() -> None:
    """x'' = -x conserves x'^2/2 + x^2/2; T - U is x'^2/2 where -x is no spring but a generalised force."""
    spring = mbsym.simulate(STATEMENTS / "osc.yaml", 1)
    assert [str(what).startswith("conserved (proved)") for _, what in energy_lines(spring)] == [True]
    ((_, what),) = energy_lines(mbsym.simulate(mbsym.loads(FORCED), 1))
    assert str(what).startswith("not conserved")
    assert str(what).endswith("(U has no part of forces that are given as such)")


def test_what_a_change_is_divided_by_is_said() -> None:
    """x'' + 1000 x' + x = 0 from 1 creeps: 1/2 m v^2 is at most 5e-7 of the energy 1/2, which falls to 7e-3 of itself.

    "Largest relative change 1.0e+06" was told of it.  The energy at the end is exp(-t/500)/2 but for 1e-6 of it.
    """
    run = mbsym.simulate(STATEMENTS / "creeping-energy.yaml", 2500, estimate=False)
    wanted = 0.5 * (1 - np.exp(-5)) / run.conservation.scale
    assert run.conservation.change == pytest.approx(wanted, rel=1e-4)
    assert run.conservation.scale == pytest.approx(5e-7, rel=0.02)
    assert f"largest change {wanted:.1e} times the largest kinetic energy" in conservation_line(run.conservation)
    resting = mbsym.loads((STATEMENTS / "osc.yaml").read_text().replace("x: 1", "x: 0"))
    assert mbsym.simulate(resting, 1, estimate=False).conservation.measure is Measure.UNIT


@pytest.mark.parametrize(
    ("error", "broken"),
    [(NoEstimate(Lacking.CUT), False), (NoEstimate(Lacking.BREAKS_DOWN), False), (NoEstimate(Lacking.NOT_ASKED), True)],
)
def test_what_makes_a_run_doubtful_is_read_first(error: NoEstimate, broken: bool) -> None:
    """Not behind "conserved (proved)", which is about the equations."""
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 5, estimate=False)
    kept = replace(run.conservation, change=0.5 if broken else 1e-9)
    doubtful = replace(run, error=error, conservation=kept, energy_conservation=kept)
    lines = [text for _, text in result_lines(doubtful, "osc.yaml")]
    for told in (lines, [*doubts(doubtful), *run_sentences(doubtful)]):
        assert ("does not keep it" if broken else error.why.value) in told[0]
        assert sum("conserved (proved)" in text for text in told[1:]) == 1
    assert "tolerance" in [text for _, text in method_lines(run)][1]


def test_what_other_motions_change_may_be_constant_along_this_one() -> None:
    """ "not conserved; largest relative change 0" was told of a bead that rests at the bottom of a turning hoop."""
    told = conservation_line(Conservation("energy", Standing.CHANGING, 0.0, 1.0))
    assert told == "not conserved in general; constant along this run"


def test_what_is_advised_to_a_method_with_steps_of_one_length_is_of_its_own() -> None:
    """It takes no --tolerance, and "--method rk4 with a small --step" was what had been asked for already."""
    run = mbsym.simulate(STATEMENTS / "osc.yaml", 100, method="rk4", step=1.0, every=1.0)
    (advice,) = [text for text in warnings(run.conservation, run.error) if "does not keep it" in text]
    assert "a smaller --step" in advice
    assert "rk4" not in advice


RESTING = """
mbsym: 1
name: Particle whose damper has nothing to do
bodies:
  - {name: particle, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - spring: {coordinate: x, stiffness: 1}
  - spring: {coordinate: y, stiffness: 4}
  - damper: {coordinate: y, coefficient: 1}
initial: {x: 1, y: START}
"""


@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize(("start", "wanted"), [("0", Standing.VERIFIED), ("1e-9", Standing.CHANGING)])
def test_a_damper_on_a_coordinate_that_rests_takes_nothing(
    start: str, wanted: Standing, whole: bool, tmp_path: Path
) -> None:
    """x = cos t and y = 0: T - U = 1/2 for ever.  Displaced by whatever little, y loses its energy to the damper."""
    path = filed(tmp_path / "particle.yaml", RESTING.replace("START", start))
    assert mbsym.simulate(path, 5, whole=whole).conservation.standing is wanted


# --- between rows ---

SOFT_GROUND = """
mbsym: 1
name: Ball on soft ground, a force where z < 0 alone
parameters: {k: 1e4, d: 1/20000, g: 10}
bodies:
  - {name: ball, attached to: 0, connection point: [0, 0, z], mass: 1, coordinates: [z]}
loads:
  - uniform gravity: {vector: [0, 0, -g]}
  - generalized force: {z: "k*(sqrt(z**2) - z)/2*(1 - d*z_dot)"}
initial: {z: 1}
"""


@pytest.mark.parametrize("rows", [2, 3, 11, 2001])
def test_a_force_between_rows_is_seen(rows: int) -> None:
    """It touches the ground at t = sqrt(1/5) for 0.03 of time; at two rows, t = 0 and 0.9, nothing pushes it."""
    run = mbsym.simulate(mbsym.loads(SOFT_GROUND, ()), 0.9, samples=rows, method="dop853")
    assert run.conservation.standing is Standing.CHANGING
    assert run.conservation.change > 0.5, "the energy of the compressed ground is none of T - U"


def test_a_planted_blindness_between_rows_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Negative control: judged at its rows alone the same run is called conserved, beside a loss of 3e-4."""
    monkeypatch.setattr("mbsym.simulation.run.between_rows", lambda dynamics, found, method, scalar: found)
    run = mbsym.simulate(mbsym.loads(SOFT_GROUND, ()), 0.9, samples=2, method="dop853")
    assert run.conservation.standing is Standing.VERIFIED
    assert run.conservation.change > 1e-4


def test_a_late_force_is_seen_however_few_rows_there_are() -> None:
    """x'' = -x + exp(-(t - 5)^2 100)/1e5 has the power x' F, not zero at any time but 1e-1086 at both rows."""
    text = (
        "mbsym: 1\nname: late\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\n"
        "loads:\n  - potential: x**2/2\n  - generalized force: {x: exp(-((t - 5)*10)**2)/100000}\ninitial: {x: 1}\n"
    )
    for rows in (2, 5, 100):
        run = mbsym.simulate(mbsym.loads(text), 10, samples=rows)
        assert run.conservation.standing is Standing.CHANGING


def test_the_drift_is_that_of_the_whole_interval() -> None:
    """Between the steps of the midpoint rule, which keep h, a curve is drawn that does not, however few the rows."""
    found = [
        mbsym.simulate(
            STATEMENTS / "osc.yaml", 4 * np.pi, samples=rows, method="midpoint", step=0.1
        ).conservation.change
        for rows in (3, 5, 2001)
    ]
    assert found == pytest.approx([found[2]] * 3, rel=0.05)
    assert found[2] > 1e-10


@pytest.mark.parametrize(("start", "end"), [(5, 5.002), (5.003, 5.005)])
def test_a_push_between_two_rows_is_seen(start: float, end: float) -> None:
    """x'' = -x + 500 for 2 ms: no row sees its power, 500 x', and yet it is there; without it energy is an integral."""
    text = (
        "mbsym: 1\nname: pushed\nbodies:\n"
        "  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}\nloads:\n"
        f"  - potential: x**2/2\n  - generalized force:\n      x: FORCE*pulse(t, {start}, {end})\ninitial: {{x: 1}}\n"
    )
    pushed = mbsym.simulate(mbsym.loads(text.replace("FORCE", "500")), 20)
    assert pushed.conservation.standing is Standing.CHANGING
    still = mbsym.simulate(mbsym.loads(text.replace("FORCE", "0")), 20)
    assert still.conservation.standing is Standing.PROVED


def test_where_there_is_nothing_to_watch_that_is_said() -> None:
    # Henon and Heiles: no integral beside the energy is known of it; the heavy top has momenta.
    for name, none in (("henon-heiles", True), ("heavy-top", False)):
        run = mbsym.simulate(SHIPPED / f"{name}.yaml", 0.1, samples=3, estimate=False, invariants=True)
        assert ("none is known beside the energy" in run.no_invariants) is none is (not run.invariants)


def test_a_run_that_ends_where_it_begins_verifies_nothing() -> None:
    """One value of a quantity does not change; that it does not is no finding."""
    found = confronted("energy", Standing.VERIFIED, np.array([2.0]), 1.0)
    assert (found.standing, found.doubt) == (Standing.UNDECIDED, Doubt.NO_MOTION)
    assert confronted("energy", Standing.PROVED, np.array([2.0]), 1.0).standing is Standing.PROVED
    assert confronted("energy", Standing.VERIFIED, np.array([2.0, 2.0]), 1.0).standing is Standing.VERIFIED


@pytest.mark.parametrize(("coefficient", "told"), [("1e-15", False), ("1e-7", True)])
@pytest.mark.parametrize("away", [0, 1000])
@pytest.mark.parametrize("estimate", [True, False])
def test_a_change_that_is_less_than_the_error_is_not_told_as_one(
    away: int, coefficient: str, told: bool, estimate: bool
) -> None:
    """x'' + c x' + x - a = 0 loses about c t of the largest kinetic energy: 1e-14 and 1e-6 up to t = 10.

    The error is near 1e-11 of x.  About a = 1000 that is a larger part of x - a, and of the energy: the change in the
    run is six times the error then, and nothing of it is real.  Without an estimate a step's tolerance stands for it.
    """
    run = mbsym.simulate(
        mbsym.loads(
            FORCED.replace(
                "{generalized force: {x: -x}}",
                "{damper: {coordinate: x, "
                f"coefficient: {coefficient}}}}}, {{spring: {{coordinate: x, stiffness: 1, rest: {away}}}}}",
            ).replace("x: 1}", f"x: {away + 1}}}")
        ),
        10,
        estimate=estimate,
    )
    ((_, line),) = energy_lines(run)
    assert ("largest change" in str(line)) is told
    assert ("is not told from its error" in str(line)) is not told
