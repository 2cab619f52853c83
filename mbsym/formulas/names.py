"""Names from one language to another: Greek words, subscripts, and renamings that keep different names different."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass

LOWER_GREEK = (
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
)  # fmt: skip

#: ``lambda`` is no name in Python, so descriptions write one of these.
ALIASES = {"lam": "lambda", "lamda": "lambda", "lambda_": "lambda", "Lam": "Lambda"}

_WORDS = {word: word for word in LOWER_GREEK} | {word.capitalize(): word.capitalize() for word in LOWER_GREEK} | ALIASES
_LEADING_GREEK = re.compile("(" + "|".join(sorted(_WORDS, key=len, reverse=True)) + r")(?=_|\d|\Z)")


@dataclass(frozen=True, slots=True)
class NameParts:
    """``stem`` and the parts that stand as its index; ``greek`` is the stem's Greek letter (theta, Theta) or empty."""

    stem: str
    greek: str
    indices: tuple[str, ...]


def greek(word: str) -> str:
    """The Greek letter a whole word means, or an empty string."""
    return _WORDS.get(word, "")


def parts(name: str) -> NameParts:
    """omega0 -> omega, 0;  p_max -> p, max;  k_theta_2 -> k, theta, 2;  Jx -> Jx."""
    match = _LEADING_GREEK.match(name)
    stem, rest = (match[1], name[match.end() :]) if match else _split_stem(name)
    indices: list[str] = []
    for piece in rest.split("_"):
        indices += re.findall(r"\d+|\D+", piece) if piece[:1].isdigit() else [piece] if piece else []
    return NameParts(stem, greek(stem), tuple(indices))


def _split_stem(name: str) -> tuple[str, str]:
    stem, _, rest = name.partition("_")
    plain = stem.rstrip("0123456789") or stem
    return plain, "_".join(piece for piece in (stem[len(plain) :], rest) if piece)


def injective(names: Iterable[str], propose: Callable[[str], str], taken: Collection[str] = ()) -> dict[str, str]:
    """A renaming under which different names stay different and none is in ``taken``.

    Each name gets what ``propose`` says; where that is taken, letters are appended until it is free.  Names that
    ``propose`` leaves alone are served first, so that nobody takes theirs away.
    """
    ordered = list(dict.fromkeys(names))
    result: dict[str, str] = {}
    used = set(taken)
    for unchanged in (True, False):
        for name in ordered:
            proposed = propose(name)
            if (proposed == name) is unchanged:
                result[name] = free_name(proposed, used)
                used.add(result[name])
    return {name: result[name] for name in ordered}


def free_name(proposed: str, used: Collection[str]) -> str:
    """The proposed name, with letters appended until it is not among the used ones."""
    candidate, count = proposed, 0
    while candidate in used:
        candidate, count = proposed + "x" + "z" * count, count + 1
    return candidate
