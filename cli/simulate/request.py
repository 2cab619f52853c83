"""What ``mbsym simulate`` is asked for: its options, read and held against each other before anything is compiled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import TYPE_CHECKING, Any

from mbsym.studies.simulate import Request as Fields
from mbsym_cli.options import Options
from mbsym_cli.requests import read_some

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.simulation import Request
    from mbsym_cli.simulate.choice import Goal

FORMATS = ("csv", "svg", "png", "pdf", "bodies-csv", "html", "gif")

#: Those that are figures.
FIGURES = ("svg", "png", "pdf")

#: A first try of a fixed step is the whole time divided by this.
TRIAL_STEPS = 10_000


@dataclass(frozen=True)
class Asked:
    """What was asked for: the simulation, what of it is written and printed, and an accuracy to be reached."""

    request: Request
    formats: tuple[str, ...]
    quiet: bool
    goal: Goal | None = None
    verbose: bool = False


#: Read from their texts alone.
READ = ("time", "every", "tolerance", "step", "max_step", "samples", "arithmetic", "step_limit")


def read_request(system: System | None, texts: Mapping[str, Any], formats: str, quiet: bool, options: Options) -> Asked:
    """What the options say, by the names of their fields; whatever is wrong with them joins the complaints."""
    from mbsym.numerics.methods.table import METHODS
    from mbsym.simulation import Request

    read = read_some(Fields, READ, texts, options)
    method = options.word("--method", texts["method"].lower(), ("auto", *METHODS), "method")
    written = options.words("--format", formats, FORMATS, "format")
    end, step = read["time"], read["step"]
    if system is not None and (texts["samples"] is None or texts["every"] is None):
        _check_rows(system, end, read["every"], read["samples"], options)
    if step is not None and end is not None and step > end:
        options.complain("--step", "bad-number", f"{step:g} is longer than the whole time {end:g}")
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
    return Asked(request, written, quiet)


def _check_rows(system: System, end: float | None, every: float | None, samples: int | None, asked: Options) -> None:
    from mbsym.numerics.columns import most_rows_in_file

    rows, option = samples, "--samples"
    if every is not None:
        rows, option = None if end is None else int(min(ceil(end / every), 10**18)) + 1, "--every"
    most = most_rows_in_file(system)
    if rows is not None and rows > most:
        hint = f"at most {most} for this system; use --every with a longer interval, or --samples"
        asked.complain(option, "too-large", f"{rows} rows are too many", hint)


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
    way_out = f", or leave out {', '.join(needing)}" if needing and not tied else ""
    hint = f"at most {most_rows(system)} for this system{way_out}"
    option = "--every" if request.every is not None else "--samples"
    asked.complain(option, "too-large", f"{rows} rows are too many to be held in memory, as they have to be here", hint)


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
            hint = f"--step goes with a method of fixed step, for example --method rk4 (also {fixed})"
            asked.complain("--step", "conflicting-options", "--method auto chooses its steps by a tolerance", hint)
        return
    traits = METHODS[name].traits
    if request.arithmetic not in traits.scalars:
        able = ", ".join(key for key, other in METHODS.items() if request.arithmetic in other.traits.scalars)
        message = f"{name} does not compute in {request.arithmetic}"
        asked.complain("--arithmetic", "conflicting-options", message, f"these do: {able or 'none'}")
    if traits.fixed and has_tolerance:
        place = "leave it out" if has_step else "give a --step in its place"
        hint = f"{place}, or take a method that chooses its steps, for example --method dop853"
        asked.complain("--tolerance", "conflicting-options", f"{name} takes steps of one length, no tolerance", hint)
    elif traits.fixed and not has_step:
        many = f"--step {request.time / TRIAL_STEPS:.2g}" if request.time else "--step H"
        hint = f"for example {many}, a {TRIAL_STEPS}th of the time; then halve it until the results no longer change"
        asked.complain("--method", "missing-option", f"{name} takes steps of one length, and there is no --step", hint)
    if traits.fixed and texts["max_step"] is not None:
        hint = f"give a shorter --step in its place, for example --step {request.longest or 0.01:g}"
        asked.complain("--max-step", "conflicting-options", f"{name} takes steps of one length", hint)
    if not traits.fixed and has_step and not has_tolerance:
        hint = f"leave --step out, give a --tolerance, or take a method of fixed step: {fixed}"
        asked.complain("--step", "conflicting-options", f"{name} chooses its steps by a --tolerance", hint)
    loads = without_potential(system) if traits.conservative and system is not None else ()
    if loads:
        message = f"{name} is for conservative systems; these loads have no potential: {', '.join(loads)}"
        asked.complain("--method", "unsuitable-method", message, "for any system: --method auto, dop853 or rk4")
