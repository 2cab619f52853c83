"""A System as the plain text of the description editor, with the labels of the paper's Figure 3.

The data of a description are lines of editor text first: (label, value) by blocks, bodies by their numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from mbsym.expressions.place import Span
from mbsym.expressions.tree import ZERO, text
from mbsym.model.claims import BODY as ABOUT_BODY
from mbsym.model.claims import CLAIMS
from mbsym.model.system import Body, System
from mbsym.source.grammar import Named
from mbsym.source.keys import ALIASES, LOADS
from mbsym.source.labels import ASSUMPTIONS, BODY, FREE, FREE_KEYS, HEADER, NUMBERED, SECTIONS
from mbsym.source.placed import Scalar
from mbsym.source.text_kinds import split
from mbsym.source.text_lines import PRINTED
from mbsym.source.yaml_writer import Shape as Data
from mbsym.source.yaml_writer import body_shape, system_shape, vector_shape

Line = tuple[str, str]

#: The lists of blocks: key of the description -> what their headings begin with.
BLOCKS = {"bodies": "Body", "loads": "Load", "constraints": "Constraint", "claims": "Claim"}

ROWS = "\n    "

_LABELS = {key: label.capitalize() for label, key in BODY.items()}
_TITLES = {key: title for title, (key, _) in SECTIONS.items()}
_FIRST = dict(SECTIONS.values())
_SHOWN = {"latex symbols": "LaTeX symbols"}
_ABOVE = ("mechanical system", "description", "source", "label", "language", "order", "dependent", "reactions")
#: The lines of a header, in their order.
_ORDER = (*_ABOVE, "number of bodies", "dimensionless time", "small parameter")
#: All that Figure 3 shows of a body, and what we need besides.
_OF_BODIES = (
    *("name", "attached to", "mass", "connection point", "mass centre", "relative velocity", "rotation"),
    *("inertia about", "inertia", "gyrostatic moment", "coordinates", "speeds", "orientation", "shapes"),
)


def to_text(system: System) -> str:
    """The description of a system as editor text; reading it again gives an equal system."""
    data = system_shape(system)
    if system.linear is None:
        data["bodies"] = [_whole(body) for body in system.bodies]
    lines = lines_of_data(data)
    written = [f"{label.capitalize()}: {value}" for label, value in sorted(lines.header, key=_place)]
    for key in data:
        title = ASSUMPTIONS if key == ASSUMPTIONS else _TITLES.get(key, "")
        for number, inside in enumerate(lines.blocks.get(key, ()), start=1):
            written += ["", f"{BLOCKS[key]} description ({number})"]
            between = " =" if names_keys(inside[0][1]) else ":"
            for place, (label, value) in enumerate(inside):
                shown = f"{label}{between}" if place else f"{label.capitalize()}:"
                written.append(f"  {shown}{'' if value.startswith(ROWS) else ' '}{value}")
        if title in lines.sections:
            written += ["", title_shown(title)]
            written += [
                f"  {name} = {value}" if key != ASSUMPTIONS else f"  {name}" for name, value in lines.sections[title]
            ]
    return "\n".join(written) + "\n"


def _place(line: Line) -> int:
    return _ORDER.index(line[0])


def _whole(body: Body) -> dict[str, Data]:
    """All labels of Figure 3, zeros included, as the editor shows them."""
    unused: list[Data] = ["0"] * (3 - len(body.rotation.axes))
    axes: list[Data] = [*map(str, body.rotation.axes), *unused]
    rows = body.inertia.tensor if body.inertia is not None else ((ZERO,) * 3,) * 3
    tensor: dict[str, Data] = {"tensor": [vector_shape(row) for row in rows]}
    whole = body_shape(body, ()) | {
        "connection point": vector_shape(body.connection_point),
        "mass centre": vector_shape(body.mass_centre),
        "rotation": {"axes": axes, "angles": [*map(text, body.rotation.angles), *unused]},
        "inertia": tensor | ({"accept": "true"} if body.inertia is not None and body.inertia.accepted else {}),
        "coordinates": [*body.coordinates],
    }
    return {key: whole[key] for key in _OF_BODIES if key in whole}


@dataclass(slots=True)
class Lines:
    """What a text has to hold; assumptions are a section whose lines have no labels."""

    header: list[Line] = field(default_factory=list)
    sections: dict[str, list[Line]] = field(default_factory=dict)
    blocks: dict[str, list[list[Line]]] = field(default_factory=dict)


def lines_of_data(data: dict[str, Data]) -> Lines:
    """The lines of a whole description."""
    lines, numbers = Lines(), _numbers(data)
    for key, value in data.items():
        plain = ALIASES.get(key, key)
        if plain in BLOCKS and isinstance(value, list):
            lines.blocks[plain] = [block(plain, inner, numbers) for inner in value]
        elif plain == "assumptions" and isinstance(value, list):
            lines.sections["assumptions"] = [(_flat(inner), "") for inner in value]
        elif plain in _TITLES and isinstance(value, dict):
            first = _FIRST[plain]
            lines.sections[_TITLES[plain]] = [(name, entry(plain, inner, first)) for name, inner in value.items()]
        elif plain != "mbsym":
            lines.header += _header(plain, value, numbers)
    count = len(lines.blocks.get("bodies", ()))
    lines.header.append(("number of bodies", str(count)))
    return lines


def title_shown(title: str) -> str:
    return _SHOWN.get(title, title.capitalize())


def _numbers(data: dict[str, Data]) -> dict[str, str]:
    bodies = data.get("bodies")
    names = [body.get("name") for body in bodies if isinstance(body, dict)] if isinstance(bodies, list) else []
    return {" ".join(name.split()): str(k) for k, name in enumerate(names, start=1) if isinstance(name, str)}


def _header(key: str, value: Data, numbers: dict[str, str]) -> list[Line]:
    label = next((label for label, header_key in HEADER.items() if header_key == key), key)
    if key == "reactions" and isinstance(value, list):
        value = [numbers.get(_flat(body), _flat(body)) for body in value]
    if key == "small parameter":
        return [(label, small(value))]
    return [(label, free(value, kept=True) if label in FREE and isinstance(value, str) else _braces(value))]


def small(value: Data) -> str:
    """``eps``, or ``eps; powers = (e, 1, p2, -1); fast = (x, y)``."""
    parts = []
    for name, rest in value.items() if isinstance(value, dict) else ((text_of(value), ""),):
        parts.append(name)
        for key, inner in rest.items() if isinstance(rest, dict) else ():
            pairs: list[Data] = [x for pair in inner.items() for x in pair] if isinstance(inner, dict) else []
            parts.append(f"{key} = {text_of(pairs or inner)}")
    return "; ".join(parts)


def entry(section: str, value: Data, first: str | None) -> str:
    """The value of a name in a section; a record that says one thing stands without its key."""
    if isinstance(value, dict) and first is not None and list(value) == [first]:
        value = value[first]
    if isinstance(value, dict):
        return record(value, first)
    return free(value) if section == "inputs" and isinstance(value, str) else text_of(value)


def record(value: dict[str, Data], first: str | None = None) -> str:
    """``positive; value = 2; meaning = length``: the first value without its key where that goes without saying."""
    parts = []
    for index, (key, inner) in enumerate(value.items()):
        free_text = key in FREE_KEYS and isinstance(inner, str)
        written = free(inner, key == "meaning") if free_text and isinstance(inner, str) else text_of(inner)
        parts.append(written if index == 0 and key == first and len(value) > 1 else f"{key} = {written}")
    return "; ".join(parts)


def _flat(value: Data) -> str:
    return " ".join(value.split()) if isinstance(value, str) else text_of(value)


def text_of(value: Data) -> str:
    """A value in one line: lists in round brackets."""
    if isinstance(value, list):
        return "(" + ", ".join(map(text_of, value)) + ")"
    return record(value) if isinstance(value, dict) else _flat(value)


def free(value: str, kept: bool = False) -> str:
    """Text for people: in double quotes where it could be taken for something else.

    Greek letters and printed signs could be for names and operators, unless they are ``kept`` where it stands.
    """
    plain = value == value.strip() and "\n" not in value and not any(mark in value for mark in ';"#\\=')
    apart = len(list(split(Scalar(f"{value};", Span(1, 1)), ";"))) == 2  # every bracket is closed
    if value and plain and apart and (kept or PRINTED.search(value) is None):
        return value
    escaped = value.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


# --- blocks -----------------------------------------------------------------------------------------------------------


def block(section: str, data: Data, numbers: dict[str, str]) -> list[Line]:
    """The lines of what is listed in a section; ``numbers`` are those of bodies."""
    if not isinstance(data, dict):
        return []
    if section == "bodies":
        return _body(data, numbers)
    if section == "claims":
        return _claim(data, numbers)
    kind, value = next(iter(data.items()), ("", ""))
    what = "load" if section == "loads" else "constraint"
    return [(f"type of {what}", kind), *_tie(kind, value, numbers)]


def _body(data: dict[str, Data], numbers: dict[str, str]) -> list[Line]:
    lines: list[Line] = []
    for key, value in data.items():
        plain = ALIASES.get(key, key)
        if plain == "attached to":
            lines.append((_LABELS[plain], numbers.get(_flat(value), _flat(value))))
        elif plain == "rotation" and isinstance(value, dict):
            lines += [(_LABELS[part], _braces(inner)) for part, inner in value.items() if part in _LABELS]
        elif plain == "inertia" and isinstance(value, dict):
            lines.append((_LABELS["inertia"], _tensor(value.get("tensor", []))))
            lines += [(_LABELS["accept"], text_of(value["accept"]))] if "accept" in value else []
        elif plain == "inertia":
            lines.append((_LABELS["inertia"], _tensor(value)))
        elif plain == "shapes" and isinstance(value, list):
            lines += [(_LABELS["shapes"], _shape(part)) for part in value]
        elif plain in ("coordinates",):
            lines.append((_LABELS[plain], _braces(value)))
        else:
            lines.append((_LABELS.get(plain, plain), text_of(value)))
    return lines


def _braces(value: Data) -> str:
    return "{" + ", ".join(map(text_of, value)) + "}" if isinstance(value, list) else text_of(value)


def _tensor(value: Data) -> str:
    """Three rows; of principal moments a diagonal matrix is not what was said, but what is meant."""
    if not isinstance(value, list) or not all(isinstance(row, list) for row in value):
        return text_of(value)
    return ROWS + ROWS.join(", ".join(map(text_of, row)) for row in value if isinstance(row, list))


def _shape(value: Data) -> str:
    if not isinstance(value, dict):
        return text_of(value)
    flat: dict[str, Data] = {}
    for key, one in value.items():
        turned = one if key == "rotation" and isinstance(one, dict) else None
        flat |= {key: one} if turned is None else {name: _braces(inner) for name, inner in turned.items()}
    return record(flat)


def names_keys(kind: str) -> bool:
    """Whether the keys of a kind of load are names."""
    known = LOADS.get(ALIASES.get(kind, kind))
    return known is not None and isinstance(known.type, Named)


def _tie(kind: str, value: Data, numbers: dict[str, str]) -> list[Line]:
    if isinstance(value, list):
        return _ends(value, numbers)
    if not isinstance(value, dict):
        return [("Expression", text_of(value))]
    lines: list[Line] = []
    names = names_keys(kind)
    for key, inner in value.items():
        if key == "between" and isinstance(inner, list):
            lines += _ends(inner, numbers)
        elif ALIASES.get(key, key) in NUMBERED and not names:
            lines.append((key.capitalize(), numbers.get(_flat(inner), _flat(inner))))
        else:
            lines.append((key if names else key.capitalize(), text_of(inner)))
    return lines


def _ends(value: list[Data], numbers: dict[str, str]) -> list[Line]:
    lines: list[Line] = []
    for which, end in zip(("First", "Second"), value, strict=False):
        for key, one in end.items() if isinstance(end, dict) else ():
            written = numbers.get(_flat(one), _flat(one)) if key == "body" else text_of(one)
            lines.append((f"{which} {key}", written))
    return lines


def _claim(data: dict[str, Data], numbers: dict[str, str]) -> list[Line]:
    kind = data.get("claim")
    about_body = isinstance(kind, str) and kind in CLAIMS and CLAIMS[kind].of == ABOUT_BODY
    lines: list[Line] = []
    for key, value in data.items():
        written = text_of(value)
        if key == "of" and about_body:
            written = numbers.get(_flat(value), _flat(value))
        elif key == "place" and isinstance(value, str):
            written = free(value)
        lines.append((key.capitalize(), written))
    return lines
