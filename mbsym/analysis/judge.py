"""The one judge: what problems 6 and 11 together say of a motion at exact values of all parameters.

Asked in this order, each only where those before leave the nonlinear system open:

1. the first approximation, with the energy and exactly linear equations (``stability.ExactVerdicts``);
2. the system at these numbers: its integrals, an energy of higher order (``relative_equilibria.verdict``);
3. terms of higher order: normal forms, centre manifolds (problem 11); of one coordinate the first term of its potential
   energy, which need not be an algebraic number.

Relations that give coordinates explicitly are put in before 2, and displacements that change no equation are made
coordinates: the motion does not know which coordinates tell it.
Of other constraints 2 and 3 have the manifold that they leave (``higher.on_manifold``).

A family of rests that explains all zero roots, and equations that know no other coordinates, come last.

Step 3 is asked, too, where an energy that does not grow shows stability and dissipation of higher order may make it
asymptotic.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NOT_THERE, Failure
from mbsym.algebra.parts import installed
from mbsym.algebra.rationals import fraction
from mbsym.algebra.terms import apart
from mbsym.analysis import families, higher
from mbsym.analysis.approximation import refuse_unsolved
from mbsym.analysis.constrained import in_free_coordinates, on_a_plane, with_runs_prescribed
from mbsym.analysis.higher import expanded_with
from mbsym.analysis.poles import pole
from mbsym.analysis.stages import NoResult, Unavailable
from mbsym.expressions.message import Message
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.rest import Value, at_numbers, given_values, missing_values, rational_values
from mbsym.model.constraints import is_holonomic
from mbsym.model.substitution import beside_rest, displaced
from mbsym.model.system import System
from mbsym.problems.dissipation import INDEPENDENT
from mbsym.problems.equations import separate
from mbsym.problems.stability.problem import ExactVerdicts, stability
from mbsym.problems.stability.verdict import Flaw, Verdict, here, off_the_leaf, undecided, weakest
from mbsym.problems.stability.words import Because, HigherOrder, Reason, Word

if TYPE_CHECKING:
    from mbsym.algebra.ring import Polynomial
    from mbsym.analysis.pipeline import Analysis
    from mbsym.problems.normal_forms.along import Along, Special
    from mbsym.problems.normal_forms.result import Judged


#: What problem 11 may say, as the words of problem 6; all but the last say it at given momenta of cyclic coordinates.
_WORDS = {"stable": Word.STABLE, "asymptotically stable": Word.ASYMPTOTIC, "unstable": Word.UNSTABLE}

#: Where there is no motion that could be judged.
_NO_MOTION = (
    Because.NOT_THE_VALUE,
    Because.MOTION_NOT_THERE,
    Because.MOTION_OPEN,
    Because.NO_EQUATIONS,
    Because.POLE,
)


class Judge:
    """judge(values): the verdict on the unperturbed motion at exact values of all parameters."""

    def __init__(self, analysis: Analysis, displaces: bool = True) -> None:
        """``displaces``: displacements that change no equation may be taken for coordinates, which is done once."""
        self.analysis, self._displaces = analysis, displaces
        self._judges: dict[System, Judge] = {}

    def __call__(self, values: Mapping[str, Fraction]) -> Verdict:
        return self.decided(self.first_approximation(values), values)

    def first_approximation(self, values: Mapping[str, Any]) -> Verdict:
        """The verdict of step 1; irrational values are enclosures, of the description's own values."""
        divisor = pole(self.analysis, values)
        if divisor is not None:
            return undecided(Because.POLE, divisor)
        rational = all(isinstance(x, Fraction) for x in values.values())
        return self._counted(self._exact(values) if rational else self._enclosed, values)

    def _counted(self, verdict: Verdict, values: Mapping[str, Any]) -> Verdict:
        """With the drift told of coordinates that are cyclic at these values, where none is for all of them."""
        balance = self.analysis.optional("balance") if Flaw.CYCLIC in verdict.flawed else None
        alone = balance is not None and not balance.ignorable
        return here(verdict) if alone and self._has_cyclic_ones_at(values) else verdict

    @cached_property
    def _enclosed(self) -> Verdict:
        of = self.analysis
        described = stability(of.parameters_scene, of.balance, of.judgeable, of.equilibrium, of.signs).numerical
        return described or undecided(Because.NOT_ENCLOSED)

    @cached_property
    def _exact(self) -> ExactVerdicts:
        of = self.analysis
        return ExactVerdicts(of.parameters_scene, of.balance, of.judgeable, of.equilibrium, of.signs)

    def may_add(self, verdict: Verdict) -> bool:
        """Whether the nonlinear system may decide more: of an open verdict, or of stability by an energy that may fall.

        What has speeds of its own is not judged further.
        """
        of = self.analysis
        if of.system.linear is not None or of.system.speeds:
            return False
        if not (verdict.word.open or verdict.word is Word.STABLE):
            return False
        if (of.system.constraints or verdict.word.open) and self._in_others is not None:
            return self._in_others.may_add(verdict)
        if verdict.word is Word.STABLE:
            curved = verdict.because(Because.HIGHER_MINIMUM)  # friction of first order may decay there, too
            return self._loses_energy if curved else self._may_lose_energy
        return verdict.word.open and not verdict.coordinates_singular and not any(map(verdict.because, _NO_MOTION))

    @cached_property
    def _may_lose_energy(self) -> bool:
        balance = self.analysis.optional("balance")  # there is none of constraints without a motion that keeps them
        return balance is not None and not (balance.conserves or balance.exactly_linear) and self._loses_energy

    @cached_property
    def _loses_energy(self) -> bool:
        try:
            return installed("mbsym.problems.normal_forms") and not higher.ignorable(self.analysis)[0]
        except Failure:
            return False

    def decided(self, verdict: Verdict, values: Mapping[str, Any]) -> Verdict:
        """A verdict of step 1, with what the nonlinear system adds: steps 2 and 3, of separate equations by themselves.

        By step 2 only rational values are judged.
        """
        return self._counted(self._decided(verdict, values), values)

    def _decided(self, verdict: Verdict, values: Mapping[str, Any]) -> Verdict:
        whole = self._together(verdict, values)
        for further in (self._by_what_is_near, self._apart, self._along_rests):
            if not (whole.word.open and self.may_add(whole)):
                break
            whole = further(values) or whole
        if whole.word.open and self.may_add(whole) and not all(isinstance(x, Fraction) for x in values.values()):
            exact = self._at_its_numbers
            further_verdict = None if exact is None else exact({})
            if further_verdict is not None and not further_verdict.word.open:
                return further_verdict
        elif whole.word.open and self.may_add(whole) and self._has_cyclic_ones_at(values):
            exact = self._at(values)
            further_verdict = whole if exact is None else exact({})
            return whole if further_verdict.word.open else here(further_verdict)
        return whole

    def _has_cyclic_ones_at(self, values: Mapping[str, Fraction]) -> bool:
        """Whether coordinates are ignorable at these values that are not so for all: momenta are constant there."""
        of, ring = self.analysis, self.analysis.ring
        energies = None if of.system.constraints else of.optional("energy")
        if energies is None:
            return False
        try:
            numbers = dict(ring.given(values))
            if all(any(not ring.substitute(x, numbers).is_zero() for x in held) for held in self._holding):
                return False
            lagrangian = energies.kinetic_energy.polynomial + energies.force_function.polynomial
            parts = [lagrangian, *generalized_forces(of.held_scene).values()]
            there = [ring.reduce(ring.substitute(x, numbers)) for x in parts]
            others = [name for name in of.system.coordinates if name not in of.balance.ignorable]
            return any(not any(ring.depends_on(x, name) for x in there) for name in others)
        except (Failure, *NOT_THERE):
            return False

    @cached_property
    def _holding(self) -> list[list[Polynomial]]:
        """Of every coordinate that is not ignorable for all parameters coefficients with which it stands in L."""
        of, ring = self.analysis, self.analysis.ring
        energies = of.energy
        lagrangian = energies.kinetic_energy.polynomial + energies.force_function.polynomial
        moving = [k for k in occurring([lagrangian]) if ring.generators[k].kind in INDEPENDENT]
        parts = apart(lagrangian, moving)
        found = []
        for name in of.system.coordinates:
            if name not in of.balance.ignorable:
                at = [n for n, k in enumerate(moving) if ring.depends_on(ring.context.gen(k), name)]
                found.append([x for key, x in parts.items() if any(key[n] for n in at)])
        return found

    def at(self, values: Mapping[str, Value], first: Verdict) -> Verdict:
        """``decided`` at values that may be expressions of exact irrational numbers."""
        rational = rational_values(values)
        if len(rational) == len(values):
            return self.decided(first, rational)
        there = self._at(values)
        return first if there is None else there({})

    @cached_property
    def _at_its_numbers(self) -> Judge | None:
        """Of the description's own values, of which some are irrational: cos(pi/2) is 0 where it is put in."""
        return self._at(given_values(self.analysis.system, {}))

    def _at(self, values: Mapping[str, Value]) -> Judge | None:
        """That of the system in which these numbers stand in place of all parameters."""
        system = self.analysis.system
        if {*missing_values(system, values)}:
            return None
        try:
            return Judge(type(self.analysis)(at_numbers(system, values, places=True), (), self.analysis.terms))
        except (Failure, KeyError, *NOT_THERE):
            return None

    def _apart(self, values: Mapping[str, Any]) -> Verdict | None:
        """What is said of parts of the equations that know no others; None where that is open, too."""
        try:
            judged = [(names, judge(values)) for names, judge in self._parts]
        except (Failure, *NOT_THERE):
            return None
        if not judged:
            return None
        apart = weakest([part for _, part in judged])
        if apart.flawed >= {Flaw.CYCLIC, Flaw.STEADY}:  # what comes to another rest is not what is cyclic
            apart = Verdict(Word.STABLE_BUT_CYCLIC, apart.theorems)
        if apart.word.open:
            return None
        alike = [(names, part) for names, part in judged if part.word is apart.word] or judged
        reasons = max((part.reasons for _, part in alike), key=lambda own: [reason.rank for reason in own])
        about = Reason(
            Because.APART, ("; ".join(", ".join(names) for names, part in alike if part.reasons == reasons),)
        )
        return replace(apart, reasons=tuple(sorted({*reasons, about}, key=lambda reason: reason.rank)))

    def _along_rests(self, values: Mapping[str, Any]) -> Verdict | None:
        """Instability by slow motions along rests or steady motions near by, or by those of one coordinate."""
        along = families.by_rests_near(self.analysis, values, decaying=False)
        along = along or higher.by_reduced_potential(self.analysis, values)
        try:
            return along or families.by_one_coordinate(self.analysis, values, lambda x: self._judge_of(x)(values))
        except (Failure, *NOT_THERE):
            return None

    def _by_what_is_near(self, values: Mapping[str, Any]) -> Verdict | None:
        """What rests near by say of one, or its energy without constraints on velocities."""
        decaying = families.by_rests_near(self.analysis, values, decaying=True)
        return decaying or self._by_energy_with_fewer_constraints(lambda other: other(values), values)

    def _by_energy_with_fewer_constraints(
        self, judged: Callable[[Judge], Verdict], values: Mapping[str, Any] | None = None
    ) -> Verdict | None:
        """What the energy says of a rest without constraints on velocities, by the judge of that system."""
        of = self.analysis
        if not of.system.constraints:
            return None

        def there(system: System) -> tuple[Analysis, Verdict]:
            return self._judge_of(system).analysis, judged(self._judge_of(system))

        try:
            balance = of.balance if values is None else of.balance.at(values)
            if families.at_rest(of) and balance.law.bounded:
                return families.by_energy_with_fewer_constraints(of, there, values or {}, balance.conserves)
        except (Failure, *NOT_THERE):  # without these constraints there may be no such rest
            return None
        return None

    def _judge_of(self, system: System) -> Judge:
        """That of another system, made once."""
        if system not in self._judges:
            self._judges[system] = Judge(type(self.analysis)(system, (), self.analysis.terms, suggests=False))
        return self._judges[system]

    @cached_property
    def _parts(self) -> list[tuple[list[str], Judge]]:
        """Coordinates whose equations of motion know no others, and the judge of each; none where they are all one."""
        of = self.analysis
        equations = None if of.system.constraints else of.optional("equations")
        parts = [] if equations is None else separate(of.scene, equations)
        if len(parts) < 2:
            return []
        systems = [beside_rest(of.system, names) for names in parts]
        return [
            (names, Judge(type(of)(system, (), of.terms, suggests=False)))
            for names, system in zip(parts, systems, strict=True)
        ]

    def _together(self, verdict: Verdict, values: Mapping[str, Any]) -> Verdict:
        if not self.may_add(verdict):
            return verdict
        constraints = bool(self.analysis.system.constraints)
        if (constraints or verdict.word.open) and self._in_others is not None:
            other_verdict = self._told_in_others(verdict, values)
            if constraints or not other_verdict.word.open:
                return other_verdict
        if verdict.word.open and all(isinstance(x, Fraction) for x in values.values()):
            verdict = self._by_energy(verdict, values)
            if not self.may_add(verdict):
                return verdict
        if not installed("mbsym.problems.normal_forms"):
            return verdict
        higher_order = self._of_higher_order(values)
        further = None if higher_order is None else self._in_words(higher_order)
        if further is None and (verdict.word.open or verdict.because(Because.HIGHER_MINIMUM)):
            return higher.of_one_coordinate(self.analysis, verdict, values)
        if further is None or (verdict.stable and not further.word.asymptotic):
            return verdict
        return further

    def _by_energy(self, verdict: Verdict, values: Mapping[str, Fraction]) -> Verdict:
        """Step 2 of an open verdict; under constraints on the manifold that they leave."""
        if self.analysis.system.constraints:
            known = installed("mbsym.problems.normal_forms")
            return (higher.by_energy(self.analysis, values) if known else None) or verdict
        # What equilibria are judged by is not imported for nothing.
        from mbsym.problems.relative_equilibria.verdict import decided_at

        there = decided_at(verdict, self.analysis.parameters_scene, values)
        alike = there.because(Because.ALIKE) and not higher.nothing_acts(self.analysis)
        return here(there) if alike else there

    @cached_property
    def _in_others(self) -> Judge | None:
        """The judge of this motion in the coordinates that relations leave, explicit ones and even runs; else None.

        Without constraints in those of which some are displacements that change no equation, where those given are not.
        """
        of = self.analysis
        plain = self._displaced if self._displaces and not of.system.constraints else None
        system = with_runs_prescribed(in_free_coordinates(of.system)) if of.system.constraints else plain
        if of.system.constraints and system is not None and system.constraints:
            system = self._plane
        if system is None or system.constraints:
            return None
        return Judge(type(of)(system, (), of.terms, suggests=False), displaces=bool(of.system.constraints))

    @cached_property
    def _plane(self) -> System | None:
        """In coordinates of a plane that the constraints leave near a rest, if they do."""
        try:
            return on_a_plane(self.analysis) if families.at_rest(self.analysis) else None
        except (Failure, *NOT_THERE):
            return None

    @property
    def _displaced(self) -> System | None:
        """With displacements that change no equation as coordinates, where these are sums of those given."""
        of = self.analysis
        if of.system.linear is not None or of.system.speeds:
            return None
        names = of.system.coordinates
        system, taken = of.system, set[str]()
        for direction in of.balance.displacements(names).directions:
            if not all(x.is_constant() for x in direction):
                return None
            shares = {
                coordinate: fraction(x.leading_coefficient())
                for coordinate, x in zip(names, direction, strict=True)
                if x != 0
            }
            name = next(
                (coordinate for coordinate in reversed(names) if coordinate in shares and coordinate not in taken), None
            )
            if name is None or any(share in taken for share in shares):
                return None
            if len(shares) > 1:
                taken.add(name)
                system = displaced(system, name, {coordinate: c / shares[name] for coordinate, c in shares.items()})
        return system if taken else None

    def for_all(self, verdict: Verdict) -> Verdict:
        """An open verdict on all parameters, or what other coordinates say, or the energy without some constraints."""
        if not (verdict.word.open and self.analysis.system.constraints):
            return verdict
        if self._in_others is not None:
            return self._told_in_others(verdict, None)
        return self._by_energy_with_fewer_constraints(_unconditional) or verdict

    def _told_in_others(self, verdict: Verdict, values: Mapping[str, Any] | None) -> Verdict:
        """What other coordinates say, at values or for all; not where others follow a drift unevenly: rates vary."""
        assert self._in_others is not None
        of, others = self.analysis, self._in_others.analysis
        try:
            further = _unconditional(self._in_others) if values is None else self._in_others(values)
            drift = others.balance.ignorable if Flaw.CYCLIC in further.flawed else ()
            every = of.system.coordinates if Flaw.HERE in further.flawed else drift
            rows = of.constraints.jacobian.polynomials if self._plane is None else []
        except (Failure, *NOT_THERE):
            return verdict
        uneven = any(of.ring.dependencies(x, every) for row in rows for x in row)
        if further.word.open or further.word is Word.DEPENDS or uneven:
            return verdict
        reasons = (
            reason
            for reason in verdict.reasons
            if reason.code is Because.DISPLACEMENTS and reason not in further.reasons
        )
        told = replace(further, reasons=tuple(sorted((*further.reasons, *reasons), key=lambda reason: reason.rank)))
        return told if all(map(is_holonomic, of.system.constraints)) else off_the_leaf(told)

    @cached_property
    def _of_higher_order(self) -> Any:
        return higher.judge(self.analysis)

    def _in_words(self, judged: Judged) -> Verdict | None:
        """A verdict of problem 11 as one of problem 6; None where it leaves the motion open, too.

        Problem 11 keeps the momenta of cyclic coordinates.  Instability then is one; stability is one of neighbouring
        momenta, too, if its conditions are inequalities (Arnold and Moser's without resonance) or H has a strict
        minimum: at neighbouring momenta H is greater on a sphere about the motion than near it, still.
        So it is with the relations that integrable velocity constraints keep; what is asymptotically stable at some
        values of them is stable (it is so under constant perturbations, Malkin), and does not come back from others.
        """
        word = _WORDS.get(judged.outcome.value)
        if word is None:
            return None
        lasting = judged.theorem in (HigherOrder.DEFINITE, HigherOrder.DEFINITE_HIGHER, HigherOrder.ARNOLD_MOSER)
        if word is not Word.UNSTABLE and higher.ignorable(self.analysis)[1]:
            if not lasting:
                return None
            word = Word.STABLE_BUT_CYCLIC
        elif word is not Word.UNSTABLE and higher.on_a_leaf(self.analysis):
            if word is Word.STABLE and not lasting:
                return None
            word = Word.STABLE
        return Verdict(word, (judged.theorem.value,), (Reason(Because.TERMS_OF_HIGHER_ORDER),))


