"""Problem 5 in speeds and positions: the first approximation x' = A x about a steady motion.

x are deviations of the positions s on which the equations depend, and of the speeds u.  With  M u' = f,  s' = g  and
u' = 0, s' = 0 on the motion

    delta s' = (dg/dx) x,      M_0 delta u' = (df/dx) x,      so that      A = [dg/dx; M_0^-1 df/dx].

Deviations of unit vectors are not free: e_0 . delta e = 0 and the like, one zero root of A for each that belongs to no
motion; so those of a quaternion, e_0 . delta e = 0.  Where the motion is not steady in these variables there is no
such A.

Second route: with T = d(s, u)/d(q, q') on the motion and A_q that of the generalised coordinates,  A T = T' + T A_q;
the rows of a quaternion there are  de/dq_i = 1/2 e o w_i,  w_i the axis about which q_i turns, in those of the body.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import ScalarMatrix, solved
from mbsym.algebra.ring import Polynomial
from mbsym.expressions.message import Message
from mbsym.expressions.tree import divide, number, substitute
from mbsym.expressions.tree import names as names_in
from mbsym.formulas.formula import Column, Matrix, Shown, column
from mbsym.mechanics.frames import of_turns, rates
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import motion_values, rate_on_motion, turning, unperturbed_with, unsteady
from mbsym.mechanics.speeds import SpeedForm, Variable
from mbsym.mechanics.variables import ring_environment
from mbsym.model.system import velocity_name
from mbsym.problems.checks import Check, check_identities
from mbsym.problems.equilibrium import Equilibrium, unsolved
from mbsym.problems.in_speeds.speeds import SpeedEquations
from mbsym.problems.linearisation import Linearisation


@dataclass(frozen=True, repr=False)
class FirstOrder(Shown):
    """``names`` of x, positions first; their ``values`` on the motion; A (k x k).

    ``relations``: how many combinations of the deviations of unit vectors and quaternions are zero, ``norms`` those of
    quaternions among them.
    """

    names: tuple[str, ...]
    values: Column
    A: Matrix
    relations: int
    norms: int

    @property
    def terms(self) -> int:
        return self.A.terms


def first_order(form: SpeedForm, equations: SpeedEquations, equilibrium: Equilibrium) -> FirstOrder:
    """A in closed form.  Raises NoClosedForm where the motion does not exist, or is not steady in these variables."""
    ring = form.ring
    if form.system.inputs:
        raise NoClosedForm("inputs: x' = A x + B v is derived in coordinates only")
    if equilibrium.impossible:
        raise NoClosedForm("the given motion does not exist")
    variables = _variables(form, equations)
    plain, at = _motion(form, equilibrium)
    turned = _quaternions(form, plain)
    values = {x.index: turned[x.name] if x.name in turned else _value(form, x, at) for x in variables}
    varying = {name for value in values.values() for name in unsteady(plain, value)}
    if varying:
        raise NoClosedForm(
            Message(
                "the motion is not steady in speeds and positions: they vary with [[names]]",
                names=", ".join(varying),
            )
        )
    on = dict(at) | values
    kinematic = [form.rates[x.name] for x in variables[: len(variables) - len(form.speeds)]]
    forcing = [x.polynomial for x in equations.forcing]
    slopes = [[ring.substitute(ring.derivative(y, x.name), on) for x in variables] for y in (*kinematic, *forcing)]
    mass = [[ring.substitute(x, on) for x in row] for row in equations.mass_matrix.polynomials]
    m = len(kinematic)
    lower = solved(ring, mass, slopes[m:])
    if any(unsteady(plain, x) for row in (*slopes[:m], *lower) for x in row):
        raise NoClosedForm("the coefficients of the first approximation vary with time")
    count = len(equations.relations)
    return FirstOrder(
        names=tuple(x.name for x in variables),
        values=column(ring, list(values.values())),
        A=Matrix.of(ring, [*slopes[:m], *lower]),
        relations=count,
        norms=len(equations.quaternions),
    )


def check(
    form: SpeedForm, equations: SpeedEquations, found: FirstOrder, linear: Linearisation, at: Equilibrium
) -> Check:
    """A T = T' + T A_q, with A_q from the matrices of the generalised coordinates and T' along the motion."""
    ring, names = form.ring, form.system.coordinates
    plain, motion = _motion(form, at)
    variables = _variables(form, equations)
    turned = _quaternion_slopes(form, plain, motion)
    rows = [
        turned[x.name]
        if x.name in turned
        else [ring.substitute(ring.derivative(y, name), motion) for name in names]
        + [ring.substitute(ring.velocity_derivative(y, name), motion) for name in names]
        for x, y in ((x, _inner(form, x)) for x in variables)
    ]
    routes = ("Kane's equations differentiated", "matrices of the generalised coordinates")
    moving = [[ring.substitute(rate_on_motion(plain, x), motion) for x in row] for row in rows]
    mass, damping, gyroscopic, stiffness, circulatory = (matrix.polynomials for matrix in linear.matrices)
    n = range(len(names))
    below = [
        [-stiffness[i][j] - circulatory[i][j] for j in n] + [-damping[i][j] - gyroscopic[i][j] for j in n] for i in n
    ]
    upper = [[ring.one if j == len(names) + i else ring.zero for j in range(2 * len(names))] for i in n]
    whole = [*upper, *solved(ring, mass, below)]
    change = ScalarMatrix(ring, rows)
    left, right = ScalarMatrix(ring, found.A.polynomials) @ change, change @ ScalarMatrix(ring, whole)
    states = [*names, *(velocity_name(name) for name in names)]
    differences: dict[str, Polynomial] = {
        Message("the row of [[name]] by [[by]]", name=x.name, by=by): ring.reduce(a - b - rate)
        for x, one, other, moved in zip(variables, left, right, moving, strict=True)
        for by, a, b, rate in zip(states, one, other, moved, strict=True)
    }
    return check_identities(ring, "first approximation in speeds", routes, differences, unsolved(plain, at))


def _variables(form: SpeedForm, equations: SpeedEquations) -> list[Variable]:
    return [*(x for x in form.positions if x.name not in equations.aside), *form.speeds]


def _motion(form: SpeedForm, equilibrium: Equilibrium) -> tuple[Scene, Mapping[int, Polynomial]]:
    """A scene of the coordinates, and the motion in them, conditions and relations used."""
    system = form.system.without_speeds
    plain = Scene(system, form.ring, ring_environment(system, form.ring), form.ring, bodies=False)
    return plain, unperturbed_with(plain, equilibrium.determined(plain))


def _inner(form: SpeedForm, variable: Variable) -> Polynomial:
    """A variable in (q, q')."""
    for speed, value in zip(form.speeds, form.in_coordinates, strict=True):
        if speed is variable:
            return value
    return form.in_angles(form.ring.context.gen(variable.index))


def _quaternions(form: SpeedForm, plain: Scene) -> dict[str, Polynomial]:
    """The components of quaternions on the motion, by name.  Raises NoClosedForm where they turn there."""
    values = {name: value for name, (value, _) in motion_values(form.system).items()}
    found: dict[str, Polynomial] = {}
    for body in form.by_quaternion:
        used = {name for _, angle in body.rotation.turns() for name in names_in(angle)}
        varying = used & {*turning(plain), *(item.name for item in form.system.prescribed), "t"}
        if varying:
            names = ", ".join(sorted(varying))
            raise NoClosedForm(
                Message("the motion is not steady in speeds and positions: they vary with [[names]]", names=names)
            )
        turns = []
        for axis, angle in body.rotation.turns():
            sine, cosine = plain.lower.angle(divide(substitute(angle, values), number(2)))
            turns.append((axis, sine, cosine))
        components = body.orientation[0].components
        found |= dict(zip(components, map(form.ring.reduce, of_turns(form.ring, turns)), strict=True))
    return found


def _quaternion_slopes(form: SpeedForm, plain: Scene, motion: Mapping[int, Polynomial]) -> dict[str, list[Polynomial]]:
    """d(e)/d(q, q') of every component on the motion, by name:  1/2 e o w_i  and zeros."""
    ring, names = form.ring, form.system.coordinates
    found: dict[str, list[Polynomial]] = {}
    if not form.by_quaternion:
        return found
    values = _quaternions(form, plain)
    moving = Scene(plain.system, ring, plain.environment, ring)
    for body in form.by_quaternion:
        components = body.orientation[0].components
        e, spin = [values[name] for name in components], moving.motions[body.name].relative_angular_velocity
        columns = []
        for name in names:
            axis = [ring.substitute(ring.velocity_derivative(x, name), motion) for x in spin]
            columns.append([ring.reduce(x) for x in rates(ring, e, axis)])
        zeros = [ring.zero] * len(names)
        found |= {name: [*(column[k] for column in columns), *zeros] for k, name in enumerate(components)}
    return found


def _value(form: SpeedForm, variable: Variable, at: Mapping[int, Polynomial]) -> Polynomial:
    return form.ring.substitute(_inner(form, variable), at)
