"""What is said of symmetries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.algebra.certainty import Certainty
from mbsym.problems.symmetries import Symmetries, Symmetry
from mbsym.report.content import Gaps, Inline, Name, Said, Words, say

#: In reports: what a symmetry gives.
OPENING = (
    "Symmetries (Noether) with fields of degree one in the positions and $\\Gamma$ of degree two, both free of the "
    "time:"
)
KNOWN = "The field [[field]] gives an integral that is known ([[name]])."
DEPENDS = "The field [[field]] gives no further integral ([[name]]; verified at a random state)."
GIVES = "The field [[field]] gives a further integral, no function of those known without it (proved):"
OPEN = "The field [[field]] gives an integral of which it is undecided whether it is a function of those of problem 7:"

HEADING = "Symmetries with fields of degree one in the positions and $\\Gamma$ of degree two, both free of the time"


def field_text(one: Symmetry) -> str:
    """``x: -y, y: x; time: 1; Gamma = b*y``."""
    parts = [", ".join(f"{name}: {xi}" for name, xi in one.directions)] if one.directions else []
    parts += [f"time: {one.time}"] if not one.time.is_zero else []
    parts += [f"Gamma = {one.gauge}"] if not one.gauge.is_zero else []
    return "; ".join(parts)


def field(one: Symmetry) -> tuple[Said, ...]:
    """xi_x = -y, xi_y = x, tau = 1, Gamma = b y."""
    ring = one.integral.ring
    shown = [say("$\\xi_{[[name]]} = [[value]]$", name=Name(x, ring=ring), value=xi) for x, xi in one.directions]
    shown += [] if one.time.is_zero else [say("$\\tau = [[value]]$", value=one.time)]
    shown += [] if one.gauge.is_zero else [say("$\\Gamma = [[value]]$", value=one.gauge)]
    return tuple(shown)


def gives(one: Symmetry, field: Inline | Sequence[Inline]) -> Said:
    """What a symmetry gives; behind those of what has no name the integral stands."""
    if one.name:
        return say(DEPENDS if one.certainty is Certainty.VERIFIED else KNOWN, field=field, name=Words(one.name))
    return say(GIVES if one.is_new else OPEN, field=field)


def title(one: Symmetry) -> str:
    """What its integral is called."""
    if one.name:
        return one.name
    return "new: no function of those known without it (proved)" if one.is_new else "integral"


def second_route(one: Symmetry) -> str:
    """How dI/dt = 0 is known besides the identity."""
    return {
        Certainty.PROVED: "dI/dt = 0 by substitution of the accelerations, too (proved)",
        Certainty.VERIFIED: "dI/dt = 0 at random states, too (verified exactly there)",
        Certainty.UNDECIDED: "dI/dt by substitution was not decided within the budget",
    }[one.substituted]


def sentences(found: Symmetries) -> Iterator[Said]:
    """What is known of the list as a whole."""
    values: Gaps = {"unknowns": str(found.unknowns)}
    proof = _COMPARED if found.compared else _BY
    almost = _ALMOST if found.symbols else ""
    if not found.symmetries:
        none = f"There is none of this kind{almost} {proof}"
        yield Said(none if found.complete else "None was found; that there is none is not proved.", values)
        return
    yield Said("Each of them is an identity of the exact ring (proved).", values)
    if found.complete:
        yield Said(
            f"Every other of this kind is a combination of these with constant coefficients{almost} {proof}", values
        )
    else:
        yield Said("That there are no others is not proved.", values)


_ALMOST = ", for almost all values of the parameters"
_BY = "(proved: rank of the conditions on [[unknowns]] constants at exact states)."
_COMPARED = "(proved: the conditions on [[unknowns]] constants, compared in independent functions)."
