"""``model.mo``: a flat model in Modelica, whose equations are the straight-line program of the accelerations.

Mass matrix and Jacobian are left to the tools that read it: they differentiate and sort equations themselves.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

from mbsym.algebra.program import Choice
from mbsym.formulas.names import free_name
from mbsym.formulas.straight_line import Dialect, angle_name
from mbsym.model.system import System, velocity_name
from mbsym.model.units import ENERGY, LENGTH, TIME, Units
from mbsym.report.code.constrained_code import tied_of
from mbsym.report.code.identifiers import number, spelled
from mbsym.report.environment import rendered
from mbsym.report.exports.interface import COMMON, Export, Language, Written, export
from mbsym.report.unit_text import base_unit, modelica

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

_WORDS = """
    algorithm and annotation assert block break class connect connector constant constrainedby der discrete each else
    elseif elsewhen encapsulated end enumeration equation expandable extends external false final flow for function if
    import impure in initial inner input loop model not operator or outer output package parameter partial protected
    public pure record redeclare replaceable return stream then true type when while within
    time abs sign sqrt div mod rem ceil floor integer sin cos tan asin acos atan atan2 sinh cosh tanh exp log log10
    Real Integer Boolean String noEvent smooth sample pre edge change reinit initial terminal terminate homotopy delay
    cardinality semiLinear spatialDistribution actualStream inStream getInstanceName ndims size scalar vector matrix
    identity diagonal zeros ones fill linspace min max sum product transpose outerProduct symmetric cross skew
    Connections Clock StateSelect ExternalObject AssertionLevel start fixed
"""
RESERVED = COMMON | frozenset(_WORDS.split())

#: The functions that the model shows as variables.
SHOWN = (
    "accelerations", "energy", "generalized_energy", "integrals", "joints", "mass_centres",
    *("constraints", "constraint_velocity", "multipliers", "reactions"),
)  # fmt: skip


def proposed(name: str) -> str:
    """An identifier of Modelica."""
    return spelled(name, RESERVED)


LANGUAGE = Language(
    Dialect(
        call=lambda function, argument: (
            f"noEvent({function}({argument}))" if isinstance(function, Choice) else f"{function}({argument})"
        ),
        number=number,
        angle=angle_name,
    ),
    RESERVED,
    proposed,
    time="time",
)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The model's text."""
    model = export(analysis, problems, LANGUAGE, shared=SHOWN)
    shown = model.functions
    auxiliary: dict[str, str] = {}
    for function in shown:
        for name, value in function.body.assignments:
            assert auxiliary.get(name, value) == value  # prescribed quantities are the same everywhere
            auxiliary[name] = value
    loose, closing = _at_the_start(analysis, shown)
    results = list(_results(model, shown, _labels(analysis), {*RESERVED, *model.names.values(), *auxiliary}))
    slopes = next((function.rows("0.0") for function in shown if function.name == "accelerations"), [])
    return rendered(
        "exports/model.mo.j2",
        {"string": string},
        model=model,
        auxiliary=auxiliary,
        results=results,
        accelerations=[row[0] for row in slopes],
        own=model.names,
        unit=_units(model),
        loose=loose,
        closing=closing,
        kept=any(function.name == "constraints" for function in shown) and not loose & {*analysis.system.coordinates},
    )


def _labels(analysis: Analysis) -> tuple[str, ...]:
    """What the rows of constraints are called."""
    tied = tied_of(analysis)
    return () if isinstance(tied, str) else tied.labels


def _at_the_start(analysis: Analysis, shown: Sequence[Written]) -> tuple[set[str], list[str]]:
    """The states that constraints determine at the start, and what is zero there.

    Dependent velocities always; dependent coordinates where every constraint is one on positions.
    """
    if not any(function.name == "multipliers" for function in shown):
        return set(), []
    constraints, tied = analysis.constraints, tied_of(analysis)
    assert not isinstance(tied, str)
    loose = {velocity_name(name) for name in constraints.dependent}
    independent = [k for k, i in enumerate(tied.rows, 1) if i in constraints.independent]
    closing = [f"constraint_velocity_{k}" for k in independent]
    if constraints.position_rank == len(closing):
        loose |= {*constraints.dependent}
        closing += [f"constraint_position_{k}" for k in independent]
    return loose, closing


def _units(model: Export) -> Callable[[str], str]:
    """What gives the units of parameters, coordinates and velocities in the syntax of Modelica.

    Its time is in seconds: where that of the description is not, no unit would agree with it.
    """
    system = model.system
    if not _in_seconds(system):
        return lambda name: ""
    rates = {rate: name for name, rate in zip(system.coordinates, system.velocities, strict=True)}

    def unit(name: str) -> str:
        return modelica(base_unit(system, rates.get(name, name), 1 if name in rates else 0))

    return unit


def _in_seconds(system: System) -> bool:
    return system.units.text(TIME) == "s"


def _results(
    model: Export, shown: Sequence[Written], labels: Sequence[str], used: set[str]
) -> Iterator[tuple[str, str, str, list[str] | str]]:
    """(name, unit, words, value or three components) of energies, integrals, places of bodies."""
    known = model.system.units if _in_seconds(model.system) else Units()
    energy, length = modelica(known.text(ENERGY)), modelica(known.text(LENGTH))
    for result in shown:
        rows = result.rows("0.0") if result.shape else []
        if not result.shape:
            yield (_free(result.name, used), energy, result.words, result.entries[0][1] if result.entries else "0.0")
        elif result.name == "integrals":
            for item, row in zip(model.integrals, rows, strict=True):
                yield _free(f"integral_{item.name}", used), "", f"{item.title}: constant ({item.status})", row[0]
        elif result.name in ("constraints", "constraint_velocity", "multipliers"):
            stem = {"constraints": "constraint_position", "multipliers": "multiplier"}.get(result.name, result.name)
            what = "lambda" if result.name == "multipliers" else "zero"
            for place, (label, row) in enumerate(zip(labels, rows, strict=False), 1):
                yield _free(f"{stem}_{place}", used), "", f"{what}: {label}", row[0]
        elif result.name == "reactions":
            for place, (joint, row) in enumerate(zip(model.system.reactions, rows, strict=True), 1):
                for what, part in (("force", row[:3]), ("moment", row[3:])):
                    yield _free(f"{what}_in_joint{place}", used), "", f"{what} in the joint of {joint}", part
        elif result.name in ("joints", "mass_centres"):
            words = "connection point" if result.name == "joints" else "mass centre"
            for place, (body, row) in enumerate(zip(model.system.bodies, rows, strict=True), 1):
                name = _free(f"{'joint' if result.name == 'joints' else 'centre'}{place}", used)
                yield name, length, f"{words} of {body.name}, in inertial axes", row


def _free(proposal: str, used: set[str]) -> str:
    # What a function of other exports is called is free here, where nothing is a function.
    name = free_name(proposal, used - COMMON)
    used.add(name)
    return name


def string(words: str) -> str:
    """A string literal."""
    return '"' + " ".join(words.split()).replace("\\", "\\\\").replace('"', '\\"') + '"'
