"""Random trees of bodies as descriptions (hypothesis strategies), and numbers at which two of them are compared.

A description is a dictionary with the keys of the YAML format; JSON is YAML, so ``analysed`` reads its JSON text.
Masses are positive numbers or parameters; inertias are those of point masses, so every body is physical.
"""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Sequence
from fractions import Fraction
from random import Random
from typing import Any
from zlib import crc32

from flint import fmpq
from hypothesis import strategies as st

import mbsym
from mbsym.algebra.base import Scalar
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Rationals
from mbsym.analysis import Analysis
from mbsym.mechanics.oracle import State

Description = dict[str, Any]
Draw = Callable[[st.SearchStrategy[Any]], Any]

POSITIVE, FREE = ("g", "k", "m1", "m2", "m3", "m4", "l1", "l2", "R", "nu"), ("alpha", "Omega", "b", "c")
axes = st.sampled_from([1, 2, 3])
small = st.integers(-2, 2)
vectors = st.lists(small, min_size=3, max_size=3)
nonzero_vectors = vectors.filter(any)


def analysed(description: Description, problems: Sequence[int] = (1, 2, 3, 4, 5)) -> Analysis:
    return mbsym.loads(json.dumps(description, indent=1), problems)


# --- bodies ---


@st.composite
def joints(draw: Draw, number: int, known: Sequence[str], kinds: Sequence[str]) -> Description:
    """A joint with coordinates q<number>, r<number>, p<number>; ``known`` are coordinates of earlier joints."""
    q, r, p = (f"{letter}{number}" for letter in "qrp")
    point: list[Any] = draw(vectors)
    axis, slide = draw(axes), draw(st.integers(0, 2))
    turn, shift, names = [(axis, q)], 0, [q]
    match draw(st.sampled_from(kinds)):
        case "revolute":
            turn = [(axis, draw(st.sampled_from([q, f"-{q}"])))]
        case "odd angle":
            other = draw(st.sampled_from([*known, "alpha", "pi/2"]))
            turn = [(axis, draw(st.sampled_from([f"{q} - {other}", f"{other} + 2*{q}", f"{q}/2"])))]
        case "prismatic":
            turn, shift = [], draw(st.sampled_from([q, f"l1 + {q}", f"-2*{q}"]))
        case "cylindrical":
            shift, names = p, [q, p]
        case "screw":
            shift = f"l2*{q}"
        case "crank":  # the connection point runs on a circle
            turn, point = [], [f"l1*cos({q})", f"l1*sin({q})", 1]
        case "universal":
            turn, names = [(axis, q), (axis % 3 + 1, r)], [q, r]
        case "spherical":
            turn, names = (
                [(axis, q), (axis % 3 + 1, r), (draw(st.sampled_from([axis, (axis + 1) % 3 + 1])), p)],
                [q, r, p],
            )
        case "fixed":
            turn, names = [(axis, draw(st.sampled_from(["alpha", "pi/2", "-alpha"])))], []
        case "driven":
            turn, names = [(axis, draw(st.sampled_from(["chi", "-chi"])))], []
        case "driven slide":
            turn, shift, names = [(axis, q)], draw(st.sampled_from(["chi", "sin(chi)"])), [q]
    if shift:
        point[slide] = shift
    if turn and draw(st.booleans()):  # the constant turn of a mounting
        turn.insert(draw(st.integers(0, 1)), (draw(axes), draw(st.sampled_from(["alpha", "pi/2"]))))
    joint: Description = {"connection point": point, "coordinates": names}
    if turn[:3]:
        joint["rotation"] = {"axes": [a for a, _ in turn[:3]], "angles": [x for _, x in turn[:3]]}
    used = json.dumps(joint.get("rotation", {})) + json.dumps(point)
    joint["coordinates"] = [name for name in names if name in used]
    return joint


def tensor(points: Sequence[Sequence[int]], mass: str) -> list[list[str]]:
    """The inertia of unit-``mass`` points at the given places and at their opposites, about their common centre."""
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            square = sum(sum(x * x for x in point) for point in points) if i == j else 0
            row.append(f"{2 * (square - sum(point[i] * point[j] for point in points))}*{mass}")
        rows.append(row)
    return rows


