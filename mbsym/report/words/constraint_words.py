"""What is said of constraints, and of what they leave of the coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import worded
from mbsym.mechanics.constraints.rows import RowName
from mbsym.problems.constraints import Constraints, Demanded, Integrability
from mbsym.problems.reactions import Reaction
from mbsym.problems.reduction import Reduction
from mbsym.report.content import Listed, Name, Phrase, Relation, Said, Symbol, joined, named, say, speeds


def sentences(found: Constraints) -> Iterator[Said]:
    """Counts, redundant rows, integrability, and what depends on what."""
    n = len(found.coordinates)
    yield say(
        "Coordinates: [[n]]; independent constraints on positions: [[h]], on velocities: [[r]] in all; degrees of "
        "freedom: [[f]].",
        n=str(n),
        h=str(found.position_rank),
        r=str(found.velocity_rank),
        f=str(n - found.velocity_rank),
    )
    if not found.exact_points:
        yield Said("The ranks were taken at certified enclosures of points that keep the constraints.")
    for redundant in found.redundant:
        if not redundant.from_rows:
            yield say(
                "Redundant: [[row]] is satisfied by every motion ([[sure]]).",
                row=label(redundant.name),
                sure=worded(redundant.certainty.value),
            )
            continue
        yield say(
            "Redundant: [[row]] follows from [[others]] ([[sure]]).",
            row=label(redundant.name),
            others=[label(from_row) for from_row in redundant.from_rows],
            sure=worded(redundant.certainty.value),
        )
    if found.demanded.count:
        yield from _demanded(found.demanded)
    if found.rank_beside is not None:
        yield say(
            "These ranks are those at the given values of the parameters; at other values near them [[other]] "
            "constraints on velocities are independent.",
            other=str(found.rank_beside),
        )
    if found.integrability is not None:
        yield from _integrable(found.integrability, n - found.position_rank)
    for whole, sentence in (
        (True, "Integrable by itself (proved): [[rows]]."),
        (False, "Not integrable by itself (proved): [[rows]]."),
    ):
        rows = [name for name, decided in found.alone if decided is whole]
        if rows and len(found.alone) > 1:  # of one alone it has been said
            yield say(sentence, rows=_labels(rows))
    if found.dependent and found.free and found.in_speeds:
        yield say(
            "Dependent speeds: [[dependent]]; independent ones: [[free]].",
            dependent=speeds(found.dependent),
            free=speeds(found.free),
        )
    elif found.dependent and not found.free:
        yield Said("The constraints determine all velocities: nothing is left to be integrated.")
    elif found.dependent and found.free:
        yield say(
            "Dependent velocities: those of [[dependent]]; independent ones: those of [[free]].",
            dependent=named(found.dependent),
            free=named(found.free),
        )


def _demanded(found: Demanded) -> Iterator[Said]:
    """Which relations between parameters, and what the given values make of them."""
    yield say(
        "The constraints can be kept, and leave this freedom, only where the parameters satisfy further relations; "
        "their number: [[k]].",
        k=str(found.count),
    )
    if found.relations:
        yield say(
            "The parameters have to satisfy [[relations]] ([[sure]]).",
            relations=[Relation(x, "=", 0) for x in found.relations],
            sure=worded(Certainty.VERIFIED.value),
        )
    if found.satisfied:
        yield Said("The given values do so.")
    elif found.satisfied is not None:
        yield Said("The given values do not: what is said of the motion here is not about them.")
        if found.freedom is None:
            yield Said("At the given values no configuration that keeps all constraints was found.")
        elif not found.freedom:
            yield Said("At the given values nothing can move in any configuration that was found.")
        else:
            yield say(
                "At the given values the configurations that were found have [[f]] degrees of freedom at most.",
                f=str(found.freedom),
            )


def reaction_sentences(found: Reaction) -> Iterator[Said]:
    """What is not determined of a reaction; nothing where all is."""
    if not found.balances:
        return
    yield say(
        "The joint of [[body]] is statically indeterminate: the equations do not determine [[components]].",
        body=found.body,
        components=Listed(_components(found.undetermined)),
    )
    for balance in found.balances:
        if balance.added is None:
            yield say(
                "Forces of [[rows]] may be in balance within the mechanism, whatever their size, and change "
                "[[components]].",
                rows=_labels(balance.rows),
                components=Listed(_components(balance.components)),
            )
        else:
            force, moment = (Listed(tuple(x), brackets=True) for x in balance.added)
            yield say(
                "Forces of [[rows]] may be in balance within the mechanism: they add any multiple of [[force]] to the "
                "force and of [[moment]] to the moment.",
                rows=_labels(balance.rows),
                force=force,
                moment=moment,
            )
    if found.combinations:
        yield say(
            "Combinations of these components to which they add nothing are determined: [[k]] in number.",
            k=str(found.combinations),
        )
    yield say(
        "The formulas are those without the forces of [[rows]].", rows=_labels([one.rows[0] for one in found.balances])
    )


def _components(places: Iterable[int]) -> tuple[Symbol, ...]:
    return tuple(Symbol("RL"[k // 3], str(k % 3 + 1)) for k in places)


def reduction_sentences(found: Reduction) -> Iterator[Said]:
    """Which quantities the first approximation is about, and what became of the others."""
    yield say(
        "The first approximation is about the independent velocities, those of [[free]], and what they depend on.",
        free=named(found.speeds),
    )
    if found.dependent_coordinates:
        yield say(
            "Dependent coordinates are expanded about the motion, not solved for: [[names]].",
            names=named(found.dependent_coordinates),
        )
    if found.leaf:
        yield say(
            "The velocity constraints are integrable (Frobenius; proved): they keep relations between the coordinates, "
            "[[k]] in number, and the first approximation is that of disturbances that keep the values of these; the "
            "zero roots of others, as many, are not among those below.",
            k=str(found.leaf),
        )
    if found.rates:
        rates = [Relation(Name(name, 1), "=", x) for name, x in found.rates]
        yield say("On the motion the constraints demand [[rates]].", rates=rates)
    if found.idle:
        yield say("No equation of these velocities depends on [[names]].", names=named(found.idle))
    if found.following:
        yield say(
            "The equations depend on [[names]], of which the velocities are dependent: each of them has an equation of "
            "first order of its own, and M has a row of zeros for it.",
            names=named(found.following),
        )
    for value in found.assumed:
        yield say("This holds where [[value]].", value=Relation(value, "!=", 0))
    if not found.holonomic:
        yield say(
            "Velocities are constrained besides coordinates, so D, G, K and N are taken as no more than the symmetric "
            "and skew parts of two matrices: nothing is said about forces of a kind."
        )


def _integrable(found: Integrability, dimension: int) -> Iterator[Said]:
    """Frobenius' verdict; its word falls with its certainty."""
    growth = list(map(str, found.growth))
    sure = worded(found.certainty.value)
    if found.kept is None:
        yield Said("Whether the velocity constraints are integrable is undecided: the formulas outgrew their budget.")
        return
    if found.word == "holonomic" and found.rheonomic:
        yield say(
            "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the "
            "configurations that can be reached at any one time are of dimension [[k]].",
            sure=sure,
            k=str(dimension - found.kept),
        )
    elif found.word == "holonomic":
        yield say(
            "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the "
            "configurations that can be reached are of dimension [[k]].",
            sure=sure,
            k=str(dimension - found.kept),
        )
    elif found.word == "partly":
        yield say(
            "The velocity constraints are integrable in part ([[sure]]): they keep [[kept]] further relations between "
            "the coordinates; the fields and their Lie brackets span [[growth]] dimensions.",
            sure=sure,
            kept=str(found.kept),
            growth=growth,
        )
    else:
        # That the brackets span everything is reached at a point, and so proved.
        yield say(
            "The system is nonholonomic ([[sure]]): no relation between the coordinates follows from the velocity "
            "constraints; the fields and their Lie brackets span [[growth]] dimensions.",
            sure=worded(Certainty.PROVED.value),
            growth=growth,
        )


def label(name: RowName) -> Phrase:
    """``rolling 2, component 3``."""
    component = (", ", worded("component"), f" {name.component}") if name.component else ()
    return Phrase((worded(name.kind), f" {name.constraint + 1}", *component))


def _labels(names: Iterable[RowName]) -> Phrase:
    """With components that have a comma, semicolons between them."""
    return joined(map(label, names), "; ")
