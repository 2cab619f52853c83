"""``results.json``: every asked-for result as strings in Python syntax with the declared names."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from mbsym.expressions.tree import text
from mbsym.formulas.formula import Column, Formula, Matrix
from mbsym.formulas.names import free_name
from mbsym.model.system import System
from mbsym.problems.claims import ClaimResult
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability import Stability
from mbsym.problems.stability.spectrum import numbers
from mbsym.report.claims import claim_line, left_side
from mbsym.report.conditions import CaseStatement, Shown, Statement, cases, statements
from mbsym.report.inertias import accepted_inertias
from mbsym.report.lengths import COUNTED, FILE, not_printed, withheld

if TYPE_CHECKING:
    from mbsym.analysis import Analysis


#: The text of a formula, or its length.
Write = Callable[[Formula], str]


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The file's text."""
    return json.dumps(results(analysis, problems), indent=2, sort_keys=True, ensure_ascii=False) + "\n"


def results(analysis: Analysis, problems: Sequence[int]) -> dict[str, Any]:
    """The file as nested lists and dictionaries of strings."""
    from mbsym.analysis import PROBLEMS

    system = analysis.system
    found: dict[str, Any] = {
        "system": {"name": system.name, "description": system.description},
        "coordinates": list(system.coordinates),
        "parameters": _parameters(system),
        "checks": [vars(check) for check in analysis.checks],
    }
    unavailable: dict[str, str] = {}
    stages = {number: analysis.stage(number) for number in problems}
    long = withheld([stages[number].value for number in COUNTED if number in stages], FILE)

    def write(formula: Formula) -> str:
        return not_printed(formula) if id(formula) in long else str(formula)

    for number, stage in stages.items():
        key = PROBLEMS[number].attribute
        if stage.failure is None:
            found[key] = _SECTIONS[number](stage.value, system, write)
        else:
            unavailable[key] = stage.failure.reason
    accepted = accepted_inertias(system)
    if accepted:
        found["accepted_inertias"] = [{"body": name, "violation": reason} for name, reason in accepted.items()]
    if system.claims:
        found["claims"] = [_claim(result, system) for result in analysis.claims]
    return found | {"unavailable": unavailable}


def _claim(result: ClaimResult, system: System) -> dict[str, Any]:
    """One claim; what does not concern it is left out."""
    shape = {key: value for key, value in vars(claim_line(result)).items() if key in ("place", "title", "word")}
    found: dict[str, Any] = {**shape, "outcome": result.outcome}
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
        }
        for item in system.parameters
    ]


def _column(values: Column, write: Write) -> list[str]:
    return [write(x) for x in values]


def _matrix(values: Matrix, write: Write) -> list[list[str]]:
    return [_column(row, write) for row in values]


def _kinematics(found: Kinematics, system: System, write: Write) -> dict[str, Any]:
    return {
        "bodies": [
            {
                "name": body.name,
                "rotation": _matrix(body.rotation, write),
                "angular_velocity": _column(body.angular_velocity, write),
                "velocity_origin": _column(body.velocity_origin, write),
                "velocity_mass_centre": _column(body.velocity_mass_centre, write),
            }
            for body in found.bodies
        ]
    }


def _energy(found: Energy, system: System, write: Write) -> dict[str, Any]:
    return {
        "kinetic_energy": write(found.kinetic_energy),
        "A2": _matrix(found.A2, write),
        "A1": _column(found.A1, write),
        "A0": write(found.A0),
        "force_function": write(found.force_function),
        "cyclic": list(found.cyclic),
    }


def _equations(found: Equations, system: System, write: Write) -> dict[str, Any]:
    return {"mass_matrix": _matrix(found.mass_matrix, write), "forcing": _column(found.forcing, write)}


def _equilibrium(found: Equilibrium, system: System, write: Write) -> dict[str, Any]:
    return {
        "satisfied": found.satisfied,
        "conditions": _column(found.conditions, write),
        "solved": {name: str(value) for name, value in found.solved},
    }


def _linearisation(found: Linearisation, system: System, write: Write) -> dict[str, Any]:
    return {
        **_five(found, write),
        "subsystems": [{"coordinates": list(part.coordinates), **_five(part, write)} for part in found.subsystems],
        "time": "t" if found.time_scale is None else f"({found.time_scale})*t",
        "notation": {item.name: text(item.value) for item in system.notation},
    }


def _five(found: Any, write: Write) -> dict[str, list[list[str]]]:
    return {name: _matrix(getattr(found, name), write) for name in "MDGKN"}


def _stability(found: Stability, system: System, write: Write) -> dict[str, Any]:
    taken = [*system.coordinates, *system.parameter_names, *(item.name for item in system.notation)]
    lam = free_name("lam", taken)
    parts = found.subsystems
    wanted = [list(statements(part.ring, part.theory.requirements)) for part in parts]
    return {
        "characteristic_polynomials": [polynomial_text(part.characteristic, lam) for part in parts],
        "conditions": [statement_text(item) for items in wanted for item in items],
        "condition_labels": [[item.label for item in items] for items in wanted],
        "condition_places": [[item.place for item in items] for items in wanted],
        "cases": [
            [_case(case, items) for case in cases(part.ring, part.theory.cases)]
            for part, items in zip(parts, wanted, strict=True)
        ],
        "verdict": found.verdict.word,
        "theorem": found.verdict.theorem,
        "verdict_at_values": None if found.numerical is None else found.numerical.word,
        "eigenvalues_at_values": [
            {
                "coordinates": list(part.coordinates),
                "roots": [
                    {"real": x.real, "imaginary": x.imaginary, "multiplicity": x.multiplicity} for x in numbers(part)
                ],
            }
            for part in found.spectra
        ],
    }


def polynomial_text(coefficients: Sequence[Formula], variable: str) -> str:
    """sum of coefficient*variable**k, highest power first; the coefficients stay factored."""
    written = []
    for power, coefficient in reversed(list(enumerate(coefficients))):
        if coefficient.is_zero:
            continue
        bare = variable if power == 1 else f"{variable}**{power}"
        written.append(f"({coefficient})" if power == 0 else bare if coefficient == 1 else f"({coefficient})*{bare}")
    return " + ".join(written) or "0"


def statement_text(statement: Statement) -> str:
    """``formula > 0``, or what is wrong with it."""
    if statement.formula is None:
        return f"{statement.label} {statement.relation} 0: {statement.note}"
    return f"{statement.formula} {statement.relation} 0"


def _case(case: CaseStatement, listed: Sequence[Statement]) -> dict[str, Any]:
    """Conditions that the list already holds, or holds reversed, are named by their labels."""
    shown = Shown()
    for item in listed:
        shown.show(item)

    def short(item: Statement) -> str:
        found = shown.reference(item)
        return statement_text(item) if found is None else f"{found.under} {found.relation} 0"

    return {
        "all_of": [short(item) for item in case.all_of],
        "any_of": [short(item) for item in case.any_of],
        "verdict": case.word,
        "theorem": case.theorem,
    }


def _integrals(found: tuple[Integral, ...], system: System, write: Write) -> list[dict[str, str]]:
    return [
        {"name": item.name, "kind": item.kind, "of": item.of, "formula": write(item.formula), "status": item.status}
        for item in found
    ]


_SECTIONS: dict[int, Callable[[Any, System, Write], Any]] = {
    1: _kinematics,
    2: _energy,
    3: _equations,
    4: _equilibrium,
    5: _linearisation,
    6: _stability,
    7: _integrals,
}
