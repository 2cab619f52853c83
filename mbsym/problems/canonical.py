"""Problem 3 in other forms, and their second routes: Hamilton's equations, and Routh's without cyclic coordinates.

With L = T + U, T = 1/2 q'.M q' + A1.q' + A0, and the momenta p = dL/dq' = M q' + A1,

    H(q, p, t) = p.q' - L = 1/2 (p - A1).M^-1 (p - A1) - A0 - U
    q' = dH/dp,      p' = -dH/dq + Q

Generally u are independent velocities, q' = Y u + y0: those that constraints leave, or speeds of the system's own.
With T in u alone and p = dT/du = M u + A1 it is the same H, on the manifold of the constraints, with

    q' = Y dH/dp + y0,      p' = -Y^T dH/dq + Q + C,      {q, p} = Y,  {p_a, p_b} = W_ab = sum p_r dS_r(Y_a, Y_b)

where u = S q' + s0 and C = W dH/dp and what moves as prescribed.  C = 0 where u are velocities of coordinates and the
constraints are integrable (the fields Y_a commute): the equations are canonical then, Dirac's bracket in independent
variables.  In speeds they are Poincare's and Chetaev's (of a body about a fixed point those of Lie and Poisson).  Where
constraints are not integrable {,} violates Jacobi's identity (van der Schaft and Maschke); H is kept as it is elsewhere
where y0 = 0.  C is not derived by itself: p' = f + dp/dt at u' = 0, of M u' = f.

(H is the generalised energy T_2 - T_0 - U.)  Where L does not contain the
coordinates c and no other force acts on them, their momenta beta are constants.  Routh's function of the others, s, is

    R(s, s', beta, t) = L - beta.c',      c' = M_cc^-1 (beta - M_cs s' - A1_c)

    d/dt dR/ds' - dR/ds = Q,      that is      M_R s'' = f_R,      and then      c' = -dR/dbeta

    R = 1/2 s'.M_R s' + b.s' - W,      W(s, beta, t) the reduced potential: where b = 0 and W and Q contain neither
    the time nor s', the motions with s constant are its stationary points.

Both are derived in a ring of their own, in which the momenta are generators.  They are compared with d'Alembert's
principle at random exact states (``mbsym.problems.canonical``).

Source: Landau & Lifshitz, Mechanics, sections 40 and 41; Pars, A Treatise on Analytical Dynamics, ch. 10; Dirac,
Lectures on Quantum Mechanics (1964); Chetaev, PMM 5 (1941) 253; van der Schaft & Maschke, Reports on Mathematical
Physics 34 (1994) 225.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/spherical-pendulum.yaml")
    >>> print(pendulum.routh.ignored, pendulum.routh.momenta)
    ('psi',) ('p_psi',)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import combinations, permutations
from typing import TYPE_CHECKING, Any

from flint import arb, arb_mat, fmpq_mat

from mbsym.algebra.base import Lowering, Scalar
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, NoClosedForm, SingularPoint
from mbsym.algebra.matrices import dot, solved
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined, worded
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.mechanics.oracle import Oracle, State
from mbsym.mechanics.speed_states import all_slopes, completed, in_time
from mbsym.mechanics.speeds import SpeedForm, Variable
from mbsym.mechanics.states import Oracles
from mbsym.mechanics.variables import rate_of, ring_environment, ring_of
from mbsym.model.momenta import denominator_names, momentum_names
from mbsym.model.system import acceleration_name, velocity_name
from mbsym.problems.checks import D_ALEMBERT, FAILED, HOW_EQUAL, Check, Pair, compare, extent, how_equal
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.integrals import ENERGY, Integral

if TYPE_CHECKING:
    from mbsym.mechanics.constraints.programs import ConstrainedPrograms
    from mbsym.problems.constraints.checks import OnManifold
    from mbsym.problems.constraints.result import Constraints, Solved

#: A matrix is inverted in closed form up to this size.
MOST = 6

#: Names that the rings keep for long denominators, where somebody wants to write these once.
DENOMINATORS = 6


@dataclass(frozen=True, repr=False)
class Hamilton(Shown):
    """``momenta`` are the names of p, ``momenta_in_velocities`` dL/du; ``hamiltonian`` is H(q, p, t).

    ``velocities`` are q' = Y dH/dp + y0 of the ``positions`` in their order, Y the ``directions``; ``rates`` are p', of
    the ``speeds`` u in theirs.  Of coordinates without constraints u is q' and Y = 1.  ``integrable`` says whether the
    constraints on velocities are (None: undecided), ``structure`` is W; None where there are no Poisson brackets.
    """

    counted = ("hamiltonian",)

    momenta: tuple[str, ...]
    momenta_in_velocities: Column
    hamiltonian: Formula
    velocities: Column
    rates: Column
    positions: tuple[str, ...]
    speeds: tuple[str, ...]
    directions: Matrix
    structure: Matrix | None
    integrable: bool | None

    @property
    def plain(self) -> bool:
        """Whether positions are coordinates and all their velocities independent."""
        return tuple(map(velocity_name, self.positions)) == self.speeds

    def along(self, x: Polynomial, k: int) -> Polynomial:
        """sum over positions of  Y_sk dx/ds."""
        ring = self.hamiltonian.ring
        own = [(row[k], s) for row, s in zip(self.directions.polynomials, self.positions, strict=True) if row[k]]
        return ring.reduce(sum((ring.times(y, ring.derivative(x, s)) for y, s in own), ring.zero))

    @property
    def in_quasi_momenta(self) -> bool:
        """Whether the brackets W of momenta with each other are known and not all zero."""
        return self.structure is not None and not all(x.is_zero for row in self.structure for x in row)


@dataclass(frozen=True)
class Independent:
    """A system in its independent velocities u, polynomials of the ring of ``form``; ``equations`` tie the others."""

    form: SpeedForm
    scene: Scene
    energy: Energy
    tied: Constraints
    equations: Equations | None

    @cached_property
    def solved(self) -> Solved:
        """Raises NoClosedForm where the dependent velocities have none."""
        if self.tied.solved is None:
            raise NoClosedForm("the dependent velocities have no closed form within the budget of terms")
        return self.tied.solved

    @cached_property
    def speeds(self) -> tuple[Variable, ...]:
        return tuple(self.form.speeds[k] for k in self.solved.embedding.free)

    @cached_property
    def _images(self) -> dict[int, Polynomial]:
        from mbsym.problems.constraints.motion import dependent_velocities

        return dependent_velocities(self.form, self.solved)

    def on(self, x: Polynomial) -> Polynomial:
        """With the dependent velocities expressed by the independent ones."""
        return self.form.ring.reduce(self.form.ring.substitute(x, self._images))

    def at_rest(self, x: Polynomial) -> Polynomial:
        """At u = 0."""
        return self.form.ring.substitute(x, {u.index: self.form.ring.zero for u in self.speeds})

    @cached_property
    def kinetic(self) -> Polynomial:
        return self.on(self.energy.kinetic_energy.polynomial)

    @cached_property
    def momenta(self) -> list[Polynomial]:
        """dT/du."""
        return [self.form.ring.derivative(self.kinetic, u.name) for u in self.speeds]

    @cached_property
    def velocities(self) -> list[Polynomial]:
        """s' = Y u + y0."""
        return [self.on(self.form.rates[x.name]) for x in self.form.positions]

    @property
    def integrable(self) -> bool | None:
        """Whether what ties velocities follows from relations between positions; None where that is undecided."""
        how = self.tied.integrability
        if how is None:
            return True
        return None if how.kept is None or how.certainty is not Certainty.PROVED else how.word == "holonomic"

    def rates(self) -> list[Polynomial]:
        """d(dT/du)/dt = f + its rate at u' = 0, of M u' = f."""
        assert self.equations is not None
        own = self.equations.embedded
        if own is None:
            raise NoClosedForm("the equations without multipliers have no closed form within the budget")
        drifts = [self.on(self.form.drift(p)) for p in self.momenta]
        return [self.form.shortened(f.polynomial + x) for f, x in zip(own.forcing, drifts, strict=True)]

    def structure(self) -> list[tuple[int, int, list[Polynomial]]] | None:
        """(a, b, dS_r(Y_a, Y_b) of every r) for a < b; None where they hold angles that are no positions.

        dS_r(X, Z) = sum (dS_rj/dq_i - dS_ri/dq_j) X_i Z_j.
        """
        form, ring, names = self.form, self.form.ring, self.form.system.coordinates
        n = len(names)
        if len(self.speeds) != n or n > MOST:
            return None
        rows = [[ring.velocity_derivative(x, name) for name in names] for x in form.in_coordinates]
        fields = solved(ring, rows, [[ring.one if i == k else ring.zero for k in range(n)] for i in range(n)])
        slopes = [[[ring.derivative(x, name) for name in names] for x in row] for row in rows]
        found = []
        for a, b in combinations(range(n), 2):
            parts = []
            for slope in slopes:
                turns = [
                    ring.times(slope[j][i] - slope[i][j], ring.times(fields[i][a], fields[j][b]))
                    for i, j in permutations(range(n), 2)
                ]
                parts.append(ring.reduce(sum(turns, ring.zero)))
            if any(ring.dependencies(x, [*form.replaced]) for x in parts):
                return None
            found.append((a, b, parts))
        return found


