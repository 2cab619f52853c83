"""Problem 4: does the given unperturbed motion satisfy the equations of motion?

The motion q = q0 + rate t is substituted into  M(q) q'' = f(q, q', t).  Either every residual f_i vanishes identically,
or the conditions under which the motion exists are returned: polynomials in the parameters that must vanish, factors
that cannot vanish dropped.  A condition that a parameter enters linearly is solved for it, and problems 5 and 6 go on
with the solution.

Where angles are singular on the motion, f = 0 says less than the motion demands.  With the Jacobian B of what moves,
f = B^T F; a displacement v with B v = 0 there leaves v^T f = 0 whatever F is, but F is felt beside it: since

    v^T df/dq_j = (dB/dq_j v)^T F        where B v = 0

these vanish, too, in all directions j, if the motion exists.  They are demanded besides f = 0.

Source: Banshchikov & Vetrov, Problem 4.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.equilibrium.satisfied
    True
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from mbsym.algebra.factors import occurring
from mbsym.algebra.jet import Jet
from mbsym.algebra.matrices import null_space_of_rationals
from mbsym.algebra.rationals import exact, fraction
from mbsym.algebra.ring import Polynomial
from mbsym.algebra.signs import Signs
from mbsym.expressions.message import Message, joined
from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import names
from mbsym.formulas.formula import Column, Formula, Shown, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import determined, motion_values, relations, steadied, unperturbed_with, unsteady
from mbsym.model.loads import ForceFunction, Rayleigh
from mbsym.model.system import System

#: A displacement by (coordinate, part), without parts that are zero.
Displacement = tuple[tuple[str, Fraction], ...]


@dataclass(frozen=True, repr=False)
class Equilibrium(Shown):
    """``satisfied``: identically, for all parameter values (relations used).

    ``residuals`` are f_i on the motion, then v^T df/dq_j of each ``singular`` displacement v; ``conditions`` must
    vanish for the motion to exist; ``solved`` are the (parameter, value) pairs that are carried forward; ``impossible``
    lists conditions that can never hold; ``unsteady`` the quantities through which a residual still varies with time.
    """

    counted = ("residuals",)

    satisfied: bool
    residuals: Column
    conditions: tuple[Formula, ...] = ()
    solved: tuple[tuple[str, Formula], ...] = ()
    impossible: tuple[Formula, ...] = ()
    unsteady: tuple[str, ...] = ()
    singular: tuple[Displacement, ...] = ()

    @property
    def why_not(self) -> Message:
        """Why there is no such motion, where a condition is ``impossible``."""
        conditions = joined((Message("$[[left]] = 0$", left=condition) for condition in self.impossible), ", ")
        return Message("the given motion does not exist: [[never]] is impossible", never=conditions)

    def determined(self, scene: Scene) -> dict[int, Polynomial]:
        """Generator indices of all parameters that others determine where the motion exists, and their values."""
        return determined(scene, ((name, value.polynomial) for name, value in self.solved))


def equilibrium(
    scene: Scene,
    residuals: Sequence[Polynomial],
    signs: Signs,
    on_motion: bool = False,
    singular: tuple[Displacement, ...] = (),
) -> Equilibrium:
    """Conditions for the motion, from the residuals f_i at q'' = 0 (scene over the ring).

    ``residuals`` may be the forcing of the nonlinear equations or values already on the motion; with ``on_motion`` they
    are such values, and what they hold of coordinates still moves there.
    """
    ring = scene.ring
    at = relations(scene) if on_motion else unperturbed_with(scene, relations(scene))
    values = [steadied(scene, ring.substitute(x, at)) for x in residuals]
    varying = tuple(dict.fromkeys(name for x in values for name in unsteady(scene, x)))
    pending = [condition for x in values if (condition := essential(scene, x, signs)) is not None]
    conditions: list[Polynomial] = []
    impossible: list[Polynomial] = []
    solved: dict[int, Polynomial] = {}
    while pending:
        condition = min(pending, key=len)
        pending.remove(condition)
        a_number = ring.is_number(condition) and ring.is_zero(condition) is False
        if a_number or signs.never_zero(condition):
            impossible.append(condition)
            continue
        conditions.append(condition)
        solution = _solve(scene, condition, signs.never_zero)
        if solution is not None:
            index, value = solution
            solved = {k: ring.substitute(image, {index: value}) for k, image in solved.items()} | {index: value}
            pending = [ring.substitute(other, {index: value}) for other in pending]
        reduced = [essential(scene, other, signs) for other in pending]
        pending = [
            other
            for other in reduced
            if other is not None and not any(ring.quotient(other, known) is not None for known in conditions)
        ]
    return Equilibrium(
        satisfied=not conditions and not impossible,
        residuals=column(ring, values),
        conditions=column(ring, conditions + impossible),
        solved=tuple((ring.generators[k].name, Formula(ring, value)) for k, value in solved.items()),
        impossible=column(ring, impossible),
        unsteady=varying,
        singular=singular,
    )


def singular_displacements(first: Scene[Jet], expanded: Callable[[], Scene[Jet]]) -> tuple[Displacement, ...]:
    """Displacements that move nothing with mass or load on the motion, but do beside it.

    ``first`` is the scene over jets there, of any order; ``expanded``, of second order, is asked for only where
    something rests.  Those with rational parts; none of coordinates on which loads act directly: such a load is no
    load on bodies there.
    """
    system, n = first.system, len(first.system.coordinates)
    held = {name for load in system.loads for name in load.coordinates}
    for load in system.loads:
        if isinstance(load, ForceFunction | Rayleigh):
            inside = names(load.expression)
            held |= {x for x in system.coordinates if not inside.isdisjoint((x, velocity_name(x)))}
    free = [name for name in system.coordinates if name not in held]
    places = {n + system.coordinates.index(name): column_ for column_, name in enumerate(free)}
    resting = null_space_of_rationals(_slopes(first, places), len(free))
    if not resting:
        return ()
    zero, felt = first.ring.zero, list(_felt(expanded()))

    def moves(parts: Sequence[Any]) -> bool:
        """Whether it moves something beside the motion."""
        changes = (
            sum((x.second.get((j, k), zero) * part for part, k in zip(parts, places, strict=True)), zero)
            for x in felt
            for j in range(n)
        )
        return any(not x.is_zero() for x in changes)

    return tuple(
        tuple((name, fraction(part)) for name, part in zip(free, parts, strict=True) if part)
        for parts in resting
        if moves(parts)
    )


def _felt(scene: Scene[Jet]) -> Iterator[Jet]:
    """The velocities that something with mass or load has, body by body."""
    loaded = {name for load in scene.system.loads for name in load.bodies or ()}
    for name, motion in scene.motions.items():
        if name in loaded or motion.gyrostatic_moment is not None:
            yield from (*motion.velocity_origin, *motion.angular_velocity)
        elif not motion.mass.value.is_zero() or motion.mass.parts:
            yield from motion.velocity_mass_centre
        if motion.inertia is not None:
            yield from motion.inertia @ motion.angular_velocity


def _slopes(scene: Scene[Jet], places: Mapping[int, int]) -> Iterator[dict[int, Any]]:
    """Rows of numbers, by columns, whose products with the rates at ``places`` are what is felt to first order."""
    for x in _felt(scene):
        rows: dict[tuple[int, ...], dict[int, Any]] = {}
        for k, slope in x.first.items():
            if k in places:
                constant = slope.is_constant()  # in a large ring exponents are long
                for monomial, c in [((), slope.leading_coefficient())] if constant else slope.terms():
                    rows.setdefault(monomial if any(monomial) else (), {})[places[k]] = c
        yield from rows.values()


def beside(
    slopes: Mapping[str, Sequence[Polynomial]], singular: Sequence[Displacement], zero: Polynomial
) -> list[Polynomial]:
    """v^T df/dq_j for each displacement v and coordinate j; ``slopes``: df_i/dq_j, all j of the i of each name."""
    return [
        sum((x * exact(part) for (_, part), x in zip(displacement, column_, strict=True)), zero)
        for displacement in singular
        for column_ in zip(*(slopes[name] for name, _ in displacement), strict=True)
    ]


def unsolved(scene: Scene, steady_state: Equilibrium) -> list[Polynomial]:
    """The conditions of problem 4 that were not solved for a parameter, what was solved for put in."""
    ring, at = scene.ring, steady_state.determined(scene)
    values = (ring.substitute(x.polynomial, dict(at)) for x in steady_state.conditions)
    return [ring.fraction(x)[0] for x in values if ring.is_zero(x) is not True]


def essential(scene: Scene, x: Polynomial, signs: Signs) -> Polynomial | None:
    """The square-free part of x's numerator, factors that cannot vanish dropped; None if x is zero."""
    ring = scene.ring
    numerator, _ = ring.fraction(x)
    if numerator.is_zero():
        return None
    product = ring.one
    for factor, _ in ring.factored(numerator)[1]:
        if not signs.never_zero(factor):
            product = ring.times(product, factor)
    return numerator if product.is_constant() else ring.reduce(product)


