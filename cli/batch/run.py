"""What ``mbsym batch`` does once its options are read: finds, looks what is up to date, derives the rest, sums up."""

from __future__ import annotations

import hashlib
import json
import os
import sys
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any

import mbsym
from mbsym.batch import index_page, junit
from mbsym.batch.coordinator import Batch, Place
from mbsym.batch.digests import derivation
from mbsym.batch.outcome import FORMAT, ComplaintRow, Outcome, Row, Summary, findings
from mbsym.batch.summary_json import FILENAME, summary_text
from mbsym.batch.transport import BatchOptions, Budget
from mbsym.expressions.message import Message, joined
from mbsym.report.language import Language
from mbsym.report.words.findings import github_annotations, json_lines, sarif
from mbsym.studies.study import Exit
from mbsym_cli.batch.folders import Descriptions, chosen, found_in, share
from mbsym_cli.batch.machine import Locks, memory_is_bounded
from mbsym_cli.batch.store import COMMAND, FolderStore
from mbsym_cli.batch.table import complaints, totals, watcher
from mbsym_cli.console import language_of_files, printable
from mbsym_cli.files import MANIFEST, deliver, delivered, obstacle, read_manifest
from mbsym_cli.options import DESCRIPTIONS_HAVE, nothing_here

if TYPE_CHECKING:
    from mbsym.batch.coordinator import Executor

#: The appendices of a folder's systems as one file.
APPENDIX = "appendix.tex"

#: Whose files those about a whole batch are, in the manifest of its folder.
SUMMARY = "batch summary"


@dataclass(frozen=True)
class Request:
    """A batch as it was asked for."""

    folders: tuple[Path, ...]
    out: Path
    options: BatchOptions
    budget: Budget
    jobs: int
    patterns: tuple[str, ...] = ()
    shard: tuple[int, int] | None = None
    fail_fast: bool = False
    strict_claims: bool = False
    changed: bool = False
    quiet: bool = False
    output_format: str = "text"
    cluster: str | None = None
    appendix: bool = False


def run(request: Request) -> int:
    """The whole batch; its exit code."""
    started, say = time.monotonic(), Language().say
    reason = obstacle(request.out)
    if reason:
        print(say(Message("the results cannot be written: [[why]]", why=reason)), file=sys.stderr)
        return Exit.BAD_INPUT
    descriptions = found_in(request.folders, request.out)
    places = chosen(descriptions.places, request.patterns)
    language = language_of_files(*(place.file for place in places or descriptions.places))
    say = language.say
    if not places and not descriptions.unreadable:
        print("\n".join(map(say, _nothing(request, descriptions))), file=sys.stderr)
        return Exit.BAD_INPUT
    if request.shard is not None:
        places = share(places, *request.shard)
    if request.budget.memory and not memory_is_bounded():
        print(say(Message("--memory has no effect here: this system has no such bound")), file=sys.stderr)
    summary, stopped = _summed_up(request, places, descriptions, started, say)
    folders = {place.folder for place in descriptions.places}
    gone = forget_gone(request.out, summary_name(request), request.folders, folders)
    whole = write_files(request, summary, language)
    if request.output_format != "text":
        sys.stdout.write(_for_programs(request, summary))
    elif not request.quiet:
        for folder in gone:
            complained = Message("[[folder]]: removed, its description is gone", folder=printable(request.out / folder))
            print(say(complained))
        where = printable(request.out / summary_name(request))
        print(f"{say(totals(summary))}; {summary.seconds:.2f} s; {where}")
    if stopped:
        print(say(Message("interrupted; what was finished is kept")), file=sys.stderr)
        return Exit.INTERRUPTED
    return summary.exit_code if whole else summary.exit_code or Exit.FAILED


