"""Problem 5, linearisation: what results.json and reports show of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.algebra.failures import Failure, message_of
from mbsym.expressions.message import worded
from mbsym.expressions.tree import text
from mbsym.model.system import System
from mbsym.problems.linearisation import Linearisation, Subsystem
from mbsym.report.content import (
    Block,
    Display,
    Heading,
    Listed,
    Math,
    Matrices,
    Name,
    Relation,
    Said,
    SideBySide,
    Symbol,
    joined,
    named,
    paragraph,
    say,
    speeds,
)
from mbsym.report.documents.base import Write
from mbsym.report.documents.results import linearisation as doc

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.first_order import FirstOrder
    from mbsym.report.results import Results


#: B of at most so many terms stands in the terminal.
SHORT = 12


def data(linearisation: Linearisation, system: System, write: Write) -> doc.Linearisation:
    """The section of results.json."""
    return doc.Linearisation.from_result(
        linearisation,
        write,
        time="t" if linearisation.time_scale is None else f"({linearisation.time_scale})*t",
        notation={item.name: text(item.value) for item in system.notation},
    )


#: The matrices, with how often what they multiply is differentiated, and whether they are symmetric.
_FIVE = (("M", 2, True), ("D", 1, True), ("G", 1, False), ("K", 0, True), ("N", 0, False))


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("linearisation", Said("Problem 5. First approximation"))
    system, linearisation = results.system, results.by_problem.get(5)
    yield from results.missing(5)
    if linearisation is None:
        return
    if linearisation.about.ties:
        from mbsym.report.words.constraint_words import reduction_sentences

        yield paragraph(joined(reduction_sentences(linearisation.about), " "))
    if system.linear is not None and system.linear.of_first_order:
        yield paragraph(Said("As $\\dot x = A x$ with $M = 0$, $D = 1$ and $K + N = -A$."))
    yield paragraph(
        say(
            "In the time $t$ and the declared parameters, $q = ([[q]])$ meaning deviations; entries that are not "
            "written are zero.",
            q=named(linearisation.coordinates),
        )
    )
    if linearisation.varying:
        among = tuple(dict.fromkeys(name for entry in linearisation.varying for name in entry.among))
        yield paragraph(say("The coefficients are functions of the time, through $[[names]]$.", names=named(among)))
    for letter, _, symmetric in _FIVE:
        matrix = getattr(linearisation, letter)
        if letter == "M" or not matrix.is_zero:
            yield Matrices(Symbol(letter), matrix, symmetric, f"linear:{letter}")
    if linearisation.B is not None:
        yield paragraph(
            say(
                "With the deviations $v$ of the inputs $([[inputs]])$ from the values at which they are held, the "
                "right side is $B v$ instead of zero.",
                inputs=named(linearisation.inputs),
            )
        )
        yield Matrices(Symbol("B"), linearisation.B, False, "linear:B")
    yield from _first_order(results, linearisation)
    if linearisation.time_scale is not None or system.notation or len(linearisation.subsystems) > 1:
        yield from _subsystems(linearisation)
    if system.notation:
        yield paragraph(Said("Notation"), ":")
        yield Display(Listed(tuple(Relation(Name(x.name), "=", x.value) for x in system.notation)), "notation")
    state = results.analysis.optional("first_order") if system.speeds else None
    if state is not None:
        yield from _in_speeds(state)


def _first_order(results: Results, linearisation: Linearisation) -> Iterator[Block]:
    """A, B, C, D of systems with inputs or outputs."""
    known = first_order(results.analysis, linearisation)
    form = known["first_order"]
    if form is None:
        if known["no_first_order"]:
            yield paragraph(Said("There is no first-order form"), ": ", worded(known["no_first_order"]), ".")
        return
    if linearisation.about.ties:
        state = speeds(form.states)
        said = (
            say(
                "In first-order form, in the time $t$, with the state $x = ([[state]])$ of independent coordinates "
                "and velocities and the deviations $w$ of the outputs $([[outputs]])$:",
                state=state,
                outputs=named(form.outputs),
            )
            if form.outputs
            else say(
                "In first-order form, in the time $t$, with the state $x = ([[state]])$ of independent coordinates "
                "and velocities:",
                state=state,
            )
        )
    elif form.outputs:
        said = say(
            r"In first-order form, in the time $t$, with the state $x = (q, \dot q)$ and the deviations $w$ of the "
            "outputs $([[outputs]])$:",
            outputs=named(form.outputs),
        )
    else:
        said = Said(r"In first-order form, in the time $t$, with the state $x = (q, \dot q)$:")
    yield paragraph(said)
    a, b, c, d = (Symbol(letter, look="script") for letter in "ABCD")
    x, v, plus = Symbol("x"), Symbol("v"), ("+",) if form.inputs else ()
    rates = Relation(Symbol("x", dots=1), "=", a, x, *((*plus, b, v) if form.inputs else ()))
    outputs = Relation(Symbol("w"), "=", c, x, *((*plus, d, v) if form.inputs else ()))
    yield Display(Listed((rates, outputs) if form.outputs else (rates,)), "first-order")
    yield Matrices(a, form.A, False, "first-order:A")
    if form.inputs:
        yield Matrices(b, form.B, False, "first-order:B")
    if form.outputs:
        yield Matrices(c, form.C, False, "first-order:C")
    if form.inputs and form.outputs:
        yield Matrices(d, form.D, False, "first-order:D")


def _subsystems(linear: Linearisation) -> Iterator[Block]:
    """What problem 6 decides about, in its time and notation."""
    several = len(linear.subsystems) > 1
    if several:
        yield paragraph(say("The equations split into subsystems: [[count]].", count=str(len(linear.subsystems))))
    if linear.time_scale is not None:
        yield paragraph(say(r"Derivatives are with respect to $\tau = [[scale]]\, t$.", scale=linear.time_scale))
    for k, part in enumerate(linear.subsystems, start=1):
        index, key = str(k) if several else "", f"subsystem:{k}"
        present = [x for x in _FIVE if x[0] == "M" or not getattr(part, x[0]).is_zero]
        yield Display(_equation(part, index, present), key)
        matrices = (
            Matrices(Symbol(letter, index), getattr(part, letter), symmetric, f"{key}:{letter}")
            for letter, _, symmetric in present
        )
        yield SideBySide(tuple(matrices), key)


def _equation(part: Subsystem, index: str, present: list[tuple[str, int, bool]]) -> Listed:
    """M q'' + D q' + ... = 0, q = (...)."""
    terms: list[Math | str] = []
    for letter, dots, _ in present:
        terms += [*(["+"] if terms else []), Symbol(letter, index), Symbol("q", index, dots=dots)]
    names = Listed(tuple(map(Name, part.coordinates)), brackets=True)
    return Listed((Relation(*terms, "=", 0), Relation(Symbol("q", index), "=", names)))


