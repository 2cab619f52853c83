"""A system whose motion is told in variables of its own: what a run integrates is y = (s, u).

s are the positions (coordinates, components of unit vectors and quaternions), u the speeds; y' = (g(s, u, t), u').
They stand where else coordinates and velocities do, and need be no pairs of these: three speeds go with four positions.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cached_property

from mbsym.model.system import System


@dataclass(frozen=True, repr=False)
class InStates(System):
    """``described`` seen in its own variables, ``positions`` s and ``own_speeds`` u by name."""

    described: System | None = None
    positions: tuple[str, ...] = ()
    own_speeds: tuple[str, ...] = ()

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """s."""
        return self.positions

    @cached_property
    def velocities(self) -> tuple[str, ...]:
        """u."""
        return self.own_speeds

    def with_field_order(self, order: int | str) -> System:
        """The same of what is described, seen in the same variables."""
        assert self.described is not None
        return in_states(self.described.with_field_order(order), self.positions, self.own_speeds)


def in_states(system: System, positions: tuple[str, ...], speeds: tuple[str, ...]) -> InStates:
    """The same system in these variables."""
    same = {field.name: getattr(system, field.name) for field in fields(System)}
    return InStates(**same, described=system, positions=positions, own_speeds=speeds)


def described(system: System) -> System:
    """The system as it was described."""
    return system.described if isinstance(system, InStates) and system.described is not None else system
