"""Section ``waits``: what a person waits for, beside what was aimed at and beside peers, in one run.

Whole processes in turn, medians; what is measured inside a process comes from a bench of its own, started as one.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import chains
from run import HERE, SATELLITE, Child, in_rounds, in_turn, mbsym_command, number, ratio, run_child, say, summary

Record = dict[str, Any]
#: Joints of the chains, and those of ``--quick``.
LENGTHS, SHORT = (50, 100, 200), (5, 10, 20)
SIMULATE = ["simulate", "systems/double-pendulum.yaml", "--time", "10", "--force", "--quiet"]


@dataclass(frozen=True)
class Line:
    """A row of the table: ``wanted`` as the issue of speed has it; ``beside``: a peer's time by ours, by its name."""

    work: str
    measured: float | None
    unit: str
    wanted: str
    beside: dict[str, float | None] = field(default_factory=dict)
    complaint: str = ""


def short(options: argparse.Namespace) -> Iterator[Line]:
    """Short commands, processor time; machine code is kept from the warm-up, as from any run before."""
    with tempfile.TemporaryDirectory() as folder:
        out = ["--out", f"{folder}/out"]
        commands: dict[str, tuple[list[str], bool]] = {
            name: ([*mbsym_command(), *words], False)
            for name, words in (
                ("--help", ["--help"]),
                ("check", ["check", SATELLITE]),
                ("figures", [*SIMULATE, *out]),
                ("csv", [*SIMULATE, "--format", "csv", *out]),
            )
        }
        commands["import sympy"] = ([sys.executable, "-c", "import sympy"], False)
        for peer in ("scipy", "heyoka"):
            commands[peer] = ([sys.executable, str(HERE / "peer_pendulum.py"), peer], False)
        done = _in_turn(commands, options)
    spent = {name: found.get("process", {}).get("cpu_seconds") for name, found in done.items()}
    pendulum, scripts = "double pendulum, 10 s, simulate", ("scipy", "heyoka")
    yield Line(f"{pendulum} with figures", spent["figures"], "s", "1.2")
    yield Line(
        f"{pendulum} to CSV", spent["csv"], "s", "0.5", {f"script, {x}": ratio(spent[x], spent["csv"]) for x in scripts}
    )
    for name, wanted in (("--help", "0.1"), ("check", "0.15")):
        yield Line(name, ratio(spent[name], spent["import sympy"]), "of import sympy", wanted)


def satellite(options: argparse.Namespace) -> Iterator[Line]:
    """The whole run beside the library's process and an expert's script, as ``peer_satellite.py`` has them."""
    roads = [road for road in ("library", "jacobian") if not (options.quick and road == "library")]
    with tempfile.TemporaryDirectory() as folder:
        commands: dict[str, tuple[list[str], bool]] = {
            "mbsym": ([*mbsym_command(), "run", SATELLITE, "--out", f"{folder}/out"], False)
        }
        for road in roads:
            commands[road] = ([sys.executable, str(HERE / "peer_satellite.py"), "--road", road], True)
        done = _in_turn(commands, options)
    own = done["mbsym"].get("process", {})
    for road, wanted in (("library", "40"), ("jacobian", "3")):
        peer = done.get(road, {}).get("process", {})
        for what, found in (
            ("wall", in_rounds(peer, own)),
            ("user + system", ratio(peer.get("cpu_seconds"), own.get("cpu_seconds"))),
        ):
            yield Line(f"satellite, all reports, {what}", found, "times", wanted, {f"SymPy, {road}": found})


