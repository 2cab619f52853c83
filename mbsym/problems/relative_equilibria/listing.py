"""Places of rest as entries of a list: their coordinates as text, what tells configurations apart, their verdicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from flint import ctx, fmpq, fmpq_poly

from mbsym.algebra import rationals
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, message_of
from mbsym.algebra.point import Arrays
from mbsym.algebra.polynomial_systems import Limits
from mbsym.algebra.program import Program
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message, joined
from mbsym.expressions.tree import Expression
from mbsym.mechanics.charts import Chart
from mbsym.mechanics.charts import features as direction_features
from mbsym.mechanics.states import SEED
from mbsym.mechanics.symmetry import Reflection, reflections
from mbsym.model.system import System
from mbsym.problems.relative_equilibria.conditions import Case, Conditions
from mbsym.problems.relative_equilibria.orbits import Orbits
from mbsym.problems.relative_equilibria.place import PRECISION, Place, exact_rates
from mbsym.problems.relative_equilibria.verdict import LinearAtRest, linear_at_rest
from mbsym.problems.stability.verdict import Verdict, undecided
from mbsym.problems.stability.words import Because, Reason, Word

#: Other values of coordinates that may have any, where their verdicts are compared: t, or 2 atan(t) of angles.
ELSEWHERE = (fmpq(1, 3), fmpq(-2), fmpq(7, 5))


@dataclass(frozen=True)
class Solution:
    """A solution in one chart; ``features`` are numbers that belong to the configuration, whatever the coordinates."""

    values: tuple[CoordinateValue, ...]
    features: tuple[Any, ...]
    proof: str
    place: Place
    chart: Listing
    free: tuple[str, ...]
    beyond: tuple[str, ...] = ()


def groups(candidates: Iterable[Solution]) -> list[list[Solution]]:
    """Candidates that mean one configuration: their features cannot be told apart at the working precision."""
    together: list[list[Solution]] = []
    table: dict[tuple[float, ...], list[list[Solution]]] = {}
    for candidate in candidates:
        # Rounded features only say where to look; overlapping balls decide.
        key = tuple(round(float(x.mid()), 6) + 0.0 for x in candidate.features)
        for group in table.get(key, []):
            if all(a.overlaps(b) for a, b in zip(group[0].features, candidate.features, strict=True)):
                group.append(candidate)
                break
        else:
            together.append([candidate])
            table.setdefault(key, []).append(together[-1])
    return together


class Listing(Conditions):
    """Solutions of one chart, as they are found."""

    def __init__(
        self,
        chart: Chart,
        within: float,
        limits: Limits,
        case: Case | None = None,
        rank: int | None = None,
        parameters: tuple[str, ...] = (),
    ) -> None:
        super().__init__(chart, within, limits, case, rank, parameters)
        self.points: list[Solution] = []
        self.families: list[EquilibriumFamily] = []
        self.family_equations: list[list[Polynomial]] = []
        self.family_places: list[Place] = []

    def _zero(self) -> Place:
        """The place where every coordinate is 0, exactly."""
        ring, zero, one = self.ring, fmpq_poly([0]), fmpq_poly([1])
        exact = {}
        for name in self.rest.constant:
            exact[ring.index("coordinate", name)] = zero
            if name in ring.angles:
                exact |= {ring.index("sine", name): zero, ring.index("cosine", name): one}
        return Place(self.rest, {}, exact | exact_rates(self.rest), fmpq_poly([0, 1]))

    def _may_rest(self, place: Place) -> bool:
        """Whether no equation is proved not to vanish there: the second route of every list in balls."""
        known = [x for x in self.equations if not self.ring.dependencies(x, self.rest.multipliers)]
        with ctx.workprec(PRECISION):
            return all(self.ring.evaluate(x, place.balls).contains(0) for x in known)

    def _same(self, place: Place, other: Place) -> bool:
        """Whether two places have coordinates that balls of PRECISION bits cannot tell apart."""
        ring = self.ring
        compared = [
            ring.generator(kind, name)
            for name in self.occurring
            for kind in (("sine", "cosine") if self._periodic(name) else ("coordinate",))
        ]
        return all(place.ball(x).overlaps(other.ball(x)) for x in compared)

    def _known(self, place: Sequence[float], tolerance: float) -> bool:
        """Whether a solution is listed already, within ``tolerance``."""
        return any(
            all(
                abs(turned(x - item.value, self.ring.angles[item.name]) if item.angle else x - item.value) < tolerance
                for x, item in zip(place, other.values, strict=True)
            )
            for other in self.points
        )

    def _add(self, place: Place, proof: str) -> None:
        self.points.append(self._candidate(place, proof))

    def _candidate(self, place: Place, proof: str) -> Solution:
        beyond = []
        for reflection in self._reflections:
            if place.balls[reflection.length] < 0 and reflection.same_forces:
                place = place.reflected(reflection.length, reflection.angle)
            elif place.balls[reflection.length] < 0:
                beyond.append(reflection.length)
        return Solution(self._values(place), self._features(place), proof, place, self, self.free, tuple(beyond))

    @cached_property
    def _reflections(self) -> tuple[Reflection, ...]:
        """Polar coordinates; none for the search of a family's points."""
        return () if self.rest.rows else reflections(self.rest)

    def _values(self, place: Place) -> tuple[CoordinateValue, ...]:
        return tuple(self._value(place, name) for name in self.occurring)

    def _value(self, place: Place, name: str) -> CoordinateValue:
        ring, ball = self.ring, place.balls[name]
        periodic = self._periodic(name)
        value = float(ball.mid())
        if not periodic:
            residue = place.residue(ring.generator("coordinate", name))
            if residue is not None and residue.degree() <= 0:
                exact = rationals.fraction(residue[0])
                text = str(exact)
                told = len(text) <= 14
                return CoordinateValue(name, text if told else short(value), value, False, told, place.exactly(name))
            return CoordinateValue(name, short(value), value, False, False, place.exactly(name))
        if proof_of := self._twelfths(place, name, value):
            return CoordinateValue(name, proof_of, value, True, True)
        value = turned(value, ring.angles[name])
        return CoordinateValue(name, short(value), value, True, False, place.exactly(name))

    def _twelfths(self, place: Place, name: str, value: float) -> str:
        """``k*pi/12`` if the angle is such a multiple, proved by (cos + i sin)^24 = 1 in the number field."""
        s, c = (place.residue(self.ring.generator(kind, name)) for kind in ("sine", "cosine"))
        if s is None or c is None or self.ring.angles[name] != 1:
            return ""
        real, imaginary = fmpq_poly([1]), fmpq_poly([0])
        for _ in range(24):
            real, imaginary = (real * c - imaginary * s) % place.modulus, (real * s + imaginary * c) % place.modulus
        if real != fmpq_poly([1]) or imaginary != fmpq_poly([0]):
            return ""
        part = Fraction(round(12 * value / math.pi), 12)
        if part == 0:
            return "0"
        top = {1: "pi", -1: "-pi"}.get(part.numerator, f"{part.numerator}*pi")
        return top if part.denominator == 1 else f"{top}/{part.denominator}"

    def _features(self, place: Place) -> tuple[Any, ...]:
        """Direction cosines of the joints that have other angles; sines, cosines or values of the other coordinates.

        Of three angles of which the first or the last may be any, those of its axis tell where the body is.
        """
        features, done = [], set(self.free)
        for joint in self.chart.joints:
            if len(joint.angles) == 3:
                first, last = joint.angles[0] in self.free, joint.angles[2] in self.free
                joint = replace(joint, first_free=joint.first_free or first, last_free=joint.last_free or last)
            cyclic = joint.angles[:1] * joint.first_free + joint.angles[2:] * joint.last_free
            if set(joint.angles) & set(self.free) - set(cyclic):
                continue
            features += [place.ball(x) for x in direction_features(self.rest, joint)]
            done |= set(joint.angles)
        for name in self.rest.constant:
            if name in done:
                continue
            if self._periodic(name):
                features += [place.ball(self.ring.generator(kind, name)) for kind in ("sine", "cosine")]
            else:
                features.append(place.balls[name])
        return tuple(features)

    # --- stability ---

    @cached_property
    def _linear(self) -> LinearAtRest | str:
        """The matrices as formulas, or why there are none."""
        try:
            return linear_at_rest(self.rest)
        except Failure as reason:
            return message_of(reason)

    def verdict(self, place: Place) -> Verdict:
        """The verdict of problem 6 at a place."""
        here, elsewhere = self.ranks
        if elsewhere is not None and here != elsewhere and not self.case.whole:
            return undecided(Because.RANK_LOST if here < elsewhere else Because.OTHER_BRANCH, here, elsewhere)
        if isinstance(self.rest, Orbits):
            return self.rest.first_approximation.verdict(place)
        if isinstance(self._linear, str):
            return undecided(Because.NO_EQUATIONS, self._linear)
        found = self._linear.verdict(place)
        ring, free = self.ring, self.free
        every = (x for rows in self._linear.matrices for row in rows for x in row)
        varying = tuple(dict.fromkeys(name for x in every for name in ring.dependencies(x, free)))
        if not varying or found.word is Word.UNDECIDED:
            return found
        # Any value of these is an equilibrium, but not the same first approximation.
        words = {self._linear.verdict(place.elsewhere(varying, t)).word for t in ELSEWHERE}
        return also_elsewhere(found, words, varying)


