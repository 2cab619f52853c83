"""Formulas in the Wolfram Language: ``1/2*m*l^2*\\[Theta]'[t]^2``, ``Sin[\\[Theta][t]]``.

Names: ``_`` would make a pattern, and ``N`` or ``Gamma`` mean something else there, so every system has its own
injective renaming.  Numbers are exact quotients; decimals of a description such as 1e-9 are exact quotients too.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from functools import lru_cache

from mbsym.algebra.remembered import remembered
from mbsym.algebra.ring import Generator, ParameterRing, Polynomial, Ring
from mbsym.expressions.rates import derivative_of
from mbsym.expressions.table import OUTSIDE_ZERO, Curve, Table, Tabulated
from mbsym.expressions.tree import Call, Expression, Name, Negative, Number, Operation, children
from mbsym.formulas.letters import lettered
from mbsym.formulas.names import greek, injective, parts
from mbsym.formulas.python import InfixPrinter, declared_name
from mbsym.formulas.shape import printed
from mbsym.formulas.tree import angles_or

_PRIMES = {"velocity": "'", "acceleration": "''"}
_FUNCTIONS = {"sqrt": "Sqrt", "atan": "ArcTan"}
#: Two letters, the first a capital: these are taken.
_SHORT_SYMBOLS = ("Do", "If", "In", "Im", "Re", "Or", "On", "Tr", "Pi", "Up", "By")


def wolfram_text(ring: Ring, polynomial: Polynomial, functions_of_time: bool = True) -> str:
    """The polynomial on one line; coordinates as functions of t, or as plain symbols (``\\[Theta]dot``)."""
    ring, polynomial = lettered(ring, polynomial)
    return printed(
        ring,
        polynomial,
        angles_or("products"),
        ("wolfram", functions_of_time),
        lambda shape: WolframPrinter(ring, functions_of_time).sum(shape),
    )


@lru_cache(4096)
def wolfram_name(name: str) -> str:
    """What a name would like to be called: no underscores, Greek letters, and nothing that Wolfram defines itself."""
    split = parts(name)
    stem = _greek_letter(split.greek) if split.greek else split.stem
    whole = stem + "".join(_greek_letter(greek(index)) if greek(index) else index for index in split.indices)
    return whole + "Par" if _may_be_defined(whole) else whole


def _greek_letter(letter: str) -> str:
    return f"\\[{'Capital' if letter[:1].isupper() else ''}{letter.capitalize()}]" if letter else ""


def _may_be_defined(name: str) -> bool:
    """Wolfram's own names are C, D, E, I, K, N, O and capitalised words (``Jxy`` and ``M2`` are none)."""
    if not name[0].isupper():
        return False
    if len(name) == 1:
        return name in "CDEIKNO"
    if name[1:].strip("xyz0123456789") == "":
        return False
    return len(name) > 2 or name in _SHORT_SYMBOLS


class WolframNames:
    """One renaming for all names of a system, velocities among them; different names stay different."""

    def __init__(self, ring: Ring) -> None:
        plain = ("coordinate", "prescribed", "parameter", "velocity", "acceleration")
        names = [declared_name(g) for g in ring.generators if g.kind in plain and g.name != "pi"]
        self.table = injective(names, wolfram_name, taken=("t", *RESERVED))

    def __getitem__(self, name: str) -> str:
        if name == "pi":
            return "Pi"
        return name if name == "t" else self.table[name]

    def listed(self, names: Iterable[str], suffix: str = "") -> str:
        """``{a[t], b[t]}``."""
        return "{" + ", ".join(self[name] + suffix for name in names) + "}"


#: What the report itself defines.
RESERVED = (
    "coordinates", "parameters", "values", "massMatrix", "forcing", "equations", "initialConditions", "kineticEnergy",
    "forceFunction", "rotation", "angularVelocity", "velocityOrigin", "velocityMassCentre", "linearM", "linearD",
    "linearG", "linearK", "linearN", "subsystems", "characteristicPolynomials", "stabilityConditions", "notation",
    "firstIntegrals", "prescribed", "equilibriumConditions", "lambda", "tau", "tEnd", "dynamics", "mbsymSolution",
    "mbsymRate", "mbsymInitial", "mbsymState", "pieces", "positions", "velocities",
    "speeds", "rates", "needed", "supplied",
    "momenta", "momentaInVelocities", "hamiltonian", "velocitiesInMomenta", "ratesOfMomenta", "canonicalEquations",
    "integralsInMomenta", "poissonBrackets", "routhCoordinates", "ignoredCoordinates", "routhMomenta", "routhFunction",
    "reducedPotential", "routhMassMatrix", "routhForcing", "ignoredRates", "routhEquations",
)  # fmt: skip


