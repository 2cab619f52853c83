"""Cyclic coordinates, ignored after Routh."""

from __future__ import annotations

from mbsym.algebra.characteristic import Matrix, adjugate, determinant
from mbsym.problems.stability.linear_form import LinearSystem, is_zero
from mbsym.problems.stability.verdict import Verdict, concluded
from mbsym.problems.stability.words import Because, Fact, Reason


def only_momenta(system: LinearSystem) -> bool:
    """Whether all coordinates are cyclic and nothing acts on them: M q'' = 0."""
    idle = all(is_zero(matrix) for matrix in (system.D, system.G, system.K, system.N))
    return system.conservative and idle and not system.driven and len(system.cyclic) == system.size


def ignoring_cyclic(system: LinearSystem) -> LinearSystem:
    """Routh's reduction: cyclic velocities expressed by their momenta, where these are constant.

    With c the cyclic coordinates of ``with_constant_momenta`` and r the others,
    M_cc q_c' + M_cr q_r' + G_cr q_r = const gives::

        M_R = M_rr - M_rc W M_cr,   G_R = G_rr - M_rc W G_cr - G_rc W M_cr,   K_R = K_rr - G_rc W G_cr,   W = M_cc^-1

    and D_R = D_rr, N_R = N_rr; everything here times det M_cc > 0.  K_R is the second derivative of the effective
    potential.  Raises ValueError where the momenta are not constant.
    """
    if not momenta_are_constant(system):
        raise ValueError("Routh's reduction needs cyclic coordinates without D and N and no G between them, and others")
    cyclic = with_constant_momenta(system)
    rest = [i for i in range(system.size) if i not in cyclic]
    block = [[system.M[i][j] for j in cyclic] for i in cyclic]
    scale, inverse = determinant(block), adjugate(block)

    def schur(main: Matrix, *pairs: tuple[Matrix, Matrix]) -> Matrix:
        return tuple(
            tuple(
                scale * main[i][j]
                - sum(
                    (
                        left[i][c] * inverse[a][b] * right[d][j]
                        for left, right in pairs
                        for a, c in enumerate(cyclic)
                        for b, d in enumerate(cyclic)
                    ),
                    start=scale * 0,
                )
                for j in rest
            )
            for i in rest
        )

    m, g = system.M, system.G
    stiffness = schur(system.K, (g, g))  # with G between them an ignored coordinate makes another one felt
    return LinearSystem(
        schur(m, (m, m)),
        schur(system.D),
        schur(g, (m, g), (g, m)),
        stiffness,
        schur(system.N),
        system.conservative,
        cyclic=tuple(k for k, i in enumerate(rest) if i in system.cyclic and all(x == 0 for x in stiffness[k])),
        driven=tuple(k for k, i in enumerate(rest) if i in system.driven),
        turned=system.turned,
        names=tuple(system.name(i) for i in rest),
        exact=system.exact,
        # through G another momentum acts like a constant force: where nothing holds, that is more than a drift
        free=system.free and all(system.G[i][c] == 0 for i in rest for c in cyclic),
    )


def with_constant_momenta(system: LinearSystem) -> tuple[int, ...]:
    """The cyclic coordinates on which nothing acts; () where G is between them."""
    conserved = tuple(
        i
        for i in system.cyclic
        if i not in system.driven and all(x == 0 for matrix in (system.D, system.N) for x in matrix[i])
    )
    return () if any(system.G[i][j] != 0 for i in conserved for j in conserved) else conserved


def momenta_are_constant(system: LinearSystem) -> bool:
    """Whether there are such coordinates, and others."""
    return 0 < len(with_constant_momenta(system)) < system.size


#: What Lagrange's theorem needs where K is that of ``besides_cyclic``.
ENERGY_BESIDES = frozenset(
    {Fact.MASS_POSITIVE, Fact.POTENTIAL, Fact.STIFFNESS_POSITIVE, Fact.DAMPING_SEMIDEFINITE, Fact.ENERGY_NEVER_GROWS}
)


def energy_besides(system: LinearSystem) -> Verdict:
    """The verdict by ENERGY_BESIDES on what is not cyclic; where everything is, T is all of the energy."""
    alone = len(system.cyclic) == system.size
    return concluded(ENERGY_BESIDES, *((Reason(Because.VELOCITIES),) if alone else ()))


def besides_cyclic(system: LinearSystem) -> Matrix:
    """K of the coordinates that are not cyclic."""
    rest = [i for i in range(system.size) if i not in system.cyclic]
    return tuple(tuple(system.K[i][j] for j in rest) for i in rest)
