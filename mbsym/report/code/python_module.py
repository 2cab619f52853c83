"""``model.py``: one self-contained module of the equations, its code taken from the straight-line program.

It needs NumPy alone, but for ``python model.py``, which simulates with SciPy and plots with Matplotlib.
"""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from textwrap import fill, wrap
from typing import TYPE_CHECKING

from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import Failure, Limit, NoClosedForm
from mbsym.algebra.program import Node, Program
from mbsym.expressions.table import Tabulated
from mbsym.expressions.tree import Expression, names, text
from mbsym.formulas.formula import Formula
from mbsym.formulas.names import injective
from mbsym.formulas.straight_line import Dialect, angle_name, listing
from mbsym.mechanics.variables import program_environment
from mbsym.model.quantities import told_units, unit_of
from mbsym.model.speeds import Quaternion
from mbsym.model.system import System, rational
from mbsym.problems.linearisation import Linearisation
from mbsym.report.code.functions import (
    Function,
    Functions,
    coded,
    courses,
    identifier,
    initial_values,
    lawless,
    ordered,
    parameters_of,
    python_definition,
    starting,
    words_of_inputs,
)
from mbsym.report.code.identifiers import prefix_of
from mbsym.report.code.model_code import first_integrals, functions_of, programs_of, solved, undetermined
from mbsym.report.code.named_dynamics import bodies, named_dynamics
from mbsym.report.environment import rendered
from mbsym.report.sections import section_of

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.report.words.expansion_words import Sums


#: What the module itself calls something.
RESERVED = {
    *keyword.kwlist, *dir(builtins), "np", "Mapping", "q", "qd", "p", "t", "x", "M", "D", "G", "K", "N", "f", "n",
    "result", "velocities", "accelerations", "annotations", "COORDINATES", "PARAMETERS", "DEFAULTS", "mass_matrix",
    "forcing", "rhs", "energy", "generalized_energy", "linear_matrices", "jacobian", "integrals", "values", "zero",
    "main", "simulate", "complete", "initial_state", "given", "npt", "Any", "Sequence", "TypeAlias", "Array", "NAME",
    "Parameters", "INTEGRALS", "UNITS", "with_unit", "LINEAR",
    "polynomial_integrals", "invariant_sets", "normal_forms", "small_parameters", "missing", "name",
    "slow_manifold", "slow_flow", "periodic_solution",
    "SPEEDS", "POSITIONS", "speed_state", "speed_rhs", "speed_restored",
    "speed_simulate", "y", "right", "matrix", "FRAMES", "frame", "frame_pose", "frame_jacobian", "qdd", "tau",
    "coriolis", "gravity", "inverse_dynamics", "forward_dynamics",
}  # fmt: skip
#: What a module of a constrained system calls something besides.
TIED = frozenset({
    "constraints", "constraint_velocity", "constraint_jacobian", "constraint_acceleration", "multipliers",
    "constraint_error", "consistent", "matrix", "jacobian", "right", "whole", "above", "error", "worst", "reactions",
    "DEPENDENT", "GIVEN", "mass", "scale", "sizes", "unknown", "step", "basis", "free", "rows", "root", "what", "size",
})  # fmt: skip

#: What a module that has Hamilton's or Routh's form calls something besides.
IN_MOMENTA = frozenset({
    "MOMENTA", "CANONICAL_POSITIONS", "canonical_state", "hamiltonian", "canonical_rhs", "constants", "LEFT", "IGNORED",
    "CONSTANTS", "reduced_state", "reduced_rhs", "reduced_potential", "ignored_rates", "places", "s",
})  # fmt: skip

_NUMPY = {"atan": "arctan"}
_WORD = re.compile("[a-z]+")


def _called(function: str) -> str:
    return identifier(function) if isinstance(function, Tabulated) else f"np.{_NUMPY.get(function, function)}"


DIALECT = Dialect(call=lambda function, argument: f"{_called(function)}({argument})", angle=angle_name, tables=True)


