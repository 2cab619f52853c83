"""What problem 6 may say: the words for a motion, why they are said, and the theorems that say so."""

from __future__ import annotations

from collections.abc import Iterable, Sequence, Set
from dataclasses import dataclass
from enum import Enum, StrEnum, auto, member, unique

from mbsym.expressions.message import Code, Message, enumerated, joined


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


# Why a verdict is what it is, as codes with data.


def _to_the_right(number: int) -> Message:
    if number == 1:
        return Message("1 root with positive real part.")
    return Message("[[count]] roots with positive real part.", count=number)


def _integrals(*names: str) -> Message:
    if not names:
        return Message(
            "A combination of first integrals is stationary, and its second variation is definite where they keep "
            "their values: it makes a Lyapunov function of the nonlinear system."
        )
    return Message(
        "A combination of integrals ([[names]]) is stationary, and its second variation is definite where they keep "
        "their values: it makes a Lyapunov function of the nonlinear system.",
        names=enumerated(names),
    )


@unique
class Because(Code):
    """A code; what stands in brackets are its data.  The order is that in which several are told."""

    # of theorems
    RIGHT_ROOTS = member(_to_the_right)  # (how many)
    RIGHT_ROOT = "A root with positive real part."
    REAL_ROOT = "K is not positive semidefinite: a real positive root."
    RIGHT_BY_TRACE = "Without dissipation the roots sum to zero, but they are not symmetric: some lie to the right."
    DESTROYED = "Complete dissipation, and K is not positive definite."
    ODD_DEGREE = "$\\det K < 0$: an odd degree of instability."
    ODD_DEGREE_REMAINS = "$\\det K < 0$: an odd degree of instability, which gyroscopic forces cannot remove."
    COMPLETE = "$K > 0$ and complete dissipation."
    COMPLETE_BUT_CYCLIC = "Without the cyclic coordinates $K > 0$, and dissipation is complete."
    LEFT = "All roots have negative real parts."
    LEFT_BUT_CYCLIC = "All roots but the zero ones of the cyclic coordinates have negative real parts."
    TURNED_DECAYS = (
        "All roots have negative real parts but those of the steady spins about other directions of space: a disturbed "
        "motion tends to a steady spin about an axis near by, and every variable that does not change when everything "
        "is turned in space tends to its value there."
    )
    STEADY_DECAYS = (
        "All roots have negative real parts but the zero ones, which are as many as the steady motions near by have "
        "dimensions: a disturbed motion tends to one of these, and coordinates on which no equation depends may end "
        "elsewhere."
    )
    OTHER_LEAF = (
        "A disturbance that changes the relations which the integrable velocity constraints keep does not decay: the "
        "motion tends to one near by, with other values of them."
    )
    FOLLOWS_ONE = (
        "Along every motion the velocities are functions of one position (integrals of Chaplygin, without a closed "
        "form), and this position oscillates as in a system of one degree of freedom."
    )
    FOLLOWING = (
        "Along every motion the velocities are functions of one position (integrals of Chaplygin, without a closed "
        "form), and while that rests these velocities are constant."
    )
    MINIMUM = "$K > 0$: the (changed) potential energy has a strict minimum."
    MINIMUM_AND_DISSIPATION = (
        "$K > 0$ and $D \\geq 0$: the energy does not grow, and the (changed) potential energy has a strict minimum."
    )
    MINIMUM_BUT_CYCLIC = (
        "Without the cyclic coordinates $K > 0$: the (changed) potential energy has a strict minimum in the others."
    )
    MINIMUM_AND_DISSIPATION_BUT_CYCLIC = (
        "Without the cyclic coordinates $K > 0$, and $D \\geq 0$: the energy does not grow, and the (changed) "
        "potential energy has a strict minimum in the others."
    )
    UNDAMPED_MOTION = "In first approximation motions of [[1]] stay undamped."  # (coordinates)
    INTEGRALS = member(_integrals)  # (which)
    INTEGRAL_HOLDS = (  # (coordinate, integral)
        "The potential energy is the same at every position, so that the energy keeps velocities small; an integral "
        "([[2]]) whose value at rest varies with [[1]] keeps [[1]] near its value."
    )
    LINEAR_BOUNDED = (
        "The equations of motion are exactly linear: no root has a positive real part, and those on the imaginary axis "
        "are semisimple, so that every disturbed motion stays near."
    )
    LINEAR_SHIFTED = (
        "The equations of motion are exactly linear: but for shifts on which they do not depend every disturbed motion "
        "stays near."
    )
    LINEAR_GROWS = (
        "The equations of motion are exactly linear, and a multiple root on the imaginary axis is not semisimple: "
        "there are disturbances that grow like a power of t."
    )
    LINEAR_DRIFTS = (
        "Nothing grows but a uniform drift along displacements that change no equation: coordinates count here, but "
        "for that drift the motion is stable; of bodies just that is said."
    )
    LINEAR_GYROSCOPIC = (
        "K is not positive definite: gyroscopic forces alone stabilise the motion, and complete dissipation would make "
        "it unstable (Kelvin-Chetaev)."
    )
    HIGHER_MINIMUM = (  # (order)
        "K is only semidefinite, but terms of order [[1]] make a strict minimum of the (changed) potential energy."
    )
    HIGHER_MINIMUM_AND_COMPLETE = (  # (order)
        "K is only semidefinite, but terms of order [[1]] make a strict minimum of the (changed) potential energy, and "
        "dissipation is complete."
    )
    NO_MINIMUM = "The (changed) potential energy has no minimum: terms of order [[1]] decide."  # (order)
    ENERGY_LOST = (
        "There is one coordinate, of which the (changed) potential energy has a strict minimum, and no motion near it "
        "but the rest itself keeps the energy, which never grows."
    )
    ENERGY_GAINED = (
        "There is one coordinate, of which the (changed) potential energy has a strict minimum, and no motion near it "
        "but the rest itself keeps the energy, which never falls."
    )
    NO_FORCES = (
        "The (changed) potential energy is constant, and no gyroscopic forces act: every position is one of rest, and "
        "the smallest velocity leads away from it along a geodesic."
    )
    ALONG_RESTS = (  # (dimensions)
        "Rests near by are a manifold of dimension [[1]], across which the potential energy has a strict minimum: slow "
        "motions follow its geodesics (Rubin and Ungar), and leave, however slow they are."
    )
    FEWER_CONSTRAINTS = (
        "Without the constraints on velocities the energy keeps velocities, and coordinates that are not cyclic, near "
        "the rest. They do no work: so it does with them."
    )
    TERMS_OF_HIGHER_ORDER = "The first approximation leaves the nonlinear system open; terms of higher order decide."
    # of what no theorem carries
    GYROSCOPIC_ONLY = (
        "The necessary conditions hold, but K is not positive definite: the first approximation is stable by "
        "gyroscopic forces alone, complete dissipation would make it unstable (Kelvin-Chetaev), and leaves the "
        "nonlinear system open."
    )
    GYROSCOPIC_ENCLOSED = (
        "The first approximation is stable by gyroscopic forces alone, and leaves the nonlinear system open."
    )
    COINCIDENCE = "Frequencies coincide (semisimple): a border of the region of gyroscopic stabilisation may be here."
    NO_ENERGY = "$K > 0$, but the energy of the whole nonlinear system is not known to be kept or to fall."
    NO_ENERGY_BUT_CYCLIC = (
        "Without the cyclic coordinates $K > 0$, but the energy of the whole nonlinear system is not known to be kept "
        "or to fall."
    )
    IMAGINARY = "No root has a positive real part, but some are imaginary."
    IMAGINARY_SIMPLE = "All roots are imaginary and simple; the forces are not potential."
    ZERO_ROOT = "No root has a positive real part, but some are zero."
    IMAGINARY_BESIDES_TURNED = (
        "No root has a positive real part, but some are imaginary besides those of the turned steady spins."
    )
    IMAGINARY_NONHOLONOMIC = (
        "No root has a positive real part, but some are imaginary; where velocities are constrained, or equations are "
        "of first order, no theorem on energy or gyroscopic stabilisation is applied."
    )
    UNLIKE_PARTS = "Some parts are asymptotically stable, others not; no theorem that was tried covers both."
    HIGHER_ORDER = "Terms of higher order decide."
    # of cyclic coordinates
    COASTING = (
        "All coordinates of this part are cyclic: their momenta are constant, so their velocities stay near theirs; "
        "the coordinates drift away if these are disturbed, so that with them counted the motion is unstable."
    )
    ALIKE = (
        "Nothing acts, and for the kinetic energy all positions are alike (each of its parts has constant curvature): "
        "displacements that change no equation lead to every position near by, as cyclic coordinates do. Velocities, "
        "measured by the kinetic energy, stay near theirs; positions drift away if they are disturbed, so that with "
        "them counted the motion is unstable."
    )
    VELOCITIES = (
        "All coordinates of this part are cyclic, and the kinetic energy of a disturbance does not grow: velocities "
        "stay near theirs."
    )
    DRIFT = (
        "This is about the other coordinates and all velocities, with respect to a part of the variables (Rumyantsev); "
        "a perturbation of the cyclic velocities can make the cyclic coordinates drift away where no dissipation stops "
        "them."
    )
    DRIFT_AT_GIVEN_MOMENTA = (
        "This is about the other coordinates at the given momenta of the cyclic ones: momenta that differ a little "
        "stay different, the motion then tends to a steady one near by, and the cyclic coordinates may drift away."
    )
    ELSEWHERE = (
        "This is about the other coordinates and all velocities, with respect to a part of the variables (Rumyantsev): "
        "these tend to theirs again, and the cyclic coordinates may end elsewhere."
    )
    DISPLACEMENTS = (  # (how coordinates move together, each a text)
        "No equation of motion changes when coordinates move together as [[1]]: along such displacements there are "
        "cyclic coordinates."
    )
    OTHER_ANGLES = (  # (body, axes, angles)
        "Judged in other angles of body [[1]], about axes [[2]] by [[3]], in which the same motion is steady: "
        "coordinates are these angles here."
    )
    APART = (  # (coordinates)
        "This is about [[1]]: equations of motion that know no other coordinates are judged by themselves."
    )
    WHILE_OTHERS_REST = (  # (coordinate)
        "This is about motions of [[1]] while all other coordinates rest: these are motions, too."
    )
    PARTLY_CYCLIC = "A part of the coordinates is cyclic."
    CONSTANT_MOMENTA = "The momenta of cyclic coordinates are constant, so their velocities stay near theirs."
    # of what is open
    SEE_CASES = "It depends on the parameters; see the cases."
    BORDERS_APART = "This is so wherever no condition is an equality; border cases are left open here."
    CONDITIONS_UNWRITTEN = "Conditions are too long to be written out; see the cases."
    BORDER = "On a border: no theorem of the first approximation decides."
    VALUES_DECIDE = "Terms of higher order may decide: give all parameters values, and they are looked at."
    NEAR_BORDER = "On a border, or too close to one: no theorem of the first approximation decides."
    JORDAN_BLOCK = (
        "A multiple root on the imaginary axis is not semisimple: the linear equations have growing solutions, the "
        "nonlinear system is not decided by them."
    )
    LINEAR_OPEN = (
        "The equations of motion are exactly linear: their roots decide, and at numbers they do so in every case; in "
        "symbols it is left open here."
    )
    ZERO_OR_MULTIPLE_BESIDES_TURNED = "Besides the turned steady spins there are zero or multiple imaginary roots."
    CYCLIC_ZERO_ROOTS = "Cyclic coordinates give zero roots, and no theorem decides about the rest."
    NOT_CLOSED = (  # (coordinates)
        "The coordinates [[1]] drop out of the first approximation, but are not shown to drop out of the nonlinear "
        "equations: terms of higher order decide."
    )
    MORE_ZERO_ROOTS = (  # (zero roots, dimensions of the family)
        "Zero roots beside those of coordinates that drop out: [[1]]; shown to be those of a family of steady motions: "
        "[[2]]. Terms of higher order decide."
    )
    NOT_ENCLOSED = "The roots could not be enclosed."
    NO_CLOSED_FORM = "No closed form within the budget: [[1]]."  # (why)
    ALSO_ELSEWHERE = "This is so at [[1]] = 0, and elsewhere in samples."  # (whatever which coordinates are)
    DIFFERS_ALONG = (  # (which coordinates, word, other words)
        "It depends on [[1]]: [[2]] at 0, [[3]] in samples elsewhere."
    )
    NO_EQUATIONS = "[[1]]"  # (why)
    MASS_SINGULAR = "The mass matrix is singular."
    ORDER_LOWER = "The mass matrix is singular, so the order of the equations is lower."
    VARIES = "The first approximation varies with [[1]]; nothing is claimed."  # (with what)
    RANK_LOST = (  # (rank there, rank near it)
        "The constraints are singular there: [[1]] of them are independent, [[2]] near by."
    )
    OTHER_BRANCH = (  # (rank there, lower rank elsewhere)
        "This is another branch of the constraints: [[1]] of them are independent there, and [[2]] where the "
        "description begins."
    )
    NOT_THE_VALUE = "The motion does not exist there: [[1]] has another value."  # (of which parameter)
    MOTION_NOT_THERE = "The motion does not exist there: [[1]] = [[2]], not 0."  # (condition, value)
    MOTION_OPEN = "Whether the motion exists there is open: [[1]] is about 0."  # (condition)
    POLE = "The description divides by [[1]] there, which is 0: there is no motion to be judged."  # (divisor)


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
        return _ORDER[self.code], tuple(map(str, self.data))


_ORDER = {code: place for place, code in enumerate(Because)}


def sentence(reason: Reason) -> Message:
    return reason.code.said(*reason.data)


def explanation(reasons: Iterable[Reason]) -> Message:
    """The reasons, one sentence after another."""
    return joined(map(sentence, reasons))


def with_theorem(word: str, theorems: Sequence[str]) -> Message:
    """``stable (Routh)``."""
    said = Message(word)
    if not theorems:
        return said
    return Message("[[word]] ([[theorems]])", word=said, theorems=named(theorems))


def named(theorems: Sequence[str]) -> Message:
    """The names of theorems."""
    return joined(map(Message, theorems), ", ")


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
