"""What the stability kernel requires, as statements that every report can print."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeGuard, TypeVar, cast

from mbsym.algebra.characteristic import Polynomial, lienard_chipart, subdiscriminants
from mbsym.algebra.factors import rational_ratio
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message, joined
from mbsym.formulas.formula import Formula
from mbsym.formulas.letters import letters
from mbsym.formulas.names import parts
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.stability.problem import Stability, SubsystemStability
from mbsym.problems.stability.requirements import PART, REVERSED, Case, Place, Requirement
from mbsym.problems.stability.words import Word

#: Places of the list as a whole: the others are told with the condition.
_OF_THE_LIST = {Place.NECESSARY, Place.EXPONENTIAL, Place.SUFFICIENT}


#: A formula of so many characters that was shown before is written again, rather than its name.
AS_A_NAME = 40


def written_again(formula: Formula) -> bool:
    """Whether it is as short as its name."""
    return formula.terms < AS_A_NAME and len(formula.readable()) <= AS_A_NAME


#: The label of a coefficient whose letter is a name in the formulas, too.
TAKEN = "condition [[label]]"


@dataclass(frozen=True)
class Statement:
    """``formula`` ``relation`` 0.

    ``formula`` is None where the statement cannot hold, or is too long to be written out; ``note`` says so.  ``never``
    is the polynomial, as it arises, of a statement that cannot hold.  ``place``: what follows where it fails.
    ``in_coefficients``: the same in the coefficients of the characteristic polynomial, where ``formula`` is long.
    ``freed``: of a coefficient as it is, what is left of it without factors that are positive.
    """

    label: str
    formula: Formula | None
    relation: str
    note: str = ""
    never: Formula | None = None
    place: Place = Place.NECESSARY
    in_coefficients: InCoefficients | None = None
    freed: Formula | None = None

    @property
    def opposite(self) -> bool:
        """Whether it is told as another one reversed."""
        return _is_opposite(self.label)

    @property
    def bare(self) -> str:
        """Its label, v4 for -(v4)."""
        return _bare(self.label)

    @property
    def whole(self) -> str:
        """The label of what it is, or of what it is a part of: v4 for v4, without squares."""
        bare = self.bare
        return bare.gaps["label"] if isinstance(bare, Message) and bare.text == PART else bare

    @property
    def named(self) -> bool:
        """Whether its formula needs a label: none where it is the letter, or short and without a letter of its own."""
        if self.formula is None or is_letter(self.formula, self.bare):
            return self.formula is None
        return not (isinstance(self.bare, Message) and self.bare.text == TAKEN and written_again(self.formula))

    @property
    def remark(self) -> str:
        """What is to be said of its place where it is not that of the others."""
        return "" if self.place in _OF_THE_LIST else self.place.value


@dataclass(frozen=True)
class Labels:
    """What labels of coefficients (v4, a3) mean in the text about one subsystem: one thing, wherever they stand.

    ``letters``: those that forms in coefficients hold, so that they name the coefficients as they are, with their
    factors of known sign.  ``taken``: those that are names in the formulas, too; they are told as words.
    """

    letters: frozenset[str] = frozenset()
    taken: frozenset[str] = frozenset()

    def __call__(self, label: str) -> str:
        """The label as it is told: ``condition v4`` where a parameter is called v4."""
        bare = _bare(label)
        if bare.partition(" ")[0] not in self.taken:
            return label
        named = Message(TAKEN, label=bare)
        return named if bare == label else Message(REVERSED, label=named)


def label_meanings(ring: Ring, requirements: Sequence[Requirement]) -> Labels:
    """The meaning of the labels where these requirements are told."""
    forms = [form for requirement in requirements if (form := in_coefficients(ring, requirement)) is not None]
    same = {x for labelled in requirements if is_letter(Formula(ring, labelled.polynomial), x := _bare(labelled.label))}
    return Labels(frozenset(name for form in forms for name in form.names), names_in(ring) - same)


def statements(
    ring: Ring, requirements: Sequence[Requirement], by_mass: bool = False, told: Labels | None = None
) -> Iterator[Statement]:
    """The requirements that are not known to hold; with ``by_mass`` also those that the kinetic energy guarantees.

    ``told``: what labels mean beside them, as ``label_meanings`` of all requirements of the subsystem finds it.
    """
    told = label_meanings(ring, requirements) if told is None else told
    for requirement in requirements:
        if not requirement.always or (by_mass and requirement.by_mass):
            yield from _stated(ring, requirement, told)


def _stated(ring: Ring, requirement: Requirement, labels: Labels) -> Iterator[Statement]:
    condition, label, place = requirement.condition, labels(requirement.label), requirement.place
    note = "holds: the kinetic energy is positive definite" if requirement.by_mass else ""
    if _bare(label) in labels.letters and condition.kind in ("inequality", "nonzero", "always"):
        relation = "!=" if condition.kind == "nonzero" else requirement.relation
        at = requirement.strict if condition.kind == "nonzero" else place
        split = condition.kind != "inequality" or condition.nonzero
        freed = None if split else Formula(ring, condition.polynomial)
        yield Statement(label, Formula(ring, requirement.polynomial), relation, note, None, at, freed=freed)
        return
    # g f^2 > 0 is g > 0 and f != 0: two polynomials, which must not have one name.
    several = condition.kind == "inequality" or len(condition.nonzero) > 1
    if condition.kind == "inequality":
        form = in_coefficients(ring, requirement)
        formula = Formula(ring, condition.polynomial)
        own = _part(label, Message("without squares")) if condition.nonzero else label
        yield Statement(own, formula, requirement.relation, note, None, place, form)
    elif condition.kind == "unwritten":
        yield Statement(label, None, requirement.relation, "too long to be written out", None, place)
    elif condition.kind == "never":
        never = Formula(ring, requirement.polynomial)
        yield Statement(label, None, requirement.relation, "never holds", never, place)
    for number, polynomial in enumerate(condition.nonzero, 1):
        which = Message("squared factor")
        if len(condition.nonzero) > 1:
            which = Message("squared factor [[number]]", number=number)
        own = _part(_bare(label), which) if several else label
        yield Statement(own, Formula(ring, polynomial), "!=", note, None, requirement.strict)


def _is_opposite(label: str) -> TypeGuard[Message]:
    """Whether it is the label of a condition reversed, as ``requirements.against`` makes it."""
    return isinstance(label, Message) and label.text == REVERSED


def _bare(label: str) -> str:
    """v4 for -(v4)."""
    return label.gaps["label"] if _is_opposite(label) else label


def _part(label: str, which: Message) -> Message:
    """v4, squared factor; -(v4, without squares)."""
    bare = _bare(label)
    part = Message(PART, label=bare, part=which)
    return part if bare == label else Message(REVERSED, label=part)


def _alternative(ring: Ring, requirement: Requirement, labels: Labels) -> Statement:
    """One requirement as one statement: p > 0 and f != 0 together are p f^2 > 0, several f != 0 are their product."""
    condition = requirement.condition
    if condition.kind not in ("inequality", "nonzero") or _bare(requirement.label) in labels.letters:
        return next(_stated(ring, requirement, labels))
    whole, power = condition.polynomial, 2 if condition.kind == "inequality" else 1
    for polynomial in condition.nonzero:
        whole = whole * polynomial**power
    relation = requirement.relation if condition.kind == "inequality" else "!="
    return Statement(labels(requirement.label), Formula(ring, whole), relation)


@dataclass(frozen=True)
class CaseStatement:
    """If ``all_of`` and one of ``any_of`` hold: the verdict.  Requirements that always hold are left out.

    ``otherwise``: nothing is required, but that the cases before do not apply.
    """

    all_of: tuple[Statement, ...]
    any_of: tuple[Statement, ...]
    word: Word
    theorems: tuple[str, ...]
    explanation: str
    otherwise: bool = False

    @property
    def if_(self) -> str:
        """The words in front of ``all_of``, or of ``any_of`` alone."""
        if len(self.all_of or self.any_of) == 1:
            return Message("if")
        return Message("if all of these hold" if self.all_of else "if at least one of these holds")

    @property
    def and_(self) -> str:
        """The words between both."""
        return Message("and at least one of these holds" if len(self.any_of) > 1 else "and")

    @property
    def conditional(self) -> bool:
        """Whether it is told: one that always applies is the verdict."""
        return bool(self.all_of or self.any_of or self.otherwise)


def told_cases(part: SubsystemStability) -> list[CaseStatement]:
    """The cases of a subsystem by which its verdict is told: none where its word says all."""
    word, known = part.theory.verdict.word, [case for case in cases(part) if case.conditional]
    if word.asymptotic or word is Word.UNSTABLE or all(case.word is word is Word.UNDECIDED for case in known):
        return []
    if word is Word.UNSTABLE_BUT_BORDERS and any(case.word is not Word.UNSTABLE for case in known):
        return []  # the conditions of the others hold nowhere inside
    return known


def cases(part: SubsystemStability) -> list[CaseStatement]:
    """The cases that can occur, what an earlier one says left out of each.

    Where parameters are known at which none of them holds, that these are undecided is the last.
    """
    ring, candidates = part.ring, part.theory.cases
    labels = label_meanings(ring, part.theory.requirements)
    certain = next((k for k, case in enumerate(candidates) if case.always), len(candidates))
    possible = (
        CaseStatement(
            *_required(ring, case, labels),
            case.verdict.word,
            case.verdict.theorems,
            case.verdict.explanation,
            case.always and any(not other.never for other in candidates[:k]),
        )
        for k, case in enumerate(candidates[: certain + 1])
        if not case.never
    )
    listed = list(_without_repeats(possible))
    if part.theory.uncovered and listed:
        nothing = Message("None of the theorems that were tried decides there.")
        listed.append(CaseStatement((), (), Word.UNDECIDED, (), nothing, otherwise=True))
    return listed


def _required(ring: Ring, case: Case, labels: Labels) -> tuple[tuple[Statement, ...], tuple[Statement, ...]]:
    """What all of has to hold, and what one of; the only alternative that can hold is told in its parts."""
    every, some = case.all_of, [r for r in case.any_of if not r.never]
    some = [r for r in some if not any(_suffices(other, r) for other in some)]
    if any(r.always for r in some):
        some = []
    elif len(some) == 1 and some[0].condition.kind == "inequality" and some[0].condition.nonzero:
        every, some = (*every, *some), []
    return tuple(statements(ring, every, told=labels)), tuple(_alternative(ring, r, labels) for r in some)


def _suffices(wide: Requirement, narrow: Requirement) -> bool:
    """Whether p f^2 > 0 is ``narrow`` where p > 0 alone is ``wide``, which is therefore met wherever that is."""
    condition, other = wide.condition, narrow.condition
    if not condition.kind == other.kind == "inequality" or wide.relation != narrow.relation:
        return False
    ratio = rational_ratio(condition.polynomial, other.polynomial)
    more = len(condition.nonzero) < len(other.nonzero) and all(factor in other.nonzero for factor in condition.nonzero)
    return more and ratio is not None and ratio > 0


def _without_repeats(possible: Iterable[CaseStatement]) -> Iterator[CaseStatement]:
    """Cases read in order: without those, and those alternatives, that cannot hold where no earlier case does."""
    before: list[tuple[list[Statement], list[Statement]]] = []
    sufficed: list[Statement] = []
    for case in possible:
        every, some = _once(case.all_of), _once(case.any_of)
        some = [x for x in some if x.relation == "!=" or not any(_says(y, x, "!=") for y in some)]
        if any(_says(x, y) for x in some for y in every):  # one of them holds, then
            some = []
        strict = [x for x in (*every, *(some if len(some) == 1 else ())) if x.relation in ("<", ">")]
        every = [x for x in every if not any(_follows(x, other) for other in strict)]
        open_ = [x for x in some if not any(_says(x, other) for other in sufficed)]
        again = any(_alike(every, a) and _alike(open_, b) for a, b in before) and bool(every or some)
        if again or (some and not open_) or any(_says(x, other) for x in every for other in sufficed):
            continue
        yield replace(case, all_of=tuple(every), any_of=tuple(open_))
        before.append((every, open_))
        if len(every) + len(open_) == 1 or not every:  # where one of these holds, this case or one before applies
            sufficed += [*every, *open_]


def _once(items: Iterable[Statement]) -> list[Statement]:
    distinct: list[Statement] = []
    for item in items:
        distinct += [] if any(_says(item, other) for other in distinct) else [item]
    return distinct


def _alike(some: Sequence[Statement], others: Sequence[Statement]) -> bool:
    """Whether they are the same, in any order."""
    return len(some) == len(others) and all(any(_says(x, y) for y in others) for x in some)


def _says(statement: Statement, other: Statement, relation: str = "") -> bool:
    """Whether it is the other one; with ``relation``: whether it is that between the other's polynomial and 0."""
    one, two = (x.freed or x.formula for x in (statement, other))
    if one is None or two is None:
        return False
    ratio = rational_ratio(one.polynomial, two.polynomial)
    if ratio is None or relation:
        return ratio is not None and statement.relation == relation
    return statement.relation == (other.relation if ratio > 0 else OPPOSITE.get(other.relation, other.relation))