@dataclass(frozen=True, repr=False)
class Routh(Shown):
    """``ignored`` are the cyclic coordinates c, ``momenta`` the names of their constants beta; ``function`` is R.

    M_R (m x m) and f_R belong to ``coordinates`` s; ``ignored_rates`` are c'; ``linear`` is b, and
    ``reduced_potential`` W, of R = 1/2 s'.M_R s' + b.s' - W.
    """

    counted = ("function",)

    ignored: tuple[str, ...]
    momenta: tuple[str, ...]
    coordinates: tuple[str, ...]
    function: Formula
    mass_matrix: Matrix
    forcing: Column
    ignored_rates: Column
    linear: Column
    reduced_potential: Formula


class NoBrackets(Failure):
    """There are no Poisson brackets, or none are derived."""

    code = "no-brackets"


class NothingIgnored(Failure):
    """Routh's form is Lagrange's where nothing can be left out, and says nothing where nothing is left."""

    code = "nothing-ignored"


def hamilton(own: Independent, terms: int) -> Hamilton:
    """The canonical equations.  Raises NoClosedForm where they outgrow the budget, SingularPoint where det M = 0."""
    form, system, integrable = own.form, own.form.system, own.integrable
    called = momentum_names(system)
    of_velocities = {velocity_name(name): name for name in system.coordinates}
    momenta = tuple(called[of_velocities.get(u.name, u.name)] for u in own.speeds)
    ring = ring_of(system, terms, moving=momenta, fixed=denominator_names(system, DENOMINATORS))
    carry = Carrier(form.ring, ring, ring_environment(system, ring))
    values = [ring.generator("prescribed", name) for name in momenta]
    free = [p - carry(own.at_rest(slope)) for p, slope in zip(values, own.momenta, strict=True)]
    mass = [[carry(form.ring.derivative(slope, u.name)) for u in own.speeds] for slope in own.momenta]
    speeds = _solved(ring, mass, free)
    half, potential = ring.number(Fraction(1, 2)), own.energy.force_function.polynomial
    whole = ring.reduce(ring.times(half, ring.dot(free, speeds)) - carry(own.at_rest(own.kinetic)) - carry(potential))
    rates = [carry(x) for x in own.velocities]
    places = [form.ring.generators[u.index] for u in own.speeds]
    along = {ring.index(g.kind, g.name): ring.derivative(whole, p) for g, p in zip(places, momenta, strict=True)}
    canonical = bool(integrable) and not system.speeds
    turning = () if canonical else own.structure()
    structure = [[ring.zero] * len(momenta) for _ in momenta]
    for a, b, parts in turning or ():
        structure[a][b] = ring.reduce(ring.dot(values, [carry(x) for x in parts]))
        structure[b][a] = -structure[a][b]
    found = Hamilton(
        momenta=momenta,
        momenta_in_velocities=column(ring, [carry(slope) for slope in own.momenta]),
        hamiltonian=Formula(ring, whole),
        velocities=column(ring, [ring.substitute(x, along) for x in rates]),
        rates=(),
        positions=tuple(x.name for x in form.positions),
        speeds=tuple(u.name for u in own.speeds),
        directions=Matrix.of(ring, [[ring.derivative(x, u.name) for u in own.speeds] for x in rates]),
        structure=None if turning is None else Matrix.of(ring, structure),
        integrable=integrable,
    )
    if canonical:
        acting = generalized_forces(own.scene)
        forces = [carry(own.on(acting[name])) for name in found.positions]
        work = [ring.dot([row[k] for row in found.directions.polynomials], forces) for k, _ in enumerate(momenta)]
        moved = [ring.substitute(x, along) - found.along(whole, k) for k, x in enumerate(work)]
    else:
        moved = [ring.substitute(carry(x), along) for x in own.rates()]
    return replace(found, rates=column(ring, [ring.reduce(x) for x in moved]))


