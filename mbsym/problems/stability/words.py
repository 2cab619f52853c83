"""What problem 6 may say: the words for a motion, why they are said, and the theorems that say so."""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass
from enum import Enum, StrEnum, auto


class Word(StrEnum):
    """A verdict in the words that every output prints, tables and JSON included, in the order of lists."""

    ASYMPTOTIC = "asymptotically stable"
    #: A turned steady spin is a steady spin: it does not come back.
    ASYMPTOTIC_BUT_TURNED = "asymptotically stable but for a rotation of space"
    #: With cyclic coordinates nothing better can hold: they drift.
    ASYMPTOTIC_BUT_CYCLIC = "asymptotically stable but for a drift of cyclic coordinates"
    #: Steady motions of a family are near one another: what is disturbed may end in another one.
    ASYMPTOTIC_BUT_STEADY = "asymptotically stable but for a change of the steady motion"
    STABLE = "stable"
    STABLE_BUT_CYCLIC = "stable but for a drift of cyclic coordinates"
    GYROSCOPIC = "gyroscopically stabilised only"
    CRITICAL = "stable in first approximation only"
    #: No theorem applies.
    UNDECIDED = "undecided"
    #: It is different for different parameters: the cases say how.
    DEPENDS = "depends on the parameters"
    UNSTABLE = "unstable"
    #: Of no point: for all parameters but those at which some condition is an equality, which have no inner point.
    UNSTABLE_BUT_BORDERS = "unstable but for border cases"

    def __repr__(self) -> str:
        return repr(self.value)

    @property
    def asymptotic(self) -> bool:
        """Whether it says that disturbed motions come back, be it but for drift, rotation, another speed."""
        return self in (
            Word.ASYMPTOTIC,
            Word.ASYMPTOTIC_BUT_TURNED,
            Word.ASYMPTOTIC_BUT_CYCLIC,
            Word.ASYMPTOTIC_BUT_STEADY,
        )

    @property
    def stable(self) -> bool:
        """Whether it says that the motion itself is stable, be it asymptotically, or but for drift or rotation."""
        return self.asymptotic or self in (Word.STABLE, Word.STABLE_BUT_CYCLIC)

    @property
    def open(self) -> bool:
        """Whether it leaves the nonlinear system open, at one place."""
        return self in (Word.GYROSCOPIC, Word.CRITICAL, Word.UNDECIDED)


#: What each of them says.
MEANINGS = {
    Word.ASYMPTOTIC: "disturbed motions stay near and come back",
    Word.ASYMPTOTIC_BUT_TURNED: "disturbed motions stay near and come back to the same motion, turned in space",
    Word.ASYMPTOTIC_BUT_CYCLIC: (
        "everything else comes back, or to a steady motion near by where momenta were changed; cyclic "
        "coordinates may drift: asymptotic stability with respect to a part of the variables (Rumyantsev), "
        "where it comes back"
    ),
    Word.ASYMPTOTIC_BUT_STEADY: (
        "of a system with constraints on velocities, or with rests side by side: they come to a steady motion near by, "
        "of another speed "
        "or at another place"
    ),
    Word.STABLE: (
        "disturbed motions stay near, in the nonlinear system (of a system given by its matrices: these "
        "equations are all there is)"
    ),
    Word.STABLE_BUT_CYCLIC: (
        "everything else stays near, velocities measured by the kinetic energy; cyclic coordinates may drift: "
        "stability with respect to a part of the variables (Rumyantsev), not Lyapunov's with positions counted"
    ),
    Word.GYROSCOPIC: (
        "the first approximation is stable by gyroscopic forces; no theorem decides the nonlinear system"
    ),
    Word.CRITICAL: "no root is to the right; no theorem decides the nonlinear system",
    Word.UNDECIDED: "no theorem applies",
    Word.DEPENDS: "the cases are told with their conditions",
    Word.UNSTABLE: "some disturbed motions leave",
    Word.UNSTABLE_BUT_BORDERS: (
        "some disturbed motions leave wherever no condition is an equality, whatever the parameters; about the "
        "border nothing is said"
    ),
}

