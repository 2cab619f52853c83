"""The conditions of rest in one set of coordinates, and whether they can be solved exactly."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from math import gcd, lcm

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_systems import Limits
from mbsym.algebra.rationals import fraction
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import apart
from mbsym.expressions.angles import LinearForm
from mbsym.expressions.message import Message
from mbsym.mechanics.charts import Chart, moments
from mbsym.mechanics.rest import Rest


class Conditions:
    """What vanishes at rest in one chart as polynomials, what must not vanish, and which coordinates occur.

    Under constraints that is one ``case`` of the rank of J, which elsewhere is ``rank``, where that is known.
    ``parameters`` without numbers are unknowns, too.
    """

    def __init__(
        self,
        chart: Chart,
        within: float,
        limits: Limits,
        case: Case | None = None,
        rank: int | None = None,
        parameters: tuple[str, ...] = (),
    ) -> None:
        self.parameters = parameters
        self.chart, self.rest, self.within, self.limits = chart, chart.rest, within, limits
        self.case = case or Case(self.rest.at_rest)
        self.ranks = (self.case.rank, rank)
        self.ring: Ring = chart.rest.ring
        self.remarks: list[str] = []
        self.doubts: list[str] = []
        self.unfinished = False

    def _conditions(self) -> None:
        rest, ring = self.rest, self.ring
        forcing = [*rest.kept, *self.case.zero, *self.case.left]
        for joint, other in zip(self.chart.joints, self.chart.replaced, strict=True):
            # Where the angles are regular these follow, and with them the exact solution is much faster.
            forcing += () if other or rest.rows else moments(rest, joint)
        polynomials = [y for x in forcing for y in self._for_all_times(x)]
        self.equations: list[Polynomial] = []
        self.nonzero: list[Polynomial] = [*self.case.nonzero]
        self.impossible = False
        for x in (*polynomials, *self.chart.restrictions):
            numerator, denominators = ring.fraction(x)
            self.nonzero += [factor for factor, _ in denominators]
            if numerator.is_constant() and not numerator.is_zero():
                self.impossible = True
            elif not numerator.is_zero():
                self.equations.append(numerator)
        self._take_relations_of_angles_for_turns()
        used = set(occurring(self.equations))
        self.occurring = tuple(name for name in rest.constant if any(ring.depends_on(x, name) for x in self.equations))
        self.free = tuple(name for name in rest.constant if name not in self.occurring)
        usual = [
            x for x in self.chart.nonzero if any(ring.generators[k].name in self.occurring for k in occurring([x]))
        ]
        self.nonzero += usual
        self.singular_where = usual
        self.reason = self._obstacle(used)

    def _take_relations_of_angles_for_turns(self) -> None:
        """Whole numbers n_k without common factor, sum n_k q_k = 0:  sin = 0, cos = 1 of the sum in its place.

        So it is up to turns by 2 pi of angles q_k that occur nowhere else but in sines and cosines.
        """
        ring = self.ring
        for x in tuple(self.equations):
            whole = _whole_sum(ring, x)
            others = [y for y in self.equations if y is not x]
            if whole is None or ring.held([*others, *self.rest.forcing]) & {*occurring([x])}:
                continue
            sine, cosine = ring.sin_cos(LinearForm(whole))
            self.equations = [*others, sine, ring.reduce(cosine - ring.one)]

    def _for_all_times(self, x: Polynomial) -> Iterator[Polynomial]:
        """What must vanish so that x does at all times: its coefficients with respect to what moves."""
        ring = self.ring
        moving = [*self.rest.turning, *(item.name for item in self.rest.system.prescribed), "t"]
        present = ring.dependencies(x, moving)
        if not present:
            yield x
            return
        self.remarks.append(
            Message(
                "the equations vary with [[present]]: a relative equilibrium has to satisfy them at all times",
                present=", ".join(present),
            )
        )
        indices = [
            k
            for k, g in enumerate(ring.generators)
            if g.name in present
            and g.argument is None
            and g.kind in ("sine", "cosine", "coordinate", "prescribed", "time")
        ]
        if len(present) > 1:
            self._incomplete(
                Message(
                    "the equations vary with [[present]]; only solutions for all values of each are listed",
                    present=", ".join(present),
                )
            )
        for part in apart(x, indices).values():
            if ring.dependencies(part, moving):
                raise NoClosedForm(
                    "the equations vary with [[names]] in a way that cannot be separated", names=", ".join(present)
                )
            yield part

    def _obstacle(self, used: set[int]) -> str:
        """Why the equations are not polynomials in sines, cosines and plain coordinates; empty if they are."""
        ring = self.ring
        unknown = {ring.index("parameter", name) for name in self.parameters}
        pending, seen = list(used - unknown), set()
        kinds: dict[str, set[str]] = {}
        while pending:
            k = pending.pop()
            if k in seen:
                continue
            seen.add(k)
            g = ring.generators[k]
            if g.kind == "function" or (g.kind in ("sine", "cosine") and g.argument is not None):
                what = (
                    Message("a number")
                    if ring.constant_value(g.argument) is not None
                    else Message("something that is no angle")
                )
                return Message(
                    "[[functions]] of [[what]]",
                    functions=Message("sine and cosine") if g.kind != "function" else g.name,
                    what=what,
                )
            if g.argument is not None:
                pending += occurring([g.argument])
            elif g.kind in ("sine", "cosine", "coordinate"):
                kinds.setdefault(g.name, set()).add("plain" if g.kind == "coordinate" else "angle")
            elif g.name in self.parameters:
                return Message("[[name]] stands in a root or a function", name=g.name)
            else:
                return Message("[[name]] is transcendental", name=g.name)
        mixed = [name for name, both in kinds.items() if len(both) > 1]
        return (
            Message("[[names]] occurs both as an angle and outside sine and cosine", names=", ".join(sorted(mixed)))
            if mixed
            else ""
        )

    def _incomplete(self, remark: str) -> None:
        self.doubts.append(remark)

    @property
    def complete(self) -> bool:
        """Whether nothing is missing; else ``doubts`` say what was not done, or it is still to be done."""
        return not self.doubts and not self.unfinished

    def _periodic(self, name: str) -> bool:
        """Whether it occurs as an angle only: not outside of its sine and cosine, nor in a function or another sine."""
        return self.ring.has("sine", name) and self.ring.index("coordinate", name) not in self._held

    @cached_property
    def _held(self) -> set[int]:
        return self.ring.held(self.equations)


# Rest under constraints: which equations between coordinates  f + J^T lambda = 0  leaves, whatever the rank of J.
#
# The multipliers are eliminated without fractions.  A pivot that may vanish makes two cases, in one of which it is not
# zero and in the other it is, so that every position that the constraints allow belongs to exactly one case, and the
# number of pivots is the rank of J there:
#
#     [J^T | f]  ->  rows without a pivot:  [0 | combination of f],  which has to vanish


def _whole_sum(ring: Ring, x: Polynomial) -> tuple[tuple[str, Fraction], ...] | None:
    """(q_k, n_k) of sum n_k q_k = 0, n_k whole numbers without common factor and q_k angles; else None."""
    terms = [(ring.generators[k], c) for k in occurring([x]) if (c := x.derivative(k)).is_constant()]
    total = sum((c * ring.generator(g.kind, g.name) for g, c in terms if g.kind == "coordinate"), ring.zero)
    if len(terms) < 2 or total != x or any(ring.angles.get(g.name) != 1 for g, _ in terms):
        return None
    numbers = {g.name: fraction(c.leading_coefficient()) for g, c in terms}
    share = Fraction(gcd(*(n.numerator for n in numbers.values())), lcm(*(n.denominator for n in numbers.values())))
    return tuple(sorted((name, n / share) for name, n in numbers.items()))


#: More cases are not told apart.
MOST_CASES = 200

Polynomials = tuple[Polynomial, ...]


@dataclass(frozen=True)
class Case:
    """``left`` have to vanish at rest where ``zero`` vanish and ``nonzero`` do not: there J has this ``rank``.

    ``pivots``: their places (row of the table that is left, constraint), one after the other.  ``whole``: multipliers
    are not eliminated from ``left``, and no pivot is assumed.
    """

    left: Polynomials
    zero: Polynomials = ()
    nonzero: Polynomials = ()
    pivots: tuple[tuple[int, int], ...] = ()
    whole: bool = False

    @property
    def rank(self) -> int:
        return len(self.pivots)


def cases(rest: Rest, possible: Callable[[Polynomials, Polynomials], bool]) -> Iterator[Case]:
    """The cases of a constrained system; one where there are no constraints.

    ``possible``: False of (zero, nonzero) that no position has.  Raises NoClosedForm where there are too many.
    """
    ring = rest.ring
    pending: list[tuple[list[list[Polynomial]], Case]] = [(_table(rest), Case(()))]
    looked_at = 0
    while pending:
        rows, case = pending.pop()
        looked_at += 1
        if looked_at > MOST_CASES:
            raise NoClosedForm("more than [[count]] cases of the rank of constraints", count=MOST_CASES)
        if case.zero and not possible(case.zero, case.nonzero):
            continue
        place = _pivot(rows)
        if place is None:
            yield replace(case, left=tuple(row[-1] for row in rows))
            continue
        i, k = place
        pivot = rows[i][k]
        numerator, _ = ring.fraction(pivot)
        regular = replace(case, pivots=(*case.pivots, place))
        if not numerator.is_constant():
            without = [[ring.zero if x == pivot or x == -pivot else x for x in row] for row in rows]
            pending.append((without, replace(case, zero=(*case.zero, numerator))))
            regular = replace(regular, nonzero=(*case.nonzero, numerator))
        pending.append((_eliminated(ring, rows, i, k), regular))


def near(rest: Rest, case: Case) -> tuple[Polynomials, tuple[int, ...]]:
    """What has to vanish at rest near positions of a case, and which constraints are independent there.

    The pivots are those of the case, but what vanishes in it is not left out: so these may be differentiated.
    """
    rows = _table(rest)
    for i, k in case.pivots:
        rows = _eliminated(rest.ring, rows, i, k)
    return tuple(row[-1] for row in rows), tuple(k for _, k in case.pivots)


def _table(rest: Rest) -> list[list[Polynomial]]:
    """[J^T | f]."""
    return [[*(row.partials[i] for row in rest.rows), f] for i, f in enumerate(rest.at_rest)]


def _pivot(rows: Sequence[Sequence[Polynomial]]) -> tuple[int, int] | None:
    """The place of a multiplier's shortest factor, a number before all others."""
    held = [(not x.is_constant(), len(x), i, k) for i, row in enumerate(rows) for k, x in enumerate(row[:-1]) if x != 0]
    return min(held)[2:] if held else None


def _eliminated(ring: Ring, rows: list[list[Polynomial]], i: int, k: int) -> list[list[Polynomial]]:
    """The rows without the one of the pivot, each times the pivot less its own entry times that row."""
    top, pivot = rows[i], rows[i][k]
    left = []
    for j, row in enumerate(rows):
        if j == i:
            continue
        if row[k].is_zero():
            left.append(row)
            continue
        left.append([ring.reduce(ring.times(pivot, x) - ring.times(row[k], y)) for x, y in zip(row, top, strict=True)])
    return left
