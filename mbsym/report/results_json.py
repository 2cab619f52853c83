"""``results.json``: every asked-for result; formulas are strings in Python syntax with the declared names.

``schemas/results.json`` says what each property is.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from mbsym.expressions.tree import text
from mbsym.formulas.formula import Formula
from mbsym.model.quantities import energy_unit, unit_of, units_by_name
from mbsym.model.system import System
from mbsym.problems.claims import ClaimResult
from mbsym.report.canonical import data as canonical_data
from mbsym.report.canonical import forms_of
from mbsym.report.claims import claim_line, left_side
from mbsym.report.documents.writer import version
from mbsym.report.first_order import first_order
from mbsym.report.inertias import accepted_inertias
from mbsym.report.lengths import COUNTED, FILE, withheld
from mbsym.report.plain import Written, matrix_text
from mbsym.report.sections import section_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import NoResult
    from mbsym.problems.state_space import StateSpace

#: The version of ``schemas/results.json`` that the file follows.
FORMAT = 1


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    return json.dumps(results(analysis, problems), indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def results(analysis: Analysis, problems: Sequence[int]) -> dict[str, Any]:
    """The file as nested lists and dictionaries, as ``schemas/results.json`` describes them."""
    from mbsym.analysis import PROBLEMS

    system = analysis.system
    found: dict[str, Any] = {
        "format": FORMAT,
        "version": version(),
        "problems": sorted(problems),
        "terms": analysis.terms,
        "system": {"name": system.name, "description": system.description},
        "coordinates": list(system.coordinates),
        "prescribed": {item.name: text(item.rate) for item in system.prescribed},
        "parameters": _parameters(system),
        "checks": [vars(check) for check in analysis.checks],
    }
    units = units_by_name(system, [("energy", energy_unit(system))])
    if units:
        found["units"] = units
    if system.motion:
        found["motion"] = {one.coordinate: {"value": text(one.value), "rate": text(one.rate)} for one in system.motion}
    initial = _initial(system)
    if initial:
        found["initial"] = initial
    if system.inputs:
        found["inputs"] = [{"name": x.name, "meaning": x.meaning, "held": text(x.held)} for x in system.inputs]
    if system.outputs:
        found["outputs"] = [{"name": one.name, "value": text(one.value)} for one in system.outputs]
    unavailable: dict[str, Any] = {}
    stages = {number: analysis.stage(number) for number in problems}
    forms = forms_of(analysis, problems)
    long = withheld([*(stages[number].value for number in COUNTED if number in stages), *forms.results], FILE)

    def write(formula: Formula) -> Written:
        return counted(formula) if id(formula) in long else str(formula)

    for number, stage in stages.items():
        key = PROBLEMS[number].attribute
        if stage.failure is None:
            found[key] = section_of(PROBLEMS[number]).data(stage.value, system, write)
        else:
            unavailable[key] = _failure(stage.failure)
    if 5 in stages and stages[5].failure is None:
        told = first_order(analysis, stages[5].value)
        if told["first_order"] is not None:
            found["state_space"] = _state_space(told["first_order"], write)
    if forms.some:
        sections, missing = canonical_data(forms, write, _failure)
        found |= sections
        unavailable |= missing
    if system.reactions and 3 in problems:
        from mbsym.report.sections.equations import reaction_data

        stage = analysis.stage_of("reactions")
        if stage.failure is None:
            tied = analysis.constraints if system.constraints else None
            found["reactions"] = reaction_data(stage.value, tied, write)
        else:
            unavailable["reactions"] = _failure(stage.failure)
    state = analysis.optional("first_order") if system.speeds and 5 in problems else None
    if state is not None:
        found["first_order"] = {
            "speeds": list(state.names),
            "values": [write(x) for x in state.values],
            "A": [[write(x) for x in row] for row in state.A],
            "relations": state.relations,
        }
    accepted = accepted_inertias(system)
    if accepted:
        found["accepted_inertias"] = [{"body": name, "violation": reason} for name, reason in accepted.items()]
    if system.claims:
        found["claims"] = [_claim(result, system) for result in analysis.claims]
    return found | {"unavailable": unavailable}


def _state_space(found: StateSpace, write: Callable[[Formula], Written]) -> dict[str, Any]:
    matrices = {name: matrix_text(getattr(found, name), write) for name in "ABCD"}
    return {"states": list(found.states), **matrices}


def _initial(system: System) -> dict[str, dict[str, str]]:
    """What the description says of the state at t = 0, and of where prescribed motions begin, by name."""
    given = [(one.coordinate, one.position, one.velocity) for one in system.initial]
    given += [(one.coordinate, one.position, None) for one in system.start]
    given += [(one.name, one.initial, None) for one in system.prescribed]
    found = {
        name: {key: text(x) for key, x in (("position", position), ("velocity", velocity)) if x is not None}
        for name, position, velocity in given
    }
    return {name: said for name, said in found.items() if said}


def counted(formula: Formula) -> dict[str, Any]:
    """What stands for a formula that is not written out: its length, and a digest of its normal form.

    Equal digests mean equal formulas; unequal ones say nothing where the descriptions differ.
    """
    digest = hashlib.sha256()
    generators = [(g.kind, g.name, g.denominator, str(g.argument)) for g in formula.ring.generators]
    digest.update(repr([g for g in generators if g[0] != "spare"]).encode())
    digest.update(str(formula.polynomial).encode())  # its terms in the order of the ring; by the kernel, which is quick
    return {"terms": formula.terms, "sha256": digest.hexdigest()}


def _failure(failure: NoResult) -> dict[str, Any]:
    return {
        "code": failure.code,
        "limit": None if failure.limit is None else failure.limit.value,
        "severity": failure.severity.value,
        "reason": failure.reason,
        "hint": failure.hint,
    }


def _claim(result: ClaimResult, system: System) -> dict[str, Any]:
    """One claim; what does not concern it is left out."""
    claim, line = result.claim, claim_line(result)
    found: dict[str, Any] = {
        "kind": claim.kind,
        "of": claim.of,
        "entry": list(claim.entry),
        "place": line.place,
        "title": line.title,
        "word": line.word,
        "outcome": result.outcome,
    }
    claimed = result.claim.printed or text(result.claim.equals)
    if result.claim.right is None:
        found["claimed"] = claimed
    for key in ("derived", "difference", "factor"):
        formula = getattr(result, key)
        if formula is not None:
            found[key] = str(formula)
    if result.value:
        found["value"] = result.value
    if result.digits is not None:
        found |= {"digits_right": result.digits, "digits_printed": result.printed_digits}
    for key in ("remark", "where"):
        if getattr(result, key):
            found[key] = getattr(result, key)
    if result.difference is not None or result.parts:
        found["difference_is"] = left_side(result)
    if result.counterexample is not None:
        example = result.counterexample
        found["counterexample"] = {"at": dict(example.at), "shows": dict(example.shows)}
    if result.parts:
        found["parts"] = [
            {
                "of": str(part.factor) if part.power is None else f"{result.claim.variable}**{part.power}",
                "difference": str(part.difference),
                "same_as": part.same_as,
                "repairs": [{"abbreviation": name, "add": str(change)} for name, change in part.repairs],
            }
            for part in result.parts
        ]
    return found


def _parameters(system: System) -> list[dict[str, str | None]]:
    return [
        {
            "name": item.name,
            "sign": item.sign,
            "value": None if item.value is None else text(item.value),
            "meaning": item.meaning,
            **({"unit": unit} if (unit := unit_of(system, item.name)) else {}),
        }
        for item in system.parameters
    ]
