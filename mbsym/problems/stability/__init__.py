"""Problem 6: stability of the unperturbed motion, subsystem by subsystem.

For every subsystem  M x'' + (D + G) x' + (K + N) x = 0  of problem 5, in the user's dimensionless notation,

    Lambda(lambda) = det(lambda^2 M + lambda (D + G) + K + N)

is made primitive (a factor of known sign is removed) and factored; the conditions are

* only even powers of lambda: all roots in lambda^2 real, negative and simple (coefficients and discriminants);
* otherwise: all roots to the left of the imaginary axis (Lienard-Chipart).

Every condition has its logical place.  Where p > 0 is listed and p < 0, a root has a positive real part: p >= 0 is
necessary for stability.  That p is not 0 either is necessary for exponential stability, all roots to the left (second
kind): at p = 0 terms of higher order may make the motion stable, asymptotically even.  Of the first kind it is only
this method that needs it, as it needs roots that do not coincide: there the motion may be stable.  Of exactly linear
equations linear theory decides what equality does, where a parameter can be solved for on p = 0, and it is told with
the condition.  In potential systems coinciding roots do no harm: their discriminants are listed, and needed for
nothing.  K > 0 is sufficient where the energy does not grow.

"Necessary conditions hold" is not "stable": the verdict is a word of its own ('mbsym explain undecided' tells of one).
At numerical values it is decided exactly (irrational ones by enclosures).  A theorem is named where all its hypotheses
are shown, those on the nonlinear system included ('mbsym explain Kelvin-Chetaev' tells of one).  Where the equations of
motion are exactly linear (M constant, f of first degree in q and q', proved in the ring; whatever is given by its
matrices) no nonlinear system is left open.  A drift of bodies along directions on which nothing depends is told apart
then, as that of cyclic coordinates is.

"But for a drift of cyclic coordinates" is stability with respect to a part of the variables (V. V. Rumyantsev): the
other coordinates and all velocities.  Where cyclic momenta are constant what is asymptotic is so at given ones.

Displacements that change no equation are cyclic coordinates in every choice of coordinates (two masses on a ring move
on together); those with constant momenta are ignored after Routh.  A steady spin is judged in angles in which it is
steady, and the verdict says in which.

No verdict is given where terms of higher order hold t, or what grows with it, outside of sines and cosines: they are
not small at all times alike, as Lyapunov's theorems ask; nor where D is not 0 (or G and N are both there) and the rate
of a dimensionless time is not known to be positive.

Verdicts of subsystems combine to the weakest that they share: all asymptotically stable, or all with K > 0 under one
energy that does not grow (a damped part beside an undamped one: stable), or none of them dissipative; else critical.

At the values, what the first approximation leaves open is looked at in the nonlinear system: terms of higher order
where K has a null direction, combinations of first integrals with a definite second variation (Chetaev; sleeping
tops, free bodies, rotors), and the theorems of problem 11.  Claims, and every entry of a list of equilibria, are judged
so, too.

Source: Banshchikov & Vetrov, section 5, eqs (4) to (6); the theorems are those of Lagrange, Routh, Kelvin and Chetaev.

Example:

    >>> import mbsym
    >>> pendulum = mbsym.load("systems/simple-pendulum.yaml")
    >>> pendulum.stability.verdict.word, pendulum.stability.verdict.theorem
    ('asymptotically stable', 'Kelvin-Chetaev')
"""
