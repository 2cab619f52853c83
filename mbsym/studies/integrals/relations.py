"""``mbsym integrals --relations``: what is printed of invariant relations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.problems.polynomial_integrals.result import Obstacle
from mbsym.report.words.integrals_words import equations_text, level_title, title, weights_text

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
    Obstacle.NOT_HOMOGENEOUS: "relations between variables, of several unit vectors, angles or roots, "
    "are not looked at here",
    Obstacle.MIXED: "a K of that weight may hold products of variables, which is not looked at",
    Obstacle.NOT_AT_REST: "K is read off at rest where one variable alone is not zero, and there is no rest there",
    Obstacle.TOO_MANY: "there may be more K of one weight than are looked at",
}
#: Where nothing is looked for along a line.
UNLOOKED = (Obstacle.NOT_HOMOGENEOUS, Obstacle.MIXED, Obstacle.NOT_AT_REST)


def relation_lines(there: Setting, found: Relations) -> Iterator[str]:
    """Each relation with its conditions, and whether there are others."""

    def write(p: Any) -> str:
        return str(there.formula(p))

    for relation in found.relations:
        yield f"{write(relation.polynomial)} = 0"
        if relation.conditions:
            yield f"  where {equations_text(relation.conditions, write)}"
        if relation.nonzero:
            yield f"  provided {', '.join(f'{write(p)} != 0' for p in relation.nonzero)}"
    if not found.relations:
        yield "none was found" if not found.complete else "there are none (proved)"
    elif found.complete:
        yield "There are no other forms that are linear in the variables of least weight (proved)."
    if not found.complete:
        yield "Whether there are others is undecided: roots of parameters and families of forms were not followed."


def level_lines(there: Setting, found: PolynomialIntegrals, levels: ZeroLevels | None) -> Iterator[str]:
    """What holds where an integral of the list is zero, and that nothing else does."""
    if levels is None:
        yield "not looked for: several unit vectors or angles are related, or roots occur, which is not looked at here"
        return
    if levels.weights not in (None, found.grading.weights):
        yield f"weights are {weights_text(there.field.variables, levels.weights or ())} here"
    length = "" if levels.weights is None or not there.vectors else "; unit vectors of any length"
    almost = ", for almost all values of the parameters" if there.field.parameters else ""
    for level in levels.levels:
        for weight, f in level.integrals:
            yield f"{level_title(weight, level)}: {there.formula(f)}"
        where = f"where that of weight {level.level.weight} ({title(level.level)}) is zero"
        other = "no other" if level.integrals else "none beyond those that hold everywhere"
        if level.complete:
            yield f"{where} there is {other} of weight up to {found.degree}{almost} (proved{length})."
        else:
            yield f"{where} there may be others of weight up to {found.degree}: not found within the budget."
    if not levels.levels:
        yield "There is no integral in the list whose zeros could be looked at."


def darboux_lines(there: Setting, usual: PolynomialIntegrals, found: DarbouxPolynomials) -> Iterator[str]:
    """Each f with its K, and whether there are others."""
    if found.weights != usual.grading.weights:
        yield f"weights are {weights_text(there.field.variables, found.weights)} here"
    almost = ", for almost all values of the parameters" if there.field.parameters else ""
    length = "; unit vectors of any length" if there.vectors else ""
    for polynomial in found.polynomials:
        yield f"weight {polynomial.weight}: {there.formula(polynomial.polynomial)} = 0"
        yield f"  K = {there.quotient(polynomial.cofactor, there.field.denominator)}"
        if not polynomial.defined:
            yield "  no relation of motions: it is zero nowhere, or the equations are not defined there"
    for count in found.counts:
        if not count.complete:
            cofactor = there.quotient(count.cofactor, there.field.denominator)
            yield (
                f"of weight {count.weight} with K = {cofactor} there are at most {count.most - count.products} more; "
                "they were not found within the budget."
            )
    if found.obstacle is not None:
        yield f"Whether there are others is undecided: {UNDECIDED[found.obstacle]}."
    elif found.complete:
        none = "Every other f of weight up to" if found.polynomials else "There is none of weight up to"
        but = " is a combination of products of these and of integrals" if found.polynomials else ""
        yield (
            f"{none} {found.degree} with K not zero and coefficients that are rational (in the parameters)"
            f"{but}{almost} (proved{length})."
        )


def darboux_values(there: Setting, usual: PolynomialIntegrals, found: DarbouxAlong) -> Iterator[str]:
    """Each value of the parameter with its f and K, and what is known of other values."""
    name, interval = found.name, f"of {found.name} from {found.low} to {found.high}"
    for special in found.values:
        yield f"{name} = {special.value}"
        for f in special.polynomials:
            yield f"  weight {f.weight}: {there.formula(f.polynomial)} = 0"
            yield f"    K = {there.quotient_over(special.field, f.cofactor)}"
            if not f.defined:
                yield "    no relation of motions: it is zero nowhere, or the equations are not defined there"
    if found.general.obstacle in UNLOOKED:
        yield f"not looked for: {UNDECIDED[found.general.obstacle]}"
        return
    if not found.values:
        yield f"at no rational value {interval} was a further one found"
    for value in found.undecided:
        yield f"whether there are others at {name} = {value} is undecided"
    for p in found.irrational:
        yield f"undecided at the zeros of {str(p).replace('x', name)}"
    for p in found.square:
        yield f"undecided where {there.formula(p)} is the square of a rational number: there may be others at each"
    if found.left:
        yield f"{found.left} possible K were not looked at within the budget: of these nothing is known."
    if not found.followed:
        yield "Not all K that become rational at single values were followed: of these nothing is known."
    if not found.general.complete:
        yield f"What there is for almost all {name} is not known to be all: of other values nothing is proved."
    elif found.complete:
        length = "; unit vectors of any length" if there.vectors else ""
        others = "At all other values" if found.values else "At all values"
        yield (
            f"{others} {interval} with numerator and denominator up to 10^9 there is none of weight up to "
            f"{usual.degree} with rational coefficients beyond those for almost all {name} (proved{length}); "
            "irrational values are undecided."
        )
