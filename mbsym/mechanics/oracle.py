"""An independent derivation at one state: d'Alembert's principle in inertial axes, by Taylor series in time.

It shares with the rest of mbsym only the description and the arithmetic of numbers; the geometry is its own.  Bodies
are placed by active rotations (Rodrigues' formula e e^T + c (1 - e e^T) + s [e]), velocities and accelerations are the
Taylor coefficients of positions, partial velocities are directional derivatives of positions, and

    residual_i = sum over bodies of  m r_C'' . dr_C/dq_i + dH_C/dt . (rotation vector of dA/dq_i)  -  Q_i .

Bodies that a joint carries move as one: forces and moments are summed about the origin of the inertial axes, once for
all joints.  Gravity is taken from the second moments of the masses, other conservative forces by displacing the system,
so that a slip in a frame, an axis order, a Coriolis term or a gravity torque elsewhere does not repeat itself here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

from mbsym.algebra.base import Algebra, Lowering, Scalar
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.rates import acceleration_name
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import Name, names
from mbsym.model import loads
from mbsym.model import system as model
from mbsym.model.system import INERTIAL, System, velocity_name

Triple = list["Series"]


class Series:
    """a + b s + c s^2, higher powers dropped."""

    __slots__ = ("a", "b", "c")

    def __init__(self, a: Scalar, b: Scalar, c: Scalar) -> None:
        self.a, self.b, self.c = a, b, c

    def __add__(self, other: Series) -> Series:
        return Series(self.a + other.a, self.b + other.b, self.c + other.c)

    def __sub__(self, other: Series) -> Series:
        return Series(self.a - other.a, self.b - other.b, self.c - other.c)

    def __neg__(self) -> Series:
        return Series(-self.a, -self.b, -self.c)

    def __mul__(self, other: Series) -> Series:
        a, b, first, second = self.a, self.b, other.a, other.b
        return Series(a * first, a * second + b * first, a * other.c + b * second + self.c * first)


class Dual:
    """a + b s, higher powers dropped."""

    __slots__ = ("a", "b")

    def __init__(self, a: Scalar, b: Scalar) -> None:
        self.a, self.b = a, b

    def __add__(self, other: Dual) -> Dual:
        return Dual(self.a + other.a, self.b + other.b)

    def __sub__(self, other: Dual) -> Dual:
        return Dual(self.a - other.a, self.b - other.b)

    def __neg__(self) -> Dual:
        return Dual(-self.a, -self.b)

    def __mul__(self, other: Dual) -> Dual:
        a, first = self.a, other.a
        return Dual(a * first, a * other.b + self.b * first)


class TaylorSeries(Algebra[Series]):
    """Series over numbers (rationals or balls)."""

    def __init__(self, numbers: Algebra, angles: Mapping[str, Any]) -> None:
        self.numbers = numbers
        self.angles = angles
        self.zero, self.one = self.number(0), self.number(1)

    def number(self, value: Fraction | int) -> Series:
        return self.constant(self.numbers.number(value))

    def constant(self, value: Scalar) -> Series:
        return Series(value, self.numbers.zero, self.numbers.zero)

    def vanishes(self, x: Series) -> bool:
        return all(self.numbers.vanishes(part) for part in (x.a, x.b, x.c))

    def _compose(self, x: Series, value: Scalar, slope: Scalar, half_curvature: Scalar) -> Series:
        return Series(value, slope * x.b, slope * x.c + half_curvature * x.b * x.b)

    def sin_cos(self, angle: LinearForm) -> tuple[Series, Series]:
        total = self.zero
        for name, coefficient in angle.coefficients:
            total = total + self.number(coefficient) * self.angles[name]
        return self._turned(total, *self.numbers.sin_cos(angle))

    def sin_cos_of(self, argument: Series) -> tuple[Series, Series]:
        return self._turned(argument, *self.numbers.sin_cos_of(argument.a))

    def _turned(self, x: Series, sine: Scalar, cosine: Scalar) -> tuple[Series, Series]:
        half = self.numbers.number(Fraction(-1, 2))
        return self._compose(x, sine, cosine, half * sine), self._compose(x, cosine, -sine, half * cosine)

    def reciprocal(self, x: Series) -> Series:
        inverse = self.numbers.reciprocal(x.a)
        return self._compose(x, inverse, -inverse * inverse, inverse * inverse * inverse)

    def square_root(self, x: Series) -> Series:
        root = self.numbers.square_root(x.a)
        inverse = self.numbers.reciprocal(root)
        slope = self.numbers.number(Fraction(1, 2)) * inverse
        return self._compose(x, root, slope, self.numbers.number(Fraction(-1, 8)) * inverse * inverse * inverse)

    def function(self, name: str, x: Series) -> Series:
        if name in ("sinh", "cosh", "tanh"):
            up, down = self.function("exp", x), self.function("exp", -x)
            half = self.number(Fraction(1, 2))
            sinh, cosh = half * (up - down), half * (up + down)
            return {"sinh": sinh, "cosh": cosh}.get(name) or sinh * self.reciprocal(cosh)
        if name in ("abs", "sign"):  # off the kink
            sign, nothing = self.numbers.function("sign", x.a), self.numbers.zero
            if name == "sign":
                return self._compose(x, sign, nothing, nothing)
            return self._compose(x, x.a * sign, sign, nothing)
        value = self.numbers.function(name, x.a)
        if isinstance(name, Tabulated):  # off the knots
            slope, bend = self.numbers.function(name.slope, x.a), self.numbers.function(name.slope.slope, x.a)
            return self._compose(x, value, slope, self.numbers.number(Fraction(1, 2)) * bend)
        half_number = self.numbers.number(Fraction(1, 2))
        if name == "exp":
            return self._compose(x, value, value, half_number * value)
        if name == "log":
            inverse = self.numbers.reciprocal(x.a)
            return self._compose(x, value, inverse, -half_number * inverse * inverse)
        inverse = self.numbers.reciprocal(self.numbers.one + x.a * x.a)
        return self._compose(x, value, inverse, -x.a * inverse * inverse)


class FirstOrder(TaylorSeries):
    """The same to first order only: what a small disturbance does."""

    def constant(self, value: Scalar) -> Any:
        return Dual(value, self.numbers.zero)

    def vanishes(self, x: Any) -> bool:
        return self.numbers.vanishes(x.a) and self.numbers.vanishes(x.b)

    def _compose(self, x: Any, value: Scalar, slope: Scalar, half_curvature: Scalar) -> Any:
        return Dual(value, slope * x.b)


@dataclass(frozen=True, slots=True)
class State:
    """Numbers for everything: ``values`` by declared name (and ``q_dot``, ``q_ddot``), in ``numbers``' kind."""

    numbers: Algebra
    values: Mapping[str, Scalar]


