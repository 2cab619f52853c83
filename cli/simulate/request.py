"""What ``mbsym simulate`` is asked for: its options, read and held against each other before anything is compiled."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil
from typing import TYPE_CHECKING, Any

from mbsym.expressions.message import Message, joined, worded
from mbsym.model.constraints import listed
from mbsym.studies.simulate import Request as Fields
from mbsym_cli.options import Options
from mbsym_cli.requests import read_some

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.planning.plan import Accuracy
    from mbsym.numerics.planning.planning import Pins
    from mbsym.simulation import Request

FORMATS = ("csv", "svg", "png", "pdf", "bodies-csv", "html", "gif")

#: Those that are figures.
FIGURES = ("svg", "png", "pdf")

#: Errors that can be asked for: nothing here is finer, and nothing coarser says anything about a motion.
FINEST, COARSEST = 1e-17, 0.5

#: What an option that goes with coordinates only is answered with.
WAY_OUT = "--variables coordinates integrates coordinates and their velocities, angles among them"

#: Formats that tell what bodies do, which is known in coordinates.
OF_BODIES = {"bodies-csv": "--bodies"}

#: A first try of a fixed step is the whole time divided by this.
TRIAL_STEPS = 10_000


@dataclass(frozen=True)
class Goal:
    """What is to be reached, and what is settled already; ``only_plan``: nothing is run.

    ``settings`` are those of --set, ``carried`` further options, for the command that repeats the run.
    """

    accuracy: Accuracy
    pins: Pins
    only_plan: bool
    settings: tuple[str, ...] = ()
    carried: tuple[str, ...] = ()


@dataclass(frozen=True)
class Asked:
    """What was asked for: the simulation, what of it is written and printed, and an accuracy to be reached."""

    request: Request
    formats: tuple[str, ...]
    quiet: bool
    goal: Goal | None = None
    verbose: bool = False
    as_json: bool = False


#: Read from their texts alone.
READ = ("time", "every", "tolerance", "step", "max_step", "samples", "arithmetic", "step_limit")


def read_request(system: System | None, texts: Mapping[str, Any], options: Options) -> Asked:
    """What the options say, by the names of their fields; whatever is wrong with them joins the complaints."""
    from mbsym.numerics.methods.table import METHODS
    from mbsym.simulation import Request

    read = read_some(Fields, READ, texts, options)
    method = options.word("--method", texts["method"].lower(), ("auto", *METHODS), "method")
    more = [*(["bodies-csv"] if texts["bodies"] else []), *(["html", "gif"] if texts["animate"] else [])]
    written = options.words("--format", ",".join([texts["formats"], *more]), FORMATS, "format")
    end, step = read["time"], read["step"]
    if system is not None and (texts["samples"] is None or texts["every"] is None):
        _check_rows(system, end, read["every"], read["samples"], options)
    if step is not None and end is not None and step > end:
        told = Message("[[step]] is longer than the whole time [[time]]", step=f"{step:g}", time=f"{end:g}")
        options.complain("--step", "bad-number", told)
    request = Request(
        time=end or 0.0,
        method=method or "auto",
        arithmetic=read["arithmetic"] or "float64",
        step_limit=read["step_limit"] or 1,
        longest=read["max_step"],
        **{name: read[name] for name in ("samples", "every", "tolerance", "step")},
        **{name: texts[name] for name in ("invariants", "estimate", "whole")},
    )
    if method is not None:
        _check_method(system, request, texts, options)
    quiet = texts["quiet"] or texts["as_json"]
    return Asked(request, written, quiet, verbose=texts["verbose"], as_json=texts["as_json"])


def _check_rows(system: System, end: float | None, every: float | None, samples: int | None, asked: Options) -> None:
    from mbsym.numerics.columns import most_rows_in_file

    rows, option = samples, "--samples"
    if every is not None:
        rows, option = None if end is None else int(min(ceil(end / every), 10**18)) + 1, "--every"
    most = most_rows_in_file(system)
    if rows is not None and rows > most:
        hint = Message("at most [[most]] for this system; use --every with a longer interval, or --samples", most=most)
        asked.complain(option, "too-large", Message("[[rows]] rows are too many", rows=rows), hint)


def check_held(request: Request, system: System | None, many: bool, asked: Options) -> None:
    """Complains about rows that have to be in memory together, and do not fit: the others go to a file."""
    from mbsym.numerics.columns import most_rows

    why = {
        "--certify": request.certify is not None,
        "--continue": request.earlier is not None,
        "--vary, --sensitivity": many,
    }
    needing = [option for option, there in why.items() if there]
    rows = request.rows if request.earlier is None else request.samples
    tied = system is not None and bool(system.constraints)  # their drift is measured by the whole motion
    if system is None or not (needing or tied) or rows is None or rows <= most_rows(system):
        return
    hint = Message("at most [[most]] for this system", most=most_rows(system))
    if needing and not tied:
        words = "at most [[most]] for this system, or leave out [[options]]"
        hint = Message(words, most=most_rows(system), options=", ".join(needing))
    option = "--every" if request.every is not None else "--samples"
    told = Message("[[rows]] rows are too many to be held in memory, as they have to be here", rows=rows)
    asked.complain(option, "too-large", told, hint)


def _check_method(system: System | None, request: Request, texts: Mapping[str, Any], asked: Options) -> None:
    """Whether the method goes with arithmetic, step or tolerance, and loads; before anything is compiled."""
    from mbsym.numerics.methods.symplectic import without_potential
    from mbsym.numerics.methods.table import METHODS

    name = request.method
    has_step, has_tolerance = texts["step"] is not None, texts["tolerance"] is not None
    given = METHODS.get(name)
    if has_step and has_tolerance and not (given is not None and given.traits.fixed):
        hint = "a method takes one or the other"
        asked.complain("--step", "conflicting-options", "--step and --tolerance exclude each other", hint)
    fixed = ", ".join(key for key, other in METHODS.items() if other.traits.fixed)
    if name == "auto":
        if has_step and not has_tolerance:
            words = "--step goes with a method of fixed step, for example --method rk4 (also [[others]])"
            hint = Message(words, others=fixed)
            asked.complain("--step", "conflicting-options", "--method auto chooses its steps by a tolerance", hint)
        return
    traits = METHODS[name].traits
    if request.arithmetic not in traits.scalars:
        able = ", ".join(key for key, other in METHODS.items() if request.arithmetic in other.traits.scalars)
        message = Message("[[method]] does not compute in [[arithmetic]]", method=name, arithmetic=request.arithmetic)
        asked.complain(
            "--arithmetic",
            "conflicting-options",
            message,
            Message("these do: [[names]]", names=able) if able else "no method does",
        )
    if traits.fixed and has_tolerance:
        hint = "give a --step in its place, or take a method that chooses its steps, for example --method dop853"
        if has_step:
            hint = "leave it out, or take a method that chooses its steps, for example --method dop853"
        told = Message("[[method]] takes steps of one length, no tolerance", method=name)
        asked.complain("--tolerance", "conflicting-options", told, hint)
    elif traits.fixed and not has_step:
        many = f"--step {request.time / TRIAL_STEPS:.2g}" if request.time else "--step H"
        hint = Message(
            "for example [[step]], a [[steps]]th of the time; then halve it until the results no longer change",
            step=many, steps=TRIAL_STEPS,
        )  # fmt: skip
        told = Message("[[method]] takes steps of one length, and there is no --step", method=name)
        asked.complain("--method", "missing-option", told, hint)
    if traits.fixed and texts["max_step"] is not None:
        example = f"{request.longest or 0.01:g}"
        hint = Message("give a shorter --step in its place, for example --step [[step]]", step=example)
        told = Message("[[method]] takes steps of one length", method=name)
        asked.complain("--max-step", "conflicting-options", told, hint)
    if not traits.fixed and has_step and not has_tolerance:
        hint = Message("leave --step out, give a --tolerance, or take a method of fixed step: [[names]]", names=fixed)
        told = Message("[[method]] chooses its steps by a --tolerance", method=name)
        asked.complain("--step", "conflicting-options", told, hint)
    loads = without_potential(system) if traits.conservative and system is not None else ()
    if loads:
        words = "[[method]] is for conservative systems; these loads have no potential: [[loads]]"
        message = Message(words, method=name, loads=", ".join(loads))
        asked.complain("--method", "unsuitable-method", message, "for any system: --method auto, dop853 or rk4")


# --- what does not know constraints, or declared variables ---


def check_constrained(system: System | None, wanted: Asked, asked: Options) -> None:
    """Complains about every option that does not know constraints yet."""
    if system is None or not system.constraints:
        return
    from mbsym.numerics.methods.table import METHODS

    request = wanted.request
    told = listed(system.constraints)
    if request.model.linear:
        message = Message("--linear does not take constraints into account yet ([[which]])", which=told)
        asked.complain("--linear", "constraints", message, "without them this would be another system")
    if request.method in METHODS and (METHODS[request.method].traits.conservative or request.method == "lsoda"):
        hint = Message("these do: [[names]]", names="auto, dop853, rk45, rk4, taylor, radau, bdf")
        message = Message("[[method]] does not keep to constraints ([[which]])", method=request.method, which=told)
        asked.complain("--method", "unsuitable-method", message, hint)


def check_states(system: System | None, wanted: Asked, asked: Options) -> None:
    """Complains about every option that goes with coordinates only, where a run has other variables."""
    from mbsym.model.states import InStates

    if not isinstance(system, InStates):
        return
    from mbsym.numerics.methods.table import METHODS

    request = wanted.request
    options = {
        "--continue": request.earlier is not None,
        "--linear": request.model.linear,
        **{option: kind in wanted.formats for kind, option in OF_BODIES.items()},
    }
    for option, there in options.items():
        if there:
            words = "[[option]] knows coordinates and their velocities only, and this system has speeds"
            message = Message(words, option=option)
            asked.complain(option, "variables", message, WAY_OUT)
    if request.method == "lsoda" and any(body.orientation for body in system.bodies):
        lengths = "lsoda does not keep quaternions and unit vectors at their lengths"
        asked.complain("--method", "unsuitable-method", lengths, "take dop853, rk4, taylor, radau or bdf")
    if request.method in METHODS and METHODS[request.method].traits.conservative:
        words = "[[method]] integrates coordinates and their velocities only, and this system has speeds"
        message = Message(words, method=request.method)
        asked.complain(
            "--method",
            "unsuitable-method",
            message,
            joined(("take dop853, rk4, taylor or radau", worded(WAY_OUT)), "; "),
        )


# --- ``--accuracy`` and ``--plan`` ---


def with_goal(
    texts: Mapping[str, Any],
    system: System | None,
    wanted: Asked,
    typed: Collection[str],
    carried: Sequence[str],
    asked: Options,
) -> Asked:
    """What is asked for, with the accuracy that is to be reached, if one is; ``typed`` are the options' names."""
    accuracy = _accuracy(system, texts["accuracy"], asked)
    if accuracy is None:
        return wanted
    pins = _pins(wanted.request, texts, "--arithmetic" in typed)
    return replace(wanted, goal=Goal(accuracy, pins, texts["plan"], texts["values"], tuple(carried)))


