"""Noether: symmetries that the choice of coordinates hides, and their first integrals.

A field  xi = S s + b  on the positions s (b_r and S_rj constants) and a shift of time tau move the system; with the
momenta p_r = dT/du_r, their rates R_r by the equations of motion, and  H = T_2 - T_0 - U,

    sum_r (xi_r R_r + xi'_r p_r) + tau dH/dt = dGamma/dt     gives     sum_r xi_r p_r + tau H - Gamma = const.

Directions r are generalised coordinates, or the declared speeds (then xi is a velocity in quasi-coordinates: a body
turns about its own axis, or, with xi = gamma, about an axis of space); Gamma is a polynomial of degree two in the
positions.  The constants are the kernel of a linear system: identities in the state, solved over the field of the
parameters.  The system may have forces without a force function: only the identity counts.

Found are cyclic coordinates in other coordinates (two discs on one shaft: both turn alike), axes of symmetry that are
no axes of the description (Lagrange's top in axes turned about), rotations of spaces that are no space of one body
(two oscillators of one frequency), helices (a shift of time with a rotation).  Not looked for: fields that are no
polynomials of degree one in the positions, a Gamma that is none of degree two in them, and what holds the time: free
fall (m z' + m g t), a free particle's centre (x - t x'), x'' = -3 x^2 y', y'' = 3 x^2 x' (y' - x^3).

How it is known: the identity in the exact ring; dI/dt on the motion once more, by substitution of the accelerations.
That there are no others of this kind: the rank of the system at exact random states, at numbers for the parameters.

Source: E. Noether, Invariante Variationsprobleme, Goett. Nachr. (1918); in quasi-coordinates H. Poincare, Sur une forme
nouvelle des equations de la mecanique, C. R. Acad. Sci. 132 (1901).

Example:

    >>> import mbsym
    >>> from mbsym.analysis.symmetric import symmetries_of
    >>> found = symmetries_of(mbsym.load("systems/spherical-pendulum.yaml"))
    >>> [(one.directions[0][0] if one.directions else "time", one.name) for one in found.symmetries]
    [('psi', 'momentum of psi'), ('time', 'generalised energy')]
"""
