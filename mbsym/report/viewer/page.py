"""``view.html``: picture, motion, modes and equilibria of one system in one file that asks the network for nothing.

The script and style are the viewer's bundle (editor/src/view.ts), which a content security policy knows by their
hashes; what the description says stands in the file as text and as JSON, and never becomes an element.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

from markupsafe import Markup, escape

from mbsym import __version__
from mbsym.algebra.failures import Failure, NoValue, message_of
from mbsym.analysis import Analysis
from mbsym.analysis.resting import relative_equilibria
from mbsym.analysis.stages import Unavailable
from mbsym.expressions.message import Message
from mbsym.expressions.tree import Expression, substitute
from mbsym.mechanics.rest import given_values, missing_values
from mbsym.model.system import System, rational, with_values
from mbsym.picture.build import picture
from mbsym.picture.encode import as_json, number
from mbsym.problems.relative_equilibria.equilibria import CoordinateValue
from mbsym.problems.stability.verdict import Verdict
from mbsym.problems.stability.words import THEOREMS, Word
from mbsym.report.documents import parts
from mbsym.report.documents.base import plain
from mbsym.report.html.environment import embedded, hash_of
from mbsym.report.language import Language
from mbsym.report.viewer.modes import modes, modes_json
from mbsym.report.viewer.motion import motion, motion_json, moving_picture
from mbsym.simulation import Request, Simulation

#: The words of the viewer itself (editor/src/picture/viewer.ts), which a page brings in its language.
WORDS = (
    "Play", "Pause", "Time", "Speed", "Coordinates", "Motion", "Linear modes", "Equilibria", "Values", "In words",
    "Closer", "Further", "First view", "Amplitude", "How it was computed", "Shown in the picture", "Names",
    "Names of bodies", "Axes", "Axes of bodies: the first red, the second green, the third blue", "Forces",
    "Forces and torques of loads", "Paths", "Paths of mass centres", "Inertia",
    "Ellipsoids of inertia, of rods and in the plane, too",
    "kinetic energy (line)", "energy (its change dashed)", "of a family: ", "any position", "The list is complete.",
    "The list may be incomplete.", "no initial value is given", "initial value", "initial velocity",
    "No coordinate changes in this motion. From elsewhere, or with a velocity, it may be another.",
    "No position near this one keeps the constraints with [[name]] = [[value]]; open: [[constraints]].",
    "Begun where the sliders stood; no initial value is given for [[names]].",
    "limits of the description: [[low]] to [[high]]", "stands in: no value is given.",
    "Mode [[number]]", "Equilibrium [[number]]", "Verdict: [[word]]", "[[name]] any", "[[name]] turns at [[rate]].",
    "; in other angles of [[bodies]], which no slider shows",
    "frequency [[frequency]] per [[unit]] ([[rate]] rad per [[unit]]), damping ratio [[ratio]]", "unit of time",
    "[[swings]], growing", "root 0: in the first approximation nothing drives it back",
    "does not swing: decays by e in [[time]]", "does not swing: grows by e in [[time]]",
    ", shown [[times]] times slower", ", shown [[times]] times faster",
    "body", "on", "joint", "origin", "mass centre", "drawn as", "the frame", "fixed", "slides by", "turns by",
    "ellipsoid of inertia", "point and lines", "Picture: nothing drawn yet",
    "This browser draws nothing (neither WebGL nor a flat canvas): positions are told below in words.",
)  # fmt: skip

#: What its data say by name: verdicts, and what shapes are.
NAMED = (*map(str, Word), *(theorem.name for theorem in THEOREMS), "sphere", "cylinder", "capsule", "ellipsoid")

#: Where the bundles are that `make page` builds.
BUNDLES = Path(__file__).parents[2] / "serving" / "page"


AFTER = "After [[source]]."
NEEDED = "The picture needs JavaScript; nothing of it comes from the network."
KEYS = (
    "Drag or arrow keys: turn; Shift: move; wheel or + and -: closer; 0: first view; space: play; comma and full stop: "
    "a hundredth on."
)

Values = Mapping[str, Expression]


class Page(NamedTuple):
    """The file's text, and what is said with it."""

    text: str
    said: list[str]


