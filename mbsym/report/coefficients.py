"""Long conditions in the coefficients of the characteristic polynomial: v4^2 v2^2 - 4 v2^3 v6 - ..., as papers print.

A discriminant of hundreds of terms is five in its coefficients.  The form is what the stability kernel computes, done
again over letters; the letters put back give its polynomial exactly, or no such form is shown.
"""

from __future__ import annotations

from dataclasses import dataclass

from mbsym.algebra.characteristic import Polynomial, lienard_chipart, subdiscriminants
from mbsym.algebra.ring import Ring
from mbsym.formulas.formula import Formula
from mbsym.formulas.letters import letters
from mbsym.formulas.names import parts
from mbsym.problems.stability.requirements import Requirement

#: Shorter conditions are written out.
WRITTEN_OUT = 40
#: A form with more terms than this helps nobody.
MOST_TERMS = 60


#: Letters of coefficients, the first of which that is no parameter's is taken: of even polynomials, and of others.
_STEMS = ("v", "a", "c", "h", "w", "z")


@dataclass(frozen=True)
class InCoefficients:
    """``formula`` over letters of its own (v6, v4, ... or a3, a2, ...); ``letters``: each with what it stands for."""

    formula: Formula
    letters: tuple[tuple[Formula, Formula], ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(str(letter) for letter, _ in self.letters)


def names_in(ring: Ring) -> frozenset[str]:
    """The names that formulas over the ring may hold, and those that look like them: v4 for ``v_4``, which is v_{4}."""
    names = [*ring.names(), *(wanted.wanted if (wanted := letters()) is not None else ())]
    return frozenset([*names, *map(_looks, names)])


def is_letter(formula: Formula, name: str) -> bool:
    """Whether a formula is written as that letter of the description, and nothing else."""
    return letters() is not None and str(formula) == name


def _looks(name: str) -> str:
    """The shortest name that reports write in the same way."""
    split = parts(name)
    return split.stem + "_".join(split.indices)


def in_coefficients(ring: Ring, requirement: Requirement) -> InCoefficients | None:
    """The form of a requirement that is too long to be read; None where there is none.

    The requirement is an inequality that nothing was split off from, so that form and polynomial have one sign.  The
    letters are those of the labels, v4 or a3, where no parameter is called so; of several factors v4_2, of the second.
    """
    condition, coefficients = requirement.condition, requirement.coefficients
    if condition.kind != "inequality" or condition.nonzero or len(condition.polynomial) <= WRITTEN_OUT:
        return None
    label, _, factor = requirement.label.partition(" of factor ")
    names = _letters("discriminant" in label, [Formula(ring, x) for x in coefficients], factor, names_in(ring))
    present = [(name, x) for name, x in zip(names, coefficients, strict=True) if x != 0]
    own = Ring((), (), [name for name, _ in reversed(present)], {})
    given = [own.generator("parameter", n) if own.has("parameter", n) else own.zero for n in names]
    value = _made(label, given)
    if value is None or not 2 * len(value) < len(condition.polynomial) or len(value) > MOST_TERMS:
        return None
    standing = dict(present)
    images = [standing.get(g.name, ring.zero) for g in own.generators]
    if value.compose(*images, ctx=ring.context) != requirement.polynomial:
        return None
    stand_for = [(Formula(own, own.generator("parameter", n)), Formula(ring, x)) for n, x in reversed(present)]
    return InCoefficients(Formula(own, value), tuple(stand_for))


def _letters(even: bool, coefficients: list[Formula], factor: str, taken: frozenset[str]) -> list[str]:
    """Names of the coefficients, from low to high powers, none of which is ``taken`` for something else."""
    count = len(coefficients)
    power, end = (2 if even else 1), f"_{factor}" if factor else ""
    stems = _STEMS if even else (*_STEMS[1:], *_STEMS[:1])
    listed = ([f"{stem}{power * k}{end}" for k in range(count)] for stem in stems)
    free = next(
        (
            one
            for one in listed
            if all(x not in taken or is_letter(c, x) for x, c in zip(one, coefficients, strict=True))
        ),
        None,
    )
    return free or [f"coefficient{power * k}{end}" for k in range(count)]


def _made(label: str, coefficients: list[Polynomial]) -> Polynomial | None:
    """What a label stands for, of a polynomial with these coefficients."""
    word, _, number = label.rpartition(" ")
    if label == "discriminant":
        return subdiscriminants(coefficients)[-1]
    if word == "subdiscriminant":
        return subdiscriminants(coefficients)[int(number) - 1]
    return dict(lienard_chipart(coefficients)).get(label) if word == "Hurwitz minor" else None
