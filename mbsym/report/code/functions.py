"""Function bodies in any language, from nodes of a program: names unpacked, assignments, results."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

from mbsym.algebra.base import Lowering
from mbsym.algebra.failures import Failure
from mbsym.algebra.program import Node, Program
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import ZERO, Expression, Name, add, multiply, names, reached, substitute
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import Dialect, Listing, listing
from mbsym.mechanics.variables import program_environment
from mbsym.model.inputs import force_names
from mbsym.model.quantities import marked
from mbsym.model.substitution import images_of_laws
from mbsym.model.system import Parameter, System, acceleration_name
from mbsym.numerics.scenario import exact
from mbsym.report.code.identifiers import number


@dataclass(frozen=True)
class Function:
    """A function's body: which names it unpacks, its assignments, and what it stores."""

    coordinates: tuple[tuple[int, str], ...]
    velocities: tuple[tuple[int, str], ...]
    parameters: tuple[tuple[int, str], ...]
    assignments: tuple[tuple[str, str], ...]
    results: tuple[str, ...]
    time: bool = False
    inputs: tuple[tuple[int, str], ...] = ()
    accelerations: tuple[tuple[int, str], ...] = ()
    forces: tuple[tuple[int, str], ...] = ()


def courses(system: System) -> dict[str, Expression]:
    """What is prescribed, as functions of t: initial + rate*t, and the laws of functions of time with derivatives."""
    steady = {item.name: moving(item.initial, item.rate) for item in system.of_constant_rate}
    return steady | {name: substitute(law, steady) for name, law in images_of_laws(system, {}).items()}


def coded(system: System) -> System:
    """The system as generated code takes it, with what is ``lawless`` behind its parameters."""
    own = lawless(system)
    return replace(system, parameters=(*system.parameters, *own)) if own else system


def lawless(system: System) -> tuple[Parameter, ...]:
    """Functions of time without a law and their derivatives: whoever calls generated code gives their values at t."""
    words = ("function of time, its value at t", "its derivative", "its second derivative")
    return tuple(
        Parameter(name, meaning=f"{what}: {item.meaning}" if item.meaning else what)
        for item in system.given
        if item.law is None
        for name, what in zip(item.names, words, strict=True)
    )


def moving(initial: Expression | None, rate: Expression) -> Expression:
    """initial + rate*t."""
    return add(initial or ZERO, multiply(rate, Name("t")))


def words_of_inputs(system: System) -> frozenset[str]:
    """What generated code calls inputs, where there are any: no name of the description is one of these."""
    return frozenset(("u", "INPUTS", "Inputs", "HELD", "B", "input_matrix", "held")) if system.inputs else frozenset()


class Functions:
    """Turns nodes of a program into function bodies with names that the language lets us use.

    ``propose`` turns a declared name into one of the language, ``pi`` is how the language writes that number.
    """

    def __init__(
        self, system: System, dialect: Dialect, reserved: Collection[str], propose: Callable[[str], str], pi: str
    ) -> None:
        self.system, self.dialect, self.reserved = system, dialect, frozenset(reserved) | words_of_inputs(system)
        if dialect.tables:
            self.reserved |= identifiers(system)
        self.tables: dict[Tabulated, None] = {}  # that are called
        names = [*system.coordinates, *system.velocities, *system.parameter_names]
        names += [*(item.name for item in system.prescribed), *system.input_names, *system.variables]
        names += [*map(acceleration_name, system.coordinates), *force_names(system)]
        self.names = injective(names, propose, taken=self.reserved) | {"t": "t", "pi": pi}

    def function(self, program: Program, outputs: Iterable[Node]) -> Function:
        """A body for the outputs, prescribed quantities computed from the time first."""
        outputs = list(outputs)
        if self.dialect.tables and self.system.tables:
            called = (program.instructions[number].operation for number in program.live(outputs))
            self.tables |= {name: None for name in called if isinstance(name, Tabulated)}
        body = listing(program, outputs, self.names, self.dialect, self.reserved)
        driven = self._prescribed(set(body.inputs), {name for name, _ in body.assignments})
        used = {*body.inputs, *driven.inputs}
        system = self.system
        return Function(
            coordinates=self._unpacked(system.coordinates, used),
            velocities=self._unpacked(system.velocities, used),
            parameters=self._unpacked(system.parameter_names, used),
            assignments=(*driven.assignments, *body.assignments),
            results=body.results,
            time="t" in used,
            inputs=self._unpacked(system.input_names, used),
            accelerations=self._unpacked(tuple(map(acceleration_name, system.coordinates)), used),
            forces=self._unpacked(force_names(system), used),
        )

    def expression(self, value: Expression) -> str:
        """A value of the description as one expression in the names of the language."""
        program = Program()
        node = Lowering(program, program_environment(self.system, program))(value)
        return listing(program, [node], self.names, self.dialect, inline=True).results[0]

    def _unpacked(self, names: Sequence[str], used: set[str]) -> tuple[tuple[int, str], ...]:
        return tuple((place, self.names[name]) for place, name in enumerate(names) if name in used)

    def _prescribed(self, used: set[str], taken: set[str]) -> Listing:
        """The ``courses`` of what occurs."""
        program = Program()
        lower = Lowering(program, program_environment(self.system, program))
        values = {name: lower(course) for name, course in courses(self.system).items() if name in used}
        listed = listing(program, values.values(), self.names, self.dialect, self.reserved | taken)
        named = tuple((self.names[name], x) for name, x in zip(values, listed.results, strict=True))
        return Listing((*listed.assignments, *named), (), listed.inputs)