def about_joint(central: Sequence[Sequence[str]], mass: str, c: Sequence[str]) -> list[list[str]]:
    """Theta_O = Theta_C + m (c.c 1 - c c^T), written out."""
    rows = []
    for i in range(3):
        row = []
        for j in range(3):
            square = " + ".join(f"({x})**2" for x in c) if i == j else "0"
            low, high = sorted((i, j))
            row.append(f"{central[i][j]} + {mass}*({square} - ({c[low]})*({c[high]}))")
        rows.append(row)
    return rows


@st.composite
def matters(draw: Draw, number: int, solid: bool, about: str | None = None) -> Description:
    """Mass, mass centre, inertia and sometimes rotors; ``solid`` bodies have a positive definite central tensor."""
    mass = draw(st.sampled_from([f"m{number}", "2", "3/2"]))
    centre = [f"{x}*l1" if draw(st.booleans()) else str(x) for x in draw(vectors)]
    kind = "tensor" if solid else draw(st.sampled_from(["tensor", "tensor", "point", "massless"]))
    if kind == "massless":
        return {"mass": 0}
    matter: Description = {"mass": mass, "mass centre": centre}
    if kind == "tensor":
        principal = [[1, 0, 0], [0, draw(st.integers(1, 2)), 0], [0, 0, 1]]
        central = tensor([*principal, draw(vectors)], mass)
        matter["inertia about"] = about or draw(st.sampled_from(["joint", "mass centre"]))
        matter["inertia"] = about_joint(central, mass, centre) if matter["inertia about"] == "joint" else central
    if draw(st.integers(0, 3)) == 0:
        matter["gyrostatic moment"] = [f"{x}*b" for x in draw(nonzero_vectors)]
    return matter


JOINTS = ("revolute", "revolute", "odd angle", "prismatic", "cylindrical", "screw", "universal", "spherical", "crank")
PASSIVE = ("fixed", "driven", "driven slide")


@st.composite
def systems(
    draw: Draw,
    most: int = 4,
    most_coordinates: int = 5,
    loads: bool = True,
    driven: bool = True,
    solid: bool = False,
    about: str | None = None,
    irrational: bool = False,
) -> Description:
    """A tree of one to ``most`` bodies; the last one is solid, so that something moves.

    ``irrational`` adds a load whose value at rational states is a root or an exponential.
    """
    count = draw(st.integers(1, most))
    bodies: list[Description] = []
    known: list[str] = []
    for number in range(1, count + 1):
        kinds = JOINTS[:4] if len(known) + 2 > most_coordinates else JOINTS
        if len(known) >= most_coordinates:
            kinds = ("fixed",)
        elif driven and known:
            kinds = (*kinds, *PASSIVE)
        last = number == count
        joint = draw(joints(number, known, kinds))
        parent = draw(st.sampled_from(["0", *(body["name"] for body in bodies)])) if bodies else "0"
        if last and bodies:  # what would be a massless branch ends in a body
            parent = draw(st.sampled_from([bodies[-1]["name"], parent]))
        known += joint["coordinates"]
        bodies.append(
            {"name": f"body {number}", "attached to": parent} | joint | draw(matters(number, solid or last, about))
        )
    description: Description = {
        "mbsym": 1,
        "name": "random",
        "parameters": dict.fromkeys(POSITIVE, "positive") | dict.fromkeys(FREE, "real"),
        "bodies": bodies,
    }
    if driven:
        description["prescribed"] = {"chi": "Omega"}
    if loads and known:
        description["loads"] = draw(st.lists(all_loads(description), max_size=3))
        if irrational:
            description["loads"].append(draw(irrational_loads(description)))
        spelled = draw(st.sampled_from(["potential", "force function"]))  # a file spells it one way
        description["loads"] = [
            {spelled: next(iter(load.values()))} if {"potential", "force function"} & load.keys() else load
            for load in description["loads"]
        ]
    return description


