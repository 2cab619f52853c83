"""Problems 3 and 7, and their self-check, in velocities of their own: speeds u with q' = Y(q) u + y0(q, t).

    M u' = f                                            Kane's equations (equally Boltzmann-Hamel)
    s' = g(s, u, t)                                     kinematic equations

where s are the coordinates, and components of unit vectors that take the place of angles (e' = e x omega, Poisson).
Each equation is also kept as it stands in textbooks: what the motion needs = what the loads supply, for a body about a
fixed point

    A p' + (C - B) q r = m g (z_0 gamma_2 - y_0 gamma_3).

Source: Kane & Levinson, Dynamics: Theory and Applications (1985); Lurie, Analytical Mechanics, ch. 8 (Euler-Poisson).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import cramer, determinant
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Column, Formula, Matrix, column
from mbsym.mechanics.kane import Kane
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.oracle import Oracle
from mbsym.mechanics.speed_programs import speed_program
from mbsym.mechanics.speed_states import all_slopes
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.states import Oracles
from mbsym.model.speeds import Quaternion
from mbsym.model.system import velocity_name
from mbsym.problems.checks import D_ALEMBERT, STATES, Check, Pair, compare
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.integrals import ENERGY, Integral, is_independent, momentum_title, whole_momenta


@dataclass(frozen=True, repr=False)
class SpeedEquations(Equations):
    """M (n x n), f (n) of M u' = f; ``needed`` = ``supplied`` are the same equations before they are sorted.

    ``speeds`` u and ``positions`` s by name, ``rates`` s' in their order.  ``vectors`` are the unit vectors and
    quaternions that occur, each with its components, three or four, ``owners`` their bodies, ``quaternions`` those of
    norm 1; ``aside`` the positions on which no equation depends, nor the rate of another one that
    matters: they follow by integration.
    """

    speeds: tuple[str, ...]
    speed_rates: tuple[str, ...]
    positions: tuple[str, ...]
    rates: Column
    needed: Column
    supplied: Column
    vectors: tuple[tuple[str, tuple[str, ...]], ...]
    owners: tuple[str, ...]
    quaternions: tuple[str, ...]
    aside: tuple[str, ...]

    @property
    def in_speeds(self) -> bool:
        return True

    def equality(self, i: int, names: Sequence[str] = ()) -> Formula:
        """What the motion needs less what the loads supply: zero along every motion of the open tree."""
        return self.needed[i] - self.supplied[i]

    @property
    def kinematic(self) -> list[tuple[str, Formula]]:
        """(position, its rate) of those on which the equations depend."""
        return [(name, x) for name, x in zip(self.positions, self.rates, strict=True) if name not in self.aside]

    @property
    def kinematic_aside(self) -> list[tuple[str, Formula]]:
        """The same of the others."""
        return [(name, x) for name, x in zip(self.positions, self.rates, strict=True) if name in self.aside]

    @property
    def relations(self) -> tuple[tuple[tuple[str, str], ...], ...]:
        """Pairs of components whose products sum up: to 1 where a vector meets itself, to 0 where it meets another."""
        return tuple(tuple(zip(first, second, strict=True)) for (_, first), (_, second) in self.products)

    @property
    def products(self) -> tuple[tuple[tuple[str, tuple[str, ...]], tuple[str, tuple[str, ...]]], ...]:
        """Unit vectors and quaternions two by two, each with itself and with the others of its body."""
        return tuple(
            (first, second)
            for k, first in enumerate(self.vectors)
            for second in self.vectors[k:]
            if second is first or self.owners[k] == self.owners[self.vectors.index(second)]
        )


def equations(form: SpeedForm, scene: Scene, rows: Sequence[Polynomial] = ()) -> SpeedEquations:
    """Kane's equations as M u' = f, and the kinematic equations.

    What ``rows`` of constraints depend on is not aside either.
    """
    ring, loads = form.ring, scene.loads
    kane = Kane(form, scene)
    needed, supplied = list(map(form.shortened, kane.inertia())), list(map(form.shortened, kane.active(loads)))
    others = list(map(form.shortened, kane.active([load for load in loads if not load.conservative])))
    still = {u.rate_index: ring.zero for u in form.speeds}
    forcing = [
        form.shortened(ring.reduce(b - ring.substitute(a, still))) for a, b in zip(needed, supplied, strict=True)
    ]
    mass = [[form.shortened(a.derivative(u.rate_index)) for u in form.speeds] for a in needed]
    names = tuple(s.name for s in form.positions)
    occurring = {s.name for s in form.occurring([*needed, *supplied, *rows])}
    oriented = [(body.name, e) for body in form.oriented for e in body.orientation if set(e.components) & occurring]
    return SpeedEquations(
        mass_matrix=Matrix.of(ring, mass),
        forcing=column(ring, forcing),
        generalized_force=column(ring, others),
        speeds=tuple(u.name for u in form.speeds),
        speed_rates=tuple(u.rate_name for u in form.speeds),
        positions=names,
        rates=column(ring, [form.rates[name] for name in names]),
        needed=column(ring, needed),
        supplied=column(ring, supplied),
        vectors=tuple((e.name, e.components) for _, e in oriented),
        owners=tuple(owner for owner, _ in oriented),
        quaternions=tuple(e.name for _, e in oriented if isinstance(e, Quaternion)),
        aside=tuple(name for name in names if name not in occurring),
    )


# Problem 7 in speeds u and positions s: what is constant on every motion of  M u' = f,  s' = g.
#
# An expression I(s, u, t) is an integral if
#
#     det(M) (dI/dt + grad_s I . g) + grad_u I . adj(M) f  =  0,
#
# an identity of the ring, in which unit vectors are orthonormal (their components in terms of angles take their place
# before zero is decided).  Tried are
#
# * Jacobi's  H = sum (u_r - s0_r) dT/du_r - T - U  with  u = S q' + s0: T_2 - T_0 - U where nothing moves as
#   prescribed;
# * the momenta  sum_r dT/du_r du_r/dq'_i  of the coordinates that are left;
# * the components of the linear and angular momentum in inertial axes; with the unit vector gamma along one of them the
#   area integral  (A p + h_1) gamma_1 + (B q + h_2) gamma_2 + (C r + h_3) gamma_3;
# * dT/du_r of the declared speeds (C r of a symmetric top);
# * the squares and products of the unit vectors that occur, the norms of quaternions: what these are is known, they are
#   listed because the equations alone keep them.
#
# Others, such as those of Kovalevskaya's and Clebsch's cases, are not looked for here: problem 9 and ``mbsym
# symmetries`` do; a claim can propose them.


GEOMETRIC, NORM, SPEED_MOMENTUM = "unit vectors", "quaternion", "speed momentum"


def rate(form: SpeedForm, determinant: Polynomial, scaled: Sequence[Polynomial], x: Polynomial) -> Polynomial:
    """D dx/dt where s' = g and D u' = ``scaled``."""
    ring = form.ring
    total = ring.times(determinant, form.drift(x))
    for u, own in zip(form.speeds, scaled, strict=True):
        slope = ring.derivative(x, u.name)
        if not ring.vanishes(slope):
            total = total + ring.times(slope, own)
    return total


@dataclass(frozen=True)
class Field:
    """The vector field of a system in speeds: s' = g, u' = M^-1 f."""

    form: SpeedForm
    equations: Equations

    @cached_property
    def determinant(self) -> Polynomial:
        return determinant(self.form.ring, self.equations.mass_matrix.polynomials)

    @cached_property
    def scaled(self) -> list[Polynomial]:
        """det(M) u' by Cramer's rule."""
        forcing = [x.polynomial for x in self.equations.forcing]
        return cramer(self.form.ring, self.equations.mass_matrix.polynomials, forcing)

    def rate(self, x: Polynomial) -> Polynomial:
        """det(M) dx/dt on the motion."""
        return self.form.ring.reduce(rate(self.form, self.determinant, self.scaled, x))

    def keeps(self, x: Polynomial) -> bool | None:
        """Whether dx/dt = 0 on every motion; None where the ring cannot decide."""
        return self.form.vanishes(self.rate(x))

    def combines(self, x: Polynomial, multipliers: Sequence[Polynomial]) -> bool | None:
        """Whether dx/dt = sum mu_r (M u' - f)_r with these multipliers, as polynomials in u', too: no inverse of M."""
        ring, rows = self.form.ring, [x.polynomial for x in self.equations.equalities(())]
        return self.form.vanishes(ring.reduce(self.form.rate(x) - ring.dot(multipliers, rows)))

    def rate_in_lowest_terms(self, x: Polynomial) -> Formula:
        """dx/dt on the motion."""
        ring = self.form.ring
        return Formula(ring, ring.ratio(self.rate(x), self.determinant))


def integrals(form: SpeedForm, scene: Scene, energy: Energy, equations: SpeedEquations) -> tuple[Integral, ...]:
    """All first integrals of the kinds above, each proved."""
    ring = form.ring
    field = Field(form, equations)
    found: list[Integral] = []
    known: list[Polynomial] = []
    for integral, multipliers in candidates(form, scene, energy, equations):
        x = integral.formula.polynomial
        geometric = integral.kind in (GEOMETRIC, NORM)
        with suppress(Failure):  # what is too long is not known to be conserved
            proved = bool(multipliers) and field.combines(x, multipliers) is True
            if (proved or field.keeps(x) is True) and (geometric or is_new(form, x, known)):
                found.append(integral)
                if integral.kind not in (ENERGY, GEOMETRIC, NORM):
                    known.append(x)
    assert all(x.formula.ring is ring for x in found)
    return tuple(found)


Candidate = tuple[Integral, Sequence[Polynomial]]


def candidates(
    form: SpeedForm,
    scene: Scene,
    energy: Energy,
    equations: Equations,
    displacements: Sequence[tuple[str, Sequence[Polynomial]]] = (),
) -> Iterator[Candidate]:
    """What may be conserved, each with the multipliers that would prove it where they are known.

    ``displacements`` that constraints allow have momenta, too.
    """
    ring = form.ring
    kinetic, force = energy.kinetic_energy.polynomial, energy.force_function.polynomial
    momenta = [ring.derivative(kinetic, u.name) for u in form.speeds]
    homogeneous = [ring.context.gen(u.index) - at_rest for u, at_rest in zip(form.speeds, form.drifts, strict=True)]
    power = sum((ring.times(p, u) for p, u in zip(momenta, homogeneous, strict=True)), ring.zero)
    yield _integral(form, ENERGY, ENERGY, "time", power - kinetic - force), homogeneous
    for name, row in form.slopes.items():
        momentum = sum((ring.times(p, slope) for p, slope in zip(momenta, row, strict=True)), ring.zero)
        yield _integral(form, Message("momentum of [[name]]", name=name), "cyclic momentum", name, momentum), row
    for name, along in displacements:
        title = Message("momentum along the displacement of [[name]] that the constraints allow", name=name)
        yield _integral(form, title, "cyclic momentum", name, ring.dot(momenta, along)), along
    with suppress(Failure):
        for kind, axis, formula in whole_momenta(scene):
            yield _integral(form, momentum_title(kind, axis), kind, str(axis), formula), ()
    for u, momentum in zip(form.speeds, momenta, strict=True):
        if u.name in form.system.variables:
            yield _integral(form, f"dT/d{u.name}", SPEED_MOMENTUM, u.name, momentum), ()
    for (name, components), (other, others) in equations.products:
        pairs = [
            (ring.generator("coordinate", a), ring.generator("coordinate", b))
            for a, b in zip(components, others, strict=True)
        ]
        product = sum((ring.times(a, b) for a, b in pairs), ring.zero)
        if any(body.orientation[0].name == name for body in form.by_quaternion):
            yield _integral(form, Message("norm of [[name]]", name=name), NORM, name, product), ()
            continue
        title = (
            Message("length of [[name]]", name=name)
            if other == name
            else Message("product of [[name]] and [[other]]", name=name, other=other)
        )
        yield _integral(form, title, GEOMETRIC, name if other == name else f"{name} {other}", product), ()


def _integral(form: SpeedForm, name: str, kind: str, of: str, x: Polynomial) -> Integral:
    x = form.ring.reduce(x)
    if kind != NORM:
        x = min(x, form.of_unit_quaternions(x), key=len)
    return Integral(name, kind, of, Formula(form.ring, x), Certainty.PROVED)


def is_new(form: SpeedForm, x: Polynomial, known: Sequence[Polynomial]) -> bool:
    """Whether it depends on the state, and is no combination of the others."""
    ring, on = form.ring, form.in_angles(x)
    state = [*form.system.coordinates, *(u.name for u in form.speeds)]
    return bool(ring.dependencies(on, state)) and is_independent(ring, on, list(map(form.in_angles, known)))


# The self-check of equations in speeds: against d'Alembert's principle, through velocities of the placed bodies.
#
# With E_r = (M u' - f)_r and the oracle's residual e_i of every coordinate, at the same state,
#
#     e_i = sum_r E_r du_r/dq'_i,
#
# du/dq' from the spins of the bodies; the kinematic equations s' = g(s, u) are compared with the rates at that state.


def check_equations(truth: Oracles, found: SpeedEquations) -> Check:
    """Kane's closed equations and the kinematic ones against d'Alembert's principle."""

    def pairs(oracle: Oracle) -> list[Pair]:
        state = oracle.state
        carry = Carrier(truth.ring, state.numbers, state.values)
        mass = [[carry(entry.polynomial) for entry in row] for row in found.mass_matrix]
        errors = _errors(oracle, found.speed_rates, mass, [carry(x.polynomial) for x in found.forcing])
        balance = [carry(a.polynomial) - carry(b.polynomial) for a, b in zip(found.needed, found.supplied, strict=True)]
        names = [Message("equation [[name]] as it stands", name=u) for u in found.speeds]
        rates = [carry(x.polynomial) for x in found.rates]
        compared: list[Pair] = list(zip(names, balance, errors, strict=True))
        return compared + _against(oracle, found.speeds, found.positions, errors, rates)

    return compare(truth, "equations of motion", ("Kane, closed form", D_ALEMBERT), pairs, STATES)


def check_program(truth: Oracles, form: SpeedForm) -> Check:
    """The straight-line program in speeds against d'Alembert's principle."""
    code = speed_program(form)
    n = len(form.speeds)
    nodes = [*(x for row in code.mass_matrix for x in row), *code.forcing, *code.rates]
    speeds = [u.name for u in form.speeds]

    def pairs(oracle: Oracle) -> list[Pair]:
        values = code.program.evaluate(nodes, oracle.state.values, oracle.state.numbers)
        mass = [values[r * n : (r + 1) * n] for r in range(n)]
        forcing, rates = values[n * n : n * n + n], values[n * n + n :]
        errors = _errors(oracle, [u.rate_name for u in form.speeds], mass, forcing)
        return _against(oracle, speeds, [x.name for x in form.positions], errors, rates)

    return compare(truth, "straight-line program", ("Kane in body axes, straight-line", D_ALEMBERT), pairs, STATES)


def _errors(oracle: Oracle, rates: Sequence[str], mass: Sequence[Sequence[Any]], forcing: Sequence[Any]) -> list[Any]:
    """(M u' - f)_r at the state."""
    errors = []
    for row, force in zip(mass, forcing, strict=True):
        total = -force
        for entry, rate in zip(row, rates, strict=True):
            total = total + entry * oracle.state.values[rate]
        errors.append(total)
    return errors


def _against(
    oracle: Oracle, speeds: Sequence[str], positions: Sequence[str], errors: Sequence[Any], rates: Sequence[Any]
) -> list[Pair]:
    """e_i against sum_r E_r du_r/dq'_i, and s' against the rates at the state."""
    state, system = oracle.state, oracle.system
    columns, zero = all_slopes(oracle, speeds), state.numbers.zero
    compared: list[Pair] = []
    for i, name in enumerate(system.coordinates):
        total = sum((e * column[i] for e, column in zip(errors, columns, strict=True)), zero)
        compared.append((Message("equation [[name]]", name=name), total, oracle.residuals[name]))
    for position, rate in zip(positions, rates, strict=True):
        compared.append((f"{position}'", rate, state.values[velocity_name(position)]))
    return compared
