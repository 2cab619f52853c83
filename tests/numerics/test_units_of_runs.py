"""The units of mass, length and time that a description is written in change nothing of a run but its numbers."""

from __future__ import annotations

import warnings
from contextlib import nullcontext, suppress
from dataclasses import replace
from fractions import Fraction as F
from functools import cache
from math import atan, cos, exp, inf, pi, sqrt
from operator import attrgetter
from typing import Any

import mpmath
import numpy as np
import pytest
from conftest import system_of

from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import number
from mbsym.model.system import System
from mbsym.model.units import TIME, Dimension, times
from mbsym.numerics.accuracy import ErrorEstimate
from mbsym.numerics.closing import closed
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.enclosure.field import NotAnalytic
from mbsym.numerics.ensembles import side_by_side
from mbsym.numerics.ensembles.ensemble import OneByOne, WithParameters
from mbsym.numerics.ensembles.parametrised import Parametrised
from mbsym.numerics.events.switching import rates
from mbsym.numerics.inverse import inverse_constrained
from mbsym.numerics.methods import runge_kutta
from mbsym.numerics.methods.interface import Cause, Setting, within_bound
from mbsym.numerics.methods.magnitudes import Magnitudes, about
from mbsym.numerics.methods.table import METHODS
from mbsym.numerics.orbits.lyapunov import exponents
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.scenario import Scenario, scenario
from mbsym.numerics.simulate import _undefined
from mbsym.numerics.states import state_names
from mbsym.simulation import Request, Simulation, simulate
from mbsym.simulation.accurate import plan_for
from mbsym.simulation.motions import find_orbit
from tests.numerics.test_adjoint import expression
from tests.source.test_units_of_systems import SYSTEMS, UNITS

#: How many of each unit kg, m and s are: mm, g and ms; lengths in microns and in thousands of kilometres; nanoseconds.
OTHER = {
    "mm-g-ms": (F(1000), F(1000), F(1000)),
    "microns": (F(1), F(10**6), F(1)),
    "megametres": (F(1), F(1, 10**6), F(1)),
    "milliseconds": (F(1), F(1), F(1000)),
}

#: Estimated errors below this are roundings, which differ from unit to unit.
ROUNDINGS = 1e-13


def described(name: str) -> System:
    """A system that comes with mbsym, with the units of its quantities."""
    text = (SYSTEMS / f"{name}.yaml").read_text("utf-8")
    plain = system_of(text, f"{name}.yaml")
    speeds = set(plain.variables) - set(plain.coordinates)  # their units follow
    given = "".join(f"  {symbol}: {unit}\n" for symbol, unit in UNITS[name].items() if symbol not in speeds)
    return system_of(f"{text}\nunits:\n{given}", f"{name}.yaml")


def factor(of: Dimension, units: tuple[F, F, F]) -> float | F:
    """How many of the other unit one of SI's is."""
    found: Any = F(1)
    for base, exponent in of:
        value = units[("kg", "m", "s").index(base)] ** exponent
        found = found * (value if isinstance(value, F) else F(value))
    return found


def factors(system: System, units: tuple[F, F, F]) -> dict[str, Any]:
    """By name of a quantity, and of its rate."""
    known = dict(system.units.inferred)
    names = [*system.coordinates, *system.parameter_names, *(one.name for one in system.prescribed)]
    names += [name for name in system.variables if name in known]  # unit vectors have no dimension
    missing = [name for name in names if name not in known]
    if missing:
        pytest.skip(f"no dimension follows for {', '.join(missing)}")
    found = {name: factor(known[name], units) for name in names}
    return found | {velocity_name(name): factor(times(known[name], TIME, -1), units) for name in names}


