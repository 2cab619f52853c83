"""Rows of constraints of which some follow from the others: all of them are kept, and which are used is chosen locally.

A fixed choice of independent rows becomes dependent at positions in which nothing happens to the mechanism (the two
wheels of an axle, seen from axes in which the axle turns).  So S lambda = b, with S = J M^-1 J^T positive semidefinite
of rank r, is solved by elimination with the largest pivots in straight-line code: exchanges are made by factors that
are 0 or 1,

    c = 1 where S_ii w_k > S_kk w_i, else 0;      x_k <- c x_i + (1 - c) x_k,      x_i <- c x_k + (1 - c) x_i

w measures rows by their own kind, since a moment and a force have other units (``measures``).  r pivots are taken, what
is left is zero where the rows keep the rank r, and a pivot vanishes only where all rows together have a lower one.  The
solution does not depend on the choice, so that nothing jumps where the choice changes, and derivatives are those of the
solution.

Exchanges of all rows cost much code.  Of more than MOST_DEPENDENT that hang together each is taken in its turn, where
what the rows before leave of it is more than FAINT of its kind, until r are taken.  So a pivot may be as small as FAINT
where the largest would not be; then as many digits are lost.  Where fewer than r are taken all rows lose their rank.

Only rows take part in this that follow from others.  lambda itself is not unique: of all solutions the least is given,
but of rows in turn the one without those that were not taken.

Source: Golub & Van Loan, Matrix Computations, 4th ed. 2013, 4.2.8 (symmetric pivoting of semidefinite matrices).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.matrices import united
from mbsym.algebra.program import Node, Program
from mbsym.mechanics.constraints.rows import RowName
from mbsym.mechanics.factorisation import Elimination

#: More rows that hang together are taken in turn: with exchanges the code would be long.
MOST_DEPENDENT = 24

#: Of still more only independent ones are used, which may be dependent elsewhere.
MOST_IN_TURN = 40

#: The least pivot of rows in turn, as a part of the row's kind.
FAINT = Fraction(1, 10**5)

#: Of two pivots that are as good as each other the first one stays, whatever the roundings.
FIRST = Fraction(1) + Fraction(1, 2**30)


@dataclass(frozen=True)
class Dependent:
    """Rows each of which follows from others of them somewhere; ``rank`` of them are independent."""

    rows: tuple[int, ...]
    rank: int


def dependent_sets(relations: Iterable[Collection[int]], independent: Collection[int]) -> tuple[Dependent, ...]:
    """Which rows hang together by ``relations``: each names the rows of one that say something about each other."""
    dependents = (Dependent(tuple(sorted(group)), len(group & set(independent))) for group in united(relations))
    return tuple(sorted(dependents, key=lambda group: group.rows))


def counted_anew(
    order: Iterable[int], independent: Collection[int], *kinds: Sequence[Dependent]
) -> tuple[list[int], list[tuple[Dependent, ...]]]:
    """The rows of ``order`` that equations are made of, and the sets counted by their places among these.

    The ``independent`` ones of sets of more than MOST_DEPENDENT rows come first: they are good where they were chosen.
    Sets of more than MOST_IN_TURN are left with these, of which nothing follows any more.
    """
    long = {i for sets in kinds for group in sets if len(group.rows) > MOST_IN_TURN for i in group.rows}
    rows = [i for i in order if i not in long or i in independent]
    places = {i: place for place, i in enumerate(rows)}

    def counted(group: Dependent) -> Dependent:
        behind = {*group.rows} - {*independent} if len(group.rows) > MOST_DEPENDENT else ()
        return Dependent(
            tuple(places[i] for i in sorted(group.rows, key=lambda i: (i in behind, places[i]))), group.rank
        )

    return rows, [tuple(counted(dependent) for dependent in sets if not long & {*dependent.rows}) for sets in kinds]


def measures(
    program: Program, names: Sequence[RowName], diagonal: Sequence[Node], usual: Mapping[tuple[int, int], Fraction]
) -> list[Node]:
    """w of every row: the sum of S_ii over the rows of its kind, or S_ii and what that usually is, where it is known.

    So the single row of a constraint, which may have units of its own, is not chosen where it vanishes in passing.
    """
    known = [usual.get((name.constraint, name.component)) for name in names]
    sums: dict[str, Node] = {}
    for name, size in zip(names, diagonal, strict=True):
        sums[name.kind] = sums.get(name.kind, program.zero) + size
    return [
        sums[name.kind] if x is None else size + program.number(x)
        for name, size, x in zip(names, diagonal, known, strict=True)
    ]


class Compliance:
    """S x = b for S with dependent rows among the first ``count`` ones.  Raises SingularPoint as ``Elimination`` does.

    ``pivots`` are those of the rows that are independent, then those of each set of ``dependent`` ones; ``owners`` says
    of which rows each of them may be.
    """

    def __init__(
        self,
        program: Program,
        matrix: Sequence[Sequence[Node]],
        right: Sequence[Node],
        dependent: Sequence[Dependent],
        sizes: Sequence[Node],
        singular: str,
    ) -> None:
        self.program, self.dependent = program, dependent
        tied = [i for group in dependent for i in group.rows]
        loose = [i for i in range(len(matrix)) if i not in tied]
        self._loose, self._tied = loose, tied
        rights = [[matrix[i][j] for i in loose] for j in tied]
        self._first = Elimination(
            program, [[matrix[i][j] for j in loose] for i in loose], [[right[i] for i in loose], *rights], singular
        )
        own, *columns = self._first.forward
        self._columns = columns
        block = [[matrix[i][j] - self._paired(x, y) for j, y in zip(tied, columns, strict=True)]
                 for i, x in zip(tied, columns, strict=True)]  # fmt: skip
        rest = [right[i] - self._paired(x, own) for i, x in zip(tied, columns, strict=True)]
        self._second = _Chosen(program, block, rest, [sizes[i] for i in tied], dependent)
        self.owners = tuple((i,) for i in loose) + tuple(
            group.rows for group in dependent for _ in range(_pivots_of(group))
        )

    def _paired(self, x: Sequence[Node], y: Sequence[Node]) -> Node:
        total = self.program.zero
        for a, b, inverse in zip(x, y, self._first.inverses, strict=True):
            if not (self.program.vanishes(a) or self.program.vanishes(b)):
                total = total + a * inverse * b
        return total

    @property
    def pivots(self) -> tuple[Node, ...]:
        return (*self._first.pivots, *self._second.pivots)

    def solution(self, least: bool = False) -> tuple[Node, ...]:
        """x, one of many where rows are dependent: with zeros for rows that follow, or the ``least`` one."""
        second = self._second.solution(least)
        start = list(self._first.forward[0])
        for x, column in zip(second, self._columns, strict=True):
            start = [y if self.program.vanishes(c) else y - x * c for y, c in zip(start, column, strict=True)]
        components = dict(zip(self._loose, self._first.backward(start), strict=True))
        components |= dict(zip(self._tied, second, strict=True))
        return tuple(components[i] for i in range(len(components)))


def _pivots_of(dependent: Dependent) -> int:
    """Of rows in turn each has one, and one more vanishes where too few are taken."""
    return dependent.rank if len(dependent.rows) <= MOST_DEPENDENT else len(dependent.rows) + 1


class _Chosen:
    """A x = b with the largest pivots of each set of rows, which stand one after another."""

    def __init__(
        self,
        program: Program,
        matrix: Sequence[Sequence[Node]],
        right: Sequence[Node],
        sizes: Sequence[Node],
        sets: Sequence[Dependent],
    ) -> None:
        self.program, n = program, len(right)
        self._a, self._b, self._sizes = [list(row) for row in matrix], list(right), list(sizes)
        self._factors: list[list[Node]] = [[program.zero] * n for _ in range(n)]  # by row, then by pivot
        self._exchanges: list[tuple[int, int, Node]] = []
        self._taken: list[int] = []
        self._left: list[tuple[range, list[int]]] = []  # of each set the places of its pivots, and those without
        self._pivots: list[Node] = []
        start = 0
        for dependent in sets:
            end = start + len(dependent.rows)
            if len(dependent.rows) > MOST_DEPENDENT:
                self._take_in_turn(range(start, end), dependent.rank)
                start = end
                continue
            for k in range(start, start + dependent.rank):
                for i in range(k + 1, end):
                    self._exchange(k, i, [*range(k, n)])
                self._eliminate(k, [*range(k + 1, end), *range(end, n)])
                self._pivots.append(self._a[k][k])
            self._left.append((range(start, start + dependent.rank), [*range(start + dependent.rank, end)]))
            start = end

    @property
    def pivots(self) -> tuple[Node, ...]:
        return tuple(self._pivots)

    def _take_in_turn(self, rows: range, rank: int) -> None:
        """Each row that is not taken is left out by the factor 0, and has its size for a pivot."""
        program, a, count = self.program, self._a, self.program.zero
        for k in rows:
            enough = program.exceeds(a[k][k], program.number(FAINT) * self._sizes[k])
            taken = enough * program.exceeds(program.number(Fraction(2 * rank - 1, 2)), count)
            count = count + taken
            a[k][k] = taken * a[k][k] + (program.one - taken) * self._sizes[k]
            self._b[k] = taken * self._b[k]
            for i in range(k + 1, len(a)):
                a[i][k] = a[k][i] = taken * a[i][k]
            self._eliminate(k, [*range(k + 1, len(a))])
            self._pivots.append(a[k][k])
        self._pivots.append(program.exceeds(count, program.number(Fraction(2 * rank - 1, 2))) * self._sizes[rows.start])

    def _exchange(self, k: int, i: int, active: Sequence[int]) -> None:
        """Rows k and i exchanged where i has the larger pivot."""
        program, a, sizes = self.program, self._a, self._sizes
        same = sizes[i] == sizes[k]
        mine, other = (a[k][k], a[i][i]) if same else (a[k][k] * sizes[i], a[i][i] * sizes[k])
        chosen = program.exceeds(other, program.number(FIRST) * mine)
        if program.vanishes(chosen):
            return
        self._exchanges.append((k, i, chosen))
        diagonal, beside = (a[k][k], a[i][i]), a[k][i]
        for j in active:
            if j not in (k, i):
                a[k][j], a[i][j] = self._exchanged(a[k][j], a[i][j], chosen)
                a[j][k], a[j][i] = a[k][j], a[i][j]
        a[k][k], a[i][i] = self._exchanged(*diagonal, chosen)
        a[k][i] = a[i][k] = beside
        for rows in (self._b, *([] if same else [sizes])):
            rows[k], rows[i] = self._exchanged(rows[k], rows[i], chosen)
        for p in self._taken:
            own, others = self._factors[k], self._factors[i]
            own[p], others[p] = self._exchanged(own[p], others[p], chosen)

    def _exchanged(self, x: Node, y: Node, chosen: Node) -> tuple[Node, Node]:
        if x == y:
            return x, y
        stays = self.program.one - chosen
        return chosen * y + stays * x, chosen * x + stays * y

    def _eliminate(self, k: int, rows: Sequence[int]) -> None:
        a, inverse = self._a, self.program.reciprocal(self._a[k][k])
        for place, i in enumerate(rows):
            factor = self._factors[i][k] = a[k][i] * inverse
            for j in rows[: place + 1]:
                a[i][j] = a[j][i] = a[i][j] - factor * a[k][j]
            self._b[i] = self._b[i] - factor * self._b[k]
        self._taken.append(k)

    def solution(self, least: bool) -> list[Node]:
        program = self.program
        nodes = [program.zero] * len(self._b)
        for k in reversed(self._taken):
            value = program.divide(self._b[k], self._a[k][k])
            for i in self._taken:
                if i > k:
                    value = value - self._factors[i][k] * nodes[i]
            nodes[k] = value
        if least:
            for pivots, without in self._left:
                self._shorten(nodes, pivots, without)
        for k, i, chosen in reversed(self._exchanges):
            nodes[k], nodes[i] = self._exchanged(nodes[k], nodes[i], chosen)
        return nodes

    def _shorten(self, x: list[Node], pivots: Sequence[int], without: Sequence[int]) -> None:
        """x - N (N^T w N)^-1 N^T w x, where N spans the null space: a column for each row without pivot."""
        program = self.program
        if not without:
            return
        columns: list[dict[int, Node]] = []
        for j in without:
            column = {j: program.one}
            for k in reversed(pivots):
                value = -self._factors[j][k]
                for i in pivots:
                    if i > k:
                        value = value - self._factors[i][k] * column[i]
                column[k] = value
            columns.append(column)

        def measured_product(nodes: dict[int, Node], other: dict[int, Node]) -> Node:
            total = program.zero
            for k, value in nodes.items():
                if k in other:
                    total = total + self._sizes[k] * value * other[k]
            return total

        whole = {k: x[k] for k in pivots}
        squares = [[measured_product(nodes, other) for other in columns] for nodes in columns]
        solved = Elimination(program, squares, [[measured_product(nodes, whole) for nodes in columns]])
        for weight, column in zip(solved.backward(solved.forward[0]), columns, strict=True):
            for k, value in column.items():
                x[k] = x[k] - weight * value