class Placement:
    """Every body's place in inertial axes as series: ``origin``, and ``axes`` whose columns are the body axes."""

    def __init__(self, system: System, state: State, environment: Mapping[str, Series]) -> None:
        self.system = system
        self.algebra = TaylorSeries(state.numbers, environment)
        self.lower = Lowering(self.algebra, environment)
        self._centres: dict[str, Triple] = {}
        self._tensors: dict[str, list[Triple]] = {}
        self._spins: dict[str, tuple[list[Scalar], list[Scalar]]] = {}
        series, zero = self.algebra.one, self.algebra.zero
        identity = [[series if i == j else zero for j in range(3)] for i in range(3)]
        self.origin: dict[str, Triple] = {INERTIAL: [zero, zero, zero]}
        self.axes: dict[str, list[Triple]] = {INERTIAL: identity}
        for body in system.bodies:
            self._place(body)

    def _place(self, body: model.Body) -> None:
        offset = self.lower.vector(body.connection_point)
        self.origin[body.name] = self.point(body.attached_to, offset)
        axes = self.axes[body.attached_to]
        for axis, angle in body.rotation.turns():
            axes = _product(axes, self._rodrigues(axis - 1, *self.lower.angle(angle)))
        self.axes[body.name] = axes

    @cached_property
    def frames(self) -> dict[str, model.Body]:
        """The bodies by name."""
        return {body.name: body for body in self.system.bodies}

    @cached_property
    def joined(self) -> dict[str, list[str]]:
        """By a name the bodies whose place or turns against the body before them depend on it, from the base on."""
        dependents: dict[str, list[str]] = {}
        for body in self.system.bodies:
            turns = (names(angle) for _, angle in body.rotation.turns())
            for name in set().union(*map(names, body.connection_point), *turns):
                dependents.setdefault(name, []).append(body.name)
        return dependents

    def _rodrigues(self, k: int, s: Series, c: Series) -> list[Triple]:
        """e e^T + c (1 - e e^T) + s [e x], e the k-th unit vector."""
        series, zero = self.algebra.one, self.algebra.zero
        rows = [[series if i == j == k else (c if i == j else zero) for j in range(3)] for i in range(3)]
        rows[(k + 1) % 3][(k + 2) % 3] = -s
        rows[(k + 2) % 3][(k + 1) % 3] = s
        return rows

    def direction(self, body: str, v: Sequence[Series]) -> Triple:
        """A vector given in a body's axes, in inertial axes."""
        return [dot(row, v) for row in self.axes[body]]

    def point(self, body: str, v: Sequence[Series]) -> Triple:
        return [a + b for a, b in zip(self.origin[body], self.direction(body, v), strict=True)]

    def mass_centre(self, body: model.Body) -> Triple:
        if body.name not in self._centres:
            self._centres[body.name] = self.point(body.name, self.lower.vector(body.mass_centre))
        return self._centres[body.name]

    def inertia(self, body: model.Body) -> list[Triple] | None:
        """A Theta_C A^T, in inertial axes."""
        if body.inertia is None:
            return None
        if body.name not in self._tensors:
            self._tensors[body.name] = self._inertia(body, body.inertia)
        return self._tensors[body.name]

    def _inertia(self, body: model.Body, inertia: model.Inertia) -> list[Triple]:
        tensor = [list(self.lower.vector(row)) for row in inertia.tensor]
        if inertia.about == "joint":
            c = self.lower.vector(body.mass_centre)
            mass, square = self.lower(body.mass), dot(c, c)
            for i in range(3):
                for j in range(3):
                    steiner = square - c[i] * c[j] if i == j else -(c[i] * c[j])
                    tensor[i][j] = tensor[i][j] - mass * steiner
        axes = self.axes[body.name]
        return _product(_product(axes, tensor), _transpose(axes))

    def gyrostatic_moment(self, body: model.Body) -> Triple | None:
        """h, fixed in the body, in inertial axes: its rate comes from the turning of the axes alone."""
        if body.gyrostatic_moment is None:
            return None
        return self.direction(body.name, self.lower.vector(body.gyrostatic_moment))

    def spin(self, body: str) -> tuple[list[Scalar], list[Scalar]]:
        """omega and domega/ds from A' A^T, in inertial axes."""
        if body not in self._spins:
            self._spins[body] = self._spin(self.axes[body])
        return self._spins[body]

    def _spin(self, axes: list[Triple]) -> tuple[list[Scalar], list[Scalar]]:
        omega, rate = [], []
        for i, j in ((2, 1), (0, 2), (1, 0)):
            pairs = list(zip(axes[i], axes[j], strict=True))
            omega.append(sum((x.b * y.a for x, y in pairs), self.algebra.numbers.zero))
            two = self.algebra.numbers.number(2)
            rate.append(sum((two * x.c * y.a + x.b * y.b for x, y in pairs), self.algebra.numbers.zero))
        return omega, rate


