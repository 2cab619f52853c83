"""Pages that are made of the program itself whenever the site is built, so that none of them can be out of date."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

sys.path.insert(0, str(Path(__file__).parent))

import commands_page
import description_page
import json_page
import problems_page
import python_page

PAGES = {
    "reference/python.md": python_page.page,
    "reference/json.md": json_page.page,
}
#: What is made stands below what is written.
TAILS = {
    "reference/description.md": description_page.tail,
    "reference/commands.md": commands_page.tail,
    "reference/problems.md": problems_page.tail,
}
#: Where docs/theory.md has the words of verdicts.
VERDICTS = "<!-- verdicts -->"


def on_files(files: Files, config: Any, **_: Any) -> Files:
    """The files of the site, with the pages and schemas that are made."""
    for name, page in PAGES.items():
        files.append(File.generated(config, name, content=page()))
    for name, text in json_page.schemas().items():
        files.append(File.generated(config, f"reference/{name}", content=text))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """A page with what is made for it."""
    tail = TAILS.get(page.file.src_uri)
    markdown = markdown.replace(VERDICTS, problems_page.verdicts())
    return f"{markdown}\n\n{tail()}" if tail else markdown
