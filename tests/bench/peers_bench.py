"""Integrators beside mbsym's: equal equations, equal rows, equal measured error, ratios of one run.

    python tests/bench/peers_bench.py [--quick] [--stiff]

who          what
-----------  ----------------------------------------------------------------------------------------------------------
scipy+numba  SciPy's DOP853 (Radau on stiff scenes) on the straight-line program compiled by numba, its Jacobian too
sundials     CVODE's BDF on stiff scenes, by scikit-sundae, right-hand side and Jacobian by numba
diffrax      Dopri8 (Kvaerno5 on stiff scenes), whole solve under jax.jit on the CPU in float64
pinocchio    classical RK4 with as many steps as that needs, times four calls of its ABA (in C++: a lower bound)
rk4 at 1 ms  mbsym's own compiled RK4 over the whole interval, against dop853 at the error that RK4 has

All but the last take the loosest tolerance (half decades) at which the largest error of 2001 rows, relative to each
component's size, is within the target, and are timed with the rows that are asked for; the reference is mbsym's dop853
in extended arithmetic, held against a run of rk45 (on stiff scenes rodas5p, held against CVODE, both at 1e-13).  Times
are the least processor times of interleaved repetitions, compiling not counted.  Who is not installed (the extra
``bench``) is named.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable, Sequence
from functools import cache
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

import chains  # noqa: E402
import numbers_bench  # noqa: E402
from truth.independent.scenes import SCENES  # noqa: E402

import mbsym  # noqa: E402
from mbsym.numerics.dynamics import Dynamics  # noqa: E402
from mbsym.numerics.kernels.interface import EXTENDED, Code  # noqa: E402
from mbsym.numerics.methods.interface import Breakdown, Setting, Unusable  # noqa: E402
from mbsym.numerics.methods.table import METHODS  # noqa: E402
from mbsym.numerics.scenario import scenario  # noqa: E402

SYSTEMS = HERE.parents[1] / "systems"
JUDGED, REPEATS, POWERS = 2001, 7, np.arange(3.0, 14.01, 0.5)
STIFFNESSES = 10**3, 10**6

#: times -> states (2n, m)
Fill = Callable[[Any], Any]


def source(code: Code, name: str, module: str, gather: str) -> str:
    """The straight-line program as Python: ``name(t, x)`` with the functions of a module, ``gather`` of the outputs."""
    program, place = code.program, {name: k for k, name in enumerate(code.inputs)}
    lines = [f"def {name}(t, x):"]
    words = {"add": "{} + {}", "subtract": "{} - {}", "multiply": "{} * {}", "divide": "{} / {}", "negative": "-{}"}
    for number in program.live(code.outputs):
        operation, operands, payload = program.instructions[number]
        values = [f"v{k}" for k in operands]
        if operation == "input":
            k = place[str(payload)]
            text = "t" if k == 0 else f"x[{k - 1}]"
        elif operation == "constant":
            text = repr(float(payload))  # type: ignore[arg-type]
        else:
            text = words.get(operation, f"{module}.{operation}({{}})").format(*values)
        lines.append(f"    v{number} = {text}")
    outputs = ", ".join(f"v{node.number}" for node in code.outputs)
    return "\n".join([*lines, f"    return {gather.format(outputs)}"])


def function(code: Code, name: str, module: str, gather: str, names: dict[str, Any]) -> Callable[..., Any]:
    scope = dict(names)
    exec(compile(source(code, name, module, gather), name, "exec"), scope)  # of our own program
    made: Callable[..., Any] = scope[name]
    return made


# --- who integrates ---


def own(method: str) -> Callable[[Dynamics, float], Fill]:
    def make(dynamics: Dynamics, tolerance: float) -> Fill:
        run = METHODS[method].start(dynamics, Setting(tolerance=tolerance))
        state = np.array(run.state)

        def fill(times: Any) -> Any:
            run.restart(0.0, state)
            return np.column_stack([state, run.fill(times[1:])])

        return fill

    return make


@cache
def by_numba(dynamics: Dynamics) -> tuple[Callable[..., Any], Callable[..., Any]]:
    """The right-hand side and its Jacobian (n, n)."""
    import math

    import numba

    names = {"np": np, "math": math}
    parts = ((dynamics.right_hand_side, "rhs"), (dynamics.jacobian, "jac"))
    rhs, flat = (numba.njit(function(code, name, "math", "np.array([{}])", names)) for code, name in parts)
    n = len(dynamics.scenario.state)
    return rhs, lambda t, x: flat(t, x).reshape(n, n)


def scipy_numba(solver: str) -> Callable[[Dynamics, float], Fill]:
    def make(dynamics: Dynamics, tolerance: float) -> Fill:
        from scipy.integrate import solve_ivp

        rhs, slopes = by_numba(dynamics)
        start = np.array([float(x) for x in dynamics.scenario.state])
        more = {"jac": slopes} if solver == "Radau" else {}
        rhs(0.0, start)

        def fill(times: Any) -> Any:
            found = solve_ivp(rhs, (0.0, times[-1]), start, solver, times, rtol=tolerance, atol=tolerance, **more)
            return found.y if found.y.shape[1] == len(times) else np.full((len(start), len(times)), np.nan)

        return fill

    return make


def sundials(dynamics: Dynamics, tolerance: float) -> Fill:
    """CVODE's BDF by scikit-sundae, which calls right-hand side and Jacobian through Python."""
    from sksundae.cvode import CVODE

    rhs, slopes = by_numba(dynamics)
    start = np.array([float(x) for x in dynamics.scenario.state])

    def rates(t: float, x: Any, into: Any) -> None:
        into[:] = rhs(t, x)

    def jacobian(t: float, x: Any, _: Any, into: Any) -> None:
        into[:] = slopes(t, x)

    solver = CVODE(rates, rtol=tolerance, atol=tolerance, jacfn=jacobian, max_num_steps=200_000)

    def fill(times: Any) -> Any:
        found = solver.solve(times, start).y.T
        return found if found.shape[1] == len(times) else np.full((len(start), len(times)), np.nan)

    return fill


