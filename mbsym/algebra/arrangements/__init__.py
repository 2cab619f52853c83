"""Exact arrangements of algebraic curves in a box of the plane, and of surfaces in one of space."""

from mbsym.algebra.arrangements.arrangement import Arc, Arrangement, Corner, CornerKind, Region, areas, polyline
from mbsym.algebra.arrangements.decomposition import decompose
from mbsym.algebra.arrangements.space import critical_levels
