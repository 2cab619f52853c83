"""A reduction of a system, from what its author asks for (``mbsym.source.scaling``)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import count
from operator import add, mul, sub, truediv
from random import Random
from typing import TYPE_CHECKING, Any, cast

from flint import fmpq, fmpq_mat

from mbsym.algebra.base import Lowering
from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.quotients import Quotient, Series
from mbsym.algebra.rationals import exact
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.algebra.terms import apart
from mbsym.expressions.rates import velocity_name
from mbsym.expressions.tree import Expression, Name, Negative, Number, Operation, names, substitute, text, walk
from mbsym.formulas.formula import Formula
from mbsym.mechanics.motion import relations
from mbsym.mechanics.variables import ring_environment
from mbsym.model.claims import Abbreviation, Claim
from mbsym.model.scaling import INTEGRALS, Reducing
from mbsym.model.system import System
from mbsym.problems import changes
from mbsym.problems.changes import Flow, How, Reduction
from mbsym.problems.vector_field import Transfer, vector_field

if TYPE_CHECKING:
    from mbsym.analysis import Analysis
    from mbsym.analysis.scaled import Formulas


@dataclass(frozen=True)
class Reduced:
    """The reduction with the ring in which it is told; ``system`` has its letters."""

    reduction: Reduction
    transfer: Transfer
    system: System
    request: Reducing

    def formula(self, c: Quotient) -> Formula:
        """With sin^2 in place of factors 1 - cos^2 of the denominator."""
        ring, back = self.transfer.ring, self.transfer.back
        numerator, below = back(c.top), back(c.bottom)
        for name in ring.angles:
            sine = ring.generator("sine", name)
            while (left := ring.quotient(below, ring.one - ring.generator("cosine", name) ** 2)) is not None:
                numerator, below = ring.times(numerator, ring.reciprocal(sine) ** 2), left
        return Formula(ring, ring.ratio(numerator, below))

    def terms(self, x: Series) -> tuple[tuple[Formula, Formula], ...]:
        """The coefficients with powers of the small parameter, from the lowest on; they hold what it divides."""
        ring, pairs = self.transfer.ring, []
        small = ring.generator("parameter", self.request.small) if self.request.small else ring.one
        for k, c in sorted(x.coefficients.items()):
            below = ring.reciprocal(small) ** max(0, -k)
            own = self.formula(c)
            pairs.append((Formula(ring, ring.times(own.polynomial, below)), Formula(ring, small ** max(0, k))))
        return tuple(pairs)

    @property
    def remainder(self) -> str:
        """From which power on terms are left out."""
        return f"{self.request.small}^{self.request.known}"

    def variable(self, place: int) -> Formula:
        return self.formula(Quotient.of(self.transfer.context.gen(place)))

    def rate(self, place: int) -> Formula | None:
        """The rate of a variable as it is written; None of a sine or cosine."""
        g = self.transfer.ring.generators[self.transfer.places[place]]
        kind = {"coordinate": "velocity", "velocity": "acceleration"}.get(g.kind)
        return None if kind is None else Formula(self.transfer.ring, self.transfer.ring.generator(kind, g.name))


def reduced(
    analysis: Analysis, reducing: Reducing, formulas: Formulas | None = None, claims: Iterable[Claim] = ()
) -> Reduced:
    """The equations of motion, in the variables of ``formulas`` if any, reduced.  Raises NoClosedForm.

    ``claims``: integrals among them are tried before those of problem 7, if they are any.
    """
    start = _Start(analysis, reducing, formulas, claims)
    reduction = Reduction(start.rows, start.small, ()).then(How.SORTED, {}, start.flow())
    for step in reducing.steps:
        if not step.by:
            put = {start.place(name): start.whole(x) for name, x in step.definitions.items() if name in start.moving}
            new = dict.fromkeys(node.name for x in put.values() for node in walk(x) if isinstance(node, Name))
            places = [start.place(name) for name in new if name in start.fresh]
            if put:
                old = {place: start.series(x) for place, x in put.items()}
                reduction = changes.by_change(reduction, old, places, reducing.known)
            continue
        unknown = [start.place(name) for name in step.names]
        if step.by == (INTEGRALS,):
            first = start.initial(reduction.flow.rates)
            first |= {start.place(name): start.series(x) for name, x in step.definitions.items()}
            reduction = changes.by_integrals(reduction, unknown, first, start.constants(len(unknown)), reducing.known)
        else:
            reduction = changes.by_equations(
                reduction, unknown, [start.place(name) for name in step.by], reducing.known
            )
    abbreviations = (
        abbreviation for abbreviation in start.system.abbreviations if abbreviation.name not in start.letters
    )
    letters = (*abbreviations, *(Abbreviation(name, value) for name, value in start.letters.items()))
    system = replace(start.system, abbreviations=letters)
    return Reduced(reduction, start.transfer, system, reducing)


class _Start:
    """The equations and integrals in a ring that has room for all names that come in."""

    def __init__(self, analysis: Analysis, asked: Reducing, formulas: Formulas | None, claims: Iterable[Claim]) -> None:
        own = analysis.ring
        field, there = vector_field(analysis.form, analysis.equations, (), relations(analysis.parameters_scene))
        indices = there.places[len(there.parameters) :]
        self.system = analysis.system if formulas is None else formulas.system
        bases = dict.fromkeys(own.generators[k].name for k in indices)
        parameters = [*self.system.parameter_names, *(notation.name for notation in self.system.notation)]
        expressions = {name: x for step in asked.steps if not step.by for name, x in step.definitions.items()}
        self.moving = {own.generators[k].name for k in indices if own.generators[k].kind == "coordinate"}
        self.moving |= {velocity_name(n) for n in bases}
        self.letters = {name: x for name, x in expressions.items() if name not in self.moving}
        for name in sorted({*self.letters} & {*parameters, "pi"}):
            raise NoClosedForm("[[name]] is a parameter: a letter needs a name of its own", name=name)
        seen = [name for x in expressions.values() for name in sorted(names(x))]
        known = {*parameters, *self.letters, *self.moving, "pi"}
        self.fresh = [name for name in dict.fromkeys(seen) if name not in known]
        self.moving |= {*self.fresh, *map(velocity_name, self.fresh)}
        taken = {*known, *self.fresh}
        numbered = (f"c{k}" for k in count(1))
        self._firsts = {name: next(x for x in _tried(f"{name}_0") if x not in taken) for name in bases}
        self._constants = [next(x for x in numbered if x not in taken) for _ in bases]
        added = [*self._firsts.values(), *self._constants]
        if asked.small and asked.small not in parameters:
            raise NoClosedForm("[[name]] is no parameter of the equations", name=asked.small)
        fixed = dict.fromkeys((*parameters, *added))
        positive = [parameter.name for parameter in self.system.parameters if parameter.sign == "positive"]
        self.ring = ring = Ring([*bases, *self.fresh], [], [*fixed], own.angles, positive, spare=64)
        self.environment = {name: ring.generator("parameter", name) for name in (*fixed, "pi")}
        for name in (*bases, *self.fresh):
            self.environment[name] = ring.generator("coordinate", name)
            self.environment[velocity_name(name)] = ring.generator("velocity", name)
        places = [k for k, g in enumerate(ring.generators) if g.kind in ("coordinate", "velocity")]
        places += [ring.index(g.kind, g.name) for g in (own.generators[k] for k in indices) if "sine" in g.kind]
        fixed_places = [ring.index("parameter", name) for name in (*fixed, "pi")]
        self.transfer = Transfer(
            ring, {k: f"{ring.generators[k].kind} {ring.generators[k].name}" for k in places}, fixed_places
        )
        self.small = fixed_places.index(ring.index("parameter", asked.small)) if asked.small else -1
        self.known = asked.known
        carry = _carrier(own, ring, self.environment, formulas)
        self.rows: dict[int, tuple[Polynomial, Polynomial]] = {}
        time = carry(own.generator("time", "t"))
        for k, p in zip(indices, field.numerators, strict=True):
            g = own.generators[k]
            variable = ring.generator(g.kind, g.name)
            factor = ring.quotient(carry(own.context.gen(k)), variable)
            if factor is None:
                raise NoClosedForm("[[name]] under sines and cosines is not scaled", name=g.name)
            below = ring.times(carry(there.back(field.denominator)), factor)
            rate = ring.times(ring.times(carry(there.back(p)), time), ring.reciprocal(below))
            self.rows[self.at(variable)] = self.transfer.fraction(rate)
        self.integrals: list[Polynomial] = []
        for p in (
            *self._claimed(analysis, claims, formulas),
            *sorted((integral.formula.polynomial for integral in analysis.integrals), key=len),
        ):
            try:
                polynomial = self.transfer.fraction(carry(p))[0]
            except (NoClosedForm, KeyError):
                continue  # of a position that no equation holds
            if self._constant(polynomial) and self._independent([*self.integrals, polynomial]):
                self.integrals.append(polynomial)

    def _claimed(self, analysis: Analysis, claims: Iterable[Claim], formulas: Formulas | None) -> Iterator[Polynomial]:
        """What an author says are first integrals, in the ring of the equations."""
        system, ring = analysis.system, analysis.ring
        new = {} if formulas is None else {variable.name: Name(variable.new) for variable in formulas.scaling.variables}
        lower = Lowering(ring, ring_environment(system, ring))
        letters = {abbreviation.name: abbreviation.value for abbreviation in self.system.abbreviations}
        for claim in claims:
            if claim.kind == "first integral":
                x = claim.equals
                for _ in letters:
                    x = substitute(x, letters)
                yield lower(substitute(x, new))

    def _constant(self, p: Polynomial) -> bool:
        """Whether it is one along the motion, exactly."""
        moved = (Quotient.of(p.derivative(place) * top, below) for place, (top, below) in self.rows.items())
        return reduce(add, moved).is_zero

    def _independent(self, integrals: Sequence[Polynomial]) -> bool:
        """Whether none is a function of the others: their gradients, at a random state."""
        chance = Random("integrals")
        at = [fmpq(chance.randint(2, 99)) for _ in self.transfer.context.names()]
        return fmpq_mat([[p.derivative(place)(*at) for place in self.rows] for p in integrals]).rank() == len(integrals)

    def of(self, generator: Polynomial) -> int:
        """The place of a generator of the context."""
        return next(k for k, degree in enumerate(generator.degrees()) if degree)

    def at(self, generator: Polynomial) -> int:
        """The place in the context of a generator of the ring."""
        return self.of(self.transfer(generator))

    def place(self, name: str) -> int:
        """Raises NoClosedForm for what is no variable."""
        if name not in self.moving:
            raise NoClosedForm("[[name]] is no variable of the equations", name=name)
        return self.at(self.environment[name])

    def initial(self, places: Iterable[int]) -> dict[int, Series]:
        """The names of what variables are at first."""
        initial_values = {}
        for place in places:
            g = self.ring.generators[self.transfer.places[place]]
            if g.kind == "coordinate" and g.name in self._firsts:
                initial_values[place] = self._sorted(self.environment[self._firsts[g.name]])
        return initial_values

    def constants(self, many: int) -> list[Series]:
        return [self._sorted(self.environment[name]) for name in self._constants[:many]]

    def whole(self, x: Expression) -> Expression:
        """Without letters."""
        for _ in self.letters:
            x = substitute(x, self.letters)
        return x

    def series(self, x: Expression) -> Series:
        """Raises NoClosedForm for what is no rational function of names that are known."""
        quotient = self._quotient(self.whole(x))
        return self._graded(quotient.top, quotient.bottom)

    def _quotient(self, x: Expression) -> Quotient:
        match x:
            case Number(value):
                return Quotient.of(self.transfer.context.constant(exact(value)))
            case Name(name) if name in self.environment:
                return Quotient.of(self.transfer(self.environment[name]))
            case Negative(operand):
                return -self._quotient(operand)
            case Operation("**", base, Number(power)) if power.denominator == 1 and 0 < power < 100:
                quotient = self._quotient(base)
                return Quotient.of(quotient.top ** int(power), quotient.bottom ** int(power))
            case Operation("+" | "-" | "*" | "/" as operator, left, right):
                act: Any = {"+": add, "-": sub, "*": mul, "/": truediv}[operator]
                return cast("Quotient", act(self._quotient(left), self._quotient(right)))
        raise NoClosedForm("[[formula]] is no rational function of names that are known", formula=text(x))

    def flow(self) -> Flow:
        velocities = {}
        for name, generator in self.environment.items():
            if velocity_name(name) in self.environment:
                velocities[self.at(generator)] = self.at(self.environment[velocity_name(name)])
        one = self.transfer.context.constant(1)
        integrals = tuple(self._graded(p, one) for p in self.integrals)
        rates = {place: self._graded(*row) for place, row in self.rows.items()}
        return Flow(self.transfer.context, rates, integrals, velocities)

    def _sorted(self, p: Polynomial) -> Series:
        return self._graded(*self.transfer.fraction(p))

    def _graded(self, top: Polynomial, bottom: Polynomial) -> Series:
        """By powers of the small parameter."""
        places = [self.small] if self.small >= 0 else []
        above, below = (
            Series(self.transfer.context, {sum(k): Quotient.of(c) for k, c in apart(p, places).items()})
            for p in (top, bottom)
        )
        return above.over(below, self.known if len(below.coefficients) > 1 else None)


def _tried(name: str) -> Iterator[str]:
    """q_0, q_00, ...: a name that stands for something else already is not taken."""
    return (name + "0" * k for k in count())


def _carrier(own: Ring, ring: Ring, environment: Mapping[str, Any], formulas: Formulas | None) -> Any:
    """From the ring of the equations into the new one, through that of scaled variables."""
    if formulas is None:
        return Carrier(own, ring, {**environment, "t": ring.one})
    last = Carrier(formulas.ring, ring, {**environment, "t": ring.one})
    return lambda p: last(formulas.carry(p))
