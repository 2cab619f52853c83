"""``simulation.json``: what a trajectory was computed from, how, with what work, and whether it is whole.

Without seconds and dates, so that the same simulation writes the same file.
"""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from math import isfinite
from typing import Any

import numpy as np
from msgspec import UNSET, Struct

from mbsym.model.quantities import energy_unit, units_by_name
from mbsym.numerics.planning.reduced import Reduced
from mbsym.numerics.simulate import Trajectory
from mbsym.report.documents import simulation as doc
from mbsym.report.documents.base import plain, written
from mbsym.report.runs.certificate import certificate_json
from mbsym.report.runs.constrained_run_words import constraints_json
from mbsym.report.runs.events import events_json
from mbsym.report.runs.plan_words import plan_json
from mbsym.report.runs.simulation_words import between_steps_json, error_json, laws_json, states_json
from mbsym.simulation import Simulation
from mbsym.simulation.sampling import may_change
from mbsym.source.yaml_writer import meaning

PACKAGES = ("mbsym", "numpy", "scipy", "llvmlite", "python-flint", "heyoka")


def simulation_json(run: Simulation, files: Sequence[str], table_sha256: str | None = None) -> str:
    """The file's text; ``files`` are those that belong to it, and the hash is that of the table of rows."""
    system, trajectory, chosen, scenario = run.system, run.trajectory, run.chosen, run.scenario
    state = [float(x) for x in scenario.state]
    traits, earlier = chosen.method.traits, run.request.earlier
    names = [*system.coordinates, *system.velocities]
    content = doc.Simulation(
        system=system.name,
        description_sha256=meaning(run.given.system if run.given is not None else system),
        status="whole" if trajectory.whole else "partial",
        ended=_ended(trajectory),
        time=doc.TimeSpan(from_=0.0, to=float(chosen.times[-1]), samples=len(chosen.times)),
        reached=doc.Reached(time=float(trajectory.times[-1]), samples=trajectory.samples, state=_last(trajectory)),
        continued=None if earlier is None else doc.Continued(from_=earlier.time, samples=len(earlier.times)),
        method=doc.MethodUsed(
            name=traits.name.lower(), title=traits.title, why=chosen.why, may_change=may_change(run.request)
        ),
        arithmetic=run.arithmetic,
        tolerance=trajectory.setting.tolerance,
        step=trajectory.setting.step,
        longest_step=trajectory.setting.longest,
        between_steps=between_steps_json(trajectory.passed),
        step_limit=trajectory.setting.step_limit,
        parameters={name: float(value) for name, value in scenario.parameters.items()},
        inputs=laws_json(scenario) if scenario.inputs else UNSET,
        initial=dict(zip(names, state, strict=True)),
        work=doc.Work.from_result(trajectory.work),
        files=list(files),
        table_sha256=table_sha256,
        versions=versions(),
        units=_units(run) or UNSET,
        energy=doc.Energy.from_result(run.energy_conservation, is_="T - U"),
        generalized_energy=UNSET
        if run.dynamics.natural
        else doc.GeneralizedEnergy.from_result(run.conservation, is_="T2 - T0 - U"),
        invariants={item.column: doc.Invariant.from_result(item.conservation) for item in run.invariants},
        estimated_error=error_json(run.error),
        resting=_resting(chosen.resting),
        **events_json(run),
        parts=[doc.SystemPart.from_result(part) for part in chosen.parts],
        model=doc.Model.from_result(run.request.model),
        plan=None if run.plan is None else plan_json(run.plan, run.request),
        method_changes=[doc.MethodChange.from_result(change) for change in trajectory.work.changes] or UNSET,
        constraints=constraints_json(run),
        variables=states_json(run),
        certificate=UNSET if run.certificate is None else certificate_json(run.certificate, names),
    )
    return written(finite(content), indent=2)


def _units(run: Simulation) -> dict[str, str]:
    """The units of everything that has a name; nothing for a description without."""
    energy = energy_unit(run.system)
    energies = [("energy", energy)] if run.dynamics.natural else [("energy", energy), ("generalized_energy", energy)]
    return units_by_name(run.system, [*energies, *((invariant.column, invariant.unit) for invariant in run.invariants)])


def _resting(reduced_system: Reduced | None) -> doc.Resting | None:
    """Which coordinates rest, how that is known, and the operations of one right-hand side with and without them."""
    if reduced_system is None:
        return None
    whole, reduced = reduced_system.operations
    return doc.Resting(
        coordinates=list(reduced_system.names),
        how=reduced_system.reduction.how,
        taken_out=reduced_system.proved,
        operations=doc.Operations(whole=whole, reduced=reduced) if reduced_system.proved else UNSET,
    )


def _last(trajectory: Trajectory) -> dict[str, Any]:
    """The last state to the last bit; numbers of more digits than JSON's readers keep are text."""
    names, state = [*trajectory.system.coordinates, *trajectory.system.velocities], trajectory.states[:, -1]
    exact = [np.format_float_scientific(x) for x in state] if state.dtype == np.longdouble else map(float, state)
    return dict(zip(names, exact, strict=True))


def _ended(trajectory: Trajectory) -> doc.Ended | None:
    """Why and where a trajectory ended early."""
    if trajectory.interrupted:
        return doc.Ended(kind="interrupted", message="stopped by the user", time=float(trajectory.times[-1]))
    if trajectory.breakdown is None:
        return None
    names = [*trajectory.system.coordinates, *trajectory.system.velocities]
    state: dict[str, float | str] = dict(zip(names, map(float, trajectory.breakdown.state), strict=True))
    ended = trajectory.breakdown
    return doc.Ended.from_result(ended, time=float(ended.time), state=state)


def versions() -> dict[str, str]:
    """Of Python and of the packages that the numbers depend on."""
    version_numbers = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            version_numbers[name] = version(name)
        except PackageNotFoundError:
            continue
    return version_numbers


def finite(value: Any) -> Any:
    """The same as nested lists and dictionaries without infinities, which JSON does not know: they become text."""
    if isinstance(value, Struct):
        return finite(plain(value))
    if isinstance(value, dict):
        return {name: finite(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(item) for item in value]
    if isinstance(value, float) and not isfinite(value):
        return str(value)
    return value
