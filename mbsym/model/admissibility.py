"""Which masses and inertias a real body can have.

For a body with density rho >= 0 the second moments P = int rho x x^T are positive semidefinite, and the tensor of
inertia is J = tr(P) 1 - P, that is P = tr(J)/2 1 - J.  So J belongs to a body exactly if P is positive semidefinite;
for principal moments that is the triangle inequality A <= B + C in its three forms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import combinations

from mbsym.expressions.tree import (
    Call,
    Expression,
    Name,
    Negative,
    Number,
    Operation,
    is_number,
    names,
    sign_by_structure,
    text,
)
from mbsym.model.system import Body, System, Tensor

Numbers = tuple[Fraction, Fraction, Fraction]
NumberTensor = tuple[Numbers, Numbers, Numbers]

#: A number longer than this is not worth a check.
_MAX_BITS = 20_000

#: Eigenvalues that are shown are rounded to so many bits, and approached in so many steps (double ones are slow).
_EIGENVALUE_BITS, _NEWTON_STEPS = 192, 200


#: Tensors of inertia are printed in decimals: what is wrong by less than this part of them is rounding.
ROUNDING = Fraction(1, 10**6)

#: An excess smaller than this part of a moment is told, because the moment's own digits do not show it.
_HIDDEN = Fraction(1, 10**4)


def inertia_violation(tensor: NumberTensor, slack: Fraction = Fraction(0)) -> str | None:
    """Why no body has this tensor of inertia, with the inequality in numbers, or None if some body has it.

    With ``slack`` only what is wrong by more than slack tr(J)/2 in an eigenvalue of tr(J)/2 1 - J counts.
    """
    allowed = slack * size_of(tensor)
    for index in range(3):
        if tensor[index][index] < -allowed:
            return f"the moment of inertia about axis {index + 1} is negative: {decimal(tensor[index][index])} < 0"
    if _is_diagonal(tensor):
        for index in range(3):
            others = [tensor[other][other] for other in range(3) if other != index]
            if tensor[index][index] > sum(others, 2 * allowed):
                numbers = _triangle(tensor[index][index], others[0], others[1])
                return f"the moment of inertia about axis {index + 1} exceeds the sum of the other two: {numbers}"
        return None
    if not _is_semidefinite(second_moments(tensor), allowed):
        return f"its principal moments violate the triangle inequality: {_triangle(*principal_values(tensor))}"
    return None


def size_of(tensor: NumberTensor) -> Fraction:
    """tr(J)/2 for the tensor of a body: the trace of its second moments."""
    return sum((abs(tensor[index][index]) for index in range(3)), Fraction(0)) / 2


def _triangle(largest: Fraction, second: Fraction, third: Fraction) -> str:
    """The broken inequality A > B + C, with its excess where the digits do not show it."""
    excess = largest - second - third
    hidden = f" (by {decimal(excess)})" if abs(excess) < _HIDDEN * abs(largest) else ""
    return f"{decimal(largest)} > {decimal(second)} + {decimal(third)}{hidden}"


def principal_values(tensor: NumberTensor) -> Numbers:
    """The eigenvalues of a symmetric matrix, the largest first, to some 40 digits.

    All roots of x^3 - (sum of minors of order 1) x^2 + (those of order 2) x - determinant are real, so that Newton's
    method runs monotonically to the outermost ones from outside.
    """
    minors = list(principal_minors(tensor))
    trace, second, determinant = sum(minors[:3], Fraction(0)), sum(minors[3:6], Fraction(0)), minors[6]
    bound = sum((abs(entry) for row in tensor for entry in row), Fraction(0))

    def outermost(x: Fraction) -> Fraction:
        for _ in range(_NEWTON_STEPS):
            value = ((x - trace) * x + second) * x - determinant
            slope = (3 * x - 2 * trace) * x + second
            if not value or not slope:
                break
            x = Fraction(round((x - value / slope) / bound * 2**_EIGENVALUE_BITS), 2**_EIGENVALUE_BITS) * bound
        return x

    if not bound:
        return Fraction(0), Fraction(0), Fraction(0)
    largest, least = outermost(2 * bound), outermost(-2 * bound)
    return largest, trace - largest - least, least


def offset_violation(
    tensor: NumberTensor,
    mass: Fraction,
    centre: Numbers,
    axes: Sequence[int] = (0, 1, 2),
    slack: Fraction = Fraction(0),
) -> str | None:
    """Why no body with the inertia ``tensor`` about O has its mass centre at ``centre`` from O, or None if some has.

    About the axis i through O the mass alone, were it all at its centre, has m (c.c - c_i^2); no body has less.  What
    is left about the mass centre must be the inertia of a body.  Where only some moments were meant, ``axes`` are
    theirs.  ``slack`` is a part of the tensor about O, in which rounding was done.
    """
    square = sum((component * component for component in centre), Fraction(0))
    for index in axes:
        least = mass * (square - centre[index] * centre[index])
        if tensor[index][index] < least - slack * size_of(tensor):
            numbers = f"{decimal(tensor[index][index])} < {_offset_words(index)} = {decimal(least)}"
            return f"moved to the mass centre, the moment of inertia about axis {index + 1} is negative: {numbers}"
    moved = about_mass_centre(tensor, mass, centre)
    share = slack * size_of(tensor) / size_of(moved) if size_of(moved) else slack
    violation = inertia_violation(moved, share) if len(axes) == 3 else None
    return None if violation is None else f"moved to the mass centre, {violation}"


def body_violation(body: Body, values: Mapping[str, Fraction], slack: Fraction = Fraction(0)) -> str | None:
    """Why the numbers of a body exclude its inertia, beyond the slack; None where they do not, or are not all known."""
    tensor = None if body.inertia is None else numeric_tensor(body.inertia.tensor, values)
    if body.inertia is None or tensor is None:
        return None
    violation = inertia_violation(tensor, slack)
    if violation is None and body.inertia.about == "joint":
        mass, centre = number_of(body.mass, values), numeric_vector(body.mass_centre, values)
        if mass is not None and centre is not None:
            violation = offset_violation(tensor, mass, centre, slack=slack)
    return violation


def has_negative_energy(body: Body, values: Mapping[str, Fraction]) -> bool:
    """Whether the numbers say for sure that the body's kinetic energy is negative for some motion, beyond rounding.

    It is m V_C.V_C/2 + w.J_C w/2, with the tensor J_C about the mass centre.
    """
    tensor = None if body.inertia is None else numeric_tensor(body.inertia.tensor, values)
    if body.inertia is None or tensor is None:
        return False
    allowed = ROUNDING * size_of(tensor)
    if body.inertia.about == "joint":
        mass, centre = number_of(body.mass, values), numeric_vector(body.mass_centre, values)
        if mass is not None and centre is not None:
            tensor = about_mass_centre(tensor, mass, centre)
    return not _is_semidefinite(tensor, allowed)


def numeric_tensor(tensor: Tensor, values: Mapping[str, Fraction]) -> NumberTensor | None:
    """The tensor in numbers, or None where a name has no value."""
    rows = [numeric_vector(row, values) for row in tensor]
    if rows[0] is None or rows[1] is None or rows[2] is None:
        return None
    return rows[0], rows[1], rows[2]


def numeric_vector(vector: Sequence[Expression], values: Mapping[str, Fraction]) -> Numbers | None:
    """The vector in numbers, or None where a name has no value."""
    first, second, third = (number_of(component, values) for component in vector)
    return None if first is None or second is None or third is None else (first, second, third)


def _offset_words(index: int) -> str:
    first, second = (other + 1 for other in range(3) if other != index)
    return f"m (c{first}^2 + c{second}^2)"


def symbolic_violation(
    tensor: Tensor, mass: Expression, centre: Sequence[Expression], about_joint: bool, signs: Mapping[str, str]
) -> str | None:
    """What the signs of the parameters alone decide: a principal moment larger than the other two together, or smaller
    than m (c.c - c_i^2) allows.  None if they decide nothing.
    """
    for index in range(3):
        others = [other for other in range(3) if other != index]
        if about_joint:
            squares = [Operation("*", centre[other], centre[other]) for other in others]
            lever = Operation("+", squares[0], squares[1])
            left = Operation("-", tensor[index][index], Operation("*", mass, lever))
            if _surely_negative_sum(left, signs):
                reason = f"{text(tensor[index][index])} < {_offset_words(index)}"
                return f"moved to the mass centre, the moment of inertia about axis {index + 1} is negative: {reason}"
        if all(is_number(tensor[row][column], 0) for row in range(3) for column in range(3) if row != column):
            first, second = (tensor[other][other] for other in others)
            if _surely_negative_sum(Operation("-", Operation("+", first, second), tensor[index][index]), signs):
                reason = f"{text(tensor[index][index])} > {text(first)} + {text(second)}"
                return f"the moment of inertia about axis {index + 1} exceeds the sum of the other two: {reason}"
    return None


#: Sums longer than this are not looked at.
_MAX_MONOMIALS = 200
_Monomials = dict[tuple[tuple[str, int], ...], Fraction]


def _surely_negative_sum(expression: Expression, signs: Mapping[str, str]) -> bool:
    """Whether, multiplied out, nothing but negative multiples of products of positive parameters is left."""
    terms = _monomials(expression)
    if not terms or any(coefficient >= 0 for coefficient in terms.values()):
        return False
    return all(signs.get(name) == "positive" or name == "pi" for monomial in terms for name, _ in monomial)


def _monomials(expression: Expression) -> _Monomials | None:
    """Coefficients by monomials, or None for what is no polynomial (in names and their reciprocals) of modest size."""
    match expression:
        case Number(value):
            return {(): value} if value else {}
        case Name(name):
            return {((name, 1),): Fraction(1)}
        case Negative(operand):
            inner = _monomials(operand)
            return None if inner is None else {key: -value for key, value in inner.items()}
        case Operation("**", base, Number(exponent)) if exponent.denominator == 1 and abs(exponent) <= 8:
            inner, power = _monomials(base), int(exponent)
            if inner is None or (power < 0 and len(inner) != 1):
                return None
            if power < 0:
                ((key, value),) = inner.items()
                inner = {tuple((name, -degree) for name, degree in key): 1 / value}
            result: _Monomials | None = {(): Fraction(1)}
            for _ in range(abs(power)):
                result = None if result is None else _product(result, inner)
            return result
        case Operation(operator, left, right) if operator in ("+", "-", "*", "/"):
            other = Operation("**", right, Number(Fraction(-1))) if operator == "/" else right
            first, second = _monomials(left), _monomials(other)
            if first is None or second is None:
                return None
            if operator in ("*", "/"):
                return _product(first, second)
            return _sum(first, second, 1 if operator == "+" else -1)
    return None


def _sum(first: _Monomials, second: _Monomials, sign: int) -> _Monomials:
    total = dict(first)
    for key, value in second.items():
        total[key] = total.get(key, Fraction(0)) + sign * value
    return {key: value for key, value in total.items() if value}


def _product(first: _Monomials, second: _Monomials) -> _Monomials | None:
    if len(first) * len(second) > _MAX_MONOMIALS:
        return None
    total: _Monomials = {}
    for monomial, a in first.items():
        for other, b in second.items():
            degrees = dict(monomial)
            for name, degree in other:
                degrees[name] = degrees.get(name, 0) + degree
            key = tuple(sorted((name, degree) for name, degree in degrees.items() if degree))
            total[key] = total.get(key, Fraction(0)) + a * b
    total = {key: value for key, value in total.items() if value}
    return total if all(map(_is_short, total.values())) else None


def decimal(value: Fraction) -> str:
    """A number as a message shows it."""
    try:
        return f"{float(value):.10g}"
    except OverflowError:
        return "a huge number"


def impossible_alone(tensor: Tensor, signs: Mapping[str, str], values: Mapping[str, Fraction]) -> int | None:
    """The index of the only moment of inertia, if it is positive by its sign or value: 0 + 0 cannot reach it."""
    if any(not is_number(tensor[row][column], 0) for row in range(3) for column in range(3) if row != column):
        return None
    alone = [index for index in range(3) if not is_number(tensor[index][index], 0)]
    if len(alone) != 1:
        return None
    moment = tensor[alone[0]][alone[0]]
    return alone[0] if sign_by_structure(moment, signs) == "positive" or (number_of(moment, values) or 0) > 0 else None


def _is_diagonal(tensor: NumberTensor) -> bool:
    return not any(tensor[row][column] for row in range(3) for column in range(3) if row != column)


def second_moments(tensor: NumberTensor) -> NumberTensor:
    """P = tr(J)/2 1 - J, the tensor of second moments."""
    half = (tensor[0][0] + tensor[1][1] + tensor[2][2]) / 2
    return _tensor(lambda row, column: (half if row == column else Fraction(0)) - tensor[row][column])


def _tensor(entry: Callable[[int, int], Fraction]) -> NumberTensor:
    rows = [(entry(row, 0), entry(row, 1), entry(row, 2)) for row in range(3)]
    return rows[0], rows[1], rows[2]


def _is_semidefinite(matrix: NumberTensor, allowed: Fraction) -> bool:
    """Whether no eigenvalue is less than ``-allowed``."""
    raised = _tensor(lambda row, column: matrix[row][column] + (allowed if row == column else 0))
    return all(minor >= 0 for minor in principal_minors(raised))


def principal_minors(matrix: NumberTensor) -> Iterator[Fraction]:
    """All principal minors: a symmetric matrix is positive semidefinite exactly if none is negative."""
    for size in (1, 2, 3):
        for chosen in combinations(range(3), size):
            yield _determinant([[matrix[row][column] for column in chosen] for row in chosen])


def _determinant(matrix: list[list[Fraction]]) -> Fraction:
    if len(matrix) == 1:
        return matrix[0][0]
    total = Fraction(0)
    for column, entry in enumerate(matrix[0]):
        minor = [row[:column] + row[column + 1 :] for row in matrix[1:]]
        total += (-1) ** column * entry * _determinant(minor)
    return total


def about_mass_centre(tensor: NumberTensor, mass: Fraction, centre: Numbers) -> NumberTensor:
    """The parallel-axis theorem: J_C = J_O - m (c.c 1 - c c^T), with c from O to the mass centre."""
    square = sum((component * component for component in centre), Fraction(0))
    return _tensor(
        lambda row, column: (
            tensor[row][column] - mass * ((square if row == column else Fraction(0)) - centre[row] * centre[column])
        )
    )


def number_of(expression: Expression, values: Mapping[str, Fraction]) -> Fraction | None:
    """The exact value where the names have values, or None where it is not rational, not known or absurdly long."""
    result: Fraction | None = None
    match expression:
        case Number(value):
            result = value
        case Name(name):
            result = values.get(name)
        case Negative(operand):
            inner = number_of(operand, values)
            result = None if inner is None else -inner
        case Operation(operator, left, right):
            first, second = number_of(left, values), number_of(right, values)
            if first is not None and second is not None:
                result = _combine(operator, first, second)
        case Call():
            result = None
    return result if result is None or _is_short(result) else None


def _is_short(value: Fraction) -> bool:
    return value.numerator.bit_length() + value.denominator.bit_length() <= _MAX_BITS


def _combine(operator: str, first: Fraction, second: Fraction) -> Fraction | None:
    match operator:
        case "+":
            return first + second
        case "-":
            return first - second
        case "*":
            return first * second
        case "/":
            return first / second if second else None
    if second.denominator != 1 or (not first and second < 0):
        return None
    size = first.numerator.bit_length() + first.denominator.bit_length()
    return first**second.numerator if size * abs(second.numerator) <= _MAX_BITS else None


def known_values(system: System) -> dict[str, Fraction]:
    """The exact values of the parameters that have any, relations included."""
    values: dict[str, Fraction] = {}
    for parameter in system.parameters:
        value = None if parameter.value is None else number_of(parameter.value, {})
        if value is not None:
            values[parameter.name] = value
    waiting = {relation.name: relation.value for relation in system.relations if relation.name not in values}
    needs = {name: names(value) for name, value in waiting.items()}
    while ready := [name for name in waiting if needs[name] <= values.keys()]:
        for name in ready:
            value = number_of(waiting.pop(name), values)
            if value is not None:
                values[name] = value
    return values
