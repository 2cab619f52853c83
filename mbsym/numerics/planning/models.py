"""The models of one scene: how much of its mechanics is in the equations.

gravity   the order of Newtonian fields: 2, 3, 4 or exact
linear    the equations linearised about the unperturbed motion
without   parameters taken as zero: a mass, a stiffness, a damping that this motion does not feel

``described`` is the model as it was given, ``faithful`` the one that leaves nothing out.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import names
from mbsym.mechanics.variables import expressions
from mbsym.model.loads import EXACT, GRAVITY_ORDERS
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.linearised import LinearisedDynamics
from mbsym.numerics.scenario import Scenario, changed, exact
from mbsym.numerics.states import dynamics_of


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
    found = changed(scenario, **dict.fromkeys(model.without, Fraction(0))) if model.without else scenario
    if model.gravity is None or all(load.order == model.gravity for load in scenario.system.newtonian_fields):
        return found
    return replace(found, system=scenario.system.with_field_order(model.gravity))


def modelled(scenario: Scenario, model: Model) -> Dynamics:
    """The equations of a model.  Raises Failure where there is no program for them, as ``Dynamics`` does."""
    found = scenario if model == Model() else scenario_of(scenario, model)
    return LinearisedDynamics(found) if model.linear else dynamics_of(found)


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
    found = scenario.system.newtonian_fields
    if not found:
        return (None,)
    from mbsym.numerics.ledger.described import relative_size  # what the ledger needs, few scenes do

    sizes = [relative_size(scenario, load) for load in found if load.order == EXACT]
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
    found: dict[str, tuple[str, ...]] = {}
    for body in scenario.system.bodies:
        rows = () if body.inertia is None else body.inertia.tensor
        values = (body.mass, *(x for row in rows for x in row))
        held = set[str]().union(*(names(x) for x in values)) & set(without)
        if held and all(exact(x, less) == 0 for x in values):
            found[body.name] = tuple(name for name in scenario.system.parameter_names if name in held)
    return found


def parted(scenario: Scenario, model: Model) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What a model takes as zero: bodies that have no mass and no inertia left, and parameters that are none of
    theirs."""
    empty = emptied(scenario, model.without)
    held = {name for found in empty.values() for name in found}
    return tuple(empty), tuple(name for name in model.without if name not in held)