def routh(own: Independent, terms: int) -> Routh:
    """Routh's equations of what is left of a system without its cyclic coordinates.

    Raises NothingIgnored where there is no cyclic coordinate without a force on it, nothing else is left, or
    constraints are not integrable; NoClosedForm where formulas outgrow the budget.
    """
    if not own.integrable:
        raise NothingIgnored(
            "Routh's equations are made of Lagrange's in independent velocities, which hold where constraints are "
            "integrable; these are not"
            if own.integrable is False
            else "Routh's equations are made of Lagrange's in independent velocities, which hold where constraints are "
            "integrable; whether these are is undecided"
        )
    system, form = own.form.system, own.form
    all_momenta = momentum_names(system)
    ring = ring_of(system, terms, fixed=(*all_momenta.values(), *denominator_names(system, DENOMINATORS)))
    carry = Carrier(form.ring, ring, ring_environment(system, ring))
    kinetic, potential = carry(own.kinetic), carry(own.energy.force_function.polynomial)
    velocities = dict(zip(system.coordinates, map(carry, own.velocities), strict=True))
    free = [name for name in system.coordinates if velocity_name(name) in {u.name for u in own.speeds}]
    along = {
        name: {x: y for x in system.coordinates if (y := ring.velocity_derivative(velocities[x], name))}
        for name in free
    }

    def slope(x: Polynomial, name: str) -> Polynomial:
        return ring.dot([*along[name].values()], [ring.derivative(x, other) for other in along[name]])

    acting = generalized_forces(own.scene)
    forces = {name: carry(own.on(acting[name])) for name in system.coordinates}
    applied = {name: ring.dot([*along[name].values()], [forces[x] for x in along[name]]) for name in free}
    steady = (kinetic, potential, *velocities.values())
    cyclic = [
        name for name in free if [*along[name]] == [name] and not any(ring.dependencies(x, (name,)) for x in steady)
    ]
    ignored = tuple(name for name in cyclic if ring.vanishes(applied[name]))
    if any(ring.dependencies(applied[name], ignored) for name in free):
        ignored = tuple(x for x in ignored if not any(ring.dependencies(q, (x,)) for q in applied.values()))
    left = tuple(name for name in free if name not in ignored)
    if not ignored:
        raise NothingIgnored(
            Message("cyclic are [[names]], but other forces act on them, or depend on them", names=", ".join(cyclic))
            if cyclic
            else "no coordinate is cyclic"
        )
    if not left:
        raise NothingIgnored("all coordinates are cyclic, so that no other is left")
    beta = [ring.generator("parameter", all_momenta[name]) for name in ignored]
    at_rest = {ring.index("velocity", name): ring.zero for name in ignored}
    momenta = [ring.velocity_derivative(kinetic, name) for name in ignored]
    masses = [[ring.velocity_derivative(p, name) for name in ignored] for p in momenta]
    rest = [b - ring.substitute(p, at_rest) for b, p in zip(beta, momenta, strict=True)]
    rates = _solved(ring, masses, rest)
    back = {ring.index("velocity", name): x for name, x in zip(ignored, rates, strict=True)}
    lagrangian = ring.substitute(kinetic, back) + ring.substitute(potential, back)
    function = ring.reduce(lagrangian - sum((ring.times(b, c) for b, c in zip(beta, rates, strict=True)), ring.zero))
    slopes = [ring.velocity_derivative(function, name) for name in left]
    moving_as = {name: ring.substitute(x, back) for name, x in velocities.items() if name not in ignored}
    lower = Lowering(ring, ring_environment(system, ring))
    forcing = []
    for name, momentum in zip(left, slopes, strict=True):
        rate = rate_of(ring, lower, system, momentum, moving_as.items())
        forcing.append(ring.reduce(ring.substitute(applied[name], back) + slope(function, name) - rate))
    rest_of = {ring.index("velocity", name): ring.zero for name in left}
    return Routh(
        ignored=ignored,
        momenta=tuple(all_momenta[name] for name in ignored),
        coordinates=left,
        function=Formula(ring, function),
        mass_matrix=Matrix.of(ring, [[ring.velocity_derivative(p, name) for name in left] for p in slopes]),
        forcing=column(ring, forcing),
        ignored_rates=column(ring, rates),
        linear=column(ring, [ring.substitute(p, rest_of) for p in slopes]),
        reduced_potential=Formula(ring, -ring.substitute(function, rest_of)),
    )


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


