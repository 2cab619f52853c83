"""Problem 3 where velocities are variables of their own: speeds u with q' = Y(q) u + y0(q, t).

    M u' = f                                            Kane's equations (equally Boltzmann-Hamel)
    s' = g(s, u, t)                                     kinematic equations

where s are the coordinates, and components of unit vectors that take the place of angles (e' = e x omega, Poisson).
Each equation is also kept as it stands in textbooks: what the motion needs = what the loads supply, for a body about a
fixed point

    A p' + (C - B) q r = m g (z_0 gamma_2 - y_0 gamma_3).

Source: Kane & Levinson, Dynamics: Theory and Applications (1985); Lurie, Analytical Mechanics, ch. 8 (Euler-Poisson).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mbsym.algebra.ring import Polynomial
from mbsym.formulas.formula import Column, Formula, Matrix, column
from mbsym.mechanics.kane import Kane
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.speeds import SpeedForm
from mbsym.model.speeds import Quaternion
from mbsym.problems.equations import Equations


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
