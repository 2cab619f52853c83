"""A study as a command: options, complaints, what is shown meanwhile, files, lines, exit codes, Ctrl-C."""

from __future__ import annotations

import inspect
import sys
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import click
from click.core import ParameterSource

from mbsym.expressions.message import Message
from mbsym.expressions.place import Complaint
from mbsym.expressions.safe import UNBROKEN
from mbsym.model.system import LANGUAGES, System
from mbsym.report.content import Block
from mbsym.report.language import Language
from mbsym.report.letters import in_letters, with_meanings
from mbsym.report.plain_writer import Line as Written
from mbsym.report.plain_writer import Writer
from mbsym.studies.request import Tongue, fields_of, options_typed
from mbsym.studies.study import (
    Answer,
    Asked,
    Document,
    Exit,
    Folder,
    Line,
    NotFit,
    Remember,
    Screen,
    Single,
    Study,
    Unfit,
    unremembered,
)
from mbsym_cli.beside import Beside, beside
from mbsym_cli.console import (
    HANGING,
    OutPath,
    asked_width,
    between_terms,
    complain,
    defect,
    described,
    diagnose,
    printable,
    read_description,
    read_held,
    reason_of,
    tell,
    watching,
)
from mbsym_cli.console import show as show_lines
from mbsym_cli.files import deliver, folder_for, folders_for, prevented, room_beside, unchanged, write_whole
from mbsym_cli.letters import letters_option, read_letters
from mbsym_cli.options import Options
from mbsym_cli.requests import option_of, read_fields

Found = TypeVar("Found")


class StudyCommand(click.Command):
    """``rare``: parameters whose options a long ``--help`` leaves to ``mbsym explain``."""

    rare: Collection[str] = ()


def command_of(study: Study[Any, Any]) -> StudyCommand:
    """The command; its help is what the request says of itself."""

    def called(file: Path | tuple[Path, ...], **texts: Any) -> None:
        context = click.get_current_context()
        typed = {name for name in texts if context.get_parameter_source(name) is ParameterSource.COMMANDLINE}
        if not isinstance(file, tuple):
            run = _Run(study, file, texts, typed)
            leave(file, run.code, lambda: run.delivered)
        options = Options()
        files = options.descriptions(file)
        if options.refused():
            sys.exit(Exit.BAD_INPUT)
        among = [printable(path.name) for path in files] if len(files) > 1 else []
        folders = folders_for(files, texts.get("out"))
        runs = [_Run(study, path, texts, typed, among, at) for path, at in zip(files, folders, strict=True)]
        leave(file[0], lambda: _several(study, runs), lambda: any(run.delivered for run in runs))

    count = -1 if study.several else 1
    command = StudyCommand(
        study.name,
        params=[
            click.Argument(["file"], type=click.Path(path_type=Path), nargs=count, required=True),
            *(option_of(field) for field in fields_of(study.request)),
            *_further(study),
        ],
        callback=called,
        help=inspect.getdoc(study.request),
    )
    command.rare = study.rare
    return command


def _further(study: Study[Any, Any]) -> Iterator[click.Option]:
    """``--json``, ``--out`` and ``--quiet``, where there is something to them."""
    if study.letters:
        yield letters_option()
    if study.json is not None or (isinstance(study.out, Folder) and study.out.json):
        yield click.Option(["--json", "as_json"], is_flag=True, help=study.json_help)
    match study.out:
        case Folder() as out:
            yield click.Option(["--out", "-o"], type=OutPath(path_type=Path, file_okay=False), help=out.help)
            if out.quiet is not None:
                yield click.Option(["--quiet", "-q"], is_flag=True, help=out.quiet)
        case Single() as out:
            yield click.Option(["--out", "-o"], type=OutPath(path_type=Path, dir_okay=False), help=out.help)
            yield click.Option(["--quiet", "-q"], is_flag=True, help="Print nothing but complaints.")