# Poisson brackets of the first integrals of problem 7, in positions and momenta.
#
#     {F, G} = sum over i of  Y_i F dG/dp_i - dF/dp_i Y_i G  +  sum over i, j of  dF/dp_i W_ij dG/dp_j
#     dF/dt  = dF/dt|_(q, p) + sum over i of  dF/dq_i q'_i + dF/dp_i p'_i
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


def brackets(own: Independent, canonical: Hamilton, integrals: Sequence[Integral]) -> Brackets | None:
    """The brackets of the ``integrals``, whose formulas are in positions and velocities; None without integrals.

    Raises NoBrackets where there are none, or none in closed form.
    """
    if not integrals:
        return None
    if canonical.structure is None:
        raise NoBrackets(
            "brackets of quasi-momenta are not derived where constraints tie speeds, or where they hold angles that "
            "unit vectors replace"
            if canonical.integrable
            else "where constraints on velocities are not integrable brackets violate Jacobi's identity"
            if canonical.integrable is False
            else "it is undecided whether the constraints on velocities are integrable: without that brackets violate "
            "Jacobi's identity"
        )
    system, ring = own.form.system, canonical.hamiltonian.ring
    environment = ring_environment(system, ring)
    environment |= {
        velocity_name(q): x.polynomial for q, x in zip(canonical.positions, canonical.velocities, strict=True)
    }
    slopes = [ring.derivative(canonical.hamiltonian.polynomial, p) for p in canonical.momenta]
    environment |= dict(zip(canonical.speeds, slopes, strict=True))
    carry = Carrier(integrals[0].formula.ring, ring, environment)
    known: dict[tuple[str, str], Polynomial] = {}
    if canonical.plain:
        known[ENERGY, "time"] = canonical.hamiltonian.polynomial
        for q, p in zip(canonical.positions, canonical.momenta, strict=True):
            known["cyclic momentum", q] = ring.generator("prescribed", p)
    formulas = []
    for integral in integrals:
        taken = known.get((integral.kind, integral.of))
        formulas.append(ring.reduce(carry(integral.formula.polynomial)) if taken is None else taken)
    there = SpeedForm(system, ring)
    rows = [[poisson_bracket(canonical, a, b) for b in formulas] for a in formulas]
    rows = [[ring.zero if there.oriented and there.vanishes(x) else x for x in row] for row in rows]
    return Brackets(tuple(one.name for one in integrals), column(ring, formulas), Matrix.of(ring, rows))