def dot(u: Sequence[Any], v: Sequence[Any]) -> Any:
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def _product(a: list[Triple], b: list[Triple]) -> list[Triple]:
    return [[dot(row, [b[k][j] for k in range(3)]) for j in range(3)] for row in a]


def _transpose(a: list[Triple]) -> list[Triple]:
    return [[a[j][i] for j in range(3)] for i in range(3)]


class _Placed(dict[str, Any]):
    """Values by the names of bodies, each found when it is first asked for."""

    def __init__(self, found: Callable[[str], Any]) -> None:
        super().__init__()
        self._found = found

    def __missing__(self, body: str) -> Any:
        self[body] = self._found(body)
        return self[body]


class Displacement(Placement):
    """The system at rest in the state, displaced along one coordinate q: series in the displacement, first order.

    A joint whose own expressions contain q is placed anew.  What hangs on it moves with it as one rigid body,

        r' = r_O' + theta x (r - r_O),   e' = theta x e     (O, theta: its origin and rotation vector),

    and everything else stays where ``rest`` has it.  A body is placed when somebody asks for it.
    """

    def __init__(self, state: State, environment: Mapping[str, Series], rest: Placement, name: str) -> None:
        self.system, self.name, self.rest = rest.system, name, rest
        self.algebra = TaylorSeries(state.numbers, environment)
        self.lower = Lowering(self.algebra, environment)
        self._centres, self._tensors, self._spins = {}, {}, {}
        #: The displaced joint that carries a body; None for those that stay.
        self._carrier = _Placed(self._carrier_of)
        self._carrier[INERTIAL] = None
        self.origin, self.axes = _Placed(self._origin_of), _Placed(self._axes_of)

    def _carrier_of(self, body: str) -> str | None:
        return body if self._joins(body) else self._carrier[self.rest.frames[body].attached_to]

    def _joins(self, body: str) -> bool:
        return body in self.rest.joined.get(self.name, ())

    def _origin_of(self, body: str) -> Triple:
        carrier = self._carrier[body]
        if carrier is None:
            return self.rest.origin[body]
        if carrier == body:
            self._place(self.rest.frames[body])
            return self.origin[body]
        return self._carried(carrier, self.rest.origin[body])

    def _axes_of(self, body: str) -> list[Triple]:
        carrier = self._carrier[body]
        if carrier is None:
            return self.rest.axes[body]
        if carrier == body:
            self._place(self.rest.frames[body])
            return self.axes[body]
        theta = self.spin(carrier)[0]
        return _transpose([self._turned(theta, column) for column in _transpose(self.rest.axes[body])])

    def spin(self, body: str) -> tuple[list[Scalar], list[Scalar]]:
        """theta, the rotation vector; the second part is never asked for."""
        carrier = self._carrier[body]
        return super().spin(body) if carrier in (None, body) else self.spin(carrier)

    def work(self, wrenches: Wrenches) -> Scalar:
        """sum over all bodies of F . dr_C/dq + L . theta.

        Of a rigid motion it is F . v + N . theta with the sums F, N of ``wrenches`` about the origin of the inertial
        axes, where v = r_O' - theta x r_O.  What hangs on two displaced joints, one beyond the other, moves with the
        inner one, and besides as the outer one does against that.
        """
        total = self.algebra.numbers.zero
        for joint in self.rest.joined.get(self.name, ()):
            force, moment = wrenches[joint]
            (v, theta), inner = self._motion(joint), self._carrier[self.rest.frames[joint].attached_to]
            if inner is not None:
                u, turned = self._motion(inner)
                v, theta = ([a - b for a, b in zip(x, y, strict=True)] for x, y in ((v, u), (theta, turned)))
            total = total + dot(force, v) + dot(moment, theta)
        return total

    def _motion(self, joint: str) -> tuple[list[Scalar], list[Scalar]]:
        """(v, theta) of a displaced joint."""
        theta, origin = self.spin(joint)[0], self.origin[joint]
        swept = cross(theta, [x.a for x in origin])
        return [x.b - y for x, y in zip(origin, swept, strict=True)], theta

    def mass_centre(self, body: model.Body) -> Triple:
        carrier = self._carrier[body.name]
        if carrier is None:
            return self.rest.mass_centre(body)
        if body.name not in self._centres:
            self._centres[body.name] = self._carried(carrier, self.rest.mass_centre(body))
        return self._centres[body.name]

    def _carried(self, carrier: str, point: Triple) -> Triple:
        arm = [x.a - o.a for x, o in zip(point, self.rest.origin[carrier], strict=True)]
        turned = cross(self.spin(carrier)[0], arm)
        zero = self.algebra.numbers.zero
        return [Series(x.a, o.b + along, zero) for x, o, along in zip(point, self.origin[carrier], turned, strict=True)]

    def _turned(self, theta: Sequence[Scalar], direction: Triple) -> Triple:
        turned = cross(theta, [x.a for x in direction])
        return [Series(x.a, along, self.algebra.numbers.zero) for x, along in zip(direction, turned, strict=True)]


