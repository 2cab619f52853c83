"""What a run may do without: one vocabulary of the ledger and the plan.

A kind that changes what is integrated has a switch: an option of ``mbsym simulate`` that keeps what was left out, or
takes it out, by hand.  The others are written differently, or never written, for the same numbers.
"""

from __future__ import annotations

from enum import StrEnum


class Kind(StrEnum):
    """What is left out, or chosen."""

    # of both
    GRAVITY = "order of gravity"
    LINEARITY = "linear or nonlinear"
    LEFT_OUT = "parameters left out"
    MASSES = "negligible masses"
    RESTING = "coordinates that rest"
    PLANE = "plane motion"
    PARTS = "separable parts"
    WELDED = "welded bodies"
    # of the plan alone: how, not what, is integrated
    METHOD = "method"
    FINENESS = "tolerance"
    SCALAR = "arithmetic"
    KERNEL = "kernel"
    # of the ledger alone
    MASSLESS = "massless bodies"
    POINTS = "point masses"
    AXES = "unused axes"
    TURNS = "constant rotations"
    CYCLIC = "cyclic coordinates"
    SKEW = "motion in a skew plane"
    DROPPED = "parameters that drop out"
    ENTRIES = "entries that vanish"
    SUBSYSTEMS = "subsystems"
    NOT_ASKED = "outputs nobody asked for"
    SYMMETRY = "symmetry of M"
    SPARSITY = "sparsity of M"
    ROUTE = "route to q''"
    DEAD = "dead instructions"
    STEADY = "parameters only"
    ZEROS = "values that are zero"
    VALUES = "values put in"
