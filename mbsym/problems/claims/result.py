"""What became of a claim: its outcome, and everything that can be said of a difference."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Protocol

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.algebra.terms import grouped
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import ZERO, Name, text
from mbsym.formulas.formula import Formula
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import relations
from mbsym.mechanics.programs import Programs
from mbsym.model.claims import CLAIMS, COORDINATE, SUMS, Claim, index_names
from mbsym.model.system import System
from mbsym.problems.claims.counterexample import Counterexample, Trials
from mbsym.problems.dissipation import Balance
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.integrals import Integral
from mbsym.problems.kinematics import Kinematics
from mbsym.problems.knowledge import definition_in_parameters
from mbsym.problems.linearisation import Linearisation
from mbsym.problems.stability.problem import Stability

if TYPE_CHECKING:
    from mbsym.mechanics.speeds import SpeedForm
    from mbsym.problems.canonical import Routh
    from mbsym.problems.claims.oscillations import SolutionInRing, ToldManifold
    from mbsym.problems.normal_forms.result import NormalForms
    from mbsym.problems.state_space import StateSpace


class Outcome(StrEnum):
    """What became of a claim."""

    EXACT = "holds exactly"
    RELATIONS = "holds on the relations between the parameters"
    FACTOR = "holds up to a factor"
    ALONG = "holds on every motion"
    BORDERS = "holds but for border cases"
    EQUIVALENT = "holds up to a total time derivative"
    DIGITS = "holds to the digits printed"
    TOLERANCE = "holds within the tolerance"
    DOUBLES = "holds to the rounding of double precision"
    NUMERICAL = Certainty.VERIFIED.value
    UNDECIDED = Certainty.UNDECIDED.value
    DIFFERS = "differs"
    SCALED = "differs by a factor"
    FAILS = "does not hold"

    def __repr__(self) -> str:
        return repr(self.value)


class Derived(Protocol):
    """What a claim may be compared with; each is derived when it is asked for."""

    @property
    def system(self) -> System: ...
    @property
    def form(self) -> SpeedForm: ...
    @property
    def ring(self) -> Ring: ...
    @property
    def scene(self) -> Scene: ...
    @property
    def parameters_scene(self) -> Scene: ...
    @property
    def signs(self) -> Signs: ...
    @property
    def programs(self) -> Programs: ...
    @property
    def kinematics(self) -> Kinematics: ...
    @property
    def energy(self) -> Energy: ...
    @property
    def equations(self) -> Equations: ...
    @property
    def equilibrium(self) -> Equilibrium: ...
    @property
    def linearisation(self) -> Linearisation: ...
    @property
    def state_space(self) -> StateSpace: ...
    @property
    def routh(self) -> Routh: ...
    @property
    def balance(self) -> Balance: ...
    @property
    def stability(self) -> Stability: ...
    @property
    def integrals(self) -> Sequence[Integral]: ...
    @property
    def normal_forms(self) -> NormalForms: ...
    @property
    def trials(self) -> Trials: ...
    @property
    def claimed_oscillation(self) -> SolutionInRing: ...
    @property
    def claimed_manifold(self) -> ToldManifold: ...


@dataclass(frozen=True)
class Part:
    """``factor`` (a combination of products of velocities; 1 without them) times ``difference``.

    For a characteristic polynomial the factor is its variable to the power ``power``.  ``same_as`` is the abbreviation
    that the difference is (with its number: ``-2*c18``); ``repairs`` are abbreviations with which the claim would be
    right if the formula were added to them.
    """

    factor: Formula
    difference: Formula
    power: int | None = None
    same_as: str = ""
    repairs: tuple[tuple[str, Formula], ...] = ()


@dataclass(frozen=True)
class ClaimResult:
    """``outcome`` is one of the words above; ``difference`` is claimed - derived, ``parts`` the same taken apart.

    ``factor`` is claimed / derived where one is a multiple of the other; else, where it is given, the difference is
    claimed - factor*derived.  For a first integral I the difference is dI/dt on the equations of motion instead.
    ``where`` are the signs to which the outcome is restricted, ``counterexample`` numbers that refute the claim.  For
    numbers at a state ``value`` is the derived one, to more digits than the claim has, ``digits`` how many of the
    ``printed_digits`` hold.  ``remark`` says what else there is to say.
    """

    claim: Claim
    title: str
    outcome: str
    derived: Formula | None = None
    difference: Formula | None = None
    parts: tuple[Part, ...] = ()
    factor: Formula | None = None
    value: str = ""
    digits: int | None = None
    printed_digits: int | None = None
    remark: str = ""
    where: str = ""
    counterexample: Counterexample | None = None

    @property
    def holds(self) -> bool:
        return self.outcome in (
            Outcome.EXACT,
            Outcome.RELATIONS,
            Outcome.FACTOR,
            Outcome.ALONG,
            Outcome.BORDERS,
            Outcome.EQUIVALENT,
            Outcome.DIGITS,
            Outcome.TOLERANCE,
            Outcome.DOUBLES,
            Outcome.NUMERICAL,
        )

    @property
    def refuted(self) -> bool:
        return self.outcome in (Outcome.DIFFERS, Outcome.SCALED, Outcome.FAILS)


#: The title of a claim about an entry: ``mass matrix`` and its indices.
ENTRY = "[[title]] [[[entry]]]"
#: That of a condition, and what it says.
CONDITION = "[[title]] [[that]]"


def title(claim: Claim, system: System) -> Message:
    """What a claim is about: ``mass matrix [theta, delta]``."""
    kind = CLAIMS[claim.kind]
    of = claim.of_expression or (Name(claim.of) if claim.of and kind.of == COORDINATE else claim.of)
    said = Message(f"{claim.kind} of [[of]]", of=of) if of else Message(claim.kind)
    if claim.kind == "coefficient":
        whole = Message(claim.of) if claim.of in SUMS else Message("the equation of [[name]]", name=Name(claim.of))
        said = Message("coefficient of [[at]] in [[whole]]", at=claim.at or ZERO, whole=whole)
    if kind.order:
        said = Message("[[title]], order [[order]]", title=said, order=claim.order)
    if claim.entry:
        counted = zip(claim.entry, index_names(kind, system), strict=True)
        indices = {f"i{n}": k if kind.axes else Name(names[k - 1]) for n, (k, names) in enumerate(counted)}
        together = ",\\, ".join(f"[[{index}]]" for index in indices)
        said = Message(ENTRY, title=said, entry=Message(f"${together}$", **indices))
    if claim.right is not None:
        that = f"{text(claim.equals)} {claim.relation} {text(claim.right)}"
        said = Message(CONDITION, title=said, that=that)
    if claim.at_initial:
        return Message("[[title]] at the initial state", title=said)
    if claim.state:
        state = (Message("$[[name]] = [[value]]$", name=Name(name), value=value) for name, value in claim.state)
        return Message("[[title]] at [[at]]", title=said, at=joined(state, ", "))
    return said


def undecided(system: System, claim: Claim, reason: str) -> ClaimResult:
    """A claim about something that could not be derived."""
    return ClaimResult(claim, title(claim, system), Outcome.UNDECIDED, remark=reason)


# Polynomials of a claim in other forms: in declared parameters, on the relations, by products of velocities.


#: What is told of an unperturbed motion, by how the kinds of claim begin.
_OF_THE_MOTION = ("linear", "subsystem", "state", "characteristic", "condition", "normal form", "lyapunov")

_MOTION = ("velocity", "acceleration")


def scene_of_claims(derived: Derived) -> Scene[Any]:
    """Where claims and their abbreviations are lowered: over parameters, and with the inputs where there are some."""
    return derived.scene if derived.system.inputs else derived.parameters_scene


def in_parameters(derived: Derived, x: Polynomial) -> Polynomial:
    """The description's own symbols replaced by what they stand for."""
    ring, scene = derived.ring, derived.parameters_scene
    degrees = x.degrees()
    images = {}
    for item in derived.system.notation:
        index = ring.index("parameter", item.name)
        if degrees[index] > 0:
            images[index] = definition_in_parameters(scene, item.name)
    return ring.substitute(x, images) if images else ring.reduce(x)


