"""Messages: each that is said has its translation with the same gaps, and each translation is one that is said."""

from __future__ import annotations

import ast
import importlib
import pickle
import pkgutil
import re
from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from pathlib import Path

import mbsym_templates
import polib
import pytest
from flint import Ordering, fmpq_mpoly_ctx

import mbsym
from mbsym.algebra.certainty import Certainty
from mbsym.algebra.failures import NoClosedForm, NoValue, message_of
from mbsym.analysis.stages import NoResult
from mbsym.batch import outcome
from mbsym.expressions.message import GAP, Counted, Message
from mbsym.maps import branches_curve
from mbsym.maps.boundaries import Origin
from mbsym.maps.branches_events import Event
from mbsym.maps.result import Lack
from mbsym.maps.soft_borders import Onset
from mbsym.mechanics.intermediates import Quantity
from mbsym.mechanics.programs import ARTICULATED, FACTORISED
from mbsym.model.claims import CLAIMS, SUMS
from mbsym.model.constraints import KIND_NAMES
from mbsym.model.system import LANGUAGES
from mbsym.numerics.accuracy import Lacking
from mbsym.numerics.conservation import Doubt, Measure, Standing
from mbsym.numerics.kernels.interface import EXTENDED
from mbsym.numerics.methods import interface, sides, tableaux
from mbsym.numerics.planning import kinds, plan
from mbsym.problems.checks import HOW_EQUAL
from mbsym.problems.claims.remarks import Said
from mbsym.problems.normal_forms.result import Outcome, Theorem
from mbsym.problems.stability import words
from mbsym.problems.stability.linear_form import LinearSystem, kind_of
from mbsym.problems.stability.requirements import BUT_TURNED, BUT_ZERO, Method, Place
from mbsym.problems.stability.words import Because, Word
from mbsym.report.language import Language
from mbsym.report.latex.writer import escaped
from mbsym.report.maps.words import _DOUBTS
from mbsym.report.messages import messages, plurals
from mbsym.report.runs.plan_words import TITLES
from mbsym.report.schemas import schema
from mbsym.report.words.normal_form_words import REASONS
from mbsym.report.words.passages import _FROM_ORIGIN, _LESS_GRAVITY
from mbsym.source.starter import JOINTS
from mbsym.studies.simulate import PAIRS
from mbsym.studies.study import Apart
from mbsym_cli.diff import called
from tests.report import said

OTHERS = [name for name in LANGUAGES if name != "en"]
FOLDER = Path(mbsym.__file__).parent


@pytest.mark.parametrize("name", OTHERS)
def test_a_catalogue_is_whole(name: str) -> None:
    """What msgfmt --check looks at, the gaps, and that TeX can set it: a dash was a question mark in LaTeX."""
    entries = polib.pofile(str(FOLDER / "report" / "messages" / f"{name}.po"))
    assert len({(x.msgctxt, x.msgid) for x in entries}) == len(entries), "each message once"
    for entry in entries:
        assert entry.msgstr or all(entry.msgstr_plural.values()), f"not translated: {entry.msgid}"
        assert not entry.fuzzy, entry.msgid
        assert not entry.obsolete, entry.msgid
        gaps = [set(re.findall(r"\[\[\w+\]\]", text)) for text in (entry.msgid, entry.msgstr)]
        assert gaps[0] == gaps[1], entry.msgid
        assert entry.msgstr.count("$") % 2 == 0, entry.msgid
        assert escaped(entry.msgstr).count("?") == entry.msgstr.count("?"), entry.msgstr


@pytest.mark.parametrize("name", OTHERS)
def test_a_term_is_one_word(name: str) -> None:
    """The glossary at the head of a catalogue against all of its messages, but for what is typed and gaps."""
    catalogue = polib.pofile(str(FOLDER / "report" / "messages" / f"{name}.po"))
    glossary = dict(line.split(" = ") for line in catalogue.header.splitlines() if " = " in line)
    assert len(glossary) > 25
    typed = re.compile(r"'[^']*'|\{.*\}|\[\[\w+\]\]")
    said_otherwise = []
    for term, other in glossary.items():
        english = re.compile(rf"(?<![\w'-]){term.removesuffix('a')}(?:s|a)?(?![\w'-])", re.IGNORECASE)
        word = re.compile(rf"\b{re.escape(other)}".replace(r"\*", r"\w*"), re.IGNORECASE)
        asked = [x for x in catalogue if not x.msgid_plural and english.search(typed.sub("", x.msgid))]
        assert asked, term
        said_otherwise += [(term, x.msgid, x.msgstr) for x in asked if not word.search(x.msgstr)]
    assert not said_otherwise


def test_all_languages_have_the_same_messages() -> None:
    known = {name: set(messages(name)) for name in OTHERS}
    for name in OTHERS:
        assert known[name] == known[OTHERS[0]], known[name] ^ known[OTHERS[0]]


