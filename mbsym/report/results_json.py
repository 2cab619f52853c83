"""``results.json``: every asked-for result; formulas are strings in Python syntax with the declared names.

The types of ``mbsym.report.documents.results`` say what each property is.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from msgspec import UNSET

from mbsym.expressions.tree import text
from mbsym.formulas.formula import Formula
from mbsym.model.quantities import energy_unit, unit_of, units_by_name
from mbsym.model.system import System
from mbsym.problems.claims import ClaimResult
from mbsym.report.canonical import data as canonical_data
from mbsym.report.canonical import forms_of
from mbsym.report.documents import results as doc
from mbsym.report.documents.base import plain, written
from mbsym.report.documents.parts import Counted
from mbsym.report.documents.results import linearisation
from mbsym.report.documents.results.claims import Claim, ClaimPart
from mbsym.report.lengths import COUNTED, FILE, withheld
from mbsym.report.sections import section_of
from mbsym.report.sections.linearisation import first_order
from mbsym.report.sections.system import accepted_inertias
from mbsym.report.words.claims import claim_line, left_side

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    return written(results_document(analysis, problems), indent=2, sort_keys=True)


def results(analysis: Analysis, problems: Sequence[int]) -> dict[str, Any]:
    """The file as nested lists and dictionaries."""
    document: dict[str, Any] = plain(results_document(analysis, problems))
    return document


def results_document(analysis: Analysis, problems: Sequence[int]) -> doc.Results:
    """The file as a value."""
    system = analysis.system
    unavailable: dict[str, doc.Failure] = {}
    sections = _sections(analysis, problems, unavailable)
    accepted = accepted_inertias(system)
    return doc.Results(
        problems=sorted(problems),
        terms=analysis.terms,
        system=doc.Described.from_result(system),
        coordinates=list(system.coordinates),
        prescribed={item.name: text(item.rate) for item in system.of_constant_rate},
        given=[doc.Given.from_result(x, text) for x in system.given] or UNSET,
        parameters=[
            doc.Parameter.from_result(item, text, unit=unit_of(system, item.name) or UNSET)
            for item in system.parameters
        ],
        relations={relation.name: text(relation.value) for relation in system.relations} or UNSET,
        assumptions=[doc.Assumption.from_result(x, text) for x in system.assumptions] or UNSET,
        small_parameter=doc.SmallParameter.from_result(system.small) if system.small else UNSET,
        tables=[doc.Table.from_result(x, held=x.held if x.jumps else UNSET) for x in system.tables] or UNSET,
        checks=[doc.SelfCheck(**vars(check)) for check in analysis.checks],
        units=units_by_name(system, [("energy", energy_unit(system))]) or UNSET,
        motion={entry.coordinate: doc.Motion.from_result(entry, text) for entry in system.motion} or UNSET,
        initial=_initial(system) or UNSET,
        inputs=[doc.Input.from_result(x, text) for x in system.inputs] or UNSET,
        outputs=[doc.Output.from_result(x, text) for x in system.outputs] or UNSET,
        accepted_inertias=[doc.AcceptedInertia.from_result(inertia) for inertia in accepted.items()] or UNSET,
        claims=[_claim(result, system) for result in analysis.claims] if system.claims else UNSET,
        unavailable=unavailable,
        **sections,
    )


def _sections(analysis: Analysis, problems: Sequence[int], unavailable: dict[str, doc.Failure]) -> dict[str, Any]:
    """What is derived, by property; ``unavailable`` takes what is not."""
    from mbsym.analysis import PROBLEMS

    system = analysis.system
    derived: dict[str, Any] = {}
    stages = {number: analysis.stage(number) for number in problems}
    forms = forms_of(analysis, problems)
    long = withheld([*(stages[number].value for number in COUNTED if number in stages), *forms.results], FILE)

    def write(formula: Formula) -> str | Counted:
        return counted(formula) if id(formula) in long else str(formula)

    for number, stage in stages.items():
        key = PROBLEMS[number].attribute
        if stage.failure is None:
            derived[key] = section_of(PROBLEMS[number]).data(stage.value, system, write)
        else:
            unavailable[key] = doc.Failure.from_result(stage.failure)
    if 5 in stages and stages[5].failure is None:
        linear = first_order(analysis, stages[5].value)
        if linear["first_order"] is not None:
            derived["state_space"] = linearisation.StateSpace.from_result(linear["first_order"], write)
    if forms.some:
        sections, missing = canonical_data(forms, write, doc.Failure.from_result)
        derived |= sections
        unavailable |= missing
    if system.reactions and 3 in problems:
        from mbsym.report.sections.equations import reaction_data

        stage = analysis.stage_of("reactions")
        if stage.failure is None:
            derived["reactions"] = reaction_data(stage.value, analysis.constraints, write)
        else:
            unavailable["reactions"] = doc.Failure.from_result(stage.failure)
    state = analysis.optional("first_order") if system.speeds and 5 in problems else None
    if state is not None:
        derived["first_order"] = linearisation.FirstOrder.from_result(state, write)
    return derived


def _initial(system: System) -> dict[str, doc.Initial]:
    """What the description says of the state at t = 0, and of where prescribed motions begin, by name."""
    conditions = [(value.coordinate, value.position, value.velocity) for value in system.initial]
    conditions += [(value.coordinate, value.position, None) for value in system.start]
    conditions += [(prescribed.name, prescribed.initial, None) for prescribed in system.prescribed]
    initial_by_name: dict[str, dict[str, Any]] = {
        name: {key: text(x) for key, x in (("position", position), ("velocity", velocity)) if x is not None}
        for name, position, velocity in conditions
    }
    return {name: doc.Initial(**said) for name, said in initial_by_name.items() if said}


def counted(formula: Formula) -> Counted:
    """What stands for a formula that is not written out: its length, and a digest of its normal form.

    Equal digests mean equal formulas; unequal ones say nothing where the descriptions differ.
    """
    digest = hashlib.sha256()
    generators = [(g.kind, g.name, g.denominator, str(g.argument)) for g in formula.ring.generators]
    digest.update(repr([g for g in generators if g[0] != "spare"]).encode())
    digest.update(str(formula.polynomial).encode())  # its terms in the order of the ring; by the kernel, which is quick
    return Counted(terms=formula.terms, sha256=digest.hexdigest())


def _claim(result: ClaimResult, system: System) -> Claim:
    """One claim; what does not concern it is left out."""
    claim, line = result.claim, claim_line(result)
    return Claim.from_result(
        result,
        place=line.place,
        title=line.title,
        word=line.word,
        claimed=UNSET if claim.right is not None else claim.printed or text(claim.equals),
        difference_is=left_side(result) if result.difference is not None or result.parts else UNSET,
        parts=[
            ClaimPart.from_result(
                part, of=str(part.factor) if part.power is None else f"{claim.variable}**{part.power}"
            )
            for part in result.parts
        ]
        or UNSET,
    )