def poisson_bracket(canonical: Hamilton, f: Polynomial, g: Polynomial) -> Polynomial:
    """{f, g} in the ring of the canonical equations."""
    assert canonical.structure is not None
    ring = canonical.hamiltonian.ring
    left, right = ([ring.derivative(x, p) for p in canonical.momenta] for x in (f, g))
    total = ring.zero
    for k, row in enumerate(canonical.structure.polynomials):
        total = total + ring.times(canonical.along(f, k), right[k]) - ring.times(left[k], canonical.along(g, k))
        total = total + ring.times(left[k], ring.dot(row, right))
    return ring.reduce(total)


def rate_along(canonical: Hamilton, scene: Scene, f: Polynomial) -> Polynomial:
    """df/dt by the canonical equations; ``scene`` lowers formulas over their ring."""
    ring = canonical.hamiltonian.ring
    total = ring.derivative(f, "t")
    for item in scene.system.prescribed:
        total = total + ring.times(scene.lower(item.rate), ring.derivative(f, item.name))
    names, rates = (*canonical.positions, *canonical.momenta), (*canonical.velocities, *canonical.rates)
    for name, rate in zip(names, rates, strict=True):
        total = total + ring.times(ring.derivative(f, name), rate.polynomial)
    return ring.reduce(total)