def also_elsewhere(found: Verdict, words: Set[Word], varying: Sequence[str]) -> Verdict:
    """The verdict at 0 of coordinates that may have any value, where these are the words at other values of them."""
    names = ", ".join(varying)
    if words != {found.word}:
        *others, last = sorted(words - {found.word})
        alternatives = Message("[[first]] or [[last]]", first=joined(others, ", "), last=last) if others else last
        return undecided(Because.DIFFERS_ALONG, names, found.word, alternatives)
    return replace(found, reasons=(*found.reasons, Reason(Because.ALSO_ELSEWHERE, (names,))))


def short(value: float) -> str:
    return f"{value + 0.0:.10g}" if abs(value) > 1e-15 else "0"


# What is told of relative equilibria: isolated ones, families, and how far the list is complete.


EXACT, CERTIFIED = "exact", "proved in a box"


@dataclass(frozen=True)
class CoordinateValue:
    """One coordinate at an equilibrium: ``text`` is exact if ``exact`` (``pi/2``, ``5/4``), else rounded.

    ``angle``: it occurs under sine and cosine only, so it is meant modulo a full turn.  ``exactly``: the value as an
    expression, where ``text`` is rounded and it is known.
    """

    name: str
    text: str
    value: float
    angle: bool
    exact: bool
    exactly: Expression | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class RelativeEquilibrium:
    """One isolated relative equilibrium.

    ``proof``: exact (f vanishes in a number field), or proved in a box.  ``coordinates_of``: which joints have other
    angles than the description's, because those are singular here (empty: none).  ``free``: coordinates that do not
    occur in f, so that every value of them does.  ``described``: how many sets of coordinates mean this configuration.
    ``beyond``: the negative lengths of polar coordinates, behind their singularity.  ``enclosures``: balls that hold
    the coordinates; ``system``: at numbers, in the angles of ``coordinates_of``.
    """

    values: tuple[CoordinateValue, ...]
    proof: str
    verdict: Verdict
    coordinates_of: str = ""
    free: tuple[str, ...] = ()
    described: int = 1
    beyond: tuple[str, ...] = ()
    enclosures: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)
    system: System | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class EquilibriumFamily:
    """Relative equilibria that are not isolated: a real set of ``dimension``, all solutions of ``equations`` = 0.

    ``sample`` is one of them, in ``enclosures``, ``verdict`` the verdict there; ``free`` may be
    chosen near it; ``special`` if it is none that was met by chance.
    """

    dimension: int
    free: tuple[str, ...]
    equations: tuple[str, ...]
    sample: tuple[CoordinateValue, ...]
    verdict: Verdict
    coordinates_of: str = ""
    enclosures: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)
    system: System | None = field(default=None, compare=False, repr=False)
    special: bool = field(default=False, compare=False, repr=False)


