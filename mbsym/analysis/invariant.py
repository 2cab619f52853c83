"""Problem 10 in the pipeline: the vector field, the integrals known of it, what is declared of parameters."""

from __future__ import annotations

import random
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import Failure, NoClosedForm
from mbsym.algebra.ring import Ring
from mbsym.expressions.message import Message
from mbsym.expressions.tree import text
from mbsym.formulas import latex, mathml, python
from mbsym.model.substitution import held
from mbsym.problems.claims.result import in_parameters
from mbsym.problems.claims.symbols import Symbols
from mbsym.problems.integrals import ENERGY

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis

#: Of Lagrange's equations: coordinates, and variables of their field, beyond which splitting takes minutes.
MOST_ANGLES, MOST_IN_ANGLES = 4, 7

if TYPE_CHECKING:
    from mbsym.algebra.polynomial_field import PolynomialField
    from mbsym.analysis.pipeline import Analysis
    from mbsym.analysis.polynomial import Setting
    from mbsym.model.system import System
    from mbsym.problems.invariant_sets.result import InvariantSets
    from mbsym.problems.vector_field import Transfer


def invariant_sets_of(analysis: Analysis) -> InvariantSets:
    """Families of the integrals of problem 7, of those that claims have proved, and of further polynomial ones.

    Of equations in speeds and unit vectors, or of Lagrange's in rates, sines and cosines of angles and positions.
    Inputs keep their values on the unperturbed motion.

    Raises NoClosedForm where the field is not polynomial or nothing but the geometry is conserved.
    """
    from mbsym.analysis import polynomial  # few ask for it
    from mbsym.problems.invariant_sets.branches import arena
    from mbsym.problems.invariant_sets.problem import invariant_sets

    if analysis.system.inputs:
        values = tuple((signal.name, text(signal.held)) for signal in analysis.system.inputs)
        still = type(analysis)(held(analysis.system), analysis.problems, analysis.terms, analysis.suggests)
        return replace(invariant_sets_of(still), inputs=values)
    count = len(analysis.constraints.free)
    if not analysis.system.speeds and count > MOST_ANGLES:
        raise NoClosedForm(
            "[[count]] coordinates: without speeds of their own, families of integrals of at most "
            "[[most]] are looked at",
            count=count,
            most=MOST_ANGLES,
            remedy=_remedy(analysis.system),
        )
    there = polynomial.setting(analysis)
    field = there.whole
    lagrangian = not analysis.system.speeds
    inside = [x for x in field.variables if not (x.isidentifier() or (lagrangian and x.startswith(("sin(", "cos("))))]
    if inside:
        raise NoClosedForm(
            "[[names]] are variables: families of integrals are looked at in velocities, angles and positions, or "
            "in speeds, positions and unit vectors",
            names=", ".join(inside),
            remedy="see 'mbsym integrals'" if lagrangian else "leave 'speeds' out",
        )
    twice = [x for x in field.variables if any(y.startswith((f"sin({x})", f"sin({x}/")) for y in field.variables)]
    if twice:  # grad K with respect to both would not be that of a function of the angle
        names = ", ".join(y for x in twice for y in (x, f"sin({x})"))
        raise NoClosedForm("[[names]] are functions of each other: they cannot all be variables", names=names)
    vectors = {name for body in analysis.system.bodies for vector in body.orientation for name in vector.components}
    if not all(_is_of_one_angle(field, p) or _names(field, p) <= vectors for p in field.relations):
        raise NoClosedForm(
            "constraints tie positions: families of integrals are looked at in coordinates that keep them",
            remedy="choose such coordinates, or write a constraint as  relation: x = r*phi; a closed loop has none as "
            "a rule: 'mbsym equilibria' lists its steady motions at values",
        )
    if lagrangian and len(field.variables) > MOST_IN_ANGLES:
        raise NoClosedForm(
            "[[count]] rates, sines, cosines and positions: families of at most [[most]] are looked at",
            count=len(field.variables),
            most=MOST_IN_ANGLES,
            remedy=_remedy(analysis.system),
        )
    integrals = [(name, _without_constants(field, p)) for name, p in _known(analysis, there)]
    chosen, left = _independent(field, [(name, p) for name, p in integrals if field.reduced(field.derivative(p)) == 0])
    if not chosen:
        raise NoClosedForm("no polynomial integrals are known but those of geometry")
    signs = {parameter.name: parameter.sign for parameter in analysis.system.parameters}
    floating = len(field.relations) if lagrangian else 0
    place = arena(field, chosen, signs, _assumptions(analysis, there.transfer), floating)
    from mbsym.problems.invariant_sets.branches import identifiers

    plain = identifiers(field.variables, field.parameters)
    written = write_in(place.ring, analysis, dict(zip(plain, field.variables, strict=True)) if lagrangian else {})
    return replace(invariant_sets(place), written=written, in_angles=lagrangian, left_out=left)


