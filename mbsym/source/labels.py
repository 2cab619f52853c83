"""The labels of the editor's plain text (the paper's Figure 3, and what our model needs besides) as YAML keys."""

from __future__ import annotations

HEADER = {
    "mechanical system": "name",
    "description": "description",
    "number of bodies": "number of bodies",
    "dimensionless time": "dimensionless time",
    "small parameter": "small parameter",
    "source": "source",
    "language": "language",
    "order": "order",
    "dependent": "dependent",
    "reactions": "reactions",
}

BODY = {
    "name": "name",
    "previous body number": "attached to",
    "body mass": "mass",
    "radius vector of connection point": "connection point",
    "radius vector of mass center": "mass centre",
    "vector of relative linear velocity": "relative velocity",
    "numbers of rotation axes": "axes",
    "rotation angles": "angles",
    "inertia about": "inertia about",
    "tensor of inertia": "inertia",
    "accept tensor of inertia": "accept",
    "gyrostatic moment": "gyrostatic moment",
    "generalized coordinates": "coordinates",
    "shape": "shapes",
    "speeds": "speeds",
    "orientation": "orientation",
}

#: Sections of ``name = value`` lines and the key of a bare first value (None: the value is one expression).
SECTIONS: dict[str, tuple[str, str | None]] = {
    "parameters": ("parameters", "sign"),
    "prescribed motions": ("prescribed", "rate"),
    "inputs": ("inputs", "meaning"),
    "outputs": ("outputs", None),
    "tables": ("tables", "points"),
    "linear system": ("linear system", "file"),
    "units": ("units", None),
    "relations": ("relations", None),
    "unperturbed motion": ("motion", "value"),
    "notation": ("notation", None),
    "values": ("values", None),
    "initial state": ("initial", "position"),
    "abbreviations": ("abbreviations", None),
    "limits": ("limits", None),
    "latex symbols": ("latex", None),
}

ASSUMPTIONS = "assumptions"

LOAD_TYPE = "type of load"
LOAD_EXPRESSION = "expression"

#: The two points of a spring or damper: label -> (which point, key of the point).
BETWEEN = {
    "first body": (0, "body"),
    "first point": (0, "point"),
    "second body": (1, "body"),
    "second point": (1, "point"),
}

CONSTRAINT_TYPE = "type of constraint"

#: The two ends of a constraint: the same, and axes.
ENDS = {**BETWEEN, "first axis": (0, "axis"), "second axis": (1, "axis")}

#: Labels whose values may be numbers of bodies.
LOAD_BODIES = ("body", "centre", "about", "axes", "reaction on", "first body", "second body")
CONSTRAINT_BODIES = ("body", "axes", "on", "first body", "second body")

#: Labels of vectors in loads.
LOAD_VECTORS = ("vector", "direction", "point", "components", "first point", "second point")
CONSTRAINT_VECTORS = ("point", "first point", "second point", "first axis", "second axis")

SPELLINGS = {
    "radius vector of mass centre": "radius vector of mass center",
    "generalised coordinates": "generalized coordinates",
    "center": "centre",
    "system": "mechanical system",
}
