"""``results.json`` of ``mbsym run``: the head and what is small; each problem has a module."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Literal

from msgspec import UNSET, Meta, UnsetType, field

from mbsym.algebra.failures import Limit, Severity
from mbsym.expressions.table import CUBIC, ENDS, EXTRAPOLATE, HOLD, LINEAR, OUTSIDE_ZERO
from mbsym.problems import NUMBERS
from mbsym.report.documents.base import (
    ASIDE,
    BY_COORDINATE,
    Format,
    From,
    Part,
    Version,
    or_null,
    told_apart_by,
    version,
    words,
)
from mbsym.report.documents.parts import Formula
from mbsym.report.documents.results.claims import Claim
from mbsym.report.documents.results.equations import Equations, Reaction
from mbsym.report.documents.results.linearisation import FirstOrder, Linearisation, StateSpace
from mbsym.report.documents.results.stabilisation import Stabilisation
from mbsym.report.documents.results.stability import Stability

if TYPE_CHECKING:
    from mbsym.report.documents.results.invariant_sets import InvariantSets
    from mbsym.report.documents.results.normal_forms import NormalForms
    from mbsym.report.documents.results.polynomial_integrals import PolynomialIntegrals
    from mbsym.report.documents.results.small_parameters import SmallParameters


#: Types of sections of problems that an installation may lack (``mbsym.algebra.parts``), for schemas alone.
LATER = {
    "InvariantSets": "invariant_sets",
    "NormalForms": "normal_forms",
    "PolynomialIntegrals": "polynomial_integrals",
    "SmallParameters": "small_parameters",
}


class Described(Part, frozen=True):
    """what the description is about"""

    name: Annotated[str, "its name"]
    description: Annotated[str, "its own words about it"]


class Assumption(Part, frozen=True):
    """an inequality that the parameters are assumed to satisfy"""

    left: Annotated[Formula, "its left side, in parameters and symbols of the notation"]
    relation: Annotated[str, words("<", "<=", ">", ">=", "!="), "how it is related to the right side"]
    right: Annotated[Formula, "its right side"]


class SmallParameter(Part, frozen=True):
    """what expansions are made in the powers of"""

    name: Annotated[str, "a parameter, or with powers a name of its own"]
    powers: Annotated[dict[str, int], "parameters and variables that hold it, each with its power; or none"]
    fast: Annotated[list[str], "variables that a slow manifold expresses by the others; none: they are found"]
    slow: Annotated[list[str], "variables that are not among the fast ones"]
    leading: Annotated[str | UnsetType, "the variable whose oscillation is followed, where it is given", From()] = UNSET


class Table(Part, frozen=True):
    """a function that is given by points"""

    name: Annotated[str, "its name, by which formulas call it"]
    points: Annotated[list[list[str]], "argument and value, exact, arguments increasing"]
    between: Annotated[str, words(LINEAR, CUBIC), "between the points: straight lines, or the natural spline"]
    outside: Annotated[str, words(HOLD, OUTSIDE_ZERO, EXTRAPOLATE, ENDS), "before the first point and after the last"]
    held: Annotated[
        str | UnsetType,
        "where it is zero outside and jumps: how formulas call the same table with its end values outside, which "
        "terms with sign() take away there",
    ] = UNSET


class Motion(Part, frozen=True):
    """of one coordinate"""

    value: Annotated[Formula, "at t = 0"]
    rate: Annotated[Formula, "how fast it changes, a constant"]


class Initial(Part, frozen=True):
    """of one coordinate"""

    position: Annotated[Formula | UnsetType, "its value"] = UNSET
    velocity: Annotated[Formula | UnsetType, "its rate"] = UNSET


class Given(Part, frozen=True):
    """a free function of time: it and its derivatives are symbols"""

    name: Annotated[str, "its name; of its derivatives name_dot and name_ddot"]
    meaning: Annotated[str, "what it is"]
    law: Annotated[
        Formula | UnsetType, "what it is where numbers are wanted, if the description says so", From(by=or_null)
    ] = UNSET


class Input(Part, frozen=True):
    """an input"""

    name: Annotated[str, "its name"]
    meaning: Annotated[str, "what it is"]
    held: Annotated[Formula, "its constant value on the unperturbed motion, for which problems 4 to 6 hold"]


class Output(Part, frozen=True):
    """an output"""

    name: Annotated[str, "its name"]
    value: Annotated[Formula, "in coordinates, velocities, parameters and inputs"]


class Parameter(Part, frozen=True):
    """a parameter"""

    name: Annotated[str, "its name"]
    sign: Annotated[
        str, words("real", "positive", "nonnegative", "negative", "nonpositive", "nonzero"), "what is known of its sign"
    ]
    value: Annotated[Formula | None, "its value, if the description gives one"]
    meaning: Annotated[str | None, "what it is, in the description's words"]
    unit: Annotated[str | UnsetType, "its unit, where that follows from the description; nothing for a pure number"] = (
        UNSET
    )


class Body(Part, frozen=True):
    """a body; components in its own axes"""

    name: Annotated[str, "its name"]
    rotation: Annotated[list[list[Formula]], "direction cosines, axes of the body in the rows"]
    angular_velocity: Annotated[list[Formula], "angular velocity"]
    velocity_origin: Annotated[list[Formula], "velocity of its joint"]
    velocity_mass_centre: Annotated[list[Formula], "velocity of its mass centre"]


class Kinematics(Part, frozen=True):
    """problem 1"""

    bodies: Annotated[list[Body], "the bodies", told_apart_by("name")]


class Energy(Part, frozen=True):
    """problem 2: T = 1/2 A2_ij q'_i q'_j + A1_i q'_i + A0; with speeds u of their own in these"""

    kinetic_energy: Annotated[Formula, "T"]
    A2: Annotated[
        list[Annotated[list[Formula], BY_COORDINATE]], "second degree in the velocities, symmetric", BY_COORDINATE
    ]
    A1: Annotated[list[Formula], "first degree", BY_COORDINATE]
    A0: Annotated[Formula, "of no degree"]
    force_function: Annotated[Formula, "U = -potential energy"]
    cyclic: Annotated[list[str], "coordinates and prescribed quantities that L does not contain"]
    speeds: Annotated[list[str] | UnsetType, "the speeds u, in the order of A2 and A1, where they are not q'"] = UNSET


