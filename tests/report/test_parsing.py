"""Files that their readers would refuse are recognised, and those that they take are left alone."""

from __future__ import annotations

import re
from collections.abc import Sequence
from random import Random

import pytest

from tests.report.readers import unreadable

GOOD = {
    "model.py": [
        "import numpy as np\nA = {'m': (2*np.pi/86164)**2, 'l': -1/3, 'n': None, 'r': np.sqrt(2)}\n",
        "import numpy as np\ndef f(x):\n    y = [z for z in x]\n    return np.array(y)\n",
        'NAMES = (\n    "a",\n)\nEMPTY = {\n}\n',
        "def f(n: int = 1):\n    def g():\n        return n\n    return [k for k in range(n)], g, lambda x: x + n\n",
        "def f():\n    import os\n    return os\nif __name__ == '__main__':\n    for x in (1, 2):\n        f()\n",
    ],
    "model.c": ['/* ( */ const char *s = "({"; int f(void) { return a[1]; } // }\n', "char c = '\"';\n"],
    "report.wl": ['(* a (* nested *) "one *) x = {1, f[2], "(*", "a\\"]"}; \\[Lambda] = (1)\n'],
    "report.tex": [
        r"\begin{align*} \left( \frac{a}{b} \right] \end{align*} 100\% \{ \\[2mm] $x$ \leftarrow \verb|{|" + "\n",
        r"\[ x \text{ if $y > 0$, \(z\)} \] $a \mbox{$b$}$" + "\n",
        "% } nothing\n\\[ x \\]\n$$y$$\n",
    ],
    "results.json": ['{"a": [1, "x"]}'],
    "report.html": [
        '<p><a href="#a">on = style = href = src</a><img src="data:image/png;base64,xx"/></p>\n',
        "<p title=' onclick=1'>a<script>x.onclick=1</script></p>\n",
    ],
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
        "def f(x: s1):\n    return x\n",
        "def f(x=s1):\n    return x\n",
        "def f(x):\n    def g():\n        return x + s1\n    return g\n",
        "def f(x):\n    y = [k for k in x]\n    return k\n",
        "@s1\ndef f(x):\n    return x\n",
        "if __name__ == '__main__':\n    print(s1)\n",
    ],
    "model.c": ["int f( { }\n", "/* never\n", '"never\n', "int f(void) { return 1; \n", "int a; /* \x1b */\n"],
    "report.wl": ["f[x)\n", "(* (* *)\n", '"never\n', "x *)\n", "{\x00}"],
    "report.tex": ["\\frac{a\n", "a}\n", "\\begin{a}\\end{b}\n", "\\left( x\n", "$x\n", "\\[ $x$ \\]\n", "a\x07\n"],
    "report.html": [
        "<p>\n",
        '<p><b onclick="x()">a</b></p>\n',
        "<p><b\nONCLICK = 'x()'>a</b></p>\n",
        '<p><i style="x">a</i></p>\n',
        '<p><a href="https://x">a</a></p>\n',
        "<p><img\tsrc ='//x'/></p>\n",
        '<p><a href="&#35;a" data="x">a</a></p>\n',
        '<!DOCTYPE p [<!ATTLIST p onclick CDATA "x()">]><p>a</p>\n',
    ],
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


# --- LaTeX ------------------------------------------------------------------------------------------------------------


def mutated(text: str, pieces: Sequence[str], source: Random, at: str = ".|\n") -> str:
    """With a piece put in, or a character left out, in up to three places."""
    for _ in range(source.randint(1, 3)):
        place = source.choice([found.end() for found in re.finditer(at, text)])
        if source.random() < 0.7:
            text = text[:place] + source.choice(pieces) + text[place:]
        else:
            text = text[:place] + text[place + 1 :]
    return text


COMMANDS = ["{", "}", "$", r"\left(", r"\right.", r"\leftarrow\!", r"\[", r"\]", r"\foo", r"\begin{a}", r"\end{a}"]
TEX = r"""\begin{a} $x \left( \frac{y}{z} \right)$ \text{if $p$}
\[ \cos q \] % {
\end {a} \rightarrow \begingroup{}\endgroup \left a \right b
"""


def test_tex_is_read_like_token_by_token() -> None:
    source, refused = Random(6), 0
    for _ in range(1500):
        text = mutated(TEX, COMMANDS, source)
        wanted = token_by_token(text)
        assert bool(unreadable("report.tex", text)) is wanted
        refused += wanted
    assert 500 < refused < 1450


def token_by_token(text: str) -> bool:
    """Whether TeX would refuse it, by a stack of what is open."""
    pattern = r"\\verb([^a-zA-Z]).*?\1|\\[a-zA-Z]+ ?|\\.|%[^\n]*|\$\$?|[{}]|."
    stack: list[str] = []
    rest = text
    while rest:
        found = re.match(pattern, rest, re.DOTALL)
        assert found is not None
        token, rest = found[0], rest[found.end() :]
        word = token.strip().removeprefix("\\")
        if token.startswith(("%", "\\verb")):
            continue
        if word in ("left", "right"):
            delimiter = re.match(r"\s*(\\[{}|]|.)", rest, re.DOTALL)
            if delimiter is None:
                return True
            rest = rest[delimiter.end() :]
        if word in ("begin", "end"):
            name = re.match(r"\s*\{([^{}]*)\}", rest)
            if name is None:
                return True
            word, rest = f"{word} {name[1]}", rest[name.end() :]
        if token.startswith("\\") and token[1:2].isalpha():
            if word.startswith("begin ") or word in ("left", "begingroup"):
                stack.append(word)
            elif word.startswith("end ") or word in ("right", "endgroup"):
                wanted = {"right": "left", "endgroup": "begingroup"}.get(word, "begin" + word[3:])
                if not stack or stack.pop() != wanted:
                    return True
            elif word not in ("frac", "text", "cos", "rightarrow", "leftarrow"):
                return True
        elif token == "{":
            stack.append("{")
        elif token == "}":
            if not stack or stack.pop() != "{":
                return True
        elif token in ("$", "$$", "\\[", "\\]"):
            own = "\\[" if token == "\\]" else token
            if stack and stack[-1] == own:
                stack.pop()
                continue
            inner = stack[len(stack) - stack[::-1].index("{") :] if "{" in stack else stack
            if token == "\\]" or any(x in ("$", "$$", "\\[") for x in inner):
                return True
            stack.append(token)
    return bool(stack)
