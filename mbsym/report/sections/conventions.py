"""The conventions that every formula keeps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from mbsym.report.content import Block, Heading, Said, paragraph

if TYPE_CHECKING:
    from mbsym.report.results import Results

_OF_BODIES = (
    Said("Direction cosines are passive, $v^k = R^{jk} v^j$; the new axes are the rows."),
    Said(
        "Axes $\\{a_1, a_2, a_3\\}$ with angles $\\{x_1, x_2, x_3\\}$ mean $R = C_{a_3}(x_3)\\, C_{a_2}(x_2)\\, "
        "C_{a_1}(x_1)$; axis $0$ means no rotation."
    ),
    Said("Vectors of body $k$ are in its own axes."),
    Said("The velocity of a connection point is $V_{O_k} = V_{O_j} + \\omega_j \\times r^j_{O_k} + V^j_{O_k}$."),
    Said(
        "An inertia tensor $\\Theta$ is that of $T = \\frac12\\, \\omega \\cdot \\Theta\\, \\omega$, so its products "
        "carry the minus sign."
    ),
    Said("$L = T + U$ with the force function $U = -(\\text{potential energy})$."),
)
_LINEAR = Said(
    "Linear form: $M \\ddot q + (D + G)\\, \\dot q + (K + N)\\, q = 0$ with $M$, $D$ (dissipative) and $K$ (potential) "
    "symmetric, $G$ (gyroscopic) and $N$ (circulatory) skew."
)


def content(results: Results) -> Iterator[Block]:
    """What reports say."""
    yield Heading("conventions", Said("Conventions"))
    said = (_LINEAR,) if results.system.linear else (*_OF_BODIES, _LINEAR)
    yield paragraph(*[part for sentence in said for part in (" ", sentence)][1:])