# --- loads ---


def coordinates(description: Description) -> list[str]:
    return [name for body in description["bodies"] for name in body["coordinates"]]


def _ends(bodies: list[str]) -> st.SearchStrategy[list[Description]]:
    points = st.lists(st.sampled_from([-1, 0, 2, "l1", "-l2"]), min_size=3, max_size=3)
    end = st.fixed_dictionaries({"body": st.sampled_from(["0", *bodies]), "point": points})
    return st.lists(end, min_size=2, max_size=2, unique_by=lambda x: x["body"])


def all_loads(description: Description) -> st.SearchStrategy[Description]:
    """Every kind of load, on a given set of bodies."""
    names, bodies = coordinates(description), [body["name"] for body in description["bodies"]]
    q, other = st.sampled_from(names), st.sampled_from(names)
    body, frame = st.sampled_from(bodies), st.sampled_from(["0", *bodies])
    amount = st.sampled_from(["k", "2", "-c", f"c*{names[0]}", f"b*{names[-1]}_dot", "b*t", "0"])
    components = st.lists(amount, min_size=3, max_size=3)
    potentials = [
        st.builds("k*({} - {})**2/2".format, q, other),
        st.builds("-c*{}*cos({})".format, q, other),
        st.builds("g*sin(2*{})".format, q),
        st.builds("c*{}*t + b*{}**3".format, q, other),
    ]
    rayleigh = [st.builds("b*({0}_dot - {1}_dot)**2/2 + c*{1}_dot**4*cos({0})".format, q, other)]
    forces = [st.builds("c*{0} - b*{1}_dot**2 + k*sin({1})".format, q, other)]
    rest = st.sampled_from([0, "l2"])
    return st.one_of(
        st.builds(lambda v: {"uniform gravity": {"vector": [f"{x}*g" for x in v]}}, nonzero_vectors),
        st.builds(lambda x, r: {"spring": {"coordinate": x, "stiffness": "k", "rest": r}}, q, rest),
        st.builds(lambda x: {"damper": {"coordinate": x, "coefficient": "b"}}, q),
        st.builds(lambda e: {"spring": {"between": e, "stiffness": "k", "length": 0}}, _ends(bodies)),
        st.builds(lambda e: {"isotropic damper": {"between": e, "coefficient": "b"}}, _ends(bodies)),
        st.one_of(potentials).map(lambda x: {"potential": x}),
        st.one_of(rayleigh).map(lambda x: {"rayleigh": x}),
        st.builds(lambda x, f: {"generalized force": {x: f}}, q, st.one_of(forces)),
        st.builds(
            lambda x, p, f, a: {"force": {"body": x, "point": p, "components": f, "axes": a}},
            *(body, vectors, components, frame),
        ),
        st.builds(
            lambda x, f, a, r: {
                "torque": {"body": x, "components": f, "axes": a} | ({} if r == x else {"reaction on": r})
            },
            *(body, components, frame, frame),
        ),
    )


def irrational_loads(description: Description) -> st.SearchStrategy[Description]:
    names, bodies = coordinates(description), [body["name"] for body in description["bodies"]]
    q = st.sampled_from(names)
    forces = [
        "c*exp(-{0})",
        "k*sqrt(l1**2 + {0}**2)",
        "b*tanh({0}_dot)",
        "c*sin(Omega*t)*{0}",
        "k*atan({0})",
        "c*cos({0} + 1)",
    ]
    potentials = ["k*log(1 + {0}**2)", "c*cosh({0})", "c*{0}*cos(Omega*t)"]
    return st.one_of(
        st.builds(lambda e: {"spring": {"between": e, "stiffness": "k", "length": "l2"}}, _ends(bodies)),
        st.builds(lambda x, f: {"generalized force": {x: f.format(x)}}, q, st.sampled_from(forces)),
        st.builds(lambda x, f: {"force function": f.format(x)}, q, st.sampled_from(potentials)),
    )


