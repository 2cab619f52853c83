"""The models of one scene: how much of its mechanics is in the equations.

gravity   the order of Newtonian fields: 2, 3, 4 or exact
linear    the equations linearised about the unperturbed motion
without   parameters taken as zero: a mass, a stiffness, a damping that this motion does not feel

``described`` is the model as it was given, ``faithful`` the one that leaves nothing out.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.program import Node
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import names
from mbsym.mechanics.speed_programs import restoring
from mbsym.mechanics.variables import expressions
from mbsym.model.loads import EXACT, GRAVITY_ORDERS
from mbsym.model.states import InStates
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.scenario import Scenario, changed, exact, substituted
from mbsym.numerics.states import StateDynamics, dynamics_of
from mbsym.numerics.tangent import Placed, on_tangent, unperturbed

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.dynamics import ConstrainedDynamics
    from mbsym.mechanics.programs import ForwardDynamics
    from mbsym.numerics.constrained import Constraints

# The equations of motion linearised about the unperturbed motion.
#
#     x' = x0' + J(t, x0) (x - x0),      x0(t) = (value + rate t, rate),      J = d rhs/dx
#
# Their energies are those of the whole system, which this motion does not conserve.  With constraints J is that of the
# equations without multipliers: its flow keeps C (x - x0) = 0, the rows to first order, if it begins there
# (``mbsym.numerics.tangent``), and then is that of problem 5 in the independent deviations.


class LinearisedDynamics(Dynamics):
    """x' = x0' + J(t, x0(t)) (x - x0(t)) about the unperturbed motion x0 = (value + rate t, rate).

    Nothing leads its states to constraints, which these keep to first order by themselves.
    """

    constraints = None

    def __init__(self, scenario: Scenario, ring: Ring | None = None) -> None:
        super().__init__(on_tangent(scenario), ring)

    #: As do norms of quaternions and unit vectors.
    correction = None

    @cached_property
    def whole(self) -> Dynamics:
        """The equations that are linearised."""
        return dynamics_of(self.scenario, self.ring)

    @property
    def _solved(self) -> ForwardDynamics | ConstrainedDynamics:
        return self.whole._solved

    @property
    def measured(self) -> Constraints | None:
        return self.whole.constraints

    @cached_property
    def right_hand_side(self) -> Code:
        plain, code, rows = self._specialised, self.whole.right_hand_side, self.whole.jacobian
        motion = unperturbed(self.scenario, plain)
        nodes = substituted(code.program, [*code.outputs, *rows.outputs], Placed(plain, motion))
        size = self.dimension
        deviation = [plain.input(name) - motion[name] for name in self.inputs[1:]]
        outputs = []
        for i in range(size):
            total = nodes[i]
            for j in range(size):
                total = total + plain.product(nodes[size + i * size + j], deviation[j])
            outputs.append(total)
        return Code(plain, self.inputs, tuple(outputs))

    @cached_property
    def jacobian(self) -> Code:
        code = self.right_hand_side
        states = [code.program.input(name) for name in self.inputs[1:]]
        rows = jacobian(code.program, code.outputs, states)
        return Code(code.program, self.inputs, tuple(node for row in rows for node in row))


class LinearisedStates(LinearisedDynamics, StateDynamics):
    """The same in declared variables; energies are those of orientations, so of vectors that are led back to norm 1."""

    @cached_property
    def _in_scene(self) -> Sequence[Node]:
        plain, nodes = self._specialised, super()._in_scene
        moved = {name: plain.input(name) + step for name, step in restoring(plain, self.described).items()}
        return substituted(plain, nodes, Placed(plain, moved))

    @property
    def pivots(self) -> Code:
        return self.whole.pivots


def linearised(scenario: Scenario, ring: Ring | None = None) -> LinearisedDynamics:
    """In what the scenario is told in: coordinates and their velocities, or declared variables."""
    return (LinearisedStates if isinstance(scenario.system, InStates) else LinearisedDynamics)(scenario, ring)


@dataclass(frozen=True)
class Model:
    """What is in the equations; ``gravity`` None: no Newtonian field, or the order that the description gives."""

    gravity: int | str | None = None
    linear: bool = False
    without: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """``gravity of order 2, linearised, without c``."""
        parts = []
        if self.gravity is not None:
            exact = self.gravity == EXACT
            parts.append(
                Message("exact gravity") if exact else Message("gravity of order [[order]]", order=self.gravity)
            )
        if self.linear:
            parts.append(Message("linearised"))
        if self.without:
            parts.append(Message("without [[names]]", names=", ".join(self.without)))
        return joined(parts, ", ") if parts else Message("as described")


def scenario_of(scenario: Scenario, model: Model) -> Scenario:
    """The scenario with the field of a model's order and zero for the parameters that it leaves out."""
    simplified = changed(scenario, **dict.fromkeys(model.without, Fraction(0))) if model.without else scenario
    if model.gravity is None or all(load.order == model.gravity for load in scenario.system.newtonian_fields):
        return simplified
    return replace(simplified, system=scenario.system.with_field_order(model.gravity))


