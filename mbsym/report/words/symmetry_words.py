"""What is said of symmetries."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import worded
from mbsym.problems.symmetries.search import Symmetries, Symmetry
from mbsym.report.content import Inline, Name, Relation, Said, Symbol, say

LOOKED_FOR = (
    "Looked for were symmetries (Noether) with fields of degree one in the positions and $\\Gamma$ of degree two, both "
    "free of the time."
)
#: What a symmetry gives.
KNOWN = "The field [[field]] gives an integral that is known ([[name]])."
DEPENDS = "The field [[field]] gives no further integral ([[name]]; verified at a random state)."
GIVES = "The field [[field]] gives a further integral, no function of those known without it (proved):"
OPEN = "The field [[field]] gives an integral of which it is undecided whether it is a function of those of problem 7:"


def field_text(symmetry: Symmetry) -> str:
    """``x: -y, y: x; time: 1; Gamma = b*y``."""
    parts = [", ".join(f"{name}: {xi}" for name, xi in symmetry.directions)] if symmetry.directions else []
    parts += [f"time: {symmetry.time}"] if not symmetry.time.is_zero else []
    parts += [f"Gamma = {symmetry.gauge}"] if not symmetry.gauge.is_zero else []
    return "; ".join(parts)


def field(symmetry: Symmetry) -> tuple[Inline, ...]:
    """xi_x = -y, xi_y = x, tau = 1, Gamma = b y."""
    ring = symmetry.integral.ring
    shown: list[Inline] = [
        say("$\\xi_{[[name]]} = [[value]]$", name=Name(x, ring=ring), value=xi) for x, xi in symmetry.directions
    ]
    shown += [] if symmetry.time.is_zero else [Relation(Symbol("tau"), "=", symmetry.time)]
    shown += [] if symmetry.gauge.is_zero else [say("$\\Gamma = [[value]]$", value=symmetry.gauge)]
    return tuple(shown)


def gives(symmetry: Symmetry, field: Inline | Sequence[Inline]) -> Said:
    """What a symmetry gives; behind those of what has no name the integral stands."""
    if symmetry.name:
        return say(
            DEPENDS if symmetry.certainty is Certainty.VERIFIED else KNOWN, field=field, name=worded(symmetry.name)
        )
    return say(GIVES if symmetry.is_new else OPEN, field=field)


def sentences(symmetries: Symmetries) -> Iterator[Said]:
    """What is known of the list as a whole."""
    proof = say(_COMPARED if symmetries.compared else _BY_RANK, unknowns=str(symmetries.unknowns))
    if not symmetries.symmetries and symmetries.complete:
        yield say(_NONE[symmetries.symbols], proof=proof)
    elif not symmetries.symmetries:
        yield Said("None was found; that there is none is not proved.")
    else:
        yield Said("Each of them is an identity of the exact ring (proved).")
        for certainty, text in _SUBSTITUTED.items():
            count = sum(symmetry.substituted is certainty for symmetry in symmetries.symmetries)
            if count:
                yield say(text, count=str(count))
        yield say(_NO_OTHER[symmetries.symbols], proof=proof) if symmetries.complete else Said(_MAYBE_OTHERS)


#: How dI/dt = 0 is known besides the identity.
_SUBSTITUTED = {
    Certainty.PROVED: "$\\dot I = 0$ by substitution of the accelerations, too (proved), of integrals: [[count]].",
    Certainty.VERIFIED: "$\\dot I = 0$ at random states, too (verified exactly there), of integrals: [[count]].",
    Certainty.UNDECIDED: "Integrals of which $\\dot I$ was not decided by substitution within the budget: [[count]].",
}
#: Whether some parameters have no numbers.
_NONE = {
    False: "There is none of this kind ([[proof]]).",
    True: "There is none of this kind, for almost all values of the parameters ([[proof]]).",
}
_NO_OTHER = {
    False: "Every other of this kind is a combination of these with constant coefficients ([[proof]]).",
    True: "Every other of this kind is a combination of these with constant coefficients, for almost all values of the "
    "parameters ([[proof]]).",
}
_MAYBE_OTHERS = "That there are no others is not proved."
_BY_RANK = "proved: rank of the conditions on [[unknowns]] constants at exact states"
_COMPARED = "proved: the conditions on [[unknowns]] constants, compared in independent functions"
