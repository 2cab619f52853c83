"""mbsym: exact symbolic mechanics of multibody systems from a text description.

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.energy.cyclic
    ()

``load`` reads a description (YAML or the editor's text) and returns an ``Analysis`` whose attributes ``kinematics``,
``energy``, ``equations``, ``equilibrium``, ``linearisation``, ``stability``, ``integrals``, ``claims`` and ``checks``
are derived when they are first asked for.  Matrices print as LaTeX in a notebook and convert with ``.to_sympy()``.

``simulate`` integrates the equations of motion and returns times, coordinates, velocities and energy as arrays, with
how far the energy is known to be conserved and an estimate of the error.  ``tradeoff``, ``extremes`` and
``equilibria`` return what the commands of these names measure and find, as tables of arrays.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fractions import Fraction

    from mbsym.analysis import Analysis
    from mbsym.model.system import System
    from mbsym.numerics.ensembles.ensemble import Ensemble
    from mbsym.numerics.inverse import InverseDynamics
    from mbsym.numerics.orbits.adjoint import Gradient
    from mbsym.numerics.orbits.floquet import Judged
    from mbsym.numerics.orbits.lyapunov import Exponents
    from mbsym.numerics.planning.plan import Plan
    from mbsym.simulation import Simulation
    from mbsym.simulation.motions import PeriodicMotion
    from mbsym.simulation.sensitivities import Sensitivities
    from mbsym.studies import EquilibriaStudy, ExtremesStudy, TradeoffStudy

__version__ = "0.1.0"
__all__ = [
    "DescriptionError",
    "ensemble",
    "equilibria",
    "extremes",
    "floquet",
    "gradient",
    "inverse_dynamics",
    "load",
    "loads",
    "lyapunov",
    "orbit",
    "plan",
    "sensitivities",
    "simulate",
    "tradeoff",
]


class DescriptionError(ValueError):
    """A description with complaints; the message holds all of them, each with file, line and column."""


def load(path: str | Path, problems: Iterable[int] | None = None) -> Analysis:
    """The analysis of a description file, of all its problems unless some are named.

    Raises DescriptionError with every complaint, OSError never.
    """
    from mbsym.source import load as read_file

    system, complaints, text = read_file(Path(path))
    return _analysis(system, complaints, text, str(path), problems)


def loads(text: str, problems: Iterable[int] | None = None) -> Analysis:
    """The analysis of a description given as text."""
    from mbsym.source import read

    system, complaints = read(text)
    return _analysis(system, complaints, text, "<string>", problems)


def simulate(
    source: str | Path | Analysis,
    time: float,
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
    samples: int | None = None,
    every: float | None = None,
    method: str = "auto",
    tolerance: float | None = None,
    step: float | None = None,
    arithmetic: str = "float64",
    step_limit: int = 10_000_000,
    max_step: float | None = None,
    invariants: bool = False,
    estimate: bool | None = None,
    whole: bool = False,
    certify: float | None = None,
    events: str | Iterable[str] = (),
    stop: str | Iterable[str] = (),
    section: str | None = None,
    axes: str = "",
    accuracy: float | Mapping[str, float] | None = None,
    inputs: Mapping[str, Fraction | float | str] | None = None,
    variables: str = "declared",
) -> Simulation:
    """The motion of a description (a file, or what ``load`` returned) from 0 to ``time``.

        >>> import mbsym
        >>> run = mbsym.simulate("systems/double-pendulum.yaml", 10)
        >>> run.coordinates.shape, run.energy.shape
        ((2, 2001), (2001,))
        >>> run.conservation.standing.value, run.error.largest < 1e-8
        ('proved', True)
        >>> run.at([0.1234, 7.5]).shape  # between the rows: (q, q') at any times, from the method's dense output
        (4, 2)

    ``values`` replace those of the description: parameters, initial positions by the coordinates' names, initial
    velocities by ``<name>_dot``; numbers, or text such as ``"pi/6"``.  The rest is what ``mbsym simulate`` calls by the
    same names (``mbsym.simulation.Request``).  A run that ends early is a result too: ``run.whole``, ``run.ended``.

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
    of angles) and speeds, ``run.coordinates`` and ``run.velocities``; with ``variables="coordinates"``, as with an
    ``accuracy``, coordinates and their velocities.

    Raises DescriptionError for a description with errors, ValueError for arguments that cannot be met,
    ``mbsym.numerics.scenario.Incomplete`` with every number that is missing, Unusable where the method does not apply.
    """
    from mbsym import simulation
    from mbsym.numerics.scenario import scenario

    system = _analysis_of(source).system
    if accuracy is not None:
        variables = "coordinates"
    seen = simulation.integrated_system(system, variables)
    request = simulation.Request(
        *(time, samples, every, method, tolerance, step, arithmetic, step_limit, invariants, estimate, whole, certify),
        events=simulation.read_watch(seen, _several(events), _several(stop), section, axes),
        longest=max_step,
        variables=variables,
    )
    read, own = simulation.read_values(system, values or {}), variables == "declared"
    given = scenario(system, read, laws=_laws(system, inputs), declared=own)
    if accuracy is None:
        return simulation.simulate(given, request)
    from mbsym.simulation.accurate import read_accuracy, settled_by, simulate_accurately

    return simulate_accurately(given, request, read_accuracy(system, accuracy), settled_by(request))


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

    system = _system(source)
    given = scenario(system, simulation.read_values(system, values or {}))
    return plan_for(given, simulation.Request(time, samples, every), read_accuracy(system, accuracy))[0]


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

    system = _system(source)
    read = simulation.read_values(system, values or {})
    request = simulation.Request(time, samples, every, method, tolerance, step)
    asked = Spread(request, [variation(name, given) for name, given in vary.items()], members, seed, sampling)
    return simulate_many(scenario(system, read), asked, read, threads)


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
    from mbsym.simulation.sensitivities import sensitivities as derived

    system = _system(source)
    read = simulation.read_values(system, values or {})
    request = simulation.Request(time, samples, every, method, tolerance)
    return derived(scenario(system, read), request, tuple(names), read)


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

    system = _system(source)
    return gradient_of(system, simulation.read_values(system, values or {}), functional, tuple(names), time)


def orbit(
    source: str | Path | Analysis,
    period: float,
    *,
    keep: str = "auto",
    turns: Mapping[str, int] | None = None,
    values: Mapping[str, Fraction | float | str] | None = None,
) -> PeriodicMotion:
    """A periodic motion near the initial state and near ``period``: ``mbsym orbit``.

        >>> import mbsym
        >>> found = mbsym.orbit("systems/double-pendulum.yaml", 2.6, values={"theta1": 0.3, "theta2": 0.12})
        >>> found.orbit.multipliers.shape, found.states.shape
        ((4,), (4, 401))

    Raises DescriptionError, ValueError, ``mbsym.numerics.orbits.periodic.NotFound``.
    """
    from mbsym import simulation
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.motions import find_orbit

    system = _system(source)
    return find_orbit(scenario(system, simulation.read_values(system, values or {})), period, keep, turns)


def lyapunov(
    source: str | Path | Analysis,
    time: float,
    *,
    count: int | None = None,
    every: float | None = None,
    values: Mapping[str, Fraction | float | str] | None = None,
) -> Exponents:
    """Lyapunov exponents over ``time``, the largest first, with their uncertainty: ``mbsym lyapunov``.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    from mbsym import simulation
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.motions import lyapunov_exponents

    system = _system(source)
    given = scenario(system, simulation.read_values(system, values or {}))
    return lyapunov_exponents(given, time, every, count)


