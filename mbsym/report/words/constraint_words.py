"""What is said of constraints: sentences with gaps, filled by whoever writes them (terminal, LaTeX, HTML).

A sentence stands in English with ``[[name]]`` for what is filled in, as the templates of the LaTeX report have them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from mbsym.algebra.certainty import Certainty
from mbsym.formulas.formula import Column, Formula
from mbsym.mechanics.constraints.rows import RowName
from mbsym.problems.constraints import Constraints, Demanded, Integrability
from mbsym.problems.reactions import Reaction
from mbsym.problems.reduction import Reduction
from mbsym.report.words.said import Said as Said
from mbsym.report.words.said import filled as filled


@dataclass(frozen=True)
class Writer:
    """How a medium writes lists of coordinates and of speeds, words in its language, known rates, formulas beside 0."""

    names: Callable[[tuple[str, ...]], str]
    word: Callable[[str], str] = str
    rates: Callable[[tuple[tuple[str, Formula], ...]], str] = lambda rates: ", ".join(f"{n}' = {x}" for n, x in rates)
    condition: Callable[[Formula, str], str] = lambda value, sign: f"{value} {sign} 0"
    speeds: Callable[[tuple[str, ...]], str] = ", ".join
    components: Callable[[Sequence[int]], str] = lambda places: ", ".join(
        f"{'force' if k < 3 else 'moment'} {k % 3 + 1}" for k in places
    )
    vector: Callable[[Column], str] = lambda x: f"({', '.join(map(str, x))})"


def sentences(found: Constraints, write: Writer) -> Iterator[Said]:
    """Counts, redundant rows, integrability, and what depends on what."""
    n = len(found.coordinates)
    yield (
        "Coordinates: [[n]]; independent constraints on positions: [[h]], on velocities: [[r]] in all; degrees of "
        "freedom: [[f]].",
        {"n": n, "h": found.position_rank, "r": found.velocity_rank, "f": n - found.velocity_rank},
    )
    if not found.exact_points:
        yield "The ranks were taken at certified enclosures of points that keep the constraints.", {}
    for redundant in found.redundant:
        yield (
            "Redundant: [[row]] follows from [[others]] ([[sure]]).",
            {
                "row": label(redundant.name, write),
                "others": ", ".join(label(one, write) for one in redundant.from_rows),
                "sure": write.word(redundant.certainty.value),
            },
        )
    if found.demanded.count:
        yield from _demanded(found.demanded, write)
    if found.rank_beside is not None:
        yield (
            "These ranks are those at the given values of the parameters; at other values near them [[other]] "
            "constraints on velocities are independent.",
            {"other": found.rank_beside},
        )
    if found.integrability is not None:
        yield from _integrable(found.integrability, n - found.position_rank, write)
    for whole, sentence in (
        (True, "Integrable by itself (proved): [[rows]]."),
        (False, "Not integrable by itself (proved): [[rows]]."),
    ):
        rows = "; ".join(label(name, write) for name, decided in found.alone if decided is whole)
        if rows and len(found.alone) > 1:  # of one alone it has been said
            yield sentence, {"rows": rows}
    if found.dependent and found.free and found.in_speeds:
        yield (
            "Dependent speeds: [[dependent]]; independent ones: [[free]].",
            {"dependent": write.speeds(found.dependent), "free": write.speeds(found.free)},
        )
    elif found.dependent and not found.free:
        yield "The constraints determine all velocities: nothing is left to be integrated.", {}
    elif found.dependent and found.free:
        yield (
            "Dependent velocities: those of [[dependent]]; independent ones: those of [[free]].",
            {"dependent": write.names(found.dependent), "free": write.names(found.free)},
        )


def _demanded(found: Demanded, write: Writer) -> Iterator[Said]:
    """Which relations between parameters, and what the given values make of them."""
    yield (
        "The constraints can be kept, and leave this freedom, only where the parameters satisfy further relations; "
        "their number: [[k]].",
        {"k": found.count},
    )
    if found.relations:
        yield (
            "The parameters have to satisfy [[relations]] ([[sure]]).",
            {
                "relations": ", ".join(write.condition(x, "=") for x in found.relations),
                "sure": write.word(Certainty.VERIFIED.value),
            },
        )
    if found.satisfied:
        yield "The given values do so.", {}
    elif found.satisfied is not None:
        yield "The given values do not: what is said of the motion here is not about them.", {}
        if found.freedom is None:
            yield "At the given values no configuration that keeps all constraints was found.", {}
        elif not found.freedom:
            yield "At the given values nothing can move in any configuration that was found.", {}
        else:
            yield (
                "At the given values the configurations that were found have [[f]] degrees of freedom at most.",
                {"f": found.freedom},
            )


def reaction_sentences(found: Reaction, write: Writer) -> Iterator[Said]:
    """What is not determined of a reaction; nothing where all is."""
    if not found.balances:
        return
    yield (
        "The joint of [[body]] is statically indeterminate: the equations do not determine [[components]].",
        {"body": write.word(found.body), "components": write.components(found.undetermined)},
    )
    for one in found.balances:
        rows = ", ".join(label(name, write) for name in one.rows)
        if one.added is None:
            yield (
                "Forces of [[rows]] may be in balance within the mechanism, whatever their size, and change "
                "[[components]].",
                {"rows": rows, "components": write.components(one.components)},
            )
        else:
            force, moment = map(write.vector, one.added)
            yield (
                "Forces of [[rows]] may be in balance within the mechanism: they add any multiple of [[force]] to the "
                "force and of [[moment]] to the moment.",
                {"rows": rows, "force": force, "moment": moment},
            )
    if found.combinations:
        yield (
            "Combinations of these components to which they add nothing are determined: [[k]] in number.",
            {"k": found.combinations},
        )
    yield (
        "The formulas are those without the forces of [[rows]].",
        {"rows": ", ".join(label(one.rows[0], write) for one in found.balances)},
    )


def reduction_sentences(found: Reduction, write: Writer) -> Iterator[Said]:
    """Which quantities the first approximation is about, and what became of the others."""
    yield (
        "The first approximation is about the independent velocities, those of [[free]], and what they depend on.",
        {"free": write.names(found.speeds)},
    )
    if found.dependent_coordinates:
        yield (
            "Dependent coordinates are expanded about the motion, not solved for: [[names]].",
            {"names": write.names(found.dependent_coordinates)},
        )
    if found.leaf:
        yield (
            "The velocity constraints are integrable (Frobenius; proved): they keep relations between the coordinates, "
            "[[k]] in number, and the first approximation is that of disturbances that keep the values of these; the "
            "zero roots of others, as many, are not among those below.",
            {"k": found.leaf},
        )
    if found.rates:
        yield "On the motion the constraints demand [[rates]].", {"rates": write.rates(found.rates)}
    if found.idle:
        yield "No equation of these velocities depends on [[names]].", {"names": write.names(found.idle)}
    if found.following:
        yield (
            "The equations depend on [[names]], of which the velocities are dependent: each of them has an equation of "
            "first order of its own, and M has a row of zeros for it.",
            {"names": write.names(found.following)},
        )
    for value in found.assumed:
        yield "This holds where [[value]].", {"value": write.condition(value, "!=")}
    if not found.holonomic:
        yield (
            "Velocities are constrained besides coordinates, so D, G, K and N are taken as no more than the symmetric "
            "and skew parts of two matrices: nothing is said about forces of a kind.",
            {},
        )


def _integrable(found: Integrability, dimension: int, write: Writer) -> Iterator[Said]:
    """Frobenius' verdict; its word falls with its certainty."""
    growth = ", ".join(map(str, found.growth))
    sure = write.word(found.certainty.value)
    if found.kept is None:
        yield "Whether the velocity constraints are integrable is undecided: the formulas outgrew their budget.", {}
        return
    if found.word == "holonomic" and found.rheonomic:
        yield (
            "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the "
            "configurations that can be reached at any one time are of dimension [[k]].",
            {"sure": sure, "k": dimension - found.kept},
        )
    elif found.word == "holonomic":
        yield (
            "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the "
            "configurations that can be reached are of dimension [[k]].",
            {"sure": sure, "k": dimension - found.kept},
        )
    elif found.word == "partly":
        yield (
            "The velocity constraints are integrable in part ([[sure]]): they keep [[kept]] further relations between "
            "the coordinates; the fields and their Lie brackets span [[growth]] dimensions.",
            {"sure": sure, "kept": found.kept, "growth": growth},
        )
    else:
        # That the brackets span everything is reached at a point, and so proved.
        yield (
            "The system is nonholonomic ([[sure]]): no relation between the coordinates follows from the velocity "
            "constraints; the fields and their Lie brackets span [[growth]] dimensions.",
            {"sure": write.word(Certainty.PROVED.value), "growth": growth},
        )


def label(name: RowName, write: Writer) -> str:
    """``rolling 2 (component 3)``."""
    kind = f"{write.word(name.kind)} {name.constraint + 1}"
    return f"{kind}, {write.word('component')} {name.component}" if name.component else kind