@st.composite
def orbiting(draw: Draw) -> Description:
    """One or two bodies carried by an orbital frame, with approximate Newtonian gravity about its origin."""
    carried = draw(systems(most=2, most_coordinates=3, loads=False, driven=False))
    frame: Description = {"name": "orbit", "attached to": 0, "mass": 0, "coordinates": []}
    if draw(st.booleans()):
        frame["connection point"] = ["R*sin(chi)", "R*cos(chi)", 0]
        frame["rotation"] = {"axes": [3], "angles": ["-chi"]}
    else:
        frame["connection point"] = draw(st.sampled_from([[0, "R", 0], ["2*R", "-R", "2*R"]]))
    for body in carried["bodies"]:
        if body["attached to"] == "0":
            body["attached to"] = draw(st.sampled_from(["orbit", "orbit", "orbit", "0"]))
    carried["bodies"].insert(0, frame)
    carried["prescribed"] = {"chi": "Omega"}
    carried["loads"] = [{"newtonian gravity": {"constant": "nu", "centre": 0, "about": "orbit", "order": 2}}]
    return carried


@st.composite
def spinning(draw: Draw) -> Description:
    """A tree on a shaft along the third axis, with a steady rotation of the shaft and other coordinates at rest."""
    carried = draw(systems(most=2, most_coordinates=3, loads=False, driven=False))
    shaft = {"name": "shaft", "attached to": 0, "rotation": {"axes": [3], "angles": ["phi"]}, "coordinates": ["phi"]}
    for body in carried["bodies"]:
        body["attached to"] = "shaft" if body["attached to"] == "0" else body["attached to"]
    names = coordinates(carried)
    carried["bodies"].insert(0, shaft | draw(matters(4, True)))
    spring = {"spring": {"coordinate": draw(st.sampled_from(names)), "stiffness": "k", "rest": "l2"}} if names else None
    damper = {"damper": {"coordinate": draw(st.sampled_from(names)), "coefficient": "b"}} if names else None
    follower = {"force": {"body": "body 1", "point": [1, 0, 2], "components": ["c", 0, "b"], "axes": "body 1"}}
    gravity = {"uniform gravity": {"vector": [0, 0, "-g"]}}
    carried["loads"] = [load for load in (gravity, spring, damper, follower) if load and draw(st.booleans())]
    rest = st.sampled_from([0, 0, "pi/2", "alpha", "-alpha"])
    carried["motion"] = {"phi": {"value": 0, "rate": draw(st.sampled_from(["Omega", "2"]))}}
    carried["motion"] |= {name: draw(rest) for name in names}
    return carried


@st.composite
def driving(draw: Draw) -> Description:
    """A tree on a base that is moved in a prescribed way (it turns, slides, speeds up), with loads that know the time.

    The coordinates rest somewhere, or the first turns steadily; that this is no motion of the system does not matter.
    """
    carried = draw(systems(most=2, most_coordinates=3))
    moved = st.sampled_from(["0", "1", "R*cos(chi)", "R*sin(chi)", "l1*chi", "b*chi**2", "chi*sin(chi)"])
    base: Description = {"name": "base", "attached to": 0, "mass": 0, "coordinates": []}
    base["connection point"] = [draw(moved) for _ in range(3)]
    if draw(st.booleans()):
        base["rotation"] = {"axes": [draw(axes)], "angles": [draw(st.sampled_from(["chi", "-2*chi", "alpha"]))]}
    for body in carried["bodies"]:
        body["attached to"] = "base" if body["attached to"] == "0" else body["attached to"]
    names = coordinates(carried)
    carried["bodies"].insert(0, base)
    carried.setdefault("loads", [])
    timely = ["k*{0}**2*cos(chi)", "c*{0}*t**2", "k*{0}**2*chi*t"]
    if names and draw(st.booleans()):
        carried["loads"].append({"potential": draw(st.sampled_from(timely)).format(draw(st.sampled_from(names)))})
    if names and draw(st.booleans()):
        forced = {"generalized force": {names[-1]: f"c*{names[0]}*chi + b*{names[-1]}_dot*t"}}
        carried["loads"].append(forced)
    spelled = [load for load in carried["loads"] if "force function" not in load]
    carried["loads"] = spelled
    carried["motion"] = {name: draw(st.sampled_from([0, 0, "pi/2", "alpha"])) for name in names}
    if names and draw(st.booleans()):
        carried["motion"][names[0]] = {"value": 0, "rate": draw(st.sampled_from(["Omega", "2"]))}
    return carried