class Routh(Part, frozen=True):
    """problem 3 in Routh's form, where it was asked for: M_R s'' = f_R"""

    ignored: Annotated[list[str], "the cyclic coordinates c, without force, that are left out"]
    momenta: Annotated[list[str], "the names of their momenta beta, which are constants"]
    coordinates: Annotated[list[str], "the other coordinates s, in the order of M_R and f_R"]
    function: Annotated[Formula, "Routh's function R = L - beta.c', without c'"]
    mass_matrix: Annotated[list[list[Formula]], "M_R"]
    linear: Annotated[list[Formula], "b of R = 1/2 s'.M_R s' + b.s' - W"]
    reduced_potential: Annotated[Formula, "W"]
    forcing: Annotated[list[Formula], "f_R"]
    ignored_rates: Annotated[list[Formula], "c'"]


class Hamilton(Part, frozen=True):
    """problem 3 in Hamilton's form, where it was asked for"""

    positions: Annotated[list[str], "coordinates, unit vectors and quaternions that are the state beside p"]
    speeds: Annotated[list[str], "the independent velocities u, or speeds, that p belong to"]
    momenta: Annotated[list[str], "the names of the momenta p, in the order of u"]
    momenta_in_velocities: Annotated[list[Formula], "p = dL/du", BY_COORDINATE]
    hamiltonian: Annotated[Formula, "Hamilton's function H(q, p, t)"]
    velocities: Annotated[list[Formula], "q' = Y dH/dp + y0 of the positions; Y = 1 where u = q'", BY_COORDINATE]
    rates: Annotated[list[Formula], "p', -dH/dq + Q where u = q'", BY_COORDINATE]
    integrable: Annotated[bool | None, "whether the constraints on velocities are; null where that is undecided"]


class Brackets(Part, frozen=True):
    """the first integrals of problem 7 in momenta"""

    integrals: Annotated[list[str], "their names", From("names")]
    formulas: Annotated[list[Formula], "F_i(q, p, t)"]
    matrix: Annotated[list[list[Formula]], "their Poisson brackets"]
    in_involution: Annotated[bool | None, "whether all brackets are zero; null where that is not decided"]


