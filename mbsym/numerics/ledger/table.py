"""All kinds of savings, and the ledger of one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.numerics.ledger import code, described, formulas, measured, motion, plane
from mbsym.numerics.ledger.entry import Ledger, Saving
from mbsym.numerics.ledger.work import BUDGET, TooDear, Wanted, Work
from mbsym.numerics.planning.kinds import (
    AXES,
    CYCLIC,
    DEAD,
    DROPPED,
    ENTRIES,
    GRAVITY,
    LEFT_OUT,
    MASSLESS,
    NOT_ASKED,
    PARTS,
    POINTS,
    RESTING,
    ROUTE,
    SKEW,
    SPARSITY,
    STEADY,
    SUBSYSTEMS,
    SYMMETRY,
    TURNS,
    VALUES,
    WELDED,
)

#: What each function looks for; the order is that of the ledger.
KINDS: Mapping[str, Callable[[Work], Iterator[Saving]]] = {
    RESTING: motion.resting_coordinates,
    PARTS: motion.separate_parts,
    WELDED: described.welded_bodies,
    MASSLESS: described.massless_bodies,
    POINTS: described.point_masses,
    AXES: described.unused_axes,
    TURNS: described.constant_rotations,
    SKEW: plane.skew_plane,
    CYCLIC: motion.cyclic_coordinates,
    DROPPED: motion.dropped_parameters,
    ENTRIES: formulas.vanishing_entries,
    SUBSYSTEMS: formulas.subsystems,
    NOT_ASKED: formulas.problems_not_asked,
    SYMMETRY: code.symmetry,
    SPARSITY: code.branch_sparsity,
    ROUTE: code.route,
    DEAD: code.dead_operations,
    STEADY: code.steady_operations,
    VALUES: code.values,
    GRAVITY: measured.gravity_orders,
    LEFT_OUT: measured.simpler_model,
}

#: Those that hold whatever constraints there are, and in any speeds: the others take the system for an open tree whose
#: velocities are those of its coordinates (no momentum is constant merely because L does not hold its coordinate).
OF_ANY_SYSTEM = frozenset((MASSLESS, POINTS, AXES, TURNS, ENTRIES, SUBSYSTEMS, NOT_ASKED))


def ledger(analysis: Analysis, budget: float = BUDGET, wanted: Wanted | None = None) -> Ledger:
    """What this run left out, why that is safe, and what it saved; call it when the run itself is over.

    ``budget`` bounds the counterfactuals together: counted work, and none is begun that would probably exceed it.  What
    the equations leave out is held against ``wanted``, an accuracy over a time.
    """
    work = Work(analysis, budget, wanted)
    found: list[Saving] = []
    unmeasured = []
    tied = bool(analysis.system.constraints or analysis.system.speeds)
    for kind, savings in KINDS.items():
        if tied and kind not in OF_ANY_SYSTEM:
            continue
        try:
            found += [saving for saving in savings(work) if saving.saves]
        except TooDear:
            unmeasured.append(kind)
        except Failure:
            continue
    return Ledger(tuple(found), tuple(unmeasured))
