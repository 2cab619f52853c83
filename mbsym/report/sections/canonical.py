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
    joined,
    named,
    numbered,
    paragraph,
    say,
    speeds,
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
        yield from _of_hamilton(named_ones.forms.hamilton, named_ones.hamilton, bool(results.system.constraints))
    if named_ones.forms.brackets is not None:
        yield from _of_brackets(named_ones.forms.brackets, named_ones.forms.hamilton)
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


def _of_hamilton(hamilton: Hamilton, denominators: Sequence[tuple[Formula, Formula]], tied: bool) -> Iterator[Block]:
    ring = hamilton.hamiltonian.ring
    yield Subheading((Said(TITLES["hamilton"]),))
    yield paragraph(joined(_meaning(hamilton, tied), " "))
    yield from equalities(denominators, "canonical:Delta")
    momenta = [Name(x, ring=ring) for x in hamilton.momenta]
    yield from equalities(zip(momenta, hamilton.momenta_in_velocities, strict=True), "momentum")
    yield Display(Relation(Symbol("H"), "=", hamilton.hamiltonian), "H")
    if hamilton.structure is not None and hamilton.in_quasi_momenta:
        yield Matrices(Symbol("W"), hamilton.structure, False, "W")
    yield from equalities(
        zip((Name(x, 1) for x in hamilton.positions), hamilton.velocities, strict=True), "canonical:q"
    )
    yield from equalities(zip((replace(x, dots=1) for x in momenta), hamilton.rates, strict=True), "canonical:p")


def _meaning(hamilton: Hamilton, tied: bool) -> Iterator[Said]:
    """What p, H and the equations are."""
    if hamilton.plain:
        yield Said(
            r"Momenta $p = \partial L/\partial \dot q$, Hamilton's function $H = p \cdot \dot q - L$ and the canonical "
            r"equations $\dot q = \partial H/\partial p$, $\dot p = -\partial H/\partial q + Q$ with the forces $Q$ "
            "that have no force function."
        )
        return
    yield say(
        r"Momenta $p = \partial L/\partial u$ of $u = ([[speeds]])$, with the other velocities expressed by these, and "
        r"Hamilton's function $H = p \cdot u - L$, on the manifold of the constraints, which stay beside the equations."
        if tied
        else r"Momenta $p = \partial L/\partial u$ of the speeds $u = ([[speeds]])$ and Hamilton's function "
        r"$H = p \cdot u - L$.",
        speeds=speeds(hamilton.speeds),
    )
    if hamilton.integrable is False:
        yield Said(
            "The constraints are not integrable: the rates of the momenta may have terms that are of the constraints "
            "alone, and Poisson brackets would violate Jacobi's identity."
        )
    elif hamilton.integrable is None:
        yield Said("Whether the constraints are integrable is undecided; the equations hold in any case.")
    elif hamilton.in_quasi_momenta:
        yield Said(r"With Poisson brackets $\{p_i, p_j\} = W_{ij}$ these are the equations of Poincaré and Chetaev.")
    elif tied and hamilton.structure is not None:
        yield Said(
            r"The constraints are integrable, and the equations canonical: $\dot q = Y \, \partial H/\partial p + y_0$ "
            r"and $\dot p = Y^T (Q - \partial H/\partial q)$ with the forces $Q$ that have no force function."
        )


def _of_brackets(brackets: Brackets, hamilton: Hamilton | None) -> Iterator[Block]:
    yield paragraph(Said("The first integrals of problem 7 in coordinates and momenta:"))
    for k, (name, value) in enumerate(zip(brackets.names, brackets.formulas, strict=True), start=1):
        yield Display(Relation(Symbol("F", str(k)), "=", value), f"canonical:F:{k}", (worded(name),))
    if len(brackets.names) < 2:
        return
    if hamilton is not None and not hamilton.plain:
        yield paragraph(
            Said(r"They are in involution: all Poisson brackets $\{F_i, F_j\}$ are zero.")
            if brackets.in_involution
            else Said(
                r"Poisson brackets $\{F_i, F_j\}$; those that are not written are zero, or follow by a change of sign."
            )
        )
    elif brackets.in_involution:
        yield paragraph(
            Said(
                r"They are in involution: all Poisson brackets $\{F_i, F_j\} = \frac{\partial F_i}{\partial q} \cdot "
                r"\frac{\partial F_j}{\partial p} - \frac{\partial F_i}{\partial p} \cdot \frac{\partial "
                r"F_j}{\partial q}$ are zero."
            )
        )
    else:
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
