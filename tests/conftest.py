"""Shared by the tests: the reference data, and a reader of published formulas into a system's exact ring."""

from __future__ import annotations

import gc
import json
import os
import shutil
import subprocess
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import replace
from fractions import Fraction
from functools import cache, wraps
from importlib.util import module_from_spec, spec_from_file_location
from operator import add, mul, sub, truediv
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

import properties  # noqa: F401  (before the command line asks for one of its profiles)
import pytest
from click.testing import CliRunner, Result
from durations import (  # noqa: F401
    pytest_addoption,
    pytest_collection_modifyitems,
    pytest_runtest_logreport,
    pytest_runtest_makereport,
    pytest_runtest_setup,
    pytest_terminal_summary,
)
from flint import arb, ctx, fmpq

import mbsym
from mbsym.algebra.base import Lowering
from mbsym.analysis import Analysis
from mbsym.expressions.parser import parse_expression
from mbsym.expressions.place import Complaints, Span
from mbsym.expressions.tree import Expression, Name, Negative, Number, Operation, number, substitute
from mbsym.formulas.formula import Formula
from mbsym.mechanics.variables import ring_environment
from mbsym.model.system import System
from mbsym.numerics.dynamics import Dynamics
from mbsym.numerics.kernels.llvm import Library
from mbsym.numerics.scenario import scenario
from mbsym.report import whole_run
from mbsym.source import load, read
from mbsym_cli.main import main

T = TypeVar("T")

#: A width that somebody exported would wrap what is looked for in outputs.
os.environ.pop("COLUMNS", None)

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="no chromium")
needs_pdflatex = pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex")

TESTS = Path(__file__).parent

#: Machine code is kept beside what pytest keeps, not where the user's own is.
os.environ["MBSYM_CACHE"] = str(TESTS.parent / ".pytest_cache" / "mbsym")

#: So many compiled libraries wait for a test that needs the same: some hundred kilobytes each.
MOST_SHARED = 100

SHIPPED = TESTS.parent / "systems"
OWN = TESTS / "systems"
#: Descriptions about which something false was once said.
STATEMENTS = TESTS / "cases" / "statements"

#: Those that move: not given by their matrices.
WITH_BODIES = [path for path in sorted(SHIPPED.glob("*.yaml")) if "\nbodies:" in path.read_text(encoding="utf-8")]


#: Eigenvalues -1e6 and -1e-6, beside a slow oscillation.
STIFF = """
mbsym: 1
name: Two particles, one of them in honey
parameters: {m: 1, k: 1, c: 1e6}
bodies:
  - {name: slow, attached to: 0, connection point: [x, 0, 0], mass: m, coordinates: [x]}
  - {name: free, attached to: 0, connection point: [0, y, 0], mass: m, coordinates: [y]}
loads:
  - spring: {coordinate: x, stiffness: k}
  - spring: {coordinate: y, stiffness: k}
  - damper: {coordinate: x, coefficient: c}
initial: {x: 1, y: 1}
"""

#: x'' - mu (1 - x**2) x' + x = 0
VAN_DER_POL = """
mbsym: 1
name: van der Pol
parameters: {mu: positive}
bodies:
  - {name: b, attached to: 0, connection point: [x, 0, 0], mass: 1, coordinates: [x]}
loads:
  - spring: {coordinate: x, stiffness: 1}
  - generalized force: {x: mu*(1-x**2)*x_dot}
values: {mu: 100000}
initial: {x: {position: 0, velocity: 1/100}}
"""


def system_of(source: str | Path, filename: str = "<string>") -> System:
    """The system of a description, a text or a file, that is read without a mistake."""
    system, complaints = read(source, filename) if isinstance(source, str) else load(source)[:2]
    assert system is not None, [one.message for one in complaints]
    return system


def analysed(source: str | Path, problems: Iterable[int] | None = None) -> Analysis:
    """The analysis of a description that is read without a mistake; further complaints are not looked for."""
    return Analysis(system_of(source), problems)