#: By a body's name the sums (F, N) of forces and of their moments about the origin of the inertial axes, over the body
#: and all that hangs on it; by ``INERTIAL`` those over the whole system.
Wrenches = Mapping[str, tuple[list[Scalar], list[Scalar]]]


def cross(u: Sequence[Scalar], v: Sequence[Scalar]) -> list[Scalar]:
    return [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]


class Oracle:
    """All generalised forces of a system at one state."""

    def __init__(self, system: System, state: State) -> None:
        self.system = system
        self.state = state
        self.numbers = state.numbers
        self._last: Displacement | None = None
        self._weights: dict[loads.UniformGravity, Wrenches] = {}

    @cached_property
    def moving(self) -> Placement:
        """The system moving through the state: series in time."""
        return Placement(self.system, self.state, self.in_time)

    @cached_property
    def rest(self) -> Placement:
        """The system at rest in the state."""
        return Placement(self.system, self.state, self._constants())

    def displaced(self, name: str) -> Displacement:
        """The system at rest in the state, displaced along a coordinate; only the last one asked for is kept."""
        if self._last is None or self._last.name != name:
            self._last = Displacement(self.state, self._displaced(name), self.rest, name)
        return self._last

    @cached_property
    def residuals(self) -> dict[str, Scalar]:
        """M q'' - forcing, for every coordinate."""
        return {
            name: self.displaced(name).work(self.momentum_rates) - self._applied(name)
            for name in self.system.coordinates
        }

    def _constants(self) -> dict[str, Series]:
        zero = self.numbers.zero
        return {name: Series(value, zero, zero) for name, value in self.state.values.items()}

    @cached_property
    def in_time(self) -> dict[str, Series]:
        """Every name as a series in time."""
        zero, half = self.numbers.zero, self.numbers.number(Fraction(1, 2))
        environment, values = self._constants(), self.state.values
        environment["t"] = Series(values["t"], self.numbers.one, zero)
        rates = Lowering(self.numbers, values)
        second = {item.name: rates(item.rate) for item in self.system.prescribed}
        for item in self.system.prescribed:
            curved = half * second.get(item.rate.name, zero) if isinstance(item.rate, Name) else zero
            environment[item.name] = Series(values[item.name], rates(item.rate), curved)
        for name in self.system.coordinates:
            speed, acceleration = values[velocity_name(name)], values[acceleration_name(name)]
            environment[name] = Series(values[name], speed, half * acceleration)
            environment[velocity_name(name)] = Series(speed, acceleration, zero)
        return environment

    def _displaced(self, name: str) -> dict[str, Series]:
        environment = self._constants()
        environment[name] = Series(self.state.values[name], self.numbers.one, self.numbers.zero)
        return environment

    @cached_property
    def momentum_rates(self) -> Wrenches:
        """The sums of m r_C'' and of r_C x m r_C'' + dH_C/dt."""
        two = self.numbers.number(2)
        wrenches = {}
        for body in self.system.bodies:
            mass = self.moving.lower(body.mass).a
            tensor = self.moving.inertia(body)
            internal = self.moving.gyrostatic_moment(body)
            if self.numbers.vanishes(mass) and tensor is None and internal is None:
                continue
            centre = self.moving.mass_centre(body)
            force = [mass * two * x.c for x in centre]
            change = None
            if tensor is not None:
                omega, rate = self.moving.spin(body.name)
                change = [dot([x.a for x in row], rate) + dot([x.b for x in row], omega) for row in tensor]
            if internal is not None:
                turning = [x.b for x in internal]
                change = turning if change is None else [a + b for a, b in zip(change, turning, strict=True)]
            moment = cross([x.a for x in centre], force)
            if change is not None:
                moment = [a + b for a, b in zip(moment, change, strict=True)]
            wrenches[body.name] = force, moment
        return self._gathered(wrenches)

    def weights(self, load: loads.UniformGravity) -> Wrenches:
        """The sums of m g and of r_C x m g; the same load is asked for again and again."""
        if load not in self._weights:
            wrenches, field = {}, [x.a for x in self.rest.lower.vector(load.acceleration)]
            for body in self.system.bodies:
                mass = self.rest.lower(body.mass).a
                force = [mass * x for x in field]
                wrenches[body.name] = force, cross([x.a for x in self.rest.mass_centre(body)], force)
            self._weights[load] = self._gathered(wrenches)
        return self._weights[load]

    def _gathered(self, own: Wrenches) -> Wrenches:
        """What acts on each body and on all that hangs on it, from what acts on each (nothing on those left out)."""
        nothing = [self.numbers.zero] * 3, [self.numbers.zero] * 3
        wrenches = {INERTIAL: nothing, **{body.name: own.get(body.name, nothing) for body in self.system.bodies}}
        for body in reversed(self.system.bodies):
            pairs = zip(wrenches[body.attached_to], wrenches[body.name], strict=True)
            force, moment = ([a + b for a, b in zip(x, y, strict=True)] for x, y in pairs)
            wrenches[body.attached_to] = force, moment
        return wrenches

    def _applied(self, name: str) -> Scalar:
        total = self.numbers.zero
        for load in self.system.loads:
            if type(load) in _GENERALIZED_FORCES:
                total = total + _GENERALIZED_FORCES[type(load)](self, load, name)
            else:
                total = total + _FORCE_FUNCTIONS[type(load)](load, self.displaced(name)).b
        return total

    @cached_property
    def force_function(self) -> Scalar:
        """U of all loads that have one."""
        total = self.numbers.zero
        for load in self.system.loads:
            if type(load) in _FORCE_FUNCTIONS:
                total = total + _FORCE_FUNCTIONS[type(load)](load, self.moving).a
        return total

    @cached_property
    def kinetic_energy(self) -> Scalar:
        """(1/2) sum of m V_C^2 + omega . A Theta_C A^T omega, and the gyrostatic term."""
        return self.energy_of_motion + self.gyrostatic_term

    @cached_property
    def gyrostatic_term(self) -> Scalar:
        """sum of (A h) . omega."""
        total = self.numbers.zero
        for body in self.system.bodies:
            internal = self.moving.gyrostatic_moment(body)
            if internal is not None:
                total = total + dot([x.a for x in internal], self.moving.spin(body.name)[0])
        return total

    @cached_property
    def energy_of_motion(self) -> Scalar:
        """(1/2) sum of m V_C^2 + omega . A Theta_C A^T omega: what T - (gyrostatic term) must be."""
        twice = self.numbers.zero
        for body in self.system.bodies:
            mass = self.moving.lower(body.mass).a
            for x in self.moving.mass_centre(body):
                twice = twice + mass * x.b * x.b
            tensor = self.moving.inertia(body)
            if tensor is not None:
                spin = self.moving.spin(body.name)[0]
                twice = twice + dot(spin, [dot([x.a for x in row], spin) for row in tensor])
        return twice * self.numbers.number(Fraction(1, 2))

    def along(self, name: str, body: str, point: Sequence[Scalar]) -> list[Scalar]:
        """dr_P/dq in inertial axes."""
        constant = [self.moving.algebra.constant(x) for x in point]
        return [x.b for x in self.displaced(name).point(body, constant)]

    def numbers_of(self, components: Sequence[Any]) -> list[Scalar]:
        return [self.moving.lower(x).a for x in components]

    def in_inertial_axes(self, axes: str, components: Sequence[Any]) -> list[Scalar]:
        return [x.a for x in self.moving.direction(axes, self.moving.lower.vector(components))]