def _several(study: Study[Any, Any], runs: Sequence[_Run]) -> int:
    """Several descriptions: each with its own files and complaints, and one table of all; the worst exit code.

    What is wrong with the options of any description is told once.
    """
    if len(runs) > 1 and not runs[0].reads_options():
        for run in runs:
            run.described()
        runs[0].options.refused()
        return Exit.BAD_INPUT
    codes = [run.contained() for run in runs]
    known = [run.told for run in runs if run.told is not None]
    if known and study.together is not None:
        show(study.together(known), known[0][0].language)
    worst_last: list[int] = [Exit.OK, Exit.FAILED, Exit.BROKEN_DOWN, Exit.BAD_INPUT, Exit.INTERRUPTED]
    return max(codes, key=worst_last.index)


class _Run:
    """One command at work: everything is read and complained about, then derived, written and told."""

    def __init__(
        self,
        study: Study[Any, Any],
        file: Path,
        texts: Mapping[str, Any],
        typed: Collection[str],
        among: Sequence[str] = (),
        folder: Path | None = None,
    ) -> None:
        """``among``: the names of several, of which it is one, and has a ``folder`` of its own in that of all."""
        self.study, self.file, self.texts, self.among = study, file, texts, among
        self.typed = {name: text for name, text in texts.items() if name in typed}
        self.delivered = False
        self.out: Path | None = texts.get("out")
        self.inside = self.out if among else None
        self.folder = folder or folder_for(file, self.out)
        if among and self.out is not None:
            self.out = self.folder
        self.told: tuple[Asked, Any, Any] | None = None
        self.quiet = bool(texts.get("quiet"))
        self.as_json = bool(texts.get("as_json"))
        self.options = Options()
        self.letters: tuple[str, ...] | None = None
        self.used: set[str] = set()
        self.writes = False
        self.started = time.perf_counter()
        self.say = Language().say

    def reads_options(self) -> bool:
        """Whether nothing is wrong with them whatever the description is."""
        values, _, _ = read_fields(self.file, None, self.study.request, self.texts, self.options)
        self._complain(self.study.request(**values), None)
        return not self.options.complaints

    def contained(self) -> int:
        """The exit code; a mistake of ours does not cost what comes after this description."""
        try:
            return self.code()
        except Exception as error:
            defect(error, self.file)
            return Exit.FAILED

    def code(self) -> int:
        study, file, self.started = self.study, self.file, time.perf_counter()
        said = (self.texts[x.name] or "" for x in fields_of(study.request) if isinstance(x.kind, Tongue))
        spoken = next((text.lower() for text in said if text.lower() in LANGUAGES), "")
        system = self.described()
        self.say = self.options.say = Language(spoken or ("" if system is None else system.language)).say
        values, scenario, system = read_fields(file, system, study.request, self.texts, self.options)
        if study.letters and system is not None:
            self.letters = read_letters(self.texts.get("letters"), system, self.options)
        request, folder = study.request(**values), self.folder
        self.writes = isinstance(study.out, Folder) and study.writes(self.typed)
        with ExitStack() as stack:
            context = None
            if system is not None:
                store = partial(stack.enter_context, room_beside(folder))
                screen = Screen(asked_width(), self.quiet or self.as_json, self.among, self._seconds)
                known = (self.typed, store, _memory(), self.letters, spoken, beside, partial(unchanged, folder), screen)
                context = Asked(system, scenario, printable(file), folder, write_whole, *known)
            self._complain(request, context)
            has_folder = self.writes or (isinstance(study.out, Single) and study.out.usual and self.out is None)
            place = folder if has_folder else None
            code = prevented(file, place, system is not None, self.options, self.inside)
            if code or context is None:
                return code or Exit.BAD_INPUT
            return self._answered(context, request)

    @contextmanager
    def _in_letters(self, system: System) -> Iterator[set[str]]:
        """Formulas are written in the author's letters, where the study does so; which ones were used is known then."""
        with in_letters(system, self.letters if self.study.letters else ()) as used:
            yield used
        self.used |= used

    def _seconds(self) -> float:
        return time.perf_counter() - self.started

    def described(self) -> System | None:
        """The system, None after complaints; inputs are held, which is said, where the study does so."""
        study, bodies = self.study, self.study.bodies(self.texts)
        matrices = study.matrices and not bodies
        if study.held:
            return read_held(self.file, study.name, study.constraints, not matrices, study.instead)
        refused = ["" if knows else study.name for knows in (study.constraints, matrices)]
        return read_description(self.file, *refused, study.instead, free=study.free)

    def _complain(self, request: Any, context: Asked | None) -> None:
        """About what does not go together."""
        there = options_typed(self.study.request, self.typed)
        for reason in (unfit for pair in self.study.pairs for unfit in pair.unfit(there)):
            self._unfit(reason)
        for reason in self.study.unfit(context, request) if context is not None else ():
            self._unfit(reason)
        if isinstance(self.study.out, Single):
            self.options.unwritten("--out", self.out)
        elif isinstance(self.study.out, Folder):
            options = {"--out": self.out is not None, "--quiet": self.quiet}
            for option in (name for name, present in options.items() if present and not self.writes):
                if self.study.out.unwritten is not None:
                    self.options.complain(option, *self.study.out.unwritten)
            if self.writes and self.as_json and self.study.out.alone is not None:
                self.options.complain("--json", *self.study.out.alone)
        order = [field.option for field in fields_of(self.study.request)]
        self.options.sort(order)

    def _unfit(self, reason: Unfit) -> None:
        if reason.name:
            self.options.complain_whole(reason.option, self._text(reason), reason.code, reason.message, reason.hint)
        else:
            complaint = Complaint(reason.code, reason.message, reason.span, reason.hint)
            self.options.add(reason.option or str(self.file), reason.text, complaint)

    def _text(self, reason: Unfit) -> str:
        """What was typed for that name."""
        field = next(field for field in fields_of(self.study.request) if field.option == reason.option)
        name, *typed = (" ".join(text.splitlines()) for text in (reason.name, *self.texts[field.name]))
        return next(text for text in typed if name in (text, text.partition("=")[0].strip()))

    def _answered(self, context: Asked, request: Any) -> int:
        """Derives, writes the files of a folder, then tells."""
        study, file = self.study, self.file
        try:
            with watching(self.quiet or self.as_json, file.name) as watch:
                derived = study.derive(context, request, watch)
                with self._in_letters(context.system):
                    answer = study.answer(context, request, derived)
                    answer = replace(answer, lines=list(answer.lines))
                if answer.files:
                    self.delivered = True  # Ctrl-C may come when it is complete, and has not returned
                    deliver(context.folder, answer.files, answer.owner or study.name, answer.gone)
                if answer.stopped is not None:
                    raise answer.stopped
        except OSError as error:
            complain(file, Message("the results cannot be written: [[why]]", why=reason_of(error)))
            return Exit.FAILED
        except NotFit as error:
            for reason in error.reasons:
                self._unfit(reason)
            self.options.refused(file)
            return Exit.BAD_INPUT
        except Exception as error:
            refusal = study.refusal(error, context, request)
            if refusal is None:
                raise
            self._complaints((refusal.text, *refusal.more))
            return refusal.code
        if self.as_json:
            click.echo(
                _json(context, answer) if study.json is None else study.json(context, request, derived), nl=False
            )
        elif self.among and study.together is not None:
            self.told = context, request, derived
        else:
            with self._in_letters(context.system) as used:
                self._tell(context, answer, used)
        self._complaints(answer.complaints)
        for defective in {described(x): x for x in answer.defects}.values():
            defect(defective, file)
        usual = study.out.usual if isinstance(study.out, Single) else ""
        place = self.out or (folder_for(file, None) / usual if usual else None)
        if answer.code or place is None or study.document is None:
            return answer.code
        return self._written(place, study.document(context, request, derived))

    def _tell(self, context: Asked, answer: Answer, used: set[str]) -> None:
        if answer.text is not None:
            if answer.breaks and sys.stdout.isatty():
                for line in answer.text.splitlines():
                    tell(line if line.startswith("#") else between_terms(line), margin=HANGING)
            else:
                click.echo(answer.text, nl=False)
            return
        loud = not self.quiet
        if loud and not answer.bare:
            seconds = f",{UNBROKEN}{self._seconds():.2f}{UNBROKEN}s" if self.study.timed else ""
            tell((context.system.name, "bold"), (f"  {printable(self.file)}{answer.after}{seconds}", "dim"))
        for block in answer.lines if loud or not answer.brief else answer.brief:
            if isinstance(block, Line) and (loud or block.always):
                parts = (self.say(x) if isinstance(x, str) else (self.say(x[0]), x[1]) for x in block.parts)
                tell(*parts, whole=block.whole)
            elif isinstance(block, Written):
                show_lines([block])
            elif not isinstance(block, Line) and (loud or answer.brief):
                show([block], context.language)
        if loud and not answer.bare:
            show(with_meanings((), context.system, self.used | used), context.language)
        if answer.files and answer.listed and loud and not answer.bare:
            show_files(context.folder, answer.files, context.language, answer.more)
        for closing in answer.last if loud else ():
            tell(*closing.parts, whole=closing.whole)

    def _complaints(self, texts: Iterable[str]) -> None:
        """On standard error; what goes on, indented, without the name of the file."""
        for text in texts:
            if text.startswith("  "):
                diagnose(self.say(text))
            else:
                complain(self.file, text, self.say)

    def _written(self, out: Path, document: Document) -> int:
        """The exit code of a single file."""
        self._complaints(document.complaints)
        if document.text is None:
            return Exit.FAILED
        try:
            if self.out is None:
                deliver(out.parent, {out.name: document.text}, self.study.name)
            else:
                write_whole(out, document.text)
        except OSError as error:
            complain(out, Message("cannot be written: [[why]]", why=error.strerror or error), self.say)
            return Exit.FAILED
        if document.told and not self.quiet:
            click.echo(f"{printable(out)}: {self.say(document.told)}")
        return Exit.OK


