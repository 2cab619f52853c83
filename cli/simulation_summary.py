"""What ``mbsym simulate`` tells: how it went, how good it is, and what broke down."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import ceil, pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbsym_cli.console import console, counted

if TYPE_CHECKING:
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.methods.interface import Breakdown
    from mbsym.numerics.reduced import Reduced
    from mbsym.numerics.simulate import Trajectory
    from mbsym_cli.simulate import Chosen
    from mbsym_cli.simulation_request import Request

#: Below this much of what it was a pivot of M costs digits worth a warning.
NEARLY_SINGULAR = 1e-8


def print_summary(
    file: Path,
    dynamics: Dynamics,
    found: Trajectory,
    chosen: Chosen,
    request: Request,
    summary: Mapping[str, Any],
    paths: Sequence[Path],
) -> None:
    from rich.text import Text

    out = console()
    out.print(Text.assemble((found.system.name, "bold"), (f"  {file}", "dim")))
    for name, text in _lines(dynamics, found, chosen, request, summary):
        style = "yellow" if name == "warning" else "bold cyan"
        out.print(Text.assemble("  ", (f"{name:<9} ", style), text))
    names = ", ".join(path.name for path in paths)
    out.print(Text.assemble("  files in ", (str(paths[0].parent), "bold"), f": {names}"))


def _lines(
    dynamics: Dynamics, found: Trajectory, chosen: Chosen, request: Request, summary: Mapping[str, Any]
) -> Iterator[tuple[str, str]]:
    """(title, text) of the summary's lines."""
    from mbsym.numerics.invariants import CHANGING
    from mbsym.numerics.simulate import least_pivot

    setting, work = found.setting, found.work
    measured = f": {chosen.measured}" if chosen.measured else ""
    yield "method", f"{chosen.method.traits.title} ({chosen.why}{measured})"
    if setting.step is None:
        how = f"tolerance {setting.tolerance:g} per step"
    else:
        spacing = float(chosen.times[1] - chosen.times[0])
        taken = spacing / ceil(spacing / setting.step * (1 - 1e-9))
        shorter = taken < setting.step * (1 - 1e-6)
        how = f"step {setting.step:g}" + (f", shortened to {taken:.6g} to end at every row" if shorter else "")
    yield "setting", f"{how}, {request.arithmetic}"
    reached = "" if found.whole else f", reached {found.times[-1]:.9g}"
    yield "time", f"0 to {request.end:g}, {len(chosen.times)} samples{reached}"
    if chosen.resting is not None:
        yield "resting", _rest_line(chosen.resting)
    evaluations = counted(work.evaluations, "evaluation", "evaluations")
    jacobians = f" and {counted(work.jacobians, 'Jacobian', 'Jacobians')}" if work.jacobians else ""
    rejected = f" ({work.rejected} rejected)" if work.rejected else ""
    yield "work", f"{counted(work.steps, 'step', 'steps')}{rejected}, {evaluations}{jacobians}, {found.seconds:.3g} s"
    energy = summary["energy"]
    change = "change" if energy["conserved"] == CHANGING else "drift"
    yield "energy", f"{energy['conserved']}; largest relative {change} {energy['largest_relative_drift']:.1e}"
    for item in summary["invariants"].values():
        yield "invariant", f"{item['name']} ({item['status']}): largest relative drift {item['drift']:.1e}"
    estimated = summary["estimated_error"]
    if estimated and "final" in estimated:
        worst = f", {estimated['largest']:.1e} at worst" if estimated["largest"] > 2 * estimated["final"] else ""
        yield "error", f"about {estimated['final']:.1e} at the end{worst} (relative, against {estimated['against']})"
        if estimated["largest"] > 0.1:
            yield (
                "warning",
                "the end depends on the last digits of everything: the motion is chaotic, or this is too coarse",
            )
    ratio, at = least_pivot(dynamics, found)
    if found.breakdown is None and ratio < NEARLY_SINGULAR:
        yield "warning", f"at t = {at:.6g} the mass matrix was nearly singular (a pivot fell to {ratio:.1e})"
    spacing = float(chosen.times[1] - chosen.times[0])
    if chosen.frequency * spacing > pi / 2:
        yield "warning", "fewer than 4 samples a period of the fastest oscillation: figures deceive; raise --samples"


def _rest_line(found: Reduced) -> str:
    """What was taken out of the integration, how it is known, and what that saved."""
    names = ", ".join(found.names)
    rest = "rests" if len(found.names) == 1 else "rest"
    if not found.proved:
        return f"{names} {rest} ({found.reduction.how}, not proved): integrated all the same"
    whole, less = found.operations
    n = found.whole.size
    saved = f"{less} operations a right-hand side instead of {whole}"
    return f"{names} {rest} (proved): {n - len(found.names)} of {n} coordinates integrated, {saved}"


def broken(file: Path, ended: Breakdown, found: Trajectory, paths: Sequence[Path]) -> str:
    """What happened, when, and in which state."""
    from mbsym.numerics.methods.interface import BLOW_UP, SINGULAR, STEP_LIMIT, STUCK

    names = [*found.system.coordinates, *found.system.velocities]
    state = ", ".join(f"{name} = {float(value):.6g}" for name, value in zip(names, ended.state, strict=True))
    hints = {
        BLOW_UP: "the motion leaves every bound in finite time; is a sign of the forces right?",
        SINGULAR: (
            "a coordinate loses its meaning in this state: a distance has shrunk to zero (a collision, a fall to the "
            "centre), or angles are singular (a pole; other angles help); or a mass is zero. Start elsewhere or stop "
            "earlier"
        ),
        STEP_LIMIT: "raise --step-limit, or choose a larger --tolerance or --step; a stiff system needs --method radau",
        STUCK: "a larger --tolerance may pass; look for a singularity of forces at this state",
    }
    kept = f"{counted(len(found.times), 'sample', 'samples')} up to t = {found.times[-1]:.9g} kept in {paths[0].parent}"
    return "\n".join(
        [
            f"{file}: error[{ended.kind.replace(' ', '-')}]: {ended.kind} at t = {ended.time:.9g}: {ended.message}",
            f"  state: {state}",
            f"  hint: {hints.get(ended.kind, '')}",
            f"{file}: {kept}",
        ]
    )


def note(found: Trajectory) -> str:
    if found.breakdown is not None:
        return f"ended early: {found.breakdown.kind} at t = {found.breakdown.time:.6g}"
    return f"interrupted at t = {found.times[-1]:.6g}" if found.interrupted else ""