@dataclass(frozen=True)
class Equilibria:
    """``complete``: nothing is missing; otherwise ``remarks`` say what was not done, and why.

    ``singular`` are solutions of f = 0 at which the mass matrix, and with it the coordinates, are singular: whether
    they are equilibria is undecided.  ``beyond`` are solutions in which a polar coordinate that is a length is negative
    and the forces are not those at the same places of the bodies with a positive length: no states of the system meant.
    ``turning`` are the coordinates that turn at the description's rates, ``charts`` how many sets of angles were used.
    ``everywhere``: every position that the constraints allow is one, so that none is listed.
    """

    equilibria: tuple[RelativeEquilibrium, ...]
    families: tuple[EquilibriumFamily, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: tuple[tuple[str, float], ...] = ()
    charts: int = 1
    singular: tuple[RelativeEquilibrium, ...] = ()
    beyond: tuple[RelativeEquilibrium, ...] = ()
    everywhere: bool = False


# Solutions of conditions of rest from many starting points: found, not proved, and perhaps not all.


#: Starting points of a search from many points.
STARTS = 400


def turned(value: float, denominator: int = 1) -> float:
    """The same angle in (-pi, pi]."""
    period = 2 * math.pi * denominator
    return value - period * math.ceil((value - period / 2) / period - 1e-12)


def from_many_points(
    ring: Ring,
    equations: Sequence[Polynomial],
    names: Sequence[str],
    bounds: Sequence[tuple[float, float]],
    linear: Sequence[str] = (),
    following: Sequence[str] = (),
) -> list[list[float]]:
    """Where damped Newton iterations from random points end, without repetition; found, not proved.

    ``linear``: further unknowns, in which the equations are linear and which begin at their least squares; so do before
    them those of ``names`` that are ``following``, in which the equations without the linear ones are.
    """
    import numpy as np

    source = np.random.default_rng(SEED)
    bounded, unknowns = len(names), (*names, *linear)
    n = len(unknowns)
    q = np.array([*(source.uniform(low, high, STARTS) for low, high in bounds), *np.zeros((len(linear), STARTS))])
    slopes = (ring.derivative(x, name) for x in equations for name in unknowns)
    value = _vectorised(ring, [*equations, *slopes], unknowns)
    rates = [k for k, name in enumerate(names) if name in following]
    stepping = [k for k in range(bounded) if k not in rates]
    q[rates] = 0
    tied = [k for k, x in enumerate(equations) if not any(ring.depends_on(x, name) for name in linear)]
    for rows, places in ((tied, rates), (range(n), range(bounded, n))):
        if not places:
            continue
        with np.errstate(all="ignore"):
            values = value(q)
        for at in np.flatnonzero(np.isfinite(values).all(axis=0)):
            columns = values[n:, at].reshape(n, n)[np.ix_(rows, places)]
            q[places, at] = -np.linalg.lstsq(columns, values[rows, at], rcond=None)[0]
    for _ in range(60):
        with np.errstate(all="ignore"):
            values = value(q)
        f, jacobian = values[:n], values[n:].reshape(n, n, -1)
        matrices = np.moveaxis(jacobian, 2, 0)
        usable = np.isfinite(matrices).all(axis=(1, 2)) & np.isfinite(f).all(axis=0)
        change = np.zeros_like(q)
        damping = 1e-14 * np.eye(n)
        normal = np.einsum("kji,kjl->kil", matrices[usable], matrices[usable])
        scale = np.trace(normal, axis1=1, axis2=2)[:, None, None] + 1e-300
        right = np.einsum("kji,jk->ki", matrices[usable], f[:, usable])
        change[:, usable] = -np.linalg.solve(normal + scale * damping, right[..., None])[..., 0].T
        length = np.sqrt((change[stepping] ** 2).sum(axis=0))
        q = q + change * np.minimum(1.0, 0.7 / np.maximum(length, 1e-300))
    ends: dict[tuple[float, ...], list[float]] = {}
    for k in range(STARTS):
        if usable[k] and length[k] < 1e-8:
            point = [float(x) for x in q[:, k]]
            for i, name in enumerate(names):
                if i in stepping and bounds[i][1] - bounds[i][0] > 2 * math.pi * ring.angles.get(name, 10**6):
                    point[i] = turned(point[i], ring.angles[name])
            ends.setdefault(tuple(round(x, 6) for x in point), point)
    return [ends[key] for key in sorted(ends)]


def _vectorised(ring: Ring, polynomials: Sequence[Polynomial], names: Sequence[str]) -> Callable[[Any], Any]:
    """Values of polynomials at many points at once, by a straight-line program; what has no value there is 0."""
    import numpy as np

    program = Program()
    carry = Carrier(ring, program, {name: program.input(name) for name in (*ring.names(), "pi")})
    outputs = [carry(x) for x in polynomials]

    def values(q: Any) -> Any:
        inputs = dict.fromkeys(ring.names(), 0.0) | {"pi": math.pi} | dict(zip(names, q, strict=True))
        evaluated = program.evaluate(outputs, inputs, Arrays(inputs))
        return np.array([np.broadcast_to(x, q.shape[1:]) for x in evaluated])

    return values