def _unconditional(judge: Judge) -> Verdict:
    """The verdict on a motion that exists for all parameters; undecided where it needs conditions."""
    of = judge.analysis
    return of.stability.verdict if of.equilibrium.satisfied else undecided(Because.MOTION_OPEN, "")


# Problem 11 along one parameter, from an analysis.


def exceptional(
    analysis: Analysis, name: str, interval: tuple[Fraction, Fraction], values: Mapping[str, Fraction]
) -> Along:
    """All exceptional values of a parameter between two numbers, the others at ``values``.

    Raises Unavailable where the system is given by matrices or has no motion; NotAlong and what expansions raise.
    """
    from mbsym.problems.normal_forms.along import along

    if analysis.system.speeds:
        return exceptional(analysis.in_coordinates, name, interval, values)
    analysis = analysis.in_free_coordinates
    if analysis.system.linear is not None:
        reason = "it is given by its matrices, which have no terms of higher order"
        raise Unavailable("system", NoResult(reason, "", "not supported", "not-supported"))
    with analysis.strictly():
        equilibrium = analysis.equilibrium
        analysis.judgeable  # noqa: B018  raises where no theorem applies
    refuse_unsolved(equilibrium)
    solved = {parameter for parameter, _ in equilibrium.solved}
    if name in solved:
        reason = Message("the motion needs one value of [[name]], which the other parameters give", name=name)
        raise Unavailable("conditions", NoResult(reason, "vary another one", "conditions", "solved"))
    numbers = {key: value for key, value in values.items() if key != name and key not in solved}
    scene, told_with = analysis.parameters_scene, expanded_with(analysis)
    listed = along(scene, analysis.system, equilibrium, name, interval, numbers, *told_with)
    return replace(listed, specials=tuple(_judged(analysis, numbers, name, special) for special in listed.specials))


def _judged(analysis: Analysis, values: Mapping[str, Fraction], name: str, special: Special) -> Special:
    """With what problem 6 says at a rational value that terms of higher order leave open: an energy may decide it."""
    if special.exactly is None or special.judged.outcome.value != Word.UNDECIDED.value:
        return special
    there = {**values, name: special.exactly}
    try:
        verdict = Judge(analysis)(there)
    except NOT_THERE:
        return special
    return special if verdict.word.open else replace(special, verdict=verdict)
