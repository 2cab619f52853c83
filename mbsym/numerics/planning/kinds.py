"""What a run may do without: one vocabulary of the ledger and the plan, and the options that switch each kind.

A kind that changes what is integrated has a switch: an option of ``mbsym simulate`` that keeps what was left out, or
takes it out, by hand.  The others are written differently, or never written, for the same numbers.
"""

from __future__ import annotations

from collections.abc import Mapping

# --- of both ---
GRAVITY = "order of gravity"
LINEARITY = "linear or nonlinear"
LEFT_OUT = "parameters left out"
MASSES = "negligible masses"
RESTING = "coordinates that rest"
PLANE = "plane motion"
PARTS = "separable parts"
WELDED = "welded bodies"

# --- of the plan alone: how, not what, is integrated ---
METHOD, FINENESS, SCALAR, KERNEL = "method", "tolerance", "arithmetic", "kernel"

# --- of the ledger alone ---
MASSLESS, POINTS, AXES = "massless bodies", "point masses", "unused axes"
TURNS = "constant rotations"
CYCLIC = "cyclic coordinates"
SKEW = "motion in a skew plane"
DROPPED = "parameters that drop out"
ENTRIES, SUBSYSTEMS, NOT_ASKED = "entries that vanish", "subsystems", "outputs nobody asked for"
SYMMETRY, SPARSITY, ROUTE = "symmetry of M", "sparsity of M", "route to q''"
DEAD, STEADY = "dead instructions", "parameters only"
ZEROS, VALUES = "values that are zero", "values put in"

#: Kinds that change what is integrated, with the option that settles each by hand.
SWITCHES: Mapping[str, str] = {
    GRAVITY: "--gravity",
    LINEARITY: "--linear",
    LEFT_OUT: "--without",
    MASSES: "--without",
    RESTING: "--whole",
    PLANE: "--whole",
    PARTS: "--whole",
    WELDED: "--whole",
}

#: Kinds that change the way of a run, with the option that settles each; one motion has one kernel.
WAYS: Mapping[str, str | None] = {
    METHOD: "--method",
    FINENESS: "--tolerance",
    SCALAR: "--arithmetic",
    KERNEL: None,
}

#: Kinds that change nothing of a motion but rounding: the same equations, with fewer instructions or none to write.
SAME_EQUATIONS = frozenset(
    (
        *(MASSLESS, POINTS, AXES, TURNS, CYCLIC, SKEW, DROPPED, ENTRIES, SUBSYSTEMS, NOT_ASKED),
        *(SYMMETRY, SPARSITY, ROUTE, DEAD, STEADY, ZEROS, VALUES),
    )
)
