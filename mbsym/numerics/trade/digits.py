"""How many digits a quantity keeps: compiled kernels against rigorous balls.

The true value at an exact state comes from the same formulas over ``arb`` balls, with growing precision until the balls
are tight.  Three numbers are told apart for an arithmetic with unit roundoff u:

digits       -log10 of the relative error at the state that is meant, whose inputs had to be rounded first
formula      the same at the rounded state itself: what the formula and its arithmetic cost
condition    max_i sum_j |df_i/dx_j x_j| / s_i, over the parameters, coordinates and velocities: an input known
             to a relative error u gives a result known to condition * u, whatever the formula (Higham, section 1.6)

so a loss of log10(condition) digits is in the question, and only what goes beyond it is in the formula.
Errors are max |error_i| / s_i with the sizes s_i of ``mbsym.numerics.planning.sizes``, which do not depend on units
(``digits``), and for the worst entry of its own (``worst``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, isfinite, log10
from typing import Any

import numpy as np
from flint import arb, ctx

from mbsym.algebra.derivative import gradient, jacobian
from mbsym.algebra.program import Node, Program
from mbsym.algebra.rationals import ball
from mbsym.algebra.ring import Ring
from mbsym.algebra.stable import stabilised
from mbsym.mechanics.constraints.dynamics import ConstrainedDynamics
from mbsym.mechanics.falling import relative_lagrangian
from mbsym.mechanics.programs import ForwardDynamics, forward_dynamics, programs, scene_without_accelerations
from mbsym.mechanics.variables import program_environment
from mbsym.model.system import System
from mbsym.numerics.compensation import Compensation, compensated_code
from mbsym.numerics.kernels.arrays import stepwise
from mbsym.numerics.kernels.interface import FLOAT32, FLOAT64, Code
from mbsym.numerics.kernels.llvm import kernels
from mbsym.numerics.kernels.precise import precise
from mbsym.numerics.planning.sizes import kinds, scales
from mbsym.numerics.scenario import Scenario, Specialised, bound, substituted

#: Digits of a number in each arithmetic, -log10 of its unit roundoff.
FULL = {FLOAT32: 7.22, FLOAT64: 15.95}

#: A ball is tight at this relative radius; more bits than the last entry are never tried.
TIGHT = 1e-30
PRECISIONS = (256, 512, 1024, 2048)

#: A loss beyond log10(condition) is laid to the formula if it exceeds so many digits.
SLACK = 1.5

#: Fewer digits than this are no result.
FEW = 3.0


@dataclass(frozen=True)
class Quantity:
    """A quantity as one program over parameters, prescribed quantities, time and state; ``size`` entries."""

    name: str
    code: Code

    @property
    def size(self) -> int:
        return len(self.code.outputs)


@dataclass(frozen=True)
class Digits:
    """What was found for one quantity in one state.

    ``digits`` and ``worst`` by the arithmetic's name; ``formula`` and ``condition`` as above, ``formula`` in float64.
    ``bits`` is the precision at which the balls were tight, 0 if they never were: then nothing else is known.
    ``norm`` is max |f_i|.
    """

    digits: Mapping[str, float]
    worst: Mapping[str, float]
    formula: float
    condition: float
    bits: int
    norm: float

    @property
    def verdict(self) -> str:
        """full, ill-conditioned, formula or undecided; see the module's head."""
        if not self.bits:
            return "undecided"
        lost = FULL[FLOAT64] - self.formula
        if lost > SLACK + max(0.0, log10(self.condition) if 0 < self.condition < inf else inf):
            return "formula"
        if FULL[FLOAT64] - self.digits[FLOAT64] > SLACK:
            return "ill-conditioned"
        return "full"


def quantities(
    system: System, ring: Ring, with_jacobian: bool = True, solved: ConstrainedDynamics | None = None
) -> tuple[Quantity, ...]:
    """Mass matrix, forcing, accelerations, pivots, energy and the Jacobian of the accelerations, over all inputs.

    Accelerations and pivots are those of ``solved`` where constraints are in them; mass matrix and forcing the tree's.
    """
    equations = programs(system, ring, open_tree=solved is not None)
    names = input_names(system)
    made = [("mass matrix", equations.program, [x for row in equations.mass_matrix for x in row])]
    made.append(("forcing", equations.program, list(equations.forcing)))
    answer: ConstrainedDynamics | ForwardDynamics = solved or forward_dynamics(system, ring)
    made.append(("accelerations", answer.program, list(answer.accelerations)))
    made.append(("pivots", answer.program, list(answer.pivots)))
    program = Program()
    environment = program_environment(system, program)
    kinetic, force = relative_lagrangian(scene_without_accelerations(system, ring, program, environment))
    total = -(kinetic + force)
    velocities = [environment[name] for name in system.velocities]
    for velocity, momentum in zip(velocities, gradient(program, kinetic + force, velocities), strict=True):
        total = total + program.product(velocity, momentum)
    made.append(("energy", program, [total]))
    if with_jacobian:
        states = [answer.environment[name] for name in (*system.coordinates, *system.velocities)]
        rows = jacobian(answer.program, answer.accelerations, states)
        made.append(("Jacobian", answer.program, [x for row in rows for x in row]))
    return tuple(Quantity(name, Code(program, names, tuple(nodes))) for name, program, nodes in made)