@st.composite
def resting(draw: Draw) -> Description:
    """Any tree with any loads at rest somewhere; nothing depends on time."""
    description = draw(systems(most_coordinates=3, driven=False))
    description["loads"] = [load for load in description["loads"] if "*t" not in json.dumps(load)]
    description["motion"] = {name: draw(st.sampled_from([0, 0, "pi/2", "alpha"])) for name in coordinates(description)}
    return description


# --- mechanisms whose rows follow from others, as texts ---


def closed_tree(source: Random) -> str:
    """A tree of hinges and slides whose bodies are held together at points that coincide where all coordinates are 0.

    Some bodies have no mass; some are held at two points, some twice at one: these rows follow from others.
    """
    planar, count = source.random() < 0.5, source.randint(3, 6)

    def vector() -> list[Fraction]:
        found = [Fraction(source.choice(["0", "1", "-1", "1/2", "2"])) for _ in range(3)]
        return [*found[:2], Fraction(0)] if planar else found

    def listed(values: Any) -> str:
        return "[" + ", ".join(map(str, values)) + "]"

    places, bodies = [[Fraction(0)] * 3], []
    for i in range(1, count + 1):
        parent, arm = source.randint(0, i - 1), vector()
        places.append([a + b for a, b in zip(places[parent], arm, strict=True)])
        axis = 3 if planar else source.choice([1, 2, 3])
        joint = f"connection point: {listed(arm)}, rotation: {{axes: [{axis}], angles: [q{i}]}}"
        if source.random() < 0.15:
            joint = f"connection point: {listed([f'{arm[0]} + q{i}', *arm[1:]])}, coordinates: [q{i}]"
        mass = "mass: 1, mass centre: " + listed(vector()) + ", inertia about: mass centre, inertia: [1/5, 1/4, 1/3]"
        mass = "mass: 0" if source.random() < 0.2 else mass
        bodies.append(f"{{name: b{i}, attached to: {f'b{parent}' if parent else 0}, {joint}, {mass}}}")
    rows: list[str] = []
    for _ in range(source.randint(1, 3)):
        pair, point = source.sample(range(count + 1), 2), [2 * x for x in vector()]
        for _ in range(source.choice([1, 1, 2])):
            arms = {k: listed(a - b for a, b in zip(point, places[k], strict=True)) for k in pair}
            ends = (f"{{body: {f'b{k}' if k else 0}, point: {arm}}}" for k, arm in arms.items())
            rows.append(f"coincide: [{', '.join(ends)}]")
            point = [a + b for a, b in zip(point, vector(), strict=True)]
    rows += rows[:1] if source.random() < 0.3 else []
    return described(bodies, rows, [f"q{i}: 0" for i in range(1, count + 1)])


