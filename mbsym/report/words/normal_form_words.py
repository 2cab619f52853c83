"""What is said of problem 11."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any

from flint import arb

from mbsym.expressions.message import worded
from mbsym.problems.normal_forms.result import Focus, InSymbols, Judged, NormalForms, Outcome, Theorem, Why
from mbsym.problems.stability.words import Word
from mbsym.report.content import Gaps, Math, Notation, Number, Relation, Said, named, say

#: Digits of enclosed numbers.
DIGITS = 10

#: Why nothing is decided.
REASONS = {
    Why.ZERO_ROOT: "A root is not told from zero, or others beside a zero one are not told apart: nothing is proved.",
    Why.TWO_ZERO_ROOTS: "Two or more roots are zero, the others are to the left: the motion on a centre manifold of "
    "that dimension decides, whose equations are not formed.",
    Why.EQUAL_FREQUENCIES: "Frequencies are equal or are not told apart, and what would decide then is not proved.",
    Why.EQUAL_MORE: "Frequencies are equal or are not told apart, the energy is not shown to be definite, and there "
    "are more than two degrees of freedom: Sokolskii's theorems are of two.",
    Why.CONE_OPEN: "Frequencies are equal, with two eigenvectors for each root, and on the cone where $H_2 = 0$ the "
    "normal form of fourth order is not proved to be without zeros, nor to have a simple one: terms "
    "of higher order may decide.",
    Why.ZERO_TWO: "Zero is a double root with two eigenvectors, or a root of higher multiplicity, or this is not "
    "excluded: normal forms of these cases are not formed.",
    Why.ZERO_MORE: "A root is zero, the energy is not shown to be definite, and there are more than two degrees of "
    "freedom: Sokolskii's theorem is of two.",
    Why.ZERO_OPEN: "A root is zero, and the energy along its direction vanishes up to order 6, or is not told from "
    "that: terms of higher order may decide.",
    Why.SINGULAR_MASS: "The mass matrix is singular on the motion, or is not told from a singular one (coordinates are "
    "singular there, or what moves has no mass): there are no momenta, and no normal form.",
    Why.POLE: "At the given values the description divides by zero: there is nothing to be judged.",
    Why.NO_MOTION: "At the given values the motion does not exist, or that is not shown.",
    Why.RESONANCE_OPEN: "A resonance up to order 4 is neither proved nor excluded.",
    Why.RESONANCE: "A resonance holds that the theorems for frequencies without resonances exclude.",
    Why.RESONANT_TERM_OPEN: "The resonant term of third order is not told from zero.",
    Why.EQUALITY: "The two sides of Markeev's inequality are not told apart.",
    Why.DETERMINANT_OPEN: "The determinants $D_4$ and $D_6$ are not told from zero, or resonances of order 5 or 6 are "
    "not excluded.",
    Why.FORM_OPEN: "$H_4$ has a zero in the cone of actions $\\Omega \\cdot I = 0$, or this is not excluded.",
    Why.COEFFICIENT_OPEN: "The coefficients of second and third order on the centre manifold vanish, or are not told "
    "from zero: terms of higher order may decide.",
    Why.MORE_PAIRS: "More than one pair of roots is imaginary, and there are applied forces: not decided.",
    Why.MIXED_ROOTS: "Zero roots and imaginary ones occur together: not decided.",
    Why.IRRATIONAL: "With applied forces roots on the imaginary axis are proved where all coefficients of the "
    "characteristic polynomial are rational numbers: not decided.",
}

#: In place of a reason, where no term of higher order could have decided.
LINEAR = "The equations are exactly linear: there are no terms of higher order that could decide."

#: Arnold and Moser's theorem asks for a normal form of fourth order in the actions alone, however that comes about.
ABSENT = (
    "The terms that the resonance of third order would leave are exactly zero, so that the normal form of fourth order "
    "holds the actions alone, and $D_4$ is not zero: the motion is stable (Arnold-Moser)."
)

#: What each theorem asks, as far as it was shown.
THEOREMS = {
    Theorem.DEFINITE: "The quadratic part of the Hamiltonian is definite: the motion is stable (Dirichlet).",
    Theorem.ARNOLD_MOSER: "No resonance up to order 4 holds and $D_4$ is not zero: the motion is stable "
    "(Arnold-Moser).",
    Theorem.ARNOLD_MOSER_6: "No resonance up to order 6 holds and $D_6$ is not zero: the motion is stable, whether "
    "$D_4$ is zero or not (Arnold-Moser, order 6).",
    Theorem.THIRD: "The resonant term of third order is not zero: the motion is unstable (Markeev).",
    Theorem.THIRD_OF_MORE: "One resonance of third order alone holds, the signs of the energies in it let all its "
    "amplitudes grow together, and its term is not zero: the motion is unstable (Markeev; Khazina).",
    Theorem.EQUAL: "The frequencies are equal exactly, with one eigenvector for each root: by the sign of a "
    "coefficient of the normal form of fourth order the motion is [[word]] (Sokolskii).",
    Theorem.EQUAL_TWO: "The frequencies are equal exactly, with two eigenvectors for each root: by the zeros of "
    "the normal form of fourth order on the cone where $H_2 = 0$ the motion is [[word]] "
    "(Sokolskii; Cabral and Meyer).",
    Theorem.DEFINITE_HIGHER: "A root is zero.  With the other variables eliminated the energy begins with [[a]] times "
    "the power [[degree]] of the deviation of [[name]]: a strict minimum or maximum, the motion is stable (Dirichlet).",
    Theorem.ZERO: "A root is zero.  With the other variables eliminated the energy begins with [[a]] times the power "
    "[[degree]] of the deviation of [[name]]: by the parity of that power and the sign of its coefficient against that "
    "of the quadratic part the motion is [[word]] (Sokolskii, resonance of first order).",
    Theorem.BRUNO: "No resonance up to order 4 holds, and $H_4$ has no zero in the cone of actions $\\Omega \\cdot I "
    "= 0$: the motion is formally stable (Bruno); stability in Lyapunov's sense is not proved.",
    Theorem.ARNOLD: "No resonance up to order 4 holds, and $H_4$ is not degenerate: invariant tori fill most of the "
    "neighbourhood of the motion, it is stable for most initial states (Arnold); stability in Lyapunov's sense is not "
    "proved.",
}


def sentences(normal_forms: NormalForms) -> Iterator[Said]:
    """Everything, in order."""
    if normal_forms.cyclic:
        names: Gaps = {"names": named(normal_forms.cyclic)}
        if normal_forms.conservative:
            yield Said(
                "What is said is about the system without its cyclic coordinates [[names]], whose momenta keep their "
                "unperturbed values.",
                names,
            )
        else:
            yield Said("What is said is about the other coordinates and all velocities; [[names]] are cyclic.", names)
    if normal_forms.conservative and not normal_forms.coordinates:
        yield Said("All coordinates are cyclic: without them nothing is left that could be judged.")
        return
    if normal_forms.taken_in:
        yield Said(
            "The applied forces have a generalized potential (Helmholtz's conditions): Lagrange's function takes it in."
        )
    if normal_forms.first is not None:
        yield say(
            "At the given values problem 6 says, without normal forms and centre manifolds: [[word]].",
            word=worded(normal_forms.first.value),
        )
    if normal_forms.at_values is not None:
        yield from _judged(normal_forms.at_values, normal_forms)
    if isinstance(normal_forms.in_symbols, InSymbols):
        yield from _in_symbols(normal_forms.in_symbols, normal_forms.everywhere)
    elif isinstance(normal_forms.in_symbols, Focus):
        yield from _focus(normal_forms.in_symbols, normal_forms)
    elif normal_forms.no_symbols:
        yield say("There is no formula in parameters: [[why]].", why=worded(normal_forms.no_symbols))
    elif normal_forms.at_values is None:
        yield Said("There is no formula in parameters here; with numbers for all of them it may be decided.")


def _judged(normal_form: Judged, whole: NormalForms) -> Iterator[Said]:
    if normal_form.frequencies and whole.conservative:
        text = "Frequencies with the signs of their energies: [[values]] (enclosed)."
        yield say(text, values=tuple(map(_number, normal_form.frequencies)))
    for resonance in normal_form.resonances:
        text = "A resonance of order [[order]] holds exactly: [[relation]]."
        yield say(text, order=str(resonance.order), relation=_relation(resonance.vector, normal_form.frequencies))
    if normal_form.quadratic:
        yield say("Normal form of fourth order in the actions: [[form]].", form=_form(normal_form.quadratic))
    for order, value in normal_form.determinants:
        yield say("$[[symbol]] = [[value]]$.", symbol=Notation(f"D_{order}"), value=_number(value))
    if normal_form.theorem is Theorem.FIRST:
        yield say("The first approximation decides: the motion is [[word]].", word=worded(normal_form.outcome.value))
    elif normal_form.theorem is Theorem.FOURTH and normal_form.sides is not None:
        left, right = map(_number, normal_form.sides)
        greater = normal_form.outcome is Outcome.STABLE
        yield say(
            "Markeev's inequality of the resonance of fourth order: [[left]] is greater than [[right]], the motion is "
            "stable."
            if greater
            else "Markeev's inequality of the resonance of fourth order: [[left]] is less than [[right]], the motion "
            "is unstable.",
            left=left,
            right=right,
        )
    elif normal_form.theorem is Theorem.REDUCTION:
        yield from _centre(normal_form)
    elif normal_form.theorem in THEOREMS:
        if normal_form.theorem is Theorem.EQUAL and normal_form.coefficient is not None:
            text = "In Sokolskii's normal form of equal frequencies $\\delta A = [[value]]$."
            yield say(text, value=_number(normal_form.coefficient))
        absent = normal_form.theorem is Theorem.ARNOLD_MOSER and any(item.order <= 4 for item in normal_form.resonances)
        yield Said(ABSENT if absent else THEOREMS[normal_form.theorem], _gaps(normal_form))
    if normal_form.why in REASONS and normal_form.outcome is Outcome.UNDECIDED:
        yield Said(LINEAR if whole.linear_at_values else REASONS[normal_form.why])
    weak = normal_form.outcome in (Outcome.UNDECIDED, Outcome.FORMAL, Outcome.MOST)
    if weak and whole.first is not None and not whole.first.open:
        yield Said("That is no matter: problem 6 has decided already.")


def _gaps(form: Judged) -> Gaps:
    """What the sentence of a theorem names."""
    text = THEOREMS[form.theorem]
    gaps: Gaps = {"word": worded(form.outcome.value)} if "[[word]]" in text else {}
    if "[[degree]]" in text:
        gaps |= {"name": named((form.along,)), "degree": str(form.degree), "a": _number(form.coefficient)}
    return gaps


def _centre(normal_form: Judged) -> Iterator[Said]:
    if not normal_form.frequencies:
        unstable = normal_form.outcome is Outcome.UNSTABLE
        yield Said(
            "One root is zero, the others are to the left: the first coefficient on the centre manifold that is not "
            "zero makes the motion unstable."
            if unstable
            else "One root is zero, the others are to the left: on the centre manifold the coefficient of second order "
            "is zero and that of third order negative, the motion is asymptotically stable."
        )
        return
    soft = normal_form.outcome is Outcome.ASYMPTOTIC
    if normal_form.degree is not None:
        yield say(
            "One pair of roots is imaginary, of frequency [[w]], the others are to the left; on the centre manifold "
            "the growth of the amplitude of [[name]] has no term of third order and begins with [[a]] times its "
            "power [[degree]]: asymptotically stable."
            if soft
            else "One pair of roots is imaginary, of frequency [[w]], the others are to the left; on the centre "
            "manifold the growth of the amplitude of [[name]] has no term of third order and begins with [[a]] times "
            "its power [[degree]]: unstable.",
            w=_number(normal_form.frequencies[0]),
            a=_number(normal_form.coefficient),
            name=named((normal_form.amplitude_of,)),
            degree=str(normal_form.degree),
        )
        return
    yield say(
        "One pair of roots is imaginary, of frequency [[w]], the others are to the left; on the centre manifold the "
        "amplitude of [[name]] grows at the rate [[a]] times its cube: asymptotically stable, a soft border."
        if soft
        else "One pair of roots is imaginary, of frequency [[w]], the others are to the left; on the centre manifold "
        "the amplitude of [[name]] grows at the rate [[a]] times its cube: unstable, a hard border.",
        w=_number(normal_form.frequencies[0]),
        a=_number(normal_form.coefficient),
        name=named((normal_form.amplitude_of,)),
    )


def _in_symbols(symbols: InSymbols, everywhere: Word | None) -> Iterator[Said]:
    yield say(
        "In parameters, for the frequencies $\\omega_1$ and $\\omega_2$: the sum of their squares is [[trace]], the "
        "product of these [[product]], the discriminant [[discriminant]].",
        trace=symbols.trace,
        product=symbols.product,
        discriminant=symbols.discriminant,
    )
    zero = symbols.zero if symbols.vanishing is None else symbols.vanishing.determinant
    resonances = symbols.resonances if symbols.vanishing is None else symbols.vanishing.resonances
    if symbols.determinant.is_zero:
        yield Said("$D_4$ is zero for all parameters: the theorem of Arnold and Moser decides nothing at this order.")
    elif zero.is_number:
        yield say("$D_4 = [[determinant]]$; it vanishes for no parameters.", determinant=symbols.determinant)
    else:
        yield say(
            "$D_4 = [[determinant]]$; it vanishes where $[[zero]] = 0$.", determinant=symbols.determinant, zero=zero
        )
    for vector, formula in resonances:
        if not formula.is_number:
            yield say(
                "The resonance [[ratio]] holds where this vanishes: [[formula]].",
                ratio=Notation(f"{vector[0]}:{vector[1]}"),
                formula=formula,
            )
    if everywhere is not None:
        yield say("For all parameters problem 6 has decided already: [[word]].", word=worded(everywhere.value))
        return
    if symbols.determinant.is_zero:
        return
    yield Said(
        "Where sum, product and discriminant are positive the motion is stable (Arnold-Moser) but for parameters at "
        "which $D_4$ or one of these resonances vanishes; what holds there is told at numbers."
    )


def _focus(focus: Focus, whole: NormalForms) -> Iterator[Said]:
    if focus.coefficient.is_zero and (whole.everywhere is not None or whole.linear):
        text = "Two roots have the sum zero for all parameters, the square of their frequency is [[square]]."
        yield say(text, square=focus.square)
        if whole.linear and whole.at_values is None:
            yield Said(LINEAR)
        if whole.everywhere is not None:
            sentence = "For all parameters problem 6 has decided already: [[word]]."
            yield say(sentence, word=worded(whole.everywhere.value))
        return
    if focus.coefficient.is_zero:
        yield say(
            "Two roots have the sum zero for all parameters, the square of their frequency is [[square]]; on the "
            "centre manifold the growth of the amplitude of [[name]] is without a term of third order for all "
            "parameters: those of higher order may decide.",
            square=focus.square,
            name=named((focus.amplitude_of,)),
        )
        return
    yield say(
        "Two roots have the sum zero for all parameters, the square of their frequency is [[square]]; on the centre "
        "manifold the amplitude of [[name]] grows, but for terms of higher order, at the rate [[a]] times its cube.  "
        "Where that square is positive and all other roots are to the left the motion is asymptotically stable if this "
        "rate is negative and unstable if it is positive.",
        square=focus.square,
        a=focus.coefficient,
        name=named((focus.amplitude_of,)),
    )


def _relation(vector: Sequence[int], frequencies: Sequence[Any]) -> Notation:
    """omega1 = 2 |omega2|, where the second one is told with the sign of a negative energy."""
    sides: tuple[list[str], list[str]] = ([], [])
    for place, (k, frequency) in enumerate(zip(vector, frequencies, strict=True), start=1):
        if k:
            size = f"|\\omega_{place}|" if frequency < 0 else f"\\omega_{place}"
            sides[k < 0].append((f"{abs(k)} " if abs(k) > 1 else "") + size)
    return Notation(" = ".join(" + ".join(side) or "0" for side in sides))


def _form(quadratic: Sequence[tuple[tuple[int, int], Any]]) -> Relation:
    parts: list[Math | str] = []
    for (i, j), value in quadratic:
        text = decimal(value)
        if parts or text.startswith("-"):
            parts.append("-" if text.startswith("-") else "+")
        power = f"I_{i + 1}^2" if i == j else f"I_{i + 1} I_{j + 1}"
        parts += [Number(text.lstrip("-")), Notation(power)]
    return Relation(*parts)


def _number(x: Any) -> Number:
    return Number(decimal(x))


def decimal(x: Any) -> str:
    """A number in decimals: as many digits as its enclosure gives, at most ``DIGITS``; an exact one as it is."""
    if isinstance(x, arb):
        if x.is_zero():
            return "0"
        if x.contains(0):
            return f"0 within {float(x.rad() + abs(x.mid())):.1e}"
        return f"{float(x):.{DIGITS}g}" if x.rel_accuracy_bits() > 34 else str(x.str(DIGITS, radius=False))
    exact = Fraction(int(x.p), int(x.q)) if hasattr(x, "p") else Fraction(x)
    text = str(exact)
    return text if len(text) <= 16 else f"{float(exact):.{DIGITS}g}"
