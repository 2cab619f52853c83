"""``mbsym integrals --relations``: what is printed of invariant relations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.expressions.message import Message, joined
from mbsym.problems.polynomial_integrals.result import Obstacle
from mbsym.report.words.integrals_words import (
    ALMOST,
    ANY_LENGTH,
    NOT_LOOKED_FOR,
    NOTHING_KNOWN,
    all_values,
    equations_text,
    level_title,
    no_further,
    title,
    undecided_at,
    weights_here,
)

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals import (
        DarbouxAlong,
        DarbouxPolynomials,
        PolynomialIntegrals,
        Relations,
        ZeroLevels,
    )

#: Why it is not known that there are no other invariant relations.
UNDECIDED = {
    Obstacle.NOT_HOMOGENEOUS: Message(
        "relations between variables, of several unit vectors, angles or roots, are not looked at here"
    ),
    Obstacle.MIXED: Message("a K of that weight may hold products of variables, which is not looked at"),
    Obstacle.NOT_AT_REST: Message(
        "K is read off at rest where one variable alone is not zero, and there is no rest there"
    ),
    Obstacle.TOO_MANY: Message("there may be more K of one weight than are looked at"),
}
#: Of an f that no motion makes zero.
NO_RELATION = Message("no relation of motions: it is zero nowhere, or the equations are not defined there")
#: Where nothing is looked for along a line.
UNLOOKED = (Obstacle.NOT_HOMOGENEOUS, Obstacle.MIXED, Obstacle.NOT_AT_REST)


def relation_lines(there: Setting, relations: Relations) -> Iterator[str]:
    """Each relation with its conditions, and whether there are others."""

    def write(p: Any) -> str:
        return str(there.formula(p))

    for relation in relations.relations:
        yield f"{write(relation.polynomial)} = 0"
        if relation.conditions:
            yield Message("  where [[conditions]]", conditions=equations_text(relation.conditions, write))
        if relation.nonzero:
            nonzero = ", ".join(f"{write(p)} != 0" for p in relation.nonzero)
            yield Message("  provided [[conditions]]", conditions=nonzero)
    if not relations.relations:
        yield Message("none was found" if not relations.complete else "there are none (proved)")
    elif relations.complete:
        yield Message("There are no other forms that are linear in the variables of least weight (proved).")
    if not relations.complete:
        yield Message(
            "Whether there are others is undecided: roots of parameters and families of forms were not followed."
        )


def level_lines(there: Setting, usual: PolynomialIntegrals, levels: ZeroLevels | None) -> Iterator[str]:
    """What holds where an integral of the list is zero, and that nothing else does."""
    if levels is None:
        yield NOT_LOOKED_FOR
        return
    if levels.weights not in (None, usual.grading.weights):
        yield weights_here(there.field.variables, levels.weights or ())
    length = "" if levels.weights is None or not there.vectors else ANY_LENGTH
    almost = ALMOST if there.field.parameters else ""
    for level in levels.levels:
        for weight, f in level.integrals:
            yield joined((level_title(weight, level), there.formula(f)), ": ")
        known = {"weight": level.level.weight, "name": title(level.level), "degree": usual.degree}
        if level.complete:
            text = (
                "where the integral of weight [[weight]] ([[name]]) is zero there is none beyond those that hold "
                "everywhere of weight up to [[degree]][[almost]] (proved[[length]])."
            )
            if level.integrals:
                text = (
                    "where the integral of weight [[weight]] ([[name]]) is zero there is no other of weight up to "
                    "[[degree]][[almost]] (proved[[length]])."
                )
            yield Message(text, **known, almost=almost, length=length)
        else:
            yield Message(
                "where the integral of weight [[weight]] ([[name]]) is zero there may be others of weight up to "
                "[[degree]]: not found within the budget.",
                **known,
            )
    if not levels.levels:
        yield Message("There is no integral in the list whose zeros could be looked at.")


def darboux_lines(there: Setting, usual: PolynomialIntegrals, darboux: DarbouxPolynomials) -> Iterator[str]:
    """Each f with its K, and whether there are others."""
    if darboux.weights != usual.grading.weights:
        yield weights_here(there.field.variables, darboux.weights)
    almost = ALMOST if there.field.parameters else ""
    length = ANY_LENGTH if there.vectors else ""
    for polynomial in darboux.polynomials:
        formula = there.formula(polynomial.polynomial)
        yield Message("weight [[weight]]: [[formula]] = 0", weight=polynomial.weight, formula=formula)
        yield f"  K = {there.quotient(polynomial.cofactor, there.field.denominator)}"
        if not polynomial.defined:
            yield joined(("  ", NO_RELATION), "")
    for count in darboux.counts:
        if not count.complete:
            cofactor = there.quotient(count.cofactor, there.field.denominator)
            yield Message(
                "of weight [[weight]] with K = [[cofactor]] there are at most [[more]] more; they were not found "
                "within the budget.",
                weight=count.weight,
                cofactor=cofactor,
                more=count.most - count.products,
            )
    if darboux.obstacle is not None:
        yield Message("Whether there are others is undecided: [[why]].", why=UNDECIDED[darboux.obstacle])
    elif darboux.complete:
        text = (
            "There is none of weight up to [[degree]] with K not zero and coefficients that are rational (in the "
            "parameters)[[almost]] (proved[[length]])."
        )
        if darboux.polynomials:
            text = (
                "Every other f of weight up to [[degree]] with K not zero and coefficients that are rational (in the "
                "parameters) is a combination of products of these and of integrals[[almost]] (proved[[length]])."
            )
        yield Message(text, degree=darboux.degree, almost=almost, length=length)


def darboux_values(there: Setting, usual: PolynomialIntegrals, along: DarbouxAlong) -> Iterator[str]:
    """Each value of the parameter with its f and K, and what is known of other values."""
    name = along.name
    for special in along.values:
        yield f"{name} = {special.value}"
        for f in special.polynomials:
            formula = there.formula(f.polynomial)
            yield joined(("  ", Message("weight [[weight]]: [[formula]] = 0", weight=f.weight, formula=formula)), "")
            yield f"    K = {there.quotient_over(special.field, f.cofactor)}"
            if not f.defined:
                yield joined(("    ", NO_RELATION), "")
    if along.general.obstacle in UNLOOKED:
        yield Message("not looked for: [[why]]", why=UNDECIDED[along.general.obstacle])
        return
    if not along.values:
        yield no_further(name, along.low, along.high)
    yield from undecided_at(name, along.undecided, along.irrational)
    for p in along.square:
        text = "undecided where [[formula]] is the square of a rational number: there may be others at each"
        yield Message(text, formula=there.formula(p))
    if along.left:
        yield Message("Possible K beyond the budget: [[count]]; nothing is known of them.", count=along.left)
    if not along.followed:
        yield Message("Not all K that become rational at single values were followed: nothing is known of them.")
    if not along.general.complete:
        yield Message(NOTHING_KNOWN, name=name)
    elif along.complete:
        yield Message(
            "[[all]] of [[name]] from [[low]] to [[high]] with numerator and denominator up to 10^9 there "
            "is none of weight up to [[degree]] with rational coefficients beyond those for almost all [[name]] "
            "(proved[[length]]); irrational values are undecided.",
            all=all_values(along.values),
            name=name,
            low=along.low,
            high=along.high,
            degree=usual.degree,
            length=ANY_LENGTH if there.vectors else "",
        )
