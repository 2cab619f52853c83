"""One formula of a system by its name, for the screen or for another program (``mbsym show``)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.matrices import cramer, determinant
from mbsym.formulas.formula import Column, Formula, Matrix, column
from mbsym.formulas.latex import latex_symbol
from mbsym.formulas.wolfram import wolfram_name
from mbsym.problems.stability.spectrum import numbers
from mbsym.report.conditions import Statement, label_meanings, statements

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.problems.in_speeds.speeds import SpeedEquations

#: The languages in which a formula is written; the first is for people.
LANGUAGES = ("text", "latex", "wolfram", "python")

#: Accelerations of more coordinates are left to programs: their formulas fill pages.
MOST_SOLVED = 4


@dataclass(frozen=True)
class Line:
    """``name = value``, or ``value relation 0`` where it has no name; ``remark`` says in words what it is of.

    ``right`` stands in place of 0: the sum of coefficients times multipliers, by their names.
    """

    name: str
    value: Formula | Matrix | Column | str
    relation: str = "="
    remark: str = ""
    right: tuple[tuple[Formula, str], ...] = ()


def _lagrangian(analysis: Analysis) -> Iterator[Line]:
    yield Line("L", analysis.energy.kinetic_energy + analysis.energy.force_function)


def _equations(analysis: Analysis) -> Iterator[Line]:
    """M q'' - f = 0; under constraints M q'' - f = J^T lambda, and the constraints."""
    found = analysis.equations
    tied = found.constraints
    for i, x in enumerate(found.equalities(analysis.system.coordinates)):
        right = () if tied is None else tuple((row[i], f"lambda{k}") for k, row in enumerate(tied.jacobian, start=1))
        yield Line("", x, right=tuple(one for one in right if not one[0].is_zero))
    if found.in_speeds:
        yield from (Line(f"{name}'", x) for name, x in cast("SpeedEquations", found).kinematic)
    if tied is not None:
        yield from _constraints(analysis)


def _constraints(analysis: Analysis) -> Iterator[Line]:
    """The constraints in velocities, row by row."""
    tied = analysis.equations.constraints
    if tied is None:
        raise NoClosedForm("the system has no constraints")
    for name, value in zip(tied.names, tied.velocity, strict=True):
        of = f", component {name.component}" if name.component else ""
        yield Line("", value, remark=f"constraint {name.constraint + 1} ({name.kind}{of})")


def accelerations(analysis: Analysis) -> Column:
    """q'' = M^-1 f by Cramer's rule.  Raises NoClosedForm under constraints and for more than ``MOST_SOLVED`` rows."""
    found = analysis.equations
    if found.constraints is not None:
        raise NoClosedForm("accelerations under constraints come with the multipliers; the equations have them")
    n = len(found.forcing)
    if n > MOST_SOLVED:
        raise NoClosedForm(f"accelerations of {n} coordinates fill pages; model.py computes them")
    ring = found.forcing[0].ring
    rows = [[x.polynomial for x in row] for row in found.mass_matrix]
    tops = cramer(ring, rows, [x.polynomial for x in found.forcing])
    inverse = ring.reciprocal(determinant(ring, rows))
    return column(ring, [ring.reduce(ring.times(top, inverse)) for top in tops])


def _accelerations(analysis: Analysis) -> Iterator[Line]:
    found = analysis.equations
    speeds: Sequence[str] = getattr(found, "speeds", ())
    names = [f"{x}'" for x in speeds] if speeds else [f"{x}''" for x in analysis.system.coordinates]
    yield from (Line(name, x) for name, x in zip(names, accelerations(analysis), strict=True))


def _motion(analysis: Analysis) -> Iterator[Line]:
    found = analysis.equilibrium
    if found.satisfied:
        yield Line("", "the unperturbed motion satisfies the equations of motion identically")
    yield from (Line("", x, "!=" if found.impossible else "=") for x in found.impossible or found.conditions)


def _matrix(name: str) -> Callable[[Analysis], Iterator[Line]]:
    def lines(analysis: Analysis) -> Iterator[Line]:
        value = getattr(analysis.linearisation, name)
        if value is None:
            raise NoClosedForm("the system has no inputs")
        yield Line(name, value)

    return lines


