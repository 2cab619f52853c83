"""Claims: formulas and numbers that somebody printed, each with its place, to be compared with what is derived.

A claim says that a quantity *equals* an expression, at every state or at one given state.  ``CLAIMS`` is the one table
of the kinds of claim: what each is about, and which keys it takes.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from mbsym.expressions.place import Span
from mbsym.expressions.tree import Expression

if TYPE_CHECKING:
    from mbsym.model.system import System

#: The state of a claim that is about the description's own initial state.
INITIAL_STATE = "initial"

#: Quantities whose single coefficients may be claimed.
SUMS = ("kinetic energy", "force function", "potential energy", "lagrangian")

#: What a condition may be claimed as; without a word it is either.
NECESSARY, SUFFICIENT = "necessary", "sufficient"

#: What ``of`` names.
COORDINATE, BODY, EXPRESSION, SUM = "coordinate", "body", "expression", "sum"

#: Coefficients of higher powers of a small parameter cannot be claimed.
MOST_ORDER = 6

#: What the rows and columns of a matrix count.
COORDINATES, INPUTS, OUTPUTS, STATES = "coordinates", "inputs", "outputs", "states"


@dataclass(frozen=True, slots=True)
class ClaimKind:
    """``of`` says what the key of that name holds, ``entry`` how many indices are given, ``axes`` what they count.

    ``rows`` and ``columns`` are what the indices of an entry count otherwise; with ``momenta`` it may be told in these.
    Of an expansion the ``order`` is given, and one that ``oscillates`` is told in a phase, an amplitude and constants.
    ``homogeneous`` claims say that the quantity vanishes or is constant, so that a constant factor is immaterial.
    """

    meaning: str
    of: str = ""
    entry: int = 0
    axes: bool = False
    at: bool = False
    variable: bool = False
    accelerations: bool = False
    state: bool = True
    homogeneous: bool = False
    inequality: bool = False
    rows: str = COORDINATES
    columns: str = COORDINATES
    momenta: bool = False
    order: bool = False
    oscillates: bool = False


CLAIMS: dict[str, ClaimKind] = {
    "kinetic energy": ClaimKind("T"),
    "force function": ClaimKind("U = -potential energy"),
    "potential energy": ClaimKind("-U"),
    "lagrangian": ClaimKind("L = T + U; one that differs by a total time derivative is recognised"),
    "coefficient": ClaimKind("of one product of velocities in a quantity, or in a coordinate's equation", SUM, at=True),
    "mass matrix": ClaimKind("an entry of M(q)", entry=2),
    "equation of motion": ClaimKind(
        "of a coordinate: an expression that vanishes on every motion", COORDINATE, accelerations=True, state=False,
        homogeneous=True,
    ),
    "acceleration": ClaimKind("of a coordinate: q'' = M^-1 f in coordinates, velocities and the time", COORDINATE),
    **{
        f"{which} matrix {name}": ClaimKind(f"an entry of {name} {where}", entry=2, state=False)
        for which, where in (
            ("linear", "in physical time and declared parameters"),
            ("subsystem", "in dimensionless time and the description's notation"),
        )
        for name in "MDGKN"
    },
    "linear matrix B": ClaimKind("an entry of B: a coordinate and an input", entry=2, state=False, columns=INPUTS),
    **{
        f"state matrix {name}": ClaimKind(
            f"an entry of {name} of x' = A x + B v, y = C x + D v: {rows} and {columns}",
            entry=2,
            state=False,
            rows=rows,
            columns=columns,
        )
        for name, rows, columns in (
            ("A", STATES, STATES), ("B", STATES, INPUTS), ("C", OUTPUTS, STATES), ("D", OUTPUTS, INPUTS)
        )
    },
    "hamiltonian": ClaimKind("H = p.q' - L, in coordinates and momenta (p_theta)", state=False, momenta=True),
    "momentum": ClaimKind("of a coordinate: dL/dq'", COORDINATE, state=False),
    "routh function": ClaimKind("R = L - p_c.c' without cyclic coordinates c", state=False, momenta=True),
    "reduced potential": ClaimKind("W = -R at rest of the coordinates that are left", state=False, momenta=True),
    "characteristic polynomial": ClaimKind(
        "of the subsystem with a coordinate, or of the whole system", COORDINATE, variable=True, state=False,
        homogeneous=True,
    ),
    "angular velocity": ClaimKind("of a body, a component in its own axes", BODY, 1, axes=True),
    "relative angular velocity": ClaimKind("of a body, a component in its own axes", BODY, 1, axes=True),
    "direction cosine": ClaimKind("an entry of R^jk of a body on the one it is attached to", BODY, 2, axes=True),
    "position": ClaimKind("of the mass centre of a body, a component in inertial axes", BODY, 1, axes=True),
    "velocity": ClaimKind("of the mass centre of a body, a component in inertial axes", BODY, 1, axes=True),
    "first integral": ClaimKind(
        "an expression that is constant on every motion", state=False, homogeneous=True, momenta=True
    ),
    "condition": ClaimKind("an inequality among the stability conditions", state=False, inequality=True),
    "oscillation": ClaimKind(
        "of a variable, or an expression in variables: what stands before eps^order in the periodic solution of "
        "problem 12, in its phase, amplitude and constants (amplitude, phase, r_0)",
        EXPRESSION, state=False, order=True, oscillates=True,
    ),
    "oscillation frequency": ClaimKind(
        "what stands before eps^order in the rate of the phase of that solution", state=False, order=True,
        oscillates=True,
    ),
    "slow manifold": ClaimKind(
        "of a fast variable: what stands before eps^order in it on the slow manifold of problem 12; of a slow one: in "
        "its rate there",
        COORDINATE, state=False, order=True,
    ),
    "normal form determinant": ClaimKind(
        "D_4 of problem 11, of two degrees of freedom: H_4 at I = (Omega_2, -Omega_1), up to a factor without zeros",
        state=False, homogeneous=True,
    ),
    "lyapunov coefficient": ClaimKind(
        "a of r' = d r + a r^3 of problem 11, of one pair of imaginary roots; up to a positive factor",
        state=False, homogeneous=True,
    ),
    "value": ClaimKind("of an expression at a state; it may hold accelerations", EXPRESSION, accelerations=True),
}  # fmt: skip


def index_names(kind: ClaimKind, system: System) -> tuple[tuple[str, ...], ...]:
    """What the indices of an entry count, by name; of axes, which have numbers, nothing."""
    if kind.axes:
        return ((),) * kind.entry
    names = {
        COORDINATES: system.claimable,
        STATES: (*system.coordinates, *system.velocities),
        INPUTS: system.input_names,
        OUTPUTS: tuple(output.name for output in system.outputs),
    }
    return (names[kind.rows], names[kind.columns])[: kind.entry]


@dataclass(frozen=True, slots=True)
class Abbreviation:
    """A publication's own symbol, for use in claims: ``c1 = mA + mB``.  Later ones may use earlier ones."""

    name: str
    value: Expression
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Claim:
    """``kind`` is a key of ``CLAIMS``; ``equals`` what was printed (for a condition: ``equals relation right``).

    ``of`` is the name of a coordinate, body or quantity, ``of_expression`` an expression instead; ``entry`` holds
    indices counted from 1; ``at`` a product of velocities; ``variable`` the symbol of a characteristic polynomial.
    A condition's ``role`` is necessary, sufficient (those of one place together), or "" for either.
    ``order`` is the power of a small parameter.
    ``tolerance`` (absolute) or ``digits`` (significant ones that count) say how exact a number at a state is meant.
    ``state`` gives numbers for coordinates, velocities, parameters and t (or they are those of the initial state with
    ``at_initial``), and then ``printed`` keeps a decimal number as it was printed, with its digits.
    """

    kind: str
    equals: Expression
    of: str = ""
    of_expression: Expression | None = None
    entry: tuple[int, ...] = ()
    at: Expression | None = None
    variable: str = ""
    order: int = 0
    relation: str = ""
    right: Expression | None = None
    role: str = ""
    at_initial: bool = False
    state: tuple[tuple[str, Expression], ...] = ()
    printed: str = ""
    tolerance: Expression | None = None
    digits: int = 0
    place: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def is_numerical(self) -> bool:
        """Whether it is about numbers at one state."""
        return self.at_initial or bool(self.state)
