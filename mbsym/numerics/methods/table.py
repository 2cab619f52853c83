"""Every method by its name.

compiled      rk4 (fixed step), rk45, dop853; stiff: rodas5p
conservative  midpoint, midpoint4, midpoint6 (fixed step)
SciPy         scipy-rk45, scipy-dop853; stiff: lsoda, radau, bdf
heyoka        taylor
"""

from __future__ import annotations

from mbsym.numerics.methods import library, runge_kutta, symplectic, taylor
from mbsym.numerics.methods.interface import Method
from mbsym.numerics.methods.landing import Landing

_FAMILIES: tuple[tuple[Method, ...], ...] = (
    tuple(runge_kutta.METHODS),
    tuple(symplectic.METHODS),
    tuple(taylor.METHODS),
    tuple(library.METHODS),
)

METHODS: dict[str, Method] = {method.traits.name: Landing(method) for family in _FAMILIES for method in family}

#: Those that keep to constraints, and quaternions and unit vectors at their lengths.
LED = tuple(name for name, method in METHODS.items() if method.traits.led)