def _in_speeds(state: FirstOrder) -> Iterator[Block]:
    yield paragraph(
        say(
            r"In speeds and positions: $\dot x = A x$ with the deviations $x$ of $([[names]])$ from $([[values]])$.",
            names=speeds(state.names),
            values=Listed(tuple(state.values)),
        )
    )
    yield Matrices(Symbol("A"), state.A, False, "linear:A")
    zeros = []
    if state.relations - state.norms:
        text = (
            "Unit vectors keep their lengths and the angles between them: zero roots of $A$ that belong to no motion: "
            "[[count]]."
        )
        zeros.append(say(text, count=str(state.relations - state.norms)))
    if state.norms:
        text = "Quaternions keep their norm: zero roots of $A$ that belong to no motion: [[count]]."
        zeros.append(say(text, count=str(state.norms)))
    if zeros:
        yield paragraph(joined(zeros, " "))


# The first-order form of problem 5 as reports show it: for systems with inputs or outputs alone.


def first_order(analysis: Analysis, linear: Linearisation | None) -> dict[str, Any]:
    """``first_order``: A, B, C, D, or None; ``no_first_order``: why there are none although there might be."""
    if linear is None or not (analysis.system.inputs or analysis.system.outputs):
        return {"first_order": None, "no_first_order": ""}
    try:
        return {"first_order": analysis.state_space, "no_first_order": ""}
    except Failure as reason:
        return {"first_order": None, "no_first_order": message_of(reason)}
