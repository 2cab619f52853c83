"""Problem 9: polynomial first integrals of equations of motion.

Variables are speeds and direction cosines, rates, sines and cosines, positions, exponentials (Toda's lattice),
reciprocals (Calogero's particles) and square roots of these (Kepler's problem), and sines and cosines of driven phases.
Square roots of numbers are constants of the field.

Of  x' = P(x)/d  the polynomials f with  sum_i P_i df/dx_i = 0  (modulo the relations that all states keep) are the
kernel of a linear map on the monomials of one weighted degree.  The search goes through the weights w from below:

* the kernel modulo a prime, at random parameters, has at least the dimension that it has over QQ(parameters);
* products of integrals that are known already span a part of it, whose dimension modulo the prime is at most their own;
* where the two are equal there is no further one: absence is proved, for almost all parameters;
* where they are not, the monomials of a further integral are read off, its coefficients are found over QQ(parameters)
  and it is proved by substitution.

Positions that no equation contains are no variables: integrals that hold them are not looked for, which is said.

Weights are looked for under which the equations are quasi-homogeneous (Euler's and Poisson's: angular velocity 1,
unit vector 2; without forces that are linear in it 1): then each weight stands for itself. Rates, sines, cosines and
lengths have all the weight 1. Of two unit vectors of one
body, perpendicular to each other, what holds for any lengths and angles is found, and that unit vectors have no
others is proved modulo their relations; lengths and products of theirs are told as such. Integrals are told apart as
functions by the rank of their gradients at a random state.

Particular integrals have derivatives that vanish where another one does: df/dt = K V, or where it has another value:
df/dt = K (V - c), with c found. Where the equations are quasi-homogeneous and nothing else has a value of its own
there are none of these for c not zero, which scaling proves. Darboux polynomials divide their own, df/dt = K f, and a
motion that begins on f = 0 stays there: ``mbsym integrals --relations`` finds them, as Hess and Appelrot's A x0 p + C
z0 r, or proves that there are none; with ``--vary``, at which values of a parameter there are more of them. ``mbsym
integrals`` asks more: at which values of a parameter, or under which conditions on parameters, there are others (of
gyrostats, too, whose equations a further constant variable makes quasi-homogeneous). ``mbsym symmetries`` finds those
of symmetries whose fields are of degree one in the positions, polynomial or not; ``mbsym simulate --invariants``
watches what is found.

Source: H. Yoshida, Necessary condition for the existence of algebraic first integrals, Celest. Mech. 31 (1983), on
weights; the integrals themselves are those of Euler, Lagrange, Kovalevskaya and Clebsch.

Example:

    >>> import mbsym
    >>> found = mbsym.load("systems/clebsch-poisson.yaml").polynomial_integrals.integrals
    >>> [(one.weight, one.name) for one in found.generators if one.is_new], found.complete
    ([(2, '')], True)
"""
