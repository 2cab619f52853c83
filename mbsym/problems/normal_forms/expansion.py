"""The Lagrangian and the applied forces as Taylor polynomials about the unperturbed motion; what follows over numbers.

    L(q0 + x, q0' + v) = L_0 + p_0.v + L_2(x, v) + L_3 + ...,      Q = Q_1(x, v) + Q_2 + ...

while they are built (jets).  Over any scalars then (enclosures, exact towers) Legendre's transformation

    p = dL/dv - p_0,      H(x, p) = p.v - (L - L_0 - p_0.v)

and the field x' = v, v' = M(x, v)^-1 (dL/dx + Q - (d^2 L/dv dx) v), both by series to the same order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import chain, combinations
from typing import Any

from flint import acb

from mbsym.algebra.failures import Failure, SingularPoint
from mbsym.algebra.jet import Jet, Terms
from mbsym.algebra.matrices import inverted
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.truncated import Space, Truncated
from mbsym.mechanics.energy import kinetic_energy
from mbsym.mechanics.expansion import OnManifold, given_motion, over_jets
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.loads.kinds import force_function
from mbsym.mechanics.motion import relations, unsteady
from mbsym.mechanics.newton_euler import applied_forces
from mbsym.problems.equilibrium import Equilibrium


class NotExpanded(Failure):
    """There is no autonomous expansion about the motion."""

    code = "not-expanded"


class SingularMass(SingularPoint):
    """The mass matrix is singular on the motion, or is not told from a singular one: there are no momenta."""

    code = "singular-mass"

    def __init__(self) -> None:
        super().__init__("the mass matrix is singular on the motion", remedy="choose other coordinates")


@dataclass(frozen=True)
class Expansion:
    """``lagrangian`` holds the terms of degree 1, 2, ... in x_i (i) and v_i (n + i); ``forces`` those of each Q_i.

    ``cyclic`` are the places of the coordinates that are left out.
    """

    scene: Scene
    coordinates: tuple[str, ...]
    order: int
    lagrangian: tuple[Terms, ...]
    forces: tuple[tuple[Terms, ...], ...]
    cyclic: tuple[int, ...]


def expansion(
    scene: Scene,
    whole: Any,
    equilibrium: Equilibrium | None,
    order: int,
    ignored: Collection[str],
    manifold: Callable[[int], OnManifold] | None = None,
) -> Expansion:
    """The system ``whole`` about its motion; ``scene`` is over the ring.  The coordinates ``ignored`` are cyclic.

    With ``manifold``, which gives what constraints leave to an order, it is one in the independent coordinates y, where
    the forces are sum_i Q_i dq_i/dy_k.  Raises NotExpanded where a coefficient varies with time, NoClosedForm where
    coefficients outgrow the budget.
    """
    tied = None if manifold is None else manifold(order + 1)  # dq/dy loses an order
    expanded: Scene[Jet] = over_jets(scene, given_motion(scene), whole, order) if tied is None else tied.scene
    images = relations(scene) if equilibrium is None else equilibrium.determined(scene)
    names = scene.system.coordinates if tied is None else tied.coordinates
    ring, n = scene.ring, len(names)

    def kept(terms: Terms) -> Terms:
        constants: Terms = {}
        for key, value in terms.items():
            constant = ring.substitute(value, images)
            if constant.is_zero() or max(key) >= 2 * n:
                continue
            varying = unsteady(scene, constant)
            if varying:
                raise NotExpanded(
                    "terms of order [[count]] vary with [[names]]", count=len(key), names=", ".join(varying)
                )
            constants[key] = constant
        return constants

    def parts(x: Jet) -> tuple[Terms, ...]:
        return tuple(kept(x.degree(k)) for k in range(1, order + 1))

    lagrangian = parts(kinetic_energy(expanded) + force_function(expanded))
    applied = applied_forces(expanded)
    if tied is not None:
        times, nothing = expanded.algebra.times, expanded.algebra.zero
        jets = [applied[name] for name in scene.system.coordinates]
        pulled = [sum((times(x, tied.slope(i, k)) for i, x in enumerate(jets)), nothing) for k in range(n)]
        applied = dict(zip(names, pulled, strict=True))
    forces = tuple(parts(applied[name]) for name in names)
    cyclic = tuple(i for i, name in enumerate(names) if name in ignored)
    return Expansion(scene, names, order, lagrangian, forces, cyclic)


def potential(expanded: Expansion) -> Terms | None:
    """The terms of V in L = T - V, by places of coordinates; None where applied forces of several are static, too.

    The energy that is conserved, or dissipated, is T_2 + V then, whatever L has besides; of one coordinate with what
    is static in its force, V - int Q(x, 0) dx.
    """
    n = len(expanded.coordinates)
    energy = {key: -value for part in expanded.lagrangian for key, value in part.items() if max(key) < n}
    for key, value in ((key, x) for parts in expanded.forces for part in parts for key, x in part.items()):
        if max(key) < n:
            if n > 1:
                return None
            above = (*key, 0)
            energy[above] = (energy[above] if above in energy else value * 0) - value / len(above)
    return energy


class Numbers:
    """An expansion over scalars: ``carry`` gives each coefficient its value, ``inverse`` that of a scalar."""

    def __init__(
        self, found: Expansion, carry: Callable[[Polynomial], Any], inverse: Callable[[Any], Any], zero: Any, one: Any
    ) -> None:
        self.expansion, self.carry, self.inverse = found, carry, inverse
        self.zero, self.one, self.n = zero, one, len(found.coordinates)
        self.space = Space(2 * self.n, found.order, zero, one)

    def _lowered(self, parts: Sequence[Terms], least: int) -> Truncated:
        terms = {key: self.carry(value) for part in parts for key, value in part.items() if len(key) >= least}
        return self.space.of(terms)

    def hamiltonian(self) -> Truncated:
        """H(x, p) without the cyclic coordinates, whose momenta keep their unperturbed values; from degree 2 on.

        Variables are the other x in order, then their p.  Raises SingularMass where det M = 0.
        """
        n, space = self.n, self.space
        lagrangian = self._lowered(self.expansion.lagrangian, 2)
        slopes = [lagrangian.derivative(n + i) for i in range(n)]
        mass = [[slopes[i][_unit(2 * n, n + j)] for j in range(n)] for i in range(n)]
        back = self._inverted(mass)
        rest = [slope - space.of({(n + j,): mass[i][j] for j in range(n)}) for i, slope in enumerate(slopes)]
        x = [space.variable(i) for i in range(n)]
        p = [space.nothing if i in self.expansion.cyclic else space.variable(n + i) for i in range(n)]
        v = [space.nothing] * n
        for _ in range(self.expansion.order):
            right = [p[i] - rest[i].composed([*x, *v]) for i in range(n)]
            v = [_sum(space, (right[j].scaled(back[i][j]) for j in range(n))) for i in range(n)]
        whole = _sum(space, (p[i] * v[i] for i in range(n))) - lagrangian.composed([*x, *v])
        return self._without_cyclic(whole)

    def _inverted(self, mass: Sequence[Sequence[Any]]) -> list[list[Any]]:
        try:
            inverse = inverted(mass, self.inverse, self.zero, self.one)
        except ZeroDivisionError:
            raise SingularMass from None
        if any(isinstance(x, acb) and not x.is_finite() for row in inverse for x in row):
            raise SingularMass
        return inverse

    def _without_cyclic(self, whole: Truncated) -> Truncated:
        left = [i for i in range(self.n) if i not in self.expansion.cyclic]
        places = [*left, *(self.n + i for i in left)]
        space = Space(len(places), self.expansion.order, self.zero, self.one)
        terms = {tuple(key[k] for k in places): value for key, value in whole.coefficients.items()}
        return Truncated(space, terms)

    def field(self) -> list[Truncated]:
        """v' as series in x and v (all coordinates), to one order less than that of the Lagrangian.

        Raises SingularMass where det M = 0.
        """
        n, space = self.n, Space(2 * self.n, self.expansion.order - 1, self.zero, self.one)
        lagrangian = self._lowered(self.expansion.lagrangian, 2)
        cut = lambda series: Truncated(space, series.coefficients)  # noqa: E731
        slopes = [lagrangian.derivative(n + i) for i in range(n)]
        mass = [[cut(slopes[i].derivative(n + j)) for j in range(n)] for i in range(n)]
        right = []
        for i in range(n):
            total = cut(lagrangian.derivative(i)) + cut(self._lowered(self.expansion.forces[i], 1))
            for j in range(n):
                total = total - cut(slopes[i].derivative(j)) * space.variable(n + j)
            right.append(total)
        back = self._inverted([[m[(0,) * (2 * n)] for m in row] for row in mass])
        moving = [[m - space.constant(m[(0,) * (2 * n)]) for m in row] for row in mass]
        a = [space.nothing] * n
        for _ in range(self.expansion.order):
            left = [right[i] - _sum(space, (moving[i][j] * a[j] for j in range(n))) for i in range(n)]
            a = [_sum(space, (left[j].scaled(back[i][j]) for j in range(n))) for i in range(n)]
        return a


def _unit(size: int, index: int) -> tuple[int, ...]:
    return tuple(int(k == index) for k in range(size))


def _sum(space: Space, items: Any) -> Truncated:
    total = space.nothing
    for item in items:
        total = total + item
    return total


# Applied forces that Lagrange's function can take in: magnetic forces, Coriolis's, gradients given as forces.
#
# Helmholtz's conditions for Q_i = P_i(q) + F_ij(q) q'_j, free of the time:
#
#     F_ij = -F_ji,      dF_ij/dq_k + dF_jk/dq_i + dF_ki/dq_j = 0,      dP_i/dq_j = dP_j/dq_i
#
# Then there is V(q, q') with  Q_i = dV/dq_i - d/dt dV/dq'_i,  L + V is a Lagrangian of all, and the theorems for
# Hamiltonian systems hold.  The conditions are decided of the closed formulas: a force that has a potential up to the
# order of an expansion only is none.  An energy that is conserved is not enough: Q = x' (y', -x') does no work, either.
# In deviations x, v from the motion, a term of degree k of Q is a derivative of one of degree k + 1 of V (Poincare):
#
#     V(x, v) = sum_i x_i int_0^1 Q_i(s x, s v) ds
#
# Santilli, Foundations of Theoretical Mechanics I, 1978, section 2.2.


def have_generalized_potential(
    ring: Ring, coordinates: Sequence[str], forces: Mapping[str, Polynomial], running: Sequence[str]
) -> bool:
    """Whether Helmholtz's conditions are proved of Q_i(q, q'); ``running`` are the time and what it prescribes."""

    def zero(x: Polynomial) -> bool:
        return ring.is_zero(x) is True

    if all(ring.vanishes(x) for x in forces.values()):
        return True
    try:
        if any(ring.depends_on(x, name) for x in forces.values() for name in running):
            return False
        by = {(a, b): ring.velocity_derivative(forces[a], b) for a in coordinates for b in coordinates}
        if not all(zero(ring.velocity_derivative(x, name)) for x in by.values() for name in coordinates):
            return False
        at_rest = {
            a: sum((ring.times(by[a, b], -ring.generator("velocity", b)) for b in coordinates), forces[a])
            for a in coordinates
        }
        skew: Iterator[Polynomial] = (by[a, b] + by[b, a] for a in coordinates for b in coordinates)
        closed: Iterator[Polynomial] = (
            ring.derivative(by[a, b], c) + ring.derivative(by[b, c], a) + ring.derivative(by[c, a], b)
            for a, b, c in combinations(coordinates, 3)
        )
        gradient: Iterator[Polynomial] = (
            ring.derivative(at_rest[a], b) - ring.derivative(at_rest[b], a) for a, b in combinations(coordinates, 2)
        )
        return all(zero(x) for x in chain(skew, closed, gradient))
    except Failure:
        return False


def has_forces(expanded: Expansion) -> bool:
    """Whether terms of applied forces are left in an expansion."""
    return any(part for force in expanded.forces for part in force)


def taken_in(expanded: Expansion) -> Expansion:
    """The expansion with V in its Lagrangian and no forces.  Raises NotExpanded if V does not give them back."""
    if not has_forces(expanded):
        return expanded
    ring, n = expanded.scene.ring, len(expanded.coordinates)
    assert isinstance(ring, Ring)
    potential: list[Terms] = [{} for _ in range(expanded.order + 1)]
    for i, parts in enumerate(expanded.forces):
        for degree, part in enumerate(parts, start=1):
            for key, value in part.items():
                _add(potential[degree], tuple(sorted((i, *key))), value * ring.number(Fraction(1, degree + 1)))
    for i, parts in enumerate(expanded.forces):
        for degree, part in enumerate(parts, start=1):
            again = _force(potential[degree], i, n)
            for key in {*part, *again}:
                original, made = part.get(key) or ring.zero, again.get(key) or ring.zero
                if not ring.vanishes(ring.reduce(original - made)):
                    raise NotExpanded("the potential of applied forces does not give them back")
    lagrangian = tuple(_together(part, potential[k]) for k, part in enumerate(expanded.lagrangian))
    none: tuple[tuple[Terms, ...], ...] = tuple(tuple({} for _ in parts) for parts in expanded.forces)
    return replace(expanded, lagrangian=lagrangian, forces=none)


def _force(potential: Terms, i: int, n: int) -> Terms:
    """dV/dx_i - d/dt dV/dv_i of V linear in v: the time derivative puts v_j for an x_j."""
    terms: Terms = {}
    for key, value in potential.items():
        count = Counter(key)
        if count[i]:
            _add(terms, _without(key, i), value * count[i])
        if count[n + i]:
            rest = _without(key, n + i)
            for j, times in Counter(rest).items():
                if j < n:
                    _add(terms, tuple(sorted((*_without(rest, j), n + j))), value * (-times))
    return terms


def _without(key: tuple[int, ...], dropped: int) -> tuple[int, ...]:
    place = key.index(dropped)
    return key[:place] + key[place + 1 :]


def _add(into: Terms, key: tuple[int, ...], value: Polynomial) -> None:
    into[key] = into[key] + value if key in into else value


def _together(a: Terms, b: Terms) -> Terms:
    merged = dict(a)
    for key, value in b.items():
        _add(merged, key, value)
    return {key: value for key, value in merged.items() if not value.is_zero()}