def strings() -> set[str]:
    """Whatever stands in a string of the package, of a command or in a template."""
    found: set[str] = set()
    for tree in said.trees().values():
        found |= {x.value for x in ast.walk(tree) if isinstance(x, ast.Constant) and isinstance(x.value, str)}
    for path in Path(next(iter(mbsym_templates.__path__))).rglob("*.j2"):
        for pattern in (r'\btr\(("(?:[^"\\\n]|\\.)*")', r'("(?:[^"\\\n]|\\.)*")'):
            found |= {ast.literal_eval(x) for x in re.findall(pattern, path.read_text(encoding="utf-8"))}
    return found


def test_no_message_is_left_of_what_is_said_no_longer() -> None:
    known = {english for _, english in messages(OTHERS[0]) if english}
    assert not known - strings() - words_of_types()


# --- every message, found in the source -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def told() -> list[said.Module]:
    """All modules, with every kind of refusal imported."""
    for one in pkgutil.walk_packages(mbsym.__path__, "mbsym."):
        if one.name.replace(".", "/").startswith(tuple(f"mbsym/{layer}" for layer in said.LAYERS)):
            importlib.import_module(one.name)
    return list(said.modules())


@pytest.mark.parametrize("name", OTHERS)
def test_every_message_of_results_is_translated(name: str, told: list[said.Module]) -> None:
    """Reasons, refusals, hints, remarks, checks, integrals, conditions: as they stand in the source."""
    known = {english for _, english in messages(name)}
    asked = {one.text: one.place for module in told for one in module.texts if said.has_words(one.text)}
    assert len(asked) > 500
    assert not {text: place for text, place in asked.items() if text not in known}


@pytest.mark.parametrize("name", OTHERS)
def test_whatever_is_counted_has_all_its_forms(name: str, told: list[said.Module]) -> None:
    """Three in Russian, two in Spanish; of what is counted no longer there are none."""
    forms, form = plurals(name)
    assert set(forms) == {text for module in told for text in module.counted}
    assert {len(one) for one in forms.values()} == {max(map(form, range(100))) + 1} == {3 if name == "ru" else 2}


def test_numbers_of_things_are_declined() -> None:
    """1, 21, 31 go together in Russian, 2 to 4, and the others with 11 to 14."""
    said_so = [Language("ru").say(Message("[[n]]", n=Counted(n, "step"))) for n in (1, 2, 5, 11, 21, 22)]
    assert said_so == ["1 шаг", "2 шага", "5 шагов", "11 шагов", "21 шаг", "22 шага"]
    assert [Counted(n, "family", "families") for n in (1, 2)] == ["1 family", "2 families"]
    again = pickle.loads(pickle.dumps(Counted(2, "step")))
    assert Language("es").say(again) == "2 pasos"


def test_no_message_is_put_together_of_pieces(told: list[said.Module]) -> None:
    """An f-string in the place of a message is English in every language."""
    assert not [place for module in told for place in module.open]


def test_each_gap_of_a_message_has_its_value_and_each_value_its_gap(told: list[said.Module]) -> None:
    wrong = [
        one
        for module in told
        for one in module.texts
        if one.gaps is not None and one.gaps != frozenset(GAP.findall(one.text))
    ]
    assert not wrong


def test_what_is_wrong_with_a_complaint_about_options_is_found() -> None:
    """Negative control: in a study, in a command, and by a tuple that has a name."""
    study = """
UNWRITTEN = ("code", "nobody says this", "nor this")

def unfit(name):
    yield Unfit("--set", "code", f"{name} is lost", Message("take [[other]]", other=name))
    yield Unfit("--set", *UNWRITTEN)
"""
    module = said.Module("studies/planted.py", ast.parse(study), frozenset())
    assert [place.partition(": ")[0] for place in module.open] == ["studies/planted.py:5"]
    assert {one.text for one in module.texts} == {"take [[other]]", "nobody says this", "nor this"}
    command = 'asked.complain("--set", "code", "nobody says this", f"take {name}")'
    module = said.Module("cli/planted.py", ast.parse(command), frozenset())
    assert len(module.open) == 1
    assert [one.text for one in module.texts] == ["nobody says this"]


def test_what_is_said_of_an_option_that_is_absent_is_found() -> None:
    """Negative control: a tuple, one that has a name, and one that is put together."""
    study = """
ABSENT = ("nobody says this", "nor this")
period: Annotated[float, Number("T", "The period.", absent=ABSENT)]
time: Annotated[float, Number("T", "The time.", absent=("how long?", f"take {name}"))]
"""
    module = said.Module("studies/planted.py", ast.parse(study), frozenset())
    assert {one.text for one in module.texts} == {"nobody says this", "nor this", "how long?"}
    assert [place.partition(": ")[0] for place in module.open] == ["studies/planted.py:4"]


