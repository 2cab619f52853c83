"""An initial state given in the variables that a description declares: (s, u), and the coordinates that belong to it.

    e -> R (``mechanics.quaternions``) or unit vectors as its columns;  R -> three angles of the joint;
    S(q) q' = u - s0    for the generalised velocities

in balls of many bits.  Where S is singular (the pole of three angles) no generalised velocities belong to the state:
a run in declared variables begins there all the same.  What is given twice has to agree.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import arb, arb_mat, ctx

from mbsym.algebra.derivative import jacobian
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.matrices import dot
from mbsym.algebra.point import Balls
from mbsym.algebra.program import Program
from mbsym.algebra.rationals import ball
from mbsym.expressions.tree import Name
from mbsym.mechanics import frames as quaternions
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import ring_of
from mbsym.model.speeds import Quaternion
from mbsym.model.system import Body, System, velocity_name
from mbsym.numerics.kernels.interface import Code
from mbsym.numerics.kernels.precise import enclosures

#: How far a norm may be from 1, or two values given for one thing apart.
AGREEMENT = Fraction(1, 10**9)

BITS = 320


@dataclass(frozen=True)
class DeclaredStart:
    """``state`` is (s, u); ``positions`` and ``velocities`` of all coordinates, None where angles are ``singular``.

    ``missing`` are names without a value; ``wrong`` (name, sentence) of what cannot be; ``unstated`` velocities that
    were left out and do not follow from speeds.
    """

    state: tuple[arb, ...] = ()
    positions: tuple[arb, ...] = ()
    velocities: tuple[arb, ...] | None = None
    missing: tuple[str, ...] = ()
    wrong: tuple[tuple[str, str], ...] = ()
    unstated: tuple[str, ...] = ()


def declared_start(
    system: System,
    own: Mapping[str, Fraction],
    positions: Mapping[str, Fraction | None],
    velocities: Mapping[str, Fraction | None],
    numbers: Mapping[str, Fraction],
) -> DeclaredStart:
    """The initial state from ``own``, values of declared variables, and what is given of coordinates (None: nothing).

    ``numbers``: of parameters and of what is prescribed.  Raises Failure where the speeds have no closed form.
    """
    with ctx.workprec(BITS):
        return _Start(system, own, positions, velocities, numbers).found()


class _Start:
    def __init__(
        self,
        system: System,
        own: Mapping[str, Fraction],
        positions: Mapping[str, Fraction | None],
        velocities: Mapping[str, Fraction | None],
        numbers: Mapping[str, Fraction],
    ) -> None:
        self.system, self.form = system, SpeedForm(system, ring_of(system))
        self.own = {name: ball(value) for name, value in own.items()}
        self.positions = {name: None if x is None else ball(x) for name, x in positions.items()}
        self.velocities = {name: None if x is None else ball(x) for name, x in velocities.items()}
        self.numbers = {name: ball(value) for name, value in numbers.items()} | {"pi": arb.pi(), "t": arb(0)}
        self.missing: list[str] = []
        self.wrong: list[tuple[str, str]] = []
        #: The components of quaternions and unit vectors by name.
        self.oriented: dict[str, arb] = {}
        #: Coordinates of bodies whose orientation is given otherwise.
        self.told: set[str] = set()

    def found(self) -> DeclaredStart:
        for body in self.form.oriented:
            self._orientation(body)
        lacking = [name for name, x in self.positions.items() if x is None and name not in self.told]
        self.missing += [f"{name} (its initial position)" for name in lacking]
        speeds = {speed.name for speed in self.system.speeds}
        declared = speeds & self.own.keys()
        if declared:
            self.missing += [f"{name} (its initial value)" for name in sorted(speeds - declared)]
        if self.missing or self.wrong:
            return DeclaredStart(missing=tuple(self.missing), wrong=tuple(self.wrong))
        q = {name: x for name, x in self.positions.items() if x is not None}
        u, rates = self._speeds(q, bool(declared))
        if declared and not self._determined(q):
            names = ", ".join(sorted(declared))
            text = f"in the initial state the velocities of coordinates do not follow from {names}"
            self.wrong.append((min(declared), f"{text}: choose other speeds, or other axes of 'rotation'"))
        if self.wrong:
            return DeclaredStart(wrong=tuple(self.wrong))
        s = [self._position(x.name, q) for x in self.form.positions]
        left = [velocity_name(name) for name, x in self.velocities.items() if x is None]
        own = {u.name for u in self.form.speeds}
        unstated = tuple(name for name in left if not declared or name in own)
        return DeclaredStart((*s, *u), tuple(q[name] for name in self.system.coordinates), rates, unstated=unstated)

    def _position(self, name: str, q: Mapping[str, arb]) -> arb:
        return self.oriented[name] if name in self.oriented else q[name]

    # --- orientations ------------------------------------------------------------------------------------------------

    def _orientation(self, body: Body) -> None:
        """Direction cosines of a body told by its own variables, and the angles that make them."""
        named = [name for vector in body.orientation for name in vector.components]
        declared = [name for name in named if name in self.own]
        if not declared:
            self._from_angles(body)
            return
        self.told |= {*body.own_angles}
        lacking = [name for name in named if name not in self.own]
        if lacking:
            self.missing += [f"{name} (its initial value)" for name in lacking]
            return
        rows = self._matrix(body)
        if rows is None:
            return
        angles = self._angles(body, rows)
        own = [angle.name for _, angle in body.rotation.turns() if isinstance(angle, Name)]
        if angles is None or len(own) != 3:
            self.wrong.append((declared[0], f"the angles of {body.name} are not three coordinates: give these"))
            return
        stated = [name for name in own if self.positions[name] is not None]
        if stated:
            other = _of_angles(body, [self.positions[name] or arb(0) for name in own])
            gap = max(abs(a - b) for x, y in zip(rows, other, strict=True) for a, b in zip(x, y, strict=True))
            if len(stated) < 3 or not gap < ball(AGREEMENT):
                by = f"{', '.join(stated)} and by {', '.join(declared)}"
                text = f"the orientation of {body.name} is given twice: by {by}"
                self.wrong.append((stated[0], f"{text}, and these differ" if len(stated) == 3 else text))
            return
        self.positions |= dict(zip(own, angles, strict=True))

    def _from_angles(self, body: Body) -> None:
        """The components where the angles are given."""
        if any(self.positions[name] is None for name in body.own_angles):
            return  # said where positions are missing
        values = self.numbers | {name: x for name, x in self.positions.items() if x is not None}
        first = body.orientation[0]
        if isinstance(first, Quaternion):
            self.oriented |= self.form.quaternion_of_angles(body, Balls(values), values)
            return
        program = Program()
        nodes = self.form.variables_in_coordinates(program)
        components = [name for vector in body.orientation for name in vector.components]
        inputs = values | {velocity_name(name): arb(0) for name in self.system.coordinates}
        code = Code(program, tuple(inputs), tuple(nodes[name] for name in components))
        self.oriented |= dict(zip(components, enclosures(code, tuple(inputs.values()), BITS), strict=True))

    def _matrix(self, body: Body) -> list[list[arb]] | None:
        """R^jk of what is given, exactly orthonormal; None where it is none."""
        first = body.orientation[0]
        vectors = [[self.own[name] for name in orientation.components] for orientation in body.orientation]
        for i, vector in enumerate(vectors):
            for other in vectors[i:]:
                product = dot(vector, other)
                expected = 1 if other is vector else 0
                if not abs(product - expected) < ball(AGREEMENT):
                    name = body.orientation[i].name
                    what = "the norm squared" if other is vector else "a product with another unit vector"
                    text = f"{what} of {name} is {float(product.mid()):.12g} and has to be {expected}"
                    self.wrong.append((body.orientation[i].components[0], text))
                    return None
        for i, vector in enumerate(vectors):  # Gram and Schmidt: what is left are roundings
            for other in vectors[:i]:
                along = dot(vector, other)
                vector = [a - along * b for a, b in zip(vector, other, strict=True)]
            length = dot(vector, vector).sqrt()
            vectors[i] = [a / length for a in vector]
            self.oriented |= dict(zip(body.orientation[i].components, vectors[i], strict=True))
        if isinstance(first, Quaternion):
            return quaternions.cosines(Balls({}), vectors[0])
        if _determinant(vectors) < 0:
            self.wrong.append((body.orientation[0].components[0], f"the unit vectors of {body.name} are left-handed"))
            return None
        return [[vector[i] for vector in vectors] for i in range(3)]

    def _angles(self, body: Body, rows: Sequence[Sequence[arb]]) -> list[arb] | None:
        """Three angles with these direction cosines; None where the joint has not three turns by names."""
        turns = list(body.rotation.turns())
        if len(turns) != 3 or not all(isinstance(angle, Name) for _, angle in turns):
            return None
        i, j, last = (axis - 1 for axis, _ in turns)
        a = [[rows[c][r] for c in range(3)] for r in range(3)]  # from body axes to those of the frame
        k = 3 - i - j
        sign = 1 if (j - i) % 3 == 1 else -1
        if last == i:
            middle = arb.acos(_within(a[i][i]))
            return [arb.atan2(a[j][i], -sign * a[k][i]), middle, arb.atan2(a[i][j], sign * a[i][k])]
        middle = arb.asin(_within(sign * a[i][k]))
        return [arb.atan2(-sign * a[j][k], a[k][k]), middle, arb.atan2(-sign * a[i][j], a[i][i])]

    def _determined(self, q: Mapping[str, arb]) -> bool:
        """Whether the speeds determine the velocities that they replace."""
        values = self.numbers | dict(q) | self.oriented
        return bool(abs(Carrier(self.form.ring, Balls(values), values)(self.form.determinant)) > arb(2) ** -200)

    # --- speeds ------------------------------------------------------------------------------------------------------

    def _speeds(self, q: Mapping[str, arb], has_speeds: bool) -> tuple[list[arb], tuple[arb, ...] | None]:
        """u, and q' of all coordinates; None where they do not follow from u."""
        system, form, program = self.system, self.form, Program()
        names = [velocity_name(name) for name in system.coordinates]
        known = self._nodes(program)
        slopes = jacobian(program, known, [program.input(name) for name in names])
        stated = {velocity_name(name): x if x is not None else arb(0) for name, x in self.velocities.items()}
        values = self.numbers | dict(q) | stated
        code = Code(program, tuple(values), (*known, *(x for row in slopes for x in row)))
        whole = enclosures(code, tuple(values.values()), BITS)
        n = len(known)
        own, matrix = whole[:n], [whole[n + r * n : n + (r + 1) * n] for r in range(n)]
        if not has_speeds:
            return own, tuple(stated[name] for name in names)
        speeds = [self.own.get(u.name, stated.get(u.name, arb(0))) for u in form.speeds]
        still = [
            x - sum((s * stated[v] for s, v in zip(row, names, strict=True)), arb(0))
            for x, row in zip(own, matrix, strict=True)
        ]
        stretched = [u - x for u, x in zip(speeds, still, strict=True)]
        named = [name for name, x in self.velocities.items() if x is not None]
        if named and len(named) == n:
            least, near = (
                ball(AGREEMENT),
                zip(own, speeds, _products(matrix, [stated[v] for v in names], still), strict=True),
            )
            if not all(a.overlaps(b) or abs(a - b) < least * (abs(b) + size) for a, b, size in near):
                text = "the initial velocities are given twice, by coordinates and by speeds, and these differ"
                self.wrong.append((velocity_name(named[0]), text))
            return speeds, tuple(stated[name] for name in names)
        both = [name for name in named if velocity_name(name) not in {u.name for u in form.speeds}]
        if both:
            text = f"the initial velocity of {both[0]} follows from the speeds: give one or the other"
            self.wrong.append((velocity_name(both[0]), text))
            return speeds, None
        try:
            inverse = arb_mat(matrix).inv().tolist()
        except ZeroDivisionError:
            return speeds, None
        rates = tuple(sum((a * b for a, b in zip(row, stretched, strict=True)), arb(0)) for row in inverse)
        sizes = _products(inverse, stretched, [arb(0)] * n)
        narrow = all(x.rad() <= arb(2) ** -200 * size for x, size in zip(rates, sizes, strict=True))
        return speeds, rates if narrow else None

    def _nodes(self, program: Program) -> list[Any]:
        """u in (q, q', t), in the order of the speeds."""
        n = len(self.form.positions)
        return self.form.state_in_coordinates(program)[n:]


