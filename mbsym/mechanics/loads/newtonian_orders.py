"""The Newtonian field of a centre beyond the second order: orders 3 and 4, and the exact distances.

A body has the mass m, the mass centre at r = R e + c from the attracting centre (e the unit vector to the point O1 of
expansion, c from O1) and the inertia Theta about its mass centre.

* **exact**: the exact distance of every mass centre, with MacCullagh's formula for the extent of the body,

      U = nu m/|r| + nu/(2 |r|^3) (tr Theta - 3 r.Theta r/|r|^2),

  exact for point masses; third and higher central moments, which a description does not contain, are dropped.
* **order N**: the Taylor polynomial of this in (size)/R, c and the extent of the bodies counted alike (so Theta counts
  twice), up to the total degree N.  With x = e.c, y = c.c and the polynomials P_k(x, y) = |c|^k Legendre_k(x/|c|),

      degree k of the first term  (-1)^k nu m P_k / R^(k+1)
      degree 2 of the second      nu/(2 R^3) [ tr Theta - 3 e.Theta e ]
      degree 3                    nu/(2 R^4) [ -3 x tr Theta + 15 x e.Theta e - 6 e.Theta c ]
      degree 4                    nu/(2 R^5) [ (15 x^2 - 3 y)/2 tr Theta - (105 x^2 - 15 y)/2 e.Theta e
                                               + 30 x e.Theta c - 3 c.Theta c ].

The wrenches are stated independently, from the force and torque of the exact field,

    F = -nu m r/|r|^3 - nu (3/2) [ tr Theta r + 2 Theta r ]/|r|^5 + nu (15/2) (r.Theta r) r/|r|^7,
    L = 3 nu r x Theta r/|r|^5,

expanded through |e + s c|^-n = sum (-1)^k s^k C_k with the Gegenbauer polynomials C_k of index n/2, s = 1/R.

Sources: Kellogg, Foundations of Potential Theory, ch. V (Legendre's expansion, MacCullagh's formula); Abramowitz and
Stegun 22.7.3 and 22.7.10 (the recurrences of the Gegenbauer and Legendre polynomials).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Generic

from mbsym.algebra.base import Algebra, S
from mbsym.algebra.vectors import Vector
from mbsym.mechanics.kinematics import BodyMotion, Scene
from mbsym.mechanics.loads.interface import Action, Wrench
from mbsym.mechanics.loads.orbit import Orbit, central_inertia, completed, radius_vectors, trace
from mbsym.model.loads import EXACT, NewtonianGravity


def order_force_function(load: NewtonianGravity, scene: Scene[S]) -> S:
    """U of the orders 3 and 4 and of the exact field, summed over the bodies."""
    if load.order == EXACT:
        return _exact_force_function(load, scene)
    algebra, order = scene.algebra, int(load.order)
    orbit = Orbit(load, scene)
    by_degree = [algebra.zero] * (order + 1)
    for motion, e, c in orbit.bodies():
        x, y = e.dot(c), c.dot(c)
        for degree, polynomial in enumerate(legendre(algebra, x, y, order)):
            sign = algebra.number((-1) ** degree)
            by_degree[degree] = by_degree[degree] + algebra.times(sign, algebra.times(motion.mass, polynomial))
        for degree, value in _spread(scene, motion, e, c, x, y, order).items():
            by_degree[degree] = by_degree[degree] + value
    total, factor = algebra.zero, orbit.first
    if orbit.falling:
        by_degree[:2] = [algebra.zero, algebra.zero]
    for value in by_degree:
        total = total + algebra.times(factor, algebra.reduce(value))
        factor = algebra.times(factor, orbit.inverse)
    return algebra.reduce(total)


def legendre(algebra: Algebra[S], x: S, y: S, order: int) -> list[S]:
    """P_0 to P_order, homogeneous: the coefficients of (1 - 2 s x + s^2 y)^(-1/2) in powers of s."""
    return gegenbauer(algebra, -x, y, 1, order)


def _spread(scene: Scene[S], motion: BodyMotion[S], e: Vector[S], c: Vector[S], x: S, y: S, order: int) -> dict[int, S]:
    """MacCullagh's term by its degree, without nu/R^(degree + 1)."""
    tensor = central_inertia(scene, motion)
    if tensor is None:
        return {}
    algebra = scene.algebra
    turned, t = tensor @ e, trace(tensor)
    ee, ec = e.dot(turned), c.dot(turned)

    def sum_of(*terms: tuple[Fraction | int, S, S]) -> S:
        total = algebra.zero
        for number, first, second in terms:
            total = total + algebra.times(algebra.number(number), algebra.times(first, second))
        return algebra.reduce(total)

    one, half = algebra.one, Fraction(1, 2)
    terms_by_degree = {2: sum_of((half, t, one), (-3 * half, ee, one))}
    if order >= 3:
        terms_by_degree[3] = sum_of((-3 * half, x, t), (15 * half, x, ee), (-3, ec, one))
    if order >= 4:
        cc, xx = c.dot(tensor @ c), algebra.times(x, x)
        pair = sum_of((15 * half, xx, one), (-3 * half, y, one))
        quartet = sum_of((105 * half, xx, one), (-15 * half, y, one))
        terms_by_degree[4] = sum_of((half, pair, t), (-half, quartet, ee), (15, x, ec), (-3 * half, cc, one))
    return terms_by_degree


