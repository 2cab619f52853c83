"""The pipeline on one page: numbers, titles, who needs whom.

``Analysis`` computes every result when it is first asked for and remembers it, or why there is none, and the seconds
it took.  The dependency graph is plain attribute access.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mbsym.algebra.failures import Failure, SingularPoint
from mbsym.algebra.ring import TERM_BUDGET, Ring
from mbsym.algebra.signs import Signs
from mbsym.formulas.formula import Column, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.mechanics.newton_euler import residuals
from mbsym.mechanics.programs import Programs, programs
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.mechanics.rotation_orders import rotation_orders
from mbsym.mechanics.variables import angle_denominators, ring_environment, ring_of
from mbsym.model.claims import Claim
from mbsym.model.system import System
from mbsym.problems import (
    checks,
    claims,
    energy,
    equations,
    equilibria,
    equilibrium,
    integrals,
    kinematics,
    knowledge,
    linearisation,
    perturbation,
    stability,
)
from mbsym.problems.checks import Check
from mbsym.problems.claims import ClaimResult
from mbsym.problems.claims.counterexample import Trials
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.equilibria import Equilibria
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability import Stability


@dataclass(frozen=True)
class Problem:
    """A numbered problem: ``attribute`` of Analysis holds the result; ``module`` explains it."""

    number: int
    title: str
    attribute: str
    module: Any

    @property
    def explanation(self) -> str:
        return str(self.module.__doc__).strip()


PROBLEMS = {
    problem.number: problem
    for problem in (
        Problem(1, "kinematics", "kinematics", kinematics),
        Problem(2, "energy and force function", "energy", energy),
        Problem(3, "nonlinear Lagrange equations", "equations", equations),
        Problem(4, "equilibrium conditions", "equilibrium", equilibrium),
        Problem(5, "linearisation", "linearisation", linearisation),
        Problem(6, "stability", "stability", stability),
        Problem(7, "first integrals", "integrals", integrals),
    )
}
ALL_PROBLEMS = tuple(PROBLEMS)


#: All claims together may take this part of the work that a run may take, and one of them this part.
CLAIMS_SHARE, CLAIM_SHARE = 4, 16


@dataclass(frozen=True)
class NoResult:
    """Why a stage has no result, in a sentence and in a word or two, and what to try next; a value, not a crash."""

    reason: str
    hint: str = ""
    short: str = "no closed form"


class Unavailable(Failure):
    """Raised when a result is asked for that a stage could not produce; ``failure`` says why."""

    def __init__(self, stage: str, failure: NoResult) -> None:
        super().__init__(f"{stage}: {failure.reason}" + (f" ({failure.hint})" if failure.hint else ""))
        self.failure = failure


@dataclass(frozen=True)
class Stage:
    """What a stage left behind: its value, or its failure, and its own seconds (needed stages not counted)."""

    name: str
    value: Any
    failure: NoResult | None
    seconds: float


class Analysis:
    """Everything that can be derived from one system, lazily.

    ``problems`` are the numbers that reports and self-checks are about; any attribute may be asked for nevertheless.
    ``terms`` is the budget of terms a closed formula may have.  With ``suggests`` false no other coordinates are tried
    where a motion is not steady.
    """

    def __init__(
        self, system: System, problems: Iterable[int] = ALL_PROBLEMS, terms: int = TERM_BUDGET, suggests: bool = True
    ) -> None:
        self.system = system
        self.problems = tuple(sorted(set(problems)))
        self.terms = terms
        self._suggests = suggests
        self._stages: dict[str, Stage] = {}
        self._nested = 0.0

    # --- the machinery of stages ---

    def run(self, name: str, compute: Callable[[], Any]) -> Stage:
        """The remembered stage, computed on first demand."""
        if name not in self._stages:
            outer, self._nested = self._nested, 0.0
            started = time.perf_counter()
            value, failure = None, None
            try:
                value = compute()
            except Unavailable as missing:
                failure = missing.failure
            except SingularPoint as reason:
                failure = NoResult(f"singular: {reason}", "choose another motion or other coordinates", "singular")
            except Failure as reason:
                failure = NoResult(str(reason), reason.remedy)
            whole = time.perf_counter() - started
            self._stages[name] = Stage(name, value, failure, whole - self._nested)
            self._nested = outer + whole
        return self._stages[name]

    def _result(self, name: str, compute: Callable[[], Any]) -> Any:
        stage = self.run(name, compute)
        if stage.failure is not None:
            raise Unavailable(name, stage.failure)
        return stage.value

    def stage(self, number: int) -> Stage:
        """Stage of a numbered problem, derived now if it was not before."""
        name = PROBLEMS[number].attribute
        with suppress(Unavailable):
            getattr(self, name)
        return self._stages[name]

    @property
    def derived(self) -> frozenset[str]:
        """The names of the stages that something has asked for so far."""
        return frozenset(self._stages)

    def _optional(self, attribute: str) -> Any:
        """A result, or None where there is none."""
        try:
            return getattr(self, attribute)
        except Unavailable:
            return None

    # --- what everything stands on ---

    @cached_property
    def ring(self) -> Ring:
        return ring_of(self.system, self.terms)

    @property
    def scene(self) -> Scene:
        """The system over the ring."""
        return self._result("scene", self._scene)

    def _scene(self) -> Scene:
        return Scene(self.system, self.ring, ring_environment(self.system, self.ring), self.ring)

    @property
    def parameters_scene(self) -> Scene:
        """The system over the ring, for formulas in parameters only: its bodies are not derived."""
        return self._result("parameters", self._parameters_scene)

    def _parameters_scene(self) -> Scene:
        return Scene(self.system, self.ring, ring_environment(self.system, self.ring), self.ring, bodies=False)

    @property
    def signs(self) -> Signs:
        return self._result("signs", lambda: knowledge.signs(self.parameters_scene))

    @property
    def programs(self) -> Programs:
        """The equations as a straight-line program."""
        return self._result("programs", lambda: programs(self.system, self.ring))

    @property
    def expanded(self) -> Scene:
        """The system over second-order jets about the unperturbed motion."""
        return self._result("expansion", self._expanded)

    def _expanded(self) -> Scene:
        if not self.system.motion:
            hint = "add for example  motion: {" + ", ".join(f"{name}: 0" for name in self.system.coordinates) + "}"
            raise Unavailable("motion", NoResult("the description gives no unperturbed motion", hint, "no motion"))
        return linearisation.quadratised(self.parameters_scene)

    # --- the numbered problems ---

    @property
    def kinematics(self) -> Kinematics:
        return self._result("kinematics", lambda: kinematics.kinematics(self.scene))

    @property
    def energy(self) -> Energy:
        return self._result("energy", lambda: energy.energy(self.scene))

    @property
    def equations(self) -> Equations:
        return self._result("equations", lambda: equations.equations(self.scene, self.energy))

    @property
    def residuals(self) -> Column:
        """The forcing on the unperturbed motion, by the Newton-Euler recursion over jets."""
        return self._result("residuals", self._residuals)

    def _residuals(self) -> Column:
        return column(self.ring, [-x.value for x in residuals(self.expanded).values()])

    @property
    def equilibrium(self) -> Equilibrium:
        return self._result("equilibrium", self._equilibrium)

    def _equilibrium(self) -> Equilibrium:
        forcing = [x.polynomial for x in self.residuals]
        return equilibrium.equilibrium(self.parameters_scene, forcing, self.signs)

    @property
    def first_approximation(self) -> Linearisation:
        """The equations of perturbed motion, time-dependent or not (its ``varying`` says which)."""
        return self._result("first approximation", self._first_approximation)

    def _first_approximation(self) -> Linearisation:
        if self.equilibrium.impossible:
            never = ", ".join(f"{item} = 0" for item in self.equilibrium.impossible)
            raise Unavailable(
                "motion", NoResult(f"the given motion does not exist: {never} is impossible", "", "no such motion")
            )
        if self.equilibrium.unsteady:
            varying = ", ".join(self.equilibrium.unsteady)
            reason = f"on the given motion the equations still vary with {varying}"
            hint = self._steady_order() or "it is no steady motion in these coordinates"
            raise Unavailable("motion", NoResult(reason, hint, "not steady"))
        return linearisation.by_quadratisation(self.parameters_scene, self.expanded, self.equilibrium)

    @property
    def linearisation(self) -> Linearisation:
        """The first approximation where its coefficients are constant: what the theorems of problem 6 are about."""
        return self._result("linearisation", self._linearisation)

    def _linearisation(self) -> Linearisation:
        found = self.first_approximation
        if found.varying:
            hint = self._steady_order() or "choose coordinates in which the motion is steady, if there are any"
            raise Unavailable("linearisation", NoResult(found.time_dependence, hint, "time-dependent"))
        return found

    def _steady_order(self) -> str:
        """A hint at the rotation sequence in which the first approximation is steady; "" where none is known."""
        if not self._suggests:
            return ""
        for other in rotation_orders(self.system):
            try:
                Analysis(other.system, (), self.terms, suggests=False).linearisation  # noqa: B018
            except Failure:
                continue
            axes, angles = ", ".join(map(str, other.axes)), ", ".join(other.angles)
            order = f"rotation: {{axes: [{axes}], angles: [{angles}]}}"
            return f"with '{order}' of body '{other.body}' the coefficients are constant"
        return ""

    @property
    def stability(self) -> Stability:
        return self._result("stability", self._stability)

    def _stability(self) -> Stability:
        linear, energies = self.linearisation, self._optional("energy")
        cyclic = () if energies is None else energies.cyclic
        conserved = stability.conserves_energy(self.parameters_scene, energies)
        found = self.equilibrium
        return stability.stability(self.parameters_scene, conserved, cyclic, linear, found, self.signs)

    @property
    def integrals(self) -> tuple[Integral, ...]:
        return self._result("integrals", self._integrals)

    def _integrals(self) -> tuple[Integral, ...]:
        return integrals.integrals(self.scene, self.energy, self.equations, self.programs)

    # --- equilibria ---

    @property
    def equilibria(self) -> Equilibria:
        """All relative equilibria at the description's numbers."""
        return self._result("equilibria", self._equilibria)

    def _equilibria(self) -> Equilibria:
        values = given_values(self.system, {})
        missing = missing_values(self.system, values)
        if missing:
            hint = f"add for example  values: {{{missing[0]}: 1, ...}}"
            raise Unavailable("values", NoResult(f"no number for {', '.join(missing)}", hint, "no values"))
        return equilibria.equilibria(self.system, values)

    # --- claims ---

    @property
    def claims(self) -> tuple[ClaimResult, ...]:
        """Every claim of the description against what is derived; the results themselves do not depend on claims."""
        return self._result("claims", self._claims)

    def _claims(self) -> tuple[ClaimResult, ...]:
        if not self.system.claims:
            return ()
        for number in self.problems:  # not under the small budget of a claim, whose failures would be remembered
            self.stage(number)
        if any(claim.right is not None for claim in self.system.claims):
            self._optional("trials")
        symbols = claims.Symbols(self.system)
        own = angle_denominators(self.system)
        arguments = {id(claim): list(symbols.arguments(claim)) for claim in self.system.claims}
        # Sines that only claims hold: those claims are judged in a ring of their own, and cost the others nothing.
        further = {key: some for key, some in arguments.items() if angle_denominators(self.system, some) != own}
        source = self
        if further:
            source = Analysis(self.system, self.problems, self.terms)
            source.ring = ring_of(self.system, self.terms, [one for some in further.values() for one in some])
        allowance = self.ring.work_budget // CLAIMS_SHARE
        found = []
        for claim in self.system.claims:
            result, spent = self._claim(source if id(claim) in further else self, claim, allowance)
            allowance -= spent
            found.append(result)
        return tuple(found)

    @property
    def trials(self) -> Trials:
        """Parameters at which claimed conditions are tried, with exact verdicts."""
        return self._result("exact verdicts", self._trials)

    def _trials(self) -> Trials:
        scene, energies, linear = self.parameters_scene, self._optional("energy"), self.linearisation
        cyclic = () if energies is None else energies.cyclic
        conserved = stability.conserves_energy(scene, energies)
        verdict_at = stability.ExactVerdicts(scene, conserved, cyclic, linear, self.equilibrium, self.signs)
        solved = {name: value.polynomial for name, value in self.equilibrium.solved}
        return Trials(self.system, self.ring, linear.M, solved, verdict_at)

    def _claim(self, source: Analysis, claim: Claim, allowance: int) -> tuple[ClaimResult, int]:
        """One claim and the work that it took: bounded by itself, so that claims cost the reports nothing."""
        ring = source.ring
        work, budget = ring.work, ring.work_budget
        ring.work, ring.work_budget = 0, min(budget // CLAIM_SHARE, max(allowance, 0))
        try:
            result = claims.examine(source, claim)
        except Failure as reason:
            result = claims.undecided(self.system, claim, str(reason))
        spent, ring.work, ring.work_budget = ring.work, work, budget
        return result, spent

    # --- self-check ---

    def _dependent(self) -> perturbation.Dependent:
        """What the matrices of problem 5 have already been freed of, and what their notation stands for."""
        scene = self.parameters_scene
        values = {self.ring.generators[k].name: value for k, value in relations(scene).items()}
        values |= {name: value.polynomial for name, value in self.equilibrium.solved}
        names = [item.name for item in self.system.notation]
        return perturbation.Dependent(values, {name: knowledge.definition_in_parameters(scene, name) for name in names})

    @property
    def checks(self) -> tuple[Check, ...]:
        """Every result of the asked-for problems that has a second route, compared with it."""
        return self._result("checks", self._checks)

    def _checks(self) -> tuple[Check, ...]:
        done = []
        for name, check in self._second_routes():
            try:
                done.append(check())
            except Failure as reason:
                done.append(Check(name, "", "", checks.UNDECIDED, str(reason)))
        return tuple(done)

    def _second_routes(self) -> Iterator[tuple[str, Callable[[], Check]]]:
        """Name and computation of every check that the asked-for problems and their results allow."""
        ring = self.ring
        truth = checks.oracles(self.system, ring)
        asked = {PROBLEMS[number].attribute: self._optional(PROBLEMS[number].attribute) for number in self.problems}
        closed, linear = asked.get("equations"), asked.get("linearisation")
        if asked.get("kinematics") is not None:
            yield "kinematics", lambda: checks.check_kinematics(truth, asked["kinematics"])
        if asked.get("energy") is not None:
            yield "energy", lambda: checks.check_energy(truth, asked["energy"])
        if closed is not None:
            yield "equations of motion", lambda: checks.check_equations(truth, closed)
        if 3 in self.problems and self._optional("programs") is not None:
            yield "straight-line program", lambda: checks.check_program(truth, self.programs)
            yield "mass matrix", lambda: checks.check_mass_matrix(truth, self.programs)
        if closed is not None and asked.get("equilibrium") is not None:
            yield (
                "equilibrium",
                lambda: checks.check_residuals(ring, self.residuals_of(closed), self.equilibrium.residuals),
            )
        if closed is not None and linear is not None:
            yield "linearisation", lambda: checks.check_linearisation(ring, linear, self.linearised(closed))
        if linear is not None:
            dependent = self._dependent()
            yield (
                "perturbed motion",
                lambda: perturbation.check_perturbed_motion(self.system, ring, linear, dependent),
            )
        if asked.get("integrals"):
            yield "first integrals", lambda: perturbation.check_integrals(truth, self.programs, asked["integrals"])

    def residuals_of(self, closed: Equations) -> Column:
        """The motion substituted into the closed equations: the second route of problem 4."""
        forcing = [x.polynomial for x in closed.forcing]
        return equilibrium.equilibrium(self.scene, forcing, self.signs).residuals

    def linearised(self, closed: Equations) -> Linearisation:
        """The closed equations differentiated on the motion: the second route of problem 5."""
        return linearisation.by_equations(self.scene, closed, self.equilibrium)