def text_of(name: str, *changes: tuple[str, str]) -> str:
    """A shipped description, in which what stands there once is changed."""
    text = (SHIPPED / f"{name}.yaml").read_text(encoding="utf-8")
    for old, new in changes:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def dynamics_of(source: str | Path) -> Dynamics:
    """The equations of a description with its own numbers, as codes."""
    return Dynamics(scenario((mbsym.load(source) if isinstance(source, Path) else mbsym.loads(source)).system))


@pytest.fixture(scope="module")
def mathics() -> Any:
    """Another reader of Wolfram's language than Wolfram's own."""
    pytest.importorskip("mathics")
    from mathics.core.load_builtin import import_and_load_builtins

    import_and_load_builtins()
    from mathics.session import MathicsSession

    return MathicsSession(add_builtin=True, character_encoding="UTF-8")


def filed(path: Path, text: str) -> Path:
    """The path, where now a file holds the text."""
    path.write_text(text, encoding="utf-8")
    return path


def imported(path: Path) -> ModuleType:
    """The module in a file, under a name of its own."""
    spec = spec_from_file_location(f"{path.stem}_{abs(hash(path))}", path)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def invoked(*words: object, code: int | None = None, **how: Any) -> Result:
    """What ``mbsym`` with these words does in this process, where no error is left uncaught; it ends with ``code``."""
    done = CliRunner().invoke(main, list(map(str, words)), catch_exceptions=False, **how)
    assert code in (None, done.exit_code), done.output
    return done


def reference(name: str) -> Any:
    """The content of a file of reference data."""
    return json.loads((TESTS / "references" / f"{name}.json").read_text(encoding="utf-8"))


def compiled_latex(text: str, folder: Path) -> str:
    """What pdflatex says of a document, which it has to compile."""
    (folder / "report.tex").write_text(text, encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "report.tex"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, errors="replace", timeout=120)
    assert done.returncode == 0, done.stdout[-2000:]
    return done.stdout


@cache
def derived(path: Path) -> Analysis:
    """The analysis of a description as it stands: once for all tests of this process that read it and change nothing,
    neither in it nor in what derives it."""
    return mbsym.load(path)


def parsed(text: str) -> Expression:
    """The tree of an expression that has no mistakes."""
    complaints = Complaints()
    tree = parse_expression(text, complaints, lambda start, end: Span(1, start + 1, end - start))
    assert tree is not None, [item.message for item in complaints.items]
    return tree


def with_letters(system: System, values: dict[str, T], number: Callable[[Fraction], T]) -> dict[str, T]:
    """The values, and those that rational letters of the description (notation, abbreviations) have by them."""

    def value(x: Expression) -> Any:
        match x:
            case Number():
                return number(x.value)
            case Name():
                return found[x.name]
            case Negative():
                return -value(x.operand)
            case Operation("**", left, Number() as exponent):
                return value(left) ** int(exponent.value)
            case Operation(sign, left, right):
                return {"+": add, "-": sub, "*": mul, "/": truediv}[sign](value(left), value(right))
        raise KeyError(x)

    found = dict(values)
    for one in (*system.notation, *system.abbreviations):
        with suppress(KeyError):
            found[one.name] = value(one.value)
    return found


def browsed(file: Path, *options: str, wait: int = 1000) -> tuple[str, list[str]]:
    """The document that a browser makes of a file, after ``wait`` virtual milliseconds, and what its console says."""
    command = [str(CHROMIUM), "--headless", "--no-sandbox", "--disable-gpu", "--enable-logging=stderr", "--v=0"]
    command += [f"--user-data-dir={file.parent / 'browser'}", f"--virtual-time-budget={wait}", *options, "--dump-dom"]
    done = subprocess.run([*command, file.as_uri()], capture_output=True, timeout=120)
    said = done.stderr.decode(errors="replace").splitlines()
    return done.stdout.decode(errors="replace"), [line for line in said if "CONSOLE" in line]


def pytest_configure() -> None:
    """As the command has it: formulas are many small objects and hardly ever cycles."""
    gc.set_threshold(200_000, 20, 20)


@pytest.fixture(scope="session", autouse=True)
def _read_by_who_gets_it() -> Iterator[None]:
    """Every file of every report that a test renders would be taken by its language."""
    from tests.report.readers import unreadable

    original = whole_run._rendered

    def checked(*given: Any) -> whole_run.Rendered:
        found = original(*given)
        reason = "" if found.text is None else unreadable(found.filename, found.text)
        assert not reason, f"{found.filename}: {reason}"
        return found

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(whole_run, "_rendered", checked)
        yield


