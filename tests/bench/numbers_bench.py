"""Numbers beside their peers: forward dynamics, simulation to equal error, and how code grows with the joints.

Everything is measured in one sitting, in turn, and the smallest of several rounds is taken on every side; nothing
asserts.  What each peer is given is said in README.md of this folder.
"""

from __future__ import annotations

import argparse
import importlib.util
import math
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import chains

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
Record = dict[str, Any]

#: States a kernel is called with in one go.
BATCH = 1_000


def best(work: Callable[[], Any], rounds: int = 5) -> float:
    """The smallest time of several rounds."""
    times = []
    for _ in range(rounds):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return min(times)


def dynamics_of(text: str) -> Any:
    """A description's codes."""
    import mbsym
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.scenario import scenario

    return Dynamics(scenario(mbsym.loads(text).system))


def states_of(dynamics: Any, count: int) -> Any:
    """``count`` different states near the initial one, shape (inputs, count)."""
    import numpy as np

    x = np.array([0.0, *map(float, dynamics.scenario.state)])
    return np.ascontiguousarray(x[:, None] + np.random.default_rng(3).uniform(-0.5, 0.5, (len(x), count)))


# --- forward dynamics ---


def forward(options: argparse.Namespace) -> list[Record]:
    """Nanoseconds of q'' = M^-1 f for chains: mbsym, Pinocchio's ABA, SymPy's lambdify."""
    program = pinocchio_program()
    results = []
    for kind in ("principal", "full"):
        for joints in (2, 3, 5, 7, 10, 15, 20):
            print(f"  chain, {joints} joints, {kind}", file=sys.stderr)
            links = chains.chain(joints, kind == "full")
            record: Record = {"joints": joints, "kind": kind, **mbsym_forward(links)}
            truth = record.pop("accelerations")
            record |= pinocchio_forward(links, program, truth)
            if joints <= options.sympy_joints:
                record |= sympy_forward(links, truth)
            results.append(record)
    return results


def mbsym_forward(links: list[chains.Link]) -> Record:
    """A new state every time inside machine code: one state at a time, and several side by side."""
    import ctypes

    import numpy as np

    from mbsym.numerics.kernels.llvm import compiled, kernels

    started = time.perf_counter()
    dynamics = dynamics_of(chains.description(links))
    code = dynamics.right_hand_side
    emitted = time.perf_counter() - started
    started = time.perf_counter()
    library = compiled({"rhs": code})
    compiling = time.perf_counter() - started
    started = time.perf_counter()
    kernel = kernels({"rhs": code}, wide=True)["rhs"]
    compiling_both = time.perf_counter() - started
    points = states_of(dynamics, BATCH)
    out = np.empty((len(code.outputs), BATCH))
    one_by_one = library.function("rhs.many", ctypes.c_void_p, ctypes.c_void_p, ctypes.c_int64)
    single = best(lambda: one_by_one(points.ctypes.data, out.ctypes.data, BATCH), 300)
    many = best(lambda: kernel(points), 300)
    assert np.array_equal(out, kernel(points))
    x = np.array([0.0, *map(float, dynamics.scenario.state)])
    return {
        "mbsym_ns": single / BATCH * 1e9,
        "mbsym_many_ns": many / BATCH * 1e9,
        "operations": code.operations,
        "emitting_s": emitted,
        "compiling_s": compiling,
        "compiling_both_s": compiling_both,
        "accelerations": kernel(x)[len(links) :],
    }


