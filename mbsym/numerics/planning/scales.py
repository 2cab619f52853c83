"""What the error of each entry of a quantity is measured by, in whatever units the description has.

Entries of like dimension are measured together by the largest of them, unlike ones each by itself.  Where such a group
vanishes or nearly does, by symmetry say, its size is what the kinetic metric makes of the others:

    M_ij       by sqrt(M_ii M_jj), which bounds it
    f_i        by at least RESTS N sqrt(M_ii),     N = max |f_j|/sqrt(M_jj)
    q''_i      by at least RESTS N/sqrt(M_ii),     N = max |q''_j| sqrt(M_jj)
    dq''/dq    by at least RESTS N sqrt(M_jj/M_ii), N the largest of them times sqrt(M_ii/M_jj); dq''/dq' likewise,
               N = omega^2 and omega of the same omega
    pivots     each by itself: they have different units

Every one changes with the units as the entry itself does, so digits and conditions do not change.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb

from mbsym.mechanics.variables import angle_denominators
from mbsym.model.system import System

#: A group smaller than this part of what the others would make it has no size of its own.
RESTS = 1e-6

Kinds = tuple[str, ...]


def kinds(system: System) -> Kinds:
    """Coordinates of one kind have one dimension: angles.  Whatever is not known to be alike counts as unlike."""
    angles = angle_denominators(system)
    return tuple("angle" if name in angles else name for name in system.coordinates)


def scales(name: str, values: Sequence[Any], masses: Sequence[Any], alike: Kinds) -> list[Any]:
    """One positive scale an entry, as exact balls; 0 where nothing has a size.

    ``values`` are the true entries, ``masses`` the diagonal of M there (empty: unknown).
    """
    sizes = [abs(x.mid()) for x in values]
    n = len(alike)
    weights = [x.mid().sqrt() if x.mid() > 0 else arb(0) for x in masses] or [arb(1)] * n
    if name == "mass matrix" and masses:
        return [weights[i] * weights[j] for i in range(n) for j in range(n)]
    if name == "forcing" and len(sizes) == n:
        return _grouped(sizes, list(alike), weights)
    if name == "accelerations" and len(sizes) == n:
        return _grouped(sizes, list(alike), [_inverse(w) for w in weights])
    if name == "Jacobian" and len(sizes) == 2 * n * n:
        return _slopes(sizes, alike, weights)
    if name in ("M", "D", "G", "K", "N") and len(sizes) == n * n:
        pairs = [(i, j) for i in range(n) for j in range(n)]
        groups = [tuple(sorted((alike[i], alike[j]))) for i, j in pairs]
        return _grouped(sizes, groups, [weights[i] * weights[j] for i, j in pairs])
    return sizes


def _inverse(x: Any) -> Any:
    return 1 / x if x > 0 else arb(0)


def _grouped(sizes: Sequence[Any], groups: Sequence[Any], usual: Sequence[Any], norm: Any = None) -> list[Any]:
    """The largest of each group, but at least RESTS * norm * usual; norm = max size/usual unless it is given."""
    if norm is None:
        norm = max((s / u for s, u in zip(sizes, usual, strict=True) if u > 0), default=arb(0))
    own: dict[Any, Any] = {}
    for size, group in zip(sizes, groups, strict=True):
        own[group] = max(own.get(group, arb(0)), size)
    found = []
    for size, group, unit in zip(sizes, groups, usual, strict=True):
        least = norm * unit
        scale = own[group] if own[group] >= least * RESTS else least
        found.append(max(scale, size).mid())
    return found


def _slopes(sizes: Sequence[Any], alike: Kinds, weights: Sequence[Any]) -> list[Any]:
    n = len(alike)
    entries = [(i, j) for i in range(n) for j in range(2 * n)]
    groups = [(alike[i], alike[j % n], j >= n) for i, j in entries]
    ratios = [weights[j % n] * _inverse(weights[i]) for i, j in entries]
    rates = [
        (s / u if j >= n else (s / u).sqrt()).mid()
        for s, u, (_, j) in zip(sizes, ratios, entries, strict=True)
        if u > 0
    ]
    omega = max(rates, default=arb(0))
    usual = [u * (omega if j >= n else omega * omega) for u, (_, j) in zip(ratios, entries, strict=True)]
    return _grouped(sizes, groups, usual, arb(1))