def _characteristic(analysis: Analysis) -> Iterator[Line]:
    for part in analysis.stability.subsystems:
        remark = f"of {', '.join(part.coordinates)}: coefficients of the powers of lambda, from the constant one on"
        yield Line("", tuple(part.characteristic), "", remark)


def _conditions(analysis: Analysis) -> Iterator[Line]:
    """What ``statements`` lists, with what each is needed for."""
    for part in analysis.stability.subsystems:
        of = ", ".join(part.coordinates)
        told = label_meanings(part.ring, part.theory.requirements)
        yield Line("", f"conditions: {part.theory.wanted}", "", of)
        for item in statements(part.ring, part.theory.requirements, told=told):
            yield Line("", item.formula or item.never or item.note, item.relation, _remark(item, of))


def _remark(item: Statement, of: str) -> str:
    return ", ".join(filter(None, (f"{item.label} of {of}", item.note or item.remark)))


def _eigenvalues(analysis: Analysis) -> Iterator[Line]:
    from mbsym.report.sections.stability import root_text

    if not analysis.stability.spectra:
        raise NoClosedForm("the description does not give all values")
    for part in analysis.stability.spectra:
        yield Line("", ", ".join(map(root_text, numbers(part))), "", f"of {', '.join(part.coordinates)}")


def _integrals(analysis: Analysis) -> Iterator[Line]:
    yield from (Line("", x.formula, "= const", f"{x.name} ({x.status})") for x in analysis.integrals)


#: What may be asked for, and what it is.
NAMES: Mapping[str, tuple[str, Callable[[Analysis], Iterator[Line]]]] = {
    "equations": ("the equations of motion, M q'' - f = 0", _equations),
    "accelerations": ("the equations solved for q''", _accelerations),
    "T": ("the kinetic energy", lambda x: iter([Line("T", x.energy.kinetic_energy)])),
    "U": ("the force function", lambda x: iter([Line("U", x.energy.force_function)])),
    "L": ("the Lagrangian, T + U", _lagrangian),
    "M": ("the mass matrix", lambda x: iter([Line("M", x.equations.mass_matrix)])),
    "f": ("the right-hand sides of M q'' = f", lambda x: iter([Line("f", x.equations.forcing)])),
    "constraints": ("the constraints in velocities", _constraints),
    "motion": ("when the unperturbed motion satisfies the equations", _motion),
    "M0": ("the mass matrix of the first approximation", _matrix("M")),
    "D": ("its dissipative matrix", _matrix("D")),
    "G": ("its gyroscopic matrix", _matrix("G")),
    "K": ("its potential matrix", _matrix("K")),
    "N": ("its circulatory matrix", _matrix("N")),
    "B": ("its matrix of inputs", _matrix("B")),
    "characteristic": ("the characteristic polynomials", _characteristic),
    "conditions": ("the conditions of stability", _conditions),
    "eigenvalues": ("the eigenvalues at the given values", _eigenvalues),
    "integrals": ("the first integrals", _integrals),
}


def _of_body(analysis: Analysis, name: str) -> Iterator[Line]:
    body = next(x for x in analysis.kinematics.bodies if x.name == name)
    yield Line("R", body.rotation, remark=f"direction cosines of {name}")
    yield Line("omega", body.angular_velocity, remark="its angular velocity, in its axes")
    yield Line("V_O", body.velocity_origin, remark="velocity of its connection point")
    yield Line("V_C", body.velocity_mass_centre, remark="velocity of its mass centre")


def _of_name(analysis: Analysis, name: str) -> Iterator[Line] | None:
    """Of an integral or of a body, by its name."""
    if any(x.name == name for x in analysis.system.bodies):
        return _of_body(analysis, name)
    return None


def known_names(analysis: Analysis) -> list[str]:
    """Everything that may be asked for."""
    return [*NAMES, *(body.name for body in analysis.system.bodies)]


def lines(analysis: Analysis, name: str) -> Iterator[Line]:
    """The formulas that go by a name.  Raises KeyError where nothing has it, Failure where there is no result."""
    if name in NAMES:
        return NAMES[name][1](analysis)
    found = _of_name(analysis, name)
    if found is None:
        raise KeyError(name)
    return found


