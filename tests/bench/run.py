"""``make bench``: mbsym beside its peers in one sitting; see README.md in this folder.

Derivations are timed as whole processes run in turn, numbers inside one process (``numbers_bench.py``).

Nothing here asserts: the targets are printed beside what was measured.  The process stays small on purpose, because
a child's peak memory counts from the moment it is forked.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import math
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

import peer_arm  # noqa: E402  (imports sympy only where it derives)
import peer_satellite  # noqa: E402

SATELLITE = "systems/satellite.yaml"
ALL = ("waits", "satellite", "arm", "robots", "forward", "simulation", "growth")
KINDS = ("principal", "full")
ROAD_TITLES = {
    "library": "LagrangesMethod, Linearizer",
    "restricted": "LagrangesMethod, by hand",
    "jacobian": "SymPy core, Jacobians",
    "plain": "SymPy core, by hand",
}
Record = dict[str, Any]


# ------------------------------------------------------------------ children


@dataclass(frozen=True)
class Child:
    """One finished process."""

    seconds: float
    cpu: float
    peak_mb: float
    record: Record | None
    complaint: str


def run_child(command: Sequence[str], timeout: float, wants_record: bool = True) -> Child:
    """Run a process to its end; its last line of output is a JSON record if it is to have one."""
    with tempfile.TemporaryFile("w+") as output, tempfile.TemporaryFile("w+") as errors:
        start = time.perf_counter()
        process = subprocess.Popen(
            list(command),
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=errors,
            start_new_session=True,
            env={name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"},
        )
        late = threading.Event()

        def stop() -> None:
            late.set()
            os.killpg(process.pid, signal.SIGKILL)

        timer = threading.Timer(timeout, stop)
        timer.daemon = True
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - start
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        errors.seek(0)
        lines, complaints = output.read().strip().splitlines(), errors.read().strip().splitlines()
    peak = usage.ru_maxrss / 1e6 if sys.platform == "darwin" else usage.ru_maxrss * 1024 / 1e6
    record, complaint = None, ""
    if late.is_set():
        complaint = f"stopped after {timeout:.0f} s"
    elif process.returncode:
        complaint = f"exit code {process.returncode}: {(complaints or lines or ['no message'])[-1][:200]}"
    elif wants_record:
        try:
            record = json.loads(lines[-1])
        except (IndexError, ValueError):
            complaint = "no record in its output"
    return Child(seconds, usage.ru_utime + usage.ru_stime, peak, record, complaint)


def say(text: str) -> None:
    """Progress, on stderr."""
    print(text, file=sys.stderr, flush=True)


# ------------------------------------------------------------------ inside one mbsym process


def residual_at(equations: Any, values: dict[str, float], names: Sequence[str]) -> list[float] | None:
    """M q'' - f of mbsym at one state, term by term in balls; None if the system uses other names."""
    from flint import ctx

    ctx.prec = 200  # many terms cancel

    def value(formula: Any) -> float:
        return float(formula.ring.evaluate(formula.polynomial, values))

    try:
        mass = [[value(x) for x in row] for row in equations.mass_matrix]
        forcing = [value(x) for x in equations.forcing]
    except (AttributeError, KeyError, TypeError):
        return None
    accelerations = [values[f"{name}_ddot"] for name in names]
    return [
        math.fsum([*(a * b for a, b in zip(row, accelerations, strict=True)), -f])
        for row, f in zip(mass, forcing, strict=True)
    ]


def relative_difference(mine: list[float] | None, truth: Sequence[float]) -> float | None:
    """The largest difference, relative to the largest component."""
    if mine is None:
        return None
    return max(abs(a - b) for a, b in zip(mine, truth, strict=True)) / max(abs(b) for b in truth)


def satellite_state() -> dict[str, float]:
    """The reference state under the names of the description file."""
    state = peer_satellite.STATE
    values = {
        name.replace("_", ""): float(text)
        for name, text in zip(peer_satellite.PARAMETERS, state["parameters"], strict=True)
    }
    for suffix, key in (("", "q"), ("_dot", "qd"), ("_ddot", "qdd")):
        values |= {
            name + suffix: float(text) for name, text in zip(peer_satellite.COORDINATES, state[key], strict=True)
        }
    radius = 41.097
    # what the motion about O1 does not depend on
    return values | {"R": radius, "M2": 25.33, "chi": 0.3, "nu": values["omega0"] ** 2 * radius**3}


def measure(path: str, arm: str | None) -> None:
    """Time mbsym's stages in this process and print a JSON record."""
    clock = time.perf_counter
    seconds: dict[str, float] = {}
    start = clock()
    import mbsym

    seconds["import"] = clock() - start
    start = clock()
    analysis = mbsym.load(path)
    seconds["load"] = clock() - start
    start = clock()
    equations = analysis.equations
    seconds["equations"] = clock() - start
    if arm is None:
        start = clock()
        _ = analysis.linearisation
        seconds["linearisation"] = clock() - start
    record: Record = {"seconds": seconds, "peak_mb": peer_satellite.peak_memory_mb()}
    record["terms"] = {
        "mass_matrix": sum(x.terms for row in equations.mass_matrix for x in row),
        "forcing": sum(x.terms for x in equations.forcing),
    }
    if arm is None:
        truth = [float(text) for text in peer_satellite.STATE["residual"]]
        mine = residual_at(equations, satellite_state(), peer_satellite.COORDINATES)
        record["difference"] = relative_difference(mine, truth)
    else:
        joints, full = int(arm.split(":")[0]), arm.endswith("full")
        sample: dict[str, Fraction] = peer_arm.sample(joints, full)
        values = {name: float(value) for name, value in sample.items()}
        mine = residual_at(equations, values, [f"q{k}" for k in range(1, joints + 1)])
        record["difference"] = relative_difference(mine, peer_arm.newton_euler(joints, full, values))
    print(json.dumps(record))


