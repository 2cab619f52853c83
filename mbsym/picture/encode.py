"""Pictures as JSON values: what a page reads (editor/src/picture/types.ts has the same names).

Numbers that are not finite become null; floats are written whole, so that the page computes with the same doubles.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import isfinite
from typing import Any

from mbsym.expressions.message import Message
from mbsym.expressions.safe import quoted
from mbsym.expressions.table import Curve
from mbsym.formulas.mathml import spelled_name
from mbsym.model.system import INERTIAL
from mbsym.picture.program import PoseProgram
from mbsym.picture.values import Closure, Drawn, Picture


def as_json(found: Picture) -> dict[str, Any]:
    """The picture with the sentences that have to stand beside it."""
    stand_ins = dict(found.notes.stand_ins)
    return {
        "name": found.name,
        "frame": found.frame,
        "units": dict(found.units),
        "coordinates": [
            {
                "name": x.name,
                "label": spelled_name(x.name),
                "kind": x.kind.value,
                "unit": x.unit,
                "value": number(x.value),
                "velocity": number(x.velocity),
                "minimum": number(x.minimum),
                "maximum": number(x.maximum),
                "limited": x.limited,
            }
            for x in found.coordinates
        ],
        "parameters": [
            {
                "name": x.name,
                "label": spelled_name(x.name),
                "value": number(x.value),
                "unit": x.unit,
                "meaning": x.meaning,
                "given": x.name not in stand_ins,
            }
            for x in found.parameters
        ],
        "guides": [
            {"body": x.body, "points": [numbers(point) for point in x.points], "closed": x.closed} for x in found.guides
        ],
        "program": _program(found.program),
        "bodies": [_body(x) for x in found.bodies],
        "arrows": [
            {"load": x.load, "of": x.of.value, "body": x.body, "point": x.point, "along": x.along} for x in found.arrows
        ],
        "lines": [{"kind": x.kind.value, "start": x.start, "end": x.end, "of": x.of} for x in found.lines],
        "closure": None if found.closure is None else _closure(found.closure),
        "view": {
            "up": numbers(found.view.up),
            "azimuth": found.view.azimuth,
            "elevation": found.view.elevation,
            "plane": found.view.plane,
        },
        "middle": numbers(found.middle),
        "extent": number(found.extent),
        "atZero": list(found.notes.at_zero),
        "sentences": list(sentences(found)),
    }


def number(value: float) -> float | None:
    """null for what is not finite."""
    return float(value) if isfinite(value) else None


def numbers(values: Iterable[float]) -> list[float | None]:
    """The same for many."""
    return [number(x) for x in values]


def _program(found: PoseProgram) -> dict[str, Any]:
    return {
        "inputs": list(found.inputs),
        "constants": numbers(found.constants),
        "steps": [list(step) for step in found.steps],
        "tables": [_table(curve) for curve in found.tables],
    }


def _table(curve: Curve) -> dict[str, Any]:
    """f = c_0 + u (c_1 + ...), u = x - base of the piece: the i-th lies before knot i, the last behind all."""
    return {
        "knots": [float(x) for x in curve.knots],
        "bases": [float(x) for x in curve.bases],
        "pieces": [[float(x) for x in piece] for piece in curve.polynomials],
    }


def _body(found: Drawn) -> dict[str, Any]:
    joint = found.joint
    return {
        "name": found.name,
        "parent": found.parent,
        "axes": found.axes,
        "origin": found.origin,
        "centre": found.centre,
        "massive": found.massive,
        "cart": found.cart,
        "joint": {
            "hinges": [
                {"along": x.along, "coordinates": list(x.coordinates), "slides": x.slides, "straight": x.straight}
                for x in joint.hinges
            ],
            "sprung": list(joint.sprung),
            "damped": list(joint.damped),
        },
        "shapes": [
            {"kind": x.kind, "size": numbers(x.size), "at": numbers(x.at), "axes": [numbers(row) for row in x.axes]}
            for x in found.shapes
        ],
        "ellipsoid": None
        if found.ellipsoid is None
        else {
            "halfAxes": numbers(found.ellipsoid.half_axes),
            "axes": [numbers(row) for row in found.ellipsoid.axes],
            "trueSize": found.ellipsoid.true_size,
            "telling": found.ellipsoid.telling,
        },
    }


def _closure(found: Closure) -> dict[str, Any]:
    return {
        "coordinates": list(found.coordinates),
        "rows": list(found.rows),
        "slopes": [list(row) for row in found.slopes],
        "names": list(found.names),
        "tolerance": found.tolerance,
    }


def sentences(found: Picture) -> Iterator[str]:
    """In which axes it is seen, what was made up, moved, left out, or is not to scale."""
    notes = found.notes
    axes = {} if found.frame == INERTIAL else {"body": quoted(found.frame)}
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
        moves = ", ".join(f"{name}: {given:.6g} -> {there:.6g}" for name, given, there in notes.moved)
        yield Message("Led to the constraints: [[moves]].", moves=moves)
    if notes.open_loop:
        yield Message("The constraints are open here: [[why]].", why=notes.open_loop)
    if notes.velocity_rows:
        text = "Constraints on velocities: [[count]]; every position can be shown, whether a motion reaches it or not."
        yield Message(text, count=notes.velocity_rows)
    solid = [body.ellipsoid for body in found.bodies if body.ellipsoid is not None]
    if any(ellipsoid.true_size for ellipsoid in solid):
        yield Message(
            "Ellipsoids: homogeneous bodies with the same mass and inertia, to scale (none thinner than 1/100)."
        )
    if any(not ellipsoid.true_size for ellipsoid in solid):
        yield Message(
            "Ellipsoids of bodies without a mass have the proportions of their inertia; their size means nothing."
        )
    if any(body.shapes for body in found.bodies):
        yield Message("Shapes are those that the description gives; no force depends on them.")
    if notes.without_arrow:
        loads = ", ".join(str(k + 1) for k in notes.without_arrow)
        text = "Without an arrow, because it acts on coordinates or is zero or has no force on a point: load [[loads]]."
        yield Message(text, loads=loads)
