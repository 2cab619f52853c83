"""Where a sweep keeps its finished chunks: a file each, named by what they follow from.

    chunks/<16 digits of the SHA-256 of description, request and version>-<number>.npz

A file is whole or not there.  Another description, request or version has other names, so nothing stale is ever read.
"""

from __future__ import annotations

import zipfile
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from mbsym.sweeps.sweep import Chunk


class Folder:
    """The chunks of one sweep in ``folder/chunks``; ``write`` writes a file that is whole or not there."""

    def __init__(
        self, folder: Path, digest: str, columns: tuple[str, ...], write: Callable[[Path, bytes], object]
    ) -> None:
        self.folder, self.digest, self.columns, self.write = folder / "chunks", digest[:16], columns, write

    def path(self, chunk: Chunk) -> Path:
        return self.folder / f"{self.digest}-{chunk.number:06d}.npz"

    def load(self, chunk: Chunk) -> Mapping[str, Any] | None:
        """The columns; None where they are not there, or are not what they should be."""
        try:
            with np.load(self.path(chunk), allow_pickle=False) as stored:
                found = {name: stored[name] for name in self.columns}
        except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
            return None
        if any(values.shape != (chunk.stop - chunk.start,) for values in found.values()):
            return None
        return found

    def save(self, chunk: Chunk, columns: Mapping[str, Any]) -> None:
        stream = BytesIO()
        np.savez_compressed(stream, **{name: columns[name] for name in self.columns})
        self.write(self.path(chunk), stream.getvalue())
