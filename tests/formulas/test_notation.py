"""Notation in the common part of TeX is read as TeX reads it, and all of ours can be read."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

import mbsym
from mbsym.formulas.mathml import notation
from mbsym.report.messages import messages

REPORT = Path(mbsym.__file__).parent / "report"


@pytest.mark.parametrize(
    ("tex", "wanted"),
    [
        (r"\dot q_i", '<msub><mover accent="true"><mi>q</mi><mo stretchy="false">\u02d9</mo></mover><mi>i</mi></msub>'),
        (r"r^j_{O_k}", "<msubsup><mi>r</mi><msub><mi>O</mi><mi>k</mi></msub><mi>j</mi></msubsup>"),
        (r"\frac12 u", "<mfrac><mrow><mn>1</mn></mrow><mrow><mn>2</mn></mrow></mfrac><mi>u</mi>"),
        (r"x_12", "<msub><mi>x</mi><mn>1</mn></msub><mn>2</mn>"),  # TeX takes one digit
        (r"10^{-12}", '<msup><mn>10</mn><mrow><mo form="prefix">\u2212</mo><mn>12</mn></mrow></msup>'),
        (r"a \penalty0 - b", "<mi>a</mi><mo>\u2212</mo><mi>b</mi>"),
        (r"\Bigl[ \varphi \Bigr]", "<mo>[</mo><mi>\u03c6</mi><mo>]</mo>"),
        (r"\mathrm{grad}\, K", '<mi>grad</mi><mspace width="0.167em"/><mi>K</mi>'),
        (r"-(\text{a < b})", '<mo form="prefix">\u2212</mo><mo>(</mo><mtext>a &lt; b</mtext><mo>)</mo>'),
        (r"\{F_i, F_j\}", "<mo>{</mo><msub><mi>F</mi><mi>i</mi></msub><mo>,</mo>"
         "<msub><mi>F</mi><mi>j</mi></msub><mo>}</mo>"),
    ],
)  # fmt: skip
def test_it_is_read_as_tex_reads_it(tex: str, wanted: str) -> None:
    assert notation(tex) == wanted


@pytest.mark.parametrize("tex", [r"\oint f", r"{a", r"_1", r"\text a", "a}", r"\frac1", "x^"])
def test_what_cannot_be_read_is_an_error(tex: str) -> None:
    with pytest.raises(ValueError, match=re.escape(tex)):
        notation(tex)


def ours() -> set[str]:
    """Between the dollars of messages, and what builders hand over as notation."""
    texts = {
        text for name in ("ru", "es") for (_, english), other in messages(name).items() for text in (english, other)
    }
    found = {part for text in texts for part in text.split("$")[1::2]}
    for path in REPORT.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and path.parent.name in ("sections", "words")
            ):
                found |= set(node.value.split("$")[1::2])
            if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("Notation"):
                found |= {x.value for x in node.args if isinstance(x, ast.Constant) and isinstance(x.value, str)}
    return found


def test_all_of_ours_can_be_read() -> None:
    assert len(ours()) > 100
    for tex in ours():
        written = notation(re.sub(r"\[\[\w+\]\]", "\ue000", tex))
        ElementTree.fromstring(f"<math>{written}</math>")
