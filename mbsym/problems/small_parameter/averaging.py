"""Averaging over fast prescribed phases: the effective potential of systems that are shaken or driven fast.

With a phase phi' = nu prescribed, nu = O(1/eps), or several, whose rates and those of their combinations that occur are
O(1/eps), every parameter that sets how strongly phases act has an order eps^k of its own: lengths h that are shaken
k = 1, amplitudes v of forces of zero mean k = -1 (the force is as large as nu; v nu^2 has k = 1).  All else is O(1).
The Lagrangian is

    L = 1/2 q'.M q' + A1.q' + A0 + U_0 + U_1,      U_0 = O(1),  U_1 = O(1/eps),  <U_1> = 0

and Q_1 = O(1/eps), <Q_1> = 0, are applied forces without a force function, which hold no velocities.  By parts,
U_1 = d/dt W - (dW/dq).q' + O(1) of zero mean, W = integral U_1 dt at constant q, so that with

    g = dW/dq + integral Q_1 dt,      a = A1 - <A1> - g,      P = p - g

the motion is within O(eps), over times of order 1, of that of the same M with the potential energy

    V(q) = 1/2 <a.M^-1 a> - <A0> - <U_0>      (only terms of order eps^0 count)

in the velocities  Q' = M^-1 (P - <A1>);  the motion about it is  q = Q - M^-1 integral a dt + ...  M of order
eps^0 must not hold the phase.  Where Q_1 is no gradient the mean force  sum_j <(dg_i/dq_j - dg_j/dq_i) (M^-1 a)_j>
is left; it has to be of a potential, like the means of forces of order 1, and is taken into V.  What the shaking adds
to <A1>.q' must be a total derivative (as in one coordinate it always is).  What A1, A0 and U are without the amplitudes
(other prescribed motions) stays as it is, and must not hold the phase.  Terms of order eps^-2 displace the motion by
O(1) within one turn of the phase: then nothing is small, and it is refused.

For Kapitza's pendulum, theta from the hanging position, V = -m g l cos(theta) + m h^2 nu^2 sin(theta)^2/4: upright it
is stable where h^2 nu^2 > 2 g l.  For a Paul trap, U = -v cos(phi) x^2/2: V = v^2 x^2/(4 m nu^2).

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

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from math import comb
from typing import Any

from flint import fmpq

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import adjugate, determinant
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Formula, Shown
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import generalized_forces
from mbsym.problems.energy import Energy


@dataclass(frozen=True, repr=False)
class Averaged(Shown):
    """V = ``potential``, but for constants; ``vibrational``: what of it the phases add.

    ``rates`` of ``phases`` are of order eps^-1; ``orders``: the powers of eps of the amplitudes; all else is O(1).
    ``apart``: sums of several rates that are of order eps^-1, too, as their harmonics meet.

    ``beside``: coordinates on which forces act that have no place in V and do what they did (damping, generalised
    forces): V alone is not the whole motion then.

    ``swings`` are M^-1 a by coordinate, in q and the phases: the velocities of the oscillation about Q are -M^-1 a.
    """

    phases: tuple[str, ...]
    rates: tuple[str, ...]
    orders: tuple[tuple[str, int], ...]
    vibrational: Formula
    potential: Formula
    swings: tuple[Formula, ...]
    beside: tuple[str, ...] = ()
    apart: tuple[Formula, ...] = ()

    @property
    def small(self) -> tuple[str, ...]:
        """The amplitudes that tend to zero with eps."""
        return tuple(name for name, power in self.orders if power > 0)

    @property
    def scaling(self) -> str:
        """Of which order everything is taken: the result holds for that only."""
        every = (*((rate, -1) for rate in self.rates), *self.orders)
        return ", ".join(f"{name} of order eps^{power}" for name, power in every) + ", all else of order 1"


@dataclass(frozen=True)
class Order:
    """Powers of eps in terms of the ring: ``amplitudes`` by their places, and -1 for every rate."""

    ring: Ring
    amplitudes: Mapping[int, int]
    rates: tuple[int, ...]
    phases: tuple[tuple[int, int, int], ...]  # of each its sine, its cosine and itself

    @property
    def told(self) -> str:
        """The names of the phases."""
        return ", ".join(self.ring.generators[itself].name for *_, itself in self.phases)

    @property
    def places(self) -> set[int]:
        """Where the phases stand in the ring."""
        return {k for phase in self.phases for k in phase}

    def leading(self, p: Polynomial, what: str) -> Polynomial:
        """The terms of order eps^0.  Raises NoClosedForm where p grows as eps tends to 0, or hides what matters."""
        grown, polynomial = self.split(p, what)
        if grown != 0:
            raise NoClosedForm(
                "[[what]] grows with the rate of the phase: more has to be small than was told", what=what
            )
        return polynomial

    def split(self, p: Polynomial, what: str) -> tuple[Polynomial, Polynomial]:
        """The terms of order eps^-1 and eps^0.  Raises NoClosedForm where p has larger ones, or hides what matters."""
        self.refuse_hidden(p, what)
        by_order: tuple[dict[Any, Any], dict[Any, Any]] = {}, {}
        for monomial, c in p.to_dict().items():
            power = sum(k * monomial[at] for at, k in self.amplitudes.items())
            power -= sum(monomial[at] for at in self.rates)
            if power < -1:
                raise NoClosedForm(
                    "[[what]] grows with the rate of the phase as its square: it would move the system by much "
                    "within one turn of the phase, and the averages mean nothing",
                    what=what,
                )
            if power <= 0:
                by_order[power + 1][monomial] = c
        grown, bounded = by_order
        return self.ring.context.from_dict(grown), self.ring.context.from_dict(bounded)

    def unshaken(self, p: Polynomial) -> Polynomial:
        """The terms in which neither the rate nor an amplitude stands."""
        scaled = (*self.rates, *self.amplitudes)
        terms = {m: c for m, c in p.to_dict().items() if not any(m[k] for k in scaled)}
        return self.ring.context.from_dict(terms)

    def unscaled(self, p: Polynomial) -> Polynomial:
        """The terms in which no amplitude stands."""
        terms = {m: c for m, c in p.to_dict().items() if not any(m[k] for k in self.amplitudes)}
        return self.ring.context.from_dict(terms)

    def holds_phase(self, p: Polynomial) -> bool:
        degrees = p.degrees()
        return any(degrees[k] > 0 for k in self.places)

    def mean(self, p: Polynomial, what: str) -> Polynomial:
        """The average over the phases.  Raises NoClosedForm where one stands outside of sines and cosines."""
        turning = {k for sine, cosine, _ in self.phases for k in (sine, cosine)}
        total: dict[tuple[int, ...], Any] = {}
        for monomial, c in p.to_dict().items():
            for *_, itself in self.phases:
                if monomial[itself]:
                    raise NoClosedForm(
                        "[[what]] holds [[name]] outside of sines and cosines",
                        what=what,
                        name=self.ring.generators[itself].name,
                    )
            powers = [(monomial[sine], monomial[cosine]) for sine, cosine, _ in self.phases]
            if any(a % 2 or b % 2 for a, b in powers):
                continue
            for a, b in powers:
                c = c * fmpq(_odd(a) * _odd(b), _even(a + b))
            key = tuple(0 if k in turning else e for k, e in enumerate(monomial))
            total[key] = total.get(key, fmpq(0)) + c
        return self.ring.context.from_dict({key: c for key, c in total.items() if c})

    def waves(self, p: Polynomial) -> dict[tuple[fmpq, ...], tuple[Polynomial, Polynomial]]:
        """p = sum over k of  P_k cos(k.phi) + Q_k sin(k.phi),  the first k_j that is not zero positive."""
        ring, found = self.ring, dict[tuple[fmpq, ...], tuple[Polynomial, Polynomial]]()
        turning = {k for sine, cosine, _ in self.phases for k in (sine, cosine)}
        for monomial, coefficient in p.to_dict().items():
            rest = ring.context.from_dict(
                {tuple(0 if k in turning else e for k, e in enumerate(monomial)): coefficient}
            )
            # exp(i k.phi) by k: even parts are real, odd ones imaginary, so that cosines and sines come out by symmetry
            terms = {(fmpq(0),) * len(self.phases): (fmpq(1), fmpq(0))}
            for place, (sine, cosine, itself) in enumerate(self.phases):
                unit = self._unit(sine, itself)
                powers = _exponentials(monomial[sine], monomial[cosine])
                further: dict[tuple[fmpq, ...], tuple[fmpq, fmpq]] = {}
                for k, (x, y) in terms.items():
                    for n, (u, v) in powers.items():
                        key = (*k[:place], k[place] + n * unit, *k[place + 1 :])
                        x0, y0 = further.get(key, (fmpq(0), fmpq(0)))
                        further[key] = x0 + x * u - y * v, y0 + x * v + y * u
                terms = further
            for k, (x, y) in terms.items():
                first = next((n for n in k if n), fmpq(0))
                if first < 0 or not (x or y):
                    continue
                double = 2 if first else 1  # exp(i k.phi) and its conjugate
                old = found.get(k, (ring.zero, ring.zero))
                found[k] = old[0] + rest * (double * x), old[1] - rest * (double * y)
        return found

    def _unit(self, sine: int, itself: int) -> fmpq:
        """1/n of  sin(phi/n)."""
        own = self.ring.generators[itself].name
        ((_, factor),) = self.ring.derivative(self.ring.context.gen(sine), own).to_dict().items()
        return factor

    def speed(self, k: tuple[fmpq, ...]) -> Polynomial:
        """The rate of k.phi."""
        gens = (self.ring.context.gen(at) * n for n, at in zip(k, self.rates, strict=True))
        return sum(gens, self.ring.zero)

    def integral(self, p: Polynomial) -> Polynomial:
        """The antiderivative of zero mean in time of p, whose own mean over the phases is zero."""
        ring = self.ring
        total = ring.zero
        for k, (even, odd) in self.waves(p).items():
            if any(k):
                s, c = self._turned(k)
                whole = ring.times(even, s) - ring.times(odd, c)
                total += ring.times(whole, ring.reciprocal(self.speed(k)))
        return ring.reduce(total)

    def _turned(self, k: tuple[fmpq, ...]) -> tuple[Polynomial, Polynomial]:
        """Sine and cosine of k.phi."""
        ring = self.ring
        s, c = ring.zero, ring.one
        for n, (sine, cosine, itself) in zip(k, self.phases, strict=True):
            times = int(n / self._unit(sine, itself))
            sine_multiple, cosine_multiple = ring.multiple_angle(
                ring.context.gen(sine), ring.context.gen(cosine), abs(times)
            )
            sine_multiple = sine_multiple if times >= 0 else -sine_multiple
            s, c = (
                ring.times(s, cosine_multiple) + ring.times(c, sine_multiple),
                ring.times(c, cosine_multiple) - ring.times(s, sine_multiple),
            )
        return s, c

    def refuse_hidden(self, p: Polynomial, what: str) -> None:
        """Raises NoClosedForm where what is scaled or averaged stands in a denominator, root or function."""
        watched = {*self.amplitudes, *self.rates, *self.places}
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
                raise NoClosedForm(
                    "[[what]] holds [[names]] in a denominator, root or function", what=what, names=", ".join(hidden)
                )
            inside += within


def _odd(n: int) -> int:
    """(n - 1)!!"""
    product = 1
    for k in range(n - 1, 0, -2):
        product *= k
    return product


def _even(n: int) -> int:
    """n!!"""
    product = 1
    for k in range(n, 0, -2):
        product *= k
    return product


def _exponentials(a: int, b: int) -> dict[int, tuple[fmpq, fmpq]]:
    """s^a c^b = sum of (x + i y) exp(i n u), by n: (z - 1/z)^a (z + 1/z)^b = (2i)^a 2^b s^a c^b."""
    exponentials = {}
    for n in range(-a - b, a + b + 1, 2):
        drop = (a + b - n) // 2  # so many factors give 1/z
        count = sum((-1) ** j * comb(a, j) * comb(b, drop - j) for j in range(min(a, drop) + 1))
        if count:
            x = fmpq(count, 2 ** (a + b))
            exponentials[n] = ((x, fmpq(0)), (fmpq(0), -x), (-x, fmpq(0)), (fmpq(0), x))[a % 4]  # times i^-a
    return exponentials


def averaged(
    scene: Scene[Polynomial], energy: Energy, phases: Mapping[str, str], orders: Mapping[str, int]
) -> Averaged:
    """V, exactly; ``phases`` with their rates.

    Raises NoClosedForm where the system is none of those described above; the reason says why.
    """
    ring, names = scene.ring, scene.system.coordinates
    order = _order(ring, phases, orders)
    phase = order.told
    moving = without_constants(ring, names)
    mass = [[order.leading(x, Message("the mass matrix")) for x in row] for row in energy.A2.polynomials]
    if any(order.holds_phase(x) for row in mass for x in row):
        raise NoClosedForm("the mass matrix depends on [[phase]]", phase=phase)
    linear = [order.leading(x.polynomial, "T") for x in energy.A1]
    rest = order.leading(energy.A0.polynomial, "T")
    grown, force = order.split(energy.force_function.polynomial, "U")
    pushes, steady, beside = _other_loads(scene, order)
    whole_force, whole_rest = (moving(x.polynomial) for x in (energy.force_function, energy.A0))
    for what, parts in (("T", [*(x.polynomial for x in energy.A1), whole_rest]), ("U", [whole_force])):
        if any(order.holds_phase(order.unscaled(x)) for x in parts):
            amplitudes = ", ".join(orders)
            raise NoClosedForm(
                "[[what]] depends on [[phase]] also where [[told]] = 0",
                what=what,
                phase=phase,
                told=amplitudes,
                remedy=_REMEDY,
            )
    if not ring.vanishes(moving(order.mean(grown, "U"))):
        raise NoClosedForm("the mean of U over [[phase]] grows with the rate of the phase", phase=phase)
    means = [order.mean(x, "T") for x in linear]
    added = [mean - order.unshaken(x) for mean, x in zip(means, linear, strict=True)]
    for i, a in enumerate(names):
        for j, b in enumerate(names[:i]):
            if not ring.is_zero(ring.derivative(added[i], b) - ring.derivative(added[j], a)):
                raise NoClosedForm("gyroscopic terms are left: what the shaking adds to <A1> is no gradient")
    wave = order.integral(moving(grown))
    driven = {name: order.integral(push) for name, push in pushes.items()}
    kicks = [ring.derivative(wave, name) + driven[name] for name in names]
    swings = [ring.reduce(x - mean - g) for x, mean, g in zip(linear, means, kicks, strict=True)]
    adjoint = adjugate(mass, partial(determinant, ring))
    vibrational = ring.number(0)
    for i, x in enumerate(swings):
        for j, y in enumerate(swings):
            if not (ring.vanishes(x) or ring.vanishes(y)):
                product = order.mean(ring.reduce(ring.times(x, y)), "T")
                vibrational += ring.times(product, adjoint[i][j])
    inverse = ring.reciprocal(determinant(ring, mass))
    divided = ring.times(vibrational * fmpq(1, 2), inverse)
    turned = [ring.reduce(ring.times(ring.dot(row, swings), inverse)) for row in adjoint]
    for a in names:
        for b, turn in zip(names, turned, strict=True):
            curl = ring.reduce(ring.derivative(driven[b], a) - ring.derivative(driven[a], b))
            steady[a] -= order.mean(ring.reduce(ring.times(curl, turn)), Message("the force on [[name]]", name=a))
    whole = ring.reduce(divided - order.mean(rest, "T") - _force_function(ring, steady))
    mean_force = ring.reduce(order.mean(force, "U"))
    vibrational_alone = whole + order.unshaken(rest) - mean_force + order.unshaken(force)
    return Averaged(
        tuple(phases),
        tuple(phases.values()),
        tuple(orders.items()),
        Formula(ring, moving(ring.reduce(vibrational_alone))),
        Formula(ring, moving(ring.reduce(whole - mean_force))),
        tuple(Formula(ring, x) for x in turned),
        beside,
        tuple(Formula(ring, x) for x in _mixed(order, swings, [*swings, grown, force, rest])),
    )


def _mixed(order: Order, factors: Sequence[Polynomial], formulas: Sequence[Polynomial]) -> list[Polynomial]:
    """The rates of several phases at which formulas, and products of two ``factors``, oscillate."""
    if len(order.phases) < 2:
        return []
    own = {k for x in factors for k in order.waves(x)}
    pairs = {tuple(x + sign * y for x, y in zip(a, b, strict=True)) for a in own for b in own for sign in (1, -1)}
    mixed = {
        k for k in pairs.union(*map(order.waves, formulas)) if sum(map(bool, k)) > 1 and next(n for n in k if n) > 0
    }
    return [order.speed(k) for k in sorted(mixed, key=lambda k: (sum(map(abs, k)), [-n for n in k]))]


_REMEDY = "give the amplitude of what the phase does a parameter of its own, or name its order: mbsym average --order"


def _order(ring: Ring, phases: Mapping[str, str], orders: Mapping[str, int]) -> Order:
    """Raises NoClosedForm where no sine or cosine of a phase occurs: nothing oscillates with it."""
    for phase in phases:
        if not all(ring.has(kind, phase) for kind in ("sine", "cosine", "prescribed")):
            raise NoClosedForm("no sine or cosine of [[phase]] occurs: nothing oscillates with it", phase=phase)
    return Order(
        ring,
        {ring.index("parameter", name): power for name, power in orders.items()},
        tuple(ring.index("parameter", rate) for rate in phases.values()),
        tuple((ring.index("sine", x), ring.index("cosine", x), ring.index("prescribed", x)) for x in phases),
    )


def _force_function(ring: Ring, forces: Mapping[str, Polynomial]) -> Polynomial:
    """U with dU/dq = the mean forces that the amplitudes add, polynomials in the coordinates, along rays from q = 0.

    Raises NoClosedForm where there is none.
    """
    places = [ring.index("coordinate", name) for name in forces]
    total = ring.zero
    for name, force in forces.items():
        terms = {m: c / (sum(int(m[k]) for k in places) + 1) for m, c in force.to_dict().items()}
        total += ring.times(ring.generator("coordinate", name), ring.context.from_dict(terms))
    for name, force in forces.items():
        if any(not ring.vanishes(ring.velocity_derivative(force, other)) for other in forces):
            raise NoClosedForm(
                "the force on [[name]] holds products of what is small and the rate of the phase", name=name
            )
        if not ring.is_zero(ring.derivative(total, name) - force):
            raise NoClosedForm(
                "a mean force on [[name]] is left that is not seen to be of a potential",
                name=name,
                remedy="write it as a potential",
            )
    return ring.reduce(total)


def without_constants(ring: Ring, names: Sequence[str]) -> Callable[[Polynomial], Polynomial]:
    """p without the terms in which no coordinate stands."""

    def moving(p: Polynomial) -> Polynomial:
        terms = {m: ring.context.from_dict({m: c}) for m, c in p.to_dict().items()}
        polynomial = ring.zero
        for term in terms.values():
            if ring.dependencies(term, names):
                polynomial += term
        return polynomial

    return moving


def _other_loads(
    scene: Scene[Polynomial], order: Order
) -> tuple[dict[str, Polynomial], dict[str, Polynomial], tuple[str, ...]]:
    """Forces without a force function: those of order 1/eps, and what the amplitudes add to the mean of the others.

    The third are the coordinates on which forces are left where all amplitudes vanish.  Raises NoClosedForm for what
    averages in another way.
    """
    ring, system = scene.ring, scene.system
    phase = order.told
    pushes, steady, beside = {}, {}, []
    for name, generalized_force in generalized_forces(scene).items():
        what = Message("the force on [[name]]", name=name)
        grown, force = order.split(generalized_force, what)
        try:
            slopes = {a: [ring.velocity_derivative(x, a) for x in (grown, force)] for a in system.coordinates}
            bends = [ring.velocity_derivative(x, b) for _, x in slopes.values() for b in system.coordinates]
        except NoClosedForm as jump:
            raise NoClosedForm("[[what]] is not linear in the velocities", what=what) from jump
        if any(not ring.vanishes(x) for x, _ in slopes.values()):
            raise NoClosedForm("[[what]] holds velocities and grows with the rate of the phase", what=what)
        if any(order.holds_phase(x) for _, x in slopes.values()):
            raise NoClosedForm(
                "[[what]] depends on [[phase]] and on velocities: its mean is no potential", what=what, phase=phase
            )
        if any(not ring.vanishes(x) for x in bends):
            raise NoClosedForm("[[what]] is not linear in the velocities", what=what)
        if order.holds_phase(order.unscaled(generalized_force)):
            raise NoClosedForm("[[what]] depends on [[phase]] by itself", what=what, phase=phase, remedy=_REMEDY)
        if not ring.is_zero(order.mean(grown, what)):
            raise NoClosedForm(
                "the mean of [[what]] over [[phase]] grows with the rate of the phase", what=what, phase=phase
            )
        pushes[name], steady[name] = grown, ring.reduce(order.mean(force, what) - order.unshaken(force))
        if not ring.vanishes(order.unshaken(force)):
            beside.append(name)
    return pushes, steady, tuple(beside)


def orders_of(scene: Scene[Polynomial], energy: Energy, phases: Mapping[str, str]) -> dict[str, int]:
    """The powers of eps of the amplitudes, where they are plain.  Raises NoClosedForm where they have to be told.

    Order 1 has the only parameter without which T does not depend on the phases and there is a mass matrix still, or
    have the fewest that do so together (the axes of an ellipse).
    The loads that are left depend on the phase by parameters of their own, each term by one: where the mean of what
    holds one vanishes, its order makes that O(1/eps), as large as it can be with a mean motion; else O(1).
    """
    ring, names = scene.ring, scene.system.coordinates
    order = _order(ring, phases, {})
    phase = order.told
    kinetic = [energy.A0.polynomial, *(x.polynomial for x in energy.A1)]
    kinetic += [x for row in energy.A2.polynomials for x in row]
    moving = without_constants(ring, names)
    loads = {"U": moving(energy.force_function.polynomial)}
    loads |= {Message("the force on [[name]]", name=name): x for name, x in generalized_forces(scene).items()}
    for what, p in (*(("T", x) for x in kinetic), *loads.items()):
        order.refuse_hidden(p, what)
    parameters = {x.name: ring.index("parameter", x.name) for x in scene.system.parameters}
    parameters = {name: k for name, k in parameters.items() if k not in order.rates}
    orders: dict[str, int] = {}
    waves = [m for p in kinetic for m in p.to_dict() if any(m[k] for k in order.places)]
    if waves:
        mass = [x for row in energy.A2.polynomials for x in row]
        killing = {name: k for name, k in parameters.items() if all(m[k] for m in waves)}
        small = [name for name, k in killing.items() if not any(p.degrees()[k] > 0 for p in mass)]
        small = small or [name for name, k in killing.items() if _has_mass_without(ring, energy, k)]
        if not small:
            beside = [name for name, k in parameters.items() if not any(p.degrees()[k] > 0 for p in mass)]
            every = [few for few in _choices(beside) if all(any(m[parameters[n]] for n in few) for m in waves)]
            least = [few for few in every if len(few) == min(map(len, every))]
            small = list(least[0]) if len(least) == 1 else []
        elif len(small) > 1:
            small = []
        if not small:
            raise NoClosedForm("which parameters are small is not plain: name what [[phase]] shakes", phase=phase)
        orders |= dict.fromkeys(small, 1)
    shaken = [parameters[name] for name in orders]
    means = {what: order.mean(p, what) for what, p in loads.items()}
    left = [
        (m, what) for what, p in loads.items() for m in (p - means[what]).to_dict() if not any(m[k] for k in shaken)
    ]
    if not (waves or left):
        raise NoClosedForm("[[phase]] occurs in no equation of motion: nothing oscillates with it", phase=phase)
    if not left:
        return orders
    hidden = _hidden(ring, (*kinetic, *loads.values()))
    free = {n: k for n, k in parameters.items() if k not in hidden and not any(p.degrees()[k] > 0 for p in kinetic)}
    slow = [m for p in means.values() for m in p.to_dict()]
    pure = {n for n, k in free.items() if not any(m[k] for m in slow)}
    own = [n for n, k in free.items() if any(m[k] for m, _ in left)]
    for few in sorted(_choices(own), key=lambda some: (not pure.issuperset(some), len(some))):
        if not all(sum(m[free[n]] > 0 for n in few) == 1 for m, _ in left):
            continue
        powers = [_power(free[n], order.rates, [m for m, _ in left], n in pure, slow) for n in few]
        if None not in powers:
            return orders | {n: power for n, power in zip(few, powers, strict=True) if power is not None}
    raise NoClosedForm("of which order what [[phase]] does in the loads is, is not plain", phase=phase, remedy=_REMEDY)


def _has_mass_without(ring: Ring, energy: Energy, at: int) -> bool:
    """Whether the mass matrix is regular where the parameter in the place ``at`` is zero."""
    rows = energy.A2.polynomials
    if at in _hidden(ring, [x for row in rows for x in row]):
        return False
    without = [
        [ring.context.from_dict({m: c for m, c in x.to_dict().items() if not m[at]}) for x in row] for row in rows
    ]
    return not ring.vanishes(determinant(ring, without))


def _choices(names: Sequence[str]) -> Iterator[tuple[str, ...]]:
    """Up to three of up to eight names."""
    for size in (1, 2, 3):
        yield from combinations(names[:8], size)


def _power(
    at: int, rates: Sequence[int], waves: Sequence[tuple[int, ...]], pure: bool, slow: Sequence[tuple[int, ...]]
) -> int | None:
    """Of eps, for the amplitude in the place ``at``; None where no power fits."""
    mine = [m for m in waves if m[at]] if pure else [m for m in slow if m[at]]
    exponents = {int(m[at]) for m in mine}
    grown = max(sum(int(m[k]) for k in rates) for m in mine)
    if pure:
        return grown - 1 if exponents == {1} else None
    return 0 if not grown else grown if exponents == {1} else None


def _hidden(ring: Ring, formulas: Sequence[Polynomial]) -> set[int]:
    """What stands in denominators, roots and functions."""
    hidden: set[int] = set()
    ahead = [ring.generators[k].argument for k in occurring(formulas)]
    while ahead:
        argument = ahead.pop()
        if argument is not None:
            new = set(occurring([argument])) - hidden
            hidden |= new
            ahead += [ring.generators[k].argument for k in new]
    return hidden
