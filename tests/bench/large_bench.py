"""Section ``robots`` of the benchmark, as whole processes: what large costs.

Nothing heavy is imported here: a child's peak memory counts from the moment it is forked.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from run import ROOT, Child, mbsym_command, number, ratio, run_child, say

sys.path.insert(0, str(ROOT / "tests" / "robots"))
from robots import QUICK, ROBOTS

Record = dict[str, Any]
AGREEMENT = [sys.executable, str(ROOT / "tests" / "robots" / "agreement.py")]


def _record(child: Child) -> Record:
    found = {"seconds": child.seconds, "cpu": child.cpu, "peak_mb": child.peak_mb, **(child.record or {})}
    return {**found, "complaint": child.complaint} if child.complaint else found


def robots(options: argparse.Namespace) -> list[Record]:
    """Every robot: `mbsym run`, Pinocchio's parse, CRBA and RNEA in a process of its own, and their difference."""
    results = []
    for name in QUICK if options.quick else ROBOTS:
        with tempfile.TemporaryDirectory() as folder:
            written = run_child([*AGREEMENT, "write", name, folder], options.timeout)
            if written.complaint:
                raise RuntimeError(f"{written.complaint} (make robot-data installs the URDF files)")
            command = [*mbsym_command(), "run", f"{folder}/robot.yaml", "--out", f"{folder}/reports", "--quiet"]
            own = run_child(command, options.timeout, wants_record=False)
            peer = run_child([*AGREEMENT, "peer", name], options.timeout)
            compared = run_child([*AGREEMENT, "compare", name, folder], options.timeout)
            sizes = {file.name: file.stat().st_size for file in Path(folder).glob("reports/[a-z]*")}
        say(f"  {name}: {own.complaint or f'{own.seconds:.1f} s, {own.peak_mb:.0f} MB'}")
        results.append(
            {
                "name": name,
                **(written.record or {}),
                "mbsym": _record(own),
                "peer": _record(peer),
                "bytes": sizes,
                **(compared.record or {"complaint": compared.complaint}),
            }
        )
    return results


def show_robots(results: list[Record], table: Callable[..., None]) -> None:
    rows = []
    for result in results:
        own, peer = result["mbsym"], result["peer"]
        rows.append(
            [
                result["name"],
                str(result["coordinates"]),
                own.get("complaint") or number(own["seconds"]),
                number(own["peak_mb"]),
                number(peer["seconds"]),
                number(ratio(own["seconds"], peer["seconds"])),
                number(peer.get("inside")),
                number(max(result["bytes"].values(), default=0) / 1e6),
                number(result.get("difference")) if "difference" in result else result["complaint"],
            ]
        )
    headings = ["robot", "joints", "run, s", "MB", "peer, s", "ratio", "inside, s", "largest file, MB", "difference"]
    table("mbsym run, all problems and reports, beside a process of Pinocchio (parse, CRBA, RNEA)", headings, rows)


SECTIONS = {"robots": (robots, show_robots)}