def _is_of_one_angle(field: PolynomialField, relation: Any) -> bool:
    """Whether it is sin^2 + cos^2 = 1."""
    names = _names(field, relation)
    return len(names) == 2 and all(name.startswith(("sin(", "cos(")) for name in names)


def _names(field: PolynomialField, p: Any) -> set[str]:
    """The variables that occur."""
    return {name for k, name in zip(field.places, field.variables, strict=True) if p.degrees()[k] > 0}


def _remedy(system: System) -> str:
    """What shortens the equations: speeds, and a quaternion for a body with three angles of its own."""
    for body in system.bodies:
        if len(body.own_angles) == 3 and not body.speeds:
            taken = {
                *system.parameter_names,
                *system.coordinates,
                *(prescribed.name for prescribed in system.prescribed),
            }
            free = {*taken} & {"p", "q", "r", "e0", "e1", "e2", "e3"}
            other = ""
            if free:
                other = Message(" (other names for [[names]], which are taken)", names=", ".join(sorted(free)))
            return Message(
                "told by a quaternion the equations of '[[body]]' are shorter: write 'speeds: {p: omega1, q: "
                "omega2, r: omega3}' and 'orientation: {e: quaternion}'[[other]] into it, as "
                "systems/gravity-gradient-quaternion.yaml does",
                body=body.name,
                other=other,
            )
    return "with speeds and unit vectors (mbsym explain description) equations are shorter"


def _known(analysis: Analysis, there: Setting) -> list[tuple[str, Any]]:
    """Names and polynomials, the energy first, then others by falling degree.

    Of problem 7, of claims, and what a search up to weighted degree 2 max(weights) finds besides.
    """
    from mbsym.analysis import polynomial

    field = there.whole
    energies = {integral.name for integral in analysis.integrals if integral.kind == ENERGY}
    energies |= {Message(polynomial.MULTIPLE, name=name) for name in energies}
    known = [(name, p) for name, p in there.known if field.reduced(_without_constants(field, p)) != 0]
    # Claimed integrals are looked at here once more: ``analysis.claims`` asks for every result, this one among them.
    for k, claim in enumerate(analysis.system.claims):
        if claim.kind == "first integral":
            with suppress(Failure):
                stated = Symbols.of(analysis).polynomial(analysis.parameters_scene, claim)
                top, bottom = there.transfer.fraction(in_parameters(analysis, stated))
                if not any(bottom.degrees()[place] for place in field.places):
                    known.append((claim.place or Message("claim [[number]]", number=k + 1), top))
    with suppress(Failure):
        most = 2 * max(polynomial.weights_of(there).weights)
        generators = [
            generator
            for generator in polynomial.integrals_of(there, most).generators
            if generator.certainty is Certainty.PROVED
        ]
        new = [generator for generator in generators if generator.is_new]
        for k, generator in enumerate(new, 1):
            name = Message("further integral [[k]]", k=k) if len(new) > 1 else Message("further integral")
            known.append((name, generator.polynomial))
        # What follows from integrals that are none of the field is one of the field all the same.
        known += [
            (generator.name, generator.polynomial)
            for generator in generators
            if generator.name == polynomial.FUNCTION and generator.independent
        ]
    order = sorted(range(len(known)), key=lambda k: (known[k][0] not in energies, -_degree(field, known[k][1]), k))
    return [known[k] for k in order]


def _degree(field: PolynomialField, p: Any) -> int:
    first = len(field.parameters)
    return max((sum(monomial[first:]) for monomial in p.to_dict()), default=0)


def _without_constants(field: PolynomialField, p: Any) -> Any:
    """The integral without terms that hold no variable."""
    first = len(field.parameters)
    return field.context.from_dict({m: c for m, c in p.to_dict().items() if any(m[first:])})


