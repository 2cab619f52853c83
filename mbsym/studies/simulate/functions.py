"""What else is integrated in Python: plans, ensembles, derivatives of a motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.studies.described import moving_system

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.numerics.ensembles.ensemble import Ensemble
    from mbsym.numerics.orbits.variational import Gradient
    from mbsym.numerics.planning.plan import Plan
    from mbsym.simulation.motions import Sensitivities


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
    come to the end, ``mbsym.numerics.simulate.Rests`` where nothing moves.
    """
    from mbsym import simulation
    from mbsym.numerics.scenario import scenario
    from mbsym.simulation.accurate import plan_for, read_accuracy

    system = moving_system(source)
    motion = scenario(system, simulation.read_values(system, values or {}), declared=True)
    seen = simulation.integrated_system(system)
    return plan_for(motion, simulation.Request(time, samples, every), read_accuracy(seen, accuracy))[0]


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
    spread = Spread(request, [variation(name, law) for name, law in vary.items()], members, seed, sampling)
    return simulate_many(scenario(system, read, declared=True), spread, read, threads)


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
