"""MJCF (MuJoCo): bodies within bodies, joints inside them, inertia given or made of their geoms; sites are frames.

Orientations by ``euler`` are exact; by ``quat``, ``axisangle``, ``xyaxes``, ``zaxis`` and ``fromto`` they become yaw,
pitch, roll, exact where these are multiples of pi/4 or pi/6 and else rounded to the digits of a double.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from decimal import Decimal
from fractions import Fraction

from mbsym.expressions.parser import ascii_safe
from mbsym.expressions.place import Complaints
from mbsym.model.admissibility import ROUNDING, inertia_violation
from mbsym.source.robots.geoms import (
    TURNING,
    Angles,
    checked,
    is_solid,
    matter_of,
    of_matrix,
    orientation,
    shape_of,
    weighs,
)
from mbsym.source.robots.reader import (
    NO_TENSOR,
    NOWHERE,
    Element,
    Reader,
    Spelling,
    Texts,
    check_spelling,
    decimal,
    degrees,
    number,
    words_of,
)
from mbsym.source.robots.robot import GROUND, Inertial, Joint, Link, Moments, Robot, Turns, at_zero, ties

_KINDS = {"hinge": "turn", "slide": "slide", "ball": "ball", "free": "free"}

#: Sections, and elements of bodies, that rigid bodies in a tree have no place for.
_SECTIONS = {
    "tendon": "tendon",
    "sensor": "sensor",
    "contact": "contact pair",
    "deformable": "deformable body",
    "extension": "plugin",
    "keyframe": "state to begin in (<key>)",
}
_SAVED = 'let MuJoCo save the compiled model with <compiler saveinertial="true"/>'

#: What stands for other elements, and what to do about it.
_NOT_READ = {
    "include": "what it stands for is in another file, which is not beside this one or was included before",
    "attach": "what it stands for is in another model",
    "replicate": "it stands for copies of what is inside",
}
_COMPILED = "MuJoCo writes the model without it: mj_saveLastXML, or Save xml in its viewer"

#: Settings of the compiler that are one of these words; the first one where it is not given.
_WORDS = {
    "angle": ("degree", "radian"),
    "inertiafromgeom": ("auto", "true", "false"),
    "autolimits": ("true", "false"),
}
_INSIDE = {"composite": "composite body", "flexcomp": "flexible body", "replicate": ""}

_TURNS = "quat axisangle xyaxes zaxis euler"
_EQUALITY = "name class active solref solimp"

#: What matters here: what weighs, turns, slides, is tied, and how all of it is read (MuJoCo 3, XML reference).
_ATTRIBUTES = words_of(
    {
        "compiler": "autolimits boundmass boundinertia settotalmass balanceinertia strippath coordinate angle fitaabb "
        "eulerseq meshdir texturedir assetdir discardvisual usethread fusestatic inertiafromgeom inertiagrouprange "
        "saveinertial exactmeshinertia convexhull alignfree",
        "option": "timestep apirate impratio gravity wind magnetic density viscosity o_margin o_solref o_solimp "
        "o_friction integrator collision cone jacobian solver iterations tolerance ls_iterations ls_tolerance "
        "noslip_iterations noslip_tolerance mpr_iterations mpr_tolerance ccd_iterations ccd_tolerance sleep_tolerance "
        "sdf_iterations sdf_initpoints actuatorgroupdisable",
        "worldbody": f"name childclass pos {_TURNS} gravcomp mocap sleep user",
        "body": f"name childclass pos {_TURNS} gravcomp mocap sleep user",
        "frame": f"name childclass pos {_TURNS}",
        "inertial": f"pos {_TURNS} mass diaginertia fullinertia",
        "joint": "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit "
        "solreffriction solimpfriction stiffness range actuatorfrcrange actuatorgravcomp margin ref springref armature "
        "damping frictionloss user",
        "freejoint": "name group align",
        "geom": "name class type contype conaffinity condim group priority size material friction mass density "
        f"shellinertia solmix solref solimp margin gap fromto pos {_TURNS} hfield mesh fitscale rgba fluidshape "
        "fluidcoef user",
        "flag": "constraint equality frictionloss limit contact passive spring damper gravity clampctrl warmstart "
        "filterparent actuation refsafe sensor midphase eulerdamp autoreset nativeccd island override energy fwdinv "
        "invdiscrete multiccd sleep diagexact",
        "equality/joint": f"{_EQUALITY} joint1 joint2 polycoef",
        "equality/connect": f"{_EQUALITY} body1 body2 anchor site1 site2",
        "equality/weld": f"{_EQUALITY} body1 body2 relpose anchor site1 site2 torquescale",
    }
)

#: What may stand in the world and in bodies, and in bodies alone; what moves or weighs in frames is told elsewhere.
_ELEMENTS = "body geom site camera light plugin composite flexcomp attach frame replicate"
_OF_BODIES = "inertial joint freejoint"

_SPELLING = Spelling(
    _ATTRIBUTES,
    words_of(
        {
            "body": f"{_ELEMENTS} {_OF_BODIES}",
            "frame": f"{_ELEMENTS} {_OF_BODIES}",
            "worldbody": _ELEMENTS,
            "default": "default joint geom site camera light pair equality tendon mesh material general motor position "
            "velocity intvelocity damper cylinder muscle adhesion dcmotor plugin",
            "equality": "connect weld joint tendon flex flexvert flexstrain distance",
            "option": "flag",
            "mujoco": "compiler option size visual statistic default custom extension asset worldbody contact "
            "deformable equality tendon actuator sensor keyframe include",
        }
    ),
    words_of({"body": "inertial freejoint"}),
)


def _read(root: Element) -> Iterator[tuple[str, Element]]:
    """What is read: settings, default classes, bodies with what stands in them, and ties, each with its section."""
    yield "", root
    for section in root.children:
        if section.tag in ("compiler", "option", "equality"):
            yield from ((section.tag, element) for element in section.walk())
        elif section.tag in ("default", "worldbody"):
            yield from ((section.tag, element) for element in _within(section))


def _within(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        if child.tag in ("body", "frame", "default"):
            yield from _within(child)
        else:
            yield child


_MAIN = "main"


def read_mjcf(root: Element, complaints: Complaints, exact: bool = False) -> Robot | None:
    """The robot of an MJCF file, or None with complaints; ``exact``: angles in radians stay as they are printed."""
    reader = Reader(complaints, exact)
    for element in root.walk():
        if element.tag in _NOT_READ:
            reader.error("unsupported", f"<{element.tag}> is not read: {_NOT_READ[element.tag]}", element, _COMPILED)
    check_spelling(_read(root), _SPELLING, reader)
    for section in root.children:
        for _ in section.children if section.tag in _SECTIONS else ():
            reader.leave_out(_SECTIONS[section.tag])
    worlds = root.all("worldbody")
    if not worlds:
        reader.error("missing-key", "there is no <worldbody>", root)
        return None
    bodies = _Bodies(root, reader)
    links = [link for world in worlds for link in bodies.links(world, GROUND, bodies.childclass(world, ""))]
    links.sort(key=lambda link: link.name in bodies.sites and link.parent == GROUND)  # the first one is a body
    if not bodies.bodies and not complaints.errors:
        reader.error("missing-key", "there is no <body>", worlds[0])
    name = root.get("model") or "robot"
    gravity = _gravity(root, reader)
    places = {link.name: link for link in links}
    tied = tuple(ties(bodies.tied(root), places, bodies.site_links, reader))
    links = [replace(link, joints=tuple(_started(joint, link, places) for joint in link.joints)) for link in links]
    if not complaints.errors:
        links = _of_mass(links, root, reader)
    if complaints.errors:
        return None
    return Robot(name, tuple(links), gravity, reader.left_out(), reader.snapped(), tied)


def _started(joint: Joint, link: Link, links: Mapping[str, Link]) -> Joint:
    """A free joint with the place, yaw, pitch and roll that its body has in the file."""
    if joint.kind != "free":
        return joint
    place, ((a, d, g), (b, e, h), (c, f, i)) = at_zero(link.name, links)
    angles = dict(of_matrix(((a, b, c), (d, e, f), (g, h, i))))
    return replace(joint, start=(*place, *(angles.get(axis, "0") for axis in (3, 2, 1))))


def _of_mass(links: list[Link], root: Element, reader: Reader) -> list[Link]:
    """With ``settotalmass`` all masses and moments are multiplied such that the sum of masses is what it says."""
    section = _together(root, "compiler")
    whole = reader.number(section, "settotalmass", "-1")
    masses = [one.mass for link in links for one in link.inertials if one.mass != "0"]
    if float(whole) <= 0 or not masses:
        return links
    factor = f"{whole}/({' + '.join(masses)})"
    numbers = [decimal(mass) for mass in masses]
    if None not in numbers:
        factor = str(Fraction(whole) / sum(Fraction(mass) for mass in masses))

    def scaled(text: str) -> str:
        return text if text == "0" else f"{text}*({factor})" if decimal(text) is not None else f"({text})*({factor})"

    return [
        replace(
            link,
            inertials=tuple(
                replace(one, mass=scaled(one.mass), tensor=_six(map(scaled, one.tensor))) for one in link.inertials
            ),
        )
        for link in links
    ]


def _six(parts: Iterable[str]) -> tuple[str, str, str, str, str, str]:
    xx, xy, xz, yy, yz, zz = parts
    return xx, xy, xz, yy, yz, zz


def _together(root: Element, tag: str) -> Element:
    """Sections of a tag as one: what a later one says stands."""
    elements = root.all(tag)
    attributes = {key: value for element in elements for key, value in element.attributes.items()}
    return Element(
        tag, attributes, elements[-1].span if elements else root.span, [c for e in elements for c in e.children]
    )


def _gravity(root: Element, reader: Reader) -> Texts:
    option = _together(root, "option")
    gravity = reader.three(option, "gravity", "0 0 -9.81")
    for key, label in (("density", "density"), ("viscosity", "viscosity")):
        if float(reader.number(option, key)):
            reader.leave_out(f"forces of a fluid ({label})")
    return NOWHERE if "gravity" in _disabled(root) else gravity


def _disabled(root: Element) -> set[str]:
    """What the flags of <option> switch off; ``passive`` is what springs and dampers were together before 3.3."""
    flags = {key for key, word in _together(_together(root, "option"), "flag").attributes.items() if word == "disable"}
    return flags | ({"spring", "damper"} if "passive" in flags else set())


def _driven(root: Element, reader: Reader, defaults: Defaults, joints: set[str]) -> set[str]:
    """The joints that an actuator drives; what else actuators do is left out.

    The input is the torque or force in the joint: that of an actuator times its gear.
    """
    driven = set()
    for section in root.all("actuator"):
        for element in (defaults.of(child, "") for child in section.children):
            joint = element.get("joint") or element.get("jointinparent")
            if not joint:
                reader.leave_out(f"actuator of no joint ({element.tag})")
                continue
            if joint not in joints:
                reader.error("unknown-name", f"there is no joint {ascii_safe(joint)}", element)
            driven.add(joint)
            if element.tag != "motor":
                reader.leave_out(f"law of an actuator ({element.tag})")
            if any(element.get(key) for key in ("armature", "damping")):
                reader.leave_out("armature and damping of an actuator")
            if any(element.get(key) for key in ("ctrlrange", "forcerange")):
                reader.leave_out("limits of an actuator")
            count = len(element.get("gear").split())
            if count and float(reader.numbers(element, "gear", count)[0]) != 1:
                reader.leave_out("gear of an actuator (the input is the torque or force in the joint)")
    return driven


class _Bodies:
    """Reads bodies with the settings of the compiler and the defaults of classes."""

    def __init__(self, root: Element, reader: Reader) -> None:
        self.reader = reader
        self.defaults = Defaults(root, reader)
        section = _together(root, "compiler")
        compiler = section.attributes
        for key, words in _WORDS.items():
            if compiler.get(key, words[0]) not in words:
                message = f"'{key}' is {ascii_safe(compiler[key])}"
                reader.error("bad-word", message, section, f"one of {', '.join(words)}")
        self.groups = tuple(map(float, reader.numbers(section, "inertiagrouprange", 2, "0 5")))
        self.angles = Angles(compiler.get("angle", "degree") != "radian", compiler.get("eulerseq", "xyz"))
        self.autolimits = compiler.get("autolimits", "true") != "false"
        inside = [element for world in root.all("worldbody") for element in world.walk()]
        self.joint_names = reader.names((x for x in inside if x.tag in ("joint", "freejoint")), "joint")
        self.driven = _driven(root, reader, self.defaults, self.joint_names)
        self.disabled = _disabled(root)
        self.from_geoms = compiler.get("inertiafromgeom", "auto")
        self.names: set[str] = set()
        self.sites: set[str] = set()
        self.site_links: dict[str, str] = {}
        self.world_frames: set[str] = {GROUND}
        self.bodies = {element.get("name") for element in inside if element.tag == "body"}
        self.balanced = compiler.get("balanceinertia", "false") == "true"
        for key in ("boundmass", "boundinertia"):
            if compiler.get(key, "0") not in ("0", "false", "-1"):
                reader.leave_out(f"setting of the compiler ({key})")
        if compiler.get("coordinate", "local") != "local":
            reader.error("unsupported", "global coordinates are not read", section)

    def tied(self, root: Element) -> Iterator[Element]:
        """The elements of <equality>, with what their classes say of them; none where constraints are switched off."""
        for element in (child for section in root.all("equality") for child in section.children):
            resolved = self.defaults.of(element, "", "equality")
            off = self.disabled & {"equality", "constraint"}
            yield replace(resolved, attributes={**resolved.attributes, "active": "false"}) if off else resolved

    def nameless(self, body: str) -> str:
        """What a joint without a name is called: as its body, or so that no other joint is called so."""
        name, index = body, 2
        while name in self.joint_names:
            name, index = f"{body} {index}", index + 1
        self.joint_names.add(name)
        return name

    def childclass(self, element: Element, above: str) -> str:
        """The default class of what is inside an element."""
        return self.defaults.checked(element, "childclass") or above

    def links(self, above: Element, parent: str, childclass: str, weighing: bool = False) -> Iterator[Link]:
        """The bodies and frames inside an element, each followed by what is inside it, and then its sites.

        ``weighing``: whether geoms in frames weigh.
        """
        for element in above.children:
            if element.tag == "frame":
                yield from self.frame(element, parent, childclass, weighing)
            if element.tag != "body":
                continue
            name = element.get("name") or f"body {len(self.names) + 1}"
            if name in self.names:
                self.reader.error("repeated-name", f"a second body called {ascii_safe(name)}", element)
            self.names.add(name)
            inside = self.childclass(element, childclass)
            yield self.link(name, element, parent, inside)
            yield from self.links(element, name, inside, self.takes_geoms(element, inside))
        for site in above.all("site"):
            yield from self.site(self.defaults.of(site, childclass), parent)

    def takes_geoms(self, body: Element, childclass: str) -> bool:
        """Whether the matter of a body is that of its geoms: where none weighs, an <inertial> stands."""
        if body.first("inertial") is None:
            return self.from_geoms != "false"
        return self.from_geoms == "true" and self.has_matter(body, childclass)

    def has_matter(self, element: Element, childclass: str) -> bool:
        """Whether geoms of a body weigh, those in its frames included."""
        geoms = [self.defaults.of(geom, childclass) for geom in element.all("geom")]
        inside = ((frame, self.childclass(frame, childclass)) for frame in element.all("frame"))
        return any(self.counts(geom) for geom in geoms) or any(self.has_matter(*frame) for frame in inside)

    def counts(self, geom: Element) -> bool:
        """Whether a geom weighs, and is of a group whose matter is that of bodies."""
        low, high = self.groups
        in_group = low <= float(self.reader.number(geom, "group")) <= high
        return in_group and geom.get("type", "sphere") not in ("plane", "hfield") and weighs(geom, self.reader)

    def frame(self, element: Element, parent: str, childclass: str, weighing: bool) -> Iterator[Link]:
        """A link without joints: what is inside is placed relative to it; its geoms belong to the body around it."""
        for child in element.children:
            if child.tag in ("joint", "freejoint", "inertial"):
                self.reader.error("unsupported", f"<{child.tag}> in <frame> is not read", child, _COMPILED)
            elif child.tag in _INSIDE:
                self.reader.leave_out(_INSIDE[child.tag])
        own = element.get("name") or "frame"
        name, index = own, 2
        while name in self.names or name in self.bodies:
            name, index = f"{own} {index}", index + 1
        self.names.add(name)
        if parent in self.world_frames:
            self.world_frames.add(name)
        inside = self.childclass(element, childclass)
        place, turned = self.pose(element)
        geoms = self.geoms(element, inside) if parent not in self.world_frames else []
        shapes = tuple(shape_of(geom, self.angles, self.reader) for geom in geoms if is_solid(geom))
        yield Link(name, parent, place, turned, (), self.of_geoms(geoms) if weighing else (), shapes, element.span)
        yield from self.links(element, name, inside, weighing)

    def site(self, element: Element, parent: str) -> Iterator[Link]:
        """A site with a name is a massless frame; others nothing can name."""
        name = element.get("name")
        if not name or element.get("fromto"):
            self.reader.leave_out("site with two ends (fromto)" if name else "site without a name")
            return
        own = f"site {name}" if name in self.bodies else name
        if own in self.names:
            self.reader.error("repeated-name", f"a second site called {ascii_safe(name)}", element)
        self.names.add(own)
        self.sites.add(own)
        self.site_links[name] = own
        place, turned = self.pose(element)
        yield Link(own, parent, place, turned, span=element.span)

    def link(self, name: str, element: Element, parent: str, childclass: str) -> Link:
        reader = self.reader
        place, turned = self.pose(element)
        joints = tuple(self.joints(name, element, childclass))
        alone = len(joints) == 1 and parent in self.world_frames
        if any(joint.kind == "free" for joint in joints) and not alone:
            reader.error("unsupported", "a free joint moves a body of the world, alone", element)
        for child in element.children:
            if child.tag in _INSIDE:
                reader.leave_out(_INSIDE[child.tag])
        for attribute, none, feature in (
            ("gravcomp", "0", "compensation of gravity"),
            ("mocap", "false", "mocap body"),
        ):
            if element.get(attribute, none) != none:
                reader.leave_out(feature)
        geoms = self.geoms(element, childclass)
        solid = [geom for geom in geoms if is_solid(geom)]
        shapes = tuple(shape_of(geom, self.angles, reader) for geom in solid)
        inertial = element.first("inertial")
        if self.takes_geoms(element, childclass):
            matter = self.of_geoms(geoms)
        else:
            matter = () if inertial is None else (self.inertial(inertial),)
        return Link(name, parent, place, turned, joints, matter, shapes, element.span)

    def geoms(self, element: Element, childclass: str) -> list[Element]:
        """The geoms of a body or frame; what of them has no place here is noted."""
        elements = [self.defaults.of(geom, childclass) for geom in element.all("geom")]
        elements = [geom for geom in elements if checked(geom, self.reader)]
        for geom in elements:
            if not is_solid(geom):
                self.reader.leave_out(f"geom of the type {geom.get('type', 'sphere')}")
            elif geom.get("contype", "1") != "0" or geom.get("conaffinity", "1") != "0":
                self.reader.leave_out("contact (<geom>)")
        return elements

    def of_geoms(self, geoms: list[Element]) -> tuple[Inertial, ...]:
        """The matter of a body's geoms; complains about what weighs something that is not known here."""
        reader, inertials = self.reader, []
        for geom in filter(self.counts, geoms):
            if not is_solid(geom):
                message = f"the mass of a {geom.get('type')} is not known here, and the body has no <inertial>"
                reader.error("unsupported", message, geom, _SAVED)
            elif geom.get("shellinertia") == "true":
                reader.error("unsupported", "the mass of a shell ('shellinertia') is not read", geom, _SAVED)
            elif (matter := matter_of(geom, self.angles, reader)) is not None:
                inertials.append(matter)
        return tuple(inertials)

    def pose(self, element: Element, place: str | None = "0 0 0") -> tuple[Texts, Turns]:
        """Where it stands, by default at ``place`` (None: the file has to say it), and how it is turned."""
        return self.reader.three(element, "pos", place), orientation(element, self.angles, self.reader)

    def joints(self, body: str, element: Element, childclass: str) -> Iterator[Joint]:
        for child in element.children:
            if child.tag == "freejoint":
                yield Joint(child.get("name") or self.nameless(body), "free")
            elif child.tag == "joint":
                yield self.joint(body, self.defaults.of(child, childclass))

    def joint(self, body: str, element: Element) -> Joint:
        reader = self.reader
        word = element.get("type") or "hinge"
        kind = _KINDS.get(word)
        if kind is None:
            message = f"a joint of the type {ascii_safe(word)}"
            reader.error("unsupported", message, element, f"one of {', '.join(_KINDS)}")
            kind = "turn"
        axis = reader.three(element, "axis", "0 0 1")
        if all(float(part) == 0 for part in axis):
            reader.error("bad-axis", "an axis of length zero", element)
            axis = ("0", "0", "1")
        if float(reader.number(element, "frictionloss")):
            reader.leave_out("dry friction")
        if element.get("actuatorfrcrange"):
            reader.leave_out("limits of an actuator")
        armature = reader.number(element, "armature")
        if float(armature) < 0:
            reader.error("impossible-inertia", "an armature is not negative", element)
        if kind == "free" and float(armature):
            reader.leave_out("armature of a free joint")
            armature = "0"
        if kind in ("ball", "free") and float(reader.number(element, "stiffness")):
            reader.leave_out("stiffness of ball and free joints")
        if kind == "ball" and element.get("range") and element.get("limited", "auto") != "false":
            reader.leave_out("limit of a ball joint")
        for key in ("damping", "stiffness"):
            if len(element.get(key).split()) > 1:
                reader.error("unsupported", f"'{key}' that is a polynomial is not read", element, "give one number")
        if any(float(part) for part in reader.numbers(element, "springdamper", 2, "0 0")):
            reader.error(
                "unsupported", "a joint with 'springdamper' is not read", element, "give stiffness and damping"
            )
        turns = kind == "turn"
        ref = reader.number(element, "ref") if kind in ("turn", "slide") else "0"
        ref = self.angle(ref) if turns else ref
        limited = element.get("limited", "auto")
        limits = None
        if (
            element.get("range")
            and (limited == "true" or (limited == "auto" and self.autolimits))
            and kind in ("turn", "slide")
            and not self.disabled & {"limit", "constraint"}
        ):
            low, high = reader.numbers(element, "range", 2)
            limits = (self.angle(low), self.angle(high)) if turns else (low, high)
        rest = reader.number(element, "springref")
        return Joint(
            element.get("name") or self.nameless(body),
            kind,
            axis,
            reader.three(element, "pos") if kind in ("turn", "ball") else NOWHERE,
            limits,
            "0" if "damper" in self.disabled else reader.number(element, "damping"),
            "0" if "spring" in self.disabled else reader.number(element, "stiffness"),
            self.angle(rest) if turns else rest,
            armature,
            kind in ("turn", "slide") and element.get("name") in self.driven,
            ref=ref,
            start=(ref,) if ref != "0" else (),
        )

    def angle(self, text: str) -> str:
        return degrees(text) if self.angles.in_degrees else number(text)

    def inertial(self, element: Element) -> Inertial:
        reader = self.reader
        place, turned = self.pose(element, None)
        mass = reader.number(element, "mass", None)
        if float(mass) < 0:
            reader.error("impossible-mass", "a mass is not negative", element)
        turned_besides = [key for key in ("diaginertia", *TURNING) if element.get(key)]
        if element.get("fullinertia") and turned_besides:
            message = f"<inertial> has 'fullinertia' and '{turned_besides[0]}'"
            reader.error("conflicting-keys", message, element, "'fullinertia' is in the axes of the body")
        xx = yy = zz = xy = xz = yz = "0"
        if element.get("fullinertia"):
            xx, yy, zz, xy, xz, yz = reader.numbers(element, "fullinertia", 6)
        elif element.get("diaginertia"):
            xx, yy, zz = reader.three(element, "diaginertia")
        else:
            reader.leave_out(NO_TENSOR)
        return Inertial(mass, place, turned, self.of_a_body((xx, xy, xz, yy, yz, zz), element))

    def of_a_body(self, tensor: Moments, element: Element) -> Moments:
        """A tensor that a body may have, but for rounding; with 'balanceinertia' equal moments in place of others."""
        xx, xy, xz, yy, yz, zz = map(Fraction, tensor)
        why = inertia_violation(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)), ROUNDING)
        if why is None:
            return tensor
        if self.balanced:
            trace = xx + yy + zz
            mean = number(str(Decimal(trace.numerator) / Decimal(3 * trace.denominator)))
            return (mean, "0", "0", mean, "0", mean)
        hint = 'MuJoCo refuses it, too; with <compiler balanceinertia="true"/> the mean of its moments is taken'
        self.reader.error("impossible-inertia", why, element, hint)
        return tensor


