"""Constraints of a description in words: one sentence each, with gaps that LaTeX and HTML fill."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mbsym.expressions.tree import Expression
from mbsym.model.constraints import Coincide, Constraint, Distance, Parallel, Relation, Rolling, Velocity
from mbsym.model.system import Point, Vector


@dataclass(frozen=True)
class Medium:
    """How a medium writes formulas, a vector, a body, and a point of a body."""

    equation: Callable[[Expression, Expression], object]
    formula: Callable[[Expression], object]
    vector: Callable[[Vector], object]
    frame: Callable[[str], object]
    point: Callable[[Point], object]


def described(constraint: Constraint, write: Medium) -> tuple[str, dict[str, object]]:
    """The sentence in English with ``[[gaps]]``, and what stands in them."""
    match constraint:
        case Coincide(first, second):
            return "Two points coincide: [[first]] and [[second]].", {
                "first": write.point(first),
                "second": write.point(second),
            }
        case Parallel(first, second):
            return (
                "Two axes are parallel: [[first]] of [[body]] and [[second]] of [[other]].",
                {
                    "first": write.vector(first.direction),
                    "body": write.frame(first.body),
                    "second": write.vector(second.direction),
                    "other": write.frame(second.body),
                },
            )
        case Distance(first, second, length):
            return (
                "Two points keep the distance [[length]]: [[first]] and [[second]].",
                {"first": write.point(first), "second": write.point(second), "length": write.formula(length)},
            )
        case Rolling(body, contact, axes, on):
            return (
                "Rolling without slipping of [[body]] on [[on]]: the contact is at [[contact]] from the connection "
                "point, in the axes of [[axes]].",
                {
                    "body": write.frame(body),
                    "on": write.frame(on),
                    "contact": write.vector(contact),
                    "axes": write.frame(axes),
                },
            )
        case Relation(left, right):
            return "Relation between coordinates: [[equation]].", {"equation": write.equation(left, right)}
        case Velocity(left, right):
            return "Relation between velocities: [[equation]].", {"equation": write.equation(left, right)}
    raise TypeError(f"not a constraint: {constraint!r}")
