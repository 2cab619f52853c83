"""Pictures as JSON values: what a page reads (editor/src/picture/types.ts has the same names).

Numbers that are not finite become null; floats are written whole, so that the page computes with the same doubles.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from enum import Enum
from math import isfinite
from typing import Any

from mbsym.expressions.message import Message
from mbsym.expressions.safe import quoted
from mbsym.expressions.table import Curve
from mbsym.formulas.mathml import spelled_name
from mbsym.model.system import INERTIAL
from mbsym.picture.program import PoseProgram
from mbsym.picture.values import Picture


def as_json(picture: Picture) -> dict[str, Any]:
    """The picture with the sentences that have to stand beside it."""
    stand_ins = dict(picture.notes.stand_ins)
    told = {x.name: _encoded(getattr(picture, x.name)) for x in fields(picture) if x.name not in ("notes", "program")}
    for shown in (*told["coordinates"], *told["parameters"]):
        shown["label"] = spelled_name(shown["name"])
    for parameter in told["parameters"]:
        parameter["given"] = parameter["name"] not in stand_ins
    for shown, guide in zip(told["guides"], picture.guides, strict=True):
        shown["closed"] = guide.closed
    return told | {
        "units": dict(picture.units),
        "program": _program(picture.program),
        "atZero": list(picture.notes.at_zero),
        "sentences": list(sentences(picture)),
    }


def _encoded(value: Any) -> Any:
    """A value of a picture by the names of its fields, halfAxes for half_axes."""
    if isinstance(value, float):
        return number(value)
    if isinstance(value, tuple):
        return [_encoded(x) for x in value]
    if is_dataclass(value):
        return {re.sub("_(.)", lambda m: m[1].upper(), x.name): _encoded(getattr(value, x.name)) for x in fields(value)}
    return value.value if isinstance(value, Enum) else value


def number(value: float) -> float | None:
    """null for what is not finite."""
    return float(value) if isfinite(value) else None


def _program(program: PoseProgram) -> dict[str, Any]:
    return {
        "inputs": list(program.inputs),
        "constants": [number(x) for x in program.constants],
        "steps": [list(step) for step in program.steps],
        "tables": [_table(curve) for curve in program.tables],
    }


def _table(curve: Curve) -> dict[str, Any]:
    """f = c_0 + u (c_1 + ...), u = x - base of the piece: the i-th lies before knot i, the last behind all."""
    return {
        "knots": [float(x) for x in curve.knots],
        "bases": [float(x) for x in curve.bases],
        "pieces": [[float(x) for x in piece] for piece in curve.polynomials],
    }


def sentences(picture: Picture) -> Iterator[str]:
    """In which axes it is seen, what was made up, moved, left out, or is not to scale."""
    notes = picture.notes
    axes = {} if picture.frame == INERTIAL else {"body": quoted(picture.frame)}
    if notes.hidden:
        text = (
            "Seen in the axes of [[body]]; [[names]] not drawn."
            if axes
            else "Seen in inertial axes; [[names]] not drawn."
        )
        yield Message(text, names=", ".join(notes.hidden), **axes)
    else:
        yield Message("Seen in the axes of [[body]]." if axes else "Seen in inertial axes.", **axes)
    if notes.stand_ins:
        values = ", ".join(f"{name} = {value:g}" for name, value in notes.stand_ins)
        yield Message("Stand-ins for values that are not given, only to draw: [[values]].", values=values)
    if notes.at_zero:
        names = ", ".join(notes.at_zero)
        yield Message("No initial value is given for [[names]]: drawn at 0.", names=names)
    if notes.moved:
        moves = ", ".join(f"{name}: {before:.6g} -> {there:.6g}" for name, before, there in notes.moved)
        yield Message("Led to the constraints: [[moves]].", moves=moves)
    if notes.open_loop:
        yield Message("The constraints are open here: [[why]].", why=notes.open_loop)
    if notes.velocity_rows:
        text = "Constraints on velocities: [[count]]; every position can be shown, whether a motion reaches it or not."
        yield Message(text, count=notes.velocity_rows)
    solid = [body.ellipsoid for body in picture.bodies if body.ellipsoid is not None]
    if any(ellipsoid.true_size for ellipsoid in solid):
        yield Message(
            "Ellipsoids: homogeneous bodies with the same mass and inertia, to scale (none thinner than 1/100)."
        )
    if any(not ellipsoid.true_size for ellipsoid in solid):
        yield Message(
            "Ellipsoids of bodies without a mass have the proportions of their inertia; their size means nothing."
        )
    if any(body.shapes for body in picture.bodies):
        yield Message("Shapes are those that the description gives; no force depends on them.")
    if notes.without_arrow:
        loads = ", ".join(str(k + 1) for k in notes.without_arrow)
        text = "Without an arrow, because it acts on coordinates or is zero or has no force on a point: load [[loads]]."
        yield Message(text, loads=loads)