def rescaled(given: Scenario, units: tuple[F, F, F]) -> Scenario:
    """The same numbers in other units."""
    by, system = factors(given.system, units), given.system
    declared = [name for names in state_names(system) for name in names] if given.declared else []
    return replace(
        given,
        parameters={name: value * by[name] for name, value in given.parameters.items()},
        positions=tuple(x * by[name] for name, x in zip(system.coordinates, given.positions, strict=True)),
        velocities=tuple(
            x * by[velocity_name(name)] for name, x in zip(system.coordinates, given.velocities, strict=True)
        ),
        prescribed={
            name: (value * by[name], rate * by[velocity_name(name)]) for name, (value, rate) in given.prescribed.items()
        },
        declared=tuple(x * by[name] for name, x in zip(declared, given.declared, strict=True)),
        typed={},
    )


def run(given: Scenario, time: Any, method: str = "auto", **more: Any) -> Simulation:
    return simulate(given, Request(time=float(time), samples=101, method=method, **more))


def assert_alike(one: Simulation, other: Simulation, steps: float = 0.02) -> None:
    """The same method, steps, digits and what is said of the energy."""
    assert other.chosen.method.traits.name == one.chosen.method.traits.name
    assert other.conservation.standing == one.conservation.standing
    made = one.trajectory.work.steps, other.trajectory.work.steps
    assert abs(made[0] - made[1]) <= 1 + steps * max(made), made
    assert isinstance(one.error, ErrorEstimate) == isinstance(other.error, ErrorEstimate)
    if isinstance(one.error, ErrorEstimate) and isinstance(other.error, ErrorEstimate):
        first, second = one.error.largest, other.error.largest
        # Roundings may make one step more, with other errors than those of the same steps.
        within = 2 if made[0] == made[1] else 10
        assert max(first, ROUNDINGS) <= within * max(second, ROUNDINGS), (first, second)
        assert max(second, ROUNDINGS) <= within * max(first, ROUNDINGS), (first, second)


@cache
def as_described(name: str) -> tuple[Scenario, Simulation]:
    """A system in its own units, and its motion over 2 seconds."""
    given = scenario(described(name))
    return given, run(given, 2)


def test_roundings_of_a_turned_start_rule_no_sizes() -> None:
    """Unit vectors with components like 1e-78, as phi = pi/2 leaves them, have the size 1; the spin is fastest."""
    dynamics = run(scenario(described("gyrostat-poisson")), 1e-3).dynamics
    state = np.array(dynamics.scenario.state, dtype=float)
    turned = [name[:-1] in ("alpha", "beta", "gamma") for name in dynamics.inputs[1 : 1 + dynamics.dimension]]
    assert sum(turned) == 9
    assert np.min(np.abs(state[turned][state[turned] != 0])) < 1e-60
    assert np.allclose(about(dynamics, 0.0, state).sizes[turned], 1.0)
    spin = 200.0
    assert spin == pytest.approx(rates(dynamics)[1], rel=0.01)


#: Every system in mm, g and ms, and in one of the others.
CHOSEN = [(name, "mm-g-ms") for name in sorted(UNITS)]
CHOSEN += [(name, ("microns", "megametres", "milliseconds")[k % 3]) for k, name in enumerate(sorted(UNITS))]


@pytest.mark.parametrize(("name", "units"), sorted(CHOSEN))
def test_a_system_runs_alike_in_all_units(name: str, units: str) -> None:
    given, known = as_described(name)
    # Where forces jump every piece may take a step more.
    steps = 0.1 if Dynamics(given).features.switches.outputs else 0.02
    assert_alike(known, run(rescaled(given, OTHER[units]), 2 * OTHER[units][2]), steps)


#: Certificates of these are over a tenth of the time, and to fewer digits: that is a minute otherwise.
LONG = {"gyrostat", "rolling-disc-speeds", "rolling-sphere-speeds"} | {x for x in UNITS if x.startswith("satellite")}

#: Its mass matrix is eliminated with cancellation, for which balls pay: a certified step is 1e-5 s, in every unit, and
#: half a second would be two hundred thousand of them: a counted budget ends it, at the same place in every unit.
BUDGETS = {"tethered-satellites": 20.0}

