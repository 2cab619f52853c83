"""Reductions step by step: printed equations, Routh's form, a slow flow by hand; planted errors; complaints."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from conftest import SHIPPED, invoked

import mbsym
from mbsym.algebra.failures import NoClosedForm
from mbsym.analysis import Analysis
from mbsym.analysis.reducing import Reduced, reduced
from mbsym.analysis.scaled import Formulas
from mbsym.expressions.place import Complaints
from mbsym.problems import changes
from mbsym.source.scaling import read_reduction, read_scaling

#: (4) of the paper on gyrostat-fast.yaml, and its integrals (3).
SCALE = (
    "p=r0*eps*p1,q=r0*eps*q1,r=r0*r1,gamma1=g0*h1,gamma2=g0*h2,gamma3=g0*h3,t=tau/r0,A=a*C,B=b*C,x0=L*x,y0=L*y,z0=L*z,"
    "g=C*eps**2*r0**2/(M*L*g0),R=3*g*g0**2/(k*eps**2*r0**2),lx=y1*C*r0*eps,lz=nz*C*r0"
)
INTEGRALS = """
  - claim: first integral
    equals: A*p**2 + B*q**2 + C*r**2 - 2*M*g*(x0*gamma1 + y0*gamma2 + z0*gamma3)
      + 3*g*(A*gamma1**2 + B*gamma2**2 + C*gamma3**2)/R
  - {claim: first integral, equals: (A*p + lx)*gamma1 + B*q*gamma2 + (C*r + lz)*gamma3}
