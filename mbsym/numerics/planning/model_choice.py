"""Which model is enough for an accuracy: the cheapest whose estimated error leaves room for that of the integration.

Candidates are held against the most faithful model, the cheapest first.  A look at the residual along a coarse motion
(its double integral, as if nothing answered to it) spares hopeless ones; the others are estimated by the equation of
the difference (below), and that by a rerun with the faithful model where it is cheap.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import frexp, inf, isfinite
from typing import Any

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.derivative import directional
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node
from mbsym.expressions.message import Message
from mbsym.model.loads import EXACT
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.ensembles.parametrised import parametrised
from mbsym.numerics.kernels import arrays
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Method, Setting, compiled_kernel
from mbsym.numerics.orbits.variational import extended
from mbsym.numerics.planning.models import Model, droppable, faithful, modelled, orders, scenario_of
from mbsym.numerics.scenario import Scenario, Specialised, substituted
from mbsym.numerics.trade.trial import trial_of

# What a simpler model costs in accuracy, estimated after the fact: along the motion that it gives.
#
# Let x' = f(t, x) be the richer model and x~' = f~(t, x~) the simpler one, both from the same state.  With the residual
# r = f - f~ at the simpler motion and J = df/dx there, the difference e = x - x~ obeys to first order
#
#     e' = J(t, x~(t)) e + r(t, x~(t)),        e(0) = 0,
#
# and is integrated beside x~, each part of e in units of what its quantity is measured by.  J e is one sweep of program
# differentiation; no matrix is formed.  What is left out is of the order of e^2: where e is more than ``TRUSTED`` of
# the motion, nothing is claimed.  A second solution checks it where that is cheap: the richer model itself.


#: Beyond this part of the motion, what is of second order in the difference counts.
TRUSTED = 0.03

#: The estimate and a rerun agree where they are never apart by more than this part of the larger one.
AGREEMENT = 0.5


@dataclass(frozen=True)
class ModelEstimate:
    """The largest |x_i - x~_i| of the motion over ``scale_i``, shape (2n,): ``by_quantity``; and how that is known.

    ``trusted``: the difference is small enough for its equation; ``states`` are x~ (2n, m) and ``difference`` e (2n, m)
    at the times asked for.  ``confirmed``: rerun with the richer model, it is that difference; None: not rerun.
    """

    by_quantity: Any
    states: Any
    difference: Any
    trusted: bool
    confirmed: bool | None = None
    trouble: str = ""

    @property
    def largest(self) -> float:
        return float(np.max(self.by_quantity, initial=0.0))


class Propagated(Dynamics):
    """(x~, y): x~' = f~(t, x~) and y_i' = (J (u s y) + r)_i / (u s_i), where e_i = u s_i y_i.

    ``scale`` s (2n,) is what each quantity is measured by, ``unit`` u the relative error that y = 1 stands for; both
    are taken as the powers of two below them, so that they round nothing.
    """

    def __init__(self, simple: Dynamics, rich: Dynamics, scale: Sequence[float], unit: float) -> None:
        if simple.inputs != rich.inputs:
            raise ValueError("both models need the same coordinates")
        super().__init__(extended(simple.scenario, [Fraction(0)] * simple.dimension), simple.ring)
        self._simple, self._rich = simple, rich
        self.weights = tuple(_power_of_two(unit) * _power_of_two(float(s)) for s in scale)
        self.differences = tuple(f"difference of {name}" for name in simple.inputs[1:])
        self.inputs = (*simple.inputs, *self.differences)
        # Rates keep what is on constraints there, and nothing leads back: small errors of steps are no matter here.
        self.__dict__["constraints"] = None

    @cached_property
    def pivots(self) -> Code:
        """Those of the simpler model's matrices."""
        return Code(self._simple.pivots.program, self.inputs, self._simple.pivots.outputs)

    @cached_property
    def mass_matrix(self) -> Code:
        """That of the simpler model."""
        return Code(self._simple.mass_matrix.program, self.inputs, self._simple.mass_matrix.outputs)

    @cached_property
    def _specialised(self) -> Specialised:
        return Specialised()

    @cached_property
    def right_hand_side(self) -> Code:
        fresh = self._specialised
        plain = self._rates(fresh, self._simple)
        full = self._rates(fresh, self._rich)
        states = [fresh.input(name) for name in self._simple.inputs[1:]]
        scaled = [fresh.number(w) * fresh.input(name) for w, name in zip(self.weights, self.differences, strict=True)]
        carried = self._carried(fresh, full, states, scaled)
        growth = []
        for w, along, a, b in zip(self.weights, carried, full, plain, strict=True):
            growth.append(fresh.number(1 / w) * (along + self._residual(a, b)))
        return Code(fresh, self.inputs, (*plain, *growth))

    @staticmethod
    def _residual(rich: Node, simple: Node) -> Node:
        """r = f - f~."""
        return rich - simple

    @staticmethod
    def _carried(program: Specialised, full: Sequence[Node], states: Sequence[Node], e: Sequence[Node]) -> list[Node]:
        """J e."""
        return list(directional(program, full, states, e))

    @staticmethod
    def _rates(fresh: Specialised, dynamics: Dynamics) -> list[Node]:
        code = dynamics.right_hand_side
        return substituted(code.program, code.outputs, fresh)

    def split(self, states: Any) -> tuple[Any, Any]:
        """(x~, e) of states of this system, shapes (2n, m)."""
        weights = np.array([float(w) for w in self.weights])[:, np.newaxis]
        return states[: len(weights)], weights * states[len(weights) :]


