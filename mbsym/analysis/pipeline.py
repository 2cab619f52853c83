"""The pipeline on one page: numbers, titles, who needs whom.

``Analysis`` computes every result when it is first asked for and remembers it, or why there is none, and the seconds
it took.  The dependency graph is plain attribute access.  A problem is one line here: how it follows from other
results; its number and title stand in ``mbsym.problems``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeVar

from mbsym.algebra.failures import Severity
from mbsym.algebra.ring import TERM_BUDGET, Ring
from mbsym.algebra.signs import Signs
from mbsym.analysis import (
    approximation,
    constrained,
    deriving,
    forms,
    given,
    second_routes,
)
from mbsym.analysis.stages import Derived, Knows, NoResult, Stage, Stages, later
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression
from mbsym.formulas.formula import Column
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.mechanics.kinematics import Scene, over_ring
from mbsym.mechanics.programs import Programs, programs
from mbsym.mechanics.states import Oracles
from mbsym.mechanics.variables import ring_of
from mbsym.model.substitution import held
from mbsym.model.system import System
from mbsym.problems import TITLES, kinematics, knowledge
from mbsym.problems.checks import Check, oracles
from mbsym.problems.dissipation import Balance
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability.problem import Stability
from mbsym.problems.telling import ToldSystem

if TYPE_CHECKING:
    from mbsym.analysis.expanding import Expansion
    from mbsym.analysis.oscillating import Oscillating
    from mbsym.analysis.small import SmallParameters
    from mbsym.mechanics.constraints.programs import ConstrainedPrograms
    from mbsym.mechanics.speeds import SpeedForm
    from mbsym.problems.canonical import Brackets, Hamilton, Routh
    from mbsym.problems.claims import ClaimResult
    from mbsym.problems.claims.counterexample import Trials
    from mbsym.problems.constraints.result import Constraints
    from mbsym.problems.first_order import FirstOrder
    from mbsym.problems.invariant_sets.result import InvariantSets
    from mbsym.problems.normal_forms.result import NormalForms
    from mbsym.problems.polynomial_integrals.result import Polynomials
    from mbsym.problems.reduction import Reduced
    from mbsym.problems.relative_equilibria.equilibria import Equilibria
    from mbsym.problems.stabilisation.result import Stabilisation
    from mbsym.problems.state_space import StateSpace

T = TypeVar("T")


#: The checks with which verdicts fall: those of the motion, of the energy and of the first approximation.
JUDGED = ("energy", "equilibrium", "linearisation", "perturbed motion")


#: The checks of what is told in coordinates, and the stage that each is about.
CHECKED_IN_COORDINATES = {
    "equilibrium": "equilibrium",
    "linearisation": "linearisation",
    "perturbed motion": "linearisation",
    "stabilisation": "stabilisation",
    "normal forms": "normal_forms",
    constrained.REACTIONS: "reactions",
    forms.REDUCED: "routh",
}


class Problem(Derived["Analysis", T]):
    """A numbered problem: an attribute of Analysis that holds its result; ``module`` of ``problems`` explains it."""

    def __init__(
        self,
        derive: Callable[[Analysis], T],
        stands_on: Sequence[str],
        says: bool = False,
        knows: Knows = Knows.BODIES,
        module: str = "",
    ) -> None:
        super().__init__(derive, stands_on, says, knows)
        self.module = module

    def __set_name__(self, owner: type, name: str) -> None:
        super().__set_name__(owner, name)
        self.module = self.module or name
        self.number, self.title = [*TITLES].index(name) + 1, TITLES[name]

    @property
    def attribute(self) -> str:
        return self.name

    @property
    def explanation(self) -> str:
        """What ``mbsym explain`` prints."""
        return str(import_module(f"mbsym.problems.{self.module}").__doc__).strip()


class Analysis(Stages):
    """Everything that can be derived from one system, lazily.

    ``problems`` are the numbers that reports and self-checks are about; any attribute may be asked for nevertheless.
    ``terms`` is the budget of terms a closed formula may have.  With ``suggests`` false no other coordinates are tried
    where a motion is not steady.  ``angles`` are angles under sin and cos besides those of the system.
    """

    def __init__(
        self,
        system: System,
        problems: Iterable[int] | None = None,
        terms: int = TERM_BUDGET,
        suggests: bool = True,
        angles: Iterable[Expression] = (),
    ) -> None:
        super().__init__()
        self._checks: dict[str, Check] = {}
        self.system = system
        self.problems = given.chosen(system, USUAL_PROBLEMS) if problems is None else tuple(sorted(set(problems)))
        self.terms = terms
        self.suggests = suggests
        #: Results that a report cannot show, by their numbers, with the reason; they are not missing elsewhere.
        self.withheld: dict[int, NoResult] = {}
        self.angles = tuple(angles)
        #: The forms of problem 3 that reports show beside Lagrange's: of ``FORMS``.
        self.forms: tuple[str, ...] = ()
        #: Of the reports, where it is not that of the description.
        self.language = ""
        #: The author's letters that reports use even where nothing gets shorter; None: all of them where it does.
        self.letters: tuple[str, ...] | None = None
        #: How much reports write out: "compact", or "full".
        self.detail = "compact"
        #: The time until which report.html shows the motion; None: it does not, and nothing is integrated.
        self.animate: float | None = None
        #: Figures beside report.tex that belong to this description (``report.made_figures``).
        self.figures: tuple[Any, ...] = ()

    def __repr__(self) -> str:
        return f"Analysis({self.system!r})"

    @property
    def asked(self) -> tuple[Problem[Any], ...]:
        """The problems that reports and self-checks are about."""
        return tuple(PROBLEMS[number] for number in self.problems)

    def stage(self, number: int) -> Stage:
        """Stage of a numbered problem, derived now if it was not before; what is ``withheld`` counts as missing.

        Where problem 9 is asked for, too, the list of problem 7 goes on with what is found there.
        """
        stage = self.stage_of(PROBLEMS[number].attribute)
        if number in self.withheld:
            return replace(stage, value=None, failure=self.withheld[number])
        if number == 7 and 9 in self.problems and stage.failure is None:
            further = self.stage_of("further_integrals").value
            return replace(stage, value=(*stage.value, *further)) if further else stage
        return stage

    def result(self, name: str, compute: Callable[[], Any]) -> Any:
        """The value of a stage; one that does not know constraints has none where there are some."""
        knows = getattr(type(self), name).knows
        if self.system.constraints and Knows.CONSTRAINTS not in knows:
            compute = lambda: refuse_constraints(self.system, Message("not derived"))  # noqa: E731
        elif self.system.speeds and Knows.SPEEDS not in knows:
            compute = lambda: deriving.result_in_coordinates(self, name)  # noqa: E731
        elif self.system.linear is not None and Knows.MATRICES not in knows:
            compute = given.refuse
        return super().result(name, compute)

    # --- what everything stands on: the system over the ring, over its parameters alone, over jets, as a program ---

    @cached_property
    def ring(self) -> Ring:
        ring = ring_of(self.system, self.terms, self.angles)
        forms.write_symbols(self.system, ring)
        return ring

    scene = Derived["Analysis", Scene](lambda a: a.over_ring(), knows=Knows.ALL)
    parameters_scene = Derived["Analysis", Scene](lambda a: a.over_ring(bodies=False, inputs=False), knows=Knows.ALL)
    #: The system whose inputs keep their values on the unperturbed motion.
    held_scene = Derived["Analysis", Scene](
        lambda a: a.over_ring(inputs=False) if a.system.inputs else a.scene, knows=Knows.MOTIONS
    )
    signs = Derived["Analysis", Signs](lambda a: knowledge.signs(a.parameters_scene), knows=Knows.ALL)
    programs = Derived["Analysis", Programs](lambda a: programs(a.system, a.ring), knows=Knows.SPEEDS)
    expanded = Derived["Analysis", Scene](approximation.expanded, knows=Knows.COORDINATES)
    told = Derived["Analysis", ToldSystem](deriving.told_of, knows=Knows.SPEEDS)

    @cached_property
    def oracles(self) -> Oracles:
        """The states at which checks compare two routes, and d'Alembert's principle there."""
        return oracles(self.system, self.ring)

    @cached_property
    def form(self) -> SpeedForm:
        """The variables of the state: speeds and positions, or coordinates and their rates."""
        from mbsym.mechanics.speeds import SpeedForm  # few systems have speeds of their own

        return SpeedForm(self.system, self.ring)

    @cached_property
    def in_coordinates(self) -> Analysis:
        """The same system in generalised velocities, over the same ring.

        Raises Unavailable where the speeds do not determine these on the unperturbed motion.
        """
        return deriving.analysis(self)

    @cached_property
    def in_free_coordinates(self) -> Analysis:
        """The same motions in the coordinates that explicit relations leave; this one where other constraints stay."""
        system = constrained.in_free_coordinates(self.system) if self.system.constraints else self.system
        if system is self.system or system.constraints:
            return self
        return type(self)(system, self.problems, self.terms, self.suggests, self.angles)

    def over_ring(self, bodies: bool = True, inputs: bool = True) -> Scene:
        """The system over the ring; without ``bodies`` only formulas in its parameters can be lowered.

        Without ``inputs`` these keep their values on the unperturbed motion.
        """
        if self.system.speeds:
            return self.form.scene(bodies)
        system = self.system if inputs else held(self.system)
        return over_ring(system, self.ring, bodies=bodies)

    # --- the numbered problems ---

    kinematics = Problem[Kinematics](lambda a: kinematics.kinematics(a.scene), ("kinematics",))
    energy = Problem[Energy](deriving.energy_of, ("energy",))
    equations = Problem[Equations](
        constrained.equations_of,
        ("equations of motion", "constraints", "constrained motion"),
    )
    constraints: Derived[Analysis, Constraints] = Derived(constrained.constraints_of, ("constraints",))
    #: The same in generalised velocities, of a system in speeds.
    tied_in_coordinates: Derived[Analysis, Constraints] = Derived(constrained.constraints_in_coordinates)
    tied_programs: Derived[Analysis, ConstrainedPrograms] = Derived(constrained.programs_of)
    reactions = Derived["Analysis", tuple[Any, ...]](
        constrained.reactions_of, (constrained.REACTIONS,), knows=Knows.CONSTRAINTS
    )
    reduced: Derived[Analysis, Reduced] = Derived(approximation.reduced, knows=Knows.CONSTRAINTS)
    residuals = Derived["Analysis", Column](approximation.residuals, knows=Knows.CONSTRAINTS)
    equilibrium = Problem[Equilibrium](
        deriving.equilibrium_of,
        ("equilibrium",),
        says=True,
        knows=Knows.MOTIONS,
    )
    first_approximation = Derived["Analysis", Linearisation](approximation.first_approximation, knows=Knows.MOTIONS)
    linearisation = Problem[Linearisation](
        lambda a: a.first_approximation,
        ("linearisation", "perturbed motion"),
        knows=Knows.MOTIONS,
    )
    autonomous = Derived["Analysis", Linearisation](approximation.autonomous, knows=Knows.MOTIONS)
    state_space: Derived[Analysis, StateSpace] = Derived(
        deriving.state_space_of, ("linearisation", "perturbed motion"), knows=Knows.MOTIONS
    )
    judgeable = Derived["Analysis", Linearisation](approximation.judgeable, knows=Knows.MOTIONS)
    balance = Derived["Analysis", Balance](deriving.balance_of, knows=Knows.MOTIONS)
    stability = Problem[Stability](deriving.stability_of, JUDGED, says=True, knows=Knows.MOTIONS)
    integrals = Problem[tuple[Integral, ...]](
        deriving.first_integrals,
        ("equations of motion", *constrained.CHECKS, "first integrals"),
        says=True,
    )

    stabilisation: Problem[Stabilisation] = Problem(
        deriving.stabilisation_of,
        (*JUDGED, "stabilisation"),
        says=True,
        knows=Knows.MOTIONS,
    )

    polynomial_integrals: Problem[Polynomials] = Problem(
        later("mbsym.analysis.polynomial", "polynomials_of"),
        ("equations of motion", "polynomial integrals"),
        says=True,
    )

    further_integrals = Derived["Analysis", tuple[Integral, ...]](
        later("mbsym.analysis.found", "beyond"),
        ("equations of motion", "polynomial integrals"),
        says=True,
        knows=Knows.SPEEDS,
    )

    invariant_sets: Problem[InvariantSets] = Problem(
        later("mbsym.analysis.invariant", "invariant_sets_of"),
        ("equations of motion", "first integrals"),
        says=True,
    )

    normal_forms: Problem[NormalForms] = Problem(
        later("mbsym.analysis.higher", "normal_forms_of"),
        (*JUDGED, "normal forms"),
        says=True,
        knows=Knows.CONSTRAINTS,
    )

    small_parameters: Problem[SmallParameters] = Problem(
        later("mbsym.analysis.small", "small_parameters_of"),
        ("equations of motion", "energy"),
        says=True,
        knows=Knows.ALL,
        module="small_parameter",
    )

    # --- problem 5 in speeds, of a system that has some ---

    first_order: Derived[Analysis, FirstOrder] = Derived(deriving.first_order_of, ("first approximation in speeds",))

    # --- problem 3 in other forms, for whoever asks ---

    hamilton: Derived[Analysis, Hamilton] = Derived(forms.hamilton, (forms.CANONICAL,))
    routh: Derived[Analysis, Routh] = Derived(forms.routh, (forms.REDUCED,), knows=Knows.CONSTRAINTS)
    brackets: Derived[Analysis, Brackets | None] = Derived(
        forms.brackets, (forms.CANONICAL, forms.INVOLUTION), says=True
    )

    # --- at numbers ---

    equilibria: Derived[Analysis, Equilibria] = Derived(
        deriving.equilibria_of,
        ("straight-line program", "constraints"),
        says=True,
        knows=Knows.CONSTRAINTS,
    )

    # --- what stands beside the problems: claims, and the second routes of the self-check ---

    claims: Derived[Analysis, tuple[ClaimResult, ...]] = Derived(
        lambda a: later("mbsym.analysis.judging", "judged_claims")(a) if a.system.claims else (), knows=Knows.ALL
    )
    trials: Derived[Analysis, Trials] = Derived(
        later("mbsym.analysis.judging", "trials"), JUDGED, says=True, knows=Knows.MOTIONS
    )
    claimed_oscillation: Derived[Analysis, Oscillating] = Derived(
        later("mbsym.analysis.judging", "claimed_oscillation"), ("equations of motion",), says=True
    )
    claimed_manifold: Derived[Analysis, Expansion] = Derived(
        later("mbsym.analysis.judging", "claimed_manifold"), ("equations of motion",), says=True
    )
    checks = Derived["Analysis", tuple[Check, ...]](second_routes.checks, knows=Knows.ALL)

    def broken(self, names: Sequence[str]) -> NoResult | None:
        """Why what stands on these checks is withdrawn: the first of them that fails; None where none does."""
        for name in names:
            check = self.check(name)
            if check is not None and check.failed:
                reason = Message(
                    "withdrawn, because the self-check '[[name]]' failed: [[detail]]",
                    name=check.name,
                    detail=check.detail,
                )
                return NoResult(reason, "", "withdrawn", "withdrawn", severity=Severity.DEFECT)
        return None

    def check(self, name: str) -> Check | None:
        """The check of that name; None where the results do not allow one."""
        if self.system.speeds and name in CHECKED_IN_COORDINATES:
            return None if self.optional(CHECKED_IN_COORDINATES[name]) is None else self._there(name)
        if name not in self._checks:
            stage = self.run(f"check: {name}", lambda: second_routes.check(self, name))
            if stage.value is None:  # nothing to compare yet
                self.forget(stage)
                return None
            self._checks[name] = stage.value
        return self._checks[name]

    def _there(self, name: str) -> Check | None:
        """A check of what is told in coordinates; the closed equations there are one of its routes."""
        if 3 in self.problems:
            self.in_coordinates.optional("equations")
        return self.in_coordinates.check(name)

    def take(self, checks: Iterable[Check]) -> None:
        """Checks that were carried out on this analysis, or on a copy of it."""
        for check in checks:
            self._checks.setdefault(check.name, check)


#: Every numbered problem, by its number.
PROBLEMS: dict[int, Problem[Any]] = {number: vars(Analysis)[name] for number, name in enumerate(TITLES, start=1)}
ALL_PROBLEMS = tuple(PROBLEMS)
#: Those of every run; later ones are derived where they are named (8 of systems that are given by their matrices, too).
USUAL_PROBLEMS = tuple(number for number in PROBLEMS if number < 8)
