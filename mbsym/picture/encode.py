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


def as_json(picture: Picture) -> dict[str, Any]:
    """The picture with the sentences that have to stand beside it."""
    stand_ins = dict(picture.notes.stand_ins)
    return {
        "name": picture.name,
        "frame": picture.frame,
        "units": dict(picture.units),
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
            for x in picture.coordinates
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
            for x in picture.parameters
        ],
        "guides": [
            {"body": x.body, "points": [numbers(point) for point in x.points], "closed": x.closed}
            for x in picture.guides
        ],
        "program": _program(picture.program),
        "bodies": [_body(x) for x in picture.bodies],
        "arrows": [
            {"load": x.load, "of": x.of.value, "body": x.body, "point": x.point, "along": x.along}
            for x in picture.arrows
        ],
        "lines": [{"kind": x.kind.value, "start": x.start, "end": x.end, "of": x.of} for x in picture.lines],
        "closure": None if picture.closure is None else _closure(picture.closure),
        "view": {
            "up": numbers(picture.view.up),
            "azimuth": picture.view.azimuth,
            "elevation": picture.view.elevation,
            "plane": picture.view.plane,
        },
        "middle": numbers(picture.middle),
        "extent": number(picture.extent),
        "atZero": list(picture.notes.at_zero),
        "sentences": list(sentences(picture)),
    }


def number(value: float) -> float | None:
    """null for what is not finite."""
    return float(value) if isfinite(value) else None


def numbers(values: Iterable[float]) -> list[float | None]:
    """The same for many."""
    return [number(x) for x in values]


def _program(program: PoseProgram) -> dict[str, Any]:
    return {
        "inputs": list(program.inputs),
        "constants": numbers(program.constants),
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


def _body(body: Drawn) -> dict[str, Any]:
    joint = body.joint
    return {
        "name": body.name,
        "parent": body.parent,
        "axes": body.axes,
        "origin": body.origin,
        "centre": body.centre,
        "massive": body.massive,
        "cart": body.cart,
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
            for x in body.shapes
        ],
        "ellipsoid": None
        if body.ellipsoid is None
        else {
            "halfAxes": numbers(body.ellipsoid.half_axes),
            "axes": [numbers(row) for row in body.ellipsoid.axes],
            "trueSize": body.ellipsoid.true_size,
            "telling": body.ellipsoid.telling,
        },
    }


def _closure(closure: Closure) -> dict[str, Any]:
    return {
        "coordinates": list(closure.coordinates),
        "sizes": numbers(closure.sizes),
        "rows": list(closure.rows),
        "slopes": [list(row) for row in closure.slopes],
        "names": list(closure.names),
        "tolerance": closure.tolerance,
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