#: What conditions of problem 6 are called, beside the letters of coefficients, a0, a1, ... or v0, v2, ...
CONDITIONS = {
    "discriminant": (
        "of the characteristic polynomial in x = lambda^2, v_2n^(2n-2) prod (x_i - x_j)^2 over its roots: zero where "
        "two frequencies are equal. All x are real, negative and simple, which gives n frequencies, where it, the "
        "subdiscriminants and all coefficients are positive"
    ),
    "subdiscriminant": (
        "the number k is v_2n^(2k-2) times the sum of prod (x_i - x_j)^2 over all choices of k roots x = lambda^2 of "
        "the characteristic polynomial; all roots are real and simple where all of them and the discriminant are "
        "positive"
    ),
    "Hurwitz minor": (
        "the leading minor of order k of the matrix of Hurwitz of the characteristic polynomial a_n lambda^n + ... + "
        "a0. All real parts are negative where all coefficients are positive and so are the minors of orders n - 1, "
        "n - 3, ... (Lienard and Chipart)"
    ),
    "minor": (
        "the number k of a matrix is the determinant of its first k rows and columns; a symmetric matrix is positive "
        "definite where all of them are positive (Sylvester)"
    ),
}


# Why a verdict is what it is, as codes with data; ``sentences`` puts them into words.


class Because(Enum):
    """A code; what stands in brackets are its data.  The order is that in which several are told."""

    # of theorems
    RIGHT_ROOTS = auto()  # (how many)
    RIGHT_ROOT = auto()
    REAL_ROOT = auto()
    RIGHT_BY_TRACE = auto()
    DESTROYED = auto()
    ODD_DEGREE = auto()
    ODD_DEGREE_REMAINS = auto()
    COMPLETE = auto()
    COMPLETE_BUT_CYCLIC = auto()
    LEFT = auto()
    LEFT_BUT_CYCLIC = auto()
    TURNED_DECAYS = auto()
    STEADY_DECAYS = auto()
    OTHER_LEAF = auto()
    FOLLOWS_ONE = auto()
    FOLLOWING = auto()
    MINIMUM = auto()
    MINIMUM_AND_DISSIPATION = auto()
    MINIMUM_BUT_CYCLIC = auto()
    MINIMUM_AND_DISSIPATION_BUT_CYCLIC = auto()
    UNDAMPED_MOTION = auto()  # (coordinates)
    INTEGRALS = auto()  # (which)
    INTEGRAL_HOLDS = auto()  # (coordinate, integral)
    LINEAR_BOUNDED = auto()
    LINEAR_SHIFTED = auto()
    LINEAR_GROWS = auto()
    LINEAR_DRIFTS = auto()
    LINEAR_GYROSCOPIC = auto()
    HIGHER_MINIMUM = auto()  # (order)
    HIGHER_MINIMUM_AND_COMPLETE = auto()  # (order)
    NO_MINIMUM = auto()  # (order)
    ENERGY_LOST = auto()
    ENERGY_GAINED = auto()
    NO_FORCES = auto()
    ALONG_RESTS = auto()  # (dimensions)
    FEWER_CONSTRAINTS = auto()
    TERMS_OF_HIGHER_ORDER = auto()
    # of what no theorem carries
    GYROSCOPIC_ONLY = auto()
    GYROSCOPIC_ENCLOSED = auto()
    COINCIDENCE = auto()
    NO_ENERGY = auto()
    NO_ENERGY_BUT_CYCLIC = auto()
    IMAGINARY = auto()
    IMAGINARY_SIMPLE = auto()
    ZERO_ROOT = auto()
    IMAGINARY_BESIDES_TURNED = auto()
    IMAGINARY_NONHOLONOMIC = auto()
    UNLIKE_PARTS = auto()
    HIGHER_ORDER = auto()
    # of cyclic coordinates
    COASTING = auto()
    ALIKE = auto()
    VELOCITIES = auto()
    DRIFT = auto()
    DRIFT_AT_GIVEN_MOMENTA = auto()
    ELSEWHERE = auto()
    DISPLACEMENTS = auto()  # (how coordinates move together, each a text)
    OTHER_ANGLES = auto()  # (body, axes, angles)
    APART = auto()  # (coordinates)
    WHILE_OTHERS_REST = auto()  # (coordinate)
    PARTLY_CYCLIC = auto()
    CONSTANT_MOMENTA = auto()
    # of what is open
    SEE_CASES = auto()
    BORDERS_APART = auto()
    CONDITIONS_UNWRITTEN = auto()
    BORDER = auto()
    ORDER_DECIDES = auto()  # (order, whatever is positive where it is stable, word there)
    VALUES_DECIDE = auto()
    NEAR_BORDER = auto()
    JORDAN_BLOCK = auto()
    LINEAR_OPEN = auto()
    ZERO_OR_MULTIPLE_BESIDES_TURNED = auto()
    CYCLIC_ZERO_ROOTS = auto()
    NOT_CLOSED = auto()  # (coordinates)
    MORE_ZERO_ROOTS = auto()  # (zero roots, dimensions of the family)
    NOT_ENCLOSED = auto()
    NO_CLOSED_FORM = auto()  # (why)
    ALSO_ELSEWHERE = auto()  # (whatever which coordinates are)
    DIFFERS_ALONG = auto()  # (which coordinates, word, other words)
    NO_EQUATIONS = auto()  # (why)
    MASS_SINGULAR = auto()
    ORDER_LOWER = auto()
    VARIES = auto()  # (with what)
    RANK_LOST = auto()  # (rank there, rank near it)
    OTHER_BRANCH = auto()  # (rank there, lower rank elsewhere)
    NOT_THE_VALUE = auto()  # (of which parameter)
    MOTION_NOT_THERE = auto()  # (condition, value)
    MOTION_OPEN = auto()  # (condition)
    POLE = auto()  # (divisor)