def modelled(scenario: Scenario, model: Model) -> Dynamics:
    """The equations of a model.  Raises Failure where there is no program for them, as ``Dynamics`` does."""
    simplified = scenario if model == Model() else scenario_of(scenario, model)
    return linearised(simplified) if model.linear else dynamics_of(simplified)


def described(scenario: Scenario) -> Model:
    """The model that the description gives: the least order of its Newtonian fields, nothing else left out."""
    orders = [load.order for load in scenario.system.newtonian_fields]
    return Model(min(orders, key=GRAVITY_ORDERS.index)) if orders else Model()


def faithful(scenario: Scenario) -> Model:
    """The model that leaves nothing out of what the description has."""
    return Model(EXACT) if scenario.system.newtonian_fields else Model()


def orders(scenario: Scenario) -> tuple[int | str | None, ...]:
    """The orders of gravity that make sense here, the lowest first; (None,) without a Newtonian field.

    An expansion in size/R is offered where the bodies are nearer to O1 than O1 to the centre, or where the description
    itself expands.
    """
    gravities = scenario.system.newtonian_fields
    if not gravities:
        return (None,)
    from mbsym.numerics.ledger.described import relative_size  # what the ledger needs, few scenes do

    sizes = [relative_size(scenario, load) for load in gravities if load.order == EXACT]
    expandable = all(size is not None and size < 1 for size in sizes)
    return GRAVITY_ORDERS if expandable else (EXACT,)


def droppable(system: System) -> tuple[str, ...]:
    """Parameters that may be taken as zero each by itself.

    Nothing else follows from them: no relation, no prescribed motion, no unperturbed motion, no constraint and no
    speed, so that an initial state stays what it is.
    """
    tied = {relation.name for relation in system.relations}
    parts: tuple[Any, ...] = (system.relations, system.prescribed, system.motion, system.initial)
    parts = (*parts, system.constraints, system.speeds)
    for x in expressions(parts):
        tied |= names(x)
    used = {name for x in expressions((system.bodies, system.loads)) for name in names(x)}
    return tuple(name for name in system.parameter_names if name in used and name not in tied)


def emptied(scenario: Scenario, without: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Bodies whose mass and inertia all become zero with the parameters ``without``, and which of these they hold."""
    less = {**scenario.parameters, **dict.fromkeys(without, Fraction(0))}
    parameters_by_body: dict[str, tuple[str, ...]] = {}
    for body in scenario.system.bodies:
        rows = () if body.inertia is None else body.inertia.tensor
        values = (body.mass, *(x for row in rows for x in row))
        held = set[str]().union(*(names(x) for x in values)) & set(without)
        if held and all(exact(x, less) == 0 for x in values):
            parameters_by_body[body.name] = tuple(name for name in scenario.system.parameter_names if name in held)
    return parameters_by_body


def parted(scenario: Scenario, model: Model) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What a model takes as zero: bodies that have no mass and no inertia left, and parameters that are none of
    theirs."""
    empty = emptied(scenario, model.without)
    held = {name for parameters in empty.values() for name in parameters}
    return tuple(empty), tuple(name for name in model.without if name not in held)
