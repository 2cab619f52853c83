"""Formulas given outside of a description, in its names: laws of inputs ``u = sin(3*t)``, motions ``theta = t**2``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import isfinite
from typing import TYPE_CHECKING

from mbsym.expressions.constants import out_of_range
from mbsym.expressions.parser import names_apart, parse_expression
from mbsym.expressions.place import Complaints, Span, in_line
from mbsym.expressions.tree import Expression, number
from mbsym.model.speeds import Quaternion
from mbsym.source.scope import FORCE, Allowed, Scope

if TYPE_CHECKING:
    from mbsym.model.system import System

#: What a force may hold, but for other inputs.
LAW = Allowed("the law of an input", tuple(kind for kind in FORCE.kinds if kind != "input"), FORCE.kinked)


#: Its derivatives count, so that nothing in it may have a kink.
GIVEN_LAW = Allowed("the law of a function of time", ("prescribed", "parameter", "time"), given=False)


#: A motion is differentiated twice.
MOTION = Allowed("a motion", ("prescribed", "parameter", "time"))


def read_law(
    text: str, system: System, complaints: Complaints, place: Callable[[int, int], Span], allowed: Allowed = LAW
) -> Expression | None:
    """A formula in what the description's forces may hold, inputs excepted; None after a complaint."""
    scope = _scope(system, complaints)
    before = len(complaints.items)
    tree = parse_expression(text, complaints, place, True, tables=scope.tables)
    for expression in [tree] if tree is not None else names_apart(text, place, complaints.items[before:]):
        scope.check(expression, allowed)
    if tree is not None and (why := out_of_range(tree)):
        complaints.error("no-number", "nothing can be computed with this number: [[why]]", place(0, len(text)), why=why)
    return tree if len(complaints.items) == before else None


def read_laws(system: System, laws: Mapping[str, Expression | Fraction | float | str]) -> dict[str, Expression]:
    """Laws of inputs by name as expressions in what the description's forces may hold, inputs excepted.

    Those of free functions of time are smooth ones in t, parameters and prescribed motions.  Raises ValueError with
    everything that is wrong.
    """
    return _read(system, laws, of_laws(system), "input")


def of_laws(system: System) -> dict[str, Allowed]:
    """By name what the law of an input, or of a free function of time, may hold."""
    return dict.fromkeys(system.input_names, LAW) | dict.fromkeys((item.name for item in system.given), GIVEN_LAW)


def of_motions(system: System) -> dict[str, Allowed]:
    """By coordinate what a motion may hold."""
    return dict.fromkeys(system.coordinates, MOTION)


def read_motions(system: System, motions: Mapping[str, Expression | Fraction | float | str]) -> dict[str, Expression]:
    """Motions of all coordinates by name as smooth expressions in t, parameters and prescribed motions.

    With constraints some of them, one at least.  Raises ValueError with everything that is wrong, coordinates without a
    motion included.
    """
    every = not (system.constraints and motions)
    return _read(system, motions, of_motions(system), "coordinate", every)


def _read(
    system: System,
    values: Mapping[str, Expression | Fraction | float | str],
    known: Mapping[str, Allowed],
    kind: str,
    every: bool = False,
) -> dict[str, Expression]:
    expressions: dict[str, Expression] = {}
    wrong = [f"there is no {kind} called {name}" for name in values if name not in known]
    wrong += [f"no motion is given for {name}" for name in known if every and name not in values]
    for name, value in values.items():
        complaints = Complaints()
        if isinstance(value, str):
            law = read_law(value, system, complaints, in_line, known.get(name, LAW))
            wrong += [f"{name} = {value}: {item.message}" for item in complaints.items]
            if law is not None:
                expressions[name] = law
        elif not isinstance(value, (int, float, Fraction)):
            expressions[name] = value
        elif isfinite(value):
            expressions[name] = number(Fraction(value))
        else:
            wrong.append(f"{name} = {value} is no number")
    if wrong:
        raise ValueError("; ".join(wrong))
    return expressions


def _scope(system: System, complaints: Complaints) -> Scope:
    kinds = dict.fromkeys(system.parameter_names, "parameter") | dict.fromkeys(system.coordinates, "coordinate")
    kinds |= {item.name: "prescribed" for item in system.of_constant_rate} | {x.name: "given" for x in system.given}
    kinds |= {item.name: "notation" for item in system.notation} | dict.fromkeys(system.input_names, "input")
    kinds |= {speed.name: "speed" for speed in system.speeds}
    for vector in (vector for body in system.bodies for vector in body.orientation):
        kinds |= dict.fromkeys(vector.components, "quaternion" if isinstance(vector, Quaternion) else "unit vector")
    return Scope(complaints, kinds, tables={table.name: table for table in system.tables})