def _follows(statement: Statement, other: Statement) -> bool:
    """Whether it says only that something is not 0 of which the other has a multiple on one side of 0."""
    if statement.relation != "!=" or statement.formula is None or other.formula is None:
        return False
    return bool(divmod(other.formula.polynomial, statement.formula.polynomial)[1].is_zero())


@dataclass(frozen=True)
class Reference:
    """The statement ``label``: the polynomial that was shown as ``under``, ``formula``, stands in ``relation`` to 0."""

    label: str
    under: str
    relation: str
    formula: Formula


OPPOSITE = {">": "<", "<": ">", ">=": "<=", "<=": ">="}

Stood = TypeVar("Stood")


def as_stood(item: Statement, seen: list[tuple[Formula, Stood]]) -> tuple[Stood, str]:
    """p > 0; where -p or a multiple stood before, by that: p < 0, v0 < 0; so, too, where all signs of p are minus.

    ``seen``: polynomials that stood before, and as what; p is added.
    """
    assert item.formula is not None
    formula, freed, reversed_ = item.formula, item.freed or item.formula, OPPOSITE.get(item.relation, item.relation)
    for previous, told in seen:
        ratio = rational_ratio(freed.polynomial, previous.polynomial)
        if ratio is not None:
            return told, item.relation if ratio > 0 else reversed_
    minus = all(coefficient < 0 for coefficient in formula.polynomial.coeffs())
    if minus:
        formula, freed = -formula, -freed
    stood = cast("Stood", formula)
    seen.append((freed, stood))
    return stood, reversed_ if minus else item.relation


