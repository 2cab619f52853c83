"""The systems that come with mbsym pass with the units that their quantities have, and not with others."""

from __future__ import annotations

from pathlib import Path

import pytest

from mbsym.source import read

SYSTEMS = Path(__file__).parents[2] / "systems"

#: From what each symbol is, without looking at the formulas.
MOMENTS = "kg*m^2"
CARRIER = {
    **dict.fromkeys(("I1", "I2", "I3", "Jt", "Ja", "A"), MOMENTS),
    "mu": "kg",
    "b0": "m",
    "d": "m",
    "k": "N/m",
    "cd": "N*s/m",
    "Omega": "rad/s",
    "omega": "rad/s",
    "e": "1",
    "s": "1",
    "rho": "1",
    "p2": "1/s^2",
    "dc": "1/s",
    "Lambda": "1/s",
    "z": "m",
    "sigma": "rad",
}
ORBIT = {"R": "m", "omega0": "1/s", "nu": "m^3/s^2"}
BODY = {"A": MOMENTS, "B": MOMENTS, "C": MOMENTS}
LINKS = {**{f"m{k}": "kg" for k in range(1, 7)}, **{f"{x}{k}": MOMENTS for x in "ABC" for k in range(1, 7)}}
TETHER = {
    **dict.fromkeys(("d_Ccm1", "d_AC", "d_EB", "d_Dcm2", "L1", "L2", "x_A", "y_A"), "m"),
    **dict.fromkeys(("I_A", "I1", "I_B", "I2"), MOMENTS),
    **dict.fromkeys(("m_A", "m_B", "m1", "m2"), "kg"),
}
FIXED = {"g": "m/s^2", "x0": "m", "y0": "m", "z0": "m", "lx": "N*m*s", "lz": "kg*m^2/s"}
HEAVY = {"m": "kg", "g": "m/s^2", "x0": "m", "psi": "rad", "p": "rad/s"}
SMALL = dict.fromkeys(("epsilon", "delta1", "delta2"), "1")
BICYCLE = {
    **dict.fromkeys(("w", "c", "rR", "rF", "xB", "zB", "xH", "zH"), "m"),
    **dict.fromkeys(("mR", "mB", "mH", "mF"), "kg"),
    **dict.fromkeys(("IRxx", "IRyy", "IBxx", "IByy", "IBzz", "IBxz"), MOMENTS),
    **dict.fromkeys(("IHxx", "IHyy", "IHzz", "IHxz", "IFxx", "IFyy"), MOMENTS),
    "g": "m/s^2",
    "v": "m/s",
    "lam": "rad",
    "roll": "rad",
}
UNITS = {
    "bead-on-hoop": {"m": "kg", "R": "m", "g": "m/s^2", "b": "N*m*s/rad", "Omega": "rad/s", "theta": "rad"},
    "bicycle": BICYCLE,
    "cart-pendulum": {"m0": "kg", "m1": "kg", "l0": "m", "l1": "m", "g": "m/s^2", "F": "N", "x": "m", "q1": "rad"},
    "cart-pole": {"M": "kg", "m": "kg", "J": MOMENTS, "l": "m", "c": "N*s/m", "gamma": "N*m*s", "F": "N", "p": "m"},
    "cartesian-pendulum": {"m": "kg", "L": "m", "g": "m/s^2", "x": "m", "y": "m"},
    "chaplygin-sleigh": {"m": "kg", "J": MOMENTS, "a": "m", "x": "m", "y": "m", "theta": "rad"},
    "clebsch": {**BODY, "R": "m", "N": "1/s^2", "M": "kg", "W": "rad/s", "c": "rad"},
    "clebsch-poisson": {**BODY, "R": "m", "N": "1/s^2", "M": "kg", "W": "rad/s", "c": "rad"},
    "dish-sphere": {
        "m": "kg",
        "r": "m",
        "l": "m",
        "J": MOMENTS,
        "g": "m/s^2",
        "Omega": "rad/s",
        "s": "rad/s",
        "x": "m",
    },
    "double-pendulum": {"m1": "kg", "m2": "kg", "l1": "m", "l2": "m", "g": "m/s^2", "theta1": "rad"},
    "dumbbell": {**ORBIT, "m1": "kg", "m2": "kg", "l": "m", "alpha": "rad", "chi": "rad"},
    "euler-poisson": {**BODY, **HEAVY, "y0": "m", "z0": "m"},
    "heavy-gyrostat": {**BODY, **HEAVY, "z0": "m", "h": "kg*m^2/s"},
    "kovalevskaya": {"C": MOMENTS, **HEAVY},
    "goryachev-chaplygin": {"C": MOMENTS, **HEAVY},
    "hess-appelrot": {"A": MOMENTS, "C": MOMENTS, **HEAVY, "z0": "m"},
    "kirchhoff": {**BODY, **dict.fromkeys(("k1", "k2", "k3"), "kg*m^2/s^2")},
    "four-bar": {**dict.fromkeys(("l1", "l2", "l3", "l4"), "m"), "rho": "kg/m", "q1": "rad"},
    "gravity-gradient": {**ORBIT, **BODY, "m": "kg", "chi": "rad"},
    "gravity-gradient-quaternion": {**ORBIT, **BODY, "m": "kg", "chi": "rad", "p": "rad/s", "e1": "1"},
    "gyrostat": {**BODY, **FIXED, "R": "m", "M": "kg", "psi": "rad"},
    "gyrostat-fast": {**BODY, **FIXED, "R": "m", "M": "kg", "psi": "rad"},
    "gyrostat-poisson": {**FIXED, **SMALL, "R": "m", "M": "kg", "A0": MOMENTS, "C": MOMENTS, "psi": "rad"},
    "henon-heiles": {
        "m": "kg",
        **dict.fromkeys(("A", "B"), "1/s^2"),
        **dict.fromkeys(("a", "b"), "1/(m*s^2)"),
        "x": "m",
    },
    "heavy-top": {"A": MOMENTS, "C": MOMENTS, "m": "kg", "l": "m", "g": "m/s^2", "Omega": "rad/s"},
    "satellite-with-gyroscope": {
        **ORBIT,
        **BODY,
        "m": "kg",
        "mg": "kg",
        "Jx": MOMENTS,
        "Jy": MOMENTS,
        "Jz": MOMENTS,
        "h": MOMENTS,
        "k": MOMENTS,
        "d": MOMENTS,
    },
    "satellite-with-two-gyroscopes": {
        **ORBIT,
        **BODY,
        "m": "kg",
        "mg": "kg",
        "Jx": MOMENTS,
        "Jy": MOMENTS,
        "Jz": MOMENTS,
        **dict.fromkeys(("h1", "h2", "k1", "k2", "d1", "d2"), MOMENTS),
    },
    "orbital-gyrostat": {**ORBIT, **BODY, "m": "kg", "h1": "N*m*s", "h2": "N*m*s", "h3": "N*m*s", "h": MOMENTS},
    "rolling-disc": {"m": "kg", "r": "m", "g": "m/s^2", "x": "m", "y": "m", "lean": "rad"},
    "rolling-disc-in-a-circle": {
        "m": "kg",
        "r": "m",
        "g": "m/s^2",
        "L": "rad",
        "W": "rad/s",
        "w": "rad/s",
        "x": "m",
        "y": "m",
    },
    "rolling-disc-speeds": {
        "m": "kg",
        "r": "m",
        "g": "m/s^2",
        "x": "m",
        "y": "m",
        "lean": "rad",
        "u1": "rad/s",
        "u2": "rad/s",
    },
    "rolling-sphere": {"m": "kg", "r": "m", "J": MOMENTS, "g": "m/s^2", "z": "m", "psi": "rad"},
    "rolling-sphere-speeds": {
        "m": "kg",
        "r": "m",
        "J": MOMENTS,
        "g": "m/s^2",
        "x": "m",
        "psi": "rad",
        "p": "rad/s",
        "q": "rad/s",
    },
    "satellite": {**ORBIT, "M2": "kg", "m": "kg", "m0": "kg", "l": "m", "r": "m", "Jx": MOMENTS, "Jy": MOMENTS},
    "satellite-controlled": {**ORBIT, "m": "kg", "m0": "kg", "l": "m", "Jx": MOMENTS, "u1": "N*m", "u2": "N*m"},
    "satellite-with-damper": CARRIER,
    "satellite-with-damper-driven": CARRIER,
    "satellite-with-damper-slow": {
        "A": MOMENTS,
        "b0": "m",
        "kappa": "1/s^2",
        "delta": "1/s",
        "eta": "rad/s",
        "omega": "rad/s",
        **dict.fromkeys(("eps", "s", "rho", "x"), "1"),
        **dict.fromkeys(("p", "q", "r"), "rad/s"),
        "y": "1/s",
    },
    "shaken-pendulum": {"m": "kg", "l": "m", "g": "m/s^2", "h": "m", "nu": "rad/s", "c": "N*m*s", "phi": "rad"},
    "simple-pendulum": {"m": "kg", "l": "m", "J": MOMENTS, "g": "m/s^2", "b": "N*m*s/rad", "theta": "rad"},
    "snakeboard": {"m": "kg", "l": "m", "J": MOMENTS, "J0": MOMENTS, "J1": MOMENTS, "v": "m/s", "x": "m", "y": "m"},
    "spatial-arm": {**LINKS, "g": "m/s^2", "h": "m", "e": "m", "c4": "m", "s": "m"},
    "spherical-pendulum": {"m": "kg", "l": "m", "g": "m/s^2", "Omega": "rad/s", "theta0": "rad"},
    "spring-pendulum": {"m": "kg", "k": "N/m", "l0": "m", "g": "m/s^2", "r": "m"},
    "stick-slip": {"m": "kg", "k": "N/m", "R": "N", "v": "m/s", "F": "N", "T": "s", "d": "s", "x": "m"},
    "tethered-satellites": TETHER,
    "three-bodies": {"mu": "1", "a": "m", "n": "rad/s", "m": "kg", "x": "1", "y": "1", "phi": "rad"},
    "turntable-sphere": {
        "m": "kg",
        "r": "m",
        "J": MOMENTS,
        "g": "m/s^2",
        "Omega": "rad/s",
        "s": "rad/s",
        "x": "m",
        "y": "m",
    },
    "ziegler": {"m": "kg", "l": "m", "k": "N*m/rad", "P": "N"},
    "ziegler-damped": {"m": "kg", "l": "m", "k": "N*m/rad", "P": "N", "b1": "N*m*s/rad", "b2": "N*m*s/rad"},
}


def complaints(name: str, units: dict[str, str]) -> list[str]:
    text = (SYSTEMS / f"{name}.yaml").read_text(encoding="utf-8")
    given = "".join(f"  {symbol}: {unit}\n" for symbol, unit in units.items())
    _, found = read(f"{text}\nunits:\n{given}", f"{name}.yaml")
    return [
        one.message for one in found.items if one.code in ("dimension", "bad-unit", "incoherent-units", "unknown-name")
    ]


def test_no_system_is_forgotten() -> None:
    given_by_matrices = {path.stem for path in SYSTEMS.glob("*.yaml") if "\nlinear system:" in path.read_text("utf-8")}
    assert {path.stem for path in SYSTEMS.glob("*.yaml")} == set(UNITS) | given_by_matrices


@pytest.mark.parametrize("name", sorted(UNITS))
def test_a_system_passes_with_its_units_and_not_with_a_wrong_one(name: str) -> None:
    units = UNITS[name]
    assert complaints(name, units) == []
    symbol = next(symbol for symbol, unit in units.items() if unit in ("m", "kg", MOMENTS))
    assert complaints(name, {**units, symbol: "m*s"}), symbol