# --- wrenches ---


def order_action(load: NewtonianGravity, scene: Scene[S]) -> Action[S]:
    """Forces at the mass centres and torques, of the orders 3 and 4 and of the exact field.

    Where O1 moves and the bodies stay, p = R e and c change oppositely.  In the exact field this changes nothing,
    degree by degree: dU_k/dp = dU_(k+1)/dc.  So of the truncated field there is left on O1 the force of the next
    degree, sum of dU_(N+1)/dc.
    """
    if load.order == EXACT:
        return _exact_action(load, scene)
    algebra, order = scene.algebra, int(load.order)
    orbit = Orbit(load, scene)
    factors = [orbit.first]  # nu/R, nu/R^2, ...
    for _ in range(order + 1):
        factors.append(algebra.times(factors[-1], orbit.inverse))
    expansions = [(motion, _Expansion(scene, motion, e, c, order)) for motion, e, c in orbit.bodies()]
    wrenches = []
    for motion, expansion in expansions:
        force = torque = scene.zero(motion.body.name)
        for degree in range(1 if orbit.falling else 0, order):
            force = force + expansion.force(degree) * factors[degree + 1]
        if expansion.tensor is not None:
            for degree in range(2, order + 1):
                torque = torque + expansion.torque(degree) * factors[degree]
        wrenches.append(Wrench(motion.body.name, force, motion.mass_centre.cross(force) + torque))

    def on_the_expansion_point() -> Wrench[S]:
        left = nothing = scene.zero(load.about)
        for _, expansion in expansions:
            left = left + scene.to_axes(expansion.force(order), load.about)
        return Wrench(load.about, left * factors[order + 1], nothing)

    return completed(load, scene, wrenches, on_the_expansion_point)