def on_relations(derived: Derived, claim: Claim, x: Polynomial) -> Polynomial:
    """Relations between parameters used; for the linear problem also the conditions under which the motion exists."""
    ring = derived.ring
    if claim.kind.startswith(_OF_THE_MOTION):
        images = derived.equilibrium.determined(derived.parameters_scene)
    else:
        images = relations(derived.parameters_scene)
    return ring.substitute(x, images) if images else x


def is_moving(derived: Derived, x: Polynomial) -> bool:
    """Whether x depends on the state or the time."""
    ring = derived.ring
    degrees = x.degrees()
    if any(degrees[k] > 0 for k, g in enumerate(ring.generators) if g.kind in _MOTION):
        return True
    prescribed = (*(item.name for item in derived.system.prescribed), *derived.system.input_names)
    return bool(ring.dependencies(x, [*derived.system.coordinates, *derived.system.velocities, *prescribed, "t"]))


def by_motion(ring: Ring, x: Polynomial) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """Exponents of velocities and accelerations (those of all others are zero), and what stands before them."""
    yield from split_off(ring, x, {k for k, g in enumerate(ring.generators) if g.kind not in _MOTION})


def by_place(ring: Ring, claim: Claim, x: Polynomial) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """x by products of velocities and accelerations; a characteristic polynomial by powers of its variable."""
    if not claim.variable:
        return by_motion(ring, x)
    time = ring.index("time", "t")
    return split_off(ring, x, set(range(len(ring.generators))) - {time})


def split_off(ring: Ring, x: Polynomial, constant: set[int]) -> Iterator[tuple[tuple[int, ...], Polynomial]]:
    """x as a polynomial in the other generators: their exponents, and the coefficients in the constant ones."""
    others = [k for k in range(len(ring.generators)) if k not in constant]
    groups = grouped(x, lambda m: tuple(0 if k in constant else int(e) for k, e in enumerate(m)), others)
    return iter(groups.items())
