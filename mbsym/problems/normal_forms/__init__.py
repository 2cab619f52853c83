"""Problem 11: what terms of higher order decide where the first approximation (problem 6) does not.

The Lagrangian and the applied forces are expanded about the unperturbed motion to order 4 (6 where that is needed)
while they are built; cyclic coordinates without forces are left out with their momenta at the unperturbed values.
Constraints on positions are expanded with them, about a rest: dependent coordinates as series in the independent ones.

* Hamiltonian systems (no applied force beside the force function, or one with a generalized potential, as a magnetic
  field has by Helmholtz's conditions, proved: it is taken into the Lagrangian): Birkhoff's normal form

      H = sum Omega_k I_k + sum a_jk I_j I_k + ...,      Omega_k the frequencies with the signs of their energies

  All Omega_k of one sign: stable (Dirichlet).  Two degrees of freedom: stable where there is no resonance up to order
  4 and  D_4 = a_11 Omega_2^2 - a_12 Omega_1 Omega_2 + a_22 Omega_1^2  is not 0 (Arnold-Moser); where D_4 is not told
  from 0 order 6 is asked; |Omega_1| = 2 |Omega_2| and 3 |Omega_2|: Markeev's theorems; equal ones, with one
  eigenvector for each root or two, and a zero root: Sokolskii's.  More degrees of freedom: unstable where one resonance
  of third order alone holds, with a term that is not 0 and energies of which all may grow (Khazina, Markeev); else
  never more than formally stable (Bruno), or stable for most initial states (Arnold), unless H has a strict extremum
  along a zero root, too.
  Of two degrees of freedom D_4 and the resonances as formulas in parameters.
* With applied forces: one pair +-i w of roots, the others to the left: on the centre manifold r' = a r^3 + ... for the
  amplitude r; a < 0: asymptotically stable (a soft border), a > 0: unstable (hard); where a = 0 exactly (Bautin's
  point) the term of fifth order.  One zero root:
  u' = a2 u^2 + a3 u^3.  Two zero roots, more pairs: named.

Resonances, resonant terms of third order that cancel, and roots on the axis are decided exactly (rational numbers,
square roots), what is not zero by enclosures.
Every normal form is checked: its transformation is canonical, and H with it substituted is the normal form.

Source: G. D. Birkhoff (1927); V. I. Arnold (1963); J. Moser (1968); A. P. Markeev, Libration Points in Celestial
Mechanics and Space Dynamics (1978); A. D. Bruno (1967); J. Guckenheimer & P. Holmes (1983), section 3.4.

Example:

    >>> import mbsym
    >>> point = mbsym.load("systems/three-bodies.yaml").normal_forms
    >>> print(point.at_values.outcome, "by", point.at_values.theorem)
    stable by Arnold-Moser
"""
