"""``mbsym simulate``: the equations of motion integrated, a motion or many; tables, figures, what is said of them.

``Request`` is what Python's ``simulate`` takes, ``Command`` what the command takes beside that.  ``fitting`` says what
does not go together and what that leaves to be integrated, ``files`` what is written, ``answer`` what is told;
``functions`` are those of Python beside ``simulate``.
"""

from __future__ import annotations

import shutil
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from mbsym.expressions.message import Message
from mbsym.studies.described import Source, analysis_of, laws_of, public
from mbsym.studies.request import (
    LEAST_ERROR,
    MOST_ERROR,
    Anew,
    Errors,
    Flag,
    Formulas,
    Names,
    Number,
    Place,
    Ranges,
    Settings,
    Text,
    Value,
    Varied,
    Whole,
    Word,
    duration,
    formats,
)
from mbsym.studies.study import Answer, Apart, Asked, Folder, Needed, Refusal, Study, Unfit, Watch

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Simulation
    from mbsym.studies.simulate.fitting import Result


ARITHMETIC = ("float64", "float32", "extended")

#: No arithmetic here is finer, and nothing coarser is a solution.
FINEST, COARSEST = 1e-19, 0.1

#: ``--certify`` without a number; the narrowest and the widest that can be asked for.
USUAL_WIDTH, NARROWEST, WIDEST = "1e-10", 1e-100, 1e-3

#: What a proof may cost where no seconds are given: counted work, worth about so many seconds.
WORK = 200.0

#: What is integrated of a description with speeds.
DECLARED = "declared"

#: Words of ``--gravity``.
ORDERS = ("2", "3", "4", "exact")

FORMATS = ("csv", "svg", "png", "pdf", "bodies-csv", "html", "gif", "mp4")

#: More names than this are not varied at once.
MOST_VARIED = 32

#: Why there are two rows at least.
ENDS = ", the start and the end of a trajectory"

INVARIANTS = "Add first integrals as columns: those of problem 7; of small systems others found at these numbers, too."
WHOLE = (
    "Integrate the coordinates that provably rest as well, all parts with the same steps, and keep welded bodies apart."
)
VARIABLES = (
    "Of a description with speeds: integrate these, and unit vectors or quaternions in place of angles, or "
    "coordinates and their velocities."
)
CERTIFY = "Prove where the exact solution is, to this part of each size, and how far the run is from it."
SECONDS = "How long the proof may take; ends early where a tenth of it shows that ten times as much would not do."
ACCURACY = (
    "Tolerable relative error over the whole time (1e-6; theta=1e-6,energy=1e-9): model, method, "
    "tolerance and arithmetic are chosen for it."
)
VARY = "Many motions at once: theta=0:pi/2:1000 (a grid), theta=normal(0.3, 0.01), m=uniform(1, 2); repeatable."
SENSITIVITY = "Derivatives of the motion by initial values and parameters: --sensitivity theta,m1."


def _methods() -> tuple[str, ...]:
    from mbsym.numerics.methods.table import METHODS

    return ("auto", *METHODS)


def _declared(texts: Mapping[str, Any]) -> bool:
    return (texts["variables"] or DECLARED).lower() == DECLARED


def _quantities(system: System, texts: Mapping[str, Any]) -> Sequence[str]:
    """What an error can be of."""
    from mbsym.numerics.planning.plan import ENERGY
    from mbsym.studies.simulate.fitting import integrated

    seen = integrated(system, (texts["variables"] or DECLARED).lower())
    return (*seen.coordinates, *seen.velocities, ENERGY)


#: ``--set``, with the laws of inputs.
Values: TypeAlias = Annotated[
    Mapping[str, Value],
    Settings("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set", declared=_declared, laws="inputs"),
]


