"""Symmetries of a system and their integrals, with numbers in place of some parameters."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.expressions.message import Message
from mbsym.mechanics.constraints.refusal import refuse_constraints
from mbsym.mechanics.motion import relations
from mbsym.problems.symmetries.search import Blocks, Symmetries, blocks, symmetries

if TYPE_CHECKING:
    from mbsym.analysis.pipeline import Analysis


def symmetries_of(analysis: Analysis, values: Mapping[str, Fraction] | None = None) -> Symmetries:
    """All symmetries with fields of degree one in the positions (Gamma: two), free of the time, and their integrals.

    Raises Failure where equations or their coefficients outgrow a bound, SingularPoint where formulas divide by zero at
    the ``values``.
    """
    analysis = analysis.in_free_coordinates
    refuse_constraints(analysis.system, Message("symmetries are not looked for"))
    return symmetries(analysis.system, blocks_of(analysis, values), analysis.optional("integrals"))


def blocks_of(analysis: Analysis, values: Mapping[str, Fraction] | None = None) -> Blocks:
    """What conditions of symmetries are made of, with numbers in place of some parameters."""
    ring = analysis.ring
    numbers = ring.given(values or {})
    images = {k: ring.substitute(x, numbers) for k, x in relations(analysis.parameters_scene).items()} | numbers
    return blocks(analysis.form, analysis.scene, analysis.energy, analysis.equations, images)