def written(line: Line, language: str) -> str:
    """A line in one of ``LANGUAGES``."""
    value = _WRITERS[language](line.value)
    name = _NAMED[language](line.name) if line.name else ""
    zero = "" if not line.relation or isinstance(line.value, str) else f" {_relation(line.relation, language)}"
    if not name:
        right = _sum(line.right, language) if line.right else "0"
        return value + (zero if "const" in zero else f"{zero} {right}" if zero else "")
    equals = {"wolfram": " = ", "python": " = "}.get(language, " = ")
    if language == "text" and "\n" in value:
        indent = "\n" + " " * (len(name) + len(equals))
        return name + equals + value.replace("\n", indent)
    return f"{name}{equals}{value}"


def _sum(terms: Sequence[tuple[Formula, str]], language: str) -> str:
    """The sum of coefficients times multipliers."""
    times = {"latex": "\\, ", "text": " "}.get(language, "*")
    written = []
    for coefficient, multiplier in terms:
        value, name = _WRITERS[language](coefficient), _NAMED[language](multiplier)
        factor = f"({value})" if coefficient.terms > 1 or language != "text" else value
        written.append({"1": name, "-1": f"-{name}"}.get(value, f"{factor}{times}{name}"))
    return " + ".join(written).replace("+ -", "- ")


def _relation(relation: str, language: str) -> str:
    if language == "latex":
        return {"!=": r"\neq", ">=": r"\geq", "<=": r"\leq", "= const": r"= \mathrm{const}"}.get(relation, relation)
    return {"=": "==", "= const": "== const"}.get(relation, relation) if language != "text" else relation


def _text(value: Formula | Matrix | Column | str) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, Formula):
        return value.readable()
    if isinstance(value, Matrix):
        rows = [[x.readable() for x in row] for row in value]
        if value.shape == (1, 1):
            return rows[0][0]
        widths = [max(map(len, texts)) for texts in zip(*rows, strict=True)]
        return "\n".join("[ " + "   ".join(map(str.ljust, row, widths)) + " ]" for row in rows)
    return "(" + ", ".join(x.readable() for x in value) + ")"


def _latex(value: Formula | Matrix | Column | str) -> str:
    if isinstance(value, str):
        return f"\\text{{{value}}}"
    if isinstance(value, Matrix) and value.shape == (1, 1):
        return value[0, 0].latex()
    return value.latex() if isinstance(value, Formula | Matrix) else "(" + ",\\; ".join(x.latex() for x in value) + ")"


def _wolfram(value: Formula | Matrix | Column | str) -> str:
    if isinstance(value, str):
        return f"(* {value} *)"
    if isinstance(value, Formula):
        return value.wolfram()
    rows = [_wolfram(tuple(row)) for row in value] if isinstance(value, Matrix) else [x.wolfram() for x in value]
    return "{" + ", ".join(rows) + "}"


def _python(value: Formula | Matrix | Column | str) -> str:
    if isinstance(value, str):
        return f"# {value}"
    return f"({', '.join(map(str, value))},)" if isinstance(value, tuple) else str(value)


_WRITERS = {"text": _text, "latex": _latex, "wolfram": _wolfram, "python": _python}


def _latex_name(name: str) -> str:
    bare = name.rstrip("'")
    dots = ("", "dot", "ddot")[len(name) - len(bare)]
    stem, _, index = bare.partition("_")
    symbol = latex_symbol(bare)
    if index in ("O", "C"):
        return f"{stem}_{{{index}}}"
    return symbol.accented(dots) if dots else str(symbol)


_NAMED: Mapping[str, Callable[[str], str]] = {
    "text": str,
    "latex": _latex_name,
    "wolfram": lambda name: (
        wolfram_name(name.rstrip("'")) + "'" * (len(name) - len(name.rstrip("'"))) + ("[t]" if "'" in name else "")
    ),
    "python": lambda name: name.rstrip("'") + ("", "_dot", "_ddot")[len(name) - len(name.rstrip("'"))],
}
