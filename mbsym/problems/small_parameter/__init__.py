"""Small parameters: slow integral manifolds, exactly.

    D x' = N(s, z, eps),      z = h_0(s) + h_1(s) eps + ... + h_n(s) eps^n,      s' = f_0(s) + f_1(s) eps + ...

Variables z whose derivatives grow without bound as eps tends to 0, and those that must be known with them, are fast.
Comparing coefficients of eps in the equations of invariance gives h exactly (``slow``); h, cut off, is put into the
field at a random rational state, where what is left must be of order n + 1 or higher (``checks``).  About a steady
state the characteristic polynomial falls apart into that of the flow on the manifold and that of the fast variables,
whose Hurwitz minors decide by their first coefficients for all sufficiently small eps > 0 (``steady``).
"""
