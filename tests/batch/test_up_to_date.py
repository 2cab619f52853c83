"""What is up to date is not derived again, and nothing else is taken for it."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest
from batches import QUICK, START, batch, cached, command, files_of, folder_of, outcomes, pendulum, summary
from conftest import filed

from mbsym.batch import digests
from mbsym.batch.coordinator import Place
from mbsym.batch.isolation import isolated
from mbsym.batch.outcome import Outcome, Row
from mbsym.batch.transport import BatchOptions, Budget, Task
from mbsym.batch.work import work
from mbsym.report.exports import fmu
from mbsym_cli.batch.store import FolderStore

DAMPED = pendulum().replace("loads:\n", "loads:\n  - damper: {coordinate: theta, coefficient: m}\n")


@pytest.fixture(scope="module")
def derived(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one description and its results, for copying."""
    root = tmp_path_factory.mktemp("derived")
    folder_of(root / "in", a=pendulum())
    batch("in", "-o", "out", *QUICK, cwd=root)
    return root


@pytest.fixture
def place(derived: Path, tmp_path: Path) -> Path:
    shutil.copytree(derived, tmp_path, dirs_exist_ok=True)
    return tmp_path


def test_nothing_is_derived_twice(place: Path) -> None:
    before, first = files_of(place / "out"), summary(place / "out")
    done = batch("in", "-o", "out", *QUICK, cwd=place)
    assert "up to date" in done.stdout
    assert cached(place / "out") == {"a": True}
    assert files_of(place / "out") == before
    second = summary(place / "out")
    assert first.pop("run") != second.pop("run")
    assert first == second  # but for the run itself the summary is the same


def test_comments_and_layout_do_not_matter(place: Path) -> None:
    text = pendulum().replace("\n", "\r\n").replace("mass: m", "mass:   'm'  # in kilograms")
    block = "parameters:\r\n  m: positive\r\n  l: positive\r\n  g: positive\r\n"
    text = "# a comment\r\n" + text.replace("parameters: {m: positive, l: positive, g: positive}\r\n", block)
    assert block in text
    assert "kilograms" in text
    before = files_of(place / "out")
    (place / "in" / "a.yaml").write_bytes(text.encode())
    batch("in", "-o", "out", *QUICK, cwd=place)
    assert cached(place / "out") == {"a": True}
    after = files_of(place / "out")
    assert {name for name in after if after[name] != before[name]} == {"a/outcome.json", "a/.mbsym.json"}


def test_a_warning_is_said_again_and_where_it_stands_now(tmp_path: Path) -> None:
    """A parameter that nothing uses."""
    text = pendulum().replace("g: positive}", "g: positive, unused: positive}")
    folder_of(tmp_path / "in", a=text)
    first = batch("in", "-o", "out", *QUICK, cwd=tmp_path)
    assert ":3:" in first.stderr
    again = batch("in", "-o", "out", *QUICK, cwd=tmp_path)
    assert again.stderr == first.stderr
    folder_of(tmp_path / "in", a="# one line more\n" + text)
    moved = batch("in", "-o", "out", *QUICK, cwd=tmp_path)
    assert cached(tmp_path / "out") == {"a": True}
    assert moved.stderr == first.stderr.replace(":3:", ":4:")
    assert batch("in", "-o", "out", *QUICK, cwd=tmp_path).stderr == moved.stderr


ASKED = BatchOptions(("json",), (1, 2, 3))


@pytest.mark.parametrize(
    ("text", "asked", "kept"),
    [
        (pendulum(), ASKED, True),
        (pendulum(length="2*l"), ASKED, False),
        (pendulum("Another name"), ASKED, False),
        (DAMPED, ASKED, False),
        (pendulum(), replace(ASKED, problems=(1, 2, 3, 4)), False),
        (pendulum(), replace(ASKED, problems=None), False),
        (pendulum(), replace(ASKED, formats=("json", "python")), False),
        (pendulum(), replace(ASKED, terms=59_999), False),
        (pendulum(), replace(ASKED, angles="sums"), False),
        (pendulum(), replace(ASKED, detail="full"), False),
    ],
    ids=["the same", "expression", "name", "load", "problems", "all problems", "format", "terms", "angles", "detail"],
)
def test_another_description_or_option_is_derived(place: Path, text: str, asked: BatchOptions, kept: bool) -> None:
    file = filed(place / "in" / "a.yaml", text)
    found = FolderStore(place / "out", asked, digests.derivation()).look(Place(str(file), "a"))
    if isinstance(found, Task):  # it is read again, and seen to mean something else
        done = isolated(found, Budget())
        assert not done.same
        assert done.row.outcome is Outcome.DERIVED
    assert isinstance(found, Row) == kept