"""
ELIMINATED = "r1=1,h3=1 by integrals; q1,h2 by p1,h1;"
#: (10) with the exact X and Omega^2 of references/gyrostat/notes.md, and (16).
SYMBOLS = (
    "A1=(1-b)/a,B1=(a-1)/b,X=a/(1-b+nz),W=(1-b+nz)*(1-a+nz)/(a*b),lam=x*(A1+nz/a)/(b*W),"
    "lam1=(z*(A1/b-1/a)+k*(A1+A1*B1)+(z/b+k*B1)*nz/a)/(1-W),rho1=(1+B1-nz/b)/(1-W)"
)
CHANGED = f"{ELIMINATED}{SYMBOLS},p1=p2+eps*(lam+lam1*g2),h1=g2+eps*rho1*p2;"


def gyrostat(steps: str) -> Reduced:
    text = (SHIPPED / "gyrostat-fast.yaml").read_text(encoding="utf-8")
    system = mbsym.loads(text + INTEGRALS).system
    scaling = read_scaling(SCALE, system, Complaints())
    assert scaling is not None
    formulas = Formulas(system, scaling)
    return reduced(formulas.analysis, asked(steps), formulas, system.claims)


def asked(steps: str) -> Any:
    found = read_reduction(steps, Complaints())
    assert found is not None
    return found


def rates(found: Reduced) -> dict[str, dict[int, str]]:
    """Second derivatives by powers of eps, as Python expressions."""
    flow = found.reduction.flow
    return {
        str(found.rate(place)): {k: str(found.formula(c)) for k, c in x.coefficients.items()}
        for place, x in flow.rates.items()
        if found.rate(place) is not None
    }


def images(found: Reduced) -> dict[str, dict[int, str]]:
    return {
        str(found.variable(place)): {k: str(found.formula(c)) for k, c in x.coefficients.items()}
        for step in found.reduction.steps
        for place, x in step.images.items()
    }


VALUES = {
    name: Fraction(n, d)
    for name, n, d in [
        ("a", 2, 3), ("b", 7, 10), ("x", 2, 7), ("y", 3, 7), ("z", 6, 7), ("k", 1, 5), ("nz", 3, 10), ("y1", 1, 2),
        ("C", 5, 1), ("M", 3, 1), ("L", 2, 1), ("g0", 3, 5), ("r0", 7, 1),
        ("p1", 3, 4), ("p1_dot", -5, 6), ("h1", 8, 9), ("h1_dot", 10, 11), ("q1", 2, 5), ("h2", 5, 3),
        ("p1_0", 1, 3), ("q1_0", 4, 7), ("h1_0", 6, 5), ("h2_0", 3, 8), ("p2", 9, 7), ("g2", 4, 9), ("g2_dot", 3, 2),
    ]
}  # fmt: skip


def at(text: str, **other: Fraction) -> Fraction:
    found: Fraction = eval(text, {**VALUES, **other})
    return found


def test_r_and_gamma_from_the_integrals_are_those_of_the_paper() -> None:
    """(7) with repaired subscripts: r1^2 = 1 + eps^2 S1, (r1 + nz) h3 = 1 + nz + eps (...): expanded by hand."""
    found = images(gyrostat("r1=1,h3=1 by integrals; O(eps**3)"))
    s1 = (
        "a*(p1_0**2 - p1**2) + b*(q1_0**2 - q1**2) - 2*(x*(h1_0 - h1) + y*(h2_0 - h2))"
        "+ k*(a*(h1_0**2 - h1**2) + b*(h2_0**2 - h2**2))"
    )
    s2 = "a*(p1_0*h1_0 - p1*h1) + b*(q1_0*h2_0 - q1*h2) + y1*(h1_0 - h1)"
    assert set(found["r1"]) == {0, 2}
    assert found["r1"][0] == found["h3"][0] == "1"
    assert at(found["r1"][2]) == at(s1) / 2
    assert at(found["h3"][1]) == at(s2) / at("1 + nz")
    assert at(found["h3"][2]) == -at(s1) / 2 / at("1 + nz")


def test_the_second_order_equations_are_the_repaired_ones_of_the_paper() -> None:
    """(13) and (14) for l = 0 with A1 x0' S2/b, which references/gyrostat/notes.md found right through eps^2."""
    found = rates(gyrostat(ELIMINATED + "O(eps**3)"))
    zero = {"nz": Fraction(0), "y1": Fraction(0)}
    own = dict(VALUES) | zero
    a, b, x, y, z, k, p, h, dp, dh = (own[n] for n in ("a", "b", "x", "y", "z", "k", "p1", "h1", "p1_dot", "h1_dot"))
    A1, B1, C1 = (1 - b) / a, (a - 1) / b, b - a
    w2, q, g = -A1 * B1, -dp / A1, dh
    s1 = (
        a * (own["p1_0"] ** 2 - p**2)
        + b * (own["q1_0"] ** 2 - q**2)
        - 2 * (x * (own["h1_0"] - h) + y * (own["h2_0"] - g))
    )
    s1 += k * (a * (own["h1_0"] ** 2 - h**2) + b * (own["h2_0"] ** 2 - g**2))
    s2 = a * (own["p1_0"] * own["h1_0"] - p * h) + b * (own["q1_0"] * own["h2_0"] - q * g)
    assert at(found["p1_ddot"][0], **zero) == -w2 * p
    assert at(found["p1_ddot"][1], **zero) == z * (1 / a - A1 / b) * h + A1 * x / b + k * (w2 - A1) * h
    assert at(found["p1_ddot"][2], **zero) == (
        -w2 * p * s1 + A1 * x * s2 / b + A1 * C1 * p * q**2 - A1 * x * g * q + A1 * y * q * h + y * q * h / a
        - y * p * g / a - z * p / a + A1 * k * (p * (1 - g**2) + q * (1 - C1) * h * g - s2 * (1 + B1) * h)
    )  # fmt: skip
    assert at(found["h1_ddot"][0], **zero) == -h
    assert at(found["h1_ddot"][1], **zero) == (1 + B1) * p
    assert at(found["h1_ddot"][2], **zero) == (
        (1 + B1) * p * s2 - h * s1 + p * q * g * (1 - C1) + x * g**2 - y * h * g - z * h / b + x / b - q**2 * h
        + k * (C1 * g**2 - B1) * h
    )  # fmt: skip


