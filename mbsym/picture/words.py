"""What a picture has to be told with: sentences of its notes."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.counting import counted
from mbsym.model.system import INERTIAL
from mbsym.picture.values import Picture


def sentences(found: Picture) -> Iterator[str]:
    """In which axes it is seen, what was made up, moved, left out, or is not to scale."""
    notes = found.notes
    where = "inertial axes" if found.frame == INERTIAL else f"the axes of '{found.frame}'"
    without = f"; {', '.join(notes.hidden)} not drawn" if notes.hidden else ""
    yield f"Seen in {where}{without}."
    if notes.stand_ins:
        given = ", ".join(f"{name} = {value:g}" for name, value in notes.stand_ins)
        yield f"Stand-ins for values that are not given, only to draw: {given}."
    if notes.at_zero:
        yield f"No initial value is given for {', '.join(notes.at_zero)}: drawn at 0."
    if notes.moved:
        moves = ", ".join(f"{name} from {given:.6g} to {there:.6g}" for name, given, there in notes.moved)
        yield f"Led to the constraints: {moves}."
    if notes.open_loop:
        yield f"The constraints are open here: {notes.open_loop}."
    if notes.velocity_rows:
        some = counted(notes.velocity_rows, "constraint")
        yield f"{some} on velocities: every position can be shown, not every one is reached by a given motion."
    solid = [body.ellipsoid for body in found.bodies if body.ellipsoid is not None]
    if any(one.true_size for one in solid):
        yield "Ellipsoids: homogeneous bodies with the same mass and inertia, to scale (none thinner than 1/100)."
    if any(not one.true_size for one in solid):
        yield "Ellipsoids of bodies without a mass have the proportions of their inertia; their size means nothing."
    if any(body.shapes for body in found.bodies):
        yield "Shapes are those that the description gives; no force depends on them."
    if notes.without_arrow:
        loads = ", ".join(str(k + 1) for k in notes.without_arrow)
        yield f"Without an arrow, because it acts on coordinates or is zero or has no force on a point: load {loads}."
