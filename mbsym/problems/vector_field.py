"""The equations of motion in speeds as a polynomial vector field: Euler-Poisson's, Kirchhoff's and their like."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import Ordering, fmpq_mpoly_ctx

from mbsym.algebra.factors import occurring
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.mechanics.speeds import SpeedForm
from mbsym.problems.in_speeds.speed_integrals import Field
from mbsym.problems.in_speeds.speeds import SpeedEquations

#: No relations between parameters.
NOTHING: Mapping[int, Polynomial] = {}
#: Why there is no field x' = f(x).
SINGULAR = "the mass matrix is singular everywhere, so that the equations do not determine all accelerations"


def in_speeds(
    form: SpeedForm,
    equations: SpeedEquations,
    also: Sequence[Polynomial] = (),
    images: Mapping[int, Polynomial] = NOTHING,
) -> tuple[PolynomialField, Transfer]:
    """(u, s)' over QQ[parameters], with det(M) as a part of the denominator, and the way from the ring there.

    Variables are the speeds and the positions on which the equations depend; parameters are those that occur in the
    equations and in ``also``, where ``images`` (by generator) take the place of dependent ones.  Raises NoClosedForm
    where M is singular, the time, roots or functions occur, or angles do: their sines and cosines are no variables
    here.
    """
    ring = form.ring
    field = Field(form, equations)
    if ring.vanishes(field.determinant):
        raise NoClosedForm(SINGULAR)
    positions = [one for one in form.positions if one.name not in equations.aside]
    numerators = [*field.scaled, *(ring.times(field.determinant, form.rates[one.name]) for one in positions)]
    scaled = [put_in(ring, p, images) for p in (field.determinant, *numerators)]
    variables = [*form.speeds, *positions]
    relations = []
    names = {one.name for one in positions}
    for first, second in (pair for pair in equations.products):
        (name, components), (other, others) = first, second
        if not names.issuperset((*components, *others)):
            continue
        total = ring.zero if name != other else -ring.one
        for a, b in zip(components, others, strict=True):
            total = total + ring.generator("coordinate", a) * ring.generator("coordinate", b)
        relations.append(total)
    places = {one.index: one.name for one in variables}
    fractions = [ring.fraction(p) for p in scaled]
    held = [factor for _, factors in fractions for factor, _ in factors]
    also = [put_in(ring, x, images) for x in also]
    also = [p for x in also for p in (ring.fraction(x)[0], *(f for f, _ in ring.fraction(x)[1]))]
    transfer = transfer_of(ring, places, [*(p for p, _ in fractions), *held, *relations, *also], images)
    tops, bottoms = zip(*(transfer.fraction(p) for p in scaled), strict=True)
    common = bottoms[0]
    for bottom in bottoms[1:]:
        common = common * (bottom / bottom.gcd(common))
    cleared = [top * (common / bottom) for top, bottom in zip(tops, bottoms, strict=True)]
    moved, denominator = in_lowest_terms(cleared[1:], cleared[0])
    return PolynomialField(
        transfer.context,
        transfer.parameters,
        transfer.variables,
        tuple(moved),
        denominator,
        tuple(transfer(p) for p in relations),
    ), transfer


def put_in(ring: Ring, p: Polynomial, images: Mapping[int, Polynomial]) -> Polynomial:
    """p with what relations say in place of dependent parameters."""
    return ring.substitute(p, images) if images else p


class Transfer:
    """Polynomials of a ring over a context of parameters and variables alone.  Raises NoClosedForm for others."""

    def __init__(
        self,
        ring: Ring,
        places: dict[int, str],
        parameters: Sequence[int],
        images: Mapping[int, Polynomial] = NOTHING,
    ) -> None:
        self.ring, self.images = ring, images
        self.parameters = tuple(ring.generators[k].name for k in parameters)
        self.variables = tuple(places.values())
        self.places = (*parameters, *places)
        self.context: Any = fmpq_mpoly_ctx.get([*self.parameters, *self.variables], Ordering.lex)

    def __call__(self, p: Polynomial) -> Any:
        degrees = p.degrees()
        for k, degree in enumerate(degrees):
            if degree > 0 and k not in self.places:  # of 0 they are all -1
                raise NoClosedForm(
                    Message(
                        "[[what]] occurs: the equations are not polynomial in speeds and positions",
                        what=_told(self.ring, k),
                    )
                )
        return self.context.from_dict({tuple(m[k] for k in self.places): c for m, c in p.to_dict().items()})

    def fraction(self, p: Polynomial) -> tuple[Any, Any]:
        """(P, Q) with p = P/Q, for p with reciprocals of polynomials in the parameters; relations are used."""
        top, factors = self.ring.fraction(put_in(self.ring, p, self.images))
        bottom = self.context.constant(1)
        for factor, exponent in factors:
            bottom *= self(factor) ** exponent
        return self(top), bottom

    def back(self, p: Any) -> Polynomial:
        """A polynomial of the context in the ring."""
        total: dict[tuple[int, ...], Any] = {}
        for monomial, c in p.to_dict().items():
            exponents = [0] * len(self.ring.generators)
            for k, power in zip(self.places, monomial, strict=True):
                exponents[k] = power
            total[tuple(exponents)] = c
        return self.ring.context.from_dict(total)


def transfer_of(
    ring: Ring, places: dict[int, str], polynomials: Sequence[Polynomial], images: Mapping[int, Polynomial] = NOTHING
) -> Transfer:
    """With the parameters that occur; ``places``: generators of the ring that are variables, by name."""
    parameters = [k for k in occurring(polynomials) if k not in places and ring.generators[k].kind == "parameter"]
    return Transfer(ring, places, parameters, images)


def _told(ring: Ring, k: int) -> str:
    g = ring.generators[k]
    if g.kind == "prescribed":  # an input, too
        return Message("[[name]], a function of the time,", name=g.name)
    if g.kind == "time":
        return Message("the time")
    if not g.name or g.name.startswith("#"):
        return Message(g.kind)
    if g.kind == "function":
        return Message("the function [[name]]", name=g.name)
    return Message("[[kind]] of [[name]]", kind=Message(g.kind), name=g.name)