def test_the_paper_s_change_of_variables_leaves_no_terms_of_the_first_order() -> None:
    """(18): p2'' + Omega^2 p2 = (1 - b + nz) y1/(a b), and gamma2'' + gamma2 is of order eps through y1 alone:
    the constant p = y1/(1 - a + nz) times 1 + B1 - nz/b, with y1/b of (14):  y1 ((a + b - 1 - nz)/(1 - a + nz) + 1)/b
    at p2 = p2_0; what the change takes out is rho1 (1 - Omega^2) p2.  The sum of constants is y1/(1 + nz)."""
    found = gyrostat(CHANGED + "O(eps**2)")
    told = rates(found)
    omega = "((1 - b + nz)*(1 - a + nz)/(a*b))"
    assert set(told["p2_ddot"]) == {0}
    assert at(told["p2_ddot"][0]) == at(f"-{omega}*p2 + (1 - b + nz)*y1/(a*b)")
    assert at(told["g2_ddot"][0]) == at("-g2")
    # rho1 p2'' brings rho1 (1 - b + nz) y1/(a b) into the equation of h1, which is taken from y1/b
    assert at(told["g2_ddot"][1]) == at("y1/b - a/(1 + nz)*(1 - b + nz)*y1/(a*b)")
    (length,) = found.reduction.flow.integrals
    lowest = at(str(found.formula(length.coefficients[0])))
    assert lowest == at("g0**2*(g2_dot**2 + g2**2 - h1_0**2 - h2_0**2)")
    text = str(images(found)["h1"][1])
    assert at(text) == at("a*p2/(1 + nz)")


def test_a_cyclic_velocity_goes_as_routh_says() -> None:
    """theta'' = c1^2 cos/(m^2 l^4 sin^3) - g sin/l, the momentum c1 of psi a constant."""
    analysis = Analysis(mbsym.load(SHIPPED / "spherical-pendulum.yaml").system)
    found = reduced(analysis, asked("psi_dot by integrals"))
    assert [step.left for step in found.reduction.steps] == [None, None]
    own: dict[str, Any] = {n: Fraction(k) for n, k in (("m", 2), ("l", 3), ("g", 5), ("c1", 7), ("theta_dot", 11))}
    own |= {"sin": lambda _: Fraction(3, 5), "cos": lambda _: Fraction(4, 5), "theta": 0}
    sine, cosine = Fraction(3, 5), Fraction(4, 5)
    expected = Fraction(49, 4 * 81) * cosine / sine**3 - Fraction(5, 3) * sine
    assert eval(rates(found)["theta_ddot"][0], own) == expected
    (energy,) = found.reduction.flow.integrals
    value = eval(str(found.formula(energy.coefficients[0])), own)
    shift = value - (Fraction(2 * 9 * 121, 2) + Fraction(49, 2 * 2 * 9) / sine**2 - 2 * 5 * 3 * cosine)
    own |= {"theta_dot": Fraction(2), "c1": Fraction(3)}
    again = eval(str(found.formula(energy.coefficients[0])), own)
    assert again - (Fraction(2 * 9 * 4, 2) + Fraction(9, 2 * 2 * 9) / sine**2 - 2 * 5 * 3 * cosine) == shift


def test_names_that_stand_for_something_are_not_taken_for_constants() -> None:
    """The spherical pendulum with a mass called c1: the momentum is another constant, not the mass."""
    text = re.sub(r"\bm\b", "c1", (SHIPPED / "spherical-pendulum.yaml").read_text(encoding="utf-8"))
    found = reduced(Analysis(mbsym.loads(text).system), asked("psi_dot by integrals"))
    own: dict[str, Any] = {n: Fraction(k) for n, k in (("c1", 2), ("l", 3), ("g", 5), ("c2", 7))}
    sine, cosine = Fraction(3, 5), Fraction(4, 5)
    own |= {"sin": lambda _: sine, "cos": lambda _: cosine, "theta": 0, "theta_dot": 0}
    expected = Fraction(49, 4 * 81) * cosine / sine**3 - Fraction(5, 3) * sine
    assert eval(rates(found)["theta_ddot"][0], own) == expected
    with pytest.raises(NoClosedForm, match="l is a parameter"):
        reduced(Analysis(mbsym.loads(text).system), asked("theta=x*l,l=g*g"))


