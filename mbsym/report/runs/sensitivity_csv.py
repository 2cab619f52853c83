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


def shown(sensitivities: Sensitivities, name: str) -> str:
    """``m1``, ``theta(0)``."""
    return name if name in sensitivities.system.parameter_names else f"{name}(0)"


def sensitivity_csv(sensitivities: Sensitivities) -> str:
    """Numbers that read back exactly."""
    names, columns = [marked("t", unit_of(sensitivities.system, "t"))], [sensitivities.times]
    for j, name in enumerate(sensitivities.names):
        for i, quantity in enumerate(sensitivities.quantities):
            names.append(f"d {quantity}/d {shown(sensitivities, name)}")
            columns.append(sensitivities.values[j, i])
    return written(names, columns)


def sentences(sensitivities: Sensitivities) -> Iterator[tuple[str, str]]:
    """(title, text): the greatest answers at the end, and how good they are."""
    for j, name in enumerate(sensitivities.names):
        last, of = sensitivities.values[j, : len(sensitivities.system.coordinates), -1], shown(sensitivities, name)
        pairs = zip(sensitivities.system.coordinates, last, strict=True)
        summary = ", ".join(f"d {q}/d {of} = {value:.6g}" for q, value in pairs)
        time = f"{sensitivities.times[-1]:g}"
        yield Message("by [[name]]", name=of), Message("[[values]] at t = [[time]]", values=summary, time=time)
    summary = Message("not estimated")
    if np.isfinite(sensitivities.error):
        text = "about [[size]] of each derivative's largest size: the difference from a finer integration"
        summary = Message(text, size=f"{sensitivities.error:.1e}")
    yield Message("error"), summary