def render(analysis: Analysis, problems: Sequence[int]) -> str:
    """The module's text."""
    from mbsym.analysis import PROBLEMS

    system, (code, no_code) = coded(analysis.system), programs_of(analysis)
    writer = _Module(system, bool(analysis.forms))
    tied = None
    if system.constraints:
        from mbsym.report.code.constrained_code import tied_code

        tied = tied_code(analysis, writer)
    speeds = None
    if system.speeds and (tied or not system.constraints):
        from mbsym.report.code.speed_code import speed_code

        speeds = speed_code(analysis, writer)
    forms = None
    if analysis.forms:
        from mbsym.report.code.canonical_code import canonical_code

        forms = canonical_code(analysis, problems, writer)
    named = named_dynamics(analysis) if code else None
    n = len(system.coordinates)
    functions, places = functions_of(analysis, writer)
    known = solved(analysis)
    conserved = first_integrals(analysis, problems)
    parameters = parameters_of(system, writer)
    linear = analysis.stage(5) if 5 in problems else None
    if linear is not None and linear.failure is None and linear.value.varying:
        linear = None  # functions of the parameters alone
    units = told_units(system)
    matrices = gains = None
    if linear is not None and linear.failure is None:
        matrices, gains = writer.linear(analysis, linear.value), writer.gains(analysis, linear.value)
    linear_names: tuple[str, ...] = ()
    following = False
    if linear is not None and linear.failure is None and linear.value.coordinates != system.coordinates:
        linear_names, following = linear.value.coordinates, bool(linear.value.about.following)
    return rendered(
        "model.py.j2",
        {},
        system=system,
        title=plain(system.name),
        description=fill(plain(system.description), 110),
        n=n,
        defaults=[(item.name, default(item.value)) for item in system.parameters],
        meanings=[(item.name, plain(item.told)) for item in parameters if item.told],
        units=wrap(f"Units: {', '.join(units)}.", 110, break_long_words=False) if units else [],
        axes=[
            (name, unit) for name in ("t", *system.coordinates, *system.velocities) if (unit := unit_of(system, name))
        ],
        relations=[(item.name, text(item.value)) for item in system.relations],
        prescribed=[(name, text(course)) for name, course in courses(system).items()],
        moving=[item.name for item in lawless(system)],
        no_code=plain(no_code),
        tied=tied,
        speeds=speeds,
        quaternions=any(isinstance(rotation, Quaternion) for body in system.bodies for rotation in body.orientation),
        forms=forms,
        lacking=[plain(line) for line in forms.lacking] if forms else [],
        upper=[(i, j) for i in range(n) for j in range(i, n)],
        **functions,
        prefix=prefix_of(system.name),
        example=f"{next(iter(system.parameter_names), next(iter(system.coordinates), 'x'))}=2",
        integrals=conserved,
        formulas=[
            replace(
                function, results=tuple((plain(key), x) for key, x in function.results), missing=plain(function.missing)
            )
            for function in formula_functions(analysis, problems, writer)
        ],
        titles={number: PROBLEMS[number].title for number in problems},
        named=named and bodies(named, writer, plain),
        without=wrap(named.told_without, 110, break_long_words=False) if named else [],
        conserved=writer.function(conserved.program, conserved.nodes) if conserved.nodes else None,
        slopes=functions["jacobian"] and (functions["jacobian"], places),
        no_slopes=plain(known.no_slopes or known.no_forward),
        no_reactions=plain(known.no_reactions),
        undetermined=wrap(plain(undetermined(analysis)), 112, break_long_words=False),
        related=[item for item in ordered(parameters) if item.needs],
        names=writer.names,
        initial=initial_values(system, writer),
        starting=starting(system, parameters),
        linear=matrices,
        linear_names=linear_names,
        linear_size=len(linear_names) or n,
        following=following,
        gains=gains,
        held=writer.held(),
        input_meanings=[(signal.name, plain(signal.meaning)) for signal in system.inputs if signal.meaning],
        lookups=[python_definition(table, "np", typed=True) for table in writer.tables],
        unavailable="" if linear is None or linear.failure is None else plain(linear.failure.reason),
    )


