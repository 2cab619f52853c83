"""Which model is enough for an accuracy: the cheapest whose estimated error leaves room for that of the integration.

Candidates are held against the most faithful model, the cheapest first.  A look at the residual along a coarse motion
(its double integral, as if nothing answered to it) spares hopeless ones; the others are estimated by the equation of
the difference (``mbsym.numerics.planning.model_error``), and that by a rerun with the faithful model where it is cheap.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf, isfinite
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.expressions.message import Message
from mbsym.model.loads import EXACT
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import parametrised
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import FLOAT64
from mbsym.numerics.methods.interface import Breakdown, Method, Setting
from mbsym.numerics.methods.kept import compiled_kernel
from mbsym.numerics.planning.model_error import ModelEstimate, confirmed, model_error
from mbsym.numerics.planning.models import Model, droppable, faithful, modelled, orders, scenario_of
from mbsym.numerics.planning.prices import cost
from mbsym.numerics.rows import Rows, rows
from mbsym.numerics.scenario import Scenario

#: The part of the tolerable error that a model may take.
PART = 0.5

#: Where the naive error is so many times too large, no closer look is taken.
HOPELESS = 30.0

#: A model with more operations than this part of those of the faithful one saves nothing worth an error.
SAVES = 0.9

#: Parameters are looked at where the equations have at most so many operations; and at most so many of them.
LONG, MOST = 3_000, 40

#: The rerun is cheap where a run costs less (``mbsym.numerics.planning.prices``).
CHEAP = 3.0


@dataclass(frozen=True)
class Tried:
    """A model and its error: ``ratio`` is the largest over quantities of error / target; ``errors`` (2n + 1,)."""

    model: Model
    operations: int
    ratio: float
    errors: Any
    how: Certainty
    why: str = ""
    estimate: ModelEstimate | None = None

    @property
    def worst(self) -> float:
        return float(np.max(self.errors[:-1], initial=0.0))


@dataclass(frozen=True)
class ModelChoice:
    """The model taken, its dynamics, and the others that were tried; ``faithful`` is what all are held against."""

    taken: Tried
    dynamics: Dynamics
    tried: tuple[Tried, ...]
    faithful: Model


@dataclass(frozen=True)
class Scene:
    """What the choice of a model needs to know: the motion in outline, and what is tolerable.

    ``times`` (m,), ``states`` (2n, m) of a coarse run of the faithful model; ``scale`` and ``targets`` (2n + 1,).
    """

    scenario: Scenario
    rich: Dynamics
    model: Model
    times: Any
    states: Any
    scale: Any
    targets: Any
    method: Method

    @property
    def setting(self) -> Setting:
        """Fine enough to tell a model's error from that of the integration."""
        finest = float(np.min(self.targets))
        small = min(1.0, float(np.min(self.scale[:-1])))
        return Setting(tolerance=min(1e-6, max(1e-3 * finest * small, 1e-13)))


def richest(scenario: Scenario) -> tuple[Model, Dynamics, str]:
    """The most faithful model that has a program, and why it is not the exact one, if so."""
    wanted = faithful(scenario)
    reason = ""
    for order in (wanted.gravity, *reversed(orders(scenario))):
        model = Model(order)
        try:
            found = modelled(scenario, model)
            assert found.right_hand_side.outputs
            return model, found, reason
        except Failure as trouble:
            reason = Message("there is no program for [[label]]: [[trouble]]", label=model.label, trouble=trouble)
    found = modelled(scenario, Model())
    assert found.right_hand_side.outputs
    return Model(), found, reason


def model_settled(scene: Scene, model: Model) -> ModelChoice:
    """A model that somebody settled, with its error, however large.  Raises Failure where it has no program."""
    none = np.zeros(len(scene.targets))
    whole = Tried(scene.model, scene.rich.right_hand_side.operations, 0.0, none, Certainty.PROVED)
    if model == scene.model:
        return ModelChoice(whole, scene.rich, (whole,), scene.model)
    dynamics = modelled(scene.scenario, model)
    own = _estimated(scene, model, dynamics, _Truth(scene))
    return ModelChoice(own, dynamics, (whole, own), scene.model)


