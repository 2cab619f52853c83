"""The layers of the design: imports point downwards only, and light commands stay light."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import mbsym
from mbsym.algebra.parts import PARTS

ROOT = Path(mbsym.__file__).parent
COMMANDS = ROOT.parent / "cli"

#: What each layer may import besides itself, bottom first.
BELOW = {
    "expressions": "",
    "algebra": "expressions",
    "model": "expressions",
    "source": "expressions model",
    "formulas": "expressions algebra",
    "mechanics": "expressions algebra model",
    "problems": "expressions algebra model mechanics formulas",
    "analysis": "expressions algebra model mechanics formulas problems",
    "maps": "expressions algebra model mechanics formulas problems analysis",
    "numerics": "expressions algebra model mechanics formulas problems analysis",
    "simulation": "expressions algebra model mechanics formulas problems analysis numerics",
    "sweeps": "expressions algebra model mechanics formulas problems analysis maps numerics",
    "picture": "expressions algebra model formulas mechanics problems analysis numerics",
    "report": "expressions algebra model source mechanics formulas problems analysis numerics simulation maps sweeps"
    " picture",
    "studies": "expressions algebra model source mechanics formulas problems analysis maps numerics simulation sweeps"
    " report batch picture",
    "editing": "expressions algebra model source formulas analysis report",
    "batch": "expressions algebra model source formulas problems analysis report sweeps",
    "diff": "expressions algebra formulas report",
    "serving": "expressions algebra model source formulas problems analysis maps numerics simulation report editing"
    " batch picture __init__",
    "__init__": "studies",
    "cli": "expressions algebra model source mechanics formulas problems analysis numerics simulation report studies"
    " batch diff editing maps sweeps picture serving __init__",
}
MODULES = sorted([*ROOT.rglob("*.py"), *COMMANDS.rglob("*.py")])
HEAVY = ("sympy", "numpy", "scipy", "jinja2", "rich", "matplotlib", "llvmlite")


def layer_of(path: Path) -> str:
    """``mechanics`` for mbsym/mechanics/loads/free.py, ``analysis`` for mbsym/analysis.py."""
    return "cli" if path.is_relative_to(COMMANDS) else path.relative_to(ROOT).with_suffix("").parts[0]


def statements(within: ast.AST) -> Iterator[ast.stmt]:
    """All of them, at any depth; expressions, of which there are ten times as many, hold none."""
    for name in ("body", "handlers", "orelse", "finalbody", "cases"):
        for node in getattr(within, name, ()):
            if isinstance(node, ast.stmt):
                yield node
            yield from statements(node)


def imported(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """The layers that a module imports, anywhere in it, each with its line."""
    for node in statements(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            assert node.module is not None
            names = [f"{node.module}.{alias.name}" if node.module == "mbsym" else node.module for alias in node.names]
        for name in names:
            top, *rest = name.split(".")
            if name == "mbsym.__version__":  # known before anything is imported
                continue
            if top == "mbsym":
                yield node.lineno, rest[0] if rest and rest[0] in BELOW else "__init__"
            elif top in ("mbsym_cli", "cli"):
                yield node.lineno, "cli"


def upward_imports(path: Path) -> Iterator[str]:
    """``mbsym/algebra/ring.py:12: algebra imports report`` for each import that does not point downwards."""
    layer = layer_of(path)
    for line, name in imported(ast.parse(path.read_text(encoding="utf-8"))):
        if name not in (layer, *BELOW[layer].split()):
            yield f"{path.relative_to(ROOT.parent)}:{line}: {layer} imports {name}"


def test_imports_point_downwards() -> None:
    """In every module; all breaches are listed at once."""
    assert {layer_of(path) for path in MODULES} >= {"algebra", "cli"}
    breaches = [breach for path in MODULES for breach in upward_imports(path)]
    assert not breaches, "\n" + "\n".join(breaches)


def test_an_upward_import_is_found_wherever_it_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: on top of a module, in a function, and where only types are looked at."""
    monkeypatch.setattr(f"{__name__}.ROOT", tmp_path / "mbsym")
    module = tmp_path / "mbsym" / "algebra" / "ring.py"
    module.parent.mkdir(parents=True)
    module.write_text(
        "from mbsym.expressions import tree\nfrom mbsym.report.html import page\n"
        "def f():\n    import mbsym_cli.main\n"
        "if TYPE_CHECKING:\n    from mbsym import model\nelse:\n    from mbsym import source\n"
        "try:\n    import a\nexcept ImportError:\n    import mbsym.maps\nelse:\n    import mbsym.diff\n"
        "finally:\n    with a:\n        import mbsym.batch\n"
        "match a:\n    case 1:\n        import mbsym.picture\n"
    )
    found = ["2 report", "4 cli", "6 model", "8 source", "12 maps", "14 diff", "17 batch", "20 picture"]
    expected = ["mbsym/algebra/ring.py:{}: algebra imports {}".format(*text.split()) for text in found]
    assert list(upward_imports(module)) == expected


