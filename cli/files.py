"""Delivering files: one whole, or a set of them whole.

A folder of reports may hold files of the user's own, so it cannot be exchanged as one.  A set goes into it in three
steps, under a lock:

1. *staged*: every file is written and flushed into a hidden folder ``.mbsym-new-...`` inside, with the new manifest;
2. *committed*: that folder is renamed to ``.mbsym-ready``, which is one step for every observer;
3. *installed*: the files that the set replaces are removed, then the new ones are moved to their places, the
   manifest last.

What fails or is killed before step 2 leaves the old set as it was.  What is killed after it is completed by whoever
delivers into the folder next; until then names may be missing, but an old file never stands beside a new one of the
same set.  What step 1 left behind is removed by the next delivery.

The manifest, ``.mbsym.json``, lists each set with the SHA-256 of its files.  Only files that it lists, and that still
are what was written, are removed when a later set does without them.  A file that no manifest lists is somebody's own:
it is not replaced unless ``--force`` was given.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, TYPE_CHECKING, BinaryIO, TypeVar, cast

from mbsym.expressions.message import Message
from mbsym.source.render import escaped
from mbsym.studies.study import Exit
from mbsym_cli.console import Force, complain

if TYPE_CHECKING:
    from mbsym_cli.options import Options

T = TypeVar("T")

MANIFEST = ".mbsym.json"

#: Where files go that nobody gave a place.
REPORTS = Path("reports")

_READY = ".mbsym-ready"
_NEW, _PART = ".mbsym-new-", ".mbsym-part-"

#: Where nothing says that its writer is gone, what lies aside for so many seconds is a stray.
_STALE = 3600.0

#: For so many files at a time the disk is waited for.
_AT_ONCE = 8

#: A folder's name has at most so many bytes (file systems allow 255), for endings that are put to it.
_LONGEST_NAME = 200

#: Names that some systems keep for devices.
_RESERVED = {"con", "prn", "aux", "nul"} | {f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10)}

#: Of a file: all of it, or parts that are made one after the other.
Content = str | bytes | Iterable[str]

#: What is said of a file that mbsym did not write.
NOT_OURS = "it is there already and mbsym did not write it; --force replaces it"

#: Command -> file -> SHA-256, one entry a set; a command has several where it was asked for some of its files only.
Sets = list[tuple[str, dict[str, str]]]


def taken(path: Path) -> bool:
    """Whether there is something in the place of a single file that is not to be replaced."""
    return not Force.wanted and os.path.lexists(path)


# --- one file ---------------------------------------------------------------------------------------------------------


def write_whole(path: Path, content: str | bytes) -> None:
    """Writes aside, in the same folder, and renames: a reader sees the old file or the new one, never half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    _remove_strays(path.parent, certain=False)
    handle, aside = tempfile.mkstemp(prefix=_PART, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            _written(stream, content)
            os.fsync(stream.fileno())
        os.chmod(aside, 0o666 & ~_umask())
        os.replace(aside, path)
    except BaseException:
        Path(aside).unlink(missing_ok=True)
        raise


# --- a set of files ---------------------------------------------------------------------------------------------------


def deliver(
    folder: Path, files: Mapping[str, Content], command: str, gone: Collection[str] | None = None
) -> list[Path]:
    """The paths of ``files`` (name -> content, whole or in parts), delivered into ``folder`` as one set of ``command``.

    A name may have one folder in it, ``fragments/energy.tex``.

    Of the files that ``command`` delivered there before and that are not in this set, those named in ``gone`` are
    removed (without ``gone``: all of them), unless somebody has changed them since.  Raises OSError where the set
    cannot be written, FileExistsError where it would replace what no set lists; then what was there is whole.
    """
    if any(not _is_plain(name) for name in files):
        raise ValueError(f"names of files are wanted, not {sorted(files)}")
    made = not folder.exists()
    with alone(folder) as locked:
        _recover(folder, locked)
        for name in (*files, MANIFEST):
            if (folder / name).is_dir() and not (folder / name).is_symlink():
                raise IsADirectoryError(f"{folder / name} is a folder")
            inner = (folder / name).parent
            if inner != folder and (inner.is_symlink() or (inner.exists() and not inner.is_dir())):
                raise NotADirectoryError(f"{inner} is no folder")
        stage = Path(tempfile.mkdtemp(prefix=_NEW, dir=folder))
        try:
            with ExitStack() as closing:
                staged: list[BinaryIO] = []
                digests = {}
                for name, content in files.items():
                    staged.append(closing.enter_context(_staged(stage / name)))
                    digests[name] = _written(staged[-1], content)
                _spare(folder, digests)
                manifest = _manifest_text(_merged(read_manifest(folder), command, digests, gone))
                staged.append(closing.enter_context(_staged(stage / MANIFEST)))
                _written(staged[-1], manifest)
                _at_once(lambda stream: os.fsync(stream.fileno()), staged)
            folders = [*(inner for inner in stage.iterdir() if inner.is_dir()), stage]
            for directory in folders:
                os.chmod(directory, 0o777 & ~_umask())
            _at_once(_flush_folder, folders)
            os.rename(stage, folder / _READY)
        except BaseException:
            shutil.rmtree(stage, ignore_errors=True)
            if made:
                with suppress(OSError):
                    folder.rmdir()
            raise
        try:
            _install(folder)
        except BaseException:  # Ctrl-C: what is committed is completed before it ends
            with suppress(OSError):
                _install(folder)
            raise
    return [folder / name for name in files]


def _spare(folder: Path, digests: Mapping[str, str]) -> None:
    """Raises FileExistsError where a file would be replaced that mbsym did not write and that holds something else."""
    if Force.wanted:
        return
    own = {name for _, files in read_manifest(folder) for name in files}
    foreign = sorted(
        name
        for name, digest in digests.items()
        if name not in own and os.path.lexists(folder / name) and digest_of(folder / name) != digest
    )
    if foreign:
        raise FileExistsError(errno.EEXIST, NOT_OURS, str(folder / ", ".join(foreign)))


def read_manifest(folder: Path) -> Sets:
    """The sets that were delivered into a folder; nothing where there is no manifest that can be read."""
    return _read_sets(folder / MANIFEST)


def delivered(folder: Path, command: str) -> dict[str, str]:
    """The files of ``command`` in a folder, with the SHA-256 that they had when they were written."""
    return {
        name: digest for owner, files in read_manifest(folder) if owner == command for name, digest in files.items()
    }


def recover(folder: Path) -> None:
    """Completes a set that was committed by a delivery that was killed."""
    if (folder / _READY).is_dir():
        with alone(folder) as locked, suppress(OSError):
            _recover(folder, locked)


def _merged(old: Sets, command: str, digests: dict[str, str], gone: Collection[str] | None) -> Sets:
    """The sets after this delivery: what is replaced or goes is in no older set any more."""
    merged: Sets = []
    for owner, files in old:
        leaving = set(digests) | ((set(files) if gone is None else set(gone)) if owner == command else set())
        remaining = {name: digest for name, digest in files.items() if name not in leaving}
        if remaining:
            merged.append((owner, remaining))
    return [*merged, (command, digests)] if digests else merged


def _manifest_text(sets: Sets) -> str:
    listed = [{"command": command, "files": dict(sorted(files.items()))} for command, files in sets]
    return json.dumps({"written by": "mbsym", "sets": listed}, indent=2) + "\n"


def _read_sets(file: Path) -> Sets:
    """Its names are somebody's word, which nobody follows out of the folder."""
    try:
        content = json.loads(file.read_bytes())
        sets = [(str(entry["command"]), dict(entry["files"])) for entry in content["sets"]]
    except (OSError, ValueError, TypeError, KeyError, RecursionError):
        return []
    return [(command, {str(k): str(v) for k, v in files.items() if _is_plain(str(k))}) for command, files in sets]


def _is_plain(name: str) -> bool:
    """A name that stays in its folder, or in one folder inside, and is none of our own."""
    parts = name.split("/")
    return len(parts) <= 2 and all(
        part and part == os.path.basename(part) and part not in (".", "..") and not part.startswith(".mbsym")
        for part in parts
    )


def _recover(folder: Path, locked: bool) -> None:
    """Completes what was committed and removes what was not, after a crash of another delivery."""
    if (folder / _READY).is_dir():
        _install(folder)
    _remove_strays(folder, certain=locked)


def _install(folder: Path) -> None:
    """Step 3, from wherever it was left."""
    ready = folder / _READY
    if not ready.is_dir():
        return
    staged = (path.relative_to(ready).as_posix() for path in ready.rglob("*") if not path.is_dir())
    waiting = sorted(name for name in staged if name != MANIFEST)
    if (ready / MANIFEST).exists():
        staying = {name for _, files in _read_sets(ready / MANIFEST) for name in files}
        for _, files in read_manifest(folder):
            for name, digest in files.items():
                if name not in staying and _is_inside(folder, name) and digest_of(folder / name) == digest:
                    (folder / name).unlink(missing_ok=True)
                    _remove_empty(folder, name)
        _at_once(lambda name: (folder / name).unlink(missing_ok=True), waiting)
        for name in [*waiting, MANIFEST]:
            (folder / name).parent.mkdir(exist_ok=True)
            os.replace(ready / name, folder / name)
    _at_once(_flush_folder, {folder, *((folder / name).parent for name in waiting)})
    for path in list(ready.iterdir()):
        path.rmdir()
    ready.rmdir()


def _is_inside(folder: Path, name: str) -> bool:
    """Whether no link leads out of the folder on the way to a file."""
    return not (folder / name).parent.is_symlink() or "/" not in name


def _remove_empty(folder: Path, name: str) -> None:
    """The folder inside that a removed file leaves empty."""
    if "/" in name:
        with suppress(OSError):
            (folder / name).parent.rmdir()


def _remove_strays(folder: Path, certain: bool) -> None:
    """What a killed writer left aside; where one may still be at work (not ``certain``), only what is old."""
    with suppress(OSError):
        for path in folder.iterdir():
            if not path.name.startswith((_NEW, _PART)):
                continue
            with suppress(OSError):
                sure = certain and path.name.startswith(_NEW)
                if sure or time.time() - path.lstat().st_mtime > _STALE:
                    if path.is_dir() and not path.is_symlink():
                        shutil.rmtree(path, ignore_errors=True)
                    else:
                        path.unlink()


def _staged(path: Path) -> BinaryIO:
    """A new file."""
    path.parent.mkdir(exist_ok=True)
    return path.open("xb")


def _written(stream: IO[bytes], content: Content) -> str:
    """Hands the content to the system; the SHA-256 of its bytes."""
    digest = hashlib.sha256()
    for part in [content] if isinstance(content, (str, bytes)) else content:
        data = part.encode() if isinstance(part, str) else part
        stream.write(data)
        digest.update(data)
    stream.flush()
    return digest.hexdigest()


def _at_once(step: Callable[[T], object], items: Collection[T]) -> None:
    """A step for each item that waits for the disk and may be taken a second time.

    All at once, where there are threads: a disk that is told of twenty files one by one (to keep them, to free their
    room) waits twenty times.
    """
    from concurrent.futures import ThreadPoolExecutor  # not before something is delivered

    try:
        with ThreadPoolExecutor(_AT_ONCE) as pool:
            for _ in pool.map(step, items):
                pass
    except RuntimeError:  # no thread can be started here
        for item in items:
            step(item)


def digest_of(path: Path) -> str:
    """The SHA-256 of a plain file; "" for anything else."""
    if path.is_symlink() or not path.is_file():
        return ""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _flush_folder(folder: Path) -> None:
    """Names reach the disk, where a system has that."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


@contextmanager
def room_beside(folder: Path) -> Iterator[BinaryIO]:
    """A file without a name on the disk of a folder, which need not be there yet: gone with the process, however it
    ends."""
    place = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.is_dir())
    with tempfile.TemporaryFile(prefix=_PART, dir=place) as stream:
        yield cast(BinaryIO, stream)


# --- folders ----------------------------------------------------------------------------------------------------------


@contextmanager
def alone(folder: Path) -> Iterator[bool]:
    """Another run that writes into the folder waits, where locks exist; yields whether this one has the lock."""
    folder.mkdir(parents=True, exist_ok=True)
    try:
        import fcntl

        handle = os.open(folder, os.O_RDONLY)
    except (ImportError, OSError):
        yield False
        return
    try:
        locked = True
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
        except OSError:  # some network file systems have no locks
            locked = False
        yield locked
    finally:
        os.close(handle)


def unchanged(folder: Path, command: str) -> list[str]:
    """The files of ``command`` in a folder that are as they were written."""
    return [name for name, digest in delivered(folder, command).items() if digest_of(folder / name) == digest]


def folder_for(file: Path, out: Path | None) -> Path:
    """Where the files about one description go: ``out`` itself, or a folder of its name in ``reports``."""
    return out if out is not None else REPORTS / safe_name(file.stem)


def folders_for(files: Sequence[Path], out: Path | None) -> list[Path]:
    """Where those about each of several go: folders of their names in ``out``, or in ``reports``, no two the same."""
    if len(files) == 1:
        return [folder_for(files[0], out)]
    taken: set[str] = set()
    folders = []
    for file in files:
        name, count = safe_name(file.stem), 1
        while name.casefold() in taken:  # some file systems tell no capitals
            name = safe_name(file.name if count == 1 else f"{file.name}-{count}")
            count += 1
        taken.add(name.casefold())
        folders.append((out or REPORTS) / name)
    return folders


def safe_name(name: str) -> str:
    """The name of a folder like ``name``, which is one level down on any system.

    Dots and blanks at the end go (``..``), names of devices get an underscore (``con``), what cannot be seen or
    separates folders becomes one, and what is too long is cut and told apart by its hash.
    """
    plain = "".join(c if c.isprintable() and c not in '/\\:*?"<>|' else "_" for c in name).rstrip(". ") or "unnamed"
    if plain.split(".")[0].rstrip().lower() in _RESERVED or plain.startswith(".mbsym"):
        plain = f"_{plain}"
    data = plain.encode(errors="surrogateescape")
    if len(data) <= _LONGEST_NAME:
        return plain
    return data[:_LONGEST_NAME].decode(errors="ignore") + "-" + hashlib.sha256(data).hexdigest()[:8]


def prevented(file: Path, folder: Path | None, read: bool, options: Options, inside: Path | None = None) -> int:
    """The exit code where options are wrong (``read``: the description is not) or nothing can be written; else 0."""
    if options.refused(file if read else None) or not read:
        return Exit.BAD_INPUT
    reason = "" if folder is None else obstacle(folder, inside)
    if reason:
        complain(file, Message("the results cannot be written: [[why]]", why=reason))
        return Exit.FAILED
    return Exit.OK


def obstacle(folder: Path, inside: Path | None = None) -> str:
    """Why a folder cannot be written to, known before hours of computing; empty if nothing speaks against it.

    A folder that has to be ``inside`` another one, as those in ``reports`` have, is not written to through a link that
    leads out of it.
    """
    if inside is None and folder.parent == REPORTS:
        inside = REPORTS
    try:
        if inside is not None and not folder.resolve().is_relative_to(inside.resolve()):
            return f"{escaped(str(folder))} is a link that leads out of {escaped(str(inside))}"
        for place in (folder, *folder.absolute().parents):
            if place.exists():
                if not place.is_dir():
                    return f"{escaped(str(place))} is no folder"
                return "" if os.access(place, os.W_OK) else f"{escaped(str(place))} is not writable"
    except (OSError, ValueError, RuntimeError) as error:  # a name that is too long, a link that loops
        return str(error)
    return ""


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
