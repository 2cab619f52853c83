"""Dimensionless variables that an author chose: equations derived by hand and printed ones, the law, complaints."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from conftest import SHIPPED, filed, invoked, system_of
from jsonschema import Draft202012Validator

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.analysis import Analysis, scaled
from mbsym.analysis.scaled import Formulas, NoDescription, in_variables
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.mechanics.variables import ring_environment
from mbsym.model.scaling import Scaling
from mbsym.model.system import System
from mbsym.report.schemas import schema
from mbsym.source.scaling import read_scaling
from mbsym.studies.groups import in_scale

#: theta'' + 2 zeta theta' + sin(theta) = 0 of (J + m l^2) theta'' + b theta' + m g l sin(theta) = 0, divided through.
PENDULUM = "theta=phi,t=tau/w,J=j*m*l**2,g=l*(1+j)*w**2,b=2*zeta*m*l**2*(1+j)*w"
SPRING = "r=l0*x,t=tau/w,k=m*w**2,g=l0*w**2*nu"
#: (4) of the paper on gyrostat-fast.yaml: c sqrt(gamma0'') = r0 eps, c^2 = M g L/C, k = N gamma0''/c^2, N = 3 g/R.
GYROSTAT = (
    "p=r0*eps*p1,q=r0*eps*q1,r=r0*r1,gamma1=g0*h1,gamma2=g0*h2,gamma3=g0*h3,t=tau/r0,A=a*C,B=b*C,x0=L*x,y0=L*y,z0=L*z,"
    "g=C*eps**2*r0**2/(M*L*g0),R=3*g*g0**2/(k*eps**2*r0**2),lx=y1*C*r0*eps,lz=nz*C*r0"
)


def scaling(system: System, text: str) -> Scaling:
    complaints = Complaints()
    found = read_scaling(text, system, complaints)
    assert found is not None, complaints.items
    return found


def shown(*arguments: str) -> str:
    done = invoked("show", *arguments, code=0)
    return done.output


def test_the_pendulum_divided_through_by_hand() -> None:
    path = str(SHIPPED / "simple-pendulum.yaml")
    assert shown(path, "equations", "--scale", PENDULUM) == "(j + 1) (phi'' + 2 zeta phi' + sin(phi)) = 0\n"
    assert shown(path, "T", "K", "--scale", PENDULUM) == "T = (j + 1) phi'^2/2\nK = j + 1\n"


def test_the_spring_pendulum_divided_through_by_hand() -> None:
    """x = r/l0, nu = m g/(k l0):  x'' - x theta'^2 + x - 1 = nu cos(theta),  (x^2 theta')' + nu x sin(theta) = 0."""
    told = shown(str(SHIPPED / "spring-pendulum.yaml"), "equations", "--scale", SPRING)
    assert told == "x (theta'' x + 2 theta' x' + nu sin(theta)) = 0\nx'' + x - theta'^2 x - nu cos(theta) - 1 = 0\n"


#: (5) with A1 = (1 - b)/a, B1 = (a - 1)/b, C1 = b - a, A0 lz = nz/a, B0 lz = nz/b, B0 lx/eps = y1/b, C0 lx = eps y1;
#: multiplied by a, b and 1.
PRINTED = (
    "a*p1_dot + (1 - b)*q1*r1 + nz*q1 - eps*(y*h3 - z*h2 + k*(1 - b)*h2*h3)",
    "b*q1_dot + (a - 1)*r1*p1 - (p1*nz - r1*y1) - eps*(z*h1 - x*h3 + k*(a - 1)*h1*h3)",
    "r1_dot + eps**2*(b - a)*p1*q1 - eps**2*y1*q1 - eps**2*(x*h2 - y*h1 + k*(b - a)*h1*h2)",
)
#: (6) and (7) with all constants at the right; in the potential of the second order gamma.I gamma enters, and that of
#: the mass at the mass centre is M L^2 (|r|^2 gamma^2 - ...) of the unit vector: constant, by the length.
AREA = "eps*(a*p1*h1 + b*q1*h2 + y1*h1) + (r1 + nz)*h3"