# --- loads, each by the shortest physical argument ---
#
# Conservative loads give their force function for a placement of the bodies; its derivative along a displacement is
# the generalised force.  The others give the generalised force itself, and so do weights, whose sums are known.


def _uniform(load: loads.UniformGravity, place: Placement) -> Series:
    field = place.lower.vector(load.acceleration)
    total = place.algebra.zero
    for body in place.system.bodies:
        total = total + place.lower(body.mass) * dot(field, place.mass_centre(body))
    return total


def _newtonian(load: loads.NewtonianGravity, place: Placement) -> Series:
    if load.order == loads.EXACT:
        return _newtonian_exact(load, place)
    return _newtonian_quadratic(load, place) if load.order == 2 else _newtonian_in_size(load, place, int(load.order))


def _attracted(load: loads.NewtonianGravity, place: Placement) -> list[model.Body]:
    """The bodies that the frame ``about`` carries; the centre does not attract itself."""
    return [x for x in place.system.bodies if load.about in place.system.path(x.name) and x.name != load.centre]


def _from(start: str, end: Triple, place: Placement) -> Triple:
    return [a - b for a, b in zip(end, place.origin[start], strict=True)]


def _central_second_moments(body: model.Body, place: Placement) -> list[Triple] | None:
    """P = int x x^T dm = (tr J)/2 1 - J about the mass centre, in inertial axes."""
    tensor = place.inertia(body)
    if tensor is None:
        return None
    half_trace = place.algebra.number(Fraction(1, 2)) * (tensor[0][0] + tensor[1][1] + tensor[2][2])
    return [[half_trace - tensor[i][j] if i == j else -tensor[i][j] for j in range(3)] for i in range(3)]


