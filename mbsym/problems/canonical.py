"""Problem 3 in other forms, and their second routes: Hamilton's equations, and Routh's without cyclic coordinates.

With L = T + U, T = 1/2 q'.M q' + A1.q' + A0, and the momenta p = dL/dq' = M q' + A1,

    H(q, p, t) = p.q' - L = 1/2 (p - A1).M^-1 (p - A1) - A0 - U
    q' = dH/dp,      p' = -dH/dq + Q

(H is the generalised energy T_2 - T_0 - U.)  Where L does not contain the
coordinates c and no other force acts on them, their momenta beta are constants.  Routh's function of the others, s, is

    R(s, s', beta, t) = L - beta.c',      c' = M_cc^-1 (beta - M_cs s' - A1_c)

    d/dt dR/ds' - dR/ds = Q,      that is      M_R s'' = f_R,      and then      c' = -dR/dbeta

    R = 1/2 s'.M_R s' + b.s' - W,      W(s, beta, t) the reduced potential: where b = 0 and W and Q contain neither
    the time nor s', the motions with s constant are its stationary points.

Both are derived in a ring of their own, in which the momenta are generators.  They are compared with d'Alembert's
principle at random exact states (``mbsym.problems.canonical``).

Source: Landau & Lifshitz, Mechanics, sections 40 and 41; Pars, A Treatise on Analytical Dynamics, ch. 10.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/spherical-pendulum.yaml")
    >>> print(pendulum.routh.ignored, pendulum.routh.momenta)
    ('psi',) ('p_psi',)
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, fmpq_mat

from mbsym.algebra.base import Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, NoClosedForm, SingularPoint
from mbsym.algebra.matrices import solved
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined, worded
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.states import Oracles
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.momenta import denominator_names, momentum_names
from mbsym.model.system import System, acceleration_name, velocity_name
from mbsym.problems import energy as energies
from mbsym.problems.checks import D_ALEMBERT, FAILED, HOW_EQUAL, Check, Pair, compare, extent, how_equal
from mbsym.problems.equations import convective_rate
from mbsym.problems.integrals import ENERGY, Integral, total_rate

#: A matrix is inverted in closed form up to this size.
MOST = 6

#: Names that the rings keep for long denominators, where somebody wants to write these once.
DENOMINATORS = 6


@dataclass(frozen=True, repr=False)
class Hamilton(Shown):
    """``momenta`` are the names of p, ``momenta_in_velocities`` dL/dq'; ``hamiltonian`` is H(q, p, t).

    ``velocities`` are q' = dH/dp and ``rates`` p' = -dH/dq + Q, in the order of the coordinates.
    """

    momenta: tuple[str, ...]
    momenta_in_velocities: Column
    hamiltonian: Formula
    velocities: Column
    rates: Column

    @property
    def terms(self) -> int:
        """Terms of H."""
        return self.hamiltonian.terms


@dataclass(frozen=True, repr=False)
class Routh(Shown):
    """``ignored`` are the cyclic coordinates c, ``momenta`` the names of their constants beta; ``function`` is R.

    M_R (m x m) and f_R belong to ``coordinates`` s; ``ignored_rates`` are c'; ``linear`` is b, and
    ``reduced_potential`` W, of R = 1/2 s'.M_R s' + b.s' - W.
    """

    ignored: tuple[str, ...]
    momenta: tuple[str, ...]
    coordinates: tuple[str, ...]
    function: Formula
    mass_matrix: Matrix
    forcing: Column
    ignored_rates: Column
    linear: Column
    reduced_potential: Formula

    @property
    def terms(self) -> int:
        """Terms of R."""
        return self.function.terms


class NothingIgnored(Failure):
    """Routh's form is Lagrange's where nothing can be left out, and says nothing where nothing is left."""

    code = "nothing-ignored"


def hamilton(system: System, terms: int) -> Hamilton:
    """The canonical equations.  Raises NoClosedForm where they outgrow the budget, SingularPoint where det M = 0."""
    names, momenta = system.coordinates, momentum_names(system)
    spare = denominator_names(system, DENOMINATORS)
    ring = ring_of(system, terms, moving=tuple(momenta.values()), fixed=spare)
    scene = Scene(system, ring, ring_environment(system, ring), ring)
    energy = energies.energy(scene)
    values = [ring.generator("prescribed", momenta[name]) for name in names]
    linear = [x.polynomial for x in energy.A1]
    free = [p - a for p, a in zip(values, linear, strict=True)]
    velocities = _solved(ring, energy.A2.polynomials, free)
    half = ring.number(Fraction(1, 2))
    quadratic = sum((ring.times(a, b) for a, b in zip(free, velocities, strict=True)), ring.zero)
    whole = ring.reduce(ring.times(half, quadratic) - energy.A0.polynomial - energy.force_function.polynomial)
    applied = generalized_forces(scene)
    back = {ring.index("velocity", name): x for name, x in zip(names, velocities, strict=True)}
    rates = [ring.reduce(ring.substitute(applied[name], back) - ring.derivative(whole, name)) for name in names]
    in_velocities = [ring.velocity_derivative(energy.kinetic_energy.polynomial, name) for name in names]
    return Hamilton(
        momenta=tuple(momenta[name] for name in names),
        momenta_in_velocities=column(ring, in_velocities),
        hamiltonian=Formula(ring, whole),
        velocities=column(ring, [ring.derivative(whole, momenta[name]) for name in names]),
        rates=column(ring, rates),
    )


def routh(system: System, terms: int) -> Routh:
    """Routh's equations of what is left of a system without its cyclic coordinates.

    Raises NothingIgnored where there is no cyclic coordinate without a force on it, or nothing else is left,
    NoClosedForm where formulas outgrow the budget.
    """
    all_momenta = momentum_names(system)
    ring = ring_of(system, terms, fixed=(*all_momenta.values(), *denominator_names(system, DENOMINATORS)))
    scene = Scene(system, ring, ring_environment(system, ring), ring)
    energy = energies.energy(scene)
    applied = generalized_forces(scene)
    ignored = tuple(name for name in system.coordinates if name in energy.cyclic and ring.vanishes(applied[name]))
    if any(ring.dependencies(applied[name], ignored) for name in system.coordinates):
        ignored = tuple(x for x in ignored if not any(ring.dependencies(q, (x,)) for q in applied.values()))
    left = tuple(name for name in system.coordinates if name not in ignored)
    if not ignored:
        cyclic = ", ".join(name for name in energy.cyclic if name in system.coordinates)
        raise NothingIgnored(
            Message("cyclic are [[names]], but other forces act on them, or depend on them", names=cyclic)
            if cyclic
            else "no coordinate is cyclic"
        )
    if not left:
        raise NothingIgnored("all coordinates are cyclic, so that no other is left")
    beta = [ring.generator("parameter", all_momenta[name]) for name in ignored]
    kinetic = energy.kinetic_energy.polynomial
    at_rest = {ring.index("velocity", name): ring.zero for name in ignored}
    momenta = [ring.velocity_derivative(kinetic, name) for name in ignored]
    own = [[ring.velocity_derivative(p, name) for name in ignored] for p in momenta]
    rest = [b - ring.substitute(p, at_rest) for b, p in zip(beta, momenta, strict=True)]
    rates = _solved(ring, own, rest)
    back = {ring.index("velocity", name): x for name, x in zip(ignored, rates, strict=True)}
    lagrangian = ring.substitute(kinetic, back) + ring.substitute(energy.force_function.polynomial, back)
    function = ring.reduce(lagrangian - sum((ring.times(b, c) for b, c in zip(beta, rates, strict=True)), ring.zero))
    slopes = [ring.velocity_derivative(function, name) for name in left]
    forcing = []
    for name, slope in zip(left, slopes, strict=True):
        force = ring.substitute(applied[name], back) + ring.derivative(function, name)
        forcing.append(ring.reduce(force - _convective(scene, ring, slope, left)))
    rest_of = {ring.index("velocity", name): ring.zero for name in left}
    return Routh(
        ignored=ignored,
        momenta=tuple(all_momenta[name] for name in ignored),
        coordinates=left,
        function=Formula(ring, function),
        mass_matrix=Matrix.of(ring, [[ring.velocity_derivative(p, name) for name in left] for p in slopes]),
        forcing=column(ring, forcing),
        ignored_rates=column(ring, rates),
        linear=column(ring, [ring.substitute(slope, rest_of) for slope in slopes]),
        reduced_potential=Formula(ring, -ring.substitute(function, rest_of)),
    )


def _convective(scene: Scene, ring: Ring, x: Polynomial, left: Sequence[str]) -> Polynomial:
    """dx/dt at s'' = 0; x does not contain the ignored coordinates."""
    assert not ring.dependencies(x, [name for name in scene.system.coordinates if name not in left])
    return convective_rate(scene, ring, x)


def _solved(ring: Ring, matrix: Sequence[Sequence[Polynomial]], right: Sequence[Polynomial]) -> list[Polynomial]:
    """matrix^-1 right by Cramer's rule: the only denominator is the determinant."""
    if len(right) > MOST:
        raise NoClosedForm(
            "the inverse of a matrix of [[count]] rows: at most [[most]] are inverted in closed form",
            count=len(right),
            most=MOST,
        )
    try:
        return [x for (x,) in solved(ring, matrix, [[x] for x in right])]
    except SingularPoint:
        raise SingularPoint("the mass matrix is singular") from None


