"""``mbsym.simulate`` and what else is integrated in Python: plans, ensembles, derivatives of a motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from mbsym.studies.described import Source, analysis_of, laws_of, moving_system, public
from mbsym.studies.request import Flag, Number, Text, Value, Values, Whole, Word, duration
from mbsym.studies.study import Asked, Watch

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.numerics.ensembles.ensemble import Ensemble
    from mbsym.numerics.orbits.variational import Gradient
    from mbsym.numerics.planning.plan import Plan
    from mbsym.simulation import Simulation
    from mbsym.simulation.motions import Sensitivities


ARITHMETIC = ("float64", "float32", "extended")

#: No arithmetic here is finer, and nothing coarser is a solution.
FINEST, COARSEST = 1e-19, 0.1

#: Why there are two rows at least.
ENDS = ", the start and the end of a trajectory"

INVARIANTS = "Add first integrals as columns: those of problem 7; of small systems others found at these numbers, too."
WHOLE = (
    "Integrate the coordinates that provably rest as well, all parts with the same steps, and keep welded bodies apart."
)


@dataclass(frozen=True)
class Request:
    """What a simulation is asked for; ``mbsym.simulate`` tells what each field means."""

    time: Annotated[float, duration("Simulate from 0 to T (60, 2*pi, 1e3).")]
    _: KW_ONLY
    values: Values = field(default_factory=dict)
    samples: Annotated[
        int | None,
        Whole("N", "Rows of the table.", usual="2001, more for fast motion", least=2, most=10**18, why=ENDS),
    ] = None
    every: Annotated[float | None, Number("DT", "A row every DT instead.")] = None
    method: Annotated[str, Text(None, "auto or one of those above.", "-m")] = "auto"
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
    certify: float | None = None
    events: str | Iterable[str] = ()
    stop: str | Iterable[str] = ()
    section: str | None = None
    axes: str = ""
    accuracy: float | Mapping[str, float] | None = None
    inputs: Mapping[str, Value] | None = None
    variables: str = "declared"


def _asked(source: Source, request: Request) -> Asked:
    """With laws for its inputs; declared variables where these are integrated."""
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.request import read_values

    system = analysis_of(source).system
    own = request.variables == "declared"
    laws = laws_of(system, request.inputs)
    return Asked(system, scenario(system, read_values(system, request.values or {}), laws=laws, declared=own))


@public(Request, _asked)
def simulate(asked: Asked, request: Request, watch: Watch) -> Simulation:
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

    seen = simulation.integrated_system(asked.system, request.variables)
    wanted = simulation.Request(
        *(request.time, request.samples, request.every, request.method, request.tolerance, request.step),
        *(request.arithmetic, request.step_limit, request.invariants, request.estimate, request.whole, request.certify),
        events=simulation.read_watch(
            seen, _several(request.events), _several(request.stop), request.section, request.axes
        ),
        longest=request.max_step,
        variables=request.variables,
    )
    if request.accuracy is None:
        return simulation.simulate(asked.motion, wanted)
    from mbsym.simulation.accurate import read_accuracy, settled_by, simulate_accurately

    accuracy = read_accuracy(seen, request.accuracy)
    return simulate_accurately(asked.motion, wanted, accuracy, settled_by(wanted))


def plan(
    source: str | Path | Analysis,
    time: float,
    accuracy: float | Mapping[str, float],
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
    samples: int | None = None,
    every: float | None = None,
) -> Plan:
    """What ``simulate(..., accuracy=...)`` would choose, and what its error would be at most; nothing else is run.

        >>> import mbsym
        >>> found = mbsym.plan("systems/simple-pendulum.yaml", 10, 1e-6)
        >>> found.reached, found.bound.total <= 1e-6, [share.name for share in found.bound.shares]
        (True, True, ['model', 'integration', 'arithmetic'])

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``; Breakdown where the motion does not
    come to the end.
    """
    from mbsym import simulation
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.accurate import plan_for, read_accuracy

    system = moving_system(source)
    given = scenario(system, simulation.read_values(system, values or {}), declared=True)
    seen = simulation.integrated_system(system)
    return plan_for(given, simulation.Request(time, samples, every), read_accuracy(seen, accuracy))[0]


def ensemble(
    source: str | Path | Analysis,
    time: float,
    vary: Mapping[str, tuple[float | str, ...]],
    *,
    members: int | None = None,
    seed: int = 1,
    sampling: str = "random",
    values: Mapping[str, Fraction | float | str] | None = None,
    samples: int | None = None,
    every: float | None = None,
    method: str = "auto",
    tolerance: float | None = None,
    step: float | None = None,
    threads: int | None = None,
) -> Ensemble:
    """Many motions at once, side by side in vector registers and on all cores, and how they are spread.

        >>> import mbsym
        >>> found = mbsym.ensemble("systems/double-pendulum.yaml", 5, {"theta1": (0.5, 1.0, 100)})
        >>> found.count, found.statistics.mean.shape, found.final.shape
        (100, (201, 4), (4, 100))

    ``vary`` maps names of parameters, coordinates and velocities to (low, high, count), a grid, or to
    ("normal", mean, deviation) or ("uniform", low, high), of which ``members`` are drawn.  Members that end early are
    in ``found.fates``.  The rest is what ``mbsym simulate --vary`` calls by the same names.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    from mbsym import simulation
    from mbsym.numerics.ensembles.variation import variation
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.ensembles import Spread, simulate_many

    system = moving_system(source)
    read = simulation.read_values(system, values or {})
    request = simulation.Request(time, samples, every, method, tolerance, step)
    asked = Spread(request, [variation(name, given) for name, given in vary.items()], members, seed, sampling)
    return simulate_many(scenario(system, read, declared=True), asked, read, threads)


def sensitivities(
    source: str | Path | Analysis,
    time: float,
    names: Iterable[str],
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
    samples: int | None = None,
    every: float | None = None,
    method: str = "auto",
    tolerance: float | None = None,
) -> Sensitivities:
    """How the motion answers to changes of parameters and of initial values: ``mbsym simulate --sensitivity``.

        >>> import mbsym
        >>> found = mbsym.sensitivities("systems/simple-pendulum.yaml", 2, ["theta", "l"])
        >>> found["theta", "l"].shape
        (2001,)

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    from mbsym import simulation
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.motions import sensitivities as derived

    system = moving_system(source)
    read = simulation.read_values(system, values or {})
    request = simulation.Request(time, samples, every, method, tolerance)
    return derived(scenario(system, read, declared=True), request, tuple(names), read)


def gradient(
    source: str | Path | Analysis,
    time: float,
    functional: str,
    names: Iterable[str],
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
) -> Gradient:
    """The derivatives of one number at the end by many parameters and initial values at once (adjoint equations).

        >>> import mbsym
        >>> found = mbsym.gradient("systems/double-pendulum.yaml", 2, "l1*sin(theta1)", ["m1", "m2", "theta1"])
        >>> sorted(found.by)
        ['m1', 'm2', 'theta1']

    ``functional`` is an expression in coordinates, velocities and parameters.  Raises DescriptionError, ValueError,
    ``mbsym.numerics.scenario.Incomplete``, Breakdown where the motion ends early.
    """
    from mbsym import simulation
    from mbsym.simulation.motions import gradient_of

    system = moving_system(source)
    return gradient_of(system, simulation.read_values(system, values or {}), functional, tuple(names), time)


def _several(texts: str | Iterable[str]) -> tuple[str, ...]:
    return (texts,) if isinstance(texts, str) else tuple(texts)