def stood_by_name(item: Statement, name: Stood, seen: list[tuple[Formula, Stood]]) -> tuple[Stood, str]:
    """The same of a condition that is told by its name, that of the one that it is reversed, if it is."""
    assert item.formula is not None
    freed = item.freed or item.formula
    seen.append((-freed if item.opposite else freed, name))
    return name, OPPOSITE.get(item.relation, item.relation) if item.opposite else item.relation


class Shown:
    """Which polynomials a text has shown, and as what, so that it need not show them again (nor their opposites)."""

    def __init__(self) -> None:
        self._shown: list[tuple[str, Formula]] = []

    def show(self, statement: Statement) -> None:
        if statement.formula is not None and self.reference(statement) is None:
            self._shown.append((statement.label, statement.formula))

    def unshown(self, form: InCoefficients) -> tuple[tuple[Formula, Formula], ...]:
        """The letters of a form that do not stand for what was shown under their names."""
        return tuple(
            (letter, value)
            for letter, value in form.letters
            if not any(label == str(letter) and shown.polynomial == value.polynomial for label, shown in self._shown)
        )

    def reference(self, statement: Statement) -> Reference | None:
        """How to refer to what was shown; None if it was not."""
        if statement.formula is None:
            return None
        label, polynomial, relation = statement.label, statement.formula.polynomial, statement.relation
        if _is_opposite(label):
            label, polynomial, relation = _bare(label), -polynomial, OPPOSITE.get(relation, relation)
        for own in (True, False):
            for under, formula in self._shown:
                bare, formula = _bare(under), -formula if _is_opposite(under) else formula
                if (bare == label) is not own:
                    continue
                ratio = rational_ratio(polynomial, formula.polynomial)
                if ratio is not None and (ratio > 0 or not own):
                    stands = relation if ratio > 0 else OPPOSITE.get(relation, relation)
                    return Reference(label, bare, stands, formula)
        return None