# Poisson brackets of the first integrals of problem 7, in coordinates and momenta.
#
#     {F, G} = sum over i of  dF/dq_i dG/dp_i - dF/dp_i dG/dq_i
#     dF/dt  = dF/dt|_(q, p) + sum over i of  dF/dq_i dH/dp_i + dF/dp_i (-dH/dq_i + Q_i)
#
# Integrals whose brackets are all zero are in involution.  Where no generalised forces Q act the bracket of two
# integrals is an integral again, or a constant (Poisson's theorem).
#
# Source: Landau & Lifshitz, Mechanics, section 42; Arnold, Mathematical Methods of Classical Mechanics, section 40.


@dataclass(frozen=True, repr=False)
class Brackets(Shown):
    """``formulas`` are the integrals of these ``names`` in (q, p, t), ``matrix`` their brackets {F_i, F_j}."""

    names: tuple[str, ...]
    formulas: Column
    matrix: Matrix

    @property
    def in_involution(self) -> bool | None:
        """Whether all brackets vanish; None where one is no zero of the ring, and may be one all the same."""
        ring = self.matrix[0, 0].ring
        vanishing = [ring.is_zero(x) for row in self.matrix.polynomials for x in row]
        return False if False in vanishing else None if None in vanishing else True


def brackets(system: System, canonical: Hamilton, integrals: Sequence[Integral]) -> Brackets | None:
    """The brackets of the ``integrals``, whose formulas are in q and q'; None without integrals."""
    if not integrals:
        return None
    ring = canonical.hamiltonian.ring
    environment = ring_environment(system, ring)
    for name, velocity in zip(system.coordinates, canonical.velocities, strict=True):
        environment[velocity_name(name)] = velocity.polynomial
    carry = Carrier(integrals[0].formula.ring, ring, environment)
    own: dict[tuple[str, str], Polynomial] = {(ENERGY, "time"): canonical.hamiltonian.polynomial}
    for q, p in zip(system.coordinates, canonical.momenta, strict=True):
        own["cyclic momentum", q] = ring.generator("prescribed", p)
    formulas = []
    for integral in integrals:
        known = own.get((integral.kind, integral.of))
        formulas.append(ring.reduce(carry(integral.formula.polynomial)) if known is None else known)
    rows = [[poisson_bracket(system, canonical, a, b) for b in formulas] for a in formulas]
    return Brackets(tuple(one.name for one in integrals), column(ring, formulas), Matrix.of(ring, rows))


