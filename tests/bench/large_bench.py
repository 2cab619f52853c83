"""Sections ``robots``, ``chains``, ``folder`` and ``waiting`` of the benchmark, as whole processes: what large costs.

Nothing heavy is imported here: a child's peak memory counts from the moment it is forked.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import chains
from run import ROOT, Child, in_turn, mbsym_command, number, ratio, run_child, say, summary

sys.path.insert(0, str(ROOT / "tests" / "robots"))
from robots import QUICK, ROBOTS

Record = dict[str, Any]
AGREEMENT = [sys.executable, str(ROOT / "tests" / "robots" / "agreement.py")]
#: Joints of the chains, and those of ``--quick``.
LENGTHS, SHORT = (5, 10, 20, 50, 100, 200), (5, 10, 20)
#: What is aimed at, by joints.
TARGETS = {100: ((4, "s"),), 200: ((9, "s"), (400, "MB"), (1.1, "= p"))}


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


def chains_(options: argparse.Namespace) -> list[Record]:
    """Chains of `chains.py` with principal inertias: `mbsym run` against their length."""
    results = []
    for joints in SHORT if options.quick else LENGTHS:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "chain.yaml"
            path.write_text(chains.description(chains.chain(joints, full=False)), encoding="utf-8")
            child = run_child(
                [*mbsym_command(), "run", str(path), "--out", f"{folder}/reports", "--quiet"], options.timeout, False
            )
        say(f"  {joints} joints: {child.complaint or f'{child.seconds:.1f} s, {child.peak_mb:.0f} MB'}")
        results.append({"joints": joints, **_record(child)})
    return results


def show_chains(results: list[Record], table: Callable[..., None]) -> None:
    rows = []
    for before, result in zip([None, *results], results, strict=False):
        exponent = ""
        if before is not None:
            steps = math.log(result["joints"] / before["joints"])
            exponent = number(math.log(result["cpu"] / before["cpu"]) / steps, 2)
        shown = result.get("complaint") or number(result["seconds"])
        target = ", ".join(f"{limit} {unit}" for limit, unit in TARGETS.get(result["joints"], ()))
        cells = [str(result["joints"]), shown, number(result["cpu"]), number(result["peak_mb"]), exponent, target]
        rows.append(cells)
    headings = ["joints", "wall, s", "user + system, s", "MB", "p", "target"]
    table("mbsym run on spatial chains; user + system grows as joints**p", headings, rows)


def folder(options: argparse.Namespace) -> dict[str, Record]:
    """`mbsym batch` on all shipped systems into a new folder, and once more when all is up to date."""
    with tempfile.TemporaryDirectory() as place:
        command = [*mbsym_command(), "batch", "systems", "--out", f"{place}/build"]
        results = {}
        for name in ("derived", "up to date"):
            child = run_child(command, options.timeout, False)
            say(f"  folder, {name}: {child.complaint or f'{child.seconds:.2f} s'}")
            results[name] = _record(child)
    return results


def show_folder(results: dict[str, Record], table: Callable[..., None]) -> None:
    targets = {"derived": "12", "up to date": "0.2"}
    rows = [
        [name, result.get("complaint") or number(result["seconds"]), targets[name]] for name, result in results.items()
    ]
    table(
        "mbsym batch systems",
        ["", "wall, s", "target"],
        rows,
    )


#: What somebody waits for, and what part of `import sympy` in processor time it is to be at most.
SIMULATE = ["simulate", "systems/double-pendulum.yaml", "--time", "10", "--force", "--quiet"]
WAITING = {
    "--help": (["--help"], 0.1),
    "check, satellite": (["check", "systems/satellite.yaml"], 0.15),
    "simulate to csv, double pendulum, 10 s": ([*SIMULATE, "--format", "csv"], 1.5),
    "simulate with figures, double pendulum, 10 s": (SIMULATE, 3.5),
}


def waiting(options: argparse.Namespace) -> dict[str, Record]:
    """Short commands in turn with `import sympy`; machine code is kept from the warm-up, as from any run before."""
    with tempfile.TemporaryDirectory() as folder:
        commands = {"import sympy": ([sys.executable, "-c", "import sympy"], False)}
        for name, (command, _) in WAITING.items():
            out = ["--out", f"{folder}/out"] if command[0] == "simulate" else []
            commands[name] = ([*mbsym_command(), *command, *out], False)
        return {name: summary(done) for name, done in in_turn(commands, options.runs, options.timeout, {}).items()}


def show_waiting(results: dict[str, Record], table: Callable[..., None]) -> None:
    measured = {name: found.get("process", {}).get("cpu_seconds") for name, found in results.items()}
    rows = [
        [
            name,
            number(seconds),
            number(ratio(seconds, measured["import sympy"])),
            number(WAITING.get(name, ("", None))[1]),
        ]
        for name, seconds in measured.items()
    ]
    table("short commands, processor time of whole processes", ["command", "s", "of import sympy", "target"], rows)


SECTIONS = {
    "robots": (robots, show_robots),
    "chains": (chains_, show_chains),
    "folder": (folder, show_folder),
    "waiting": (waiting, show_waiting),
}
