"""Problem 5 in speeds with constraints on velocities: x' = A x about a steady motion, x = (s, v).

With  Mb v' = fb(s, v, t),  s' = g(s, V v + v0, t)  and v' = 0, s' = 0 on the motion

    delta s' = (dg/d(s, v)) x,      Mb_0 delta v' = (dfb/d(s, v)) x,      A = [dg/d(s, v); Mb_0^-1 dfb/d(s, v)].

Positions are those on which fb depends, and on which their rates do, and coordinates that have roots of their own since
their rates depend on themselves, if these do not vary on the motion.  Constraints on positions tie the deviations of
these, and are refused.

Second route: what the coordinates have been expanded to (``mechanics.constraints.expansion``), q' = S eta + T x_q and
a eta' + B eta + C x_q = 0 for all coordinates q, and  Z = d(s, v)/d(q, eta)  on the motion:  A Z = Z' + Z A_q.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import ScalarMatrix, solved
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.formulas.formula import Matrix, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import unperturbed_with, unsteady
from mbsym.mechanics.speeds import SpeedForm, Variable
from mbsym.mechanics.variables import ring_environment
from mbsym.problems.checks import Check, check_identities
from mbsym.problems.constraints.motion import dependent_velocities
from mbsym.problems.equilibrium import Equilibrium, unsolved
from mbsym.problems.first_order import FirstOrder
from mbsym.problems.in_speeds.speeds import SpeedEquations
from mbsym.problems.reduction import Reduced


def first_order(form: SpeedForm, equations: SpeedEquations, reduced: Reduced, at: Equilibrium) -> FirstOrder:
    """A in closed form.

    Raises NoClosedForm where the motion does not exist, is not steady in these variables, or positions are constrained.
    """
    ring, tied, embedded = form.ring, equations.constraints, equations.embedded
    if form.system.inputs or form.by_quaternion:
        raise NoClosedForm("inputs and quaternions with constraints: x' = A x is derived without them only")
    if at.impossible:
        raise NoClosedForm("the given motion does not exist")
    if tied is None or tied.position_rank or reduced.about.leaf:
        raise NoClosedForm("constraints tie positions: their deviations are not free")
    if tied.solved is None or embedded is None:
        raise NoClosedForm("the equations without multipliers outgrow the budget of terms")
    images = dependent_velocities(form, tied.solved)
    speeds = [u for u in form.speeds if u.name in tied.free]
    forcing = [x.polynomial for x in embedded.forcing]
    rates = {x.name: ring.reduce(ring.substitute(form.rates[x.name], images)) for x in form.positions}
    plain, motion = _motion(form, reduced, at)
    for by_themselves in (True, False):
        positions = _felt(form, forcing, rates, by_themselves)
        variables = [*positions, *speeds]
        values = {x.index: ring.substitute(_inner(form, x), motion) for x in variables}
        varying = {name for value in values.values() for name in unsteady(plain, value)}
        if not varying:
            break
    if varying:
        raise NoClosedForm(
            Message(
                "the motion is not steady in speeds and positions: they vary with [[names]]",
                names=", ".join(varying),
            )
        )
    on = dict(motion) | values
    formulas = [*(rates[x.name] for x in positions), *forcing]
    slopes = [[ring.substitute(ring.derivative(y, x.name), on) for x in variables] for y in formulas]
    mass = [[ring.substitute(x, on) for x in row] for row in embedded.mass_matrix.polynomials]
    m = len(positions)
    lower = solved(ring, mass, slopes[m:])
    if any(unsteady(plain, x) for row in (*slopes[:m], *lower) for x in row):
        raise NoClosedForm("the coefficients of the first approximation vary with time")
    felt = {x.name for x in positions}
    relations = sum(all({a, b} <= felt for a, b in pairs) for pairs in equations.relations)
    return FirstOrder(
        names=tuple(x.name for x in variables),
        values=column(ring, list(values.values())),
        A=Matrix.of(ring, [*slopes[:m], *lower]),
        relations=relations,
        norms=0,
    )


def check(form: SpeedForm, found: FirstOrder, reduced: Reduced, at: Equilibrium) -> Check:
    """A Z = Z' + Z A_q, with A_q from the expansion in coordinates and Z' along the motion."""
    ring, names = form.ring, form.system.coordinates
    plain, motion = _motion(form, reduced, at)
    by_name = {x.name: x for x in (*form.positions, *form.speeds)}
    inner = [_inner(form, by_name[name]) for name in found.names]
    base, n = reduced.expansion.base, len(names)
    moving = [reduced.expansion.velocities[i] for i in range(n)]
    kept = [*range(n), *(n + k for k in reduced.expansion.speeds)]
    nu = [[ring.substitute(form_.get(j, ring.zero), motion) for j in kept] for form_ in moving]

    def along(y: Polynomial) -> Polynomial:
        """dy/dt on the motion."""
        total = ring.derivative(y, "t")
        for name, rate in zip(names, base.rates, strict=True):
            total = total + ring.times(rate, ring.derivative(y, name))
        for item in form.system.prescribed:
            total = total + ring.times(plain.lower(item.rate), ring.derivative(y, item.name))
        return ring.substitute(ring.reduce(total), motion)

    rows = []
    for y in inner:
        by_place = [ring.substitute(ring.derivative(y, name), motion) for name in names]
        by_rate = [ring.substitute(ring.velocity_derivative(y, name), motion) for name in names]
        through = [ring.dot(by_rate, [nu[i][j] for i in range(n)]) for j in range(len(kept))]
        rows.append([x + (by_place[j] if j < n else ring.zero) for j, x in enumerate(through)])
    equations = reduced.equations
    place = {i: j for j, i in enumerate(reduced.expansion.coordinates)}

    def on(rows_: Sequence[Sequence[Polynomial]]) -> list[list[Polynomial]]:
        return [[ring.substitute(x, motion) for x in row] for row in rows_]

    a, b, c = on(equations.A), on(equations.B), on(equations.C)
    below = solved(ring, a, [[*(-row[place[i]] for i in range(n)), *(-x for x in b[k])] for k, row in enumerate(c)])
    change = ScalarMatrix(ring, rows)
    left, right = ScalarMatrix(ring, found.A.polynomials) @ change, change @ ScalarMatrix(ring, [*nu, *below])
    differences: dict[str, Polynomial] = {
        Message("the row of [[name]], column [[j]]", name=name, j=j): ring.reduce(x - y - along(z))
        for name, one, other, moved in zip(found.names, left, right, rows, strict=True)
        for j, (x, y, z) in enumerate(zip(one, other, moved, strict=True), start=1)
    }
    routes = ("equations of the independent speeds differentiated", "constraints expanded in coordinates")
    return check_identities(ring, "first approximation in speeds", routes, differences, unsolved(plain, at))


def _felt(
    form: SpeedForm, formulas: Sequence[Polynomial], rates: Mapping[str, Polynomial], by_themselves: bool
) -> list[Variable]:
    """The positions on which formulas depend, and on which the rates of these do.

    With ``by_themselves`` the coordinates whose rates depend on themselves, too, directly or through others (the angle
    of a light trailer): they have roots of their own although no equation of the speeds needs them.
    """
    ring, names = form.ring, list(rates)
    needs = {name: set(ring.dependencies(rates[name], names)) for name in names}

    def reached(start: set[str]) -> set[str]:
        found, pending = set(start), list(start)
        while pending:
            new = needs[pending.pop()] - found
            found |= new
            pending += new
        return found

    start = {name for x in formulas for name in ring.dependencies(x, names)}
    if by_themselves:
        start |= {name for name in form.coordinates if name in needs and name in reached(needs[name])}
    found = reached(start)
    return [x for x in form.positions if x.name in found]


def _motion(form: SpeedForm, reduced: Reduced, at: Equilibrium) -> tuple[Scene, dict[int, Polynomial]]:
    """The coordinates' scene, and the motion in them with the velocities that the constraints demand."""
    system, ring, base = form.system.without_speeds, form.ring, reduced.expansion.base
    plain = Scene(system, ring, ring_environment(system, ring), ring, bodies=False)
    images = at.determined(plain)
    found = unperturbed_with(plain, images)
    for name, value, rate in zip(system.coordinates, base.values, base.rates, strict=True):
        if name in base.turning:
            found.pop(ring.index("coordinate", name), None)
        else:
            found[ring.index("coordinate", name)] = ring.substitute(value, images)
        found[ring.index("velocity", name)] = ring.substitute(rate, images)
    found |= {k: ring.substitute(x, images) for k, x in base.related.items() if k not in images}
    return plain, found


def _inner(form: SpeedForm, variable: Variable) -> Polynomial:
    """A variable in (q, q')."""
    for speed, value in zip(form.speeds, form.in_coordinates, strict=True):
        if speed.name == variable.name:
            return value
    return form.in_angles(form.ring.context.gen(variable.index))
