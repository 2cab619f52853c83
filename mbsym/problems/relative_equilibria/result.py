"""What is told of relative equilibria: isolated ones, families, and how far the list is complete."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from mbsym.problems.stability.verdict import Verdict

EXACT, CERTIFIED = "exact", "proved in a box"


@dataclass(frozen=True)
class CoordinateValue:
    """One coordinate at an equilibrium: ``text`` is exact if ``exact`` (``pi/2``, ``5/4``), else rounded.

    ``angle``: it occurs under sine and cosine only, so it is meant modulo a full turn.
    """

    name: str
    text: str
    value: float
    angle: bool
    exact: bool


@dataclass(frozen=True)
class RelativeEquilibrium:
    """One isolated relative equilibrium.

    ``proof``: exact (f vanishes in a number field), or proved in a box.  ``coordinates_of``: which joints have other
    angles than the description's, because those are singular here (empty: none).  ``free``: coordinates that do not
    occur in f, so that every value of them does.  ``described``: how many sets of coordinates mean this configuration.
    ``beyond``: the negative lengths of polar coordinates, behind their singularity.  ``enclosures``: balls that hold
    the coordinates.
    """

    values: tuple[CoordinateValue, ...]
    proof: str
    verdict: Verdict
    coordinates_of: str = ""
    free: tuple[str, ...] = ()
    described: int = 1
    beyond: tuple[str, ...] = ()
    enclosures: Mapping[str, Any] = field(default_factory=dict, compare=False, repr=False)


@dataclass(frozen=True)
class EquilibriumFamily:
    """Relative equilibria that are not isolated: a real set of ``dimension``, all solutions of ``equations`` = 0.

    ``sample`` is one of them, ``verdict`` the verdict there; ``free`` may be chosen near it.
    """

    dimension: int
    free: tuple[str, ...]
    equations: tuple[str, ...]
    sample: tuple[CoordinateValue, ...]
    verdict: Verdict
    coordinates_of: str = ""


@dataclass(frozen=True)
class Equilibria:
    """``complete``: nothing is missing; otherwise ``remarks`` say what was not done, and why.

    ``singular`` are solutions of f = 0 at which the mass matrix, and with it the coordinates, are singular: whether
    they are equilibria is undecided.  ``beyond`` are solutions in which a polar coordinate that is a length is negative
    and the forces are not those at the same places of the bodies with a positive length: no states of the system meant.
    ``turning`` are the coordinates that turn at the description's rates, ``charts`` how many sets of angles were used.
    """

    equilibria: tuple[RelativeEquilibrium, ...]
    families: tuple[EquilibriumFamily, ...]
    complete: bool
    remarks: tuple[str, ...]
    turning: tuple[tuple[str, float], ...] = ()
    charts: int = 1
    singular: tuple[RelativeEquilibrium, ...] = ()
    beyond: tuple[RelativeEquilibrium, ...] = ()