def _independent(
    field: PolynomialField, integrals: list[tuple[str, Any]]
) -> tuple[list[tuple[str, Any]], tuple[str, ...]]:
    """Those whose gradients are independent of the earlier ones' and of the relations', at a random point mod a prime.

    The relations come last, with names of their own: they take part in the families.  And the names of others, but for
    those that are sums of these with constant coefficients, which families hold.
    """
    from mbsym.problems.invariant_sets.branches import PRIME, rank

    chance = random.Random(3)
    point = {k: chance.randrange(2, PRIME) for k in range(field.context.nvars())}
    rows = [_gradient(field, relation, point) for relation in field.relations]
    independent: list[tuple[str, Any]] = []
    left = []
    for name, p in integrals:
        row = _gradient(field, p, point)
        if rank([*rows, row]) > len(rows):
            rows.append(row)
            independent.append((name, p))
        elif not _is_sum(field, p, [q for _, q in independent], point):
            left.append(name)
    if not independent:
        return [], ()
    for k, relation in enumerate(field.relations):
        several = len(field.relations) > 1
        name = Message("geometry [[number]]", number=k + 1) if several else Message("geometry")
        independent.append((name, _without_constants(field, relation)))
    return independent, tuple(left)


def _is_sum(field: PolynomialField, p: Any, others: list[Any], point: dict[int, int]) -> bool:
    """Whether p is a sum of others and a constant, at parameters of the point: modulo a prime and the relations."""
    from mbsym.problems.invariant_sets.branches import PRIME, evaluate, rank

    first = len(field.parameters)
    listed = []
    for polynomial in (p, *others):
        parts: dict[tuple[int, ...], int] = {}
        for monomial, c in field.reduced(polynomial).to_dict().items():
            if any(monomial[first:]):
                term = field.context.from_dict({(*monomial[:first], *(0 for _ in monomial[first:])): c})
                key = tuple(int(k) for k in monomial[first:])
                parts[key] = (parts.get(key, 0) + evaluate(term, point)) % PRIME
        listed.append(parts)
    columns = sorted({key for parts in listed for key in parts})
    rows = [[parts.get(key, 0) for key in columns] for parts in listed]
    return rank(rows) == rank(rows[1:])


def _gradient(field: PolynomialField, p: Any, point: dict[int, int]) -> list[int]:
    from mbsym.problems.invariant_sets.branches import evaluate

    return [evaluate(p.derivative(k), point) for k in field.places]


def _assumptions(analysis: Analysis, transfer: Transfer) -> list[tuple[Any, str]]:
    """Those in parameters that occur in the field."""
    assumptions = []
    for p, relation in analysis.signs.assumptions:
        try:
            assumptions.append((transfer(p), relation))
        except Failure:
            continue
    return assumptions


def write_in(ring: Ring, analysis: Analysis, names: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """``names``: identifiers of the ring -> variables of the field, ``sin(theta)`` or ``sin(theta/2)``.

    The identifiers that stand for something else, with that in Python syntax; the description's own symbols are kept.
    """
    system = analysis.system
    symbols = {symbol.name: symbol.latex for symbol in system.symbols}
    given = {name: latex.given_symbol(text) for name, text in symbols.items()}
    in_tex, in_page = latex.LatexNames(system.coordinates, given), mathml.MathNames(system.coordinates)
    latex_by_name: dict[str, str] = {}
    page: dict[str, mathml.Symbol] = {}
    for plain, name in names.items():
        stem = name.removesuffix("_dot")
        if name[:4] in ("sin(", "cos("):
            function = name[:3]
            angle, _, share = name[4:-1].partition("/")
            latex_by_name[plain] = rf"(\{function} {in_tex[angle]}{'/' + share if share else ''})"
            part = mathml.mo("/") + mathml.mn(share) if share else ""
            inside = mathml.mi(function) + mathml.APPLY + str(in_page[angle]) + part
            page[plain] = mathml.Symbol(mathml.bracketed(inside))
        elif stem != name and stem in system.coordinates:
            latex_by_name[plain] = in_tex[stem].accented("dot")
            page[plain] = in_page[stem].dotted("\u02d9")
    if latex_by_name or symbols:
        latex.write_as(ring, latex_by_name | symbols)
    if page:
        mathml.MathNames.write_as(ring, page)
        python.write_as(ring, {x: re.sub("_dot$", "'", names[x]) for x in page})
    return tuple((plain, name) for plain, name in names.items() if plain != name)
