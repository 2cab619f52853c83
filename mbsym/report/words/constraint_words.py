"""What is said of constraints, and of what they leave of the coordinates."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import worded
from mbsym.mechanics.constraints.rows import RowName
from mbsym.problems.constraints.result import Constraints, Demanded, Integrability
from mbsym.problems.linearisation import Reduction
from mbsym.problems.reactions import Reaction
from mbsym.report.content import Listed, Name, Phrase, Relation, Said, Symbol, joined, named, say, speeds


def sentences(constraints: Constraints) -> Iterator[Said]:
    """Counts, redundant rows, integrability, and what depends on what."""
    n = len(constraints.coordinates)
    yield say(
        "Coordinates: [[n]]; independent constraints on positions: [[h]], on velocities: [[r]] in all; degrees of "
        "freedom: [[f]].",
        n=str(n),
        h=str(constraints.position_rank),
        r=str(constraints.velocity_rank),
        f=str(n - constraints.velocity_rank),
    )
    if not constraints.exact_points:
        yield Said("The ranks were taken at certified enclosures of points that keep the constraints.")
    for redundant in constraints.redundant:
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
    if constraints.demanded.count:
        yield from _demanded(constraints.demanded)
    if constraints.kept_at_values is False:
        yield Said("At the given values no regular configuration that keeps all constraints was found.")
    if constraints.rank_beside is not None:
        yield say(
            "These ranks are those at the given values of the parameters; at other values near them [[other]] "
            "constraints on velocities are independent.",
            other=str(constraints.rank_beside),
        )
    if constraints.integrability is not None:
        yield from _integrable(constraints.integrability, n - constraints.position_rank)
    for whole, sentence in (
        (True, "Integrable by itself (proved): [[rows]]."),
        (False, "Not integrable by itself (proved): [[rows]]."),
    ):
        rows = [name for name, decided in constraints.alone if decided is whole]
        if rows and len(constraints.alone) > 1:  # of one alone it has been said
            yield say(sentence, rows=_labels(rows))
    if constraints.dependent and constraints.free and constraints.in_speeds:
        yield say(
            "Dependent speeds: [[dependent]]; independent ones: [[free]].",
            dependent=speeds(constraints.dependent),
            free=speeds(constraints.free),
        )
    elif constraints.dependent and not constraints.free:
        yield Said("The constraints determine all velocities: nothing is left to be integrated.")
    elif constraints.dependent and constraints.free:
        yield say(
            "Dependent velocities: those of [[dependent]]; independent ones: those of [[free]].",
            dependent=named(constraints.dependent),
            free=named(constraints.free),
        )


def _demanded(demands: Demanded) -> Iterator[Said]:
    """Which relations between parameters, and what the given values make of them."""
    yield say(
        "The constraints can be kept, and leave this freedom, only where the parameters satisfy further relations; "
        "their number: [[k]].",
        k=str(demands.count),
    )
    if demands.relations:
        yield say(
            "The parameters have to satisfy [[relations]] ([[sure]]).",
            relations=[Relation(x, "=", 0) for x in demands.relations],
            sure=worded(Certainty.VERIFIED.value),
        )
    if demands.satisfied:
        yield Said("The given values do so.")
    elif demands.satisfied is not None:
        yield Said("The given values do not: what is said of the motion here is not about them.")
        if demands.freedom == 0:
            yield Said("At the given values nothing can move in any configuration that was found.")
        elif demands.freedom is not None:
            yield say(
                "At the given values the configurations that were found have [[f]] degrees of freedom at most.",
                f=str(demands.freedom),
            )


def reaction_sentences(reaction: Reaction) -> Iterator[Said]:
    """What is not determined of a reaction; nothing where all is."""
    if not reaction.balances:
        return
    yield say(
        "The joint of [[body]] is statically indeterminate: the equations do not determine [[components]].",
        body=reaction.body,
        components=Listed(_components(reaction.undetermined)),
    )
    for balance in reaction.balances:
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
    if reaction.combinations:
        yield say(
            "Combinations of these components to which they add nothing are determined: [[k]] in number.",
            k=str(reaction.combinations),
        )
    yield say(
        "The formulas are those without the forces of [[rows]].",
        rows=_labels([reaction_balance.rows[0] for reaction_balance in reaction.balances]),
    )


def _components(places: Iterable[int]) -> tuple[Symbol, ...]:
    return tuple(Symbol("RL"[k // 3], str(k % 3 + 1)) for k in places)


def reduction_sentences(reduction: Reduction) -> Iterator[Said]:
    """Which quantities the first approximation is about, and what became of the others."""
    yield say(
        "The first approximation is about the independent velocities, those of [[free]], and what they depend on.",
        free=named(reduction.speeds),
    )
    if reduction.dependent_coordinates:
        yield say(
            "Dependent coordinates are expanded about the motion, not solved for: [[names]].",
            names=named(reduction.dependent_coordinates),
        )
    if reduction.leaf:
        yield say(
            "The velocity constraints are integrable (Frobenius; proved): they keep relations between the coordinates, "
            "[[k]] in number, and the first approximation is that of disturbances that keep the values of these; the "
            "zero roots of others, as many, are not among those below.",
            k=str(reduction.leaf),
        )
    if reduction.rates:
        rates = [Relation(Name(name, 1), "=", x) for name, x in reduction.rates]
        yield say("On the motion the constraints demand [[rates]].", rates=rates)
    if reduction.idle:
        yield say("No equation of these velocities depends on [[names]].", names=named(reduction.idle))
    if reduction.following:
        yield say(
            "The equations depend on [[names]], of which the velocities are dependent: each of them has an equation of "
            "first order of its own, and M has a row of zeros for it.",
            names=named(reduction.following),
        )
    for value in reduction.assumed:
        yield say("This holds where [[value]].", value=Relation(value, "!=", 0))
    if not reduction.holonomic:
        yield say(
            "Velocities are constrained besides coordinates, so D, G, K and N are taken as no more than the symmetric "
            "and skew parts of two matrices: nothing is said about forces of a kind."
        )


def _integrable(integrability: Integrability, dimension: int) -> Iterator[Said]:
    """Frobenius' verdict; its word falls with its certainty."""
    growth = list(map(str, integrability.growth))
    sure = worded(integrability.certainty.value)
    if integrability.kept is None:
        yield Said("Whether the velocity constraints are integrable is undecided: the formulas outgrew their budget.")
        return
    if integrability.word == "holonomic" and integrability.rheonomic:
        yield say(
            "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the "
            "configurations that can be reached at any one time are of dimension [[k]].",
            sure=sure,
            k=str(dimension - integrability.kept),
        )
    elif integrability.word == "holonomic":
        yield say(
            "The velocity constraints are integrable (Frobenius; [[sure]]): the system is holonomic, and the "
            "configurations that can be reached are of dimension [[k]].",
            sure=sure,
            k=str(dimension - integrability.kept),
        )
    elif integrability.word == "partly":
        yield say(
            "The velocity constraints are integrable in part ([[sure]]): they keep further relations between the "
            "coordinates, their number: [[kept]]; the fields and their Lie brackets span [[growth]] dimensions.",
            sure=sure,
            kept=str(integrability.kept),
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
