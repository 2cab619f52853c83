"""What single options of ``mbsym simulate`` add to its request; whatever is wrong with them joins the complaints."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbsym.expressions.condition import AxisText, Condition, parse_axes, parse_condition
from mbsym.expressions.message import Message, joined, worded
from mbsym.expressions.place import Complaints
from mbsym.expressions.safe import quoted
from mbsym.source import render_option
from mbsym.source.scope import did_you_mean, listed
from mbsym_cli.options import Options, place_in
from mbsym_cli.simulate.options import NARROWEST, ORDERS, WIDEST, WORK

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.planning.models import Model
    from mbsym.numerics.scenario import Scenario
    from mbsym.simulation import Request
    from mbsym.simulation.request import Earlier


def with_further(request: Request, texts: Mapping[str, Any], system: System | None, asked: Options) -> Request:
    """The request with all of them; how an earlier run is gone on from is settled by ``going_on``."""
    if texts["variables"] is not None:
        request = _in_variables(request, texts["variables"], system, asked)
    if texts["fixed"] is not None and system is not None:
        request = _fixed(request, texts["fixed"], system, asked)
    if texts["path"] is not None and system is not None:
        request = _continued(request, texts["path"], system, asked)
    if system is not None and any(texts[name] for name in ("events", "stops", "section", "axes")):
        request = _watched(request, texts, system, asked)
    model = _model(texts, system, asked)
    request = _certified(request, texts, asked)
    return request if model is None else replace(request, model=model)


# --- ``--variables`` ---


def declared(texts: Mapping[str, Any]) -> bool:
    """Whether declared variables are integrated, where there are some."""
    return (texts["variables"] or "declared").lower() == "declared"


def integrated(system: System | None, texts: Mapping[str, Any]) -> System | None:
    """The system with what is integrated in the place of coordinates and velocities, where that can be told."""
    from mbsym.algebra.failures import Failure
    from mbsym.simulation import integrated_system

    if system is None or not system.speeds:
        return system
    try:
        return integrated_system(system, (texts["variables"] or "declared").lower())
    except Failure:
        return system  # said when it is integrated


def _in_variables(request: Request, text: str, system: System | None, asked: Options) -> Request:
    word = asked.word("--variables", text.lower(), ("declared", "coordinates"), "choice of variables")
    if word is not None and system is not None and not system.speeds:
        hint = "coordinates and their velocities are integrated; leave --variables out"
        asked.complain("--variables", "idle-option", "the description declares no speeds", hint)
    return request if word is None else replace(request, variables=word)


# --- ``--fixed`` ---


def _fixed(request: Request, text: str, system: System, asked: Options) -> Request:
    if not system.constraints:
        hint = "initial values stay as they are given; leave --fixed out"
        asked.complain("--fixed", "idle-option", "there are no constraints that initial values would follow", hint)
        return request
    known = (*system.coordinates, *system.velocities)
    names = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    for name in names:
        if name not in known:
            way = did_you_mean(name, known) or listed("these can be fixed", known)
            told = Message("there is nothing called [[name]] to be fixed", name=quoted(name))
            asked.complain("--fixed", "unknown-name", told, way)
    return replace(request, fixed=tuple(name for name in names if name in known))


# --- ``--certify`` ---


def _certified(request: Request, texts: Mapping[str, Any], asked: Options) -> Request:
    width = asked.number("--certify", texts["width"], NARROWEST, WIDEST)
    seconds = asked.number("--certify-seconds", texts["certify_seconds"], 1e-3, 1e9)
    if seconds is None:
        return replace(request, certify=width, certify_limit=WORK)
    return replace(request, certify=width, certify_seconds=seconds)


# --- ``--event``, ``--stop``, ``--section``, ``--axes`` ---


def _watched(request: Request, texts: Mapping[str, Any], system: System, asked: Options) -> Request:
    from mbsym.simulation.watching import Watch, section_of

    events = _conditions("--event", texts["events"], system, asked)
    stops = _conditions("--stop", texts["stops"], system, asked)
    surfaces = _conditions("--section", () if texts["section"] is None else (texts["section"],), system, asked)
    axes = _axes(texts["axes"], system, asked)
    sections = [section_of(system, surface, axes) for surface in surfaces]
    return replace(request, events=Watch(events, stops, sections[0] if sections else None))


def _conditions(option: str, texts: Sequence[str], system: System, asked: Options) -> tuple[Condition, ...]:
    """The conditions that are sound."""
    from mbsym.numerics.events.surfaces import known_names

    found = []
    for text in (" ".join(one.splitlines()) for one in texts):
        complaints = Complaints()
        found.append(parse_condition(text, known_names(system), complaints, place_in))
        asked.complaints += [render_option(one, text, option, asked.say) for one in complaints.sorted()]
    return tuple(one for one in found if one is not None)


def _axes(text: str | None, system: System, asked: Options) -> tuple[AxisText, ...]:
    from mbsym.numerics.events.surfaces import known_names

    complaints = Complaints()
    found = () if text is None else parse_axes(text, known_names(system), complaints, place_in)
    asked.complaints += [render_option(one, text or "", "--axes", asked.say) for one in complaints.sorted()]
    return found


# --- ``--gravity``, ``--linear``, ``--without``: the model that was settled by hand ---


def _model(texts: Mapping[str, Any], system: System | None, asked: Options) -> Model | None:
    """None where nothing was said."""
    from mbsym.numerics.planning.models import Model

    order: int | str | None = None
    if texts["gravity"] is not None:
        word = asked.word("--gravity", texts["gravity"], ORDERS, "order")
        order = int(word) if word is not None and word.isdigit() else word
        if system is not None and not system.newtonian_fields:
            asked.complain("--gravity", "unsuitable-option", "there is no Newtonian gravity in this description")
    if texts["linear"] and system is not None and not system.motion:
        hint = "the description says with 'motion:' what the equations are linearised about"
        asked.complain("--linear", "unsuitable-option", "there is no unperturbed motion", hint)
    for name in texts["without"] if system is not None else ():
        assert system is not None
        asked.word("--without", name, system.parameter_names, "parameter")
    if order is None and not texts["linear"] and not texts["without"]:
        return None
    return Model(order, texts["linear"], tuple(dict.fromkeys(texts["without"])))


# --- ``--continue`` ---


def _continued(request: Request, path: Path, system: System, asked: Options) -> Request:
    from mbsym.report.runs.earlier_run import Unfit, read_earlier

    try:
        earlier = read_earlier(path, system)
    except Unfit as error:
        asked.complain("--continue", "unfit-run", error.reason, "take the simulation.json of a run of this FILE")
        return request
    if 0 < request.time <= earlier.time:
        there = f"{earlier.time:.9g}"
        hint = Message("--time is counted from the start: take one beyond [[time]]", time=there)
        told = Message("that run is at t = [[time]] already", time=there)
        asked.complain("--time", "conflicting-options", told, hint)
    return replace(request, earlier=earlier)


def begun_at(given: Scenario | None, request: Request) -> Scenario | None:
    """With the initial state that a run takes; what was given where there is an answer to that question only later."""
    if given is None or not given.system.constraints or request.earlier is None:
        return given
    from mbsym.algebra.failures import Failure
    from mbsym.numerics.closing import closed

    try:
        return closed(given, request.fixed).scenario
    except Failure:
        return given


def going_on(request: Request, given: Scenario | None, typed: Collection[str], asked: Options) -> Request:
    """The request, integrated as the earlier run was but for what was ``typed``; what does not fit is complained about.

    The model and the arithmetic stay: rows of two models, or of a state that was rounded on the way, are no run.
    """
    from mbsym.numerics.methods.table import METHODS

    earlier = request.earlier
    if earlier is None:
        return request
    if request.model != earlier.model:
        for option in sorted({"--gravity", "--linear", "--without"} & set(typed)):
            message = Message("[[option]] does not go with --continue: that run was one as described", option=option)
            if earlier.model.label != "as described":
                words = "[[option]] does not go with --continue: that run was one of another model: [[model]]"
                message = Message(words, option=option, model=worded(earlier.model.label))
            asked.complain(option, "conflicting-options", message, "leave it out: the model of that run is taken")
    request = replace(request, model=earlier.model, arithmetic=earlier.arithmetic)
    if request.method == "auto":
        request = _as_before(request, earlier, typed, asked)
    elif earlier.arithmetic not in METHODS[request.method].traits.scalars:
        words = "--method [[method]] does not go with --continue: that run was one in [[arithmetic]]"
        message = Message(words, method=request.method, arithmetic=earlier.arithmetic)
        able = ", ".join(name for name, one in METHODS.items() if earlier.arithmetic in one.traits.scalars)
        asked.complain(
            "--method", "conflicting-options", message, Message("these compute in it: [[names]]", names=able)
        )
    _check_values(request, given, asked)
    return request


def _as_before(request: Request, earlier: Earlier, typed: Collection[str], asked: Options) -> Request:
    """With the method of the earlier run, its tolerance unless one was typed, or its step."""
    if earlier.step is not None:
        for option in sorted({"--tolerance", "--max-step"} & set(typed)):
            words = "[[option]] does not go with --continue: that run took steps of one length by [[method]]"
            message = Message(words, option=option, method=earlier.method)
            asked.complain(option, "conflicting-options", message, "--method dop853 chooses its steps")
    tolerance = None if earlier.step is not None else request.tolerance or earlier.tolerance
    return replace(request, method=earlier.method, tolerance=tolerance, step=earlier.step)


def _check_values(request: Request, given: Scenario | None, asked: Options) -> None:
    """Complains about values that are not those of the run that is gone on from."""
    from mbsym.report.runs.earlier_run import changed

    if request.earlier is None or given is None:
        return
    different = list(changed(request.earlier, given))
    if different:
        message = Message("that run had other values: [[values]]", values=joined(different, "; "))
        asked.complain("--continue", "unfit-run", message, "repeat the --set of that run, or leave out --continue")