@dataclass(frozen=True)
class Request:
    """What a simulation is asked for; ``mbsym.simulate`` tells what each field means."""

    time: Annotated[float, duration("Simulate from 0 to T (60, 2*pi, 1e3).")]
    _: KW_ONLY
    values: Values = field(default_factory=dict)
    samples: Annotated[
        int | None, Whole("N", "Rows of the table.", usual="2001, more for fast motion", least=2, most=10**18, why=ENDS)
    ] = None
    every: Annotated[float | None, Number("DT", "A row every DT instead.")] = None
    method: Annotated[
        str, Word(None, "auto, or one that 'mbsym explain simulate' lists.", "-m", choices=_methods, what="method")
    ] = "auto"
    tolerance: Annotated[
        float | None,
        Number("X", "Error of one step, relative and absolute.", least=FINEST, most=COARSEST, usual="1e-10 in float64"),
    ] = None
    step: Annotated[float | None, Number("H", "Length of a step, for methods of fixed step.")] = None
    max_step: Annotated[
        float | None, Number("H", "No step is longer (0.01), so that nothing short is stepped over.")
    ] = None
    arithmetic: Annotated[str, Word(f"[{'|'.join(ARITHMETIC)}]", "", choices=ARITHMETIC, what="arithmetic")] = "float64"
    step_limit: Annotated[int, Whole("N", "", most=10**12)] = 10_000_000
    invariants: Annotated[bool, Flag(None, INVARIANTS)] = False
    estimate: Annotated[
        bool | None,
        Flag(None, "Estimate the error by a better run.", usual="of short runs, as far as little work goes", both=True),
    ] = None
    whole: Annotated[bool, Flag(None, WHOLE)] = False
    certify: Annotated[
        float | None, Number("[WIDTH]", CERTIFY, usual=USUAL_WIDTH, least=NARROWEST, most=WIDEST, alone=USUAL_WIDTH)
    ] = None
    certify_seconds: Annotated[
        float | None, Number("S", SECONDS, least=1e-3, most=1e9, usual=f"counted work, worth about {WORK:g} s")
    ] = None
    events: Annotated[
        str | Iterable[str], Names("CONDITION", 'Record when: "theta = 0 rising"; repeatable.', name="--event")
    ] = ()
    stop: Annotated[str | Iterable[str], Names("CONDITION", 'End the run when: "r < 1/10"; repeatable.')] = ()
    section: Annotated[str | None, Text("CONDITION", 'Poincare section: "t = 0 mod 2*pi/Omega", "q1 = 0 rising".')] = (
        None
    )
    axes: Annotated[str, Text("X,Y", 'Of the section: "q2, q2_dot".', usual="the first free coordinate")] = ""
    inputs: Annotated[
        Mapping[str, Value] | None,
        Formulas(
            "NAME=LAW",
            'Law of an input or function: "u=sin(3*t)"; repeatable.',
            name="--input",
            laws=True,
        ),
    ] = None
    variables: Annotated[
        str,
        Word(
            "[declared|coordinates]", VARIABLES, usual=DECLARED,
            choices=(DECLARED, "coordinates"), what="choice of variables",
        ),
    ] = DECLARED  # fmt: skip
    accuracy: Annotated[
        float | Mapping[str, float] | None, Errors("X", ACCURACY, names=_quantities, least=LEAST_ERROR, most=MOST_ERROR)
    ] = None


