"""Problem 5 in speeds and positions: the first approximation x' = A x about a steady motion.

x are deviations of the positions s on which the equations depend, and of the speeds u.  With  M u' = f,  s' = g  and
u' = 0, s' = 0 on the motion

    delta s' = (dg/dx) x,      M_0 delta u' = (df/dx) x,      so that      A = [dg/dx; M_0^-1 df/dx].

With constraints on velocities u are the independent speeds, and M, f those of the equations without multipliers; the
positions are those on which f depends, and on which their rates do, and coordinates that have roots of their own since
their rates depend on themselves, if these do not vary on the motion.  Constraints on positions tie the deviations of
these, and are refused.

Deviations of unit vectors are not free: e_0 . delta e = 0 and the like, one zero root of A for each that belongs to no
motion; so those of a quaternion, e_0 . delta e = 0.  Where the motion is not steady in these variables there is no
such A.

Second route: with T = d(s, u)/d(q, eta) on the motion and A_q that of the generalised coordinates,  A T = T' + T A_q,
eta the generalised velocities, or those that constraints leave (``mechanics.expansion``);
the rows of a quaternion there are  de/dq_i = 1/2 e o w_i,  w_i the axis about which q_i turns, in those of the body.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import ScalarMatrix, solved
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.expressions.tree import divide, number, reached, substitute
from mbsym.expressions.tree import names as names_in
from mbsym.formulas.formula import Column, Matrix, Shown, column
from mbsym.mechanics.frames import of_turns, rates
from mbsym.mechanics.kinematics import Scene, over_ring
from mbsym.mechanics.motion import motion_values, unperturbed_with, unsteady
from mbsym.mechanics.speeds import SpeedForm, Variable
from mbsym.model.system import velocity_name
from mbsym.problems.checks import Check, check_identities
from mbsym.problems.equilibrium import Equilibrium, unsolved
from mbsym.problems.in_speeds import SpeedEquations
from mbsym.problems.reduction import Reduced


@dataclass(frozen=True, repr=False)
class FirstOrder(Shown):
    """``names`` of x, positions first; their ``values`` on the motion; A (k x k).

    ``relations``: how many combinations of the deviations of unit vectors and quaternions are zero, ``norms`` those of
    quaternions among them.
    """

    counted = ("A",)

    names: tuple[str, ...]
    values: Column
    A: Matrix
    relations: int
    norms: int


def first_order(form: SpeedForm, equations: SpeedEquations, at: Equilibrium, reduced: Reduced) -> FirstOrder:
    """A in closed form, with what the coordinates are ``reduced`` to.

    Raises NoClosedForm where the motion does not exist, is not steady in these variables, or positions are constrained.
    """
    ring = form.ring
    if form.system.inputs:
        raise NoClosedForm("inputs: x' = A x + B v is derived in coordinates only")
    if at.impossible:
        raise NoClosedForm(at.why_not)
    matrix, right, speeds, images = _independent(form, equations, reduced)
    forcing = [x.polynomial for x in right]
    rates = {x.name: ring.reduce(ring.substitute(form.rates[x.name], images)) for x in form.positions}
    plain, motion = _motion(form, at, reduced)
    turned = _quaternions(form, plain, reduced)
    for positions in _positions(form, equations, forcing, rates):
        variables = [*positions, *speeds]
        values = {
            x.index: turned[x.name] if x.name in turned else ring.substitute(_inner(form, x), motion) for x in variables
        }
        varying = {name for value in values.values() for name in unsteady(plain, value)}
        if not varying:
            break
    if varying:
        raise _not_steady(varying)
    on = dict(motion) | values
    formulas = [*(rates[x.name] for x in positions), *forcing]
    slopes = [[ring.substitute(ring.derivative(y, x.name), on) for x in variables] for y in formulas]
    mass = [[ring.substitute(x, on) for x in row] for row in matrix.polynomials]
    m = len(positions)
    lower = solved(ring, mass, slopes[m:])
    if any(unsteady(plain, x) for row in (*slopes[:m], *lower) for x in row):
        raise NoClosedForm("the coefficients of the first approximation vary with time")
    there = {x.name for x in positions}
    return FirstOrder(
        names=tuple(x.name for x in variables),
        values=column(ring, list(values.values())),
        A=Matrix.of(ring, [*slopes[:m], *lower]),
        relations=sum(all({a, b} <= there for a, b in pairs) for pairs in equations.relations),
        norms=sum(name in equations.quaternions and {*parts} <= there for name, parts in equations.vectors),
    )


def _independent(
    form: SpeedForm, equations: SpeedEquations, reduced: Reduced
) -> tuple[Matrix, Column, list[Variable], dict[int, Polynomial]]:
    """M, f and u of the independent speeds, and what the others are."""
    tied, embedded = equations.constraints, equations.embedded
    if tied.position_rank or reduced.about.leaf:
        raise NoClosedForm("constraints tie positions: their deviations are not free")
    if tied.solved is None or embedded is None:
        raise NoClosedForm("the equations without multipliers outgrow the budget of terms")
    from mbsym.problems.constraints.motion import dependent_velocities  # few systems have constraints

    free = [form.speeds[k] for k in tied.solved.embedding.free]
    return embedded.mass_matrix, embedded.forcing, free, dependent_velocities(form, tied.solved)


def check(
    form: SpeedForm,
    equations: SpeedEquations,
    approximation: FirstOrder,
    at: Equilibrium,
    reduced: Reduced,
) -> Check:
    """A T = T' + T A_q, with A_q of the generalised coordinates and T' along the motion."""
    ring, names = form.ring, form.system.coordinates
    plain, motion = _motion(form, at, reduced)
    by_name = {x.name: x for x in (*form.positions, *form.speeds)}
    turned = _quaternion_slopes(form, plain, motion, reduced)
    moving, below, independent = _flow(form, motion, reduced)
    rates = [motion[ring.index("velocity", name)] for name in names]

    def along(y: Polynomial) -> Polynomial:
        """dy/dt on the motion."""
        total = ring.derivative(y, "t")
        running = [*zip(names, rates, strict=True), *((x.name, plain.lower(x.rate)) for x in form.system.prescribed)]
        for name, rate in running:
            total = total + ring.times(rate, ring.derivative(y, name))
        return ring.substitute(ring.reduce(total), motion)

    rows = []
    for name in approximation.names:
        y = _inner(form, by_name[name])
        by_place = [ring.substitute(ring.derivative(y, q), motion) for q in names]
        by_rate = [ring.substitute(ring.velocity_derivative(y, q), motion) for q in names]
        if name in turned:
            by_place, by_rate = turned[name], [ring.zero for _ in names]
        through = [ring.dot(by_rate, column) for column in zip(*moving, strict=True)]
        rows.append([ring.reduce(x + y) for x, y in zip_longest(through, by_place, fillvalue=ring.zero)])
    change = ScalarMatrix(ring, rows)
    left, right = (
        ScalarMatrix(ring, approximation.A.polynomials) @ change,
        change @ ScalarMatrix(ring, [*moving, *below]),
    )
    states = [*names, *(velocity_name(names[k]) for k in independent)]
    differences: dict[str, Polynomial] = {
        Message("the row of [[name]] by [[by]]", name=name, by=by): ring.reduce(a - b - along(z))
        for name, left_row, right_row, row in zip(approximation.names, left, right, rows, strict=True)
        for by, a, b, z in zip(states, left_row, right_row, row, strict=True)
    }
    routes = ("Kane's equations differentiated", "matrices of the generalised coordinates")
    if reduced.about.ties:
        routes = ("equations of the independent speeds differentiated", "constraints expanded in coordinates")
    return check_identities(ring, "first approximation in speeds", routes, differences, unsolved(plain, at))


Rows = list[list[Polynomial]]


def _flow(form: SpeedForm, motion: Mapping[int, Polynomial], reduced: Reduced) -> tuple[Rows, Rows, Sequence[int]]:
    """delta q' and eta' by (delta q, eta), and the places of eta among the velocities."""
    ring, n = form.ring, len(form.system.coordinates)
    expansion, parts = reduced.expansion, reduced.equations
    columns = [*range(n), *(n + k for k in expansion.speeds)]
    moving = [
        [ring.substitute(velocity.get(j, ring.zero), motion) for j in columns] for velocity in expansion.velocities[:n]
    ]
    a, b, c = ([[ring.substitute(x, motion) for x in row] for row in rows] for rows in (parts.A, parts.B, parts.C))
    place = {i: j for j, i in enumerate(expansion.coordinates)}
    right = [[*(-row[place[i]] for i in range(n)), *(-x for x in b[k])] for k, row in enumerate(c)]
    return moving, solved(ring, a, right), expansion.speeds


def _positions(
    form: SpeedForm,
    equations: SpeedEquations,
    formulas: Sequence[Polynomial],
    rates: Mapping[str, Polynomial],
) -> Iterator[list[Variable]]:
    """The positions of x, in the ways that may be steady.

    Beside constraints those on which formulas depend, and on which the rates of these do; first with the coordinates
    whose rates depend on themselves, too, directly or through others (the angle of a light trailer): they have roots of
    their own although no equation of the speeds needs them.
    """
    if not equations.constraints.names:
        yield [x for x in form.positions if x.name not in equations.aside]
        return
    ring, names = form.ring, list(rates)
    needs = {name: set(ring.dependencies(rates[name], names)) for name in names}

    start = {name for x in formulas for name in ring.dependencies(x, names)}
    by_themselves = {name for name in form.coordinates if name in needs and name in reached(needs, needs[name])}
    for reachable in (reached(needs, start | by_themselves), reached(needs, start)):
        yield [x for x in form.positions if x.name in reachable]


def _motion(form: SpeedForm, at: Equilibrium, reduced: Reduced) -> tuple[Scene, dict[int, Polynomial]]:
    """A scene of the coordinates, and the motion in them with the velocities that constraints demand."""
    system, ring = form.system.without_speeds, form.ring
    plain = over_ring(system, ring, bodies=False)
    images = at.determined(plain)
    motion = dict(unperturbed_with(plain, images))
    base = reduced.expansion.base
    for name, value, rate in zip(system.coordinates, base.values, base.rates, strict=True):
        if name in base.turning:
            motion.pop(ring.index("coordinate", name), None)
        else:
            motion[ring.index("coordinate", name)] = ring.substitute(value, images)
        motion[ring.index("velocity", name)] = ring.substitute(rate, images)
    return plain, motion | {k: ring.substitute(x, images) for k, x in base.related.items() if k not in images}


def _inner(form: SpeedForm, variable: Variable) -> Polynomial:
    """A variable in (q, q')."""
    for speed, value in zip(form.speeds, form.in_coordinates, strict=True):
        if speed is variable:
            return value
    return form.in_angles(form.ring.context.gen(variable.index))


def _not_steady(names: Iterable[str]) -> NoClosedForm:
    what = "the motion is not steady in speeds and positions: they vary with [[names]]"
    return NoClosedForm(what, names=", ".join(names))


def _quaternions(form: SpeedForm, plain: Scene, reduced: Reduced) -> dict[str, Polynomial]:
    """The components of quaternions on the motion, by name.  Raises NoClosedForm where they turn there."""
    values = {name: value for name, (value, _) in motion_values(form.system).items()}
    quaternions: dict[str, Polynomial] = {}
    turned = reduced.expansion.base.turning
    for body in form.by_quaternion:
        used = {name for _, angle in body.rotation.turns() for name in names_in(angle)}
        varying = used & {*turned, *(item.name for item in form.system.prescribed), "t"}
        if varying:
            raise _not_steady(sorted(varying))
        turns = []
        for axis, angle in body.rotation.turns():
            sine, cosine = plain.lower.angle(divide(substitute(angle, values), number(2)))
            turns.append((axis, sine, cosine))
        components = body.orientation[0].components
        quaternions |= dict(zip(components, map(form.ring.reduce, of_turns(form.ring, turns)), strict=True))
    return quaternions


def _quaternion_slopes(
    form: SpeedForm, plain: Scene, motion: Mapping[int, Polynomial], reduced: Reduced
) -> dict[str, list[Polynomial]]:
    """de/dq of every component on the motion, by name:  1/2 e o w_i."""
    ring, names = form.ring, form.system.coordinates
    slopes: dict[str, list[Polynomial]] = {}
    if not form.by_quaternion:
        return slopes
    values = _quaternions(form, plain, reduced)
    moving = Scene(plain.system, ring, plain.environment, ring)
    for body in form.by_quaternion:
        components = body.orientation[0].components
        e, spin = [values[name] for name in components], moving.motions[body.name].relative_angular_velocity
        columns = []
        for name in names:
            axis = [ring.substitute(ring.velocity_derivative(x, name), motion) for x in spin]
            columns.append([ring.reduce(x) for x in rates(ring, e, axis)])
        slopes |= {name: [slope_column[k] for slope_column in columns] for k, name in enumerate(components)}
    return slopes
