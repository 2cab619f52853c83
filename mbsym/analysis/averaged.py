"""Averaging in the pipeline, and the averaged system as a description of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import Expression, Name, names, number
from mbsym.model.loads import ForceFunction
from mbsym.model.substitution import folded, put
from mbsym.model.system import System
from mbsym.problems import averaging
from mbsym.problems.averaging import Averaged

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def fast_phases(system: System) -> tuple[str, ...]:
    """The prescribed quantities whose rate is a parameter."""
    declared = {one.name for one in system.parameters}
    return tuple(item.name for item in system.prescribed if isinstance(item.rate, Name) and item.rate.name in declared)


def averaging_of(analysis: Analysis, phase: str, small: Sequence[str] = ()) -> Averaged:
    """The effective potential of an analysis whose ``phase`` is fast; ``small``: what it shakes, found where left out.

    Raises NoClosedForm with the reason where there is none.
    """
    system = analysis.system
    if system.constraints or system.speeds or system.linear is not None or system.inputs:
        raise NoClosedForm("averaging is for systems in coordinates, without constraints and inputs")
    if system.time_scale is not None:
        raise NoClosedForm("averaging is in physical time: leave the description's own time out")
    rate = next(item.rate for item in system.prescribed if item.name == phase)
    assert isinstance(rate, Name)
    _refuse_company(system, phase, rate.name)
    chosen = tuple(small) or averaging.small_parameters(analysis.scene, analysis.energy, phase, rate.name)
    if not chosen:
        raise NoClosedForm(f"which parameters are small is not plain: name what {phase} shakes")
    _refuse_ties(system, (rate.name, *chosen))
    return averaging.averaged(analysis.scene, analysis.energy, phase, rate.name, chosen)


def _refuse_company(system: System, phase: str, rate: str) -> None:
    """Raises NoClosedForm where another prescribed quantity is as fast: it takes part in the averages."""
    for item in system.prescribed:
        if item.name != phase and rate in names(item.rate):
            raise NoClosedForm(f"{item.name} is as fast as {phase}: both have a rate with {rate}")


def _refuse_ties(system: System, scaled: Sequence[str]) -> None:
    """Raises NoClosedForm where a relation ties what is small or large: powers of eps would be hidden in it."""
    for relation in system.relations:
        tied = [name for name in scaled if name == relation.name or name in names(relation.value)]
        if tied:
            raise NoClosedForm(
                f"{tied[0]} is tied by the relation for {relation.name}: what is small or large must be free",
                remedy="put the relation into the formulas",
            )


def averaged_system(system: System, found: Averaged) -> System:
    """The description without the shaking and with the vibrational potential as a load; claims are left out."""
    at_rest = {name: number(0) for name in found.small}
    base = replace(system, parameters=(), initial=(), claims=(), abbreviations=(), prescribed=())
    still: System = put(base, at_rest, folded)
    kept = tuple(item for item in system.prescribed if item.name != found.phase)
    loads = still.loads
    if not found.vibrational.is_zero:
        loads = (*loads, ForceFunction(_expression(str(found.vibrational)), "potential"))
    return replace(
        still,
        name=f"{system.name}, averaged over {found.phase}",
        description=f"Its effective potential holds what the fast {found.phase} does on average.  {system.description}",
        parameters=system.parameters,
        initial=system.initial,
        prescribed=kept,
        loads=loads,
    )


def _expression(text: str) -> Expression:
    """The tree of a formula's own text."""
    complaints = Complaints()
    found = parse_expression(text, complaints, lambda start, end: Span(1, start + 1))
    assert found is not None, complaints.sorted()
    return found