def axle(source: Random) -> str:
    """Wheels on one axle, at any yaw or one where the rows of a fixed choice are dependent; some carry a pendulum."""
    count, hanging, yaw = (
        source.randint(1, 4),
        source.random() < 0.5,
        source.choice(["0", "pi/2", "-pi/2", "pi", "1/3"]),
    )
    places = source.sample(["0", "1/2", "-1/2", "1", "-3/2"], count)
    radii = [source.choice(["1/4", "1/4", "1/3"]) for _ in places]
    bodies = [
        f"{{name: car, attached to: 0, connection point: [x, y, 0], rotation: {{axes: [3], angles: [h]}}, coordinates: "
        f"[x, y, h], mass: 2, mass centre: [{source.choice(['0', '1/5', '-1/3'])}, 0, 0], inertia about: mass centre, "
        "inertia: [1, 1, 1]}"
    ]
    rows = []
    for i, (place, r) in enumerate(zip(places, radii, strict=True)):
        bodies.append(
            f"{{name: w{i}, attached to: car, connection point: [0, {place}, 0], rotation: {{axes: [2], angles: "
            f"[p{i}]}}, mass: 1, mass centre: [{source.choice(['0', '1/9'])}, 0, 0], inertia about: mass centre, "
            "inertia: [1, 2, 1]}"
        )
        rows.append(f"rolling: {{body: w{i}, point: [0, 0, -{r}], axes: car, on: ground}}")
        if source.random() < 0.3:
            rows.append(f"velocity: {source.choice([1, 1000])}*(x_dot*sin(h) - y_dot*cos(h)) = 0")
    if hanging:
        bodies.append(
            f"{{name: pendulum, attached to: car, rotation: {{axes: [{source.choice([1, 2])}], angles: [b]}}, mass: 1, "
            "mass centre: [0, 0, 1/2], inertia about: mass centre, inertia: [1/4, 1/4, 1/4]}"
        )
    start = ["x: 0", "y: 0", f"h: {yaw}", *(f"p{i}: {source.choice(['0', '2'])}" for i in range(count))]
    return described(bodies, rows, [*start, *["b: 1/2"] * hanging])


def ball(source: Random) -> str:
    """A ball that rolls on a plane, in a bowl, on a sphere, in a cylinder; its centre may be tied a second time."""
    surface, axes = source.choice(["plane", "bowl", "sphere", "cylinder"]), source.choice(["3, 1, 3", "1, 2, 3"])
    round_ = (
        f"rotation: {{axes: [{axes}], angles: [u, v, w]}}, mass: 1, mass centre: [{source.choice(['0', '1/9'])}, 0, 0]"
    )
    round_ += ", inertia about: mass centre, inertia: [1/5, 1/4, 1/3]"
    centre = "{{name: c, attached to: 0, connection point: {}, coordinates: [x, y, z], mass: 0}}".format("[x, y, z]")
    far, start = {"bowl": "3", "sphere": "5", "cylinder": "3"}.get(surface, "1"), ["u: 1", "v: 1/2", "w: 2"]
    if surface == "plane":
        bodies = [centre, f"{{name: ball, attached to: c, {round_}}}"]
        rows = ["rolling: {body: ball, point: [0, 0, -1], axes: c, on: ground}", "relation: z = 1"]
        return described(bodies, rows + rows[1:] * source.randint(0, 1), ["x: 0", "y: 0", "z: 1", *start])
    second = "" if surface == "cylinder" else ", 2"
    arm = f"rotation: {{axes: [1{second}], angles: [a{', b' if second else ''}]}}, mass: 0"
    arm += "" if second else ", connection point: [s, 0, 0], coordinates: [s, a]"
    own = ["a: 1/3", "b: 1/4" if second else "s: 0"]
    contact = "1" if surface == "sphere" else "-1"
    bodies = [
        f"{{name: arm, attached to: 0, {arm}}}",
        f"{{name: ball, attached to: arm, connection point: [0, 0, -{far}], {round_}}}",
    ]
    rows = [f"rolling: {{body: ball, point: [0, 0, {contact}], axes: arm, on: ground}}"]
    return described(bodies, rows * source.randint(1, 2), [*own, *start])


