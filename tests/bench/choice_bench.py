"""Whether ``--accuracy`` chooses the cheapest: every scene with an independent solution, at 1e-4 and 1e-8.

    python tests/bench/choice_bench.py [scene ...]

The plan's setting and a ladder of methods (midpoint rules and SciPy's explicit ones apart), arithmetics and
tolerances (third of a decade) or steps (factors of sqrt 2) are run over the whole time, in one process, interleaved;
the cheapest of those whose true error reaches the target is what the plan is held against:

    ratio = processor time of the plan's setting / that of the cheapest other one

The error is the one against solutions of equations written by hand, at irregular times.  A setting counts only if its
error, doubled, is within the target, as the plan's has to be: one that happens to be good enough at these places is not
known to be.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

from truth.independent.scenes import SCENES, Scene  # noqa: E402
from truth.independent.solve import places  # noqa: E402

import mbsym  # noqa: E402
from mbsym.algebra.failures import Failure  # noqa: E402
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64  # noqa: E402
from mbsym.numerics.methods.interface import Breakdown, Method, Setting, Unusable  # noqa: E402
from mbsym.numerics.methods.table import METHODS  # noqa: E402
from mbsym.numerics.planning.models import modelled  # noqa: E402
from mbsym.numerics.planning.plan import Accuracy, Plan  # noqa: E402
from mbsym.numerics.planning.planning import planned  # noqa: E402
from mbsym.numerics.planning.reduced import reduced  # noqa: E402
from mbsym.numerics.scenario import Scenario, scenario  # noqa: E402
from mbsym.numerics.separable import completing  # noqa: E402
from mbsym.numerics.trade.trial import trial_of  # noqa: E402

TRUTH = HERE.parent / "truth" / "independent"
SOLUTIONS = json.loads((TRUTH / "solutions.json").read_text(encoding="utf-8"))
SIZES = json.loads((TRUTH / "sizes.json").read_text(encoding="utf-8"))

#: Van der Pol's oscillator about its highest velocity, from where its error comes.
PEAK = json.loads((TRUTH / "peak.json").read_text(encoding="utf-8"))

TARGETS = (1e-4, 1e-8)
ROWS = 101

#: What is tried besides the plan's setting; SciPy's explicit methods are the compiled ones at a multiple of their cost.
RIVALS = ("dop853", "rk45", "rk4", "radau", "lsoda", "bdf", "taylor")

#: Tolerances from coarse to fine; a ladder ends where the error has been within the target so often.
TOLERANCES, ENOUGH = 10.0 ** -np.arange(2.0, 14.01, 1 / 3), 2

#: Where a run costs so many times what is known to do, its ladder goes no further.
DEAR = 6.0


@dataclass(frozen=True)
class Way:
    """A method with its setting; ``complete`` makes whole states of it."""

    method: Method
    setting: Setting
    scalar: str
    label: str


@dataclass(frozen=True)
class Outcome:
    """The plan's seconds and true error beside the cheapest rival's; ``rival`` "" where none reaches the target."""

    scene: str
    target: float
    plan: Plan
    label: str
    seconds: float
    error: float
    rival: str
    least: float
    rival_error: float

    @property
    def ratio(self) -> float:
        return self.seconds / self.least if self.least < inf else 0.0


def scene_of(name: str) -> Scene:
    return next(scene for scene in SCENES if scene.name == name)


def outcome(name: str, target: float, say: Callable[[str], None] = lambda text: None) -> Outcome:
    """One scene at one target.

    All integrate the plan's equations, without what rests: methods and settings are compared, not models.
    """
    scene = scene_of(name)
    given = scenario(mbsym.loads(scene.text).system)
    times = np.linspace(0.0, scene.time, ROWS)
    plan = planned(given, Accuracy(target), times)
    chosen, dynamics = _of_plan(plan, given)
    judge = _Judge(scene, times)
    error = judge.error(dynamics, chosen)
    best, least, best_error = None, inf, inf
    for way in _reaching(judge, dynamics, target, say):
        seconds, wrong = judge.seconds(dynamics, way, 3), judge.error(dynamics, way)
        if seconds < least:
            best, least, best_error = way, seconds, wrong
    own = judge.seconds(dynamics, chosen, 9)
    if best is not None:  # in turn, so that whatever else the machine does hits both
        both = [(judge.seconds(dynamics, chosen, 3), judge.seconds(dynamics, best, 3)) for _ in range(7)]
        own, least = (min(column) for column in zip(*both, strict=True))
    label = "" if best is None else best.label
    return Outcome(name, target, plan, chosen.label, own, error, label, least, best_error)


def _of_plan(plan: Plan, given: Scenario) -> tuple[Way, Any]:
    dynamics = modelled(given, plan.model)
    method = METHODS[plan.method]
    fineness = plan.setting.step or plan.setting.tolerance
    return Way(method, plan.setting, plan.scalar, f"{plan.method} {fineness:.2g} {plan.scalar}"), dynamics


def _reaching(judge: _Judge, dynamics: Any, target: float, say: Callable[[str], None]) -> Iterator[Way]:
    """Of every method and arithmetic the coarsest settings that reach the target."""
    known = inf
    for name in RIVALS:
        if name not in METHODS:
            continue
        method = METHODS[name]
        for scalar in (FLOAT64, FLOAT32) if FLOAT32 in method.traits.scalars else (FLOAT64,):
            say(f"{name}, {scalar}")
            good = 0
            for setting in _ladder(method, float(judge.times[-1])):
                way = Way(method, setting, scalar, f"{name} {setting.step or setting.tolerance:.2g} {scalar}")
                started = time.thread_time()
                error = judge.error(dynamics, way)
                spent = time.thread_time() - started
                if 2 * error <= target:
                    good += 1
                    known = min(known, judge.seconds(dynamics, way, 1))
                    yield way
                if good == ENOUGH or spent > max(DEAR * known * 2, 1.0 if known == inf else 0.0, 0.05):
                    break


def _ladder(method: Method, end: float) -> Iterator[Setting]:
    if method.traits.fixed:
        for power in np.arange(2.0, 17.01, 0.5):
            yield Setting(step=min(end / 2**power, end / (ROWS - 1)))
        return
    for tolerance in TOLERANCES:
        yield Setting(float(f"{tolerance:.1e}"))


class _Judge:
    """Runs ways on one scene; errors at the places of the independent solution, seconds for the rows."""

    def __init__(self, scene: Scene, times: Any) -> None:
        self.times = times
        more = PEAK if scene.name == "van der pol" else {"times": [], "states": []}
        at = np.array([*places(scene.time), *more["times"]])
        order = np.argsort(at)
        self.places = at[order]
        self.truth = np.array([*SOLUTIONS[scene.name]["states"], *more["states"]], dtype=np.longdouble).T[:, order]
        size = np.max(np.abs(self.truth), axis=1)
        self.size = np.maximum(size, SIZES[scene.name]) if scene.name in SIZES else size

    def error(self, dynamics: Any, way: Way) -> float:
        """inf where a run breaks down."""
        at = np.union1d([0.0], self.places)
        if way.method.traits.fixed:  # such a method is judged at the ends of its steps, which the places then are
            at = np.union1d(at, self.times)
        try:
            states = trial_of(self._whole(dynamics, way), dynamics, way.setting, at, way.scalar).whole().states
        except (Breakdown, Unusable, Failure):
            return inf
        found = states[:, np.searchsorted(at, self.places)]
        with np.errstate(all="ignore"):
            wrong = np.max(np.abs(found - self.truth), axis=1) / np.where(self.size > 0, self.size, 1)
        worst = float(np.max(wrong))
        return worst if np.isfinite(worst) else inf

    def seconds(self, dynamics: Any, way: Way, repeats: int) -> float:
        """The least processor time of some runs that show the rows; compiling is not counted."""
        method = self._whole(dynamics, way)
        return min(trial_of(method, dynamics, way.setting, self.times, way.scalar).seconds for _ in range(repeats))

    @staticmethod
    def _whole(dynamics: Any, way: Way) -> Method:
        resting = reduced(dynamics)
        return way.method if resting is None or not resting.proved else completing(resting, way.method)


def main() -> None:
    chosen = sys.argv[1:] or [scene.name for scene in SCENES]
    heads = ("scene", "target", "plan", "error", "ms", "cheapest", "error", "ms")
    print("{:12} {:>7}  {:26} {:>8} {:>8}   {:26} {:>8} {:>8}  ratio".format(*heads))
    worst = 0.0
    for name in chosen:
        for target in TARGETS:
            say = lambda text, name=name: print(f"  {name}: {text}        ", end="\r", file=sys.stderr)  # noqa: E731
            one = outcome(name, target, say)
            worst = max(worst, one.ratio)
            print(
                f"{name:12} {target:7.0e}  {one.label:26} {one.error:8.1e} {one.seconds * 1e3:8.3g}   "
                f"{one.rival or 'none':26} {one.rival_error:8.1e} {one.least * 1e3:8.3g}  {one.ratio:5.2f}",
                flush=True,
            )
    print(f"largest ratio {worst:.2f} (at most 1.5 is aimed at)")


if __name__ == "__main__":
    main()
