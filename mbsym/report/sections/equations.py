"""Problem 3, equations: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from typing import TYPE_CHECKING, cast

from msgspec import UNSET

from mbsym.algebra.factors import content as content_of
from mbsym.expressions.rates import acceleration_name, velocity_name
from mbsym.expressions.tree import Expression, add, multiply, number, power
from mbsym.expressions.tree import Name as Variable
from mbsym.formulas.formula import Formula
from mbsym.formulas.shape import present
from mbsym.formulas.tree import angles_or
from mbsym.model.system import System
from mbsym.problems.equations import Equations
from mbsym.report.code.programs import programs_of
from mbsym.report.content import (
    Block,
    Components,
    Display,
    Folded,
    Heading,
    Listed,
    Math,
    Matrices,
    Name,
    Relation,
    Said,
    Steps,
    Subheading,
    Symbol,
    equalities,
    joined,
    named,
    numbered,
    paragraph,
    say,
    speeds,
)
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import equations as doc

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.constraints.result import Constraints
    from mbsym.problems.in_speeds import SpeedEquations
    from mbsym.problems.reactions import Reaction
    from mbsym.report.results import Results


def data(equations: Equations, system: System, write: Write) -> doc.Equations:
    """The section of results.json."""
    tied, own = equations.constraints, {}
    if equations.in_speeds:
        kane = cast("SpeedEquations", equations)
        own = {name: getattr(kane, name) for name in ("speeds", "needed", "supplied", "aside")}
        own["positions"] = zip(kane.positions, kane.rates, strict=True)
    own |= {"constraints": _constraints(tied, write)} if tied.names else {"constraints": UNSET, "embedded": UNSET}
    return doc.Equations.from_result(equations, write, **own)


def _constraints(constraints: Constraints, write: Write) -> doc.Constraints:
    rows = zip(constraints.names, constraints.position, constraints.velocity, strict=True)
    return doc.Constraints.from_result(
        constraints,
        write,
        rows=[
            doc.ConstraintRow.from_result(
                name, write, position=f, velocity=rate, independent=k in constraints.independent
            )
            for k, (name, f, rate) in enumerate(rows)
        ],
        integrable_alone=[(name.label, decided) for name, decided in constraints.alone],
    )


def reaction_data(reactions: Sequence[Reaction], tied: Constraints, write: Write) -> list[doc.Reaction]:
    """What each joint transmits, for results.json."""
    names = [tied.names[i].label for i in tied.independent]
    return [
        doc.Reaction.from_result(
            item, write, per_multiplier=[(name, *both) for name, both in zip(names, item.per_multiplier, strict=True)]
        )
        for item in reactions
    ]


_LAGRANGE = (
    r"Lagrange's equations of the second kind, $M(q)\, \ddot q = f(q, \dot q, t)$; $M$ is symmetric, entries that are "
    "not written are zero."
)
_WITH_MULTIPLIERS = (
    r"$M(q)\, \ddot q = f(q, \dot q, t) + J^T \lambda$, $J \ddot q + \gamma = 0$: $M$ and $f$ are those of the bodies "
    r"without constraints, $\lambda$ the multipliers of the independent constraints; $M$ is symmetric, entries that "
    "are not written are zero."
)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("equations", Said("Problem 3. Equations of motion"))
    system, motion_equations, compact = results.system, results.by_problem.get(3), results.compact.get(3)
    equations = Said(_WITH_MULTIPLIERS if system.constraints else _LAGRANGE)
    yield from results.missing(3)
    if motion_equations is not None and motion_equations.in_speeds:
        yield from _of_kane(motion_equations)
    elif compact is not None:
        yield paragraph(equations)
        yield from results.intermediates(3)
        yield Matrices(Symbol("M"), compact.system.mass_matrix, True, "M", packed=True)
        yield from equalities(numbered(Symbol("f"), compact.system.forcing), "f")
        if motion_equations is not None:
            yield Folded(Said("The same, written out"), tuple(_closed(motion_equations)))
    elif motion_equations is not None:
        written = short_equations(motion_equations, system)
        if written:
            yield paragraph(Said("The equations of motion:"))
        for k, relation in enumerate(written, start=1):
            yield Display(relation, f"equation:{k}")
        yield paragraph(equations)
        yield from _closed(motion_equations)
    else:
        yield from _program(results.analysis, equations)
    if motion_equations is not None and motion_equations.constraints.names:
        yield from _of_constraints(motion_equations, motion_equations.constraints)
    if results.analysis.forms:
        from mbsym.report.sections import canonical

        yield from canonical.content(results)
    yield from _of_reactions(results)


#: Longer formulas (in characters), and more equations, are left to the report; of all of them, what fills a page.
LONGEST, MOST_EQUATIONS, LONGEST_TOGETHER = 220, 6, 720
#: Formulas with more terms are not even written to be measured.
MOST_TERMS = 24


def short_equations(equations: Equations, system: System) -> tuple[Relation, ...]:
    """M q'' - f = 0, under constraints J^T lambda on the right; none where they are too long to be read at a glance."""
    if len(equations.forcing) > MOST_EQUATIONS or equations.terms > MOST_TERMS * MOST_EQUATIONS:
        return ()
    left, forces = zip(*balances(equations, system), strict=True)
    beside = [x for relation in ties(equations) for x in relation.parts if isinstance(x, Formula)]
    if not are_short([*left, *beside, *(x for row in forces for x, _ in row)]):
        return ()
    right = [[(x, Symbol("lambda", str(k))) for x, k in row] for row in forces]
    return tuple(Relation(x, "=", *combination(row)) for x, row in zip(left, right, strict=True))


def balances(found: Equations, system: System) -> Iterator[tuple[Formula, tuple[tuple[Formula, int], ...]]]:
    """(M q'' - f)_i and (J^T lambda)_i; where nothing stands on the right the left is without a common number."""
    for i, left in enumerate(found.equalities(system.coordinates)):
        forces = constraint_forces(found, i)
        number = 1 if forces or left.is_zero else abs(content_of(left.polynomial))
        yield left if number == 1 else Formula(left.ring, left.polynomial / number), forces


def ties(equations: Equations) -> tuple[Relation, ...]:
    """What stands beside these: kinematic equations of speeds, and constraints."""
    kinematic = (Relation(Name(x, 1), "=", rate) for x, rate in getattr(equations, "kinematic", ()))
    return (*kinematic, *(Relation(value, "=", 0) for _, value in constraint_rows(equations.constraints)))


def are_short(values: Sequence[Formula]) -> bool:
    """Whether all of them together are read at a glance."""
    return all(map(is_short, values)) and sum(len(x.readable()) for x in values) <= LONGEST_TOGETHER


def constraint_forces(equations: Equations, i: int) -> tuple[tuple[Formula, int], ...]:
    """(J^T lambda)_i: what is not zero before the multipliers of independent constraints, and their numbers from 1."""
    tied = equations.constraints
    entries = ((tied.jacobian.rows[k][i], k + 1) for k in tied.independent)
    return tuple((x, k) for x, k in entries if not x.is_zero)


def constraint_rows(tied: Constraints) -> Iterator[tuple[Symbol, Formula]]:
    """Each in positions, or in velocities where it has no other form, with its letter."""
    for k, (position, velocity) in enumerate(zip(tied.position, tied.velocity, strict=True), start=1):
        yield (Symbol("chi", str(k)), velocity) if position is None else (Symbol("phi", str(k)), position)


def combination(terms: Sequence[tuple[Formula, Math]]) -> Iterator[Math | str]:
    """The sum of numbers times letters times formulas, as parts of a relation: sin(x) c would be read as sin(x c)."""
    if not terms:
        yield 0
    for k, (coefficient, letter) in enumerate(terms):
        ring, polynomial = coefficient.ring, coefficient.polynomial
        number = abs(content_of(polynomial))
        minus = all(term.coefficient < 0 for term in present(ring, polynomial, angles_or("shorter")).terms)
        factor = Formula(ring, polynomial / (-number if minus else number))
        if minus or k:
            yield "-" if minus else "+"
        if number != 1:
            yield Formula(ring, ring.one * number)
        yield letter
        # Of the factor: (c - 1)/2 is one term, and c - 1, without its number, two.
        if len(present(ring, factor.polynomial, angles_or("shorter")).terms) > 1:
            yield Listed((factor,), brackets=True)
        elif factor != 1:
            yield factor


def is_short(value: Formula) -> bool:
    """Whether a formula is read at a glance."""
    return value.terms <= MOST_TERMS and len(value.readable()) <= LONGEST


def _closed(equations: Equations) -> Iterator[Block]:
    yield Matrices(Symbol("M"), equations.mass_matrix, True, "M")
    yield from equalities(numbered(Symbol("f"), equations.forcing), "f")


def _of_kane(kane: SpeedEquations) -> Iterator[Block]:
    """In speeds, as they stand in textbooks first."""
    text = (
        "Kane's equations (equally those of Boltzmann and Hamel) in the speeds $[[speeds]]$: what the motion needs is "
        "what the loads supply."
        if not kane.constraints.names
        else "Kane's equations (equally those of Boltzmann and Hamel) in the speeds $[[speeds]]$, of the bodies "
        r"without constraints: what the motion needs is what the loads supply; constraints add $J^T \lambda$ "
        "on the right."
    )
    yield paragraph(say(text, speeds=speeds(kane.speeds)))
    yield from equalities(zip(kane.needed, kane.supplied, strict=True), "needed")
    if kane.kinematic:
        yield paragraph(Said("Kinematic equations:"))
    yield from equalities(((Name(x, 1), rate) for x, rate in kane.kinematic), "kinematic")
    for pairs in kane.relations:
        yield Display(Relation(_products(pairs), "=", int(pairs[0][0] == pairs[0][1])))
    if kane.aside:
        text = "No equation above depends on $[[names]]$, which follow by integration:"
        yield paragraph(say(text, names=named(kane.aside)))
        yield from equalities(((Name(x, 1), rate) for x, rate in kane.kinematic_aside), "aside")
    text = (
        r"As $M \dot u = f$ with $u = ([[speeds]])$; $M$ is symmetric, entries that are not written are zero."
        if not kane.constraints.names
        else r"$M$ and $f$ of these equations sorted by $\dot u$, $u = ([[speeds]])$; $M$ is symmetric, entries that "
        "are not written are zero."
    )
    yield paragraph(say(text, speeds=speeds(kane.speeds)))
    yield from _closed(kane)


def _products(pairs: Sequence[tuple[str, str]]) -> Expression:
    """The sum of the products of these names."""
    squared = number(2)
    terms = (power(Variable(a), squared) if a == b else multiply(Variable(a), Variable(b)) for a, b in pairs)
    return reduce(add, terms)


def _program(analysis: Analysis, equations: Said) -> Iterator[Block]:
    """Equations without closed formulas, where there is a program for them."""
    programs, _ = programs_of(analysis)
    if programs is None:
        return
    names = {name: Name(name) for name in programs.environment if name != "pi"}
    for name in analysis.system.coordinates:
        names |= {velocity_name(name): Name(name, 1), acceleration_name(name): Name(name, 2)}
    n = len(analysis.system.coordinates)
    comma = "," if n > 9 else ""
    places = [(i, j) for i in range(n) for j in range(i, n)]
    results = [(Symbol("M", f"{i + 1}{comma}{j + 1}"), programs.mass_matrix[i][j]) for i, j in places]
    results += [(Symbol("f", str(k)), node) for k, node in enumerate(programs.forcing, start=1)]
    yield paragraph(equations, " ", Said("As a straight-line program:"))
    yield Steps(programs.program, tuple(results), names, Said("The program"))


def _of_constraints(equations: Equations, tied: Constraints) -> Iterator[Block]:
    """What is known of them, J and gamma, and the equations without multipliers."""
    from mbsym.report.words.constraint_words import label, sentences

    free = speeds(tied.free) if tied.in_speeds else named(tied.free)
    yield Subheading((Said("Constraints"),))
    yield paragraph(joined(sentences(tied), " "))
    for k, (name, (letter, value)) in enumerate(zip(tied.names, constraint_rows(tied), strict=True), start=1):
        yield Display(Relation(letter, "=", value, "=", 0), f"phi:{k}", (label(name),))
    yield paragraph(
        Said(
            r"$J = \partial (\dot\varphi, \chi)/\partial u$, a row for each of these, and $\gamma$, their second rates "
            r"(of $\chi$ the rates) at $\dot u = 0$; with the multipliers $\lambda$ of the independent ones, "
            r"$M \dot u = f + J^T \lambda$ and $J \dot u + \gamma = 0$."
            if tied.in_speeds
            else r"$J = \partial (\dot\varphi, \chi)/\partial \dot q$, a row for each of these, and $\gamma$, their "
            r"second rates (of $\chi$ the rates) at $\ddot q = 0$:"
        )
    )
    yield Matrices(Symbol("J"), tied.jacobian, False, "J")
    yield from equalities(numbered(Symbol("gamma"), tied.acceleration), "gamma")
    solved = tied.solved
    if solved is not None and tied.free:
        text = (
            r"With the independent speeds $v = ([[free]])$: $u = Y v + y_0$, $\dot u = Y \dot v + a_0$."
            if tied.in_speeds
            else r"With the velocities $u$ of $[[free]]$: $\dot q = Y u + y_0$, $\ddot q = Y \dot u + a_0$."
        )
        yield paragraph(say(text, free=free))
        if not solved.regular_everywhere:
            yield paragraph(Said("These are regular where"))
            yield Display(Relation(solved.regular_where, "!=", 0), "Y:regular")
        yield Matrices(Symbol("Y"), solved.transformation, False, "Y")
        if not all(x.is_zero for x in solved.shift):
            yield Components(Symbol("y", "0"), solved.shift, "y:zero")
    if not tied.free:
        return
    if equations.embedded is None:
        yield paragraph(Said("The equations without multipliers are longer than the budget of terms."))
    else:
        yield paragraph(
            Said(
                r"Equations without multipliers (Maggi), $\bar M \dot v = \bar f$ with $\bar M = Y^T M Y$ and "
                r"$\bar f = Y^T (f - M a_0)$, the dependent speeds expressed; $\bar M$ is symmetric, entries that are "
                "not written are zero."
                if tied.in_speeds
                else r"Equations without multipliers (Maggi), $\bar M \dot u = \bar f$ with $\bar M = Y^T M Y$ and "
                r"$\bar f = Y^T (f - M a_0)$, the dependent velocities expressed; $\bar M$ is symmetric, entries that "
                "are not written are zero."
            )
        )
        yield Matrices(Symbol("M", look="bar"), equations.embedded.mass_matrix, True, "M:embedded")
        yield from equalities(numbered(Symbol("f", look="bar"), equations.embedded.forcing), "f:embedded")


def _of_reactions(results: Results) -> Iterator[Block]:
    """What joints transmit, where that was asked for."""
    reactions = results.analysis.optional("reactions") if results.system.reactions else None
    if not reactions:
        return
    yield Subheading((Said("Reactions in joints"),))
    sentences = [
        "Force $R$ and moment $L$ about the connection point that the joint exerts on the body, in its axes. What is "
        "given by coordinates (springs, dampers, generalised forces) acts in the joint and is in them; forces and "
        "torques on bodies act besides."
    ]
    if results.system.constraints:
        sentences.append(r"With the multipliers, $R + \sum \lambda_i R^{(i)}$ and $L + \sum \lambda_i L^{(i)}$.")
    if results.system.speeds:
        sentences.append("They are told in generalised coordinates, velocities and accelerations.")
    yield paragraph(joined(map(Said, sentences), " "))
    for reaction in reactions:
        k = str(results.numbers[reaction.body])
        if reaction.balances:
            from mbsym.report.words.constraint_words import reaction_sentences

            yield paragraph(joined(reaction_sentences(reaction), " "))
        yield Components(Symbol("R", k), reaction.force, f"R:{k}")
        yield Components(Symbol("L", k), reaction.moment, f"L:{k}")
        for i, (force, moment) in enumerate(reaction.per_multiplier, start=1):
            yield Components(Symbol("R", k, f"({i})"), force, f"R:{k}:per:{i}")
            yield Components(Symbol("L", k, f"({i})"), moment, f"L:{k}:per:{i}")
