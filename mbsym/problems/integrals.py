"""Problem 7: first integrals.

An expression I(q, q', t) is an integral if dI/dt vanishes by virtue of the equations E_i = (M q'' - f)_i = 0.
Found are

* the generalised energy  H = T_2 - T_0 - U,  with  dH/dt = sum q'_i E_i  if L does not contain the time and the other
  loads do no work;
* where these forces are the gradient of a function W(q) that has a closed form, T_2 - T_0 - U - W; of one coordinate
  every force that depends on it alone is: m(x) x'' + m'(x) x'^2/2 = Q(x) has an energy; so have, with T_2 - W, the
  motions in a frame whose acceleration is constant, whatever T_0 and U hold of the time;
* a cyclic momentum  p_i = dT/dq'_i,  with  dp_i/dt = E_i,  for every coordinate that L and Q_i do not contain;
* components of the linear and angular momentum in inertial axes that are conserved but are no combination of the
  above: candidates are tried at exact rational states, and proved through multipliers, dI/dt = sum mu_i E_i with
  mu = M^-1 dI/dq', where these are linear in q and q' (found by fitting) or M is small enough to be inverted;
* the angular momentum of a body that carries no other about an axis of symmetry in it, on which its mass centre lies;
* of systems that consist of parts which do not know each other, the energy of each whose momenta are not all constant;
* such a momentum less W(q), if the forces that change it are dW/dt: m x' - q B y of a magnetic field, m x' + c x of a
  damper.

Where a formula outgrows its budget, the energy and cyclic momenta that follow from the structure of the equations alone
are named without one.

``status`` is "proved" (an identity of the ring) or "verified numerically" (at random states: exactly
where they are rational, else by narrow balls around zero).

Source: Banshchikov & Vetrov (first integrals); the generalised energy is Jacobi's.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/spring-pendulum.yaml")
    >>> [(integral.name, integral.status) for integral in pendulum.integrals]
    [('generalised energy', 'proved')]
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any

from flint import arb, arb_mat, ctx, fmpq_mat

from mbsym.algebra.antiderivative import potential
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NOT_THERE, Failure, NotRational
from mbsym.algebra.kernel import kernel
from mbsym.algebra.matrices import adjugate, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.vectors import axis_vector
from mbsym.expressions.message import Message, worded
from mbsym.expressions.tree import names
from mbsym.formulas.formula import Formula, Shown
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.programs import Programs, accelerated
from mbsym.mechanics.states import are_met, ball_states, rational_states
from mbsym.mechanics.variables import expressions
from mbsym.model.constraints import Rolling
from mbsym.model.system import INERTIAL, System, acceleration_name
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations, convective_rate, separate

#: T_2 - T_0 - U.  The energy T - U is the same where nothing moves as prescribed.
ENERGY = "generalised energy"

#: T_2 - T_0 - U - W, where the forces without a force function have one after all: Q = dW/dq.
WITH_FORCES = "energy with the potential of the forces"
ENERGIES = (ENERGY, WITH_FORCES)

#: The energy of coordinates whose equations know no others.
OF_A_PART = "energy of a part"

#: A momentum less W, where forces that do no work together change it by dW/dt; where forces do that do work.
GYROSCOPIC, WITH_IMPULSE = "gyroscopic momentum", "momentum with the impulse of forces"

#: C omega + h along an axis of symmetry of a body.
AXIAL = "angular momentum about an axis of symmetry"

#: H_P = H - r_P x P about the place P where a body rolls on another.
ABOUT_CONTACT = "angular momentum about a contact"

#: Working precision of balls, in bits.
PRECISION = 256
#: States at which a candidate must be conserved exactly before it is reported.
STATES = 4
#: Multipliers through adj(M) are tried up to this size of M and of the candidate.
MOST_COORDINATES, MOST_TERMS = 3, 400


@dataclass(frozen=True, repr=False)
class Integral(Shown):
    """``kind``: one of those above, or cyclic, linear, angular momentum; ``of``: coordinates or an axis."""

    name: str
    kind: str
    of: str
    formula: Formula
    status: Certainty

    def __post_init__(self) -> None:
        object.__setattr__(self, "name", worded(self.name))


def identifiers(first_integrals: Iterable[Integral], taken: Iterable[str] = ()) -> list[str]:
    """A name for each in letters, digits, underscores, none twice: ``momentum_psi``, ``generalized_energy``.

    None of them is ``taken``.
    """
    used, named = set(taken), []
    for integral in first_integrals:
        short = integral.kind.removeprefix("cyclic ")
        stem = f"{short}_{integral.of}".replace(" ", "_") if integral.kind != ENERGY else "generalized_energy"
        name, count = stem, 2
        while name in used:
            name, count = f"{stem}_{count}", count + 1
        used.add(name)
        named.append(name)
    return named


def integrals(scene: Scene, energy: Energy, equations: Equations, programs: Programs) -> tuple[Integral, ...]:
    """All first integrals of the kinds above (scene over the ring); ``programs`` is used to rule candidates out."""
    energies = [*_generalised_energy(scene, energy, equations)]
    idle = any(item.name == ENERGY for item in energies)
    momenta = [*_cyclic_momenta(scene, energy, equations, idle)]
    constant = {item.of for item in momenta if item.kind == "cyclic momentum"}
    known = [item.formula.polynomial for item in energies]
    for item in _energies_of_parts(scene, energy, equations):
        if _is_new(scene.ring, item.formula.polynomial, known):
            known.append(item.formula.polynomial)
            energies += [] if {*item.of.split()} <= constant else [item]  # else by its momenta
    first_integrals = [item for item in (*energies, *momenta) if varies(scene, item.formula.polynomial)]
    conserved = _constant_momenta(scene.system, scene.ring, programs)
    first_integrals += _momenta(
        scene, equations, conserved, [item.formula.polynomial for item in first_integrals if item not in energies]
    )
    momenta = [item.formula.polynomial for item in first_integrals if item not in energies]
    first_integrals += _axial_momenta(scene, equations, programs, momenta)
    if not all(load.conservative for load in scene.system.loads):
        known = [item.formula.polynomial for item in first_integrals if item not in energies]
        first_integrals += _momenta_with_a_share(scene, equations, conserved, known, idle)
    return tuple(first_integrals)


def varies(scene: Scene, x: Polynomial) -> bool:
    """Whether x depends on the state: what is the same at all states, as a momentum without inertia, says nothing."""
    return bool(scene.ring.dependencies(x, (*scene.system.coordinates, *scene.system.velocities)))


def by_structure(system: System, programs: Programs) -> tuple[str, ...]:
    """What is conserved for reasons that need no closed formula, in words; all loads must have force functions.

    The energy T - U, if nothing depends on the time, and the momentum dL/dq' of every coordinate that the straight-line
    program of L = T + U does not read.  Sufficient: a coordinate may drop out only when formulas are simplified.
    """
    if not all(load.conservative for load in system.loads):
        return ()
    names_used = {name for expression in expressions(system) for name in names(expression)}
    rates = {*system.velocities, *(acceleration_name(name) for name in system.coordinates)}
    conserved = []
    if not system.prescribed and "t" not in names_used and not names_used & rates:
        conserved.append("the energy T - U")
    program = programs.program
    live = program.live([programs.kinetic_energy, programs.force_function])
    read = {str(x.payload) for x in map(program.instructions.__getitem__, live) if x.operation == "input"}
    if not names_used & rates:
        pairs = zip(system.coordinates, system.velocities, strict=True)
        # What L does not read at all has no inertia: its momentum is zero.
        conserved += [
            Message("the momentum of [[name]]", name=name) for name, rate in pairs if name not in read and rate in read
        ]
    return tuple(conserved)


def total_rate(scene: Scene, x: Polynomial) -> Polynomial:
    """dx/dt with the accelerations q'' as they stand."""
    ring = scene.ring
    total = convective_rate(scene, ring, x)
    for name in scene.system.coordinates:
        total = total + ring.generator("acceleration", name) * ring.velocity_derivative(x, name)
    return ring.reduce(total)


def _generalised_energy(scene: Scene, energy: Energy, equations: Equations) -> Iterator[Integral]:
    ring, names = scene.ring, scene.system.coordinates
    integral = _jacobi(scene, energy)
    speeds = [ring.generator("velocity", name) for name in names]
    momenta = [ring.velocity_derivative(energy.kinetic_energy.polynomial, name) for name in names]
    squares = [[ring.velocity_derivative(x, name) for name in names] for x in momenta]
    half = ring.number(Fraction(1, 2))
    for whole in (integral, ring.times(half, ring.dot(speeds, [ring.dot(row, speeds) for row in squares]))):
        formula = _with_work(scene, equations, whole, names)
        if formula is not None:
            kind = ENERGY if formula == whole == integral else WITH_FORCES
            yield Integral(kind, kind, "time", Formula(ring, formula), Certainty.PROVED)
            return


def _jacobi(scene: Scene, energy: Energy) -> Polynomial:
    """T_2 - T_0 - U."""
    ring, kinetic = scene.ring, energy.kinetic_energy.polynomial
    momenta = [ring.velocity_derivative(kinetic, name) for name in scene.system.coordinates]
    power = ring.dot(momenta, [ring.generator("velocity", name) for name in scene.system.coordinates])
    return ring.reduce(power - kinetic - energy.force_function.polynomial)


def _with_work(scene: Scene, equations: Equations, whole: Polynomial, of: Sequence[str]) -> Polynomial | None:
    """An energy of coordinates, less what forces without a force function have done; None if that is not constant."""
    ring, names = scene.ring, scene.system.coordinates
    rows = {name: x.polynomial for name, x in zip(names, equations.equalities(names), strict=True)}
    speeds = [ring.generator("velocity", name) for name in of]
    power = ring.reduce(total_rate(scene, whole) - ring.dot(speeds, [rows[name] for name in of]))
    if ring.is_zero(power):
        return whole
    work = _work(scene, power)
    return None if work is None else ring.reduce(whole - work)


def _energies_of_parts(scene: Scene, energy: Energy, equations: Equations) -> Iterator[Integral]:
    """T_2 - T_0 - U of coordinates whose equations know no others, where there are such parts."""
    ring, names = scene.ring, scene.system.coordinates
    every = (*names, *scene.system.velocities)
    owner = dict(zip(every, (*names, *names), strict=True))
    parts = separate(scene, equations)
    if len(parts) == 1:
        return
    shares = [ring.zero for _ in parts]
    for monomial, coefficient in _jacobi(scene, energy).to_dict().items():
        term = ring.context.from_dict({monomial: coefficient})
        knowing = {owner[x] for x in ring.dependencies(term, every)}
        at = [k for k, part in enumerate(parts) if knowing & {*part}]
        if len(at) > 1:
            return
        for k in at:
            shares[k] = shares[k] + term
    for part, share in zip(parts, shares, strict=True):
        formula = _with_work(scene, equations, share, part)
        if formula is not None:
            title = Message("energy of [[names]]", names=", ".join(part))
            yield Integral(title, OF_A_PART, " ".join(part), Formula(ring, formula), Certainty.PROVED)


def _work(scene: Scene, power: Polynomial) -> Polynomial | None:
    """W(q) with dW/dt = ``power``: what the forces without a force function have done; None where there is none.

    Of one coordinate there is always one where the force depends on it alone, if only in closed form or not.
    """
    ring, coordinates = scene.ring, scene.system.coordinates
    try:
        field = [ring.velocity_derivative(power, name) for name in coordinates]
        running = (*scene.system.velocities, *(x.name for x in scene.system.prescribed), *scene.system.input_names, "t")
        speeds = [ring.generator("velocity", name) for name in coordinates]
        if any(ring.dependencies(x, running) for x in field) or not ring.is_zero(power - ring.dot(speeds, field)):
            return None
        return potential(ring, field, coordinates)
    except Failure:
        return None


def _cyclic_momenta(scene: Scene, energy: Energy, equations: Equations, idle: bool) -> Iterator[Integral]:
    """``idle``: the forces without a force function do no work together."""
    ring, names = scene.ring, scene.system.coordinates
    for i, name in enumerate(names):
        momentum = ring.velocity_derivative(energy.kinetic_energy.polynomial, name)
        if name not in energy.cyclic:
            continue
        force = ring.reduce(total_rate(scene, momentum) - equations.equality(i, names).polynomial)
        kind, title, share = "cyclic momentum", Message("momentum of [[name]]", name=name), ring.zero
        if not ring.is_zero(force):
            work = _work(scene, force)
            if work is None:
                continue
            share = work
            kind, title = _with_share(title, idle)
        yield Integral(title, kind, name, Formula(ring, ring.reduce(momentum - share)), Certainty.PROVED)


def _with_share(momentum: Message, idle: bool) -> tuple[str, Message]:
    """The kind of a momentum less W, and what it is called."""
    if idle:
        return GYROSCOPIC, Message("[[momentum]] with the share of gyroscopic forces", momentum=momentum)
    return WITH_IMPULSE, Message("[[momentum]] with the impulse of forces", momentum=momentum)


# --- momenta of the whole system ---


def _constant_momenta(system: System, ring: Ring, programs: Programs) -> set[tuple[str, int]]:
    """The (kind, axis) of momenta whose rate vanishes at one random state: what has to be looked at closely.

    Rates of momentum are known as numbers, in inertial axes, so that no formula is formed for nothing.
    """
    for state in _states_in_motion(system, ring, programs):
        try:
            forces, moments = Oracle(system, state).momentum_rates[INERTIAL]
        except NOT_THERE:
            continue
        rates = {("linear momentum", i + 1): x for i, x in enumerate(forces)}
        rates |= {("angular momentum", i + 1): x for i, x in enumerate(moments)}
        return {key for key, x in rates.items() if _may_vanish(x)}
    return set()


def _states_in_motion(system: System, ring: Ring, programs: Programs) -> Iterator[State]:
    """Random states with the accelerations there: rational ones, then those of balls."""
    for states in (rational_states(system, ring, STATES), ball_states(system, ring, STATES)):
        for state in states:
            with suppress(*NOT_THERE):
                yield accelerated(system, state, programs)


def _may_vanish(x: Any) -> bool:
    return bool(x.contains(0) if isinstance(x, arb) else x == 0)


def _momenta(
    scene: Scene, equations: Equations, conserved: set[tuple[str, int]], known: Sequence[Polynomial]
) -> list[Integral]:
    momenta: list[Integral] = []
    if not conserved:
        return momenta
    try:
        for kind, axis, formula in whole_momenta(scene):
            others = [*known, *(item.formula.polynomial for item in momenta)]
            candidate = (kind, axis) in conserved and _is_new(scene.ring, formula, others)
            if candidate and is_conserved(scene, equations, formula):
                status = Certainty.PROVED if is_proved(scene, equations, formula) else Certainty.VERIFIED
                if status is Certainty.VERIFIED and (scene.ring.kinked or not are_met(scene.system, scene.ring)):
                    continue  # a force that comes late vanishes at every state before, a difference where it is told
                momenta.append(
                    Integral(momentum_title(kind, axis), kind, str(axis), Formula(scene.ring, formula), status)
                )
    except Failure:
        pass  # what was found so far is right; the rest is not known
    return momenta


def _axial_momenta(
    scene: Scene, equations: Equations, programs: Programs, known: Sequence[Polynomial]
) -> list[Integral]:
    """Those that are proved, and no combinations of others; none is proved whose rate differs from zero at a state."""
    ring = scene.ring
    found: list[Integral] = []
    state = next(_states_in_motion(scene.system, ring, programs), None)
    carry = None if state is None else Carrier(ring, state.numbers, state.values)
    carrying = {body.attached_to for body in scene.system.bodies}
    try:
        for name, motion in scene.motions.items():
            if motion.inertia is None or name in carrying:
                continue
            rows, centre = motion.inertia.rows, motion.mass_centre
            for k, (i, j) in enumerate(((1, 2), (0, 2), (0, 1))):
                apart = (rows[i][i] - rows[j][j], rows[i][j], rows[i][k], rows[j][k], centre[i], centre[j])
                if not all(ring.is_zero(ring.reduce(x)) is True for x in apart):
                    continue
                momentum = ring.times(rows[k][k], motion.angular_velocity[k])
                if motion.gyrostatic_moment is not None:
                    momentum = momentum + motion.gyrostatic_moment[k]
                momentum = ring.reduce(momentum)
                others = [*known, *(item.formula.polynomial for item in found)]
                if (
                    varies(scene, momentum)
                    and _may_be_conserved(scene, momentum, carry)
                    and _is_new(ring, momentum, others)
                    and is_proved(scene, equations, momentum)
                ):
                    title = Message("angular momentum of [[body]] about its axis [[axis]]", body=name, axis=k + 1)
                    of = f"{name} {k + 1}"
                    found.append(Integral(title, AXIAL, of, Formula(ring, momentum), Certainty.PROVED))
    except Failure:
        pass  # what was found so far is right; the rest is not known
    return found


def _may_be_conserved(scene: Scene, x: Polynomial, carry: Carrier | None) -> bool:
    """Whether dx/dt is zero, or has no value, at the state in motion that ``carry`` puts in."""
    try:
        return carry is None or _may_vanish(carry(total_rate(scene, x)))
    except NOT_THERE:
        return True


def _momenta_with_a_share(
    scene: Scene,
    equations: Equations,
    conserved: set[tuple[str, int]],
    known: Sequence[Polynomial],
    idle: bool,
) -> list[Integral]:
    """Momenta of the whole system less W, where what is left of their rates by the equations is dW/dt, W(q)."""
    ring, names = scene.ring, scene.system.coordinates
    found: list[Integral] = []
    try:
        for kind, axis, formula in whole_momenta(scene):
            multipliers = None if (kind, axis) in conserved else _simple_multipliers(scene, equations, formula)
            if multipliers is None:
                continue
            rate = total_rate(scene, formula)
            for i, multiplier in enumerate(multipliers):
                if not multiplier.is_zero():
                    rate = rate - ring.times(multiplier, equations.equality(i, names).polynomial)
            rate = ring.reduce(rate)
            work = None if ring.is_zero(rate) else _work(scene, rate)
            others = [*known, *(item.formula.polynomial for item in found)]
            if work is None or not _is_new(ring, whole := ring.reduce(formula - work), others):
                continue
            sort, title = _with_share(momentum_title(kind, axis), idle)
            of = f"{kind.removesuffix(' momentum')} {axis}"
            found.append(Integral(title, sort, of, Formula(ring, whole), Certainty.PROVED))
    except Failure:
        pass  # what was found so far is right; the rest is not known
    return found


def momentum_title(kind: str, axis: int) -> Message:
    """What a component of a momentum of the whole system is called."""
    if kind == "angular momentum":
        return Message("angular momentum about axis [[axis]]", axis=axis)
    return Message("linear momentum along axis [[axis]]", axis=axis)


def whole_momenta(scene: Scene) -> list[tuple[str, int, Any]]:
    """(kind, axis, component) of sum m V_C and of sum (r_C x m V_C + Theta_C omega + h), over the scene's algebra.

    The components are those along the inertial axes 1, 2, 3, angular momenta about the inertial origin.

    Axes are turned outwards to the bodies, so that nothing is turned inwards: P.e = sum m V_C.e_k, and
    H.e = sum m (e_k x r_k).V_C + omega.Theta_C e_k with r_k the mass centre from the inertial origin.
    """
    algebra = scene.algebra
    momenta = []
    for axis in (3, 1, 2):
        direction = {INERTIAL: axis_vector(algebra, axis, algebra.one, INERTIAL)}
        origin = {INERTIAL: scene.zero(INERTIAL)}
        linear, angular = algebra.zero, algebra.zero
        for name, motion in scene.motions.items():
            parent = motion.body.attached_to
            direction[name] = scene.to_axes(direction[parent], name)
            origin[name] = scene.to_axes(origin[parent] + motion.offset, name)
            along = direction[name]
            about_joint = motion.body.inertia is not None and motion.body.inertia.about == "joint"
            momentum = motion.velocity_mass_centre * motion.mass
            linear = linear + momentum.dot(along)
            arm = origin[name] if about_joint else origin[name] + motion.mass_centre
            angular = angular + momentum.dot(along.cross(arm))
            if about_joint:
                carried = motion.velocity_origin * motion.mass
                angular = angular + carried.dot(along.cross(motion.mass_centre))
            if motion.inertia is not None:
                angular = angular + motion.angular_velocity.dot(motion.inertia @ along)
            if motion.gyrostatic_moment is not None:
                angular = angular + motion.gyrostatic_moment.dot(along)
        momenta.append(("linear momentum", axis, algebra.reduce(linear)))
        momenta.append(("angular momentum", axis, algebra.reduce(angular)))
    order = {"linear momentum": 0, "angular momentum": 1}
    return sorted(momenta, key=lambda item: order[item[0]])


def about_contacts(scene: Scene, whole: Sequence[tuple[str, int, Any]]) -> Iterator[tuple[str, str, int, Any]]:
    """(what the integral is of, body, axis, component) of H - r x P along the inertial axes, r where the body rolls.

    ``whole``: the components of P and H.
    """
    algebra, known = scene.algebra, {(kind, axis): x for kind, axis, x in whole}
    for rolling in scene.system.constraints:
        if not isinstance(rolling, Rolling):
            continue
        place = scene.position(scene.zero(rolling.body), INERTIAL)
        arm = place + scene.to_axes(scene.vector(rolling.contact, rolling.axes), INERTIAL)
        for axis, second, third in ((3, 1, 2), (1, 2, 3), (2, 3, 1)):
            turned, back = (
                algebra.times(arm[i - 1], known["linear momentum", j]) for i, j in ((second, third), (third, second))
            )
            component = algebra.reduce(known["angular momentum", axis] - turned + back)
            yield f"{rolling.body} {rolling.on} {axis}", rolling.body, axis, component


def _is_new(ring: Ring, formula: Polynomial, others: Sequence[Polynomial]) -> bool:
    """Whether it depends on the state and is no combination of the others, and of a constant of parameters."""
    if formula.is_zero() or formula.is_constant():
        return False
    return is_independent(ring, formula, others)


def is_independent(ring: Ring, x: Polynomial, others: Sequence[Polynomial]) -> bool:
    """Whether x is no combination of 1 and the others with coefficients like a, cos(a), pi, or none that is found."""
    try:
        if not others or x in others:
            return not others
        return not any(len(others) + 1 in c for c in kernel(ring, [ring.one, *others, x]))
    except Failure:
        return True


def is_conserved(scene: Scene, equations: Equations, formula: Polynomial) -> bool | None:
    """Whether dI/dt = 0, q'' from the equations, at random states, and I holds a velocity at all.

    Exact at rational states; where roots or exponentials make the values irrational, balls that contain zero and are
    narrow.  None where it could be tried at too few states, and is different from zero at none of them.
    """
    ring = scene.ring
    if not ring.dependencies(formula, scene.system.velocities):
        return False
    rate = total_rate(scene, formula)
    try:
        return _vanishes(scene, equations, rate, rational_states(scene.system, ring, 4 * STATES), fmpq_mat)
    except NotRational:
        pass
    with ctx.workprec(PRECISION):
        return _vanishes(scene, equations, rate, ball_states(scene.system, ring, 4 * STATES), arb_mat)


def _vanishes(
    scene: Scene, equations: Equations, rate: Polynomial, states: Iterable[State], matrix: Any
) -> bool | None:
    """Whether dI/dt, with the accelerations of the equations, is zero at the states; None where these are too few."""
    names = scene.system.coordinates
    n, passed = len(names), 0
    for state in states:
        carry = Carrier(scene.ring, state.numbers, state.values)
        try:
            mass = matrix(n, n, _mass_at(carry, equations))
            accelerations = mass.solve(matrix(n, 1, [carry(x.polynomial) for x in equations.forcing]))
        except ZeroDivisionError:
            continue
        moved = {acceleration_name(name): accelerations[i, 0] for i, name in enumerate(names)}
        value = Carrier(scene.ring, state.numbers, {**state.values, **moved})(rate)
        if matrix is fmpq_mat and value != 0:
            return False
        if matrix is arb_mat:
            if not value.contains(0):
                return False
            if not value.rad() <= arb(2) ** -60:  # too wide to say anything (an exponential of much, at this state)
                continue
        passed += 1
        if passed == STATES:
            return True
    return None


def is_proved(scene: Scene, equations: Equations, formula: Polynomial) -> bool:
    """dI/dt = sum mu_i E_i as polynomials, with simple multipliers or with those of ``remainder``."""
    multipliers = _simple_multipliers(scene, equations, formula)
    if multipliers is not None:
        left, names = total_rate(scene, formula), scene.system.coordinates
        for i, multiplier in enumerate(multipliers):
            if not multiplier.is_zero():
                left = left - scene.ring.times(multiplier, equations.equality(i, names).polynomial)
        if scene.ring.is_zero(left):
            return True
    left = remainder(scene, equations, formula)
    return left is not None and scene.ring.is_zero(left) is True


def _simple_multipliers(scene: Scene, equations: Equations, formula: Polynomial) -> list[Polynomial] | None:
    """mu = M^-1 dI/dq', if that is linear in coordinates and velocities with rational coefficients: a guess.

    Such are the multipliers of momenta (Noether: the displacement that leaves L unchanged) and of the energy.  They are
    fitted to exact values at rational states, so that no formula is inverted.
    """
    ring, names = scene.ring, scene.system.coordinates
    unknowns = [ring.one, *(ring.generator(kind, name) for kind in ("coordinate", "velocity") for name in names)]
    slopes = [ring.velocity_derivative(formula, name) for name in names]
    basis: list[Any] = []
    values: list[Any] = []
    try:
        if not _depend_on_state_alone(scene, equations, slopes):
            return None
        for state in rational_states(scene.system, ring, 4 * STATES + len(unknowns)):
            solved = _multipliers_at(scene, equations, slopes, state)
            if solved is None:
                continue
            carry = Carrier(ring, state.numbers, state.values)
            basis.append([carry(x) for x in unknowns])
            values.append(solved)
            if len(basis) == len(unknowns):
                coefficients = fmpq_mat(basis).solve(fmpq_mat(values))
                columns = [[coefficients[k, i] for k in range(len(unknowns))] for i in range(len(names))]
                return [sum((x * c for x, c in zip(unknowns, column, strict=True)), ring.zero) for column in columns]
    except NOT_THERE:
        pass
    return None


def _depend_on_state_alone(scene: Scene, equations: Equations, slopes: Sequence[Polynomial]) -> bool:
    """False if mu differs between two states of equal q and q', but other sines, cosines and parameters.

    At a rational state these are independent numbers, so two solutions spare the fit of large systems.
    """
    names = [*scene.system.coordinates, *scene.system.velocities]
    multipliers: list[list[Any]] = []
    fixed: dict[str, Any] = {}
    for state in rational_states(scene.system, scene.ring, 4 * STATES):
        fixed = fixed or {name: state.values[name] for name in names}
        same = State(state.numbers, {**state.values, **fixed})
        solved = _multipliers_at(scene, equations, slopes, same)
        if solved is not None:
            multipliers.append(solved)
        if len(multipliers) == 2:
            return multipliers[0] == multipliers[1]
    return True


def _multipliers_at(scene: Scene, equations: Equations, slopes: Sequence[Polynomial], state: State) -> list[Any] | None:
    """mu = M^-1 dI/dq' at a rational state; None where that is singular."""
    carry = Carrier(scene.ring, state.numbers, state.values)
    n = len(slopes)
    try:
        solved = fmpq_mat(n, n, _mass_at(carry, equations)).solve(fmpq_mat(n, 1, [carry(x) for x in slopes]))
    except ZeroDivisionError:
        return None
    return [solved[i, 0] for i in range(n)]


