"""Files that their readers would refuse are recognised, and those that they take are left alone."""

from __future__ import annotations

import pytest

from mbsym.report.parsing import unreadable

GOOD = {
    "model.py": [
        "import numpy as np\nA = {'m': (2*np.pi/86164)**2, 'l': -1/3, 'n': None, 'r': np.sqrt(2)}\n",
        "import numpy as np\ndef f(x):\n    y = [z for z in x]\n    return np.array(y)\n",
        'NAMES = (\n    "a",\n)\nEMPTY = {\n}\n',
    ],
    "model.c": ['/* ( */ const char *s = "({"; int f(void) { return a[1]; } // }\n', "char c = '\"';\n"],
    "report.wl": ['(* a (* nested *) "one *) x = {1, f[2], "(*", "a\\"]"}; \\[Lambda] = (1)\n'],
    "report.tex": [
        r"\begin{align*} \left( \frac{a}{b} \right] \end{align*} 100\% \{ \\[2mm] $x$ \leftarrow \verb|{|" + "\n",
        r"\[ x \text{ if $y > 0$, \(z\)} \] $a \mbox{$b$}$" + "\n",
        "% } nothing\n\\[ x \\]\n$$y$$\n",
    ],
    "results.json": ['{"a": [1, "x"]}'],
    "ledger.csv": ["anything ("],
}
BAD = {
    "model.py": [
        "A = {'m': s1*s1}\n",  # not defined
        "def f(x):\n    return s1\n",
        "def f(:\n",
        "A = {'m': 1/0}\n",
        "import numpy as np\nA = {'m': np.sqrt(-1)}\n",
        "A = {'m': 10.0**400}\n",
        "A = {'m': open('x')}\n",
        "A = {'m': " + "9" * 5000 + "}\n",
        'A = "a\nb"\n',
    ],
    "model.c": ["int f( { }\n", "/* never\n", '"never\n', "int f(void) { return 1; \n", "int a; /* \x1b */\n"],
    "report.wl": ["f[x)\n", "(* (* *)\n", '"never\n', "x *)\n", "{\x00}"],
    "report.tex": ["\\frac{a\n", "a}\n", "\\begin{a}\\end{b}\n", "\\left( x\n", "$x\n", "\\[ $x$ \\]\n", "a\x07\n"],
    "results.json": ["{", '{"a": NaN}', '{"a": "\n"}'],
}


@pytest.mark.parametrize(("name", "text"), [(name, text) for name, texts in GOOD.items() for text in texts])
def test_what_is_right_is_taken(name: str, text: str) -> None:
    assert unreadable(name, text) == ""


@pytest.mark.parametrize(("name", "text"), [(name, text) for name, texts in BAD.items() for text in texts])
def test_what_is_wrong_is_not(name: str, text: str) -> None:
    assert unreadable(name, text)


def test_the_line_is_told_and_nothing_is_executed() -> None:
    assert unreadable("model.py", "import os\nA = {'x': os.mkdir('here')}\n").startswith("line 2: ")
    assert unreadable("model.c", "int a;\n/* x\n y */ }\n") == "line 3: '}' closes nothing"
    assert unreadable("report.tex", "a\n\n{") == "line 3: '{' is never closed"