#: In units of powers of two a bicycle's bound is the same to its last digit (below).  In others sizes and first rates
#: agree to 1e-14, but some of its 22 steps end a little elsewhere: another speed errs most, by up to 1.3 times as much.
ROUNDED = {"bicycle": 0.5}


@pytest.mark.parametrize("name", sorted(UNITS))
def test_choices_and_bits_are_the_same_in_all_units(name: str) -> None:
    """What --accuracy takes, what bound it names, and how a certificate comes about."""
    given = scenario(described(name))
    kinds = [(given, F(1)), *((rescaled(given, OTHER[units]), OTHER[units][2]) for units in ("mm-g-ms", "microns"))]
    first, *others = (plan_for(one, Request(float(2 * unit), samples=101), Accuracy(1e-6))[0] for one, unit in kinds)
    chosen = attrgetter("method", "scalar", "setting.step", "model", "reached")
    for plan in others:
        assert chosen(plan) == chosen(first)
        assert plan.setting.tolerance == pytest.approx(first.setting.tolerance, rel=0.1)
        assert plan.bound.total == pytest.approx(first.bound.total, rel=ROUNDED.get(name, 0.2))
    part, width = (20, 1e-6) if name in LONG else (2, 1e-10)
    limit = BUDGETS.get(name, inf)
    certified, *same = (enclosed(one, float(unit) / part, width, limit) for one, unit in kinds)
    assert same == [certified, certified]
    assert certified is None or certified[1:3] == (name not in BUDGETS, True)


def test_of_single_precision_all_that_is_finite_is_within_the_bound() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = within_bound(np.array([[1e38, np.inf, np.nan, 0.0]], dtype=np.float32))
    assert found.tolist() == [True, False, False, True]


def test_powers_of_two_change_no_digit_of_a_bound() -> None:
    given, unit = scenario(described("bicycle")), F(2) ** 10
    kinds = (given, 1), (rescaled(given, (unit, unit, unit)), 1024)
    plans = [plan_for(one, Request(2.0 * time, samples=101), Accuracy(1e-6))[0] for one, time in kinds]
    assert plans[1].bound == plans[0].bound


def enclosed(given: Scenario, time: float, width: float, limit: float) -> tuple[int, bool, bool, str] | None:
    """(bits, whole, narrow, the part of the time) of a certificate; None where the equations have no power series."""
    with suppress(NotAnalytic):
        request = Request(time, samples=11, certify=width, estimate=False, certify_limit=limit)
        found = simulate(given, request).certificate
        assert found is not None
        return found.enclosure.bits, found.whole, found.narrow, f"{found.enclosure.reached / time:.6g}"
    return None


SPRING = described("spring-pendulum")


@pytest.mark.parametrize("units", OTHER)
@pytest.mark.parametrize("method", [name for name in METHODS if not METHODS[name].traits.fixed])
def test_every_method_takes_the_same_steps(method: str, units: str) -> None:
    """ODEPACK's order and steps hang on roundings more than others do."""
    given, tolerance = scenario(SPRING), 1e-8 if METHODS[method].traits.implicit else 1e-10
    found = [METHODS[method].start(Dynamics(one), Setting(tolerance)) for one in (given, rescaled(given, OTHER[units]))]
    ends = [one.advance(float(3 * unit)) for one, unit in zip(found, (F(1), OTHER[units][2]), strict=True)]
    by = factors(SPRING, OTHER[units])
    names = (*SPRING.coordinates, *map(velocity_name, SPRING.coordinates))
    far = 1e-4 if METHODS[method].traits.implicit else 1e-8
    assert ends[1] / np.array([float(by[name]) for name in names]) == pytest.approx(ends[0], rel=far, abs=far)
    steps = [one.work.steps for one in found]
    assert abs(steps[0] - steps[1]) <= (0.3 if method == "lsoda" else 0.02) * max(steps), steps