def test_another_version_of_the_derivation_is_derived(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As if a line of its source had been changed: a copy of the package with one comment more."""
    import mbsym

    root = place / "other"
    shutil.copytree(Path(mbsym.__file__).parent, root / "mbsym", ignore=shutil.ignore_patterns("__pycache__"))
    program = "from mbsym.batch import digests; print(digests.derivation())"

    def there() -> str:
        monkeypatch.setenv("PYTHONPATH", str(root))
        done = subprocess.run([sys.executable, "-c", program], cwd=place, capture_output=True, text=True, check=True)
        return done.stdout.strip()

    assert there() == digests.derivation()  # wherever it is installed
    changed = root / "mbsym" / "mechanics" / "kinematics.py"
    changed.write_text(changed.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    assert there() != digests.derivation()
    kept = place / "out" / "a" / "outcome.json"
    assert json.loads(kept.read_text(encoding="utf-8"))["derivation"] == digests.derivation()
    subprocess.run(command("in", "-o", "out", *QUICK), cwd=place, capture_output=True, check=True)
    assert cached(place / "out") == {"a": False}
    assert json.loads(kept.read_text(encoding="utf-8"))["derivation"] == there()


def test_a_damaged_file_is_made_again(place: Path) -> None:
    """Each in a copy of the same results; the copy that is not damaged stays up to date."""
    text = (place / "in" / "a.yaml").read_text(encoding="utf-8")
    damaged = {}
    for name in ("results.json", "outcome.json", ".mbsym.json"):
        for damage in ("changed", "gone"):
            copy = f"{damage}-{name.strip('.').replace('.', '-')}"
            folder_of(place / "in", **{copy: text})
            shutil.copytree(place / "out" / "a", place / "out" / copy)
            file = place / "out" / copy / name
            data = file.read_bytes()
            file.unlink()
            if damage == "changed":
                file.write_bytes(data.replace(b"a", b"b", 1))
            damaged[copy] = False
    before = files_of(place / "out" / "a")
    batch("in", "-o", "out", *QUICK, cwd=place)
    assert cached(place / "out") == {"a": True, **damaged}
    assert all(files_of(place / "out" / copy) == before for copy in damaged)


def test_a_delivery_that_was_killed_is_completed(place: Path) -> None:
    """Everything lay ready (``cli/files.py``, step 2), but only some of it had been moved to its place."""
    folder = place / "out" / "a"
    before = files_of(place / "out")
    (folder / ".mbsym-ready").mkdir()
    for name in ("outcome.json", ".mbsym.json"):
        (folder / name).rename(folder / ".mbsym-ready" / name)
    batch("in", "-o", "out", *QUICK, cwd=place)
    assert cached(place / "out") == {"a": True}
    assert files_of(place / "out") == before


def test_what_another_command_wrote_over_is_made_again(place: Path) -> None:
    arguments = ["run", "in/a.yaml", "--out", "out/a", "--format", "json", "--problems", "1", "--quiet"]
    subprocess.run([*START, *arguments], cwd=place, check=True)
    before = (place / "out" / "a" / "results.json").read_bytes()
    batch("in", "-o", "out", *QUICK, cwd=place)
    assert cached(place / "out") == {"a": False}
    assert (place / "out" / "a" / "results.json").read_bytes() != before


def test_a_description_with_errors_leaves_what_was_there(place: Path) -> None:
    """As with ``mbsym run``, nothing is written for it; corrected, it is up to date at once."""
    before = files_of(place / "out")
    folder_of(place / "in", a=pendulum().replace("mass: m", "mass: mm"))
    done = batch("in", "-o", "out", *QUICK, cwd=place, code=2)
    assert "in/a.yaml:9:11: error[unknown-name]" in done.stderr
    assert summary(place / "out")["systems"][0]["files"] == []
    assert files_of(place / "out") == before
    folder_of(place / "in", a=pendulum())
    batch("in", "-o", "out", *QUICK, cwd=place)
    assert cached(place / "out") == {"a": True}


def test_a_compiler_that_came_since_is_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An FMU without a binary is not up to date where there can be one; and one with it is."""
    if fmu.compiler() is None:
        pytest.skip("there is no C compiler")
    file = folder_of(tmp_path / "in", a=pendulum()) / "a.yaml"
    place, asked = Place(str(file), "a"), BatchOptions(("fmu2",), (1,))

    def look() -> Row | Task:
        return FolderStore(tmp_path / "out", asked, "d").look(place)

    def derive() -> set[str]:
        task = look()
        assert isinstance(task, Task)
        FolderStore(tmp_path / "out", asked, "d").keep(task, work(task))
        with zipfile.ZipFile(tmp_path / "out" / "a" / "model-fmi2.fmu") as archive:
            return {Path(name).parts[0] for name in archive.namelist()}

    with monkeypatch.context() as without:
        without.setattr(fmu, "compiler", lambda: None)
        assert "binaries" not in derive()
        assert isinstance(look(), Row)
    assert "binaries" in derive()
    assert isinstance(look(), Row)


def test_a_claim_that_does_not_hold_is_said_again(tmp_path: Path) -> None:
    wrong = pendulum() + "claims:\n  - {claim: mass matrix, entry: [theta, theta], equals: 2*m*l**2}\n"
    folder_of(tmp_path / "in", a=wrong)
    for again in (False, True):
        batch("in", "-o", "out", *QUICK, cwd=tmp_path)
        assert cached(tmp_path / "out") == {"a": again}
        assert [claim["word"] for claim in summary(tmp_path / "out")["systems"][0]["claims"]] == ["refuted"]
    batch("in", "-o", "out", *QUICK, "--strict-claims", cwd=tmp_path, code=1)
    assert cached(tmp_path / "out") == {"a": True}
    assert outcomes(tmp_path / "out") == {"a": "claim does not hold"}


def test_only_what_changed_is_shown(tmp_path: Path) -> None:
    folder_of(tmp_path / "in", a=pendulum(), b=pendulum("B"))
    batch("in", "-o", "out", *QUICK, cwd=tmp_path)
    folder_of(tmp_path / "in", b=pendulum("Changed"))
    done = batch("in", "-o", "out", *QUICK, "--changed", cwd=tmp_path)
    assert "in/b.yaml" in done.stdout
    assert "in/a.yaml" not in done.stdout
    assert outcomes(tmp_path / "out") == {"a": "derived", "b": "derived"}


def test_meaning() -> None:
    """Texts whose pieces are the same characters, one after another, are told apart."""
    meanings = [
        digests.of_meaning(text, "x.yaml")
        for text in (
            "mbsym: 1\nname: [ab, c]\n",
            "mbsym: 1\nname: [a, bc]\n",
            "mbsym: 1\nname: [[ab], c]\n",
            "mbsym: 1\nname: {ab: c}\n",
            "mbsym: 1\nname: '[ab, c]'\n",
        )
    ]
    assert "" not in meanings
    assert len(set(meanings)) == len(meanings)
    assert digests.of_meaning("mbsym: 1\nname:\n - 'ab'  # why\n - \"c\"", "y.yml") == meanings[0]
    assert digests.of_meaning("mbsym: [", "x.yaml") == ""


def test_problems_are_numbered_as_in_the_pipeline() -> None:
    from mbsym.analysis import ALL_PROBLEMS
    from mbsym.problems import NUMBERS

    assert tuple(NUMBERS) == ALL_PROBLEMS


def test_looking_loads_nothing_heavy(place: Path) -> None:
    heavy = ("flint", "sympy", "numpy", "scipy", "jinja2", "matplotlib", "llvmlite", "rich", "mbsym.analysis")
    program = f"""
import sys
from mbsym_cli.main import main
try:
    main(["batch", "in", "-o", "out", "--format", "json", "--problems", "1-3"], prog_name="mbsym")
except SystemExit as ended:
    print(*[name for name in {heavy} if name in sys.modules], ended.code)
"""
    done = subprocess.run([sys.executable, "-c", program], cwd=place, capture_output=True, text=True, check=True)
    assert "1 up to date" in done.stdout
    assert done.stdout.splitlines()[-1] == "0"


# --- descriptions that are gone ---------------------------------------------------------------------------------------


def test_results_of_a_deleted_description_go_and_nothing_else(place: Path) -> None:
    """What somebody has changed or put there stays, and so does what another batch wrote of another folder."""
    folder_of(place / "in", b=pendulum(), c=pendulum(), d=pendulum())
    folder_of(place / "other", e=pendulum())
    batch("in", "other", "-o", "out", *QUICK, cwd=place)
    assert {"a", "b", "c", "d", "e"} <= {path.parent.name for path in (place / "out").rglob("outcome.json")}
    (b,), (c,), (d,), (e,) = ([path.parent for path in (place / "out").rglob(f"{n}/outcome.json")] for n in "bcde")
    (c / "own.txt").write_text("mine")
    (d / "results.json").write_text("changed")
    for name in "bcd":
        (place / "in" / f"{name}.yaml").unlink()
    (place / "other" / "e.yaml").unlink()
    done = batch("in", "-o", "out", *QUICK, cwd=place)
    assert done.stdout.count("removed, its description is gone") == 3
    assert not b.exists()
    assert {path.name for path in c.iterdir()} - {".mbsym.json"} == {"own.txt"}
    assert {path.name for path in d.iterdir()} - {".mbsym.json"} == {"results.json"}
    assert (e / "outcome.json").exists()  # nobody asked about its folder
    assert [Path(one["file"]).name for one in summary(place / "out")["systems"]] == ["a.yaml"]


@pytest.mark.parametrize("folder", ["../victim", "/victim", "", "."])
def test_a_summary_leads_nowhere_else(folder: str, place: Path) -> None:
    shutil.copytree(place / "out", place / "victim")
    told = summary(place / "out")
    told["systems"].append({**told["systems"][0], "file": "in/gone.yaml", "folder": folder})
    (place / "out" / "summary.json").write_text(json.dumps(told))
    before = files_of(place / "victim")
    assert "removed" not in batch("in", "-o", "out", *QUICK, cwd=place).stdout
    assert files_of(place / "victim") == before
