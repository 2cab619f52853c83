"""Problem 10: steady motions and invariant manifolds, by families of integrals (Routh, Lyapunov).

Where V_0, V_1, ..., V_m are integrals of x' = X(x), so is  K = V_0 + lambda_1 V_1 + ... + lambda_m V_m,  and

    {x: grad K(x) = 0}

is carried into itself by the motion, for every choice of the multipliers.  These equations are taken apart exactly,
over the parameters and the multipliers, by what they are linear in: each branch is a family of
steady motions, or an invariant manifold with the motion on it.  The norms of unit vectors are integrals with
multipliers of their own.  Each set is checked without its derivation: d/dt of every equation of the set vanishes on the
set by the equations of motion.

Stability: a motion (or manifold) on which the second variation of K is definite on the level of the integrals is stable
(Routh's theorem with Lyapunov's complement): **sufficient**.  The roots of the first approximation beside it give what
is **necessary**; whether parameters lie between the two is tried at exact points.

Systems without speeds are taken in rates, sines and cosines of angles, and positions.  Cyclic coordinates do not occur
there: relative equilibria, as conical motions and precessions, are stationary.  sin^2 + cos^2 = 1 makes integrals of
the others, so its multipliers are Lagrange's, and need not be constant along a motion; they are eliminated.  What is
said is about places where the angles are regular; others are counted.

The integrals are those of problem 7, those that claims have proved, and polynomial ones up to twice the largest weight
of a variable (quadratic ones where all weights are 1); those that are functions of others are left out, and named.
A steady motion that is stationary for no such K is not listed.

All this holds for almost all parameters: polynomials in them that were divided by are listed and taken not to vanish.
Branches that the budget leaves aside are counted: then the list may be incomplete.

Source: E. J. Routh, A Treatise on the Stability of a Given State of Motion (1877); A. M. Lyapunov, On constant helical
motions of a body in a liquid (1888); V. D. Irtegov and T. N. Titorenko (families of first integrals).

Example:

    >>> import mbsym
    >>> clebsch = mbsym.load("systems/clebsch-poisson.yaml").invariant_sets
    >>> [one.kind.value for one in clebsch.families[0].sets].count("steady motions") >= 3
    True
"""
