"""Symmetries and their integrals, as values."""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.certainty import Certainty
from mbsym.formulas.formula import Formula

#: The name of an integral that depends on those of problem 7 and of the list before it, at an exact random state.
DEPENDENT = "function of those before it"


@dataclass(frozen=True)
class Symmetry:
    """A field and its integral.

    ``directions``: (name of the coordinate or speed, xi_r) where that is not zero.  ``time``: tau, ``gauge``: Gamma.
    ``name``: the integral of problem 7 of which it is a multiple; FUNCTION of these; DEPENDENT; "" for others.
    ``sure``: how that is known (proved: by the rank of gradients at an exact state).
    ``substituted``: how dI/dt = 0 came out on the second route (proved: an identity; verified: at exact states).
    """

    directions: tuple[tuple[str, Formula], ...]
    time: Formula
    gauge: Formula
    integral: Formula
    name: str
    certainty: Certainty
    substituted: Certainty

    @property
    def is_new(self) -> bool:
        """Whether it is proved that problem 7 does not know it, as a function."""
        return not self.name and self.certainty is Certainty.PROVED


@dataclass(frozen=True)
class Symmetries:
    """A basis of the ``symmetries``; ``complete``: it is proved that every other is a combination of them.

    ``unknowns``: so many constants were free.  ``in_speeds``: directions are declared speeds.
    ``symbols``: some parameters have no numbers, and what is said holds for almost all their values.
    ``compared``: that is known by coefficients of independent functions, not by ranks at states.
    """

    symmetries: tuple[Symmetry, ...]
    complete: bool
    unknowns: int
    in_speeds: bool
    symbols: bool
    compared: bool = False

    @property
    def new(self) -> tuple[Symmetry, ...]:
        """Those that problem 7 does not list, nor functions of what it lists."""
        return tuple(one for one in self.symmetries if one.is_new)
