"""Proved enclosures of trajectories: balls that contain the exact solution of x' = f(t, x), step by step.

=============  ============================================================================================
``field``      f and its Jacobian over balls, over series of balls and over models
``model``      functions of complex time on a disc: a polynomial and a bound of the rest
``disc``       how far the solution is analytic: a disc of complex times, by Picard's operator
``segment``    one step: Taylor series about a point, its tail by Cauchy's estimate, the set carried along
``enclose``    many of them, with as many bits as the width that is wanted needs
``compare``    how far a computed trajectory is from the exact one; its events, proved one by one
=============  ============================================================================================

What is enclosed is the solution of the equations as they are integrated: irrational numbers of a description are
rounded to 256 bits (``mbsym.numerics.scenario``) there.
"""