def pinocchio_program() -> Path | None:
    """The C++ peer, compiled once; None without a compiler or without Pinocchio's headers."""
    prefix = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix"
    eigen = next((p for p in (prefix / "include/eigen3", Path("/usr/include/eigen3")) if p.is_dir()), None)
    compiler = shutil.which("g++") or shutil.which("clang++")
    if compiler is None or eigen is None or not (prefix / "include/pinocchio").is_dir():
        return None
    target = Path(os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))) / "mbsym-bench" / "peer_pinocchio"
    source = HERE / "peer_pinocchio.cpp"
    if target.exists() and target.stat().st_mtime > source.stat().st_mtime:
        return target
    print("  compiling the C++ peer (a minute or two)", file=sys.stderr)
    target.parent.mkdir(parents=True, exist_ok=True)
    words = [compiler, "-O3", "-march=native", "-DNDEBUG", "-std=c++17"]
    words += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]
    words += [f"-I{prefix / 'include'}", f"-I{eigen}", str(source)]
    words += [f"-L{prefix / 'lib'}", "-lpinocchio_default", f"-Wl,-rpath,{prefix / 'lib'}", "-o", str(target)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode:
        print(done.stderr[-600:], file=sys.stderr)
        return None
    return target


def pinocchio_forward(links: list[chains.Link], program: Path | None, truth: Any) -> Record:
    """ABA inside C++, or, without a compiler, called from Python with the overhead of a call subtracted."""
    if program is not None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "chain.txt"
            path.write_text(chains.for_pinocchio(links))
            calls = max(50, 1_000 // len(links))
            done = subprocess.run([str(program), str(path), str(calls)], capture_output=True, text=True, check=True)
        words = [float(word) for word in done.stdout.split()]
        return {"pinocchio_ns": words[0], "pinocchio_by": "C++", "difference": relative(words[1:], truth)}
    if importlib.util.find_spec("pinocchio") is None:
        return {}
    return pinocchio_from_python(links, truth)


def pinocchio_from_python(links: list[chains.Link], truth: Any) -> Record:
    """Calls of ``pinocchio.aba`` less calls of it on a model without joints."""
    import numpy as np
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([float(x) for x in chains.GRAVITY])
    parent = 0
    for k, link in enumerate(links):
        joint = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ)[link.axis - 1]()
        place = pin.SE3(np.eye(3), np.array([float(x) for x in link.place]))
        parent = model.addJoint(parent, joint, place, f"joint{k}")
        inertia = np.array([[float(x) for x in row] for row in link.inertia])
        body = pin.Inertia(float(link.mass), np.array([float(x) for x in link.centre]), inertia)
        model.appendBodyToJoint(parent, body, pin.SE3.Identity())
    data, empty = model.createData(), pin.Model()
    nothing, none = empty.createData(), np.zeros(0)
    q, v = (np.array([float(x) for x in part]) for part in chains.state(len(links)))
    tau, calls = np.zeros(len(links)), 5_000

    def full() -> None:
        for _ in range(calls):
            pin.aba(model, data, q, v, tau)

    def bare() -> None:
        for _ in range(calls):
            pin.aba(empty, nothing, none, none, none)

    seconds = (best(full) - best(bare)) / calls
    pin.aba(model, data, q, v, tau)
    return {"pinocchio_ns": seconds * 1e9, "pinocchio_by": "Python", "difference": relative(data.ddq, truth)}


def sympy_forward(links: list[chains.Link], truth: Any) -> Record:
    """M and f by SymPy from the compact Lagrangian with these numbers, lambdify(cse=True), and NumPy's solve."""
    import numpy as np

    function, derived = sympy_function(links)
    n = len(links)
    q, v = (np.array([float(x) for x in part]) for part in chains.state(n))
    calls = 400

    def run() -> None:
        for _ in range(calls):
            matrix, right = function(q, v)
            np.linalg.solve(matrix, right)

    matrix, right = function(q, v)
    found = np.linalg.solve(matrix, right)[:, 0]
    return {
        "sympy_ns": best(run, 3) / calls * 1e9,
        "sympy_derivation_s": derived,
        "sympy_difference": relative(found, truth),
    }


def sympy_function(links: list[chains.Link]) -> tuple[Callable[[Any, Any], Any], float]:
    """(q, q') -> (M, f) with M q'' = f, and the seconds of deriving it."""
    import sympy as sp

    started = time.perf_counter()
    n = len(links)
    q, v = sp.symbols(f"q0:{n}"), sp.symbols(f"v0:{n}")
    spin, speed = sp.zeros(3, 1), sp.zeros(3, 1)
    down = sp.Matrix([sp.Float(float(x)) for x in chains.GRAVITY])
    height, kinetic, potential = sp.Integer(0), sp.Integer(0), sp.Integer(0)
    for k, link in enumerate(links):
        place, centre = (sp.Matrix([sp.Float(float(x)) for x in part]) for part in (link.place, link.centre))
        s, c = sp.sin(q[k]), sp.cos(q[k])
        turn = {
            1: sp.Matrix([[1, 0, 0], [0, c, s], [0, -s, c]]),
            2: sp.Matrix([[c, 0, -s], [0, 1, 0], [s, 0, c]]),
            3: sp.Matrix([[c, s, 0], [-s, c, 0], [0, 0, 1]]),
        }[link.axis]
        axis = sp.Matrix([int(link.axis == i) for i in (1, 2, 3)])
        speed = turn * (speed + spin.cross(place))
        height = height + down.dot(place)
        down = turn * down
        spin = turn * spin + v[k] * axis
        at_centre = speed + spin.cross(centre)
        inertia = sp.Matrix([[sp.Float(float(x)) for x in row] for row in link.inertia])
        kinetic += sp.Float(float(link.mass)) * at_centre.dot(at_centre) / 2 + spin.dot(inertia * spin) / 2
        potential -= sp.Float(float(link.mass)) * (height + down.dot(centre))
    momenta = [sp.diff(kinetic, x) for x in v]
    matrix = sp.Matrix(n, n, lambda i, j: sp.diff(momenta[i], v[j]))
    right = sp.Matrix(
        n,
        1,
        lambda i, _: sp.diff(kinetic - potential, q[i]) - sum(sp.diff(momenta[i], q[j]) * v[j] for j in range(n)),
    )
    function = sp.lambdify([q, v], [matrix, right], cse=True)
    return function, time.perf_counter() - started


def relative(found: Sequence[float], truth: Sequence[float]) -> float:
    """The largest difference relative to the largest value."""
    return max(abs(a - b) for a, b in zip(found, truth, strict=True)) / max(abs(x) for x in truth)


def show_forward(results: list[Record], table: Callable[..., None]) -> None:
    """ns per state, and how many times faster than the peers."""
    rows = []
    for r in results:
        target = ">= 5" if r["joints"] <= 10 else "> 1"
        rows.append(
            [
                f"{r['joints']} {r['kind']}",
                str(r["operations"]),
                f"{r['mbsym_ns']:.0f}",
                f"{r['mbsym_many_ns']:.0f}",
                _cell(r.get("pinocchio_ns"), ".0f"),
                _ratio(r, "pinocchio_ns"),
                target,
                _ratio(r, "pinocchio_ns", "mbsym_many_ns"),
                _cell(r.get("sympy_ns"), ".0f"),
                _ratio(r, "sympy_ns"),
                ">= 100" if "sympy_ns" in r else "",
            ]
        )
    headings = ["joints", "operations", "one, ns", "many, ns", "ABA, ns", "ABA/one", "target", "ABA/many"]
    headings += ["lambdify, ns", "ratio", "target"]
    how = next((r["pinocchio_by"] for r in results if "pinocchio_by" in r), "not installed")
    table(f"Forward dynamics of spatial chains, ns a state (Pinocchio timed in {how})", headings, rows)
    differences = [r[key] for r in results for key in ("difference", "sympy_difference") if key in r]
    if differences:
        print(f"accelerations of all agree to {max(differences):.1e}")


def _cell(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _ratio(record: Record, key: str, own: str = "mbsym_ns") -> str:
    return _cell(record[key] / record[own], ".1f") if key in record else ""


# --- simulation to equal error ---


def simulation(options: argparse.Namespace) -> list[Record]:
    """Seconds to the error that RK4 reaches with steps of 1 ms on the same kernel."""
    double = (ROOT / "systems/double-pendulum.yaml").read_text(encoding="utf-8")
    arm = chains.description(chains.chain(4, False))
    satellite = (ROOT / "systems/satellite.yaml").read_text(encoding="utf-8")
    return [
        equal_error("double pendulum", double, 60.0, double_pendulum),
        equal_error("chain of 4 joints", arm, 10.0, lambda: sympy_function(chains.chain(4, False))[0]),
        equal_error("satellite", satellite, 60.0, None),
    ]


def equal_error(title: str, text: str, end: float, peer: Callable[[], Any] | None) -> Record:
    """One system: RK4 at 1 ms, then the coarsest setting of each other way that is at least as accurate."""
    import numpy as np

    from mbsym.numerics.methods.interface import Setting, Unusable
    from mbsym.numerics.methods.table import METHODS
    from mbsym.numerics.trade.reference_search import solved_at

    print(f"  simulation, {title}", file=sys.stderr)
    dynamics = dynamics_of(text)
    truth = solved_at(dynamics, [0.0, end], 1e-24, 600.0).astype(float)
    final, size = truth[:, -1], np.max(np.abs(truth), axis=1)

    def run(name: str, setting: Any) -> tuple[float, float]:
        seconds, state = [], None
        while len(seconds) < 5 or (len(seconds) < 40 and sum(seconds) < 1.0):
            going = METHODS[name].start(dynamics, setting)
            started = time.perf_counter()
            state = going.advance(end)
            seconds.append(time.perf_counter() - started)
        return float(np.max(np.abs(np.asarray(state, dtype=float) - final) / size)), min(seconds)

    goal, cost = run("rk4", Setting(step=1e-3))
    ways: Record = {"rk4 at 1 ms": {"error": goal, "seconds": cost}}
    for name in ("dop853", "taylor", "scipy-dop853"):
        for power in np.arange(-5, -15.01, -0.5):
            if name not in METHODS:
                break
            try:
                error, seconds = run(name, Setting(tolerance=10.0**power))
            except Unusable as reason:
                ways[name] = {"complaint": str(reason)}
                break
            if error <= goal:
                ways[name] = {"error": error, "seconds": seconds, "tolerance": 10.0**power}
                break
    if peer is not None:
        ways["SciPy on lambdify"] = lambdified(dynamics, peer(), end, final, size, goal)
    return {"title": title, "end": end, "reference_error": truth.error, "ways": ways}


def lambdified(dynamics: Any, function: Any, end: float, final: Any, size: Any, goal: float) -> Record:
    """solve_ivp(DOP853) on a function lambdified from SymPy, as most people do it."""
    import numpy as np
    from scipy.integrate import solve_ivp

    n = dynamics.size
    start = np.array([float(x) for x in dynamics.scenario.state])

    def slope(t: float, x: Any) -> Any:
        matrix, right = function(x[:n], x[n:])
        return np.concatenate([x[n:], np.linalg.solve(matrix, np.ravel(right))])

    for power in np.arange(-5, -13.51, -0.5):
        started = time.perf_counter()
        found = solve_ivp(slope, (0, end), start, method="DOP853", rtol=10.0**power, atol=10.0**power)
        seconds = time.perf_counter() - started
        error = float(np.max(np.abs(found.y[:, -1] - final) / size))
        if error <= goal:
            return {"error": error, "seconds": seconds, "tolerance": 10.0**power}
    return {"complaint": f"never as accurate as {goal:.1e} (down to {error:.1e})"}


def double_pendulum() -> Callable[[Any, Any], Any]:
    """systems/double-pendulum.yaml with its values, by SymPy: (q, q') -> (M, f)."""
    import sympy as sp

    (a, b), (u, w) = sp.symbols("q0:2"), sp.symbols("v0:2")
    g = sp.Float(9.81)
    x1, y1 = sp.sin(a), -sp.cos(a)
    x2, y2 = x1 + sp.sin(a + b), y1 - sp.cos(a + b)

    def rate(e: Any) -> Any:
        return sp.diff(e, a) * u + sp.diff(e, b) * w

    kinetic = sum(rate(e) ** 2 for e in (x1, y1, x2, y2)) / 2
    potential = g * (y1 + y2)
    momenta = [sp.diff(kinetic, x) for x in (u, w)]
    matrix = sp.Matrix(2, 2, lambda i, j: sp.diff(momenta[i], (u, w)[j]))
    right = sp.Matrix(2, 1, lambda i, _: sp.diff(kinetic - potential, (a, b)[i]) - rate(momenta[i]))
    found: Callable[[Any, Any], Any] = sp.lambdify([(a, b), (u, w)], [matrix, right], cse=True)
    return found


def show_simulation(results: list[Record], table: Callable[..., None]) -> None:
    """Seconds, errors and ratios to equal error."""
    rows = []
    targets = {"rk4 at 1 ms": ">= 20", "SciPy on lambdify": ">= 10"}
    for result in results:
        ways = result["ways"]
        fastest = min(
            (w["seconds"] for k, w in ways.items() if k in ("dop853", "taylor") and "seconds" in w), default=math.inf
        )
        for name, way in ways.items():
            if "complaint" in way:
                rows.append([result["title"], name, way["complaint"], "", "", ""])
                continue
            ratio = way["seconds"] / fastest
            rows.append(
                [
                    result["title"],
                    name,
                    f"{way['error']:.1e}",
                    f"{way['seconds'] * 1e3:.3g}",
                    f"{ratio:.1f}",
                    targets.get(name, ""),
                ]
            )
    table(
        "Simulation to the error of RK4 at 1 ms (ratio: to the quickest of mbsym's own)",
        ["system", "method", "error", "ms", "ratio", "target"],
        rows,
    )


# --- growth ---


def growth(options: argparse.Namespace) -> list[Record]:
    """Seconds and operations from 2 to 200 joints, by both routes of forward dynamics."""
    import mbsym
    from mbsym.mechanics.programs import forward_dynamics
    from mbsym.mechanics.variables import ring_of
    from mbsym.numerics.dynamics import Dynamics
    from mbsym.numerics.kernels.llvm import SCALARS, function_text
    from mbsym.numerics.scenario import scenario

    results = []
    for joints in (2, 5, 10, 20, 50, 100, 200):
        print(f"  growth, {joints} joints", file=sys.stderr)
        system = mbsym.loads(chains.description(chains.chain(joints, False))).system
        ring = ring_of(system)
        started = time.perf_counter()
        found = forward_dynamics(system, ring)
        emitted = time.perf_counter() - started
        code = Dynamics(scenario(system), ring).right_hand_side
        started = time.perf_counter()
        text = function_text("f", code, SCALARS["float64"])
        written = time.perf_counter() - started
        record = {"joints": joints, "emitting_s": emitted, "writing_s": written, "method": found.method}
        record |= {"operations": code.operations, "counted": dict(found.operations), "lines": text.count("\n")}
        results.append(record)
    return results


def show_growth(results: list[Record], table: Callable[..., None]) -> None:
    """Emitting time and operations a joint."""
    rows = []
    for r in results:
        counted = ", ".join(f"{name} {count}" for name, count in r["counted"].items())
        rows.append(
            [
                str(r["joints"]),
                f"{r['emitting_s']:.2f}",
                f"{1e3 * r['emitting_s'] / r['joints']:.1f}",
                f"{r['writing_s']:.2f}",
                str(r["operations"]),
                f"{r['operations'] / r['joints']:.0f}",
                counted,
            ]
        )
    headings = [
        "joints",
        "emitting, s",
        "ms/joint",
        "LLVM text, s",
        "operations",
        "per joint",
        "counted for each route",
    ]
    table("Forward dynamics: growth with the number of joints", headings, rows)


SECTIONS: dict[str, tuple[Callable[[argparse.Namespace], Any], Callable[..., None]]] = {
    "forward": (forward, show_forward),
    "simulation": (simulation, show_simulation),
    "growth": (growth, show_growth),
}
