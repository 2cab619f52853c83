"""What the multipliers of a periodic first approximation prove, as a file and in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.message import Counted, Message, joined
from mbsym.model.system import System
from mbsym.numerics.orbits.floquet import Judged, Multiplier, Word
from mbsym.report.documents import orbit as doc
from mbsym.report.documents.base import file_of
from mbsym.report.documents.orbit import DIGITS

_SAID = {
    Word.UNSTABLE: Message("unstable: a multiplier is outside the unit circle (Lyapunov)"),
    Word.ASYMPTOTICALLY_STABLE: Message("asymptotically stable: all multipliers are inside the unit circle (Lyapunov)"),
    Word.STABLE: Message(
        "stable: the equations are linear and follow from a Lagrangian, and the multipliers are on the unit circle and "
        "simple (coordinates that are not coupled may have equal ones)"
    ),
    Word.STABLE_FIRST_APPROXIMATION: Message(
        "the first approximation is stable: the equations follow from a Lagrangian, and the multipliers are on the "
        "unit circle and simple (coordinates that are not coupled may have equal ones); of the motion itself that "
        "proves nothing (a critical case)"
    ),
    Word.UNDECIDED: Message(
        "undecided: no multiplier is proved to be outside the unit circle, and neither are all proved to be inside nor "
        "all to be simple ones on it"
    ),
}


def floquet_json(system: System, floquet: Judged) -> str:
    """The file's text."""
    return file_of(doc.Floquet, system, floquet)


def sentences(floquet: Judged) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    if floquet.rests:
        yield Message("motion"), _SAID[floquet.word]
    else:
        text = "that the unperturbed motion satisfies the equations is verified numerically, not proved"
        yield Message("warning"), Message(text)
        yield Message("motion"), Message("if it does: [[verdict]]", verdict=_SAID[floquet.word])
    period = floquet.period.str(15, radius=False)
    text = "[[period]] is a period of the coefficients (2 pi over [[frequency]])"
    yield Message("period"), Message(text, period=period, frequency=floquet.frequency)
    for mu in floquet.multipliers:
        where = Message("size between [[least]] and [[most]]", least=f"{mu.least:.12g}", most=f"{mu.greatest:.12g}")
        text = Message("on the unit circle") if mu.on_circle else where
        yield Message("multiplier"), joined((_shown(mu), text), "; ")
    text = "enclosed in balls with proved remainders, [[steps]]"
    yield Message("how"), Message(text, steps=Counted(floquet.steps, "step"))


def _shown(multiplier: Multiplier) -> str:
    real = multiplier.ball.real.str(DIGITS, radius=False)
    if multiplier.ball.imag.contains(0):
        return real
    imaginary = multiplier.ball.imag.str(DIGITS, radius=False)
    return f"{real} {'-' if imaginary.startswith('-') else '+'} {imaginary.lstrip('-')} i"