#: What needs more than the first approximation, and the energy, of the whole system.
BEYOND_LINEAR = (
    Because.INTEGRALS,
    Because.INTEGRAL_HOLDS,
    Because.HIGHER_MINIMUM,
    Because.HIGHER_MINIMUM_AND_COMPLETE,
    Because.NO_MINIMUM,
    Because.ENERGY_LOST,
    Because.ENERGY_GAINED,
    Because.ALONG_RESTS,
    Because.FEWER_CONSTRAINTS,
    Because.TERMS_OF_HIGHER_ORDER,
    Because.APART,
    Because.WHILE_OTHERS_REST,
)


@dataclass(frozen=True)
class Reason:
    """A code with its data."""

    code: Because
    data: tuple[object, ...] = ()

    def __reduce__(self) -> tuple[type[Reason], tuple[Because, tuple[object, ...]]]:
        """Formulas as their text: they belong to the rings of one process."""
        return Reason, (self.code, tuple(x if isinstance(x, int | str) else str(x) for x in self.data))

    def __hash__(self) -> int:
        return hash(self.rank)

    @property
    def rank(self) -> tuple[int, tuple[str, ...]]:
        """Where it stands among other reasons."""
        return self.code.value, tuple(map(str, self.data))


# The theorems of problem 6 as values: what each needs, and what it gives.
#
# For  M x'' + (D + G) x' + (K + N) x = 0,  the first approximation of a system whose energy is, near the motion,
# x'.M x'/2 + x.K x/2 + terms of higher order:
#
# * Lagrange-Dirichlet, Routh: K > 0, N = 0, and the energy **of the nonlinear system** does not grow (it is constant,
#   or dissipative forces take it away): stable.  D >= 0 is what the first approximation shows of that; it is asked for
#   besides, and does not replace it: a Rayleigh function without quadratic terms has D = 0, whatever its sign.
# * Kelvin-Chetaev: K > 0, D > 0, N = 0: asymptotically stable; D > 0, N = 0, det K != 0, K not > 0: unstable;
#   D = N = 0 and det K < 0: unstable, whatever G is.
# * Lyapunov's first method: all roots to the left, or one to the right.
# * Lyapunov-Malkin: the roots that are not to the left are those of a family of steady motions.  Of nonholonomic
#   systems it is, with Lyapunov's first method, all there is of the first approximation: that has no Hamiltonian
#   structure, and the theorems on gyroscopic stabilisation are not about them (Neimark & Fufaev, chapter V;
#   Karapetyan).  Rests are stable, too, by an energy that has a minimum without the constraints on velocities.
# * Routh, by Chaplygin's integrals: of a nonholonomic system with one position q beside velocities w, w' = q' A(q, w)
#   and q'' = F(q, q'^2, w), w is a function of q along every motion, and what is left, q'' = f(q, q'^2), is reversed
#   with the time: a centre where q rests and its roots are imaginary (bodies of revolution that roll on a plane).
# * Lagrange-Dirichlet where K is only semidefinite: terms of higher order make a strict minimum, or none, where the
#   converse holds if the energy is constant and no gyroscopic forces act (``bundle``).
#   Of one coordinate it holds wherever the energy only falls, or only grows: what begins with less, or more, than that
#   of the rest does not come to it, and around a rest whose index is not 1 no closed orbit in the plane can be.
# * Barbashin-Krasovskii: of one coordinate, V has a strict minimum and the energy, which never grows, is constant on no
#   orbit: asymptotically stable.  Where it never falls that is so of time reversed: unstable.
# * Chetaev: a combination of integrals has a strict minimum where they keep their values (``bundle``): stable.
# * Exactly linear equations (a Penning trap, a rotating saddle, whatever is given by its matrices): their solutions are
#   known.  No root to the right and those on the axis semisimple, zero ones too: stable; a Jordan block on the axis:
#   unstable, disturbances grow like a power of t (Gantmacher, The Theory of Matrices II, chapter XIV).  There is no
#   nonlinear system that this could leave open, and x'.M x'/2 + x.K x/2 is an energy where N = 0.
#
# A theorem is named only where all its hypotheses have been shown: ``applying`` is the only way to one.


