"""Which descriptions a batch is about, and where the files of each go."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import Path, PurePosixPath

from mbsym.batch.coordinator import Place
from mbsym_cli.files import safe_name
from mbsym_cli.options import SUFFIXES, identity_of

#: Folders that hold no descriptions of the user's.
_APART = {"__pycache__", "node_modules"}


@dataclass(frozen=True)
class Descriptions:
    """``places`` in the order of their files; ``unreadable`` folders with the reason; ``others``: files passed over."""

    places: tuple[Place, ...]
    unreadable: tuple[tuple[str, str], ...] = ()
    others: int = 0


def found_in(paths: Sequence[Path], out: Path) -> Descriptions:
    """The descriptions of files and folders, with all that is in these; each once, whatever it is called.

    Not looked into: hidden folders, links to folders (they may lead round in circles), and ``out``.  A file that is
    named itself is one in any case; in folders those are that say so.
    """
    from mbsym.source import is_description

    candidates: list[tuple[Path, PurePosixPath]] = []
    unreadable: list[tuple[str, str]] = []
    others = 0
    labels = _labels([path for path in paths if path.is_dir()])
    for path in paths:
        if not path.is_dir():
            candidates.append((path, PurePosixPath(path.name)))
            continue
        for file, inside in _walk(path, out, unreadable):
            if is_description(file):
                candidates.append((file, labels[path] / inside))
            else:
                others += 1
    return Descriptions(tuple(_places(candidates)), tuple(unreadable), others)


def chosen(places: Iterable[Place], patterns: Sequence[str]) -> list[Place]:
    """Those whose path, or the end of it, fits one of the patterns; all where there are none."""
    return [place for place in places if not patterns or any(_fits(place.file, pattern) for pattern in patterns)]


def share(places: Sequence[Place], part: int, parts: int) -> list[Place]:
    """The places of one of ``parts`` batches, ``part`` counted from 1: every so many-th of them."""
    return list(places[part - 1 :: parts])


def _fits(file: str, pattern: str) -> bool:
    pieces = PurePosixPath(file).parts
    return any(fnmatchcase("/".join(pieces[start:]), pattern) for start in range(len(pieces)))


def _labels(folders: Sequence[Path]) -> dict[Path, PurePosixPath]:
    """Of one folder nothing, of several their names, so that equal files in them have folders of their own."""
    if len(folders) < 2:
        return dict.fromkeys(folders, PurePosixPath())
    return {folder: PurePosixPath(folder.resolve().name) for folder in folders}


def _walk(root: Path, out: Path, unreadable: list[tuple[str, str]]) -> Iterable[tuple[Path, PurePosixPath]]:
    """The files in a folder that could be descriptions, with their paths in it: folder by folder."""

    def refused(error: OSError) -> None:
        unreadable.append((_shown(Path(error.filename)), error.strerror or str(error)))

    own = identity_of(out)
    for folder, inside, names in os.walk(root, onerror=refused):
        inside[:] = sorted(
            name
            for name in inside
            if not name.startswith(".") and name not in _APART and identity_of(Path(folder, name)) != own
        )
        for name in names:
            if name.endswith(SUFFIXES):
                file = Path(folder, name)
                yield file, PurePosixPath(file.relative_to(root).as_posix())


def _places(candidates: Iterable[tuple[Path, PurePosixPath]]) -> Iterable[Place]:
    """Every file once, with a folder of its own: where two would share one, the second keeps its ending."""
    seen: set[str] = set()
    taken: set[str] = set()
    places = []
    for file, inside in sorted(candidates, key=_order):
        identity = identity_of(file)
        if identity in seen:
            continue
        seen.add(identity)
        above = [safe_name(part) for part in inside.parts[:-1]]
        count = 0
        while True:
            last = inside.stem if count == 0 else inside.name if count == 1 else f"{inside.name}-{count}"
            folder = "/".join([*above, safe_name(last)])
            if folder.casefold() not in taken:  # some file systems tell no capitals
                break
            count += 1
        taken.add(folder.casefold())
        places.append(Place(_shown(file), folder))
    return places


def _order(candidate: tuple[Path, PurePosixPath]) -> tuple[tuple[str, ...], str, int, str]:
    """By folder and name, YAML before plain text."""
    file, inside = candidate
    ending = SUFFIXES.index(inside.suffix) if inside.suffix in SUFFIXES else len(SUFFIXES)
    return inside.parts[:-1], inside.stem, ending, str(file)


def _shown(path: Path) -> str:
    """A path with ``/`` on every system, as CI systems want it."""
    return path.as_posix()