def model_chosen(scene: Scene, watch: Callable[[str], None] = lambda text: None) -> ModelChoice:
    """The cheapest model that is good enough; the faithful one where none is."""
    operations = scene.rich.right_hand_side.operations
    none = np.zeros(len(scene.targets))
    whole = Tried(scene.model, operations, 0.0, none, Certainty.PROVED)
    taken, dynamics, tried = whole, scene.rich, [whole]
    truth = _Truth(scene)
    for model in _candidates(scene):
        watch(model.label)
        found = _judged(scene, model, truth)
        if found is None:
            continue
        item, own = found
        tried.append(item)
        if item.ratio <= PART and item.operations < SAVES * taken.operations:
            taken, dynamics = item, own
            break
    fewer = None if taken.model.linear else _without(scene, taken.model, truth, watch)
    if fewer is not None and fewer[0].operations < SAVES * taken.operations:
        taken, dynamics = fewer
        tried.append(taken)
    return ModelChoice(taken, dynamics, tuple(tried), scene.model)


def _candidates(scene: Scene) -> list[Model]:
    """Simpler models, those with fewer operations first as a rule."""
    found = []
    system = scene.scenario.system
    if system.motion and not system.constraints and not scene.rich.in_states:
        found.append(replace(scene.model, linear=True))
    found += [Model(order) for order in orders(scene.scenario) if order != scene.model.gravity and order != EXACT]
    return found


class _Truth:
    """The motion of the faithful model at the times, found when it is first asked for; None where it is dear."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._found: Rows | None = None
        self._asked = False

    def states(self) -> Any | None:
        scene = self._scene
        if not self._asked:
            self._asked = True
            try:
                coarse = rows(scene.method, scene.rich, replace(scene.setting, tolerance=1e-4), scene.times)
                if cost(scene.rich, scene.method.traits.name, FLOAT64, coarse.work) < CHEAP / 10:
                    self._found = rows(scene.method, scene.rich, scene.setting, scene.times)
            except Breakdown:
                pass
        return None if self._found is None else self._found.states


def _judged(scene: Scene, model: Model, truth: _Truth) -> tuple[Tried, Dynamics] | None:
    """A model with its error; None where there is no program for it, or it saves nothing."""
    try:
        return _held_against(scene, model, truth)
    except Failure:
        return None


def _held_against(scene: Scene, model: Model, truth: _Truth) -> tuple[Tried, Dynamics] | None:
    """A model with its error; None where it saves nothing.  Raises Failure where it has no program."""
    dynamics = modelled(scene.scenario, model)
    operations = dynamics.right_hand_side.operations
    if operations >= SAVES * scene.rich.right_hand_side.operations:
        return None
    naive = _naive(scene, dynamics)
    if not naive <= HOPELESS * PART:
        errors = np.full(len(scene.targets), inf)
        why = Message("far off by its residual")
        return Tried(model, operations, naive, errors, Certainty.ESTIMATED, why), dynamics
    return _estimated(scene, model, dynamics, truth), dynamics


def _estimated(scene: Scene, model: Model, dynamics: Dynamics, truth: _Truth) -> Tried:
    """A model with its error by the equation of the difference, and by a rerun where that is cheap."""
    operations = dynamics.right_hand_side.operations
    unit = float(np.min(scene.targets))
    found = model_error(dynamics, scene.rich, scene.method, scene.setting, scene.times, scene.scale[:-1], unit)
    rerun, how, why = truth.states(), Certainty.ESTIMATED, ""
    reached = found.states.shape[1] == len(scene.times)
    if rerun is not None and reached:
        trusted = found.trusted
        found = confirmed(found, rerun, scene.scale[:-1], 0.1 * unit)
        how, why = (
            Certainty.MEASURED,
            "" if found.confirmed or not trusted else Message("a rerun with the richer model says otherwise"),
        )
    elif not found.trusted:
        errors = np.full(len(scene.targets), inf)
        return Tried(model, operations, inf, errors, Certainty.ESTIMATED, found.trouble, found)
    errors = np.append(found.by_quantity, _energy_error(scene, dynamics, found))
    asked = np.isfinite(scene.targets)
    ratio = float(np.max(errors[asked] / scene.targets[asked]))
    return Tried(model, operations, ratio if not why else inf, errors, how, why, found)


def _naive(scene: Scene, simple: Dynamics) -> float:
    """The residual's integral in the velocities and double integral in the coordinates, beside what is tolerable.

    0, which says nothing, of speeds that are no velocities of positions.
    """
    if scene.rich.in_states:
        return 0.0
    points = np.vstack([scene.times, scene.states])
    with np.errstate(all="ignore"):
        residual = compiled_kernel(scene.rich, "right_hand_side")(points)
        residual = residual - arrays.kernel(simple.right_hand_side)(points)
    return _integrated(scene, residual[simple.size :])


def _integrated(scene: Scene, residual: Any) -> float:
    """rho of the motion that accelerations (n, m) alone make."""
    steps = np.diff(scene.times)
    velocity = _running(residual, steps)
    moved = np.vstack([_running(velocity, steps), velocity])
    errors = np.max(np.abs(moved), axis=1) / scene.scale[:-1]
    asked = np.isfinite(scene.targets[:-1])
    if not np.any(asked):
        return 0.0
    found = float(np.max(errors[asked] / scene.targets[:-1][asked]))
    return found if isfinite(found) else inf


def _running(values: Any, steps: Any) -> Any:
    """The integral from 0 to each time by trapezia."""
    pieces = 0.5 * (values[:, 1:] + values[:, :-1]) * steps
    return np.hstack([np.zeros((len(values), 1)), np.cumsum(pieces, axis=1)])


def _energy_error(scene: Scene, simple: Dynamics, found: ModelEstimate) -> float:
    """The largest error of h(t) - h(0) over the energy's scale; 0 where nobody asked."""
    if not isfinite(scene.targets[-1]):
        return 0.0
    with np.errstate(all="ignore"):
        true = compiled_kernel(scene.rich, "relative_energy")(np.vstack([scene.times, found.states + found.difference]))
        own = compiled_kernel(simple, "relative_energy")(np.vstack([scene.times, found.states]))
        apart = (true[0] - true[0, 0]) - (own[0] - own[0, 0])
    worst = float(np.max(np.abs(apart))) / float(scene.scale[-1])
    return worst if isfinite(worst) else inf


