"""A study as a command: options, complaints, what is shown meanwhile, files, lines, exit codes, Ctrl-C.

``attempted``, ``leave`` and ``prevented`` are the same for commands that are written out.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import click

from mbsym.studies.request import fields_of
from mbsym.studies.study import Answer, Asked, Study
from mbsym_cli.console import (
    BAD_INPUT,
    FAILED,
    INTERRUPTED,
    OK,
    OutPath,
    complain,
    printable,
    read_description,
    reason_of,
    tell,
)
from mbsym_cli.files import deliver, folder_for, obstacle
from mbsym_cli.options import Options
from mbsym_cli.progress import watching
from mbsym_cli.requests import option_of, read_fields

if TYPE_CHECKING:
    from mbsym.model.system import System

Found = TypeVar("Found")


def command_of(study: Study[Any, Any]) -> click.Command:
    """The command; its help is what the request says of itself."""

    def called(file: Path, **texts: Any) -> None:
        leave(file, lambda: _run(study, file, texts))

    options = [option_of(field) for field in fields_of(study.request)]
    options += [_out(), _quiet()]
    return click.Command(
        study.name,
        params=[click.Argument(["file"], type=click.Path(path_type=Path)), *options],
        callback=called,
        help=inspect.getdoc(study.request),
    )


def _out() -> click.Option:
    told = "Folder.  [default: reports/NAME]"
    return click.Option(["--out", "-o"], type=OutPath(path_type=Path, file_okay=False), help=told)


def _quiet() -> click.Option:
    return click.Option(["--quiet", "-q"], is_flag=True, help="Print only what went wrong.")


def _run(study: Study[Any, Any], file: Path, texts: Mapping[str, Any]) -> int:
    """Reads everything, complains about everything, then derives, writes and tells; the exit code."""
    folder, quiet = folder_for(file, texts["out"]), texts["quiet"]
    system = _described(study, file)
    options = Options()
    values, given = read_fields(file, system, study.request, texts, options)
    request = study.request(**values)
    for one in study.unfit(request, system) if system is not None else ():
        options.complain(one.option, one.code, one.message, one.hint)
    code = prevented(file, folder, system is not None, options)
    if code or system is None:
        return code or BAD_INPUT
    asked = Asked(system, given)
    answer = _answered(study, file, asked, request, folder, quiet)
    if isinstance(answer, int):
        return answer
    if not quiet:
        tell((system.name, "bold"), (f"  {printable(file)}", "dim"))
        for line in answer.lines:
            tell(*line.parts, whole=line.whole)
        tell("  files in ", (printable(folder), "bold"), f": {', '.join(answer.files)}")
    for text in answer.complaints:
        complain(file, text)
    return answer.code


def _described(study: Study[Any, Any], file: Path) -> System | None:
    """The system, None after complaints; inputs are held, which is said, where the study does so."""
    if study.held:
        from mbsym_cli.simulation_inputs import read_held

        return read_held(file, study.name, study.constraints, not study.matrices)
    return read_description(file, "" if study.constraints else study.name, "" if study.matrices else study.name)


def _answered(
    study: Study[Any, Any], file: Path, asked: Asked, request: Any, folder: Path, quiet: bool
) -> Answer | int:
    """What is to be said, after the files were written; the exit code where there is nothing to be said."""
    try:
        with watching(quiet, file.name) as watch:
            found = study.derive(asked, request, watch)
            answer = study.answer(asked, request, found)
            deliver(folder, answer.files, study.name)
            return answer
    except OSError as error:
        complain(file, f"the results cannot be written: {reason_of(error)}")
        return FAILED
    except Exception as error:
        refusal = study.refusal(error)
        if refusal is None:
            raise
        complain(file, refusal.text)
        return refusal.code


def leave(file: Path, command: Callable[[], int]) -> NoReturn:
    """Ends the process with the command's exit code, or with that of Ctrl-C, which leaves nothing written."""
    try:
        sys.exit(command())
    except KeyboardInterrupt:
        complain(file, "interrupted; nothing was written")
        sys.exit(INTERRUPTED)


def prevented(file: Path, folder: Path, read: bool, asked: Options) -> int:
    """The exit code where options are wrong (``read``: the description is not) or nothing can be written; else 0."""
    if asked.refused(file if read else None) or not read:
        return BAD_INPUT
    reason = obstacle(folder)
    if reason:
        complain(file, f"the results cannot be written: {reason}")
        return FAILED
    return OK


def attempted(
    file: Path,
    work: Callable[[], Found],
    expected: Mapping[type[Exception], str] | None = None,
    equations: str = "these equations",
    results: str = "results",
) -> Found | None:
    """What ``work`` finds and writes; None where it fails, and a word about why.

    ``expected`` are failures of its own, with what to say before their message.
    """
    from mbsym.algebra.failures import Failure

    own = dict(expected or {})
    try:
        return work()
    except tuple(own) as error:
        before = next(text for kind, text in own.items() if isinstance(error, kind))
        complain(file, f"{before}: {error}")
    except Failure as error:
        complain(file, f"error[no-program]: there is no program for {equations}: {error}")
    except OSError as error:
        complain(file, f"the {results} cannot be written: {reason_of(error)}")
    return None
