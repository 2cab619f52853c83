"""Claimed conditions of stability: proved from those of problem 6, refuted by exact parameters, or left undecided.

Of a condition C that is to be necessary, one measure for systems of every kind:

* it **holds exactly** if the motion is proved to be unstable wherever C does not hold;
* it holds **but for border cases** if C is strict and the motion is proved to be unstable where C does not hold with
  equality either: at equality it may be stable where a condition of problem 6 is an equality, too, and is told to be
  where such parameters are known;
* it **does not hold** if other parameters are known at which C does not hold and the motion is stable, be it in first
  approximation;
* where no parameters but perhaps border cases make the motion stable, C says nothing.

C is sufficient if with it, and the others of its place, the cases of problem 6 give the whole a stable verdict.  All of
this is decided of sets of parameters (``regions``): the cases of the parts are intersected, and what is proved to be
empty is left out.  Whatever refutes is a point at which the exact judge was asked.

Parameters that are no body's are left out: where it helps, the triangle inequalities of the moments of inertia are
used, and the remark says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from typing import Any

from mbsym.algebra.factors import rational_ratio
from mbsym.algebra.failures import NOT_THERE, NoClosedForm
from mbsym.algebra.signs import ContradictionError, Signs
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import subtract
from mbsym.model.claims import NECESSARY, SUFFICIENT, Claim
from mbsym.problems.claims.counterexample import IN_FIRST, Counterexample, Gap, Tried
from mbsym.problems.claims.regions import Inequality, Region, is_certain
from mbsym.problems.claims.remarks import Remark, Said, named, said, words
from mbsym.problems.claims.result import ClaimResult, Derived, Outcome
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.stability.verdict import Flaw, Verdict, weakest
from mbsym.problems.stability.words import Word, with_theorem

_BODIES = Message(", with the triangle inequalities of the inertias")
_BUT_EQUALITY = Message(", but for the case of equality")
_STRICT = (">", "<")


def examined_condition(derived: Derived, claim: Claim, about: str) -> ClaimResult:
    """The claimed inequality against problem 6.

    Sufficient conditions of one place count together.
    """
    result = ClaimResult(claim, about, Outcome.EXACT)
    examined = _sufficient if claim.role == SUFFICIENT else _necessary
    return examined(derived, claim, result)


def _told(result: ClaimResult, outcome: str, *remarks: Remark, example: Counterexample | None = None) -> ClaimResult:
    return replace(result, outcome=outcome, remark=words(remarks), counterexample=example)


# --- necessary conditions, and those without a role ---


@dataclass(frozen=True)
class Need:
    """What is proved of a condition: ``beyond`` (and even with equality: ``everywhere``) the motion is unstable.

    ``but_borders``: beyond it is, but perhaps where other conditions are equalities.  ``because``: what it is among the
    conditions of problem 6, or follows from; ``exponential``: the coordinates whose roots are to the left only with it.
    ``drifts``: with equality it is unstable only as coordinates count that are cyclic there.
    """

    everywhere: bool
    beyond: bool
    but_borders: bool
    because: Remark
    exponential: tuple[str, ...] | None
    note: str
    drifts: bool = False


def _necessary(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult:
    regions = list(forms(derived, claim))
    for region in regions:
        claim_result = trivial(region, wanted_of(region, claim), result) or one_of_problem_6(region, claim, result)
        if claim_result is not None:
            return claim_result
    verdict = derived.stability.verdict
    never = verdict.word in (Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS)
    needs = [] if never else [_need(region, claim) for region in regions]
    for condition in needs:
        if condition.everywhere:
            drifts = (said(Said.DRIFTS_WITH_EQUALITY),) if condition.drifts else ()
            return _told(result, Outcome.EXACT, condition.because, said(Said.UNSTABLE_WITHOUT), *drifts)
    tried = _refuting(derived, claim)
    example = tried.counterexample
    exponential = next((condition for condition in needs if condition.exponential is not None), None)
    for_exponential = () if exponential is None else (_for_exponential(derived, exponential),)
    # On a border with equality alone nothing is contradicted that is said of all other parameters.
    need = next((condition for condition in needs if condition.beyond), None)
    if need is not None and (example is None or (example.at_equality and example.at_border)):
        return _but_for_equality(derived, claim, result, need, example, for_exponential)
    if example is not None:
        in_first = example.word in IN_FIRST
        code = Said.NOT_NECESSARY_IN_FIRST if in_first else Said.NOT_NECESSARY
        equal = (said(Said.STABLE_WITH_EQUALITY),) if claim.relation in _STRICT and example.at_equality else ()
        return _told(result, Outcome.FAILS, said(code), *equal, *for_exponential, example=example)
    if never:
        message = with_theorem(verdict.word, verdict.theorems)
        return _told(
            result, Outcome.UNDECIDED, said(Said.NEVER_STABLE, message, verdict.word is Word.UNSTABLE_BUT_BORDERS)
        )
    if claim.relation == "!=":
        return _apart(derived, regions, claim, result, tried, for_exponential)
    partly = next((condition for condition in needs if condition.but_borders), exponential)
    if partly is not None:
        return _told(result, Outcome.BORDERS, partly.because, said(Said.UNSTABLE_INSIDE), *for_exponential)
    return _told(
        result,
        Outcome.UNDECIDED,
        said(Said.NOT_PROVED_NECESSARY),
        *for_exponential,
        _tried(tried, Said.NONE_STABLE),
    )


def _need(region: Region, claim: Claim) -> Need:
    inequality, pieces = wanted_of(region, claim), pieces_of(region, claim)
    closed = _closed(inequality)
    rows = region.without_roots(_as_printed(region, claim))
    edges = [tuple(map(_closed, row)) for row in rows]
    what, _ = _found_among(region, inequality, ("sufficient",))
    everywhere = beyond = but_borders = drifts = False
    exponential: tuple[str, ...] | None = None
    bodies_used = False
    for bodies in (False, True):
        if bodies and region.signs_of_bodies is region.signs:
            continue
        without = _unstable_without(region, rows, bodies)
        everywhere = without is Word.UNSTABLE
        but_borders = but_borders or without is Word.UNSTABLE_BUT_BORDERS
        beyond = everywhere or (
            closed is not inequality
            and _unstable_without(region, edges, bodies) is Word.UNSTABLE
            and not is_certain(region.signs_of_bodies, closed)  # else there is nothing beyond
        )
        if not everywhere and (beyond or inequality.relation == "!="):
            border = region.on_border(pieces[-1], list(map(_closed, pieces[:-1])))
            everywhere, drifts = border.counted is Word.UNSTABLE, Flaw.HERE in border.flawed
        exponential = region.exponential(inequality, bodies) if exponential is None else exponential
        bodies_used = bodies
        if everywhere or beyond or exponential is not None:
            break
    labels = region.labels(exponential or ()) if not (everywhere or beyond) else region.labels()
    note = _BODIES if bodies_used else ""
    because = what or said(Said.FOLLOWS, labels, note)
    return Need(everywhere, beyond, but_borders, because, exponential, "" if everywhere or beyond else note, drifts)


def _closed(inequality: Inequality) -> Inequality:
    return replace(inequality, relation=">=") if inequality.relation == ">" else inequality


def _unstable_without(region: Region, rows: Sequence[Sequence[Inequality]], bodies: bool) -> Word:
    """What the motion is where nothing of one of these rows holds, if it is unstable."""
    open_ones = [
        row for row in rows if len(rows) == 1 or not any(is_certain(region.signs, condition) for condition in row)
    ]
    words = [
        region.without(row[0], bodies).word
        if len(row) == 1
        else region.verdict([inequality.negated() for inequality in row], bodies).word
        for row in open_ones
    ]
    worst = (Word.UNSTABLE, Word.UNSTABLE_BUT_BORDERS)
    return max(words, key=worst.index) if all(word in worst for word in words) else Word.DEPENDS


def _for_exponential(derived: Derived, need: Need) -> Remark:
    assert need.exponential is not None
    parts = derived.stability.subsystems
    whose = "" if len(parts) == 1 else named(need.exponential)
    zeros = any(part.theory.zero_power for part in parts if part.coordinates == need.exponential)
    return said(Said.FOR_DECAY if zeros else Said.FOR_EXPONENTIAL, whose, need.note)


def _but_for_equality(
    derived: Derived,
    claim: Claim,
    result: ClaimResult,
    need: Need,
    example: Counterexample | None,
    further: tuple[Remark, ...],
) -> ClaimResult:
    """A strict condition without which, but for the case of equality, the motion is unstable."""
    if example is not None:
        also = Said.STABLE_IN_FIRST_WITH_EQUALITY if example.word in IN_FIRST else Said.STABLE_WITH_EQUALITY
        remarks = (said(Said.UNSTABLE_BEYOND), *further, said(also))
        return _told(result, Outcome.BORDERS, need.because, *remarks, example=example)
    region = Region(derived, claim, own=False)
    singular = region.makes_stiffness_singular(wanted_of(region, claim).polynomial)
    if singular and derived.balance.exactly_linear:
        return _told(result, Outcome.EXACT, need.because, said(Said.UNSTABLE_BEYOND), said(Said.GROWS_WITH_EQUALITY))
    last = said(Said.GROWTH_LEAVES_OPEN if singular else Said.EQUALITY_OPEN)
    return _told(result, Outcome.BORDERS, need.because, said(Said.UNSTABLE_BEYOND), *further, last)


def _apart(
    derived: Derived,
    regions: Sequence[Region],
    claim: Claim,
    result: ClaimResult,
    tried: Tried,
    further: tuple[Remark, ...],
) -> ClaimResult:
    """p != 0, which fails on a border only, at which no parameters are known that make the motion stable."""
    for region in regions:
        inequality = wanted_of(region, claim)
        if not region.makes_stiffness_singular(inequality.polynomial):
            continue
        what, _ = _found_among(region, inequality, ("sufficient",))
        because = () if what is None else (what,)
        if derived.balance.exactly_linear:
            return _told(result, Outcome.EXACT, *because, said(Said.GROWS_WITH_EQUALITY))
        return _told(result, Outcome.UNDECIDED, *because, *further, said(Said.GROWTH_LEAVES_OPEN))
    return _told(result, Outcome.UNDECIDED, said(Said.NOT_PROVED_NECESSARY), *further, _tried(tried, Said.NONE_STABLE))


def _tried(tried: Tried, code: Said) -> Remark:
    return said(code, tried.points) if tried.points else said(Said.NOT_TRIED)


def forms(derived: Derived, claim: Claim) -> Iterator[Region]:
    """What problem 6 requires in the description's own symbols, then in declared parameters."""
    yield Region(derived, claim, own=True)
    try:
        yield Region(derived, claim, own=False)
    except NoClosedForm:
        return


