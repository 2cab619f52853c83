"""What is said of problem 8."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import worded
from mbsym.formulas.formula import Formula
from mbsym.problems.stabilisation.result import (
    Control,
    Dissipation,
    EnergyFunction,
    Gyroscopic,
    Locus,
    Rank,
    Stabilisation,
)
from mbsym.report.content import (
    Gaps,
    Phrase,
    Polynomial,
    Relation,
    Said,
    Symbol,
    compared,
    joined,
    named,
    numbered,
    say,
)

#: What signs are asked of, with a number.
_SIGN = Symbol("Delta")


def sentences(stabilisation: Stabilisation) -> Iterator[Said]:
    """Everything but the matrices of the feedback, in order."""
    if stabilisation.nonholonomic:
        yield Said(
            "The theorems on gyroscopic forces, dissipation and energy do not apply to constraints in velocities: "
            "constraint forces stand in $D$, $G$, $K$ and $N$, which may feed a motion or damp it although energy is "
            "kept."
        )
    if stabilisation.left_out:
        yield Said(
            "These equations are about the independent velocities and what acts on them; what they show carries over "
            "where the equations of motion do not depend on [[names]], and of these nothing is said.",
            {"names": named(stabilisation.left_out)},
        )
    if stabilisation.circulatory:
        yield Said(
            "Of [[names]] nothing is said of gyroscopic forces, dissipation and energy: the theorems ask for $N = 0$.",
            {"names": named(stabilisation.circulatory)},
        )
    elif not (stabilisation.gyroscopic or stabilisation.control or stabilisation.nonholonomic):
        yield Said(
            "There are no inputs, and the theorems on gyroscopic forces, dissipation and energy are not about "
            "equations of first order: nothing is said."
        )
    for part in stabilisation.gyroscopic:
        yield from _gyroscopic(part)
    yield from _together(stabilisation.gyroscopic)
    for energy in stabilisation.energy:
        yield from _energy(energy)
    for damped in stabilisation.dissipation:
        yield from _dissipation(damped)
    for control in stabilisation.control:
        yield from _control(control)
        if control.rank.everywhere:
            break  # the first is about the whole: so are its parts, which are apart
    if stabilisation.least:
        sets = joined(map(named, stabilisation.least), "; ")
        yield say("The smallest sets of inputs that suffice for almost all parameters (proved): [[sets]].", sets=sets)
    if stabilisation.control and stabilisation.feedback is None:
        yield say("No feedback is given: [[why]].", why=worded(stabilisation.no_feedback))


# --- gyroscopic forces ---


def _gyroscopic(part: Gyroscopic) -> Iterator[Said]:
    names: Gaps = {"names": named(part.coordinates)}
    if not part.regions:
        yield Said("The degree of instability of $K$ for [[names]] was not found.", names)
        return
    if part.free:
        yield Said(
            "$K$ for [[names]] is singular at all values of the parameters; zero eigenvalues, at least: [[free]].",
            {**names, "free": str(part.free)},
        )
    if part.degree is not None:
        yield Said(
            "Degree of instability of $K$ for [[names]] (negative eigenvalues): [[degree]] (proved).",
            {**names, "degree": str(part.degree)},
        )
        yield from _what_it_means(part, part.degree)
        return
    yield from _by_region(part)


def _by_region(part: Gyroscopic) -> Iterator[Said]:
    """The degrees, each with all its regions; by letters where the same signs are asked for again and again."""
    factors = {str(x): x for region in part.regions for x, _ in region.signs}
    names: Gaps = {"names": named(part.coordinates)}
    letters: Mapping[str, Symbol | Formula] = factors
    several = len(part.regions) > 2
    if several:
        letters = {name: symbol for name, (symbol, _) in zip(factors, numbered(_SIGN, factors.values()), strict=True)}
        relations = tuple(Relation(letters[name], "=", x) for name, x in factors.items())
        text = "The degree of instability of $K$ for [[names]] follows from the signs of [[signs]]."
        yield Said(text, {**names, "signs": relations})
    for degree in sorted({region.degree for region in part.regions}):
        regions = (
            joined((Relation(letters[str(x)], how, 0) for x, how in region.signs), ", ")
            for region in part.regions
            if region.degree == degree
        )
        gaps: Gaps = {"where": joined(regions, "; ", Said("or"), " "), "degree": str(degree)}
        if several:
            yield Said("It is [[degree]] where [[where]] (proved).", gaps)
        else:
            text = "Degree of instability of $K$ for [[names]] where [[where]]: [[degree]] (proved)."
            yield Said(text, {**names, **gaps})
        yield from _what_it_means(part, degree)


def _together(parts: Sequence[Gyroscopic]) -> Iterator[Said]:
    """What gyroscopic forces between the parts could do: each alone may be of an odd degree, both of an even one."""
    degrees = [part.degree for part in parts if not part.free]
    known = [degree for degree in degrees if degree is not None]
    if len(known) < max(2, len(parts)) or not any(degree % 2 for degree in known):
        return
    gaps: Gaps = {"names": named([name for part in parts for name in part.coordinates]), "degree": str(sum(known))}
    if sum(known) % 2:
        yield Said(
            "Of [[names]] together the degree is [[degree]], odd: no gyroscopic forces between them make the motion "
            "stable, either.",
            gaps,
        )
    elif not any(part.damped for part in parts):
        yield Said(
            "Of [[names]] together the degree is [[degree]], even: suitable gyroscopic forces between them would "
            "stabilise their first approximation.",
            gaps,
        )


def _what_it_means(part: Gyroscopic, degree: int) -> Iterator[Said]:
    if degree == 0 or part.free:
        return
    names: Gaps = {"names": named(part.coordinates)}
    if degree % 2:
        yield Said("It is odd: no gyroscopic forces among [[names]] make the motion stable (Kelvin-Chetaev).", names)
        return
    if part.damped:
        yield Said(
            "It is even, but where $D$ is positive definite the motion is unstable all the same (Kelvin-Chetaev)."
        )
        return
    if part.present:
        yield Said(
            "It is even: the gyroscopic forces among [[names]] stabilise their first approximation where the "
            "conditions of problem 6 hold; complete dissipation, however small, destroys that (Kelvin-Chetaev).",
            names,
        )
    else:
        yield Said(
            "It is even: suitable gyroscopic forces among [[names]] would stabilise their first approximation, there "
            "are none; complete dissipation, however small, would destroy that (Kelvin-Chetaev).",
            names,
        )


# --- energy ---


def _energy(energy: EnergyFunction) -> Iterator[Said]:
    names: Gaps = {"names": named(energy.coordinates)}
    if energy.conserved:
        yield Said(
            "The energy $V$ of the linear equations of [[names]], with $M$ and $K$, is an integral of theirs.", names
        )
    else:
        yield Said(
            "The energy $V$ of the linear equations of [[names]], with $M$ and $K$, changes through $D$ alone.", names
        )
    if energy.definite is True:
        yield Said("It is positive definite (proved).")
    elif energy.definite is False:
        yield Said("It is not positive definite (proved).")
    elif energy.minors:
        yield say("It is positive definite where [[where]].", where=compared(energy.minors, ">"))
    if energy.definite is None and energy.at_values is not None:
        yield Said(
            "At the given values it is positive definite (proved)."
            if energy.at_values
            else "At the given values it is not positive definite (proved)."
        )
    if energy.bundle is not None:
        weights = ", ".join(map(str, energy.bundle))
        yield Said(
            "At the given values a combination of the integrals that $V$ makes of the motion and of its derivatives, "
            "with the weights [[weights]], is positive definite (proved): the linear equations of [[names]] are stable "
            "there.",
            {**names, "weights": weights},
        )


# --- dissipation ---


def _dissipation(part: Dissipation) -> Iterator[Said]:
    names: Gaps = {"names": named(part.coordinates)}
    if part.complete:
        yield Said("$D$ is positive definite for [[names]] (proved): dissipation is complete.", names)
        return
    if part.rank.full:
        yield Said(
            "Every motion of [[names]] but rest is felt by $D$ (proved)."
            if part.rank.everywhere
            else "Every motion of [[names]] but rest is felt by $D$, for almost all parameters (proved).",
            names,
        )
    elif part.rank.factors:
        yield Said(
            "Motions of [[names]] are not felt by $D$ at all parameters (proved): those of the roots of [[roots]].",
            {**names, "roots": _roots(part.rank.factors)},
        )
        if any(factor[0].is_zero for factor in part.rank.factors):  # a drift, which is proved under conditions
            yield from _provided(part.rank.locus)
    else:
        yield Said(
            "Whether $D$ is felt by every motion of [[names]] is undecided: [[why]].",
            {**names, "why": worded(part.rank.why_not)},
        )
    for motion in part.motions:
        if motion.shape is None:
            yield say("Not felt: $\\lambda^2 = -([[square]])$.", square=motion.square)
        else:
            text = "Not felt: $\\lambda^2 = -([[square]])$, along ([[shape]])."
            yield say(text, square=motion.square, shape=motion.shape)
    yield from _locus(part.rank)
    if part.at_values is False or (part.at_values and not part.rank.everywhere):
        yield Said(
            "At the given values $D$ is felt by every motion of [[names]] but rest (proved)."
            if part.at_values
            else "At the given values $D$ is not felt by every motion of [[names]] but rest (proved).",
            names,
        )
    if part.semidefinite is False:
        yield Said("$D$ is not positive semidefinite for [[names]] (proved).", names)
    elif part.semidefinite is None:
        yield Said("That $D$ is positive semidefinite for [[names]] is not known.", names)
    elif part.rank.full:
        yield Said(
            "Where it is felt the linear equations of [[names]] are asymptotically stable if their $K$ is positive "
            "definite, and unstable if it has a negative eigenvalue and is not singular.",
            names,
        )


def _locus(rank: Rank) -> Iterator[Said]:
    """Where what was said of almost all parameters does not hold."""
    locus: Locus | None = rank.locus
    if not rank.full:
        return
    if locus is None:
        yield say("At which parameters it is otherwise was not found: [[why]].", why=worded(rank.why_not))
        return
    if locus.factors:
        yield say("It is otherwise (proved) where [[where]].", where=_any(locus.factors))
    if locus.together:
        yield say("It is otherwise where all of these vanish at once: [[where]].", where=compared(locus.together, "="))
    yield from _provided(locus)


def _provided(locus: Locus | None) -> Iterator[Said]:
    if locus is not None and locus.provided:
        yield say("This is about parameters with [[where]].", where=compared(locus.provided, "!="))


def _any(formulas: Sequence[Formula]) -> Phrase:
    return joined((Relation(formula, "=", 0) for formula in formulas), " ", Said("or"), " ")


def _roots(factors: Sequence[Sequence[Formula]]) -> Phrase:
    return joined((Phrase(("(", Polynomial(tuple(factor), "lambda"), ")")) for factor in factors), " ")


# --- control ---


def controllability(part: Control) -> Said:
    """Whether the inputs control the coordinates, for which parameters, and how surely that is known."""
    gaps: Gaps = {"names": named(part.coordinates), "inputs": named(part.inputs)}
    if part.rank.everywhere:
        return Said("Controllability of [[names]] by [[inputs]]: yes (proved).", gaps)
    if part.rank.full:
        return Said("Controllability of [[names]] by [[inputs]]: yes, for almost all parameters (proved).", gaps)
    if part.rank.factors:
        return Said(
            "Controllability of [[names]] by [[inputs]]: no (proved), out of reach are the roots of [[roots]].",
            {**gaps, "roots": _roots(part.rank.factors)},
        )
    if part.rank.certainty is Certainty.PROVED:
        return Said("Controllability of [[names]] by [[inputs]]: no (proved).", gaps)
    why: Gaps = {**gaps, "why": worded(part.rank.why_not)}
    return Said("Controllability of [[names]] by [[inputs]]: undecided ([[why]]).", why)


def _control(part: Control) -> Iterator[Said]:
    yield controllability(part)
    yield from _locus(part.rank)
    if part.at_values:
        if not part.rank.everywhere:
            yield Said("At the given values they are controllable (proved).")
    elif part.at_values is False:
        yield Said(
            "At the given values they are not controllable, but what is out of reach decays by itself (proved)."
            if part.stabilisable_at_values
            else "At the given values they are not controllable, and what is out of reach does not decay (proved)."
        )


#: What is said of a feedback, before its matrices.
FEEDBACK = (
    "At the given values the feedback $u = -k z$, $z = (q, \\dot q)$, makes the linear equations asymptotically stable "
    "(proved: the roots of the closed loop, counted exactly, lie to the left). It was found as an LQR with unit "
    "weights and rounded."
)
#: The same where values are irrational.
ENCLOSED = (
    "At the given values the feedback $u = -k z$, $z = (q, \\dot q)$, makes the linear equations asymptotically stable "
    "(proved: by the Lyapunov function below, the values being enclosed). It was found as an LQR with unit weights and "
    "rounded."
)
#: Before either, where it is one of some coordinates only.
OF_PART = "There is no feedback of all coordinates: [[why]]. This one is about the linear equations of [[names]] alone."
#: Where some velocities follow from the others.
STATES = "Here $z$ is ([[names]])."
LYAPUNOV = (
    "A Lyapunov function of the closed loop is $z \\cdot P z$: $P$ is positive definite, and its rate negative "
    "definite (proved)."
)
