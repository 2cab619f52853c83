"""The page that is shipped is what its sources give."""

from __future__ import annotations

import gzip
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SHIPPED_PAGE = ROOT / "mbsym" / "serving" / "page"

#: Compressed, everything that a browser loads: what the editor may weigh.
MOST_COMPRESSED = 500_000

needs_node = pytest.mark.skipif(not (shutil.which("node") and shutil.which("npm")), reason="no node with npm")


def test_the_page_is_light_enough() -> None:
    """Under 500 kB as it would be sent compressed."""
    files = ("index.html", "page.js", "page.css")
    assert sum(len(gzip.compress((SHIPPED_PAGE / name).read_bytes())) for name in files) < MOST_COMPRESSED


def test_nothing_is_fetched_from_elsewhere() -> None:
    """The page works offline: its own document names no other host, and no part of it asks for one."""
    for path in SHIPPED_PAGE.iterdir():
        text = path.read_text(encoding="utf-8")
        for call in ('fetch("http', 'import("http', "@import", 'url("http', "url(http", 'src="http', 'href="http'):
            assert call not in text, (path.name, call)


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sources with the packages that the lock file names, in a folder of their own."""
    folder = tmp_path_factory.mktemp("page") / "editor"
    shutil.copytree(ROOT / "editor", folder, ignore=shutil.ignore_patterns("node_modules"))
    shutil.copytree(ROOT / "templates" / "html", folder.parent / "templates" / "html")
    command = ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--prefer-offline"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    if done.returncode != 0 and any(
        word in done.stderr for word in ("ENOTFOUND", "ETIMEDOUT", "EAI_AGAIN", "ECONNREFUSED")
    ):
        pytest.skip("the registry of npm cannot be reached")
    assert done.returncode == 0, done.stderr
    return folder


@needs_node
def test_the_sources_have_no_type_errors(sources: Path) -> None:
    done = subprocess.run(["npm", "run", "--silent", "types"], cwd=sources, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout


@needs_node
def test_the_shipped_page_is_what_the_sources_give(sources: Path, tmp_path: Path) -> None:
    """Byte for byte, after `npm ci` and a build in another folder."""
    command = ["node", "build.mjs", str(tmp_path)]
    done = subprocess.run(command, cwd=sources, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    built = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert set(built) == {path.name for path in SHIPPED_PAGE.iterdir()}
    different = [name for name, content in built.items() if (SHIPPED_PAGE / name).read_bytes() != content]
    assert not different, f"`make page` has to be run: {different}"