def model_error(
    simple: Dynamics,
    rich: Dynamics,
    method: Method,
    setting: Setting,
    times: Sequence[float],
    scale: Any,
    unit: float,
) -> ModelEstimate:
    """The error of ``simple`` against ``rich`` over ``times``, by the equation of the difference.

    ``setting`` is that of the integration; ``unit`` the relative error of interest.  Never raises Breakdown: where the
    motion or the difference ends early, the estimate is not trusted and says why.
    """
    both = Propagated(simple, rich, [float(s) for s in scale], unit)
    size = simple.dimension
    trial = trial_of(method, both, setting, times)
    if trial.ended:
        none = np.full((size, 0), np.nan)
        return ModelEstimate(np.full(size, np.inf), none, none, False, trouble=str(trial.ended))
    states, difference = both.split(trial.states)
    by_quantity = np.max(np.abs(difference), axis=1) / np.asarray(scale, dtype=float)
    good = bool(np.all(np.isfinite(by_quantity)) and np.max(by_quantity) <= TRUSTED)
    trouble = "" if good else "the difference is no longer small against the motion"
    return ModelEstimate(by_quantity, states, difference, good, trouble=trouble)


def confirmed(estimate: ModelEstimate, rerun: Any, scale: Any, noise: float) -> ModelEstimate:
    """The estimate beside a rerun with the richer model at the same times, ``rerun`` (2n, m).

    The larger of the two counts; where the equation is not trusted, the rerun alone.  ``noise`` is the relative error
    of the two runs themselves: below it nothing is told apart.
    """
    scale = np.asarray(scale, dtype=float)
    true = rerun - estimate.states
    measured = np.max(np.abs(true), axis=1) / scale
    apart = np.max(np.abs(true - estimate.difference), axis=1) / scale
    agree = apart <= AGREEMENT * np.maximum(measured, estimate.by_quantity) + noise
    larger = np.maximum(measured, estimate.by_quantity) if estimate.trusted else measured
    return replace(estimate, by_quantity=larger, difference=true, confirmed=bool(np.all(agree)))


def _power_of_two(x: float) -> Fraction:
    """The power of two at or below a positive number."""
    if not x > 0:
        return Fraction(1)
    exponent = frexp(x)[1] - 1
    return Fraction(2) ** exponent


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
        return Setting(tolerance=min(1e-6, max(1e-3 * float(np.min(self.targets)), 1e-13)))

    @cached_property
    def truth(self) -> Any | None:
        """The states of the faithful model at the times; None where they are dear, or do not come to the end."""
        coarse = trial_of(self.method, self.rich, replace(self.setting, tolerance=1e-4), self.times)
        if coarse.ended or coarse.cost >= CHEAP / 10:
            return None
        return trial_of(self.method, self.rich, self.setting, self.times).states