@pytest.mark.parametrize("power", [-40, 40])
def test_powers_of_two_change_no_digit(power: int) -> None:
    """All is exact then: the states are the same bit for bit but for the unit."""
    given, unit = scenario(SPRING), F(2) ** power
    other = rescaled(given, (unit, unit, F(1)))
    ends = [METHODS["dop853"].start(Dynamics(one), Setting(1e-10)).advance(3.0) for one in (given, other)]
    by = factors(SPRING, (unit, unit, F(1)))
    names = (*SPRING.coordinates, *map(velocity_name, SPRING.coordinates))
    assert (ends[1] / np.array([float(by[name]) for name in names]) == ends[0]).all()


# --- constraints, and what single motions are like, in units in which lengths are 1e-9 or less ---

#: Nanometres written in metres, and lengths of 1e12.
FAR_UNITS = {"lengths 1e-12": (F(1), F(1, 10**12), F(1)), "lengths 1e12": (F(1), F(10**12), F(1))}


@cache
def apart_from_its_rows(name: str) -> Scenario:
    """A system a thousandth off its constraints."""
    given = scenario(described(name))
    return replace(given, positions=tuple(x * (1 + F(k, 1000)) for k, x in enumerate(given.positions, start=-1)))


@pytest.mark.parametrize("units", FAR_UNITS.values(), ids=FAR_UNITS)
@pytest.mark.parametrize("name", ["cartesian-pendulum", "four-bar", "rolling-disc", "snakeboard", "turntable-sphere"])
def test_what_constraints_hold_and_move_is_the_same_in_all_units(name: str, units: tuple[F, F, F]) -> None:
    """The values that had to move, the rows that say something, and whether more is held than these tell."""
    first = closed(apart_from_its_rows(name))
    other = closed(rescaled(apart_from_its_rows(name), units))
    assert [move.name for move in other.moves] == [move.name for move in first.moves]
    ones, others = (Dynamics(one.scenario).constraints for one in (first, other))
    assert ones is not None
    assert others is not None
    assert others.kept == ones.kept
    assert others.more_is_held == ones.more_is_held


def test_what_swings_by_less_than_1e_12_of_a_metre_is_no_rest() -> None:
    given = rescaled(scenario(described("cartesian-pendulum")), (F(1), F(1, 10**13), F(1)))
    assert not exponents(Dynamics(given), 2.0, 0.1, 1).resting


BESIDE = """
mbsym: 1
name: two masses on springs, one of half the frequency
parameters: {m: positive, k: positive}
bodies:
  - {name: a, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}
  - {name: b, attached to: 0, mass: m, connection point: [0, y, 0], coordinates: [y]}
loads: [{spring: {coordinate: x, stiffness: 4*k}}, {spring: {coordinate: y, stiffness: k}}]
motion: {x: 0, y: 0}
values: {m: 1, k: 1}
"""


@pytest.mark.parametrize("unit", [1.0, 1e-12])
@pytest.mark.parametrize(("y", "times"), [(0.1, 1), (0.0, 2)])
def test_a_motion_runs_through_itself_as_often_in_all_units(unit: float, y: float, times: int) -> None:
    """x = a cos(2 t) runs through itself twice in 2 pi, beside y = b cos(t) it does not."""
    given = from_text(f"{BESIDE}initial: {{x: {unit!r}, y: {y * unit!r}}}\n")
    assert find_orbit(given, 6.2831853, keep="nothing").repeats == times


@pytest.mark.parametrize("unit", [F(1), F(1, 10**12)], ids=str)
@pytest.mark.parametrize("part", ["1", "1.01"])
def test_a_motion_off_its_constraints_is_refused_in_all_units(unit: F, part: str) -> None:
    """x = L cos(t), y = L sin(t) is on the circle, and with 1.01 L sin(t) it is not."""
    motion = {"x": expression("L*cos(t)"), "y": expression(f"{part}*L*sin(t)")}
    times = np.linspace(0, 2, 5)
    with nullcontext() if part == "1" else pytest.raises(ValueError, match="does not satisfy"):
        inverse_constrained(described("cartesian-pendulum"), motion, {"L": number(unit)}, times)


