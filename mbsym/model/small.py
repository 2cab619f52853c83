"""A small parameter: what is expanded in its powers, and which variables are fast, which oscillates."""

from __future__ import annotations

from dataclasses import dataclass, field

from mbsym.expressions.place import Span


@dataclass(frozen=True)
class SmallParameter:
    """``name`` is a parameter, or with ``powers`` a name of its own: each P there, a parameter or
    a variable, stands for P name^power.

    ``fast`` are the variables that a slow manifold expresses by the others (empty: they are found), ``slow`` those
    that are not among them.  ``leading`` is the variable whose oscillation a periodic solution belongs to ("": it is
    found).
    """

    name: str
    powers: tuple[tuple[str, int], ...] = ()
    fast: tuple[str, ...] = ()
    slow: tuple[str, ...] = ()
    leading: str = ""
    span: Span | None = field(default=None, compare=False, repr=False)