class Measure(Part, frozen=True):
    """a measure"""

    quantity: Annotated[str, "what is measured"]
    unit: Annotated[str, "its unit"]
    without: Annotated[float, "without the saving"]
    with_: Annotated[float, "with it", From("taken")]
    at_least: Annotated[bool, "whether the number without is a lower bound"]


class Saving(Part, frozen=True):
    """one saving"""

    kind: Annotated[str, "its kind"]
    what: Annotated[list[str], "what was left out"]
    why: Annotated[str, "why that is safe, in words"]
    how: Annotated[str, "how that is known: proved, verified numerically, measured, estimated, undecided"]
    standing: Annotated[
        str,
        words("not needed", "needed", "open"),
        "whether this scene needs it: not needed, needed, open (no accuracy to hold it against)",
    ]
    error: Annotated[float | None, "what leaving it out changes of the motion, relative to its size (--accuracy)"]
    tolerable: Annotated[float | None, "what a model may change at the accuracy asked for"]
    measures: Annotated[list[Measure], "what it saved"]


class Ledger(Part, frozen=True):
    """what was left out of the model and what that saved (mbsym run --ledger)"""

    savings: Annotated[list[Saving], "savings"]
    not_measured: Annotated[list[str], "what was not measured, in words", From("unmeasured")]


class SelfCheck(Part, frozen=True):
    """a comparison of two independent routes"""

    name: Annotated[str, "what is compared"]
    first: Annotated[str, "the first route"]
    second: Annotated[str, "the second route"]
    outcome: Annotated[
        Literal["exact", "verified numerically", "undecided", "singular", "FAILED"], "how certain it is that they agree"
    ]
    detail: Annotated[str, "how they were compared, or what differs, in words", ASIDE]
    states: Annotated[int | None, "at how many states they agree, where they are compared at states"]


class Equilibrium(Part, frozen=True):
    """problem 4: does the given motion satisfy the equations"""

    satisfied: Annotated[bool, "whether it does identically"]
    impossible: Annotated[bool, "whether it cannot"]
    conditions: Annotated[list[Formula], "what has to vanish besides"]
    solved: Annotated[dict[str, Formula], "parameters that the conditions fix"]


class Integral(Part, frozen=True):
    """a first integral"""

    name: Annotated[str, "its name, in words"]
    kind: Annotated[
        str,
        words(
            "generalised energy",
            "energy with the potential of the forces",
            "energy of a part",
            "cyclic momentum",
            "gyroscopic momentum",
            "momentum with the impulse of forces",
            "linear momentum",
            "angular momentum",
            "angular momentum about an axis of symmetry",
            "angular momentum about a contact",
            "speed momentum",
            "unit vectors",
            "quaternion",
            "symmetry",
            "polynomial",
        ),
        "its kind; generalised energy is T2 - T0 - U, that with the potential of the forces T2 - T0 - U - W, where "
        "dW/dq are the forces without a force function; of unit vectors the length or a product is constant, of a "
        "quaternion the norm; the last two only where problem 9 is asked for, too",
    ]
    of: Annotated[
        str,
        "the coordinate or axis; time for the energy, coordinates of a part; directions of a symmetry, weight of a "
        "polynomial",
    ]
    formula: Annotated[Formula, "I(q, q', t), constant on every motion"]
    status: Annotated[str, words("proved", "verified numerically"), "how that is known"]


class AcceptedInertia(Part, frozen=True):
    """an inertia that no body has, accepted by the description"""

    body: Annotated[str, "the body"]
    violation: Annotated[str, "the inequality that it breaks, in words"]


class Failure(Part, frozen=True):
    """why a problem has no result"""

    code: Annotated[
        str, "the kind of failure: no-closed-form, singular, withdrawn, internal-error, ...", Meta(pattern="^[a-z-]+$")
    ]
    limit: Annotated[Limit | None, "the bound that was met, if any"]
    severity: Annotated[Severity, "answer: that there is none is the answer; defect: the program is at fault"]
    reason: Annotated[str, "the reason in a sentence"]
    hint: Annotated[str, "what to try next, in a sentence; empty where nothing is known", ASIDE]


