"""What ``mbsym inverse`` writes and says: the inputs of a motion as a table, as a figure, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure

from mbsym.expressions.counting import counted
from mbsym.model.quantities import marked, unit_of
from mbsym.model.system import acceleration_name
from mbsym.numerics.inverse import InverseDynamics
from mbsym.report.figures.drawing import pictures, thinned
from mbsym.report.runs.trajectory_csv import written
from mbsym.report.unit_text import labelled


def inputs_csv(found: InverseDynamics) -> str:
    """t, inputs, q, q', q'', and ``left_<q>``: B u - r of each equation."""
    system = found.system
    names = ["t", *found.names, *system.coordinates, *system.velocities]
    names += [acceleration_name(name) for name in system.coordinates]
    named = [marked(name, unit_of(system, name)) for name in names]
    table = [found.times, *found.inputs, *found.coordinates, *found.velocities, *found.accelerations, *found.residual]
    return written([*named, *(f"left_{name}" for name in system.coordinates)], table)


def inputs_figure(found: InverseDynamics, formats: Sequence[str]) -> dict[str, bytes]:
    """``inputs.svg`` and others: a curve for each input."""

    def drawn() -> Figure:
        count = len(found.names)
        figure = Figure(figsize=(8.0, 1.2 + 2.2 * count), layout="constrained")
        rows = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
        for axes, name, values in zip(rows, found.names, found.inputs, strict=True):
            axes.plot(*thinned(found.times, values), linewidth=1.2)
            axes.axhline(0, color="#444444", linewidth=0.7)
            axes.set_ylabel(labelled(name.replace("$", r"\$"), unit_of(found.system, name)))
        rows[-1].set_xlim(found.times[0], found.times[-1])
        rows[-1].set_xlabel(labelled("t", unit_of(found.system, "t")))
        note = "" if found.exact else "\nthe nearest in the sense of least squares: no inputs give this motion"
        figure.suptitle(f"{found.system.name[:60]}: inputs of the motion{note}", fontsize=12, parse_math=False)
        return figure

    return pictures({"inputs": drawn}, formats)


def sentences(found: InverseDynamics) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    n, k = len(found.system.coordinates), len(found.names)
    tied = " and the forces of constraints" if found.system.constraints else ""
    yield "equations", f"{counted(n, 'equation', 'equations')} for {counted(k, 'input', 'inputs')}{tied}"
    for name, values in zip(found.names, found.inputs, strict=True):
        yield name, f"from {values.min() + 0.0:.6g} to {values.max() + 0.0:.6g}"
    left = f"{found.left:.1e} of the size of their terms"
    if found.exact:
        yield "motion", f"these inputs give it at all {len(found.times)} times: what is left of the equations is {left}"
    else:
        yield "warning", f"no inputs give this motion: in the sense of least squares {left} is left of the equations"
    if not found.unique:
        lacking = found.times[found.rank < k]
        where = f"at t = {lacking[0]:.6g}" + (f" and {len(lacking) - 1} more times" if len(lacking) > 1 else "")
        yield "warning", f"other inputs do the same {where}: the smallest are shown"
