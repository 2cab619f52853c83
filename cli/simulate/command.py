"""``mbsym simulate``: integrates the equations of motion and writes the trajectory as a table and as figures."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mbsym.report.language import Language
from mbsym_cli.assignments import given_numbers
from mbsym_cli.console import BAD_INPUT, INTERRUPTED, complain, read_description
from mbsym_cli.files import folder_for
from mbsym_cli.formulas import LAWS, read_formula
from mbsym_cli.options import Options
from mbsym_cli.simulate.ensemble import answers, spread
from mbsym_cli.simulate.further import begun_at, declared, going_on, integrated, with_further
from mbsym_cli.simulate.many import read_many
from mbsym_cli.simulate.options import OPTIONS, carried, complain_of_names, complain_of_pairs, typed_options
from mbsym_cli.simulate.request import check_constrained, check_held, check_states, read_request, with_goal
from mbsym_cli.simulate.run import run
from mbsym_cli.study import prevented

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.numerics.scenario import Scenario


def simulate(file: Path, **texts: Any) -> None:
    """Integrate the equations of motion of FILE from 0 to T; write a table and figures.

    Parameters and the initial state come from the description (values:, initial:); --set replaces them, a coordinate's
    name meaning its initial position and NAME_dot its initial velocity.  Written are trajectory.csv (t, coordinates,
    velocities, energy T - U, generalized_energy T2 - T0 - U where something is prescribed, relative drift), time
    histories, phase planes, drift, the moving system itself and the paths of its mass centres, and simulation.json.
    Whether an energy is conserved is proved, or seen along the run; the error is the difference from a better run.

    Formats: csv, bodies-csv (of each body place, velocity, acceleration of the mass centre in inertial axes, angular
    velocity in its own axes, kinetic energy; T, U, T - U), figures as svg, png, pdf, and the moving system in three
    dimensions as html (one page with time controls, without network) and gif.

    Methods: auto looks at the system and says why it chose what; dop853, rk45 (explicit); radau, lsoda, bdf (stiff
    systems); taylor (very exact, needs heyoka); with a fixed step rk4 and, for conservative systems, midpoint,
    midpoint4, midpoint6 (whose energy does not drift).

    --vary integrates many motions at once, on a grid or drawn at random; written are ensemble.csv (mean, standard
    deviation, extremes and quantiles at every time), members.csv (values and final state of each), fan charts and
    ensemble.json.  Up to six motions of a grid are drawn as curves, in one picture, in place of the fan charts.
    --sensitivity writes the motion's derivatives by initial values and parameters, sensitivity.csv.

    --certify encloses the exact solution in balls: what it says is proved, whatever the method did.  enclosure.csv has
    it.  Where neighbouring motions part fast that takes long, and ends early (exit code 3) where it is out of reach.

    A condition is EXPRESSION = EXPRESSION (or <, >) in t, coordinates, velocities, parameters, energy; "rising" or
    "falling" keep one direction of =, "mod 2*pi" takes an angle modulo a turn (never done unasked).  events.csv has
    every time of an --event that dense output shows; --stop ends the run; a --section is a table and a picture.

    --input says what an input of the description is: a number, or a formula in t, coordinates, velocities, parameters
    and tables.  Without it an input is held at its value on the unperturbed motion (0 unless motion: gives another).

    --accuracy 1e-6 chooses order of gravity, linear or nonlinear, parameters to drop, method, tolerance, arithmetic;
    prints one bound, and the command that repeats the run.  --method, --tolerance, --gravity, ... settle a part of it.

    --continue goes on from the last state of an earlier run of the same description and values, in its arithmetic, with
    its method and tolerance unless others are given; the table holds the rows of both (in float64).  Steps begin anew
    there: the numbers are those of one run in one go within the tolerance, or, where that run ended at the end of a
    step of fixed length, but for rounding.

    Of a description with speeds these are integrated, and unit vectors or a quaternion in place of angles, so that no
    angle is singular: they are the columns, and the names in conditions.  --variables coordinates takes coordinates.

    With constraints the initial state is the closest one to what is given that satisfies them; --fixed q1,q1_dot keeps
    values.  Every row is led back to them; trajectory.csv has their drift.  A loop that cannot be closed: exit code 3.

    A blow-up, a singular mass matrix, too many steps or Ctrl-C end it early: what was computed is kept in files named
    ...-partial.  Exit codes: 0 done, 1 not written, 2 wrong, 3 ended early, or not as accurate or as narrow as
    asked for, 130 interrupted.

    \b
    Examples:
      mbsym simulate systems/double-pendulum.yaml --time 60
      mbsym simulate systems/spring-pendulum.yaml --time 20 --set theta=pi/6 --set r=3/2 --set theta_dot=0
      mbsym simulate systems/double-pendulum.yaml --time 6 --animate --bodies --format csv,pdf
      mbsym simulate systems/heavy-top.yaml --time 5 --method rk4 --step 1e-4
      mbsym simulate systems/double-pendulum.yaml --time 60 --event "theta1 = 0 rising" --stop "theta2 > pi"
      mbsym simulate systems/double-pendulum.yaml --time 2000 --section "theta1 = 0 mod 2*pi rising"
      mbsym simulate systems/double-pendulum.yaml --time 10 --vary "theta1=normal(1, 0.01)" --members 1000
      mbsym simulate systems/double-pendulum.yaml --time 10 --sensitivity theta1,m1
      mbsym simulate systems/double-pendulum.yaml --time 5 --certify 1e-12
      mbsym simulate systems/cart-pole.yaml --time 5 --set p=0 --input "F=20*sin(3*t)"
      mbsym simulate systems/satellite.yaml --time 20 --accuracy 1e-6 --plan
      mbsym simulate systems/double-pendulum.yaml --time 120 --continue reports/double-pendulum/simulation.json
    """
    try:
        sys.exit(_simulated(file, texts))
    except KeyboardInterrupt:
        complain(file, "interrupted; what has been written is whole")
        sys.exit(INTERRUPTED)


command = click.Command(
    "simulate",
    params=[click.Argument(["file"], type=click.Path(path_type=Path)), *OPTIONS],
    callback=simulate,
    help=inspect.getdoc(simulate),
)


def _simulated(file: Path, texts: Mapping[str, Any]) -> int:
    """The exit code: all options are read and complained about together, before anything is compiled."""
    folder, settings = folder_for(file, texts["out"]), texts["values"]
    system = read_description(file, moving="simulate")
    asked, context = Options(), click.get_current_context()
    asked.say = Language("" if system is None else system.language).say
    typed = typed_options(context)
    complain_of_pairs(typed, asked)
    complain_of_names(settings, {"--vary": texts["vary"], "--without": texts["without"]}, asked)
    laws: dict[str, Expression] = {}
    for text in texts["laws"] if system is not None else ():
        read_formula(text, system, LAWS, laws, asked)
    own = declared(texts)
    given, overrides = (None, {}) if system is None else given_numbers(file, system, settings, asked, laws, own)
    system = system if given is None else given.system
    seen = integrated(system, texts)
    wanted = read_request(system, texts, asked)
    request = with_further(wanted.request, texts, seen, asked)
    wanted = replace(wanted, request=going_on(request, begun_at(given, request), typed, asked))
    check_held(wanted.request, system, bool(texts["vary"] or texts["sensitivity"]), asked)
    varied, sensitive = read_many(texts, given, wanted, typed, asked)
    wanted = with_goal(texts, seen, wanted, typed, carried(context), asked)
    check_constrained(system, wanted, asked)
    check_states(seen, wanted, asked)
    code = prevented(file, folder, system is not None, asked)
    if code or given is None:
        return code or BAD_INPUT
    if varied is not None:

        def read(more: tuple[str, ...]) -> Scenario | None:
            return given_numbers(file, given.system, (*settings, *more), asked, laws, own)[0]

        return spread(file, folder, given, overrides, varied, wanted, asked, read)
    code = run(file, folder, given, wanted, asked)
    return code if code or not sensitive else answers(file, folder, given, overrides, sensitive, wanted)