def coupled(source: Random, form: str = "", angle: Fraction | None = None) -> str:
    """Wheels of a locomotive with rods on both sides, a quarter of a turn apart: one may be in line with its pins."""
    count, form = source.randint(2, 3), form or source.choice(["distance", "relation"])
    bodies = ["{name: engine, attached to: 0, connection point: [x, 1, 0], coordinates: [x], mass: 3}"]
    for i in range(count):
        bodies.append(
            f"{{name: w{i}, attached to: engine, connection point: [{3 * i}, 0, 0], rotation: {{axes: [3], angles: "
            f"[-p{i}]}}, mass: 1, mass centre: [{source.choice(['1/3', '-1/4'])}, 0, 0], inertia about: mass centre, "
            "inertia: [1, 1, 1]}"
        )
    rows = ["relation: x = p0"]
    for i in range(1, count):
        for a, b in (("1/2", 0), (0, "1/2")):
            pins = [f"{{body: w{k}, point: [{a}, {b}, 0]}}" for k in (i - 1, i)]
            apart = [f"({a})*({f}(p{i}) - {f}(p{i - 1})) + ({b})*({g}(p{i}) - {g}(p{i - 1}))*{sign}"
                     for f, g, sign in (("cos", "sin", 1), ("sin", "cos", -1))]  # fmt: skip
            scale = source.choice([1, 1, 1000])
            rows.append(
                f"distance: {{between: [{pins[0]}, {pins[1]}], length: 3}}"
                if form == "distance"
                else f"relation: {scale}*((3 + {apart[0]})**2 + ({apart[1]})**2) = {scale}*9"
            )
    at = source.choice(["0", "pi/2", "pi", "1"]) if angle is None else angle
    return described(bodies, rows, [f"{name}: {at}" for name in ("x", *(f"p{i}" for i in range(count)))])


def described(bodies: Sequence[str], rows: Sequence[str], start: Sequence[str]) -> str:
    lines = ["mbsym: 1", "name: random", "bodies:", *(f"  - {x}" for x in bodies)]
    lines += ["loads: [{uniform gravity: {vector: [1, -9, 2]}}]", "constraints:", *(f"  - {x}" for x in rows)]
    return "\n".join([*lines, f"initial: {{{', '.join(start)}}}", ""])


MECHANISMS = {kind.__name__: kind for kind in (closed_tree, axle, ball, coupled)}


def mechanism(kind: str, seed: int) -> str:
    """One of each kind by its seed."""
    return MECHANISMS[kind](Random(f"{kind} {seed}"))


mechanisms = st.builds(mechanism, st.sampled_from([*MECHANISMS]), st.integers(0, 9999))


# --- the same numbers in two descriptions ---


def _drawn(name: str) -> int:
    return crc32(name.encode())


def state(analysis: Analysis, called: Callable[[str], str] = lambda name: name) -> State:
    """An exact state that depends only on names: ``called`` gives the name that a coordinate has elsewhere."""
    ring = analysis.ring
    values = {}
    for name in ring.names():
        base, suffix = name, ""
        for ending in ("_ddot", "_dot"):
            if name.endswith(ending):
                base, suffix = name.removesuffix(ending), ending
                break
        seed = _drawn(called(base) + suffix)
        values[name] = fmpq(seed % 37 + 1, seed % 23 + 2)
    tangents = {name: fmpq(_drawn("tan " + called(name)) % 16 + 1, 17) for name in ring.angles}
    return State(Rationals(tangents, ring.angles), values | {"pi": fmpq(355, 113)})


def numbers(
    analysis: Analysis, formulas: Sequence[Any], called: Callable[[str], str] = lambda name: name
) -> list[Scalar]:
    """Values of formulas at the state of ``state``; raises NotRational where they are irrational there."""
    here = state(analysis, called)
    carry = Carrier(analysis.ring, here.numbers, here.values)
    return [carry(formula.polynomial) for formula in formulas]


def motion_numbers(analysis: Analysis, called: Callable[[str], str] = lambda name: name) -> dict[Any, Scalar]:
    """Mass matrix, forcing and kinetic energy at the state of ``state``, by the names of the coordinates there."""
    names = [called(name) for name in analysis.system.coordinates]
    found: dict[Any, Scalar] = {"T": numbers(analysis, [analysis.energy.kinetic_energy], called)[0]}
    for i, row in enumerate(analysis.equations.mass_matrix):
        found |= {(names[i], names[j]): x for j, x in enumerate(numbers(analysis, row, called))}
    return found | dict(zip(names, numbers(analysis, analysis.equations.forcing, called), strict=True))


def clone(description: Description) -> Description:
    return copy.deepcopy(description)
