"""Sensitive operations carried to twice the precision: pairs  value = high + low,  |low| about half a unit of high.

Two instructions give what rounding took away, exactly:

    rounding of sum       (a + b) - fl(a + b)     by Knuth's two-sum
    rounding of product   (a b) - fl(a b)         by a fused multiplication and addition

In exact arithmetic both are 0, so that a program means the same with them and without.  With pairs (a, a'), (b, b'):

    a + b       s = fl(a + b),    s' = rounding + a' + b',   brought into order by one more two-sum
    a b         p = fl(a b),      p' = rounding + a b' + b a'
    a/b         q = fl(a/b),      q' = ((a - q b) + a' - q b')/b
    sqrt a      r = fl(sqrt a),   r' = ((a - r^2) + a')/(2 r)
    sin, cos    brought onto the circle: s' = s e/2, c' = c e/2, e = 1 - s^2 - c^2; what is left is an error of the
                angle, which is the question's

(Dekker, Numer. Math. 18 (1971) 224; Hida, Li and Bailey, ARITH 15 (2001).)  Constants are split into two doubles.
Only the operations in ``sensitive`` and what they hand on take part; everything else is computed as before.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fractions import Fraction

from mbsym.algebra.program import PRODUCT_ROUNDING, SUM_ROUNDING, Node, Program

HALF = Fraction(1, 2)

Pair = tuple[Node, Node | None]


def compensated(program: Program, outputs: Sequence[Node], sensitive: Collection[int]) -> list[Node]:
    """The same outputs with the instructions of ``sensitive`` (their numbers) carried as pairs.

    The nodes are added to the program.  To be compiled as they are: rewriting (``stabilised``) would undo them.
    """
    return _Pairs(program, frozenset(sensitive)).images(outputs)


class _Pairs:
    def __init__(self, program: Program, sensitive: frozenset[int]) -> None:
        self.program, self.sensitive = program, sensitive
        self.pairs: dict[int, Pair] = {}
        self.excess: dict[int, Node] = {}

    def images(self, outputs: Sequence[Node]) -> list[Node]:
        for number in self.program.live(outputs):
            self.pairs[number] = self._pair(number)
        return [self._joined(self.pairs[node.number]) for node in outputs]

    def _joined(self, pair: Pair) -> Node:
        high, low = pair
        return high if low is None else self.program.plus(high, low)

    def _rounding(self, operation: str, a: Node, b: Node) -> Node:
        return self.program.rounding(operation, a, b)

    def _pair(self, number: int) -> Pair:
        program = self.program
        operation, operands, payload = program.instructions[number]
        exact = number in self.sensitive
        if operation == "constant":
            assert isinstance(payload, Fraction)
            return self._split(number, payload) if exact else (Node(program, number), None)
        pairs = [self.pairs[k] for k in operands]
        if not operands or not (exact or any(low is not None for _, low in pairs)):
            unchanged = all(high.number == k for (high, _), k in zip(pairs, operands, strict=True))
            return (Node(program, number) if unchanged else program.again(operation, [h for h, _ in pairs])), None
        match operation, pairs:
            case "negative", [(a, low)]:
                return program.minus(a), None if low is None else program.minus(low)
            case "add", [a, b]:
                nodes = self._sum(a, b, exact)
            case "subtract", [a, (b, low)]:
                nodes = self._sum(a, (program.minus(b), None if low is None else program.minus(low)), exact)
            case "multiply", [a, b]:
                nodes = self._product(a, b, exact)
            case "divide", [a, b]:
                nodes = self._quotient(a, b, exact)
            case "sqrt", [a]:
                nodes = self._root(a, exact)
            case ("sin" | "cos") as which, [a]:
                nodes = self._turn(which, a, exact)
            case name, [(a, _)]:
                return program.again(name, [a]), None
            case _:
                raise ValueError(f"no such operation: {operation}")
        # What is not sensitive itself takes in what it was handed, and hands on one number.
        return nodes if exact else (self._joined(nodes), None)

    def _split(self, number: int, value: Fraction) -> Pair:
        high = Fraction(float(value))
        if high == value:
            return Node(self.program, number), None
        return self.program.number(high), self.program.number(Fraction(float(value - high)))

    def _lows(self, *lows: Node | None) -> Node | None:
        total: Node | None = None
        for low in lows:
            if low is not None:
                total = low if total is None else self.program.plus(total, low)
        return total

    def _sum(self, a: Pair, b: Pair, exact: bool) -> Pair:
        program = self.program
        s = program.plus(a[0], b[0])
        if not exact:
            return s, self._lows(a[1], b[1])
        low = self._lows(self._rounding(SUM_ROUNDING, a[0], b[0]), a[1], b[1])
        assert low is not None
        return program.plus(s, low), self._rounding(SUM_ROUNDING, s, low)

    def _product(self, a: Pair, b: Pair, exact: bool) -> Pair:
        program = self.program
        low = self._lows(
            self._rounding(PRODUCT_ROUNDING, a[0], b[0]) if exact else None,
            None if b[1] is None else program.product(a[0], b[1]),
            None if a[1] is None else program.product(a[1], b[0]),
        )
        return program.product(a[0], b[0]), low

    def _quotient(self, a: Pair, b: Pair, exact: bool) -> Pair:
        program = self.program
        q = program.divide(a[0], b[0])
        parts = [a[1], None if b[1] is None else program.minus(program.product(q, b[1]))]
        if exact:
            # fl(q b) is so near a that the difference is exact.
            rest = program.difference(program.difference(a[0], program.product(q, b[0])), self._over(q, b[0]))
            parts.insert(0, rest)
        low = self._lows(*parts)
        return q, None if low is None else program.divide(low, b[0])

    def _over(self, a: Node, b: Node) -> Node:
        return self._rounding(PRODUCT_ROUNDING, a, b)

    def _root(self, a: Pair, exact: bool) -> Pair:
        program = self.program
        r = program.square_root(a[0])
        rest = program.difference(program.difference(a[0], program.product(r, r)), self._over(r, r)) if exact else None
        low = self._lows(rest, a[1])
        return r, None if low is None else program.divide(low, program.product(program.number(2), r))

    def _turn(self, which: str, a: Pair, exact: bool) -> Pair:
        """d sin = cos da + sin e/2,  d cos = -sin da + cos e/2."""
        program = self.program
        s, c = program.sin_cos_of(a[0])
        own, other = (s, c) if which == "sin" else (c, program.minus(s))
        low = None if a[1] is None else program.product(other, a[1])
        if exact:
            low = self._lows(low, program.product(program.product(program.number(HALF), own), self._circle(s, c)))
        return own, low

    def _circle(self, s: Node, c: Node) -> Node:
        """1 - s^2 - c^2, all digits of it."""
        program = self.program
        if s.number not in self.excess:
            square, node = program.minus(program.product(s, s)), program.one
            first = program.plus(node, square)
            rest = program.difference(first, program.product(c, c))
            roundings = program.plus(self._over(s, s), self._over(c, c))
            taken = program.difference(self._rounding(SUM_ROUNDING, node, square), roundings)
            self.excess[s.number] = program.plus(rest, taken)
        return self.excess[s.number]
