"""``mbsym sweep`` at work: options read, chunks measured, tables and pictures written."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mbsym.expressions.constants import out_of_range
from mbsym.expressions.parser import ascii_safe, parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.source import render_option
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, read_held, status
from mbsym_cli.files import deliver
from mbsym_cli.options import MAX_LENGTH, Options
from mbsym_cli.section_options import complain_unfit, read_settings
from mbsym_cli.study import attempted, prevented
from mbsym_cli.sweep.request import MOST_JOBS, read_vary

if TYPE_CHECKING:
    from mbsym.expressions.tree import Expression
    from mbsym.model.system import System
    from mbsym.sweeps.measure import Measure
    from mbsym.sweeps.request import Asked
    from mbsym.sweeps.sweep import Chunk, Executor
    from mbsym_cli.sweep.store import Folder

KINDS = ("csv", "parquet", "svg", "png", "pdf")
#: A picture holds all points: of more there is none.
MOST_DRAWN = 20_000_000


@dataclass(frozen=True)
class Wanted:
    """How a sweep is done, besides what it is asked for."""

    formats: tuple[str, ...]
    jobs: int
    cluster: str | None
    shard: tuple[int, int] | None
    quiet: bool


def swept(file: Path, folder: Path, options: Mapping[str, Any], processors: int) -> int:
    """Everything is read and complained about, then measured; the exit code."""
    moving = str(options["measure"]).strip().startswith("simulate:")
    system = read_held(file, "sweep", constrained=not moving, moving=moving)
    complaints = Options()
    wanted = _wanted(options, processors, complaints)
    asked = None if system is None else _asked(options, system, complaints)
    wrong = prevented(file, folder, system is not None, complaints)
    if wrong or system is None or asked is None or wanted is None:
        return wrong or BAD_INPUT
    measure = _measure(file, system, asked, complaints, wanted.quiet)
    if isinstance(measure, int):
        return measure
    done = attempted(file, partial(_measured, file, folder, system, asked, measure, wanted))
    return FAILED if done is None else done


# --- reading ----------------------------------------------------------------------------------------------------------


def _wanted(options: Mapping[str, Any], processors: int, complaints: Options) -> Wanted | None:
    formats = complaints.words("--format", options["formats"], KINDS, "format")
    jobs = processors if options["jobs"] is None else complaints.whole("--jobs", options["jobs"], 1, MOST_JOBS)
    shard = None if options["shard"] is None else _shard(options["shard"], complaints)
    if "parquet" in formats and not _arrow():
        complaints.complain("--format", "missing-package", "parquet needs PyArrow", "pip install 'mbsym[parquet]'")
    if jobs is None or (options["shard"] is not None and shard is None):
        return None
    return Wanted(formats, jobs, options["cluster"], shard, bool(options["quiet"]))


def _shard(text: str, complaints: Options) -> tuple[int, int] | None:
    first, slash, last = (part.strip() for part in text.partition("/"))
    if not slash:
        complaints.complain("--shard", "bad-number", f"{ascii_safe(text[:40])} is no share", "for example --shard 3/16")
        return None
    of = complaints.whole("--shard", last, 1, 10**6)
    number = complaints.whole("--shard", first, 1, of or 10**6)
    return None if of is None or number is None else (number, of)


def _arrow() -> bool:
    from importlib.util import find_spec

    return find_spec("pyarrow") is not None


def _asked(options: Mapping[str, Any], system: System, complaints: Options) -> Asked | None:
    from mbsym.maps.section import usable
    from mbsym.sweeps.request import MEASURES, Asked

    measure, formula, time = str(options["measure"]).strip(), None, None
    moving = measure.startswith("simulate:")
    names = usable(system)
    if moving:
        names = (*system.parameter_names, *system.coordinates, *system.velocities)
        time = complaints.time(options["time"])
    elif options["time"] is not None:
        told = "--time goes with --measure simulate:FORMULA only"
        complaints.complain("--time", "conflicting-options", told, "leave it out")
    if measure not in MEASURES:
        formula = _formula(measure.removeprefix("simulate:"), {*names, "t"} if moving else {*names}, complaints)
        measure = ""
    settings = read_settings(options["settings"], system, complaints)
    vary = read_vary(
        options["vary"], options["points"], options["seed"], options["sampling"], names, system, complaints
    )
    for name in settings.keys() & ({*vary.points.names} if vary else set()):
        complaints.complain(f"--set {name}", "conflicting-options", f"{name} is varied", "leave one of the two out")
    if vary is None or (not measure and formula is None) or (moving and time is None):
        return None
    return Asked(vary.points, vary.ends, settings, measure, formula, time)


def _formula(text: str, names: set[str], complaints: Options) -> Expression | None:
    from mbsym.expressions.tree import CONSTANTS, Name, walk
    from mbsym.source.scope import did_you_mean
    from mbsym.sweeps.request import MEASURES

    text = " ".join(text.splitlines()).strip()
    found = Complaints()
    value = None
    if not text or len(text) > MAX_LENGTH:
        hint = f"{', '.join(MEASURES)}, or a formula"
        complaints.complain("--measure", "bad-formula", "what to measure is not said", hint)
        return None
    value = parse_expression(text, found, lambda start, end: Span(1, start + 1, max(1, end - start)))
    for node in walk(value) if value is not None else ():
        if isinstance(node, Name) and node.name not in {*names, *CONSTANTS} and node.span is not None:
            hint = did_you_mean(node.name, [*names, *MEASURES]) or f"{', '.join(MEASURES)}, or a formula"
            found.error("unknown-name", f"unknown name {ascii_safe(node.name)}", node.span, hint)
    if value is not None and (why := out_of_range(value)):
        found.error("no-number", f"nothing can be computed with this number: {why}", Span(1, 1, max(1, len(text))))
    complaints.complaints += [render_option(one, text, "--measure") for one in found.sorted()]
    return None if found.errors else value


def _measure(file: Path, system: System, asked: Asked, complaints: Options, quiet: bool) -> Measure | int:
    """The measure, or the exit code where there is none."""
    from mbsym.maps.given import Unfit
    from mbsym.numerics.scenario import Incomplete
    from mbsym.sweeps.request import measure_of
    from mbsym_cli.lacking import missing

    try:
        with status(quiet, "deriving"):
            found = attempted(file, partial(_made, measure_of, system, asked))
    except Incomplete as error:
        print(missing(file, error.lack.names), file=sys.stderr)
        return BAD_INPUT
    if isinstance(found, Unfit):
        complain_unfit(found.complaints, "--vary", complaints)
        complaints.refused(file)
        return BAD_INPUT
    return FAILED if found is None else found


def _made(measure_of: Callable[[System, Asked], Measure], system: System, asked: Asked) -> Any:
    from mbsym.maps.given import Unfit

    try:
        return measure_of(system, asked)
    except Unfit as error:
        return error


# --- measuring --------------------------------------------------------------------------------------------------------


def _measured(file: Path, folder: Path, system: System, asked: Asked, measure: Measure, wanted: Wanted) -> int:
    from mbsym.batch.digests import derivation
    from mbsym.source.meaning import meaning
    from mbsym.sweeps.sweep import chunks, measured, shard
    from mbsym_cli.sweep.store import Folder

    every = chunks(asked.points.count)
    digest = asked.digest(meaning(system), derivation())
    store = Folder(folder, digest, tuple(column.name for column in measure.columns))
    mine = every if wanted.shard is None else shard(every, *wanted.shard)
    executor = _executor(file, system, asked, measure, wanted)
    if executor is None:
        return BAD_INPUT
    done = 0
    try:
        with _bar(wanted.quiet, file.name, len(mine)) as advance:
            for _ in measured(mine, executor, store):
                done += 1
                advance(done)
    except KeyboardInterrupt:
        executor.close()
        complain(file, f"interrupted; {done} of {len(mine)} chunks are kept: the same command goes on from there")
        return INTERRUPTED
    executor.close()
    if wanted.shard is not None:
        if not wanted.quiet:
            number, of = wanted.shard
            told = f"shard {number} of {of}: {len(mine)} chunks are done; without --shard all are put together"
            print(f"{file.name}: {told}")
        return OK
    return _written(file, folder, system, asked, measure, wanted, store, every)


def _executor(file: Path, system: System, asked: Asked, measure: Measure, wanted: Wanted) -> Executor | None:
    """None where there is no cluster, after a complaint."""
    from mbsym.sweeps.sweep import Threads

    if wanted.cluster is None:
        return Threads(lambda: measure, asked.points, wanted.jobs)
    from mbsym.batch.cluster import NoCluster
    from mbsym.batch.swept import Workers

    try:
        return Workers(wanted.cluster, wanted.jobs, system, asked)
    except NoCluster as reason:
        complain(file, f"--cluster: {reason}")
        return None


def _written(
    file: Path,
    folder: Path,
    system: System,
    asked: Asked,
    measure: Measure,
    wanted: Wanted,
    store: Folder,
    every: Sequence[Chunk],
) -> int:
    import numpy as np

    from mbsym.report.runs.sweep_files import sweep_csv, sweep_json, sweep_parquet
    from mbsym.report.runs.sweep_words import sentences
    from mbsym.sweeps.statistics import total
    from mbsym_cli.telling import told

    points, columns = asked.points, measure.columns

    def parts() -> Iterator[tuple[Any, Mapping[str, Any]]]:
        for chunk in every:
            found = store.load(chunk)
            if found is None:
                raise OSError(f"{store.path(chunk)} is not there any more")
            yield points.part(chunk.start, chunk.stop), found

    with status(wanted.quiet, "writing"):
        totals = total(columns, points.names, parts())
        files: dict[str, Any] = {}
        if "csv" in wanted.formats:
            files["sweep.csv"] = sweep_csv(points.names, columns, parts())
        if "parquet" in wanted.formats:
            files["sweep.parquet"] = sweep_parquet(points.names, columns, parts())
        kinds = [kind for kind in wanted.formats if kind in ("svg", "png", "pdf")]
        if kinds and points.count <= MOST_DRAWN:
            from mbsym.report.figures.sweep_figure import sweep_figure

            values = np.concatenate([found[columns[0].name] for _, found in parts()])
            files.update(sweep_figure(system, points, columns[0], values, kinds))
        left_out = _left_out(measure)
        table = next((name for name in files if name.startswith("sweep.")), "")
        settings = {name: str(value) for name, value in asked.settings.items()}
        files["sweep.json"] = sweep_json(system, points, settings, asked.name, columns, totals, table, left_out)
        deliver(folder, files, "sweep")
    if not wanted.quiet:
        told(file, system.name, sentences(points, columns, totals, left_out), folder, files)
    return OK


def _left_out(measure: Measure) -> tuple[str, ...]:
    """What parameters have to keep, but could not be looked at."""
    admissibility = getattr(measure, "admissibility", None)
    return () if admissibility is None else tuple(admissibility.left_out)


def _bar(quiet: bool, name: str, end: int) -> Any:
    from mbsym_cli.progress import progress

    return progress(quiet, name, end, "chunks")
