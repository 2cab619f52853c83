"""The equations of motion as one polynomial vector field x' = X(x), whatever a description says its state by.

    det(M) u' = adj(M) f,      s' = g(s, u),      g' = dg/dx . x'    for every g that stands in X

Variables are the velocities or speeds u (under constraints in velocities those that are independent, in the equations
without multipliers), and what X holds of positions, by itself or in functions: coordinates, unit vectors and
quaternions; the sine and cosine of an angle, with s^2 + c^2 = 1; exponentials, e' = e a' with a the exponent, those of
a basis of the lattice that exponents span, or one relation between them; square roots, r^2 = p, r' = r p'/(2 p), and
with one of them alone 1/p; for problem 9 reciprocals w = 1/p, w' = -w^2 p'; phases that are driven at a rate. Each
variable brings in what its own derivative holds. Positions on which nothing depends are left out; constraints on
positions are relations between those that are left, or give one by others.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import combinations, islice
from math import gcd, lcm, prod
from random import Random
from typing import TYPE_CHECKING, Any

from flint import Ordering, fmpq, fmpq_mat, fmpq_mpoly_ctx, fmpz_mat

from mbsym.algebra.base import Lowering
from mbsym.algebra.factors import occurring, rational_ratio
from mbsym.algebra.failures import NoClosedForm
from mbsym.algebra.kernel import independent
from mbsym.algebra.matrices import cramer, determinant, null_space_of_polynomials
from mbsym.algebra.polynomial_field import PolynomialField, in_lowest_terms
from mbsym.algebra.ring import Polynomial, Ring
from mbsym.expressions.message import Message
from mbsym.expressions.rates import without_derivatives
from mbsym.formulas.formula import Formula
from mbsym.mechanics.speeds import SpeedForm
from mbsym.mechanics.variables import ring_environment
from mbsym.problems.equations import Equations

if TYPE_CHECKING:
    from mbsym.problems.constraints.motion import Embedded

#: No relations between parameters.
NOTHING: Mapping[int, Polynomial] = {}
#: Sets of exponentials that are tried as those of which others are powers.
MOST_BASES = 200
#: Why there is no field x' = f(x).
SINGULAR = "the mass matrix is singular everywhere, so that the equations do not determine all accelerations"


def vector_field(
    form: SpeedForm,
    equations: Equations,
    also: Sequence[Polynomial] = (),
    images: Mapping[int, Polynomial] = NOTHING,
    driven: bool = False,
    rooted: bool = False,
) -> tuple[PolynomialField, Transfer]:
    """x' over QQ[parameters], with det(M) as a part of the denominator, and the way from the ring there.

    Parameters are those that occur in the equations and in ``also``, where ``images`` (by generator) take the place of
    dependent ones; phases are variables where they may be ``driven``.  Where it may be ``rooted`` square roots of
    numbers are parameters of the field, with their squares, and reciprocals of polynomials in positions are variables
    if their relations are solved.  Raises NoClosedForm where M is singular, and where the time, inputs, other roots or
    functions other than exponentials occur.
    """
    tied = equations.constraints
    if rooted and not tied.position_rank:  # else reciprocals may be tied by what ties positions
        with suppress(NoClosedForm):
            field, transfer = _of(_State(form, equations, images, driven, rooted, divided=True), also)
            if field.are_solved:
                return field, transfer
    return _of(_State(form, equations, images, driven, rooted), also)


def _of(state: _State, also: Sequence[Polynomial]) -> tuple[PolynomialField, Transfer]:
    variables = state.variables()
    images, ring = state.images, state.ring
    relations = state.relations(variables)
    polynomials = [state.determinant, *variables.values()]
    fractions = [ring.fraction(p, state.kept) for p in polynomials]
    held = [factor for _, factors in fractions for factor, _ in factors]
    also = [put_in(ring, x, images) for x in also]
    also = [p for x in also for p in (ring.fraction(x)[0], *(f for f, _ in ring.fraction(x)[1]))]
    places = {k: state.name(k) for k in variables}
    parameters = occurring([*(p for p, _ in fractions), *held, *relations, *also])
    roots = [k for k in parameters if is_number_root(ring, k)]
    parameters = [k for k in parameters if k not in places and ring.generators[k].kind == "parameter"] + roots
    transfer = Transfer(ring, places, parameters, images, state.kept)
    tops, bottoms = zip(*(transfer.fraction(p) for p in polynomials), strict=True)
    common: Any = bottoms[0]
    for bottom in bottoms[1:]:
        common = common * (bottom / bottom.gcd(common))
    cleared = [top * (common / bottom) for top, bottom in zip(tops, bottoms, strict=True)]
    moved, denominator = in_lowest_terms(cleared[1:], cleared[0])
    units = frozenset(name for k, name in places.items() if state.is_unit(k))
    field = PolynomialField(
        transfer.context,
        transfer.parameters,
        transfer.variables,
        tuple(moved),
        denominator,
        tuple(map(transfer, relations)),
        roots=tuple((transfer.name(k), transfer(ring.generators[k].argument)) for k in roots),
        units=units,
    )
    return on_rows(field) if state.rows else field, transfer


def on_rows(field: PolynomialField) -> PolynomialField:
    """The same by what positions keep that constraints tie.

    Raises NoClosedForm where the relations are not solved for a variable each, or the field is singular on them.
    """
    if not field.are_solved:
        raise NoClosedForm(
            "constraints tie positions by relations that do not give one power of a variable each",
            remedy="choose coordinates that keep them; a closed loop has none as a rule: problem 7 tells what it keeps",
        )
    denominator = field.reduced(field.denominator)
    if denominator == 0:
        raise NoClosedForm(SINGULAR)
    moved, denominator = in_lowest_terms([field.reduced(p) for p in field.numerators], denominator)
    return replace(field, numerators=tuple(moved), denominator=denominator)


class _State:
    """Generators of the ring as variables: how each moves, how it is called, what ties it to others."""

    def __init__(
        self,
        form: SpeedForm,
        equations: Equations,
        images: Mapping[int, Polynomial],
        driven: bool,
        rooted: bool,
        divided: bool = False,
    ) -> None:
        system, ring = form.system, form.ring
        self.rooted, self.divided = rooted, divided
        self.ring, self.equations = ring, equations
        free, tied, self.rows = _free(form, equations, images)
        self.rates = {name: put_in(ring, rate, tied) for name, rate in form.rates.items()}
        images = {**images, **self._powers()}
        self.images, self.driven = {**images, **tied}, driven
        mass, forcing = free.mass_matrix.polynomials, [x.polynomial for x in free.forcing]
        whole = determinant(ring, mass)
        if ring.vanishes(whole):
            raise NoClosedForm(SINGULAR)
        self.determinant, *scaled = (put_in(ring, p, images) for p in (whole, *cramer(ring, mass, forcing)))
        self.unknowns = {u.index: u.name for u in form.speeds if u.index not in tied}
        self.accelerations = dict(zip(self.unknowns, scaled, strict=True))
        lower = Lowering(ring, ring_environment(system, ring))
        self.rates |= {item.name: lower(item.rate) for item in system.prescribed if driven}

    @property
    def kept(self) -> list[int]:
        """Reciprocals that are variables, and no denominators: of exponentials, positions, of what is under a root."""
        ring = self.ring
        reciprocals = (k for k in range(ring.spare) if ring.generators[k].kind == "reciprocal")
        return [*(k for k in reciprocals if self._exponent(k) is not None), *self._inverse]

    @property
    def _inverse(self) -> list[int]:
        """1/p, where p stands under the only root and its leading coefficient is 1, so that 1/p leads a relation.

        Where it is ``divided``, of all p in positions.
        """
        ring = self.ring
        if self.divided:
            reciprocals = (k for k in range(ring.spare) if ring.generators[k].kind == "reciprocal")
            return [k for k in reciprocals if self._is_of_positions(ring.generators[k].argument)]
        squares = [ring.generators[k].argument for k in range(ring.spare) if self._is_root(k)]
        if len(squares) != 1 or any(
            g.kind == "parameter" and power for g, power in zip(ring.generators, squares[0].monomial(0), strict=True)
        ):
            return []
        reciprocals = (k for k in range(ring.spare) if ring.generators[k].kind == "reciprocal")
        return [k for k in reciprocals if rational_ratio(ring.generators[k].argument, squares[0]) is not None]

    def is_unit(self, k: int) -> bool:
        """Whether it vanishes in no state: an exponential, 1/p, and the root of a p that the equations divide by."""
        return k in self.kept or self._exponent(k) is not None or (self._is_root(k) and bool(self._inverse))

    def _is_root(self, k: int) -> bool:
        """Whether it is the square root of a polynomial in positions, cosines and parameters."""
        g = self.ring.generators[k]
        return g.kind == "root" and self._is_of_positions(g.argument, ("coordinate", "cosine"))

    def _is_of_positions(self, argument: Polynomial, kinds: Collection[str] = ("coordinate",)) -> bool:
        """Whether it moves, and holds what is of these ``kinds``, parameters and reciprocals of parameters alone."""
        ring, held = self.ring, occurring([argument])
        tied = {name for sides in self.equations.products for _, names in sides for name in names}
        moved = [k for k in held if ring.generators[k].kind in kinds and self._follows(k)]
        moved = [k for k in moved if ring.generators[k].name not in tied]  # of unit vectors squares are sums of others
        fixed = {
            k
            for k in ring.held([argument])
            if ring.generators[k].kind in ("parameter", "reciprocal") or is_number_root(ring, k)
        }
        return (
            bool(moved)
            and {*moved, *fixed}.issuperset(held)
            and not any(ring.dependencies(ring.context.gen(k), self.rates) for k in fixed)
        )

    def _exponent(self, k: int) -> Any:
        """a, where the generator is exp(a) and a is made of positions and parameters; else None."""
        ring, sign = self.ring, 1
        g = ring.generators[k]
        if g.kind == "reciprocal":
            inner, sign = occurring([g.argument])[0], -1
            if g.argument != ring.context.gen(inner):
                return None
            g = ring.generators[inner]
        if g.kind != "function" or g.name != "exp":
            return None
        held = [(i, ring.generators[i]) for i in occurring([g.argument])]
        moved = [i for i, generator in held if self._follows(i)]
        constant = all(i in moved or generator.kind == "parameter" or is_number_root(ring, i) for i, generator in held)
        return sign * g.argument if moved and constant else None

    def _follows(self, k: int) -> bool:
        """Whether it is a position, a sine or a cosine that moves as ``rates`` say."""
        g = self.ring.generators[k]
        if g.kind in ("sine", "cosine") and g.argument is not None:  # of x/l, with l a parameter
            return self._is_of_positions(g.argument)
        return g.kind in ("coordinate", "sine", "cosine", "prescribed") and g.name in self.rates

    def variables(self) -> dict[int, Polynomial]:
        """det(M) times the derivative of every variable, in the order in which they are told."""
        ring, rates, waiting = self.ring, dict(self.accelerations), [self.determinant, *self.accelerations.values()]
        while waiting:
            fractions = [ring.fraction(p, self.kept) for p in waiting]
            held = occurring([*(p for p, _ in fractions), *(f for _, factors in fractions for f, _ in factors)])
            waiting = [rates.setdefault(k, self._rate(k)) for k in sorted(self._moving(held) - rates.keys())]
            if not waiting:
                self.rows = self._felt(rates)
                waiting = [
                    rates.setdefault(k, self._rate(k)) for k in self._moving(occurring(self.rows)) - rates.keys()
                ]
        return {k: rates[k] for k in sorted(rates, key=self._order)}

    def _moving(self, held: Iterable[int]) -> set[int]:
        """Generators that are no parameters, sines with their cosines."""
        generators = self.ring.generators
        fixed = {k for k in held if generators[k].kind == "parameter" or (self.rooted and is_number_root(self.ring, k))}
        return {i for k in held if k not in fixed for i in (k, self._partner(k))}

    def _felt(self, variables: Collection[int]) -> list[Polynomial]:
        """The rows without those that only give a position that is no variable; it is put in where they are linear."""
        rows = list(self.rows)
        while True:
            held = [self._moving(occurring([row])) for row in rows]
            apart = [own - {*variables}.union(*held[:i], *held[i + 1 :]) for i, own in enumerate(held)]
            place = next((i for i, own in enumerate(apart) if own), None)
            if place is None:
                return rows
            row = rows.pop(place)
            for k in apart[place]:
                slope = row.derivative(k)
                if slope.is_constant() and self.ring.generators[k].kind == "coordinate":
                    self.images = {k: self.ring.context.gen(k) - row / slope, **self.images}

    def _partner(self, k: int) -> int:
        """The cosine of a sine, and the other way round."""
        ring, g = self.ring, self.ring.generators[k]
        other = {"sine": "cosine", "cosine": "sine"}.get(g.kind)
        if g.argument is not None and other is not None:
            same = (i for i in range(ring.spare) if ring.generators[i].argument == g.argument)
            return next(i for i in same if ring.generators[i].kind == other)
        return k if other is None or not ring.has(other, g.name) else ring.index(other, g.name)

    def _order(self, k: int) -> tuple[int, int]:
        """Velocities, roots (each leads its relation), pairs of sine and cosine, positions, functions."""
        g, names = self.ring.generators[k], [*self.rates]
        if k in self.unknowns:
            return 0, list(self.unknowns).index(k)
        if g.kind == "root":
            return 1, k
        if g.kind in ("sine", "cosine") and g.name in names:
            return 2, 2 * names.index(g.name) + (g.kind == "cosine")
        if g.name in names:  # what hangs on others comes first, where it is tied to them
            return 3, names.index(g.name) * (-1 if self.rows else 1)
        return 4, -k

    def _rate(self, k: int) -> Polynomial:
        """det(M) dg/dt of a generator g."""
        ring, own = self.ring, self.ring.context.gen(k)
        if not self._follows(k) and self._exponent(k) is None and not self._is_root(k) and k not in self.kept:
            raise no_variable(ring, k)
        slopes = [ring.times(ring.derivative(own, x), self.rates[x]) for x in ring.dependencies(own, self.rates)]
        return ring.reduce(ring.times(self.determinant, put_in(ring, ring.reduce(sum(slopes, ring.zero)), self.images)))

    def name(self, k: int) -> str:
        """``theta_dot``, ``sin(theta/2)``, ``exp(x - y)``, ``sqrt(x**2 + y**2)``."""
        g, exponent = self.ring.generators[k], self._exponent(k)
        if k in self.unknowns:
            return self.unknowns[k]
        if exponent is not None:
            return f"exp({Formula(self.ring, exponent)})"
        if g.kind in ("sine", "cosine"):
            angle = g.name if g.denominator == 1 else f"{g.name}/{g.denominator}"
            return f"{g.kind[:3]}({angle if g.argument is None else Formula(self.ring, g.argument)})"
        return str(g.name) if g.argument is None else str(Formula(self.ring, self.ring.context.gen(k)))

    def relations(self, variables: Collection[int]) -> list[Polynomial]:
        """What vanishes on all states."""
        ring, found = self.ring, []
        roots = [k for k in variables if self._is_root(k)]
        if not independent(ring, [ring.context.gen(k) for k in roots]):
            raise NoClosedForm(
                "[[names]]: it is not shown that no product of what stands under these roots is a square",
                names=", ".join(map(self.name, roots)),
                remedy="write what is a square without a root, as 2*sin(x/2) for sqrt(2 - 2*cos(x))",
            )
        for k in roots:
            found.append(ring.context.gen(k) ** 2 - ring.generators[k].argument)
        for k in variables:
            if ring.generators[k].kind == "sine":
                found.append(ring.context.gen(k) ** 2 + ring.context.gen(self._partner(k)) ** 2 - 1)
        inverse = [k for k in variables if k in self._inverse]
        beside = {k: self._moving(occurring([ring.generators[k].argument])) for k in inverse}
        alone = [k for k in inverse if beside[k].isdisjoint(variables)]
        found += [ring.context.gen(k) * ring.generators[k].argument - 1 for k in inverse if k not in alone]
        between = self._between_reciprocals(alone)
        names = {ring.generators[k].name for k in variables}
        for (name, components), (other, others) in self.equations.products:
            if names.issuperset((*components, *others)):
                total = ring.zero if name != other else -ring.one
                for a, b in zip(components, others, strict=True):
                    total = total + ring.generator("coordinate", a) * ring.generator("coordinate", b)
                found.append(total)
        exponentials = [k for k in variables if self._exponent(k) is not None]
        found += [row / row.leading_coefficient() for row in self.rows]
        tied = self._between_exponentials(exponentials)
        angles = [k for k in variables if ring.generators[k].kind == "sine" and ring.generators[k].argument is not None]
        apart = {*exponentials, *angles, *map(self._partner, angles)}
        left = [k for k in variables if k not in apart and k not in alone]
        self._refuse_dependent([*exponentials, *angles, *alone], left, len(tied) + len(between))
        return [*found, *tied, *between]

    def _between_reciprocals(self, places: Sequence[int]) -> list[Polynomial]:
        """sum_k c_k prod_(j != k) w_j  of the reciprocals w of positions p with  sum_k c_k p_k = 0, if there is one."""
        ring = self.ring
        columns, count = _in_monomials([ring.generators[k].argument for k in places]).nullspace()
        held = (
            [(ring.context.gen(k), c) for n, k in enumerate(places) if (c := int(columns[n, 0]))] if count == 1 else []
        )
        terms = [prod((x for x, _ in held if x is not w), start=ring.one) * c for w, c in held]
        return [sum(terms, ring.zero) / sum(terms, ring.zero).leading_coefficient()] if terms else []

    def _refuse_dependent(self, functions: Sequence[int], others: Sequence[int], tied: int) -> None:
        """Raises NoClosedForm where variables are functions of each other but for relations: ranks would mislead."""
        ring = self.ring
        exponents = [ring.generators[k].argument if self._exponent(k) is None else self._exponent(k) for k in functions]
        under = sorted({name for a in exponents for name in ring.dependencies(a, self.rates)})
        beside = [self.name(k) for k in others if k not in self.unknowns and ring.generators[k].name in under]
        chance = Random("exponents")
        point = [
            x if is_number_root(ring, k) else ring.number(chance.randint(2, 99))
            for k, x in enumerate(ring.context.gens())
        ]
        slopes = [[ring.reduce(ring.derivative(a, name).compose(*point)) for name in under] for a in exponents]
        if beside or len(null_space_of_polynomials(ring, list(zip(*slopes, strict=True)), len(slopes))) > tied:
            dependent = ", ".join([*map(self.name, functions), *beside])
            raise NoClosedForm(
                "[[names]] are functions of each other: they cannot all be variables",
                names=dependent,
                remedy="see 'mbsym symmetries', which needs no polynomials",
            )

    def _between_exponentials(self, places: Sequence[int]) -> list[Polynomial]:
        """exp(a) exp(-a) = 1, and exp(a)^m exp(b)^n ... = exp(c)^k ... for integers with  m a + n b + ... = k c + ...

        Raises NoClosedForm where only constants are left of such a sum, or several are zero.
        """
        ring = self.ring
        apart, inverses = self._up_to_inverses(places)
        between = [ring.context.gen(j) * ring.context.gen(k) - 1 for j, k in inverses.items()]
        columns, count = self._exponents_of(apart).nullspace()
        if not count:
            return between
        column = [int(columns[k, 0]) for k in range(len(apart))]
        powers = [x // gcd(*column) for x in column]
        if between or count > 1 or not self._are_one(apart, powers):
            raise NoClosedForm(
                "the exponentials [[names]] are related in several ways, or by a constant factor",
                names=", ".join(map(self.name, places)),
                remedy="write them as powers of fewer exponentials",
            )
        sides = [ring.one, ring.one]
        for k, n in zip(apart, powers, strict=True):
            sides[int(n < 0)] = sides[int(n < 0)] * ring.context.gen(k) ** abs(n)
        difference = sides[0] - sides[1]
        return [*between, difference / difference.leading_coefficient()]

    def _powers(self) -> dict[int, Polynomial]:
        """Exponentials as products of powers of some of them and of reciprocals, where several relations hold.

        Exponents span a lattice over the integers.  Those that are a basis of it are taken; {} where none are.
        """
        ring = self.ring
        apart, inverses = self._up_to_inverses(
            [k for k in reversed(range(ring.spare)) if self._exponent(k) is not None]
        )
        exponents = fmpq_mat(self._exponents_of(apart))
        size = exponents.rank()
        if len(apart) - size + bool(inverses) < 2 or len(apart) == size:
            return {}
        bases = []
        for basis in islice(combinations(range(len(apart)), size), MOST_BASES):
            columns = [*basis, *(j for j in range(len(apart)) if j not in basis)]
            rows, _ = fmpq_mat([[row[j] for j in columns] for row in exponents.tolist()]).rref()
            held = [apart[j] for j in basis]
            powers = {apart[j]: [rows[i, k] for i in range(size)] for k, j in enumerate(columns) if k >= size}
            if all(rows[i, i] == 1 for i in range(size)) and all(n.q == 1 for row in powers.values() for n in row):
                product = {j: dict(zip(held, map(int, row), strict=True)) for j, row in powers.items()}
                if all(self._are_one([j, *held], [-1, *own.values()]) for j, own in product.items()):
                    bases.append(product)
        if not bases:
            return {}
        shortest = min(bases, key=lambda product: sum(abs(n) for own in product.values() for n in own.values()))
        signed = [(j, 1, own) for j, own in shortest.items()]
        signed += [(inverses[j], -1, own) for j, _, own in signed if j in inverses]
        images = {}
        for k, sign, own in signed:
            factors = [(j if sign * n > 0 else self._reciprocal(j, inverses), abs(n)) for j, n in own.items() if n]
            images[k] = prod((ring.context.gen(j) ** n for j, n in factors), start=ring.one)
        return images

    def _reciprocal(self, k: int, inverses: Mapping[int, int]) -> int:
        """The generator that is 1/exp(a) of the generator exp(a)."""
        return inverses[k] if k in inverses else occurring([self.ring.reciprocal(self.ring.context.gen(k))])[0]

    def _up_to_inverses(self, places: Sequence[int]) -> tuple[list[int], dict[int, int]]:
        """Exponentials of which none is the reciprocal of another; and the reciprocals of some of them, by these."""
        apart, inverses = list[int](), dict[int, int]()
        for k in places:
            other = next((j for j in apart if self._are_one([j, k], [1, 1])), None)
            if other is None:
                apart.append(k)
            else:
                inverses[other] = k
        return apart, inverses

    def _exponents_of(self, places: Sequence[int]) -> fmpz_mat:
        """What moves of the exponents, in columns: rational multiples of monomials, a row for each, times a number."""
        gens = zip(self.ring.generators, self.ring.context.gens(), strict=True)
        still = [x if g.kind in ("parameter", "root") else self.ring.zero for g, x in gens]
        return _in_monomials([a - a.compose(*still) for a in map(self._exponent, places)])

    def _are_one(self, places: Sequence[int], powers: Sequence[int]) -> bool:
        """Whether the product of these powers of exponentials is 1."""
        ring = self.ring
        return ring.vanishes(ring.dot(list(map(self._exponent, places)), list(map(ring.number, powers))))


def _in_monomials(polynomials: Sequence[Polynomial]) -> fmpz_mat:
    """Their coefficients in columns, a row for each monomial, times a number."""
    parts = [p.to_dict() for p in polynomials]
    rows = [[part.get(m, fmpq(0)) for part in parts] for m in sorted({m for part in parts for m in part})]
    whole = [int((x * lcm(*(int(y.q) for y in row))).p) for row in rows for x in row]
    return fmpz_mat(len(rows), len(parts), whole)


def _free(
    form: SpeedForm, equations: Equations, images: Mapping[int, Polynomial]
) -> tuple[Embedded, Mapping[int, Polynomial], list[Polynomial]]:
    """The equations of the independent velocities, the dependent ones by these (q' = Y u), and what ties positions.

    The last are polynomials that vanish.  A coordinate that one of them gives is put in, as dependent velocities are.
    """
    tied, ring = equations.constraints, form.ring
    if equations.embedded is None or tied.solved is None:
        raise NoClosedForm("the equations without multipliers outgrow the budget of terms")
    from mbsym.problems.constraints.motion import dependent_velocities  # few systems have constraints

    told = [tied.position[k] for k in tied.independent]
    rows = [put_in(ring, ring.fraction(row.polynomial)[0], images) for row in told if row is not None]
    return equations.embedded, dependent_velocities(form, tied.solved), rows


def is_number_root(ring: Ring, k: int) -> bool:
    """Whether the generator is the square root of a number; the ring takes those of primes, which are independent."""
    g = ring.generators[k]
    return g.kind == "root" and g.argument.is_constant()


def put_in(ring: Ring, p: Polynomial, images: Mapping[int, Polynomial]) -> Polynomial:
    """p with what relations say in place of dependent parameters."""
    return ring.substitute(p, images) if images else p


class Transfer:
    """Polynomials of a ring over a context of parameters and variables alone.  Raises NoClosedForm for others.

    ``places``: generators of the ring that are variables, by name; ``kept`` those that are reciprocals.
    """

    def __init__(
        self,
        ring: Ring,
        places: dict[int, str],
        parameters: Sequence[int],
        images: Mapping[int, Polynomial] = NOTHING,
        kept: Collection[int] = (),
    ) -> None:
        self.ring, self.images, self.kept = ring, images, kept
        self.parameters = tuple(map(self.name, parameters))
        self.variables = tuple(places.values())
        self.places = (*parameters, *places)
        self.context: Any = fmpq_mpoly_ctx.get([*self.parameters, *self.variables], Ordering.lex)

    def name(self, k: int) -> str:
        """Of a parameter: itself, or ``sqrt(3)``."""
        return str(
            self.ring.generators[k].name
            if self.ring.generators[k].argument is None
            else Formula(self.ring, self.ring.context.gen(k))
        )

    def __call__(self, p: Polynomial) -> Any:
        degrees = p.degrees()
        for k, degree in enumerate(degrees):
            if degree > 0 and k not in self.places:  # of 0 they are all -1
                raise no_variable(self.ring, k)
        return self.context.from_dict({tuple(m[k] for k in self.places): c for m, c in p.to_dict().items()})

    def fraction(self, p: Polynomial) -> tuple[Any, Any]:
        """(P, Q) with p = P/Q, for p with reciprocals of polynomials in the parameters; relations are used."""
        top, factors = self.ring.fraction(put_in(self.ring, p, self.images), self.kept)
        bottom = self.context.constant(1)
        for factor, exponent in factors:
            bottom *= self(factor) ** exponent
        return self(top), bottom

    def told(self, p: Any, names: Sequence[str]) -> Polynomial:
        """A polynomial over generators of these names, some of the context's, in the ring."""
        places = [(*self.parameters, *self.variables).index(name) for name in names]
        terms = {}
        for monomial, c in p.to_dict().items():
            exponents = [0] * len(self.places)
            for k, power in zip(places, monomial, strict=True):
                exponents[k] = power
            terms[tuple(exponents)] = c
        return self.back(self.context.from_dict(terms))

    def back(self, p: Any) -> Polynomial:
        """A polynomial of the context in the ring."""
        total: dict[tuple[int, ...], Any] = {}
        for monomial, c in p.to_dict().items():
            exponents = [0] * len(self.ring.generators)
            for k, power in zip(self.places, monomial, strict=True):
                exponents[k] = power
            total[tuple(exponents)] = c
        return self.ring.context.from_dict(total)


def no_variable(ring: Ring, k: int) -> NoClosedForm:
    """Why a generator cannot be one of a polynomial field, and what to write in its place."""
    g = ring.generators[k]
    if g.kind == "function" and g.name == "exp":  # it would be one, if not for what its exponent holds
        allowed = ("coordinate", "velocity", "sine", "cosine", "parameter")
        held = [i for i in occurring([g.argument]) if ring.generators[i].kind not in allowed]
        if held and any(ring.generators[i].kind != "parameter" for i in occurring([g.argument])):
            return no_variable(ring, held[0])
    what: Message | str = Message(g.kind)
    remedy = ""
    if g.argument is not None and not any(ring.generators[i].kind != "parameter" for i in occurring([g.argument])):
        what = Message("the constant [[formula]]", formula=str(Formula(ring, ring.context.gen(k))))
        remedy = "write a parameter in its place: its value may be any number"
    elif g.kind == "prescribed":  # an input, too
        what = Message("[[name]], a function of the time,", name=without_derivatives(g.name))
    elif g.kind == "time":
        what = Message("the time")
    elif g.kind == "function" and g.name:
        what = Message("the function [[name]]", name=g.name)
    elif g.argument is not None:
        what = str(Formula(ring, ring.context.gen(k)))
    elif g.name and not g.name.startswith("#"):
        what = Message("[[kind]] of [[name]]", kind=Message(g.kind), name=g.name)
    message = Message("[[what]] occurs: the equations are not polynomial in speeds and positions", what=what)
    return NoClosedForm(message, remedy=remedy) if remedy else NoClosedForm(message)