def floquet(source: str | Path | Analysis, *, values: Mapping[str, Fraction | float | str] | None = None) -> Judged:
    """What the multipliers of a time-periodic first approximation prove: ``mbsym floquet``.

        >>> import mbsym
        >>> mbsym.floquet("systems/shaken-pendulum.yaml", values={"nu": 40}).word.value
        'unstable'

    Raises DescriptionError, ValueError, ``mbsym.numerics.orbits.floquet.NotPeriodic``.
    """
    from mbsym import simulation
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.orbits.floquet import judged
    from mbsym.numerics.scenario import scenario

    system = _system(source)
    return judged(Dynamics(scenario(system, simulation.read_values(system, values or {}))))


def tradeoff(
    source: str | Path | Analysis,
    time: float,
    *,
    target: float = 1e-9,
    values: Mapping[str, Fraction | float | str] | None = None,
    budget: float = 60.0,
    methods: Iterable[str] | None = None,
    models: bool = True,
) -> TradeoffStudy:
    """What accuracy costs from 0 to ``time`` on this machine: ``mbsym tradeoff``.

    ``study.runs`` is a table (``study.runs["error"]``, the largest over the whole interval), ``study.advice`` the
    sentence about ``target``; ``study.reference_error`` is that of the reference, ``study.reference`` says what it is.
    ``budget`` is counted work, worth so many seconds on a usual machine: the same runs are measured everywhere, and
    only their seconds are those of this machine.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``; Breakdown where there is no reference
    solution up to ``time``.
    """
    from mbsym import studies

    names = None if methods is None else tuple(methods)
    return studies.tradeoff(_system(source), time, values or {}, target, budget, names, models)


