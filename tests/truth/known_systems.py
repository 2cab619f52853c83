"""Systems solved by hand: how their motion behaves, what is conserved, and where they can rest.

The comment at each says why.  None of these answers was taken from mbsym.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp
from truth.statements import Known, State

PI = math.pi


def one(name: str, loads: str, nature: str, acceleration=None, extra: str = "", **more) -> Known:  # type: ignore[no-untyped-def]
    """A unit point mass on a line: x'' = acceleration(t, x, x')."""
    text = (
        "mbsym: 1\nname: one\nbodies:\n  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, "
        f"coordinates: [x]}}\nloads:\n{loads}motion: {{x: 0}}\n{extra}"
    )
    return Known(name, text, nature, motion=None if acceleration is None else solved(acceleration), **more)


def solved(acceleration):  # type: ignore[no-untyped-def]
    """(t, start) -> state of q'' = acceleration(t, q, q'), by integration of the equation written by hand."""

    def motion(time: float, start: State) -> State:
        n = len(start) // 2

        def rate(t: float, y: State) -> State:
            return np.concatenate([y[n:], np.atleast_1d(acceleration(t, *np.split(y, 2)))])

        if time == 0:
            return start
        found: State = solve_ivp(rate, (0, time), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        return found

    return motion


def potential(formula: str) -> str:
    return f'  - potential: "{formula}"\n'


def rayleigh(formula: str) -> str:
    return f'  - rayleigh: "{formula}"\n'


def force(formula: str) -> str:
    return f'  - generalized force: {{x: "{formula}"}}\n'


SPRING = potential("x**2/2")

LINE = [
    one("spring", SPRING, "stable", lambda t, x, v: -x),
    one("negative spring", potential("-x**2/2"), "unstable", lambda t, x, v: x),
    # a strict minimum of the potential (Lagrange-Dirichlet), whatever its order
    one("quartic well", potential("x**4/4"), "stable", lambda t, x, v: -(x**3)),
    one("sextic well", potential("x**6/6"), "stable", lambda t, x, v: -(x**5)),
    # one degree of freedom, no minimum: the energy integral solves it, the motion leaves
    one("quartic hill", potential("-x**4/4"), "unstable, critical", lambda t, x, v: x**3),
    one("cubic slope", potential("x**3/3"), "unstable, critical", lambda t, x, v: -(x**2)),
    one("spring with a cubic force", potential("x**2/2 - x**4/4"), "stable", lambda t, x, v: x**3 - x),
    # energy falls, and nothing but rest keeps it
    one("damped spring", SPRING + rayleigh("x_dot**2/2"), "asymptotic", lambda t, x, v: -x - v),
    one("damped hill", potential("-x**2/2") + rayleigh("x_dot**2/2"), "unstable", lambda t, x, v: x - v),
    one("pushed spring", SPRING + rayleigh("-x_dot**2/2"), "unstable", lambda t, x, v: -x + v),
    # cubic friction: E' = -x'^4 (LaSalle: asymptotic); turned round it pushes: E' = x'^4
    one("cubic friction", SPRING + rayleigh("x_dot**4/4"), "asymptotic", lambda t, x, v: -x - v**3),
    one("cubic push", SPRING + rayleigh("-x_dot**4/4"), "unstable, critical", lambda t, x, v: -x + v**3),
    one("push alone", rayleigh("-x_dot**4/4"), "unstable, critical", lambda t, x, v: v**3, decided=False),
    # x' is reduced by friction alone, x stays where it comes to rest: stable, not asymptotically
    one("friction alone", rayleigh("x_dot**2/2"), "asymptotic, displaced", lambda t, x, v: -v),
    one("van der Pol", SPRING + force("(1 - x**2)*x_dot"), "unstable", lambda t, x, v: -x + (1 - x**2) * v),
    one("van der Pol turned", SPRING + force("-(1 - x**2)*x_dot"), "asymptotic", lambda t, x, v: -x - (1 - x**2) * v),
    # E' = -x^2 x'^2: stable, and rest alone stays: asymptotic, beyond the first approximation
    one("van der Pol's border", SPRING + force("-x**2*x_dot"), "asymptotic",
        lambda t, x, v: -x - x**2 * v),
    one("van der Pol's border, pushed", SPRING + force("x**2*x_dot"), "unstable, critical",
        lambda t, x, v: -x + x**2 * v),
    # a flat well: E = x'^2/2 + x^4/4, E' = -x^2 x'^2 or -x'^4, which vanishes along no level of E: asymptotic; turned
    # round E grows: unstable.  Of a flat hill E falls from below 0, or grows from above it: unstable either way
    one("flat well, friction away from 0", potential("x**4/4") + force("-x**2*x_dot"), "asymptotic",
        lambda t, x, v: -(x**3) - x**2 * v),
    one("flat well, cubic friction", force("-x**3 - x_dot**3"), "asymptotic", lambda t, x, v: -(x**3) - v**3),
    one("flat well, cubic push", force("-x**3 + x_dot**3"), "unstable, critical", lambda t, x, v: -(x**3) + v**3),
    one("flat hill, cubic friction", force("x**3 - x_dot**3"), "unstable, critical", lambda t, x, v: x**3 - v**3),
    one("flat hill, cubic push", force("x**3 + x_dot**3"), "unstable, critical", lambda t, x, v: x**3 + v**3),
    one("cubic slope, friction away from 0", force("-x**2 - x**2*x_dot"), "unstable, critical",
        lambda t, x, v: -(x**2) - x**2 * v),
    # V = 3 (1 - cos x) - 3 x^2/2 + a x^4/4: at a = 1/2 it is x^6/240 + ..., below that a maximum
    one("flat well of two loads", potential("3*(1 - cos(x))") + force("3*x - a*x**3 - x**2*x_dot"), "asymptotic",
        lambda t, x, v: -3 * np.sin(x) + 3 * x - x**3 / 2 - x**2 * v, "parameters: {a: real}\nvalues: {a: 1/2}\n"),
    one("flat hill of two loads", potential("3*(1 - cos(x))") + force("3*x - a*x**3 - x**2*x_dot"),
        "unstable, critical", lambda t, x, v: -3 * np.sin(x) + 3 * x - 0.4 * x**3 - x**2 * v,
        "parameters: {a: real}\nvalues: {a: 0.4}\n"),
    # friction that may vanish: at c = 0 the energy is kept
    one("no cubic friction", SPRING + rayleigh("c*x_dot**4/4"), "stable", lambda t, x, v: -x,
        "parameters: {c: nonnegative}\nvalues: {c: 0}\n"),
    # a Hopf border: a = 0 leaves the quartic term alone
    one("subcritical border", SPRING + rayleigh("a*x_dot**2/2 - b*x_dot**4/4"), "unstable, critical",
        lambda t, x, v: -x + v**3, "parameters: {a: real, b: positive}\nvalues: {a: 0, b: 1}\n"),
    one("supercritical border", SPRING + rayleigh("a*x_dot**2/2 + b*x_dot**4/4"), "asymptotic",
        lambda t, x, v: -x - v**3, "parameters: {a: real, b: positive}\nvalues: {a: 0, b: 1}\n"),
    # friction to the right, a push to the left: the energy is no Lyapunov function (the symmetry x, t -> -x, -t makes
    # it a centre all the same, which no theorem of mbsym knows)
    one("friction to the right only", SPRING + rayleigh("x*x_dot**2/2"), "open, critical", lambda t, x, v: -x - x * v),
    Known("free", "mbsym: 1\nname: free\nbodies:\n  - {name: p, attached to: 0, connection point: [x, 0, 0], mass: 1, "
        "coordinates: [x]}\nmotion: {x: 0}\n", "drifts", motion=solved(lambda t, x, v: 0 * x)),
    # V' = 8 x + 1 - 1/(1 + x) vanishes at x = -9/8, too, where V is not real
    one("beside the wall of a logarithm", potential("4*x**2 + x - log(1 + x)"), "stable",
        lambda t, x, v: 1 / (1 + x) - 1 - 8 * x, rests=[[0.0]]),
    one("driven", SPRING + force("sin(t)"), "time-dependent", lambda t, x, v: -x + np.sin(t)),
    one("weak spring in time", potential("(2 + cos(t))*x**2/2"), "time-dependent",
        lambda t, x, v: -(2 + np.cos(t)) * x),
    one("border by assumption", potential("a*x**2/2"), "stable", None,
        "parameters: {a: real}\nassumptions: [a > 1]\nvalues: {a: 3}\n"),
]  # fmt: skip


def pendulum(name: str, loads: str, motion: str, nature: str, acceleration=None, extra: str = "", **more) -> Known:  # type: ignore[no-untyped-def]
    """m = l = 1 hanging at q = 0, gravity 1 (if it is among the loads)."""
    text = (
        "mbsym: 1\nname: pendulum\nbodies:\n  - {name: p, attached to: 0, rotation: {axes: [3], angles: [q]}, "
        f"mass centre: [0, -1, 0], mass: 1}}\nloads:\n{loads}motion: {{q: {motion}}}\n{extra}"
    )
    return Known(name, text, nature, motion=None if acceleration is None else solved(acceleration), **more)


GRAVITY = "  - uniform gravity: {vector: [0, -1, 0]}\n"
BACK = {"rests": [[0.0], [PI]]}

PENDULUMS = [
    pendulum("pendulum", GRAVITY, "0", "stable", lambda t, q, v: -np.sin(q), **BACK),
    pendulum("pendulum upright", GRAVITY, "pi", "unstable", lambda t, q, v: -np.sin(q), **BACK),
    pendulum("damped pendulum", GRAVITY + "  - damper: {coordinate: q, coefficient: 1}\n", "0", "asymptotic",
             lambda t, q, v: -np.sin(q) - v, **BACK),
    pendulum("damped pendulum upright", GRAVITY + "  - damper: {coordinate: q, coefficient: 1}\n", "pi", "unstable",
             lambda t, q, v: -np.sin(q) - v, **BACK),
    # a constant torque 1/2: sin q = 1/2
    pendulum("pendulum under a torque", GRAVITY + '  - potential: "-q/2"\n', "pi/6", "stable",
             lambda t, q, v: 0.5 - np.sin(q), rests=[[PI / 6], [5 * PI / 6]]),
    pendulum("the other side of the torque", GRAVITY + '  - potential: "-q/2"\n', "5*pi/6", "unstable",
             lambda t, q, v: 0.5 - np.sin(q), rests=[[PI / 6], [5 * PI / 6]]),
    # torque 1: the two rests meet at pi/2, an inflexion of the potential
    pendulum("pendulum at its last torque", GRAVITY + '  - potential: "-q"\n', "pi/2", "unstable, critical",
             lambda t, q, v: 1 - np.sin(q)),
    # upright on a torsional spring k: V = k q^2/2 + cos q
    pendulum("upright, strong spring", '  - uniform gravity: {vector: [0, 1, 0]}\n  - potential: "q**2"\n', "0",
             "stable", lambda t, q, v: np.sin(q) - 2 * q, rests=[[0.0]]),
    pendulum("upright, weak spring", '  - uniform gravity: {vector: [0, 1, 0]}\n  - potential: "q**2/4"\n', "0",
             "unstable", lambda t, q, v: np.sin(q) - q / 2,
             rests=[[0.0], [1.895494267033981], [-1.895494267033981]]),
    # k = 1: V = 1 + q^4/24 + ...: a strict minimum
    pendulum("upright, just held", '  - uniform gravity: {vector: [0, 1, 0]}\n  - potential: "q**2/2"\n', "0", "stable",
             lambda t, q, v: np.sin(q) - q, rests=[[0.0]]),
]  # fmt: skip


def hoop(speed: str, where: str, nature: str, rests: list[list[float]], decided: bool = True) -> Known:
    """A bead on a hoop of radius 1 that turns about its vertical diameter: q'' = sin q (w^2 cos q - 1)."""
    w = float(speed)
    text = (
        f"mbsym: 1\nname: hoop\nprescribed: {{chi: {{rate: {speed}}}}}\nbodies:\n"
        "  - {name: hoop, attached to: 0, rotation: {axes: [3], angles: [chi]}, mass: 0}\n"
        "  - {name: bead, attached to: hoop, rotation: {axes: [1], angles: [q]}, mass centre: [0, 0, -1], mass: 1}\n"
        f"loads:\n  - uniform gravity: {{vector: [0, 0, -1]}}\nmotion: {{q: {where}}}\n"
    )
    return Known(
        f"hoop {speed} at {where}",
        text,
        nature,
        decided,
        solved(lambda t, q, v: np.sin(q) * (w * w * np.cos(q) - 1)),
        rests,
    )


_BELOW = [[0.0], [PI]]
_ABOVE = [[0.0], [PI], [math.acos(1 / 4)], [-math.acos(1 / 4)]]
HOOPS = [
    hoop("0.5", "0", "stable", _BELOW),
    hoop("0.5", "pi", "unstable", _BELOW),
    hoop("2", "0", "unstable", _ABOVE),
    hoop("2", "pi", "unstable", _ABOVE),
    # w = 1: the effective potential -cos q - sin^2 q/2 = const + q^4/8 + ...
    hoop("1", "0", "stable", _BELOW),
]


def plane(name: str, loads: str, nature: str, acceleration=None, extra: str = "", **more) -> Known:  # type: ignore[no-untyped-def]
    """A unit point mass in a plane, at the origin."""
    text = (
        "mbsym: 1\nname: plane\nbodies:\n  - {name: p, attached to: 0, connection point: [x, y, 0], mass: 1, "
        f"coordinates: [x, y]}}\nloads:\n{loads}motion: {{x: 0, y: 0}}\n{extra}"
    )
    return Known(name, text, nature, motion=None if acceleration is None else solved(acceleration), **more)


def forces(x: str, y: str) -> str:
    return f'  - generalized force: {{x: "{x}", y: "{y}"}}\n'


PLANES = [
    plane("bowl", potential("(x**2 + y**2)/2"), "stable", lambda t, q, v: -q),
    plane("saddle", potential("(x**2 - y**2)/2"), "unstable", lambda t, q, v: np.array([-q[0], q[1]])),
    # a hill held up by gyroscopic forces: g^2 > 4; linear, so it is stable, but not by its energy
    plane("hill with gyroscopic forces", potential("-(x**2 + y**2)/2") + forces("3*y_dot", "-3*x_dot"),
          "stable, gyroscopic", lambda t, q, v: np.array([q[0] + 3 * v[1], q[1] - 3 * v[0]]), decided=False),
    plane("hill with weak gyroscopic forces", potential("-(x**2 + y**2)/2") + forces("y_dot", "-x_dot"), "unstable",
          lambda t, q, v: np.array([q[0] + v[1], q[1] - v[0]])),
    # complete dissipation destroys gyroscopic stabilisation (Kelvin-Chetaev)
    plane("damped hill with gyroscopic forces",
          potential("-(x**2 + y**2)/2") + forces("3*y_dot", "-3*x_dot") + rayleigh("(x_dot**2 + y_dot**2)/20"),
          "unstable", lambda t, q, v: np.array([q[0] + 3 * v[1], q[1] - 3 * v[0]]) - v / 10),
    # circulatory forces: d^2 k > n^2 or not
    plane("circulatory, well damped",
          potential("(x**2 + y**2)/2") + rayleigh("(x_dot**2 + y_dot**2)/2") + forces("-y/2", "x/2"), "asymptotic",
          lambda t, q, v: -q - v + 0.5 * np.array([-q[1], q[0]])),
    plane("circulatory, badly damped",
          potential("(x**2 + y**2)/2") + rayleigh("(x_dot**2 + y_dot**2)/2") + forces("-2*y", "2*x"), "unstable",
          lambda t, q, v: -q - v + 2 * np.array([-q[1], q[0]])),
    # one direction is damped, the other not: energy falls, but y swings on
    plane("half damped", potential("(x**2 + y**2)/2") + rayleigh("x_dot**2/2"), "stable",
          lambda t, q, v: -q - np.array([v[0], 0])),
    # the damped direction is coupled to the other one: nothing swings on
    plane("pervasively damped", potential("x**2 + y**2 + x*y") + rayleigh("x_dot**2/2"), "asymptotic",
          lambda t, q, v: -np.array([2 * q[0] + q[1], 2 * q[1] + q[0]]) - np.array([v[0], 0])),
    # E' = -y'^2: where y rests x^2 is constant, so that all rests, beyond the first approximation; but along y = 0 the
    # other one swings on
    plane("damped beside, moved by a square", potential("(x**2 + 4*y**2)/2 + x**2*y") + rayleigh("y_dot**2/2"),
          "asymptotic", lambda t, q, v: np.array([-q[0] - 2 * q[0] * q[1], -4 * q[1] - q[0] ** 2 - v[1]])),
    plane("damped beside, moving by a square", potential("(x**2 + 3*y**2)/2 + x*y**2") + rayleigh("y_dot**2/2"),
          "stable", lambda t, q, v: np.array([-q[0] - q[1] ** 2, -3 * q[1] - 2 * q[0] * q[1] - v[1]])),
    # both directions equal: the combination x = y swings without touching the damper between them
    plane("equal masses, damper between", potential("(x**2 + y**2)/2") + rayleigh("(x_dot - y_dot)**2/2"), "stable",
          lambda t, q, v: -q - np.array([v[0] - v[1], v[1] - v[0]])),
    # internal friction of a shaft that turns faster (2) than its frequency (1), cubic: it pushes the whirl
    plane("cubic friction in a fast shaft",
          potential("(x**2 + y**2)/2") + rayleigh("((x_dot + 2*y)**2 + (y_dot - 2*x)**2)**2/4"), "unstable, critical",
          decided=False),
    plane("linear friction in a fast shaft",
          potential("(x**2 + y**2)/2") + rayleigh("((x_dot + 2*y)**2 + (y_dot - 2*x)**2)/2"), "unstable",
          lambda t, q, v: -q - np.array([v[0] + 2 * q[1], v[1] - 2 * q[0]])),
    plane("linear friction in a slow shaft",
          potential("(x**2 + y**2)/2") + rayleigh("((x_dot + y/2)**2 + (y_dot - x/2)**2)/2"), "asymptotic",
          lambda t, q, v: -q - np.array([v[0] + q[1] / 2, v[1] - q[0] / 2])),
    # a minimum at which K is singular in y
    plane("trough with a quartic floor", potential("x**2/2 + y**4/4"), "stable",
          lambda t, q, v: -np.array([q[0], q[1]**3])),
    # an isolated minimum; friction takes energy from every motion, or from those across the line x = 0 alone
    plane("round quartic bowl, damped", potential("(x**2 + y**2)**2") + rayleigh("(x_dot**2 + y_dot**2)/2"),
          "asymptotic", lambda t, q, v: -4 * np.sum(q * q) * q - v),
    plane("round quartic bowl, half damped", potential("(x**2 + y**2)**2") + rayleigh("x_dot**2/2"), "stable",
          lambda t, q, v: -4 * np.sum(q * q) * q - np.array([v[0], 0])),
    plane("the same by one force", forces("-4*(x**2 + y**2)*x - x_dot", "-4*(x**2 + y**2)*y"), "stable",
          lambda t, q, v: -4 * np.sum(q * q) * q - np.array([v[0], 0])),
    plane("trough with a quartic crest", potential("x**2/2 - y**4/4"), "unstable, critical", decided=False),
    # rests fill a line, along which one root is zero, all others are to the left (Lyapunov-Malkin)
    plane("trough that narrows, damped", potential("x**2/2 + x**2*y**2") + rayleigh("(x_dot**2 + y_dot**2)/2"),
          "asymptotic, beside other rests",
          lambda t, q, v: -np.array([q[0] + 2 * q[0] * q[1]**2, 2 * q[0]**2 * q[1]]) - v),
    plane("skew trough that narrows, damped", potential("(x - y)**2*(1 + y)") + rayleigh("(x_dot**2 + y_dot**2)/2"),
          "asymptotic, beside other rests"),
    # no trough: along x = -y^3 the potential is -y^6/2
    plane("no trough, damped", potential("x**2/2 + x*y**3") + rayleigh("(x_dot**2 + y_dot**2)/2"),
          "unstable, critical", decided=False),
    # equations that do not know each other: what one of them does the whole does, whatever the other
    plane("cubic slope beside a damped spring", potential("x**2/2 + y**3/3") + rayleigh("x_dot**2/2"),
          "unstable, critical", lambda t, q, v: -np.array([q[0] + v[0], q[1]**2])),
    plane("pushed border beside a quartic well", potential("x**2/2 + y**4/4") + forces("x**2*x_dot", "0"),
          "unstable, critical", lambda t, q, v: -np.array([q[0] - q[0]**2 * v[0], q[1]**3])),
    # a monkey saddle: no minimum
    plane("monkey saddle", potential("x**3/3 - x*y**2"), "unstable, critical", decided=False),
]  # fmt: skip


def top(spin: str, nature: str, decided: bool = True) -> Known:
    """Lagrange's top upright: A = 2, C = m g l = 1, so that it is held up where C^2 W^2 > 4 A m g l: W^2 > 8."""
    text = (
        "mbsym: 1\nname: top\nbodies:\n  - {name: top, attached to: 0, rotation: {axes: [1, 2, 3], angles: [a, b, c]}, "
        "mass centre: [0, 0, 1], mass: 1, inertia about: joint, inertia: [2, 2, 1]}\n"
        f"loads:\n  - uniform gravity: {{vector: [0, 0, -1]}}\nmotion: {{a: 0, b: 0, c: {{value: 0, rate: {spin}}}}}\n"
    )
    return Known(f"sleeping top {spin}", text, nature, decided)


def rigid(moments: str, nature: str, decided: bool = True) -> Known:
    """Euler's top turning about its third axis."""
    text = (
        "mbsym: 1\nname: Euler\nbodies:\n  - {name: body, attached to: 0, "
        f"rotation: {{axes: [3, 1, 2], angles: [c, a, b]}}, mass: 0, inertia about: joint, inertia: [{moments}]}}\n"
        "motion: {c: {value: 0, rate: 1}, a: 0, b: 0}\n"
    )
    return Known(f"Euler's top {moments}", text, nature, decided)


def central(power: int, nature: str, decided: bool = True) -> Known:
    """A circular orbit r = 1, phi' = 1 under the force r^-power: r is stable iff power < 3."""
    potential_ = "log(r)" if power == 1 else f"r**({1 - power})/({1 - power})"
    text = (
        "mbsym: 1\nname: orbit\nbodies:\n  - {name: p, attached to: 0, rotation: {axes: [3], angles: [phi]}, mass: 0}\n"
        "  - {name: m, attached to: p, connection point: [r, 0, 0], mass: 1, coordinates: [r]}\n"
        f'loads:\n  - potential: "{potential_}"\nmotion: {{phi: {{value: 0, rate: 1}}, r: 1}}\n'
    )
    return Known(f"circular orbit under r^-{power}", text, nature, decided)


def double(loads: str, motion: str, nature: str) -> Known:
    """Two unit pendulums, absolute angle of the second its own."""
    text = (
        "mbsym: 1\nname: double\nbodies:\n"
        "  - {name: a, attached to: 0, rotation: {axes: [3], angles: [q1]}, mass centre: [0, -1, 0], mass: 1}\n"
        "  - {name: b, attached to: a, rotation: {axes: [3], angles: [q2]}, connection point: [0, -1, 0], "
        f"mass centre: [0, -1, 0], mass: 1}}\nloads:\n{GRAVITY}{loads}motion: {{{motion}}}\n"
    )
    return Known(f"double pendulum {motion} {loads}".strip(), text, nature,
                 rests=[[0, 0], [0, PI], [PI, 0], [PI, PI]])  # fmt: skip


BODIES = [
    top("3", "drifts, gyroscopic"),
    top("29/10", "drifts, gyroscopic"),
    top("28/10", "unstable"),
    top("1", "unstable"),
    top("2*sqrt(2)", "unknown"),
    # about the axis of the largest or smallest moment: stable up to a turn of space; about the middle one: not
    rigid("1, 2, 5/2", "drifts, gyroscopic"),
    rigid("2, 5/2, 1", "drifts, gyroscopic"),
    rigid("1, 5/2, 2", "unstable"),
    rigid("2, 3, 5", "drifts, gyroscopic"),  # a lamina
    central(2, "drifts"),
    central(1, "drifts"),
    central(-1, "drifts"),
    central(4, "unstable"),
    double("", "q1: 0, q2: 0", "stable"),
    double("", "q1: pi, q2: 0", "unstable"),
    double("", "q1: 0, q2: pi", "unstable"),
    double("", "q1: pi, q2: pi", "unstable"),
    # either damper alone lets nothing swing on: a mode with q1 = 0 or q2 = 0 does not exist
    double("  - damper: {coordinate: q1, coefficient: 1}\n", "q1: 0, q2: 0", "asymptotic"),
    double("  - damper: {coordinate: q2, coefficient: 1}\n", "q1: 0, q2: 0", "asymptotic"),
    double("  - damper: {coordinate: q1, coefficient: 1}\n", "q1: pi, q2: pi", "unstable"),
    double("  - damper: {coordinate: q1, coefficient: -1}\n", "q1: 0, q2: 0", "unstable"),
]

KNOWN = [*LINE, *PENDULUMS, *HOOPS, *PLANES, *BODIES]
