"""What problem 6 requires of the parameters, as sets that a claimed condition is compared with.

Every polynomial is in one form: in the description's own symbols, or in declared parameters with relations used, and
its denominators are cleared by their signs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import ParameterRing, Polynomial
from mbsym.algebra.signs import MOST_TERMS, ContradictionError, Signs
from mbsym.expressions.tree import is_number
from mbsym.model.claims import Claim
from mbsym.problems.claims.forms import in_parameters, on_relations
from mbsym.problems.claims.result import Derived
from mbsym.problems.stability import SubsystemStability
from mbsym.problems.stability.requirements import Case, Requirement
from mbsym.problems.stability.verdict import Verdict, combine
from mbsym.problems.stability.word import Word

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
_NEGATED = {">": "<=", ">=": "<", "!=": "=", "<=": ">", "<": ">=", "=": "!="}


@dataclass(frozen=True)
class Inequality:
    """``polynomial`` ``relation`` 0."""

    polynomial: Polynomial
    relation: str

    def negated(self) -> Inequality:
        return replace(self, relation=_NEGATED[self.relation])


def is_certain(signs: Signs | None, wanted: Inequality) -> bool:
    """Whether the inequality is proved by what is known; not where nothing is known, or it contradicts itself."""
    if signs is None:
        return False
    try:
        return signs.sign(wanted.polynomial) in _CERTAIN[wanted.relation]
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
        ring = self.derived.ring
        whole = x if self.own else on_relations(self.derived, self.claim, in_parameters(self.derived, x))
        numerator, denominators = ring.fraction(whole)
        for factor, exponent in denominators:
            if exponent % 2 and self.signs.sign(factor) != "positive":
                numerator = ring.times(numerator, factor)
        return numerator

    # --- single conditions ---

    def conditions(self, left_out: Sequence[str] = ()) -> Iterator[tuple[str, Inequality]]:
        """What a condition of problem 6 is called, and its inequality: as they stand, as they arise, and sufficient."""
        for part in self.parts:
            whose = ", ".join(part.coordinates)
            sufficient = () if "sufficient" in left_out else part.sufficient
            for found, note in (
                ((*part.conditions, *part.unreduced, *sufficient), ""),
                (part.guaranteed, ": it holds, the kinetic energy is positive definite"),
            ):
                for label, formula, relation in found:
                    what = f"it is the condition {label} of {whose}{note}"
                    yield what, Inequality(self.cleared(formula.polynomial), relation)

    def labels(self, asymptotic: bool = False) -> str:
        """Names of the conditions that an implication rests on."""
        parts = [part for part in self.parts if not asymptotic or part.theory.variable == "lambda"]
        found = [([r.label for r in part.theory.requirements if not r.always], part.coordinates) for part in parts]
        if not 0 < sum(len(labels) for labels, _ in found) <= _MOST_LABELS:
            return "the conditions of problem 6"
        return " and ".join(f"{', '.join(labels)} of {', '.join(names)}" for labels, names in found if labels)

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

    def inside(self, bodies: bool = False, asymptotic: bool = False) -> Signs | None:
        """What is known where all conditions hold; with ``asymptotic`` where all roots of some parts lie to the left.

        None where problem 6 requires nothing (of such parts).
        """
        known: list[Inequality] = []
        for part in self.parts:
            if asymptotic and part.theory.variable != "lambda":
                continue
            for requirement in part.theory.requirements:
                condition = requirement.condition
                if condition.kind in ("inequality", "never") and not requirement.by_mass:
                    known.append(Inequality(self._lifted(part, requirement.polynomial), ">"))
                    known.append(Inequality(self._lifted(part, condition.polynomial), ">"))
                known += [Inequality(self._lifted(part, x), "!=") for x in condition.nonzero]
        return self._assuming(known, bodies)

    def not_unstable(self, bodies: bool = False) -> Signs | None:
        """What is known where no inequality is reversed: elsewhere a root has a positive real part."""
        known = [
            Inequality(self._lifted(part, requirement.polynomial), ">=")
            for part in self.parts
            for requirement in part.theory.requirements
            if requirement.relation == ">" and not requirement.always and requirement.condition.kind != "unwritten"
        ]
        return self._assuming(known, bodies)

    def _assuming(self, known: Sequence[Inequality], bodies: bool) -> Signs | None:
        if not known:
            return None
        signs = self.signs_of_bodies if bodies else self.signs
        facts = (x for x in (*known, *self._mass()) if not x.polynomial.is_constant())
        return signs.assuming((x.polynomial, x.relation) for x in facts if len(x.polynomial) <= MOST_TERMS)

    def _mass(self) -> Iterator[Inequality]:
        """M > 0, as of every kinetic energy: its leading minors."""
        for part in self.parts:
            for requirement in part.theory.mass.requirements:
                if len(requirement.polynomial) <= MOST_TERMS:
                    yield Inequality(self._lifted(part, requirement.polynomial), ">")

    def _lifted(self, part: SubsystemStability, x: Polynomial) -> Polynomial:
        """A polynomial of problem 6 in this form."""
        ring = self.derived.ring
        return self.cleared(part.ring.lift(x) if isinstance(part.ring, ParameterRing) else ring.reduce(x))

    # --- what follows ---

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

    def verdict_with(self, conditions: Sequence[Inequality], bodies: bool = False) -> Verdict | None:
        """What the cases of problem 6 say where these hold; None where that is open, or they contradict each other."""
        signs = self.signs_of_bodies if bodies else self.signs
        facts = [*conditions, *self._mass()]
        known = signs.assuming((x.polynomial, x.relation) for x in facts if not x.polynomial.is_constant())
        try:
            found = [self._verdict_of(part, known) for part in self.parts]
        except ContradictionError:
            return None
        return combine(x for x in found if x is not None) if found and None not in found else None

    def _verdict_of(self, part: SubsystemStability, known: Signs) -> Verdict | None:
        """The verdict of the first case that holds, if all before it do not."""
        theory = part.theory
        if theory.verdict.word not in (Word.UNDECIDED, Word.DEPENDS):
            return theory.verdict
        for case in theory.cases:
            word = self._state(part, case, known)
            if word == "holds":
                return case.verdict
            if word == "open":
                return None
        return None

    def _state(self, part: SubsystemStability, case: Case, known: Signs) -> str:
        """Whether a case ``holds``, ``fails`` or is ``open``."""
        every = [self._decided(part, requirement, known) for requirement in case.all_of]
        some = [self._decided(part, requirement, known) for requirement in case.any_of]
        if "fails" in every or (some and all(word == "fails" for word in some)):
            return "fails"
        return "holds" if all(w == "holds" for w in every) and (not some or "holds" in some) else "open"

    def _decided(self, part: SubsystemStability, requirement: Requirement, known: Signs) -> str:
        if requirement.always:
            return "holds"
        if requirement.condition.kind == "unwritten":
            return "open"
        wanted = Inequality(self._lifted(part, requirement.polynomial), requirement.relation)
        if is_certain(known, wanted):
            return "holds"
        return "fails" if is_certain(known, wanted.negated()) else "open"
