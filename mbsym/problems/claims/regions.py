"""What problem 6 requires of the parameters, as sets that a claimed condition is compared with.

Every polynomial is in one form: in the description's own symbols, or in declared parameters with relations used, and
its denominators are cleared by their signs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import combinations
from typing import Any

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import Failure
from mbsym.algebra.point import Rationals
from mbsym.algebra.ring import ParameterRing, Polynomial
from mbsym.algebra.semialgebraic import atom, where
from mbsym.algebra.signs import MOST_TERMS, ContradictionError, Signs
from mbsym.algebra.terms import coefficients_in
from mbsym.expressions.message import Message
from mbsym.expressions.tree import is_number
from mbsym.model.claims import Claim
from mbsym.problems.claims.remarks import Remark, Said, letter, named, said
from mbsym.problems.claims.result import Derived, in_parameters, on_relations
from mbsym.problems.knowledge import signs as signs_now
from mbsym.problems.stability.problem import SubsystemStability
from mbsym.problems.stability.problem import in_parameters as of_parameters
from mbsym.problems.stability.requirements import (
    Case,
    Cell,
    Lift,
    Place,
    Requirement,
    against,
    atoms,
    cells_of,
    everywhere,
    joined,
)
from mbsym.problems.stability.symbolic import on_border
from mbsym.problems.stability.verdict import Verdict, combine, concluded, depends
from mbsym.problems.stability.words import Fact, Word

#: Of which coordinates a condition is, and what it is.
_OF = "[[whose]] ([[formula]] [[relation]] 0)"
#: A condition that is longer is called by its label alone.
_LONGEST = 60
#: More labels than these are not listed.
_MOST_LABELS = 4
#: Words of ``Signs.sign`` under which p > 0, p >= 0, p != 0 (and their negations p <= 0, p < 0, p = 0) are certain.
_CERTAIN = {
    ">": ("positive",),
    ">=": ("positive", "nonnegative", "zero"),
    "!=": ("positive", "negative", "nonzero"),
    "<=": ("negative", "nonpositive", "zero"),
    "<": ("negative",),
    "=": ("zero",),
}
#: Roots that are turned over together, and steps by which roots are removed.
_MOST_ROOTS, _MOST_STEPS = 3, 6
_NEGATED = {">": "<=", ">=": "<", "!=": "=", "<=": ">", "<": ">=", "=": "!="}


@dataclass(frozen=True)
class Inequality:
    """``polynomial`` ``relation`` 0."""

    polynomial: Polynomial
    relation: str

    def negated(self) -> Inequality:
        return replace(self, relation=_NEGATED[self.relation])


def is_certain(signs: Signs | None, inequality: Inequality) -> bool:
    """Whether the inequality is proved by what is known; not where nothing is known, or it contradicts itself."""
    if signs is None:
        return False
    try:
        return signs.sign(inequality.polynomial) in _CERTAIN[inequality.relation]
    except ContradictionError:
        return False


class Region:
    """The conditions of problem 6 in one form, for one claim.  Raises NoClosedForm where they have none."""

    def __init__(self, derived: Derived, claim: Claim, own: bool) -> None:
        self.derived, self.claim, self.own = derived, claim, own
        self.signs = derived.signs
        self.parts = derived.stability.subsystems

    def cleared(self, x: Polynomial) -> Polynomial:
        """x in this form times a product that is positive wherever x makes sense: no denominators are left."""
        whole = x if self.own else on_relations(self.derived, self.claim, in_parameters(self.derived, x))
        return self._numerator(whole)

    def _numerator(self, whole: Polynomial) -> Polynomial:
        ring = self.derived.ring
        numerator, denominators = ring.fraction(whole)
        for factor, exponent in denominators:
            if exponent % 2 and self.signs.sign(factor) != "positive":
                numerator = ring.times(numerator, factor)
        return numerator

    def without_roots(self, inequality: Inequality) -> tuple[tuple[Inequality, ...], ...]:
        """Inequalities without roots, of each row of which one holds where ``wanted`` does; itself if none were found.

        With roots r >= 0: a + b r has the sign of (a + b r)(a - b r) where a - b r is known to be positive; for b <= 0
        it is positive if a and a^2 - b^2 r^2 are, for b >= 0 if a or b^2 r^2 - a^2 is.  So g > sqrt(k1) + sqrt(k2) is
        g^2 > k1 + k2 and (g^2 - k1 - k2)^2 > 4 k1 k2, for positive g, and w < sqrt(k) is w < 0 or w^2 < k.
        """
        ring, p, apart = self.derived.ring, inequality.polynomial, list[tuple[Inequality, ...]]()
        if inequality.relation not in (">", ">=") or not self._roots(p):
            return ((inequality,),)
        known = signs_now(self.derived.parameters_scene)  # what claims hold was not there when the others were found
        try:
            for _ in range(_MOST_STEPS):
                roots = self._roots(p)
                if not roots:
                    return (*apart, (Inequality(p, inequality.relation),))
                norm = self._norm(p, roots, known)
                if norm is not None:
                    p = self._numerator(ring.reduce(norm))
                    continue
                first, norm, both = self._squared(p, roots, known)
                p = self._numerator(ring.reduce(norm))
                if both:
                    apart.append((Inequality(first, inequality.relation),))
                elif not self._roots(p):
                    return (*apart, (Inequality(first, inequality.relation), Inequality(p, inequality.relation)))
                else:
                    break
        except (Failure, LookupError):
            pass
        return ((inequality,),)

    def _roots(self, p: Polynomial) -> list[int]:
        return [k for k in occurring([p]) if self.derived.ring.generators[k].kind == "root"]

    def _norm(self, p: Polynomial, roots: Sequence[int], known: Signs) -> Polynomial | None:
        """p times what it is with other signs of some roots, of known sign, or minus that; None where there is none."""
        for number in range(min(len(roots), _MOST_ROOTS), 0, -1):
            for turned in combinations(roots, number):
                terms = p.terms()
                other = p.context().from_dict({e: c * (-1) ** sum(e[k] for k in turned) for e, c in terms})
                sign = known.sign(other)
                if sign in ("positive", "negative"):
                    return self.derived.ring.times(p, other if sign == "positive" else -other)
        return None

    def _squared(self, p: Polynomial, roots: Sequence[int], known: Signs) -> tuple[Polynomial, Polynomial, bool]:
        """(a, a^2 - b^2 r^2, True) of p = a + b r with b <= 0, (a, b^2 r^2 - a^2, False) with b >= 0.

        Raises LookupError where it is not of that form.
        """
        times = self.derived.ring.times
        for k in roots:
            if p.degrees()[k] == 1:
                a, b = coefficients_in(p, k)
                sign, with_root = known.sign(b), b * p.context().gen(k)
                norm = times(a, a) - times(with_root, with_root)
                if not self._roots(a) and sign in ("negative", "nonpositive"):
                    return a, norm, True
                if not self._roots(a) and sign in ("positive", "nonnegative"):
                    return a, -norm, False
        raise LookupError("no root can be taken apart")

    # --- single conditions ---

    def conditions(self, left_out: Sequence[str] = ()) -> Iterator[tuple[Remark, Inequality]]:
        """What a condition of problem 6 is called, and its inequality: as they stand, as they arise, and sufficient.

        With its label stands what it is, where a list of the open conditions of problem 6 does not hold it.
        """
        for part in self.parts:
            whose = named(part.coordinates)
            sufficient = () if "sufficient" in left_out else part.sufficient
            # Of a motion that is proved to be stable no condition is listed.
            listed = () if part.theory.verdict.stable else part.conditions
            for group, note in (
                ((*part.conditions, *part.unreduced, *sufficient), ""),
                (part.guaranteed, Message(": it holds, the kinetic energy is positive definite")),
            ):
                for label, formula, relation in group:
                    seen = (label, formula, relation) in listed or len(f"{formula} {relation} 0") > _LONGEST
                    of = whose if seen else Message(_OF, whose=whose, formula=formula, relation=relation)
                    yield said(Said.IS, letter(label), of, note), Inequality(self.cleared(formula.polynomial), relation)

    def labels(self, of: Sequence[str] = ()) -> str | tuple[Remark, ...]:
        """The conditions that an implication rests on, those of one part where its coordinates are given."""
        parts = [part for part in self.parts if not of or part.coordinates == of]
        labelled = [(_needed(part.theory.requirements), part.coordinates) for part in parts]
        if not 0 < sum(len(labels) for labels, _ in labelled) <= _MOST_LABELS:
            return Message("the conditions of problem 6")
        return tuple(
            said(Said.LABELS, tuple(map(letter, labels)), named(names)) for labels, names in labelled if labels
        )

    # --- sets ---

    @cached_property
    def signs_of_bodies(self) -> Signs:
        """The signs, and I1 + I2 >= I3 for the moments of inertia of every body."""
        return self.signs.assuming((x.polynomial, x.relation) for x in self._triangles())

    def _triangles(self) -> Iterator[Inequality]:
        for body in self.derived.system.bodies:
            if body.inertia is None or body.inertia.accepted:
                continue
            if any(is_number(body.inertia.tensor[k][k], 0) for k in range(3)):
                continue  # moments that are left out as zero are no body's
            try:
                moments = [self.derived.parameters_scene.lower(body.inertia.tensor[k][k]) for k in range(3)]
                gaps = [self.cleared(sum(moments) - 2 * moment) for moment in moments]
            except Failure:
                continue
            for gap in gaps:
                if not gap.is_constant() and len(gap) <= MOST_TERMS:
                    yield Inequality(gap, ">=")

    def verdict(self, conditions: Sequence[Inequality], bodies: bool = False) -> Verdict:
        """What the cases of problem 6 have in common where all of these hold, as sets of parameters.

        "depends on the parameters" where that is nothing, and where it was not found.
        """
        try:
            carry, known = self._domain(conditions, bodies)
            cells = [self._cells(part, partial(self._carried, carry, part)) for part in self.parts]
            within = where(*(atom(carry(x.polynomial), x.relation) for x in conditions))
            return joined(cells, known, self.derived.balance.law.bounded, within)
        except (ContradictionError, Failure):
            return depends()

    def without(self, inequality: Inequality, bodies: bool = False) -> Verdict:
        """The verdict where it does not hold."""
        return self.verdict([inequality.negated()], bodies)

    def exponential(self, inequality: Inequality, bodies: bool = False) -> tuple[str, ...] | None:
        """The coordinates of a part whose roots all lie to the left only where it holds; None where there is none."""
        opposite = inequality.negated()
        for part in self.parts:
            requirements = [r for r in part.theory.requirements if not r.by_mass]
            if part.theory.variable != "lambda" or any(r.unwritten for r in requirements):
                continue
            try:
                carry, known = self._domain([inequality], bodies)
                lift = partial(self._carried, carry, part)
                inside = where(*(x for r in requirements for x in atoms(r, lift)))
                beyond = inside & where(atom(carry(opposite.polynomial), opposite.relation))
                if beyond.is_empty(known) and not inside.is_empty(known):
                    return part.coordinates
            except (ContradictionError, Failure):
                continue
        return None

    def is_border(self, values: Mapping[str, Any]) -> bool:
        """Whether some condition of problem 6, as it arises, is an equality there."""
        carry = Carrier(self.derived.ring, Rationals({}, {}), values)
        return any(
            carry(part.in_whole(r.polynomial)) == 0
            for part in self.parts
            for r in part.theory.requirements
            if r.relation == ">" and r.place is not Place.HARMLESS and not r.by_mass and not r.unwritten
        )

    def _domain(self, inequalities: Sequence[Inequality], bodies: bool) -> tuple[Lift, Signs]:
        """How polynomials are carried into the ring of the parameters that occur, and what is known of these."""
        signs = self.signs_of_bodies if bodies else self.signs
        masses = [x.polynomial for x in self._mass() if not x.polynomial.is_constant()]
        held = [self._lifted(part, x) for part in self.parts for x in part.theory.polynomials]
        ring, known = of_parameters(
            self.derived.ring, [[[*(x.polynomial for x in inequalities), *held, *masses]]], signs
        )

        def carry(x: Polynomial) -> Polynomial:
            return ring.project(x) if isinstance(ring, ParameterRing) else x

        return carry, known.assuming((carry(x), ">") for x in masses)

    def _cells(self, part: SubsystemStability, lift: Lift) -> tuple[Cell, ...]:
        """The cases of a part; where a condition is reversed it is unstable, whether a case says so or not."""
        theory = part.theory
        if theory.verdict.word is not Word.DEPENDS:
            return everywhere(theory.verdict)
        unstable_labels = {r.label for case in theory.cases if case.verdict.word is Word.UNSTABLE for r in case.any_of}
        plain = Signs(part.ring.context, ("real",) * part.ring.context.nvars())
        further = tuple(r for r in against(theory.requirements, plain) if r.label not in unstable_labels)
        cases = [case for case in theory.cases if not case.never]
        cases += [Case((), further, concluded({Fact.ROOT_RIGHT}))] if further else []
        return cells_of(cases, lift) or everywhere(theory.verdict)

    def _mass(self) -> Iterator[Inequality]:
        """M > 0, as of every kinetic energy: its leading minors."""
        for part in self.parts:
            for requirement in part.theory.mass.requirements:
                if len(requirement.polynomial) <= MOST_TERMS:
                    yield Inequality(self._lifted(part, requirement.polynomial), ">")

    def _carried(self, carry: Lift, part: SubsystemStability, x: Polynomial) -> Polynomial:
        return carry(self._lifted(part, x))

    def _lifted(self, part: SubsystemStability, x: Polynomial) -> Polynomial:
        """A polynomial of problem 6 in this form."""
        ring = self.derived.ring
        return self.cleared(part.ring.lift(x) if isinstance(part.ring, ParameterRing) else ring.reduce(x))

    def on_border(self, inequality: Inequality, others: Sequence[Inequality] = ()) -> Verdict:
        """What holds where ``wanted`` is an equality and ``others`` do, which exactly linear equations know of.

        "depends on the parameters" also where that was not found.
        """
        if not self.derived.balance.exactly_linear:
            declared = Region(self.derived, self.claim, own=False)
            return self.derived.trials.verdict_where_zero(declared.cleared(inequality.polynomial)) or depends()
        if not self.own:
            return depends()
        verdicts = []
        try:
            for part in self.parts:
                if part.system is None or part.known is None:
                    return depends()
                small = part.ring if isinstance(part.ring, ParameterRing) else None
                p = _in(small, inequality.polynomial)
                further = [(x, other.relation) for other in others if (x := _in(small, other.polynomial)) is not None]
                there = None if p is None else on_border(part.system, part.known, p, further)
                verdicts.append(there or part.theory.verdict)
        except (ContradictionError, Failure):
            return depends()
        return combine(verdicts, self.derived.balance.law.bounded)

    def makes_stiffness_singular(self, x: Polynomial) -> bool:
        """Whether x = 0 implies det K = 0 in a part M q'' + K q = 0: then q = q0 + q1 t solves it."""
        ring = self.derived.ring
        stiff = [
            self._lifted(part, part.theory.polynomial[0])
            for part in self.parts
            if part.theory.kind == "conservative" and part.theory.polynomial and not part.theory.zero_power
        ]
        if x.is_constant() or not stiff:
            return False
        factors = (factor for factor, _ in ring.factored(x)[1])
        may_vanish = [f for f in factors if not self.signs.never_zero(f)]
        return all(any(ring.quotient(k, factor) is not None for k in stiff) for factor in may_vanish)


def _in(small: ParameterRing | None, x: Polynomial) -> Polynomial | None:
    """The polynomial in a part's ring; None where it holds what does not occur there."""
    if small is None:
        return x
    return small.project(x) if {*occurring([x])} <= {*small.indices} else None


def _needed(requirements: Sequence[Requirement]) -> list[str]:
    return [r.label for r in requirements if not r.always and r.place is not Place.HARMLESS]