def long_chains(options: argparse.Namespace) -> Iterator[Line]:
    """`mbsym run` on spatial chains; processor time grows as joints**p."""
    wanted = {100: ("4", ""), 200: ("9", "400")}
    before: tuple[int, float] | None = None
    for joints in SHORT if options.quick else LENGTHS:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "chain.yaml"
            path.write_text(chains.description(chains.chain(joints, full=False)), encoding="utf-8")
            child = _run(["run", str(path), "--out", f"{folder}/reports", "--quiet"], options)
        seconds, memory = wanted.get(joints, ("", ""))
        yield Line(f"chain of {joints}", child.cpu, "s", seconds, complaint=child.complaint)
        yield Line(f"chain of {joints}, memory", child.peak_mb, "MB", memory, complaint=child.complaint)
        if before is not None:
            power = math.log(child.cpu / before[1]) / math.log(joints / before[0])
            aim = "1.1" if joints == LENGTHS[-1] else ""
            yield Line(f"chain of {joints}, power of the time since {before[0]}", power, "", aim)
        before = joints, child.cpu


def folder(options: argparse.Namespace) -> Iterator[Line]:
    """`mbsym batch` on all shipped systems, and again when all is up to date: wall time, others do the work."""
    with tempfile.TemporaryDirectory() as place:
        for name, wanted in (("derived", "12"), ("up to date", "0.2")):
            child = _run(["batch", "systems", "--out", f"{place}/build"], options)
            yield Line(f"folder of all systems, {name}, wall", child.seconds, "s", wanted, complaint=child.complaint)


def inside(options: argparse.Namespace) -> Iterator[Line]:
    """What is measured without starting Python: six links, forty four-bars, a stiff scene."""
    record, complaint = _bench(["rows_bench.py", "--links"], options)
    share = ratio(record.get("mbsym"), record.get("heyoka"))
    yield Line("six links, taylor, 2001 rows", share, "of heyoka's", "1.2", {"heyoka": ratio(1, share)}, complaint)
    record, complaint = _bench(["loops_bench.py", "--forty"], options)
    yield Line("forty four-bars, preparation", record.get("before"), "s", "1.5", complaint=complaint)
    yield Line("forty four-bars, integration", record.get("seconds"), "s", "", complaint=complaint)
    record, complaint = _bench(["peers_bench.py", "--stiff"], options)
    for stiffness, spent in record.items():
        own = spent.pop("mbsym rodas5p", None)
        beside = {who: ratio(seconds, own) for who, seconds in spent.items()}
        least = min((x for x in beside.values() if x is not None), default=None)
        yield Line(f"van der Pol, mu = {stiffness}, rodas5p", least, "times", "5", beside)
    if complaint:
        yield Line("van der Pol", None, "", "5", complaint=complaint)


def _in_turn(commands: dict[str, tuple[list[str], bool]], options: argparse.Namespace) -> dict[str, Record]:
    done = in_turn(commands, options.runs, options.timeout, {})
    return {name: summary(children) for name, children in done.items()}


def _run(words: list[str], options: argparse.Namespace) -> Child:
    child = run_child([*mbsym_command(), *words], options.timeout, wants_record=False)
    say(f"  {words[0]} {words[1]}: {child.complaint or f'{child.cpu:.2f} s, {child.peak_mb:.0f} MB'}")
    return child


def _bench(words: list[str], options: argparse.Namespace) -> tuple[Record, str]:
    child = run_child([sys.executable, str(HERE / words[0]), *words[1:]], options.timeout)
    say(f"  {' '.join(words)}: {child.complaint or f'{child.seconds:.1f} s'}")
    return child.record or {}, child.complaint


ARMS: tuple[Callable[[argparse.Namespace], Iterator[Line]], ...] = (short, satellite, inside, folder, long_chains)


def waits(options: argparse.Namespace) -> list[Record]:
    """Every line of the table."""
    return [vars(line) for arm in ARMS for line in arm(options)]


def show_waits(results: list[Record], table: Callable[..., None]) -> None:
    rows = []
    for line in (Line(**found) for found in results):
        beside = ", ".join(f"{who} {number(x)}" for who, x in line.beside.items() if x is not None)
        shown = line.complaint or f"{number(line.measured)} {line.unit}".strip()
        rows.append([line.work, shown, line.wanted, beside])
    table("what a person waits for; peers: how many times as long", ["work", "measured", "wanted", "peers"], rows)


SECTIONS = {"waits": (waits, show_waits)}
