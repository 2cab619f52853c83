"""What is said of problem 8: sentences with gaps, filled by whoever writes them (terminal, LaTeX, HTML)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from mbsym.algebra.certainty import Certainty
from mbsym.formulas.formula import Formula
from mbsym.problems.stabilisation import (
    Control,
    Dissipation,
    EnergyFunction,
    Gyroscopic,
    Locus,
    Rank,
    Region,
    Stabilisation,
)
from mbsym.report.words.said import Said


@dataclass(frozen=True)
class Medium:
    """How a medium writes names, ``formula relation 0``, a formula, a polynomial in lambda, lambda^2 = -x, a word."""

    names: Callable[[tuple[str, ...]], str]
    condition: Callable[[Formula, str], str]
    formula: Callable[[Formula], str]
    polynomial: Callable[[Sequence[Formula]], str]
    square: Callable[[Formula], str]
    word: Callable[[str], str]


def sentences(found: Stabilisation, write: Medium) -> Iterator[Said]:
    """Everything but the matrices of the feedback, in order."""
    for part in found.gyroscopic:
        yield from _gyroscopic(part, write)
    for energy in found.energy:
        yield from _energy(energy, write)
    for damped in found.dissipation:
        yield from _dissipation(damped, write)
    for control in found.control:
        yield from _control(control, write)
    if found.least:
        sets = "; ".join(write.names(one) for one in found.least)
        yield "The smallest sets of inputs that suffice for almost all parameters (proved): [[sets]].", {"sets": sets}
    if found.control and found.feedback is None:
        yield "No feedback is given: [[why]].", {"why": write.word(found.no_feedback)}


def _all(formulas: Sequence[Formula], relation: str, write: Medium) -> str:
    return ", ".join(write.condition(one, relation) for one in formulas)


# --- gyroscopic forces ---


def _gyroscopic(part: Gyroscopic, write: Medium) -> Iterator[Said]:
    names: dict[str, object] = {"names": write.names(part.coordinates)}
    if not part.regions:
        yield "The degree of instability of K for [[names]] was not found.", names
        return
    if part.free:
        yield "K does not hold all of [[names]]: so many zero eigenvalues: [[free]].", {**names, "free": part.free}
    if part.degree is not None:
        yield (
            "Degree of instability of K for [[names]] (negative eigenvalues): [[degree]] (proved).",
            {**names, "degree": part.degree},
        )
        yield from _what_it_means(part, part.degree, write)
        return
    for region in part.regions:
        yield (
            "Degree of instability of K for [[names]] where [[where]]: [[degree]] (proved).",
            {**names, "where": _where(region, write), "degree": region.degree},
        )
        yield from _what_it_means(part, region.degree, write)


def _where(region: Region, write: Medium) -> str:
    return ", ".join(write.condition(x, relation) for x, relation in region.signs)


def _what_it_means(part: Gyroscopic, degree: int, write: Medium) -> Iterator[Said]:
    if degree == 0 or part.free:
        return
    names: dict[str, object] = {"names": write.names(part.coordinates)}
    if degree % 2:
        yield "It is odd: no gyroscopic forces among [[names]] make the motion stable (Kelvin-Chetaev).", names
        return
    if part.damped:
        yield "It is even, but where D is positive definite the motion is unstable all the same (Kelvin-Chetaev).", {}
        return
    if part.present:
        yield (
            "It is even: the gyroscopic forces among [[names]] stabilise their first approximation where the "
            "conditions of problem 6 hold; complete dissipation, however small, destroys that (Kelvin-Chetaev).",
            names,
        )
    else:
        yield (
            "It is even: suitable gyroscopic forces among [[names]] would stabilise their first approximation, there "
            "are none; complete dissipation, however small, would destroy that (Kelvin-Chetaev).",
            names,
        )


# --- energy ---


def _energy(energy: EnergyFunction, write: Medium) -> Iterator[Said]:
    names: dict[str, object] = {"names": write.names(energy.coordinates)}
    if energy.conserved:
        yield "The energy V of the linear equations of [[names]], with M and K, is an integral of theirs.", names
    else:
        yield (
            "The energy V of the linear equations of [[names]], with M and K, changes through D alone.",
            names,
        )
    if energy.definite is True:
        yield "It is positive definite (proved).", {}
    elif energy.definite is False:
        yield "It is not positive definite (proved).", {}
    elif energy.minors:
        yield "It is positive definite where [[where]].", {"where": _all(energy.minors, ">", write)}
    if energy.definite is None and energy.at_values is not None:
        yield (
            (
                "At the given values it is positive definite (proved)."
                if energy.at_values
                else "At the given values it is not positive definite (proved)."
            ),
            {},
        )
    if energy.bundle is not None:
        weights = ", ".join(map(str, energy.bundle))
        yield (
            "At the given values a combination of the integrals that V makes of the motion and of its derivatives, "
            "with the weights [[weights]], is positive definite (proved): the linear equations of [[names]] are stable "
            "there.",
            {**names, "weights": weights},
        )


# --- dissipation ---


def _dissipation(part: Dissipation, write: Medium) -> Iterator[Said]:
    names: dict[str, object] = {"names": write.names(part.coordinates)}
    if part.complete:
        yield "D is positive definite for [[names]] (proved): dissipation is complete.", names
        return
    if part.rank.full:
        yield "Every motion of [[names]] but rest is felt by D, for almost all parameters (proved).", names
    elif part.rank.factors:
        roots = " ".join(f"({write.polynomial(factor)})" for factor in part.rank.factors)
        yield (
            "Motions of [[names]] are not felt by D at all parameters (proved): those of the roots of [[roots]].",
            {**names, "roots": roots},
        )
        if any(factor[0].is_zero for factor in part.rank.factors):  # a drift, which is proved under conditions
            yield from _provided(part.rank.locus, write)
    else:
        yield (
            "Whether D is felt by every motion of [[names]] is undecided: [[why]].",
            {**names, "why": write.word(part.rank.why_not)},
        )
    for motion in part.motions:
        square = write.square(motion.square)
        if motion.shape is None:
            yield "Not felt: [[square]].", {"square": square}
        else:
            shape = ", ".join(map(write.formula, motion.shape))
            yield "Not felt: [[square]], along ([[shape]]).", {"square": square, "shape": shape}
    yield from _locus(part.rank, write)
    if part.at_values is not None:
        yield (
            (
                "At the given values D is felt by every motion of [[names]] but rest (proved)."
                if part.at_values
                else "At the given values D is not felt by every motion of [[names]] but rest (proved)."
            ),
            names,
        )
    if part.semidefinite is False:
        yield "D is not positive semidefinite for [[names]] (proved).", names
    elif part.semidefinite is None:
        yield "That D is positive semidefinite for [[names]] is not known.", names
    elif part.rank.full:
        yield (
            "Where it is felt the linear equations of [[names]] are asymptotically stable if their K is positive "
            "definite, and unstable if it has a negative eigenvalue and is not singular.",
            names,
        )


def _locus(rank: Rank, write: Medium) -> Iterator[Said]:
    """Where what was said of almost all parameters does not hold."""
    locus: Locus | None = rank.locus
    if not rank.full:
        return
    if locus is None:
        yield "At which parameters it is otherwise was not found: [[why]].", {"why": write.word(rank.why_not)}
        return
    if locus.factors:
        yield "It is otherwise (proved) where [[where]].", {"where": _any(locus.factors, write)}
    if locus.together:
        yield (
            "It is otherwise where all of these vanish at once: [[where]].",
            {"where": _all(locus.together, "=", write)},
        )
    yield from _provided(locus, write)
    if not locus.factors and not locus.together and not locus.provided:
        yield "It is so at all parameters that are allowed (proved).", {}


def _provided(locus: Locus | None, write: Medium) -> Iterator[Said]:
    if locus is not None and locus.provided:
        yield "This is about parameters with [[where]].", {"where": _all(locus.provided, "!=", write)}


def _any(formulas: Sequence[Formula], write: Medium) -> str:
    return f" {write.word('or')} ".join(write.condition(one, "=") for one in formulas)


# --- control ---


def _control(part: Control, write: Medium) -> Iterator[Said]:
    gaps: dict[str, object] = {"names": write.names(part.coordinates), "inputs": write.names(part.inputs)}
    if part.rank.full:
        yield "Controllability of [[names]] by [[inputs]]: yes, for almost all parameters (proved).", gaps
    elif part.rank.factors:
        roots = " ".join(f"({write.polynomial(factor)})" for factor in part.rank.factors)
        yield (
            "Controllability of [[names]] by [[inputs]]: no (proved), out of reach are the roots of [[roots]].",
            {**gaps, "roots": roots},
        )
    elif part.rank.certainty is Certainty.PROVED:
        yield "Controllability of [[names]] by [[inputs]]: no (proved).", gaps
    else:
        yield (
            "Controllability of [[names]] by [[inputs]]: undecided ([[why]]).",
            {**gaps, "why": write.word(part.rank.why_not)},
        )
    yield from _locus(part.rank, write)
    if part.at_values:
        yield "At the given values they are controllable (proved).", {}
    elif part.at_values is False:
        yield (
            (
                "At the given values they are not controllable, but what is out of reach decays by itself (proved)."
                if part.stabilisable_at_values
                else "At the given values they are not controllable, and what is out of reach does not decay (proved)."
            ),
            {},
        )


#: What is said of a feedback, before its matrices.
FEEDBACK = (
    "At the given values the feedback u = -k z, z = (q, q'), makes the linear equations asymptotically stable "
    "(proved: the roots of the closed loop, counted exactly, lie to the left). It was found as an LQR with unit "
    "weights and rounded."
)
LYAPUNOV = (
    "A Lyapunov function of the closed loop is z.P z: P is positive definite, and its rate negative definite (proved)."
)