def _memory() -> Remember:
    """What was measured before counts for a command in a process of its own."""
    if not Beside.allowed:
        return unremembered

    def recalled(
        question: Sequence[str], measure: Callable[[], Any], sound: Callable[[Any], bool], anew: bool
    ) -> tuple[Any, bool]:
        from mbsym_cli.remembered import remembered  # few studies have anything to remember

        return remembered(question, measure, sound, anew)

    return recalled


def _json(context: Asked, answer: Answer) -> str:
    """What the file says that is JSON, which has been written; nothing where what ended early has none."""
    name = next((name for name in answer.files if name.endswith(".json")), None)
    return "" if name is None else (context.folder / name).read_text(encoding="utf-8")


def leave(file: Path, command: Callable[[], int], written: Callable[[], bool] = lambda: False) -> NoReturn:
    """Ends the process with the command's exit code, or with that of Ctrl-C, when nothing may be ``written`` yet."""
    try:
        sys.exit(command())
    except KeyboardInterrupt:
        whole = written()
        complain(file, "interrupted; what has been written is whole" if whole else "interrupted; nothing was written")
        sys.exit(Exit.INTERRUPTED)


# What a command has found, in the language of the description, and where the files are.


#: Columns of tables in a file or pipe of which nothing is said.
WIDTH = 120


def show(blocks: Iterable[Block], language: str) -> None:
    """Prints them beneath the name of a system."""
    writer = Writer(Language(language), True, width=(asked_width() or WIDTH) - 2)
    show_lines(writer.document(blocks))


def show_files(folder: Path, names: Iterable[str], language: str, more: str = "") -> None:
    say = Language(language).say
    listed = f": {', '.join(names)}" + (f" ({say(more)})" if more else "")
    tell(f"  {say(Message('files in'))} ", (printable(folder), "bold"), listed)
