"""What is said of polynomial integrals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.expressions.message import Message, worded
from mbsym.problems.polynomial_integrals.result import FUNCTION, Case, Generator, OnLevel, PolynomialIntegrals
from mbsym.report.content import Gaps, Inline, Phrase, Said, joined, named, say
from mbsym.report.plain_writer import Writer

#: One integral of a list, and one that holds where another is zero.
LISTED = "Weight [[weight]], [[name]]:"
LEVEL = "Weight [[weight]], where that of weight [[own]] ([[name]]) is zero:"
#: What the list is about.
OPENING = (
    "Looked for are polynomials up to weighted degree [[degree]] whose derivatives vanish by the equations of motion; "
    "weights of the variables: [[weights]]."
)
UNIFORM = "Under these weights the equations are quasi-homogeneous."
NOT_UNIFORM = "Under these weights the equations are not quasi-homogeneous."


#: What is said behind a proof, where it holds for more, and of whom.
ANY_LENGTH = Message("; unit vectors of any length")
BUT_FOR_ALGEBRAIC = Message(
    "proved, but for algebraic numbers whose polynomials over the integers need coefficients beyond 10^9"
)
ALMOST = Message(", for almost all values of the parameters")
NOTHING_KNOWN = "What there is for almost all [[name]] is not known to be all: of other values nothing is proved."
NOT_LOOKED_FOR = Message(
    "not looked for: several unit vectors or angles are related, constraints tie positions, or roots occur, which is "
    "not looked at here"
)


def weights_here(variables: Sequence[Inline], given: Sequence[int]) -> Message:
    """Where they are others than those of the list."""
    return Message("weights are [[weights]] here", weights=weights_text(variables, given))


def no_further(name: str, low: object, high: object) -> Message:
    """Along a parameter."""
    text = "at no rational value of [[name]] from [[low]] to [[high]] was a further one found"
    return Message(text, name=name, low=low, high=high)


def all_values(but: Sequence[object]) -> Message:
    """All of a parameter, ``but`` those that were told."""
    return Message("At all other values") if but else Message("At all values")


def undecided_at(name: str, values: Sequence[object], polynomials: Sequence[object]) -> Iterator[Message]:
    """Values of a parameter, and zeros of polynomials in it."""
    for value in values:
        yield Message("whether there are others at [[name]] = [[value]] is undecided", name=name, value=value)
    for p in polynomials:
        yield Message("undecided at the zeros of [[polynomial]]", polynomial=str(p).replace("x", name))


def weights_text(variables: Sequence[Inline], weights: Sequence[int]) -> str:
    """``p, q, r: 1; gamma1, gamma2, gamma3: 2``."""
    return Writer().inline(weighted(variables, weights))


def weighted(variables: Sequence[Inline], weights: Sequence[int]) -> Phrase:
    """The same as a value: those of each weight together."""
    groups: dict[int, list[Inline]] = {}
    for variable, weight in zip(variables, weights, strict=True):
        groups.setdefault(weight, []).append(variable)
    return joined((Phrase((joined(items, ", "), f": {weight}")) for weight, items in groups.items()), "; ")


def title(generator: Generator) -> str:
    """What an integral is called."""
    return generator.name or Message("further integral")


def case_title(weight: int) -> str:
    """Of an integral that holds in a special case."""
    return Message("further integral of weight [[weight]]", weight=weight)


def level_title(weight: int, level: OnLevel) -> str:
    """Of one that holds where another one vanishes."""
    return Message(
        "where the integral of weight [[other]] ([[name]]) is zero, one of weight [[weight]]",
        other=level.level.weight,
        name=title(level.level),
        weight=weight,
    )


def conditions_text(case: Case, write: Callable[[Any], str]) -> str:
    """``A = B, x0 = 0``: differences of two names as equations between them."""
    return equations_text(case.conditions, write)


def equations_text(polynomials: Sequence[Any], write: Callable[[Any], str]) -> str:
    """The same of polynomials that vanish."""
    return ", ".join(_equation(p, write) for p in polynomials)


def _equation(p: Any, write: Callable[[Any], str]) -> str:
    terms = sorted(p.to_dict().items(), key=lambda item: item[0], reverse=True)
    if len(terms) == 2 and terms[0][1] * terms[1][1] < 0:
        sign = 1 if terms[0][1] > 0 else -1
        left, right = (p.context().from_dict({m: c * sign * k}) for (m, c), k in zip(terms, (1, -1), strict=True))
        return f"{write(left)} = {write(right)}"
    return f"{write(p)} = 0"


def sentences(polynomial_integrals: PolynomialIntegrals) -> Iterator[Said]:
    """What is known of the list as a whole."""
    values: Gaps = {
        "degree": str(polynomial_integrals.degree),
        "count": str(polynomial_integrals.independent),
        "names": named(polynomial_integrals.aside),
    }
    if not polynomial_integrals.generators:
        vectors = polynomial_integrals.field.relations and all(
            name.isidentifier() for name in polynomial_integrals.field.variables
        )
        none = _NONE_BUT_LENGTHS if vectors else _NONE
        none = _NONE_WITHOUT if polynomial_integrals.aside and not vectors else none
        yield Said(
            none[bool(polynomial_integrals.field.free_parameters)]
            if polynomial_integrals.complete
            else "None was found.",
            values,
        )
        yield from _left_out(polynomial_integrals)
        return
    yield Said("As functions at least [[count]] of them are independent (proved: rank of the gradients).", values)
    if any(integral.name.startswith("product of ") for integral in polynomial_integrals.generators):
        yield Said(_TRIVIAL, values)
    for generator in polynomial_integrals.generators:
        if not generator.independent:
            yield say(_DEPENDENT[generator.certainty], name=worded(title(generator)), weight=str(generator.weight))
    if polynomial_integrals.complete:
        yield Said(_EVERY[bool(polynomial_integrals.aside)][bool(polynomial_integrals.field.free_parameters)], values)
    yield from _left_out(polynomial_integrals)
    for count in polynomial_integrals.counts:
        if not count.complete:
            yield say(
                "Of weight [[weight]] there are at most [[more]] more; they were not found within the budget.",
                weight=str(count.weight),
                more=str(count.most - count.products),
            )
    if (
        polynomial_integrals.complete
        and not polynomial_integrals.new
        and all(integral.name != FUNCTION for integral in polynomial_integrals.generators)
    ):
        yield Said(
            (_NO_OTHER_WITHOUT if polynomial_integrals.aside else _NO_OTHER)[
                bool(polynomial_integrals.field.free_parameters)
            ],
            values,
        )


def _left_out(polynomial_integrals: PolynomialIntegrals) -> Iterator[Said]:
    """x' - B y, of a charge in a magnetic field, is not looked for, nor the area integral of a free body."""
    if polynomial_integrals.tied:
        yield Said("Constraints may have several branches: those of one branch alone are not looked for.")
    if polynomial_integrals.aside:
        text = "The equations do not contain [[names]]: integrals that do are not looked for here."
        yield say(text, names=named(polynomial_integrals.aside))
    if polynomial_integrals.rational:
        text = "Integrals of problem 7 that are no polynomials in these variables, but quotients of such: [[names]]."
        yield say(text, names=joined((worded(x) for x in polynomial_integrals.rational), ", "))
    if polynomial_integrals.inside:
        text = "Integrals that hold [[names]] outside of these variables are not looked for."
        yield say(text, names=named(polynomial_integrals.inside))