def _summed_up(
    request: Request, places: list[Place], descriptions: Descriptions, started: float, say: Callable[[str], str]
) -> tuple[Summary, bool]:
    """Every row, and whether the batch was stopped."""
    version = derivation()
    refused = [_unreadable(folder, reason) for folder, reason in descriptions.unreadable]
    width = max((len(printable(place.file)) for place in places), default=0)
    progress = watcher(len(places), width, request.quiet or request.output_format != "text", request.changed, say)
    store = FolderStore(request.out, request.options, version)
    batch = Batch(places, store, progress, request.budget, request.fail_fast, request.strict_claims)
    stopped = False
    for row in refused:
        for text in complaints(row):
            progress.complain(text)
    try:
        batch.run(lambda tasks: _executor(request, tasks))
    except KeyboardInterrupt:
        stopped = True
    finally:
        progress.close()
    rows = [*(batch.rows[place.file] for place in places), *refused]
    options = request.options
    summary = Summary(
        rows=tuple(sorted(rows, key=lambda row: row.file)),
        version=mbsym.__version__,
        derivation=version,
        problems=options.problems,
        formats=options.formats,
        terms=options.terms,
        angles=options.angles,
        detail=options.detail,
        shard=None if request.shard is None else "{}/{}".format(*request.shard),
        timeout=request.budget.seconds,
        memory=request.budget.memory,
        seconds=time.monotonic() - started,
    )
    return summary, stopped


def _executor(request: Request, tasks: int) -> Executor:
    if request.cluster is not None:
        from mbsym.batch.cluster import Cluster

        return Cluster(request.cluster, request.jobs)
    from mbsym.batch.coordinator import Local

    return Local(request.jobs, tasks, request.options.formats)


def summary_name(request: Request) -> str:
    """``summary.json``; of one of several parts ``summary-3-of-8.json``."""
    return _of_part(request, FILENAME)


def _of_part(request: Request, name: str) -> str:
    if request.shard is None:
        return name
    stem, dot, ending = name.partition(".")
    return "{}-{}-of-{}{}{}".format(stem, *request.shard, dot, ending)


def summary_files(request: Request, summary: Summary, language: Language) -> Mapping[str, str]:
    """The files about the whole batch, by their names in its folder."""
    name = summary_name(request)
    return {
        name: summary_text(summary),
        _of_part(request, junit.FILENAME): junit.junit(summary),
        _of_part(request, "mbsym.sarif"): sarif(findings(summary), summary.version),
        _of_part(request, index_page.FILENAME): index_page.index_page(summary, name, language),
    }


def _for_programs(request: Request, summary: Summary) -> str:
    """Standard output for a program that reads it."""
    reported = findings(summary)
    if request.output_format == "junit":
        return junit.junit(summary)
    if request.output_format == "sarif":
        return sarif(reported, summary.version)
    return github_annotations(reported) if request.output_format == "github" else json_lines(reported)


def write_files(request: Request, summary: Summary, language: Language) -> bool:
    """Each of them whole; whether all could be written.

    Of one that cannot be, the reason is told, and none is left of an earlier batch, which would speak for this one.
    """
    writers: dict[str, Callable[[], object]] = {
        name: partial(deliver, request.out, {name: text}, SUMMARY, ())
        for name, text in summary_files(request, summary, language).items()
    }
    if request.appendix:
        name = _of_part(request, APPENDIX)
        writers[name] = partial(write_appendix, request.out, name, summary)
    whole = True
    for name, write in writers.items():
        try:
            write()
        except OSError as error:
            whole = False
            print(
                language.say(
                    Message(
                        "[[file]] cannot be written: [[why]]",
                        file=printable(request.out / name),
                        why=error.strerror or error,
                    )
                ),
                file=sys.stderr,
            )
            if not isinstance(error, FileExistsError):
                with suppress(OSError):
                    (request.out / name).unlink(missing_ok=True)
    return whole


def write_appendix(out: Path, name: str, summary: Summary) -> None:
    """Joins the appendices of those descriptions that have one, in the order of the summary, into ``out/name``.

    Labels differ from system to system; what has none, as a description with errors, is named at the head.  Raises
    OSError where the file cannot be written.
    """
    from mbsym.report.latex import appendix

    texts = [(row.file, _text(out, row)) for row in summary.rows]
    without = [file for file, text in texts if not text]
    head = [f"% Appendices of {len(texts) - len(without)} systems, joined by mbsym {summary.version}."]
    head += [f"% Left out, without an appendix: {_plain(file)}" for file in without]
    whole = "\n".join(head) + "\n\n" + appendix.joined([text for _, text in texts if text])
    deliver(out, {name: whole}, SUMMARY, gone=())