# ------------------------------------------------------------------ tables


def number(value: float | None, digits: int = 3) -> str:
    """A number for a table: as many significant digits as are worth reading."""
    if value is None:
        return "-"
    if value != 0 and abs(value) < 10**-digits:
        return f"{value:.1e}"
    return f"{value:.{max(0, digits - 1 - math.floor(math.log10(abs(value) or 1)))}f}"


def count(value: float | None) -> str:
    """A whole number for a table."""
    return "-" if value is None else f"{int(value):,}"


def table(title: str, headings: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table, with rich where it is installed."""
    rows = list(rows)
    try:
        from rich.console import Console
        from rich.table import Table
    except ImportError:
        widths = [max(len(cell) for cell in cells) for cells in zip(headings, *rows, strict=True)]
        print(f"\n{title}")
        for row in [headings, ["-" * width for width in widths], *rows]:
            print("  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)))
        return
    console = Console() if sys.stdout.isatty() else Console(width=120)
    grid = Table(title=title, title_justify="left", title_style="bold")
    for place, heading in enumerate(headings):
        grid.add_column(heading, justify="left" if place == 0 else "right", overflow="fold")
    for row in rows:
        grid.add_row(*row)
    console.print()
    console.print(grid)


def median(values: Iterable[float | None]) -> float | None:
    """The median of what there is."""
    known = [value for value in values if value is not None]
    return statistics.median(known) if known else None


def ratio(peer: float | None, mine: float | None) -> float | None:
    """How many times more the peer needs."""
    return peer / mine if peer is not None and mine else None


def total(seconds: dict[str, float | None], stages: Sequence[str]) -> float | None:
    """The sum of some stages, if all were measured."""
    parts = [seconds.get(stage) for stage in stages]
    return None if None in parts else sum(part for part in parts if part is not None)


# ------------------------------------------------------------------ runs in turn


def in_turn(
    commands: dict[str, tuple[list[str], bool]], runs: int, timeout: float, warm: dict[str, list[str]]
) -> dict[str, list[Child]]:
    """Run every command once (with its extra arguments, not counted) and then ``runs`` times, A B C A B C ...

    A command that fails is not tried again; its failed run is the last of its list.
    """
    done: dict[str, list[Child]] = {name: [] for name in commands}
    failed: set[str] = set()
    for turn in range(runs + 1):
        for name, (command, wants_record) in commands.items():
            if name in failed:
                continue
            extra = warm.get(name, []) if turn == 0 else []
            child = run_child([*command, *extra], timeout, wants_record)
            label = "warm-up" if turn == 0 else f"run {turn} of {runs}"
            say(f"  {name}, {label}: {child.complaint or f'{child.seconds:.2f} s, {child.peak_mb:.0f} MB'}")
            done[name].append(child)
            if child.complaint:
                failed.add(name)
    return done


def summary(children: list[Child]) -> Record:
    """Medians over the counted runs (all but the first); facts from the first."""
    if not children:
        return {"complaint": "not run"}
    if children[-1].complaint:
        return {"complaint": children[-1].complaint}
    counted = children[1:]
    records = [child.record for child in counted if child.record]
    stages = list(records[0]["seconds"]) if records else []
    result: Record = {
        "runs": len(counted),
        "process": {
            "seconds": median(child.seconds for child in counted),
            "cpu_seconds": median(child.cpu for child in counted),
            "peak_mb": median(child.peak_mb for child in counted),
            "all_seconds": [round(child.seconds, 4) for child in counted],
        },
        "seconds": {stage: median(record["seconds"].get(stage) for record in records) for stage in stages},
    }
    first = children[0].record or {}
    result |= {key: first[key] for key in ("operations", "terms", "differences", "difference") if key in first}
    return result


def compile_ours() -> None:
    """What pip does with a package that it installs, SymPy among them: bytecode beside the sources."""
    folders = [str(ROOT / name) for name in ("mbsym", "cli", "templates")]
    subprocess.run([sys.executable, "-m", "compileall", "-q", *folders], cwd=ROOT, check=True)


def mbsym_command() -> list[str]:
    """The installed command, or the module behind it."""
    script = Path(sys.executable).with_name("mbsym")
    return [str(script)] if script.exists() else [sys.executable, "-m", "mbsym_cli"]


def measure_command(path: str, arm: str | None = None) -> list[str]:
    """This very script as a child that times mbsym inside."""
    return [sys.executable, str(HERE / "run.py"), "--measure", path, *(["--arm", arm] if arm else [])]


# ------------------------------------------------------------------ the satellite


#: What a run stands on, each with what comes before: nothing that is written can be quicker.
FLOORS = {
    "Python starts": "pass",
    "imports": "import mbsym_cli.process, mbsym.studies.run, mbsym_cli.study, mbsym.analysis, mbsym.source.document, "
    "mbsym.report.latex.report, mbsym.report.html.report, mbsym.report.wolfram_report, "
    "mbsym.report.code.python_module, mbsym.report.code.c_source, mbsym.report.results_json",
    "everything derived and checked": "import os, pathlib\n"
    "from mbsym.analysis import Analysis\n"
    "from mbsym.report.whole_run import derive_all\n"
    "from mbsym.source import load\n"
    f"system, _, _ = load(pathlib.Path('{SATELLITE}'))\n"
    "derive_all(Analysis(system), ('python',), lambda text: None)\n"
    "os._exit(0)",
}


def satellite(options: argparse.Namespace) -> Record:
    """Equations and linearisation in-process, and the whole processes, in turn."""
    if not (ROOT / SATELLITE).exists():
        say(f"  {SATELLITE} is not there: mbsym's side stays empty")
    roads = [road for road in peer_satellite.ROADS if not (options.quick and road == "library")]
    with tempfile.TemporaryDirectory() as folder:
        commands: dict[str, tuple[list[str], bool]] = {
            "mbsym, inside": (measure_command(SATELLITE), True),
            "mbsym run": ([*mbsym_command(), "run", SATELLITE, "--out", str(Path(folder) / "out")], False),
        }
        for floor, code in FLOORS.items():
            commands[floor] = ([sys.executable, "-c", code], False)
        for road in roads:
            commands[road] = ([sys.executable, str(HERE / "peer_satellite.py"), "--road", road], True)
        warm = {road: ["--check"] for road in roads}
        done = in_turn(commands, options.runs, options.timeout, warm)
    return {name: summary(children) for name, children in done.items()}


def in_rounds(peer: Record, mine: Record) -> float | None:
    """The median of the ratios of the rounds: what else runs on the machine meets both sides of a round."""
    pairs = zip(peer.get("all_seconds", []), mine.get("all_seconds", []), strict=False)
    return median(ratio(a, b) for a, b in pairs)


def show_floors(results: Record) -> None:
    """What a run of the satellite cannot do without, in one process, and the run, which uses two cores."""
    names = [*FLOORS, "mbsym run"]
    processes = [results.get(name, {}).get("process", {}) for name in names]
    keys = (("wall, s", "seconds"), ("user + system, s", "cpu_seconds"))
    rows = [[title, *(number(p.get(key)) for p in processes)] for title, key in keys]
    table("Satellite: what the run stands on", ["in all", *FLOORS, "mbsym run, all reports"], rows)


def show_satellite(results: Record) -> None:
    """The tables of the satellite."""
    mine, whole = results["mbsym, inside"], results["mbsym run"]
    roads = [road for road in peer_satellite.ROADS if road in results]
    for name, result in results.items():
        if "complaint" in result:
            print(f"{ROAD_TITLES.get(name, name)}: {result['complaint']}")
    own = mine.get("seconds", {})
    headings = ["inside the process, s", "mbsym", *(ROAD_TITLES[road] for road in roads)]
    peers = {road: results[road].get("seconds", {}) for road in roads}
    rows = [
        ["import", number(own.get("import")), *(number(peers[road].get("import")) for road in roads)],
        ["load the file / build T and U", number(own.get("load")), *(number(peers[r].get("build")) for r in roads)],
    ]
    for stage in ("equations", "linearisation"):
        rows.append([stage, number(own.get(stage)), *(number(peers[road].get(stage)) for road in roads)])
    both = ("equations", "linearisation")
    rows.append(["both", number(total(own, both)), *(number(total(peers[road], both)) for road in roads)])
    operations = [results[road].get("operations", {}) for road in roads]
    terms = mine.get("terms", {})
    rows.append(
        [
            "M and f: terms / operations",
            count(total(terms, ("mass_matrix", "forcing"))),
            *(count(total(o, ("mass_matrix", "forcing"))) for o in operations),
        ]
    )
    differences = [max(results[road].get("differences", {"": math.nan}).values()) for road in roads]
    rows.append(["difference from the reference", number(mine.get("difference")), *map(number, differences)])
    table("Satellite: equations and linearisation (medians)", headings, rows)

    processes = [whole.get("process", {}), *(results[road].get("process", {}) for road in roads)]
    headings = ["whole process", "mbsym run, all reports", *(ROAD_TITLES[road] for road in roads)]
    keys = (("wall, s", "seconds"), ("user + system, s", "cpu_seconds"), ("peak memory, MB", "peak_mb"))
    table(
        "Satellite: whole processes (medians)", headings, [[t, *(number(p.get(k)) for p in processes)] for t, k in keys]
    )

    show_floors(results)
    process = whole.get("process", {})
    stages = ("load", *both)
    rows = []
    for title, target, value in (
        ("equations + linearisation", ">= 100", lambda r: ratio(total(peers[r], both), total(own, both))),
        (
            "the same, reading the file included",
            "",
            lambda r: ratio(total(peers[r], ("build", *both)), total(own, stages)),
        ),
        (
            "whole process, wall, median of the rounds",
            ">= 20; without the library >= 4",
            lambda r: in_rounds(results[r].get("process", {}), process),
        ),
        (
            "whole process, user + system",
            "",
            lambda r: ratio(results[r].get("process", {}).get("cpu_seconds"), process.get("cpu_seconds")),
        ),
        (
            "whole process, peak memory",
            "",
            lambda r: ratio(results[r].get("process", {}).get("peak_mb"), process.get("peak_mb")),
        ),
    ):
        rows.append([title, target, *(number(value(road)) for road in roads)])
    peak = process.get("peak_mb")
    rows.append(["mbsym run: peak memory, MB", "< 200", number(peak), *("" for _ in roads[1:])])
    table(
        "Satellite: SymPy / mbsym",
        ["ratio", "target", *(ROAD_TITLES[road] for road in roads)],
        rows,
    )
    print(f"The targets were set against {ROAD_TITLES['library']}; the other roads are harder to beat.")


# ------------------------------------------------------------------ the arm


def arm(options: argparse.Namespace) -> list[Record]:
    """Closed equations of the spatial arm, joint by joint; LagrangesMethod only as far as it is worth waiting."""
    results: list[Record] = []
    for kind in KINDS:
        gone: set[str] = set()
        for joints in range(2, options.joints + 1):
            say(f"  arm, {joints} joints, {kind}")
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / f"arm-{joints}-{kind}.yaml"
                path.write_text(peer_arm.description(joints, kind == "full"), encoding="utf-8")
                commands: dict[str, tuple[list[str], bool]] = {
                    "mbsym": (measure_command(str(path), f"{joints}:{kind}"), True)
                }
                for road in peer_arm.ROADS:
                    if (road == "plain" or joints <= options.library_joints) and road not in gone:
                        script = [sys.executable, str(HERE / "peer_arm.py"), str(joints), kind, "--road", road]
                        commands[road] = (script, True)
                runs = options.runs if joints <= 4 else 1
                warm = {road: ["--check"] for road in peer_arm.ROADS}
                done = in_turn(commands, runs, options.timeout, warm)
            parts = {name: summary(children) for name, children in done.items()}
            gone |= {name for name, part in parts.items() if "complaint" in part and name in peer_arm.ROADS}
            results.append({"joints": joints, "kind": kind, **parts})
    return results


def show_arm(results: list[Record]) -> None:
    """The table of the arm: seconds and size against the number of joints."""
    targets = {("principal", 6): "< 1 s", ("full", 6): "2 to 3 s"}
    parts = ("mass_matrix", "forcing")
    rows = []
    differences: dict[str, list[float]] = {}
    complaints = []
    for result in results:
        kind, joints = result["kind"], result["joints"]
        measured = {name: result.get(name, {}) for name in ("mbsym", *peer_arm.ROADS)}
        own, quick, slow = (part.get("seconds", {}).get("equations") for part in measured.values())
        rows.append(
            [
                f"{joints} {kind}",
                number(own),
                targets.get((kind, joints), ""),
                count(total(measured["mbsym"].get("terms", {}), parts)),
                number(quick),
                number(ratio(quick, own)),
                number(slow),
                number(ratio(slow, own)),
                count(total(measured["plain"].get("operations", {}), parts)),
            ]
        )
        for name, part in measured.items():
            if part.get("difference") is not None:
                differences.setdefault(name, []).append(part["difference"])
            if "complaint" in part:
                complaints.append(f"{joints} {kind}, {name}: {part['complaint']}")
    headings = ["joints", "mbsym, s", "target", "terms", "by hand, s", "ratio", "Lagrange, s", "ratio", "operations"]
    table(
        "Spatial arm: closed M(q) q'' = f, inside the process (medians; SymPy by hand, LagrangesMethod)", headings, rows
    )
    for name, values in differences.items():
        print(f"{name}: {len(values)} arms agree with Newton-Euler at a state to {max(values):.1e}")
    for complaint in complaints:
        print(complaint)


# ------------------------------------------------------------------ main


def versions() -> dict[str, str]:
    """Versions of what is measured."""
    found = {"python": ".".join(map(str, sys.version_info[:3]))}
    for name in ("mbsym", "sympy", "python-flint"):
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def machine() -> dict[str, Any]:
    """What seconds on the wall depend on: where more is running than there are processors, they are too many."""
    found: dict[str, Any] = {"processors": os.cpu_count()}
    if hasattr(os, "getloadavg"):
        found["load before"] = round(os.getloadavg()[0], 1)
    return found


def main() -> None:
    """Run the sections asked for, print their tables, write the record."""
    parser = argparse.ArgumentParser(description="mbsym beside SymPy: time, memory, size of formulas")
    parser.add_argument("--runs", type=int, default=3, help="counted runs of each process (default 3)")
    parser.add_argument("--sections", default=",".join(ALL), help=f"which of {', '.join(ALL)} (default: all)")
    parser.add_argument("--joints", type=int, default=6, help="largest arm (default 6)")
    parser.add_argument("--sympy-joints", type=int, default=5, help="largest chain lambdified from SymPy (default 5)")
    parser.add_argument("--full", action="store_true", help="LagrangesMethod too goes to the largest arm (default: 4)")
    parser.add_argument("--quick", action="store_true", help="one run, arms of 2 and 3 joints, no library linearizer")
    parser.add_argument("--timeout", type=float, default=600.0, help="seconds after which a process is stopped")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write everything measured to FILE")
    parser.add_argument("--measure", metavar="FILE", help=argparse.SUPPRESS)
    parser.add_argument("--arm", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        measure(options.measure, options.arm)
        return
    if options.quick:
        options.runs, options.joints = 1, min(options.joints, 3)
    options.library_joints = options.joints if options.full else 4

    sections: dict[str, tuple[Callable[[argparse.Namespace], Any], Callable[[Any], None]]] = {
        "satellite": (satellite, show_satellite),
        "arm": (arm, show_arm),
    }
    import large_bench
    import waits_bench

    for name, (work, show) in (large_bench.SECTIONS | waits_bench.SECTIONS).items():
        sections[name] = (work, partial(show, table=table))
    if set(options.sections.split(",")) - set(sections):
        import numbers_bench  # NumPy and compilers: not in a process whose children's memory is measured

        for name, (work, show) in numbers_bench.SECTIONS.items():
            sections[name] = (work, partial(show, table=table))
    compile_ours()
    record: Record = {"versions": versions(), "runs": options.runs, "machine": machine()}
    print(", ".join(f"{name} {version}" for name, version in record["versions"].items()))
    print(", ".join(f"{name} {value}" for name, value in record["machine"].items()))
    for name in options.sections.split(","):
        if name not in sections:
            parser.error(f"no section called {name!r}; there are {', '.join(sections)}")
        work, show = sections[name]
        say(f"{name}:")
        try:
            record[name] = work(options)
            show(record[name])
        except Exception as problem:
            print(f"section {name} failed: {type(problem).__name__}: {problem}")
    if options.json:
        options.json.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        say(f"written: {options.json}")


if __name__ == "__main__":
    main()
