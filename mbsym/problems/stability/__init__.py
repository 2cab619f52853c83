"""Problem 6: stability of the unperturbed motion, subsystem by subsystem.

For every subsystem  M x'' + (D + G) x' + (K + N) x = 0  of problem 5, in the user's dimensionless notation,

    Lambda(lambda) = det(lambda^2 M + lambda (D + G) + K + N)

is made primitive (a factor of known sign is removed) and factored; the conditions are

* only even powers of lambda: all roots in lambda^2 real, negative and simple (coefficients and discriminants);
* otherwise: all roots to the left of the imaginary axis (Lienard-Chipart).

"Necessary conditions hold" is not "stable": the verdict is one of asymptotically stable; stable (the theorem is named);
gyroscopically stabilised only; stable in first approximation only, critical; unstable; undecided.  With symbolic
parameters it comes as cases, and at numerical values it is decided exactly (irrational ones by enclosures).

Source: Banshchikov & Vetrov, section 5, eqs (4) to (6); the theorems are those of Lagrange, Routh, Kelvin and Chetaev.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.stability.verdict.word, pendulum.stability.verdict.theorem
    ('asymptotically stable', 'Kelvin-Chetaev')
"""

from __future__ import annotations

from mbsym.problems.stability.problem import (
    ExactVerdicts,
    Stability,
    SubsystemStability,
    parameter_values,
    stability,
)

__all__ = [
    "ExactVerdicts",
    "Stability",
    "SubsystemStability",
    "parameter_values",
    "stability",
]