@pytest.mark.parametrize("name", ["mbsym", "mbsym.source", "mbsym_cli.main"])
def test_reading_a_description_loads_nothing_heavy(name: str) -> None:
    program = f"import sys, {name}; print(*[m for m in {HEAVY} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_an_analysis_loads_what_every_system_needs() -> None:
    """Neither claims, of which most descriptions have none, nor the parts that an installation may lack."""
    unused = ("mbsym.problems.claims", "mbsym.analysis.judging", *PARTS)
    program = f"import sys, mbsym.analysis; print(*[m for m in {unused} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


#: What a run has no use for: numbers in arrays, figures, SymPy's exchange, the search for all equilibria,
#: metadata of packages, constraints where there are none, and (where nothing is printed) a terminal's colours.
UNUSED = (
    *(name for name in HEAVY if name != "jinja2"),
    "importlib.metadata",
    "importlib.resources",
    "mbsym.algebra.polynomial_systems",
    "mbsym.problems.relative_equilibria.equilibria",
    "mbsym.problems.constraints.analysis",
    "mbsym.mechanics.constraints.states",
    *PARTS,
)


#: What validating a description has no use for: files to be written, formulas, balls where fractions do.
UNCHECKED = (*HEAVY, "importlib.metadata", "flint", "mbsym.analysis", "hashlib", "tempfile", "pickle", *PARTS)

#: What integrating a system has no use for: derivations, plans, the ledger, ways over singular positions.
UNINTEGRATED = (
    *(name for name in HEAVY if name not in ("numpy", "llvmlite")),
    "mbsym.analysis",
    "mbsym.problems.stability",
    "mbsym.numerics.ledger",
    "mbsym.numerics.planning.pilot",
    "numpy.polynomial",
    *PARTS,
)

OPTIONS = {"run": ("--quiet",), "simulate": ("--time", "1", "--format", "csv", "--quiet")}


@pytest.mark.parametrize(
    ("command", "name", "unused"),
    [
        ("run", "double-pendulum", UNUSED),
        ("check", "double-pendulum", UNCHECKED),
        ("check", "satellite", UNCHECKED),
        ("simulate", "double-pendulum", UNINTEGRATED),
    ],
)
def test_a_command_loads_only_what_it_uses(command: str, name: str, unused: tuple[str, ...], tmp_path: Path) -> None:
    """Every module that is imported for nothing is time that every run takes."""
    options = ["--out", str(tmp_path), *OPTIONS[command]] if command in OPTIONS else []
    arguments = ["mbsym", command, str(ROOT.parent / "systems" / f"{name}.yaml"), *options]
    program = (
        f"import atexit, sys; sys.argv = {arguments}\n"
        f"atexit.register(lambda: print('loaded:', *[m for m in {unused} if m in sys.modules]))\n"
        "from mbsym_cli.main import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "loaded:"


ARCHITECTURE = (ROOT.parent / "ARCHITECTURE.md").read_text(encoding="utf-8")


def test_the_page_names_what_is_there() -> None:
    """Each path of it exists, in mbsym/ or beside it; each room has its place there, and it stays one page."""
    paths = {path for path in re.findall(r"`([\w./*]+(?:/|\.py|\.po|\.json|\.j2))`", ARCHITECTURE) if "/" in path}
    lost = [path for path in sorted(paths) if not any(any(top.glob(path)) for top in (ROOT, ROOT.parent))]
    assert not lost
    rooms = {str(path.parent.relative_to(ROOT)) for path in ROOT.rglob("__init__.py")} - {"."}
    unnamed = {room for room in rooms if room.count("/") == 1 and f"{room}/" not in ARCHITECTURE}
    assert not unnamed
    assert len(ARCHITECTURE.splitlines()) <= 115
