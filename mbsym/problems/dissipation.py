"""What the loads without a force function do to the energy and to the momenta of cyclic coordinates, in all orders.

Theorems that rest on the energy (Lagrange-Dirichlet, Routh) need  dh/dt = P <= 0  near the motion, for the generalised
energy h = q'.dL/dq' - L and the power

    P = sum Q_i q'_i,        of a dissipation function R = R_1 + R_2 + ... (parts of degree k in q')   P = -sum k R_k.

That the linear part of Q vanishes is not enough: x'' + x = x'^3 is unstable.  Where coordinates turn steadily (psi' =
omega on the motion) Routh's reduced energy takes the place of h: the sum is then over the others, provided that neither
L nor Q contains psi and Q_psi = 0.

* ``CONSERVED``: P = 0 identically, or the forces have a potential that nobody named (a dead load: a force that keeps
  its direction in space): Q depends on q alone, with dQ_i/dq_j = dQ_j/dq_i, and joins the energy.
* ``NOT_GROWING``: P <= 0 near the motion, proved: a sum of squares and even powers with coefficients of known sign, or
  a quadratic part of P that is negative definite in all the velocities that occur in P; P less that of Q(q, 0) where
  this has a potential, which joins the energy, too.
* ``GROWS``: P >= 0 near the motion and not zero, proved by the same sums.
* ``UNKNOWN``: anything else.

A dashpot between two points whose joints are moved by a prescribed motion or a steady spin takes power from these, so
nothing is claimed about it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from fractions import Fraction
from functools import cached_property
from itertools import combinations
from itertools import product as choices
from typing import Any

from mbsym.algebra.characteristic import leading_minors
from mbsym.algebra.factors import irreducible_factors, occurring, rational_ratio
from mbsym.algebra.failures import Failure
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs, sign_of_product
from mbsym.algebra.terms import apart
from mbsym.algebra.vectors import axis_vector
from mbsym.expressions.angles import angle_name
from mbsym.expressions.tree import (
    Call,
    Expression,
    Name,
    Negative,
    Operation,
    names,
)
from mbsym.mechanics.frames import forward
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import KINDS, generalized_forces
from mbsym.mechanics.motion import motion_values, relations, turning, unperturbed_with
from mbsym.mechanics.variables import expressions, rate_of
from mbsym.model.loads import (
    Load,
)
from mbsym.model.system import INERTIAL, Body, rational, velocity_name
from mbsym.problems.displacements import (
    FIELD_WORK,
    Direction,
    Displacements,
    among,
    displacements,
    independent,
    linear_fields,
    symmetries,
    turned_fields,
)
from mbsym.problems.energy import Energy
from mbsym.problems.exact_linearity import Excess, excess


class EnergyLaw(Enum):
    """What the (generalised, reduced) energy does along every motion near the unperturbed one."""

    CONSERVED = "conserved"
    NOT_GROWING = "not growing"
    UNKNOWN = "unknown"
    GROWS = "growing"

    @property
    def bounded(self) -> bool:
        """Whether the energy is proved not to grow: what Lagrange's and Routh's theorems need."""
        return self in (EnergyLaw.CONSERVED, EnergyLaw.NOT_GROWING)


#: Generators of which a polynomial vanishes as a function only where all its coefficients do.
INDEPENDENT = ("coordinate", "velocity", "sine", "cosine")

#: A formula of more products than this is not judged product by product.
MOST_PRODUCTS = 64


@dataclass(frozen=True)
class Balance:
    """``scene`` over the ring; ``energy`` is problem 2's result, or None where it has no closed form.

    ``fixed`` are numbers that stand for some of the parameters.  With ``somewhere`` the motion is any of the states of
    rest, wherever it is: then only what holds everywhere is used.
    """

    scene: Scene
    energy: Energy | None
    signs: Signs
    fixed: Mapping[int, Polynomial]
    somewhere: bool = False

    def at(self, values: Mapping[str, Any]) -> Balance:
        """The same at parameter values; irrational ones (enclosures) keep their letters, so that less is known."""
        there = replace(self, fixed=self.scene.ring.given(values))
        # What holds for all parameters holds there: no need to find it once more at every point.
        cached: dict[str, Any] = {"ignorable": self.ignorable}
        if not self._signs:  # which may be known where parameters are numbers
            cached["_nonlinear"] = self._nonlinear
        if not self.driven:
            cached["driven"] = ()
        if self.law.bounded:
            cached["law"] = self.law
        cached |= {key: value for key, value in vars(self).items() if key in ("_forces", "_here")}
        vars(there).update(cached)
        return there

    @cached_property
    def law(self) -> EnergyLaw:
        """The law of the energy, of all values there may be if it is one."""
        return self._law()

    @cached_property
    def conserves(self) -> bool:
        """Whether the energy is constant: at values it may be where it does not grow at all of them."""
        return self._law() is EnergyLaw.CONSERVED

    def _law(self) -> EnergyLaw:
        try:
            if self._knows_the_time or not self._turns_freely:
                return EnergyLaw.UNKNOWN
            return _together([self._formulas(), *(self._pair(x) for x in self._others)])
        except Failure:
            return EnergyLaw.UNKNOWN

    @cached_property
    def varies(self) -> bool:
        """Whether the energy of a system of one coordinate, which never grows or never falls, is constant on no orbit.

        P = (Q(q, q') - Q(q, 0)) q' as an analytic function: near a strict minimum of V orbits of constant energy are
        its level lines, and where P vanished on lines as near as one likes it would vanish on all rays, identically.
        So it is between the axes where Q knows |q'| or sign(q'), and is continuous: each orbit crosses both sides.
        What vanishes for some parameters is not counted.
        """
        scene, ring = self.scene, self.scene.ring
        names, forces = scene.system.coordinates, self._forces
        alone = len(names) == 1 and not (scene.system.constraints or turning(scene))
        if not alone or forces is None or self.law in (EnergyLaw.CONSERVED, EnergyLaw.UNKNOWN):
            return False
        try:
            (force,) = forces.values()
            above, _ = ring.fraction(self._put(force - ring.at_rest(force)))
        except Failure:
            return False
        sides = _one_sided(ring, above, ring.index("velocity", names[0]))
        return bool(sides) and all(map(self._somewhere, sides))

    def _somewhere(self, x: Polynomial) -> bool:
        """Whether an analytic function of q and q' vanishes identically for no parameters."""
        ring, system = self.scene.ring, self.scene.system
        of = (*system.coordinates, *system.velocities)
        moving = [k for k in occurring([x]) if ring.dependencies(ring.context.gen(k), of)]
        if any(ring.generators[k].kind not in INDEPENDENT for k in moving):
            return False
        return any(map(self.signs.never_zero, apart(x, moving).values()))

    @cached_property
    def exactly_linear(self) -> bool:
        """Whether the equations of motion have no terms of higher order at all."""
        try:
            return self._nonlinear is not None and all(self._put(x).is_zero() for x in self._nonlinear)
        except Failure:  # a formula has no value there
            return False

    @cached_property
    def _nonlinear(self) -> Excess:
        if self.energy is None or not self.scene.motions:
            return None
        return excess(self.scene, self.energy, self._velocity_rows, {} if self.somewhere else self._sliding)

    @property
    def _signs(self) -> dict[int, Polynomial]:
        """The generators sign(x), and x."""
        generators = enumerate(self.scene.ring.generators)
        return {k: g.argument for k, g in generators if g.name == "sign" and g.kind == "function" and g.argument}

    @property
    def _sliding(self) -> dict[int, Polynomial]:
        """Signs of velocities that differ from 0 on the motion, and so near it: dry friction while something slides."""
        ring, numbers = self.scene.ring, {"positive": 1, "negative": -1}
        polynomials = {}
        for k, argument in self._signs.items():
            word = "" if ring.dependencies(argument, self.scene.system.coordinates) else self._word(argument)
            if word in numbers:
                polynomials[k] = ring.number(numbers[word])
        return polynomials

    @property
    def _velocity_rows(self) -> tuple[Polynomial, ...]:
        """Of constraints: J q' + j."""
        return ()

    # --- cyclic coordinates ---

    @cached_property
    def ignorable(self) -> tuple[str, ...]:
        """The coordinates that occur neither in L nor in any other force; their velocities may."""
        known = () if self.energy is None else self.energy.cyclic
        return tuple(name for name in self.scene.system.coordinates if name in known and self._unseen(name))

    @cached_property
    def driven(self) -> tuple[str, ...]:
        """Ignorable coordinates on which forces of higher order act: their momenta need not be constant.

        Where all of Q_i is linear it shows in D and N; the momentum is constant if these have no entries.
        """
        return tuple(name for name in self.ignorable if not self._linear(name))

    def displacements(self, coordinates: Sequence[str]) -> Displacements:
        """Displacements along some coordinates that change no equation; none where there are no closed formulas."""
        return self._displacements(coordinates)

    def symmetries(self, coordinates: Sequence[str]) -> Displacements:
        """The same with those that vary with the position."""
        return among(self.scene.ring, self._fields, self.scene.system.coordinates, coordinates)

    @property
    def varying_fields(self) -> tuple[Direction, ...]:
        """Those that vary with the position, as functions of it: their flows take motions into motions."""
        return tuple(c for c, value, _ in self._symmetries if c != value)

    @property
    def _allowing(self) -> tuple[Direction, ...] | None:
        """The rows J of constraints, which allow a displacement c where J c = 0; None where they are not known."""
        return None if self.scene.system.constraints else ()

    @cached_property
    def _fields(self) -> list[tuple[Direction, Direction, bool]]:
        try:
            return independent(self.scene.ring, self.scene.system.coordinates, self._symmetries)
        except Failure:
            return []

    @cached_property
    def _symmetries(self) -> list[tuple[Direction, Direction, bool]]:
        system, ring = self.scene.system, self.scene.ring
        rows = self._allowing
        if self.energy is None or self.somewhere or self._forces is None or rows is None:
            return []
        try:
            names, moving = system.coordinates, {*turning(self.scene)}
            fields = linear_fields(ring, names)
            for body in system.bodies:
                fields += self._turned(body)
            if not fields:
                return []
            forces = self._whole_forces(self.energy, self._forces, names)
            standing = [name for name in names if name not in moving]
            with ring.budget(FIELD_WORK):
                return symmetries(
                    ring,
                    names,
                    self.energy.kinetic_energy.polynomial,
                    forces,
                    fields,
                    lambda x: ring.substitute(x, self._here),
                    standing,
                    rows,
                )
        except Failure:
            return []

    def _whole_forces(
        self, energy: Energy, applied: Mapping[str, Polynomial], names: Sequence[str]
    ) -> list[Polynomial]:
        """dU/dq_i and what is applied besides."""
        ring, u = self.scene.ring, energy.force_function.polynomial
        return [ring.reduce(ring.derivative(u, name) + applied[name]) for name in names]

    def _turned(self, body: Body) -> list[Direction]:
        """Turns of a body about axes of the frame that it hangs on, and about its own, by three angles."""
        names = [angle_name(angle) for angle in body.rotation.angles]
        own = [name for name in names if name is not None and name in self.scene.system.coordinates]
        if len({*own}) < 3 or len(names) > 3 or body.name not in self.scene.motions:
            return []
        ring, motion = self.scene.ring, self.scene.motions[body.name]
        spin = motion.relative_angular_velocity.components
        rates = [[ring.velocity_derivative(x, name) for name in own] for x in spin]
        fixed = [forward(motion.turns, axis_vector(ring, k, ring.one, body.attached_to), body.name) for k in (1, 2, 3)]
        carried = [axis_vector(ring, k, ring.one, body.name) for k in (1, 2, 3)]
        axes = [axis.components for axis in (*fixed, *carried)]
        return turned_fields(ring, self.scene.system.coordinates, own, rates, axes)

    def _displacements(
        self, coordinates: Sequence[str], rows: Sequence[tuple[Polynomial, Sequence[Polynomial]]] = ()
    ) -> Displacements:
        """``rows``: of every constraint g, and its partial derivatives by the velocities of ``coordinates``."""
        none, system, ring = Displacements(tuple(coordinates)), self.scene.system, self.scene.ring
        if self.energy is None or self.somewhere or self._forces is None:
            return none
        order = (*coordinates, *(name for name in system.coordinates if name not in coordinates))
        try:
            forces = self._whole_forces(self.energy, self._forces, order)
            moving = (*system.coordinates, *system.velocities)
            return displacements(ring, coordinates, self.energy.kinetic_energy.polynomial, forces, moving, rows)
        except Failure:
            return none

    def _unseen(self, name: str) -> bool:
        """Whether Q does not depend on a coordinate."""
        if all(name not in self._names_of(load) for load in self._without_potential):
            return True
        forces = self._forces
        return forces is not None and not any(self.scene.ring.depends_on(x, name) for x in forces.values())

    def _linear(self, name: str) -> bool:
        """Whether Q of a coordinate is a linear form in coordinates and velocities, with constant coefficients."""
        ring, own = self.scene.ring, {name, velocity_name(name)}
        acting = [load for load in self._without_potential if self._acts_on(load, name, own)]
        if not acting:
            return True
        if all(load.linear for load in acting):
            return True
        forces = self._forces
        if forces is None:
            return False
        x, coordinates = forces[name], self.scene.system.coordinates
        try:
            x = self._put(x)
            slopes = [ring.derivative(x, coordinate) for coordinate in coordinates]
            slopes += [ring.velocity_derivative(x, coordinate) for coordinate in coordinates]
        except Failure:
            return False
        moving = (*coordinates, *self.scene.system.velocities)
        return not any(ring.dependencies(slope, moving) for slope in slopes)

    def _acts_on(self, load: Load, name: str, own: set[str]) -> bool:
        if load.coordinates:
            return name in load.coordinates
        if load.dissipation_function is not None:
            return velocity_name(name) in names(load.dissipation_function)
        return bool(own & self._names_of(load))

    @cached_property
    def _forces(self) -> dict[str, Polynomial] | None:
        """Q in closed form, where it has one."""
        try:
            return generalized_forces(self.scene) if self.scene.motions else None
        except Failure:
            return None

    # --- the parts ---

    @property
    def _without_potential(self) -> list[Load]:
        return [load for load in self.scene.system.loads if not load.conservative]

    @property
    def _others(self) -> list[Load]:
        return [load for load in self._acting if not _is_formula(load)]

    @property
    def _acting(self) -> list[Load]:
        """The loads whose power has to be looked at."""
        return [load for load in self._without_potential if load not in self._gradients]

    @cached_property
    def _gradients(self) -> tuple[Load, ...]:
        """Forces that are the gradient of a function of the coordinates: together, or each by itself."""
        gradients = [load for load in self._without_potential if load.given]
        if not gradients or not self.scene.motions:
            return ()
        if self._is_gradient(gradients):
            return tuple(gradients)
        return tuple(load for load in gradients if len(gradients) > 1 and self._is_gradient([load]))

    def _is_gradient(self, loads: Sequence[Load]) -> bool:
        try:
            return self._has_potential(
                {name: self._put(x) for name, x in generalized_forces(self.scene, loads).items()}
            )
        except Failure:
            return False

    def _has_potential(self, forces: Mapping[str, Polynomial]) -> bool:
        """Whether forces are the gradient of a function of the coordinates that what turns does not know.

        Raises Failure.
        """
        ring, system = self.scene.ring, self.scene.system
        if any(ring.dependencies(x, (*system.velocities, *self._running)) for x in forces.values()):
            return False
        return self._along_motion(forces).is_zero() and all(
            ring.is_zero(ring.derivative(forces[a], b) - ring.derivative(forces[b], a)) is True
            for a, b in combinations(system.coordinates, 2)
        )

    @cached_property
    def _running(self) -> tuple[str, ...]:
        """What goes on by itself on the unperturbed motion."""
        system = self.scene.system
        return (*turning(self.scene), *(item.name for item in system.prescribed), "t")

    @property
    def _knows_the_time(self) -> bool:
        """Whether L may vary with the time; without a closed form every mention counts."""
        system = self.scene.system
        timely = {item.name for item in system.prescribed} | {"t"}
        if self.energy is None:
            return any(timely & names(expression) for expression in expressions(system))
        return any(self.scene.ring.depends_on(self._lagrangian, name) for name in timely) and not self._only_a_gauge

    @cached_property
    def _only_a_gauge(self) -> bool:
        """Whether the time stands in L as a total derivative alone: the equations do not know it, and have an energy.

        In a frame with a constant acceleration a, L = T_rel + U - m a x + d/dt (...).  With D what t and prescribed
        quantities change, D L = d/dt phi(q, t) exactly if it is c_i(q, t) q'_i + c_0(q, t) with dc_i/dq_j = dc_j/dq_i
        and D c_i = dc_0/dq_i.  Where q_i is cyclic, or turns, c_i = 0 is wanted: there its momentum does not know
        the time, and phi has no share in what goes on along it.
        """
        ring, system = self.scene.ring, self.scene.system

        def changed(x: Polynomial) -> Polynomial:
            return self._put(rate_of(ring, self.scene.lower, system, x))

        try:
            left = changed(self._lagrangian)
            slopes = {name: ring.velocity_derivative(left, name) for name in system.coordinates}
            if any(ring.dependencies(x, system.velocities) for x in slopes.values()):
                return False
            if any(ring.is_zero(slopes[name]) is not True for name in {*turning(self.scene), *self.ignorable}):
                return False
            rest = ring.at_rest(left)
            return all(
                ring.is_zero(ring.derivative(slopes[a], b) - ring.derivative(slopes[b], a)) is True
                for a, b in combinations(system.coordinates, 2)
            ) and all(ring.is_zero(changed(x) - ring.derivative(rest, name)) is True for name, x in slopes.items())
        except Failure:
            return False

    @property
    def _turns_freely(self) -> bool:
        """Whether the steady motion goes on along a symmetry of L, so that a reduced energy exists.

        A cyclic coordinate turns, or several so that sum of rate_i dL/dq_i = 0: h - sum of rate_i p_i is constant.
        """
        if self.energy is None:
            return not turning(self.scene)
        ring, running = self.scene.ring, turning(self.scene)
        if not any(ring.depends_on(self._lagrangian, name) for name in running):
            return True
        slopes = {name: ring.derivative(self._lagrangian, name) for name in running}
        return ring.is_zero(self._along_motion(slopes)) is True

    def _along_motion(self, covector: Mapping[str, Polynomial]) -> Polynomial:
        """The sum of rate_i times the i-th component over what turns steadily."""
        ring, rates = self.scene.ring, motion_values(self.scene.system)
        images = relations(self.scene)
        parts = (
            ring.times(ring.substitute(self.scene.lower(rates[name][1]), images), covector[name])
            for name in turning(self.scene)
        )
        return self._put(ring.reduce(sum(parts, ring.zero)))

    def _same_along_motion(self) -> bool:
        """Whether the forces do no work along the steady motion and are the same functions wherever it has gone to.

        Then their power is that of the velocities beside those of the motion.
        """
        ring, running, forces = self.scene.ring, turning(self.scene), self._forces
        if forces is None or not self._along_motion(forces).is_zero():
            return False
        for x in forces.values():
            moved = self._along_motion({name: ring.derivative(x, name) for name in running})
            faster = self._along_motion({name: ring.velocity_derivative(x, name) for name in running})
            if not moved.is_zero() or not faster.is_zero():
                return False
        return True

    @property
    def _lagrangian(self) -> Polynomial:
        assert self.energy is not None
        return self.energy.kinetic_energy.polynomial + self.energy.force_function.polynomial

    def _put(self, x: Polynomial) -> Polynomial:
        return self.scene.ring.substitute(x, dict(self.fixed)) if self.fixed else x

    # --- signs near the motion ---

    @cached_property
    def _here(self) -> dict[int, Polynomial]:
        return unperturbed_with(self.scene, relations(self.scene))

    def _on_motion(self, x: Polynomial) -> Polynomial | None:
        """A formula on the motion; None where it varies with the time there, or where the motion is not known."""
        ring = self.scene.ring
        if not self.somewhere:
            x = ring.substitute(x, self._here)
        elif ring.dependencies(x, self.scene.system.coordinates):
            return None
        return None if ring.dependencies(x, self._running) else self._put(x)

    def _word(self, x: Polynomial) -> str:
        """The sign of a formula near the motion: positive, negative, zero, nonnegative, nonpositive or unknown.

        What is positive on the motion is so near it; what varies with the time there has no least value.
        """
        word = self.signs.sign(self._put(x))
        if word not in ("unknown", "nonzero"):
            return word
        here = self._on_motion(x)
        strict = "unknown" if here is None else self.signs.sign(here)
        return strict if strict in ("positive", "negative") else "unknown"

    # --- loads that are formulas ---

    def _formulas(self) -> EnergyLaw:
        """The power of dampers of coordinates, dissipation functions and generalised forces together."""
        system = self.scene.system
        loads = [load for load in self._acting if _is_formula(load)]
        spinning = {x for name in turning(self.scene) for x in (name, velocity_name(name))}
        if any(spinning & self._names_of(load) for load in loads) and not self._same_along_motion():
            return EnergyLaw.UNKNOWN
        given_loads = [load for load in loads if load.given]
        if (
            len(given_loads) < len(loads) and given_loads and self._loss(given_loads).is_zero()
        ):  # gyroscopic ones: the others decide
            loads = [load for load in loads if not load.given]
        static = self._static(loads)
        words = [word for load in loads for word in self._losses(load, bool(static))]
        if {*words} <= {"zero"}:
            return EnergyLaw.CONSERVED
        if {*words} <= {"zero", "positive", "nonnegative"}:
            return EnergyLaw.NOT_GROWING
        if {*words} <= {"zero", "negative", "nonpositive"}:
            return EnergyLaw.GROWS
        loss = self._loss(loads) + self._power(static)
        return _Loss(self, self.scene.ring, tuple(system.coordinates), self._put(self.scene.ring.reduce(loss))).law

    def _static(self, loads: Sequence[Load]) -> dict[str, Polynomial]:
        """Q(q, 0) of some loads together where it has a potential, which joins the energy; else nothing."""
        ring = self.scene.ring
        forces: dict[str, Polynomial] = {}
        try:
            for load in loads:
                for name, force in KINDS[type(load)].action(load, self.scene).generalized.items():
                    forces[name] = forces.get(name, ring.zero) + self._put(ring.at_rest(force))
            every = {name: ring.reduce(forces.get(name, ring.zero)) for name in self.scene.system.coordinates}
            return every if self._has_potential(every) else {}
        except Failure:
            return {}

    def _power(self, forces: Mapping[str, Polynomial]) -> Polynomial:
        ring = self.scene.ring
        return ring.dot(list(forces.values()), [ring.generator("velocity", name) for name in forces])

    def _loss(self, loads: Sequence[Load]) -> Polynomial:
        """-P of some loads together."""
        ring = self.scene.ring
        powers = (self._power(KINDS[type(load)].action(load, self.scene).generalized) for load in loads)
        return ring.reduce(-sum(powers, ring.zero))

    def _losses(self, load: Load, moving: bool) -> Iterator[str]:
        """The signs of parts of -P, product by product; ``moving``: without those of forces that know no velocity."""
        if load.damping is not None:
            yield self._word(self.scene.lower(load.damping))
        if load.dissipation_function is not None:
            for product in _products(load.dissipation_function):
                degree = self._degree(product)
                yield "unknown" if degree is None else "zero" if degree == 0 else self._product_word(product)
        for name, force in zip(load.coordinates, load.given, strict=False):
            for product in _products(force):
                if moving and not any({*self.scene.system.velocities} & names(base) for base, _ in product.powers):
                    continue
                power = _Product(Fraction(1), ((Name(velocity_name(name)), 1),)) * product
                yield sign_of_product("negative", self._product_word(power))

    def _degree(self, product: _Product) -> int | None:
        """The degree of a product in the velocities; None where it is not homogeneous."""
        total = 0
        for base, exponent in product.powers:
            degrees = self._degrees(base)
            if len(degrees) != 1:
                return None
            total += exponent * next(iter(degrees))
        return total

    def _degrees(self, base: Expression) -> set[int]:
        """The degrees in the velocities of the parts of a formula; two of them where it is no polynomial in them.

        |u| is homogeneous as u is (for positive factors, which is all that Euler's theorem asks for).
        """
        ring = self.scene.ring
        if isinstance(base, Call) and base.function == "abs":
            return self._degrees(base.argument)
        parts = _by_velocities(ring, self.scene.lower(base), self.scene.system.coordinates)
        return {0, 1} if parts is None else {sum(exponents) for exponents in parts} or {0}

    def _product_word(self, product: _Product) -> str:
        word = "positive" if product.number > 0 else "negative" if product.number < 0 else "zero"
        for base, exponent in product.powers:
            word = sign_of_product(word, self._power_word(base, exponent))
        return word

    def _power_word(self, base: Expression, exponent: int) -> str:
        if exponent % 2 == 0 or (isinstance(base, Call) and base.function in ("abs", "sqrt", "exp", "cosh")):
            return "nonnegative"
        if not any(velocity in names(base) for velocity in self.scene.system.velocities):
            return self._word(self.scene.lower(base))
        if isinstance(base, Operation) and base.operator in "+-*":
            words = {self._product_word(product) for product in _products(base)} - {"zero"}
            if words <= {"positive", "nonnegative"}:
                return "nonnegative"
            if words <= {"negative", "nonpositive"}:
                return "nonpositive"
        return "unknown"

    # --- loads between bodies ---

    def _pair(self, load: Load) -> EnergyLaw:
        """A dashpot, force or torque."""
        if load.given:
            still = all(self._word(self.scene.lower(x)) == "zero" for x in load.given)
            return EnergyLaw.CONSERVED if still else EnergyLaw.UNKNOWN
        if load.damping is None:
            return EnergyLaw.UNKNOWN
        word = self._word(self.scene.lower(load.damping))
        if word == "zero":
            return EnergyLaw.CONSERVED
        if {*self._running} & self._names_of(load):
            return EnergyLaw.UNKNOWN
        if word in ("positive", "nonnegative"):
            return EnergyLaw.NOT_GROWING
        return EnergyLaw.GROWS if word in ("negative", "nonpositive") else EnergyLaw.UNKNOWN

    def _names_of(self, load: Load) -> set[str]:
        """The names that a load's force can depend on: those of its formulas, and of the joints between its bodies.

        A dashpot along a line knows only what moves its ends with respect to each other.
        """
        system = self.scene.system
        dependencies = {name for x in expressions(load) for name in names(x)}
        dependencies |= {x for name in load.coordinates for x in (name, velocity_name(name))}
        if load.bodies is None:  # it depends on places in space: on anything
            return dependencies | {*system.coordinates, *system.velocities}
        paths = [system.path(name) for name in load.bodies]
        common: set[str] = {INERTIAL}
        if load.along_line:
            common |= {*paths[0]} & {*paths[1]}
        for body in {name for path in paths for name in path} - common:
            part = system.body(body)
            moved = {name for x in expressions((part.rotation, part.connection_point)) for name in names(x)}
            dependencies |= moved | {velocity_name(name) for name in moved & {*system.coordinates}}
        return dependencies


def _is_formula(load: Load) -> bool:
    """Whether its generalised forces are formulas in q and q' and need no kinematics."""
    return load.bodies == ()


def _together(laws: Sequence[EnergyLaw]) -> EnergyLaw:
    """The law of a sum of powers."""
    acting = {law for law in laws if law is not EnergyLaw.CONSERVED}
    if not acting:
        return EnergyLaw.CONSERVED
    return acting.pop() if len(acting) == 1 else EnergyLaw.UNKNOWN


# --- products ---


@dataclass(frozen=True)
class _Product:
    """``number`` times powers of formulas."""

    number: Fraction
    powers: tuple[tuple[Expression, int], ...] = ()

    def __mul__(self, other: _Product) -> _Product:
        powers: dict[Expression, int] = dict(self.powers)
        for base, exponent in other.powers:
            powers[base] = powers.get(base, 0) + exponent
        return _Product(self.number * other.number, tuple((b, e) for b, e in powers.items() if e))


def _products(expression: Expression) -> list[_Product]:
    """Sums multiplied out, powers kept: the expression as a sum of products.

    Raises Failure where there are too many.
    """
    value = rational(expression)
    if value is not None:
        return [_Product(value)]
    match expression:
        case Negative(operand):
            return [_Product(-product.number, product.powers) for product in _products(operand)]
        case Operation("+", left, right):
            products = [*_products(left), *_products(right)]
        case Operation("-", left, right):
            products = [*_products(left), *_products(Negative(right))]
        case Operation("*", left, right):
            firsts, seconds = _products(left), _products(right)
            if len(firsts) * len(seconds) > MOST_PRODUCTS:
                raise Failure("too many products")
            products = [a * b for a, b in choices(firsts, seconds)]
        case Operation("/", left, right):
            bottom = rational(right)
            below = _Product(1 / bottom) if bottom else _Product(Fraction(1), ((right, -1),))
            products = [product * below for product in _products(left)]
        case Operation("**", base, exponent) if (times := rational(exponent)) is not None and times.denominator == 1:
            products = [_Product(Fraction(1), ((base, int(times)),))]
        case _:
            products = [_Product(Fraction(1), ((expression, 1),))]
    if len(products) > MOST_PRODUCTS:
        raise Failure("too many products")
    return products


# --- polynomials in the velocities ---


def _by_velocities(ring: Ring, x: Polynomial, coordinates: Sequence[str]) -> dict[tuple[int, ...], Polynomial] | None:
    """{exponents of the velocities: coefficient}; None where a velocity stands under a root or a function."""
    indices = [ring.index("velocity", name) for name in coordinates]
    used = occurring([x])
    speeds = [velocity_name(name) for name in coordinates]
    for k in used:
        if k not in indices and ring.dependencies(ring.context.gen(k), speeds):
            return None
    return apart(x, indices)


def _one_sided(ring: Ring, x: Polynomial, velocity: int) -> tuple[Polynomial, ...]:
    """x where q' > 0 and where q' < 0, of a function that is continuous at q' = 0; itself where both are one.

    Nothing where it knows signs, moduli or tables of anything else.
    """
    kinked = [k for k in occurring([x]) if ring.generators[k].kinked]
    if not kinked:
        return (x,)
    speed, sides = ring.context.gen(velocity), []
    ratios = {k: rational_ratio(ring.generators[k].argument, speed) for k in kinked}
    for side in (1, -1):
        images = dict(enumerate(ring.context.gens()))
        for k, ratio in ratios.items():
            if ratio is None or ring.generators[k].name not in ("abs", "sign"):
                return ()
            turn = side if ratio > 0 else -side
            images[k] = turn * ratio * speed if ring.generators[k].name == "abs" else images[k] * 0 + turn
        sides.append(x.compose(*images.values(), ctx=ring.context))
    return () if any(ring.at_rest(side) != 0 for side in sides) else tuple(sides)


@dataclass(frozen=True)
class _Loss:
    """-P as one polynomial: its parts by degree, or its quadratic part alone."""

    balance: Balance
    ring: Ring
    coordinates: tuple[str, ...]
    loss: Polynomial

    @property
    def law(self) -> EnergyLaw:
        parts = _by_velocities(self.ring, self.loss, self.coordinates)
        if parts is None:
            return EnergyLaw.UNKNOWN
        if not parts:
            return EnergyLaw.CONSERVED
        if min(map(sum, parts)) < 2:
            return EnergyLaw.UNKNOWN
        if self._even(parts) or self._definite(parts) or self._by_degree(parts) or self._beside_squares():
            return EnergyLaw.NOT_GROWING
        return EnergyLaw.UNKNOWN

    def _beside_squares(self) -> bool:
        """-P = s^2 r with r nowhere negative: in other coordinates squares of sums are written out."""
        unit, powers = irreducible_factors(self.loss)
        rest = self.loss * 0 + unit
        for factor, exponent in powers:
            rest = rest * factor if exponent % 2 else rest
        parts = _by_velocities(self.ring, rest, self.coordinates)
        return parts is not None and self._by_degree(parts)

    def _even(self, parts: Mapping[tuple[int, ...], Polynomial]) -> bool:
        """Even powers only, with coefficients that are not negative."""
        return all(
            not any(exponent % 2 for exponent in key) and self.balance._word(x) in ("positive", "nonnegative", "zero")
            for key, x in parts.items()
        )

    def _matrix(self, parts: Mapping[tuple[int, ...], Polynomial], at: Sequence[int]) -> list[list[Polynomial]]:
        """The matrix D of the quadratic part u.D u, twice, in the velocities ``at``."""
        rows = []
        for i in at:
            row = []
            for j in at:
                key = tuple((k == i) + (k == j) for k in range(len(self.coordinates)))
                row.append(parts.get(key, self.ring.zero) * (2 if i == j else 1))
            rows.append(row)
        return rows

    def _occurring(self, parts: Mapping[tuple[int, ...], Polynomial]) -> list[int]:
        return [k for k in range(len(self.coordinates)) if any(key[k] for key in parts)]

    def _definite(self, parts: Mapping[tuple[int, ...], Polynomial]) -> bool:
        """Whether the quadratic part is positive definite on the motion in all velocities that occur.

        Terms of higher order in q' are smaller near it.
        """
        balance, at = self.balance, self._occurring(parts)
        if self.ring.dependencies(self.loss, balance._running):
            return False  # how near depends on the time
        here = []
        for row in self._matrix(parts, at):
            entries = [balance._on_motion(x) for x in row]
            if any(x is None for x in entries):
                return False
            here.append(entries)
        return all(balance.signs.sign(self.ring.reduce(minor)) == "positive" for minor in leading_minors(here))

    def _by_degree(self, parts: Mapping[tuple[int, ...], Polynomial]) -> bool:
        """Every part of one degree for itself: even powers, or a quadratic form that is nowhere negative."""
        for degree in {sum(key) for key in parts}:
            part = {key: x for key, x in parts.items() if sum(key) == degree}
            if not self._even(part) and not (degree == 2 and self._semidefinite(part)):
                return False
        return True

    def _semidefinite(self, parts: Mapping[tuple[int, ...], Polynomial]) -> bool:
        """By completing squares: a pivot that is positive, the rest reduced by it (times the pivot), and so on."""
        ring, signs = self.ring, self.balance.signs
        rows = self._matrix(parts, self._occurring(parts))
        while rows:
            size = range(len(rows))
            pivot = next((i for i in size if signs.sign(rows[i][i]) == "positive"), None)
            if pivot is None:
                return all(x.is_zero() for row in rows for x in row)
            top, rest = rows[pivot], [i for i in size if i != pivot]
            rows = [
                [ring.reduce(ring.times(top[pivot], rows[i][j]) - ring.times(rows[i][pivot], top[j])) for j in rest]
                for i in rest
            ]
        return True


def balance(scene: Scene, energy: Energy | None, signs: Signs, somewhere: bool = False) -> Balance:
    """What is known of the energy and of cyclic momenta (scene over the ring, with its bodies where it has them)."""
    return Balance(scene, energy, signs, {}, somewhere)