def on_a_branch(scene: Scene, steady_state: Equilibrium) -> dict[int, Polynomial]:
    """As ``determined``, on one branch of the conditions that were not solved: s = 0 of s sin(a) = 0, sin(a) != 0.

    What holds only where the motion exists is to be tried there.  A condition that is linear in no parameter is left.
    """
    ring, solved = scene.ring, [(name, value.polynomial) for name, value in steady_state.solved]
    pending = unsolved(scene, steady_state)
    while pending:
        solution = _solve(scene, pending.pop(), lambda slope: ring.is_zero(slope) is not True)
        if solution is not None:
            index, value = solution
            solved = [(name, ring.substitute(image, {index: value})) for name, image in solved]
            solved.append((ring.generators[index].name, value))
            pending = [x for x in (ring.substitute(x, {index: value}) for x in pending) if ring.is_zero(x) is not True]
    return determined(scene, solved)


def _solve(
    scene: Scene, condition: Polynomial, never_zero: Callable[[Polynomial], bool]
) -> tuple[int, Polynomial] | None:
    """(generator, value) for a parameter that enters linearly with a coefficient that cannot vanish."""
    ring = scene.ring
    hidden = {
        index
        for k, g in enumerate(ring.generators)
        if g.argument is not None and condition.degrees()[k] > 0
        for index in occurring([g.argument])
    }
    options = []
    for order, name in enumerate(_preferred(scene.system)):
        index = ring.index("parameter", name)
        if condition.degrees()[index] != 1 or index in hidden or name in ring.angles:
            continue
        slope = condition.derivative(index)
        if never_zero(slope):
            options.append((len(slope), order, index, slope))
    if not options:
        return None
    _, _, index, slope = min(options, key=lambda option: option[:2])
    rest = condition - ring.times(slope, ring.context.gen(index))
    return index, ring.ratio(-rest, slope)


def _preferred(system: System) -> list[str]:
    """Parameters that the motion itself names come first: r0 is solved for before m or g is."""
    from mbsym.expressions.tree import names

    of_motion: set[str] = set()
    for value, rate in motion_values(system).values():
        of_motion |= names(value) | names(rate)
    return sorted(system.parameter_names, key=lambda name: name not in of_motion)
