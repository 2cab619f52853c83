"""What results say, found in the source: messages, and the constant texts of refusals, remarks and checks."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import mbsym
import mbsym_cli
from mbsym.algebra.failures import Failure
from mbsym.expressions.message import GAP

ROOT = Path(mbsym.__file__).parent
#: The layers whose refusals can stand in a report, or on a page.
LAYERS = (
    *("algebra", "analysis", "batch", "formulas", "maps", "mechanics", "model", "numerics", "picture", "problems"),
    *("report", "simulation", "studies", "sweeps"),
)
#: What is said before a reason, by the function that says it, and which argument that is.
BEFORE = {"refused": 0, "failed": 1}
#: Where among the arguments of a complaint about an option the message stands; a hint follows.
COMPLAINTS = {"complain": 2, "complain_whole": 3}
#: What failures have besides the gaps of their message.
OF_FAILURES = ("limit", "remedy")
#: What prints words, and asks for an answer.
PRINTS = ("print", "echo", "prompt", "confirm")
#: Commands that are about no description: nobody says in which language they are read.
OF_NO_DESCRIPTION = tuple(
    f"cli/{name}.py" for name in ("console", "edit", "examples", "explain", "lsp", "main", "process")
)


@dataclass(frozen=True)
class Asked:
    """A text with its place, and what its gaps are given; None: a text without gaps, or given by ``**``."""

    text: str
    place: str
    gaps: frozenset[str] | None = None


class Module(ast.NodeVisitor):
    """``texts`` are what is said, ``counted`` what has a plural; ``open``: places where a text is put together."""

    def __init__(self, name: str, tree: ast.Module, refusals: frozenset[str]) -> None:
        self.name = name
        self.refusals = refusals
        self.layered = self.name.startswith(tuple(f"{layer}/" for layer in LAYERS))
        # Files of robots say nothing of their language.
        self.of_descriptions = self.name.startswith(("source/", "expressions/")) and "/robots/" not in self.name
        self.texts: list[Asked] = []
        self.open: list[str] = []
        self.counted: set[str] = set()
        self.known: dict[str, list[ast.expr]] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Assign):
                for target in node.targets:
                    self._assigned(target, node.value)
        self.visit(tree)

    def _assigned(self, target: ast.expr, value: ast.expr) -> None:
        if isinstance(target, ast.Name):
            self.known.setdefault(target.id, []).append(value)
        elif isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
            for one, other in zip(target.elts, value.elts, strict=False):
                self._assigned(one, other)

    def visit_Call(self, node: ast.Call) -> None:
        self.generic_visit(node)
        self._words([part for x in node.keywords if x.arg == "absent" for part in self._parts(x.value)], node)
        name = ast.unparse(node.func).split(".")[-1]
        if name == "Message" or (
            name in self.refusals and any(x.arg not in ("limit", "remedy") for x in node.keywords)
        ):
            self._message(node)
        elif name == "Unreadable" and self.name == "source/matrix_file.py":
            self._message(node)
            self._words([x.value for x in node.keywords if x.arg == "remedy"], node)
        elif name in ("Measure", "Unusable"):
            self._words(node.args[:1], node)
        elif name in ("error", "warning") and self.of_descriptions:
            self._complaint(node)
        elif name == "Unfit" and self.name.startswith("studies/"):
            self._words(self._unpacked(node.args)[2:4], node)
        elif name == "Unfit" and self.name == "report/runs/earlier_run.py":
            self._words(node.args[:1], node)
        elif isinstance(node.func, ast.Name) and name == "complain" and self.name.startswith("cli/"):
            self._words(node.args[1:2], node)
        elif name in PRINTS and self.name.startswith("cli/") and self.name not in OF_NO_DESCRIPTION:
            self.open += [f"{self._at(node)}: {ast.unparse(one)}" for one in node.args if _in_english(one)]
        elif name in COMPLAINTS and self.name.startswith("cli/"):
            first = COMPLAINTS[name]
            self._words(self._unpacked(node.args)[first : first + 2], node)
        elif name in ("Breakdown", "_fail") and self.name.startswith("numerics/"):
            self._words(node.args[1:2], node)
        elif name == "Counted":
            self.counted |= {text for one in node.args[1:2] for text in self._literals(one)}
        elif name in BEFORE:
            before = node.args[BEFORE[name] :][:1]
            self.texts += [Asked(text, self._at(node)) for one in before for text in self._literals(one)]
        elif not self.layered:
            return
        elif name in self.refusals:
            self._words(node.args[:1], node)
            self._words([x.value for x in node.keywords if x.arg == "remedy"], node)
        elif name == "NoResult":
            self._words(node.args[:2], node)
        elif name == "Check":
            self._words([x for k, x in enumerate(node.args[:5]) if k != 3 and not isinstance(x, ast.Starred)], node)
        self._words([x.value for x in node.keywords if x.arg in ("remark", "detail", "why_not", "missing")], node)

    def _unpacked(self, values: list[ast.expr]) -> list[ast.expr]:
        """Of ``*NAMED`` what that tuple of the module holds."""
        found: list[ast.expr] = []
        for one in values:
            starred = isinstance(one, ast.Starred) and isinstance(one.value, ast.Name)
            named = self.known.get(ast.unparse(one)[1:], []) if starred else []
            whole = [x for x in named if isinstance(x, ast.Tuple)]
            found += whole[0].elts if whole else [one]
        return found

    def _parts(self, value: ast.expr) -> list[ast.expr]:
        """A message and its hint: of a tuple, or of one that has a name."""
        known = self.known.get(value.id, []) if isinstance(value, ast.Name) else [value]
        return [part for one in known if isinstance(one, ast.Tuple) for part in one.elts]

    def _message(self, node: ast.Call) -> None:
        first = node.args[0]
        starred = any(x.arg is None for x in node.keywords)
        gaps = None if starred else frozenset(x.arg for x in node.keywords if x.arg and x.arg not in OF_FAILURES)
        known = self.known.get(first.id, []) if isinstance(first, ast.Name) else []
        before = [x for x in known if x.lineno <= node.lineno]
        nearest = set(self._literals(max(before, key=lambda x: x.lineno) if before else first))
        for text in self._literals(first):  # a name that was used before had other texts
            self.texts.append(Asked(text, self._at(node), gaps if text in nearest else None))
        for text in self._named(first):
            self.texts.append(Asked(text, self._at(node)))

    def _complaint(self, node: ast.Call) -> None:
        """A message and a hint, which share what fills their gaps; what is given and stands in neither is wrong."""
        words = [*node.args[1:2], *node.args[3:4], *(x.value for x in node.keywords if x.arg == "hint")]
        given = {x.arg for x in node.keywords if x.arg and x.arg not in ("hint", "span")}
        if not given:
            return self._words(words, node)
        texts = [text for one in words if not isinstance(one, ast.Call) for text in self._literals(one)]
        idle = given - {gap for text in texts for gap in GAP.findall(text)}
        for text in texts:
            self.texts.append(Asked(text, self._at(node), frozenset(given & set(GAP.findall(text)) | idle)))
        return None

    def _words(self, values: list[ast.expr], node: ast.AST, depth: int = 0) -> None:
        for value in values:
            if isinstance(value, ast.JoinedStr) and depth < 4 and not _of_names(value):
                self.open.append(f"{self._at(node)}: {ast.unparse(value)}")
            elif isinstance(value, ast.IfExp):
                self._words([value.body, value.orelse], node, depth)
            elif isinstance(value, ast.BoolOp):
                self._words(value.values, node, depth)
            elif isinstance(value, ast.Name) and depth < 3:
                self._words(self.known.get(value.id, []), node, depth + 1)
            elif isinstance(value, ast.Constant) and isinstance(value.value, str):
                self.texts.append(Asked(value.value, self._at(node)))

    def _literals(self, node: ast.expr) -> Iterator[str]:
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value
        elif isinstance(node, ast.IfExp):
            yield from self._literals(node.body)
            yield from self._literals(node.orelse)
        elif isinstance(node, ast.Name):
            before = [x for x in self.known.get(node.id, []) if x.lineno <= node.lineno]
            if before:
                yield from self._literals(max(before, key=lambda x: x.lineno))

    def _named(self, node: ast.expr) -> Iterator[str]:
        """Whatever else a name may stand for: of branches, one is nearest to where it is said."""
        for name in (x.id for x in ast.walk(node) if isinstance(x, ast.Name)):
            for value in self.known.get(name, []):
                yield from self._literals(value)

    def _at(self, node: ast.AST) -> str:
        return f"{self.name}:{getattr(node, 'lineno', 0)}"


def _of_names(node: ast.JoinedStr) -> bool:
    """Whether nothing but names and signs is put together: ``a: 0.1``."""
    parts = [x.value for x in node.values if isinstance(x, ast.Constant)]
    return not has_words(" ".join(map(str, parts))) and any(not str(x).isspace() for x in parts)


def _in_english(node: ast.expr) -> bool:
    """Whether words stand in it that nobody says in another language."""
    if isinstance(node, ast.Call):
        if re.match(r"(\w+\.)*say\b|speaking\b", ast.unparse(node.func)):
            return False
        return any(map(_in_english, node.args))
    if isinstance(node, ast.JoinedStr):
        return any(map(_in_english, node.values))
    if isinstance(node, ast.FormattedValue):
        return _in_english(node.value)
    if isinstance(node, ast.BinOp):
        return _in_english(node.left) or _in_english(node.right)
    if isinstance(node, ast.IfExp):
        return _in_english(node.body) or _in_english(node.orelse)
    commands = r"mbsym \w*|^--\w+|\.wrapped|bold|dim|cyan|red"
    words = re.sub(commands, "", node.value) if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""
    return has_words(words)


@cache
def trees() -> dict[str, ast.Module]:
    """The modules of the package and of its commands by their paths."""
    commands = Path(next(iter(mbsym_cli.__path__)))
    paths = {str(path.relative_to(ROOT)): path for path in sorted(ROOT.rglob("*.py"))}
    paths |= {f"cli/{path.relative_to(commands)}": path for path in sorted(commands.rglob("*.py"))}
    return {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in paths.items()}


def refusals() -> frozenset[str]:
    """The names of all kinds of ``Failure``."""
    found, pending = set(), [Failure]
    while pending:
        kind = pending.pop()
        found.add(kind.__name__)
        pending += kind.__subclasses__()
    return frozenset(found - {"Unsound", "Unavailable", "NoValue", "Demand"})


def modules() -> Iterator[Module]:
    """All of the package."""
    names = refusals()
    return (Module(name, tree, names) for name, tree in trees().items())


def has_words(text: str) -> bool:
    """Not of gaps, signs and symbols alone, which are the same in every language."""
    return re.search(r"[A-Za-z]{2}", GAP.sub("", text)) is not None