@cache
def by_diffrax(dynamics: Dynamics, solver: str) -> Callable[[Any, float], Any]:
    """The whole solve, compiled once: (times, tolerance) -> states (m, 2n)."""
    import diffrax as dfx
    import jax

    jax.config.update("jax_enable_x64", True)
    import jax.numpy as jnp

    rhs = function(dynamics.right_hand_side, "rhs", "jnp", "jnp.stack([jnp.asarray(v) for v in ({},)])", {"jnp": jnp})
    start = jnp.array([float(x) for x in dynamics.scenario.state])
    term = dfx.ODETerm(lambda t, x, args: rhs(t, x))

    @jax.jit
    def solve(times: Any, tolerance: Any) -> Any:
        way, control = getattr(dfx, solver)(), dfx.PIDController(rtol=tolerance, atol=tolerance)
        save = dfx.SaveAt(ts=times)
        return dfx.diffeqsolve(
            term, way, 0.0, times[-1], None, start, saveat=save, stepsize_controller=control, max_steps=200_000,
            throw=False,
        ).ys  # fmt: skip

    return lambda times, tolerance: np.asarray(solve(jnp.asarray(times), tolerance).block_until_ready())


def diffrax(solver: str) -> Callable[[Dynamics, float], Fill]:
    def make(dynamics: Dynamics, tolerance: float) -> Fill:
        solve = by_diffrax(dynamics, solver)
        return lambda times: solve(times, tolerance).T

    return make


# --- what is compared ---


PLAIN = {
    "mbsym dop853": own("dop853"),
    "scipy+numba DOP853": scipy_numba("DOP853"),
    "diffrax Dopri8": diffrax("Dopri8"),
}
STIFF = {
    "mbsym rodas5p": own("rodas5p"),
    "mbsym radau (SciPy's)": own("radau"),
    "scipy+numba Radau": scipy_numba("Radau"),
    "sundials CVODE": sundials,
    "diffrax Kvaerno5": diffrax("Kvaerno5"),
}