def wanted_of(region: Region, claim: Claim) -> Inequality:
    """The claimed inequality as p > 0, p >= 0 or p != 0, without roots where one inequality without does.

    Raises NoClosedForm.
    """
    pieces = pieces_of(region, claim)
    return pieces[0] if len(pieces) == 1 else _as_printed(region, claim)


def pieces_of(region: Region, claim: Claim) -> tuple[Inequality, ...]:
    """The inequalities, without roots if some were found, that hold together where the claimed one does.

    Raises NoClosedForm.
    """
    printed = _as_printed(region, claim)
    rows = region.without_roots(printed)
    return tuple(inequality for row in rows for inequality in row) if all(len(row) == 1 for row in rows) else (printed,)


def _as_printed(region: Region, claim: Claim) -> Inequality:
    derived = region.derived
    symbols = Symbols.of(derived)
    assert claim.right is not None
    lower = symbols.in_scene(derived.parameters_scene)
    left, right = (lower(symbols.opened(side)) for side in (claim.equals, claim.right))
    if claim.relation in ("<", "<="):
        left, right = right, left
    return Inequality(region.cleared(left - right), {"<": ">", "<=": ">="}.get(claim.relation, claim.relation))


def trivial(region: Region, inequality: Inequality, result: ClaimResult) -> ClaimResult | None:
    """What the declared signs, assumptions and the inertias of bodies decide by themselves."""
    for signs, what in (
        (region.signs, Message("the declared signs and assumptions")),
        (
            region.signs_of_bodies,
            Message("the declared signs and assumptions and the triangle inequalities of the inertias"),
        ),
    ):
        if is_certain(signs, inequality):
            return _told(result, Outcome.EXACT, said(Said.FOLLOWS_FROM_SIGNS, what))
        if is_certain(signs, inequality.negated()):
            return _told(result, Outcome.FAILS, said(Said.NEVER_HOLDS, what))
    return None