ROOT = """
mbsym: 1
name: a force that ends
parameters: {L: positive}
bodies: [{name: mass, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]
loads: [{generalized force: {x: -L*sqrt(x/L + 1)}}]
values: {L: 1}
"""


@pytest.mark.parametrize("unit", [F(1), F(1, 10**9), F(10**9)], ids=str)
@pytest.mark.parametrize(("away", "near"), [(F(2), False), (F(1, 100), True)])
def test_how_near_the_end_of_a_domain_is_depends_on_no_unit(unit: F, away: F, near: bool) -> None:
    """x'' = -L sqrt(x/L + 1), from x = (away - 1) L with x' = -L."""
    system = system_of(ROOT)
    values = {"L": unit, "x": (away - 1) * unit, "x_dot": -unit}
    given = scenario(system, {name: number(value) for name, value in values.items()})
    state = np.array([float(x) for x in given.state])
    assert _undefined(Dynamics(given), 0.0, state, np.append(0.0, state)[:, None]) is near


BELT = """
mbsym: 1
name: a block on a belt
parameters: {L: positive}
bodies: [{name: mass, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}]
loads: [{generalized force: {x: FORCE}}]
values: {L: 1}
initial: {x: 0}
""".replace("FORCE", "-x - L*sign(x_dot - L/2)")


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
def test_a_block_leaves_its_belt_at_the_same_time_in_all_units(unit: float) -> None:
    """x'' = -x + L up to x' = L/2 at pi/6, carried along up to x = L, where friction is used up, and x'' = -x + L.

    Friction that is not linear in the sign holds it in no unit.
    """
    text = BELT.replace("L: 1}", f"L: {unit!r}}}")
    found = run(from_text(text), 12, estimate=False).trajectory
    assert found.breakdown is None
    t, first = found.times, np.pi / 6
    begun = 1 - np.cos(first)
    last = first + 2 * (1 - begun)
    carried = np.where(t < last, begun + (t - first) / 2, 1 + np.sin(t - last) / 2)
    assert found.states[0] / unit == pytest.approx(np.where(t < first, 1 - np.cos(t), carried), abs=1e-9)
    bent = from_text(text.replace("L/2)", "L/2) - L*sign(x_dot - L/2)**2/5"))
    ended = run(bent, 12, estimate=False).trajectory.breakdown
    assert ended is not None
    assert "no force between the two sides holds it there" in str(ended)


# --- sizes ---


def of_scene(given: Scenario) -> Magnitudes:
    return about(Dynamics(given), 0.0, [float(x) for x in given.state])


def from_text(text: str) -> Scenario:
    system = system_of(text)
    return scenario(system)


OSCILLATOR = """
mbsym: 1
name: oscillator
parameters: {m: positive, k: positive}
bodies: [{name: mass, attached to: 0, mass: m, connection point: [x, 0, 0], coordinates: [x]}]
loads: [{spring: {coordinate: x, stiffness: k}}]
motion: {x: 0}
"""


@pytest.mark.parametrize("unit", [1.0, 1e-9, 1e9])
def test_sizes_follow_from_rates(unit: float) -> None:
    """x'' = -25 x, displaced to 9/8 x0:  F = 25 9/8 x0,  tau = sqrt(x0/F),  V = F tau."""
    known = _known({"x": unit})
    (size, speed), (time,) = known.sizes[:, 0], known.times
    assert size == unit
    assert speed == pytest.approx(5 * sqrt(9 / 8) * unit, rel=1e-12)
    assert time == pytest.approx(1 / (5 * sqrt(9 / 8)), rel=1e-12)


def _known(initial: dict[str, float]) -> Magnitudes:
    values = "".join(f"{name}: {value!r}, " for name, value in initial.items())
    return of_scene(from_text(f"{OSCILLATOR}values: {{m: 4, k: 100}}\ninitial: {{{values}}}\n"))


def test_what_rests_where_nothing_pushes_it_is_measured_by_1() -> None:
    assert _known({"x": 0}).sizes.tolist() == [[1], [1]]


