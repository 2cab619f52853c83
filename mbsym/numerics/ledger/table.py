"""All kinds of savings, and the ledger of one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.numerics.ledger import code, described, formulas, motion
from mbsym.numerics.ledger.entry import Ledger, Saving
from mbsym.numerics.ledger.work import BUDGET, OutOfTime, Work

#: What each function looks for; the order is that of the ledger.
KINDS: Mapping[str, Callable[[Work], Iterator[Saving]]] = {
    "coordinates that rest": motion.resting_coordinates,
    "parts": motion.separate_parts,
    "massless bodies": described.massless_bodies,
    "point masses": described.point_masses,
    "unused axes": described.unused_axes,
    "constant rotations": described.constant_rotations,
    "cyclic coordinates": motion.cyclic_coordinates,
    "parameters that drop out": motion.dropped_parameters,
    "entries that vanish": formulas.vanishing_entries,
    "subsystems": formulas.subsystems,
    "outputs nobody asked for": formulas.problems_not_asked,
    "symmetry of M": code.symmetry,
    "sparsity of M": code.branch_sparsity,
    "route to q''": code.route,
    "dead instructions": code.dead_operations,
    "parameters only": code.steady_operations,
    "values": code.values,
    "order of gravity": described.gravity_orders,
}


def ledger(analysis: Analysis, seconds: float = BUDGET) -> Ledger:
    """What this run left out, why that is safe, and what it saved; call it when the run itself is over.

    ``seconds`` bound the counterfactuals together: none is begun that would probably exceed them.
    """
    work = Work(analysis, seconds)
    found: list[Saving] = []
    unmeasured = []
    for kind, savings in KINDS.items():
        try:
            found += [saving for saving in savings(work) if saving.saves]
        except OutOfTime:
            unmeasured.append(kind)
        except Failure:
            continue
    return Ledger(tuple(found), tuple(unmeasured))
