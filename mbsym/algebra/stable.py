"""Forms that keep digits: sums in which equal parts cancel, rewritten so that they cancel on paper instead.

A sum is flattened into terms  coefficient * product of factors  with exact coefficients, and

* like terms are added exactly: (J cos^2 x + J' sin^2 x) - J' sin x sin x  becomes  J cos^2 x;
* a s^2 + a c^2                        becomes  a                              (s, c: sine and cosine of one angle)
* a + b s^2,  a + b about 0            becomes  (a + b) - b c^2                likewise with s and c exchanged
* a + b cos x,  a + b about 0          becomes  (a + b) - 2 b sin^2(x/2)       and with 2 cos^2(x/2) for a - b about 0
* a x^2 - a y^2                        becomes  a (x - y) (x + y)
* a cos x - a cos y, a sin x - a sin y become products, where the functions are not needed for anything else
* sqrt(S) - L  and  1 - L/sqrt(S)      become  (S - L^2) / (sqrt(S) + L) and that over sqrt(S), for a number L > 0

each times a common product of factors.  In exact arithmetic nothing changes; in floating point the error of such a sum
is relative to its own size, no longer to that of its parts (Higham, Accuracy and Stability of Numerical Algorithms,
2nd ed., sections 1.7 and 1.8).  Whatever matches no rule is left as it stands, so that shared nodes stay shared.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from mbsym.algebra.program import Node, Program

#: Constants "cancel" where their sum is at most this part of them: two binary digits would be lost.
CLOSE = Fraction(1, 4)

#: Products of more factors, sums of more terms are left alone: nothing cancels by chance there.
MOST_FACTORS, MOST_SUMMANDS = 10, 64

#: Numbers of the factors of a term, sorted; ``~number`` stands for its reciprocal.
Key = tuple[int, ...]
HALF = Fraction(1, 2)


def stabilised(program: Program, outputs: Sequence[Node], thorough: bool = False) -> list[Node]:
    """The same outputs, built of sums that do not lose digits; the nodes are added to the program.

    Half angles are brought in where the cosine is not needed for anything else, with ``thorough`` everywhere: that
    takes one more sine or cosine.
    """
    return _Rewriting(program, outputs, thorough).images(outputs)


@dataclass
class _Sum:
    """Terms by key, in the order in which they occurred; ``origins`` are nodes that already hold a term."""

    coefficients: dict[Key, Fraction] = field(default_factory=dict)
    origins: dict[Key, tuple[Fraction, Node]] = field(default_factory=dict)

    def add(self, key: Key, coefficient: Fraction, origin: tuple[Fraction, Node] | None = None) -> None:
        known = self.coefficients.get(key, Fraction(0))
        self.coefficients[key] = known + coefficient
        if origin is not None and known == 0:
            self.origins[key] = origin
        if self.coefficients[key] == 0:
            del self.coefficients[key]


class _Rewriting:
    def __init__(self, program: Program, outputs: Sequence[Node], thorough: bool) -> None:
        self.program = program
        self.thorough = thorough
        self.live = program.live(outputs)
        self.uses = Counter(k for number in self.live for k in program.instructions[number].operands)
        self.uses.update(node.number for node in outputs)
        users: dict[int, str] = {}
        for number in self.live:
            for operand in program.instructions[number].operands:
                users[operand] = program.instructions[number].operation
        additive = ("add", "subtract", "negative")
        instructions = program.instructions
        differences = {instructions[k].operands for k in self.live if instructions[k].operation == "subtract"}
        # A part of a sum that nobody else needs is no node of its own; x - y is needed where y - x is.
        self.inner = {
            number
            for number in self.live
            if self.uses[number] == 1
            and instructions[number].operation in additive
            and users.get(number) in additive
            and not (
                instructions[number].operation == "subtract" and instructions[number].operands[::-1] in differences
            )
        } - {node.number for node in outputs}
        self.image: dict[int, Node] = {}
        self.known: dict[int, tuple[Fraction, Key]] = {}

    def images(self, outputs: Sequence[Node]) -> list[Node]:
        for number in self.live:
            if number not in self.inner:
                self.image[number] = self._image(number)
        return [self.image[node.number] for node in outputs]

    def _image(self, number: int) -> Node:
        program = self.program
        operation, operands, _ = program.instructions[number]
        if operation in ("add", "subtract"):
            return self._sum(number)
        if all(self.image[k].number == k for k in operands if k in self.image) and operation != "negative":
            return Node(program, number)
        return program.again(operation, [self._factor(k) for k in operands])

    def _factor(self, number: int) -> Node:
        """The image of an operand; one inside a negative is made now."""
        if number not in self.image:
            self.image[number] = self._sum(number)
        return self.image[number]

    # --- taking sums apart -------------------------------------------------------------------------------------------

    def _sum(self, number: int) -> Node:
        """The rewritten sum with this root."""
        summands: list[tuple[int, int]] = []
        pending = [(1, number)]
        while pending:
            sign, k = pending.pop()
            operation, operands, _ = self.program.instructions[k]
            if k != number and k not in self.inner:
                summands.append((sign, k))
            elif operation == "negative":
                pending.append((-sign, operands[0]))
            else:
                second = -sign if operation == "subtract" else sign
                pending += [(second, operands[1]), (sign, operands[0])]
        if len(summands) > MOST_SUMMANDS:
            return self._plain([(sign, self.image[k]) for sign, k in summands])
        if len(summands) == 2 and self._ordinary([self.image[k] for _, k in summands]):
            return self._plain([(sign, self.image[k]) for sign, k in summands])
        whole = _Sum()
        for sign, k in summands:
            self._note(whole, sign, self.image[k])
        before = dict(whole.coefficients)
        self._improve(whole)
        if whole.coefficients == before and len(before) == len(summands):
            return self._plain([(sign, self.image[k]) for sign, k in summands])
        return self._emitted(whole)

    def _ordinary(self, nodes: Sequence[Node]) -> bool:
        """Whether no rule can apply to a sum of two terms: unlike keys, not one a part of the other."""
        first, second = (self._term(node)[1] for node in nodes)
        if first == second or abs(len(first) - len(second)) > 2:
            return first != second
        shared = sum((Counter(first) & Counter(second)).values())
        return max(len(first), len(second)) - shared > 2

    def _plain(self, summands: Sequence[tuple[int, Node]]) -> Node:
        total = self.program.zero
        for sign, node in summands:
            total = total + node if sign > 0 else total - node
        return total

    def _note(self, whole: _Sum, sign: int, node: Node) -> None:
        coefficient, key = self._term(node)
        whole.add(key, sign * coefficient, (coefficient, node))

    def _term(self, node: Node) -> tuple[Fraction, Key]:
        """node = coefficient * product of the key's factors."""
        term = self.known.get(node.number)
        if term is None:
            term = self.known[node.number] = self._taken_apart(node)
        return term

    def _taken_apart(self, node: Node) -> tuple[Fraction, Key]:
        coefficient, factors = Fraction(1), []
        pending = [(node.number, False)]
        while pending:
            number, below = pending.pop()
            operation, operands, payload = self.program.instructions[number]
            if isinstance(payload, Fraction) and payload != 0:
                coefficient = coefficient / payload if below else coefficient * payload
            elif operation == "negative":
                coefficient = -coefficient
                pending.append((operands[0], below))
            elif operation == "multiply":
                pending += [(k, below) for k in operands]
            elif operation == "divide":
                pending += [(operands[0], below), (operands[1], not below)]
            elif operation == "subtract" and operands[0] > operands[1]:
                # y - x and x - y are two nodes; as factors they are one, with a sign.
                coefficient = -coefficient
                other = self.program.minus(Node(self.program, number)).number
                factors.append(~other if below else other)
            else:
                factors.append(~number if below else number)
            if len(factors) + len(pending) > MOST_FACTORS:
                return Fraction(1), (node.number,)
        if node.number == 0:
            return Fraction(0), ()
        return coefficient, tuple(sorted(factors))

    def _terms(self, node: Node) -> _Sum:
        """An already rewritten node as a sum."""
        whole = _Sum()
        pending = [(1, node.number)]
        while pending:
            sign, number = pending.pop()
            operation, operands, _ = self.program.instructions[number]
            if operation in ("add", "subtract"):
                second = -sign if operation == "subtract" else sign
                pending += [(second, operands[1]), (sign, operands[0])]
            elif operation == "negative":
                pending.append((-sign, operands[0]))
            else:
                self._note(whole, sign, Node(self.program, number))
        return whole

    # --- putting them together ---------------------------------------------------------------------------------------

    def _emitted(self, whole: _Sum) -> Node:
        program, total = self.program, self.program.zero
        for key, coefficient in whole.coefficients.items():
            own, node = whole.origins.get(key, (Fraction(0), program.zero))
            if own and abs(own) == abs(coefficient):
                total = total + node if own == coefficient else total - node
                continue
            product = program.one
            for factor in key:
                if factor >= 0:
                    product = program.product(product, Node(program, factor))
            for factor in key:
                if factor < 0:
                    product = program.divide(product, Node(program, ~factor))
            product = program.product(program.number(abs(coefficient)), product)
            total = total + product if coefficient > 0 else total - product
        return total

    def _improve(self, whole: _Sum) -> None:
        """Every rule once for every pair of terms; each application leaves no more terms than there were."""
        kinds = {self._operation(f if f >= 0 else ~f)[0] for key in whole.coefficients for f in key}
        turning = "sin" in kinds or "cos" in kinds
        repeated = any(len(set(key)) < len(key) for key in whole.coefficients)
        rules = [self._squares_of_one_angle] if turning and repeated else []
        rules += [self._cosines] if "cos" in kinds else []
        rules += [self._roots] if "sqrt" in kinds else []
        rules += [self._squares] if repeated else []
        rules += [self._two_angles] if turning else []
        for rule in rules:
            for key in list(whole.coefficients):
                if key in whole.coefficients:
                    rule(whole, key)

    def _operation(self, factor: int) -> tuple[str, int]:
        """(name, operand) of a function, ("", -1) of anything else."""
        if factor < 0:
            return "", -1
        operation, operands, _ = self.program.instructions[factor]
        return (operation, operands[0]) if len(operands) == 1 else ("", -1)

    def _squares_of_one_angle(self, whole: _Sum, key: Key) -> None:
        """a s^2 + a c^2 = a;  a + b s^2 = (a + b) - b c^2 and a + b c^2 = (a + b) - b s^2."""
        for factor in _repeated(key):
            name, angle = self._operation(factor)
            if name not in ("sin", "cos") or key not in whole.coefficients:
                continue
            pair = self.program.sin_cos_of(Node(self.program, angle))
            other = pair[1 if name == "sin" else 0]
            if self._operation(other.number) != ("cos" if name == "sin" else "sin", angle):
                continue  # a number, or a sign was moved
            rest = _without(key, factor, factor)
            across = _with(rest, other.number, other.number)
            b = whole.coefficients[key]
            if whole.coefficients.get(across) == b:
                whole.add(key, -b)
                whole.add(across, -b)
                whole.add(rest, b)
                continue
            a = whole.coefficients.get(rest)
            if a is not None and _cancel(a, b):
                whole.add(rest, b)
                whole.add(key, -b)
                whole.add(across, -b)

    def _cosines(self, whole: _Sum, key: Key) -> None:
        """a + b1 cos x1 + b2 cos x2 + ..., where a + b1 + b2 + ... is about 0; or a + b cos x with a - b about 0."""
        a = whole.coefficients[key]
        cosine_terms = [
            (other, factor, b)
            for other, b in whole.coefficients.items()
            if len(other) == len(key) + 1
            for factor in dict.fromkeys(other)
            if self._operation(factor)[0] == "cos" and (self.thorough or self.uses[factor] <= 1)
            if _without(other, factor) == key
        ]
        against = [(other, factor, b) for other, factor, b in cosine_terms if (b > 0) != (a > 0)]
        if against and _cancel(a, sum((b for _, _, b in against), Fraction(0))):
            for other, factor, b in against:
                self._half_angle(whole, key, other, factor, b, 0)
            return
        for other, factor, b in cosine_terms:
            if (b > 0) == (a > 0) and _cancel(a, -b):
                self._half_angle(whole, key, other, factor, b, 1)
                return

    def _half_angle(self, whole: _Sum, rest: Key, key: Key, cosine: int, b: Fraction, which: int) -> None:
        """b cos x = b - 2 b sin^2(x/2)  (which = 0)  or  2 b cos^2(x/2) - b  (1)."""
        angle = Node(self.program, self._operation(cosine)[1])
        half = self.program.sin_cos_of(self.program.product(self.program.number(HALF), angle))[which]
        whole.add(key, -b)
        whole.add(rest, b if which == 0 else -b)
        self._include(whole, rest, [half, half], -2 * b if which == 0 else 2 * b)

    def _include(self, whole: _Sum, rest: Key, nodes: Sequence[Node], coefficient: Fraction) -> None:
        """coefficient * rest * nodes, each node taken apart into its factors."""
        key = list(rest)
        for node in nodes:
            own, factors = self._term(node)
            coefficient *= own
            key += factors
        if coefficient:
            whole.add(tuple(sorted(key)), coefficient)

    def _squares(self, whole: _Sum, key: Key) -> None:
        """a x^2 - a y^2 = a (x - y) (x + y)."""
        a = whole.coefficients[key]
        minus = -a
        for x in _repeated(key):
            rest = _without(key, x, x)
            for other in [other for other in whole.coefficients if len(other) == len(key) and other != key]:
                for y in _repeated(other):
                    if _without(other, y, y) == rest and x >= 0 and y >= 0 and whole.coefficients[other] == minus:
                        first, second = Node(self.program, x), Node(self.program, y)
                        whole.add(key, -a)
                        whole.add(other, a)
                        apart = self._difference(first, second)
                        self._include(whole, rest, [apart, self.program.plus(first, second)], a)
                        return

    def _difference(self, a: Node, b: Node) -> Node:
        """a - b, with what both have in common left out."""
        first, second = self._terms(a), self._terms(b)
        before = len(first.coefficients) + len(second.coefficients)
        for key, coefficient in second.coefficients.items():
            own, node = second.origins.get(key, (coefficient, self.program.zero))
            first.add(key, -coefficient, (own, node))
        if len(first.coefficients) >= before or before > MOST_SUMMANDS:
            return self.program.difference(a, b)
        return self._emitted(first)

    def _two_angles(self, whole: _Sum, key: Key) -> None:
        """a cos x - a cos y = -2 a sin((x + y)/2) sin((x - y)/2),  a sin x - a sin y = 2 a cos(..) sin(..)."""
        a, program = whole.coefficients[key], self.program
        minus = -a
        for factor in dict.fromkeys(key):
            name, x = self._operation(factor)
            if name not in ("sin", "cos") or (self.uses[factor] > 1 and not self.thorough):
                continue
            rest = _without(key, factor)
            for other in [other for other in whole.coefficients if len(other) == len(key)]:
                for match in dict.fromkeys(other):
                    same, y = self._operation(match)
                    if same != name or x == y or _without(other, match) != rest or whole.coefficients[other] != minus:
                        continue
                    if self.uses[match] > 1 and not self.thorough:
                        continue
                    first, second = Node(program, x), Node(program, y)
                    half = program.number(HALF)
                    middle = program.sin_cos_of(program.product(half, program.plus(first, second)))
                    apart = program.sin_cos_of(program.product(half, self._difference(first, second)))[0]
                    whole.add(key, -a)
                    whole.add(other, a)
                    if name == "cos":
                        self._include(whole, rest, [middle[0], apart], -2 * a)
                    else:
                        self._include(whole, rest, [middle[1], apart], 2 * a)
                    return

    def _roots(self, whole: _Sum, key: Key) -> None:
        """a sqrt(S) - a L = a (S - L^2)/(sqrt(S) + L);  a - a L/sqrt(S) = a (S - L^2)/((sqrt(S) + L) sqrt(S))."""
        for factor in dict.fromkeys(key):
            below = factor < 0
            name, square = self._operation(~factor if below else factor)
            rest = _without(key, factor)
            if name != "sqrt" or rest not in whole.coefficients:
                continue
            own, alone = whole.coefficients[key], whole.coefficients[rest]
            a, length = (alone, -own / alone) if below else (own, -alone / own)
            if length <= 0:
                continue
            program, root = self.program, Node(self.program, ~factor if below else factor)
            above = self._less_square(Node(program, square), length)
            bottom = program.plus(root, program.number(length))
            if below:
                bottom = program.product(bottom, root)
            whole.add(key, -own)
            whole.add(rest, -alone)
            self._include(whole, rest, [program.divide(above, bottom)], a)
            return

    def _less_square(self, square: Node, length: Fraction) -> Node:
        """S - L^2; if S contains (L' + z)^2 with L' about L, as (L' - L + z) (L' + L + z) + the rest."""
        program, whole = self.program, self._terms(square)
        for key, coefficient in whole.coefficients.items():
            for x in _repeated(key):
                node = Node(program, x) if x >= 0 else program.zero
                inside = self._terms(node).coefficients.get((), Fraction(0))
                if coefficient == 1 and key == (x, x) and inside and _cancel(inside, -length):
                    whole.add(key, -coefficient)
                    apart = self._difference(node, program.number(length))
                    product = program.product(apart, program.plus(node, program.number(length)))
                    return program.plus(product, self._emitted(whole))
        whole.add((), -length * length)
        return self._emitted(whole)


def _cancel(a: Fraction, b: Fraction) -> bool:
    """Whether a + b is much smaller than its parts."""
    return abs(a + b) <= CLOSE * abs(a)


def _repeated(key: Key) -> list[int]:
    """Factors that occur twice."""
    return list(dict.fromkeys(factor for factor, other in pairwise(key) if factor == other))


def _without(key: Key, *factors: int) -> Key:
    left = list(key)
    for factor in factors:
        if factor not in left:
            return (-1,)  # ~0: no key contains the reciprocal of the constant 0
        left.remove(factor)
    return tuple(left)


def _with(key: Key, *factors: int) -> Key:
    return tuple(sorted((*key, *factors)))