# Second routes for Hamilton's and Routh's forms: d'Alembert's principle in inertial axes, at random exact states.
#
# Hamilton, at a state (q, q', q''), for every displacement dq that the constraints allow, du = S dq:
#
#     p.du = dT/dq'.dq  by differences  dT/dq'_i = (T(q' + e_i) - T(q' - e_i))/2,      H(q, p, t) = p.u - T - U,
#     (dp/dt - p').du = e.dq,  e the residual of d'Alembert's principle,      q' as the state has it,
#
# with dp/dt = d(dL/du)/dt along the state.  Routh: beta is such a p of the ignored coordinates c, and
#
#     R = T + U - beta.c',      M_R s'' - f_R = E_s - M_sc M_cc^-1 E_c      (E: the residuals),
#
# where M_sc and M_cc are differences of residuals.  The right-hand side is what is left of E_s on the level of beta.


CANONICAL, ROUTH, BRACKETS = "canonical equations", "Routh's equations", "Poisson brackets"


def check_hamilton(truth: Oracles, own: Independent, canonical: Hamilton, programs: ConstrainedPrograms) -> Check:
    """p, H, q' and p' against sums over bodies in inertial axes; with constraints by ``programs`` on their manifold."""
    system, ring = own.form.system, canonical.hamiltonian.ring
    names = system.coordinates
    lengths = {"all": sum(x.terms for x in (*canonical.velocities, *canonical.rates, *canonical.momenta_in_velocities))}
    if canonical.plain:
        rows = zip(canonical.velocities, canonical.rates, canonical.momenta_in_velocities, strict=True)
        lengths = {name: sum(x.terms for x in row) for name, row in zip(names, rows, strict=True)}
    chosen = extent(lengths, "equations", fixed=canonical.hamiltonian.terms)

    def shown(name: str) -> bool:
        return not canonical.plain or name in chosen.chosen

    def pairs(oracle: Oracle, displacements: Mapping[str, Sequence[Scalar]]) -> list[Pair]:
        state, moved = completed(oracle), in_time(ring, oracle)
        along = [moved(x.polynomial) for x in canonical.momenta_in_velocities]
        p = [x.a for x in along]
        hidden = _without(state, (*names, *(speed.name for speed in system.speeds)))
        carry = Carrier(ring, state.numbers, hidden | dict(zip(canonical.momenta, p, strict=True)))
        own_speeds = [state.values[u] for u in canonical.speeds]
        legendre = dot(p, own_speeds) - oracle.kinetic_energy - oracle.force_function
        compared: list[Pair] = [("H", carry(canonical.hamiltonian.polynomial), legendre)]
        for position, velocity in zip(canonical.positions, canonical.velocities, strict=True):
            if shown(position):
                rate = state.values[velocity_name(position)]
                compared.append((f"{position}'", carry(velocity.polynomial), rate))
        slopes, residuals = momenta_at(oracle, names), [oracle.residuals[name] for name in names]
        kept = [k for k, _ in enumerate(canonical.momenta) if not canonical.plain or shown(names[k])]
        left = [along[k].b - carry(canonical.rates[k].polynomial) for k in kept]
        columns = all_slopes(oracle, canonical.speeds)
        for name, y in displacements.items():
            if shown(name):
                turned = [dot(column, y) for column in columns]
                work = dot(left, [turned[k] for k in kept])
                compared.append((Message("the momenta along [[name]]", name=name), dot(p, turned), dot(slopes, y)))
                compared.append((Message("their rates along [[name]]", name=name), work, dot(residuals, y)))
        return compared

    routes = ("Hamilton, closed form", D_ALEMBERT)
    if not own.tied.names:

        def free(oracle: Oracle) -> list[Pair]:
            one, zero = oracle.numbers.one, oracle.numbers.zero
            return pairs(oracle, {name: [one if x == name else zero for x in names] for name in names})

        return compare(truth, CANONICAL, routes, free, chosen.states, chosen.remark)

    def along_the_constraints(oracle: Oracle, basis: Sequence[Sequence[Scalar]]) -> list[Pair]:
        return pairs(oracle, {str(k + 1): y for k, y in enumerate(basis)})

    return _on_the_manifold(CANONICAL, routes, own, own.tied, programs, along_the_constraints)