def _mass_at(carry: Carrier, equations: Equations) -> list[Any]:
    """The entries of M row by row, each pair of equal ones evaluated once."""
    rows: list[list[Any]] = []
    for i, row in enumerate(equations.mass_matrix.polynomials):
        rows.append([rows[j][i] if j < i else carry(x) for j, x in enumerate(row)])
    return [x for row in rows for x in row]


def remainder(scene: Scene, equations: Equations, formula: Polynomial) -> Polynomial | None:
    """det(M) dI/dt - sum mu_i E_i with mu = adj(M) dI/dq': det(M) dI/dt on the equations of motion.

    None where that is too long to be formed.
    """
    rate = rate_on_motion(scene, equations, formula)
    return None if rate is None else rate[0]


def rate_on_motion(scene: Scene, equations: Equations, formula: Polynomial) -> tuple[Polynomial, Polynomial] | None:
    """(det(M) dI/dt on the equations of motion, det(M)); None where that is too long to be formed."""
    ring, names = scene.ring, scene.system.coordinates
    if len(names) > MOST_COORDINATES or len(formula) > MOST_TERMS or equations.mass_matrix.terms > MOST_TERMS:
        return None
    mass = [list(row) for row in equations.mass_matrix.polynomials]
    slopes = [ring.velocity_derivative(formula, name) for name in names]
    adjoint = adjugate(mass, partial(determinant, ring))
    whole = ring.dot(mass[0], [row[0] for row in adjoint])
    multipliers = [ring.dot(slopes, row) for row in adjoint]
    rows = [x.polynomial for x in equations.equalities(names)]
    left = ring.times(whole, total_rate(scene, formula)) - ring.dot(multipliers, rows)
    return ring.reduce(left), ring.reduce(whole)
