"""Attributes and elements of MJCF that are none (MuJoCo 3, XML reference): a misspelt one must not go by in silence."""

from __future__ import annotations

from collections.abc import Iterator

from mbsym.expressions.parser import ascii_safe
from mbsym.source.robots.elements import Element
from mbsym.source.robots.reader import Reader
from mbsym.source.scope import closest

_TURNS = "quat axisangle xyaxes zaxis euler"

#: What matters here: what weighs, turns, slides, and how all of it is read.
_ATTRIBUTES = {
    tag: frozenset(words.split())
    for tag, words in {
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
    }.items()
}

#: What may stand in a body.
_ELEMENTS = "body inertial joint freejoint geom site camera light plugin composite flexcomp attach frame replicate"
_INSIDE = frozenset(_ELEMENTS.split())

#: So much has a slip of the pen in common with what was meant (``mas``, ``dampng``, ``diagInertia``).
_ALIKE = 0.75


def check_spelling(root: Element, reader: Reader) -> None:
    """Complains about what looks like a slip of the pen, at its element; what looks like nothing known is left out.

    The latter may be of a later MuJoCo.  Only what is read here is looked at: sections that are left out have elements
    of the same names with other attributes.
    """
    for element in _read(root):
        known = _ATTRIBUTES.get(element.tag, frozenset())
        for name in element.attributes if known else ():
            if name not in known:
                _tell(f"attribute {ascii_safe(name)} of <{element.tag}>", name, known, element, reader)
        for child in element.children if element.tag in ("body", "worldbody", "frame") else ():
            if child.tag not in _INSIDE:
                _tell(
                    f"element <{ascii_safe(child.tag).strip(chr(39))}> in <{element.tag}>",
                    child.tag,
                    _INSIDE,
                    child,
                    reader,
                )


def _tell(what: str, word: str, known: frozenset[str], element: Element, reader: Reader) -> None:
    meant = closest(word, sorted(known), _ALIKE)
    if meant is None:
        reader.leave_out(f"unknown {what}")
    else:
        reader.error("unknown-key", f"unknown {what}", element, f"did you mean '{meant}'?")


def _read(root: Element) -> Iterator[Element]:
    """What is read: settings, default classes, and bodies with what stands in them."""
    for section in root.children:
        if section.tag in ("compiler", "option"):
            yield section
        elif section.tag in ("default", "worldbody"):
            yield from _within(section)


def _within(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        if child.tag in ("body", "frame", "default"):
            yield from _within(child)
        else:
            yield child