def sizes(truth: Any) -> Any:
    return np.maximum(np.max(np.abs(truth), axis=1), 1e-300)[:, None]


def error(states: Any, truth: Any) -> float:
    with np.errstate(all="ignore"):
        found = float(np.max(np.abs(states - truth) / sizes(truth)))
    return found if np.isfinite(found) else inf


def fitting(make: Callable[[Dynamics, float], Fill], dynamics: Dynamics, times: Any, truth: Any, goal: float) -> Any:
    """(fill, tolerance, error) at the loosest tolerance that reaches the goal; None where none does."""
    for power in POWERS:
        try:
            fill = make(dynamics, float(10**-power))
            wrong = error(fill(times), truth)
        except Breakdown:
            continue
        if wrong <= goal:
            return fill, float(10**-power), wrong
    return None


def least(work: Sequence[Callable[[], Any]]) -> list[float]:
    """The least processor time of each, in turn, after a first time that may compile."""
    for one in work:
        one()
    best = [inf] * len(work)
    for _ in range(REPEATS):
        for k, one in enumerate(work):
            count, started = 0, time.process_time()
            while count < 1 or time.process_time() - started < 5e-3:
                one()
                count += 1
            best[k] = min(best[k], (time.process_time() - started) / count)
    return best


def reference(dynamics: Dynamics, times: Any, stiff: bool) -> tuple[Any, float]:
    """(states, how far a solution by another method is from them)."""
    start = np.array([float(x) for x in dynamics.scenario.state])[:, None]
    if stiff:
        found, other = own("rodas5p")(dynamics, 1e-13)(times), sundials(dynamics, 1e-13)(times)
        return found, error(other, found)
    how = Setting(tolerance=1e-16, longest=float(times[-1]) / 2000)
    states = METHODS["dop853"].start(dynamics, how, EXTENDED).fill(times[1:])
    other = METHODS["rk45"].start(dynamics, Setting(tolerance=1e-14)).fill(times[1:])
    found = np.hstack([start, states.astype(float)])
    return found, error(np.hstack([start, np.asarray(other, dtype=float)]), found)


def compare(title: str, text: str, end: float, goal: float, rows: int, stiff: bool) -> dict[str, float]:
    """Seconds by who integrates; what was found is printed."""
    dynamics = Dynamics(scenario(mbsym.loads(text).system))
    judged, times = np.linspace(0.0, end, JUDGED), np.linspace(0.0, end, rows)
    truth, agreement = reference(dynamics, judged, stiff)
    print(f"\n{title}: {end:g} s, {rows} rows, error {goal:.0e}; the references differ by {agreement:.0e}", flush=True)
    found = {}
    for who, make in (STIFF if stiff else PLAIN).items():
        try:
            fit = fitting(make, dynamics, judged, truth, goal)
        except (ImportError, Unusable) as reason:
            print(f"  {who}: missing ({reason})")
            continue
        if fit is None:
            print(f"  {who}: does not reach it")
            continue
        found[who] = fit
    seconds = least([lambda fill=fit[0]: fill(times) for fit in found.values()])
    first = min((s for who, s in zip(found, seconds, strict=True) if who.startswith("mbsym")), default=inf)
    for (who, (_, tolerance, wrong)), spent in zip(found.items(), seconds, strict=True):
        print(f"  {who:22} tolerance {tolerance:.1e} error {wrong:.1e} {spent * 1e3:9.4g} ms  {spent / first:7.2f}")
    return dict(zip(found, seconds, strict=True))


def van_der_pol(stiffness: int, goal: float) -> dict[str, float]:
    """Somewhat more than a period."""
    text, _ = scene("van der pol")
    text = text.replace("100*(", f"{stiffness}*(")
    return compare(f"van der pol, mu = {stiffness:.0e}", text, 2.0 * stiffness, goal, 201, True)


