"""Problem 3, equations: what results.json and the terminal show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, cast

from msgspec import UNSET, UnsetType

from mbsym.expressions.counting import counted
from mbsym.model.system import System
from mbsym.problems.equations import Equations
from mbsym.report.documents.results import equations as doc
from mbsym.report.plain import Write, column_text, matrix_text

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.constraints import Constraints, Solved
    from mbsym.problems.in_speeds.speeds import SpeedEquations
    from mbsym.problems.reactions import Reaction


def data(found: Equations, system: System, write: Write) -> doc.Equations:
    """The section of results.json."""
    constraints = found.constraints
    return doc.Equations(
        mass_matrix=matrix_text(found.mass_matrix, write),
        forcing=column_text(found.forcing, write),
        **(_in_speeds(cast("SpeedEquations", found), write) if found.in_speeds else {}),
        constraints=UNSET if constraints is None else _constraints(constraints, write),
        embedded=UNSET if constraints is None else _embedded(found, write),
    )


def _in_speeds(found: SpeedEquations, write: Write) -> dict[str, Any]:
    rates = zip(found.positions, found.rates, strict=True)
    return {
        "speeds": list(found.speeds),
        "needed": column_text(found.needed, write),
        "supplied": column_text(found.supplied, write),
        "positions": {name: write(rate) for name, rate in rates},
        "aside": list(found.aside),
    }


def _constraints(found: Constraints, write: Write) -> doc.Constraints:
    rows = [
        doc.ConstraintRow(
            constraint=name.constraint + 1,
            component=name.component or None,
            kind=name.kind,
            holonomic=name.holonomic,
            position=None if position is None else write(position),
            velocity=write(velocity),
            independent=k in found.independent,
        )
        for k, (name, position, velocity) in enumerate(zip(found.names, found.position, found.velocity, strict=True))
    ]
    integrable = found.integrability
    return doc.Constraints(
        rows=rows,
        jacobian=matrix_text(found.jacobian, write),
        acceleration=column_text(found.acceleration, write),
        position_rank=found.position_rank,
        velocity_rank=found.velocity_rank,
        degrees_of_freedom=len(found.free),
        redundant=[
            doc.RedundantRow(
                row=one.name.label,
                follows_from=[name.label for name in one.from_rows],
                known=one.certainty.value,
            )
            for one in found.redundant
        ],
        parameter_conditions=found.demanded.count,
        parameter_relations=[write(x) for x in found.demanded.relations],
        parameters_satisfy_them=found.demanded.satisfied,
        velocity_rank_beside=found.rank_beside,
        integrability=None
        if integrable is None
        else doc.Integrability(
            word=integrable.word,
            growth=list(integrable.growth),
            kept=integrable.kept,
            known=integrable.certainty.value,
        ),
        integrable_alone=[doc.IntegrableAlone(row=name.label, integrable=decided) for name, decided in found.alone],
        dependent=list(found.dependent),
        independent=list(found.free),
        **_solved(found.solved, write),
    )


def reaction_data(found: Sequence[Reaction], tied: Constraints | None, write: Write) -> list[doc.Reaction]:
    """What each joint transmits, for results.json."""
    names = [] if tied is None else [tied.names[i].label for i in tied.independent]
    return [
        doc.Reaction(
            body=one.body,
            force=column_text(one.force, write),
            moment=column_text(one.moment, write),
            per_multiplier=[
                doc.PerMultiplier(row=name, force=column_text(force, write), moment=column_text(moment, write))
                for name, (force, moment) in zip(names, one.per_multiplier, strict=True)
            ],
            undetermined=[
                doc.Balance(
                    rows=[name.label for name in balance.rows],
                    components=list(balance.components),
                    force=None if balance.added is None else column_text(balance.added[0], write),
                    moment=None if balance.added is None else column_text(balance.added[1], write),
                )
                for balance in one.balances
            ],
            determined_combinations=one.combinations,
        )
        for one in found
    ]


def _solved(found: Solved | None, write: Write) -> dict[str, Any]:
    """The dependent velocities, where they have closed forms."""
    if found is None:
        return {}
    return {
        "regular_where_not_zero": write(found.regular_where),
        "Y": matrix_text(found.transformation, write),
        "y0": column_text(found.shift, write),
        "a0": column_text(found.acceleration_shift, write),
    }


def _embedded(found: Equations, write: Write) -> doc.Embedded | UnsetType:
    if found.embedded is None:
        return UNSET
    matrix, forcing = found.embedded.mass_matrix, found.embedded.forcing
    return doc.Embedded(mass_matrix=matrix_text(matrix, write), forcing=column_text(forcing, write))


def lines(found: Equations, analysis: Analysis) -> Iterator[str]:
    """The lines in the terminal."""
    n = len(found.forcing)
    if found.in_speeds:
        own = cast("SpeedEquations", found)
        others = ", ".join(name for name, _ in own.kinematic)
        yield f"Kane's equations in {', '.join(own.speeds)}" + (f"; with {others}" if others else "")
    terms = sum(x.terms for x in found.forcing)
    size = counted(found.mass_matrix.terms, "term")
    yield f"{counted(n, 'equation')}; mass matrix {size}, right-hand sides {counted(terms, 'term')}"
    if found.constraints is not None:
        from mbsym.report.words.constraint_words import Writer, filled, sentences

        yield from map(filled, sentences(found.constraints, Writer(", ".join)))
    if found.embedded is not None:
        yield f"without multipliers: {counted(found.embedded.terms, 'term')}"
    elif found.constraints is not None:
        yield "without multipliers: longer than the budget of terms"
    for reaction in analysis.optional("reactions") or () if analysis.system.reactions else ():
        yield f"reaction in the joint of {reaction.body}: {counted(reaction.terms, 'term')}"
        if reaction.balances:
            from mbsym.report.words.constraint_words import Writer, filled, reaction_sentences

            yield from map(filled, reaction_sentences(reaction, Writer(", ".join)))
    if analysis.forms:
        from mbsym.report.canonical import form_lines

        yield from form_lines(analysis)
