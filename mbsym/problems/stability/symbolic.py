"""Problem 6, the kernel: stability of M q'' + (D + G) q' + (K + N) q = 0, in symbols and at exact parameter values.

M, D, K symmetric, G, N skew.  The roots of det(lambda^2 M + lambda (D + G) + K + N) decide as far as the first
approximation goes; the theorems below go further.  Nothing is claimed on a border.

* D = N = 0 (the determinant is even): roots in mu = lambda^2 real, negative and simple, by the signs of the
  coefficients and the discriminant (from degree 4 on all subdiscriminants).  **Necessary** for stability, but for the
  case of equality.  With G = 0, too, by the coefficients alone: the roots are real and semisimple anyway, and the
  discriminants are listed as what nobody needs.
* K > 0 besides: stable, by Lagrange-Dirichlet (G = 0) or Routh (G != 0), if the nonlinear system has its energy
  integral.  Without K > 0 the motion is **gyroscopically stabilised only**: any complete dissipation destroys it
  (Kelvin-Chetaev), and the nonlinear system is not decided.  det K < 0: unstable (Kelvin-Chetaev).
* D > 0, N = 0: asymptotically stable if K > 0, unstable if K is not and det K != 0 (Kelvin-Chetaev).
* Otherwise all Re lambda < 0 by Lienard-Chipart: asymptotically stable; one Re lambda > 0: unstable, both by
  Lyapunov's first method.
* A steady spin in a space without preferred directions: turned in space it is a spin again, which puts the roots
  +- i omega into the determinant, whatever the system.  With all other roots to the left it is asymptotically stable
  in every variable that does not change when everything is turned (Lyapunov-Malkin: the critical roots are those of a
  family of steady motions).
* Cyclic coordinates on which no damping acts have constant momenta: they are ignored after Routh.

M is taken to be positive definite, as a mass matrix is.  Rows may be scaled, by one positive factor per row through
all five matrices: neither the roots nor the signs of leading minors change.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial
from itertools import combinations

from mbsym.algebra.characteristic import (
    Coefficients,
    Matrix,
    Polynomial,
    characteristic_polynomial,
    determinant,
    factor_in_lambda,
    first_minors,
    is_semisimple,
    lienard_chipart,
    primitive,
    resultant,
    subdiscriminants,
)
from mbsym.algebra.factors import irreducible_factors, occurring
from mbsym.algebra.failures import Failure, NoClosedForm, TooLargeError, message_of
from mbsym.algebra.matrices import added
from mbsym.algebra.signs import MOST_TERMS, Condition, ContradictionError, Signs, conditions
from mbsym.algebra.terms import coefficients_in
from mbsym.expressions.message import Message, joined
from mbsym.problems.stability import nonholonomic
from mbsym.problems.stability.exact import PointVerdict, on_the_motion, verdict_at
from mbsym.problems.stability.linear_form import (
    CONSERVATIVE,
    LinearSystem,
    NonholonomicForm,
    dot,
    is_potential,
    is_zero,
    kind_of,
    null_rows,
)
from mbsym.problems.stability.on_border import where_zero
from mbsym.problems.stability.requirements import (
    BUT_TURNED,
    BUT_ZERO,
    EVEN_BUT_ZERO,
    OF_FACTOR,
    Case,
    Definite,
    Definiteness,
    Factor,
    Method,
    Place,
    Requirement,
    against,
    alone,
    cells_of,
    definiteness,
    differs,
    holds_always,
    uncovered,
    unwritten,
)
from mbsym.problems.stability.routh import (
    ENERGY_BESIDES,
    besides_cyclic,
    energy_besides,
    ignoring_cyclic,
    momenta_are_constant,
    only_momenta,
)
from mbsym.problems.stability.verdict import (
    Flaw,
    Verdict,
    bounded,
    coasting,
    concluded,
    depends,
    drifting,
    exactly,
    here,
    only_drifts,
    undecided,
)
from mbsym.problems.stability.words import Because, Fact, Ground, Reason, Word, applying

#: More damped coordinates have too many principal minors.
MOST_DAMPED = 4

#: Conditions with more terms are not asked whether they imply others.
MOST_COMPARED = 60


@dataclass(frozen=True)
class Theory:
    """Everything about one subsystem.

    characteristic = removed * lambda^zero_power * polynomial, ``removed`` known to be positive (both polynomials are
    empty when they were too large to be written out).  ``factors`` of ``polynomial`` are in ``variable``: lambda^2
    where only even powers occur, else lambda.
    """

    kind: str
    characteristic: Coefficients
    removed: Polynomial
    zero_power: int
    polynomial: Coefficients
    variable: str
    factors: tuple[Factor, ...]
    method: Method
    requirements: tuple[Requirement, ...]
    mass: Definiteness
    stiffness: Definiteness
    dissipation: Definiteness | None
    cases: tuple[Case, ...]
    verdict: Verdict
    remarks: tuple[str, ...] = ()
    at_point: PointVerdict | None = None
    reduced: Theory | None = None  # with cyclic coordinates ignored after Routh
    turned: bool = False  # the roots of a turned steady spin are left out of the requirements
    uncovered: bool = False  # parameters are known, and all that are near them, at which none of the cases holds

    @property
    def wanted(self) -> str:
        """What the conditions say together."""
        if self.method is Method.EVEN and self.zero_power:
            return EVEN_BUT_ZERO
        if self.method is not Method.HURWITZ or not (self.zero_power or self.turned):
            return self.method.value
        return BUT_TURNED if self.turned else BUT_ZERO

    @property
    def potential(self) -> bool:
        """Whether there are no other forces than those of K."""
        return self.kind == CONSERVATIVE

    @property
    def polynomials(self) -> Iterator[Polynomial]:
        """What its conditions and cases are about."""
        for case in self.cases:
            yield from case.polynomials
        for r in self.requirements:
            yield from r.polynomials

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """What remains of ``requirements``, each once."""
        return conditions(r.condition for r in self.requirements)


def analyse(
    system: LinearSystem, signs: Signs, point: Mapping[int, Fraction] | None = None, borders: bool = True
) -> Theory:
    """Characteristic polynomial, conditions, cases and verdict; with ``point`` also the exact verdict there.

    With ``borders`` the places of conditions say what holds with equality, where the equations are exactly linear.
    Without proof by ``signs`` the verdict is ``undecided`` and ``cases`` say what it depends on.  Formulas beyond the
    budget are left out, with a remark; then nothing is claimed in symbols.
    """
    try:
        theory = _analyse(system, signs, borders)
    except TooLargeError as error:
        theory = _left_out(system, signs, message_of(error))
    if system.exact:
        null = null_rows(added(system.K, system.N), signs.normalised) if theory.zero_power else ()
        calm = len(null) == theory.zero_power  # the zero roots have no Jordan blocks, where there are no others
        cases = tuple(
            replace(case, verdict=exactly(case.verdict, calm and _without_further_zeros(theory, signs, case)))
            for case in theory.cases
        )
        calm = calm and _without_further_zeros(theory, signs, theory.cases[0] if theory.cases else None)
        left_open = theory.verdict.because(Because.BORDER)
        verdict = undecided(Because.LINEAR_OPEN) if left_open else exactly(theory.verdict, calm)
        at_hand = verdict.word.open or verdict.because(Because.LINEAR_GROWS)
        if at_hand and not occurring(x for matrix in system.matrices for row in matrix for x in row):
            verdict = verdict_at(system, {}).verdict
        theory = replace(theory, cases=cases, verdict=verdict)
    theory = replace(
        theory,
        cases=tuple(
            replace(case, verdict=on_the_motion(system, case.verdict, theory.zero_power)) for case in theory.cases
        ),
        verdict=on_the_motion(system, theory.verdict, theory.zero_power),
    )
    return theory if point is None else replace(theory, at_point=verdict_at(system, point))


def _without_further_zeros(theory: Theory, signs: Signs, case: Case | None) -> bool:
    """Whether the lowest coefficient is known not to vanish, by the signs or by what the case requires.

    Where it vanishes more roots are zero than lambda^z tells, and they may have Jordan blocks: x'' = g y', y'' = -g x'.
    """
    if not theory.polynomial or signs.never_zero(theory.polynomial[0]):
        return True
    if case is None:
        return False
    held = [r.polynomial for r in case.all_of]  # those that the others imply, too
    if all(r.polynomial in held for r in theory.requirements if not r.always):
        return True
    try:
        known = signs.assuming((r.polynomial, r.relation) for r in case.all_of if not r.always)
        return known.never_zero(theory.polynomial[0])
    except (ContradictionError, NoClosedForm):
        return False


def _left_out(system: LinearSystem, signs: Signs, reason: str) -> Theory:
    nothing = Definiteness(Definite.OPEN, ())
    return Theory(
        kind=kind_of(system),
        characteristic=(),
        removed=signs.context.constant(1),
        zero_power=0,
        polynomial=(),
        variable="lambda",
        factors=(),
        method=Method.NONE,
        requirements=(),
        mass=nothing,
        stiffness=nothing,
        dissipation=None if is_zero(system.D) else nothing,
        cases=(),
        verdict=undecided(Because.NO_CLOSED_FORM, reason),
        remarks=(
            Message(
                "The characteristic polynomial is not written out: [[why]]; at a point the verdict is exact.",
                why=reason,
            ),
        ),
    )


def _analyse(system: LinearSystem, signs: Signs, borders: bool) -> Theory:
    written = characteristic_polynomial(system.M, added(system.D, system.G), added(system.K, system.N))
    raw = tuple(signs.normalised(c) for c in written[: len(written) - len(system.following)])
    mass = definiteness(system.kinetic, signs, "M") if system.kinetic else Definiteness(Definite.POSITIVE, ())
    # A mass matrix is positive definite, so its minors may be used to judge everything else.
    # Long ones would cost the search for combinations more than they can give.
    minors = [r.polynomial for r in mass.requirements]
    known = signs.assuming((p, ">") for p in minors if not p.is_constant() and len(p) <= MOST_TERMS)
    start = Theory(
        kind=kind_of(system),
        characteristic=raw,
        removed=raw[-1] * 0 + 1,
        zero_power=0,
        polynomial=raw,
        variable="lambda",
        factors=(),
        method=Method.NONE,
        requirements=(),
        mass=mass,
        stiffness=definiteness(system.K, known, "K"),
        dissipation=None if is_zero(system.D) else definiteness(system.D, known, "D"),
        cases=(),
        verdict=undecided(Because.ORDER_LOWER),
    )
    if raw[-1] == 0:
        return start
    zero_power = next(i for i, c in enumerate(raw) if c != 0)
    polynomial, removed = _without_known_factor(raw[zero_power:], known)
    even = all(c == 0 for c in polynomial[1::2])
    factors = _factors(polynomial[::2] if even else polynomial)
    turned = None if even else _turned_factor(system, factors)
    requirements, remarks = _requirements(system, factors, even, signs, known, turned)
    if system.exact and borders:
        requirements = tuple(_with_equality(system, r, requirements, known, even) for r in requirements)
    if mass.word is not Definite.POSITIVE:
        remarks.append("M is taken to be positive definite, as the matrix of a kinetic energy is.")
    if zero_power:
        one = "One zero root splits off; conditions name the coefficients of the rest."
        several = "[[count]] zero roots split off; conditions name the coefficients of the rest."
        remarks.append(Message(several, count=zero_power) if zero_power > 1 else Message(one))
    theory = replace(
        start,
        removed=removed,
        zero_power=zero_power,
        polynomial=polynomial,
        variable="lambda^2" if even else "lambda",
        factors=factors,
        method=Method.EVEN if even else Method.HURWITZ,
        requirements=requirements,
        remarks=tuple(remarks),
        turned=turned is not None,
    )
    if system.nonholonomic is not None:
        cases, reduced = _cases_of_roots(system, system.nonholonomic, theory, known), None
    elif zero_power:
        cases, reduced = _cases_with_zero_roots(system, theory, known)
    else:
        cases, reduced = _cases(system, theory, known), None
    if system.exact and zero_power and not any(case.verdict.word.stable for case in cases):
        linear = _cases_of_linear(system, theory, known)
        # What changes the relations of a leaf acts like a constant force: along zero roots velocities grow under it.
        if not (system.leaf and any(case.verdict.word.stable for case in linear)):
            cases = linear or cases
    cases = tuple(_without_implications(case, known) for case in cases)
    verdict, left = _first_certain(cases, known)
    return replace(theory, cases=cases, reduced=reduced, verdict=verdict, uncovered=left)


def on_border(
    system: LinearSystem, signs: Signs, p: Polynomial, further: Sequence[tuple[Polynomial, str]] = ()
) -> Verdict | None:
    """The verdict at all parameters at which p vanishes and ``further`` holds; None where none is known."""
    return where_zero(system, signs, p, _with_blocks, further)


def _with_blocks(system: LinearSystem, known: Signs, further: bool = True) -> Verdict:
    """The verdict at all parameters, by Jordan blocks of imaginary roots, too, where the equations are exactly linear.

    ``further``: where blocks may be missing is looked at, too.
    """
    theory = analyse(system, known, borders=False)
    even = system.exact and theory.variable == "lambda^2" and theory.verdict.word is not Word.UNSTABLE
    if even and any(_has_blocks(system, factor, known, further) for factor in theory.factors):
        return concluded({Fact.EXACTLY_LINEAR, Fact.JORDAN_BLOCK})
    if system.exact and theory.verdict.word.open and _one_pair_beside_decay(theory, known):
        return bounded({Fact.EXACTLY_LINEAR})
    return theory.verdict


def _one_pair_beside_decay(theory: Theory, known: Signs) -> bool:
    """Whether at all parameters one simple pair of roots is imaginary, all others to the left."""
    if theory.zero_power or theory.method is not Method.HURWITZ or theory.mass.word is not Definite.POSITIVE:
        return False
    pairs = 0
    for factor in theory.factors:
        p = factor.coefficients
        if len(p) == 3 and p[1] == 0:
            pairs += factor.multiplicity
            wanted = [p[0] * p[2]]
        else:
            word = known.sign(p[-1])
            p = tuple(-x for x in p) if word == "negative" else p
            try:
                wanted = [p[-1], *(x for _, x in lienard_chipart(p)[1:])]
            except TooLargeError:
                return False
        if any(known.sign(x) != "positive" for x in wanted):
            return False
    return pairs == 1


def _has_blocks(system: LinearSystem, factor: Factor, known: Signs, further: bool) -> bool:
    """Whether at all parameters a factor in lambda^2 that occurs several times has Jordan blocks, or all is unstable.

    Its roots are imaginary then, and multiple without being semisimple, or one of them lies to the right.
    """
    if factor.multiplicity == 1 or system.size == 1 or len(factor.coefficients) < 2:
        return False
    in_lambda = tuple(c for v in factor.coefficients for c in (v, v * 0))[:-1]
    try:
        for minor in first_minors(system.M, added(system.D, system.G), added(system.K, system.N)):
            without = minor[0] if len(minor) == 1 else resultant(minor, in_lambda)
            if known.never_zero(without):
                return True
            if further:
                there = where_zero(system, known, without, partial(_with_blocks, further=False))
                if there is not None and there.word is Word.UNSTABLE:
                    return True
    except (Failure, ContradictionError):
        pass
    return False


def _with_equality(
    system: LinearSystem, requirement: Requirement, every: Sequence[Requirement], known: Signs, even: bool
) -> Requirement:
    """The requirement with the places that the verdicts on its borders give it; ``even``: none decays anywhere."""
    condition = requirement.condition
    if condition.kind not in ("inequality", "nonzero") or Place.HARMLESS in (requirement.place, requirement.strict):
        return requirement
    others = [fact for r in every if r is not requirement and not r.always for fact in _facts_of(r)]
    apart = tuple(x for x in condition.nonzero)
    places = []
    for polynomials in ((condition.polynomial,) if condition.kind == "inequality" else (), apart):
        candidates: set[Place | None] = set()
        for x in polynomials:
            beside = [*others, *((y, "!=") for y in apart if y is not x)]
            candidates.add(_place_of_equality(system, x, known, beside, even))
        places.append(candidates.pop() if len(candidates) == 1 else None)
    return replace(requirement, place=places[0] or requirement.place, strict=places[1] or requirement.strict)


def _facts_of(r: Requirement) -> Iterator[tuple[Polynomial, str]]:
    if r.condition.kind == "inequality":
        yield r.condition.polynomial, r.relation
    for x in r.condition.nonzero:
        yield x, "!="


def _place_of_equality(
    system: LinearSystem, p: Polynomial, known: Signs, beside: Sequence[tuple[Polynomial, str]], even: bool
) -> Place | None:
    verdict = on_border(system, known, p)
    if verdict is not None and verdict.word is Word.UNSTABLE:
        return Place.STRICTLY
    if verdict is None or not verdict.stable:
        verdict = on_border(system, known, p, [x for x in beside if len(x[0]) <= MOST_TERMS])
    if verdict is None:
        return None
    if verdict.word is Word.UNSTABLE:
        return Place.BESIDE
    if not verdict.stable:
        return None
    if Flaw.HERE in verdict.flawed:
        return Place.DRIFTS
    if Flaw.CYCLIC in verdict.flawed and verdict.counted is not Word.STABLE:
        return None
    return Place.EQUALITY if even or verdict.word is Word.ASYMPTOTIC else Place.MERELY


def _turned_factor(system: LinearSystem, factors: tuple[Factor, ...]) -> int | None:
    """The position of the simple factor that a turned steady spin explains."""
    if not system.turned or system.turned[1] == 0:
        return None
    top, bottom = system.turned
    for i, factor in enumerate(factors):
        p = factor.coefficients
        if len(p) == 3 and p[1] == 0 and p[0] * top == p[2] * bottom and factor.multiplicity == 1:
            return i
    return None


def _requirements(
    system: LinearSystem, factors: tuple[Factor, ...], even: bool, signs: Signs, known: Signs, turned: int | None
) -> tuple[tuple[Requirement, ...], list[str]]:
    """The conditions on the factors of the characteristic polynomial, and remarks on what they leave open.

    Nothing is required of the factor number ``turned``.
    """
    requirements: list[Requirement] = []
    remarks: list[str] = []
    for index, factor in enumerate(factors, start=1):
        several = len(factors) > 1
        if index - 1 == turned:
            remarks.append(
                Message("Factor [[number]] belongs to the steady spins about other directions of space.", number=index)
            )
            continue
        p = factor.coefficients
        lead, word = p[-1], known.sign(p[-1])
        if word == "negative":
            p = tuple(-c for c in p)
        alone = len(factors) == 1 and factor.multiplicity == 1
        if alone:
            # det M > 0 is the leading coefficient, up to a positive factor.
            requirements.append(Requirement(_power_name(even, len(p) - 1), p[-1], signs.condition(p[-1]), by_mass=True))
        elif word not in ("positive", "negative"):
            p = tuple(lead * c for c in p)
        try:
            wanted = _even_wanted(p) if even else lienard_chipart(p)[1:]
        except TooLargeError as error:
            remarks.append(
                Message(
                    "The conditions of factor [[number]] are not written out ([[why]]); at a point they are exact.",
                    number=index,
                    why=error.reason,
                )
                if several
                else Message(
                    "The conditions are not written out ([[why]]); at a point they are exact.", why=error.reason
                )
            )
            requirements.append(unwritten(p[0]))
            continue
        reduced = [
            _required(known, label, index if several else 0, value, p, _places(system, label, even))
            for label, value in wanted
        ]
        left_out = joined((requirement.label for requirement in reduced if requirement.unwritten), ", ")
        if left_out:
            remarks.append(
                Message(
                    "Not written out, but in the coefficients, because of their length: [[labels]].", labels=left_out
                )
            )
        requirements += reduced if even else _without_implied(_spared(reduced, len(p) - 1), known)
    if even and not is_potential(system):
        requirements += _simple(system, factors, known, remarks)
    elif even and sum(len(f.coefficients) - 1 for f in factors) > 1:
        remarks.append(
            Message(
                "In a conservative system without gyroscopic forces the squares of the roots are real and semisimple: "
                "$K > 0$ is necessary and sufficient for the stability of the first approximation, a vanishing "
                "discriminant (equal frequencies) does no harm."
            )
        )
    return tuple(_without_following(requirements, signs)), remarks


def _without_following(requirements: Sequence[Requirement], signs: Signs) -> Iterator[Requirement]:
    """p > 0 goes without saying where another q > 0 is wanted and q >= 0 shows it: p < 0 is nowhere but where q < 0."""

    def follows(q: Requirement, r: Requirement) -> bool:
        return _following((q.condition.polynomial, ">="), r.condition.polynomial, signs) == "positive"

    standing = [r for r in requirements if _in_short(r)]
    for r in requirements:
        by = next((q for q in standing if q is not r and _in_short(r) and follows(q, r)), None)
        if by is not None:
            standing = [q for q in standing if q is not r]
            r = replace(r, condition=Condition("always", r.condition.polynomial * 0 + 1))
        yield r


def _in_short(r: Requirement) -> bool:
    kind, terms = r.condition.kind, len(r.condition.polynomial)
    return kind == "inequality" and not r.condition.nonzero and r.place is not Place.HARMLESS and terms <= MOST_TERMS


def _is_symmetric(system: LinearSystem) -> bool:
    """Whether it is a pencil of two symmetric matrices, one of them positive definite.

    Its roots in lambda^2 are real and semisimple: no discriminant is negative, and none that vanishes does any harm.
    """
    return is_potential(system) and system.nonholonomic is None


def _places(system: LinearSystem, label: str, even: bool) -> tuple[Place, Place]:
    """What p > 0 is needed for, and what p != 0.

    Where M x'' + (K + N) x = 0, x = x0 + x1 t solves it where (K + N) x0 = (K + N) x1 = 0, which is so with x1 != 0
    where a coefficient vanishes while no root in lambda^2 is positive: then the last of them vanishes, too.  With other
    forces a zero root may be semisimple, as roots that coincide may be whatever the forces are.
    """
    if not even:
        return Place.EXPONENTIAL, Place.EXPONENTIAL
    if _is_symmetric(system) and not label.startswith("v"):
        return Place.HARMLESS, Place.HARMLESS
    grows = is_zero(system.D) and is_zero(system.G) and system.nonholonomic is None
    return Place.NECESSARY, Place.FIRST if grows and label.startswith("v") else Place.METHOD


def _required(
    known: Signs, label: str, factor: int, value: Polynomial, p: Coefficients, places: tuple[Place, Place]
) -> Requirement:
    """One condition on the coefficients p of a factor, 0 if it is the only one.

    One that outgrows the budget stays what it is made of.
    """
    place, strict = places
    made = p if " " in label or label == "discriminant" else ()
    label = Message(OF_FACTOR, label=label, number=factor) if factor else label
    try:
        return Requirement(label, value, known.condition(value), place=place, strict=strict, coefficients=made)
    except NoClosedForm:
        return replace(unwritten(p[0]), label=label, place=place, strict=strict, coefficients=made)


def _spared(requirements: list[Requirement], degree: int) -> list[Requirement]:
    """Lienard-Chipart needs, besides a_0 and the minors, only every second coefficient: the simpler half is kept.

    ``wanted`` begins with a_(n-1), ..., a_0; for even n the first of them is the minor Delta_1 and stays.
    """
    if degree < 3 or any(r.never for r in requirements):
        return requirements
    first = 1 if degree % 2 == 0 else 0
    numbered = list(zip(range(degree - 1 - first, 0, -1), requirements[first:], strict=False))
    halves = [[r for k, r in numbered if k % 2 == odd] for odd in (0, 1)]
    weight = [sum(len(r.condition.polynomial) for r in half if not r.always) for half in halves]
    left_out = halves[0] if weight[0] > weight[1] else halves[1]
    return [r for r in requirements if not any(r is other for other in left_out)]


def _without_implied(wanted_requirements: list[Requirement], known: Signs) -> list[Requirement]:
    """f != 0 goes without saying where a product with f has to be positive, or where the other g != 0 show it."""
    strict = [f for r in wanted_requirements for f in r.condition.factors]
    apart = known.apart(
        [f for r in wanted_requirements for f in r.condition.nonzero if not any(f in (g, -g) for g in strict)]
    )
    requirements = []
    for r in wanted_requirements:
        requirements.append(_apart(r, [f for f in r.condition.nonzero if f in apart]))
    return requirements


def _apart(r: Requirement, left: Sequence[Polynomial]) -> Requirement:
    """The same requirement, its side conditions only those that are left."""
    if r.condition.kind == "nonzero" and not left:
        return replace(r, condition=Condition("always", r.condition.polynomial))
    return r if tuple(left) == r.condition.nonzero else replace(r, condition=replace(r.condition, nonzero=tuple(left)))


def _without_implications(case: Case, known: Signs) -> Case:
    """Without p > 0 or f != 0 that another one of ``all_of`` implies, and without alternatives that imply another one.

    An alternative needs no f != 0 where another one holds on f = 0.
    """
    every, some = list(case.all_of), list(case.any_of)
    for k, r in enumerate(every):
        if any(_implies(other, r, known) for other in (*every[:k], *every[k + 1 :])):
            every[k] = replace(r, condition=Condition("always", r.condition.polynomial))
    positive = [r.condition.polynomial for r in every if _is_inequality(r)]
    every = [_without_sides(r, positive, ("negative", "nonpositive", "zero"), known) for r in every]
    enough = [r.condition.polynomial for r in some if _is_inequality(r) and not r.condition.nonzero]
    some = [_without_sides(r, enough, ("positive",), known) for r in some]
    for k, r in enumerate(some):
        if any(_implies(r, other, known) for other in (*some[:k], *some[k + 1 :])):
            some[k] = replace(r, condition=Condition("never", r.condition.polynomial))
    return replace(case, all_of=tuple(every), any_of=tuple(some))


def _is_inequality(r: Requirement) -> bool:
    return r.condition.kind == "inequality" and r.relation == ">"


def _without_sides(r: Requirement, others: Sequence[Polynomial], words: Sequence[str], known: Signs) -> Requirement:
    """Without f != 0, f a single letter, where one of the others has on f = 0 one of the signs."""

    def told(f: Polynomial) -> bool:
        if len(f) != 1 or f.total_degree() != 1:
            return False
        return any(known.sign(coefficients_in(p, occurring([f])[0])[0]) in words for p in others)

    return _apart(r, [f for f in r.condition.nonzero if not told(f)])


def _implies(one: Requirement, other: Requirement, known: Signs) -> bool:
    """Whether p > 0 implies r > 0: p = q r + s with q > 0, s <= 0, q the ratio of their slopes; or found by search."""
    p, r = one.condition, other.condition
    if not (_is_inequality(one) and _is_inequality(other)) or r.nonzero:
        return False
    if max(len(p.polynomial), len(r.polynomial)) > MOST_COMPARED:
        return False
    for variable in occurring([r.polynomial]):
        slope = r.polynomial.derivative(variable)
        if not slope.is_constant():
            continue
        quotient = p.polynomial.derivative(variable) / slope.coeffs()[0]
        rest = p.polynomial - quotient * r.polynomial
        if known.sign(quotient) == "positive" and known.sign(rest) in ("negative", "nonpositive", "zero"):
            return True
    return _following((p.polynomial, ">"), r.polynomial, known) == "positive"


def _following(fact: tuple[Polynomial, str], p: Polynomial, known: Signs) -> str:
    """The sign of p where the fact holds, too; "unknown" where nothing is proved."""
    try:
        return known.assuming([fact]).sign(p)
    except (ContradictionError, NoClosedForm):
        return "unknown"


def _power_name(even: bool, i: int) -> str:
    return f"v{2 * i}" if even else f"a{i}"


def _even_wanted(p: Coefficients) -> list[tuple[str, Polynomial]]:
    n = len(p) - 1
    wanted = [(f"v{2 * i}", p[i]) for i in range(n - 1, -1, -1)]
    if n >= 2:
        table = subdiscriminants(p)
        # Up to degree 3 the discriminant alone makes the roots real.
        first = 2 if n >= 4 else n
        wanted += [
            (Message("subdiscriminant [[k]]", k=k) if k < n else Message("discriminant"), table[k - 1])
            for k in range(first, n + 1)
        ]
    return wanted


def _simple(system: LinearSystem, factors: tuple[Factor, ...], known: Signs, remarks: list[str]) -> list[Requirement]:
    """No common roots of different factors; a factor that occurs several times must be semisimple."""
    requirements = []
    for i, left in enumerate(factors):
        try:
            for j in range(i + 1, len(factors)):
                value = resultant(left.coefficients, factors[j].coefficients)
                requirements.append(
                    differs(
                        Message("resultant of factors [[number]] and [[other]]", number=i + 1, other=j + 1),
                        value,
                        known,
                    )
                )
            if left.multiplicity > 1:
                simple = _is_semisimple(system, left)
                if not simple:
                    never = left.coefficients[0] * 0
                    blocks = differs(Message("multiplicity of factor [[number]]", number=i + 1), never, known)
                    requirements.append(replace(blocks, place=Place.FIRST, strict=Place.FIRST))
                how = (
                    Message("simple elementary divisors")
                    if simple
                    else Message("Jordan blocks: its roots are never semisimple")
                )
                remarks.append(
                    Message(
                        "Factor [[number]] occurs [[multiplicity]] times, with [[how]].",
                        number=i + 1,
                        multiplicity=left.multiplicity,
                        how=how,
                    )
                )
        except TooLargeError as error:
            requirements.append(unwritten(left.coefficients[0]))
            remarks.append(
                Message(
                    "Whether roots of factor [[number]] coincide with others is left open: [[why]].",
                    number=i + 1,
                    why=error.reason,
                )
            )
    return requirements


def _is_semisimple(system: LinearSystem, factor: Factor) -> bool:
    in_lambda = tuple(c for v in factor.coefficients for c in (v, v * 0))[:-1]
    c, k = added(system.D, system.G), added(system.K, system.N)
    return is_semisimple(system.M, c, k, in_lambda, factor.multiplicity)


def _cases(system: LinearSystem, theory: Theory, known: Signs) -> tuple[Case, ...]:
    stiff, requirements, facts = theory.stiffness.requirements, theory.requirements, system.facts
    unstable = _unstable(requirements, known)
    if not is_zero(system.N) or theory.dissipation is not None:
        if theory.variable == "lambda^2":
            why = Reason(Because.IMAGINARY_SIMPLE), Reason(Because.HIGHER_ORDER)
            return Case(requirements, (), bounded(facts & {Fact.EXACTLY_LINEAR}, *why)), *unstable
        if theory.dissipation is None:
            odd = tuple(differs(f"a{i}", c, known) for i, c in enumerate(theory.polynomial) if i % 2 and c != 0)
            return (Case((), odd, concluded({Fact.ROOT_RIGHT}, Reason(Because.RIGHT_BY_TRACE))),)
        if not is_zero(system.N) or theory.dissipation.word is not Definite.POSITIVE:
            held = _semidefinite(system, known) if is_zero(system.N) and not theory.turned else facts
            minimum = held | {Fact.STIFFNESS_POSITIVE}
            if Ground.ENERGY in applying(minimum):
                # With D >= 0 and N = 0 roots are all to the left only where K > 0 (Kelvin-Chetaev).
                decaying = concluded(minimum | {Fact.ROOTS_LEFT})
                return Case(requirements, (), decaying), Case(stiff, (), concluded(minimum)), *unstable
            return Case(requirements, (), _all_left(theory.turned)), *unstable
    negative = against(stiff, known)
    minimum = facts | {Fact.STIFFNESS_POSITIVE}
    if theory.dissipation is not None:
        nonsingular = differs("det K", stiff[-1].polynomial, known)
        complete = facts | {Fact.DAMPING_POSITIVE}
        destroyed = complete | {Fact.STIFFNESS_NEGATIVE_SOMEWHERE, Fact.STIFFNESS_NONSINGULAR}
        return (Case(stiff, (), concluded(complete | minimum)), Case((nonsingular,), negative, concluded(destroyed)))
    if is_potential(system):
        growing = concluded({Fact.ROOT_RIGHT}, Reason(Because.REAL_ROOT))
        return Case(stiff, (), _conservative(minimum)), Case((), negative, growing)
    odd_degree = concluded(facts | {Fact.STIFFNESS_ODD}, Reason(Because.ODD_DEGREE_REMAINS))
    return (
        Case(stiff, (), _conservative(minimum)),
        Case(requirements, (), bounded(facts - {Fact.STIFFNESS_POSITIVE}, Reason(Because.GYROSCOPIC_ONLY))),
        Case((), negative[-1:], odd_degree),
        *unstable,
    )


def _cases_of_roots(system: LinearSystem, form: NonholonomicForm, theory: Theory, known: Signs) -> tuple[Case, ...]:
    """Of a nonholonomic system: by the roots alone."""
    unstable, zeros = _unstable(theory.requirements, known), form.zeros(theory.zero_power)
    even = theory.variable == "lambda^2" or not theory.factors
    if even and form.pairs == sum(len(f.coefficients) - 1 for f in theory.factors):
        return Case(_wanted(theory), (), nonholonomic.one_oscillates(form)), *unstable
    if theory.variable == "lambda^2" and theory.factors:
        best = undecided(Because.MORE_ZERO_ROOTS, zeros, form.family)
        if zeros in (0, form.family):  # the family's are in the kernel: no blocks
            best = bounded(system.facts & {Fact.EXACTLY_LINEAR}, *nonholonomic.OPEN)
        return Case(theory.requirements, (), best), *unstable
    return Case(_wanted(theory), (), nonholonomic.all_left(form, zeros)), *unstable


def _cases_of_linear(system: LinearSystem, theory: Theory, known: Signs) -> tuple[Case, ...]:
    """Of exactly linear equations with lambda^z for a factor: by the r null directions of K + N.

    These make r zero roots without Jordan blocks.  Where z = r there are no others, and the zero roots do no harm; else
    there are blocks wherever K + N has no further null directions.  Where everything may be shifted along the null
    directions V at constant velocity, (D + G) V = 0, z = 2 r, they are drifts, and nothing but drifts.
    """
    unstable = _unstable(theory.requirements, known)
    places, rates = added(system.K, system.N), added(system.D, system.G)
    null = null_rows(places, known.normalised)
    if not null:
        return ()
    drifts = system.shifts or (system.free and _no_gyroscopic(system, null, known))
    requirements = _wanted(theory)
    decays = theory.variable == "lambda" and bool(theory.factors)
    calm = bounded({Fact.EXACTLY_LINEAR})
    if theory.zero_power == len(null):
        if decays and drifts:
            calm = drifting(_all_left(False), constant_momenta=False)
        return Case(requirements, (), calm), *unstable
    still = all(known.normalised(dot(row, v)) == 0 for row in rates for v in null)
    if drifts and still and theory.zero_power == 2 * len(null):
        calm = drifting(_all_left(False) if decays else calm) if theory.factors else coasting()
        calm = here(calm) if len(null) > len(system.shifts) else calm
        return Case(requirements, (), calm), *unstable
    if system.shifts:
        return ()
    grows = concluded({Fact.EXACTLY_LINEAR, Fact.JORDAN_BLOCK})
    if still and theory.zero_power == 2 * len(null) and not decays and all(r.always for r in requirements):
        return (Case(requirements, (), only_drifts(grows)),)
    letter = "A" if system.of_first_order else "K + N"
    return (Case(_of_full_rank(places, letter, len(null), known), (), grows),)


def _no_gyroscopic(system: LinearSystem, rows: Matrix, known: Signs) -> bool:
    return all(known.normalised(dot(row, v)) == 0 for row in system.G for v in rows)


def _wanted(theory: Theory) -> tuple[Requirement, ...]:
    """What a case requires by which nothing is wrong with the roots: M > 0, or nothing, where they are all zero."""
    by_mass = tuple(replace(r, by_mass=True) for r in theory.mass.requirements)
    return theory.requirements or by_mass or (holds_always(theory.removed),)


def _of_full_rank(matrix: Matrix, letter: str, null: int, known: Signs) -> tuple[Requirement, ...]:
    """A minor of order n - ``null`` that is not zero: the matrix ``letter`` has no further null directions there."""
    n = len(matrix)
    size = n - null
    if not size:
        return (holds_always(matrix[0][0]),)
    for rows in combinations(range(n), size):
        for columns in combinations(range(n), size):
            minor = known.normalised(determinant([[matrix[i][j] for j in columns] for i in rows]))
            if minor != 0:
                return (
                    differs(Message("minor of order [[size]] of [[letter]]", size=size, letter=letter), minor, known),
                )
    raise ValueError("the rank is smaller")


def _semidefinite(system: LinearSystem, known: Signs) -> frozenset[Fact]:
    """The facts, with D >= 0 if all its principal minors are known not to be negative."""
    damped = [i for i in range(system.size) if any(x != 0 for x in system.D[i])]
    if len(damped) > MOST_DAMPED:
        return system.facts
    for size in range(1, len(damped) + 1):
        for at in combinations(damped, size):
            minor = determinant([[system.D[i][j] for j in at] for i in at])
            if known.sign(minor) not in ("positive", "nonnegative", "zero"):
                return system.facts
    return system.facts | {Fact.DAMPING_SEMIDEFINITE}


def _cases_with_zero_roots(
    system: LinearSystem, theory: Theory, known: Signs
) -> tuple[tuple[Case, ...], Theory | None]:
    """Cyclic coordinates: ignore them (Routh) or strike their roots; other zero roots are a border."""
    unstable = _unstable(theory.requirements, known)
    if not system.cyclic:
        standing = bool(system.turned) and system.turned[1] == 0  # in any direction of space: two zero roots
        if standing and theory.zero_power == 2 and theory.variable == "lambda":
            return (Case(theory.requirements, (), _all_left(True)), *unstable), None
        null = null_rows(added(system.K, system.N), known.normalised)
        if len(null) != theory.zero_power:  # Jordan blocks
            return unstable, None
        why = Reason(Because.ZERO_ROOT), Reason(Because.HIGHER_ORDER)
        return (Case(_wanted(theory), (), concluded({Fact.BOUNDED}, *why)), *unstable), None
    if only_momenta(system):
        by_mass = tuple(replace(r, by_mass=True) for r in theory.mass.requirements)
        return (Case(by_mass, (), coasting()),), None
    if momenta_are_constant(system):
        reduced = analyse(ignoring_cyclic(system), known)
        return tuple(replace(c, verdict=drifting(c.verdict)) for c in reduced.cases), reduced
    lasting = _energy_besides(system, known)
    if theory.zero_power == len(system.cyclic) and theory.variable == "lambda":
        energy = ENERGY_BESIDES if any(case.always for case in lasting) else frozenset()
        verdict = drifting(concluded(energy | {Fact.ROOTS_LEFT}), constant_momenta=False)
        if lasting and theory.dissipation is not None and theory.dissipation.word is Definite.POSITIVE:
            return _where_all_is_damped(system, lasting[0].all_of, verdict, known), None
        return (Case(theory.requirements, (), verdict), *lasting, *unstable), None
    return (*lasting, *unstable), None


def _where_all_is_damped(
    system: LinearSystem, positive: Sequence[Requirement], decaying: Verdict, known: Signs
) -> tuple[Case, ...]:
    """D > 0, N = 0: K of the coordinates that are not cyclic decides (Kelvin-Chetaev), no Hurwitz minor is needed.

    m lambda + d + i g + k / lambda = 0 of a vector v, with m = v*.M v and so on, has no solution with Re lambda >= 0
    where k >= 0; lambda = 0 has no Jordan block, as q.D q = 0 of its vector would be asked for.
    """
    block = besides_cyclic(system)
    if not block:
        return (Case(tuple(positive), (), decaying),)
    nonsingular = differs(positive[-1].label, positive[-1].polynomial, known)
    growing = Case((nonsingular,), against(positive, known), concluded({Fact.ROOT_RIGHT}))
    return Case(tuple(positive), (), decaying), growing


def _energy_besides(system: LinearSystem, known: Signs) -> tuple[Case, ...]:
    """Lagrange's theorem for the coordinates that are not cyclic, and all velocities, where D >= 0 is known."""
    block = besides_cyclic(system)
    if not system.conservative or not is_zero(system.N):
        return ()
    if Fact.DAMPING_SEMIDEFINITE not in _semidefinite(system, known):
        return ()
    requirements = definiteness(block or system.kinetic, known, "K" if block else "M").requirements
    if not block:  # T is all of the energy
        requirements = tuple(replace(r, by_mass=True) for r in requirements)
    return (Case(requirements, (), drifting(energy_besides(system), constant_momenta=False)),)


