"""Problem 8: how an unstable motion may be stabilised, and what stands against it.  About the first approximation

    M x'' + (D + G) x' + (K + N) x = B u

* Gyroscopic forces.  Poincare's degree of instability is the number of negative eigenvalues of K, by Jacobi's rule the
  number of changes of sign in 1, Delta_1, ..., Delta_n.  Where it is odd no gyroscopic forces G make the motion stable
  (Kelvin-Chetaev); where it is even and not 0 problem 6 says at which parameters those of the system do.  Complete
  dissipation, however small, makes the motion unstable wherever K has a negative eigenvalue and det K != 0.
* Dissipation.  D >= 0 is pervasive if every motion that it does not feel (D x' = 0 at all times) is at rest:

      rank [ lambda^2 M + lambda G + K; D ] = n    for all lambda != 0

  (with K > 0, N = 0 that is necessary and sufficient for asymptotic stability).  Where it is not, the motion that stays
  undamped is told, and at which parameters a pervasive D ceases to be so.
* Control by the declared inputs: rank [ lambda^2 M + lambda (D + G) + K + N, B ] = n for all lambda (Hautus), the
  parameters at which it is lost, the smallest sets of inputs that suffice; at given values by Kalman's rank.  There a
  feedback u = -k (x, x') is found (LQR in floating point), rationalised, and proved by counting the roots of the
  closed loop exactly, and by a Lyapunov function with rational coefficients.
* Energies as Lyapunov functions: V = x'.M x'/2 + x.K x/2 has dV/dt = -x'.D x' where N = 0.  Where D = 0 and K is not
  positive definite, a combination of the integrals V(x), V(x'), V(x''), ... may be so (Chetaev's bundle).

Everything is about the linear equations; asymptotic stability and instability carry over to the nonlinear ones, the
feedback being the same (Lyapunov's first method).

Source: Thomson & Tait; N. G. Chetaev, The Stability of Motion (1961); D. R. Merkin, Introduction to the Theory of
Stability (1997), chapter 6; E. E. Zajac, The Kelvin-Tait-Chetaev theorem and extensions (1964), on pervasive damping;
Kalman, Hautus.

Example:

    >>> import mbsym
    >>> pole = mbsym.load("systems/cart-pole.yaml").stabilisation
    >>> pole.control[0].rank.full, pole.least
    (True, (('F',),))
"""
