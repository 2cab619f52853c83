"""What ``mbsym map`` does with its options: reads everything, complains about everything, then draws."""

from __future__ import annotations

from pathlib import Path

from mbsym_cli.console import BAD_INPUT
from mbsym_cli.options import Options
from mbsym_cli.section_options import distinct, read_axis, read_settings
from mbsym_cli.simulation_inputs import read_held
from mbsym_cli.study import prevented

KINDS = ("stability", "signature", "equilibria")
ROUTES = ("regions", "boxes")
FORMATS = ("svg", "pdf", "png", "json", "tex")


def map_command(
    file: Path,
    folder: Path,
    texts: tuple[str | None, str | None, str | None],
    settings: tuple[str, ...],
    of: str,
    route: str,
    locate: Path | None,
    formats: str,
    language: str,
    quiet: bool,
) -> int:
    """The exit code."""
    from mbsym.report.language import LANGUAGES
    from mbsym_cli.equilibria_map_run import fitting, of_equilibria
    from mbsym_cli.map_run import Request, read_located, run

    system = read_held(file, "map", constrained=True, moving=False)
    asked = Options()
    what, how = asked.word("--of", of, KINDS, "map"), asked.word("--by", route, ROUTES, "route")
    wanted = asked.words("--format", formats, FORMATS, "format")
    asked.word("--language", language, LANGUAGES, "language")
    if system is None:
        asked.refused()
        return BAD_INPUT
    if texts[2] is not None and texts[1] is None:
        asked.complain("--z", "missing-option", "slices of a line are no pictures", "give the second parameter as --y")
    of_one = what != "equilibria"
    if how == "boxes" and of_one and (texts[1] is None or texts[2] is not None):
        asked.complain("--by", "missing-option", "boxes are of planes", "give two parameters, as --x and --y")
    further = [(name, text) for name, text in (("--y", texts[1]), ("--z", texts[2])) if text is not None]
    axes = [read_axis(text, name, system, asked) for name, text in (("--x", texts[0]), *further)]
    found = [axis for axis in axes if axis is not None]
    values = read_settings(settings, system, asked)
    distinct(found, values, asked)
    whole = len(found) == len(axes)
    points = (
        None if locate is None or not (whole and of_one) else read_located(locate, [axis.name for axis in found], asked)
    )
    numbers = {}
    if what == "equilibria":
        refused = [name for name, given in (("--locate", locate is not None), ("--by boxes", how == "boxes")) if given]
        numbers = fitting(file, system, texts, found, values, refused, asked)
    code = prevented(file, folder, True, asked)
    if code:
        return code
    if what == "equilibria":
        return of_equilibria(file, folder, system, found, numbers, wanted, language, quiet)
    return run(Request(file, folder, system, found, values, str(what), wanted, language, points, quiet, str(how)))