def poisson_bracket(system: System, canonical: Hamilton, f: Polynomial, g: Polynomial) -> Polynomial:
    """{f, g} in the ring of the canonical equations."""
    ring = canonical.hamiltonian.ring
    total = ring.zero
    for q, p in zip(system.coordinates, canonical.momenta, strict=True):
        total = total + ring.times(ring.derivative(f, q), ring.derivative(g, p))
        total = total - ring.times(ring.derivative(f, p), ring.derivative(g, q))
    return ring.reduce(total)


def rate_along(canonical: Hamilton, scene: Scene, f: Polynomial) -> Polynomial:
    """df/dt by the canonical equations; ``scene`` is the system over their ring."""
    ring, system = canonical.hamiltonian.ring, scene.system
    total = ring.derivative(f, "t")
    for item in system.prescribed:
        total = total + ring.times(scene.lower(item.rate), ring.derivative(f, item.name))
    moved = zip(system.coordinates, canonical.momenta, canonical.velocities, canonical.rates, strict=True)
    for q, p, velocity, rate in moved:
        total = total + ring.times(ring.derivative(f, q), velocity.polynomial)
        total = total + ring.times(ring.derivative(f, p), rate.polynomial)
    return ring.reduce(total)


# Second routes for Hamilton's and Routh's forms: d'Alembert's principle in inertial axes, at random exact states.
#
# Hamilton, at a state (q, q', q''):  p is what the differences of T in inertial axes give, p_i = (T(q' + e_i) -
# T(q' - e_i))/2, and
#
#     H(q, p, t) = p.q' - T - U,      dH/dp = q',      dp/dt - (-dH/dq + Q) = residual of d'Alembert's principle,
#
# with dp/dt = d(dL/dq')/dt along the state.  Routh: beta is such a p of the ignored coordinates c, and
#
#     R = T + U - beta.c',      M_R s'' - f_R = E_s - M_sc M_cc^-1 E_c      (E: the residuals),
#
# where M_sc and M_cc are differences of residuals.  The right-hand side is what is left of E_s on the level of beta.