def _text(out: Path, row: Row) -> str:
    """A system's appendix, as it was written for this row; "" where it is not there."""
    digest = next((file.sha256 for file in row.files if file.name == APPENDIX), "")
    try:
        data = (out / row.folder / APPENDIX).read_bytes() if digest else b""
    except OSError:
        return ""
    return data.decode() if hashlib.sha256(data).hexdigest() == digest else ""


def _plain(words: str) -> str:
    """A path in a comment of TeX."""
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in words)


def _unreadable(folder: str, reason: str) -> Row:
    complaint = ComplaintRow("error", "unreadable", Message("the folder cannot be read: [[why]]", why=reason))
    return Row(folder, "", Outcome.ERRORS, complaints=(complaint,))


def _nothing(request: Request, descriptions: Descriptions) -> Iterator[Message]:
    """What to say where there is nothing to do, line by line."""
    where = ", ".join(map(printable, request.folders))
    if descriptions.places:
        patterns = ", ".join(map(printable, request.patterns))
        text = "[[where]]: no description fits --filter [[patterns]] (descriptions there: [[count]])"
        yield Message(text, where=where, patterns=patterns, count=len(descriptions.places))
        return
    yield joined((where, nothing_here(descriptions.others)), ": ")
    yield joined(("  ", Message("hint: [[hint]]", hint=DESCRIPTIONS_HAVE)), "")


#: A summary is no larger; more of a file is not read.
_MOST_BYTES = 256 * 1024 * 1024


def forget_gone(out: Path, summary: str, folders: Sequence[Path], current: Collection[str]) -> list[str]:
    """Removes the results of descriptions that were deleted; the folders that they were in, below ``out``.

    ``summary`` is the file of the last batch into ``out``.  What it lists goes if its description lay in one of the
    ``folders`` that are asked for now and is not there any more, and no description of now has its folder
    (``current``).
    Files that somebody has changed, or put there, stay, and their folder with them.
    """
    locks, forgotten = Locks(out), []
    for file, folder in _listed(out / summary):
        place = out / folder
        if folder in current or not any(Path(file).is_relative_to(root) for root in folders) or not _is_gone(file):
            continue
        if obstacle(place, out) or not delivered(place, COMMAND) or not locks.take(folder):
            continue
        try:
            deliver(place, {}, COMMAND)
            if not read_manifest(place) and [path.name for path in place.iterdir()] == [MANIFEST]:
                (place / MANIFEST).unlink()
                for empty in (place, *(out / parent for parent in PurePosixPath(folder).parents if parent.name)):
                    empty.rmdir()
        except OSError:  # not empty, or not ours to remove: it says itself what it is about
            pass
        finally:
            locks.leave(folder)
        forgotten.append(folder)
    return forgotten


def _listed(summary: Path) -> Iterator[tuple[str, str]]:
    """(description, folder of its results) as a summary says; its folders are somebody's word, and stay inside."""
    content: Any = None
    with suppress(OSError, ValueError, RecursionError):
        if summary.stat().st_size <= _MOST_BYTES:
            content = json.loads(summary.read_bytes())
    if not isinstance(content, dict) or content.get("format") != FORMAT or not isinstance(content.get("systems"), list):
        return
    for row in content["systems"]:
        file, folder = (row.get("file"), row.get("folder")) if isinstance(row, dict) else (None, None)
        if isinstance(file, str) and isinstance(folder, str) and "\0" not in file + folder:
            parts = PurePosixPath(folder).parts
            if parts and not PurePosixPath(folder).is_absolute() and ".." not in parts:
                yield file, folder


def _is_gone(file: str) -> bool:
    """Whether nothing has this name; what cannot be looked at is not gone."""
    try:
        os.lstat(file)
    except (FileNotFoundError, NotADirectoryError):
        return True
    except (OSError, ValueError):
        pass
    return False
