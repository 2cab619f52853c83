"""``mbsym sweep``: something of a system at very many parameter values."""

from __future__ import annotations

import os
from pathlib import Path

import click

from mbsym_cli.console import OutPath
from mbsym_cli.files import folder_for
from mbsym_cli.study import leave


@click.command("sweep")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--vary",
    "-v",
    multiple=True,
    metavar="NAME=RANGE",
    help="alpha=-1:1:1000 (a grid), m=1 +- 5%, m=uniform(1, 2), m=normal(1, 0.05); parameters or symbols; repeatable.",
)
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Replace a value; repeatable.")
@click.option(
    "--measure",
    "-m",
    default="stability",
    show_default=True,
    metavar="WHAT",
    help="stability, eigenvalues, damping, frequency, simulate:FORMULA, or a formula in parameters.",
)
@click.option("--points", metavar="N", help="How many points to draw at random, for example --points 100000.")
@click.option("--seed", metavar="N", default="1", show_default=True, help="Of what is drawn at random.")
@click.option("--sampling", metavar="[random|sobol]", default="random", show_default=True)
@click.option("--time", metavar="T", help="How long to simulate, with --measure simulate:FORMULA.")
@click.option("--format", "formats", default="csv,svg,png", show_default=True, help="csv, parquet, svg, png, pdf.")
@click.option("--jobs", "-j", metavar="N", help="Threads.  [default: as many as there are processors]")
@click.option("--cluster", metavar="ADDRESS", help="A Dask scheduler, tcp://host:8786, or 'local'.")
@click.option("--shard", metavar="I/N", help="Only every N-th chunk, the I-th first; then once without, to join them.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print nothing but complaints.")
def command(file: Path, out: Path | None, **options: object) -> None:
    """Measure something of FILE at very many parameter values.

    What is measured is derived once, in symbols, and evaluated in machine code.  A verdict of stability is that of the
    exact judge at the very number in its row: points are told apart by signs whose rounding is bounded, every kind is
    judged exactly once, and what is too near a border is judged by itself.  Eigenvalues are floating-point numbers.

    Finished chunks are kept in a folder 'chunks': the same command goes on where it was interrupted, shards on other
    machines may share the folder.  Random points give probabilities with confidence intervals.  Written are sweep.csv
    (or sweep.parquet), sweep.json, and a picture where one or two names vary on a grid, or points are drawn.

    Exit codes: 0 done, 1 files could not be written, 2 something is missing or wrong, 130 interrupted.

    \b
    Examples:
      mbsym sweep systems/satellite.yaml -v alpha=-0.9:0.9:400 -v gamma=-0.9:0.9:400 -s p1=2/5 -s p2=1/5
      mbsym sweep systems/spring-pendulum.yaml -v "m=1 +- 5%" -v "k=+-10%" --points 10000 --measure frequency
    """
    from mbsym_cli.sweep.run import swept

    leave(file, lambda: swept(file, folder_for(file, out), options, os.cpu_count() or 1))
