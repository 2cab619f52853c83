"""What problem 8 finds, as values: each statement with how it is known."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from mbsym.algebra.certainty import Certainty
from mbsym.formulas.formula import Formula, Shown
from mbsym.problems.stability.verdict import Verdict


@dataclass(frozen=True)
class Region:
    """Where each of the ``signs`` (polynomial, ``>``, ``<`` or ``!=``) holds, K has ``degree`` negative eigenvalues."""

    signs: tuple[tuple[Formula, str], ...]
    degree: int


@dataclass(frozen=True, repr=False)
class Gyroscopic(Shown):
    """Of one subsystem with N = 0: Poincare's degree of instability of K, region by region.

    No region where the minors of K outgrew their budget.  ``free`` eigenvalues of K vanish for all parameters.
    ``present``: G is not zero; ``damped``: D is not zero; ``size``: how many coordinates there are.
    """

    coordinates: tuple[str, ...]
    regions: tuple[Region, ...]
    present: bool
    damped: bool
    free: int = 0

    @property
    def size(self) -> int:
        return len(self.coordinates)

    @property
    def degree(self) -> int | None:
        """The degree, where it is the same everywhere; None where there are places of which nothing is said."""
        return self.regions[0].degree if len(self.regions) == 1 and not self.regions[0].signs else None


@dataclass(frozen=True)
class Locus:
    """Parameter values at which a rank is lost.

    Proved: where one of ``factors`` vanishes it is lost; elsewhere only where all formulas of ``together`` vanish at
    once (nowhere, where these are none), and then it is.  All of this where no formula of ``provided`` vanishes.
    """

    factors: tuple[Formula, ...] = ()
    together: tuple[Formula, ...] = ()
    provided: tuple[Formula, ...] = ()


@dataclass(frozen=True, repr=False)
class Rank(Shown):
    """Whether [ lambda^2 M + lambda C + S, B ] has full rank for all lambda (Hautus), for almost all parameters.

    ``full`` and how ``sure`` that is; where it is not, ``factors`` are the coefficients, low to high in lambda, of
    polynomials at whose roots it is lost for all parameters.  ``locus`` is None where it was not found.
    """

    full: bool
    certainty: Certainty
    factors: tuple[tuple[Formula, ...], ...] = ()
    locus: Locus | None = None
    why_not: str = ""

    @property
    def everywhere(self) -> bool:
        """Whether it is full at all parameters that are allowed."""
        return self.full and self.locus == Locus()


@dataclass(frozen=True, repr=False)
class Motion(Shown):
    """A motion exp(lambda t) v that dissipation does not feel: lambda^2 = -``square``, v = ``shape``; exactly."""

    square: Formula
    shape: tuple[Formula, ...] | None


@dataclass(frozen=True, repr=False)
class Dissipation(Shown):
    """Of one subsystem with D != 0, N = 0: is D pervasive (does every motion with D x' = 0 rest)?

    ``complete``: whether D > 0, ``semidefinite``: whether D >= 0, without which D may feed motions instead of damping
    them: True proved, False refuted, None not known.  ``at_values``: whether it is pervasive at the given values,
    exactly; None without any.
    """

    coordinates: tuple[str, ...]
    complete: bool | None
    semidefinite: bool | None
    rank: Rank
    motions: tuple[Motion, ...] = ()
    at_values: bool | None = None


@dataclass(frozen=True, repr=False)
class Control(Shown):
    """Of one subsystem, or of the whole: controllability by the ``inputs``; exactly at the given values, if any."""

    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    rank: Rank
    at_values: bool | None = None
    stabilisable_at_values: bool | None = None


@dataclass(frozen=True, repr=False)
class Feedback(Shown):
    """u = -gains z at the given values, found as an LQR in floating point, rationalised, and then proved.

    ``states`` z are the coordinates and the velocities that are no functions of others.  ``characteristic`` is that of
    the closed loop, exactly, low to high powers; all its roots are to the left (``verdict``: that of problem 6's exact
    judge on the closed loop).  ``lyapunov`` is a rational P > 0 with P A + A^T P < 0, both proved; None where none was
    found.  At irrational values, which are enclosed, there is no ``characteristic``, and P is the proof.
    ``of_part`` says why not all coordinates are in z, if they are not: the closed loop is that of those in it.
    """

    states: tuple[str, ...]
    of_part: str
    gains: tuple[tuple[Fraction, ...], ...]
    characteristic: tuple[Fraction, ...]
    verdict: Verdict
    lyapunov: tuple[tuple[Fraction, ...], ...] | None


@dataclass(frozen=True, repr=False)
class EnergyFunction(Shown):
    """V = x'.M x'/2 + x.K x/2 of one subsystem with N = 0:  dV/dt = -x'.D x',  V > 0 where K > 0.

    ``minors`` of K that must be positive, known ones left out; ``definite``: True proved, False refuted, None open;
    ``at_values``: whether K > 0 at the given values, None without any.
    ``bundle``: rational weights w_k at the given values with which sum w_k E_k, E_k = V of the k-th derivative of the
    motion, is positive definite (proved); None where it was not looked for, or not found.
    """

    coordinates: tuple[str, ...]
    conserved: bool
    minors: tuple[Formula, ...]
    definite: bool | None
    at_values: bool | None = None
    bundle: tuple[Fraction, ...] | None = None


@dataclass(frozen=True, repr=False)
class Stabilisation(Shown):
    """Problem 8.  ``control`` begins with the whole system; ``least`` are the smallest sets of inputs that suffice for
    almost all parameters, () where none does or there are none; ``no_feedback`` says why there is no ``feedback``.
    ``left_out``: coordinates of which a constrained system's independent equations know nothing.  Of a ``nonholonomic``
    one nothing is said of gyroscopic forces, energy and dissipation: D, G, K, N split two matrices, no more.  Nor is it
    of ``circulatory`` coordinates, in whose subsystem N is not zero."""

    gyroscopic: tuple[Gyroscopic, ...]
    dissipation: tuple[Dissipation, ...]
    control: tuple[Control, ...]
    least: tuple[tuple[str, ...], ...]
    feedback: Feedback | None
    no_feedback: str
    energy: tuple[EnergyFunction, ...]
    left_out: tuple[str, ...] = ()
    nonholonomic: bool = False
    circulatory: tuple[str, ...] = ()