def viewed(
    system: System,
    overrides: Values,
    time: float | None = None,
    modes: bool = False,
    equilibria: bool = False,
    watch: Callable[[float], None] = lambda t: None,
) -> Page:
    """The page of a system with what is asked for, and the sentences that are told with it.

    Modes and equilibria that cannot be had are told of; a motion that cannot is not: raises what ``motion`` and
    ``picture`` raise.
    """
    drawn = picture_part(system, overrides)
    moving = None if time is None else motion_part(system, drawn, time, overrides, watch)
    further = {
        "modes": modes_part(system, overrides) if modes else None,
        "equilibria": equilibria_part(system, overrides) if equilibria else None,
    }
    none = {"modes": "no modes: [[why]]", "equilibria": "no equilibria: [[why]]"}
    missing = [(none[name], part["why"]) for name, part in further.items() if part is not None and "why" in part]
    said = [*drawn["sentences"], *(Message(text, why=why) for text, why in missing)]
    return Page(view_page(system, drawn, moving, further["modes"], further["equilibria"]), said)


def view_page(
    system: System,
    picture: dict[str, Any],
    motion: dict[str, Any] | None = None,
    modes: dict[str, Any] | None = None,
    equilibria: dict[str, Any] | None = None,
) -> str:
    """The file's text, of what ``as_json``, ``motion_json``, ``modes_json`` and ``at_rest_json`` give."""
    return _page(system, _data(Language(system.language), picture, motion, modes, equilibria))