def _newtonian_exact(load: loads.NewtonianGravity, place: Placement) -> Series:
    """U = nu sum of m/|r| + (1/2) P : grad grad 1/|r|, with P the second moments about the mass centre."""
    algebra = place.algebra
    total = algebra.zero
    for body in _attracted(load, place):
        r = _from(load.centre, place.mass_centre(body), place)
        inverse = algebra.reciprocal(algebra.square_root(dot(r, r)))
        total = total + place.lower(body.mass) * inverse
        moments = _central_second_moments(body, place)
        if moments is None:
            continue
        for i in range(3):
            for j in range(3):  # d^2/dx_i dx_j of 1/|r|
                curvature = algebra.number(3) * r[i] * r[j] * inverse * inverse
                curvature = curvature - algebra.one if i == j else curvature
                cube = inverse * inverse * inverse
                total = total + algebra.number(Fraction(1, 2)) * moments[i][j] * curvature * cube
    return place.lower(load.constant) * total


def _newtonian_in_size(load: loads.NewtonianGravity, place: Placement, order: int) -> Series:
    """The exact field of bodies s times as large, r = p + s x, P s^2: Taylor polynomial in s to the order, at s = 1.

    |r|^-1 is the binomial series in u = |r|^2/|p|^2 - 1; everything else is products of polynomials in s.
    """
    algebra = place.algebra
    p = _from(load.centre, place.origin[load.about], place)
    square = dot(p, p)
    inverse_square = algebra.reciprocal(square)
    inverse = algebra.reciprocal(algebra.square_root(square))
    two, half = algebra.number(2), algebra.number(Fraction(1, 2))

    def product(a: list[Series], b: list[Series]) -> list[Series]:
        coefficients = [algebra.zero] * (order + 1)
        for i, first in enumerate(a):
            for j, second in enumerate(b[: order + 1 - i]):
                coefficients[i + j] = coefficients[i + j] + first * second
        return coefficients

    total = algebra.zero
    for body in _attracted(load, place):
        x = _from(load.about, place.mass_centre(body), place)
        u = [algebra.zero, two * inverse_square * dot(p, x), inverse_square * dot(x, x)]
        power, binomial, reciprocal = [inverse], Fraction(1), [algebra.zero] * (order + 1)
        for k in range(order + 1):
            for degree, term in enumerate(power):
                reciprocal[degree] = reciprocal[degree] + algebra.number(binomial) * term
            power, binomial = product(power, u), binomial * (Fraction(-1, 2) - k) / (k + 1)
        mass, moments = place.lower(body.mass), _central_second_moments(body, place)
        for part in reciprocal:
            total = total + mass * part
        if moments is None:
            continue
        cube = product(reciprocal, product(reciprocal, reciprocal))
        turned = [dot(row, p) for row in moments]
        quadratic = [dot(p, turned), two * dot(x, turned), dot(x, [dot(row, x) for row in moments])]
        fifth = product(cube, product(reciprocal, reciprocal))
        spread = moments[0][0] + moments[1][1] + moments[2][2]
        for along, across in zip(product(quadratic, fifth)[: order - 1], cube[: order - 1], strict=True):
            total = total + half * (algebra.number(3) * along - spread * across)
    return place.lower(load.constant) * total