@pytest.mark.parametrize("unit", [F(1), F(1000), F(1, 60)], ids=str)
def test_a_push_from_rest_at_0_has_the_time_of_its_spring(unit: F) -> None:
    """m x'' = F0 - k x - c x':  sqrt(m/k), without a spring m/c; sizes F0/k and F0 m/c^2."""
    loads = "loads: [{generalized force: {x: 3 - k*x - c*x_dot}}]\nmotion: {x: 0}\n"
    for k, c, time in ((100, 1, 0.2), (0, 2, 2.0)):
        text = OSCILLATOR[: OSCILLATOR.index("loads")].replace("k: positive", "k: real, c: real") + loads
        given = from_text(f"{text}values: {{m: 4, k: {k}, c: {c}}}\ninitial: {{x: 0}}\n")
        by = {"k": unit**-2, "c": unit**-1}
        other = replace(given, parameters={name: x * by.get(name, 1) for name, x in given.parameters.items()})
        known = of_scene(other)
        assert known.times == pytest.approx(time * float(unit), rel=1e-3)
        assert known.sizes[0, 0] == pytest.approx(3 / 4 * (time * float(unit)) ** 2, rel=1e-3)


AGAINST = """
mbsym: 1
name: two pendulums on a cart
parameters: {M: positive, m: positive, l: positive, g: positive}
bodies:
  - {name: cart, attached to: 0, mass: M, connection point: [x, 0, 0], coordinates: [x]}
  - {name: left, attached to: cart, mass: m, connection point: [l*sin(a), -l*cos(a), 0], coordinates: [a]}
  - {name: right, attached to: cart, mass: m, connection point: [l*sin(b), -l*cos(b), 0], coordinates: [b]}
loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}]
motion: {x: 0, a: 0, b: 0}
values: {M: 1, m: 1, l: 1, g: 9.81}
initial: {x: 0, a: 1, b: -1}
"""


@pytest.mark.parametrize("method", ["dop853", "rk45", "taylor", "scipy-dop853"])
def test_a_cart_that_rests_but_for_rounding_rules_no_step(method: str) -> None:
    """One pendulum of the same motion, its point of suspension held, takes as many steps."""
    given = from_text(AGAINST)
    run = METHODS[method].start(Dynamics(given), Setting(1e-10))
    x, *_ = run.advance(20.0)
    assert abs(x) < 1e-12
    alone = from_text(AGAINST.replace("b: -1", "b: 0").replace("M: 1,", "M: 1e15,"))
    beside = METHODS[method].start(Dynamics(alone), Setting(1e-10))
    beside.advance(20.0)
    assert run.work.steps + run.work.rejected < 1.5 * (beside.work.steps + beside.work.rejected)


# --- members side by side; choices ---


def test_members_side_by_side_take_the_same_steps() -> None:
    given, units = scenario(SPRING), (F(1000), F(1, 10**6), F(1000))
    made = side_by_side.compiled(Dynamics(given), side_by_side.TABLEAUX["dop853"])
    steps = []
    for one, unit in ((given, F(1)), (rescaled(given, units), units[2])):
        made = side_by_side.compiled(Dynamics(one), side_by_side.TABLEAUX["dop853"])
        starts = np.array([[float(x) for x in one.state]]).T * np.array([[1, 1.25, 0.75]])
        run = side_by_side.SideBySide(made, Setting(1e-10), starts, np.zeros((0, 3)), threads=1)
        run.block(np.array([float(3 * unit)]))
        alone = METHODS["dop853"].start(Dynamics(one), Setting(1e-10), initial=starts[:, 1])
        alone.far(float(3 * unit))
        assert run.steps[0][1] == alone.work.steps
        steps.append(run.steps[0])
    assert steps[0] == pytest.approx(steps[1], abs=1)