def _page(system: System, data: Markup) -> str:
    script, style = bundle()
    policy = (
        f"default-src 'none'; script-src {hash_of(script)}; style-src {hash_of(style)}; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )
    said = " ".join(system.description.split())
    language = Language(system.language)
    source = f" {escape(language.say(AFTER).replace('[[source]]', system.source.rstrip('.')))}" if system.source else ""
    needed, keys = map(language.say, (NEEDED, KEYS))
    return (
        f'<!doctype html>\n<html lang="{escape(system.language)}">\n<head>\n<meta charset="utf-8">\n'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="referrer" '
        f'content="no-referrer">\n<title>{escape(system.name)}</title>\n<style>{style}</style>\n</head>\n'
        '<body class="view">\n'
        f"<header>\n<h1>{escape(system.name)}</h1>\n<p>{escape(said)}{source}</p>\n</header>\n"
        f'<main id="viewer"><noscript>{escape(needed)}</noscript>'
        f"</main>\n<footer>mbsym {escape(__version__)}. {escape(keys)}</footer>\n"
        f'<script type="application/json" id="picture-data">{data}</script>\n<script>{script}</script>\n'
        "</body>\n</html>\n"
    )


def animation_page(run: Simulation) -> str:
    """``animation.html``: the page of a run.  Raises Failure as ``moving_picture`` does."""
    return _page(run.system, run_data(run))


def run_data(run: Simulation, language: Language | None = None) -> Markup:
    """What the viewer reads of a run; the language is that of the description.

    Raises Failure as ``moving_picture`` does.
    """
    drawn, moving = moving_picture(run)
    picture = as_json(drawn)
    own = language or Language(run.system.language)
    return _data(own, picture, motion_json(moving, picture["program"]["inputs"]))


def _data(
    language: Language,
    picture: dict[str, Any],
    motion: dict[str, Any] | None = None,
    modes: dict[str, Any] | None = None,
    equilibria: dict[str, Any] | None = None,
) -> Markup:
    words = {word: language.say(word) for word in (*WORDS, *NAMED)} | {"box": language.say("box", "shape")}
    parts = {"picture": picture, "motion": motion, "modes": modes, "equilibria": equilibria}
    return embedded(
        {
            "words": {} if language.name == "en" else words,
            **{name: part and _said(part, language) for name, part in parts.items()},
        }
    )


def _said(part: dict[str, Any], language: Language) -> dict[str, Any]:
    """A part of the data with its sentences in the language."""
    spoken = {key: [*map(language.say, part[key])] for key in ("sentences", "remarks") if key in part}
    return part | spoken | ({"why": language.say(part["why"])} if "why" in part else {})


def bundle() -> tuple[str, str]:
    """(script, style) of the viewer, which may stand in elements of a page."""
    script, style = ((BUNDLES / name).read_text(encoding="utf-8") for name in ("view.js", "view.css"))
    return _inside(script, "script"), _inside(style, "style")


def _inside(text: str, element: str) -> str:
    """Text that cannot end the element in which it stands.  Raises ValueError where it would."""
    if f"</{element}" in text.lower() or "<!--" in text:
        raise ValueError(f"the bundle holds what ends a <{element}> element")
    return text


def picture_part(system: System, overrides: Values) -> dict[str, Any]:
    """See ``picture``."""
    return as_json(picture(system, overrides))


def motion_part(
    system: System, drawn: dict[str, Any], time: float, overrides: Values, watch: Callable[[float], None]
) -> dict[str, Any]:
    """The motion from 0 to ``time``; raises what ``motion`` raises."""
    return motion_json(motion(system, Request(time), overrides, watch), drawn["program"]["inputs"])


def modes_part(system: System, overrides: Values) -> dict[str, Any]:
    """The modes at the values of the description and of ``overrides``."""
    try:
        return modes_json(modes(Analysis(with_values(system, overrides))))
    except Failure as reason:
        return {"why": message_of(reason)}


def equilibria_part(system: System, overrides: Values) -> dict[str, Any]:
    """The relative equilibria at exact values; a value that is not rational has none."""
    try:
        return at_rest_json(at_rest(with_values(system, overrides), exact_values(system, overrides)))
    except Failure as reason:
        return {"why": message_of(reason)}


def exact_values(system: System, overrides: Values) -> dict[str, Fraction]:
    """The ``overrides`` of parameters that are rational numbers, those in terms of other parameters evaluated."""
    known = {item.name: item.value for item in system.parameters if item.value is not None} | dict(overrides)
    fractions = {}
    for name in (x for x in overrides if x in system.parameter_names):
        value = rational(substitute(overrides[name], {k: v for k, v in known.items() if k != name}))
        if value is not None:
            fractions[name] = value
    return fractions


# Relative equilibria as positions to click through, each with its verdict.


@dataclass(frozen=True)
class Resting:
    """``values`` of the coordinates that it fixes, ``free`` those that may have any value.

    ``texts`` are the values as they are told, exact where they are.  ``other_angles`` names the joints whose values are
    in other angles than the description's, because these are singular there: no slider shows it.  ``family``: one of a
    continuum, ``sample`` of it.
    """

    values: Mapping[str, float]
    texts: Mapping[str, str]
    free: tuple[str, ...]
    verdict: Verdict
    proof: str
    other_angles: str = ""
    family: bool = False


@dataclass(frozen=True)
class AtRest:
    """``complete``: it is proved that there are no others but those of the families."""

    listed: tuple[Resting, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: Mapping[str, float]


def at_rest(system: System, overrides: Mapping[str, Fraction] | None = None) -> AtRest:
    """All relative equilibria at exact values.  Raises NoValue for one that is missing, and what the search raises."""
    values = given_values(system, overrides or {})
    for name in missing_values(system, values):
        raise NoValue(name)
    try:
        equilibria = relative_equilibria(system, values)
    except Unavailable as withdrawn:
        return AtRest((), False, (withdrawn.failure.reason,), {})
    listed = [_resting(x.values, x.free, x.verdict, x.proof, x.coordinates_of) for x in equilibria.equilibria]
    listed += [_resting(x.sample, x.free, x.verdict, "", x.coordinates_of, True) for x in equilibria.families]
    return AtRest(tuple(listed), equilibria.complete, equilibria.remarks, dict(equilibria.turning))


def _resting(
    values: Iterable[CoordinateValue],
    free: tuple[str, ...],
    verdict: Verdict,
    proof: str,
    other: str,
    family: bool = False,
) -> Resting:
    listed = list(values)
    return Resting(
        {x.name: x.value for x in listed}, {x.name: x.text for x in listed}, free, verdict, proof, other, family
    )


def at_rest_json(equilibria: AtRest) -> dict[str, Any]:
    """What a page reads."""
    return {
        "equilibria": [
            {
                "values": {name: number(value) for name, value in x.values.items()},
                "texts": dict(x.texts),
                "free": list(x.free),
                "verdict": plain(parts.Verdict.from_result(x.verdict)),
                "proof": x.proof,
                "otherAngles": x.other_angles,
                "family": x.family,
            }
            for x in equilibria.listed
        ],
        "complete": equilibria.complete,
        "remarks": list(equilibria.remarks),
        "turning": {name: number(value) for name, value in equilibria.turning.items()},
    }
