"""Machine code and measurements that outlive the process, under the SHA-256 of all that they were made of.

Code is compiled once and loaded after, each kind of thing in a folder of its own.  That of all is ``MBSYM_CACHE``, or
else ``mbsym`` in ``XDG_CACHE_HOME`` or ``~/.cache``; ``MBSYM_CACHE=`` (empty) keeps nothing.  It may be deleted at any
time.  What stands in it is executed, as Python's own compiled modules are: a folder that belongs to another user, or
that others may write to, is not looked at, and a file whose digest does not fit is no file.  Whatever goes wrong with
it, the work is done again.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

#: Bytes that the folder may hold; beyond, what was written first goes, until half is left.
MOST_BYTES = 2**28

_DIGEST = sha256().digest_size

#: Kinds of things: machine code; what was measured.
CODE, MEASURED = "kernels", "measured"


def key_of(parts: Sequence[str]) -> str:
    """One name for all of the parts, in their order."""
    return sha256("".join(f"{len(part)}:{part}" for part in parts).encode()).hexdigest()


def load(key: str, kind: str = CODE) -> bytes | None:
    """What was kept under a key; None where there is nothing, or it is not whole."""
    with suppress(OSError):
        folder = _folder(kind)
        if folder is not None and _own(folder):
            content = (folder / key).read_bytes()
            if content[:_DIGEST] == _digest(key, content[_DIGEST:]):
                return content[_DIGEST:]
    return None


def keep(key: str, code: bytes, kind: str = CODE) -> None:
    """Keeps it where that can be done; a reader sees all of it or nothing."""
    with suppress(OSError):
        folder = _folder(kind)
        if folder is None:
            return
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not _own(folder):
            return
        _make_room(folder, len(code))
        handle, aside = tempfile.mkstemp(dir=folder)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(_digest(key, code) + code)
            os.replace(aside, folder / key)
        except OSError:
            os.unlink(aside)


def _folder(kind: str = CODE) -> Path | None:
    """Where a kind of thing is kept; None where nothing is to be, or where nobody is at home."""
    setting = os.environ.get("MBSYM_CACHE")
    if setting is not None:
        return Path(setting) / kind if setting else None
    with suppress(RuntimeError):
        base = os.environ.get("XDG_CACHE_HOME", "")
        return (Path(base) if os.path.isabs(base) else Path.home() / ".cache") / "mbsym" / kind
    return None


def _own(folder: Path) -> bool:
    """Whether nobody else can have written there."""
    if not hasattr(os, "getuid"):  # Windows: a profile is its user's
        return True
    known = folder.stat()
    return known.st_uid == os.getuid() and not known.st_mode & 0o022


def _digest(key: str, code: bytes) -> bytes:
    return sha256(key.encode() + code).digest()


def _make_room(folder: Path, size: int) -> None:
    """Deletes the oldest files where the folder would hold too much."""
    known = sorted((entry.stat().st_mtime, entry.stat().st_size, entry.path) for entry in os.scandir(folder))
    total = size + sum(size for _, size, _ in known)
    if total > MOST_BYTES:
        for _, freed, path in known:
            with suppress(OSError):
                os.unlink(path)
            total -= freed
            if total <= MOST_BYTES // 2:
                break