def test_words_that_a_command_prints_in_english_are_found() -> None:
    """Negative control: a complaint, a line and a question of a command, and reasons against an earlier run."""
    command = """
complain(file, f"{count} descriptions are lost")
complain(file, "nobody says this", say)
print(f"{printable(file)}: nobody reads this")
click.prompt("how many", default=1)
click.echo(f"  mbsym run {file}")
print(f"{printable(file)}: {say(text)}")
"""
    module = said.Module("cli/planted.py", ast.parse(command), frozenset())
    assert [place.partition(": ")[0] for place in module.open] == [f"cli/planted.py:{k}" for k in (2, 4, 5)]
    assert [one.text for one in module.texts] == ["nobody says this"]
    reason = 'raise Unfit("it is lost")\nraise Unfit(f"{name} is lost")'
    module = said.Module("report/runs/earlier_run.py", ast.parse(reason), frozenset())
    assert [one.text for one in module.texts] == ["it is lost"]
    assert len(module.open) == 1


@pytest.mark.parametrize("name", OTHERS)
def test_why_options_of_a_run_do_not_go_together_is_translated(name: str) -> None:
    known = {english for _, english in messages(name)}
    asked = {one.why for one in PAIRS if isinstance(one, Apart)} | {one.hint for one in PAIRS}
    assert not {text for text in asked if text is not None} - known


PLANTED = """
def refuse(name, error):
    told = f"the coordinate {name} is lost"
    if error:
        raise NoClosedForm(told)
    raise NoClosedForm("nobody translates this", remedy=Message("take [[this]] or [[that]]", this=name))
"""


def test_what_is_wrong_with_a_message_is_found() -> None:
    """Negative control: no translation, a gap without value, a text that is put together."""
    module = said.Module("problems/planted.py", ast.parse(PLANTED), frozenset({"NoClosedForm"}))
    assert [place.partition(": ")[0] for place in module.open] == ["problems/planted.py:5"]
    lost = {one.text for one in module.texts} - {english for _, english in messages("ru")}
    assert lost == {"nobody translates this", "take [[this]] or [[that]]"}
    assert [one.gaps for one in module.texts if "[[" in one.text] == [frozenset({"this"})]


# --- words by their types ---------------------------------------------------------------------------------------------


def words_of_types() -> set[str]:
    """Verdicts, outcomes, theorems, places and methods of conditions, kinds of systems, claims and constraints."""
    found: set[str] = {*Word, *Place, *Method, *Outcome, *Theorem, *HOW_EQUAL.values(), *KIND_NAMES.values(), *SUMS}
    found |= {value for key, value in vars(words).items() if key.isupper() and isinstance(value, str)}
    found |= {str(one.value) for one in (Certainty.PROVED, Certainty.VERIFIED, Certainty.UNDECIDED)}
    found |= {kind_of(system) for system in systems()}
    found |= {f"{kind} of [[of]]" if one.of and kind != "coefficient" else kind for kind, one in CLAIMS.items()}
    found |= {BUT_TURNED, BUT_ZERO, *REASONS.values()}
    found |= {*(quantity.words for quantity in Quantity), *_LESS_GRAVITY.values(), *_FROM_ORIGIN.values()}
    found |= {one.told for one in (*Event, *Lack, *Onset, *Origin)} - {Event.REGULAR}
    found |= {"sine", "cosine", "root", "reciprocal", "function"}
    found |= {*outcome.Outcome, "parameter", "coordinate", "body", *(told for _, _, told in JOINTS.values())}
    found |= {one.value for one in Because if isinstance(one.value, str)}
    found |= {str(called(key)) for key in properties(schema("results"))}
    found |= {*Standing, *Doubt, *Measure, *Lacking, *Certainty, *TITLES.values(), *of_runs()}
    found |= {
        *_DOUBTS.values(),
        *(x for name, x in vars(branches_curve).items() if name.endswith(("_OPEN", "_UNDECIDED"))),
    }
    found |= {code.text(*data) for code in Said for data in DATA}
    return {x for x in found - {"", Place.SUFFICIENT.value, Method.NONE.value} if said.has_words(x)}


def properties(part: object) -> Iterator[str]:
    """What is compared of a document of this schema, by its keys; symbols are called the same everywhere."""
    inner = part if isinstance(part, list) else list(part.values()) if isinstance(part, dict) else []
    if isinstance(part, dict) and "x-aside" in part:
        return
    if isinstance(part, dict) and isinstance(part.get("properties"), dict):
        yield from (key for key, one in part["properties"].items() if "x-aside" not in one and key != "a0")
    for one in inner:
        yield from properties(one)


