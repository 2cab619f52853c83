"""Writing files whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path


def write_whole(path: Path, content: str | bytes) -> None:
    """Writes aside, in the same folder, and renames: a reader sees the old file or the new one, never half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, aside = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content.encode() if isinstance(content, str) else content)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(aside, 0o666 & ~_umask())
        os.replace(aside, path)
    except BaseException:
        Path(aside).unlink(missing_ok=True)
        raise


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Several files of one run together: another run that writes into the folder waits, where locks exist."""
    folder.mkdir(parents=True, exist_ok=True)
    try:
        import fcntl

        handle = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield
        return
    try:
        with suppress(OSError):  # some network file systems have no locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def obstacle(folder: Path) -> str:
    """Why a folder cannot be written to, known before hours of computing; empty if nothing speaks against it."""
    for place in (folder, *folder.absolute().parents):
        try:
            found = place.exists()
        except (OSError, ValueError) as error:  # a name that is too long
            return str(error)
        if found:
            if not place.is_dir():
                return f"{place} is no folder"
            return "" if os.access(place, os.W_OK) else f"{place} is not writable"
    return ""


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