def one_of_problem_6(region: Region, claim: Claim, result: ClaimResult) -> ClaimResult | None:
    """The claim without a role that is a condition of problem 6, perhaps but for the case of equality."""
    if claim.role == NECESSARY:
        return None
    inequality = wanted_of(region, claim)
    what, equality = _found_among(region, inequality, ())
    if what is None:
        return None
    if not equality:
        return _told(result, Outcome.EXACT, what)
    needed = region.without(inequality).word is Word.UNSTABLE or region.on_border(inequality).counted is Word.UNSTABLE
    outcome = Outcome.EXACT if needed else Outcome.BORDERS
    label, whose, note = what.data
    assert isinstance(note, str)
    return _told(
        result, outcome, said(Said.IS, label, whose, joined((note, _BUT_EQUALITY), "") if note else _BUT_EQUALITY)
    )


def _found_among(region: Region, condition: Inequality, left_out: Sequence[str]) -> tuple[Remark | None, bool]:
    """Which condition it is, and whether it differs in the case of equality; None where it is none of them."""
    for same in (_proportional, partial(_same_condition, region.signs)):
        for what, inequality in region.conditions(left_out):
            if (condition.relation == "!=") == (inequality.relation == "!=") and same(condition, inequality):
                return what, condition.relation != inequality.relation
    return None, False


