"""Problem 5: equations of perturbed motion in the first approximation,

    M x'' + (D + G) x' + (K + N) x = B v

with M and D symmetric, G skew (gyroscopic), K symmetric (potential), N skew (circulatory); v are the deviations of the
inputs from the values at which they are held, B = dQ/du (0 on the right where the system has no inputs).  Two routes:

1. the residuals M q'' - f of the equations are expanded to first order while they are built, about q0(t), by a
   recursion over truncated polynomials in the deviations, so that the nonlinear equations are never formed; constraints
   are expanded beside them (``mbsym.problems.reduction``).  The acceleration of a prescribed motion, and that of q0(t),
   enter through the bodies' accelerations: a lift gives K = m l (g + a) through it;
2. the nonlinear equations M(q) q'' = f, where they are derived, are differentiated on the motion: C = -df0/dq',
   S = -df0/dq, B = df0/du with f0 = f - M q0''.

Of C the symmetric part is D and the skew part G, of S these are K and N.

Subsystems are the connected components of the coordinates under all five matrices.  With a time scale w the time is
tau = w t: M stays, D and G are divided by w, K and N by w^2.

Source: Banshchikov & Vetrov, Problem 5 and eq. (3).

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> print(pendulum.linearisation.M, pendulum.linearisation.D, pendulum.linearisation.K)
    [[m*l**2 + J]] [[b]] [[m*l*g]]
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from mbsym.algebra.elimination import Definition, combination
from mbsym.algebra.matrices import ScalarMatrix, skew, symmetric
from mbsym.algebra.matrices import components as connected
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined
from mbsym.formulas.formula import Column, Formula, Matrix, Shown, column
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.motion import (
    relations,
    steadied,
    unperturbed,
    unsteady,
)
from mbsym.problems.equations import Equations
from mbsym.problems.equilibrium import Equilibrium


@dataclass(frozen=True, repr=False)
class Subsystem(Shown):
    """A set of coordinates that move by themselves; matrices in dimensionless time and the user's notation."""

    coordinates: tuple[str, ...]
    M: Matrix
    D: Matrix
    G: Matrix
    K: Matrix
    N: Matrix


#: How many varying coefficients a message names, and of how many terms those are whose values it tells.
MOST_NAMED, SHORT = 4, 4


@dataclass(frozen=True)
class Varying:
    """An entry of M, D, G, K or N (row <= column) that is not constant: it varies with the quantities ``among``."""

    matrix: str
    row: str
    column: str
    value: Formula
    among: tuple[str, ...]

    @property
    def named(self) -> Message:
        """``K[theta, theta] = m*l*g*cos(chi)``, without the value where that is long."""
        name = f"{self.matrix}[{self.row}, {self.column}]"
        if self.value.terms > SHORT:
            return Message("[[entry]]", entry=name)
        return Message("[[entry]] = [[value]]", entry=name, value=self.value)


@dataclass(frozen=True, repr=False)
class Reduction(Shown):
    """Which quantities the first approximation is about; without constraints all coordinates are independent.

    ``coordinates`` and ``speeds`` are the independent ones, ``dependent_coordinates`` and ``dependent_speeds`` the
    others; ``idle`` are independent coordinates that no equation of the speeds depends on, ``following`` those that are
    felt although their velocities are dependent.  ``rates`` are velocities of the motion that follow from the
    constraints, ``assumed`` polynomials that must not vanish.  ``holonomic``: every constraint is one between
    coordinates, as it is given.  ``family``: the derivatives of the coordinate, and of its velocity, by the parameters
    that stand in the motion only, of every speed and then of all that follow: by these the description gives a family
    of motions.  ``leaf``: how many relations between coordinates the velocity constraints keep, all of them proved to
    be integrable, so that the first approximation is that on the leaf of the motion; 0 where they are not.
    """

    coordinates: tuple[str, ...]
    speeds: tuple[str, ...]
    dependent_coordinates: tuple[str, ...] = ()
    dependent_speeds: tuple[str, ...] = ()
    idle: tuple[str, ...] = ()
    rates: tuple[tuple[str, Formula], ...] = ()
    assumed: tuple[Formula, ...] = ()
    holonomic: bool = True
    family: tuple[tuple[tuple[Formula, ...], tuple[Formula, ...]], ...] = ()
    following: tuple[str, ...] = ()
    leaf: int = 0

    @property
    def about(self) -> tuple[str, ...]:
        """The coordinates of the first approximation: those of the speeds, then those that follow."""
        return (*self.speeds, *self.following)

    @property
    def ties(self) -> bool:
        """Whether velocities depend on others, by constraints."""
        return bool(self.dependent_speeds)

    @property
    def rates_by_name(self) -> dict[str, Polynomial]:
        """``rates`` as a mapping."""
        return {name: rate.polynomial for name, rate in self.rates}


