"""What ``mbsym inverse`` writes and says: the inputs of a motion as a table, as a figure, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from matplotlib.figure import Figure

from mbsym.expressions.message import Counted, Message
from mbsym.model.quantities import marked, unit_of
from mbsym.model.system import acceleration_name
from mbsym.numerics.inverse import InverseDynamics
from mbsym.report.figures.drawing import pictures, thinned
from mbsym.report.runs.trajectory_csv import written
from mbsym.report.unit_text import labelled


def inputs_csv(inverse: InverseDynamics) -> str:
    """t, inputs, q, q', q'', and ``left_<q>``: B u - r of each equation."""
    system = inverse.system
    names = ["t", *inverse.names, *system.coordinates, *system.velocities]
    names += [acceleration_name(name) for name in system.coordinates]
    named = [marked(name, unit_of(system, name)) for name in names]
    table = [
        inverse.times,
        *inverse.inputs,
        *inverse.coordinates,
        *inverse.velocities,
        *inverse.accelerations,
        *inverse.residual,
    ]
    return written([*named, *(f"left_{name}" for name in system.coordinates)], table)


def inputs_figure(inverse: InverseDynamics, formats: Sequence[str]) -> dict[str, bytes]:
    """``inputs.svg`` and others: a curve for each input."""

    def drawn() -> Figure:
        count = len(inverse.names)
        figure = Figure(figsize=(8.0, 1.2 + 2.2 * count), layout="constrained")
        rows = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
        for axes, name, values in zip(rows, inverse.names, inverse.inputs, strict=True):
            axes.plot(*thinned(inverse.times, values), linewidth=1.2)
            axes.axhline(0, color="#444444", linewidth=0.7)
            axes.set_ylabel(labelled(name.replace("$", r"\$"), unit_of(inverse.system, name)))
        rows[-1].set_xlim(inverse.times[0], inverse.times[-1])
        rows[-1].set_xlabel(labelled("t", unit_of(inverse.system, "t")))
        note = "" if inverse.exact else "\nthe nearest in the sense of least squares: no inputs give this motion"
        figure.suptitle(f"{inverse.system.name[:60]}: inputs of the motion{note}", fontsize=12, parse_math=False)
        return figure

    return pictures({"inputs": drawn}, formats)


def sentences(inverse: InverseDynamics) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    left = f"{inverse.left:.1e}"
    if inverse.exact:
        text = (
            "these inputs give it at all [[count]] times: what is left of the equations is [[left]] of the "
            "size of their terms"
        )
        yield Message("motion"), Message(text, count=len(inverse.times), left=left)
    else:
        text = (
            "no inputs give this motion: in the sense of least squares [[left]] of the size of their terms "
            "is left of the equations"
        )
        yield Message("warning"), Message(text, left=left)
    n, k = len(inverse.system.coordinates), len(inverse.names)
    both = {"equations": Counted(n, "equation"), "inputs": Counted(k, "input")}
    tied = "[[equations]] for [[inputs]] and the forces of constraints"
    yield Message("equations"), Message(tied if inverse.system.constraints else "[[equations]] for [[inputs]]", **both)
    for name, values in zip(inverse.names, inverse.inputs, strict=True):
        yield (
            name,
            Message("from [[least]] to [[most]]", least=f"{values.min() + 0.0:.6g}", most=f"{values.max() + 0.0:.6g}"),
        )
    if not inverse.unique:
        lacking = inverse.times[inverse.rank < k]
        first, more = f"{lacking[0]:.6g}", len(lacking) - 1
        text = Message("other inputs do the same at t = [[time]]: the smallest are shown", time=first)
        if more:
            text = Message(
                "other inputs do the same at t = [[time]] and [[more]]: the smallest are shown",
                time=first,
                more=Counted(more, "more time"),
            )
        yield Message("warning"), text
