"""The ledger and the plan have one vocabulary, and whatever changes what is integrated can be switched."""

from __future__ import annotations

import click
import numpy as np
import pytest

import mbsym
from mbsym.numerics.ledger.table import KINDS, ledger
from mbsym.numerics.planning import kinds
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.planning.planning import Pins, planned
from mbsym.numerics.scenario import scenario
from mbsym.simulation import Request, simulate
from mbsym_cli.main import main


def simulate_command() -> click.Command:
    found = main.get_command(click.Context(main), "simulate")
    assert found is not None
    return found


EVERY = set(kinds.Kind)

#: Kinds that change what is integrated, with the option that settles each by hand.
SWITCHES: dict[kinds.Kind, str] = {
    kinds.Kind.GRAVITY: "--gravity",
    kinds.Kind.LINEARITY: "--linear",
    kinds.Kind.LEFT_OUT: "--without",
    kinds.Kind.MASSES: "--without",
    kinds.Kind.RESTING: "--whole",
    kinds.Kind.PLANE: "--whole",
    kinds.Kind.PARTS: "--whole",
    kinds.Kind.WELDED: "--whole",
}

#: Kinds that change the way of a run, with the option that settles each; one motion has one kernel.
WAYS: dict[kinds.Kind, str | None] = {
    kinds.Kind.METHOD: "--method",
    kinds.Kind.FINENESS: "--tolerance",
    kinds.Kind.SCALAR: "--arithmetic",
    kinds.Kind.KERNEL: None,
}

#: Kinds that change nothing of a motion but rounding: the same equations, with fewer instructions or none to write.
SAME_EQUATIONS = frozenset(
    (
        *(
            kinds.Kind.MASSLESS,
            kinds.Kind.POINTS,
            kinds.Kind.AXES,
            kinds.Kind.TURNS,
            kinds.Kind.CYCLIC,
            kinds.Kind.SKEW,
            kinds.Kind.DROPPED,
            kinds.Kind.ENTRIES,
        ),
        *(
            kinds.Kind.SUBSYSTEMS,
            kinds.Kind.NOT_ASKED,
            kinds.Kind.SYMMETRY,
            kinds.Kind.SPARSITY,
            kinds.Kind.ROUTE,
            kinds.Kind.DEAD,
            kinds.Kind.STEADY,
        ),
        *(kinds.Kind.ZEROS, kinds.Kind.VALUES),
    )
)


def test_every_kind_says_whether_it_changes_what_is_integrated() -> None:
    sorted_out = [*SWITCHES, *WAYS, *SAME_EQUATIONS]
    assert sorted(sorted_out) == sorted(EVERY)
    assert set(KINDS) <= EVERY


def test_every_switch_is_an_option_of_simulate() -> None:
    options = {option for parameter in simulate_command().params for option in parameter.opts}
    wanted = [*SWITCHES.values(), *(option for option in WAYS.values() if option is not None)]
    assert set(wanted) <= options


#: Two pendulums beside each other, one of them two welded bodies, and a cart that rests; nothing links them.
BESIDE = """
mbsym: 1
name: Three that know nothing of each other
parameters: {m: positive, L: positive, g: positive}
bodies:
  - {name: cart, attached to: 0, coordinates: [x], connection point: [x, 0, 0], mass: m}
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass: m, mass centre: [0, -L, 0]}
  - {name: bob, attached to: rod, connection point: [0, -L, 0], rotation: {axes: [1], angles: [pi/5]}, mass: m,
     inertia about: mass centre, inertia: [[m*L**2, 0, 0], [0, m*L**2, 0], [0, 0, 2*m*L**2]]}
  - {name: other, attached to: 0, rotation: {axes: [1], angles: [phi]}, mass: 2*m, mass centre: [0, -L, 0]}
loads:
  - uniform gravity: {acceleration: g, direction: [0, -1, 0]}
values: {m: 1, L: 1, g: 9.81}
initial: {x: 0, theta: 1, phi: 0.5}
"""


def by_plan(whole: bool) -> set[str]:
    """The kinds that change a run, by the plan."""
    given = scenario(mbsym.loads(BESIDE, ()).system)
    plan = planned(given, Accuracy(1e-5), np.linspace(0, 2, 101), Pins(whole=whole))
    return {item.kind for item in plan.items} & SWITCHES.keys()


def test_the_plan_and_the_ledger_say_the_same_of_a_scene() -> None:
    found = {saving.kind for saving in ledger(mbsym.loads(BESIDE, ())).savings} & SWITCHES.keys()
    assert found == {kinds.Kind.RESTING, kinds.Kind.PARTS, kinds.Kind.WELDED}
    assert by_plan(whole=False) == found
    assert not by_plan(whole=True)


@pytest.mark.parametrize("whole", [False, True])
def test_whole_switches_what_is_lumped_separate_and_resting(whole: bool) -> None:
    found = simulate(scenario(mbsym.loads(BESIDE, ()).system), Request(1.0, samples=11, whole=whole))
    assert found.dynamics.apart == whole
    assert bool(found.chosen.parts) != whole
    assert ("x" in (found.chosen.resting.names if found.chosen.resting else ())) != whole
