"""An ensemble as files: statistics at every time, every member's values and final state, and all of it as JSON.

``ensemble.csv``    t, alive, then of every coordinate and velocity its mean, std, min, max and quantiles
``members.csv``     member, what varied, the final state (empty where the member ended early), ended, at
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import isfinite
from typing import Any

from msgspec import UNSET

from mbsym.expressions.message import Counted, Message
from mbsym.model.quantities import marked, unit_of
from mbsym.numerics.ensembles.ensemble import QUANTILES, Ensemble
from mbsym.numerics.ensembles.variation import Grid, Variation
from mbsym.report.documents import ensemble as doc
from mbsym.report.documents.base import file_of
from mbsym.report.runs.simulation_words import laws_json
from mbsym.report.runs.trajectory_csv import shortest, text_table, written

#: So many members that ended early are named one by one in sentences.
NAMED = 5


def quantile_name(chance: float) -> str:
    """``q05`` for 0.05."""
    return f"q{round(100 * chance):02d}"


def ensemble_csv(ensemble: Ensemble) -> str:
    """Statistics at every time; numbers read back exactly, nan where nobody lives."""
    spread, system = ensemble.statistics, ensemble.members.dynamics.system
    names, columns = [marked("t", unit_of(system, "t")), "alive"], [ensemble.times, spread.alive]
    for place, name in enumerate(ensemble.quantities):
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


def members_csv(ensemble: Ensemble) -> str:
    """One row a member, numbered from 0 in the order of the grid or of the draws."""
    system = ensemble.members.dynamics.system
    ended = {fate.member: fate for fate in ensemble.fates}
    varied = [marked(name, unit_of(system, name)) for name in ensemble.members.names]
    final = [marked(f"{name}_final", unit_of(system, name)) for name in ensemble.quantities]
    rows: list[Sequence[object]] = []
    for member in range(ensemble.count):
        fate = ended.get(member)
        values = map(shortest, ensemble.members.values[:, member])
        state = (shortest(value) if isfinite(value) else "" for value in ensemble.final[:, member])
        rows.append((member, *values, *state, *((fate.kind, f"{fate.time:.9g}") if fate else ("", ""))))
    return text_table(["member", *varied, *final, "ended", "at"], rows)


def ensemble_json(
    ensemble: Ensemble, variations: tuple[Variation, ...], seed: int, sampling: str, files: list[str]
) -> str:
    """The file's text; ``files`` are those that belong to it."""
    scenario = ensemble.members.dynamics.scenario
    spread = ensemble.statistics
    return file_of(
        doc.Ensemble,
        scenario.system,
        ensemble,
        status="partial" if ensemble.interrupted else "whole",
        inputs=laws_json(scenario) if scenario.inputs else UNSET,
        members=ensemble.count,
        varied=[_variation(variation) for variation in variations],
        seed=None if isinstance(variations[0], Grid) else seed,
        sampling="grid" if isinstance(variations[0], Grid) else sampling,
        time=(0.0, float(ensemble.times[-1]), len(ensemble.times)),
        ended=[
            doc.Ended.from_result(
                fate,
                values=zip(ensemble.members.names, map(float, ensemble.members.values[:, fate.member]), strict=True),
            )
            for fate in ensemble.fates
        ],
        final={
            name: (
                *(x[-1, place] for x in (spread.mean, spread.deviation, spread.least, spread.greatest)),
                {f"{chance:g}": row[-1, place] for chance, row in zip(QUANTILES, spread.quantiles, strict=True)},
            )
            for place, name in enumerate(ensemble.quantities)
        },
        files=files,
    )


def _variation(varied: Variation) -> doc.Varied:
    if isinstance(varied, Grid):
        return doc.Varied(name=varied.name, kind="grid", from_=varied.low, to=varied.high, count=varied.count)
    if varied.kind == "normal":
        return doc.Varied(name=varied.name, kind="normal", mean=varied.first, deviation=varied.second)
    return doc.Varied(name=varied.name, kind="uniform", from_=varied.first, to=varied.second)


def sentences(ensemble: Ensemble) -> Iterator[tuple[str, str]]:
    """(title, text): how it went, how good it is, who ended early."""
    setting, compared = ensemble.setting, ensemble.compared
    varied = Message("[[count]], [[names]] varied", count=ensemble.count, names=", ".join(ensemble.members.names))
    yield Message("members"), varied
    if compared.members:
        text = (
            "integrated more finely, [[members]]: at most [[size]] of a quantity's size away; of the others nothing is "
            "known"
        )
        members = Counted(len(compared.members), "member")
        yield Message("error"), Message(text, members=members, size=f"{compared.largest:.1e}")
    elif not ensemble.interrupted:
        yield Message("error"), Message("not estimated: nothing finer than this to compare with")
    if ensemble.missed:
        member, transient = min(ensemble.missed.items())
        text = (
            "a load that changes within [[width]] at t = [[time]] was passed by steps of [[step]] "
            "(member [[member]]; so "
            "in [[members]]): a step of [[needed]] meets it"
        )
        gaps = {"width": f"{transient.width:.2g}", "time": f"{transient.time:.6g}", "step": f"{transient.step:.2g}"}
        members = Counted(len(ensemble.missed), "member")
        yield (
            Message("warning"),
            Message(text, member=member, members=members, needed=f"{transient.width / 4:.2g}", **gaps),
        )
    if ensemble.fates:
        text = "[[ended]] early; from then on the statistics are those of the rest (column alive)"
        yield Message("warning"), Message(text, ended=Counted(len(ensemble.fates), "member ended", "members ended"))
        for fate in ensemble.fates[:NAMED]:
            text = "member [[member]] ([[values]]): [[how]] near t = [[time]]"
            values = ensemble.members.described(fate.member)
            yield (
                Message("ended"),
                Message(text, member=fate.member, values=values, how=Message(fate.kind), time=f"{fate.time:.6g}"),
            )
        if len(ensemble.fates) > NAMED:
            yield Message("ended"), Message("and [[count]] more, in members.csv", count=len(ensemble.fates) - NAMED)
    if ensemble.interrupted:
        yield (
            Message("warning"),
            Message("interrupted: statistics up to t = [[time]]", time=f"{ensemble.times[-1]:.9g}"),
        )
    text, gap = "[[method]], step [[setting]], float64; each member has steps of its own", setting.step
    if gap is None:
        text, gap = (
            "[[method]], tolerance [[setting]] per step, float64; each member has steps of its own",
            setting.tolerance,
        )
    yield Message("method"), Message(text, method=ensemble.method, setting=f"{gap:g}")
    if ensemble.members.dynamics.switches.outputs:
        text = "steps end where the rates are not smooth, each member's at places of its own"
        yield Message("switches"), Message(text)
    work = Message(
        "[[steps]] in [[seconds]] s, [[rate]] a second, [[threads]]",
        steps=Counted(ensemble.steps, "step"),
        seconds=f"{ensemble.seconds:.2f}",
        rate=f"{ensemble.steps / max(ensemble.seconds, 1e-9):.2g}",
        threads=Counted(ensemble.threads, "thread"),
    )
    yield Message("work"), work
