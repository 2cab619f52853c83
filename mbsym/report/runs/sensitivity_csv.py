"""Derivatives along a motion as plain CSV: ``t``, then ``d theta/d m1`` for every quantity and every name.

Derivatives by an initial value carry its name with (0): ``d theta/d theta(0)``.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mbsym.expressions.message import Message
from mbsym.model.quantities import marked, unit_of
from mbsym.report.runs.trajectory_csv import written
from mbsym.simulation.motions import Sensitivities


def shown(found: Sensitivities, name: str) -> str:
    """``m1``, ``theta(0)``."""
    return name if name in found.system.parameter_names else f"{name}(0)"


def sensitivity_csv(found: Sensitivities) -> str:
    """Numbers that read back exactly."""
    names, columns = [marked("t", unit_of(found.system, "t"))], [found.times]
    for j, name in enumerate(found.names):
        for i, quantity in enumerate(found.quantities):
            names.append(f"d {quantity}/d {shown(found, name)}")
            columns.append(found.values[j, i])
    return written(names, columns)


def sentences(found: Sensitivities) -> Iterator[tuple[str, str]]:
    """(title, text): the greatest answers at the end, and how good they are."""
    for j, name in enumerate(found.names):
        last, of = found.values[j, : len(found.system.coordinates), -1], shown(found, name)
        pairs = zip(found.system.coordinates, last, strict=True)
        told = ", ".join(f"d {q}/d {of} = {value:.6g}" for q, value in pairs)
        time = f"{found.times[-1]:g}"
        yield Message("by [[name]]", name=of), Message("[[values]] at t = [[time]]", values=told, time=time)
    told = Message("not estimated")
    if np.isfinite(found.error):
        text = "about [[size]] of each derivative's largest size: the difference from a finer integration"
        told = Message(text, size=f"{found.error:.1e}")
    yield Message("error"), told
