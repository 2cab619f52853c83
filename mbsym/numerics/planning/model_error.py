"""What a simpler model costs in accuracy, estimated after the fact: along the motion that it gives.

Let x' = f(t, x) be the richer model and x~' = f~(t, x~) the simpler one, both from the same state.  With the residual
r = f - f~ at the simpler motion and J = df/dx there, the difference e = x - x~ obeys to first order

    e' = J(t, x~(t)) e + r(t, x~(t)),        e(0) = 0,

and is integrated beside x~, each part of e in units of what its quantity is measured by.  J e is one sweep of program
differentiation; no matrix is formed.  What is left out is of the order of e^2: where e is more than ``TRUSTED`` of the
motion, nothing is claimed.  A second solution checks it where that is cheap: the richer model itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import frexp
from typing import Any

import numpy as np

from mbsym.algebra.derivative import directional
from mbsym.algebra.program import Node
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.methods.interface import Breakdown, Method, Setting
from mbsym.numerics.orbits.variational import extended
from mbsym.numerics.rows import rows
from mbsym.numerics.specialise import Specialised, substituted

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

    @property
    def dimension(self) -> int:
        """Of x~ and y."""
        return len(self.inputs) - 1

    @cached_property
    def pivots(self) -> Code:
        """Those of the simpler model's matrices."""
        return Code(self._simple.pivots.program, self.inputs, self._simple.pivots.outputs)

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
    try:
        found = rows(method, both, setting, times)
    except Breakdown as reason:
        none = np.full((size, 0), np.nan)
        return ModelEstimate(np.full(size, np.inf), none, none, False, trouble=str(reason))
    states, difference = both.split(found.states)
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