def richest(scenario: Scenario) -> tuple[Model, Dynamics, str]:
    """The most faithful model that has a program, and why it is not the exact one, if so."""
    full_model = faithful(scenario)
    reason = ""
    for order in (full_model.gravity, *reversed(orders(scenario))):
        model = Model(order)
        try:
            dynamics = modelled(scenario, model)
            assert dynamics.right_hand_side.outputs
            return model, dynamics, reason
        except Failure as trouble:
            reason = Message("there is no program for [[label]]: [[trouble]]", label=model.label, trouble=trouble)
    dynamics = modelled(scenario, Model())
    assert dynamics.right_hand_side.outputs
    return Model(), dynamics, reason


def model_settled(scene: Scene, model: Model) -> ModelChoice:
    """A model that somebody settled, with its error, however large.  Raises Failure where it has no program."""
    none = np.zeros(len(scene.targets))
    whole = Tried(scene.model, scene.rich.right_hand_side.operations, 0.0, none, Certainty.PROVED)
    if model == scene.model:
        return ModelChoice(whole, scene.rich, (whole,), scene.model)
    dynamics = modelled(scene.scenario, model)
    own = _estimated(scene, model, dynamics)
    return ModelChoice(own, dynamics, (whole, own), scene.model)


def model_chosen(scene: Scene, watch: Callable[[str], None] = lambda text: None) -> ModelChoice:
    """The cheapest model that is good enough; the faithful one where none is."""
    operations = scene.rich.right_hand_side.operations
    none = np.zeros(len(scene.targets))
    whole = Tried(scene.model, operations, 0.0, none, Certainty.PROVED)
    taken, dynamics, tried = whole, scene.rich, [whole]
    for model in _candidates(scene):
        watch(model.label)
        candidate = _judged(scene, model)
        if candidate is None:
            continue
        item, own = candidate
        tried.append(item)
        if item.ratio <= PART and _saves(own, dynamics):
            taken, dynamics = item, own
            break
    fewer = None if taken.model.linear else _without(scene, taken.model, watch)
    if fewer is not None and _saves(fewer[1], dynamics):
        taken, dynamics = fewer
        tried.append(taken)
    return ModelChoice(taken, dynamics, tuple(tried), scene.model)


def _saves(simple: Dynamics, rich: Dynamics) -> bool:
    return simple.right_hand_side.in_any_units < SAVES * rich.right_hand_side.in_any_units


def _candidates(scene: Scene) -> list[Model]:
    """Simpler models, those with fewer operations first as a rule."""
    candidates = []
    system = scene.scenario.system
    if system.motion and not system.constraints and not scene.rich.in_states:
        candidates.append(replace(scene.model, linear=True))
    candidates += [Model(order) for order in orders(scene.scenario) if order != scene.model.gravity and order != EXACT]
    return candidates


def _judged(scene: Scene, model: Model) -> tuple[Tried, Dynamics] | None:
    """A model with its error; None where there is no program for it, or it saves nothing."""
    try:
        return _held_against(scene, model)
    except Failure:
        return None


def _held_against(scene: Scene, model: Model) -> tuple[Tried, Dynamics] | None:
    """A model with its error; None where it saves nothing.  Raises Failure where it has no program."""
    dynamics = modelled(scene.scenario, model)
    operations = dynamics.right_hand_side.operations
    if not _saves(dynamics, scene.rich):
        return None
    naive = _naive(scene, dynamics)
    if not naive <= HOPELESS * PART:
        errors = np.full(len(scene.targets), inf)
        why = Message("far off by its residual")
        return Tried(model, operations, naive, errors, Certainty.ESTIMATED, why), dynamics
    return _estimated(scene, model, dynamics), dynamics