@remembered
def wolfram_names(ring: Ring) -> WolframNames:
    """The ring's renaming, made once; a part of a ring has the names of the whole."""
    return wolfram_names(ring.whole) if isinstance(ring, ParameterRing) else WolframNames(ring)


class WolframPrinter(InfixPrinter):
    """``functions_of_time``: coordinates and prescribed quantities as ``x[t]``, velocities as ``x'[t]``."""

    power = "^"

    def __init__(self, ring: Ring, functions_of_time: bool = True) -> None:
        super().__init__(ring)
        self.functions_of_time = functions_of_time
        self.names = wolfram_names(ring)

    def call(self, function: str, argument: str) -> str:
        return wolfram_call(function, argument)

    def symbol(self, generator: Generator) -> str:
        moving = generator.kind in ("coordinate", "prescribed", *_PRIMES)
        if self.functions_of_time and moving:
            kind, name = derivative_of(generator.kind, generator.name)
            return f"{self.names[name]}{_PRIMES.get(kind, '')}[t]"
        return self.names[declared_name(generator)]


def wolfram_call(function: str, argument: str) -> str:
    """A function of one argument, known by Python's name, or a table."""
    if isinstance(function, Tabulated):
        return f"{wolfram_table(function.written)}{chr(39) * function.curve.order}[{argument}]"
    return f"{_FUNCTIONS.get(function, function.capitalize())}[{argument}]"


def wolfram_table(name: str) -> str:
    """The name of a table, which no other name can be."""
    return "table$" + "$".join(name.split("_"))


def wolfram_definition(table: Table) -> str:
    """``table$push[x_] := Piecewise[{{1 + 2*(x - 0), x < 1}, ...}]``: exact; its derivatives are Wolfram's own.

    Outside it goes on as it does here: where nothing is given there, it is ``Indeterminate``.
    """
    curve = table.curve
    written = [
        " + ".join(
            f"({wolfram_number(c)})" + (f"*(x - ({wolfram_number(base)}))" + (f"^{k}" if k > 1 else "") if k else "")
            for k, c in enumerate(polynomial)
            if c or not k
        )
        for base, polynomial in zip(curve.bases, curve.polynomials, strict=True)
    ]
    before, *inner, last = written
    held = ""
    if table.jumps:
        held = _piecewise(table.held, curve, written) + ";\n"
    if table.outside == OUTSIDE_ZERO:
        before = last = "0"
    if curve.bounded:
        before = last = "Indeterminate"
    return held + _piecewise(table.name, curve, [before, *inner, last])


def _piecewise(name: str, curve: Curve, written: Sequence[str]) -> str:
    before, *inner, last = written
    cases = [f"{{{before}, x < {wolfram_number(curve.knots[0])}}}"]
    cases += [
        f"{{{formula}, x <= {wolfram_number(knot)}}}" for formula, knot in zip(inner, curve.knots[1:], strict=True)
    ]
    return f"{wolfram_table(name)}[x_] := Piecewise[{{{', '.join(cases)}}}, {last}]"


def wolfram_expression(expression: Expression, names: WolframNames) -> str:
    """An expression of the description as it stands, in plain symbols.  Raises TypeError for anything else."""
    match expression:
        case Number(value):
            return wolfram_number(value)
        case Name(name):
            return names[name]
        case Negative(operand):
            return f"-{_operand(operand, names)}"
        case Call(_, argument, table=Table() as table):
            return f"{wolfram_table(table.name)}[{wolfram_expression(argument, names)}]"
        case Call(function):
            arguments = [wolfram_expression(child, names) for child in children(expression)]
            if function == "step":
                return f"((1 + Sign[{arguments[0]}])/2)"
            if function == "pulse":
                x, start, end = arguments
                return f"((Sign[{x} - ({start})] - Sign[{x} - ({end})])/2)"
            return wolfram_call(function, arguments[0])
        case Operation(operator, left, right):
            sign = "^" if operator == "**" else operator
            return f"{_operand(left, names)}{sign}{_operand(right, names)}"
    raise TypeError(f"not an expression: {expression!r}")


def _operand(expression: Expression, names: WolframNames) -> str:
    """In brackets unless it is a name, a call or a natural number."""
    written = wolfram_expression(expression, names)
    simple = isinstance(expression, Name | Call) or written.isdigit()
    return written if simple else f"({written})"


def wolfram_number(value: Fraction) -> str:
    """An exact number: 10^-9 rather than a float."""
    return str(value.numerator) if value.denominator == 1 else f"{value.numerator}/{value.denominator}"