@pytest.fixture(scope="session", autouse=True)
def _shared_machine_code() -> Iterator[None]:
    """What several tests compile is compiled once: a library is a function of its text, and nothing in it changes."""
    compile_text, engines = Library.__init__, OrderedDict[tuple[object, ...], Any]()

    @wraps(compile_text)
    def shared(library: Library, text: str, level: int = 2, thorough: bool = True) -> None:
        key = (text, level, thorough)
        if key in engines:
            library._engine = engines[key]
        else:
            compile_text(library, text, level, thorough)
            engines[key] = library._engine
        engines.move_to_end(key)
        if len(engines) > MOST_SHARED:
            engines.popitem(last=False)

    Library.__init__ = shared  # type: ignore[method-assign]
    yield
    Library.__init__ = compile_text  # type: ignore[method-assign]


class Exact:
    """Published formulas as members of a system's ring, where ``==`` means that the difference is proved zero."""

    def __init__(self, analysis: Analysis) -> None:
        self.ring = analysis.ring
        self.lower = Lowering(self.ring, ring_environment(analysis.system, self.ring))

    def __call__(self, text: str, **meanings: str) -> Formula:
        """The formula of ``text``; ``meanings`` stand for names of the text and may use those given before them."""
        known: dict[str, Expression] = {}
        for name, meaning in meanings.items():
            known[name] = substitute(parsed(meaning), known)
        return Formula(self.ring, self.lower(substitute(parsed(text), known)))

    def same(self, formula: Formula) -> Formula:
        """A formula of another ring of the same system (that of the parameters alone), here."""
        x, total = formula.polynomial, self.ring.zero
        if formula.ring is self.ring:
            return formula
        for monomial, coefficient in x.terms():
            term = self.ring.context.constant(coefficient)
            for index, exponent in enumerate(monomial):
                if exponent:
                    known = formula.ring.generators[index]
                    term = term * self.ring.generator(known.kind, known.name) ** int(exponent)
            total = total + term
        return Formula(self.ring, total)

    def ratio(self, ours: Formula, theirs: Formula) -> Fraction | None:
        """The number k with ours = k theirs, exactly; None if there is none."""
        mine, other = self.ring.fraction(self.same(ours).polynomial), self.ring.fraction(theirs.polynomial)
        assert mine[1] == other[1] == [], "a polynomial is expected"
        content, rest = divmod(mine[0], other[0])
        if not rest.is_zero() or not content.is_constant():
            return None
        value = content.leading_coefficient() if content else fmpq(0)
        return Fraction(int(value.p), int(value.q))


def with_values(system: System, values: Mapping[str, int | str | Fraction]) -> System:
    """The system with (some) other numerical values of parameters."""
    given = {name: number(Fraction(value)) for name, value in values.items()}
    assert given.keys() <= set(system.parameter_names)
    return replace(system, parameters=tuple(replace(p, value=given.get(p.name, p.value)) for p in system.parameters))


def at_values(path: Path, **values: int | str | Fraction) -> Analysis:
    """The analysis of a description at (some) other numerical values."""
    return Analysis(with_values(mbsym.load(path).system, values))


@contextmanager
def precision(bits: int) -> Iterator[None]:
    with ctx.workprec(bits):
        yield


def ball(value: str | Fraction | int) -> arb:
    """An exact decimal or fraction as a ball of the working precision."""
    exact = Fraction(value)
    return arb(fmpq(exact.numerator, exact.denominator))


def agrees(value: arb, text: str, digits: int) -> bool:
    """Whether a ball lies within ``digits`` significant digits of the printed number."""
    expected = ball(text)
    bound = abs(expected) * ball(Fraction(1, 10**digits))
    return bool(abs(value - expected) <= bound) if expected != 0 else bool(abs(value) < ball(Fraction(1, 10**digits)))


def total(formulas: Iterable[Formula]) -> Formula:
    """Their sum."""
    items = list(formulas)
    ring = items[0].ring
    return Formula(ring, ring.reduce(sum((x.polynomial for x in items), ring.zero)))
