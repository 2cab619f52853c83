"""Constraints of a system: their rows, which of them are independent, degrees of freedom, what is integrable.

    phi(q, t) = 0             h independent ones, given as relations between coordinates
    J(q, t) q' + j(q, t) = 0  r independent ones in all: the derivatives of phi, and the velocity constraints

n - r velocities are free.  The velocity constraints follow from further relations between coordinates as far as they
are integrable: with k such relations the configurations have n - h - k dimensions.  Integrability is Frobenius' theorem
for the distribution q' = Y u + y0 (for constraints that depend on time, of (q, t)): the fields and their Lie brackets,
brackets of these and so on, span at a generic point a space of some dimension; what lacks to n is kept by the motion.

Ranks are those at generic points *of the constraint manifold*, random exact ones.  A rank that is reached at one point
is reached almost everywhere: that is proved.  That a row depends on others is proved where the ring says so, else it is
seen at several points.

Sources: F. R. Gantmacher, Lectures in Analytical Mechanics, sections 1-3 (constraints, virtual displacements); Ju. I.
Neimark & N. A. Fufaev, Dynamics of Nonholonomic Systems, chapter 1 (integrability by the Pfaffian forms).
"""