def extremes(
    source: str | Path | Analysis,
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
    budget: float = 60.0,
) -> ExtremesStudy:
    """How many digits each quantity keeps at the extremes, as far as ``budget`` goes: ``mbsym extremes``.

    ``budget`` is counted work, worth about so many seconds on a usual machine: the same rows come out everywhere.

    Raises DescriptionError, ValueError, ``mbsym.numerics.scenario.Incomplete``.
    """
    from mbsym import studies

    return studies.extremes(_system(source), values or {}, budget)


def equilibria(
    source: str | Path | Analysis, *, values: Mapping[str, Fraction | int | str] | None = None, within: float = 10.0
) -> EquilibriaStudy:
    """All relative equilibria at exact values of the parameters, each with its verdict: ``mbsym equilibria``.

        >>> import mbsym
        >>> found = mbsym.equilibria("systems/double-pendulum.yaml")
        >>> found.complete, list(found.table["verdict"])
        (True, ['stable', 'unstable', 'unstable', 'unstable'])

    Raises DescriptionError, ValueError for a parameter without a number, Failure where they cannot be listed.
    """
    from mbsym import studies

    return studies.equilibria(_system(source), values or {}, within)


def inverse_dynamics(
    source: str | Path | Analysis,
    motion: Mapping[str, Fraction | float | str],
    times: Iterable[float],
    *,
    values: Mapping[str, Fraction | float | str] | None = None,
) -> InverseDynamics:
    """The inputs of a description with which its coordinates move as given: ``mbsym inverse``.

        >>> import mbsym
        >>> found = mbsym.inverse_dynamics("systems/cart-pole.yaml", {"p": "t", "theta": "pi"}, [0, 1, 2])
        >>> found.exact, [round(float(x), 12) for x in found["F"]]  # at a constant speed the friction c p' remains
        (True, [0.1, 0.1, 0.1])

    ``motion`` gives every coordinate as a smooth formula in t, parameters and prescribed motions; with constraints some
    of them, from which they give the others, near the initial position.  The equations are
    solved for the inputs at every time: in the sense of least squares where there are more of them (``exact`` and
    ``left`` say what remains), by the smallest inputs where these are not ``unique``.

    Raises DescriptionError; ValueError for arguments that cannot be met; ``mbsym.numerics.inverse.NotLinear`` where an
    input enters other than linearly; ``mbsym.numerics.scenario.Incomplete``.
    """
    import numpy as np

    from mbsym.numerics.inverse import inverse_dynamics as found_for
    from mbsym.simulation import read_values
    from mbsym.source.laws import read_motions

    system = _analysis_of(source).system
    moments = np.asarray(list(times), dtype=float)
    return found_for(system, read_motions(system, motion), read_values(system, values or {}), moments)


def _several(texts: str | Iterable[str]) -> tuple[str, ...]:
    return (texts,) if isinstance(texts, str) else tuple(texts)


def _analysis_of(source: str | Path | Analysis) -> Analysis:
    return load(source, ()) if isinstance(source, (str, Path)) else source


def _laws(system: System, inputs: Mapping[str, Fraction | float | str] | None) -> dict[str, Any]:
    if not inputs:
        return {}
    from mbsym.source.laws import read_laws

    return read_laws(system, inputs)


def _system(source: str | Path | Analysis) -> System:
    """The system; its inputs, where it has any, at the values of the unperturbed motion.

    Raises GivenByMatrices where there are no bodies that could move.
    """
    from mbsym.analysis.given import refuse_matrices
    from mbsym.model.driven import held

    system = _analysis_of(source).system
    refuse_matrices(system, "no motion is integrated or searched for")
    return held(system)


def _analysis(system, complaints, text, name, problems) -> Analysis:  # type: ignore[no-untyped-def]
    from mbsym.analysis import Analysis
    from mbsym.source import render

    if system is not None and (system.constraints or system.linear):
        from mbsym.analysis.soundness import complain as complain_of

        complain_of(system, complaints)
    if system is None or complaints.errors:
        raise DescriptionError("\n".join(render(item, text, name) for item in complaints.sorted()))
    return Analysis(system, problems)
