"""Dimensions as unknowns: every sum, equation and place of a description says something linear of their exponents.

A ``Form`` is a known dimension times powers of the unknown dimensions of names.  ``Inference`` solves the equations as
they come, by elimination over the rationals; one that contradicts those before is a slip.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from mbsym.model.units import NONE, Dimension, times


@dataclass(frozen=True, slots=True)
class Form:
    """``known`` times the product of the dimensions of names to the powers of ``unknown``."""

    known: Dimension = NONE
    unknown: tuple[tuple[str, Fraction], ...] = ()

    def times(self, other: Form, power: Fraction | int = 1) -> Form:
        powers = dict(self.unknown)
        for name, exponent in other.unknown:
            powers[name] = powers.get(name, Fraction(0)) + exponent * power
        kept = tuple((name, exponent) for name, exponent in sorted(powers.items()) if exponent)
        return Form(times(self.known, other.known, power), kept)

    def to_the(self, power: Fraction | int) -> Form:
        return Form().times(self, power)

    @property
    def is_number(self) -> bool:
        """Whether it is known to be without dimension."""
        return not self.known and not self.unknown


@dataclass
class Inference:
    """What is known of the dimensions of names so far."""

    solved: dict[str, Form] = field(default_factory=dict)

    def reduced(self, form: Form) -> Form:
        """A form with everything put in that is known."""
        while True:
            name = next((name for name, _ in form.unknown if name in self.solved), None)
            if name is None:
                return form
            power = dict(form.unknown)[name]
            rest = Form(form.known, tuple(one for one in form.unknown if one[0] != name))
            form = rest.times(self.solved[name], power)

    def equate(self, left: Form, right: Form) -> bool:
        """Takes ``left = right`` for true; False, and nothing is taken, where that contradicts what is known."""
        difference = self.reduced(left.times(right, -1))
        if not difference.unknown:
            return not difference.known
        name, power = difference.unknown[0]
        rest = Form(difference.known, difference.unknown[1:])
        self.solved[name] = rest.to_the(-1 / power)
        return True

    def dimension(self, name: str) -> Dimension | None:
        """The dimension of a name, if it follows."""
        form = self.reduced(Form(NONE, ((name, Fraction(1)),)))
        return None if form.unknown else form.known