def fixed_steps(title: str, text: str, end: float, rows: int) -> None:
    """dop853 against RK4 at 1 ms over the whole interval, at the error that RK4 has there."""
    dynamics = Dynamics(scenario(mbsym.loads(text).system))
    times = np.linspace(0.0, end, rows)
    truth, _ = reference(dynamics, times, False)
    run = METHODS["rk4"].start(dynamics, Setting(step=1e-3))
    state = np.array(run.state)

    def rk4() -> Any:
        run.restart(0.0, state)
        return np.column_stack([state, run.fill(times[1:])])

    goal = max(error(rk4(), truth), 1e-14)
    fit = fitting(own("dop853"), dynamics, times, truth, goal)
    if fit is None:
        print(f"\n{title}: dop853 does not reach the {goal:.1e} of RK4 at 1 ms")
        return
    slow, quick = least([rk4, lambda: fit[0](times)])
    going = METHODS["dop853"].start(dynamics, Setting(tolerance=fit[1]))
    going.advance(end)
    fewer = 4 * end / 1e-3 / going.work.evaluations
    print(
        f"\n{title}: {end:g} s, {rows} rows, RK4 at 1 ms has {goal:.1e}: {slow * 1e3:.4g} ms; dop853 {fit[1]:.1e} "
        f"{quick * 1e3:.4g} ms; {slow / quick:.1f} times, with {fewer:.1f} times fewer evaluations (20 is aimed at)"
    )


def pinocchio(goal: float) -> None:
    """A chain of four joints: as many steps of RK4 as reach the goal, four ABAs each."""
    links = chains.chain(4, False)
    dynamics = Dynamics(scenario(mbsym.loads(chains.description(links)).system))
    times = np.linspace(0.0, 10.0, 201)
    truth, _ = reference(dynamics, times, False)
    accelerations = numbers_bench.mbsym_forward(links)["accelerations"]
    found = numbers_bench.pinocchio_forward(links, numbers_bench.pinocchio_program(), accelerations)
    if not found:
        print("\nchain of 4 joints: pinocchio is missing")
        return
    for power in range(14):
        steps = 200 * 2**power
        run = METHODS["rk4"].start(dynamics, Setting(step=10.0 / steps))
        start = np.array(run.state)[:, None]
        wrong = error(np.hstack([start, run.fill(times[1:])]), truth)
        if wrong <= goal:
            break
    else:
        print(f"\nchain of 4 joints: RK4 does not reach {goal:.0e}")
        return
    fit = fitting(own("dop853"), dynamics, times, truth, goal)
    (quick,) = least([lambda: fit[0](times)])
    slow = steps * 4 * found["pinocchio_ns"] * 1e-9
    print(f"\nchain of 4 joints, 10 s, 201 rows, error {goal:.0e}: Pinocchio's ABA ({found['pinocchio_by']}, "
          f"{found['pinocchio_ns']:.0f} ns) in {steps} steps of RK4: {slow * 1e3:.4g} ms and more; "
          f"dop853 {quick * 1e3:.4g} ms; {slow / quick:.1f} times")  # fmt: skip


def scene(name: str) -> tuple[str, float]:
    """A scene with an independent solution."""
    found = next(one for one in SCENES if one.name == name)
    return found.text, found.time


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="one system of each kind")
    parser.add_argument("--stiff", action="store_true", help="van der Pol's oscillator alone, as a JSON record")
    options = parser.parse_args()
    if options.stiff:
        print(json.dumps({f"{stiffness:.0e}": van_der_pol(stiffness, 1e-4) for stiffness in STIFFNESSES}))
        return
    quick = options.quick
    names = (("double-pendulum", 10.0), ("spring-pendulum", 20.0), ("spatial-arm", 5.0))
    for name, end in names[: 1 if quick else None]:
        text = (SYSTEMS / f"{name}.yaml").read_text(encoding="utf-8")
        for goal in (1e-4, 1e-8):
            for rows in (2,) if quick else (2, 2001):
                compare(name, text, end, goal, rows, False)
        fixed_steps(name, text, end, 201)
    for stiffness in STIFFNESSES[: 1 if quick else None]:
        van_der_pol(stiffness, 1e-4)
    pinocchio(1e-8)


if __name__ == "__main__":
    main()