class _Expansion(Generic[S]):
    """Forces and torques on one body by their degree, without nu and powers of R."""

    def __init__(self, scene: Scene[S], motion: BodyMotion[S], e: Vector[S], c: Vector[S], order: int) -> None:
        algebra = self.algebra = scene.algebra
        self.mass, self.e, self.c = motion.mass, e, c
        x, y = e.dot(c), c.dot(c)
        self.third = gegenbauer(algebra, x, y, 3, order)
        self.tensor = central_inertia(scene, motion)
        if self.tensor is not None:
            self.fifth = gegenbauer(algebra, x, y, 5, order)
            self.seventh = gegenbauer(algebra, x, y, 7, order)
            self.turned = (self.tensor @ e, self.tensor @ c)
            twice = algebra.times(algebra.number(2), e.dot(self.turned[1]))
            self.quadratic = (e.dot(self.turned[0]), twice, c.dot(self.turned[1]))
            self.trace = trace(self.tensor)

    def _along(self, series: list[S], k: int, pair: tuple[Vector[S], Vector[S]]) -> Vector[S]:
        """The coefficient of s^k in series (first + s second)."""
        vector = pair[0] * series[k]
        return vector + pair[1] * series[k - 1] if k else vector

    def force(self, degree: int) -> Vector[S]:
        """The coefficient of nu/R^(degree + 2) in the force."""
        algebra = self.algebra
        r = (self.e, self.c)
        less = -self.mass
        total = self._along(self.third, degree, r) * less
        if self.tensor is not None and degree >= 2:
            k = degree - 2
            spread = self._along(self.fifth, k, r) * self.trace
            two = algebra.number(2)
            spread = spread + self._along(self.fifth, k, self.turned) * two
            total = total - spread * algebra.number(Fraction(3, 2))
            central = [self._product(self.seventh, i) for i in range(k + 1)]
            along = self._along(central, k, r)
            total = total + along * algebra.number(Fraction(15, 2))
        return total.reduced()

    def _product(self, series: list[S], k: int) -> S:
        """The coefficient of s^k in series (e + s c).Theta (e + s c)."""
        total = self.algebra.zero
        for i, value in enumerate(self.quadratic[: k + 1]):
            total = total + self.algebra.times(series[k - i], value)
        return self.algebra.reduce(total)

    def torque(self, degree: int) -> Vector[S]:
        """The coefficient of nu/R^(degree + 1) in the torque."""
        algebra, k = self.algebra, degree - 2
        e, c = self.e, self.c
        total = e.cross(self.turned[0]) * self.fifth[k]
        if k >= 1:
            mixed = e.cross(self.turned[1]) + c.cross(self.turned[0])
            total = total + mixed * self.fifth[k - 1]
        if k >= 2:
            total = total + c.cross(self.turned[1]) * self.fifth[k - 2]
        return total * algebra.number(3)


def gegenbauer(algebra: Algebra[S], x: S, y: S, exponent: int, order: int) -> list[S]:
    """The coefficients q_0 to q_order of (1 + 2 s x + s^2 y)^(-exponent/2) = |e + s c|^-exponent in powers of s:

    k q_k = -(2k + exponent - 2) x q_(k-1) - (k + exponent - 2) y q_(k-2).
    """
    coefficients = [algebra.one, algebra.times(algebra.number(-exponent), x)]
    for k in range(2, order + 1):
        ahead = algebra.times(algebra.number(Fraction(2 * k + exponent - 2, k)), algebra.times(x, coefficients[-1]))
        behind = algebra.times(algebra.number(Fraction(k + exponent - 2, k)), algebra.times(y, coefficients[-2]))
        coefficients.append(algebra.reduce(-ahead - behind))
    return coefficients


# --- exact ---


def _inverse_distance(algebra: Algebra[S], r: Vector[S]) -> tuple[S, S]:
    """1/|r| and 1/|r|^2."""
    square = r.dot(r)
    inverse = algebra.reciprocal(square)
    return algebra.reduce(algebra.times(algebra.square_root(square), inverse)), inverse


