"""The exact ring: QQ[parameters][q', q''][sin q, cos q, q] modulo sin^2 + cos^2 = 1, with a derivation as a table.

Scalars are raw ``fmpq_mpoly`` of python-flint: arithmetic on them is where the speed is, so no wrapper stands
between.  Normal forms are taken after products of vectors, not after every addition.

What is not polynomial is adjoined as a spare generator with a relation: a reciprocal (x * x_inverse = 1), a root
(rho^2 = p), a function (its derivative is known).  Generators are ordered so that in the lexicographic order the term
to be eliminated leads its relation: adjoined ones first (the latest before the earlier ones it may depend on), then
sines before cosines.  For reciprocals the normal form is not always unique; ``is_zero`` therefore clears
denominators before it decides.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from flint import Ordering, arb, ctx, fmpq, fmpq_mpoly_ctx, fmpz

from mbsym.algebra.base import Algebra, NoClosedForm, SingularPoint
from mbsym.expressions.angles import LinearForm

Polynomial = Any

#: Products with more candidate terms than this, and polynomials longer than the term budget, have "no closed form".
PRODUCT_BUDGET = 40_000_000
TERM_BUDGET = 400_000


@dataclass(frozen=True, slots=True)
class Generator:
    """What one generator of the ring stands for.

    ``kind`` is one of parameter, coordinate, velocity, acceleration, prescribed, time, sine, cosine, reciprocal, root,
    function.  ``name`` is the declared name; for sines and cosines the angle is ``name / denominator`` (or, for an
    angle that is no single name, ``argument``).  Adjoined generators keep the polynomial they are the reciprocal, root
    or function of in ``argument``.
    """

    kind: str
    name: str
    denominator: int = 1
    argument: Polynomial = None


class Ring(Algebra):
    """One context per system.

    coordinates, prescribed, parameters: declared names, disjoint.  angles: the names that stand under sin and cos,
    each with the common denominator of its coefficients there (sin(q/2) makes it 2).  positive: the parameters known to
    be positive (a root of their squares is taken exactly).  spare: how many generators may be adjoined.  terms: the
    budget of terms a formula may have; beyond it NoClosedForm is raised.
    """

    def __init__(
        self,
        coordinates: Sequence[str],
        prescribed: Sequence[str],
        parameters: Sequence[str],
        angles: Mapping[str, int],
        positive: Iterable[str] = (),
        spare: int = 8,
        terms: int = TERM_BUDGET,
    ) -> None:
        self.term_budget = terms
        self.spare = spare
        layout: list[Generator] = [Generator("spare", f"#{spare - 1 - k}") for k in range(spare)]
        layout += [Generator("acceleration", name) for name in coordinates]
        layout += [Generator("velocity", name) for name in coordinates]
        layout += [Generator("sine", name, angles[name]) for name in angles]
        layout += [Generator("cosine", name, angles[name]) for name in angles]
        layout += [Generator("coordinate", name) for name in coordinates]
        layout += [Generator("prescribed", name) for name in prescribed]
        layout += [Generator("time", "t"), Generator("parameter", "pi")]
        layout += [Generator("parameter", name) for name in parameters]
        self.generators = layout
        self.context = fmpq_mpoly_ctx.get([f"x{k}" for k in range(len(layout))], Ordering.lex)
        self._gens = self.context.gens()
        self._index = {(g.kind, g.name): k for k, g in enumerate(layout)}
        self._free = spare - 1
        self.zero = self.context.constant(0)
        self.one = self.context.constant(1)
        self._positive = {self._index["parameter", name] for name in positive if ("parameter", name) in self._index}
        self._relations: list[tuple[tuple[tuple[int, int], ...], Polynomial]] = []
        self._derivatives: dict[str, dict[int, Polynomial]] = {}
        self.angles = dict(angles)
        self._declare_angles()

    def _declare_angles(self) -> None:
        moving = {g.name for g in self.generators if g.kind in ("coordinate", "prescribed", "time")}
        for name in sorted(moving):
            kind = "coordinate" if ("coordinate", name) in self._index else "prescribed"
            index = self._index["time", "t"] if name == "t" else self._index[kind, name]
            self._derivatives[name] = {index: self.one}
            if kind == "coordinate":  # loads may hold functions of velocities: exp(q'), which the chain rule must reach
                self._derivatives[name + "_dot"] = {self._index["velocity", name]: self.one}
        for name, denominator in self.angles.items():
            s, c = self._index["sine", name], self._index["cosine", name]
            self._relate(((s, 2),), self._gens[s] ** 2 + self._gens[c] ** 2 - 1)
            if name in moving:
                factor = fmpq(1, denominator)
                self._derivatives[name] |= {s: self._gens[c] * factor, c: -self._gens[s] * factor}

    def _relate(self, leading: tuple[tuple[int, int], ...], relation: Polynomial) -> None:
        """Later relations stand first: they may bring in what the earlier ones reduce."""
        self._relations.insert(0, (leading, relation))

    # --- scalars ---------------------------------------------------------------------------------------------------

    def number(self, value: Fraction | int) -> Polynomial:
        value = Fraction(value)
        return self.context.constant(fmpq(value.numerator, value.denominator))

    def generator(self, kind: str, name: str) -> Polynomial:
        return self._gens[self._index[kind, name]]

    def index(self, kind: str, name: str) -> int:
        return self._index[kind, name]

    def has(self, kind: str, name: str) -> bool:
        return (kind, name) in self._index

    def times(self, a: Polynomial, b: Polynomial) -> Polynomial:
        if len(a) * len(b) > PRODUCT_BUDGET:
            raise NoClosedForm(f"a product of {len(a)} by {len(b)} terms is beyond the budget")
        return a * b

    def vanishes(self, x: Polynomial) -> bool:
        return bool(x.is_zero())

    def reduce(self, x: Polynomial) -> Polynomial:
        """Normal form: each relation's leading term eliminated, sin^2 -> 1 - cos^2 among them."""
        if len(x) > self.term_budget:
            raise NoClosedForm(f"{len(x)} terms are beyond the budget of {self.term_budget}")
        again = True
        while again:
            again = False
            degrees = x.degrees()
            for leading, relation in self._relations:
                for k, d in leading:
                    if degrees[k] < d:
                        break
                else:
                    reduced = divmod(x, relation)[1]
                    if reduced != x:
                        x, degrees, again = reduced, reduced.degrees(), len(self._relations) > len(self.angles)
        return x

    # --- angles ------------------------------------------------------------------------------------------------------

    def sin_cos(self, angle: LinearForm) -> tuple[Polynomial, Polynomial]:
        sine, cosine = self._constant_angle(angle.turns)
        for name, coefficient in angle.coefficients:
            multiple = coefficient * self.angles[name]
            if multiple.denominator != 1:
                raise NoClosedForm(f"sin and cos of {coefficient}*{name} were not foreseen")
            s, c = self.multiple_angle(self.generator("sine", name), self.generator("cosine", name), int(multiple))
            sine, cosine = sine * c + cosine * s, cosine * c - sine * s
        return self.reduce(sine), self.reduce(cosine)

    def multiple_angle(self, s: Polynomial, c: Polynomial, n: int) -> tuple[Polynomial, Polynomial]:
        """sin(n x) and cos(n x) from s = sin x and c = cos x."""
        sine, cosine = self.zero, self.one
        for _ in range(abs(n)):
            sine, cosine = self.reduce(sine * c + cosine * s), self.reduce(cosine * c - sine * s)
        return (-sine if n < 0 else sine), cosine

    def _constant_angle(self, turns: Fraction) -> tuple[Polynomial, Polynomial]:
        """sin and cos of turns*pi, where they are made of square roots of 2 and 3."""
        turns = turns % 2
        if turns >= 1:
            s, c = self._constant_angle(turns - 1)
            return -s, -c
        if turns > Fraction(1, 2):
            s, c = self._constant_angle(1 - turns)
            return s, -c
        if turns > Fraction(1, 4):
            s, c = self._constant_angle(Fraction(1, 2) - turns)
            return c, s
        half = self.number(Fraction(1, 2))
        if turns == 0:
            return self.zero, self.one
        if turns == Fraction(1, 4):
            return (half * self.square_root(self.number(2)),) * 2
        if turns == Fraction(1, 6):
            return half, half * self.square_root(self.number(3))
        raise NoClosedForm(f"sin and cos of {turns}*pi: only multiples of pi/4 and pi/6 are supported")

    def sin_cos_of(self, argument: Polynomial) -> tuple[Polynomial, Polynomial]:
        """An angle of its own, such as ``Omega*t``: two adjoined generators with the chain rule."""
        if argument.is_zero():
            return self.zero, self.one
        index = self._adjoined("sine", argument)
        if index is None:
            c = self._adjoin("cosine", argument)
            index = s = self._adjoin("sine", argument)  # adjoined later, so that it leads s^2 + c^2 - 1
            self._relate(((s, 2),), self._gens[s] ** 2 + self._gens[c] ** 2 - 1)
            for name in self._derivatives:
                inner = self.derivative(argument, name)
                if not inner.is_zero():
                    self._derivatives[name] |= {s: self._gens[c] * inner, c: -self._gens[s] * inner}
        return self._gens[index], self._gens[index + 1]

    # --- adjoined elements -------------------------------------------------------------------------------------------

    def _adjoin(self, kind: str, argument: Polynomial, name: str = "") -> int:
        if self._free < 0:
            raise NoClosedForm(f"more than {self.spare} reciprocals, roots and functions")
        index = self._free
        self._free -= 1
        self.generators[index] = Generator(kind, name or f"#{index}", 1, argument)
        return index

    def _adjoined(self, kind: str, argument: Polynomial, name: str = "") -> int | None:
        for index in range(self._free + 1, self.spare):
            known = self.generators[index]
            if known.kind == kind and (not name or known.name == name) and known.argument == argument:
                return index
        return None

    def _chain(self, index: int, outer: Polynomial, argument: Polynomial) -> None:
        """d generator = outer * d argument, for every variable."""
        for name in self._derivatives:
            inner = self.derivative(argument, name)
            if not inner.is_zero():
                self._derivatives[name][index] = self.reduce(outer * inner)

    def reciprocal(self, x: Polynomial) -> Polynomial:
        """1/x, one adjoined generator for each irreducible factor of x.

        Raises SingularPoint if x is zero.
        """
        x = self.reduce(x)
        if x.is_zero():
            raise SingularPoint("division by zero")
        content, factors = x.factor()
        result = self.context.constant(1 / content)
        for factor, exponent in factors:
            result = result * self._reciprocal_of_factor(factor) ** exponent
        return self.reduce(result)

    def _reciprocal_of_factor(self, factor: Polynomial) -> Polynomial:
        inverse = self._inverse_of_adjoined(factor)
        if inverse is not None:
            return inverse
        index = self._adjoined("reciprocal", factor)
        if index is None:
            index = self._adjoin("reciprocal", factor)
            generator = self._gens[index]
            leading = tuple((k, e) for k, e in enumerate(factor.monomial(0)) if e)
            self._relate((*leading, (index, 1)), factor * generator - 1)
            self._chain(index, -(generator**2), factor)
            if self.is_positive(factor):
                self._positive.add(index)
        return self._gens[index]

    def _inverse_of_adjoined(self, factor: Polynomial) -> Polynomial | None:
        """1/(1/p) = p and 1/sqrt(p) = sqrt(p)/p need no generator of their own."""
        for index in range(self._free + 1, self.spare):
            if factor == self._gens[index]:
                known = self.generators[index]
                if known.kind == "reciprocal":
                    return known.argument
                if known.kind == "root":
                    return self._gens[index] * self.reciprocal(known.argument)
        return None

    def square_root(self, x: Polynomial) -> Polynomial:
        """sqrt(x): squares of positive factors come out exactly, the rest is adjoined with rho^2 = rest."""
        x = self.reduce(x)
        if x.is_zero():
            return self.zero
        content, factors = x.factor()
        outside, inside, numbers = self.one, self.one, Fraction(int(content.p), int(content.q))
        for factor, exponent in factors:
            positive = self.is_positive(factor)
            if positive:
                outside = outside * factor ** (exponent // 2)
                exponent = exponent % 2
            inside = inside * factor**exponent
        rational, radicand = _square_part(abs(numbers))
        outside = outside * self.number(rational)
        if inside.is_constant():
            if numbers < 0:
                raise SingularPoint("the square root of a negative number")
            for prime in _primes(radicand):
                outside = outside * self._root(self.number(prime))
            return self.reduce(outside)
        sign = -1 if numbers < 0 else 1
        return self.reduce(outside * self._root(inside * (sign * radicand)))

    def _root(self, radicand: Polynomial) -> Polynomial:
        index = self._adjoined("root", radicand)
        if index is None:
            index = self._adjoin("root", radicand)
            root = self._gens[index]
            self._relate(((index, 2),), root**2 - radicand)
            if any(not self.derivative(radicand, name).is_zero() for name in self._derivatives):
                self._chain(index, root * self.reciprocal(radicand) * fmpq(1, 2), radicand)
        return self._gens[index]

    def function(self, name: str, x: Polynomial) -> Polynomial:
        """exp and log and their kin, as adjoined generators whose derivatives are the textbook's."""
        if name in ("sinh", "cosh", "tanh"):
            up = self.function("exp", x)
            down = self.function("exp", -x)
            half = fmpq(1, 2)
            sinh, cosh = (up - down) * half, (up + down) * half
            return {"sinh": sinh, "cosh": cosh}.get(name) or self.reduce(sinh * self.reciprocal(cosh))
        if x.is_zero() and name in ("exp", "atan"):
            return self.one if name == "exp" else self.zero
        if x.is_one() and name == "log":
            return self.zero
        if name == "exp" and self._adjoined("function", -x, "exp") is not None:
            return self.reciprocal(self.function("exp", -x))
        index = self._adjoined("function", x, name)
        if index is None:
            index = self._adjoin("function", x, name)
            moving = any(not self.derivative(x, variable).is_zero() for variable in self._derivatives)
            if moving:
                outer = {
                    "exp": lambda: self._gens[index],
                    "log": lambda: self.reciprocal(x),
                    "atan": lambda: self.reciprocal(self.one + x * x),
                }[name]()
                self._chain(index, outer, x)
        return self._gens[index]

    def is_positive(self, x: Polynomial) -> bool:
        """Whether x is a sum of positive terms in positive parameters: sufficient, never wrong."""
        return all(
            coefficient > 0 and all(k in self._positive or e % 2 == 0 for k, e in enumerate(monomial) if e)
            for monomial, coefficient in x.terms()
        ) and any(all(k in self._positive for k, e in enumerate(monomial) if e) for monomial in x.monoms())

    # --- derivation --------------------------------------------------------------------------------------------------

    def derivative(self, x: Polynomial, name: str) -> Polynomial:
        """Partial derivative with respect to a coordinate, a prescribed quantity or t, chain rule included."""
        total = self.zero
        degrees = x.degrees()
        for index, inner in self._derivatives[name].items():
            if degrees[index] > 0:
                total = total + self.times(x.derivative(index), inner)
        return self.reduce(total)

    def velocity_derivative(self, x: Polynomial, name: str) -> Polynomial:
        """Partial derivative with respect to the velocity of a coordinate."""
        if len(self._derivatives[name + "_dot"]) > 1:
            return self.derivative(x, name + "_dot")
        return x.derivative(self._index["velocity", name])

    def depends_on(self, x: Polynomial, name: str) -> bool:
        """Whether a coordinate, a prescribed quantity or t occurs (plainly, under sin and cos, or adjoined)."""
        degrees = x.degrees()
        return any(degrees[index] > 0 for index in self._derivatives[name])

    # --- substitution ------------------------------------------------------------------------------------------------

    def substitute(self, x: Polynomial, values: Mapping[int, Polynomial]) -> Polynomial:
        """Generators replaced by polynomials, adjoined ones rebuilt from their arguments at the new place.

        Raises SingularPoint where a reciprocal's argument vanishes there.
        """
        return self._substitute(x, dict(values))

    def _substitute(self, x: Polynomial, images: dict[int, Polynomial]) -> Polynomial:
        degrees = x.degrees()
        for index in range(self.spare - 1, self._free, -1):
            if degrees[index] > 0 and index not in images:
                images[index] = self._moved(index, images)
        touched = [index for index in images if degrees[index] > 0]
        constant = [index for index in touched if images[index].is_constant()]
        for index in constant:  # the remainder modulo g - number puts the number for g, faster than a composition
            x = divmod(x, self._gens[index] - images[index])[1]
        touched = [index for index in touched if index not in constant and x.degrees()[index] > 0]
        if not touched:
            return self.reduce(x) if constant else x
        full = list(self._gens)
        for index in touched:
            full[index] = images[index]
        return self.reduce(x.compose(*full))

    def _moved(self, index: int, images: dict[int, Polynomial]) -> Polynomial:
        known = self.generators[index]
        argument = self._substitute(known.argument, images)
        if argument == known.argument:
            return self._gens[index]
        if known.kind == "reciprocal":
            return self.reciprocal(argument)
        if known.kind == "root":
            return self.square_root(argument)
        if known.kind == "function":
            return self.function(known.name, argument)
        return self.sin_cos_of(argument)[0 if known.kind == "sine" else 1]

    # --- zero test ---------------------------------------------------------------------------------------------------

    def fraction(self, x: Polynomial) -> tuple[Polynomial, list[tuple[Polynomial, int]]]:
        """(numerator, [(factor, exponent), ...]) with x = numerator / product: reciprocals cleared, gcds removed."""
        denominators: list[tuple[Polynomial, int]] = []
        x = self.reduce(x)
        for index in range(self._free + 1, self.spare):
            known = self.generators[index]
            degree = int(x.degrees()[index])
            if known.kind != "reciprocal" or degree <= 0:
                continue
            cleared = self.zero
            for monomial, coefficient in x.terms():
                exponents = list(monomial)
                lacking = degree - int(exponents[index])
                exponents[index] = 0
                cleared = cleared + self.context.term(coefficient, tuple(exponents)) * known.argument**lacking
            x = self.reduce(cleared)
            while degree and x and divmod(x, known.argument)[1].is_zero():
                x, degree = divmod(x, known.argument)[0], degree - 1
            if degree:
                denominators.append((known.argument, degree))
        return x, denominators

    def is_zero(self, x: Polynomial) -> bool | None:
        """True (proved zero), False (proved different from zero), or None where this ring cannot decide.

        Sines, cosines, reciprocals and roots of primes are decided algebraically.  Behind other adjoined elements
        (sqrt((1 + cos x)^2), log(exp x), sin(x + 1)) a nonzero normal form may hide a zero: there only balls at random
        points prove "nonzero".
        """
        numerator, _ = self.fraction(x)
        if numerator.is_zero():
            return True
        degrees = numerator.degrees()
        adjoined = [g for k, g in enumerate(self.generators[: self.spare]) if degrees[k] > 0]
        if all(g.kind == "root" and g.argument.is_constant() for g in adjoined):
            return False
        return False if self._nonzero_at_random(numerator) else None

    def _nonzero_at_random(self, x: Polynomial) -> bool:
        """Whether a ball at some random point excludes zero."""
        source = random.Random(20240229)
        keep, ctx.prec = ctx.prec, 400
        try:
            for _ in range(4):
                value = self.evaluate(x, {name: fmpq(source.randint(1, 99), 64) for name in self.names()})
                if not value.contains(0) and value.is_finite():
                    return True
        finally:
            ctx.prec = keep
        return False

    def names(self) -> list[str]:
        """The keys that ``evaluate`` wants: declared names and ``<name>_dot``, ``<name>_ddot``."""
        suffix = {"velocity": "_dot", "acceleration": "_ddot"}
        plain = ("coordinate", "prescribed", "time", "parameter", "velocity", "acceleration")
        return [g.name + suffix.get(g.kind, "") for g in self.generators if g.kind in plain and g.name != "pi"]

    def evaluate(self, x: Polynomial, values: Mapping[str, Any]) -> Any:
        """The value as a ball (``arb``, working precision ``flint.ctx.prec``) at numbers for all names."""
        return _Evaluation(self, values)(x)


class ParameterRing(Ring):
    """The part of a ring that holds only some parameters: short exponent vectors, no relations.

    What concerns parameters alone (conditions, discriminants) is an order of magnitude faster here.  ``indices`` are
    generators of ``whole``, all of kind parameter; ``project`` carries polynomials over.
    """

    def __init__(self, whole: Ring, indices: Sequence[int]) -> None:
        if any(whole.generators[k].kind != "parameter" for k in indices):
            raise ValueError("only parameters can be split off")
        self.whole = whole
        self.term_budget = whole.term_budget
        self.spare, self._free = 0, -1
        self.indices = tuple(indices)
        self.generators = [whole.generators[k] for k in indices]
        self.context = fmpq_mpoly_ctx.get([f"x{k}" for k in indices], Ordering.lex)
        self._gens = self.context.gens()
        self._index = {(g.kind, g.name): k for k, g in enumerate(self.generators)}
        self.zero, self.one = self.context.constant(0), self.context.constant(1)
        self._positive = {self.indices.index(k) for k in whole._positive if k in self.indices}
        self._relations, self._derivatives, self.angles = [], {}, {}

    def project(self, x: Polynomial) -> Polynomial:
        """A polynomial of the whole ring in these parameters only."""
        return x.project_to_context(self.context)

    def lift(self, x: Polynomial) -> Polynomial:
        """A polynomial of this ring in the whole ring."""
        return x.project_to_context(self.whole.context)


class _Evaluation:
    """Evaluates polynomials at ball values of the declared names; generators are computed on demand."""

    def __init__(self, ring: Ring, values: Mapping[str, Any]) -> None:
        self.ring = ring
        self.values = values
        self.known: dict[int, Any] = {}

    def __call__(self, x: Polynomial) -> Any:
        total = arb(0)
        used = [k for k, degree in enumerate(x.degrees()) if degree > 0]
        base = {k: self.generator(k) for k in used}
        for monomial, coefficient in x.terms():
            term = arb(coefficient)
            for k in used:
                if monomial[k]:
                    term *= base[k] ** int(monomial[k])
            total += term
        return total

    def generator(self, index: int) -> Any:
        if index not in self.known:
            self.known[index] = self._value(self.ring.generators[index])
        return self.known[index]

    def _value(self, g: Generator) -> Any:
        match g.kind:
            case "sine" | "cosine":
                inner = self(g.argument) if g.argument is not None else arb(self.values[g.name]) / g.denominator
                return inner.sin() if g.kind == "sine" else inner.cos()
            case "reciprocal":
                return 1 / self(g.argument)
            case "root":
                return self(g.argument).sqrt()
            case "function":
                return getattr(self(g.argument), g.name)()
            case "velocity":
                return arb(self.values[g.name + "_dot"])
            case "acceleration":
                return arb(self.values[g.name + "_ddot"])
        return arb.pi() if g.name == "pi" else arb(self.values[g.name])


def _square_part(value: Fraction) -> tuple[Fraction, int]:
    """(r, n) with value = r^2 n, n a square-free integer."""
    whole = value.numerator * value.denominator
    outside, inside = 1, 1
    for prime in _primes(whole, distinct=False):
        if inside % prime == 0:
            inside, outside = inside // prime, outside * prime
        else:
            inside *= prime
    return Fraction(outside, value.denominator), inside


def _primes(n: int, distinct: bool = True) -> list[int]:
    return [int(p) for p, e in fmpz(n).factor() for _ in range(1 if distinct else int(e))]