# --- parameters that this motion does not feel ---


def _without(scene: Scene, base: Model, truth: _Truth, watch: Callable[[str], None]) -> tuple[Tried, Dynamics] | None:
    """The model without every parameter that may be taken as zero; None where there is none."""
    ranked = _felt(scene, base)
    names = [name for name, ratio in ranked if 0 < ratio <= HOPELESS * PART]
    looked_at = False
    while names:
        model = replace(base, without=tuple(names))
        watch(model.label)
        try:
            found = _held_against(scene, model, truth)
        except Failure:  # a mass that nothing else replaces, a divisor: it stays, and the others are looked at
            able = names if looked_at else [name for name in names if _has_program(scene, base, name)]
            looked_at = True
            names = able if able != names else names[:-1]
            continue
        if found is None or found[0].ratio <= PART:
            return found
        names.pop()
    return None


def _has_program(scene: Scene, base: Model, name: str) -> bool:
    """Whether the equations can be solved for accelerations without a parameter."""
    try:
        return bool(modelled(scene.scenario, replace(base, without=(name,))).right_hand_side.outputs)
    except Failure:
        return False


def _felt(scene: Scene, base: Model) -> Sequence[tuple[str, float]]:
    """(name, rho of the motion that its terms alone make) for parameters that are not zero, the least felt first.

    Nothing of speeds that are no velocities of positions.
    """
    given = scene.scenario
    if scene.rich.in_states:
        return ()
    names = [name for name in droppable(given.system) if given.parameters[name] != 0]
    if not names or len(names) > MOST or scene.rich.right_hand_side.operations > LONG:
        return ()
    program = parametrised(scenario_of(given, base), names)
    try:
        accelerations = arrays.kernel(program.right_hand_side)
    except Failure:
        return ()
    few = np.linspace(0, len(scene.times) - 1, min(len(scene.times), 2_000)).astype(int)
    fewer = replace(scene, times=scene.times[few], states=scene.states[:, few])
    values = np.array([[float(given.parameters[name])] for name in names])
    points = np.vstack([fewer.times, fewer.states, np.tile(values, (1, len(few)))])
    with np.errstate(all="ignore"):
        usual = accelerations(points)
        found = []
        for place, name in enumerate(names):
            less = points.copy()
            less[1 + len(scene.states) + place] = 0.0
            found.append((name, _integrated(fewer, (usual - accelerations(less))[program.size :])))
    return sorted(found, key=lambda item: item[1])