#: What verdicts presume of inputs.
HELD = Message("while the inputs keep their values on the unperturbed motion")


def provided(stability: Stability, motion: Equilibrium | None, inputs: bool = False) -> str:
    """What the verdicts presume: that the motion exists, for which problem 4 has the conditions, and what inputs do.

    Where other angles were judged more may have to hold than in singular ones, which is then told itself.
    """
    own, count = () if motion is None else motion.conditions, len(stability.presumed)
    known = [x for x in stability.presumed if any(rational_ratio(x.polynomial, y.polynomial) is not None for y in own)]
    if motion is not None and len(known) < count:
        text = joined((Message("$[[left]] = 0$", left=x) for x in stability.presumed), ", ")
        if inputs:
            return joined((HELD, Message("for [[wanted]]", wanted=text)), ", ")
        return Message("provided that [[wanted]]", wanted=text)
    count = len(own) if own and count else count
    if count == 0:
        return HELD if inputs else ""
    if inputs:
        one = Message("for which its condition (problem 4) holds")
        many = Message("for which its conditions (problem 4) hold")
        return joined((HELD, one if count == 1 else many), ", ")
    return (
        "provided the condition of the motion (problem 4) holds"
        if count == 1
        else "provided the conditions of the motion (problem 4) hold"
    )