@pytest.mark.parametrize("units", OTHER.values())
@pytest.mark.parametrize("name", ["spring-pendulum", "ziegler-damped"])
def test_rates_of_decay_and_oscillation_scale_with_the_time(name: str, units: tuple[F, F, F]) -> None:
    given = scenario(described(name))
    decay, frequency = rates(Dynamics(given))
    other = rates(Dynamics(rescaled(given, units)))
    assert decay + frequency > 0.1
    assert [x * float(units[2]) for x in other] == pytest.approx([decay, frequency], rel=1e-5, abs=1e-6)


FALL = """
mbsym: 1
name: {name}
parameters: {{g: positive}}
bodies: [{{name: mass, attached to: 0, mass: 1, connection point: [x, 0, 0], coordinates: [x]}}]
loads: [{{generalized force: {{x: {force}}}}}]
values: {{g: {unit}}}
initial: {{x: {start}}}
"""


@pytest.mark.parametrize("unit", [1, 10**6, 10**12], ids=str)
def test_a_free_fall_is_no_blow_up_in_any_unit(unit: int) -> None:
    """x = g t^2/2 from rest at 0, where nothing tells a size: alone and in ensembles."""
    given = from_text(FALL.format(name="a free fall", force="g", unit=unit, start=0))
    for method in ("dop853", "rk4"):
        fixed = {"step": 100.0} if METHODS[method].traits.fixed else {}
        found = run(given, 1000, method, estimate=False, **fixed).trajectory
        assert found.breakdown is None
        assert found.states[0, -1] == pytest.approx(unit * 5e5, rel=1e-12)
        starts = np.zeros((2, 3))
        made = side_by_side.compiled(Dynamics(given), side_by_side.TABLEAUX[method])
        setting = Setting(1e-10, **fixed)
        beside = side_by_side.SideBySide(made, setting, starts, np.zeros((0, 3)), threads=1)
        each = OneByOne(WithParameters(Parametrised(given, ())), method, setting, starts, np.zeros((0, 3)))
        for members in (beside, each):
            assert members.block(np.array([500.0, 1000.0]))[-1, 0] == pytest.approx(unit * 5e5, rel=1e-12)
            assert not members.fates


@pytest.mark.parametrize("method", ["dop853", "taylor"])
def test_what_swings_ever_wider_is_followed(method: str) -> None:
    """x = exp(3 t) cos(100 t), to 10^13 times its size: where x' = 0 the rate of x' is no escape."""
    given = from_text(FALL.format(
        name="ever wider", force="6*x_dot - 10009*x", unit=1, start="{position: 1, velocity: 3}"
    ))  # fmt: skip
    time = (318 * pi + atan(0.03)) / 100
    found = run(given, time, method, estimate=False).trajectory
    assert found.breakdown is None
    assert found.states[0, -1] == pytest.approx(exp(3 * time) * cos(100 * time), rel=1e-4)


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12], ids=str)
def test_what_runs_away_is_a_blow_up_in_every_unit(unit: float) -> None:
    """x'' = 2 g (x/g)^3 from x = g, x' = g is g/(1 - t); there is no row at t = 1."""
    start = f"{{position: {unit!r}, velocity: {unit!r}}}"
    given = from_text(FALL.format(name="an escape", force="2*g*(x/g)**3", unit=repr(unit), start=start))
    for method in ("dop853", "taylor", "lsoda"):
        found = run(given, 2, method, estimate=False).trajectory
        ended, before = found.breakdown, found.times < 0.99
        assert ended is not None
        assert (ended.kind, round(ended.time, 3)) == (Cause.BLOW_UP, 1)
        assert found.times[-1] < 1
        assert found.states[0, before] / unit == pytest.approx(1 / (1 - found.times[before]), rel=1e-6)
    made = side_by_side.compiled(Dynamics(given), side_by_side.TABLEAUX["dop853"])
    starts = np.full((2, 3), unit)
    members = side_by_side.SideBySide(made, Setting(1e-10), starts, np.zeros((0, 3)), threads=1)
    members.block(np.array([2.0]))
    assert {fate.kind for fate in members.fates.values()} == {Cause.BLOW_UP}