def input_names(system: System) -> tuple[str, ...]:
    """The inputs of all quantities, in this order."""
    driven = [item.name for item in system.prescribed]
    return (*system.parameter_names, "pi", *driven, "t", *system.coordinates, *system.velocities)


class Truth:
    """Rigorous values of quantities, and their condition."""

    def __init__(self, system: System, found: Sequence[Quantity]) -> None:
        self.system, self.alike = system, kinds(system)
        self.functions = {q.name: precise(q.code, PRECISIONS[-1]) for q in found}
        self.varied = [
            place
            for place, name in enumerate(input_names(system))
            if name in {*system.parameter_names, *system.coordinates, *system.velocities}
        ]

    def inputs(self, scenario: Scenario, time: Fraction, state: Sequence[Fraction]) -> list[arb]:
        """Balls at the working precision."""
        values = [ball(scenario.parameters[name]) for name in self.system.parameter_names]
        values.append(arb.pi())
        values += [ball(start + rate * time) for start, rate in (scenario.prescribed[p.name] for p in self._driven)]
        return [*values, ball(time), *(ball(x) for x in state)]

    @property
    def evaluations(self) -> int:
        """How many evaluations one quantity in one state takes, about: its value, its sizes and its condition."""
        return 4 + len(self.varied)

    @property
    def _driven(self) -> tuple[Any, ...]:
        return self.system.prescribed

    def value(self, name: str, scenario: Scenario, time: Fraction, state: Sequence[Fraction]) -> tuple[list[arb], int]:
        """(balls, bits); bits is 0 where they are not tight at the largest precision."""
        for bits in PRECISIONS:
            with ctx.workprec(bits):
                balls = self.functions[name](self.inputs(scenario, time, state))
                if tight(balls):
                    return balls, bits
        return balls, 0

    def scales(
        self, name: str, exact: Sequence[arb], scenario: Scenario, time: Fraction, state: Sequence[Fraction]
    ) -> list[arb]:
        """What the errors of the entries are measured by at a state where they are ``exact``."""
        masses: list[arb] = []
        if "mass matrix" in self.functions:
            n = len(self.alike)
            with ctx.workprec(PRECISIONS[0]):
                masses = self.functions["mass matrix"](self.inputs(scenario, time, state))[:: n + 1]
        return scales(name, exact, masses if all(x.is_finite() for x in masses) else (), self.alike)

    def condition(
        self, name: str, scenario: Scenario, time: Fraction, state: Sequence[Fraction], sizes: Sequence[arb] = ()
    ) -> float:
        """By differences in 512 bits, which are derivatives for all that matters here; sizes: all the largest entry."""
        with ctx.workprec(512):
            inputs = self.inputs(scenario, time, state)
            base = self.functions[name](inputs)
            sums = [arb(0)] * len(base)
            tiny = arb(2) ** -200
            for place in self.varied:
                if not inputs[place].is_zero():
                    moved = list(inputs)
                    moved[place] = inputs[place] * (1 + tiny)
                    values = self.functions[name](moved)
                    sums = [s + abs(a - b) for s, a, b in zip(sums, values, base, strict=True)]
            whole = max((abs(x.mid()) for x in base), default=arb(0))
            pairs = zip(sums, sizes or [whole] * len(sums), strict=True)
            parts = [float((s / tiny / size).mid()) if size > 0 else inf for s, size in pairs if not s.is_zero()]
        condition_number = max(parts, default=1.0)
        return condition_number if isfinite(condition_number) else inf


def tight(balls: Sequence[arb]) -> bool:
    if not all(x.is_finite() for x in balls):
        return False
    norm = max((abs(x.mid()) for x in balls), default=arb(0))
    return all(x.is_exact() or x.rad() <= norm * TIGHT * (TIGHT if x.contains(0) else 1) for x in balls)