CANONICAL, ROUTH, BRACKETS = "canonical equations", "Routh's equations", "Poisson brackets"


def check_hamilton(truth: Oracles, canonical: Hamilton) -> Check:
    """p, H, dH/dp and -dH/dq + Q against sums over bodies in inertial axes."""
    system, ring, names = truth.system, canonical.hamiltonian.ring, truth.system.coordinates
    scene = Scene(system, ring, ring_environment(system, ring), ring, bodies=False)
    along = [total_rate(scene, x.polynomial) for x in canonical.momenta_in_velocities]
    rows = zip(canonical.velocities, canonical.rates, canonical.momenta_in_velocities, strict=True)
    lengths = {name: sum(x.terms for x in row) for name, row in zip(names, rows, strict=True)}
    chosen = extent(lengths, "equations", fixed=canonical.hamiltonian.terms)

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        p = momenta_at(oracle, names)
        known = Carrier(ring, state.numbers, state.values)
        carry = Carrier(ring, state.numbers, _without(state, names) | dict(zip(canonical.momenta, p, strict=True)))
        legendre = -(oracle.kinetic_energy + oracle.force_function)
        for momentum, name in zip(p, names, strict=True):
            legendre = legendre + momentum * state.values[velocity_name(name)]
        compared: list[Pair] = [("H", carry(canonical.hamiltonian.polynomial), legendre)]
        for i, name in enumerate(names):
            if name in chosen.chosen:
                rate = known(along[i]) - carry(canonical.rates[i].polynomial)
                velocity = state.values[velocity_name(name)]
                compared += [
                    (
                        Message("[[momentum]]", momentum=canonical.momenta[i]),
                        known(canonical.momenta_in_velocities[i].polynomial),
                        p[i],
                    ),
                    (
                        Message("dH/d[[momentum]]", momentum=canonical.momenta[i]),
                        carry(canonical.velocities[i].polynomial),
                        velocity,
                    ),
                    (Message("the rate of [[momentum]]", momentum=canonical.momenta[i]), rate, oracle.residuals[name]),
                ]
        return compared

    routes = ("Hamilton, closed form", D_ALEMBERT)
    return compare(truth, CANONICAL, routes, pairs, chosen.states, chosen.remark)


def check_routh(truth: Oracles, found: Routh) -> Check:
    """R, c' and M_R s'' = f_R against sums over bodies in inertial axes, on the level of the momenta."""
    ring = found.function.ring
    rows = zip(found.coordinates, found.mass_matrix, found.forcing, strict=True)
    lengths = {name: sum(x.terms for x in (*row, f)) for name, row, f in rows}
    fixed = found.function.terms + sum(x.terms for x in (*found.ignored_rates, *found.linear, found.reduced_potential))
    chosen = extent(lengths, "equations", fixed)

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        beta = momenta_at(oracle, found.ignored)
        values = _without(state, found.ignored) | dict(zip(found.momenta, beta, strict=True))
        carry = Carrier(ring, state.numbers, values)
        function = oracle.kinetic_energy + oracle.force_function
        compared: list[Pair] = []
        for name, momentum, rate in zip(found.ignored, beta, found.ignored_rates, strict=True):
            velocity = state.values[velocity_name(name)]
            function = function - momentum * velocity
            compared.append((Message("the velocity of [[name]]", name=name), carry(rate.polynomial), velocity))
        compared.append(("R", carry(found.function.polynomial), function))
        compared.append((Message("the parts of R"), _by_parts(found, carry, state), function))
        needed = _on_the_level(oracle, found)
        for i, name in enumerate(found.coordinates):
            if name in chosen.chosen:
                total = -carry(found.forcing[i].polynomial)
                for j, other in enumerate(found.coordinates):
                    entry = carry(found.mass_matrix[i, j].polynomial)
                    total = total + entry * state.values[acceleration_name(other)]
                compared.append((Message("equation [[name]]", name=name), total, needed[name]))
        return compared

    routes = ("Routh, closed form", D_ALEMBERT)
    return compare(truth, ROUTH, routes, pairs, chosen.states, chosen.remark)