def test_a_size_of_1_in_whatever_unit_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def careless(rates: Any, kinds: Any, begin: Any, states: Any) -> Magnitudes:
        one = np.ones(states.shape)
        return Magnitudes(one, np.ones(len(begin)), one, one)

    monkeypatch.setattr(runge_kutta, "magnitudes", careless)
    given, steps = scenario(SPRING), []
    for unit in (F(1), F(1, 10**6)):
        found = METHODS["dop853"].start(Dynamics(rescaled(given, (F(1), unit, F(1)))), Setting(1e-10))
        found.advance(3.0)
        steps.append(found.work.steps)
    assert steps[1] < 0.9 * steps[0]


# --- extremes, against a solution by hand ---

PAIR = """
mbsym: 1
name: a mass on a mass
parameters: {m1: positive, m2: positive, k1: positive, k2: positive}
bodies:
  - {name: a, attached to: 0, mass: m1, connection point: [x, 0, 0], coordinates: [x]}
  - {name: b, attached to: a, mass: m2, connection point: [y, 0, 0], coordinates: [y]}
loads: [{spring: {coordinate: x, stiffness: k1}}, {spring: {coordinate: y, stiffness: k2}}]
motion: {x: 0, y: 0}
"""

#: m1, k1, m2, k2, x(0), y(0), time.
EXTREMES = {
    "of order 1": ("1", "1", "1", "2", "1", "0.5", 10.0),
    "masses 1e12 and 1e-12": ("1e12", "1e12", "1e-12", "1e-12", "1", "0.5", 10.0),
    "masses 1e-12 and 1e12": ("1e-12", "1", "1e12", "1e12", "1e-12", "0.5", 1e-11),
    "lengths of 1e-9": ("1e-15", "1e-3", "1e-15", "2e-3", "1e-9", "0.5e-9", 1e-5),
    "lengths of 1e9": ("1e20", "1e6", "1e20", "1e6", "1e9", "0.5e9", 1e8),
    "a stiff spring at its rest": ("1", "1e8", "1", "1", "0", "1", 0.1),
}


def by_hand(m1: str, k1: str, m2: str, k2: str, x: str, y: str, times: Any) -> Any:
    """M q'' + K q = 0 from rest with M = [[m1 + m2, m2], [m2, m2]]: a sum of two cosines, in 60 digits."""
    with mpmath.workdps(60):
        a, b, c, d = (mpmath.mpf(value) for value in (m1, k1, m2, k2))
        rates, modes = mpmath.eig(mpmath.inverse(mpmath.matrix([[a + c, c], [c, c]])) * mpmath.diag([b, d]))
        shares = mpmath.lu_solve(modes, mpmath.matrix([mpmath.mpf(x), mpmath.mpf(y)]))
        found = [[shares[i] * mpmath.cos(mpmath.sqrt(rates[i]) * t) for i in range(2)] for t in times]
        return np.array([[float(mpmath.re(z)) for z in modes * mpmath.matrix(row)] for row in found]).T


@pytest.mark.parametrize("method", ["dop853", "taylor"])
@pytest.mark.parametrize("case", EXTREMES)
def test_estimates_are_true_at_extremes(case: str, method: str) -> None:
    """Of default runs, and within 1000 of the error."""
    *numbers, time = EXTREMES[case]
    m1, k1, m2, k2, x, y = numbers
    values = f"values: {{m1: {m1}, k1: {k1}, m2: {m2}, k2: {k2}}}\ninitial: {{x: {x}, y: {y}}}\n"
    found = run(from_text(PAIR + values), time, method)
    exact = by_hand(*numbers, found.trajectory.times.tolist())
    error = np.max(np.abs(found.trajectory.states[:2] - exact), axis=1) / np.max(np.abs(exact), axis=1)
    assert isinstance(found.error, ErrorEstimate)
    assert np.max(error) <= 2 * found.error.largest
    assert found.error.largest <= 1000 * max(np.max(error), ROUNDINGS)
    assert np.max(error) < (1e-4 if "stiff" in case else 1e-10), "its own size is 1e-8 of the other's"