class _Falling(Generic[S]):
    """The exact monopole field of unit mass beyond its value at O1, without differences of nearly equal numbers.

    With x = e.c, y = c.c, u = 2 x/R + y/R^2 and s = sqrt(1 + u) = |r|/R (Encke's method; Battin, An Introduction to the
    Mathematics and Methods of Astrodynamics, 1987, section 9.4):

        force   -nu/R^3 [ c + f (R e + c) ],        f = s^-3 - 1 = -u (1 + s + s^2)/(s^3 (1 + s))
        U        nu/R [ 1/s - 1 + x/R ]  =  nu/(2 R) [ u^2 (s + 2)/(s (1 + s)^2) - y/R^2 ]
    """

    def __init__(self, orbit: Orbit[S], e: Vector[S], c: Vector[S]) -> None:
        algebra = self.algebra = orbit.scene.algebra
        self.orbit, self.e, self.c = orbit, e, c
        scaled = c * orbit.inverse
        self.y = scaled.dot(scaled)
        self.u = algebra.times(algebra.number(2), e.dot(scaled)) + self.y
        self.s = algebra.square_root(algebra.reduce(algebra.one + self.u))

    def force(self) -> Vector[S]:
        algebra, s = self.algebra, self.s
        square = algebra.times(s, s)
        top = algebra.times(self.u, algebra.one + s + square)
        bottom = algebra.times(algebra.times(square, s), algebra.one + s)
        f = -algebra.times(top, algebra.reciprocal(bottom))
        along = self.e * algebra.times(f, self.orbit.square)
        across = self.c * algebra.times(algebra.one + f, self.orbit.cube)
        return -(along + across)

    def potential(self) -> S:
        algebra, s = self.algebra, self.s
        more = algebra.one + s
        top = algebra.times(algebra.times(self.u, self.u), s + algebra.number(2))
        quotient = algebra.times(top, algebra.reciprocal(algebra.times(s, algebra.times(more, more))))
        half = algebra.times(algebra.number(Fraction(1, 2)), self.orbit.first)
        return algebra.times(half, quotient - self.y)


def _fallen(load: NewtonianGravity, scene: Scene[S]) -> dict[str, _Falling[S]]:
    """The field of every body that a falling frame carries; nothing where the frame does not fall."""
    if load.about not in scene.falling:
        return {}
    orbit = Orbit(load, scene)
    return {motion.body.name: _Falling(orbit, e, c) for motion, e, c in orbit.bodies()}


def _exact_force_function(load: NewtonianGravity, scene: Scene[S]) -> S:
    """U = nu [ m/|r| + (tr Theta - 3 r.Theta r/|r|^2)/(2 |r|^3) ], summed over the bodies."""
    algebra = scene.algebra
    total = tides = algebra.zero
    fallen = _fallen(load, scene)
    for motion, r in radius_vectors(load, scene):
        inverse, square = _inverse_distance(algebra, r)
        value = algebra.zero if fallen else algebra.times(motion.mass, inverse)
        if fallen:
            tides = tides + algebra.times(motion.mass, fallen[motion.body.name].potential())
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            turned = r.dot(tensor @ r)
            excess = trace(tensor) - algebra.times(algebra.number(3), algebra.reduce(algebra.times(square, turned)))
            cube = algebra.reduce(algebra.times(inverse, square))
            value = value + algebra.times(algebra.number(Fraction(1, 2)), algebra.times(cube, algebra.reduce(excess)))
        total = total + value
    return algebra.reduce(algebra.times(scene.lower(load.constant), algebra.reduce(total)) + tides)


def _exact_action(load: NewtonianGravity, scene: Scene[S]) -> Action[S]:
    """F and L of the exact field, on every body."""
    algebra = scene.algebra
    constant = scene.lower(load.constant)
    fallen = _fallen(load, scene)
    wrenches = []
    for motion, r in radius_vectors(load, scene):
        inverse, square = _inverse_distance(algebra, r)
        cube = algebra.times(constant, algebra.reduce(algebra.times(inverse, square)))
        force = r * -algebra.times(motion.mass, cube)
        if fallen:
            force = fallen[motion.body.name].force() * motion.mass
        torque = scene.zero(motion.body.name)
        tensor = central_inertia(scene, motion)
        if tensor is not None:
            fifth = algebra.reduce(algebra.times(cube, square))
            turned = tensor @ r
            central = algebra.reduce(algebra.times(square, r.dot(turned)))
            central = algebra.times(algebra.number(5), central) - trace(tensor)
            spread = r * central
            two = algebra.number(2)
            spread = spread - turned * two
            force = force + spread * algebra.times(algebra.number(Fraction(3, 2)), fifth)
            thrice = algebra.times(algebra.number(3), fifth)
            torque = r.cross(turned) * thrice
        force = force.reduced()
        wrenches.append(Wrench(motion.body.name, force, motion.mass_centre.cross(force) + torque))
    return completed(load, scene, wrenches)