def test_the_equations_5_of_the_fast_gyrostat() -> None:
    """And the area integral of (6), (7); they are those of the paper, identically."""
    system = mbsym.load(SHIPPED / "gyrostat-fast.yaml").system
    found = Formulas(system, scaling(system, GYROSTAT))
    lower = Lowering(found.ring, ring_environment(found.system, found.ring))

    def printed(text: str) -> object:
        tree = parse_expression(text, Complaints(), lambda start, end: Span(1, start + 1, end - start))
        assert tree is not None
        return lower(tree)

    rows = found.analysis.equations.equalities(found.analysis.system.coordinates)
    assert [found.row(x).polynomial for x in rows] == [printed(text) for text in PRINTED]
    area = next(x.formula for x in found.analysis.integrals if "angular momentum" in x.name)
    assert found.row(area, constant=True).polynomial == printed(AREA)
    told = shown(str(SHIPPED / "gyrostat-fast.yaml"), "--scale", GYROSTAT)
    assert "h1' = r1 h2 - eps q1 h3\n" in told
    with pytest.raises(NoDescription, match="unit vector"):
        in_variables(system, scaling(system, GYROSTAT))


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("simple-pendulum", PENDULUM),
        ("spring-pendulum", SPRING),
        ("spring-pendulum", "r=l0*mu*x,t=tau/w,k=m*w**2,g=l0*w**2*nu"),  # a factor is left, and stands in the joint
        ("spring-pendulum", "r=m*g/k*x,theta=vartheta,t=tau/w,g=l0*w**2"),
        ("cart-pole", "t=tau*sqrt(l/g),p=l*xi"),
        ("bead-on-hoop", "t=tau/Omega,g=R*Omega**2*nu"),
        ("rolling-disc-speeds", "x=r*x1,y=r*y1,t=tau*sqrt(r/g)"),
    ],
)
def test_scaled_equations_are_those_of_the_system(name: str, text: str) -> None:
    """``in_variables`` demands it identically in the ring; here it is seen that a slip shows."""
    system = mbsym.load(SHIPPED / f"{name}.yaml").system
    own = scaling(system, text)
    found = in_scale(system, own)
    assert not {one.name for one in own.variables if one.name != one.new} & {*found.coordinates, *found.variables}
    with pytest.MonkeyPatch.context() as patch:
        true = scaled.in_groups
        patch.setattr(
            scaled,
            "in_groups",
            lambda base, groups: true(base, groups.__class__(**{**vars(groups), "units": groups.units[1:]})),
        )
        with pytest.raises(NoDescription):
            in_variables(system, own)


def test_scaled_systems_have_scaled_solutions() -> None:
    """Both are integrated to 1e-12; x(tau) = r(tau/w)/l0 with w^2 = k/m = 40, to all those digits."""
    analysis = mbsym.load(SHIPPED / "spring-pendulum.yaml")
    there = Analysis(in_scale(analysis.system, scaling(analysis.system, "r=l0/2*x,t=tau/w,k=m*w**2,g=l0*w**2*nu")))
    rate = 40**0.5
    theta, r = mbsym.simulate(analysis, 2, accuracy=1e-12).coordinates[:, -1]
    angle, x = mbsym.simulate(there, 2 * rate, accuracy=1e-12).coordinates[:, -1]
    assert abs(theta - angle) < 1e-9
    assert abs(r - x / 2) < 1e-9


LITERAL = """
mbsym: 1
name: Literal length
parameters: {m: {sign: positive}, g: {sign: positive}, l: {sign: positive}}
bodies:
  - {name: rod, attached to: 0, rotation: {axes: [3], angles: [theta]}, mass: 0}
  - {name: bob, attached to: rod, connection point: [0.3, -l, 0], mass: m}
loads: [{uniform gravity: {acceleration: g, direction: [0, -1, 0]}}]
"""


#: r = 1/2 and an input that is held at 3 are numbers with a dimension.
MOTION = """
mbsym: 1
name: Literal rest
parameters: {m: {sign: positive}, k: {sign: positive}, l: {sign: positive}, c: {sign: nonnegative}}
bodies: [{name: bob, attached to: 0, connection point: [r, 0, 0], mass: m, coordinates: [r]}]
loads:
  - spring: {coordinate: r, stiffness: k, rest: l}
  - damper: {coordinate: r, coefficient: c}
motion: {r: REST}
"""


@pytest.mark.parametrize("text", [LITERAL, MOTION.replace("REST", "1/2")])
def test_a_number_with_a_dimension_has_no_place_among_dimensionless_ones(text: str) -> None:
    system = system_of(text)
    if text is not LITERAL:
        with pytest.raises(NoDescription, match="numbers that have a dimension"):
            in_variables(system, scaling(system, "r=l*x,t=tau/w,k=m*w**2,c=m*w*d"))
        return
    with pytest.raises(NoDescription, match="numbers that have a dimension"):
        in_variables(system, scaling(system, "t=tau/w,g=l*w**2"))


def test_what_nothing_measures_is_named() -> None:
    """The sleigh's speed v may have either sign, and no other name holds the time."""
    system = mbsym.load(SHIPPED / "chaplygin-sleigh.yaml").system
    with pytest.raises(NoDescription, match="measures v"):
        in_variables(system, scaling(system, "x=a*x1,y=a*y1,J=m*a**2*j"))
    assert in_scale(system, scaling(system, "x=a*x1,y=a*y1,J=m*a**2*j,t=tau*a/u,v=u*w"))