@dataclass(frozen=True, repr=False)
class Linearisation(Shown):
    """Matrices n x n in physical time and declared parameters; ``subsystems`` as a paper prints them.

    ``time_scale`` is w of tau = w t, or None.  ``route`` names the way the matrices were obtained.  ``varying`` lists
    the coefficients that are not constant: with any of them the first approximation is time-dependent, and no theorem
    about constant coefficients (Lagrange, Kelvin-Chetaev, eigenvalues) says anything about it.

    ``B`` (n x m, in physical time) belongs to the m ``inputs``; None where there are none.  Of a constrained system the
    ``coordinates`` are the independent ones; ``about`` says what became of the others.
    """

    counted = ("matrices", "B")

    about: Reduction
    M: Matrix
    D: Matrix
    G: Matrix
    K: Matrix
    N: Matrix
    time_scale: Formula | None
    subsystems: tuple[Subsystem, ...]
    route: str
    varying: tuple[Varying, ...] = ()
    inputs: tuple[str, ...] = ()
    B: Matrix | None = None

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Those of the rows and columns."""
        return self.about.about

    @property
    def matrices(self) -> tuple[Matrix, Matrix, Matrix, Matrix, Matrix]:
        return self.M, self.D, self.G, self.K, self.N

    @property
    def equalities(self) -> Column:
        """(M q'' + (D + G) q' + (K + N) q - B v)_i, which vanish; deviations go by the names of what deviates."""
        ring = self.M.rows[0][0].ring
        rates = (("acceleration", (self.M,)), ("velocity", (self.D, self.G)), ("coordinate", (self.K, self.N)))
        terms = [(matrix, self.coordinates, kind, 1) for kind, matrices in rates for matrix in matrices]
        terms += [] if self.B is None else [(self.B, self.inputs, "prescribed", -1)]
        residuals = [ring.zero for _ in self.coordinates]
        for matrix, names, kind, sign in terms:
            moving = [ring.generator(kind, name) * sign for name in names]
            for i, row in enumerate(matrix):
                residuals[i] += sum((ring.times(x.polynomial, y) for x, y in zip(row, moving, strict=True)), ring.zero)
        return column(ring, list(map(ring.reduce, residuals)))

    @property
    def time_dependence(self) -> str:
        """Which coefficients vary with which quantity, in words; "" where all are constant."""
        if not self.varying:
            return ""
        among = ", ".join(dict.fromkeys(name for entry in self.varying for name in entry.among))
        entries = [entry.named for entry in self.varying[:MOST_NAMED]]
        if len(self.varying) > MOST_NAMED:
            entries.append(Message("[[count]] more", count=len(self.varying) - MOST_NAMED))
        return Message(
            "the first approximation is time-dependent, its coefficients vary with [[among]] "
            "([[entries]]); no theorem about constant coefficients applies",
            among=among,
            entries=joined(entries, ", "),
        )


def by_equations(scene: Scene, equations: Equations, equilibrium: Equilibrium | None) -> Linearisation:
    """Route 2: differentiates the nonlinear equations on the unperturbed motion.

    Raises NoClosedForm or SingularPoint.
    """
    ring, names = scene.ring, scene.system.coordinates
    at, inputs = unperturbed(scene), scene.system.input_names
    f = with_inertia(scene, equations)

    def on_motion(rows: Sequence[Sequence[Polynomial]]) -> ScalarMatrix[Polynomial]:
        return ScalarMatrix(ring, rows).map(lambda x: ring.substitute(x, at))

    M = on_motion(equations.mass_matrix.polynomials)
    C = -on_motion([[ring.velocity_derivative(x, name) for name in names] for x in f])
    S = -on_motion([[ring.derivative(x, name) for name in names] for x in f])
    B = on_motion([[ring.derivative(x, name) for name in inputs] for x in f])
    return assemble(scene, equilibrium, (M, C, S, B), "linearised equations", inputs)


def with_inertia(scene: Scene, equations: Equations) -> list[Polynomial]:
    """f - M q0'': what vanishes on an unperturbed motion q0(t); f where that turns steadily or rests."""
    ring, at = scene.ring, unperturbed(scene)
    accelerations = [at[ring.index("acceleration", name)] for name in scene.system.coordinates]
    return [
        x.polynomial - sum(map(ring.times, row, accelerations), ring.zero)
        for x, row in zip(equations.forcing, equations.mass_matrix.polynomials, strict=True)
    ]


def assemble(
    scene: Scene,
    equilibrium: Equilibrium | None,
    whole: tuple[ScalarMatrix[Polynomial], ...],
    route: str,
    inputs: tuple[str, ...],
    about: Reduction | None = None,
) -> Linearisation:
    """The matrices of  M x'' + C x' + S x = B u  made a result: ``whole`` is M, C, S, B, by ``about.about``.

    Relations and conditions of existence are used, then C and S are split into symmetric and skew parts.
    """
    ring = scene.ring
    images = relations(scene) if equilibrium is None else equilibrium.determined(scene)
    M, C, S, B = (matrix.map(lambda x: steadied(scene, ring.substitute(x, images))) for matrix in whole)
    scale = None
    if scene.system.time_scale is not None:
        scale = Formula(ring, ring.substitute(scene.lower(scene.system.time_scale), images))
    result = Linearisation(
        about=about or Reduction(scene.system.coordinates, scene.system.coordinates),
        M=Matrix.of(ring, M.rows),
        D=Matrix.of(ring, symmetric(C).rows),
        G=Matrix.of(ring, skew(C).rows),
        K=Matrix.of(ring, symmetric(S).rows),
        N=Matrix.of(ring, skew(S).rows),
        time_scale=scale,
        subsystems=(),
        route=route,
        inputs=inputs,
        B=Matrix.of(ring, B.rows) if inputs else None,
    )
    return replace(result, subsystems=_subsystems(scene, result), varying=_varying(scene, result))


def _varying(scene: Scene, whole: Linearisation) -> tuple[Varying, ...]:
    names = whole.coordinates
    return tuple(
        Varying(label, names[i], names[j], matrix[i, j], among)
        for label, matrix in zip("MDGKN", whole.matrices, strict=True)
        for i in range(len(names))
        for j in range(i, len(names))
        if (among := unsteady(scene, matrix[i, j].polynomial))
    )


# --- subsystems ---


def components(matrices: Sequence[Matrix]) -> list[list[int]]:
    """Connected components of the indices, coupled where any matrix has an entry that is not zero."""

    def coupled(i: int, j: int) -> bool:
        return any(not matrix[i, j].is_zero or not matrix[j, i].is_zero for matrix in matrices)

    return connected(matrices[0].shape[0], coupled)


def _subsystems(scene: Scene, whole: Linearisation) -> tuple[Subsystem, ...]:
    order = [*scene.system.order, *whole.coordinates]
    rank = [order.index(name) for name in whole.coordinates]
    groups = [sorted(indices, key=rank.__getitem__) for indices in components(whole.matrices)]
    return tuple(_subsystem(scene, whole, indices) for indices in sorted(groups, key=lambda group: rank[group[0]]))


def _subsystem(scene: Scene, whole: Linearisation, indices: list[int]) -> Subsystem:
    ring = scene.ring
    inverse = ring.one if whole.time_scale is None else ring.reciprocal(whole.time_scale.polynomial)
    factors = (ring.one, inverse, inverse, inverse**2, inverse**2)
    symbols = first_symbols(scene)
    cut = []
    for matrix, factor in zip(whole.matrices, factors, strict=True):
        rows = [[ring.reduce(matrix[i, j].polynomial * factor) for j in indices] for i in indices]
        cut.append(Matrix.of(ring, [[in_notation(ring, x, symbols) for x in row] for row in rows]))
    return Subsystem(tuple(whole.coordinates[i] for i in indices), *cut)


def first_symbols(scene: Scene) -> list[Definition]:
    """The user's symbols that stand directly for parameters, with relations used: a, b, c, d, f of the paper."""
    ring, images = scene.ring, relations(scene)
    own = {ring.index("parameter", item.name) for item in scene.system.notation}
    expanded: dict[int, Polynomial] = {}
    definitions: list[Definition] = []
    for item in scene.system.notation:
        value = scene.lower(item.value)
        index = ring.index("parameter", item.name)
        direct = any(degree > 0 and k not in own for k, degree in enumerate(value.degrees()) if k >= ring.spare)
        expanded[index] = ring.substitute(value, expanded | images)
        if direct and not any(d > 0 for d in expanded[index].degrees()[: ring.spare]):
            definitions.append((index, expanded[index]))
    return definitions


def in_notation(ring: Ring, x: Polynomial, symbols: Sequence[Definition]) -> Polynomial:
    """x in the user's symbols where it is a combination of them, else as it was."""
    rewritten = combination(ring, x, symbols) if symbols else None
    return x if rewritten is None else rewritten
