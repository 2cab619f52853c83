"""``mbsym simulate --vary`` and ``--sensitivity``: integrated, written, summed up."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mbsym.expressions.message import Message
from mbsym_cli.console import BAD_INPUT, BROKEN_DOWN, FAILED, INTERRUPTED, OK, complain, progress, status
from mbsym_cli.files import deliver
from mbsym_cli.options import Options
from mbsym_cli.study import attempted, show_result

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
    read: Callable[[tuple[str, ...]], Scenario | None],
) -> int:
    """Many motions; the exit code.  ``read`` makes the scenario of one member, from its settings."""
    from mbsym.numerics.ensembles.ensemble import Ensemble
    from mbsym.numerics.ensembles.variation import Unvaried
    from mbsym.report.figures.figures import fan_charts
    from mbsym.report.runs.ensemble_tables import ensemble_csv, ensemble_json, members_csv, sentences
    from mbsym.simulation.ensembles import Spread, simulate_many

    request = Spread(wanted.request, varied.variations, varied.members, varied.seed, varied.sampling)
    texts: dict[str, str | bytes] = {}

    def work() -> Ensemble:
        with progress(wanted.quiet, file.name, wanted.request.time) as watch:
            found = simulate_many(given, request, overrides, watch=watch)
        kinds = [kind for kind in wanted.formats if kind != "csv"]
        several = _beside(file, read, varied, wanted, kinds) if kinds and not found.interrupted else {}
        with status(wanted.quiet, "drawing"):
            if "csv" in wanted.formats:
                texts.update({"ensemble.csv": ensemble_csv(found), "members.csv": members_csv(found)})
            texts.update(several or (fan_charts(found, kinds) if kinds and len(found.times) > 1 else {}))
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
    if wanted.as_json:
        click.echo(texts["ensemble.json"], nl=False)
    if not wanted.quiet:
        show_result(file, given.system, sentences(found), folder, texts)
    if found.interrupted:
        complain(file, Message("interrupted; kept up to t = [[time]]", time=f"{found.times[-1]:.9g}"))
        return INTERRUPTED
    if found.fates:
        told = "members that ended early: [[ended]] of [[count]]"
        complain(file, Message(told, ended=len(found.fates), count=found.count))
        return BROKEN_DOWN
    return OK


def _beside(
    file: Path, read: Callable[[tuple[str, ...]], Scenario | None], varied: Varied, wanted: Asked, kinds: Sequence[str]
) -> dict[str, bytes]:
    """Curves of a few members in one picture, each from a run of its own; ``read`` makes a scenario with more settings.

    Nothing where one has no such scenario: the ensemble has said so.
    """
    from mbsym.report.figures.figures import Curve, curves
    from mbsym.simulation import simulate
    from mbsym_cli.simulate.files import rates_along

    drawn = []
    for member in varied.few:
        name = ", ".join(f"{one} = {value:.12g}" for one, value in member)
        given = read(tuple(f"{one}={value}" for one, value in member))
        if given is None:
            return {}
        with progress(wanted.quiet, f"{file.name}: {name}", wanted.request.time) as watch:
            run = simulate(given, replace(wanted.request, estimate=False), watch)
        drawn.append(Curve(run.trajectory, rates_along(run), name))
    return curves(drawn, kinds) if drawn and all(len(one.found.times) > 1 for one in drawn) else {}


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
    from mbsym.simulation.motions import Sensitivities, sensitivities

    def work() -> Sensitivities:
        with status(wanted.quiet, f"{file.name}: how it answers to changes"):
            found = sensitivities(given, wanted.request, names, overrides)
            deliver(folder, {"sensitivity.csv": sensitivity_csv(found)}, "sensitivity")
        return found

    found = attempted(file, work)
    if found is None:
        return FAILED
    if not wanted.quiet:
        show_result(file, given.system, sentences(found), folder, ["sensitivity.csv"], Message("derivatives"))
    if found.ended is not None:
        complain(file, Message("the derivatives end early: [[why]]", why=found.ended.told))
        return BROKEN_DOWN
    return OK
