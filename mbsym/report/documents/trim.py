"""What ``mbsym trim --json`` and ``mbsym inverse --json`` print: inputs that hold a posture, or give a motion."""

from __future__ import annotations

from typing import Annotated

from mbsym.report.documents.base import From, Head, Part, words


class SignDemand(Part, frozen=True):
    """a demand: the value, in relation to 0"""

    name: Annotated[str, "the parameter whose sign is declared"]
    value: Annotated[str, "its value, in Python syntax"]
    relation: Annotated[str, words(">", ">=", "<", "<=", "!="), "how it has to stand to 0"]


class Trim(Head, frozen=True, kw_only=True):
    """Inputs or parameters with which the described motion satisfies the equations; formulas in Python syntax."""

    possible: Annotated[bool, "whether there are such values", From("impossible", lambda never: not never)]
    solved: Annotated[dict[str, str], "values in terms of the free ones, by name"]
    free: Annotated[list[str], "those that may have any value"]
    nonzero: Annotated[list[str], "what was divided by: all this holds where none of it vanishes", From("assumed")]
    conditions: Annotated[list[str], "what has to vanish besides, whatever the values are"]
    signed: Annotated[list[SignDemand], "what the declared signs demand of the values"]


class Inverse(Head, frozen=True, kw_only=True):
    """The inputs with which the coordinates move as given, in the units of the description."""

    exact: Annotated[bool, "whether they give this motion, but for rounding; else the nearest by least squares"]
    left: Annotated[float | None, "what is left of the equations at most, as a part of the size of their terms"]
    unique: Annotated[bool, "whether no other inputs do the same at any of the times; else these are the smallest"]
    times: Annotated[list[float], "the times"]
    inputs: Annotated[dict[str, Annotated[list[float], "its value at each time"]], "the inputs, by name"]
