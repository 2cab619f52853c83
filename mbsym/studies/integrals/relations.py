"""``mbsym integrals`` with ``--relations``, ``--vary``, ``--cases``: relations, levels, special parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mbsym.expressions.message import Message, joined
from mbsym.problems.polynomial_integrals.result import Obstacle
from mbsym.report.words.integrals_words import (
    ALMOST,
    ANY_LENGTH,
    BUT_FOR_ALGEBRAIC,
    NOT_LOOKED_FOR,
    NOTHING_KNOWN,
    all_values,
    case_title,
    conditions_text,
    equations_text,
    level_title,
    no_further,
    title,
    undecided_at,
    weights_here,
)

if TYPE_CHECKING:
    from mbsym.analysis.polynomial import Setting
    from mbsym.problems.polynomial_integrals.homogenised import ZeroLevels
    from mbsym.problems.polynomial_integrals.result import (
        Along,
        Cases,
        DarbouxAlong,
        DarbouxPolynomials,
        OtherLevel,
        OtherLevels,
        PolynomialIntegrals,
        Relations,
        Special,
    )

#: Why it is not known that there are no other invariant relations.
UNDECIDED = {
    Obstacle.NOT_HOMOGENEOUS: Message(
        "relations between variables, of several unit vectors, angles, roots or constraints, are not looked at here"
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


# ``mbsym integrals --vary`` and ``--cases``: what is printed of special parameters.


def along_lines(there: Setting, usual: PolynomialIntegrals, along: Along) -> Iterator[str]:
    """The values, what there is at each, and what is known of the others."""
    if along.weights not in (None, usual.grading.weights):
        yield weights_here(there.field.variables, along.weights or ())
    length = "" if along.weights is None or not there.vectors else ANY_LENGTH
    for special in along.values:
        yield f"{along.name} = {special.value}"
        yield from _special(there, special)
    if not along.values:
        yield no_further(along.name, along.low, along.high)
    yield from undecided_at(along.name, along.undecided, along.irrational)
    without = Message(" that does not contain [[names]]", names=", ".join(usual.aside)) if usual.aside else ""
    if not along.usual:
        yield Message(NOTHING_KNOWN, name=along.name)
        return
    text = (
        "[[all]] of [[name]] from [[low]] to [[high]] with numerator and denominator up to 10^9 there is no further "
        "integral of weight up to [[degree]][[without]] (proved[[length]]); irrational values are undecided."
    )
    ends: dict[str, object] = {"low": along.low, "high": along.high}
    if along.whole:
        text = (
            "[[all]] of [[name]] from [[low]] to [[high]], rational or not, there is no further integral of weight up "
            "to [[degree]][[without]] ([[how]][[length]])."
        )
        ends["how"] = BUT_FOR_ALGEBRAIC
    ends["all"] = all_values(along.values or along.undecided)
    yield Message(text, name=along.name, **ends, degree=usual.degree, without=without, length=length)


def cases_lines(there: Setting, cases: Cases) -> Iterator[str]:
    """The cases, and what the list is not."""
    for case in cases.cases:
        yield conditions_text(case, lambda p: str(there.formula(p)))
        yield from _special(there, case.special)
    if not cases.cases:
        yield Message("no case was found")
    yield Message(
        "Families of parameters searched (some zero, some equal that play the same part): [[count]], with conditions "
        "of degree up to 3 in each. The integrals are proved; that there are no other cases is not.",
        count=cases.families,
    )
    if cases.left:
        yield Message("Families beyond the budget (--budget): [[count]]; nothing is known of them.", count=cases.left)
    if cases.unread:
        yield Message(
            "Families in which the rank also drops under conditions that were not found: [[count]].", count=cases.unread
        )


def _special(there: Setting, special: Special) -> Iterator[str]:
    for weight, f in special.integrals:
        yield joined(("  ", case_title(weight), ": ", there.formula(f)), "")
    for level in special.levels:
        for weight, f in level.integrals:
            yield joined(("  ", level_title(weight, level), ": ", there.formula(f)), "")


# ``mbsym integrals --relations``: what is printed of integrals where another one has a value that is not zero.


def other_lines(there: Setting, other_levels: OtherLevels | None) -> Iterator[str]:
    """What holds on single levels, and what is known of all others."""
    if other_levels is None:
        yield NOT_LOOKED_FOR
        return
    for level in other_levels.levels:
        yield from _of(there, other_levels, level)
    if not other_levels.levels:
        yield Message("There is no integral in the list whose values could be looked at.")


def _of(there: Setting, other_levels: OtherLevels, other: OtherLevel) -> Iterator[str]:
    that = Message("the integral of weight [[weight]] ([[name]])", weight=other.level.weight, name=title(other.level))
    power = other.power
    value = that if power == 1 else Message("the power [[power]] of [[integral]]", power=power, integral=that)
    vectors = bool(there.field.relations) and (not other_levels.fixed or other_levels.weights is not None)
    if not other.looked:
        yield Message("where [[integral]] is not zero there may be others: not found within the budget.", integral=that)
        return
    for at in other.values:
        for weight, f in at.integrals:
            yield Message(
                "where [[integral]] is [[value]], one of weight [[weight]]: [[formula]]",
                integral=value,
                value=at.value,
                weight=weight,
                formula=there.formula(f),
            )
        if not at.complete:
            yield Message("  where it is [[value]] there may be others: not found within the budget", value=at.value)
    for number in other.undecided:
        text = "whether there are others where [[integral]] is [[value]] is undecided"
        yield Message(text, integral=value, value=number)
    for p in other.irrational:
        text = "undecided where [[integral]] is a zero c of [[polynomial]]"
        yield Message(text, integral=value, polynomial=str(p).replace("x", "c"))
    if not other.complete:
        yield Message(
            "where [[integral]] is not zero there may be others at almost all of its values: those are integrals that "
            "hold everywhere, of higher weight or not found, with this value put in.",
            integral=that,
        )
        return
    if other.drops:
        text = "where [[integral]] has single values, other than zero, there may be others: put in numbers with --set."
        yield Message(text, integral=that)
        return
    known = {
        "integral": that,
        "degree": other_levels.degree,
        "almost": ALMOST if there.field.parameters else "",
        "length": ANY_LENGTH if vectors else "",
    }
    text = (
        "where [[integral]] is not zero there is none beyond those that hold everywhere of weight up to "
        "[[degree]][[almost]] ([[how]][[length]])."
    )
    if not other.by_rank:
        known["how"] = Message("proved")
    elif there.field.parameters:
        known["how"] = Message("verified at random parameters modulo a prime")
    elif other.whole:
        known["how"] = BUT_FOR_ALGEBRAIC
    else:
        known["integral"] = value
        text = (
            "where [[integral]] has any other rational value but zero, with numerator and denominator up to 10^9, "
            "there is none beyond those that hold everywhere of weight up to [[degree]][[almost]] (proved[[length]]); "
            "other irrational values are undecided."
        )
    yield Message(text, **known)
