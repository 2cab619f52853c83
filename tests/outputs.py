"""Every output at once, to see what a change does.

    python tests/outputs.py build/outputs                  every file, and DIGESTS with one line a file
    python tests/outputs.py build/outputs --ref <commit>   besides, what that commit writes, and what differs: CHANGES

Run are every description that is shipped or tested, in every format and language, and every command of the README and
the documentation, always those of this checkout; a commit differs in its code alone.  Measured seconds are masked.
"""

from __future__ import annotations

import argparse
import difflib
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests" / "site")]

from pages import DOCS, blocks, pages  # noqa: E402

COMMAND = "import sys; from mbsym_cli.process import command; sys.argv[0] = 'mbsym'; command()"
#: Where packages stand in a checkout that is not installed.
PACKAGES = {"mbsym": "mbsym", "mbsym_cli": "cli", "mbsym_templates": "templates", "mbsym_systems": "systems"}
#: Languages other than English have LaTeX reports alone.
RUNS = {
    "all": ("--format", "all,casadi,jax,octave,julia,modelica"),
    "ru": ("--format", "latex", "--language", "ru"),
    "es": ("--format", "latex", "--language", "es"),
}
#: They wait for somebody.
ENDLESS = ("watch", "lsp", "edit")
#: One command may take so long.
SECONDS = 600
#: So many lines of one file's difference are shown.
MOST_LINES = 40

#: What is measured, wherever it is printed: "0.42 s" (in columns, too), "3 ms", "12.3 MB", "seconds": 0.42, and rows of
#: tables in seconds; and digests of the code and of files, which are compared themselves.
MASKED = re.compile(
    r" *(?<![\w.])[0-9][0-9.]*(?:e[-+]?\d+)? ?(?=(?:s|ms|min|MB|seconds)\b)"
    r"|(?<=seconds\": )[0-9.e+-]+|(?<=time=\")[0-9.e+-]+|(?<=,seconds,)[0-9.e,+-]+|\b[0-9a-f]{64}\b"
)


@dataclass(frozen=True)
class Job:
    """One command: its words after ``mbsym``, and the folder beneath the outputs in which it runs."""

    words: tuple[str, ...]
    place: str


def descriptions() -> list[Path]:
    """All that a run can begin with: shipped ones, and those that tests keep."""
    shipped = [path for path in (ROOT / "systems").iterdir() if path.suffix in (".yaml", ".txt")]
    tested = [path for folder in ("cases", "systems") for path in (ROOT / "tests" / folder).rglob("*.yaml")]
    return sorted(shipped) + sorted(tested)


def jobs(only: str) -> list[Job]:
    found = []
    for path in descriptions():
        name = path.relative_to(ROOT).as_posix()
        found += [Job(("run", name, *words, "--out", "out"), f"{name}/{run}") for run, words in RUNS.items()]
    found += [Job(tuple(words), f"documented/{k:03d}") for k, words in enumerate(documented())]
    return [job for job in found if only in " ".join((job.place, *job.words))]


#: What of a line is for the shell alone.
REDIRECTED = {">", "|", "&&", "2>"}


def documented() -> Iterator[list[str]]:
    """The commands of the README and of the pages, each once."""
    seen = set()
    for text in ((ROOT / "README.md").read_text("utf-8"), *((DOCS / page).read_text("utf-8") for page in pages())):
        for block in blocks(text):
            for line in block.text.replace("\\\n", " ").splitlines() if block.language == "sh" else ():
                if not line.startswith("mbsym "):
                    continue
                words = shlex.split(line, comments=True)
                words = words[: next((k for k, word in enumerate(words) if word in REDIRECTED), None)]
                elsewhere = any(word.startswith("tcp://") for word in words)  # a machine that is not there
                if words[1] not in ENDLESS and not elsewhere and line not in seen:
                    seen.add(line)
                    yield words[1:]


