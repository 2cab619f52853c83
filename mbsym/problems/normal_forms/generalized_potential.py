"""Applied forces that Lagrange's function can take in: magnetic forces, Coriolis's, gradients given as forces.

Helmholtz's conditions for Q_i = P_i(q) + F_ij(q) q'_j, free of the time:

    F_ij = -F_ji,      dF_ij/dq_k + dF_jk/dq_i + dF_ki/dq_j = 0,      dP_i/dq_j = dP_j/dq_i

Then there is V(q, q') with  Q_i = dV/dq_i - d/dt dV/dq'_i,  L + V is a Lagrangian of all, and the theorems for
Hamiltonian systems hold.  The conditions are decided of the closed formulas: a force that has a potential up to the
order of an expansion only is none.  An energy that is conserved is not enough: Q = x' (y', -x') does no work, either.
In deviations x, v from the motion, a term of degree k of Q is a derivative of one of degree k + 1 of V (Poincare):

    V(x, v) = sum_i x_i int_0^1 Q_i(s x, s v) ds

Santilli, Foundations of Theoretical Mechanics I, 1978, section 2.2.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import chain, combinations

from mbsym.algebra.failures import Failure
from mbsym.algebra.jet import Terms
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.problems.normal_forms.expansion import Expansion, NotExpanded


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


def has_forces(found: Expansion) -> bool:
    """Whether terms of applied forces are left in an expansion."""
    return any(part for one in found.forces for part in one)


def taken_in(found: Expansion) -> Expansion:
    """The expansion with V in its Lagrangian and no forces.  Raises NotExpanded if V does not give them back."""
    if not has_forces(found):
        return found
    ring, n = found.scene.ring, len(found.coordinates)
    assert isinstance(ring, Ring)
    potential: list[Terms] = [{} for _ in range(found.order + 1)]
    for i, parts in enumerate(found.forces):
        for degree, part in enumerate(parts, start=1):
            for key, value in part.items():
                _add(potential[degree], tuple(sorted((i, *key))), value * ring.number(Fraction(1, degree + 1)))
    for i, parts in enumerate(found.forces):
        for degree, part in enumerate(parts, start=1):
            again = _force(potential[degree], i, n)
            for key in {*part, *again}:
                given, made = part.get(key) or ring.zero, again.get(key) or ring.zero
                if not ring.vanishes(ring.reduce(given - made)):
                    raise NotExpanded("the potential of applied forces does not give them back")
    lagrangian = tuple(_together(part, potential[k]) for k, part in enumerate(found.lagrangian))
    none: tuple[tuple[Terms, ...], ...] = tuple(tuple({} for _ in parts) for parts in found.forces)
    return replace(found, lagrangian=lagrangian, forces=none)


def _force(potential: Terms, i: int, n: int) -> Terms:
    """dV/dx_i - d/dt dV/dv_i of V linear in v: the time derivative puts v_j for an x_j."""
    found: Terms = {}
    for key, value in potential.items():
        count = Counter(key)
        if count[i]:
            _add(found, _without(key, i), value * count[i])
        if count[n + i]:
            rest = _without(key, n + i)
            for j, times in Counter(rest).items():
                if j < n:
                    _add(found, tuple(sorted((*_without(rest, j), n + j))), value * (-times))
    return found


def _without(key: tuple[int, ...], one: int) -> tuple[int, ...]:
    place = key.index(one)
    return key[:place] + key[place + 1 :]


def _add(into: Terms, key: tuple[int, ...], value: Polynomial) -> None:
    into[key] = into[key] + value if key in into else value


def _together(a: Terms, b: Terms) -> Terms:
    found = dict(a)
    for key, value in b.items():
        _add(found, key, value)
    return {key: value for key, value in found.items() if not value.is_zero()}
