"""What every export holds, as text of a language but for its syntax: values, initial state, function bodies.

A language is how it writes operations, numbers and names; its template says how functions and arrays look.  All
functions are functions of (t, x, p) with the state x = (q, q') and the parameters p in the order of the description;
of (t, x, p, u) where the system has inputs u.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from textwrap import wrap
from typing import TYPE_CHECKING

from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import text
from mbsym.formulas.straight_line import Dialect
from mbsym.model.quantities import told_units
from mbsym.model.system import System
from mbsym.report.code.functions import (
    Function,
    Functions,
    Value,
    coded,
    courses,
    initial_values,
    lawless,
    ordered,
    parameters_of,
    starting,
)
from mbsym.report.code.identifiers import camel, prefix_of
from mbsym.report.code.model_code import NamedIntegral, Part, first_integrals, parts

if TYPE_CHECKING:
    from mbsym.analysis import Analysis

#: What exports call their functions and tables; no local name of theirs is one of these.
_WORDS = """
    t x p result name given values missing unknown parameters initial_state mass_matrix forcing energy
    generalized_energy accelerations right_hand_side jacobian integrals joints mass_centres coriolis gravity
    inverse_dynamics forward_dynamics qdd tau
"""
COMMON = frozenset(_WORDS.split())
#: What they call besides where there are constraints, or reactions are asked for.
_FURTHER = """
    constraints constraint_velocity constraint_jacobian constraint_acceleration multipliers position_correction
    velocity_correction consistent steps reactions q qd