def _pins(request: Request, texts: Mapping[str, Any], arithmetic: bool) -> Pins:
    """What other options have settled; float64 settles the ``arithmetic`` only where it was typed."""
    from mbsym.numerics.planning.planning import Pins

    return Pins(
        model=request.model if texts["gravity"] or texts["linear"] or texts["without"] else None,
        method=None if request.method == "auto" else request.method,
        tolerance=request.tolerance,
        step=request.step,
        scalar=request.arithmetic if arithmetic else None,
        whole=request.whole,
    )


def _accuracy(system: System | None, text: str | None, asked: Options) -> Accuracy | None:
    """``1e-6``, ``theta=1e-6,energy=1e-9``, or both: ``1e-4,energy=1e-9``."""
    if text is None:
        return None
    from mbsym.numerics.planning.plan import ENERGY, Accuracy

    known = (*system.coordinates, *system.velocities, ENERGY) if system is not None else ()
    everything: float | None = None
    named: dict[str, float] = {}
    before = len(asked.complaints)
    for part in text.split(","):
        left, equals, right = (piece.strip() for piece in part.partition("="))
        value = asked.number("--accuracy", right if equals else left, FINEST, COARSEST)
        name = left if equals else "everything"
        if name in named or (not equals and everything is not None):
            told = Message("two errors are given for [[name]]", name=name if equals else worded(name))
            asked.complain("--accuracy", "conflicting-options", told)
        elif not equals:
            everything = value
        elif system is None or asked.word("--accuracy", name, known, "quantity") is not None:
            named[name] = value or FINEST
    if len(asked.complaints) > before:
        return None
    return Accuracy(everything, named)
