"""All kinds of savings, and the ledger of one run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from math import isfinite

import numpy as np

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure
from mbsym.analysis import Analysis
from mbsym.expressions.message import Message, joined
from mbsym.numerics.ledger import code, described, formulas, motion, plane
from mbsym.numerics.ledger.entry import OPERATIONS, Ledger, Measure, Saving
from mbsym.numerics.ledger.work import BUDGET, AccuracyGoal, TooDear, Work
from mbsym.numerics.methods.interface import Breakdown
from mbsym.numerics.planning.kinds import (
    AXES,
    CYCLIC,
    DEAD,
    DROPPED,
    ENTRIES,
    GRAVITY,
    LEFT_OUT,
    LINEARITY,
    MASSES,
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
from mbsym.numerics.planning.model_choice import PART, Scene, Tried, model_chosen, model_settled
from mbsym.numerics.planning.models import Model, parted
from mbsym.numerics.planning.plan import Accuracy
from mbsym.numerics.planning.planning import outlined

# What the equations leave out, held against an accuracy: the motion without it beside the motion with it.
#
# Both are those of ``mbsym simulate --accuracy``: the same models, the same measure of their errors, the same part of
# the accuracy that a model may take.  Where no accuracy is asked for only the size of what is dropped is estimated,
# which decides nothing.


#: Times at which two motions are compared, besides the steps between.
TIMES = 501


def gravity_orders(work: Work) -> Iterator[Saving]:
    """Terms of the Newtonian field above the chosen order: their size, or what they change of the motion."""
    found = list(described.gravity_orders(work))
    if work.wanted is None or not found:
        yield from found
        return
    scene = _scene(work, work.wanted)
    tried = None if scene is None else model_settled(scene, Model()).taken
    for saving in found:
        yield saving if tried is None else _held(saving, tried, work.wanted)


def simpler_model(work: Work) -> Iterator[Saving]:
    """What a run to the accuracy leaves out of the equations as well: all that is not linear, parameters, masses."""
    scene = None if work.wanted is None else _scene(work, work.wanted)
    if scene is None or work.wanted is None:
        return
    taken = model_chosen(scene).taken
    model = taken.model
    before = scene.rich.right_hand_side.operations
    measures = (Measure("operations of the right-hand side at these values", OPERATIONS, before, taken.operations),)
    why = Message("simulate --accuracy [[accuracy]] leaves it out", accuracy=f"{work.wanted.accuracy:g}")
    for kind, what in _left_out(scene, model):
        yield _held(Saving(kind, what, why, Certainty.ESTIMATED, measures), taken, work.wanted)


def _left_out(scene: Scene, model: Model) -> Iterator[tuple[str, tuple[str, ...]]]:
    if model.linear:
        yield LINEARITY, (Message("all that is not linear in the deviation"),)
    bodies, others = parted(scene.scenario, model)
    if bodies:
        yield MASSES, bodies
    if others:
        yield LEFT_OUT, others


def _scene(work: Work, wanted: AccuracyGoal) -> Scene | None:
    """The motion in outline; None without numbers, or where it does not come to the end."""
    if work.scenario is None:
        return None
    work.begin(work.price)
    try:
        return outlined(work.scenario, Accuracy(wanted.accuracy), np.linspace(0, wanted.time, TIMES))[0]
    except Breakdown:
        return None


def _held(saving: Saving, tried: Tried, wanted: AccuracyGoal) -> Saving:
    """A saving with what it changes of the motion, beside what a model may change at this accuracy."""
    tolerable = PART * wanted.accuracy
    if not isfinite(tried.worst):
        why = Message("[[why]]; what that changes of the motion could not be measured", why=saving.why)
        return replace(saving, why=joined(filter(None, (why, tried.why)), ": "), how=Certainty.UNDECIDED)
    word = Message("no more than" if tried.worst <= tolerable else "more than")
    text = (
        "until [[time]] it changes the motion by [[worst]] of its size, [[word]] the [[most]] that a model may at an "
        "accuracy of [[accuracy]]"
    )
    time, worst, most, accuracy = f"{wanted.time:g}", f"{tried.worst:.1e}", f"{tolerable:g}", f"{wanted.accuracy:g}"
    changed = Message(text, time=time, worst=worst, word=word, most=most, accuracy=accuracy)
    why = joined([saving.why, changed], "; ")
    return replace(saving, why=why, how=tried.how, error=tried.worst, tolerable=tolerable)


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
    GRAVITY: gravity_orders,
    LEFT_OUT: simpler_model,
}

#: Those that hold whatever constraints there are, and in any speeds: the others take the system for an open tree whose
#: velocities are those of its coordinates (no momentum is constant merely because L does not hold its coordinate).
OF_ANY_SYSTEM = frozenset((MASSLESS, POINTS, AXES, TURNS, ENTRIES, SUBSYSTEMS, NOT_ASKED))


def ledger(analysis: Analysis, budget: float = BUDGET, wanted: AccuracyGoal | None = None) -> Ledger:
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
