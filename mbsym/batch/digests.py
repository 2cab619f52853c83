"""When results are still those of a description: digests of what they follow from.

    results = derivation(description, options)

The *derivation* is the source of mbsym with the versions of the libraries that its formulas come from.  The description
is told by its *bytes*, which are quick to compare, and by its *meaning*: its tree of keys and values, without comments,
layout, quotation marks and places.  All are SHA-256 in hexadecimal.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path

from mbsym import __version__

#: Libraries that formulas come from, as their distributions are called.
_LIBRARIES = ("python-flint", "sympy")


def of_bytes(data: bytes, filename: str) -> str:
    """The digest of a file.  The ending of its name is part of it: it can decide how the file is read."""
    ending = os.path.splitext(filename)[1].lower()
    return hashlib.sha256(ending.encode(errors="surrogateescape") + b"\0" + data).hexdigest()


def of_meaning(text: str, filename: str) -> str:
    """The digest of what a description says, "" where it cannot be read.

    Two texts have the same one if they differ in comments, blanks, line ends, quotation marks, or in block style
    against flow style; not if an expression is written in another way, or keys stand in another order.
    """
    from mbsym.source.document import placed_tree

    tree, editor = placed_tree(text, filename)
    if tree is None:
        return ""
    digest = hashlib.sha256(b"editor" if editor else b"yaml")
    for piece in _pieces(tree):
        data = piece.encode(errors="surrogatepass")
        digest.update(b"%d:" % len(data))  # so that no two sequences of pieces are one sequence of bytes
        digest.update(data)
    return digest.hexdigest()


def _pieces(tree: object) -> Iterator[str]:
    """A placed tree without its places."""
    from mbsym.source.placed import Mapping, Scalar, Sequence

    match tree:
        case Scalar(text=text):
            yield f"={text}"
        case Sequence(items=items):
            yield "["
            for item in items:
                yield from _pieces(item)
            yield "]"
        case Mapping(entries=entries):
            yield "{"
            for entry in entries:
                yield f"={entry.key.text}"
                yield from _pieces(entry.value)
            yield "}"


def derivation() -> str:
    """The digest of everything that derives and writes: whoever changes a line of it gets new results."""
    digest = hashlib.sha256(__version__.encode())
    for name in _LIBRARIES:
        digest.update(f"\0{name} {_version(name)}".encode())
    for name, path in _sources():
        digest.update(f"\0{name}\0".encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _sources() -> Iterator[tuple[str, Path]]:
    """The files of mbsym and its templates, with names that are the same wherever it is installed."""
    from importlib.util import find_spec

    templates = find_spec("mbsym_templates")
    places = [] if templates is None else list(templates.submodule_search_locations or ())
    for where, root in (("mbsym", Path(__file__).parents[1]), *(("templates", Path(place)) for place in places)):
        for folder, inside, names in os.walk(root):
            inside[:] = sorted(name for name in inside if name != "__pycache__")
            for name in sorted(names):
                if name.endswith((".py", ".j2", ".json", ".css", ".js")):
                    path = Path(folder, name)
                    yield f"{where}/{path.relative_to(root).as_posix()}", path


def _version(name: str) -> str:
    from importlib import metadata

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""