class Fact(Enum):
    """What may be shown of a subsystem, and what is presumed of the nonlinear system it belongs to."""

    MASS_POSITIVE = "M > 0"
    STIFFNESS_POSITIVE = "K > 0"
    STIFFNESS_NONSINGULAR = "det K != 0"
    STIFFNESS_NEGATIVE_SOMEWHERE = "x.K x < 0 for some x"
    STIFFNESS_ODD = "det K < 0"
    UNDAMPED = "D = 0"
    DAMPING_SEMIDEFINITE = "D >= 0"
    DAMPING_POSITIVE = "D > 0"
    NOT_GYROSCOPIC = "G = 0"
    POTENTIAL = "N = 0"
    #: Of the nonlinear system, near the motion, in all orders: not to be read off D.
    ENERGY_NEVER_GROWS = "the energy of the nonlinear system does not grow"
    ROOTS_LEFT = "Re lambda < 0 for every root"
    ROOT_RIGHT = "Re lambda > 0 for some root"
    #: The roots of the first approximation that are not to the left are those of steady spins about other directions.
    LEFT_BUT_TURNED = "Re lambda < 0 for every root but those of turned steady spins"
    #: The zero roots are as many as the steady motions near by have dimensions, all others are to the left.
    LEFT_BUT_STEADY = "Re lambda < 0 for every root but the zero ones of a family of steady motions"
    #: w' = q' A(q, w) and q'' = F(q, q'^2, w) in all orders: along every motion w is a function of the one position q.
    ONE_POSITION = "the velocities follow one position along every motion"
    #: No root to the right, and those on the imaginary axis, zero ones too, are semisimple.
    BOUNDED = "the first approximation is stable"
    #: The equations of motion are their own first approximation (``exact_linearity``).
    EXACTLY_LINEAR = "the equations of motion are exactly linear"
    JORDAN_BLOCK = "a root on the imaginary axis is not semisimple"
    #: K >= 0 has one or two null directions; terms of higher order make a strict minimum of V, or none (``bundle``).
    MINIMUM_OF_HIGHER_ORDER = "V has a strict minimum, by terms of higher order"
    NO_MINIMUM_IN_LOWEST_FORM = "the lowest terms of V, where its second derivative vanishes, have no minimum"
    NO_OTHER_FORCES = "gyroscopic forces are not there, or V is a function of one coordinate alone"
    POTENTIAL_CONSTANT = "V is the same at every position"
    ENERGY_CONSERVED = "the energy of the nonlinear system is constant"
    #: Of one coordinate, which turns nowhere.
    ONE_COORDINATE = "there is one coordinate"
    ENERGY_NEVER_FALLS = "the energy of the nonlinear system does not fall"
    ENERGY_VARIES = "the energy of the nonlinear system is constant on no orbit near the motion"
    MINIMUM_ACROSS_RESTS = "V has a strict minimum across a manifold of rests"
    #: A combination of integrals of the nonlinear system is stationary, its second variation definite where they keep
    #: their values (``bundle``): shown of the whole system, never of a subsystem.
    INTEGRALS_DEFINITE = "a combination of integrals of the nonlinear system has a strict minimum"


class Ground(Enum):
    """What carries a statement about the whole system if it holds for each of its subsystems."""

    DECAYS = auto()  # every root to the left, but for those that the flaws explain
    ENERGY = auto()  # a strict minimum of an energy that does not grow
    LINEAR = auto()  # bounded solutions of exactly linear equations
    SHIFTED = auto()  # bounded but for shifts on which the equations do not depend
    UNDAMPED = auto()  # bounded in first approximation, neither dissipation nor circulation
    IDLE = auto()  # nothing moves but at constant momenta