def built(code: Path, folder: Path, chosen: Sequence[Job]) -> None:
    """What the code at ``code`` writes for each job, beneath ``folder``."""
    links = folder.with_name(folder.name + "-code")
    for where in (folder, links):
        shutil.rmtree(where, ignore_errors=True)
        where.mkdir(parents=True)
    for package, place in PACKAGES.items():
        (links / package).symlink_to(code / place)
    environment = {**os.environ, "PYTHONPATH": str(links), "COLUMNS": "80", "NO_COLOR": "1", "PYTHONHASHSEED": "0"}

    def run(job: Job) -> None:
        there = folder / job.place
        there.mkdir(parents=True)
        for name in ("systems", "tests"):
            (there / name).symlink_to(ROOT / name)
        try:
            done = subprocess.run(
                [sys.executable, "-c", COMMAND, *job.words],
                cwd=there, env=environment, capture_output=True, text=True, timeout=SECONDS, check=False,
            )  # fmt: skip
            said = f"$ mbsym {shlex.join(job.words)}\n{done.stdout}{done.stderr}exit code {done.returncode}\n"
        except subprocess.TimeoutExpired:
            said = f"$ mbsym {shlex.join(job.words)}\nno end\n"
        for name in ("systems", "tests"):
            (there / name).unlink()
        (there / "terminal.txt").write_text(said, encoding="utf-8")

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for k, _ in enumerate(pool.map(run, chosen), start=1):
            print(f"\r{folder.name}: {k} of {len(chosen)} commands", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    shutil.rmtree(links)


def files(folder: Path) -> dict[str, bytes]:
    """Every file by its name, what was measured masked in those that are text."""
    found = {}
    for path in sorted(path for path in folder.rglob("*") if path.is_file()):
        data = path.read_bytes()
        with suppress(UnicodeDecodeError):
            data = MASKED.sub(" 0 ", data.decode("utf-8")).encode("utf-8")
        found[path.relative_to(folder).as_posix()] = data
    return found


def digests(found: dict[str, bytes]) -> str:
    return "".join(f"{hashlib.sha256(data).hexdigest()[:16]}  {name}\n" for name, data in found.items())


def differences(before: dict[str, bytes], after: dict[str, bytes]) -> Iterator[str]:
    """Lines for a person: files that are gone or new, and what changed in the others."""
    for name in sorted({*before, *after}):
        if name not in after or name not in before:
            yield f"{'gone' if name not in after else 'new'}: {name}"
        elif before[name] != after[name]:
            try:
                old, new = (side[name].decode("utf-8").splitlines() for side in (before, after))
            except UnicodeDecodeError:
                yield f"differs: {name}"
                continue
            lines = list(difflib.unified_diff(old, new, name, name, lineterm="", n=0))
            yield from lines[:MOST_LINES]
            if len(lines) > MOST_LINES:
                yield f"... and {len(lines) - MOST_LINES} lines more"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--ref", default="", help="a commit whose outputs are built beside")
    parser.add_argument("--only", default="", help="commands whose words or folder hold this")
    asked = parser.parse_args()
    chosen, folder = jobs(asked.only), asked.folder.resolve()
    built(ROOT, folder / "here", chosen)
    here = files(folder / "here")
    (folder / "DIGESTS").write_text(digests(here), encoding="utf-8")
    print(f"{len(here)} files of {len(chosen)} commands: {folder / 'DIGESTS'}")
    if not asked.ref:
        return 0
    tree = folder / "ref-tree"
    git = ("git", "-C", str(ROOT), "worktree")
    subprocess.run([*git, "remove", "--force", str(tree)], capture_output=True, check=False)
    subprocess.run([*git, "add", "--quiet", "--detach", str(tree), asked.ref], check=True)
    try:
        built(tree, folder / "ref", chosen)
    finally:
        subprocess.run([*git, "remove", "--force", str(tree)], check=True)
    lines = list(differences(files(folder / "ref"), here))
    (folder / "CHANGES").write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    print(f"{len(lines)} lines differ from {asked.ref}: {folder / 'CHANGES'}" if lines else "nothing differs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