def of_runs() -> Iterator[str]:
    """Kinds of savings, shares of bounds, ways to q'', how runs end, what methods are called."""
    yield from (kind for kind in kinds.Kind if kind not in (kinds.Kind.FINENESS, kinds.Kind.KERNEL))  # never told
    yield from (plan.MODEL, plan.INTEGRATION, plan.ARITHMETIC, EXTENDED, ARTICULATED, FACTORISED)
    yield from (
        interface.Cause.BLOW_UP,
        interface.Cause.SINGULAR,
        interface.Cause.SINGULAR_SPEEDS,
        interface.Cause.STEP_LIMIT,
        interface.Cause.STUCK,
        interface.Cause.UNDEFINED,
    )
    yield from (
        interface.Cause.SINGULAR_CONSTRAINTS,
        interface.Cause.OUT_OF_REACH,
        interface.Cause.NOT_SMOOTH,
        sides.OUTSIDE,
        sides.SWITCHING,
        "energy",
        "generalised energy",
    )
    yield from (one.title for one in vars(tableaux).values() if isinstance(one, tableaux.Tableau | tableaux.Rosenbrock))


@pytest.mark.parametrize("name", ["summary", "plan_words", "constrained_run_words", "simulation_words", "events"])
def test_titles_of_what_is_said_of_a_run_are_translated(name: str) -> None:
    """The first of every pair that is yielded."""
    tree = said.trees()[f"report/runs/{name}.py"]
    pairs = [x.value for x in ast.walk(tree) if isinstance(x, ast.Yield) and isinstance(x.value, ast.Tuple)]
    found = {x.value for pair in pairs for x in ast.walk(pair.elts[0]) if isinstance(x, ast.Constant)}
    assert found
    for language in OTHERS:
        assert not {x for x in found if isinstance(x, str) and said.has_words(x)} - {x for _, x in messages(language)}


def systems() -> Iterator[LinearSystem]:
    """With every combination of forces."""
    context = fmpq_mpoly_ctx.get(["a"], Ordering.lex)
    zero, one = context.constant(0), context.constant(1)
    nothing, unit, skew = [[zero] * 2] * 2, [[one, zero], [zero, one]], [[zero, one], [-one, zero]]
    for d, g, n in product((nothing, unit), (nothing, skew), (nothing, skew)):
        yield LinearSystem(unit, d, g, unit, n)


DATA = ((1, "", ""), (2, "", ""), ("x", ""), ("", ""), ("stable", True), ("stable", False))


@pytest.mark.parametrize("name", OTHERS)
def test_words_of_results_are_translated(name: str) -> None:
    known = {english for _, english in messages(name)}
    asked = words_of_types()
    assert len(asked) > 150
    assert not asked - known


# --- what a message is ------------------------------------------------------------------------------------------------


def test_a_message_is_its_english_text_and_is_said_with_its_gaps() -> None:
    """A message in a gap is said, too; a name stays, be it a word of ours: a parameter may be called root."""
    inner = Message("momentum of [[name]]", name="root")
    whole = Message(
        "[[why]]; conserved all the same, by structure: [[known]]", why=Message("too many minors"), known=inner
    )
    assert whole == "too many minors; conserved all the same, by structure: momentum of root"
    said_so = Language("ru").say(whole)
    assert said_so == "слишком много миноров; тем не менее сохраняются по структуре уравнений: обобщённый импульс root"
    assert Language("en").say(whole) == Language().say(whole) == whole
    assert pickle.loads(pickle.dumps(whole)).gaps["known"].gaps == {"name": "root"}
    assert Language("es").say(Word.STABLE) == Language("es").say(Message("[[word]]", word=Word.STABLE)) != "stable"
    assert Message("a [[x]] [[x]]", x=Fraction(1, 2)) == "a 1/2 1/2"
    with pytest.raises(ValueError, match="are not the gaps"):
        Message("terms of order [[order]]", degree=3)
    with pytest.raises(ValueError, match="are not the gaps"):
        Message("terms of order [[order]]")


def test_a_failure_keeps_its_message() -> None:
    """Through a pickle, as its reason, and in what is made of it: str() is English."""
    failure = NoClosedForm("[[count]] terms are beyond the budget of [[most]]", count=9, most=5)
    again = pickle.loads(pickle.dumps(failure))
    assert type(again.reason) is Message
    assert again.reason.gaps == {"count": "9", "most": "5"}
    assert str(again) == "9 terms are beyond the budget of 5"
    assert type(str(again)) is str
    assert Language("es").say(NoResult.of(failure).reason) == Language("es").say(failure.reason) != str(failure)
    assert NoValue("m").reason == str(NoValue("m")) == "no number for m"
    assert message_of(ZeroDivisionError("division by zero")) == "division by zero"
