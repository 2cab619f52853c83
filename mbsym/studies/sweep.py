"""``mbsym sweep``: something of a system at very many parameter values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Annotated, Any

from mbsym.expressions.message import Message, joined
from mbsym.studies.request import (
    HOW_LONG,
    ExactSettings,
    Formula,
    Number,
    Quantity,
    Ranges,
    Share,
    Text,
    Varied,
    Whole,
    Word,
    formats,
)  # fmt: skip
from mbsym.studies.study import (
    Answer,
    Asked,
    Exit,
    Folder,
    NotFit,
    Refusal,
    Study,
    Unfit,
    Watch,
    line,
    missing,
    no_program,
)  # fmt: skip

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym.numerics.ensembles.variation import Points
    from mbsym.sweeps.points import Measure
    from mbsym.sweeps.sweep import Asked as Wanted
    from mbsym.sweeps.sweep import Chunk, Executor
    from mbsym.sweeps.sweep import Folder as Store

KINDS = ("csv", "parquet", "svg", "png", "pdf")
#: A picture holds all points: of more there is none.
MOST_DRAWN = 20_000_000
#: Of a motion a formula is measured, behind this word.
MOTION = "simulate:"
#: What is measured by name.
MEASURES = ("stability", "eigenvalues", "damping", "frequency")
VARY = "alpha=-1:1:1000 (a grid), m=1 +- 5%, m=uniform(1, 2), m=normal(1, 0.05); parameters or symbols; repeatable."
MEASURE = f"{', '.join(MEASURES)}, {MOTION}FORMULA, or a formula in parameters."


def _names(system: System, text: str) -> Sequence[str]:
    """What may vary, and be in a formula."""
    from mbsym.maps.section import usable

    moving = text.startswith(MOTION)
    return (*system.parameter_names, *system.coordinates, *system.velocities) if moving else usable(system)


def _known(system: System, text: str) -> Sequence[str]:
    return (*_names(system, text), *((*system.variables, "t") if text.startswith(MOTION) else ()))


@dataclass(frozen=True)
class Request:
    """Measure something of FILE at very many parameter values.

    What is measured is derived once, in symbols, and evaluated in machine code.  A verdict of stability is that of the
    first approximation and the energy, exactly at the very number in its row: points are told apart by signs whose
    rounding is bounded, every kind is judged exactly once, and what is too near a border is judged by itself, by terms
    of higher order, too ('mbsym run' asks them everywhere).  Eigenvalues are floating-point numbers.

    Finished chunks are kept in a folder 'chunks': the same command goes on where it was interrupted, shards on other
    machines may share the folder.  Random points give probabilities with confidence intervals.  Written are sweep.csv
    (or sweep.parquet), sweep.json, and a picture where one or two names vary on a grid, or points are drawn.

    Exit codes: 0 done, 1 files could not be written, 2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym sweep systems/satellite.yaml --vary alpha=-0.9:0.9:400 --vary gamma=-0.9:0.9:400 -s p1=2/5 -s p2=1/5
      mbsym sweep systems/spring-pendulum.yaml --vary "m=1 +- 5%" --vary "k=+-10%" --points 10000 --measure frequency
    """

    vary: Annotated[tuple[Varied, ...], Ranges("NAME=RANGE", VARY, most=64, exact=True)]
    _: KW_ONLY
    values: Annotated[
        Mapping[str, Fraction], ExactSettings("NAME=VALUE", "Replace a value; repeatable.", "-s", "--set")
    ] = field(default_factory=dict)
    measure: Annotated[Quantity, Formula("WHAT", MEASURE, "-m", words=MEASURES, prefix=MOTION, names=_known)] = (
        Quantity(MEASURES[0])
    )
    points: Annotated[
        int | None, Whole("N", "How many points to draw at random, for example --points 100000.", least=2, most=10**9)
    ] = None
    seed: Annotated[int, Whole("N", "Of what is drawn at random.", least=0, most=2**63 - 1)] = 1
    sampling: Annotated[str, Word("[random|sobol]", "", choices=("random", "sobol"), what="sampling")] = "random"
    time: Annotated[float | None, Number("T", f"How long to simulate, with --measure {MOTION}FORMULA.", "-t")] = None
    format: Annotated[tuple[str, ...], formats("csv, parquet, svg, png, pdf.", KINDS)] = ("csv", "svg", "png")
    jobs: Annotated[int | None, Whole("N", "Threads.", "-j", usual="as many as there are processors", most=1000)] = None
    cluster: Annotated[str | None, Text("ADDRESS", "A Dask scheduler, tcp://host:8786, or 'local'.")] = None
    shard: Annotated[
        tuple[int, int] | None, Share("I/N", "Only every N-th chunk, the I-th first; then once without, to join them.")
    ] = None

    @property
    def wanted(self) -> Wanted:
        from mbsym.numerics.ensembles.variation import Points
        from mbsym.sweeps.sweep import Asked

        points = Points(tuple(varied.variation for varied in self.vary), self.points or 0, self.seed, self.sampling)
        ends = {varied.variation.name: varied.ends for varied in self.vary}
        measure = "" if self.measure.formula is not None else self.measure.text
        return Asked(points, ends, self.values, measure, self.measure.formula, self.time)


def unfit(context: Asked, request: Request) -> Iterator[Unfit]:
    from mbsym.numerics.ensembles.variation import complaints
    from mbsym.sweeps.points import MOST_POINTS

    system = context.system
    moving = request.measure.text.startswith(MOTION)
    if moving and "time" not in context.typed:
        yield Unfit("--time", "missing-option", *HOW_LONG)
    if not moving and "time" in context.typed:
        message = Message("--time goes with --measure [[motion]]FORMULA only", motion=MOTION)
        yield Unfit("--time", "conflicting-options", message, "leave it out")
    if "parquet" in request.format and not _arrow():
        yield Unfit("--format", "missing-package", "parquet needs PyArrow", "pip install 'mbsym[parquet]'")
    variations = [varied.variation for varied in request.vary or ()]
    if request.points is not None or "points" not in context.typed:
        known = _names(system, request.measure.text)
        wrong = complaints(variations, request.points, known, (), "points", MOST_POINTS, 100_000)
        for name, text, hint in wrong:
            code = "bad-variation" if name in known else "unknown-name"
            yield Unfit(f"--vary {name}", code, text, hint or None)
    for name in request.values.keys() & {variation.name for variation in variations}:
        yield Unfit(
            f"--set {name}", "conflicting-options", Message("[[name]] is varied", name=name), "leave one of the two out"
        )


def _arrow() -> bool:
    from importlib.util import find_spec

    return find_spec("pyarrow") is not None


@dataclass(frozen=True)
class Swept:
    """The chunks of ``measure`` that are there, ``done`` of those ``requested`` for; ``cut``: by Ctrl-C."""

    measure: Measure
    points: Points
    store: Store
    every: tuple[Chunk, ...]
    requested: int
    done: int
    cut: bool

    def parts(self) -> Iterator[tuple[Any, Mapping[str, Any]]]:
        """(points, columns) of one chunk after the other."""
        for chunk in self.every:
            columns = self.store.load(chunk)
            if columns is None:
                raise OSError(f"{self.store.path(chunk)} is not there any more")
            yield self.points.part(chunk.start, chunk.stop), columns


def derive(context: Asked, request: Request, watch: Watch) -> Swept:
    """Raises NotFit where there is no section or a number is missing, Failure where nothing can be derived."""
    from mbsym.batch.digests import derivation
    from mbsym.maps.section import Unfit as Wrong
    from mbsym.numerics.scenario import Incomplete
    from mbsym.source.yaml_writer import meaning
    from mbsym.studies.section import unfit_section
    from mbsym.sweeps import sweep
    from mbsym.sweeps.sweep import measure_of

    watch("deriving")
    sweep_request, system = request.wanted, context.system
    try:
        measure = measure_of(system, sweep_request)
    except Incomplete as error:
        raise NotFit([missing(error.lack.names)]) from error
    except Wrong as error:
        raise NotFit(tuple(unfit_section(error.complaints, "--vary"))) from error
    most = getattr(measure, "most", sweep_request.points.count)
    if sweep_request.points.count > most:
        message = Message("points are judged one by one here, at most [[most]]", most=most)
        raise NotFit([Unfit("--points", "too-many", message, "take fewer")])
    every = sweep.chunks(sweep_request.points.count)
    digest = sweep_request.digest(meaning(system), derivation())
    folder = sweep.Folder(context.folder, digest, tuple(column.name for column in measure.columns), context.write)
    mine = every if request.shard is None else sweep.shard(every, *request.shard)
    executor, done, cut = _executor(system, request, sweep_request, measure), 0, False
    try:
        for _ in sweep.measured(mine, executor, folder):
            done += 1
            watch("", done, len(mine))
    except KeyboardInterrupt:
        cut = True
    executor.close()
    return Swept(measure, sweep_request.points, folder, every, len(mine), done, cut)


def _executor(system: System, request: Request, sweep_request: Wanted, measure: Measure) -> Executor:
    """Raises NoCluster."""
    import os

    from mbsym.sweeps.sweep import Threads

    jobs = request.jobs or os.cpu_count() or 1
    if request.cluster is None:
        return Threads(lambda: measure, sweep_request.points, jobs)
    from mbsym.batch.swept import Workers

    return Workers(request.cluster, jobs, system, sweep_request)


def _fixed(system: System, points: Points, request: Request) -> dict[str, Any]:
    """The numbers of what does not vary: of parameters, or what was put in for symbols of the notation.

    Not of what relations give, which may vary with the others.
    """
    from mbsym.model.admissibility import known_values

    described = known_values(system) if {*points.names} <= {*system.parameter_names} else {}
    varied = {*points.names, *(relation.name for relation in system.relations)}
    return {name: value for name, value in {**described, **request.values}.items() if name not in varied}


def answer(context: Asked, request: Request, swept: Swept) -> Answer:
    if swept.cut:
        words = "interrupted; [[done]] of [[all]] chunks are kept: the same command goes on from there"
        message = Message(words, done=swept.done, all=swept.requested)
        return Answer(complaints=(message,), code=Exit.INTERRUPTED)
    if request.shard is not None:
        from mbsym.report.language import Language

        number, of = request.shard
        words = "shard [[number]] of [[all]]: [[count]] chunks are done; without --shard all are put together"
        message = Message(words, number=number, all=of, count=swept.requested)
        return Answer((line(f"  {Language(context.system.language).say(message)}"),))
    from mbsym.report.content import facts
    from mbsym.report.runs.sweep_files import sentences, sweep_csv, sweep_json, sweep_parquet
    from mbsym.sweeps.statistics import total

    points, fields = swept.points, swept.measure.columns
    admissibility = getattr(swept.measure, "admissibility", None)  # what could not be looked at, of a section
    left_out = () if admissibility is None else tuple(admissibility.left_out)
    totals = total(fields, points.names, swept.parts())
    files: dict[str, Any] = {}
    if "csv" in request.format:
        files["sweep.csv"] = sweep_csv(points.names, fields, swept.parts())
    if "parquet" in request.format:
        files["sweep.parquet"] = sweep_parquet(points.names, fields, swept.parts())
    kinds = [kind for kind in request.format if kind in ("svg", "png", "pdf")]
    if kinds and points.count <= MOST_DRAWN:
        import numpy as np

        from mbsym.report.figures.sweep_figure import sweep_figure

        values = np.concatenate([part[fields[0].name] for _, part in swept.parts()])
        files |= sweep_figure(context.system, points, fields[0], values, kinds, _fixed(context.system, points, request))
    table = next((name for name in files if name.startswith("sweep.")), "")
    settings = {name: str(value) for name, value in request.values.items()}
    files["sweep.json"] = sweep_json(
        context.system, points, settings, request.wanted.name, fields, totals, table, left_out
    )
    return Answer([facts(sentences(points, fields, totals, left_out))], files)


def refusal(error: Exception, context: Asked, request: Request) -> Refusal | None:
    if request.cluster is not None:
        from mbsym.batch.cluster import NoCluster

        if isinstance(error, NoCluster):
            return Refusal(joined(("--cluster", error.reason), ": "), Exit.BAD_INPUT)
    return no_program(error, context, request)


STUDY = Study(
    "sweep", Request, derive, answer, refusal, unfit,
    constraints=True, matrices=True, out=Folder("Print nothing but complaints.", json=True),
    bodies=lambda texts: str(texts["measure"]).strip().startswith(MOTION),
)  # fmt: skip
