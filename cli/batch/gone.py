"""Results of descriptions that are gone: what the last batch says it wrote for them, and nothing else, goes, too."""

from __future__ import annotations

import json
import os
from collections.abc import Collection, Iterator, Sequence
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import Any

from mbsym.batch.outcome import FORMAT
from mbsym_cli.batch.locks import Locks
from mbsym_cli.batch.store import COMMAND
from mbsym_cli.files import MANIFEST, deliver, delivered, obstacle, read_manifest

#: A summary is no larger; more of a file is not read.
_MOST_BYTES = 256 * 1024 * 1024


def forget_gone(out: Path, summary: str, folders: Sequence[Path], wanted: Collection[str]) -> list[str]:
    """Removes the results of descriptions that were deleted; the folders that they were in, below ``out``.

    ``summary`` is the file of the last batch into ``out``.  What it lists goes if its description lay in one of the
    ``folders`` that are asked for now and is not there any more, and no description of now has its folder (``wanted``).
    Files that somebody has changed, or put there, stay, and their folder with them.
    """
    locks, forgotten = Locks(out), []
    for file, folder in _listed(out / summary):
        place = out / folder
        if folder in wanted or not any(Path(file).is_relative_to(one) for one in folders) or not _is_gone(file):
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
    found: Any = None
    with suppress(OSError, ValueError, RecursionError):
        if summary.stat().st_size <= _MOST_BYTES:
            found = json.loads(summary.read_bytes())
    if not isinstance(found, dict) or found.get("format") != FORMAT or not isinstance(found.get("systems"), list):
        return
    for one in found["systems"]:
        file, folder = (one.get("file"), one.get("folder")) if isinstance(one, dict) else (None, None)
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