def _all_left(turned: bool) -> Verdict:
    return concluded({Fact.LEFT_BUT_TURNED if turned else Fact.ROOTS_LEFT})


def _conservative(minimum: frozenset[Fact]) -> Verdict:
    """K > 0, D = N = 0."""
    if {None, Ground.ENERGY} & {*applying(minimum)}:
        return concluded(minimum)
    return concluded(minimum | {Fact.BOUNDED}, Reason(Because.NO_ENERGY), Reason(Because.HIGHER_ORDER))


def _first_certain(cases: Sequence[Case], known: Signs) -> tuple[Verdict, bool]:
    """The verdict of the first case, if it always holds; else what all cases have in common that can hold.

    And whether parameters are known at which no case holds.
    """
    possible = [case for case in cases if not case.never]
    if not possible:
        return undecided(Because.BORDER), False
    if possible[0].always:
        return possible[0].verdict, False
    cells = cells_of(possible)
    if cells is None:
        unwritten = any(r.unwritten for case in possible for r in (*case.all_of, *case.any_of))
        return undecided(Because.CONDITIONS_UNWRITTEN) if unwritten else depends(), False
    return alone(cells, known), uncovered(cells, known)


def with_given_cases(theory: Theory, cases: Sequence[Case], known: Signs) -> Theory:
    """The theory with other cases, and the verdict that follows from them."""
    verdict, left = _first_certain(cases, known)
    if verdict.word is Word.UNSTABLE_BUT_BORDERS and any(case.verdict.stable for case in cases):
        verdict = depends()  # the border is no open case
    return replace(theory, cases=tuple(cases), verdict=verdict, uncovered=left)


