"""Problem 12: small parameters: slow integral manifolds, oscillations, and motions averaged over a fast phase, exactly.

A description that says  small parameter: eps  (or gives powers of a name eps by which parameters are multiplied) and
has equations that are polynomial in positions and velocities:

    D x' = N(s, z, eps),      z = h_0(s) + h_1(s) eps + ... + h_n(s) eps^n,      s' = f_0(s) + f_1(s) eps + ...

Variables z whose derivatives grow without bound as eps tends to 0, and those that must be known with them, are fast.
The lowest order is solved by elimination; comparing coefficients of eps in the equations of invariance gives h exactly;
h, cut off, is put into the field at a random rational state, where what is left must be of order n + 1 or higher.
About a steady state the characteristic polynomial falls apart into that of the flow on the manifold and that of the
fast variables, whose Hurwitz minors decide by their first coefficients for all sufficiently small eps > 0.  Reports
expand to order 2, or 3 where order 2 does not decide; mbsym expand to any order.

Where the equations without eps have linear oscillations: the periodic motions near them (Poincare, Lindstedt),

    x = X_0(T) + eps X_1(T) + ...,      T' = omega (1 + eps nu_1 + ...),      X_n of period 2 pi in the phase T,

to order 2; mbsym oscillations has any order, and several phases.

A description with a prescribed phase whose rate is a parameter: the effective potential of what the phase shakes or
drives, as Kapitza's and a Paul trap's, with the orders of eps that are assumed, and problem 6 with it.  It is withdrawn
where the measurement contradicts it.

Relations between parameters are put in first: what follows from a scaled parameter is scaled with it, and a small
parameter that follows from others is refused.  Where all numbers are given the error is measured against a simulation
at eps, eps/2 and eps/4.

Source: V. V. Strygin and V. A. Sobolev, Separation of motions by the method of integral manifolds (1988);
E. Shchepakina, V. Sobolev and M. Mortell, Singular Perturbations (2014); A. H. Nayfeh, Perturbation Methods (1973);
P. L. Kapitza (1951).

Example:

    >>> import mbsym
    >>> found = mbsym.load("systems/satellite-with-damper-slow.yaml").small_parameters
    >>> print(found.slow.manifold.fast, found.slow.manifold.order)
    ('y', 'x') 3
"""