"""
FURTHER = frozenset(_FURTHER.split())

PI = "3.141592653589793"


@dataclass(frozen=True)
class Language:
    """``propose`` turns a declared name into one of the language; none of ``reserved`` is used."""

    dialect: Dialect
    reserved: frozenset[str]
    propose: Callable[[str], str]
    time: str = "t"


@dataclass(frozen=True)
class Written:
    """A function: its body, and what stands where in its result; other places are zero.

    ``argument``: ``, qdd`` or ``, tau`` where it takes that besides the state, and no inputs.
    """

    name: str
    words: str
    shape: tuple[int, ...]
    body: Function
    entries: tuple[tuple[tuple[int, ...], str], ...]
    argument: str = ""

    def rows(self, zero: str) -> list[list[str]]:
        """The result of a matrix, of a column in rows of one."""
        table = dict(self.entries)
        height, width = (*self.shape, 1)[:2]
        columns = len(self.shape) == 2
        return [[table.get((i, j) if columns else (i,), zero) for j in range(width)] for i in range(height)]


def told_in(system: System) -> str:
    """Which variables the states are, of a system that declares others; nothing otherwise."""
    if not system.speeds:
        return ""
    others = ", ".join(system.variables)
    return f"The states are coordinates and their velocities: {others} of the description are none here."


@dataclass(frozen=True)
class Export:
    """``parameters`` in the order of the description; ``initial`` the texts of x(0), empty for a position not given.

    ``ordered``: parameters such that relations come after what they need.  ``further`` are functions with another
    argument, and of single frames.
    """

    system: System
    prefix: str
    functions: tuple[Written, ...]
    parameters: tuple[Value, ...]
    ordered: tuple[Value, ...]
    initial: tuple[tuple[str, str], ...]
    integrals: tuple[NamedIntegral, ...]
    lacking: tuple[str, ...]
    names: dict[str, str] = field(compare=False)
    tables: tuple[Tabulated, ...] = ()
    further: tuple[Written, ...] = ()

    @property
    def law(self) -> str:
        """The equations that the functions hold."""
        return "M(q) q'' = f(q, q', t) + J^T lambda" if self.system.constraints else "M(q) q'' = f(q, q', t)"

    @property
    def told_in(self) -> str:
        """What is said where the description has other variables than coordinates and their velocities."""
        return told_in(self.system)

    @property
    def tied(self) -> list[str]:
        """Lines about constraints; none without any."""
        if not self.has("multipliers"):
            return []
        first = ["phi(q, t) = 0", "J q' + j = 0"] if self.has("constraints") else ["J q' + j = 0"]
        words = (
            f"Constraints: {', '.join(first)}, J q'' + gamma = 0; M and f are those of the bodies without them. "
            "x' keeps the rates of the constraints, so that integration drifts from them by its errors: consistent "
            "leads a state back, whose constraint_velocity"
            + (" and constraints tell" if self.has("constraints") else " tells")
            + " what is left. Where J M^-1 J^T is singular (links in line, dependent constraints) or M is, results are "
            "not finite, or by rounding finite and worthless."
        )
        return wrap(words, 100, break_long_words=False)

    @property
    def driven(self) -> str:
        """What stands behind (t, x, p in arguments: the inputs, where there are any."""
        return ", u" if self.system.inputs else ""

    @property
    def held(self) -> str:
        """The values of the inputs on the unperturbed motion, as the description writes them."""
        return ", ".join(f"{signal.name} = {text(signal.held)}" for signal in self.system.inputs)

    @property
    def moving(self) -> list[str]:
        """Which of the parameters are values of functions of time and their derivatives."""
        return [item.name for item in lawless(self.system)]

    @property
    def type_name(self) -> str:
        """As types and modules are called."""
        return camel(self.prefix)

    @property
    def relations(self) -> list[tuple[str, str]]:
        """As the description writes them."""
        return [(item.name, text(item.value)) for item in self.system.relations]

    @property
    def prescribed(self) -> list[tuple[str, str]]:
        """As the description writes them."""
        return [(name, text(course)) for name, course in courses(self.system).items()]

    @property
    def units(self) -> list[str]:
        """Lines that tell the units of t, the state and energies; none for a description without units."""
        told = ", ".join(told_units(self.system))
        return wrap(f"Units: {told}.", 100, break_long_words=False) if told else []

    @property
    def starting(self) -> list[tuple[int, str]]:
        """The parameters of which initial values are made: place, and name in the language."""
        return starting(self.system, self.parameters)

    @property
    def unplaced(self) -> list[str]:
        """The coordinates whose initial positions are not given."""
        return [name for name, value in self.initial if not value]

    def has(self, name: str) -> bool:
        """Whether there is a function of that name."""
        return any(item.name == name for item in self.functions)


def export(
    analysis: Analysis,
    problems: Sequence[int],
    language: Language,
    shared: Collection[str] | None = None,
    further_too: bool = False,
) -> Export:
    """The system's code in a language.

    ``shared`` names functions that stand in one scope: there are only these, those of one program have one body in
    common, and no local name is used twice.  ``further_too``: functions with another argument, too.

    Raises NoClosedForm for a number beyond the range of double.
    """
    system = coded(analysis.system)
    made, lacking = parts(analysis, problems, shared is None)
    further = FURTHER if system.constraints or system.reactions else frozenset()
    writer = Functions(system, language.dialect, language.reserved | further, language.propose, PI)
    writer.names["t"] = language.time
    parameters = parameters_of(system, writer)
    further_functions: list[Written] = []
    if shared is None:
        functions = [function for part in made if not part.further for function in _written(writer, [part])]
        if further_too:
            further_functions = [function for part in made if part.further for function in _written(writer, [part])]
    else:
        functions = list(_in_one_scope(writer, [part for part in made if part.name in shared]))
    return Export(
        system=system,
        prefix=prefix_of(system.name),
        functions=tuple(functions),
        parameters=tuple(parameters),
        ordered=ordered(parameters),
        initial=tuple(initial_values(system, writer)),
        integrals=first_integrals(analysis, problems).named,
        lacking=(*lacking, *filter(None, [told_in(analysis.system)])),
        names=writer.names,
        tables=tuple(writer.tables),
        further=tuple(further_functions),
    )


def _written(writer: Functions, made: Sequence[Part]) -> list[Written]:
    """Parts of one program, with one body for all of them."""
    body = writer.function(made[0].program, [node for part in made for node in part.entries.values()])
    results = iter(body.results)
    return [
        Written(
            part.name,
            part.words,
            part.shape,
            body,
            tuple((place, next(results)) for place in part.entries),
            f", {part.argument}" if part.argument else "",
        )
        for part in made
    ]


def _in_one_scope(writer: Functions, made: Sequence[Part]) -> Iterator[Written]:
    for program in dict.fromkeys(part.program for part in made):
        functions = _written(writer, [part for part in made if part.program is program])
        writer.reserved |= {name for name, _ in functions[0].body.assignments}
        yield from functions
