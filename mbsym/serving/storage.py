"""The one file that is edited, and the journal beside it: each written whole or not at all.

The journal, ``.NAME.mbsym-journal``, holds what was typed and not saved.  It outlives a crash of the page or of the
server and is offered at the next start; a save removes it.  One that is found at a start is kept as
``.NAME.mbsym-journal-before`` as soon as there is a new one, until something is saved: who has not looked at the offer
yet loses nothing.
"""

from __future__ import annotations

import hashlib
import json
import os
import platform
import stat
import tempfile
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from mbsym.source.placed import MAX_TEXT

#: Larger files are none of ours: so many bytes for each character, and JSON's escapes for journals.
MOST_BYTES = 4 * MAX_TEXT
MOST_JOURNAL = 6 * MOST_BYTES

#: What is written aside, until it is renamed: ``.mbsym-part-``, a digest of this machine and the file's name, the
#: process, and what makes it unique.
_PART = ".mbsym-part-"

#: What lies aside for so many seconds is a stray, whoever is at work.
_STALE = 3600.0


class Conflict(Exception):
    """Somebody else has written the file: ``digest`` and ``text`` of what is there now."""

    def __init__(self, digest: str, text: str) -> None:
        super().__init__("the file was changed by someone else")
        self.digest, self.text = digest, text


class Unwritable(Exception):
    """With words that say why."""


class Unreadable(Exception):
    """With words that say why."""


@dataclass(frozen=True)
class Content:
    """``digest``: SHA-256 of the bytes, "" where there is no file."""

    text: str
    digest: str


@dataclass(frozen=True)
class Journal:
    """``written``: local time with its offset, ISO 8601."""

    text: str
    written: str