def _unstable(requirements: Sequence[Requirement], known: Signs) -> tuple[Case, ...]:
    """One case at most: some necessary inequality is reversed, so that there is a root with positive real part."""
    reversed_ = against(requirements, known)
    return (Case((), reversed_, concluded({Fact.ROOT_RIGHT})),) if reversed_ else ()


def _without_known_factor(p: Coefficients, known: Signs) -> tuple[Coefficients, Polynomial]:
    """p = removed * q, with ``removed`` > 0 proved; common factors of unknown sign stay in q."""
    q, common = primitive(p)
    unit, powers = irreducible_factors(common)
    removed, remaining = common * 0 + abs(unit), common * 0 + (1 if unit > 0 else -1)
    for factor, multiplicity in powers:
        power = factor**multiplicity
        word = known.sign(power)
        if word == "positive":
            removed *= power
        elif word == "negative":
            removed *= -power
            remaining = -remaining
        else:
            remaining *= power
    return tuple(c * remaining for c in q), removed


def _factors(p: Coefficients) -> tuple[Factor, ...]:
    """Irreducible factors; what is free of lambda and not a number stays with a single simple factor."""
    powers = factor_in_lambda(p)[1]
    if len(powers) == 1 and powers[0][1] == 1:
        return (Factor(p, 1),)
    return tuple(Factor(coefficients, multiplicity) for coefficients, multiplicity in powers)
