"""Formulas of a description as MathML, as they are written."""

from __future__ import annotations

from collections.abc import Sequence as Items

from mbsym.editing.document.written import child
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints
from mbsym.expressions.tree import Expression, names
from mbsym.formulas.mathml import MathNames, row, table
from mbsym.report.html.description import expression
from mbsym.source.placed import Mapping, Node, Scalar, Sequence


def content(tree: Expression) -> str:
    """What stands in a ``<math>``."""
    return str(expression(tree, MathNames(sorted(names(tree)))))


def math(inner: str) -> str:
    return f"<math>{inner}</math>"


def vector(trees: Items[Expression]) -> str:
    return math(row([content(one) for one in trees]))


def mathml_of(node: Node) -> str | None:
    """A formula, a vector or a matrix of formulas; None where something of it is none."""
    if isinstance(node, Mapping):
        node = child(node, "tensor") or node
    if isinstance(node, Scalar):
        cell = _cell(node)
        return None if cell is None else math(cell)
    if not isinstance(node, Sequence) or not node.items:
        return None
    if all(isinstance(item, Sequence) for item in node.items):
        rows = [_cells(item) for item in node.items]
        return None if any(one is None for one in rows) else math(table([one for one in rows if one is not None]))
    cells = _cells(node)
    return None if cells is None else math(row(cells))


def _cells(node: Node) -> list[str] | None:
    cells = [_cell(item) for item in node.items] if isinstance(node, Sequence) else []
    found = [cell for cell in cells if cell is not None]
    return found if cells and len(found) == len(cells) else None


def _cell(node: Node) -> str | None:
    if not isinstance(node, Scalar) or not node.text.strip():
        return None
    tree = parse_expression(node.text, Complaints(), node.place)
    return None if tree is None else content(tree)
