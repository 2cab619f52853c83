"""Linear invariant relations  f = sum a_i x_i = 0  with  df/dt = K f,  and the parameters at which there are such.

With the first coefficient that is not zero put to 1, f divides its derivative if and only if that vanishes where
x_1 = -(a_2 x_2 + ...) is put in.  Its coefficients are polynomials in the other a_i and the parameters.  They are
solved by cases: of an equation that is a product, one factor after the other; an unknown that occurs linearly, where
its coefficient is not zero, and the coefficient zero besides.  What is left is conditions on the parameters alone.

Source: T. Levi-Civita & U. Amaldi on invariant relations; W. Hess, Math. Ann. 37 (1890), for the heavy rigid body.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from flint import fmpq_mpoly_ctx

from mbsym.algebra.factors import irreducible_factors
from mbsym.algebra.polynomial_field import PolynomialField
from mbsym.algebra.terms import with_quotient
from mbsym.problems.polynomial_integrals.darboux import is_regular_on, put_in
from mbsym.problems.polynomial_integrals.modular import coefficients, primitive
from mbsym.problems.polynomial_integrals.result import Relation, Relations

#: Cases that are followed for one leading variable, and terms of an equation.
MOST_CASES, MOST_TERMS = 300, 2000


@dataclass(frozen=True)
class _State:
    """Equations in parameters and unknowns; conditions on the parameters; what is not zero; unknowns solved."""

    equations: tuple[Any, ...]
    conditions: tuple[Any, ...]
    nonzero: tuple[Any, ...]
    solved: tuple[tuple[int, Any, Any], ...]


def linear_relations(
    field: PolynomialField, weights: Sequence[int], positive: Sequence[str], free: bool = True
) -> Relations:
    """All relations that are linear and homogeneous in the variables of least weight.

    ``positive``: parameters that are not zero, nor sums of their products.  ``free``: the field's relations matter
    to no such form (``Grading.free``); otherwise there may be others, which divide their derivatives modulo these.
    """
    least = min(weights)
    chosen = [k for k, w in enumerate(weights) if w == least]
    relations: list[Relation] = []
    complete = True
    for number, k in enumerate(chosen):
        leading = _Leading(field, k, chosen[number + 1 :], positive)
        for relation in leading.relations():
            if not any(_same(relation, other) for other in relations):
                relations.append(relation)
        complete = complete and leading.complete
    return Relations(tuple(relations), complete and (free or not field.relations))


def _same(first: Relation, second: Relation) -> bool:
    return first.polynomial == second.polynomial and set(map(str, second.conditions)) <= set(map(str, first.conditions))


class _Leading:
    """f = x_k + a_2 x_2 + ... with the variables ``others``."""

    def __init__(self, field: PolynomialField, k: int, others: Sequence[int], positive: Sequence[str]) -> None:
        self.field, self.k, self.others, self.positive = field, k, others, set(positive)
        self.unknowns = [f"#{j}" for j in others]
        self.count = len(field.parameters)
        names = [*field.parameters, *self.unknowns, *field.variables]
        self.context = fmpq_mpoly_ctx.get(names, field.context.ordering())
        self.complete, self.cases = True, 0

    def relations(self) -> Iterator[Relation]:
        bottom = [f for f, _ in irreducible_factors(self.field.denominator)[1]]  # 0 at no system
        start = _State(tuple(self._equations()), (), tuple(map(self._moved, bottom)), ())
        pending = [start]
        while pending:
            state = pending.pop()
            self.cases += 1
            if self.cases > MOST_CASES:
                self.complete = False
                return
            further = self._step(state)
            if further is None:
                relation = self._relation(state)
                if relation is not None:
                    yield relation
            else:
                pending.extend(further)

    def _moved(self, p: Any) -> Any:
        """A polynomial of the field, with the unknowns as further generators."""
        gens = self.context.gens()
        return p.compose(*gens[: self.count], *gens[self.count + len(self.others) :], ctx=self.context)

    def _equations(self) -> Iterator[Any]:
        gens = self.context.gens()
        parameters, unknowns = gens[: self.count], gens[self.count : self.count + len(self.others)]
        variables = list(gens[self.count + len(self.others) :])
        moved = list(map(self._moved, self.field.numerators))
        rate = moved[self.k] + sum((a * moved[j] for a, j in zip(unknowns, self.others, strict=True)), 0 * gens[0])
        put = -sum((a * variables[j] for a, j in zip(unknowns, self.others, strict=True)), 0 * gens[0])
        images = [*parameters, *unknowns, *variables]
        images[len(images) - len(variables) + self.k] = put
        rate = rate.compose(*images, ctx=self.context)
        within = PolynomialField(
            self.context,
            (*self.field.parameters, *self.unknowns),
            self.field.variables,
            (rate,) * len(variables),
            self.context.constant(1),
        )
        yield from coefficients(within, rate).values()

    def _step(self, state: _State) -> list[_State] | None:
        """The cases that a state falls into; [] where it contradicts itself, None where only conditions are left."""
        parts = []
        for p in state.equations:
            if p == 0:
                continue
            if len(p) > MOST_TERMS:
                self.complete = False
                return []
            factors = [f for f, _ in irreducible_factors(p)[1] if not self._nonzero(f, state)]
            if not factors:
                return []
            if not any(f in state.conditions or -f in state.conditions for f in factors):
                parts.append(factors)
        if not parts:
            return None
        parts.sort(key=self._price)
        factors = parts[0]
        if len(factors) > 1:
            return [_put(state, (f,)) for f in factors]
        return self._solved(state, factors[0], min(map(self._effort, factors)))

    def _price(self, factors: Sequence[Any]) -> tuple[bool, int]:
        """Short products first; those with an unknown that is not linear after all others."""
        return any(self._effort(f)[0] == 3 for f in factors), sum(map(len, factors)) + 2 * (len(factors) - 1)

    def _effort(self, f: Any) -> tuple[int, int]:
        """Pure powers of unknowns and linear ones first, then conditions on parameters, nonlinear ones last."""
        linear = self._linear(f)
        if linear is not None:
            return (0 if self._nonzero(linear[1], None) else 1, len(f))
        return (3 if self._has_unknowns(f) else 2, len(f))

    def _solved(self, state: _State, f: Any, effort: tuple[int, int]) -> list[_State]:
        linear = self._linear(f)
        if linear is not None:
            place, slope = linear
            rest = f - slope * self.context.gen(place)
            cases = []
            if not self._nonzero(slope, state):
                cases.append(_put(state, (slope, rest)))
            equations = tuple(with_quotient(p, place, -rest, slope) for p in state.equations)
            if not any(slope in (c, -c) for c in state.conditions):
                apart = [] if slope.is_constant() else [p for p, _ in irreducible_factors(slope)[1]]
                nonzero = (*state.nonzero, *(p for p in apart if not self._nonzero(p, state)))
                cases.append(_State(equations, state.conditions, nonzero, (*state.solved, (place, -rest, slope))))
            return cases
        if effort[0] == 3:
            self.complete = False  # an unknown of higher degree: roots of parameters are not followed
            return []
        if not self._possible(f):
            return []
        return [self._conditioned(state, f)]

    def _conditioned(self, state: _State, f: Any) -> _State:
        """A condition on the parameters: put in where a parameter is 0 or another one, kept as it is elsewhere."""
        degrees = f.degrees()
        for k in range(self.count):
            slope = f.derivative(k)
            if degrees[k] == 1 and slope.is_constant():
                top = -(f - slope * self.context.gen(k)) / slope.leading_coefficient()
                one = self.context.constant(1)
                equations = tuple(with_quotient(p, k, top, one) for p in state.equations)
                conditions = []
                for p in state.conditions:  # those that change are equations again
                    moved = with_quotient(p, k, top, one)
                    if moved == p:
                        conditions.append(p)
                    elif p.degrees()[k] == 1 and p.derivative(k).is_constant():
                        conditions.append(p)
                        equations = (*equations, moved)
                    else:
                        equations = (*equations, moved)
                nonzero = tuple(with_quotient(p, k, top, one) for p in state.nonzero)
                if any(p == 0 for p in nonzero):
                    return _State((one,), (), (), ())
                solved = tuple(
                    (place, with_quotient(a, k, top, one), with_quotient(b, k, top, one))
                    for place, a, b in state.solved
                )
                return _State(equations, (*conditions, f), nonzero, solved)
        return _State(state.equations, (*state.conditions, f), state.nonzero, state.solved)

    def _linear(self, f: Any) -> tuple[int, Any] | None:
        """An unknown that occurs linearly with a coefficient in parameters alone, the simplest coefficient."""
        degrees = f.degrees()
        able = []
        for place in range(self.count, self.count + len(self.others)):
            if degrees[place] == 1:
                slope = f.derivative(place)
                if not self._has_unknowns(slope):
                    able.append((len(slope), place, slope))
        if not able:
            return None
        _, place, slope = min(able, key=lambda candidate: candidate[:2])
        return place, slope

    def _has_unknowns(self, f: Any) -> bool:
        return any(f.degrees()[self.count : self.count + len(self.others)])

    def _nonzero(self, f: Any, state: _State | None) -> bool:
        if f.is_constant():
            return bool(f != 0)
        if state is not None and any(f in (p, -p) for p in state.nonzero):
            return True
        return not self._has_unknowns(f) and not self._possible(f)

    def _possible(self, f: Any) -> bool:
        """Whether f may vanish where the positive parameters are positive, by the signs of its terms."""
        signs = set()
        for m, c in f.to_dict().items():
            if any(power and name not in self.positive for name, power in zip(self.context.names(), m, strict=True)):
                return True
            signs.add(c > 0)
        return len(signs) > 1

    def _relation(self, state: _State) -> Relation | None:
        """f with the unknowns put in, and whether the relation is one: each coefficient a multiple of a condition."""
        gens = self.context.gens()
        variables = gens[self.count + len(self.others) :]
        f = variables[self.k]
        for a, j in zip(gens[self.count : self.count + len(self.others)], self.others, strict=True):
            f = f + a * variables[j]
        free = set(range(self.count, self.count + len(self.others)))
        for place, top, bottom in state.solved:
            f = with_quotient(f, place, top, bottom)
            free.discard(place)
        if any(f.degrees()[place] for place in free):
            self.complete = False  # a whole pencil of relations: its members are integrals, which are listed elsewhere
            return None
        gens_back = self.field.context.gens()
        zero = self.field.context.constant(0)
        images = [*gens_back[: self.count], *(zero for _ in self.others), *gens_back[self.count :]]
        back = primitive(self.field, f.compose(*images, ctx=self.field.context))
        independent = [p for k, p in enumerate(state.conditions) if not self._follows(p, state.conditions[:k])]
        if any(self._never(p, state.nonzero) for p in independent):
            return None
        conditions = tuple(p.compose(*images, ctx=self.field.context) for p in independent)
        apart = {str(p): p for p in state.nonzero}
        nonzero = tuple(p.compose(*images, ctx=self.field.context) for p in apart.values())
        # What holds variables stems from the denominator: that, and what divides it, is not zero at any system.
        nonzero = tuple(
            p
            for p in nonzero
            if not any(p.degrees()[k] for k in self.field.places) and divmod(self.field.denominator, p)[1] != 0
        )
        if not divides(self.field, back, conditions) or not is_regular_on(self.field, back, conditions):
            return None
        return Relation(back, conditions, nonzero)

    def _follows(self, p: Any, others: Sequence[Any]) -> bool:
        """Whether a condition is one of the others, once what is linear in a parameter has been put in."""
        for condition in others:
            k = next(
                (k for k in range(self.count) if condition.degrees()[k] == 1 and condition.derivative(k).is_constant()),
                None,
            )
            if k is not None:
                slope = condition.derivative(k)
                top = -(condition - slope * self.context.gen(k)) / slope.leading_coefficient()
                p = with_quotient(p, k, top, self.context.constant(1))
        return bool(p == 0)

    def _never(self, p: Any, nonzero: Sequence[Any]) -> bool:
        """Whether p is a sum of squares of real parameters, one of which is not zero."""
        names, terms = self.context.names(), p.to_dict()
        apart = set(self.positive) | {
            name for q in nonzero if len(q) == 1 for name, power in zip(names, q.monoms()[0], strict=True) if power
        }
        even = all(not a % 2 or name in self.positive for m in terms for name, a in zip(names, m, strict=True))
        if not even or len({c > 0 for c in terms.values()}) > 1:
            return False
        return any(all(name in apart for name, a in zip(names, m, strict=True) if a) for m in terms)


def _put(state: _State, more: Sequence[Any]) -> _State:
    return _State((*more, *state.equations), state.conditions, state.nonzero, state.solved)


def divides(field: PolynomialField, f: Any, conditions: Sequence[Any]) -> bool:
    """Whether f, linear, divides its derivative where the conditions hold: put in one by one, then divided by."""
    rate = field.derivative(f)
    for p in conditions:
        rate, f = put_in(field, p, (rate, f))
    if f == 0:
        return False
    place = next(k for k in field.places if f.degrees()[k])
    slope = f.derivative(place)
    rest = f - slope * field.context.gen(place)
    rate = with_quotient(rate, place, -rest, slope)
    return all(c == 0 or any(divmod(c, p)[1] == 0 for p in conditions) for c in coefficients(field, rate).values())