def plain(words: str) -> str:
    """Text that may stand in a docstring or a comment."""
    return " ".join(words.replace("\\", "/").replace('"', "'").split())


def default(value: Expression | None) -> str:
    """A number as Python reads it, or None: nothing is made up."""
    if value is None:
        return "None"
    number = rational(value)
    if number is None:
        if names(value) - {"pi"}:
            return "None"
        program = Program()
        node = Lowering(program, {"pi": program.input("pi")})(value)
        listed = listing(program, [node], {"pi": "np.pi"}, DIALECT)
        # A part that occurs twice would want a line of its own, which a table has not.
        return _WORD.sub(_in_numpy, text(value)) if listed.assignments else listed.results[0]
    return str(number.numerator) if number.denominator == 1 else _decimal(number)


def _in_numpy(word: re.Match[str]) -> str:
    return f"np.{_NUMPY.get(word[0], word[0])}"


def _decimal(number: Fraction) -> str:
    try:
        shown = repr(float(number))
    except OverflowError:
        raise NoClosedForm("a number in it is beyond 1.8e308, where floats end", limit=Limit.DIGITS) from None
    return shown if Fraction(shown) == number else f"{number.numerator} / {number.denominator}"


class _Module(Functions):
    """Turns nodes of a program into function bodies with names that Python lets us use."""

    def __init__(self, system: System, in_momenta: bool = False) -> None:
        reserved = RESERVED | words_of_inputs(system) | (TIED if system.constraints else frozenset())
        if system.reactions:
            reserved |= {"reactions", "REACTIONS", "zero"}
        if in_momenta:
            reserved |= IN_MOMENTA
        super().__init__(system, DIALECT, reserved, lambda name: name + "_" if name in reserved else name, "np.pi")

    def linear(self, analysis: Analysis, linearisation: Linearisation) -> tuple[Function, list[tuple[str, int, int]]]:
        """M, D, G, K, N entry by entry, zeros left out."""
        program = Program()
        carry = Carrier(analysis.ring, program, program_environment(self.system, program))
        places, nodes = [], []
        for name, matrix in zip("MDGKN", linearisation.matrices, strict=True):
            for i, row in enumerate(matrix):
                for j, entry in enumerate(row):
                    if not entry.is_zero:
                        places.append((name, i, j))
                        nodes.append(carry(entry.polynomial))
        return self.function(program, nodes), places

    def gains(self, analysis: Analysis, linearisation: Linearisation) -> tuple[Function, list[tuple[int, int]]] | None:
        """B entry by entry, zeros left out; None without inputs."""
        if linearisation.B is None:
            return None
        program = Program()
        carry = Carrier(analysis.ring, program, program_environment(self.system, program))
        entries = [(i, k, x) for i, row in enumerate(linearisation.B) for k, x in enumerate(row) if not x.is_zero]
        return self.function(program, [carry(x.polynomial) for _, _, x in entries]), [(i, k) for i, k, _ in entries]

    def held(self) -> Function | None:
        """The values of the inputs on the unperturbed motion; None without inputs."""
        if not self.system.inputs:
            return None
        program = Program()
        lower = Lowering(program, program_environment(self.system, program))
        return self.function(program, [lower(signal.held) for signal in self.system.inputs])


# Problems 9 to 12 in ``model.py``: a function for each, with every formula of its result by what it is.


#: What a formula is, and the formula.
Told = tuple[str, Formula]

#: The problems from here on have their formulas in functions.
FIRST = 9


