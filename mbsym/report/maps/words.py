"""The words of maps: what a region is, which condition a curve comes from, why there is no verdict."""

from __future__ import annotations

from collections.abc import Sequence

from mbsym.expressions.counting import counted
from mbsym.maps.boundaries import Condition, Origin
from mbsym.maps.result import Of, PlaneMap, Shape, Shown, Standing, Stratum
from mbsym.maps.section import Section
from mbsym.maps.soft_borders import Onset
from mbsym.maps.verdicts import Judged
from mbsym.problems.stability.word import Word
from mbsym.report.language import Language

ENGLISH = Language()

#: Of several conditions that vanish on one curve, the first says most about it.
_TELLING = (
    *(Origin.CONSTANT, Origin.HURWITZ, Origin.DISCRIMINANT, Origin.STIFFNESS, Origin.RESULTANT),
    Origin.MEETING,
    *(Origin.ASSUMPTION, Origin.INERTIA, Origin.SIGN, Origin.UNDEFINED, Origin.MASS, Origin.LEADING),
    *(Origin.DAMPING, Origin.UNDAMPED, Origin.POTENTIAL, Origin.NOT_GYROSCOPIC, Origin.CYCLIC, Origin.ENERGY),
)

_CONDITIONS = {
    Origin.CONSTANT: "zero root: constant term",
    Origin.HURWITZ: "imaginary roots: Hurwitz minor",
    Origin.DISCRIMINANT: "double root: discriminant",
    Origin.MEETING: "real roots meet: discriminant",
    Origin.RESULTANT: "common root: resultant",
    Origin.STIFFNESS: "det K = 0",
    Origin.MASS: "det M = 0",
    Origin.LEADING: "leading coefficient",
    Origin.DAMPING: "det D = 0",
    Origin.UNDAMPED: "no damping: D = 0",
    Origin.POTENTIAL: "no circulatory forces: N = 0",
    Origin.NOT_GYROSCOPIC: "no gyroscopic forces: G = 0",
    Origin.CYCLIC: "cyclic coordinates set free",
    Origin.ENERGY: "sign that the energy depends on",
    Origin.ASSUMPTION: "assumption",
    Origin.SIGN: "declared sign",
    Origin.INERTIA: "triangle inequality",
    Origin.UNDEFINED: "division by zero",
}

#: Of every file of a map that Ctrl-C ended.
INTERRUPTED = "Interrupted: incomplete and not checked"

STANDINGS = {
    Standing.OUTSIDE: "not admissible",
    Standing.MASSLESS: "kinetic energy not positive definite",
    Standing.UNDEFINED: "formulas divide by zero",
    Standing.TOO_LARGE: "too large to be decided",
    Standing.WITHDRAWN: "withdrawn: the check failed",
    Standing.NOT_REACHED: "not reached",
}


def telling(conditions: Sequence[Condition], outside: bool = False) -> Condition:
    """The condition that says most about a curve; one that parameters have to keep where it is a border of these."""
    kept = (Origin.ASSUMPTION, Origin.INERTIA, Origin.SIGN, Origin.MASS, Origin.UNDEFINED)
    order = [*kept, *_TELLING] if outside else _TELLING
    return min(conditions, key=lambda one: order.index(one.origin))


def condition_words(condition: Condition, section: Section, language: Language = ENGLISH) -> str:
    """``double root: discriminant (psi, phi, sigma)``."""
    words = language.say(_CONDITIONS[condition.origin])
    if condition.origin in (Origin.ASSUMPTION, Origin.SIGN, Origin.INERTIA):
        return f"{words}: {condition.about}" if condition.about else words
    if condition.part is None or len(section.parts) == 1:
        return words
    return f"{words} ({', '.join(section.coordinates[condition.part])})"


def arcs_of(found: PlaneMap, curve: int) -> list[Stratum]:
    """The arcs of a boundary polynomial."""
    return [one for one in found.arcs if curve in found.arrangement.arcs[one.number].factors]


def onset_words(strata: Sequence[Stratum], language: Language = ENGLISH) -> str:
    """``, soft border`` of a curve's arcs or of zeros where terms of third order decide that on all of them.

    Nothing where one of them is open, or is decided at its point only.
    """
    seen: set[Onset] = set()
    for one in strata:
        if one.soft is not None and one.soft.onset is not Onset.NEITHER:
            stretches = one.soft.stretches
            if one.shape is Shape.ARC and stretches is None:
                return ""
            seen |= {one.soft.onset, *(x.onset for x in stretches or ())}
    if not seen or Onset.OPEN in seen:
        return ""
    only = next(iter(seen)) if len(seen) == 1 else None
    words = {Onset.SOFT: "soft border", Onset.HARD: "hard border", None: "soft border in parts, hard in others"}
    return f", {language.say(words[only])}"


def look_words(found: Shown, stratum: Stratum, language: Language = ENGLISH) -> str:
    """What is shown of a stratum, for a legend."""
    if stratum.judged is None:
        return language.say(STANDINGS[stratum.standing])
    if found.of is Of.SIGNATURE:
        return signature_words(stratum.judged, language)
    return judged_words(stratum.judged, language)


def judged_words(judged: Judged, language: Language = ENGLISH) -> str:
    """``unstable: flutter`` or the verdict's word."""
    word = judged.verdict.word
    if word is not Word.UNSTABLE or not judged.right or judged.real_right is None:
        return language.say(word)  # unstable by terms of higher order, too
    pairs = judged.right - judged.real_right
    how = "divergence" if not pairs else "divergence and flutter" if judged.real_right else "flutter"
    return f"{language.say(word)}: {language.say(how)}"


def signature_words(judged: Judged, language: Language = ENGLISH) -> str:
    """``degree of instability 2``; where K is singular, its nullity as well."""
    if judged.degree is None:
        return language.say(Word.UNDECIDED)
    told = f"{language.say('degree of instability')} {judged.degree}"
    return told + (f", {language.say('null directions')} {judged.null}" if judged.null else "")


def broken_words(stratum: Stratum) -> str:
    """The demands that are not kept, each once."""
    return "; ".join(dict.fromkeys(one.condition.about or str(one.condition.polynomial) for one in stratum.broken))


def row_words(judged: Judged) -> str:
    """``unstable: flutter, 2 roots to the right``, for tables."""
    told = judged_words(judged)
    return f"{told}, {counted(judged.right, 'root')} to the right" if judged.right else told