def factors(part: SubsystemStability) -> list[tuple[list[Formula], int]]:
    """The irreducible factors of a characteristic polynomial by powers of lambda, and how often each occurs.

    Their signs are those of the conditions, where a leading coefficient is positive.
    """
    even = part.theory.variable == "lambda^2"
    required = {item.label: item.polynomial for item in part.theory.requirements}
    factored = []
    for number, factor in enumerate(part.theory.factors, 1):
        powers = list(factor.coefficients)
        labels = [f"v{2 * k} of factor {number}" if even else f"a{k} of factor {number}" for k in range(len(powers))]
        if any(x and label in required and required[label] == -x for label, x in zip(labels, powers, strict=True)):
            powers = [-x for x in powers]
        if even:
            powers = [x for power in powers for x in (power, part.ring.zero)][:-1]
        factored.append(([Formula(part.ring, x) for x in powers], factor.multiplicity))
    return factored


# Long conditions in the coefficients of the characteristic polynomial: v4^2 v2^2 - 4 v2^3 v6 - ..., as papers print.
#
# A discriminant of hundreds of terms is five in its coefficients.  The form is what the stability kernel computes, done
# again over letters; the letters put back give its polynomial exactly, or no such form is shown.


#: Shorter conditions are written out.
WRITTEN_OUT = 40
#: A form with more terms than this helps nobody.
MOST_TERMS = 60