@dataclass(frozen=True)
class FormulaFunction:
    """A function of a module: ``unpacked`` are declared names and what the code calls them, ``results`` by what they
    are.  ``missing``: why there is none.  ``of_time``: the time t is an argument of its own.
    """

    number: int
    name: str
    unpacked: tuple[tuple[str, str], ...] = ()
    assignments: tuple[tuple[str, str], ...] = ()
    results: tuple[tuple[str, str], ...] = ()
    missing: str = ""
    contents: str = "formulas"
    of_time: bool = False


def formula_functions(analysis: Analysis, problems: Sequence[int], writer: Functions) -> list[FormulaFunction]:
    """Of those problems that are asked for and have formulas."""
    from mbsym.analysis import PROBLEMS

    functions = []
    for number in (number for number in problems if number >= FIRST):
        stage, name = analysis.stage(number), PROBLEMS[number].attribute
        if stage.failure is not None:
            functions.append(FormulaFunction(number, name, missing=stage.failure.reason))
            continue
        formulas = list(section_of(PROBLEMS[number]).formulas(stage.value, analysis.system))
        if not formulas:
            continue
        sums = getattr(section_of(PROBLEMS[number]), "functions", None)
        try:
            functions.append(_function(number, name, formulas, writer))
            functions += [_of_sums(number, series, writer) for series in (sums(stage.value) if sums else ())]
        except Failure as reason:
            functions.append(FormulaFunction(number, name, missing=str(reason)))
    return functions


def _function(number: int, name: str, formulas: Sequence[Told], writer: Functions) -> FormulaFunction:
    return _written(number, name, [(key, ((0, formula),)) for key, formula in formulas], writer)


def _of_sums(number: int, sums: Sums, writer: Functions) -> FormulaFunction:
    """Sums in powers of the small parameter; where they are of the time, with the phase before them, and told."""
    series = dict(sums.series)
    if not sums.phase:
        return replace(_written(number, sums.name, [*series.items()], writer, sums.small), contents="series, summed")
    rate = _written(number, sums.name, [(sums.phase, series.pop(sums.phase))], writer, sums.small)
    function = _written(number, sums.name, [*series.items()], writer, sums.small)
    phase = dict(function.unpacked).pop(sums.phase, sums.phase)
    unpacked = dict(rate.unpacked) | {x: called for x, called in function.unpacked if x != sums.phase}
    return replace(
        function,
        unpacked=tuple(unpacked.items()),
        assignments=(*rate.assignments, (phase, f"({rate.results[0][1]})*t"), *function.assignments),
        results=((sums.phase, phase), *function.results),
        contents="series, summed, at the time t",
        of_time=True,
    )


def _written(
    number: int,
    name: str,
    sums: Sequence[tuple[str, Sequence[tuple[int, Formula]]]],
    writer: Functions,
    small: str = "",
) -> FormulaFunction:
    """Sums by what they are, of formulas times powers of ``small``."""
    program = Program()
    carriers: dict[int, Carrier] = {}
    nodes: list[Node] = []
    names: dict[str, None] = {small: None} if small else {}
    for _, parts in sums:
        total = program.zero
        for power, formula in parts:
            ring = formula.ring
            if id(ring) not in carriers:
                names |= dict.fromkeys(ring.names())
                environment = {x: program.input(x) for x in (*ring.names(), "t", "pi")}
                carriers[id(ring)] = Carrier(ring, program, environment)
            term: Node = carriers[id(ring)](formula.polynomial)
            for _ in range(abs(power)):
                term = (program.times if power > 0 else program.divide)(term, program.input(small))
            total = total + term
        nodes.append(total)
    own = [x for x in names if x not in writer.names]
    called = writer.names | injective(own, _plain, taken={*writer.names.values(), *writer.reserved})
    body = listing(program, nodes, called, writer.dialect, writer.reserved)
    unpacked = tuple((x, called[x]) for x in body.inputs if x != "pi")
    keys = [key for key, _ in sums]
    assert len(set(keys)) == len(keys), keys
    return FormulaFunction(number, name, unpacked, body.assignments, tuple(zip(keys, body.results, strict=True)))


def _plain(name: str) -> str:
    return name