class HigherOrder(StrEnum):
    """The theorems of problem 11, which judge what the first approximation leaves open."""

    DEFINITE = "Dirichlet"
    FIRST = "Lyapunov's first method"
    ARNOLD_MOSER = "Arnold-Moser"
    ARNOLD_MOSER_6 = "Arnold-Moser, order 6"
    THIRD = "Markeev, resonance of third order"
    #: Of more than two degrees of freedom.
    THIRD_OF_MORE = "Markeev and Khazina, resonance of third order"
    FOURTH = "Markeev, resonance of fourth order"
    EQUAL = "Sokolskii, equal frequencies"
    #: Of equal frequencies with two eigenvectors for each root.
    EQUAL_TWO = "Sokolskii, equal frequencies with two eigenvectors"
    #: One root is zero: H has a minimum or maximum by terms of higher order; or its normal form decides.
    DEFINITE_HIGHER = "Dirichlet, by terms of higher order"
    ZERO = "Sokolskii, zero frequency"
    BRUNO = "Bruno"
    ARNOLD = "Arnold"
    REDUCTION = "Lyapunov, Pliss: centre manifold"
    NONE = ""


@dataclass(frozen=True)
class Theorem:
    """``gives`` is the ground that it lays; None: instability.  ``because``: its reason, in short."""

    name: str
    needs: frozenset[Fact]
    gives: Ground | None
    because: Because


def _theorem(name: str, gives: Ground | None, because: Because, *needs: Fact) -> Theorem:
    return Theorem(name, frozenset(needs), gives, because)


LAGRANGE = "Lagrange-Dirichlet"
ROUTH = "Routh"
KELVIN_CHETAEV = "Kelvin-Chetaev"
LYAPUNOV = "Lyapunov's first method"
MALKIN = "Lyapunov-Malkin"
CHAPLYGIN = "Routh, by Chaplygin's integrals"
CHETAEV = "Chetaev's combination of integrals"
BARBASHIN = "Barbashin-Krasovskii"
CONVERSE = "converse of Lagrange-Dirichlet"
GEODESICS = "motion along geodesics"
LINEAR = "theory of linear equations"

_PLAIN = (Fact.MASS_POSITIVE, Fact.POTENTIAL)
_MINIMUM = (*_PLAIN, Fact.STIFFNESS_POSITIVE, Fact.ENERGY_NEVER_GROWS)