def _newtonian_quadratic(load: loads.NewtonianGravity, place: Placement) -> Series:
    """U = nu sum of int (1/R - e.x/R^2 + (3 (e.x)^2 - x.x)/(2 R^3)) dm, x from the expansion point."""
    algebra = place.algebra
    outward = [a - b for a, b in zip(place.origin[load.about], place.origin[load.centre], strict=True)]
    distance = algebra.square_root(dot(outward, outward))
    inverse = algebra.reciprocal(distance)
    e = [inverse * x for x in outward]
    total = algebra.zero
    half, three = algebra.number(Fraction(1, 2)), algebra.number(3)
    for body in _attracted(load, place):
        mass = place.lower(body.mass)
        x = [a - b for a, b in zip(place.mass_centre(body), place.origin[load.about], strict=True)]
        second = [[mass * x[i] * x[j] for j in range(3)] for i in range(3)]
        tensor = place.inertia(body)
        if tensor is not None:
            trace = half * (tensor[0][0] + tensor[1][1] + tensor[2][2])
            for i in range(3):
                for j in range(3):
                    spread = trace - tensor[i][j] if i == j else -tensor[i][j]
                    second[i][j] = second[i][j] + spread
        along = dot(e, [dot(row, e) for row in second])
        quadrupole = half * (three * along - (second[0][0] + second[1][1] + second[2][2]))
        terms = mass * inverse - inverse * inverse * mass * dot(e, x) + inverse * inverse * inverse * quadrupole
        total = total + terms
    return place.lower(load.constant) * total


def _coordinate_spring(load: loads.CoordinateSpring, place: Placement) -> Series:
    stretch = place.lower.environment[load.coordinate] - place.lower(load.rest)
    return place.algebra.number(Fraction(-1, 2)) * place.lower(load.stiffness) * stretch * stretch


def _point_spring(load: loads.PointSpring, place: Placement) -> Series:
    algebra = place.algebra
    ends = [place.point(end.body, place.lower.vector(end.position)) for end in (load.first, load.second)]
    span = [a - b for a, b in zip(*ends, strict=True)]
    square, length = dot(span, span), place.lower(load.length)
    energy = square
    if not algebra.vanishes(length):
        energy = square - algebra.number(2) * length * algebra.square_root(square) + length * length
    return algebra.number(Fraction(-1, 2)) * place.lower(load.stiffness) * energy


