"""What outputs say, as data, and whether it is true of a system whose answer is known.

The functions ``false_...`` are the judges: they take what was printed (verdicts, conserved quantities, equilibria,
errors) and what is known by hand, and list every sentence that is not true.  They know nothing of how mbsym arrives at
them.  The tests feed them the real outputs (nothing may be false) and planted lies (each must be found).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

State = np.ndarray

#: What may truly be said of a motion of each nature.  The first word is the whole truth, the others say less.
ASYMPTOTIC = "asymptotically stable"
STABLE = "stable"
CRITICAL = "stable in first approximation only"
GYROSCOPIC = "gyroscopically stabilised only"
UNSTABLE = "unstable"
DRIFTS = "stable but for a drift of cyclic coordinates"
ASYMPTOTIC_BUT_DRIFTS = "asymptotically stable but for a drift of cyclic coordinates"
REPLACED = "asymptotically stable but for a change of the steady motion"
TURNED = "asymptotically stable but for a rotation of space"
NOTHING = ("undecided", "depends on the parameters")

TRUE_OF: Mapping[str, tuple[str, ...]] = {
    # nature of the motion: what is true of it
    "asymptotic": (ASYMPTOTIC, STABLE, CRITICAL),
    "stable": (STABLE, CRITICAL),
    "stable, gyroscopic": (STABLE, CRITICAL, GYROSCOPIC, DRIFTS),  # K is not positive definite, and nothing dissipates
    "open, gyroscopic": (GYROSCOPIC, CRITICAL),  # nobody knows; the first approximation is stable, K is not positive
    "open, critical": (CRITICAL,),  # the first approximation is stable, no theorem is known
    "unstable": (UNSTABLE,),
    "unstable, critical": (UNSTABLE, CRITICAL),  # the first approximation is stable, the motion is not
    "drifts": (DRIFTS, CRITICAL),
    "drifts, gyroscopic": (DRIFTS, CRITICAL, GYROSCOPIC),
    "asymptotic, drifts": (ASYMPTOTIC_BUT_DRIFTS, DRIFTS, CRITICAL),
    "asymptotic, displaced": (ASYMPTOTIC_BUT_DRIFTS, DRIFTS, STABLE, CRITICAL),  # what is displaced stays there
    "stable, displaced": (STABLE, DRIFTS, CRITICAL),
    "asymptotic, beside other rests": (REPLACED, STABLE, CRITICAL),
    "turned": (TURNED, CRITICAL),
    "unknown": (),
    "time-dependent": (),
}
WORDS = {ASYMPTOTIC, STABLE, CRITICAL, GYROSCOPIC, UNSTABLE, DRIFTS, ASYMPTOTIC_BUT_DRIFTS, REPLACED, TURNED, *NOTHING}


@dataclass(frozen=True)
class Known:
    """A description, and what is true of it by hand.

    ``nature`` is that of its unperturbed motion at its values (a key of TRUE_OF); with ``decided`` mbsym has to find
    the whole truth, else it may say less.  ``motion`` (t, start) -> state solves the equations of motion in floats, the
    state being (q, q'); it is how conserved quantities and errors are judged.  ``rests`` are all relative equilibria.
    """

    name: str
    text: str
    nature: str = "unknown"
    decided: bool = True
    motion: Callable[[float, State], State] | None = None
    rests: Sequence[Sequence[float]] | None = None
    conserves_energy: bool | None = None


def false_verdict(known: Known, word: str) -> list[str]:
    """The sentence "the motion is <word>", if it is false."""
    assert word in WORDS, word
    if word in NOTHING or word in TRUE_OF[known.nature]:
        return []
    return [f"{known.name}: '{word}' is said of a motion that is {known.nature}"]


def undecided_verdict(known: Known, word: str) -> list[str]:
    """What should have been decided, and was not: no falsehood, but no help either."""
    if not known.decided or not TRUE_OF[known.nature] or word == TRUE_OF[known.nature][0]:
        return []
    return [f"{known.name}: '{word}' is all that is said of a motion that is {known.nature}"]


def false_integrals(known: Known, names: Sequence[str], integrals: Sequence[Mapping[str, str]]) -> list[str]:
    """Every quantity that is called a first integral and varies along a true motion."""
    if known.motion is None:
        return []
    found = []
    n = len(names)
    source = np.random.default_rng(20260101)
    for item in integrals:
        start = source.uniform(-0.5, 0.5, 2 * n)
        values = []
        for time in (0.0, 0.3, 1.1, 2.7):
            state = known.motion(time, start)
            table = dict(zip(names, state[:n], strict=True)) | {"t": time}
            table |= {f"{name}_dot": x for name, x in zip(names, state[n:], strict=True)}
            values.append(float(evaluated(item["formula"], table)))
        spread = max(values) - min(values)
        if spread > 1e-7 * (1 + max(map(abs, values))):
            found.append(f"{known.name}: '{item['name']}' is said to be conserved, but varies by {spread:.3g}")
    return found


def evaluated(formula: str, table: Mapping[str, float]) -> float:
    """The value of a formula in Python syntax."""
    functions = {name: getattr(np, name) for name in ("sin", "cos", "sqrt", "exp", "log", "tan")}
    return eval(formula, {"__builtins__": {}}, {**functions, "pi": np.pi, **table})


def false_equilibria(known: Known, found: Sequence[Sequence[float]], complete: bool) -> list[str]:
    """States called equilibria that are none, one state called two, and a complete list that lacks one."""
    assert known.rests is not None
    wrong = []
    for i, state in enumerate(found):
        if not any(same_state(state, other) for other in known.rests):
            wrong.append(f"{known.name}: {state} is listed as an equilibrium")
        if any(same_state(state, other) for other in found[:i]):
            wrong.append(f"{known.name}: {state} is listed twice")
    if complete:
        lost = [state for state in known.rests if not any(same_state(state, other) for other in found)]
        wrong += [f"{known.name}: the list is called complete without {state}" for state in lost]
    return wrong


def same_state(a: Sequence[float], b: Sequence[float]) -> bool:
    """Equal, angles up to whole turns."""
    turns = [(x - y) / (2 * np.pi) for x, y in zip(a, b, strict=True)]
    return all(abs(turn - round(turn)) < 1e-6 for turn in turns)


@dataclass(frozen=True)
class Run:
    """A simulation, and what it says: its largest relative error, and whether the (generalised) energy is conserved.

    ``times`` (m,) and ``states`` (2n, m) are what it computed.
    """

    times: np.ndarray
    states: np.ndarray
    error: float | None
    conserved: bool | None


def false_run(name: str, run: Run, truth: np.ndarray, conserves: bool) -> list[str]:
    """An error that is far from what it is said to be, and an energy falsely called conserved or not.

    ``truth`` (2n, m) is the motion itself.  "About" is a power of ten; an error of rounding size may be told as less.
    """
    wrong = []
    sizes = np.max(np.abs(truth), axis=1)
    error = float(np.max(np.max(np.abs(run.states - truth), axis=1) / np.where(sizes > 0, sizes, 1.0)))
    if run.error is not None:
        if error > 10 * run.error + 1e-14 or (error < run.error / 10 - 1e-14):
            wrong.append(f"{name}: the error is said to be about {run.error:.2g}, and is {error:.2g}")
        if run.error == 0:
            wrong.append(f"{name}: no run has no error")
    if run.conserved is not None and run.conserved is not conserves:
        wrong.append(f"{name}: its energy is said to be {'' if run.conserved else 'not '}conserved")
    return wrong
