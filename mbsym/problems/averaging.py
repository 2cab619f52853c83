"""Averaging over a fast prescribed phase: the effective potential of shaken systems.

With a phase phi' = nu prescribed, nu large, and lengths h that it shakes small, h = O(1/nu), write h -> eps h,
nu -> nu/eps.  The Hamiltonian of  L = 1/2 q'.M q' + A1.q' + A0 + U  is

    H(q, p, phi) = 1/2 (p - A1).M^-1 (p - A1) - A0 - U = H_0(q, p, phi) + O(eps)

and by the averaging theorem the motion is within O(eps), over times of order 1, of that of <H_0>.  Where M of H_0 does
not hold the phase this is a system of the same M with the potential energy

    V(q) = 1/2 <a.M^-1 a> - <A0> - <U>,      a = A1 - <A1>   (only terms of order eps^0 count)

in the velocities  Q' = M^-1 (p - <A1>);  the motion about it is  q = Q - (1/nu) M^-1 integral a dphi + ...  What the
shaking adds to <A1>.q' must be a total derivative (as in one coordinate it always is).  What A1, A0 and U are without
h and nu (other prescribed motions) stays as it is, and must not hold the phase.  For Kapitza's pendulum, theta from the
hanging position, V = -m g l cos(theta) + m h^2 nu^2 sin(theta)^2/4: upright it is stable where h^2 nu^2 > 2 g l.

Other loads may depend on velocities linearly, without the phase.

Everything is exact; whether eps is small enough at given numbers no expansion tells: that is measured, by the motion
itself (``mbsym average``) or by Floquet multipliers (``mbsym floquet``).

Source: P. L. Kapitza (1951); Landau & Lifshitz, Mechanics, section 30; N. N. Bogolyubov, Yu. A. Mitropolsky, Asymptotic
Methods in the Theory of Non-linear Oscillations.

Example:

    >>> import mbsym
    >>> from mbsym.analysis.averaged import averaging_of
    >>> print(averaging_of(mbsym.load("systems/shaken-pendulum.yaml"), "phi").vibrational)
    -m*h**2*nu**2*cos(theta)**2/4
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.generators import occurring
from mbsym.algebra.matrices import determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.formulas.formula import Formula
from mbsym.formulas.notebook import Shown
from mbsym.mechanics.generalized import generalized_forces
from mbsym.mechanics.kinematics import Scene
from mbsym.problems.energy import Energy


@dataclass(frozen=True, repr=False)
class Averaged(Shown):
    """V = ``potential``, but for constants; ``vibrational``: what of it the shaking adds.

    ``phase`` and ``rate`` are fast, ``small`` small.

    ``swings`` are M^-1 a by coordinate, in q and the phase: the velocities of the oscillation about Q are -M^-1 a.
    """

    phase: str
    rate: str
    small: tuple[str, ...]
    vibrational: Formula
    potential: Formula
    swings: tuple[Formula, ...]


@dataclass(frozen=True)
class Order:
    """Powers of eps in terms of the ring: + for small parameters, - for the rate."""

    ring: Ring
    small: tuple[int, ...]
    rate: int
    phase: tuple[int, ...]  # its sine, its cosine and itself

    def leading(self, p: Polynomial, what: str) -> Polynomial:
        """The terms of order eps^0.  Raises NoClosedForm where p grows as eps tends to 0, or hides what matters."""
        self._is_plain(p, what)
        kept = {}
        for monomial, c in p.to_dict().items():
            power = sum(monomial[k] for k in self.small) - monomial[self.rate]
            if power < 0:
                raise NoClosedForm(f"{what} grows with the rate of the phase: more has to be small than was told")
            if power == 0:
                kept[monomial] = c
        return self.ring.context.from_dict(kept)

    def unshaken(self, p: Polynomial) -> Polynomial:
        """The terms in which neither the rate nor anything small stands."""
        kept = {m: c for m, c in p.to_dict().items() if not (m[self.rate] or any(m[k] for k in self.small))}
        return self.ring.context.from_dict(kept)

    def holds_phase(self, p: Polynomial) -> bool:
        degrees = p.degrees()
        return any(degrees[k] > 0 for k in self.phase)

    def mean(self, p: Polynomial, what: str) -> Polynomial:
        """The average over the phase.  Raises NoClosedForm where it stands outside of sines and cosines."""
        sine, cosine, itself = self.phase
        total: dict[tuple[int, ...], Any] = {}
        for monomial, c in p.to_dict().items():
            if monomial[itself]:
                raise NoClosedForm(f"{what} holds {self.ring.generators[itself].name} outside of sines and cosines")
            a, b = monomial[sine], monomial[cosine]
            if a % 2 or b % 2:
                continue
            key = tuple(0 if k in (sine, cosine) else e for k, e in enumerate(monomial))
            total[key] = total.get(key, fmpq(0)) + c * fmpq(_odd(a) * _odd(b), _even(a + b))
        return self.ring.context.from_dict({key: c for key, c in total.items() if c})

    def _is_plain(self, p: Polynomial, what: str) -> None:
        """Raises NoClosedForm where what is small, large or averaged stands in a denominator, root or function."""
        watched = {*self.small, self.rate, *self.phase}
        inside = [k for k in occurring([p]) if k not in watched]
        seen: set[int] = set()
        while inside:
            k = inside.pop()
            argument = self.ring.generators[k].argument
            if argument is None or k in seen:
                continue
            seen.add(k)
            within = occurring([argument])
            hidden = dict.fromkeys(self.ring.generators[j].name for j in within if j in watched)
            if hidden:
                raise NoClosedForm(f"{what} holds {', '.join(hidden)} in a denominator, root or function")
            inside += within


def _odd(n: int) -> int:
    """(n - 1)!!"""
    found = 1
    for k in range(n - 1, 0, -2):
        found *= k
    return found


def _even(n: int) -> int:
    """n!!"""
    found = 1
    for k in range(n, 0, -2):
        found *= k
    return found


def averaged(scene: Scene[Polynomial], energy: Energy, phase: str, rate: str, small: Sequence[str]) -> Averaged:
    """V, exactly.  Raises NoClosedForm where the system is none of those described above; the reason says why."""
    ring, names = scene.ring, scene.system.coordinates
    _refuse_without_waves(ring, phase)
    order = Order(
        ring,
        tuple(ring.index("parameter", name) for name in small),
        ring.index("parameter", rate),
        (ring.index("sine", phase), ring.index("cosine", phase), ring.index("prescribed", phase)),
    )
    mass = [[order.leading(x, "the mass matrix") for x in row] for row in energy.A2.polynomials]
    if any(order.holds_phase(x) for row in mass for x in row):
        raise NoClosedForm(f"the mass matrix depends on {phase}")
    linear = [order.leading(x.polynomial, "T") for x in energy.A1]
    rest = order.leading(energy.A0.polynomial, "T")
    force = order.leading(energy.force_function.polynomial, "U")
    _other_loads(scene, order)
    for what, parts in (("T", [*linear, rest]), ("U", [force])):
        if any(order.holds_phase(order.unshaken(x)) for x in parts):
            raise NoClosedForm(f"{what} depends on {phase} also where {', '.join(small)} = 0")
    means = [order.mean(x, "T") for x in linear]
    added = [mean - order.unshaken(x) for mean, x in zip(means, linear, strict=True)]
    for i, a in enumerate(names):
        for j, b in enumerate(names[:i]):
            if not ring.is_zero(ring.derivative(added[i], b) - ring.derivative(added[j], a)):
                raise NoClosedForm("gyroscopic terms are left: what the shaking adds to <A1> is no gradient")
    swings = [ring.reduce(x - mean) for x, mean in zip(linear, means, strict=True)]
    vibrational = ring.number(0)
    for i, x in enumerate(swings):
        for j, y in enumerate(swings):
            if not (ring.vanishes(x) or ring.vanishes(y)):
                product = order.mean(ring.reduce(ring.times(x, y)), "T")
                vibrational += ring.times(product, _cofactor(ring, mass, i, j))
    inverse = ring.reciprocal(determinant(ring, mass))
    divided = ring.times(vibrational * fmpq(1, 2), inverse)
    turned = [
        sum((ring.times(_cofactor(ring, mass, i, j), y) for j, y in enumerate(swings)), ring.zero)
        for i in range(len(names))
    ]
    whole = ring.reduce(divided - order.mean(rest, "T"))
    mean_force = ring.reduce(order.mean(force, "U"))
    vibrational_alone = whole + order.unshaken(rest) - mean_force + order.unshaken(force)
    moving = without_constants(ring, names)
    return Averaged(
        phase,
        rate,
        tuple(small),
        Formula(ring, moving(ring.reduce(vibrational_alone))),
        Formula(ring, moving(ring.reduce(whole - mean_force))),
        tuple(Formula(ring, ring.reduce(ring.times(x, inverse))) for x in turned),
    )


def _refuse_without_waves(ring: Ring, phase: str) -> None:
    """Raises NoClosedForm where no sine or cosine of the phase occurs: nothing is shaken by it."""
    if not all(ring.has(kind, phase) for kind in ("sine", "cosine", "prescribed")):
        raise NoClosedForm(f"no sine or cosine of {phase} occurs: nothing oscillates with it")


def _cofactor(ring: Ring, matrix: Sequence[Sequence[Polynomial]], i: int, j: int) -> Polynomial:
    rows = [[x for col, x in enumerate(row) if col != i] for at, row in enumerate(matrix) if at != j]
    value = determinant(ring, rows) if rows else ring.one
    return -value if (i + j) % 2 else value


def without_constants(ring: Ring, names: Sequence[str]) -> Callable[[Polynomial], Polynomial]:
    """p without the terms in which no coordinate stands."""

    def moving(p: Polynomial) -> Polynomial:
        terms = {m: ring.context.from_dict({m: c}) for m, c in p.to_dict().items()}
        kept = ring.zero
        for term in terms.values():
            if ring.dependencies(term, names):
                kept += term
        return kept

    return moving


def _other_loads(scene: Scene[Polynomial], order: Order) -> None:
    """Raises NoClosedForm for loads that average in another way."""
    ring, system = scene.ring, scene.system
    for name, found in generalized_forces(scene).items():
        force = order.leading(found, f"the force on {name}")
        if order.holds_phase(force):
            raise NoClosedForm(f"the force on {name} depends on {order.ring.generators[order.phase[2]].name}")
        if not ring.is_zero(force - order.unshaken(force)):
            raise NoClosedForm(f"the force on {name} holds products of what is small and the rate of the phase")
        for a in system.coordinates:
            slope = ring.velocity_derivative(force, a)
            if any(not ring.vanishes(ring.velocity_derivative(slope, b)) for b in system.coordinates):
                raise NoClosedForm(f"the force on {name} is not linear in the velocities")


def small_parameters(scene: Scene[Polynomial], energy: Energy, phase: str, rate: str) -> tuple[str, ...]:
    """Parameters without which nothing depends on the phase and the mass matrix stays what it is: one, or none.

    Raises NoClosedForm where no sine or cosine of the phase occurs.
    """
    ring = scene.ring
    _refuse_without_waves(ring, phase)
    sine, cosine, itself = (ring.index(kind, phase) for kind in ("sine", "cosine", "prescribed"))
    formulas = [energy.A0.polynomial, energy.force_function.polynomial, *(x.polynomial for x in energy.A1)]
    formulas += [x for row in energy.A2.polynomials for x in row]
    found = []
    for parameter in scene.system.parameters:
        if parameter.name == rate or not ring.has("parameter", parameter.name):
            continue
        k = ring.index("parameter", parameter.name)
        kills = all(
            monomial[k] > 0
            for p in formulas
            for monomial in p.to_dict()
            if monomial[sine] or monomial[cosine] or monomial[itself]
        )
        stays = not any(p.degrees()[k] > 0 for row in energy.A2.polynomials for p in row)
        if kills and stays:
            found.append(parameter.name)
    return tuple(found) if len(found) == 1 else ()