#: Of several that apply and give the same, the first is named.
THEOREMS = (
    _theorem(
        KELVIN_CHETAEV,
        None,
        Because.DESTROYED,
        *_PLAIN,
        Fact.DAMPING_POSITIVE,
        Fact.STIFFNESS_NONSINGULAR,
        Fact.STIFFNESS_NEGATIVE_SOMEWHERE,
    ),
    _theorem(KELVIN_CHETAEV, None, Because.ODD_DEGREE, *_PLAIN, Fact.UNDAMPED, Fact.STIFFNESS_ODD),
    _theorem(LYAPUNOV, None, Because.RIGHT_ROOT, Fact.ROOT_RIGHT),
    _theorem(KELVIN_CHETAEV, Ground.DECAYS, Because.COMPLETE, *_PLAIN, Fact.DAMPING_POSITIVE, Fact.STIFFNESS_POSITIVE),
    _theorem(LYAPUNOV, Ground.DECAYS, Because.LEFT, Fact.ROOTS_LEFT),
    _theorem(MALKIN, Ground.DECAYS, Because.TURNED_DECAYS, Fact.LEFT_BUT_TURNED),
    _theorem(MALKIN, Ground.DECAYS, Because.STEADY_DECAYS, Fact.LEFT_BUT_STEADY),
    _theorem(LAGRANGE, Ground.ENERGY, Because.MINIMUM, *_MINIMUM, Fact.UNDAMPED, Fact.NOT_GYROSCOPIC),
    _theorem(ROUTH, Ground.ENERGY, Because.MINIMUM, *_MINIMUM, Fact.UNDAMPED),
    _theorem(
        LAGRANGE,
        Ground.ENERGY,
        Because.MINIMUM_AND_DISSIPATION,
        *_MINIMUM,
        Fact.DAMPING_SEMIDEFINITE,
        Fact.NOT_GYROSCOPIC,
    ),
    _theorem(ROUTH, Ground.ENERGY, Because.MINIMUM_AND_DISSIPATION, *_MINIMUM, Fact.DAMPING_SEMIDEFINITE),
    _theorem(LAGRANGE, Ground.ENERGY, Because.HIGHER_MINIMUM, Fact.MINIMUM_OF_HIGHER_ORDER, Fact.ENERGY_NEVER_GROWS),
    _theorem(
        KELVIN_CHETAEV,
        Ground.DECAYS,
        Because.HIGHER_MINIMUM_AND_COMPLETE,
        Fact.MINIMUM_OF_HIGHER_ORDER,
        Fact.ENERGY_NEVER_GROWS,
        Fact.DAMPING_POSITIVE,
    ),
    _theorem(
        CONVERSE, None, Because.NO_MINIMUM, Fact.NO_MINIMUM_IN_LOWEST_FORM, Fact.NO_OTHER_FORCES, Fact.ENERGY_CONSERVED
    ),
    *(
        _theorem(CONVERSE, None, Because.NO_MINIMUM, Fact.NO_MINIMUM_IN_LOWEST_FORM, Fact.ONE_COORDINATE, law)
        for law in (Fact.ENERGY_NEVER_GROWS, Fact.ENERGY_NEVER_FALLS)
    ),
    *(
        _theorem(BARBASHIN, gives, because, Fact.ONE_COORDINATE, Fact.ENERGY_VARIES, law, *minimum)
        for gives, because, law in (
            (Ground.DECAYS, Because.ENERGY_LOST, Fact.ENERGY_NEVER_GROWS),
            (None, Because.ENERGY_GAINED, Fact.ENERGY_NEVER_FALLS),
        )
        for minimum in ((Fact.MINIMUM_OF_HIGHER_ORDER,), (*_PLAIN, Fact.STIFFNESS_POSITIVE))
    ),
    # A small ball is left by every geodesic through it (Whitehead), at the constant rate sqrt(2 T).
    _theorem(GEODESICS, None, Because.NO_FORCES, Fact.POTENTIAL_CONSTANT, Fact.NOT_GYROSCOPIC, Fact.ENERGY_CONSERVED),
    # Slow motions that begin along the rests stay near them, and tend to geodesics there as they are slower.
    _theorem(
        GEODESICS,
        None,
        Because.ALONG_RESTS,
        Fact.MINIMUM_ACROSS_RESTS,
        Fact.NOT_GYROSCOPIC,
        Fact.ENERGY_CONSERVED,
    ),
    _theorem(CHAPLYGIN, Ground.ENERGY, Because.FOLLOWS_ONE, Fact.ONE_POSITION, Fact.BOUNDED),
    _theorem(CHETAEV, Ground.ENERGY, Because.INTEGRALS, Fact.INTEGRALS_DEFINITE),
    _theorem(LINEAR, Ground.LINEAR, Because.LINEAR_BOUNDED, Fact.EXACTLY_LINEAR, Fact.BOUNDED),
    _theorem(LINEAR, None, Because.LINEAR_GROWS, Fact.EXACTLY_LINEAR, Fact.JORDAN_BLOCK),
)

_IMPLIED = {
    Fact.UNDAMPED: {Fact.DAMPING_SEMIDEFINITE},
    Fact.DAMPING_POSITIVE: {Fact.DAMPING_SEMIDEFINITE},
    Fact.STIFFNESS_POSITIVE: {Fact.STIFFNESS_NONSINGULAR},
    Fact.STIFFNESS_ODD: {Fact.STIFFNESS_NONSINGULAR, Fact.STIFFNESS_NEGATIVE_SOMEWHERE},
}


def implied(shown: Set[Fact]) -> frozenset[Fact]:
    """The facts, and those that they imply."""
    every = frozenset(shown).union(*(_IMPLIED.get(fact, ()) for fact in shown))
    if every >= {Fact.EXACTLY_LINEAR, *_PLAIN, Fact.DAMPING_SEMIDEFINITE}:  # the derivative of its energy is -x'.D x'
        every |= {Fact.ENERGY_NEVER_GROWS}
    return every


def applying(shown: Set[Fact]) -> dict[Ground | None, Theorem]:
    """By what they give, the first theorem all of whose hypotheses are among the facts."""
    every = implied(shown)
    theorems: dict[Ground | None, Theorem] = {}
    for theorem in THEOREMS:
        if theorem.needs <= every:
            theorems.setdefault(theorem.gives, theorem)
    return theorems


def reason_of(theorem: Theorem) -> Reason:
    return Reason(theorem.because)