def digest_of(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


class Storage:
    """Reads and writes ``path`` and the journal beside it, and no other file.  Safe to be called by several threads."""

    def __init__(self, path: Path) -> None:
        self.path = path.absolute()
        self.journal_path = self.path.with_name(f".{self.path.name}.mbsym-journal")
        self._before_path = self.path.with_name(f".{self.path.name}.mbsym-journal-before")
        self._lock = threading.RLock()
        self._found = self._leftover()
        self._remove_strays()

    # --- the file -----------------------------------------------------------------------------------------------------

    def read(self) -> Content:
        """Raises Unreadable for what is no text in UTF-8, too large, or no file."""
        try:
            if not self.path.exists() and not self.path.is_symlink():
                return Content("", "")
            if not self.path.is_file():
                if self.path.is_dir():
                    raise Unreadable("it is no file, but a folder")
                raise Unreadable("it is no file" if self.path.exists() else "it is a link to nothing")
            with self.path.open("rb") as stream:
                data = stream.read(MOST_BYTES + 1)
        except OSError as error:
            raise Unreadable(error.strerror or str(error)) from error
        if len(data) > MOST_BYTES:
            raise Unreadable(f"it has more than {MOST_BYTES} bytes")
        if b"\0" in data:
            raise Unreadable("it is no text")
        try:
            return Content(data.decode("utf-8"), digest_of(data))
        except UnicodeDecodeError as error:
            raise Unreadable("it is no text in UTF-8") from error

    def stamp(self) -> tuple[int, int, int] | None:
        """Changes whenever the file is written, as far as the system tells; None where there is none."""
        with suppress(OSError):
            status = self.path.stat()
            return status.st_mtime_ns, status.st_size, status.st_ino
        return None

    def save(self, text: str, digest: str, force: bool = False) -> str:
        """Writes the text where the file still has this digest, or by ``force``; the new digest.

        Mode and owner stay, and a link goes on pointing at what is written.  A reader, or who comes after a crash, sees
        the old bytes or the new ones.  Raises Conflict, or Unwritable, with the old file whole.
        """
        data = _encoded(text)
        with self._lock:
            self._compare(digest, force)
            target = Path(os.path.realpath(self.path))
            if target.exists() and not os.access(target, os.W_OK):
                raise Unwritable("the file may not be written")
            self._remove_strays()
            _replace(target, data, _mode(target), lambda: self._compare(digest, force))
            self._clear()
        return digest_of(data)

    def _compare(self, digest: str, force: bool) -> None:
        if force:
            return
        try:
            now = self.read()
        except Unreadable as error:
            raise Unwritable(f"what is there now cannot be read: {error}") from error
        if now.digest != digest:
            raise Conflict(now.digest, now.text)

    def _remove_strays(self) -> None:
        """What saves of this file left aside whose processes were killed."""
        for target in {Path(os.path.realpath(self.path)), self.journal_path}:
            own = _aside(target)
            with suppress(OSError):
                for path in target.parent.iterdir():
                    if path.name.startswith(own) and _is_stray(path, path.name.removeprefix(own)):
                        with suppress(OSError):
                            path.unlink()

    # --- the journal --------------------------------------------------------------------------------------------------

    def keep(self, text: str) -> None:
        """What is typed and not saved; where it is what the file holds there is nothing to keep.

        Raises Unwritable.
        """
        data = _encoded(text)
        entry = {"written by": "mbsym", "written": _now(), "text": text}
        with self._lock:
            if self._holds(data):
                with suppress(OSError):
                    self.journal_path.unlink(missing_ok=True)
                return
            if self._found is not None:  # of an earlier session, perhaps not looked at
                with suppress(OSError):
                    if self.journal_path.is_file() and _read_journal(self.journal_path) == self._found:
                        os.replace(self.journal_path, self._before_path)
            _replace(self.journal_path, json.dumps(entry).encode(), 0o600)

    def offered(self) -> Journal | None:
        """What an earlier session left unsaved, or this one, where it is another text than the file's."""
        with self._lock:
            try:
                stored = self.read().text
            except Unreadable:
                stored = ""
            for journal in (_read_journal(self.journal_path), self._found):
                if journal is not None and journal.text != stored:
                    return journal
        return None

    def _leftover(self) -> Journal | None:
        return _read_journal(self.journal_path) or _read_journal(self._before_path)

    def _holds(self, data: bytes) -> bool:
        try:
            with self.path.open("rb") as stream:
                return stream.read(MOST_BYTES + 1) == data
        except OSError:
            return False

    def _clear(self) -> None:
        self._found = None
        for path in (self.journal_path, self._before_path):
            with suppress(OSError):
                path.unlink(missing_ok=True)


def _encoded(text: str) -> bytes:
    try:
        data = text.encode("utf-8")
    except UnicodeEncodeError as error:
        raise Unwritable("it has half a character, which no file holds") from error
    if len(data) > MOST_BYTES:
        raise Unwritable(f"a description has at most {MAX_TEXT} characters")
    if "\0" in text:
        raise Unwritable("it has a character of number 0, which no description has")
    return data


def _read_journal(path: Path) -> Journal | None:
    """None for what is none: somebody else's file, a link, half of one."""
    try:
        if path.is_symlink() or not path.is_file():
            return None
        with path.open("rb") as stream:
            data = stream.read(MOST_JOURNAL + 1)
        if len(data) > MOST_JOURNAL:
            return None
        entry = json.loads(data)
        text, written = entry["text"], entry["written"]
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return None
    return Journal(text, written) if isinstance(text, str) and isinstance(written, str) else None


def _replace(target: Path, data: bytes, mode: int, before: Callable[[], None] | None = None) -> None:
    """Written aside in the same folder, flushed, renamed; ``before`` is called last, and may raise."""
    try:
        handle, aside = tempfile.mkstemp(prefix=f"{_aside(target)}{os.getpid()}-", dir=target.parent)
    except OSError as error:
        raise Unwritable(error.strerror or str(error)) from error
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        _owned_as(aside, target)
        os.chmod(aside, mode)
        if before is not None:
            before()
        os.replace(aside, target)
    except OSError as error:
        Path(aside).unlink(missing_ok=True)
        raise Unwritable(error.strerror or str(error)) from error
    except BaseException:
        Path(aside).unlink(missing_ok=True)
        raise
    with suppress(OSError):  # the name reaches the disk, where a system has that
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)


def _aside(target: Path) -> str:
    """How names begin of what is written aside for a file by this machine."""
    return f"{_PART}{digest_of(os.fsencode(f'{platform.node()}/{target.name}'))[:12]}-"


def _is_stray(path: Path, rest: str) -> bool:
    """Whether who wrote it aside is gone, or has had time enough; ``rest`` of its name begins with the process."""
    process = rest.partition("-")[0]
    if process == str(os.getpid()):
        return False  # the lock is held by who is at work, and what fails clears up itself
    if process.isdigit():
        try:
            os.kill(int(process), 0)
        except ProcessLookupError:
            return True
        except (OSError, OverflowError):  # somebody else's, or no process at all
            pass
    return time.time() - path.lstat().st_mtime > _STALE


def _owned_as(path: str, like: Path) -> None:
    """Where one may: who edits another's file by a group's right does not take it away from him."""
    if hasattr(os, "chown"):
        with suppress(OSError):
            old = like.stat()
            if (old.st_uid, old.st_gid) != (os.geteuid(), os.getegid()):
                os.chown(path, old.st_uid, old.st_gid)


def _mode(target: Path) -> int:
    with suppress(OSError):
        return stat.S_IMODE(target.stat().st_mode)
    mask = os.umask(0)
    os.umask(mask)
    return 0o666 & ~mask


def _now() -> str:
    return datetime.now().astimezone().isoformat(timespec="seconds")
