"""The equations of a constrained system as one straight-line program.

    M q'' = f + J^T lambda        J q'' = -gamma,  gamma = J' q' + j'        phi(q, t) = 0,  J q' + j = 0

M and f are those of the open tree.  Which rows there are is decided over the ring (``rows.said_rows``); rows that
depend on others are among them, and whoever solves has to know it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mbsym.algebra.program import Node
from mbsym.algebra.ring import Ring
from mbsym.mechanics.constraints.rows import Row, RowName, constraint_rows
from mbsym.mechanics.kinematics import Scene
from mbsym.mechanics.programs import Programs, programs
from mbsym.model.system import System, acceleration_name


@dataclass(frozen=True)
class ConstrainedPrograms:
    """Nodes of one program: the open tree's in ``tree``, and the constraint rows.

    ``position`` is phi (None of a row that is given by velocities), ``velocity`` J q' + j, ``acceleration`` gamma,
    ``jacobian`` J (m x n), ``names`` what the rows are called.
    """

    tree: Programs
    names: tuple[RowName, ...]
    position: tuple[Node | None, ...]
    velocity: tuple[Node, ...]
    acceleration: tuple[Node, ...]
    jacobian: tuple[tuple[Node, ...], ...]

    @property
    def environment(self) -> Mapping[str, Node]:
        """The inputs, by their declared names."""
        return self.tree.environment


def constrained_programs(system: System, ring: Ring, selected: Sequence[tuple[int, int]]) -> ConstrainedPrograms:
    """M, f and the rows of ``selected`` (``rows.kept_rows`` of those over the ring) as straight-line code."""
    tree = programs(system, ring, open_tree=True)
    still = {acceleration_name(name): tree.program.zero for name in system.coordinates}
    rows = constraint_rows(Scene(system, tree.program, {**tree.environment, **still}, ring), selected)
    return ConstrainedPrograms(tree, *columns(rows))


def columns(
    rows: Sequence[Row],
) -> tuple[
    tuple[RowName, ...], tuple[Node | None, ...], tuple[Node, ...], tuple[Node, ...], tuple[tuple[Node, ...], ...]
]:
    """Names, phi, J q' + j, gamma and J of rows."""
    return (
        tuple(row.name for row in rows),
        tuple(row.position for row in rows),
        tuple(row.velocity for row in rows),
        tuple(row.acceleration for row in rows),
        tuple(row.partials for row in rows),
    )