def check_brackets(found: Brackets, canonical: Hamilton, scene: Scene) -> Check:
    """dF/dt along the canonical equations is zero, for every first integral F that problem 7 found."""
    ring = canonical.hamiltonian.ring
    rates = [rate_along(canonical, scene, x.polynomial) for x in found.formulas]
    outcomes = [how_equal(ring, [[rate]], [[ring.zero]]) for rate in rates]
    wrong = [name for name, outcome in zip(found.names, outcomes, strict=True) if outcome == FAILED]
    outcome = max(outcomes, key=tuple(HOW_EQUAL).index) if not wrong else FAILED
    detail = (
        Message("not kept by the canonical equations: [[wrong]]", wrong=joined(map(worded, wrong), ", "))
        if wrong
        else HOW_EQUAL[outcome]
    )
    routes = ("rates of first integrals along the canonical equations", "zero, as problem 7 found them")
    return Check(BRACKETS, *routes, outcome, detail)


def momenta_at(oracle: Oracle, names: Sequence[str]) -> list[Scalar]:
    """dT/dq' of some coordinates, by differences of T, which is quadratic in q'."""
    half = oracle.state.numbers.number(Fraction(1, 2))
    scalars = []
    for name in names:
        there, back = (_moved(oracle, velocity_name(name), step).kinetic_energy for step in (1, -1))
        scalars.append((there - back) * half)
    return scalars


def _moved(oracle: Oracle, name: str, step: int) -> Oracle:
    """The oracle of the same state with one number changed."""
    state = oracle.state
    values: Mapping[str, Scalar] = {**state.values, name: state.values[name] + state.numbers.number(step)}
    return Oracle(oracle.system, State(state.numbers, values))


def _without(state: State, names: Sequence[str]) -> dict[str, Scalar]:
    """The state with other numbers for these velocities, on which a formula in momenta must not depend."""
    other = {velocity_name(name): state.numbers.number(2 * k + 3) for k, name in enumerate(names)}
    return {**state.values, **other}


def _by_parts(found: Routh, carry: Carrier, state: State) -> Scalar:
    """1/2 s'.M_R s' + b.s' - W."""
    half = state.numbers.number(Fraction(1, 2))
    speeds = [state.values[velocity_name(name)] for name in found.coordinates]
    total = -carry(found.reduced_potential.polynomial)
    for i, speed in enumerate(speeds):
        total = total + carry(found.linear[i].polynomial) * speed
        for j, other in enumerate(speeds):
            total = total + half * carry(found.mass_matrix[i, j].polynomial) * speed * other
    return total


def _on_the_level(oracle: Oracle, found: Routh) -> dict[str, Scalar]:
    """E_s - M_sc M_cc^-1 E_c by name of s.  Raises ZeroDivisionError where M_cc is singular."""
    residuals = oracle.residuals
    columns = [_moved(oracle, acceleration_name(name), 1).residuals for name in found.ignored]
    own = [[column[name] - residuals[name] for column in columns] for name in found.ignored]
    matrix: Any = arb_mat if any(isinstance(x, arb) for row in own for x in row) else fmpq_mat
    n = len(found.ignored)
    right = matrix(n, 1, [residuals[name] for name in found.ignored])
    solved = matrix(n, n, [x for row in own for x in row]).solve(right)
    left = {}
    for name in found.coordinates:
        taken = oracle.state.numbers.zero
        for k, lever in enumerate(columns):
            taken = taken + (lever[name] - residuals[name]) * solved[k, 0]
        left[name] = residuals[name] - taken
    return left
