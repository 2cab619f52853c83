"""Tables in generated code: a search among the knots and a polynomial, one function for each derivative that is used.

    lookup__push__0(x) = f(x),    lookup__push__1(x) = f'(x), at a knot that of the piece behind it

Rows hold the base of a piece and its coefficients by rising powers.  Where a table says nothing outside of its points,
the value there is NaN.
"""

from __future__ import annotations

from collections.abc import Iterable

from mbsym.expressions.table import Tabulated
from mbsym.model.system import System
from mbsym.report.numbers import number


def identifier(name: Tabulated) -> str:
    """What the function of a table is called."""
    return f"lookup__{name.table.name}__{name.curve.order}"


def identifiers(system: System) -> frozenset[str]:
    """What no other name may be: those of up to four derivatives of all tables, and of their numbers."""
    own = [f"lookup__{table.name}__{order}" for table in system.tables for order in range(5)]
    return frozenset(own + [f"{one}_{part}" for one in own for part in ("at", "rows")])


def _numbers(name: Tabulated) -> tuple[list[str], list[list[str]]]:
    curve = name.curve
    rows = [(base, *own) for base, own in zip(curve.bases, curve.polynomials, strict=True)]
    return [number(x) for x in curve.knots], [[number(x) for x in row] for row in rows]


def _horner(terms: list[str]) -> str:
    """c0 + u*(c1 + u*(...))."""
    *before, total = terms
    for count, term in enumerate(reversed(before)):
        total = f"{term} + u*{total}" if count == 0 else f"{term} + u*({total})"
    return total


def _lines(items: Iterable[str], indent: str, width: int = 108) -> list[str]:
    """Items with commas behind them, as many on a line as fit."""
    found, line = [], indent
    for item in items:
        if len(line) + len(item) + 2 > width and line.strip():
            found.append(line.rstrip())
            line = indent
        line += f"{item}, "
    return [*found, line.rstrip()]


def c_definition(name: Tabulated) -> str:
    """A static function of C, with its numbers."""
    own, (at, rows) = identifier(name), _numbers(name)
    width = len(rows[0])
    lines = [
        f"static const double {own}_at[{len(at)}] = {{",
        *_lines(at, "    "),
        "};",
        f"static const double {own}_rows[{width * len(rows)}] = {{",
        *_lines((x for row in rows for x in row), "    "),
        "};",
        "",
        f"static double {own}(double x)",
        "{",
        f"    int low = 0, high = {len(at)};",
        "    while (low < high) {",
        "        const int middle = low + (high - low)/2;",
        f"        if (x >= {own}_at[middle])",
        "            low = middle + 1;",
        "        else",
        "            high = middle;",
        "    }",
    ]
    if name.curve.bounded:
        lines += [f"    if (x < {own}_at[0] || x > {own}_at[{len(at) - 1}])", "        return NAN;"]
    terms = [f"row[{k}]" for k in range(1, width)]
    lines.append(f"    const double *row = {own}_rows + {width}*low;")
    if width > 2:
        lines += ["    const double u = x - row[0];", f"    return {_horner(terms)};"]
    else:
        lines.append("    return x == x ? row[1] : x;")
    return "\n".join([*lines, "}", ""])


def python_definition(name: Tabulated, module: str, typed: bool) -> str:
    """Its numbers and a function of Python over arrays of ``module`` (np or jnp); ``typed``: with annotations."""
    own, (at, rows) = identifier(name), _numbers(name)
    columns = list(zip(*rows, strict=True))
    hint = ": Array" if typed else ""
    lines = [f"{own}_at{hint} = {'np.array(' if typed else ''}(", *_lines(at, "    "), f"){')' if typed else ''}"]
    lines.append(f"{own}_rows{hint} = {'np.array(' if typed else ''}(")
    for column in columns:
        lines += ["    (", *_lines(column, "        "), "    ),"]
    lines += [f"){')' if typed else ''}", "", ""]
    lines.append(f"def {own}(x{': Any' if typed else ''}){' -> Any' if typed else ''}:")
    what = name.table.name + "'" * name.curve.order
    lines.append(f'    """The table {what}: {len(at)} knots."""')
    known = own if typed else f"{module}.asarray({own}"
    end = "" if typed else ")"
    lines += [
        f'    row = {known}_rows{end}[:, {module}.searchsorted({known}_at{end}, x, side="right")]',
        "    u = x - row[0]",
    ]
    total = _horner([f"row[{k}]" for k in range(1, len(columns))])
    if name.curve.bounded:
        total = f"{module}.where((x < {known}_at{end}[0]) | (x > {known}_at{end}[-1]), {module}.nan, {total})"
    return "\n".join([*lines, f"    return {total}", ""])