class Results(Part, frozen=True, kw_only=True):
    """Every result of mbsym run for one description. A problem that was not asked for has no property."""

    format: Format = 1
    version: Version = field(default_factory=version)
    problems: Annotated[list[Annotated[int, Meta(ge=NUMBERS[0], le=NUMBERS[-1])]], "the problems that were asked for"]
    terms: Annotated[int, "budget of terms of one closed formula", Meta(ge=1)]
    system: Described
    coordinates: Annotated[list[str], "generalised coordinates, in their order"]
    units: Annotated[
        dict[str, Annotated[str, "its unit"]] | UnsetType,
        "where the description declares units: those of t, coordinates, rates, parameters, prescribed motions and "
        "energies, by name; 1 for a pure number, nothing where a unit does not follow",
    ] = UNSET
    prescribed: Annotated[dict[str, Formula], "angles and lengths that are driven, with their rates"]
    given: Annotated[
        list[Given] | UnsetType, "free functions of time, where the description has any", told_apart_by("name")
    ] = UNSET
    motion: Annotated[
        dict[str, Motion] | UnsetType,
        "the unperturbed motion value + rate*t, by coordinate, where the description gives one",
    ] = UNSET
    initial: Annotated[
        dict[str, Annotated[Initial, Meta(extra_json_schema={"minProperties": 1})]] | UnsetType,
        "state at t = 0 for simulations, by name of a coordinate, a declared variable or a prescribed motion, as far "
        "as the description gives it",
    ] = UNSET
    inputs: Annotated[
        list[Input] | UnsetType,
        "functions of time that are chosen later, where the description has any",
        told_apart_by("name"),
    ] = UNSET
    outputs: Annotated[
        list[Output] | UnsetType, "what is measured, where the description says so", told_apart_by("name")
    ] = UNSET
    parameters: Annotated[list[Parameter], "parameters, in their order", told_apart_by("name")]
    relations: Annotated[
        dict[str, Formula] | UnsetType,
        "parameters that are functions of others, used from problem 4 on, where the description gives relations",
    ] = UNSET
    assumptions: Annotated[
        list[Assumption] | UnsetType, "what is assumed of parameters beside their signs, where anything is"
    ] = UNSET
    small_parameter: Annotated[
        SmallParameter | UnsetType, "in whose powers expansions are made, where the description names one"
    ] = UNSET
    tables: Annotated[
        list[Table] | UnsetType, "functions given by points, where the description has any", told_apart_by("name")
    ] = UNSET
    checks: Annotated[list[SelfCheck], "the self-check", told_apart_by("name")]
    kinematics: Kinematics | UnsetType = UNSET
    energy: Energy | UnsetType = UNSET
    equations: Equations | UnsetType = UNSET
    equilibrium: Equilibrium | UnsetType = UNSET
    linearisation: Linearisation | UnsetType = UNSET
    state_space: StateSpace | UnsetType = UNSET
    stability: Stability | UnsetType = UNSET
    integrals: Annotated[list[Integral] | UnsetType, "problem 7", told_apart_by("kind", "of")] = UNSET
    stabilisation: Stabilisation | UnsetType = UNSET
    normal_forms: NormalForms | UnsetType = UNSET
    accepted_inertias: Annotated[
        list[AcceptedInertia] | UnsetType, "inertias that are taken as given", told_apart_by("body")
    ] = UNSET
    claims: Annotated[list[Claim] | UnsetType, "the description's claims", told_apart_by("place", "title")] = UNSET
    ledger: Annotated[Ledger | UnsetType, ASIDE] = UNSET
    unavailable: Annotated[dict[str, Failure], "problems that were asked for and have no result, by their property"]
    reactions: Annotated[
        list[Reaction] | UnsetType,
        "what the joints that 'reactions' names transmit to their bodies, about the connection point, in the axes of "
        "the body: force + sum lambda_i force_i",
    ] = UNSET
    first_order: FirstOrder | UnsetType = UNSET
    routh: Routh | UnsetType = UNSET
    hamilton: Hamilton | UnsetType = UNSET
    brackets: Brackets | UnsetType = UNSET
    invariant_sets: InvariantSets | UnsetType = UNSET
    polynomial_integrals: PolynomialIntegrals | UnsetType = UNSET
    small_parameters: SmallParameters | UnsetType = UNSET