def _products(matrix: Sequence[Sequence[arb]], vector: Sequence[arb], rest: Sequence[arb]) -> list[arb]:
    """|A| |x| + |b|: by what A x + b is measured, whatever the units."""
    rows = (zip(row, vector, strict=True) for row in matrix)
    return [abs(b) + sum((abs(a * x) for a, x in row), arb(0)) for row, b in zip(rows, rest, strict=True)]


def _within(x: arb) -> arb:
    """A sine or cosine whose ball may hold a little more than what there is."""
    return arb(1) if x.mid() > 1 else arb(-1) if x.mid() < -1 else arb(x.mid()) if not abs(x) <= 1 else x


def _determinant(rows: Sequence[Sequence[arb]]) -> arb:
    return arb_mat([list(row) for row in rows]).det()


def _of_angles(body: Body, angles: Sequence[arb]) -> list[list[arb]]:
    """R^jk of the angles of a joint with turns by names."""
    of_angles = [[arb(int(i == j)) for j in range(3)] for i in range(3)]
    for (axis, _), angle in zip(body.rotation.turns(), angles, strict=True):
        i, j = axis % 3, (axis + 1) % 3
        s, c = angle.sin(), angle.cos()
        of_angles[i], of_angles[j] = (
            [c * a + s * b for a, b in zip(of_angles[i], of_angles[j], strict=True)],
            [c * b - s * a for a, b in zip(of_angles[i], of_angles[j], strict=True)],
        )
    return of_angles
