"""``simulation.json``: what a trajectory was computed from, how, with what work, and whether it is whole.

Without seconds and dates, so that the same simulation writes the same file.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from math import isfinite
from typing import Any

from mbsym.numerics.methods.interface import Method
from mbsym.numerics.scenario import Scenario
from mbsym.numerics.simulate import Trajectory

PACKAGES = ("mbsym", "numpy", "scipy", "llvmlite", "python-flint", "heyoka")


def simulation_json(
    found: Trajectory,
    scenario: Scenario,
    method: Method,
    why: str,
    scalar: str,
    asked: Sequence[float],
    more: Mapping[str, Any],
    files: Sequence[str],
) -> str:
    """The file's text; ``asked`` are the times asked for, ``more`` is added as it is."""
    system = found.system
    state = [float(x) for x in scenario.state]
    content = {
        "system": system.name,
        "status": "whole" if found.whole else "partial",
        "ended": _ended(found),
        "time": {"from": 0.0, "to": float(asked[-1]), "samples": len(asked)},
        "reached": {"time": float(found.times[-1]), "samples": len(found.times)},
        "method": {"name": method.traits.name.lower(), "title": method.traits.title, "why": why},
        "arithmetic": scalar,
        "tolerance": found.setting.tolerance,
        "step": found.setting.step,
        "step_limit": found.setting.step_limit,
        "parameters": {name: float(value) for name, value in scenario.parameters.items()},
        "initial": dict(zip([*system.coordinates, *system.velocities], state, strict=True)),
        "work": vars(found.work),
        "files": list(files),
        "versions": versions(),
        **more,
    }
    return json.dumps(_plain(content), indent=2, ensure_ascii=False) + "\n"


def _ended(found: Trajectory) -> dict[str, Any] | None:
    """Why and where a trajectory ended early."""
    if found.interrupted:
        return {"kind": "interrupted", "message": "stopped by the user", "time": float(found.times[-1])}
    if found.breakdown is None:
        return None
    names = [*found.system.coordinates, *found.system.velocities]
    state = dict(zip(names, map(float, found.breakdown.state), strict=True))
    ended = found.breakdown
    return {"kind": ended.kind, "message": ended.message, "time": float(ended.time), "state": state}


def versions() -> dict[str, str]:
    """Of Python and of the packages that the numbers depend on."""
    found = {"python": platform.python_version()}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _plain(value: Any) -> Any:
    """JSON knows no infinities: they become text."""
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not isfinite(value):
        return str(value)
    return value
