"""Problems 3 and 7 in velocities of their own: speeds u with q' = Y(q) u + y0(q, t).

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

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Column, Formula, Matrix, column
from mbsym.mechanics.kane import Kane
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.speeds import Quaternion
from mbsym.problems.constraints.result import Constraints
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Embedded, Equations
from mbsym.problems.integrals import (
    ABOUT_CONTACT,
    ENERGY,
    Integral,
    about_contacts,
    momentum_title,
    whole_momenta,
)


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
    matrix, right = Matrix.of(ring, mass), column(ring, forcing)
    own, names = tuple(u.name for u in form.speeds), tuple(s.name for s in form.positions)
    occurring = {s.name for s in form.occurring([*needed, *supplied, *rows])}
    oriented = [(body.name, e) for body in form.oriented for e in body.orientation if set(e.components) & occurring]
    return SpeedEquations(
        mass_matrix=matrix,
        forcing=right,
        generalized_force=column(ring, others),
        constraints=Constraints.none(ring, own, in_speeds=True),
        embedded=Embedded(own, matrix, right),
        speeds=own,
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


# Problem 7 in speeds u and positions s: what may be constant on every motion of  M u' = f,  s' = g.  Tried are
#
# * Jacobi's  H = sum (u_r - s0_r) dT/du_r - T - U  with  u = S q' + s0: T_2 - T_0 - U where nothing moves as
#   prescribed;
# * the momenta  sum_r dT/du_r du_r/dq'_i  of the coordinates that are left;
# * the components of the linear and angular momentum in inertial axes; with the unit vector gamma along one of them the
#   area integral  (A p + h_1) gamma_1 + (B q + h_2) gamma_2 + (C r + h_3) gamma_3;
# * the components of the angular momentum about the contact of what rolls (a ball on a turntable keeps them);
# * dT/du_r of the declared speeds (C r of a symmetric top);
# * the squares and products of the unit vectors that occur, the norms of quaternions: what these are is known, they are
#   listed because the equations alone keep them.
#
# Others, such as those of Kovalevskaya's and Clebsch's cases, are not looked for here: problem 9 and ``mbsym
# symmetries`` do; a claim can propose them.


GEOMETRIC, NORM, SPEED_MOMENTUM = "unit vectors", "quaternion", "speed momentum"

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
        momenta_of_all = whole_momenta(scene)
        for kind, axis, formula in momenta_of_all:
            yield _integral(form, momentum_title(kind, axis), kind, str(axis), formula), ()
        text = "angular momentum about the contact of [[body]], axis [[axis]]"
        for of, body, axis, formula in about_contacts(scene, momenta_of_all):
            yield _integral(form, Message(text, body=body, axis=axis), ABOUT_CONTACT, of, formula), ()
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
