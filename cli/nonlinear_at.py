"""``mbsym nonlinear`` without a parameter to vary: what terms of higher order decide at the values."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from mbsym.expressions.tree import number
from mbsym_cli.console import BAD_INPUT, FAILED, INTERRUPTED, OK, complain, console, printable, status

if TYPE_CHECKING:
    from mbsym.model.system import System
    from mbsym_cli.options import Options


def check_settings(system: System, numbers: Mapping[str, Fraction], asked: Options) -> None:
    """Numbers are of parameters that follow from nothing else, and have their declared signs."""
    from mbsym.model.comparison import has_sign

    signs = {one.name: one.sign for one in system.parameters}
    related = {one.name for one in system.relations}
    for name, value in numbers.items():
        if name not in signs:
            asked.complain("--set", "unknown-name", f"{name} is a symbol of the notation", "set the parameters in it")
        elif name in related:
            asked.complain("--set", "wrong-use", f"{name} follows from a relation", "set the parameters in it")
        elif not has_sign(value, signs[name]):
            asked.complain("--set", "sign-contradiction", f"{name} is declared {signs[name]}, {value} is not")


def at_values(file: Path, system: System, numbers: Mapping[str, Fraction], as_json: bool) -> int:
    """Prints what problem 11 says, at numbers where there are all, in parameters where it can; the exit code.

    ``as_json``: as ``results.json`` of that problem.
    """
    from mbsym.algebra.failures import Failure
    from mbsym.analysis import Analysis
    from mbsym.analysis.stages import Unavailable
    from mbsym.mechanics.rest import given_values, missing_values, rational_values
    from mbsym.report.sections.normal_forms import lines
    from mbsym_cli.lacking import missing

    parameters = (
        replace(one, value=number(numbers[one.name])) if one.name in numbers else one for one in system.parameters
    )
    analysis = Analysis(replace(system, parameters=tuple(parameters)))
    started = time.perf_counter()
    try:
        with status(False, f"{file.name}: normal forms"), analysis.strictly():
            found = analysis.normal_forms
            solved = {name for name, _ in analysis.equilibrium.solved}
    except Failure as reason:
        told = reason.reason if isinstance(reason, Unavailable) else str(reason)
        complain(file, f"nothing decided: {told}" + (f"; {reason.remedy}" if reason.remedy else ""))
        return FAILED
    except KeyboardInterrupt:
        complain(file, "interrupted")
        return INTERRUPTED
    known = rational_values(given_values(system, numbers))
    lacking = [name for name in missing_values(system, known) if name not in solved]
    if found.at_values is None and lacking and found.in_symbols is None:
        print(missing(file, lacking, "rational number"), file=sys.stderr)
        return BAD_INPUT
    if as_json:
        from mbsym.report.results_json import render

        print(render(analysis, (11,)), end="")
        return OK
    _show(system.name, file, list(lines(found, analysis)), time.perf_counter() - started)
    out = console()
    if found.at_values is None and lacking:
        words = " ".join(f"--set {name}=NUMBER" for name in lacking)
        out.print(f"  At numbers nothing is said: {', '.join(lacking)} have none.  Give them:", markup=False)
        out.print(f"    mbsym nonlinear {printable(file)} {words}", markup=False, soft_wrap=True)
    return OK


def _show(name: str, file: Path, lines: list[str], seconds: float) -> None:
    from rich.text import Text

    out = console()
    out.print(Text.assemble((name, "bold"), (f"  {printable(file)}, {seconds:.2f} s", "dim")))
    for line in lines:
        out.print(Text(f"  {line}"))
