"""Base parameters and regressor as files: JSON, LaTeX, a module of Python; and in sentences."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

from mbsym.algebra.evaluate import Carrier
from mbsym.algebra.program import Node, Program
from mbsym.expressions.message import Message
from mbsym.expressions.tree import decimal_text
from mbsym.mechanics.regressor import KINDS, Standard
from mbsym.mechanics.variables import program_environment
from mbsym.report.documents import parameters as doc
from mbsym.report.documents.base import file_of

if TYPE_CHECKING:
    from mbsym.formulas.formula import Formula
    from mbsym.problems.regressor import Base, Regressor


def named(standard: Standard) -> str:
    """``Jxx(upper arm)``."""
    return f"{standard.kind}({standard.body})"


def sum_of(base: Base) -> str:
    """``Jzz(one) + l**2 m(two)``."""
    formula = named(base.parameter)
    for other, factor in base.others:
        text = _number(factor) or str(factor)
        sign, text = ("-", text[1:]) if text.startswith("-") and not set(text[1:]) & set("+-") else ("+", text)
        if set(text) & set("+-"):
            text = f"({text})"
        formula += f" {sign} {named(other)}" if text == "1" else f" {sign} {text}*{named(other)}"
    return formula


def _number(factor: Formula) -> str:
    """A decimal as descriptions write it, 0.2717 and not 2717/10000; "" for others: 1/2 may be a squared sine."""
    number = Fraction(str(factor)) if factor.is_number else Fraction(0)
    return "" if number.denominator % 5 else decimal_text(number)


def regressor_json(regressor: Regressor) -> str:
    """The file's text."""
    return file_of(
        doc.Regressor,
        regressor.system,
        regressor,
        coordinates=regressor.system.coordinates,
        standard=len(regressor.standard),
        base=[
            doc.Base.from_result(
                base.parameter,
                others=[doc.Share(other.body, other.kind, str(factor)) for other, factor in base.others],
                value=str(base.value),
            )
            for base in regressor.base
        ],
        without_effect=[doc.Parameter(standard.body, standard.kind) for standard in regressor.without_effect],
        other_loads=regressor.besides,
        constraints=regressor.tied,
    )


def regressor_latex(regressor: Regressor) -> str:
    """``align`` environments with a label; bodies are numbers, in a comment with their names."""
    numbers = {body.name: k for k, body in enumerate(regressor.system.bodies, start=1)}
    lines = [
        "% Base parameters: tau = Y(q, q', q'') beta; needs amsmath.  J about the connection point, h = m c.",
        *(f"% {k}: {name}" for name, k in numbers.items()),
        r"\begin{align}",
    ]
    rows = []
    for k, base in enumerate(regressor.base, start=1):
        formula = _symbol(base.parameter, numbers)
        for other, factor in base.others:
            text = _number(factor) or factor.latex()
            if text == "1":
                formula += f" + {_symbol(other, numbers)}"
            elif text == "-1":
                formula += f" - {_symbol(other, numbers)}"
            else:
                formula += rf" + \left({text}\right) {_symbol(other, numbers)}"
        rows.append(rf"  \beta_{{{k}}} &= {formula}")
    return "\n".join([*lines, " \\\\\n".join(rows), r"\end{align}"]) + "\n"


def _symbol(standard: Standard, numbers: dict[str, int]) -> str:
    letter, index = standard.kind[0], standard.kind[1:]
    return f"{letter}_{{{numbers[standard.body]}{',' + index if index else ''}}}"


def regressor_module(regressor: Regressor) -> str:
    """``regressor.py``: Y and the values of the base parameters, of NumPy alone."""
    from mbsym.report.code.functions import Functions, parameters_of
    from mbsym.report.code.python_module import DIALECT, RESERVED, default, plain
    from mbsym.report.environment import rendered

    system = regressor.system
    taken = RESERVED | {"BASE", "regressor", "base_parameters"}
    writer = Functions(system, DIALECT, taken, lambda name: name + "_" if name in taken else name, "np.pi")
    n, rank = len(system.coordinates), len(regressor.base)
    entries = [(i, j, column[i]) for j, column in enumerate(regressor.columns) for i in range(n)]
    nonzero = [(i, j, x) for i, j, x in entries if not regressor.program.vanishes(x)]
    program, values = _values(regressor)
    return rendered(
        "regressor.py.j2",
        {},
        system=system,
        title=plain(system.name),
        n=n,
        rank=rank,
        base=[(named(base.parameter), plain(sum_of(base))) for base in regressor.base],
        meanings=[(item.name, plain(item.told)) for item in parameters_of(system, writer) if item.told],
        defaults=[(item.name, default(item.value)) for item in system.parameters],
        places=[(i, j) for i, j, _ in nonzero],
        Y=writer.function(regressor.program, [x for _, _, x in nonzero]),
        values=writer.function(program, values),
        besides=regressor.besides,
        tied=regressor.tied,
    )


def _values(regressor: Regressor) -> tuple[Program, list[Node]]:
    program = Program()
    environment = program_environment(regressor.system, program)
    rings = {id(base.value.ring): base.value.ring for base in regressor.base}
    carry = {key: Carrier(ring, program, environment) for key, ring in rings.items()}
    return program, [carry[id(base.value.ring)](base.value.polynomial) for base in regressor.base]


def sentences(regressor: Regressor) -> Iterator[tuple[str, str]]:
    """(title, text)."""
    rank, standard = len(regressor.base), len(regressor.standard)
    kinds = f"{', '.join(KINDS[:2])}, ..., {', '.join(KINDS[6:])}"
    text = "[[rank]] of [[count]] parameters ([[kinds]] of each body) determine all generalised forces"
    yield "base", Message(text, rank=rank, count=standard, kinds=kinds)
    for k, base in enumerate(regressor.base, start=1):
        yield f"{k}", sum_of(base)
    if regressor.without_effect:
        names = ", ".join(map(named, regressor.without_effect))
        yield "none", Message("without effect on any motion: [[names]]", names=names)
    text = "exact: relations are identities of T and U; that there are no others is the rank, for almost all values"
    yield "how", Message(text)
    if regressor.besides:
        yield "besides", Message("tau = Y base leaves out the loads that are no uniform gravity")
    if regressor.tied:
        told = (
            "tau is that of the tree without constraints: tau + J^T lambda = Y base; on them fewer sums may be enough"
        )
        yield "constraints", Message(told)