def _estimated(scene: Scene, model: Model, dynamics: Dynamics) -> Tried:
    """A model with its error by the equation of the difference, and by a rerun where that is cheap."""
    operations = dynamics.right_hand_side.operations
    unit = float(np.min(scene.targets))
    estimate = model_error(dynamics, scene.rich, scene.method, scene.setting, scene.times, scene.scale[:-1], unit)
    rerun, how, why = scene.truth, Certainty.ESTIMATED, ""
    reached = estimate.states.shape[1] == len(scene.times)
    if rerun is not None and reached:
        trusted = estimate.trusted
        estimate = confirmed(estimate, rerun, scene.scale[:-1], 0.1 * unit)
        how, why = (
            Certainty.MEASURED,
            "" if estimate.confirmed or not trusted else Message("a rerun with the richer model says otherwise"),
        )
    elif not estimate.trusted:
        errors = np.full(len(scene.targets), inf)
        return Tried(model, operations, inf, errors, Certainty.ESTIMATED, estimate.trouble, estimate)
    errors = np.append(estimate.by_quantity, _energy_error(scene, dynamics, estimate))
    targeted = np.isfinite(scene.targets)
    ratio = float(np.max(errors[targeted] / scene.targets[targeted]))
    return Tried(model, operations, ratio if not why else inf, errors, how, why, estimate)


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
    targeted = np.isfinite(scene.targets[:-1])
    if not np.any(targeted):
        return 0.0
    ratio = float(np.max(errors[targeted] / scene.targets[:-1][targeted]))
    return ratio if isfinite(ratio) else inf


def _running(values: Any, steps: Any) -> Any:
    """The integral from 0 to each time by trapezia."""
    pieces = 0.5 * (values[:, 1:] + values[:, :-1]) * steps
    return np.hstack([np.zeros((len(values), 1)), np.cumsum(pieces, axis=1)])


def _energy_error(scene: Scene, simple: Dynamics, estimate: ModelEstimate) -> float:
    """The largest error of h(t) - h(0) over the energy's scale; 0 where nobody asked."""
    if not isfinite(scene.targets[-1]):
        return 0.0
    with np.errstate(all="ignore"):
        true = compiled_kernel(scene.rich, "relative_energy")(
            np.vstack([scene.times, estimate.states + estimate.difference])
        )
        own = compiled_kernel(simple, "relative_energy")(np.vstack([scene.times, estimate.states]))
        apart = (true[0] - true[0, 0]) - (own[0] - own[0, 0])
    worst = float(np.max(np.abs(apart))) / float(scene.scale[-1])
    return worst if isfinite(worst) else inf


# --- parameters that this motion does not feel ---


def _without(scene: Scene, base: Model, watch: Callable[[str], None]) -> tuple[Tried, Dynamics] | None:
    """The model without every parameter that may be taken as zero; None where there is none."""
    ranked = _felt(scene, base)
    names = [name for name, ratio in ranked if 0 < ratio <= HOPELESS * PART]
    looked_at = False
    while names:
        model = replace(base, without=tuple(names))
        watch(model.label)
        try:
            candidate = _held_against(scene, model)
        except Failure:  # a mass that nothing else replaces, a divisor: it stays, and the others are looked at
            able = names if looked_at else [name for name in names if _has_program(scene, base, name)]
            looked_at = True
            names = able if able != names else names[:-1]
            continue
        if candidate is None or candidate[0].ratio <= PART:
            return candidate
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
    scenario = scene.scenario
    if scene.rich.in_states:
        return ()
    names = [name for name in droppable(scenario.system) if scenario.parameters[name] != 0]
    if not names or len(names) > MOST or scene.rich.right_hand_side.operations > LONG:
        return ()
    program = parametrised(scenario_of(scenario, base), names)
    try:
        accelerations = arrays.kernel(program.right_hand_side)
    except Failure:
        return ()
    few = np.linspace(0, len(scene.times) - 1, min(len(scene.times), 2_000)).astype(int)
    fewer = replace(scene, times=scene.times[few], states=scene.states[:, few])
    values = np.array([[float(scenario.parameters[name])] for name in names])
    points = np.vstack([fewer.times, fewer.states, np.tile(values, (1, len(few)))])
    with np.errstate(all="ignore"):
        usual = accelerations(points)
        ratios = []
        for place, name in enumerate(names):
            less = points.copy()
            less[1 + len(scene.states) + place] = 0.0
            ratios.append((name, _integrated(fewer, (usual - accelerations(less))[program.size :])))
    return sorted(ratios, key=lambda item: item[1])