@dataclass(frozen=True)
class Command(Request):
    """Integrate the equations of motion of FILE from 0 to T; write a table and figures.

    Parameters and the initial state come from the description (values:, initial:); --set replaces them, a coordinate's
    name meaning its initial position and NAME_dot its initial velocity.  Written are trajectory.csv (t, coordinates,
    velocities, energy T - U, generalized_energy T2 - T0 - U where something is prescribed, relative drift), time
    histories, phase planes, drift, the moving system itself and the paths of its mass centres, and simulation.json.
    Whether an energy is conserved is proved, or seen along the run; the error is the difference from a better run.

    Formats: csv, bodies-csv (of each body place, velocity, acceleration of the mass centre in inertial axes, angular
    velocity in its own axes, kinetic energy; T, U, T - U), figures as svg, png, pdf, and the moving system in three
    dimensions as html (one page with time controls, without network), as on paper as gif, and mp4 (by ffmpeg).

    Methods: auto looks at the system and says why it chose what; dop853, rk45 (explicit); rodas5p (stiff systems,
    compiled), radau, lsoda, bdf (stiff systems, of SciPy), scipy-rk45, scipy-dop853; taylor (very exact, needs heyoka);
    with a fixed step rk4 and, for conservative systems, midpoint, midpoint4, midpoint6 (whose energy does not drift).

    --vary integrates many motions at once, on a grid or drawn at random; written are ensemble.csv (mean, standard
    deviation, extremes and quantiles at every time), members.csv (values and final state of each), fan charts and
    ensemble.json.  Up to six motions of a grid are drawn as curves, in one picture, in place of the fan charts.
    --sensitivity writes the motion's derivatives by initial values and parameters, sensitivity.csv.

    --certify encloses the exact solution in balls: what it says is proved, whatever the method did.  enclosure.csv has
    it.  Where neighbouring motions part fast that takes long, and ends early (exit code 3) where it is out of reach.

    A condition is EXPRESSION = EXPRESSION (or <, >) in t, coordinates, velocities, parameters, energy; "rising" or
    "falling" keep one direction of =, "mod 2*pi" takes an angle modulo a turn (never done unasked).  events.csv has
    every time of an --event that dense output shows; --stop ends the run; a --section is a table and a picture.

    --input says what an input of the description is: a number, or a formula in t, coordinates, velocities, speeds,
    parameters and tables.  Without it an input is held at its value on the unperturbed motion (0 unless motion: gives
    another).

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

    _: KW_ONLY
    plan: Annotated[bool, Flag(None, "Print what --accuracy chooses and its bound; run nothing.")] = False
    gravity: Annotated[
        str | None,
        Word(
            f"[{'|'.join(ORDERS)}]", "Order of Newtonian gravity.", usual="as described; chosen by --accuracy",
            choices=ORDERS, what="order",
        ),
    ] = None  # fmt: skip
    linear: Annotated[bool, Flag(None, "Integrate the equations linearised about the unperturbed motion.")] = False
    without: Annotated[
        tuple[str, ...],
        Names(
            "NAME", "Take a parameter as zero; repeatable.", known=lambda system: system.parameter_names,
            what="parameter",
        ),
    ] = ()  # fmt: skip
    vary: Annotated[tuple[Varied, ...] | None, Ranges("NAME=RANGE", VARY, most=MOST_VARIED)] = ()
    members: Annotated[
        int | None, Whole("N", "How many members to draw at random, for example --members 1000.", least=2, most=10**12)
    ] = None
    seed: Annotated[int, Whole("N", "Of what is drawn at random.", least=0, most=2**63 - 1)] = 1
    sampling: Annotated[str, Word("[random|sobol]", "", choices=("random", "sobol"), what="sampling")] = "random"
    sensitivity: Annotated[tuple[str, ...], Names("NAMES", SENSITIVITY, separated=True)] = ()
    path: Annotated[
        Path | None,
        Place(
            "simulation.json", "Go on from where an earlier run of FILE ended, up to T; its rows come first.",
            name="--continue",
        ),
    ] = None  # fmt: skip
    fixed: Annotated[
        tuple[str, ...],
        Names("NAMES", "Initial values that stay while the others are fitted to the constraints.", separated=True),
    ] = ()
    format: Annotated[tuple[str, ...], formats("", FORMATS)] = ("csv", "png")
    bodies: Annotated[bool, Flag(None, "What each body does, in bodies.csv; the same as format bodies-csv.")] = False
    animate: Annotated[bool, Flag(None, "animation.html and animation.gif; the same as formats html,gif.")] = False
    verbose: Annotated[bool, Flag(None, "Tell how it was done, too: method, setting, work, what rests.", "-v")] = False
    anew: Anew = False

    @property
    def formats(self) -> tuple[str, ...]:
        """All that are written."""
        more = (*(["bodies-csv"] if self.bodies else []), *(["html", "gif"] if self.animate else []))
        return tuple(dict.fromkeys((*self.format, *more)))


def _apart(options: Collection[str], others: Collection[str], why: str, hint: str | None = None) -> Iterator[Apart]:
    for option, other in product(options, others):
        yield Apart(option, other, why, hint)


#: Midpoint rules are written for the system's own coordinates.
MIDPOINTS = ("--method midpoint", "--method midpoint4", "--method midpoint6")

MODEL = ("--gravity", "--linear", "--without")

PAIRS: tuple[Apart | Needed, ...] = (
    *_apart(("--every",), ("--samples",), "they exclude each other"),
    *_apart(("--sensitivity",), ("--vary",), "they exclude each other, one is about one motion, the other about many"),
    *_apart(
        ("--accuracy", "--plan", *MODEL),
        ("--vary", "--sensitivity"),
        "models and accuracies are chosen for one motion by itself",
    ),
    *_apart(("--event", "--stop", "--section", "--axes"), ("--vary",), "members are not watched"),
    *_apart(("--certify",), ("--vary",), "one motion is enclosed, not many"),
    *_apart(("--invariants",), ("--vary",), "first integrals are not followed for every member"),
    *_apart(("--whole",), ("--vary",), "members are integrated whole in any case, with welded bodies lumped"),
    *_apart(("--estimate", "--no-estimate"), ("--vary",), "some members are always integrated more finely"),
    *_apart(("--bodies", "--animate"), ("--vary",), "there are no bodies of an ensemble to be shown"),
    *_apart(("--continue",), ("--vary",), "an earlier run is one motion"),
    *_apart(("--arithmetic float32", "--arithmetic extended"), ("--vary",), "members are computed in float64"),
    *_apart(
        ("--arithmetic float32", "--arithmetic extended"), ("--sensitivity",), "derivatives are computed in float64"
    ),
    *_apart(
        ("--sensitivity",),
        MIDPOINTS,
        "midpoint rules are those of a system with a potential, and the variational equations have none",
        "take --method dop853, rk4 or radau",
    ),
    *_apart(
        ("--sensitivity",), ("--stop",), "derivatives at the moment at which a condition holds are other derivatives"
    ),
    *_apart(("--sensitivity",), ("--continue",), "derivatives by the state at t = 0 want the motion from there on"),
    *_apart(("--plan",), ("--stop",), "a plan is for the whole --time", "take the --time at which it stops"),
    *_apart(("--json",), ("--plan",), "a plan is told in words, and as the command that repeats it"),
    *_apart(("--plan",), ("--certify",), "a plan runs nothing of which anything could be proved"),
    *_apart(
        ("--accuracy",),
        ("--continue",),
        "its bound is one from t = 0 on, and how wrong the earlier run was is not known",
        "run it from t = 0, or leave --accuracy out: the earlier method and tolerance are taken",
    ),
    *_apart(("--arithmetic",), ("--continue",), "the arithmetic is that of the earlier run"),
    Needed("--members", "--vary", "write name=normal(0.3, 0.01) or name=uniform(0, 1)"),
    Needed("--seed", "--vary", "write name=normal(0.3, 0.01) or name=uniform(0, 1)"),
    Needed("--sampling", "--vary", "write name=normal(0.3, 0.01) or name=uniform(0, 1)"),
    Needed("--certify-seconds", "--certify", "for example --certify 1e-10"),
    Needed("--axes", "--section", 'for example --section "q1 = 0 rising"'),
    Needed("--plan", "--accuracy", "for example --accuracy 1e-6"),
)


def _asked(source: Source, request: Request) -> Asked:
    """With laws for its inputs; declared variables where these are integrated."""
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.request import read_values

    system = analysis_of(source).system
    own = request.variables == "declared"
    laws = laws_of(system, request.inputs)
    return Asked(system, scenario(system, read_values(system, request.values or {}), laws=laws, declared=own))


@public(Request, _asked)
def simulate(context: Asked, request: Request, watch: Watch) -> Simulation:
    """The motion of a description (a file, or what ``load`` returned) from 0 to ``time``.

        >>> import mbsym
        >>> run = mbsym.simulate("systems/double-pendulum.yaml", 10)
        >>> run.coordinates.shape, run.energy.shape
        ((2, 2001), (2001,))
        >>> run.conservation.standing.value, run.error.largest < 1e-8
        ('proved', True)
        >>> run.at([0.1234, 7.5]).shape  # between the rows: (q, q') at any times, from the method's dense output
        (4, 2)

    Its arguments are the fields of ``mbsym.studies.simulate.Request``, which may be given in their place.

    ``values`` replace those of the description: parameters, initial positions by the coordinates' names, initial
    velocities by ``<name>_dot``; numbers, or text such as ``"pi/6"``.  The rest is what ``mbsym simulate`` calls by the
    same names.  A run that ends early is a result too: ``run.whole``, ``run.ended``.

    ``events`` are conditions such as ``"theta = 0 rising"``; every time at which one is met is in ``run.events``
    (``times``, ``which``, ``turns``, ``states``; ``run.events.of("theta = 0 rising")``).  ``stop`` are conditions that
    end the run, ``run.events.ended`` the one that did.  ``section`` is a surface, ``run.section.points`` the states
    there in the ``axes`` (``"q2, q2_dot"``).

    ``accuracy`` is the tolerable relative error, of everything or by quantity (``{"theta": 1e-6, "energy": 1e-9}``):
    model, method, tolerance and arithmetic are chosen for it (what is given by hand is kept); ``run.plan`` says how,
    and ``run.plan.bound.total`` what the error is at most.

    ``inputs`` gives inputs of the description by name: numbers, or formulas in t, coordinates, velocities, parameters
    and tables such as ``"20*sin(3*t)"``; those left out are held at their values on the unperturbed motion.

    Of a description with ``speeds`` its own variables are integrated: positions (unit vectors or a quaternion in place
    of angles) and speeds, ``run.coordinates`` and ``run.velocities``; with ``variables="coordinates"`` coordinates and
    their velocities.

    Raises DescriptionError for a description with errors, ValueError for arguments that cannot be met,
    ``mbsym.numerics.scenario.Incomplete`` with every number that is missing, Unusable where the method does not apply.
    """
    from mbsym import simulation
    from mbsym.studies.simulate.fitting import basic

    seen = simulation.integrated_system(context.system, request.variables)
    run_request = basic(request, seen)
    if request.accuracy is None:
        return simulation.simulate(context.motion, run_request)
    from mbsym.simulation.accurate import read_accuracy, settled_by, simulate_accurately

    accuracy = read_accuracy(seen, request.accuracy)
    return simulate_accurately(context.motion, run_request, accuracy, settled_by(run_request))


def unfit(context: Asked, request: Command) -> Iterator[Unfit]:
    from mbsym.studies.simulate.fitting import settled

    if "mp4" in request.formats and shutil.which("ffmpeg") is None:
        yield Unfit(
            "--format",
            "no-ffmpeg",
            Message("ffmpeg makes mp4, and there is none on the path"),
            Message("install it, or take gif or html"),
        )
    yield from settled(context, request).wrong


def derive(context: Asked, request: Command, watch: Watch) -> Result:
    from mbsym.studies.simulate.fitting import derived

    return derived(context, request, watch)


def answer(context: Asked, request: Command, result: Result) -> Answer:
    from mbsym.studies.simulate.answer import answered

    return answered(context, request, result)


def refusal(error: Exception, context: Asked, request: Command) -> Refusal | None:
    from mbsym.studies.simulate.answer import refused

    return refused(error, context, request)


#: Options that a first run does without.
RARE = (
    "every", "step", "max_step", "arithmetic", "step_limit", "invariants", "estimate", "whole", "certify_seconds",
    "section", "axes", "variables", "gravity", "linear", "without", "members", "seed", "sampling", "path", "fixed",
    "anew",
)  # fmt: skip

STUDY = Study(
    "simulate", Command, derive, answer, refusal, unfit,
    json_help="Print JSON, that of simulation.json or ensemble.json, instead of a summary.",
    constraints=True, held=False, free=True, out=Folder(json=True), pairs=PAIRS, rare=RARE,
)  # fmt: skip