def test_signs_go_over_to_what_is_put_in() -> None:
    """d = c/(m w) has the sign of c; where the sign of a name does not follow it is assumed of the expression."""
    system = system_of(MOTION.replace("REST", "l"))
    found = in_scale(system, scaling(system, "r=l*x,t=tau/w,k=m*w**2,c=m*w*d"))
    assert [(one.name, one.sign) for one in found.parameters] == [("d", "nonnegative")]
    assert found.assumptions == ()
    other = in_scale(system, scaling(system, "r=l*x,t=tau/w,k=m*w**2*(1-e)"))
    assert [(one.name, one.sign) for one in other.parameters] == [("c", "nonnegative"), ("e", "real")]
    (assumed,) = other.assumptions
    assert assumed.relation == ">"


@pytest.mark.parametrize(
    ("text", "code", "place", "words"),
    [
        ("r=m*x", "dimension", 2, "a mass (kg), and 'r' is a length (m)"),
        ("r=l0*x, t=l0*tau", "dimension", 10, "'t' is a time (s)"),
        ("g=l0*nu", "dimension", 2, "'g' is m/s^2"),
        ("r=x", "dimension", 2, "a pure number, and 'r' is a length (m)"),
        ("r=l0*x**2", "bad-scale", 0, "a factor times a new name"),
        ("r=l0", "bad-scale", 0, "a factor times a new name"),
        ("q=l0*x", "unknown-name", 0, "nothing called 'q'"),
        ("r=l0*x,r=l0*y", "repeated-name", 7, "given twice"),
        ("r=l0*theta", "bad-name", 5, "the description has it"),
        ("g=k*nu/m,k=g*kappa/l0", "circular", 0, "made of itself"),
        ("r", "bad-assignment", 0, "of no name"),
    ],
)
def test_what_is_wrong_is_said_at_its_place(text: str, code: str, place: int, words: str) -> None:
    complaints = Complaints()
    assert read_scaling(text, mbsym.load(SHIPPED / "spring-pendulum.yaml").system, complaints) is None
    first = complaints.sorted()[0]
    assert (first.code, first.span and first.span.column - 1) == (code, place), first
    assert words in str(first.message)


def test_groups_propose_a_scaling_that_converts(tmp_path: Path) -> None:
    path = str(SHIPPED / "double-pendulum.yaml")
    told = invoked("groups", path, env={"COLUMNS": "70"}).output
    (line,) = (one for one in told.splitlines() if "--scale" in one)  # in one line, as it is pasted
    proposal = line.partition('--scale "')[2].partition('"')[0]
    assert proposal == "t=tau/sqrt(g/l1),m2=m1*m2_hat,l2=l1*l2_hat"
    out = tmp_path / "scaled.yaml"
    invoked("convert", path, "--scale", proposal, "--out", out, code=0)
    system = system_of(out.read_text())
    assert set(system.parameter_names) == {"m2_hat", "l2_hat"}


def test_a_run_in_dimensionless_variables_tells_its_units_and_names_no_physical_time(tmp_path: Path) -> None:
    """x'' + x = 0 in t omega: its roots are +- i, whatever omega is in seconds."""
    path = filed(
        tmp_path / "a.yaml",
        "mbsym: 1\nname: mass\nparameters: {m: {sign: positive, value: 2}, k: {sign: positive, value: 8}}\n"
        "bodies: [{name: p, mass: m, connection point: [x, 0, 0], coordinates: [x]}]\n"
        "loads: [{spring: {coordinate: x, stiffness: k}}]\nmotion: {x: 0}\n",
    )
    asked = ["run", str(path), "--scale", "t=s/w,k=m*w**2", "-p", "5,6", "-v", "--format", "json"]
    told = invoked(*asked, "--out", tmp_path / "out").output
    assert "mass, in units in which w = 1, m = 1" in told
    assert "Eigenvalues there, in the time t, of x: +- 1 i" in " ".join(told.split())
    assert "physical" not in told


def test_groups_as_json_have_no_dimension() -> None:
    """Of m, k, l0, g and r in kg, m, s: Buckingham leaves 4 - 3 groups; rate and length have the powers of theirs."""
    dimensions = {"m": (1, 0, 0), "k": (1, 0, -2), "l0": (0, 1, 0), "g": (0, 1, -2), "r": (0, 1, 0)}

    def of(powers: dict[str, str]) -> list[Fraction | int]:
        return [
            sum((Fraction(x) * dimensions[name][axis] for name, x in powers.items()), Fraction(0)) for axis in range(3)
        ]

    done = invoked("groups", SHIPPED / "spring-pendulum.yaml", "--json", code=0)
    found = json.loads(done.stdout)
    assert list(Draft202012Validator(schema("groups")).iter_errors(found)) == []
    assert len(found["groups"]) == 1
    assert of({found["groups"][0]["parameter"]: "1", **found["groups"][0]["powers"]}) == [0, 0, 0]
    assert of(found["rate"]) == [0, 0, -1]
    assert [(one["parameter"], of(one["powers"])) for one in found["lengths"]] == [("r", [0, 1, 0])]
    assert (found["idle"], found["unused"]) == ([], 0)