def _proportional(first: Inequality, second: Inequality) -> bool:
    ratio = rational_ratio(first.polynomial, second.polynomial)
    return ratio is not None and (first.relation == "!=" or ratio > 0)


def _same_condition(signs: Signs, first: Inequality, second: Inequality) -> bool:
    """Whether two polynomials are positive together (nonzero together) for all parameters."""
    decide = signs.nonzero_condition if first.relation == "!=" else signs.condition
    first_condition, second_condition = decide(first.polynomial), decide(second.polynomial)
    if first_condition.kind != second_condition.kind or first_condition.kind not in ("inequality", "nonzero"):
        return False
    return first_condition.polynomial == second_condition.polynomial and sorted(
        map(str, first_condition.nonzero)
    ) == sorted(map(str, second_condition.nonzero))


# --- sufficient conditions ---


def _sufficient(derived: Derived, claim: Claim, result: ClaimResult) -> ClaimResult:
    together = _of_its_place(derived, claim)
    number = len(together)

    def holds(found: Verdict, note: str) -> ClaimResult:
        return _told(result, Outcome.EXACT, said(Said.WITH_IT, number, note, with_theorem(found.word, found.theorems)))

    always = derived.stability.verdict
    if always.stable:  # nothing can refute it, and where other angles were judged nothing could be tried
        each = (trivial(region, wanted_of(region, claim), result) for region in forms(derived, claim))
        never = next(
            (candidate for candidate in each if candidate is not None and candidate.outcome == Outcome.FAILS), None
        )
        return never or _told(
            result, Outcome.EXACT, said(Said.WITH_IT, number, "", with_theorem(always.word, always.theorems))
        )
    tried = _refuting(derived, claim)
    if tried.counterexample is not None:
        return _told(result, Outcome.FAILS, said(Said.NOT_SUFFICIENT, number), example=tried.counterexample)
    open_words: tuple[Remark, ...] = ()
    for region in forms(derived, claim):
        conditions = [piece for companion in together for piece in pieces_of(region, companion)]
        known = trivial(region, wanted_of(region, claim), result)
        if known is not None and known.outcome == Outcome.FAILS:
            return known
        strict = [
            replace(condition, relation=">") if condition.relation == ">=" else condition for condition in conditions
        ]
        for bodies in (False, True):
            if bodies and region.signs_of_bodies is region.signs:
                continue
            note = _BODIES if bodies else ""
            verdict = region.verdict(conditions, bodies)
            if verdict.counted.stable:
                return holds(verdict, note)
            if verdict.word in (Word.GYROSCOPIC, Word.CRITICAL):
                open_words = (said(Said.FIRST_WITH_IT, number),)
            inner = region.verdict(strict, bodies) if strict != conditions else verdict
            if inner.counted.stable and strict != conditions:
                message = with_theorem(inner.word, inner.theorems)
                borders = _on_borders(region, conditions)
                if borders is not None:
                    return holds(weakest([inner, *borders]), note)
                inside = said(Said.WITH_IT, number, joined((*filter(None, (note, _BUT_EQUALITY)), ","), ""), message)
                return _told(result, Outcome.UNDECIDED, inside, _with_equality(derived, claim))
    by_integrals = _by_integrals(derived, claim, together)
    if by_integrals is not None:
        return holds(by_integrals, "")
    remarks = open_words or (said(Said.NOT_PROVED_SUFFICIENT, number), _tried(tried, Said.NONE_UNSTABLE))
    return _told(result, Outcome.UNDECIDED, *remarks)


def _on_borders(region: Region, conditions: Sequence[Inequality]) -> list[Verdict] | None:
    """The verdicts where one of p >= 0 is an equality and the others hold; None where one is not stable or unknown."""
    on_borders = []
    for condition in conditions:
        if condition.relation == ">=":
            on_borders.append(region.on_border(condition, [other for other in conditions if other is not condition]))
            if not on_borders[-1].counted.stable:
                return None
    return on_borders


def _with_equality(derived: Derived, claim: Claim) -> Remark:
    """What is known where both sides are equal: nothing in general, perhaps something at the given values."""
    trial = derived.trials.given
    if trial is not None and claim.right is not None:
        symbols, sides = Symbols.of(derived), [claim.equals, claim.right]
        try:
            lower = symbols.lowering(derived.trials.numbers, trial.values, symbols.occurring(sides))
            equal = lower(symbols.opened(sides[0])) == lower(symbols.opened(sides[1]))
        except (*NOT_THERE, KeyError):
            equal = False
        verdict = derived.trials.looked_into(trial) if equal else None
        if verdict is not None and not verdict.word.open:
            return said(Said.EQUAL_AT_VALUES, with_theorem(verdict.word, verdict.theorems))
    return said(Said.EQUALITY_OPEN)