#: Letters of coefficients, the first of which that is no parameter's is taken: of even polynomials, and of others.
_STEMS = ("v", "a", "c", "h", "w", "z")


@dataclass(frozen=True)
class InCoefficients:
    """``formula`` over letters of its own (v6, v4, ... or a3, a2, ...); ``letters``: each with what it stands for."""

    formula: Formula
    letters: tuple[tuple[Formula, Formula], ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(str(letter) for letter, _ in self.letters)


def names_in(ring: Ring) -> frozenset[str]:
    """The names that formulas over the ring may hold, and those that look like them: v4 for ``v_4``, which is v_{4}."""
    names = [*ring.names(), *(wanted.wanted if (wanted := letters()) is not None else ())]
    return frozenset([*names, *map(_looks, names)])


def is_letter(formula: Formula, name: str) -> bool:
    """Whether a formula is written as that letter of the description, and nothing else."""
    return letters() is not None and str(formula) == name


def _looks(name: str) -> str:
    """The shortest name that reports write in the same way."""
    split = parts(name)
    return split.stem + "_".join(split.indices)


def in_coefficients(ring: Ring, requirement: Requirement) -> InCoefficients | None:
    """The form of a requirement that is too long to be read; None where there is none.

    The requirement is an inequality that nothing was split off from, so that form and polynomial have one sign.  The
    letters are those of the labels, v4 or a3, where no parameter is called so; of several factors v4_2, of the second.
    """
    condition, coefficients = requirement.condition, requirement.coefficients
    if condition.kind != "inequality" or condition.nonzero or len(condition.polynomial) <= WRITTEN_OUT:
        return None
    label, _, factor = requirement.label.partition(" of factor ")
    names = _letters("discriminant" in label, [Formula(ring, x) for x in coefficients], factor, names_in(ring))
    present = [(name, x) for name, x in zip(names, coefficients, strict=True) if x != 0]
    own = Ring((), (), [name for name, _ in reversed(present)], {})
    symbols = [own.generator("parameter", n) if own.has("parameter", n) else own.zero for n in names]
    value = _made(label, symbols)
    if value is None or not 2 * len(value) < len(condition.polynomial) or len(value) > MOST_TERMS:
        return None
    standing = dict(present)
    images = [standing.get(g.name, ring.zero) for g in own.generators]
    if value.compose(*images, ctx=ring.context) != requirement.polynomial:
        return None
    stand_for = [(Formula(own, own.generator("parameter", n)), Formula(ring, x)) for n, x in reversed(present)]
    return InCoefficients(Formula(own, value), tuple(stand_for))


def _letters(even: bool, row: list[Formula], factor: str, taken: frozenset[str]) -> list[str]:
    """Names of the coefficients, from low to high powers, none of which is ``taken`` for something else."""
    count = len(row)
    power, end = (2 if even else 1), f"_{factor}" if factor else ""
    stems = _STEMS if even else (*_STEMS[1:], *_STEMS[:1])
    listed = ([f"{stem}{power * k}{end}" for k in range(count)] for stem in stems)
    free = next(
        (names for names in listed if all(x not in taken or is_letter(c, x) for x, c in zip(names, row, strict=True))),
        None,
    )
    return free or [f"coefficient{power * k}{end}" for k in range(count)]


def _made(label: str, coefficients: list[Polynomial]) -> Polynomial | None:
    """What a label stands for, of a polynomial with these coefficients."""
    word, _, number = label.rpartition(" ")
    if label == "discriminant":
        return subdiscriminants(coefficients)[-1]
    if word == "subdiscriminant":
        return subdiscriminants(coefficients)[int(number) - 1]
    return dict(lienard_chipart(coefficients)).get(label) if word == "Hurwitz minor" else None
