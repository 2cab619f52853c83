"""Twelve scenes, each described for mbsym and written down once more by hand as x' = f(t, x).

The functions know nothing of mbsym: they are textbook equations in whatever arithmetic their arguments have, numbers or
power series.  ``solve.py`` integrates them at 200 bits and writes ``solutions.json``; where there is a closed form it
is taken in their place.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath

LINE = "mbsym: 1\nname: {name}\nbodies:\n"


@dataclass(frozen=True)
class Scene:
    """A description, how long it runs, and f by hand or the solution in closed form; ``start`` is (q, q') as text."""

    name: str
    text: str
    time: float
    start: tuple[str, ...]
    rates: Callable[[Any, Sequence[Any], Callable[[str], Any]], list[Any]] | None = None
    closed: Callable[[Any], list[Any]] | None = None


# --- a swinging Atwood machine (Tufillaro, Abbott & Griffiths, Am. J. Phys. 52 (1984) 895) ---

ATWOOD = """
mbsym: 1
name: swinging Atwood machine
bodies:
  - {name: counterweight, attached to: 0, connection point: [1, 0, r], mass: 3}
  - {name: string, attached to: 0, rotation: {axes: [2], angles: [theta]}, coordinates: [theta], mass: 0}
  - {name: bob, attached to: string, connection point: [0, 0, -r], mass: 1, coordinates: [r]}
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
initial: {r: 1, theta: pi/2}
"""


def atwood(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """(M + m) r'' = m r theta'^2 + g (m cos theta - M),  r theta'' = -2 r' theta' - g sin theta."""
    theta, r, omega, v = x
    g, big, small = n("9.81"), n("3"), n("1")
    return [
        omega,
        v,
        (-2 * v * omega - g * theta.sin()) / r,
        (small * r * omega * omega + g * (small * theta.cos() - big)) / (big + small),
    ]


# --- Kepler's ellipse with e = 9/10 from its pericentre ---

KEPLER = """
mbsym: 1
name: Kepler orbit
bodies:
  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, coordinates: [x, y]}
loads:
  - potential: -1/sqrt(x**2 + y**2)
initial: {x: 1/10, y: {position: 0, velocity: sqrt(19)}}
"""


def kepler(t: Any) -> list[Any]:
    e = mpmath.mpf(9) / 10
    mean = t - 2 * mpmath.pi * mpmath.floor(t / (2 * mpmath.pi))
    low, high = mpmath.mpf(0), 2 * mpmath.pi
    for _ in range(240):  # bisection cannot go wrong
        middle = (low + high) / 2
        low, high = (middle, high) if middle - e * mpmath.sin(middle) < mean else (low, middle)
    rate, minor = 1 / (1 - e * mpmath.cos(low)), mpmath.sqrt(1 - e * e)
    c, s = mpmath.cos(low), mpmath.sin(low)
    return [c - e, minor * s, -s * rate, minor * c * rate]


# --- an elastic pendulum ---

ELASTIC = """
mbsym: 1
name: elastic pendulum
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [2], angles: [theta]}, coordinates: [theta], mass: 0}
  - {name: bob, attached to: rod, connection point: [0, 0, -r], mass: 1/2, coordinates: [r]}
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
  - potential: 40*(r - 1)**2/2
initial: {theta: 1, r: 5/4}
"""


def elastic(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """r'' = r theta'^2 + g cos theta - (k/m)(r - L),  theta'' = -(2 r' theta' + g sin theta)/r."""
    theta, r, omega, v = x
    g = n("9.81")
    return [omega, v, -(2 * v * omega + g * theta.sin()) / r, r * omega * omega + g * theta.cos() - 80 * (r - 1)]


# --- Furuta's pendulum: an arm that turns, a pendulum at its end ---

FURUTA = """
mbsym: 1
name: Furuta pendulum
bodies:
  - name: arm
    attached to: 0
    rotation: {axes: [3], angles: [phi]}
    coordinates: [phi]
    mass: 1
    inertia about: mass centre
    inertia: {tensor: [[1/100, 0, 0], [0, 1/100, 0], [0, 0, 1/100]]}
  - name: pendulum
    attached to: arm
    connection point: [1/5, 0, 0]
    rotation: {axes: [1], angles: [theta]}
    coordinates: [theta]
    mass center: [0, 0, 3/10]
    mass: 1/10
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
initial: {phi: {position: 0, velocity: 2}, theta: 3/10}
"""


def furuta(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """The pendulum is at (a, -l sin theta, l cos theta) of the arm:

    (J + m a^2 + m l^2 s^2) phi'' - m a l c theta'' = -2 m l^2 s c phi' theta' - m a l s theta'^2
    -m a l c phi'' + m l^2 theta'' = m l^2 s c phi'^2 + m g l s
    """
    _, theta, spin, omega = x
    m, a, length, inertia, g = n("0.1"), n("0.2"), n("0.3"), n("0.01"), n("9.81")
    s, c = theta.sin(), theta.cos()
    first, mixed, second = inertia + m * a * a + m * length * length * s * s, -m * a * length * c, m * length * length
    one = -2 * m * length * length * s * c * spin * omega - m * a * length * s * omega * omega
    two = m * length * length * s * c * spin * spin + m * g * length * s
    bottom = first * second - mixed * mixed
    return [spin, omega, (second * one - mixed * two) / bottom, (first * two - mixed * one) / bottom]


# --- a chain of six masses on a line, stiff dampers between them ---

CHAIN = (
    "mbsym: 1\nname: stiff chain of six\nbodies:\n"
    + "".join(
        f"  - {{name: m{i}, attached to: 0, connection point: [x{i}, 0, 0], mass: 1, coordinates: [x{i}]}}\n"
        for i in range(1, 7)
    )
    + "loads:\n  - potential: "
    + "100/2*("
    + " + ".join(["x1**2", *(f"(x{i} - x{i - 1})**2" for i in range(2, 7))])
    + ")\n  - rayleigh: 2000/2*("
    + " + ".join(["x1_dot**2", *(f"(x{i}_dot - x{i - 1}_dot)**2" for i in range(2, 7))])
    + ")\ninitial: {x1: 0, x2: 0, x3: 0, x4: 0, x5: 0, x6: 1}\n"
)


def chain(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """x_i'' = k (x_(i+1) - 2 x_i + x_(i-1)) + c (...)', the first one tied to a wall, the last one free."""
    k, c = 100, 2000
    found = []
    for i in range(6):
        left, slow = (x[i - 1], x[6 + i - 1]) if i else (0, 0)
        force = k * (left - x[i]) + c * (slow - x[6 + i])
        if i < 5:
            force = force + k * (x[i + 1] - x[i]) + c * (x[6 + i + 1] - x[6 + i])
        found.append(force)
    return [*x[6:], *found]


# --- a beam of ten links with torsion springs and dampers, in a plane ---

LINKS = 10
_TURNS = ["q1", *(f"q{i} - q{i - 1}" for i in range(2, LINKS + 1))]
_RATES = ["q1_dot", *(f"q{i}_dot - q{i - 1}_dot" for i in range(2, LINKS + 1))]
BEAM = (
    "mbsym: 1\nname: beam of ten links\nbodies:\n"
    + "".join(
        f"  - {{name: b{i}, attached to: {f'b{i - 1}' if i > 1 else 0}, "
        f"connection point: [{'1/10' if i > 1 else '0'}, 0, 0], rotation: {{axes: [3], angles: [{_TURNS[i - 1]}]}}, "
        f"coordinates: [q{i}], mass center: [1/10, 0, 0], mass: 1/10}}\n"
        for i in range(1, LINKS + 1)
    )
    + "loads:\n  - uniform gravity: {vector: [0, -9.81, 0]}\n  - potential: 5*("
    + " + ".join(f"({turn})**2" for turn in _TURNS)
    + ")\n  - rayleigh: 1/50*("
    + " + ".join(f"({rate})**2" for rate in _RATES)
    + ")\ninitial: {"
    + ", ".join(f"q{i}: 0" for i in range(1, LINKS + 1))
    + "}\n"
)


def beam(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """Point masses m at the ends of links of length l, angles q_i to the horizontal, k = 10 and c = 1/25 in the joints:

    sum_j M_ij cos(q_i - q_j) q_j'' = -sum_j M_ij sin(q_i - q_j) q_j'^2 - m g l (N - i + 1) cos q_i + joints,
    M_ij = m l^2 (N - max(i, j) + 1)
    """
    count = LINKS
    q, w = list(x[:count]), list(x[count:])
    m, length, g, k, c = n("0.1"), n("0.1"), n("9.81"), 10, n("0.04")
    sines, cosines = [a.sin() for a in q], [a.cos() for a in q]
    rows, right = [], []
    for i in range(count):
        row, total = [], -m * g * length * (count - i) * cosines[i]
        for j in range(count):
            weight = m * length * length * (count - max(i, j))
            row.append(weight * (cosines[i] * cosines[j] + sines[i] * sines[j]))
            total = total - weight * (sines[i] * cosines[j] - cosines[i] * sines[j]) * w[j] * w[j]
        before, slower = (q[i - 1], w[i - 1]) if i else (0, 0)
        total = total - k * (q[i] - before) - c * (w[i] - slower)
        if i + 1 < count:
            total = total + k * (q[i + 1] - q[i]) + c * (w[i + 1] - w[i])
        rows.append(row)
        right.append(total)
    for p in range(count):  # Gauss; the matrix is positive definite
        for i in range(p + 1, count):
            part = rows[i][p] / rows[p][p]
            rows[i] = [a - part * b for a, b in zip(rows[i], rows[p], strict=True)]
            right[i] = right[i] - part * right[p]
    found: list[Any] = [None] * count
    for p in reversed(range(count)):
        total = right[p]
        for j in range(p + 1, count):
            total = total - rows[p][j] * found[j]
        found[p] = total / rows[p][p]
    return [*w, *found]


# --- van der Pol's oscillator ---

VAN_DER_POL = """
mbsym: 1
name: van der Pol
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: x**2/2
  - generalized force: {x: 100*(1 - x**2)*x_dot}
initial: {x: 2}
"""


def van_der_pol(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    return [x[1], 100 * (1 - x[0] * x[0]) * x[1] - x[0]]


# --- an oscillator that is hit for two milliseconds ---

PULSE = """
mbsym: 1
name: pulse
bodies:
  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - potential: x**2/2
  - generalized force: {x: 500*exp(-((t - 5)*1000)**2)}
initial: {x: 1}
"""


def pulse(t: Any) -> list[Any]:
    """x'' + x = p(t), p = 500 exp(-((t - 5)/w)^2), w = 1/1000: x = cos t + integral of sin(t - s) p(s)."""
    middle, far = mpmath.mpf(5), mpmath.mpf(1) / 50

    def push(s: Any) -> Any:
        return 500 * mpmath.exp(-(((s - 5) * 1000) ** 2))

    x, v = mpmath.cos(t), -mpmath.sin(t)
    if t > middle - far:
        end = min(t, middle + far)
        places = [middle - far + k * (end - middle + far) / 40 for k in range(41)]
        x += mpmath.quad(lambda s: mpmath.sin(t - s) * push(s), places)
        v += mpmath.quad(lambda s: mpmath.cos(t - s) * push(s), places)
    return [x, v]


# --- a particle that falls on a soft wall ---

CONTACT = """
mbsym: 1
name: soft contact
bodies:
  - {name: p, attached to: 0, connection point: [0, 0, z], mass: 1, coordinates: [z]}
loads:
  - potential: 9.81*z + 1/10*exp(-100*z)
initial: {z: 1}
"""


def contact(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    return [x[1], -n("9.81") + 10 * (-100 * x[0]).exp()]


# --- two pendulums, the second a millionth of the first ---

LIGHT = """
mbsym: 1
name: light pendulum on a heavy one
bodies:
  - name: heavy
    attached to: 0
    rotation: {axes: [2], angles: [a]}
    coordinates: [a]
    mass center: [0, 0, -1]
    mass: 1
  - name: light
    attached to: heavy
    connection point: [0, 0, -1]
    rotation: {axes: [2], angles: [b - a]}
    coordinates: [b]
    mass center: [0, 0, -1/2]
    mass: 1/1000000
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
initial: {a: 1, b: -1/2}
"""


def light(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """(M + m) L^2 a'' + m L l cos(a - b) b'' = -m L l sin(a - b) b'^2 - (M + m) g L sin a, and so on."""
    a, b, u, v = x
    g, big, small, long, short = n("9.81"), n("1"), n("0.000001"), n("1"), n("0.5")
    c, s = a.cos() * b.cos() + a.sin() * b.sin(), a.sin() * b.cos() - a.cos() * b.sin()
    first, mixed, second = (big + small) * long * long, small * long * short * c, small * short * short
    one = -small * long * short * s * v * v - (big + small) * g * long * a.sin()
    two = small * long * short * s * u * u - small * g * short * b.sin()
    bottom = first * second - mixed * mixed
    return [u, v, (second * one - mixed * two) / bottom, (first * two - mixed * one) / bottom]


# --- a fast top that nods ---

TOP = """
mbsym: 1
name: fast top
bodies:
  - name: top
    attached to: 0
    rotation: {axes: [3, 1, 3], angles: [phi, theta, psi]}
    coordinates: [phi, theta, psi]
    mass center: [0, 0, 1/10]
    mass: 1
    inertia about: joint
    inertia: {tensor: [[1/50, 0, 0], [0, 1/50, 0], [0, 0, 1/100]]}
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
initial: {phi: 0, theta: 1/2, psi: {position: 0, velocity: 200}}
"""


def top(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """C (psi' + phi' cos theta) = constant = C w; A theta'' = A phi'^2 s c - C w phi' s + m g l s, and
    A phi'' s = C w theta' - 2 A phi' theta' c.
    """
    _, theta, _, spin, nod, own = x
    s, c = theta.sin(), theta.cos()
    first, axial, weight = n("0.02"), n("0.01"), n("0.981")
    w = own + spin * c
    turn = (axial * w * nod - 2 * first * spin * nod * c) / (first * s)
    tilt = spin * spin * s * c - axial * w * spin * s / first + weight * s / first
    return [spin, nod, own, turn, tilt, spin * nod * s - turn * c]


# --- three links that move in a plane which lies askew in space ---

THREE = """
mbsym: 1
name: three links in a tilted plane
bodies:
  - {name: plane, attached to: 0, rotation: {axes: [1], angles: [pi/6]}, mass: 0}
  - name: one
    attached to: plane
    rotation: {axes: [3], angles: [q1]}
    coordinates: [q1]
    mass center: [1, 0, 0]
    mass: 1
  - name: two
    attached to: one
    connection point: [1, 0, 0]
    rotation: {axes: [3], angles: [q2 - q1]}
    coordinates: [q2]
    mass center: [1, 0, 0]
    mass: 1
  - name: three
    attached to: two
    connection point: [1, 0, 0]
    rotation: {axes: [3], angles: [q3 - q2]}
    coordinates: [q3]
    mass center: [1, 0, 0]
    mass: 1
loads:
  - uniform gravity: {vector: [0, 0, -9.81]}
initial: {q1: 0, q2: 1/2, q3: 1}
"""


def three(t: Any, x: Sequence[Any], n: Callable[[str], Any]) -> list[Any]:
    """Gravity in the plane is g sin(pi/6) along its second axis; M_ij = 4 - max(i, j) times cos(q_i - q_j)."""
    q, w, g = x[:3], x[3:], n("4.905")
    sines, cosines = [a.sin() for a in q], [a.cos() for a in q]
    rows, right = [], []
    for i in range(3):
        row, total = [], -g * (3 - i) * cosines[i]
        for j in range(3):
            weight = 3 - max(i, j)
            row.append(weight * (cosines[i] * cosines[j] + sines[i] * sines[j]))
            total = total - weight * (sines[i] * cosines[j] - cosines[i] * sines[j]) * w[j] * w[j]
        rows.append(row)
        right.append(total)

    def det(a: Sequence[Sequence[Any]]) -> Any:
        return (
            a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
            - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0])
            + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
        )

    bottom = det(rows)
    found = []
    for k in range(3):  # Cramer
        found.append(det([[right[i] if j == k else rows[i][j] for j in range(3)] for i in range(3)]) / bottom)
    return [*w, *found]


SCENES = (
    Scene("atwood", ATWOOD, 10.0, ("pi/2", "1", "0", "0"), atwood),
    Scene("kepler", KEPLER, 15.0, (), closed=kepler),
    Scene("elastic", ELASTIC, 20.0, ("1", "1.25", "0", "0"), elastic),
    Scene("furuta", FURUTA, 5.0, ("0", "0.3", "2", "0"), furuta),
    Scene("chain", CHAIN, 2.0, ("0", "0", "0", "0", "0", "1", "0", "0", "0", "0", "0", "0"), chain),
    Scene("beam", BEAM, 0.05, ("0",) * (2 * LINKS), beam),
    Scene("van der pol", VAN_DER_POL, 200.0, ("2", "0"), van_der_pol),
    Scene("pulse", PULSE, 20.0, (), closed=pulse),
    Scene("contact", CONTACT, 3.0, ("1", "0"), contact),
    Scene("light", LIGHT, 10.0, ("1", "-0.5", "0", "0"), light),
    Scene("top", TOP, 2.0, ("0", "0.5", "0", "0", "0", "200"), top),
    Scene("three", THREE, 5.0, ("0", "0.5", "1", "0", "0", "0"), three),
)
