"""Problem 3 in other forms: Hamilton's canonical equations, and Routh's with cyclic coordinates left out.

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
principle at random exact states (``mbsym.problems.canonical.canonical_checks``).

Source: Landau & Lifshitz, Mechanics, sections 40 and 41; Pars, A Treatise on Analytical Dynamics, ch. 10.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/spherical-pendulum.yaml")
    >>> print(pendulum.routh.ignored, pendulum.routh.momenta)
    ('psi',) ('p_psi',)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, NoClosedForm, SingularPoint
from mbsym.algebra.matrices import solved
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.variables import ring_environment, ring_of
from mbsym.model.momenta import denominator_names, momentum_names
from mbsym.model.system import System, velocity_name
from mbsym.problems import energy as energies
from mbsym.problems.equations import convective_rate
from mbsym.problems.integrals import ENERGY, Integral

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
        found = [ring.is_zero(x) for row in self.matrix.polynomials for x in row]
        return False if False in found else None if None in found else True


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