def _force_function(load: loads.ForceFunction, place: Placement) -> Series:
    value = place.lower(load.expression)
    return -value if load.spelled == "potential" else value


_FORCE_FUNCTIONS: dict[type, Any] = {
    loads.UniformGravity: _uniform,
    loads.NewtonianGravity: _newtonian,
    loads.CoordinateSpring: _coordinate_spring,
    loads.PointSpring: _point_spring,
    loads.ForceFunction: _force_function,
}


def _weight(oracle: Oracle, load: loads.UniformGravity, name: str) -> Scalar:
    return oracle.displaced(name).work(oracle.weights(load))


def _coordinate_damper(oracle: Oracle, load: loads.CoordinateDamper, name: str) -> Scalar:
    if name != load.coordinate:
        return oracle.numbers.zero
    return -(oracle.moving.lower(load.coefficient).a * oracle.state.values[velocity_name(name)])


def _point_damper(oracle: Oracle, load: loads.PointDamper, name: str) -> Scalar:
    """-c d' dd'/dq', where the rate of the distance d' = (r . r')/d has dd'/dq' = dd/dq = (r . dr/dq)/d."""
    apart, closing, shift = _ends_apart(oracle, load, name)
    square = oracle.numbers.reciprocal(dot(apart, apart))
    return -(oracle.moving.lower(load.coefficient).a * dot(apart, closing) * dot(apart, shift) * square)


def _isotropic_damper(oracle: Oracle, load: loads.IsotropicDamper, name: str) -> Scalar:
    """-c r' . dr/dq with r the vector between the points."""
    _, closing, shift = _ends_apart(oracle, load, name)
    return -(oracle.moving.lower(load.coefficient).a * dot(closing, shift))


def _ends_apart(
    oracle: Oracle, load: loads.PointDamper | loads.IsotropicDamper, name: str
) -> tuple[list[Scalar], list[Scalar], list[Scalar]]:
    """r = r_first - r_second, its rate, and its derivative by a coordinate, in inertial axes."""
    places, velocities, shifts = [], [], []
    for end in (load.first, load.second):
        point = oracle.moving.lower.vector(end.position)
        path = oracle.moving.point(end.body, point)
        places.append([x.a for x in path])
        velocities.append([x.b for x in path])
        shifts.append(oracle.along(name, end.body, [x.a for x in point]))
    apart = [a - b for a, b in zip(*places, strict=True)]
    closing = [a - b for a, b in zip(*velocities, strict=True)]
    shift = [a - b for a, b in zip(*shifts, strict=True)]
    return apart, closing, shift


def _rayleigh(oracle: Oracle, load: loads.Rayleigh, name: str) -> Scalar:
    environment = oracle._constants()
    zero, one = oracle.numbers.zero, oracle.numbers.one
    environment[velocity_name(name)] = Series(oracle.state.values[velocity_name(name)], one, zero)
    return -Lowering(TaylorSeries(oracle.numbers, environment), environment)(load.expression).b


def _generalized(oracle: Oracle, load: loads.GeneralizedForce, name: str) -> Scalar:
    total = oracle.numbers.zero
    for coordinate, value in load.components:
        if coordinate == name:
            total = total + oracle.moving.lower(value).a
    return total


def _point_force(oracle: Oracle, load: loads.PointForce, name: str) -> Scalar:
    force = oracle.in_inertial_axes(load.axes, load.components)
    return dot(force, oracle.along(name, load.point.body, oracle.numbers_of(load.point.position)))


def _torque(oracle: Oracle, load: loads.Torque, name: str) -> Scalar:
    torque = oracle.in_inertial_axes(load.axes, load.components)
    place = oracle.displaced(name)
    turned = place.spin(load.body)[0] if load.body != INERTIAL else [oracle.numbers.zero] * 3
    if load.reaction_on is not None and load.reaction_on != INERTIAL:
        turned = [a - b for a, b in zip(turned, place.spin(load.reaction_on)[0], strict=True)]
    return dot(torque, turned)


_GENERALIZED_FORCES: dict[type, Any] = {
    loads.UniformGravity: _weight,
    loads.CoordinateDamper: _coordinate_damper,
    loads.PointDamper: _point_damper,
    loads.IsotropicDamper: _isotropic_damper,
    loads.Rayleigh: _rayleigh,
    loads.GeneralizedForce: _generalized,
    loads.PointForce: _point_force,
    loads.Torque: _torque,
}