# Tables in generated code: a search among the knots and a polynomial, one function for each derivative that is used.
#
#     lookup__push__0(x) = f(x),    lookup__push__1(x) = f'(x), at a knot that of the piece behind it
#
# Rows hold the base of a piece and its coefficients by rising powers.  Where a table says nothing outside of its
# points, the value there is NaN.


def identifier(name: Tabulated) -> str:
    """What the function of a table is called."""
    return f"lookup__{name.table.name}__{name.curve.order}"


def identifiers(system: System) -> frozenset[str]:
    """What no other name may be: those of up to four derivatives of all tables, and of their numbers."""
    own = [f"lookup__{table.name}__{order}" for table in system.tables for order in range(5)]
    return frozenset(own + [f"{lookup}_{part}" for lookup in own for part in ("at", "rows")])


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
    lines, line = [], indent
    for item in items:
        if len(line) + len(item) + 2 > width and line.strip():
            lines.append(line.rstrip())
            line = indent
        line += f"{item}, "
    return [*lines, line.rstrip()]


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


# The numbers of a description as generated code holds them: parameters, relations between them, the initial state.


@dataclass(frozen=True)
class Value:
    """A parameter: ``local`` its name in the language, ``text`` its value there, empty where it has none.

    ``needs`` are the parameters that a relation makes it of, in the order of the description.
    """

    name: str
    local: str
    text: str
    meaning: str
    needs: tuple[str, ...] = ()
    unit: str = ""

    @property
    def told(self) -> str:
        """What it means, and its unit."""
        return marked(self.meaning, self.unit).strip()


def parameters_of(system: System, writer: Functions) -> list[Value]:
    """A relation gives a value unless it goes round in a circle; else the description's number does."""
    related = {item.name: item.value for item in system.relations}
    related |= {p.name: p.value for p in system.parameters if p.name not in related and p.value and _made(p.value)}
    values = []
    needed = {name: names(value) for name, value in related.items()}
    for item in system.parameters:
        written, needs = "", set[str]()
        if item.name in related and item.name not in reached(needed, needed[item.name]):
            with suppress(Failure):  # a power that no program has: then its number has to do
                written, needs = writer.expression(related[item.name]), names(related[item.name])
        if not written and item.value is not None and not _made(item.value):
            written = number(exact(item.value, {}))
        unit = system.units.of(item.name) or ""
        used = tuple(name for name in system.parameter_names if name in needs)
        values.append(Value(item.name, writer.names[item.name], written, " ".join(item.meaning.split()), used, unit))
    return values


def _made(value: Expression) -> bool:
    """Whether it is made of other parameters."""
    return bool(names(value) - {"pi"})


def ordered(parameters: Sequence[Value]) -> tuple[Value, ...]:
    """Those without a relation first, then relations, each after what it needs."""
    done = [item for item in parameters if not item.needs]
    left = [item for item in parameters if item.needs]
    while left:
        known = {item.name for item in done}
        ready = [item for item in left if known.issuperset(item.needs)]
        done += ready
        left = [item for item in left if item not in ready]
        assert ready
    return tuple(done)


def initial_values(system: System, writer: Functions) -> list[tuple[str, str]]:
    """(name, value) of q and q'; velocities that are not given are zero, as in simulations."""
    values = {item.coordinate: item for item in system.begun}
    placed: list[tuple[str, str]] = []
    moving: list[tuple[str, str]] = []
    for name, rate in zip(system.coordinates, system.velocities, strict=True):
        entry = values.get(name)
        position = entry.position if entry is not None else None
        velocity = entry.velocity if entry is not None else None
        placed.append((name, "" if position is None else _value(writer, position)))
        moving.append((rate, _value(writer, ZERO if velocity is None else velocity)))
    return placed + moving


def _value(writer: Functions, value: Expression) -> str:
    return writer.expression(value) if _made(value) else number(exact(value, {}))


def starting(system: System, parameters: Sequence[Value]) -> list[tuple[int, str]]:
    """The parameters of which initial values are made: place, and name in the language."""
    values = [x for item in system.begun for x in (item.position, item.velocity) if x is not None]
    used = {name for value in values for name in names(value)}
    return [(place, item.local) for place, item in enumerate(parameters) if item.name in used]