class Defaults:
    """Classes within classes: an inner one has what the outer ones say, unless it says otherwise.

    The outermost class is that of everything without a class, whatever it is called; several such sections are one.
    """

    def __init__(self, root: Element, reader: Reader) -> None:
        self.reader = reader
        self.known: dict[str, dict[str, dict[str, str]]] = {_MAIN: {}}
        for element in root.all("default"):
            self._read(element, _MAIN, self.known[_MAIN])
            if name := element.get("class"):
                self.known[name] = self.known[_MAIN]

    def _read(self, element: Element, name: str, above: dict[str, dict[str, str]]) -> None:
        own = {tag: dict(attributes) for tag, attributes in above.items()}
        for child in element.children:
            if child.tag != "default":
                own[child.tag] = {**own.get(child.tag, {}), **child.attributes}
        self.known[name] = own
        for child in element.all("default"):
            self._read(child, child.get("class"), own)

    def of(self, element: Element, childclass: str, tag: str = "") -> Element:
        """The element with what its class, or that of the bodies around it, says beside its own attributes.

        ``tag``: what classes call it, where that is not its own.
        """
        name = self.checked(element, "class") or childclass or _MAIN
        defaults = self.known.get(name, {}).get(tag or element.tag, {})
        if any(key in element.attributes for key in TURNING):  # one way to turn stands for all others
            defaults = {key: value for key, value in defaults.items() if key not in TURNING}
        return Element(element.tag, {**defaults, **element.attributes}, element.span, element.children)

    def checked(self, element: Element, attribute: str) -> str:
        """The class that an attribute names, "" for none; complains about one that there is not."""
        name = element.get(attribute)
        if name and name not in self.known:
            self.reader.error("unknown-name", f"there is no default class {ascii_safe(name)}", element)
        return name
