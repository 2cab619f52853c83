"""Averaging in the pipeline, and the averaged system as a description of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from mbsym.algebra.failures import NoClosedForm
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import Expression, Name, names, number
from mbsym.model.basics import rational
from mbsym.model.loads import ForceFunction
from mbsym.model.substitution import folded, put
from mbsym.model.system import System
from mbsym.problems.small_parameter import averaging
from mbsym.problems.small_parameter.averaging import Averaged

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def fast_phases(system: System) -> tuple[str, ...]:
    """The prescribed quantities whose rate is a parameter."""
    declared = {parameter.name for parameter in system.parameters}
    return tuple(item.name for item in system.prescribed if isinstance(item.rate, Name) and item.rate.name in declared)


def averaging_of(
    analysis: Analysis, phases: str | Sequence[str], amplitudes: Sequence[str] | Mapping[str, int] = ()
) -> Averaged:
    """The effective potential of an analysis whose ``phases`` (one, or several) are fast.

    ``amplitudes``: the parameters that set how strongly the phases act, with their powers of eps (1 where only names
    are given); found where they are left out and plain.

    Raises NoClosedForm with the reason where there is none.
    """
    system = analysis.system
    if system.constraints or system.speeds or system.linear is not None or system.inputs:
        raise NoClosedForm("averaging is for systems in coordinates, without constraints and inputs")
    if system.time_scale is not None:
        raise NoClosedForm("averaging is in physical time: leave the description's own time out")
    chosen = (phases,) if isinstance(phases, str) else tuple(phases)
    expressions = {item.name: item.rate for item in system.prescribed}
    rates = {phase: rate.name for phase in chosen if isinstance(rate := expressions[phase], Name)}
    amplitude_orders = amplitudes if isinstance(amplitudes, Mapping) else dict.fromkeys(amplitudes, 1)
    for phase, speed in rates.items():
        _refuse_company(system, phase, speed)
        if speed in amplitude_orders:
            raise NoClosedForm("[[rate]] is the rate of [[phase]], and of order eps^-1", rate=speed, phase=phase)
    orders = dict(amplitude_orders) or averaging.orders_of(analysis.scene, analysis.energy, rates)
    _refuse_ties(system, chosen, (*rates.values(), *orders))
    averaged = averaging.averaged(analysis.scene, analysis.energy, rates, orders)
    values = {parameter.name: parameter.value for parameter in system.parameters}
    numbers = {name: rational(values[name]) for name in rates.values()}
    known = {name: x for name, x in numbers.items() if x is not None}
    for combination in averaged.apart:
        if len(known) == len(numbers) and combination.subs(known).is_zero:
            raise NoClosedForm(
                "at the given values [[combination]] = 0: the phases do not turn independently of each other",
                combination=combination,
                remedy="write both by one phase, as phi and 2*phi",
            )
    return averaged


def _refuse_company(system: System, phase: str, rate: str) -> None:
    """Raises NoClosedForm where another prescribed quantity is as fast: it takes part in the averages."""
    for item in system.prescribed:
        if item.name != phase and rate in names(item.rate):
            raise NoClosedForm(
                "[[other]] is as fast as [[phase]]: both have a rate with [[rate]]",
                other=item.name,
                phase=phase,
                rate=rate,
            )


def _refuse_ties(system: System, phases: Sequence[str], scaled: Sequence[str]) -> None:
    """Raises NoClosedForm where what is small or large is tied to others: powers of eps would be hidden in that."""
    for item in system.prescribed:
        tied = [name for name in scaled if name in names(item.rate)]
        if tied and item.name not in phases:
            raise NoClosedForm(
                "[[name]] takes part in the rate of [[other]]: what is small or large must be free",
                name=tied[0],
                other=item.name,
            )
    for relation in system.relations:
        tied = [name for name in scaled if name == relation.name or name in names(relation.value)]
        if tied:
            raise NoClosedForm(
                "[[name]] is tied by the relation for [[relation]]: what is small or large must be free",
                name=tied[0],
                relation=relation.name,
                remedy="put the relation into the formulas",
            )


def averaged_system(system: System, averaged: Averaged) -> System:
    """The description without the amplitudes and with the vibrational potential as a load; claims are left out."""
    at_rest = {name: number(0) for name, _ in averaged.orders}
    base = replace(system, parameters=(), initial=(), claims=(), abbreviations=(), prescribed=())
    still: System = put(base, at_rest, folded)
    prescribeds = tuple(item for item in system.prescribed if item.name not in averaged.phases)
    loads, fast = still.loads, ", ".join(averaged.phases)
    if not averaged.vibrational.is_zero:
        loads = (*loads, ForceFunction(_expression(str(averaged.vibrational)), "potential"))
    return replace(
        still,
        name=f"{system.name}, averaged over {fast}",
        description=f"Its effective potential holds what the fast {fast} does on average "
        f"({averaged.scaling}).  {system.description}",
        parameters=system.parameters,
        initial=system.initial,
        prescribed=prescribeds,
        loads=loads,
    )


def _expression(text: str) -> Expression:
    """The tree of a formula's own text."""
    complaints = Complaints()
    expression = parse_expression(text, complaints, lambda start, end: Span(1, start + 1))
    assert expression is not None, complaints.sorted()
    return expression
