"""Results that a person can look at: formulas and matrices of the exact ring.

They hold ring polynomials in normal form and print themselves.  Equality and arithmetic are exact, in the ring.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from fractions import Fraction
from math import gcd
from typing import Any, ClassVar

from flint import fmpq

from mbsym.algebra.characteristic import rational_content
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.guessing import GuessesNames
from mbsym.formulas.latex import latex_matrix, latex_text
from mbsym.formulas.letters import lettered
from mbsym.formulas.python import python_text, readable_text
from mbsym.formulas.shape import terms_read
from mbsym.formulas.tree import Angles, angles_as, angles_or
from mbsym.formulas.wolfram import wolfram_text

# How results show themselves: a short line in a console, LaTeX in a notebook.


#: Formulas of more terms than this are counted in a notebook.
LONGEST = 60


class Shown(GuessesNames):
    """A frozen dataclass (declared with ``repr=False``) of formulas, matrices and words."""

    __slots__ = ()

    #: By name what of it tells how long it is: formulas, matrices, other results, or tuples of these.
    counted: ClassVar[tuple[str, ...]] = ()

    @property
    def terms(self) -> int:
        """How many terms that has."""
        return sum(map(_terms, (getattr(self, name) for name in self.counted)))

    def __repr__(self) -> str:
        parts = (f"{name}: {_short(value)}" for name, value in _parts(self))
        return f"{type(self).__name__}({', '.join(parts)})"

    def _repr_latex_(self) -> str:
        lines = [f"\\text{{{_tex(name.replace('_', ' '))}}} &= {_latex(value)}" for name, value in _parts(self)]
        return "$\\displaystyle \\begin{aligned} " + " \\\\ ".join(lines) + " \\end{aligned}$"


def _terms(value: Any) -> int:
    if isinstance(value, (tuple, list)):
        return sum(map(_terms, value))
    return 0 if value is None else int(value.terms)


def _parts(record: Any) -> list[tuple[str, Any]]:
    every = ((field.name, getattr(record, field.name)) for field in fields(record))
    return [(name, value) for name, value in every if not isinstance(value, Ring)]


def _short(value: Any) -> str:
    if isinstance(value, Formula):
        return str(value) if value.terms <= 4 else f"{value.terms} terms"
    if isinstance(value, Matrix):
        return "x".join(map(str, value.shape))
    if isinstance(value, (tuple, list)):
        return f"({', '.join(map(_short, value))})" if _is_short(value) else f"{len(value)} entries"
    if isinstance(value, str):
        return str(value)
    written = repr(value)
    return type(value).__name__ if is_dataclass(value) and len(written) > 80 else written


def _is_short(value: Any) -> bool:
    return len(value) <= 6 and not any(is_dataclass(item) and not isinstance(item, Formula) for item in value)


def _latex(value: Any) -> str:
    if isinstance(value, Formula):
        return value.latex() if value.terms <= LONGEST else f"\\text{{({value.terms} terms)}}"
    if isinstance(value, Matrix):
        return latex_matrix([list(map(_latex, row)) for row in value])
    if isinstance(value, (tuple, list)) and value and all(isinstance(x, Formula) for x in value):
        return latex_matrix([[_latex(x)] for x in value])
    return f"\\text{{{_tex(_short(value))}}}"


_ESCAPES = {
    "\\": "\\textbackslash{}", "{": "\\{", "}": "\\}", "$": "\\$", "&": "\\&", "#": "\\#", "%": "\\%", "_": "\\_",
    "^": "\\textasciicircum{}", "~": "\\textasciitilde{}",
}  # fmt: skip


def _tex(text: str) -> str:
    return "".join(_ESCAPES.get(character, character) for character in text)


@dataclass(frozen=True, eq=False)
class Formula(GuessesNames):
    """One scalar result.

    Formulas of one system, integers and fractions can be added, multiplied, divided and raised to whole and half
    powers; ``subs`` replaces names.  Raises TypeError for floats, ValueError for formulas of different systems,
    SingularPoint (a ZeroDivisionError) for a division by zero.
    """

    ring: Ring
    polynomial: Polynomial

    @property
    def shown(self) -> Formula:
        """What is written of it: the same in the letters of whoever asked for them (``letters_as``)."""
        return Formula(*lettered(self.ring, self.polynomial))

    @property
    def primitive(self) -> Formula:
        """The same over the greatest positive number that divides all its coefficients as they are written."""
        shown = self.shown
        return (
            shown
            if shown.is_zero
            else Formula(shown.ring, shown.polynomial / rational_content(shown.polynomial.coeffs()))
        )

    def __str__(self) -> str:
        return python_text(self.ring, self.polynomial)

    def text(self, angles: Angles = "shorter") -> str:
        """Python syntax for people: sines and cosines in ``products``, in ``sums`` of angles, or what is ``shorter``.

        ``str`` has products, one text for one formula, unless something else is asked for by ``angles_as``.
        """
        with angles_as(angles):
            return python_text(self.ring, self.polynomial)

    def readable(self) -> str:
        """On one line as people write it: ``(m l^2 + J) theta'' + m g l sin(theta)``."""
        return readable_text(self.ring, self.polynomial)

    def latex(self, angles: Angles | None = None) -> str:
        """LaTeX with amsmath; ``angles`` as for ``text``, and what is shorter unless it was asked otherwise."""
        if angles is None:
            return latex_text(self.ring, self.polynomial)
        with angles_as(angles):
            return latex_text(self.ring, self.polynomial)

    def wolfram(self, angles: Angles | None = None) -> str:
        """Wolfram Language; ``angles`` as for ``text``, and products unless it was asked otherwise."""
        if angles is None:
            return wolfram_text(self.ring, self.polynomial)
        with angles_as(angles):
            return wolfram_text(self.ring, self.polynomial)

    def to_sympy(self) -> Any:
        """A SymPy expression in plain symbols: ``theta``, ``theta_dot``, ``Jx``."""
        from mbsym.formulas.arithmetic import to_sympy

        return to_sympy(self.ring, self.polynomial)

    def _sympy_(self) -> Any:
        """What ``sympify`` asks for."""
        return self.to_sympy()

    def subs(self, values: Mapping[str, int | Fraction | str | Formula] | None = None, /, **named: Any) -> Formula:
        """The formula with names replaced, all at once: ``formula.subs(m=2, theta="pi/6", theta_dot=other)``.

        Text is an expression as in a description.  Raises ValueError for an unknown name, with a guess, and as the
        arithmetic does.
        """
        from mbsym.formulas.arithmetic import substituted

        return Formula(*substituted(self, {**(values or {}), **named}))

    def __add__(self, other: object) -> Formula:
        return self._with(other, lambda ring, x, y: ring.reduce(x + y))

    def __sub__(self, other: object) -> Formula:
        return self._with(other, lambda ring, x, y: ring.reduce(x - y))

    def __rsub__(self, other: object) -> Formula:
        return self._with(other, lambda ring, x, y: ring.reduce(y - x))

    def __mul__(self, other: object) -> Formula:
        return self._with(other, lambda ring, x, y: ring.reduce(ring.times(x, y)))

    def __truediv__(self, other: object) -> Formula:
        return self._with(other, lambda ring, x, y: ring.ratio(x, y))

    def __rtruediv__(self, other: object) -> Formula:
        return self._with(other, lambda ring, x, y: ring.ratio(y, x))

    __radd__, __rmul__ = __add__, __mul__

    def __pow__(self, exponent: object) -> Formula:
        from mbsym.formulas.arithmetic import power

        return Formula(*power(self, exponent))

    def __neg__(self) -> Formula:
        return Formula(self.ring, -self.polynomial)

    def __pos__(self) -> Formula:
        return self

    def _with(self, other: object, operation: Callable[[Ring, Polynomial, Polynomial], Polynomial]) -> Formula:
        from mbsym.formulas.arithmetic import together

        operands = together(self, other)
        return NotImplemented if operands is None else Formula(operands[0], operation(*operands))

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def __repr__(self) -> str:
        return f"Formula({self})" if self.terms <= 40 else f"Formula(<{self.terms} terms>)"

    @property
    def terms(self) -> int:
        """The length of the expanded normal form."""
        return len(self.polynomial)

    @property
    def terms_read(self) -> int:
        """The same with the sums of angles that people are shown."""
        return terms_read(self.ring, self.polynomial, angles_or("shorter"))

    @property
    def degree(self) -> int:
        """The total degree of the expanded normal form; 0 for zero."""
        return max((sum(map(int, monomial)) for monomial in self.polynomial.monoms()), default=0)

    @property
    def is_zero(self) -> bool:
        return bool(self.polynomial.is_zero())

    @property
    def is_number(self) -> bool:
        """Whether it is a rational number as it is written."""
        return bool(self.polynomial.is_constant())

    def __eq__(self, other: object) -> bool:
        """Whether the difference is proved zero in the ring.  Formulas of different systems are never equal."""
        if isinstance(other, int):
            other = Formula(self.ring, self.ring.number(other))
        if not isinstance(other, Formula) or other.ring is not self.ring:
            return NotImplemented
        return self.ring.is_zero(self.polynomial - other.polynomial) is True

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, eq=False, repr=False)
class Matrix(GuessesNames):
    """A rectangular array of formulas; indexed ``matrix[i, j]`` from zero."""

    rows: tuple[tuple[Formula, ...], ...]

    @classmethod
    def of(cls, ring: Ring, rows: Sequence[Sequence[Polynomial]]) -> Matrix:
        return cls(tuple(tuple(Formula(ring, x) for x in row) for row in rows))

    @property
    def shape(self) -> tuple[int, int]:
        return len(self.rows), len(self.rows[0]) if self.rows else 0

    def __getitem__(self, place: tuple[int, int]) -> Formula:
        return self.rows[place[0]][place[1]]

    def __iter__(self) -> Iterator[tuple[Formula, ...]]:
        return iter(self.rows)

    @property
    def polynomials(self) -> tuple[tuple[Polynomial, ...], ...]:
        return tuple(tuple(x.polynomial for x in row) for row in self.rows)

    @property
    def is_zero(self) -> bool:
        return all(x.is_zero for row in self.rows for x in row)

    @property
    def terms(self) -> int:
        return sum(x.terms for row in self.rows for x in row)

    def to_sympy(self) -> Any:
        from sympy import Matrix as SymPyMatrix

        return SymPyMatrix([[x.to_sympy() for x in row] for row in self.rows])

    def latex(self) -> str:
        return latex_matrix([[x.latex() for x in row] for row in self.rows])

    @property
    def number_and_rest(self) -> tuple[int, Matrix]:
        """The whole number that stands in front of several entries, and what is left: 3 (b - a, f; f, f)."""
        coefficients = [c for row in self.rows for x in row for c in x.polynomial.coeffs()]
        several = sum(not x.is_zero for row in self.rows for x in row) > 1
        number = gcd(*(int(c.p) for c in coefficients)) if several and all(c.q == 1 for c in coefficients) else 1
        if number == 1:
            return 1, self
        inverse = fmpq(1, number)
        return number, Matrix.of(self.rows[0][0].ring, [[x * inverse for x in row] for row in self.polynomials])

    def _repr_latex_(self) -> str:
        return f"$\\displaystyle {self.latex()}$"

    def __repr__(self) -> str:
        written = "x".join(map(str, self.shape))
        return f"Matrix({self})" if self.terms <= 40 else f"Matrix(<{written}, {self.terms} terms>)"

    def __str__(self) -> str:
        return "[" + ", ".join("[" + ", ".join(map(str, row)) + "]" for row in self.rows) + "]"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Matrix):
            return NotImplemented
        return self.shape == other.shape and self.rows == other.rows

    __hash__ = None  # type: ignore[assignment]


Column = tuple[Formula, ...]


def column(ring: Ring, entries: Sequence[Polynomial]) -> Column:
    return tuple(Formula(ring, x) for x in entries)