_EVERY = {
    False: {
        True: "Every polynomial integral of weighted degree up to [[degree]] is a polynomial in these, for almost all "
        "values of the parameters (proved).",
        False: "Every polynomial integral of weighted degree up to [[degree]] is a polynomial in these (proved).",
    },
    True: {
        True: "Every polynomial integral of weighted degree up to [[degree]] that does not contain [[names]] is a "
        "polynomial in these, for almost all values of the parameters (proved).",
        False: "Every polynomial integral of weighted degree up to [[degree]] that does not contain [[names]] is a "
        "polynomial in these (proved).",
    },
}
_NONE_WITHOUT = {
    True: "There is none up to weighted degree [[degree]] that does not contain [[names]] (proved for almost all "
    "values of the parameters).",
    False: "There is none up to weighted degree [[degree]] that does not contain [[names]] (proved).",
}
_NONE = {
    True: "There is none up to weighted degree [[degree]] (proved for almost all values of the parameters).",
    False: "There is none up to weighted degree [[degree]] (proved).",
}
#: The length of a unit vector is constant, too: it is 1, and problem 7 may list it.
_NONE_BUT_LENGTHS = {
    True: "But for relations that every state keeps, as lengths of unit vectors are, there is none up to weighted "
    "degree [[degree]] (proved for almost all values of the parameters).",
    False: "But for relations that every state keeps, as lengths of unit vectors are, there is none up to weighted "
    "degree [[degree]] (proved).",
}
#: Those of vectors of one body are integrals of the kinematic equations alone.
_TRIVIAL = "Lengths of unit vectors and products of two of them are the same in every motion: 1 and 0."
_NO_OTHER = {
    True: "Up to weighted degree [[degree]] there is none beyond those of problem 7, for almost all values of the "
    "parameters.",
    False: "Up to weighted degree [[degree]] there is none beyond those of problem 7.",
}
_NO_OTHER_WITHOUT = {
    True: "Up to weighted degree [[degree]] there is none without [[names]] beyond those of problem 7, for almost all "
    "values of the parameters.",
    False: "Up to weighted degree [[degree]] there is none without [[names]] beyond those of problem 7.",
}
_DEPENDENT = {
    Certainty.PROVED: "That of weight [[weight]] ([[name]]) depends on those before it as a function "
    "(proved: no more can be).",
    Certainty.VERIFIED: "That of weight [[weight]] ([[name]]) depends on those before it as a function "
    "(verified at a random state).",
    Certainty.UNDECIDED: "Whether that of weight [[weight]] ([[name]]) is independent of those before it is undecided.",
}
