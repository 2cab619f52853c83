"""An ensemble as files: statistics at every time, every member's values and final state, and all of it as JSON.

``ensemble.csv``    t, alive, then of every coordinate and velocity its mean, std, min, max and quantiles
``members.csv``     member, what varied, the final state (empty where the member ended early), ended, at
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import Any

import numpy as np
from msgspec import UNSET

from mbsym.expressions.counting import counted
from mbsym.model.quantities import marked, unit_of
from mbsym.numerics.ensembles.ensemble import QUANTILES, Ensemble
from mbsym.numerics.ensembles.variation import Grid, Variation
from mbsym.report.documents import ensemble as doc
from mbsym.report.documents.writer import written as document
from mbsym.report.runs.simulation_words import laws_json
from mbsym.report.runs.trajectory_csv import written
from mbsym.source.meaning import meaning

#: So many members that ended early are named one by one in sentences.
NAMED = 5


def quantile_name(chance: float) -> str:
    """``q05`` for 0.05."""
    return f"q{round(100 * chance):02d}"


def ensemble_csv(found: Ensemble) -> str:
    """Statistics at every time; numbers read back exactly, nan where nobody lives."""
    spread, system = found.statistics, found.members.dynamics.system
    names, columns = [marked("t", unit_of(system, "t")), "alive"], [found.times, spread.alive]
    for place, name in enumerate(found.quantities):
        unit = unit_of(system, name)
        parts: list[tuple[str, Any]] = [
            ("mean", spread.mean),
            ("std", spread.deviation),
            ("min", spread.least),
            ("max", spread.greatest),
            *((quantile_name(chance), row) for chance, row in zip(QUANTILES, spread.quantiles, strict=True)),
        ]
        names += [marked(f"{name}_{part}", unit) for part, _ in parts]
        columns += [values[:, place] for _, values in parts]
    return written(names, columns)


def members_csv(found: Ensemble) -> str:
    """One row a member, numbered from 0 in the order of the grid or of the draws."""
    system = found.members.dynamics.system
    ended = {fate.member: fate for fate in found.fates}
    varied = [marked(name, unit_of(system, name)) for name in found.members.names]
    final = [marked(f"{name}_final", unit_of(system, name)) for name in found.quantities]
    lines = [",".join(["member", *varied, *final, "ended", "at"])]
    for member in range(found.count):
        fate = ended.get(member)
        state = found.final[:, member]
        lines.append(
            ",".join(
                [
                    str(member),
                    *(f"{value:.17g}" for value in found.members.values[:, member]),
                    *(f"{value:.17g}" if isfinite(value) else "" for value in state),
                    fate.kind if fate else "",
                    f"{fate.time:.9g}" if fate else "",
                ]
            )
        )
    return "\n".join([*lines, ""])


def ensemble_json(
    found: Ensemble, variations: tuple[Variation, ...], seed: int, sampling: str, files: list[str]
) -> str:
    """The file's text; ``files`` are those that belong to it."""
    scenario = found.members.dynamics.scenario
    spread, compared = found.statistics, found.compared
    content = doc.Ensemble(
        system=scenario.system.name,
        description_sha256=meaning(scenario.system),
        status="partial" if found.interrupted else "whole",
        inputs=laws_json(scenario) if scenario.inputs else UNSET,
        members=found.count,
        varied=[_variation(one) for one in variations],
        seed=None if isinstance(variations[0], Grid) else seed,
        sampling="grid" if isinstance(variations[0], Grid) else sampling,
        time=doc.Time(from_=0.0, to=float(found.times[-1]), samples=len(found.times)),
        method=found.method,
        tolerance=found.setting.tolerance,
        step=found.setting.step,
        ended=[
            doc.Ended(
                member=fate.member,
                kind=fate.kind,
                time=fate.time,
                values=dict(zip(found.members.names, map(float, found.members.values[:, fate.member]), strict=True)),
            )
            for fate in found.fates
        ],
        final={
            name: doc.Final(
                mean=_finite(spread.mean[-1, place]),
                std=_finite(spread.deviation[-1, place]),
                min=_finite(spread.least[-1, place]),
                max=_finite(spread.greatest[-1, place]),
                quantiles={
                    f"{chance:g}": _finite(row[-1, place])
                    for chance, row in zip(QUANTILES, spread.quantiles, strict=True)
                },
            )
            for place, name in enumerate(found.quantities)
        },
        compared=doc.Compared(members=list(compared.members), largest=_finite(compared.largest)),
        steps=found.steps,
        files=files,
    )
    return document(content)


def _variation(one: Variation) -> doc.Varied:
    if isinstance(one, Grid):
        return doc.Varied(name=one.name, kind="grid", from_=one.low, to=one.high, count=one.count)
    if one.kind == "normal":
        return doc.Varied(name=one.name, kind="normal", mean=one.first, deviation=one.second)
    return doc.Varied(name=one.name, kind="uniform", from_=one.first, to=one.second)


def _finite(value: Any) -> float | None:
    return float(value) if np.isfinite(value) else None


def sentences(found: Ensemble) -> Iterator[tuple[str, str]]:
    """(title, text): how it went, how good it is, who ended early."""
    setting = found.setting
    how = f"tolerance {setting.tolerance:g} per step" if setting.step is None else f"step {setting.step:g}"
    yield "members", f"{found.count}, {', '.join(found.members.names)} varied"
    yield "method", f"{found.method}, {how}, float64; each member has steps of its own"
    rate = found.steps / max(found.seconds, 1e-9)
    threads = counted(found.threads, "thread", "threads")
    yield "work", f"{found.steps} steps in {found.seconds:.2f} s, {rate:.2g} a second, {threads}"
    compared = found.compared
    if compared.members:
        many = counted(len(compared.members), "member", "members")
        differ = "differs" if len(compared.members) == 1 else "differ"
        told = f"integrated more finely, {many} {differ} by {compared.largest:.1e} of a quantity's size at most"
        yield "error", told + "; of the others nothing is known"
    elif not found.interrupted:
        yield "error", "not estimated: nothing finer than this to compare with"
    if found.members.dynamics.switches.outputs:
        yield "switches", "steps end where the rates are not smooth, each member's at places of its own"
    if found.missed:
        member, one = min(found.missed.items())
        many = counted(len(found.missed), "member", "members")
        yield (
            "warning",
            f"a load that changes within {one.width:.2g} at t = {one.time:.6g} was passed by steps of {one.step:.2g} "
            f"(member {member}; so in {many}): a step of {one.width / 4:.2g} meets it",
        )
    if found.fates:
        ended = counted(len(found.fates), "member ended", "members ended")
        yield "warning", f"{ended} early; from then on the statistics are those of the rest (column alive)"
        for fate in found.fates[:NAMED]:
            yield (
                "ended",
                f"member {fate.member} ({found.members.described(fate.member)}): {fate.kind} near t = {fate.time:.6g}",
            )
        if len(found.fates) > NAMED:
            yield "ended", f"and {len(found.fates) - NAMED} more, in members.csv"
    if found.interrupted:
        yield "warning", f"interrupted: statistics up to t = {found.times[-1]:.9g}"