def _on_the_manifold(
    name: str,
    routes: tuple[str, str],
    own: Independent,
    tied: Constraints,
    programs: ConstrainedPrograms,
    pairs: Callable[[Oracle, Sequence[Sequence[Scalar]]], list[Pair]],
) -> Check:
    """Compares at states of the constrained motion; ``pairs`` takes displacements that are allowed there, too."""
    from mbsym.mechanics.constraints.oracle import oracle_rows
    from mbsym.problems.constraints.checks import compared_on_manifold, moving, null_space

    def at(on_manifold: OnManifold) -> list[Pair]:
        state = moving(own.form, on_manifold, tied, programs)
        rows = [row.partials for rows in oracle_rows(own.form.system, state) for row in rows]
        basis = null_space(rows, len(own.form.system.coordinates), state.numbers)
        return pairs(Oracle(own.form.system, state), basis)

    return compared_on_manifold(name, routes, own.form, programs, at)


def check_routh(truth: Oracles, own: Independent, found: Routh, programs: ConstrainedPrograms) -> Check:
    """R, c' and M_R s'' = f_R against sums over bodies in inertial axes, on the level of the momenta.

    With constraints on their manifold, at the accelerations with multipliers, which M_R s'' = f_R has to have.
    """
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
        zero = state.numbers.zero
        needed = _on_the_level(oracle, found) if not own.tied.names else dict.fromkeys(found.coordinates, zero)
        for i, name in enumerate(found.coordinates):
            if name in chosen.chosen:
                total = -carry(found.forcing[i].polynomial)
                for j, other in enumerate(found.coordinates):
                    entry = carry(found.mass_matrix[i, j].polynomial)
                    total = total + entry * state.values[acceleration_name(other)]
                compared.append((Message("equation [[name]]", name=name), total, needed[name]))
        return compared

    routes = ("Routh, closed form", D_ALEMBERT)
    if not own.tied.names:
        return compare(truth, ROUTH, routes, pairs, chosen.states, chosen.remark)
    return _on_the_manifold(ROUTH, routes, own, own.tied, programs, lambda oracle, _: pairs(oracle))


def check_brackets(found: Brackets, canonical: Hamilton, scene: Scene) -> Check:
    """dF/dt along the canonical equations is zero, for every first integral F that problem 7 found."""
    ring = canonical.hamiltonian.ring
    form = SpeedForm(scene.system, ring)
    rates = [form.in_angles(rate_along(canonical, scene, x.polynomial)) for x in found.formulas]
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
