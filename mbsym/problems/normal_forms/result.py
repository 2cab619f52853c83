"""What problem 11 finds, as values: a word, the theorem behind it, and the numbers that it rests on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from flint import arb, ctx

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.point import Balls
from mbsym.algebra.truncated import Truncated, bracket, flow
from mbsym.formulas.formula import Formula, Shown
from mbsym.problems.normal_forms.birkhoff import NormalForm
from mbsym.problems.stability.words import HigherOrder, Word


class Outcome(StrEnum):
    """What is said of the nonlinear system."""

    ASYMPTOTIC = "asymptotically stable"
    STABLE = "stable"
    #: No formal power series in the deviations shows a drift: it would be slower than any power of them.
    FORMAL = "formally stable"
    #: Invariant tori fill most of a neighbourhood: stability for most initial states, in Lyapunov's sense open.
    MOST = "stable for most initial states"
    UNSTABLE = "unstable"
    UNDECIDED = "undecided"

    def __repr__(self) -> str:
        return repr(self.value)


Theorem = HigherOrder


class Why(StrEnum):
    """Why nothing, or no more, is decided."""

    NONE = ""
    #: A root that is zero, or is not told from zero.
    ZERO_ROOT = "zero-root"
    TWO_ZERO_ROOTS = "two-zero-roots"
    EQUAL_FREQUENCIES = "equal-frequencies"
    #: The same in more than two degrees of freedom.
    EQUAL_MORE = "equal-more"
    #: Of equal frequencies with two eigenvectors: the form of order 4 on the cone has a multiple zero, or no simple one
    #: is proved.
    CONE_OPEN = "cone-open"
    #: Zero is a root of multiplicity two with two eigenvectors, or of a higher one.
    ZERO_TWO = "zero-two"
    #: A zero root in more than two degrees of freedom where H is not definite.
    ZERO_MORE = "zero-more"
    #: The energy along the kernel vanishes to the order looked at, or is not told from that.
    ZERO_OPEN = "zero-open"
    #: Frequencies whose ratio is not told from a resonance.
    RESONANCE_OPEN = "resonance-open"
    #: A resonance that the theorems for non-resonant frequencies exclude.
    RESONANCE = "resonance"
    #: The resonant term is not told from zero.
    RESONANT_TERM_OPEN = "resonant-term-open"
    #: The two sides of Markeev's inequality are not told apart.
    EQUALITY = "equality"
    DETERMINANT_OPEN = "determinant-open"
    #: The form of order 4 vanishes in the cone of actions, or is not told from one that does.
    FORM_OPEN = "form-open"
    COEFFICIENT_OPEN = "coefficient-open"
    #: More than one pair of imaginary roots in a system that is not Hamiltonian.
    MORE_PAIRS = "more-pairs"
    MIXED_ROOTS = "mixed-roots"
    #: Roots on the imaginary axis are proved at rational numbers only.
    IRRATIONAL = "irrational"
    #: Coordinates are singular there, or what moves has no mass: there are no momenta.
    SINGULAR_MASS = "singular-mass"
    #: At the given values the description divides by zero; or the motion is not shown to exist.
    POLE = "pole"
    NO_MOTION = "no-motion"


@dataclass(frozen=True)
class Resonance:
    """k.w = 0 exactly, |k_1| + |k_2| + ... = ``order``; frequencies in the order of the result."""

    vector: tuple[int, ...]

    @property
    def order(self) -> int:
        return sum(map(abs, self.vector))


@dataclass(frozen=True, repr=False)
class Judged(Shown):
    """At numbers.  ``frequencies`` Omega_k with the sign of their energies (enclosures), largest first.

    ``quadratic`` are the coefficients of I_j I_k (j <= k) of the normal form of order 4, where it was formed.
    ``determinants`` are D_4 and D_6 as far as they were needed; ``resonances`` those that hold exactly up to the order
    that was looked at.  Of one pair of imaginary roots: ``coefficient`` a of r' = d r + a r^3, r the amplitude of
    ``amplitude_of`` in first approximation, ``frequencies`` its w; a of  a r^5  where ``degree`` is 5.  Of equal
    frequencies with one eigenvector:
    ``coefficient`` delta A of Sokolskii's normal form.  Of a zero root of a Hamiltonian system: ``coefficient`` a of
    the energy a x^M + ... along its kernel, M ``degree``, x the variable ``along``.
    """

    outcome: Outcome
    theorem: Theorem
    why: Why = Why.NONE
    frequencies: tuple[Any, ...] = ()
    quadratic: tuple[tuple[tuple[int, int], Any], ...] = ()
    determinants: tuple[tuple[int, Any], ...] = ()
    resonances: tuple[Resonance, ...] = ()
    coefficient: Any = None
    amplitude_of: str = ""
    #: The two sides of Markeev's inequality of the resonance of fourth order: |H_4(k)| and what it is compared with.
    sides: tuple[Any, Any] | None = None
    degree: int | None = None
    along: str = ""


@dataclass(frozen=True, repr=False)
class Vanishing(Shown):
    """Numerator of D_4 and resonances without the factors that are not zero for any parameters of the given signs."""

    determinant: Formula
    resonances: tuple[tuple[tuple[int, int], Formula], ...]


@dataclass(frozen=True, repr=False)
class InSymbols(Shown):
    """Of two degrees of freedom, for almost all parameters.

    ``trace`` and ``product`` are w1^2 + w2^2 and w1^2 w2^2; where both and ``discriminant`` (trace^2 - 4 product) are
    positive the first approximation is stable.  ``determinant`` is D_4, ``zero`` its
    numerator: where that vanishes order 6 has to be looked at.
    ``resonances`` vanish where w1 : w2 or w2 : w1 is that of the vector, orders 3 and 4.
    """

    trace: Formula
    product: Formula
    discriminant: Formula
    determinant: Formula
    zero: Formula
    resonances: tuple[tuple[tuple[int, int], Formula], ...]
    #: What is left of both by the signs of the parameters; None where these were not asked.
    vanishing: Vanishing | None = None


@dataclass(frozen=True, repr=False)
class Focus(Shown):
    """Of one pair of imaginary roots +-i w that is one for all parameters: ``square`` is w^2, ``coefficient`` a."""

    square: Formula
    coefficient: Formula
    amplitude_of: str


@dataclass(frozen=True, repr=False)
class NormalForms(Shown):
    """Problem 11.  ``coordinates`` without the ``cyclic`` ones, whose momenta keep their unperturbed values.

    ``at_values`` is None without numbers; ``in_symbols`` where there is no such formula, ``no_symbols`` says why.
    """

    coordinates: tuple[str, ...]
    cyclic: tuple[str, ...]
    conservative: bool
    order: int
    at_values: Judged | None
    in_symbols: InSymbols | Focus | None
    no_symbols: str = ""
    #: Whether there are applied forces that Lagrange's function takes in: they have a generalized potential.
    taken_in: bool = False
    #: What problem 6 says at the same values.
    first: Word | None = None
    #: What it says for all parameters, where that is one verdict that leaves nothing open.
    everywhere: Word | None = None
    #: Whether the equations have no terms of higher order at all: for all parameters, and at the given values.
    linear: bool = False
    linear_at_values: bool = False


# The second route to a normal form: its transformation written out, and substituted.
#
# The generators give x(xi, eta) by Lie series.  Then two things are looked at that the normalisation does not use: the
# brackets {x_i, x_j} are those of J to the order, so that the transformation is canonical; and H(x(xi, eta)), formed by
# plain substitution, is the normal form to the order.


def transformation(form: NormalForm) -> list[Truncated]:
    """x_1 ... x_n, p_1 ... p_n in xi and eta, to the order of the normal form."""
    space = form.hamiltonian.space
    rows = [space.linear(column[i] for column in form.linear.columns) for i in range(space.variables)]
    for generator in form.generators:
        rows = [flow(row, generator) for row in rows]
    return rows


def defects(hamiltonian: Truncated, form: NormalForm) -> Iterator[Any]:
    """What has to vanish: coefficients of {x_i, x_j} - J_ij below the order, and of H(x(xi, eta)) - normal form."""
    rows = transformation(form)
    space, n = form.hamiltonian.space, len(form.linear.roots)
    for i, row in enumerate(rows):
        for j in range(i):
            expected = space.constant(space.one).scaled(-1) if i == j + n else space.nothing
            rest = bracket(row, rows[j]) - expected
            yield from (value for key, value in rest.coefficients.items() if sum(key) < space.order)
    difference = hamiltonian.composed(rows) - form.hamiltonian
    yield from difference.coefficients.values()


def symbols_agree(forms: NormalForms, values: Mapping[str, Any]) -> bool | None:
    """Whether D_4 and w_1^2 w_2^2 in parameters are at the values what enclosures of the normal form there are.

    Roots of polynomials and floating balls on one side, a tower of square roots over the parameters on the other.  None
    where one of them is not there.
    """
    symbols, judged = forms.in_symbols, forms.at_values
    if not isinstance(symbols, InSymbols) or judged is None or len(judged.frequencies) != 2:
        return None
    with ctx.workprec(320):
        balls = {"pi": arb.pi()}
        balls |= {k: x if isinstance(x, arb) else arb(x.numerator) / x.denominator for k, x in values.items()}
        carry = Carrier(symbols.determinant.ring, Balls(balls), balls)
        first, second = judged.frequencies
        pairs = [(carry(symbols.product.polynomial), (first * second) ** 2)]
        pairs += [(carry(symbols.determinant.polynomial), x) for order, x in judged.determinants if order == 4]
        return all((a - b).contains(0) for a, b in pairs)