def test_the_flow_before_the_slow_manifold_is_put_in() -> None:
    """Section 4 of the paper on the satellite with a damper: s r' = eps^2 (2 p g - (lambda + r) q f), lambda + r = s r
    + eta; p' = -lambda q + eps^2 (...): the sum of the equations of p and q solved for the rates by hand."""
    analysis = Analysis(mbsym.load(SHIPPED / "satellite-with-damper-slow.yaml").system)
    told = rates(reduced(analysis, asked("x=eps*f,y=eps*g; O(eps**4)")))
    names = ("p", "q", "r", "f", "g", "s", "eta", "rho", "kappa", "delta")
    own = {name: Fraction(k, 7) for k, name in enumerate(names, start=2)}
    p, q, r, f, g, s, eta, rho, kappa, _ = own.values()
    lam = (s - 1) * r + eta
    assert {k: eval(v, own) for k, v in told["r_dot"].items()} == {2: (2 * p * g - (lam + r) * q * f) / s}
    first = {k: eval(v, own) for k, v in told["p_dot"].items()}
    assert first[0] == -lam * q
    assert first[2] == p * q * f - 2 * rho * p * g + 2 * rho * (lam + r) * q * f
    assert first[3] == f * ((lam + r) * q * f - 2 * p * g)
    second = {k: eval(v, own) for k, v in told["q_dot"].items() if k < 2}
    assert second == {0: lam * p, 1: lam * p - p * r + rho * (p**2 + q**2) - kappa * f}


@pytest.mark.parametrize("name", ["_linear", "Flow.rate", "_put"])
def test_an_error_in_a_step_is_caught(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Solutions of linear equations, rates, and what is put in, each with a part that is wrong."""
    if name == "Flow.rate":
        true: Any = changes.Flow.rate
        monkeypatch.setattr(changes.Flow, "rate", lambda flow, x: true(flow, x) + true(flow, x))
    elif name == "_linear":
        true = changes._linear
        monkeypatch.setattr(changes, "_linear", lambda *x: [*true(*x)[:-1], true(*x)[-1] + true(*x)[-1]])
    else:
        true = changes._put
        monkeypatch.setattr(changes, "_put", lambda *x: lambda y: true(*x)(y) + true(*x)(y).shifted(1))
    with pytest.raises(NoClosedForm, match=r"withdrawn|do not settle"):
        gyrostat(ELIMINATED + "O(eps**2)")


def test_a_wrong_coefficient_anywhere_is_caught() -> None:
    """Of every rate of the last step and every image of it each coefficient, doubled."""
    found = gyrostat(CHANGED + "O(eps**2)").reduction
    last = found.steps[-1]
    left, wanted = found.order_left()
    assert left == wanted == 2
    for part in ("images", "flow"):
        series = last.images if part == "images" else last.flow.rates
        for place, x in series.items():
            for k, c in x.coefficients.items():
                wrong = {**series, place: replace(x, coefficients={**x.coefficients, k: c + c})}
                changed = (
                    replace(last, images=wrong)
                    if part == "images"
                    else replace(last, flow=replace(last.flow, rates=wrong))
                )
                left, _ = replace(found, steps=(*found.steps[:-1], changed)).order_left()
                assert left in (0, 1), (part, place, k)


def test_it_is_printed_with_checks_and_in_languages() -> None:
    path = str(SHIPPED / "spherical-pendulum.yaml")
    for language in ((), ("--latex",), ("--wolfram",), ("--python",)):
        done = invoked("show", path, "--reduce", "psi' by integrals", *language, code=0)
        assert "1. integrals used to eliminate variables" in done.output
        assert "satisfies the original equations" in done.output


@pytest.mark.parametrize(
    ("steps", "code", "said"),
    [
        ("q", 2, "'q' is no step of a reduction"),
        ("p=p1+", 2, "the expression ends too early"),
        ("v by integrals", 1, "v is no variable of the equations"),
        ("O(zz**2)", 1, "zz is no parameter of the equations"),
        ("p=p2+x", 1, "variables that stay cannot stand in what is put in for others"),
        ("p,q by integrals", 1, "no integrals determine these variables"),
        ("p=sin(u)", 1, "sin(u) is no rational function of names that are known"),
    ],
)
def test_complaints(steps: str, code: int, said: str, tmp_path: Path) -> None:
    done = invoked("show", SHIPPED / "satellite-with-damper-slow.yaml", "--reduce", steps)
    assert done.exit_code == code
    assert said in done.output
    assert "Traceback" not in done.output