class Arithmetic:
    """All quantities for one scenario, in float32 and float64.

    ``compiled``: by the kernels that a simulation would use.  Else by the same operations one by one, in NumPy's
    numbers: that differs by contracted multiplications and additions only, and a scenario costs no compilation.
    """

    def __init__(self, scenario: Scenario, found: Sequence[Quantity], compiled: bool = True) -> None:
        self.quantities, self.scenario = tuple(found), scenario
        self.compiled = compiled
        self.slopes_of: Sequence[Node] | None = None
        fresh = bound(scenario)
        names = ("t", *scenario.system.coordinates, *scenario.system.velocities)
        codes: dict[str, Code] = {}
        self.compensations: dict[str, Compensation] = {}
        for q in found:
            codes[q.name.replace(" ", "_")] = self._code(q, fresh, names)
        better = {**codes, **{name: compensation.code for name, compensation in self.compensations.items()}}
        chosen = {FLOAT32: codes, FLOAT64: better}
        if compiled:
            self._kernels = {scalar: kernels(chosen[scalar], scalar) for scalar in FULL}
        else:
            self._kernels = {s: {name: stepwise(code, s) for name, code in chosen[s].items()} for s in FULL}

    def _code(self, q: Quantity, fresh: Specialised, names: tuple[str, ...]) -> Code:
        """As ``mbsym.numerics.dynamics`` makes it; the kernels of simulations carry accelerations in pairs where that
        keeps digits, and so do these."""
        if q.name == "Jacobian" and self.slopes_of is not None:
            states = [fresh.input(name) for name in names[1:]]
            nodes = [x for row in jacobian(fresh, self.slopes_of, states) for x in row]
            return Code(fresh, names, tuple(stabilised(fresh, nodes)))
        nodes = stabilised(fresh, substituted(q.code.program, q.code.outputs, fresh), q.name == "energy")
        code = Code(fresh, names, tuple(nodes))
        if q.name == "accelerations":
            self.slopes_of = nodes
        if q.name in ("accelerations", "pivots"):
            better = compensated_code(self.scenario, code, range(len(nodes)))
            if better is not None:
                self.compensations[q.name] = better
        return code

    def values(self, name: str, scalar: str, inputs: Any) -> Any:
        """Results for one state (t, q, q'), as float64 numbers."""
        with np.errstate(all="ignore"):
            return np.asarray(self._kernels[scalar][name.replace(" ", "_")](inputs), dtype=float)


def measured(
    truth: Truth,
    arithmetic: Arithmetic,
    name: str,
    scenario: Scenario,
    state: Sequence[Fraction],
    time: Fraction = Fraction(0),
) -> Digits:
    """The digits of one quantity in one state."""
    exact, bits = truth.value(name, scenario, time, state)
    if not bits:
        nothing = dict.fromkeys(FULL, 0.0)
        return Digits(nothing, nothing, 0.0, inf, 0, inf)
    norm = max((abs(float(x.mid())) for x in exact), default=0.0)
    inputs = np.array([float(x) for x in (time, *state)])
    sizes = truth.scales(name, exact, scenario, time, state)
    digits, worst = {}, {}
    for scalar, full in FULL.items():
        digits[scalar], worst[scalar] = compared(arithmetic.values(name, scalar, inputs), exact, full, sizes)
    rounded = [Fraction(x) for x in inputs]
    there, known = truth.value(name, scenario, rounded[0], rounded[1:])
    formula = 0.0
    if known:
        own = truth.scales(name, there, scenario, rounded[0], rounded[1:])
        formula = compared(arithmetic.values(name, FLOAT64, inputs), there, FULL[FLOAT64], own)[0]
    return Digits(digits, worst, formula, truth.condition(name, scenario, time, state, sizes), bits, norm)


def compared(values: Any, exact: Sequence[arb], full: float, sizes: Sequence[arb] = ()) -> tuple[float, float]:
    """(digits relative to ``sizes``, digits of the worst entry of its own), between 0 and ``full``.

    Without sizes every entry is measured by the largest one.
    """
    with ctx.workprec(512):
        whole = max((abs(x).upper() for x in exact), default=arb(0))
        largest, worst = arb(0), full
        for value, x, size in zip(values, exact, sizes or [whole] * len(exact), strict=True):
            if not isfinite(value):
                return 0.0, 0.0
            error = abs(arb(float(value)) - x).upper()
            if error > 0 and not size > 0:
                return 0.0, 0.0
            largest = max(largest, error / size if size > 0 else arb(0))
            if not x.contains(0):
                worst = min(worst, digits_of(error / abs(x), full))
        return digits_of(largest, full), worst


def digits_of(error: arb, full: float) -> float:
    value = float(error.mid())
    return full if value <= 0 else min(full, max(0.0, -log10(value)))


#: Given as progress: what is being looked at.
Watch = Callable[[str], None]
