"""``mbsym simulate --vary`` and ``--sensitivity``: integrated, written, summed up."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym_cli.console import BAD_INPUT, BROKEN_DOWN, FAILED, INTERRUPTED, OK, complain, printable, status
from mbsym_cli.files import deliver
from mbsym_cli.options import Options
from mbsym_cli.progress import progress
from mbsym_cli.study import attempted
from mbsym_cli.telling import told

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.numerics.scenario import Scenario
    from mbsym_cli.simulate.many import Varied
    from mbsym_cli.simulate.request import Asked


def spread(
    file: Path,
    folder: Path,
    given: Scenario,
    overrides: Mapping[str, Expression],
    varied: Varied,
    wanted: Asked,
    options: Options,
) -> int:
    """Many motions; the exit code."""
    from mbsym.numerics.ensembles.ensemble import Ensemble
    from mbsym.numerics.ensembles.variation import Unvaried
    from mbsym.report.figures.ensemble_figure import fan_charts
    from mbsym.report.runs.ensemble_tables import ensemble_csv, ensemble_json, members_csv, sentences
    from mbsym.simulation.ensembles import Spread, simulate_many

    request = Spread(wanted.request, varied.variations, varied.members, varied.seed, varied.sampling)
    texts: dict[str, str | bytes] = {}

    def work() -> Ensemble:
        with progress(wanted.quiet, file.name, wanted.request.time) as watch:
            found = simulate_many(given, request, overrides, watch=watch)
        with status(wanted.quiet, "drawing"):
            if "csv" in wanted.formats:
                texts.update({"ensemble.csv": ensemble_csv(found), "members.csv": members_csv(found)})
            kinds = [kind for kind in wanted.formats if kind != "csv"]
            texts.update(fan_charts(found, kinds) if kinds and len(found.times) > 1 else {})
            files = list(texts)
            texts["ensemble.json"] = ensemble_json(found, varied.variations, varied.seed, varied.sampling, files)
            deliver(folder, texts, "ensemble")
        return found

    try:
        found = attempted(file, work)
    except Unvaried as error:
        for name, text, hint in error.reasons:
            options.complain(f"--vary {name}", "bad-variation", text, hint or None)
        options.refused(file)
        return BAD_INPUT
    except MemoryError:
        complain(file, "out of memory; ask for fewer members")
        return FAILED
    if found is None:
        return FAILED
    if not wanted.quiet:
        told(file, given.system, sentences(found), folder, texts)
    if found.interrupted:
        complain(file, f"interrupted; kept up to t = {found.times[-1]:.9g}")
        return INTERRUPTED
    if found.fates:
        print(f"{printable(file)}: {len(found.fates)} of {found.count} members ended early.", file=sys.stderr)
        return BROKEN_DOWN
    return OK


def beside(
    file: Path,
    folder: Path,
    read: Callable[[tuple[str, ...]], Scenario | None],
    varied: Varied,
    wanted: Asked,
    options: Options,
) -> int:
    """A few motions, each a run of its own, in one picture; ``read`` makes a scenario with more settings."""
    from mbsym.report.figures.figures import Curve, curves
    from mbsym.report.runs.summary import result_lines
    from mbsym.report.runs.trajectory_csv import trajectory_parts
    from mbsym.simulation import Simulation, simulate
    from mbsym_cli.simulate.files import rates_along

    texts: dict[str, str | bytes] = {}
    members = tuple(varied.few)
    given = [read(tuple(f"{name}={value}" for name, value in one)) for one in members]
    if options.refused(file):
        return BAD_INPUT
    names = [", ".join(f"{name} = {value:.12g}" for name, value in one) for one in members]

    def work() -> list[Simulation]:
        found = []
        for name, one in zip(names, given, strict=True):
            assert one is not None
            with progress(wanted.quiet, f"{file.name}: {name}", wanted.request.time) as watch:
                found.append(simulate(one, wanted.request, watch))
        with status(wanted.quiet, "drawing"):
            if "csv" in wanted.formats:
                rows = {f"trajectory-{k}.csv": trajectory_parts(run.trajectory) for k, run in enumerate(found, start=1)}
                texts.update({name: "".join(parts) for name, parts in rows.items()})
            kinds = [kind for kind in wanted.formats if kind != "csv"]
            drawn = [Curve(run.trajectory, rates_along(run), name) for run, name in zip(found, names, strict=True)]
            texts.update(curves(drawn, kinds) if kinds and all(len(run.times) > 1 for run in found) else {})
            deliver(folder, texts, "ensemble")
        return found

    found = attempted(file, work)
    if found is None:
        return FAILED
    if not wanted.quiet:
        lines = [
            (name, text)
            for name, run in zip(names, found, strict=True)
            for title, text in result_lines(run, file.name)
            if str(title) == "error"
        ]
        told(file, found[0].system, lines, folder, texts)
    ended = [(name, run) for name, run in zip(names, found, strict=True) if run.ended is not None]
    for name, run in ended:
        print(f"{printable(file)}: {name} ended early at t = {run.times[-1]:.9g}.", file=sys.stderr)
    return BROKEN_DOWN if ended else OK


def answers(
    file: Path,
    folder: Path,
    given: Scenario,
    overrides: Mapping[str, Expression],
    names: tuple[str, ...],
    wanted: Asked,
) -> int:
    """The motion's derivatives by initial values and parameters; the exit code."""
    from mbsym.report.runs.sensitivity_csv import sensitivity_csv, sentences
    from mbsym.simulation.sensitivities import Sensitivities, sensitivities

    def work() -> Sensitivities:
        with status(wanted.quiet, f"{file.name}: how it answers to changes"):
            found = sensitivities(given, wanted.request, names, overrides)
            deliver(folder, {"sensitivity.csv": sensitivity_csv(found)}, "sensitivity")
        return found

    found = attempted(file, work, None, "the derivatives", "derivatives")
    if found is None:
        return FAILED
    if not wanted.quiet:
        told(file, given.system, sentences(found), folder, ["sensitivity.csv"], Message("derivatives"))
    if found.ended is not None:
        complain(file, f"the derivatives end early: {found.ended}")
        return BROKEN_DOWN
    return OK
