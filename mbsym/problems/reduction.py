"""Problems 4 and 5: the motion, and what constraints leave of the coordinates in the first approximation.

The motion exists where the constraints hold on it and the forces that they do not carry vanish,

    f(q, t) = 0,    J q' + j = 0,    J q'' + (J' q' + j') = 0,    Y^T (M q'' - f) = 0    (J Y = 0),

and its first approximation is that of the independent quantities (``mbsym.mechanics.expansion``): dependent
ones are expanded, not solved for.  Coordinates that no equation of the speeds feels drop out.  A coordinate that is
felt although its velocity is dependent (the place of a sphere in a dish, where it is told by its angles) follows the
others by an equation of first order of its own,

    A eta' + B eta + C x = 0,      x_f' = S eta + T x,

so that M has a row of zeros for it.  Where Frobenius' theorem proves that the velocity constraints are integrable, the
system is holonomic on every leaf that they leave, and its first approximation is that on the leaf of the motion: there
the theorems of Lagrange, Kelvin and Chetaev hold.

Sources: J. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems (1972), chapters III and V; A. V. Karapetyan,
"On the problem of steady motions of nonholonomic systems", J. Appl. Math. Mech. 44 (1980).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import SingularPoint
from mbsym.algebra.matrices import ScalarMatrix
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.signs import Signs
from mbsym.expressions.tree import names as names_of
from mbsym.formulas.formula import Formula
from mbsym.mechanics.expansion import Expansion, Projected, Row, echelon, felt
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.variables import expressions
from mbsym.problems.equilibrium import Equilibrium
from mbsym.problems.linearisation import Linearisation, Reduction, assemble


@dataclass(frozen=True)
class Reduced:
    """The expansion about the motion, the equations projected there, and what is left of the coordinates."""

    expansion: Expansion
    equations: Projected
    about: Reduction

    @property
    def residuals(self) -> list[Polynomial]:
        """What has to vanish if the motion is to exist: constraints first, then the projected equations, as -f."""
        return [*self.expansion.conditions, *(-x for x in self.equations.constant)]


def reduction(scene: Scene, expanded: Expansion, equations: Projected, leaf: int = 0) -> Reduction:
    """The independent quantities by name.  Raises SingularPoint where the constraints lose their rank on the motion.

    ``leaf`` relations are kept by integrable velocity constraints: then ``expanded`` and ``equations`` are those on it.
    """
    if expanded.lost and (demanded := [x for x in expanded.conditions if not x.is_zero()]):
        equalities = ", ".join(f"{Formula(scene.ring, x)} = 0" for x in demanded)
        raise SingularPoint(
            "the motion keeps the constraints only where [[told]], and elsewhere they have another rank: write "
            "numbers in the place of these parameters",
            told=equalities,
        )
    if expanded.lost:
        raise SingularPoint(
            "the constraints have a smaller rank on this motion than at positions near it, allowed ones or not"
        )
    names, ring = scene.system.coordinates, scene.ring
    with_motion = {entry.coordinate for entry in scene.system.motion}
    independent, speeds = set(expanded.coordinates), set(expanded.speeds)
    needed = {expanded.coordinates[j] for j in felt(expanded, equations)}
    following = sorted(needed - speeds)
    parameters = _of_the_motion_alone(scene)
    return Reduction(
        coordinates=tuple(names[i] for i in expanded.coordinates),
        speeds=tuple(names[i] for i in expanded.speeds),
        dependent_coordinates=tuple(name for i, name in enumerate(names) if i not in independent),
        dependent_speeds=tuple(name for i, name in enumerate(names) if i not in speeds),
        idle=tuple(names[i] for i in expanded.coordinates if i not in needed),
        rates=tuple(
            (name, Formula(ring, rate))
            for name, rate in zip(names, expanded.base.rates, strict=True)
            if name not in with_motion and not rate.is_zero()
        ),
        assumed=tuple(Formula(ring, x) for k, x in enumerate(expanded.assumed) if x not in expanded.assumed[:k]),
        holonomic=len(expanded.coordinates) == len(expanded.speeds),
        family=tuple(
            (
                tuple(_by(ring, expanded.base.values[i], index) for index in parameters),
                tuple(_by(ring, expanded.base.rates[i], index) for index in parameters),
            )
            for i in (*expanded.speeds, *following)
        ),
        following=tuple(names[i] for i in following),
        leaf=leaf,
    )


def dimension(about: Reduction, places: Sequence[int], signs: Signs) -> int:
    """In how many dimensions the motions of the family differ in these coordinates and their speeds, at least.

    ``places`` are among those of ``about``.  Coordinates that drop out are not counted.
    """
    rows: list[Row] = []
    for k in places:
        (values, rates), name = about.family[k], about.about[k]
        lines = (rates,) if name in about.idle else (values,) if name in about.following else (values, rates)
        for line in lines:
            rows.append({p: x.polynomial for p, x in enumerate(line)})
    if not rows or not rows[0]:
        return 0
    ring = about.family[0][0][0].ring
    reduced = echelon(ring, signs, rows, range(len(rows[0])))
    return len(reduced.pivots) - len(reduced.assumed)


def _by(ring: Ring, x: Polynomial, index: int) -> Formula:
    return Formula(ring, x.derivative(index))


def _of_the_motion_alone(scene: Scene) -> list[int]:
    """The generators of parameters that occur in the motion and nowhere else, and there in no root or reciprocal."""
    ring, system = scene.ring, scene.system
    bare = replace(system, motion=(), notation=(), assumptions=(), initial=(), time_scale=None, parameters=())
    elsewhere = {name for expression in expressions(bare) for name in names_of(expression)}
    in_motion = {name for entry in system.motion for x in (entry.value, entry.rate) for name in names_of(x)}
    inner = {index for g in ring.generators if g.argument is not None for index in occurring([g.argument])}
    indices = [ring.index("parameter", name) for name in system.parameter_names if name in in_motion - elsewhere]
    return [index for index in indices if index not in inner]


def by_projection(scene: Scene, reduced: Reduced, equilibrium: Equilibrium | None) -> Linearisation:
    """Problem 5: the equations of the independent speeds, and x_f' - S eta - T x = 0 of what follows.

    Raises SingularPoint, NoClosedForm.
    """
    names, ring = scene.system.coordinates, scene.ring
    expansion, equations, about = reduced.expansion, reduced.equations, reduced.about
    place = {i: j for j, i in enumerate(expansion.coordinates)}
    following = [names.index(name) for name in about.following]
    inputs = expansion.scene.system.input_names
    nothing = [ring.zero] * len(following)

    def at(row: Sequence[Polynomial]) -> list[Polynomial]:
        return [row[place[i]] if i in place else ring.zero for i in (*expansion.speeds, *following)]

    mass, velocity = ([[*row, *nothing] for row in rows] for rows in (equations.A, equations.B))
    position, gains = [at(row) for row in equations.C], [list(row) for row in equations.gains]
    for f in following:
        mass.append([ring.zero] * len(about.about))
        velocity.append([*(-x for x in equations.S[place[f]]), *(ring.one if f == k else ring.zero for k in following)])
        position.append([-x for x in at(equations.T[place[f]])])
        gains.append([ring.zero] * len(inputs))
    a, b, c, d = (ScalarMatrix(ring, rows) for rows in (mass, velocity, position, gains))
    parts = (a, b, c, d)
    return assemble(scene, equilibrium, parts, "Newton-Euler recursion to first order", inputs, about)
