"""Problem 3 in Routh's and Hamilton's forms, and Poisson brackets: what reports say of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING

from mbsym.expressions.message import worded
from mbsym.formulas.formula import Formula
from mbsym.report.canonical import TITLES
from mbsym.report.content import (
    Block,
    Display,
    Listed,
    Matrices,
    Name,
    Notation,
    Relation,
    Said,
    Subheading,
    Symbol,
    equalities,
    named,
    numbered,
    paragraph,
    say,
)
from mbsym.report.results import no_result

if TYPE_CHECKING:
    from mbsym.problems.canonical import Brackets, Hamilton, Routh
    from mbsym.report.results import Results


def content(results: Results) -> Iterator[Block]:
    """What reports say, with names for long denominators."""
    named_ones = results.forms
    if named_ones.forms.routh is not None:
        yield from _of_routh(named_ones.forms.routh, named_ones.routh)
    if named_ones.forms.hamilton is not None:
        yield from _of_hamilton(named_ones.forms.hamilton, named_ones.hamilton, results.system.coordinates)
    if named_ones.forms.brackets is not None:
        yield from _of_brackets(named_ones.forms.brackets)
    for form, failure in named_ones.forms.failures:
        yield Subheading((Said(TITLES[form]),))
        yield no_result(failure)


def _of_routh(routh: Routh, denominators: Sequence[tuple[Formula, Formula]]) -> Iterator[Block]:
    ring = routh.function.ring
    yield Subheading((Said(TITLES["routh"]),))
    yield paragraph(
        say(
            r"$L$ does not contain $[[ignored]]$, on which no other force acts: the momenta "
            r"$\beta = ([[momenta]])$ are constants. Routh's function $R = L - \beta \cdot \dot c$, with the "
            r"velocities $\dot c$ of these in terms of $\beta$, belongs to the others, $s = ([[left]])$: "
            r"$\frac{d}{dt} \frac{\partial R}{\partial \dot s} - \frac{\partial R}{\partial s} = Q$, "
            r"that is $M^R \ddot s = f^R$.",
            ignored=named(routh.ignored),
            momenta=Listed(tuple(Name(x, ring=ring) for x in routh.momenta)),
            left=named(routh.coordinates),
        )
    )
    yield from equalities(denominators, "routh:Delta")
    yield Display(Relation(Symbol("R"), "=", routh.function), "routh")
    yield Matrices(Symbol("M", upper="R"), routh.mass_matrix, True, "routh:M")
    yield from equalities(numbered(Symbol("f", upper="R"), routh.forcing), "routh:f")
    yield paragraph(
        Said(r"With $R = \frac12 \dot s \cdot M^R \dot s + b \cdot \dot s - W$, $W$ the reduced potential:")
    )
    if all(x.is_zero for x in routh.linear):
        yield Display(Relation(Symbol("b"), "=", 0), "routh:b")
    else:
        yield from equalities(numbered(Symbol("b"), routh.linear), "routh:b")
    yield Display(Relation(Symbol("W"), "=", routh.reduced_potential), "routh:W")
    yield paragraph(Said("Then by integration:"))
    rates = zip((Name(x, 1) for x in routh.ignored), routh.ignored_rates, strict=True)
    yield from equalities(rates, "routh:rate")


def _of_hamilton(
    hamilton: Hamilton, denominators: Sequence[tuple[Formula, Formula]], coordinates: Sequence[str]
) -> Iterator[Block]:
    ring = hamilton.hamiltonian.ring
    yield Subheading((Said(TITLES["hamilton"]),))
    yield paragraph(
        Said(
            r"Momenta $p = \partial L/\partial \dot q$, Hamilton's function $H = p \cdot \dot q - L$ and the canonical "
            r"equations $\dot q = \partial H/\partial p$, $\dot p = -\partial H/\partial q + Q$ with the forces $Q$ "
            "that have no force function."
        )
    )
    yield from equalities(denominators, "canonical:Delta")
    momenta = [Name(x, ring=ring) for x in hamilton.momenta]
    yield from equalities(zip(momenta, hamilton.momenta_in_velocities, strict=True), "momentum")
    yield Display(Relation(Symbol("H"), "=", hamilton.hamiltonian), "H")
    yield from equalities(zip((Name(x, 1) for x in coordinates), hamilton.velocities, strict=True), "canonical:q")
    yield from equalities(zip((replace(x, dots=1) for x in momenta), hamilton.rates, strict=True), "canonical:p")


def _of_brackets(brackets: Brackets) -> Iterator[Block]:
    yield paragraph(Said("The first integrals of problem 7 in coordinates and momenta:"))
    for k, (name, value) in enumerate(zip(brackets.names, brackets.formulas, strict=True), start=1):
        yield Display(Relation(Symbol("F", str(k)), "=", value), f"canonical:F:{k}", (worded(name),))
    if len(brackets.names) < 2:
        return
    if brackets.in_involution:
        yield paragraph(
            Said(
                r"They are in involution: all Poisson brackets $\{F_i, F_j\} = \frac{\partial F_i}{\partial q} \cdot "
                r"\frac{\partial F_j}{\partial p} - \frac{\partial F_i}{\partial p} \cdot \frac{\partial "
                r"F_j}{\partial q}$ are zero."
            )
        )
        return
    yield paragraph(
        Said(
            r"Poisson brackets $\{F_i, F_j\} = \frac{\partial F_i}{\partial q} \cdot \frac{\partial F_j}{\partial "
            r"p} - \frac{\partial F_i}{\partial p} \cdot \frac{\partial F_j}{\partial q}$; those that are not "
            "written are zero, or follow by a change of sign."
        )
    )
    for i, j in combinations(range(1, len(brackets.names) + 1), 2):
        value = brackets.matrix[i - 1, j - 1]
        if not value.is_zero:
            bracket = Notation(rf"\{{F_{{{i}}}, F_{{{j}}}\}}")
            yield Display(Relation(bracket, "=", value), f"bracket:{i}:{j}")
