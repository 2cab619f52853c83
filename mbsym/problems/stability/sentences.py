"""Words of problem 6 for every output: the one place where codes become sentences."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from mbsym.expressions.message import Message, enumerated, joined
from mbsym.formulas.formula import Formula
from mbsym.problems.stability.words import Because, Reason, Word

HIGHER_ORDER = "Terms of higher order decide."


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


def _order_decides(order: int, condition: Formula, word: Word) -> Message:
    return Message(
        "Terms of order [[order]] decide: it is [[word]] where [[condition]] > 0, and unstable where that is < 0.",
        order=order,
        word=Message(word),
        condition=condition,
    )


#: A sentence, with gaps ``[[1]]``, ... for the data, or what makes one of them.
_SENTENCES: dict[Because, str | Callable[..., Message]] = {
    Because.RIGHT_ROOTS: _to_the_right,
    Because.RIGHT_ROOT: "A root with positive real part.",
    Because.REAL_ROOT: "K is not positive semidefinite: a real positive root.",
    Because.RIGHT_BY_TRACE: (
        "Without dissipation the roots sum to zero, but they are not symmetric: some lie to the right."
    ),
    Because.DESTROYED: "Complete dissipation, and K is not positive definite.",
    Because.ODD_DEGREE: "$\\det K < 0$: an odd degree of instability.",
    Because.ODD_DEGREE_REMAINS: "$\\det K < 0$: an odd degree of instability, which gyroscopic forces cannot remove.",
    Because.COMPLETE: "$K > 0$ and complete dissipation.",
    Because.COMPLETE_BUT_CYCLIC: "Without the cyclic coordinates $K > 0$, and dissipation is complete.",
    Because.LEFT: "All roots have negative real parts.",
    Because.LEFT_BUT_CYCLIC: "All roots but the zero ones of the cyclic coordinates have negative real parts.",
    Because.TURNED_DECAYS: (
        "All roots have negative real parts but those of the steady spins about other directions of space: a "
        "disturbed motion tends to a steady spin about an axis near by, and every variable that does not change "
        "when everything is turned in space tends to its value there."
    ),
    Because.OTHER_LEAF: (
        "A disturbance that changes the relations which the integrable velocity constraints keep does not decay: the "
        "motion tends to one near by, with other values of them."
    ),
    Because.STEADY_DECAYS: (
        "All roots have negative real parts but the zero ones, which are as many as the steady motions near by have "
        "dimensions: a disturbed motion tends to one of these, and coordinates on which no equation depends may end "
        "elsewhere."
    ),
    Because.MINIMUM: "$K > 0$: the (changed) potential energy has a strict minimum.",
    Because.MINIMUM_AND_DISSIPATION: (
        "$K > 0$ and $D \\geq 0$: the energy does not grow, and the (changed) potential energy has a strict minimum."
    ),
    Because.MINIMUM_BUT_CYCLIC: (
        "Without the cyclic coordinates $K > 0$: the (changed) potential energy has a strict minimum in the others."
    ),
    Because.MINIMUM_AND_DISSIPATION_BUT_CYCLIC: (
        "Without the cyclic coordinates $K > 0$, and $D \\geq 0$: the energy does not grow, and the (changed) "
        "potential energy has a strict minimum in the others."
    ),
    Because.UNDAMPED_MOTION: "In first approximation motions of [[1]] stay undamped.",
    Because.INTEGRALS: _integrals,
    Because.INTEGRAL_HOLDS: "The potential energy is the same at every position, so that the energy keeps velocities "
    "small; an integral ([[2]]) whose value at rest varies with [[1]] keeps [[1]] near its value.",
    Because.LINEAR_BOUNDED: (
        "The equations of motion are exactly linear: no root has a positive real part, and those on the imaginary axis "
        "are semisimple, so that every disturbed motion stays near."
    ),
    Because.LINEAR_SHIFTED: (
        "The equations of motion are exactly linear: but for shifts on which they do not depend every disturbed motion "
        "stays near."
    ),
    Because.FOLLOWS_ONE: (
        "Along every motion the velocities are functions of one position (integrals of Chaplygin, without a closed "
        "form), and this position oscillates as in a system of one degree of freedom."
    ),
    Because.FOLLOWING: (
        "Along every motion the velocities are functions of one position (integrals of Chaplygin, without a closed "
        "form), and while that rests these velocities are constant."
    ),
    Because.LINEAR_GROWS: (
        "The equations of motion are exactly linear, and a multiple root on the imaginary axis is not semisimple: "
        "there are disturbances that grow like a power of t."
    ),
    Because.LINEAR_DRIFTS: (
        "Nothing grows but a uniform drift along displacements that change no equation: coordinates count here, but "
        "for that drift the motion is stable; of bodies just that is said."
    ),
    Because.LINEAR_GYROSCOPIC: (
        "K is not positive definite: gyroscopic forces alone stabilise the motion, and complete dissipation would make "
        "it unstable (Kelvin-Chetaev)."
    ),
    Because.HIGHER_MINIMUM: (
        "K is only semidefinite, but terms of order [[1]] make a strict minimum of the (changed) potential energy."
    ),
    Because.HIGHER_MINIMUM_AND_COMPLETE: (
        "K is only semidefinite, but terms of order [[1]] make a strict minimum of the (changed) potential energy, and "
        "dissipation is complete."
    ),
    Because.NO_MINIMUM: "The (changed) potential energy has no minimum: terms of order [[1]] decide.",
    Because.ENERGY_LOST: (
        "There is one coordinate, of which the (changed) potential energy has a strict minimum, and no motion near it "
        "but the rest itself keeps the energy, which never grows."
    ),
    Because.ENERGY_GAINED: (
        "There is one coordinate, of which the (changed) potential energy has a strict minimum, and no motion near it "
        "but the rest itself keeps the energy, which never falls."
    ),
    Because.NO_FORCES: (
        "The (changed) potential energy is constant, and no gyroscopic forces act: every position is one of rest, and "
        "the smallest velocity leads away from it along a geodesic."
    ),
    Because.ALONG_RESTS: (
        "Rests near by are a manifold of dimension [[1]], across which the potential energy has a strict minimum: slow "
        "motions follow its geodesics (Rubin and Ungar), and leave, however slow they are."
    ),
    Because.FEWER_CONSTRAINTS: (
        "Without the constraints on velocities the energy keeps velocities, and coordinates that are not cyclic, near "
        "the rest. They do no work: so it does with them."
    ),
    Because.TERMS_OF_HIGHER_ORDER: (
        "The first approximation leaves the nonlinear system open; terms of higher order decide."
    ),
    Because.GYROSCOPIC_ONLY: (
        "The necessary conditions hold, but K is not positive definite: the first approximation is stable by "
        "gyroscopic forces alone, complete dissipation would make it unstable (Kelvin-Chetaev), and leaves the "
        "nonlinear system open."
    ),
    Because.GYROSCOPIC_ENCLOSED: (
        "The first approximation is stable by gyroscopic forces alone, and leaves the nonlinear system open."
    ),
    Because.COINCIDENCE: (
        "Frequencies coincide (semisimple): a border of the region of gyroscopic stabilisation may be here."
    ),
    Because.NO_ENERGY: "$K > 0$, but no energy integral of the nonlinear system is known.",
    Because.NO_ENERGY_BUT_CYCLIC: (
        "Without the cyclic coordinates $K > 0$, but no energy integral of the nonlinear system is known."
    ),
    Because.IMAGINARY: "No root has a positive real part, but some are imaginary.",
    Because.IMAGINARY_SIMPLE: "All roots are imaginary and simple; the forces are not potential.",
    Because.IMAGINARY_BESIDES_TURNED: (
        "No root has a positive real part, but some are imaginary besides those of the turned steady spins."
    ),
    Because.IMAGINARY_NONHOLONOMIC: (
        "No root has a positive real part, but some are imaginary; where velocities are constrained, or equations are "
        "of first order, no theorem on energy or gyroscopic stabilisation is applied."
    ),
    Because.UNLIKE_PARTS: "Some parts are asymptotically stable, others not; no theorem that was tried covers both.",
    Because.HIGHER_ORDER: HIGHER_ORDER,
    Because.COASTING: (
        "All coordinates of this part are cyclic: their momenta are constant, so their velocities stay near theirs; "
        "the coordinates drift away if these are disturbed, so that with them counted the motion is unstable."
    ),
    Because.ALIKE: (
        "Nothing acts, and for the kinetic energy all positions are alike (each of its parts has constant curvature): "
        "displacements that change no equation lead to every position near by, as cyclic coordinates do. Velocities, "
        "measured by the kinetic energy, stay near theirs; positions drift away if they are disturbed, so that with "
        "them counted the motion is unstable."
    ),
    Because.VELOCITIES: (
        "All coordinates of this part are cyclic, and the kinetic energy of a disturbance does not grow: velocities "
        "stay near theirs."
    ),
    Because.DRIFT: (
        "This is about the other coordinates and all velocities, with respect to a part of the variables (Rumyantsev); "
        "a perturbation of the cyclic velocities can make the cyclic coordinates drift away where no dissipation stops "
        "them."
    ),
    Because.DRIFT_AT_GIVEN_MOMENTA: (
        "This is about the other coordinates at the given momenta of the cyclic ones: momenta that differ a little "
        "stay different, the motion then tends to a steady one near by, and the cyclic coordinates may drift away."
    ),
    Because.ELSEWHERE: (
        "This is about the other coordinates and all velocities, with respect to a part of the variables (Rumyantsev): "
        "these tend to theirs again, and the cyclic coordinates may end elsewhere."
    ),
    Because.DISPLACEMENTS: (
        "No equation of motion changes when coordinates move together as [[1]]: along such displacements there are "
        "cyclic coordinates."
    ),
    Because.OTHER_ANGLES: (
        "Judged in other angles of body [[1]], about axes [[2]] by [[3]], in which the same motion is steady: "
        "coordinates are these angles here."
    ),
    Because.APART: "This is about [[1]]: equations of motion that know no other coordinates are judged by themselves.",
    Because.WHILE_OTHERS_REST: (
        "This is about motions of [[1]] while all other coordinates rest: these are motions, too."
    ),
    Because.PARTLY_CYCLIC: "A part of the coordinates is cyclic.",
    Because.CONSTANT_MOMENTA: ("The momenta of cyclic coordinates are constant, so their velocities stay near theirs."),
    Because.SEE_CASES: "It depends on the parameters; see the cases.",
    Because.BORDERS_APART: ("This is so wherever no condition is an equality; border cases are left open here."),
    Because.CONDITIONS_UNWRITTEN: "Conditions are too long to be written out; see the cases.",
    Because.BORDER: "On a border: no theorem of the first approximation decides.",
    Because.ORDER_DECIDES: _order_decides,
    Because.VALUES_DECIDE: ("Terms of higher order may decide: give all parameters values, and they are looked at."),
    Because.NEAR_BORDER: "On a border, or too close to one: no theorem of the first approximation decides.",
    Because.ZERO_ROOT: "No root has a positive real part, but some are zero.",
    Because.JORDAN_BLOCK: (
        "A multiple root on the imaginary axis is not semisimple: the linear equations have growing solutions, the "
        "nonlinear system is not decided by them."
    ),
    Because.LINEAR_OPEN: (
        "The equations of motion are exactly linear: their roots decide, and at numbers they do so in every case; in "
        "symbols it is left open here."
    ),
    Because.ZERO_OR_MULTIPLE_BESIDES_TURNED: (
        "Besides the turned steady spins there are zero or multiple imaginary roots."
    ),
    Because.CYCLIC_ZERO_ROOTS: "Cyclic coordinates give zero roots, and no theorem decides about the rest.",
    Because.NOT_CLOSED: (
        "The coordinates [[1]] drop out of the first approximation, but are not shown to drop out of the nonlinear "
        "equations: terms of higher order decide."
    ),
    Because.MORE_ZERO_ROOTS: (
        "Zero roots beside those of coordinates that drop out: [[1]]; shown to be those of a family of steady motions: "
        "[[2]]. Terms of higher order decide."
    ),
    Because.NOT_ENCLOSED: "The roots could not be enclosed.",
    Because.NO_CLOSED_FORM: "No closed form within the budget: [[1]].",
    Because.ALSO_ELSEWHERE: "This is so at [[1]] = 0, and elsewhere in samples.",
    Because.DIFFERS_ALONG: "It depends on [[1]]: [[2]] at 0, [[3]] in samples elsewhere.",
    Because.NO_EQUATIONS: "[[1]]",
    Because.MASS_SINGULAR: "The mass matrix is singular.",
    Because.ORDER_LOWER: "The mass matrix is singular, so the order of the equations is lower.",
    Because.VARIES: "The first approximation varies with [[1]]; nothing is claimed.",
    Because.OTHER_BRANCH: "This is another branch of the constraints: [[1]] of them are independent there, and [[2]] "
    "where the description begins.",
    Because.RANK_LOST: "The constraints are singular there: [[1]] of them are independent, [[2]] near by.",
    Because.NOT_THE_VALUE: "The motion does not exist there: [[1]] has another value.",
    Because.MOTION_NOT_THERE: "The motion does not exist there: [[1]] = [[2]], not 0.",
    Because.MOTION_OPEN: "Whether the motion exists there is open: [[1]] is about 0.",
    Because.POLE: "The description divides by [[1]] there, which is 0: there is no motion to be judged.",
}


def sentence(reason: Reason) -> Message:
    template = _SENTENCES[reason.code]
    if not isinstance(template, str):
        return template(*reason.data)
    return Message(
        template, **{str(k): datum for k, datum in enumerate(reason.data, start=1) if f"[[{k}]]" in template}
    )


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