def _by_integrals(derived: Derived, claim: Claim, together: Sequence[Claim]) -> Verdict | None:
    """The verdict of a combination of integrals where the conditions of one place hold."""
    from mbsym.problems.claims import by_integrals  # few claims need it

    try:
        region = Region(derived, claim, own=False)
        facts = [wanted_of(region, companion) for companion in together]
        known = region.signs.assuming((x.polynomial, x.relation) for x in facts if not x.polynomial.is_constant())
        return by_integrals.verdict_with(derived, known)
    except (ContradictionError, NoClosedForm):
        return None


def _of_its_place(derived: Derived, claim: Claim) -> list[Claim]:
    """The sufficient conditions that count together with this one."""
    if claim.role != SUFFICIENT or not claim.place:
        return [claim]
    shared = (claim.kind, claim.role, claim.place)
    return [
        companion for companion in derived.system.claims if (companion.kind, companion.role, companion.place) == shared
    ]


# --- parameters that refute ---


def _refuting(derived: Derived, claim: Claim) -> Tried:
    """Parameters at which the motion is stable without it, or (where it is to be sufficient) unstable with it."""
    together = _of_its_place(derived, claim)
    find = partial(_counterexample, derived, claim, together)
    return find() if len(together) == 1 else derived.trials.once(claim.place, find)


def _stable_words(derived: Derived) -> tuple[Word, ...]:
    """Verdicts of a motion that is stable, if only in first approximation, the weakest last.

    Where no coordinate is cyclic for all parameters, one that is at some parameters drifts away there.
    """
    parts = derived.stability.subsystems
    verdicts = chain((part.theory.verdict for part in parts), (case.verdict for x in parts for case in x.theory.cases))
    drift = any(Flaw.CYCLIC in verdict.flawed for verdict in verdicts)
    but_drift = (Word.ASYMPTOTIC_BUT_CYCLIC, Word.STABLE_BUT_CYCLIC)
    stable = (word for word in Word if word.stable and (drift or word not in but_drift))
    # Under constraints on velocities there is no other word for a stable first approximation.
    return (*stable, Word.GYROSCOPIC, *((Word.CRITICAL,) if derived.system.constraints else ()))


def _counterexample(derived: Derived, claim: Claim, together: Sequence[Claim]) -> Tried:
    """Parameters that refute these conditions, if some are found; none where the formulas are too long.

    They are also looked for on the border of the condition, and of those of problem 6.
    """
    symbols = Symbols.of(derived)
    environment = derived.parameters_scene.environment
    sufficient = claim.role == SUFFICIENT

    sides = []
    for companion in together:
        assert companion.right is not None
        about = subtract(companion.equals, companion.right)
        both = [companion.equals, companion.right]
        sides.append((about, [symbols.opened(side) for side in both], symbols.occurring(both), companion.relation))

    def claimed(numbers: Any, values: Mapping[str, Any]) -> list[Gap]:
        differences = []
        for about, (left, right), occurring, relation in sides:
            lower = symbols.lowering(numbers, values, occurring)
            differences.append((about, lower(left) - lower(right), relation))
        return differences

    verdicts = (Word.UNSTABLE,) if sufficient else _stable_words(derived)
    usual = Tried(None, 0)
    try:
        claimed(derived.ring, environment)  # its budgets end what would be too long as numbers, too
        region = Region(derived, claim, own=False)
        find = partial(derived.trials.counterexample, claimed, sufficient, verdicts, on_border=region.is_border)
        usual = find(among=derived.trials)
        if usual.counterexample is not None and not any(_weight(usual.counterexample)):
            return usual
        border = wanted_of(region, claim).polynomial
        others = (x.polynomial for _, x in region.conditions())
        among = chain.from_iterable(derived.trials.where_zero(x) for x in (border, *others))
        special = find(among=among)
    except NoClosedForm:
        return usual
    judged = usual.points + special.points
    better = special.counterexample is not None and (
        usual.counterexample is None or _weight(special.counterexample) < _weight(usual.counterexample)
    )
    return Tried(special.counterexample if better else usual.counterexample, judged)


def _weight(example: Counterexample) -> tuple[bool, bool, bool]:
    return example.at_border, example.at_equality, example.word in IN_FIRST
