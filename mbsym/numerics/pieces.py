"""Many pieces of a solution evaluated at once: where all are of a compiled method, in one go over arrays."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from mbsym.numerics.methods.interface import Piece
from mbsym.numerics.methods.nested import Nested


def states_on(pieces: Sequence[Callable[[Any], Any]], times: Sequence[Any]) -> Any:
    """The states (2n, m) of each piece at its own times, a piece after the other; not all have any.

    Times of pieces of a compiled method have to lie within them.
    """
    curves = [piece.curve for piece in pieces if isinstance(piece, Piece)]
    steps = [curve for curve in curves if isinstance(curve, Nested)]
    if len(steps) < len(pieces) or len({step.terms.shape for step in steps}) > 1:
        return np.hstack([piece(np.asarray(own)) for piece, own in zip(pieces, times, strict=True) if len(own)])
    counts = [len(own) for own in times]
    start, length, reached = (
        np.repeat([getattr(step, name) for step in steps], counts) for name in ("start", "length", "reached")
    )
    before, arrived = (
        np.repeat(np.hstack([getattr(step, name) for step in steps]), counts, axis=1) for name in ("before", "arrived")
    )
    terms = np.repeat(np.concatenate([step.terms for step in steps], axis=2), counts, axis=2)
    return Nested(start, length, reached, before, arrived, terms)(np.concatenate(times))
