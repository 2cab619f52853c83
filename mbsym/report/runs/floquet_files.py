"""What the multipliers of a periodic first approximation prove, as a file and in sentences."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.model.system import System
from mbsym.numerics.orbits.floquet import Judged, Multiplier, Word
from mbsym.report.documents import floquet as doc
from mbsym.report.documents.writer import written
from mbsym.source.meaning import meaning

#: Digits of numbers that are shown.
DIGITS = 12

_SAID = {
    Word.UNSTABLE: "unstable: a multiplier is outside the unit circle (Lyapunov)",
    Word.ASYMPTOTICALLY_STABLE: "asymptotically stable: all multipliers are inside the unit circle (Lyapunov)",
    Word.STABLE: (
        "stable: the equations are linear and follow from a Lagrangian, and the multipliers are simple and on the unit "
        "circle"
    ),
    Word.STABLE_FIRST_APPROXIMATION: (
        "the first approximation is stable: the equations follow from a Lagrangian, and the multipliers are simple and "
        "on the unit circle; of the motion itself that proves nothing (a critical case)"
    ),
    Word.UNDECIDED: (
        "undecided: no multiplier is proved to be outside the unit circle, and neither are all proved to be inside nor "
        "all to be simple ones on it"
    ),
}


def floquet_json(system: System, found: Judged) -> str:
    """The file's text."""
    content = doc.Floquet(
        system=system.name,
        description_sha256=meaning(system),
        verdict=found.word.name.lower(),
        motion="proved" if found.rests else "verified numerically",
        lagrangian=found.lagrangian,
        frequency=str(found.frequency),
        period=found.period.str(30, radius=False),
        multipliers=[_multiplier(one) for one in found.multipliers],
        simple=found.simple,
        monodromy=[[entry.str(DIGITS) for entry in row] for row in found.monodromy.tolist()],
        steps=found.steps,
    )
    return written(content)


def _multiplier(one: Multiplier) -> doc.Multiplier:
    return doc.Multiplier(
        real=one.ball.real.str(DIGITS),
        imaginary=one.ball.imag.str(DIGITS),
        size_at_least=one.least,
        size_at_most=one.greatest,
        on_unit_circle=one.on_circle,
    )


def sentences(found: Judged) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    yield (
        "period",
        f"{found.period.str(15, radius=False)} is a period of the coefficients (2 pi over {found.frequency})",
    )
    for one in found.multipliers:
        where = "on the unit circle" if one.on_circle else f"size between {one.least:.12g} and {one.greatest:.12g}"
        yield "multiplier", f"{_shown(one)}; {where}"
    if not found.rests:
        yield "warning", "that the unperturbed motion satisfies the equations is verified numerically, not proved"
        yield "motion", f"if it does: {_SAID[found.word]}"
    else:
        yield "motion", _SAID[found.word]
    yield "how", f"enclosed in balls with proved remainders, {found.steps} steps"


def _shown(one: Multiplier) -> str:
    real = one.ball.real.str(DIGITS, radius=False)
    if one.ball.imag.contains(0):
        return real
    imaginary = one.ball.imag.str(DIGITS, radius=False)
    return f"{real} {'-' if imaginary.startswith('-') else '+'} {imaginary.lstrip('-')} i"
