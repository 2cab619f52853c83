"""Problem 7 in speeds u and positions s: what is constant on every motion of  M u' = f,  s' = g.

An expression I(s, u, t) is an integral if

    det(M) (dI/dt + grad_s I . g) + grad_u I . adj(M) f  =  0,

an identity of the ring, in which unit vectors are orthonormal (their components in terms of angles take their place
before zero is decided).  Tried are

* Jacobi's  H = sum (u_r - s0_r) dT/du_r - T - U  with  u = S q' + s0: T_2 - T_0 - U where nothing moves as prescribed;
* the momenta  sum_r dT/du_r du_r/dq'_i  of the coordinates that are left;
* the components of the linear and angular momentum in inertial axes; with the unit vector gamma along one of them the
  area integral  (A p + h_1) gamma_1 + (B q + h_2) gamma_2 + (C r + h_3) gamma_3;
* dT/du_r of the declared speeds (C r of a symmetric top);
* the squares and products of the unit vectors that occur, the norms of quaternions: what these are is known, they are
  listed because the equations alone keep them.

Others, such as those of Kovalevskaya's and Clebsch's cases, are not looked for here: problem 9 and ``mbsym symmetries``
do; a claim can propose them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.algebra.matrices import cramer, determinant
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speeds import SpeedForm
from mbsym.problems.energy import Energy
from mbsym.problems.equations import Equations
from mbsym.problems.in_speeds.speeds import SpeedEquations
from mbsym.problems.integrals import ENERGY, Integral, momentum_title, whole_momenta

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
        return Formula(ring, ring.reduce(ring.times(self.rate(x), ring.reciprocal(self.determinant))))


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
    for name, slopes in form.slopes.items():
        momentum = sum((ring.times(p, slope) for p, slope in zip(momenta, slopes, strict=True)), ring.zero)
        yield _integral(form, Message("momentum of [[name]]", name=name), "cyclic momentum", name, momentum), slopes
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
    """Whether it depends on the state, and is none of the others."""
    ring = form.ring
    state = [*form.system.coordinates, *(u.name for u in form.speeds)]
    if not ring.dependencies(form.in_angles(x), state):
        return False
    return not any(form.vanishes(x - sign * other) for other in known for sign in (1, -1))
