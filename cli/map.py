"""``mbsym map``: where a motion is stable, exactly, in a plane of two parameters."""

from __future__ import annotations

from pathlib import Path

import click

from mbsym_cli.console import OutPath
from mbsym_cli.files import folder_for
from mbsym_cli.map_command import FORMATS, map_command
from mbsym_cli.study import leave


@click.command("map")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--x", "across", metavar="NAME=LOW:HIGH", help="The parameter or symbol to the right, and its interval.")
@click.option("--y", "up", metavar="NAME=LOW:HIGH", help="The one upwards; without it: a line.")
@click.option("--z", "deep", metavar="NAME=LOW:HIGH", help="A third one: slices, so that no picture is missed.")
@click.option("--set", "-s", "settings", multiple=True, metavar="NAME=VALUE", help="Another's number; repeatable.")
@click.option(
    "--of",
    "of",
    default="stability",
    show_default=True,
    metavar="WHAT",
    help="stability, signature: of K, or equilibria.",
)
@click.option("--by", "route", default="regions", show_default=True, metavar="HOW", help="regions (exact), or boxes.")
@click.option("--locate", type=click.Path(path_type=Path), metavar="CSV", help="Points: where each lies, the verdict.")
@click.option(
    "--format", "formats", default=",".join(FORMATS), show_default=True, metavar="LIST", help="Files to write."
)
@click.option("--language", default="en", metavar="NAME", help="Of picture and map.tex: en, ru, es.")
@click.option("--out", "-o", type=OutPath(path_type=Path, file_okay=False), help="Folder.  [default: reports/NAME]")
@click.option("--quiet", "-q", is_flag=True, help="Print nothing but complaints.")
def command(
    file: Path,
    across: str | None,
    up: str | None,
    deep: str | None,
    settings: tuple[str, ...],
    of: str,
    route: str,
    locate: Path | None,
    formats: str,
    language: str,
    out: Path | None,
    quiet: bool,
) -> None:
    """Divide a plane of two parameters of FILE, or a line of one, into regions of one verdict of problem 6, exactly.

    The boundaries are the polynomials on which the verdict depends (constant terms, Hurwitz minors, discriminants,
    det K, assumptions, triangle inequalities of inertias).  Their arrangement is exact: every region is judged at a
    rational point, every arc and corner at an algebraic one, by the first approximation and the energy.  With --x
    alone a line is divided into intervals; with --z the plane is shown at the critical values of a third parameter
    and between them, on pages map.pdf, map-2.pdf, ....  Numbers are taken exactly, from the description (values:)
    or --set; axes and settings are parameters, or symbols of the notation.  Where the arrangement of a plane is too
    large, and with --by boxes, boxes are halved until one verdict is proved on each, or they are small: white,
    nothing is proved of them.

    With --of equilibria every region of the plane says how many relative equilibria there are, and how many of them
    are stable; written are equilibria-map.svg, .pdf, .png, .json and .tex.

    Where stability is lost by a pair of imaginary roots terms of third order say whether the border is soft or hard
    (problem 11): at the arc's exact point and, where formulas are small enough, along the whole arc, with points where
    it changes; of slices, too.  Boxes have no borders, and nothing is said of any.

    Written are map.svg, map.pdf, map.png, map.json (every region, arc and corner), map.tex (to \\input) and, with
    --locate, located.csv.  Exit codes: 0 done, 1 there is nothing to judge or files could not be written, 2 something
    is missing or wrong, 130 interrupted (what was proved is written).

    \b
    Examples:
      mbsym map systems/satellite.yaml --x alpha=-1:1 --y gamma=0:1 --set p1=2/5 --set p2=1/5
      mbsym map systems/ziegler-damped.yaml --x P=0:4 --y b1=0:1 --locate points.csv
      mbsym map systems/triangular-points.yaml --x mu=0:1/2
      mbsym map systems/gravity-gradient.yaml --x A=0:2 --y B=0:2 --z C=1/2:3/2
      mbsym map systems/ziegler-damped.yaml --x P=0:4 --y b1=0:1 --by boxes
      mbsym map systems/orbital-gyrostat.yaml --x h=-9:9 --y A=2:8 --of equilibria
    """
    leave(
        file,
        lambda: map_command(
            file, folder_for(file, out), (across, up, deep), settings, of, route, locate, formats, language, quiet
        ),
    )
